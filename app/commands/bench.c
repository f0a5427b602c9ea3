/* penumbra bench: stage times of techniques, measured in turn in one run; what state saving costs, and a light that
 * touches no pixel. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/message.h"
#include "commands/commands.h"
#include "commands/outputs.h"
#include "experiment/choice.h"
#include "experiment/measure.h"
#include "experiment/result.h"
#include "files/output.h"
#include "scene/setup.h"
#include "scene/vector.h"

static const char default_scene[] = "builtin:balls", cheapest_technique[] = "hard";

struct bench {
  const struct options *options;
  struct host host;
  const char **specs;
  int spec_count;
  cJSON *json;  /* NULL: not wanted */
  FILE *people; /* where the table goes */
};

/* The scene's own light first; the others stand around it, at the same distance and pointing at the same target. */
static int place_light(const struct light *own, int index, int count, struct light *out) {
  *out = *own;
  if (index == 0) return STATUS_OK;
  double angle = 2 * 3.14159265358979323846 * index / count, toward[3];
  v3_sub(own->target, own->center, toward);
  double reach = 0.35 * v3_length(toward);
  for (int k = 0; k < 3; k++) out->center[k] += reach * (cos(angle) * own->u[k] + sin(angle) * own->v[k]);
  return light_finish(out);
}

static int make_lights(struct bench *b, struct client *client, const char *spec, int count, pn_light **lights) {
  const struct setup *setup = &b->host.scene->setup;
  int status = STATUS_OK;
  for (int i = 0; i < count && !status; i++) {
    struct light light;
    status = place_light(&setup->light, i, count, &light);
    if (!status) status = client_light(client, setup, &light, spec, &lights[i]);
  }
  return status;
}

static void print_table(const struct bench *b, const struct contestant *c, int lights) {
  fprintf(b->people, "\n%d light%s\n%-28s %10s %8s %9s %9s %7s  %s\n", lights, lights == 1 ? "" : "s", "technique",
          "median ms", "ratio", "min", "max", "frames", "stages, ms");
  for (int i = 0; i < b->spec_count; i++) {
    const struct timing *t = &c[i].timing;
    fprintf(b->people, "%-28s %10.2f %8.2f %9.2f %9.2f %7d ", b->specs[i], t->median, t->median / c[0].timing.median,
            t->min, t->max, t->frames);
    for (int s = 0; s < t->stage_count; s++)
      fprintf(b->people, " %s %.2f", t->stages[s].name, t->stages[s].milliseconds);
    fputc('\n', b->people);
  }
  fflush(b->people);
}

static void add_results(struct bench *b, const struct contestant *c, int lights) {
  if (!b->json) return;
  cJSON *results = cJSON_GetObjectItem(b->json, "results");
  if (!results) results = cJSON_AddArrayToObject(b->json, "results");
  for (int i = 0; i < b->spec_count; i++) {
    cJSON *result = result_technique(b->specs[i]);
    cJSON_AddItemToArray(results, result);
    cJSON_AddNumberToObject(result, "lights", lights);
    cJSON_AddNumberToObject(result, "ratio", c[i].timing.median / c[0].timing.median);
    cJSON_AddItemToObject(result, "time_ms", result_times(&c[i].timing));
  }
}

/* All techniques with this many lights. */
static int bench_techniques(struct bench *b, int lights) {
  struct contestant *c = calloc((size_t)b->spec_count + 1, sizeof *c);
  pn_light **all = calloc((size_t)b->spec_count * (size_t)lights + 1, sizeof *all);
  int status = c && all ? STATUS_OK : memory_error();
  for (int i = 0; i < b->spec_count && !status; i++) {
    c[i] = (struct contestant){
        .client = b->host.client, .lights = all + (size_t)i * (size_t)lights, .light_count = lights};
    status = make_lights(b, b->host.client, b->specs[i], lights, c[i].lights);
  }
  if (!status) status = measure(c, b->spec_count, b->options->frames, 1);
  if (!status) {
    print_table(b, c, lights);
    add_results(b, c, lights);
  }
  for (int i = 0; all && i < b->spec_count * lights; i++) pn_light_destroy(&all[i]);
  free(all);
  free(c);
  return status;
}

