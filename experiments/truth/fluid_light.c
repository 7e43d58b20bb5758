/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fluid_light.c: the continuous fluid, and what floats in and over it, as the body that light goes through. */
#include "experiments/truth/fluid_light.h"

struct ssfr_fluid_light {
    ssfr_refractor refractor;
    ssfr_line line;            /* through the fluid */
    ssfr_crossings crossings;
    size_t n_touches;
    const ssfr_extinction *floating;
    ssfr_line through;         /* what floats */
    ssfr_ray cast;             /* the ray of `through`, from 0 to cast_to; 0 when there is none */
    double cast_to;            /* m */
    ssfr_integration *work;
    ssfr_integrator_id integrator;
    ssfr_integrate_params params;
};

static ssfr_result first(void *user, const ssfr_ray *ray, double to, bool inside, ssfr_crossing *out, bool *found)
{
    ssfr_fluid_light *light = user;
    const ssfr_result result = ssfr_crossings_first(&light->crossings, &light->line, ray, to, inside, out, found);
    light->n_touches += light->crossings.n_touches;
    return result;
}

/* The way to a crossing is asked for as a whole first and then perhaps in pieces: its line is cast once. */
static ssfr_result cast(ssfr_fluid_light *light, const ssfr_ray *ray, double to)
{
    if (to <= light->cast_to && memcmp(ray, &light->cast, sizeof *ray) == 0) return SSFR_OK;
    light->cast_to = 0;
    const ssfr_result result = ssfr_line_cast(&light->through, ray, 0, to);
    if (result == SSFR_OK) light->cast = *ray, light->cast_to = to;
    return result;
}

static ssfr_result between(void *user, const ssfr_ray *ray, double from, double to, double colour[3],
                           double *transmittance, double *err)
{
    ssfr_result result = SSFR_OK;
    ssfr_fluid_light *light = user;
    ssfr_radiance radiance;
    SSFR_TRY(cast(light, ray, to));
    SSFR_TRY(ssfr_radiance_collect(light->floating, &light->through, light->work, light->integrator, &light->params,
                                   from, to, &radiance));
    for (int k = 0; k < 3; k++) colour[k] = radiance.colour[k];
    *transmittance = radiance.transmittance, *err = radiance.err;
end:
    return result;
}

static double brightest(const ssfr_extinction *floating)
{
    double most = fmax(floating->same[0], fmax(floating->same[1], floating->same[2]));
    for (size_t i = 0; floating->colour && i < floating->kernels.n; i++)
        for (int k = 0; k < 3; k++) most = fmax(most, floating->colour[i][k]);
    return most;
}

ssfr_result ssfr_fluid_light_create(ssfr_fluid_light **out, const ssfr_continuum *fluid,
                                    const ssfr_extinction *floating, const ssfr_medium *medium,
                                    ssfr_integrator_id integrator, const ssfr_integrate_params *params)
{
    ssfr_result result = SSFR_OK;
    ssfr_fluid_light *light = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&light, 1, sizeof *light, "a fluid's light"));
    light->refractor = (ssfr_refractor){
        .user = light, .first = first, .ior = medium->ior,
        .absorption = {medium->absorption_r, medium->absorption_g, medium->absorption_b},
        .colour = {medium->color_r, medium->color_g, medium->color_b}};
    ssfr_line_init(&light->line, fluid);
    SSFR_TRY(ssfr_crossings_init(&light->crossings));
    if (floating && floating->kernels.n > 0) {
        light->floating = floating, light->integrator = integrator, light->params = *params;
        light->refractor.between = between, light->refractor.brightest = brightest(floating);
        ssfr_line_init(&light->through, &floating->kernels);
        SSFR_TRY(ssfr_integration_create(&light->work));
    }
    *out = light;
    light = NULL;
end:
    ssfr_fluid_light_destroy(&light);
    return result;
}

void ssfr_fluid_light_destroy(ssfr_fluid_light **light)
{
    if (*light) {
        ssfr_line_finish(&(*light)->line);
        ssfr_line_finish(&(*light)->through);
        ssfr_crossings_finish(&(*light)->crossings);
        ssfr_integration_destroy(&(*light)->work);
    }
    free(*light);
    *light = NULL;
}

const ssfr_refractor *ssfr_fluid_light_refractor(const ssfr_fluid_light *light)
{
    return &light->refractor;
}

size_t ssfr_fluid_light_touches(const ssfr_fluid_light *light)
{
    return light->n_touches;
}
