/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shot.c: reading a frame and measuring it against its twin and against a reference. */
#include "experiments/shot.h"
#include "experiments/frame_file.h"

#include "graph/pass.h"
#include "metrics/metrics.h"

typedef struct measure { /* one column: a metric of a part */
    ssfr_column_id column;
    ssfr_shot_part part;
    const char *metric;
} measure;

static const measure twin_measures[] = {
    {SSFR_COLUMN_twin_depth_rms, SSFR_SHOT_DEPTH, "depth_rms"},
    {SSFR_COLUMN_twin_depth_max, SSFR_SHOT_DEPTH, "depth_max"},
    {SSFR_COLUMN_twin_normal_mean_deg, SSFR_SHOT_NORMAL, "normal_mean_deg"},
    {SSFR_COLUMN_twin_psnr, SSFR_SHOT_COLOUR, "psnr"},
    {SSFR_COLUMN_twin_ssim, SSFR_SHOT_COLOUR, "ssim"},
    {SSFR_COLUMN_twin_flip, SSFR_SHOT_COLOUR, "flip"},
};

static const measure method_measures[] = {
    {SSFR_COLUMN_method_depth_rms, SSFR_SHOT_DEPTH, "depth_rms"},
    {SSFR_COLUMN_method_depth_rms_interior, SSFR_SHOT_DEPTH, "depth_rms_interior"},
    {SSFR_COLUMN_method_depth_mean_interior, SSFR_SHOT_DEPTH, "depth_mean_interior"},
    {SSFR_COLUMN_method_normal_mean_deg, SSFR_SHOT_NORMAL, "normal_mean_deg"},
    {SSFR_COLUMN_method_normal_interior_deg, SSFR_SHOT_NORMAL, "normal_mean_interior_deg"},
};

static const measure reference_measures[] = {
    {SSFR_COLUMN_ref_depth_rms, SSFR_SHOT_DEPTH, "depth_rms"},
    {SSFR_COLUMN_ref_depth_mean, SSFR_SHOT_DEPTH, "depth_mean"},
    {SSFR_COLUMN_ref_depth_rms_interior, SSFR_SHOT_DEPTH, "depth_rms_interior"},
    {SSFR_COLUMN_ref_depth_mean_interior, SSFR_SHOT_DEPTH, "depth_mean_interior"},
    {SSFR_COLUMN_ref_depth_median_interior_radii, SSFR_SHOT_DEPTH, "depth_median_interior"}, /* m at first */
    {SSFR_COLUMN_ref_depth_rms_edge, SSFR_SHOT_DEPTH, "depth_rms_edge"},
    {SSFR_COLUMN_ref_normal_mean_deg, SSFR_SHOT_NORMAL, "normal_mean_deg"},
    {SSFR_COLUMN_ref_normal_interior_deg, SSFR_SHOT_NORMAL, "normal_mean_interior_deg"},
    {SSFR_COLUMN_ref_iou, SSFR_SHOT_DEPTH, "silhouette_iou"},
    {SSFR_COLUMN_ref_psnr, SSFR_SHOT_COLOUR, "psnr"},
    {SSFR_COLUMN_ref_ssim, SSFR_SHOT_COLOUR, "ssim"},
    {SSFR_COLUMN_ref_flip, SSFR_SHOT_COLOUR, "flip"},
};

static const struct { /* columns in particle radii, and in metres */
    ssfr_column_id radii, metres;
} in_radii[] = {
    {SSFR_COLUMN_ref_depth_rms_interior_radii, SSFR_COLUMN_ref_depth_rms_interior},
    {SSFR_COLUMN_ref_depth_mean_interior_radii, SSFR_COLUMN_ref_depth_mean_interior},
    {SSFR_COLUMN_ref_depth_median_interior_radii, SSFR_COLUMN_ref_depth_median_interior_radii},
};

/* ---- reading ----------------------------------------------------------------------------------------------------- */

/* The slot of a part, NULL when the pipeline does not write it. */
static const char *slot_of(const ssfr_graph *graph, const ssfr_pipeline *pipeline, ssfr_shot_part part)
{
    const char *const names[SSFR_SHOT_PARTS] = {ssfr_slots[pipeline->result].name, "surface_depth", "normal",
                                                "thickness"};
    return ssfr_frame_has(graph, names[part]) ? names[part] : NULL;
}

