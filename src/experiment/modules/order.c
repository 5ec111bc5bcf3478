/* Order of the grains: bonds to neighbours, how many lie close-packed, and where their strongest forces run.
 */
#include <math.h>

#include "core/arena.h"
#include "core/elementary.h"
#include "experiment/modules/module.h"

static const exp_output outputs[] = {
    {"_psi6", "", "mean |psi_6| of the grains with two or more neighbours, those within 1.25 (r_i + r_j)"},
    {"_packed", "", "share of the grains that are close-packed: six neighbours, |psi_6| at least 0.9"},
    {"_strongest_60", "",
     "share of the contacts than which one of their grains has no stronger, that run within 10 degrees of 60 "
     "or 120"},
    {"_packed_60", "", "the same of contacts between close-packed grains"},
    {0}};

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

/* Within 10 degrees of 60 or 120 degrees to the horizontal. */
static bool is_at_60(const dem_contact *c)
{
    const double turn = rp_atan2(fabs(c->y_b - c->y), fabs(c->x_b - c->x)) * (180.0 / M_PI);
    return fabs(turn - 60.0) <= 10.0;
}

/* The grains that move, of the region and beside it, by rising ids. */
typedef struct {
    size_t n;
    dem_state *at;
    bool *counts, *packed; /* counts: of the region */
    double *order, *most;  /* most: the strongest force on it */
    int *neighbours;
} bonded;

static rp_status find_bonds(const exp_view *s, rp_arena *memory, bonded *g)
{
    RP_NEW(memory, g->at, s->n_all);
    RP_NEW(memory, g->counts, s->n_all);
    RP_NEW(memory, g->packed, s->n_all);
    RP_NEW(memory, g->order, s->n_all);
    RP_NEW(memory, g->most, s->n_all);
    RP_NEW(memory, g->neighbours, s->n_all);
    for (size_t i = 0; i < s->n_all; i++) {
        dem_state *const one = &g->at[g->n];
        *one = s->all[i];
        dem_box_frame(s->sim, &one->x, &one->y);
        g->counts[g->n] = exp_view_has(s, one->id);
        g->n += !one->fixed;
    }
    exp_bond_order(g->n, g->at, g->order, g->neighbours);
    for (size_t i = 0; i < g->n; i++) g->packed[i] = g->neighbours[i] == 6 && g->order[i] >= 0.9;
    return RP_OK;
}

/* Of the contacts between grains, one of them of the region, than which one of the two has no stronger. */
static void strongest(const exp_view *s, const bonded *g, double out[2])
{
    double all[2] = {0.0}, at_60[2] = {0.0};
    for (int pass = 0; pass < 2; pass++)
        for (const dem_contact *c = s->contacts; c < s->contacts + s->n_contacts; c++) {
            const dem_state *p = exp_grain_of(g->n, g->at, c->id_a),
                            *q = c->id_b ? exp_grain_of(g->n, g->at, c->id_b) : NULL;
            if (!p || !q) continue;
            const size_t a = (size_t)(p - g->at), b = (size_t)(q - g->at);
            if (pass == 0) {
                g->most[a] = fmax(g->most[a], c->normal_force);
                g->most[b] = fmax(g->most[b], c->normal_force);
            } else if ((g->counts[a] || g->counts[b]) && c->normal_force >= fmin(g->most[a], g->most[b])) {
                const bool both = g->packed[a] && g->packed[b];
                all[0] += 1.0, all[1] += both;
                at_60[0] += is_at_60(c), at_60[1] += both && is_at_60(c);
            }
        }
    for (int k = 0; k < 2; k++) out[k] = at_60[k] / all[k];
}

static rp_status evaluate(const exp_view *s, const void *params, double out[])
{
    RP_SCOPE(memory);
    bonded g = {0};
    double sum = 0.0, counted = 0.0, n_packed = 0.0;
    (void)params;
    if (s->n == 0) return rp_fail(RP_NO_RESULT, "no grains that move");
    RP_TRY(find_bonds(s, &memory, &g));
    for (size_t i = 0; i < g.n; i++) {
        if (!g.counts[i]) continue;
        n_packed += g.packed[i];
        if (g.neighbours[i] >= 2) sum += g.order[i], counted += 1.0;
    }
    out[0] = sum / counted, out[1] = n_packed / (double)s->n;
    strongest(s, &g, &out[2]);
    return RP_OK;
}

EXP_MODULE(order, "bond order of grains and all their neighbours, those beside the region too", "no_pile",
           exp_no_keys, char, outputs, EXP_ON_CONTACTS, .evaluate = evaluate);
