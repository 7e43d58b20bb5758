/* SPDX-License-Identifier: GPL-3.0-or-later */
/* integrate.h: integrals of functions of one variable, by every rule that GSL has for them, one list.
 *
 * integrators.def names them. qags, qagp and cquad choose where they look until their estimate is small enough; gauss
 * (on each piece between break points) and steps do not. */
#ifndef SSFR_TRUTH_INTEGRATE_H
#define SSFR_TRUTH_INTEGRATE_H

#include "experiments/truth/collocation.h"

typedef enum ssfr_integrator_id {
#define X(name, help) SSFR_INTEGRATOR_##name,
#include "experiments/truth/integrators.def"
#undef X
    SSFR_N_INTEGRATORS
} ssfr_integrator_id;

typedef struct ssfr_integrator {
    const char *name, *help;
} ssfr_integrator;

extern const ssfr_integrator ssfr_integrators[SSFR_N_INTEGRATORS];
extern const char *const ssfr_integrator_names[]; /* NULL-terminated */

typedef struct ssfr_integrand {
    double (*value)(double t, void *user);
    void *user;
    size_t n_breaks;
    const double *breaks; /* rising; the first and the last are the ends. Between two of them the function is smooth */
} ssfr_integrand;

typedef struct ssfr_integrate_params {
    double eps_abs, eps_rel; /* what is asked of those that choose */
    int points;              /* of gauss, a piece, [1, 64] */
    int steps;               /* of equal length, [1, 2^24] */
} ssfr_integrate_params;

typedef struct ssfr_integral {
    double value;
    double err;           /* the rule's own estimate of its absolute error (GSL's abserr; gauss: the difference to half
                           * the points; steps: to half as many), plus what rounding may do; at least 0. No bound where
                           * none of the rule's points meets what there is; where the places t have no more digits only
                           * gauss and steps know it */
    size_t evaluations;
    bool converged;       /* err is within what was asked; always false for none asked */
} ssfr_integral;

/* Work space of one thread. It grows to what the largest integral takes and then allocates no more; what was integrated
 * before changes no bit of what is integrated next. */
typedef struct ssfr_integration ssfr_integration;
SSFR_MUST ssfr_result ssfr_integration_create(ssfr_integration **out);
void ssfr_integration_destroy(ssfr_integration **work);

/* Memory for n things of `size` bytes that an integrand is made of, not cleared; the work space's, until the next
 * call. */
SSFR_MUST ssfr_result ssfr_integration_room(ssfr_integration *work, size_t n, size_t size, void *out);
/* Collocation by n points, made when it is first asked for; the work space's. */
SSFR_MUST ssfr_result ssfr_integration_collocation(ssfr_integration *work, int n, const ssfr_collocation **out);

/* Not for `chords`, which is no rule but the closed form: ssfr_line_chords. A function that is not finite somewhere
 * gives an infinite err. Missing the tolerance is no error: err and converged tell. */
SSFR_MUST ssfr_result ssfr_integrate(ssfr_integration *work, ssfr_integrator_id id, const ssfr_integrand *integrand,
                                     const ssfr_integrate_params *params, ssfr_integral *out);

#endif
