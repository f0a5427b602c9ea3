#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "report/picture.h"
#include "report/report.h"

/* The page needs nothing but itself: pictures are data URIs, and its own policy forbids it to load anything. Without
 * scripts the gallery below the slider still shows all. */

static const char head_text[] =
    "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src "
    "'unsafe-inline'; "
    "script-src 'unsafe-inline'\">\n"
    "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<link rel=\"icon\" href=\"data:,\">\n";

static const char style_text[] =
    "<style>\n"
    "body { font: 15px/1.45 sans-serif; color: #1c1e21; background: #f6f6f4; margin: 24px auto; padding: 0 24px; "
    "max-width: 1400px }\n"
    "h1 { font-size: 24px; margin: 0 } h2 { font-size: 18px; margin: 28px 0 6px }\n"
    ".faint { color: #5c6066 }\n"
    "table { border-collapse: collapse; margin: 20px 0 } td, th { padding: 3px 14px 3px 0; text-align: right; "
    "font-variant-numeric: tabular-nums }\n"
    "td:first-child, th:first-child { text-align: left } thead th { border-bottom: 1px solid #c8cacc; font-weight: "
    "normal; color: #5c6066 }\n"
    ".frame { display: inline-block; max-width: 100% } .facts { white-space: pre-wrap }\n"
    "#stage { position: relative; line-height: 0; cursor: ew-resize; "
    "touch-action: none }\n"
    "#stage img { max-width: 100%; height: auto; user-select: none } #stage #left { position: absolute; left: 0; top: "
    "0 }\n"
    "#bar { position: absolute; top: 0; bottom: 0; width: 2px; margin-left: -1px; background: #fff; box-shadow: 0 0 "
    "3px #000 }\n"
    "#split { width: 100%; margin: 8px 0 } .controls { display: none } .scripted .controls { display: block }\n"
    ".choices { display: flex; gap: 28px; flex-wrap: wrap; margin: 12px 0 } select { font: inherit; max-width: 30em }\n"
    ".pair { display: flex; gap: 8px; flex-wrap: wrap } .pair img { max-width: min(100%, 640px); height: auto; border: "
    "1px solid #c8cacc }\n"
    ".scale { height: 24px; max-width: 640px; border: 1px solid #5c6066; box-sizing: border-box }\n"
    ".ticks { display: flex; justify-content: space-between; max-width: 640px }\n"
    ".swatch { display: inline-block; width: 24px; height: 14px; border: 1px solid #5c6066; vertical-align: -2px; "
    "margin: 0 6px 0 18px }\n"
    "</style>\n";

static const char script_text[] =
    "<script>\n'use strict';\n(function () {\n"
    "  const at = id => document.getElementById(id);\n"
    "  const left = at('left'), right = at('right'), stage = at('stage'), split = at('split');\n"
    "  function source(choice) {\n"
    "    const map = document.querySelector('input[name=view]:checked').value === 'error' && at('e' + choice);\n"
    "    return (map || at('p' + choice)).src;\n"
    "  }\n"
    "  function show() {\n"
    "    left.src = source(at('choose-left').value);\n"
    "    right.src = source(at('choose-right').value);\n"
    "    const percent = Number(split.value);\n"
    "    left.style.clipPath = 'inset(0 ' + (100 - percent) + '% 0 0)';\n"
    "    at('bar').style.left = percent + '%';\n"
    "  }\n"
    "  function drag(event) {\n"
    "    const box = stage.getBoundingClientRect();\n"
    "    split.value = 100 * (event.clientX - box.left) / box.width;\n"
    "    show();\n"
    "  }\n"
    "  stage.addEventListener('pointerdown', event => { stage.setPointerCapture(event.pointerId); drag(event); });\n"
    "  stage.addEventListener('pointermove', event => { if (event.buttons) drag(event); });\n"
    "  for (const control of document.querySelectorAll('.controls select, .controls input')) "
    "control.addEventListener('input', show);\n"
    "  document.body.classList.add('scripted');\n"
    "  show();\n"
    "})();\n</script>\n";

static void write_escaped(FILE *file, const char *text) {
  for (; *text; text++) {
    switch (*text) {
    case '&': fputs("&amp;", file); break;
    case '<': fputs("&lt;", file); break;
    case '>': fputs("&gt;", file); break;
    case '"': fputs("&quot;", file); break;
    default: fputc((unsigned char)*text < 0x20 ? ' ' : *text, file);
    }
  }
}

