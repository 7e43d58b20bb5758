/* SPDX-License-Identifier: GPL-3.0-or-later */
/* description_solids.c: reading the domain, the solids and their motions. */
#include "experiments/scenes/description_read.h"
#include "scene/mesh.h"

static const double max_cells = 1 << 20; /* of the neighbour grid along an axis; a cell is a support wide */

#define ANGLE .unit = "deg", .min = -1e6, .max = 1e6
#define FACTOR .min = 1e-6, .max = 1e6
#define SHARE .min = 0, .max = 1

/* ---- the domain -------------------------------------------------------------------------------------------------- */

ssfr_result ssfr_reading_domain(ssfr_reading *r)
{
    static const char *const sides[] = {"-x", "+x", "-y", "+y", "-z", "+z", NULL};
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("lo", ssfr_yaml_read_real3, ssfr_solver_setup, lo, .needed = true, SSFR_RANGE_PLACE),
        SSFR_YAML_ROW("hi", ssfr_yaml_read_real3, ssfr_solver_setup, hi, .needed = true, SSFR_RANGE_PLACE),
        SSFR_YAML_ROW("open", ssfr_yaml_read_words, ssfr_solver_setup, open, .words = sides),
        SSFR_YAML_ROW_END,
    };
    ssfr_result result = SSFR_OK;
    const ssfr_yaml_node *node = r->domain;
    ssfr_solver_setup *s = &r->d.solver;
    SSFR_TRY(ssfr_yaml_read_map(node, rows, s));
    for (int k = 0; k < 3; k++) {
        const double width = s->hi[k] - s->lo[k];
        if (!(width > 2 * s->radius))
            return ssfr_yaml_fail(node->key, SSFR_ERR_VALUE, "domain: %g m wide along %c, a particle %g m", width,
                                  "xyz"[k], 2 * s->radius);
        if (width > max_cells * SSFR_SUPPORT * s->radius)
            return ssfr_yaml_fail(node->key, SSFR_ERR_VALUE,
                                  "domain: %g m wide along %c, at most %g m for a radius of %g m", width, "xyz"[k],
                                  max_cells * SSFR_SUPPORT * s->radius, s->radius);
    }
end:
    return result;
}

/* ---- motions ----------------------------------------------------------------------------------------------------- */

static ssfr_result read_pose_keys(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("time", ssfr_yaml_read_real, ssfr_pose_key, time, .needed = true, SSFR_RANGE_TIME),
        SSFR_YAML_ROW("move", ssfr_yaml_read_real3, ssfr_pose_key, move, SSFR_RANGE_PLACE),
        SSFR_YAML_ROW("turn_deg", ssfr_yaml_read_real, ssfr_pose_key, turn_deg, ANGLE),
        SSFR_YAML_ROW_END,
    };
    ssfr_result result = SSFR_OK;
    ssfr_motion *motion = to;
    (void)row;
    SSFR_TRY(ssfr_reading_make(node, SSFR_YAML_LIST, sizeof *motion->keys, &motion->keys, &motion->n_keys));
    for (size_t i = 0; i < node->n; i++) {
        SSFR_TRY(ssfr_yaml_read_map(node->values[i], rows, &motion->keys[i]));
        if (i > 0 && !(motion->keys[i].time > motion->keys[i - 1].time))
            return ssfr_yaml_fail(node->values[i], SSFR_ERR_VALUE, "keys: %g s does not come after %g s",
                                  motion->keys[i].time, motion->keys[i - 1].time);
    }
end:
    return result;
}

/* A motion that begins again goes on from where it is: nothing in a fluid may jump. */
static ssfr_result check_period(const ssfr_motion *motion, const ssfr_yaml_node *node)
{
    const double slack = 1e-9; /* m, turns */
    const ssfr_pose_key *first = &motion->keys[0], *last = &motion->keys[motion->n_keys - 1];
    const double turns = (last->turn_deg - first->turn_deg) / 360;
    bool same = fabs(turns - round(turns)) < slack;
    if (motion->period < last->time)
        return ssfr_yaml_fail(node->key, SSFR_ERR_VALUE, "%s: a period of %g s, the last key is at %g s", motion->name,
                              motion->period, last->time);
    for (int k = 0; k < 3; k++) same &= fabs(last->move[k] - first->move[k]) < slack;
    if (!same)
        return ssfr_yaml_fail(node->key, SSFR_ERR_VALUE,
                              "%s: its last key differs from the first, where it begins again", motion->name);
    return SSFR_OK;
}

