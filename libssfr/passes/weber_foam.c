/* SPDX-License-Identifier: MIT */
/* weber_foam.c: water turns to foam, and back, by its Weber number (libssfr/scene/weber.c). */
#include "passes/weber_foam.h"
#include "scene/classify.h"

static bool needed(const ssfr_run *run)
{
    return !run->values[0]->same && !run->values[1]->same;
}

/* By then the fades that were under way before the first frame, which cannot know them, are over. */
static double history(const void *params)
{
    const ssfr_weber_params *p = params;
    return fmax(p->fade_in_min, p->fade_in_max) + p->lifetime * fmax(p->lifetime_share_min, p->lifetime_share_max);
}

static void finish(void *state)
{
    ssfr_weber_foam_state *s = state;
    ssfr_weber_destroy(&s->weber);
}

const ssfr_pass ssfr_weber_foam = {
    .name = "weber_foam",
    .source = "Bagar 2010, secs 3.2.1 and 4.2, listings A.1 to A.3",
    .help = "tells how much of each particle is foam, and since when, from its Weber number and what it was before",
    .inputs = {{"velocity", SSFR_SLOT_velocity}, {"density", SSFR_SLOT_density}},
    .outputs = {{"foam", SSFR_SLOT_foam}, {"lifetime", SSFR_SLOT_lifetime}},
    .params = ssfr_weber_rows,
    .params_size = sizeof(ssfr_weber_params),
    .needed = needed,
    .needless = "the particles have no velocity or no density",
    .particles_run = ssfr_weber_foam_run,
    .state_size = sizeof(ssfr_weber_foam_state),
    .state_finish = finish,
    .history = history,
};
