/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stage.c: loading a scene by name and finding a view that frames it. */
#include "experiments/stage.h"
#include "experiments/scenes/scenes.h"

#include <unistd.h>

#define ROW(...) SSFR_OPTION(ssfr_stage_options, __VA_ARGS__)
const ssfr_option ssfr_stage_rows[] = {
    ROW(radius, "radius", 0, NUMBER, "M", "particle radius, m (default: the file's, else estimated)", 1e-9, 1e9),
    ROW(drop_nonfinite, "drop-nonfinite", 0, FLAG, NULL, "drop particles with a NaN or infinite value", 0, 0),
    ROW(size, "size", 0, SIZE, "WxH", "image size, px (default 1280x720)", 0, 0),
    ROW(eye, "eye", 0, VECTOR, "X,Y,Z", "camera position, m (default: where all particles just fit)", 0, 0),
    ROW(target, "target", 0, VECTOR, "X,Y,Z", "the point looked at, m (default: the middle)", 0, 0),
    ROW(up, "up", 0, VECTOR, "X,Y,Z", "the direction that is up in the image (default 0,1,0)", 0, 0),
    ROW(fov_deg, "fov", 0, NUMBER, "DEG", "full vertical field of view (default 45)", 0.001, 179),
    SSFR_OPTION_END,
};

static const double margin = 0.05;       /* of half the image, left free around the framed box */
static const double elevation = 25;      /* degrees above the horizon that the default view looks down from */
static const double depth_ratio = 1e4;   /* far over near at most: what is left of window depth */
static const double range_slack = 1.01;  /* near and far stand this far off the particles */

void ssfr_stage_defaults(ssfr_stage_options *options)
{
    *options = (ssfr_stage_options){
        .eye = {NAN, NAN, NAN}, .target = {NAN, NAN, NAN}, .up = {NAN, NAN, NAN},
        .fov_deg = 45, .size = {1280, 720}, .seed = 1};
}

void ssfr_stage_bounds(const ssfr_stage *stage, double lo[3], double hi[3])
{
    ssfr_particles_bounds(stage->particles, lo, hi);
    for (int k = 0; k < 3 && stage->particles->n; k++) {
        lo[k] -= stage->particles->radius;
        hi[k] += stage->particles->radius;
    }
}

/* ---- the view ---------------------------------------------------------------------------------------------------- */

/* A corner of the box relative to a point, in the camera's axes. */
static void corner_from(const ssfr_camera *camera, const double lo[3], const double hi[3], int corner,
                        const double origin[3], double out[3])
{
    double p[3];
    for (int k = 0; k < 3; k++) p[k] = (corner >> k & 1 ? hi[k] : lo[k]) - origin[k];
    out[0] = ssfr_dot(camera->right, p);
    out[1] = ssfr_dot(camera->up, p);
    out[2] = ssfr_dot(camera->back, p);
}

/* How far from the target an eye along `back` must be for the box to fill the view up to the margin, m: a corner at
 * (x, y, z) from the target fits from D on where |x| = (1 - margin) tan_x (D - z), and the same in y. */
static double framing_distance(const ssfr_camera *camera, const double lo[3], const double hi[3],
                               const double target[3])
{
    double distance = 0;
    for (int i = 0; i < 8; i++) {
        double p[3];
        corner_from(camera, lo, hi, i, target, p);
        distance = fmax(distance, p[2] + fabs(p[0]) / ((1 - margin) * camera->tan_x));
        distance = fmax(distance, p[2] + fabs(p[1]) / ((1 - margin) * camera->tan_y));
    }
    return distance > 0 ? distance : 1;
}

/* near and far around the box, with room for splats that are drawn wider than their particles. An eye inside or
 * beside it sees from far / depth_ratio on. */
static void set_range(ssfr_camera *camera, const double lo[3], const double hi[3], double room)
{
    double nearest = INFINITY, farthest = 0;
    for (int i = 0; i < 8; i++) {
        double p[3];
        corner_from(camera, lo, hi, i, camera->eye, p);
        nearest = fmin(nearest, -p[2]);
        farthest = fmax(farthest, -p[2]);
    }
    camera->far = farthest > 0 ? range_slack * (farthest + room) : 1; /* all behind the eye: any range will do */
    camera->near = fmax((nearest - room) / range_slack, camera->far / depth_ratio);
}

/* From the long side, slightly above. */
static void default_direction(const double lo[3], const double hi[3], double from[3])
{
    const double angle = elevation * acos(-1) / 180;
    const int across = hi[0] - lo[0] >= hi[2] - lo[2] ? 2 : 0;
    from[0] = from[2] = 0;
    from[across] = cos(angle);
    from[1] = sin(angle);
}

/* 0,1,0 unless given; the far side of the ground when the view is straight up or down. */
static void choose_up(const ssfr_stage_options *options, const double from[3], double up[3])
{
    static const double vertical[3] = {0, 1, 0}, away[3] = {0, 0, -1};
    const bool steep = hypot(from[0], from[2]) <= 1e-6 * fabs(from[1]);
    memcpy(up, !isnan(options->up[0]) ? options->up : steep ? away : vertical, 3 * sizeof *up);
}

