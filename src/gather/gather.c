#include "gather/gather.h"

#include <ctype.h>
#include <stdio.h>

enum { NAME_MOST = 32 };

/* ---- defines ----------------------------------------------------------------------------------------------------- */

_Static_assert(PNI_PARAMETERS_MAX *(sizeof "PN_PARAMETER_ 31\n" + NAME_MOST) < PNI_TECHNIQUE_DEFINES - 256,
               "names fit");

static int name_parameter(const char *name, int index, char *out, size_t size) {
  char upper[NAME_MOST];
  int i = 0;
  for (; name[i] && i < (int)sizeof upper - 1; i++) upper[i] = (char)toupper((unsigned char)name[i]);
  upper[i] = 0;
  return snprintf(out, size, "PN_PARAMETER_%s %d\n", upper, index);
}

void pni_gather_defines(const pni_gathering *gathering, const pn_technique *table, const double *values,
                        char out[PNI_TECHNIQUE_DEFINES]) {
  int used = 0; /* 32 names of at most 32 letters fit */
  for (int i = 0; i < table->parameter_count; i++)
    used += name_parameter(table->parameters[i].name, i, out + used, (size_t)(PNI_TECHNIQUE_DEFINES - used));
  out[used] = 0;
  if (gathering->defines) gathering->defines(values, out + used, (size_t)(PNI_TECHNIQUE_DEFINES - used));
}

const pni_texture *pni_gather_beside(const pni_gathering *gathering, const pni_maps *maps, const void *light_state) {
  return gathering->beside ? gathering->beside(light_state) : &maps->range;
}

/* ---- passes ------------------------------------------------------------------------------------------------------ */

typedef struct {
  pni_target target;
  int width, height, scale;
  bool upsample; /* brings the image at reduced resolution up */
  bool debug;
} gather_pass;

static pn_result draw(const pni_job *job, const gather_pass *p) {
  pni_gpu *gpu = job->gpu;
  char technique[PNI_TECHNIQUE_DEFINES], receiver[PNI_RECEIVER_DEFINES];
  char defines[PNI_TECHNIQUE_DEFINES + PNI_RECEIVER_DEFINES + 64];
  pni_gather_defines(job->gathering, job->table, job->values, technique);
  pni_receiver_defines(job->receiver, receiver);
  snprintf(defines, sizeof defines, "%s%sPN_UPSAMPLE %d\nPN_DEBUG %d\n", technique, receiver, p->upsample, p->debug);
  pni_pass pass = {.name = job->table->name,
                   .program = {NULL, "gather/visibility.glsl", job->gathering->shader, defines},
                   .color = {p->target.image},
                   .channels = p->target.channels,
                   .width = p->width,
                   .height = p->height};
  if (p->debug) {
    pass.color[1] = pni_image_of(job->search, 0, 0);
    pass.color[2] = pni_image_of(job->levels, 0, 0);
  }
  pn_result result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK) return result;
  pni_receiver_uniforms(job->receiver, job->frame, job->emission, &job->maps->rounding, p->scale);
  pni_set_texture(gpu, "pn_maps", &job->maps->depth);
  pni_set_texture(gpu, "pn_range", pni_gather_beside(job->gathering, job->maps, job->light_state));
  if (p->upsample) pni_set_texture(gpu, "pn_low", job->low);
  pni_draw_screen(gpu);
  return PN_OK;
}

static pn_result draw_visibility(const pni_job *job, pni_target target, int width, int height, int scale) {
  gather_pass p = {target, width, height, scale, false, false};
  pn_result result = PN_OK;
  p.debug = (job->gpu->debug & PN_DEBUG_SEARCH) && job->gathering->searches;
  if (p.debug) result = pni_texture_shape(job->gpu, job->search, "search", PNI_RGBA32F, width, height, 0, 1);
  if (p.debug && result == PN_OK)
    result = pni_texture_shape(job->gpu, job->levels, "levels", PNI_RG32F, width, height, 0, 1);
  if (result == PN_OK) result = draw(job, &p);
  pni_job_mark(job, "visibility");
  return result;
}

pn_result pni_gather(const pni_job *job) {
  const pn_receiver_desc *view = &job->receiver->desc;
  if (view->scale == 1) return draw_visibility(job, job->target, view->width, view->height, 1);
  int width, height;
  pni_receiver_low_size(job->receiver, &width, &height);
  pn_result result = pni_texture_shape(job->gpu, job->low, "visibility, low", PNI_R32F, width, height, 0, 1);
  if (result != PN_OK) return result;
  pni_target low = {pni_image_of(job->low, 0, 0), 0};
  result = draw_visibility(job, low, width, height, view->scale);
  if (result != PN_OK) return result;
  gather_pass up = {job->target, view->width, view->height, view->scale, true, false};
  result = draw(job, &up);
  pni_job_mark(job, "upsample");
  return result;
}
