/* Analytic force models: lattice, continuum, polygonal profiles, each against a second method. */
#include <float.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_sort.h>

#include "analytic/analytic.h"
#include "tests/check.h"

#define RAD(degrees) ((degrees)*M_PI / 180)

/* One formula of a dozen operations on numbers of order 1. */
static const double ROUND = 16 * DBL_EPSILON;
/* Tolerances for forces in chi g B and for integrals of them. */
static const double FORCE_TOL = 1e-14, INTEGRAL_TOL = 1e-12;

static const double ANGLES_DEG[] = {1e-6, 1.3, 12.7, 30, 32.6, 45, 50, 55, 59.9, 60 - 1e-9};
enum { N_ANGLES = sizeof ANGLES_DEG / sizeof *ANGLES_DEG };

static void *room(long n, size_t size)
{
    void *p = malloc((size_t)n * size);
    if (!p) abort();
    return p;
}

/* Both components; forces of the models. */
#define NEAR_FORCE(f, g, tolerance)                                                                          \
    do {                                                                                                     \
        const an_force f_ = (f), g_ = (g);                                                                   \
        CHECK_NEAR(f_.N, g_.N, tolerance);                                                                   \
        CHECK_NEAR(f_.H, g_.H, tolerance);                                                                   \
    } while (0)

static an_force mirrored_force(an_force f)
{
    return (an_force){f.N, -f.H};
}

static an_force triangle(long k, double theta, long i)
{
    an_force f = {NAN, NAN};
    CHECK_OK(an_lattice_triangle(k, theta, i, &f));
    return f;
}

static an_force continuum(double alpha, double x)
{
    an_force f = {NAN, NAN};
    CHECK_OK(an_continuum(alpha, x, &f));
    return f;
}

static double kink(double alpha)
{
    double x_c = NAN;
    CHECK_OK(an_continuum_kink(alpha, &x_c));
    return x_c;
}

static an_force profile_force(const an_profile *p, double x)
{
    an_force f = {NAN, NAN};
    CHECK_OK(an_profile_force(p, x, &f));
    return f;
}

/* A tent by its angles in degrees; v is its outline. */
static an_profile tent_of(double outer_deg, double inner_deg, double x1, an_point v[5])
{
    an_profile tent;
    CHECK_OK(an_tent(RAD(outer_deg), RAD(inner_deg), x1, v));
    CHECK_OK(an_profile_set(&tent, v, 5));
    return tent;
}

/* ---- lattice */

static void triangle_printed_values(void)
{
    CHECK_NEAR(triangle(45, M_PI / 6, 1).N, 23, 0);
    CHECK_NEAR(triangle(45, M_PI / 6, 1).H, -44 / (2 * sqrt(3)), 44 * ROUND); /* (44): < 0 at the left toe */
    CHECK_NEAR(triangle(45, M_PI / 6, 23).H, 0, 0);
    CHECK_NEAR(triangle(238, 0.8135, 200).N, 119.5, 0); /* (43) */
    CHECK_NEAR(triangle(238, 0.8135, 200).H, tan(0.8135) * 80.5, 81 * ROUND);
    CHECK_NEAR(triangle(AN_LAYERS_MAX, M_PI / 3, AN_LAYERS_MAX).H, sqrt(3) * 999999 / 2, 1e6 * ROUND);
}

static void compare_outline(long k, const long up[], double theta, an_force counts[], an_force recursion[])
{
    const double additions = (double)k * (double)k * DBL_EPSILON; /* forces grow to k by k of them */
    CHECK_OK(an_lattice_counts(k, up, theta, counts));
    CHECK_OK(an_lattice_recursion(k, up, theta, recursion));
    for (long i = 0; i < k; i++) NEAR_FORCE(recursion[i], counts[i], additions);
}

static void triangle_three_ways(void)
{
    const long sizes[] = {1, 2, 3, 45, 237, check_fast() ? 1000 : AN_RECURSION_MAX};
    for (size_t t = 0; t < sizeof sizes / sizeof *sizes; t++) {
        long k = sizes[t], *up = room(k, sizeof *up);
        double theta = RAD(30 + 6.0 * (double)t);
        scoped an_force *a = room(k, sizeof *a), *b = room(k, sizeof *b);
        CHECK_OK(an_lattice_cut(k, theta, M_PI / 2 - theta, up));
        compare_outline(k, up, theta, a, b);
        for (long i = 1; i <= k; i++) {
            CHECK_NEAR(a[i - 1].N, triangle(k, theta, i).N, 0);
            CHECK_NEAR(a[i - 1].H, triangle(k, theta, i).H, (double)k * ROUND);
        }
        double n = (double)k, spacing = 2 * sin(theta); /* weight of the triangle of base B: k(k+1)/2 disks */
        CHECK_NEAR(an_lattice_base(n * (n + 1) / 2, theta, M_PI / 2 - theta), spacing * sqrt(n * (n + 1)),
                   n * ROUND);
        free(up);
    }
}

