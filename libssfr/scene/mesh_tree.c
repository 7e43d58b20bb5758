/* SPDX-License-Identifier: MIT */
/* mesh_tree.c: the tree of boxes over a mesh's triangles: the nearest of them to a place, the first along a ray. */
#include "scene/mesh.h"

/* ---- growing ----------------------------------------------------------------------------------------------------- */

enum { MAX_DEPTH = 32, MAX_WAITING = MAX_DEPTH + 32 }; /* by planes; with what halving adds for 2^28 triangles */

typedef struct growth {
    ssfr_mesh *mesh;
    uint32_t *order;     /* triangles */
    double (*middle)[3]; /* m, of the box of each */
    double margin;       /* m, by which boxes are larger than what is in them: over what floats round */
} growth;

static void bound(const growth *g, size_t begin, size_t end, ssfr_mesh_node *node)
{
    for (int k = 0; k < 3; k++) {
        double lo = INFINITY, hi = -INFINITY;
        for (size_t i = begin; i < end; i++)
            for (int j = 0; j < 3; j++) {
                const double v = g->mesh->triangles[g->order[i]].corner[j][k];
                lo = fmin(lo, v), hi = fmax(hi, v);
            }
        node->lo[k] = (float)(lo - g->margin - g->mesh->middle[k]);
        node->hi[k] = (float)(hi + g->margin - g->mesh->middle[k]);
    }
}

/* Where to part triangles in two: those whose middle lies below the plane come first. */
typedef struct cut {
    int axis;
    double at;   /* m */
    double cost; /* what it leaves to be searched: surfaces times triangles, m^2 */
} cut;

typedef struct bin {
    size_t n;
    double lo[3], hi[3];
} bin;

static const bin empty = {.lo = {INFINITY, INFINITY, INFINITY}, .hi = {-INFINITY, -INFINITY, -INFINITY}};

static void add_bin(bin *to, const bin *b)
{
    to->n += b->n;
    for (int k = 0; k < 3; k++) to->lo[k] = fmin(to->lo[k], b->lo[k]), to->hi[k] = fmax(to->hi[k], b->hi[k]);
}

static double cost_of(const bin *b)
{
    const double x = b->hi[0] - b->lo[0], y = b->hi[1] - b->lo[1], z = b->hi[2] - b->lo[2];
    return b->n ? (double)b->n * (x * y + y * z + z * x) : 0;
}

enum { N_BINS = 16 };

/* Sorts the triangles' boxes into bins along an axis by their middles, from lo to hi. */
static void fill_bins(const growth *g, size_t begin, size_t end, int axis, double lo, double hi, bin bins[N_BINS])
{
    for (int i = 0; i < N_BINS; i++) bins[i] = empty;
    for (size_t i = begin; i < end; i++) {
        const uint32_t t = g->order[i];
        const int k = ssfr_min_int((int)(N_BINS * (g->middle[t][axis] - lo) / (hi - lo)), N_BINS - 1);
        bin one = {.n = 1};
        for (int j = 0; j < 3; j++) {
            const double(*c)[3] = (const double(*)[3])g->mesh->triangles[t].corner;
            one.lo[j] = fmin(fmin(c[0][j], c[1][j]), c[2][j]), one.hi[j] = fmax(fmax(c[0][j], c[1][j]), c[2][j]);
        }
        add_bin(&bins[k], &one);
    }
}

/* The surface area heuristic: a ray, or a ball, meets a box as often as its surface is large. */
static void try_axis(const growth *g, size_t begin, size_t end, int axis, cut *best)
{
    bin bins[N_BINS], after[N_BINS], before = empty;
    double lo = INFINITY, hi = -INFINITY;
    for (size_t i = begin; i < end; i++)
        lo = fmin(lo, g->middle[g->order[i]][axis]), hi = fmax(hi, g->middle[g->order[i]][axis]);
    if (!(hi > lo)) return;
    fill_bins(g, begin, end, axis, lo, hi, bins);
    after[N_BINS - 1] = bins[N_BINS - 1];
    for (int i = N_BINS - 2; i > 0; i--) after[i] = bins[i], add_bin(&after[i], &after[i + 1]);
    for (int i = 1; i < N_BINS; i++) {
        add_bin(&before, &bins[i - 1]);
        const double cost = cost_of(&before) + cost_of(&after[i]);
        if (before.n && after[i].n && cost < best->cost) *best = (cut){axis, lo + (hi - lo) * i / N_BINS, cost};
    }
}

/* Puts the triangles below the cut first and gives where the others begin. */
static size_t part(const growth *g, size_t begin, size_t end, const cut *cut)
{
    size_t at = begin;
    for (size_t i = begin; i < end; i++) {
        const uint32_t t = g->order[i];
        if (!(g->middle[t][cut->axis] < cut->at)) continue;
        g->order[i] = g->order[at];
        g->order[at++] = t;
    }
    return at;
}

