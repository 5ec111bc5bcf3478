/* Static equilibrium of piles: closed forms, the exact solution of diagonal contacts, forces and stability by
 * direct methods, the simulator at rest, results for soft piles, every status. */
#include <float.h>
#include <gsl/gsl_eigen.h>

#include "analytic/analytic.h"
#include "statics/bonds.h"
#include "sweeps/protocols/pile.h"
#include "tests/grains.h"
#include "tests/numbers.h"
#include "tests/program.h"

static const double DEG = M_PI / 180;

/* Displacements up to 1e3 (eps sigma) are rounded by 1e-13; six contacts each, and the same in the test. */
#define ROUNDING 1e-11

/* ---- making piles ---- */

typedef struct {
    size_t n, k;
    statics_disk *disks;
    an_force *exact; /* forces of diagonal contacts alone */
    statics_pile *pile;
    statics_result result;
    double *u, *N, *H;
} test_pile;

/* Disks of a pile with k in its base, slope alpha, and gaps in its rows. */
static test_pile make_disks(long k, double alpha_deg, double gap)
{
    test_pile h = {.k = (size_t)k};
    const double theta = asin((1 + gap) / 2);
    scoped long *up = malloc((size_t)k * sizeof *up);
    CHECK_OK(an_lattice_cut(k, theta, fmin(alpha_deg * DEG, M_PI / 2 - theta), up));
    for (long s = 0; s < k; s++) h.n += (size_t)up[s];
    h.disks = malloc(h.n * sizeof *h.disks), h.exact = malloc(h.k * sizeof *h.exact);
    size_t n = 0;
    for (long s = 0; s < k; s++)
        for (long j = 0; j < up[s]; j++)
            h.disks[n++] = (statics_disk){((double)s + 0.5 * (double)j) * 2 * sin(theta),
                                          0.5 + (double)j * cos(theta), 0.5, 1};
    CHECK_OK(an_lattice_counts(k, up, theta, h.exact));
    h.u = malloc(2 * h.n * sizeof *h.u), h.N = malloc(h.k * sizeof *h.N);
    h.H = malloc(h.k * sizeof *h.H);
    return h;
}

static void free_pile(test_pile *h)
{
    statics_free(h->pile), free(h->disks), free(h->exact), free(h->u), free(h->N), free(h->H);
}

/* Another pile in place of one. */
static void remake(test_pile *h, long k, double alpha_deg)
{
    free_pile(h);
    *h = make_disks(k, alpha_deg, 0);
}

/* A pile that is freed at the end of its scope. */
#define scoped_pile __attribute__((cleanup(free_pile))) test_pile

static rp_status solve(test_pile *h, statics_definition def)
{
    def.n = h->n, def.disks = h->disks;
    statics_free(h->pile);
    h->pile = NULL;
    rp_status status = statics_create(&def, &h->pile);
    if (status) return status;
    status = statics_solve(h->pile, &h->result);
    CU_ASSERT(h->result.wells == h->k);
    statics_displacements(h->pile, h->u);
    statics_base(h->pile, NULL, h->N, h->H);
    return status;
}

static test_pile solved(long k, double alpha_deg, statics_definition def)
{
    test_pile h = make_disks(k, alpha_deg, 0);
    CHECK_OK(solve(&h, def));
    return h;
}

static statics_definition soft(double eps)
{
    statics_definition def = statics_definition_default();
    def.eps = eps;
    return def;
}

static statics_definition friction(double eps, double mu, double a)
{
    statics_definition def = soft(eps);
    def.well = STATICS_WELL_FRICTION, def.mu = mu, def.a = a;
    return def;
}

/* Status of a pile of these disks, and what is known of it. */
static rp_status try_disks(statics_definition def, size_t n, const statics_disk disks[], statics_result *r)
{
    statics_pile *pile = NULL;
    def.disks = disks, def.n = n;
    RP_TRY(statics_create(&def, &pile));
    const rp_status status = statics_solve(pile, r);
    statics_free(pile);
    return status;
}

static double N_error(const test_pile *h, double *most)
{
    double sum = 0;
    *most = 0;
    for (size_t i = 0; i < h->k; i++) {
        const double e = h->N[i] / h->exact[i].N - 1;
        sum += e * e;
        *most = fmax(*most, fabs(e));
    }
    return sqrt(sum / (double)h->k);
}

static double H_ratio(const test_pile *h)
{
    double most = 0, exact = 0;
    for (size_t i = 0; i < h->k; i++) {
        most = fmax(most, fabs(h->H[i]));
        exact = fmax(exact, fabs(h->exact[i].H));
    }
    return most / exact;
}

/* ---- a pile of three, by hand ---- */

/* The top rests on two disks: contact forces 1/(2 cos 30), N = 3/2, H = 1/(2 sqrt 3) outwards. */
static const double THREE_H = 0.28867513459481287;

static void test_three_disks(void)
{
    statics_definition def = soft(0);
    def.k_x = 0.385;
    scoped_pile h = solved(2, 60, def);
    for (size_t i = 0; i < 2; i++) {
        CHECK_PAIRS(ROUNDING, {h.N[i], 1.5}, {h.H[i], (i ? 1 : -1) * THREE_H});
    }
    /* disks 0 (left), 1 (top), 2 (right): the contact force 1/sqrt 3 is the overlap along the diagonal */
    CHECK_PAIRS(ROUNDING, {h.u[0], -THREE_H / 0.385}, {h.u[1], -1.5});
    const double along = (h.u[2] - h.u[0]) * 0.5 + (h.u[3] - h.u[1]) * cos(M_PI / 6);
    CHECK_NEAR(along, -1 / sqrt(3), ROUNDING);
    scoped statics_contact *contacts = NULL;
    size_t n = 0;
    CHECK_OK(statics_contacts(h.pile, &contacts, &n));
    CU_ASSERT(n == 2 && h.result.contacts == 2 && h.result.horizontal == 0);
    /* one factorisation valid to the end, one step, no other branch */
    CU_ASSERT(h.result.factored == 1 && h.result.steps == 1 && h.result.jumps == 0 && h.result.load == 1);
    for (size_t c = 0; c < n; c++) {
        CHECK_NEAR(contacts[c].force, 1 / sqrt(3), ROUNDING);
        CU_ASSERT(contacts[c].strongest && contacts[c].weakest && !contacts[c].horizontal);
    }
    /* solved again from the start, not from the present state */
    CHECK_OK(statics_solve(h.pile, &h.result));
    CU_ASSERT(h.result.steps == 1);
    /* wells set at the displacements of half the load; the full force acts from there */
    def.set_load = 0.5;
    CHECK_OK(solve(&h, def));
    CHECK_PAIRS(ROUNDING, {h.H[1], THREE_H}, {h.u[2 * 2], 1.5 * THREE_H / 0.385});
}

/* Disks apart on wells of stiffness mu N/a = N/4: the softest belongs to the lightest. */
static void test_softest_disk(void)
{
    for (size_t light = 0; light < 4; light++) {
        statics_disk disks[4];
        for (size_t i = 0; i < 4; i++)
            disks[i] = (statics_disk){3 * (double)i, 0.5, 0.5, i == light ? 0.7 : 1.1 + 0.1 * (double)i};
        statics_result r;
        CHECK_OK(try_disks(friction(1e-4, 0.5, 2), 4, disks, &r));
        CHECK_NEAR(r.smallest_pivot, 0.7 / 4, ROUNDING);
        CU_ASSERT(r.pivot_disk == light && r.contacts == 0 && r.negative_modes == 0);
    }
}

static void test_friction_wells(void)
{
    /* stiffness mu N/a: held at x = H a/(mu N) while H < mu N, 0.1925 of N here */
    scoped_pile h = solved(2, 60, friction(0, 0.25, 3.7));
    CHECK_NEAR(h.u[4], THREE_H * 3.7 / (0.25 * 1.5), 1e-9);
    CU_ASSERT(h.result.broken == 0);
    /* the same displacement again from that of half the load, although the sum exceeds a */
    statics_definition anew = friction(0, 0.25, 3.7);
    anew.set_load = 0.5;
    CHECK_OK(solve(&h, anew));
    CHECK_NEAR(h.u[4], 2 * THREE_H * 3.7 / (0.25 * 1.5), 1e-9);
    CU_ASSERT(h.result.broken == 0);
    CHECK_FAILS(solve(&h, friction(0, 0.19, 3.7)), RP_NO_RESULT, "spreads: 2 of 2 wells broken");
    for (int again = 0; again < 2; again++) { /* broken wells are intact in a new solution */
        CHECK_FAILS(statics_solve(h.pile, &h.result), RP_NO_RESULT,
                    "spreads: 2 of 2 wells broken, first that of disk 1");
        CU_ASSERT(h.result.fault == STATICS_SPREADS && h.result.broken == 2 && h.result.first_broken == 0);
    }
    CHECK_FAILS(solve(&h, friction(1e-4, 0.19, 3.7)), RP_NO_RESULT, "spreads");
    statics_definition again = friction(1e-4, 0.19, 3.7); /* creeps without end */
    again.set_again = true;
    CHECK_FAILS(solve(&h, again), RP_NO_RESULT,
                "creeps: 2 of 2 wells set anew, first that of disk 1: disks 1, 3; ");
    CU_ASSERT(h.result.fault == STATICS_CREEPS);
}

