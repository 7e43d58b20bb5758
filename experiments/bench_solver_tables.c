/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_solver_tables.c: the columns of the solver's bench, and the charts that are drawn of them. */
#include "experiments/bench_solver.h"

/* ---- columns ----------------------------------------------------------------------------------------------------- */

static const ssfr_column cost_columns[] = {
    {"case", "1", 0, "pool: at rest; dam_break: at its splash"},
    {"particles", "1", 0, "of the fluid"},
    {"threads", "1", 0, "of OpenMP"},
    {"part", "1", 0, "(step): as a whole; then its stages; (foam): a step of diffuse particles beside the fluid"},
    {"diffuse", "1", 0, "diffuse particles"},
    {"status", "1", 0, "ok, or why it failed"},
    {"radius", "m", 0, "of the fluid's particles"},
    {"ms_min", "ms", -1, "shortest time"},
    {"ms_median", "ms", -1, "median time"},
    {"ms_mad", "ms", -1, "median absolute deviation of the time"},
    {"runs", "1", 0, "timed steps"},
    {"outliers", "1", 0, "timed steps whose modified z-score exceeds 3.5"},
    {"share", "1", 0, "median time over that of the step"},
    {"bytes_per_particle", "B", -1, "memory that the solver holds"},
    {"neighbours", "1", 0, "of a particle within the support, on average"},
    {"step", "s", 0, "mean length of the timed steps"},
    {"steps_per_second", "1/s", -1, "steps in a simulated second"},
    {"real_time", "1", 1, "mean length of a step over median time"},
};

static const ssfr_column physics_columns[] = {
    {"case", "1", 0, "pool: at rest from the start; dam_break: the same water, collapsing"},
    {"phase", "1", 0, "rest: all the time; motion: until the wave is back from the wall; settled: the end"},
    {"iterations", "1", 0, "of the density constraint in a step"},
    {"status", "1", 0, "ok, or why it failed"},
    {"particles", "1", 0, "of the fluid"},
    {"radius", "m", 0, "of the particles"},
    {"from", "s", 0, "begin of the phase"},
    {"to", "s", 0, "end of the phase; all is over its moments, 30 a second"},
    {"interior", "1", 0, "share of particles farther than a support from walls and surface: densities are theirs"},
    {"density_mean", "1", 0, "mean deviation of densities from 1000 kg/m^3, relative to it"},
    {"density_rms", "1", -1, "root mean square of the deviations"},
    {"density_max", "1", -1, "largest size of a deviation"},
    {"compression_rms", "1", -1, "root mean square of the deviations, those below 0 as 0"},
    {"compression_max", "1", -1, "largest deviation above 0"},
    {"volume_change", "1", 0, "sum of m/rho over all particles, relative to the start"},
    {"surface_change", "1", 0, "height of the surface, relative to the water's volume over the floor's area"},
    {"centre_change", "1", 0, "twice the height of the centre of mass, relative to the same"},
    {"speed_rms", "m/s", -1, "root mean square of the speeds"},
    {"speed_max", "m/s", -1, "largest speed"},
    {"steps_per_second", "1/s", -1, "steps in a simulated second, over the whole simulation"},
};

static const ssfr_column series_columns[] = {
    {"case", "1", 0, "pool or dam_break"},
    {"iterations", "1", 0, "of the density constraint in a step"},
    {"time", "s", 0, "simulated"},
    {"status", "1", 0, "ok, or why it failed"},
    {"volume_change", "1", 0, "sum of m/rho over all particles, relative to the start"},
    {"surface", "m", 0, "height of the surface: the median over columns two particles wide"},
    {"centre", "m", 0, "height of the centre of mass"},
    {"speed_rms", "m/s", -1, "root mean square of the speeds"},
    {"speed_max", "m/s", -1, "largest speed"},
    {"energy", "J", 0, "kinetic energy, and potential energy over the floor"},
    {"interior", "1", 0, "share of particles farther than a support from walls and surface: densities are theirs"},
    {"density_mean", "1", 0, "mean deviation of densities from 1000 kg/m^3, relative to it"},
    {"density_rms", "1", -1, "root mean square of the deviations"},
    {"density_max", "1", -1, "largest size of a deviation"},
    {"steps", "1", 0, "since the start"},
};

static const ssfr_column fall_columns[] = {
    {"max_step", "s", 0, "length of a step"},
    {"status", "1", 0, "ok, or why it failed"},
    {"steps", "1", 0, "in one second"},
    {"fallen", "m", 0, "how far the drop's centre of mass falls in one second from rest"},
    {"error", "m", -1, "distance from where the exact parabola ends"},
    {"order", "1", 1, "logarithm to the base 2 of the error with twice as long steps over this error"},
};

/* ---- charts ------------------------------------------------------------------------------------------------------ */

/* A cell that is not given is the number of all threads. */
#define EVERY_CASE {{"case", NULL}, {"threads", "threads "}}
#define WHOLE {{"part", "(step)"}}

