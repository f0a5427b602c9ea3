/* penumbra.h: real-time soft shadows from area lights, for any OpenGL renderer.
 *
 * Hand over what your renderer already has (its camera's depth buffer, the meshes that block light, a light with a
 * size) and get back a texture that says, for every pixel, which fraction of the light that pixel sees.
 *
 *     objects    pn_context   one per GL context
 *                pn_casters   what blocks light: meshes and their instances, or a draw callback
 *                pn_receiver  one camera view: what is shaded
 *                pn_light     what emits; owns its depth maps, and one result for each receiver
 *     a frame    pn_receiver_set, then for each light pn_maps_update and pn_visibility
 *
 * Conventions, unless a declaration says otherwise:
 *   - Scene space is right-handed. Matrices are column-major and map column vectors: float m[16], m[12..14] the
 *     translation. Distances are in scene units, angles in radians.
 *   - Every function that takes an object must be called with the context's GL context current, on that thread.
 *     Different contexts may be used on different threads at the same time. Functions without an object may be called
 *     anywhere. Objects that are handed to one call belong to one context.
 *   - Description structs may be zeroed: zero means the default wherever zero itself makes no sense. They are copied.
 *   - Objects live until their pn_..._destroy or their context's. GL objects of the host's are referenced, never freed:
 *     keep them alive as long as a description holds them.
 *   - Functions return PN_OK or a negative pn_result; the reason, with a stable message id, goes to the context's log.
 *     A call that fails leaves everything as it was, maps and results included: what can fail is made before the first
 *     draw. Nothing aborts, nothing is printed, no GL error is raised.
 *   - The same input on the same device gives the same bits.
 *
 * Errors are listed as results, with the messages that tell them apart: "Errors: ARGUMENT (MESH_BOUNDS),
 * OUT_OF_MEMORY." stands for PN_ERROR_ARGUMENT with PN_MESSAGE_MESH_BOUNDS, and PN_ERROR_OUT_OF_MEMORY. What is the
 * same everywhere:
 *   - The object that a function is called with is NULL: ARGUMENT, without a message, since nobody could be told. It is
 *     not listed. NULL_ARGUMENT stands for every other pointer that must not be NULL.
 *   - OUT_OF_MEMORY comes with OUT_OF_MEMORY (the host's memory) or GPU_MEMORY; SHADER with SHADER_COMPILE, SHADER_LINK
 *     or SHADER_MISSING; CONTEXT_LOST with GL_LOST; UNSUPPORTED of what draws with FRAMEBUFFER.
 *
 * This header is C99 and C++, and includes no GL header. docs/ explains the space, the techniques and the costs. */
#ifndef PENUMBRA_H
#define PENUMBRA_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#ifndef PN_API
#if defined(__GNUC__) && !defined(_WIN32)
#define PN_API __attribute__((visibility("default")))
#else
#define PN_API
#endif
#endif

#define PN_VERSION_MAJOR 0
#define PN_VERSION_MINOR 1
#define PN_VERSION_PATCH 0
#define PN_VERSION_STRING "0.1.0"

typedef struct pn_context pn_context;
typedef struct pn_casters pn_casters;
typedef struct pn_receiver pn_receiver;
typedef struct pn_light pn_light;

/* The name of a GL object, as glGen* returned it; 0 = none. */
typedef uint32_t pn_gl;

/* The library's version at run time, for example "0.1.0". */
PN_API const char *pn_version(void);

/* ---- results and messages ---------------------------------------------------------------------------------------- */

typedef enum {
  PN_OK = 0,
  PN_ERROR_ARGUMENT = -1,      /* a value is out of its range, or contradicts another */
  PN_ERROR_UNSUPPORTED = -2,   /* this GL context cannot do it, or nothing can yet */
  PN_ERROR_OUT_OF_MEMORY = -3, /* the allocator, the driver, or pn_context_desc.gpu_memory_limit said no */
  PN_ERROR_SHADER = -4,        /* a shader did not compile; the log has the driver's text */
  PN_ERROR_CONTEXT_LOST = -5,  /* the GL context is gone: call pn_context_abandon */
  PN_ERROR_NOT_READY = -6      /* something that must come first is missing: see the message */
} pn_result;

/* A few words for a result, for example "argument"; never NULL. Static. */
PN_API const char *pn_result_name(pn_result result);

typedef enum { PN_LOG_ERROR = 0, PN_LOG_WARNING, PN_LOG_INFO } pn_log_level;

