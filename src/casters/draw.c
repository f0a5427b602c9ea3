/* Drawing casters into a depth pass: the library's own meshes, then the host's callbacks. */
#include "casters/casters.h"

#include <stdio.h>

#include "gl/host.h"
#include "gl/inspect.h"

enum { DEFINES = 64 };

static pni_program_key caster_program(bool alpha, bool peel, bool floor, char defines[DEFINES]) {
  snprintf(defines, DEFINES, "PN_ALPHA %d\nPN_PEEL %d\nPN_FLOOR %d\n", alpha, peel, floor);
  return (pni_program_key){"casters/caster.vert.glsl", "casters/caster.frag.glsl", NULL, defines};
}

/* What a box is held against: the sides and the far plane of the map's frustum, and the light's range. Beyond the far
 * plane nothing may be drawn, because depth is clamped: it would come to lie on that plane, before receivers that it is
 * behind. Nearer than the near plane casters count, and are clamped to it. */
typedef struct {
  pni_matrix clip_from_object;
  double distance[4]; /* from the light, of an object's point */
  double range;       /* 0: no limit */
} culling;

static void box_corner(const pni_box *box, int i, double out[4]) {
  out[0] = i & 1 ? box->max[0] : box->min[0];
  out[1] = i & 2 ? box->max[1] : box->min[1];
  out[2] = i & 4 ? box->max[2] : box->min[2];
  out[3] = 1;
}

/* Whether all eight corners lie outside the same plane. */
static bool outside(const pni_box *box, const culling *c) {
  int out[6] = {0};
  for (int i = 0; i < 8; i++) {
    double p[4], h[4], z = 0;
    box_corner(box, i, p);
    pni_matrix_apply(&c->clip_from_object, p, h);
    for (int k = 0; k < 4; k++) z += c->distance[k] * p[k];
    out[0] += h[0] < -h[3];
    out[1] += h[0] > h[3];
    out[2] += h[1] < -h[3];
    out[3] += h[1] > h[3];
    out[4] += h[2] > h[3];
    out[5] += c->range > 0 && z > c->range;
  }
  for (int k = 0; k < 6; k++)
    if (out[k] == 8) return true;
  return false;
}

bool pni_mesh_beyond(const pni_mesh_data *mesh, const pni_matrix *light_from_object, double distance) {
  for (int b = 0; b < mesh->box_count; b++)
    for (int i = 0; i < 8; i++) {
      double p[4], q[4];
      box_corner(&mesh->boxes[b], i, p);
      pni_matrix_apply(light_from_object, p, q);
      if (q[2] <= distance) return false;
    }
  return true;
}

static culling culling_of(const pni_caster_draw *draw, const pni_matrix *scene_from_object) {
  culling c = {.clip_from_object = pni_matrix_multiply(&draw->cull_from_scene, scene_from_object),
               .range = draw->range};
  for (int k = 0; k < 4; k++)
    for (int r = 0; r < 4; r++) c.distance[k] += draw->distance[r] * scene_from_object->m[4 * k + r];
  return c;
}

/* Whether what is drawn from at on, up to where the next box begins, may reach into the frustum. Where boxes do not
 * tell triangles apart, that is all of them. */
static bool run_inside(const pni_mesh_data *mesh, const culling *cull, size_t at) {
  size_t first = 0, end = (size_t)mesh->box_count;
  if (mesh->box_triangles) {
    first = at / (3 * mesh->box_triangles);
    end = first + 1;
  }
  for (size_t b = first; b < end; b++)
    if (!outside(&mesh->boxes[b], cull)) return true;
  return false;
}

/* From *at on, the next vertices or indices that may reach into the frustum: moves *at there, returns how many, 0 at
 * the end. */
static size_t next_run(const pni_mesh_data *mesh, const culling *cull, size_t *at) {
  size_t step = mesh->box_triangles ? 3 * mesh->box_triangles : mesh->draw_count;
  while (*at < mesh->draw_count && !run_inside(mesh, cull, *at)) *at += step;
  if (*at >= mesh->draw_count) return 0;
  size_t end = *at + step;
  while (end < mesh->draw_count && run_inside(mesh, cull, end)) end += step;
  return (end < mesh->draw_count ? end : mesh->draw_count) - *at;
}

