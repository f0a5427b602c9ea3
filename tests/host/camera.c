#include "camera.h"

#include <math.h>
#include <string.h>

#include "gl.h"

const double camera_fov_tangent = 0.44;
static const double near_plane = 0.5, far_plane = 30;

/* The baseline's frustum, or the part of it that covers the given rectangle of its pixels. */
static mat4 perspective_part(double x0, double y0, double x1, double y1) {
  double top = near_plane * camera_fov_tangent, right = top * CAMERA_WIDTH / CAMERA_HEIGHT;
  return frustum(right * (2 * x0 / CAMERA_WIDTH - 1), right * (2 * x1 / CAMERA_WIDTH - 1),
                 top * (2 * y0 / CAMERA_HEIGHT - 1), top * (2 * y1 / CAMERA_HEIGHT - 1), near_plane, far_plane);
}

static mat4 perspective(void) { return perspective_part(0, 0, CAMERA_WIDTH, CAMERA_HEIGHT); }

static void set_projection(camera *self, mat4 m) { to_float(&m, self->projection); }

/* z' = (z + w) / 2 maps -1..1 to 0..1, z' = (w - z) / 2 the other way round. */
static mat4 zero_to_one(mat4 m, int reversed) {
  for (int column = 0; column < 4; column++) {
    double z = m.m[4 * column + 2], w = m.m[4 * column + 3];
    m.m[4 * column + 2] = reversed ? (w - z) / 2 : (w + z) / 2;
  }
  return m;
}

static mat4 infinite_reversed(mat4 m) {
  m.m[2] = m.m[6] = m.m[10] = 0;
  m.m[14] = near_plane;
  return m;
}

static mat4 negative_depth(mat4 m) {
  for (int column = 0; column < 4; column++) m.m[4 * column + 2] = -m.m[4 * column + 2];
  return m;
}

camera camera_sized(int index, int width, int height) {
  camera out = camera_at(index);
  out.width = out.target_width = width;
  out.height = out.target_height = height;
  return out;
}

camera camera_from(vec3 eye, vec3 target) {
  camera out = {.name = "perspective-d32f", .format = GL_DEPTH_COMPONENT32F, .same_rays = 1};
  out.width = out.target_width = CAMERA_WIDTH;
  out.height = out.target_height = CAMERA_HEIGHT;
  mat4 view = look_at(eye, target, v3(0, 1, 0));
  to_float(&view, out.view);
  set_projection(&out, perspective());
  return out;
}

static void set_format(camera *self, const char *name, unsigned format) {
  self->name = name;
  self->format = format;
}

static void set_reversed(camera *self, const char *name, mat4 projection) {
  self->name = name;
  self->zero_to_one = self->reversed = 1;
  set_projection(self, projection);
}

static void set_samples(camera *self, const char *name, unsigned format, int samples, int renderbuffer) {
  set_format(self, name, format);
  self->samples = samples;
  self->renderbuffer = renderbuffer;
  self->same_rays = samples == 0;
}

static void set_off_centre(camera *self, const char *name, int x, int y, int width, int height) {
  self->name = name;
  self->crop_x = x, self->crop_y = y;
  self->width = self->target_width = width;
  self->height = self->target_height = height;
  set_projection(self, perspective_part(x, y, x + width, y + height));
}

static void set_other_rays(camera *self, const char *name, mat4 projection) {
  self->name = name;
  self->same_rays = 0;
  set_projection(self, projection);
}

/* The right half of a picture of two players, with a border below. */
static void set_split_screen(camera *self) {
  self->name = "split-screen";
  self->target_width = 2 * CAMERA_WIDTH + 8;
  self->target_height = CAMERA_HEIGHT + 24;
  self->x = CAMERA_WIDTH + 8, self->y = 16;
}

