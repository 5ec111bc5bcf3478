/* Threads in one pile: a run has the same bits with any number of them. */
#include <stdlib.h>
#include <string.h>

#include "dem/sim.h"
#include "tests/check.h"
#include "tests/grains.h"

/* All that a simulation goes on from: also forces, springs, and the order of the lists. */
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

/* A pile whose steps are those of a large one. */
static dem_sim *start(const dem_definition *def, size_t threads)
{
    dem_sim *sim = grains_start(def);
    sim->pairs.chunk = 64;
    CHECK_OK(dem_neighbours_rebuild(sim));
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
    dem_grain *grains;
    const long part = check_fast() ? 300 : 2000;
    dem_definition def = grains_box(2500, 10.0, 9, &grains);
    def.walls[DEM_BOX_RIGHT].open_at_step = 3 * part;
    compare(&def, 6, part);
    free(grains);
}

/* Cells that wrap around, fixed grains in between, grains that leave. */
static void outflow(bool rotation)
{
    dem_grain *grains;
    const long part = check_fast() ? 300 : 1500;
    dem_definition def = grains_box(400, 4.0, 9, &grains);
    for (int i = 0; i < 400; i += 50) grains[i].fixed = true;
    def.walls[DEM_BOX_RIGHT].open_at_step = 2 * part;
    def.walls[DEM_BOX_FLOOR].open_at_step = 3 * part;
    def.x_max = 8.0;
    def.y_min = -0.5;
    def.rotation = rotation;
    def.material.mu_roll = rotation ? 0.1 : 0.0;
    compare(&def, 4, part);
    free(grains);
}

static void outflows(void)
{
    outflow(false);
    outflow(true);
}

const check_case threads_cases[] = {
    {"a whole avalanche", avalanche},
    {"wrapped cells, fixed grains, outflow", outflows},
    {NULL, NULL}};

void suite_threads(void)
{
    check_register("threads", threads_cases);
}