static void cut_counts(void)
{
    const struct {
        double alpha_deg;
        long base, disks;
    } published[] = {{60, 45, 1035}, {30, 45, 360}, {30, 180, 5490}, {55, 45, 821},
                     {50, 45, 690},  {45, 45, 581}, {32.6, 45, 383}, {1e-7, 45, 45}};
    for (size_t t = 0; t < sizeof published / sizeof *published; t++) {
        long up[180], disks = 0;
        CHECK_OK(an_lattice_cut(published[t].base, RAD(30), RAD(published[t].alpha_deg), up));
        for (long s = 0; s < published[t].base; s++) disks += up[s];
        CU_ASSERT_EQUAL(disks, published[t].disks);
    }
}

/* Under 30 degrees the largest H is base/(12 sqrt 3) m g, for bases of 6 m disks; other bases deviate by
 * their steps: 45 has 7 units of 1/(2 sqrt 3) instead of 7.5, and 1225 has 204 instead of 204.17. */
static void cut_largest_H(void)
{
    static const struct {
        long base;
        double units;
    } piles[] = {{6, 1}, {90, 15}, {180, 30}, {480, 80}, {1224, 204}, {45, 7}, {1225, 204}};
    for (size_t t = 0; t < sizeof piles / sizeof *piles; t++) {
        long up[1225];
        an_force f[1225];
        double most = 0;
        CHECK_OK(an_lattice_cut(piles[t].base, RAD(30), RAD(30), up));
        CHECK_OK(an_lattice_counts(piles[t].base, up, RAD(30), f));
        for (long s = 0; s < piles[t].base; s++) most = fmax(most, fabs(f[s].H));
        CHECK_NEAR(most * 2 * sqrt(3), piles[t].units, piles[t].units * ROUND);
    }
}

/* A disk is in the pile if and only if it is inside both cutting lines, for theta above 30 degrees too. */
static void cut_rule(void)
{
    enum { K = 61 };
    const double theta = RAD(41.3), alpha = RAD(37.9);
    long up[K];
    CHECK_OK(an_lattice_cut(K, theta, alpha, up));
    for (long s = 0; s < K; s++)
        for (long j = 0; j < K; j++) {
            double x = 2 * sin(theta) * ((double)s + 0.5 * (double)j), h = (double)j * cos(theta);
            double right = 2 * sin(theta) * (K - 1) - x;
            CU_ASSERT_EQUAL(j < up[s], fmin(x, right) >= h / tan(alpha) - 1e-12);
        }
}

static void cut_forces(void)
{
    const double slopes_deg[] = {12.7, 30, 32.6, 45, 50, 55, 60};
    enum { K = 97 };
    for (size_t t = 0; t < sizeof slopes_deg / sizeof *slopes_deg; t++) {
        long up[K];
        double disks = 0, weight = 0;
        an_force a[K], b[K];
        CHECK_OK(an_lattice_cut(K, RAD(30), RAD(slopes_deg[t]), up));
        compare_outline(K, up, RAD(30), a, b);
        for (long i = 0; i < K; i++) {
            disks += (double)up[i];
            weight += a[i].N;
            NEAR_FORCE(a[i], mirrored_force(a[K - 1 - i]), 0); /* counts are exact */
        }
        CHECK_NEAR(weight, disks, 0);
        CU_ASSERT(a[0].H <= 0 && a[K / 4].H < 0); /* H < 0 on the left */
    }
}

