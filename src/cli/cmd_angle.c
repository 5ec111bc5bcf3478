/* repose angle: the angle toolkit on the command line. */
#include <gsl/gsl_sort.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "angle/angle.h"
#include "stats/stats.h"
#include "cli/cli.h"
#include "cli/cmd_angle.h"
#include "core/random.h"

static const double deg = M_PI / 180.0;

#define N_OF(array) (sizeof(array) / sizeof *(array))
#define MU_PARAM(T)                                                                                          \
    {                                                                                                        \
        "mu", "", RP_REAL, offsetof(T, mu), NULL, "[0, inf) | infinite", "friction coefficient of the base"  \
    }
#define PHI_PARAM(T)                                                                                         \
    {                                                                                                        \
        "phi-deg", "deg", RP_REAL, offsetof(T, phi_deg), "60", "(0, 90)", "inclination of the rays of force" \
    }

/* ---- marginal ---- */

typedef struct {
    double mu, phi_deg;
} marginal_options;

static const rp_param marginal_params[] = {MU_PARAM(marginal_options), PHI_PARAM(marginal_options), {0}};

static const cli_command marginal_command = {
    "angle marginal",
    "--mu MU [options]",
    "Angle of marginal stability, tan theta_MS = mu tan^2 phi (Lee & Herrmann 1993, (3)).\n"
    "status: ok, or extrapolated where theta_MS >= phi, beyond the derivation.",
    "repose angle marginal --mu 0.2",
    marginal_params,
    0,
    0};

static rp_status print_marginal(const void *values)
{
    const marginal_options *o = values;
    bool extrapolated;
    double theta_ms;
    rp_status status = ang_marginal(o->mu, o->phi_deg * deg, &theta_ms, &extrapolated);
    if (status) return status;
    cli_table(stdout, marginal_params, o);
    rp_table_columns(stdout, 2, (const char *const[][2]){{"theta_ms_deg", "deg"}, {"status", ""}});
    rp_table_row_word(stdout, 1, (double[]){theta_ms / deg}, extrapolated ? "extrapolated" : "ok");
    return RP_OK;
}

static rp_status marginal(int argc, char **argv)
{
    marginal_options o;
    return cli_plain(&marginal_command, argc, argv, &o, print_marginal);
}

/* ---- tilt ---- */

typedef struct {
    double mu, theta_r_deg, phi_deg;
    int form;
} tilt_options;

static const rp_param tilt_params[] = {
    MU_PARAM(tilt_options),
    {"theta-r-deg", "deg", RP_REAL, offsetof(tilt_options, theta_r_deg), NULL, "[0, 90)",
     "slope of the pile"},
    {"form", "", RP_CHOICE, offsetof(tilt_options, form), "balanced", ANG_FORM_WORDS, "form of (4)"},
    PHI_PARAM(tilt_options),
    {0}};

static const cli_command tilt_command = {
    "angle tilt",
    "--mu MU --theta-r-deg ANGLE [options]",
    "Tilt theta_T at which a pile slides (Lee & Herrmann 1993, (4)), theta_MS of (3), margin theta_MS -\n"
    "theta_R, and the tilt up to which the form is defined.\n"
    "form: balanced (rays fixed to gravity, forces balance), lattice (rays fixed to the pile, forces\n"
    "balance), sine ((4b) with sines for tangents), printed.\n"
    "status: ok; ok_pulling (found, but there one ray of the lattice form pulls); already_unstable (margin\n"
    "negative, no theta_T); no_slide (no theta_T below the limit); rays_miss (theta_R >= phi, no theory:\n"
    "exit status 1).",
    "repose angle tilt --mu 0.2 --theta-r-deg 18 --form balanced",
    tilt_params,
    0,
    0};

static rp_status print_tilt(const void *values)
{
    const tilt_options *o = values;
    ang_tilt_result r;
    rp_status status = ang_tilt((ang_form)o->form, o->mu, o->theta_r_deg * deg, o->phi_deg * deg, &r);
    if (status) return status;
    cli_table(stdout, tilt_params, o);
    static const char *const columns[][2] = {{"theta_t_deg", "deg"},
                                             {"theta_ms_deg", "deg"},
                                             {"margin_deg", "deg"},
                                             {"limit_deg", "deg"},
                                             {"status", ""}};
    rp_table_columns(stdout, N_OF(columns), columns);
    rp_table_row_word(stdout, 4, (double[]){r.theta_t / deg, r.theta_ms / deg, r.margin / deg, r.limit / deg},
                      ang_tilt_word(r.status));
    if (r.status == ANG_TILT_RAYS_MISS)
        return rp_fail(RP_NO_RESULT,
                       "theta-r-deg = %g: the rays of inclination %g deg never leave through the flank",
                       o->theta_r_deg, o->phi_deg);
    return RP_OK;
}

static rp_status tilt(int argc, char **argv)
{
    tilt_options o;
    return cli_plain(&tilt_command, argc, argv, &o, print_tilt);
}

/* ---- slope ---- */

typedef struct {
    double width, cell;
    int height, empty, parabola;
} slope_options;

