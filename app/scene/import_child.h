/* import_child.h: what the import's own process does. */
#ifndef PENUMBRA_APP_SCENE_IMPORT_CHILD_H
#define PENUMBRA_APP_SCENE_IMPORT_CHILD_H

/* Imports path and writes its records to fd. Returns when everything or one error was sent; where memory ran out or
 * nobody reads, ends the process. */
void import_child(const char *path, int up_is_z, int fd);

#endif
