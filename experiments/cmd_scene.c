/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_scene.c: `ssfr scene`: which scenes there are, simulating them, what is in them, converting particle files. */
#include "experiments/cmd_scene.h"
#include "experiments/console.h"
#include "experiments/param_table.h"
#include "experiments/scenes/make.h"
#include "experiments/stage.h"

/* A word without options of its own: false when only help was asked for. */
static ssfr_result parse_plain(int argc, char **argv, const char *help, bool *go_on)
{
    ssfr_command_line line;
    const ssfr_usage usage = {.command = argv[0], .arguments = "", .help = help};
    const ssfr_result result = ssfr_options_parse(&line, &usage, argc, argv);
    *go_on = result == SSFR_OK && !line.help;
    return result;
}

/* ---- list -------------------------------------------------------------------------------------------------------- */

static ssfr_result list_builtin(ssfr_table *table, const ssfr_builtin *builtin)
{
    ssfr_result result = SSFR_OK;
    ssfr_particles *particles = NULL;
    SSFR_TRY(builtin->make(&particles, 1));
    SSFR_TRY(ssfr_table_add(table, "%s", builtin->name));
    for (int scale = 0; scale < 2; scale++) SSFR_TRY(ssfr_table_add(table, "%zu", particles->n));
    SSFR_TRY(builtin->n_frames > 0 ? ssfr_table_add(table, "%d", builtin->n_frames) : ssfr_table_add(table, "-"));
    SSFR_TRY(ssfr_table_add(table, "%s", builtin->help));
end:
    ssfr_particles_destroy(&particles);
    return result;
}

static ssfr_result list_scene(ssfr_table *table, const ssfr_scene_source *source)
{
    ssfr_result result = SSFR_OK;
    ssfr_description *scales[2] = {NULL, NULL};
    for (int scale = 0; scale < 2; scale++)
        SSFR_TRY(ssfr_scene_describe(source, (ssfr_scale)scale, &scales[scale]));
    SSFR_TRY(ssfr_table_add(table, "%s", source->name));
    for (int scale = 0; scale < 2; scale++)
        SSFR_TRY(ssfr_table_add(table, "%zu", scales[scale]->solver.max_particles));
    SSFR_TRY(ssfr_table_add(table, "%d", scales[0]->n_frames));
    SSFR_TRY(ssfr_table_add(table, "%s", scales[0]->title));
end:
    for (int scale = 0; scale < 2; scale++) ssfr_description_destroy(&scales[scale]);
    return result;
}

static ssfr_result list(int argc, char **argv)
{
    static const char *const titles[] = {"SCENE", "PARTICLES", "FULL", "FRAMES", "TITLE"};
    ssfr_result result = SSFR_OK;
    ssfr_table table = {0};
    ssfr_scene_source source;
    bool go_on;
    SSFR_TRY(parse_plain(argc, argv,
                         "Lists what is built in: shapes of one picture, and scenes that are simulated, with the most "
                         "particles that they have at --scale quick, which is the default, and full.",
                         &go_on));
    if (!go_on) goto end;
    ssfr_table_init(&table, SSFR_COUNT(titles));
    SSFR_TRY(ssfr_table_row(&table, titles));
    for (int i = 0; ssfr_builtin_at(i); i++) SSFR_TRY(list_builtin(&table, ssfr_builtin_at(i)));
    for (int i = 0; ssfr_scene_at(i, &source); i++) SSFR_TRY(list_scene(&table, &source));
    ssfr_table_print(&table, stdout);
end:
    ssfr_table_finish(&table);
    return result;
}

/* ---- make -------------------------------------------------------------------------------------------------------- */

typedef struct make_words {
    const char *cache;
    int scale;
    long last;
    bool anew;
} make_words;

#define ROW(...) SSFR_OPTION(make_words, __VA_ARGS__)
static const ssfr_option make_rows[] = {
    ROW(scale, "scale", 0, WORD, "quick|full", "a sixteenth of the paper's particles (default), or all", 0, 0),
    ROW(last, "last", 0, INTEGER, "N", "make frames 0 to N (default: all)", 0, SSFR_MAX_FRAME),
    ROW(anew, "anew", 0, FLAG, NULL, "make frames again that are there", 0, 0),
    ROW(cache, "cache", 0, TEXT, "DIR",
        "where frames are kept (default: ssfr/scenes in $XDG_CACHE_HOME or ~/.cache)", 0, 0),
    SSFR_OPTION_END,
};