/* Random supported outlines of several peaks; mirrored, N is mirrored and H too, with opposite sign. */
static void any_outline(void)
{
    enum { K = 211 };
    unsigned state = 2385;
    for (int t = 0; t < 20; t++) {
        long up[K], mirrored[K];
        an_force a[K], b[K];
        for (long s = K - 1, next = 0; s >= 0; next = up[s--]) {
            state = state * 1664525u + 1013904223u;
            up[s] = (state >> 28) < 13 ? next + 1 : next / 2 + 1;
        }
        double theta = RAD(30 + 1.5 * t), disks = 0, weight = 0, thrust = 0;
        compare_outline(K, up, theta, a, b);
        for (long i = 0; i < K; i++) {
            disks += (double)up[i], weight += a[i].N, thrust += a[i].H;
            mirrored[K - 1 - i] = lround(a[i].N + a[i].H / tan(theta)); /* n_ul */
        }
        CHECK_NEAR(weight, disks, 0);
        CHECK_NEAR(thrust, 0, disks * ROUND);
        CHECK_OK(an_lattice_counts(K, mirrored, theta, b));
        for (long i = 0; i < K; i++) NEAR_FORCE(b[K - 1 - i], mirrored_force(a[i]), 0);
    }
}

/* The cut pile converges to the continuum as 1/k. Each count deviates by less than 1 from its chord, B by
 * less than 2 sigma, hence N/(chi g B) by less than 1/k + 2 slope/k, where the flank's slope is largest. */
static void cut_pile_to_continuum(void)
{
    const double slopes_deg[] = {30, 32.6, 45, 50, 55};
    for (long k = 100; k <= (check_fast() ? 10000 : AN_LAYERS_MAX); k *= 100) {
        scoped long *up = room(k, sizeof *up);
        an_force *a = room(k, sizeof *a), f;
        for (size_t t = k > 10000; t < (k > 10000 ? 2 : sizeof slopes_deg / sizeof *slopes_deg); t++) {
            double alpha = RAD(slopes_deg[t]), disks = 0, mean = 0;
            CHECK_OK(an_lattice_cut(k, RAD(30), alpha, up));
            CHECK_OK(an_lattice_counts(k, up, RAD(30), a));
            for (long s = 0; s < k; s++) disks += (double)up[s];
            double base = an_lattice_base(disks, RAD(30), alpha), n = (double)k;
            double bound = 1 + 2 * sin(alpha) / (2 * sin(2 * M_PI / 3 - alpha)) / kink(alpha);
            long misfits = 0;
            for (long i = 0; i < k; i++) {
                f.N = NAN;
                (void)an_continuum(alpha, 0.5 + ((double)i - (n - 1) / 2) / base, &f);
                double off = a[i].N / base - f.N;
                misfits += !(fabs(off) <= bound / n && fabs(a[i].H / base - f.H) <= bound / n);
                mean += off / n;
            }
            CU_ASSERT_EQUAL(misfits, 0);
            CHECK_NEAR(mean, 0, bound / (n * n)); /* an_lattice_base: the mean is free of bias */
        }
        free(a);
    }
}

static void lattice_errors(void)
{
    an_force f[8];
    long up[8];
    const double theta = RAD(30);
    CHECK_FAILS(an_lattice_triangle(0, theta, 1, f), RP_BAD_INPUT, "0 disks");
    CHECK_FAILS(an_lattice_triangle(AN_LAYERS_MAX + 1L, theta, 1, f), RP_BAD_INPUT, "[1, 1000000]");
    CHECK_FAILS(an_lattice_triangle(8, theta, 0, f), RP_BAD_INPUT, "i = 0");
    CHECK_FAILS(an_lattice_triangle(8, theta, 9, f), RP_BAD_INPUT, "[1, 8]");
    CHECK_FAILS(an_lattice_triangle(8, RAD(29.9), 1, f), RP_BAD_INPUT, "theta = 29.9");
    CHECK_FAILS(an_lattice_triangle(8, RAD(60.1), 1, f), RP_BAD_INPUT, "[30, 60]");
    CHECK_FAILS(an_lattice_triangle(8, NAN, 1, f), RP_BAD_INPUT, "theta");
    CHECK_FAILS(an_lattice_cut(0, theta, RAD(30), up), RP_BAD_INPUT, "0 disks");
    CHECK_FAILS(an_lattice_cut(8, RAD(61), RAD(20), up), RP_BAD_INPUT, "theta = 61");
    CHECK_FAILS(an_lattice_cut(8, theta, 0, up), RP_BAD_INPUT, "alpha = 0 degrees");
    CHECK_FAILS(an_lattice_cut(8, theta, RAD(60.5), up), RP_BAD_INPUT, "alpha = 60.5");
    CHECK_FAILS(an_lattice_cut(8, RAD(40), RAD(50.5), up), RP_BAD_INPUT, "90 - theta = 50]");
    CHECK_FAILS(an_lattice_cut(8, theta, NAN, up), RP_BAD_INPUT, "alpha");
    CHECK_OK(an_lattice_cut(8, theta, RAD(60), up));
    CHECK_FAILS(an_lattice_counts(-3, up, theta, f), RP_BAD_INPUT, "-3 disks");
    CHECK_FAILS(an_lattice_counts(8, up, NAN, f), RP_BAD_INPUT, "theta");
    CHECK_FAILS(an_lattice_recursion(AN_RECURSION_MAX + 1L, up, theta, f), RP_BAD_INPUT, "[1, 10000]");
    up[7] = 2;
    CHECK_FAILS(an_lattice_counts(8, up, theta, f), RP_BAD_INPUT, "2 disks on diagonal 7");
    up[7] = 1, up[3] = 0;
    CHECK_FAILS(an_lattice_recursion(8, up, theta, f), RP_BAD_INPUT, "0 disks on diagonal 3");
    up[3] = 6;
    CHECK_FAILS(an_lattice_recursion(8, up, theta, f), RP_BAD_INPUT, "allowed: [1, 5]");
}

