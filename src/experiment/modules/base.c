/* The load on a wall that a pile stands on: its profile about its own centroid, and whether it dips there;
 * and what rays at 60 degrees would put there under the pile's outline (Liffman, Chan & Hughes 1992, section
 * 3). */
#include <math.h>

#include "analytic/analytic.h"
#include "core/arena.h"
#include "core/elementary.h"
#include "experiment/modules/module.h"

static const double STEEP = 1.7; /* below tan 60 degrees, which rays need */

/* Pressure of the rays of a profile at points of the base, in its bins. */
static rp_status bin_rays(const an_profile *profile, const stress_base *base, double N[STRESS_DIP_BINS])
{
    enum { POINTS = 20 * STRESS_DIP_BINS };
    double x[POINTS], r[POINTS], pressure[POINTS];
    for (int i = 0; i < POINTS; i++) {
        an_force force;
        x[i] = base->centroid + base->width * ((i + 0.5) / POINTS - 0.5);
        r[i] = 0.5 * base->width / POINTS;
        RP_TRY(an_profile_force(profile, x[i], &force));
        pressure[i] = force.N;
    }
    stress_base_bins(base, POINTS, x, r, pressure, N);
    return RP_OK;
}

rp_status exp_outline_rays(size_t n, const double x[], const double top[], const stress_base *base,
                           double N[STRESS_DIP_BINS])
{
    RP_SCOPE(memory);
    double lo = base->centroid - base->width / 2, hi = base->centroid + base->width / 2, highest = 0;
    an_profile profile;
    an_point *v;
    /* columns one diameter wide that hold all points and the base, and on both sides as many empty ones as a
     * slope of STEEP takes down from the highest point */
    for (size_t i = 0; i < n; i++) {
        lo = fmin(lo, x[i]);
        hi = fmax(hi, x[i]);
        highest = fmax(highest, top[i]);
    }
    const double beside = ceil(highest / STEEP) + 2, left = floor(lo) - beside;
    const size_t columns = (size_t)(floor(hi) - left + 1 + beside);
    RP_NEW(&memory, v, columns);
    /* polygon over their middles: their highest points, raised where the slope exceeded STEEP */
    for (size_t k = 0; k < columns; k++) v[k].x = left + (double)k + 0.5;
    for (size_t i = 0; i < n; i++) {
        an_point *p = &v[(size_t)(x[i] - left)];
        p->y = fmax(p->y, top[i]);
    }
    for (size_t k = 1; k < columns; k++) v[k].y = fmax(v[k].y, v[k - 1].y - STEEP);
    for (size_t k = columns - 1; k-- > 0;) v[k].y = fmax(v[k].y, v[k + 1].y - STEEP);
    RP_TRY(an_profile_set(&profile, v, columns));
    return bin_rays(&profile, base, N);
}

typedef struct {
    bool fixed;
} base_params;

static const rp_param schema[] = {{"fixed", "", RP_BOOL, offsetof(base_params, fixed), "false", "",
                                   "whether fixed grains are part of the base"},
                                  {0}};

enum { LOAD, CENTROID, WIDTH, DIP, MIDDLE, EXCESS, SHEAR, N_01, RAYS_01 = N_01 + STRESS_DIP_BINS };
#define N_ROW(k)    {"_n_" #k, "", "pressure in bin " #k " of 20 across the width, over the mean pressure"},
#define RAYS_ROW(k) {"_rays_" #k, "", "the same of rays at 60 degrees under the outline"},
static const exp_output outputs[] = {
    {"_load", "dyn", "force normal to the wall"},
    {"_centroid", "cm", "x of the centroid of this force"},
    {"_width", "cm", "width about the centroid that carries 98 % of the load"},
    {"_dip", "",
     "mean pressure within 0.1 of the width from the centroid, minus that from 0.1 to 0.3, over the mean "
     "pressure"},
    {"_middle", "", "the same, minus that from 0.1 to 0.2"},
    {"_excess", "", "the same, minus that of rays at 60 degrees under the outline"},
    {"_shear", "", "outward force along the wall, both flanks, over the load"},
    STRESS_DIP_BIN_LIST(N_ROW) STRESS_DIP_BIN_LIST(RAYS_ROW){0}};

