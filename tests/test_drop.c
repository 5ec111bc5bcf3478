/* Dropped piles: initial contacts of a simulation, protocol `drop`, and the dip. */
#include <float.h>

#include "stress/stress.h"
#include "core/random.h"
#include "dem/list/list.h"
#include "tests/numbers.h"
#include "tests/protocol.h"
#include "tests/grains.h"

/* Disks of diameter and mass 1 in unit gravity, above a ground: wells, or shear springs. */
static dem_definition disks(bool spring, size_t n, const dem_grain *grains)
{
    dem_definition def = grains_of(n, grains);
    def.gravity[1] = -1.0;
    def.dt = 0.006;
    def.normal = DEM_LINEAR;
    def.tension = false;
    def.rotation = true;
    def.shape = DEM_DISK;
    def.damping = DEM_DAMPING_INSIDE;
    def.tangential = spring ? DEM_SPRING : DEM_SLIP_ROLL;
    def.material = (dem_material){.k_n = 1000.0, .gamma_n = 18.0, .k_s = 500.0, .gamma_s = 9.0, .mu = 0.5};
    def.material.mu_roll = 0.1;
    def.material.k_roll = 500.0;
    def.material.gamma_roll = 9.0;
    def.hard = (dem_hard){true, 0.5, 0.5};
    def.n_walls = 1;
    def.walls[0] = grains_line(0.0, 0.0, 0.0, 1.0, &def.material);
    if (!spring) def.ground = (dem_ground){1, 0.5, 0.05, DEM_WELL_AGAIN};
    return def;
}

static dem_grain disk(double x, double y, double vx)
{
    return (dem_grain){.x = x, .y = y, .r = 0.5, .m = 1.0, .vx = vx};
}

/* ---- Initial contacts ---- */

enum { HEAP = 6 };

/* A pile that slides and rolls. */
static dem_sim *moving_pile(bool spring)
{
    const dem_grain grains[HEAP] = {disk(0.0, 0.5, 0.1),  disk(1.01, 0.5, 0.0), disk(2.02, 0.5, -0.2),
                                    disk(0.52, 1.4, 0.0), disk(1.53, 1.4, 0.3), disk(1.0, 2.4, 0.0)};
    dem_definition def = disks(spring, HEAP, grains);
    return grains_after(&def, 150);
}

/* A new simulation of the same state, with or without its contacts, in ascending or descending ids. */
static dem_sim *again(const dem_sim *sim, bool spring, bool with, bool turned)
{
    dem_grain grains[HEAP] = {{0}};
    dem_definition def = disks(spring, HEAP, grains);
    size_t n;
    scoped dem_contact *contacts = grains_contacts(sim, &n);
    scoped dem_state *states = grains_states(sim);
    for (size_t i = 0; i < HEAP; i++) {
        const dem_state *s = &states[turned ? HEAP - 1 - i : i];
        grains[i] = (dem_grain){s->x, s->y, s->r, s->m, s->vx, s->vy, s->angle, s->omega, false};
    }
    for (size_t k = 0; k < n && turned; k++) {
        const uint32_t a = HEAP + 1 - contacts[k].id_a, b = HEAP + 1 - contacts[k].id_b;
        contacts[k].id_a = contacts[k].id_b ? b : a; /* seen from the other side */
        if (!contacts[k].id_b) continue;
        contacts[k].id_b = a;
        contacts[k].rolling_spring = -contacts[k].rolling_spring;
    }
    def.contacts = contacts;
    def.n_contacts = with ? n : 0;
    return grains_start(&def);
}

/* Largest difference of net force or torque between two simulations of the pile. */
static double differ(const dem_sim *a, const dem_sim *b, bool turned)
{
    scoped dem_state *s = grains_states(a), *t = grains_states(b);
    double most = 0.0;
    for (size_t i = 0; i < HEAP; i++) {
        const dem_state *u = &t[turned ? HEAP - 1 - i : i];
        most = fmax(most, fabs(s[i].fx - u->fx) + fabs(s[i].fy - u->fy) + fabs(s[i].torque - u->torque));
    }
    return most;
}

