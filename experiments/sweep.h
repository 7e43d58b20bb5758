/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sweep.h: running a sweep into a table, with what it depends on beside it and figures at the end. */
#ifndef SSFR_SWEEP_H
#define SSFR_SWEEP_H

#include "experiments/published.h"
#include "experiments/stage.h"
#include "experiments/sweep_spec.h"

typedef struct ssfr_sweep_options {
    const char *output; /* NULL: standard output, without metadata and plot */
    bool resume, dry_run, quick, no_plot, no_twin;
    double max_time;     /* s of timed frames a run; 0: no cap */
    size_t shard, shards; /* the shard-th of shards, from 1 */
    ssfr_stage_options stage; /* but for the size */
    int argc;            /* the command line, for the metadata */
    char **argv;
    const char *what;    /* the part of a command that it is; NULL for a command of its own, with --resume */
    const ssfr_published *published; /* of the spec; NULL for none */
    long seed;
} ssfr_sweep_options;

/* Finds out what of a complete spec is wrong, as far as that needs no scene and no OpenGL. */
SSFR_MUST ssfr_result ssfr_sweep_check(const ssfr_sweep_spec *spec, const ssfr_sweep_options *options);

/* Runs the full product of a complete spec in order. After SIGINT or SIGTERM the row in progress is finished, but for
 * a truth that is being cast: then it fails. Either is gone on with by `resume`. */
SSFR_MUST ssfr_result ssfr_sweep_run(const ssfr_sweep_spec *spec, const ssfr_sweep_options *options);

#endif
