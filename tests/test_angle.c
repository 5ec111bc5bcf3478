/* The angle toolkit against closed forms, planted surfaces and GSL. */
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_fit.h>
#include <gsl/gsl_poly.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_statistics_double.h>

#include "angle/angle.h"
#include "tests/check.h"
#include "tests/numbers.h"

static const double deg = M_PI / 180.0;
/* a dozen rounded operations on numbers of order 1 */
static const double tight = 1e-14;
/* accuracy of theta_T, rad */
static const double root_error = 1e-12;
/* slopes of order 1: sums of 20 to 50 terms and their cancellation */
static const double sum_error = 1e-12;
/* a random quantity against its expectation: 4 of its standard errors; seeds are fixed */
static const double sigmas = 4.0;

/* ---- theory ---- */

static const double phis_deg[] = {31.7, 44.9, 52.3, 60.0, 73.9};
static const double mus[] = {0.0371, 0.2, 0.4385, 0.713, 1.931};
static const double fractions[] = {0.0, 0.137, 0.581, 0.967, 1.0}; /* of the steepest stable pile */

/* Every (phi, mu, theta_r) above with theta_r < phi. */
static void for_each_pile(void (*test)(double phi, double mu, double theta_r))
{
    for (int i = 0; i < 5; i++)
        for (int j = 0; j < 5; j++)
            for (int k = 0; k < 5; k++) {
                double phi = phis_deg[i] * deg, theta_ms;
                CHECK_OK(ang_marginal(mus[j], phi, &theta_ms, NULL));
                double theta_r = fractions[k] * theta_ms;
                if (theta_r < 0.99 * phi) test(phi, mus[j], theta_r);
            }
}

static double closed_form(ang_form form, double phi, double mu, double theta_r)
{
    double t = tan(theta_r), k = tan(phi) * tan(phi), f = atan(mu);
    if (form == ANG_SINE) return 0.5 * (f - theta_r - asin(cos(2.0 * phi) * sin(f + theta_r)));
    if (form == ANG_LATTICE) return atan((mu - t / k) / (1.0 - mu * t));
    double lead = 1.0 - mu * t, u[3] = {NAN, NAN, NAN};
    CU_ASSERT(gsl_poly_solve_cubic((t * k - mu) / lead, -(k + mu * t * (2.0 + k)) / lead, (mu * k - t) / lead,
                                   &u[0], &u[1], &u[2]) == 3);
    return atan(u[1]);
}

static void closed_forms_of(double phi, double mu, double theta_r)
{
    ang_tilt_result r;
    bool slides = atan(mu) + theta_r < M_PI_2;
    for (int form = 0; form < ANG_PRINTED; form++) {
        CHECK_OK(ang_tilt((ang_form)form, mu, theta_r, phi, &r));
        if (!slides) {
            CU_ASSERT(r.status == ANG_TILT_NO_SLIDE && isnan(r.theta_t));
        } else if (r.limit - closed_form((ang_form)form, phi, mu, theta_r) > 1e-9) {
            CHECK_NEAR(r.theta_t, closed_form((ang_form)form, phi, mu, theta_r), root_error);
            bool pulls = form == ANG_LATTICE && r.theta_t > M_PI_2 - phi;
            CU_ASSERT(r.status == (pulls ? ANG_TILT_OK_PULLING : ANG_TILT_OK));
        } else { /* a flat layer: the root lies beyond the inclination of the rays */
            CU_ASSERT(r.status == ANG_TILT_NO_SLIDE);
        }
    }
}

static void test_closed_forms(void)
{
    for_each_pile(closed_forms_of);
}

/* Each form requires less friction below theta_t and more above it, up to the limit. */
static void crossings_of(double phi, double mu, double theta_r)
{
    ang_tilt_result r;
    double needed;
    for (int form = 0; form < ANG_N_FORMS; form++) {
        CHECK_OK(ang_tilt((ang_form)form, mu, theta_r, phi, &r));
        double end = r.status == ANG_TILT_NO_SLIDE ? r.limit : r.theta_t;
        for (int i = 0; i < 50; i++) {
            double theta = end * i / 50.0;
            if (theta >= end) continue;
            CHECK_OK(ang_friction((ang_form)form, theta_r, theta, phi, &needed));
            CU_ASSERT(needed < mu + tight);
        }
        for (int i = 1; i < 50 && r.status == ANG_TILT_OK; i++) {
            CHECK_OK(ang_friction((ang_form)form, theta_r, end + (r.limit - end) * i / 50.0, phi, &needed));
            CU_ASSERT(needed > mu - tight || needed < 0.0); /* N < 0: the base grain lifts off */
        }
    }
}

static void test_crossings(void)
{
    for_each_pile(crossings_of);
}

/* T/N from rays in the frame of gravity, intersected with the flank, independent of the library. */
static double by_geometry(ang_form form, double phi, double theta_r, double theta)
{
    double turn = form == ANG_LATTICE ? theta : 0.0; /* rays turn with the pile or not */
    double up[2] = {cos(theta), sin(theta)}, normal[2] = {-sin(theta), cos(theta)};
    double flank[2] = {cos(theta + theta_r), sin(theta + theta_r)};
    double ray[2][2] = {{cos(phi + turn), sin(phi + turn)}, {-cos(phi - turn), sin(phi - turn)}};
    /* (0, -1) = -(F_A ray_A + F_B ray_B), by Cramer's rule */
    double det = ray[0][0] * ray[1][1] - ray[0][1] * ray[1][0];
    double share[2] = {-ray[1][0] / det, ray[0][0] / det}, t = 0.0, n = 0.0;
    for (int i = 0; i < 2; i++) {
        /* s ray = 1.37 normal + w flank */
        double cross = ray[i][0] * flank[1] - ray[i][1] * flank[0];
        double chord = 1.37 * (normal[0] * flank[1] - normal[1] * flank[0]) / cross;
        double width = fabs(ray[i][0] * up[1] - ray[i][1] * up[0]);
        double force = form == ANG_SINE ? chord : chord * width * share[i];
        t += force * (ray[i][0] * up[0] + ray[i][1] * up[1]);
        n += force * (ray[i][0] * normal[0] + ray[i][1] * normal[1]);
    }
    return t / n;
}

static void test_geometry(void)
{
    for (int form = 0; form < ANG_PRINTED; form++)
        for (int i = 0; i < 5; i++) {
            double phi = phis_deg[i] * deg, mu;
            for (int j = 0; j < 4; j++) {
                double theta_r = 0.231 * j * phi, theta = 0.83 * (phi - theta_r);
                CHECK_OK(ang_friction((ang_form)form, theta_r, theta, phi, &mu));
                CHECK_NEAR(mu / by_geometry((ang_form)form, phi, theta_r, theta), 1.0, 10.0 * tight);
            }
        }
}

static void test_reference_angles(void)
{
    static const struct {
        ang_form form;
        double pile_deg, layer_deg;
        double pile_digit, layer_digit; /* half the last digit given */
    } known[] = {{ANG_PRINTED, 3.533, 4.87, 5e-4, 5e-3},
                 {ANG_SINE, 3.739, 8.47, 5e-4, 5e-3},
                 {ANG_BALANCED, 4.83, 11.31, 5e-3, 5e-3},
                 {ANG_LATTICE, 5.60, 11.31, 5e-3, 5e-3}};
    ang_tilt_result r;
    for (int i = 0; i < 4; i++) {
        CHECK_OK(ang_tilt(known[i].form, 0.2, 18.0 * deg, 60.0 * deg, &r));
        CHECK_NEAR(r.theta_t / deg, known[i].pile_deg, known[i].pile_digit);
        CHECK_NEAR(r.margin / deg, 12.96, 5e-3);
        CHECK_OK(ang_tilt(known[i].form, 0.2, 0.0, 60.0 * deg, &r));
        CHECK_NEAR(r.theta_t / deg, known[i].layer_deg, known[i].layer_digit);
    }
}

