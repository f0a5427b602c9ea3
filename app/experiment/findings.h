/* findings.h: an experiment as a report. */
#ifndef PENUMBRA_APP_EXPERIMENT_FINDINGS_H
#define PENUMBRA_APP_EXPERIMENT_FINDINGS_H

#include "experiment/experiment.h"
#include "report/report.h"

/* What report points into, besides the experiment. */
struct findings {
  struct report report;
  struct report_technique *techniques;
  cJSON **described; /* technique, label, parameters */
  cJSON *scene;
  char **files;
  char facts[320], sizes[320];
};

/* Of an experiment that has its errors; without pictures where those were not made. The experiment must outlive the
 * findings and not be changed. samples: what it was traced with; saved: its buffers are in a folder. Free the findings
 * in any case. Exit status. */
int findings_make(const struct experiment *e, int samples, int saved, struct findings *out);
void findings_free(struct findings *findings);

#endif
