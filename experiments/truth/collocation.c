/* SPDX-License-Identifier: GPL-3.0-or-later */
/* collocation.c: Gauss points and the matrix that integrates between them, by Legendre polynomials. */
#include "experiments/truth/collocation.h"

#include <gsl/gsl_integration.h>

/* P_0 .. P_n at x in [-1, 1]. */
static void legendre(int n, double x, double p[SSFR_COLLOCATION_MOST + 1])
{
    p[0] = 1;
    p[1] = x;
    for (int k = 1; k < n; k++) p[k + 1] = ((2 * k + 1) * x * p[k] - k * p[k - 1]) / (k + 1);
}

/* The polynomial that is 1 at point j and 0 at the others is w_j sum_k (2 k + 1) / 2 P_k(x_j) P_k, k < n, and the
 * integral of P_k from -1 is (P_k+1 - P_k-1) / (2 k + 1). */
static void fill_matrix(ssfr_collocation *c, double (*p)[SSFR_COLLOCATION_MOST + 1])
{
    for (int i = 0; i < c->n; i++)
        for (int j = 0; j < c->n; j++) {
            double sum = 1 + p[i][1];
            for (int k = 1; k < c->n; k++) sum += p[j][k] * (p[i][k + 1] - p[i][k - 1]);
            c->upto[i][j] = 0.5 * c->weight[j] * sum;
        }
}

ssfr_result ssfr_collocation_init(ssfr_collocation *out, int n)
{
    double p[SSFR_COLLOCATION_MOST][SSFR_COLLOCATION_MOST + 1];
    *out = (ssfr_collocation){0};
    if (n < 1 || n > SSFR_COLLOCATION_MOST)
        return ssfr_fail(SSFR_ERR_VALUE, "%d points: there are 1 to %d", n, SSFR_COLLOCATION_MOST);
    gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc((size_t)n);
    if (!table) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for %d points of Gauss and Legendre", n);
    out->n = n;
    for (int i = 0; i < n; i++) {
        gsl_integration_glfixed_point(0, 1, (size_t)i, &out->at[i], &out->weight[i], table);
        legendre(n, 2 * out->at[i] - 1, p[i]);
    }
    gsl_integration_glfixed_table_free(table);
    fill_matrix(out, p);
    return SSFR_OK;
}