/* Springs, rolling springs and wells continue: forces are unchanged, except for damping, which uses
 * velocities half a step later: gamma m_eff a dt/2 = 0.027 a per contact, a below g. Without initial contacts
 * the forces differ far more. */
static void contacts_go_on(void)
{
    for (int spring = 0; spring < 2; spring++) {
        scoped_sim *sim = moving_pile(spring);
        CHECK_NEAR(differ(sim, sim, false), 0.0, 0.0);
        size_t n;
        double sheared = 0.0, rolled = 0.0, wells = 0.0;
        scoped dem_contact *contacts = grains_contacts(sim, &n);
        for (size_t k = 0; k < n; k++) {
            sheared = fmax(sheared, fabs(contacts[k].shear_spring));
            rolled = fmax(rolled, fabs(contacts[k].rolling_spring));
            wells += contacts[k].well == DEM_WELL_HOLDS;
        }
        CU_ASSERT(sheared > 1e-5 && rolled > 1e-5 && (spring || wells > 0.0));
        for (int turned = 0; turned < 2; turned++) {
            scoped_sim *with = again(sim, spring, true, turned), *without = again(sim, spring, false, turned);
            CHECK_NEAR(differ(sim, with, turned), 0.0, 0.1);
            CU_ASSERT(differ(sim, without, turned) > 5.0 * differ(sim, with, turned));
        }
    }
}

/* ---- The dip ---- */

static void base_of_known_loads(void)
{
    enum { N = 400 };
    double x[N], r[N], load[N];
    for (int i = 0; i < N; i++) { /* even load over (3, 7) */
        x[i] = 3.0 + (i + 0.5) * 4.0 / N;
        r[i] = 0.5 * 4.0 / N;
        load[i] = 2.0;
    }
    stress_base base;
    CHECK_OK(stress_base_profile(N, x, r, load, &base));
    CHECK_NEAR(base.centroid, 5.0, 1e-12);
    CHECK_NEAR(base.width, 0.98 * 4.0, 2.1 * 4.0 / N);
    for (int k = 0; k < STRESS_DIP_BINS; k++) CHECK_NEAR(base.N[k], 1.0, 1e-9);
    CHECK_NEAR(stress_dip(base.N), 0.0, 1e-9);
    for (int i = 0; i < N; i++) load[i] = 2.0 - fabs(x[i] - 5.0); /* triangle: 2 B of the load is 0.98 */
    CHECK_OK(stress_base_profile(N, x, r, load, &base));
    const double h = 2.0 * (1.0 - sqrt(0.02)), B = 2.0 * h; /* 1 - (1 - h/2)^2 = 0.98 */
    CHECK_NEAR(base.width, B, 2.1 * 4.0 / N);
    CHECK_NEAR(stress_dip(base.N), 0.15 * B / (0.5 * (2.0 + 2.0 - h)),
               2e-3); /* N(0.05 B) - N(0.2 B), over mean */
    for (int i = 0; i < N; i++) load[i] = 0.0;
    CHECK_FAILS(stress_base_profile(N, x, r, load, &base), RP_NO_RESULT, "no load");
    x[0] = 0.7, load[0] = 0.1; /* whose moment is rounded */
    CHECK_FAILS(stress_base_profile(N, x, r, load, &base), RP_NO_RESULT, "one position");
}

/* Profiles that are even up to 0.3 B, with noise in each bin; the excess is that of the middle. */
enum { PILES = 60 };
static const double TOP = 1.25, BIN_NOISE = 0.3;

static double even(int k)
{
    return k >= 4 && k < 16 ? TOP : 0.625;
}