/* Every message the library can send. Ids are stable: new ones are appended. */
typedef enum {
  PN_MESSAGE_NONE = 0,
  PN_MESSAGE_NULL_ARGUMENT,           /* a required pointer is NULL, or an object is of another context */
  PN_MESSAGE_GL_VERSION,              /* the context is older than OpenGL 3.3 core */
  PN_MESSAGE_GL_FUNCTION,             /* the loader has no such function */
  PN_MESSAGE_GL_LOST,                 /* the GL context was lost or reset */
  PN_MESSAGE_OUT_OF_MEMORY,           /* the allocator returned NULL */
  PN_MESSAGE_GPU_MEMORY,              /* GL_OUT_OF_MEMORY, or gpu_memory_limit reached */
  PN_MESSAGE_FRAMEBUFFER,             /* this device has no texture of that size, or cannot draw into it */
  PN_MESSAGE_SHADER_COMPILE,          /* with the driver's log */
  PN_MESSAGE_SHADER_LINK,             /* with the driver's log */
  PN_MESSAGE_SHADER_MISSING,          /* a file is missing, or an #include does not resolve */
  PN_MESSAGE_SHADER_DIRECTORY,        /* pn_context_desc.shader_directory cannot be read */
  PN_MESSAGE_STATE_SCOPE,             /* pn_state_begin and pn_state_end do not pair up */
  PN_MESSAGE_MESH_POSITIONS,          /* no positions, or their offset, stride or count are impossible */
  PN_MESSAGE_MESH_INDICES,            /* index size not 0, 2 or 4, a count not divisible by 3, an index out of range */
  PN_MESSAGE_MESH_TEXCOORDS,          /* alpha texture and texture coordinates come together; or impossible spans */
  PN_MESSAGE_MESH_ALPHA,              /* channel not 0..3, cutoff not in [0, 1] */
  PN_MESSAGE_MESH_BOUNDS,             /* bounds missing for a GL buffer, inverted, or not finite */
  /* warning: triangles with a coordinate that is not finite, or without area, dropped */
  PN_MESSAGE_MESH_DROPPED,
  PN_MESSAGE_MESH_UNKNOWN,            /* the mesh was removed or never existed */
  PN_MESSAGE_INSTANCE_UNKNOWN,        /* the instance was removed or never existed */
  PN_MESSAGE_INSTANCE_TRANSFORM,      /* not finite, or its last row is not 0 0 0 1 */
  PN_MESSAGE_CASTER_GROUP,            /* group not 0..31, or a group mask this version cannot serve */
  PN_MESSAGE_CASTER_BOUNDS,           /* bounds of a draw callback inverted or not finite */
  /* neither or both of depth texture and framebuffer, or no such object; or a texture of the view is gone since */
  PN_MESSAGE_RECEIVER_SOURCE,
  PN_MESSAGE_RECEIVER_DEPTH,          /* the source has no depth this library can read */
  PN_MESSAGE_RECEIVER_VIEW,           /* the view rectangle is empty, negative, or outside its texture */
  PN_MESSAGE_RECEIVER_MATRIX,         /* view or projection not finite or not invertible */
  PN_MESSAGE_RECEIVER_NORMAL,         /* normal texture's size, format or encoding */
  PN_MESSAGE_RECEIVER_MASK,           /* mask texture's size or format */
  PN_MESSAGE_RECEIVER_SCALE,          /* scale not 1, 2 or 4 */
  PN_MESSAGE_RECEIVER_FORMAT,         /* result format unknown */
  PN_MESSAGE_RECEIVER_UNSET,          /* pn_receiver_set has not succeeded yet */
  PN_MESSAGE_LIGHT_SHAPE,             /* unknown shape */
  PN_MESSAGE_LIGHT_FRAME,             /* direction or axis zero, parallel, or not finite */
  /* half extents not positive, or beyond 1e9 (sun: tangent above PN_SUN_TANGENT_MAX) */
  PN_MESSAGE_LIGHT_SIZE,
  PN_MESSAGE_LIGHT_RANGE,             /* near distance or range negative, not finite, or near >= range */
  PN_MESSAGE_LIGHT_TEXTURE,           /* a textured light, which this version does not do yet */
  PN_MESSAGE_LIGHT_FIT,               /* unknown fit, or its bounds a point, inverted or not finite */
  PN_MESSAGE_LIGHT_MAP,               /* map size outside 1..8192 or beyond the device's limit */
  PN_MESSAGE_LIGHT_ANGLE,             /* warning: the map would open past 170 degrees and is clamped there */
  PN_MESSAGE_LIGHT_UNSET,             /* pn_light_set has not succeeded yet */
  /* pn_maps_update has not succeeded since the light or its technique changed, its casters are gone, or the pair was
   * not drawn yet */
  PN_MESSAGE_MAPS_STALE,
  PN_MESSAGE_TECHNIQUE_UNKNOWN,       /* no technique of that name */
  PN_MESSAGE_PARAMETER_UNKNOWN,       /* the technique has no such parameter */
  PN_MESSAGE_PARAMETER_VALUE,         /* not a value of the parameter's type, or out of its range */
  /* the host's texture has the wrong size, format, layer or channels, or is read by the call */
  PN_MESSAGE_RESULT_TARGET,
  PN_MESSAGE_FORWARD,                 /* no forward form, or slots, lights, program or version do not fit */
  PN_MESSAGE_FALLBACK,                /* information: a slower way is taken because the device lacks a feature */
  PN_MESSAGE_ACCUMULATION,            /* warning: 16-bit sums of many small occluders lose some of them (`ssm`) */
  PN_MESSAGE_STATE_MODE,              /* pn_context_desc.state is none of pn_state_mode */
  /* information, once a mesh: edges that are open, shared by three and more faces, between faces wound against each
   * other */
  PN_MESSAGE_MESH_EDGES,
  PN_MESSAGE_CASTER_MESHES,           /* warning: the technique needs meshes, and some casters have none */
  PN_MESSAGE_DEBUG_FLAGS,             /* pn_debug does not know all of its flags */
  /* the description's depth range is impossible; or, a warning once a receiver: glDepthRange is not 0 to 1, and the
   * description has none */
  PN_MESSAGE_RECEIVER_RANGE,
  PN_MESSAGE_RECEIVER_POSITION,       /* position_error negative or not finite */
  /* information, once a pair: with merge=0 windows may have more texels than are looked at one by one */
  PN_MESSAGE_SEARCH_COARSER,
  PN_MESSAGE_COUNT
} pn_message;

