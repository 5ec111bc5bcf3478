/* Forces on the base under any polygonal outline: the chords l_1, l_2 of Fig. 11 of Liffman, Chan & Hughes
 * 1992 end on the outline, and (52), (53) follow. Assumptions: continuum.c. See analytic.h. */
#include "analytic/analytic.h"
#include "core/elementary.h"

#include <math.h>

static const double DEG = 180.0 / M_PI;
static const double LEAN = 0.57735026918962576; /* 1/sqrt 3: the diagonals' dx/dy */
/* Least (dx - LEAN dy)/dx of an edge: a smaller one is 60 degrees steep within rounding of the vertices. */
static const double STEEP = 1e-14;

rp_status an_profile_set(an_profile *profile, const an_point *v, size_t n)
{
    if (n < 3) return rp_fail(RP_BAD_INPUT, "outline: %zu vertices, at least 3 expected", n);
    for (size_t i = 0; i < n; i++)
        if (!isfinite(v[i].x) || !(v[i].y >= 0 && isfinite(v[i].y)))
            return rp_fail(RP_BAD_INPUT,
                           "outline: vertex %zu at (%g, %g): y >= 0 and finite numbers expected", i, v[i].x,
                           v[i].y);
    if (v[0].y > 0 || v[n - 1].y > 0)
        return rp_fail(RP_BAD_INPUT, "outline: ends at heights %g and %g, 0 expected", v[0].y, v[n - 1].y);
    for (size_t i = 1; i < n; i++) {
        double dx = v[i].x - v[i - 1].x, dy = v[i].y - v[i - 1].y;
        if (!(dx > 0))
            return rp_fail(RP_BAD_INPUT,
                           "outline: vertex %zu at x = %.15g after x = %.15g: not a function of x", i, v[i].x,
                           v[i - 1].x);
        if (!(dx - LEAN * fabs(dy) > STEEP * dx))
            return rp_fail(RP_BAD_INPUT,
                           "outline: slope of %.15g degrees before vertex %zu, allowed: (-60, 60)",
                           rp_atan2(dy, dx) * DEG, i);
    }
    *profile = (an_profile){n, v};
    return RP_OK;
}

static rp_status check_x(const an_profile *p, double x)
{
    double lo = p->v[0].x, hi = p->v[p->n - 1].x;
    if (x >= lo && x <= hi) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "x = %.15g: out of range, allowed: [%.15g, %.15g]", x, lo, hi);
}

/* Height at which the line of direction (lean, 1) from (x, 0) leaves the pile. Along the outline x - lean y
 * increases, since every slope is below 1/|lean|; bisection finds the segment. */
static double leave(const an_profile *p, double x, double lean)
{
    size_t lo = 0, hi = p->n - 1;
    while (hi - lo > 1) {
        size_t mid = lo + (hi - lo) / 2;
        if (p->v[mid].x - lean * p->v[mid].y <= x)
            lo = mid;
        else
            hi = mid;
    }
    an_point a = p->v[lo], b = p->v[hi];
    double dx = b.x - a.x, dy = b.y - a.y;
    return a.y + dy * fmin(1, (x - (a.x - lean * a.y)) / (dx - lean * dy));
}

rp_status an_profile_chords(const an_profile *profile, double x, double l[2])
{
    RP_TRY(check_x(profile, x));
    l[0] = leave(profile, x, -LEAN) * 2 * LEAN;
    l[1] = leave(profile, x, LEAN) * 2 * LEAN;
    return RP_OK;
}

rp_status an_profile_height(const an_profile *profile, double x, double *y)
{
    RP_TRY(check_x(profile, x));
    *y = leave(profile, x, 0);
    return RP_OK;
}

rp_status an_profile_force(const an_profile *profile, double x, an_force *force)
{
    double l[2];
    RP_TRY(an_profile_chords(profile, x, l));
    double base = profile->v[profile->n - 1].x - profile->v[0].x;
    *force = (an_force){(l[0] + l[1]) / (2 * base), (l[0] - l[1]) / (2 * sqrt(3) * base)};
    return RP_OK;
}

rp_status an_profile_largest(const an_profile *profile, double *x, double *N)
{
    const double left = profile->v[0].x, right = profile->v[profile->n - 1].x;
    double first = left, most = 0;
    for (size_t i = 0; i < profile->n; i++)
        for (int side = -1; side <= 1; side += 2) {
            const double at = fmin(fmax(profile->v[i].x + side * LEAN * profile->v[i].y, left), right);
            an_force force;
            RP_TRY(an_profile_force(profile, at, &force));
            if (!(force.N > most)) continue;
            most = force.N;
            first = at;
        }
    *x = first;
    *N = most;
    return RP_OK;
}

static rp_status check_angle(const char *name, double angle)
{
    if (angle > 0 && angle < M_PI / 3) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "%s = %.15g degrees: out of range, allowed: (0, 60)", name, angle * DEG);
}

rp_status an_tent(double alpha_1, double alpha_2, double x_1, an_point v[5])
{
    RP_TRY(check_angle("alpha_1", alpha_1));
    RP_TRY(check_angle("alpha_2", alpha_2));
    if (!(x_1 > 0 && x_1 < 0.5))
        return rp_fail(RP_BAD_INPUT, "X_1/B = %.15g: out of range, allowed: (0, 0.5)", x_1);
    double shoulder = x_1 * rp_tan(alpha_1), peak = shoulder + (0.5 - x_1) * rp_tan(alpha_2);
    v[0] = (an_point){0, 0};
    v[1] = (an_point){x_1, shoulder};
    v[2] = (an_point){0.5, peak};
    v[3] = (an_point){1 - x_1, shoulder};
    v[4] = (an_point){1, 0};
    return RP_OK;
}
