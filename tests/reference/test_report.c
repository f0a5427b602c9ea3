/* Errors against sums done by hand, and the forms a comparison is shown in. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cairo.h>
#include <cmocka.h>

#include "report/picture.h"
#include "report/report.h"

/* ---- errors ------------------------------------------------------------------------------------------------------ */

static void errors_by_hand(void **state) {
  (void)state;
  /* Lit in both: not counted; masked: not counted; the other four: errors 0.25, -0.5, 0, 1. */
  const float reference[] = {1, 0.5f, 0.75f, 0.25f, 0, 0.9f}, result[] = {1, 0.75f, 0.25f, 0.25f, 1, 0.1f};
  const uint8_t mask[] = {1, 1, 1, 1, 1, 0};
  struct error_statistics error;
  assert_true(error_measure(reference, result, mask, 6, &error));
  assert_int_equal(error.pixels, 4);
  assert_true(error.mae == (0.25 + 0.5 + 0 + 1) / 4);
  assert_true(error.rmse == sqrt((0.0625 + 0.25 + 0 + 1) / 4));
  assert_true(error.p95 == 1);
  assert_true(error.max == 1);
  assert_true(error.bias == (0.25 - 0.5 + 0 + 1) / 4);
}

static void shadow_begins_at_its_threshold(void **state) {
  (void)state;
  const float at = 1 - 1 / 2048.0f, below = nextafterf(1 - 1 / 2048.0f, 0);
  const float pairs[][2] = {{1, 1}, {at, 1}, {1, at}, {at, at}, {below, 1}, {1, below}};
  const size_t counted[] = {0, 0, 0, 0, 1, 1};
  const uint8_t mask = 1;
  for (size_t i = 0; i < 6; i++) {
    struct error_statistics error;
    assert_true(error_measure(&pairs[i][0], &pairs[i][1], &mask, 1, &error));
    assert_int_equal(error.pixels, counted[i]);
  }
}

/* 100 errors 0.01 .. 1.00 in no order: 95 of them do not exceed 0.95. */
static void percentile_is_the_nearest_rank(void **state) {
  (void)state;
  float reference[101], result[101];
  uint8_t mask[101];
  for (int n = 1; n <= 101; n += 20) {
    for (int i = 0; i < n; i++) {
      mask[i] = 1;
      reference[i] = 0;
      result[i] = (float)((i * 37 % n) + 1) / 128;
    }
    struct error_statistics error;
    assert_true(error_measure(reference, result, mask, (size_t)n, &error));
    int rank = (int)ceil(0.95 * n - 1e-9);
    assert_true(error.p95 == rank / 128.0);
  }
}

static void undefined_is_nan(void **state) {
  (void)state;
  const float lit[] = {1, 1}, broken[] = {0.5f, NAN};
  const uint8_t mask[] = {1, 1}, nothing[] = {0, 0};
  struct error_statistics error;
  assert_true(error_measure(lit, lit, mask, 2, &error));
  assert_true(error.pixels == 0 && isnan(error.mae) && isnan(error.rmse) && isnan(error.p95) && isnan(error.max) &&
              isnan(error.bias));
  assert_true(error_measure(broken, lit, nothing, 2, &error));
  assert_true(error.pixels == 0 && isnan(error.mae));
  assert_true(error_measure(lit, lit, mask, 0, &error));
  assert_true(error.pixels == 0);
  assert_true(error_measure(lit, broken, mask, 2, &error)); /* a broken result is never taken for a lit one */
  assert_true(error.pixels == 2 && error.not_finite == 1 && isnan(error.mae) && isnan(error.max));
}

