/* SPDX-License-Identifier: GPL-3.0-or-later */
/* inspect.h: what a frame tells without another to compare with: what ran, and whether its values can be right.
 *
 * finite: all values of all images that the pipeline writes are finite.
 * bounded: in all of these images
 *  - a surface of the fluid is no nearer than the nearest sphere of a particle begins and no farther than the farthest
 *    ends, spheres being as large as the largest splats, and one of foam by what its quad leans out of them;
 *  - a length of fluid is not negative;
 *  - the picture is not negative, and no brighter than the sum of the brightest that there is to be seen (the scene
 *    without fluid, sky or environment, white under the light, the water's own colour), of the highest highlight and of
 *    the brightest foam, and where there is spray, of all its particles.
 * Smoothing that is not stable leaves the first, errors of signs or of shares that do not add up to one the others. */
#ifndef SSFR_INSPECT_H
#define SSFR_INSPECT_H

#include "experiments/columns.h"

typedef struct ssfr_bounds {
    double nearest, farthest; /* m, eye-space z of surfaces of the fluid; without particles none is within them */
    double leaning;           /* m, how much nearer or farther foam may be, whose quads lean along its velocity */
    double brightest;         /* of the picture */
} ssfr_bounds;

/* Of a graph's frames of a scene. `behind` is the scene without the fluid. */
ssfr_bounds ssfr_inspect_bounds(const ssfr_graph *graph, const ssfr_scene *scene, const ssfr_field *behind);

typedef struct ssfr_inspected {
    bool finite, bounded;
} ssfr_inspected;

/* Clears what an image of that slot is not; both must be true at first. */
void ssfr_inspect_image(ssfr_inspected *inspected, const char *slot, const ssfr_field *image,
                        const ssfr_bounds *bounds);

/* Runs one more frame, with all images, and looks at each. What the graph was asked for stays as it was. */
SSFR_MUST ssfr_result ssfr_inspect_frame(ssfr_inspected *out, ssfr_graph *graph, const ssfr_scene *scene,
                                         const ssfr_run_options *run);

/* Of the particles of the graph's last frame: the mean of their foam values, and the share that has a size as spray;
 * 0 where the pipeline has no such values. */
SSFR_MUST ssfr_result ssfr_inspect_foam(double *foam_share, double *spray_share, const ssfr_graph *graph);

/* "surface_noise unwanted;noise_foam needless", cut where it does not fit. */
void ssfr_inspect_left_out(int n, const ssfr_node_report *reports, char *text, size_t size);
/* 16 hexadecimal digits, of all bits of all values. */
void ssfr_inspect_hash(const ssfr_field *image, char text[17]);

#endif
