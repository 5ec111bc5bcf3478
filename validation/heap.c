/* Piles that are solved for and simulated; see heap.h. */
#include "validation/heap.h"

#include <stdlib.h>

#include "analytic/analytic.h"
#include "tests/check.h"
#include "tests/grains.h"

static const double R = 0.5, MU = 1.0, WELL = 1.0; /* half-width in eps sigma */

heap heap_solved(long k, double alpha_deg, double eps, long load_steps)
{
    heap h = {.k = (size_t)k, .eps = eps};
    const double theta = M_PI / 6.0;
    long *up = malloc((size_t)k * sizeof *up);
    CHECK_OK(an_lattice_cut(k, theta, alpha_deg * (M_PI / 180.0), up));
    for (long s = 0; s < k; s++) h.n += (size_t)up[s];
    h.grains = calloc(h.n, sizeof *h.grains);
    statics_disk *list = calloc(h.n, sizeof *list);
    size_t n = 0;
    for (long s = 0; s < k; s++)
        for (long j = 0; j < up[s]; j++, n++) {
            list[n] = (statics_disk){(double)s + 0.5 * (double)j, R + (double)j * sqrt(0.75), R, 1.0};
            h.grains[n] = (dem_grain){.x = list[n].x, .y = list[n].y - 1e-13, .r = R, .m = 1.0};
        }
    statics_definition def = statics_definition_default();
    def.n = h.n;
    def.disks = list;
    def.eps = eps;
    def.well = STATICS_WELL_FRICTION;
    def.mu = MU;
    def.a = WELL;
    def.load_steps = load_steps;
    CHECK_OK(statics_create(&def, &h.pile));
    CHECK_OK(statics_solve(h.pile, &h.result));
    CU_ASSERT(h.result.wells == h.k && h.result.broken == 0 && h.result.negative_modes == 0);
    h.N = calloc(h.k, sizeof *h.N);
    h.H = calloc(h.k, sizeof *h.H);
    h.u = calloc(2 * h.n, sizeof *h.u);
    statics_base(h.pile, NULL, h.N, h.H);
    statics_displacements(h.pile, h.u);
    free(list);
    free(up);
    return h;
}

void heap_free(heap *h)
{
    statics_free(h->pile);
    free(h->grains), free(h->N), free(h->H), free(h->u);
}

dem_definition heap_scene(const heap *h, int integrator, double gamma, double dt)
{
    const double omega = sqrt(1.0 / h->eps);
    dem_definition def = dem_definition_default();
    def.integrator = integrator;
    def.gravity[1] = 0.0;
    def.normal = DEM_LINEAR;
    def.tension = false;
    def.tangential = DEM_NONE;
    def.shape = DEM_DISK;
    def.dt = dt / omega;
    def.material = (dem_material){.k_n = 1.0 / h->eps, .gamma_n = gamma * omega};
    grains_on_floor(&def, h->n, h->grains);
    def.ground = (dem_ground){.wall = 1, .mu_static = MU, .a = WELL * h->eps, .set = DEM_WELL_TOUCH};
    return def;
}

void heap_load(dem_sim *sim, long steps)
{
    for (int k = 1; k <= 20; k++) {
        dem_gravity_set(sim, (double[]){0.0, -0.05 * k});
        CHECK_OK(dem_run(sim, steps / 20));
    }
}