static void report(struct bench *b, const char *key, const char *text, const struct timing *a,
                   const struct timing *other, double value) {
  fprintf(b->people, "%s\n", text);
  if (!b->json) return;
  cJSON *object = cJSON_AddObjectToObject(b->json, key);
  cJSON_AddItemToObject(object, "hard_ms", result_times(a));
  cJSON_AddItemToObject(object, "other_ms", result_times(other));
  if (isfinite(value)) cJSON_AddNumberToObject(object, "share", value);
  else cJSON_AddNullToObject(object, "share");
}

/* A small difference needs many frames. */
static int many_frames(const struct options *o) { return o->given[OPTION_FRAMES] ? o->frames : 5 * o->frames; }

/* The same frame with the GL state saved and restored in every call, and once around all calls. */
static int bench_state(struct bench *b) {
  struct client *scoped = NULL;
  pn_light *lights[2] = {NULL, NULL};
  int status = client_create(b->host.gpu, b->host.gbuffer, PN_STATE_SCOPED, &scoped);
  if (!status) status = client_check(scoped, pn_state_begin(scoped->context));
  if (!status) status = make_lights(b, scoped, cheapest_technique, 1, &lights[1]);
  if (!status) status = client_check(scoped, pn_state_end(scoped->context));
  if (!status) status = make_lights(b, b->host.client, cheapest_technique, 1, &lights[0]);
  struct contestant c[2] = {{.client = b->host.client, .lights = &lights[0], .light_count = 1},
                            {.client = scoped, .lights = &lights[1], .light_count = 1, .in_scope = 1}};
  if (!status) status = measure(c, 2, many_frames(b->options), 0);
  if (!status) {
    double difference = c[0].timing.median - c[1].timing.median, share = difference / c[0].timing.median;
    char text[240], verdict[60] = "not measurable (within the noise)";
    /* One frame has no spread to tell a difference from. Saving more often cannot take less: what looks like it was
     * something else. */
    int measurable = c[0].timing.frames > 1 && difference > fmax(c[0].timing.quartiles, c[1].timing.quartiles);
    if (measurable) snprintf(verdict, sizeof verdict, "%+.1f %%", 100 * share);
    else share = NAN;
    snprintf(text, sizeof text,
             "\nstate saving: a %s frame takes %.3f ms saving state in each call, %.3f ms with one scope: %s",
             cheapest_technique, c[0].timing.median, c[1].timing.median, verdict);
    report(b, "state_saving", text, &c[0].timing, &c[1].timing, share);
  }
  pn_light_destroy(&lights[0]);
  client_free(&scoped);
  return status;
}

/* A light that shines away from everything against the scene's own. */
static int bench_untouched(struct bench *b) {
  const struct setup *setup = &b->host.scene->setup;
  struct light away = setup->light;
  pn_light *lights[2] = {NULL, NULL};
  for (int k = 0; k < 3; k++) {
    away.center[k] -= 4 * (away.target[k] - away.center[k]);
    away.target[k] = 2 * away.center[k] - away.target[k];
  }
  int status = light_finish(&away);
  if (!status) status = client_light(b->host.client, setup, &setup->light, cheapest_technique, &lights[0]);
  if (!status) status = client_light(b->host.client, setup, &away, cheapest_technique, &lights[1]);
  struct contestant c[2] = {{.client = b->host.client, .lights = &lights[0], .light_count = 1},
                            {.client = b->host.client, .lights = &lights[1], .light_count = 1}};
  if (!status) status = measure(c, 2, b->options->frames, 0);
  if (!status) {
    double share = c[1].timing.median / c[0].timing.median;
    char text[200];
    snprintf(text, sizeof text, "a light that touches no pixel: %.3f ms, %.1f %% of a %s frame (%.3f ms)",
             c[1].timing.median, 100 * share, cheapest_technique, c[0].timing.median);
    report(b, "untouched_light", text, &c[0].timing, &c[1].timing, share);
  }
  for (int i = 0; i < 2; i++) pn_light_destroy(&lights[i]);
  return status;
}

/* ---- hierarchies: Bitmask Soft Shadows, Table 2 ---- */

enum { HIERARCHIES = 3 };
static const char *const hierarchies[HIERARCHIES] = {"hsm", "mssm", "hybrid"};

static double stage_ms(const struct timing *t, const char *stage) {
  for (int i = 0; i < t->stage_count; i++)
    if (strcmp(t->stages[i].name, stage) == 0) return t->stages[i].milliseconds;
  return NAN;
}

