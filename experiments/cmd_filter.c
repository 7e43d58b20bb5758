/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_filter.c: `ssfr filter`: one pass on the user's own buffers. */
#include "experiments/channels.h"
#include "experiments/command.h"
#include "experiments/depth.h"
#include "experiments/output.h"
#include "experiments/record.h"
#include "experiments/truth/flow.h"

#include "graph/graph.h"

typedef struct filter_options {
    const char *output;
    ssfr_list channels;
    int kind;         /* ssfr_depth_kind */
    double near, far; /* m; 0: not given */
    double fov_deg, radius;
    int reference;    /* ssfr_flow_method + 1; 0: the pass itself */
} filter_options;

#define ROW(...) SSFR_OPTION(filter_options, __VA_ARGS__)
static const ssfr_option rows[] = {
    ROW(output, "output", 'o', TEXT, "FILE.exr", "where to write what the pass writes; depths as eye-space z, m", 0, 0),
    ROW(channels, "channel", 0, LIST, "PORT=NAMES[:FILE]",
        "the channels that a port of the pass reads, by commas, in the order of the port, from another file if need be "
        "(default: those that 'ssfr passes PASS' names, from the input)",
        0, 0),
    ROW(kind, "depth", 0, WORD, "eye|positive|window|reversed",
        "how depths are stored: eye-space z, negative in front (default); distance along the view axis; window depth "
        "in [0, 1], 0 near; reversed window depth, 1 near",
        0, 0),
    ROW(near, "near", 0, NUMBER, "M", "the near plane of window depth, m", 1e-9, 1e12),
    ROW(far, "far", 0, NUMBER, "M", "the far plane of window depth, m (default: infinitely far)", 1e-9, 1e12),
    ROW(fov_deg, "fov", 0, NUMBER, "DEG", "full vertical field of view of the image (default 45)", 0.001, 179),
    ROW(radius, "radius", 0, NUMBER, "M", "particle radius, for passes that need one (default 0.02)", 1e-9, 1e9),
    ROW(reference, "reference", 0, WORD, "none|rk8pd|msbdf",
        "curvature_flow: in the place of its steps the flow that they approximate, by this solver, on the CPU: "
        "explicit (up to 128x128 px) or implicit (up to 24x24 px, for stiff ones)",
        0, 0),
    SSFR_OPTION_END,
};

static ssfr_result check_planes(const filter_options *o)
{
    const bool needed = o->kind == SSFR_DEPTH_WINDOW || o->kind == SSFR_DEPTH_REVERSED;
    if (needed && !(o->near > 0)) return ssfr_fail(SSFR_ERR_VALUE, "--depth window and reversed need --near");
    if (needed && o->far > 0 && o->far <= o->near)
        return ssfr_fail(SSFR_ERR_VALUE, "--far %g: must be beyond --near %g", o->far, o->near);
    return SSFR_OK;
}

/* ---- what the ports read ----------------------------------------------------------------------------------------- */

typedef struct source { /* where a port's image comes from */
    char names[256];
    const char *file; /* NULL: the port stays empty */
} source;

/* What --channel says of a port, NULL when nothing. */
static const char *user_channels(const ssfr_list *channels, const char *port)
{
    const char *found = NULL;
    const size_t length = strlen(port);
    for (int i = 0; i < channels->n; i++)
        if (strncmp(channels->items[i], port, length) == 0 && channels->items[i][length] == '=')
            found = channels->items[i] + length + 1;
    return found;
}

static ssfr_result check_channels(const ssfr_list *channels, const ssfr_pass *pass)
{
    for (int i = 0; i < channels->n; i++) {
        const size_t length = strcspn(channels->items[i], "=");
        bool found = false;
        for (const ssfr_port *port = pass->inputs; port->name; port++)
            found |= strlen(port->name) == length && memcmp(port->name, channels->items[i], length) == 0;
        if (!found || !channels->items[i][length])
            return ssfr_fail(SSFR_ERR_UNKNOWN, "--channel %s: expected PORT=NAMES for an input of %s",
                             channels->items[i], pass->name);
    }
    return SSFR_OK;
}