static const rp_param slope_params[] = {
    {"width", "cm", RP_REAL, offsetof(slope_options, width), NULL, "(0, inf)",
     "width W of the box, from x = 0"},
    {"cell", "cm", RP_REAL, offsetof(slope_options, cell), "0.2", "(0, inf)",
     "nominal diameter d of a grain; round(W/d) cells"},
    {"height", "", RP_CHOICE, offsetof(slope_options, height), "centre", ANG_HEIGHT_WORDS,
     "height of a cell: highest centre - d/2 (at least 0), highest centre, or highest point"},
    {"empty", "", RP_CHOICE, offsetof(slope_options, empty), "zero", ANG_EMPTY_WORDS,
     "empty cells have height 0, or are left out"},
    {"parabola", "", RP_CHOICE, offsetof(slope_options, parabola), "free", ANG_PARABOLA_WORDS,
     "parabola of method 3: three coefficients, or through the origin"},
    {0}};

static const cli_command slope_command = {
    "angle slope",
    "FILE --width W [options]",
    "Slope of a pile's surface h(x), positive where it falls to the right, by the methods of Lee & Herrmann\n"
    "1993: 1 first to last cell, 2 straight line, 3 parabola through the running sum of h. The standard\n"
    "error is propagated from the scatter of h about its straight line.\n"
    "FILE (- for standard input): one row a grain, columns x y r by name, otherwise the first three; r is\n"
    "needed for --height top only. Fewer than 5 occupied cells: no_pile, exit status 1.",
    "repose angle slope pile.tsv --width 4",
    slope_params,
    1,
    1};

static rp_status place_columns(const rp_table *table, bool with_r, int columns[3])
{
    static const char *const names[] = {"x", "y", "r"};
    bool named = false;
    for (int c = 0; c < 3; c++) {
        columns[c] = table->n_columns > 0 ? rp_table_column(table, names[c]) : -1;
        named = named || columns[c] >= 0;
    }
    int n = with_r ? 3 : 2;
    if (named) {
        rp_status status = cli_find_columns(table, (size_t)n, names, columns);
        if (status) return status;
    } else if (table->n_columns < (size_t)n) {
        return rp_fail(RP_BAD_INPUT, "%s: %zu columns, at least %d (%s) needed", table->path,
                       table->n_columns, n, with_r ? "x y r" : "x y");
    } else {
        for (int c = 0; c < 3; c++) columns[c] = c;
    }
    if (!with_r) columns[2] = -1;
    return RP_OK;
}

/* A table of states may hold a pile at several times. */
static rp_status refuse_several_steps(const rp_table *table)
{
    int column = rp_table_column(table, "step");
    for (size_t i = 1; table->names[0] && column >= 0 && i < table->n_rows; i++)
        if (strcmp(table->cells[i * table->n_columns + (size_t)column], table->cells[column]) != 0)
            return rp_fail(RP_BAD_INPUT, "%s:%zu: step = %s after %s: one step's grains expected",
                           table->path, table->lines[i], table->cells[i * table->n_columns + (size_t)column],
                           table->cells[column]);
    return RP_OK;
}

/* Without slopes: rows without result. */
static void print_slopes(const slope_options *o, const ang_surface *surface, const ang_slope *slopes)
{
    static const char *const columns[][2] = {{"method", ""},          {"slope", ""},   {"theta_deg", "deg"},
                                             {"theta_se_deg", "deg"}, {"n_cells", ""}, {"n_occupied", ""},
                                             {"status", ""}};
    cli_table(stdout, slope_params, o);
    rp_table_columns(stdout, N_OF(columns), columns);
    for (int i = 0; i < ANG_N_METHODS; i++) {
        ang_slope s = slopes ? slopes[i] : (ang_slope){NAN, NAN, NAN, NAN};
        rp_table_row_word(stdout, 6,
                          (double[]){i + 1, s.slope, s.theta / deg, s.theta_se / deg,
                                     (double)surface->n_cells, (double)surface->n_occupied},
                          slopes ? "ok" : "no_pile");
    }
}

static rp_status slope_of_table(rp_table *table, const void *values)
{
    const slope_options *o = values;
    int columns[3];
    double *block = NULL;
    size_t n = table->n_rows;
    ang_options options = {o->cell, (ang_height)o->height, (ang_empty)o->empty, (ang_parabola)o->parabola};
    ang_surface surface = {0};
    ang_slope slopes[ANG_N_METHODS];
    if (n == 0) return rp_fail(RP_BAD_INPUT, "%s: no grains", table->path);
    rp_status status = place_columns(table, options.height == ANG_TOP, columns);
    if (!status) status = refuse_several_steps(table);
    if (!status) status = cli_read_columns(table, 3, columns, 0, &block);
    if (!status) {
        status = ang_surface_make(n, block, block + n, options.height == ANG_TOP ? block + 2 * n : NULL,
                                  o->width, &options, &surface);
        if (status) rp_prefix(status, "%s: ", table->path);
    }
    if (!status)
        status = ang_slopes(surface.n, surface.column, surface.h, surface.cell, options.parabola, slopes);
    if (!status || status == RP_NO_RESULT) print_slopes(o, &surface, status ? NULL : slopes);
    ang_surface_free(&surface);
    free(block);
    return status;
}