/* ---- continuum */

/* (49)-(53) for the left half, the right one by symmetry. */
static an_force by_chords(double alpha, double x)
{
    if (x > 0.5) return mirrored_force(by_chords(alpha, 1 - x));
    double x_c = tan(alpha) / 2 * (1 / tan(alpha) - 1 / sqrt(3));
    double l_1 = x * sin(alpha) / sin(2 * M_PI / 3 - alpha);
    double l_2 =
        x <= x_c ? x * sin(alpha) / sin(M_PI / 3 - alpha) : (1 - x) * sin(alpha) / sin(2 * M_PI / 3 - alpha);
    return (an_force){(l_1 + l_2) / 2, (l_1 - l_2) / (2 * sqrt(3))};
}

/* Errors of sin(60 degrees - alpha) and of x_c are magnified as alpha nears 60 degrees. */
static double near_60(double alpha_deg)
{
    return FORCE_TOL * fmax(1, 5 / (60 - alpha_deg));
}

static void continuum_by_chords(void)
{
    for (int a = 0; a < N_ANGLES; a++)
        for (int i = 0; i <= 1000; i++) {
            double alpha = RAD(ANGLES_DEG[a]), x = i / 1000.0;
            NEAR_FORCE(continuum(alpha, x), by_chords(alpha, x), near_60(ANGLES_DEG[a]));
        }
}

static void continuum_printed_values(void)
{
    CHECK_NEAR(kink(RAD(30)), 1.0 / 3, ROUND);
    CHECK_NEAR(continuum(RAD(30), 0.5).N, 0.25, ROUND); /* (56): sin 30/(2 sin 90) */
    CHECK_NEAR(continuum(RAD(30), 0.5).H, 0, 0);
    /* (54), (55): sqrt 3 x sqrt 3/4, -x/(4 sqrt 3) */
    NEAR_FORCE(continuum(RAD(30), 0.1), ((an_force){0.075, -0.1 / (4 * sqrt(3))}), ROUND);
    CHECK_NEAR(continuum(RAD(45), 0.6).H, 0.1 * sin(RAD(45)) / (sqrt(3) * sin(RAD(75))), ROUND); /* (57) */
    for (int edge = 0; edge <= 1; edge++) {
        NEAR_FORCE(continuum(RAD(45), edge), ((an_force){0, 0}), 0);
        CU_ASSERT(!signbit(continuum(RAD(45), edge).H)); /* no "-0" in tables */
    }
}

static void continuum_is_continuous(void)
{
    for (int a = 0; a < N_ANGLES; a++) {
        double alpha = RAD(ANGLES_DEG[a]), x_c = kink(alpha);
        for (int side = 0; side <= 1; side++) {
            double x = side ? 1 - x_c : x_c;
            /* the flanks' slope is at most 1/x_c in N and in H */
            NEAR_FORCE(continuum(alpha, x - 4 * DBL_EPSILON), continuum(alpha, x + 4 * DBL_EPSILON),
                       ROUND * (1 + 1 / x_c));
        }
    }
}

static double continuum_N(double x, void *alpha)
{
    return continuum(*(double *)alpha, x).N;
}

