#include "host/client.h"

#include <epoxy/gl.h>
#include <stdio.h>
#include <stdlib.h>
#include <math.h>
#include <string.h>

#include "base/message.h"

static void on_message(void *user, pn_log_level level, int message_id, const char *text) {
  struct client *client = user;
  static const char advice[] = "; a smaller --map, size or number of layers takes less";
  if (level == PN_LOG_ERROR)
    snprintf(client->reason, sizeof client->reason, "%s%s", text, message_id == PN_MESSAGE_GPU_MEMORY ? advice : "");
  else if (client->warming) return;
  else if (level == PN_LOG_WARNING) warning("%s", text);
  else note("%s: %s", pn_message_name(message_id), text);
}

int client_check(struct client *client, pn_result result) {
  if (result == PN_OK) return STATUS_OK;
  const char *reason = *client->reason ? client->reason : pn_result_name(result);
  int status = result == PN_ERROR_ARGUMENT ? input_error("%s", reason) : work_error("%s", reason);
  client->reason[0] = 0;
  return status;
}

static int add_mesh(struct client *client, const struct gpu_scene *gpu, int index, pn_mesh *out) {
  const struct mesh *mesh = &gpu->scene->meshes[index];
  const struct gpu_mesh *buffers = &gpu->meshes[index];
  pn_mesh_desc desc = {0};
  desc.positions = (pn_span){.buffer = buffers->positions, .count = mesh->vertex_count};
  desc.indices = (pn_span){.buffer = buffers->indices, .count = (size_t)mesh->triangle_count * 3};
  desc.index_bytes = 4;
  if (mesh->texture >= 0) {
    desc.texcoords = (pn_span){.buffer = buffers->texcoords, .count = mesh->vertex_count};
    desc.alpha_texture = gpu->textures[mesh->texture];
    desc.alpha_cutoff = mesh->cutoff;
  }
  memcpy(desc.bounds_min, mesh->bounds_min, sizeof desc.bounds_min);
  memcpy(desc.bounds_max, mesh->bounds_max, sizeof desc.bounds_max);
  return client_check(client, pn_mesh_add(client->casters, &desc, out));
}

/* Pure receivers are not registered: they are never in a caster's map. */
static int add_casters(struct client *client, const struct gpu_scene *gpu) {
  const struct scene *scene = gpu->scene;
  pn_mesh *known = calloc((size_t)scene->mesh_count + 1, sizeof *known);
  if (!known) return memory_error();
  int status = client_check(client, pn_casters_create(client->context, &client->casters));
  for (int i = 0; i < scene->instance_count && !status; i++) {
    const struct instance *instance = &scene->instances[i];
    if (!instance->casts) continue;
    pn_mesh *mesh = &known[instance->mesh];
    pn_instance ignored;
    if (!mesh->id) status = add_mesh(client, gpu, instance->mesh, mesh);
    if (!status) status = client_check(client, pn_instance_add(client->casters, *mesh, instance->placed, 0, &ignored));
  }
  free(known);
  return status;
}

static void describe_receiver(const struct gbuffer *g, const struct setup *setup, pn_receiver_desc *out) {
  pn_receiver_desc desc = PN_RECEIVER_DEFAULTS;
  desc.depth_texture = g->depth;
  desc.normal_texture = setup->normals_from_depth ? 0 : g->normal;
  desc.mask_texture = g->mask;
  desc.scale = setup->visibility_scale;
  desc.format = PN_FORMAT_R32F;
  memcpy(desc.view, g->view, sizeof desc.view);
  memcpy(desc.projection, g->projection, sizeof desc.projection);
  *out = desc;
}

static int set_receiver(struct client *client, const struct gbuffer *g, const struct setup *setup) {
  describe_receiver(g, setup, &client->view);
  int status = client_check(client, pn_receiver_create(client->context, &client->receiver));
  return status ? status : client_check(client, pn_receiver_set(client->receiver, &client->view));
}

int client_create(const struct gpu_scene *gpu, const struct gbuffer *g, pn_state_mode mode, struct client **out) {
  *out = NULL;
  struct client *client = calloc(1, sizeof *client);
  if (!client) return memory_error();
  client->width = g->width;
  client->height = g->height;
  memcpy(client->origin, gpu->scene->origin, sizeof client->origin);
  pn_context_desc desc = {.log = on_message, .user = client, .state = mode};
  desc.shader_directory = getenv("PENUMBRA_SHADERS");
  int status = client_check(client, pn_context_create(&desc, &client->context));
  if (!status) status = add_casters(client, gpu);
  if (!status) status = set_receiver(client, g, &gpu->scene->setup);
  if (status) client_free(&client);
  *out = client;
  return status;
}

