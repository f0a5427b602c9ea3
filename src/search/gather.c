#include "search/gather.h"

#include <stdio.h>

typedef struct {
  const char *shader, *technique, *receiver; /* the technique's shader and defines, the receiver's defines */
  bool upsample, debug;
} gather_variant;

static pn_result gather_program(pni_gpu *gpu, const gather_variant *v, const pni_program **out) {
  char defines[512];
  snprintf(defines, sizeof defines, "%s%sPN_UPSAMPLE %d\nPN_DEBUG %d\n", v->technique, v->receiver, v->upsample,
           v->debug);
  pni_program_key key = {"shaders/screen.vert.glsl", "search/visibility.glsl", v->shader, defines};
  return pni_program_get(gpu, &key, out);
}

static pn_result draw(const pni_gathering *g, pni_attachment target, int width, int height, bool upsample, int scale) {
  char defines[PNI_RECEIVER_DEFINES];
  const pni_program *program;
  pni_receiver_defines(g->receiver, defines);
  bool debug = (g->gpu->debug & PN_DEBUG_SEARCH) && g->searches && !upsample;
  gather_variant variant = {g->shader, g->defines, defines, upsample, debug};
  pn_result result = gather_program(g->gpu, &variant, &program);
  if (result == PN_OK && debug) result = pni_texture_shape(g->gpu, &g->pair->search, GL_RGBA32F, width, height, 0, 1);
  if (result != PN_OK) return result;
  pni_pass pass = {.color = {target}, .width = width, .height = height};
  if (debug) pass.color[1] = (pni_attachment){g->pair->search.id, GL_TEXTURE_2D, 0, 0};
  result = pni_screen_begin(g->gpu, &pass, program);
  if (result != PN_OK) return result;
  pni_receiver_bind(g->receiver, program, g->frame, scale);
  pni_bind_texture(g->gpu, PNI_UNIT_MAPS, GL_TEXTURE_2D_ARRAY, g->maps->depth.id, false);
  if (g->maps->range.id) pni_bind_texture(g->gpu, PNI_UNIT_RANGE, GL_TEXTURE_2D_ARRAY, g->maps->range.id, false);
  if (upsample) pni_bind_texture(g->gpu, PNI_UNIT_WORK, GL_TEXTURE_2D, g->pair->low.id, false);
  pni_draw_screen(g->gpu);
  return PN_OK;
}

pn_result pni_gather(const pni_gathering *g) {
  const pn_receiver_desc *view = &g->receiver->desc;
  if (view->scale == 1) {
    pn_result result = draw(g, g->target, view->width, view->height, false, 1);
    pni_clock_mark(g->gpu, &g->pair->clock, "visibility");
    return result;
  }
  int width, height;
  pni_receiver_low_size(g->receiver, &width, &height);
  pn_result result = pni_texture_shape(g->gpu, &g->pair->low, GL_R32F, width, height, 0, 1);
  if (result != PN_OK) return result;
  pni_attachment low = {g->pair->low.id, GL_TEXTURE_2D, 0, 0};
  result = draw(g, low, width, height, false, view->scale);
  pni_clock_mark(g->gpu, &g->pair->clock, "visibility");
  if (result == PN_OK) result = draw(g, g->target, view->width, view->height, true, view->scale);
  pni_clock_mark(g->gpu, &g->pair->clock, "upsample");
  return result;
}

pn_result pni_gather_prepare(pni_gpu *gpu, const char *shader, const char *defines) {
  static const char *const receivers[] = {"PN_NORMALS 0\nPN_MASK 0\n", "PN_NORMALS 1\nPN_MASK 0\n"};
  pn_result result = PN_OK;
  for (int i = 0; i < 2 && result == PN_OK; i++) {
    const pni_program *program;
    gather_variant variant = {shader, defines, receivers[i], false, false};
    result = gather_program(gpu, &variant, &program);
  }
  return result;
}
