/* Calibration by runs; see calibrate.h. */
#include "sweeps/engine/calibrate.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/elementary.h"
#include "core/file.h"
#include "params/config.h"
#include "params/settings.h"
#include "stats/stats.h"

/* ---- the file ---- */

static rp_status read_fit(sweep_problem *s, const config_setting_t *fit)
{
    const int n = fit && config_setting_is_group(fit) ? config_setting_length(fit) : 0;
    if (n < 1 || n > STATS_NAMES)
        return fit ? rp_config_fail(fit, "fit: a group of one to %d names, { NAME = [from, to]; } expected",
                                    STATS_NAMES)
                   : rp_fail(RP_BAD_INPUT, "%s: fit: missing (what is to be found)", s->path);
    s->quest.n_names = (size_t)n;
    for (int i = 0; i < n; i++) {
        const config_setting_t *range = element(fit, (size_t)i);
        double ends[2];
        s->name[i] = config_setting_name(range);
        RP_TRY(rp_config_pair(range, ends));
        if (!(ends[1] > ends[0]))
            return rp_config_fail(range, "%s: [%g, %g]: a range from a smaller to a larger number expected",
                                  s->name[i], ends[0], ends[1]);
        s->quest.lo[i] = ends[0], s->quest.hi[i] = ends[1];
    }
    return RP_OK;
}

/* A setting as it is written. */
static rp_status text_of(rp_arena *arena, const config_setting_t *setting, const char **text)
{
    char *written;
    size_t size;
    FILE *out = open_memstream(&written, &size);
    if (!out) return rp_fail(RP_NO_MEMORY, "calibrate: out of memory");
    rp_config_write_value(out, setting);
    fclose(out);
    *text = rp_arena_keep(arena, written, free);
    return RP_OK;
}

/* The group of a number: that of an earlier one of the same runs, or a new one. */
static size_t group_of(sweep_problem *s, const sweep_measured *m, const char *fixed)
{
    const char *kind = *m->experiment ? "experiment"
                       : *m->protocol ? "protocol"
                                      : "runs",
               *source = rp_text(s->arena, "%s%s%s", m->experiment, m->protocol, m->runs);
    for (size_t g = 0; g < s->quest.n_groups; g++)
        if (strcmp(s->group[g].kind, kind) == 0 && strcmp(s->group[g].source, source) == 0 &&
            strcmp(s->group[g].fixed, fixed) == 0)
            return g;
    s->group[s->quest.n_groups] = (sweep_group){.kind = kind, .source = source, .fixed = fixed};
    return s->quest.n_groups++;
}

static rp_status read_measured(sweep_problem *s, const config_setting_t *setting, size_t k)
{
#define AT(field) offsetof(sweep_measured, field)
    static const rp_param schema[] = {
        {"of", "", RP_TEXT, AT(of), NULL, "", "column"},
        {"value", "", RP_REAL, AT(value), NULL, "(-inf, inf)", "measured"},
        {"error", "", RP_REAL, AT(error), NULL, "(0, inf)", "its standard error"},
        {"model_error", "", RP_REAL, AT(model_error), "0", "[0, inf)",
         "of the model, which adds in quadrature"},
        {"experiment", "", RP_TEXT, AT(experiment), "", "", "file"},
        {"protocol", "", RP_TEXT, AT(protocol), "", "", "its name"},
        {"runs", "", RP_TEXT, AT(runs), "", "", "table of another program"},
        {0}};
    sweep_measured *m = &s->number[k];
    const config_setting_t *values = member(setting, "fixed");
    const char *fixed = "";
    if (!config_setting_is_group(setting))
        return rp_config_fail(setting, "measured: a list ( { ... } ) expected");
    rp_params_defaults(schema, RP_CGS, m);
    RP_TRY(rp_config_group(setting, schema, m, "fixed"));
    if ((*m->experiment != 0) + (*m->protocol != 0) + (*m->runs != 0) != 1)
        return rp_config_fail(setting, "measured: one of experiment, protocol and runs expected");
    if (*m->runs && values) return rp_config_fail(values, "fixed: has no effect on a table");
    s->quest.value[k] = m->value;
    s->quest.error[k] = rp_hypot(m->error, m->model_error);
    if (values) RP_TRY(text_of(s->arena, values, &fixed));
    s->quest.group[k] = group_of(s, m, fixed);
    s->quest.fixed_runs |= *m->runs != 0;
    return RP_OK;
}

