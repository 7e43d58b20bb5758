/* SPDX-License-Identifier: MIT */
/* layer_composite.c: layers of water and foam over the scene, from back to front (Bagar 2010, sec. 3.2.3):
 *
 *     C_wb = lerp(c_fluid, C_background, e^-T_wb)   the water behind the front of the foam,   (3.5)
 *     C_f  = lerp(c_foam,  C_wb,         e^-T_f)    the foam,                                 (3.6)
 *     C_wf = lerp(c_fluid, C_f,          e^-T_wf)   the water before it,                      (3.7)
 *     illuminate(x) = x (1 - F) + r F + k_s (n . h)^alpha,                                    (3.8)
 *     c_foam = lerp(c_ff, c_fb, e^-T_ff),                                                     (3.9, corrected)
 *
 * where C_wf is illuminated, or C_wb where no water is before the foam. Each T is a length times a coefficient.
 *
 * The surface is that of images of depth and normals, or (sec. 4.9.3) read straight from the smoothed depth at its own
 * resolution, see split.c. Then its outline is that of the water's thickness. */
#include "passes/layer_composite.h"

typedef struct layer_params {
    ssfr_optics optics; /* first */
    int fresnel, fluid_color, foam_blend;
    double fresnel_bias, fresnel_scale, fresnel_power;
    double base_color_r, base_color_g, base_color_b, falloff_scale;
    double color_falloff_r, color_falloff_g, color_falloff_b, color_falloff_w;
    double c_ff_r, c_ff_g, c_ff_b, c_fb_r, c_fb_g, c_fb_b;
    double delta_foam, foam_pow_scale, foam_falloff_scale, Ka;
    unsigned as_printed;
    int surface, border, off_axis;
    double depth_thresh, lone_thresh;
} layer_params;

static const char *const fresnels[] = {"power", "exact", NULL};
static const char *const fluid_colors[] = {"constant", "falloff", NULL};
static const char *const foam_blends[] = {"exponential", "power", NULL};
static const char *const printed[] = {"B10", "B11", "B12", "B26", "B28", "B29", NULL}; /* SSFR_PRINTED_* */
static const char *const surfaces[] = {"image", "split", NULL};
static const char *const borders[] = {"split", "never", "always", NULL};

