/* SPDX-License-Identifier: MIT */
/* solid.c: the shapes of solids as signed distances, boxes around them and the places where rays enter. */
#include "scene/solid.h"

#include "scene/mesh.h"

/* ---- checking ---------------------------------------------------------------------------------------------------- */

bool ssfr_axes_are_orthonormal(const double x[3], const double y[3], const double z[3])
{
    const double *axes[3] = {x, y, z};
    bool ok = true;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k <= i; k++) ok &= fabs(ssfr_dot(axes[i], axes[k]) - (i == k)) < 1e-4; /* false for NaN */
    return ok;
}

static bool are_right_handed(const double axis[3][3])
{
    double across[3];
    ssfr_cross(axis[0], axis[1], across);
    return ssfr_dot(across, axis[2]) > 0;
}

/* How many of the half extents a shape has. */
static int n_halves(ssfr_shape shape)
{
    return shape == SSFR_BOX || shape == SSFR_CYLINDER || shape == SSFR_RAMP ? 3 : shape == SSFR_SPHERE;
}

static ssfr_result check_shape(const ssfr_solid *s, const char *what)
{
    for (int k = 0; k < n_halves(s->shape); k++)
        if (!(s->half[k] > 0 && isfinite(s->half[k])))
            return ssfr_fail(SSFR_ERR_VALUE, "%s: half extents %g,%g,%g m: they must be positive", what, s->half[0],
                             s->half[1], s->half[2]);
    if (s->shape == SSFR_CYLINDER && s->half[0] != s->half[2])
        return ssfr_fail(SSFR_ERR_VALUE, "%s: a cylinder's radius is %g m along x and %g m along z", what, s->half[0],
                         s->half[2]);
    if (s->shape == SSFR_CYLINDER && !(s->inner >= 0 && s->inner < s->half[0]))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: inner radius %g m: expected at least 0 and less than %g m", what,
                         s->inner, s->half[0]);
    return SSFR_OK;
}

ssfr_result ssfr_solid_check(const ssfr_solid *s, const char *what)
{
    if ((unsigned)s->shape > SSFR_MESH)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: shape %d: expected 0 to %d", what, (int)s->shape, SSFR_MESH);
    if (s->shape == SSFR_MESH && !s->mesh) return ssfr_fail(SSFR_ERR_VALUE, "%s: no mesh is given", what);
    if (!ssfr_all_finite(s->centre) || !ssfr_all_finite(s->colour))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: centre and colour must be finite", what);
    if (!ssfr_axes_are_orthonormal(s->axis[0], s->axis[1], s->axis[2]) ||
        !are_right_handed((const double(*)[3])s->axis))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: its axes are not orthonormal and right-handed", what);
    return check_shape(s, what);
}

/* ---- distance, in the solid's axes ------------------------------------------------------------------------------- */

/* A signed distance, m, and its unit gradient. */
typedef struct gap {
    double d, n[3];
} gap;

/* Of what two regions have in common that lie in spaces at right angles, as a disc and an interval make a cylinder:
 * exact on both sides where both gaps are. */
static gap combine(const gap *a, const gap *b)
{
    if (!(a->d > 0 && b->d > 0)) return a->d > b->d ? *a : *b;
    const double d = sqrt(a->d * a->d + b->d * b->d);
    if (d < 1e-150) return *a; /* the squares have no digits left */
    gap out = {.d = d};
    for (int k = 0; k < 3; k++) out.n[k] = (a->d * a->n[k] + b->d * b->n[k]) / d;
    return out;
}

/* |p[k]| <= half */
static gap interval(const double p[3], int k, double half)
{
    gap out = {.d = fabs(p[k]) - half};
    out.n[k] = p[k] < 0 ? -1 : 1;
    return out;
}

static gap box(const double p[3], const double half[3])
{
    const gap x = interval(p, 0, half[0]), y = interval(p, 1, half[1]), z = interval(p, 2, half[2]);
    const gap xy = combine(&x, &y);
    return combine(&xy, &z);
}

/* A disc or ring in x and z. */
static gap ring(const double p[3], double inner, double outer)
{
    const double rho = sqrt(p[0] * p[0] + p[2] * p[2]);
    const bool hole = inner > 0 && inner - rho > rho - outer;
    const double side = hole ? -1 : 1;
    gap out = {.d = hole ? inner - rho : rho - outer, .n = {side, 0, 0}};
    if (rho > 0) out.n[0] = side * p[0] / rho, out.n[2] = side * p[2] / rho;
    return out;
}

static gap cylinder(const double p[3], const double half[3], double inner)
{
    const gap round = ring(p, inner, half[0]), tall = interval(p, 1, half[1]);
    return combine(&round, &tall);
}

static gap ball(const double p[3], double radius)
{
    const double r = sqrt(ssfr_dot(p, p));
    gap out = {.d = r - radius, .n = {0, 1, 0}};
    for (int k = 0; k < 3 && r > 0; k++) out.n[k] = p[k] / r;
    return out;
}

