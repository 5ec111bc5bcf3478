/* repose stress dip: does the pressure on the base of piles dip in the middle? */
#include "cli/derive/derive.h"
#include "stress/stress.h"

#define DIP_OPTIONS(X)                                                                                       \
    X(REAL, margin, "", "0.05", "(0, inf)", "largest |middle| that counts as none")                          \
    X(REAL, level, "", "0.05", "(0, 0.5)", "significance level of the tests")                                \
    X(BOOL, profile, "", "false", "", "print the mean profile with its band")                                \
    CLI_WHERE(X)

CLI_OPTIONS(dip, DIP_OPTIONS)

#define BIN_NAME(k)  "n_" #k ","
#define RAYS_NAME(k) "rays_" #k ","

enum { HALF = STRESS_DIP_BINS / 2 };

/* Mean profile of rays over both sides and all piles; NaN where the table has none. */
static rp_status read_rays(rp_arena *arena, const rp_table *t, double rays[HALF])
{
    rp_rows rows;
    for (int k = 0; k < HALF; k++) rays[k] = NAN;
    if (rp_table_column(t, "rays_01") < 0) return RP_OK;
    RP_TRY(rp_rows_read(arena, t, STRESS_DIP_BIN_LIST(RAYS_NAME) "excess", &(rp_choice){0}, &rows));
    for (int k = 0; k < HALF; k++) {
        rays[k] = 0.0;
        for (size_t i = 0; i < rows.n; i++)
            rays[k] += 0.5 * (rows.column[HALF - 1 - k][i] + rows.column[HALF + k][i]) / (double)rows.n;
    }
    return RP_OK;
}

static void print_dip(const cli_call *call, const stress_dips *d, const dip_options *o, const char *failed)
{
    const stats_summary *m = &d->middle, *e = &d->excess;
    rp_table_header(call->out, call->units,
                    "n, middle, middle_se, middle_sd, middle_lo, middle_hi, p_value, p_margin, below, "
                    "below_se, excess, excess_se, excess_sd, excess_lo, excess_hi, " RP_FAILED_COLUMNS
                    ", verdict");
    CLI_ROW_WORD(rp_text(call->arena, "%s\t%s", failed, stress_dip_word(d, o->level)), (double)m->n, m->mean,
                 m->se, m->sd, m->lo, m->hi, d->p_value, d->p_margin, d->below, d->below_se, e->mean, e->se,
                 e->sd, e->lo, e->hi);
}

static rp_status dip_of_table(cli_call *call, rp_table *table, const void *values)
{
    const dip_options *o = values;
    rp_rows piles;
    stress_dips dips;
    double rays[HALF];
    RP_TRY(rp_rows_read(call->arena, table, STRESS_DIP_BIN_LIST(BIN_NAME) "excess", &(rp_choice){0}, &piles));
    double *profiles = rp_arena_memory(call->arena, piles.n * STRESS_DIP_BINS, sizeof *profiles);
    for (size_t i = 0; i < piles.n; i++) {
        double sum = 0.0;
        for (int k = 0; k < STRESS_DIP_BINS; k++)
            sum += profiles[i * STRESS_DIP_BINS + (size_t)k] = piles.column[k][i];
        if (!(sum > 0.0))
            return rp_fail(RP_BAD_INPUT, "%s:%zu: n_01 to n_20: sum = %g: out of range, allowed: (0, inf)",
                           RP_PLACE(table, piles.row[i]), sum);
    }
    RP_TRY(read_rays(call->arena, table, rays));
    RP_TRY(rp_prefix(stress_dip_ensemble(piles.n, profiles, piles.column[STRESS_DIP_BINS], o->margin, &dips),
                     "%s: ", table->path));
    cli_table(call, call->out);
    rp_table_note(call->out, "rows", "%zu used, %zu left out", piles.n, table->n_rows - piles.n);
    if (!o->profile) {
        print_dip(call, &dips, o, rp_failed_text(call->arena, table, NULL, 0, NULL, NULL));
        return RP_OK;
    }
    rp_table_header(call->out, call->units, "distance [B], N [mean], N_se [mean], rays [mean]");
    for (int k = 0; k < HALF; k++) CLI_ROW((k + 0.5) / STRESS_DIP_BINS, dips.N[k], dips.N_se[k], rays[k]);
    return RP_OK;
}

const cli_command cmd_stress_dip = {
    "stress dip",
    "does the pressure on the base dip in the middle?",
    "TABLE [options]",
    "Tests whether the pressure N on the base of many piles has a minimum in the middle. B is the base that "
    "holds 98 % of the load, and distances are from the centroid of the load; both are fixed before N is "
    "examined.\n"
    "  middle  mean N within 0.1 B minus the mean from 0.1 to 0.2 B, over the mean N:\n"
    "          negative for a dip. Errors and 95 % intervals are over piles. p_value\n"
    "          is the probability of a mean as far from 0, p_margin that of the\n"
    "          equivalence test (TOST) with the margin, and below the fraction of\n"
    "          piles in which middle is negative\n"
    "  excess  mean within 0.1 B of N minus the pressure of 60-degree rays under the\n"
    "          piles' own outlines, over the mean N. It is near 0 if the outline\n"
    "          makes the dip\n"
    "The verdict on middle is dip or peak if p_value < level; none_within_margin if p_margin < level; "
    "dip_within_margin or peak_within_margin if both; otherwise undecided. --profile prints the mean N of "
    "both sides in bins of 0.05 B, and that of the rays.\n"
    "\n"
    "TABLE (- for standard input) has one row for each pile, with columns n_01 to n_20, excess and status, "
    "as `repose sweep export` writes it for the protocols drop and pile. Rows whose status is not ok are "
    "left out.",
    "repose stress dip build/tables/li20_point_runs.tsv",
    dip_params,
    .refuses = "A table without columns n_01 to n_20 and excess. Fewer than 3 piles: exit status 1.",
    .derives = true,
    .on_table = dip_of_table};
