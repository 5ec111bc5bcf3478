/* See oblique.h. Unit of time is 1/w, w^2 = k_n/m_eff: the normal force is m_eff w v_n sin(t), half a period.
 * In stick the shear spring oscillates at W = sqrt(a kappa); in sliding the slip velocity changes by a mu
 * times the normal impulse. Sliding starts where the spring reaches the limit, and ends where the limit grows
 * faster than the slip would stretch the spring. */
#include "validation/oblique.h"

#include <math.h>
#include <stdbool.h>

typedef struct {
    double a, W, v_n, mu, spring_max; /* limit of the spring: spring_max sin(t) */
    bool slides;
    double sign, t, ds, v; /* at the last event; sign of the sliding spring */
} motion;

/* Spring and slip at time t, without an event since the last one; true if the next event is earlier. */
static bool follow(const motion *m, double t, double *ds, double *v)
{
    const double x = t - m->t, limit = m->spring_max * sin(t);
    if (m->slides) {
        *v = m->v - m->sign * m->a * m->mu * m->v_n * (cos(m->t) - cos(t));
        *ds = m->sign * limit;
        return m->sign * *v < m->spring_max * cos(t);
    }
    *v = m->v * cos(m->W * x) - m->ds * m->W * sin(m->W * x);
    *ds = m->ds * cos(m->W * x) + m->v / m->W * sin(m->W * x);
    return fabs(*ds) > limit;
}

double oblique_left(double a, double kappa, double mu, double v_n, double v_s)
{
    const double pi = 3.14159265358979323846;
    const int scan = 4000;
    motion m = {a, sqrt(a * kappa), v_n, mu, mu * v_n / kappa, .sign = copysign(1.0, v_s), .v = v_s};
    m.slides = fabs(v_s) > m.spring_max;
    double ds = 0.0, v = v_s;
    for (int k = 1; k <= scan; k++) {
        double lo = pi * (k - 1) / scan, hi = pi * k / scan;
        if (lo < m.t) lo = m.t;
        if (!follow(&m, hi, &ds, &v)) continue;
        for (int halvings = 0; halvings < 60; halvings++) {
            const double middle = 0.5 * (lo + hi);
            *(follow(&m, middle, &ds, &v) ? &hi : &lo) = middle;
        }
        follow(&m, hi, &ds, &v);
        m.slides = !m.slides;
        m.sign = copysign(1.0, ds);
        m.t = hi, m.ds = ds, m.v = v;
    }
    follow(&m, pi, &ds, &v);
    return v;
}
