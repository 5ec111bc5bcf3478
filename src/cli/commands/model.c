/* repose lattice, continuum and tent: the analytic models of a pile's forces on its base. */
#include <stdlib.h>
#include <string.h>

#include "analytic/analytic.h"
#include "cli/cli.h"

/* ---- lattice ---- */

enum { CLOSED, RECURSION };

#define LATTICE_OPTIONS(X)                                                                                   \
    X(INT, layers, "", "auto", "[1, 1000000] | auto", "layers of a full triangle")                           \
    X(INT, base, "", "auto", "[1, 1000000] | auto", "disks in the base of a cut pile")                       \
    X(REAL, alpha_deg, "degrees", "auto", "(0, 60] | auto",                                                  \
      "slope of the cut pile, at most 90 - theta (with --base)")                                             \
    X(REAL, theta_deg, "degrees", "30", "[30, 60]",                                                          \
      "angle of the diagonals to the vertical; above 30 gaps separate the disks of a row")                   \
    X(CHOICE, method, "", "closed", "closed | recursion",                                                    \
      "closed form, or recursion disk by disk from the top (at most 10000 disks in the base)")

CLI_OPTIONS(lattice, LATTICE_OPTIONS)

static rp_status check_usage(const lattice_options *o)
{
    bool cut = o->base > 0, sloped = o->alpha_deg > 0;
    if (cut == (o->layers > 0))
        return rp_fail(RP_USAGE, "give --layers, or --base with --alpha-deg; see repose lattice --help");
    if (cut != sloped)
        return rp_fail(RP_USAGE, "%s; see repose lattice --help",
                       cut ? "--base needs --alpha-deg" : "--alpha-deg needs --base");
    return RP_OK;
}

static rp_status write_pile(cli_call *call, const void *values)
{
    const lattice_options *o = values;
    RP_TRY(check_usage(o));
    const long k = o->base > 0 ? o->base : o->layers; /* disks in the base */
    const double theta = o->theta_deg * M_PI / 180,
                 alpha = o->base > 0 ? o->alpha_deg * M_PI / 180 : M_PI / 2 - theta;
    long *up = rp_arena_memory(call->arena, (size_t)k, sizeof *up); /* how many disks stand over each */
    an_force *force = rp_arena_memory(call->arena, (size_t)k, sizeof *force);
    double disks = 0;
    RP_TRY(an_lattice_cut(k, theta, alpha, up));
    for (long s = 0; s < k; s++) disks += (double)up[s];
    if (o->method == RECURSION) RP_TRY(an_lattice_recursion(k, up, theta, force));
    if (o->method == CLOSED && o->base > 0) RP_TRY(an_lattice_counts(k, up, theta, force));
    if (o->method == CLOSED && o->base <= 0)
        for (long i = 1; i <= k; i++) RP_TRY(an_lattice_triangle(k, theta, i, &force[i - 1]));
    const double base = an_lattice_base(disks, theta, alpha);
    cli_table(call, call->out);
    rp_table_note(call->out, "disks", "%.0f", disks);
    rp_table_note_number(call->out, "B", base, "sigma, the base of the triangle of equal weight");
    rp_table_header(call->out, call->units, "i, N/mg, H/mg, x/B, N/(chi*g*B), H/(chi*g*B)");
    for (long i = 1; i <= k; i++) {
        const an_force f = force[i - 1];
        const double x = 0.5 + ((double)i - (double)(k + 1) / 2) * 2 * sin(theta) / base;
        CLI_ROW((double)i, f.N, f.H, x, f.N / base, f.H / base);
    }
    return RP_OK;
}

const cli_command cmd_lattice = {
    "lattice",
    "forces on the base of a close-packed pile, by the lattice model of Liffman et al. 1992",
    "(--layers K | --base K --alpha-deg ANGLE) [--theta-deg ANGLE] [--method closed|recursion]",
    "Forces of a pile of equal disks on its base. Only contacts along the diagonals of the lattice carry "
    "force. Equations (37)-(44) of Liffman, Chan & Hughes 1992 give the full triangle; the same force "
    "balance gives piles with slopes cut out of the lattice. Row i = 1..K is base disk i from the left. N is "
    "the normal force of the ground. H is the horizontal force of the pile on the ground, positive to the "
    "right. The columns in chi g B (chi = m/sigma, of disks of mass m and diameter sigma) can be compared "
    "with `repose continuum`; B is the base of "
    "the triangle of equal weight.",
    "repose lattice --base 45 --alpha-deg 30",
    lattice_params,
    .refuses = "--layers together with --base, and --base without --alpha-deg.\n"
               "More than 10000 disks in the base with recursion: use the closed form.",
    .act = write_pile};

/* ---- positions ---- */

/* Values of CLI_POSITIONS as a new array of fractions of the base, of a list "0.1,0.25,..." or equidistant;
 * points -1, at "auto": not given. */
