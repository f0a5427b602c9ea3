/* The casters of a scene: adding, moving, removing. */
#include "casters/casters.h"

#include <math.h>
#include <string.h>

#include "casters/mesh.h"
#include "gl/host.h"

static pni_gpu *gpu_of(const pn_casters *casters) { return &casters->object.context->gpu; }

/* ---- the object -------------------------------------------------------------------------------------------------- */

static void release_casters(pni_object *object, bool abandon) {
  pn_casters *casters = (pn_casters *)object;
  pni_gpu *gpu = gpu_of(casters);
  for (int i = 0; i < casters->mesh_count; i++) pni_mesh_drop(gpu, &casters->meshes[i], abandon);
  pni_free(gpu, casters->meshes);
  pni_free(gpu, casters->instances);
}

pn_result pn_casters_create(pn_context *context, pn_casters **out) {
  if (!context) return PN_ERROR_ARGUMENT;
  if (!out)
    return pni_fail(&context->gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_casters_create: out is NULL");
  *out = pni_object_create(context, release_casters, sizeof **out);
  return *out ? PN_OK : PN_ERROR_OUT_OF_MEMORY;
}

void pn_casters_destroy(pn_casters **casters) {
  if (!casters || !*casters) return;
  pni_object_destroy(&(*casters)->object);
  *casters = NULL;
}

/* ---- slots ------------------------------------------------------------------------------------------------------- */

/* A slot in an array that grows; freed ones are taken first. Ids never repeat, so a stale one is noticed. */
static bool grow(pni_gpu *gpu, void **array, int *capacity, size_t element) {
  int more = *capacity ? *capacity * 2 : 16;
  void *grown = pni_reallocate(gpu, *array, (size_t)more * element);
  if (!grown) return false;
  memset((char *)grown + (size_t)*capacity * element, 0, (size_t)(more - *capacity) * element);
  *array = grown;
  *capacity = more;
  return true;
}

static pni_mesh_data *free_mesh(pn_casters *c) {
  for (int i = 0; i < c->mesh_count; i++)
    if (!c->meshes[i].id) return &c->meshes[i];
  if (c->mesh_count == c->mesh_capacity && !grow(gpu_of(c), (void **)&c->meshes, &c->mesh_capacity, sizeof *c->meshes))
    return NULL;
  return &c->meshes[c->mesh_count++];
}

/* Ids count up, so instances stay sorted by id when removal closes the gap: found by bisection. */
static pni_instance_data *find_instance(const pn_casters *c, uint32_t id) {
  int low = 0, high = c->instance_count;
  while (low < high) {
    int middle = (low + high) / 2;
    if (c->instances[middle].id < id) low = middle + 1;
    else high = middle;
  }
  return id && low < c->instance_count && c->instances[low].id == id ? &c->instances[low] : NULL;
}

pni_mesh_data *pni_find_mesh(const pn_casters *c, uint32_t id) {
  for (int i = 0; id && i < c->mesh_count; i++)
    if (c->meshes[i].id == id) return &c->meshes[i];
  return NULL;
}

/* ---- meshes ------------------------------------------------------------------------------------------------------ */

pn_result pn_mesh_add(pn_casters *casters, const pn_mesh_desc *desc, pn_mesh *out) {
  if (!casters) return PN_ERROR_ARGUMENT;
  pni_gpu *gpu = gpu_of(casters);
  if (!desc || !out)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_mesh_add: desc or out is NULL");
  out->id = 0;
  pni_enter(casters->object.context); /* the check looks into buffers */
  pn_result result = pni_mesh_check(gpu, desc);
  if (result != PN_OK) return pni_leave(casters->object.context, result);
  pni_mesh_data *slot = free_mesh(casters);
  if (!slot) return pni_leave(casters->object.context, PN_ERROR_OUT_OF_MEMORY);
  result = pni_mesh_build(gpu, desc, slot);
  if (result == PN_OK) out->id = slot->id = ++casters->next_id;
  return pni_leave(casters->object.context, result);
}

static pni_mesh_data *known_mesh(pn_casters *casters, pn_mesh mesh) {
  pni_mesh_data *found = pni_find_mesh(casters, mesh.id);
  if (!found) pni_fail(gpu_of(casters), PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_UNKNOWN, "there is no mesh %u", mesh.id);
  return found;
}

pn_result pn_mesh_moved(pn_casters *casters, pn_mesh mesh, const pn_span *positions, const float *bounds) {
  if (!casters) return PN_ERROR_ARGUMENT;
  pni_gpu *gpu = gpu_of(casters);
  pni_mesh_data *data = known_mesh(casters, mesh);
  if (!data) return PN_ERROR_ARGUMENT;
  pn_result result = positions ? pni_mesh_check_moved(gpu, data, positions) : PN_OK;
  if (result != PN_OK) return result;
  if (bounds && !pni_box_sound(bounds, bounds + 3))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_BOUNDS, "bounds are inverted or not finite");
  pni_enter(casters->object.context);
  result = pni_mesh_deform(gpu, data, positions, bounds);
  return pni_leave(casters->object.context, result);
}

pn_result pn_mesh_remove(pn_casters *casters, pn_mesh mesh) {
  if (!casters) return PN_ERROR_ARGUMENT;
  pni_mesh_data *data = known_mesh(casters, mesh);
  if (!data) return PN_ERROR_ARGUMENT;
  int kept = 0;
  for (int i = 0; i < casters->instance_count; i++)
    if (&casters->meshes[casters->instances[i].mesh] != data) casters->instances[kept++] = casters->instances[i];
  casters->instance_count = kept;
  pni_enter(casters->object.context);
  pni_mesh_drop(gpu_of(casters), data, false);
  return pni_leave(casters->object.context, PN_OK);
}

