/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_integrators_rays.c: the scenes of the bench of integrators, and which of their rays it takes. */
#include "experiments/bench_integrators.h"

static const double edge = 0.5;    /* of the largest density along a ray: where a region begins */
static const double sampling = 0.25; /* of a support: how far apart density is looked at for that */
enum { MAX_SAMPLES = 100000 };

/* ---- scenes ------------------------------------------------------------------------------------------------------ */

/* Foam of the scene, or else the fluid's particles taken for it. */
static ssfr_result init_foam(ssfr_study_scene *s, const ssfr_study *study)
{
    ssfr_result result = SSFR_OK;
    const ssfr_particles *fluid = s->stage->scene.particles;
    ssfr_particles lent = *fluid;
    uint32_t *kinds = NULL;
    SSFR_TRY(ssfr_alloc(&kinds, lent.n, sizeof *kinds, "kinds of particles"));
    for (size_t i = 0; i < lent.n; i++) kinds[i] = (uint32_t)(i % 3);
    lent.kind = kinds;
    SSFR_TRY(ssfr_extinction_init(&s->foam, s->stage->foam && s->stage->foam->n > 0 ? s->stage->foam : &lent,
                                  fluid->radius, s->fluid.origin, &study->extinction));
end:
    free(kinds);
    return result;
}

ssfr_result ssfr_study_scene_init(ssfr_study_scene *out, const ssfr_study *study, const char *scene, uint64_t seed)
{
    ssfr_result result = SSFR_OK;
    ssfr_stage_options options;
    *out = (ssfr_study_scene){0};
    ssfr_stage_defaults(&options);
    for (int k = 0; k < 2; k++) options.size[k] = (int)study->size[k];
    options.seed = seed;
    SSFR_TRY(ssfr_stage_create(&out->stage, scene, &options));
    SSFR_TRY(ssfr_continuum_init(&out->fluid, out->stage->scene.particles, &study->fluid, NULL));
    SSFR_TRY(init_foam(out, study));
    ssfr_line_init(&out->lines[SSFR_STUDY_DENSITY], &out->fluid);
    ssfr_line_init(&out->lines[SSFR_STUDY_RADIANCE], &out->foam.kernels);
    SSFR_TRY(ssfr_integration_create(&out->work));
end:
    if (result != SSFR_OK) ssfr_study_scene_finish(out);
    return result;
}

void ssfr_study_scene_finish(ssfr_study_scene *scene)
{
    for (int k = 0; k < SSFR_N_STUDY_INTEGRALS; k++) ssfr_line_finish(&scene->lines[k]);
    ssfr_integration_destroy(&scene->work);
    ssfr_extinction_finish(&scene->foam);
    ssfr_continuum_finish(&scene->fluid);
    ssfr_stage_destroy(&scene->stage);
    *scene = (ssfr_study_scene){0};
}

double ssfr_study_unit(const ssfr_study_scene *scene, ssfr_study_integral integral)
{
    return integral == SSFR_STUDY_DENSITY ? 2 * scene->stage->scene.particles->radius : 1;
}

bool ssfr_study_clip(const ssfr_line *line, double *a, double *b)
{
    *a = line->n > 0 ? line->kernels[0].enters : 0;
    *b = *a;
    for (size_t i = 0; i < line->n; i++) *b = fmax(*b, line->kernels[i].leaves);
    return *a < *b;
}

/* ---- candidates -------------------------------------------------------------------------------------------------- */

/* Through the middle of a random pixel, as the camera looks. */
static ssfr_ray random_ray(const ssfr_study_scene *s, uint64_t bits)
{
    const ssfr_camera *c = &s->stage->scene.camera;
    const int x = (int)(bits % (uint64_t)c->w), y = (int)((bits >> 32) % (uint64_t)c->h);
    const double u = (2 * x + 1 - c->w) * c->tan_x / c->w, v = (c->h - 1 - 2 * y) * c->tan_y / c->h;
    ssfr_ray ray;
    for (int k = 0; k < 3; k++) {
        ray.origin[k] = c->eye[k] - s->fluid.origin[k];
        ray.dir[k] = u * c->right[k] + v * c->up[k] - c->back[k];
    }
    ssfr_normalize(ray.dir);
    return ray;
}

