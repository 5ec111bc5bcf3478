/* Random inputs of a property, and simplification of a failing one; see property.h. */
#include "tests/numbers.h"
#include "tests/property.h"

#include "tests/check.h"

static bool fails(const property *p, const double x[])
{
    return !(p->excess(x) <= 1.0);
}

/* The number of the range nearest to 0. */
static double simplest(const property_input *in)
{
    return fmax(in->lo, fmin(in->hi, 0.0));
}

static size_t digits(double value)
{
    char text[40];
    snprintf(text, sizeof text, "%.15g", fabs(value));
    return strlen(text);
}

/* Fewer digits, or as many and nearer to the simplest by a tenth, so that simplification ends. */
static bool is_simpler(const property_input *in, double a, double b)
{
    if (!(a >= in->lo && a <= in->hi)) return false;
    return digits(a) < digits(b) ||
           (digits(a) == digits(b) && fabs(a - simplest(in)) < 0.9 * fabs(b - simplest(in)));
}

static double rounded(double value, int figures)
{
    char text[40];
    snprintf(text, sizeof text, "%.*g", figures, value);
    return strtod(text, NULL);
}

/* Replace input i of the failing x by a simpler failing value. */
static bool simplify(const property *p, double x[], int i)
{
    const property_input *in = &p->input[i];
    const double old = x[i], middle = 0.5 * (old + simplest(in));
    double ways[] = {simplest(in),    rounded(middle, 1), rounded(middle, 2),
                     rounded(old, 1), rounded(old, 2),    rounded(old, 3)};
    for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
        x[i] = in->whole ? round(ways[k]) : ways[k];
        if (is_simpler(in, x[i], old) && fails(p, x)) return true;
    }
    x[i] = old;
    return false;
}

bool property_holds(const property *p, unsigned long seed, int n, double x[PROPERTY_INPUTS])
{
    scoped_rng *rng = numbers_of(seed, 0);
    CU_ASSERT_PTR_NOT_NULL_FATAL(rng);
    bool good = true;
    for (int t = 0; t < n && good; t++) {
        for (int i = 0; i < PROPERTY_INPUTS && p->input[i].name; i++) {
            const property_input *in = &p->input[i];
            const double u = gsl_rng_uniform(rng);
            x[i] = in->whole ? floor(in->lo + u * (in->hi - in->lo + 1.0)) : in->lo + u * (in->hi - in->lo);
        }
        good = !fails(p, x);
    }
    for (bool changed = !good; changed;) {
        changed = false;
        for (int i = 0; i < PROPERTY_INPUTS && p->input[i].name; i++) changed |= simplify(p, x, i);
    }
    return good;
}

void property_check(const property *p, unsigned long seed, int n)
{
    double x[PROPERTY_INPUTS];
    const bool good = property_holds(p, seed, n, x);
    CU_ASSERT(good);
    if (good) return;
    fprintf(stderr, "property \"%s\", seed %lu: %g tolerances at", p->name, seed, p->excess(x));
    for (int i = 0; i < PROPERTY_INPUTS && p->input[i].name; i++)
        fprintf(stderr, "%s %s = %.17g", i ? "," : "", p->input[i].name, x[i]);
    fputc('\n', stderr);
}
