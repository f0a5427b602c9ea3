/* Penumbra extents without reading anything back (Soft Shadow Maps, section 4.3): micropatches are counted in a
 * pyramid, listed from the counts, and drawn as many as there are. */
#include "techniques/ssm/ssm.h"

typedef enum { PASS_FIRST, PASS_LEVEL, PASS_LIST, PASS_ARGUMENTS } pass_kind;

static pn_result pass_program(pni_gpu *gpu, pass_kind kind, bool tiles, const pni_program **out) {
  static const char *const fragments[] = {"techniques/ssm/nodes.frag.glsl", "techniques/ssm/nodes.frag.glsl",
                                          "techniques/ssm/list.frag.glsl", "techniques/ssm/arguments.frag.glsl"};
  static const char *const defines[][2] = {{"PN_FIRST 1\nPN_TILES 0\n", "PN_FIRST 1\nPN_TILES 1\n"},
                                           {"PN_FIRST 0\nPN_TILES 0\n", "PN_FIRST 0\nPN_TILES 1\n"},
                                           {"PN_TILES 0\n", "PN_TILES 1\n"},
                                           {"", ""}};
  const char *vertex = kind == PASS_LIST ? "techniques/ssm/list.vert.glsl" : "shaders/screen.vert.glsl";
  pni_program_key key = {vertex, fragments[kind], NULL, defines[kind][tiles]};
  return pni_program_get(gpu, &key, out);
}

static bool has_tiles(const ssm_list *list) { return list->request->maps->fit.tiles > 1; }

pn_result ssm_gpu_prepare(pni_gpu *gpu) {
  const pni_program *program;
  pn_result result = PN_OK;
  for (int kind = PASS_FIRST; kind <= PASS_ARGUMENTS && result == PN_OK; kind++)
    result = pass_program(gpu, (pass_kind)kind, false, &program);
  return result;
}

/* ---- shapes ------------------------------------------------------------------------------------------------------ */

static size_t least(size_t a, size_t b) { return a < b ? a : b; }

int ssm_list_most(const pni_maps *maps) {
  size_t texels = (size_t)maps->depth.width * (size_t)maps->depth.height;
  return (int)(texels + texels / 3 + 1); /* every node of the pyramid */
}

int ssm_list_size(const pni_maps *maps) { return (int)least((size_t)ssm_list_most(maps), SSM_LIST_MOST); }

pn_result ssm_gpu_shape(const pni_visibility_request *r) {
  pni_texture *work = r->pair->work;
  const pni_texture *range = &r->maps->range;
  int size = ssm_list_size(r->maps), width = (int)least((size_t)size, SSM_LIST_WIDTH);
  int height = (size + width - 1) / width;
  pn_result result =
      pni_texture_shape(r->gpu, &work[SSM_COUNTS], GL_R32UI, range->width, range->height, 0, range->levels);
  for (int i = SSM_LIST; i <= SSM_LIMITS && result == PN_OK; i++)
    result = pni_texture_shape(r->gpu, &work[i], GL_RGBA32F, width, height, 0, 1);
  return result == PN_OK ? pni_texture_shape(r->gpu, &work[SSM_ARGUMENTS], GL_RGBA32UI, SSM_DRAWS, 1, 0, 1) : result;
}

/* ---- passes ------------------------------------------------------------------------------------------------------ */

/* What node.glsl reads. */
static void bind_nodes(const ssm_list *list, const pni_program *program, int level) {
  const pni_visibility_request *r = list->request;
  pni_gpu *gpu = r->gpu;
  const pni_receiver_map *seen = &r->pair->seen;
  GLint source[4] = {list->map * r->maps->layers + list->layer, level, list->seen_layer, list->map};
  GLint levels[4] = {r->maps->range.levels, seen->range.levels, seen->want.width, seen->want.height};
  GLfloat share[4] = {(float)list->share};
  GL(gpu, Uniform4iv)(pni_uniform(program, "pn_source"), 1, source);
  GL(gpu, Uniform4iv)(pni_uniform(program, "pn_levels"), 1, levels);
  GL(gpu, Uniform4fv)(pni_uniform(program, "pn_share"), 1, share);
  pni_bind_texture(gpu, PNI_UNIT_RANGE, r->maps->range.target, r->maps->range.id, true);
  pni_receiver_map_bind(gpu, seen, program);
}

/* Levels of the counts that a pass may read: never the one it draws. */
static void bind_counts(pni_gpu *gpu, const pni_texture *counts, int low, int high) {
  pni_bind_texture(gpu, PNI_UNIT_WORK, counts->target, counts->id, true);
  GL(gpu, TexParameteri)(counts->target, GL_TEXTURE_BASE_LEVEL, low);
  GL(gpu, TexParameteri)(counts->target, GL_TEXTURE_MAX_LEVEL, high);
}

