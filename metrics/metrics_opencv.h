/* SPDX-License-Identifier: MIT */
/* metrics_opencv.h: what is taken from OpenCV, as C. */
#ifndef SSFR_METRICS_OPENCV_H
#define SSFR_METRICS_OPENCV_H

#include "ssfr.h"

#ifdef __cplusplus
extern "C" {
#endif

/* SSIM at each pixel of two planes of w h values in [0, 255]: a window of 11 pixels, sigma 1.5, mirrored at the border.
 * Nothing is logged: on failure one line is left in message[size]. */
SSFR_MUST ssfr_result ssfr_opencv_ssim(const double *a, const double *b, int w, int h, double *map, char *message,
                                       size_t size);

#ifdef __cplusplus
}
#endif
#endif
