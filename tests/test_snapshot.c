/* Snapshots: a run that goes on from one has the bits of the run that was never stopped, in memory, from a
 * file and as output files of the program; what is no such state is refused with the reason. */
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "core/snapshot.h"
#include "core/version.h"
#include "dem/dem.h"
#include "tests/check.h"
#include "tests/grains.h"

/* ---- Simulations ---- */

enum { GRAINS = 40, HALF = 150 };

/* What a scene may have, one bit each. */
enum {
    ROTATION = 1,
    ROLLING = 2,
    WELLS = 4,
    HARD = 8,
    LIFTED_GATE = 16,
    GRAVITY_TURNS = 32,
    BOX_TURNS = 64,
    OUTFLOW = 128,
    LEDGER = 256,
    FIXED = 512,
    PUT_IN = 1024,
    FEATURES = 2048
};

static dem_definition scene_of(int features, dem_grain **grains)
{
    dem_definition def = grains_box(GRAINS, 1.2, 3, grains);
    for (size_t i = 0; i < GRAINS; i++) {
        (*grains)[i].vx = 60.0 * ((double)(i % 7) / 3.0 - 1.0);
        (*grains)[i].vy = -50.0 * (double)(i % 3);
        if (features & ROTATION) (*grains)[i].omega = (double)i - 20.0;
    }
    def.rotation = features & ROTATION;
    if (features & ROLLING) def.material.mu_roll = 0.1;
    if (features & WELLS) def.ground = (dem_ground){1, 0.5, 0.01, DEM_WELL_AGAIN};
    if (features & HARD) {
        def.hard = (dem_hard){true, 0.7, 0.3};
        def.tension = false;
    }
    if (features & LIFTED_GATE) {
        def.walls[DEM_BOX_RIGHT].extent[0] = 0.0;
        def.walls[DEM_BOX_RIGHT].open_speed = 100.0;
        def.walls[DEM_BOX_RIGHT].open_at_step = HALF / 2;
    }
    if (features & GRAVITY_TURNS) def.turn_per_step = 1e-3, def.turn_from_step = HALF / 3;
    if (features & BOX_TURNS) def.box_turn_per_step = 1e-4;
    if (features & OUTFLOW) {
        def.x_max = 1.1;
        def.walls[DEM_BOX_RIGHT].open_at_step = 0;
        for (size_t i = 0; i < GRAINS; i++)
            if ((*grains)[i].x > 1.0) (*grains)[i].x -= 0.1, (*grains)[i].y += 4.0;
    }
    if (features & FIXED)
        (*grains)[0].fixed = true, (*grains)[0].vx = (*grains)[0].vy = (*grains)[0].omega = 0.0;
    def.ledger = features & LEDGER;
    return def;
}

static void run(dem_sim *sim, long steps)
{
    CHECK_OK(dem_run(sim, steps));
}

static void put_in(dem_sim *sim, int features)
{
    if (!(features & PUT_IN)) return;
    const double y = 9.0 + 0.005 * (double)dem_step(sim);
    for (int k = 0; k < 3; k++)
        CHECK_OK(
            dem_add(sim, &(dem_grain){.x = 0.2 + 0.3 * k, .y = y, .r = 0.1, .m = 0.004, .vy = -9.0}, NULL));
}

/* Everything that can be read of two simulations. */
static bool same(const dem_sim *a, const dem_sim *b)
{
    double forces[2][2 * DEM_MAX_WALLS] = {{0}};
    dem_energy energy[2];
    dem_ledger ledger[2] = {{0}};
    dem_counts counts[2];
    double g[2][2];
    dem_contact *contacts[2];
    size_t n[2];
    for (int k = 0; k < 2; k++) {
        const dem_sim *sim = k ? b : a;
        dem_wall_forces(sim, forces[k]);
        dem_energies(sim, &energy[k]);
        dem_ledger_read(sim, &ledger[k]);
        dem_count_work(sim, &counts[k]);
        dem_gravity(sim, g[k]);
        CHECK_OK(dem_contacts(sim, &contacts[k], &n[k]));
    }
    bool equal = grains_same_bits(a, b) && dem_step(a) == dem_step(b) && n[0] == n[1] &&
                 memcmp(forces[0], forces[1], sizeof forces[0]) == 0 &&
                 memcmp(&energy[0], &energy[1], sizeof energy[0]) == 0 &&
                 memcmp(&ledger[0], &ledger[1], sizeof ledger[0]) == 0 &&
                 memcmp(&counts[0], &counts[1], sizeof counts[0]) == 0 &&
                 memcmp(g[0], g[1], sizeof g[0]) == 0;
    for (size_t k = 0; k < n[0] && equal; k++)
        equal = contacts[0][k].shear_spring == contacts[1][k].shear_spring &&
                contacts[0][k].rolling_spring == contacts[1][k].rolling_spring &&
                contacts[0][k].well == contacts[1][k].well;
    free(contacts[0]);
    free(contacts[1]);
    return equal;
}

