/* What casts, given in three ways that must give one shadow: meshes in memory, meshes in the host's GL buffers, and a
 * draw callback whose vertex shader deforms and whose fragment shader makes holes. And what changes must change the
 * shadow. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "agreement.h"
#include "host.h"

enum { PIXELS = CAMERA_WIDTH * CAMERA_HEIGHT };

/* Every technique that casts from a draw callback, cheap enough to be drawn often. */
static const char *const techniques[] = {
    "hard",   "pcf", "pcf:filter=bicubic", "pcss", "average:samples=16", "ssm", "backprojection", "bitmask:maps=layers",
    "bitmask:maps=layers,layers=4,focus=40", "bitmask"};

static int usable(const char *spec) {
  const pn_technique *technique = NULL;
  return pn_technique_parse(spec, &technique, NULL, NULL, 0) == PN_OK && !technique->needs_meshes;
}

/* The bounds are given, so that all three ways have the same map: casters' vertices may be fitted more tightly than a
 * box. */
static pn_light_desc fitted_desc(const host *h) {
  pn_light_desc desc = host_light_desc();
  desc.fit = PN_FIT_GIVEN;
  scene_bounds(&h->world, desc.fit_bounds);
  return desc;
}

static float *shadow(host *h, cast_kind kind, const char *technique, const camera_view *v) {
  pn_light_desc desc = fitted_desc(h);
  pn_light *light = NULL;
  assert_int_equal(host_cast(h, kind), PN_OK);
  assert_int_equal(host_light(h, &desc, technique, &light), PN_OK);
  float *image = host_visibility(h, light, v);
  assert_non_null(image);
  pn_light_destroy(&light);
  host_uncast(h);
  return image;
}

/* The callback's vertices are transformed by another shader, so they differ by rounding: a unit or two in the last
 * place of coordinates below 4, against a map texel of about 1/100, and the snapping to the rasteriser's grid of 1/256
 * texel. */
static const double texel_share = 2.0 / 256;

static void test_three_ways(void **state) {
  host *h = *state;
  camera view = camera_at(0);
  camera_view v;
  assert_int_equal(host_view(h, &view, &v), PN_OK);
  for (size_t i = 0; i < sizeof techniques / sizeof *techniques; i++) {
    if (!usable(techniques[i])) continue;
    float *memory = shadow(h, CAST_MEMORY, techniques[i], &v), *buffers = shadow(h, CAST_BUFFERS, techniques[i], &v);
    float *callback = shadow(h, CAST_CALLBACK, techniques[i], &v);
    char name[80];
    snprintf(name, sizeof name, "casters-%s", techniques[i]);
    save_picture(name, memory, CAMERA_WIDTH, CAMERA_HEIGHT);
    assert_memory_equal(memory, buffers, PIXELS * sizeof *memory);
    agreement a = agree(memory, CAMERA_WIDTH, CAMERA_HEIGHT, 0, 0, callback, CAMERA_WIDTH, CAMERA_HEIGHT, NULL);
    printf("%s: callback differs in %d pixels, mean %.2g, worst %.2g\n", techniques[i], a.differing, a.sum / PIXELS,
           a.worst);
    assert_true(a.range > 100); /* there is a shadow at all */
    /* A texel that flips is seen by as many pixels as it covers: about four here. */
    assert_true(a.sum <= 4 * allowed_changes(a.range * texel_share));
    free(memory);
    free(buffers);
    free(callback);
  }
  host_view_close(&v);
}

/* Techniques that look at meshes find the same edges in memory and in the host's buffers. */
static void test_edges(void **state) {
  host *h = *state;
  camera view = camera_at(0);
  camera_view v;
  assert_int_equal(host_view(h, &view, &v), PN_OK);
  float *memory = shadow(h, CAST_MEMORY, "smoothies", &v), *buffers = shadow(h, CAST_BUFFERS, "smoothies", &v);
  assert_memory_equal(memory, buffers, PIXELS * sizeof *memory);
  assert_true(dark_pixels(memory, CAMERA_WIDTH, CAMERA_HEIGHT) > 1000);
  free(memory);
  free(buffers);
  host_view_close(&v);
}

/* Techniques that peel call the callback with pn_peel's map; the snippet links and hides what was seen already. */
static void test_peeling(void **state) {
  host *h = *state;
  if (!usable("bitmask:maps=layers")) skip();
  camera view = camera_at(0);
  camera_view v;
  assert_int_equal(host_view(h, &view, &v), PN_OK);
  h->peeled_passes = 0;
  free(shadow(h, CAST_CALLBACK, "bitmask:maps=layers", &v));
  assert_true(h->peeled_passes > 0);
  host_view_close(&v);
}

