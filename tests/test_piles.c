/* Piles for the static solver, the dip of N, and protocol `pile`: closed forms, the exact forces of diagonal
 * contacts, unequal disks, runs without a result. */
#include <gsl/gsl_fit.h>
#include <gsl/gsl_statistics_double.h>

#include "experiment/modules/module.h"
#include "sweeps/protocols/pile.h"
#include "tests/protocol.h"
#include "tests/program.h"

static const double DEG = M_PI / 180;

/* Forces of up to 1e3 (m g) balance to the solver's tolerance, sums over a hundred base disks. */
#define BALANCE 1e-9

/* ---- the outline ---- */

/* A pile of 55 degrees has steps: a row starts half a diameter to the right of the one below, as in a slope
 * of 60 degrees, or at a step one and a half. The steps make up what the slope lacks over its height, 3.8. */
static void steps_of_a_slope(void)
{
    enum { ROWS = 37 };
    const double row = sin(60 * DEG), lacks = (ROWS - 1) * row * (1 / tan(55 * DEG) - 1 / tan(60 * DEG));
    double left[ROWS], right[ROWS];
    size_t steps = 0;
    RP_ENDS(sweep_outline_free) sweep_outline h = {0};
    CHECK_OK(sweep_outline_make(&h, 45, 0, 55 * DEG, 0, NULL));
    for (size_t k = 0; k < ROWS; k++) left[k] = INFINITY, right[k] = -INFINITY;
    for (size_t i = 0; i < h.n; i++) {
        const long k = lround((h.disks[i].y - 0.5) / row);
        CU_ASSERT_FATAL(k >= 0 && k < ROWS);
        left[k] = fmin(left[k], h.disks[i].x);
        right[k] = fmax(right[k], h.disks[i].x);
    }
    for (size_t k = 1; k < ROWS; k++) {
        const double shift = left[k] - left[k - 1];
        CHECK_PAIRS(1e-9, {right[k - 1] - right[k], shift}, {shift, shift > 1 ? 1.5 : 0.5});
        steps += shift > 1;
    }
    CU_ASSERT(steps == (size_t)lround(lacks) && steps == 4);
}

/* ---- the dip ---- */

/* D of the loads N of k disks at x, a distance `apart`. */
static double dip_of(size_t k, const double x[], const double N[], double apart)
{
    stress_base base;
    scoped double *r = malloc(k * sizeof *r);
    for (size_t i = 0; i < k; i++) r[i] = apart / 2;
    CHECK_OK(stress_base_profile(k, x, r, N, &base));
    return stress_dip(base.N);
}

/* Of bins whose mean is 1: that of the four in the middle, and that less the mean of two on either side. */
static double inner(const double N[])
{
    return (N[8] + N[9] + N[10] + N[11]) / 4;
}

static double middle_of(const double N[])
{
    return inner(N) - (N[6] + N[7] + N[12] + N[13]) / 4;
}

/* Loads 1 + s |u|^power of k disks at 3 + 0.2 u, u from -1/2 to 1/2. */
static double heaped(size_t k, double s, double power)
{
    scoped double *x = malloc(k * sizeof *x), *N = malloc(k * sizeof *N);
    for (size_t i = 0; i < k; i++) {
        const double u = ((double)i + 0.5) / (double)k - 0.5;
        x[i] = 3 + 0.2 * u;
        N[i] = 1 + s * pow(fabs(u), power);
    }
    return dip_of(k, x, N, 0.2 / (double)k);
}

/* B ends at a disk, so that w has an error of up to 2/K; |dD/dw| is at most 0.45 |s|. */
#define TOLERANCE(s, K) (0.9 * fabs(s) / (K) + 1e-12)

/* Half of the load within w/2 of the middle: w + s w^2/4 = 0.98 (1 + s/4); the means of 1 + s |u| are 1 + s
 * 0.05 w, 1 + s 0.2 w and 1 + s w/4. */
