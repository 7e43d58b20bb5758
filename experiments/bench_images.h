/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_images.h: `ssfr bench images`: the images and tables that a pipeline holds after a frame. */
#ifndef SSFR_BENCH_IMAGES_H
#define SSFR_BENCH_IMAGES_H

/* argv[0] is "bench", argv[1] "images"; gives the exit status. */
int ssfr_bench_images(int argc, char **argv);

#endif
