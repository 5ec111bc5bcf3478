/* Elementary functions in pairs of doubles; see elementary.h. */
#include "core/elementary.h"

#include <math.h>

/* high + low, |low| at most half a unit in the last place of high. Dekker 1971, Numer. Math. 18. */
typedef struct {
    double high, low;
} pair;

static pair sum_of(double a, double b)
{
    const double sum = a + b, part = sum - a;
    return (pair){sum, (a - (sum - part)) + (b - part)};
}

static pair product_of(double a, double b)
{
    static const double SPLIT = 134217729.0; /* 2^27 + 1 */
    const double s = SPLIT * a, t = SPLIT * b, a1 = s - (s - a), a2 = a - a1, b1 = t - (t - b), b2 = b - b1,
                 product = a * b;
    return (pair){product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2};
}

static pair add(pair a, pair b)
{
    const pair sum = sum_of(a.high, b.high), rest = sum_of(a.low, b.low),
               all = sum_of(sum.high, sum.low + rest.high);
    return sum_of(all.high, all.low + rest.low);
}

static pair negative(pair a)
{
    return (pair){-a.high, -a.low};
}

static pair multiply(pair a, pair b)
{
    const pair product = product_of(a.high, b.high);
    return sum_of(product.high, product.low + (a.high * b.low + a.low * b.high));
}

static pair divide(pair a, pair b)
{
    const double first = a.high / b.high;
    const pair rest = add(a, negative(multiply(b, (pair){first, 0.0})));
    const double second = rest.high / b.high;
    const pair left = add(rest, negative(multiply(b, (pair){second, 0.0})));
    return add(sum_of(first, second), (pair){left.high / b.high, 0.0});
}

static pair root(pair a)
{
    const double first = sqrt(a.high);
    if (!(first > 0.0)) return (pair){first, 0.0};
    const pair left = add(a, negative(product_of(first, first)));
    return sum_of(first, left.high / (2.0 * first));
}

static pair of(double a)
{
    return (pair){a, 0.0};
}

static double rounded(pair a)
{
    return a.high + a.low;
}

static const pair LN2 = {0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56},
                  HALF_PI = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};
static const double HALF_PI_REST = -0x1.f1976b7ed8fbcp-110;

/* a - k b, k a whole number. */
static pair without(pair a, double k, pair b)
{
    return add(add(a, negative(product_of(k, b.high))), negative(product_of(k, b.low)));
}

/* e^a = 2^k e^r, |r| <= ln(2)/2, by Taylor's series. */
static pair exponential(pair a)
{
    const double k = floor(a.high / LN2.high + 0.5);
    const pair r = without(a, k, LN2);
    pair sum = of(1.0);
    for (int n = 28; n > 0; n--) sum = add(of(1.0), multiply(divide(r, of(n)), sum));
    return (pair){ldexp(sum.high, (int)k), ldexp(sum.low, (int)k)};
}

/* ln(2^k f) = k ln 2 + y, f in [sqrt(1/2), sqrt(2)]: y by the series of artanh, then a step of Newton's. */
static pair logarithm(pair a)
{
    int k;
    double f = frexp(a.high, &k), sum = 0.0;
    if (f < 0.70710678118654752) f *= 2.0, k--;
    const double s = (f - 1.0) / (f + 1.0), s2 = s * s;
    for (int n = 23; n > 0; n -= 2) sum = 1.0 / n + s2 * sum;
    const double y = 2.0 * s * sum;
    const pair scaled = {f, ldexp(a.low, -k)}, step = add(multiply(scaled, exponential(of(-y))), of(-1.0));
    return add(add(product_of(k, LN2.high), product_of(k, LN2.low)), add(of(y), step));
}

/* Sine (first = 3) or cosine (2) of |a| <= pi/4 by Taylor's series. */
static pair circular(pair a, int first)
{
    const pair square = multiply(a, a);
    pair sum = of(1.0);
    for (int n = first + 24; n >= first; n -= 2)
        sum = add(of(1.0), negative(multiply(divide(square, of(n * (n - 1))), sum)));
    return first == 3 ? multiply(a, sum) : sum;
}

/* Of the angle and `quarters` of a turn. */
static pair sine(double angle, int quarters)
{
    if (!(fabs(angle) < 1e9)) return of(NAN);
    const double k = floor(angle / HALF_PI.high + 0.5);
    const pair rest = add(without(of(angle), k, HALF_PI), of(-k * HALF_PI_REST));
    const int quarter = ((int)k + quarters) & 3;
    const pair a = circular(rest, quarter & 1 ? 2 : 3);
    return quarter & 2 ? negative(a) : a;
}

