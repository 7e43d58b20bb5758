/* SPDX-License-Identifier: MIT */
/* splat.c: parameters that all splatting passes share, and their work. */
#include "passes/splat.h"

#include "graph/draw.h"

const char *const ssfr_splat_forms[] = {"point", "quad", "exact", NULL};
const char *const ssfr_splat_sizes[] = {"depth", "distance", NULL};

static int root_of(const ssfr_splat_params *p)
{
    return p->form == SSFR_SPLAT_EXACT ? SSFR_ROOT_EXACT : p->root;
}

void ssfr_splat_derive(const ssfr_run *run, void *coeffs)
{
    ssfr_splat *splat = coeffs;
    const ssfr_splat_params *p = run->params;
    splat->radius = run->frame->radius * p->radius_scale;
    splat->max_point_px = p->max_point_px;
    splat->form = p->form;
    splat->by_distance = p->size == SSFR_SIZE_DISTANCE;
    splat->root = root_of(p);
    splat->spares_foam = 0;
}

bool ssfr_splat_define(const ssfr_run *run, int i, const char *more, char text[SSFR_DEFINES])
{
    static const char *const forms[] = {"POINT", "QUAD", "EXACT"};
    const ssfr_splat_params *p = run->params;
    const char *sizes = run->values[0] && !run->values[0]->same ? "#define SIZES\n" : "";
    const char *root = ssfr_root_define(root_of(p));
    text[0] = '\0';
    if (sizes[0] || root[0] || more[0])
        snprintf(text, SSFR_DEFINES, "#define %s\n%s%s%s", forms[i], sizes, root, more);
    return i == p->form;
}

bool ssfr_splat_defines(const ssfr_run *run, int i, char text[SSFR_DEFINES])
{
    return ssfr_splat_define(run, i, "", text);
}

double ssfr_splat_reach(const void *params)
{
    return ((const ssfr_splat_params *)params)->radius_scale;
}

bool ssfr_splat_needed(const ssfr_run *run)
{
    return run->frame->facts.n_particles > 0 && (!run->values[0] || run->n_valued[0] > 0);
}

void ssfr_splat_work(const ssfr_run *run, ssfr_node_report *report)
{
    const ssfr_splat_params *p = run->params;
    const double n = (double)run->frame->facts.n_particles;
    report->vertices = p->form == SSFR_SPLAT_POINT ? n : 4 * n;
    report->bytes += n * 3 * sizeof(float);
}

static ssfr_result splat_gl(const ssfr_run *run, ssfr_splat_blend blend)
{
    const ssfr_splat *splat = run->coeffs;
    const double largest = ssfr_gl_get_limits(run->draw->gl)->point_px;
    const ssfr_splat_primitive primitive = splat->form == SSFR_SPLAT_POINT ? SSFR_POINTS : SSFR_QUADS;
    if (primitive == SSFR_POINTS && splat->max_point_px > largest) /* the driver would cut them without a word */
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "max_point_px %g: this GPU draws points of up to %g px",
                         splat->max_point_px, largest);
    return ssfr_draw_splats(run, run->draw->programs[splat->form], primitive, blend);
}

ssfr_result ssfr_splat_gl_nearest(const ssfr_run *run)
{
    return splat_gl(run, SSFR_BLEND_NEAREST);
}

ssfr_result ssfr_splat_gl_add(const ssfr_run *run)
{
    return splat_gl(run, SSFR_BLEND_ADD);
}