static ssfr_result read_motion(const ssfr_yaml_node *node, ssfr_motion *motion)
{
    static const char *const easings[] = {"smooth", "linear", NULL}; /* as ssfr_easing */
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("pivot", ssfr_yaml_read_real3, ssfr_motion, pivot, SSFR_RANGE_PLACE),
        SSFR_YAML_ROW("axis", ssfr_reading_direction, ssfr_motion, axis),
        SSFR_YAML_ROW("period", ssfr_yaml_read_real, ssfr_motion, period, .unit = "s", .min = 1e-3,
                      .max = SSFR_MAX_TIME),
        SSFR_YAML_ROW("easing", ssfr_yaml_read_word, ssfr_motion, easing, .words = easings),
        SSFR_YAML_ROW_ALL("keys", read_pose_keys, .needed = true),
        SSFR_YAML_ROW_END,
    };
    ssfr_result result = SSFR_OK;
    motion->axis[1] = 1;
    SSFR_TRY(ssfr_yaml_copy(&motion->name, "", node->name));
    SSFR_TRY(ssfr_yaml_read_map(node, rows, motion));
    if (motion->period > 0) SSFR_TRY(check_period(motion, node));
end:
    return result;
}

ssfr_result ssfr_reading_motions(ssfr_reading *r)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_reading_make(r->motions, SSFR_YAML_MAP, sizeof *r->d.motions, &r->d.motions, &r->d.n_motions));
    for (int i = 0; i < r->d.n_motions; i++) SSFR_TRY(read_motion(r->motions->values[i], &r->d.motions[i]));
end:
    return result;
}

ssfr_result ssfr_reading_find_motion(const ssfr_reading *r, const ssfr_yaml_node *motion, int *index)
{
    ssfr_result result = SSFR_OK;
    char list[300] = "none";
    size_t used = 0;
    *index = -1;
    if (!motion) return SSFR_OK;
    SSFR_TRY(ssfr_yaml_expect(motion, SSFR_YAML_TEXT));
    for (int i = 0; i < r->d.n_motions; i++) {
        if (strcmp(r->d.motions[i].name, motion->text) == 0) *index = i;
        ssfr_list_name(list, sizeof list, &used, r->d.motions[i].name);
    }
    if (*index < 0)
        result = ssfr_yaml_fail(motion, SSFR_ERR_UNKNOWN, "no motion %.80s: there are %s", motion->text, list);
end:
    return result;
}

/* ---- solids ------------------------------------------------------------------------------------------------------ */

typedef struct entry { /* a solid as it is written */
    const ssfr_yaml_node *word; /* of its shape */
    double centre[3], size[3];  /* m */
    double radius, inner, height;
    double axis[3];             /* unit */
    double turn_deg[3];
    double colour[3], friction, scale;
    bool hidden;
    const ssfr_yaml_node *motion, *file;
} entry;

#define ROW(key, reader, member, ...) SSFR_YAML_ROW(key, reader, entry, member, __VA_ARGS__)
#define COMMON                                              \
    ROW("shape", ssfr_yaml_read_node, word),                \
    ROW("motion", ssfr_yaml_read_node, motion),             \
    ROW("colour", ssfr_yaml_read_real3, colour, SHARE),     \
    ROW("friction", ssfr_yaml_read_real, friction, SHARE),  \
    ROW("hidden", ssfr_yaml_read_flag, hidden)
#define CENTRE ROW("centre", ssfr_yaml_read_real3, centre, .needed = true, SSFR_RANGE_PLACE)
#define SIZE ROW("size", ssfr_yaml_read_real3, size, .needed = true, SSFR_RANGE_LENGTH)
#define RADIUS ROW("radius", ssfr_yaml_read_real, radius, .needed = true, SSFR_RANGE_LENGTH)
#define HEIGHT ROW("height", ssfr_yaml_read_real, height, .needed = true, SSFR_RANGE_LENGTH)
#define INNER ROW("inner", ssfr_yaml_read_real, inner, .needed = true, SSFR_RANGE_LENGTH)
#define AXIS ROW("axis", ssfr_reading_direction, axis)
#define TURN ROW("turn_deg", ssfr_yaml_read_real3, turn_deg, ANGLE)