/* The simulation that the bytes of another's snapshot make. */
static dem_sim *again(dem_sim *sim)
{
    rp_snapshot s = {0};
    dem_sim *copy = sim;
    dem_keep(&s, &copy);
    CHECK_OK(s.status);
    s.reading = true, s.path = "memory";
    dem_keep(&s, &copy);
    CHECK_OK(rp_snapshot_end(&s));
    rp_snapshot_free(&s);
    return copy;
}

/* Whether there is such a scene; if so, twice HALF steps, of which the second half is also made from a
 * snapshot; adds the contacts that it has there. */
static bool continues(dem_definition *def, int features, size_t *contacts)
{
    dem_sim *sim;
    const double limit = dem_time_step_limit(def, NULL);
    if (!(def->dt <= 0.5 * limit)) def->dt = 0.5 * limit;
    const rp_status status = dem_create(def, &sim);
    CU_ASSERT(!status || status == RP_BAD_INPUT);
    if (status) return false;
    run(sim, HALF - 40);
    put_in(sim, features);
    run(sim, 40);
    dem_counts counts;
    dem_count_work(sim, &counts);
    *contacts += counts.contacts;
    dem_sim *copy = again(sim);
    CU_ASSERT_PTR_NOT_NULL_FATAL(copy);
    CU_ASSERT(same(sim, copy));
    for (int k = 0; k < 2; k++) {
        put_in(sim, features), put_in(copy, features);
        run(sim, HALF / 2);
        run(copy, HALF / 3);
        run(copy, HALF / 2 - HALF / 3);
        CU_ASSERT(same(sim, copy));
    }
    dem_free(sim);
    dem_free(copy);
    return true;
}

/* Each feature alone, and all that go together. */
static const int sets[] = {0,
                           ROTATION,
                           ROTATION | ROLLING,
                           WELLS,
                           HARD,
                           LIFTED_GATE,
                           GRAVITY_TURNS,
                           BOX_TURNS,
                           OUTFLOW,
                           LEDGER,
                           FIXED,
                           PUT_IN,
                           ROTATION | ROLLING | WELLS | HARD | GRAVITY_TURNS | OUTFLOW | LEDGER | PUT_IN,
                           ROTATION | ROLLING | LIFTED_GATE | GRAVITY_TURNS | FIXED | LEDGER | PUT_IN,
                           WELLS | GRAVITY_TURNS | LEDGER | FIXED};
enum { SETS = sizeof sets / sizeof *sets };

static void every_law_integrator_and_feature(void)
{
    size_t of_integrator[DEM_INTEGRATORS] = {0}, of_set[SETS] = {0}, contacts = 0;
    for (int normal = 0; normal < DEM_NORMAL_N; normal++)
        for (int tangential = 0; tangential < DEM_TANGENTIAL_N; tangential++)
            for (int integrator = 0; integrator < DEM_INTEGRATORS; integrator++)
                for (size_t k = 0; k < SETS; k++) {
                    dem_grain *grains;
                    dem_definition def = scene_of(sets[k], &grains);
                    grains_law(&def, (dem_normal_law)normal, 1e5, 200.0);
                    def.tangential = (dem_tangential_law)tangential;
                    def.integrator = (dem_integrator)integrator;
                    if (tangential == DEM_NONE) def.material.mu = def.material.mu_roll = 0.0;
                    for (size_t w = 0; w < def.n_walls; w++) def.walls[w].material = def.material;
                    const bool done = continues(&def, sets[k], &contacts);
                    of_integrator[integrator] += done, of_set[k] += done;
                    free(grains);
                }
    for (int k = 0; k < DEM_INTEGRATORS; k++) CU_ASSERT(of_integrator[k] >= 20);
    for (size_t k = 0; k < SETS; k++) CU_ASSERT(of_set[k] >= 3);
    CU_ASSERT(contacts > 1000);
}

/* So many grains that a step takes them in chunks, and runs ahead. */
static void large_pile(void)
{
    enum { SIDE = 130, N = SIDE * SIDE };
    dem_grain *grains = calloc(N, sizeof *grains);
    for (int i = 0; i < N; i++)
        grains[i] = (dem_grain){.x = 0.1 + 0.198 * (i % SIDE) + 0.099 * (i / SIDE % 2),
                                .y = 0.1 + 0.172 * (i / SIDE),
                                .r = 0.1,
                                .m = 0.004,
                                .vx = 3.0 * ((i * 7919) % 101 - 50)};
    dem_definition def = dem_definition_default();
    grains_on_floor(&def, N, grains);
    dem_sim *sim = grains_start(&def);
    run(sim, 30);
    dem_sim *copy = again(sim);
    run(sim, 30);
    run(copy, 30);
    dem_counts counts;
    dem_count_work(sim, &counts);
    CU_ASSERT(counts.pairs > 6 * 8192 && counts.rebuilds > 2);
    CU_ASSERT(same(sim, copy));
    dem_free(sim);
    dem_free(copy);
    free(grains);
}

void suite_snapshot(void)
{
    static const check_case cases[] = {
        {"every law, integrator and feature", every_law_integrator_and_feature},
        {"large pile", large_pile},
        {0}};
    check_register("snapshot", cases);
}
