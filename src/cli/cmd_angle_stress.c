/* repose angle stress, repose angle critical: measured stress on the command line. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "angle/angle.h"
#include "stats/stats.h"
#include "stress/stress.h"
#include "cli/cli.h"
#include "cli/cmd_angle.h"
#include "core/random.h"

static const double deg = M_PI / 180.0;

#define N_OF(array) (sizeof(array) / sizeof *(array))

/* ---- stress ---- */

enum { MOST_PILES = 1000 };

typedef struct {
    double width, cell, diameter, g, phi_deg;
    bool base;
} stress_options;

static const rp_param stress_params[] = {
    {"width", "cm", RP_REAL, offsetof(stress_options, width), NULL, "(0, inf)",
     "width W of the box, from x = 0"},
    {"cell", "cm", RP_REAL, offsetof(stress_options, cell), "0.4", "(0, inf)", "cells; round(W/cell) to W"},
    {"base", "", RP_BOOL, offsetof(stress_options, base), "false", "", "forces on the floor, not the field"},
    {"diameter", "cm", RP_REAL, offsetof(stress_options, diameter), "0.2", "(0, inf)",
     "nominal diameter of a grain, for the slope"},
    {"g", "cm/s^2", RP_REAL, offsetof(stress_options, g), "981.0", "(0, inf)", "gravity"},
    {"phi-deg", "deg", RP_REAL, offsetof(stress_options, phi_deg), "60", "(0, 90)",
     "inclination of the rays of theory"},
    {0}};

static const cli_command stress_command = {"angle stress",
                                           "PREFIX... --width W [options]",
                                           "Mean over piles of the stress in cells, from the tables "
                                           "PREFIX_contacts.tsv and PREFIX_grains.tsv of each:\n"
                                           "s_ab, force along a, branch along b, compression positive, 0 "
                                           "where there are no grains; p mean pressure,\n"
                                           "shear radius of Mohr's circle, couple (xy - yx)/2, direction of "
                                           "the largest compression, mobilised angle.\n"
                                           "With --base, of piles without tilt: N, H forces of the pile on "
                                           "the floor, H away from the left wall; weight\n"
                                           "of the column above; through: vertical force through its sides; "
                                           "imbalance N - weight - through; N_theory,\n"
                                           "H_theory: rays of inclination phi in a wedge of the mean slope "
                                           "by method 3, of that weight. All per length.",
                                           "repose angle stress pile --width 4 --base",
                                           stress_params,
                                           1,
                                           MOST_PILES};

/* One pile out of its tables. */
typedef struct {
    size_t n, n_grains;
    stress_contact *contacts;
    bool *floor;                /* is it one with the floor? */
    double *grains, *x, *y, *m; /* of the grains: columns of one block */
} pile;

static void pile_free(pile *p)
{
    free(p->contacts);
    free(p->floor);
    free(p->grains);
}

static rp_status read_block(const char *prefix, const char *what, size_t n, const char *const names[],
                            double **block, size_t *rows)
{
    char path[4096];
    rp_table table;
    int columns[16];
    snprintf(path, sizeof path, "%s_%s.tsv", prefix, what);
    rp_status status = rp_table_read(path, &table);
    if (!status) status = cli_find_columns(&table, n, names, columns);
    if (!status) status = cli_read_columns(&table, n, columns, 0, block);
    *rows = status ? 0 : table.n_rows;
    rp_table_free(&table);
    return status;
}

static rp_status pile_read(const char *prefix, pile *p)
{
    static const char *const contact_names[] = {"id_b", "wall",         "x",          "y", "x_b",
                                                "y_b",  "normal_force", "shear_force"};
    static const char *const grain_names[] = {"x", "y", "m"};
    double *block = NULL;
    *p = (pile){0};
    rp_status status = read_block(prefix, "contacts", N_OF(contact_names), contact_names, &block, &p->n);
    if (!status)
        status = read_block(prefix, "grains", N_OF(grain_names), grain_names, &p->grains, &p->n_grains);
    p->contacts = malloc((p->n + 1) * sizeof *p->contacts);
    p->floor = malloc((p->n + 1) * sizeof *p->floor);
    if (!status && !(p->contacts && p->floor)) status = rp_fail(RP_NO_MEMORY, "%s: out of memory", prefix);
    for (size_t k = 0; k < p->n && !status; k++) {
        const double *v = block + k;
        const size_t n = p->n;
        const double lx = v[2 * n] - v[4 * n], ly = v[3 * n] - v[5 * n], l = hypot(lx, ly);
        const double fn = v[6 * n], fs = v[7 * n];
        if (!(l > 0.0)) status = rp_fail(RP_BAD_INPUT, "%s: contact %zu has no branch", prefix, k + 1);
        /* normal from b to a; shear along the normal turned clockwise */
        p->contacts[k] = (stress_contact){
            v[2 * n], v[3 * n], v[4 * n], v[5 * n], (fn * lx + fs * ly) / l, (fn * ly - fs * lx) / l};
        p->floor[k] = v[0] == 0.0 && v[n] == 1.0;
    }
    free(block);
    p->x = p->grains;
    p->y = p->x ? p->x + p->n_grains : NULL;
    p->m = p->y ? p->y + p->n_grains : NULL;
    return status;
}