static const ssfr_yaml_row box_rows[] = {COMMON, CENTRE, SIZE, TURN, SSFR_YAML_ROW_END};
static const ssfr_yaml_row cylinder_rows[] = {COMMON, CENTRE, RADIUS, HEIGHT, AXIS, SSFR_YAML_ROW_END};
static const ssfr_yaml_row tube_rows[] = {COMMON, CENTRE, RADIUS, INNER, HEIGHT, AXIS, SSFR_YAML_ROW_END};
static const ssfr_yaml_row sphere_rows[] = {COMMON, CENTRE, RADIUS, SSFR_YAML_ROW_END};
static const ssfr_yaml_row plane_rows[] = {COMMON, CENTRE, ROW("normal", ssfr_reading_direction, axis),
                                           SSFR_YAML_ROW_END};
static const ssfr_yaml_row mesh_rows[] = {COMMON,
                                          ROW("file", ssfr_yaml_read_node, file, .needed = true),
                                          ROW("scale", ssfr_yaml_read_real, scale, FACTOR),
                                          ROW("centre", ssfr_yaml_read_real3, centre, SSFR_RANGE_PLACE),
                                          TURN,
                                          SSFR_YAML_ROW_END};

static const struct shape {
    const char *name;
    ssfr_shape shape;
    const ssfr_yaml_row *rows;
} shapes[] = {
    {"box", SSFR_BOX, box_rows},
    {"ramp", SSFR_RAMP, box_rows},
    {"cylinder", SSFR_CYLINDER, cylinder_rows},
    {"tube", SSFR_CYLINDER, tube_rows},
    {"sphere", SSFR_SPHERE, sphere_rows},
    {"plane", SSFR_PLANE, plane_rows},
    {"mesh", SSFR_MESH, mesh_rows},
};

/* What a solid may say depends on its shape. */
static ssfr_result find_shape(const ssfr_yaml_node *node, const struct shape **out)
{
    ssfr_result result = SSFR_OK;
    const ssfr_yaml_node *word;
    char list[100] = "";
    size_t used = 0;
    *out = NULL;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_MAP));
    word = ssfr_yaml_find(node, "shape");
    if (!word) return ssfr_yaml_fail(node->key, SSFR_ERR_FORMAT, "%.80s: shape must be given", node->name);
    SSFR_TRY(ssfr_yaml_expect(word, SSFR_YAML_TEXT));
    for (size_t i = 0; i < SSFR_COUNT(shapes) && !*out; i++) {
        if (strcmp(shapes[i].name, word->text) == 0) *out = &shapes[i];
        ssfr_list_name(list, sizeof list, &used, shapes[i].name);
    }
    if (!*out)
        result = ssfr_yaml_fail(word, SSFR_ERR_UNKNOWN, "no shape %.80s: there are %s", word->text, list);
end:
    return result;
}

/* Rows with y along the axis, and the world's for an upright one. */
static void set_axes(const double along[3], double axis[3][3])
{
    static const double x[3] = {1, 0, 0}, z[3] = {0, 0, 1};
    const bool lies_along_z = fabs(along[2]) > 0.9;
    memcpy(axis[1], along, sizeof axis[1]);
    if (lies_along_z) {
        ssfr_cross(x, along, axis[2]);
        ssfr_normalize(axis[2]);
        ssfr_cross(axis[1], axis[2], axis[0]);
    } else {
        ssfr_cross(along, z, axis[0]);
        ssfr_normalize(axis[0]);
        ssfr_cross(axis[0], axis[1], axis[2]);
    }
}

/* Turns the axes about the world's x, then y, then z. */
static void turn_axes(const double turn_deg[3], double axis[3][3])
{
    for (int k = 0; k < 3; k++) {
        const double angle = turn_deg[k] * acos(-1) / 180, c = cos(angle), s = sin(angle);
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        for (int row = 0; row < 3; row++) {
            const double a = axis[row][i], b = axis[row][j];
            axis[row][i] = c * a - s * b;
            axis[row][j] = s * a + c * b;
        }
    }
}

