/* repose tent: forces on the base of a tent-shaped pile. */
#include <math.h>

#include "analytic/analytic.h"
#include "cli/cli.h"

#define TENT_OPTIONS(X)                                                                                      \
    X(REAL, outer_deg, "degrees", "auto", "(0, 60) | auto", "alpha_1, slope from the edge to X_1")           \
    X(REAL, inner_deg, "degrees", "auto", "(0, 60) | auto", "alpha_2, slope from X_1 to the middle")         \
    X(REAL, x1, "B", NULL, "(0, 0.5)", "X_1, where the slope changes")                                       \
    X(BOOL, map, "", "false", "",                                                                            \
      "depth of the dip of N for all pairs of whole degrees, instead of one tent")                           \
    CLI_POSITIONS(X)

CLI_OPTIONS(tent, TENT_OPTIONS)

typedef struct {
    double x_most, most, middle; /* position of the largest N; largest N; N in the middle */
} dip;

static rp_status find_dip(const an_profile *tent, dip *d)
{
    an_force f;
    RP_TRY(an_profile_largest(tent, &d->x_most, &d->most));
    RP_TRY(an_profile_force(tent, 0.5, &f));
    d->middle = f.N;
    return RP_OK;
}

static rp_status write_map(const cli_call *call, const tent_options *o)
{
    cli_table(call, stdout);
    rp_table_header(stdout,
                    "outer_deg [degree], inner_deg [degree], x_most/B, N_most/(chi*g*B), N_middle/(chi*g*B), "
                    "dip");
    for (int outer = 1; outer < 60; outer++)
        for (int inner = 1; inner < 60; inner++) {
            an_point v[5];
            an_profile tent;
            dip d;
            RP_TRY(an_tent(outer * M_PI / 180, inner * M_PI / 180, o->x1, v));
            RP_TRY(an_profile_set(&tent, v, 5));
            RP_TRY(find_dip(&tent, &d));
            CLI_ROW(outer, inner, d.x_most, d.most, d.middle, 1 - d.middle / d.most);
        }
    return RP_OK;
}

static rp_status write_places(const cli_call *call, const tent_options *o, const an_profile *tent)
{
    double *x = NULL;
    size_t n = 0;
    dip d;
    RP_TRY(cli_positions(call->arena, o->points, o->at, &x, &n));
    RP_TRY(find_dip(tent, &d));
    cli_table(call, stdout);
    rp_table_note(stdout, "dip", "%.3g: N = %.4g at %.4g B, %.4g in the middle", 1 - d.middle / d.most,
                  d.most, d.x_most, d.middle);
    rp_table_header(stdout, "x/B, N/(chi*g*B), H/(chi*g*B), y/B");
    for (size_t i = 0; i < n; i++) {
        an_force f = {0};
        double y = 0;
        RP_TRY(an_profile_force(tent, x[i], &f));
        RP_TRY(an_profile_height(tent, x[i], &y));
        CLI_ROW(x[i], f.N, f.H, y);
    }
    return RP_OK;
}

static rp_status write_tent(cli_call *call, const void *values)
{
    const tent_options *o = values;
    an_point v[5];
    an_profile tent;
    if ((o->outer_deg > 0) + (o->inner_deg > 0) != (o->map ? 0 : 2))
        return rp_fail(RP_USAGE, "give --outer-deg and --inner-deg, or --map; see repose tent --help");
    if (o->map) return write_map(call, o);
    RP_TRY(an_tent(o->outer_deg * M_PI / 180, o->inner_deg * M_PI / 180, o->x1, v));
    RP_TRY(an_profile_set(&tent, v, 5));
    return write_places(call, o, &tent);
}

const cli_command cmd_tent = {
    "tent",
    "forces on the base of a tent-shaped pile",
    "--x1 X (--outer-deg ANGLE --inner-deg ANGLE [--points N | --at X,X,...] | --map)",
    "Outline of a symmetric pile with two slopes, and its forces on the base: the tents of Figs. 18 and\n"
    "19 of Liffman, Chan & Hughes 1992. x and y are fractions of the base B. N is the normal force of\n"
    "the ground. H is the horizontal force of the pile on the ground, positive to the right. The unit\n"
    "of both is chi g B, where chi is the mass per length of a diagonal. The dip is (max N - N in the\n"
    "middle)/max N.",
    "repose tent --outer-deg 30 --inner-deg 45 --x1 0.38",
    tent_params,
    .act = write_tent};
