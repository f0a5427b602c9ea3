/* import_files.h: the files that an import may read: regular ones, so that none of them waits for ever. */
#ifndef PENUMBRA_APP_SCENE_IMPORT_FILES_H
#define PENUMBRA_APP_SCENE_IMPORT_FILES_H

#include <assimp/cfileio.h>
#include <stddef.h>

#include "scene/import_send.h"

/* The whole of a regular file, malloc'ed, with a zero after its end; NULL and errno where it cannot be read. One that
 * is there but no regular file is refused (import_send.h). */
void *read_file(const struct importer *importer, const char *path, size_t *size);

/* Only the beginning: at most room bytes and a zero. Returns how many there were. */
size_t read_head(const struct importer *importer, const char *path, char *out, size_t room);

/* The same as read_file for a file named in the model: relative to the model's folder, as written, then decoded as a
 * URI. */
void *read_beside(const struct importer *importer, const char *name, size_t *size);

/* "%20" becomes a space, and "\" a slash. In place. */
void decode_uri(char *text);

/* How Assimp reads files: the same rules. A byte-order mark is passed over, and a text that is an STL in capitals is
 * given in small letters, which is how Assimp wants it. */
struct aiFileIO import_files(struct importer *importer);

/* The name of a material library that is not there, or "". */
const char *import_files_missing(void);

#endif