/* The user's word, else the first port of its kind reads the channels that files of this program have. */
static source find_source(const ssfr_pass *pass, int k, const filter_options *options, const char *file,
                          const char *file_channels)
{
    const ssfr_port *port = &pass->inputs[k];
    const char *user = user_channels(&options->channels, port->name), *usual = ssfr_slots[port->slot].exr;
    const char *colon = user ? strchr(user, ':') : NULL;
    bool first = true;
    source s = {.file = file};
    for (int i = 0; i < k; i++) first &= strcmp(ssfr_slots[pass->inputs[i].slot].exr, usual) != 0;
    if (user) {
        snprintf(s.names, sizeof s.names, "%.*s", (int)strcspn(user, ":"), user);
        if (colon) s.file = colon + 1;
    } else if (first && ssfr_channels_include(file_channels, usual)) {
        snprintf(s.names, sizeof s.names, "%s", usual);
    } else {
        s.file = NULL;
    }
    return s;
}

typedef struct inputs {
    int w, h; /* px, of the largest image */
    int n;
    int n_depths;
    ssfr_depth_range range;
} inputs;

static ssfr_result import(ssfr_graph *graph, const ssfr_port *port, const source *from, const filter_options *options,
                          inputs *in)
{
    ssfr_result result = SSFR_OK;
    ssfr_field *field = NULL;
    const ssfr_depth_format format = {(ssfr_depth_kind)options->kind, options->near, options->far};
    SSFR_TRY(ssfr_exr_load(from->file, from->names, &field));
    in->n++;
    if (ssfr_slots[port->slot].kind == SSFR_IMAGE)
        in->w = ssfr_max_int(in->w, field->w), in->h = ssfr_max_int(in->h, field->h);
    if (strcmp(ssfr_slots[port->slot].exr, "Z") == 0) {
        ssfr_depth_convert(&format, field, &in->range);
        in->n_depths++;
    }
    SSFR_TRY(ssfr_graph_import(graph, port->name, field));
    ssfr_log(SSFR_INFO, "%s reads %s of %s, %dx%d px", port->name, from->names, from->file, field->w, field->h);
end:
    ssfr_field_destroy(&field);
    return result;
}

static ssfr_result fail_nothing(const ssfr_pass *pass, const char *file, const char *channels)
{
    char ports[512] = "";
    size_t used = 0;
    for (const ssfr_port *port = pass->inputs; port->name && used < sizeof ports; port++)
        used += (size_t)snprintf(ports + used, sizeof ports - used, "%s%s (%s)", used ? ", " : "", port->name,
                                 ssfr_slots[port->slot].exr);
    return ssfr_fail(SSFR_ERR_VALUE, "%s: has channels %s; %s reads %s: give --channel", file, channels, pass->name,
                     ports);
}

/* A pass goes on without an image: its values are neutral. That may be meant. */
static void warn_of_empty(const ssfr_pass *pass, const filter_options *options, const char *file, const char *channels)
{
    for (int k = 0; pass->inputs[k].name; k++)
        if (!find_source(pass, k, options, file, channels).file)
            ssfr_log(SSFR_WARNING, "%s is left empty: --channel %s=NAMES fills it", pass->inputs[k].name,
                     pass->inputs[k].name);
}

static ssfr_result import_all(ssfr_graph *graph, const ssfr_pass *pass, const filter_options *options, const char *file,
                              inputs *in)
{
    ssfr_result result = SSFR_OK;
    char *channels = NULL;
    *in = (inputs){0};
    SSFR_TRY(ssfr_exr_channels(file, &channels));
    for (int k = 0; pass->inputs[k].name; k++) {
        if (ssfr_slots[pass->inputs[k].slot].kind == SSFR_PARTICLES) continue;
        const source from = find_source(pass, k, options, file, channels);
        if (from.file) SSFR_TRY(import(graph, &pass->inputs[k], &from, options, in));
    }
    if (in->n == 0) {
        result = fail_nothing(pass, file, channels);
        goto end;
    }
    warn_of_empty(pass, options, file, channels);
    if (in->n_depths && in->range.n == 0)
        ssfr_log(SSFR_WARNING, "%s: no pixel of depth is a surface; is --depth right?", file);
end:
    free(channels);
    return result;
}

