/* repose angle: marginal stability and tilt, (3) and (4), on the command line. */
#include "angle/angle.h"
#include "cli/derive/derive.h"

/* ---- marginal ---- */

#define MU_PARAM(X) X(REAL, mu, "", NULL, "[0, inf) | infinite", "friction coefficient of the base")
#define MARGINAL_OPTIONS(X)                                                                                  \
    MU_PARAM(X)                                                                                              \
    CLI_PHI(X)

CLI_OPTIONS(marginal, MARGINAL_OPTIONS)

static rp_status print_marginal(cli_call *call, const void *values)
{
    const marginal_options *o = values;
    bool extrapolated;
    double theta_ms;
    RP_TRY(ang_marginal(o->mu, o->phi_deg * deg, &theta_ms, &extrapolated));
    cli_table(call, call->out);
    rp_table_header(call->out, call->units, "theta_ms_deg [deg], status");
    CLI_ROW_WORD(extrapolated ? "extrapolated" : "ok", theta_ms / deg);
    return RP_OK;
}

static const cli_command marginal = {
    "angle marginal",
    "angle of marginal stability, by (3) of Lee & Herrmann 1993",
    "--mu MU [options]",
    "Angle of marginal stability by (3) of Lee & Herrmann 1993: tan theta_MS = mu tan^2 phi. status is ok, "
    "or extrapolated if theta_MS >= phi, where the derivation does not hold.",
    "repose angle marginal --mu 0.2",
    marginal_params,
    .refuses = "A negative friction coefficient; rays that are horizontal or vertical.",
    .act = print_marginal};

/* ---- tilt ---- */

#define TILT_OPTIONS(X)                                                                                      \
    MU_PARAM(X)                                                                                              \
    X(REAL, theta_r_deg, "deg", NULL, "[0, 90)", "slope of the pile")                                        \
    X(CHOICE, form, "", "balanced", ANG_FORM_WORDS, "form of (4)")                                           \
    CLI_PHI(X)

CLI_OPTIONS(tilt, TILT_OPTIONS)

static rp_status print_tilt(cli_call *call, const void *values)
{
    const tilt_options *o = values;
    ang_tilt_result r;
    RP_TRY(ang_tilt((ang_form)o->form, o->mu, o->theta_r_deg * deg, o->phi_deg * deg, &r));
    cli_table(call, call->out);
    rp_table_header(call->out, call->units,
                    "theta_t_deg [deg], theta_ms_deg [deg], margin_deg [deg], limit_deg [deg], status");
    CLI_ROW_WORD(ang_tilt_words[r.status], r.theta_t / deg, r.theta_ms / deg, r.margin / deg, r.limit / deg);
    if (r.status == ANG_TILT_RAYS_MISS)
        return rp_fail(RP_NO_RESULT,
                       "theta-r-deg = %g: the rays of inclination %g deg never leave through the flank",
                       o->theta_r_deg, o->phi_deg);
    return RP_OK;
}

static const cli_command tilt = {
    "angle tilt",
    "tilt at which a pile slides, by (4) of Lee & Herrmann 1993",
    "--mu MU --theta-r-deg ANGLE [options]",
    "Prints the tilt theta_T at which a pile slides, by (4) of Lee & Herrmann 1993; theta_MS of (3); the "
    "margin theta_MS - theta_R; and the tilt up to which the form of (4) is defined. The forms are\n"
    "  balanced  rays fixed to gravity, forces balance\n"
    "  lattice   rays fixed to the pile, forces balance\n"
    "  sine      sines instead of the tangents in (4b)\n"
    "  printed   as in the paper\n"
    "status is one of\n"
    "  ok                theta_T was found\n"
    "  ok_pulling        found, but one ray of the lattice form attracts there\n"
    "  already_unstable  the margin is negative: no theta_T\n"
    "  no_slide          no theta_T below the limit\n"
    "  rays_miss         otherwise, if theta_R >= phi: no theory, exit status 1",
    "repose angle tilt --mu 0.2 --theta-r-deg 18 --form balanced",
    tilt_params,
    .refuses =
        "theta_R >= phi, where no ray leaves through the flank, unless already_unstable: exit status 1.",
    .act = print_tilt};

/* ---- group ---- */

static const cli_command *const commands[] = {&marginal, &tilt, &cmd_angle_slope, CLI_ANGLE(CLI_ENTRY) NULL};
const cli_command cmd_angle = {"angle", "angles of repose, tilting and marginal stability",
                               .group = commands};
