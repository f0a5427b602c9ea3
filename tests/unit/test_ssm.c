/* Soft shadow maps: lists of micropatches from GPU and CPU, a plate's closed form, sums in 16 bits, the error's bound,
 * which faces cast, and scenes that ask for trouble. */
#include <stdlib.h>
#include <string.h>

#include "gl/host.h"
#include "light.h"
#include "over_ground.h"
#include "techniques/ssm/ssm.h"

static const double half_u = 0.5, half_v = 0.3, plate = 0.6, plate_h = 1.5;

enum { SIZE = 48 };

typedef over_ground scene;

static void scene_open(scene *c, double half_height) { over_ground_open(c, SIZE, half_height); }

static pn_light_desc light_above(int map) { return light_over_ground(half_u, half_v, map); }

static void add_plate(scene *c) { soup_patch(&c->casters, v3(0, plate_h, 0), v3(plate, 0, 0), v3(0, 0, plate)); }

/* Boxes at several heights, and a tilted plate: blocks that merge and blocks that do not. */
static void add_clutter(scene *c) {
  add_plate(c);
  soup_box(&c->casters, v3(-1.2, 0.3, -1), v3(-0.8, 1.1, -0.2));
  soup_quad(&c->casters, v3(0.7, 0.4, -0.8), v3(0.5, 0.5, 0), v3(0, 0.2, 1.1));
}

/* ---- lists ------------------------------------------------------------------------------------------------------- */

/* The list that the last draw left, of its last side and layer: 8 floats an entry. */
static float *read_list(const pni_ssm_state *state, int count) {
  float *out = malloc((size_t)(count ? count : 1) * 8 * sizeof *out);
  for (int half = 0; half < 2; half++) {
    const pni_texture *t = half ? &state->limits : &state->list;
    float *texels = gl_read_texture(t->id, 0, -1, t->width, t->height, 4);
    for (int i = 0; i < count; i++) memcpy(out + 8 * i + 4 * half, texels + 4 * i, 4 * sizeof *out);
    free(texels);
  }
  return out;
}

static int gpu_total(const pni_ssm_state *state) {
  const pni_texture *t = &state->counts;
  GLuint top[4] = {0};
  glBindTexture(GL_TEXTURE_2D, t->id);
  glGetTexImage(GL_TEXTURE_2D, t->levels - 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT, top);
  return (int)(top[0] & 0x7fffffffu);
}

/* The same patches in the same order. What they serve follows from float arithmetic that two compilers may order
 * differently, and the farthest receiver in reach from one comparison with a texel's border: both to a part in 10^5. */
static void check_lists(const char *spec, int map) {
  scene c = {0};
  add_clutter(&c);
  scene_open(&c, 2.2);
  pn_light_desc light = light_above(map);
  free(stage_visibility(&c.s, &light, spec));
  pni_pair *pair = pni_pair_find(&c.s.light->object, &c.s.receiver->object);
  assert_non_null(pair);
  pni_ssm_state *kept = pair->kept.state;
  int count = gpu_total(kept), cpu_count;
  float *gpu = read_list(kept, count);
  pni_job job = {.gpu = &c.s.context->gpu, .maps = &c.s.light->maps, .pair_state = kept};
  pni_ssm_list list = {
      .job = &job, .state = kept, .layer = pni_want_layers(&job.maps->want) - 1, .share = c.s.light->values[5] / 100};
  pni_enter(c.s.context);
  assert_ok(pni_leave(c.s.context, pni_ssm_cpu_list(&list, &cpu_count)));
  float *cpu = read_list(kept, cpu_count);
  print_message("%s, %d: %d and %d patches\n", spec, map, count, cpu_count);
  assert_true(count > 0);
  int different = 0;
  for (int i = 0; i < count && i < cpu_count; i++)
    for (int k = 0; k < 7; k++) different += fabs(gpu[8 * i + k] - cpu[8 * i + k]) > 1e-5 * fabs(cpu[8 * i + k]);
  assert_int_equal(count, cpu_count);
  assert_true(different <= count / 1000);
  free(gpu);
  free(cpu);
  over_ground_close(&c);
}

static void gpu_and_cpu_lists_agree(void **state) {
  (void)state;
  check_lists("ssm:merge=0,layers=1,sides=front", 64);
  check_lists("ssm:merge=0,layers=1", 61);
  check_lists("ssm:merge=1,layers=1,sides=front", 128);
  check_lists("ssm:merge=5,layers=1,size=50", 128);
}

/* ---- a plate parallel to the light ------------------------------------------------------------------------------- */