/* Of 0 <= a <= 1: arctan(a) = b + arctan((a - tan b)/(1 + a tan b)), twice, from b right to 0.005. */
static pair arctangent(pair a)
{
    pair b = of(a.high / (1.0 + 0.28 * a.high * a.high));
    for (int i = 0; i < 2; i++) {
        const pair s = circular(b, 3), c = circular(b, 2),
                   d = divide(add(multiply(a, c), negative(s)), add(c, multiply(a, s)));
        b = add(b, add(d, of(-d.high * d.high * d.high / 3.0)));
    }
    return b;
}

/* Of the point (x, y) with x, y >= 0, not both 0. */
static pair direction(pair y, pair x)
{
    return y.high <= x.high ? arctangent(divide(y, x)) : add(HALF_PI, negative(arctangent(divide(x, y))));
}

/* Borges 2019, arXiv:1904.09481, without fused operations, as in glibc. */
double rp_hypot(double x, double y)
{
    const double a = fmax(fabs(x), fabs(y)), b = fmin(fabs(x), fabs(y));
    if (isinf(x) || isinf(y)) return INFINITY;
    if (isnan(x) || isnan(y)) return NAN;
    if (a > 0x1p+511) return 0x1p+600 * rp_hypot(0x1p-600 * a, 0x1p-600 * b);
    if (b <= a * 0x1p-54) return a;
    if (b < 0x1p-459) return 0x1p-600 * rp_hypot(0x1p+600 * a, 0x1p+600 * b);
    const double h = sqrt(a * a + b * b), over_b = h - b, over_a = h - a;
    const double excess = h <= 2.0 * b
                              ? a * (2.0 * over_b - a) + (over_b - 2.0 * (a - b)) * over_b
                              : 2.0 * over_a * (a - 2.0 * b) + ((4.0 * over_a - b) * b + over_a * over_a);
    return h - excess / (2.0 * h);
}

double rp_exp(double x)
{
    return x > 710.0 ? INFINITY : x < -746.0 ? 0.0 : isnan(x) ? x : rounded(exponential(of(x)));
}

double rp_log(double x)
{
    return x == 0.0 ? -INFINITY : !(x > 0.0) ? NAN : isinf(x) ? x : rounded(logarithm(of(x)));
}

double rp_pow(double x, double p)
{
    if (p == 0.0 || x == 1.0) return 1.0;
    const double about = p * rp_log(x);
    if (!(fabs(about) < 746.0)) return rp_exp(about); /* infinite, 0 or NAN */
    return rounded(exponential(multiply(of(p), logarithm(of(x)))));
}

double rp_acosh(double x)
{
    if (!(x >= 1.0) || isinf(x)) return x >= 1.0 ? x : NAN;
    if (x > 0x1p+400) return rounded(add(logarithm(of(x)), LN2));
    return rounded(logarithm(add(of(x), root(multiply(sum_of(x, -1.0), sum_of(x, 1.0))))));
}

double rp_sin(double angle)
{
    return fabs(angle) < 1e-9 ? angle : rounded(sine(angle, 0));
}

double rp_cos(double angle)
{
    return rounded(sine(angle, 1));
}

double rp_tan(double angle)
{
    return rounded(divide(sine(angle, 0), sine(angle, 1)));
}

double rp_asin(double x)
{
    const double size = fabs(x);
    if (!(size <= 1.0)) return NAN;
    return copysign(rounded(direction(of(size), root(multiply(sum_of(1.0, -size), sum_of(1.0, size))))), x);
}

double rp_acos(double x)
{
    const double size = fabs(x);
    if (!(size <= 1.0)) return NAN;
    const pair a = direction(root(multiply(sum_of(1.0, -size), sum_of(1.0, size))), of(size));
    return rounded(x < 0.0 ? add(add(HALF_PI, HALF_PI), negative(a)) : a);
}

double rp_atan(double x)
{
    return fabs(x) < 1e-9 ? x : rp_atan2(x, 1.0);
}

double rp_atan2(double y, double x)
{
    int up, along;
    if (isnan(x) || isnan(y)) return NAN;
    if (isinf(x) || isinf(y)) return rp_atan2(copysign(isinf(y), y), copysign(isinf(x), x));
    if (x == 0.0 && y == 0.0) return 0.0;
    frexp(x, &along), frexp(y, &up); /* of the larger: no product of two parts overflows */
    const int scale = -(x == 0.0 ? up : y == 0.0 || along > up ? along : up);
    const pair a = direction(of(ldexp(fabs(y), scale)), of(ldexp(fabs(x), scale)));
    return copysign(rounded(x < 0.0 ? add(add(HALF_PI, HALF_PI), negative(a)) : a), y);
}
