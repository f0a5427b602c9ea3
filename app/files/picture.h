/* picture.h: linear RGB as a file. */
#ifndef PENUMBRA_APP_FILES_PICTURE_H
#define PENUMBRA_APP_FILES_PICTURE_H

/* Three floats a pixel, top row first, as the ending of path says: sRGB PNG or EXR. Exit status. */
int picture_write(const char *path, int width, int height, const float *rgb);

#endif