static int shifted(int size, int level) { return size >> level > 1 ? size >> level : 1; }

static pn_result count_level(const ssm_list *list, int level) {
  pni_gpu *gpu = list->request->gpu;
  const pni_texture *counts = &list->request->pair->work[SSM_COUNTS];
  const pni_program *program;
  pn_result result = pass_program(gpu, level ? PASS_LEVEL : PASS_FIRST, has_tiles(list), &program);
  if (result != PN_OK) return result;
  pni_pass pass = {.color = {{counts->id, counts->target, level, 0}},
                   .width = shifted(counts->width, level),
                   .height = shifted(counts->height, level)};
  result = pni_screen_begin(gpu, &pass, program);
  if (result != PN_OK) return result;
  static const GLuint nothing[4] = {0, 0, 0, 0};
  GL(gpu, ClearBufferuiv)(GL_COLOR, 0, nothing);
  bind_nodes(list, program, level);
  if (level) bind_counts(gpu, counts, level - 1, level - 1);
  pni_draw_screen(gpu);
  return PN_OK;
}

pn_result ssm_gpu_count(const ssm_list *list) {
  const pni_texture *counts = &list->request->pair->work[SSM_COUNTS];
  pn_result result = PN_OK;
  for (int level = 0; level < counts->levels && result == PN_OK; level++) result = count_level(list, level);
  bind_counts(list->request->gpu, counts, 0, counts->levels - 1);
  return result;
}

static pn_result draw_list(const ssm_list *list) {
  const pni_visibility_request *r = list->request;
  const pni_texture *entries = &r->pair->work[SSM_LIST], *limits = &r->pair->work[SSM_LIMITS];
  const pni_program *program;
  pn_result result = pass_program(r->gpu, PASS_LIST, has_tiles(list), &program);
  if (result != PN_OK) return result;
  pni_pass pass = {.color = {{entries->id, entries->target, 0, 0}, {limits->id, limits->target, 0, 0}},
                   .width = entries->width,
                   .height = entries->height};
  result = pni_screen_begin(r->gpu, &pass, program);
  if (result != PN_OK) return result;
  GLint place[4] = {list->first, entries->width, entries->height, 0};
  GL(r->gpu, Uniform4iv)(pni_uniform(program, "pn_place"), 1, place);
  bind_nodes(list, program, 0);
  bind_counts(r->gpu, &r->pair->work[SSM_COUNTS], 0, r->pair->work[SSM_COUNTS].levels - 1);
  pni_draw_counted(r->gpu, &r->pair->arguments, SSM_DRAW_ROWS, 6 * entries->height);
  return PN_OK;
}

static pn_result draw_arguments(const ssm_list *list) {
  const pni_visibility_request *r = list->request;
  const pni_texture *arguments = &r->pair->work[SSM_ARGUMENTS], *counts = &r->pair->work[SSM_COUNTS];
  const pni_program *program;
  pn_result result = pass_program(r->gpu, PASS_ARGUMENTS, false, &program);
  if (result != PN_OK) return result;
  pni_pass pass = {.color = {{arguments->id, arguments->target, 0, 0}}, .width = SSM_DRAWS, .height = 1};
  result = pni_screen_begin(r->gpu, &pass, program);
  if (result != PN_OK) return result;
  GLint place[4] = {list->first, ssm_list_size(r->maps), counts->levels - 1, r->pair->work[SSM_LIST].width};
  GL(r->gpu, Uniform4iv)(pni_uniform(program, "pn_place"), 1, place);
  bind_counts(r->gpu, counts, 0, counts->levels - 1);
  pni_draw_screen(r->gpu);
  return pni_counts_take(r->gpu, arguments, &r->pair->arguments);
}

pn_result ssm_gpu_list(const ssm_list *list) {
  pn_result result = draw_arguments(list);
  return result == PN_OK ? draw_list(list) : result;
}

pn_result ssm_gpu_total(const ssm_list *list, int *out) {
  pni_gpu *gpu = list->request->gpu;
  const pni_texture *counts = &list->request->pair->work[SSM_COUNTS];
  GLuint top[4] = {0};
  pni_read_from(gpu, counts, counts->levels - 1, 0);
  GL(gpu, BindBuffer)(GL_PIXEL_PACK_BUFFER, 0);
  GL(gpu, ReadPixels)(0, 0, 1, 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT, top);
  *out = (int)(top[0] & 0x7fffffffu); /* the highest bit: whether the top node is one itself */
  return PN_OK;
}
