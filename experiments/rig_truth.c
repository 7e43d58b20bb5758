/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rig_truth.c: truth's parameters from a sweep, and its images in the place of a reference frame's. */
#include "experiments/rig_truth.h"

#include "base/param.h"

/* ---- parameters -------------------------------------------------------------------------------------------------- */

const ssfr_param *ssfr_rig_truth_row(const char *key)
{
    static const ssfr_truth_params none; /* rows are asked for, not values */
    char name[128];
    const ssfr_param *row;
    const void *group;
    for (int i = 0; ssfr_truth_key_at(&none, i, name, &row, &group); i++)
        if (strcmp(name, key) == 0) return row;
    return NULL;
}

static ssfr_result apply(ssfr_truth_params *out, const ssfr_settings *settings)
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < settings->n && result == SSFR_OK; i++)
        if (ssfr_rig_truth_row(settings->items[i].key))
            result = ssfr_truth_set(out, settings->items[i].key, settings->items[i].value);
    return result;
}

ssfr_result ssfr_rig_truth_params(ssfr_truth_params *out, const ssfr_sweep_spec *spec, const ssfr_variant *variant,
                                  const ssfr_description *scene)
{
    ssfr_result result = SSFR_OK;
    ssfr_truth_defaults(out);
    out->cast.parts = SSFR_TRUTH_SURFACE | SSFR_TRUTH_THICKNESS;
    if (scene) SSFR_TRY(ssfr_truth_apply_scene(out, scene));
    SSFR_TRY(apply(out, &spec->settings));
    if (variant) SSFR_TRY(apply(out, &variant->settings));
end:
    return result;
}

ssfr_result ssfr_rig_truth_vary(ssfr_truth_params *params, const ssfr_sweep_spec *spec,
                                const size_t index[SSFR_MAX_AXES])
{
    ssfr_result result = SSFR_OK;
    for (int i = 0; i < spec->n_axes; i++) {
        const ssfr_axis *axis = &spec->axes[i];
        if (ssfr_rig_truth_row(axis->key)) SSFR_TRY(ssfr_truth_set(params, axis->key, axis->values[index[i]]));
    }
end:
    return result;
}

/* ---- images ------------------------------------------------------------------------------------------------------ */

typedef struct bounds { /* of errors, over the pixels that have the thing */
    double mean, max;   /* NaN where none has */
} bounds;

static bounds bounds_of(const ssfr_field *errors, const ssfr_field *of)
{
    const size_t n = (size_t)errors->w * (size_t)errors->h;
    double sum = 0, max = NAN;
    size_t count = 0;
    for (size_t i = 0; i < n; i++) {
        const double value = of->data[i];
        if (value == 0 || !(fabs(value) < SSFR_SURFACE)) continue;
        sum += errors->data[i];
        max = fmax(max, errors->data[i]);
        count++;
    }
    return (bounds){.mean = sum / (double)count, .max = max};
}

static void put_errors(const ssfr_truth *truth, double values[SSFR_N_COLUMNS])
{
    ssfr_field *const *c = truth->channels;
    if (truth->parts & SSFR_TRUTH_SURFACE) {
        const bounds depth = bounds_of(c[SSFR_TRUTH_depth_err], c[SSFR_TRUTH_depth]);
        values[SSFR_COLUMN_truth_depth_err_mean] = depth.mean;
        values[SSFR_COLUMN_truth_depth_err_max] = depth.max;
        values[SSFR_COLUMN_truth_normal_err_mean_deg] =
            bounds_of(c[SSFR_TRUTH_normal_err], c[SSFR_TRUTH_depth]).mean * 180 / acos(-1);
    }
    if (truth->parts & SSFR_TRUTH_THICKNESS)
        values[SSFR_COLUMN_truth_thickness_err_mean] =
            bounds_of(c[SSFR_TRUTH_thickness_err], c[SSFR_TRUTH_thickness]).mean;
}

/* The images change hands; the rest of the truth goes. */
static void take_images(ssfr_truth *truth, ssfr_shot *out)
{
    static const ssfr_truth_channel channels[SSFR_SHOT_PARTS] = {
        [SSFR_SHOT_COLOUR] = SSFR_TRUTH_colour,
        [SSFR_SHOT_DEPTH] = SSFR_TRUTH_depth,
        [SSFR_SHOT_NORMAL] = SSFR_TRUTH_normal,
        [SSFR_SHOT_THICKNESS] = SSFR_TRUTH_thickness,
    };
    for (int part = 0; part < SSFR_SHOT_PARTS; part++) {
        out->parts[part] = truth->channels[channels[part]];
        truth->channels[channels[part]] = NULL;
    }
}

ssfr_result ssfr_rig_truth_cast(ssfr_shot *out, double values[SSFR_N_COLUMNS], const ssfr_stage *stage,
                                const ssfr_truth_params *params, const ssfr_truth_options *options)
{
    ssfr_result result = SSFR_OK;
    ssfr_truth *truth = NULL;
    ssfr_shot_finish(out);
    SSFR_TRY(ssfr_truth_create(&truth, stage, params, options));
    put_errors(truth, values);
    take_images(truth, out);
end:
    ssfr_truth_destroy(&truth);
    return result;
}