/* How often the density rises above `edge` of its largest. */
static double count_regions(const ssfr_line *line, double a, double b, double *densities)
{
    const size_t n = (size_t)ssfr_clamp((b - a) / (sampling * line->fluid->support), 1, MAX_SAMPLES);
    double largest = 0;
    size_t regions = 0;
    for (size_t i = 0; i < n; i++) {
        densities[i] = ssfr_line_density(line, a + (b - a) * ((double)i + 0.5) / (double)n);
        largest = fmax(largest, densities[i]);
    }
    for (size_t i = 0; i < n; i++)
        regions += densities[i] > edge * largest && (i == 0 || densities[i - 1] <= edge * largest);
    return (double)regions;
}

ssfr_result ssfr_study_survey(ssfr_study_scene *scene, const ssfr_study *study, ssfr_study_integral integral,
                              uint64_t seed, size_t *n, ssfr_study_ray **candidates)
{
    ssfr_result result = SSFR_OK;
    ssfr_line *line = &scene->lines[integral];
    double *densities = NULL, a, b;
    *n = 0;
    *candidates = NULL;
    SSFR_TRY(ssfr_alloc(&densities, MAX_SAMPLES, sizeof *densities, "densities along a ray"));
    SSFR_TRY(ssfr_alloc(candidates, study->candidates, sizeof **candidates, "rays"));
    for (size_t i = 0; i < study->candidates; i++) {
        double from = 0, to = INFINITY;
        ssfr_study_ray *ray = *candidates + *n;
        *ray = (ssfr_study_ray){.ray = random_ray(scene, ssfr_mix_bits(ssfr_mix_bits(seed) + i))};
        if (!ssfr_boxes_clip(&line->fluid->boxes, &ray->ray, &from, &to)) continue;
        SSFR_TRY(ssfr_line_cast(line, &ray->ray, 0, INFINITY));
        ray->n_kernels = line->n;
        if (ssfr_study_clip(line, &a, &b)) {
            ray->content = ssfr_line_chords(line, a, b, NULL) / ssfr_study_unit(scene, integral);
            ray->regions = count_regions(line, a, b, densities);
        }
        ++*n;
    }
end:
    free(densities);
    return result;
}

/* ---- choosing ---------------------------------------------------------------------------------------------------- */

static bool is_within(double v, const double range[2])
{
    return v >= range[0] && v <= range[1];
}

/* The ray that comes after the last of those chosen: in the order of the candidates, or of their kernels. */
static const ssfr_study_ray *next_of(const ssfr_ray_kind *kind, size_t n, const ssfr_study_ray *candidates,
                                     const ssfr_study_ray *last)
{
    const ssfr_study_ray *next = NULL;
    for (const ssfr_study_ray *ray = candidates; ray < candidates + n; ray++) {
        if (!is_within(ray->content, kind->content) || !is_within(ray->regions, kind->regions)) continue;
        const bool after = !last || (kind->most ? ray->n_kernels < last->n_kernels : ray > last) ||
                           (kind->most && ray->n_kernels == last->n_kernels && ray > last);
        if (after && (!next || (kind->most && ray->n_kernels > next->n_kernels))) next = ray;
    }
    return next;
}

ssfr_result ssfr_study_choose(const ssfr_ray_kind *kind, size_t n, const ssfr_study_ray *candidates,
                              size_t *n_chosen, ssfr_study_ray *rays)
{
    const ssfr_study_ray *last = NULL;
    *n_chosen = 0;
    while (*n_chosen < kind->count && (last = next_of(kind, n, candidates, last))) rays[(*n_chosen)++] = *last;
    if (*n_chosen > 0) return SSFR_OK;
    return ssfr_fail(SSFR_ERR_VALUE, "none of %zu rays that meet the particles is %s", n, kind->name);
}
