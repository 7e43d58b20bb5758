/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stage.c: loading a scene by name, and a frame of it. */
#include "experiments/stage.h"
#include "experiments/scenes/make.h"

#define ROW(...) SSFR_OPTION(ssfr_stage_options, __VA_ARGS__)
const ssfr_option ssfr_scene_rows[] = {
    ROW(scale, "scale", 0, WORD, "quick|full",
        "particles of a simulated scene: a sixteenth of the paper's (default), or all", 0, 0),
    ROW(frame, "frame", 0, INTEGER, "N", "the frame (default: the one two thirds of the way)", 0, SSFR_MAX_FRAME),
    ROW(time, "time", 0, NUMBER, "S", "the frame of a simulated scene that is nearest to this time, s", 0, 1e9),
    ROW(cache, "cache", 0, TEXT, "DIR",
        "where simulated frames are kept (default: ssfr/scenes in $XDG_CACHE_HOME or ~/.cache)", 0, 0),
    SSFR_OPTION_END,
};

const ssfr_option ssfr_file_rows[] = {
    ROW(radius, "radius", 0, NUMBER, "M", "particle radius, m (default: the file's, else estimated)", 1e-9, 1e9),
    ROW(drop_nonfinite, "drop-nonfinite", 0, FLAG, NULL, "drop particles with a NaN or infinite value", 0, 0),
    ROW(unit, "unit", 0, NUMBER, "M", "the file's unit of length, m (default 1)", 1e-9, 1e9),
    ROW(up_axis, "up-axis", 0, WORD, "x|y|z", "the file's axis that points up (default y)", 0, 0),
    ROW(map, "map", 0, TEXT, "NAME=PATH,..",
        "where another program's HDF5 file has its arrays: position=/a/pos,vx=/a/u,vy=/a/v,vz=/a/w", 0, 0),
    SSFR_OPTION_END,
};

const ssfr_option ssfr_view_rows[] = {
    ROW(size, "size", 0, SIZE, "WxH", "image size, px (default 1280x720)", 0, 0),
    ROW(camera, "camera", 0, TEXT, "NAME", "a camera of the scene (default: its first; ssfr scene info lists them)", 0,
        0),
    ROW(camera_time, "camera-time", 0, NUMBER, "S",
        "where the camera is on its path, s (default: where it is at the frame's time)", 0, 1e9),
    ROW(eye, "eye", 0, VECTOR, "X,Y,Z", "camera position, m (default: the scene's, else where all particles just fit)",
        0, 0),
    ROW(target, "target", 0, VECTOR, "X,Y,Z", "the point looked at, m (default: the scene's, else the middle)", 0, 0),
    ROW(up, "up", 0, VECTOR, "X,Y,Z", "the direction that is up in the image (default: the scene's, else 0,1,0)", 0, 0),
    ROW(fov_deg, "fov", 0, NUMBER, "DEG", "full vertical field of view (default: the scene's, else 45)", 0.001, 179),
    SSFR_OPTION_END,
};

void ssfr_stage_defaults(ssfr_stage_options *options)
{
    *options = (ssfr_stage_options){
        .unit = 1, .up_axis = 1, .frame = -1, .time = NAN, .camera_time = NAN, .eye = {NAN, NAN, NAN},
        .target = {NAN, NAN, NAN}, .up = {NAN, NAN, NAN}, .fov_deg = NAN, .size = {1280, 720}, .seed = 1};
}

ssfr_load_options ssfr_stage_load_options(const ssfr_stage_options *options)
{
    return (ssfr_load_options){.radius = options->radius, .unit = options->unit, .up = "xyz"[options->up_axis],
                               .map = options->map, .drop_nonfinite = options->drop_nonfinite};
}

/* ---- which frames there are -------------------------------------------------------------------------------------- */

/* From 0 on. */
static ssfr_result number_frames(ssfr_stage *stage, int n)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_alloc(&stage->frames, (size_t)n, sizeof *stage->frames, "the numbers of frames"));
    for (; stage->n_frames < (size_t)n; stage->n_frames++) stage->frames[stage->n_frames] = (long)stage->n_frames;
