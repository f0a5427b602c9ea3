#include "scene/gltf_document.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "scene/import_files.h"

/* ---- JSON -------------------------------------------------------------------------------------------------------- */

const cJSON *gltf_member(const cJSON *object, const char *name) {
  return cJSON_IsObject(object) ? cJSON_GetObjectItemCaseSensitive(object, name) : NULL;
}

const cJSON *gltf_extension(const cJSON *object, const char *name) {
  return gltf_member(gltf_member(object, "extensions"), name);
}

double gltf_number(const cJSON *object, const char *name, double otherwise) {
  const cJSON *value = gltf_member(object, name);
  return cJSON_IsNumber(value) && isfinite(value->valuedouble) ? value->valuedouble : otherwise;
}

static int to_index(double value) { return value >= 0 && value < INT32_MAX && value == floor(value) ? (int)value : -1; }

int gltf_index(const cJSON *object, const char *name) { return to_index(gltf_number(object, name, -1)); }

const char *gltf_string(const cJSON *object, const char *name) {
  const cJSON *value = gltf_member(object, name);
  return cJSON_IsString(value) ? value->valuestring : NULL;
}

int gltf_is_true(const cJSON *object, const char *name) { return cJSON_IsTrue(gltf_member(object, name)); }

int gltf_numbers(const cJSON *object, const char *name, size_t count, double *out) {
  const cJSON *array = gltf_member(object, name), *item = NULL;
  size_t i = 0;
  if (!cJSON_IsArray(array) || (size_t)cJSON_GetArraySize(array) != count) return 0;
  cJSON_ArrayForEach(item, array) if (!cJSON_IsNumber(item)) return 0;
  cJSON_ArrayForEach(item, array) out[i++] = item->valuedouble;
  return 1;
}

const cJSON *gltf_item(const struct gltf *g, enum gltf_list_name list, int index) {
  const struct gltf_list *l = &g->lists[list];
  if (index < 0 || (size_t)index >= l->count)
    refuse(g->importer, "is damaged: it refers to %s %d of %zu", l->name, index, l->count);
  return l->items[index];
}

