/* SPDX-License-Identifier: MIT */
/* mesh.c: makes a closed surface of triangles: checks that it is one, and finds the normals of all that it has. */
#include "scene/mesh.h"

#include <stdatomic.h>

enum { MAX_TRIANGLES = 1 << 28 }; /* three times as many edges, and the nodes of their tree, fit 32 bits */

typedef struct edge {
    uint32_t from, to; /* vertices, from < to */
    uint32_t side;     /* of which triangle, and which of its sides: 3 triangle + side */
    bool backwards;    /* the triangle runs along it from `to` to `from` */
} edge;

typedef struct work {
    const char *what;
    size_t n_vertices, n_triangles;
    const double *vertices;
    uint32_t (*triangles)[3];
    edge *edges;                /* 3 n_triangles, sorted */
    double (*corner_normals)[3]; /* one a vertex, summed */
    ssfr_mesh *mesh;
} work;

/* ---- a closed surface -------------------------------------------------------------------------------------------- */

static ssfr_result check_numbers(const work *w)
{
    if (w->n_triangles == 0) return ssfr_fail(SSFR_ERR_VALUE, "%s: no triangles", w->what);
    if (w->n_triangles > MAX_TRIANGLES || w->n_vertices > UINT32_MAX)
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: %zu triangles and %zu vertices: at most %d triangles", w->what,
                         w->n_triangles, w->n_vertices, MAX_TRIANGLES);
    for (size_t i = 0; i < 3 * w->n_vertices; i++)
        if (!(fabs(w->vertices[i]) <= SSFR_MESH_REACH))
            return ssfr_fail(SSFR_ERR_VALUE, "%s: vertex %zu (from 0) has the coordinate %g m: expected at most %g m",
                             w->what, i / 3, w->vertices[i], SSFR_MESH_REACH);
    return SSFR_OK;
}

static ssfr_result copy_triangles(work *w, const uint32_t *triangles)
{
    ssfr_result result = SSFR_OK;
    for (size_t i = 0; i < 3 * w->n_triangles; i++)
        if (triangles[i] >= w->n_vertices)
            return ssfr_fail(SSFR_ERR_VALUE, "%s: triangle %zu (from 0) has a corner at vertex %u of %zu", w->what,
                             i / 3, triangles[i], w->n_vertices);
    SSFR_TRY(ssfr_alloc(&w->triangles, w->n_triangles, sizeof *w->triangles, "triangles"));
    memcpy(w->triangles, triangles, w->n_triangles * sizeof *w->triangles);
end:
    return result;
}

static int compare_edges(const void *a, const void *b)
{
    const edge *p = a, *q = b;
    int order = (p->from > q->from) - (p->from < q->from);
    if (order == 0) order = (p->to > q->to) - (p->to < q->to);
    return order ? order : (p->side > q->side) - (p->side < q->side);
}

static ssfr_result list_edges(work *w)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_alloc(&w->edges, 3 * w->n_triangles, sizeof *w->edges, "edges"));
    for (size_t i = 0; i < 3 * w->n_triangles; i++) {
        const uint32_t a = w->triangles[i / 3][i % 3], b = w->triangles[i / 3][(i + 1) % 3];
        w->edges[i] = a < b ? (edge){a, b, (uint32_t)i, false} : (edge){b, a, (uint32_t)i, true};
    }
    qsort(w->edges, 3 * w->n_triangles, sizeof *w->edges, compare_edges);
end:
    return result;
}

