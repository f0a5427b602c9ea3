/* The same scene far from the origin, in a host that goes through scene space in floats. */
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
#include "truth.h"

enum { WIDTH = 160, HEIGHT = 120 };
typedef enum { PLACED, BAKED, BACK } far_kind;
static const char *kind_names[] = {"placed", "baked", "back"};
static const char *cast_names[] = {"memory", "buffers", "callback"};

static void rebake(mesh *m, vec3 d, int whole) {
  mat4 place = from_float(m->place);
  if (!whole) place = identity();
  m->wave = 0;
  for (int i = 0; i < m->vertex_count; i++) {
    vec3 q = add(project(&place, v3_of(m->posed + 3 * i), NULL), d);
    m->rest[3 * i] = (float)q.x, m->rest[3 * i + 1] = (float)q.y, m->rest[3 * i + 2] = (float)q.z;
  }
  mesh_pose(m, 0);
}

static void displace(scene *world, far_kind kind, vec3 d) {
  for (int i = 0; i < world->count; i++) {
    mesh *m = &world->meshes[i];
    mat4 place = from_float(m->place), away = translation(d.x, d.y, d.z), back = translation(-d.x, -d.y, -d.z);
    if (kind == PLACED) place = multiply(&away, &place);
    if (kind == BACK) rebake(m, d, 0), place = multiply(&place, &back);
    if (kind == BAKED) rebake(m, d, 1), place = identity();
    to_float(&place, m->place);
  }
}

static camera camera_moved(vec3 d) {
  camera out = camera_from(add(v3(0.4, 2.7, 5.2), d), add(v3(0, 0.6, 0), d));
  out.width = out.target_width = WIDTH;
  out.height = out.target_height = HEIGHT;
  return out;
}

static pn_light_desc light_moved(int sun, vec3 d) {
  pn_light_desc out = sun ? host_sun_desc() : host_light_desc();
  out.center[0] = (float)(out.center[0] + d.x), out.center[1] = (float)(out.center[1] + d.y), out.center[2] = (float)(out.center[2] + d.z);
  return out;
}

static int open_far(host *h, far_kind kind, vec3 d) {
  memset(h, 0, sizeof *h);
  if (!headless_open(&h->window)) return 0;
  scene_make(&h->world);
  displace(&h->world, kind, d);
  return renderer_open(&h->draw, &h->world) && host_context(h) == PN_OK;
}

static host near_host;
static surfaces seen;
static unsigned char lit[2][WIDTH * HEIGHT];

static int whole_around(int x, int y) {
  if (x < 3 || y < 3 || x >= WIDTH - 3 || y >= HEIGHT - 3) return 0;
  int i = y * WIDTH + x;
  for (int k = 0; k < 9; k++) {
    int j = i + (k / 3 - 1) * WIDTH + k % 3 - 1;
    vec3 n = v3_of(seen.normal + 3 * i);
    if (seen.position[4 * i + 3] != seen.position[4 * j + 3] || dot(n, v3_of(seen.normal + 3 * j)) < 0.999 || fabs(dot(n, sub(v3_of(seen.position + 4 * i), v3_of(seen.position + 4 * j)))) > 1e-3) return 0;
  }
  return truth_plane_known(&seen, x, y);
}

static float *picture(host *h, vec3 d, cast_kind cast, int sun, int normals, const char *spec, float given) {
  camera view = camera_moved(d);
  camera_view v;
  assert_int_equal(host_view(h, &view, &v), PN_OK);
  GLuint texture = 0;
  pn_receiver_desc desc = host_receiver_desc(&view, &v.target);
  if (normals) {
    texture = make_texture(GL_RGBA32F, WIDTH, HEIGHT);
    gl.BindTexture(GL_TEXTURE_2D, texture);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, WIDTH, HEIGHT, 0, GL_RGB, GL_FLOAT, seen.normal);
    gl.BindTexture(GL_TEXTURE_2D, 0);
    desc.normal_texture = texture;
  }
  desc.position_error = given;
  assert_int_equal(pn_receiver_set(v.receiver, &desc), PN_OK);
  assert_int_equal(host_cast(h, cast), PN_OK);
  pn_light_desc l = light_moved(sun, d);
  l.fit = PN_FIT_VISIBLE;
  pn_light *light;
  assert_int_equal(host_light(h, &l, spec, &light), PN_OK);
  assert_int_equal(pn_maps_update(light, h->casters, PN_GROUPS_ALL, &v.receiver, 1), PN_OK);
  assert_int_equal(pn_visibility(light, v.receiver), PN_OK);
  float *out = host_result(light, v.receiver);
  pn_light_destroy(&light);
  host_uncast(h);
  host_view_close(&v);
  gl.DeleteTextures(1, &texture);
  return out;
}