/* At theta_T = 0 the forms must equal (3); the printed one requires half the friction. */
static void test_zero_tilt(void)
{
    double t = tan(0.3127), mu, third = M_PI / 3.0, theta_ms;
    ang_tilt_result r;
    for (int form = 0; form < ANG_N_FORMS; form++) {
        CHECK_OK(ang_friction((ang_form)form, 0.3127, 0.0, third, &mu));
        CHECK_NEAR(mu, form == ANG_PRINTED ? t / 6.0 : t / 3.0, tight);
        CHECK_OK(ang_friction((ang_form)form, 0.3127, 0.0, 0.823, &mu));
        CHECK_NEAR(mu, t / pow(tan(0.823), 2.0) * (form == ANG_PRINTED ? cos(0.823) : 1.0), tight);
        CHECK_OK(ang_marginal(0.2385, 0.823, &theta_ms, NULL));
        CHECK_OK(ang_tilt((ang_form)form, 0.2385, theta_ms, 0.823, &r));
        CU_ASSERT(r.status == ANG_TILT_OK && r.margin == 0.0);
        if (form != ANG_PRINTED) CHECK_NEAR(r.theta_t, 0.0, root_error);
        if (form == ANG_PRINTED) CU_ASSERT(r.theta_t > deg);
    }
}

static void test_marginal(void)
{
    double theta;
    bool extrapolated;
    CHECK_OK(ang_marginal(0.2385, M_PI / 3.0, &theta, &extrapolated));
    CHECK_NEAR(theta, atan(3.0 * 0.2385), tight);
    CU_ASSERT(!extrapolated);
    CHECK_OK(ang_marginal(0.2385, 0.913, &theta, NULL));
    CHECK_NEAR(tan(theta), 0.2385 * pow(tan(0.913), 2.0), tight);
    CHECK_OK(ang_marginal(0.0, 0.913, &theta, NULL));
    CHECK_NEAR(theta, 0.0, 0.0);
    CHECK_OK(ang_marginal(INFINITY, 0.913, &theta, &extrapolated));
    CHECK_NEAR(theta, M_PI_2, 0.0);
    CU_ASSERT(extrapolated);
    CHECK_OK(ang_marginal(0.58, M_PI / 3.0, &theta, &extrapolated)); /* cot(pi/3) = 0.577 */
    CU_ASSERT(extrapolated);
}

static void test_tilt_without_root(void)
{
    ang_tilt_result r;
    for (int i = 0; i < ANG_N_FORMS; i++) {
        ang_form form = (ang_form)i;
        CHECK_OK(ang_tilt(form, 0.2, 35.0 * deg, 60.0 * deg, &r));
        CU_ASSERT(r.status == ANG_TILT_ALREADY_UNSTABLE && isnan(r.theta_t));
        CHECK_NEAR(r.margin, atan(0.6) - 35.0 * deg, tight);
        CHECK_OK(ang_tilt(form, 0.0, 0.013, 1.0, &r));
        CU_ASSERT(r.status == ANG_TILT_ALREADY_UNSTABLE);
        CHECK_OK(ang_tilt(form, 0.0, 0.0, 1.0, &r));
        CU_ASSERT(r.status == ANG_TILT_OK);
        CHECK_NEAR(r.theta_t, 0.0, 0.0);
        for (double theta_r = 0.0; theta_r < 1.0; theta_r += 0.237) {
            CHECK_OK(ang_tilt(form, INFINITY, theta_r, 1.0, &r));
            CU_ASSERT(r.status == ANG_TILT_NO_SLIDE && isnan(r.theta_t));
            CHECK_NEAR(r.theta_ms, M_PI_2, 0.0);
        }
        CHECK_OK(ang_tilt(form, 50.0, 1.57, 1.56, &r));
        CU_ASSERT(r.status == ANG_TILT_RAYS_MISS && r.margin > 0.0);
    }
    CHECK_OK(ang_tilt(ANG_BALANCED, 5.0, 0.4385, 1.0, &r)); /* limits: phi - theta_r; sin a = t cos^2 a */
    CHECK_NEAR(r.limit, 1.0 - 0.4385, tight);
    CHECK_OK(ang_tilt(ANG_PRINTED, 5.0, 0.4385, 0.913, &r));
    double a = 0.913 - r.limit;
    CHECK_NEAR(sin(a), tan(0.4385) * cos(a) * cos(a), tight);
    CHECK_OK(ang_tilt(ANG_PRINTED, 0.2, 0.1, 1.2, &r));
    CHECK_NEAR(r.limit, M_PI_2 - 1.2, tight);
}

static void test_theory_errors(void)
{
    ang_tilt_result r;
    double v;
    CHECK_FAILS(ang_marginal(-0.1, 1.0, &v, NULL), RP_BAD_INPUT, "mu = -0.1");
    CHECK_FAILS(ang_marginal(NAN, 1.0, &v, NULL), RP_BAD_INPUT, "mu");
    CHECK_FAILS(ang_marginal(0.1, 0.0, &v, NULL), RP_BAD_INPUT, "phi = 0");
    CHECK_FAILS(ang_marginal(0.1, M_PI_2, &v, NULL), RP_BAD_INPUT, "phi");
    CHECK_FAILS(ang_marginal(0.1, NAN, &v, NULL), RP_BAD_INPUT, "phi");
    CHECK_FAILS(ang_tilt(ANG_SINE, -1.0, 0.1, 1.0, &r), RP_BAD_INPUT, "mu = -1");
    CHECK_FAILS(ang_tilt(ANG_SINE, 0.2, -0.1, 1.0, &r), RP_BAD_INPUT, "theta_r = -0.1");
    CHECK_FAILS(ang_tilt(ANG_SINE, 0.2, M_PI_2, 1.0, &r), RP_BAD_INPUT, "theta_r");
    CHECK_FAILS(ang_tilt(ANG_SINE, 0.2, NAN, 1.0, &r), RP_BAD_INPUT, "theta_r");
    CHECK_FAILS(ang_tilt(ANG_SINE, 0.2, 0.1, 1.6, &r), RP_BAD_INPUT, "phi = 1.6");
    CHECK_FAILS(ang_tilt(ANG_N_FORMS, 0.2, 0.1, 1.0, &r), RP_BAD_INPUT, "form = 4");
    CHECK_FAILS(ang_friction(ANG_SINE, 1.1, 0.1, 1.0, &v), RP_BAD_INPUT, "theta_r = 1.1");
    CHECK_FAILS(ang_friction(ANG_SINE, 0.3, 0.71, 1.0, &v), RP_BAD_INPUT, "theta_t = 0.71");
    CHECK_FAILS(ang_friction(ANG_SINE, 0.3, -0.01, 1.0, &v), RP_BAD_INPUT, "theta_t");
}

/* ---- surface ---- */

#define scoped_surface __attribute__((cleanup(ang_surface_free))) ang_surface