/* Twice the triangle's area along its normal, m^2. */
static void cross_of(const work *w, const uint32_t t[3], double out[3])
{
    const double *a = w->vertices + 3 * (size_t)t[0], *b = w->vertices + 3 * (size_t)t[1];
    const double *c = w->vertices + 3 * (size_t)t[2];
    const double ab[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, ac[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    ssfr_cross(ab, ac, out);
}

static double length_squared(const work *w, uint32_t i, uint32_t k)
{
    const double *a = w->vertices + 3 * (size_t)i, *b = w->vertices + 3 * (size_t)k;
    return ssfr_square(b[0] - a[0]) + ssfr_square(b[1] - a[1]) + ssfr_square(b[2] - a[2]);
}

/* Corners in one place or, but for rounding, on one line: such a triangle has no normal. */
static bool is_degenerate(const work *w, const uint32_t t[3])
{
    const double longest = fmax(fmax(length_squared(w, t[0], t[1]), length_squared(w, t[1], t[2])),
                                length_squared(w, t[2], t[0]));
    double n[3];
    cross_of(w, t, n);
    return !(ssfr_normalize(n) > 1e-12 * longest);
}

typedef struct faults {
    size_t open, crowded, opposed, degenerate;
} faults;

static faults count_faults(const work *w)
{
    faults f = {0};
    const size_t n = 3 * w->n_triangles;
    for (size_t i = 0; i < w->n_triangles; i++) f.degenerate += is_degenerate(w, w->triangles[i]);
    for (size_t i = 0, next; i < n; i = next) {
        const edge *e = w->edges + i;
        for (next = i + 1; next < n && w->edges[next].from == e->from && w->edges[next].to == e->to;) next++;
        f.open += next - i == 1;
        f.crowded += next - i > 2;
        f.opposed += next - i == 2 && e[0].backwards == e[1].backwards;
    }
    return f;
}

static ssfr_result check_closed(const work *w)
{
    const faults f = count_faults(w);
    const struct {
        size_t n;
        const char *one, *many;
    } list[] = {{f.open, "open edge", "open edges"},
                {f.crowded, "edge of more than two triangles", "edges of more than two triangles"},
                {f.opposed, "edge between triangles that face opposite ways",
                 "edges between triangles that face opposite ways"},
                {f.degenerate, "degenerate triangle", "degenerate triangles"}};
    char text[256] = "";
    for (size_t i = 0; i < SSFR_COUNT(list); i++) {
        const size_t used = strlen(text);
        if (list[i].n)
            snprintf(text + used, sizeof text - used, "%s%zu %s", used ? ", " : "", list[i].n,
                     list[i].n == 1 ? list[i].one : list[i].many);
    }
    if (!text[0]) return SSFR_OK;
    return ssfr_fail(SSFR_ERR_VALUE, "%s: %s: a closed surface is needed", w->what, text);
}

/* ---- which side is out ------------------------------------------------------------------------------------------- */

static void measure(work *w)
{
    ssfr_mesh *mesh = w->mesh;
    for (int k = 0; k < 3; k++) mesh->lo[k] = INFINITY, mesh->hi[k] = -INFINITY;
    for (size_t i = 0; i < 3 * w->n_triangles; i++) {
        const double *at = w->vertices + 3 * (size_t)w->triangles[i / 3][i % 3];
        for (int k = 0; k < 3; k++) mesh->lo[k] = fmin(mesh->lo[k], at[k]), mesh->hi[k] = fmax(mesh->hi[k], at[k]);
    }
    for (int k = 0; k < 3; k++) mesh->middle[k] = 0.5 * (mesh->lo[k] + mesh->hi[k]);
}

/* m^3, from pyramids over the triangles with their tops in the middle: negative where the surface is inside out. */
static double volume(const work *w)
{
    const ssfr_mesh *m = w->mesh;
    double six = 0;
    for (size_t i = 0; i < w->n_triangles; i++) {
        const double *a = w->vertices + 3 * (size_t)w->triangles[i][0];
        double n[3], top[3];
        cross_of(w, w->triangles[i], n);
        for (int k = 0; k < 3; k++) top[k] = a[k] - m->middle[k];
        six += ssfr_dot(n, top);
    }
    return six / 6;
}

static ssfr_result turn_outside_out(work *w)
{
    const double size[3] = {w->mesh->hi[0] - w->mesh->lo[0], w->mesh->hi[1] - w->mesh->lo[1],
                            w->mesh->hi[2] - w->mesh->lo[2]};
    const double v = volume(w), largest = fmax(fmax(size[0], size[1]), size[2]);
    if (!(fabs(v) > 1e-14 * largest * largest * largest))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: the surface encloses no volume", w->what);
    if (v > 0) return SSFR_OK;
    ssfr_log(SSFR_INFO, "%s: the surface is inside out, and is turned", w->what);
    for (size_t i = 0; i < w->n_triangles; i++) {
        const uint32_t second = w->triangles[i][1];
        w->triangles[i][1] = w->triangles[i][2], w->triangles[i][2] = second;
    }
    free(w->edges);
    w->edges = NULL;
    return list_edges(w);
}

/* ---- normals ----------------------------------------------------------------------------------------------------- */

static double angle_at(const work *w, const uint32_t t[3], int k)
{
    const double *a = w->vertices + 3 * (size_t)t[k], *b = w->vertices + 3 * (size_t)t[(k + 1) % 3];
    const double *c = w->vertices + 3 * (size_t)t[(k + 2) % 3];
    const double ab[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, ac[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    double across[3];
    ssfr_cross(ab, ac, across);
    return atan2(sqrt(ssfr_dot(across, across)), ssfr_dot(ab, ac));
}

static void sum_corner_normals(work *w)
{
    for (size_t i = 0; i < w->n_triangles; i++) {
        double *face = w->mesh->triangles[i].normal;
        cross_of(w, w->triangles[i], face);
        ssfr_normalize(face);
        for (int k = 0; k < 3; k++) {
            const double angle = angle_at(w, w->triangles[i], k);
            for (int j = 0; j < 3; j++) w->corner_normals[w->triangles[i][k]][j] += angle * face[j];
        }
    }
    for (size_t i = 0; i < w->n_vertices; i++) ssfr_normalize(w->corner_normals[i]);
}

/* Edges stand in pairs. */
static void set_edge_normals(const work *w)
{
    const ssfr_mesh_triangle *triangles = w->mesh->triangles;
    ssfr_mesh_normals *normals = w->mesh->normals;
    for (size_t i = 0; i < 3 * w->n_triangles; i += 2) {
        const uint32_t a = w->edges[i].side, b = w->edges[i + 1].side;
        double n[3];
        for (int k = 0; k < 3; k++) n[k] = triangles[a / 3].normal[k] + triangles[b / 3].normal[k];
        ssfr_normalize(n);
        memcpy(normals[a / 3].edge[a % 3], n, sizeof n);
        memcpy(normals[b / 3].edge[b % 3], n, sizeof n);
    }
}

static ssfr_result fill(work *w)
{
    ssfr_result result = SSFR_OK;
    ssfr_mesh *mesh = w->mesh;
    mesh->n_triangles = w->n_triangles;
    SSFR_TRY(ssfr_alloc(&mesh->triangles, w->n_triangles, sizeof *mesh->triangles, "triangles"));
    SSFR_TRY(ssfr_alloc(&mesh->normals, w->n_triangles, sizeof *mesh->normals, "normals"));
    SSFR_TRY(ssfr_alloc(&w->corner_normals, w->n_vertices, sizeof *w->corner_normals, "normals"));
    sum_corner_normals(w);
    set_edge_normals(w);
    for (size_t i = 0; i < 3 * w->n_triangles; i++) {
        const size_t v = w->triangles[i / 3][i % 3];
        memcpy(mesh->triangles[i / 3].corner[i % 3], w->vertices + 3 * v, 3 * sizeof(double));
        memcpy(mesh->normals[i / 3].corner[i % 3], w->corner_normals[v], 3 * sizeof(double));
    }
end:
    return result;
}

/* ---- life -------------------------------------------------------------------------------------------------------- */

static atomic_uint_fast64_t serial; /* of the last mesh */

ssfr_result ssfr_mesh_make(ssfr_mesh **out, const char *what, size_t n_vertices, const double *vertices,
                           size_t n_triangles, const uint32_t *triangles)
{
    ssfr_result result = SSFR_OK;
    work w = {.what = what, .n_vertices = n_vertices, .vertices = vertices, .n_triangles = n_triangles};
    *out = NULL;
    SSFR_TRY(check_numbers(&w));
    SSFR_TRY(copy_triangles(&w, triangles));
    SSFR_TRY(list_edges(&w));
    SSFR_TRY(check_closed(&w));
    SSFR_TRY(ssfr_alloc(&w.mesh, 1, sizeof *w.mesh, "a mesh"));
    measure(&w);
    SSFR_TRY(turn_outside_out(&w));
    SSFR_TRY(fill(&w));
    SSFR_TRY(ssfr_mesh_grow_tree(w.mesh));
    w.mesh->serial = ++serial;
    *out = w.mesh;
    w.mesh = NULL;
end:
    free(w.triangles), free(w.edges), free(w.corner_normals);
    ssfr_mesh_destroy(&w.mesh);
    return result;
}

ssfr_result ssfr_mesh_create(ssfr_mesh **out, size_t n_vertices, const double *vertices, size_t n_triangles,
                             const uint32_t *triangles)
{
    return ssfr_mesh_make(out, "mesh", n_vertices, vertices, n_triangles, triangles);
}

void ssfr_mesh_scale(ssfr_mesh *mesh, double factor)
{
    for (size_t i = 0; i < 9 * mesh->n_triangles; i++) mesh->triangles[i / 9].corner[i / 3 % 3][i % 3] *= factor;
    for (size_t i = 0; i < 3 * mesh->n_nodes; i++) {
        float *lo = &mesh->nodes[i / 3].lo[i % 3], *hi = &mesh->nodes[i / 3].hi[i % 3];
        *lo = (float)((double)*lo * factor), *hi = (float)((double)*hi * factor);
    }
    for (int k = 0; k < 3; k++) mesh->lo[k] *= factor, mesh->hi[k] *= factor, mesh->middle[k] *= factor;
    mesh->serial = ++serial;
}

void ssfr_mesh_destroy(ssfr_mesh **mesh)
{
    if (*mesh) free((*mesh)->triangles), free((*mesh)->normals), free((*mesh)->nodes);
    free(*mesh);
    *mesh = NULL;
}
