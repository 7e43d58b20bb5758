/* SPDX-License-Identifier: MIT */
/* weber_foam_cpu.c: the phases of ssfr_weber, gone on with where the frame follows the last, else begun anew. */
#include "passes/weber_foam.h"
#include "scene/classify.h"

/* Whom to go on with cannot be told without ids, in this frame or in the last. */
static ssfr_result begin(const ssfr_run *run, ssfr_weber_foam_state *s)
{
    ssfr_result result = SSFR_OK;
    const bool named = run->frame->particles->id != NULL;
    if (!s->weber) SSFR_TRY(ssfr_weber_create(&s->weber, run->params));
    else if (isnan(run->dt) || !s->named || !named) ssfr_weber_restart(s->weber, run->params);
    s->named = named;
end:
    return result;
}

ssfr_result ssfr_weber_foam_run(const ssfr_run *run)
{
    ssfr_result result = SSFR_OK;
    ssfr_weber_foam_state *s = run->state;
    ssfr_particles particles = *run->frame->particles;
    if (run->values[0]->same || run->values[1]->same) { /* kept in all the same: no Weber number, no foam */
        for (int k = 0; k < 2; k++) memset(run->values_out[k], 0, particles.n * sizeof *run->values_out[k]);
        return SSFR_OK;
    }
    particles.velocity = (float *)run->values[0]->data; /* which are only read */
    particles.density = (float *)run->values[1]->data;
    SSFR_TRY(begin(run, s));
    SSFR_TRY(ssfr_weber_step(s->weber, &particles, isnan(run->dt) ? 0 : run->dt, run->values_out[0],
                             run->values_out[1], NULL));
end:
    return result;
}
