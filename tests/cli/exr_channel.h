/* What the program saved, read by the library that others read it with. */
#ifndef EXR_CHANNEL_H
#define EXR_CHANNEL_H

#include <stdbool.h>

/* One channel of an EXR file of width x height pixels, found by its name; rows from the top. */
bool exr_channel_read(const char *path, const char *channel, int width, int height, float *out);

#endif
