/* repose lattice: forces on the base of a pile on a lattice. */
#include <math.h>

#include "analytic/analytic.h"
#include "cli/cli.h"

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

/* Forces on the k base disks, and the number of disks of the pile. `up` holds k numbers. */
static rp_status solve(const lattice_options *o, long k, double alpha, double theta, long up[],
                       an_force force[], double *disks)
{
    RP_TRY(an_lattice_cut(k, theta, alpha, up));
    *disks = 0;
    for (long s = 0; s < k; s++) *disks += (double)up[s];
    if (o->method == RECURSION) return an_lattice_recursion(k, up, theta, force);
    if (o->base > 0) return an_lattice_counts(k, up, theta, force);
    for (long i = 1; i <= k; i++) RP_TRY(an_lattice_triangle(k, theta, i, &force[i - 1]));
    return RP_OK;
}

static void print(const cli_call *call, long k, double alpha, double theta, const an_force force[],
                  double disks)
{
    double base = an_lattice_base(disks, theta, alpha);
    cli_table(call, stdout);
    rp_table_note(stdout, "disks", "%.0f", disks);
    rp_table_note_number(stdout, "B", base, "sigma, the base of the triangle of equal weight");
    rp_table_header(stdout, "i, N/mg, H/mg, x/B, N/(chi*g*B), H/(chi*g*B)");
    for (long i = 1; i <= k; i++) {
        an_force f = force[i - 1];
        double x = 0.5 + ((double)i - (double)(k + 1) / 2) * 2 * sin(theta) / base;
        CLI_ROW((double)i, f.N, f.H, x, f.N / base, f.H / base);
    }
}

static rp_status write_pile(cli_call *call, const void *values)
{
    const lattice_options *o = values;
    RP_TRY(check_usage(o));
    long k = o->base > 0 ? o->base : o->layers;
    double theta = o->theta_deg * M_PI / 180,
           alpha = o->base > 0 ? o->alpha_deg * M_PI / 180 : M_PI / 2 - theta;
    double disks = 0;
    long *up = rp_arena_memory(call->arena, (size_t)k, sizeof *up);
    an_force *force = rp_arena_memory(call->arena, (size_t)k, sizeof *force);
    RP_TRY(solve(o, k, alpha, theta, up, force, &disks));
    print(call, k, alpha, theta, force, disks);
    return RP_OK;
}

const cli_command cmd_lattice = {
    "lattice",
    "forces on the base of a close-packed pile, lattice model (37)-(44)",
    "(--layers K | --base K --alpha-deg ANGLE) [--theta-deg ANGLE] [--method closed|recursion]",
    "Forces of a pile of equal disks on its base. Only contacts along the diagonals of the lattice\n"
    "carry force. Equations (37)-(44) of Liffman, Chan & Hughes 1992 give the full triangle; the same\n"
    "force balance gives piles with slopes cut out of the lattice. Row i = 1..K is base disk i from the\n"
    "left. N is the normal force of the ground. H is the horizontal force of the pile on the ground,\n"
    "positive to the right. The columns in chi g B (chi = m/sigma) compare with `repose continuum`; B\n"
    "is the base of the triangle of equal weight.",
    "repose lattice --base 45 --alpha-deg 30",
    lattice_params,
    .act = write_pile};
