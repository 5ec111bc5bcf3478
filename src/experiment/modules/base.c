/* The load on a wall that a pile stands on: its profile about its own centroid, and whether it dips there. */
#include <math.h>

#include "core/arena.h"
#include "experiment/modules/base.h"
#include "experiment/modules/module.h"

static const rp_param schema[] = {{0}};

enum { LOAD, CENTROID, WIDTH, DIP, MIDDLE, EXCESS, SHEAR, N_01, RAYS_01 = N_01 + STRESS_DIP_BINS };
#define N_ROW(k)    {"_n_" #k, "", "pressure in bin " #k " of 20 over the width, over its mean"},
#define RAYS_ROW(k) {"_rays_" #k, "", "that of rays at 60 degrees under the outline"},
static const exp_output outputs[] = {
    {"_load", "dyn", "force normal to the wall"},
    {"_centroid", "cm", "its centroid, along x"},
    {"_width", "cm", "width about it that holds 98 % of it"},
    {"_dip", "", "mean pressure within 0.1 of the width from the centroid, less that from there to 0.3"},
    {"_middle", "", "the same, less that from 0.1 to 0.2"},
    {"_excess", "", "the same, less that of rays at 60 degrees under the outline"},
    {"_shear", "", "outward force along the wall, both flanks, over the load"},
    STRESS_DIP_BIN_LIST(N_ROW) STRESS_DIP_BIN_LIST(RAYS_ROW){0}};

/* A contact of the wall with a grain of the view. */
static bool is_of(const exp_view *s, const dem_contact *c)
{
    bool wall = false;
    for (size_t k = 0; k < s->n_walls && c->id_b == 0; k++) wall |= s->walls[k] == (size_t)c->wall;
    return wall && exp_view_has(s, c->id_a);
}

/* Lengths in diameters, from here on. */
static rp_status evaluate(const exp_view *s, const void *params, double out[])
{
    const size_t n_contacts = s->n_contacts;
    const dem_contact *const c = s->contacts;
    RP_SCOPE(memory);
    double *x, *top, outward = 0.0, load = 0.0;
    size_t n = 0;
    stress_base base;
    (void)params;
    RP_NEW(&memory, x, 4 * n_contacts);
    RP_NEW(&memory, top, 2 * s->n);
    double *r = x + n_contacts, *N = r + n_contacts, *H = N + n_contacts, *at = top + s->n;
    for (size_t k = 0; k < n_contacts; k++) {
        if (!is_of(s, &c[k])) continue;
        const double l = hypot(c[k].x - c[k].x_b, c[k].y - c[k].y_b);
        x[n] = c[k].x / s->d, r[n] = (l + c[k].overlap) / s->d;
        H[n] = -c[k].shear_force, N[n] = c[k].normal_force;
        load += N[n++];
    }
    RP_TRY(stress_base_profile(n, x, r, N, &base));
    for (size_t i = 0; i < n; i++) outward += x[i] > base.centroid ? H[i] : -H[i];
    for (size_t i = 0; i < s->n; i++)
        at[i] = s->grains[i].x / s->d, top[i] = (s->grains[i].y + s->grains[i].r) / s->d;
    out[LOAD] = load, out[CENTROID] = base.centroid * s->d, out[WIDTH] = base.width * s->d;
    out[DIP] = stress_dip(base.N), out[MIDDLE] = stress_middle(base.N), out[SHEAR] = outward / load;
    for (int k = 0; k < STRESS_DIP_BINS; k++) out[N_01 + k] = base.N[k];
    RP_TRY(exp_outline_rays(s->n, at, top, &base, &out[RAYS_01]));
    out[EXCESS] = stress_excess(base.N, &out[RAYS_01]);
    return RP_OK;
}

const exp_module exp_module_base = {.name = "base",
                                    .about = "load of a pile on a level wall under it, and its profile",
                                    .word = "no_pile",
                                    .schema = schema,
                                    .size = 1,
                                    .outputs = outputs,
                                    .on_wall = true,
                                    .on_contacts = true,
                                    .evaluate = evaluate};