camera camera_at(int index) {
  camera out = camera_from(v3(0.4, 2.7, 5.2), v3(0, 0.6, 0));
  mat4 base = perspective();
  switch (index) {
  case 1: set_format(&out, "perspective-d24", GL_DEPTH_COMPONENT24); break;
  case 2: set_format(&out, "perspective-d24s8", GL_DEPTH24_STENCIL8); break;
  case 3: set_format(&out, "perspective-d32fs8", GL_DEPTH32F_STENCIL8); break;
  case 4: set_format(&out, "perspective-d16", GL_DEPTH_COMPONENT16); break;
  case 5: set_reversed(&out, "reversed-d32f", zero_to_one(base, 1)); break;
  case 6: set_reversed(&out, "reversed-infinite-d32f", infinite_reversed(base)); break;
  case 7:
    out.name = "zero-to-one-d32f";
    out.zero_to_one = 1;
    set_projection(&out, zero_to_one(base, 0));
    break;
  case 8:
    set_format(&out, "reversed-without-clip-control-d24", GL_DEPTH_COMPONENT24);
    out.reversed = 1;
    set_projection(&out, negative_depth(base));
    break;
  case 9: set_other_rays(&out, "orthographic", orthographic(-2.8, 2.8, -2.1, 2.1, near_plane, 12)); break;
  case 10: set_off_centre(&out, "off-centre", 96, 64, 160, 120); break;
  /* A third of a pixel to the right and a quarter down, as temporal antialiasing does it. */
  case 11:
    set_other_rays(&out, "jittered", perspective_part(0.33, -0.25, CAMERA_WIDTH + 0.33, CAMERA_HEIGHT - 0.25));
    break;
  case 12: set_samples(&out, "multisample-texture", GL_DEPTH_COMPONENT32F, 4, 0); break;
  case 13: set_samples(&out, "renderbuffer-d24", GL_DEPTH_COMPONENT24, 0, 1); break;
  case 14: set_samples(&out, "renderbuffer-d24s8", GL_DEPTH24_STENCIL8, 0, 1); break;
  case 15: set_samples(&out, "multisample-renderbuffer", GL_DEPTH_COMPONENT24, 4, 1); break;
  case 16: set_split_screen(&out); break;
  default: break;
  }
  return out;
}

mat4 camera_clip(const camera *self) {
  mat4 view = from_float(self->view), projection = from_float(self->projection);
  return multiply(&projection, &view);
}

/* Depth in the buffer at eye distance z along the view axis. */
static double depth_at(const camera *self, double z) {
  const float *p = self->projection;
  double clip_z = p[14] - p[10] * z, clip_w = p[15] - p[11] * z, ndc = clip_z / clip_w;
  return self->zero_to_one ? ndc : (ndc + 1) / 2;
}

static double eye_distance(const camera *self, double d) {
  const float *p = self->projection;
  double ndc = self->zero_to_one ? d : 2 * d - 1;
  return (p[14] - ndc * p[15]) / (p[10] - ndc * p[11]);
}

/* Interpolation computes with numbers near 1, unless reversed depth brings them near 0: eight units in the last place.
 * */
static double quantum(const camera *self, double d) {
  double interpolation = 8 * ldexp(self->zero_to_one ? fmax(fabs(d), 1e-4) : 1, -24);
  switch (self->format) {
  case GL_DEPTH_COMPONENT16: return 1.0 / 65535 + interpolation;
  case GL_DEPTH_COMPONENT24:
  case GL_DEPTH24_STENCIL8: return 1.0 / 16777215 + interpolation;
  default: return interpolation;
  }
}

double camera_depth_error(const camera *self, double d) {
  double z = eye_distance(self, d), step = 1e-4 * z;
  double slope = fabs(depth_at(self, z + step) - depth_at(self, z - step)) / (2 * step);
  double clip_w = self->projection[15] - self->projection[11] * z;
  double pixel = 2 * clip_w / (fabs(self->projection[5]) * self->height);
  return 0.5 * quantum(self, d) / slope / pixel;
}
