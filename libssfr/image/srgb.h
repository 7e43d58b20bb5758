/* SPDX-License-Identifier: MIT */
/* srgb.h: the sRGB transfer function (IEC 61966-2-1), exactly as defined and in double. */
#ifndef SSFR_SRGB_H
#define SSFR_SRGB_H

#include "base/base.h"

/* Display value in [0, 1] of a linear value, which is clamped to [0, 1]. NaN stays NaN. */
static inline double ssfr_srgb_encode(double linear)
{
    const double v = ssfr_clamp(linear, 0, 1);
    return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
}

/* Linear value of a display value in [0, 1]. */
static inline double ssfr_srgb_decode(double display)
{
    return display <= 0.04045 ? display / 12.92 : pow((display + 0.055) / 1.055, 2.4);
}

/* Of a linear colour. */
static inline double ssfr_srgb_luminance(const double linear[3])
{
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
}

#endif