static void write_base64(FILE *file, const uint8_t *bytes, size_t size) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (size_t i = 0; i < size; i += 3) {
    size_t left = size - i;
    uint32_t group =
        (uint32_t)bytes[i] << 16 | (left > 1 ? (uint32_t)bytes[i + 1] << 8 : 0) | (left > 2 ? bytes[i + 2] : 0);
    char text[4] = {digits[group >> 18], digits[group >> 12 & 63], left > 1 ? digits[group >> 6 & 63] : '=',
                    left > 2 ? digits[group & 63] : '='};
    fwrite(text, 1, 4, file);
  }
}

/* <img id="KINDINDEX">. Returns 0 when memory ran out. */
static int write_picture(FILE *file, const struct report *report, char kind, int index, const char *what,
                         const uint8_t *rgb) {
  uint8_t *png;
  size_t size;
  if (!picture_png(rgb, report->width, report->height, &png, &size)) return 0;
  fprintf(file, "<img id=\"%c%d\" width=\"%d\" height=\"%d\" alt=\"%s\" src=\"data:image/png;base64,", kind, index,
          report->width, report->height, what);
  write_base64(file, png, size);
  fputs("\">\n", file);
  free(png);
  return 1;
}

static void write_number(FILE *file, const char *format, double value) {
  if (isfinite(value)) fprintf(file, format, value);
  else fputs("\xe2\x80\x93", file);
}

static void write_cell(FILE *file, const char *format, double value) {
  fputs("<td>", file);
  write_number(file, format, value);
  fputs("</td>", file);
}

static void write_table(FILE *file, const struct report *report, const int *order) {
  double first = report->technique_count ? report->techniques[0].error.mae : NAN;
  fputs("<table>\n<thead><tr><th>technique</th><th>mean error</th><th>ratio to ", file);
  write_escaped(file, report->technique_count ? report->techniques[0].label : "the first");
  fputs("</th><th>rms</th><th>95 %</th><th>max</th><th>bias</th><th>shadow pixels</th><th>mean over all</th>"
        "<th>picture</th><th>ms a frame</th></tr></thead>\n<tbody>\n",
        file);
  for (int i = 0; i < report->technique_count; i++) {
    const struct report_technique *technique = &report->techniques[order[i]];
    fputs("<tr><td>", file);
    write_escaped(file, technique->label);
    fputs("</td>", file);
    write_cell(file, "%.4f", technique->error.mae);
    write_cell(file, "%.3f", first > 0 ? technique->error.mae / first : NAN);
    write_cell(file, "%.4f", technique->error.rmse);
    write_cell(file, "%.4f", technique->error.p95);
    write_cell(file, "%.4f", technique->error.max);
    write_cell(file, "%+.4f", technique->error.bias);
    write_cell(file, "%.0f", (double)technique->error.pixels);
    write_cell(file, "%.4f", technique->all.mae);
    write_cell(file, "%.4f", technique->picture_error);
    write_cell(file, "%.2f", technique->time_median);
    fputs("</tr>\n", file);
  }
  fputs("</tbody>\n</table>\n<p class=\"faint\">ratio: the technique's mean error divided by that of ", file);
  write_escaped(file, report->technique_count ? report->techniques[0].label : "the first");
  fputs(", the first one named; below 1 is better than it. mean over all: mean error over every "
        "pixel that faces any of the light, lit ones too. picture: mean difference of the shaded values, 1 being "
        "white</p>\n",
        file);
}

/* Choice 0 is the truth, choice i + 1 technique i. */
static void write_choices(FILE *file, const struct report *report, const char *side, int selected) {
  fprintf(file, "<label>%s <select id=\"choose-%s\">\n", side, side);
  for (int i = 0; i <= report->technique_count; i++) {
    fprintf(file, "<option value=\"%d\"%s>", i, i == selected ? " selected" : "");
    write_escaped(file, i ? report->techniques[i - 1].label : "reference");
    fputs("</option>\n", file);
  }
  fputs("</select></label>\n", file);
}

static void write_stage(FILE *file, const struct report *report, const int *order) {
  fputs("<div class=\"controls\">\n<div class=\"choices\">\n", file);
  write_choices(file, report, "left", 0);
  write_choices(file, report, "right", report->technique_count ? order[0] + 1 : 0);
  fputs("<span><label><input type=\"radio\" name=\"view\" value=\"picture\" checked> pictures</label>\n"
        "<label><input type=\"radio\" name=\"view\" value=\"error\"> error maps</label></span>\n</div>\n"
        "<div class=\"frame\"><div id=\"stage\"><img id=\"right\" alt=\"right\" draggable=\"false\"><img id=\"left\" "
        "alt=\"left\" "
        "draggable=\"false\">"
        "<div id=\"bar\"></div></div>\n"
        "<input id=\"split\" type=\"range\" min=\"0\" max=\"100\" step=\"0.1\" value=\"50\" aria-label=\"border "
        "between left and right\">\n</div></div>\n",
        file);
}

