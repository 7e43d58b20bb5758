/* SPDX-License-Identifier: GPL-3.0-or-later */
/* meta.h: what stands beside a table, as <name>.meta.json: machine, versions, command, scenes, every parameter. */
#ifndef SSFR_META_H
#define SSFR_META_H

#include "experiments/columns.h"
#include "experiments/hash.h"
#include "experiments/record.h"
#include "experiments/sweep_spec.h"
#include "experiments/truth/truth.h"

/* Of the world positions, in the order of the packed set. */
uint64_t ssfr_hash_particles(const ssfr_particles *particles);

/* The commit that the program was built from, "-dirty" behind it when files differed from it; "" when not known. */
const char *ssfr_meta_commit(void);

/* The processor's name, as the system has it. */
void ssfr_meta_processor(char *text, size_t size);
/* Of version, commit and processor, as identities begin: rows of another build or machine must not mix. */
uint64_t ssfr_meta_hash(void);

typedef struct ssfr_meta {
    int argc;
    char **argv; /* argv[0] is the command */
    long seed;
    uint64_t identity;           /* of what the rows of a table have in common, see ssfr_meta_check; 0: none */
    const ssfr_gl *gl;           /* NULL when none is used */
    const char *pipeline;
    const ssfr_graph *graph;     /* for its parameters; those that an axis varies are left out; NULL for none */
    const ssfr_record *parameters; /* of what is measured when that is no graph */
    const ssfr_truth_params *truth; /* that errors are measured against; those that an axis varies are left out; NULL */
    const ssfr_sweep_spec *spec; /* NULL for a table without axes */
    const char *scale;           /* of scenes that are described: quick or full; NULL for none */
    int n_columns;
    const ssfr_column *columns;  /* those whose name does not say all */
    int n_scenes;
    const ssfr_record *scenes;   /* as ssfr_meta_record_scene fills them */
    double bandwidth_gl, bandwidth_cpu; /* bytes/s; NaN when not measured */
} ssfr_meta;

/* What tells one scene from another: counts, camera, and a hash of its content. */
SSFR_MUST ssfr_result ssfr_meta_record_scene(ssfr_record *record, const ssfr_stage *stage);

/* "dir/name.csv" gives "dir/name<ending>". Free it. */
SSFR_MUST ssfr_result ssfr_meta_path(char **out, const char *table, const char *ending);

/* Writes the file beside the table, aside and renamed when complete. */
SSFR_MUST ssfr_result ssfr_meta_save(const char *table, const ssfr_meta *meta);

/* Fails when the file beside the table tells of another identity: such rows must not mix. Without a file: a warning. */
SSFR_MUST ssfr_result ssfr_meta_check(const char *table, uint64_t identity);

#endif