/* 2.13/0.2 rounds to 11 cells of 0.19363...; grains 0 to 5 lie in cells 0, 0, 1, 3, 4, 10. */
static const double grain_x[] = {0.0, 0.1, 0.25, 0.6, 0.9, 2.1299999, 2.13, -0.01};
static const double grain_y[] = {1.3, 1.21, 0.95, 0.07, 0.41, 0.1, 9.0, 9.0};
static const double grain_r[] = {0.08, 0.19, 0.1, 0.11, 0.12, 0.1, 0.1, 0.1};
enum { N_GRAINS = 8 };

static void check_heights(const ang_options *options, size_t n, const double expected[])
{
    scoped_surface s;
    CHECK_OK(ang_surface_make(N_GRAINS, grain_x, grain_y, grain_r, 2.13, options, &s));
    CU_ASSERT(s.n_cells == 11 && s.n_occupied == 5 && s.n == n);
    CHECK_NEAR(s.cell, 2.13 / 11.0, tight);
    for (size_t k = 0; k < s.n && k < n; k++) CHECK_NEAR(s.h[k], expected[k], tight);
    CU_ASSERT(s.n == 11 ? s.column[10] == 10 : s.column[2] == 3 && s.column[4] == 10);
}

static void test_surface(void)
{
    ang_options o = ANG_OPTIONS_DEFAULT;
    check_heights(&o, 11, (double[]){1.2, 0.85, 0.0, 0.0, 0.31, 0, 0, 0, 0, 0, 0.0});
    o.height = ANG_RAW_CENTRE;
    check_heights(&o, 11, (double[]){1.3, 0.95, 0.0, 0.07, 0.41, 0, 0, 0, 0, 0, 0.1});
    o.height = ANG_TOP;
    check_heights(&o, 11, (double[]){1.4, 1.05, 0.0, 0.18, 0.53, 0, 0, 0, 0, 0, 0.2});
    /* the last number below the width can divide to n_cells; it belongs to the last cell */
    for (double width = 1.01; width < 6.0; width += 0.037) {
        double x[] = {0.1, 0.3, 0.5, 0.7, nextafter(width, 0.0)};
        scoped_surface s;
        ang_options raw = {0.2, ANG_RAW_CENTRE, ANG_EMPTY_ZERO, ANG_PARABOLA_FREE};
        CHECK_OK(ang_surface_make(5, x, grain_y, NULL, width, &raw, &s));
        CHECK_NEAR(s.h[s.n_cells - 1], grain_y[4], 0.0);
    }
    o.empty = ANG_EMPTY_SKIP;
    check_heights(&o, 5, (double[]){1.4, 1.05, 0.18, 0.53, 0.2});
}

/* Each grain whose position, or radius, is infinite is refused by its number. */
static void refuse_grains(const ang_options *o, const char *what)
{
    ang_surface s;
    for (int i = 0; i < N_GRAINS; i++) {
        double x[N_GRAINS], r[N_GRAINS];
        memcpy(x, grain_x, sizeof x);
        memcpy(r, grain_r, sizeof r);
        *(strcmp(what, "radius") == 0 ? &r[i] : &x[i]) = INFINITY;
        const char *text = check_text("grain %d: %s", i + 1, what);
        CHECK_FAILS(ang_surface_make(N_GRAINS, x, grain_y, r, 2.13, o, &s), RP_BAD_INPUT, text);
    }
}

static void test_surface_errors(void)
{
    ang_options o = ANG_OPTIONS_DEFAULT;
    ang_surface s;
    double bad[N_GRAINS] = {0.1, NAN, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1};
#define MAKE(n, y, r, width) ang_surface_make(n, grain_x, y, r, width, &o, &s)
    CHECK_FAILS(MAKE(5, grain_y, NULL, 2.13), RP_NO_RESULT, "4 of 11 cells");
    ang_surface_free(&s);
    CHECK_FAILS(MAKE(0, grain_y, NULL, 2.13), RP_NO_RESULT, "0 of 11 cells");
    CU_ASSERT(s.n_cells == 11 && s.n_occupied == 0);
    ang_surface_free(&s);
    CHECK_FAILS(MAKE(N_GRAINS, bad, NULL, 2.13), RP_BAD_INPUT, "grain 2");
    refuse_grains(&o, "position");
    CHECK_FAILS(MAKE(N_GRAINS, grain_y, NULL, 0.0), RP_BAD_INPUT, "width = 0: out of range");
    CHECK_FAILS(MAKE(N_GRAINS, grain_y, NULL, NAN), RP_BAD_INPUT, "width");
    CHECK_FAILS(MAKE(N_GRAINS, grain_y, NULL, 0.09), RP_BAD_INPUT, "0 cells");
    CHECK_FAILS(MAKE(N_GRAINS, grain_y, NULL, 1e30), RP_BAD_INPUT, "allowed: 1 to 1e+08");
    o.height = ANG_TOP;
    CHECK_FAILS(MAKE(N_GRAINS, grain_y, NULL, 2.13), RP_BAD_INPUT, "radii");
    CHECK_FAILS(MAKE(N_GRAINS, grain_y, bad, 2.13), RP_BAD_INPUT, "grain 2: radius");
    refuse_grains(&o, "radius");
    o.diameter = -0.2;
    CHECK_FAILS(MAKE(N_GRAINS, grain_y, grain_r, 2.13), RP_BAD_INPUT, "diameter) = -0.2");
    ang_surface_free(&s);
#undef MAKE
}

/* ---- slopes ---- */

/* A straight surface keeps its slope, whatever cells are missing, and has no error. */
static void test_exact_lines(void)
{
    static const size_t gaps[] = {1, 2, 3, 7, 8, 12, 13, 14, 19};
    ang_slope s[ANG_N_METHODS];
    double h[50];
    for (int parabola = 0; parabola < 2; parabola++)
        for (size_t n = 3; n <= 50; n += 3)
            for (double slope = -0.7; slope < 1.0; slope += 0.341) {
                bool skip = n == 9;
                for (size_t k = 0; k < n; k++) h[k] = 3.17 - slope * 0.193 * (double)(skip ? gaps[k] : k);
                CHECK_OK(ang_slopes(n, skip ? gaps : NULL, h, 0.193, (ang_parabola)parabola, s));
                for (int m = 0; m < ANG_N_METHODS; m++)
                    CHECK_PAIRS(sum_error, {s[m].slope, slope}, {s[m].theta, atan(slope)},
                                {s[m].slope_se, 0.0});
            }
}

/* The paper's method: second derivative of a parabola fitted to the running sum; se from that fit. */
static double fit_running_sum(size_t n, const double h[], double cell, bool origin, double *se)
{
    enum { MOST = 50 };
    const size_t p = origin ? 2 : 3;
    double X[3 * MOST], y[MOST], c[3], cov[9], sum = 0.0;
    for (size_t j = 0; j < n; j++) {
        y[j] = sum += h[j];
        for (size_t k = 0; k < p; k++) X[p * j + k] = pow((double)(j + 1), 2.0 - (double)k);
    }
    numbers_fit(n, p, X, NULL, y, c, cov);
    *se = 2.0 * sqrt(cov[0]) / cell;
    return -2.0 * c[0] / cell;
}

static void rough_line(gsl_rng *rng, size_t n, double slope, double cell, double h[])
{
    for (size_t j = 0; j < n; j++) h[j] = 2.385 - slope * cell * (double)j + gsl_ran_gaussian(rng, 0.11);
}

