/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_info.c: `ssfr info`: versions, OpenGL, threads: what a bug report or a table of times needs. */
#include "experiments/command.h"
#include "experiments/json.h"
#include "experiments/options.h"
#include "experiments/versions.h"

#include <omp.h>

typedef struct info_options {
    bool json;
} info_options;

static const ssfr_option rows[] = {
    SSFR_OPTION(info_options, json, "json", 0, FLAG, NULL, "as JSON", 0, 0),
    SSFR_OPTION_END,
};

/* gl NULL: there is none. */
static void print_text(const ssfr_gl *gl)
{
    printf("%-12s%s\n%-12s%s\n%-12s%d\n", "ssfr", ssfr_version(), "compiler", __VERSION__, "threads",
           omp_get_max_threads());
    if (gl) {
        printf("%-12s%s\n%-12s%s\n", "GL vendor", ssfr_gl_vendor(gl), "GL renderer", ssfr_gl_renderer(gl));
        printf("%-12s%s\n%-12s%s\n", "GL version", ssfr_gl_version(gl), "GL software",
               ssfr_gl_is_software(gl) ? "yes" : "no");
    } else {
        printf("%-12snone\n", "GL");
    }
    for (int i = 0; ssfr_library_at(i).name; i++)
        printf("%-12s%s\n", ssfr_library_at(i).name, ssfr_library_at(i).version);
}

static void print_json(const ssfr_gl *gl)
{
    ssfr_json json;
    ssfr_json_init(&json, stdout);
    ssfr_json_object(&json, NULL);
    ssfr_json_text(&json, "ssfr", ssfr_version());
    ssfr_json_text(&json, "compiler", __VERSION__);
    ssfr_json_integer(&json, "threads", omp_get_max_threads());
    ssfr_json_object(&json, "gl");
    ssfr_json_text(&json, "vendor", gl ? ssfr_gl_vendor(gl) : NULL);
    ssfr_json_text(&json, "renderer", gl ? ssfr_gl_renderer(gl) : NULL);
    ssfr_json_text(&json, "version", gl ? ssfr_gl_version(gl) : NULL);
    if (gl) ssfr_json_flag(&json, "software", ssfr_gl_is_software(gl));
    ssfr_json_close(&json);
    ssfr_json_object(&json, "libraries");
    for (int i = 0; ssfr_library_at(i).name; i++)
        ssfr_json_text(&json, ssfr_library_at(i).name, ssfr_library_at(i).version);
    ssfr_json_close(&json);
    ssfr_json_close(&json);
}

int ssfr_cmd_info(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    info_options options = {0};
    ssfr_command_line line;
    ssfr_gl *gl = NULL;
    const ssfr_option_set sets[] = {{"info", rows, &options}, {NULL, NULL, NULL}};
    const ssfr_usage usage = {.command = argv[0], .arguments = "", .sets = sets,
                              .help = "Says what runs: versions, OpenGL, threads."};
    SSFR_TRY(ssfr_options_parse(&line, &usage, argc, argv));
    if (line.help) goto end;
    /* A machine without GL has said so in the log; that is an answer here, not a failure. */
    if (ssfr_gl_create(&gl, SSFR_GL_OWN) != SSFR_OK) ssfr_log(SSFR_INFO, "only --backend cpu will work");
    if (options.json)
        print_json(gl);
    else
        print_text(gl);
end:
    ssfr_gl_destroy(&gl);
    return ssfr_exit_status(result);
}
