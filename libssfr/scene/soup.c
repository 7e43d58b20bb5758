/* SPDX-License-Identifier: MIT */
/* soup.c: triangles from files: polygons cut into triangles, equal vertices made one. */
#include "scene/soup.h"

#include "scene/mesh.h"

#include <assert.h>
#include <strings.h>

/* Room for `more` entries; n and cap are counted in entries of `size` bytes. */
static ssfr_result reserve(void **array, size_t n, size_t *cap, size_t more, size_t size)
{
    const size_t least = n + more, doubled = 2 * *cap > 64 ? 2 * *cap : 64, to = least > doubled ? least : doubled;
    if (least <= *cap) return SSFR_OK;
    void *grown = realloc(*array, to * size);
    if (!grown) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for %zu x %zu bytes of a mesh", to, size);
    *array = grown;
    *cap = to;
    return SSFR_OK;
}

ssfr_result ssfr_soup_vertex(ssfr_soup *soup, const double at[3])
{
    void *vertices = soup->vertices;
    const ssfr_result result = reserve(&vertices, soup->n_vertices, &soup->cap_vertices, 1, 3 * sizeof *soup->vertices);
    soup->vertices = vertices;
    if (result == SSFR_OK) memcpy(soup->vertices + 3 * soup->n_vertices++, at, 3 * sizeof *at);
    return result;
}

void ssfr_soup_finish(ssfr_soup *soup)
{
    free(soup->vertices), free(soup->triangles);
    *soup = (ssfr_soup){0};
}

/* ---- polygons ---------------------------------------------------------------------------------------------------- */

/* A polygon seen along its normal: counter-clockwise in x and y. */
typedef struct flat {
    int n;
    double (*at)[2];
    int *next, *previous; /* of what is left of it */
} flat;

