/* repose calibrate: names of experiments from numbers that were measured. Each stage of the search is a sweep
 * in the folder, which it goes on from. */
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/cli.h"
#include "core/elementary.h"
#include "core/file.h"
#include "core/folder.h"
#include "core/version.h"
#include "params/config.h"
#include "params/expression.h"
#include "params/settings.h"
#include "stats/identify.h"

#define CALIBRATE_OPTIONS(X)                                                                                 \
    X(REAL, theta_r_deg, "deg", "none", "(-90, 90) | none", "measured angle of repose, by method 3")         \
    X(REAL, error_deg, "deg", "none", "(0, 90) | none", "its standard error")                                \
    X(REAL, theta_t_deg, "deg", "none", "[0, 90) | none", "measured tilt at which the pile moves")           \
    X(REAL, theta_t_error_deg, "deg", "none", "(0, 90) | none", "its standard error")                        \
    X(TEXT, o, "", "calibrate", "", "folder of the runs; those that are there are not made again")           \
    X(INT, budget, "", "auto", "[1, 10000000] | auto", "most runs; auto: the file's")                        \
    X(BOOL, dry_run, "", "false", "", "check the file, and say what the first stage needs")                  \
    CLI_FORCE(X)                                                                                             \
    CLI_QUIET(X)                                                                                             \
    CLI_WORKERS(X)

CLI_OPTIONS(calibrate, CALIBRATE_OPTIONS)

/* Runs that give some of the numbers: of an experiment or protocol with values of its own, or of a table. */
typedef struct {
    const char *kind, *source; /* "experiment", "protocol" or "runs", and its name */
    const char *fixed;         /* values, as a sweep's file has them; "": none */
    bool has[STATS_NAMES];     /* it has this name */
    rp_table *table;           /* of the last stage */
} group;

typedef struct {
    const char *of, *experiment, *protocol, *runs;
    double value, error, model_error;
} measured;

typedef struct {
    const cli_call *call;
    const calibrate_options *o;
    const char *path, *folder; /* of the file */
    config_t config;
    stats_quest quest;
    const char *name[STATS_NAMES];
    measured number[STATS_NUMBERS];
    group group[STATS_NUMBERS];
    long seed, budget;
    bool made; /* runs of the last stage, now */
    int lock;  /* of the folder of the runs; 0: none */
    rp_expression where;
    rp_x_names names;
    size_t n_table_points;
    double *points; /* of tables */
    stats_runs *runs;
} problem;

/* ---- the file ---- */

static rp_status read_fit(problem *s, const config_setting_t *fit)
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
static size_t group_of(problem *s, const measured *m, const char *fixed)
{
    const char *kind = *m->experiment ? "experiment"
                       : *m->protocol ? "protocol"
                                      : "runs",
               *source = rp_text(s->call->arena, "%s%s%s", m->experiment, m->protocol, m->runs);
    for (size_t g = 0; g < s->quest.n_groups; g++)
        if (strcmp(s->group[g].kind, kind) == 0 && strcmp(s->group[g].source, source) == 0 &&
            strcmp(s->group[g].fixed, fixed) == 0)
            return g;
    s->group[s->quest.n_groups] = (group){.kind = kind, .source = source, .fixed = fixed};
    return s->quest.n_groups++;
}

static rp_status read_measured(problem *s, const config_setting_t *setting, size_t k)
{
#define AT(field) offsetof(measured, field)
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
    measured *m = &s->number[k];
    const config_setting_t *values = member(setting, "fixed");
    const char *fixed = "";
    if (!config_setting_is_group(setting))
        return rp_config_fail(setting, "measured: a list ( { ... } ) expected");
    rp_params_defaults(schema, RP_CGS, m);
    RP_TRY(rp_config_group(setting, schema, m, "fixed"));
    if ((*m->experiment != 0) + (*m->protocol != 0) + (*m->runs != 0) != 1)
        return rp_config_fail(setting, "measured: one of experiment, protocol and runs expected");
    if (*m->runs && values) return rp_config_fail(values, "fixed: a table is as it is");
    s->quest.value[k] = m->value;
    s->quest.error[k] = rp_hypot(m->error, m->model_error);
    if (values) RP_TRY(text_of(s->call->arena, values, &fixed));
    s->quest.group[k] = group_of(s, m, fixed);
    s->quest.fixed_runs |= *m->runs != 0;
    return RP_OK;
}

