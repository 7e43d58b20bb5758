/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_pipelines.c: `ssfr pipelines`: the pipelines, their nodes, and every key that --set takes. */
#include "experiments/command.h"
#include "experiments/options.h"
#include "experiments/param_table.h"
#include "experiments/setup.h"

#include "graph/graph.h"

static ssfr_result list(void)
{
    ssfr_result result = SSFR_OK;
    ssfr_table table;
    ssfr_table_init(&table, 3);
    SSFR_TRY(ssfr_table_row(&table, (const char *[]){"PIPELINE", "SOURCE", "HELP"}));
    for (int i = 0; ssfr_pipeline_at(i); i++) {
        const ssfr_pipeline *p = ssfr_pipeline_at(i);
        SSFR_TRY(ssfr_table_row(&table, (const char *[]){p->name, p->source, p->help}));
    }
    ssfr_table_print(&table, stdout);
end:
    ssfr_table_finish(&table);
    return result;
}

static ssfr_result print_nodes(const ssfr_pipeline *pipeline)
{
    ssfr_result result = SSFR_OK;
    ssfr_table table;
    ssfr_table_init(&table, 3);
    SSFR_TRY(ssfr_table_row(&table, (const char *[]){"NODE", "PASS", "HELP"}));
    for (const ssfr_node *node = pipeline->nodes; node->name; node++) {
        const ssfr_pass *pass = ssfr_pass_find(node->pass ? node->pass : node->name);
        SSFR_TRY(ssfr_table_row(&table, (const char *[]){node->name, pass->name, pass->help}));
    }
    ssfr_table_print(&table, stdout);
end:
    ssfr_table_finish(&table);
    return result;
}

/* Values are those of a graph as it is made: a pipeline may set its nodes otherwise than a pass' defaults. */
static ssfr_result print_keys(const ssfr_pipeline *pipeline)
{
    ssfr_result result = SSFR_OK;
    ssfr_table table = {0};
    ssfr_graph *graph = NULL;
    SSFR_TRY(ssfr_graph_create(&graph, pipeline, NULL));
    SSFR_TRY(ssfr_param_table_begin(&table));
    for (int i = 0; ssfr_graph_key_at(graph, i); i++) {
        const char *key = ssfr_graph_key_at(graph, i);
        char value[256];
        SSFR_TRY(ssfr_graph_get(graph, key, value, sizeof value));
        SSFR_TRY(ssfr_param_table_add(&table, key, ssfr_graph_row(graph, key), value));
    }
    ssfr_table_print(&table, stdout);
end:
    ssfr_table_finish(&table);
    ssfr_graph_destroy(&graph);
    return result;
}

static ssfr_result describe(const char *name)
{
    ssfr_result result = SSFR_OK;
    const ssfr_pipeline *pipeline = NULL;
    SSFR_TRY(ssfr_setup_find_pipeline(&pipeline, name));
    printf("%s: %s\nsource: %s\nresult: %s\n\n", name, pipeline->help, pipeline->source,
           ssfr_slots[pipeline->result].name);
    SSFR_TRY(print_nodes(pipeline));
    printf("\n");
    SSFR_TRY(print_keys(pipeline));
end:
    return result;
}

int ssfr_cmd_pipelines(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    ssfr_command_line line;
    const ssfr_usage usage = {.command = argv[0], .arguments = "[NAME]", .max_arguments = 1,
                              .help = "Lists the pipelines, or the nodes of one and every key that --set takes."};
    SSFR_TRY(ssfr_options_parse(&line, &usage, argc, argv));
    if (line.help) goto end;
    result = line.arguments.n ? describe(line.arguments.items[0]) : list();
end:
    return ssfr_exit_status(result);
}
