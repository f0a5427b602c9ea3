/* label.h: names of scenes and techniques as parts of file names. */
#ifndef PENUMBRA_APP_FILES_LABEL_H
#define PENUMBRA_APP_FILES_LABEL_H

/* Every character outside [A-Za-z0-9._=-] becomes '-', as the contract says of --save-dir. malloc'ed; NULL: out of
 * memory. */
char *file_label(const char *text);

/* "bunny", "builtin:boxes" and "pcss:samples=16" make "bunny-pcss-samples=16.png", "boxes-pcss-samples=16.png".
 * malloc'ed; NULL: out of memory. */
char *picture_name(const char *scene, const char *technique, const char *ending);

#endif