/* Names of the condition `where`. */
static rp_status find_name(void *host, const char *name, int n_args, rp_x_symbol *symbol, bool *known)
{
    const sweep_problem *s = host;
    for (size_t p = 0; p < s->quest.n_names && n_args < 0; p++)
        if (strcmp(s->name[p], name) == 0)
            *symbol = (rp_x_symbol){.type = RP_X_NUMBER, .key = s->name[p], .id = (int)p}, *known = true;
    return RP_OK;
}

static void list_names(void *host, rp_guess *guess)
{
    const sweep_problem *s = host;
    for (size_t p = 0; p < s->quest.n_names; p++) rp_guess_try(guess, s->name[p]);
}

static double load(void *host, int id, const double args[])
{
    (void)args;
    return (*(const double *const *)host)[id];
}

static bool allowed(void *host, const double x[])
{
    const sweep_problem *s = host;
    const rp_x_values values = {&x, load};
    return rp_expression_value(&s->where, &values, NULL) != 0.0;
}

static rp_status read_where(sweep_problem *s, const config_setting_t *where)
{
    const char *text = config_setting_get_string(where);
    s->names = (rp_x_names){.host = s, .find = find_name, .list = list_names};
    if (!text || rp_expression_read_as(s->arena, text, RP_X_TRUTH, &s->names, &s->where))
        return rp_config_fail(where, "where%s%s: %s", text ? " " : "", text ? text : "",
                              text ? rp_message() : "a condition on the variables expected");
    s->quest.allowed = allowed;
    return RP_OK;
}

static rp_status read_settings(sweep_problem *s, const config_setting_t *root)
{
#undef AT
#define AT(field) offsetof(sweep_problem, field)
    static const rp_param schema[] = {
        {"seed", "", RP_INT, AT(seed), "1", "[0, 2147483647]", "of the runs"},
        {"budget", "", RP_INT, AT(budget), "1000", "[1, 10000000]", "most runs"},
        {0}};
    const config_setting_t *list = member(root, "measured"), *where = member(root, "where");
    rp_params_defaults(schema, RP_CGS, s);
    RP_TRY(rp_config_group(root, schema, s, "fit measured where"));
    RP_TRY(read_fit(s, member(root, "fit")));
    const int n = list && config_setting_is_list(list) ? config_setting_length(list) : 0;
    if (n < 1 || n > STATS_NUMBERS)
        return list ? rp_config_fail(list, "measured: a list ( { ... } ) of 1 to %d numbers expected",
                                     STATS_NUMBERS)
                    : rp_fail(RP_BAD_INPUT, "%s: measured: missing (the measured values)", s->path);
    s->quest.n_numbers = (size_t)n, s->quest.budget = (size_t)s->budget;
    for (int k = 0; k < n; k++) RP_TRY(read_measured(s, element(list, (size_t)k), (size_t)k));
    for (size_t g = 0; g < s->quest.n_groups && s->quest.fixed_runs; g++)
        if (strcmp(s->group[g].kind, "runs") != 0)
            return rp_config_fail(list,
                                  "measured: values from tables and from experiments cannot be combined");
    return where ? read_where(s, where) : RP_OK;
}

/* Is a column of runs one that is fitted, varied or of no meaning? */
static bool is_used(const sweep_problem *s, const char *column)
{
    static const char *const of_none[] = {"run", "replica", "pile", "seed", "seconds"};
    bool used = false;
    for (size_t k = 0; k < s->quest.n_numbers; k++) used |= strcmp(s->number[k].of, column) == 0;
    for (size_t i = 0; i < s->quest.n_names; i++) used |= strcmp(s->name[i], column) == 0;
    for (size_t i = 0; i < sizeof of_none / sizeof *of_none; i++) used |= strcmp(of_none[i], column) == 0;
    return used;
}

