/* SPDX-License-Identifier: GPL-3.0-or-later */
/* inspect.h: what a frame tells without another to compare with: what ran, and whether its values can be right.
 *
 * finite: all values of all images that the pipeline writes are finite.
 * bounded: in all of these images
 *  - the splats' water is no nearer than the nearest sphere of a particle begins, nor than the eye, and no farther than
 *    the farthest ends, spheres being as large as the largest splats, and foam by what its quads lean out of them;
 *    depths made of the splats' are within theirs;
 *  - a length of fluid is not negative, and no more than the diameters of all particles that may be over the pixel;
 *  - the picture is not negative, and no brighter than the brightest that there is to be seen (the scene without fluid,
 *    sky or environment, white under the light, the colours of water and foam) with the highest highlight, and with what
 *    all spray adds that may be over the pixel.
 * Smoothing that is not stable leaves the first, errors of signs or of shares that do not add up to one the others. */
#ifndef SSFR_INSPECT_H
#define SSFR_INSPECT_H

#include "experiments/columns.h"

typedef struct ssfr_bounds {
    double nearest, farthest; /* m, eye-space z of surfaces of the fluid; without particles none is within them */
    double leaning;           /* m, how much nearer or farther foam may be, whose quads lean along its velocity */
    double brightest;         /* of the picture without spray */
    ssfr_field *water, *foam; /* m, lengths at each pixel */
    ssfr_field *spray;        /* what it adds to each pixel */
} ssfr_bounds;

/* Of a graph's last frame, which was of this scene. `behind` is the scene without the fluid. */
SSFR_MUST ssfr_result ssfr_inspect_bounds(ssfr_bounds *out, const ssfr_graph *graph, const ssfr_scene *scene,
                                          const ssfr_field *behind);
void ssfr_bounds_clear(ssfr_bounds *bounds);

typedef struct ssfr_inspected {
    bool finite, bounded;
    double border_share; /* of the pixels with water: those whose colours are interpolated; 0 where none tells */
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
