/* SPDX-License-Identifier: MIT */
/* foam_thickness.c: the foam along the view ray, all of it and that near its front (Bagar 2010, secs 3.2.2 and 4.8.2,
 * listing A.16). Each foam particle adds
 *
 *     2 R sqrt(1 - r^2) e^(-2 r^2) n(tc.x, tc.y, lifetime),
 *
 * with n the 3D Perlin noise of perlin.h over the quad, tc in [0, 1]: a pattern of its own for each particle, which
 * changes while it lives. Its mean is 1/2, so that noise takes half of the foam. */
#include "passes/foam_thickness.h"

#include "passes/perlin.h"

typedef struct foam_thickness_params {
    ssfr_streak_params streak;
    int kernel, occlusion, mass, noise, pattern, front, storage;
    double scale, noise_rate, delta_foam;
} foam_thickness_params;

static const char *const masses[] = {"kept", "printed", NULL};
static const char *const noises[] = {"exact", "texture", "constant", NULL}; /* SSFR_FOAM_NOISE_* */
static const char *const patterns[] = {"id", "lifetime", NULL};
static const char *const fronts[] = {"centre", "fragment", NULL};

static const ssfr_param rows[] = {
    SSFR_STREAK_ROWS,
    SSFR_THICKNESS_KERNEL_ROWS(foam_thickness_params),
    SSFR_PARAM_CHOICE(foam_thickness_params, mass, masses, 0,
                      "a quad along the motion spreads the foam of its particle, or has more by as much as it is "
                      "larger (listing A.10)"),
    SSFR_PARAM_CHOICE(foam_thickness_params, noise, noises, SSFR_FOAM_NOISE_EXACT,
                      "Perlin noise computed, from a texture of 64x64x64 texels of 8 bits, or its mean 1/2"),
    SSFR_PARAM_CHOICE(foam_thickness_params, pattern, patterns, 0,
                      "patterns differ by particle id, or by lifetime alone (listing A.16)"),
    SSFR_PARAM_REAL(foam_thickness_params, noise_rate, "1/s", 0.25, 0, 1e3,
                    "periods of the noise, each of 8 cells, that a pattern runs through in a second of lifetime"),
    SSFR_PARAM_CHOICE(foam_thickness_params, front, fronts, 0,
                      "a particle is within delta_foam of the front of the foam as its centre is, seen at the nearest "
                      "pixel of the image (sec. 4.8.2), or as its own front is at each pixel"),
    SSFR_PARAM_REAL(foam_thickness_params, delta_foam, "m", 0.08, 0, 1e6,
                    "depth of the front of the foam, that of layer_composite"),
    SSFR_PARAM_REAL(foam_thickness_params, scale, "1", 1, 0, 100, "multiplies the sum"),
    SSFR_THICKNESS_STORAGE_ROW(foam_thickness_params),
    SSFR_PARAM_END,
};

#define COEFF(name, member, n) {name, offsetof(ssfr_foam_thickness_coeffs, member), n}
static const ssfr_uniform uniforms[] = {
    SSFR_STREAK_UNIFORMS,
    SSFR_THICKNESS_SUM_UNIFORMS(ssfr_foam_thickness_coeffs, sum),
    COEFF("u_noise_rate", noise_rate, 1),
    COEFF("u_delta_foam", delta_foam, 1),
    COEFF("u_kept", kept, 0),
    COEFF("u_by_id", by_id, 0),
    COEFF("u_has_ids", has_ids, 0),
    {NULL, 0, 0},
};

static void derive(const ssfr_run *run, void *coeffs)
{
    const foam_thickness_params *p = run->params;
    const double s = p->streak.radius_scale;
    ssfr_foam_thickness_coeffs *c = coeffs;
    ssfr_streak_derive(run, &c->streak);
    /* A wider splat spreads the volume of the particle. */
    c->sum = (ssfr_thickness_sum){p->scale / (s * s * s), p->kernel == 1, p->occlusion == 1,
                                  p->storage == SSFR_STORE_HALF};
    c->noise_rate = p->noise_rate;
    c->delta_foam = p->delta_foam;
    c->kept = p->mass == 0;
    c->by_centre = p->front == 0;
    c->noise = p->noise;
    c->by_id = p->pattern == 0;
    c->has_ids = run->frame->particles && run->frame->particles->id;
}

static bool defines(const ssfr_run *run, int i, char text[SSFR_DEFINES])
{
    static const char *const lines[] = {"#define NOISE\n", "#define NOISE_TEXTURE\n", ""};
    const foam_thickness_params *p = run->params;
    snprintf(text, SSFR_DEFINES, "#define PARTICLE\n%s%s%s", lines[p->noise], ssfr_root_define(p->streak.root),
             p->front == 0 ? "#define CENTRE\n" : "");
    return i == 0;
}

static ssfr_storage storage(const void *params)
{
    return (ssfr_storage)((const foam_thickness_params *)params)->storage;
}

/* Of n quads that each add 2 R h noise, where height and noise are 2/3 and 1/2 on average. */
static void widen(const ssfr_run *run, ssfr_tolerance *tolerance)
{
    const ssfr_foam_thickness_coeffs *c = run->coeffs;
    const double noise = c->noise == SSFR_FOAM_NOISE_TEXTURE ? ssfr_foam_perlin_rounding() : 0;
    const double root = ssfr_root_rounding(c->streak.root);
    tolerance->abs += 2 * c->streak.radius * c->sum.scale * (root + noise);
    tolerance->rel += 1.5 * root + 2 * noise;
}

const ssfr_pass ssfr_foam_thickness = {
    .name = "foam_thickness",
    .source = "Bagar 2010, secs 3.2.2 and 4.8.2, listings A.10 and A.16",
    .help = "adds up each foam particle's thickness along the view ray, and that of the front of the foam",
    .inputs = {{"scene_depth", SSFR_SLOT_scene_depth}, {"foam_depth", SSFR_SLOT_foam_depth},
               SSFR_STREAK_PORTS(SSFR_SLOT_foam_size), {"lifetime", SSFR_SLOT_lifetime}},
    .outputs = {{"foam_thickness", SSFR_SLOT_foam_thickness}, {"foam_front", SSFR_SLOT_foam_front}},
    .tables = {SSFR_STREAK_TABLES,
               {&ssfr_foam_perlin, offsetof(foam_thickness_params, noise), SSFR_FOAM_NOISE_TEXTURE}},
    .params = rows,
    .params_size = sizeof(foam_thickness_params),
    .coeffs_size = sizeof(ssfr_foam_thickness_coeffs),
    .uses_ids = true,
    .derive = derive,
    .needed = ssfr_streak_needed,
    .needless = "no foam in view",
    .reach = ssfr_streak_reach,
    .storage = storage,
    .cpu_run = ssfr_foam_thickness_cpu,
    .programs = SSFR_STREAK_PROGRAMS("foam_thickness.frag", "#define PARTICLE\n#define NOISE\n#define CENTRE\n"),
    .defines = defines,
    .uniforms = uniforms,
    .gl_run = ssfr_streak_gl_add,
    .work = ssfr_streak_work,
    .tolerance = {.abs = 2e-4, .rel = 1e-3, .outliers = 0.02},
    .half_tolerance = SSFR_THICKNESS_HALF_TOLERANCE,
    .widen = widen,
};
