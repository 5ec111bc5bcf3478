/* Stress from contacts: hand-made arrangements with known stress, momentum balance in a simulated box, Mohr's
 * circle against a scan of planes, and protocol `stress`. */
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_fit.h>
#include <gsl/gsl_sort.h>

#include "analytic/analytic.h"
#include "stress/stress.h"
#include "tests/grains.h"
#include "tests/numbers.h"
#include "tests/protocol.h"

static const double deg = M_PI / 180.0;
/* sums of some hundred rounded products of order 1 */
static const double tight = 1e-12;

/* ---- hand-made arrangements ---- */

/* The grids hold the highest and the farthest grain of all piles, wherever it is. */
static void test_grids(void)
{
    double low[] = {0.1, 0.2, 0.3}, high[] = {0.1, 2.6}, mass[] = {1.0, 1.0, 1.0}, size;
    for (int order = 0; order < 2; order++)
        for (int last = 0; last < 2; last++) {
            double far[] = {high[!last], high[last]};
            stress_pile piles[2];
            piles[order] = (stress_pile){0, 3, NULL, NULL, NULL, low, low, mass, 0.0};
            piles[!order] = (stress_pile){0, 2, NULL, NULL, NULL, far, far, mass, 0.0};
            const stress_grid g = stress_grid_over(2, piles, 2.0, 0.6);
            CU_ASSERT(g.nx == 3 && g.ny == 5); /* cells of 2/3: 2.6 is in the fourth, and one is above */
            CHECK_PAIRS(tight, {g.dx, 2.0 / 3.0}, {g.dy, 2.0 / 3.0});
            CU_ASSERT(g.x0 == 0.0 && g.y0 == 0.0);
            CU_ASSERT_EQUAL(stress_floor_cells(2, piles, 2.0, 0.6, &size), 5);
            CHECK_NEAR(size, 2.0 / 3.0, tight);
        }
    /* a cell that is wider than the box: one across */
    const stress_pile one = {0, 3, NULL, NULL, NULL, low, low, mass, 0.0};
    const stress_grid g = stress_grid_over(1, &one, 2.0, 5.0);
    CU_ASSERT(g.nx == 1 && g.ny == 2 && g.dx == 2.0);
    CU_ASSERT_EQUAL(stress_floor_cells(1, &one, 2.0, 5.0, &size), 2);
    CHECK_NEAR(size, 2.0, 0.0);
}

/* Columns of width 1/2 and what each contact puts into them: two piles, the second of which has one grain.
 * What is beyond the three columns, on either side, does not count. */
