/* The techniques there are, and how their specs are read. */
#ifndef PNI_TECHNIQUES_REGISTRY_H
#define PNI_TECHNIQUES_REGISTRY_H

#include "techniques/technique.h"

/* The class behind a table that the library handed out. */
const pni_technique_class *pni_technique_class_of(const pn_technique *table);

/* What was wrong with a spec: one line that names it and what would be right, and the message that fits. */
typedef struct {
  pn_message message;
  char text[512];
} pni_explanation;

/* Reads "name" or "name:key=value,...". values: PNI_PARAMETERS_MAX numbers, those not named take their defaults. */
pn_result pni_spec_read(const char *spec, const pni_technique_class **out, double *values, pni_explanation *why);

/* Sets one of values by the parameter's name; a preset sets the others too. */
pn_result pni_parameter_set(const pni_technique_class *technique, const char *name, double value, double *values,
                            pni_explanation *why);

#endif