/* The base holds as long as no well breaks: a slope is stable if unbreakable wells of the same stiffness mu
 * N/a carry at most mu N. x_0 under load changes nothing, since the pile must be stable before. At 60
 * degrees, where forces can't be redistributed, resetting wells changes nothing either. */
static void test_smooth_base(void)
{
    static const struct {
        double alpha, falls, stands, again; /* again: stable if wells are set again */
    } cases[] = {{30, 0.25, 0.26, 0.2}, {32.6, 0.27, 0.28, 0}, {45, 0.46, 0.47, 0.35},
                 {50, 0.49, 0.5, 0},    {55, 0.53, 0.54, 0},   {60, 0.55, 0.56, 0}};
    const double NEVER = 100; /* times mu and a */
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        scoped_pile slope = make_disks(45, cases[c].alpha, 0);
        for (int stands = 0; stands < 2; stands++) {
            const double mu = stands ? cases[c].stands : cases[c].falls;
            CHECK_OK(solve(&slope, friction(1e-4, NEVER * mu, NEVER)));
            CU_ASSERT((sweep_outline_friction(45, slope.N, slope.H) < mu) == stands);
            for (int loaded = 0; loaded < 2; loaded++) {
                statics_definition def = friction(1e-4, mu, 1);
                def.set_load = loaded;
                CU_ASSERT(solve(&slope, def) == (stands ? RP_OK : RP_NO_RESULT));
                CU_ASSERT((slope.result.fault == STATICS_SPREADS) == !stands);
                CU_ASSERT((slope.result.broken == 0) == stands);
            }
        }
        statics_definition again = friction(1e-4, cases[c].again > 0 ? cases[c].again : cases[c].falls, 1);
        again.set_again = true;
        if (cases[c].again > 0) {
            CHECK_OK(solve(&slope, again));
            CU_ASSERT(slope.result.broken > 0 && sweep_outline_friction(45, slope.N, slope.H) < again.mu);
        } else if (cases[c].alpha > 59)
            CHECK_FAILS(solve(&slope, again), RP_NO_RESULT, "creeps");
    }
}

/* Wells: H = mu N (x - x_0)/a for intact wells, 0 for broken ones, whose disks left them. */
static void check_wells(const test_pile *h, double mu, double a, bool at_rest)
{
    statics_well wells[64];
    size_t broken = 0;
    CU_ASSERT_FATAL(h->k <= 64);
    statics_wells(h->pile, wells);
    for (size_t i = 0; i < h->k; i++) {
        const statics_well *w = &wells[i];
        CU_ASSERT(w->N == h->N[i] && w->H == h->H[i] && w->x == h->u[2 * w->disk]);
        if (w->state == STATICS_WELL_HOLDS) {
            CU_ASSERT(w->x_0 == 0);
            if (!at_rest) continue;
            CHECK_NEAR(w->H, mu * w->N * w->x / a, 1e-9);
            CU_ASSERT(fabs(w->x) <= a);
        } else {
            CU_ASSERT(w->state == STATICS_WELL_BROKEN && w->H == 0 && fabs(w->x_0) > a);
            broken++;
        }
    }
    CU_ASSERT(broken == h->result.broken);
}

static void test_state_of_wells(void)
{
    scoped_pile h = solved(45, 30, friction(1e-4, 0.3, 1));
    CU_ASSERT(h.result.eps == 1e-4);
    check_wells(&h, 0.3, 1, true);
    CHECK_FAILS(solve(&h, friction(1e-4, 0.2, 1)), RP_NO_RESULT, " and 16 more; neighbours ");
    CU_ASSERT(h.result.fault == STATICS_SPREADS && h.result.broken == 24);
    CU_ASSERT(h.result.negative_modes == STATICS_UNCOUNTED && isnan(h.result.smallest_pivot));
    check_wells(&h, 0.2, 1, false);
    /* the same while the positions of the wells are determined under part of the load */
    statics_definition part = friction(1e-4, 0.1, 1);
    part.set_load = 0.5;
    CHECK_FAILS(solve(&h, part), RP_NO_RESULT, "spreads");
    CU_ASSERT(h.result.load < 0.5 && h.result.eps < 0.6e-4);
    check_wells(&h, 0.1, 2, false);
}

/* ---- reasons for the absence of an equilibrium ---- */

/* A slope of 16 disks in its base, and a distant column of two disks. */
static test_pile slope_and_column(void)
{
    test_pile h = make_disks(16, 30, 0);
    h.disks = realloc(h.disks, (h.n + 2) * sizeof *h.disks);
    h.u = realloc(h.u, 2 * (h.n + 2) * sizeof *h.u);
    h.N = realloc(h.N, (h.k + 1) * sizeof *h.N);
    h.H = realloc(h.H, (h.k + 1) * sizeof *h.H);
    CU_ASSERT_FATAL(h.disks && h.u && h.N && h.H);
    for (int i = 0; i < 2; i++) h.disks[h.n++] = (statics_disk){100, 0.5 + i, 0.5, 1};
    h.k++;
    return h;
}

static void test_causes(void)
{
    scoped_pile h = slope_and_column();
    /* in the limit no force stabilises the column's upper disk, with or without broken wells in the slope */
    for (int again = 0; again < 2; again++) {
        statics_definition def = friction(0, again ? 0.18 : 1, 1);
        def.set_again = again;
        CHECK_FAILS(solve(&h, def), RP_NO_RESULT, "followed up to 1 of the load, after");
        CU_ASSERT(strstr(rp_message(), "no pivot for disk ") != NULL);
        CU_ASSERT(h.result.fault == STATICS_SINGULAR && (h.result.broken > 0) == again);
        CU_ASSERT(h.result.pivot_disk == h.n - 1 && h.result.smallest_pivot < 1e-11);
        CU_ASSERT(h.result.negative_modes == STATICS_UNCOUNTED && h.result.residual < 1e-9);
    }
    /* springs never break: the pile is too soft for its weight */
    remake(&h, 45, 60);
    CHECK_FAILS(solve(&h, soft(0.1)), RP_NO_RESULT, "collapses: neighbours ");
    CU_ASSERT(h.result.fault == STATICS_COLLAPSES && h.result.eps < 0.1 && h.result.broken == 0);
    statics_definition part = soft(4e-3);
    part.set_load = 0.8;
    CHECK_FAILS(solve(&h, part), RP_NO_RESULT, "collapses");
    CU_ASSERT(h.result.load > 0 && h.result.load * 4e-3 < h.result.eps);
    /* the full load shows the spreading; an eighth of the load, with the ground nearer, would not */
    remake(&h, 12, 30);
    CHECK_FAILS(solve(&h, friction(0.01, 0.1, 30)), RP_NO_RESULT, "spreads: 12 of 12 wells broken");
    /* a pile that spread into a layer has free disks and new contacts; spreading is reported first */
    remake(&h, 5, 60);
    CHECK_FAILS(solve(&h, friction(0.01, 0.1, 100)), RP_NO_RESULT,
                "against one another; no neighbours, but disk 3 on 6, ");
    CU_ASSERT(h.result.fault == STATICS_SPREADS && h.result.broken == 4);
    /* disks that overlap anew are told where all that is known is balanced, and not on the way there */
    remake(&h, 12, 45);
    statics_definition creeping = friction(0.1, 0.2, 10);
    creeping.set_again = true;
    CHECK_FAILS(solve(&h, creeping), RP_NO_RESULT, "not_converged: the wells' stiffness does not settle");
    CU_ASSERT(h.result.fault == STATICS_NOT_CONVERGED);
}

/* ---- against diagonal contacts alone ---- */

/* Contacts, and those of them between disks less than 15 degrees from level, counted from the overlaps of all
 * pairs: of touching disks the displacements alone, along the line of centres. */