/* Names of the condition `where`. */
static rp_status find_name(void *host, const char *name, int n_args, rp_x_symbol *symbol, bool *known)
{
    const problem *s = host;
    for (size_t p = 0; p < s->quest.n_names && n_args < 0; p++)
        if (strcmp(s->name[p], name) == 0)
            *symbol = (rp_x_symbol){.type = RP_X_NUMBER, .key = s->name[p], .id = (int)p}, *known = true;
    return RP_OK;
}

static void list_names(void *host, rp_guess *guess)
{
    const problem *s = host;
    for (size_t p = 0; p < s->quest.n_names; p++) rp_guess_try(guess, s->name[p]);
}

static double load(void *host, int id, const double args[])
{
    (void)args;
    return (*(const double *const *)host)[id];
}

static bool allowed(void *host, const double x[])
{
    const problem *s = host;
    const rp_x_values values = {&x, load};
    return rp_expression_value(&s->where, &values, NULL) != 0.0;
}

static rp_status read_file(problem *s)
{
#undef AT
#define AT(field) offsetof(problem, field)
    static const rp_param schema[] = {
        {"seed", "", RP_INT, AT(seed), "1", "[0, 2147483647]", "of the runs"},
        {"budget", "", RP_INT, AT(budget), "1000", "[1, 10000000]", "most runs"},
        {0}};
    static const char *const of_measured[] = {"experiment", "protocol",    "of",   "value", "error",
                                              "fixed",      "model_error", "runs", NULL};
    RP_TRY(rp_config_read(s->path, &s->config));
    const config_setting_t *root = config_root_setting(&s->config), *list = member(root, "measured"),
                           *where = member(root, "where");
    rp_params_defaults(schema, RP_CGS, s);
    for (const char *const *key = of_measured; *key; key++)
        if (member(root, *key))
            return rp_config_fail(member(root, *key), "%s: belongs to an entry of measured", *key);
    RP_TRY(rp_config_group(root, schema, s, "fit measured where"));
    RP_TRY(read_fit(s, member(root, "fit")));
    const int n = list && config_setting_is_list(list) ? config_setting_length(list) : 0;
    if (n < 1 || n > STATS_NUMBERS)
        return list ? rp_config_fail(list, "measured: a list ( { ... } ) of 1 to %d numbers expected",
                                     STATS_NUMBERS)
                    : rp_fail(RP_BAD_INPUT, "%s: measured: missing (the numbers)", s->path);
    s->quest.n_numbers = (size_t)n;
    for (int k = 0; k < n; k++) RP_TRY(read_measured(s, element(list, (size_t)k), (size_t)k));
    for (size_t g = 0; g < s->quest.n_groups && s->quest.fixed_runs; g++)
        if (strcmp(s->group[g].kind, "runs") != 0)
            return rp_config_fail(list, "measured: numbers of tables and of experiments don't go together");
    s->quest.budget = (size_t)(s->o->budget > 0 ? s->o->budget : s->budget);
    if (!where) return RP_OK;
    const char *text = config_setting_get_string(where);
    s->names = (rp_x_names){.host = s, .find = find_name, .list = list_names};
    if (!text || rp_expression_read_as(s->call->arena, text, RP_X_TRUTH, &s->names, &s->where))
        return rp_config_fail(where, "where%s%s: %s", text ? " " : "", text ? text : "",
                              text ? rp_message() : "a condition of the names expected");
    s->quest.allowed = allowed;
    return RP_OK;
}

/* ---- stages ---- */

/* A file that the problem's own names. */
static rp_status beside(const problem *s, const char *name, const char **path)
{
    return rp_path(s->call->arena, path, "%s%s", *name == '/' ? "" : s->folder, name);
}

/* What a file is to hold: one that is there, as after a stop, and has other words is a person's. */
static rp_status write_once(const char *path, const char *text, bool force)
{
    FILE *out;
    if (!force && access(path, F_OK) == 0) {
        char *there;
        const rp_status read = rp_file_read(path, &there);
        const bool same = !read && strcmp(there, text) == 0;
        free(there);
        if (read || same) return read;
        return rp_fail(RP_BAD_INPUT, "%s: not what this problem asks for; give another folder, or --force",
                       path);
    }
    RP_TRY(rp_file_open(path, true, &out));
    fputs(text, out);
    return rp_file_close(path, out, RP_OK);
}

