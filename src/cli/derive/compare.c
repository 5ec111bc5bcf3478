/* repose angle compare: measured piles against (3) and (4). */
#include "angle/angle.h"
#include "cli/derive/derive.h"
#include "core/random.h"

#define COMPARE_OPTIONS(X)                                                                                   \
    CLI_PHI(X)                                                                                               \
    X(INT, bootstrap, "", "2000", "[2, 10000000]", "resamples of the piles")                                 \
    X(INT, seed, "", "1993", "[0, 2147483647]", "seed of the resamples")                                     \
    CLI_WHERE(X)

CLI_OPTIONS(compare, COMPARE_OPTIONS)

static void print_compare_header(const cli_call *call)
{
    static const char *const parts[] = {"theta_t", "diff", "theta_rt", "gain"};
    const char *text = "mu, n, theta_r_deg [deg], theta_r_se_deg [deg], theta_t_deg [deg], "
                       "theta_t_se_deg [deg], theta_rt_deg [deg], theta_rt_se_deg [deg], theta_ms_deg [deg], "
                       "diff_ms_deg [deg], diff_ms_se_deg [deg], n_unstable, n_lost";
    for (int f = 0; f < ANG_N_FORMS; f++) {
        const char *form = ang_form_words[f];
        for (size_t k = 0; k < N_OF(parts); k++)
            text = rp_text(call->arena, "%s, %s_%s_deg [deg], %s_%s_se_deg [deg]", text, parts[k], form,
                           parts[k], form);
        text = rp_text(call->arena, "%s, gain_relative_%s, gain_relative_%s_se", text, form, form);
    }
    rp_table_header(call->out, call->units, rp_text(call->arena, "%s, " RP_FAILED_COLUMNS ", status", text));
}

static void print_comparison(const cli_call *call, double mu, const ang_comparison *c, const char *failed)
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
    rp_table_row_word(call->out, N_OF(v), v, rp_text(call->arena, "%s\t%s", failed, ang_tilt_words[worst]));
}

static rp_status compare_table(cli_call *call, rp_table *table, const void *values)
{
    const compare_options *o = values;
    rp_rows piles; /* ordered by mu: mu, theta_r, theta_t */
    RP_TRY(rp_rows_read(call->arena, table, "mu,theta_r3_deg,theta_t_displacement_deg",
                        &(rp_choice){.grouped = true}, &piles));
    for (size_t i = 0; i < piles.n; i++) {
        for (int c = 1; c < 3; c++)
            if (!(fabs(piles.column[c][i]) < 90.0))
                return rp_fail(RP_BAD_INPUT, "%s:%zu: %s = %g: out of range, allowed: (-90, 90)",
                               RP_PLACE(table, piles.row[i]),
                               c == 1 ? "theta_r3_deg" : "theta_t_displacement_deg", piles.column[c][i]);
        piles.column[1][i] *= deg, piles.column[2][i] *= deg;
    }
    rp_random *rng = rp_random_in(call->arena, (unsigned long)o->seed, 0, RP_PURPOSE_BOOTSTRAP);
    cli_table(call, call->out);
    rp_table_note(call->out, "rows", "%zu used, %zu left out", piles.n, table->n_rows - piles.n);
    for (size_t g = 0; g < piles.n_groups; g++)
        if (piles.first[g + 1] - piles.first[g] == 1)
            rp_table_note(call->out, "errors", "mu = %g has one pile; at least 2 needed",
                          piles.column[0][piles.first[g]]);
    print_compare_header(call);
    for (size_t g = 0; g < piles.n_groups; g++) {
        const size_t first = piles.first[g];
        const ang_piles of = {piles.column[0][first], piles.first[g + 1] - first, piles.column[1] + first,
                              piles.column[2] + first};
        ang_comparison c;
        RP_TRY(rp_prefix(ang_compare(&of, o->phi_deg * deg, (size_t)o->bootstrap, rng, &c),
                         "%s: mu = %g: ", table->path, of.mu));
        print_comparison(call, of.mu, &c,
                         rp_failed_text(call->arena, table, NULL, 0, "mu", (double[]){of.mu, of.mu}));
    }
    return RP_OK;
}

const cli_command cmd_angle_compare = {
    "angle compare",
    "measured angles compared with (3) and (4) of Lee & Herrmann 1993",
    "FILE [options]",
    "Compares measured piles with (3) and (4) of Lee & Herrmann 1993, one row for each mu.\n"
    "\n"
    "FILE (- for standard input) has one row for each pile, with columns mu, theta_r3_deg, "
    "theta_t_displacement_deg and status, as `repose sweep export` writes it. Rows whose status is not ok "
    "and rows with nan in an angle are left out.\n"
    "\n"
    "Columns with rt hold theta_R + theta_T: measured pile by pile, or with theta_T of (4) at the mean "
    "theta_R. Columns with diff hold measurement minus theory. theta_r_se, theta_t_se and theta_rt_se are "
    "SD/sqrt(n); the other errors come from a bootstrap over piles. n_unstable counts the piles steeper than "
    "theta_MS, and n_lost the resamples without a theta_T. status is that of `repose angle tilt` at the mean "
    "theta_R, for the first form of (4) that is not ok.",
    "repose angle compare piles.tsv",
    compare_params,
    .refuses = "A table without these columns, or without a usable pile; an angle of 90 degrees or more.",
    .derives = true,
    .on_table = compare_table};