/* ---- running ----------------------------------------------------------------------------------------------------- */

/* The graph learns from packets of particles where the fluid is: one stands at the nearest pixel, the other as far
 * behind as makes their mean distance that of all pixels. */
static ssfr_result make_stand_ins(ssfr_particles **out, const ssfr_depth_range *range, double radius)
{
    static double positions[2 * SSFR_PACKET][3];
    const ssfr_particles given = {.radius = radius};
    const double nearest = range->n ? range->nearest : 1, mean = range->n ? range->sum / (double)range->n : 1;
    for (int i = 0; i < 2 * SSFR_PACKET; i++) positions[i][2] = i < SSFR_PACKET ? -nearest : nearest - 2 * mean;
    return ssfr_particles_create(out, 2 * SSFR_PACKET, positions[0], &given);
}

static ssfr_result run_pass(ssfr_graph *graph, const filter_options *options, const inputs *in)
{
    static const double origin[3] = {0, 0, 0}, up[3] = {0, 1, 0}, ahead[3] = {0, 0, -1};
    const ssfr_run_options run = {.keep_all = true, .timing = true};
    ssfr_result result = SSFR_OK;
    ssfr_particles *particles = NULL;
    ssfr_scene scene = {.floor = -INFINITY};
    SSFR_TRY(make_stand_ins(&particles, &in->range, options->radius));
    scene.particles = particles;
    SSFR_TRY(ssfr_camera_look(&scene.camera, origin, ahead, up, options->fov_deg * acos(-1) / 180,
                              ssfr_max_int(in->w, 1), ssfr_max_int(in->h, 1))); /* maps have no view */
    scene.camera.near = in->range.n ? in->range.nearest : 1;
    scene.camera.far = 1.01 * fmax(in->range.farthest, scene.camera.near);
    SSFR_TRY(ssfr_graph_run(graph, &scene, &run));
    const ssfr_node_report *node = &ssfr_graph_report(graph)->nodes[0];
    ssfr_log(SSFR_INFO, "%s: %.3f ms, %.1f taps/px, %g sweeps", node->node, node->ms, node->taps, node->iterations);
end:
    ssfr_particles_destroy(&particles);
    return result;
}

/* The flow without steps, in the place of what the pass made of the same input with the same coefficients. */
static ssfr_result run_reference(const ssfr_graph *graph, int reference, ssfr_record *record)
{
    ssfr_result result = SSFR_OK;
    const ssfr_flow_method method = (ssfr_flow_method)(reference - 1);
    const ssfr_run *run = ssfr_graph_last_run(graph, 0);
    ssfr_flow_report r = {0};
    if (!run) return SSFR_OK; /* there was nothing to do */
    SSFR_TRY(ssfr_flow_run(run, method, SSFR_FLOW_TOLERANCE, &r));
    const struct {
        const char *name;
        double number;
    } items[] = {{"tolerance", SSFR_FLOW_TOLERANCE},       {"time", r.time},
                 {"reached", r.reached},                   {"unknowns", (double)r.unknowns},
                 {"steps", (double)r.steps},               {"failed", (double)r.failed},
                 {"evaluations", (double)r.evaluations},   {"jacobians", (double)r.jacobians},
                 {"crossings", (double)r.crossings},       {"flickers", (double)r.flickers},
                 {"err", r.err}};
    SSFR_TRY(ssfr_record_text(record, "reference", ssfr_flow_names[method]));
    for (size_t i = 0; i < SSFR_COUNT(items); i++) {
        char name[64];
        snprintf(name, sizeof name, "reference.%s", items[i].name);
        SSFR_TRY(ssfr_record_number(record, name, items[i].number));
    }
    printf("%s: %zu unknowns to %.9g of %.9g m^2, %zu steps, %zu failed, %zu evaluations, %zu Jacobians, "
           "%zu crossings, %zu flickers, err %.3g m\n",
           ssfr_flow_names[method], r.unknowns, r.reached, r.time, r.steps, r.failed, r.evaluations, r.jacobians,
           r.crossings, r.flickers, r.err);
end:
    return result;
}

