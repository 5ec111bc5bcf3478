/* Grains of very different size: the search by size makes the list of the plain search, in the same order. */
#include <gsl/gsl_randist.h>

#include "dem/state/state.h"
#include "tests/grains.h"
#include "tests/numbers.h"
#include "tests/property.h"

static const double PLAIN = INFINITY, BY_SIZE = 0.0; /* most tests of a grain in the plain search */

/* The first grain is the largest, of radius 1; areas of all ranges of log r are equal. A half full box. */
static dem_definition mixture(long n, double ratio, unsigned long seed, double *width, dem_grain **grains)
{
    dem_definition def = dem_definition_default();
    double area = 4.0;
    dem_grain *g = *grains = calloc((size_t)n, sizeof *g);
    for (long i = 0; i < n; i++) {
        g[i].r = 1.0 / sqrt(1.0 + (double)i / (double)n * (ratio * ratio - 1.0));
        area += g[i].r * g[i].r;
    }
    *width = sqrt(2.0 * M_PI * area);
    dem_fill fill = {.N = n, .W = *width, .H = *width, .density = 1.0, .shape = DEM_SPHERE};
    fill.seed = (long)seed, fill.radius_mean = 0.5, fill.radius_min = 1.0 / ratio, fill.radius_max = 1.0;
    CHECK_OK(dem_fill_place(&fill, g));
    def.grains = g, def.n_grains = (size_t)n;
    def.x_max = INFINITY, def.y_min = -INFINITY;
    def.dt = 0.5 * dem_time_step_limit(&def, NULL);
    return def;
}

/* Let them lie anywhere, so that cells wrap around among them, a third of them in another box that has the
 * same cells; some fixed, some so fast that their margins are wide. */
static void stir(dem_sim *sim, double speed, unsigned long seed)
{
    dem_grains *const g = &sim->grains;
    scoped_rng *rng = numbers_of(seed, 0);
    const dem_vec shift = {gsl_ran_flat(rng, -20.0, 20.0), gsl_ran_flat(rng, -20.0, 20.0)};
    for (size_t i = 0; i < g->n; i++) {
        g->motion[i].x += shift + (i % 3 ? (dem_vec){0.0, 0.0} : (dem_vec){97.3, -61.1});
        if (i % 5 == 0) g->inverse_mass[i] = 0.0;
        if (i % 2) g->motion[i].v[0] = 0.9 * speed * gsl_rng_uniform(rng) * g->radius[i] / sim->def.dt;
    }
}

static double list_is_plain(const double x[])
{
    scoped dem_grain *grains = NULL;
    double width;
    const dem_definition def = mixture((long)x[0], pow(10.0, x[1]), (unsigned long)x[3], &width, &grains);
    scoped_sim *sim = grains_start(&def), *plain = NULL;
    stir(sim, x[2], (unsigned long)x[3]);
    CHECK_OK(dem_clone(sim, &plain));
    sim->list.most_tests = BY_SIZE, plain->list.most_tests = PLAIN;
    CHECK_OK(dem_neighbours_rebuild(sim));
    CHECK_OK(dem_neighbours_rebuild(plain));
    double wrong = (double)grains_wrong_pairs(sim) + (sim->list.sizes == NULL) + (plain->list.sizes != NULL);
    wrong += sim->pairs.n != plain->pairs.n ||
             memcmp(sim->pairs.i, plain->pairs.i, sim->pairs.n * sizeof *sim->pairs.i) != 0 ||
             memcmp(sim->pairs.j, plain->pairs.j, sim->pairs.n * sizeof *sim->pairs.j) != 0;
    return 2.0 * wrong;
}

static void lists(void)
{
    const property list = {"sizes: list",
                           list_is_plain,
                           {{"n", 2, 600, true},
                            {"lg_ratio", 0.0, 2.0, false},
                            {"speed", 0.0, 1.0, false},
                            {"seed", 0, 1e6, true}}};
    property_check(&list, 21, check_fast() ? 100 : 600);
}

/* By size from as many tests on as it takes as long: not in a box of equal grains. */
static void choice(void)
{
    double width;
    for (int k = 0; k < 2; k++) {
        scoped dem_grain *grains = NULL;
        const dem_definition def = mixture(2000, k ? 30.0 : 1.2, 7, &width, &grains);
        scoped_sim *sim = grains_start(&def);
        CU_ASSERT((sim->list.sizes != NULL) == (k == 1));
    }
}

/* Runs, also with threads, have the bits of plain searches: they fall, flow out, and leave. */
static void runs(void)
{
    enum { RUNS = 3 };
    static const size_t threads[RUNS] = {1, 1, 3};
    const long part = check_fast() ? 300 : 1500;
    scoped dem_grain *grains = NULL;
    double width;
    dem_definition def = mixture(700, 12.0, 3, &width, &grains);
    for (size_t i = 0; i < def.n_grains; i += 50) grains[i].fixed = true;
    def.rotation = true, def.material.mu_roll = 0.1;
    dem_box_walls(&def, width, &def.material);
    def.y_min = -0.5, def.walls[DEM_BOX_FLOOR].open_at_step = 2 * part;
    def.dt = 0.8 * dem_time_step_limit(&def, NULL);
    dem_sim *sim[RUNS];
    for (int k = 0; k < RUNS; k++) {
        sim[k] = grains_start_in_chunks(&def, 64);
        sim[k]->list.most_tests = k == 0 ? PLAIN : BY_SIZE;
        dem_threads(sim[k], threads[k]);
    }
    for (int round = 0; round < 4; round++)
        for (int k = 0; k < RUNS; k++) {
            CHECK_OK(dem_run(sim[k], part));
            CU_ASSERT(grains_same_bits(sim[0], sim[k]));
        }
    CU_ASSERT(dem_count(sim[0]) < def.n_grains && sim[0]->count.rebuilds > 10);
    CU_ASSERT(!sim[0]->list.sizes && sim[1]->list.sizes && sim[2]->list.sizes);
    for (int k = 0; k < RUNS; k++) dem_free(sim[k]);
}

CHECK_SUITE(sizes, "sizes", lists, choice, runs)