/* The stable name of a message id, for example "MESH_BOUNDS"; NULL when unknown. Static. */
PN_API const char *pn_message_name(int message_id);

/* Called on the calling thread, during the call that caused it. text is one line, valid during the callback, which must
 * not call the library. */
typedef void (*pn_log_fn)(void *user, pn_log_level level, int message_id, const char *text);

/* ---- context ----------------------------------------------------------------------------------------------------- */

/* What happens to the host's GL state. docs/integration.md lists every piece that is saved. */
typedef enum {
  PN_STATE_RESTORE = 0, /* every call leaves the state as it found it: about 100 glGet* and glIsEnabled a call */
  PN_STATE_SCOPED,      /* saved by pn_state_begin, restored by pn_state_end; calls in between read nothing back */
  /* nothing is read back; after each call the state is GL's default wherever the library touched it */
  PN_STATE_RESET
} pn_state_mode;

typedef struct {
  /* How GL functions are found. NULL: libepoxy finds them. Called during pn_context_create only. */
  void *(*get_proc_address)(void *user, const char *name);
  /* Memory: realloc's behaviour, and 0 bytes frees and returns NULL. NULL: realloc and free. */
  void *(*allocate)(void *user, void *old, size_t bytes);
  pn_log_fn log; /* NULL: silent */
  void *user;    /* handed to the three callbacks */
  pn_state_mode state;
  size_t gpu_memory_limit; /* bytes, for everything the library allocates in GL; 0 = none */
  /* GLSL is read from here instead of the embedded text, in the layout of src/, for live editing; what is missing there
   * is taken from the embedded text. NULL = embedded */
  const char *shader_directory;
} pn_context_desc;

/* Makes a context for the current GL context, OpenGL 3.3 core or newer (compatibility contexts work too). desc may be
 * NULL: all defaults. The description is copied, its strings too. No shader is compiled yet: see pn_prepare. *out is
 * NULL after a failure.
 * Errors: ARGUMENT (NULL_ARGUMENT, STATE_MODE, SHADER_DIRECTORY), UNSUPPORTED (GL_VERSION, GL_FUNCTION),
 * OUT_OF_MEMORY, CONTEXT_LOST: no GL context is current. */
PN_API pn_result pn_context_create(const pn_context_desc *desc, pn_context **out);

/* Frees the context and every object made from it that still lives (their handles become invalid), GL objects included.
 * Clears the handle. NULL and a NULL handle are fine. */
PN_API void pn_context_destroy(pn_context **context);

/* The same without a single GL call: for a GL context that is lost or already destroyed. None needs to be current. */
PN_API void pn_context_abandon(pn_context **context);

/* PN_STATE_SCOPED only: bracket any number of calls. Not nestable. In other modes they do nothing.
 * Errors: ARGUMENT (STATE_SCOPE). */
PN_API pn_result pn_state_begin(pn_context *context);
PN_API pn_result pn_state_end(pn_context *context);

/* Throws compiled programs away, so that the next call compiles again: with shader_directory, from the files as they
 * are now. Errors: none. */
PN_API pn_result pn_reload_shaders(pn_context *context);

/* What the device can do and what the library makes of it. Errors: ARGUMENT, without a message: out is NULL. */
typedef struct {
  const char *vendor, *renderer, *version; /* GL's strings, valid as long as the context */
  int gl_version;                          /* 33 for OpenGL 3.3 */
  /* nonzero: a software rasteriser; clocks are glFinish and the system's, not queries */
  int software;
  int map_size_max;                        /* largest map width and height here */
  int map_layers_max;                      /* layers of depth a light can have: peeled layers times tiles */
  size_t gpu_memory;                       /* bytes the library holds in GL now */
  size_t gl_calls;                         /* GL calls so far, in builds with assertions; else 0 */
} pn_info;
PN_API pn_result pn_context_info(const pn_context *context, pn_info *out);

/* Optional features, one call for each index from 0 until it returns 0. *in_use tells whether it is taken here; *help
 * says in one line what it is for and what happens without it. Strings are static. */
PN_API int pn_feature(const pn_context *context, int index, const char **name, int *in_use, const char **help);

/* ---- casters: what blocks light ---------------------------------------------------------------------------------- */

/* Numbers in a GL buffer (referenced, not copied: keep it alive, its contents may change) or in memory (copied during
 * the call). Exactly one of buffer and data is set. */
typedef struct {
  pn_gl buffer;
  const void *data;
  size_t offset; /* bytes to the first element */
  size_t stride; /* bytes from element to element; 0 = tightly packed */
  size_t count;  /* elements: vertices, or indices (not bytes, not triangles) */
} pn_span;

/* A triangle mesh. Triangles may face any way: what blocks light is decided per technique, and closed meshes give the
 * same shadow with any winding. */