static ssfr_result save(const ssfr_setup *setup, const ssfr_pass *pass, const char *path, const ssfr_record *record)
{
    ssfr_result result = SSFR_OK;
    ssfr_layer layers[SSFR_MAX_OUTPUTS] = {0};
    int n = 0;
    for (; pass->outputs[n].name; n++) {
        layers[n].channels = ssfr_slots[pass->outputs[n].slot].exr;
        SSFR_TRY(ssfr_graph_read(setup->graph, pass->outputs[n].name, &layers[n].field));
    }
    SSFR_TRY(ssfr_exr_save(path, n, layers, record->n, record->items));
end:
    for (int i = 0; i < SSFR_MAX_OUTPUTS; i++) ssfr_field_destroy(&layers[i].field);
    return result;
}

static ssfr_result check(const filter_options *options, const ssfr_pass *pass)
{
    ssfr_result result = SSFR_OK;
    if (!options->output) return ssfr_fail(SSFR_ERR_VALUE, "nowhere to write: give -o FILE.exr");
    SSFR_TRY(ssfr_output_check_image(options->output, false));
    if (pass->particles_run)
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: works on particles and filters no image", pass->name);
    if (pass->reach || !pass->inputs[0].name)
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: draws a scene and filters no image: use render", pass->name);
    SSFR_TRY(check_planes(options));
    if (options->reference && strcmp(pass->name, "curvature_flow") != 0)
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "--reference: of curvature_flow only, not of %s", pass->name);
    SSFR_TRY(check_channels(&options->channels, pass));
end:
    return result;
}

int ssfr_cmd_filter(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    filter_options options = {.fov_deg = 45, .radius = 0.02};
    ssfr_setup_options setup_options;
    ssfr_command_line line;
    ssfr_setup setup = {0};
    ssfr_record record = {0};
    const ssfr_pass *pass = NULL;
    inputs in;
    const ssfr_option_set sets[] = {{"filter", rows, &options},
                                    {"what runs", ssfr_setup_rows + 1, &setup_options}, /* no --pipeline */
                                    {NULL, NULL, NULL}};
    const ssfr_usage usage = {.command = argv[0], .arguments = "PASS IN.exr -o OUT.exr", .min_arguments = 2,
                              .max_arguments = 2, .sets = sets,
                              .help = "Runs one pass ('ssfr passes' lists them) on your own buffers."};
    ssfr_setup_defaults(&setup_options);
    SSFR_TRY(ssfr_options_parse(&line, &usage, argc, argv));
    if (line.help) goto end;
    SSFR_TRY(ssfr_setup_find_pass(&pass, line.arguments.items[0]));
    SSFR_TRY(check(&options, pass));
    if (options.reference) setup_options.backend = SSFR_BACKEND_CPU;
    SSFR_TRY(ssfr_setup_init(&setup, &setup_options, pass));
    SSFR_TRY(import_all(setup.graph, pass, &options, line.arguments.items[1], &in));
    SSFR_TRY(run_pass(setup.graph, &options, &in));
    SSFR_TRY(ssfr_record_program(&record, &setup, &line, argc, argv));
    SSFR_TRY(ssfr_record_number(&record, "camera.fov_deg", options.fov_deg));
    SSFR_TRY(ssfr_record_graph(&record, setup.graph));
    if (options.reference) SSFR_TRY(run_reference(setup.graph, options.reference, &record));
    SSFR_TRY(save(&setup, pass, options.output, &record));
end:
    ssfr_record_finish(&record);
    ssfr_setup_finish(&setup);
    return ssfr_exit_status(result);
}