static void count_closed(const test_pile *h)
{
    size_t closed = 0, level = 0;
    for (size_t i = 0; i < h->n; i++)
        for (size_t j = 0; j < i; j++) {
            const double x = h->disks[i].x - h->disks[j].x, y = h->disks[i].y - h->disks[j].y,
                         d = hypot(x, y);
            if (d > 1 + 1e-9) continue;
            const bool pressed =
                x * (h->u[2 * i] - h->u[2 * j]) + y * (h->u[2 * i + 1] - h->u[2 * j + 1]) < -ROUNDING;
            closed += pressed;
            level += pressed && fabs(y) < sin(15 * DEG) * d;
        }
    CU_ASSERT(level > 0 && level < closed);
    CU_ASSERT_EQUAL(h->result.contacts, closed);
    CU_ASSERT_EQUAL(h->result.horizontal, level);
}

static void test_linearised(void)
{
    double most;
    scoped_pile h = solved(45, 60, soft(0));
    CU_ASSERT(h.n == 1035);
    CU_ASSERT(N_error(&h, &most) < ROUNDING && most < ROUNDING);
    for (size_t i = 0; i < h.k; i++) CHECK_NEAR(h.H[i], h.exact[i].H, 22.5 * ROUNDING);
    CU_ASSERT(h.result.contacts == 1980 && h.result.horizontal == 0 && h.result.negative_modes == 0);
    CU_ASSERT(h.result.steps == 1 && h.result.factored == 1);
    /* the pile of half the size predicts nearly all closed horizontal contacts; without this prediction the
     * solution takes 39 factorisations */
    remake(&h, 90, 30);
    CHECK_OK(solve(&h, soft(0)));
    CU_ASSERT(h.result.horizontal > 0 && h.result.steps < 12 && h.result.factored < 5);
    count_closed(&h);
    /* gaps in the rows keep horizontal contacts open under any slope */
    scoped_pile gaps = make_disks(31, 27, 0.02);
    CHECK_OK(solve(&gaps, soft(0)));
    CU_ASSERT(N_error(&gaps, &most) < ROUNDING && gaps.result.horizontal == 0);
    for (size_t i = 0; i < gaps.k; i++) CHECK_NEAR(gaps.H[i], gaps.exact[i].H, 22.5 * ROUNDING);
}

/* A soft well lets the rows separate: as it widens H approaches that of diagonal contacts alone, N nearly. */
static void test_soft_wells(void)
{
    static const double a[] = {1, 10, 100, 1000}, found[] = {0.81, 0.83, 0.92, 1.00};
    scoped_pile h = make_disks(45, 30, 0);
    CU_ASSERT(h.n == 360);
    for (int i = 0; i < 4; i++) {
        CHECK_OK(solve(&h, friction(1e-4, 1, a[i])));
        CHECK_NEAR(H_ratio(&h), found[i], 0.007);
    }
    double most;
    CHECK_OK(solve(&h, friction(1e-8, 1, 1e5)));
    CHECK_NEAR(H_ratio(&h), 1, 1e-3);
    CU_ASSERT(N_error(&h, &most) < 0.04);
}

/* ---- the equilateral pile at eps = 1e-4 ---- */

static void test_primary(void)
{
    double most, last = 0;
    scoped_pile h = solved(45, 60, soft(1e-4));
    CHECK_NEAR(N_error(&h, &most), 2.3e-3, 0.05e-3);
    CHECK_NEAR(most, 4.8e-3, 0.05e-3);
    CU_ASSERT(h.result.negative_modes == 18 && h.result.horizontal == 0 && h.result.jumps == 0);
    scoped double *direct = malloc(2 * h.n * sizeof *direct);
    memcpy(direct, h.u, 2 * h.n * sizeof *direct);
    statics_definition ramp = soft(1e-4); /* the same branch in small steps */
    ramp.load_steps = 10;
    CHECK_OK(solve(&h, ramp));
    for (size_t i = 0; i < 2 * h.n; i++)
        CHECK_NEAR(h.u[i], direct[i], 1e-6);         /* residuals of 1e-11 over the softest modes, 1e-5 */
    for (double eps = 1e-5; eps > 1e-8; eps /= 10) { /* the error falls with eps */
        CHECK_OK(solve(&h, soft(eps)));
        const double error = N_error(&h, &most);
        if (last > 0) CHECK_NEAR(last / error, 10, 0.02);
        last = error;
    }
}

/* (47), (48), disk by disk: of the two forces from above, the one from the side of the axis is the stronger,
 * and on the axis both are equal. All disks but those of the two slopes have both. */
static void test_stronger_diagonals(void)
{
    enum { LAYERS = 45, DISKS = LAYERS * (LAYERS + 1) / 2 };
    static double left[DISKS], right[DISKS], x[DISKS];
    scoped_pile h = make_disks(LAYERS, 60, 0);
    scoped statics_contact *contacts = NULL;
    size_t n, both = 0, right_ones = 0;
    CU_ASSERT_FATAL(h.n == DISKS);
    CHECK_OK(solve(&h, soft(1e-4)));
    CHECK_OK(statics_contacts(h.pile, &contacts, &n));
    memset(left, 0, sizeof left);
    memset(right, 0, sizeof right);
    for (size_t k = 0; k < n; k++) {
        const statics_contact *c = &contacts[k];
        const bool a_lower = c->y < c->y_b, from_left = a_lower ? c->x_b < c->x : c->x < c->x_b;
        const size_t lower = a_lower ? c->a : c->b;
        (from_left ? left : right)[lower] = c->force;
        x[lower] = a_lower ? c->x : c->x_b;
    }
    double axis = 0.0;
    for (size_t i = 0; i < DISKS; i++)
        if (left[i] > 0.0 && right[i] > 0.0) both++, axis += x[i];
    axis /= (double)both;
    for (size_t i = 0; i < DISKS; i++) {
        if (!(left[i] > 0.0 && right[i] > 0.0)) continue;
        /* neighbours of the axis are 0.5 sigma from it, and differ by a disk's weight */
        if (fabs(x[i] - axis) < 0.25)
            right_ones += fabs(left[i] - right[i]) < 1e-6;
        else
            right_ones += (left[i] > right[i]) == (x[i] > axis);
    }
    CU_ASSERT(both == (LAYERS - 1) * (LAYERS - 2) / 2 && right_ones == both);
}

/* A branch that ends under load: the pile jumps to another branch once, at full load. */
static void test_jump(void)
{
    statics_definition def = soft(3e-3);
    scoped_pile h = solved(20, 55, def);
    CU_ASSERT(h.result.jumps == 1 && h.result.load == 1);
    def.branch = STATICS_BRANCH_MINIMUM; /* not followed, so without an end */
    CHECK_OK(solve(&h, def));
    CU_ASSERT(h.result.jumps == 0 && h.result.load == 1 && h.result.negative_modes == 0);
    def.leave = 1; /* no primary state to leave */
    CHECK_OK(solve(&h, def));
    CU_ASSERT(h.result.jumps == 1 && h.result.negative_modes == 0 && isnan(h.result.released));
    remake(&h, 45, 50); /* the descent is symmetric, and leads to a saddle */
    CHECK_OK(solve(&h, soft(1e-3)));
    CU_ASSERT(h.result.jumps == 1 && h.result.negative_modes == 0);
}

/* The branch of the large pile of 30 degrees ends before eps = 1e-4. Any steps of loading lead to the same
 * state, with few factorisations. */
static void test_large_soft(void)
{
    statics_definition def = soft(1e-4);
    scoped_pile h = solved(180, 30, def);
    CU_ASSERT(h.n == 5490 && h.result.jumps == 1 && h.result.negative_modes == 0);
    CU_ASSERT(h.result.factored <
              12); /* 12 if an indefinite matrix is tried twice, or modes are counted anew */
    const double H = H_ratio(&h);
    const size_t horizontal = h.result.horizontal;
    def.branch = STATICS_BRANCH_MINIMUM;
    CHECK_OK(solve(&h, def));
    CU_ASSERT(h.result.factored < 9 && h.result.horizontal == horizontal);
    CHECK_NEAR(H_ratio(&h), H, 1e-9);
}

/* Above eps_c the equilateral pile buckles in different modes: each mode leads downhill to a stable state
 * with the same weight on the base. */
static void test_minima(void)
{
    double released[3], N_most[3];
    const unsigned long ways[] = {2, 5, 13};
    statics_definition def = soft(1e-4);
    scoped_pile h = solved(45, 60, def);
    CU_ASSERT(isnan(h.result.released));
    const double primary = h.result.energy;
    def.branch = STATICS_BRANCH_MINIMUM;
    for (int i = 0; i < 3; i++) {
        def.leave = ways[i];
        CHECK_OK(solve(&h, def));
        CU_ASSERT(h.result.negative_modes == 0 && h.result.smallest_pivot > 0 && h.result.jumps == 0);
        released[i] = h.result.released;
        CHECK_NEAR(primary - h.result.energy, released[i], 1e-8); /* of 1e5, summed over 1035 disks */
        double weight = 0;
        for (size_t b = 0; b < h.k; b++) weight += h.N[b];
        CHECK_NEAR(weight, 1035, 1035 * ROUNDING);
        N_error(&h, &N_most[i]);
        CU_ASSERT(released[i] > 10 && N_most[i] > 0.015 && N_most[i] < 0.045);
    }
    for (int i = 0; i < 3; i++) CU_ASSERT(fabs(released[i] - released[(i + 1) % 3]) > 0.1);
}

