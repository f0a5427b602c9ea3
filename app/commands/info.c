/* penumbra info: GL devices, the chosen one's limits, and which optional features are in use. */
#include <string.h>

#include "base/message.h"
#include "commands/commands.h"
#include "host/device.h"

static void print_devices(void) {
  enum { DEVICES_MAX = 32 };
  static struct device_info devices[DEVICES_MAX];
  int count = device_list(devices, DEVICES_MAX);
  puts("devices (--device N):");
  for (int i = 0; i < count && i < DEVICES_MAX; i++) {
    const struct device_info *d = &devices[i];
    if (d->usable)
      printf("  %d  %s, OpenGL %s%s\n", d->number, d->renderer, d->version, d->software ? " (software)" : "");
    else printf("  %d  not usable: %s\n", d->number, d->problem);
  }
  if (!count) puts("  none");
}

static void on_message(void *user, pn_log_level level, int message_id, const char *text) {
  (void)user;
  (void)message_id;
  if (level == PN_LOG_INFO) note("%s", text);
  else warning("%s", text);
}

static void print_context(const pn_context *context) {
  pn_info info;
  if (pn_context_info(context, &info) != PN_OK) return;
  printf("  vendor          %s\n  renderer        %s\n  version         %s\n", info.vendor, info.renderer,
         info.version);
  printf("  OpenGL          %d.%d core, %s\n", info.gl_version / 10, info.gl_version % 10,
         info.software ? "software: times are glFinish and the system's clock"
                       : "hardware: times are timestamp queries");
  printf("  depth maps      up to %d x %d, %d layers\n", info.map_size_max, info.map_size_max, info.map_layers_max);
  puts("features:");
  const char *name, *help;
  int in_use;
  for (int i = 0; pn_feature(context, i, &name, &in_use, &help); i++)
    printf("  %-3s  %-22s %s\n", in_use ? "yes" : "no", name, help);
}

int command_info(const struct options *o) {
  printf("penumbra %s\n", pn_version());
  print_devices();
  struct device *device = NULL;
  int status = device_open(o->device, &device);
  if (status) return status;
  printf("chosen: %d\n", device_number(device));
  pn_context_desc desc = {.log = on_message};
  pn_context *context = NULL;
  pn_result result = pn_context_create(&desc, &context);
  if (result == PN_OK) print_context(context);
  else status = work_error("the library does not start on this device: %s", pn_result_name(result));
  pn_context_destroy(&context);
  device_close(&device);
  return status;
}
