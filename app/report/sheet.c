#include <cairo.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "report/picture.h"
#include "report/report.h"

/* A grid of cells: truth with the legend, then each technique with its error map.
 *
 *     +---------+ +---------+        a cell: lines of text,
 *     | truth   | | hard    |        the picture,
 *     | legend  | | errors  | ...    the error map (truth: the legend)
 *     +---------+ +---------+
 */
enum {
  MARGIN = 24,    /* around the sheet */
  GAP = 24,       /* between cells */
  HEAD = 86,      /* the sheet's title and two lines */
  CELL_HEAD = 95, /* label and numbers */
  BETWEEN = 8,    /* picture and error map */
  TILE_MAX = 640, /* pictures wider or taller than this are shrunk */
  TILE_MIN = 160,
  CELL_LEAST = 540, /* what the text needs */
  LEGEND = 320,     /* what the legend needs */
  SIDE_MAX = 30000  /* of the sheet; cairo's own limit is 32767 */
};
#define PIXELS_MAX 100e6
#define ASPECT 1.4 /* width to height that the grid aims at */

struct layout {
  int tile[2]; /* picture */
  int cell[2];
  int columns, rows;
  int size[2];
};

/* ---- layout ------------------------------------------------------------------------------------------------------ */

static void lay_out(struct layout *layout, const int picture[2], int tile_max, int columns, int cells) {
  double shrink = fmax(1, fmax((double)picture[0] / tile_max, (double)picture[1] / tile_max));
  for (int i = 0; i < 2; i++) layout->tile[i] = (int)fmax(1, floor(picture[i] / shrink + 0.5));
  layout->cell[0] = layout->tile[0] > CELL_LEAST ? layout->tile[0] : CELL_LEAST;
  layout->cell[1] = CELL_HEAD + layout->tile[1] + BETWEEN + (layout->tile[1] > LEGEND ? layout->tile[1] : LEGEND);
  layout->columns = columns;
  layout->rows = (cells + columns - 1) / columns;
  layout->size[0] = 2 * MARGIN + columns * layout->cell[0] + (columns - 1) * GAP;
  layout->size[1] = 2 * MARGIN + HEAD + layout->rows * layout->cell[1] + (layout->rows - 1) * GAP;
}

static int fits(const struct layout *layout) {
  return layout->size[0] <= SIDE_MAX && layout->size[1] <= SIDE_MAX &&
         (double)layout->size[0] * layout->size[1] <= PIXELS_MAX;
}

/* The number of columns nearest to ASPECT with few empty cells; tiles shrink when even that is too large. Returns 0
 * when nothing fits. */
static int choose_layout(struct layout *best, const struct report *report) {
  int picture[2] = {report->width, report->height}, cells = report->technique_count + 1;
  for (int tile_max = TILE_MAX; tile_max >= TILE_MIN; tile_max /= 2) {
    double distance = INFINITY;
    for (int columns = 1; columns <= cells && columns <= 200; columns++) {
      struct layout layout;
      lay_out(&layout, picture, tile_max, columns, cells);
      double empty = (double)(layout.rows * columns - cells) / cells;
      double off = fabs(log((double)layout.size[0] / layout.size[1] / ASPECT)) + 0.5 * empty;
      if (fits(&layout) && off < distance) {
        distance = off;
        *best = layout;
      }
    }
    if (isfinite(distance)) return 1;
  }
  return 0;
}

/* ---- text -------------------------------------------------------------------------------------------------------- */

struct pen {
  cairo_t *cairo;
  cairo_surface_t *surface;
};

static void colour(struct pen *pen, const uint8_t rgb[3]) {
  cairo_set_source_rgb(pen->cairo, rgb[0] / 255.0, rgb[1] / 255.0, rgb[2] / 255.0);
}

static double text_width(struct pen *pen, const char *text) {
  cairo_text_extents_t extents;
  cairo_text_extents(pen->cairo, text, &extents);
  return extents.x_advance;
}

