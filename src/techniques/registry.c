/* The techniques there are, and how their specs are read. */
#include "techniques/technique.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PNI_TECHNIQUE(name) extern const pni_technique_class pni_technique_##name;
#include "techniques/list.h"
#undef PNI_TECHNIQUE

#define PNI_TECHNIQUE(name) &pni_technique_##name,
static const pni_technique_class *const classes[] = {
#include "techniques/list.h"
};
#undef PNI_TECHNIQUE

enum { COUNT = sizeof classes / sizeof *classes };

int pn_technique_count(void) { return COUNT; }

const pn_technique *pn_technique_at(int index) { return index >= 0 && index < COUNT ? &classes[index]->table : NULL; }

const pn_technique *pn_technique_find(const char *name) {
  for (int i = 0; i < COUNT && name; i++)
    if (!strcmp(classes[i]->table.name, name)) return &classes[i]->table;
  return NULL;
}

const pni_technique_class *pni_technique_class_of(const pn_technique *table) {
  for (int i = 0; i < COUNT; i++)
    if (&classes[i]->table == table) return classes[i];
  return NULL;
}

/* ---- specs: "name" or "name:key=value,key=value" ----------------------------------------------------------------- */

typedef struct {
  char *why;
  size_t size;
} explanation;

static pn_result explain(const explanation *e, const char *format, const char *a, const char *b) {
  if (e->why && e->size) snprintf(e->why, e->size, format, a, b);
  return PN_ERROR_ARGUMENT;
}

/* The names that would have been right, for the explanation. */
static void list_techniques(char out[256]) {
  out[0] = 0;
  for (int i = 0; i < COUNT; i++) {
    size_t used = strlen(out);
    snprintf(out + used, 256 - used, "%s%s", i ? ", " : "", classes[i]->table.name);
  }
}

static void list_parameters(const pn_technique *t, char out[256]) {
  snprintf(out, 256, t->parameter_count ? "it has " : "it has none");
  for (int i = 0; i < t->parameter_count; i++) {
    size_t used = strlen(out);
    snprintf(out + used, 256 - used, "%s%s", i ? ", " : "", t->parameters[i].name);
  }
}

static void describe_values(const pn_parameter *p, char out[256]) {
  if (p->type == PN_BOOL) snprintf(out, 256, "on or off");
  if (p->type == PN_INT) snprintf(out, 256, "a whole number from %.0f to %.0f", p->least, p->most);
  if (p->type == PN_FLOAT)
    snprintf(out, 256, "%s%sa number from %g to %g", p->choices ? p->choices[0] : "", p->choices ? " or " : "",
             p->least, p->most);
  if (p->type != PN_CHOICE) return;
  out[0] = 0;
  for (int i = 0; p->choices[i]; i++) {
    size_t used = strlen(out);
    snprintf(out + used, 256 - used, "%s%s", i ? ", " : "one of ", p->choices[i]);
  }
}

static bool read_number(const char *text, double *out) {
  static const char allowed[] = "0123456789+-.eE";
  if (!*text || strspn(text, allowed) != strlen(text)) return false; /* no hexadecimal, no inf, no spaces */
  /* strtod reads the locale's decimal point; a host may have set one, so the point is put in by hand. */
  char copy[64], *end;
  if (strlen(text) >= sizeof copy) return false;
  strcpy(copy, text);
  char *point = strchr(copy, '.');
  *out = strtod(copy, &end);
  if (*end == '.' && end == point) {
    char probe[8];
    snprintf(probe, sizeof probe, "%.1f", 0.5);
    *point = probe[1];
    *out = strtod(copy, &end);
  }
  return *end == 0 && isfinite(*out);
}

static bool value_in_range(const pn_parameter *p, double value) {
  bool whole = p->type == PN_FLOAT || value == floor(value);
  return isfinite(value) && whole && value >= p->least && value <= p->most;
}

static bool read_value(const pn_parameter *p, const char *text, double *out) {
  if (p->type == PN_BOOL) {
    bool on = !strcmp(text, "on") || !strcmp(text, "1"), off = !strcmp(text, "off") || !strcmp(text, "0");
    *out = on;
    return on || off;
  }
  if (p->type == PN_CHOICE) {
    for (int i = 0; p->choices[i]; i++)
      if (!strcmp(p->choices[i], text)) {
        *out = i;
        return true;
      }
    return false;
  }
  bool word = p->type == PN_FLOAT && p->choices && !strcmp(p->choices[0], text);
  if (word) *out = p->least;
  return word || (read_number(text, out) && value_in_range(p, *out));
}