/* A texel of a map of something at that height, on the light, as the ground sees it. */
static double texel_on_light(double texel, double h) { return texel * (LIGHT_HEIGHT - h) * LIGHT_HEIGHT / h; }

/* Each of two edges an axis moves by half an occluder texel and the raster's snapping; the soft shadow map is looked up
 * bilinearly, which cuts the corners of the ramps by a quarter of its texels. A product of two shares, each at most 1,
 * is off by at most the sum of what they are off. */
static double texels_allow(const scene *c, double h) {
  pn_maps_info info;
  pn_soft_shadow_map soft;
  assert_ok(pn_light_maps(c->s.light, &info));
  assert_ok(pn_soft_shadow_map_image(c->s.light, c->s.receiver, &soft));
  double texel = fmax(info.s1 - info.s0, info.t1 - info.t0) / info.width;
  double moved = 2 * (0.5 + 1.0 / 128) * texel_on_light(texel, h);
  double cut = 2 * 0.25 * texel_on_light(fmax(soft.s1 - soft.s0, soft.t1 - soft.t0) / soft.image.width, h);
  return (moved + cut) * (1 / (2 * half_u) + 1 / (2 * half_v)) + 1e-4;
}

static double hidden_by(vec p, double size, double h) {
  return hidden_by_plate(p.x, half_u, size, h) * hidden_by_plate(p.z, half_v, size, h);
}

/* The largest difference from the closed form, and what texels allow. */
static double check_plate(const char *spec, bool sum_in_16_bits, double *allowed) {
  scene c = {0};
  add_plate(&c);
  scene_open(&c, 2.2);
  pn_light_desc light = light_above(128);
  float *visibility = stage_visibility(&c.s, &light, spec);
  double worst = 0;
  *allowed = texels_allow(&c, plate_h);
  for (int k = 0; k < SIZE * SIZE; k++) {
    vec p = view_point(&c.v, k % SIZE, k / SIZE);
    worst = fmax(worst, fabs(visibility[k] - 1 + hidden_by(p, plate, plate_h)));
    assert_true(visibility[k] >= 0 && visibility[k] <= 1);
  }
  print_message("%s: off by %.4f, texels allow %.4f\n", spec, worst, *allowed);
  assert_int_equal(c.s.messages[PN_MESSAGE_ACCUMULATION], sum_in_16_bits);
  free(visibility);
  over_ground_close(&c);
  return worst;
}

/* Eq. 4 is of the finest texels: under a light close to a wide plate there are nine tiles, that in the middle the
 * finest. Light by light, the warning comes where a texel of it hides less than 2^-10, as densities in GLSL's block
 * have it; for some of the lights the first tile's do not. */
static void warning_is_of_the_finest_tile(void **state) {
  (void)state;
  int between = 0;
  for (int i = 0; i < 12; i++) {
    scene c = {0};
    soup_patch(&c.casters, v3(0, 3, 0), v3(20, 0, 0), v3(0, 0, 20));
    scene_open(&c, 2.2);
    double half = 0.2 * pow(1.25, i);
    pn_light_desc light = light_over_ground(half, half, 64);
    light.fit = PN_FIT_CASTERS;
    free(stage_visibility(&c.s, &light, "ssm:accumulate=fp16,sides=front,layers=1,size=16"));
    const pni_maps *maps = &c.s.light->maps;
    double finest = INFINITY, first = 0;
    for (int m = 0; m < maps->fit.tiles; m++) {
      double area = 1 / ((double)maps->block.maps[m].density[0] * (double)maps->block.maps[m].density[1]);
      finest = fmin(finest, area);
      if (m == 0) first = area;
    }
    /* The plate is at w = 1, which the map rounds up, the ground at w = 1 / 4. */
    double depth = maps->fit.w_near - 0.25, hides = 1 / (4 * half * half * depth * depth);
    assert_true(maps->fit.tiles == 9);
    if (fabs(finest * hides - 0x1p-10) > 0.02 * 0x1p-10)
      assert_int_equal(c.s.messages[PN_MESSAGE_ACCUMULATION], finest * hides < 0x1p-10);
    between += finest * hides < 0x1p-10 && first * hides >= 0x1p-10;
    over_ground_close(&c);
  }
  assert_true(between > 0);
}

static void parallel_plate_has_its_closed_form(void **state) {
  (void)state;
  static const char *const specs[] = {"ssm",
                                      "ssm:merge=0",
                                      "ssm:sides=front",
                                      "ssm:sides=back,merge=0.25",
                                      "ssm:extents=cpu",
                                      "ssm:size=77",
                                      "ssm:size=300,layers=1",
                                      "ssm:accumulate=fp16-batched,merge=0"};
  for (size_t i = 0; i < sizeof specs / sizeof *specs; i++) {
    double allowed;
    assert_true(check_plate(specs[i], false, &allowed) <= allowed + (strstr(specs[i], "fp16") ? 0.01 : 0));
  }
}