static rp_status slope(int argc, char **argv)
{
    slope_options o;
    return cli_with_table(&slope_command, argc, argv, &o, slope_of_table);
}

/* ---- compare ---- */

typedef struct {
    double phi_deg;
    long bootstrap, seed;
} compare_options;

static const rp_param compare_params[] = {
    PHI_PARAM(compare_options),
    {"bootstrap", "", RP_INT, offsetof(compare_options, bootstrap), "2000", "[2, 10000000]",
     "resamples of the piles"},
    {"seed", "", RP_INT, offsetof(compare_options, seed), "1993", "[0, 2147483647]", "seed of the resamples"},
    {0}};

static const cli_command compare_command = {
    "angle compare",
    "FILE [options]",
    "Measured piles against (3) and (4) of Lee & Herrmann 1993, one row for each mu.\n"
    "FILE (- for standard input): one row a pile, columns mu theta_r3_deg theta_t_displacement_deg status, "
    "as\n"
    "repose sweep export writes; rows whose status is not ok, or with nan in an angle, are left out.\n"
    "rt: theta_R + theta_T, measured pile by pile, or with theta_T of (4) at the mean theta_R; diff: "
    "measured\n"
    "minus theory. theta_r_se, theta_t_se, theta_rt_se: SD/sqrt(n); the other errors: bootstrap over piles.\n"
    "n_unstable: piles steeper than theta_MS; n_lost: resamples without theta_T, left out. status: that of\n"
    "repose angle tilt at the mean theta_R, of the first form that is not ok.",
    "repose angle compare piles.tsv",
    compare_params,
    1,
    1};

/* Piles ordered by mu, then as in the file. */
typedef struct {
    double mu, theta_r, theta_t;
    size_t row;
} pile;

static int by_mu(const void *a, const void *b)
{
    const pile *p = a, *q = b;
    return p->mu != q->mu ? (p->mu > q->mu) - (p->mu < q->mu) : (p->row > q->row) - (p->row < q->row);
}

static const char *const compare_columns[][2] = {
    {"mu", ""},
    {"n", ""},
    {"theta_r_deg", "deg"},
    {"theta_r_se_deg", "deg"},
    {"theta_t_deg", "deg"},
    {"theta_t_se_deg", "deg"},
    {"theta_rt_deg", "deg"},
    {"theta_rt_se_deg", "deg"},
    {"theta_ms_deg", "deg"},
    {"diff_ms_deg", "deg"},
    {"diff_ms_se_deg", "deg"},
    {"n_unstable", ""},
    {"n_lost", ""},
};
/* Before and after the form's name, and the unit. */
static const char *const form_columns[][3] = {{"theta_t_", "_deg", "deg"},  {"theta_t_", "_se_deg", "deg"},
                                              {"diff_", "_deg", "deg"},     {"diff_", "_se_deg", "deg"},
                                              {"theta_rt_", "_deg", "deg"}, {"theta_rt_", "_se_deg", "deg"},
                                              {"gain_", "_deg", "deg"},     {"gain_", "_se_deg", "deg"},
                                              {"gain_relative_", "", ""},   {"gain_relative_", "_se", ""}};
enum {
    N_HEAD = N_OF(compare_columns),
    N_FORM = N_OF(form_columns),
    N_COMPARE = N_HEAD + ANG_N_FORMS * N_FORM
};

static void print_compare_header(void)
{
    char names[ANG_N_FORMS * N_FORM][40];
    const char *columns[N_COMPARE + 1][2];
    memcpy(columns, compare_columns, sizeof compare_columns);
    for (int i = 0; i < ANG_N_FORMS * N_FORM; i++) {
        snprintf(names[i], sizeof names[i], "%s%s%s", form_columns[i % N_FORM][0],
                 ang_form_word((ang_form)(i / N_FORM)), form_columns[i % N_FORM][1]);
        columns[N_HEAD + i][0] = names[i];
        columns[N_HEAD + i][1] = form_columns[i % N_FORM][2];
    }
    columns[N_COMPARE][0] = "status";
    columns[N_COMPARE][1] = "";
    rp_table_columns(stdout, N_COMPARE + 1, (const char *const(*)[2])columns);
}

static void print_comparison(double mu, const ang_comparison *c)
{
    double v[N_COMPARE] = {mu,
                           (double)c->theta_r.n,
                           c->theta_r.mean / deg,
                           c->theta_r.se / deg,
                           c->theta_t.mean / deg,
                           c->theta_t.se / deg,
                           c->theta_rt.mean / deg,
                           c->theta_rt.se / deg,
                           c->theta_ms / deg,
                           c->diff_ms.value / deg,
                           c->diff_ms.se / deg,
                           (double)c->n_unstable,
                           (double)c->n_lost};
    ang_tilt_status worst = ANG_TILT_OK;
    for (int f = 0; f < ANG_N_FORMS; f++) {
        const ang_estimate parts[] = {c->form[f].theta_t, c->form[f].diff, c->form[f].theta_rt,
                                      c->form[f].gain, c->form[f].gain_relative};
        for (int i = 0; i < N_FORM; i++)
            v[N_HEAD + f * N_FORM + i] =
                (i % 2 ? parts[i / 2].se : parts[i / 2].value) / (*form_columns[i][2] ? deg : 1.0);
        if (worst == ANG_TILT_OK) worst = c->form[f].status;
    }
    rp_table_row_word(stdout, N_COMPARE, v, ang_tilt_word(worst));
}