typedef struct {
  pni_matrix clip_from_vertex;
  culling cull;
  bool clockwise; /* as the light sees it */
} placed;

static pn_result begin_mesh(pni_gpu *gpu, const pni_mesh_data *mesh, const placed *p, const pni_caster_draw *draw) {
  const pni_texture *peel = draw->peel;
  char defines[DEFINES];
  bool alpha = mesh->alpha_texture != 0;
  pni_program_key key = caster_program(alpha, peel != NULL, draw->floor != NULL, defines);
  pn_result result = pni_pass_program(gpu, &key);
  if (result != PN_OK) return result;
  float matrix[16];
  pni_matrix_to_floats(&p->clip_from_vertex, matrix);
  pni_set_matrix4(gpu, "pn_clip_from_vertex", matrix);
  if (draw->floor) pni_set_floats(gpu, "pn_floor", draw->floor);
  if (peel) pni_set_texture(gpu, "pn_peel_map", peel);
  if (alpha) {
    pni_set_ints(gpu, "pn_alpha_channel", mesh->alpha_channel, 0, 0, 0);
    pni_set_floats(gpu, "pn_alpha_cutoff", (const float[4]){mesh->alpha_cutoff});
    pni_set_host_texture(gpu, "pn_alpha", mesh->alpha_texture,
                         mesh->alpha_complete ? PNI_SAMPLE_OWN : PNI_SAMPLE_LINEAR);
  }
  pni_pass_clockwise(gpu, p->clockwise);
  return PN_OK;
}

static pn_result draw_mesh(pni_gpu *gpu, const pni_mesh_data *mesh, const placed *p, const pni_caster_draw *draw) {
  size_t first = 0, count = next_run(mesh, &p->cull, &first);
  if (count == 0) return PN_OK;
  pn_result result = begin_mesh(gpu, mesh, p, draw);
  if (result != PN_OK) return result;
  size_t offset = mesh->own_indices.id ? 0 : mesh->indices.offset;
  for (; count > 0; count = next_run(mesh, &p->cull, &first)) {
    pni_draw_vertices(gpu, &mesh->vertices, mesh->index_bytes, offset, first, count);
    first += count;
  }
  return PN_OK;
}

/* Mirroring turns winding round. */
static bool mirrors(const pni_matrix *a) {
  const double *m = a->m;
  return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[4] * (m[1] * m[10] - m[2] * m[9]) +
             m[8] * (m[1] * m[6] - m[2] * m[5]) <
         0;
}

pn_result pni_casters_check(const pn_casters *casters, uint32_t groups) {
  pni_gpu *gpu = &casters->object.context->gpu;
  const pni_mesh_data *last = NULL;
  for (int i = 0; i < casters->instance_count; i++) {
    const pni_instance_data *instance = &casters->instances[i];
    const pni_mesh_data *mesh = &casters->meshes[instance->mesh];
    if (!(groups >> instance->group & 1) || !mesh->alpha_texture || mesh == last) continue;
    last = mesh;
    if (!pni_texture_is_2d(gpu, mesh->alpha_texture))
      return pni_fail(gpu, PN_ERROR_NOT_READY, PN_MESSAGE_MESH_ALPHA,
                      "alpha texture %u of mesh %u is gone, or no longer a 2D texture", mesh->alpha_texture, mesh->id);
  }
  return PN_OK;
}

/* One look a call. */
static pn_result check_once(pn_casters *casters, uint32_t groups) {
  const pni_gpu *gpu = &casters->object.context->gpu;
  if (casters->checked == gpu->plan.number) return PN_OK;
  casters->checked = gpu->plan.number;
  return pni_casters_check(casters, groups);
}

/* The programs that they need: no more than two. */
static pn_result plan_meshes(pn_casters *casters, const pni_caster_draw *draw) {
  bool any[2] = {false, false};
  for (int i = 0; i < casters->instance_count; i++) {
    const pni_instance_data *instance = &casters->instances[i];
    if (draw->groups >> instance->group & 1) any[casters->meshes[instance->mesh].alpha_texture != 0] = true;
  }
  pn_result result = any[1] ? check_once(casters, draw->groups) : PN_OK;
  for (int alpha = 0; alpha < 2 && result == PN_OK; alpha++) {
    char defines[DEFINES];
    pni_program_key key = caster_program(alpha, draw->peel != NULL, draw->floor != NULL, defines);
    if (any[alpha]) result = pni_pass_program(&casters->object.context->gpu, &key);
  }
  return result;
}

