/* client.h: the program as the library's client: one pn_context with the scene's casters and the camera's receiver.
 * Everything goes through the public header; what the library logs becomes the program's own lines. */
#ifndef PENUMBRA_APP_HOST_CLIENT_H
#define PENUMBRA_APP_HOST_CLIENT_H

#include "host/gbuffer.h"

struct client {
  pn_context *context;
  pn_casters *casters;
  pn_receiver *receiver;
  pn_receiver_desc view; /* the receiver's */
  double origin[3];      /* the scene's: the library's scene space begins there */
  int width, height;
  char reason[400]; /* the library's latest error */
  int warming;      /* nonzero: warnings are not passed on, the real frame will repeat them */
};

/* gpu and gbuffer must outlive the client. Exit status. */
int client_create(const struct gpu_scene *gpu, const struct gbuffer *gbuffer, pn_state_mode mode, struct client **out);
void client_free(struct client **client); /* and its lights */

/* A light of the set-up's map and fit, with a technique whose programs the driver has compiled. spec NULL: the
 * library's default. light: the scene's own, or another. */
int client_light(struct client *client, const struct setup *setup, const struct light *light, const char *spec,
                 pn_light **out);

/* The maps of one frame, without visibility; and the bytes of what summarises them, 0 where nothing does. */
int client_maps(struct client *client, pn_light *light);
long long client_range_bytes(struct client *client, pn_light *light);
/* Maps and visibility of one frame. */
int client_frame(struct client *client, pn_light *light);

/* The light's last visibility, one float a pixel, top row first. */
int client_visibility(struct client *client, pn_light *light, float *out);

/* What the light's technique did on the way, for the view of its last frame: one more frame is drawn for it. */
struct insides {
  float *levels; /* two floats a pixel, where there is search: coarsest level of primitives, of ranges */
  float *search; /* four floats a pixel (see pn_debug), top row first; NULL: the technique does not search */
  float *bound;  /* of the error, one float a pixel, top row first; NULL: the technique has none */
  float *soft;   /* the soft shadow map: for each layer of receivers what is hidden, top row first; NULL: none */
  int soft_width, soft_height, soft_layers;
  double covered; /* texels that micropatches covered, in all; 0: the technique does not scatter */
};
int client_insides(struct client *client, pn_light *light, int debug_flags, struct insides *out);
void insides_free(struct insides *insides);

/* Turns a library result into the program's line and exit status; PN_OK is STATUS_OK. */
int client_check(struct client *client, pn_result result);

#endif
