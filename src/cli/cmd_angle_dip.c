/* repose angle dip: does the pressure on the base of dropped piles dip in the middle? */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "angle/dip.h"
#include "cli/cli.h"
#include "cli/cmd_angle.h"
#include "core/random.h"

#define N_OF(array) (sizeof(array) / sizeof *(array))

typedef struct {
    double margin, level;
    long resamples, seed;
    bool profile;
} options;

static const rp_param params[] = {
    {"margin", "", RP_REAL, offsetof(options, margin), "0.1", "(0, inf)", "largest |D| that counts as none"},
    {"level", "", RP_REAL, offsetof(options, level), "0.05", "(0, 0.5)", "of the tests"},
    {"resamples", "", RP_INT, offsetof(options, resamples), "10000", "[2, 10000000]", "of the piles"},
    {"seed", "", RP_INT, offsetof(options, seed), "1992", "[0, 2147483647]", "seed of the resamples"},
    {"profile", "", RP_BOOL, offsetof(options, profile), "false", "", "print the mean profile"},
    {0}};

static const cli_command command = {
    "angle dip",
    "TABLE [options]",
    "Mean N on the base within 0.1 B of the centroid of the load, less that from there to 0.3 B, over the "
    "mean\n"
    "N: D, negative for a dip, with SE and 95 % interval over piles. null_lo, null_hi: 95 % of the mean D "
    "of\n"
    "such piles without dip; p_value, p_dip: chance of a D as far from 0, as low, in these; p_margin: TOST,\n"
    "chance of so small a D if it were the margin. verdict: dip or peak if p_value < level; "
    "none_within_margin\n"
    "if p_margin < level; dip_within_margin or peak_within_margin if both; undecided. With --profile the "
    "mean\n"
    "of both sides, outwards: distance over B, N over the mean, SE. TABLE (- for standard input): one row a\n"
    "pile, columns n_01 to n_20, status, as repose sweep export writes for protocol drop; rows whose status\n"
    "is not ok are left out.",
    "repose angle dip build/tables/li20_point_runs.tsv",
    params,
    1,
    1};

/* Profiles of the rows that count, one after the other. */
static rp_status read_profiles(const rp_table *t, double **profiles, size_t *n)
{
    char names[ANG_DIP_BINS][16];
    const char *columns_of[ANG_DIP_BINS];
    int columns[ANG_DIP_BINS], status_column;
    double *block = NULL;
    for (int k = 0; k < ANG_DIP_BINS; k++) {
        snprintf(names[k], sizeof names[k], "n_%02d", k + 1);
        columns_of[k] = names[k];
    }
    *n = 0;
    *profiles = malloc((t->n_rows + 1) * ANG_DIP_BINS * sizeof **profiles);
    if (!*profiles) return rp_fail(RP_NO_MEMORY, "%s: out of memory", t->path);
    rp_status status = cli_find_columns(t, ANG_DIP_BINS, columns_of, columns);
    if (!status) status = cli_find_columns(t, 1, (const char *const[]){"status"}, &status_column);
    if (!status) status = cli_read_columns(t, ANG_DIP_BINS, columns, 1, &block);
    for (size_t i = 0; i < t->n_rows && !status; i++) {
        if (strcmp(t->cells[i * t->n_columns + (size_t)status_column], "ok") != 0) continue;
        for (size_t k = 0; k < ANG_DIP_BINS; k++)
            (*profiles)[*n * ANG_DIP_BINS + k] = block[k * t->n_rows + i];
        ++*n;
    }
    free(block);
    return status;
}

static const char *verdict(const ang_dips *d, double level)
{
    const bool differs = d->p_value < level, within = d->p_margin < level;
    if (!differs) return within ? "none_within_margin" : "undecided";
    if (d->dip.mean < 0.0) return within ? "dip_within_margin" : "dip";
    return within ? "peak_within_margin" : "peak";
}

static void print_dip(const ang_dips *d, double level)
{
    static const char *const columns[][2] = {
        {"n", ""},       {"D", ""},       {"D_se", ""},    {"D_sd", ""},  {"D_lo", ""},     {"D_hi", ""},
        {"null_lo", ""}, {"null_hi", ""}, {"p_value", ""}, {"p_dip", ""}, {"p_margin", ""}, {"verdict", ""}};
    rp_table_columns(stdout, N_OF(columns), columns);
    rp_table_row_word(stdout, N_OF(columns) - 1,
                      (double[]){(double)d->dip.n, d->dip.mean, d->dip.se, d->dip.sd, d->dip.lo, d->dip.hi,
                                 d->null_lo, d->null_hi, d->p_value, d->p_dip, d->p_margin},
                      verdict(d, level));
}

static void print_profile(const ang_dips *d)
{
    static const char *const columns[][2] = {{"distance", "B"}, {"N", "mean"}, {"N_se", "mean"}};
    rp_table_columns(stdout, N_OF(columns), columns);
    for (int k = 0; k < ANG_DIP_BINS / 2; k++)
        rp_table_row(stdout, 3, (double[]){(k + 0.5) / ANG_DIP_BINS, d->N[k], d->N_se[k]});
}

static rp_status dip_of_table(rp_table *table, const void *values)
{
    const options *o = values;
    double *profiles = NULL, *means = malloc((size_t)o->resamples * sizeof *means);
    size_t n;
    ang_dips dips;
    gsl_rng *rng = rp_random_alloc((unsigned long)o->seed, 0, RP_PURPOSE_BOOTSTRAP);
    rp_status status = means && rng ? RP_OK : rp_fail(RP_NO_MEMORY, "dip: out of memory");
    if (!status) status = read_profiles(table, &profiles, &n);
    if (!status) {
        status = ang_dip_ensemble(n, profiles, o->margin, (size_t)o->resamples, rng, means, &dips);
        if (status) rp_prefix(status, "%s: ", table->path);
    }
    if (!status) {
        cli_table(stdout, params, o);
        rp_table_note(stdout, "rows", "%zu used, %zu left out", n, table->n_rows - n);
        if (o->profile)
            print_profile(&dips);
        else
            print_dip(&dips, o->level);
    }
    if (rng) gsl_rng_free(rng);
    free(means);
    free(profiles);
    return status;
}

rp_status cmd_angle_dip(int argc, char **argv)
{
    options o;
    return cli_with_table(&command, argc, argv, &o, dip_of_table);
}
