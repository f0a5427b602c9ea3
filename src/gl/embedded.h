/* The .glsl files of src/, embedded by the build (cmake/embed_shaders.cmake). */
#ifndef PNI_GL_EMBEDDED_H
#define PNI_GL_EMBEDDED_H

typedef struct {
  const char *path; /* relative to src/, for example "techniques/hard/hard.glsl" */
  const char *text; /* the file's bytes, zero-terminated; #include lines are not resolved */
} pni_embedded_shader;

/* Sorted by path; one more entry of two NULLs follows the last. */
extern const pni_embedded_shader pni_embedded_shaders[];
extern const int pni_embedded_shader_count;

#endif