/* The snippet is text for the host's shader whether or not a technique peels today. */
static void test_peel_text(void **state) {
  host *h = *state;
  const char *text = pn_glsl(h->context, "caster", 330, 0);
  assert_non_null(text);
  assert_non_null(strstr(text, "pn_peel"));
  assert_null(strstr(text, "#version"));
  GLuint program = renderer_program(text, renderer_caster_body(1));
  assert_true(program != 0);
  gl.DeleteProgram(program);
  assert_true(pn_glsl(h->context, "caster", 330, 0) == text);
}

/* Light passes through the holes: with the alpha test the flag's shadow loses the holes' share of its area. The holes
 * are disks of radius 0.3 in cells of side 1: 0.09 pi = 28 % of the flag, 26 to 31 % after rounding to 16 x 21 texels a
 * cell. */
static void test_holes(void **state) {
  host *h = *state;
  camera view = camera_at(0);
  camera_view v;
  mesh *flag = &h->world.meshes[SCENE_FLAG];
  /* Only the flag casts; the depth is drawn as always. */
  assert_int_equal(host_view(h, &view, &v), PN_OK);
  double dark[2];
  for (int holes = 0; holes < 2; holes++) {
    pn_light_desc desc = host_light_desc();
    desc.half_u = desc.half_v = 0.01f;
    pn_light *light = NULL;
    pn_mesh m;
    pn_instance instance;
    assert_int_equal(pn_casters_create(h->context, &h->casters), PN_OK);
    pn_mesh_desc flag_desc = host_mesh_desc(h, SCENE_FLAG, CAST_MEMORY);
    if (!holes) flag_desc.alpha_texture = 0, flag_desc.texcoords = (pn_span){0};
    assert_int_equal(pn_mesh_add(h->casters, &flag_desc, &m), PN_OK);
    assert_int_equal(pn_instance_add(h->casters, m, flag->place, 0, &instance), PN_OK);
    assert_int_equal(host_light(h, &desc, "hard", &light), PN_OK);
    float *image = host_visibility(h, light, &v);
    surfaces seen;
    assert_non_null(image);
    assert_true(surfaces_draw(&seen, &h->draw, &h->world, &view));
    save_picture(holes ? "flag-holes" : "flag-solid", image, CAMERA_WIDTH, CAMERA_HEIGHT);
    dark[holes] = 0;
    for (int i = 0; i < PIXELS; i++) dark[holes] += seen.position[4 * i + 3] == SCENE_FLOOR ? 1 - image[i] : 0;
    surfaces_free(&seen);
    free(image);
    pn_light_destroy(&light);
    host_uncast(h);
  }
  host_view_close(&v);
  double share = 1 - dark[1] / dark[0];
  printf("solid %g, with holes %g: holes %.3f\n", dark[0], dark[1], share);
  assert_true(dark[0] > 500);
  /* Perspective and what other objects hide weight the holes unequally: a tenth of their share either way. */
  assert_true(share > 0.22 && share < 0.34);
}

/* A moved mesh's shadow is that of one which was posed so from the beginning. */
static void check_as_posed(host *h, cast_kind kind, const float *moved, const camera_view *v) {
  float *anew = shadow(h, kind, "pcss", v);
  assert_non_null(moved);
  assert_memory_equal(moved, anew, PIXELS * sizeof *moved);
  free(anew);
}

/* Another phase of the wave, written into the host's buffer. */
static void test_deforming(void **state) {
  host *h = *state;
  pn_light_desc desc = fitted_desc(h);
  lit_view lit;
  assert_int_equal(host_lit_view(h, CAST_BUFFERS, &desc, "pcss", &lit), PN_OK);
  float *before = host_visibility(h, lit.light, &lit.v);
  assert_non_null(before);
  scene_pose(&h->world, 2.0f);
  desc = fitted_desc(h);
  assert_int_equal(pn_light_set(lit.light, &desc), PN_OK);
  renderer_pose(&h->draw, &h->world);
  const mesh *flag = &h->world.meshes[SCENE_FLAG];
  float bounds[6];
  memcpy(bounds, flag->bounds_min, sizeof flag->bounds_min);
  memcpy(bounds + 3, flag->bounds_max, sizeof flag->bounds_max);
  assert_int_equal(pn_mesh_moved(h->casters, h->meshes[SCENE_FLAG], NULL, bounds), PN_OK);
  float *moved = host_visibility(h, lit.light, &lit.v);
  host_uncast(h);
  check_as_posed(h, CAST_BUFFERS, moved, &lit.v);
  check_as_posed(h, CAST_MEMORY, moved, &lit.v);
  assert_true(agree(before, CAMERA_WIDTH, CAMERA_HEIGHT, 0, 0, moved, CAMERA_WIDTH, CAMERA_HEIGHT, NULL).sum > 20);
  free(before), free(moved);
  scene_pose(&h->world, 0);
  renderer_pose(&h->draw, &h->world);
  host_lit_view_close(h, &lit);
}

