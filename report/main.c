/* The program `report`: what two papers claim, what our tables say of each claim, and pages of both. */
#include "report/pages.h"

#include <string.h>

#define CLAIMS_OPTIONS(X)                                                                                    \
    REPORT_OPTIONS(X)                                                                                        \
    X(CHOICE, paper, "", "all", "all | lh | li | ours", "claims of one paper")                               \
    X(TEXT, id, "", "all", "", "one claim, with its variants")                                               \
    X(BOOL, variants, "", "false", "",                                                                       \
      "also the claims under other choices that a paper leaves open; the header does not count them")

CLI_OPTIONS(claims, CLAIMS_OPTIONS)

static const char *const papers[] = {"all", "lh", "li", "ours"};

static bool one_alone(const claims_options *o)
{
    return strcmp(o->id, "all") != 0;
}

static bool is_asked_for(const report_claim *c, const claims_options *o)
{
    if (o->paper > 0 && strcmp(papers[o->paper], c->paper) != 0) return false;
    if (one_alone(o)) return strcmp(o->id, c->id) == 0 || strcmp(o->id, c->of) == 0;
    return o->variants || !*c->of;
}

static void print_verdicts(const cli_call *call, const report_claims *all, const report_judged judged[],
                           const claims_options *o)
{
    rp_table_header(
        call->out, call->units,
        "id, paper, place, statement, test, published, samples, answer, ours, n, z, fixed, verdict, "
        "detail, failed");
    for (size_t i = 0; i < all->n; i++) {
        const report_claim *c = &all->claims[i];
        const report_judged *j = &judged[i];
        if (!is_asked_for(c, o)) continue;
        fprintf(call->out, "%s\t%s\t%s\t%s\t%s\t%s\t%g\t%s\t%s\t", c->id, c->paper, cli_cell(c->place),
                c->statement, c->test, cli_cell(report_published(call->arena, c)), c->samples,
                cli_cell(c->answer), cli_cell(j->text));
        fprintf(call->out, "%g\t%.3g\t%s\t%s\t%s\t%s\n", fabs(j->ours.n), j->z, cli_cell(c->fixed), j->word,
                cli_cell(j->note), cli_cell(j->failed));
    }
}

static rp_status print_claims(cli_call *call, const void *values)
{
    const claims_options *o = values;
    report_tables tables = {call->arena, o->tables, NULL};
    report_claims all;
    report_judged *judged;
    const report_claim *one;
    RP_TRY(report_claims_read(tables.arena, o->claims, &all));
    if (one_alone(o)) RP_TRY(report_claims_find(&all, o->id, &one));
    RP_TRY(report_judge(&all, &tables, &judged));
    cli_table(call, call->out);
    for (size_t p = 1; p < N_OF(papers) && !one_alone(o); p++) {
        const char *text = report_count(tables.arena, &all, judged, papers[p]);
        if (*text && (o->paper == 0 || o->paper == (int)p)) rp_table_note(call->out, papers[p], "%s", text);
    }
    print_verdicts(call, &all, judged, o);
    return RP_OK;
}

static const cli_command claims = {
    "claims",
    "print the published claims and their verdicts",
    "[options]",
    "Prints every claim of both papers with its verdict. The header counts the claims with each verdict.\n"
    "  reproduced, not reproduced  result of the claim's test, which is named in\n"
    "                              report/claims.tsv\n"
    "  supported, not supported    the same for our own claims, beyond the papers\n"
    "                              (`ours`)\n"
    "  open                        our error or the error of the paper is too large\n"
    "  no data                     the table with our value has not been made\n"
    "Column `fixed` says whether the test was fixed before the runs, or after a look at some of them. Column "
    "`failed` has the runs without a result at the grid points that the claim reads, the number of all runs "
    "there, their causes, and how the mean changes without them.",
    "report claims --paper lh",
    claims_params,
    .refuses = "A claim that lacks what its test needs; a table without the cells that a claim names.",
    .act = print_claims};

const cli_command *const report_commands[] = {&claims, &report_joint_command, &report_page, NULL};

int main(int argc, char **argv)
{
    static const cli_program report = {"report", "Report",
                                       "compares the claims of two papers with the tables of this repository",
                                       report_commands};
    return cli_main(&report, argc, argv);
}
