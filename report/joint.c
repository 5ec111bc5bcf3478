/* The command `joint`: several published numbers together, against each choice that a paper leaves open. */
#include "report/pages.h"

#include <string.h>

#define JOINT_OPTIONS(X)                                                                                     \
    REPORT_OPTIONS(X)                                                                                        \
    X(TEXT, id, "", "lh-five", "", "claim whose `answer` names the claims with the numbers")                 \
    X(TEXT, table, "", "lh_ramp/points", "", "table of points of a sweep over the choices")                  \
    X(TEXT, column, "", "theta_r3_deg", "", "column that is compared")
CLI_OPTIONS(joint, JOINT_OPTIONS)

/* Points of a sweep, of whose first n_keys columns some are settings of the paper: `at` says what each is
 * there, unless a claim says it (NULL: a choice, of which the paper says nothing). */
typedef struct {
    const rp_table *table;
    int n_keys;
    const char **at;
} joint_points;

static bool is_on(const char *condition, const char *column)
{
    const size_t n = strcspn(condition, "<>=!");
    return strncmp(condition, column, n) == 0 && !column[n];
}

/* What a claim's cell says of a column; NULL: nothing. */
static const char *condition_on(const report_claim *c, const char *column)
{
    for (size_t i = 0; i < c->answers->n; i++)
        if (is_on(c->answers->conditions[i], column)) return c->answers->conditions[i];
    return NULL;
}

/* What the file of claims says of the settings of a paper. */
static void read_settings(rp_arena *arena, const report_claims *all, const char *paper, joint_points *p)
{
    const char *usual = rp_table_find_note(all->table, rp_text(arena, "at %s", paper));
    const report_words words = report_split(arena, usual ? usual : "");
    p->at = rp_arena_memory(arena, (size_t)p->n_keys, sizeof *p->at);
    for (int w = 0; w < words.n; w++)
        for (int k = 0; k < p->n_keys; k++)
            if (is_on(words.word[w], p->table->names[k])) p->at[k] = words.word[w];
}

/* The rows of the setting of a claim. */
static rp_status mark_setting(const report_claim *c, const joint_points *p, bool rows[])
{
    for (int k = 0; k < p->n_keys; k++) {
        const char *said = p->at[k] ? condition_on(c, p->table->names[k]) : NULL;
        if (p->at[k]) RP_TRY(rp_rows_mark(p->table, said ? said : p->at[k], rows));
    }
    return RP_OK;
}

static rp_status print_joint(cli_call *call, const void *values)
{
    const joint_options *o = values;
    rp_arena *arena = call->arena;
    report_tables tables = {arena, o->tables, NULL};
    report_claims all;
    const report_claim *joint, *claims[16];
    joint_points p;
    rp_groups groups; /* rows of one choice */
    RP_TRY(report_claims_read(arena, o->claims, &all));
    RP_TRY(report_claims_find(&all, o->id, &joint));
    RP_TRY(report_table(&tables, o->table, &p.table));
    if (!p.table) return rp_fail(RP_BAD_INPUT, "%s: no such table in %s", o->table, o->tables);
    const report_words ids = report_split(arena, joint->answer);
    if (joint->kind != CLAIM_JOINT || ids.n > (int)N_OF(claims))
        return rp_fail(RP_BAD_INPUT, "claim %s: a joint one of at most %zu expected", o->id, N_OF(claims));
    for (p.n_keys = 0; !rp_ends_in(p.table->names[p.n_keys], "_mean"); p.n_keys++)
        if ((size_t)p.n_keys + 1 == p.table->n_columns) break;
    read_settings(arena, &all, joint->paper, &p);
    bool **rows = rp_arena_memory(arena, (size_t)ids.n, sizeof *rows);
    for (int i = 0; i < ids.n; i++) {
        RP_TRY(report_claims_find(&all, ids.word[i], &claims[i]));
        rows[i] = rp_arena_memory(arena, p.table->n_rows, sizeof **rows);
        memset(rows[i], true, p.table->n_rows);
        RP_TRY(mark_setting(claims[i], &p, rows[i]));
    }
    cli_table(call, call->out);
    rp_table_note(call->out, "dof", "%d, with a common shift %d", ids.n, ids.n - 1);
    const char *choices = "", *columns = "";
    for (int k = 0; k < p.n_keys; k++) {
        const char *name = p.table->names[k];
        if (p.at[k]) continue;
        choices = rp_text(arena, "%s%s%s", choices, *choices ? "," : "", name);
        columns = rp_text(arena, "%s%s, ", columns, name);
    }
    RP_TRY(rp_group_rows(arena, p.table, *choices ? choices : "none", '\t', &groups));
    rp_table_header(call->out, call->units,
                    rp_text(arena,
                            "%schi2, p_value, shift [own], shift_se [own], left, p_left, n_least, n_failed",
                            columns));
    for (size_t g = 0; g < groups.n_groups; g++) {
        stats_number differences[N_OF(claims)];
        double least = INFINITY, failed = 0.0;
        bool whole = true; /* a choice is told where the table has all of its settings */
        for (int i = 0; i < ids.n; i++) {
            report_cell cell = {p.table, p.table->n_rows, o->column};
            report_number ours = {.tested = {NAN, NAN}, .n = 0.0};
            double lost = 0.0;
            for (size_t r = 0; r < p.table->n_rows; r++)
                if (rows[i][r] && groups.of_row[r] == g) cell.row = r;
            if (cell.row < p.table->n_rows) {
                RP_TRY(report_cell_number(&cell, &ours));
                RP_TRY(report_cell_column(&cell, "n_failed", &lost));
            } else {
                whole = false;
            }
            differences[i] = report_difference(ours.tested, claims[i]->number);
            least = fmin(least, ours.n), failed += lost;
        }
        if (!whole) continue;
        const report_together t = report_joint((size_t)ids.n, differences);
        fprintf(call->out, "%s%s", groups.words[g], *choices ? "\t" : "");
        fprintf(call->out, "%.6g\t%.6g\t%.6g\t%.6g\t%.6g\t%.6g\t%g\t%g\n", t.chi2, t.p, t.shift.value,
                t.shift.se, t.left, t.p_left, least, failed);
    }
    return RP_OK;
}

const cli_command report_joint_command = {
    .name = "joint",
    .summary = "test published numbers jointly, for each choice that a paper leaves open",
    .synopsis = "[options]",
    .about = "Each row of the table is a choice that the claims do not set, such as the mass of a grain. It "
             "has chi^2 of the published numbers, the shift common to all of them, and the chi^2 that "
             "remains after this shift, with its probability. `n_least` is the number of piles of the "
             "setting that has fewest, and `n_failed` the number of runs without a result.",
    .example = "report joint --id lh-five --table lh_ramp/points",
    .refuses = "A claim that is not a joint one; a table that does not exist.",
    .options = joint_params,
    .act = print_joint};
