/* repose stats trend, repose stats size: how a column of a table of runs depends on another. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "stats/stats.h"
#include "cli/cli.h"

#define N_OF(array) (sizeof(array) / sizeof *(array))

enum { SCALE_LINEAR, SCALE_LOG, SCALE_INVERSE };

typedef struct {
    const char *x, *y, *by;
    double from, to, margin, level, power;
    int scale;
    bool pair;
    rp_texts where;
} options;

/* clang-format off */
#define COLUMN_PARAMS(POWER)                                                                                 \
    CLI_TEXT(options, x, NULL, "column of x"), CLI_TEXT(options, y, NULL, "column of y"),                    \
    CLI_BY(options, "none", "groups"), CLI_RANGE(options, "x"),                                              \
    {"power", "", RP_REAL, offsetof(options, power), POWER, "[-10, 10]",                                     \
     "weights x^power: 2 where scatter falls as 1/x"},                                                       \
    CLI_WHERE(options)

#define TABLE_HELP                                                                                           \
    "TABLE (- for standard input): one row per run, as repose sweep export writes. Rows are left out\n"      \
    "and counted (n_left) if a column holds nan, or a status that does not start with ok."
/* clang-format on */

static const rp_param trend_params[] = {
    COLUMN_PARAMS("0"),
    {"scale", "", RP_CHOICE, offsetof(options, scale), "linear", "linear | log",
     "straight line in x, or in log10 x"},
    {"margin", "y", RP_REAL, offsetof(options, margin), "1", "(0, inf)",
     "largest change that counts as none"},
    {"level", "", RP_REAL, offsetof(options, level), "0.05", "(0, 0.5)", "significance level of the tests"},
    {"pair", "", RP_BOOL, offsetof(options, pair), "false", "",
     "compare rows of the same pile (column pile)"},
    {0}};

static const rp_param size_params[] = {COLUMN_PARAMS("2"), {0}};

#define TREND_COLUMNS                                                                                        \
    "n, n_left, n_x, x_from [x], x_to [x], slope [y/x], slope_se [y/x], dof, change [y], change_se [y], "    \
    "change_lo [y], change_hi [y], p_value, p_holm, bend [y/x^2], bend_se [y/x^2], p_bend, "                 \
    "change_lo90 [y], change_hi90 [y], p_margin, pair [y], pair_se [y], p_pairs, verdict"
#define SIZE_COLUMNS                                                                                         \
    "n, n_x, x_from [x], x_to [x], limit [y], limit_se [y], limit_lo [y], limit_hi [y], c [x y], "           \
    "c_se [x y], c_lo [x y], c_hi [x y], p_value, p_holm, p_bend, status"

static bool grouped(const options *o)
{
    return strcmp(o->by, "none") != 0;
}

/* The rows that count, ordered by group. */
typedef struct {
    cli_groups groups; /* of all rows */
    size_t n, n_failed, n_nan, n_outside;
    double *block, *x, *y, *pile; /* in order of the groups; pile is NULL if piles are not compared */
    size_t *first;                /* of the rows of each group; n_groups + 1 of them */
    char x_words[256];            /* what the numbers of x stand for; empty if they are numbers */
} rows;

static void rows_free(rows *r)
{
    cli_groups_free(&r->groups);
    free(r->block);
    free(r->first);
}

static double scaled(int scale, double x)
{
    return scale == SCALE_LOG ? log10(x) : scale == SCALE_INVERSE ? 1.0 / x : x;
}

/* Is this row left out? Count why. x, y and pile are its cells. */
static bool left_out(rows *r, const char *word, double x, double y, double pile, const options *o)
{
    const bool failed = strncmp(word, "ok", 2) != 0, missing = isnan(x) || isnan(y) || isnan(pile);
    const bool outside = x < o->from || x > o->to;
    r->n_failed += failed;
    r->n_nan += !failed && missing;
    r->n_outside += !failed && !missing && outside;
    return failed || missing || outside;
}

/* Cells of the columns x, y, pile, status; status may be -1. */
static rp_status select_rows(const rp_table *t, const double *cells, const int columns[4], const options *o,
                             rows *r)
{
    const size_t n = t->n_rows, n_groups = r->groups.n_groups;
    size_t *group = r->groups.of_row;
    r->block = malloc((3 * n + 1) * sizeof *r->block);
    r->first = calloc(n_groups + 1, sizeof *r->first);
    rp_status status = r->block && r->first ? RP_OK : rp_fail(RP_NO_MEMORY, "trend: out of memory");
    for (size_t i = 0; i < n && !status; i++) {
        const double x = cells[i];
        char **words = t->cells + i * t->n_columns;
        if (left_out(r, columns[3] < 0 ? "ok" : words[columns[3]], x, cells[n + i],
                     o->pair ? cells[2 * n + i] : 0.0, o))
            group[i] = n_groups; /* no group */
        else if (o->scale != SCALE_LINEAR && !(x > 0.0))
            status = rp_fail(RP_BAD_INPUT, "%s:%zu: %s = %g: out of range of this scale, allowed: (0, inf)",
                             t->path, t->lines[i], o->x, x);
    }
    r->x = r->block;
    r->y = r->block + n;
    r->pile = o->pair ? r->block + 2 * n : NULL;
    for (size_t g = 0; g < n_groups && !status; g++) {
        r->first[g] = r->n;
        for (size_t i = 0; i < n; i++) {
            if (group[i] != g) continue;
            r->x[r->n] = scaled(o->scale, cells[i]);
            r->y[r->n] = cells[n + i];
            if (o->pair) r->pile[r->n] = cells[2 * n + i];
            r->n++;
        }
    }
    if (!status) r->first[n_groups] = r->n;
    return status;
}