/* ---- which faces cast -------------------------------------------------------------------------------------------- */

/* Single sheets: one that looks away from the light above a larger one that looks at it. */
static const double away_size = 0.35, away_h = 2.4, at_size = 0.5, at_h = 1;

static void add_sheets(soup *to) {
  soup_patch(to, v3(0, away_h, 0), v3(away_size, 0, 0), v3(0, 0, away_size));
  soup_patch(to, v3(0, at_h, 0), v3(0, 0, at_size), v3(at_size, 0, 0));
}

/* The larger of what the two hide, each where it is in one of the maps. */
static void check_sheets(const char *spec, bool away, bool at) {
  scene c = {0};
  add_sheets(&c.casters);
  scene_open(&c, 2.2);
  pn_light_desc light = light_above(128);
  float *visibility = stage_visibility(&c.s, &light, spec);
  double worst = 0, allowed = fmax(away ? texels_allow(&c, away_h) : 0, at ? texels_allow(&c, at_h) : 0);
  for (int k = 0; k < SIZE * SIZE; k++) {
    vec p = view_point(&c.v, k % SIZE, k / SIZE);
    double hidden = fmax(away ? hidden_by(p, away_size, away_h) : 0, at ? hidden_by(p, at_size, at_h) : 0);
    worst = fmax(worst, fabs(visibility[k] - 1 + hidden));
  }
  print_message("%s: off by %.4f, texels allow %.4f\n", spec, worst, allowed);
  assert_true(allowed < 0.25);
  assert_true(worst <= allowed);
  free(visibility);
  over_ground_close(&c);
}

/* Section 3.5: the nearest of the faces that look at the light, the farthest of those that look away. Of all faces the
 * near map has the upper sheet, which looks away, and the far map the lower one; so neither has its closed form. */
static void culled_maps_have_the_faces_of_their_side(void **state) {
  (void)state;
  check_sheets("ssm:faces=culled,sides=front", false, true);
  check_sheets("ssm:faces=culled,sides=back", true, false);
  check_sheets("ssm:faces=culled,merge=0", true, true);
}

/* A sheet that looks away from the light casts by way of the far map alone. */
static void sheets_that_look_away_cast_from_the_far_map(void **state) {
  (void)state;
  static const char *const specs[] = {"ssm:faces=culled,sides=front", "ssm:faces=culled,sides=back", "ssm:faces=culled",
                                      "ssm:sides=front"};
  scene c = {0};
  add_plate(&c);
  scene_open(&c, 2.2);
  pn_light_desc light = light_above(128);
  for (size_t i = 0; i < sizeof specs / sizeof *specs; i++) {
    float *visibility = stage_visibility(&c.s, &light, specs[i]);
    for (int k = 0; k < SIZE * SIZE; k++) {
      double hidden = i ? hidden_by(view_point(&c.v, k % SIZE, k / SIZE), plate, plate_h) : 0;
      assert_true(fabs(visibility[k] - 1 + hidden) <= (i ? texels_allow(&c, plate_h) : 0));
    }
    free(visibility);
  }
  over_ground_close(&c);
}

/* The same sheets, to one side, with their mirror image made of triangles or by the instance's matrix. Winding comes
 * along with triangles; a matrix turns it round. */
static float *mirrored_sheets(bool by_matrix, bool clockwise) {
  static const float matrix[16] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -0.8f, 0, 0, 1};
  scene c = {0};
  soup sheets = {0};
  add_sheets(&sheets);
  for (int i = 0; i < sheets.count; i++)
    for (int k = 0; k < 3; k++) {
      float *x = sheets.list[i].p[k];
      *x += 0.2f * x[1]; /* not its own mirror image */
      if (!by_matrix) *x = -*x - 0.8f;
    }
  for (int i = 0; i < sheets.count && by_matrix == clockwise; i++) {
    triangle t = sheets.list[i];
    memcpy(sheets.list[i].p[1], t.p[2], sizeof t.p[2]);
    memcpy(sheets.list[i].p[2], t.p[1], sizeof t.p[1]);
  }
  scene_open(&c, 2.2);
  const pn_mesh_desc desc = {.positions = {.data = sheets.list, .count = 3 * (size_t)sheets.count},
                             .clockwise = clockwise};
  static const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  pn_mesh mesh;
  assert_ok(pn_mesh_add(c.s.casters, &desc, &mesh));
  assert_ok(pn_instance_add(c.s.casters, mesh, by_matrix ? matrix : identity, 0, NULL));
  pn_light_desc light = light_above(128);
  float *visibility = stage_visibility(&c.s, &light, "ssm:faces=culled,sides=front,size=128");
  soup_free(&sheets);
  over_ground_close(&c);
  return visibility;
}

