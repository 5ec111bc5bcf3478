/* The command `joint`: several published numbers together, against each choice that a paper leaves open. */
#include "report/pages.h"

#include <string.h>

#define JOINT_OPTIONS(X)                                                                                     \
    REPORT_OPTIONS(X)                                                                                        \
    X(TEXT, id, "", "lh-five", "", "claim whose `answer` names the claims with the numbers")                 \
    X(TEXT, table, "", "lh_choices/points", "", "points of a sweep of the choices")                          \
    X(TEXT, column, "", "theta_r3_deg", "", "column that answers")                                           \
    X(TEXT, either, "", "k_n_wall", "", "choice that some numbers have no part in: its first or last value")
CLI_OPTIONS(joint, JOINT_OPTIONS)

/* Points of a sweep, and which of its first n_keys columns the claims set; the others are choices. */
typedef struct {
    const rp_table *table;
    int n_keys;
    bool *set;
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

/* The setting of a claim: its cell's conditions on columns of the table, and for other columns that claims
 * set, what the file of claims says of its paper. */
static rp_status conditions_of(rp_arena *arena, const report_claims *all, const report_claim *c,
                               const joint_points *p, bool rows[])
{
    const char *usual = rp_table_find_note(all->table, rp_text(arena, "at %s", c->paper));
    const report_words words = report_split(arena, usual ? usual : "");
    for (int k = 0; k < p->n_keys; k++) {
        const char *column = p->table->names[k];
        const char *said = condition_on(c, column);
        for (int w = 0; w < words.n && !said && p->set[k]; w++)
            if (is_on(words.word[w], column)) said = words.word[w];
        if (said) RP_TRY(rp_rows_mark(p->table, said, rows));
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
    p.set = rp_arena_memory(arena, (size_t)p.n_keys, sizeof *p.set);
    bool **rows = rp_arena_memory(arena, (size_t)ids.n, sizeof *rows);
    for (int i = 0; i < ids.n; i++) {
        RP_TRY(report_claims_find(&all, ids.word[i], &claims[i]));
        for (int k = 0; k < p.n_keys; k++) p.set[k] |= condition_on(claims[i], p.table->names[k]) != NULL;
    }
    for (int i = 0; i < ids.n; i++) {
        rows[i] = rp_arena_memory(arena, p.table->n_rows, sizeof **rows);
        memset(rows[i], true, p.table->n_rows);
        RP_TRY(conditions_of(arena, &all, claims[i], &p, rows[i]));
    }
    cli_table(call, call->out);
    rp_table_note(call->out, "dof", "%d, with a common shift %d", ids.n, ids.n - 1);
    const char *choices = "", *columns = "";
    for (int k = 0; k < p.n_keys; k++) {
        const char *name = p.table->names[k];
        if (p.set[k] || strcmp(name, o->either) == 0) continue;
        choices = rp_text(arena, "%s%s%s", choices, *choices ? "," : "", name);
        columns = rp_text(arena, "%s%s, ", columns, name);
    }
    RP_TRY(rp_group_rows(arena, p.table, *choices ? choices : "none", '\t', &groups));
    rp_table_header(
        call->out, call->units,
        rp_text(arena, "%s%s [word], chi2, p_value, shift [own], shift_se [own], left, n_least, n_failed",
                columns, o->either));
    for (size_t g = 0; g < groups.n_groups; g++) {
        for (int last = 0; last < 2; last++) {
            stats_number differences[N_OF(claims)];
            double least = INFINITY, failed = 0.0;
            for (int i = 0; i < ids.n; i++) {
                report_cell cell = {p.table, p.table->n_rows, o->column};
                for (size_t r = 0; r < p.table->n_rows; r++)
                    if (rows[i][r] && groups.of_row[r] == g && (last || cell.row == p.table->n_rows))
                        cell.row = r;
                report_number ours = {.tested = {NAN, NAN}, .n = 0.0};
                double lost = 0.0;
                if (cell.row < p.table->n_rows) {
                    RP_TRY(report_cell_number(&cell, &ours));
                    RP_TRY(report_cell_column(&cell, "n_failed", &lost));
                }
                differences[i] = report_difference(ours.tested, claims[i]->number);
                least = fmin(least, ours.n), failed += lost;
            }
            const report_together t = report_joint((size_t)ids.n, differences);
            fprintf(call->out, "%s%s%s\t%.6g\t%.6g\t%.6g\t%.6g\t%.6g\t%g\t%g\n", groups.words[g],
                    *choices ? "\t" : "", last ? "last" : "first", t.chi2, t.p, t.shift.value, t.shift.se,
                    t.left, least, failed);
        }
    }
    return RP_OK;
}

const cli_command report_joint_command = {
    .name = "joint",
    .summary = "published numbers together, for each choice that a paper leaves open",
    .synopsis = "[options]",
    .about = "Each row of the table is a choice that the claims do not set, such as the mass of a grain: "
             "chi^2 of the published numbers, the shift that all have in common, and what it leaves of "
             "chi^2. `n_least`: piles of the setting that has fewest; `n_failed`: runs without a result.",
    .example = "report joint --id lh-five --table lh_choices/points",
    .refuses = "A claim that is no joint one; a table that is not there.",
    .options = joint_params,
    .act = print_joint};
