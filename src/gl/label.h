/* Names that debuggers and recorders of GL (RenderDoc, apitrace) show; nothing where the device has no KHR_debug. */
#ifndef PNI_GL_LABEL_H
#define PNI_GL_LABEL_H

#include "gl/gpu.h"

/* Shown as "penumbra NAME". The object must have been bound once. */
void pni_label(pni_gpu *gpu, GLenum kind, pn_gl object, const char *name);
/* Opens the debug group of a pass, closing the last one; name NULL: closes only. */
void pni_group(pni_gpu *gpu, const char *name);
/* Looks whether there is room for one more group: a host whose own groups fill the stack keeps them. For when the
 * host's state is read anyway. */
void pni_find_group_room(pni_gpu *gpu);

#endif
