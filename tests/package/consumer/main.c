/* Uses the library without a GL context: the version, and a frame whose axes are known. */
#include <penumbra/penumbra.h>
#include <stdio.h>
#include <string.h>

int main(void) {
  if (strcmp(pn_version(), PN_VERSION_STRING) != 0) {
    fprintf(stderr, "the library is %s, its header %s\n", pn_version(), PN_VERSION_STRING);
    return 1;
  }
  /* Shining along -z with y up: u = direction x up = (1, 0, 0). */
  const float direction[3] = {0, 0, -2}, up[3] = {0, 1, 0};
  float u[3] = {0, 0, 0};
  if (pn_light_frame(direction, up, NULL, u, NULL) != PN_OK || u[0] != 1 || u[1] != 0 || u[2] != 0) {
    fprintf(stderr, "pn_light_frame: u = %g %g %g\n", (double)u[0], (double)u[1], (double)u[2]);
    return 1;
  }
  printf("%s\n", pn_version());
  return 0;
}