ssfr_result ssfr_shot_want(ssfr_graph *graph, const ssfr_pipeline *pipeline, bool all)
{
    const int n = all ? SSFR_SHOT_PARTS : SSFR_SHOT_COLOUR + 1;
    ssfr_result result = ssfr_graph_want(graph, NULL);
    for (int part = 0; part < n && result == SSFR_OK; part++) {
        const char *slot = slot_of(graph, pipeline, (ssfr_shot_part)part);
        if (slot) result = ssfr_frame_want_slot(graph, slot);
    }
    return result;
}

ssfr_result ssfr_shot_take(ssfr_shot *shot, const ssfr_graph *graph, const ssfr_pipeline *pipeline, int w, int h)
{
    ssfr_result result = SSFR_OK;
    ssfr_shot_finish(shot);
    for (int part = 0; part < SSFR_SHOT_PARTS; part++) {
        const char *slot = slot_of(graph, pipeline, (ssfr_shot_part)part);
        if (slot) SSFR_TRY(ssfr_frame_read(&shot->parts[part], graph, slot, w, h));
    }
end:
    return result;
}

void ssfr_shot_finish(ssfr_shot *shot)
{
    for (int part = 0; part < SSFR_SHOT_PARTS; part++) ssfr_field_destroy(&shot->parts[part]);
}

/* ---- comparing --------------------------------------------------------------------------------------------------- */

static ssfr_result run_measures(const ssfr_shot *shot, const ssfr_shot *other, size_t n, const measure *measures,
                                double values[SSFR_N_COLUMNS])
{
    ssfr_result result = SSFR_OK;
    for (size_t i = 0; i < n; i++) {
        const measure *m = &measures[i];
        const ssfr_field *a = shot->parts[m->part], *b = other->parts[m->part];
        if (a && b) SSFR_TRY(ssfr_metric_measure(ssfr_metric_find(m->metric), a, b, NULL, &values[m->column]));
    }
end:
    return result;
}

/* Where either is fluid; NaN where neither is, and for a share of nothing. */
static void compare_thickness(const ssfr_field *a, const ssfr_field *b, double values[SSFR_N_COLUMNS])
{
    const size_t n = (size_t)a->w * (size_t)a->h;
    double sum_a = 0, sum_b = 0, squares = 0, count = 0;
    for (size_t i = 0; i < n; i++) {
        const double difference = a->data[i] - b->data[i];
        sum_a += a->data[i];
        sum_b += b->data[i];
        squares += difference * difference;
        count += a->data[i] != 0 || b->data[i] != 0;
    }
    values[SSFR_COLUMN_ref_thickness_rms] = sqrt(squares / count);
    values[SSFR_COLUMN_ref_thickness_mean] = (sum_a - sum_b) / count;
    values[SSFR_COLUMN_ref_thickness_ratio] = sum_b != 0 ? sum_a / sum_b : NAN;
}

ssfr_result ssfr_shot_count_nan(const ssfr_shot *shot, double values[SSFR_N_COLUMNS])
{
    ssfr_result result = SSFR_OK;
    const ssfr_metric *metric = ssfr_metric_find("nan_count");
    double sum = 0;
    for (int part = 0; part < SSFR_SHOT_PARTS; part++) {
        double n = 0;
        if (shot->parts[part]) SSFR_TRY(ssfr_metric_measure(metric, shot->parts[part], shot->parts[part], NULL, &n));
        sum += n;
    }
    values[SSFR_COLUMN_nan_count] = sum;
end:
    return result;
}

ssfr_result ssfr_shot_compare_twin(const ssfr_shot *shot, const ssfr_shot *twin, double values[SSFR_N_COLUMNS])
{
    return run_measures(shot, twin, SSFR_COUNT(twin_measures), twin_measures, values);
}

ssfr_result ssfr_shot_compare_method(const ssfr_shot *twin, const ssfr_shot *reference, double values[SSFR_N_COLUMNS])
{
    return run_measures(twin, reference, SSFR_COUNT(method_measures), method_measures, values);
}

ssfr_result ssfr_shot_compare_reference(const ssfr_shot *shot, const ssfr_shot *reference, double radius,
                                        double values[SSFR_N_COLUMNS])
{
    ssfr_result result = SSFR_OK;
    const ssfr_field *a = shot->parts[SSFR_SHOT_THICKNESS], *b = reference->parts[SSFR_SHOT_THICKNESS];
    SSFR_TRY(run_measures(shot, reference, SSFR_COUNT(reference_measures), reference_measures, values));
    if (a && b) compare_thickness(a, b, values);
    for (size_t i = 0; i < SSFR_COUNT(in_radii); i++)
        values[in_radii[i].radii] = radius > 0 ? values[in_radii[i].metres] / radius : NAN;
end:
    return result;
}