static rp_status column_of(const sweep_problem *s, const rp_table *table, size_t k, int *column)
{
    rp_guess guess = rp_guess_of(s->number[k].of);
    *column = rp_table_column(table, s->number[k].of);
    for (size_t c = 0; c < table->n_columns; c++) rp_guess_try(&guess, table->names[c]);
    return *column >= 0 ? rp_table_find(table, s->number[k].of, NULL, column) /* one of them */
                        : rp_fail(RP_BAD_INPUT, "of = \"%s\": the runs have no such column%s",
                                  s->number[k].of, rp_guess_text(&guess));
}

/* ---- numbers of a table ---- */

static void add_run(stats_runs *r, double y)
{
    const double d = y - r->mean;
    r->n++, r->mean += d / r->n, r->squares += d * (y - r->mean);
}

static bool is_result_of(const rp_table *t, size_t row)
{
    const int status = rp_table_column(t, "status");
    return status < 0 || rp_is_result(rp_cell(t, row, status));
}

/* Numbers of a group's table: of point at[row] of n, or for NULL of so many rows a point. */
static rp_status take_numbers(const sweep_problem *s, size_t g, size_t n, const size_t at[], size_t replicas,
                              stats_runs *runs)
{
    const rp_table *t = s->group[g].table;
    for (size_t k = 0; k < s->quest.n_numbers; k++) {
        int column;
        if (s->quest.group[k] != g) continue;
        RP_TRY(column_of(s, t, k, &column));
        for (size_t row = 0; row < t->n_rows && (at || row < n * replicas); row++) {
            double y;
            if (!is_result_of(t, row)) continue;
            RP_TRY(rp_table_number(t, row, column, 1, &y));
            if (isfinite(y)) add_run(&runs[k * n + (at ? at[row] : row / replicas)], y);
        }
    }
    return RP_OK;
}

/* A file that the problem's own names. */
static rp_status beside(const sweep_problem *s, const char *name, const char **path)
{
    const char *slash = *name == '/' ? NULL : strrchr(s->path, '/');
    return rp_path(s->arena, path, "%.*s%s", slash ? (int)(slash - s->path) + 1 : 0, s->path, name);
}

/* Rows of a point are repeats: none of them may be a setting, a column with the same few values at each
 * point. */
static rp_status refuse_settings(const sweep_problem *s, const rp_table *t, const size_t at[])
{
    typedef struct {
        double n, least, most, sum;
    } range;
    RP_SCOPE(arena);
    range *of;
    RP_NEW(&arena, of, s->n_table_points);
    for (size_t c = 0; c < t->n_columns; c++) {
        bool setting = s->n_table_points > 1 && !is_used(s, t->names[c]);
        for (size_t i = 0; i < s->n_table_points; i++) of[i] = (range){0.0, INFINITY, -INFINITY, 0.0};
        for (size_t row = 0; row < t->n_rows && setting; row++) {
            double v;
            if (!is_result_of(t, row)) continue;
            setting = !rp_table_number(t, row, (int)c, 1, &v) && isfinite(v);
            range *r = &of[at[row]];
            if (setting) *r = (range){r->n + 1.0, fmin(r->least, v), fmax(r->most, v), r->sum + v};
        }
        for (size_t i = 0; i < s->n_table_points && setting; i++)
            setting = of[i].least < of[i].most && memcmp(&of[i], of, sizeof *of) == 0;
        if (setting)
            return rp_fail(
                RP_BAD_INPUT,
                "%s: %s is a setting: at every point it goes from %g to %g; fit it too, leave rows "
                "of one value, or call it replica if it only counts",
                t->path, t->names[c], of->least, of->most);
    }
    return RP_OK;
}