static void list_items(struct gltf *g) {
  static const char *const names[GLTF_LISTS] = {
      [GLTF_ACCESSORS] = "accessors", [GLTF_VIEWS] = "bufferViews",   [GLTF_BUFFERS] = "buffers",
      [GLTF_IMAGES] = "images",       [GLTF_MATERIALS] = "materials", [GLTF_MESHES] = "meshes",
      [GLTF_NODES] = "nodes",         [GLTF_SAMPLERS] = "samplers",   [GLTF_SCENES] = "scenes",
      [GLTF_SKINS] = "skins",         [GLTF_TEXTURES] = "textures"};
  for (int i = 0; i < GLTF_LISTS; i++) {
    const cJSON *array = gltf_member(g->root, names[i]), *item = NULL;
    struct gltf_list *list = &g->lists[i];
    list->name = names[i];
    list->items = import_memory(cJSON_IsArray(array) ? (size_t)cJSON_GetArraySize(array) : 0, sizeof *list->items);
    if (cJSON_IsArray(array)) cJSON_ArrayForEach(item, array) list->items[list->count++] = item;
  }
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

static uint32_t word_at(const uint8_t *bytes) {
  return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

/* The chunks of a .glb; a version other than 2 is not for this reader. */
static int split_glb(struct gltf *g, struct gltf_bytes file, struct gltf_bytes *json) {
  enum { HEADER = 12, CHUNK = 8, CHUNK_JSON = 0x4e4f534a, CHUNK_BINARY = 0x004e4942 };
  if (file.size < HEADER || word_at(file.bytes + 4) != 2) return 0;
  for (size_t at = HEADER; file.size - at >= CHUNK;) {
    size_t size = word_at(file.bytes + at);
    uint32_t kind = word_at(file.bytes + at + 4);
    at += CHUNK;
    if (size > file.size - at)
      refuse(g->importer, "is damaged: a chunk of the .glb file needs %zu bytes, and %zu are left", size,
             file.size - at);
    if (kind == CHUNK_JSON && !json->bytes) *json = (struct gltf_bytes){file.bytes + at, size};
    if (kind == CHUNK_BINARY && !g->own.bytes) g->own = (struct gltf_bytes){file.bytes + at, size};
    at += size;
  }
  if (!json->bytes) refuse(g->importer, "is damaged: a .glb file without JSON");
  return 1;
}

static int is_named_gltf(const char *path) {
  const char *dot = strrchr(path, '.');
  return dot && (strcasecmp(dot, ".gltf") == 0 || strcasecmp(dot, ".glb") == 0 || strcasecmp(dot, ".vrm") == 0);
}

static struct gltf_bytes without_mark(struct gltf_bytes text) {
  int mark = text.size >= 3 && memcmp(text.bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
  return (struct gltf_bytes){text.bytes + mark, text.size - (size_t)mark};
}

int gltf_open(struct gltf *g, struct importer *importer) {
  struct gltf_bytes file = {0}, json = {0};
  char magic[5];
  *g = (struct gltf){.importer = importer};
  read_head(importer, importer->path, magic, 4);
  int binary = strcmp(magic, "glTF") == 0;
  if (!binary && !is_named_gltf(importer->path)) return 0;
  file.bytes = read_file(importer, importer->path, &file.size);
  if (!file.bytes) return 0;
  if (!binary) json = file;
  else if (!split_glb(g, file, &json)) return 0;
  json = without_mark(json);
  const char *end = NULL;
  g->root = cJSON_ParseWithLengthOpts((const char *)json.bytes, json.size, &end, 0);
  if (!g->root && (binary || (json.size && json.bytes[0] == '{')))
    refuse(importer, "is damaged: its JSON ends or is wrong at byte %zu", end ? (size_t)(end - (char *)json.bytes) : 0);
  /* Assimp would go on to look for words of other formats, and find them in noise. */
  if (!cJSON_IsObject(g->root))
    refuse(importer, "cannot be imported: it is damaged, or not a %s file",
           binary ? ".glb" : strrchr(importer->path, '.'));
  const char *version = gltf_string(gltf_member(g->root, "asset"), "version");
  if (!version || strncmp(version, "1.", 2) == 0) return 0;
  if (strncmp(version, "2.", 2) != 0) refuse(importer, "is glTF %.20s, of which only 1 and 2 are read", version);
  list_items(g);
  g->buffers = import_memory(g->lists[GLTF_BUFFERS].count, sizeof *g->buffers);
  g->images = import_memory(g->lists[GLTF_IMAGES].count, sizeof *g->images);
  return 1;
}

static int digit_of(char c) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const char *at = c ? strchr(digits, c) : NULL;
  return at ? (int)(at - digits) : c == '-' ? 62 : c == '_' ? 63 : -1;
}

static struct gltf_bytes decode_base64(const char *text) {
  struct gltf_bytes out = {import_memory(strlen(text) / 4 * 3 + 3, 1), 0};
  uint32_t bits = 0;
  for (int have = 0; *text; text++) {
    int digit = digit_of(*text);
    if (digit < 0) continue;
    bits = bits << 6 | (uint32_t)digit;
    have += 6;
    if (have < 8) continue;
    have -= 8;
    out.bytes[out.size++] = (uint8_t)(bits >> have);
  }
  return out;
}

static const char *find_base64(const char *uri, const char *comma) {
  static const char word[] = ";base64";
  size_t length = sizeof word - 1;
  return (size_t)(comma - uri) >= length && strncasecmp(comma - length, word, length) == 0 ? comma + 1 : NULL;
}

int gltf_uri(const struct gltf *g, const char *uri, struct gltf_bytes *out) {
  if (strncasecmp(uri, "data:", 5) == 0) {
    const char *comma = strchr(uri, ','), *data = comma ? find_base64(uri, comma) : NULL;
    char *copy = strdup(data ? data : comma ? comma + 1 : "");
    if (!copy) exit(1);
    if (data) decode_uri(copy); /* some write "%2B" for a plus */
    if (data) *out = decode_base64(copy);
    if (data) free(copy);
    if (!data) refuse(g->importer, "is damaged: a data: URI that is not base64");
    return 1;
  }
  out->bytes = read_beside(g->importer, uri, &out->size);
  return out->bytes != NULL;
}

static struct gltf_bytes buffer(struct gltf *g, int index) {
  const cJSON *object = gltf_item(g, GLTF_BUFFERS, index);
  struct gltf_bytes *buffer = &g->buffers[index];
  const char *uri = gltf_string(object, "uri");
  if (buffer->bytes) return *buffer;
  if (uri && !gltf_uri(g, uri, buffer))
    refuse(g->importer, "buffer %.150s: the file is missing or cannot be read", uri);
  if (!uri && index == 0) *buffer = g->own;
  if (!buffer->bytes) refuse(g->importer, "is damaged: buffer %d has no bytes", index);
  double size = gltf_number(object, "byteLength", 0);
  if (!(size <= (double)buffer->size))
    refuse(g->importer, "buffer %d has %zu bytes, not the %.0f that it should", index, buffer->size, size);
  return *buffer;
}

struct gltf_bytes gltf_view(struct gltf *g, int index, size_t *stride) {
  const cJSON *view = gltf_item(g, GLTF_VIEWS, index);
  static const char *const packed[] = {"EXT_meshopt_compression", "KHR_meshopt_compression", "MESHOPT_compression"};
  for (size_t i = 0; i < sizeof packed / sizeof *packed; i++)
    if (gltf_extension(view, packed[i])) {
      const cJSON *held = gltf_item(g, GLTF_BUFFERS, gltf_index(view, "buffer"));
      if (!gltf_string(held, "uri")) refuse(g->importer, "needs %s, which is not supported", packed[i]);
    }
  struct gltf_bytes all = buffer(g, gltf_index(view, "buffer"));
  double offset = gltf_number(view, "byteOffset", 0), size = gltf_number(view, "byteLength", 0);
  if (!(offset >= 0 && size >= 0 && offset + size <= (double)all.size))
    refuse(g->importer, "is damaged: buffer view %d ends behind its buffer", index);
  if (stride) *stride = (size_t)fmin(fmax(gltf_number(view, "byteStride", 0), 0), 1e6);
  return (struct gltf_bytes){all.bytes + (size_t)offset, (size_t)size};
}

/* ---- accessors --------------------------------------------------------------------------------------------------- */

enum { BYTE = 5120, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT, UNSIGNED_INT = 5125, FLOAT };

static size_t component_size(int type) {
  return type == BYTE || type == UNSIGNED_BYTE     ? 1
         : type == SHORT || type == UNSIGNED_SHORT ? 2
         : type == UNSIGNED_INT || type == FLOAT   ? 4
                                                   : 0;
}

static size_t component_count(const char *type) {
  static const struct {
    const char *name;
    size_t count;
  } types[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}};
  for (size_t i = 0; type && i < sizeof types / sizeof *types; i++)
    if (strcmp(type, types[i].name) == 0) return types[i].count;
  return 0;
}

struct values {
  const uint8_t *bytes;
  size_t stride, components;
  int type, normalized;
};

static double value_at(const struct values *v, size_t i, size_t component) {
  const uint8_t *p = v->bytes + i * v->stride + component * component_size(v->type);
  float real;
  switch (v->type) {
  case BYTE: return v->normalized ? fmax((int8_t)*p / 127.0, -1) : (int8_t)*p;
  case UNSIGNED_BYTE: return v->normalized ? *p / 255.0 : *p;
  case SHORT: {
    int16_t s = (int16_t)(p[0] | p[1] << 8);
    return v->normalized ? fmax(s / 32767.0, -1) : s;
  }
  case UNSIGNED_SHORT: return (p[0] | p[1] << 8) / (v->normalized ? 65535.0 : 1.0);
  case UNSIGNED_INT: return word_at(p);
  default: memcpy(&real, p, sizeof real); return real;
  }
}

static size_t checked_count(const struct gltf *g, const cJSON *object) {
  double count = gltf_number(object, "count", 0);
  if (!(count >= 0 && count < UINT32_MAX && count == floor(count)))
    refuse(g->importer, "is damaged: an accessor of %g values", count);
  return (size_t)count;
}

/* The bytes of count values from a view on, all of which are there. */
static struct values find_values(struct gltf *g, const cJSON *where, int type, size_t components, size_t count) {
  struct values v = {.components = components, .type = type};
  size_t stride = 0, size = component_size(type) * components;
  struct gltf_bytes view = gltf_view(g, gltf_index(where, "bufferView"), &stride);
  double offset = gltf_number(where, "byteOffset", 0);
  v.stride = stride ? stride : size;
  if (!(offset >= 0 &&
        (count == 0 || offset + (double)(count - 1) * (double)v.stride + (double)size <= (double)view.size)))
    refuse(g->importer, "is damaged: an accessor's values end behind their buffer view");
  v.bytes = view.bytes + (size_t)offset;
  return v;
}

struct accessor {
  const cJSON *object;
  size_t count, components;
  int type, normalized;
};

static struct accessor find_accessor(const struct gltf *g, int index) {
  const cJSON *object = gltf_item(g, GLTF_ACCESSORS, index);
  struct accessor a = {.object = object,
                       .count = checked_count(g, object),
                       .components = component_count(gltf_string(object, "type")),
                       .type = gltf_index(object, "componentType"),
                       .normalized = gltf_is_true(object, "normalized")};
  if (!a.components || !component_size(a.type)) refuse(g->importer, "is damaged: accessor %d has no known type", index);
  return a;
}

/* Calls put(out, place, value) for each component that is there, sparse ones last. */
static void read_values(struct gltf *g, const struct accessor *a, size_t components, void *out,
                        void (*put)(void *out, size_t place, double value)) {
  size_t used = components < a->components ? components : a->components;
  if (gltf_member(a->object, "bufferView")) {
    struct values v = find_values(g, a->object, a->type, a->components, a->count);
    v.normalized = a->normalized;
    for (size_t i = 0; i < a->count; i++)
      for (size_t k = 0; k < used; k++) put(out, i * components + k, value_at(&v, i, k));
  }
  const cJSON *sparse = gltf_member(a->object, "sparse");
  if (!sparse) return;
  const cJSON *places = gltf_member(sparse, "indices");
  size_t count = checked_count(g, sparse);
  int type = gltf_index(places, "componentType");
  if (!component_size(type) || type == FLOAT) refuse(g->importer, "is damaged: a sparse accessor without places");
  struct values at = find_values(g, places, type, 1, count);
  struct values v = find_values(g, gltf_member(sparse, "values"), a->type, a->components, count);
  v.normalized = a->normalized;
  for (size_t i = 0; i < count; i++) {
    size_t place = (size_t)value_at(&at, i, 0);
    if (place >= a->count) refuse(g->importer, "is damaged: a sparse accessor puts a value behind its end");
    for (size_t k = 0; k < used; k++) put(out, place * components + k, value_at(&v, i, k));
  }
}

static void put_float(void *out, size_t place, double value) { ((float *)out)[place] = (float)value; }

static void put_integer(void *out, size_t place, double value) {
  ((uint32_t *)out)[place] = value >= 0 && value <= UINT32_MAX ? (uint32_t)value : UINT32_MAX;
}

float *gltf_floats(struct gltf *g, int index, size_t components, size_t *count) {
  struct accessor a = find_accessor(g, index);
  float *out = import_memory(a.count, components * sizeof *out);
  read_values(g, &a, components, out, put_float);
  *count = a.count;
  return out;
}

uint32_t *gltf_integers(struct gltf *g, int index, size_t components, size_t *count) {
  struct accessor a = find_accessor(g, index);
  uint32_t *out = import_memory(a.count, components * sizeof *out);
  read_values(g, &a, components, out, put_integer);
  *count = a.count;
  return out;
}
