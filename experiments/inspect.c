/* SPDX-License-Identifier: GPL-3.0-or-later */
/* inspect.c: bounds from particles, parameters and the scene; images held to them; hashes and lists of a frame. */
#include "experiments/inspect.h"
#include "experiments/frame_file.h"
#include "experiments/hash.h"

#include "graph/graph.h"

#include <inttypes.h>

static const double slack = 1e-3; /* of a depth or a brightness: images may be of half precision, which rounds by 5e-4 */

/* ---- bounds ------------------------------------------------------------------------------------------------------ */

static bool ends_with(const char *text, const char *end)
{
    const size_t length = strlen(text), n = strlen(end);
    return length >= n && strcmp(text + length - n, end) == 0;
}

static double parameter(const ssfr_graph *graph, const char *key)
{
    char text[64];
    double number = 0;
    if (ssfr_graph_get(graph, key, text, sizeof text) != SSFR_OK || !ssfr_parse_number(text, &number)) number = 0;
    return number;
}

/* The largest of all parameters whose key holds the word; 0 when there is none. */
static double largest(const ssfr_graph *graph, const char *word, bool at_end)
{
    double most = 0;
    for (int i = 0; ssfr_graph_key_at(graph, i); i++) {
        const char *key = ssfr_graph_key_at(graph, i);
        if (at_end ? ends_with(key, word) : strstr(key, word) != NULL) most = fmax(most, parameter(graph, key));
    }
    return most;
}

static double brightest_pixel(const ssfr_field *image)
{
    const size_t n = image ? (size_t)image->w * (size_t)image->h * (size_t)image->c : 0;
    double most = 0;
    for (size_t i = 0; i < n; i++) most = fmax(most, image->data[i]);
    return most;
}

static bool ran(const ssfr_graph *graph, const char *node)
{
    const ssfr_report *report = ssfr_graph_report(graph);
    bool found = false;
    for (int i = 0; i < report->n_nodes && !found; i++)
        found = strcmp(report->nodes[i].node, node) == 0 && report->nodes[i].status == SSFR_RAN;
    return found;
}

/* It adds to what is behind it, each particle at most its colour. */
static double brightest_spray(const ssfr_graph *graph, const ssfr_scene *scene)
{
    const double n = scene->particles && ran(graph, "spray") ? (double)scene->particles->n : 0;
    return n * largest(graph, "spray.strength", true) * largest(graph, "spray.color_", false);
}

static double brightest_of(const ssfr_graph *graph, const ssfr_scene *scene, const ssfr_field *behind)
{
    static const char *const foams[] = {"noise_foam.color_", ".c_ff_", ".c_fb_", ".base_color_"};
    const double light = fmax(1, parameter(graph, "light.intensity"));
    double seen = fmax(light, fmax(brightest_pixel(behind), brightest_pixel(scene->environment)));
    double foam = 0;
    seen = fmax(seen, fmax(largest(graph, "sky.", false), largest(graph, "medium.color_", false)));
    for (size_t i = 0; i < SSFR_COUNT(foams); i++) foam = fmax(foam, largest(graph, foams[i], false));
    return seen + light * (foam + largest(graph, ".specular", true)) + brightest_spray(graph, scene);
}

ssfr_bounds ssfr_inspect_bounds(const ssfr_graph *graph, const ssfr_scene *scene, const ssfr_field *behind)
{
    const ssfr_particles *p = scene->particles;
    const ssfr_camera *camera = &scene->camera;
    ssfr_bounds bounds = {.nearest = -INFINITY, .farthest = INFINITY, .brightest = brightest_of(graph, scene, behind)};
    for (size_t i = 0; p && i < p->n; i++) {
        double place[3];
        ssfr_particles_position(p, i, place);
        for (int k = 0; k < 3; k++) place[k] -= camera->eye[k];
        const double z = ssfr_dot(camera->back, place);
        bounds.nearest = fmax(bounds.nearest, z);
        bounds.farthest = fmin(bounds.farthest, z);
    }
    const double radius = p ? p->radius * fmax(1, largest(graph, ".radius_scale", true)) : 0;
    bounds.nearest += radius;
    bounds.farthest -= radius;
    bounds.leaning = radius * (hypot(largest(graph, ".stretch", true), 1) - 1);
    return bounds;
}

/* ---- images ------------------------------------------------------------------------------------------------------ */

typedef struct range {
    double lo, hi;
} range;

/* A depth of particles: of water or of foam. */
static bool is_of_particles(ssfr_slot_id id)
{
    return ssfr_slot_is_fluid(id) || id == SSFR_SLOT_foam_depth;
}