/* The sweep of a group's runs at the points; names that it does not have are left out. */
static rp_status write_sweep(const problem *s, const group *g, const char *path, size_t n, const double x[],
                             size_t replicas, bool force)
{
    char real[PATH_MAX], *text;
    size_t size;
    const char *source = g->source;
    if (strcmp(g->kind, "experiment") == 0) {
        RP_TRY(beside(s, g->source, &source));
        if (!realpath(cli_data(s->call->arena, source), real))
            return rp_fail(RP_BAD_INPUT, "%s: experiment = \"%s\": no such file", s->path, source);
        source = real;
    }
    FILE *out = open_memstream(&text, &size);
    if (!out) return rp_fail(RP_NO_MEMORY, "calibrate: out of memory");
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
    fclose(out);
    return write_once(path, rp_arena_keep(s->call->arena, text, free), force);
}

static rp_status column_of(const problem *s, const rp_table *table, size_t k, int *column)
{
    rp_guess guess = rp_guess_of(s->number[k].of);
    *column = rp_table_column(table, s->number[k].of);
    for (size_t c = 0; c < table->n_columns; c++) rp_guess_try(&guess, table->names[c]);
    return *column >= 0 ? rp_table_find(table, s->number[k].of, NULL, column) /* one of them */
                        : rp_fail(RP_BAD_INPUT, "of = \"%s\": the runs have no such column%s",
                                  s->number[k].of, rp_guess_text(&guess));
}

/* The file or folder of a group's sweep in a stage, from 0. */
static const char *sweep_path(const problem *s, size_t stage, size_t g, const char *ending)
{
    return rp_text(s->call->arena, "%s/stage_%zu_%zu%s", s->o->o, stage + 1, g + 1, ending);
}

