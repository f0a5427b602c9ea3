/* device.h: a GL context without a window, through EGL: a GPU's driver where there is one, a software rasteriser
 * otherwise. */
#ifndef PENUMBRA_APP_HOST_DEVICE_H
#define PENUMBRA_APP_HOST_DEVICE_H

struct device;

/* What penumbra info shows of one. Strings belong to the device list. */
struct device_info {
  int number;
  int usable, software;
  char renderer[128], version[128], problem[128];
};

/* Opens "auto" (NULL: the same), "software" or a number, and makes its context current on this thread: OpenGL 4.5
 * core where that works, at least 3.3. On failure one line was printed and the exit status is returned. */
int device_open(const char *which, struct device **out);
void device_close(struct device **device); /* clears the handle; NULL and a NULL handle are fine */

const char *device_renderer(const struct device *device); /* GL's strings */
const char *device_version(const struct device *device);
int device_number(const struct device *device);

/* Tries every device and tells how it went. Returns how many there are; fills up to capacity. Call it while no
 * device is open. */
int device_list(struct device_info *out, int capacity);

#endif