static void continuum_weight(void)
{
    gsl_integration_workspace *w = gsl_integration_workspace_alloc(100);
    for (int a = 0; a < N_ANGLES; a++) {
        double alpha = RAD(ANGLES_DEG[a]), kinks[] = {0, kink(alpha), 1 - kink(alpha), 1}, integral = NAN,
               error;
        gsl_function N = {continuum_N, &alpha};
        CU_ASSERT_EQUAL(gsl_integration_qagp(&N, kinks, 4, 0, 1e-13, 100, w, &integral, &error), 0);
        CHECK_NEAR(integral, tan(alpha) / (2 * sqrt(3)), INTEGRAL_TOL);
    }
    gsl_integration_workspace_free(w);
}

static void continuum_symmetry_and_friction(void)
{
    for (int a = 0; a < N_ANGLES; a++) {
        double alpha = RAD(ANGLES_DEG[a]), largest = 0;
        for (int i = 1; i < 1024; i++) {
            double x = i / 1024.0; /* 1 - x is exact */
            const an_force f = continuum(alpha, x);
            NEAR_FORCE(f, mirrored_force(continuum(alpha, 1 - x)), 0);
            largest = fmax(largest, fabs(f.H) / f.N);
        }
        /* taken on the flanks, x < x_c: the grid reaches them below 59.9 degrees */
        if (ANGLES_DEG[a] < 59.8) CHECK_NEAR(largest, tan(alpha) / 3, ROUND);
        CU_ASSERT(largest <= tan(alpha) / 3 + ROUND);
    }
}

static void continuum_limits(void)
{
    /* alpha -> 60 degrees gives (42), (44) with B = (k + 1) sigma. The deviation is of order 60 degrees -
     * alpha; the factor is below 1 there. */
    const double short_of_60 = 1e-8;
    enum { K = 45 };
    for (long i = 1; i <= K; i++) {
        const an_force f = continuum(M_PI / 3 - short_of_60, (double)i / (K + 1)),
                       g = triangle(K, M_PI / 6, i);
        CHECK_PAIRS((K + 1) * short_of_60, {f.N * (K + 1), g.N}, {f.H * (K + 1), g.H});
    }
    /* alpha -> 0: N is the weight above, y 2/sqrt 3, to relative order alpha */
    const double tiny[] = {1e-9, 1e-100, DBL_MIN};
    for (int t = 0; t < 3; t++)
        for (double x = 0.117; x < 0.5; x += 0.1) {
            const an_force f = continuum(tiny[t], x);
            CHECK_NEAR(f.N / tiny[t], x * 2 / sqrt(3), 2 * tiny[t] + ROUND);
            CHECK_NEAR(f.H, 0, tiny[t] * tiny[t]);
        }
    /* the last angle below 60 degrees */
    for (double x = 0; x <= 1; x += 0.125) {
        const an_force f = continuum(nextafter(M_PI / 3, 0), x);
        CU_ASSERT(f.N >= 0 && f.N <= 0.5 + ROUND && fabs(f.H) <= f.N);
    }
}

static void continuum_errors(void)
{
    an_force f;
    double x_c;
    const double bad[] = {0, -0.1, M_PI / 3, 1.2, NAN, INFINITY};
    for (size_t t = 0; t < sizeof bad / sizeof *bad; t++) {
        CHECK_FAILS(an_continuum(bad[t], 0.3, &f), RP_BAD_INPUT, "allowed: (0, 60)");
        CHECK_FAILS(an_continuum_kink(bad[t], &x_c), RP_BAD_INPUT, "alpha = ");
    }
    CHECK_FAILS(an_continuum(0.5, -1e-17, &f), RP_BAD_INPUT, "allowed: [0, 1]");
    CHECK_FAILS(an_continuum(0.5, 1.2, &f), RP_BAD_INPUT, "x/B = 1.2");
    CHECK_FAILS(an_continuum(0.5, NAN, &f), RP_BAD_INPUT, "x/B");
}

/* ---- profiles */

static void tent_is_triangle(void)
{
    for (int t = 1; t < 65; t++) {
        double alpha_deg = t <= 55 ? t : 60 - pow(10, 55 - t),
               alpha = RAD(alpha_deg); /* 1 .. 55, 59.9, 59.99 .. */
        an_point v[5];
        const an_profile tent = tent_of(alpha_deg, alpha_deg, 0.2385, v);
        for (int i = 0; i <= 201; i++)
            NEAR_FORCE(profile_force(&tent, i / 201.0), continuum(alpha, i / 201.0), near_60(alpha_deg));
    }
}