static void dip_closed_forms(void)
{
    enum { K = 2000 };
    static const double slopes[] = {0, 0.7, -1.3, 40};
    for (int i = 0; i < 4; i++) {
        const double s = slopes[i], rest = 0.98 * (1 + s / 4);
        const double w = 2 * rest / (1 + sqrt(1 + s * rest));
        CHECK_NEAR(heaped(K, s, 1), -0.15 * s * w / (1 + s * w / 4), TOLERANCE(s, K));
    }
    /* 1 + s u^2: w + s w^3/12 = 0.98 (1 + s/12) by Newton; means 1 + s w^2 times 0.01/3, 0.13/3, 1/12 */
    const double s = 3.1;
    double w = 1;
    for (int i = 0; i < 20; i++) w -= (w + s * w * w * w / 12 - 0.98 * (1 + s / 12)) / (1 + s * w * w / 4);
    CHECK_NEAR(heaped(K, s, 2), -0.04 * s * w * w / (1 + s * w * w / 12), TOLERANCE(s, K));
    CHECK_NEAR(heaped(45, 0.7, 1), heaped(K, 0.7, 1), TOLERANCE(0.7, 45));
}

/* Shifted, stretched, mirrored, with doubled loads; the centroid is the origin of an asymmetric load. */
static void dip_invariances(void)
{
    enum { K = 31 };
    double x[K], N[K], y[K], M[K];
    for (int i = 0; i < K; i++) x[i] = i + 0.3 * sin(i), N[i] = 2 + sin(0.37 * i) + 0.01 * i;
    const double D = dip_of(K, x, N, 1);
    for (int i = 0; i < K; i++) y[i] = 7 - 0.3 * x[K - 1 - i], M[i] = 2 * N[K - 1 - i];
    CHECK_NEAR(dip_of(K, y, M, 0.3), D, 1e-12);
    CU_ASSERT(fabs(D) > 0.01);
}

/* ---- dips ---- */

/* N = 2 + the distance from the middle in bins: means 3 within 0.1 B, 5 to 0.2 B, 6 to 0.3 B, 7 of all. */
static void dips_of_a_wedge(void)
{
    double N[STRESS_DIP_BINS], rays[STRESS_DIP_BINS];
    for (int k = 0; k < STRESS_DIP_BINS; k++) N[k] = 2 + fabs(k + 0.5 - STRESS_DIP_BINS / 2), rays[k] = 1;
    CHECK_PAIRS(1e-15, {stress_dip(N), -3.0 / 7}, {stress_middle(N), -2.0 / 7},
                {stress_excess(N, rays), 2.0 / 7});
}

/* ---- rays under an outline ---- */

/* Highest points at the middles of columns, along the tent, or for a continuum slope the triangle. The
 * polygon is cut at ends and top by up to half a column: heights differ by 0.5 tan 45 degrees of 30, 2 %. */
static void rays_under_outlines(void)
{
    enum { COLUMNS = 120, AT = 7, POINTS = 10 };
    static const double inner_deg[] = {30, 45};
    for (int tent = 0; tent < 2; tent++) {
        an_point v[5];
        an_profile profile;
        CHECK_OK(an_tent(30 * DEG, inner_deg[tent] * DEG, 0.38, v));
        CHECK_OK(an_profile_set(&profile, v, 5));
        double x[COLUMNS], top[COLUMNS], rays[STRESS_DIP_BINS], mean = 0, exact[STRESS_DIP_BINS] = {0};
        for (int i = 0; i < COLUMNS; i++) { /* in no order */
            const double at = (i * 7 % COLUMNS + 0.5) / COLUMNS;
            x[i] = AT + COLUMNS * at;
            CHECK_OK(an_profile_height(&profile, at, &top[i]));
            top[i] *= COLUMNS;
        }
        const stress_base base = {.centroid = AT + 0.5 * COLUMNS, .width = 0.9 * COLUMNS};
        CHECK_OK(exp_outline_rays(COLUMNS, x, top, &base, rays));
        for (int i = 0; i < POINTS * STRESS_DIP_BINS; i++) {
            an_force f;
            CHECK_OK(
                an_profile_force(&profile, 0.5 + 0.9 * ((i + 0.5) / (POINTS * STRESS_DIP_BINS) - 0.5), &f));
            exact[i / POINTS] += f.N / POINTS;
            mean += f.N / (POINTS * STRESS_DIP_BINS);
        }
        for (int k = 0; k < STRESS_DIP_BINS; k++) CHECK_NEAR(rays[k], exact[k] / mean, 0.02);
        CU_ASSERT((stress_middle(rays) < -0.03) == (tent == 1) && fabs(middle_of(rays)) < 0.1);
        CHECK_NEAR(stress_middle(rays), middle_of(rays), 1e-12);
        CHECK_NEAR(stress_excess(rays, rays), 0, 0);
    }
}

