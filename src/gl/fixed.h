/* What compatibility contexts have beside core state and what outlives a shader: pixel transfer, the clamping of
 * fragments' colours, each texture unit's own level-of-detail bias. (Their switches are among pni_capabilities'.) */
#ifndef PNI_GL_FIXED_H
#define PNI_GL_FIXED_H

#include "gl/gpu.h"

void pni_fixed_save(pni_gpu *gpu, pni_fixed_state *state);
/* At GL's defaults; host NULL: whatever it was. */
void pni_fixed_neutral(pni_gpu *gpu, const pni_host_state *host);
/* From there. */
void pni_fixed_restore(pni_gpu *gpu, const pni_host_state *host, bool whole);

#endif