/* The names that the sweep of each group may have, tried one by one in a file that stays where one fails. */
static rp_status find_names(problem *s)
{
    double x[STATS_NAMES];
    bool found[STATS_NAMES] = {false};
    const char *path;
    for (size_t p = 0; p < s->quest.n_names; p++) x[p] = 0.5 * (s->quest.lo[p] + s->quest.hi[p]);
    RP_TRY(rp_make_directory(s->o->o));
    RP_TRY(rp_folder_lock(s->o->o, &s->lock));
    RP_TRY(rp_path(s->call->arena, &path, "%s/try.cfg", s->o->o));
    for (size_t i = 0; i < s->quest.n_groups * s->quest.n_names; i++) {
        const size_t g = i / s->quest.n_names, p = i % s->quest.n_names;
        group one = {.kind = s->group[g].kind, .source = s->group[g].source, .fixed = s->group[g].fixed};
        rp_table *table;
        int column;
        RP_TRY(write_sweep(s, &one, path, 1, x, 1, true));
        rp_status status = sweep_has(path, sweep_protocols, s->name[p], &one.has[p]);
        if (!status && !one.has[p]) continue;
        if (!status) status = write_sweep(s, &one, path, 1, x, 1, true);
        if (!status) status = cli_sweep_table(s->call, path, SWEEP_RUNS, &table, NULL);
        RP_TRY(rp_prefix(status, "%s: fit.%s: ", s->path, s->name[p]));
        s->group[g].has[p] = found[p] = true;
        for (size_t k = 0; k < s->quest.n_numbers; k++)
            if (s->quest.group[k] == g) RP_TRY(rp_prefix(column_of(s, table, k, &column), "%s: ", s->path));
    }
    unlink(path);
    for (size_t p = 0; p < s->quest.n_names; p++)
        if (!found[p])
            return rp_fail(RP_BAD_INPUT, "%s: fit.%s: no experiment has this name", s->path, s->name[p]);
    return RP_OK;
}

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
static rp_status take_numbers(const problem *s, size_t g, size_t n, const size_t at[], size_t replicas,
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

static rp_status run_group(problem *s, size_t stage, size_t g, size_t n, const double x[], size_t replicas)
{
    const char *path = sweep_path(s, stage, g, ".cfg"), *dir = sweep_path(s, stage, g, "");
    sweep_counts counts;
    RP_TRY(write_sweep(s, &s->group[g], path, n, x, replicas, s->o->force));
    RP_TRY(cli_claim_sweep(dir, path, s->o->force));
    RP_TRY(sweep_prepare(path, dir, 0, sweep_protocols, &counts));
    s->made |= counts.stored < counts.planned;
    if (!s->o->quiet && counts.stored < counts.planned)
        fprintf(stderr, "repose calibrate: stage %zu, %s: %zu points, %zu runs each, in %s\n", stage + 1,
                s->group[g].source, n, replicas, dir);
    RP_TRY(cli_sweep_run(dir, (sweep_options){.workers = (int)s->o->j, .snapshot = CLI_SNAPSHOT}, s->o->quiet,
                         &counts));
    return cli_sweep_table(s->call, dir, SWEEP_RUNS, &s->group[g].table, &counts);
}

static rp_status run_stage(void *host, size_t stage, size_t *n, const double **x, const size_t replicas[],
                           stats_runs **runs)
{
    problem *s = host;
    if (s->quest.fixed_runs) return *n = s->n_table_points, *x = s->points, *runs = s->runs, RP_OK;
    s->made = false;
    RP_NEW(s->call->arena, *runs, *n * s->quest.n_numbers);
    for (size_t g = 0; g < s->quest.n_groups; g++) {
        RP_TRY(run_group(s, stage, g, *n, *x, replicas[g]));
        RP_TRY(take_numbers(s, g, *n, NULL, replicas[g], *runs));
    }
    return RP_OK;
}

/* Is a column of runs one that is fitted, varied or of no meaning? */
static bool is_used(const problem *s, const char *column)
{
    static const char *const of_none[] = {"run", "replica", "pile", "seed", "seconds"};
    bool used = false;
    for (size_t k = 0; k < s->quest.n_numbers; k++) used |= strcmp(s->number[k].of, column) == 0;
    for (size_t i = 0; i < s->quest.n_names; i++) used |= strcmp(s->name[i], column) == 0;
    for (size_t i = 0; i < N_OF(of_none); i++) used |= strcmp(of_none[i], column) == 0;
    return used;
}

/* Rows of a point are repeats: none of them may be a setting, a column with the same few values at each
 * point. */
static rp_status refuse_settings(const problem *s, const rp_table *t, const size_t at[])
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

/* Points and numbers of tables: rows with equal names are runs of one point. */
static rp_status read_tables(problem *s)
{
    const size_t p = s->quest.n_names;
    const char *names = s->name[0];
    size_t rows = 0, *at, row_at = 0;
    for (size_t i = 1; i < p; i++) names = rp_text(s->call->arena, "%s,%s", names, s->name[i]);
    for (size_t g = 0; g < s->quest.n_groups; g++) {
        const char *path;
        RP_TRY(beside(s, s->group[g].source, &path));
        RP_TRY(rp_table_load(s->call->arena, path, &s->group[g].table));
        rows += s->group[g].table->n_rows;
    }
    RP_NEW(s->call->arena, s->points, rows * p);
    RP_NEW(s->call->arena, at, rows);
    for (size_t g = 0; g < s->quest.n_groups; g++) {
        const rp_table *t = s->group[g].table;
        double *v;
        RP_TRY(rp_columns_read(s->call->arena, t, names, &v));
        for (size_t row = 0; row < t->n_rows; row++, row_at++) {
            double x[STATS_NAMES];
            size_t i = 0;
            for (size_t c = 0; c < p; c++) x[c] = v[c * t->n_rows + row] + 0.0; /* of -0, 0 */
            while (i < s->n_table_points && memcmp(&s->points[i * p], x, p * sizeof *x) != 0) i++;
            if (i == s->n_table_points) memcpy(&s->points[s->n_table_points++ * p], x, p * sizeof *x);
            at[row_at] = i;
        }
    }
    RP_NEW(s->call->arena, s->runs, s->n_table_points * s->quest.n_numbers);
    for (size_t g = 0; g < s->quest.n_groups; at += s->group[g++].table->n_rows) {
        RP_TRY(refuse_settings(s, s->group[g].table, at));
        RP_TRY(take_numbers(s, g, s->n_table_points, at, 0, s->runs));
    }
    return RP_OK;
}

/* ---- the answer ---- */

/* "mu + 1.9 mu_roll" */
static const char *combination(const problem *s, const stats_answer *a)
{
    const char *text = "";
    for (size_t p = 0; p < s->quest.n_names; p++) {
        const double w = a->weight[p];
        if (w == 0.0) continue;
        const char *sign = !*text ? (w < 0.0 ? "-" : "") : w < 0.0 ? " - " : " + ";
        text = fabs(fabs(w) - 1.0) < 5e-4
                   ? rp_text(s->call->arena, "%s%s%s", text, sign, s->name[p])
                   : rp_text(s->call->arena, "%s%s%.4g %s", text, sign, fabs(w), s->name[p]);
    }
    return text;
}

/* 1, the names in units of their ranges, and their products of two. */
enum { PARABOLA = 1 + STATS_NAMES + STATS_NAMES * (STATS_NAMES + 1) / 2 };
static size_t parabola(const problem *s, const double x[], double t[PARABOLA])
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
static double apart_by(const problem *s, const stats_answer *a, const rp_table *t, int column,
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

/* Of the numbers that the runs give besides, the one that differs most along what agrees, beside its scatter,
 * in the last stage; NULL: none stands out. */
static const char *separator(const problem *s, const stats_answer *a)
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
            best = rp_text(s->call->arena, "%s of %s (differs by %.2g of its scatter)", t->names[c],
                           s->group[g].source, by);
        }
    }
    return best;
}

