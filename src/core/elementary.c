/* Elementary functions; see elementary.h. */
#include "core/elementary.h"

#include <math.h>

/* ln 2, of which the first part has 24 trailing zeros: its multiples up to 2^24 are exact. */
static const double LN2_HIGH = 0x1.62e42fep-1, LN2_LOW = 0x1.f473de6af278fp-30;

/* e^x = 2^k e^r, |r| <= ln(2)/2, by Taylor's series, whose rest after r^17 is below 1e-22. */
double rp_exp(double x)
{
    const double k = floor(x / (LN2_HIGH + LN2_LOW) + 0.5), r = (x - k * LN2_HIGH) - k * LN2_LOW;
    double sum = 1.0;
    for (int n = 17; n > 0; n--) sum = 1.0 + r / n * sum;
    return ldexp(sum, (int)k);
}

/* ln x = k ln 2 + 2 artanh(s), s = (f - 1)/(f + 1), f in [sqrt(1/2), sqrt(2)]: |s| < 0.172. */
double rp_log(double x)
{
    int k;
    double f = frexp(x, &k), sum = 0.0;
    if (f < 0.70710678118654752) f *= 2.0, k--;
    const double s = (f - 1.0) / (f + 1.0), s2 = s * s;
    for (int n = 23; n > 0; n -= 2) sum = 1.0 / n + s2 * sum;
    return k * LN2_HIGH + (2.0 * s * sum + k * LN2_LOW);
}