end:
    return result;
}

static ssfr_result open_described(ssfr_stage *stage, const ssfr_stage_options *options)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_scene_describe(&stage->source, (ssfr_scale)options->scale, &stage->description));
    const ssfr_description *d = stage->description;
    SSFR_TRY(ssfr_make_folder(d, options->cache, options->seed, &stage->folder));
    SSFR_TRY(number_frames(stage, d->n_frames));
    if (d->environment) SSFR_TRY(ssfr_exr_load(d->environment, "R,G,B", &stage->environment));
end:
    return result;
}

ssfr_result ssfr_stage_open(ssfr_stage **out, const char *scene, const ssfr_stage_options *options)
{
    ssfr_result result = SSFR_OK;
    ssfr_stage *stage = NULL;
    *out = NULL;
    SSFR_TRY(ssfr_alloc(&stage, 1, sizeof *stage, "a stage"));
    SSFR_TRY(ssfr_text_print(&stage->name, "a name", "%s", scene));
    stage->frame = -1;
    stage->time = stage->simulation_ms = NAN;
    SSFR_TRY(ssfr_scene_find(scene, &stage->source));
    if (stage->source.kind == SSFR_SCENE_DESCRIBED)
        SSFR_TRY(open_described(stage, options));
    else if (stage->source.kind == SSFR_SCENE_BUILTIN && stage->source.builtin->n_frames > 0)
        SSFR_TRY(number_frames(stage, stage->source.builtin->n_frames));
    else if (stage->source.kind == SSFR_SCENE_SEQUENCE)
        SSFR_TRY(ssfr_sequence_frames(scene, &ssfr_frame_range_all, &stage->n_frames, &stage->frames));
    *out = stage;
    stage = NULL;
end:
    ssfr_stage_destroy(&stage);
    return result;
}

ssfr_result ssfr_stage_choose(const ssfr_stage *stage, const ssfr_frame_range *range, size_t *n, long **frames)
{
    *n = 0;
    *frames = NULL;
    if (stage->n_frames == 0) return ssfr_fail(SSFR_ERR_VALUE, "%s: has no frames", stage->name);
    return ssfr_frame_range_choose(range, stage->name, stage->n_frames, stage->frames, n, frames);
}

static ssfr_result frame_at(const ssfr_stage *stage, double time, long *frame)
{
    const ssfr_description *d = stage->description;
    if (!d) return ssfr_fail(SSFR_ERR_VALUE, "%s: nothing tells when its frames are: give --frame N", stage->name);
    *frame = lround(fmin(time * d->frame_rate, SSFR_MAX_FRAME));
    return SSFR_OK;
}

ssfr_result ssfr_stage_find_frame(const ssfr_stage *stage, const ssfr_stage_options *options, long *frame)
{
    ssfr_result result = SSFR_OK;
    const size_t n = stage->n_frames;
    bool found = false;
    *frame = options->frame;
    if (n == 0 && (options->frame >= 0 || !isnan(options->time)))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: has no frames", stage->name);
    if (n == 0) return SSFR_OK;
    if (options->frame >= 0 && !isnan(options->time))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: --frame and --time both say which", stage->name);
    if (!isnan(options->time)) SSFR_TRY(frame_at(stage, options->time, frame));
    if (*frame < 0) *frame = stage->frames[n * 2 / 3];
    for (size_t i = 0; i < n && !found; i++) found = stage->frames[i] == *frame;
    if (!found)
        result = ssfr_fail(SSFR_ERR_VALUE, "%s: there is no frame %ld: they go from %ld to %ld", stage->name, *frame,
                           stage->frames[0], stage->frames[n - 1]);
end:
    return result;
}

/* ---- a frame ----------------------------------------------------------------------------------------------------- */