static rp_status load_rows(const rp_table *t, const options *o, rows *r)
{
    const char *const names[] = {o->x, o->y, o->pair ? "pile" : o->y};
    int columns[4];
    double *cells = NULL;
    rp_status status = cli_find_columns(t, N_OF(names), names, columns);
    columns[3] = rp_table_column(t, "status");
    if (!status) status = cli_group_rows(t, o->by, ',', &r->groups);
    if (!status) status = cli_read_columns(t, 3, columns, 1, &cells);
    if (!status) status = select_rows(t, cells, columns, o, r);
    free(cells);
    return status;
}

/* Back from what the line is straight in. */
static double unscaled(int scale, double u)
{
    return scale == SCALE_LOG ? pow(10.0, u) : scale == SCALE_INVERSE ? 1.0 / u : u;
}

static void print_trend(const stats_trend *t, size_t n_rows, double p_holm, const options *o)
{
    double lo[2], hi[2];
    stats_contrast_interval(&t->change, 0.95, &lo[0], &hi[0]);
    stats_contrast_interval(&t->change, 0.90, &lo[1], &hi[1]);
    CLI_ROW_WORD(isnan(p_holm) ? "no_result" : stats_trend_word(t, p_holm, o->level), (double)t->n,
                 (double)(n_rows - t->n), (double)t->n_x, unscaled(o->scale, t->from),
                 unscaled(o->scale, t->to), t->slope.value, t->slope.se, t->slope.dof, t->change.value,
                 t->change.se, lo[0], hi[0], stats_contrast_p(&t->change), p_holm, t->bend.value, t->bend.se,
                 stats_contrast_p(&t->bend), lo[1], hi[1], t->p_margin, t->pair.value, t->pair.se,
                 t->p_pairs);
}

static void print_size(const stats_trend *t, double p_holm)
{
    double lo[2], hi[2];
    stats_contrast_interval(&t->intercept, 0.95, &lo[0], &hi[0]);
    stats_contrast_interval(&t->slope, 0.95, &lo[1], &hi[1]);
    CLI_ROW_WORD(isnan(p_holm) ? "no_result" : "ok", (double)t->n, (double)t->n_x, 1.0 / t->to, 1.0 / t->from,
                 t->intercept.value, t->intercept.se, lo[0], hi[0], t->slope.value, t->slope.se, lo[1], hi[1],
                 stats_contrast_p(&t->slope), p_holm, stats_contrast_p(&t->bend));
}

static void print_header(const rows *r, const options *o, bool size)
{
    char text[1024];
    snprintf(text, sizeof text, "%s%s%s", grouped(o) ? o->by : "", grouped(o) ? ", " : "",
             size ? SIZE_COLUMNS : TREND_COLUMNS);
    cli_table(stdout, size ? size_params : trend_params, o);
    rp_table_note(stdout, "rows", "%zu used, %zu without result, %zu with nan, %zu outside the range of x",
                  r->n, r->n_failed, r->n_nan, r->n_outside);
    if (*r->x_words) rp_table_note(stdout, "words", "%s", r->x_words);
    rp_table_header(stdout, text);
}

static rp_status fit_groups(const rows *r, const options *o, bool size)
{
    stats_trend *trends = malloc((r->groups.n_groups + 1) * sizeof *trends);
    double *p = malloc((2 * r->groups.n_groups + 1) * sizeof *p);
    rp_status status = trends && p ? RP_OK : rp_fail(RP_NO_MEMORY, "trend: out of memory"), group = RP_OK;
    size_t with_result = 0;
    for (size_t g = 0; g < r->groups.n_groups && !status; g++) {
        const size_t first = r->first[g];
        group = stats_trend_fit(r->first[g + 1] - first, r->x + first, r->y + first,
                                r->pile ? r->pile + first : NULL, size ? -o->power : o->power, o->margin,
                                &trends[g]);
        with_result += group == RP_OK;
        p[g] = group ? NAN : stats_contrast_p(&trends[g].change);
        if (group && group != RP_NO_RESULT)
            status = rp_prefix(group, "%s%s", r->groups.words[g], grouped(o) ? ": " : "");
    }
    if (!status && with_result == 0) status = r->groups.n_groups ? group : rp_fail(RP_NO_RESULT, "no rows");
    if (!status) {
        stats_holm(r->groups.n_groups, p, p + r->groups.n_groups);
        print_header(r, o, size);
    }
    for (size_t g = 0; g < r->groups.n_groups && !status; g++) {
        if (grouped(o)) printf("%s\t", r->groups.words[g]);
        if (size)
            print_size(&trends[g], p[r->groups.n_groups + g]);
        else
            print_trend(&trends[g], r->first[g + 1] - r->first[g], p[r->groups.n_groups + g], o);
    }
    free(trends);
    free(p);
    return status;
}

