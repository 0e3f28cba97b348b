// voxcast stability: runs the stability suite for people and for ctest.
#include <stdio.h>
#include <string.h>

#include "server/tool/cli.h"
#include "server/tool/tool_options.h"
#include "server/tool/stability/stability.h"

static const char usage[] =
    "usage: voxcast stability [OPTIONS]\n"
    "\n"
    "Draws small scenes that try to break the numbers, and tells for each case what was measured "
    "and\n"
    "what its bound is. Exit status 1 if a case fails.\n"
    "\n"
    "  --case NAME    only this case\n"
    "  --family NAME  only the cases of this family\n"
    "  --out DIR      write images and results.json there\n"
    "  --list         print the cases; run none\n"
    "  --gpu auto|software|N\n";

static int print_list(void)
{
    for (uint32_t family = 0; family < stability_table_count; family++) {
        const struct stability_table *table = stability_tables[family];
        printf("%s: %s\n", table->name, table->title);
        for (uint32_t i = 0; i < table->count; i++)
            printf("  %-28s %s\n", table->cases[i].name, table->cases[i].invariant);
    }
    return 0;
}

int cli_stability(int argc, char **argv)
{
    struct stability_choice choice = {0};
    bool list = false;
    struct cli_parser parser = {.command = "stability", .usage = usage};
    int status;
    cli_take_text(&parser, "case", &choice.name);
    cli_take_text(&parser, "family", &choice.family);
    cli_take_text(&parser, "out", &choice.folder);
    cli_take_flag(&parser, "list", &list);
    cli_take_gpu(&parser, &choice.gpu);
    if (!cli_parse(&parser, argc, argv, &status))
        return status;
    if (list)
        return print_list();
    struct error error = {""};
    uint32_t failures = 0;
    if (!stability_run_cases(&choice, &failures, &error))
        return cli_fail(CLI_EXIT_USAGE, "%s; see voxcast stability --list", error.message);
    return failures > 0 ? 1 : 0;
}