/* Rows with equal names are runs of one point. */
static rp_status read_tables(sweep_problem *s)
{
    const size_t p = s->quest.n_names;
    const char *names = s->name[0];
    size_t rows = 0, *at, row_at = 0;
    for (size_t i = 1; i < p; i++) names = rp_text(s->arena, "%s,%s", names, s->name[i]);
    for (size_t g = 0; g < s->quest.n_groups; g++) {
        const char *path;
        RP_TRY(beside(s, s->group[g].source, &path));
        RP_TRY(rp_table_load(s->arena, path, &s->group[g].table));
        rows += s->group[g].table->n_rows;
    }
    RP_NEW(s->arena, s->points, rows * p);
    RP_NEW(s->arena, at, rows);
    for (size_t g = 0; g < s->quest.n_groups; g++) {
        const rp_table *t = s->group[g].table;
        double *v;
        RP_TRY(rp_columns_read(s->arena, t, names, &v));
        for (size_t row = 0; row < t->n_rows; row++, row_at++) {
            double x[STATS_NAMES];
            size_t i = 0;
            for (size_t c = 0; c < p; c++) x[c] = v[c * t->n_rows + row] + 0.0; /* of -0, 0 */
            while (i < s->n_table_points && memcmp(&s->points[i * p], x, p * sizeof *x) != 0) i++;
            if (i == s->n_table_points) memcpy(&s->points[s->n_table_points++ * p], x, p * sizeof *x);
            at[row_at] = i;
        }
    }
    RP_NEW(s->arena, s->runs, s->n_table_points * s->quest.n_numbers);
    for (size_t g = 0; g < s->quest.n_groups; at += s->group[g++].table->n_rows) {
        RP_TRY(refuse_settings(s, s->group[g].table, at));
        RP_TRY(take_numbers(s, g, s->n_table_points, at, 0, s->runs));
    }
    return RP_OK;
}

/* ---- sweeps ---- */

/* The sweep of a group's runs at the points; names that it does not have are left out. */
static rp_status write_sweep(const sweep_problem *s, const sweep_group *g, const char *path, size_t n,
                             const double x[], size_t replicas)
{
    char real[PATH_MAX];
    const char *source = g->source;
    FILE *out;
    if (strcmp(g->kind, "experiment") == 0) {
        RP_TRY(beside(s, g->source, &source));
        if (!realpath(rp_data(s->arena, source), real))
            return rp_fail(RP_BAD_INPUT, "experiment = \"%s\": no such file", source);
        source = real;
    }
    RP_TRY(rp_file_open(path, true, &out));
    fprintf(out, "%s = ", g->kind);
    rp_config_write_text(out, source);
    fprintf(out, ";\nreplicas = %zu;\nseed = %ld;\n", replicas, s->seed);
    if (*g->fixed) fprintf(out, "fixed = %s;\n", g->fixed);
    fputs("zip = true;\ngrid = {\n", out);
    for (size_t p = 0; p < s->quest.n_names; p++) {
        if (!g->has[p]) continue;
        fprintf(out, "  %s = [ ", s->name[p]);
        for (size_t i = 0; i < n; i++) fprintf(out, "%s%.17e", i ? ", " : "", x[i * s->quest.n_names + p]);
        fputs(" ];\n", out);
    }
    fputs("};\n", out);
    return rp_file_close(path, out, RP_OK);
}

/* Which names the group's sweep has, and whether it has the columns, by a file of a run in the middle. */
static rp_status check_group(sweep_problem *s, size_t g, const char *path)
{
    double x[STATS_NAMES];
    rp_table *table;
    int column;
    for (size_t p = 0; p < s->quest.n_names; p++) x[p] = 0.5 * (s->quest.lo[p] + s->quest.hi[p]);
    RP_TRY(write_sweep(s, &s->group[g], path, 1, x, 1));
    for (size_t p = 0; p < s->quest.n_names; p++)
        RP_TRY(sweep_has(path, s->protocols, s->name[p], &s->group[g].has[p]));
    RP_TRY(write_sweep(s, &s->group[g], path, 1, x, 1));
    RP_TRY(sweep_columns(s->arena, path, s->protocols, SWEEP_RUNS, &table));
    for (size_t k = 0; k < s->quest.n_numbers; k++)
        if (s->quest.group[k] == g) RP_TRY(column_of(s, table, k, &column));
    return RP_OK;
}

