/* Encoded normals come back as the directions that they were: encoders written here, the octahedral one by projecting
 * on |x| + |y| + |z| = 1 and unfolding the lower half as a sheet of paper, by reflection in its edge. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "glsl_call.h"

enum { COUNT = 4096 };
static float in[COUNT][4];
static vec truth[COUNT];

static vec encode(vec n, pn_normal_encoding encoding) {
  if (encoding == PN_NORMAL_SIGNED) return n;
  if (encoding == PN_NORMAL_UNSIGNED) return v3(n.x / 2 + 0.5, n.y / 2 + 0.5, n.z / 2 + 0.5);
  double size = fabs(n.x) + fabs(n.y) + fabs(n.z), x = n.x / size, y = n.y / size;
  if (n.z < 0) {
    /* The edge x sx + y sy = 1 of the quadrant: a point at a distance of h before it goes as far behind it. */
    double sx = x < 0 ? -1 : 1, sy = y < 0 ? -1 : 1, h = 1 - x * sx - y * sy;
    x += h * sx, y += h * sy;
  }
  return encoding == PN_NORMAL_OCTAHEDRON ? v3(x, y, 0) : v3(x / 2 + 0.5, y / 2 + 0.5, 0);
}

static void check(pn_normal_encoding encoding) {
  static const char *const paths[] = {"shaders/precision.glsl", "receiver/surface.glsl", NULL};
  static const char text[] =
      "void call() { vec3 n = normalize(pn_decode_normal(taken(0)));\n"
      "  results[0] = uvec4(floatBitsToUint(n.x), floatBitsToUint(n.y), floatBitsToUint(n.z), 0u); }";
  char defines[64];
  snprintf(defines, sizeof defines, "PN_NORMALS %d\nPN_MASK 0\n", (int)encoding + 1);
  stage s;
  stage_open(&s);
  uint64_t seed = 5 + (uint64_t)encoding;
  for (int i = 0; i < COUNT; i++) {
    truth[i] = random_direction(&seed);
    vec e = encode(truth[i], encoding);
    in[i][0] = (float)e.x, in[i][1] = (float)e.y, in[i][2] = (float)e.z;
  }
  uint32_t *out = glsl_call(&s, &(glsl_function){paths, defines, text}, in[0], 1, COUNT);
  for (int i = 0; i < COUNT; i++) {
    float n[3];
    memcpy(n, out + 32 * i, sizeof n);
    vec off = v3(n[0] - truth[i].x, n[1] - truth[i].y, n[2] - truth[i].z);
    if (!(length(off) < 1e-5))
      fail_msg("encoding %d: (%g, %g, %g) comes back as (%g, %g, %g)", (int)encoding, truth[i].x, truth[i].y,
               truth[i].z, n[0], n[1], n[2]);
  }
  free(out);
  stage_close(&s);
}

static void test_every_encoding(void **state) {
  (void)state;
  for (int i = PN_NORMAL_SIGNED; i <= PN_NORMAL_OCTAHEDRON_UNSIGNED; i++) check((pn_normal_encoding)i);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_encoding)};
  return GL_RUN("encoded normals", tests);
}