/* Words in the column of x (an integrator, say) become 0, 1, ... in the order in which they appear. */
static rp_status number_words(rp_table *t, const options *o, char words[256])
{
    static char *const numbers[] = {"0", "1", "2", "3", "4", "5", "6", "7", "8", "9"};
    const char *known[N_OF(numbers)];
    size_t n = 0, used = 0;
    const int column = rp_table_column(t, o->x);
    bool all_numbers = true;
    words[0] = '\0';
    for (size_t i = 0; column >= 0 && i < t->n_rows; i++) {
        char *end;
        strtod(t->cells[i * t->n_columns + (size_t)column], &end);
        all_numbers &= *end == '\0';
    }
    for (size_t i = 0; !all_numbers && i < t->n_rows; i++) {
        char **cell = &t->cells[i * t->n_columns + (size_t)column];
        size_t k = 0;
        while (k < n && strcmp(known[k], *cell) != 0) k++;
        if (k == N_OF(numbers))
            return rp_fail(RP_BAD_INPUT, "%s:%zu: %s = %s: more than %zu different words", t->path,
                           t->lines[i], o->x, *cell, N_OF(numbers));
        if (k == n) {
            known[n++] = *cell;
            if (used < 200)
                used += (size_t)snprintf(words + used, 256 - used, "%s%s = %zu", k ? ", " : "", *cell, k);
        }
        *cell = numbers[k];
    }
    return RP_OK;
}

static rp_status trend_or_size(rp_table *table, const options *o, bool size)
{
    rows r = {0};
    rp_status status = number_words(table, o, r.x_words);
    if (!status) status = load_rows(table, o, &r);
    if (!status) {
        status = fit_groups(&r, o, size);
        if (status) rp_prefix(status, "%s: ", table->path);
    }
    rows_free(&r);
    return status;
}

static rp_status trend_of_table(rp_table *table, const void *values)
{
    const options *o = values;
    if (o->scale == SCALE_LOG && o->power != 0.0)
        return rp_fail(RP_USAGE, "--power weighs with x itself; give --scale log or --power, not both");
    return trend_or_size(table, o, false);
}

static rp_status size_of_table(rp_table *table, const void *values)
{
    options o = *(const options *)values;
    o.scale = SCALE_INVERSE;
    o.margin = 1.0; /* of a test that is not printed */
    return trend_or_size(table, &o, true);
}

const cli_command cmd_stats_trend = {
    "stats trend",
    "does a column of a table of runs depend on another?",
    "TABLE -x COLUMN -y COLUMN [options]",
    "Does y depend on x? Least squares, one row per group. Errors come from the scatter at each x; with\n"
    "--pair, from the slopes of single piles that have a row at every x. Words in column x count as\n"
    "0, 1, ... in the order in which they appear.\n"
    "  change    of the fitted line over the whole range of x; change_lo, change_hi: 95 % interval;\n"
    "            change_lo90, change_hi90: 90 % interval\n"
    "  p_value   of the slope, two-sided, Student's t; p_holm: corrected for the number of groups\n"
    "  bend      coefficient of x^2 in a quadratic fit\n"
    "  p_margin  equivalence test (TOST): chance of a change this small if the true one were the margin\n"
    "  pair      largest difference of the means at two x; p_pairs: largest TOST p over all pairs of x,\n"
    "            a much stricter test\n"
    "  verdict   falls or rises if p_holm < level; no_dependence_within_margin if p_margin < level;\n"
    "            falls_within_margin or rises_within_margin if both; undecided if neither; "
    "no_result\n" TABLE_HELP,
    "repose stats trend build/tables/lh2a_runs.tsv -x H -y theta_r3_deg --by mu",
    trend_params,
    .on_table = trend_of_table};

const cli_command cmd_stats_size = {
    "stats size",
    "limit of infinite size, from a table of runs",
    "TABLE -x COLUMN -y COLUMN [options]",
    "Finite size: y = limit + c/x by least squares, one row a group; errors from the scatter at each x;\n"
    "lo and hi are 95 % intervals (Student). p_value: of c, two-sided; p_holm: corrected for the number\n"
    "of groups; p_bend: of a term in 1/x^2, small where limit + c/x does not describe the "
    "means.\n" TABLE_HELP,
    "repose stats size build/tables/lh2b_runs.tsv -x W -y theta_r3_deg --by mu",
    size_params,
    .on_table = size_of_table};
