/* Grains that leave the scene: in a large pile, where gaps are closed later, with the bits of a small one. */
#include "dem/list/list.h"
#include "tests/grains.h"

/* The grains in the same order, and the same pairs in the same order. */
static bool same_order(const dem_sim *a, const dem_sim *b)
{
    bool same = a->grains.n == b->grains.n && a->pairs.n == b->pairs.n &&
                a->walls.n_slots == b->walls.n_slots && a->grains.n_fixed == b->grains.n_fixed;
    for (size_t i = 0; same && i < a->grains.n; i++) same = a->grains.id[i] == b->grains.id[i];
    for (size_t i = 0; same && i < a->grains.n_fixed; i++) same = a->grains.fixed[i] == b->grains.fixed[i];
    for (size_t k = 0; same && k < a->pairs.n; k++)
        same = a->pairs.i[k] == b->pairs.i[k] && a->pairs.j[k] == b->pairs.j[k] &&
               a->pairs.radii[k] == b->pairs.radii[k] &&
               dem_touches(&a->pairs, k) == dem_touches(&b->pairs, k) &&
               (!dem_touches(&a->pairs, k) || a->pairs.spring[k] == b->pairs.spring[k]);
    for (size_t k = 0; same && k < a->walls.n_slots; k++)
        same = a->walls.slot[k].grain == b->walls.slot[k].grain;
    return same;
}

static long settling(void)
{
    return check_fast() ? 1000 : 3000;
}

/* A pile that settles in a box, on a floor with fixed grains; then the box is open on the right. */
static dem_definition stream(dem_grain **grains)
{
    dem_definition def = grains_box(600, 6.0, 9, grains);
    for (size_t i = 0; i < def.n_grains; i++) (*grains)[i].fixed = i % 60 == 7;
    def.walls[DEM_BOX_RIGHT].open_at_step = settling(), def.x_max = 6.5, def.dt = 4e-5;
    return def;
}

/* Its right half moves to the right, where it leaves. The left half rests at a wall. */
static void push(dem_sim *sim)
{
    for (size_t i = 0; i < sim->grains.n; i++)
        if (!dem_is_fixed(sim, i) && sim->grains.motion[i].x[0] > 2.5) sim->grains.motion[i].v[0] = 400.0;
}

static bool same_ledger(const dem_sim *a, const dem_sim *b)
{
    dem_ledger l = {0}, m = {0};
    return dem_ledger_read(a, &l) == dem_ledger_read(b, &m) && memcmp(&l, &m, sizeof l) == 0;
}

/* Runs of many lengths: at once, later, and later with threads. */
static void compare(const dem_definition *def, long steps)
{
    enum { RUNS = 3 };
    static const size_t chunk[RUNS] = {0, 64, 64}, threads[RUNS] = {1, 1, 3};
    dem_sim *sim[RUNS];
    for (int k = 0; k < RUNS; k++) {
        sim[k] = grains_start_in_chunks(def, chunk[k]);
        dem_threads(sim[k], threads[k]);
        CHECK_OK(dem_run(sim[k], settling()));
        push(sim[k]);
    }
    for (long step = 0, length = 1; step < steps; step += length, length = length % 50 + 7)
        for (int k = 0; k < RUNS; k++) {
            CHECK_OK(dem_run(sim[k], length));
            CU_ASSERT(sim[k]->grains.n_gone == 0 && grains_same_bits(sim[0], sim[k]));
            CU_ASSERT(same_order(sim[0], sim[k]) && sim[0]->count.rebuilds == sim[k]->count.rebuilds);
            CU_ASSERT(sim[0]->count.grain_steps == sim[k]->count.grain_steps && same_ledger(sim[0], sim[k]));
            for (size_t w = 0; w < def->n_walls; w++)
                CU_ASSERT(memcmp(&sim[0]->walls.force[w], &sim[k]->walls.force[w], sizeof(dem_vec)) == 0);
        }
    CU_ASSERT(dem_count(sim[0]) + 30 < def->n_grains && dem_count(sim[0]) > 100);
    for (int k = 0; k < RUNS; k++) dem_free(sim[k]);
}

static void streams(void)
{
    dem_grain *grains;
    dem_definition def = stream(&grains);
    compare(&def, check_fast() ? 150 : 300);
    def.rotation = true;
    compare(&def, check_fast() ? 150 : 300);
    /* which keep grains from their next step until all forces are there */
    def.turn_per_step = 1e-4, def.turn_from_step = settling();
    compare(&def, 150);
    def.turn_per_step = 0.0, def.walls[DEM_BOX_LEFT].velocity[0] = -5.0;
    compare(&def, 150);
}

