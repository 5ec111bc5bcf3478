/* Order of the grains: bonds to neighbours, how many lie close-packed, and where their strongest forces run.
 */
#include <math.h>

#include "core/arena.h"
#include "core/elementary.h"
#include "experiment/modules/module.h"

static const exp_output outputs[] = {
    {"_psi6", "",
     "mean |psi_6| of the grains with two or more neighbours, which are grains within 1.25 (r_i + r_j)"},
    {"_packed", "", "fraction of the grains that are close-packed: six neighbours, |psi_6| at least 0.9"},
    {"_strongest_60", "",
     "among the contacts that are the strongest of one of their grains, the fraction within 10 degrees of 60 "
     "or 120 degrees"},
    {"_packed_60", "", "the same for contacts between close-packed grains"},
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

/* Of the contacts between grains, one of which counts, than which one of the two has no stronger; most[i]:
 * the strongest force of grain i. */
static void strongest(const exp_view *s, const bool counts[], const bool packed[], double most[],
                      double out[2])
{
    double all[2] = {0.0}, at_60[2] = {0.0};
    for (int pass = 0; pass < 2; pass++)
        for (const dem_contact *c = s->contacts; c < s->contacts + s->n_contacts; c++) {
            const dem_state *p = exp_grain_of(s->n, s->grains, c->id_a),
                            *q = c->id_b ? exp_grain_of(s->n, s->grains, c->id_b) : NULL;
            if (!p || !q) continue;
            const size_t a = (size_t)(p - s->grains), b = (size_t)(q - s->grains);
            if (pass == 0) {
                most[a] = fmax(most[a], c->normal_force);
                most[b] = fmax(most[b], c->normal_force);
            } else if ((counts[a] || counts[b]) && c->normal_force >= fmin(most[a], most[b])) {
                const bool both = packed[a] && packed[b];
                all[0] += 1.0, all[1] += both;
                at_60[0] += is_at_60(c), at_60[1] += both && is_at_60(c);
            }
        }
    for (int k = 0; k < 2; k++) out[k] = at_60[k] / all[k];
}

static rp_status evaluate(const exp_view *s, const void *params, double out[])
{
    RP_SCOPE(memory);
    exp_view wide = *s; /* with the grains beside the region, which are neighbours alone */
    dem_state *grains;
    double *order, *most, sum = 0.0, counted = 0.0, n_packed = 0.0;
    int *neighbours;
    bool *packed, *counts;
    (void)params;
    if (s->n == 0) return rp_fail(RP_NO_RESULT, "no grains that move");
    RP_NEW(&memory, grains, s->n_all);
    RP_NEW(&memory, order, s->n_all);
    RP_NEW(&memory, most, s->n_all);
    RP_NEW(&memory, neighbours, s->n_all);
    RP_NEW(&memory, packed, s->n_all);
    RP_NEW(&memory, counts, s->n_all);
    wide.grains = grains, wide.n = 0;
    for (size_t i = 0; i < s->n_all; i++) {
        dem_state *const g = &grains[wide.n];
        *g = s->all[i];
        dem_box_frame(s->sim, &g->x, &g->y);
        counts[wide.n] = exp_view_has(s, g->id);
        wide.n += !g->fixed;
    }
    exp_bond_order(wide.n, grains, order, neighbours);
    for (size_t i = 0; i < wide.n; i++) {
        packed[i] = neighbours[i] == 6 && order[i] >= 0.9;
        if (!counts[i]) continue;
        n_packed += packed[i];
        if (neighbours[i] >= 2) sum += order[i], counted += 1.0;
    }
    out[0] = sum / counted, out[1] = n_packed / (double)s->n;
    strongest(&wide, counts, packed, most, &out[2]);
    return RP_OK;
}

EXP_MODULE(order, "bond order of grains; neighbours outside the region count too", "no_pile", exp_no_keys,
           char, outputs, EXP_ON_CONTACTS, .evaluate = evaluate);