static void write_colour(FILE *file, const uint8_t rgb[3]) { fprintf(file, "#%02x%02x%02x", rgb[0], rgb[1], rgb[2]); }

static void write_legend(FILE *file) {
  fputs("<h2>Error: visibility of the technique minus the reference</h2>\n<div class=\"scale\" style=\"background: "
        "linear-gradient(to right",
        file);
  for (int i = -8; i <= 8; i++) {
    uint8_t rgb[3];
    picture_error_colour(PICTURE_ERROR_FULL * i / 8.0, rgb);
    fputs(", ", file);
    write_colour(file, rgb);
  }
  fprintf(file,
          ")\"></div>\n<div class=\"ticks\"><span>%+.3g, too dark</span><span>0</span><span>%+.3g, too "
          "light</span></div>\n",
          -PICTURE_ERROR_FULL, PICTURE_ERROR_FULL);
  fputs("<p class=\"faint\">Numbers are taken over shadow pixels, where the reference or the technique sees less than "
        "1 &minus; 1/2048 of the light.\n"
        "<span class=\"swatch\" style=\"background: ",
        file);
  write_colour(file, picture_uncounted);
  fputs("\"></span>not counted: does not receive, or does not face the whole light <span class=\"swatch\" "
        "style=\"background: ",
        file);
  write_colour(file, picture_background);
  fputs("\"></span>background</p>\n", file);
}

static void write_summary(FILE *file, const struct report_technique *technique) {
  fputs("<p class=\"faint\">mean error ", file);
  write_number(file, "%.4f", technique->error.mae);
  fputs(", rms ", file);
  write_number(file, "%.4f", technique->error.rmse);
  fputs(", 95 % ", file);
  write_number(file, "%.4f", technique->error.p95);
  fputs(", max ", file);
  write_number(file, "%.4f", technique->error.max);
  fputs(", bias ", file);
  write_number(file, "%+.4f", technique->error.bias);
  fputs("; over all that the light reaches ", file);
  write_number(file, "%.4f", technique->all.mae);
  fputs(", picture ", file);
  write_number(file, "%.4f", technique->picture_error);
  fputs("; ", file);
  write_number(file, "%.2f", technique->time_median);
  fputs(" ms a frame</p>\n", file);
}

static int write_gallery(FILE *file, const struct report *report, const int *order) {
  fprintf(file, "<h2>reference</h2>\n<p class=\"faint\">ray-traced, %d ray%s a pixel, in ", report->samples,
          report->samples == 1 ? "" : "s");
  write_number(file, "%.1f", report->reference_ms / 1000);
  fputs(" s</p>\n<div class=\"pair\">\n", file);
  if (!write_picture(file, report, 'p', 0, "reference", report->reference_picture)) return 0;
  fputs("</div>\n", file);
  for (int i = 0; i < report->technique_count; i++) {
    const struct report_technique *technique = &report->techniques[order[i]];
    fputs("<h2>", file);
    write_escaped(file, technique->label);
    fputs("</h2>\n", file);
    write_summary(file, technique);
    fputs("<div class=\"pair\">\n", file);
    uint8_t *map = picture_error_map(report, technique->visibility);
    int written = map && write_picture(file, report, 'p', order[i] + 1, "picture", technique->picture) &&
                  write_picture(file, report, 'e', order[i] + 1, "error map", map);
    free(map);
    if (!written) return 0;
    fputs("</div>\n", file);
  }
  return 1;
}

enum report_status report_html(const struct report *report, FILE *file) {
  int *order = malloc(((size_t)report->technique_count + 1) * sizeof *order);
  if (!order) return REPORT_MEMORY;
  report_order(report, order);
  fputs(head_text, file);
  fputs("<title>penumbra: ", file);
  write_escaped(file, report->title);
  fprintf(file, "</title>\n%s</head>\n<body>\n<h1>", style_text);
  write_escaped(file, report->title);
  fputs("</h1>\n<p class=\"faint facts\">", file);
  write_escaped(file, report->facts ? report->facts : "");
  fputs("<br>", file);
  write_escaped(file, report->sizes ? report->sizes : "");
  fputs("<br>", file);
  write_escaped(file, report->renderer ? report->renderer : "");
  fputs("; penumbra ", file);
  write_escaped(file, report->version);
  fputs("</p>\n", file);
  write_stage(file, report, order);
  write_table(file, report, order);
  write_legend(file);
  int written = write_gallery(file, report, order);
  free(order);
  fprintf(file, "%s</body>\n</html>\n", script_text);
  return written ? REPORT_OK : REPORT_MEMORY;
}