/* Two minima near the saddle of a small pile, and which of them a number leads to: a result that names the
 * number can be repeated. */
static void test_ways(void)
{
    static const double released[] = {0.691513, 0.675877};
    scoped_pile h = make_disks(9, 60, 0);
    statics_definition def = soft(8e-3);
    def.branch = STATICS_BRANCH_MINIMUM;
    for (unsigned long way = 1; way < 3; way++) {
        def.leave = way;
        CHECK_OK(solve(&h, def));
        CHECK_NEAR(h.result.released, released[way - 1], 1e-6); /* as printed */
    }
}

/* The energy falls by the work of the weight in compression: of one disk on the ground,
 * weight 1 and stiffness 1, 1/2 - 1. */
static void test_energy(void)
{
    scoped_pile h = solved(1, 60, soft(1e-3));
    CHECK_NEAR(h.result.energy, -0.5, ROUNDING);
    remake(&h, 45, 60); /* half of the work of all springs, by Clapeyron, in the linearised problem */
    CHECK_OK(solve(&h, soft(0)));
    double work = 0;
    for (size_t i = 0; i < h.n; i++) work += h.u[2 * i + 1];
    CHECK_NEAR(h.result.energy, work / 2, fabs(work) * ROUNDING);
    /* of ground, contacts and weight, and of wells that were set under half of the load */
    remake(&h, 5, 60);
    statics_definition def = friction(1e-3, 0.7, 3);
    def.set_load = 0.5;
    CHECK_OK(solve(&h, def));
    statics_well wells[5];
    scoped statics_contact *list = NULL;
    size_t n;
    double sum = 0, x_0 = 0;
    statics_wells(h.pile, wells);
    CHECK_OK(statics_contacts(h.pile, &list, &n));
    for (size_t i = 0; i < 5; i++) sum += (h.N[i] * h.N[i] + h.H[i] * (wells[i].x - wells[i].x_0)) / 2;
    for (size_t i = 0; i < 5; i++) x_0 = fmax(x_0, fabs(wells[i].x_0));
    for (size_t k = 0; k < n; k++) sum += list[k].force * list[k].force / 2;
    for (size_t i = 0; i < h.n; i++) sum += h.u[2 * i + 1];
    CU_ASSERT(x_0 > 0.1);
    CHECK_NEAR(h.result.energy, sum, fabs(sum) * 1e-12);
}

/* Stability is lost at eps_c, about 5.2/k^3 in large piles. */
static void test_threshold(void)
{
    static const struct {
        long k;
        double found;
    } cases[] = {{12, 4.32}, {24, 4.94}, {48, 5.21}};
    for (size_t c = 0; c < (check_fast() ? 2 : 3); c++) {
        const double unit = pow((double)cases[c].k, -3);
        double lo = unit, hi = 20 * unit;
        scoped_pile h = make_disks(cases[c].k, 60, 0);
        while (hi - lo > 0.003 * lo) {
            const double eps = sqrt(lo * hi);
            CHECK_OK(solve(&h, soft(eps)));
            *(h.result.negative_modes ? &hi : &lo) = eps;
        }
        CHECK_NEAR(lo / unit, cases[c].found, 0.02);
    }
}

/* Net forces and energy from positions of all pairs of disks: eps = 1e-3 leaves 12 digits of an overlap. */
static double plain_forces(const test_pile *h, const double *u, double eps, double k_x, double *force)
{
    double energy = 0;
    for (size_t i = 0; i < h->n; i++) {
        const statics_disk *p = &h->disks[i];
        const bool base = p->y < 0.6;
        const double sunk = fmax(p->r - (p->y + eps * u[2 * i + 1]), 0) / eps;
        force[2 * i] = base ? -k_x * u[2 * i] : 0;
        force[2 * i + 1] = sunk - p->weight;
        energy += sunk * sunk / 2 + p->weight * u[2 * i + 1] + (base ? k_x * u[2 * i] * u[2 * i] / 2 : 0);
    }
    for (size_t i = 0; i < h->n; i++)
        for (size_t j = 0; j < i; j++) {
            const double x = h->disks[i].x - h->disks[j].x + eps * (u[2 * i] - u[2 * j]);
            const double y = h->disks[i].y - h->disks[j].y + eps * (u[2 * i + 1] - u[2 * j + 1]);
            const double r = hypot(x, y), f = (h->disks[i].r + h->disks[j].r - r) / eps;
            if (!(f > 0)) continue;
            force[2 * i] += f * x / r;
            force[2 * i + 1] += f * y / r;
            force[2 * j] -= f * x / r;
            force[2 * j + 1] -= f * y / r;
            energy += f * f / 2;
        }
    return energy;
}

static double worst_of(const double *v, size_t n)
{
    double worst = 0;
    for (size_t i = 0; i < n; i++) worst = fmax(worst, fabs(v[i]));
    return worst;
}

/* Negative eigenvalues of the stiffness by differences of forces, independent of the factorisation. */
static size_t plain_negative_modes(const test_pile *h, double eps, double k_x)
{
    const size_t n = 2 * h->n;
    const double step = 1e-4; /* forces vary over 1: errors of 1e-8 against modes of 1e-3 */
    gsl_matrix *A = gsl_matrix_alloc(n, n);
    gsl_vector *values = gsl_vector_alloc(n);
    gsl_eigen_symm_workspace *work = gsl_eigen_symm_alloc(n);
    scoped double *u = malloc(n * sizeof *u), *up = malloc(n * sizeof *up), *down = malloc(n * sizeof *down);
    memcpy(u, h->u, n * sizeof *u);
    for (size_t j = 0; j < n; j++) {
        u[j] = h->u[j] + step;
        plain_forces(h, u, eps, k_x, up);
        u[j] = h->u[j] - step;
        plain_forces(h, u, eps, k_x, down);
        u[j] = h->u[j];
        for (size_t i = 0; i < n; i++) gsl_matrix_set(A, i, j, (down[i] - up[i]) / (2 * step));
    }
    gsl_eigen_symm(A, values, work);
    size_t negative = 0;
    for (size_t i = 0; i < n; i++) negative += gsl_vector_get(values, i) < 0;
    gsl_matrix_free(A), gsl_vector_free(values), gsl_eigen_symm_free(work);
    return negative;
}

/* Diameters above the base spread evenly over 1 -+ sizes/2, in no order. */
static void unequal(test_pile *h, double sizes)
{
    for (size_t i = 0; i < h->n; i++) {
        statics_disk *p = &h->disks[i];
        if (p->y < 0.6) continue;
        p->r += 0.5 * sizes * (fmod(0.618033988749895 * (double)i, 1) - 0.5);
        p->weight = 4 * p->r * p->r;
    }
}

static void test_plain_forces_and_modes(void)
{
    static const struct {
        long k;
        double alpha, eps;
        int branch;
        double sizes;
    } cases[] = {{10, 60, 6e-3, STATICS_BRANCH_PRIMARY, 0},
                 {10, 60, 6e-3, STATICS_BRANCH_MINIMUM, 0},
                 {14, 40, 1e-3, STATICS_BRANCH_PRIMARY, 0},
                 {14, 40, 1e-3, STATICS_BRANCH_MINIMUM, 0.05}};
    double energy[4];
    for (size_t c = 0; c < 4; c++) {
        scoped_pile h = make_disks(cases[c].k, cases[c].alpha, 0);
        unequal(&h, cases[c].sizes);
        statics_definition def = soft(cases[c].eps);
        def.k_x = 0.7, def.branch = cases[c].branch;
        CHECK_OK(solve(&h, def));
        scoped double *force = malloc(2 * h.n * sizeof *force);
        energy[c] = plain_forces(&h, h.u, def.eps, def.k_x, force);
        CU_ASSERT(worst_of(force, 2 * h.n) < 1e-10);
        CU_ASSERT(plain_negative_modes(&h, def.eps, def.k_x) == h.result.negative_modes);
        CU_ASSERT((h.result.negative_modes > 0) == (c == 0));
    }
    CU_ASSERT(energy[1] < energy[0] - 1e-6);
}

/* ---- slopes below 60 degrees ---- */

