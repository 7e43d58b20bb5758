/* SPDX-License-Identifier: GPL-3.0-or-later */
/* light.c: a tree of rays through clear bodies, walked with a stack, and the account of where the light went.
 *
 * With `background` the tree is the recursion of Imai et al. 2016:
 *
 *      c = F_1 b(r_1) + (1 - F_1) c(t_1),                                                    (6)
 *      c(t_k) = F_k+1 b(r_k+1) + (1 - F_k+1) c(t_k+1),                                       (7)
 *      c(t_4) = b(t_4),                                                                      (8)
 *
 * with b the background in a direction, which no fluid and no solid hides. What differs: F is exact, where the paper
 * has Schlick's approximation, which knows no total reflection (here F = 1 then, and b(r) is all); `depth` crossings
 * are followed (path.depth=4 is eq. 8); refracted rays that meet no fluid any more see floor and solids, too; and light
 * fades inside to the medium's colour, as in the pass `composite`, where eq. 9 has black. What the paper calls its
 * limitation, that reflected rays are not followed, costs the difference between the two modes. */
#include "experiments/truth/light.h"

#include "base/param.h"

static const char *const reflections[] = {"recursive", "background", NULL};

const ssfr_param ssfr_light_rows[] = {
    SSFR_PARAM_INT(ssfr_light_params, depth, "1", SSFR_LIGHT_DEPTH, 0, SSFR_LIGHT_DEPTH,
                   "the most crossings on one path of light"),
    SSFR_PARAM_REAL(ssfr_light_params, least, "1", 1e-4, 1e-15, 0.5, "a path that carries less of the light ends"),
    SSFR_PARAM_CHOICE(ssfr_light_params, reflections, reflections, SSFR_REFLECTIONS_RECURSIVE,
                      "follow reflected rays, or take the sky in their direction (Imai 2016, eqs 6 to 8)"),
    SSFR_PARAM_END,
};

/* ---- at one crossing --------------------------------------------------------------------------------------------- */

/* Square of ratio times the cosine on the far side; negative where nothing is refracted. Without the cancellation that
 * ratio^2 - 1 has for ratios next to 1. */
static double far_square(double cosine, double ratio)
{
    return (ratio - 1) * (ratio + 1) + cosine * cosine;
}

/* r_s = (c - g) / (c + g), r_p = -r_s cos(i + t) / cos(i - t), with c and g the cosines on both sides, each times its
 * side's index over the near one's: Fresnel's equations with no difference of almost equal numbers in them. */
double ssfr_fresnel(double cosine, double ratio)
{
    const double square = far_square(cosine, ratio);
    if (ratio == 1) return 0;
    if (!(square > 0)) return 1;
    const double g = sqrt(square), sum = cosine + g, sine2 = (1 - cosine) * (1 + cosine);
    const double across = (1 - ratio) * (1 + ratio) / (sum * sum);
    const double along = across * (cosine * g - sine2) / (cosine * g + sine2);
    return fmin(0.5 * (across * across + along * along), 1);
}

bool ssfr_refract(const double dir[3], const double normal[3], double ratio, double out[3])
{
    const double cosine = ssfr_clamp(-ssfr_dot(dir, normal), 0, 1), square = far_square(cosine, ratio);
    for (int k = 0; k < 3; k++) out[k] = dir[k];
    if (ratio == 1) return true;
    if (!(square > 0)) return false;
    const double bend = (1 - ratio) * (1 + ratio) / (cosine + sqrt(square)); /* c - g */
    for (int k = 0; k < 3; k++) out[k] = (dir[k] + bend * normal[k]) / ratio;
    ssfr_normalize(out);
    return true;
}

/* Over the square of the normal, which is 1 but for rounding: else a ray that goes round in a drop would get longer at
 * each reflection, by a factor. */
void ssfr_reflect(const double dir[3], const double normal[3], double out[3])
{
    const double turn = 2 * ssfr_dot(dir, normal) / ssfr_dot(normal, normal);
    for (int k = 0; k < 3; k++) out[k] = dir[k] - turn * normal[k];
}

/* The normal against dir, and the cosine between both. Where a ray only grazes, rounding may turn a normal to the wrong
 * side: a surface that a ray crosses faces it. A normal that is none (a field without slope) is taken to be head-on. */
static double face(const double dir[3], const double normal[3], double out[3])
{
    const double square = ssfr_dot(normal, normal), side = ssfr_dot(dir, normal);
    if (!(fabs(square - 1) < 0.01)) {
        for (int k = 0; k < 3; k++) out[k] = -dir[k];
        return 1;
    }
    for (int k = 0; k < 3; k++) out[k] = side > 0 ? -normal[k] : normal[k];
    return fmin(fabs(side), 1);
}

