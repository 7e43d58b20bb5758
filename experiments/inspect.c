/* SPDX-License-Identifier: GPL-3.0-or-later */
/* inspect.c: bounds from particles, parameters and the scene; images held to them; hashes and lists of a frame. */
#include "experiments/inspect.h"
#include "experiments/frame_file.h"
#include "experiments/hash.h"
#include "experiments/pile.h"

#include "base/field.h"
#include "base/half.h"
#include "graph/graph.h"

#include <inttypes.h>

static const double slack = 1e-3; /* of a depth or a brightness: images may be of half precision, which rounds by 5e-4 */

/* ---- bounds ------------------------------------------------------------------------------------------------------ */

static bool ends_with(const char *text, const char *end)
{
    const size_t length = strlen(text), n = strlen(end);
    return length >= n && strcmp(text + length - n, end) == 0;
}

/* 0 where the pipeline has none of that name. */
static double parameter(const ssfr_graph *graph, const char *key)
{
    char text[64];
    double number = 0;
    if (!ssfr_graph_row(graph, key) || ssfr_graph_get(graph, key, text, sizeof text) != SSFR_OK ||
        !ssfr_parse_number(text, &number))
        number = 0;
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

/* Layers are mixed; highlights, and the foam of noise, are added. */
static double brightest_of(const ssfr_graph *graph, const ssfr_scene *scene, const ssfr_field *behind)
{
    static const char *const mixed[] = {"sky.", "medium.color_", ".c_ff_", ".c_fb_", ".base_color_"};
    const double light = parameter(graph, "light.intensity");
    double seen = fmax(light, fmax(brightest_pixel(behind), brightest_pixel(scene->environment)));
    for (size_t i = 0; i < SSFR_COUNT(mixed); i++) seen = fmax(seen, largest(graph, mixed[i], false));
    const double added = fmax(1, light) * largest(graph, "noise_foam.color_", false);
    return seen + light * largest(graph, ".specular", true) + added;
}

static void bound_depths(ssfr_bounds *bounds, const ssfr_graph *graph, const ssfr_scene *scene)
{
    const ssfr_particles *p = scene->particles;
    const ssfr_camera *camera = &scene->camera;
    bounds->nearest = -INFINITY, bounds->farthest = INFINITY;
    for (size_t i = 0; p && i < p->n; i++) {
        double place[3];
        ssfr_particles_position(p, i, place);
        for (int k = 0; k < 3; k++) place[k] -= camera->eye[k];
        const double z = ssfr_dot(camera->back, place);
        bounds->nearest = fmax(bounds->nearest, z);
        bounds->farthest = fmin(bounds->farthest, z);
    }
    const double radius = p ? p->radius * fmax(1, largest(graph, ".radius_scale", true)) : 0;
    bounds->nearest = fmin(bounds->nearest + radius, 0);
    bounds->farthest -= radius;
    bounds->leaning = radius * (hypot(largest(graph, ".stretch", true), 1) - 1);
}

/* What the particles of a kind can add up to, each by as much as `each`: a slot has their sizes, a node draws them. */
static ssfr_result pile_up(ssfr_field **out, const ssfr_graph *graph, const ssfr_scene *scene, ssfr_slot_id slot,
                           const char *node, double each, bool by_size)
{
    ssfr_result result = SSFR_OK;
    const ssfr_particles *p = scene->particles;
    const float *sizes = NULL;
    size_t n = 0;
    char key[64];
    if (ssfr_graph_has_slot(graph, slot)) SSFR_TRY(ssfr_graph_read_values(graph, ssfr_slots[slot].name, &n, &sizes));
    const bool all_same = !p || n != p->n, none = n > 0 && all_same && !(*sizes > 0);
    snprintf(key, sizeof key, "%s.stretch", node);
    const double length = parameter(graph, key);
    snprintf(key, sizeof key, "%s.radius_scale", node);
    const double radius = p ? p->radius * parameter(graph, key) : 0;
    const ssfr_pile_options options = {
        .sizes = all_same ? NULL : sizes, .reach = radius * (length > 0 ? hypot(length, 1) : 1), .by_size = by_size};
    SSFR_TRY(ssfr_pile(out, none || !(radius > 0) ? NULL : p, &scene->camera, &options));
    for (int i = 0; i < (*out)->w * (*out)->h; i++) (*out)->data[i] *= each;
end:
    return result;
}

/* Halves end where floats do not: a sum beyond is infinite. */
static void open_halves(ssfr_field *lengths, const ssfr_graph *graph, const char *node)
{
    char key[64], storage[64];
    snprintf(key, sizeof key, "%s.storage", node);
    if (!ssfr_graph_row(graph, key) || ssfr_graph_get(graph, key, storage, sizeof storage) != SSFR_OK) return;
    for (int i = 0; i < lengths->w * lengths->h && strcmp(storage, "half") == 0; i++)
        if (!isfinite(ssfr_half_round(lengths->data[i] * (1 + slack)))) lengths->data[i] = INFINITY;
}

/* Diameters: a wider splat spreads the volume of its particle, and is thinner by the square. */
static ssfr_result bound_lengths(ssfr_field **out, const ssfr_graph *graph, const ssfr_scene *scene, ssfr_slot_id slot,
                                 const char *node)
{
    ssfr_result result = SSFR_OK;
    char key[64];
    snprintf(key, sizeof key, "%s.radius_scale", node);
    const double wide = parameter(graph, key), diameter = scene->particles ? 2 * scene->particles->radius : 0;
    snprintf(key, sizeof key, "%s.scale", node);
    const double each = wide > 0 ? parameter(graph, key) * diameter / (wide * wide) : 0;
    SSFR_TRY(pile_up(out, graph, scene, slot, node, each, true));
    open_halves(*out, graph, node);
end:
    return result;
}

ssfr_result ssfr_inspect_bounds(ssfr_bounds *out, const ssfr_graph *graph, const ssfr_scene *scene,
                                const ssfr_field *behind)
{
    const bool layers = ssfr_graph_has_slot(graph, SSFR_SLOT_thickness_back);
    const double spray = parameter(graph, "spray.strength") * largest(graph, "spray.color_", false);
    ssfr_result result = SSFR_OK;
    *out = (ssfr_bounds){.brightest = brightest_of(graph, scene, behind)};
    bound_depths(out, graph, scene);
    SSFR_TRY(bound_lengths(&out->water, graph, scene, SSFR_SLOT_water_size, layers ? "layer_thickness" : "thickness"));
    SSFR_TRY(bound_lengths(&out->foam, graph, scene, SSFR_SLOT_foam_size, "foam_thickness"));
    SSFR_TRY(pile_up(&out->spray, graph, scene, SSFR_SLOT_spray_size, "spray", spray, false));
end:
    return result;
}

void ssfr_bounds_clear(ssfr_bounds *bounds)
{
    ssfr_field_destroy(&bounds->water);
    ssfr_field_destroy(&bounds->foam);
    ssfr_field_destroy(&bounds->spray);
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

/* What a value of a slot may be at a pixel. */
static range range_at(ssfr_slot_id id, const ssfr_bounds *b, int x, int y)
{
    range r = {-INFINITY, INFINITY};
    const double leaning = id == SSFR_SLOT_foam_depth ? b->leaning : 0, nearest = fmin(b->nearest + leaning, 0),
                 farthest = b->farthest - leaning;
    if (is_of_particles(id)) {
        r = (range){farthest - slack * fabs(farthest), nearest + slack * fabs(nearest)};
    } else if (strcmp(ssfr_slots[id].exr, "T") == 0) {
        const bool of_foam = id == SSFR_SLOT_foam_thickness || id == SSFR_SLOT_foam_front;
        r = (range){0, *ssfr_field_fetch(of_foam ? b->foam : b->water, x, y) * (1 + slack)};
    } else if (id == SSFR_SLOT_color) {
        r = (range){0, (b->brightest + *ssfr_field_fetch(b->spray, x, y)) * (1 + slack)};
    }
    return r;
}

void ssfr_inspect_image(ssfr_inspected *inspected, const char *slot, const ssfr_field *image,
                        const ssfr_bounds *bounds)
{
    const ssfr_slot_id id = ssfr_slot_find(slot);
    const int n = image->w * image->h * image->c;
    for (int i = 0; i < n; i++) {
        const double value = image->data[i];
        const range r = range_at(id, bounds, i / image->c % image->w, i / image->c / image->w);
        inspected->finite &= isfinite(value);
        const bool empty = is_of_particles(id) && fabs(value) >= SSFR_SURFACE; /* a NaN is not */
        inspected->bounded &= empty || (value >= r.lo && value <= r.hi);
    }
}

/* The bounds of what is made of the splats' depths: these. */
static ssfr_result bound_smoothed(ssfr_bounds *smoothed, const ssfr_bounds *bounds, const ssfr_graph *graph)
{
    ssfr_result result = SSFR_OK;
    ssfr_field *splats = NULL;
    SSFR_TRY(ssfr_graph_read(graph, "fluid_depth", &splats));
    *smoothed = *bounds;
    smoothed->nearest = -INFINITY, smoothed->farthest = INFINITY;
    for (int i = 0; i < splats->w * splats->h; i++) {
        if (!ssfr_is_surface(splats->data[i])) continue;
        smoothed->nearest = fmax(smoothed->nearest, splats->data[i]);
        smoothed->farthest = fmin(smoothed->farthest, splats->data[i]);
    }
end:
    ssfr_field_destroy(&splats);
    return result;
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

/* Water is where there is a length of it, as layer_composite has it. */
static ssfr_result find_border(double *share, const ssfr_graph *graph, int w, int h)
{
    ssfr_result result = SSFR_OK;
    ssfr_field *border = NULL, *thickness = NULL;
    size_t water = 0, borders = 0;
    if (!ssfr_graph_has_slot(graph, SSFR_SLOT_border)) return SSFR_OK;
    SSFR_TRY(ssfr_frame_read(&border, graph, "border", w, h));
    SSFR_TRY(ssfr_frame_read(&thickness, graph, "thickness", w, h));
    for (size_t i = 0; i < (size_t)w * (size_t)h; i++) {
        water += thickness->data[i] > 0;
        borders += border->data[i] > 0;
    }
    if (water) *share = (double)borders / (double)water;
end:
    ssfr_field_destroy(&border);
    ssfr_field_destroy(&thickness);
    return result;
}

ssfr_result ssfr_inspect_frame(ssfr_inspected *out, ssfr_graph *graph, const ssfr_scene *scene,
                               const ssfr_run_options *run)
{
    ssfr_result result = SSFR_OK;
    ssfr_field *behind = NULL;
    ssfr_bounds bounds = {0}, smoothed; /* which shares its images */
    *out = (ssfr_inspected){.finite = true, .bounded = true};
    ssfr_graph_want_all(graph, true);
    SSFR_TRY(ssfr_graph_run(graph, scene, run));
    SSFR_TRY(ssfr_graph_read(graph, "scene_color", &behind));
    SSFR_TRY(ssfr_inspect_bounds(&bounds, graph, scene, behind));
    SSFR_TRY(bound_smoothed(&smoothed, &bounds, graph));
    for (int i = 0; ssfr_graph_slot_at(graph, i); i++) {
        const char *slot = ssfr_graph_slot_at(graph, i);
        const ssfr_slot_id id = ssfr_slot_find(slot);
        const bool made_of_splats = ssfr_slot_is_fluid(id) && id != SSFR_SLOT_fluid_depth;
        SSFR_TRY(inspect_slot(out, graph, slot, made_of_splats ? &smoothed : &bounds));
    }
    SSFR_TRY(find_border(&out->border_share, graph, scene->camera.w, scene->camera.h));
end:
    ssfr_graph_want_all(graph, false);
    ssfr_bounds_clear(&bounds);
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
