/* SPDX-License-Identifier: GPL-3.0-or-later */
/* truths.c: stages of a few particles, cast. */
#include "tests/truths.h"

ssfr_stage *test_truth_stage(size_t n, const double *positions, double radius, const double eye[3],
                             const double target[3], int w, int h)
{
    static const double up[3] = {0, 1, 0};
    const ssfr_particles given = {.radius = radius};
    ssfr_stage *stage = NULL;
    assert_int_equal(ssfr_alloc(&stage, 1, sizeof *stage, "a stage"), SSFR_OK);
    assert_int_equal(ssfr_particles_create(&stage->particles, n, positions, &given), SSFR_OK);
    stage->scene = (ssfr_scene){.particles = stage->particles, .solids = stage->solids, .floor = -INFINITY};
    assert_int_equal(ssfr_camera_look(&stage->scene.camera, eye, target, up, 40 * acos(-1) / 180, w, h), SSFR_OK);
    return stage;
}

ssfr_stage *test_truth_scene(const char *name, int w, int h)
{
    ssfr_stage_options options;
    ssfr_stage *stage = NULL;
    ssfr_stage_defaults(&options);
    options.size[0] = w, options.size[1] = h;
    assert_int_equal(ssfr_stage_create(&stage, name, &options), SSFR_OK);
    return stage;
}

ssfr_truth_params test_truth_params(const char *const *settings)
{
    ssfr_truth_params params;
    ssfr_truth_defaults(&params);
    for (; *settings; settings += 2) assert_int_equal(ssfr_truth_set(&params, settings[0], settings[1]), SSFR_OK);
    return params;
}

ssfr_truth *test_truth_cast(const ssfr_stage *stage, const ssfr_truth_params *params)
{
    const ssfr_truth_options options = {.every = 1, .no_cache = true};
    ssfr_truth *truth = NULL;
    assert_int_equal(ssfr_truth_create(&truth, stage, params, &options), SSFR_OK);
    return truth;
}

const double *test_truth_at(const ssfr_truth *truth, ssfr_truth_channel channel, int x, int y)
{
    return ssfr_field_at(truth->channels[channel], x, y);
}

static bool same_field(const ssfr_field *a, const ssfr_field *b)
{
    if (!a || !b) return a == b;
    return a->w == b->w && a->h == b->h && a->c == b->c &&
           memcmp(a->data, b->data, (size_t)a->w * (size_t)a->h * (size_t)a->c * sizeof *a->data) == 0;
}

ssfr_ray test_truth_ray(uint64_t *seed, double extent)
{
    ssfr_ray ray;
    for (int k = 0; k < 3; k++) ray.origin[k] = test_random(seed, -extent, extent);
    for (int k = 0; k < 3; k++) ray.dir[k] = test_random(seed, -0.5, 0.5) * extent - ray.origin[k];
    ssfr_normalize(ray.dir);
    return ray;
}


bool test_truth_same(const ssfr_truth *a, const ssfr_truth *b)
{
    bool same = same_field(a->cast, b->cast);
    for (int i = 0; i < SSFR_N_TRUTH_CHANNELS && same; i++) same = same_field(a->channels[i], b->channels[i]);
    return same;
}

void test_truth_check_finite(const ssfr_truth *truth)
{
    for (int i = 0; i < SSFR_N_TRUTH_CHANNELS; i++) {
        const ssfr_field *f = truth->channels[i];
        const bool bound = strstr(ssfr_truth_channels[i].name, "_err");
        for (size_t k = 0; f && k < (size_t)f->w * (size_t)f->h * (size_t)f->c; k++)
            assert_true(isfinite(f->data[k]) && (!bound || f->data[k] >= 0));
    }
}