/* The same with data in memory, moved before anything is drawn. */
static void test_deforming_memory(void **state) {
  host *h = *state;
  camera view = camera_at(0);
  camera_view v;
  pn_light *light = NULL;
  assert_int_equal(host_view(h, &view, &v), PN_OK);
  assert_int_equal(host_cast(h, CAST_MEMORY), PN_OK);
  scene_pose(&h->world, 2.0f);
  pn_light_desc desc = fitted_desc(h);
  assert_int_equal(host_light(h, &desc, "pcss", &light), PN_OK);
  const mesh *flag = &h->world.meshes[SCENE_FLAG];
  pn_span positions = {.data = flag->posed, .count = (size_t)flag->vertex_count};
  assert_int_equal(pn_mesh_moved(h->casters, h->meshes[SCENE_FLAG], &positions, NULL), PN_OK);
  float *moved = host_visibility(h, light, &v);
  pn_light_destroy(&light);
  host_uncast(h);
  check_as_posed(h, CAST_MEMORY, moved, &v);
  free(moved);
  scene_pose(&h->world, 0);
  host_view_close(&v);
}

/* Removing what casts, group masks, and a mirrored instance. */
static void test_instances(void **state) {
  host *h = *state;
  pn_light_desc desc = host_light_desc();
  lit_view lit;
  pn_instance mirrored;
  assert_int_equal(host_lit_view(h, CAST_MEMORY, &desc, "pcss", &lit), PN_OK);
  float *all = host_visibility(h, lit.light, &lit.v);
  float place[16];
  memcpy(place, h->world.meshes[SCENE_TORUS].place, sizeof place);
  for (int i = 0; i < 3; i++) place[i] = -place[i];
  assert_int_equal(pn_instance_add(h->casters, h->meshes[SCENE_TORUS], place, 5, &mirrored), PN_OK);
  assert_int_equal(pn_instance_move(h->casters, mirrored, place), PN_OK);
  assert_int_equal(pn_maps_update(lit.light, h->casters, 1u << 0, NULL, 0), PN_OK);
  assert_int_equal(pn_visibility(lit.light, lit.v.receiver), PN_OK);
  float *without = host_result(lit.light, lit.v.receiver);
  assert_memory_equal(all, without, PIXELS * sizeof *all);
  assert_int_equal(pn_instance_remove(h->casters, mirrored), PN_OK);
  assert_int_equal(pn_mesh_remove(h->casters, h->meshes[SCENE_TORUS]), PN_OK);
  float *less = host_visibility(h, lit.light, &lit.v);
  assert_true(agree(all, CAMERA_WIDTH, CAMERA_HEIGHT, 0, 0, less, CAMERA_WIDTH, CAMERA_HEIGHT, NULL).sum > 100);
  for (int i = 0; i < SCENE_MESHES; i++) {
    if (h->world.meshes[i].casts && i != SCENE_TORUS) assert_int_equal(pn_mesh_remove(h->casters, h->meshes[i]), PN_OK);
  }
  float *none = host_visibility(h, lit.light, &lit.v);
  for (int i = 0; i < PIXELS; i++) assert_true(none[i] == 1);
  pn_maps_info maps;
  assert_int_equal(pn_light_maps(lit.light, &maps), PN_OK);
  assert_true(maps.empty);
  free(all), free(without), free(less), free(none);
  host_lit_view_close(h, &lit);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_teardown(test_three_ways, host_check),
      cmocka_unit_test_teardown(test_edges, host_check),
      cmocka_unit_test_teardown(test_peeling, host_check),
      cmocka_unit_test_teardown(test_peel_text, host_check),
      cmocka_unit_test_teardown(test_holes, host_check),
      cmocka_unit_test_teardown(test_deforming, host_check),
      cmocka_unit_test_teardown(test_deforming_memory, host_check),
      cmocka_unit_test_teardown(test_instances, host_check),
  };
  return cmocka_run_group_tests_name("casters", tests, host_setup, host_teardown);
}