/* ---- along one piece of the way ---------------------------------------------------------------------------------- */

typedef struct path {
    ssfr_ray ray;
    double begins;    /* m: neither the body nor what floats is met before */
    double weight[3]; /* share of the light that comes along it, by channel */
    bool inside;
    int n_crossings;  /* behind it */
} path;

typedef struct walk {
    const ssfr_refractor *body;
    const ssfr_surroundings *around;
    const ssfr_light_params *params;
    int clearest;  /* the channel with the least absorption: no channel's weight is above its */
    double range;  /* no two radiances differ by more */
    int n_waiting;
    path waiting[SSFR_LIGHT_DEPTH + 1]; /* each crossing leaves one path more, and the first makes two of one */
    ssfr_lit *lit;
} walk;

/* What a piece of the way adds, and lets through of what is behind. */
typedef struct piece {
    double colour[3], through[3];
    double err;    /* of what floats */
    double unsure; /* because it floats in water; falls with the square of the length */
} piece;

/* Water and what floats in it, on one piece. Where the things are within it is not known, but each of them has at most
 * the whole piece's water before it, and water at most all of the things: so the light F of things lies between
 * F e^(-a s) and F, that of water between c (1 - e^(-a s)) e^-tau and c (1 - e^(-a s)). The middle is taken, and half
 * the difference is a bound on its error. */
static ssfr_result fade(const walk *w, const path *p, double from, double to, piece *out)
{
    ssfr_result result = SSFR_OK;
    const ssfr_refractor *body = w->body;
    double things[3] = {0, 0, 0}, clear = 1;
    *out = (piece){0};
    if (body->between) SSFR_TRY(body->between(body->user, &p->ray, from, to, things, &clear, &out->err));
    clear = ssfr_clamp(clear, 0, 1);
    for (int k = 0; k < 3; k++) {
        const double a = p->inside ? body->absorption[k] : 0, lost = a > 0 ? -expm1(-a * (to - from)) : 0;
        const double water = lost * body->colour[k];
        out->colour[k] = things[k] * (1 - 0.5 * lost) + water * 0.5 * (1 + clear);
        out->through[k] = (1 - lost) * clear;
        out->unsure = fmax(out->unsure, 0.5 * (lost * fabs(things[k]) + water * (1 - clear)));
    }
end:
    return result;
}

/* Goes along the path to `to`, by pieces as short as what floats in water asks for, and takes along what they add. */
static ssfr_result travel(walk *w, path *p, double to)
{
    enum { PIECES = 64 };
    ssfr_result result = SSFR_OK;
    const double weight_before = p->weight[w->clearest];
    double from = p->begins, step = to;
    while (from < to) {
        piece way;
        const double weight = p->weight[w->clearest], end = to - from <= step ? to : from + step;
        SSFR_TRY(fade(w, p, from, end, &way));
        if (weight * way.unsure > w->params->least * w->range && step > to / PIECES) {
            step *= 0.5;
            continue;
        }
        for (int k = 0; k < 3; k++) {
            w->lit->colour[k] += p->weight[k] * way.colour[k];
            p->weight[k] *= way.through[k];
        }
        if (weight > 0) w->lit->err += weight * (way.err + way.unsure); /* of all that is behind nothing is seen */
        from = end, step *= 2;
    }
    w->lit->absorbed += weight_before - p->weight[w->clearest];
end:
    return result;
}

/* ---- the tree ---------------------------------------------------------------------------------------------------- */

static void add(walk *w, const path *p, const double colour[3])
{
    for (int k = 0; k < 3; k++) w->lit->colour[k] += p->weight[k] * colour[k];
    w->lit->n_paths++;
}

static void escape(walk *w, const path *p, const double colour[3])
{
    add(w, p, colour);
    w->lit->escaped += p->weight[w->clearest];
}

/* The sky is the best guess at what the path would have met. */
static void finish(walk *w, const path *p)
{
    double sky[3];
    w->around->sky(w->around->user, p->ray.dir, sky);
    add(w, p, sky);
    w->lit->ended += p->weight[w->clearest];
    w->lit->err += p->weight[w->clearest] * w->range;
}

static void go_on(walk *w, const path *p)
{
    if (p->weight[w->clearest] < w->params->least) finish(w, p);
    else w->waiting[w->n_waiting++] = *p;
}