static double profile_N(double x, void *profile)
{
    return profile_force(profile, x).N;
}

static double profile_H(double x, void *profile)
{
    return profile_force(profile, x).H;
}

/* Two peaks, a valley that touches the base, and a base that starts away from 0. */
static const an_point RANGE[] = {{-2.385, 0}, {-1.1, 1.9}, {-0.45, 1.75}, {0.77, 0},
                                 {1.6, 0.31}, {2.9, 2.4},  {4.115, 0.42}, {4.9, 0}};
enum { N_RANGE = sizeof RANGE / sizeof *RANGE };

static void profile_chords_end_on_outline(void)
{
    an_profile p;
    CHECK_OK(an_profile_set(&p, RANGE, N_RANGE));
    for (int i = 0; i <= 997; i++) {
        double x = RANGE[0].x + (RANGE[N_RANGE - 1].x - RANGE[0].x) * i / 997, l[2] = {NAN, NAN},
               y[2] = {NAN, NAN};
        CHECK_OK(an_profile_chords(&p, x, l));
        CHECK_OK(an_profile_height(&p, fmax(x - l[0] / 2, RANGE[0].x), &y[0]));
        CHECK_OK(an_profile_height(&p, fmin(x + l[1] / 2, RANGE[N_RANGE - 1].x), &y[1]));
        for (int side = 0; side < 2; side++) CHECK_NEAR(y[side], l[side] * sqrt(3) / 2, 8 * ROUND);
    }
    double y;
    CHECK_OK(an_profile_height(&p, 1.185, &y));
    CHECK_NEAR(y, 0.155, ROUND);
}

/* N sums to the weight, 2/sqrt 3 of the area in these units, and H to 0. Both are linear between the
 * positions whose rays end on a vertex. */
static void profile_weight(void)
{
    an_profile p;
    double area = 0, N = NAN, H = NAN, error, base = RANGE[N_RANGE - 1].x - RANGE[0].x, kinks[2 * N_RANGE];
    CHECK_OK(an_profile_set(&p, RANGE, N_RANGE));
    for (int i = 0; i < N_RANGE; i++) {
        if (i > 0) area += (RANGE[i].x - RANGE[i - 1].x) * (RANGE[i].y + RANGE[i - 1].y) / 2;
        kinks[2 * i] = RANGE[i].x - RANGE[i].y / sqrt(3);
        kinks[2 * i + 1] = RANGE[i].x + RANGE[i].y / sqrt(3);
    }
    gsl_sort(kinks, 1, 2 * N_RANGE);
    gsl_integration_workspace *w = gsl_integration_workspace_alloc(100);
    gsl_function f = {profile_N, &p}, g = {profile_H, &p};
    CU_ASSERT_EQUAL(gsl_integration_qagp(&f, kinks, 2 * N_RANGE, INTEGRAL_TOL, 0, 100, w, &N, &error), 0);
    CU_ASSERT_EQUAL(gsl_integration_qagp(&g, kinks, 2 * N_RANGE, INTEGRAL_TOL, 0, 100, w, &H, &error), 0);
    CHECK_PAIRS(INTEGRAL_TOL * base, {N, area * 2 / sqrt(3) / base}, {H, 0});
    gsl_integration_workspace_free(w);
}

static void profile_mirror_and_scale(void)
{
    an_point m[N_RANGE];
    an_profile p, q;
    const double scale = 7.31;
    for (int i = 0; i < N_RANGE; i++)
        m[N_RANGE - 1 - i] = (an_point){-scale * RANGE[i].x, scale * RANGE[i].y};
    CHECK_OK(an_profile_set(&p, RANGE, N_RANGE));
    CHECK_OK(an_profile_set(&q, m, N_RANGE));
    for (double x = RANGE[0].x; x < RANGE[N_RANGE - 1].x; x += 0.0371) {
        /* slopes to 58 degrees */
        NEAR_FORCE(profile_force(&p, x), mirrored_force(profile_force(&q, -scale * x)), 8 * ROUND);
    }
}

/* A parabola c x (1 - x) in many straight pieces: a ray of slope sqrt 3 intersects it at a root of a
 * quadratic. The pieces lie c h^2/4 below it at most; the ray meets them under an angle of more than 1/4. */