static void test_floor(void)
{
    enum { N = 10, COLUMNS = 3 };
    const double size = 0.5, g = 10.0;
    double x[] = {0.2, 0.7, -0.3, 1.6}, y[4] = {0.0}, m[] = {1.0, 2.0, 4.0, 8.0}, one_x = 0.5, one_m = 3.0;
    bool floor[N] = {true, true}, wall[N] = {true, true, [9] = true}, one_floor = true;
    stress_contact c[N] = {{0.2, 0.1, 0.2, 0.0, -3.0, 5.0},    /* floor */
                           {1.6, 0.1, 1.6, 0.0, 7.0, 11.0},    /* floor, beyond */
                           {0.7, 0.3, 0.2, 0.1, 1.0, 2.0},     /* from the first column to the second */
                           {0.2, 0.3, 0.4, 0.1, 1.0, 7.0},     /* within the first */
                           {0.2, 0.1, 0.0, 0.1, 9.0, 1.5},     /* wall */
                           {0.2, 0.1, -0.1, 0.1, 9.0, 0.25},   /* the same, grains overlap it */
                           {-0.3, 0.1, 0.3, 0.2, 1.0, 0.125},  /* from beyond */
                           {1.2, 0.1, 1.7, 0.2, 1.0, 0.0625},  /* to beyond */
                           {1.5, 0.1, 1.2, 0.2, 1.0, 0.03125}, /* from where the columns end */
                           {0.7, 0.1, 1.0, 0.1, -9.0, 0.75}};  /* wall on the right, at the third */
    stress_contact one = {0.5, 0.1, 0.5, 0.0, 0.5, 13.0};
    const stress_pile piles[2] = {{N, 4, c, floor, wall, x, y, m, 0.0},
                                  {1, 1, &one, &one_floor, &one_floor, &one_x, y, &one_m, 0.0}};
    static const double n[2][COLUMNS] = {{5.0, 0.0, 0.0}, {0.0, 13.0, 0.0}},
                        h[2][COLUMNS] = {{3.0, 0.0, 0.0}, {0.0, -0.5, 0.0}},
                        weight[COLUMNS] = {10.0, 50.0, 0.0}, through[COLUMNS] = {0.375, -2.75, -0.03125};
    stress_floor f[COLUMNS];
    CHECK_OK(stress_floor_forces(2, piles, size, g, COLUMNS, f));
    for (int k = 0; k < COLUMNS; k++) { /* of two values the error of the mean is half of their difference */
        CHECK_PAIRS(tight, {f[k].n.mean, 0.5 * (n[0][k] + n[1][k]) / size},
                    {f[k].n.se, 0.5 * fabs(n[0][k] - n[1][k]) / size},
                    {f[k].h.mean, 0.5 * (h[0][k] + h[1][k]) / size},
                    {f[k].h.se, 0.5 * fabs(h[0][k] - h[1][k]) / size}, {f[k].weight, 0.5 * weight[k] / size},
                    {f[k].through, 0.5 * through[k] / size},
                    {f[k].imbalance, f[k].n.mean - 0.5 * (weight[k] + through[k]) / size});
    }
    /* mean stress of both, whatever the memory held; force times branch, over cells of all branches */
    const stress_grid grid = {-0.5, 0.0, 2.5, 0.5, 1, 1};
    stress_tensor mean = {1e9, NAN, 1e9, 1e9}, sum = {0};
    CHECK_OK(stress_mean_cells(2, piles, &grid, &mean));
    for (int k = 0; k <= N; k++) {
        const stress_contact *a = k < N ? &c[k] : &one;
        const double l[2] = {a->x - a->x_b, a->y - a->y_b};
        const stress_tensor part = {a->fx * l[0], a->fx * l[1], a->fy * l[0], a->fy * l[1]};
        stress_tensor_add(&sum, &part, 0.5 / 1.25);
    }
    CHECK_PAIRS(tight, {mean.xx, sum.xx}, {mean.xy, sum.xy}, {mean.yx, sum.yx}, {mean.yy, sum.yy});
}

/* A column of equal grains of diameter 0.7 and weight 1.3: each contact carries the weight above. */
static void test_column(void)
{
    enum { N = 9, NY = 13 };
    const double d = 0.7, weight = 1.3;
    stress_contact c[N];
    for (int i = 0; i < N; i++) { /* grain i on the one below, the first on the floor */
        double y = (i + 0.5) * d, below = i > 0 ? y - d : 0.0;
        c[i] = (stress_contact){0.1, y, 0.1, below, 0.0, (N - i) * weight};
    }
    const stress_grid grid = {-0.37, 0.0, 0.81, N * d / NY, 1, NY};
    stress_tensor s[NY];
    CHECK_OK(stress_cells(N, c, &grid, s));
    for (int j = 0; j < NY; j++) {
        /* the force through each height, averaged over the cell by a separate fine sum */
        double lo = j * grid.dy, mean = 0.0;
        for (int i = 0; i < N; i++) {
            mean += fmax(fmin(c[i].y, lo + grid.dy) - fmax(c[i].y_b, lo), 0.0) * c[i].fy / grid.dy;
        }
        CHECK_NEAR(s[j].yy, mean / grid.dx, tight);
        CU_ASSERT(s[j].xx == 0.0 && s[j].xy == 0.0 && s[j].yx == 0.0);
        /* linear in depth, except for the finite size of the grains */
        if (j < NY - 1)
            CHECK_NEAR(s[j].yy, weight / grid.dx * (N - (lo + 0.5 * grid.dy) / d), weight / grid.dx);
    }
}

/* A square lattice with equal contact forces: a pressure, in any cell of whole periods. */
static void test_hydrostatic(void)
{
    enum { SIDE = 12 };
    const double d = 0.31, force = 2.7;
    stress_contact c[2 * SIDE * SIDE];
    size_t n = 0;
    for (int i = 0; i < SIDE; i++)
        for (int j = 0; j < SIDE; j++) {
            c[n++] = (stress_contact){(i + 1) * d, j * d, i * d, j * d, force, 0.0};
            c[n++] = (stress_contact){i * d, (j + 1) * d, i * d, j * d, 0.0, force};
        }
    for (int k = 0; k < 4;
         k++) { /* neither the position of the cell matters, nor the order of the two grains */
        const stress_grid grid = {(2.0 + 0.237 * k) * d, (1.0 + 0.411 * k) * d, 3.0 * d, 4.0 * d, 2, 2};
        stress_tensor s[4];
        CHECK_OK(stress_cells(n, c, &grid, s));
        for (int m = 0; m < 4; m++) {
            CHECK_PAIRS(tight, {s[m].xx, force / d}, {s[m].yy, force / d},
                        {stress_mohr(&s[m]).mobilised, 0.0});
        }
        for (size_t i = 0; i < n; i += 2)
            c[i] = (stress_contact){c[i].x_b, c[i].y_b, c[i].x, c[i].y, -c[i].fx, -c[i].fy};
    }
}