static rp_status print_field(size_t n, const pile piles[], const stress_options *o)
{
    static const char *const columns[][2] = {
        {"x/W", ""},          {"y/W", ""},          {"sxx", "dyn/cm"},       {"sxy", "dyn/cm"},
        {"syx", "dyn/cm"},    {"syy", "dyn/cm"},    {"p", "dyn/cm"},         {"shear", "dyn/cm"},
        {"couple", "dyn/cm"}, {"direction", "rad"}, {"mobilised_deg", "deg"}};
    double top = 0.0;
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < piles[i].n_grains; k++) top = fmax(top, piles[i].y[k]);
    stress_grid g = {.nx = (size_t)fmax(round(o->width / o->cell), 1.0)};
    g.dx = g.dy = o->width / (double)g.nx;
    g.ny = (size_t)ceil(top / g.dy) + 1;
    const size_t cells = g.nx * g.ny;
    stress_tensor *sum = calloc(2 * cells, sizeof *sum), *one = sum + cells;
    rp_status status = sum ? RP_OK : rp_fail(RP_NO_MEMORY, "%zu cells: out of memory", cells);
    for (size_t i = 0; i < n && !status; i++) {
        status = stress_cells(piles[i].n, piles[i].contacts, &g, one);
        for (size_t k = 0; k < cells && !status; k++) {
            sum[k].xx += one[k].xx / (double)n;
            sum[k].xy += one[k].xy / (double)n;
            sum[k].yx += one[k].yx / (double)n;
            sum[k].yy += one[k].yy / (double)n;
        }
    }
    if (!status) rp_table_columns(stdout, N_OF(columns), columns);
    for (size_t k = 0; k < cells && !status; k++) {
        const stress_circle m = stress_mohr(&sum[k]);
        rp_table_row(stdout, N_OF(columns),
                     (double[]){((double)(k % g.nx) + 0.5) * g.dx / o->width,
                                ((double)(k / g.nx) + 0.5) * g.dy / o->width, sum[k].xx, sum[k].xy, sum[k].yx,
                                sum[k].yy, m.pressure, m.shear, m.couple, m.direction, m.mobilised / deg});
    }
    free(sum);
    return status;
}

/* What a column of the base holds, summed over a pile. */
typedef struct {
    double n, h, weight, through;
} column;

static void add_columns(const pile *p, const stress_options *o, double size, size_t n, column columns[])
{
    for (size_t i = 0; i < n; i++) columns[i] = (column){0};
    for (size_t k = 0; k < p->n_grains; k++) {
        const double at = floor(p->x[k] / size);
        if (at >= 0.0 && at < (double)n) columns[(size_t)at].weight += p->m[k] * o->g;
    }
    for (size_t k = 0; k < p->n; k++) {
        const stress_contact *c = &p->contacts[k];
        const double a = floor(c->x / size), b = floor(c->x_b / size);
        const bool in_a = a >= 0.0 && a < (double)n, wall = c->x_b <= 0.0;
        if (p->floor[k] && in_a) {
            columns[(size_t)a].n += c->fy;
            columns[(size_t)a].h -= c->fx;
        } else if (a != b || wall) {
            if (in_a) columns[(size_t)a].through -= c->fy;
            if (!wall && b >= 0.0 && b < (double)n) columns[(size_t)b].through += c->fy;
        }
    }
}

/* Mean slope by method 3 of the parts in 0 < x < W. */
static rp_status mean_slope(size_t n, const pile piles[], const stress_options *o, double *theta)
{
    ang_options options = ANG_OPTIONS_DEFAULT;
    options.diameter = o->diameter;
    *theta = 0.0;
    rp_status status = RP_OK;
    for (size_t i = 0; i < n && !status; i++) {
        ang_surface surface;
        ang_slope slopes[ANG_N_METHODS];
        status =
            ang_surface_make(piles[i].n_grains, piles[i].x, piles[i].y, NULL, o->width, &options, &surface);
        if (!status)
            status = ang_slopes(surface.n, surface.column, surface.h, surface.cell, options.parabola, slopes);
        ang_surface_free(&surface);
        if (!status) *theta += slopes[2].theta / (double)n;
    }
    return status;
}

