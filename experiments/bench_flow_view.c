/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_flow_view.c: how many steps each pixel of a view takes, and how curved its surface is. */
#include "experiments/bench_flow.h"

#include "graph/graph.h"
#include "passes/adaptive_flow.h"

/* Magnitudes of the mean curvature, 1/m. The exact rate is the curvature times sqrt(C_x C_y) |z|, here for a dt of 1. */
static ssfr_result measure_curvatures(const ssfr_run *run, const ssfr_field *depth, ssfr_flow_curvatures *out)
{
    ssfr_result result = SSFR_OK;
    ssfr_curvature_flow_coeffs c = *(const ssfr_curvature_flow_coeffs *)run->coeffs;
    ssfr_run exact = *run;
    c.dt = 1, c.limit = SSFR_EMPTY, c.threshold = SSFR_EMPTY;
    c.cross_term = c.off_axis = 1, c.over_depth = 0;
    exact.coeffs = &c;
    SSFR_TRY(ssfr_field_create(&out->image, depth->w, depth->h, 1));
    SSFR_TRY(ssfr_alloc(&out->values, (size_t)depth->w * (size_t)depth->h, sizeof *out->values, "curvatures"));
    ssfr_field_fill(out->image, NAN);
    for (int y = 0; y < depth->h; y++)
        for (int x = 0; x < depth->w; x++) {
            const double z = *ssfr_field_at(depth, x, y);
            if (!ssfr_is_surface(z) || ssfr_curvature_flow_cuts(&exact, depth, x, y)) continue;
            const double rate = ssfr_curvature_flow_rate(&exact, depth, x, y, 0);
            out->values[out->n] = fabs(rate / (sqrt(c.c[0] * c.c[1]) * z));
            *ssfr_field_at(out->image, x, y) = out->values[out->n++];
        }
    qsort(out->values, out->n, sizeof *out->values, ssfr_by_value);
end:
    return result;
}

static ssfr_result count_steps(const ssfr_run *run, bool adapts, ssfr_flow_pixels *out)
{
    ssfr_result result = SSFR_OK;
    const ssfr_curvature_flow_coeffs *c = run->coeffs;
    out->most = c->iterations;
    SSFR_TRY(ssfr_field_create(&out->steps, run->w, run->h, 1));
    SSFR_TRY(ssfr_alloc(&out->counts, (size_t)out->most + 1, sizeof *out->counts, "numbers of steps"));
    ssfr_field_fill(out->steps, NAN);
    for (int y = 0; y < run->h; y++)
        for (int x = 0; x < run->w; x++) {
            if (!ssfr_is_surface(*ssfr_field_at(run->in[0], x, y))) continue;
            const int steps = adapts ? ssfr_adaptive_flow_steps(run, x, y) : out->most;
            *ssfr_field_at(out->steps, x, y) = steps;
            out->counts[steps]++;
            out->n++;
        }
end:
    return result;
}

ssfr_result ssfr_flow_look(const ssfr_graph *graph, ssfr_flow_pixels *out)
{
    ssfr_result result = SSFR_OK;
    const ssfr_report *report = ssfr_graph_report(graph);
    const ssfr_run *run = NULL;
    bool adapts = false;
    *out = (ssfr_flow_pixels){0};
    for (int i = 0; i < report->n_nodes && !run; i++) {
        const char *pass = report->nodes[i].pass;
        adapts = strcmp(pass, "adaptive_flow") == 0;
        if (adapts || strcmp(pass, "curvature_flow") == 0) run = ssfr_graph_last_run(graph, i);
    }
    if (!run) return ssfr_fail(SSFR_ERR_UNSUPPORTED, "bench flow: no curvature flow ran on the CPU");
    SSFR_TRY(count_steps(run, adapts, out));
    SSFR_TRY(measure_curvatures(run, run->in[0], &out->before));
    SSFR_TRY(measure_curvatures(run, run->out[0], &out->after));
end:
    return result;
}

void ssfr_flow_pixels_finish(ssfr_flow_pixels *pixels)
{
    free(pixels->counts);
    free(pixels->before.values);
    free(pixels->after.values);
    ssfr_field_destroy(&pixels->steps);
    ssfr_field_destroy(&pixels->before.image);
    ssfr_field_destroy(&pixels->after.image);
    *pixels = (ssfr_flow_pixels){0};
}
