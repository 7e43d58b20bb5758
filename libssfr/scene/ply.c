/* SPDX-License-Identifier: MIT */
/* ply.c: reads PLY particles (the vertex element, properties by name) and writes them as binary little-endian ones. */
#include "scene/ply_file.h"
#include "scene/sheet.h"
#include "scene/writer.h"

typedef struct vertices {
    ssfr_sheet sheet;
    const ssfr_ply_property *first;
    ssfr_sheet_column columns[SSFR_PLY_PROPERTIES]; /* of the properties from `first` on */
} vertices;

/* "particle radius 0.02 m" is a convention; a text of another form, or in another unit, is a mere comment. */
static void read_comment(void *user, char *words[])
{
    ssfr_reading *reading = user;
    double radius;
    const bool metres = !words[4][0] || strcmp(words[4], "m") == 0 || strcmp(words[4], "m,") == 0;
    if (strcmp(words[1], "particle") == 0 && strcmp(words[2], "radius") == 0 && metres &&
        ssfr_parse_number(words[3], &radius))
        reading->given.radius = radius;
}

static ssfr_result put(void *user, const ssfr_ply_property *q, size_t i, size_t k, size_t n, double value)
{
    vertices *v = user;
    (void)k, (void)n; /* no list has a column */
    return ssfr_sheet_put(&v->sheet, v->columns[q - v->first], i, value);
}

/* Makes the arrays that the vertex has. */
static ssfr_result make_sheet(const ssfr_ply *p, const ssfr_ply_element *vertex, vertices *v)
{
    ssfr_result result = SSFR_OK;
    v->first = p->properties + vertex->first;
    for (int k = 0; k < vertex->n_properties; k++) {
        const ssfr_ply_property *q = v->first + k;
        v->columns[k] = q->list ? (ssfr_sheet_column){SSFR_PLACE_NONE, 0} : ssfr_sheet_column_find(q->name);
        SSFR_TRY(ssfr_sheet_add(&v->sheet, p->path, q->name, v->columns[k]));
    }
    SSFR_TRY(ssfr_sheet_begin(&v->sheet, p->path, vertex->n));
end:
    return result;
}

/* Elements before the vertices are skipped, those after them are not looked at. */
static ssfr_result read_body(ssfr_ply *p, vertices *v)
{
    ssfr_result result = SSFR_OK;
    const ssfr_ply_element *vertex = p->elements, *const end_of_elements = p->elements + p->n_elements;
    for (; vertex < end_of_elements && strcmp(vertex->name, "vertex") != 0; vertex++)
        SSFR_TRY(ssfr_ply_read_instances(p, vertex, NULL, NULL));
    if (vertex == end_of_elements)
        return ssfr_fail(SSFR_ERR_FORMAT, "%s: the header has no vertex element", p->path);
    SSFR_TRY(ssfr_ply_check_size(p, vertex, "particles"));
    SSFR_TRY(make_sheet(p, vertex, v));
    SSFR_TRY(ssfr_ply_read_instances(p, vertex, put, v));
    ssfr_reading_end(v->sheet.reading, vertex->n);
    if (vertex + 1 == end_of_elements) SSFR_TRY(ssfr_ply_check_end(p));
end:
    return result;
}

ssfr_result ssfr_ply_read(ssfr_reading *reading)
{
    ssfr_result result = SSFR_OK;
    char *file = NULL;
    ssfr_ply p = {.path = reading->path, .vertex = "particle", .comment = read_comment, .user = reading};
    vertices v = {.sheet = {.reading = reading}};
    SSFR_TRY(ssfr_ply_open(&p, &file));
    SSFR_TRY(read_body(&p, &v));
end:
    free(file);
    return result;
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

/* Scalars keep the array's name, which other programs show as it is; vectors have a property a component, vx vy vz. */
static void write_properties(ssfr_sink *sink, const ssfr_array *array)
{
    const char *type = array->real ? "float" : "uint";
    if (array->count == 1) ssfr_sink_text(sink, "property %s %s\n", type, array->name);
    for (size_t k = 0; k < array->count && array->count > 1; k++)
        ssfr_sink_text(sink, "property %s %c%c\n", type, array->name[0], "xyz"[k]);
}

/* Doubles where floats would lose digits: far from the origin, or where particles lie very close together. */
ssfr_result ssfr_ply_write(const ssfr_particles *set, const char *path)
{
    ssfr_result result = SSFR_OK;
    ssfr_sink sink;
    const bool as_double = !ssfr_floats_suffice(set);
    SSFR_TRY(ssfr_sink_begin(&sink, path, SSFR_LITTLE_ENDIAN));
    ssfr_sink_text(&sink, "ply\nformat binary_little_endian 1.0\ncomment metres, seconds, kilograms\n");
    if (set->radius > 0) ssfr_sink_text(&sink, "comment particle radius %.17g m\n", set->radius);
    ssfr_sink_text(&sink, "element vertex %zu\n", set->n);
    for (int k = 0; k < 3; k++) ssfr_sink_text(&sink, "property %s %c\n", as_double ? "double" : "float", "xyz"[k]);
    for (const ssfr_array *a = ssfr_arrays; a < ssfr_arrays + SSFR_N_ARRAYS; a++)
        if (ssfr_array_get(set, a)) write_properties(&sink, a);
    ssfr_sink_text(&sink, "end_header\n");
    for (size_t i = 0; i < set->n; i++) {
        ssfr_sink_position(&sink, set, i, as_double);
        for (const ssfr_array *a = ssfr_arrays; a < ssfr_arrays + SSFR_N_ARRAYS; a++)
            if (ssfr_array_get(set, a)) ssfr_sink_values(&sink, set, a, i);
    }
end:
    return ssfr_sink_end(&sink, result);
}