/* "; determined is mu + 1.9 mu_roll = 0.5 +- 0.01; best to separate the names: width of FILE" */
static const char *apart(const problem *s, const stats_answer *a)
{
    const char *other = separator(s, a),
               *sum = a->determined ? rp_text(s->call->arena, "; determined is %s = %.5g +- %.2g",
                                              combination(s, a), a->sum, a->sum_error)
                                    : "";
    return rp_text(s->call->arena, "%s; %s%s", sum,
                   other ? "best to separate the names: "
                         : "no other number of these runs separates the names",
                   other ? other : "");
}

/* Is it the names that the numbers can't tell, rather than their range? */
static bool is_unseparated(const problem *s, stats_identified status)
{
    return s->quest.n_names > 1 &&
           (status == STATS_IDENTIFIED_NOT_IDENTIFIED || status == STATS_IDENTIFIED_SEVERAL ||
            status == STATS_IDENTIFIED_BUDGET || status == STATS_IDENTIFIED_BENT);
}

/* "repose calibrate: after stage 1: mu 0.2 to 0.4", after runs that were made now. */
static void tell(void *host, const stats_answer *a)
{
    const problem *s = host;
    bool unseparated = false;
    if (s->o->quiet || !s->made) return;
    fprintf(stderr, "repose calibrate: after stage %zu:", a->stages);
    for (size_t p = 0; p < s->quest.n_names; p++) {
        const size_t n = a->n_intervals[p];
        const stats_identified status = a->status[p];
        unseparated |= is_unseparated(s, status) && status != STATS_IDENTIFIED_BUDGET;
        fprintf(stderr, "%s %s ", p ? "," : "", s->name[p]);
        if (n > 0) fprintf(stderr, "%.3g to %.3g", a->interval[p][0].lower, a->interval[p][n - 1].upper);
        if (status != STATS_IDENTIFIED_BUDGET)
            fprintf(stderr, "%s%s", n > 0 ? ", " : "", stats_identified_words[status]);
    }
    fprintf(stderr, "%s\n", unseparated ? apart(s, a) : "");
}

/* How many runs of all stages ended by which word other than ok. */
static void print_failed(const problem *s, size_t stages)
{
    rp_tally all = {0};
    char text[1024];
    for (size_t k = 0; k < stages * s->quest.n_groups; k++) {
        const char *dir = sweep_path(s, k / s->quest.n_groups, k % s->quest.n_groups, "");
        sweep_counts one;
        if (!rp_is_in(dir, "store.sqlite") || sweep_status(dir, sweep_protocols, &one)) continue;
        for (size_t w = 0; w < one.words.n; w++)
            rp_tally_add(&all, one.words.of[w].word, strlen(one.words.of[w].word), one.words.of[w].times);
    }
    if (*sweep_words(&all, sweep_is_failed, text))
        rp_table_note(s->call->out, "failed", "%s: the numbers are of the other runs", text);
}