/* The close-packed triangle with diagonal contacts alone: its base forces are those of the lattice model. */
static void test_triangle(void)
{
    enum { K = 9 };
    const double rise = 0.5 * sqrt(3.0);
    stress_contact c[2 * K * K];
    double fx[K][K] = {{0.0}}, fy[K][K] = {{0.0}}; /* load on disk i of row j */
    size_t n = 0;
    for (int j = K - 1; j > 0; j--)
        for (int i = 0; i < K - j; i++) {
            /* rests on i and i + 1 of the row below: L along (1, 2 rise)/2, R along (-1, 2 rise)/2 */
            double down = fy[j][i] + 1.0, right = fx[j][i];
            double l = 0.5 * down / rise - right, r = 0.5 * down / rise + right;
            double x = i + 0.5 * j, y = (j + 0.5) * rise;
            c[n++] = (stress_contact){x, y, x - 0.5, y - rise, 0.5 * l, rise * l};
            c[n++] = (stress_contact){x, y, x + 0.5, y - rise, -0.5 * r, rise * r};
            fx[j - 1][i] -= 0.5 * l;
            fy[j - 1][i] += rise * l;
            fx[j - 1][i + 1] += 0.5 * r;
            fy[j - 1][i + 1] += rise * r;
        }
    /* one row of cells between the first two rows of disks */
    const stress_grid grid = {-0.5, 0.5 * rise, 1.0, rise, K, 1};
    stress_tensor s[K];
    CHECK_OK(stress_cells(n, c, &grid, s));
    for (int i = 0; i < K; i++) {
        an_force base;
        CHECK_OK(an_lattice_triangle(K, M_PI / 6.0, i + 1, &base));
        CHECK_NEAR(s[i].yy, base.N - 1.0, tight); /* minus the weight of the base disk */
        CHECK_NEAR(-s[i].xy, base.H, tight);
    }
}

/* ---- a simulated box ---- */

enum { GRAINS = 60 };

static dem_sim *make_box(void)
{
    dem_grain grains[GRAINS];
    const dem_fill fill = {GRAINS, 1.7, 3.0, 0.1, 0.02, 0.07, 0.13, 1.0, DEM_SPHERE, 1993, 7};
    CHECK_OK(dem_fill_grains(&fill, grains, &(size_t){0}));
    dem_definition def = grains_of(GRAINS, grains);
    dem_material wall = def.material;
    wall.k_n *= 2.0;
    dem_box_walls(&def, fill.W, &wall);
    return grains_after(&def, 6000); /* still moving a little: the balance holds with the accelerations */
}

static size_t read_contacts(const dem_sim *sim, stress_contact **forces)
{
    size_t n;
    scoped dem_contact *list = grains_contacts(sim, &n);
    *forces = malloc((n + 1) * sizeof **forces);
    CU_ASSERT_PTR_NOT_NULL_FATAL(*forces);
    for (size_t k = 0; k < n; k++) {
        const dem_contact *c = &list[k];
        const double lx = c->x - c->x_b, ly = c->y - c->y_b, l = hypot(lx, ly);
        const double fx = c->normal_force * lx + c->shear_force * ly,
                     fy = c->normal_force * ly - c->shear_force * lx;
        (*forces)[k] = (stress_contact){c->x, c->y, c->x_b, c->y_b, fx / l, fy / l};
    }
    return n;
}

/* Sum over the crossings of a branch with the border of the cell [x, x + w) x [y, y + h), of force times
 * position, positive where the branch from b to a leaves the cell. */