/* The triangle (-a, -b), (a, -b), (a, b) in x and y. Outside it is nearest to the one edge that it stands before, else
 * to a corner; inside, to the nearest of the edges' lines. */
static gap triangle(const double p[3], double a, double b)
{
    const double corner[3][2] = {{-a, -b}, {a, -b}, {a, b}}, slope = sqrt(a * a + b * b);
    const double out[3][2] = {{0, -1}, {1, 0}, {-b / slope, a / slope}}, length[3] = {2 * a, 2 * b, 2 * slope};
    gap line = {.d = -INFINITY}, point = {.d = INFINITY};
    for (int i = 0; i < 3; i++) {
        const double x = p[0] - corner[i][0], y = p[1] - corner[i][1];
        const double d = x * out[i][0] + y * out[i][1], along = y * out[i][0] - x * out[i][1];
        const double r = sqrt(x * x + y * y);
        if (r == 0) return (gap){.n = {out[i][0], out[i][1], 0}};
        if (d > 0 && along >= 0 && along <= length[i]) return (gap){.d = d, .n = {out[i][0], out[i][1], 0}};
        if (d > line.d) line = (gap){.d = d, .n = {out[i][0], out[i][1], 0}};
        if (r < point.d) point = (gap){.d = r, .n = {x / r, y / r, 0}};
    }
    return line.d > 0 ? point : line;
}

static gap ramp(const double p[3], const double half[3])
{
    const gap side = triangle(p, half[0], half[1]), wide = interval(p, 2, half[2]);
    return combine(&side, &wide);
}

static gap surface(const double p[3], const ssfr_mesh *mesh)
{
    gap out;
    out.d = ssfr_mesh_distance(mesh, p, out.n);
    return out;
}

static gap distance(const ssfr_solid *s, const double p[3])
{
    switch (s->shape) {
    case SSFR_BOX: return box(p, s->half);
    case SSFR_CYLINDER: return cylinder(p, s->half, s->inner);
    case SSFR_SPHERE: return ball(p, s->half[0]);
    case SSFR_RAMP: return ramp(p, s->half);
    case SSFR_MESH: return surface(p, s->mesh);
    default: return (gap){.d = p[1], .n = {0, 1, 0}};
    }
}

static void turn_to_world(const ssfr_solid *s, const double local[3], double world[3])
{
    for (int k = 0; k < 3; k++)
        world[k] = local[0] * s->axis[0][k] + local[1] * s->axis[1][k] + local[2] * s->axis[2][k];
}

double ssfr_solid_distance(const ssfr_solid *solid, const double at[3], double normal[3])
{
    double local[3];
    ssfr_solid_local(solid, at, local);
    const gap g = distance(solid, local);
    turn_to_world(solid, g.n, normal);
    return g.d;
}

/* ---- the box around a solid -------------------------------------------------------------------------------------- */

/* A ramp reaches where the corners of its triangle do, a mesh at most where those of the box around it do. */
static void reach(const ssfr_solid *s, int k, double *lo, double *hi)
{
    const double x = s->axis[0][k], y = s->axis[1][k], z = s->axis[2][k], *h = s->half;
    const double foot = -h[0] * x - h[1] * y, heel = h[0] * x - h[1] * y;
    double most = INFINITY, least = -INFINITY;
    switch (s->shape) {
    case SSFR_BOX: most = fabs(h[0] * x) + fabs(h[1] * y) + fabs(h[2] * z), least = -most; break;
    case SSFR_CYLINDER: most = fabs(h[1] * y) + h[0] * sqrt(x * x + z * z), least = -most; break;
    case SSFR_SPHERE: most = h[0], least = -most; break;
    case SSFR_RAMP:
        most = fmax(fabs(foot), heel) + fabs(h[2] * z); /* the crest is opposite the foot */
        least = fmin(-fabs(foot), heel) - fabs(h[2] * z);
        break;
    case SSFR_MESH:
        most = least = 0;
        for (int j = 0; j < 3; j++) {
            const double a = s->axis[j][k] * s->mesh->lo[j], b = s->axis[j][k] * s->mesh->hi[j];
            most += fmax(a, b), least += fmin(a, b);
        }
        break;
    case SSFR_PLANE: break;
    }
    *lo = least, *hi = most;
}

void ssfr_solid_bounds(const ssfr_solid *solid, double lo[3], double hi[3])
{
    for (int k = 0; k < 3; k++) {
        reach(solid, k, &lo[k], &hi[k]);
        lo[k] += solid->centre[k], hi[k] += solid->centre[k];
    }
}

/* ---- rays, in the solid's axes ----------------------------------------------------------------------------------- */

/* The part of a ray in a convex region, in lengths of its direction, and the normal where it enters. */
typedef struct span {
    double enter, leave, n[3];
} span;

static const span whole = {.enter = -INFINITY, .leave = INFINITY};

