#include "stage.h"

#include <stdio.h>
#include <stdlib.h>

static void on_log(void *user, pn_log_level level, int id, const char *text) {
  stage *s = user;
  s->messages[id]++;
  if (level == PN_LOG_ERROR) fprintf(stderr, "penumbra: %s: %s\n", pn_message_name(id), text);
}

void stage_open(stage *s) {
  *s = (stage){0};
  pn_context_desc desc = {.log = on_log, .user = s};
  assert_ok(pn_context_create(&desc, &s->context));
  assert_ok(pn_casters_create(s->context, &s->casters));
  assert_ok(pn_receiver_create(s->context, &s->receiver));
  assert_ok(pn_light_create(s->context, &s->light));
}

void stage_close(stage *s) { pn_context_destroy(&s->context); }

pn_mesh stage_mesh(stage *s, const soup *triangles) {
  pn_mesh mesh;
  pn_mesh_desc desc = {.positions = {.data = triangles->list, .count = 3 * (size_t)triangles->count}};
  assert_ok(pn_mesh_add(s->casters, &desc, &mesh));
  return mesh;
}

pn_instance stage_cast(stage *s, const soup *triangles) {
  static const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  pn_instance instance;
  assert_ok(pn_instance_add(s->casters, stage_mesh(s, triangles), identity, 0, &instance));
  return instance;
}

void stage_receive(stage *s, const view *v, bool normals) {
  pn_receiver_desc desc = view_desc(v, normals);
  assert_ok(pn_receiver_set(s->receiver, &desc));
}

static void narrow(vec a, float out[3]) {
  out[0] = (float)a.x;
  out[1] = (float)a.y;
  out[2] = (float)a.z;
}

pn_light_desc light_at(vec centre, vec direction, double half_u, double half_v, int map) {
  pn_light_desc d = {.half_u = (float)half_u, .half_v = (float)half_v, .map_width = map};
  narrow(centre, d.center);
  narrow(direction, d.direction);
  return d;
}

pn_light_desc sun_along(vec direction, double half_u, double half_v, int map) {
  pn_light_desc d = light_at(v3(0, 0, 0), direction, half_u, half_v, map);
  d.shape = PN_LIGHT_SUN;
  return d;
}

float *stage_look(stage *s) {
  pn_image image;
  assert_ok(pn_visibility(s->light, s->receiver));
  assert_ok(pn_result_image(s->light, s->receiver, &image));
  return gl_read_texture(image.texture, 0, -1, image.width, image.height, 1);
}

float *stage_visibility(stage *s, const pn_light_desc *light, const char *technique) {
  char why[256];
  if (pn_light_technique(s->light, technique, why, sizeof why) != PN_OK) fail_msg("%s", why);
  assert_ok(pn_light_set(s->light, light));
  assert_ok(pn_maps_update(s->light, s->casters, PN_GROUPS_ALL, &s->receiver, 1));
  return stage_look(s);
}

light_axes axes_of(const pn_light_desc *light) {
  const float *c = light->center, *d = light->direction;
  light_axes l = {.origin = v3(c[0], c[1], c[2]),
                  .z = unit(v3(d[0], d[1], d[2])),
                  .half_u = light->half_u,
                  .half_v = light->half_v,
                  .sun = light->shape == PN_LIGHT_SUN};
  vec up = v3(0, 1, 0);
  if (length(cross(l.z, up)) < 1e-6) up = v3(0, 0, -1);
  l.u = unit(cross(l.z, up));
  l.v = cross(l.u, l.z);
  return l;
}

/* A sun's direction to the point with tangents (x, y): light from there travels along z - x u - y v, so that it darkens
 * what lies at s' = s - x w; the point is seen along -z + x u + y v. */
vec to_light(const light_axes *l, vec p, double a, double b) {
  vec offset = add(mul(a * l->half_u, l->u), mul(b * l->half_v, l->v));
  return l->sun ? sub(offset, l->z) : sub(add(l->origin, offset), p);
}

bool faces_whole_light(const light_axes *l, vec p, vec n, double margin) {
  if (!l->sun && dot(sub(p, l->origin), l->z) <= 0) return false;
  for (int i = 0; i < 4; i++)
    if (dot(unit(to_light(l, p, i & 1 ? 1 : -1, i & 2 ? 1 : -1)), n) <= margin) return false;
  return true;
}