/* Every pixel of the mask counts, those lit in both too: errors 0, 0.25, -0.5, 0, 1. */
static void all_counts_lit_pixels(void **state) {
  (void)state;
  const float reference[] = {1, 0.5f, 0.75f, 0.25f, 0, 0.9f}, result[] = {1, 0.75f, 0.25f, 0.25f, 1, 0.1f};
  const uint8_t mask[] = {1, 1, 1, 1, 1, 0}, nothing[6] = {0};
  struct error_statistics all;
  assert_true(error_measure_all(reference, result, mask, 6, &all));
  assert_int_equal(all.pixels, 5);
  assert_true(all.mae == 1.75 / 5 && all.rmse == sqrt(1.3125 / 5) && all.p95 == 1 && all.max == 1);
  assert_true(all.bias == 0.75 / 5);
  assert_true(error_measure_all(reference, result, nothing, 6, &all));
  assert_true(all.pixels == 0 && isnan(all.mae) && isnan(all.max));
  const float lit[] = {1, 1}, broken[] = {1, NAN};
  assert_true(error_measure_all(lit, lit, mask, 2, &all));
  assert_true(all.pixels == 2 && all.mae == 0 && all.max == 0 && all.bias == 0);
  assert_true(error_measure_all(lit, broken, mask, 2, &all));
  assert_true(all.not_finite == 1 && isnan(all.mae));
}

/* Two pixels count, of three channels: |differences| 0.25, 0, 0.5 and 0, 0, 1; the one between does not. */
static void picture_by_hand(void **state) {
  (void)state;
  const float truth[] = {0.5f, 0.5f, 1, 9, 9, 9, 0, 0, 1}, result[] = {0.25f, 0.5f, 1.5f, 0, 0, 0, 0, 0, 2};
  const uint8_t mask[] = {1, 0, 1}, nothing[3] = {0};
  assert_true(error_picture(truth, result, mask, 3) == 1.75 / 6);
  assert_true(error_picture(result, truth, mask, 3) == 1.75 / 6);
  assert_true(error_picture(truth, truth, mask, 3) == 0);
  assert_true(isnan(error_picture(truth, result, nothing, 3)) && isnan(error_picture(truth, result, mask, 0)));
  const float broken[] = {0, NAN, 0};
  assert_true(isnan(error_picture(truth, broken, mask, 1)));
}

/* ---- a made-up comparison ---------------------------------------------------------------------------------------- */

enum { WIDTH = 90, HEIGHT = 60, COUNT = WIDTH * HEIGHT };

struct made {
  float reference[COUNT], visibility[3][COUNT];
  uint8_t mask[COUNT], background[COUNT], pictures[4][3 * COUNT];
  struct report_stage stages[2];
  struct report_technique techniques[3];
  cJSON *scene, *parameters;
  struct report report;
};

static const char *const hostile = "</script><img src=\"http://x/\">&\xff\xc3";

