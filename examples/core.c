/* A pile of 400 grains from the core alone, in cm, g and s: rows of grains fall into a box 4 cm wide; its
 * right wall is removed, what runs out beyond 8 cm is taken out, and the rest comes to rest.
 *
 *     make standalone && build/core
 *     repose run examples/core.cfg         # the same, as a text */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#include "core/random.h"
#include "dem/dem.h"

enum { N = 400 };
static const double width = 4.0, mean = 0.1, least = 0.07, most = 0.13;

/* Rows from the floor up, of places that the largest grain has room in. */
static void place(dem_grain grains[N])
{
    rp_random radii = rp_random_of(1993, 0, RP_PURPOSE_RADII);
    for (int n = 0, row = 0; n < N; row++)
        for (int k = 0; n < N && most * (2.0 * k + row % 2 + 2.0) <= width; k++) {
            const double r = rp_random_cut_normal(&radii, mean, 0.02, least, most);
            const double x = most * (1.0 + 2.0 * k + row % 2), y = most * (1.0 + sqrt(3.0) * row);
            grains[n++] = (dem_grain){.x = x, .y = y, .r = r, .m = dem_mass(DEM_SPHERE, 1.0, r)};
        }
}

/* Run until ten looks in a row find the grains at rest. */
static rp_status run_to_rest(dem_sim *sim)
{
    const double weight = dem_mass(DEM_SPHERE, 1.0, mean) * 981.0;
    for (int looks = 0; looks < DEM_REST_LOOKS; looks++) {
        dem_rest rest;
        RP_TRY(dem_run(sim, DEM_REST_STEPS));
        RP_TRY(dem_rest_state(sim, 0.0, 2.0 * width, &rest));
        if (!dem_at_rest(&rest, DEM_REST_ENERGY * weight * 2.0 * mean, DEM_REST_FORCE * weight, false))
            looks = -1;
    }
    return RP_OK;
}

static rp_status print(const dem_sim *sim)
{
    static dem_state grains[N];
    dem_energy energy;
    dem_counts now;
    uint64_t digest;
    double height = 0.0;
    RP_TRY(dem_states(sim, grains));
    RP_TRY(dem_digest(sim, &digest));
    dem_energies(sim, &energy);
    dem_count_work(sim, &now);
    for (size_t i = 0; i < dem_count(sim); i++) height = fmax(height, grains[i].y + grains[i].r);
    printf("%zu grains, %ld steps, t = %g s: energy %g erg, %zu contacts, height %g cm\n", dem_count(sim),
           dem_step(sim), dem_time(sim), energy.elastic + energy.gravity, now.contacts, height);
    printf("digest %016" PRIx64 "\n", digest);
    return RP_OK;
}

int main(void)
{
    dem_grain grains[N];
    dem_definition scene = dem_definition_default(); /* of Lee & Herrmann, with a friction of 0.2 */
    dem_material wall = scene.material;
    dem_sim *sim = NULL;
    place(grains);
    scene.grains = grains, scene.n_grains = N, scene.x_max = 2.0 * width;
    wall.k_n *= 2.0;
    dem_box_walls(&scene, width, &wall);
    rp_status status = dem_create(&scene, &sim);
    if (!status) status = run_to_rest(sim);
    if (!status) status = dem_wall_open(sim, DEM_BOX_RIGHT, INFINITY);
    if (!status) status = run_to_rest(sim);
    if (!status) status = print(sim);
    if (status) fprintf(stderr, "core: %s\n", rp_message());
    dem_free(sim);
    return (int)status;
}