static void mirrored_faces_look_where_their_image_does(void **state) {
  (void)state;
  float *image = mirrored_sheets(false, false), least = 1;
  for (int way = 1; way < 4; way++) {
    float *other = mirrored_sheets(way & 1, way & 2), apart = 0;
    for (int k = 0; k < SIZE * SIZE; k++) {
      apart = fmaxf(apart, fabsf(image[k] - other[k]));
      least = fminf(least, image[k]);
    }
    print_message("mirrored, way %d: %g apart\n", way, (double)apart);
    assert_true(apart <= 1e-4f);
    free(other);
  }
  assert_true(least < 0.5f);
  free(image);
}

/* ---- receivers whose horizon cuts the light ---------------------------------------------------------------------- */

/* A wall, which sees the light on one side of its plane only, below a plate that is parallel to the light and reaches
 * through that plane. */
static const double wall_x = -1.2, wall_top = 1.4, reaches[2] = {-2.2, -0.5}, aside = 0.6, wide_u = 1.5, wide_v = 1;

/* Share of the light above the horizon that the plate hides from beyond that distance before the wall, with its other
 * edges moved outwards. */
static double hidden_from_wall(vec p, double before, double moved) {
  double grows = (LIGHT_HEIGHT - p.y) / fmax(plate_h - p.y, 1e-3);
  double u =
      clamped(wall_x + (reaches[1] + moved - wall_x) * grows, wall_x, wide_u) - fmin(wall_x + before * grows, wide_u);
  double from = clamped(p.z - (aside + moved + p.z) * grows, -wide_v, wide_v);
  double to = clamped(p.z + (aside + moved - p.z) * grows, -wide_v, wide_v);
  return u / (wide_u - wall_x) * (to - from) / (2 * wide_v);
}

/* How far a value lies beside the closed form's, where texels move the plate's edges, half of one, and the receiver: dy
 * and dz are half a texel of the receiver map on the wall. What is lower before the wall than a texel may be the wall
 * itself, whichever map's is larger. */
static double beside_wall(double hidden, vec p, double texel, double dy, double dz) {
  double least = 1, most = 0;
  for (int i = 0; i < 16; i++) {
    vec q = v3(p.x, p.y + (i & 1 ? dy : -dy), p.z + (i & 2 ? dz : -dz));
    double h = hidden_from_wall(q, i & 8 ? 1.5 * texel : 0, (i & 4 ? 0.5 : -0.5) * texel);
    least = fmin(least, h);
    most = fmax(most, h);
  }
  return fmax(least - hidden, hidden - most);
}

static void wall_open(scene *c) {
  soup_quad(&c->ground, v3(wall_x, 0, 1), v3(0, 0, -2), v3(0, wall_top, 0));
  soup_quad(&c->casters, v3(reaches[0], plate_h, -aside), v3(reaches[1] - reaches[0], 0, 0), v3(0, 0, 2 * aside));
  camera k = camera_over_ground(SIZE, 0.6);
  k.eye = v3(4, 0.7, 0);
  k.target = v3(wall_x, 0.7, 0);
  k.up = v3(0, 1, 0);
  over_ground_see(c, &k);
}

/* Half a block at a horizon is no block: what merging changes stays below what it may move edges by, and without it
 * there is the closed form, but for what texels move. */
static void blocks_do_not_cross_horizons(void **state) {
  (void)state;
  scene c = {0};
  wall_open(&c);
  pn_light_desc light = light_over_ground(wide_u, wide_v, 128);
  float *visibility[2];
  for (int i = 0; i < 2; i++) visibility[i] = stage_visibility(&c.s, &light, i ? "ssm:merge=0" : "ssm:merge=5");
  pn_maps_info info;
  pn_soft_shadow_map soft;
  assert_ok(pn_light_maps(c.s.light, &info));
  assert_ok(pn_soft_shadow_map_image(c.s.light, c.s.receiver, &soft));
  double texel = fmax(info.s1 - info.s0, info.t1 - info.t0) / info.width * (LIGHT_HEIGHT - plate_h);
  double ds = (soft.s1 - soft.s0) / soft.image.width, dt = (soft.t1 - soft.t0) / soft.image.height;
  double apart = 0, worst = 0;
  for (int k = 0; k < SIZE * SIZE; k++) {
    vec p = view_point(&c.v, k % SIZE, k / SIZE);
    double z = LIGHT_HEIGHT - p.y, dy = 0.5 * ds * z * z / -wall_x; /* s = wall_x / z */
    apart = fmax(apart, fabs(visibility[0][k] - visibility[1][k]));
    worst = fmax(worst, beside_wall(1 - visibility[1][k], p, texel, dy, 0.5 * dt * z));
  }
  print_message("wall: %.4f beside the closed form at most; merging changes %.4f\n", worst, apart);
  assert_true(worst <= 0.003);
  assert_true(apart <= 0.002);
  for (int i = 0; i < 2; i++) free(visibility[i]);
  over_ground_close(&c);
}

