/* host.h: all that drawing a scene takes, in the order in which it is made: device, buffers, camera, library. */
#ifndef PENUMBRA_APP_HOST_HOST_H
#define PENUMBRA_APP_HOST_HOST_H

#include "host/client.h"
#include "host/device.h"

struct host {
  const struct scene *scene;
  struct device *device;
  struct gpu_scene *gpu;
  struct gbuffer *gbuffer;
  struct client *client; /* PN_STATE_RESTORE */
};

/* device: as device_open. The scene must outlive the host. Exit status. */
int host_open(const struct scene *scene, const char *device, struct host *host);
void host_close(struct host *host);

#endif