static void profile_of_many_vertices(void)
{
    enum { PIECES = 100000 };
    const double c = 1.25, h = 1.0 / PIECES, tol = c * h * h / 4 * 2 / sqrt(3) * 4 + ROUND * PIECES / 1e3;
    scoped an_point *v = room(PIECES + 1, sizeof *v);
    an_profile p;
    for (int i = 0; i <= PIECES; i++) v[i] = (an_point){i * h, c * (i * h) * (1 - i * h)};
    v[PIECES] = (an_point){1, 0};
    CHECK_OK(an_profile_set(&p, v, PIECES + 1));
    for (int i = 1; i < 100; i++) {
        double x = i / 100.0 + 0.00123 * h, l[2] = {NAN, NAN};
        CHECK_OK(an_profile_chords(&p, x, l));
        for (int side = 0; side < 2; side++) {
            /* with d = l/2 and z = x, or 1 - x to the left: 2 d sin 60 = c (z + d)(1 - z - d) */
            double z = side ? x : 1 - x, b = c * (2 * z - 1) + sqrt(3), e = c * z * (1 - z);
            CHECK_NEAR(l[side], 4 * e / (b + sqrt(b * b + 4 * c * e)), tol);
        }
    }
}

static double tent_at(double outer_deg, double inner_deg, double x)
{
    an_point v[5];
    const an_profile tent = tent_of(outer_deg, inner_deg, 0.38, v);
    return profile_force(&tent, x).N;
}

/* The vertices of a tent, all of them set. */
static void tent_vertices(void)
{
    an_point v[5];
    for (int i = 0; i < 5; i++) v[i] = (an_point){NAN, NAN};
    CHECK_OK(an_tent(RAD(45), atan(0.5), 0.2, v));
    static const an_point typed[5] = {{0, 0}, {0.2, 0.2}, {0.5, 0.35}, {0.8, 0.2}, {1, 0}};
    for (int i = 0; i < 5; i++) CHECK_PAIRS(1e-15, {v[i].x, typed[i].x}, {v[i].y, typed[i].y});
}

/* Fig. 19: a dip under the middle for a peak steeper than the flanks, and none for a flattened one. */
static void tent_dip(void)
{
    double highest = 0, flattened = 0;
    for (int i = 0; i <= 1000; i++) {
        highest = fmax(highest, tent_at(30, 45, i / 1000.0));
        flattened = fmax(flattened, tent_at(45, 30, i / 1000.0));
    }
    /* in the middle both rays meet the outer slope: tan 30 (1/2)/(sin 60 + cos 60 tan 30) each */
    CHECK_NEAR(tent_at(30, 45, 0.5), 0.25, ROUND);
    CHECK_NEAR(1 - 0.25 / highest, 0.08, 0.005); /* two digits known */
    CHECK_NEAR(tent_at(45, 30, 0.5), flattened, ROUND);
}

/* The largest N is at least a scan's, at the same position: tents of all kinds, outlines in any unit. */
static void largest_force(void)
{
    static const double tents[][3] = {
        {30, 45, 0.38}, {45, 30, 0.38}, {10, 55, 0.45}, {55, 20, 0.1}, {40, 40, 0.2}};
    for (size_t t = 0; t < 5; t++) {
        const double unit = 7.3, left = -2.1;
        an_point v[5];
        an_profile tent = tent_of(tents[t][0], tents[t][1], tents[t][2], v);
        double x, N, scanned = 0;
        for (int i = 0; i < 5; i++) v[i] = (an_point){left + unit * v[i].x, unit * v[i].y};
        CHECK_OK(an_profile_set(&tent, v, 5));
        CHECK_OK(an_profile_largest(&tent, &x, &N));
        for (int i = 0; i <= 3000; i++)
            scanned = fmax(scanned, profile_force(&tent, left + unit * i / 3000.0).N);
        CU_ASSERT(scanned <= N + ROUND && scanned > N - 2.0 / 3000);
        CHECK_NEAR(profile_force(&tent, x).N, N, ROUND);
        CU_ASSERT(x <= left + unit / 2 + ROUND); /* the first of two */
    }
}

/* Before (49): a weight W on two rays at pi/6 to the vertical gives W/(2 cos(pi/6)) = W/sqrt 3 along each, as
 * in the lattice below a single disk; the printed pi/3 would give W along each. */