/* ---- coarse normals ---------------------------------------------------------------------------------------------- */

/* The ground's normals in eight bits, in place of exact ones. */
static GLuint receive_coarse_normals(scene *c) {
  unsigned char up[SIZE * SIZE][4];
  for (int k = 0; k < SIZE * SIZE; k++) memcpy(up[k], (const unsigned char[4]){128, 255, 128, 255}, 4);
  GLuint texture;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, SIZE, SIZE, 0, GL_RGBA, GL_UNSIGNED_BYTE, up);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  pn_receiver_desc desc = view_desc(&c->v, false);
  desc.normal_texture = texture;
  desc.normal_encoding = PN_NORMAL_UNSIGNED;
  assert_ok(pn_receiver_set(c->s.receiver, &desc));
  return texture;
}

static double hidden_of_sun(double x, double half) {
  return (clamped((plate - x) / plate_h, -half, half) - clamped((-plate - x) / plate_h, -half, half)) / (2 * half);
}

/* What a normal's angle may be off by counts for each sample as far as it is away. Something high up, off to a side
 * where it shades nothing that is seen, takes no other caster's shadow. */
static void near_casters_leave_far_ones_their_shadow(void **state) {
  (void)state;
  const double height = 400, tangent = 0.1, aside_x = 43;
  scene c = {0};
  add_plate(&c);
  soup_patch(&c.casters, v3(aside_x, height, 0), v3(0.1, 0, 0), v3(0, 0, 0.1));
  scene_open(&c, 2.2);
  GLuint normals = receive_coarse_normals(&c);
  pn_light_desc light = sun_along(v3(0, -1, 0), tangent, tangent, 4096);
  light.map_height = 128;
  light.fit = PN_FIT_CASTERS;
  float *visibility = stage_visibility(&c.s, &light, "ssm:size=128");
  pn_maps_info info;
  assert_ok(pn_light_maps(c.s.light, &info));
  assert_true(info.s1 - info.s0 > aside_x); /* the map has both */
  double texel = fmax((info.s1 - info.s0) / info.width, (info.t1 - info.t0) / info.height) / plate_h;
  double allowed = 2 * 2 * texel / (2 * tangent), worst = 0;
  for (int k = 0; k < SIZE * SIZE; k++) {
    vec p = view_point(&c.v, k % SIZE, k / SIZE);
    worst = fmax(worst, fabs(visibility[k] - 1 + hidden_of_sun(p.x, tangent) * hidden_of_sun(p.z, tangent)));
  }
  print_message("beside a caster near the sun: off by %.4f, texels allow %.4f\n", worst, allowed);
  assert_true(allowed < 0.5);
  assert_true(worst <= allowed);
  free(visibility);
  glDeleteTextures(1, &normals);
  over_ground_close(&c);
}

/* Appendix A: what is below 2^-10 of a sum near 1 is lost, and these micropatches hide 1/3000 of the light. */
static void sums_in_16_bits_lose_small_patches(void **state) {
  (void)state;
  double allowed;
  assert_true(check_plate("ssm:accumulate=fp16,merge=0", true, &allowed) > 0.1);
}

/* A sum of positive numbers in binary16: the exact one, rounded to 11 bits. GL leaves open how: IEEE 754 rounds to the
 * nearest, to even; Mesa's software towards zero. */
typedef double (*rounding)(double);
static double half_sum(double a, double b, rounding round) {
  int exponent;
  frexp(a + b, &exponent);
  double step = ldexp(1, exponent < -13 ? -24 : exponent - 11);
  return round((a + b) / step) * step;
}

/* What the micropatch of an entry hides from a receiver at (s, t, w). */
static double hidden_by_entry(const pni_light_block *b, const float *entry, const double at[3]) {
  const pni_map_block *map = &b->maps[0];
  double share = 1, beyond = entry[3] - at[2];
  for (int i = 0; i < 2; i++) {
    double low = map->origin[i] + entry[i] / map->density[i], high = low + 1 / map->density[i], half = b->extent[i];
    share *=
        (clamped((high - at[i]) / beyond, -half, half) - clamped((low - at[i]) / beyond, -half, half)) / (2 * half);
  }
  return share;
}