/* Where no plane parts them, or the tree would get too deep, they are halved by number. */
static void grow(const growth *g, size_t begin, size_t end, int depth)
{
    ssfr_mesh *mesh = g->mesh;
    ssfr_mesh_node *node = mesh->nodes + mesh->n_nodes++;
    bound(g, begin, end, node);
    if (end - begin <= SSFR_MESH_LEAF) {
        node->leaf = (uint32_t)(8 * begin + (end - begin));
    } else {
        cut best = {.cost = INFINITY};
        for (int axis = 0; axis < 3 && depth < MAX_DEPTH; axis++) try_axis(g, begin, end, axis, &best);
        size_t middle = isfinite(best.cost) ? part(g, begin, end, &best) : begin;
        if (middle == begin || middle == end) middle = begin + (end - begin) / 2;
        grow(g, begin, middle, depth + 1);
        grow(g, middle, end, depth + 1);
    }
    node->skip = (uint32_t)mesh->n_nodes;
}

/* Puts the triangles into the leaves' order. */
static ssfr_result sort(const growth *g)
{
    ssfr_result result = SSFR_OK;
    ssfr_mesh *mesh = g->mesh;
    ssfr_mesh_triangle *triangles = NULL;
    ssfr_mesh_normals *normals = NULL;
    SSFR_TRY(ssfr_alloc(&triangles, mesh->n_triangles, sizeof *triangles, "triangles"));
    SSFR_TRY(ssfr_alloc(&normals, mesh->n_triangles, sizeof *normals, "normals"));
    for (size_t i = 0; i < mesh->n_triangles; i++)
        triangles[i] = mesh->triangles[g->order[i]], normals[i] = mesh->normals[g->order[i]];
    free(mesh->triangles), free(mesh->normals);
    mesh->triangles = triangles, mesh->normals = normals;
    triangles = NULL, normals = NULL;
end:
    free(triangles), free(normals);
    return result;
}

ssfr_result ssfr_mesh_grow_tree(ssfr_mesh *mesh)
{
    ssfr_result result = SSFR_OK;
    growth g = {.mesh = mesh};
    for (int k = 0; k < 3; k++) g.margin = fmax(g.margin, 1e-6 * (mesh->hi[k] - mesh->lo[k]));
    SSFR_TRY(ssfr_alloc(&g.order, mesh->n_triangles, sizeof *g.order, "the triangles' order"));
    SSFR_TRY(ssfr_alloc(&g.middle, mesh->n_triangles, sizeof *g.middle, "the triangles' middles"));
    SSFR_TRY(ssfr_alloc(&mesh->nodes, 2 * mesh->n_triangles, sizeof *mesh->nodes, "a tree"));
    for (size_t i = 0; i < mesh->n_triangles; i++) {
        const double(*c)[3] = (const double(*)[3])mesh->triangles[i].corner;
        g.order[i] = (uint32_t)i;
        for (int k = 0; k < 3; k++)
            g.middle[i][k] = 0.5 * (fmin(fmin(c[0][k], c[1][k]), c[2][k]) + fmax(fmax(c[0][k], c[1][k]), c[2][k]));
    }
    grow(&g, 0, mesh->n_triangles, 0);
    SSFR_TRY(sort(&g));
end:
    free(g.order), free(g.middle);
    return result;
}

/* ---- the nearest triangle ---------------------------------------------------------------------------------------- */

/* What of a triangle a place is nearest to, and where. */
typedef enum feature { FACE, EDGE, CORNER = EDGE + 3 } feature;
typedef struct nearest {
    double square; /* m^2 */
    size_t triangle;
    int feature;   /* EDGE + k, CORNER + k */
    double at[3];  /* m */
} nearest;

static void subtract(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++) out[k] = a[k] - b[k];
}

/* The regions of Ericson, Real-Time Collision Detection (2005), sec. 5.1.5. Gives the corner where the nearest point's
 * way begins, and how far it goes along the side from there to the next corner; `face` when it is on neither. */
