#include "scene/import.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/message.h"
#include "base/utf8.h"
#include "files/image.h"
#include "scene/import_process.h"
#include "scene/import_records.h"

static int check_file(const char *path, struct stat *info) {
  if (stat(path, info) != 0) return input_error("%s: %s", path, strerror(errno));
  if (S_ISDIR(info->st_mode)) return input_error("%s: is a directory, not a model file", path);
  if (!S_ISREG(info->st_mode)) return input_error("%s: is not a regular file", path);
  if (info->st_size == 0) return input_error("%s: the file is empty", path);
  if (access(path, R_OK) != 0) return input_error("%s: %s", path, strerror(errno));
  return STATUS_OK;
}

/* 0: all size bytes; -1: the pipe ended. */
static int read_all(int fd, void *bytes, size_t size) {
  for (size_t done = 0; done < size;) {
    ssize_t n = read(fd, (char *)bytes + done, size - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return -1;
    done += (size_t)n;
  }
  return 0;
}

static void *read_array(int fd, size_t count, size_t element) {
  void *array = count <= SIZE_MAX / element ? malloc(count * element + 1) : NULL;
  if (array && read_all(fd, array, count * element)) {
    free(array);
    return NULL;
  }
  return array;
}

enum received { RECEIVED_MORE, RECEIVED_END, RECEIVED_ERROR, RECEIVED_BROKEN };

static enum received receive_mesh(int fd, const struct record *r, struct scene *scene) {
  struct mesh mesh = {
      .vertex_count = r->vertex_count, .triangle_count = r->triangle_count, .texture = r->texture, .cutoff = r->cutoff};
  if (r->texture >= scene->texture_count || r->triangle_count > UINT32_MAX / 3) return RECEIVED_BROKEN;
  mesh.positions = read_array(fd, r->vertex_count, 3 * sizeof(float));
  if (mesh.positions && r->texture >= 0) mesh.texcoords = read_array(fd, r->vertex_count, 2 * sizeof(float));
  if (mesh.positions && (r->texture < 0 || mesh.texcoords))
    mesh.indices = read_array(fd, r->triangle_count, 3 * sizeof(uint32_t));
  int broken = !mesh.indices;
  for (size_t i = 0; !broken && i < 3 * (size_t)mesh.triangle_count; i++) broken = mesh.indices[i] >= mesh.vertex_count;
  if (broken) {
    mesh_free(&mesh);
    return RECEIVED_BROKEN;
  }
  return scene_add_mesh(scene, &mesh) < 0 ? RECEIVED_BROKEN : RECEIVED_MORE;
}

static enum received receive_texture(int fd, const struct record *r, struct scene *scene) {
  if (r->width < 1 || r->height < 1 || r->width > IMAGE_SIZE_MAX || r->height > IMAGE_SIZE_MAX) return RECEIVED_BROKEN;
  struct texture texture = {.width = r->width, .height = r->height, .wrap_u = r->wrap_u, .wrap_v = r->wrap_v};
  texture.alpha = read_array(fd, (size_t)r->width, (size_t)r->height);
  return !texture.alpha || scene_add_texture(scene, &texture) < 0 ? RECEIVED_BROKEN : RECEIVED_MORE;
}

static enum received receive_instance(const struct record *r, struct scene *scene) {
  if (r->mesh < 0 || r->mesh >= scene->mesh_count) return RECEIVED_BROKEN;
  return scene_add_instance(scene, r->mesh, r->scene_from_object, 1, 1) < 0 ? RECEIVED_BROKEN : RECEIVED_MORE;
}

static enum received receive_text(int fd, const struct record *r, const char *path) {
  char text[512];
  if (r->text_size >= sizeof text || read_all(fd, text, r->text_size)) return RECEIVED_BROKEN;
  text[r->text_size] = 0;
  if (r->tag == RECORD_ERROR) {
    input_error("%s: %s", path, text);
    return RECEIVED_ERROR;
  }
  warning("%s: %s", path, text);
  return RECEIVED_MORE;
}

static enum received receive(int fd, const char *path, struct scene *scene) {
  struct record r;
  if (read_all(fd, &r, sizeof r)) return RECEIVED_BROKEN;
  switch (r.tag) {
  case RECORD_MESH: return receive_mesh(fd, &r, scene);
  case RECORD_TEXTURE: return receive_texture(fd, &r, scene);
  case RECORD_INSTANCE:
    return receive_instance(&r, scene);
  case RECORD_WARNING:
  case RECORD_ERROR: return receive_text(fd, &r, path);
  case RECORD_END: return RECEIVED_END;
  default: return RECEIVED_BROKEN;
  }
}

/* How a child that sent neither an end nor an error came to its own. */
static int explain_death(const char *path, int wait_status, off_t size) {
  if (WIFSIGNALED(wait_status)) {
    int number = WTERMSIG(wait_status);
    if (number == SIGXCPU)
      return input_error("%s: importing took more than %u s, too long for a file of its size; it is probably damaged",
                         path, import_seconds(size));
    if (number == SIGKILL) return work_error("%s: the importer was killed, perhaps because memory ran out", path);
    return input_error("%s: the importer crashed on it (%s); the file is probably damaged", path, strsignal(number));
  }
  /* What a shell and the dynamic linker say of a program that does not start. */
  if (WEXITSTATUS(wait_status) == 127) return work_error("%s: the importer does not start", path);
  return input_error("%s: the importer gave up on it; the file is probably damaged or far too large", path);
}

/* "dir/bunny.obj" is "bunny". */
static struct scene *scene_named_after(const char *path) {
  const char *slash = strrchr(path, '/');
  struct scene *scene = scene_new(slash ? slash + 1 : path);
  if (!scene) return NULL;
  char *dot = strrchr(scene->name, '.');
  if (dot && dot != scene->name) *dot = 0;
  utf8_mend(scene->name);
  return scene;
}

int import_model(const char *path, int up_is_z, struct scene **out) {
  *out = NULL;
  struct stat info;
  int status = check_file(path, &info);
  if (status) return status;
  struct scene *scene = scene_named_after(path);
  if (!scene) return memory_error();
  pid_t child = 0;
  int fd = import_start(path, up_is_z, info.st_size, &child);
  if (fd < 0) {
    scene_free(&scene);
    return work_error("cannot start the importer: %s", strerror(errno));
  }
  enum received last;
  do last = receive(fd, path, scene);
  while (last == RECEIVED_MORE);
  close(fd);
  if (last != RECEIVED_BROKEN) kill(child, SIGKILL); /* it has nothing left to say; freeing what it holds takes time */
  int wait_status = 0;
  while (waitpid(child, &wait_status, 0) < 0 && errno == EINTR) {
  }
  if (last == RECEIVED_END) {
    *out = scene;
    return STATUS_OK;
  }
  scene_free(&scene);
  return last == RECEIVED_ERROR ? STATUS_INPUT : explain_death(path, wait_status, info.st_size);
}