typedef struct {
  pn_span positions; /* 3 floats each, object space */
  pn_span indices;   /* count 0: positions are triangles, three by three */
  int index_bytes;   /* 0 (no indices), 2 or 4 */
  pn_span texcoords; /* 2 floats each, with alpha_texture only */
  /* 2D texture, no integers, whose alpha_channel below alpha_cutoff makes holes; its own sampling parameters and
   * mipmaps are used, or, where it lacks mipmaps that they ask for, it is filtered linearly and repeated. 0: opaque.
   * Referenced, not copied */
  pn_gl alpha_texture;
  int alpha_channel;    /* 0..3 = red..alpha. Default 0: set 3 for the usual alpha */
  float alpha_cutoff;   /* [0, 1]; a texel with alpha >= cutoff blocks. 0 = 0.5 */
  /* object space; equal: computed from data. Required when positions are in a GL buffer */
  float bounds_min[3], bounds_max[3];
  /* nonzero: front faces wind clockwise seen from outside. Matters only to ssm:faces=culled */
  int clockwise;
} pn_mesh_desc;

typedef struct { uint32_t id; } pn_mesh;     /* id 0 is never valid */
typedef struct { uint32_t id; } pn_instance; /* id 0 is never valid */

/* Errors: ARGUMENT (NULL_ARGUMENT), OUT_OF_MEMORY. */
PN_API pn_result pn_casters_create(pn_context *context, pn_casters **out);

/* Clears the handle. NULL and a NULL handle are fine. Maps that were drawn of them stay. */
PN_API void pn_casters_destroy(pn_casters **casters);

/* Adds a mesh. It casts nothing until an instance places it. Triangles in memory with a coordinate that is not
 * finite, or without area, are dropped and counted in one warning (MESH_DROPPED). out->id is 0 after a failure.
 * Errors: ARGUMENT (NULL_ARGUMENT, MESH_POSITIONS, MESH_INDICES, MESH_TEXCOORDS, MESH_ALPHA, MESH_BOUNDS),
 * OUT_OF_MEMORY, CONTEXT_LOST. */
PN_API pn_result pn_mesh_add(pn_casters *casters, const pn_mesh_desc *desc, pn_mesh *out);

/* The mesh deformed. positions: new data of the same count in memory, of a mesh that came from memory, copied; or NULL
 * when the contents of the GL buffer changed. bounds: min and max in object space, six floats; NULL: computed (memory)
 * or unchanged (GL buffer). Its triangles are looked at anew: those without area in this pose are dropped.
 * Errors: ARGUMENT (MESH_UNKNOWN, MESH_POSITIONS, MESH_BOUNDS), OUT_OF_MEMORY, CONTEXT_LOST. */
PN_API pn_result pn_mesh_moved(pn_casters *casters, pn_mesh mesh, const pn_span *positions, const float *bounds);

/* Removes the mesh and its instances. Errors: ARGUMENT (MESH_UNKNOWN). */
PN_API pn_result pn_mesh_remove(pn_casters *casters, pn_mesh mesh);

#define PN_GROUP_COUNT 32
#define PN_GROUPS_ALL 0xffffffffu

/* Places a mesh. scene_from_object must be affine (last row 0 0 0 1); mirroring and zero scale are allowed. group
 * 0..31. out may be NULL for an instance that stays as it is; out->id is 0 after a failure.
 * Errors: ARGUMENT (NULL_ARGUMENT, MESH_UNKNOWN, INSTANCE_TRANSFORM, CASTER_GROUP), OUT_OF_MEMORY. */
PN_API pn_result pn_instance_add(pn_casters *casters, pn_mesh mesh, const float scene_from_object[16], int group,
                                 pn_instance *out);

/* Errors: ARGUMENT (NULL_ARGUMENT, INSTANCE_UNKNOWN, INSTANCE_TRANSFORM). */
PN_API pn_result pn_instance_move(pn_casters *casters, pn_instance instance, const float scene_from_object[16]);

/* Errors: ARGUMENT (INSTANCE_UNKNOWN). */
PN_API pn_result pn_instance_remove(pn_casters *casters, pn_instance instance);

/* Which surfaces a pass draws. */
typedef enum { PN_FACES_ANY = 3, PN_FACES_FRONT = 1, PN_FACES_BACK = 2 } pn_faces;

/* What a pass asks of the host's draw callback; valid during it. Framebuffer, viewport, scissor, depth function, depth
 * range, depth clamp, culling and colour mask are set: do not change them. Program, vertex array, textures and buffers
 * are the callback's to bind; the front face is GL_CCW, and the callback's to set where its triangles wind clockwise or
 * are mirrored. */
typedef struct {
  const float *clip_from_scene; /* 16 floats; GL's own depth convention (-1 to 1), never a reversed one */
  /* plane_count times 4: n.p + d >= 0 inside, scene space, for the host's culling; around less than the matrix shows
   * where a layer holds a part of the map only (parameter focus) */
  const float *planes;
  int plane_count;
  pn_faces faces;     /* already set with glCullFace, for information */
  /* not 0: bound to unit peel_unit; the fragment shader must call pn_peel(), see pn_glsl("caster", ...) */
  pn_gl peel_texture;
  int peel_unit;      /* value for the sampler uniform pn_peel_map */
  int layer, width, height;
} pn_caster_pass;
typedef void (*pn_draw_fn)(void *user, const pn_caster_pass *pass);

/* Casters drawn by the host's own shaders, beside any meshes: called once or more in each pn_maps_update, never later.
 * bounds: min and max in scene space, six floats, that contain everything drawn. One callback for a group, 0..31; draw
 * NULL removes it, and bounds may be NULL then. Tell new bounds when what is drawn moves; the next pn_maps_update takes
 * them. The callback may leave any GL state and must not call the library.
 * Errors: ARGUMENT (NULL_ARGUMENT, CASTER_GROUP, CASTER_BOUNDS). */