/* "p <= 0.5, q >= 0.1": ends that the ranges have lost; "" without. */
static const char *cut_ends(const problem *s, const stats_answer *a)
{
    const char *text = "";
    for (size_t p = 0; p < 2 * s->quest.n_names; p++) {
        const double end = p % 2 ? a->hi[p / 2] : a->lo[p / 2];
        if (end != (p % 2 ? s->quest.hi : s->quest.lo)[p / 2])
            text = rp_text(s->call->arena, "%s%s%s %s %.4g", text, *text ? ", " : "", s->name[p / 2],
                           p % 2 ? "<=" : ">=", end);
    }
    return text;
}

static void print_answer(const problem *s, const stats_answer *a)
{
    const cli_call *call = s->call;
    const bool bent = a->status[0] == STATS_IDENTIFIED_BENT;
    cli_provenance(call, call->out);
    rp_table_note(call->out, "runs", "%zu at %zu points, %zu of them without some number, %s", a->n_runs,
                  a->n_points, a->n_failed,
                  !s->quest.fixed_runs ? rp_text(call->arena, "in %zu stages", a->stages)
                  : a->n_repeated > 0  ? rp_text(call->arena, "%zu repeated", a->n_repeated)
                                      : "none repeated: nothing tells scatter from a form that does not fit");
    print_failed(s, a->stages);
    if (*cut_ends(s, a))
        rp_table_note(call->out, "range", "%s: only there the runs have all numbers", cut_ends(s, a));
    rp_table_note(call->out, "chi2", "%.3g over %zu", a->chi2, a->dof);
    for (size_t k = 0; k < s->quest.n_numbers; k++) {
        const measured *m = &s->number[k];
        const double d = (m->value - a->fitted[k]) / rp_hypot(s->quest.error[k], a->fit_error[k]);
        rp_table_note(call->out, m->of, "measured %.6g +- %.3g%s; form p = %s; runs reach %.6g to %.6g",
                      m->value, s->quest.error[k],
                      bent ? ""
                           : rp_text(call->arena, ", fitted %.6g +- %.3g, residual %.2g", a->fitted[k],
                                     a->fit_error[k], d),
                      isnan(a->p_value[k]) ? "not known" : rp_text(call->arena, "%.2g", a->p_value[k]),
                      a->reach[k][0], a->reach[k][1]);
    }
    for (size_t p = 1; p < s->quest.n_names && !bent; p++)
        for (size_t q = 0; q < p; q++)
            rp_table_note(call->out, "correlation", "%s and %s: %.2f", s->name[q], s->name[p],
                          a->correlation[q][p]);
    if (s->quest.n_names > 1)
        rp_table_note(call->out, "determined", "%s",
                      a->determined
                          ? rp_text(call->arena, "%s = %.5g +- %.2g", combination(s, a), a->sum, a->sum_error)
                      : bent ? "not told where the runs bend too much"
                             : "not told where the best values lie at an end of their range, or what "
                               "agrees bends");
    rp_table_note(call->out, "left out", "%zu of %zu points are found again by the others", a->recovered,
                  a->tried);
    rp_table_note(call->out, "holds for", "the experiments that ran, and no other model");
    rp_table_header(call->out, call->units, "parameter, value, se, lower, upper, status");
    for (size_t p = 0; p < s->quest.n_names; p++) {
        const size_t n = a->n_intervals[p];
        for (size_t k = 0; k == 0 || k < n; k++) {
            const stats_interval *i = n > 1 ? &a->interval[p][k] : &a->own[p];
            fprintf(call->out, "%s\t", s->name[p]);
            CLI_ROW_WORD(stats_identified_words[a->status[p]], n > 1 ? i->value : a->x[p], a->se[p], i->lower,
                         i->upper);
        }
    }
}

/* A name that is not found, with what is known of it. */
static rp_status conclude(const problem *s, const stats_answer *a)
{
    size_t p = 0;
    while (p < s->quest.n_names && a->status[p] != STATS_IDENTIFIED_NOT_IDENTIFIED) p++;
    if (p == s->quest.n_names)
        for (p = 0; p < s->quest.n_names && a->status[p] == STATS_IDENTIFIED_OK;) p++;
    if (p == s->quest.n_names) return RP_OK;
    const stats_identified status = a->status[p];
    const char *more = "";
    if (is_unseparated(s, status)) more = apart(s, a);
    if (status == STATS_IDENTIFIED_ABOVE_RANGE || status == STATS_IDENTIFIED_BELOW_RANGE)
        more = rp_text(s->call->arena, "; the runs reach %.3g to %.3g, for %g <= %s <= %g", a->reach[0][0],
                       a->reach[0][1], a->lo[0], s->name[0], a->hi[0]);
    if (*cut_ends(s, a))
        more = rp_text(s->call->arena, "%s; the runs have all numbers only for %s", more, cut_ends(s, a));
    if (a->n_next > 0)
        more =
            rp_text(s->call->arena, "%s; %zu of %zu runs, and the next stage needs %zu: --budget gives more",
                    more, a->n_runs, s->quest.budget, a->n_next);
    return rp_fail(RP_NO_RESULT, "%s: %s: %s%s", s->name[p], stats_identified_words[status],
                   stats_identified_meanings[status], more);
}