/* H at 30 degrees stays below the maximum of the continuum, at any size and softness. */
static void test_horizontal_force(void)
{
    double x_c;
    an_force kink;
    CHECK_OK(an_continuum_kink(30 * DEG, &x_c));
    CHECK_OK(an_continuum(30 * DEG, x_c, &kink));
    static const struct {
        long k;
        size_t n;
        double eps, found;
    } cases[] = {{45, 360, 1e-4, 0.72}, {45, 360, 1e-8, 0.72}, {180, 5490, 0, 0.75}};
    for (size_t c = 0; c < (check_fast() ? 2 : 3); c++) {
        scoped_pile h = solved(cases[c].k, 30, soft(cases[c].eps));
        CU_ASSERT(h.n == cases[c].n);
        const double B = an_lattice_base((double)h.n, M_PI / 6, 30 * DEG);
        CHECK_NEAR(worst_of(h.H, h.k) / (B * fabs(kink.H)), cases[c].found, 0.01);
        CU_ASSERT(h.result.horizontal > h.n / 2);
        for (size_t i = 0; i < h.k; i++) { /* mirrored */
            CHECK_PAIRS(1e-9, {h.N[i], h.N[h.k - 1 - i]}, {h.H[i], -h.H[h.k - 1 - i]});
        }
    }
    /* steeper slopes all have an equilibrium */
    static const double alphas[] = {32.6, 45, 50, 55};
    static const size_t counts[] = {383, 581, 690, 821};
    for (size_t a = 0; a < 4; a++) {
        scoped_pile h = solved(45, alphas[a], soft(1e-4));
        CU_ASSERT(h.n == counts[a]);
        CU_ASSERT(h.result.negative_modes == 0 && h.result.residual < ROUNDING);
    }
}

/* The order of the disks does not matter. */
static void test_relabelled(void)
{
    scoped_pile h = solved(20, 35, soft(1e-3));
    scoped double *u = malloc(2 * h.n * sizeof *u);
    double N[20];
    memcpy(u, h.u, 2 * h.n * sizeof *u);
    memcpy(N, h.N, sizeof N);
    scoped statics_disk *disks = malloc(h.n * sizeof *disks);
    memcpy(disks, h.disks, h.n * sizeof *disks);
    for (size_t i = 0; i < h.n; i++) h.disks[i] = disks[(i * 11 + 3) % h.n];
    CU_ASSERT_FATAL(h.n % 11 != 0);
    CHECK_OK(solve(&h, soft(1e-3)));
    for (size_t i = 0; i < h.n; i++) CHECK_NEAR(h.u[2 * i], u[2 * ((i * 11 + 3) % h.n)], 1e-9);
    size_t base[20]; /* by x, whatever the order */
    statics_base(h.pile, base, h.N, h.H);
    for (size_t i = 0; i < h.k; i++) {
        CHECK_NEAR(h.disks[base[i]].x, (double)i, 1e-12);
        CHECK_NEAR(h.N[i], N[i], 1e-9);
    }
}

/* ---- against the simulator ---- */

/* The same pile, released under gravity with damping until it is at rest: linear springs without friction
 * between the grains, and a floor whose shear spring never slips instead of the wells. */
static void test_damped_dynamics(void)
{
    const double eps = 1e-3, k_x = 0.8;
    statics_definition def = soft(eps);
    def.k_x = k_x;
    scoped_pile h = solved(12, 35, def);
    CU_ASSERT(h.result.horizontal > 0);
    scoped dem_grain *grains = calloc(h.n, sizeof *grains);
    for (size_t i = 0; i < h.n; i++)
        grains[i] = (dem_grain){.x = h.disks[i].x, .y = h.disks[i].y, .r = 0.5, .m = 1};
    dem_definition scene = grains_of(h.n, grains);
    scene.gravity[0] = 0, scene.gravity[1] = -1, scene.dt = 4e-3;
    scene.normal = DEM_LINEAR, scene.tangential = DEM_SPRING, scene.tension = false;
    scene.material = (dem_material){.k_n = 1 / eps, .gamma_n = 20, .k_s = 1};
    scene.n_walls = 1;
    scene.walls[0] = (dem_wall){
        .direction = {0, 1},
        .material = {.k_n = 1 / eps, .gamma_n = 20, .k_s = k_x / eps, .gamma_s = 20, .mu = INFINITY},
        .extent = {-INFINITY, INFINITY},
        .open_at_step = -1};
    scoped_sim *sim = grains_start(&scene);
    scoped dem_state *states = malloc(h.n * sizeof *states);
    grains_run(sim, 100000, states);
    for (size_t i = 0; i < h.n; i++) {
        /* positions near 6 in units of eps: 1e-12; remaining motion: below 1e-9 */
        CHECK_NEAR((states[i].x - grains[i].x) / eps, h.u[2 * i], 1e-8);
        CHECK_NEAR((states[i].y - grains[i].y) / eps, h.u[2 * i + 1], 1e-8);
    }
}

/* ---- bad input ---- */

/* A disk on two others held by weak springs: tan(theta)/2 = k_x u, at sin(theta) = (1/2 + eps u)/(1 - eps f),
 * with the contact force f = 1/(2 cos(theta)); stable up to eps u of about 0.3. A distance above half a
 * diameter between the two counts as spread, for any order of the disks. */
static double weak_base(double u, double eps, double k_x)
{
    double s = 0.5 + eps * u;
    for (int i = 0; i < 40; i++) s = (0.5 + eps * u) / (1 - eps / (2 * sqrt(1 - s * s)));
    return 0.5 * s / sqrt(1 - s * s) - k_x * u;
}

static void check_weak_base(void)
{
    static const size_t orders[][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}};
    const statics_disk disks[] = {{0, 0.5, 0.5, 1}, {1, 0.5, 0.5, 1}, {0.5, 0.5 + sqrt(0.75), 0.5, 1}};
    const double eps = 1e-4;
    for (int k = 0; k < 6; k++) {
        statics_disk given[3];
        for (int i = 0; i < 3; i++) given[orders[k / 2][i]] = disks[i];
        statics_definition def = soft(eps);
        def.n = 3, def.disks = given;
        def.k_x = (k % 2 ? 2.25 : 2.3) * eps;
        statics_pile *pile = NULL;
        statics_result result;
        CHECK_OK(statics_create(&def, &pile));
        if (k % 2) {
            CHECK_FAILS(statics_solve(pile, &result), RP_NO_RESULT, "collapses");
        } else {
            CHECK_OK(statics_solve(pile, &result));
            double lo = 0.1 / eps, hi = 0.25 / eps, u[6];
            while (hi - lo > 1e-9 / eps)
                *(weak_base(0.5 * (lo + hi), eps, def.k_x) > 0 ? &lo : &hi) = 0.5 * (lo + hi);
            statics_displacements(pile, u);
            CHECK_NEAR(eps * u[2 * orders[k / 2][1]], eps * lo, 1e-8);
            CHECK_NEAR(eps * u[2 * orders[k / 2][0]], -eps * lo, 1e-8);
        }
        statics_free(pile);
    }
}

