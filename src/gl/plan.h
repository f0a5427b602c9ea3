/* A call in two steps, so that it succeeds or leaves everything as it was: first it is planned, then it draws. Both go
 * through the same code. While a call is planned textures are shaped, programs compiled, memory taken, and that new
 * textures can be drawn into is looked at; passes begin and draw nothing, and nothing is read back. What fails does so
 * there, before the first draw. Code between passes keeps to this: what it tells or remembers of a draw it does where
 * gpu->plan.on is false. */
#ifndef PNI_GL_PLAN_H
#define PNI_GL_PLAN_H

#include "gl/gpu.h"

/* keep: there is a result to keep; textures that are replaced are held until the plan ends. Else they go at once. */
void pni_plan_begin(pni_gpu *gpu, bool keep);
/* Returns result. After a failure all textures that were shaped are what they were, and those of a plan without keep
 * some of one, some of the other. */
pn_result pni_plan_end(pni_gpu *gpu, pn_result result);
/* What is made until pni_plan_resume stays also if the plan fails: it may be freed before the plan ends. */
bool pni_plan_pause(pni_gpu *gpu);
void pni_plan_resume(pni_gpu *gpu, bool keep);

#endif
