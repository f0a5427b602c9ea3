#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "report/report.h"

void report_order(const struct report *report, int *order) {
  for (int i = 0; i < report->technique_count; i++) {
    double mae = report->techniques[i].error.mae;
    int at = i;
    /* Insertion: a comparison with NaN is false, so what is undefined stays at the end. */
    while (at > 0 && (mae < report->techniques[order[at - 1]].error.mae ||
                      (!isnan(mae) && isnan(report->techniques[order[at - 1]].error.mae)))) {
      order[at] = order[at - 1];
      at--;
    }
    order[at] = i;
  }
}

static void print_number(FILE *file, int width, const char *format, double value) {
  char text[32] = "-";
  if (isfinite(value)) snprintf(text, sizeof text, format, value);
  fprintf(file, "  %*s", width, text);
}

static int column_width(const char *text, int least) {
  size_t length = strlen(text);
  return length > 60 ? 60 : (int)length > least ? (int)length : least;
}

void report_table(const struct report *report, FILE *file) {
  int *order = malloc(((size_t)report->technique_count + 1) * sizeof *order), label_width = 9;
  if (!order || report->technique_count == 0) {
    free(order);
    return;
  }
  report_order(report, order);
  for (int i = 0; i < report->technique_count; i++)
    label_width = column_width(report->techniques[i].label, label_width);
  const struct report_technique *first = &report->techniques[0];
  char ratio[80];
  snprintf(ratio, sizeof ratio, "to %s", first->name);
  int ratio_width = column_width(ratio, 8);
  fprintf(file, "%-*s  %7s  %*s  %7s  %7s  %7s  %8s  %7s  %7s  %10s\n", label_width, "technique", "mean", ratio_width,
          ratio, "rms", "95 %", "max", "bias", "all", "picture", "ms a frame");
  for (int i = 0; i < report->technique_count; i++) {
    const struct report_technique *technique = &report->techniques[order[i]];
    fprintf(file, "%-*s", label_width, technique->label);
    print_number(file, 7, "%.4f", technique->error.mae);
    print_number(file, ratio_width, "%.3f", first->error.mae > 0 ? technique->error.mae / first->error.mae : NAN);
    print_number(file, 7, "%.4f", technique->error.rmse);
    print_number(file, 7, "%.4f", technique->error.p95);
    print_number(file, 7, "%.4f", technique->error.max);
    print_number(file, 8, "%+.4f", technique->error.bias);
    print_number(file, 7, "%.4f", technique->all.mae);
    print_number(file, 7, "%.4f", technique->picture_error);
    print_number(file, 10, "%.2f", technique->time_median);
    fputc('\n', file);
  }
  free(order);
}
