/* Order of the grains: bonds to neighbours, and how many lie close-packed. */
#include <math.h>
#include <stdlib.h>

#include "experiment/modules/module.h"

static const rp_param schema[] = {{0}};

static const exp_output outputs[] = {
    {"_psi6", "", "mean |psi_6| of the grains with two or more neighbours"},
    {"_packed", "", "share of the grains that are close-packed: six neighbours, |psi_6| at least 0.9"},
    {0}};

static int by_id(const void *a, const void *b)
{
    const uint32_t p = ((const dem_state *)a)->id, q = ((const dem_state *)b)->id;
    return (p > q) - (p < q);
}

bool exp_view_has(const exp_view *view, uint32_t id)
{
    const dem_state wanted = {.id = id};
    return bsearch(&wanted, view->grains, view->n, sizeof wanted, by_id) != NULL;
}

double exp_bond_order(size_t n, const dem_state grains[], double order[], int neighbours[])
{
    double sum = 0.0, counted = 0.0;
    for (size_t i = 0; i < n; i++) {
        const dem_state *a = &grains[i];
        double re = 0.0, im = 0.0, near = 0.0;
        for (const dem_state *b = grains; b < grains + n; b++) {
            const double dx = b->x - a->x, dy = b->y - a->y, reach = 1.25 * (a->r + b->r),
                         r2 = dx * dx + dy * dy;
            if (a == b || a->fixed || b->fixed || r2 > reach * reach) continue;
            const double c2 = (dx * dx - dy * dy) / r2, s2 = 2.0 * dx * dy / r2; /* of 2 theta; cubed */
            re += c2 * c2 * c2 - 3.0 * c2 * s2 * s2;
            im += 3.0 * c2 * c2 * s2 - s2 * s2 * s2;
            near += 1.0;
        }
        const double own = near < 2.0 ? NAN : sqrt(re * re + im * im) / near;
        if (order) order[i] = own;
        if (neighbours) neighbours[i] = (int)near;
        if (near < 2.0) continue;
        sum += own;
        counted += 1.0;
    }
    return sum / counted;
}

static rp_status evaluate(const exp_view *s, const void *params, double out[])
{
    double *order = malloc((s->n + 1) * sizeof *order), packed = 0.0;
    int *neighbours = malloc((s->n + 1) * sizeof *neighbours);
    (void)params;
    rp_status status = order && neighbours ? RP_OK : rp_fail(RP_NO_MEMORY, "order: out of memory");
    if (!status && s->n == 0) status = rp_fail(RP_NO_RESULT, "no grains");
    if (!status) out[0] = exp_bond_order(s->n, s->grains, order, neighbours);
    for (size_t i = 0; i < s->n && !status; i++) packed += neighbours[i] == 6 && order[i] >= 0.9;
    if (!status) out[1] = packed / (double)s->n;
    free(order), free(neighbours);
    return status;
}

const exp_module exp_module_order = {.name = "order",
                                     .about = "bond order of grains and their neighbours",
                                     .word = "no_pile",
                                     .schema = schema,
                                     .size = 1,
                                     .outputs = outputs,
                                     .evaluate = evaluate};
