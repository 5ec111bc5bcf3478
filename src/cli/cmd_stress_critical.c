/* repose stress critical: the tilt at which the measured stress reaches Coulomb's law. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "stress/stress.h"
#include "cli/cli.h"
#include "core/random.h"

static const double deg = M_PI / 180.0;

#define N_OF(array) (sizeof(array) / sizeof *(array))

typedef struct {
    long bootstrap, seed;
    rp_texts where;
} critical_options;

static const rp_param critical_params[] = {{"bootstrap", "", RP_INT, offsetof(critical_options, bootstrap),
                                            "1000", "[2, 10000000]", "resamples of the piles"},
                                           {"seed", "", RP_INT, offsetof(critical_options, seed), "1993",
                                            "[0, 2147483647]", "seed of the resamples"},
                                           CLI_WHERE(critical_options),
                                           {0}};

enum { COLUMN_MU, COLUMN_T, COLUMN_RESPONSE, N_RESPONSE = sizeof(stress_response) / sizeof(double) };
static const char *const run_columns[] = {"mu",    "theta_t_displacement_deg",
                                          "n_0",   "n_1",
                                          "h_0",   "h_1",
                                          "sxx_0", "sxy_0",
                                          "syx_0", "syy_0",
                                          "sxx_1", "sxy_1",
                                          "syx_1", "syy_1"};

static void print_critical_header(void)
{
    static const struct {
        const char *name;
        bool angle;
    } list[] = {
#define X(name, angle) {#name, angle},
        STRESS_CRITICAL_LIST(X)
#undef X
    };
    static const char *const parts[] = {"", "_se", "_lo", "_hi"};
    char names[4 * N_OF(list)][40];
    const char *columns[4 * N_OF(list) + 2][2] = {{"mu", ""}, {"n", ""}};
    for (size_t i = 0; i < 4 * N_OF(list); i++) {
        snprintf(names[i], sizeof names[i], "%s%s%s", list[i / 4].name, parts[i % 4],
                 list[i / 4].angle ? "_deg" : "");
        columns[i + 2][0] = names[i];
        columns[i + 2][1] = list[i / 4].angle ? "deg" : "";
    }
    rp_table_columns(stdout, N_OF(columns), (const char *const(*)[2])columns);
}

static void print_critical(double mu, size_t n, const stress_critical *c)
{
    double v[2 + sizeof *c / sizeof(double)] = {mu, (double)n};
    size_t used = 2;
#define X(name, angle)                                                                                       \
    v[used++] = c->name.value / (angle ? deg : 1.0);                                                         \
    v[used++] = c->name.se / (angle ? deg : 1.0);                                                            \
    v[used++] = c->name.lo / (angle ? deg : 1.0);                                                            \
    v[used++] = c->name.hi / (angle ? deg : 1.0);
    STRESS_CRITICAL_LIST(X)
#undef X
    rp_table_row(stdout, used, v);
}

/* A run that counts. */
typedef struct {
    double mu, theta_t;
    stress_response response;
} pile_run;

static int by_mu(const void *a, const void *b)
{
    const pile_run *p = a, *q = b;
    return (p->mu > q->mu) - (p->mu < q->mu);
}

static rp_status critical_groups(size_t n, const pile_run runs[], const critical_options *o)
{
    gsl_rng *rng = rp_random_alloc((unsigned long)o->seed, 0, RP_PURPOSE_BOOTSTRAP);
    stress_response *responses = malloc((n + 1) * sizeof *responses);
    double *theta_t = malloc((n + 1) * sizeof *theta_t);
    rp_status status = rng && responses && theta_t ? RP_OK : rp_fail(RP_NO_MEMORY, "critical: out of memory");
    for (size_t first = 0, end; first < n && !status; first = end) {
        stress_critical critical;
        for (end = first; end < n && runs[end].mu == runs[first].mu; end++) {
            responses[end - first] = runs[end].response;
            theta_t[end - first] = runs[end].theta_t;
        }
        status = stress_critical_tilts(end - first, responses, theta_t, runs[first].mu, (size_t)o->bootstrap,
                                       rng, &critical);
        if (status)
            rp_prefix(status, "mu = %g: ", runs[first].mu);
        else
            print_critical(runs[first].mu, end - first, &critical);
    }
    if (rng) gsl_rng_free(rng);
    free(responses);
    free(theta_t);
    return status;
}

static rp_status critical_table(rp_table *table, const void *values)
{
    const critical_options *o = values;
    int columns[N_OF(run_columns)];
    double *block = NULL;
    const size_t rows = table->n_rows;
    size_t n = 0;
    const int status_column = rp_table_column(table, "status");
    rp_status status = cli_find_columns(table, N_OF(run_columns), run_columns, columns);
    if (!status && status_column < 0) status = rp_fail(RP_BAD_INPUT, "%s: no column \"status\"", table->path);
    if (!status) status = cli_read_columns(table, N_OF(run_columns), columns, 1, &block);
    pile_run *runs = malloc((rows + 1) * sizeof *runs);
    if (!status && !runs) status = rp_fail(RP_NO_MEMORY, "%s: out of memory", table->path);
    for (size_t i = 0; i < rows && !status; i++) {
        if (strcmp(table->cells[i * table->n_columns + (size_t)status_column], "ok") != 0) continue;
        double response[N_RESPONSE];
        for (size_t k = 0; k < N_RESPONSE; k++) response[k] = block[(COLUMN_RESPONSE + k) * rows + i];
        runs[n].mu = block[COLUMN_MU * rows + i];
        runs[n].theta_t = block[COLUMN_T * rows + i] * deg;
        memcpy(&runs[n].response, response, sizeof response);
        n += !isnan(runs[n].theta_t); /* a pile that stood every tilt has none to compare with */
    }
    if (!status && n == 0)
        status = rp_fail(RP_NO_RESULT, "%s: no row with status ok and a tilt", table->path);
    if (!status) {
        qsort(runs, n, sizeof *runs, by_mu);
        cli_table(stdout, critical_params, o);
        rp_table_note(stdout, "rows", "%zu used, %zu left out", n, rows - n);
        print_critical_header();
        status = critical_groups(n, runs, o);
        if (status) rp_prefix(status, "%s: ", table->path);
    }
    free(runs);
    free(block);
    return status;
}

const cli_command cmd_stress_critical = {
    "stress critical",
    "tilt at which the measured stress reaches Coulomb's law",
    "FILE [options]",
    "Tilt at which the measured stress of piles reaches Coulomb's law, one row for each mu, from the\n"
    "runs of protocol stress (repose sweep export; rows whose status is not ok are left out). Mean\n"
    "response of the piles, extrapolated in the tangent of the tilt; errors and 95 % intervals by\n"
    "bootstrap over piles.\n"
    "floor_tilt: friction on the floor comes to mu; floor_less: that less the measured theta_t.\n"
    "..._friction_0, _t: friction mobilised without tilt and at the measured theta_t. rank: Spearman's\n"
    "correlation of the piles' own floor_tilt and theta_t.",
    "repose stress critical build/tables/lh_stress_runs.tsv",
    critical_params,
    .on_table = critical_table};