PN_API pn_result pn_casters_draw(pn_casters *casters, int group, pn_draw_fn draw, void *user, const float bounds[6]);

/* ---- receiver: one camera view ----------------------------------------------------------------------------------- */

/* How a normal texture stores the surface's geometric (not bump-mapped) normal. Length does not matter, either sign
 * will do. */
typedef enum {
  PN_NORMAL_SIGNED = 0,      /* rgb = normal: float or snorm textures */
  PN_NORMAL_UNSIGNED,        /* rgb = normal/2 + 1/2: unorm textures */
  PN_NORMAL_OCTAHEDRON,      /* rg = octahedral map in [-1, 1] */
  PN_NORMAL_OCTAHEDRON_UNSIGNED /* rg = octahedral map in [0, 1] */
} pn_normal_encoding;

/* What a visibility buffer stores. */
typedef enum {
  PN_FORMAT_R16F = 0, /* default; steps of 1/2048 near 1 */
  PN_FORMAT_R32F,
  PN_FORMAT_R8 /* steps of 1/255 */
} pn_format;

/* One camera view. The library reads the host's depth as it is: any depth format, any projection (perspective,
 * orthographic, off-centre, jittered, infinite, reversed), compare mode ignored. Textures are referenced: keep them
 * until the next pn_receiver_set. A zeroed description has every default; a source of depth, view and projection come
 * to it. */
typedef struct {
  pn_gl depth_texture;     /* 2D or 2D multisample (sample 0 is read); or */
  pn_gl depth_framebuffer; /* a framebuffer whose depth is copied (renderbuffers; multisample: sample 0), with */
  int use_framebuffer;     /* nonzero: that one, since the default framebuffer is named 0; else ignored */
  int x, y, width, height; /* the view inside it, pixels, GL's lower-left origin; sizes 0: the rest of a texture */
  float view[16];          /* eye from scene */
  float projection[16];    /* clip from eye */
  int depth_zero_to_one;   /* nonzero: the projection maps to [0, 1] (glClipControl with GL_ZERO_TO_ONE) */
  int reversed_depth;      /* nonzero: near is 1, and depth 0 means that nothing was drawn; else depth 1 does */
  float depth_range[2];    /* glDepthRange's near and far when depth was drawn, in [0, 1]; both 0 = 0 to 1 */
  /* 0: the tangent plane comes from depth. Same size and view rectangle as the depth texture (framebuffer: as the
   * view) */
  pn_gl normal_texture;
  pn_normal_encoding normal_encoding;
  int normal_in_view; /* nonzero: normals are in eye space, else in scene space */
  /* red = 0: not a receiver, visibility 1 is written. 0: everything receives. Size as the normal texture's */
  pn_gl mask_texture;
  int scale;          /* 1, 2 or 4: visibility is computed at 1/scale and brought up along depth and plane; 0 = 1 */
  pn_format format;   /* of the results; not of pn_visibility_into */
  /* Scene units, finite, not negative: how far the host's vertex shader may have moved a vertex, by float rounding,
   * before depth was made; a caster nearer to a surface than that casts no shadow on it. Depth's own precision is not
   * meant. 0: estimated from view, as if positions went through scene space in floats, and from the casters'
   * transforms: about 1e-6 of the camera's distance from the origin, next to nothing near it. A host that composes
   * object to clip in double loses less, about 2e-7 of the view's size (docs/integration.md) */
  float position_error;
} pn_receiver_desc;
/* As a zeroed one. */
#ifdef __cplusplus
#define PN_RECEIVER_DEFAULTS {}
#else
#define PN_RECEIVER_DEFAULTS {0}
#endif

/* Errors: ARGUMENT (NULL_ARGUMENT), OUT_OF_MEMORY. */
PN_API pn_result pn_receiver_create(pn_context *context, pn_receiver **out);

/* And its results. Clears the handle. NULL and a NULL handle are fine. */
PN_API void pn_receiver_destroy(pn_receiver **receiver);

/* What the camera sees. It must be called in each frame in which depth or a matrix changed, after the depth pre-pass,
 * and before pn_maps_update with PN_FIT_VISIBLE or PN_FIT_FRUSTUM: depth of a framebuffer or of a multisample texture
 * is copied here, and without normals the slopes of depth are found once, in the first pn_visibility after it, and kept
 * until the next call.
 * Warning: RECEIVER_RANGE.
 * Errors: ARGUMENT (NULL_ARGUMENT, RECEIVER_SOURCE, RECEIVER_DEPTH, RECEIVER_VIEW, RECEIVER_RANGE, RECEIVER_MATRIX,
 * RECEIVER_NORMAL, RECEIVER_MASK, RECEIVER_SCALE, RECEIVER_FORMAT, RECEIVER_POSITION); where depth is copied
 * UNSUPPORTED, OUT_OF_MEMORY, SHADER, CONTEXT_LOST. */
PN_API pn_result pn_receiver_set(pn_receiver *receiver, const pn_receiver_desc *desc);

/* ---- light ------------------------------------------------------------------------------------------------------- */

typedef enum { PN_LIGHT_RECTANGLE = 0, PN_LIGHT_SUN } pn_light_shape;

/* Which casters the depth maps are fitted to. Accuracy depends on the map's resolution over what casts. Bounds snap,
 * so that a caster moving inside them does not make the others' shadows crawl. */