static void cross(const stress_contact *c, const double lo[2], const double hi[2], double moment[2][2])
{
    const double from[2] = {c->x_b, c->y_b}, step[2] = {c->x - c->x_b, c->y - c->y_b}, f[2] = {c->fx, c->fy};
    for (int axis = 0; axis < 2; axis++)
        for (int end = 0; end < 2; end++) {
            double line = end ? hi[axis] : lo[axis];
            double at = (line - from[axis]) / step[axis], place[2];
            if (!(at > 0.0 && at < 1.0)) continue;
            place[axis] = line;
            place[1 - axis] = from[1 - axis] + at * step[1 - axis];
            if (place[1 - axis] < lo[1 - axis] || place[1 - axis] >= hi[1 - axis]) continue;
            double out = (end ? step[axis] : -step[axis]) > 0.0 ? 1.0 : -1.0;
            for (int a = 0; a < 2; a++)
                for (int b = 0; b < 2; b++) moment[a][b] += out * f[a] * place[b];
        }
}

/* div s = rho (g - acceleration) + forces of walls, as its moment over each cell: forces across the border,
 * minus net contact forces on the grains inside, minus forces at walls. */
static void test_momentum(void)
{
    enum { NX = 5, NY = 6 };
    const stress_grid grid = {-0.05, -0.04, 0.37, 0.41, NX, NY};
    scoped_sim *sim = make_box();
    scoped stress_contact *c = NULL;
    const size_t n = read_contacts(sim, &c);
    stress_tensor s[NX * NY];
    double total[2][2] = {{0.0}}, sum[2][2] = {{0.0}};
    CU_ASSERT_FATAL(dem_count(sim) == GRAINS);
    scoped dem_state *states = grains_states(sim);
    CHECK_OK(stress_cells(n, c, &grid, s));
    /* forces up to 1e3, positions up to 2, some 20 terms per cell */
    const double rounding = 1e-9;
    for (int k = 0; k < NX * NY; k++) {
        const double lo[2] = {grid.x0 + k % NX * grid.dx, grid.y0 + k / NX * grid.dy};
        const double hi[2] = {lo[0] + grid.dx, lo[1] + grid.dy};
        double moment[2][2] = {{0.0}};
        for (size_t i = 0; i < n; i++) {
            cross(&c[i], lo, hi, moment);
            bool wall = true;
            for (int g = 0; g < GRAINS && wall; g++)
                wall = states[g].x != c[i].x_b || states[g].y != c[i].y_b;
            if (!wall || c[i].x_b < lo[0] || c[i].x_b >= hi[0] || c[i].y_b < lo[1] || c[i].y_b >= hi[1])
                continue;
            const double f[2] = {c[i].fx, c[i].fy}, at[2] = {c[i].x_b, c[i].y_b};
            for (int a = 0; a < 2; a++)
                for (int b = 0; b < 2; b++) moment[a][b] -= f[a] * at[b];
        }
        for (int i = 0; i < GRAINS; i++) {
            const dem_state *g = &states[i];
            if (g->x < lo[0] || g->x >= hi[0] || g->y < lo[1] || g->y >= hi[1]) continue;
            const double by_contacts[2] = {g->fx, g->fy + g->m * 981.0}, at[2] = {g->x, g->y};
            for (int a = 0; a < 2; a++)
                for (int b = 0; b < 2; b++) moment[a][b] += by_contacts[a] * at[b];
        }
        const double area = grid.dx * grid.dy, *v = &s[k].xx;
        for (int ab = 0; ab < 4; ab++) {
            CHECK_NEAR(area * v[ab], moment[ab / 2][ab % 2], rounding);
            total[ab / 2][ab % 2] += area * v[ab];
        }
    }
    for (size_t i = 0; i < n; i++) {
        const double f[2] = {c[i].fx, c[i].fy}, l[2] = {c[i].x - c[i].x_b, c[i].y - c[i].y_b};
        for (int ab = 0; ab < 4; ab++) sum[ab / 2][ab % 2] += f[ab / 2] * l[ab % 2];
    }
    for (int ab = 0; ab < 4; ab++) CHECK_NEAR(total[ab / 2][ab % 2], sum[ab / 2][ab % 2], 10.0 * rounding);
}

/* ---- Mohr ---- */