/* Keeps what lies where n . p <= c; before: n . origin - c, slope: n . dir. */
static void clip(span *s, double before, double slope, const double n[3])
{
    const double t = -before / slope;
    if (slope < 0 && t > s->enter) {
        s->enter = t;
        memcpy(s->n, n, sizeof s->n);
    } else if (slope > 0) {
        s->leave = fmin(s->leave, t);
    } else if (slope == 0 && before > 0) {
        s->leave = -INFINITY;
    }
}

static void clip_interval(span *s, const double o[3], const double d[3], int k, double half)
{
    double n[3] = {0};
    n[k] = d[k] > 0 ? -1 : 1; /* the side where it enters */
    clip(s, n[k] * o[k] - half, n[k] * d[k], n);
    clip(s, -n[k] * o[k] - half, -n[k] * d[k], n);
}

/* The ray's part in the endless cylinder around y (y_too 0) or the ball (1) of a radius. Measured from where the ray is
 * nearest to the middle: there is no difference of large squares far away. */
static void clip_round(span *s, const double o[3], const double d[3], double y_too, double radius)
{
    const double dd = d[0] * d[0] + d[2] * d[2] + y_too * d[1] * d[1];
    const double middle = dd > 0 ? -(o[0] * d[0] + o[2] * d[2] + y_too * o[1] * d[1]) / dd : 0;
    const double x = o[0] + middle * d[0], y = y_too * (o[1] + middle * d[1]), z = o[2] + middle * d[2];
    const double inside = radius * radius - (x * x + y * y + z * z), half = sqrt(fmax(inside, 0) / dd);
    if (inside <= 0) {
        s->leave = -INFINITY;
    } else if (dd > 0) {
        const double t = middle - half;
        if (t > s->enter) {
            s->enter = t;
            s->n[0] = (o[0] + t * d[0]) / radius;
            s->n[1] = y_too * (o[1] + t * d[1]) / radius;
            s->n[2] = (o[2] + t * d[2]) / radius;
        }
        s->leave = fmin(s->leave, middle + half);
    }
}

/* The first t > 0 where a ray comes into a span. */
static double entry(const span *s, double n[3])
{
    memcpy(n, s->n, sizeof s->n);
    return s->enter < s->leave && s->enter > 0 ? s->enter : -1;
}

/* In the hole the ray is outside: it comes in where it enters the cylinder before the hole, or where it leaves the hole
 * while still in the cylinder. */
static double enter_tube(const span *outer, const double o[3], const double d[3], double inner, double n[3])
{
    span hole = whole;
    double t = entry(outer, n);
    clip_round(&hole, o, d, 0, inner);
    const bool through = hole.enter < hole.leave;
    if (!through || (t > 0 && (t < hole.enter || t > hole.leave))) return t;
    t = hole.leave;
    n[0] = -(o[0] + t * d[0]) / inner, n[1] = 0, n[2] = -(o[2] + t * d[2]) / inner;
    return t > 0 && t > outer->enter && t < outer->leave ? t : -1;
}

static double enter_ramp(const double half[3], span *in, const double o[3], const double d[3], double n[3])
{
    const double slope = sqrt(half[0] * half[0] + half[1] * half[1]);
    const double up[3] = {-half[1] / slope, half[0] / slope, 0};
    clip(in, ssfr_dot(up, o), ssfr_dot(up, d), up);
    return entry(in, n);
}

static double enter(const ssfr_solid *s, const double o[3], const double d[3], double n[3])
{
    static const double up[3] = {0, 1, 0};
    span in = whole;
    if (s->shape == SSFR_BOX || s->shape == SSFR_RAMP)
        for (int k = 0; k < 3; k++) clip_interval(&in, o, d, k, s->half[k]);
    if (s->shape == SSFR_CYLINDER) {
        clip_round(&in, o, d, 0, s->half[0]);
        clip_interval(&in, o, d, 1, s->half[1]);
    }
    if (s->shape == SSFR_SPHERE) clip_round(&in, o, d, 1, s->half[0]);
    if (s->shape == SSFR_PLANE) clip(&in, o[1], d[1], up);
    if (s->shape == SSFR_RAMP) return enter_ramp(s->half, &in, o, d, n);
    if (s->shape == SSFR_MESH) return ssfr_mesh_enter(s->mesh, o, d, n);
    return s->shape == SSFR_CYLINDER && s->inner > 0 ? enter_tube(&in, o, d, s->inner, n) : entry(&in, n);
}

double ssfr_solid_enter(const ssfr_solid *solid, const double origin[3], const double dir[3], double normal[3])
{
    double o[3], d[3], n[3];
    ssfr_solid_local(solid, origin, o);
    for (int k = 0; k < 3; k++) d[k] = ssfr_dot(solid->axis[k], dir);
    const double t = enter(solid, o, d, n);
    turn_to_world(solid, n, normal);
    return t;
}