/* Methods 1 and 2 by the sums of least squares, method 3 by a fit of GSL to the running sum. */
static void test_methods(void)
{
    scoped_rng *rng = numbers_of(1, 0);
    ang_slope s[ANG_N_METHODS], mirrored[ANG_N_METHODS];
    double h[37], back[37], naive, mean = 0.0, sxx = 0.0, sxh = 0.0, shh = 0.0;
    rough_line(rng, 37, 0.41, 0.193, h);
    for (size_t j = 0; j < 37; j++) {
        back[j] = h[36 - j];
        mean += h[j] / 37.0;
    }
    for (int parabola = 0; parabola < 2; parabola++) {
        CHECK_OK(ang_slopes(37, NULL, h, 0.193, (ang_parabola)parabola, s));
        CHECK_NEAR(s[2].slope, fit_running_sum(37, h, 0.193, parabola == ANG_PARABOLA_ORIGIN, &naive),
                   sum_error);
    }
    CHECK_OK(ang_slopes(37, NULL, h, 0.193, ANG_PARABOLA_FREE, s));
    CHECK_NEAR(s[0].slope, (h[0] - h[36]) / (36.0 * 0.193), sum_error);
    for (size_t j = 0; j < 37; j++) {
        const double x = 0.193 * ((double)j - 18.0);
        sxx += x * x;
        sxh += x * (h[j] - mean);
        shh += (h[j] - mean) * (h[j] - mean);
    }
    const double slope = sxh / sxx, variance = (shh - slope * sxh) / 35.0;
    CHECK_PAIRS(sum_error, {s[1].slope, -slope}, {s[1].slope_se, sqrt(variance / sxx)},
                {s[0].slope_se, sqrt(2.0 * variance) / (36.0 * 0.193)},
                {s[1].theta_se, sqrt(variance / sxx) / (1.0 + slope * slope)});
    CHECK_OK(ang_slopes(37, NULL, back, 0.193, ANG_PARABOLA_FREE, mirrored));
    for (int m = 0; m < 2; m++) CHECK_NEAR(mirrored[m].slope, -s[m].slope, sum_error);
}

/* An excluded cell enters the sum as the mean of its neighbours. */
static void test_gap(void)
{
    static const size_t column[] = {0, 1, 3, 4, 5, 8, 9};
    static const double h[] = {2.1, 1.7, 1.9, 1.2, 1.3, 0.4, 0.6};
    double full[10] = {2.1, 1.7, 1.8, 1.9, 1.2, 1.3, 0.85, 0.85, 0.4, 0.6};
    double z3 = 0.0, z2 = 0.0, top = 0.0, norm = 0.0,
           sum = 0.0; /* parabola through 0 at the positions used */
    ang_slope s[ANG_N_METHODS];
    for (int k = 0; k < 7; k++) {
        double z = (double)(column[k] + 1);
        z2 += z * z;
        z3 += z * z * z;
    }
    for (size_t j = 0, k = 0; j < 10; j++) {
        sum += full[j];
        if (column[k] != j) continue;
        double z = (double)(j + 1), e = z * z - z3 / z2 * z;
        top += e * sum;
        norm += e * e;
        k++;
    }
    CHECK_OK(ang_slopes(7, column, h, 0.5, ANG_PARABOLA_ORIGIN, s));
    CHECK_PAIRS(sum_error, {s[2].slope, -2.0 * top / norm / 0.5}, {s[0].slope, 1.5 / 4.5});
}

/* Propagated errors match the scatter over an ensemble; the parabola's own do not. */
static void test_propagated_errors(void)
{
    enum { N = 20 };
    const size_t n_piles = check_fast() ? 1000 : 10000;
    scoped_rng *rng = numbers_of(2, 0);
    for (int parabola = 0; parabola < 2; parabola++) {
        double sum[3] = {0}, squares[3] = {0}, predicted[3] = {0}, naive_squares = 0.0, h[N], naive;
        ang_slope s[ANG_N_METHODS];
        for (size_t i = 0; i < n_piles; i++) {
            rough_line(rng, N, 0.35, 0.2, h);
            CHECK_OK(ang_slopes(N, NULL, h, 0.2, (ang_parabola)parabola, s));
            for (int m = 0; m < 3; m++) {
                sum[m] += s[m].slope - 0.35;
                squares[m] += pow(s[m].slope - 0.35, 2.0);
                predicted[m] += s[m].slope_se * s[m].slope_se;
            }
            fit_running_sum(N, h, 0.2, parabola == ANG_PARABOLA_ORIGIN, &naive);
            naive_squares += naive * naive;
        }
        double many = (double)n_piles;
        /* relative error of a standard deviation from M piles, 1/sqrt(2 M), and of the predicted variance */
        double uncertainty = sqrt(1.0 / (2.0 * many) + 1.0 / (2.0 * (N - 2.0) * many));
        for (int m = 0; m < 3; m++) {
            CHECK_NEAR(sum[m] / many, 0.0, sigmas * sqrt(squares[m]) / many);
            CHECK_NEAR(sqrt(predicted[m] / squares[m]), 1.0, sigmas * uncertainty);
        }
        /* about a third */
        if (parabola == ANG_PARABOLA_FREE) CHECK_NEAR(sqrt(squares[2] / naive_squares), 3.0, 0.5);
    }
}

/* Piles of random grains below a planted line: every method recovers its slope. */
static void test_planted_heaps(void)
{
    enum { N = 3000, PILES = 60 };
    scoped_rng *rng = numbers_of(3, 0);
    ang_options o = ANG_OPTIONS_DEFAULT;
    double x[N], y[N], slopes[ANG_N_METHODS][PILES];
    const double slope = 0.3249, width = 4.0;
    for (int i = 0; i < PILES; i++) {
        scoped_surface surface;
        ang_slope s[ANG_N_METHODS];
        /* uniform below the line, so that the deviation has the same distribution in every cell */
        for (int k = 0; k < N;) {
            x[k] = width * gsl_rng_uniform(rng);
            y[k] = 2.5 * gsl_rng_uniform(rng);
            k += y[k] < 2.5 - slope * x[k];
        }
        CHECK_OK(ang_surface_make(N, x, y, NULL, width, &o, &surface));
        CHECK_OK(ang_slopes(surface.n, surface.column, surface.h, surface.cell, o.parabola, s));
        for (int m = 0; m < ANG_N_METHODS; m++) slopes[m][i] = s[m].slope;
    }
    for (int m = 0; m < ANG_N_METHODS; m++) {
        stats_summary stats;
        CHECK_OK(stats_mean(PILES, slopes[m], &stats));
        CHECK_NEAR(stats.mean, slope, sigmas * stats.se);
        CU_ASSERT(stats.se < 0.01);
    }
}

static void test_slope_errors(void)
{
    ang_slope s[ANG_N_METHODS];
    double h[4] = {3.0, 2.0, NAN, 1.0};
    size_t column[4] = {0, 2, 2, 3};
    CHECK_FAILS(ang_slopes(2, NULL, h, 0.2, ANG_PARABOLA_FREE, s), RP_BAD_INPUT, "2 cells");
    CHECK_FAILS(ang_slopes(4, NULL, h, 0.2, ANG_PARABOLA_FREE, s), RP_BAD_INPUT, "height 3");
    CHECK_FAILS(ang_slopes(4, NULL, h, 0.0, ANG_PARABOLA_FREE, s), RP_BAD_INPUT, "cell = 0");
    h[2] = 1.5;
    CHECK_FAILS(ang_slopes(4, column, h, 0.2, ANG_PARABOLA_FREE, s), RP_BAD_INPUT, "column 3");
    CHECK_FAILS(ang_slopes(4, (size_t[]){1, 1, 2, 3}, h, 0.2, ANG_PARABOLA_FREE, s), RP_BAD_INPUT,
                "column 2");
    CHECK_FAILS(ang_slopes(4, (size_t[]){0, 1, 2, 1}, h, 0.2, ANG_PARABOLA_FREE, s), RP_BAD_INPUT,
                "column 4");
    CHECK_OK(ang_slopes(3, NULL, h, 0.2, ANG_PARABOLA_FREE, s));
    for (int i = 0; i < 4; i++) {
        const double kept = h[i];
        const char *text = check_text("height %d", i + 1);
        h[i] = INFINITY;
        CHECK_FAILS(ang_slopes(4, NULL, h, 0.2, ANG_PARABOLA_FREE, s), RP_BAD_INPUT, text);
        h[i] = kept;
    }
}

