/* A technique with more parameters than any other: its shader reads the last one by name. */
#include "techniques/technique.h"

#define PARAMETER(name) \
  { name, "", "one of many", "none", PN_FLOAT, 0, 1, 0.5, NULL }

enum { COUNT = 20 };

static const pn_parameter parameters[COUNT] = {
    PARAMETER("first"),       PARAMETER("second"),     PARAMETER("third"),      PARAMETER("fourth"),
    PARAMETER("fifth"),       PARAMETER("sixth"),      PARAMETER("seventh"),    PARAMETER("eighth"),
    PARAMETER("ninth"),       PARAMETER("tenth"),      PARAMETER("eleventh"),   PARAMETER("twelfth"),
    PARAMETER("thirteenth"),  PARAMETER("fourteenth"), PARAMETER("fifteenth"),  PARAMETER("sixteenth"),
    PARAMETER("seventeenth"), PARAMETER("eighteenth"), PARAMETER("nineteenth"), PARAMETER("twentieth"),
};

static void want(const double *values, pni_maps_want *out) {
  (void)values;
  *out = (pni_maps_want){.near_layers = 1};
}

const pni_technique_class pni_technique_many = {
    .table = {.name = "many",
              .title = "many parameters",
              .help = "visibility is what the twentieth says",
              .parameters = parameters,
              .parameter_count = COUNT,
              .forward = 1,
              .self_shadows = 1},
    .want = want,
    .draw = pni_gather,
    .gathering = {.shader = "techniques/many/many.glsl"},
};
