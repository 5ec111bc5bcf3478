/* Thirty grains fall into a box 2 cm wide: centres and radii after a second, in cm. Given a file's name,
 * `run` writes the scene into it, and `repose run` of this file ends with the same grains.
 *
 *     cc run.c $(pkg-config --cflags --libs repose) -o run */
#include <stdlib.h>

#include <repose/scene.h>
#include <repose/table.h>

/* Lee & Herrmann's grains, in units of cm, g and s. */
static dem_scene scene_of_box(double width)
{
    static dem_fill fill = {.N = 30, .H = 3, .density = 1, .radius_mean = 0.1};
    dem_scene scene = {
        .def = dem_definition_default(), .n_fills = 1, .fills = &fill, .seed = 1, .steps = 20000};
    fill.W = width, fill.radius_width = 0.02, fill.radius_min = 0.07, fill.radius_max = 0.13;
    const dem_physics grains = dem_physics_of(&scene.def, fill.density);
    const dem_material wall = dem_wall_material(&dem_material_auto, &grains);
    dem_box_walls(&scene.def, width, &wall);
    return scene;
}

static rp_status print_grains(const dem_sim *sim)
{
    const size_t n = dem_count(sim);
    dem_state *grains = malloc(n * sizeof *grains);
    rp_status status = grains ? dem_states(sim, grains) : RP_NO_MEMORY;
    rp_table_header(stdout, RP_CGS, "x [cm], y [cm], r [cm]");
    for (size_t i = 0; i < n && !status; i++)
        rp_table_row(stdout, 3, (double[]){grains[i].x, grains[i].y, grains[i].r});
    free(grains);
    return status;
}

int main(int argc, char **argv)
{
    dem_scene scene = scene_of_box(2);
    dem_sim *sim = NULL;
    FILE *file = argc > 1 ? fopen(argv[1], "w") : NULL;
    if (file) {
        dem_scene_write(&scene, file);
        fclose(file);
    }
    rp_status status = dem_scene_start(&scene, &sim);
    if (!status) status = dem_run(sim, scene.steps);
    if (!status) status = print_grains(sim);
    if (status) fprintf(stderr, "run: %s\n", rp_message());
    dem_free(sim);
    return (int)status;
}