/* ---- ensembles ---- */

static void test_mean(void)
{
    static const double v[] = {2.385, 1.172, 3.906, 2.041}, same[] = {0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1},
                        none[] = {2.385, NAN}; /* of the first one alone */
    stats_summary s;
    CHECK_OK(stats_mean(4, v, &s));
    CHECK_NEAR(s.mean, 2.376, tight);
    double sd = sqrt((0.009 * 0.009 + 1.204 * 1.204 + 1.53 * 1.53 + 0.335 * 0.335) / 3.0);
    CHECK_PAIRS(tight, {s.sd, sd}, {s.se, sd / 2.0});
    /* Student's t of 97.5 % with 3 degrees of freedom, from tables, half a digit */
    CHECK_PAIRS(5e-7, {(s.hi - s.mean) / s.se, 3.182446}, {(s.mean - s.lo) / s.se, 3.182446});
    CHECK_OK(stats_mean(2, v, &s));
    CHECK_NEAR((s.hi - s.mean) / s.se, 12.706205, 5e-7);
    CHECK_NEAR(s.se, (2.385 - 1.172) / 2.0, tight);
    CHECK_OK(stats_mean(7, same, &s));
    CU_ASSERT(s.n == 7 && s.mean == 0.1 && s.sd == 0.0 && s.lo == 0.1 && s.hi == 0.1);
    CHECK_OK(stats_mean(1, none, &s));
    CU_ASSERT(s.n == 1 && s.mean == 2.385 && isnan(s.sd) && isnan(s.se) && isnan(s.lo) && isnan(s.hi));
    CHECK_FAILS(stats_mean(0, v, &s), RP_NO_RESULT, "no values");
    CU_ASSERT(s.n == 0 && isnan(s.mean));
    CHECK_FAILS(stats_mean(2, (double[]){1.0, INFINITY}, &s), RP_BAD_INPUT, "value 2");
    CU_ASSERT(isnan(s.mean));
    for (double unit = 1e-300; unit < 1e301; unit *= 1e300) { /* squares neither vanish nor overflow */
        CHECK_OK(stats_mean(2, (double[]){unit, 3.0 * unit}, &s));
        CHECK_PAIRS(tight, {s.mean / unit, 2.0}, {s.se / unit, 1.0});
    }
    CHECK_FAILS(stats_mean(2, (double[]){1e308, -1e308}, &s), RP_NO_RESULT, "their sum overflows");
    CU_ASSERT(isnan(s.mean));
}

static void test_paired(void)
{
    static const double a[] = {20.1, 18.7, 17.2}, b[] = {18.9, 17.1, 16.4};
    static const double same[2][7] = {{0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1},
                                      {0.7, 0.7, 0.7, 0.7, 0.7, 0.7, 0.7}},
                        none[2][2] = {{20.1, NAN}, {18.9, NAN}};
    stats_summary s;
    CHECK_OK(stats_paired(3, a, -1.0, b, &s));
    CHECK_NEAR(s.mean, 1.2, tight);
    CHECK_NEAR(s.sd, 0.4, 10.0 * tight);
    CHECK_OK(stats_paired(3, a, 1.0, b, &s));
    CHECK_NEAR(s.mean, (39.0 + 35.8 + 33.6) / 3.0, 10.0 * tight);
    CHECK_OK(stats_paired(7, same[0], 3.0, same[1], &s)); /* equal values have no spread at all */
    CU_ASSERT(s.mean == 0.1 + 3.0 * 0.7 && s.sd == 0.0 && s.se == 0.0);
    CHECK_OK(stats_paired(1, none[0], -1.0, none[1], &s));
    CHECK_NEAR(s.mean, 1.2, tight);
    CHECK_FAILS(stats_paired(3, a, -1.0, (double[]){1.0, 2.0, NAN}, &s), RP_BAD_INPUT, "value 3");
    CHECK_FAILS(stats_paired(0, a, -1.0, b, &s), RP_NO_RESULT, "no values");
}

