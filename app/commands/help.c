/* penumbra help: the overview, a command's options, a technique's table. */
#include <string.h>

#include "base/message.h"
#include "base/names.h"
#include "commands/commands.h"

enum { PARAMETERS_MAX = 64, LINE_MAX_TEXT = 100 };

static void value_text(const pn_parameter *p, double value, char *text, size_t size) {
  if (p->type == PN_CHOICE) snprintf(text, size, "%s", p->choices[(int)value]);
  else if (p->type == PN_BOOL) snprintf(text, size, "%s", value != 0 ? "on" : "off");
  else if (p->choices && value == p->least) snprintf(text, size, "%s", p->choices[0]);
  else snprintf(text, size, "%g", value);
}

/* What one choice of the parameter preset sets other than the default does: asked of the library, spec by spec. */
static void print_preset(FILE *file, const pn_technique *technique, const pn_parameter *preset, const char *choice) {
  double initial[PARAMETERS_MAX], values[PARAMETERS_MAX];
  char spec[160], value[64];
  snprintf(spec, sizeof spec, "%s:%s=%s", technique->name, preset->name, choice);
  if (pn_technique_parse(technique->name, NULL, initial, NULL, 0) != PN_OK) return;
  if (pn_technique_parse(spec, NULL, values, NULL, 0) != PN_OK) return;
  int column = fprintf(file, "      %s:", choice), any = 0;
  for (int i = 0; i < technique->parameter_count; i++) {
    const pn_parameter *p = &technique->parameters[i];
    if (p == preset || values[i] == initial[i]) continue;
    value_text(p, values[i], value, sizeof value);
    if (column > LINE_MAX_TEXT) column = fprintf(file, "\n        ") - 1;
    column += fprintf(file, " %s=%s", p->name, value);
    any = 1;
  }
  fputs(any ? "\n" : " the defaults\n", file);
}

void print_technique(FILE *file, const pn_technique *technique) {
  fprintf(file, "%s: %s\n  %s\n", technique->name, technique->title, technique->help);
  if (technique->needs_meshes)
    fputs("  needs triangle meshes: what draw callbacks draw casts a hard shadow at most\n", file);
  if (technique->needs_closed) fputs("  casters should be closed surfaces\n", file);
  if (!technique->self_shadows) fputs("  casters do not shadow themselves\n", file);
  if (!technique->parameter_count) fputs("  no parameters\n", file);
  for (int i = 0; i < technique->parameter_count; i++) {
    const pn_parameter *p = &technique->parameters[i];
    char values[160] = "", initial[40];
    value_text(p, p->initial, initial, sizeof initial);
    if (p->type == PN_CHOICE) {
      for (int c = 0; p->choices[c]; c++)
        snprintf(values + strlen(values), sizeof values - strlen(values), "%s%s", c ? "|" : "", p->choices[c]);
    } else if (p->type == PN_BOOL) {
      snprintf(values, sizeof values, "on|off");
    } else {
      snprintf(values, sizeof values, "%s%s%g..%g%s%s", p->choices ? p->choices[0] : "", p->choices ? "|" : "",
               p->least, p->most, *p->unit ? " " : "", p->unit);
    }
    fprintf(file, "  %s=%s  default %s\n      %s%s%s%s\n", p->name, values, initial, p->help, *p->source ? " (" : "",
            p->source, *p->source ? ")" : "");
    if (p->type != PN_CHOICE || strcmp(p->name, "preset") != 0 || technique->parameter_count > PARAMETERS_MAX) continue;
    for (int c = 0; p->choices[c]; c++) print_preset(file, technique, p, p->choices[c]);
  }
}

void print_help(FILE *file, const struct command_row *command) {
  if (command) {
    fprintf(file, "penumbra %s %s\n%s\n\n", command->name, command->arguments, command->summary);
    options_print(file, command->bit);
    return;
  }
  fprintf(file, "penumbra %s: real-time soft shadows from area lights, measured against ray-traced truth\n\n",
          pn_version());
  for (int i = 0; i < COMMAND_COUNT; i++)
    fprintf(file, "  penumbra %-8s%-20s  %s\n", commands[i].name, commands[i].arguments, commands[i].summary);
  fputs("  penumbra --version\n\n"
        "SCENE is a model file (glTF, OBJ, PLY, STL, FBX and whatever else Assimp reads) or builtin:NAME.\n"
        "penumbra help COMMAND shows a command's options, penumbra help TECHNIQUE a technique's parameters.\n",
        file);
}

int command_help(const struct options *o) {
  if (o->positional_count == 0) {
    print_help(stdout, NULL);
    return STATUS_OK;
  }
  const char *topic = o->positionals[0], *names[128];
  const struct command_row *command = command_find(topic);
  const pn_technique *technique = pn_technique_find(topic);
  if (command) print_help(stdout, command);
  else if (technique) print_technique(stdout, technique);
  if (command || technique) return STATUS_OK;
  int count = 0;
  for (int i = 0; i < COMMAND_COUNT; i++) names[count++] = commands[i].name;
  for (int i = 0; i < pn_technique_count() && count < 128; i++) names[count++] = pn_technique_at(i)->name;
  char hint[80];
  return input_error("help: '%s' is neither a command nor a technique; %s", topic,
                     nearest_name(topic, names, count, hint, sizeof hint) ? hint : "penumbra help lists the commands");
}