/* The piles that count, ordered by mu: status ok, both angles. *piles is a new array (free it). */
static rp_status read_piles(const rp_table *table, pile **piles, size_t *n)
{
    static const char *const names[] = {"mu", "theta_r3_deg", "theta_t_displacement_deg", "status"};
    int columns[4];
    double *block = NULL;
    size_t rows = table->n_rows;
    *n = 0;
    *piles = malloc((rows + 1) * sizeof **piles);
    rp_status status = *piles ? cli_find_columns(table, 4, names, columns)
                              : rp_fail(RP_NO_MEMORY, "%s: out of memory", table->path);
    if (!status) status = cli_read_columns(table, 3, columns, 1, &block);
    for (size_t i = 0; i < rows && !status; i++) {
        pile p = {block[i], block[rows + i] * deg, block[2 * rows + i] * deg, i};
        const char *word = table->cells[i * table->n_columns + (size_t)columns[3]];
        if (strncmp(word, "ok", 2) == 0 && !isnan(p.mu) && !isnan(p.theta_r) && !isnan(p.theta_t))
            (*piles)[(*n)++] = p;
    }
    free(block);
    qsort(*piles, *n, sizeof **piles, by_mu);
    return status;
}

/* One row for each run of equal mu. theta_r[n] and theta_t[n] are work space. */
static rp_status compare_groups(size_t n, const pile piles[], const compare_options *o, double theta_r[],
                                double theta_t[])
{
    gsl_rng *rng = rp_random_alloc((unsigned long)o->seed, 0, RP_PURPOSE_BOOTSTRAP);
    if (!rng) return rp_fail(RP_NO_MEMORY, "compare: out of memory");
    rp_status status = RP_OK;
    for (size_t first = 0, end; first < n && !status; first = end) {
        ang_comparison c;
        for (end = first; end < n && piles[end].mu == piles[first].mu; end++) {
            theta_r[end - first] = piles[end].theta_r;
            theta_t[end - first] = piles[end].theta_t;
        }
        status = ang_compare(end - first, theta_r, theta_t, piles[first].mu, o->phi_deg * deg,
                             (size_t)o->bootstrap, rng, &c);
        if (status)
            rp_prefix(status, "mu = %g: ", piles[first].mu);
        else
            print_comparison(piles[first].mu, &c);
    }
    gsl_rng_free(rng);
    return status;
}

static rp_status compare_table(rp_table *table, const void *values)
{
    const compare_options *o = values;
    pile *piles;
    size_t n;
    rp_status status = read_piles(table, &piles, &n);
    double *angles = malloc((2 * n + 1) * sizeof *angles);
    if (!status && !angles) status = rp_fail(RP_NO_MEMORY, "%s: out of memory", table->path);
    if (!status) {
        cli_table(stdout, compare_params, o);
        rp_table_note(stdout, "rows", "%zu used, %zu left out", n, table->n_rows - n);
        print_compare_header();
        status = n > 0 ? compare_groups(n, piles, o, angles, angles + n)
                       : rp_fail(RP_NO_RESULT, "no row with status ok and both angles");
        if (status) rp_prefix(status, "%s: ", table->path);
    }
    free(angles);
    free(piles);
    return status;
}

static rp_status compare(int argc, char **argv)
{
    compare_options o;
    return cli_with_table(&compare_command, argc, argv, &o, compare_table);
}

/* ---- phi ---- */

typedef struct {
    double from, to;
    long bootstrap, seed;
} phi_options;

static const rp_param phi_params[] = {
    {"from", "", RP_REAL, offsetof(phi_options, from), "0", "[0, inf)", "smallest mu that is used"},
    {"to", "", RP_REAL, offsetof(phi_options, to), "1e308", "(0, inf)", "largest mu that is used"},
    {"bootstrap", "", RP_INT, offsetof(phi_options, bootstrap), "1000", "[2, 10000000]",
     "resamples of the piles"},
    {"seed", "", RP_INT, offsetof(phi_options, seed), "1993", "[0, 2147483647]", "seed of the resamples"},
    {0}};

static const cli_command phi_command = {
    "angle phi",
    "FILE [options]",
    "Inclination phi of the rays at which (3), tan theta_MS = mu tan^2 phi, meets measured theta_R + "
    "theta_T,\n"
    "and (4) in its balanced and lattice forms measured theta_T: one phi for all mu (mu = nan), and one for\n"
    "each. against: the equation; ..._less_marginal: by how much phi of (4) exceeds that of (3), which "
    "cannot\n"
    "both hold with one phi for a pile that stands a tilt. The sine form is not fitted: phi would absorb "
    "the\n"
    "forces that it leaves unbalanced.\n"
    "FILE (- for standard input): as for repose angle compare; rows with mu = 0 are left out.\n"
    "phi_lo, phi_hi: 95 % interval where chi2 has risen by 3.84 (profile likelihood); boot_lo, boot_hi: by\n"
    "bootstrap over piles. p_value: chance of a larger chi2 if one phi serves all mu (of a difference: if "
    "there\n"
    "is none); below 0.05 it does not (one_phi 0), and the intervals are those of a compromise. open: -1, 1\n"
    "where the data give no bound on phi from below, from above, 2 from neither side: phi is not "
    "identified.\n"
    "measured: mean theta_R + theta_T or theta_T; fitted, sixty: the equation at the mean theta_R with the "
    "phi of\n"
    "all mu, and with 60 degrees.",
    "repose angle phi build/tables/lh3_runs.tsv",
    phi_params,
    1,
    1};