static void test_line_fit(void)
{
    static const double x[] = {0.05, 0.1, 0.15, 0.2, 0.25}, y[] = {5.31, 10.7, 14.2, 19.3, 21.8};
    static const double se[] = {0.41, 0.33, 0.52, 0.29, 0.71};
    double sw = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
    stats_line line;
    for (int i = 0; i < 5; i++) {
        const double w = 1.0 / (se[i] * se[i]);
        sw += w, sx += w * x[i], sy += w * y[i];
        sxx += w * x[i] * x[i], sxy += w * x[i] * y[i], syy += w * y[i] * y[i];
    }
    /* the normal equations; sums up to 1e4, cancellation of a few digits */
    const double fit_error = 1e-10, det = sw * sxx - sx * sx;
    const double slope = (sw * sxy - sx * sy) / det, intercept = (sxx * sy - sx * sxy) / det;
    const double chi2 = syy - intercept * sy - slope * sxy;
    CHECK_OK(stats_line_fit(&(stats_xy){5, x, y, se}, false, &line));
    CHECK_PAIRS(fit_error, {line.slope, slope}, {line.intercept, intercept}, {line.slope_se, sqrt(sw / det)},
                {line.intercept_se, sqrt(sxx / det)}, {line.covariance, -sx / det}, {line.chi2, chi2},
                {line.p_value, gsl_cdf_chisq_Q(chi2, 3.0)});
    CU_ASSERT(line.n == 5 && line.dof == 3);
    CHECK_OK(stats_line_fit(&(stats_xy){5, x, y, se}, true, &line));
    CHECK_PAIRS(fit_error, {line.slope, sxy / sxx}, {line.slope_se, 1.0 / sqrt(sxx)},
                {line.chi2, syy - sxy * sxy / sxx});
    CU_ASSERT(line.dof == 4 && line.intercept == 0.0 && line.covariance == 0.0);
    double gsl[6];
    gsl_fit_wlinear(x, 1, (double[]){1, 2, 3, 4, 5}, 1, y, 1, 5, &gsl[0], &gsl[1], &gsl[2], &gsl[3], &gsl[4],
                    &gsl[5]);
    CHECK_OK(stats_line_fit(&(stats_xy){5, x, y, (double[]){1, M_SQRT1_2, 1 / sqrt(3.0), 0.5, 1 / sqrt(5.0)}},
                            false, &line));
    CHECK_PAIRS(1e-12, {line.slope, gsl[1]}, {line.intercept_se * line.intercept_se, gsl[2]},
                {line.chi2, gsl[5]});
    /* without errors, by hand: slope 1/2, residuals 1/6, -1/3, 1/6 */
    CHECK_OK(stats_line_fit(&(stats_xy){3, (double[]){1, 2, 3}, (double[]){1, 1, 2}, NULL}, false, &line));
    CHECK_PAIRS(tight, {line.slope, 0.5}, {line.intercept, 1.0 / 3.0}, {line.chi2, 1.0 / 6.0},
                {line.slope_se, sqrt(1.0 / 12.0)}, {line.intercept_se, sqrt(14.0 / 36.0)},
                {line.covariance, -1.0 / 6.0});
    CU_ASSERT(isnan(line.p_value) && line.dof == 1);
    CHECK_OK(stats_line_fit(&(stats_xy){3, (double[]){1, 2, 3}, (double[]){1, 1, 2}, NULL}, true,
                            &line)); /* 9/14 x */
    CHECK_NEAR(line.slope, 9.0 / 14.0, tight);
    CHECK_OK(stats_line_fit(&(stats_xy){2, (double[]){1, 1}, (double[]){3, 4}, NULL}, true,
                            &line)); /* one x is enough */
    CHECK_NEAR(line.slope, 3.5, tight);
    CHECK_OK(stats_line_fit(&(stats_xy){3, (double[]){1, 2, 3}, (double[]){1, 1, 2}, NULL}, true, &line));
    CHECK_NEAR(line.slope_se, sqrt((6.0 - 81.0 / 14.0) / 2.0 / 14.0), tight);
    CHECK_OK(stats_line_fit(&(stats_xy){2, x, y, NULL}, false, &line));
    CU_ASSERT(isnan(line.slope_se) && line.dof == 0);
    CHECK_OK(stats_line_fit(&(stats_xy){2, x, y, se}, false, &line));
    CHECK_NEAR(line.slope, (10.7 - 5.31) / 0.05, fit_error);
    CU_ASSERT(line.dof == 0 && isnan(line.p_value));
    static const struct {
        size_t n;
        double x[2], y[2], se[2];
        bool origin;
        rp_status status;
        const char *text;
    } failures[] = {{0, {1, 2}, {1, 1}, {1, 1}, false, RP_NO_RESULT, "0 points"},
                    {1, {1, 2}, {1, 1}, {1, 1}, false, RP_NO_RESULT, "1 points"},
                    {2, {1, 2}, {1e-300, 2e-300}, {1, 1}, false, RP_NO_RESULT, "so large or small"},
                    {2, {0.3, 0.1 + 0.2}, {1, 1}, {1, 1}, false, RP_NO_RESULT, "two different x"},
                    {1, {0, 2}, {1, 1}, {1, 1}, true, RP_NO_RESULT, "other than 0"},
                    {2, {0, 0}, {3, 4}, {1, 1}, true, RP_NO_RESULT, "an x other than 0"},
                    {2, {1, 2}, {1, NAN}, {1, 1}, false, RP_BAD_INPUT, "point 2"},
                    {2, {NAN, 1}, {1, 1}, {1, 1}, false, RP_BAD_INPUT, "point 1"},
                    {2, {1, INFINITY}, {1, 1}, {1, 1}, false, RP_BAD_INPUT, "point 2"},
                    {2, {1, 2}, {1, 1}, {1, 0}, false, RP_BAD_INPUT, "standard error = 0"},
                    {2, {1, 2}, {1, 1}, {NAN, 1}, false, RP_BAD_INPUT, "point 1"},
                    {2, {1, 2}, {1, 1}, {INFINITY, 1}, false, RP_BAD_INPUT, "point 1"},
                    {2, {1, 2}, {1, 1}, {1, INFINITY}, false, RP_BAD_INPUT, "point 2"}};
    for (size_t k = 0; k < sizeof failures / sizeof *failures; k++)
        CHECK_FAILS(stats_line_fit(&(stats_xy){failures[k].n, failures[k].x, failures[k].y, failures[k].se},
                                   failures[k].origin, &line),
                    failures[k].status, failures[k].text);
    CHECK_FAILS(stats_line_fit(&(stats_xy){2, (double[]){0, 0}, y, NULL}, true, &line), RP_NO_RESULT,
                "an x other than 0");
}

/* ---- one series in time ---- */

/* x(k + 1) = phi x(k) + noise, of variance 1, started in its stationary state. */
static void autoregressive(gsl_rng *rng, double phi, size_t n, double v[])
{
    v[0] = gsl_ran_gaussian(rng, 1.0);
    for (size_t i = 1; i < n; i++) v[i] = phi * v[i - 1] + gsl_ran_gaussian(rng, sqrt(1.0 - phi * phi));
}

/* Variance of the mean of n of its values. */
static double mean_variance(double phi, double n)
{
    return ((1.0 + phi) / (1.0 - phi) - 2.0 * phi * (1.0 - pow(phi, n)) / (n * (1.0 - phi) * (1.0 - phi))) /
           n;
}

static void test_blocking(void)
{
    enum { N = 16384, SERIES = 200 }; /* 20 blocks or more */
    static double v[N], work[N];
    scoped_rng *rng = numbers_of(11, 0);
    for (double phi = 0.0; phi < 0.95; phi += 0.3) {
        double variance = 0.0, expected = 0.0, tau = 0.0, spread = 0.0, error = 0.0, se = 0.0;
        for (int s = 0; s < SERIES; s++) {
            stats_series b;
            autoregressive(rng, phi, N, v);
            CHECK_OK(stats_blocking(N, v, work, &b));
            const double blocks = floor(N / (double)b.block);
            variance += b.se * b.se / SERIES;
            se += b.se / SERIES;
            /* blocks correlate a little: E(scatter) of means of b.block values about that of all */
            expected += (mean_variance(phi, (double)b.block) - mean_variance(phi, N)) / (blocks - 1) / SERIES;
            tau += b.tau / SERIES;
            spread += b.mean * b.mean / SERIES;
            error += 2.0 * b.se_error / b.se / SERIES; /* relative, of the variance */
        }
        /* relative errors: of a variance from SERIES means; of the mean of SERIES estimates; and since B is
         * chosen by the estimate itself, low ones are met a little more often */
        const double rough = sigmas * sqrt(2.0 / SERIES), fine = sigmas * error / sqrt(SERIES) + 0.02;
        /* the scatter of the errors themselves, to that of 200 and of the plateaus' lengths */
        CHECK_NEAR(sqrt(variance - se * se) / (0.5 * error * se), 1.0, sigmas / sqrt(2.0 * SERIES) + 0.1);
        CHECK_NEAR(spread / mean_variance(phi, N), 1.0, rough);
        CHECK_NEAR(variance / expected, 1.0, fine);
        CHECK_NEAR(expected / mean_variance(phi, N), 1.0, 0.1); /* bias of the blocks, 2 tau/B at most */
        CHECK_NEAR(tau / (0.5 * (1.0 + phi) / (1.0 - phi)), 1.0, fine + 0.1);
    }
}

/* A series of any length has an interval that misses the truth no more often than one in twenty, and few
 * independent values have none. */
static void test_blocking_short(void)
{
    enum { MOST = 256, SERIES = 2000 };
    double v[MOST], work[MOST];
    scoped_rng *rng = numbers_of(17, 0);
    for (size_t n = 16; n <= MOST; n *= 2)
        for (double phi = 0.0; phi < 0.97; phi += 0.32) {
            int missed = 0, found = 0;
            for (int s = 0; s < SERIES; s++) {
                stats_series b;
                autoregressive(rng, phi, n, v);
                if (stats_blocking(n, v, work, &b)) continue;
                const double blocks = floor((double)n / (double)b.block);
                missed += fabs(b.mean) > gsl_cdf_tdist_Pinv(0.975, blocks - 1.0) * b.se;
                found++;
            }
            CU_ASSERT(missed < 0.05 * SERIES);
            if ((double)n * (1.0 - phi) / (1.0 + phi) < 8.0) CU_ASSERT(found < 0.15 * SERIES);
        }
}

