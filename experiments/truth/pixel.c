/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pixel.c: one ray, and what it tells: surface, lengths, foam, light. */
#include "experiments/truth/pixel.h"

#include "scene/solid.h"

#include <float.h>

/* A pixel's ray: t is the distance to the eye, and begins at the near plane. */
typedef struct view {
    ssfr_ray ray;
    double cosine;      /* between the ray and the view's axis */
    double near, hidden; /* m: t of the near plane, and of the first solid or the floor; infinite for none that hides */
} view;

/* ---- what all rays have in common -------------------------------------------------------------------------------- */

ssfr_result ssfr_truth_scene_init(ssfr_truth_scene *out, const ssfr_stage *stage, const ssfr_truth_params *params,
                                  const ssfr_tiles *tiles)
{
    ssfr_result result = SSFR_OK;
    const ssfr_scene *scene = &stage->scene;
    *out = (ssfr_truth_scene){.params = params, .tiles = tiles, .scene = scene};
    out->hides = params->cast.solids || params->cast.parts & SSFR_TRUTH_FOAM;
    SSFR_TRY(ssfr_continuum_init(&out->fluid, scene->particles, &params->fluid, &params->anisotropy));
    SSFR_TRY(ssfr_extinction_init(&out->foam, stage->foam, scene->particles->radius, out->fluid.origin,
                                  &params->extinction));
    SSFR_TRY(ssfr_surroundings_create(&out->around, scene, &params->world, out->fluid.origin));
    for (int k = 0; k < 3; k++) out->eye[k] = scene->camera.eye[k] - out->fluid.origin[k];
end:
    return result;
}

void ssfr_truth_scene_finish(ssfr_truth_scene *scene)
{
    ssfr_surroundings_destroy(&scene->around);
    ssfr_extinction_finish(&scene->foam);
    ssfr_continuum_finish(&scene->fluid);
}

static ssfr_integrate_params integrate_params(const ssfr_truth_cast_params *p)
{
    return (ssfr_integrate_params){.eps_abs = p->eps_abs, .eps_rel = p->eps_rel, .points = p->points,
                                   .steps = p->steps};
}

ssfr_result ssfr_truth_worker_init(ssfr_truth_worker *out, const ssfr_truth_scene *scene)
{
    ssfr_result result = SSFR_OK;
    const ssfr_truth_params *p = scene->params;
    *out = (ssfr_truth_worker){.scene = scene};
    ssfr_line_init(&out->fluid, &scene->fluid);
    ssfr_line_init(&out->foam, &scene->foam.kernels);
    SSFR_TRY(ssfr_crossings_init(&out->crossings));
    SSFR_TRY(ssfr_integration_create(&out->integration));
    if (p->cast.parts & SSFR_TRUTH_COLOUR) {
        const ssfr_integrate_params integrals = integrate_params(&p->cast);
        SSFR_TRY(ssfr_fluid_light_create(&out->light, &scene->fluid, &scene->foam, &p->world.medium,
                                         (ssfr_integrator_id)p->cast.integrator, &integrals));
    }
end:
    if (result != SSFR_OK) ssfr_truth_worker_finish(out);
    return result;
}

void ssfr_truth_worker_finish(ssfr_truth_worker *worker)
{
    ssfr_fluid_light_destroy(&worker->light);
    ssfr_integration_destroy(&worker->integration);
    ssfr_crossings_finish(&worker->crossings);
    ssfr_line_finish(&worker->foam);
    ssfr_line_finish(&worker->fluid);
}

/* ---- the ray ----------------------------------------------------------------------------------------------------- */

/* t of the first solid or the floor. */
static double find_solid(const ssfr_truth_scene *s, const ssfr_ray *ray)
{
    const ssfr_scene *scene = s->scene;
    const double above = scene->camera.eye[1] - scene->floor; /* infinite without a floor */
    double nearest = INFINITY;
    if (above * ray->dir[1] < 0) nearest = -above / ray->dir[1];
    for (int i = 0; i < scene->n_solids; i++) {
        ssfr_solid solid = scene->solids[i];
        double normal[3];
        for (int k = 0; k < 3; k++) solid.centre[k] -= s->fluid.origin[k];
        const double t = ssfr_solid_enter(&solid, ray->origin, ray->dir, normal);
        if (t > 0 && t < nearest) nearest = t;
    }
    return nearest;
}

