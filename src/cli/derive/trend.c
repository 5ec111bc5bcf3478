/* repose stats trend, repose stats size: how a column of a table of runs depends on another. */
#include <ctype.h>
#include <string.h>

#include "stats/stats.h"
#include "cli/derive/derive.h"

enum { SCALE_LINEAR, SCALE_LOG, SCALE_INVERSE };

#define COLUMN_OPTIONS(X, POWER)                                                                             \
    X(TEXT, x, "", NULL, "", "column of x")                                                                  \
    X(TEXT, y, "", NULL, "", "column of y")                                                                  \
    CLI_BY(X, "none", "groups")                                                                              \
    CLI_RANGE(X, "x")                                                                                        \
    X(REAL, power, "", POWER, "[-10, 10]", "exponent of the weights x^power: 2 if the scatter falls as 1/x") \
    CLI_WHERE(X)
#define TABLE_HELP                                                                                           \
    "TABLE (- for standard input) has one row for each run, as `repose sweep export` writes it; several "    \
    "tables with the same columns are read as one. A row is left out, and counted in n_left, if a column "   \
    "holds nan or the status does not start with ok."

#define TREND_OPTIONS(X)                                                                                     \
    COLUMN_OPTIONS(X, "0")                                                                                   \
    X(CHOICE, scale, "", "linear", "linear | log", "straight line in x, or in log10 x")                      \
    X(REAL, margin, "y", "1", "(0, inf)", "largest change that counts as none")                              \
    X(REAL, level, "", "0.05", "(0, 0.5)", "significance level of the tests")                                \
    X(BOOL, pair, "", "false", "", "compare rows of the same pile (column pile)")

CLI_OPTIONS(trend, TREND_OPTIONS)

#define SIZE_OPTIONS(X) COLUMN_OPTIONS(X, "2")

CLI_OPTIONS(size, SIZE_OPTIONS)

#define TREND_COLUMNS                                                                                        \
    "n, n_left, n_x, x_from [x], x_to [x], slope [y/x], slope_se [y/x], dof, change [y], change_se [y], "    \
    "change_lo [y], change_hi [y], p_value, p_holm, bend [y/x^2], bend_se [y/x^2], p_bend, "                 \
    "change_lo90 [y], change_hi90 [y], p_margin, pair [y], pair_se [y], p_pairs, " RP_FAILED_COLUMNS         \
    ", verdict"
#define SIZE_COLUMNS                                                                                         \
    "n, n_x, x_from [x], x_to [x], limit [y], limit_se [y], limit_lo [y], limit_hi [y], c [x y], "           \
    "c_se [x y], c_lo [x y], c_hi [x y], p_value, p_holm, p_bend, " RP_FAILED_COLUMNS ", status"

/* The rows that count, with columns x, y and, where piles are compared, pile. */
typedef struct {
    rp_groups groups;
    rp_rows of;
    char x_words[256]; /* what the numbers of x stand for; empty if they are numbers */
} rows;

static rp_status read_rows(rp_arena *arena, const rp_table *t, const trend_options *o, rows *r)
{
    const rp_choice choice = {.range = CLI_RANGE_OF(o), .groups = &r->groups};
    const char *names = rp_text(arena, "%s,%s%s", o->x, o->y, o->pair ? ",pile" : "");
    RP_TRY(rp_one_column("-y", o->y)); /* one x was found */
    RP_TRY(rp_group_rows(arena, t, o->by, '\t', &r->groups));
    RP_TRY(rp_rows_read(arena, t, names, &choice, &r->of));
    for (size_t i = 0; i < r->of.n; i++) {
        double *x = &r->of.column[0][i];
        if ((o->scale != SCALE_LINEAR || o->power != 0.0) && !(*x > 0.0))
            return rp_fail(RP_BAD_INPUT, "%s:%zu: %s = %g: out of range of this scale%s, allowed: (0, inf)",
                           RP_PLACE(t, r->of.row[i]), o->x, *x, o->power != 0.0 ? " or --power" : "");
        *x = o->scale == SCALE_LOG ? log10(*x) : o->scale == SCALE_INVERSE ? 1.0 / *x : *x;
    }
    return RP_OK;
}

/* Back from what the line of a trend is straight in. */
static double unscaled(int scale, double u)
{
    return scale == SCALE_LOG ? pow(10.0, u) : u;
}

