/* SPDX-License-Identifier: GPL-3.0-or-later */
/* play.c: which frames are played, and playing them. */
#include "experiments/play.h"
#include "experiments/console.h"

#define ROW(...) SSFR_OPTION(ssfr_stage_options, __VA_ARGS__)
const ssfr_option ssfr_play_rows[] = {
    ROW(play, "play", 0, TEXT, "N|all|none",
        "how many frames before the drawn one are played for passes that follow particles from frame to frame "
        "(default: as many as what they keep lasts)",
        0, 0),
    SSFR_OPTION_END,
};

enum { BY_HISTORY = -1 };

static ssfr_result parse(const char *text, long *n)
{
    char *end = NULL;
    *n = BY_HISTORY;
    if (!text) return SSFR_OK;
    *n = strcmp(text, "all") == 0 ? SSFR_MAX_FRAME : 0;
    if (*n || strcmp(text, "none") == 0) return SSFR_OK;
    *n = strtol(text, &end, 10);
    if (!*text || text[strspn(text, "0123456789")] || *n > SSFR_MAX_FRAME)
        return ssfr_fail(SSFR_ERR_VALUE, "--play '%s': expected a number of frames, all or none", text);
    return SSFR_OK;
}

ssfr_result ssfr_play_check(const ssfr_stage_options *options)
{
    long n;
    return parse(options->play, &n);
}

/* The first frame to be played of those before the one shown: n of them, or those within `history` (s) and one more,
 * for what lags. */
static long find_first(const ssfr_stage *stage, long n, double history)
{
    if (n == BY_HISTORY && !stage->description) n = stage->frame; /* they are all of one time */
    if (n == BY_HISTORY) n = lround(fmin(ceil(history * stage->description->frame_rate), SSFR_MAX_FRAME - 1)) + 1;
    return stage->frame > n ? stage->frame - n : 0;
}

static ssfr_result play_frame(ssfr_graph *graph, const ssfr_stage *stage, const ssfr_stage_options *options, long frame)
{
    ssfr_result result = SSFR_OK;
    ssfr_particles *fluid = NULL;
    ssfr_scene scene = stage->scene;
    SSFR_TRY(ssfr_stage_read(stage, options, frame, &fluid));
    scene.particles = fluid;
    scene.time = ssfr_stage_time(stage, frame);
    SSFR_TRY(ssfr_graph_advance(graph, &scene));
end:
    ssfr_particles_destroy(&fluid);
    return result;
}

static ssfr_result play_frames(ssfr_graph *graph, const ssfr_stage *stage, const ssfr_stage_options *options,
                               long first)
{
    ssfr_result result = SSFR_OK;
    const long n = stage->frame - first;
    for (long i = 0; i < n && result == SSFR_OK; i++) {
        ssfr_console_progress("play", (size_t)i, (size_t)n);
        result = play_frame(graph, stage, options, first + i);
    }
    if (n > 0) ssfr_console_progress("play", 1, 1);
    return result;
}

ssfr_result ssfr_play(ssfr_graph *graph, const ssfr_stage *stage, const ssfr_stage_options *options, long since)
{
    ssfr_result result = SSFR_OK;
    const double history = ssfr_graph_history(graph, &stage->scene);
    long n;
    SSFR_TRY(parse(options->play, &n));
    if (history < 0 || (n == 0 && since >= 0)) return SSFR_OK;
    const long first = find_first(stage, n, history);
    const bool goes_on = since >= 0 && since + 1 >= first;
    if (!goes_on) ssfr_graph_restart(graph);
    SSFR_TRY(play_frames(graph, stage, options, goes_on ? since + 1 : first));
end:
    return result;
}
