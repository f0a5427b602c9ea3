/* buffers.h: an experiment's raw buffers in the folder of --save-dir, under the contract's names. */
#ifndef PENUMBRA_APP_EXPERIMENT_BUFFERS_H
#define PENUMBRA_APP_EXPERIMENT_BUFFERS_H

#include "files/save.h"
#include "host/client.h"
#include "host/view.h"

/* What is saved of a technique's insides, and what the files are called: "NN-LABEL.ssm.exr". */
enum inside { INSIDE_SEARCH, INSIDE_SOFT, INSIDE_BOUND, INSIDE_COUNT };
extern const char *const inside_kinds[INSIDE_COUNT];

/* position.exr, normal.exr and mask.exr. Exit status, like all of them. */
int save_view(const struct save *save, const struct view *view);

/* The technique with this index: its visibility, and those of its insides that are there. */
int save_technique(const struct save *save, int index, const char *spec, const float *visibility,
                   const struct insides *insides);

#endif
