/* Single impacts; see laws.h. */
#include "core/elementary.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <gsl/gsl_roots.h>
#include <math.h>

#include "dem/law/law.h"

/* Of an impact's integration, in the units below. */
static const struct {
    double step, tolerance, longest, strong, creeping;
} course = {.step = 1e-2,
            .tolerance = 1e-13,
            .longest = 1e4,   /* time after which a pair never parts */
            .strong = 10.0,   /* damping from which on an impact ends once it has turned, as far as it ends */
            .creeping = 1e4}; /* damping from which on the limit of no spring serves */

/* An impact in units of its length, at which the spring alone stops it, and of the time to run that. */
typedef struct {
    dem_head_on of;
    double length, time, damping; /* rate at that length */
} impact_problem;

/* Overlap y[0] and its rate y[1]. */
static int impact_rates(double t, const double y[], double dydt[], void *params)
{
    (void)t;
    const impact_problem *p = params;
    const bool apart = y[0] <= 0.0 && y[1] < 0.0;
    const dem_head_on *o = &p->of;
    const double x = y[0] > 0.0 ? y[0] : 0.0, unit = o->m_eff * p->length / (p->time * p->time);
    dydt[0] = y[1];
    dydt[1] = apart ? 0.0
                    : -dem_law_normal(o->normal, o->tension, o->k_n, o->gamma_n, o->m_eff, x * p->length,
                                      -y[1] * p->length / p->time) /
                          unit;
    return GSL_SUCCESS;
}

/* Strong damping stops the impact before the spring acts: the overlap is the speed over the mean rate up to
 * it. The spring then drives the grains apart at the speed at which damping balances it, and without tension
 * they part. The relative error is at most 4 ln(damping) damping^-2. */
static void creep(const impact_problem *p, double *overlap, double *speed)
{
    enum { ROUNDS = 40 }; /* each leaves a quarter of the error, or none where the rate is constant */
    const dem_head_on *o = &p->of;
    const double v = p->length / p->time;
    double x = p->length;
    for (int k = 0; k < ROUNDS; k++)
        x = v / dem_normal_descriptors[o->normal].mean_rate(o->k_n, o->gamma_n, o->m_eff, 0.0, x);
    *overlap = x / p->length;
    *speed = o->tension
                 ? 0.0
                 : dem_law_elastic(o->normal, o->k_n, x) /
                       (o->m_eff * dem_law_damping_rate(o->normal, o->k_n, o->gamma_n, o->m_eff, x)) / v;
}

rp_status dem_collision(const dem_head_on *o, dem_collision_result *result)
{
    const dem_normal_descriptor *law = &dem_normal_descriptors[o->normal];
    *result = (dem_collision_result){NAN, NAN, NAN};
    if (!(o->k_n > 0.0 && o->gamma_n >= 0.0 && o->m_eff > 0.0 && o->v > 0.0))
        return rp_fail(RP_BAD_INPUT, "impact: k_n = %g, gamma_n = %g, m_eff = %g, v = %g: must be positive",
                       o->k_n, o->gamma_n, o->m_eff, o->v);
    const bool tension = o->tension;
    const double length = law->impact_overlap(o->k_n, o->m_eff, o->v), time = length / o->v;
    impact_problem problem = {*o, length, time,
                              time * law->damping_rate(o->k_n, o->gamma_n, o->m_eff, length)};
    if (problem.damping > course.creeping) {
        double overlap, speed;
        creep(&problem, &overlap, &speed);
        *result =
            (dem_collision_result){speed, overlap * length, tension ? INFINITY : overlap / speed * time};
        return RP_OK;
    }
    const bool strong = problem.damping > course.strong;
    const double step = strong ? 0.1 / problem.damping : course.step,
                 tolerance = course.tolerance * (strong ? rp_pow(problem.damping, -2.5) : 1.0);
    gsl_odeiv2_system system = {impact_rates, NULL, 2, &problem};
    gsl_odeiv2_driver *driver = gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, 0.1 * step,
                                                              tolerance, course.tolerance);
    if (!driver) return rp_fail(RP_NO_MEMORY, "impact: out of memory");
    double t = 0.0, y[2] = {0.0, 1.0}, last[2] = {0.0, 1.0}, deepest = 0.0;
    bool freed = false; /* no force acts from there on */
    /* what never parts fades away, of the linear law so much that numbers have no more digits */
    while (t < course.longest && !freed && !(strong && tension && deepest > 0.0) &&
           gsl_odeiv2_driver_apply(driver, &t, t + step, y) == GSL_SUCCESS && y[0] > 1e-100) {
        /* a step's parabola holds the turning point to the third order */
        if (last[1] > 0.0 && y[1] <= 0.0) deepest = y[0] + 0.5 * step * y[1] * y[1] / (last[1] - y[1]);
        last[0] = y[0];
        last[1] = y[1];
        double rates[2];
        impact_rates(t, y, rates, &problem);
        freed = strong && deepest > 0.0 && rates[1] == 0.0;
    }
    gsl_odeiv2_driver_free(driver);
    result->overlap = deepest * length;
    result->restitution = 0.0;
    result->time = INFINITY;
    if (y[0] <= 0.0 || freed) {
        result->restitution = -y[1]; /* no force acts after y = 0 */
        result->time = (t - y[0] / y[1]) * time;
    }
    return RP_OK;
}

