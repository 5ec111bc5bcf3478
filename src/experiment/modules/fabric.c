/* Fabric: the directions of the contacts between grains, by number and by their normal forces. */
#include <math.h>

#include "core/elementary.h"
#include "experiment/modules/module.h"

typedef struct {
    double about, apart;
} fabric_params;

static const rp_param schema[] = {
    {"about", "cm", RP_REAL, offsetof(fabric_params, about), "none", "(-inf, inf) | none",
     "contacts to the left of this x are mirrored; for a pile, x of its middle"},
    {"apart", "cm", RP_REAL, offsetof(fabric_params, apart), "0", "[0, inf)",
     "contacts nearer than this to `about` are left out"},
    {0}};

enum { FABRIC, FABRIC_DEG, FORCE, FORCE_DEG, CONTACTS };
static const exp_output outputs[] = {
    {"_fabric", "", "anisotropy of the contacts' directions, |mean exp(2 i direction)|"},
    {"_fabric_deg", "degree",
     "principal direction of the contacts from the vertical, positive if its upper end leans to +x"},
    {"_force", "", "the same anisotropy, with contacts weighted by their normal force"},
    {"_force_deg", "degree", "principal direction with these weights"},
    {"_contacts", "", "number of contacts between the grains"},
    {0}};

static rp_status evaluate(const exp_view *s, const void *params, double out[])
{
    const fabric_params *p = params;
    if (p->apart > 0.0 && !isfinite(p->about)) return rp_fail(RP_NO_RESULT, "apart needs about");
    double cos2[2] = {0.0}, sin2[2] = {0.0}, sum[2] = {0.0};
    for (const dem_contact *c = s->contacts; c < s->contacts + s->n_contacts; c++) {
        if (c->id_b == 0 || !exp_view_has(s, c->id_a) || !exp_view_has(s, c->id_b)) continue;
        double x = 0.5 * (c->x + c->x_b), y = 0.5 * (c->y + c->y_b);
        dem_box_frame(s->sim, &x, &y);
        const double off = isfinite(p->about) ? x - p->about : INFINITY;
        if (fabs(off) < p->apart) continue;
        const double side = copysign(1.0, off), lx = side * (c->x - c->x_b), ly = c->y - c->y_b,
                     l2 = lx * lx + ly * ly, weight[2] = {1.0, c->normal_force};
        for (int k = 0; k < 2; k++) {
            cos2[k] += weight[k] * (lx * lx - ly * ly) / l2;
            sin2[k] += weight[k] * 2.0 * lx * ly / l2;
            sum[k] += weight[k];
        }
    }
    if (!(sum[0] > 0.0 && sum[1] > 0.0)) return rp_fail(RP_NO_RESULT, "no contacts of grains");
    out[CONTACTS] = sum[0];
    for (int k = 0; k < 2; k++) {
        out[k ? FORCE : FABRIC] = rp_hypot(cos2[k], sin2[k]) / sum[k];
        out[k ? FORCE_DEG : FABRIC_DEG] = 0.5 * rp_atan2(sin2[k], -cos2[k]) * (180.0 / M_PI);
    }
    return RP_OK;
}

EXP_MODULE(fabric, "directions of the contacts between grains", "no_contacts", schema, fabric_params, outputs,
           EXP_ON_CONTACTS, .evaluate = evaluate);