static view look_through(const ssfr_truth_scene *s, int x, int y)
{
    const ssfr_camera *c = &s->scene->camera;
    const double u = (2 * x + 1 - c->w) * c->tan_x / c->w, v = (c->h - 1 - 2 * y) * c->tan_y / c->h;
    const double length = sqrt(1 + u * u + v * v);
    view out = {.cosine = 1 / length, .near = c->near * length};
    for (int k = 0; k < 3; k++) {
        out.ray.origin[k] = s->eye[k];
        out.ray.dir[k] = (u * c->right[k] + v * c->up[k] - c->back[k]) / length;
    }
    ssfr_normalize(out.ray.dir); /* the camera's axes are so only up to a float's rounding, perhaps */
    out.hidden = s->hides ? find_solid(s, &out.ray) : INFINITY;
    return out;
}

/* ---- surface and lengths ----------------------------------------------------------------------------------------- */

/* A touch nearer than the crossing may be the surface instead. */
static void tell_surface(const ssfr_truth_worker *w, const view *v, const ssfr_crossing *first, double *values)
{
    const int *at = w->scene->tiles->at;
    const ssfr_camera *c = &w->scene->scene->camera;
    const double side = first->enters ? 1 : -1, z = -first->t * v->cosine, touch = w->crossings.touch;
    const bool doubtful = touch < first->t;
    double *normal = values + at[SSFR_TRUTH_normal];
    values[at[SSFR_TRUTH_depth]] = z;
    values[at[SSFR_TRUTH_depth_err]] =
        first->t_err * v->cosine + 4 * DBL_EPSILON * fabs(z) + (doubtful ? (first->t - touch) * v->cosine : 0);
    normal[0] = side * ssfr_dot(c->right, first->normal);
    normal[1] = side * ssfr_dot(c->up, first->normal);
    normal[2] = side * ssfr_dot(c->back, first->normal);
    values[at[SSFR_TRUTH_normal_err]] = doubtful ? M_PI : fmin(first->normal_err + 4 * DBL_EPSILON, M_PI);
}

/* Only a touch tells of a surface, or none does. */
static void tell_no_surface(const ssfr_truth_worker *w, double *values)
{
    const int *at = w->scene->tiles->at;
    if (!isfinite(w->crossings.touch)) return;
    values[at[SSFR_TRUTH_depth_err]] = SSFR_EMPTY;
    values[at[SSFR_TRUTH_normal_err]] = M_PI;
}

/* Of the way from the line's from to its to, where that is finite. */
static void tell_length(const ssfr_truth_worker *w, double *values)
{
    const int *at = w->scene->tiles->at;
    const ssfr_crossings *c = &w->crossings;
    double length = 0, err = c->touched, entered = w->fluid.from;
    bool inside = c->begins_inside;
    for (size_t i = 0; i < c->n; i++) {
        if (inside) length += c->items[i].t - entered;
        entered = c->items[i].t;
        inside = c->items[i].enters;
        err += c->items[i].t_err;
    }
    if (inside && isfinite(w->fluid.to)) length += w->fluid.to - entered;
    values[at[SSFR_TRUTH_thickness]] = length;
    values[at[SSFR_TRUTH_thickness_err]] = err + DBL_EPSILON * (double)(c->n + 1) * length;
    values[at[SSFR_TRUTH_crossings]] = (double)c->n;
}

/* ---- content ----------------------------------------------------------------------------------------------------- */

static double density_at(double t, void *user)
{
    return ssfr_line_density(user, t);
}

/* The part of the line that anything reaches: its own may be infinite. */
static bool clip_line(const ssfr_line *line, double *a, double *b)
{
    *a = fmax(line->from, line->n ? line->kernels[0].enters : INFINITY);
    *b = -INFINITY;
    for (size_t i = 0; i < line->n; i++) *b = fmax(*b, line->kernels[i].leaves);
    *b = fmin(*b, line->to);
    return *a < *b;
}