/* The measured angle that an equation is fitted to, the mean over piles, and what the equation gives for phi.
 */
static rp_status angles_of(const ang_piles *piles, ang_against against, double phi_all,
                           stats_summary *measured, double given[2])
{
    const bool marginal = against == ANG_AGAINST_MARGINAL;
    const double phis[2] = {phi_all, 60.0 * deg};
    stats_summary theta_r;
    rp_status status = stats_mean(piles->n, piles->theta_r, &theta_r);
    if (!status)
        status = stats_paired(piles->n, piles->theta_t, marginal ? 1.0 : 0.0,
                              marginal ? piles->theta_r : NULL, measured);
    for (int i = 0; i < 2 && !status; i++) {
        ang_form form = against == ANG_AGAINST_LATTICE ? ANG_LATTICE : ANG_BALANCED;
        ang_tilt_result tilt;
        status = ang_tilt(form, piles->mu, theta_r.mean, phis[i], &tilt);
        given[i] = marginal ? tilt.theta_ms : tilt.theta_t;
    }
    return status;
}

/* A fit to all groups (`piles` NULL) or to one, beside which stand its angles with the phi of all. */
static rp_status print_phi(const ang_piles *piles, size_t n_groups, size_t n, ang_against against,
                           const ang_phi *fit, double phi_all)
{
    stats_summary measured = {0, NAN, NAN, NAN, NAN, NAN};
    double given[2] = {NAN, NAN};
    int open = fit->lo_open && fit->hi_open ? 2 : (int)fit->hi_open - (int)fit->lo_open;
    rp_status status = RP_OK;
    if (piles && against < ANG_BALANCED_LESS_MARGINAL)
        status = angles_of(piles, against, phi_all, &measured, given);
    if (!status)
        rp_table_row_word(stdout, 17,
                          (double[]){piles ? piles->mu : NAN, (double)n_groups, (double)n, fit->phi / deg,
                                     fit->lo / deg, fit->hi / deg, fit->boot_lo / deg, fit->boot_hi / deg,
                                     fit->chi2, (double)fit->dof, fit->p_value,
                                     fit->dof > 0 ? fit->p_value >= 0.05 : NAN, open, measured.mean / deg,
                                     measured.se / deg, given[0] / deg, given[1] / deg},
                          ang_against_word(against));
    return status;
}

/* All groups together, then each alone. */
static rp_status fit_phis(size_t n_groups, const ang_piles groups[], const phi_options *o, gsl_rng *rng)
{
    rp_status status = RP_OK;
    size_t n_all = 0;
    ang_phi all[ANG_N_AGAINST], one[ANG_N_AGAINST];
    for (size_t i = 0; i < n_groups; i++) n_all += groups[i].n;
    status = ang_phi_fit(n_groups, groups, (size_t)o->bootstrap, rng, all);
    for (int a = 0; a < ANG_N_AGAINST && !status && n_groups > 1; a++)
        status = print_phi(NULL, n_groups, n_all, (ang_against)a, &all[a], NAN);
    for (size_t i = 0; i < n_groups && !status; i++) {
        status = ang_phi_fit(1, &groups[i], (size_t)o->bootstrap, rng, one);
        for (int a = 0; a < ANG_N_AGAINST && !status; a++)
            status = print_phi(&groups[i], 1, groups[i].n, (ang_against)a, &one[a], all[a].phi);
    }
    return status;
}

/* Groups of equal mu among the sorted piles; their angles are copied to `angles`, 2 n numbers. */
static rp_status group_piles(size_t n, const pile piles[], const phi_options *o, double angles[],
                             ang_piles groups[], size_t *n_groups)
{
    *n_groups = 0;
    for (size_t i = 0; i < n; i++) {
        angles[i] = piles[i].theta_r;
        angles[n + i] = piles[i].theta_t;
        if (piles[i].mu == 0.0 || piles[i].mu < o->from || piles[i].mu > o->to) continue;
        if (*n_groups == 0 || groups[*n_groups - 1].mu != piles[i].mu)
            groups[(*n_groups)++] = (ang_piles){piles[i].mu, 0, angles + i, angles + n + i};
        groups[*n_groups - 1].n++;
    }
    return *n_groups > 0 ? RP_OK
                         : rp_fail(RP_NO_RESULT, "no row with status ok, both angles, and mu in range");
}