/* A radius that is estimated must not change from frame to frame. */
static void hold_estimate(ssfr_stage *stage, bool estimated, ssfr_particles *particles)
{
    if (estimated && stage->estimate == 0) stage->estimate = particles->radius;
    if (estimated || particles->radius == 0) particles->radius = stage->estimate;
}

static ssfr_result load_file(ssfr_stage *stage, const char *path, const ssfr_stage_options *options,
                             ssfr_particles **out)
{
    ssfr_load_options load = ssfr_stage_load_options(options);
    const ssfr_result result = ssfr_particles_load(out, path, &load);
    stage->n_dropped = load.n_dropped;
    if (result == SSFR_OK) hold_estimate(stage, load.estimated, *out);
    if (result == SSFR_OK && load.n_dropped)
        ssfr_log(SSFR_WARNING, "%s: dropped %zu particles with a value that is not finite", path, load.n_dropped);
    return result;
}

static ssfr_result load_of_sequence(ssfr_stage *stage, const ssfr_stage_options *options, long frame,
                                    ssfr_particles **out)
{
    char *path = NULL;
    ssfr_result result = ssfr_sequence_path(stage->name, frame, &path);
    if (result == SSFR_OK) result = load_file(stage, path, options, out);
    free(path);
    return result;
}

static ssfr_result make_frames(const ssfr_stage *stage, const ssfr_stage_options *options, long last)
{
    const ssfr_make_options make = {.cache = options->cache, .seed = options->seed, .last = (int)last};
    return ssfr_make(stage->description, &make);
}

static ssfr_result load_made(const ssfr_stage *stage, long frame, bool foam, ssfr_particles **out)
{
    char *path = NULL;
    ssfr_result result = ssfr_make_path(stage->folder, (int)frame, foam, &path);
    if (result == SSFR_OK) result = ssfr_particles_load(out, path, NULL);
    free(path);
    return result;
}

/* Fluid, and foam where there is any, of a frame. */
static ssfr_result load_frame(ssfr_stage *stage, const ssfr_stage_options *options, long frame, ssfr_particles **fluid,
                              ssfr_particles **foam)
{
    ssfr_result result = SSFR_OK;
    switch (stage->source.kind) {
    case SSFR_SCENE_BUILTIN: SSFR_TRY(stage->source.builtin->make(fluid, options->seed)); break;
    case SSFR_SCENE_PARTICLES: SSFR_TRY(load_file(stage, stage->name, options, fluid)); break;
    case SSFR_SCENE_SEQUENCE: SSFR_TRY(load_of_sequence(stage, options, frame, fluid)); break;
    default:
        SSFR_TRY(make_frames(stage, options, frame));
        SSFR_TRY(load_made(stage, frame, false, fluid));
        if (stage->description->has_foam) SSFR_TRY(load_made(stage, frame, true, foam));
    }
    if (options->radius > 0) (*fluid)->radius = options->radius;
end:
    if (result != SSFR_OK) ssfr_particles_destroy(fluid);
    return result;
}

ssfr_result ssfr_stage_read(const ssfr_stage *stage, const ssfr_stage_options *options, long frame,
                            ssfr_particles **fluid)
{
    const ssfr_builtin *builtin = stage->source.builtin;
    const ssfr_result result = builtin ? builtin->make(fluid, options->seed) : load_made(stage, frame, false, fluid);
    if (result == SSFR_OK && options->radius > 0) (*fluid)->radius = options->radius;
    return result;
}

double ssfr_stage_time(const ssfr_stage *stage, long frame)
{
    const bool at_once = stage->source.builtin && stage->source.builtin->n_frames > 0;
    return stage->description ? (double)frame / stage->description->frame_rate : at_once ? 0 : NAN;
}

/* Those that are drawn, where they are now; how many. */
static int place_solids(ssfr_stage *stage)
{
    const ssfr_builtin *builtin = stage->source.builtin;
    const ssfr_description *d = stage->description;
    int n = 0;
    for (int i = 0; builtin && i < builtin->n_solids; i++) stage->solids[n++] = builtin->solids[i];
    for (int i = 0; d && i < d->n_bodies && n < SSFR_MAX_SOLIDS; i++)
        if (!d->bodies[i].hidden) stage->solids[n++] = ssfr_body_at(d, &d->bodies[i], stage->time);
    return n;
}