/* ---- instances --------------------------------------------------------------------------------------------------- */

static pn_result check_transform(pni_gpu *gpu, const float m[16]) {
  if (!m) return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "the transform is NULL");
  if (pni_floats_finite(m, 16) && m[3] == 0 && m[7] == 0 && m[11] == 0 && m[15] == 1) return PN_OK;
  return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_INSTANCE_TRANSFORM,
                  "a transform must be finite, its last row 0 0 0 1");
}

static pn_result check_group(pni_gpu *gpu, int group) {
  if (group >= 0 && group < PN_GROUP_COUNT) return PN_OK;
  return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_CASTER_GROUP, "group %d is not one of 0..%d", group,
                  PN_GROUP_COUNT - 1);
}

pn_result pn_instance_add(pn_casters *casters, pn_mesh mesh, const float transform[16], int group, pn_instance *out) {
  if (!casters) return PN_ERROR_ARGUMENT;
  pni_gpu *gpu = gpu_of(casters);
  if (out) out->id = 0;
  const pni_mesh_data *data = known_mesh(casters, mesh);
  if (!data) return PN_ERROR_ARGUMENT;
  pn_result result = check_transform(gpu, transform);
  if (result == PN_OK) result = check_group(gpu, group);
  if (result != PN_OK) return result;
  if (casters->instance_count == casters->instance_capacity &&
      !grow(gpu, (void **)&casters->instances, &casters->instance_capacity, sizeof *casters->instances))
    return PN_ERROR_OUT_OF_MEMORY;
  casters->instances[casters->instance_count++] =
      (pni_instance_data){++casters->next_id, (int)(data - casters->meshes), group, pni_matrix_from_floats(transform)};
  if (out) out->id = casters->next_id;
  return PN_OK;
}

static pni_instance_data *known_instance(pn_casters *casters, pn_instance instance) {
  pni_instance_data *found = find_instance(casters, instance.id);
  if (!found)
    pni_fail(gpu_of(casters), PN_ERROR_ARGUMENT, PN_MESSAGE_INSTANCE_UNKNOWN, "there is no instance %u", instance.id);
  return found;
}

pn_result pn_instance_move(pn_casters *casters, pn_instance instance, const float transform[16]) {
  if (!casters) return PN_ERROR_ARGUMENT;
  pni_instance_data *data = known_instance(casters, instance);
  if (!data) return PN_ERROR_ARGUMENT;
  pn_result result = check_transform(gpu_of(casters), transform);
  if (result != PN_OK) return result;
  data->scene_from_object = pni_matrix_from_floats(transform);
  return PN_OK;
}

pn_result pn_instance_remove(pn_casters *casters, pn_instance instance) {
  if (!casters) return PN_ERROR_ARGUMENT;
  pni_instance_data *data = known_instance(casters, instance);
  if (!data) return PN_ERROR_ARGUMENT;
  ptrdiff_t at = data - casters->instances;
  memmove(data, data + 1, (size_t)(casters->instance_count - at - 1) * sizeof *data);
  casters->instance_count--;
  return PN_OK;
}

pn_result pn_casters_draw(pn_casters *casters, int group, pn_draw_fn draw, void *user, const float bounds[6]) {
  if (!casters) return PN_ERROR_ARGUMENT;
  pni_gpu *gpu = gpu_of(casters);
  pn_result result = check_group(gpu, group);
  if (result != PN_OK) return result;
  if (draw && !bounds)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_casters_draw: bounds is NULL");
  if (draw && (!pni_box_sound(bounds, bounds + 3)))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_CASTER_BOUNDS,
                    "a draw callback needs bounds: finite, not inverted");
  pni_callback *callback = &casters->callbacks[group];
  callback->draw = draw;
  callback->user = user;
  if (draw) memcpy(&callback->bounds, bounds, sizeof callback->bounds);
  return PN_OK;
}

bool pni_casters_call_host(const pn_casters *casters, uint32_t groups) {
  for (int group = 0; group < PN_GROUP_COUNT; group++)
    if (casters->callbacks[group].draw && (groups >> group & 1)) return true;
  return false;
}

pni_matrix pni_from_vertex(const pni_mesh_data *mesh, const pni_matrix *from_object) {
  pni_matrix out = *from_object;
  double at[3];
  pni_matrix_point(from_object, mesh->center, at);
  memcpy(out.m + 12, at, sizeof at);
  return out;
}

/* ---- bounds ------------------------------------------------------------------------------------------------------ */

static void visit_box(const pni_box *box, const pni_matrix *transform, pni_box_visitor visit, void *user) {
  double corners[8][3];
  for (int i = 0; i < 8; i++) {
    double p[3] = {i & 1 ? box->max[0] : box->min[0], i & 2 ? box->max[1] : box->min[1],
                   i & 4 ? box->max[2] : box->min[2]};
    pni_matrix_point(transform, p, corners[i]);
  }
  visit(user, (const double(*)[3])corners);
}

void pni_casters_each_box(const pn_casters *casters, uint32_t groups, pni_box_visitor visit, void *user) {
  for (int i = 0; i < casters->instance_count; i++) {
    const pni_instance_data *instance = &casters->instances[i];
    if (!(groups >> instance->group & 1)) continue;
    const pni_mesh_data *mesh = &casters->meshes[instance->mesh];
    for (int b = 0; b < mesh->box_count; b++) visit_box(&mesh->boxes[b], &instance->scene_from_object, visit, user);
  }
  pni_matrix identity = pni_matrix_identity();
  for (int group = 0; group < PN_GROUP_COUNT; group++)
    if (casters->callbacks[group].draw && (groups >> group & 1))
      visit_box(&casters->callbacks[group].bounds, &identity, visit, user);
}
