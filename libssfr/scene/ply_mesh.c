/* SPDX-License-Identifier: MIT */
/* ply_mesh.c: reads the polygons of PLY files: the vertex element's x y z, and the face element's list of vertices. */
#include "scene/ply_file.h"
#include "scene/soup.h"

typedef struct polygons {
    ssfr_soup *soup;
    double at[3];
    unsigned found; /* coordinates of the vertex, bit k is k */
    const ssfr_ply_property *list;
    uint32_t corners[SSFR_SOUP_CORNERS];
} polygons;

static int coordinate_of(const ssfr_ply_property *q)
{
    const bool named = strlen(q->name) == 1 && strchr("xyz", q->name[0]);
    return named && !q->list ? q->name[0] - 'x' : -1;
}

static ssfr_result put_vertex(void *user, const ssfr_ply_property *q, size_t i, size_t k, size_t n, double value)
{
    polygons *p = user;
    const int axis = coordinate_of(q);
    (void)i, (void)k, (void)n;
    if (axis < 0) return SSFR_OK;
    p->at[axis] = value;
    p->found |= 1u << axis;
    if (p->found != 7) return SSFR_OK;
    p->found = 0;
    return ssfr_soup_vertex(p->soup, p->at);
}

static ssfr_result put_corner(void *user, const ssfr_ply_property *q, size_t i, size_t k, size_t n, double value)
{
    polygons *p = user;
    const char *path = p->soup->path;
    if (q != p->list) return SSFR_OK;
    if (n < 3) return ssfr_fail(SSFR_ERR_FORMAT, "%s: face %zu (from 0): %zu corners", path, i, n);
    if (n > SSFR_SOUP_CORNERS)
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: face %zu (from 0): %zu corners, at most %d", path, i, n,
                         SSFR_SOUP_CORNERS);
    if (!(value >= 0 && value < (double)p->soup->n_vertices && value == floor(value)))
        return ssfr_fail(SSFR_ERR_FORMAT, "%s: face %zu (from 0): vertex %.10g of %zu", path, i, value,
                         p->soup->n_vertices);
    p->corners[k] = (uint32_t)value;
    return k + 1 == n ? ssfr_soup_polygon(p->soup, (int)n, p->corners) : SSFR_OK;
}

static ssfr_result check_vertex(const ssfr_ply *ply, const ssfr_ply_element *e)
{
    int n[3] = {0};
    for (int i = e->first; i < e->first + e->n_properties; i++) {
        const int axis = coordinate_of(ply->properties + i);
        if (axis >= 0) n[axis]++;
    }
    if (n[0] != 1 || n[1] != 1 || n[2] != 1)
        return ssfr_fail(SSFR_ERR_FORMAT, "%s: expected one x, y and z of the vertices", ply->path);
    return ssfr_ply_check_size(ply, e, "vertices");
}

static ssfr_result find_list(polygons *p, const ssfr_ply *ply, const ssfr_ply_element *e)
{
    for (int i = e->first; i < e->first + e->n_properties; i++) {
        const ssfr_ply_property *q = ply->properties + i;
        if (q->list && (strcmp(q->name, "vertex_indices") == 0 || strcmp(q->name, "vertex_index") == 0)) p->list = q;
    }
    if (!p->list) return ssfr_fail(SSFR_ERR_FORMAT, "%s: the faces lack a list vertex_indices", ply->path);
    return ssfr_ply_check_size(ply, e, "faces");
}

/* Faces may only name vertices that came before them. What stands after the faces is not looked at. */
static ssfr_result read_elements(polygons *p, ssfr_ply *ply)
{
    ssfr_result result = SSFR_OK;
    for (const ssfr_ply_element *e = ply->elements; e < ply->elements + ply->n_elements && !p->list; e++) {
        ssfr_ply_put *put = NULL;
        if (strcmp(e->name, "vertex") == 0) {
            SSFR_TRY(check_vertex(ply, e));
            put = put_vertex;
        } else if (strcmp(e->name, "face") == 0) {
            SSFR_TRY(find_list(p, ply, e));
            put = put_corner;
        }
        SSFR_TRY(ssfr_ply_read_instances(ply, e, put, p));
    }
    if (!p->list) result = ssfr_fail(SSFR_ERR_FORMAT, "%s: the header has no face element", ply->path);
end:
    return result;
}

ssfr_result ssfr_ply_read_mesh(ssfr_soup *soup)
{
    ssfr_result result = SSFR_OK;
    char *file = NULL;
    polygons *p = NULL;
    ssfr_ply ply = {.path = soup->path, .vertex = "vertex"};
    SSFR_TRY(ssfr_alloc(&p, 1, sizeof *p, "a reader"));
    p->soup = soup;
    SSFR_TRY(ssfr_ply_open(&ply, &file));
    SSFR_TRY(read_elements(p, &ply));
end:
    free(file), free(p);
    return result;
}