static void explore(void **state) {
  (void)state;
  const double ds[] = {0, 300, 3000, 30000};
  const char *only = getenv("FAR_SPEC");
  for (int sun = 0; sun < 2; sun++)
    for (int normals = 0; normals < 2; normals++) {
      assert_true(open_far(&near_host, BAKED, v3(0, 0, 0)));
      camera nv = camera_moved(v3(0, 0, 0));
      assert_true(surfaces_draw(&seen, &near_host.draw, &near_host.world, &nv));
      pn_light_desc l = light_moved(sun, v3(0, 0, 0));
      pn_maps_info info = {.s0 = 0, .s1 = 1, .t0 = 0, .t1 = 1, .width = 256, .height = 256};
      truth_light tl = truth_light_of(&l, &info);
      int count = 0;
      for (int i = 0; i < WIDTH * HEIGHT; i++) {
        int x = i % WIDTH, y = i / WIDTH;
        lit[sun][i] = seen.position[4 * i + 3] >= 0 && (seen.position[4*i+3] < 3) && whole_around(x, y) &&
                      truth_sees_all(&tl, &near_host.world, v3_of(seen.position + 4 * i), v3_of(seen.normal + 3 * i));
        count += lit[sun][i];
      }
      float *base = picture(&near_host, v3(0, 0, 0), CAST_BUFFERS, sun, normals, only, 0);
      host_close(&near_host);
      for (int kind = 0; kind < 3; kind++)
        for (int di = 1; di < 4; di++) {
          vec3 d = v3(0.6 * ds[di], -0.3 * ds[di], 0.7 * ds[di]);
          for (int cast = 0; cast < 3; cast++) {
            host h;
            assert_true(open_far(&h, (far_kind)kind, d));
            vec3 cd = kind == BACK ? v3(0, 0, 0) : d;
            float *image = picture(&h, cd, (cast_kind)cast, sun, normals, only, getenv("FAR_GIVEN") ? (float)atof(getenv("FAR_GIVEN")) : 0);
            double least = 1, diff = 0;
            int below = 0;
            for (int i = 0; i < WIDTH * HEIGHT; i++) {
              if (lit[sun][i]) {
                least = fmin(least, image[i]);
                below += image[i] < 254.0 / 255;
                if (getenv("FAR_DUMP") && image[i] < 254.0/255) printf("  %d,%d obj %g p %.3f %.3f %.3f n %.2f %.2f %.2f: %.3f\n", i%WIDTH, i/WIDTH, seen.position[4*i+3], seen.position[4*i], seen.position[4*i+1], seen.position[4*i+2], seen.normal[3*i], seen.normal[3*i+1], seen.normal[3*i+2], image[i]);
              }
              if (seen.position[4 * i + 3] >= 0) diff += fabs(image[i] - base[i]);
            }
            printf("%s normals %d %s %g %s: lit %d below %d least %.3f; mean difference %.5f dark %d (%d)\n", sun ? "sun" : "rect", normals, kind_names[kind], ds[di], cast_names[cast], count, below, least, diff / (WIDTH * HEIGHT), dark_pixels(image, WIDTH, HEIGHT), dark_pixels(base, WIDTH, HEIGHT));
            free(image);
            host_close(&h);
          }
        }
      free(base);
      surfaces_free(&seen);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(explore)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