static void test_mohr(void)
{
    scoped_rng *rng = numbers_of(1993, 3);
    for (int k = 0; k < 20; k++) {
        double v[4];
        for (int i = 0; i < 4; i++) v[i] = 0.4 * gsl_rng_uniform(rng);
        const stress_tensor s = {1.0 + v[0], v[1], v[2], 1.0 + v[3]};
        const stress_circle m = stress_mohr(&s);
        double steepest = 0.0, most = 0.0, at = 0.0;
        for (int i = 0; i < 7200; i++) {
            double a = i * M_PI / 7200.0, nx = cos(a), ny = sin(a);
            double tx = s.xx * nx + s.xy * ny, ty = s.yx * nx + s.yy * ny;
            double normal = nx * tx + ny * ty, shear = nx * ty - ny * tx;
            steepest = fmax(steepest, atan(fabs(shear) / normal));
            if (normal > most) at = a;
            most = fmax(most, normal);
        }
        /* a maximum on steps of 4e-4 is low by their square; its position has an error of one step */
        CHECK_PAIRS(1e-6, {m.mobilised, steepest}, {m.pressure + m.shear, most});
        CHECK_NEAR(sin(m.direction - at), 0.0, 5e-4);
        CHECK_NEAR(m.couple, 0.5 * (s.xy - s.yx), tight);
    }
    CU_ASSERT(isnan(stress_mohr(&(stress_tensor){0}).mobilised));
    CHECK_NEAR(stress_mohr(&(stress_tensor){1.0, 0.0, 0.0, -0.2}).mobilised, M_PI_2, 0.0);
    CHECK_NEAR(stress_mohr(&(stress_tensor){1.0, 0.0, 0.0, 3.0}).mobilised, 30.0 * deg, tight);
    CHECK_NEAR(stress_mohr(&(stress_tensor){1.0, 0.0, 0.0, 3.0}).direction, M_PI_2, tight);
}

/* ---- the dip of an ensemble ---- */

enum { BINS = STRESS_DIP_BINS, DIP_PILES = 7 };

/* Every number of an ensemble, from those of its piles. */
static void test_dips(void)
{
    double N[DIP_PILES][BINS], excess[DIP_PILES], of[DIP_PILES], below = 0.0;
    stats_summary all;
    stress_dips d;
    for (int i = 0; i < DIP_PILES; i++) {
        excess[i] = 0.02 * (i * 3 % 7) - 0.05;
        for (int k = 0; k < BINS; k++)
            N[i][k] = 1.0 - 0.004 * (k - 9.5) * (k - 9.5) + 0.02 * ((7 * i + 3 * k) % 5) -
                      (k > 7 && k < 12 ? 0.04 * (i % 3) + 0.3 * (i % 4 == 1) * (k < 10 ? 1.0 : -1.0) : 0.0);
    }
    CHECK_OK(stress_dip_ensemble(DIP_PILES, N[0], excess, 0.05, &d));
    for (int k = 0; k < BINS / 2; k++) {
        for (int i = 0; i < DIP_PILES; i++) of[i] = 0.5 * (N[i][9 - k] + N[i][10 + k]);
        CHECK_OK(stats_mean(DIP_PILES, of, &all));
        CHECK_PAIRS(tight, {d.N[k], all.mean}, {d.N_se[k], all.se});
    }
    for (int i = 0; i < DIP_PILES; i++) {
        double mean = 0.0;
        for (int k = 0; k < BINS; k++) mean += N[i][k] / BINS;
        of[i] =
            (N[i][8] + N[i][9] + N[i][10] + N[i][11] - N[i][6] - N[i][7] - N[i][12] - N[i][13]) / 4.0 / mean;
        below += (of[i] < 0.0) / (double)DIP_PILES;
    }
    CHECK_OK(stats_mean(DIP_PILES, of, &all));
    CU_ASSERT(below > 0.0 && below < 1.0);
    CHECK_PAIRS(tight, {d.middle.mean, all.mean}, {d.middle.se, all.se}, {d.below, below},
                {d.p_value, 2.0 * gsl_cdf_tdist_Q(fabs(all.mean) / all.se, DIP_PILES - 1.0)},
                {d.p_margin, gsl_cdf_tdist_Q((0.05 - fabs(all.mean)) / all.se, DIP_PILES - 1.0)});
    CHECK_OK(stats_mean(DIP_PILES, excess, &all));
    CHECK_PAIRS(tight, {d.excess.mean, all.mean}, {d.excess.se, all.se});
    static const char *const words[] = {"dip",  "dip_within_margin",  "undecided", "none_within_margin",
                                        "peak", "peak_within_margin", "undecided", "none_within_margin"};
    for (int k = 0; k < 8; k++) {
        d.middle.mean = k < 4 ? -0.1 : 0.1, d.p_value = k % 4 < 2 ? 0.049 : 0.05,
        d.p_margin = k % 2 ? 0.049 : 0.05;
        CU_ASSERT_STRING_EQUAL(stress_dip_word(&d, 0.05), words[k]);
    }
}

