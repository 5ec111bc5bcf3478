/* Single impacts, by + - * / and roots alone; see laws.h. */
#include <math.h>
#include <string.h>

#include "dem/law/law.h"

/* Of an impact's integration: the steps that it may take, the columns of an extrapolation, those that leave a
 * longer step possible, and what the last of them may differ by, relative to the result. */
enum { MOST_STEPS = 4000, COLUMNS = 9, FEW = 7 };
static const double TOLERANCE = 1e-13;

/* An impact in units of its length, at which the spring alone stops it, and of the time to run that. */
typedef struct {
    dem_head_on of;
    double length, time;
} impact_problem;

/* The overlap's fourth root u, its rate v and the time t change with s, dt = u^3 ds. Forces of x^(3/2) and
 * rates of x^(1/4) are smooth in u and s at first touch, and not in t. */
enum { U, V, T, STATES };

static double overlap_of(const double y[])
{
    return y[U] * y[U] * y[U] * y[U];
}

/* The force, which may pull. */
static double force_of(const impact_problem *p, const double y[])
{
    const dem_head_on *o = &p->of;
    return dem_law_normal(o->normal, true, o->k_n, o->gamma_n, o->m_eff, overlap_of(y) * p->length,
                          -y[V] * p->length / p->time);
}

/* y + h dy/ds, the rates taken at `at`. */
static void move(const impact_problem *p, double y[], double h, const double at[])
{
    const double dt = h * at[U] * at[U] * at[U];
    y[U] += 0.25 * h * at[V];
    y[V] -= dt * (force_of(p, at) / (p->of.m_eff * p->length) * p->time * p->time);
    y[T] += dt;
}

/* A step by the midpoint rule in 2, 4, ... parts, extrapolated to parts without length (Gragg 1965; Bulirsch
 * & Stoer 1966). The number of columns that it takes; 0: h is too long. */
static int step(const impact_problem *p, const double y[], double h, double to[])
{
    double row[COLUMNS][STATES];
    bool near = false; /* two columns may agree by chance, and not three */
    for (int j = 0; j < COLUMNS; j++) {
        const int n = 2 * (j + 1);
        double z[2][STATES];
        bool was_near = near;
        near = j > 0;
        memcpy(z[0], y, sizeof z[0]), memcpy(z[1], y, sizeof z[1]);
        move(p, z[1], h / n, y);
        for (int k = 1; k < n; k++) move(p, z[(k + 1) % 2], 2.0 * h / n, z[k % 2]);
        for (int i = 0; i < STATES; i++) {
            double change = 0.0;
            to[i] = z[0][i];
            for (int k = 0; k < j; k++) {
                const double ratio = (j + 1.0) / (j - k);
                change = (to[i] - row[k][i]) / (ratio * ratio - 1.0);
                row[k][i] = to[i], to[i] += change;
            }
            row[j][i] = to[i];
            near = near && (i == T || fabs(change) < TOLERANCE * fmax(fabs(y[i]), fabs(to[i])));
        }
        if (near && was_near) return j + 1;
    }
    return 0;
}

/* The overlap is the deepest. */
static bool turned(const impact_problem *p, const double y[])
{
    return (void)p, !(y[V] > 0.0);
}

/* The overlap is 0 again, or without tension the force, to rounding, after which none acts. */
static bool parted(const impact_problem *p, const double y[])
{
    const double spring = dem_law_elastic(p->of.normal, p->of.k_n, overlap_of(y) * p->length);
    return !(y[U] > 0.0) || !(p->of.tension || force_of(p, y) > TOLERANCE * spring);
}