/* A wall is steeper than rays: its foot is filled. Points left of zero; a base beyond the disks. */
static void rays_under_walls(void)
{
    enum { N = 9 };
    double x[N], top[N], rays[STRESS_DIP_BINS];
    for (int i = 0; i < N; i++) x[i] = i - 13.5, top[i] = 17;
    const stress_base base = {.centroid = x[4], .width = 32};
    CHECK_OK(exp_outline_rays(N, x, top, &base, rays));
    for (int k = 0; k < STRESS_DIP_BINS / 2; k++) {
        CHECK_NEAR(rays[k], rays[STRESS_DIP_BINS - 1 - k], 1e-9);
        /* from x up to 17 along both rays within the block and its filled feet, 10 wide each */
        const double beyond = fmax(fabs(-16 + 1.6 * (k + 0.5)) - 4, 0);
        CU_ASSERT(beyond > 10.1 ? rays[k] < 1e-12 : rays[k] > 0.01);
    }
    const stress_base wide = {.centroid = 3.5, .width = 60}; /* far beyond the one disk */
    CHECK_OK(exp_outline_rays(1, (double[]){3.5}, (double[]){1.7}, &wide, rays));
    for (int k = 0; k < STRESS_DIP_BINS; k++) CU_ASSERT((rays[k] > 0) == (k == 9 || k == 10));
    /* the highest disk, of any number, needs room for its feet */
    const stress_base narrow = {.centroid = 1, .width = 2};
    for (int high = 0; high < 3; high++) {
        double tops[] = {1, 1, 1, 0};
        tops[high] = 17;
        CHECK_OK(exp_outline_rays(3, (double[]){0, 1, 2, 0}, tops, &narrow, rays));
    }
}

/* ---- outlines as polygons ---- */

/* A triangle of any size, anywhere, holds the disks that its slope does, rows that end on the outline too;
 * over the square of the base its area is tan(alpha)/4. */
static void outlines_of_any_size(void)
{
    static const double sizes[] = {1e-6, 1, 1e6};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (long k = 2; k < 40; k += 5)
            for (int alpha_deg = 20; alpha_deg <= 50; alpha_deg += 10) {
                const double width = (double)(k - 1) * sizes[i], left = 3 * sizes[i];
                const an_point v[] = {
                    {left, 0}, {left + width / 2, width / 2 * tan(alpha_deg * DEG)}, {left + width, 0}};
                RP_ENDS(sweep_outline_free) sweep_outline slope = {0}, drawn = {0};
                CHECK_OK(sweep_outline_count(&slope, k, 0, alpha_deg * DEG, 0, NULL));
                CHECK_OK(sweep_outline_count(&drawn, k, 0, 0, 3, v));
                CU_ASSERT_EQUAL(drawn.n, slope.n);
                for (long s = 0; s < k; s++) CU_ASSERT_EQUAL(drawn.up[s], slope.up[s]);
                const double disks = (double)drawn.n * sin(60 * DEG);
                CHECK_NEAR(drawn.B, sqrt(4 * disks / tan(alpha_deg * DEG)), 1e-9 * drawn.B);
            }
}

/* ---- friction required at the base ---- */

/* By hand; diagonals alone, full triangle: tan(30 degrees) (k - 1)/(k + 1), at the ends of the base. */
static void friction_of_base(void)
{
    const double N[] = {2, 4, 5, 0}, H[] = {-1.5, 2, -1, 0}, pushed[] = {0, 0, 0, 1e-9};
    CU_ASSERT(sweep_outline_friction(4, N, H) == 0.75);
    CU_ASSERT(sweep_outline_friction(1, N + 3, H) == INFINITY &&
              sweep_outline_friction(4, N, pushed) == INFINITY);
    for (long k = 2; k < 50; k += 9) {
        RP_ENDS(sweep_outline_free) sweep_outline h = {0};
        double exact_N[50], exact_H[50];
        CHECK_OK(sweep_outline_make(&h, k, 0, 0, 0, NULL));
        for (long i = 0; i < k; i++) exact_N[i] = h.exact[i].N, exact_H[i] = h.exact[i].H;
        CHECK_NEAR(sweep_outline_friction(h.k, exact_N, exact_H), (double)(k - 1) / (double)(k + 1) / sqrt(3),
                   1e-12);
    }
}

