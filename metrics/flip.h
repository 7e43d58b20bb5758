/* SPDX-License-Identifier: MIT */
/* flip.h: FLIP, the difference seen when two images alternate, as a map, of displayed and of high dynamic range images.
 *
 * LDR-FLIP: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom and Fairchild, "FLIP: A Difference Evaluator for
 * Alternating Images", 2020. HDR-FLIP: Andersson, Nilsson, Shirley and Akenine-Moller, "Visualizing Errors in Rendered
 * High Dynamic Range Images", 2021. The metrics flip and flip_hdr are means of these maps. */
#ifndef SSFR_FLIP_H
#define SSFR_FLIP_H

#include "metrics/metrics.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Pixels per degree of visual angle: an image of 3840 pixels seen from as far as it is wide, as the authors have it. */
#define SSFR_FLIP_PPD (3840 * M_PI / 180)

/* A map has one channel: errors in [0, 1], NaN where a NaN is in the filters' reach of ceil(0.135 ppd) pixels. Images
 * have 1 or 3 channels, linear. The mask of the pair is not looked at. ppd is in [1, 1000]. */

/* Clamped to [0, 1]. The same when a and b are exchanged. */
SSFR_MUST ssfr_result ssfr_flip_map(const ssfr_pair *pair, double ppd, ssfr_field **out);

typedef enum ssfr_flip_tone { SSFR_FLIP_ACES, SSFR_FLIP_HABLE, SSFR_FLIP_REINHARD } ssfr_flip_tone; /* tone mappers */

typedef struct ssfr_flip_exposures { /* n of them, equally far apart from start to stop */
    double start, stop;              /* log2 of the factor */
    int n;                           /* from 1 */
} ssfr_flip_exposures;

/* The exposures at which the brightest and the median pixel of the reference (pair->b, where the mask counts) are tone
 * mapped to 0.85, at most one apart: all that is between burnt out and too dark. A median below FLT_EPSILON counts as
 * that, so that images on black have a second exposure; black alone is exposed by 0. n is 0 when no pixel is counted,
 * or one is not finite: no exposure shows it. */
SSFR_MUST ssfr_result ssfr_flip_expose(const ssfr_pair *pair, ssfr_flip_tone tone, ssfr_flip_exposures *out);

/* The largest error of a pixel over the exposures, each image tone mapped. Negative values count as 0. */
SSFR_MUST ssfr_result ssfr_flip_hdr_map(const ssfr_pair *pair, double ppd, ssfr_flip_tone tone,
                                        const ssfr_flip_exposures *exposures, ssfr_field **out);

#ifdef __cplusplus
}
#endif
#endif
