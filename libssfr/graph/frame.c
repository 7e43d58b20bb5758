/* SPDX-License-Identifier: MIT */
/* frame.c: camera, world and facts of one frame; culling by packets; the tiles that may hold fluid. */
#include "graph/frame.h"

#include "base/param.h"
#include "scene/mesh.h"
#include "scene/solid.h"

#include <float.h>

/* ---- the world's parameter groups ------------------------------------------------------------------------------- */

#define RGB(type, name, r, g, b, unit, max, help)                     \
    SSFR_PARAM_REAL(type, name##_r, unit, r, 0, max, help ", red"),   \
    SSFR_PARAM_REAL(type, name##_g, unit, g, 0, max, help ", green"), \
    SSFR_PARAM_REAL(type, name##_b, unit, b, 0, max, help ", blue")

static const ssfr_param medium_rows[] = {
    SSFR_PARAM_REAL(ssfr_medium, ior, "1", 1.333, 1, 4, "index of refraction"),
    RGB(ssfr_medium, absorption, 2.2, 0.65, 0.45, "1/m", 1e6, "absorption coefficient"),
    RGB(ssfr_medium, color, 0.01, 0.09, 0.13, "1", 1e3, "colour of infinitely thick fluid, linear"),
    SSFR_PARAM_END,
};

static const ssfr_param light_rows[] = {
    SSFR_PARAM_REAL(ssfr_light, azimuth_deg, "deg", 125, -360, 360, "direction to the light, from +x towards +z"),
    SSFR_PARAM_REAL(ssfr_light, elevation_deg, "deg", 40, -90, 90, "direction to the light above the horizon"),
    SSFR_PARAM_REAL(ssfr_light, intensity, "1", 1, 0, 1e3, "of the light, against the sky"),
    SSFR_PARAM_REAL(ssfr_light, ambient, "1", 0.45, 0, 1, "share of the light that reaches shaded faces of solids"),
    SSFR_PARAM_END,
};

static const ssfr_param sky_rows[] = {
    RGB(ssfr_sky, zenith, 0.16, 0.33, 0.68, "1", 1e3, "radiance at the zenith, linear"),
    RGB(ssfr_sky, horizon, 0.78, 0.86, 0.93, "1", 1e3, "radiance at the horizon, linear"),
    SSFR_PARAM_END,
};

static const ssfr_param floor_rows[] = {
    SSFR_PARAM_REAL(ssfr_floor, tile, "m", 0.4, 1e-6, 1e6, "side of a tile of the chequered floor"),
    SSFR_PARAM_REAL(ssfr_floor, light, "1", 0.62, 0, 1, "reflectance of the light tiles"),
    SSFR_PARAM_REAL(ssfr_floor, dark, "1", 0.34, 0, 1, "reflectance of the dark tiles"),
    SSFR_PARAM_REAL(ssfr_floor, haze, "m", 40, 1e-6, 1e9, "distance over which the floor fades into the horizon"),
    SSFR_PARAM_END,
};

static const struct group {
    const char *name;
    const ssfr_param *rows;
    size_t offset;
} groups[] = {
#define X(name, type) {#name, name##_rows, offsetof(ssfr_world, name)},
    SSFR_GROUPS(X)
#undef X
};

const char *ssfr_world_group(int i, const ssfr_param **rows, size_t *offset)
{
    const bool there = i >= 0 && (size_t)i < SSFR_COUNT(groups);
    *rows = there ? groups[i].rows : NULL;
    *offset = there ? groups[i].offset : 0;
    return there ? groups[i].name : NULL;
}

const char *ssfr_group_at(int i, const ssfr_param **rows)
{
    size_t offset;
    return ssfr_world_group(i, rows, &offset);
}

void ssfr_world_default(ssfr_world *world)
{
    for (size_t i = 0; i < SSFR_COUNT(groups); i++)
        ssfr_params_default(groups[i].rows, (char *)world + groups[i].offset);
}

/* ---- the block that shaders read --------------------------------------------------------------------------------- */

static void set4(double out[4], double x, double y, double z, double w)
{
    out[0] = x, out[1] = y, out[2] = z, out[3] = w;
}

/* Two tiles are one period of the floor, so the pattern needs the eye's place only modulo that. */
static double in_period(double position, double tile)
{
    return fmod(position, 2 * tile);
}

/* Where the mesh stands among the frame's, with those before it. */
static size_t add_mesh(ssfr_frame *frame, const ssfr_mesh *mesh)
{
    int i = 0;
    while (i < frame->n_meshes && frame->meshes[i] != mesh) i++;
    if (i == frame->n_meshes) {
        frame->meshes[frame->n_meshes] = mesh;
        frame->first_node[frame->n_meshes++] = frame->n_nodes;
        frame->n_nodes += mesh->n_nodes, frame->n_triangles += mesh->n_triangles;
    }
    return frame->first_node[i];
}

/* Half extents of the box around the solid in its own axes, m; infinite for a plane. */
static void half_extents(const ssfr_solid *s, double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = s->shape == SSFR_MESH     ? 0.5 * (s->mesh->hi[k] - s->mesh->lo[k])
                 : s->shape == SSFR_SPHERE ? s->half[0]
                 : s->shape == SSFR_PLANE  ? INFINITY
                                           : s->half[k];
}

static void fill_solid(ssfr_frame *frame, int i)
{
    const ssfr_solid *s = &frame->solids[i];
    double(*out)[4] = frame->block.solid[i], half[3], middle[3] = {s->centre[0], s->centre[1], s->centre[2]};
    half_extents(s, half);
    if (s->shape == SSFR_MESH) ssfr_solid_world(s, s->mesh->middle, middle);
    if (s->shape == SSFR_PLANE) /* its point next to the eye: the centre may be any, far away */
        for (int k = 0; k < 3; k++) middle[k] = ssfr_dot(s->centre, s->axis[1]) * s->axis[1][k];
    /* Larger by what a float may lose on the way from the eye. */
    const double around = 1.001 * sqrt(ssfr_dot(half, half)) + 1e-5 * sqrt(ssfr_dot(middle, middle));
    set4(out[0], middle[0], middle[1], middle[2], fmin(around * around, SSFR_EMPTY));
    for (int k = 0; k < 3; k++)
        set4(out[1 + k], s->axis[k][0], s->axis[k][1], s->axis[k][2], fmin(half[k], SSFR_EMPTY));
    set4(out[4], s->colour[0], s->colour[1], s->colour[2], 0);
    set4(out[5], s->shape, s->inner, s->shape == SSFR_MESH ? (double)add_mesh(frame, s->mesh) : 0, 0);
}

static void fill_solids(ssfr_frame *frame, const ssfr_scene *scene)
{
    frame->n_solids = scene->n_solids;
    frame->n_meshes = 0;
    frame->n_nodes = frame->n_triangles = 0;
    for (int i = 0; i < scene->n_solids; i++) {
        frame->solids[i] = scene->solids[i];
        for (int k = 0; k < 3; k++) frame->solids[i].centre[k] -= scene->camera.eye[k];
        fill_solid(frame, i);
    }
}

static void fill_block(ssfr_block *block, const ssfr_scene *scene, const ssfr_world *world)
{
    const ssfr_camera *camera = &scene->camera;
    const ssfr_medium *m = &world->medium;
    const ssfr_sky *sky = &world->sky;
    const ssfr_field *map = scene->environment;
    const double degree = M_PI / 180, tile = world->floor.tile;
    const double a = world->light.azimuth_deg * degree, e = world->light.elevation_deg * degree;
    const double floor_y = isfinite(scene->floor) ? scene->floor - camera->eye[1] : -SSFR_EMPTY;
    set4(block->image, camera->w, camera->h, 2 * camera->tan_x / camera->w, 2 * camera->tan_y / camera->h);
    set4(block->right, camera->right[0], camera->right[1], camera->right[2], floor_y);
    set4(block->up, camera->up[0], camera->up[1], camera->up[2], in_period(camera->eye[0], tile));
    set4(block->back, camera->back[0], camera->back[1], camera->back[2], in_period(camera->eye[2], tile));
    set4(block->light, cos(e) * cos(a), sin(e), cos(e) * sin(a), world->light.intensity);
    set4(block->absorption, m->absorption_r, m->absorption_g, m->absorption_b, m->ior);
    set4(block->fluid, m->color_r, m->color_g, m->color_b, world->light.ambient);
    set4(block->zenith, sky->zenith_r, sky->zenith_g, sky->zenith_b, scene->n_solids);
    set4(block->horizon, sky->horizon_r, sky->horizon_g, sky->horizon_b, camera->near);
    set4(block->floor, tile, world->floor.light, world->floor.dark, world->floor.haze);
    set4(block->map, map ? map->w : 0, map ? map->h : 0, 0, 0);
}

/* ---- the light --------------------------------------------------------------------------------------------------- */

/* From the level axis that is least along the light, so that none is degenerate. */
static void set_light_axes(ssfr_frame *frame)
{
    double(*axis)[3] = frame->light_axis;
    double level[3] = {0};
    const double *light = frame->block.light;
    level[fabs(light[0]) <= fabs(light[2]) ? 0 : 2] = 1;
    memcpy(axis[2], light, sizeof axis[2]);
    ssfr_cross(level, axis[2], axis[0]);
    ssfr_normalize(axis[0]);
    ssfr_cross(axis[2], axis[0], axis[1]);
}

static void forget_lit(ssfr_facts *facts)
{
    for (int k = 0; k < 3; k++) facts->lit_lo[k] = INFINITY, facts->lit_hi[k] = -INFINITY;
}

/* There is fluid in a box at `centre` (eye space), half as large as half (world axes) and `reach` larger all around. */
static void add_lit(ssfr_frame *frame, const double centre[3], const float half[3], double reach)
{
    ssfr_facts *facts = &frame->facts;
    for (int k = 0; k < 3 && frame->n_solids; k++) {
        const double *axis = frame->light_axis[k];
        double middle = 0, extent = reach;
        for (int j = 0; j < 3; j++) {
            middle += centre[j] * ssfr_dot(frame->rotation[j], axis);
            extent += fabs(axis[j]) * (double)half[j];
        }
        facts->lit_lo[k] = fmin(facts->lit_lo[k], middle - extent);
        facts->lit_hi[k] = fmax(facts->lit_hi[k], middle + extent);
    }
}

/* There may be fluid anywhere in view between two distances, m. */
static void add_lit_view(ssfr_frame *frame, double nearest, double farthest)
{
    static const float point[3] = {0, 0, 0};
    const double *image = frame->block.image, ends[2] = {nearest, farthest};
    for (int i = 0; i < 8; i++) {
        const double d = ends[i / 4], x = 0.5 * image[0] * image[2] * d, y = 0.5 * image[1] * image[3] * d;
        add_lit(frame, (const double[3]){i & 1 ? x : -x, i & 2 ? y : -y, -d}, point, 0);
    }
}

/* ---- facts ------------------------------------------------------------------------------------------------------- */

typedef struct bounds { /* of a packet, in eye space */
    double centre[3], half[3];
} bounds;

static bounds packet_bounds(const ssfr_frame *frame, size_t i, double reach)
{
    const ssfr_packet *packet = &frame->particles->packets[i];
    bounds b;
    for (int k = 0; k < 3; k++) {
        b.centre[k] = frame->offset[i][k];
        b.half[k] = reach;
        for (int j = 0; j < 3; j++) b.half[k] += fabs(frame->rotation[k][j]) * (double)packet->half[j];
    }
    return b;
}

/* The pixels that a box may touch along one axis, [lo, hi), for a box at [c - h, c + h] and distances [near, far]. */
static void project(double c, double h, double near, double far, double per_pixel, int size, int *lo, int *hi)
{
    const double a = fmin((c - h) / near, (c - h) / far), b = fmax((c + h) / near, (c + h) / far);
    /* One pixel more on each side, for what floats round and for the margins of splats. */
    *lo = (int)floor(ssfr_clamp(a / per_pixel + size / 2.0 - 1, 0, size));
    *hi = (int)ceil(ssfr_clamp(b / per_pixel + size / 2.0 + 1, 0, size));
}

static bool box_pixels(const ssfr_frame *frame, const bounds *b, double near, int lo[2], int hi[2])
{
    const double farthest = b->half[2] - b->centre[2], nearest = -b->half[2] - b->centre[2];
    lo[0] = lo[1] = 0, hi[0] = frame->w, hi[1] = frame->h;
    if (farthest < near) return false; /* behind the near plane */
    if (nearest > 1e-3 * farthest) {
        project(b->centre[0], b->half[0], nearest, farthest, frame->block.image[2], frame->w, &lo[0], &hi[0]);
        project(-b->centre[1], b->half[1], nearest, farthest, frame->block.image[3], frame->h, &lo[1], &hi[1]);
    }
    return lo[0] < hi[0] && lo[1] < hi[1];
}

static void mark_tiles(ssfr_facts *facts, const int lo[2], const int hi[2])
{
    const int x0 = lo[0] / SSFR_TILE, x1 = (hi[0] - 1) / SSFR_TILE;
    for (int y = lo[1] / SSFR_TILE; y <= (hi[1] - 1) / SSFR_TILE; y++)
        memset(facts->mask + (size_t)y * (size_t)facts->tiles_x + x0, 1, (size_t)(x1 - x0 + 1));
}

static size_t packet_size(const ssfr_frame *frame, size_t i)
{
    const size_t left = frame->n_particles - i * SSFR_PACKET;
    return left < SSFR_PACKET ? left : SSFR_PACKET;
}

static int n_tiles_of(const int lo[2], const int hi[2])
{
    return ((hi[0] - 1) / SSFR_TILE - lo[0] / SSFR_TILE + 1) * ((hi[1] - 1) / SSFR_TILE - lo[1] / SSFR_TILE + 1);
}

/* A packet of stray particles has a large box that is mostly empty: then each particle marks its own tiles. */
static void mark_packet(ssfr_frame *frame, size_t i, double reach, const int lo[2], const int hi[2])
{
    enum { FEW = 9 };
    const size_t start = i * SSFR_PACKET;
    if (n_tiles_of(lo, hi) <= FEW) {
        mark_tiles(&frame->facts, lo, hi);
        return;
    }
    for (size_t k = start; k < start + packet_size(frame, i); k++) {
        bounds b = {.half = {reach, reach, reach}};
        int from[2], to[2];
        ssfr_frame_eye(frame, k, b.centre);
        if (box_pixels(frame, &b, frame->near, from, to)) mark_tiles(&frame->facts, from, to);
    }
}

static void add_packet(ssfr_frame *frame, size_t i)
{
    ssfr_facts *facts = &frame->facts;
    const size_t start = i * SSFR_PACKET;
    const int n = (int)packet_size(frame, i), last = facts->n_ranges - 1;
    if (last >= 0 && (size_t)facts->first[last] + (size_t)facts->count[last] == start) {
        facts->count[last] += n;
    } else {
        facts->first[facts->n_ranges] = (int)start;
        facts->count[facts->n_ranges++] = n;
    }
    facts->n_particles += (size_t)n;
    facts->n_packets++;
}

/* The box around the solid, in eye space. */
static bounds solid_bounds(const ssfr_frame *frame, int i)
{
    bounds b = {0};
    for (int k = 0; k < 3; k++) {
        b.centre[k] = ssfr_dot(frame->rotation[k], frame->block.solid[i][0]);
        for (int j = 0; j < 3; j++)
            b.half[k] += fabs(ssfr_dot(frame->rotation[k], frame->block.solid[i][1 + j])) *
                         frame->block.solid[i][1 + j][3];
    }
    return b;
}

static ssfr_tile_kind kind_of(const ssfr_frame *frame, const ssfr_solid_set solids)
{
    int kind = SSFR_TILE_PLAIN;
    for (int i = 0; i < frame->n_solids; i++)
        if (solids[i / 32] >> i % 32 & 1)
            kind = ssfr_max_int(kind, frame->solids[i].shape == SSFR_MESH ? SSFR_TILE_MESHES : SSFR_TILE_SOLIDS);
    return (ssfr_tile_kind)kind;
}

static void list_by_solids(ssfr_frame *frame)
{
    ssfr_facts *facts = &frame->facts;
    const int n = facts->tiles_x * facts->tiles_y;
    int at = 0;
    for (ssfr_tile_kind kind = 0; kind < SSFR_N_TILE_KINDS; kind++) {
        const int first = at;
        for (int i = 0; i < n; i++)
            if (kind_of(frame, facts->solids[i]) == kind)
                facts->by_solids[at++] = (uint32_t)(i % facts->tiles_x) | (uint32_t)(i / facts->tiles_x) << 16;
        facts->n_by_solids[kind] = at - first;
    }
}

/* Rays begin in the eye, whatever the near plane is. */
static void mark_solids(ssfr_frame *frame, bool keep_all)
{
    ssfr_facts *facts = &frame->facts;
    memset(facts->solids, 0, (size_t)facts->tiles_x * (size_t)facts->tiles_y * sizeof *facts->solids);
    for (int i = 0; i < frame->n_solids; i++) {
        const bounds b = solid_bounds(frame, i);
        int lo[2] = {0, 0}, hi[2] = {frame->w, frame->h};
        const bool everywhere = keep_all || frame->solids[i].shape == SSFR_PLANE;
        if (!everywhere && !box_pixels(frame, &b, 0, lo, hi)) continue;
        for (int y = lo[1] / SSFR_TILE; y <= (hi[1] - 1) / SSFR_TILE; y++)
            for (int x = lo[0] / SSFR_TILE; x <= (hi[0] - 1) / SSFR_TILE; x++)
                facts->solids[y * facts->tiles_x + x][i / 32] |= 1u << i % 32;
    }
    list_by_solids(frame);
}

static void list_tiles(ssfr_facts *facts)
{
    facts->n_tiles = 0;
    for (int y = 0; y < facts->tiles_y; y++)
        for (int x = 0; x < facts->tiles_x; x++)
            if (facts->mask[y * facts->tiles_x + x]) facts->tiles[facts->n_tiles++] = (uint32_t)x | (uint32_t)y << 16;
    facts->covered = (double)facts->n_tiles / (double)(facts->tiles_x * facts->tiles_y);
}

/* By the particles' own spheres, however far some pass spreads its splats; `otherwise` when none of these is in
 * view. */
static double mean_distance(const ssfr_frame *frame, double otherwise)
{
    double sum = 0;
    size_t n_seen = 0;
    int lo[2], hi[2];
    for (size_t i = 0; i < frame->n_packets; i++) {
        const bounds b = packet_bounds(frame, i, frame->radius);
        if (!box_pixels(frame, &b, frame->near, lo, hi)) continue;
        sum -= b.centre[2] * (double)packet_size(frame, i);
        n_seen += packet_size(frame, i);
    }
    return n_seen ? sum / (double)n_seen : otherwise;
}

static void count_facts(ssfr_frame *frame, double reach, bool keep_all)
{
    ssfr_facts *facts = &frame->facts;
    /* The same for a pass by itself as in its pipeline, where others may draw wider splats. */
    const double around = fmax(reach, SSFR_SUPPORT) * frame->radius;
    double nearest = INFINITY;
    int lo[2], hi[2];
    facts->n_particles = facts->n_packets = 0;
    forget_lit(facts);
    facts->n_ranges = 0;
    memset(facts->mask, keep_all, (size_t)facts->tiles_x * (size_t)facts->tiles_y);
    for (size_t i = 0; i < frame->n_packets; i++) {
        const bounds b = packet_bounds(frame, i, reach * frame->radius);
        const bool visible = box_pixels(frame, &b, frame->near, lo, hi);
        if (visible) nearest = fmin(nearest, -b.centre[2] - b.half[2]);
        if (visible) add_lit(frame, b.centre, frame->particles->packets[i].half, around);
        if (visible && !keep_all) mark_packet(frame, i, reach * frame->radius, lo, hi);
        if (visible || keep_all) add_packet(frame, i);
    }
    facts->fluid = facts->seen = nearest < INFINITY;
    facts->layers = false;
    facts->nearest = fmax(nearest, frame->near);
    facts->mean = fmax(mean_distance(frame, facts->fluid ? facts->nearest : 0), frame->near);
    list_tiles(facts);
}

static void take_all_tiles(ssfr_facts *facts)
{
    memset(facts->mask, 1, (size_t)facts->tiles_x * (size_t)facts->tiles_y);
    list_tiles(facts);
}

void ssfr_frame_assume_fluid(ssfr_frame *frame, double nearest, double mean, double farthest)
{
    ssfr_facts *facts = &frame->facts;
    if (!facts->fluid) {
        facts->nearest = fmax(nearest, frame->near);
        facts->mean = fmax(mean, frame->near);
    }
    facts->fluid = true;
    take_all_tiles(facts);
    if (!facts->seen)
        add_lit_view(frame, fmax(nearest, frame->near), farthest > 0 ? farthest : frame->scene->camera.far);
}

void ssfr_frame_assume_layers(ssfr_frame *frame)
{
    frame->facts.layers = true;
    take_all_tiles(&frame->facts);
}

/* ---- preparing --------------------------------------------------------------------------------------------------- */

static ssfr_result reserve(ssfr_frame *frame, long *grew)
{
    ssfr_result result = SSFR_OK;
    ssfr_facts *facts = &frame->facts;
    const size_t n_tiles = (size_t)facts->tiles_x * (size_t)facts->tiles_y;
    if (frame->n_packets > frame->cap_packets) {
        free(frame->offset), free(facts->first), free(facts->count);
        frame->offset = NULL, facts->first = facts->count = NULL, frame->cap_packets = 0;
        SSFR_TRY(ssfr_alloc(&frame->offset, frame->n_packets, sizeof *frame->offset, "packet offsets"));
        SSFR_TRY(ssfr_alloc(&facts->first, frame->n_packets, sizeof *facts->first, "particle ranges"));
        SSFR_TRY(ssfr_alloc(&facts->count, frame->n_packets, sizeof *facts->count, "particle ranges"));
        frame->cap_packets = frame->n_packets;
        ++*grew;
    }
    if (n_tiles > frame->cap_tiles) {
        free(facts->tiles), free(facts->mask), free(facts->solids), free(facts->by_solids);
        facts->tiles = facts->by_solids = NULL, facts->mask = NULL, facts->solids = NULL, frame->cap_tiles = 0;
        SSFR_TRY(ssfr_alloc(&facts->tiles, n_tiles, sizeof *facts->tiles, "tiles"));
        SSFR_TRY(ssfr_alloc(&facts->mask, n_tiles, 1, "tiles"));
        SSFR_TRY(ssfr_alloc(&facts->solids, n_tiles, sizeof *facts->solids, "tiles"));
        SSFR_TRY(ssfr_alloc(&facts->by_solids, n_tiles, sizeof *facts->by_solids, "tiles"));
        frame->cap_tiles = n_tiles;
        ++*grew;
    }
end:
    return result;
}

static ssfr_result check_camera(const ssfr_camera *c)
{
    if (c->w < 1 || c->h < 1 || c->w > SSFR_MAX_SIZE || c->h > SSFR_MAX_SIZE)
        return ssfr_fail(SSFR_ERR_VALUE, "image of %d x %d pixels: sides go from 1 to %d", c->w, c->h, SSFR_MAX_SIZE);
    if (!(c->tan_x > 0 && c->tan_y > 0 && isfinite(c->tan_x) && isfinite(c->tan_y)))
        return ssfr_fail(SSFR_ERR_VALUE, "camera: half widths at unit distance are %g and %g", c->tan_x, c->tan_y);
    if (!(c->near > 0 && c->near < c->far))
        return ssfr_fail(SSFR_ERR_VALUE, "camera: near %g and far %g; 0 < near < far is needed", c->near, c->far);
    if (!ssfr_all_finite(c->eye))
        return ssfr_fail(SSFR_ERR_VALUE, "camera: eye %g,%g,%g is not finite", c->eye[0], c->eye[1], c->eye[2]);
    if (!ssfr_axes_are_orthonormal(c->right, c->up, c->back))
        return ssfr_fail(SSFR_ERR_VALUE, "camera: right, up and back are not orthonormal");
    return SSFR_OK;
}

static ssfr_result check_solids(const ssfr_scene *scene)
{
    ssfr_result result = SSFR_OK;
    if (scene->n_solids < 0 || scene->n_solids > SSFR_MAX_SOLIDS)
        return ssfr_fail(SSFR_ERR_VALUE, "%d solids, at most %d are drawn", scene->n_solids, SSFR_MAX_SOLIDS);
    for (int i = 0; i < scene->n_solids; i++) {
        char what[32];
        snprintf(what, sizeof what, "solid %d (from 0)", i);
        SSFR_TRY(ssfr_solid_check(&scene->solids[i], what));
    }
end:
    return result;
}

static uint64_t mix(uint64_t key, const void *bytes, size_t n)
{
    for (size_t i = 0; i < n; i++) key = (key ^ ((const unsigned char *)bytes)[i]) * 0x100000001b3u; /* FNV-1a */
    return key;
}

/* Of where the map is, its size, and some thousand of its values. */
static uint64_t environment_key(const ssfr_field *map)
{
    enum { N_SAMPLES = 4096 };
    const size_t n = (size_t)map->w * (size_t)map->h * 3, step = n / N_SAMPLES + 1;
    const int size[2] = {map->w, map->h};
    uint64_t key = mix(mix(0xcbf29ce484222325u, size, sizeof size), &map->data, sizeof map->data);
    for (size_t i = 0; i < n; i += step) key = mix(key, map->data + i, sizeof *map->data);
    return key ? key : 1;
}

static ssfr_result check_environment(ssfr_frame *frame, const ssfr_field *map)
{
    const uint64_t before = frame->environment_key;
    frame->environment_key = 0;
    if (!map) return SSFR_OK;
    if (map->w < 1 || map->h < 1 || map->w > SSFR_MAX_SIZE || map->h > SSFR_MAX_SIZE || map->c != 3)
        return ssfr_fail(SSFR_ERR_VALUE, "environment of %d x %d pixels and %d channels: sides go from 1 to %d, with 3 "
                         "channels", map->w, map->h, map->c, SSFR_MAX_SIZE);
    const uint64_t key = environment_key(map);
    for (size_t i = 0; key != before && i < (size_t)map->w * (size_t)map->h * 3; i++)
        if (!(fabs(map->data[i]) <= (double)FLT_MAX))
            return ssfr_fail(SSFR_ERR_VALUE, "environment: pixel %zu,%zu is %g", i / 3 % (size_t)map->w,
                             i / 3 / (size_t)map->w, map->data[i]);
    frame->environment_key = key;
    return SSFR_OK;
}

static ssfr_result check_scene(ssfr_frame *frame, const ssfr_scene *scene)
{
    ssfr_result result = SSFR_OK;
    const ssfr_particles *p = scene->particles;
    SSFR_TRY(check_camera(&scene->camera));
    SSFR_TRY(check_solids(scene));
    SSFR_TRY(check_environment(frame, scene->environment));
    if (isnan(scene->floor))
        return ssfr_fail(SSFR_ERR_VALUE, "floor at %g m: expected a height, or -inf for none", scene->floor);
    if (p && p->n && !(p->radius > 0 && isfinite(p->radius)))
        return ssfr_fail(SSFR_ERR_VALUE, "particle radius %g m: it must be positive", p->radius);
    if (p && p->n > INT32_MAX / 8)
        return ssfr_fail(SSFR_ERR_VALUE, "%zu particles, at most %d are drawn", p->n, INT32_MAX / 8);
    if (scene->timed && !isfinite(scene->time))
        return ssfr_fail(SSFR_ERR_VALUE, "a frame at %g s: expected a time, or a frame that is not timed", scene->time);
end:
    return result;
}

static void place_eye(ssfr_frame *frame, const ssfr_scene *scene, const ssfr_world *world)
{
    const ssfr_camera *camera = &scene->camera;
    frame->scene = scene;
    frame->w = camera->w, frame->h = camera->h, frame->near = camera->near;
    frame->facts.tiles_x = (camera->w + SSFR_TILE - 1) / SSFR_TILE;
    frame->facts.tiles_y = (camera->h + SSFR_TILE - 1) / SSFR_TILE;
    for (int k = 0; k < 3; k++)
        frame->rotation[0][k] = camera->right[k], frame->rotation[1][k] = camera->up[k],
        frame->rotation[2][k] = camera->back[k];
    fill_block(&frame->block, scene, world);
    set_light_axes(frame);
    fill_solids(frame, scene);
}

/* Formed in double: the difference of two large world coordinates must not pass through a float. */
static void eye_from_world(const ssfr_frame *frame, const double point[3], double out[3])
{
    const double *eye = frame->scene->camera.eye;
    const double d[3] = {point[0] - eye[0], point[1] - eye[1], point[2] - eye[2]};
    for (int k = 0; k < 3; k++) out[k] = ssfr_dot(frame->rotation[k], d);
}

ssfr_result ssfr_frame_prepare(ssfr_frame *frame, const ssfr_scene *scene, const ssfr_world *world, double reach,
                               unsigned keep, long *grew)
{
    ssfr_result result = SSFR_OK;
    const ssfr_particles *p = scene->particles;
    SSFR_TRY(check_scene(frame, scene));
    place_eye(frame, scene, world);
    frame->particles = p;
    frame->n_particles = p ? p->n : 0;
    frame->n_packets = p ? p->n_packets : 0;
    frame->radius = p ? p->radius : 0;
    SSFR_TRY(reserve(frame, grew));
    for (size_t i = 0; i < frame->n_packets; i++) eye_from_world(frame, p->packets[i].centre, frame->offset[i]);
    count_facts(frame, reach, (keep & SSFR_KEEP_PARTICLES) != 0);
    mark_solids(frame, (keep & SSFR_KEEP_SOLIDS) != 0);
end:
    return result;
}

ssfr_result ssfr_frame_prepare_host(ssfr_frame *frame, const ssfr_scene *scene, const ssfr_world *world, size_t n,
                                    const double origin[3], double radius, unsigned keep, long *grew)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(check_scene(frame, scene));
    place_eye(frame, scene, world);
    frame->particles = NULL;
    frame->n_particles = n;
    frame->n_packets = (n + SSFR_PACKET - 1) / SSFR_PACKET;
    frame->radius = radius;
    SSFR_TRY(reserve(frame, grew));
    for (size_t i = 0; i < frame->n_packets; i++) eye_from_world(frame, origin, frame->offset[i]);
    frame->facts.n_particles = n;
    frame->facts.n_packets = frame->n_packets;
    frame->facts.n_ranges = n > 0;
    if (n) frame->facts.first[0] = 0, frame->facts.count[0] = (int)n;
    frame->facts.fluid = n > 0;
    frame->facts.layers = false;
    frame->facts.seen = false;
    frame->facts.nearest = frame->facts.mean = frame->near;
    forget_lit(&frame->facts);
    if (n) add_lit_view(frame, frame->near, scene->camera.far);
    take_all_tiles(&frame->facts);
    mark_solids(frame, (keep & SSFR_KEEP_SOLIDS) != 0);
end:
    return result;
}

void ssfr_frame_sample_host(ssfr_frame *frame, size_t n, const float (*positions)[3])
{
    const double *image = frame->block.image;
    double sum = 0;
    size_t n_seen = 0;
    for (size_t i = 0; i < n; i++) {
        const double p[3] = {(double)positions[i][0], (double)positions[i][1], (double)positions[i][2]};
        double eye[3];
        for (int k = 0; k < 3; k++) eye[k] = frame->offset[0][k] + ssfr_dot(frame->rotation[k], p);
        const double x = 0.5 * image[0] * image[2] * -eye[2], y = 0.5 * image[1] * image[3] * -eye[2];
        if (-eye[2] < frame->near || fabs(eye[0]) > x + frame->radius || fabs(eye[1]) > y + frame->radius) continue;
        sum -= eye[2];
        n_seen++;
    }
    frame->facts.mean = fmax(n_seen ? sum / (double)n_seen : 0, frame->near);
}

void ssfr_frame_finish(ssfr_frame *frame)
{
    free(frame->offset);
    free(frame->facts.first), free(frame->facts.count);
    free(frame->facts.tiles), free(frame->facts.mask), free(frame->facts.solids);
    free(frame->facts.by_solids);
    *frame = (ssfr_frame){0};
}
