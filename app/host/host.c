#include "host/host.h"

#include <string.h>

#include "base/message.h"

int host_open(const struct scene *scene, const char *device, struct host *host) {
  memset(host, 0, sizeof *host);
  host->scene = scene;
  int status = device_open(device, &host->device);
  if (!status) {
    note("device %d: %s, OpenGL %s", device_number(host->device), device_renderer(host->device),
         device_version(host->device));
    status = gpu_scene_create(scene, &host->gpu);
  }
  if (!status) status = gbuffer_create(host->gpu, &host->gbuffer);
  if (!status) status = client_create(host->gpu, host->gbuffer, PN_STATE_RESTORE, &host->client);
  if (status) host_close(host);
  return status;
}

void host_close(struct host *host) {
  client_free(&host->client);
  gbuffer_free(&host->gbuffer);
  gpu_scene_free(&host->gpu);
  device_close(&host->device);
}