static double choose_floor(const ssfr_stage *stage)
{
    const ssfr_builtin *builtin = stage->source.builtin;
    double lo[3], hi[3];
    if (stage->description) return stage->description->floor;
    if (builtin && !isnan(builtin->floor)) return builtin->floor;
    if (stage->is_held) return stage->held_lo[1];
    ssfr_stage_bounds(stage, lo, hi);
    return lo[1];
}

ssfr_result ssfr_stage_show(ssfr_stage *stage, const ssfr_stage_options *options, long frame)
{
    ssfr_result result = SSFR_OK;
    ssfr_particles *fluid = NULL, *foam = NULL;
    if (frame < 0) SSFR_TRY(ssfr_stage_find_frame(stage, options, &frame));
    SSFR_TRY(load_frame(stage, options, frame, &fluid, &foam));
    ssfr_particles_destroy(&stage->particles);
    ssfr_particles_destroy(&stage->foam);
    stage->particles = fluid;
    stage->foam = foam;
    stage->frame = frame;
    stage->time = ssfr_stage_time(stage, frame);
    stage->simulation_ms = stage->folder ? ssfr_make_time(stage->folder, (int)frame) : NAN;
    stage->scene = (ssfr_scene){.particles = stage->particles,
                                .solids = stage->solids,
                                .n_solids = place_solids(stage),
                                .floor = choose_floor(stage),
                                .environment = stage->environment,
                                .timed = isfinite(stage->time),
                                .time = stage->time};
    SSFR_TRY(ssfr_stage_aim(stage, options));
end:
    return result;
}

ssfr_result ssfr_stage_turn(ssfr_stage *stage, const ssfr_stage_options *options)
{
    ssfr_result result = SSFR_OK;
    long frame;
    SSFR_TRY(ssfr_stage_find_frame(stage, options, &frame));
    if (stage->particles && (frame < 0 || frame == stage->frame))
        SSFR_TRY(ssfr_stage_aim(stage, options));
    else
        SSFR_TRY(ssfr_stage_show(stage, options, frame));
end:
    return result;
}

ssfr_result ssfr_stage_hold(ssfr_stage *stage, const ssfr_stage_options *options, size_t n, const long *frames)
{
    ssfr_result result = SSFR_OK;
    const long some[] = {frames[0], frames[n / 2], frames[n - 1]};
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    if (stage->description) SSFR_TRY(make_frames(stage, options, frames[n - 1]));
    stage->is_held = false;
    for (size_t i = 0; i < SSFR_COUNT(some); i++) {
        double from[3], to[3];
        SSFR_TRY(ssfr_stage_show(stage, options, some[i]));
        ssfr_stage_view_box(stage, from, to);
        for (int k = 0; k < 3; k++) lo[k] = fmin(lo[k], from[k]), hi[k] = fmax(hi[k], to[k]);
    }
    memcpy(stage->held_lo, lo, sizeof lo);
    memcpy(stage->held_hi, hi, sizeof hi);
    stage->is_held = true;
end:
    return result;
}

ssfr_result ssfr_stage_create(ssfr_stage **out, const char *scene, const ssfr_stage_options *options)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_stage_open(out, scene, options));
    SSFR_TRY(ssfr_stage_show(*out, options, -1));
end:
    if (result != SSFR_OK) ssfr_stage_destroy(out);
    return result;
}

void ssfr_stage_destroy(ssfr_stage **stage)
{
    ssfr_stage *s = *stage;
    if (s) {
        ssfr_particles_destroy(&s->particles);
        ssfr_particles_destroy(&s->foam);
        ssfr_field_destroy(&s->environment);
        ssfr_description_destroy(&s->description);
        free(s->folder);
        free(s->frames);
        free(s->name);
    }
    free(s);
    *stage = NULL;
}
