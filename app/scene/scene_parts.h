/* scene_parts.h: between the files that make a scene: importer, built-ins, ground, set-up. */
#ifndef PENUMBRA_APP_SCENE_PARTS_H
#define PENUMBRA_APP_SCENE_PARTS_H

#include "scene/scene.h"

struct scene *scene_new(const char *name); /* NULL: out of memory, nothing printed */
void mesh_free(struct mesh *mesh);
int scene_add_texture(struct scene *scene, const struct texture *texture); /* takes alpha over; -1: out of memory */

/* Bounds in scene space. */
void instance_bounds(const struct scene *scene, const struct instance *instance, double low[3], double high[3]);

/* Computes bounds and triangle_count anew. */
void scene_measure(struct scene *scene);

/* builtin:NAME without its prefix, with floor and its own light and camera. */
int builtin_build(const char *name, struct scene **out);

/* The contract's standard light and camera from B and H, and default sizes. */
void setup_standard(struct scene *scene);

/* A plane at the lowest point, 5 H wide, around B; it only receives. Exit status. */
int ground_add(struct scene *scene);

#endif
