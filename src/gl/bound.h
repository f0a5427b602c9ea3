/* GL's state as the library's passes set it, remembered so that no call sets what is set already. What the host may
 * have changed is forgotten: at every entry, and after each of its callbacks. */
#ifndef PNI_GL_BOUND_H
#define PNI_GL_BOUND_H

#include "gl/gpu.h"

/* The indexed binding of the uniform block that the library's own passes use. */
enum { PNI_BLOCK_BINDING = 0 };

/* The host was here. */
void pni_forget(pni_gpu *gpu);
/* Before anything that depends on state: switches off everything that could change what a pass of the library draws,
 * where that is not known to be off. */
void pni_ready(pni_gpu *gpu);
/* The same, whatever is known of what passes set; what the host is known to have left so is not set again. */
void pni_neutral(pni_gpu *gpu);

void pni_bind_program(pni_gpu *gpu, pn_gl program);
void pni_bind_vertex_array(pni_gpu *gpu, pn_gl array);
void pni_bind_framebuffer(pni_gpu *gpu);
void pni_bind_read_framebuffer(pni_gpu *gpu);
void pni_bind_texture(pni_gpu *gpu, int unit, GLenum target, pn_gl texture, pn_gl sampler);
/* To the unit that no sampler reads, active afterwards. */
void pni_bind_scratch(pni_gpu *gpu, GLenum target, pn_gl texture);
/* A texture, a buffer is about to be deleted: GL unbinds it. */
void pni_texture_gone(pni_gpu *gpu, pn_gl texture);
void pni_buffer_gone(pni_gpu *gpu, pn_gl buffer);

/* Viewport, depth range and scissor test of index 0 only: the host may use the others, and no shader of ours does. */
void pni_set_viewport(pni_gpu *gpu, int x, int y, int width, int height);
void pni_set_depth_range(pni_gpu *gpu, double near, double far);
void pni_set_scissor(pni_gpu *gpu, int x, int y, int width, int height);
void pni_set_scissor_test(pni_gpu *gpu, bool on);
void pni_set_depth_test(pni_gpu *gpu, bool on, bool write, GLenum function);
void pni_set_depth_clamp(pni_gpu *gpu, bool on);
void pni_set_faces(pni_gpu *gpu, pn_faces faces);
void pni_set_clockwise(pni_gpu *gpu, bool clockwise);
void pni_set_blend(pni_gpu *gpu, pni_blend blend);
/* image 0 or 1; channels: bit 0 red .. bit 3 alpha. */
void pni_set_channels(pni_gpu *gpu, int image, int channels);
void pni_set_point_size(pni_gpu *gpu, bool on);

/* ---- without remembering: for what saves and restores the host's state ---- */

void pni_switch(pni_gpu *gpu, GLenum name, bool on);
void pni_viewport(pni_gpu *gpu, const int box[4]);
void pni_depth_range(pni_gpu *gpu, double near, double far);
void pni_scissor(pni_gpu *gpu, const int box[4]);
void pni_blend_functions(pni_gpu *gpu, const GLint equation[2], const GLint function[4]);
enum { PNI_PIXEL_NAMES = 5 };
extern const GLenum pni_pack_names[PNI_PIXEL_NAMES], pni_unpack_names[PNI_PIXEL_NAMES];
extern const GLint pni_pixel_defaults[PNI_PIXEL_NAMES];
bool pni_fills_polygons(const pni_gpu *gpu, const pni_host_state *host);

#endif