typedef enum {
  /* what can shadow a visible receiver: reads a little back from the receivers' depth and from a small image of the
   * casters, one synchronisation a call. Draw callbacks run once to three times more. Without receivers: everything
   * that casts */
  PN_FIT_VISIBLE = 0,
  PN_FIT_CASTERS,     /* everything that casts */
  PN_FIT_FRUSTUM,     /* what can shadow a point in the receivers' view frusta: no read-back, less tight */
  PN_FIT_GIVEN        /* the box fit_bounds, taken literally: no snapping, no empty border */
} pn_fit;

#define PN_SUN_TANGENT_MAX 1.0f /* a sun is at most 90 degrees wide */
#define PN_MAP_SIZE_MAX 8192

typedef struct {
  pn_light_shape shape;
  float center[3];    /* rectangle: its centre. Sun: ignored */
  float direction[3]; /* where it shines; any length but zero */
  /* the rectangle's first axis; made perpendicular to direction. Zero: derived from up, see pn_light_frame */
  float axis_u[3];
  float half_u, half_v; /* rectangle: half extents, scene units, to 1e9. Sun: tangents of the angular radii */
  /* Casters nearer than this are taken to be this far; snapped down, as bounds are. 0: from the casters */
  float near_distance;
  float range;          /* casters wholly beyond this distance cast nothing. 0: no limit */
  pn_gl texture;        /* radiance over the light: not yet, must be 0 */
  pn_fit fit;
  float fit_bounds[6];  /* PN_FIT_GIVEN: min and max, scene space; not a point */
  int map_width, map_height; /* texels of each depth map, 1..8192, any number; 0 = 512, height 0 = width */
} pn_light_desc;

/* Errors: ARGUMENT (NULL_ARGUMENT), OUT_OF_MEMORY. */
PN_API pn_result pn_light_create(pn_context *context, pn_light **out);

/* And its maps and results. Clears the handle. NULL and a NULL handle are fine. */
PN_API void pn_light_destroy(pn_light **light);

/* Sets or changes the light. After a change pn_maps_update must come before the next pn_visibility; the same
 * description again changes nothing.
 * Errors: ARGUMENT (NULL_ARGUMENT, LIGHT_SHAPE, LIGHT_SIZE, LIGHT_RANGE, LIGHT_FIT, LIGHT_MAP, LIGHT_FRAME),
 * UNSUPPORTED (LIGHT_TEXTURE). */
PN_API pn_result pn_light_set(pn_light *light, const pn_light_desc *desc);

/* The frame of a light that shines along direction: u = normalize(direction x up), v = u x direction; where up is NULL,
 * not finite or parallel to direction it becomes (0, 0, -1), then (1, 0, 0). direction_out is unit. Any output may be
 * NULL. Errors: ARGUMENT, without a message: direction NULL, zero or not finite. */
PN_API pn_result pn_light_frame(const float direction[3], const float up[3], float direction_out[3], float u[3],
                                float v[3]);

/* ---- techniques: everything by table ----------------------------------------------------------------------------- */

typedef enum { PN_INT = 0, PN_FLOAT, PN_BOOL, PN_CHOICE } pn_type;

typedef struct {
  const char *name, *unit, *help, *source; /* unit may be "", source is the paper's section or equation */
  pn_type type;
  double least, most, initial;  /* PN_CHOICE: 0 .. number of choices - 1 */
  /* NULL-terminated. PN_CHOICE: its values by name. PN_FLOAT: one word that stands for the value least, or NULL */
  const char *const *choices;
} pn_parameter;

typedef struct {
  const char *name, *title, *help;
  const pn_parameter *parameters;
  int parameter_count;
  int needs_meshes; /* what draw callbacks draw casts a hard shadow at most: there is no mesh to look at */
  int needs_closed; /* casters should be closed surfaces */
  int forward;      /* has a pn_visibility() for the host's own shaders */
  int self_shadows; /* casters may be receivers too */
} pn_technique;

PN_API int pn_technique_count(void);
PN_API const pn_technique *pn_technique_at(int index);              /* NULL out of range */
PN_API const pn_technique *pn_technique_find(const char *name);     /* NULL when unknown */

/* What measured best for everyday use (docs/techniques/bitmask.md). */
#define PN_TECHNIQUE_DEFAULT "bitmask"

/* Chooses the technique and its parameters: "pcss" or "pcss:samples=16". Parameters not named take their defaults. On
 * failure why (may be NULL) receives one line that names what is wrong and what would be right, always terminated; else
 * it is empty. A new light has PN_TECHNIQUE_DEFAULT. After a change pn_maps_update must come before the next
 * pn_visibility.
 * Errors: ARGUMENT (NULL_ARGUMENT, TECHNIQUE_UNKNOWN, PARAMETER_UNKNOWN, PARAMETER_VALUE). */
PN_API pn_result pn_light_technique(pn_light *light, const char *spec, char *why, size_t why_size);

/* Checks a spec without a light or a context. technique, values and why may be NULL; values has room for
 * parameter_count numbers; on failure both stay as they were. Errors: ARGUMENT, without a message: why says it. */
PN_API pn_result pn_technique_parse(const char *spec, const pn_technique **technique, double *values, char *why,
                                    size_t why_size);

