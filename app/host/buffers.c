#include "host/buffers.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/message.h"
#include "scene/vector.h"

static pn_gl upload(GLenum target, const void *data, size_t bytes) {
  GLuint buffer = 0;
  glGenBuffers(1, &buffer);
  glBindBuffer(target, buffer);
  glBufferData(target, (GLsizeiptr)bytes, data, GL_STATIC_DRAW);
  return buffer;
}

/* Unit normals from the corners in double, so that a flat face has one normal to the last bit. */
static void triangle_normal(const struct mesh *mesh, uint32_t triangle, float out[4]) {
  double p[3][3], a[3], b[3], n[3];
  for (int c = 0; c < 3; c++)
    for (int k = 0; k < 3; k++)
      p[c][k] = mesh->positions[3 * (size_t)mesh->indices[3 * (size_t)triangle + (size_t)c] + (size_t)k];
  v3_sub(p[1], p[0], a);
  v3_sub(p[2], p[0], b);
  v3_cross(a, b, n);
  v3_normalize(n);
  for (int k = 0; k < 3; k++) out[k] = (float)n[k];
  out[3] = 0;
}

static int upload_run(const struct mesh *mesh, struct gpu_run *run) {
  float *normals = malloc((size_t)run->count * 4 * sizeof *normals);
  if (!normals) return memory_error();
  for (uint32_t i = 0; i < run->count; i++) triangle_normal(mesh, run->first + i, &normals[4 * (size_t)i]);
  run->normal_buffer = upload(GL_TEXTURE_BUFFER, normals, (size_t)run->count * 4 * sizeof *normals);
  free(normals);
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_BUFFER, texture);
  glTexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, run->normal_buffer);
  run->normals = texture;
  return STATUS_OK;
}

static int upload_mesh(const struct mesh *mesh, struct gpu_mesh *gpu) {
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &limit);
  if (limit < 1) limit = 65536;
  GLuint array = 0;
  glGenVertexArrays(1, &array);
  glBindVertexArray(array);
  gpu->vertex_array = array;
  gpu->positions = upload(GL_ARRAY_BUFFER, mesh->positions, (size_t)mesh->vertex_count * 3 * sizeof(float));
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, NULL);
  glEnableVertexAttribArray(0);
  if (mesh->texcoords) {
    gpu->texcoords = upload(GL_ARRAY_BUFFER, mesh->texcoords, (size_t)mesh->vertex_count * 2 * sizeof(float));
    glVertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, 0, NULL);
    glEnableVertexAttribArray(1);
  }
  gpu->indices = upload(GL_ELEMENT_ARRAY_BUFFER, mesh->indices, (size_t)mesh->triangle_count * 3 * sizeof(uint32_t));
  glBindVertexArray(0);
  uint32_t most = (uint32_t)limit;
  gpu->run_count = (int)((mesh->triangle_count + (uint64_t)most - 1) / most);
  gpu->runs = calloc((size_t)gpu->run_count + 1, sizeof *gpu->runs);
  if (!gpu->runs) return memory_error();
  int status = STATUS_OK;
  for (int i = 0; i < gpu->run_count && !status; i++) {
    uint32_t first = (uint32_t)i * most;
    gpu->runs[i].first = first;
    gpu->runs[i].count = mesh->triangle_count - first < most ? mesh->triangle_count - first : most;
    status = upload_run(mesh, &gpu->runs[i]);
  }
  return status;
}

static pn_gl upload_texture(const struct texture *texture) {
  static const GLint wraps[] = {GL_REPEAT, GL_CLAMP_TO_EDGE, GL_MIRRORED_REPEAT};
  GLuint name = 0;
  glGenTextures(1, &name);
  glBindTexture(GL_TEXTURE_2D, name);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, texture->width, texture->height, 0, GL_RED, GL_UNSIGNED_BYTE, texture->alpha);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wraps[texture->wrap_u]);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wraps[texture->wrap_v]);
  return name;
}

/* An alpha texture beyond the device's limit cannot be shrunk without moving its holes. */
static int check_textures(const struct scene *scene) {
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  for (int i = 0; i < scene->texture_count; i++)
    if (scene->textures[i].width > limit || scene->textures[i].height > limit)
      return work_error("an alpha texture of %d x %d texels is beyond this device's %d", scene->textures[i].width,
                        scene->textures[i].height, limit);
  return STATUS_OK;
}

int gpu_scene_create(const struct scene *scene, struct gpu_scene **out) {
  *out = NULL;
  int status = check_textures(scene);
  if (status) return status;
  struct gpu_scene *gpu = calloc(1, sizeof *gpu);
  if (!gpu) return memory_error();
  gpu->scene = scene;
  gpu->meshes = calloc((size_t)scene->mesh_count + 1, sizeof *gpu->meshes);
  gpu->textures = calloc((size_t)scene->texture_count + 1, sizeof *gpu->textures);
  if (!gpu->meshes || !gpu->textures) status = memory_error();
  for (int i = 0; i < scene->texture_count && !status; i++) gpu->textures[i] = upload_texture(&scene->textures[i]);
  for (int i = 0; i < scene->mesh_count && !status; i++) status = upload_mesh(&scene->meshes[i], &gpu->meshes[i]);
  if (!status && glGetError() == GL_OUT_OF_MEMORY)
    status = work_error("the GL device ran out of memory for the scene's triangles");
  if (status) gpu_scene_free(&gpu);
  *out = gpu;
  return status;
}

static void free_mesh(struct gpu_mesh *mesh) {
  const GLuint buffers[3] = {mesh->positions, mesh->texcoords, mesh->indices};
  glDeleteBuffers(3, buffers);
  glDeleteVertexArrays(1, &mesh->vertex_array);
  for (int i = 0; mesh->runs && i < mesh->run_count; i++) {
    glDeleteTextures(1, &mesh->runs[i].normals);
    glDeleteBuffers(1, &mesh->runs[i].normal_buffer);
  }
  free(mesh->runs);
}

void gpu_scene_free(struct gpu_scene **gpu) {
  if (!gpu || !*gpu) return;
  struct gpu_scene *g = *gpu;
  for (int i = 0; g->meshes && i < g->scene->mesh_count; i++) free_mesh(&g->meshes[i]);
  if (g->textures) glDeleteTextures(g->scene->texture_count, g->textures);
  free(g->meshes);
  free(g->textures);
  free(g);
  *gpu = NULL;
}
