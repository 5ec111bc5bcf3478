/* repose stress dip: does the pressure on the base of dropped piles dip in the middle? */
#include "sweeps/driver/pile.h"
#include "cli/cli.h"

enum { TRIANGLE, ZERO };

#define DIP_OPTIONS(X)                                                                                       \
    X(REAL, margin, "", "0.1", "(0, inf)", "largest |D| that counts as none")                                \
    X(REAL, level, "", "0.05", "(0, 0.5)", "of the tests")                                                   \
    X(INT, resamples, "", "10000", "[2, 10000000]", "of the piles")                                          \
    CLI_SEED(X, "1992", "seed of the resamples")                                                             \
    X(CHOICE, against, "", "triangle", "triangle | zero", "what a pile without a dip has")                   \
    X(BOOL, profile, "", "false", "", "print the mean profile")                                              \
    CLI_WHERE(X)

CLI_OPTIONS(dip, DIP_OPTIONS)

/* Profiles of the rows that count, one after the other, and what each has without a dip. */
static rp_status read_profiles(const rp_table *t, int against, double **profiles, double **without, size_t *n)
{
#define NAME(k) "n_" #k ","
    cli_rows rows;
    rp_status status = cli_rows_read(t, STRESS_DIP_BIN_LIST(NAME) "left_deg,right_deg",
                                     &(cli_choice){.any_number = true}, &rows);
#undef NAME
    *n = 0;
    *profiles = cli_memory(rows.n * STRESS_DIP_BINS, sizeof **profiles);
    *without = cli_memory(rows.n * STRESS_DIP_BINS, sizeof **without);
    for (size_t i = 0; i < rows.n && !status; i++) {
        double *N = *profiles + *n * STRESS_DIP_BINS, *flat = *without + *n * STRESS_DIP_BINS;
        const double slope = 0.5 * (rows.column[STRESS_DIP_BINS][i] + rows.column[STRESS_DIP_BINS + 1][i]);
        if (against == TRIANGLE && !(slope > 0.0 && slope < 60.0)) continue; /* no triangle is like it */
        for (size_t k = 0; k < STRESS_DIP_BINS; k++) N[k] = rows.column[k][i], flat[k] = 1.0;
        if (against == TRIANGLE) status = sweep_outline_triangle(slope * deg, flat);
        if (status) rp_prefix(status, "%s: pile %zu: ", t->path, i + 1);
        ++*n;
    }
    return status;
}

static void print_dip(const stress_dips *d, const dip_options *o)
{
    rp_table_note(stdout, "D", "%s",
                  o->against == TRIANGLE
                      ? "the excess D_raw - D_reference, over the triangle of the pile's slope"
                      : "D_raw, with nothing taken off");
    rp_table_header(stdout,
                    "n, D_raw, D_reference, D, D_se, D_sd, D_lo, D_hi, null_lo, null_hi, p_value, p_dip, "
                    "p_margin, verdict");
    CLI_ROW_WORD(stress_dip_word(d, o->level), (double)d->dip.n, d->raw, d->raw - d->dip.mean, d->dip.mean,
                 d->dip.se, d->dip.sd, d->dip.lo, d->dip.hi, d->null_lo, d->null_hi, d->p_value, d->p_dip,
                 d->p_margin);
}

static void print_profile(const stress_dips *d)
{
    rp_table_header(stdout, "distance [B], N [mean], N_se [mean]");
    for (int k = 0; k < STRESS_DIP_BINS / 2; k++) CLI_ROW((k + 0.5) / STRESS_DIP_BINS, d->N[k], d->N_se[k]);
}

static rp_status dip_of_table(rp_table *table, void *values)
{
    const dip_options *o = values;
    double *profiles = NULL, *without = NULL;
    size_t n;
    stress_dips dips;
    rp_status status = read_profiles(table, o->against, &profiles, &without, &n);
    if (status) return status;
    double *means = cli_memory((size_t)o->resamples, sizeof *means);
    status = stress_dip_ensemble(n, profiles, without, o->margin, (size_t)o->resamples, cli_random(0), means,
                                 &dips);
    if (status) return rp_prefix(status, "%s: ", table->path);
    cli_table(stdout);
    rp_table_note(stdout, "rows", "%zu used, %zu left out", n, table->n_rows - n);
    if (o->profile)
        print_profile(&dips);
    else
        print_dip(&dips, o);
    return RP_OK;
}

const cli_command cmd_stress_dip = {
    "stress dip",
    "does the pressure on the base dip in the middle?",
    "TABLE [options]",
    "Tests the pressure N on the base of many piles for a dip in the middle.\n"
    "\n"
    "D_raw is the mean of N within 0.1 B of the centroid of the load, less the mean of N from there to\n"
    "0.3 B, over the mean of N; B is the base. The outer region reaches down the flanks, so that D_raw\n"
    "of a pile without a dip is not 0. D_reference is D of the continuum triangle with the pile's own\n"
    "mean slope. D is the excess D_raw - D_reference (the report's D_excess); a dip makes it negative.\n"
    "With --against zero, D is D_raw itself.\n"
    "\n"
    "Errors and 95 % intervals are over piles. null_lo and null_hi bound 95 % of the mean D of as many\n"
    "piles without a dip. p_value is the chance that such piles have a D as far from 0, p_dip that they\n"
    "have one as low. p_margin belongs to the test of equivalence (TOST) with the margin.\n"
    "\n"
    "The verdict is dip or peak if p_value < level; none_within_margin if p_margin < level;\n"
    "dip_within_margin or peak_within_margin if both; else undecided. --profile prints the mean N of\n"
    "both halves, outwards: distance over B, N over its mean, standard error.\n"
    "\n"
    "TABLE (- for standard input) has one row per pile with columns n_01 to n_20, left_deg, right_deg\n"
    "and status, as repose sweep export writes it for the protocols drop and pile. Rows whose status is\n"
    "not ok are left out. The test against the triangle also leaves out mean slopes outside (0, 60).",
    "repose stress dip build/tables/li20_point_runs.tsv",
    dip_params,
    .on_table = dip_of_table};
