#include <stdio.h>
#include <string.h>

#include "state.h"

static state_entry *put(state_list *out, const char *name, int index) {
  static state_entry overflow;
  state_entry *entry = out->count < STATE_ENTRIES ? &out->entries[out->count++] : &overflow;
  memset(entry, 0, sizeof *entry);
  if (index < 0) {
    snprintf(entry->name, sizeof entry->name, "%s", name);
  } else {
    snprintf(entry->name, sizeof entry->name, "%s[%d]", name, index);
  }
  return entry;
}

typedef struct {
  GLenum name;
  const char *text;
  int count, since; /* numbers; version */
} query;

#define Q(name, count, since) \
  { GL_##name, #name, count, since }

static const query capabilities[] = {
    Q(COLOR_LOGIC_OP, 1, 33),
    Q(CULL_FACE, 1, 33),
    Q(DEPTH_CLAMP, 1, 33),
    Q(DEPTH_TEST, 1, 33),
    Q(DITHER, 1, 33),
    Q(FRAMEBUFFER_SRGB, 1, 33),
    Q(LINE_SMOOTH, 1, 33),
    Q(MULTISAMPLE, 1, 33),
    Q(POLYGON_OFFSET_FILL, 1, 33),
    Q(POLYGON_OFFSET_LINE, 1, 33),
    Q(POLYGON_OFFSET_POINT, 1, 33),
    Q(POLYGON_SMOOTH, 1, 33),
    Q(PRIMITIVE_RESTART, 1, 33),
    Q(PROGRAM_POINT_SIZE, 1, 33),
    Q(RASTERIZER_DISCARD, 1, 33),
    Q(SAMPLE_ALPHA_TO_COVERAGE, 1, 33),
    Q(SAMPLE_ALPHA_TO_ONE, 1, 33),
    Q(SAMPLE_COVERAGE, 1, 33),
    Q(SAMPLE_MASK, 1, 33),
    Q(SCISSOR_TEST, 1, 33),
    Q(STENCIL_TEST, 1, 33),
    Q(TEXTURE_CUBE_MAP_SEAMLESS, 1, 33),
    Q(CLIP_DISTANCE0, 1, 33),
    Q(CLIP_DISTANCE1, 1, 33),
    Q(CLIP_DISTANCE2, 1, 33),
    Q(CLIP_DISTANCE3, 1, 33),
    Q(CLIP_DISTANCE4, 1, 33),
    Q(CLIP_DISTANCE5, 1, 33),
    Q(CLIP_DISTANCE6, 1, 33),
    Q(CLIP_DISTANCE7, 1, 33),
    Q(SAMPLE_SHADING, 1, 40),
    Q(PRIMITIVE_RESTART_FIXED_INDEX, 1, 43),
    Q(DEBUG_OUTPUT, 1, 43),
    Q(DEBUG_OUTPUT_SYNCHRONOUS, 1, 43),
};

static const query integers[] = {
    Q(CURRENT_PROGRAM, 1, 33),
    Q(VERTEX_ARRAY_BINDING, 1, 33),
    Q(ARRAY_BUFFER_BINDING, 1, 33),
    Q(ELEMENT_ARRAY_BUFFER_BINDING, 1, 33),
    Q(UNIFORM_BUFFER_BINDING, 1, 33),
    Q(PIXEL_PACK_BUFFER_BINDING, 1, 33),
    Q(PIXEL_UNPACK_BUFFER_BINDING, 1, 33),
    Q(COPY_READ_BUFFER, 1, 33),
    Q(COPY_WRITE_BUFFER, 1, 33),
    Q(TRANSFORM_FEEDBACK_BUFFER_BINDING, 1, 33),
    Q(TEXTURE_BUFFER, 1, 33),
    Q(DRAW_FRAMEBUFFER_BINDING, 1, 33),
    Q(READ_FRAMEBUFFER_BINDING, 1, 33),
    Q(RENDERBUFFER_BINDING, 1, 33),
    Q(VIEWPORT, 4, 33),
    Q(SCISSOR_BOX, 4, 33),
    Q(DEPTH_FUNC, 1, 33),
    Q(DEPTH_WRITEMASK, 1, 33),
    Q(STENCIL_CLEAR_VALUE, 1, 33),
    Q(STENCIL_FUNC, 1, 33),
    Q(STENCIL_REF, 1, 33),
    Q(STENCIL_VALUE_MASK, 1, 33),
    Q(STENCIL_WRITEMASK, 1, 33),
    Q(STENCIL_FAIL, 1, 33),
    Q(STENCIL_PASS_DEPTH_FAIL, 1, 33),
    Q(STENCIL_PASS_DEPTH_PASS, 1, 33),
    Q(STENCIL_BACK_FUNC, 1, 33),
    Q(STENCIL_BACK_REF, 1, 33),
    Q(STENCIL_BACK_VALUE_MASK, 1, 33),
    Q(STENCIL_BACK_WRITEMASK, 1, 33),
    Q(STENCIL_BACK_FAIL, 1, 33),
    Q(STENCIL_BACK_PASS_DEPTH_FAIL, 1, 33),
    Q(STENCIL_BACK_PASS_DEPTH_PASS, 1, 33),
    Q(CULL_FACE_MODE, 1, 33),
    Q(FRONT_FACE, 1, 33),
    Q(POLYGON_MODE, 2, 33),
    Q(LOGIC_OP_MODE, 1, 33),
    Q(SAMPLE_COVERAGE_INVERT, 1, 33),
    Q(PRIMITIVE_RESTART_INDEX, 1, 33),
    Q(PROVOKING_VERTEX, 1, 33),
    Q(POINT_SPRITE_COORD_ORIGIN, 1, 33),
    Q(LINE_SMOOTH_HINT, 1, 33),
    Q(POLYGON_SMOOTH_HINT, 1, 33),
    Q(TEXTURE_COMPRESSION_HINT, 1, 33),
    Q(FRAGMENT_SHADER_DERIVATIVE_HINT, 1, 33),
    Q(CLAMP_READ_COLOR, 1, 33),
    Q(DEBUG_GROUP_STACK_DEPTH, 1, 43),
    Q(PACK_SWAP_BYTES, 1, 33),
    Q(PACK_LSB_FIRST, 1, 33),
    Q(PACK_ROW_LENGTH, 1, 33),
    Q(PACK_IMAGE_HEIGHT, 1, 33),
    Q(PACK_SKIP_ROWS, 1, 33),
    Q(PACK_SKIP_PIXELS, 1, 33),
    Q(PACK_SKIP_IMAGES, 1, 33),
    Q(PACK_ALIGNMENT, 1, 33),
    Q(UNPACK_SWAP_BYTES, 1, 33),
    Q(UNPACK_LSB_FIRST, 1, 33),
    Q(UNPACK_ROW_LENGTH, 1, 33),
    Q(UNPACK_IMAGE_HEIGHT, 1, 33),
    Q(UNPACK_SKIP_ROWS, 1, 33),
    Q(UNPACK_SKIP_PIXELS, 1, 33),
    Q(UNPACK_SKIP_IMAGES, 1, 33),
    Q(UNPACK_ALIGNMENT, 1, 33),
    Q(ACTIVE_TEXTURE, 1, 33),
    Q(READ_BUFFER, 1, 33),
    Q(DRAW_BUFFER0, 1, 33),
    Q(DRAW_BUFFER1, 1, 33),
    Q(DRAW_INDIRECT_BUFFER_BINDING, 1, 40),
    Q(PATCH_VERTICES, 1, 40),
    Q(TRANSFORM_FEEDBACK_BINDING, 1, 40),
    Q(PROGRAM_PIPELINE_BINDING, 1, 41),
    Q(ATOMIC_COUNTER_BUFFER_BINDING, 1, 42),
    Q(SHADER_STORAGE_BUFFER_BINDING, 1, 43),
    Q(DISPATCH_INDIRECT_BUFFER_BINDING, 1, 43),
    Q(QUERY_BUFFER_BINDING, 1, 44),
    Q(CLIP_ORIGIN, 1, 45),
    Q(CLIP_DEPTH_MODE, 1, 45),
};

static const query floats[] = {
    Q(DEPTH_RANGE, 2, 33),
    Q(DEPTH_CLEAR_VALUE, 1, 33),
    Q(COLOR_CLEAR_VALUE, 4, 33),
    Q(BLEND_COLOR, 4, 33),
    Q(POLYGON_OFFSET_FACTOR, 1, 33),
    Q(POLYGON_OFFSET_UNITS, 1, 33),
    Q(SAMPLE_COVERAGE_VALUE, 1, 33),
    Q(POINT_SIZE, 1, 33),
    Q(POINT_FADE_THRESHOLD_SIZE, 1, 33),
    Q(LINE_WIDTH, 1, 33),
    Q(MIN_SAMPLE_SHADING_VALUE, 1, 40),
    Q(PATCH_DEFAULT_OUTER_LEVEL, 4, 40),
    Q(PATCH_DEFAULT_INNER_LEVEL, 2, 40),
};

static const query unit_bindings[] = {
    Q(TEXTURE_BINDING_1D, 1, 33),
    Q(TEXTURE_BINDING_2D, 1, 33),
    Q(TEXTURE_BINDING_3D, 1, 33),
    Q(TEXTURE_BINDING_1D_ARRAY, 1, 33),
    Q(TEXTURE_BINDING_2D_ARRAY, 1, 33),
    Q(TEXTURE_BINDING_CUBE_MAP, 1, 33),
    Q(TEXTURE_BINDING_RECTANGLE, 1, 33),
    Q(TEXTURE_BINDING_BUFFER, 1, 33),
    Q(TEXTURE_BINDING_2D_MULTISAMPLE, 1, 33),
    Q(TEXTURE_BINDING_2D_MULTISAMPLE_ARRAY, 1, 33),
    Q(SAMPLER_BINDING, 1, 33),
    Q(TEXTURE_BINDING_CUBE_MAP_ARRAY, 1, 40),
};

static const query blends[] = {
    Q(BLEND_SRC_RGB, 1, 33),   Q(BLEND_DST_RGB, 1, 33),      Q(BLEND_SRC_ALPHA, 1, 33),
    Q(BLEND_DST_ALPHA, 1, 33), Q(BLEND_EQUATION_RGB, 1, 33), Q(BLEND_EQUATION_ALPHA, 1, 33),
};

static const query images[] = {
    Q(IMAGE_BINDING_NAME, 1, 42),  Q(IMAGE_BINDING_LEVEL, 1, 42),  Q(IMAGE_BINDING_LAYERED, 1, 42),
    Q(IMAGE_BINDING_LAYER, 1, 42), Q(IMAGE_BINDING_ACCESS, 1, 42), Q(IMAGE_BINDING_FORMAT, 1, 42),
};

static const query running[] = {
    {GL_SAMPLES_PASSED, "SAMPLES_PASSED", 1, 33},
    {GL_ANY_SAMPLES_PASSED, "ANY_SAMPLES_PASSED", 1, 33},
    {GL_TIME_ELAPSED, "TIME_ELAPSED", 1, 33},
    {GL_PRIMITIVES_GENERATED, "PRIMITIVES_GENERATED", 1, 33},
};

static const query texture_parameters[] = {
    Q(TEXTURE_MIN_FILTER, 1, 33),   Q(TEXTURE_MAG_FILTER, 1, 33),   Q(TEXTURE_WRAP_S, 1, 33),
    Q(TEXTURE_WRAP_T, 1, 33),       Q(TEXTURE_BASE_LEVEL, 1, 33),   Q(TEXTURE_MAX_LEVEL, 1, 33),
    Q(TEXTURE_COMPARE_MODE, 1, 33), Q(TEXTURE_COMPARE_FUNC, 1, 33), Q(TEXTURE_SWIZZLE_R, 1, 33),
};
#undef Q

#define EACH(table, q) for (const query *q = table; q < table + sizeof table / sizeof *table; q++)

static void read_plain(state_list *out, int version) {
  EACH(capabilities, q) {
    if (version >= q->since) put(out, q->text, -1)->value[0] = gl.IsEnabled(q->name);
  }
  EACH(integers, q) {
    GLint v[4] = {0};
    if (version < q->since) continue;
    gl.GetIntegerv(q->name, v);
    state_entry *entry = put(out, q->text, -1);
    for (int i = 0; i < q->count; i++) entry->value[i] = v[i];
  }
  EACH(floats, q) {
    GLfloat v[4] = {0};
    if (version < q->since) continue;
    gl.GetFloatv(q->name, v);
    state_entry *entry = put(out, q->text, -1);
    for (int i = 0; i < q->count; i++) entry->value[i] = v[i];
  }
  EACH(running, q) {
    GLint v = 0;
    gl.GetQueryiv(q->name, GL_CURRENT_QUERY, &v);
    put(out, q->text, -1)->value[0] = v;
  }
}

/* Every unit's bindings, and the parameters of the 2D texture bound there, which may be the host's depth. */
static void read_units(state_list *out, int version) {
  GLint active, units;
  gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
  gl.GetIntegerv(GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS, &units);
  if (units > 48) units = 48;
  for (GLint unit = 0; unit < units; unit++) {
    gl.ActiveTexture(GL_TEXTURE0 + (GLenum)unit);
    EACH(unit_bindings, q) {
      GLint v = 0;
      if (version < q->since) continue;
      gl.GetIntegerv(q->name, &v);
      put(out, q->text, unit)->value[0] = v;
    }
  }
  gl.ActiveTexture(GL_TEXTURE0);
  EACH(texture_parameters, q) {
    GLint v = 0;
    gl.GetTexParameteriv(GL_TEXTURE_2D, q->name, &v);
    put(out, q->text, -1)->value[0] = v;
  }
  gl.ActiveTexture((GLenum)active);
}

static void read_ranges(state_list *out, const char *name, GLenum binding, GLenum start, GLenum size, int count) {
  for (int i = 0; i < count; i++) {
    GLint v = 0;
    GLint64 a = 0, b = 0;
    gl.GetIntegeri_v(binding, (GLuint)i, &v);
    gl.GetInteger64i_v(start, (GLuint)i, &a);
    gl.GetInteger64i_v(size, (GLuint)i, &b);
    state_entry *entry = put(out, name, i);
    entry->value[0] = v, entry->value[1] = (double)a, entry->value[2] = (double)b;
  }
}

static void read_indexed(state_list *out, int version) {
  for (GLuint i = 0; i < 8; i++) {
    GLboolean mask[4] = {0};
    gl.GetBooleani_v(GL_COLOR_WRITEMASK, i, mask);
    state_entry *entry = put(out, "COLOR_WRITEMASK", (int)i);
    for (int k = 0; k < 4; k++) entry->value[k] = mask[k];
    put(out, "BLEND", (int)i)->value[0] = gl.IsEnabledi(GL_BLEND, i);
    EACH(blends, q) {
      GLint v = 0;
      if (version >= 40) gl.GetIntegeri_v(q->name, i, &v);
      else gl.GetIntegerv(q->name, &v);
      put(out, q->text, (int)i)->value[0] = v;
    }
  }
  GLint mask = 0;
  gl.GetIntegeri_v(GL_SAMPLE_MASK_VALUE, 0, &mask);
  put(out, "SAMPLE_MASK_VALUE", 0)->value[0] = mask;
  read_ranges(out, "uniform buffer", GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER_START, GL_UNIFORM_BUFFER_SIZE, 36);
  read_ranges(out, "transform feedback buffer", GL_TRANSFORM_FEEDBACK_BUFFER_BINDING,
              GL_TRANSFORM_FEEDBACK_BUFFER_START, GL_TRANSFORM_FEEDBACK_BUFFER_SIZE, 4);
  if (version >= 43) {
    read_ranges(out, "storage buffer", GL_SHADER_STORAGE_BUFFER_BINDING, GL_SHADER_STORAGE_BUFFER_START,
                GL_SHADER_STORAGE_BUFFER_SIZE, 8);
  }
  for (GLuint i = 0; version >= 42 && i < 8; i++) {
    EACH(images, q) {
      GLint v = 0;
      gl.GetIntegeri_v(q->name, i, &v);
      put(out, q->text, (int)i)->value[0] = v;
    }
  }
}

static void read_viewports(state_list *out) {
  for (GLuint i = 1; i < 4; i++) {
    GLfloat v[4];
    GLint box[4];
    GLdouble range[2];
    gl.GetFloati_v(GL_VIEWPORT, i, v);
    gl.GetIntegeri_v(GL_SCISSOR_BOX, i, box);
    gl.GetDoublei_v(GL_DEPTH_RANGE, i, range);
    state_entry *a = put(out, "VIEWPORT", (int)i), *b = put(out, "SCISSOR_BOX", (int)i),
                *c = put(out, "DEPTH_RANGE", (int)i);
    for (int k = 0; k < 4; k++) a->value[k] = v[k], b->value[k] = box[k];
    c->value[0] = range[0], c->value[1] = range[1];
    put(out, "SCISSOR_TEST", (int)i)->value[0] = gl.IsEnabledi(GL_SCISSOR_TEST, i);
  }
}

void state_read(state_list *out) {
  int version = gl_version();
  out->count = 0;
  read_plain(out, version);
  read_units(out, version);
  read_indexed(out, version);
  if (version >= 41) read_viewports(out);
}

static int excepted(const char *name, const char *const *except) {
  for (; except && *except; except++) {
    if (strcmp(name, *except) == 0) return 1;
  }
  return 0;
}

int state_differences(const char *when, const state_list *before, const state_list *after, const state_list *allowed,
                      const char *const *except) {
  int count = before->count != after->count;
  for (int i = 0; i < before->count && i < after->count; i++) {
    const state_entry *a = &before->entries[i], *b = &after->entries[i];
    if (memcmp(a->value, b->value, sizeof a->value) == 0 || excepted(a->name, except)) continue;
    if (allowed && memcmp(allowed->entries[i].value, b->value, sizeof b->value) == 0) continue;
    if (count++ < 10) {
      fprintf(stderr, "%s: %s was %g %g %g %g, is %g %g %g %g\n", when, a->name, a->value[0], a->value[1], a->value[2],
              a->value[3], b->value[0], b->value[1], b->value[2], b->value[3]);
    }
  }
  return count;
}
