/* SPDX-License-Identifier: MIT */
/* anisotropy.h: ellipsoids after the spread of a particle's neighbours, and the eigenvectors that they take. */
#ifndef SSFR_ANISOTROPY_H
#define SSFR_ANISOTROPY_H

#include "base/param.h"

extern const ssfr_param ssfr_anisotropy_rows[];

/* Eigenvalues, falling, and orthonormal eigenvectors (one a row) of the symmetric matrix xx, xy, xz, yy, yz, zz: by
 * Jacobi's rotations, which find small values beside large ones, too. */
void ssfr_eigen_symmetric(const double matrix[6], double values[3], double vectors[3][3]);

#endif
