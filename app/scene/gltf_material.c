#include "scene/gltf_material.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene/import_material.h"

static enum texture_wrap wrap_of(const cJSON *sampler, const char *name) {
  enum { CLAMP = 33071, MIRROR = 33648 };
  int value = gltf_index(sampler, name);
  return value == CLAMP ? WRAP_CLAMP : value == MIRROR ? WRAP_MIRROR : WRAP_REPEAT;
}

/* KHR_texture_transform, from texture coordinates with v upwards to such: 1 - v on both sides of what it says. */
static void find_transform(const cJSON *info, struct material_alpha *out) {
  const cJSON *extension = gltf_extension(info, "KHR_texture_transform");
  if (!extension) return;
  double offset[2] = {0, 0}, scale[2] = {1, 1}, angle = gltf_number(extension, "rotation", 0);
  gltf_numbers(extension, "offset", 2, offset);
  gltf_numbers(extension, "scale", 2, scale);
  double c = cos(angle), s = sin(angle);
  const double m[6] = {c * scale[0], s * scale[1], offset[0], -s * scale[0], c * scale[1], offset[1]};
  const double upwards[6] = {m[0], -m[1], m[2] + m[1], -m[3], m[4], 1 - m[5] - m[4]};
  memcpy(out->transform, upwards, sizeof upwards);
  int channel = gltf_index(extension, "texCoord");
  if (channel >= 0) out->uv_channel = channel;
}

/* 0: no picture that could be read, which is said. */
static int find_picture(struct gltf *g, const cJSON *info, struct alpha_source *source) {
  static const char *const others[] = {"KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif",
                                       "MSFT_texture_dds"};
  const cJSON *texture = gltf_item(g, GLTF_TEXTURES, gltf_index(info, "index"));
  int image_index = gltf_index(texture, "source");
  for (size_t i = 0; image_index < 0 && i < sizeof others / sizeof *others; i++)
    if (gltf_extension(texture, others[i])) {
      send_warning(g->importer, "texture %d: %s is not read; its material is drawn opaque", gltf_index(info, "index"),
                   others[i]);
      return 0;
    }
  if (image_index < 0) return 0;
  const cJSON *image = gltf_item(g, GLTF_IMAGES, image_index);
  int sampler = gltf_index(texture, "sampler");
  const cJSON *wrap = sampler >= 0 ? gltf_item(g, GLTF_SAMPLERS, sampler) : NULL;
  source->wrap[0] = wrap_of(wrap, "wrapS");
  source->wrap[1] = wrap_of(wrap, "wrapT");
  const char *uri = gltf_string(image, "uri");
  struct gltf_bytes bytes = {0};
  if (uri && strncmp(uri, "data:", 5) != 0) {
    snprintf(source->name, sizeof source->name, "%s", uri);
    return 1;
  }
  snprintf(source->name, sizeof source->name, "%d", image_index);
  if (uri && !g->images[image_index].bytes) gltf_uri(g, uri, &g->images[image_index]);
  if (uri) bytes = g->images[image_index];
  else bytes = gltf_view(g, gltf_index(image, "bufferView"), NULL);
  source->bytes = bytes.bytes;
  source->size = bytes.size;
  return 1;
}

int gltf_has_alpha(struct gltf *g, int index) {
  const char *mode = index < 0 ? NULL : gltf_string(gltf_item(g, GLTF_MATERIALS, index), "alphaMode");
  return mode && (strcmp(mode, "MASK") == 0 || strcmp(mode, "BLEND") == 0);
}

/* Light passes through glass, which neither the maps nor the reference know. */
static void look_at_glass(struct gltf *g, const cJSON *material) {
  const cJSON *glass = gltf_extension(material, "KHR_materials_transmission");
  if (gltf_number(glass, "transmissionFactor", 0) > 0)
    send_warning(g->importer, "KHR_materials_transmission is left out: its material casts as if it were opaque");
}

struct material_alpha gltf_alpha(struct gltf *g, int index) {
  struct material_alpha out = MATERIAL_OPAQUE;
  struct alpha_source source = {.factor = 1, .cutoff = 0.5f};
  if (index < 0) return out;
  const cJSON *material = gltf_item(g, GLTF_MATERIALS, index);
  look_at_glass(g, material);
  if (!gltf_has_alpha(g, index)) return out;
  const cJSON *base = gltf_member(material, "pbrMetallicRoughness");
  const cJSON *older = gltf_extension(material, "KHR_materials_pbrSpecularGlossiness");
  double colour[4] = {1, 1, 1, 1};
  gltf_numbers(older ? older : base, older ? "diffuseFactor" : "baseColorFactor", 4, colour);
  const cJSON *info = gltf_member(older ? older : base, older ? "diffuseTexture" : "baseColorTexture");
  int blend = strcmp(gltf_string(material, "alphaMode"), "BLEND") == 0;
  if (!blend) source.cutoff = (float)gltf_number(material, "alphaCutoff", 0.5);
  if (isfinite(colour[3])) source.factor = (float)fmin(colour[3], 1);
  out.uv_channel = gltf_index(info, "texCoord") > 0 ? gltf_index(info, "texCoord") : 0;
  find_transform(info, &out);
  int visible = source.factor >= source.cutoff;
  out.blended = blend && visible && (info || source.factor < 1);
  int textured = info && visible && find_picture(g, info, &source);
  const char *name = gltf_string(material, "name");
  char number[16];
  snprintf(number, sizeof number, "%d", index);
  send_alpha_of(g->importer, &source, textured, name ? name : number, &out);
  return out;
}
