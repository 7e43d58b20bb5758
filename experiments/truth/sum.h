/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sum.h: sums whose rounding is that of one addition, however many terms they have (Neumaier 1974). */
#ifndef SSFR_TRUTH_SUM_H
#define SSFR_TRUTH_SUM_H

#include <math.h>

/* Begins as {0}. */
typedef struct ssfr_sum {
    double value, lost; /* as added up, and what rounding took from it */
    double size;        /* sum of absolute values: what the terms' own rounding counts by */
} ssfr_sum;

static inline void ssfr_sum_add(ssfr_sum *s, double term)
{
    const double value = s->value + term;
    s->lost += fabs(s->value) >= fabs(term) ? s->value - value + term : term - value + s->value;
    s->value = value;
    s->size += fabs(term);
}

static inline double ssfr_sum_total(const ssfr_sum *s)
{
    return s->value + s->lost;
}

#endif
