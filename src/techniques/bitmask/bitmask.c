#include <stdio.h>

#include "search/parameters.h"
#include "techniques/technique.h"

enum { PRESET, SAMPLES, PRIMITIVE, MAPS, LAYERS, HIERARCHY, CAP, MERGE, EDGES, FOCUS, SMOOTH, PASS, COUNT };
enum { SAMPLES_16J, SAMPLES_8, SAMPLES_16, SAMPLES_32 };
enum { PASS_BOUNDED, PASS_PAPER };
enum { MAPS_FRONT, MAPS_TWO_SIDED, MAPS_LAYERS };

static const char *const presets[] = {"fast", "good", "exact", "paper", NULL};
static const char *const samples[] = {"16j", "8", "16", "32", NULL};
static const char *const primitives[] = {"patch", "quad", "quad-exact", NULL};
static const char *const maps[] = {"front", "two-sided", "layers", NULL};

static const char *const passes[] = {"bounded", "paper", NULL};

static const pn_parameter parameters[COUNT] = {
    [PRESET] = {"preset", "", "sets the others; what is named besides it goes over it", "docs/techniques/bitmask.md",
                PN_CHOICE, 0, 3, 1, presets},
    [SAMPLES] = {"samples", "", "points on the light: N x N, or 16 x 16 jittered", "section 3, Fig. 3", PN_CHOICE, 0, 3,
                 SAMPLES_16J, samples},
    [PRIMITIVE] = {"primitive", "",
                   "what texels stand for: rectangles, or quads between texel centres, covered by the paper's "
                   "rectangle or exactly",
                   "section 4", PN_CHOICE, 0, 2, PNI_PRIMITIVE_QUAD, primitives},
    [MAPS] = {"maps", "", "nearest surface, nearest and farthest, or peeled layers", "section 3.2", PN_CHOICE, 0, 2,
              MAPS_TWO_SIDED, maps},
    [LAYERS] = {"layers", "", "how many layers are peeled, with maps=layers", "section 3.2", PN_INT, 1, PNI_LAYERS_MAX,
                2, NULL},
    [HIERARCHY] = PNI_PARAMETER_HIERARCHY("section 5"),
    [CAP] = PNI_PARAMETER_CAP("section 7"),
    [MERGE] = PNI_PARAMETER_MERGE,
    [EDGES] = PNI_PARAMETER_EDGES,
    [FOCUS] = PNI_PARAMETER_FOCUS,
    [SMOOTH] = {"smooth", "passes", "passes over the result that smooth its steps, driven by the accumulated area",
                "section 3.1", PN_INT, 0, 16, 0, NULL},
    [PASS] = {"pass", "",
              "of smooth: where visibility changes slowly, within one surface, by at most half a row of sample points; "
              "or the paper's",
              "section 3.1; docs/techniques/bitmask.md", PN_CHOICE, 0, 1, PASS_BOUNDED, passes},
};

static void preset(int choice, double *values) {
  for (int i = 0; i < COUNT; i++) values[i] = parameters[i].initial;
  values[PRESET] = choice;
  if (choice == 0) { /* fast */
    values[PRIMITIVE] = PNI_PRIMITIVE_PATCH;
    values[MERGE] = 4;
  }
  if (choice == 2) { /* exact */
    values[SAMPLES] = SAMPLES_32;
    values[PRIMITIVE] = PNI_PRIMITIVE_QUAD_EXACT;
    values[MAPS] = MAPS_LAYERS;
    values[LAYERS] = 10;
    values[MERGE] = 0.5;
  }
  if (choice == 3) { /* paper */
    values[MAPS] = MAPS_FRONT;
    values[MERGE] = 0;
    values[CAP] = 18; /* its Table 3 */
    values[EDGES] = 0;
    values[SMOOTH] = 5; /* its Fig. 3 */
    values[PASS] = PASS_PAPER;
  }
}

static pni_search_values search_values(const double *values) {
  return (pni_search_values){.primitive = (pni_primitive)values[PRIMITIVE],
                             .hierarchy = (pni_hierarchy)values[HIERARCHY],
                             .gaps = false,
                             .edges = values[EDGES] != 0,
                             .merge = values[MERGE],
                             .cap = (int)values[CAP]};
}

static void want(const double *values, pni_maps_want *out) {
  pni_search_values search = search_values(values);
  int kind = (int)values[MAPS];
  *out = (pni_maps_want){.near_layers = kind == MAPS_LAYERS ? (int)values[LAYERS] : 1,
                         .farthest = kind == MAPS_TWO_SIDED,
                         .focus = pni_search_focus(values[FOCUS]),
                         .range = pni_search_range(&search)};
}

static void defines(const double *values, char *out, size_t size) {
  static const int codes[] = {[SAMPLES_16J] = 17, [SAMPLES_8] = 8, [SAMPLES_16] = 16, [SAMPLES_32] = 32};
  pni_search_values search = search_values(values);
  int length = pni_search_defines(&search, out, size);
  snprintf(out + length, size - (size_t)length, "PN_SAMPLES %d\n", codes[(int)values[SAMPLES]]);
}

/* An edge parallel to the light's lies at most half a row of sample points beside where counting them puts it. Where
 * visibility goes by more than a row from a pixel to the next but one, no steps of it could be seen. */
static pni_smoothing smoothing_of(const double *values) {
  static const float counts[] = {[SAMPLES_16J] = 16, [SAMPLES_8] = 8, [SAMPLES_16] = 16, [SAMPLES_32] = 32};
  float row = 1 / counts[(int)values[SAMPLES]];
  pni_smoothing bounded = {(int)values[SMOOTH], .way = 2 / 3.0F, .most = row / 2, .steepest = row, true};
  pni_smoothing paper = {(int)values[SMOOTH], .way = 1, .most = 1, .steepest = 1};
  return values[PASS] == PASS_PAPER ? paper : bounded;
}

/* What it keeps for a pair. */
typedef struct {
  pni_search_state search;
  pni_texture smoothed[2];
} pair_state;

static void release(pni_gpu *gpu, void *state, bool abandon) {
  pair_state *s = state;
  for (int i = 0; i < 2; i++) pni_texture_free(gpu, &s->smoothed[i], abandon);
}

/* With smooth=1 what is smoothed; past that, what the last pass smooths or the one before it. */
static const pni_texture *image(const void *state, int index, const char **name) {
  *name = "smoothed";
  return index == 0 ? &((const pair_state *)state)->smoothed[0] : NULL;
}

static pn_result draw(const pni_job *job) {
  pair_state *state = job->pair_state;
  pni_search_values search = search_values(job->values);
  pni_search_tell(job, &state->search, &search);
  pni_smoothing smoothing = smoothing_of(job->values);
  return smoothing.passes ? pni_gather_smoothed(job, &smoothing, state->smoothed) : pni_gather(job);
}

const pni_technique_class pni_technique_bitmask = {
    .table = {.name = "bitmask",
              .title = "bitmask soft shadows",
              .help = "every occluder sets the bits of the light's sample points it hides; occluders fuse correctly",
              .parameters = parameters,
              .parameter_count = COUNT,
              .forward = 1,
              .self_shadows = 1},
    .want = want,
    .preset = preset,
    .draw = draw,
    .gathering = {.shader = "techniques/bitmask/bitmask.glsl", .defines = defines, .searches = true},
    .pair_kind = {.bytes = sizeof(pair_state), .release = release, .image = image},
};