static int region(const double c[3][3], const double p[3], int *from, double *along)
{
    double ab[3], ac[3], ap[3], bp[3], cp[3];
    subtract(c[1], c[0], ab), subtract(c[2], c[0], ac);
    subtract(p, c[0], ap), subtract(p, c[1], bp), subtract(p, c[2], cp);
    const double d1 = ssfr_dot(ab, ap), d2 = ssfr_dot(ac, ap), d3 = ssfr_dot(ab, bp), d4 = ssfr_dot(ac, bp);
    const double d5 = ssfr_dot(ab, cp), d6 = ssfr_dot(ac, cp);
    const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    *along = 0;
    if (d1 <= 0 && d2 <= 0) return *from = 0, CORNER;
    if (d3 >= 0 && d4 <= d3) return *from = 1, CORNER + 1;
    if (d6 >= 0 && d5 <= d6) return *from = 2, CORNER + 2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return *from = 0, *along = d1 / (d1 - d3), EDGE;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return *from = 1, *along = (d4 - d3) / (d4 - d3 + d5 - d6), EDGE + 1;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return *from = 2, *along = d6 / (d6 - d2), EDGE + 2;
    return *from = 0, FACE;
}

static void try_triangle(const ssfr_mesh *mesh, size_t i, const double p[3], nearest *best)
{
    const ssfr_mesh_triangle *triangle = mesh->triangles + i;
    const double(*c)[3] = triangle->corner;
    nearest found = {.triangle = i};
    double along, to[3];
    int from;
    subtract(p, c[0], to);
    const double height = ssfr_dot(triangle->normal, to);
    if (height * height >= best->square) return; /* no point of its plane is nearer */
    found.feature = region(c, p, &from, &along);
    if (found.feature == FACE) {
        for (int k = 0; k < 3; k++) found.at[k] = p[k] - height * triangle->normal[k];
        found.square = height * height;
    } else {
        for (int k = 0; k < 3; k++) found.at[k] = c[from][k] + along * (c[(from + 1) % 3][k] - c[from][k]);
        subtract(p, found.at, to);
        found.square = ssfr_dot(to, to);
    }
    if (found.square < best->square) *best = found;
}

/* Square of the distance to a node's box, m^2; p is relative to the mesh's middle. */
static double to_box(const ssfr_mesh_node *node, const double p[3])
{
    double square = 0;
    for (int k = 0; k < 3; k++) {
        const double below = (double)node->lo[k] - p[k], above = p[k] - (double)node->hi[k];
        const double side = below > above ? below : above, out = side > 0 ? side : 0;
        square += out * out;
    }
    return square;
}

/* The nearer child first; what waits is at most one node a level. */
static nearest find_nearest(const ssfr_mesh *mesh, const double p[3])
{
    struct {
        uint32_t node;
        double square;
    } waiting[MAX_WAITING];
    nearest best = {.square = INFINITY};
    double from_middle[3];
    int n = 1;
    waiting[0].node = 0, waiting[0].square = 0;
    subtract(p, mesh->middle, from_middle);
    while (n > 0) {
        const uint32_t at = waiting[--n].node, leaf = mesh->nodes[at].leaf;
        if (waiting[n].square >= best.square) continue;
        for (uint32_t i = leaf >> 3; i < (leaf >> 3) + (leaf & 7); i++) try_triangle(mesh, i, p, &best);
        if (leaf) continue;
        const uint32_t a = at + 1, b = mesh->nodes[a].skip;
        const double to_a = to_box(mesh->nodes + a, from_middle), to_b = to_box(mesh->nodes + b, from_middle);
        const bool a_first = to_a < to_b;
        waiting[n].node = a_first ? b : a, waiting[n].square = a_first ? to_b : to_a;
        n += waiting[n].square < best.square;
        waiting[n].node = a_first ? a : b, waiting[n].square = a_first ? to_a : to_b;
        n += waiting[n].square < best.square;
    }
    return best;
}

static const double *normal_of(const ssfr_mesh *mesh, const nearest *at)
{
    const ssfr_mesh_normals *n = mesh->normals + at->triangle;
    return at->feature >= CORNER ? n->corner[at->feature - CORNER]
           : at->feature >= EDGE ? n->edge[at->feature - EDGE]
                                 : mesh->triangles[at->triangle].normal;
}

/* The sign by angle-weighted pseudonormals: Baerentzen and Aanaes, Signed distance computation using the angle weighted
 * pseudonormal (2005). */
double ssfr_mesh_distance(const ssfr_mesh *mesh, const double at[3], double normal[3])
{
    const nearest best = find_nearest(mesh, at);
    const double *n = normal_of(mesh, &best), far = fmax(fabs(best.at[0]), fmax(fabs(best.at[1]), fabs(best.at[2])));
    double to[3];
    subtract(at, best.at, to);
    const bool inside = ssfr_dot(to, n) < 0;
    const double d = sqrt(best.square);
    /* Where rounding decides which way the nearest point is, the surface's own normal stands. */
    const bool own = best.feature == FACE || d < 1e-12 * far;
    for (int k = 0; k < 3; k++) normal[k] = own ? n[k] : (inside ? -to[k] : to[k]) / d;
    return inside ? -d : d;
}

