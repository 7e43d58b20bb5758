/* SPDX-License-Identifier: MIT */
/* half.c: rounding to 16-bit floats, from double at once: by way of float some would be rounded twice. */
#include "base/half.h"

#include <math.h>
#include <stddef.h>

const char *const ssfr_storages[] = {"float", "half", NULL};

double ssfr_half_round(double v)
{
    enum { BITS = 11, LOWEST = -24 }; /* of the significand; exponent of the smallest step */
    int exponent;
    if (isnan(v)) return v;
    if (fabs(v) >= 65520) return copysign(INFINITY, v); /* midway between the largest, 65504, and the next */
    frexp(v, &exponent);
    const double step = ldexp(1, exponent - BITS > LOWEST ? exponent - BITS : LOWEST);
    return rint(v / step) * step;
}