static void test_bad_grids(void)
{
    stress_contact c = {0.0, 1.0, 0.0, NAN, 0.0, 1.0};
    stress_tensor s[1];
    CHECK_FAILS(stress_cells(1, &c, &(stress_grid){0.0, 0.0, 0.0, 1.0, 1, 1}, s), RP_BAD_INPUT, "0 x 1");
    CHECK_FAILS(stress_cells(1, &c, &(stress_grid){0.0, 0.0, 1.0, 1.0, 0, 1}, s), RP_BAD_INPUT,
                "0 x 1 cells");
    CHECK_FAILS(stress_cells(1, &c, &(stress_grid){0.0, 0.0, 1.0, 1.0, 1, 1}, s), RP_BAD_INPUT, "contact 1");
}

/* ---- the protocol ---- */

static double output(const sweep_result *r, const char *name)
{
    return protocol_output(protocol_of(&sweep_protocol_stress), r, name);
}

/* A small pile: force balance, and the response at the measured tilts. */
static void test_protocol(void)
{
    const sweep_protocol *p = protocol_of(&sweep_protocol_stress);
    /* with this friction it is stable at 4 degrees */
    scoped void *params = PROTOCOL_PARAMS(p, "W=2.0", "H=2.0", "mu=0.4");
    CHECK_OK(p->check(params));
    sweep_result r;
    CHECK_OK(p->run(params, 1993, 2, NULL, &r));
    CU_ASSERT_STRING_EQUAL(r.status, "ok");
    /* at rest no net force exceeds 1e-2 m g, on some 70 grains */
    CHECK_EACH(output(&r, NAME), 1e-2, {"balance_error", 0.0}, {"weight_error", 0.0});
    /* friction without tilt against the response: the curvature of floor forces is below 1 % of the weight */
    const double n_0 = output(&r, "n_0");
    CU_ASSERT(n_0 > 0.3 && n_0 <= 1.01);
    CHECK_NEAR(output(&r, "tilts"), 5.0, 0.0);
    CHECK_NEAR(output(&r, "floor_friction_0"), output(&r, "h_0") / n_0, 0.01);
    CHECK_NEAR(output(&r, "floor_friction_beyond"), 0.0, 0.05);
    /* the floor carries more as the pile tilts away from the wall */
    CU_ASSERT(output(&r, "h_1") > 0.0 && output(&r, "floor_friction_0") > 0.0);
}

/* Protocol onset has the pile of protocol stress, with the forces on its floor. Its second tilt is the first
 * one: where that has ended, 5 % of the grains have moved, those of no zone by more than all. */
static void test_onset(void)
{
    const sweep_protocol *const protocols[] = {&sweep_protocol_stress, &sweep_protocol_onset};
    static const char *const names[] = {"theta_r3_deg", "theta_t_displacement_deg", "floor_friction_0",
                                        "grains", "bulk_friction_0"};
    double v[2][5], moved = 0.0, sum = 0.0;
    int zones = 0;
    sweep_result r;
    for (int k = 0; k < 2; k++) {
        const sweep_protocol *p = protocol_of(protocols[k]);
        scoped void *params = PROTOCOL_PARAMS(p, "W=2.0", "H=2.0");
        CHECK_OK(p->run(params, 1993, 2, NULL, &r));
        CU_ASSERT_STRING_EQUAL(r.status, "ok");
        for (size_t j = 0; j < 5; j++) v[k][j] = protocol_output(p, &r, names[j]);
    }
    for (size_t j = 0; j < 5; j++) CHECK_NEAR(v[1][j], v[0][j], 1e-12);
    const sweep_protocol *p = protocol_of(&sweep_protocol_onset);
    for (int i = 0; p->outputs[i].name; i++) {
        if (strncmp(p->outputs[i].name, "limit_", 6) == 0 && !isnan(r.values[i]))
            CU_ASSERT(r.values[i] >= 0.0 && r.values[i] <= 1.0);
        if (strncmp(p->outputs[i].name, "moved_", 6) != 0 || isnan(r.values[i])) continue;
        moved = fmax(moved, r.values[i]);
        sum += r.values[i];
        zones++;
    }
    CU_ASSERT(moved >= 0.05 && moved <= 1.0 && sum < 0.5 * zones); /* most grains have not */
    CU_ASSERT(protocol_output(p, &r, "limit_inside_4") > protocol_output(p, &r, "limit_inside_0"));
    CU_ASSERT(protocol_output(p, &r, "nonaffine_onset") > protocol_output(p, &r, "nonaffine_half"));
    CU_ASSERT(protocol_output(p, &r, "nonaffine_share_onset") <= 1.0 &&
              protocol_output(p, &r, "theta_steepest_deg") >= v[1][0]);
}