/* Twice the area to the left of the turn at b, m^2: positive at a convex corner. */
static double turn(const flat *f, int a, int b, int c)
{
    const double *p = f->at[a], *q = f->at[b], *r = f->at[c];
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

/* The corner can be cut off: it is convex, and no other corner stands in its triangle. */
static bool is_ear(const flat *f, int b)
{
    const int a = f->previous[b], c = f->next[b];
    bool ear = turn(f, a, b, c) > 0;
    for (int p = f->next[c]; p != a && ear; p = f->next[p])
        ear = !(turn(f, a, b, p) >= 0 && turn(f, b, c, p) >= 0 && turn(f, c, a, p) >= 0);
    return ear;
}

/* Newell's normal: that of the polygon's area, also when it is not quite flat. */
static void normal_of(const ssfr_soup *soup, int n, const uint32_t *corners, double out[3])
{
    const double *origin = soup->vertices + 3 * (size_t)corners[0];
    double sum[3] = {0};
    for (int i = 1; i + 1 < n; i++) {
        const double *b = soup->vertices + 3 * (size_t)corners[i], *c = soup->vertices + 3 * (size_t)corners[i + 1];
        const double ab[3] = {b[0] - origin[0], b[1] - origin[1], b[2] - origin[2]};
        const double ac[3] = {c[0] - origin[0], c[1] - origin[1], c[2] - origin[2]};
        double cross[3];
        ssfr_cross(ab, ac, cross);
        for (int k = 0; k < 3; k++) sum[k] += cross[k];
    }
    memcpy(out, sum, sizeof sum);
}

static void flatten(const ssfr_soup *soup, int n, const uint32_t *corners, flat *f)
{
    double normal[3];
    int z = 0;
    normal_of(soup, n, corners, normal);
    for (int k = 1; k < 3; k++)
        if (fabs(normal[k]) > fabs(normal[z])) z = k;
    const int x = normal[z] < 0 ? (z + 2) % 3 : (z + 1) % 3, y = normal[z] < 0 ? (z + 1) % 3 : (z + 2) % 3;
    f->n = n;
    for (int i = 0; i < n; i++) {
        f->at[i][0] = soup->vertices[3 * (size_t)corners[i] + (size_t)x];
        f->at[i][1] = soup->vertices[3 * (size_t)corners[i] + (size_t)y];
        f->next[i] = (i + 1) % n, f->previous[i] = (i + n - 1) % n;
    }
}

static void put_triangle(ssfr_soup *soup, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *to = soup->triangles + 3 * soup->n_triangles++;
    to[0] = a, to[1] = b, to[2] = c;
}

/* Where no ear is left, as in a polygon that crosses itself, the next corner goes: the mesh's check has the word. */
static void cut_ears(ssfr_soup *soup, const uint32_t *corners, flat *f)
{
    int at = 0;
    for (int left = f->n; left > 3; left--) {
        int tried = 0;
        while (tried < left && !is_ear(f, at)) at = f->next[at], tried++;
        const int a = f->previous[at], c = f->next[at];
        put_triangle(soup, corners[a], corners[at], corners[c]);
        f->next[a] = c, f->previous[c] = a;
        at = f->next[c]; /* not the neighbour: slivers are rarer so */
    }
    put_triangle(soup, corners[f->previous[at]], corners[at], corners[f->next[at]]);
}

ssfr_result ssfr_soup_polygon(ssfr_soup *soup, int n, const uint32_t *corners)
{
    ssfr_result result = SSFR_OK;
    flat f = {0};
    void *triangles = soup->triangles;
    assert(n >= 3);
    result = reserve(&triangles, soup->n_triangles, &soup->cap_triangles, (size_t)n - 2, 3 * sizeof *soup->triangles);
    soup->triangles = triangles;
    if (result != SSFR_OK) return result;
    if (n == 3) {
        put_triangle(soup, corners[0], corners[1], corners[2]);
        return SSFR_OK;
    }
    SSFR_TRY(ssfr_alloc(&f.at, (size_t)n, sizeof *f.at, "a polygon"));
    SSFR_TRY(ssfr_alloc(&f.next, 2 * (size_t)n, sizeof *f.next, "a polygon"));
    f.previous = f.next + n;
    flatten(soup, n, corners, &f);
    cut_ears(soup, corners, &f);
end:
    free(f.at), free(f.next);
    return result;
}

/* ---- welding ----------------------------------------------------------------------------------------------------- */

typedef struct place {
    double at[3];
    uint32_t index;
} place;

static int compare_places(const void *a, const void *b)
{
    const place *p = a, *q = b;
    int order = 0;
    for (int k = 0; k < 3 && order == 0; k++) order = (p->at[k] > q->at[k]) - (p->at[k] < q->at[k]);
    return order ? order : (p->index > q->index) - (p->index < q->index);
}

/* Which vertex stands for each: the first in its place. */
static void find_equals(const ssfr_soup *soup, place *places, uint32_t *same)
{
    const size_t n = soup->n_vertices;
    for (size_t i = 0; i < n; i++) {
        memcpy(places[i].at, soup->vertices + 3 * i, sizeof places[i].at);
        places[i].index = (uint32_t)i;
    }
    qsort(places, n, sizeof *places, compare_places);
    for (size_t i = 0; i < n; i++) {
        bool equal = i > 0;
        for (int k = 0; k < 3 && equal; k++) equal = !(places[i].at[k] > places[i - 1].at[k]);
        same[places[i].index] = equal ? same[places[i - 1].index] : places[i].index;
    }
}

ssfr_result ssfr_soup_weld(ssfr_soup *soup)
{
    ssfr_result result = SSFR_OK;
    place *places = NULL;
    uint32_t *same = NULL;
    if (soup->n_vertices > UINT32_MAX)
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: %zu vertices: at most %u", soup->path, soup->n_vertices,
                         UINT32_MAX);
    for (size_t i = 0; i < 3 * soup->n_vertices; i++)
        if (!isfinite(soup->vertices[i]))
            return ssfr_fail(SSFR_ERR_VALUE, "%s: vertex %zu (from 0) has the coordinate %g", soup->path, i / 3,
                             soup->vertices[i]);
    SSFR_TRY(ssfr_alloc(&places, soup->n_vertices, sizeof *places, "vertices"));
    SSFR_TRY(ssfr_alloc(&same, soup->n_vertices, sizeof *same, "vertices"));
    find_equals(soup, places, same);
    for (size_t i = 0; i < 3 * soup->n_triangles; i++) soup->triangles[i] = same[soup->triangles[i]];
end:
    free(places), free(same);
    return result;
}

/* ---- loading ----------------------------------------------------------------------------------------------------- */

static ssfr_soup_reader *find_reader(const char *path)
{
    static const struct {
        const char *ending;
        ssfr_soup_reader *read;
    } formats[] = {{".obj", ssfr_obj_read}, {".stl", ssfr_stl_read}, {".ply", ssfr_ply_read_mesh}};
    const char *ending = strrchr(path, '.');
    ssfr_soup_reader *found = NULL;
    for (size_t i = 0; ending && i < SSFR_COUNT(formats); i++)
        if (strcasecmp(ending, formats[i].ending) == 0) found = formats[i].read;
    return found;
}

ssfr_result ssfr_mesh_load(ssfr_mesh **out, const char *path)
{
    ssfr_result result = SSFR_OK;
    ssfr_soup soup = {.path = path};
    ssfr_soup_reader *read = find_reader(path);
    *out = NULL;
    if (!read) return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: the names of meshes end in .obj .stl .ply", path);
    ssfr_plain plain = ssfr_plain_begin();
    SSFR_TRY(read(&soup));
    SSFR_TRY(ssfr_soup_weld(&soup));
    SSFR_TRY(ssfr_mesh_make(out, path, soup.n_vertices, soup.vertices, soup.n_triangles, soup.triangles));
end:
    ssfr_plain_end(&plain);
    ssfr_soup_finish(&soup);
    return result;
}
