/* What a command was called with; see cli.h. */
#include "cli/cli.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

const char *cli_argument(const cli_call *call, int i)
{
    return i < call->n_arguments ? call->arguments[i] : NULL;
}

void *cli_value(const cli_call *call, const char *name)
{
    const rp_param *option = rp_params_find(call->options, name);
    return option ? (char *)call->values + option->offset : NULL;
}

bool cli_given(const cli_call *call, const char *name)
{
    return call->given[rp_params_find(call->options, name) - call->options];
}

/* ---- the table that is printed ---- */

void cli_provenance(const cli_call *call, FILE *out)
{
    rp_table_provenance(out, call->units, call->line);
    if (call->lineage) fputs(call->lineage, out);
}

void cli_table(const cli_call *call, FILE *out)
{
    char text[256];
    cli_provenance(call, out);
    for (const rp_param *p = call->options; p->name; p++)
        if (p->type != RP_TEXT && p->type != RP_TEXTS)
            rp_table_note(out, p->name, "%s%s%s", rp_params_text(p, call->values, text, sizeof text),
                          *p->unit ? " " : "", rp_unit(call->units, p->unit));
}
