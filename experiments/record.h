/* SPDX-License-Identifier: GPL-3.0-or-later */
/* record.h: what a stranger needs to make a frame again: names with a number or a text, for EXR headers and JSON. */
#ifndef SSFR_RECORD_H
#define SSFR_RECORD_H

#include "experiments/json.h"
#include "experiments/options.h"
#include "experiments/setup.h"
#include "experiments/stage.h"

typedef struct ssfr_record {
    int n;
    size_t capacity;
    ssfr_attribute *items; /* own their names and texts */
} ssfr_record;

SSFR_MUST ssfr_result ssfr_record_text(ssfr_record *record, const char *name, const char *text);
SSFR_MUST ssfr_result ssfr_record_number(ssfr_record *record, const char *name, double number);
void ssfr_record_finish(ssfr_record *record);

/* Every parameter of `from` as "prefix.name". */
SSFR_MUST ssfr_result ssfr_record_params(ssfr_record *record, const char *prefix, const ssfr_param *rows,
                                         const void *from);

/* Version, the command line as a shell takes it, seed, backend. */
SSFR_MUST ssfr_result ssfr_record_program(ssfr_record *record, const ssfr_setup *setup, const ssfr_command_line *line,
                                          int argc, char **argv);
/* Scene and frame, particle count and radius, camera. */
SSFR_MUST ssfr_result ssfr_record_stage(ssfr_record *record, const ssfr_stage *stage);
/* Every parameter of the graph. */
SSFR_MUST ssfr_result ssfr_record_graph(ssfr_record *record, const ssfr_graph *graph);

/* One item as a member of the open object. */
void ssfr_record_item_json(const ssfr_attribute *item, ssfr_json *json);
/* All items as members of the open object. */
void ssfr_record_json(const ssfr_record *record, ssfr_json *json);

#endif