static rp_status phi_table(rp_table *table, const void *values)
{
    const phi_options *o = values;
    static const char *const columns[][2] = {{"mu", ""},
                                             {"n_mu", ""},
                                             {"n", ""},
                                             {"phi_deg", "deg"},
                                             {"phi_lo_deg", "deg"},
                                             {"phi_hi_deg", "deg"},
                                             {"boot_lo_deg", "deg"},
                                             {"boot_hi_deg", "deg"},
                                             {"chi2", ""},
                                             {"dof", ""},
                                             {"p_value", ""},
                                             {"one_phi", ""},
                                             {"open", ""},
                                             {"measured_deg", "deg"},
                                             {"measured_se_deg", "deg"},
                                             {"fitted_deg", "deg"},
                                             {"sixty_deg", "deg"},
                                             {"against", ""}};
    pile *piles;
    size_t n, n_groups;
    rp_status status = read_piles(table, &piles, &n);
    double *angles = malloc((2 * table->n_rows + 1) * sizeof *angles);
    ang_piles *groups = malloc((table->n_rows + 1) * sizeof *groups);
    gsl_rng *rng = rp_random_alloc((unsigned long)o->seed, 0, RP_PURPOSE_BOOTSTRAP);
    if (!status && !(angles && groups && rng))
        status = rp_fail(RP_NO_MEMORY, "%s: out of memory", table->path);
    if (!status) {
        cli_table(stdout, phi_params, o);
        rp_table_note(stdout, "rows", "%zu used, %zu left out", n, table->n_rows - n);
        rp_table_columns(stdout, N_OF(columns), columns);
        status = group_piles(n, piles, o, angles, groups, &n_groups);
        if (!status) status = fit_phis(n_groups, groups, o, rng);
        if (status) rp_prefix(status, "%s: ", table->path);
    }
    if (rng) gsl_rng_free(rng);
    free(groups);
    free(angles);
    free(piles);
    return status;
}

static rp_status phi(int argc, char **argv)
{
    phi_options o;
    return cli_with_table(&phi_command, argc, argv, &o, phi_table);
}

/* ---- fit ---- */

typedef struct {
    const char *x, *y, *se;
    double from, to, level;
    bool successive;
} fit_options;

static const rp_param fit_params[] = {
    {"x", "", RP_TEXT, offsetof(fit_options, x), NULL, "", "column of x"},
    {"y", "", RP_TEXT, offsetof(fit_options, y), NULL, "", "column of y"},
    {"se", "", RP_TEXT, offsetof(fit_options, se), NULL, "", "column of the standard errors of y"},
    {"from", "", RP_REAL, offsetof(fit_options, from), "-1e308", "(-inf, inf)", "smallest x that is used"},
    {"to", "", RP_REAL, offsetof(fit_options, to), "1e308", "(-inf, inf)", "largest x that is used"},
    {"successive", "", RP_BOOL, offsetof(fit_options, successive), "false", "",
     "where linearity ends: one row for the first three points, the first four, ..."},
    {"level", "", RP_REAL, offsetof(fit_options, level), "0.05", "(0, 1)",
     "smallest p with which a line is accepted, for --successive"},
    {0}};

static const cli_command fit_command = {
    "angle fit",
    "FILE --x COLUMN --y COLUMN --se COLUMN [options]",
    "Straight line through points with standard errors, weights 1/se^2: y = intercept + slope x, and the "
    "line\n"
    "through the origin. Errors follow from se, not rescaled; p_value: chance of a larger chi2.\n"
    "--successive orders the points by x and adds one after the other. bend: coefficient of x^2 of the\n"
    "parabola, p_bend its two-sided p. linear_to, bend_free_to (header): largest x up to which every line "
    "has\n"
    "p_value, or p_bend, of at least --level; nan if there is none.\n"
    "FILE (- for standard input): columns by name, or 1, 2, ... without header; rows with nan are left out.",
    "repose angle fit build/tables/lh3.tsv --x mu --y theta_r3_deg_mean --se theta_r3_deg_se --to 0.2",
    fit_params,
    1,
    1};

/* Pack the usable points of the blocks x, y, se of n values each to their fronts. */
static size_t select_points(size_t n, double *block, const fit_options *o, size_t *n_missing)
{
    size_t used = 0;
    *n_missing = 0;
    for (size_t i = 0; i < n; i++) {
        double x = block[i], y = block[n + i], se = block[2 * n + i];
        bool missing = isnan(x) || isnan(y) || isnan(se);
        *n_missing += missing;
        if (missing || x < o->from || x > o->to) continue;
        block[used] = x;
        block[n + used] = y;
        block[2 * n + used++] = se;
    }
    return used;
}

/* The points in order of x: blocks of n values, of which `used` count. */
static rp_status sort_points(size_t n, size_t used, double *block)
{
    size_t *order = malloc((used + 1) * sizeof *order);
    double *sorted = malloc((used + 1) * sizeof *sorted);
    if (order && sorted) {
        gsl_sort_index(order, block, 1, used);
        for (size_t c = 3; c-- > 0;) { /* x last: the order is found from it */
            for (size_t i = 0; i < used; i++) sorted[i] = block[c * n + order[i]];
            memcpy(block + c * n, sorted, used * sizeof *sorted);
        }
    }
    rp_status status = order && sorted ? RP_OK : rp_fail(RP_NO_MEMORY, "fit: out of memory");
    free(order);
    free(sorted);
    return status;
}

typedef struct {
    stats_line line;
    stats_contrast bend;
    double p_bend;
} prefix_fit;