/* Refracted rays are followed before reflected ones. */
static void cross(walk *w, const path *p, const ssfr_crossing *crossing)
{
    const double ratio = p->inside ? 1 / w->body->ior : w->body->ior;
    double normal[3], sky[3];
    const double cosine = face(p->ray.dir, crossing->normal, normal);
    path reflected = *p;
    ssfr_ray_at(&p->ray, crossing->t, reflected.ray.origin);
    reflected.begins = 0;
    reflected.n_crossings++;
    path refracted = reflected;
    refracted.inside = !p->inside;
    ssfr_reflect(p->ray.dir, normal, reflected.ray.dir);
    const double share = ssfr_refract(p->ray.dir, normal, ratio, refracted.ray.dir) ? ssfr_fresnel(cosine, ratio) : 1;
    for (int k = 0; k < 3; k++) reflected.weight[k] *= share, refracted.weight[k] *= 1 - share;
    w->lit->n_crossings++;
    if (share > 0 && w->params->reflections == SSFR_REFLECTIONS_BACKGROUND) {
        w->around->sky(w->around->user, reflected.ray.dir, sky);
        escape(w, &reflected, sky);
    } else if (share > 0) {
        go_on(w, &reflected);
    }
    if (share < 1) go_on(w, &refracted);
}

/* The first crossing before `far`. */
static ssfr_result meet(const walk *w, const path *p, double far, ssfr_crossing *crossing, bool *found)
{
    ssfr_result result = SSFR_OK;
    ssfr_ray ray = p->ray;
    *found = false;
    if (far <= p->begins) return SSFR_OK;
    ssfr_ray_at(&p->ray, p->begins, ray.origin);
    SSFR_TRY(w->body->first(w->body->user, &ray, far - p->begins, p->inside, crossing, found));
    crossing->t += p->begins;
end:
    return result;
}

static ssfr_result step(walk *w, path *p)
{
    ssfr_result result = SSFR_OK;
    double behind[3];
    ssfr_crossing crossing = {.t = 0};
    bool found;
    const double far = w->around->trace(w->around->user, &p->ray, behind);
    SSFR_TRY(meet(w, p, far, &crossing, &found));
    /* Inside without a way out, as a surface that is only touched may bring about: all that is known is the bound. */
    const bool lost = !found && p->inside && isinf(far);
    if (!lost) SSFR_TRY(travel(w, p, found ? crossing.t : far));
    if (!found && !lost) escape(w, p, behind);
    else if (lost || p->n_crossings == w->params->depth || p->weight[w->clearest] < w->params->least) finish(w, p);
    else cross(w, p, &crossing);
end:
    return result;
}

static ssfr_result check(const ssfr_refractor *body, const ssfr_light_params *params, const ssfr_ray *ray)
{
    const double length = sqrt(ssfr_dot(ray->dir, ray->dir));
    if (!(body->ior >= 1 / SSFR_LIGHT_IOR && body->ior <= SSFR_LIGHT_IOR))
        return ssfr_fail(SSFR_ERR_VALUE, "index of refraction %g: out of range [%g, %g]", body->ior, 1 / SSFR_LIGHT_IOR,
                         SSFR_LIGHT_IOR);
    for (int k = 0; k < 3; k++) {
        if (!(body->absorption[k] >= 0 && isfinite(body->absorption[k])))
            return ssfr_fail(SSFR_ERR_VALUE, "absorption of %g 1/m: it must not be negative", body->absorption[k]);
        if (!isfinite(ray->origin[k]))
            return ssfr_fail(SSFR_ERR_VALUE, "a ray from %g,%g,%g", ray->origin[0], ray->origin[1], ray->origin[2]);
    }
    if (!(fabs(length - 1) < 1e-6))
        return ssfr_fail(SSFR_ERR_VALUE, "a ray along %g,%g,%g: its direction must be of length 1", ray->dir[0],
                         ray->dir[1], ray->dir[2]);
    return ssfr_params_check(ssfr_light_rows, params, "path");
}

ssfr_result ssfr_light_follow(const ssfr_refractor *refractor, const ssfr_surroundings *around,
                              const ssfr_light_params *params, const ssfr_ray *ray, double begins, bool inside,
                              ssfr_lit *out)
{
    ssfr_result result = SSFR_OK;
    const double *a = refractor->absorption;
    walk w = {.body = refractor, .around = around, .params = params, .lit = out};
    path now = {.ray = *ray, .begins = begins, .weight = {1, 1, 1}, .inside = inside};
    *out = (ssfr_lit){0};
    SSFR_TRY(check(refractor, params, ray));
    w.range = fmax(around->brightest, refractor->brightest);
    for (int k = 0; k < 3; k++) {
        w.range = fmax(w.range, refractor->colour[k]);
        if (a[k] < a[w.clearest]) w.clearest = k;
    }
    w.range -= fmin(around->darkest, 0);
    SSFR_TRY(step(&w, &now));
    while (w.n_waiting > 0) {
        now = w.waiting[--w.n_waiting];
        SSFR_TRY(step(&w, &now));
    }
end:
    return result;
}
