#include "techniques/technique.h"

static const char *const filters[] = {"box", "bicubic", NULL};

static const pn_parameter parameters[] = {
    {"filter", "", "shape of the neighbourhood that is averaged: box of taps x taps, or cubic B-spline of 4 x 4",
     "Reeves et al. 1987", PN_CHOICE, 0, 1, 0, filters},
    {"taps", "texels", "width of the box", "Reeves et al. 1987", PN_INT, 1, 64, 5, NULL},
};

static void want(const double *values, pni_maps_want *out) {
  (void)values;
  *out = (pni_maps_want){.near_layers = 1};
}

const pni_technique_class pni_technique_pcf = {
    .table = {.name = "pcf",
              .title = "percentage-closer filtering",
              .help = "a hard shadow with its edge smoothed over some texels, whatever the light's size",
              .parameters = parameters,
              .parameter_count = 2,
              .forward = 1,
              .self_shadows = 1},
    .want = want,
    .draw = pni_gather,
    .gathering = {.shader = "techniques/pcf/pcf.glsl"},
};