/* Fits of the first three points, the first four, ...; fits[k] has k + 3 points. */
static rp_status fit_prefixes(size_t n, const double x[], const double y[], const double se[],
                              prefix_fit fits[])
{
    for (size_t k = 0; k + 3 <= n; k++) {
        rp_status status = stats_line_fit(k + 3, x, y, se, false, &fits[k].line);
        if (!status) status = stats_bend(k + 3, x, y, se, &fits[k].bend);
        if (status) return status;
        fits[k].p_bend = stats_contrast_p(&fits[k].bend);
    }
    return RP_OK;
}

static rp_status print_successive(size_t n, const double x[], const double y[], const double se[],
                                  double level)
{
    static const char *const columns[][2] = {
        {"x_to", "x"},         {"n", ""},      {"slope", "y/x"}, {"slope_se", "y/x"}, {"intercept", "y"},
        {"intercept_se", "y"}, {"chi2", ""},   {"dof", ""},      {"p_value", ""},     {"bend", "y/x^2"},
        {"bend_se", "y/x^2"},  {"p_bend", ""}, {"status", ""}};
    if (n < 3) return rp_fail(RP_NO_RESULT, "%zu points, at least 3 needed", n);
    prefix_fit *fits = malloc(n * sizeof *fits);
    if (!fits) return rp_fail(RP_NO_MEMORY, "fit: out of memory");
    rp_status status = fit_prefixes(n, x, y, se, fits);
    double to[2] = {NAN, NAN};
    bool holds[2] = {true, true};
    for (size_t k = 0; k + 3 <= n && !status; k++) {
        const double p[2] = {fits[k].line.p_value, fits[k].p_bend};
        for (int i = 0; i < 2; i++)
            if ((holds[i] = holds[i] && p[i] >= level)) to[i] = x[k + 2];
    }
    if (!status) {
        rp_table_note(stdout, "linear_to", "%g", to[0]);
        rp_table_note(stdout, "bend_free_to", "%g", to[1]);
        rp_table_columns(stdout, N_OF(columns), columns);
    }
    for (size_t k = 0; k + 3 <= n && !status; k++) {
        const stats_line *l = &fits[k].line;
        const stats_contrast *bend = &fits[k].bend;
        rp_table_row_word(stdout, N_OF(columns) - 1,
                          (double[]){x[k + 2], (double)l->n, l->slope, l->slope_se, l->intercept,
                                     l->intercept_se, l->chi2, (double)l->dof, l->p_value, bend->value,
                                     bend->se, fits[k].p_bend},
                          l->p_value < level || fits[k].p_bend < level ? "curved" : "ok");
    }
    free(fits);
    return status;
}

static rp_status print_fit(size_t n, const double x[], const double y[], const double se[])
{
    static const char *const columns[][2] = {
        {"slope", "y/x"},      {"slope_se", "y/x"},     {"intercept", "y"},
        {"intercept_se", "y"}, {"covariance", "y^2/x"}, {"chi2", ""},
        {"dof", ""},           {"p_value", ""},         {"n", ""},
        {"line", ""}};
    stats_line lines[2];
    for (int i = 0; i < 2; i++) {
        rp_status status = stats_line_fit(n, x, y, se, i == 1, &lines[i]);
        if (status) return status;
    }
    rp_table_columns(stdout, N_OF(columns), columns);
    for (int i = 0; i < 2; i++) {
        const stats_line *l = &lines[i];
        rp_table_row_word(stdout, N_OF(columns) - 1,
                          (double[]){l->slope, l->slope_se, l->intercept, l->intercept_se, l->covariance,
                                     l->chi2, (double)l->dof, l->p_value, (double)l->n},
                          i == 1 ? "origin" : "free");
    }
    return RP_OK;
}

static rp_status fit_table(rp_table *table, const void *values)
{
    const fit_options *o = values;
    const char *const names[] = {o->x, o->y, o->se};
    int columns[3];
    double *block = NULL;
    size_t n = table->n_rows, missing;
    rp_status status = cli_find_columns(table, 3, names, columns);
    if (!status) status = cli_read_columns(table, 3, columns, 1, &block);
    if (!status) {
        size_t used = select_points(n, block, o, &missing);
        cli_table(stdout, fit_params, o);
        rp_table_note(stdout, "rows", "%zu used, %zu left out for nan, %zu outside the range of x", used,
                      missing, n - used - missing);
        if (o->successive) status = sort_points(n, used, block);
        if (!status)
            status = o->successive ? print_successive(used, block, block + n, block + 2 * n, o->level)
                                   : print_fit(used, block, block + n, block + 2 * n);
        if (status) rp_prefix(status, "%s: ", table->path);
    }
    free(block);
    return status;
}

static rp_status fit(int argc, char **argv)
{
    fit_options o;
    return cli_with_table(&fit_command, argc, argv, &o, fit_table);
}

/* ---- maximum ---- */

typedef struct {
    const char *column;
    long draws, bootstrap, seed;
} maximum_options;