static const ssfr_panel cost_panels[] = {
    {.title = "Time of a step", .x = "particles", .y = "ms_median", .x_label = "particles",
     .y_label = "median time of a step [ms]", .log_x = true, .log_y = true, .keys = EVERY_CASE, .only = WHOLE,
     .mark = {65536, 60}, .mark_text = "aim: 60 ms for 64 K"},
    {.title = "Against real time", .x = "particles", .y = "real_time", .x_label = "particles",
     .y_label = "simulated over computed time", .log_x = true, .log_y = true, .keys = EVERY_CASE, .only = WHOLE,
     .levels = {1}, .level_text = "as fast as it happens"},
    {.title = "Where the time of the dam break's steps goes", .x = "particles", .y = "share",
     .x_label = "particles", .y_label = "share of the step, all threads [%]", .y_factor = 100, .log_x = true,
     .keys = {{"part", NULL}},
     .only = {{"case", "dam_break"}, {"threads", NULL}, {"diffuse", "0"}, {"part", "predict"}, {"part", "multipliers"},
              {"part", "correct"}, {"part", "arrive"}, {"part", "sort"}, {"part", "list"}, {"part", "density"},
              {"part", "smooth"}}},
    {.title = "Memory", .x = "particles", .y = "bytes_per_particle", .x_label = "particles",
     .y_label = "bytes a particle", .log_x = true, .keys = {{"case", NULL}},
     .only = {{"part", "(step)"}, {"threads", "1"}},
     .levels = {512}, .level_text = "aim: 512"},
};

static const ssfr_panel physics_panels[] = {
    {.title = "Density inside", .x = "iterations", .y = "density_rms",
     .x_label = "iterations a step", .y_label = "RMS deviation from 1000 kg/m^3 [%]", .y_factor = 100,
     .log_x = true, .log_y = true, .keys = {{"case", NULL}, {"phase", NULL}}},
    {.title = "Largest compression inside", .x = "iterations", .y = "compression_max",
     .x_label = "iterations a step", .y_label = "largest density above 1000 kg/m^3 [%]", .y_factor = 100,
     .log_x = true, .log_y = true, .keys = {{"case", NULL}, {"phase", NULL}}},
    {.title = "Volume, as twice the height of the centre of mass", .x = "iterations", .y = "centre_change",
     .x_label = "iterations a step", .y_label = "change [%]", .y_factor = 100,
     .log_x = true, .keys = {{"case", NULL}, {"phase", NULL}}, .only = {{"phase", "rest"}, {"phase", "settled"}},
     .levels = {3, -3}, .level_text = "aim: within 3 %"},
    {.title = "Stillness", .x = "iterations", .y = "speed_rms", .x_label = "iterations a step",
     .y_label = "RMS speed [m/s]", .log_x = true, .log_y = true, .keys = {{"case", NULL}, {"phase", NULL}},
     .only = {{"phase", "rest"}, {"phase", "settled"}}},
};

#define EVERY_COUNT {{"iterations", "iterations "}}

static const ssfr_panel series_panels[] = {
    {.title = "Dam break: volume as the sum of m/rho", .x = "time", .y = "volume_change", .x_label = "time [s]",
     .y_label = "change since the start [%]", .y_factor = 100, .keys = EVERY_COUNT, .only = {{"case", "dam_break"}},
     .levels = {3, -3}, .level_text = "aim: within 3 %"},
    {.title = "Dam break: mean density inside", .x = "time", .y = "density_mean", .x_label = "time [s]",
     .y_label = "deviation from 1000 kg/m^3 [%]", .y_factor = 100, .keys = EVERY_COUNT,
     .only = {{"case", "dam_break"}}},
    {.title = "Dam break: energy over the floor", .x = "time", .y = "energy", .x_label = "time [s]",
     .y_label = "kinetic and potential energy [J]", .keys = EVERY_COUNT, .only = {{"case", "dam_break"}}},
    {.title = "Pool at rest: speeds", .x = "time", .y = "speed_max", .x_label = "time [s]",
     .y_label = "largest speed [m/s]", .log_y = true, .keys = EVERY_COUNT, .only = {{"case", "pool"}}},
};

static const ssfr_panel fall_panels[] = {
    {.title = "A drop falls for one second, 4.905 m", .x = "max_step", .y = "error", .x_label = "length of a step [s]",
     .y_label = "distance from the exact end [m]", .log_x = true, .log_y = true},
};

/* ---- tables ------------------------------------------------------------------------------------------------------ */

const ssfr_bench_layout ssfr_bench_tables[SSFR_N_BENCH_TABLES] = {
#define TABLE(ending, n_keys, name, title) \
    {ending, n_keys, SSFR_COUNT(name##_columns), name##_columns, title, SSFR_COUNT(name##_panels), name##_panels}
    [SSFR_BENCH_COST] = TABLE(".csv", 5, cost, "What the embedded solver costs"),
    [SSFR_BENCH_PHYSICS] = TABLE("_physics.csv", 3, physics, "How well the embedded solver keeps its water"),
    [SSFR_BENCH_SERIES] = TABLE("_series.csv", 3, series, "The embedded solver's water over time"),
    [SSFR_BENCH_FALL] = TABLE("_fall.csv", 1, fall, "Free fall"),
};