static pn_result draw_meshes(pn_casters *casters, const pni_caster_draw *draw) {
  pni_gpu *gpu = &casters->object.context->gpu;
  for (int i = 0; i < casters->instance_count; i++) {
    const pni_instance_data *instance = &casters->instances[i];
    if (!(draw->groups >> instance->group & 1)) continue;
    const pni_mesh_data *mesh = &casters->meshes[instance->mesh];
    pni_matrix scene_from_vertex = pni_from_vertex(mesh, &instance->scene_from_object);
    placed p = {pni_matrix_multiply(&draw->clip_from_scene, &scene_from_vertex),
                culling_of(draw, &instance->scene_from_object),
                mesh->clockwise != mirrors(&instance->scene_from_object)};
    pn_result result = draw_mesh(gpu, mesh, &p, draw);
    if (result != PN_OK) return result;
  }
  return PN_OK;
}

/* Sides and far plane of the map's frustum, pointing inwards: rows of the clip matrix. */
enum { PLANES = 5 };
static void frustum_planes(const pni_matrix *clip, float planes[PLANES][4]) {
  static const struct {
    int row;
    double sign;
  } sides[PLANES] = {{0, 1}, {0, -1}, {1, 1}, {1, -1}, {2, -1}};
  for (int i = 0; i < PLANES; i++)
    for (int c = 0; c < 4; c++)
      planes[i][c] = (float)(clip->m[4 * c + 3] + sides[i].sign * clip->m[4 * c + sides[i].row]);
}

static pn_result call_host(pn_casters *casters, const pni_caster_draw *draw, int group) {
  pni_gpu *gpu = &casters->object.context->gpu;
  const pni_callback *callback = &casters->callbacks[group];
  float matrix[16], planes[PLANES][4];
  pni_matrix_to_floats(&draw->clip_from_scene, matrix);
  frustum_planes(&draw->cull_from_scene, planes);
  pn_caster_pass pass = {.clip_from_scene = matrix,
                         .planes = planes[0],
                         .plane_count = PLANES,
                         .faces = draw->pass->faces ? draw->pass->faces : PN_FACES_ANY,
                         .peel_texture = draw->peel ? draw->peel->id : 0,
                         .peel_unit = PNI_UNIT_PEEL,
                         .layer = draw->layer,
                         .width = draw->pass->width,
                         .height = draw->pass->height};
  pn_result result = pni_pass_resume(gpu, draw->pass);
  if (result != PN_OK) return result;
  pni_host_begin(gpu, draw->peel);
  callback->draw(callback->user, &pass);
  pni_host_end(gpu);
  return PN_OK;
}

static bool calls_host(const pn_casters *casters, const pni_caster_draw *draw, int group) {
  const pni_callback *callback = &casters->callbacks[group];
  pni_matrix identity = pni_matrix_identity();
  culling all = culling_of(draw, &identity);
  if (draw->without_host || !callback->draw || !(draw->groups >> group & 1)) return false;
  for (int i = 0; i < 8; i++) { /* the host culls against sides itself */
    double p[4], h[4], z = 0;
    box_corner(&callback->bounds, i, p);
    pni_matrix_apply(&draw->clip_from_scene, p, h);
    for (int k = 0; k < 4; k++) z += all.distance[k] * p[k];
    if (h[2] <= h[3] && !(draw->range > 0 && z > draw->range)) return true;
  }
  return false;
}

pn_result pni_casters_draw_pass(pn_casters *casters, const pni_caster_draw *draw) {
  if (casters->object.context->gpu.plan.on) return plan_meshes(casters, draw);
  pn_result result = draw_meshes(casters, draw);
  for (int group = 0; group < PN_GROUP_COUNT && result == PN_OK; group++)
    if (calls_host(casters, draw, group)) result = call_host(casters, draw, group);
  return result;
}