static void draw_profiles(gsl_rng *rng, double profiles[PILES * STRESS_DIP_BINS], double excess[PILES])
{
    for (int i = 0; i < PILES; i++) excess[i] = -TOP;
    for (int i = 0; i < PILES * STRESS_DIP_BINS; i++) {
        const int k = i % STRESS_DIP_BINS;
        profiles[i] = even(k) + BIN_NOISE * rp_random_cut_normal(numbers_stream(rng), 0.0, 1.0, -4.0, 4.0);
        if (k >= 8 && k < 12) excess[i / STRESS_DIP_BINS] += profiles[i] / 4.0;
    }
}

/* Other piles, whose N within 0.1 B is lower by the part `depth`. */
static void draw_dips(gsl_rng *rng, double depth, double profiles[PILES * STRESS_DIP_BINS],
                      double excess[PILES])
{
    draw_profiles(rng, profiles, excess);
    for (int i = 0; i < PILES * STRESS_DIP_BINS; i++)
        if (i % STRESS_DIP_BINS >= 8 && i % STRESS_DIP_BINS < 12) {
            excess[i / STRESS_DIP_BINS] -= depth * profiles[i] / 4.0;
            profiles[i] *= 1.0 - depth;
        }
}

/* Without a dip the test alarms in 5 % of the ensembles, and the interval misses the truth in as many. Of 200
 * these are 10 +- 3.1; bounds at 3.3 of these. The middle has the error 0.3 sqrt(1/2)/sqrt(60) = 0.0274 of N,
 * and 0.1 of 1.25 is 4.6 of it: power 0.99; 0.05 is 2.3: 0.62, 0.02 is 0.91: 0.15. */
static void planted_dips(void)
{
    if (CHECK_SKIPS("numbers of code that other tests run under sanitizers")) return;
    enum { ENSEMBLES = 200, DEPTHS = 4 };
    static const double depths[DEPTHS] = {0.0, 0.02, 0.05, 0.1};
    double profiles[PILES * STRESS_DIP_BINS], excess[PILES];
    scoped_rng *rng = numbers_of(9, 0);
    int found[DEPTHS] = {0}, missed = 0, none = 0;
    for (int e = 0; e < ENSEMBLES; e++) {
        stress_dips d;
        for (int k = 0; k < DEPTHS; k++) {
            draw_dips(rng, depths[k], profiles, excess);
            CHECK_OK(stress_dip_ensemble(PILES, profiles, excess, 0.13, &d));
            found[k] += d.p_value < 0.05;
            none += k == 0 && d.p_margin < 0.05;
            missed += k == 3 && !(d.excess.lo <= -0.1 * TOP && -0.1 * TOP <= d.excess.hi);
        }
    }
    CU_ASSERT(found[0] >= 1 && found[0] <= 20 && found[1] > 10 && found[1] < 55);
    CU_ASSERT(found[2] > 95 && found[2] < 160 && found[3] > 190 && missed >= 1 && missed <= 20);
    CU_ASSERT(none > 180);
}

static void bad_ensembles(void)
{
    double profiles[4 * STRESS_DIP_BINS], excess[4] = {0.0};
    stress_dips d;
    for (int i = 0; i < 4 * STRESS_DIP_BINS; i++) profiles[i] = 1.0;
    CHECK_OK(stress_dip_ensemble(4, profiles, excess, 0.1, &d));
    CHECK_NEAR(d.below_se, sqrt(1.0 / 6.0 * 5.0 / 6.0 / 4.0), 1e-14); /* with a pile more on either side */
    CHECK_FAILS(stress_dip_ensemble(2, profiles, excess, 0.1, &d), RP_NO_RESULT, "at least 3");
    CHECK_FAILS(stress_dip_ensemble(4, profiles, excess, 0.0, &d), RP_BAD_INPUT, "margin = 0");
    excess[1] = NAN;
    CHECK_FAILS(stress_dip_ensemble(4, profiles, excess, 0.1, &d), RP_BAD_INPUT, "finite");
}

/* ---- The protocol ---- */