/* What the list's micropatches hide from that receiver, count numbers; returns their exact sum. */
static double list_terms(const pni_light_block *b, const float *list, int count, const double at[3], double *terms) {
  double exact = 0;
  for (int k = 0; k < count; k++) exact += terms[k] = hidden_by_entry(b, list + 8 * (size_t)k, at);
  return exact;
}

/* Their sum in 16 bits, by batches of so many one after the other. */
static double model_sum(const double *terms, int count, int batch, rounding round) {
  double sum = 0;
  for (int first = 0; first < count; first += batch) {
    double part = 0;
    for (int k = first; k < count && k < first + batch; k++) part = half_sum(part, terms[k], round);
    sum = half_sum(sum, part, round);
  }
  return sum;
}

/* The soft shadow map against models of 16-bit sums, at every third texel. Returns how far the map is off the exact
 * sum at most. */
static double check_model(const char *spec, bool by_batches) {
  static const rounding roundings[2] = {nearbyint, trunc};
  scene c = {0};
  add_plate(&c);
  scene_open(&c, 2.2);
  pn_light_desc light = light_above(256);
  free(stage_visibility(&c.s, &light, spec));
  pni_ssm_state *kept = pni_pair_find(&c.s.light->object, &c.s.receiver->object)->kept.state;
  const pni_seen_want *w = &kept->seen.want;
  int count = gpu_total(kept), width = w->width, height = w->height,
      batch = by_batches ? (int)ceil(sqrt(count)) : count;
  float *list = read_list(kept, count), *sums = gl_read_texture(kept->soft.id, 0, 0, width, height, 1);
  float *seen = gl_read_texture(kept->seen.layers.id, 0, 0, width, height, 4);
  double apart[2] = {0, 0}, lost = 0, *terms = malloc((size_t)count * sizeof *terms);
  for (int k = 0; k < width * height; k++) {
    int x = k % width, y = k / width;
    if (x % 3 || y % 3 || pni_is_nothing((double)seen[4 * k])) continue;
    const double at[3] = {w->bounds[0] + (x + 0.5) / width * (w->bounds[2] - w->bounds[0]),
                          w->bounds[1] + (y + 0.5) / height * (w->bounds[3] - w->bounds[1]), (double)seen[4 * k]};
    double exact = list_terms(&c.s.light->maps.block, list, count, at, terms);
    for (int i = 0; i < 2; i++)
      apart[i] = fmax(apart[i], fabs((double)sums[k] - model_sum(terms, count, batch, roundings[i])));
    lost = fmax(lost, fabs((double)sums[k] - exact));
  }
  print_message("%s, %d micropatches: %.5f and %.5f beside the models, %.4f beside the exact sum\n", spec, count,
                apart[0], apart[1], lost);
  assert_true(count > 10000);
  assert_true(fmin(apart[0], apart[1]) <= 0x1p-9); /* terms in float may be rounded to the other side */
  free(list), free(sums), free(seen), free(terms);
  over_ground_close(&c);
  return lost;
}

/* Term by term, batch by batch: plain sums end where a term is less than their last bit. */
static void sums_in_16_bits_are_what_they_say(void **state) {
  (void)state;
  double plain = check_model("ssm:merge=0,sides=front,layers=1,size=48,accumulate=fp16", false);
  double batches = check_model("ssm:merge=0,sides=front,layers=1,size=48,accumulate=fp16-consecutive", true);
  assert_true(batches < plain / 4);
}

static void devices_without_float_blending_sum_by_batches(void **state) {
  (void)state;
  scene c = {0};
  add_clutter(&c);
  scene_open(&c, 2.2);
  pn_light_desc light = light_above(64);
  float *direct = stage_visibility(&c.s, &light, "ssm");
  c.s.context->gpu.can.float_blend = false;
  float *batched = stage_visibility(&c.s, &light, "ssm"), worst = 0;
  for (int k = 0; k < SIZE * SIZE; k++) worst = fmaxf(worst, fabsf(direct[k] - batched[k]));
  assert_int_equal(c.s.messages[PN_MESSAGE_FALLBACK], 1);
  assert_true(worst > 0 && worst < 0.01);
  free(direct);
  free(batched);
  over_ground_close(&c);
}