static rp_status plan_alone(const problem *s)
{
    const cli_call *call = s->call;
    size_t points, runs;
    RP_TRY(rp_prefix(stats_first_stage(&s->quest, &points, &runs), "%s: ", s->path));
    cli_provenance(call, call->out);
    rp_table_note(call->out, "first stage", "%zu points, %zu runs; at most %zu in all", points, runs,
                  s->quest.budget);
    rp_table_header(call->out, call->units, "number, group, value, error");
    for (size_t k = 0; k < s->quest.n_numbers; k++) {
        fprintf(call->out, "%s\t", s->number[k].of);
        CLI_ROW((double)s->quest.group[k] + 1.0, s->quest.value[k], s->quest.error[k]);
    }
    return RP_OK;
}

static rp_status find(problem *s)
{
    stats_answer a;
    RP_TRY(read_file(s));
    RP_TRY(s->quest.fixed_runs ? rp_prefix(read_tables(s), "%s: ", s->path) : find_names(s));
    if (s->o->dry_run) return plan_alone(s);
    s->quest.host = s, s->quest.run = run_stage, s->quest.tell = tell, s->quest.leave_out = true;
    RP_TRY(rp_prefix(stats_identify(&s->quest, &a), "%s: ", s->path));
    print_answer(s, &a);
    return conclude(s, &a);
}

/* ---- an angle alone ---- */

/* The file of a friction whose piles have these angles, in the folder of its runs: to look at, and to change
 * a copy of. */
static rp_status write_file(const cli_call *call, const calibrate_options *o, const char **path)
{
    const struct {
        const char *option, *error_option, *of;
        double value, error;
    } angles[] = {{"theta-r-deg", "error-deg", "theta_r3_deg", o->theta_r_deg, o->error_deg},
                  {"theta-t-deg", "theta-t-error-deg", "theta_t_displacement_deg", o->theta_t_deg,
                   o->theta_t_error_deg}};
    const char *numbers = "";
    FILE *out;
    for (int k = 0; k < 2; k++) {
        const bool valued = !isinf(angles[k].value), has_error = !isinf(angles[k].error);
        if (valued != has_error)
            return rp_fail(RP_USAGE, "--%s needs --%s", valued ? angles[k].option : angles[k].error_option,
                           valued ? angles[k].error_option : angles[k].option);
        if (valued)
            numbers = rp_text(call->arena,
                              "%s%s  { protocol = \"repose\"; of = \"%s\"; value = %.17e; error = %.17e;\n"
                              "    fixed = { W = 4.0; H = 4.0; floor = \"extends\"; slip = \"truncated\"; "
                              "theta_t = true; }; }",
                              numbers, *numbers ? ",\n" : "", angles[k].of, angles[k].value, angles[k].error);
    }
    if (!*numbers)
        return rp_fail(RP_USAGE, "FILE.cfg, --theta-r-deg or --theta-t-deg is required; see repose calibrate "
                                 "--help");
    const char *text =
        rp_text(call->arena,
                "# Friction of a box that is opened on one side, from the angles of the pile.\n"
                "fit = { mu = [0.05, 0.8]; };\nmeasured = (\n%s );\n",
                numbers);
    RP_TRY(rp_make_directory(o->o));
    RP_TRY(rp_path(call->arena, path, "%s/angle.cfg", o->o));
    if (access(*path, F_OK) == 0) { /* a person may have changed it */
        char *there;
        const rp_status read = rp_file_read(*path, &there);
        const bool same = !read && rp_ends_in(there, text);
        free(there);
        return read || same
                   ? read
                   : rp_fail(RP_BAD_INPUT,
                             "%s: not what these options say; give it as the file, or another folder", *path);
    }
    RP_TRY(rp_file_open(*path, false, &out));
    fprintf(out, "# program: repose %s\n%s", RP_VERSION, text);
    return rp_file_close(*path, out, RP_OK);
}

