/* repose angle compare, repose angle phi: measured piles against (3) and (4). */
#include <float.h>

#include "angle/angle.h"
#include "cli/derive/derive.h"

/* ---- compare ---- */

#define COMPARE_OPTIONS(X)                                                                                   \
    CLI_PHI(X)                                                                                               \
    CLI_BOOTSTRAP(X, "2000")                                                                                 \
    CLI_WHERE(X)

CLI_OPTIONS(compare, COMPARE_OPTIONS)

/* Piles ordered by mu: mu, theta_r, theta_t. */
static rp_status read_piles(rp_arena *arena, const rp_table *table, rp_rows *piles)
{
    RP_TRY(rp_rows_read(arena, table, "mu,theta_r3_deg,theta_t_displacement_deg",
                        &(rp_choice){.grouped = true}, piles));
    for (size_t i = 0; i < piles->n; i++) piles->column[1][i] *= deg, piles->column[2][i] *= deg;
    return RP_OK;
}

static void print_compare_header(void)
{
    static const char *const parts[] = {"theta_t", "diff", "theta_rt", "gain"};
    char text[4096];
    size_t used = (size_t)snprintf(
        text, sizeof text,
        "mu, n, theta_r_deg [deg], theta_r_se_deg [deg], theta_t_deg [deg], "
        "theta_t_se_deg [deg], theta_rt_deg [deg], theta_rt_se_deg [deg], theta_ms_deg [deg], "
        "diff_ms_deg [deg], diff_ms_se_deg [deg], n_unstable, n_lost");
    for (int f = 0; f < ANG_N_FORMS; f++) {
        const char *form = ang_form_words[f];
        for (size_t k = 0; k < N_OF(parts); k++)
            used += (size_t)snprintf(text + used, sizeof text - used, ", %s_%s_deg [deg], %s_%s_se_deg [deg]",
                                     parts[k], form, parts[k], form);
        used += (size_t)snprintf(text + used, sizeof text - used, ", gain_relative_%s, gain_relative_%s_se",
                                 form, form);
    }
    snprintf(text + used, sizeof text - used, ", " CLI_FAILED_COLUMNS ", status");
    rp_table_header(stdout, text);
}

static void print_comparison(rp_arena *arena, double mu, const ang_comparison *c, const char *failed)
{
    enum { N_HEAD = 13, N_FORM = 10 };
    double v[N_HEAD + ANG_N_FORMS * N_FORM] = {mu,
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
                                               (double)c->n_lost},
                                    *next = v + N_HEAD;
    ang_tilt_status worst = ANG_TILT_OK;
    for (int f = 0; f < ANG_N_FORMS; f++) {
        const stats_number angles[] = {c->form[f].theta_t, c->form[f].diff, c->form[f].theta_rt,
                                       c->form[f].gain};
        for (size_t k = 0; k < N_OF(angles); k++)
            *next++ = angles[k].value / deg, *next++ = angles[k].se / deg;
        *next++ = c->form[f].gain_relative.value;
        *next++ = c->form[f].gain_relative.se;
        if (worst == ANG_TILT_OK) worst = c->form[f].status;
    }
    rp_table_row_word(stdout, N_OF(v), v, rp_text(arena, "%s\t%s", failed, ang_tilt_words[worst]));
}

static rp_status compare_table(cli_call *call, rp_table *table, const void *values)
{
    const compare_options *o = values;
    rp_rows piles;
    RP_TRY(read_piles(call->arena, table, &piles));
    gsl_rng *rng = cli_random(call, 0);
    cli_table(call, stdout);
    rp_rows_note(table, &piles);
    print_compare_header();
    for (size_t g = 0; g < piles.n_groups; g++) {
        const size_t first = piles.first[g];
        const ang_piles of = {piles.column[0][first], piles.first[g + 1] - first, piles.column[1] + first,
                              piles.column[2] + first};
        ang_comparison c;
        RP_TRY(rp_prefix(ang_compare(&of, o->phi_deg * deg, (size_t)o->bootstrap, rng, &c),
                         "%s: mu = %g: ", table->path, of.mu));
        print_comparison(call->arena, of.mu, &c,
                         cli_failed(call->arena, table, NULL, 0, "mu", (double[]){of.mu, of.mu}));
    }
    return RP_OK;
}

