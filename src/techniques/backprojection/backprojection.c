#include "search/parameters.h"
#include "techniques/technique.h"

enum { PRESET, PRIMITIVE, GAPS, LAYERS, HIERARCHY, CAP, MERGE, EDGES, FOCUS, COUNT };

static const char *const presets[] = {"fast", "good", "exact", NULL};
static const char *const primitives[] = {"patch", "quad", NULL};

static const pn_parameter parameters[COUNT] = {
    [PRESET] = {"preset", "", "sets the others; what is named besides it goes over it",
                "docs/techniques/backprojection.md", PN_CHOICE, 0, 2, 1, presets},
    [PRIMITIVE] = {"primitive", "", "what texels stand for: rectangles, or quads between texel centres",
                   "Bitmask Soft Shadows, section 4", PN_CHOICE, 0, 1, PN_PRIMITIVE_PATCH, primitives},
    [GAPS] = {"gaps", "", "patches are widened to meet their left and lower neighbours", "Guennebaud et al. 2006",
              PN_BOOL, 0, 1, 1, NULL},
    [LAYERS] = {"layers", "", "peeled layers, merged by maximum", "Bitmask Soft Shadows, Fig. 9d", PN_INT, 1,
                PN_LAYERS_MAX, 1, NULL},
    [HIERARCHY] = PN_PARAMETER_HIERARCHY("Bitmask Soft Shadows, section 5"),
    [CAP] = PN_PARAMETER_CAP("Guennebaud et al. 2006"),
    [MERGE] = PN_PARAMETER_MERGE,
    [EDGES] = PN_PARAMETER_EDGES,
    [FOCUS] = PN_PARAMETER_FOCUS,
};

static void preset(int choice, double *values) {
  for (int i = 0; i < COUNT; i++) values[i] = parameters[i].initial;
  values[PRESET] = choice;
  if (choice == 0) values[MERGE] = 2;    /* fast */
  if (choice == 2) values[MERGE] = 0.25; /* exact */
}

static pn_search_values search_values(const double *values) {
  return (pn_search_values){.primitive = (pn_primitive)values[PRIMITIVE],
                            .hierarchy = (pn_hierarchy)values[HIERARCHY],
                            .gaps = values[GAPS] != 0 && values[PRIMITIVE] == PN_PRIMITIVE_PATCH,
                            .edges = values[EDGES] != 0,
                            .merge = values[MERGE],
                            .merge_index = MERGE,
                            .cap_index = CAP};
}

static void want(const double *values, pn_maps_want *out) {
  pn_search_values search = search_values(values);
  *out = (pn_maps_want){
      .near_layers = (int)values[LAYERS], .focus = pn_search_focus(values[FOCUS]), .range = pn_search_range(&search)};
}

static void defines(const double *values, char out[PN_TECHNIQUE_DEFINES]) {
  pn_search_values search = search_values(values);
  pn_search_defines(&search, out, PN_TECHNIQUE_DEFINES);
}

const pn_technique_class pn_technique_backprojection = {
    .table = {.name = "backprojection",
              .title = "soft shadow mapping by backprojection",
              .help = "adds up what every micro-primitive of one map hides of the light; overlaps count twice",
              .parameters = parameters,
              .parameter_count = COUNT,
              .forward = 1,
              .self_shadows = 1},
    .want = want,
    .preset = preset,
    .shader = "techniques/backprojection/backprojection.glsl",
    .defines = defines,
    .searches = true,
};