/* ---- rays -------------------------------------------------------------------------------------------------------- */

typedef struct ray {
    double o[3], d[3], inverse[3]; /* o: moved along the ray to where it is nearest to the mesh's middle */
    double from_middle[3];         /* o relative to it */
    double moved;                  /* by so many d */
    int x, y, z;                   /* axes, right-handed; the ray runs most along z, forwards: x and y may be swapped */
    double shear[2];               /* of x and y along z, which makes the ray an axis */
    double first, t;               /* the ray's begin and its nearest hit so far, from o on */
} ray;

static bool meets_box(const ray *r, const ssfr_mesh_node *node)
{
    double enter = r->first, leave = r->t;
    for (int k = 0; k < 3; k++) {
        const double a = ((double)node->lo[k] - r->from_middle[k]) * r->inverse[k];
        const double b = ((double)node->hi[k] - r->from_middle[k]) * r->inverse[k];
        const double near = a < b ? a : b, far = a < b ? b : a;
        enter = near > enter ? near : enter;
        leave = far < leave ? far : leave;
    }
    return enter <= leave;
}

/* Seen along the ray, which of a triangle's sides it passes: after Woop, Benthin and Wald, Watertight ray/triangle
 * intersection (2013). A corner has one place for all its triangles, and an edge run backwards gives the exact opposite
 * of the edge: no ray slips through between two triangles, nor at a corner. */
static bool passes_through(const ray *r, const double c[3][3])
{
    double p[3][2];
    bool within = true;
    for (int k = 0; k < 3; k++) {
        const double z = c[k][r->z] - r->o[r->z];
        p[k][0] = c[k][r->x] - r->o[r->x] - r->shear[0] * z;
        p[k][1] = c[k][r->y] - r->o[r->y] - r->shear[1] * z;
    }
    for (int k = 0; k < 3; k++) {
        const double *a = p[k], *b = p[(k + 1) % 3];
        within &= a[0] * b[1] - a[1] * b[0] <= 0;
    }
    return within;
}

static bool enter_triangle(const ssfr_mesh *mesh, size_t i, ray *r)
{
    const ssfr_mesh_triangle *triangle = mesh->triangles + i;
    const double *n = triangle->normal, slope = ssfr_dot(n, r->d);
    double to[3];
    if (!(slope < 0)) return false;
    subtract(triangle->corner[0], r->o, to);
    const double t = ssfr_dot(n, to) / slope;
    if (!(t > r->first && t < r->t) || !passes_through(r, (const double(*)[3])triangle->corner)) return false;
    r->t = t;
    return true;
}

static void choose_axes(ray *r)
{
    r->z = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(r->d[k]) > fabs(r->d[r->z])) r->z = k;
    const bool forwards = r->d[r->z] > 0;
    r->x = (r->z + (forwards ? 1 : 2)) % 3, r->y = (r->z + (forwards ? 2 : 1)) % 3;
    r->shear[0] = r->d[r->x] / r->d[r->z], r->shear[1] = r->d[r->y] / r->d[r->z];
}

/* Measured from where the ray is nearest to the mesh's middle: the sides of triangles are told far away too. */
static ray begin(const ssfr_mesh *mesh, const double origin[3], const double dir[3])
{
    ray r = {.t = INFINITY};
    double to[3];
    subtract(mesh->middle, origin, to);
    r.moved = ssfr_dot(to, dir) / ssfr_dot(dir, dir);
    r.first = -r.moved;
    for (int k = 0; k < 3; k++) {
        r.o[k] = origin[k] + r.moved * dir[k];
        r.from_middle[k] = r.o[k] - mesh->middle[k];
        r.d[k] = dir[k];
        r.inverse[k] = 1 / (fabs(dir[k]) > 1e-30 ? dir[k] : 1e-30);
    }
    choose_axes(&r);
    return r;
}

double ssfr_mesh_enter(const ssfr_mesh *mesh, const double origin[3], const double dir[3], double normal[3])
{
    ray r = begin(mesh, origin, dir);
    size_t hit = mesh->n_triangles;
    for (uint32_t i = 0; i < mesh->n_nodes;) {
        const ssfr_mesh_node *node = mesh->nodes + i;
        const bool meets = meets_box(&r, node);
        for (uint32_t k = node->leaf >> 3; meets && k < (node->leaf >> 3) + (node->leaf & 7); k++)
            if (enter_triangle(mesh, k, &r)) hit = k;
        i = meets ? i + 1 : node->skip;
    }
    if (hit == mesh->n_triangles) return -1;
    memcpy(normal, mesh->triangles[hit].normal, 3 * sizeof *normal);
    return r.moved + r.t;
}