/* What the values of a slot may be. */
static range range_of(ssfr_slot_id id, const ssfr_bounds *b)
{
    range r = {-INFINITY, INFINITY};
    const double leaning = id == SSFR_SLOT_foam_depth ? b->leaning : 0, nearest = b->nearest + leaning,
                 farthest = b->farthest - leaning;
    if (is_of_particles(id))
        r = (range){farthest - slack * fabs(farthest), nearest + slack * fabs(nearest)};
    else if (strcmp(ssfr_slots[id].exr, "T") == 0)
        r.lo = 0;
    else if (id == SSFR_SLOT_color)
        r = (range){0, b->brightest * (1 + slack)};
    return r;
}

void ssfr_inspect_image(ssfr_inspected *inspected, const char *slot, const ssfr_field *image,
                        const ssfr_bounds *bounds)
{
    const ssfr_slot_id id = ssfr_slot_find(slot);
    const range r = range_of(id, bounds);
    const size_t n = (size_t)image->w * (size_t)image->h * (size_t)image->c;
    for (size_t i = 0; i < n; i++) {
        const double value = image->data[i];
        inspected->finite &= isfinite(value);
        const bool empty = is_of_particles(id) && fabs(value) >= SSFR_SURFACE; /* a NaN is not */
        inspected->bounded &= empty || (value >= r.lo && value <= r.hi);
    }
}

static ssfr_result inspect_slot(ssfr_inspected *out, const ssfr_graph *graph, const char *slot,
                                const ssfr_bounds *bounds)
{
    ssfr_field *image = NULL;
    const ssfr_result result = ssfr_graph_read(graph, slot, &image);
    if (result == SSFR_OK) ssfr_inspect_image(out, slot, image, bounds);
    ssfr_field_destroy(&image);
    return result;
}

ssfr_result ssfr_inspect_frame(ssfr_inspected *out, ssfr_graph *graph, const ssfr_scene *scene,
                               const ssfr_run_options *run)
{
    ssfr_result result = SSFR_OK;
    ssfr_field *behind = NULL;
    *out = (ssfr_inspected){true, true};
    ssfr_graph_want_all(graph, true);
    SSFR_TRY(ssfr_graph_run(graph, scene, run));
    SSFR_TRY(ssfr_graph_read(graph, "scene_color", &behind));
    const ssfr_bounds bounds = ssfr_inspect_bounds(graph, scene, behind);
    for (int i = 0; ssfr_graph_slot_at(graph, i); i++)
        SSFR_TRY(inspect_slot(out, graph, ssfr_graph_slot_at(graph, i), &bounds));
end:
    ssfr_graph_want_all(graph, false);
    ssfr_field_destroy(&behind);
    return result;
}

/* ---- values of particles ----------------------------------------------------------------------------------------- */

static ssfr_result mean_of(double *mean, const ssfr_graph *graph, ssfr_slot_id slot, double (*count)(double))
{
    ssfr_result result = SSFR_OK;
    const float *values;
    size_t n;
    double sum = 0;
    *mean = 0;
    if (!ssfr_graph_has_slot(graph, slot)) return SSFR_OK;
    SSFR_TRY(ssfr_graph_read_values(graph, ssfr_slots[slot].name, &n, &values));
    for (size_t i = 0; i < n; i++) sum += count((double)values[i]);
    if (n) *mean = sum / (double)n;
end:
    return result;
}

static double itself(double value)
{
    return value;
}

static double is_positive(double value)
{
    return value > 0;
}

ssfr_result ssfr_inspect_foam(double *foam_share, double *spray_share, const ssfr_graph *graph)
{
    ssfr_result result = SSFR_OK;
    *spray_share = 0;
    SSFR_TRY(mean_of(foam_share, graph, SSFR_SLOT_foam, itself));
    SSFR_TRY(mean_of(spray_share, graph, SSFR_SLOT_spray_size, is_positive));
end:
    return result;
}

/* ---- texts ------------------------------------------------------------------------------------------------------- */

void ssfr_inspect_left_out(int n, const ssfr_node_report *reports, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < n && used < size; i++)
        if (reports[i].status != SSFR_RAN)
            used += (size_t)snprintf(text + used, size - used, "%s%s %s", used ? ";" : "", reports[i].node,
                                     ssfr_status_text(reports[i].status));
}

void ssfr_inspect_hash(const ssfr_field *image, char text[17])
{
    const size_t n = (size_t)image->w * (size_t)image->h * (size_t)image->c;
    snprintf(text, 17, "%016" PRIx64, ssfr_hash_bytes(SSFR_HASH, image->data, n * sizeof *image->data));
}
