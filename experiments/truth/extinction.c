/* SPDX-License-Identifier: GPL-3.0-or-later */
/* extinction.c: the parameters of a medium of diffuse particles, and the kernels and colours that it is made of. */
#include "experiments/truth/extinction.h"

#include "base/param.h"

#define REAL(name, unit, def, min, max, help) SSFR_PARAM_REAL(ssfr_extinction_params, name, unit, def, min, max, help)
/* Ihmsen et al. 2012 render by absorption and emission along equal steps, without scattering (so Akinci et al. 2013,
 * sec. 1, who print no coefficients). The defaults follow from optics and from what is to be seen:
 *
 *      efficiency   a ball that is large against the wavelength takes what meets its cross-section: Q = 1. It is 2 with
 *                   the light that it diffracts (van de Hulst 1957), but that goes straight on
 *      radius       half of the rays through the foam of a double dam break (182 398 diffuse particles, the fluid's of
 *                   0.02 m, seen from the side) then have an optical depth below 0.6, a quarter above 1.7, 1 % above
 *                   7.6: sheets and clouds that the water shows through, opaque where they are dense. With 0.25 half
 *                   is above 1.6, and all of it is one white shape. Akinci et al. 2013, sec. 2.1 draw balls of r to
 *                   r / 5, 0.54 r in the root mean square
 *      support      a particle stands for a fleck, not for one ball: half the fluid's spacing, so that a lone one is
 *                   a soft dot (the optical depth through its middle is 6 Q a^2 / h^2 = 0.135) and many are a cloud
 *      colours      what fully opaque foam looks like, light = 1. Foam reflects nearly all light, as do drops; bubbles
 *                   are under water and meant to be less visible (Akinci et al. halve their radius, sec. 2.1) */
const ssfr_param ssfr_extinction_rows[] = {
    REAL(radius, "radii", 0.15, 1e-4, 10, "a, of a diffuse particle as a ball that takes light"),
    REAL(support, "radii", 1, 0.01, 100, "of the cubic spline kernel that its cross-section is spread with"),
    REAL(efficiency, "1", 1, 0, 4, "Q, extinction over cross-section: 1 of large balls, 2 with what they diffract"),
    REAL(spray, "1", 1, 0, 1, "grey, what spray shines with where it is opaque, light = 1"),
    REAL(foam, "1", 0.95, 0, 1, "the same of foam"),
    REAL(bubble, "1", 0.8, 0, 1, "the same of bubbles, which are under water"),
    SSFR_PARAM_END,
};

static ssfr_result check(const ssfr_particles *particles, double radius, const ssfr_extinction_params *params)
{
    const ssfr_result result = ssfr_params_check(ssfr_extinction_rows, params, "extinction");
    if (result != SSFR_OK) return result;
    if (!(radius > 0 && isfinite(radius)))
        return ssfr_fail(SSFR_ERR_VALUE, "diffuse particles need the fluid's radius, which is %g m", radius);
    for (size_t i = 0; particles->kind && i < particles->n; i++)
        if (particles->kind[i] > SSFR_BUBBLE)
            return ssfr_fail(SSFR_ERR_VALUE, "diffuse particle %zu: kind %u is none of 0 spray, 1 foam, 2 bubble", i,
                             (unsigned)particles->kind[i]);
    return SSFR_OK;
}

/* Greys by kind; foam where kinds are not known. One colour for all needs no array. */
static ssfr_result colour_kinds(ssfr_extinction *out, const ssfr_particles *particles,
                                const ssfr_extinction_params *params)
{
    const double grey[] = {[SSFR_SPRAY] = params->spray, [SSFR_FOAM] = params->foam, [SSFR_BUBBLE] = params->bubble};
    const uint32_t *kind = particles->kind;
    const double first = grey[kind ? kind[0] : (uint32_t)SSFR_FOAM];
    for (int k = 0; k < 3; k++) out->same[k] = first;
    size_t n_same = 0;
    while (n_same < particles->n && (!kind || grey[kind[n_same]] == first)) n_same++;
    if (n_same == particles->n) return SSFR_OK;

    const ssfr_result result = ssfr_alloc(&out->colour, particles->n, sizeof *out->colour, "colours of foam");
    if (result != SSFR_OK) return result;
    for (size_t i = 0; i < particles->n; i++)
        for (int k = 0; k < 3; k++) out->colour[i][k] = grey[kind[i]];
    return SSFR_OK;
}

/* Relative to the origin before anything is rounded: packets' centres may be far away. */
static void place(const ssfr_particles *particles, const double origin[3], double (*centre)[3])
{
    for (size_t i = 0; i < particles->n; i++)
        for (size_t k = 0; k < 3; k++)
            centre[i][k] = particles->packets[i / SSFR_PACKET].centre[k] - origin[k] +
                           (double)particles->position[3 * i + k];
}

ssfr_result ssfr_extinction_init(ssfr_extinction *out, const ssfr_particles *particles, double radius,
                                 const double origin[3], const ssfr_extinction_params *params)
{
    ssfr_result result = SSFR_OK;
    double (*centre)[3] = NULL;
    const size_t n = particles ? particles->n : 0;
    *out = (ssfr_extinction){0};
    if (n > 0) {
        SSFR_TRY(check(particles, radius, params));
        SSFR_TRY(colour_kinds(out, particles, params));
    }
    SSFR_TRY(ssfr_alloc(&centre, n, sizeof *centre, "places of foam"));
    if (n > 0) place(particles, origin, centre);

    const double support = n > 0 ? params->support * radius : 1, a = n > 0 ? params->radius * radius : 0;
    const double weight = params->efficiency * M_PI * a * a / (support * support * support);
    SSFR_TRY(ssfr_continuum_init_kernels(&out->kernels, n, (const double (*)[3])centre, origin, &ssfr_radials[0],
                                         support, weight, 0.5));
end:
    free(centre);
    if (result != SSFR_OK) ssfr_extinction_finish(out);
    return result;
}

void ssfr_extinction_finish(ssfr_extinction *extinction)
{
    ssfr_continuum_finish(&extinction->kernels);
    free(extinction->colour);
    *extinction = (ssfr_extinction){0};
}