static ssfr_result integrate(ssfr_truth_worker *w, ssfr_integrator_id id, double a, double b, ssfr_integral *out)
{
    ssfr_result result = SSFR_OK;
    const ssfr_integrate_params params = integrate_params(&w->scene->params->cast);
    ssfr_integrand integrand = {.value = density_at, .user = &w->fluid};
    SSFR_TRY(ssfr_line_breaks(&w->fluid, a, b, &integrand.n_breaks, &integrand.breaks));
    SSFR_TRY(ssfr_integrate(w->integration, id, &integrand, &params, out));
    out->err += w->fluid.hidden;
end:
    return result;
}

/* Holds the closed form against GSL's integral. */
static ssfr_result judge(ssfr_truth_worker *w, double a, double b, const ssfr_integral *closed,
                         ssfr_truth_tally *tally)
{
    ssfr_integral other;
    const ssfr_result result = integrate(w, SSFR_INTEGRATOR_qagp, a, b, &other);
    if (result != SSFR_OK) return result;
    const double difference = fabs(other.value - closed->value), allowed = other.err + closed->err;
    tally->judged++;
    tally->judged_max = fmax(tally->judged_max, difference);
    if (difference > 0) tally->judged_ratio = fmax(tally->judged_ratio, difference / fmax(allowed, DBL_MIN));
    return SSFR_OK;
}

/* A share of the pixels, evenly spread: x / g + y / g^2 with g^3 = g + 1 fills the unit interval evenly, over any part
 * of the image (Roberts 2018). */
static bool is_judged(const ssfr_truth_cast_params *p, int x, int y)
{
    const double u = 0.7548776662466927 * x + 0.5698402909980532 * y;
    return p->integrator == SSFR_INTEGRATOR_chords && u - floor(u) < p->judged;
}

static ssfr_result tell_content(ssfr_truth_worker *w, int x, int y, double *values, ssfr_truth_tally *tally)
{
    ssfr_result result = SSFR_OK;
    const ssfr_truth_cast_params *p = &w->scene->params->cast;
    const int *at = w->scene->tiles->at;
    ssfr_integral integral = {0};
    double a, b;
    values[at[SSFR_TRUTH_content_err]] = w->fluid.hidden; /* what may be met, just so, where nothing seems to be */
    if (!clip_line(&w->fluid, &a, &b)) return SSFR_OK;
    if (p->integrator == SSFR_INTEGRATOR_chords)
        integral.value = ssfr_line_chords(&w->fluid, a, b, &integral.err);
    else
        SSFR_TRY(integrate(w, (ssfr_integrator_id)p->integrator, a, b, &integral));
    values[at[SSFR_TRUTH_content]] = integral.value;
    values[at[SSFR_TRUTH_content_err]] = integral.err;
    if (is_judged(p, x, y)) SSFR_TRY(judge(w, a, b, &integral, tally));
end:
    return result;
}

static ssfr_result tell_fluid(ssfr_truth_worker *w, const view *v, int x, int y, double *values,
                              ssfr_truth_tally *tally)
{
    ssfr_result result = SSFR_OK;
    const unsigned parts = w->scene->params->cast.parts;
    const double to = w->scene->params->cast.solids ? v->hidden : INFINITY;
    if (to <= v->near) return SSFR_OK;
    SSFR_TRY(ssfr_line_cast(&w->fluid, &v->ray, v->near, to));
    SSFR_TRY(ssfr_crossings_find(&w->crossings, &w->fluid));
    tally->crossings += w->crossings.n;
    tally->touches += w->crossings.n_touches;
    if (parts & SSFR_TRUTH_SURFACE && w->crossings.n)
        tell_surface(w, v, &w->crossings.items[0], values);
    else if (parts & SSFR_TRUTH_SURFACE)
        tell_no_surface(w, values);
    if (!(parts & SSFR_TRUTH_THICKNESS)) goto end;
    tell_length(w, values);
    SSFR_TRY(tell_content(w, x, y, values, tally));
end:
    return result;
}

