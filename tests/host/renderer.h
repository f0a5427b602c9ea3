/* The client's renderer: depth of the scene into a target of any kind, the surfaces themselves for the truth, and
 * forward shading with the library's text. */
#ifndef HOST_RENDERER_H
#define HOST_RENDERER_H

#include "camera.h"
#include "gl.h"
#include "scene.h"

typedef struct {
  GLuint vertex_array;
  GLuint vertices; /* texcoord, position: 5 floats a vertex, at rest; the wave is the vertex shader's */
  GLuint posed;    /* a guard float, then posed positions with a stride of 16 bytes */
  GLuint indices;
} gpu_mesh;

enum { POSED_OFFSET = 4, POSED_STRIDE = 16 };

typedef struct {
  gpu_mesh meshes[SCENE_MESHES];
  GLuint holes; /* RG8, the flag's opacity in green */
  GLuint depth_program, surface_program;
} renderer;

int renderer_open(renderer *out, const scene *world);
void renderer_close(renderer *self);

/* Uploads the posed vertices again, as an application that deforms on the CPU or in a compute shader would. */
void renderer_pose(renderer *self, const scene *world);

enum { DRAW_CASTERS = 1, DRAW_RECEIVERS = 2, DRAW_ALL = 3 };

/* Draws with a program that renderer_program made. */
void renderer_draw(const renderer *self, const scene *world, GLuint program, const float clip_from_scene[16],
                   int which);

/* A program of the client's vertex shader (deformation included) and a fragment shader that is put together from the
 * version line, the text given (may be NULL) and the body. 0 with the log on stderr. */
GLuint renderer_program(const char *text, const char *body);
GLuint compile_program(const char *const *vertex, int vertex_parts, const char *const *fragment, int fragment_parts);

/* The alpha test and, where peel is set, a call of pn_peel. */
const char *renderer_caster_body(int peel);

/* A depth target for the camera, not yet drawn. */
typedef struct {
  GLuint framebuffer, depth;
  int is_renderbuffer;
} depth_target;
int target_open(depth_target *out, const camera *view);
void target_close(depth_target *self);

/* The depth pre-pass. The state afterwards is GL's default except what the caller of the library would expect to find
 * bound. */
void renderer_depth(const renderer *self, const scene *world, const camera *view, const depth_target *target);

/* What each pixel sees, from rasterised positions, not from depth. Rows from the bottom. */
typedef struct {
  int width, height;
  float *position; /* x, y, z, mesh index or -1 */
  float *normal;   /* geometric, turned to the camera; unit */
} surfaces;
int surfaces_draw(surfaces *out, const renderer *self, const scene *world, const camera *view);
void surfaces_free(surfaces *self);

GLuint make_texture(GLenum format, int width, int height);
GLuint make_framebuffer(GLuint color, GLuint depth);

#endif