static rp_status find_names(sweep_problem *s)
{
    char path[] = "/tmp/repose_XXXXXX.cfg";
    const int file = mkstemps(path, 4);
    rp_status status = file >= 0 ? RP_OK : rp_fail(RP_IO, "%s: cannot write", path);
    for (size_t g = 0; g < s->quest.n_groups && !status; g++) status = check_group(s, g, path);
    if (file >= 0) close(file), unlink(path);
    for (size_t p = 0; p < s->quest.n_names && !status; p++) {
        bool found = false;
        for (size_t g = 0; g < s->quest.n_groups; g++) found |= s->group[g].has[p];
        if (!found) status = rp_fail(RP_BAD_INPUT, "fit.%s: no experiment has this name", s->name[p]);
    }
    return status;
}

static rp_status run_group(sweep_problem *s, size_t stage, size_t g, size_t n, const double x[],
                           size_t replicas)
{
    const char *name = rp_text(s->arena, "%s/stage_%zu_%zu", s->folder, stage + 1, g + 1),
               *path = rp_text(s->arena, "%s.cfg", name), *table = rp_text(s->arena, "%s.tsv", name),
               *dir = rp_text(s->arena, "%s/%zu", s->store, g + 1);
    sweep_counts counts;
    FILE *out;
    RP_TRY(write_sweep(s, &s->group[g], path, n, x, replicas));
    RP_TRY(sweep_prepare(path, dir, 0, s->protocols, &counts));
    RP_TRY(s->run(s, stage, s->group[g].source, dir, &counts));
    RP_TRY(rp_file_open(table, true, &out));
    RP_TRY(rp_file_close(table, out, sweep_export(dir, s->protocols, SWEEP_RUNS, s->command, &counts, out)));
    for (size_t w = 0; w < counts.words.n; w++)
        rp_tally_add(&s->words, counts.words.of[w].word, strlen(counts.words.of[w].word),
                     counts.words.of[w].times);
    return rp_table_load(s->arena, table, &s->group[g].table);
}

static rp_status run_stage(void *host, size_t stage, size_t *n, const double **x, const size_t replicas[],
                           stats_runs **runs)
{
    sweep_problem *s = host;
    if (s->quest.fixed_runs) return *n = s->n_table_points, *x = s->points, *runs = s->runs, RP_OK;
    RP_NEW(s->arena, *runs, *n * s->quest.n_numbers);
    for (size_t g = 0; g < s->quest.n_groups; g++) {
        RP_TRY(run_group(s, stage, g, *n, *x, replicas[g]));
        RP_TRY(take_numbers(s, g, *n, NULL, replicas[g], *runs));
    }
    return RP_OK;
}

rp_status sweep_problem_read(sweep_problem *s, const char *text)
{
    char *own = NULL;
    RP_TRY(text ? rp_config_read_text(s->path, text, &s->config) : rp_config_read(s->path, &s->config));
    if (!text) RP_TRY(rp_file_read(s->path, &own));
    if (own) text = rp_arena_keep(s->arena, own, free);
    rp_hash_digits(XXH3_128bits(text, strlen(text)), s->key);
    RP_TRY(read_settings(s, config_root_setting(&s->config)));
    return rp_prefix(s->quest.fixed_runs ? read_tables(s) : find_names(s), "%s: ", s->path);
}

void sweep_problem_free(sweep_problem *problem)
{
    config_destroy(&problem->config);
}

rp_status sweep_problem_solve(sweep_problem *s, const char *folder, const char *store, stats_answer *answer)
{
    s->folder = folder, s->store = store;
    s->quest.host = s, s->quest.run = run_stage, s->quest.leave_out = true;
    return rp_prefix(stats_identify(&s->quest, answer), "%s: ", s->path);
}

/* ---- what the numbers don't tell apart ---- */

