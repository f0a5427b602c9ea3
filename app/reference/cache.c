#include "reference/cache.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define PATH_BYTES 4096
#define SUFFIX ".visibility"

/* ---- what a result depends on ------------------------------------------------------------------------------------ */

static void hash_mesh(struct hash *hash, const struct reference_mesh *mesh) {
  hash_array(hash, mesh->positions, mesh->vertex_count, 3 * sizeof(float));
  hash_array(hash, mesh->indices, mesh->triangle_count, 3 * sizeof(uint32_t));
  const struct reference_alpha *alpha = mesh->alpha;
  if (!alpha) {
    hash_array(hash, NULL, 0, 0);
    return;
  }
  int32_t form[4] = {alpha->width, alpha->height, alpha->wrap_s, alpha->wrap_t};
  hash_array(hash, form, 4, sizeof form[0]);
  hash_array(hash, alpha->texels, (size_t)alpha->width * (size_t)alpha->height, 1);
  hash_array(hash, mesh->texcoords, mesh->vertex_count, 2 * sizeof(float));
  hash_array(hash, &mesh->cutoff, 1, sizeof mesh->cutoff);
}

static void hash_light(struct hash *hash, const struct reference_light *light) {
  int32_t shape = light->shape;
  hash_array(hash, &shape, 1, sizeof shape);
  hash_array(hash, light->center, light->shape == REFERENCE_RECTANGLE ? 3 : 0, sizeof(double));
  hash_array(hash, light->direction, 3, sizeof(double));
  hash_array(hash, light->u, 3, sizeof(double));
  hash_array(hash, light->v, 3, sizeof(double));
  hash_array(hash, light->half, 2, sizeof(double));
}

struct digest cache_key(const struct reference_casters *casters, const struct reference_light *light,
                        const struct reference_points *points, int samples) {
  struct hash hash;
  hash_begin(&hash);
  int32_t head[6] = {REFERENCE_VERSION,      samples, points->width, points->height, casters->mesh_count,
                     casters->instance_count};
  hash_array(&hash, head, 6, sizeof head[0]);
  for (int i = 0; i < casters->mesh_count; i++) hash_mesh(&hash, &casters->meshes[i]);
  for (int i = 0; i < casters->instance_count; i++) {
    int32_t mesh = casters->instances[i].mesh;
    hash_array(&hash, &mesh, 1, sizeof mesh);
    hash_array(&hash, casters->instances[i].scene_from_object, 16, sizeof(float));
  }
  hash_light(&hash, light);
  size_t count = (size_t)points->width * (size_t)points->height;
  hash_array(&hash, points->positions, count, 3 * sizeof(float));
  hash_array(&hash, points->normals, count, 3 * sizeof(float));
  hash_array(&hash, points->receives, points->receives ? count : 0, 1);
  hash_array(&hash, points->errors, points->errors ? count : 0, sizeof(float));
  return hash_end(&hash);
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

/* A file: this, then the floats, then the digest of both. Numbers are the machine's: caches do not travel. */
struct file_head {
  char magic[24];
  struct digest key;
  uint64_t count, rays;
  double seconds;
};
static const char magic[24] = "penumbra visibility 1\n";

int cache_directory(char *path, size_t size) {
  const char *base = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
  int length = -1;
  if (base && base[0] == '/') length = snprintf(path, size, "%s/penumbra/reference", base);
  else if (home && home[0] == '/') length = snprintf(path, size, "%s/.cache/penumbra/reference", home);
  return length > 0 && (size_t)length < size;
}

static int file_path(const struct digest *key, char *path, size_t size) {
  char directory[PATH_BYTES], name[33];
  if (!cache_directory(directory, sizeof directory)) return 0;
  for (int i = 0; i < 16; i++) snprintf(name + 2 * i, 3, "%02x", key->bytes[i]);
  return (size_t)snprintf(path, size, "%s/%s%s", directory, name, SUFFIX) < size;
}

static struct digest checksum(const struct file_head *head, const float *visibility) {
  struct hash hash;
  hash_begin(&hash);
  hash_bytes(&hash, head, sizeof *head);
  hash_bytes(&hash, visibility, (size_t)head->count * sizeof(float));
  return hash_end(&hash);
}

static int values_possible(const float *visibility, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (!(visibility[i] >= 0 && visibility[i] <= 1)) return 0;
  return 1;
}

/* Returns 0 for a file that is not exactly what cache_store writes for this key. */
static int read_file(FILE *file, const struct digest *key, size_t count, float *visibility,
                     struct reference_result *result) {
  struct file_head head;
  struct digest stored;
  if (fread(&head, sizeof head, 1, file) != 1 || memcmp(head.magic, magic, sizeof magic) != 0 ||
      memcmp(&head.key, key, sizeof *key) != 0 || head.count != count)
    return 0;
  if (fread(visibility, sizeof(float), count, file) != count || fread(&stored, sizeof stored, 1, file) != 1 ||
      fgetc(file) != EOF)
    return 0;
  struct digest found = checksum(&head, visibility);
  if (memcmp(&found, &stored, sizeof stored) != 0 || !values_possible(visibility, count)) return 0;
  result->seconds = head.seconds;
  result->rays = head.rays;
  return isfinite(head.seconds) && head.seconds >= 0;
}

int cache_load(const struct digest *key, size_t count, float *visibility, struct reference_result *result, char *why,
               size_t why_size) {
  char path[PATH_BYTES];
  why[0] = 0;
  if (!file_path(key, path, sizeof path)) return 0; /* cache_store says so */
  /* Not blocking: a FIFO under that name must not hold the program. */
  int descriptor = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) {
    if (errno != ENOENT && errno != ENOTDIR)
      snprintf(why, why_size, "%s: %s; the reference is traced again", path, strerror(errno));
    return 0;
  }
  struct stat status;
  FILE *file = fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) ? fdopen(descriptor, "rb") : NULL;
  if (!file) {
    close(descriptor);
    snprintf(why, why_size, "%s: not a regular file; the reference is traced again", path);
    return 0;
  }
  int good = read_file(file, key, count, visibility, result);
  if (good) futimens(descriptor, NULL); /* last used now; where that fails it is only removed earlier */
  else snprintf(why, why_size, "%s: damaged; the reference is traced again", path);
  fclose(file);
  return good;
}

