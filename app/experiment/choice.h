/* choice.h: which techniques an experiment is about. */
#ifndef PENUMBRA_APP_EXPERIMENT_CHOICE_H
#define PENUMBRA_APP_EXPERIMENT_CHOICE_H

/* The specs that were given; where none were, the names of all techniques but `average`. The array is malloc'ed, the
 * strings are the caller's or the library's. NULL: out of memory, and one line was printed. */
const char **technique_choice(const char *const *given, int given_count, int *count);

#endif
