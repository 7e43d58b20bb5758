/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stage_view.c: where a stage is seen from: the user's camera, the scene's, or one that frames the particles. */
#include "experiments/stage.h"

static const double margin = 0.05;       /* of half the image, left free around the framed box */
static const double elevation = 25;      /* degrees above the horizon that the default view looks down from */
static const double default_fov = 45;    /* degrees, full vertical */
static const double depth_ratio = 1e6;   /* far over near at most: from 1 m to 100 km, and a little */
static const double range_slack = 1.01;  /* near and far stand this far off the particles */

void ssfr_stage_bounds(const ssfr_stage *stage, double lo[3], double hi[3])
{
    ssfr_particles_bounds(stage->particles, lo, hi);
    for (int k = 0; k < 3 && stage->particles->n; k++) {
        lo[k] -= stage->particles->radius;
        hi[k] += stage->particles->radius;
    }
}

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

static void empty_box(double lo[3], double hi[3])
{
    for (int k = 0; k < 3; k++) lo[k] = -0.5, hi[k] = 0.5;
}

void ssfr_stage_view_box(const ssfr_stage *stage, double lo[3], double hi[3])
{
    const double top = stage->source.builtin ? stage->source.builtin->top : 0;
    if (stage->is_held) {
        memcpy(lo, stage->held_lo, sizeof stage->held_lo);
        memcpy(hi, stage->held_hi, sizeof stage->held_hi);
        return;
    }
    ssfr_stage_bounds(stage, lo, hi);
    if (stage->particles->n == 0) empty_box(lo, hi);
    if (top != 0) hi[1] = fmin(hi[1], top);
}

/* All that near and far must hold. */
static void range_box(const ssfr_stage *stage, double lo[3], double hi[3])
{
    ssfr_stage_bounds(stage, lo, hi);
    if (stage->particles->n == 0) empty_box(lo, hi);
    for (int k = 0; k < 3 && stage->is_held; k++) {
        lo[k] = fmin(lo[k], stage->held_lo[k]);
        hi[k] = fmax(hi[k], stage->held_hi[k]);
    }
}

/* ---- who says where from ----------------------------------------------------------------------------------------- */

typedef struct aim {
    double eye[3], target[3], up[3]; /* m; up NaN: not said */
    double fov_deg;
    bool framed; /* the eye is a direction: it goes as far as the box needs */
} aim;

static bool is_said(const double v[3])
{
    return !isnan(v[0]);
}

static aim frame_box(const ssfr_stage *stage, const double lo[3], const double hi[3])
{
    const ssfr_builtin *builtin = stage->source.builtin;
    aim a = {.up = {NAN, NAN, NAN}, .fov_deg = default_fov, .framed = true};
    double from[3];
    default_direction(lo, hi, from);
    if (builtin && ssfr_dot(builtin->from, builtin->from) > 0) memcpy(from, builtin->from, sizeof from);
    for (int k = 0; k < 3; k++) {
        a.target[k] = 0.5 * (lo[k] + hi[k]);
        a.eye[k] = a.target[k] + from[k];
    }
    return a;
}

/* A camera stands still all the same: only a path has times. */
static ssfr_result check_camera_time(const ssfr_stage *stage, const ssfr_view *view, double time)
{
    if (isnan(time) || (view && view->n_keys > 1)) return SSFR_OK;
    return ssfr_fail(SSFR_ERR_VALUE, "--camera-time %g: %s: %s%s", time, stage->name, view ? view->name : "",
                     view ? ": the camera has no path" : "there is no camera");
}

ssfr_result ssfr_stage_find_view(const ssfr_stage *stage, const ssfr_stage_options *options, const ssfr_view **out)
{
    ssfr_result result = SSFR_OK;
    const ssfr_builtin *builtin = stage->source.builtin;
    *out = NULL;
    if (!stage->description && options->camera && !(builtin && builtin->n_views))
        return ssfr_fail(SSFR_ERR_UNKNOWN, "--camera %s: %s has no cameras", options->camera, stage->name);
    if (builtin && options->camera)
        SSFR_TRY(ssfr_view_find(builtin->n_views, builtin->views, builtin->name, options->camera, out));
    else if (stage->description)
        SSFR_TRY(ssfr_description_view(stage->description, options->camera, out));
    SSFR_TRY(check_camera_time(stage, *out, options->camera_time));
end:
    return result;
}

