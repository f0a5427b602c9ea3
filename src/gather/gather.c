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
  bool area;     /* red is visibility, green what the accumulated area leaves */
  bool debug;
} gather_pass;

static pn_result draw(const pni_job *job, const gather_pass *p) {
  pni_gpu *gpu = job->gpu;
  char technique[PNI_TECHNIQUE_DEFINES], receiver[PNI_RECEIVER_DEFINES];
  char defines[PNI_TECHNIQUE_DEFINES + PNI_RECEIVER_DEFINES + 64];
  pni_gather_defines(job->gathering, job->table, job->values, technique);
  pni_receiver_defines(job->receiver, receiver);
  snprintf(defines, sizeof defines, "%s%sPN_UPSAMPLE %d\nPN_AREA %d\nPN_DEBUG %d\n", technique, receiver, p->upsample,
           p->area, p->debug);
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

static pn_result draw_visibility(const pni_job *job, gather_pass p) {
  pn_result result = PN_OK;
  p.debug = (job->gpu->debug & PN_DEBUG_SEARCH) && job->gathering->searches;
  if (p.debug) result = pni_texture_shape(job->gpu, job->search, "search", PNI_RGBA32F, p.width, p.height, 0, 1);
  if (p.debug && result == PN_OK)
    result = pni_texture_shape(job->gpu, job->levels, "levels", PNI_RG32F, p.width, p.height, 0, 1);
  if (result == PN_OK) result = draw(job, &p);
  pni_job_mark(job, "visibility");
  return result;
}

/* Where what is gathered goes, at the resolution that it is gathered at. */
static pn_result gathered(const pni_job *job, gather_pass *out) {
  const pn_receiver_desc *view = &job->receiver->desc;
  *out = (gather_pass){.target = job->target, .width = view->width, .height = view->height, .scale = view->scale};
  if (view->scale == 1) return PN_OK;
  pni_receiver_low_size(job->receiver, &out->width, &out->height);
  pn_result result = pni_texture_shape(job->gpu, job->low, "visibility, low", PNI_R32F, out->width, out->height, 0, 1);
  out->target = (pni_target){pni_image_of(job->low, 0, 0), 0};
  return result;
}

static pn_result upsample(const pni_job *job) {
  const pn_receiver_desc *view = &job->receiver->desc;
  if (view->scale == 1) return PN_OK;
  gather_pass up = {
      .target = job->target, .width = view->width, .height = view->height, .scale = view->scale, .upsample = true};
  pn_result result = draw(job, &up);
  pni_job_mark(job, "upsample");
  return result;
}

pn_result pni_gather(const pni_job *job) {
  gather_pass p;
  pn_result result = gathered(job, &p);
  if (result == PN_OK) result = draw_visibility(job, p);
  return result == PN_OK ? upsample(job) : result;
}

/* ---- smoothed ---------------------------------------------------------------------------------------------------- */

static pn_result smooth_once(const pni_job *job, const pni_smoothing *smoothing, const pni_texture *from,
                             pni_target to) {
  pni_pass pass = {.name = "smooth",
                   .program = {NULL, "gather/smooth.frag.glsl", NULL, ""},
                   .color = {to.image},
                   .channels = to.channels,
                   .width = from->width,
                   .height = from->height};
  pn_result result = pni_pass_begin(job->gpu, &pass);
  if (result != PN_OK) return result;
  pni_set_texture(job->gpu, "pn_from", from);
  pni_set_floats(job->gpu, "pn_bounds",
                 (const float[4]){smoothing->way, smoothing->most, smoothing->steepest, smoothing->within_surfaces});
  pni_draw_screen(job->gpu);
  return PN_OK;
}

pn_result pni_gather_smoothed(const pni_job *job, const pni_smoothing *smoothing, pni_texture both[2]) {
  gather_pass p;
  pn_result result = gathered(job, &p);
  pni_target last = p.target;
  for (int i = 0; i < 2 && result == PN_OK; i++)
    result = pni_texture_shape(job->gpu, &both[i], "visibility and area", PNI_RGBA32F, p.width, p.height, 0, 1);
  p.target = (pni_target){pni_image_of(&both[0], 0, 0), 0};
  p.area = true;
  if (result == PN_OK) result = draw_visibility(job, p);
  for (int i = 0; i < smoothing->passes && result == PN_OK; i++) {
    pni_target next = {pni_image_of(&both[(i + 1) % 2], 0, 0), 0};
    result = smooth_once(job, smoothing, &both[i % 2], i == smoothing->passes - 1 ? last : next);
  }
  pni_job_mark(job, "smooth");
  return result == PN_OK ? upsample(job) : result;
}