/* Changes one parameter of the light's technique; a choice by its index, on and off as 1 and 0. "preset" sets the
 * others too. Where it changes what the maps hold, pn_maps_update must come before the next pn_visibility.
 * Errors: ARGUMENT (NULL_ARGUMENT, PARAMETER_UNKNOWN, PARAMETER_VALUE). */
PN_API pn_result pn_light_parameter(pn_light *light, const char *name, double value);

/* Compiles now what a light with this spec will need for a view like that one, and draws a small scene once with all of
 * it, because drivers finish compiling at the first draw: no frame has to. spec NULL: PN_TECHNIQUE_DEFAULT. like: a
 * description as pn_receiver_set will get it. Of its textures it counts only whether there are any, and of width and
 * height only whether they are powers of two, so that it may be filled before they exist; matrices, format of depth and
 * framebuffers play no part. NULL: views as most hosts have them, with normals and without. Only errors are logged.
 * Errors: ARGUMENT (TECHNIQUE_UNKNOWN, PARAMETER_UNKNOWN, PARAMETER_VALUE, RECEIVER_NORMAL, RECEIVER_SCALE,
 * RECEIVER_FORMAT), UNSUPPORTED, OUT_OF_MEMORY, SHADER, CONTEXT_LOST. */
PN_API pn_result pn_prepare(pn_context *context, const char *spec, const pn_receiver_desc *like);

/* ---- a frame ----------------------------------------------------------------------------------------------------- */

/* Draws the light's depth maps. groups: a bit for each group that casts (PN_GROUPS_ALL). visible: the receivers that
 * PN_FIT_VISIBLE and PN_FIT_FRUSTUM look at, visible_count of them; 0: they fit to all casters. The maps stay until the
 * next call; the casters may change or go meanwhile, but for the technique `average` (docs/techniques/average.md).
 * Warnings: LIGHT_ANGLE, CASTER_MESHES.
 * Errors: ARGUMENT (NULL_ARGUMENT), NOT_READY (LIGHT_UNSET, RECEIVER_UNSET), UNSUPPORTED, OUT_OF_MEMORY, SHADER,
 * CONTEXT_LOST. After a failure the maps of the last update stay, and pn_visibility goes on with them. NOT_READY too
 * where the host deleted what is read: RECEIVER_SOURCE, MESH_ALPHA, MESH_POSITIONS. */
PN_API pn_result pn_maps_update(pn_light *light, pn_casters *casters, uint32_t groups, pn_receiver *const *visible,
                                int visible_count);

/* Maps to visibility buffer. Visibility is the unblocked fraction of the part of the light above the receiver's
 * geometric horizon, and 1 where no part is (surfaces that face away, or lie behind a rectangle), on background, and
 * where the mask says so. May be called without a new pn_maps_update: the maps stay.
 * Errors: ARGUMENT (NULL_ARGUMENT), NOT_READY (RECEIVER_UNSET, MAPS_STALE), UNSUPPORTED, OUT_OF_MEMORY, SHADER,
 * CONTEXT_LOST. After a failure the last result stays. NOT_READY too where the host deleted what is read, or made it
 * smaller: RECEIVER_SOURCE; MESH_ALPHA with `average`. */
PN_API pn_result pn_visibility(pn_light *light, pn_receiver *receiver);

typedef struct {
  pn_gl texture;
  uint32_t target; /* GL_TEXTURE_2D, GL_TEXTURE_2D_ARRAY */
  uint32_t format; /* GL's sized internal format */
  int width, height, layers, channels; /* layers: 0 of a 2D texture */
} pn_image;

/* The last result of the pair. The texture is the library's; it is valid until the pair's next pn_visibility, and the
 * same texture while size and format stay. Row 0 is the view's lowest.
 * Errors: ARGUMENT (NULL_ARGUMENT), NOT_READY (MAPS_STALE). */
PN_API pn_result pn_result_image(pn_light *light, pn_receiver *receiver, pn_image *out);

/* Channels of a texture, to be added up. */
enum { PN_CHANNEL_RED = 1, PN_CHANNEL_GREEN = 2, PN_CHANNEL_BLUE = 4, PN_CHANNEL_ALPHA = 8 };

/* Where a result goes in the host's own memory. */
typedef struct {
  /* 2D or 2D array, of the view's size at least, of any colour-renderable format that is no integer one; not one that
   * the call reads. Written at the origin of level 0 */
  pn_gl texture;
  int layer;    /* of an array; 0 of a 2D texture */
  /* PN_CHANNEL_... that are written, each with the same visibility: four lights fit into one RGBA texture. 0: all that
   * the texture has, alpha too */
  int channels;
} pn_target;

/* As pn_visibility, but written into a texture of the host's; what pn_result_image tells stays as it was. Other
 * channels and what lies outside the view keep what they have.
 * Errors: as pn_visibility, and ARGUMENT (RESULT_TARGET). */
PN_API pn_result pn_visibility_into(pn_light *light, pn_receiver *receiver, const pn_target *target);

/* The soft shadow map of the pair's last pn_visibility with the technique `ssm` (Soft Shadow Maps, section 3): how much
 * of the light is hidden, as a map in (s, t) of the light (docs/space.md), for hosts that project it themselves. It
 * holds what this receiver's view shows, and 0 elsewhere. A receiver may be a view from the light. */