/* The first blocks whose length to the third is above twice the values times the squared ratio of variances,
 * of four blocks at least; what is no whole block is left out at the end. Neighbours of 16 blocks or more
 * tell a ratio too, which leaves 16 values, and is not passed by fewer than 20 blocks. */
static void check_blocking(size_t n, const double v[])
{
    enum { MOST = 512 };
    double work[MOST], mean[MOST], most = 0.0;
    stats_series b;
    const rp_status status = stats_blocking(n, v, work, &b);
    CHECK_PAIRS(tight, {b.mean, gsl_stats_mean(v, 1, n)}, {b.sd, gsl_stats_sd(v, 1, n)});
    for (size_t length = 1; n >= 16 && n / length >= 4; length *= 2) {
        const size_t blocks = n / length;
        for (size_t i = 0; i < blocks; i++) mean[i] = gsl_stats_mean(v + i * length, 1, length);
        const double se = gsl_stats_sd(mean, 1, blocks) / sqrt((double)blocks),
                     ratio = pow(se / b.sd, 2.0) * (double)n, middle = gsl_stats_mean(mean, 1, blocks);
        double along = 0.0;
        for (size_t i = 1; i < blocks; i++) along += (mean[i - 1] - middle) * (mean[i] - middle);
        const double r = along / gsl_stats_tss(mean, 1, blocks);
        if (blocks >= 16) most = fmax(most, ratio * (1.0 + r) / (1.0 - r));
        if ((double)n < 16.0 * most) break;
        if (pow((double)length, 3.0) <= 2.0 * (double)n * ratio * ratio) continue;
        const double own = blocks < 20 ? fmax(ratio, most) : ratio, own_se = b.sd * sqrt(own / (double)n);
        CU_ASSERT(status == RP_OK && b.n == n && b.block == length);
        CHECK_PAIRS(tight, {b.se, own_se}, {b.se_error, own_se / sqrt(2.0 * ((double)blocks - 1.0))});
        CHECK_NEAR(b.tau, 0.5 * own, 1e2 * tight);
        return;
    }
    CU_ASSERT(status == RP_NO_RESULT && isnan(b.se));
}

/* The cut of at most half of the series after which scatter over length is least; none if that is half. */
static void check_level_off(size_t n, const double v[])
{
    size_t from, best = 0;
    double least = INFINITY;
    for (size_t i = 0; i <= n / 2; i++) {
        const double kept = (double)(n - i), scatter = gsl_stats_tss(v + i, 1, n - i) / (kept * kept);
        if (scatter < least) best = i, least = scatter;
    }
    CU_ASSERT(stats_level_off(n, v, &from) == (best < n / 2 ? RP_OK : RP_NO_RESULT) && from == best);
}

static void test_series_by_hand(void)
{
    enum { MOST = 512, SERIES = 400 };
    double v[MOST];
    scoped_rng *rng = numbers_of(13, 0);
    for (int k = 0; k < SERIES; k++) {
        const size_t n = 4 + gsl_rng_uniform_int(rng, k % 2 ? 40 : MOST - 4), rise = n * (size_t)(k % 7) / 10;
        autoregressive(rng, 0.9 * gsl_rng_uniform(rng), n, v);
        for (size_t i = 0; i < n; i++) v[i] *= 0.05;
        check_blocking(n, v);
        for (size_t i = 0; i < rise; i++) v[i] -= 0.3 * (1.0 - (double)i / (double)rise);
        check_level_off(n, v);
    }
}

static void test_blocking_small(void)
{
    double v[64], work[64], ramp[64];
    stats_series b;
    for (int i = 0; i < 64; i++) {
        v[i] = 0.381;
        ramp[i] = i;
    }
    CHECK_OK(stats_blocking(64, v, work, &b));
    CU_ASSERT(b.mean == 0.381 && b.sd == 0.0 && b.se == 0.0 && b.tau == 0.5);
    CHECK_FAILS(stats_blocking(64, ramp, work, &b), RP_NO_RESULT, "no plateau");
    CU_ASSERT(b.n == 64 && b.mean == 31.5 && isnan(b.se) && isnan(b.tau));
    CHECK_FAILS(stats_blocking(3, ramp, work, &b), RP_NO_RESULT, "3 values");
    CU_ASSERT(b.mean == 1.0 && b.sd == 1.0 && isnan(b.se));
    CHECK_FAILS(stats_blocking(15, v, work, &b), RP_NO_RESULT, "at least 16 needed");
    CHECK_OK(stats_blocking(16, v, work, &b));
    CU_ASSERT(b.block == 4);
    v[5] = NAN;
    CHECK_FAILS(stats_blocking(16, v, work, &b), RP_BAD_INPUT, "value 6");
}

static void test_level_off(void)
{
    enum { N = 1000, RISE = 137 };
    double v[N];
    size_t from;
    /* a step without noise, exactly */
    for (int i = 0; i < N; i++) v[i] = i < RISE ? 0.0 : 17.3;
    CHECK_OK(stats_level_off(N, v, &from));
    CU_ASSERT(from == RISE);
    for (int i = 0; i < N; i++) v[i] = 0.1 * i;
    CHECK_FAILS(stats_level_off(N, v, &from), RP_NO_RESULT, "has not levelled off");
    CHECK_FAILS(stats_level_off(3, v, &from), RP_NO_RESULT, "3 values");
    v[2] = INFINITY;
    CHECK_FAILS(stats_level_off(N, v, &from), RP_BAD_INPUT, "value 3");
}

/* ---- piles against theory ---- */

static void test_compare(void)
{
    enum { N = 50, B = 4000 };
    double r[N], t[N];
    const double phi = M_PI / 3.0;
    scoped_rng *rng = numbers_of(5, 0);
    for (int i = 0; i < N; i++) { /* steep piles slide early */
        r[i] = 0.31 + gsl_ran_gaussian(rng, 0.03);
        t[i] = 0.07 - 0.5 * (r[i] - 0.31) + gsl_ran_gaussian(rng, 0.01);
    }
    r[7] = 0.56;
    ang_comparison c;
    CHECK_OK(ang_compare(&(ang_piles){0.2, N, r, t}, phi, B, numbers_stream(rng), &c));
    CHECK_NEAR(c.theta_ms, atan(0.6), tight);
    CHECK_NEAR(c.theta_rt.mean, c.theta_r.mean + c.theta_t.mean, 10.0 * tight);
    CHECK_NEAR(c.diff_ms.value, c.theta_rt.mean - atan(0.6), tight);
    CU_ASSERT(c.n_unstable == 1 && c.n_lost == 0);
    for (int f = 0; f < ANG_N_FORMS; f++) {
        ang_tilt_result at;
        CHECK_OK(ang_tilt((ang_form)f, 0.2, c.theta_r.mean, phi, &at));
        CU_ASSERT(c.form[f].status == ANG_TILT_OK);
        CHECK_PAIRS(root_error, {c.form[f].theta_t.value, at.theta_t},
                    {c.form[f].diff.value, c.theta_t.mean - at.theta_t},
                    {c.form[f].theta_rt.value, c.theta_r.mean + at.theta_t});
    }
    CHECK_OK(ang_compare(&(ang_piles){0.2, 1, r, t}, phi, B, numbers_stream(rng), &c));
    CU_ASSERT(isnan(c.diff_ms.se) && isnan(c.form[0].theta_t.se) && !isnan(c.form[0].theta_t.value));
    CHECK_OK(ang_compare(&(ang_piles){0.1, N, r, t}, phi, B, numbers_stream(rng),
                         &c)); /* theta_ms = 0.291, below the mean */
    CU_ASSERT(c.form[0].status == ANG_TILT_ALREADY_UNSTABLE && isnan(c.form[0].diff.se) && c.n_lost > B / 2);
    CU_ASSERT(isnan(c.form[0].theta_t.value) && isfinite(c.diff_ms.se));
    CHECK_FAILS(ang_compare(&(ang_piles){0.2, 0, r, t}, phi, B, numbers_stream(rng), &c), RP_NO_RESULT,
                "no values");
    CHECK_FAILS(ang_compare(&(ang_piles){0.2, N, r, t}, phi, 1, numbers_stream(rng), &c), RP_BAD_INPUT,
                "resamples = 1");
    CHECK_FAILS(ang_compare(&(ang_piles){-0.2, N, r, t}, phi, B, numbers_stream(rng), &c), RP_BAD_INPUT,
                "mu = -0.2");
    r[0] = NAN;
    CHECK_FAILS(ang_compare(&(ang_piles){0.2, N, r, t}, phi, B, numbers_stream(rng), &c), RP_BAD_INPUT,
                "value 1");
}

