/* SPDX-License-Identifier: GPL-3.0-or-later */
/* description_read.h: what the files that read descriptions share. */
#ifndef SSFR_DESCRIPTION_READ_H
#define SSFR_DESCRIPTION_READ_H

#include "experiments/scenes/description.h"
#include "experiments/yaml_tree.h"

/* Ranges of values, so that no sum or square of them overflows. */
#define SSFR_MAX_LENGTH 1e7  /* m, of coordinates and sizes */
#define SSFR_MIN_LENGTH 1e-6 /* m, of what must not be 0 */
#define SSFR_MAX_SPEED 1e4   /* m/s, and m/s^2 of gravity */
#define SSFR_MAX_TIME 1e5    /* s */

/* The end of a row for such values. */
#define SSFR_RANGE_PLACE .unit = "m", .min = -SSFR_MAX_LENGTH, .max = SSFR_MAX_LENGTH
#define SSFR_RANGE_LENGTH .unit = "m", .min = SSFR_MIN_LENGTH, .max = SSFR_MAX_LENGTH
#define SSFR_RANGE_TIME .unit = "s", .min = 0, .max = SSFR_MAX_TIME

enum {
    SSFR_MAX_FLUID = (1u << 31) / 64, /* particles: what 32-bit indices and the memory of today hold */
    SSFR_MAX_PARTS = 1000,            /* solids, pools, keys of a motion, ... */
};

/* A description in the making. */
typedef struct ssfr_reading {
    ssfr_description d;
    char *folder; /* what paths are relative to, with its '/'; "" for the current one */
    ssfr_mesh_loader *load_mesh;
    size_t particles;      /* at full scale */
    double spacing;        /* m, of the lattice at full scale */
    double duration;       /* s */
    const ssfr_yaml_node *domain, *motions, *solids, *pools, *emitters, *sinks, *cameras; /* NULL when not given */
} ssfr_reading;

/* Each reads one part; domain and motions come before what they are for. */
SSFR_MUST ssfr_result ssfr_reading_domain(ssfr_reading *reading);
SSFR_MUST ssfr_result ssfr_reading_motions(ssfr_reading *reading);
SSFR_MUST ssfr_result ssfr_reading_solids(ssfr_reading *reading);
SSFR_MUST ssfr_result ssfr_reading_pools(ssfr_reading *reading);
SSFR_MUST ssfr_result ssfr_reading_emitters(ssfr_reading *reading);
SSFR_MUST ssfr_result ssfr_reading_sinks(ssfr_reading *reading);
SSFR_MUST ssfr_result ssfr_reading_views(ssfr_reading *reading);
/* That there is fluid and room for it. */
SSFR_MUST ssfr_result ssfr_reading_check_room(const ssfr_reading *reading);

/* Zeroed memory, `size` bytes each, for what a map holds, or a list, which must not be empty; node NULL: for nothing.
 * More than SSFR_MAX_PARTS are refused. */
SSFR_MUST ssfr_result ssfr_reading_make(const ssfr_yaml_node *node, ssfr_yaml_kind kind, size_t size, void *out,
                                        int *n);

/* A reader for rows: double[3], which becomes a unit vector. */
ssfr_yaml_read ssfr_reading_direction;

/* A motion's name as its index. motion NULL: -1. */
SSFR_MUST ssfr_result ssfr_reading_find_motion(const ssfr_reading *reading, const ssfr_yaml_node *motion, int *index);

/* How far particles at rest are apart on a cubic lattice, m. */
double ssfr_description_spacing(const ssfr_description *description);

/* Whether one particle finds room in a box, on a lattice of that spacing (m). */
SSFR_MUST ssfr_result ssfr_description_has_room(const ssfr_description *description, const double lo[3],
                                                const double hi[3], const double spacing[3], bool *out);
/* How many places a lattice of that spacing (m) has in a pool, without a look at solids. */
double ssfr_description_places(const ssfr_pool *pool, double spacing);

#endif
