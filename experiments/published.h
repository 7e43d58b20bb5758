/* SPDX-License-Identifier: GPL-3.0-or-later */
/* published.h: a paper's own numbers beside those that a sweep measures, joined by cells of the same name. */
#ifndef SSFR_PUBLISHED_H
#define SSFR_PUBLISHED_H

#include "experiments/csv.h"
#include "experiments/sweep_spec.h"

typedef struct ssfr_published {
    const ssfr_published_spec *spec;
    ssfr_csv_table *table;
    int column, on[SSFR_MAX_ON]; /* of the table */
    char header[256];            /* of the column in the sweep's table: "published_ms" */
} ssfr_published;

/* Takes the table from its text; path is what errors call it. The spec must stay. */
SSFR_MUST ssfr_result ssfr_published_parse(ssfr_published **out, const ssfr_published_spec *spec, const char *path,
                                           const char *text, size_t size);
/* The same from published/<file> in the folder of the sweep's file. */
SSFR_MUST ssfr_result ssfr_published_load(ssfr_published **out, const ssfr_published_spec *spec, const char *sweep);
void ssfr_published_destroy(ssfr_published **published);

/* The number of the row that has these cells, one a name of `on`, as it stands in the table; "" when there is none.
 * Numbers are the same however they are written. */
const char *ssfr_published_find(const ssfr_published *published, const char *const *cells);

/* Goes on with a hash, over the numbers and what joins them to rows. */
uint64_t ssfr_published_hash(const ssfr_published *published, uint64_t hash);

#endif