static void test_errors(void)
{
    const double top = 0.5 + sqrt(0.75);
    const statics_definition def = soft(1e-4);
    statics_pile *pile = NULL;
    statics_disk disks[3] = {{0, 0.5, 0.5, 1}, {1, 0.5, 0.5, 1}, {0.5, top, 0.5, 1}};
    statics_result result;
    static const struct {
        const char *text;
        statics_disk last;
    } cases[] = {{"disk 3 at (0.5, 2.2) has no support", {0.5, 2.2, 0.5, 1}},
                 {"disk 3 at (1.5, 1.36603) has no support", {1.5, 1.3660254037844386, 0.5, 1}},
                 {"disk 3 at (5, 0.2): below the ground", {5, 0.2, 0.5, 1}}};
    statics_definition nothing = soft(1e-4);
    nothing.disks = disks;
    CHECK_FAILS(statics_create(&nothing, &pile), RP_BAD_INPUT, "0 disks");
    CU_ASSERT_PTR_NULL(pile);
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        disks[2] = cases[c].last;
        CHECK_FAILS(try_disks(def, 3, disks, &result), RP_BAD_INPUT, cases[c].text);
    }
    /* ten in the air */
    statics_disk high[11] = {{0, 0.5, 0.5, 1}};
    for (int i = 1; i < 11; i++) high[i] = (statics_disk){3 * i, 3, 0.5, 1};
    CHECK_FAILS(try_disks(def, 11, high, &result), RP_BAD_INPUT,
                "can't carry it; nor disks 3, 4, 5, 6, 7, 8, 9, 10 and 1 more");
    /* a tower is in equilibrium, but unstable */
    static const statics_disk tower[] = {{0, 0.5, 0.5, 1}, {0, 1.5, 0.5, 1}, {0, 2.5, 0.5, 1}};
    statics_definition stable = def;
    CHECK_OK(try_disks(def, 3, tower, &result));
    CU_ASSERT(result.negative_modes == 2);
    stable.branch = STATICS_BRANCH_MINIMUM;
    CHECK_FAILS(try_disks(stable, 3, tower, &result), RP_NO_RESULT,
                "collapses: neighbours 2 and 3 moved by 0.6 sigma");
    CU_ASSERT(result.negative_modes == STATICS_UNCOUNTED && isnan(result.smallest_pivot));
    check_weak_base();
    /* two piles of three on weak springs slide into one another, without having been neighbours */
    statics_disk two[6] = {{0, 0.5, 0.5, 1}, {1, 0.5, 0.5, 1}, {0.5, top, 0.5, 1}};
    for (int i = 3; i < 6; i++) two[i] = two[i - 3], two[i].x += 2.2501;
    statics_definition weak = soft(0.01);
    weak.k_x = 0.024;
    CHECK_FAILS(try_disks(weak, 6, two, &result), RP_NO_RESULT,
                "meets: no neighbours, but disk 2 on 4; followed up");
    CU_ASSERT(result.fault == STATICS_MEETS && result.load == 1);
    CU_ASSERT(result.negative_modes == STATICS_UNCOUNTED && isnan(result.smallest_pivot));
    /* 0.2 above the ground, without neighbours: no force in x */
    static const statics_disk lone[] = {{0, 0.5, 0.5, 1}, {3, 0.6, 0.5, 1}};
    CHECK_FAILS(try_disks(def, 2, lone, &result), RP_NO_RESULT, "disk 2");
    CU_ASSERT(result.fault == STATICS_SINGULAR);
}

/* Whether a pile of two disks that lie apart can be made; its wells and contacts. */
static rp_status try_two(statics_definition def, const statics_disk disks[2], statics_result *r)
{
    const rp_status status = try_disks(def, 2, disks, r);
    return status == RP_NO_RESULT ? RP_OK : status;
}

/* Both sides of each limit of a definition. */
static void test_ranges(void)
{
    const double more = 1 + DBL_EPSILON, tiny = 1e-300;
    const statics_disk good[2] = {{0, 0.5, 0.5, 1}, {3, 0.5, 0.5, 1}};
    statics_definition def = friction(1e-4, 1, 1);
    statics_result r;
    const struct {
        double *at, in, out;
        const char *text;
    } numbers[] = {{&def.eps, 0, -tiny, "eps"},           {&def.eps, 0.1, 0.1 * more, "eps"},
                   {&def.mu, DBL_MIN, 0, "mu"},           {&def.mu, 1e9, 1e9 * more, "mu"},
                   {&def.a, DBL_MIN, 0, "a = 0"},         {&def.a, 1e9, 1e9 * more, "a = 1"},
                   {&def.set_load, 0, -tiny, "set_load"}, {&def.set_load, 1, more, "set_load"},
                   {&def.k_x, DBL_MIN, 0, "k_x"},         {&def.k_x, 1e9, 1e9 * more, "k_x"}};
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
        const double before = *numbers[k].at;
        def.well = k < 8 ? STATICS_WELL_FRICTION : STATICS_WELL_SPRING;
        *numbers[k].at = numbers[k].in;
        CHECK_OK(try_two(def, good, &r));
        *numbers[k].at = numbers[k].out;
        CHECK_FAILS(try_two(def, good, &r), RP_BAD_INPUT, numbers[k].text);
        *numbers[k].at = NAN;
        CHECK_FAILS(try_two(def, good, &r), RP_BAD_INPUT, check_text("%.3s", numbers[k].text));
        *numbers[k].at = before;
    }
    static const long steps[] = {0, 1, 1000000, 1000001};
    for (int k = 0; k < 4; k++) {
        def.load_steps = steps[k];
        CHECK_FAILS_IF(k % 3 == 0, try_two(def, good, &r), RP_BAD_INPUT,
                       check_text("load_steps = %ld", steps[k]));
    }
    statics_disk two[2] = {{0, 0.5, 0.5, 1}, {3, 0.5, -0.5, 1}};
    statics_pile *pile = NULL;
    def = soft(1e-4);
    def.disks = two + 1; /* the first is refused before another is looked at */
    def.n = STATICS_MAX;
    CHECK_FAILS(statics_create(&def, &pile), RP_BAD_INPUT, "disk 1 at (3, 0.5) with r = -0.5");
    def.n++;
    CHECK_FAILS(statics_create(&def, &pile), RP_BAD_INPUT, "out of range, allowed: [1, ");
    for (int field = 0; field < 4; field++)
        for (int value = 0; value < 4; value++) {
            const double bad[] = {NAN, INFINITY, -INFINITY, 0};
            memcpy(two, good, sizeof two);
            *(double *[]){&two[1].x, &two[1].y, &two[1].r, &two[1].weight}[field] = bad[value];
            if (field > 1 || value < 3)
                CHECK_FAILS(try_two(soft(1e-4), two, &r), RP_BAD_INPUT, "not allowed");
        }
}

/* How far disks may overlap, by half of touching, or with eps = 0 by rounding; which are on the ground; which
 * contacts are level. */
static void test_ranges_of_places(void)
{
    statics_result r;
    for (int beyond = 0; beyond < 2; beyond++)
        for (int linear = 0; linear < 2; linear++) {
            const statics_definition def = soft(linear ? 0 : 1e-2);
            const double lie = (linear ? 1e-9 : 0.25) * (beyond ? 1.001 : 0.999),
                         overlap = (linear ? 1e-9 : 0.5) * (beyond ? 1.001 : 0.999);
            const statics_disk sunk[2] = {{0, 0.5, 0.5, 1}, {3, 0.5 - lie, 0.5, 1}};
            const statics_disk near[2] = {{0, 0.5, 0.5, 1}, {1 - overlap, 0.5, 0.5, 1}};
            CHECK_FAILS_IF(beyond, try_two(def, sunk, &r), RP_BAD_INPUT, "disk 2 at (3, ");
            CHECK_FAILS_IF(beyond, try_two(def, near, &r), RP_BAD_INPUT, "disks 1 and 2 overlap");
            const statics_disk above[2] = {{0, 0.5, 0.5, 1},
                                           {3, 0.5 + 1e-9 * (beyond ? 1.001 : 0.999), 0.5, 1}};
            CHECK_OK(try_two(def, above, &r));
            CU_ASSERT_EQUAL(r.wells, beyond ? 1 : 2);
            const double s = sin((beyond ? 15.01 : 14.95) * DEG), large = 0.5 * (1 + s) / (1 - s);
            const statics_disk slope[2] = {{0, 0.5, 0.5, 1},
                                           {0.999 * (0.5 + large) * sqrt(1 - s * s), large, large, 1}};
            if (linear) continue;
            CHECK_OK(try_two(def, slope, &r));
            CU_ASSERT(r.contacts == 1 && r.horizontal == (beyond ? 0 : 1));
        }
}

/* Neighbours of disks of any size, in any unit, against all pairs: in the order of their ends. */
static void test_neighbours(void)
{
    enum { MOST = 40 };
    scoped_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
    for (int trial = 0; trial < 200; trial++) {
        statics_disk disks[MOST];
        const size_t n = 1 + (size_t)trial % MOST;
        const double unit = trial % 3 ? 1 : 0.05, reach = trial % 2 ? 1.25 : 1;
        for (size_t i = 0; i < n; i++)
            disks[i] =
                (statics_disk){unit * (8 * gsl_rng_uniform(rng) - 4), unit * (6 * gsl_rng_uniform(rng) - 1),
                               unit * (trial % 5 ? 0.1 + 0.6 * gsl_rng_uniform(rng) : 0.5), 1};
        statics_network net = {.n = n, .disks = disks, .reach = reach};
        size_t k = 0;
        CHECK_OK(statics_bonds_find(&net));
        for (uint32_t a = 0; a < n; a++)
            for (uint32_t b = a + 1; b < n; b++)
                if (hypot(disks[a].x - disks[b].x, disks[a].y - disks[b].y) <
                    reach * (disks[a].r + disks[b].r)) {
                    CU_ASSERT(k < net.n_pairs && net.pairs[k].a == a && net.pairs[k].b == b);
                    CU_ASSERT(statics_bonds_has(&net, (rp_pair){a, b}));
                    k++;
                } else
                    CU_ASSERT(!statics_bonds_has(&net, (rp_pair){a, b}));
        CU_ASSERT_EQUAL(k, net.n_pairs);
        free(net.pairs);
    }
}