/* Indirect draws are a shortcut: the same micropatches are drawn without them. */
static void counted_draws_change_nothing(void **state) {
  (void)state;
  scene c = {0};
  add_clutter(&c);
  scene_open(&c, 2.2);
  pn_light_desc light = light_above(64);
  float *counted = stage_visibility(&c.s, &light, "ssm");
  c.s.context->gpu.can.indirect = false;
  float *all = stage_visibility(&c.s, &light, "ssm");
  assert_memory_equal(counted, all, SIZE * SIZE * sizeof *all);
  free(counted);
  free(all);
  over_ground_close(&c);
}

/* ---- the bound --------------------------------------------------------------------------------------------------- */

static float *bound_of(scene *c, const char *spec, float **visibility) {
  pn_light_desc light = light_above(96);
  assert_ok(pn_debug(c->s.context, PN_DEBUG_BOUND));
  *visibility = stage_visibility(&c->s, &light, spec);
  const char *name;
  pn_image image;
  for (int i = 0; pn_debug_image(c->s.light, c->s.receiver, i, &name, &image); i++)
    if (!strcmp(name, "bound")) return gl_read_texture(image.texture, 0, -1, image.width, image.height, 1);
  fail_msg("no bound");
  return NULL;
}

/* Eq. 3 bounds what neighbours at different depths overlap or leave open: nothing on a plate parallel to the light; on
 * two plates at different heights, side by side, it holds the error that their edge makes, beside what texels allow. */
static void bound_holds_overlaps(void **state) {
  (void)state;
  scene flat = {0}, step = {0};
  float *visibility;
  add_plate(&flat);
  scene_open(&flat, 2.2);
  float *bound = bound_of(&flat, "ssm:merge=0", &visibility);
  for (int k = 0; k < SIZE * SIZE; k++) assert_true(bound[k] == 0);
  free(bound);
  free(visibility);
  over_ground_close(&flat);
  soup_patch(&step.casters, v3(-0.5, plate_h, 0), v3(0.5, 0, 0), v3(0, 0, 0.6));
  soup_patch(&step.casters, v3(0.5, plate_h + 0.5, 0), v3(0.5, 0, 0), v3(0, 0, 0.6));
  scene_open(&step, 2.2);
  bound = bound_of(&step, "ssm:merge=0,sides=front", &visibility);
  float most = 0, over = 0;
  for (int k = 0; k < SIZE * SIZE; k++) {
    vec p = view_point(&step.v, k % SIZE, k / SIZE);
    most = fmaxf(most, bound[k]);
    if (hypot(p.x, p.z) < 0.25) over = fmaxf(over, (float)(visibility[k] - bound[k])); /* the truth there is umbra */
  }
  assert_true(most > 0.05 && most <= 1);
  assert_true(over < 0.05);
  free(bound);
  free(visibility);
  over_ground_close(&step);
}

/* ---- trouble ----------------------------------------------------------------------------------------------------- */

static void check_sound(scene *c, const pn_light_desc *light, const char *spec) {
  float *visibility = stage_visibility(&c->s, light, spec);
  for (int k = 0; k < SIZE * SIZE; k++)
    if (!(visibility[k] >= 0 && visibility[k] <= 1)) fail_msg("%s: %g at %d", spec, (double)visibility[k], k);
  free(visibility);
}

static void bad_scenes_stay_sound(void **state) {
  (void)state;
  static const char *const specs[] = {"ssm:preset=fast", "ssm:merge=0,sides=front,layers=1", "ssm:extents=cpu",
                                      "ssm:accumulate=fp16"};
  static const double heights[] = {0, 1e-6, 3.999, 4, 4.5}; /* on the floor, at the light, behind it */
  for (size_t i = 0; i < sizeof specs / sizeof *specs; i++) {
    scene c = {0};
    for (size_t h = 0; h < sizeof heights / sizeof *heights; h++)
      soup_patch(&c.casters, v3(0.1 * (double)h, heights[h], 0), v3(0.3, 0, 0), v3(0, 0, 0.4));
    soup_quad(&c.casters, v3(-0.5, 3, -0.5), v3(0, 2, 0), v3(0, 0, 1)); /* through the light's plane */
    scene_open(&c, 2.2);
    static const int maps[] = {1, 2, 3, 37};
    for (int m = 0; m < 4; m++) {
      pn_light_desc light = light_above(maps[m]);
      check_sound(&c, &light, specs[i]);
      light.half_u = light.half_v = 100; /* larger than the scene */
      check_sound(&c, &light, specs[i]);
      light = sun_along(v3(0.3, -1, 0.1), 0.1, 0.02, maps[m]);
      check_sound(&c, &light, specs[i]);
    }
    over_ground_close(&c);
  }
}