void client_free(struct client **client) {
  if (!client || !*client) return;
  pn_context_destroy(&(*client)->context);
  free(*client);
  *client = NULL;
}

static void describe_light(const struct client *client, const struct setup *setup, const struct light *light,
                           pn_light_desc *desc) {
  memset(desc, 0, sizeof *desc);
  desc->shape = light->shape;
  for (int k = 0; k < 3; k++) {
    desc->center[k] = (float)(light->center[k] - client->origin[k]);
    desc->direction[k] = (float)light->direction[k];
    desc->axis_u[k] = (float)light->u[k];
  }
  desc->half_u = (float)light->half[0];
  desc->half_v = (float)light->half[1];
  desc->fit = setup->fit;
  for (int i = 0; i < 6; i++) desc->fit_bounds[i] = (float)(setup->fit_bounds[i] - client->origin[i % 3]);
  /* The library takes a box that is a point for one that was forgotten; here it was asked for, and warned of. */
  if (setup->fit == PN_FIT_GIVEN && memcmp(desc->fit_bounds, desc->fit_bounds + 3, sizeof(float[3])) == 0)
    desc->fit_bounds[3] = nextafterf(desc->fit_bounds[3], INFINITY);
  desc->map_width = setup->map[0];
  desc->map_height = setup->map[1];
}

int client_light(struct client *client, const struct setup *setup, const struct light *light, const char *spec,
                 pn_light **out) {
  pn_light_desc desc;
  describe_light(client, setup, light, &desc);
  int status = client_check(client, pn_light_create(client->context, out));
  if (!status && spec) {
    char why[400] = "";
    if (pn_light_technique(*out, spec, why, sizeof why) != PN_OK) status = input_error("%s: %s", spec, why);
    client->reason[0] = 0;
  }
  if (!status) status = client_check(client, pn_light_set(*out, &desc));
  if (!status && spec) status = client_check(client, pn_prepare(client->context, spec, &client->view));
  return status;
}

int client_maps(struct client *client, pn_light *light) {
  return client_check(client, pn_maps_update(light, client->casters, PN_GROUPS_ALL, &client->receiver, 1));
}

/* All levels, as GL says they are. */
static long long image_bytes(const pn_image *image) {
  static const GLenum sizes[] = {GL_TEXTURE_RED_SIZE, GL_TEXTURE_GREEN_SIZE, GL_TEXTURE_BLUE_SIZE,
                                 GL_TEXTURE_ALPHA_SIZE};
  enum { LEVELS_MAX = 16 };
  long long bytes = 0;
  glBindTexture(image->target, image->texture);
  for (int level = 0, width = 1; level < LEVELS_MAX && width > 0; level++) {
    GLint height = 0, depth = 0, bits = 0;
    glGetTexLevelParameteriv(image->target, level, GL_TEXTURE_WIDTH, &width);
    glGetTexLevelParameteriv(image->target, level, GL_TEXTURE_HEIGHT, &height);
    glGetTexLevelParameteriv(image->target, level, GL_TEXTURE_DEPTH, &depth);
    for (int i = 0; i < 4; i++) {
      GLint size = 0;
      glGetTexLevelParameteriv(image->target, level, sizes[i], &size);
      bits += size;
    }
    bytes += (long long)width * height * depth * bits / 8;
  }
  return bytes;
}

long long client_range_bytes(struct client *client, pn_light *light) {
  const char *name;
  pn_image image;
  for (int i = 0; pn_debug_image(light, client->receiver, i, &name, &image); i++)
    if (strcmp(name, "range") == 0) return image_bytes(&image);
  return 0;
}

int client_frame(struct client *client, pn_light *light) {
  int status = client_maps(client, light);
  return status ? status : client_check(client, pn_visibility(light, client->receiver));
}

/* GL's rows are bottom first. */
static int flip_rows(float *image, size_t row, int height) {
  float *below = malloc(row * sizeof *below);
  if (!below) return memory_error();
  for (int y = 0; y < height / 2; y++) {
    float *a = image + (size_t)y * row, *b = image + (size_t)(height - 1 - y) * row;
    memcpy(below, b, row * sizeof *below);
    memcpy(b, a, row * sizeof *below);
    memcpy(a, below, row * sizeof *below);
  }
  free(below);
  return STATUS_OK;
}