static double output(const sweep_result *r, const char *name)
{
    return protocol_output(protocol_of(&sweep_protocol_drop), r, name);
}

static sweep_result run(const char *settings)
{
    const sweep_protocol *drop = protocol_of(&sweep_protocol_drop);
    scoped void *p = PROTOCOL_PARAMS(drop, settings);
    sweep_result result;
    CHECK_OK(drop->check(p));
    CHECK_OK(drop->run(p, 5, 1, NULL, &result));
    return result;
}

/* The base carries the weight of the pile, to the accuracy of rest; a second run has the same bits. */
static void piles_stand(void)
{
    static const char *const piles[] = {"N=40 law=slip_roll radius_width=0",
                                        "N=40 law=spring radius_width=0.05"};
    for (int k = 0; k < 2; k++) {
        sweep_result a = run(piles[k]), b = run(piles[k]);
        CU_ASSERT_STRING_EQUAL(a.status, "ok");
        CU_ASSERT(memcmp(a.values, b.values, sizeof a.values) == 0);
        CHECK_NEAR(output(&a, "balance"), 0.0, 1e-6);
        CHECK_NEAR(output(&a, "disks") + output(&a, "away"), 40.0, 0.0);
        double sum = 0.0;
        for (int i = 1; i <= 20; i++) sum += output(&a, check_text("n_%02d", i));
        CHECK_NEAR(sum, 20.0, 1e-9);
        CU_ASSERT(output(&a, "height") > 3.0 && output(&a, "height") < 10.0);
        CU_ASSERT(output(&a, "psi6") > 0.0 && output(&a, "psi6") <= 1.0);
    }
}

static void drops_do_not_pass_their_steps(void)
{
    sweep_result r = run("N=40 max_steps=100 mu=1 mu_roll=0.3");
    CU_ASSERT_STRING_EQUAL(r.status, "drops_not_quiet");
    CHECK_NEAR(output(&r, "steps"), 40.0 * 100.0, 0.0);
}

/* Two unfinished drops of twenty invalidate a pile; outputs are kept, and tell how many there were. */
static void cut_drops_are_no_result(void)
{
    for (int k = 0; k < 2; k++) {
        sweep_result r = run(k == 0 ? "N=40 max_steps=200" : "N=20 max_steps=600");
        CHECK_NEAR(output(&r, "capped_share"), k == 0 ? 0.75 : 0.1, k == 0 ? 0.25 : 1e-12);
        CU_ASSERT_STRING_EQUAL(r.status, "drops_not_quiet");
        CU_ASSERT_STRING_EQUAL(r.message,
                               k == 0 ? "phase drop, after 200 steps" : "phase drop, after 600 steps");
        CU_ASSERT(isfinite(output(&r, "dip")) && isfinite(output(&r, "left_deg")));
    }
}

/* Not a pile: a single row of disks, at rest or not; two rows, although they have slopes; a tower, which has
 * none; no disks, after all rolled away. */
static void layers_are_no_piles(void)
{
    static const char *const cases[] = {"N=4", "N=12", "N=6 source_width=0", "N=40 mu_roll=0 max_steps=200",
                                        "N=2 mu_roll=0 x_limit=10"};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        sweep_result r = run(cases[k]);
        CU_ASSERT_STRING_EQUAL(r.status, "no_pile");
        CU_ASSERT(strstr(r.message, k == 2 ? "one position" : "pile.height < 2") != NULL);
    }
}

/* A stricter criterion of rest takes more steps per drop. */
static void rest_takes_its_steps(void)
{
    double before = 0.0;
    for (int k = 0; k < 2; k++) {
        sweep_result r =
            run(k == 0 ? "N=15 rest_speed=0.1 rest_force=0.1" : "N=15 rest_speed=0.001 rest_force=0.001");
        CU_ASSERT(output(&r, "steps") > 1.1 * before);
        CHECK_NEAR(output(&r, "capped_share"), 0.0, 0.0);
        before = output(&r, "steps");
    }
}