/* What a contact puts on the base: position and radius of the grain, load, force along x. */
typedef struct {
    double x, r, N, H;
} base_load;

/* Of a grain of the view on a grain that never moves. */
static bool is_of_fixed(const exp_view *s, const dem_contact *c, base_load *load)
{
    const bool on_b = exp_view_has(s, c->id_a);
    const dem_state *under = exp_grain_of(s->n_all, s->all, on_b ? c->id_b : c->id_a);
    if (!under || !under->fixed || !(on_b || exp_view_has(s, c->id_b))) return false;
    const double lx = c->x - c->x_b, ly = c->y - c->y_b, l = rp_hypot(lx, ly), sign = on_b ? 1.0 : -1.0;
    *load = (base_load){on_b ? c->x : c->x_b, l + c->overlap - under->r,
                        sign * (c->normal_force * ly - c->shear_force * lx) / l,
                        -sign * (c->normal_force * lx + c->shear_force * ly) / l};
    return true;
}

/* Of a grain of the view on the wall. */
static bool is_of_wall(const exp_view *s, const dem_contact *c, base_load *load)
{
    bool wall = false;
    for (size_t k = 0; k < s->n_walls; k++) wall |= s->walls[k] == (size_t)c->wall;
    *load = (base_load){c->x, rp_hypot(c->x - c->x_b, c->y - c->y_b) + c->overlap, c->normal_force,
                        -c->shear_force};
    return wall && exp_view_has(s, c->id_a);
}

/* Lengths in diameters, from here on. */
static rp_status evaluate(const exp_view *s, const void *params, double out[])
{
    const size_t n_contacts = s->n_contacts;
    const dem_contact *const c = s->contacts;
    const base_params *p = params;
    RP_SCOPE(memory);
    double *x, *top, outward = 0.0, load = 0.0;
    size_t n = 0;
    stress_base base;
    for (size_t k = 0; k < s->n_walls; k++)
        if (fabs(dem_wall_now(s->sim, s->walls[k]).direction[0]) > 1e-9)
            return rp_fail(RP_NO_RESULT, "the wall is not level");
    const double ground = dem_wall_now(s->sim, s->walls[0]).point[1];
    RP_NEW(&memory, x, 4 * n_contacts);
    RP_NEW(&memory, top, 2 * s->n);
    double *r = x + n_contacts, *N = r + n_contacts, *H = N + n_contacts, *at = top + s->n;
    for (size_t k = 0; k < n_contacts; k++) {
        base_load on;
        if (c[k].id_b ? !p->fixed || !is_of_fixed(s, &c[k], &on) : !is_of_wall(s, &c[k], &on)) continue;
        x[n] = on.x / s->d, r[n] = on.r / s->d, N[n] = on.N, H[n] = on.H;
        load += N[n++];
    }
    RP_TRY(stress_base_profile(n, x, r, N, &base));
    for (size_t i = 0; i < n; i++) outward += x[i] > base.centroid ? H[i] : -H[i];
    for (size_t i = 0; i < s->n; i++)
        at[i] = s->grains[i].x / s->d, top[i] = (s->grains[i].y + s->grains[i].r - ground) / s->d;
    out[LOAD] = load, out[CENTROID] = base.centroid * s->d, out[WIDTH] = base.width * s->d;
    out[DIP] = stress_dip(base.N), out[MIDDLE] = stress_middle(base.N), out[SHEAR] = outward / load;
    for (int k = 0; k < STRESS_DIP_BINS; k++) out[N_01 + k] = base.N[k];
    RP_TRY(exp_outline_rays(s->n, at, top, &base, &out[RAYS_01]));
    out[EXCESS] = stress_excess(base.N, &out[RAYS_01]);
    return RP_OK;
}

EXP_MODULE(base, "load of a pile on a level wall under it, and its profile", "no_pile", schema, base_params,
           outputs, EXP_ON_WALL | EXP_ON_CONTACTS, .evaluate = evaluate);
