/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lanes.h: four floats at a time. The width is fixed here and not by the machine, and every operation is IEEE's: the
 * same bits everywhere. */
#ifndef SSFR_LANES_H
#define SSFR_LANES_H

#include <math.h>
#include <stdint.h>
#include <string.h>
#ifdef __SSE__
#include <xmmintrin.h>
#endif

enum { SSFR_LANES = 4 };

typedef float ssfr_lanes __attribute__((vector_size(4 * SSFR_LANES)));
typedef int32_t ssfr_lanes_mask __attribute__((vector_size(4 * SSFR_LANES))); /* -1 true, 0 false */

static inline ssfr_lanes ssfr_lanes_all(float v)
{
    return (ssfr_lanes){v, v, v, v};
}

static inline ssfr_lanes ssfr_lanes_load(const float *from)
{
    ssfr_lanes a;
    memcpy(&a, from, sizeof a);
    return a;
}

/* Bit l is set where lane l is. */
static inline unsigned ssfr_lanes_bits(ssfr_lanes_mask mask)
{
#ifdef __SSE__
    return (unsigned)_mm_movemask_ps((__m128)mask);
#else
    return (mask[0] & 1u) | (mask[1] & 2u) | (mask[2] & 4u) | (mask[3] & 8u);
#endif
}

static inline ssfr_lanes ssfr_lanes_sqrt(ssfr_lanes a)
{
#ifdef __SSE__
    return (ssfr_lanes)_mm_sqrt_ps((__m128)a);
#else
    return (ssfr_lanes){sqrtf(a[0]), sqrtf(a[1]), sqrtf(a[2]), sqrtf(a[3])};
#endif
}

/* a where the mask is set, else 0. */
static inline ssfr_lanes ssfr_lanes_where(ssfr_lanes_mask mask, ssfr_lanes a)
{
    return (ssfr_lanes)((ssfr_lanes_mask)a & mask);
}

static inline ssfr_lanes ssfr_lanes_positive(ssfr_lanes a) /* max(a, 0) */
{
    return ssfr_lanes_where(a > 0, a);
}

static inline float ssfr_lanes_sum(ssfr_lanes a)
{
    return (a[0] + a[2]) + (a[1] + a[3]);
}

/* Four rows to four columns. */
static inline void ssfr_lanes_transpose(ssfr_lanes m[4])
{
    const ssfr_lanes xy01 = __builtin_shufflevector(m[0], m[1], 0, 4, 1, 5);
    const ssfr_lanes zw01 = __builtin_shufflevector(m[0], m[1], 2, 6, 3, 7);
    const ssfr_lanes xy23 = __builtin_shufflevector(m[2], m[3], 0, 4, 1, 5);
    const ssfr_lanes zw23 = __builtin_shufflevector(m[2], m[3], 2, 6, 3, 7);
    m[0] = __builtin_shufflevector(xy01, xy23, 0, 1, 4, 5);
    m[1] = __builtin_shufflevector(xy01, xy23, 2, 3, 6, 7);
    m[2] = __builtin_shufflevector(zw01, zw23, 0, 1, 4, 5);
    m[3] = __builtin_shufflevector(zw01, zw23, 2, 3, 6, 7);
}

#endif