/* The files that a dry run has needed, in a folder of its own. */
static void remove_files(const problem *s)
{
    unlink(rp_text(s->call->arena, "%s/try.cfg", s->o->o));
    unlink(rp_text(s->call->arena, "%s/angle.cfg", s->o->o));
    rmdir(s->o->o);
}

static rp_status calibrate(cli_call *call, const void *values)
{
    calibrate_options own = *(const calibrate_options *)values, *o = &own;
    char aside[] = "/tmp/repose_XXXXXX";
    const char *file = cli_argument(call, 0);
    if (file && (!isinf(o->theta_r_deg) || !isinf(o->error_deg) || !isinf(o->theta_t_deg) ||
                 !isinf(o->theta_t_error_deg)))
        return rp_fail(RP_USAGE, "%s says what is measured: no --theta-r-deg and no --theta-t-deg", file);
    if (!o->dry_run && rp_is_in(o->o, ".repose"))
        return rp_fail(RP_BAD_INPUT, "%s: holds a result; give another folder", o->o);
    if (o->dry_run && !(o->o = mkdtemp(aside))) return rp_fail(RP_IO, "%s: %s", aside, strerror(errno));
    problem s = {.call = call, .o = o};
    rp_status status = file ? RP_OK : write_file(call, o, &file);
    if (!status) {
        s.path = cli_data(call->arena, file);
        const char *slash = strrchr(s.path, '/');
        s.folder = rp_text(call->arena, "%.*s", slash ? (int)(slash - s.path) + 1 : 0, s.path);
        status = find(&s);
        config_destroy(&s.config);
    }
    if (o->dry_run) remove_files(&s);
    if (s.lock) close(s.lock);
    return status;
}

const cli_command cmd_calibrate = {
    "calibrate",
    "parameters that give measured numbers, with their intervals",
    "FILE.cfg [-o DIR] [--budget RUNS] [--dry-run]\n"
    "--theta-r-deg ANGLE --error-deg SE [options]",
    "FILE.cfg: find up to three names of experiments (`let`) from several measured numbers. It has fit = { "
    "NAME = [from, to]; } and measured = ( { experiment, of, value, error } ), where `of` is a column of the "
    "experiment's sweep, and if wanted fixed = { ... }, model_error, protocol instead of experiment, or "
    "runs, a table of another program; where = \"CONDITION\" of the names, seed, budget. Each number is "
    "fitted by a polynomial of the names over the runs of a design, with more terms where the runs bend; "
    "where "
    "that agrees with the measurements, a smaller box gets more runs, until the answer is settled. Each "
    "stage "
    "says what is known, and is a sweep in DIR: the same command continues. The first one takes 24 runs of "
    "each experiment for one name, 40 for two, 56 for "
    "three.\n"
    "\n"
    "--theta-r-deg: the friction of a box that is opened on one side, whose pile has this angle of repose; "
    "--theta-t-deg: this tilting angle too. DIR/angle.cfg is the file that says so; for other piles change a "
    "copy of it.\n"
    "\n"
    "The interval from lower to upper is of 95 %, by profiles of chi2: of the measurement's error, the "
    "scatter of the runs, and the lack of fit. The header has each number's residual and reach, "
    "correlations, the combination of the names that is determined best, and how many points of the design "
    "the others find again. form p is the chance of such a misfit, beyond a tenth of the measurement's "
    "error, "
    "if the polynomial holds. Below 0.01 the runs reject it, and no value is printed. Repeated runs tell "
    "it.\n"
    "\n"
    "status is one of\n"
#define X(name, word, meaning) "  " word ": " meaning "\n"
    STATS_IDENTIFIED_LIST(X)
#undef X
        "The exit status is 1 unless the status is ok.\n"
        "\n"
        "The answer holds for the experiments that ran. It does not carry over to another model, protocol or "
        "size.",
    "repose calibrate fit.cfg -o found",
    calibrate_params,
    .refuses = "A stage_*.cfg of DIR that says something else: give another folder, or --force.\n"
               "An angle without its standard error; a column that the runs do not have; a name that no "
               "experiment has.\n"
               "An answer whose status is not ok: exit status 1.",
    .act = calibrate};
