/* The cache of traced visibility, in a directory of the test's own: kept, found, never believed when damaged. */
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "reference/cache.h"
#include "reference_scenes.h"

static char base[512], directory[1024];

static int set_up(void **state) {
  (void)state;
  snprintf(base, sizeof base, "%s/penumbra-cache-XXXXXX", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
  if (!mkdtemp(base)) return -1;
  setenv("XDG_CACHE_HOME", base, 1);
  return !cache_directory(directory, sizeof directory);
}

static int tear_down(void **state) {
  (void)state;
  char command[1200];
  snprintf(command, sizeof command, "chmod -R u+rwx '%s'; rm -rf '%s'", base, base);
  return system(command);
}

/* The published vectors of SipHash-2-4-128: key 00 01 .. 0f; and one longer, checked with another implementation. */
static void hash_is_siphash(void **state) {
  (void)state;
  static const struct {
    const char *text;
    uint8_t digest[16];
  } vectors[] = {
      {"", {0xa3, 0x81, 0x7f, 0x04, 0xba, 0x25, 0xa8, 0xe6, 0x6d, 0xf6, 0x72, 0x14, 0xc7, 0x55, 0x02, 0x93}},
      {"a", {0x0e, 0xa4, 0xf2, 0xfb, 0x02, 0xad, 0x21, 0xd9, 0x2d, 0x5f, 0xc9, 0x16, 0x84, 0xf2, 0x64, 0x26}},
      {"The quick brown fox jumps over the lazy dog",
       {0x76, 0x28, 0xc9, 0x30, 0x1a, 0xa4, 0x41, 0x25, 0x55, 0xe6, 0x52, 0x27, 0xcd, 0x31, 0x96, 0x4e}},
  };
  for (size_t i = 0; i < 3; i++)
    for (size_t step = 1; step <= 17; step += 4) { /* however it is cut */
      struct hash hash;
      hash_begin(&hash);
      size_t length = strlen(vectors[i].text);
      for (size_t at = 0; at < length; at += step)
        hash_bytes(&hash, vectors[i].text + at, length - at < step ? length - at : step);
      struct digest digest = hash_end(&hash);
      assert_memory_equal(digest.bytes, vectors[i].digest, 16);
    }
}

/* ---- keys -------------------------------------------------------------------------------------------------------- */

struct inputs {
  struct quad quad;
  struct reference_mesh mesh;
  struct reference_instance instance;
  struct reference_casters casters;
  struct reference_light light;
  struct plane_points plane;
  uint8_t texels[4], receives[12];
  float errors[12];
  struct reference_alpha alpha;
};

static void fill_inputs(struct inputs *in) {
  memset(in, 0, sizeof *in);
  in->quad = horizontal_quad(1, -1, 1, -1, 1);
  in->mesh = quad_mesh(&in->quad);
  in->alpha = (struct reference_alpha){2, 2, in->texels, REFERENCE_REPEAT, REFERENCE_REPEAT};
  in->mesh.alpha = &in->alpha;
  in->mesh.cutoff = 0.5f;
  in->instance = (struct reference_instance){0, IDENTITY};
  in->casters = (struct reference_casters){&in->mesh, &in->instance, 1, 1};
  in->light = light_down(REFERENCE_RECTANGLE, 3, 0.5, 0.5);
  in->plane = plane_points(4, 3, -1, 1, -1, 1);
  memset(in->receives, 1, sizeof in->receives);
  in->plane.points.receives = in->receives;
  in->plane.points.errors = in->errors;
}

static void everything_is_in_the_key(void **state) {
  (void)state;
  struct digest keys[32];
  int count = 0, samples = 0;
  for (int change = 0; change <= 17; change++) {
    struct inputs in;
    fill_inputs(&in);
    samples = 16;
    switch (change) {
    case 1: in.quad.positions[4] += 1e-6f; break;
    case 2: in.quad.indices[2] = 3; break;
    case 3: in.quad.texcoords[0] = 0.1f; break;
    case 4: in.texels[3] = 1; break;
    case 5: in.alpha.wrap_t = REFERENCE_CLAMP; break;
    case 6: in.mesh.cutoff = 0.25f; break;
    case 7: in.mesh.alpha = NULL; break;
    case 8: in.instance.scene_from_object[13] = 1; break;
    case 9: in.casters.instance_count = 0; break;
    case 10: in.light.shape = REFERENCE_SUN; break;
    case 11: in.light.half[1] = 0.25; break;
    case 12: in.light.center[0] = 1e-9; break;
    case 13: in.plane.positions[0] += 1e-6f; break;
    case 14: in.plane.normals[4] = -1; break;
    case 15: in.receives[7] = 0; break;
    case 16: in.errors[2] = 1e-6f; break;
    case 17: samples = 25; break;
    }
    struct digest key = cache_key(&in.casters, &in.light, &in.plane.points, samples);
    for (int i = 0; i < count; i++) assert_memory_not_equal(keys[i].bytes, key.bytes, 16);
    keys[count++] = key;
    plane_points_free(&in.plane);
  }
  struct inputs again;
  fill_inputs(&again);
  struct digest key = cache_key(&again.casters, &again.light, &again.plane.points, 16);
  assert_memory_equal(keys[0].bytes, key.bytes, 16);
  plane_points_free(&again.plane);
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

#define COUNT 100
static char why[2048];

static struct digest numbered_key(int number) {
  struct hash hash;
  hash_begin(&hash);
  hash_bytes(&hash, &number, sizeof number);
  return hash_end(&hash);
}

static void path_of(const struct digest *key, char *path, size_t size) {
  int length = snprintf(path, size, "%s/", directory);
  for (int i = 0; i < 16; i++) length += snprintf(path + length, size - (size_t)length, "%02x", key->bytes[i]);
  snprintf(path + length, size - (size_t)length, ".visibility");
}

static int store(int number, float first) {
  struct digest key = numbered_key(number);
  struct reference_result result = {12.5, 777};
  float visibility[COUNT] = {first, 1, 0.25f};
  return cache_store(&key, COUNT, visibility, &result, why, sizeof why);
}

static int load(int number, float *first) {
  struct digest key = numbered_key(number);
  struct reference_result result = {0, 0};
  float visibility[COUNT];
  int found = cache_load(&key, COUNT, visibility, &result, why, sizeof why);
  if (found) {
    *first = visibility[0];
    assert_true(visibility[1] == 1 && visibility[2] == 0.25f && visibility[COUNT - 1] == 0);
    assert_true(result.seconds == 12.5 && result.rays == 777);
  }
  return found;
}

static void what_is_stored_is_found(void **state) {
  (void)state;
  float first = 0;
  assert_false(load(1, &first));
  assert_string_equal(why, ""); /* not being there is no trouble */
  assert_true(store(1, 0.5f));
  assert_string_equal(why, "");
  assert_true(load(1, &first));
  assert_true(first == 0.5f);
  assert_true(store(1, 0.75f)); /* replaced */
  assert_true(load(1, &first));
  assert_true(first == 0.75f);
  struct digest key = numbered_key(1);
  struct reference_result result;
  float one[COUNT + 1];
  assert_false(cache_load(&key, COUNT + 1, one, &result, why, sizeof why)); /* another size cannot be meant */
}

static void rewrite(const char *path, const uint8_t *bytes, size_t size) {
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(bytes, 1, size, file), size);
  assert_int_equal(fclose(file), 0);
}

/* Every single bit counts, and so does the length. */
static void damage_is_seen(void **state) {
  (void)state;
  char path[2048];
  static uint8_t bytes[4096], damaged[4096];
  assert_true(store(2, 0.5f));
  struct digest key = numbered_key(2);
  path_of(&key, path, sizeof path);
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  size_t size = fread(bytes, 1, sizeof bytes, file);
  fclose(file);
  float first;
  for (size_t i = 0; i < size; i++) {
    memcpy(damaged, bytes, size);
    damaged[i] ^= (uint8_t)(1 << i % 8);
    rewrite(path, damaged, size);
    assert_false(load(2, &first));
    assert_non_null(strstr(why, "damaged"));
  }
  const size_t lengths[] = {0, 1, 50, size - 17, size - 16, size - 1, size + 1};
  for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
    rewrite(path, bytes, lengths[i]);
    assert_false(load(2, &first));
    assert_non_null(strstr(why, "damaged"));
  }
  rewrite(path, bytes, size);
  assert_true(load(2, &first));
}