const cli_command cmd_angle_compare = {
    "angle compare",
    "measured angles against (3) and (4)",
    "FILE [options]",
    "Compares measured piles with (3) and (4) of Lee & Herrmann 1993, one row per mu.\n"
    "\n"
    "FILE (- for standard input) has one row per pile with columns mu, theta_r3_deg,\n"
    "theta_t_displacement_deg and status, as repose sweep export writes it. Rows whose status is not ok,\n"
    "and rows with nan in an angle, are left out.\n"
    "\n"
    "Columns with rt hold theta_R + theta_T: measured pile by pile, or with theta_T of (4) at the mean\n"
    "theta_R. Columns with diff hold measured minus theory. theta_r_se, theta_t_se and theta_rt_se are\n"
    "SD/sqrt(n); the other errors come from a bootstrap over piles. n_unstable counts the piles steeper\n"
    "than theta_MS, n_lost the resamples without a theta_T. status is that of repose angle tilt at the\n"
    "mean theta_R, for the first form of (4) that is not ok.",
    "repose angle compare piles.tsv",
    compare_params,
    .refuses = "A table without these columns, or without a pile that counts.",
    .derives = true,
    .on_table = compare_table};

/* ---- phi ---- */

#define PHI_OPTIONS(X)                                                                                       \
    X(REAL, from, "", "0", "[0, inf)", "smallest mu that is used")                                           \
    X(REAL, to, "", "1e308", "(0, inf)", "largest mu that is used")                                          \
    CLI_WHERE(X)

CLI_OPTIONS(phi, PHI_OPTIONS)

static rp_status print_phis(rp_arena *arena, size_t n_groups, const ang_piles groups[], const char *failed)
{
    size_t n = 0;
    ang_phi fit[ANG_N_AGAINST];
    for (size_t i = 0; i < n_groups; i++) n += groups[i].n;
    RP_TRY(ang_phi_fit(n_groups, groups, fit));
    for (int a = 0; a < ANG_N_AGAINST; a++) {
        const ang_phi *f = &fit[a];
        const int open = f->lo_open && f->hi_open ? 2 : (int)f->hi_open - (int)f->lo_open;
        CLI_ROW_WORD(rp_text(arena, "%s\t%s", failed, ang_against_words[a]), (double)n_groups, (double)n,
                     f->phi / deg, f->lo / deg, f->hi / deg, f->chi2, (double)f->dof, f->p_value, open);
    }
    return RP_OK;
}

static rp_status phi_table(cli_call *call, rp_table *table, const void *values)
{
    const phi_options *o = values;
    rp_rows piles;
    size_t n_groups = 0;
    RP_TRY(read_piles(call->arena, table, &piles));
    ang_piles *groups = rp_arena_memory(call->arena, piles.n_groups, sizeof *groups);
    for (size_t g = 0; g < piles.n_groups; g++) {
        const size_t first = piles.first[g];
        const double mu = piles.column[0][first];
        if (mu == 0.0 || mu < o->from || mu > o->to) continue;
        groups[n_groups++] =
            (ang_piles){mu, piles.first[g + 1] - first, piles.column[1] + first, piles.column[2] + first};
    }
    if (n_groups == 0)
        return rp_fail(RP_NO_RESULT, "%s: no row with status ok, both angles, and mu in range", table->path);
    cli_table(call, stdout);
    rp_rows_note(table, &piles);
    rp_table_header(stdout, "n_mu, n, phi_deg [deg], phi_lo_deg [deg], phi_hi_deg [deg], chi2, dof, p_value, "
                            "open, " CLI_FAILED_COLUMNS ", against");
    const double range[] = {fmax(o->from, DBL_MIN), o->to};
    return rp_prefix(
        print_phis(call->arena, n_groups, groups, cli_failed(call->arena, table, NULL, 0, "mu", range)),
        "%s: ", table->path);
}

const cli_command cmd_angle_phi = {
    "angle phi",
    "inclination of the rays, fitted to measured angles",
    "FILE [options]",
    "Fits the inclination phi of the rays of force to all mu together. Equation (3), tan theta_MS =\n"
    "mu tan^2 phi, is fitted to measured theta_R + theta_T; equation (4), in its balanced form, to\n"
    "measured theta_T.\n"
    "\n"
    "FILE (- for standard input) is a table as for repose angle compare. Rows with mu = 0 are left out.\n"
    "\n"
    "against names the equation. phi_lo and phi_hi bound the 95 % interval, where chi2 has risen by 3.84\n"
    "(profile likelihood). p_value is the chance of a larger chi2 if one phi holds for all mu; below\n"
    "0.05 the interval is that of a compromise. open is -1 if the data give no lower bound on phi, 1 for\n"
    "no upper bound, 2 for neither; phi is then not identified.",
    "repose angle phi build/tables/lh3_runs.tsv",
    phi_params,
    .refuses = "A table without a pile that counts; a friction with fewer than 5 piles.\n"
               "Piles whose angles are all the same, or steeper than any ray: exit status 1.",
    .derives = true,
    .on_table = phi_table};