static void print_trend(const cli_call *call, const stats_trend *t, size_t n_rows, double p_holm,
                        const trend_options *o, const char *failed)
{
    double lo[2], hi[2];
    stats_contrast_interval(&t->change, 0.95, &lo[0], &hi[0]);
    stats_contrast_interval(&t->change, 0.90, &lo[1], &hi[1]);
    const char *word = isnan(p_holm) ? "no_result" : stats_trend_word(t, p_holm, o->level);
    CLI_ROW_WORD(rp_text(call->arena, "%s\t%s", failed, word), (double)t->n, (double)(n_rows - t->n),
                 (double)t->n_x, unscaled(o->scale, t->from), unscaled(o->scale, t->to), t->slope.value,
                 t->slope.se, t->slope.dof, t->change.value, t->change.se, lo[0], hi[0],
                 stats_contrast_p(&t->change), p_holm, t->bend.value, t->bend.se, stats_contrast_p(&t->bend),
                 lo[1], hi[1], t->p_margin, t->pair.value, t->pair.se, t->p_pairs);
}

static void print_size(const cli_call *call, const stats_trend *t, double p_holm, const char *failed)
{
    double lo[2], hi[2];
    stats_contrast_interval(&t->intercept, 0.95, &lo[0], &hi[0]);
    stats_contrast_interval(&t->slope, 0.95, &lo[1], &hi[1]);
    const double p_bend = stats_contrast_p(&t->bend);
    const char *word = isnan(p_holm) ? "no_result" : p_bend < 0.05 ? "curved" : "ok";
    CLI_ROW_WORD(rp_text(call->arena, "%s\t%s", failed, word), (double)t->n, (double)t->n_x, 1.0 / t->to,
                 1.0 / t->from, t->intercept.value, t->intercept.se, lo[0], hi[0], t->slope.value,
                 t->slope.se, lo[1], hi[1], stats_contrast_p(&t->slope), p_holm, p_bend);
}

/* A trend, or a limit of infinite size, which is the trend in 1/x. */
static rp_status fit_group(const rows *r, size_t g, const trend_options *o, bool size, stats_trend *t)
{
    const size_t first = r->of.first[g];
    return stats_trend_fit(&(stats_sample){.n = r->of.first[g + 1] - first,
                                           .x = r->of.column[0] + first,
                                           .y = r->of.column[1] + first,
                                           .pile = o->pair ? r->of.column[2] + first : NULL,
                                           .power = size ? -o->power : o->power,
                                           .log10_x = o->scale == SCALE_LOG,
                                           .margin = o->margin},
                           t);
}

static rp_status fit_groups(const cli_call *call, const rp_table *t, const rows *r, const trend_options *o,
                            bool size)
{
    const size_t n_groups = r->of.n_groups;
    stats_trend *fits = rp_arena_memory(call->arena, n_groups, sizeof *fits);
    double *p = rp_arena_memory(call->arena, 2 * n_groups, sizeof *p), *p_holm = p + n_groups;
    const char **why = rp_arena_memory(call->arena, n_groups, sizeof *why); /* there is no result */
    rp_status status = RP_OK;
    size_t with_result = 0;
    for (size_t g = 0; g < n_groups; g++) {
        status = fit_group(r, g, o, size, &fits[g]);
        if (status && status != RP_NO_RESULT)
            return rp_prefix(status, "%s%s", r->groups.words[g], *r->groups.words[g] ? ": " : "");
        if (status) why[g] = rp_text(call->arena, "%s", rp_message());
        p[g] = status ? NAN : stats_contrast_p(&fits[g].change);
        with_result += !isnan(p[g]);
    }
    if (with_result == 0)
        return status
                   ? status
                   : rp_fail(RP_NO_RESULT, "no trend: numbers so large or small that their squares overflow");
    stats_holm(n_groups, p, p_holm);
    cli_table(call, call->out);
    rp_table_note(call->out, "rows", "%zu used, %zu without result, %zu with nan, %zu outside the range of x",
                  r->of.n, r->of.n_failed, r->of.n_nan, r->of.n_outside);
    if (*r->x_words) rp_table_note(call->out, "words", "%s", r->x_words);
    for (size_t g = 0; g < n_groups; g++)
        if (why[g]) rp_table_note(call->out, "no_result", "%s: %s", r->groups.words[g], why[g]);
    RP_TRY(rp_header_by(t, o->by, size ? SIZE_COLUMNS : TREND_COLUMNS, call->out));
    for (size_t g = 0; g < n_groups; g++) {
        if (*r->groups.words[g]) fprintf(call->out, "%s\t", r->groups.words[g]);
        const char *failed = rp_failed_text(call->arena, t, &r->groups, g, o->x, CLI_RANGE_OF(o));
        if (size)
            print_size(call, &fits[g], p_holm[g], failed);
        else
            print_trend(call, &fits[g], r->of.first[g + 1] - r->of.first[g], p_holm[g], o, failed);
    }
    return RP_OK;
}

/* Words in the column of x (an integrator, say) become 0, 1, ... in the order in which they appear; among
 * numbers they are an error of the table. */