/* A result that says more than all or less than nothing is never believed, whatever its checksum. */
static void impossible_values_are_seen(void **state) {
  (void)state;
  static const float impossible[] = {-0.1f, 1.1f};
  float first, zero = 0;
  for (size_t i = 0; i < 2; i++) {
    assert_true(store(3, impossible[i]));
    assert_false(load(3, &first));
  }
  assert_true(store(3, zero / zero));
  assert_false(load(3, &first));
}

static void odd_files_are_passed_by(void **state) {
  (void)state;
  char path[2048];
  float first;
  struct digest key = numbered_key(4);
  path_of(&key, path, sizeof path);
  assert_int_equal(mkdir(path, 0700), 0);
  assert_false(load(4, &first));
  assert_true(strlen(why) > 0);
  assert_false(store(4, 0.5f));
  assert_true(strlen(why) > 0);
  assert_int_equal(rmdir(path), 0);
  assert_int_equal(mkfifo(path, 0600), 0);
  assert_false(load(4, &first)); /* and does not wait for a writer */
  assert_true(strlen(why) > 0);
  assert_int_equal(unlink(path), 0);
}

static void directories_that_cannot_be(void **state) {
  (void)state;
  float first;
  setenv("XDG_CACHE_HOME", "/dev/null", 1);
  assert_false(load(5, &first));
  assert_false(store(5, 0.5f));
  assert_non_null(strstr(why, "/dev/null"));
  setenv("XDG_CACHE_HOME", "/proc/self", 1);
  assert_false(store(5, 0.5f));
  static char long_name[5000];
  memset(long_name, 'x', sizeof long_name - 1);
  long_name[0] = '/';
  setenv("XDG_CACHE_HOME", long_name, 1);
  assert_false(store(5, 0.5f));
  assert_false(load(5, &first));
  /* A relative XDG_CACHE_HOME is ignored, as the convention wants. */
  setenv("XDG_CACHE_HOME", "relative", 1);
  setenv("HOME", base, 1);
  char path[1024];
  assert_true(cache_directory(path, sizeof path));
  assert_memory_equal(path, base, strlen(base));
  assert_string_equal(path + strlen(base), "/.cache/penumbra/reference");
  setenv("HOME", "", 1);
  assert_false(cache_directory(path, sizeof path));
  assert_false(store(5, 0.5f));
  assert_true(strlen(why) > 0);
  setenv("XDG_CACHE_HOME", base, 1);
}