/* Cuts whole UTF-8 characters off the end until text and an ellipsis fit. */
static void shorten(struct pen *pen, char *text, double width) {
  size_t length = strlen(text);
  while (length > 0 && text_width(pen, text) > width) {
    do length--;
    while (length > 0 && ((unsigned char)text[length] & 0xc0) == 0x80);
    strcpy(text + length, "\xe2\x80\xa6");
  }
}

/* Text comes from file names too: what is no UTF-8 or no character would put cairo into an error state. */
static void make_printable(char *text) {
  for (unsigned char *c = (unsigned char *)text; *c;) {
    int more = *c < 0x80                 ? 0
               : *c >= 0xc2 && *c < 0xe0 ? 1
               : *c >= 0xe0 && *c < 0xf0 ? 2
               : *c >= 0xf0 && *c < 0xf5 ? 3
                                         : -1,
        good = more >= 0 && *c >= 0x20 && *c != 0x7f;
    for (int i = 1; good && i <= more; i++) good = (c[i] & 0xc0) == 0x80;
    if (good && ((*c == 0xe0 && c[1] < 0xa0) || (*c == 0xed && c[1] > 0x9f) || (*c == 0xf0 && c[1] < 0x90) ||
                 (*c == 0xf4 && c[1] > 0x8f)))
      good = 0; /* overlong, surrogate, beyond Unicode */
    if (good) c += more + 1;
    else *c++ = '?';
  }
}

/* One line with its baseline at y, at most width wide: a little smaller if need be, then cut. */
static void write_line(struct pen *pen, double x, double y, double width, double size, int bold, const char *format,
                       ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text - 4, format, arguments);
  va_end(arguments);
  make_printable(text);
  cairo_select_font_face(pen->cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(pen->cairo, size);
  double actual = text_width(pen, text);
  if (actual > width) {
    cairo_set_font_size(pen->cairo, fmax(0.8 * size, size * width / actual));
    shorten(pen, text, width);
  }
  cairo_move_to(pen->cairo, x, y);
  cairo_show_text(pen->cairo, text);
}

static const uint8_t ink[3] = {28, 30, 33}, faint[3] = {92, 96, 102}, page[3] = {246, 246, 244},
                     line_colour[3] = {200, 202, 204};

/* "0.0123", or "-" for what is undefined. */
struct number_text {
  char text[32];
};
static struct number_text number(const char *format, double value) {
  struct number_text out = {"\xe2\x80\x93"};
  if (isfinite(value)) snprintf(out.text, sizeof out.text, format, value);
  return out;
}

/* ---- a cell ------------------------------------------------------------------------------------------------------ */

/* Draws the picture at its place in the cell, shrunk to the tile, with a thin frame. Returns 0 when memory ran out. */
static int draw_tile(struct pen *pen, const struct layout *layout, const struct report *report, int x, int y,
                     const uint8_t *rgb) {
  int shrinks = layout->tile[0] != report->width || layout->tile[1] != report->height;
  uint8_t *small =
      shrinks ? picture_shrink(rgb, report->width, report->height, layout->tile[0], layout->tile[1]) : NULL;
  if (shrinks && !small) return 0;
  picture_copy(pen->surface, x, y, small ? small : rgb, layout->tile[0], layout->tile[1]);
  free(small);
  colour(pen, line_colour);
  cairo_set_line_width(pen->cairo, 1);
  cairo_rectangle(pen->cairo, x - 0.5, y - 0.5, layout->tile[0] + 1, layout->tile[1] + 1);
  cairo_stroke(pen->cairo);
  return 1;
}