typedef struct {
  pn_image image;       /* GL_TEXTURE_2D_ARRAY of R32F or R16F; sums of overlapping occluders may exceed 1 */
  int sides, layers;    /* array layer = side * layers + receivers' layer, nearest to the light first */
  float s0, t0, s1, t1; /* bounds */
} pn_soft_shadow_map;
/* The texture is the library's, and valid until the pair's next pn_visibility or pn_visibility_into.
 * Errors: ARGUMENT (NULL_ARGUMENT), NOT_READY (MAPS_STALE): the last one had another technique, or no shadow. */
PN_API pn_result pn_soft_shadow_map_image(pn_light *light, pn_receiver *receiver, pn_soft_shadow_map *out);

/* Makes techniques tell what they did, as debug images. flags: the sum of what is wanted, 0 at first.
 * Errors: ARGUMENT (DEBUG_FLAGS).
 * PN_DEBUG_SEARCH  "search", of techniques that search: red = class (0 no map was asked, 1 lit, 2 umbra, 3 penumbra),
 *                  green = blocks visited, blue = primitives covered, alpha = texels in the search windows; and
 *                  "levels": red = the coarsest level that its primitives came from (0 texels, 1 blocks of 2 x 2 and
 *                  so on; with descent where it began), green = that of the ranges that narrowed the windows last;
 *                  costs two more colour targets. Of technique `ssm`: "covered", in the layers of the soft shadow
 *                  map, how many micropatches came by each texel; costs another drawing
 * PN_DEBUG_BOUND   "bound", of technique `ssm` with merge=0: how far visibility may be off because neighbouring
 *                  micropatches overlap or part (Soft Shadow Maps, Eq. 3); costs another drawing of them all */
enum { PN_DEBUG_SEARCH = 1, PN_DEBUG_BOUND = 2 };
PN_API pn_result pn_debug(pn_context *context, int flags);

/* Intermediate images, for looking at: index from 0 until it returns 0. receiver may be NULL: the light's only. Which
 * there are depends on technique, receiver and pn_debug; docs/integration.md lists the names, which are static. The
 * textures are the library's, valid until the light's next pn_maps_update or the pair's next pn_visibility. */
PN_API int pn_debug_image(pn_light *light, pn_receiver *receiver, int index, const char **name, pn_image *out);

/* What the last pn_maps_update drew. Errors: ARGUMENT (NULL_ARGUMENT), NOT_READY (MAPS_STALE). */
typedef struct {
  int empty;          /* nothing casts here: no map was drawn, visibility is 1 */
  int tiles, layers;  /* maps in the (s, t) plane, and depth images of each */
  int width, height;  /* texels of each map */
  float s0, t0, s1, t1; /* bounds over all tiles in light map space (docs/space.md) */
  float w_near, w_far;
  float texel_s, texel_t; /* width and height of the largest texel, in s and t */
  size_t gpu_memory;  /* bytes that depth maps and ranges hold, of an earlier update too where this one was empty */
} pn_maps_info;
PN_API pn_result pn_light_maps(const pn_light *light, pn_maps_info *out);

/* ---- forward shading: the same function inside the host's own shaders -------------------------------------------- */

/* GLSL text, owned by the context and valid as long as it; NULL on failure, with a message. No #version line, every
 * name starts with pn_.
 * a technique's spec  float pn_visibility(int light, vec3 position, vec3 geometric_normal), scene space, for the
 * lights of pn_bind; the normal
 *                       on the side that is shaded, any length
 *   "caster"            void pn_peel(): call it first in the fragment shader of a draw callback
 * glsl_version: 330 and up, or 300 and up with es nonzero.
 * Messages: NULL_ARGUMENT, FORWARD, TECHNIQUE_UNKNOWN, PARAMETER_UNKNOWN, PARAMETER_VALUE, SHADER_MISSING,
 * OUT_OF_MEMORY. */
PN_API const char *pn_glsl(pn_context *context, const char *spec, int glsl_version, int es);

typedef struct {
  int first_texture_unit; /* each light takes two units */
  int uniform_binding;    /* of the uniform block pn_block */
} pn_slots;

#define PN_FORWARD_LIGHTS_MAX 4

/* Binds the maps and the uniform block of count lights (1..4) for a program that contains pn_glsl's text, and sets its
 * samplers. The lights must share a technique, and agree in those of its parameters that are compiled in, which is
 * where pn_glsl's texts would differ; the others may be each light's own. Stays bound until the host binds something
 * else: the one call that changes GL state on purpose.
 * Errors: ARGUMENT (NULL_ARGUMENT, FORWARD), NOT_READY (MAPS_STALE), OUT_OF_MEMORY, CONTEXT_LOST. */
PN_API pn_result pn_bind(pn_light *const *lights, int count, pn_gl program, const pn_slots *slots);

/* ---- time -------------------------------------------------------------------------------------------------------- */

typedef struct {
  const char *stage; /* for example "depth_map"; static */
  double milliseconds;
} pn_time;

/* Turns measuring on or off; off at first. On hardware: timestamp queries, read some frames later, no stall, never
 * nested in a query of the host's. On software GL, where queries lie: glFinish around each stage and a monotonic
 * clock. Errors: none. */
PN_API pn_result pn_timing(pn_context *context, int enabled);

/* Stage times of the latest frame of this light whose times are known, over its maps and all its receivers: fills up to
 * capacity, returns how many there are; 0 where an argument is wrong. wait nonzero: finishes the GL's work first, so
 * that the frame just drawn is known. */
PN_API int pn_times(pn_light *light, pn_time *out, int capacity, int wait);

#ifdef __cplusplus
}
#endif
#endif