static rp_status number_words(rp_arena *arena, rp_table *t, const trend_options *o, char words[256])
{
    static char *const numbers[] = {"0", "1", "2", "3", "4", "5", "6", "7", "8", "9"};
    int column;
    size_t used = 0, n = 0;
    rp_groups known;
    RP_TRY(rp_table_find(t, o->x, o->x, &column));
    RP_TRY(rp_group_rows(arena, t, o->x, ',', &known));
    for (size_t k = 0; k < known.n_groups; k++) {
        double number = 0.0;
        const char *word = known.words[k];
        const bool begins = isdigit((unsigned char)word[strspn(word, "+-.")]), /* 0,1 or 5 mm: an error */
            is_number = begins || rp_text_number(word, &number) || strcmp(word, "infinite") == 0;
        if (is_number && !isnan(number)) return RP_OK;
    }
    for (size_t k = 0; k < known.n_groups; k++) {
        double nan;
        if (rp_text_number(known.words[k], &nan)) continue;
        if (n == N_OF(numbers))
            return rp_fail(RP_BAD_INPUT, "%s: %s has more than %zu different words", t->path, o->x, n);
        for (size_t i = 0; i < t->n_rows; i++)
            if (known.of_row[i] == k) t->cells[i * t->n_columns + (size_t)column] = numbers[n];
        if (used < 200)
            used +=
                (size_t)snprintf(words + used, 256 - used, "%s%s = %zu", n ? ", " : "", known.words[k], n);
        n++;
    }
    return RP_OK;
}

static rp_status fit_table(const cli_call *call, rp_table *table, const trend_options *o, bool size)
{
    rows r = {0};
    RP_TRY(number_words(call->arena, table, o, r.x_words));
    RP_TRY(read_rows(call->arena, table, o, &r));
    return rp_prefix(fit_groups(call, table, &r, o, size), "%s: ", table->path);
}

static rp_status trend_of_table(cli_call *call, rp_table *table, const void *values)
{
    return fit_table(call, table, values, false);
}

static rp_status size_of_table(cli_call *call, rp_table *table, const void *values)
{
    const size_options *s = values;
    const trend_options o = {.x = s->x,
                             .y = s->y,
                             .by = s->by,
                             .from = s->from,
                             .to = s->to,
                             .power = s->power,
                             .scale = SCALE_INVERSE,
                             .margin = 1.0}; /* of a test that is not printed */
    return fit_table(call, table, &o, true);
}

const cli_command cmd_stats_trend = {
    "stats trend",
    "does a column of a table of runs depend on another?",
    "TABLE... -x COLUMN -y COLUMN [options]",
    "Tests whether y depends on x, by least squares, with one row for each group. Errors come from the "
    "scatter at each x, which may differ between them, or, if some x has only one row, from the scatter "
    "about the line. With --pair they come from the slopes of single piles that have a row at every x. Words "
    "in column x count as 0, 1, ... in the order of their appearance.\n"
    "  change    change of the fitted line over the whole range of x; change_lo,\n"
    "            change_hi: 95 % interval; change_lo90, change_hi90: 90 % interval\n"
    "  p_value   of the slope, two-sided, Student's t; p_holm: corrected for the\n"
    "            number of groups\n"
    "  bend      coefficient of x^2 in a quadratic fit\n"
    "  p_margin  equivalence test (TOST): probability of a change this small if the\n"
    "            true one were the margin\n"
    "  pair      largest difference of the means at two x; p_pairs: largest TOST p\n"
    "            over all pairs of x, a much stricter test\n"
    "  verdict   falls or rises if p_holm < level; no_dependence_within_margin if\n"
    "            p_margin < level; falls_within_margin or rises_within_margin if\n"
    "            both; undecided if neither; no_result\n" TABLE_HELP,
    "repose stats trend build/tables/lh2a_runs.tsv -x H -y theta_r3_deg --by mu",
    trend_params,
    .refuses = "A number that is not positive with --scale log; more than ten different words in column x, "
               "or one that begins with a digit, or words among numbers.\n"
               "Too few x or rows for a line: exit status 1.",
    .derives = true,
    .on_table = trend_of_table};

const cli_command cmd_stats_size = {
    "stats size",
    "limit of infinite size, from a table of runs",
    "TABLE... -x COLUMN -y COLUMN [options]",
    "Finite size: fits y = limit + c/x by least squares, with one row for each group. Errors come from the "
    "scatter at each x, or, if some x has only one row, from the scatter about the line, taken to be the "
    "same at all x. lo and hi are 95 % intervals (Student). p_value is that of c, two-sided; p_holm is "
    "corrected for the number of groups; p_bend is that of a term in 1/x^2, and small where limit + c/x does "
    "not describe the means. status is ok, curved if p_bend < 0.05, or no_result.\n" TABLE_HELP,
    "repose stats size build/tables/lh2b_runs.tsv -x W -y theta_r3_deg --by mu",
    size_params,
    .refuses = "An x that is not positive.\n"
               "Too few x or rows for a limit: exit status 1.",
    .derives = true,
    .on_table = size_of_table};