static ssfr_solid make_solid(const entry *e, ssfr_shape shape)
{
    ssfr_solid s = {.shape = shape, .inner = e->inner};
    const bool round = shape == SSFR_CYLINDER || shape == SSFR_SPHERE;
    memcpy(s.centre, e->centre, sizeof s.centre);
    memcpy(s.colour, e->colour, sizeof s.colour);
    for (int k = 0; k < 3; k++) s.half[k] = round ? e->radius : e->size[k] / 2;
    if (shape == SSFR_CYLINDER) s.half[1] = e->height / 2;
    set_axes(e->axis, s.axis);
    turn_axes(e->turn_deg, s.axis);
    return s;
}

/* Lines about a mesh begin with the place that names it. */
static ssfr_result load_mesh(const ssfr_reading *r, const ssfr_yaml_node *node, double scale, ssfr_body *body)
{
    ssfr_result result = SSFR_OK;
    char place[SSFR_YAML_PLACE];
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_TEXT));
    SSFR_TRY(ssfr_yaml_copy(&body->file, node->text[0] == '/' ? "" : r->folder, node->text));
    ssfr_log_about(ssfr_yaml_place(node, place));
    result = r->load_mesh(&body->mesh, body->file);
    ssfr_log_about(NULL);
    if (result != SSFR_OK) goto end;
    if (scale != 1) ssfr_mesh_scale(body->mesh, scale);
    for (int k = 0; k < 3; k++)
        if (fmax(-body->mesh->lo[k], body->mesh->hi[k]) > SSFR_MAX_LENGTH)
            return ssfr_yaml_fail(node, SSFR_ERR_VALUE, "%.80s: reaches from %g to %g m along %c", body->file,
                                  body->mesh->lo[k], body->mesh->hi[k], "xyz"[k]);
    body->solid.mesh = body->mesh;
end:
    return result;
}

static ssfr_result read_body(const ssfr_reading *r, const ssfr_yaml_node *node, ssfr_body *body)
{
    static const double grey = 0.5; /* reflectance */
    ssfr_result result = SSFR_OK;
    entry e = {.axis = {0, 1, 0}, .colour = {grey, grey, grey}, .scale = 1};
    const struct shape *shape;
    char what[SSFR_YAML_PLACE + 100], place[SSFR_YAML_PLACE];
    SSFR_TRY(find_shape(node, &shape));
    SSFR_TRY(ssfr_yaml_read_map(node, shape->rows, &e));
    SSFR_TRY(ssfr_yaml_copy(&body->name, "", node->name));
    SSFR_TRY(ssfr_reading_find_motion(r, e.motion, &body->motion));
    body->friction = e.friction;
    body->hidden = e.hidden;
    body->solid = make_solid(&e, shape->shape);
    if (e.file) SSFR_TRY(load_mesh(r, e.file, e.scale, body));
    snprintf(what, sizeof what, "%s: %.80s", ssfr_yaml_place(node->key, place), node->name);
    result = ssfr_solid_check(&body->solid, what);
end:
    return result;
}

/* As many as can be drawn, and as the solver takes, hidden ones among them. */
ssfr_result ssfr_reading_solids(ssfr_reading *r)
{
    ssfr_result result = SSFR_OK;
    const ssfr_yaml_node *node = r->solids;
    SSFR_TRY(ssfr_reading_make(node, SSFR_YAML_MAP, sizeof *r->d.bodies, &r->d.bodies, &r->d.n_bodies));
    if (r->d.n_bodies > SSFR_MAX_SOLIDS) {
        result = ssfr_yaml_fail(node->keys[SSFR_MAX_SOLIDS], SSFR_ERR_VALUE, "%.80s: more than %d solids",
                                node->keys[SSFR_MAX_SOLIDS]->text, SSFR_MAX_SOLIDS);
        goto end;
    }
    for (int i = 0; i < r->d.n_bodies; i++) SSFR_TRY(read_body(r, node->values[i], &r->d.bodies[i]));
end:
    return result;
}
