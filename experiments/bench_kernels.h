/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_kernels.h: `ssfr bench kernels`: the curves of Bagar 2010's figures 4.3, 4.13 and 4.15, which take no scene. */
#ifndef SSFR_BENCH_KERNELS_H
#define SSFR_BENCH_KERNELS_H

/* argv[0] is "bench", argv[1] "kernels"; gives the exit status. */
int ssfr_bench_kernels(int argc, char **argv);

#endif