static void report_hierarchy(struct bench *b, int map, const char *hierarchy, const struct timing *t, long long bytes) {
  double ms = stage_ms(t, "range");
  fprintf(b->people, "%5dx%-6d %-10s %12.3f %10.2f\n", map, map, hierarchy, ms, (double)bytes / (1024 * 1024));
  fflush(b->people);
  if (!b->json) return;
  cJSON *all = cJSON_GetObjectItem(b->json, "hierarchies"), *item = cJSON_CreateObject();
  if (!all) all = cJSON_AddArrayToObject(b->json, "hierarchies");
  cJSON_AddItemToArray(all, item);
  cJSON_AddNumberToObject(item, "map", map);
  cJSON_AddStringToObject(item, "hierarchy", hierarchy);
  if (isfinite(ms)) cJSON_AddNumberToObject(item, "build_ms", ms);
  else cJSON_AddNullToObject(item, "build_ms");
  cJSON_AddNumberToObject(item, "bytes", (double)bytes);
  cJSON_AddNumberToObject(item, "frames", t->frames);
}

/* One depth map of that size with each hierarchy: two channels, as in the paper. */
static int bench_hierarchy_size(struct bench *b, int map) {
  struct setup setup = b->host.scene->setup;
  struct contestant c[HIERARCHIES];
  pn_light *lights[HIERARCHIES] = {NULL};
  int status = STATUS_OK;
  setup.map[0] = setup.map[1] = map;
  for (int i = 0; i < HIERARCHIES && !status; i++) {
    char spec[80];
    snprintf(spec, sizeof spec, "bitmask:merge=0,maps=front,primitive=patch,hierarchy=%s", hierarchies[i]);
    c[i] = (struct contestant){.client = b->host.client, .lights = &lights[i], .light_count = 1, .maps_only = 1};
    status = client_light(b->host.client, &setup, &setup.light, spec, &lights[i]);
  }
  if (!status) status = measure(c, HIERARCHIES, b->options->frames, 1);
  for (int i = 0; i < HIERARCHIES && !status; i++)
    report_hierarchy(b, map, hierarchies[i], &c[i].timing, client_range_bytes(b->host.client, lights[i]));
  for (int i = 0; i < HIERARCHIES; i++) pn_light_destroy(&lights[i]);
  return status;
}

static int bench_hierarchies(struct bench *b) {
  int status = STATUS_OK;
  fprintf(b->people, "\n%-12s %-10s %12s %10s\n", "map", "hierarchy", "build, ms", "MiB");
  for (int map = 256; map <= 2048 && !status; map *= 2) status = bench_hierarchy_size(b, map);
  return status;
}

static void print_head(const struct bench *b) {
  const struct scene *scene = b->host.scene;
  const struct setup *setup = &scene->setup;
  fprintf(b->people, "%s: %llu triangles, picture %dx%d, depth map %dx%d\n%s, OpenGL %s\n", scene->name,
          (unsigned long long)scene->triangle_count, setup->size[0], setup->size[1], setup->map[0], setup->map[1],
          device_renderer(b->host.device), device_version(b->host.device));
}

static int run_bench(struct bench *b) {
  const struct options *o = b->options;
  b->specs = technique_choice(o->techniques, o->technique_count, &b->spec_count);
  if (!b->specs) return STATUS_FAILED;
  if (o->json) b->json = result_begin(&b->host);
  if (o->json && !b->json) return memory_error();
  print_head(b);
  int status = STATUS_OK;
  for (int i = 0; i < o->light_count_count && !status; i++) status = bench_techniques(b, o->light_counts[i]);
  if (!status) status = bench_state(b);
  if (!status) status = bench_untouched(b);
  if (!status && o->given[OPTION_HIERARCHIES]) status = bench_hierarchies(b);
  if (!status && b->json) {
    status = write_result(o, b->json);
    b->json = NULL;
  }
  return status;
}

int command_bench(const struct options *o) {
  struct bench b = {.options = o, .people = options_people(o)};
  struct scene *scene = NULL;
  struct claims claims = {NULL, 0};
  int status = claim_options(&claims, o);
  claims_free(&claims);
  if (!status && o->json) status = output_check(o->json);
  if (!status) status = options_scene(o, o->positional_count ? o->positionals[0] : default_scene, &scene);
  if (!status) status = host_open(scene, o->device, &b.host);
  if (!status) status = run_bench(&b);
  cJSON_Delete(b.json);
  free(b.specs);
  host_close(&b.host);
  scene_free(&scene);
  return status;
}
