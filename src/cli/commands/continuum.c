/* repose continuum: forces on the base of a triangular pile. */
#include <math.h>

#include "analytic/analytic.h"
#include "cli/cli.h"

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
    RP_TRY(cli_positions(call->arena, o->points, o->at, &x, &n));
    cli_table(call, stdout);
    rp_table_note_number(stdout, "x_c/B", x_c, "");
    rp_table_header(stdout, "x/B, N/(chi*g*B), H/(chi*g*B)");
    for (size_t i = 0; i < n; i++) {
        an_force f = {0};
        RP_TRY(an_continuum(alpha, x[i], &f));
        CLI_ROW(x[i], f.N, f.H);
    }
    return RP_OK;
}

const cli_command cmd_continuum = {
    "continuum",
    "forces on the base of a triangular pile, continuum model (49)-(59)",
    "--alpha-deg ANGLE [--points N | --at X,X,...]",
    "Forces of a triangular pile on its base, continuum model (49)-(59) of Liffman, Chan & Hughes 1992.\n"
    "x is a fraction of the base B. N is the normal force of the ground. H is the horizontal force of\n"
    "the pile on the ground, positive to the right. The unit of both is chi g B, where chi is the mass\n"
    "per length of a diagonal.",
    "repose continuum --alpha-deg 30 --at 0.1,0.25",
    continuum_params,
    .act = write_triangle};
