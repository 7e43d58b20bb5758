/* SPDX-License-Identifier: MIT */
/* half.h: images of 16-bit floats, and how they round. */
#ifndef SSFR_HALF_H
#define SSFR_HALF_H

/* What a GPU stores a channel in. The CPU twins hold doubles, and round to what would be stored. */
typedef enum ssfr_storage { SSFR_STORE_FLOAT, SSFR_STORE_HALF } ssfr_storage;

extern const char *const ssfr_storages[]; /* words for parameters */

/* The nearest half (IEEE 754's binary16), of two the even one: steps of 2^-24 up to 2^-14, of 2^-10 of the power of two
 * below from there on, and infinity from 65520 on. */
double ssfr_half_round(double v);

#endif