/* ---- unequal disks ---- */

static void sizes(void)
{
    const double S = 0.02385;
    RP_ENDS(sweep_outline_free) sweep_outline a = {0}, b = {0};
    CHECK_OK(sweep_outline_make(&a, 100, 0, 50 * DEG, 0, NULL));
    CHECK_OK(sweep_outline_make(&b, 100, 0, 50 * DEG, 0, NULL));
    CHECK_OK(sweep_outline_disorder(&a, S, 7, 3));
    CHECK_OK(sweep_outline_disorder(&b, S, 7, 4));
    double sum = 0, squares = 0;
    size_t n = 0, same = 0;
    for (size_t i = 0; i < a.n; i++) {
        const statics_disk *p = &a.disks[i];
        const double z = (2 * p->r - 1) / S;
        CHECK_NEAR(p->weight, 4 * p->r * p->r, 1e-14);
        if (p->y == 0.5) {
            CU_ASSERT(p->r == 0.5 && p->weight == 1);
            continue;
        }
        n++;
        same += p->r == b.disks[i].r;
        CU_ASSERT(fabs(z) <= 3);
        sum += z;
        squares += z * z;
    }
    /* truncated at 3 the variance is 0.9733; five standard errors */
    CU_ASSERT(n > 3000 && same == 0);
    CHECK_NEAR(sum / (double)n, 0, 5 / sqrt((double)n));
    CHECK_NEAR(squares / (double)n, 0.9733, 5 * sqrt(2 / (double)n));
    CHECK_OK(sweep_outline_disorder(&b, S, 7, 3)); /* drawn again */
    for (size_t i = 0; i < a.n; i++) CU_ASSERT(a.disks[i].r == b.disks[i].r);
}

/* The base carries the weight without a net horizontal force, from nearly equal sizes to gaps and overlaps of
 * a hundred times the largest force; all of these states are stable. */
static void unequal_piles_stand(void)
{
    static const double S[] = {1e-6, 1e-4, 1e-2}, eps[] = {1e-4, 1e-6};
    for (int c = 0; c < (check_fast() ? 2 : 6); c++) {
        RP_ENDS(sweep_outline_free) sweep_outline h = {0};
        CHECK_OK(sweep_outline_make(&h, 24, 0, 30 * DEG, 0, NULL));
        CHECK_OK(sweep_outline_disorder(&h, S[c / 2], 1992, (unsigned long)c));
        statics_definition def = statics_definition_default();
        def.n = h.n, def.disks = h.disks, def.eps = eps[c % 2];
        def.branch = STATICS_BRANCH_MINIMUM;
        statics_pile *pile = NULL;
        statics_result r;
        double N[24], H[24], weight = 0, load = 0, push = 0;
        CHECK_OK(statics_create(&def, &pile));
        CHECK_OK(statics_solve(pile, &r));
        statics_base(pile, NULL, N, H);
        for (size_t i = 0; i < h.n; i++) weight += h.disks[i].weight;
        for (size_t i = 0; i < h.k; i++) load += N[i], push += H[i];
        CHECK_PAIRS(BALANCE, {load, weight}, {push, 0});
        CU_ASSERT(r.fault == STATICS_OK && r.negative_modes == 0 && r.residual < 1e-9);
        statics_free(pile);
    }
}

/* ---- the protocol ---- */

/* Run with "name=value" changes of the defaults, ended by NULL. */
static rp_status run_pile(const char *const changes[], unsigned long number, sweep_result *result)
{
    const sweep_protocol *p = &sweep_protocol_pile;
    scoped void *params = protocol_params(p, changes);
    rp_status status = p->check(params);
    if (!status) status = p->run(params, 1992, number, NULL, result);
    return status;
}

#define RUN(number, result, ...) run_pile((const char *const[]){__VA_ARGS__, NULL}, number, result)

static double output(const sweep_result *result, const char *name)
{
    return protocol_output(&sweep_protocol_pile, result, name);
}

/* With gaps no contact within a row closes: forces of diagonal contacts alone, under a triangle and under a
 * tent, whose N has its dip. */
