/* A scene without phases, as `repose run FILE` makes it: centres and radii of its grains at the end.
 *
 *     cc run.c $(pkg-config --cflags --libs repose) -o run && ./run FILE */
#include <stdlib.h>

#include <repose/scene.h>
#include <repose/table.h>

static rp_status print_grains(const dem_sim *sim)
{
    const size_t n = dem_count(sim);
    dem_state *grains = malloc(n * sizeof *grains);
    rp_status status = grains ? dem_states(sim, grains) : RP_NO_MEMORY;
    rp_table_header(stdout, dem_units(sim), "x [cm], y [cm], r [cm]");
    for (size_t i = 0; i < n && !status; i++)
        rp_table_row(stdout, 3, (double[]){grains[i].x, grains[i].y, grains[i].r});
    free(grains);
    return status;
}

int main(int argc, char **argv)
{
    dem_scene scene = {0};
    dem_sim *sim = NULL;
    rp_status status = argc > 1 ? dem_scene_read(argv[1], NULL, &scene) : rp_fail(RP_USAGE, "run FILE");
    if (!status) status = dem_scene_start(&scene, &sim);
    if (!status) status = dem_run(sim, scene.steps);
    if (!status) status = print_grains(sim);
    if (status) fprintf(stderr, "run: %s\n", rp_message());
    dem_free(sim);
    dem_scene_free(&scene);
    return (int)status;
}
