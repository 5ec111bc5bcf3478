/* --json: the table that a command prints, as JSON; see cli.h. */
#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"
#include "cli/export.h"

/* Standard output while a command prints into memory (glibc: stdout is a variable). */
static FILE *printed_to;
static char *text;
static size_t size;

rp_status cli_capture(void)
{
    FILE *memory = open_memstream(&text, &size);
    if (!memory) return rp_fail(RP_NO_MEMORY, "--json: out of memory");
    printed_to = stdout;
    stdout = memory;
    return RP_OK;
}

static rp_status print_table(void)
{
    rp_table table;
    rp_status status = rp_table_parse("--json", text, &table);
    text = NULL;
    int *columns = cli_memory(table.n_columns, sizeof *columns);
    for (size_t c = 0; c < table.n_columns; c++) columns[c] = (int)c;
    if (!status) status = cli_export_json(&table, table.n_columns, columns, stdout);
    rp_table_free(&table);
    return status;
}

/* A command that fails has no table, and what is no table is printed as it is. */
rp_status cli_capture_end(rp_status status)
{
    char message[4096];
    const bool whole = rp_table_finish(stdout, "--json") == RP_OK;
    if (status) snprintf(message, sizeof message, "%s", rp_message());
    fclose(stdout);
    stdout = printed_to;
    rp_status printed = RP_OK;
    if (!whole)
        printed = rp_fail(RP_NO_MEMORY, "--json: out of memory");
    else if (status && status != RP_NO_RESULT)
        printed = RP_OK;
    else if (*text == '#' || strchr(text, '\t'))
        printed = print_table();
    else
        fputs(text, stdout);
    free(text), text = NULL;
    return status ? rp_fail(status, "%s", message) : printed;
}