/* Of the grains of a pile that has been turned to theta_deg: displacements in d = 0.2, and by zones the
 * numbers of all and of those that have moved by a tenth of d. Zones: quarters of W = 2, and of each the
 * surface, the inside, the floor. */
enum { ZONES = 12, MOST_GRAINS = 200, CELLS = 10 };
typedef struct {
    size_t n;
    double moves[MOST_GRAINS], all[ZONES], moved[ZONES];
} motion;

static void read_motion(dem_sim *sim, size_t n, const dem_state at[], motion *m)
{
    static dem_state now[MOST_GRAINS];
    double top[CELLS] = {0.0};
    *m = (motion){0};
    CU_ASSERT_FATAL(dem_count(sim) == n);
    CHECK_OK(dem_states(sim, now));
    for (size_t i = 0; i < n; i++)
        if (at[i].x > 0.0 && at[i].x < 2.0) {
            double *t = &top[(int)(at[i].x / 0.2)];
            *t = fmax(*t, at[i].y);
        }
    for (size_t i = 0; i < n; i++) {
        if (!(at[i].x > 0.0 && at[i].x < 2.0)) continue;
        const double depth = top[(int)(at[i].x / 0.2)] - at[i].y;
        const int zone = 3 * (int)(2.0 * at[i].x) + (depth < 0.3 ? 0 : at[i].y < 0.2 ? 2 : 1);
        size_t j = 0;
        while (now[j].id != at[i].id) j++;
        const double moves = hypot(now[j].x - at[i].x, now[j].y - at[i].y) / 0.2;
        m->moves[m->n++] = moves;
        m->all[zone]++;
        m->moved[zone] += moves > 0.1;
    }
}

/* Straight lines through the highest centres of cells, less d/2: of the halves, and the steepest of all
 * through four neighbours of the ten. */
static void check_lines(size_t n, const dem_state at[], const sweep_result *r)
{
    const sweep_protocol *p = protocol_of(&sweep_protocol_onset);
    double x[CELLS], h[CELLS] = {0.0}, theta_deg[CELLS], steepest = -90.0, unused;
    for (size_t i = 0; i < n; i++)
        if (at[i].x > 0.0 && at[i].x < 2.0) {
            double *top = &h[(int)(at[i].x / 0.2)];
            *top = fmax(*top, at[i].y - 0.1);
        }
    for (int k = 0; k < CELLS; k++) x[k] = 0.2 * k;
    for (int k = 0; k <= CELLS - 4; k++) {
        double slope;
        gsl_fit_linear(x, 1, h + k, 1, 4, &unused, &slope, &unused, &unused, &unused, &unused);
        steepest = fmax(steepest, -atan(slope) / deg);
        if (k > CELLS - 5) continue;
        gsl_fit_linear(x, 1, h + k, 1, 5, &unused, &slope, &unused, &unused, &unused, &unused);
        theta_deg[k] = -atan(slope) / deg;
    }
    CHECK_EACH(protocol_output(p, r, NAME), 1e-9, {"theta_steepest_deg", steepest},
               {"theta_upper_deg", theta_deg[0]}, {"theta_lower_deg", theta_deg[5]});
}

/* Of the pile at rest: grains that nothing holds, and contacts whose spring is at mu N, by hand. */
static void check_limits(const dem_sim *sim, size_t n, const dem_state at[], const sweep_result *r)
{
    static const char *const names[] = {"limit_floor_0", "limit_wall_0", "limit_inside_0"};
    const sweep_protocol *p = protocol_of(&sweep_protocol_onset);
    double grains = 0.0, loose = 0.0, of[3] = {0.0}, slide[3] = {0.0}, force = 0.0, held = 0.0;
    for (size_t i = 0; i < n; i++)
        if (at[i].x > 0.0 && at[i].x < 2.0) grains++, loose += at[i].contacts < 2;
    CHECK_NEAR(protocol_output(p, r, "rattlers"), loose / grains, tight);
    size_t n_contacts;
    scoped dem_contact *contacts = grains_contacts(sim, &n_contacts);
    for (const dem_contact *c = contacts; c < contacts + n_contacts; c++) {
        if (!(c->x > 0.0 && c->x < 2.0)) continue;
        const int where = c->id_b ? 2 : c->wall == DEM_BOX_FLOOR ? 0 : 1;
        const bool slides = 1e4 * fabs(c->shear_spring) >= 0.999 * 0.2 * c->normal_force;
        of[where]++, slide[where] += slides;
        force += c->normal_force, held += slides ? c->normal_force : 0.0;
    }
    for (int k = 0; k < 3; k++)
        if (of[k] > 0.0) CHECK_NEAR(protocol_output(p, r, names[k]), slide[k] / of[k], tight);
    CHECK_NEAR(protocol_output(p, r, "limit_force_0"), held / force, tight);
}