/* What closes gaps at once, also in a large pile. */
static void at_once(void)
{
    dem_grain *grains;
    for (int k = 0; k < 4; k++) {
        dem_definition def = stream(&grains);
        if (k == 0) def.hard = (dem_hard){.on = true, .restitution = 0.1, .mu = 0.2}, def.tension = false;
        if (k == 1) def.ledger = true;
        if (k == 2) def.integrator = DEM_GEAR5, def.dt *= 0.5;
        if (k == 3) {
            def.box_turn_per_step = 2e-5;
            for (size_t i = 0; i < def.n_grains; i++) grains[i].fixed = false;
        }
        compare(&def, 150);
    }
}

/* One by one and several at once, among them the last grain and one that would have taken another's place;
 * then a long time without a rebuilding. */
static void order(void)
{
    static const int leave[][3] = {{3, -1, -1}, {10, 150, 11}, {-2, 40, -1}, {199, 0, -1}, {30, 31, 198}};
    enum { N = 200, DROPS = sizeof leave / sizeof *leave };
    dem_definition def = grains_box(N, 4.0, 3, NULL);
    def.x_max = 10.0;
    scoped_sim *now = grains_start_in_chunks(&def, 0), *later = grains_start_in_chunks(&def, 64);
    CHECK_OK(dem_run(now, 8000));
    CHECK_OK(dem_run(later, 8000));
    CHECK_OK(dem_neighbours_rebuild(now));
    CHECK_OK(dem_neighbours_rebuild(later));
    size_t n = N;
    CU_ASSERT(now->pairs.n_chunks == 0 && later->pairs.n_chunks > 0);
    for (int d = 0; d < DROPS; d++) {
        for (int k = 0; k < 3; k++) {
            /* by the present order of `now`; -2: the last of `later`'s arrays */
            const int at = leave[d][k];
            const uint32_t id = at == -2 ? later->grains.id[N - 1]
                                : at < 0 ? 0
                                         : now->grains.id[(size_t)at % n];
            for (size_t i = 0; i < n; i++)
                if (now->grains.id[i] == id) now->grains.motion[i].x[0] = 11.0;
            for (size_t i = 0; i < N; i++)
                if (later->grains.id[i] == id && later->grains.motion[i].x[1] < 100.0) {
                    later->grains.motion[i].x[0] = 11.0;
                    later->grains.slack[i / DEM_GROUP] = DEM_SLACK_OUT;
                }
        }
        double listed_y[N];
        for (size_t i = 0; i < N; i++) listed_y[i] = later->grains.listed_x[i][1];
        dem_neighbours_drop(now);
        const double skin = later->list.skin;
        later->list.skin = 10.0 * (d + 1); /* any unit of length */
        dem_neighbours_drop(later);
        for (size_t k = N - n; k < later->grains.n_fixed; k++) { /* beyond the reach of its listed pairs */
            const uint32_t i = later->grains.fixed[k];
            CU_ASSERT(later->grains.motion[i].x[1] - listed_y[i] >
                      7.0 * later->r_max + 1.5 * later->list.skin);
        }
        later->list.skin = skin;
        n = now->grains.n;
        CU_ASSERT(now->grains.n_gone == 0 && later->grains.n == N && later->grains.n_gone == N - n &&
                  later->grains.n_fixed == N - n);
        CU_ASSERT(later->pairs.n_chunks > 0 && later->walls.n_slots == now->walls.n_slots);
    }
    CU_ASSERT(n <= N - DROPS);
    dem_neighbours_close_gaps(later);
    CU_ASSERT(same_order(now, later) && grains_same_bits(now, later));
    CU_ASSERT(later->pairs.n_chunks == 0 && later->grains.n_gone == 0);
}

/* A grain that left stays where it is, and the list as it is, however long the others are at rest. */
static void rest(void)
{
    dem_definition def = grains_box(600, 6.0, 3, NULL);
    def.dt = 4e-5, def.damping = DEM_DAMPING_OUTSIDE; /* which settles it sooner */
    scoped_sim *sim = grains_start_in_chunks(&def, 64);
    CHECK_OK(dem_run(sim, 20000));
    scoped_sim *twin = NULL;
    CHECK_OK(dem_clone(sim, &twin));
    twin->pairs.chunk = 1 << 20;
    CHECK_OK(dem_neighbours_rebuild(sim));
    CHECK_OK(dem_neighbours_rebuild(twin));
    sim->def.x_max = twin->def.x_max = 5.89; /* passed by few, at the first step */
    const long before = sim->count.rebuilds;
    const size_t before_n = dem_count(sim);
    CU_ASSERT(sim->pairs.n_chunks > 0 && twin->pairs.n_chunks == 0);
    CHECK_OK(dem_run(sim, 4000));
    CHECK_OK(dem_run(twin, 4000));
    CU_ASSERT(before_n - dem_count(sim) > 2 && before_n - dem_count(sim) < 30);
    CU_ASSERT(sim->count.rebuilds == twin->count.rebuilds && sim->count.rebuilds - before < 60);
    CU_ASSERT(grains_same_bits(sim, twin));
}

CHECK_SUITE(removal, "removal", streams, at_once, order, rest)