static void make(struct made *made) {
  memset(made, 0, sizeof *made);
  for (int i = 0; i < COUNT; i++) {
    int x = i % WIDTH, y = i / WIDTH;
    made->background[i] = y < 10;
    made->mask[i] = y >= 10 && x >= 8;
    made->reference[i] = y < 10 ? 1 : (float)x / WIDTH;
    for (int t = 0; t < 3; t++) {
      float value = made->reference[i] + (t == 0 ? 0.25f : t == 1 ? -0.1f : 0.0f) * (y < 35 ? 1.0f : -1.0f);
      made->visibility[t][i] = made->background[i] || value > 1 ? 1 : value < 0 ? 0 : value;
    }
    for (int p = 0; p < 4; p++)
      memset(made->pictures[p] + 3 * i, (int)(255 * (p ? made->visibility[p - 1][i] : made->reference[i])), 3);
  }
  made->parameters = cJSON_Parse("{\"samples\": 8, \"filter\": \"box\"}");
  made->scene = cJSON_Parse("{\"name\": \"made\", \"split\": false}");
  made->stages[0] = (struct report_stage){"depth_map", 1.5};
  made->stages[1] = (struct report_stage){"gather", 2.25};
  static const char *const names[] = {"hard", "pcss", "bitmask"};
  static const char *const labels[] = {
      "hard", "pcss:samples=8", "bitmask:samples=16j,primitive=quad-exact,maps=two-sided,hierarchy=hybrid,filter=2"};
  for (int t = 0; t < 3; t++) {
    made->techniques[t] = (struct report_technique){.name = names[t],
                                                    .label = labels[t],
                                                    .parameters = t ? made->parameters : NULL,
                                                    .file = t == 1 ? "02-pcss-samples=8.exr" : NULL,
                                                    .time_median = t == 2 ? NAN : 3.75 + t,
                                                    .time_least = t == 2 ? NAN : 3.5,
                                                    .time_most = t == 2 ? NAN : 8,
                                                    .stages = made->stages,
                                                    .stage_count = t == 2 ? 0 : 2,
                                                    .visibility = made->visibility[t],
                                                    .picture = made->pictures[t + 1]};
    assert_true(error_measure(made->reference, made->visibility[t], made->mask, COUNT, &made->techniques[t].error));
    made->techniques[t].all = (struct error_statistics){.mae = 0.0611 + t, .max = 1, .pixels = 4321};
    made->techniques[t].picture_error = 0.0377 + t;
  }
  made->report = (struct report){.version = "0.1.0",
                                 .renderer = "a renderer",
                                 .gl_version = "3.3",
                                 .title = "made",
                                 .facts = "light 1 x 1",
                                 .scene = made->scene,
                                 .samples = 1024,
                                 .reference_ms = 1234.5,
                                 .width = WIDTH,
                                 .height = HEIGHT,
                                 .reference = made->reference,
                                 .reference_picture = made->pictures[0],
                                 .mask = made->mask,
                                 .background = made->background,
                                 .techniques = made->techniques,
                                 .technique_count = 3};
}

static void unmake(struct made *made) {
  cJSON_Delete(made->scene);
  cJSON_Delete(made->parameters);
}

/* What a function that prints has printed; free it. */
static char *printed(const struct report *report, int html) {
  static char *text; /* not on the stack: GCC 12 takes the stream's text for the variable that points to it */
  static size_t size;
  FILE *file = open_memstream(&text, &size);
  assert_non_null(file);
  if (html) assert_int_equal(report_html(report, file), REPORT_OK);
  else report_table(report, file);
  fclose(file);
  return text;
}

static void table_is_sorted(void **state) {
  (void)state;
  static struct made made;
  make(&made);
  char *text = printed(&made.report, 0);
  const char *bitmask = strstr(text, "\nbitmask"), *pcss = strstr(text, "\npcss"), *hard = strstr(text, "\nhard");
  assert_non_null(strstr(text, "to hard"));
  assert_true(bitmask && pcss && hard && bitmask < pcss && pcss < hard);
  assert_non_null(strstr(hard, "  1.000  "));
  double label_mae = 0, ratio = 0;
  assert_int_equal(sscanf(pcss, " pcss:samples=8 %lf %lf", &label_mae, &ratio), 2);
  assert_true(fabs(label_mae - made.techniques[1].error.mae) < 1e-4);
  assert_true(fabs(ratio - made.techniques[1].error.mae / made.techniques[0].error.mae) < 1e-3);
  assert_non_null(strstr(text, "      all  picture  ms a frame\n"));
  assert_non_null(strstr(hard, "   0.0611   0.0377  "));
  assert_non_null(strstr(pcss, "   1.0611   1.0377  "));
  free(text);
  made.techniques[1].error.mae = NAN; /* undefined goes last, the others keep their order */
  int order[3];
  report_order(&made.report, order);
  assert_true(order[0] == 2 && order[1] == 0 && order[2] == 1);
  made.techniques[0].error.mae = NAN;
  report_order(&made.report, order);
  assert_true(order[0] == 2 && order[1] == 0 && order[2] == 1);
  made.techniques[2].error.mae = NAN;
  report_order(&made.report, order);
  assert_true(order[0] == 0 && order[1] == 1 && order[2] == 2);
  unmake(&made);
}

