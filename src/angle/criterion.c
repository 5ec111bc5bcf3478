/* Angle of marginal stability and tilting angle: Lee & Herrmann 1993, (3) and (4); see angle.h.
 *
 * Tilted by theta, a pile of slope theta_r over its base carries the load of a base grain along a ray A up
 * the slope, of inclination a to the base, and a ray B down the slope, of inclination b. With t = tan
 * theta_r, the chords inside the pile, above a base point at depth h, are
 *     l_A = h/(sin a - t cos a),  l_B = h/(sin b + t cos b),
 * and with forces F_A, F_B along them T = F_A cos a - F_B cos b, N = F_A sin a + F_B sin b. It slides when
 * T/N = mu. The forms:
 *   sine      a = phi - theta, b = phi + theta, F = l: (4) with sines in (4b).
 *   printed   the same with (4b) to the letter: l_A = h/(tan a - t cos a), l_B = h/(tan b + t cos b).
 *   balanced  F = l times the width of the beam that meets a unit of base, sin a or sin b. The rays are
 *             symmetric about gravity and halve the weight, so over the whole pile T/N = tan theta.
 *   lattice   a = b = phi; the weight (sin theta, cos theta) resolved along the rays gives F_A = l_A
 *             cos(phi - theta), F_B = l_B cos(phi + theta), which pulls beyond theta = pi/2 - phi.
 *
 * Closed forms, all from T/N = mu, with t = tan theta_r, k = tan^2 phi, friction angle f = atan mu:
 *   sine      theta = (f - theta_r - asin(cos 2phi sin(f + theta_r)))/2
 *   lattice   tan theta = (mu - t/k)/(1 - mu t)
 *   balanced  F_A = h/(1 - t cot a), F_B = h/(1 + t cot b). With u = tan theta, sin a sin b =
 *             (sin^2 phi - u^2 cos^2 phi)/(1 + u^2) and cos a cos b = (cos^2 phi - u^2 sin^2 phi)/(1 + u^2)
 *                 T/N = (u (k - u^2) + t (1 - k u^2)) / (k - u^2 - t u (2 + k + u^2)), so
 *                 (1 - mu t) u^3 + (t k - mu) u^2 - (k + mu t (2 + k)) u + (mu k - t) = 0.
 *             For mu t < 1 this is >= 0 at u = 0, -t (1 + mu^2)^2 <= 0 at u = mu, and rises at infinity:
 *             of three real roots the middle one, in [0, mu], is the tilt.
 * The tests use them; the program finds every root by bracketing.
 *
 * Limits: all forms but lattice end where F_B/F_A tends to 0 as ray A becomes parallel to the flank (for
 * printed: or as tan b grows beyond bounds); there T/N tends to cot a. */
#include <gsl/gsl_errno.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_roots.h>
#include <math.h>

#include "angle/angle.h"
#include "core/elementary.h"

enum { MAX_ITERATIONS = 200 }; /* bisection alone needs 60 */
static const double root_tolerance = 1e-15;

typedef struct {
    ang_form form;
    double phi, theta_r;
    double sin_f, cos_f; /* of the friction angle */
} pile;

const char *const ang_form_words[] = {"balanced", "lattice", "sine", "printed"};
const char *const ang_tilt_words[] = {"ok",       "ok_pulling", "already_unstable",
                                      "no_slide", "rays_miss",  "no_pile"};

/* T and N on the base, up to a common positive factor. */
static void base_force(const pile *s, double theta, double *t, double *n)
{
    double r = s->theta_r, a = s->phi - theta, b = s->phi + theta, cot = 1.0 / rp_tan(s->phi);
    double p = NAN, q = NAN; /* F_A : F_B = p : q */
    switch (s->form) {
    case ANG_LATTICE: /* F_A and F_B worked out: no cancellation near pi/2 */
        *t = rp_sin(theta) * rp_cos(r) + cot * cot * rp_sin(r) * rp_cos(theta);
        *n = rp_cos(theta - r);
        return;
    case ANG_SINE:
        p = rp_sin(b + r);
        q = rp_sin(a - r);
        break;
    case ANG_PRINTED:
        p = (rp_sin(b) * rp_cos(r) + rp_sin(r) * gsl_pow_2(rp_cos(b))) * rp_cos(a);
        q = (rp_sin(a) * rp_cos(r) - rp_sin(r) * gsl_pow_2(rp_cos(a))) * rp_cos(b);
        break;
    case ANG_BALANCED:
        p = rp_cos(r) + rp_sin(r) / rp_tan(b);
        q = rp_cos(r) - rp_sin(r) / rp_tan(a);
        break;
    case ANG_N_FORMS: break;
    }
    *t = p * rp_cos(a) - q * rp_cos(b);
    *n = p * rp_sin(a) + q * rp_sin(b);
}

/* Tilt at which the form ends; 0 or less if the upper ray misses the flank without tilt. */
static double tilt_limit(ang_form form, double theta_r, double phi)
{
    if (theta_r >= phi) return 0.0;
    if (form == ANG_LATTICE) return M_PI_2;
    if (form != ANG_PRINTED) return phi - theta_r;
    /* tan a = t cos a, or tan b infinite, whichever comes first */
    double s = rp_sin(theta_r), c = rp_cos(theta_r);
    double a = rp_asin(2.0 * s / (c + sqrt(c * c + 4.0 * s * s)));
    return phi - fmax(a, 2.0 * phi - M_PI_2);
}