/* Which disks their neighbours and the ground can carry: by the steepest slopes of forces to the right and to
 * the left. A force that pushes down may be held by a steeper one from below. */
static void test_unsupported(void)
{
    const statics_disk disks[] = {
        {0, 0.5, 0.5, 1}, {0, 1.5, 0.5, 1},     {2, 0.624, 0.5, 1},  {4, 0.626, 0.5, 1}, {10, 2, 0.5, 1},
        {9, 1.5, 0.5, 1}, {11, 2.25, 0.5, 1},   {20, 2, 0.5, 1},     {19, 1.75, 0.5, 1}, {21, 2.5, 0.5, 1},
        {30, 2, 0.5, 1},  {29.5, 1.25, 0.5, 1}, {30.5, 1.25, 0.5, 1}};
    rp_pair bonds[] = {{0, 1}, {4, 5}, {4, 6}, {7, 8}, {7, 9}, {10, 11}, {10, 12}};
    static const bool carried[] = {true,  true,  true,  false, true,  false, false,
                                   false, false, false, true,  false, false};
    enum { N = sizeof disks / sizeof *disks };
    double lean[2 * N];
    size_t which[N] = {0}, n = 0;
    const statics_network net = {N, disks, 1.25, 7, bonds};
    const size_t found = statics_bonds_unsupported(&net, lean, N, which);
    for (size_t i = 0; i < N; i++)
        if (!carried[i]) CU_ASSERT(n < found && which[n++] == i);
    CU_ASSERT_EQUAL(found, n);
    static const double slopes[][2] = {{4, 0.5}, {7, 0.25}, {10, 1.5}};
    for (int k = 0; k < 3; k++) {
        const size_t i = (size_t)slopes[k][0];
        CHECK_NEAR(lean[2 * i], slopes[k][1], 1e-15);
        CHECK_NEAR(lean[2 * i + 1], k == 0 ? -0.25 : k == 1 ? -0.5 : 1.5, 1e-15);
    }
    CU_ASSERT(isinf(lean[0]) && lean[0] > 0 && lean[6] < 0 && isinf(lean[2]) && lean[2] > 0 && lean[3] > 0);
    size_t few[N] = {0};
    CU_ASSERT_EQUAL(statics_bonds_unsupported(&net, lean, 2, few), found);
    CU_ASSERT(few[0] == which[0] && few[1] == which[1] && few[2] == 0);
    CU_ASSERT_EQUAL(statics_bonds_unsupported(&(statics_network){1, disks + 3, 1.25, 0, NULL}, lean, 1, few),
                    1);
}

/* The pile of half the size: for k = 7 at 60 degrees that of k = 4, with all other disks half way between its
 * disks; none for disks off a lattice, by a tenth of a step. In any unit of length. */
static void check_half_pile(double unit)
{
    const double round_off = 1e-14 * unit, row = unit * sqrt(0.75);
    scoped_pile h = make_disks(7, 60, 0);
    rp_pair *parents = malloc(h.n * sizeof *parents);
    statics_network net = {.n = h.n, .disks = h.disks, .reach = 1.25};
    statics_disk *half = NULL;
    size_t n_half;
    for (size_t i = 0; i < h.n; i++) {
        h.disks[i].weight = 1 + 0.01 * (double)i;
        h.disks[i].x *= unit, h.disks[i].y *= unit, h.disks[i].r *= unit;
    }
    CHECK_OK(statics_bonds_find(&net));
    CHECK_OK(statics_bonds_halve(&net, &half, &n_half, parents));
    CU_ASSERT_FATAL(n_half == 10);
    for (size_t i = 0; i < n_half; i++) { /* every other disk of every other row, as heavy as it is */
        size_t same = 0;
        for (size_t k = 0; k < h.n; k++)
            same += fabs(h.disks[k].x / 2 - half[i].x) + fabs(h.disks[k].y + unit / 2 - 2 * half[i].y) <
                        round_off &&
                    h.disks[k].weight == half[i].weight;
        CU_ASSERT(same == 1);
    }
    for (size_t i = 0; i < h.n; i++) {
        CU_ASSERT_FATAL(parents[i].a < n_half && parents[i].b < n_half);
        const statics_disk *p = &half[parents[i].a], *q = &half[parents[i].b];
        CHECK_PAIRS(round_off, {p->x + q->x, h.disks[i].x}, {p->y + q->y - unit, h.disks[i].y - unit / 2});
        CHECK_NEAR(hypot(p->x - q->x, p->y - q->y), parents[i].a == parents[i].b ? 0 : unit, round_off);
    }
    free(half);
    for (int way = 0; way < 8; way++) {
        const double part = (way & 1 ? 0.099 : 0.101) * (way & 2 ? 1 : -1);
        const statics_disk before = h.disks[9];
        h.disks[9].x += way & 4 ? 0 : part * unit;
        h.disks[9].y += way & 4 ? part * row : 0;
        CHECK_OK(statics_bonds_halve(&net, &half, &n_half, parents));
        CU_ASSERT(n_half == (way & 1 ? 10 : 0));
        free(half);
        h.disks[9] = before;
    }
    statics_network less = {h.n - 1, h.disks, 1.25, 0, NULL};
    CHECK_OK(statics_bonds_halve(&less, &half, &n_half, parents));
    CU_ASSERT(n_half == 0 && half == NULL);
    /* without the last disk of the base, the one beside it has a parent less */
    less.n_pairs = net.n_pairs, less.pairs = net.pairs;
    CHECK_OK(statics_bonds_halve(&less, &half, &n_half, parents));
    CU_ASSERT(n_half == 9);
    size_t orphans = 0;
    for (size_t i = 0; i < h.n - 1; i++) orphans += parents[i].a >= n_half || parents[i].b >= n_half;
    CU_ASSERT(orphans == 2);
    free(half), free(net.pairs), free(parents);
}

static void test_half_pile(void)
{
    check_half_pile(1);
    check_half_pile(0.2);
    check_half_pile(7);
}

static void count_step(size_t n, const statics_result *so_far, void *context)
{
    (void)n, (void)so_far;
    ++*(size_t *)context;
}

/* Newton steps, also with those of smaller piles, and factorisations of piles of all kinds, counted once. A
 * start, a softening, an update or a wrong well leads to the same state by more work. */
static void test_work(void)
{
    static const struct {
        long k;
        double alpha, gap, eps, mu, a, set_load;
        bool set_again, minimum;
        unsigned long leave;
        long load_steps;
        size_t steps, factored, horizontal, watched;
    } cases[] = {{45, 60, 0, 1e-4, 0, 0, 0, false, false, 0, 1, 6, 4, 0, 7},
                 {45, 60, 0, 1e-3, 0, 0, 0, false, false, 0, 1, 7, 6, 0, 8},
                 {45, 60, 0, 1e-4, 0, 0, 0, false, true, 0, 1, 57, 32, 229, 58},
                 {45, 60, 0, 1e-4, 0, 0, 0, false, true, 3, 1, 49, 21, 229, 50},
                 {45, 30, 0, 1e-4, 0, 0, 0, false, false, 0, 1, 11, 4, 239, 11},
                 {45, 50, 0, 1e-3, 0, 0, 0, false, false, 0, 1, 101, 77, 470, 101},
                 {20, 55, 0, 2e-3, 0, 0, 0, false, false, 0, 1, 29, 16, 46, 29},
                 {20, 55, 0, 2e-3, 0, 0, 0, false, false, 0, 3, 80, 79, 47, 80},
                 {31, 27, 0.02, 1e-3, 0, 0, 0, false, false, 0, 1, 5, 3, 0, 5},
                 {90, 30, 0, 0, 0, 0, 0, false, false, 0, 1, 6, 1, 984, 16},
                 {90, 45, 0, 1e-4, 0, 0, 0, false, false, 0, 1, 17, 5, 1262, 28},
                 {90, 30, 0, 1e-4, 0, 0, 0, false, true, 0, 1, 9, 3, 984, 19},
                 {20, 40, 0, 5e-3, 0, 0, 0.3, false, false, 0, 2, 18, 5, 49, 32},
                 {30, 30, 0, 1e-4, 0.5, 4, 0, false, false, 0, 1, 51, 4, 91, 51},
                 {30, 30, 0, 1e-4, 0.5, 4, 0.5, false, false, 0, 1, 51, 4, 86, 105},
                 {30, 30, 0, 1e-4, 0.5, 1, 0, true, false, 0, 1, 42, 4, 93, 42},
                 {45, 30, 0, 1e-4, 0.3, 3, 0, true, false, 0, 1, 54, 5, 213, 54},
                 {12, 45, 0, 1e-3, 0.6, 1, 0, false, false, 0, 1, 39, 4, 12, 39},
                 {20, 35, 0, 1e-3, 0.2, 2, 0, false, false, 0, 2, 83, 16, 8, 83}, /* comes apart */
                 {90, 30, 0, 0, 0.5, 8, 0, false, false, 0, 1, 43, 3, 910, 80},
                 {180, 30, 0, 0, 0.5, 16, 0, false, false, 0, 1, 33, 1, 3790, 105},
                 {180, 30, 0, 1e-6, 0.5, 16, 0, false, false, 0, 1, 41, 3, 3790, 113},
                 {180, 25, 0, 1e-5, 0.5, 5, 0.5, true, true, 0, 1, 42, 4, 3197, 216},
                 {180, 30, 0, 1e-4, 0, 0, 0, false, false, 0, 1, 33, 11, 4309, 50}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        statics_definition def =
            cases[c].mu > 0 ? friction(cases[c].eps, cases[c].mu, cases[c].a) : soft(cases[c].eps);
        def.set_load = cases[c].set_load, def.set_again = cases[c].set_again;
        def.branch = cases[c].minimum ? STATICS_BRANCH_MINIMUM : STATICS_BRANCH_PRIMARY;
        def.leave = cases[c].leave, def.load_steps = cases[c].load_steps;
        scoped_pile h = make_disks(cases[c].k, cases[c].alpha, cases[c].gap);
        size_t watched = 0;
        def.watch = count_step, def.context = &watched;
        const rp_status status = solve(&h, def);
        const statics_result *r = &h.result;
        CU_ASSERT((status == RP_OK) == (r->broken == 0));
        CHECK_OR_SAY(r->steps == cases[c].steps && r->factored == cases[c].factored &&
                         r->horizontal == cases[c].horizontal && watched == cases[c].watched,
                     "case %zu: %zu steps, %zu factorisations, %zu horizontal contacts, %zu with others", c,
                     r->steps, r->factored, r->horizontal, watched);
    }
}