static void empty_box(double lo[3], double hi[3])
{
    for (int k = 0; k < 3; k++) lo[k] = -0.5, hi[k] = 0.5;
}

void ssfr_stage_view_box(const ssfr_stage *stage, double lo[3], double hi[3])
{
    const double top = stage->builtin ? stage->builtin->top : 0;
    ssfr_stage_bounds(stage, lo, hi);
    if (stage->particles->n == 0) empty_box(lo, hi);
    if (top != 0) hi[1] = fmin(hi[1], top);
}

/* The direction towards the eye: where the user put it, else the scene's, else the default. */
static void choose_direction(const ssfr_stage *stage, const ssfr_stage_options *options, const double lo[3],
                             const double hi[3], const double target[3], double from[3])
{
    default_direction(lo, hi, from);
    if (stage->builtin && ssfr_dot(stage->builtin->from, stage->builtin->from) > 0)
        memcpy(from, stage->builtin->from, sizeof stage->builtin->from);
    for (int k = 0; k < 3 && !isnan(options->eye[0]); k++) from[k] = options->eye[k] - target[k];
}

ssfr_result ssfr_stage_aim(ssfr_stage *stage, const ssfr_stage_options *options)
{
    ssfr_result result = SSFR_OK;
    ssfr_camera camera;
    double lo[3], hi[3], target[3], from[3], eye[3], up[3];
    const double fov = options->fov_deg * acos(-1) / 180;
    ssfr_stage_view_box(stage, lo, hi);
    for (int k = 0; k < 3; k++) target[k] = isnan(options->target[0]) ? 0.5 * (lo[k] + hi[k]) : options->target[k];
    choose_direction(stage, options, lo, hi, target, from);
    choose_up(options, from, up);
    for (int k = 0; k < 3; k++) eye[k] = target[k] + from[k];
    SSFR_TRY(ssfr_camera_look(&camera, eye, target, up, fov, options->size[0], options->size[1]));
    if (isnan(options->eye[0])) {
        const double distance = framing_distance(&camera, lo, hi, target);
        for (int k = 0; k < 3; k++) camera.eye[k] = target[k] + distance * camera.back[k];
    }
    ssfr_stage_bounds(stage, lo, hi);
    if (stage->particles->n == 0) empty_box(lo, hi);
    set_range(&camera, lo, hi, 2 * stage->particles->radius);
    stage->scene.camera = camera;
end:
    return result;
}

/* ---- the particles ----------------------------------------------------------------------------------------------- */

static ssfr_result fail_unknown(const char *scene)
{
    char names[512] = "";
    size_t used = 0;
    for (int i = 0; ssfr_builtin_at(i) && used < sizeof names; i++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", i ? ", " : "", ssfr_builtin_at(i)->name);
    return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: no such file, and not a built-in scene (%s)", scene, names);
}

static ssfr_result load_file(ssfr_stage *stage, const char *path, const ssfr_stage_options *options)
{
    ssfr_load_options load = {.radius = options->radius, .drop_nonfinite = options->drop_nonfinite};
    if (access(path, F_OK) != 0) return fail_unknown(path);
    const ssfr_result result = ssfr_particles_load(&stage->particles, path, &load);
    stage->n_dropped = load.n_dropped;
    if (result == SSFR_OK && load.n_dropped)
        ssfr_log(SSFR_WARNING, "%s: dropped %zu particles with a value that is not finite", path, load.n_dropped);
    return result;
}

static double choose_floor(const ssfr_stage *stage)
{
    double lo[3], hi[3];
    if (stage->builtin && !isnan(stage->builtin->floor)) return stage->builtin->floor;
    ssfr_stage_bounds(stage, lo, hi);
    return lo[1];
}

ssfr_result ssfr_stage_create(ssfr_stage **out, const char *scene, const ssfr_stage_options *options)
{
    ssfr_result result = SSFR_OK;
    ssfr_stage *stage = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&stage, 1, sizeof *stage, "a stage"));
    SSFR_TRY(ssfr_alloc(&stage->name, strlen(scene) + 1, 1, "a name"));
    strcpy(stage->name, scene);
    stage->builtin = ssfr_builtin_find(scene);
    if (stage->builtin)
        SSFR_TRY(stage->builtin->make(&stage->particles, options->seed));
    else
        SSFR_TRY(load_file(stage, scene, options));
    if (options->radius > 0) stage->particles->radius = options->radius;
    for (int i = 0; stage->builtin && i < stage->builtin->n_solids; i++) stage->solids[i] = stage->builtin->solids[i];
    stage->scene = (ssfr_scene){.particles = stage->particles,
                                .solids = stage->solids,
                                .n_solids = stage->builtin ? stage->builtin->n_solids : 0,
                                .floor = choose_floor(stage)};
    SSFR_TRY(ssfr_stage_aim(stage, options));
    *out = stage;
    stage = NULL;
end:
    ssfr_stage_destroy(&stage);
    return result;
}

void ssfr_stage_destroy(ssfr_stage **stage)
{
    if (*stage) {
        ssfr_particles_destroy(&(*stage)->particles);
        free((*stage)->name);
    }
    free(*stage);
    *stage = NULL;
}
