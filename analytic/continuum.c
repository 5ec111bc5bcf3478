/* Forces on the base of a triangular pile in the continuum limit: Liffman, Chan & Hughes 1992, equations
 * (49)-(59). Forces run along straight lines at 60 degrees to the base. See analytic.h. */
#include "analytic/analytic.h"
#include "core/elementary.h"

#include <math.h>

static rp_status check_alpha(double alpha)
{
    if (alpha > 0 && alpha < M_PI / 3) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "alpha = %.15g degrees: out of range, allowed: (0, 60)", alpha * 180 / M_PI);
}

/* h (cot(alpha) - 1/sqrt 3) without its cancellation near 60 degrees. */
static double kink(double alpha)
{
    return rp_sin(M_PI / 3 - alpha) / (sqrt(3) * rp_cos(alpha));
}

rp_status an_continuum_kink(double alpha, double *x_c)
{
    RP_TRY(check_alpha(alpha));
    *x_c = kink(alpha);
    return RP_OK;
}

rp_status an_continuum(double alpha, double x, an_force *force)
{
    RP_TRY(check_alpha(alpha));
    if (!(x >= 0 && x <= 1)) return rp_fail(RP_BAD_INPUT, "x/B = %.15g: out of range, allowed: [0, 1]", x);
    double a = rp_sin(alpha), b = rp_sin(2 * M_PI / 3 - alpha), c = rp_sin(M_PI / 3 - alpha);
    double edge = fmin(x, 1 - x);
    if (edge <= kink(alpha)) {
        double q = edge * a / (2 * b * c);
        force->N = sqrt(3) * q * rp_cos(alpha);         /* (54), (58) */
        force->H = (x < 0.5 ? 0 - q : q) * a / sqrt(3); /* (55), (59) */
    } else
        *force = (an_force){a / (2 * b), (x - 0.5) * a / (sqrt(3) * b)}; /* (56), (57) */
    return RP_OK;
}