/* Positive where friction holds; no poles. */
static double excess(double theta, void *params)
{
    const pile *s = params;
    double t, n;
    base_force(s, theta, &t, &n);
    return n * s->sin_f - t * s->cos_f;
}

static rp_status check_angle(const char *name, double value, double lo, double hi, bool closed)
{
    if ((closed ? value >= lo : value > lo) && value < hi) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "%s = %g rad: out of range, allowed: %c%g, %g)", name, value,
                   closed ? '[' : '(', lo, hi);
}

static rp_status check_common(ang_form form, double theta_r, double phi)
{
    if ((int)form < 0 || form >= ANG_N_FORMS)
        return rp_fail(RP_BAD_INPUT, "form = %d: unknown, allowed: 0 to %d", (int)form, ANG_N_FORMS - 1);
    RP_TRY(check_angle("phi", phi, 0.0, M_PI_2, false));
    return check_angle("theta_r", theta_r, 0.0, M_PI_2, true);
}

rp_status ang_marginal(double mu, double phi, double *theta_ms, bool *extrapolated)
{
    RP_TRY(check_angle("phi", phi, 0.0, M_PI_2, false));
    if (!(mu >= 0.0)) return rp_fail(RP_BAD_INPUT, "mu = %g: out of range, allowed: [0, inf]", mu);
    *theta_ms = rp_atan(mu * gsl_pow_2(rp_tan(phi)));
    if (extrapolated) *extrapolated = *theta_ms >= phi;
    return RP_OK;
}

rp_status ang_friction(ang_form form, double theta_r, double theta_t, double phi, double *mu)
{
    RP_TRY(check_common(form, theta_r, phi));
    RP_TRY(check_angle("theta_r", theta_r, 0.0, phi, true));
    RP_TRY(check_angle("theta_t", theta_t, 0.0, tilt_limit(form, theta_r, phi), true));
    double t, n;
    base_force(&(pile){.form = form, .phi = phi, .theta_r = theta_r}, theta_t, &t, &n);
    *mu = t / n;
    return RP_OK;
}

static rp_status find_root(double (*f)(double x, void *data), void *data, double lo, double hi,
                           double absolute, double relative, double *root)
{
    gsl_root_fsolver *solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
    if (!solver) return rp_fail(RP_NO_MEMORY, "root: out of memory");
    gsl_function function = {f, data};
    int state = gsl_root_fsolver_set(solver, &function, lo, hi);
    bool found = false;
    for (int i = 0; i < MAX_ITERATIONS && !state && !found; i++) {
        state = gsl_root_fsolver_iterate(solver);
        found = gsl_root_test_interval(gsl_root_fsolver_x_lower(solver), gsl_root_fsolver_x_upper(solver),
                                       absolute, relative) == GSL_SUCCESS;
    }
    *root = gsl_root_fsolver_root(solver);
    gsl_root_fsolver_free(solver);
    return found && !state ? RP_OK : rp_fail(RP_BROKEN, "root not found: %s", gsl_strerror(state));
}

/* The bracket [0, limit]. At 0 the excess is >= 0 because of (3) (sine, balanced and lattice are (3) there,
 * printed needs cos phi times that). At the limit T/N = cot a, so the excess is negative exactly
 * if f + a < pi/2, with a = theta_r for sine and balanced; for lattice T/N tends to 1/t, the same
 * condition. Then one root lies between: balanced and lattice by their closed forms; for sine, sin(f -
 * theta_r - 2 theta) = cos 2phi sin(f + theta_r) falls through its right side once, as a possible rise
 * ends below it. Otherwise there is none. (printed: by scanning phi, theta_r and mu over their ranges.) */
rp_status ang_tilt(ang_form form, double mu, double theta_r, double phi, ang_tilt_result *result)
{
    *result = (ang_tilt_result){.theta_t = NAN};
    RP_TRY(check_common(form, theta_r, phi));
    RP_TRY(ang_marginal(mu, phi, &result->theta_ms, NULL));
    double root = isinf(mu) ? INFINITY : rp_hypot(1.0, mu);
    pile s = {form, phi, theta_r, isinf(mu) ? 1.0 : mu / root, 1.0 / root};
    result->margin = result->theta_ms - theta_r;
    result->limit = tilt_limit(form, theta_r, phi);
    double end = result->limit * (1.0 - 4.0 * GSL_DBL_EPSILON); /* the limit itself may be 0/0 */
    if (result->margin < 0.0) {
        result->status = ANG_TILT_ALREADY_UNSTABLE;
    } else if (result->limit <= 0.0) {
        result->status = ANG_TILT_RAYS_MISS;
    } else if (excess(end, &s) >= 0.0) {
        result->status = ANG_TILT_NO_SLIDE;
    } else if (excess(0.0, &s) <= 0.0) { /* on the margin, or beyond it by round-off */
        result->theta_t = 0.0;
    } else {
        RP_TRY(find_root(excess, &s, 0.0, end, root_tolerance, 4.0 * GSL_DBL_EPSILON, &result->theta_t));
        if (form == ANG_LATTICE && result->theta_t > M_PI_2 - phi) result->status = ANG_TILT_OK_PULLING;
    }
    return RP_OK;
}