/* The claim of Fig. 7 in numbers: errors of (4) and (3); and piles that are flat on average. */
static void compare_gain_and_flat_piles(void)
{
    const double theta_r[4] = {0.301, 0.322, 0.345, 0.318}, theta_t[4] = {0.061, 0.072, 0.049, 0.066};
    const double flat[4] = {-0.012, 0.004, -0.003, 0.001}, mu = 0.2, phi = M_PI / 3.0;
    scoped_rng *rng = numbers_of(3, 0);
    ang_comparison c;
    CHECK_OK(ang_compare(&(ang_piles){mu, 4, theta_r, theta_t}, phi, 400, numbers_stream(rng), &c));
    for (int f = 0; f < ANG_N_FORMS; f++) {
        const double form = fabs(c.form[f].diff.value), ms = fabs(c.diff_ms.value);
        CHECK_NEAR(c.form[f].gain.value, form - ms, 1e-15);
        CHECK_NEAR(c.form[f].gain_relative.value, form / c.theta_t.mean - ms / c.theta_rt.mean, 1e-14);
        CU_ASSERT(c.form[f].gain.se > 0.0 && c.form[f].gain_relative.se > 0.0);
    }
    CHECK_OK(ang_compare(&(ang_piles){mu, 4, flat, theta_t}, phi, 50, numbers_stream(rng), &c));
    CU_ASSERT(c.form[ANG_BALANCED].status == ANG_TILT_NO_PILE && isnan(c.form[ANG_BALANCED].theta_t.value));
    CU_ASSERT_STRING_EQUAL(ang_tilt_words[ANG_TILT_NO_PILE], "no_pile");
    CU_ASSERT(isfinite(c.diff_ms.value) && c.n_lost > 0);
    CHECK_OK(ang_compare(&(ang_piles){mu, 1, flat, theta_t}, phi, 50, numbers_stream(rng),
                         &c)); /* one pile has no resamples to lose */
    CU_ASSERT(c.n_lost == 0);
}

/* Errors and lost resamples, from the same resamples: (4) at the mean angles of each. Some are too steep, for
 * all forms or for those but the last; the form that loses most counts. */
static void compare_resamples_of(double steeper, double mu)
{
    enum { N = 5, B = 60, PARTS = 5 };
    static const double theta_t[N] = {0.061, 0.052, 0.089, 0.066, 0.031};
    double theta_r[N] = {0.301, 0.362, 0.245, 0.318, 0.296};
    double r[B], t[B], sum[B], sample[PARTS][B];
    size_t most_lost = 0, lost = 0;
    for (int i = 0; i < N; i++) theta_r[i] += steeper;
    const double phi = M_PI / 3.0, ms = atan(3.0 * mu), unbias = sqrt(N / (N - 1.0));
    scoped_rng *rng = numbers_of(17, 0), *same = gsl_rng_clone(rng);
    ang_comparison c;
    CHECK_OK(ang_compare(&(ang_piles){mu, N, theta_r, theta_t}, phi, B, numbers_stream(rng), &c));
    for (int b = 0; b < B; b++) {
        r[b] = t[b] = 0.0;
        for (int i = 0; i < N; i++) {
            const size_t k = gsl_rng_uniform_int(same, N);
            r[b] += theta_r[k] / N, t[b] += theta_t[k] / N;
        }
        sum[b] = r[b] + t[b];
    }
    CHECK_NEAR(c.diff_ms.se, unbias * gsl_stats_sd(sum, 1, B), tight);
    for (int f = 0; f < ANG_N_FORMS; f++) {
        const stats_number *of[PARTS] = {&c.form[f].theta_t, &c.form[f].diff, &c.form[f].theta_rt,
                                         &c.form[f].gain, &c.form[f].gain_relative};
        size_t n = 0;
        for (int b = 0; b < B; b++) {
            ang_tilt_result at;
            CHECK_OK(ang_tilt((ang_form)f, mu, r[b], phi, &at));
            if (isnan(at.theta_t)) continue;
            const double miss = fabs(t[b] - at.theta_t), miss_ms = fabs(sum[b] - ms);
            sample[0][n] = at.theta_t, sample[1][n] = t[b] - at.theta_t, sample[2][n] = r[b] + at.theta_t;
            sample[3][n] = miss - miss_ms, sample[4][n++] = miss / t[b] - miss_ms / sum[b];
        }
        for (int k = 0; k < PARTS; k++)
            CHECK_NEAR(of[k]->se, unbias * gsl_stats_sd(sample[k], 1, n), root_error);
        lost = B - n;
        most_lost = lost > most_lost ? lost : most_lost;
    }
    CU_ASSERT(c.n_lost == most_lost && most_lost > 2 && most_lost < B / 2 &&
              (lost == most_lost) == (steeper == 0.0));
}

static void compare_resamples(void)
{
    enum { N = 5, B = 60 };
    static const double theta_r[N] = {0.301, 0.362, 0.245, 0.318, 0.296},
                        theta_t[N] = {0.061, 0.052, 0.089, 0.066, 0.031};
    scoped_rng *rng = numbers_of(18, 0);
    ang_comparison c;
    compare_resamples_of(0.0, 0.11);
    compare_resamples_of(0.47, 1.0);
    /* no angle at the mean: no error either, though some resamples have it */
    CHECK_OK(ang_compare(&(ang_piles){0.1, N, theta_r, theta_t}, M_PI / 3.0, B, numbers_stream(rng), &c));
    for (int f = 0; f < ANG_N_FORMS; f++)
        CU_ASSERT(isnan(c.form[f].theta_t.value) && isnan(c.form[f].theta_t.se) && isnan(c.form[f].gain.se));
    CU_ASSERT(c.n_lost > 0 && c.n_lost < B && c.n_unstable == 4);
}

CHECK_SUITE(angle, "angle", test_closed_forms, test_crossings, test_geometry, test_reference_angles,
            test_zero_tilt, test_marginal, test_tilt_without_root, test_theory_errors, test_surface,
            test_surface_errors, test_exact_lines, test_methods, test_gap, test_propagated_errors,
            test_planted_heaps, test_slope_errors, test_mean, test_paired, test_line_fit, test_blocking,
            test_blocking_short, test_series_by_hand, test_blocking_small, test_level_off, test_compare,
            compare_gain_and_flat_piles, compare_resamples)