/* ---- the program ---- */

/* The table of a pile that has a result. */
static rp_table base_table(const char *words)
{
    CU_ASSERT(run("pile %s", words) == 0);
    return read_table("out");
}

/* The summary row of a pile says its settings; the suite `piles` has the outputs. */
static void check_summary(void)
{
    scoped_table t = base_table("--alpha-deg 30 --well 1 --mu 0.2 --set-again --set-load 0.25 --summary");
    CU_ASSERT(t.n_rows == 1 && cell(&t, 0, "alpha_deg") == 30 &&
              strcmp(word(&t, 0, "inner_deg"), "auto") == 0);
    CU_ASSERT(cell(&t, 0, "well") == 1 && cell(&t, 0, "mu") == 0.2 && cell(&t, 0, "set_load") == 0.25);
    CU_ASSERT_STRING_EQUAL(word(&t, 0, "set_again"), "true");
    CU_ASSERT(cell(&t, 0, "eps") == 1e-4 && cell(&t, 0, "base") == 45);
    replace_table(&t, base_table("--alpha-deg 30 --inner-deg 45 --x-1 0.38 --summary"));
    CU_ASSERT(cell(&t, 0, "alpha_deg") == 30 && cell(&t, 0, "inner_deg") == 45);
    CU_ASSERT_STRING_EQUAL(word(&t, 0, "well"), "auto");
    CU_ASSERT_STRING_EQUAL(word(&t, 0, "set_again"), "false");
}

/* The same triangle by its slope, and as a tent of equal slopes. */
static void check_outlines(void)
{
    static const char *const words[] = {"--alpha-deg 30 --eps 0 --summary",
                                        "--alpha-deg 30 --inner-deg 30 --x-1 0.2 --eps 0 --summary"};
    double ratio = NAN;
    for (int i = 0; i < 2; i++) {
        scoped_table t = base_table(words[i]);
        CU_ASSERT(cell(&t, 0, "n_disks") == 360 && cell(&t, 0, "negative_modes") == 0);
        if (i == 0) ratio = cell(&t, 0, "H_ratio");
        CHECK_NEAR(cell(&t, 0, "H_ratio"), ratio, ROUNDING);
    }
}

/* A pile of unequal disks is the first of its stream. */
static void check_unequal(void)
{
    enum { K = 12 };
    double N[K], H[K];
    sweep_outline h = {0};
    statics_pile *pile = NULL;
    statics_result r;
    statics_definition def = statics_definition_default();
    CHECK_OK(sweep_outline_make(&h, K, 0, 30 * DEG, 0, NULL));
    CHECK_OK(sweep_outline_disorder(&h, 1e-4, 5, 0));
    def.n = h.n, def.disks = h.disks;
    CHECK_OK(statics_create(&def, &pile));
    CHECK_OK(statics_solve(pile, &r));
    statics_base(pile, NULL, N, H);
    statics_free(pile), sweep_outline_free(&h);
    scoped_table one = base_table("--base 12 --alpha-deg 30 --disorder 1e-4 --seed 5");
    CU_ASSERT(one.n_rows == K);
    for (size_t i = 0; i < K; i++) CU_ASSERT(cell(&one, i, "N/mg") == N[i]);
}

/* A pile that spreads: broken wells in the folder and in the message, nan for undetermined numbers. */
static void check_failed(void)
{
    size_t broken = 0, told = 0;
    CU_ASSERT(run("pile --alpha-deg 30 --well 1 --mu 0.2 --summary -o failed") == 1);
    CU_ASSERT(sscanf(err, "repose pile: spreads: %zu of 45 wells broken", &told) == 1);
    scoped_table t = read_table("out");
    CU_ASSERT(t.n_rows == 1 && isnan(cell(&t, 0, "negative_modes")) && isnan(cell(&t, 0, "smallest_pivot")));
    CU_ASSERT_STRING_EQUAL(rp_table_find_note(&t, "negative_modes"), "nan");
    CU_ASSERT_STRING_EQUAL(rp_table_find_note(&t, "smallest_pivot"), "nan");
    CU_ASSERT(cell(&t, 0, "broken") == (double)told);
    read_again(&t, "failed/wells.tsv");
    CU_ASSERT_STRING_EQUAL(rp_table_find_note(&t, "status"), "spreads");
    CU_ASSERT(rp_table_find_note(&t, "state") != NULL && t.n_rows == 45 && cell(&t, 0, "disk") == 1);
    for (size_t i = 0; i < t.n_rows; i++) {
        const char *state = word(&t, i, "state");
        broken += strcmp(state, "broken") == 0;
        CU_ASSERT(strcmp(state, "broken") == 0 ? cell(&t, i, "H") == 0 : strcmp(state, "holds") == 0);
        CHECK_NEAR(cell(&t, i, "x") - cell(&t, i, "x_0"), 1e-4 * cell(&t, i, "x-x_0"), 1e-12);
    }
    CU_ASSERT(broken == told && told == 24);
    read_again(&t, "failed/disks.tsv");
    CU_ASSERT(t.n_rows == 360);
}

/* An unstable primary state is a result, with a note. */
static void check_note(void)
{
    CU_ASSERT(run("pile --base 9 --eps 6e-3") == 0);
    CU_ASSERT_STRING_EQUAL(err,
                           "repose pile: unstable: 1 negative mode; --branch minimum seeks a stable state\n");
    GOOD("pile --base 9 --eps 6e-3 --branch minimum");
    GOOD("pile --base 9");
}

/* The suite `notes` has the options that would do nothing. */
static void test_program(void)
{
    static const struct {
        int status;
        const char *words;
    } cases[] = {{65, "--eps -1e-4"},
                 {65, "--alpha-deg 30 --inner-deg 60 --x-1 0.2"},
                 {65, "--alpha-deg 59.9 --gap 0.1"},
                 {65, "--alpha-deg 30 --disorder 1e-3 --eps 0"},
                 {65, "--alpha-deg 30 --disorder 0.2"},
                 {1, "--alpha-deg 30 --well 1 --mu 0.1"}};
    enter();
    check_summary();
    check_outlines();
    check_unequal();
    check_failed();
    check_note();
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++)
        CHECK_OR_SAY(run("pile %s", cases[c].words) == cases[c].status, "pile %s", cases[c].words);
    leave();
}

CHECK_SUITE(equilibrium, "equilibrium", test_three_disks, test_softest_disk, test_friction_wells,
            test_state_of_wells, test_causes, test_smooth_base, test_linearised, test_soft_wells,
            test_primary, test_stronger_diagonals, test_jump, test_large_soft, test_minima, test_ways,
            test_energy, test_threshold, test_plain_forces_and_modes, test_horizontal_force, test_relabelled,
            test_damped_dynamics, test_errors, test_work, test_ranges, test_neighbours, test_unsupported,
            test_ranges_of_places, test_half_pile, test_program)
