/* Names of results and messages. */
#include <penumbra/penumbra.h>

const char *pn_version(void) { return PN_VERSION_STRING; }

const char *pn_result_name(pn_result result) {
  switch (result) {
  case PN_OK: return "ok";
  case PN_ERROR_ARGUMENT: return "argument";
  case PN_ERROR_UNSUPPORTED: return "unsupported";
  case PN_ERROR_OUT_OF_MEMORY: return "out of memory";
  case PN_ERROR_SHADER: return "shader";
  case PN_ERROR_CONTEXT_LOST: return "context lost";
  case PN_ERROR_NOT_READY: return "not ready";
  }
  return "unknown";
}

const char *pn_message_name(int message_id) {
  static const char *const names[] = {
      [PN_MESSAGE_NONE] = "NONE",
      [PN_MESSAGE_GL_VERSION] = "GL_VERSION",
      [PN_MESSAGE_GL_FUNCTION] = "GL_FUNCTION",
      [PN_MESSAGE_GL_LOST] = "GL_LOST",
#define NAME(id) [PN_MESSAGE_##id] = #id
      NAME(NULL_ARGUMENT),
      NAME(OUT_OF_MEMORY),
      NAME(GPU_MEMORY),
      NAME(FRAMEBUFFER),
      NAME(SHADER_COMPILE),
      NAME(SHADER_LINK),
      NAME(SHADER_MISSING),
      NAME(SHADER_DIRECTORY),
      NAME(STATE_SCOPE),
      NAME(MESH_POSITIONS),
      NAME(MESH_INDICES),
      NAME(MESH_TEXCOORDS),
      NAME(MESH_ALPHA),
      NAME(MESH_BOUNDS),
      NAME(MESH_DROPPED),
      NAME(MESH_UNKNOWN),
      NAME(INSTANCE_UNKNOWN),
      NAME(INSTANCE_TRANSFORM),
      NAME(CASTER_GROUP),
      NAME(CASTER_BOUNDS),
      NAME(RECEIVER_SOURCE),
      NAME(RECEIVER_DEPTH),
      NAME(RECEIVER_VIEW),
      NAME(RECEIVER_MATRIX),
      NAME(RECEIVER_NORMAL),
      NAME(RECEIVER_MASK),
      NAME(RECEIVER_SCALE),
      NAME(RECEIVER_FORMAT),
      NAME(RECEIVER_UNSET),
      NAME(LIGHT_SHAPE),
      NAME(LIGHT_FRAME),
      NAME(LIGHT_SIZE),
      NAME(LIGHT_RANGE),
      NAME(LIGHT_TEXTURE),
      NAME(LIGHT_FIT),
      NAME(LIGHT_MAP),
      NAME(LIGHT_ANGLE),
      NAME(LIGHT_UNSET),
      NAME(MAPS_STALE),
      NAME(TECHNIQUE_UNKNOWN),
      NAME(PARAMETER_UNKNOWN),
      NAME(PARAMETER_VALUE),
      NAME(RESULT_TARGET),
      NAME(FORWARD),
      NAME(FALLBACK),
      NAME(ACCUMULATION),
      NAME(STATE_MODE),
      NAME(MESH_EDGES),
      NAME(CASTER_MESHES),
      NAME(DEBUG_FLAGS),
      NAME(RECEIVER_RANGE),
      NAME(RECEIVER_POSITION),
      NAME(SEARCH_COARSER),
#undef NAME
  };
  _Static_assert(sizeof names / sizeof *names == PN_MESSAGE_COUNT, "every message has a name");
  return message_id >= 0 && message_id < PN_MESSAGE_COUNT ? names[message_id] : NULL;
}