static double number_at(const cJSON *object, const char *path) {
  char name[64];
  while (*path) {
    size_t length = strcspn(path, ".");
    snprintf(name, sizeof name, "%.*s", (int)length, path);
    object = cJSON_GetObjectItemCaseSensitive(object, name);
    path += length + (path[length] == '.');
  }
  assert_true(cJSON_IsNumber(object));
  return object->valuedouble;
}

static void json_has_the_contracts_members(void **state) {
  (void)state;
  static struct made made;
  make(&made);
  made.techniques[2].error.mae = NAN;
  cJSON *built = report_json(&made.report);
  char *text = cJSON_Print(built);
  cJSON *json = cJSON_Parse(text);
  assert_non_null(json);
  assert_string_equal(cJSON_GetObjectItem(json, "penumbra")->valuestring, "0.1.0");
  assert_true(number_at(json, "schema") == 1);
  assert_string_equal(cJSON_GetObjectItem(cJSON_GetObjectItem(json, "device"), "renderer")->valuestring, "a renderer");
  assert_string_equal(cJSON_GetObjectItem(cJSON_GetObjectItem(json, "scene"), "name")->valuestring, "made");
  assert_true(number_at(json, "reference.samples") == 1024 && number_at(json, "reference.time_ms") == 1234.5);
  const cJSON *results = cJSON_GetObjectItem(json, "results");
  assert_int_equal(cJSON_GetArraySize(results), 3);
  const cJSON *pcss = cJSON_GetArrayItem(results, 1), *bitmask = cJSON_GetArrayItem(results, 2);
  assert_string_equal(cJSON_GetObjectItem(pcss, "technique")->valuestring, "pcss");
  assert_string_equal(cJSON_GetObjectItem(pcss, "label")->valuestring, "pcss:samples=8");
  assert_string_equal(cJSON_GetObjectItem(pcss, "file")->valuestring, "02-pcss-samples=8.exr");
  assert_true(number_at(pcss, "parameters.samples") == 8);
  assert_true(fabs(number_at(pcss, "error.mae") - made.techniques[1].error.mae) < 1e-15);
  assert_true(fabs(number_at(pcss, "error.bias") - made.techniques[1].error.bias) < 1e-15);
  assert_true(number_at(pcss, "error.pixels") == (double)made.techniques[1].error.pixels);
  assert_true(number_at(pcss, "all.mae") == 1.0611 && number_at(pcss, "all.pixels") == 4321);
  assert_true(number_at(pcss, "all.max") == 1 && number_at(pcss, "picture") == 1.0377);
  assert_true(number_at(pcss, "time_ms.total.median") == 4.75 && number_at(pcss, "time_ms.stages.gather") == 2.25);
  assert_true(cJSON_IsNull(cJSON_GetObjectItem(cJSON_GetObjectItem(bitmask, "error"), "mae")));
  assert_true(cJSON_IsNull(cJSON_GetObjectItem(bitmask, "file")));
  assert_true(cJSON_IsNull(
      cJSON_GetObjectItem(cJSON_GetObjectItem(cJSON_GetObjectItem(bitmask, "time_ms"), "total"), "median")));
  cJSON_Delete(json);
  cJSON_Delete(built);
  cJSON_free(text);
  unmake(&made);
}

/* ---- pictures ---------------------------------------------------------------------------------------------------- */

static int is_colour(const uint8_t *a, int r, int g, int b) { return a[0] == r && a[1] == g && a[2] == b; }

static double lightness(const uint8_t rgb[3]) { return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]; }