static void open_rows(void)
{
    static const char *const inner[] = {"inner_deg=auto", "inner_deg=45"};
    for (int tent = 0; tent < 2; tent++) {
        sweep_result r;
        CHECK_OK(RUN(0, &r, "base=50", "alpha_deg=30", "x_1=0.38", "eps=0", "gap=0.005", inner[tent]));
        CU_ASSERT_STRING_EQUAL(r.status, "ok");
        CHECK_EACH(output(&r, NAME), BALANCE, {"N_error_rms", 0}, {"N_error_max", 0}, {"H_ratio", 1},
                   {"thrust_ratio", 1}, {"H_slope_ratio", 1});
        CU_ASSERT(output(&r, "strongest_level") == 0 && output(&r, "weakest_level") == 0);
        CHECK_EACH(output(&r, NAME), BALANCE, {"D", output(&r, "D_diagonals")},
                   {"middle", output(&r, "middle_diagonals")}, {"excess", 0});
        CU_ASSERT(output(&r, "horizontal") == 0 && output(&r, "negative_modes") == 0);
        CU_ASSERT((output(&r, "middle") < -0.02) == (tent == 1));
    }
}

/* With diagonal contacts alone, deviations from the continuum decrease as 1/k; with contacts within rows the
 * deviation of H remains. */
static void against_continuum(void)
{
    double N[2], H[2];
    for (int i = 0; i < 2; i++) {
        sweep_result r;
        CHECK_OK(RUN(0, &r, i ? "base=120" : "base=30", "alpha_deg=30", "eps=0", "gap=1e-7"));
        N[i] = output(&r, "N_continuum_rms");
        H[i] = output(&r, "H_continuum_rms");
    }
    CU_ASSERT(N[0] < 0.05 && N[1] < 0.4 * N[0] && H[1] < 0.4 * H[0]);
    sweep_result r;
    CHECK_OK(RUN(0, &r, "base=120", "alpha_deg=30", "eps=0"));
    CU_ASSERT(output(&r, "weakest_level") > 0.5 && output(&r, "strongest_level") < 0.05);
    CU_ASSERT(output(&r, "H_continuum_rms") > 0.1 && output(&r, "N_continuum_rms") > 0.02);
    CU_ASSERT(output(&r, "H_slope_ratio") > 0.95 && output(&r, "H_slope_ratio") < 0.99);
    CHECK_OK(RUN(0, &r, "base=20")); /* no continuum at 60 degrees */
    CU_ASSERT(isnan(output(&r, "N_continuum_rms")) && output(&r, "n_disks") == 210);
}

/* A pile of the protocol, solved directly. */
typedef struct {
    const char *settings[8];
    double height, gap, eps, k_x, well, mu; /* of the top over half the base; the last two 0: springs */
    size_t n_corners;                       /* of a tent; 0 */
    an_point corners[5];
    double alpha, disorder;
    int branch;
} pile_case;

static void solve(const pile_case *c, sweep_outline *h, statics_pile **pile, statics_result *r)
{
    CHECK_OK(sweep_outline_make(h, 22, c->gap, c->alpha, c->n_corners, c->corners));
    if (c->disorder > 0) CHECK_OK(sweep_outline_disorder(h, c->disorder, 1992, 3));
    statics_definition def = statics_definition_default();
    def.n = h->n, def.disks = h->disks, def.eps = c->eps;
    def.k_x = c->k_x;
    def.well = c->well > 0 ? STATICS_WELL_FRICTION : STATICS_WELL_SPRING;
    def.a = c->well, def.mu = c->mu, def.branch = c->branch;
    CHECK_OK(statics_create(&def, pile));
    CHECK_OK(statics_solve(*pile, r));
}

/* Of contacts that no other of one of their disks is stronger (sign -1: weaker) than: how many are level. */
static double level_part(size_t n, const statics_contact list[], double sign)
{
    size_t all = 0, level = 0;
    for (size_t i = 0; i < n; i++) {
        bool most_of_a = true, most_of_b = true;
        for (size_t j = 0; j < n; j++) {
            const bool more = sign * list[j].force > sign * list[i].force + BALANCE;
            if (more && (list[j].a == list[i].a || list[j].b == list[i].a)) most_of_a = false;
            if (more && (list[j].a == list[i].b || list[j].b == list[i].b)) most_of_b = false;
        }
        all += most_of_a || most_of_b;
        level += (most_of_a || most_of_b) && list[i].horizontal;
    }
    return (double)level / (double)all;
}

