#include "gl/plan.h"

#include "gl/texture.h"

void pni_plan_begin(pni_gpu *gpu, bool keep) {
  gpu->plan.on = true;
  gpu->plan.keep = keep;
  gpu->plan.made = false;
  gpu->plan.number++;
}

pn_result pni_plan_end(pni_gpu *gpu, pn_result result) {
  pni_textures_settle(gpu, result == PN_OK);
  gpu->plan.on = gpu->plan.keep = false;
  return result;
}

bool pni_plan_pause(pni_gpu *gpu) {
  bool keep = gpu->plan.keep;
  gpu->plan.keep = false;
  return keep;
}

void pni_plan_resume(pni_gpu *gpu, bool keep) { gpu->plan.keep = keep; }