/* The grains that have moved at the tilting angle, zone by zone, and how far they have at one degree, from
 * the same pile tilted by hand. */
static void check_motion(unsigned long pile, const sweep_result *r)
{
    static const char *const layers[] = {"surface", "inside", "floor"};
    const sweep_protocol *p = protocol_of(&sweep_protocol_onset);
    const double theta_deg = protocol_output(p, r, "theta_t_displacement_deg");
    dem_state at[MOST_GRAINS];
    const sweep_protocol *filled = protocol_of(&sweep_protocol_repose);
    scoped void *params = PROTOCOL_PARAMS(filled, "W=2.0", "H=1.0");
    scoped_sim *sim = NULL;
    sweep_result same;
    motion m;
    CHECK_OK(filled->run(params, 1993, pile, NULL, &same));
    const double steps[] = {protocol_output(filled, &same, "fill_steps_used"),
                            protocol_output(filled, &same, "relax_steps_used")};
    protocol_box(2.0, 1.0, (long)pile, steps, &sim);
    const size_t n = dem_count(sim);
    CU_ASSERT_FATAL(n <= MOST_GRAINS && theta_deg > 1.0);
    CHECK_OK(dem_states(sim, at));
    check_lines(n, at, r);
    check_limits(sim, n, at, r);
    dem_gravity_turn(sim, 0.01 * deg);
    CHECK_OK(dem_run(sim, 100));
    read_motion(sim, n, at, &m);
    gsl_sort(m.moves, 1, m.n);
    CHECK_NEAR(protocol_output(p, r, "reach_probe"), m.moves[(int)floor(0.95 * ((double)m.n - 1.0))], tight);
    CHECK_OK(dem_run(sim, lround(100.0 * theta_deg) - 100));
    read_motion(sim, n, at, &m);
    for (int zone = 0; zone < ZONES; zone++) {
        const double share = protocol_output(p, r, check_text("moved_%s_%d", layers[zone % 3], zone / 3 + 1));
        CU_ASSERT(m.all[zone] > 0.0 ? fabs(share - m.moved[zone] / m.all[zone]) < tight : isnan(share));
    }
}

static void test_motion(void)
{
    const sweep_protocol *p = protocol_of(&sweep_protocol_onset);
    scoped void *box = PROTOCOL_PARAMS(p, "W=2.0", "H=1.0", "tilt_rate_deg=0.01");
    static const unsigned long piles[] = {0, 1, 2, 19, 38}; /* the last: steepest at the wall */
    for (size_t k = check_fast() ? 3 : 0; k < sizeof piles / sizeof *piles; k++) {
        sweep_result r;
        CHECK_OK(p->run(box, 1993, piles[k], NULL, &r));
        if (strcmp(r.status, "ok") == 0 && protocol_output(p, &r, "theta_t_displacement_deg") > 1.0)
            check_motion(piles[k], &r);
    }
}

/* Slope 30 degrees, rays of 60: t^2/k = 1/9. H/N at a slope theta_MS of (3), tan theta_MS = mu tan^2 phi, is
 * mu. */
static void wedge(void)
{
    double n, h;
    stress_wedge(8.0, M_PI / 6.0, M_PI / 3.0, &n, &h);
    CHECK_PAIRS(1e-13, {n, 9.0}, {h, 9.0 / sqrt(27.0)});
    stress_wedge(3.7, 0.0, 0.9, &n, &h);
    CU_ASSERT(n == 3.7 && h == 0.0);
    const double mu = 0.37, phi = 0.97;
    stress_wedge(1.0, atan(mu * tan(phi) * tan(phi)), phi, &n, &h);
    CHECK_NEAR(h / n, mu, 1e-14);
    stress_wedge(1.0, phi, phi, &n, &h); /* as steep as the rays: none leaves through the flank */
    CU_ASSERT(isnan(n) && isnan(h));
}

CHECK_SUITE(stress, "stress", test_column, test_grids, test_floor, test_hydrostatic, test_triangle,
            test_momentum, test_mohr, wedge, test_dips, test_bad_grids, test_protocol, test_onset,
            test_motion)