static const rp_param maximum_params[] = {
    {"column", "", RP_TEXT, offsetof(maximum_options, column), NULL, "", "column of the values"},
    {"draws", "", RP_INT, offsetof(maximum_options, draws), NULL, "[1, 10000000]",
     "values that the maximum is taken of"},
    {"bootstrap", "", RP_INT, offsetof(maximum_options, bootstrap), "2000", "[2, 10000000]",
     "resamples of the values"},
    {"seed", "", RP_INT, offsetof(maximum_options, seed), "1993", "[0, 2147483647]", "seed of the resamples"},
    {0}};

static const cli_command maximum_command = {
    "angle maximum",
    "FILE --column COLUMN --draws N [options]",
    "Expected largest of N of a column's values, so that maxima of ensembles of different size compare;\n"
    "maximum_se: bootstrap over the values. FILE (- for standard input): columns by name, or 1, 2, ...\n"
    "without header; rows with nan are left out.",
    "repose angle maximum piles.tsv --column theta_r3_deg --draws 10",
    maximum_params,
    1,
    1};

static rp_status print_maximum(size_t n, const double v[], double work[], const maximum_options *o)
{
    static const char *const columns[][2] = {{"n", ""},     {"mean", ""},    {"sd", ""},
                                             {"draws", ""}, {"maximum", ""}, {"maximum_se", ""}};
    stats_summary stats, resampled;
    double largest, *sample = work + n, *maxima = sample + n;
    rp_status status = stats_mean(n, v, &stats);
    if (!status) status = stats_expected_maximum(n, v, (size_t)o->draws, work, &largest);
    gsl_rng *rng = rp_random_alloc((unsigned long)o->seed, 0, RP_PURPOSE_BOOTSTRAP);
    if (!status && !rng) status = rp_fail(RP_NO_MEMORY, "maximum: out of memory");
    for (long b = 0; !status && b < o->bootstrap; b++) {
        for (size_t i = 0; i < n; i++) sample[i] = v[gsl_rng_uniform_int(rng, n)];
        status = stats_expected_maximum(n, sample, (size_t)o->draws, work, &maxima[b]);
    }
    if (rng) gsl_rng_free(rng);
    if (!status) status = stats_mean((size_t)o->bootstrap, maxima, &resampled);
    if (status) return status;
    rp_table_columns(stdout, N_OF(columns), columns);
    rp_table_row(stdout, N_OF(columns),
                 (double[]){(double)n, stats.mean, stats.sd, (double)o->draws, largest, resampled.sd});
    return RP_OK;
}

static rp_status maximum_of_table(rp_table *table, const void *options)
{
    const maximum_options *o = options;
    int column;
    double *values = NULL;
    rp_status status = cli_find_columns(table, 1, &o->column, &column);
    if (!status) status = cli_read_columns(table, 1, &column, 1, &values);
    double *work = malloc((2 * table->n_rows + (size_t)o->bootstrap) * sizeof *work);
    if (!status && !work) status = rp_fail(RP_NO_MEMORY, "%s: out of memory", table->path);
    if (!status) {
        size_t n = 0;
        for (size_t i = 0; i < table->n_rows; i++)
            if (!isnan(values[i])) values[n++] = values[i];
        cli_table(stdout, maximum_params, o);
        rp_table_note(stdout, "rows", "%zu used, %zu left out for nan", n, table->n_rows - n);
        status = print_maximum(n, values, work, o);
        if (status) rp_prefix(status, "%s: ", table->path);
    }
    free(work);
    free(values);
    return status;
}

static rp_status maximum(int argc, char **argv)
{
    maximum_options o;
    return cli_with_table(&maximum_command, argc, argv, &o, maximum_of_table);
}

/* ---- dispatch ---- */

static const struct {
    const char *name;
    rp_status (*function)(int, char **);
    const char *summary;
} commands[] = {
    {"marginal", marginal, "angle of marginal stability, (3)"},
    {"tilt", tilt, "tilt at which a pile slides, (4)"},
    {"slope", slope, "slope of a table of grains by three methods"},
    {"compare", compare, "measured angles against (3) and (4)"},
    {"phi", phi, "inclination of the rays, fitted to measured angles"},
    {"stress", cmd_angle_stress, "stress field and base forces of piles, from their contacts"},
    {"critical", cmd_angle_critical, "tilt at which the measured stress reaches Coulomb's law"},
    {"fit", fit, "weighted straight line through a table"},
    {"maximum", maximum, "expected largest of a number of values"},
    {"trend", cmd_angle_trend, "does a column of a table of runs depend on another?"},
    {"size", cmd_angle_size, "limit of infinite size, from a table of runs"},
    {"dip", cmd_angle_dip, "does the pressure on the base of dropped piles dip in the middle?"},
};

rp_status cmd_angle(int argc, char **argv)
{
    if (argc < 2) return rp_fail(RP_USAGE, "which one? see repose angle --help");
    for (size_t i = 0; i < N_OF(commands); i++)
        if (strcmp(argv[1], commands[i].name) == 0) return commands[i].function(argc - 1, argv + 1);
    if (strcmp(argv[1], "--help") != 0)
        return rp_fail(RP_USAGE, "unknown command \"%s\"; see repose angle --help", argv[1]);
    printf("usage: repose angle COMMAND [options]; repose angle COMMAND --help says more\n\n");
    for (size_t i = 0; i < N_OF(commands); i++) printf("  %-10s %s\n", commands[i].name, commands[i].summary);
    return RP_OK;
}
