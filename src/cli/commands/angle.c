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
    "angle of marginal stability, (3)",
    "--mu MU [options]",
    "Angle of marginal stability, tan theta_MS = mu tan^2 phi (Lee & Herrmann 1993, (3)). status: ok, or "
    "extrapolated where theta_MS >= phi, beyond the derivation.",
    "repose angle marginal --mu 0.2",
    marginal_params,
    .refuses = "A negative friction; rays that are level or upright.",
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
    "tilt at which a pile slides, (4)",
    "--mu MU --theta-r-deg ANGLE [options]",
    "Tilt theta_T at which a pile slides (Lee & Herrmann 1993, (4)), theta_MS of (3), margin theta_MS - "
    "theta_R, and the tilt up to which the form is defined. form: balanced (rays fixed to gravity, forces "
    "balance), lattice (rays fixed to the pile, forces balance), sine ((4b) with sines for tangents), "
    "printed. status: ok; ok_pulling (found, but there one ray of the lattice form pulls); already_unstable "
    "(margin negative, no theta_T); no_slide (no theta_T below the limit); rays_miss (else, where theta_R >= "
    "phi: no theory, exit status 1).",
    "repose angle tilt --mu 0.2 --theta-r-deg 18 --form balanced",
    tilt_params,
    .refuses =
        "theta_R >= phi, where no ray leaves through the flank, unless already_unstable: exit status 1.",
    .act = print_tilt};

/* ---- group ---- */

static const cli_command *const commands[] = {&marginal, &tilt, &cmd_angle_slope, CLI_ANGLE(CLI_ENTRY) NULL};
const cli_command cmd_angle = {"angle", "angles of repose, tilting and marginal stability from plain numbers",
                               .group = commands};