static int draw_technique(struct pen *pen, const struct layout *layout, const struct report *report, int index, int x,
                          int y) {
  const struct report_technique *technique = &report->techniques[index];
  const struct error_statistics *error = &technique->error;
  double first = report->techniques[0].error.mae, width = layout->cell[0];
  colour(pen, ink);
  write_line(pen, x, y + 19, width, 19, 1, "%s", technique->label);
  write_line(pen, x, y + 42, width, 14.5, 0, "mean %s   rms %s   95 %% %s   max %s   bias %s",
             number("%.4f", error->mae).text, number("%.4f", error->rmse).text, number("%.3f", error->p95).text,
             number("%.3f", error->max).text, number("%+.4f", error->bias).text);
  char ratio[160] = "";
  if (index > 0 && first > 0 && isfinite(error->mae))
    snprintf(ratio, sizeof ratio, "%.3f \xc3\x97 the mean error of %.80s", error->mae / first,
             report->techniques[0].label);
  colour(pen, faint);
  write_line(pen, x, y + 63, width, 14.5, 0, "%s ms a frame   %zu shadow pixels   all %s   picture %s",
             number("%.2f", technique->time_median).text, error->pixels, number("%.4f", technique->all.mae).text,
             number("%.4f", technique->picture_error).text);
  write_line(pen, x, y + 84, width, 14.5, 0, "%s", ratio);
  uint8_t *map = picture_error_map(report, technique->visibility);
  int top = y + CELL_HEAD;
  int drawn = map && draw_tile(pen, layout, report, x, top, technique->picture) &&
              draw_tile(pen, layout, report, x, top + layout->tile[1] + BETWEEN, map);
  free(map);
  return drawn;
}

static void draw_scale(struct pen *pen, int x, int y, int width) {
  for (int i = 0; i < width; i++) {
    uint8_t rgb[3];
    picture_error_colour(PICTURE_ERROR_FULL * (2 * (i + 0.5) / width - 1), rgb);
    colour(pen, rgb);
    cairo_rectangle(pen->cairo, x + i, y, 1, 28);
    cairo_fill(pen->cairo);
  }
  colour(pen, faint);
  cairo_set_line_width(pen->cairo, 1);
  cairo_rectangle(pen->cairo, x - 0.5, y - 0.5, width + 1, 29);
  cairo_stroke(pen->cairo);
  for (int tick = 0; tick <= 4; tick++) {
    double value = PICTURE_ERROR_FULL * (tick / 2.0 - 1), at = floor(x + width * tick / 4.0) + 0.5;
    char text[16];
    snprintf(text, sizeof text, value == 0 ? "0" : "%+.3g", value);
    cairo_move_to(pen->cairo, at, y + 29);
    cairo_line_to(pen->cairo, at, y + 35);
    cairo_stroke(pen->cairo);
    cairo_set_font_size(pen->cairo, 14);
    double half = text_width(pen, text) / 2;
    double left = tick == 0 ? x : tick == 4 ? x + width - 2 * half : at - half;
    cairo_move_to(pen->cairo, left, y + 50);
    cairo_show_text(pen->cairo, text);
  }
}

static void draw_swatch(struct pen *pen, int x, int y, int width, const uint8_t rgb[3], const char *text) {
  colour(pen, rgb);
  cairo_rectangle(pen->cairo, x, y, 28, 18);
  cairo_fill_preserve(pen->cairo);
  colour(pen, faint);
  cairo_stroke(pen->cairo);
  colour(pen, ink);
  write_line(pen, x + 38, y + 14, width - 38, 14.5, 0, "%s", text);
}