static void check_base(const pile_case *c, const sweep_outline *h, const double x[], const double N[],
                       const double H[], const sweep_result *r)
{
    enum { K = 22 };
    double e[K], exact[K], flank[K], r_disk[K], u[K], ours[K], theirs[K], push[2] = {0}, exact_push[2] = {0};
    size_t n = 0;
    for (size_t i = 0; i < K; i++) {
        exact[i] = h->exact[i].N;
        e[i] = fabs(N[i] / exact[i] - 1);
        flank[i] = fabs(H[i]);
        r_disk[i] = 0.5;
        push[i >= K / 2] += H[i];
        exact_push[i >= K / 2] += h->exact[i].H;
        if (fabs(x[i] - (x[0] + x[K - 1]) / 2) >= h->B / 10) continue;
        u[n] = x[i] - (x[0] + x[K - 1]) / 2;
        ours[n] = H[i];
        theirs[n++] = h->exact[i].H;
    }
    CHECK_EACH(output(r, NAME), BALANCE, {"N_error_max", gsl_stats_max(e, 1, K)},
               {"N_error_rms", sqrt(gsl_stats_tss_m(e, 1, K, 0) / K)},
               {"thrust_ratio", (push[1] - push[0]) / (exact_push[1] - exact_push[0])},
               {"D", dip_of(K, x, N, 1)}, {"D_diagonals", dip_of(K, x, exact, 1)});
    double largest = gsl_stats_max(flank, 1, K), slope[2], unused;
    for (size_t i = 0; i < K; i++) flank[i] = fabs(h->exact[i].H);
    CHECK_NEAR(output(r, "H_ratio"), largest / gsl_stats_max(flank, 1, K), BALANCE);
    gsl_fit_mul(u, 1, ours, 1, n, &slope[0], &unused, &unused);
    gsl_fit_mul(u, 1, theirs, 1, n, &slope[1], &unused, &unused);
    CU_ASSERT(n >= 4 && n < K);
    CHECK_EACH(output(r, NAME), BALANCE, {"H_slope_ratio", slope[0] / slope[1]},
               {"left_deg", atan(2 * c->height) / DEG}, {"right_deg", atan(2 * c->height) / DEG});
    stress_base base, diagonals;
    double rays[STRESS_DIP_BINS];
    CHECK_OK(stress_base_profile(K, x, r_disk, N, &base));
    CHECK_OK(stress_base_profile(K, x, r_disk, exact, &diagonals));
    stress_base_bins(&base, K, x, r_disk, exact, rays);
    for (int k = 0; k < STRESS_DIP_BINS; k++)
        CHECK_NEAR(output(r, check_text("n_%02d", k + 1)), base.N[k], BALANCE);
    CHECK_EACH(output(r, NAME), BALANCE, {"middle", middle_of(base.N)},
               {"middle_diagonals", middle_of(diagonals.N)}, {"excess", inner(base.N) - inner(rays)});
}

static void check_continuum(const pile_case *c, const sweep_outline *h, const double x[], const double N[],
                            const double H[], const sweep_result *r)
{
    const an_point triangle[3] = {{0, 0}, {0.5, c->height}, {1, 0}};
    double n_off[22], h_off[22], n_own[22], h_own[22];
    an_profile profile;
    if (an_profile_set(&profile, c->n_corners ? c->corners : triangle, c->n_corners ? c->n_corners : 3)) {
        CU_ASSERT(isnan(output(r, "N_continuum_rms")) && isnan(output(r, "H_continuum_rms")));
        return;
    }
    for (size_t i = 0; i < 22; i++) {
        an_force f;
        CHECK_OK(an_profile_force(&profile, (x[i] - x[0] - (x[21] - x[0] - h->B) / 2) / h->B, &f));
        n_own[i] = f.N;
        h_own[i] = fabs(f.H);
        n_off[i] = N[i] / h->B - f.N;
        h_off[i] = H[i] / h->B - f.H;
    }
    CHECK_NEAR(output(r, "N_continuum_rms"),
               sqrt(gsl_stats_tss_m(n_off, 1, 22, 0) / 22) / gsl_stats_max(n_own, 1, 22), BALANCE);
    CHECK_NEAR(output(r, "H_continuum_rms"),
               sqrt(gsl_stats_tss_m(h_off, 1, 22, 0) / 22) / gsl_stats_max(h_own, 1, 22), BALANCE);
}