const char *sweep_problem_combination(const sweep_problem *s, const stats_answer *a)
{
    const char *text = "";
    for (size_t p = 0; p < s->quest.n_names; p++) {
        const double w = a->weight[p];
        if (w == 0.0) continue;
        const char *sign = !*text ? (w < 0.0 ? "-" : "") : w < 0.0 ? " - " : " + ";
        text = fabs(fabs(w) - 1.0) < 5e-4 ? rp_text(s->arena, "%s%s%s", text, sign, s->name[p])
                                          : rp_text(s->arena, "%s%s%.4g %s", text, sign, fabs(w), s->name[p]);
    }
    return text;
}

/* 1, the names in units of their ranges, and their products of two. */
enum { PARABOLA = 1 + STATS_NAMES + STATS_NAMES * (STATS_NAMES + 1) / 2 };
static size_t parabola(const sweep_problem *s, const double x[], double t[PARABOLA])
{
    const size_t p = s->quest.n_names;
    size_t n = 1;
    t[0] = 1.0;
    for (size_t i = 0; i < p; i++) t[n++] = (x[i] - s->quest.lo[i]) / (s->quest.hi[i] - s->quest.lo[i]);
    for (size_t i = 1; i <= p; i++)
        for (size_t k = i; k <= p; k++) t[n++] = t[i] * t[k];
    return n;
}

/* By how many of its scatters a column differs between the ends of what agrees, by a parabola through the
 * rows; 0 where that may be by chance. */
static double apart_by(const sweep_problem *s, const stats_answer *a, const rp_table *t, int column,
                       const int names[])
{
    RP_SCOPE(arena);
    double c[PARABOLA], covariance[PARABOLA * PARABOLA], from[PARABOLA], to[PARABOLA], sum = 0.0,
                                                                                       variance = 0.0;
    const size_t p = parabola(s, a->ends[0], from);
    double *X = rp_arena_memory(&arena, t->n_rows * p, sizeof *X),
           *y = rp_arena_memory(&arena, t->n_rows, sizeof *y);
    stats_linear fit = {.p = p, .X = X, .y = y, .tolerance = 1e-12, .c = c, .covariance = covariance};
    parabola(s, a->ends[1], to);
    for (size_t row = 0; row < t->n_rows && X && y; row++) {
        double v = NAN, x[STATS_NAMES];
        if (rp_table_number(t, row, column, 1, &v) || !isfinite(v)) continue;
        for (size_t i = 0; i < s->quest.n_names; i++) rp_table_number(t, row, names[i], 1, &x[i]);
        parabola(s, x, &X[fit.n * p]), y[fit.n++] = v;
    }
    if (fit.n < p + 4 || stats_linear_fit(&fit) || !(fit.chi2 > 0.0)) return 0.0;
    for (size_t i = 0; i < p; i++) {
        sum += c[i] * (to[i] - from[i]);
        for (size_t k = 0; k < p; k++)
            variance += (to[i] - from[i]) * covariance[i * p + k] * (to[k] - from[k]);
    }
    const double by = fabs(sum) / sqrt(fit.chi2 / (double)(fit.n - p));
    return by > 2.0 && sum * sum > 4.0 * variance ? by : 0.0;
}

const char *sweep_problem_separator(const sweep_problem *s, const stats_answer *a)
{
    double most = 0.0;
    const char *best = NULL;
    for (size_t g = 0; g < s->quest.n_groups; g++) {
        const rp_table *t = s->group[g].table;
        int names[STATS_NAMES];
        bool whole = t && t->n_rows > 4 * s->quest.n_names && s->group[g].source;
        for (size_t i = 0; i < s->quest.n_names && whole; i++)
            whole = (names[i] = rp_table_column(t, s->name[i])) >= 0;
        for (size_t c = 0; whole && c < t->n_columns; c++) {
            const double by = is_used(s, t->names[c]) ? 0.0 : apart_by(s, a, t, (int)c, names);
            if (!(by > most)) continue;
            most = by;
            best = rp_text(s->arena, "%s of %s (differs by %.2g of its scatter)", t->names[c],
                           s->group[g].source, by);
        }
    }
    return best;
}