/* Each disk counts, the first too: 300 steps bring one to a speed below 1, none into balance to 1e-9 m g. */
static void every_disk_must_rest(void)
{
    sweep_result loose = run("N=2 rest_speed=1 max_steps=300 rest_force=10"),
                 strict = run("N=2 rest_speed=1 max_steps=300 rest_force=1e-9");
    CHECK_PAIRS(0.0, {output(&loose, "capped_share"), 0.0}, {output(&strict, "capped_share"), 1.0});
}

/* With little rolling resistance disks roll away: they are counted, carry no load and are not of the pile. */
static void away_is_no_part(void)
{
    sweep_result r = run("N=30 mu_roll=0.02 x_limit=10");
    CU_ASSERT(output(&r, "away") > 0.0);
    CHECK_NEAR(output(&r, "disks") + output(&r, "away"), 30.0, 0.0);
    CU_ASSERT(output(&r, "width") < 20.0);
}

/* No contact with the base carries more than its friction, which by default is that of the disks. */
static void base_has_its_friction(void)
{
    sweep_result smooth = run("N=40 mu_base=0.1"), same = run("N=40 mu_base=0.5"), fallback = run("N=40");
    CU_ASSERT(output(&smooth, "shear") > 0.02 && output(&smooth, "shear") < 0.1 + 1e-6);
    CU_ASSERT(output(&fallback, "shear") > 0.1);
    CU_ASSERT(memcmp(same.values, fallback.values, sizeof same.values) == 0);
}

/* The drops, the lattice's disks and its slope: 12 in the base, 30 degrees. */
static void drops_fall_on_the_lattice(void)
{
    sweep_result bare = run("N=0 lattice=12"), more = run("N=5 lattice=12 radius_width=0.01");
    CU_ASSERT_STRING_EQUAL(bare.status, "ok");
    CHECK_NEAR(output(&more, "disks") - output(&bare, "disks"), 5.0, 0.0);
    CHECK_NEAR(output(&bare, "psi6"), 1.0, 1e-3);
    CHECK_NEAR(output(&bare, "steps"), 0.0, 0.0);
    CU_ASSERT(output(&more, "steps") > 0.0 && isnan(output(&bare, "moved_share")));
}

static void lattices_that_fit(void)
{
    static const char *const cases[][2] = {
        {"N=1", "N: without a lattice at least 2"},
        {"lattice=9 radius_width=0.2", "grains of radius 0.8 overlap by more than a tenth"},
        {"lattice=9 glued=1.5", "glued: a lattice lies on"},
        {"lattice=40 x_limit=20", "lattice: reaches to x_limit"}};
    const sweep_protocol *drop = protocol_of(&sweep_protocol_drop);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scoped void *p = PROTOCOL_PARAMS(drop, cases[k][0]);
        CHECK_FAILS(drop->check(p), RP_BAD_INPUT, cases[k][1]);
    }
}

/* Disks that fall in a row onto a pile, added one by one, with several collisions per step. */
enum { DROPPED = 60 };

static dem_sim *drop_first(int kernel)
{
    const dem_grain first = disk(0.0, 0.6, 0.0);
    dem_definition def = disks(true, 1, &first);
    def.kernel = kernel, def.x_max = 4.0;
    return grains_start(&def);
}

static void drop_next(dem_sim *sim, int k)
{
    dem_grain next = disk(0.7 * (k * 5 % 11 - 5), 11.0 + 0.1 * (k % 3), 0.02 * (k % 7 - 3));
    next.r = 0.5 - 0.05 * (k % 4);
    next.m = 1.0 - 0.1 * (k % 4);
    next.vy = -3.0;
    CHECK_OK(dem_add(sim, &next, NULL));
}

