/* How far the largest cluster of grains that touch reaches: what has run out farther rolls alone. */
#include <math.h>

#include "core/arena.h"
#include "experiment/modules/module.h"

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

rp_status exp_largest_cluster(const exp_view *s, rp_arena *memory, dem_state **grains, size_t *n)
{
    size_t largest = 0, *of, *size; /* by id; `of` is 0: not of the sample */
    if (s->n == 0) return rp_fail(RP_NO_RESULT, "no grains that move");
    const size_t n_ids = s->grains[s->n - 1].id;
    RP_NEW(memory, of, n_ids + 1);
    RP_NEW(memory, size, n_ids + 1);
    RP_NEW(memory, *grains, s->n);
    for (size_t i = 0; i < s->n; i++) of[s->grains[i].id] = s->grains[i].id;
    for (const dem_contact *c = s->contacts; c < s->contacts + s->n_contacts; c++) {
        if (c->id_b == 0 || c->id_a > n_ids || c->id_b > n_ids || !of[c->id_a] || !of[c->id_b]) continue;
        const size_t a = root(of, c->id_a), b = root(of, c->id_b);
        of[a > b ? a : b] = a > b ? b : a;
    }
    for (size_t i = 0; i < s->n; i++) size[root(of, s->grains[i].id)]++;
    for (size_t id = 1; id <= n_ids; id++)
        if (size[id] > size[largest]) largest = id;
    *n = 0;
    for (size_t i = 0; i < s->n; i++)
        if (root(of, s->grains[i].id) == largest) (*grains)[(*n)++] = s->grains[i];
    return RP_OK;
}

static rp_status evaluate(const exp_view *s, const void *params, double out[])
{
    RP_SCOPE(memory);
    dem_state *grains;
    size_t n;
    (void)params;
    RP_TRY(exp_largest_cluster(s, &memory, &grains, &n));
    out[0] = INFINITY, out[1] = out[2] = -INFINITY, out[3] = (double)n;
    for (const dem_state *g = grains; g < grains + n; g++) {
        out[0] = fmin(out[0], g->x - g->r), out[1] = fmax(out[1], g->x + g->r),
        out[2] = fmax(out[2], g->y + g->r);
    }
    return RP_OK;
}

EXP_MODULE(deposit, "extent of the largest cluster of grains that touch", "no_pile", exp_no_keys, char,
           outputs, EXP_ON_CONTACTS, .evaluate = evaluate);