static ssfr_result make_scene(const char *scene, const make_words *words, uint64_t seed)
{
    ssfr_result result = SSFR_OK;
    const ssfr_make_options options = {.cache = words->cache, .seed = seed, .last = (int)words->last,
                                       .anew = words->anew};
    ssfr_scene_source source;
    ssfr_description *description = NULL;
    char *folder = NULL;
    SSFR_TRY(ssfr_scene_find(scene, &source));
    if (source.kind != SSFR_SCENE_DESCRIBED) {
        result = ssfr_fail(SSFR_ERR_VALUE, "%s: there is nothing to simulate", scene);
        goto end;
    }
    SSFR_TRY(ssfr_scene_describe(&source, (ssfr_scale)words->scale, &description));
    SSFR_TRY(ssfr_make_folder(description, words->cache, seed, &folder));
    SSFR_TRY(ssfr_make(description, &options));
    printf("%s: %d of %d frames in %s\n", source.name, ssfr_make_count(folder), description->n_frames, folder);
end:
    free(folder);
    ssfr_description_destroy(&description);
    return result;
}

static ssfr_result make(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    make_words words = {.last = -1};
    ssfr_command_line line;
    const ssfr_option_set sets[] = {{"make", make_rows, &words}, {NULL, NULL, NULL}};
    const ssfr_usage usage = {
        .command = argv[0], .arguments = "SCENE", .min_arguments = 1, .max_arguments = 1, .sets = sets,
        .help = "Simulates the frames of a scene that are not there yet. When interrupted, the same command goes on "
                "with the frame that was in progress."};
    SSFR_TRY(ssfr_options_parse(&line, &usage, argc, argv));
    if (!line.help) SSFR_TRY(make_scene(line.arguments.items[0], &words, (uint64_t)line.seed));
end:
    return result;
}

/* ---- what can be written in scene files, and read from others ---------------------------------------------------- */

static ssfr_result add_rows(ssfr_table *table, const char *group, const ssfr_param *rows)
{
    ssfr_result result = SSFR_OK;
    for (; rows->name && result == SSFR_OK; rows++) {
        char key[64];
        snprintf(key, sizeof key, "%s.%s", group, rows->name);
        result = ssfr_param_table_add(table, key, rows, NULL);
    }
    return result;
}

static ssfr_result params(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    ssfr_table table = {0};
    bool go_on;
    SSFR_TRY(parse_plain(argc, argv, "Lists the parameters of the solver and of its foam, as scene files set them.",
                         &go_on));
    if (!go_on) goto end;
    SSFR_TRY(ssfr_param_table_begin(&table));
    SSFR_TRY(add_rows(&table, "solver", ssfr_solver_rows));
    SSFR_TRY(add_rows(&table, "foam", ssfr_foam_rows));
    ssfr_table_print(&table, stdout);
end:
    ssfr_table_finish(&table);
    return result;
}

static ssfr_result formats(int argc, char **argv)
{
    bool go_on;
    const ssfr_result result =
        parse_plain(argc, argv, "Lists the files of particles that are read and written.", &go_on);
    if (result == SSFR_OK && go_on) printf("%s", ssfr_particle_formats());
    return result;
}

/* ---- the words --------------------------------------------------------------------------------------------------- */

static const struct {
    const char *word, *full, *help;
    ssfr_result (*run)(int argc, char **argv);
} words[] = {
    {"list", "scene list", "the scenes that are built in", list},
    {"make", "scene make", "simulate a scene's frames", make},
    {"info", "scene info", "what is in a scene, or in a file of particles", ssfr_scene_info},
    {"import", "scene import", "convert files of particles from any format that is read to any that is written",
     ssfr_scene_import},
    {"formats", "scene formats", "the formats of such files", formats},
    {"params", "scene params", "the parameters of the solver and of its foam", params},
};

static ssfr_result print_help(int argc, char **argv)
{
    ssfr_command_line line;
    char help[640] = "Scenes, simulated or from files; 'ssfr scene WORD --help' says more. WORD is";
    size_t used = strlen(help);
    for (size_t i = 0; i < SSFR_COUNT(words) && used < sizeof help; i++)
        used += (size_t)snprintf(help + used, sizeof help - used, "%s %s (%s)", i ? "," : "", words[i].word,
                                 words[i].help);
    const ssfr_usage usage = {.command = argv[0], .arguments = "list|make|info|import|formats|params ...",
                              .min_arguments = 1, .max_arguments = SSFR_MAX_LIST, .help = help};
    const ssfr_result result = ssfr_options_parse(&line, &usage, argc, argv);
    if (result != SSFR_OK || line.help) return result;
    return ssfr_fail(SSFR_ERR_VALUE, "%s: expected list, make, info, import, formats or params first",
                     line.arguments.items[0]);
}

int ssfr_cmd_scene(int argc, char **argv)
{
    for (size_t i = 0; i < SSFR_COUNT(words) && argc > 1; i++)
        if (strcmp(words[i].word, argv[1]) == 0) {
            char full[24];
            snprintf(full, sizeof full, "%s", words[i].full);
            argv[1] = full;
            return ssfr_exit_status(words[i].run(argc - 1, argv + 1));
        }
    return ssfr_exit_status(print_help(argc, argv));
}
