/* SPDX-License-Identifier: MIT */
/* shadow.c: the share of the light that arrives at water and foam, past the solids (Bagar 2010, listing A.22).
 *
 * Where the fluid is, is the mean of the depths of water around a pixel or, where it is nearer, of foam. The listing
 * takes foam where there is no water alone: then drops of water behind foam cut holes of their own light into it. */
#include "passes/shadow.h"

#include "graph/draw.h"
#include "passes/environment.h"

typedef struct shadow_params {
    int kind, average, foam;
    double bias, scale;
} shadow_params;

static const char *const kinds[] = {"map", "convolution", "ray", NULL};
static const char *const averages[] = {"none", "3x3", NULL};
static const char *const foams[] = {"off", "without_water", "front", NULL};

/* Particles whose centres touch a solid reach into it by a radius. A caster at the very depth of the fluid lets half of
 * the light through in the series; twice that is all of it. */
static const ssfr_param rows[] = {
    SSFR_PARAM_CHOICE(shadow_params, kind, kinds, SSFR_SHADOW_CONVOLUTION,
                      "map: the shadow map's nearest texel; convolution: Annen et al. 2007, as the paper has it; ray: "
                      "a ray along the light, exact"),
    SSFR_PARAM_CHOICE(shadow_params, average, averages, 1,
                      "the pixel's own depth, or the mean of the 3x3 around it as listing A.22 has it"),
    SSFR_PARAM_CHOICE(shadow_params, foam, foams, SSFR_SHADOW_FOAM_FRONT,
                      "foam says where the fluid is nowhere; where there is no water, as in listing A.22; or wherever "
                      "it is before the water"),
    SSFR_PARAM_REAL(shadow_params, bias, "radii", 1, 0, 1e6,
                    "what stands above the fluid by less casts no shadow; in particle radii"),
    SSFR_PARAM_REAL(shadow_params, scale, "1", 2, 0.01, 100,
                    "of the convolution's series before it is held to 1: more makes its step steeper and lets light "
                    "through below casters"),
    SSFR_PARAM_END,
};

static const ssfr_uniform uniforms[] = {
    SSFR_LIGHT_VIEW_UNIFORMS(ssfr_shadow_coeffs),
    {"u_divisor", offsetof(ssfr_shadow_coeffs, divisor), 1},
    {"u_night", offsetof(ssfr_shadow_coeffs, view.night), 0},
    {"u_bias", offsetof(ssfr_shadow_coeffs, bias), 1},
    {"u_scale", offsetof(ssfr_shadow_coeffs, scale), 1},
    {"u_kind", offsetof(ssfr_shadow_coeffs, kind), 0},
    {"u_around", offsetof(ssfr_shadow_coeffs, around), 0},
    {"u_foam", offsetof(ssfr_shadow_coeffs, foam), 0},
    {NULL, 0, 0},
};

static bool reads(const void *params, int port)
{
    const shadow_params *p = params;
    if (port == SSFR_SHADOW_LIGHT_DEPTH) return p->kind == SSFR_SHADOW_MAP;
    if (port == SSFR_SHADOW_BASIS) return p->kind == SSFR_SHADOW_CONVOLUTION;
    return port != SSFR_SHADOW_FOAM_DEPTH || p->foam;
}

static void derive(const ssfr_run *run, void *coeffs)
{
    const shadow_params *p = run->params;
    *(ssfr_shadow_coeffs *)coeffs = (ssfr_shadow_coeffs){
        .view = ssfr_light_view_of(run->frame), .bias = p->bias * run->frame->radius, .scale = p->scale,
        .divisor = run->divisor, .kind = p->kind, .around = p->average, .foam = p->foam};
}

/* Rays alone need solids. */
static bool defines(const ssfr_run *run, int i, char text[SSFR_DEFINES])
{
    const ssfr_shadow_coeffs *c = run->coeffs;
    const bool rays = c->kind == SSFR_SHADOW_RAY && c->view.n_casters > 0;
    (void)i;
    ssfr_environment_defines(run->frame, rays, rays, text);
    return true;
}

/* Of an input on either twin, px. */
static void size_of(const ssfr_run *run, int input, int out[2])
{
    const ssfr_field *field = run->in[input];
    const ssfr_texture *texture = run->draw ? run->draw->in[input] : NULL;
    out[0] = texture ? texture->w : field->w;
    out[1] = texture ? texture->h : field->h;
}

/* Four texels of each of its images. */
static double basis_taps(const ssfr_run *run)
{
    int size[2];
    size_of(run, SSFR_SHADOW_BASIS, size);
    return 4.0 * (size[1] / size[0]);
}

static void work(const ssfr_run *run, ssfr_node_report *report)
{
    const ssfr_shadow_coeffs *c = run->coeffs;
    const double near = c->around ? 9 : 1;
    report->taps = near * (c->foam ? 2 : 1); /* without_water: at most */
    if (c->kind == SSFR_SHADOW_MAP) report->taps++;
    if (c->kind == SSFR_SHADOW_CONVOLUTION) report->taps += basis_taps(run);
}

/* The light's view is a square, and its basis squares one below the other: what a user gives may be neither. */
static ssfr_result check(const ssfr_run *run, const char *pass)
{
    const int kind = ((const ssfr_shadow_coeffs *)run->coeffs)->kind;
    int size[2];
    if (kind == SSFR_SHADOW_RAY) return SSFR_OK;
    size_of(run, kind == SSFR_SHADOW_MAP ? SSFR_SHADOW_LIGHT_DEPTH : SSFR_SHADOW_BASIS, size);
    if (kind == SSFR_SHADOW_MAP && size[0] != size[1])
        return ssfr_fail(SSFR_ERR_VALUE, "%s: light_depth has %d x %d pixels: it must be square", pass,
                         size[0], size[1]);
    if (size[1] % size[0])
        return ssfr_fail(SSFR_ERR_VALUE, "%s: basis has %d x %d pixels: squares must stand one below the other", pass,
                         size[0], size[1]);
    return SSFR_OK;
}

const ssfr_pass ssfr_shadow = {
    .name = "shadow",
    .source = "Bagar 2010, sec. 4.9.4 and listing A.22, with convolution shadow maps (Annen et al. 2007)",
    .help = "share of the light that arrives at water and foam past the solids",
    .inputs = {{"depth", SSFR_SLOT_surface_depth}, {"foam_depth", SSFR_SLOT_foam_depth},
               {"light_depth", SSFR_SLOT_light_depth}, {"basis", SSFR_SLOT_light_basis}},
    .outputs = {{"light", SSFR_SLOT_light, .like = "depth"}},
    .params = rows,
    .params_size = sizeof(shadow_params),
    .coeffs_size = sizeof(ssfr_shadow_coeffs),
    .reads = reads,
    .derive = derive,
    .needed = ssfr_light_view_has_shadow,
    .needless = SSFR_NO_CASTER,
    .cpu_run = ssfr_shadow_cpu,
    .programs = {{"tiles.vert", "shadow.frag", NULL}},
    .defines = defines,
    .uniforms = uniforms,
    .work = work,
    .check = check,
    .tolerance = {.abs = 1e-3, .rel = 0, .outliers = 0.01},
};
