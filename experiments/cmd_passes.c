/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmd_passes.c: `ssfr passes`: the passes and their parameters, from the same rows that set them. */
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
    SSFR_TRY(ssfr_table_row(&table, (const char *[]){"PASS", "SOURCE", "HELP"}));
    for (int i = 0; ssfr_pass_at(i); i++) {
        const ssfr_pass *p = ssfr_pass_at(i);
        SSFR_TRY(ssfr_table_row(&table, (const char *[]){p->name, p->source, p->help}));
    }
    ssfr_table_print(&table, stdout);
end:
    ssfr_table_finish(&table);
    return result;
}

static void print_ports(const char *title, const ssfr_port *ports)
{
    for (const ssfr_port *port = ports; port->name; port++) {
        const ssfr_slot *slot = &ssfr_slots[port->slot];
        printf("%s %s (%s, %s): %s\n", title, port->name, slot->exr, slot->unit, slot->help);
    }
}

static ssfr_result describe(const char *name)
{
    ssfr_result result = SSFR_OK;
    ssfr_table table = {0};
    const ssfr_pass *pass = NULL;
    SSFR_TRY(ssfr_setup_find_pass(&pass, name));
    SSFR_TRY(ssfr_param_table_begin(&table));
    for (const ssfr_param *row = ssfr_pass_params(pass); row && row->name; row++)
        SSFR_TRY(ssfr_param_table_add(&table, row->name, row, NULL));
    printf("%s: %s\nsource: %s\n", name, ssfr_pass_help(pass), ssfr_pass_source(pass));
    print_ports("reads", pass->inputs);
    print_ports("writes", pass->outputs);
    printf("\n");
    ssfr_table_print(&table, stdout);
end:
    ssfr_table_finish(&table);
    return result;
}

int ssfr_cmd_passes(int argc, char **argv)
{
    ssfr_result result = SSFR_OK;
    ssfr_command_line line;
    const ssfr_usage usage = {.command = argv[0], .arguments = "[NAME]", .max_arguments = 1,
                              .help = "Lists the passes, or what one reads, writes and can be set to."};
    SSFR_TRY(ssfr_options_parse(&line, &usage, argc, argv));
    if (line.help) goto end;
    result = line.arguments.n ? describe(line.arguments.items[0]) : list();
end:
    return ssfr_exit_status(result);
}
