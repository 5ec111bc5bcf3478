/* repose stats: derivations of src/cli/derive, and rows of tables. */
#include "cli/derive/derive.h"

/* ---- select ---- */

#define SELECT_OPTIONS(X)                                                                                    \
    X(TEXT, columns, "", "all", "", "columns (a or a,b,...) to print")                                       \
    X(BOOL, bare, "", "false", "", "print the rows without a header")                                        \
    CLI_WHERE(X)

CLI_OPTIONS(select, SELECT_OPTIONS)

static void print_selected_header(const cli_call *call, const rp_table *t, size_t n, const int columns[])
{
    char number[12], unit[32];
    cli_provenance(call, call->out);
    for (size_t c = 0; c < n; c++) {
        rp_column_unit(t, columns[c], unit);
        fprintf(call->out, "%s%s", c ? "\t" : "# units: ", unit);
    }
    for (size_t c = 0; c < n; c++)
        fprintf(call->out, "%c%s", c ? '\t' : '\n', rp_column_name(t, columns[c], number));
    fputc('\n', call->out);
}

static rp_status select_of_table(cli_call *call, rp_table *t, const void *options)
{
    const select_options *o = options;
    int *columns;
    size_t n;
    RP_TRY(rp_columns(call->arena, t, o->columns, &n, &columns));
    if (!o->bare) print_selected_header(call, t, n, columns);
    for (size_t i = 0; i < t->n_rows; i++)
        for (size_t c = 0; c < n; c++)
            fprintf(call->out, "%s%s", rp_cell(t, i, columns[c]), c + 1 < n ? "\t" : "\n");
    return RP_OK;
}

static const cli_command select_rows = {
    "stats select",
    "rows and columns of a table",
    "TABLE... [options]",
    "Prints rows and columns of a table without changing their cells. TABLE is a file, or - for standard "
    "input; several tables with the same columns are read as one.",
    "repose stats select build/tables/li_disorder_runs.tsv --where 'eps<1e-5' --columns disorder,D",
    select_params,
    .refuses = "A column that the table lacks.",
    .on_table = select_of_table};

/* ---- group ---- */

static const cli_command *const commands[] = {CLI_STATS(CLI_ENTRY) & select_rows, NULL};
const cli_command cmd_stats = {"stats", "fits, trends, limits and correlations from tables of runs",
                               .group = commands};