static void error_colours_diverge(void **state) {
  (void)state;
  uint8_t zero[3], before[3], rgb[3], end[3];
  picture_error_colour(0, zero);
  assert_true(is_colour(zero, 255, 255, 255));
  for (int side = -1; side <= 1; side += 2) {
    memcpy(before, zero, 3);
    for (int i = 1; i <= 50; i++) {
      picture_error_colour(side * PICTURE_ERROR_FULL * i / 50, rgb);
      assert_true(lightness(rgb) < lightness(before));
      assert_true(side < 0 ? rgb[2] > rgb[0] : rgb[0] > rgb[2]); /* too dark is blue, too light is red */
      memcpy(before, rgb, 3);
    }
    picture_error_colour(side * 1.0, end);
    assert_memory_equal(end, before, 3);
  }
  picture_error_colour((double)NAN, rgb);
  assert_true(is_colour(rgb, 255, 0, 255));
}

static void error_map_tells_four_things_apart(void **state) {
  (void)state;
  static struct made made;
  make(&made);
  uint8_t *map = picture_error_map(&made.report, made.visibility[0]);
  assert_memory_equal(map, picture_background, 3);
  assert_memory_equal(map + 3 * (20 * WIDTH + 3), picture_uncounted, 3);
  uint8_t rgb[3];
  picture_error_colour((double)made.visibility[0][20 * WIDTH + 40] - (double)made.reference[20 * WIDTH + 40], rgb);
  assert_memory_equal(map + 3 * (20 * WIDTH + 40), rgb, 3);
  free(map);
  unmake(&made);
}

/* Black and white columns, half as many: light's mean, code 188; and an uneven ratio keeps the mean of the light. */
static void shrinking_averages_light(void **state) {
  (void)state;
  uint8_t stripes[4 * 8 * 3];
  for (int i = 0; i < 32; i++) memset(stripes + 3 * i, i % 2 ? 255 : 0, 3);
  uint8_t *half = picture_shrink(stripes, 8, 4, 4, 2);
  for (int i = 0; i < 4 * 2 * 3; i++) assert_int_equal(half[i], 188);
  free(half);
  uint8_t flat[5 * 7 * 3];
  memset(flat, 100, sizeof flat);
  uint8_t *third = picture_shrink(flat, 7, 5, 3, 2);
  for (int i = 0; i < 3 * 2 * 3; i++) assert_int_equal(third[i], 100);
  free(third);
}

struct reader {
  const uint8_t *bytes;
  size_t left;
};
static cairo_status_t read_png(void *user, unsigned char *out, unsigned count) {
  struct reader *reader = user;
  if (count > reader->left) return CAIRO_STATUS_READ_ERROR;
  memcpy(out, reader->bytes, count);
  reader->bytes += count;
  reader->left -= count;
  return CAIRO_STATUS_SUCCESS;
}

/* Somewhere in the sheet stands the picture, pixel by pixel. */
static int contains(cairo_surface_t *surface, const uint8_t *rgb, int width, int height) {
  const unsigned char *data = cairo_image_surface_get_data(surface);
  int stride = cairo_image_surface_get_stride(surface);
  for (int y0 = 0; y0 + height <= cairo_image_surface_get_height(surface); y0++)
    for (int x0 = 0; x0 + width <= cairo_image_surface_get_width(surface); x0++) {
      int same = 1;
      for (int i = 0; same && i < width * height; i++) {
        uint32_t pixel;
        memcpy(&pixel, data + (size_t)(y0 + i / width) * (size_t)stride + 4 * (size_t)(x0 + i % width), 4);
        same = (pixel & 0xffffff) == ((uint32_t)rgb[3 * i] << 16 | (uint32_t)rgb[3 * i + 1] << 8 | rgb[3 * i + 2]);
      }
      if (same) return 1;
    }
  return 0;
}

