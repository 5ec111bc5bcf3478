/* Definitions: defaults, and what can be read off them. */
#include "dem/setup/definition.h"

#include <math.h>

dem_definition dem_definition_default(void)
{
    dem_definition def = {
        .gravity = {0.0, -981.0},
        .implicit = {.relaxation = 0.7, .tolerance = 1e-15, .max_iterations = 1000},
        .restitution_speed = INFINITY,
        .x_min = -INFINITY,
        .x_max = INFINITY,
        .y_min = -INFINITY,
    };
    dem_physics physics = dem_physics_default();
    physics.tangential = DEM_SPRING;
    physics.mu = 0.2;
    dem_physics_apply(&physics, &def);
    return def;
}

void dem_box_walls(dem_definition *def, double W, const dem_material *wall)
{
    def->n_walls = DEM_BOX_N;
    for (int w = 0; w < DEM_BOX_N; w++)
        def->walls[w] = (dem_wall){
            .material = *wall, .extent = {-INFINITY, INFINITY}, .open_at_step = -1, .open_speed = INFINITY};
    def->walls[DEM_BOX_FLOOR].direction[1] = 1.0;
    def->walls[DEM_BOX_LEFT].direction[0] = 1.0;
    def->walls[DEM_BOX_RIGHT].direction[0] = -1.0;
    def->walls[DEM_BOX_RIGHT].point[0] = W;
}

bool dem_has_rolling(const dem_definition *def)
{
    bool rolling = def->material.mu_roll > 0.0;
    for (size_t w = 0; w < def->n_walls; w++) rolling |= dem_walls_of(def)[w].material.mu_roll > 0.0;
    return rolling;
}
