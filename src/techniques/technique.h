/* What a technique is. To add one: a folder with its table and shader, which defines pni_technique_NAME, and a line in
 * list.h. */
#ifndef PN_TECHNIQUES_TECHNIQUE_H
#define PN_TECHNIQUES_TECHNIQUE_H

#include "maps/maps.h"
#include "pair.h"
#include "receiver/receiver.h"

/* Everything one call of pn_visibility has: the same for every technique. */
typedef struct {
  pni_gpu *gpu;
  const pn_light_desc *desc;
  const pni_frame *frame;
  const double *values; /* parameters, in the order of the table */
  pni_maps *maps;       /* drawn by pn_maps_update as the technique wanted them */
  pni_buffer *block;    /* the light's, bound */
  pn_casters *casters;  /* of the last pn_maps_update; NULL when they are gone */
  uint32_t groups;
  const pni_region *visible; /* what that update was fitted to, or NULL */
  pn_receiver *receiver;
  pni_pair *pair;
  pni_attachment target; /* where visibility goes */
} pni_visibility_request;

/* What a technique has that adds an image of its own to the light's maps. */
typedef struct {
  pni_gpu *gpu;
  const pni_frame *frame;
  const double *values;
  pni_maps *maps; /* drawn; the block that describes them is bound */
  pn_casters *casters;
  uint32_t groups;
} pni_build_request;

enum { PNI_TECHNIQUE_DEFINES = 256 };

typedef struct {
  pn_technique table;
  /* The maps it needs with these values. */
  void (*want)(const double *values, pni_maps_want *out);
  /* Parameter 0 is preset: sets the others to what that choice stands for. NULL: the technique has no presets. */
  void (*preset)(int choice, double *values);
  /* A gathering technique is a shader with pn_technique(); it needs nothing else. */
  const char *shader;
  /* #defines that the shader depends on, as lines; what may change without compiling is read from the block. NULL:
   * none. */
  void (*defines)(const double *values, char out[PNI_TECHNIQUE_DEFINES]);
  /* Fills maps->range, in each pn_maps_update, for a technique that wants PNI_RANGE_OWN; stage: the name of its time. */
  pn_result (*build)(const pni_build_request *request);
  const char *stage;
  bool searches; /* the shader includes search/search.glsl and tells what it did */
  /* Others draw by themselves, and compile by themselves. */
  pn_result (*draw)(const pni_visibility_request *request);
  pn_result (*prepare)(pni_gpu *gpu, const double *values);
} pni_technique_class;

/* The class behind a table that the library handed out. */
const pni_technique_class *pni_technique_class_of(const pn_technique *table);

/* The shader's defines for these values: "" where it has none. */
void pni_technique_defines(const pni_technique_class *technique, const double *values, char out[PNI_TECHNIQUE_DEFINES]);

/* Sets one of values by the parameter's name; false, with the message that fits, when there is none or the value is
 * not one of its own. */
bool pni_parameter_set(const pn_technique *table, const char *name, double value, double *values, pn_message *message);

#endif