static void draw_legend(struct pen *pen, int x, int y, int width) {
  static const uint8_t white[3] = {255, 255, 255};
  colour(pen, ink);
  write_line(pen, x, y + 22, width, 16, 1, "Error: visibility of the technique minus the reference");
  colour(pen, faint);
  write_line(pen, x, y + 46, width, 14.5, 0, "too dark");
  write_line(pen, x + width - 62, y + 46, 70, 14.5, 0, "too light");
  draw_scale(pen, x, y + 54, width);
  draw_swatch(pen, x, y + 122, width, white, "no error");
  draw_swatch(pen, x, y + 150, width, picture_uncounted,
              "not counted: does not receive, or does not face the whole light");
  draw_swatch(pen, x, y + 178, width, picture_background, "background");
  colour(pen, faint);
  write_line(pen, x, y + 226, width, 14, 0,
             "Beyond the scale's ends the colour stays. Numbers are taken over shadow pixels:");
  write_line(pen, x, y + 246, width, 14, 0,
             "where the reference or the technique sees less than 1 - 1/2048 of the light.");
  write_line(pen, x, y + 266, width, 14, 0, "mean, rms, 95 %% and max are of |error|; bias is the mean error.");
  write_line(pen, x, y + 286, width, 14, 0, "all: mean over every pixel that faces any of the light, lit ones too;");
  write_line(pen, x, y + 306, width, 14, 0, "picture: mean over all pixels of the shaded values, 1 being white.");
}

static int draw_truth(struct pen *pen, const struct layout *layout, const struct report *report, int x, int y) {
  colour(pen, ink);
  write_line(pen, x, y + 19, layout->cell[0], 19, 1, "reference");
  write_line(pen, x, y + 42, layout->cell[0], 14.5, 0, "ray-traced, %d ray%s a pixel", report->samples,
             report->samples == 1 ? "" : "s");
  colour(pen, faint);
  write_line(pen, x, y + 63, layout->cell[0], 14.5, 0, "traced in %s s",
             number("%.1f", report->reference_ms / 1000).text);
  int top = y + CELL_HEAD;
  if (!draw_tile(pen, layout, report, x, top, report->reference_picture)) return 0;
  draw_legend(pen, x, top + layout->tile[1] + BETWEEN, layout->cell[0]);
  return 1;
}

/* ---- the sheet --------------------------------------------------------------------------------------------------- */

static int draw(struct pen *pen, const struct layout *layout, const struct report *report) {
  colour(pen, page);
  cairo_paint(pen->cairo);
  /* The same text everywhere: no hinting or subpixels that depend on a desktop's settings. */
  cairo_font_options_t *options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_SLIGHT);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_ON);
  cairo_set_font_options(pen->cairo, options);
  cairo_font_options_destroy(options);
  int width = layout->size[0] - 2 * MARGIN;
  colour(pen, ink);
  write_line(pen, MARGIN, MARGIN + 22, width, 24, 1, "%s", report->title);
  colour(pen, faint);
  write_line(pen, MARGIN, MARGIN + 47, width, 14.5, 0, "%s", report->facts ? report->facts : "");
  write_line(pen, MARGIN, MARGIN + 68, width, 14.5, 0, "%s%s%s   penumbra %s", report->sizes ? report->sizes : "",
             report->sizes ? "   " : "", report->renderer ? report->renderer : "", report->version);
  int drawn = 1;
  for (int i = 0; drawn && i <= report->technique_count; i++) {
    int x = MARGIN + i % layout->columns * (layout->cell[0] + GAP),
        y = MARGIN + HEAD + i / layout->columns * (layout->cell[1] + GAP);
    drawn = i == 0 ? draw_truth(pen, layout, report, x, y) : draw_technique(pen, layout, report, i - 1, x, y);
  }
  return drawn && cairo_status(pen->cairo) == CAIRO_STATUS_SUCCESS;
}

enum report_status report_sheet(const struct report *report, uint8_t **png, size_t *size) {
  struct layout layout;
  if (!choose_layout(&layout, report)) return REPORT_TOO_MANY;
  struct pen pen = {.surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, layout.size[0], layout.size[1])};
  pen.cairo = cairo_create(pen.surface);
  int done = cairo_status(pen.cairo) == CAIRO_STATUS_SUCCESS && draw(&pen, &layout, report);
  cairo_destroy(pen.cairo);
  done = done && picture_surface_png(pen.surface, png, size);
  cairo_surface_destroy(pen.surface);
  return done ? REPORT_OK : REPORT_MEMORY;
}