#define REAL(name, unit, def, min, max, help) SSFR_PARAM_REAL(layer_params, name, unit, def, min, max, help)
#define RGB(name, r, g, b, max, help)         \
    REAL(name##_r, "1", r, 0, max, help ", red"),   \
    REAL(name##_g, "1", g, 0, max, help ", green"), \
    REAL(name##_b, "1", b, 0, max, help ", blue")

/* Defaults: the papers give none of these but Ka. Fresnel's term is Schlick's for an index of 1.333. The base colour
 * and its falloff make shallow water turquoise and deep water dark, with the ratios of medium.absorption. Foam is
 * white in front and a bluish grey behind. A foam particle of 0.04 m across, as those of R = 0.02 m are, lets 1/e of
 * the light through; the front of the foam is two of them deep. depth_thresh, too, is 5 such radii, as depth_falloff of
 * other passes is; it is in metres because this pass also works on images, which tell no radius. */
static const ssfr_param rows[] = {
    SSFR_PARAM_CHOICE(layer_params, fresnel, fresnels, SSFR_LAYER_FRESNEL_POWER,
                      "bias + scale (1 - n.v)^power, or Fresnel's equations with medium.ior"),
    REAL(fresnel_bias, "1", 0.0204, 0, 1, "share mirrored at normal incidence"),
    REAL(fresnel_scale, "1", 0.9796, 0, 1, "share that grazing angles add"),
    REAL(fresnel_power, "1", 5, 0.01, 100, "how late they add it"),
    SSFR_OPTICS_SHIFT_ROW,
    SSFR_OPTICS_SCENE_ROWS,
    SSFR_PARAM_CHOICE(layer_params, fluid_color, fluid_colors, SSFR_FLUID_CONSTANT,
                      "c_fluid is medium.color (eqs 3.5, 3.7), or base_color e^(-T falloff) (listing A.20)"),
    SSFR_OPTICS_WATER_ROWS,
    RGB(base_color, 0.1, 0.35, 0.4, 1e3, "colour of thin water with fluid_color=falloff, linear"),
    REAL(falloff_scale, "1/m", 1, 0, 1e6, "of all color_falloff"),
    RGB(color_falloff, 2.2, 0.65, 0.45, 1e3, "how fast base_color darkens"),
    REAL(color_falloff_w, "1", 0.65, 0, 1e3, "how fast what is behind vanishes"),
    RGB(c_ff, 0.95, 0.95, 0.95, 1e3, "colour of much foam near its front, linear"),
    RGB(c_fb, 0.5, 0.62, 0.7, 1e3, "colour of foam behind, linear"),
    REAL(delta_foam, "m", 0.08, 1e-6, 1e6, "depth of the front of the foam, that of foam_front"),
    SSFR_PARAM_CHOICE(layer_params, foam_blend, foam_blends, SSFR_FOAM_EXPONENTIAL,
                      "share of c_ff for a part t of delta_foam: 1 - e^-t (eq. 3.9), or t (listing A.20)"),
    REAL(foam_pow_scale, "1", 1, 0.01, 4, "exponent of t"),
    REAL(foam_falloff_scale, "1/m", 25, 0, 1e6, "attenuation of light by foam"),
    REAL(Ka, "1", 0.6, 0, 1, "share of the light that reaches foam in the shade"),
    SSFR_OPTICS_HIGHLIGHT_ROWS,
    SSFR_PARAM_CHOICE(layer_params, surface, surfaces, SSFR_LAYER_IMAGE,
                      "image: depth and normals of the frame's resolution; split: the smoothed depth itself, whatever "
                      "its resolution (sec. 4.9.3)"),
    REAL(depth_thresh, "m", 0.1, 0, 1e6,
         "second differences of the smoothed depth beyond this are a border (split)"),
    SSFR_PARAM_CHOICE(layer_params, border, borders, SSFR_BORDER_SPLIT,
                      "where colours of four pixels are interpolated, and elsewhere normals: split: by depth_thresh; "
                      "never: only where a depth lacks; always (split)"),
    REAL(lone_thresh, "m", 0.1, 0, 1e6,
         "at a border a pixel of the depth whose neighbours are all farther away than this faces the eye; 0: however "
         "far they are they tell its normal, as in listing A.24 (split)"),
    SSFR_PARAM_FLAG(layer_params, off_axis, 1,
                    "interpolated normals are the surface's own; off: listing A.18, exact on the view axis alone "
                    "(split)"),
    SSFR_PARAM_SET(layer_params, as_printed, printed, 0,
                   "B10: eq. 3.9 with its colours exchanged; B11: listing A.20's weight of reflection and highlight; "
                   "B12: 1 + n.v for 1 - n.v; B26: more foam than delta_foam counts; B28: half a pixel of the smoothed "
                   "depth aside (split); B29: gamma in pixels a metre, nothing rejected"),
    SSFR_PARAM_END,
};

#define COEFF(name, member, n) {name, offsetof(ssfr_layer_composite_coeffs, member), n}
static const ssfr_uniform uniforms[] = {
    SSFR_OPTICS_UNIFORMS,
    COEFF("u_shift", shift, 1),
    COEFF("u_fresnel", fresnel, 3),
    COEFF("u_base", base, 3),
    COEFF("u_falloff", falloff, 4),
    COEFF("u_c_ff", c_ff, 3),
    COEFF("u_c_fb", c_fb, 3),
    COEFF("u_foam", foam, 4),
    COEFF("u_ambient", ambient, 1),
    COEFF("u_exact_fresnel", exact_fresnel, 0),
    COEFF("u_falloff_model", falloff_model, 0),
    COEFF("u_power_blend", power_blend, 0),
    COEFF("u_foam_swapped", foam_swapped, 0),
    COEFF("u_front_weight", front_weight, 0),
    COEFF("u_cosine_added", cosine_added, 0),
    SSFR_SPLIT_UNIFORMS(ssfr_layer_composite_coeffs, split),
    {NULL, 0, 0},
};

static bool reads(const void *params, int port)
{
    const bool split = ((const layer_params *)params)->surface == SSFR_LAYER_SPLIT;
    if (port == SSFR_LAYER_LOW) return split;
    return !(split && (port == SSFR_OPTICS_DEPTH || port == SSFR_OPTICS_NORMAL));
}

static ssfr_split split_of(const ssfr_run *run, const layer_params *p)
{
    /* The magnitude of a second difference that lacks a depth is SSFR_EMPTY, of one that lacks none less. */
    const double most[] = {p->depth_thresh, SSFR_SURFACE, -1};
    const double lone = p->lone_thresh > 0 ? p->lone_thresh : SSFR_SURFACE;
    return (ssfr_split){.low = {run->divisor_in[SSFR_LAYER_LOW], most[p->border], lone}, .off_axis = p->off_axis,
                        .half_shift = (p->as_printed & SSFR_PRINTED_B28) != 0};
}

static void derive(const ssfr_run *run, void *coeffs)
{
    const layer_params *p = run->params;
    const unsigned as = p->as_printed;
    const double f = p->falloff_scale;
    ssfr_layer_composite_coeffs *c = coeffs;
    *c = (ssfr_layer_composite_coeffs){
        .optics = p->optics, .shift = p->optics.gamma * (as & SSFR_PRINTED_B29 ? 1 : run->h),
        .fresnel = {p->fresnel_bias, p->fresnel_scale, p->fresnel_power},
        .base = {p->base_color_r, p->base_color_g, p->base_color_b},
        .falloff = {f * p->color_falloff_r, f * p->color_falloff_g, f * p->color_falloff_b, f * p->color_falloff_w},
        .c_ff = {p->c_ff_r, p->c_ff_g, p->c_ff_b}, .c_fb = {p->c_fb_r, p->c_fb_g, p->c_fb_b},
        .foam = {p->foam_falloff_scale, 1 / p->delta_foam, as & SSFR_PRINTED_B26 ? SSFR_THICKEST : 1,
                 p->foam_pow_scale},
        .ambient = p->Ka,
        .exact_fresnel = p->fresnel == SSFR_LAYER_FRESNEL_EXACT, .falloff_model = p->fluid_color == SSFR_FLUID_FALLOFF,
        .power_blend = p->foam_blend == SSFR_FOAM_POWER, .foam_swapped = (as & SSFR_PRINTED_B10) != 0,
        .front_weight = (as & SSFR_PRINTED_B11) != 0, .cosine_added = (as & SSFR_PRINTED_B12) != 0,
        .is_split = p->surface == SSFR_LAYER_SPLIT, .split = split_of(run, p)};
    if (as & SSFR_PRINTED_B29) c->optics.reject = 0;
}

static bool defines(const ssfr_run *run, int i, char text[SSFR_DEFINES])
{
    const ssfr_layer_composite_coeffs *c = run->coeffs;
    const bool runs = ssfr_optics_defines(run, i, text);
    const size_t used = strlen(text);
    snprintf(text + used, SSFR_DEFINES - used, "%s%s", c->is_split ? "#define SPLIT\n" : "",
             run->n_out > 1 ? "#define BORDER\n" : "");
    return runs;
}

/* The scene's colour 4, and 1 to begin as it; its depth; 4 thicknesses; light; depth and normal, or four lines of three
 * depths. At a border it is more: by 20 depths, and by the scene's colour and depth three times. */
static void work(const ssfr_run *run, ssfr_node_report *report)
{
    report->taps = ((const ssfr_layer_composite_coeffs *)run->coeffs)->is_split ? 23 : 13;
}

const ssfr_pass ssfr_layer_composite = {
    .name = "layer_composite",
    .source = "Bagar 2010, secs 3.2.3 and 4.9 (eqs 3.5 to 3.9, listings A.17 to A.25)",
    .help = "shades layers of water and foam over the scene, from back to front",
    .inputs = {{"scene_color", SSFR_SLOT_scene_color}, {"scene_depth", SSFR_SLOT_scene_depth},
               {"depth", SSFR_SLOT_surface_depth}, {"normal", SSFR_SLOT_normal},
               {"thickness_back", SSFR_SLOT_thickness_back}, {"thickness_front", SSFR_SLOT_thickness_front},
               {"foam_thickness", SSFR_SLOT_foam_thickness}, {"foam_front", SSFR_SLOT_foam_front},
               {"light", SSFR_SLOT_light}, {"low", SSFR_SLOT_smooth_depth, .any_size = true}},
    .outputs = {{"color", SSFR_SLOT_color, .from = "scene_color", .over = "scene_color"},
                {"border", SSFR_SLOT_border, .optional = true}},
    .params = rows,
    .params_size = sizeof(layer_params),
    .coeffs_size = sizeof(ssfr_layer_composite_coeffs),
    .derive = derive,
    .needed = ssfr_needs_layers,
    .needless = SSFR_NO_FLUID ": the picture is the scene",
    .reads = reads,
    .cpu_run = ssfr_layer_composite_cpu,
    .programs = {{"tiles.vert", "layer_composite.frag", NULL}},
    .defines = defines,
    .uniforms = uniforms,
    .work = work,
    .tolerance = {.abs = 1e-3, .rel = 1e-3, .outliers = 0.01},
};