static rp_status positions(rp_arena *arena, long points, const char *at, double **x, size_t *n)
{
    const bool listed = strcmp(at, "auto") != 0;
    if (listed && points > 0) return rp_fail(RP_USAGE, "give --points or --at, not both");
    *n = listed ? 1 : points > 0 ? (size_t)points : 201;
    for (const char *c = at; *c; c++) *n += *c == ',';
    *x = rp_arena_memory(arena, *n, sizeof **x);
    for (size_t i = 0; i < *n; i++) {
        char *end;
        (*x)[i] = listed ? strtod(at, &end) : (double)i / (double)(*n - 1);
        if (!listed) continue;
        if (end == at || (*end && *end != ',') || !isfinite((*x)[i]))
            return rp_fail(RP_BAD_INPUT, "--at: \"%.40s\": numbers separated by commas expected", at);
        if ((*x)[i] < 0 || (*x)[i] > 1)
            return rp_fail(RP_BAD_INPUT, "--at: x/B = %.15g: out of range, allowed: [0, 1]", (*x)[i]);
        at = end + (*end == ',');
    }
    return RP_OK;
}

/* ---- continuum ---- */

#define CONTINUUM_OPTIONS(X)                                                                                 \
    X(REAL, alpha_deg, "degrees", NULL, "(0, 60)", "slope of both sides")                                    \
    CLI_POSITIONS(X)

CLI_OPTIONS(continuum, CONTINUUM_OPTIONS)

static rp_status write_triangle(cli_call *call, const void *values)
{
    const continuum_options *o = values;
    double *x = NULL, x_c = 0;
    size_t n = 0;
    double alpha = o->alpha_deg * M_PI / 180;
    RP_TRY(an_continuum_kink(alpha, &x_c));
    RP_TRY(positions(call->arena, o->points, o->at, &x, &n));
    cli_table(call, call->out);
    rp_table_note_number(call->out, "x_c/B", x_c, "");
    rp_table_header(call->out, call->units, "x/B, N/(chi*g*B), H/(chi*g*B)");
    for (size_t i = 0; i < n; i++) {
        an_force f = {0};
        RP_TRY(an_continuum(alpha, x[i], &f));
        CLI_ROW(x[i], f.N, f.H);
    }
    return RP_OK;
}

const cli_command cmd_continuum = {
    "continuum",
    "forces on the base of a triangular pile, by the continuum model of Liffman et al. 1992",
    "--alpha-deg ANGLE [--points N | --at X,X,...]",
    "Forces of a triangular pile on its base, by the continuum model (49)-(59) of Liffman, Chan & Hughes "
    "1992. x is a fraction of the base B. N is the normal force of the ground. H is the horizontal force of "
    "the pile on the ground, positive to the right. The unit of both is chi g B, where chi is the mass per "
    "length of a diagonal.",
    "repose continuum --alpha-deg 30 --at 0.1,0.25",
    continuum_params,
    .refuses = "--points together with --at; a position outside [0, 1].",
    .act = write_triangle};

/* ---- tent ---- */

#define TENT_OPTIONS(X)                                                                                      \
    X(REAL, outer_deg, "degrees", NULL, "(0, 60)", "alpha_1, slope from the edge to X_1")                    \
    X(REAL, inner_deg, "degrees", NULL, "(0, 60)", "alpha_2, slope from X_1 to the middle")                  \
    X(REAL, x1, "B", NULL, "(0, 0.5)", "X_1, where the slope changes")                                       \
    CLI_POSITIONS(X)

CLI_OPTIONS(tent, TENT_OPTIONS)

static rp_status write_tent(cli_call *call, const void *values)
{
    const tent_options *o = values;
    an_point v[5];
    an_profile tent;
    an_force f;
    double *x = NULL, y, x_most, most;
    size_t n = 0;
    RP_TRY(an_tent(o->outer_deg * M_PI / 180, o->inner_deg * M_PI / 180, o->x1, v));
    RP_TRY(an_profile_set(&tent, v, 5));
    RP_TRY(positions(call->arena, o->points, o->at, &x, &n));
    RP_TRY(an_profile_largest(&tent, &x_most, &most));
    RP_TRY(an_profile_force(&tent, 0.5, &f));
    cli_table(call, call->out);
    rp_table_note(call->out, "dip", "%.3g: N = %.4g at %.4g B, %.4g in the middle", 1 - f.N / most, most,
                  x_most, f.N);
    rp_table_header(call->out, call->units, "x/B, N/(chi*g*B), H/(chi*g*B), y/B");
    for (size_t i = 0; i < n; i++) {
        RP_TRY(an_profile_force(&tent, x[i], &f));
        RP_TRY(an_profile_height(&tent, x[i], &y));
        CLI_ROW(x[i], f.N, f.H, y);
    }
    return RP_OK;
}

const cli_command cmd_tent = {
    "tent",
    "forces on the base of a tent-shaped pile, by the continuum model",
    "--outer-deg ANGLE --inner-deg ANGLE --x1 X [--points N | --at X,X,...]",
    "Outline of a symmetric pile with two slopes on each side, and its forces on the base: the tents of "
    "Figs. 18 and 19 of Liffman, Chan & Hughes 1992. x and y are fractions of the base B. N is the normal "
    "force of the ground. H is the horizontal force of the pile on the ground, positive to the right. The "
    "unit of both is chi g B, where chi is the mass per length of a diagonal. The dip is (max N - N in the "
    "middle)/max N.",
    "repose tent --outer-deg 30 --inner-deg 45 --x1 0.38",
    tent_params,
    .refuses = "--points together with --at; a position outside [0, 1].",
    .act = write_tent};
