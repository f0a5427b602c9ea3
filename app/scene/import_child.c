#include "scene/import_child.h"

#include <stdio.h>
#include <string.h>

#include "scene/gltf.h"
#include "scene/import_assimp.h"
#include "scene/import_send.h"

/* "dropped 3 triangles without area, ...": everything that was left out, or "". */
static void describe_dropped(const struct importer *importer, char *text, size_t size) {
  const struct {
    uint64_t count;
    const char *one, *many;
  } rows[] = {
      {importer->dropped_nan, "triangle with a coordinate that is not finite",
       "triangles with coordinates that are not finite"},
      {importer->dropped_far, "triangle with a coordinate beyond 1e15", "triangles with coordinates beyond 1e15"},
      {importer->dropped_area, "triangle without area", "triangles without area"},
      {importer->dropped_index, "triangle with a corner that does not exist",
       "triangles with corners that do not exist"},
      {importer->dropped_instances, "mesh placed with an unusable transform",
       "meshes placed with unusable transforms"}};
  *text = 0;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    if (!rows[i].count) continue;
    size_t length = strlen(text);
    snprintf(text + length, size - length, "%s%llu %s", length ? ", " : "dropped ", (unsigned long long)rows[i].count,
             rows[i].count == 1 ? rows[i].one : rows[i].many);
  }
}

/* Everything about materials that shadows cannot show, in one line. */
static void warn_about_opacity(const struct importer *importer) {
  char transparent[160] = "";
  int count = importer->transparent_count;
  if (count == 1)
    snprintf(transparent, sizeof transparent, "material '%s' is transparent: its mesh casts nothing and is not drawn",
             importer->transparent);
  if (count > 1)
    snprintf(transparent, sizeof transparent,
             "material '%s' and others are transparent: %d meshes cast nothing and are not drawn",
             importer->transparent, count);
  if (count || importer->blended)
    send_warning(importer, "%s%s%s", transparent, count && importer->blended ? "; " : "",
                 importer->blended ? "opacity between one half and one counts as one, less as none" : "");
}

void import_child(const char *path, int up_is_z, int fd) {
  struct importer importer = {.fd = fd, .path = path};
  if (!gltf_import(&importer, up_is_z)) import_through_assimp(&importer, up_is_z);
  char dropped[300];
  describe_dropped(&importer, dropped, sizeof dropped);
  if (importer.instance_count == 0 && importer.transparent_count && !*dropped)
    refuse(&importer, "holds no usable triangles: material '%s' is transparent", importer.transparent);
  if (importer.instance_count == 0)
    refuse(&importer, "holds no usable triangles%s%s", *dropped ? ": " : "; a model needs triangles or polygons",
           dropped);
  warn_about_opacity(&importer);
  if (*dropped) send_warning(&importer, "%s", dropped);
  struct record end = {.tag = RECORD_END};
  send_bytes(fd, &end, sizeof end);
}