/* All outputs computed independently: springs and wells, equal and unequal disks, triangles and a tent. */
static void outputs_a_second_way(void)
{
    const double TOP = 0.38 * tan(30 * DEG) + 0.12 * tan(45 * DEG);
    const double shoulder = 0.38 * tan(30 * DEG);
    pile_case cases[] = {{{"alpha_deg=30", "eps=1e-3", "k_x=3", "disorder=1e-3"}, 0.5 * tan(30 * DEG)},
                         {{"alpha_deg=30", "inner_deg=45", "x_1=0.38", "well=40", "mu=1.5"}, TOP},
                         {{"alpha_deg=60", "gap=0.01", "branch=minimum", "eps=1e-4"}, 0.5 * tan(60 * DEG)}};
    for (int k = 0; k < 3; k++) cases[k].eps = 1e-4, cases[k].k_x = 1, cases[k].mu = 1;
    cases[0].eps = 1e-3, cases[0].k_x = 3, cases[0].alpha = 30 * DEG, cases[0].disorder = 1e-3;
    cases[1].well = 40, cases[1].mu = 1.5, cases[1].n_corners = 5;
    const an_point corners[5] = {{0, 0}, {0.38, shoulder}, {0.5, TOP}, {0.62, shoulder}, {1, 0}};
    memcpy(cases[1].corners, corners, sizeof corners);
    cases[2].gap = 0.01, cases[2].branch = STATICS_BRANCH_MINIMUM;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const pile_case *c = &cases[i];
        sweep_result r;
        RP_ENDS(sweep_outline_free) sweep_outline h = {0};
        statics_pile *pile = NULL;
        statics_result solved;
        size_t disk[22], n;
        double x[22], N[22], H[22];
        scoped statics_contact *list = NULL;
        const char *settings[10] = {"base=22"};
        memcpy(settings + 1, c->settings, sizeof c->settings);
        CHECK_OK(run_pile(settings, 3, &r));
        CU_ASSERT_STRING_EQUAL(r.status, "ok");
        solve(c, &h, &pile, &solved);
        statics_base(pile, disk, N, H);
        for (size_t k = 0; k < 22; k++) x[k] = h.disks[disk[k]].x;
        check_base(c, &h, x, N, H, &r);
        check_continuum(c, &h, x, N, H, &r);
        CHECK_OK(statics_contacts(pile, &list, &n));
        CHECK_EACH(output(&r, NAME), 1e-15, {"strongest_level", level_part(n, list, 1)},
                   {"weakest_level", level_part(n, list, -1)});
        CU_ASSERT(output(&r, "n_disks") == (double)h.n && output(&r, "contacts") == (double)n);
        CU_ASSERT(output(&r, "horizontal") == (double)solved.horizontal);
        CU_ASSERT(output(&r, "negative_modes") == (double)solved.negative_modes);
        CU_ASSERT(output(&r, "broken") == 0 && output(&r, "jumps") == (double)solved.jumps);
        CU_ASSERT(output(&r, "smallest_pivot") == solved.smallest_pivot && output(&r, "load") == 1);
        statics_free(pile);
    }
}

static void replicas(void)
{
    sweep_result a, b, c;
    CHECK_OK(RUN(5, &a, "base=20", "alpha_deg=30", "disorder=1e-3"));
    CHECK_OK(RUN(5, &b, "base=20", "alpha_deg=30", "disorder=1e-3"));
    CHECK_OK(RUN(6, &c, "base=20", "alpha_deg=30", "disorder=1e-3"));
    CU_ASSERT(output(&a, "D") == output(&b, "D") && output(&a, "D") != output(&c, "D"));
    CHECK_OK(RUN(5, &a, "base=20", "alpha_deg=30"));
    CHECK_OK(RUN(6, &b, "base=20", "alpha_deg=30"));
    CU_ASSERT(output(&a, "D") == output(&b, "D"));
}