static rp_status print_base(size_t n, const pile piles[], const stress_options *o)
{
    static const char *const names[][2] = {
        {"x/W", ""},        {"N", "dyn/cm"},        {"N_se", "dyn/cm"},    {"H", "dyn/cm"},
        {"H_se", "dyn/cm"}, {"weight", "dyn/cm"},   {"through", "dyn/cm"}, {"imbalance", "dyn/cm"},
        {"H/N", ""},        {"N_theory", "dyn/cm"}, {"H_theory", "dyn/cm"}};
    double theta, far = o->width;
    rp_status status = mean_slope(n, piles, o, &theta);
    if (status) return status;
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < piles[i].n_grains; k++) far = fmax(far, piles[i].x[k]);
    const double size = o->width / fmax(round(o->width / o->cell), 1.0);
    const size_t cells = (size_t)ceil(far / size) + 1;
    column *all = malloc(n * cells * sizeof *all);
    double *forces = malloc(2 * n * sizeof *forces);
    if (all && forces) {
        for (size_t i = 0; i < n; i++) add_columns(&piles[i], o, size, cells, all + i * cells);
        rp_table_note(stdout, "theta_r_deg", "%.17g", theta / deg);
        rp_table_columns(stdout, N_OF(names), names);
    } else {
        status = rp_fail(RP_NO_MEMORY, "base: out of memory");
    }
    for (size_t j = 0; j < cells && !status; j++) {
        double weight = 0.0, through = 0.0;
        stats_summary normal, along;
        for (size_t i = 0; i < n; i++) {
            const column *c = &all[i * cells + j];
            forces[i] = c->n / size;
            forces[n + i] = c->h / size;
            weight += c->weight / (size * (double)n);
            through += c->through / (size * (double)n);
        }
        status = stats_mean(n, forces, &normal);
        if (!status) status = stats_mean(n, forces + n, &along);
        const double t = tan(theta), k = tan(o->phi_deg * deg) * tan(o->phi_deg * deg);
        const double by_rays = weight / (1.0 - t * t / k);
        if (!status)
            rp_table_row(stdout, N_OF(names),
                         (double[]){((double)j + 0.5) * size / o->width, normal.mean, normal.se, along.mean,
                                    along.se, weight, through, normal.mean - weight - through,
                                    normal.mean > 0.0 ? along.mean / normal.mean : NAN, by_rays,
                                    t / k * by_rays});
    }
    free(forces);
    free(all);
    return status;
}

rp_status cmd_angle_stress(int argc, char **argv)
{
    static const char *prefixes[MOST_PILES];
    stress_options o;
    int n;
    bool done;
    rp_status status = cli_parse(&stress_command, argc, argv, &o, prefixes, &n, &done);
    if (status || done) return status;
    pile *piles = calloc((size_t)n, sizeof *piles);
    if (!piles) return rp_fail(RP_NO_MEMORY, "%d piles: out of memory", n);
    for (int i = 0; i < n && !status; i++) status = pile_read(prefixes[i], &piles[i]);
    if (!status) {
        cli_table(stdout, stress_params, &o);
        rp_table_note(stdout, "piles", "%d", n);
        status = (o.base ? print_base : print_field)((size_t)n, piles, &o);
    }
    for (int i = 0; i < n; i++) pile_free(&piles[i]);
    free(piles);
    return status;
}

/* ---- critical ---- */

typedef struct {
    long bootstrap, seed;
} critical_options;

static const rp_param critical_params[] = {{"bootstrap", "", RP_INT, offsetof(critical_options, bootstrap),
                                            "1000", "[2, 10000000]", "resamples of the piles"},
                                           {"seed", "", RP_INT, offsetof(critical_options, seed), "1993",
                                            "[0, 2147483647]", "seed of the resamples"},
                                           {0}};

static const cli_command critical_command = {
    "angle critical",
    "FILE [options]",
    "Tilt at which the measured stress of piles reaches Coulomb's law, one row for each mu, from the runs "
    "of\n"
    "protocol stress (repose sweep export; rows whose status is not ok are left out). Mean response of the "
    "piles,\n"
    "extrapolated in the tangent of the tilt; errors and 95 % intervals by bootstrap over piles.\n"
    "floor_tilt: friction on the floor comes to mu; floor_less: that less the measured theta_t. bulk_tilt: "
    "the\n"
    "angle mobilised inside comes to atan mu; negative if it is beyond without tilt, nan if it is at any "
    "tilt.\n"
    "..._friction_0, _t: friction mobilised without tilt and at the measured theta_t. rank: Spearman's\n"
    "correlation of the piles' own floor_tilt and theta_t.",
    "repose angle critical build/tables/lh_stress_runs.tsv",
    critical_params,
    1,
    1};

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

rp_status cmd_angle_critical(int argc, char **argv)
{
    critical_options o;
    return cli_with_table(&critical_command, argc, argv, &o, critical_table);
}
