/* gltf_document.h: a glTF file as JSON and bytes. What an index leads to that does not exist is refused. */
#ifndef PENUMBRA_APP_SCENE_GLTF_DOCUMENT_H
#define PENUMBRA_APP_SCENE_GLTF_DOCUMENT_H

#include <cjson/cJSON.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/import_send.h"

/* The document's lists by index: cJSON walks them from the first. */
struct gltf_list {
  const char *name;
  const cJSON **items;
  size_t count;
};

struct gltf_bytes {
  uint8_t *bytes; /* NULL: not read yet */
  size_t size;
};

enum gltf_list_name {
  GLTF_ACCESSORS,
  GLTF_VIEWS,
  GLTF_BUFFERS,
  GLTF_IMAGES,
  GLTF_MATERIALS,
  GLTF_MESHES,
  GLTF_NODES,
  GLTF_SAMPLERS,
  GLTF_SCENES,
  GLTF_SKINS,
  GLTF_TEXTURES,
  GLTF_LISTS
};

struct gltf {
  struct importer *importer;
  const cJSON *root;
  struct gltf_list lists[GLTF_LISTS];
  struct gltf_bytes *buffers; /* one for each of the document's */
  struct gltf_bytes *images;  /* the same, of pictures in data: URIs: each is one picture for all who use it */
  int vertex_opacity;         /* said already that it is left out */
  struct gltf_bytes own;      /* what a .glb holds behind its JSON */
};

/* Reads the document. 0: it is no glTF 2.0. */
int gltf_open(struct gltf *g, struct importer *importer);

/* Refused where there is no such item. */
const cJSON *gltf_item(const struct gltf *g, enum gltf_list_name list, int index);

/* Members; the default where there is none. */
const cJSON *gltf_member(const cJSON *object, const char *name);
const cJSON *gltf_extension(const cJSON *object, const char *name);
double gltf_number(const cJSON *object, const char *name, double otherwise);
int gltf_index(const cJSON *object, const char *name); /* -1: none */
const char *gltf_string(const cJSON *object, const char *name);
int gltf_is_true(const cJSON *object, const char *name);
/* Where the member is an array of that many numbers; else what was in out stays. */
int gltf_numbers(const cJSON *object, const char *name, size_t count, double *out);

/* The bytes of a view, or of what a URI says: a file beside the model, or data. */
struct gltf_bytes gltf_view(struct gltf *g, int view, size_t *stride);
int gltf_uri(const struct gltf *g, const char *uri, struct gltf_bytes *out);

/* An accessor's values as floats, components a vertex: normalized where it says so, sparse ones put in. Missing
 * components are 0. */
float *gltf_floats(struct gltf *g, int accessor, size_t components, size_t *count);

/* Its values as integers. */
uint32_t *gltf_integers(struct gltf *g, int accessor, size_t components, size_t *count);

#endif