/* ---- foam -------------------------------------------------------------------------------------------------------- */

static ssfr_result tell_foam(ssfr_truth_worker *w, const view *v, double *values)
{
    ssfr_result result = SSFR_OK;
    const int *at = w->scene->tiles->at;
    const ssfr_integrate_params params = integrate_params(&w->scene->params->cast);
    ssfr_radiance radiance;
    double a, b;
    if (w->scene->foam.kernels.n == 0 || v->hidden <= v->near) return SSFR_OK;
    SSFR_TRY(ssfr_line_cast(&w->foam, &v->ray, v->near, v->hidden));
    if (!clip_line(&w->foam, &a, &b)) goto end;
    SSFR_TRY(ssfr_radiance_collect(&w->scene->foam, &w->foam, w->integration,
                                   (ssfr_integrator_id)w->scene->params->cast.integrator, &params, a, b, &radiance));
    memcpy(values + at[SSFR_TRUTH_foam], radiance.colour, sizeof radiance.colour);
    values[at[SSFR_TRUTH_foam] + 3] = 1 - radiance.transmittance;
    values[at[SSFR_TRUTH_foam_err]] = radiance.err;
end:
    return result;
}

/* ---- light ------------------------------------------------------------------------------------------------------- */

/* Fluid begins at the near plane, be that inside of it or not. */
static ssfr_result tell_colour(ssfr_truth_worker *w, const view *v, double *values, ssfr_truth_tally *tally)
{
    ssfr_result result = SSFR_OK;
    const int *at = w->scene->tiles->at;
    const size_t touches = ssfr_fluid_light_touches(w->light);
    ssfr_lit lit;
    bool inside;
    double near[3];
    ssfr_ray_at(&v->ray, v->near, near);
    SSFR_TRY(ssfr_crossings_inside(&w->crossings, &w->fluid, near, &inside));
    SSFR_TRY(ssfr_light_follow(ssfr_fluid_light_refractor(w->light), w->scene->around, &w->scene->params->path,
                               &v->ray, v->near, inside, &lit));
    tally->light_touches += ssfr_fluid_light_touches(w->light) - touches;
    memcpy(values + at[SSFR_TRUTH_colour], lit.colour, sizeof lit.colour);
    values[at[SSFR_TRUTH_colour_err]] = lit.err;
end:
    return result;
}

/* ---- all --------------------------------------------------------------------------------------------------------- */

/* A bound that is infinite, as of an integral that did not converge, says that nothing is known; files hold numbers. */
static ssfr_result check_values(const ssfr_tiles *tiles, int x, int y, double *values)
{
    for (int i = 0; i < SSFR_N_TRUTH_CHANNELS; i++)
        for (int k = 0; tiles->at[i] >= 0 && k < ssfr_truth_channels[i].n; k++) {
            double *value = &values[tiles->at[i] + k];
            if (*value == INFINITY) *value = SSFR_EMPTY;
            if (!isfinite(*value))
                return ssfr_fail(SSFR_ERR_VALUE, "pixel %d,%d: %s is %g", x, y, ssfr_truth_channels[i].name, *value);
        }
    return SSFR_OK;
}

ssfr_result ssfr_truth_pixel(ssfr_truth_worker *worker, int x, int y, double *values, ssfr_truth_tally *tally)
{
    ssfr_result result = SSFR_OK;
    const ssfr_truth_scene *s = worker->scene;
    const unsigned parts = s->params->cast.parts;
    const view v = look_through(s, x, y);
    memcpy(values, s->tiles->empty, (size_t)s->tiles->n_values * sizeof *values);
    tally->rays++;
    if (parts & (SSFR_TRUTH_SURFACE | SSFR_TRUTH_THICKNESS)) SSFR_TRY(tell_fluid(worker, &v, x, y, values, tally));
    if (parts & SSFR_TRUTH_FOAM) SSFR_TRY(tell_foam(worker, &v, values));
    if (parts & SSFR_TRUTH_COLOUR) SSFR_TRY(tell_colour(worker, &v, values, tally));
    SSFR_TRY(check_values(s->tiles, x, y, values));
end:
    return result;
}