double dem_impact_error(const dem_head_on *o, double restitution, double dt)
{
    enum { PHASES = 16, LONGEST = 100000 };
    double worst = 0.0;
    for (int phase = 0; phase < PHASES; phase++) {
        double v = o->v, x = o->v * dt * (phase + 0.5) / PHASES;
        for (int k = 0; k < LONGEST && x > 0.0; k++) {
            v -= dt / o->m_eff * dem_law_normal(o->normal, o->tension, o->k_n, o->gamma_n, o->m_eff, x, -v);
            x += dt * v;
        }
        worst = fmax(worst, fabs(v * v / (o->v * o->v) - restitution * restitution));
    }
    return worst;
}

typedef struct {
    dem_head_on of;
    double restitution;
    rp_status status;
} damping_problem;

/* Grains that stick creep for as long as one waits: their restitution, 0, needs no integration. */
static bool sticks(const dem_head_on *o)
{
    const dem_normal_descriptor *law = &dem_normal_descriptors[o->normal];
    const double rounding = 1e-12; /* of that speed */
    return o->tension && law->sticking_speed &&
           o->v < (1.0 - rounding) * law->sticking_speed(o->k_n, o->gamma_n, o->m_eff);
}

static double excess_restitution(double gamma_n, void *params)
{
    damping_problem *p = params;
    dem_collision_result c;
    p->of.gamma_n = gamma_n;
    if (sticks(&p->of)) return -p->restitution;
    const rp_status status = dem_collision(&p->of, &c);
    if (status) p->status = status;
    return c.restitution - p->restitution;
}

/* Restitution falls with gamma_n, from 1. */
static rp_status damping_at_speed(damping_problem *p, double *gamma_n)
{
    const dem_head_on *o = &p->of;
    const dem_normal_descriptor *law = &dem_normal_descriptors[o->normal];
    const double length = law->impact_overlap(o->k_n, o->m_eff, o->v);
    double high = o->v / length / law->damping_rate(o->k_n, 1.0, o->m_eff, length);
    *gamma_n = 0.0;
    if (!(excess_restitution(0.0, p) > 0.0)) return p->status; /* nearer to 1 than an impact is computed */
    while (excess_restitution(high, p) > 0.0 && !p->status) high *= 2.0;
    gsl_function f = {excess_restitution, p};
    gsl_root_fsolver *solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
    if (!solver) return rp_fail(RP_NO_MEMORY, "restitution: out of memory");
    int state = gsl_root_fsolver_set(solver, &f, 0.0, high);
    for (int k = 0; k < 200 && !state && !p->status; k++) {
        state = gsl_root_fsolver_iterate(solver);
        if (gsl_root_test_interval(gsl_root_fsolver_x_lower(solver), gsl_root_fsolver_x_upper(solver), 0.0,
                                   1e-13) == GSL_SUCCESS)
            break;
    }
    *gamma_n = gsl_root_fsolver_root(solver);
    gsl_root_fsolver_free(solver);
    return !state || p->status ? p->status : rp_fail(RP_BROKEN, "restitution: no gamma_n found");
}

rp_status dem_damping_of(const dem_head_on *o, double restitution, double *gamma_n)
{
    const dem_normal_descriptor *law = &dem_normal_descriptors[o->normal];
    *gamma_n = NAN;
    if (!(restitution > 0.0 && restitution <= 1.0))
        return rp_fail(RP_BAD_INPUT, "restitution = %g: out of range, allowed: (0, 1]", restitution);
    *gamma_n = 0.0;
    if (restitution == 1.0) return RP_OK;
    if (!law->damping_ratio) return damping_at_speed(&(damping_problem){*o, restitution, RP_OK}, gamma_n);
    *gamma_n = dem_damping_ratio_of(o->tension, restitution) / law->damping_ratio(o->k_n, 1.0, o->m_eff);
    return RP_OK;
}
