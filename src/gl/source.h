/* GLSL from the embedded sources, or from the files of a directory, with #include and #define. */
#ifndef PNI_GL_SOURCE_H
#define PNI_GL_SOURCE_H

#include "gl/gpu.h"

/* The whole text of one stage, without #version: a comment that names files and defines, the defines, then the files
 * with their includes in place, each once. paths ends with NULL; defines: lines "NAME VALUE\n", may be "". Owned by
 * the caller (pni_free). */
pn_result pni_shader_text(pni_gpu *gpu, const char *const *paths, const char *defines, char **out);

#endif