static void dropped(int kernel, dem_state last[DROPPED])
{
    scoped_sim *sim = drop_first(kernel);
    for (int k = 1; k < DROPPED; k++) {
        drop_next(sim, k);
        CHECK_OK(dem_run(sim, 150));
    }
    memset(last, 0, DROPPED * sizeof *last);
    grains_run(sim, 600, last);
    CU_ASSERT(grains_counts(sim).collisions > 5 * DROPPED);
}

/* The reference searches all pairs for collisions, the others only pairs without contact. */
static void kernels_collide_alike(void)
{
    dem_state expected[DROPPED], got[DROPPED];
    dropped(DEM_REFERENCE, expected);
    for (int kernel = DEM_REFERENCE + 1; kernel < DEM_KERNELS; kernel++) {
        if (!dem_kernel_runs(kernel)) continue;
        dropped(kernel, got);
        CU_ASSERT(memcmp(expected, got, sizeof got) == 0);
    }
}

/* The decay of a disk on the ground ends above subnormal numbers, which the caller's arithmetic still has. */
static void tiny_numbers_are_zero(void)
{
    for (int kernel = DEM_REFERENCE; kernel < DEM_KERNELS; kernel++) {
        if (!dem_kernel_runs(kernel)) continue;
        const dem_grain grain = disk(0.0, 0.4995, 1e-300);
        dem_definition def = disks(true, 1, &grain);
        def.kernel = kernel;
        scoped_sim *sim = grains_start(&def);
        bool tiny = false;
        for (int look = 0; look < 400; look++) {
            CHECK_OK(dem_run(sim, 10));
            const dem_wall_slot *slot = &sim->walls.slot[0];
            const double last[] = {sim->grains.motion[0].v[0], sim->grains.motion[0].v[1],
                                   sim->grains.omega[0], slot->spring, slot->roll};
            for (int a = 0; a < 5; a++) tiny |= fpclassify(last[a]) == FP_SUBNORMAL;
        }
        CU_ASSERT(!tiny && fabs(sim->grains.omega[0]) < 1e-305);
        volatile double least = DBL_MIN;
        CU_ASSERT(least / 2.0 > 0.0);
    }
}

/* Each disk has exactly the contacts given by its distances from all others and the ground. */
static void check_contacts(const dem_sim *sim)
{
    scoped dem_state *s = grains_states(sim);
    for (size_t i = 0; i < dem_count(sim); i++) {
        int contacts = s[i].y < s[i].r;
        for (size_t j = 0; j < dem_count(sim); j++) {
            const double dx = s[i].x - s[j].x, dy = s[i].y - s[j].y, reach = s[i].r + s[j].r;
            contacts += i != j && dx * dx + dy * dy < reach * reach;
        }
        CU_ASSERT_EQUAL(s[i].contacts, contacts);
        CHECK_NEAR(sim->grains.cutoff[i], sim->grains.radius[i] + sqrt(sim->grains.margin2[i]), 1e-12);
    }
}

/* The list has, once each, just the pairs, and disks near ground, that can touch within their margins. */
static void check_list(const dem_sim *sim)
{
    unsigned near_ground[DROPPED] = {0};
    bool right = grains_wrong_pairs(sim) == 0;
    for (size_t k = 0; k < sim->walls.n_slots; k++) near_ground[sim->walls.slot[k].grain]++;
    for (size_t i = 0; i < sim->grains.n; i++)
        right &= near_ground[i] == (sim->grains.listed_x[i][1] < sim->grains.cutoff[i]);
    CU_ASSERT(right);
}

/* Partial renewals of the list miss no contact and duplicate none. */
static void lists_are_complete(void)
{
    scoped_sim *sim = drop_first(DEM_FAST);
    for (int k = 1; k < DROPPED; k++) {
        drop_next(sim, k);
        for (int step = 0; step < 150; step++) {
            CHECK_OK(dem_run(sim, 1));
            check_contacts(sim);
            check_list(sim);
        }
    }
    CU_ASSERT(grains_counts(sim).rebuilds < 3 * DROPPED);
}

