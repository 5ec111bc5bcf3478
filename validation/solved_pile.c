/* Piles for the static solver and the simulator; see solved_pile.h. */
#include "validation/solved_pile.h"

#include "analytic/analytic.h"
#include "tests/grains.h"

static const double R = 0.5, MU = 1.0, WELL = 1.0; /* half-width in eps sigma */

solved_pile solved_pile_make(long k, double alpha_deg, double eps, long load_steps)
{
    solved_pile pile = {.k = (size_t)k, .eps = eps};
    long *up = malloc((size_t)k * sizeof *up);
    CHECK_OK(an_lattice_cut(k, M_PI / 6.0, alpha_deg * (M_PI / 180.0), up));
    for (long s = 0; s < k; s++) pile.n += (size_t)up[s];
    pile.grains = calloc(pile.n, sizeof *pile.grains);
    statics_disk *list = calloc(pile.n, sizeof *list);
    size_t n = 0;
    for (long s = 0; s < k; s++)
        for (long j = 0; j < up[s]; j++, n++) {
            list[n] = (statics_disk){(double)s + 0.5 * (double)j, R + (double)j * sqrt(0.75), R, 1.0};
            pile.grains[n] = (dem_grain){.x = list[n].x, .y = list[n].y - 1e-13, .r = R, .m = 1.0};
        }
    statics_definition def = statics_definition_default();
    def.n = pile.n, def.disks = list, def.eps = eps;
    def.well = STATICS_WELL_FRICTION, def.mu = MU, def.a = WELL;
    def.load_steps = load_steps;
    CHECK_OK(statics_create(&def, &pile.equilibrium));
    CHECK_OK(statics_solve(pile.equilibrium, &pile.result));
    CU_ASSERT(pile.result.wells == pile.k && pile.result.broken == 0 && pile.result.negative_modes == 0);
    pile.N = calloc(pile.k, sizeof *pile.N);
    pile.H = calloc(pile.k, sizeof *pile.H);
    pile.u = calloc(2 * pile.n, sizeof *pile.u);
    statics_base(pile.equilibrium, NULL, pile.N, pile.H);
    statics_displacements(pile.equilibrium, pile.u);
    free(list), free(up);
    return pile;
}

void solved_pile_free(solved_pile *pile)
{
    statics_free(pile->equilibrium);
    free(pile->grains), free(pile->N), free(pile->H), free(pile->u);
}

dem_definition solved_pile_scene(const solved_pile *pile, int integrator, double gamma, double dt)
{
    const double omega = sqrt(1.0 / pile->eps);
    dem_definition def = grains_bare(pile->n, pile->grains, DEM_LINEAR,
                                     (dem_material){.k_n = 1.0 / pile->eps, .gamma_n = gamma * omega});
    def.integrator = integrator, def.tension = false, def.shape = DEM_DISK, def.dt = dt / omega;
    grains_on_floor(&def, pile->n, pile->grains);
    def.ground = (dem_ground){.wall = 1, .mu_static = MU, .a = WELL * pile->eps, .set = DEM_WELL_TOUCH};
    return def;
}

void solved_pile_load(dem_sim *sim, long steps)
{
    for (int k = 1; k <= 20; k++) {
        dem_gravity_set(sim, (double[]){0.0, -0.05 * k});
        CHECK_OK(dem_run(sim, steps / 20));
    }
}
