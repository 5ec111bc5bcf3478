/* How far the largest cluster of grains that touch reaches: what has run out farther rolls alone. */
#include <math.h>
#include <stdlib.h>

#include "experiment/modules/module.h"

static const rp_param schema[] = {{0}};

static const exp_output outputs[] = {
    {"_left", "cm", "leftmost point of the largest cluster of grains that touch"},
    {"_right", "cm", "its rightmost point"},
    {"_height", "cm", "its highest point"},
    {"_grains", "", "its grains"},
    {0}};

static size_t root(size_t *of, size_t i)
{
    while (of[i] != i) i = of[i] = of[of[i]];
    return i;
}

static rp_status evaluate(const exp_view *s, const void *params, double out[])
{
    const dem_contact *const c = s->contacts;
    const size_t n_contacts = s->n_contacts;
    size_t n_ids = 0, largest = 0;
    (void)params;
    if (s->n == 0) return rp_fail(RP_NO_RESULT, "no grains");
    for (size_t i = 0; i < s->n; i++) n_ids = s->grains[i].id > n_ids ? s->grains[i].id : n_ids;
    size_t *of = calloc(2 * n_ids + 2, sizeof *of), *size = of + n_ids + 1; /* by id; 0: not of the sample */
    if (!of) return rp_fail(RP_NO_MEMORY, "deposit: out of memory");
    for (size_t i = 0; i < s->n; i++) of[s->grains[i].id] = s->grains[i].id;
    for (size_t k = 0; k < n_contacts; k++) {
        if (c[k].id_b == 0 || c[k].id_a > n_ids || c[k].id_b > n_ids || !of[c[k].id_a] || !of[c[k].id_b])
            continue;
        const size_t a = root(of, c[k].id_a), b = root(of, c[k].id_b);
        of[a > b ? a : b] = a > b ? b : a;
    }
    for (size_t i = 0; i < s->n; i++) size[root(of, s->grains[i].id)]++;
    for (size_t id = 1; id <= n_ids; id++)
        if (size[id] > size[largest]) largest = id;
    out[0] = INFINITY, out[1] = out[2] = -INFINITY, out[3] = (double)size[largest];
    for (size_t i = 0; i < s->n; i++) {
        const dem_state *g = &s->grains[i];
        if (root(of, g->id) != largest) continue;
        out[0] = fmin(out[0], g->x - g->r), out[1] = fmax(out[1], g->x + g->r),
        out[2] = fmax(out[2], g->y + g->r);
    }
    free(of);
    return RP_OK;
}

const exp_module exp_module_deposit = {.name = "deposit",
                                       .about = "extent of the largest cluster of grains that touch",
                                       .word = "no_pile",
                                       .schema = schema,
                                       .size = 1,
                                       .outputs = outputs,
                                       .on_contacts = true,
                                       .evaluate = evaluate};