static void sheet_holds_every_picture(void **state) {
  (void)state;
  static struct made made;
  make(&made);
  uint8_t *png, *again;
  size_t size, again_size;
  assert_int_equal(report_sheet(&made.report, &png, &size), REPORT_OK);
  struct reader reader = {png, size};
  cairo_surface_t *surface = cairo_image_surface_create_from_png_stream(read_png, &reader);
  assert_int_equal(cairo_surface_status(surface), CAIRO_STATUS_SUCCESS);
  for (int i = 0; i < 4; i++) assert_true(contains(surface, made.pictures[i], WIDTH, HEIGHT));
  for (int i = 0; i < 3; i++) {
    uint8_t *map = picture_error_map(&made.report, made.visibility[i]);
    assert_true(contains(surface, map, WIDTH, HEIGHT));
    free(map);
  }
  cairo_surface_destroy(surface);
  assert_int_equal(report_sheet(&made.report, &again, &again_size), REPORT_OK);
  assert_int_equal(size, again_size);
  assert_memory_equal(png, again, size);
  free(png);
  free(again);
  unmake(&made);
}

/* Odd shapes, odd texts, and as many techniques as anybody could ask for. */
static void sheet_takes_anything(void **state) {
  (void)state;
  static struct made made;
  make(&made);
  struct report report = made.report;
  struct report_technique many[40];
  uint8_t *png;
  size_t size;
  for (int i = 0; i < 40; i++) {
    many[i] = made.techniques[i % 3];
    many[i].label = hostile;
    many[i].name = hostile;
  }
  report.title = report.facts = report.renderer = hostile;
  report.techniques = many;
  report.technique_count = 40;
  assert_int_equal(report_sheet(&report, &png, &size), REPORT_OK);
  free(png);
  report.technique_count = 0;
  assert_int_equal(report_sheet(&report, &png, &size), REPORT_OK);
  free(png);
  const int shapes[][2] = {{1, 1}, {COUNT, 1}, {1, COUNT}, {WIDTH, HEIGHT}};
  for (size_t i = 0; i < 4; i++) {
    report.width = shapes[i][0];
    report.height = shapes[i][1];
    report.technique_count = 2;
    assert_int_equal(report_sheet(&report, &png, &size), REPORT_OK);
    free(png);
  }
  report.technique_count = 1000000; /* the layout alone says no */
  assert_int_equal(report_sheet(&report, &png, &size), REPORT_TOO_MANY);
  unmake(&made);
}

/* ---- the page ---------------------------------------------------------------------------------------------------- */

static void page_is_self_contained(void **state) {
  (void)state;
  static struct made made;
  make(&made);
  made.report.title = hostile;
  made.techniques[0].label = hostile;
  char *text = printed(&made.report, 1);
  int pictures = 0;
  for (const char *at = text; (at = strstr(at, " src=\"")); at++) {
    assert_true(strncmp(at + 6, "data:image/png;base64,iVBORw0KGgo", 33) == 0);
    pictures++;
  }
  assert_int_equal(pictures, 4 + 3);
  assert_null(strstr(text, "src=\"http"));
  assert_null(strstr(text, "url("));
  assert_null(strstr(text, hostile));
  assert_non_null(strstr(text, "&lt;/script&gt;&lt;img src=&quot;http://x/&quot;&gt;&amp;"));
  assert_non_null(strstr(text, "Content-Security-Policy"));
  assert_non_null(strstr(text, "</html>"));
  free(text);
  unmake(&made);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(errors_by_hand),
      cmocka_unit_test(shadow_begins_at_its_threshold),
      cmocka_unit_test(percentile_is_the_nearest_rank),
      cmocka_unit_test(undefined_is_nan),
      cmocka_unit_test(all_counts_lit_pixels),
      cmocka_unit_test(picture_by_hand),
      cmocka_unit_test(table_is_sorted),
      cmocka_unit_test(json_has_the_contracts_members),
      cmocka_unit_test(error_colours_diverge),
      cmocka_unit_test(error_map_tells_four_things_apart),
      cmocka_unit_test(shrinking_averages_light),
      cmocka_unit_test(sheet_holds_every_picture),
      cmocka_unit_test(sheet_takes_anything),
      cmocka_unit_test(page_is_self_contained),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