/* y[3] to where something is about to happen. False: it does not. */
static bool follow(const impact_problem *p, bool (*happened)(const impact_problem *p, const double y[]),
                   double h, double y[])
{
    double to[STATES], least = 0.0;
    for (int k = 0; k < MOST_STEPS; k++) {
        const int columns = step(p, y, h, to);
        const bool met = columns > 0 && happened(p, to);
        if (met && !(least > 0.0)) least = 1e-17 * h;
        if (columns > 0 && !met) memcpy(y, to, sizeof to);
        if (least > 0.0 || columns == 0)
            h *= 0.5;
        else if (columns < FEW)
            h *= 2.0;
        if (h < least) return true;
    }
    return false;
}

/* Damping that pulls holds slow grains for ever: those of no other law part, however late. */
static bool sticks(const dem_head_on *o)
{
    const dem_normal_descriptor *law = &dem_normal_descriptors[o->normal];
    const double rounding = 1e-12; /* of that speed */
    return o->tension &&
           (law->damping_ratio
                ? law->damping_ratio(o->k_n, o->gamma_n, o->m_eff) >= 1.0
                : law->sticking_speed &&
                      o->v < (1.0 - rounding) * law->sticking_speed(o->k_n, o->gamma_n, o->m_eff));
}

rp_status dem_collision(const dem_head_on *o, dem_collision_result *result)
{
    const dem_normal_descriptor *law = &dem_normal_descriptors[o->normal];
    *result = (dem_collision_result){NAN, NAN, NAN};
    if (!(o->k_n > 0.0 && o->gamma_n >= 0.0 && o->m_eff > 0.0 && o->v > 0.0))
        return rp_fail(RP_BAD_INPUT, "impact: k_n = %g, gamma_n = %g, m_eff = %g, v = %g: must be positive",
                       o->k_n, o->gamma_n, o->m_eff, o->v);
    const double length = law->impact_overlap(o->k_n, o->m_eff, o->v), time = length / o->v, first = 0.125;
    const impact_problem problem = {*o, length, time};
    double y[STATES] = {0.0, 1.0, 0.0};
    follow(&problem, turned, first, y);
    *result = (dem_collision_result){0.0, overlap_of(y) * length, INFINITY};
    if (sticks(o) || (!follow(&problem, parted, first, y) && o->tension)) return RP_OK;
    result->restitution = -y[V];
    result->time = (y[T] - overlap_of(y) / y[V]) * time; /* no force acts on the rest of the way */
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

/* By bisection: restitution falls with gamma_n, from 1. */
static rp_status damping_at_speed(dem_head_on o, double restitution, double *gamma_n)
{
    const dem_normal_descriptor *law = &dem_normal_descriptors[o.normal];
    const double length = law->impact_overlap(o.k_n, o.m_eff, o.v);
    double low = 0.0, high = INFINITY;
    dem_collision_result c;
    o.gamma_n = o.v / length / law->damping_rate(o.k_n, 1.0, o.m_eff, length);
    while (o.gamma_n > low && o.gamma_n < high) {
        RP_TRY(dem_collision(&o, &c));
        *(c.restitution > restitution ? &low : &high) = o.gamma_n;
        o.gamma_n = isinf(high) ? 2.0 * low : 0.5 * (low + high);
    }
    *gamma_n = low;
    return isfinite(high) ? RP_OK : rp_fail(RP_BROKEN, "restitution: no gamma_n found");
}

rp_status dem_damping_of(const dem_head_on *o, double restitution, double *gamma_n)
{
    const dem_normal_descriptor *law = &dem_normal_descriptors[o->normal];
    *gamma_n = NAN;
    if (!(restitution > 0.0 && restitution <= 1.0))
        return rp_fail(RP_BAD_INPUT, "restitution = %g: out of range, allowed: (0, 1]", restitution);
    *gamma_n = 0.0;
    if (restitution == 1.0) return RP_OK;
    if (!law->damping_ratio) return damping_at_speed(*o, restitution, gamma_n);
    *gamma_n = dem_damping_ratio_of(o->tension, restitution) / law->damping_ratio(o->k_n, 1.0, o->m_eff);
    return RP_OK;
}
