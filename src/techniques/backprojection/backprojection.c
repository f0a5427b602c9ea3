#include "search/parameters.h"
#include "techniques/technique.h"

enum { PRESET, PRIMITIVE, GAPS, LAYERS, HIERARCHY, CAP, MERGE, EDGES, FOCUS, COUNT };

static const char *const presets[] = {"fast", "good", "exact", "paper", NULL};
static const char *const primitives[] = {"patch", "quad", NULL};

static const pn_parameter parameters[COUNT] = {
    [PRESET] = {"preset", "", "sets the others; what is named besides it goes over it",
                "docs/techniques/backprojection.md", PN_CHOICE, 0, 3, 1, presets},
    [PRIMITIVE] = {"primitive", "", "what texels stand for: rectangles, or quads between texel centres",
                   "Bitmask Soft Shadows, section 4", PN_CHOICE, 0, 1, PNI_PRIMITIVE_QUAD, primitives},
    [GAPS] = {"gaps", "", "patches are widened to meet their left and lower neighbours, with merge=0",
              "Guennebaud et al. 2006", PN_BOOL, 0, 1, 1, NULL},
    [LAYERS] = {"layers", "", "peeled layers, merged by maximum", "Bitmask Soft Shadows, Fig. 9d", PN_INT, 1,
                PNI_LAYERS_MAX, 1, NULL},
    [HIERARCHY] = PNI_PARAMETER_HIERARCHY("Bitmask Soft Shadows, section 5"),
    [CAP] = PNI_PARAMETER_CAP("Guennebaud et al. 2006"),
    [MERGE] = PNI_PARAMETER_MERGE,
    [EDGES] = PNI_PARAMETER_EDGES,
    [FOCUS] = PNI_PARAMETER_FOCUS,
};

static void preset(int choice, double *values) {
  for (int i = 0; i < COUNT; i++) values[i] = parameters[i].initial;
  values[PRESET] = choice;
  if (choice == 0 || choice == 3) values[PRIMITIVE] = PNI_PRIMITIVE_PATCH;
  if (choice == 0) values[MERGE] = 2;    /* fast */
  if (choice == 2) values[MERGE] = 0.25; /* exact */
  if (choice == 3) {                     /* paper */
    values[HIERARCHY] = PNI_HIERARCHY_HSM;
    values[MERGE] = 0;
    values[CAP] = 18; /* Bitmask Soft Shadows, Table 3 */
    values[EDGES] = 0;
  }
}

static pni_search_values search_values(const double *values) {
  return (pni_search_values){.primitive = (pni_primitive)values[PRIMITIVE],
                             .hierarchy = (pni_hierarchy)values[HIERARCHY],
                             .gaps = values[GAPS] != 0 && values[PRIMITIVE] == PNI_PRIMITIVE_PATCH,
                             .edges = values[EDGES] != 0,
                             .merge = values[MERGE],
                             .cap = (int)values[CAP]};
}

static void want(const double *values, pni_maps_want *out) {
  pni_search_values search = search_values(values);
  *out = (pni_maps_want){
      .near_layers = (int)values[LAYERS], .focus = pni_search_focus(values[FOCUS]), .range = pni_search_range(&search)};
}

static void defines(const double *values, char *out, size_t size) {
  pni_search_values search = search_values(values);
  pni_search_defines(&search, out, size);
}

static pn_result draw(const pni_job *job) {
  pni_search_values search = search_values(job->values);
  pni_search_tell(job, job->pair_state, &search);
  return pni_gather(job);
}

const pni_technique_class pni_technique_backprojection = {
    .table = {.name = "backprojection",
              .title = "soft shadow mapping by backprojection",
              .help = "adds up what every micro-primitive of one map hides of the light; overlaps count twice",
              .parameters = parameters,
              .parameter_count = COUNT,
              .forward = 1,
              .self_shadows = 1},
    .want = want,
    .preset = preset,
    .draw = draw,
    .gathering = {.shader = "techniques/backprojection/backprojection.glsl", .defines = defines, .searches = true},
    .pair_kind = {.bytes = sizeof(pni_search_state)},
};