static void misprint_theta(void)
{
    const an_force f = triangle(2, M_PI / 6, 2);
    CHECK_PAIRS(ROUND, {hypot(f.N - 1, f.H), 1 / sqrt(3)}, {1 / (2 * cos(M_PI / 6)), 1 / sqrt(3)},
                {1 / (2 * cos(M_PI / 3)), 1});
}

static void profile_errors(void)
{
    an_profile p;
    an_point v[5] = {{0, 0}, {1, 1}, {2, 0.5}, {3, 1}, {4, 0}};
    double l[2];
    an_force f;
    CHECK_OK(an_profile_set(&p, v, 5));
    CHECK_FAILS(an_profile_chords(&p, -1e-17, l), RP_BAD_INPUT, "allowed: [0, 4]");
    CHECK_FAILS(an_profile_height(&p, 4.01, l), RP_BAD_INPUT, "x = 4.01");
    CHECK_FAILS(an_profile_force(&p, NAN, &f), RP_BAD_INPUT, "x = ");
    CHECK_FAILS(an_profile_set(&p, v, 2), RP_BAD_INPUT, "2 vertices");
    CHECK_FAILS(an_profile_set(&p, v, 4), RP_BAD_INPUT, "heights 0 and 1");
    CHECK_FAILS(an_profile_set(&p, v + 1, 4), RP_BAD_INPUT, "heights 1 and 0");
    const struct {
        an_point point;
        const char *text;
    } bad[] = {{{2, -0.1}, "vertex 2 at (2, -0.1)"},
               {{NAN, 1}, "vertex 2"},
               {{2, INFINITY}, "vertex 2"},
               {{1, 0.5}, "not a function of x"},
               {{0.5, 1}, "after x = 1"},
               {{2, 1 + sqrt(3)}, "allowed: (-60, 60)"},
               {{2, 2.8}, "before vertex 2"},
               {{2.6, 0.1}, "before vertex 3"}};
    for (size_t t = 0; t < sizeof bad / sizeof *bad; t++) {
        v[2] = bad[t].point;
        CHECK_FAILS(an_profile_set(&p, v, 5), RP_BAD_INPUT, bad[t].text);
    }
    v[2] = (an_point){2, 0.5};
    v[4].y = -0.1;
    CHECK_FAILS(an_profile_set(&p, v, 5), RP_BAD_INPUT, "vertex 4 at (4, -0.1)");
    v[4].y = 0;
    v[4].x = 3.5;
    CHECK_FAILS(an_profile_set(&p, v, 5), RP_BAD_INPUT, "before vertex 4");
    v[4].x = 4;
    v[0].x = -INFINITY;
    CHECK_FAILS(an_profile_set(&p, v, 5), RP_BAD_INPUT, "vertex 0 at (-inf, 0)");
    CHECK_FAILS(an_tent(0, 0.5, 0.3, v), RP_BAD_INPUT, "alpha_1 = 0");
    CHECK_FAILS(an_tent(M_PI / 3, 0.5, 0.3, v), RP_BAD_INPUT, "alpha_1 = 60");
    CHECK_FAILS(an_tent(0.5, NAN, 0.3, v), RP_BAD_INPUT, "alpha_2");
    CHECK_FAILS(an_tent(0.5, -0.1, 0.3, v), RP_BAD_INPUT, "allowed: (0, 60)");
    CHECK_FAILS(an_tent(0.5, 0.7, 0, v), RP_BAD_INPUT, "X_1/B = 0:");
    CHECK_FAILS(an_tent(0.5, 0.7, 0.5, v), RP_BAD_INPUT, "allowed: (0, 0.5)");
    CHECK_FAILS(an_tent(0.5, 0.7, NAN, v), RP_BAD_INPUT, "X_1");
}

CHECK_SUITE(analytic, "analytic", triangle_printed_values, triangle_three_ways, cut_counts, cut_largest_H,
            cut_rule, cut_forces, any_outline, cut_pile_to_continuum, lattice_errors,
            continuum_printed_values, continuum_by_chords, continuum_is_continuous, continuum_weight,
            continuum_symmetry_and_friction, continuum_limits, continuum_errors, tent_is_triangle,
            tent_vertices, tent_dip, largest_force, misprint_theta, profile_chords_end_on_outline,
            profile_weight, profile_mirror_and_scale, profile_of_many_vertices, profile_errors)
