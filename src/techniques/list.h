/* The techniques there are, in the order in which they are listed: a line for each folder. Included by registry.c,
 * which says what becomes of a line. */
PNI_TECHNIQUE(hard)
PNI_TECHNIQUE(pcf)
PNI_TECHNIQUE(pcss)
PNI_TECHNIQUE(average)
PNI_TECHNIQUE(ssm)
PNI_TECHNIQUE(backprojection)
PNI_TECHNIQUE(bitmask)
PNI_TECHNIQUE(smoothies)
