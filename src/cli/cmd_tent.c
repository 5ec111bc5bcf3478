/* repose tent: forces on the base of a tent-shaped pile. */
#include <math.h>
#include <stdlib.h>

#include "analytic/analytic.h"
#include "cli/positions.h"

typedef struct {
    double outer_deg, inner_deg, x_1;
    cli_positions where;
} options;

static const rp_param schema[] = {
    {"outer-deg", "degrees", RP_REAL, offsetof(options, outer_deg), NULL, "(0, 60)",
     "alpha_1, slope from the edge to X_1"},
    {"inner-deg", "degrees", RP_REAL, offsetof(options, inner_deg), NULL, "(0, 60)",
     "alpha_2, slope from X_1 to the middle"},
    {"x1", "B", RP_REAL, offsetof(options, x_1), NULL, "(0, 0.5)", "X_1, where the slope changes"},
    CLI_POSITIONS(options, where),
    {0},
};

static const cli_command command = {
    .name = "tent",
    .synopsis = "--outer-deg ANGLE --inner-deg ANGLE --x1 X [--points N | --at X,X,...]",
    .about = "Forces of a symmetric pile with two slopes on its base, and its outline: the tents of\n"
             "Figs. 18 and 19 of Liffman, Chan & Hughes 1992. x and y are fractions of the base B. N is the\n"
             "normal force of the ground; H is the horizontal force of the pile on the ground, positive to\n"
             "the right; both in chi g B, with chi the mass per length of a diagonal.",
    .example = "repose tent --outer-deg 30 --inner-deg 45 --x1 0.38",
    .options = schema,
};

static const char *const columns[][2] = {{"x/B", ""}, {"N/(chi*g*B)", ""}, {"H/(chi*g*B)", ""}, {"y/B", ""}};

rp_status cmd_tent(int argc, char **argv)
{
    options o;
    const char *arguments[1];
    int n_arguments;
    bool done;
    an_point v[5];
    an_profile tent;
    double *x = NULL;
    size_t n = 0;
    rp_status status = cli_parse(&command, argc, argv, &o, arguments, &n_arguments, &done);
    if (status || done) return status;
    status = an_tent(o.outer_deg * M_PI / 180, o.inner_deg * M_PI / 180, o.x_1, v);
    if (!status) status = an_profile_set(&tent, v, 5);
    if (!status) status = cli_positions_read(&o.where, &x, &n);
    if (status) return status;
    cli_table(stdout, schema, &o);
    rp_table_columns(stdout, 4, columns);
    for (size_t i = 0; i < n && !status; i++) {
        an_force f = {0};
        double y = 0;
        status = an_profile_force(&tent, x[i], &f);
        if (!status) status = an_profile_height(&tent, x[i], &y);
        rp_table_row(stdout, 4, (double[]){x[i], f.N, f.H, y});
    }
    free(x);
    return status;
}