/* mkdir -p; fails with errno set. */
static int make_directories(const char *directory) {
  char path[PATH_BYTES];
  if ((size_t)snprintf(path, sizeof path, "%s", directory) >= sizeof path) {
    errno = ENAMETOOLONG;
    return 0;
  }
  for (char *slash = path + 1;; slash++) {
    if (*slash != '/' && *slash != 0) continue;
    char kept = *slash;
    *slash = 0;
    if (mkdir(path, 0700) != 0 && errno != EEXIST) return 0;
    *slash = kept;
    if (!kept) return 1;
  }
}

static int write_file(int descriptor, const struct digest *key, size_t count, const float *visibility,
                      const struct reference_result *result) {
  FILE *file = fdopen(descriptor, "wb");
  if (!file) {
    close(descriptor);
    return 0;
  }
  struct file_head head;
  memset(&head, 0, sizeof head);
  memcpy(head.magic, magic, sizeof magic);
  head.key = *key;
  head.count = count;
  head.rays = result->rays;
  head.seconds = result->seconds;
  struct digest sum = checksum(&head, visibility);
  int written = fwrite(&head, sizeof head, 1, file) == 1 && fwrite(visibility, sizeof(float), count, file) == count &&
                fwrite(&sum, sizeof sum, 1, file) == 1;
  return (fclose(file) == 0) & written;
}

int cache_store(const struct digest *key, size_t count, const float *visibility, const struct reference_result *result,
                char *why, size_t why_size) {
  char directory[PATH_BYTES], path[PATH_BYTES], temporary[PATH_BYTES + 16];
  why[0] = 0;
  if (!cache_directory(directory, sizeof directory) || !file_path(key, path, sizeof path)) {
    snprintf(why, why_size, "no cache directory: neither XDG_CACHE_HOME nor HOME names one; the reference is not kept");
    return 0;
  }
  snprintf(temporary, sizeof temporary, "%s.XXXXXX", path);
  int descriptor = make_directories(directory) ? mkstemp(temporary) : -1;
  int stored = 0;
  if (descriptor >= 0) {
    stored = write_file(descriptor, key, count, visibility, result) && rename(temporary, path) == 0;
    if (!stored) {
      int reason = errno;
      unlink(temporary);
      errno = reason;
    }
  }
  if (!stored) snprintf(why, why_size, "%s: %s; the reference is not kept", directory, strerror(errno));
  else cache_trim(directory, CACHE_BYTES_MAX);
  return stored;
}

/* ---- size -------------------------------------------------------------------------------------------------------- */

struct entry {
  struct timespec used;
  unsigned long long bytes;
  char name[80];
};

static int longest_unused_first(const void *a, const void *b) {
  const struct entry *x = a, *y = b;
  if (x->used.tv_sec != y->used.tv_sec) return x->used.tv_sec < y->used.tv_sec ? -1 : 1;
  if (x->used.tv_nsec != y->used.tv_nsec) return x->used.tv_nsec < y->used.tv_nsec ? -1 : 1;
  return strcmp(x->name, y->name);
}

/* Only files this module made: 32 hexadecimal digits and the suffix, perhaps with what mkstemp appended. */
static int is_ours(const char *name) {
  return strspn(name, "0123456789abcdef") == 32 && strncmp(name + 32, SUFFIX, strlen(SUFFIX)) == 0 &&
         strlen(name) < sizeof((struct entry *)0)->name;
}

/* Left behind by a run that was killed while it wrote. */
static int is_stale_temporary(const char *name, const struct stat *status) {
  return strlen(name) > 32 + strlen(SUFFIX) && status->st_mtim.tv_sec < time(NULL) - 3600;
}

static size_t list_entries(DIR *directory, struct entry **out) {
  size_t count = 0, room = 0;
  for (struct dirent *item; (item = readdir(directory));) {
    struct stat status;
    if (!is_ours(item->d_name) || fstatat(dirfd(directory), item->d_name, &status, AT_SYMLINK_NOFOLLOW) != 0 ||
        !S_ISREG(status.st_mode))
      continue;
    if (is_stale_temporary(item->d_name, &status)) {
      unlinkat(dirfd(directory), item->d_name, 0);
      continue;
    }
    if (count == room) {
      room = room ? 2 * room : 64;
      struct entry *larger = realloc(*out, room * sizeof **out);
      if (!larger) break;
      *out = larger;
    }
    struct entry *entry = &(*out)[count++];
    entry->used = status.st_mtim;
    entry->bytes = (unsigned long long)status.st_size;
    strcpy(entry->name, item->d_name);
  }
  return count;
}

void cache_trim(const char *path, unsigned long long bytes_max) {
  DIR *directory = opendir(path);
  if (!directory) return;
  struct entry *entries = NULL;
  size_t count = list_entries(directory, &entries);
  unsigned long long bytes = 0;
  for (size_t i = 0; i < count; i++) bytes += entries[i].bytes;
  if (count) qsort(entries, count, sizeof *entries, longest_unused_first);
  for (size_t i = 0; i < count && bytes > bytes_max; i++)
    if (unlinkat(dirfd(directory), entries[i].name, 0) == 0) bytes -= entries[i].bytes;
  free(entries);
  closedir(directory);
}