static void set_age(int number, int seconds) {
  char path[2048];
  struct digest key = numbered_key(number);
  path_of(&key, path, sizeof path);
  struct timespec times[2];
  clock_gettime(CLOCK_REALTIME, &times[0]);
  times[0].tv_sec -= seconds;
  times[1] = times[0];
  assert_int_equal(utimensat(AT_FDCWD, path, times, 0), 0);
}

static void longest_unused_goes_first(void **state) {
  (void)state;
  cache_trim(directory, 0);
  float first;
  for (int i = 10; i < 15; i++) assert_true(store(i, 0.5f));
  for (int i = 10; i < 15; i++) set_age(i, 10000 * (20 - i));
  char foreign[2048];
  snprintf(foreign, sizeof foreign, "%s/notes.txt", directory);
  rewrite(foreign, (const uint8_t *)"mine", 4);
  assert_true(load(10, &first)); /* used: now the youngest */
  struct stat status;
  char path[2048];
  struct digest key = numbered_key(10);
  path_of(&key, path, sizeof path);
  assert_int_equal(stat(path, &status), 0);
  cache_trim(directory, 3 * (unsigned long long)status.st_size);
  assert_true(load(10, &first));
  assert_false(load(11, &first));
  assert_false(load(12, &first));
  assert_true(load(13, &first));
  assert_true(load(14, &first));
  cache_trim(directory, 0);
  assert_false(load(14, &first));
  assert_int_equal(access(foreign, F_OK), 0); /* not ours to remove */
  unlink(foreign);
}

static void nothing_temporary_stays(void **state) {
  (void)state;
  assert_true(store(6, 0.5f));
  cache_trim(directory, 0);
  assert_int_equal(rmdir(directory), 0); /* it is empty */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(hash_is_siphash),
      cmocka_unit_test(everything_is_in_the_key),
      cmocka_unit_test(what_is_stored_is_found),
      cmocka_unit_test(damage_is_seen),
      cmocka_unit_test(impossible_values_are_seen),
      cmocka_unit_test(odd_files_are_passed_by),
      cmocka_unit_test(directories_that_cannot_be),
      cmocka_unit_test(longest_unused_goes_first),
      cmocka_unit_test(nothing_temporary_stays),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
