#include "experiment/findings.h"

#include <stdlib.h>
#include <string.h>

#include "base/message.h"
#include "experiment/result.h"
#include "files/save.h"
#include "scene/scene_json.h"

static void describe_setup(const struct setup *setup, struct findings *out) {
  const struct light *light = &setup->light;
  const struct camera *camera = &setup->camera;
  const double *p = light->center, *q = light->target, *e = camera->position, *t = camera->target;
  const double *b = setup->fit_bounds;
  int sun = light->shape == PN_LIGHT_SUN;
  snprintf(out->facts, sizeof out->facts,
           "%s %.4g x %.4g%s at %.4g, %.4g, %.4g towards %.4g, %.4g, %.4g   "
           "camera at %.4g, %.4g, %.4g towards %.4g, %.4g, %.4g, %.4g degrees",
           sun ? "sun" : "rectangle light", light->size[0], light->size[1], sun ? " degrees" : "", p[0], p[1], p[2],
           q[0], q[1], q[2], e[0], e[1], e[2], t[0], t[1], t[2], camera->fov);
  char fit[120];
  if (setup->fit == PN_FIT_GIVEN)
    snprintf(fit, sizeof fit, "box %.4g, %.4g, %.4g to %.4g, %.4g, %.4g", b[0], b[1], b[2], b[3], b[4], b[5]);
  else snprintf(fit, sizeof fit, "%s", setup->fit == PN_FIT_CASTERS ? "casters" : "visible");
  snprintf(out->sizes, sizeof out->sizes, "%d x %d pixels   map %d x %d fitted to %s%s%s", setup->size[0],
           setup->size[1], setup->map[0], setup->map[1], fit, setup->split ? "   split: the model only casts" : "",
           setup->visibility_scale > 1 ? "   visibility at lower resolution" : "");
}

static int describe_technique(const struct entry *entry, int index, int saved, struct findings *out) {
  cJSON *described = out->described[index] = result_technique(entry->spec);
  if (saved) out->files[index] = save_name(index, entry->spec);
  if (!cJSON_GetObjectItem(described, "technique") || (saved && !out->files[index])) return memory_error();
  out->techniques[index] = (struct report_technique){.name = cJSON_GetObjectItem(described, "technique")->valuestring,
                                                     .label = entry->spec,
                                                     .file = out->files[index],
                                                     .parameters = cJSON_GetObjectItem(described, "parameters"),
                                                     .error = entry->error,
                                                     .all = entry->all,
                                                     .picture_error = entry->picture_error,
                                                     .time_median = entry->timing.median,
                                                     .time_least = entry->timing.min,
                                                     .time_most = entry->timing.max,
                                                     .stages = entry->timing.stages,
                                                     .stage_count = entry->timing.stage_count,
                                                     .covered = entry->insides.covered,
                                                     .bound = entry->bound,
                                                     .searched = entry->search.searched,
                                                     .search_pixels = entry->search.pixels,
                                                     .search_visited = entry->search.visited,
                                                     .search_primitives = entry->search.primitives,
                                                     .search_window = entry->search.window,
                                                     .visibility = entry->visibility,
                                                     .picture = entry->picture};
  return STATUS_OK;
}

static int describe_techniques(const struct experiment *e, int saved, struct findings *out) {
  out->techniques = calloc((size_t)e->count + 1, sizeof *out->techniques);
  out->described = calloc((size_t)e->count + 1, sizeof *out->described);
  out->files = calloc((size_t)e->count + 1, sizeof *out->files);
  if (!out->techniques || !out->described || !out->files) return memory_error();
  out->report.techniques = out->techniques;
  int status = STATUS_OK;
  for (int i = 0; i < e->count && !status; i++) {
    out->report.technique_count++;
    status = describe_technique(&e->entries[i], i, saved, out);
  }
  return status;
}

int findings_make(const struct experiment *e, int samples, int saved, struct findings *out) {
  memset(out, 0, sizeof *out);
  const struct scene *scene = e->host.scene;
  describe_setup(&scene->setup, out);
  out->scene = scene_to_json(scene);
  if (!out->scene) return memory_error();
  out->report = (struct report){.version = pn_version(),
                                .renderer = device_renderer(e->host.device),
                                .gl_version = device_version(e->host.device),
                                .title = scene->name,
                                .facts = out->facts,
                                .sizes = out->sizes,
                                .scene = out->scene,
                                .samples = samples,
                                .reference_ms = e->truth.seconds * 1000,
                                .width = e->view->width,
                                .height = e->view->height,
                                .reference = e->truth.visibility,
                                .reference_picture = e->reference_picture,
                                .mask = e->mask,
                                .background = e->background};
  return describe_techniques(e, saved, out);
}

void findings_free(struct findings *f) {
  for (int i = 0; i < f->report.technique_count; i++) {
    cJSON_Delete(f->described[i]);
    free(f->files[i]);
  }
  free(f->techniques);
  free(f->described);
  free(f->files);
  cJSON_Delete(f->scene);
  memset(f, 0, sizeof *f);
}
