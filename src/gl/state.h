/* The host's GL state: saved, restored, or put at GL's defaults. */
#ifndef PNI_GL_STATE_H
#define PNI_GL_STATE_H

#include "gl/gpu.h"

/* Reads it; until the host's code runs again, passes count on what was read. */
void pni_state_save(pni_gpu *gpu, pni_host_state *state);
/* Sets what is no longer so; whole: all of it, whatever is known. */
void pni_state_restore(pni_gpu *gpu, const pni_host_state *state, bool whole);
/* GL's defaults for everything the library touches, except the viewport, which has none. */
void pni_state_reset(pni_gpu *gpu);

#endif
