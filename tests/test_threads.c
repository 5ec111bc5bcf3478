/* Threads in one pile: a run has the same bits with any number of them. */
#include "dem/state/state.h"
#include "tests/grains.h"
#include "tests/program.h"

/* all that a simulation continues from: also forces, springs, and the order of the lists. */
static bool same_state(dem_sim *a, dem_sim *b)
{
    rp_snapshot s[2] = {{0}, {0}};
    dem_keep(&s[0], &a);
    dem_keep(&s[1], &b);
    CHECK_OK(s[0].status);
    CHECK_OK(s[1].status);
    const bool same = s[0].n == s[1].n && memcmp(s[0].bytes, s[1].bytes, s[0].n) == 0;
    rp_snapshot_free(&s[0]);
    rp_snapshot_free(&s[1]);
    return same;
}

static dem_sim *start(const dem_definition *def, size_t threads)
{
    dem_sim *sim = grains_start_in_chunks(def, 64);
    dem_threads(sim, threads);
    return sim;
}

/* Some parts of a run, with 1 thread and more. */
static void compare(const dem_definition *def, int parts, long steps)
{
    static const size_t MORE[] = {2, 3, 8};
    dem_sim *one = start(def, 1), *sim[3];
    for (int m = 0; m < 3; m++) sim[m] = start(def, MORE[m]);
    for (int k = 0; k < parts; k++) {
        CHECK_OK(dem_run(one, steps));
        for (int m = 0; m < 3; m++) {
            CHECK_OK(dem_run(sim[m], steps));
            CU_ASSERT(same_state(one, sim[m]));
        }
    }
    dem_free(one);
    for (int m = 0; m < 3; m++) dem_free(sim[m]);
}

static void avalanche(void)
{
    const long part = check_fast() ? 100 : 1500;
    dem_definition def = grains_box(1200, 6.0, 9, NULL);
    def.walls[DEM_BOX_RIGHT].open_at_step = 2 * part;
    compare(&def, 4, part);
}

static void outflows(void)
{
    const long part = check_fast() ? 200 : 500;
    for (int rotation = 0; rotation < 2; rotation++) {
        const dem_definition def = grains_outflow(400, part, rotation);
        compare(&def, 4, part);
    }
}

/* Scenes whose grains wait for all forces: walls that move, gravity or a box that turns; reference kernel. */
static void turning(void)
{
    const long part = check_fast() ? 100 : 250;
    for (int k = 0; k < 4; k++) {
        dem_definition def = grains_box(600, 5.0, 9, NULL);
        if (k == 0) def.walls[DEM_BOX_RIGHT].velocity[0] = -5.0;
        if (k == 1) def.turn_per_step = 1e-4, def.turn_from_step = part;
        if (k == 2) def.box_turn_per_step = 2e-5;
        if (k == 3) def.kernel = DEM_REFERENCE;
        compare(&def, 3, part);
    }
}

/* Clocks around the phases take one; so do hard collisions, the ledger and Gear's integrator (`removal`). */
static void one_thread(void)
{
    dem_definition def = grains_box(400, 4.0, 9, NULL);
    scoped_sim *one = start(&def, 1), *timed = start(&def, 3);
    dem_phases times = {0};
    CHECK_OK(dem_run(one, 200));
    CHECK_OK(dem_run_timed(timed, 200, &times));
    CU_ASSERT(grains_same_bits(one, timed) && times.lists > 0.0 && times.walls > 0.0);
}

/* A fault is found at the same step, with the same message: by the reference loop, in chunks, in threads. */
static void fault(bool wall)
{
    dem_definition def = grains_too_soft(wall);
    scoped_sim *one = start(&def, 1), *three = start(&def, 3);
    for (int k = 0; k < 2; k++) {
        def.kernel = DEM_REFERENCE;
        scoped_sim *reference = grains_start_in_chunks(&def, 0);
        grains_break_alike(reference, k ? three : one);
    }
    CU_ASSERT(one->pairs.n_chunks > 0);
}

/* Of an overlap with a grain or a wall; of a number that a rebuilding finds. */
static void faults(void)
{
    fault(false);
    fault(true);
    dem_definition def = grains_box(600, 5.0, 9, NULL);
    scoped_sim *sim = start(&def, 3);
    CHECK_OK(dem_run(sim, 100));
    sim->grains.motion[sim->grains.n / 2].v[0] = NAN;
    CHECK_FAILS(dem_run(sim, 2), RP_BROKEN, "non_finite");
    CU_ASSERT(dem_sim_fault(sim) == DEM_FAULT_NON_FINITE);
}

/* From a snapshot, with another number of threads each time. */
static void snapshots(void)
{
    const long part = check_fast() ? 100 : 300;
    dem_definition def = grains_box(600, 5.0, 9, NULL);
    def.walls[DEM_BOX_RIGHT].open_at_step = 2 * part, def.rotation = true;
    def.material.mu_roll = 0.1;
    dem_sim *one = start(&def, 1), *sim = start(&def, 3);
    for (size_t threads = 8; threads > 0; threads /= 2) {
        CHECK_OK(dem_run(one, part));
        CHECK_OK(dem_run(sim, part));
        dem_sim *const kept = grains_kept(sim);
        dem_free(sim), sim = kept;
        CU_ASSERT(sim->threads == 0 && same_state(one, sim));
        dem_threads(sim, threads);
    }
    dem_free(one), dem_free(sim);
}

/* The program: tables of a run with one thread, with two, and of one stopped and resumed with three. */
static void program(void)
{
    if (CHECK_SKIPS("the suite runs threads in its own process")) return;
    enter();
    write_text("s.cfg", "steps = 400; dt = 1e-5; skin = 0.4; gravity = [0.0, -9.81e4];\n"
                        "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } );\n"
                        "fill = { N = 12000; W = 36.0; H = 36.0; };\n");
    GOOD("run s.cfg -o one --every 200");
    GOOD("run s.cfg -o two --every 200 -j 2");
    CU_ASSERT(
        shell(
            "ulimit -f 8000; exec \"$REPOSE\" run s.cfg -o on --every 200 --snapshot 100 -j 2 >out 2>err") ==
        74);
    GOOD("run --resume on -j 3 --quiet");
    SHELL("for t in states contacts walls energy; do for d in one two on; do grep -v '^#' $d/$t.tsv >$d.$t; "
          "done; cmp one.$t two.$t && cmp one.$t on.$t || exit 1; done; test $(wc -l <one.contacts) -gt 100");
    leave();
}

CHECK_SUITE(threads, "threads", avalanche, outflows, turning, one_thread, faults, snapshots, program)