static void without_result(void)
{
    sweep_result r;
    CHECK_OK(RUN(0, &r, "alpha_deg=30", "well=1", "mu=0.1"));
    CU_ASSERT_STRING_EQUAL(r.status, "spreads");
    CU_ASSERT(strstr(r.message, "wells broken") && output(&r, "broken") > 0 && isnan(output(&r, "D")));
    CU_ASSERT(isnan(output(&r, "negative_modes")) && output(&r, "load") < 1);
    CHECK_FAILS(RUN(0, &r, "eps=0", "disorder=1e-3"), RP_BAD_INPUT, "overlap");
    CHECK_FAILS(RUN(0, &r, "alpha_deg=60", "inner_deg=30"), RP_BAD_INPUT, "alpha_1");
    CHECK_FAILS(RUN(0, &r, "alpha_deg=59.9", "gap=0.1"), RP_BAD_INPUT, "alpha");
    CHECK_FAILS(RUN(0, &r, "alpha_deg=59.9", "gap=0.1", "disorder=1e-3"), RP_BAD_INPUT, "alpha");
}

/* What `repose pile` does with --threshold, --leave and --well, as runs of a sweep. */
static void solver_choices(void)
{
    sweep_result r, other;
    CHECK_OK(RUN(0, &r, "base=12", "threshold=true"));
    const double eps_c = output(&r, "eps_c");
    CU_ASSERT_STRING_EQUAL(r.status, "ok");
    for (int above = 0; above < 2; above++) {
        CHECK_OK(RUN(0, &other, "base=12", check_text("eps=%.17g", eps_c * (above ? 1.001 : 0.999))));
        CU_ASSERT((output(&other, "negative_modes") > 0) == (above == 1));
    }
    CHECK_OK(RUN(0, &r, "base=24", "eps=1e-3", "branch=minimum", "leave=2"));
    CHECK_OK(RUN(0, &other, "base=24", "eps=1e-3", "branch=minimum", "leave=3"));
    CU_ASSERT(output(&r, "released") > 0 && output(&r, "released") != output(&other, "released"));
    /* a search without a result stays a row */
    CHECK_OK(RUN(0, &r, "alpha_deg=30", "well=1", "mu=0.2"));
    CU_ASSERT_STRING_EQUAL(r.status, "spreads");
    CU_ASSERT(isnan(output(&r, "D")) && output(&r, "broken") == 24 &&
              strstr(r.message, "24 of 45 wells") != NULL);
    CHECK_OK(RUN(0, &r, "base=2", "threshold=true"));
    CU_ASSERT_STRING_EQUAL(r.status, "no_threshold");
    CHECK_FAILS(RUN(0, &r, "leave=2"), RP_BAD_INPUT, "leave = 2: needs branch");
    CHECK_FAILS(RUN(0, &r, "set_again=true"), RP_BAD_INPUT, "set_again = true: needs wells");
    CHECK_FAILS(RUN(0, &r, "threshold=true", "branch=minimum"), RP_BAD_INPUT, "threshold = true: starts");
}

/* Tables of a traced run: the forces that its outputs are of. */
static void traced(void)
{
    sweep_pile p;
    sweep_result r;
    rp_params_defaults(sweep_pile_schema, RP_CGS, &p);
    p.base = 12;
    protocol_trace(&sweep_protocol_pile, &p, 0, &r);
    scoped_table t = read_table("t/base.tsv");
    double weight = 0, most = 0;
    for (size_t i = 0; i < t.n_rows; i++) {
        weight += cell(&t, i, "N/mg");
        most = fmax(most, fabs(cell(&t, i, "H/mg")) / cell(&t, i, "N/mg"));
    }
    CU_ASSERT(t.n_rows == 12);
    CHECK_NEAR(weight, 78, BALANCE * 78);
    CHECK_NEAR(output(&r, "H_N_max"), most, BALANCE);
}

CHECK_SUITE_WITHIN(piles, "piles", enter, leave, steps_of_a_slope, dip_closed_forms, dip_invariances,
                   dips_of_a_wedge, rays_under_outlines, rays_under_walls, outlines_of_any_size,
                   friction_of_base, sizes, unequal_piles_stand, open_rows, against_continuum,
                   outputs_a_second_way, replicas, without_result, solver_choices, traced)