/* Casters that no receiver is behind, and a light whose maps are empty: all lit, and no map to hand out. */
static void nothing_to_shadow_is_lit(void **state) {
  (void)state;
  scene c = {0};
  soup_patch(&c.casters, v3(0, -2, 0), v3(1, 0, 0), v3(0, 0, 1));
  scene_open(&c, 2.2);
  pn_light_desc light = light_above(32);
  float *visibility = stage_visibility(&c.s, &light, "ssm");
  for (int k = 0; k < SIZE * SIZE; k++) assert_true(visibility[k] == 1);
  light.fit = PN_FIT_VISIBLE;
  free(visibility);
  visibility = stage_visibility(&c.s, &light, "ssm");
  for (int k = 0; k < SIZE * SIZE; k++) assert_true(visibility[k] == 1);
  pn_soft_shadow_map soft;
  assert_int_equal(pn_soft_shadow_map_image(c.s.light, c.s.receiver, &soft), PN_ERROR_NOT_READY);
  free(visibility);
  over_ground_close(&c);
}

/* A wide light's map is split into tiles, which overlap by their borders: nothing is counted twice. */
static void tiles_are_counted_once(void **state) {
  (void)state;
  scene c = {0};
  soup_patch(&c.casters, v3(0, 2.5, 0), v3(6, 0, 0), v3(0, 0, 6)); /* opens to 152 degrees */
  scene_open(&c, 2.2);
  pn_light_desc light = light_above(64);
  light.fit = PN_FIT_CASTERS;
  for (int merge = 0; merge < 2; merge++) {
    float *visibility = stage_visibility(&c.s, &light, merge ? "ssm:layers=1" : "ssm:layers=1,merge=0");
    pn_maps_info info;
    pn_soft_shadow_map soft;
    assert_ok(pn_light_maps(c.s.light, &info));
    assert_true(info.tiles > 1);
    assert_ok(pn_soft_shadow_map_image(c.s.light, c.s.receiver, &soft));
    float *sums = gl_read_texture(soft.image.texture, 0, 0, soft.image.width, soft.image.height, 1), most = 0,
          least = 1;
    for (int i = 0; i < soft.image.width * soft.image.height; i++) most = fmaxf(most, sums[i]);
    for (int k = 0; k < SIZE * SIZE; k++) least = fminf(least, 1 - visibility[k]);
    print_message("tiles %d: sums up to %.5f, visibility down to %.5f hidden\n", info.tiles, (double)most,
                  (double)least);
    assert_true(most < 1.001f);
    assert_true(least > 0.999f); /* all of the view is umbra: no gaps between tiles */
    free(sums);
    free(visibility);
  }
  over_ground_close(&c);
}

/* What a technique keeps for a pair goes when the light takes another. */
static void other_techniques_free_its_memory(void **state) {
  (void)state;
  scene c = {0};
  add_clutter(&c);
  scene_open(&c, 2.2);
  pn_light_desc light = light_above(64);
  free(stage_visibility(&c.s, &light, "ssm")); /* what the receiver keeps for itself stays */
  free(stage_visibility(&c.s, &light, "hard"));
  size_t before = c.s.context->gpu.memory;
  free(stage_visibility(&c.s, &light, "ssm"));
  assert_true(c.s.context->gpu.memory > before + 100000);
  free(stage_visibility(&c.s, &light, "hard"));
  assert_int_equal(c.s.context->gpu.memory, before);
  over_ground_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(gpu_and_cpu_lists_agree),
      cmocka_unit_test(warning_is_of_the_finest_tile),
      cmocka_unit_test(parallel_plate_has_its_closed_form),
      cmocka_unit_test(culled_maps_have_the_faces_of_their_side),
      cmocka_unit_test(sheets_that_look_away_cast_from_the_far_map),
      cmocka_unit_test(mirrored_faces_look_where_their_image_does),
      cmocka_unit_test(blocks_do_not_cross_horizons),
      cmocka_unit_test(near_casters_leave_far_ones_their_shadow),
      cmocka_unit_test(sums_in_16_bits_lose_small_patches),
      cmocka_unit_test(sums_in_16_bits_are_what_they_say),
      cmocka_unit_test(devices_without_float_blending_sum_by_batches),
      cmocka_unit_test(counted_draws_change_nothing),
      cmocka_unit_test(bound_holds_overlaps),
      cmocka_unit_test(bad_scenes_stay_sound),
      cmocka_unit_test(nothing_to_shadow_is_lit),
      cmocka_unit_test(other_techniques_free_its_memory),
      cmocka_unit_test(tiles_are_counted_once),
  };
  return GL_RUN("ssm", tests);
}
