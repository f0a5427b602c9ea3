/* Reads what the program writes. */
#ifndef HOST_IMAGE_FILE_H
#define HOST_IMAGE_FILE_H

/* The channel of an OpenEXR file as floats, bottom row first, malloced; NULL with a line on stderr. */
float *exr_channel(const char *path, const char *channel, int *width, int *height);

/* The 8-bit pixels of a PPM (P6), top row first, malloced. */
unsigned char *ppm_pixels(const char *path, int *width, int *height);

#endif