/* Texels of a texture of the view's size, top row first. */
static int read_image(const struct client *client, pn_gl texture, GLenum layout, size_t channels, float *out) {
  glBindTexture(GL_TEXTURE_2D, texture);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glGetTexImage(GL_TEXTURE_2D, 0, layout, GL_FLOAT, out);
  return flip_rows(out, (size_t)client->width * channels, client->height);
}

int client_visibility(struct client *client, pn_light *light, float *out) {
  pn_image image;
  int status = client_check(client, pn_result_image(light, client->receiver, &image));
  return status ? status : read_image(client, image.texture, GL_RED, 1, out);
}

/* ---- what a technique did on the way ----------------------------------------------------------------------------- */

static int read_debug(struct client *client, pn_light *light, const char *wanted, GLenum layout, size_t channels,
                      float **out) {
  const char *name;
  pn_image image;
  for (int i = 0; pn_debug_image(light, client->receiver, i, &name, &image); i++) {
    if (strcmp(name, wanted) != 0 || image.width != client->width || image.height != client->height) continue;
    *out = malloc((size_t)client->width * (size_t)client->height * channels * sizeof **out);
    return *out ? read_image(client, image.texture, layout, channels, *out) : memory_error();
  }
  return STATUS_OK;
}

/* The sides are merged by maximum, as the technique does. */
static void merge_sides(const pn_soft_shadow_map *map, const float *all, float *out) {
  size_t count = (size_t)map->image.width * (size_t)map->image.height * (size_t)map->layers;
  for (size_t i = 0; i < count; i++) {
    out[i] = all[i];
    for (int side = 1; side < map->sides; side++)
      if (all[(size_t)side * count + i] > out[i]) out[i] = all[(size_t)side * count + i];
  }
}

static int read_soft(struct client *client, pn_light *light, struct insides *out) {
  pn_soft_shadow_map map;
  if (pn_soft_shadow_map_image(light, client->receiver, &map) != PN_OK) {
    client->reason[0] = 0;
    return STATUS_OK;
  }
  size_t texels = (size_t)map.image.width * (size_t)map.image.height;
  float *all = malloc(texels * (size_t)map.image.layers * sizeof *all);
  out->soft = malloc(texels * (size_t)map.layers * sizeof *out->soft);
  if (!all || !out->soft) {
    free(all);
    return memory_error();
  }
  glBindTexture(GL_TEXTURE_2D_ARRAY, map.image.texture);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glGetTexImage(GL_TEXTURE_2D_ARRAY, 0, GL_RED, GL_FLOAT, all);
  merge_sides(&map, all, out->soft);
  free(all);
  out->soft_width = map.image.width;
  out->soft_height = map.image.height;
  out->soft_layers = map.layers;
  int status = STATUS_OK;
  for (int i = 0; i < map.layers && !status; i++)
    status = flip_rows(out->soft + (size_t)i * texels, (size_t)map.image.width, map.image.height);
  return status;
}

static int read_covered(struct client *client, pn_light *light, double *sum) {
  const char *name;
  pn_image image;
  for (int i = 0; pn_debug_image(light, client->receiver, i, &name, &image); i++) {
    if (strcmp(name, "covered") != 0) continue;
    size_t count = (size_t)image.width * (size_t)image.height * (size_t)image.layers;
    float *counts = malloc(count * sizeof *counts);
    if (!counts) return memory_error();
    glBindTexture(image.target, image.texture);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glGetTexImage(image.target, 0, GL_RED, GL_FLOAT, counts);
    for (size_t k = 0; k < count; k++) *sum += counts[k];
    free(counts);
  }
  return STATUS_OK;
}

int client_insides(struct client *client, pn_light *light, int debug_flags, struct insides *out) {
  memset(out, 0, sizeof *out);
  int status = client_check(client, pn_debug(client->context, debug_flags));
  if (!status) status = client_frame(client, light);
  if (!status) status = client_check(client, pn_debug(client->context, 0));
  if (!status && debug_flags & PN_DEBUG_SEARCH) status = read_debug(client, light, "search", GL_RGBA, 4, &out->search);
  if (!status && out->search) status = read_debug(client, light, "levels", GL_RG, 2, &out->levels);
  if (!status && debug_flags & PN_DEBUG_SEARCH) status = read_covered(client, light, &out->covered);
  if (!status && debug_flags & PN_DEBUG_BOUND) status = read_debug(client, light, "bound", GL_RED, 1, &out->bound);
  return status ? status : read_soft(client, light, out);
}

void insides_free(struct insides *insides) {
  free(insides->search);
  free(insides->levels);
  free(insides->bound);
  free(insides->soft);
  memset(insides, 0, sizeof *insides);
}