static int find_parameter(const pn_technique *t, const char *name) {
  for (int i = 0; i < t->parameter_count; i++)
    if (!strcmp(t->parameters[i].name, name)) return i;
  return -1;
}

/* One "key=value", which is cut apart in place. */
static pn_result read_pair(const pn_technique *t, char *pair, double *values, const explanation *e) {
  char list[256], named[128];
  char *value = strchr(pair, '=');
  if (!value) return explain(e, "technique %s: parameter '%s' is not key=value", t->name, pair);
  *value++ = 0;
  int index = find_parameter(t, pair);
  snprintf(named, sizeof named, "technique %s: parameter '%.60s'", t->name, pair);
  if (index < 0) {
    list_parameters(t, list);
    return explain(e, "%s is unknown; %s", named, list);
  }
  if (read_value(&t->parameters[index], value, &values[index])) return PN_OK;
  describe_values(&t->parameters[index], list);
  snprintf(named, sizeof named, "technique %s: %.60s=%.40s", t->name, pair, value);
  return explain(e, "%s is no value; it takes %s", named, list);
}

static pn_result read_all_pairs(const pn_technique *t, const char *text, double *values, const explanation *e) {
  char copy[512];
  strcpy(copy, text);
  for (char *pair = copy, *next; pair; pair = next) {
    next = strchr(pair, ',');
    if (next) *next++ = 0;
    pn_result result = read_pair(t, pair, values, e);
    if (result != PN_OK) return result;
  }
  return PN_OK;
}

/* A preset is the ground that the other parameters stand on, wherever it is named: read once to find it, and again on
 * top of it. */
static pn_result read_pairs(const pn_technique *t, const char *text, double *values, const explanation *e) {
  if (!text) return PN_OK;
  const pni_technique_class *technique = pni_technique_class_of(t);
  double first[PNI_PARAMETERS_MAX];
  memcpy(first, values, sizeof first);
  pn_result result = read_all_pairs(t, text, first, e);
  if (result != PN_OK || !technique->preset) return read_all_pairs(t, text, values, e);
  technique->preset((int)first[0], values);
  values[0] = first[0];
  return read_all_pairs(t, text, values, e);
}

pn_result pn_technique_parse(const char *spec, const pn_technique **technique, double *values, char *why,
                             size_t why_size) {
  explanation e = {why, why_size};
  char copy[512], list[256];
  if (why && why_size) why[0] = 0;
  if (!spec) return explain(&e, "no technique is given%s%s", "", "");
  if (strlen(spec) >= sizeof copy) return explain(&e, "the technique's text is too long%s%s", "", "");
  strcpy(copy, spec);
  char *rest = strchr(copy, ':');
  if (rest) *rest++ = 0;
  const pn_technique *t = pn_technique_find(copy);
  if (!t) {
    list_techniques(list);
    return explain(&e, "technique '%s' is unknown; there are %s", copy, list);
  }
  double read[PNI_PARAMETERS_MAX];
  for (int i = 0; i < t->parameter_count; i++) read[i] = t->parameters[i].initial;
  pn_result result = read_pairs(t, rest, read, &e);
  if (result != PN_OK) return result;
  if (technique) *technique = t;
  if (values) memcpy(values, read, (size_t)t->parameter_count * sizeof *values);
  return PN_OK;
}

bool pni_parameter_set(const pn_technique *t, const char *name, double value, double *values, pn_message *message) {
  int index = find_parameter(t, name);
  *message = index < 0 ? PN_MESSAGE_PARAMETER_UNKNOWN : PN_MESSAGE_PARAMETER_VALUE;
  if (index < 0 || !value_in_range(&t->parameters[index], value)) return false;
  values[index] = value;
  const pni_technique_class *technique = pni_technique_class_of(t);
  if (index == 0 && technique->preset) technique->preset((int)value, values);
  return true;
}

void pni_technique_defines(const pni_technique_class *technique, const double *values,
                           char out[PNI_TECHNIQUE_DEFINES]) {
  out[0] = 0;
  if (technique->defines) technique->defines(values, out);
}