ssfr_result ssfr_stage_find_path(const ssfr_stage *stage, const ssfr_stage_options *options, bool follow,
                                 const ssfr_view **out)
{
    ssfr_result result = SSFR_OK;
    const ssfr_description *d = stage->description;
    const ssfr_view *view;
    *out = NULL;
    SSFR_TRY(ssfr_stage_find_view(stage, options, &view));
    if (!view || view->n_keys < 2)
        return ssfr_fail(SSFR_ERR_VALUE, "path: %s: %s%s", stage->name, view ? view->name : "there is no camera",
                         view ? ": the camera has no path" : "");
    const double last = view->keys[view->n_keys - 1].time;
    if (follow && lround(last * d->frame_rate) >= d->n_frames)
        return ssfr_fail(SSFR_ERR_VALUE, "path: %s: %s goes on to %g s, which no frame shows", stage->name, view->name,
                         last);
    *out = view;
end:
    return result;
}

double ssfr_stage_view_time(const ssfr_view *path, size_t i, size_t n)
{
    const double share = n > 1 ? (double)i / (double)(n - 1) : 0;
    return ssfr_mix(path->keys[0].time, path->keys[path->n_keys - 1].time, share);
}

static ssfr_result take_camera(const ssfr_stage *stage, const ssfr_stage_options *options, aim *a)
{
    ssfr_result result = SSFR_OK;
    const double time = options->camera_time;
    const ssfr_view *view = NULL;
    SSFR_TRY(ssfr_stage_find_view(stage, options, &view));
    if (view) {
        const ssfr_view_key key = ssfr_view_at(view, isnan(time) ? stage->time : time);
        *a = (aim){.fov_deg = key.fov_deg};
        memcpy(a->eye, key.eye, sizeof a->eye);
        memcpy(a->target, key.target, sizeof a->target);
        memcpy(a->up, view->up, sizeof a->up);
    }
end:
    return result;
}

static void take_users(const ssfr_stage_options *options, aim *a)
{
    for (int k = 0; k < 3 && is_said(options->target); k++) {
        if (a->framed) a->eye[k] += options->target[k] - a->target[k]; /* keeps its direction */
        a->target[k] = options->target[k];
    }
    if (is_said(options->eye)) memcpy(a->eye, options->eye, sizeof a->eye), a->framed = false;
    if (is_said(options->up)) memcpy(a->up, options->up, sizeof a->up);
    if (!isnan(options->fov_deg)) a->fov_deg = options->fov_deg;
}

/* 0,1,0; the far side of the ground when the view is straight up or down. */
static void default_up(const aim *a, double up[3])
{
    static const double vertical[3] = {0, 1, 0}, away[3] = {0, 0, -1};
    const bool steep =
        hypot(a->eye[0] - a->target[0], a->eye[2] - a->target[2]) <= 1e-6 * fabs(a->eye[1] - a->target[1]);
    memcpy(up, steep ? away : vertical, 3 * sizeof *up);
}

ssfr_result ssfr_stage_aim(ssfr_stage *stage, const ssfr_stage_options *options)
{
    ssfr_result result = SSFR_OK;
    ssfr_camera camera;
    double lo[3], hi[3];
    ssfr_stage_view_box(stage, lo, hi);
    aim a = frame_box(stage, lo, hi);
    SSFR_TRY(take_camera(stage, options, &a));
    take_users(options, &a);
    if (!is_said(a.up)) default_up(&a, a.up);
    SSFR_TRY(ssfr_camera_look(&camera, a.eye, a.target, a.up, a.fov_deg * acos(-1) / 180, options->size[0],
                              options->size[1]));
    if (a.framed) {
        const double distance = framing_distance(&camera, lo, hi, a.target);
        for (int k = 0; k < 3; k++) camera.eye[k] = a.target[k] + distance * camera.back[k];
    }
    range_box(stage, lo, hi);
    set_range(&camera, lo, hi, 2 * stage->particles->radius);
    stage->scene.camera = camera;
end:
    return result;
}