/* True if the contacts and springs are equal, in any order. */
static void check_same_contacts(const dem_sim *one, const dem_sim *two)
{
    size_t n, m, same = 0;
    scoped dem_contact *a = grains_contacts(one, &n), *b = grains_contacts(two, &m);
    for (size_t k = 0; k < n * m; k++) {
        const dem_contact *p = &a[k / m], *q = &b[k % m];
        const bool turned = p->id_a == q->id_b;
        same += ((p->id_a == q->id_a && p->id_b == q->id_b) || (turned && p->id_b == q->id_a)) &&
                p->shear_spring == q->shear_spring &&
                p->rolling_spring == (turned ? -q->rolling_spring : q->rolling_spring);
    }
    CU_ASSERT(n == m && n == same);
}

/* A partial renewal, and a full rebuild after it, keep contacts and springs. */
static void renewed_lists_hold_springs(void)
{
    enum { EVERY = 15 };
    dem_sim *sim = drop_first(DEM_FAST), *renewed;
    for (int k = EVERY; k < EVERY * DROPPED; k++) {
        if (k % EVERY == 0) drop_next(sim, k / EVERY);
        CHECK_OK(dem_run(sim, 150 / EVERY));
        CHECK_OK(dem_clone(sim, &renewed));
        const long rebuilds = renewed->count.rebuilds;
        for (size_t i = 0; i < renewed->grains.n;
             i++) { /* as if some were to move far, the others not at all */
            renewed->grains.next_motion[i].v = (dem_vec){(i + (size_t)k) % 11 == 0 ? INFINITY : 0.0, 0.0};
            renewed->grains.margin2[i] = 1e300;
        }
        CHECK_OK(dem_neighbours_renew(renewed, false));
        CU_ASSERT(renewed->count.rebuilds == rebuilds);
        for (size_t i = 0; i < renewed->grains.n; i++)
            CU_ASSERT((renewed->grains.margin2[i] < 1e300) == isinf(renewed->grains.next_motion[i].v[0]));
        check_list(renewed);
        check_same_contacts(sim, renewed);
        CHECK_OK(dem_neighbours_rebuild(renewed));
        check_same_contacts(sim, renewed);
        const size_t touching = dem_count_touching(&renewed->pairs);
        for (size_t p = 0; p < touching; p++)
            CU_ASSERT(dem_touches(&renewed->pairs, p)); /* they come first */
        renewed->grains.motion[0].x[1] = NAN;
        CHECK_FAILS(dem_neighbours_renew(renewed, false), RP_BROKEN, "not finite");
        dem_free(renewed);
    }
    dem_free(sim);
}

/* Any fall of the range runs: its speed limits the time step. With eps = 2e-3 alone, 0.0242 is the step, and
 * a fall of 250 d goes 0.54 d in it. */
static void great_heights(void)
{
    const sweep_protocol *drop = protocol_of(&sweep_protocol_drop);
    static const char *const heights[] = {"drop_height=250", "drop_height=1000"};
    for (int k = 0; k < 2; k++) {
        scoped void *params = PROTOCOL_PARAMS(drop, "N=4", heights[k], "x_limit=10000");
        sweep_result result = {0};
        rp_status status = drop->run(params, 1992, 0, NULL, &result);
        CU_ASSERT(status == RP_OK || status == RP_NO_RESULT);
        CU_ASSERT_STRING_EQUAL(result.status, "no_pile"); /* of four disks */
    }
}

CHECK_SUITE(drop, "drop", contacts_go_on, base_of_known_loads, planted_dips, bad_ensembles, great_heights,
            piles_stand, drops_do_not_pass_their_steps, cut_drops_are_no_result, layers_are_no_piles,
            rest_takes_its_steps, every_disk_must_rest, away_is_no_part, base_has_its_friction,
            drops_fall_on_the_lattice, lattices_that_fit, kernels_collide_alike, tiny_numbers_are_zero,
            lists_are_complete, renewed_lists_hold_springs)
