/* What modules share of their view; see module.h. */
#include <math.h>
#include <stdlib.h>

#include "experiment/modules/module.h"

const rp_param exp_no_keys[] = {{0}};

static int by_id(const void *a, const void *b)
{
    const uint32_t p = ((const dem_state *)a)->id, q = ((const dem_state *)b)->id;
    return (p > q) - (p < q);
}

const dem_state *exp_grain_of(size_t n, const dem_state grains[], uint32_t id)
{
    const dem_state wanted = {.id = id};
    return bsearch(&wanted, grains, n, sizeof wanted, by_id);
}

bool exp_view_has(const exp_view *view, uint32_t id)
{
    return exp_grain_of(view->n, view->grains, id) != NULL;
}

void exp_contact_force(const dem_contact *c, double force[2])
{
    const double lx = c->x - c->x_b, ly = c->y - c->y_b, l = sqrt(lx * lx + ly * ly), nx = lx / l,
                 ny = ly / l;
    force[0] = c->normal_force * nx + c->shear_force * ny;
    force[1] = c->normal_force * ny - c->shear_force * nx;
}
