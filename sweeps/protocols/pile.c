/* Protocol `pile`: static equilibrium of a close-packed pile of soft disks, solved (statics/equilibrium.h),
 * and its forces on the base beside those of diagonal contacts alone. Replicas differ in the disks' sizes, if
 * these are unequal. Liffman, Chan & Hughes 1992. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "core/elementary.h"
#include "sweeps/protocols/protocols.h"
#include "sweeps/protocols/pile.h"

#define AT(field) offsetof(sweep_pile, field)

/* clang-format off */
const rp_param sweep_pile_schema[] = {
    {"eps", "", RP_REAL, AT(eps), "1e-4", "[0, 0.1]", "softness m g/(K_s sigma); 0: the linearised limit eps -> 0"},
    {"base", "", RP_INT, AT(base), "45", "[1, 1000000]", "disks in the base"},
    {"alpha_deg", "degree", RP_REAL, AT(alpha_deg), "60", "(0, 60]", "slope; 60: the full triangle; for a tent alpha_1, from the edge to x_1"},
    {"inner_deg", "degree", RP_REAL, AT(inner_deg), "auto", "(0, 60) | auto",
     "alpha_2 of a tent, from x_1 to the middle; auto: no tent"},
    {"x_1", "B", RP_REAL, AT(x_1), "0.25", "(0, 0.5)", "position where the slope of a tent changes"},
    {"gap", "sigma", RP_REAL, AT(gap), "0", "[0, 0.73]", "gap between the disks of a row; those of the diagonals touch"},
    {"disorder", "", RP_REAL, AT(disorder), "0", "[0, 0.1]",
     "S: radii of the disks above the base are (1 + S z)/2 on the same lattice, with z normal, cut at +-3"},
    {"k_x", "K_s", RP_REAL, AT(k_x), "1", "(0, 1e9]", "stiffness of wells that are springs and never break"},
    {"well", "eps sigma", RP_REAL, AT(well), "auto", "(0, 1e9] | auto",
     "use wells of static friction of this half-width a instead: stiffness mu N/a, broken beyond a; auto: springs"},
    {"mu", "", RP_REAL, AT(mu), "1", "(0, 1e9]", "coefficient of static friction of wells with a half-width"},
    {"set_again", "", RP_BOOL, AT(set_again), "false", "", "set a broken well again where its disk then is; otherwise it stays broken", true},
    {"set_load", "", RP_REAL, AT(set_load), "0", "[0, 1]",
     "fraction of the load under which the positions of the disks become x_0 of the wells; 0: positions in the lattice", true},
    {"branch", "", RP_CHOICE, AT(branch), "primary", "primary | minimum",
     "primary: the state that grows from no load, stable or not; minimum: a minimum of the energy near it"},
    {"leave", "", RP_INT, AT(leave), "0", "[0, 2147483647]",
     "for branch = minimum: leave the primary state along unstable direction number N, drawn at random; 0: downhill from the "
     "linearised state", true},
    {"load_steps", "", RP_INT, AT(load_steps), "1", "[1, 1000000]", "number of steps in which the load is raised", true},
    {"threshold", "", RP_BOOL, AT(threshold), "false", "",
     "find instead, from eps on, the eps_c above which the primary branch is not stable", true},
    {0}};

#define OUTPUTS(X) \
    X(n_disks, "", "disks") \
    X(D, "", "mean N within 0.1 B of the centroid, less that from 0.1 B to 0.3 B, over the mean N") \
    X(D_diagonals, "", "D of the forces by diagonal contacts alone") \
    X(middle, "", "mean N within 0.1 B of the centroid, less that from 0.1 B to 0.2 B, over the mean N") \
    X(middle_diagonals, "", "middle of the forces by diagonal contacts alone") \
    X(excess, "", "N less that of diagonal contacts alone, mean within 0.1 B of the centroid, over the mean N") \
    X(H_ratio, "", "largest H over that of diagonals alone") \
    X(thrust_ratio, "", "sum of H outwards, both halves, over that of diagonals alone") \
    X(H_slope_ratio, "", "slope of H within 0.1 B of the middle over that of diagonals alone") \
    X(N_error_rms, "", "relative deviation of N from diagonals alone, root mean square") \
    X(N_error_max, "", "relative deviation of N from diagonals alone, largest") \
    X(N_continuum_rms, "", "deviation of N from the continuum over its largest N, root mean square; not at 60 degrees") \
    X(H_continuum_rms, "", "deviation of H from the continuum over its largest H, root mean square; not at 60 degrees") \
    X(negative_modes, "", "directions in which the state is not stable") \
    X(smallest_pivot, "K_s", "smallest pivot of the factorised stiffness; near 0 the pile can move freely") \
    X(contacts, "", "contacts between disks") \
    X(horizontal, "", "contacts between disks of one row") \
    X(strongest_level, "", "share of the strongest contacts of the disks that lie within a row") \
    X(weakest_level, "", "share of the weakest contacts of the disks that lie within a row") \
    X(broken, "", "wells of static friction that broke") \
    X(jumps, "", "times that the primary branch ended") \
    X(load, "", "part of the load up to which equilibrium was followed") \
    X(H_N_max, "", "friction that the base must have: largest |H|/N of its disks") \
    X(H_N_max_diagonals, "", "H_N_max of the forces by diagonal contacts alone") \
    X(residual, "m g", "largest net force on a disk") \
    X(energy, "m g eps sigma", "potential energy, 0 before any load") \
    X(released, "m g eps sigma", "energy of the primary state less that of a minimum") \
    X(eps_c, "", "of threshold = true: eps up to which the primary branch is stable") \
    X(left_deg, "degree", "slope of the left side; of a tent from the edge to the top") \
    X(right_deg, "degree", "slope of the right side; of a tent from the edge to the top")
/* clang-format on */
#define MEMBER(name, unit, meaning) double name;
#define ROW(name, unit, meaning)    {#name, unit, meaning},
#define BIN_ROW(k)                  {"n_" #k, "", "pressure in bin " #k " of 20 of the base, left to right, over the mean"},
typedef struct {
    OUTPUTS(MEMBER)
    double n[STRESS_DIP_BINS]; /* as `repose stress dip` reads them */
} pile_values;
static const sweep_output outputs[] = {OUTPUTS(ROW) STRESS_DIP_BIN_LIST(BIN_ROW){0}};
static_assert(sizeof(pile_values) == sizeof(double) * (sizeof outputs / sizeof *outputs - 1) &&
                  sizeof(pile_values) <= sizeof(double) * SWEEP_MAX_OUTPUTS,
              "each output is a member of the values");

static rp_status outline(const sweep_pile *p, an_point v[5], size_t *n)
{
    const double alpha = p->alpha_deg * M_PI / 180;
    *n = p->inner_deg > 0 ? 5 : 3;
    if (p->inner_deg > 0) return an_tent(alpha, p->inner_deg * M_PI / 180, p->x_1, v);
    v[0] = (an_point){0, 0};
    v[1] = (an_point){0.5, 0.5 * rp_tan(alpha)};
    v[2] = (an_point){1, 0};
    return RP_OK;
}

/* The disks that the parameters describe, or only their number. */
static rp_status make_outline(const sweep_pile *p, bool counted_only, sweep_outline *h)
{
    an_point v[5];
    size_t n;
    rp_status status = outline(p, v, &n);
    return status ? status
                  : (counted_only ? sweep_outline_count : sweep_outline_make)(
                        h, p->base, p->gap, p->alpha_deg < 60 ? p->alpha_deg * M_PI / 180 : 0,
                        p->inner_deg > 0 ? n : 0, v);
}

rp_status sweep_pile_outline(const sweep_pile *p, unsigned long seed, unsigned long run, sweep_outline *h)
{
    rp_status status = make_outline(p, false, h);
    return status || !(p->disorder > 0) ? status : sweep_outline_disorder(h, p->disorder, seed, run);
}

static statics_definition define(const sweep_pile *p, const sweep_outline *h)
{
    statics_definition def = statics_definition_default();
    def.n = h->n;
    def.disks = h->disks;
    def.eps = p->eps;
    def.k_x = p->k_x;
    if (p->well > 0) {
        def.well = STATICS_WELL_FRICTION;
        def.a = p->well;
        def.mu = p->mu;
    }
    def.set_again = p->set_again;
    def.set_load = p->set_load;
    def.branch = p->branch;
    def.leave = (unsigned long)p->leave;
    def.load_steps = p->load_steps;
    return def;
}

static rp_status check(const void *params)
{
    const sweep_pile *p = params;
    if (p->threshold && (!(p->eps > 0) || p->branch))
        return rp_fail(RP_BAD_INPUT, "threshold = true: starts from eps > 0, on branch = \"primary\"");
    if (p->leave && (!p->branch || !(p->eps > 0)))
        return rp_fail(RP_BAD_INPUT, "leave = %ld: needs branch = \"minimum\" and eps > 0", p->leave);
    if (p->set_again && !(p->well > 0))
        return rp_fail(RP_BAD_INPUT, "set_again = true: needs wells of a half-width, which can break");
    /* counting needs no memory for the disks; the rest shows in a small pile */
    enum { SMALL = 40 };
    RP_ENDS(sweep_outline_free) sweep_outline all = {0}, h = {0};
    statics_pile *pile = NULL;
    sweep_pile small = *p;
    if (small.base > SMALL) small.base = SMALL + p->base % 2;
    RP_TRY(make_outline(p, true, &all));
    RP_TRY(sweep_pile_outline(&small, 0, 0, &h));
    const statics_definition def = define(p, &h);
    const rp_status status = statics_create(&def, &pile);
    statics_free(pile);
    return status;
}

/* Slopes of the outline, and root mean square deviations of N and H from its continuum, over the largest of
 * its; the continuum has none at 60 degrees. */
static void compare_continuum(const sweep_solved *s, const double x[], pile_values *v)
{
    const sweep_outline *h = s->h;
    double sum[2] = {0}, most[2] = {0};
    an_point corners[5];
    size_t n;
    an_profile profile;
    if (outline(s->p, corners, &n)) return;
    v->left_deg = v->right_deg = rp_atan(corners[n / 2].y / 0.5) * 180 / M_PI;
    if (an_profile_set(&profile, corners, n)) return;
    for (size_t i = 0; i < h->k; i++) {
        const double at = 0.5 + (x[i] - (x[0] + x[h->k - 1]) / 2) / h->B;
        an_force f;
        if (an_profile_force(&profile, at, &f)) return;
        sum[0] += (s->N[i] / h->B - f.N) * (s->N[i] / h->B - f.N);
        sum[1] += (s->H[i] / h->B - f.H) * (s->H[i] / h->B - f.H);
        most[0] = fmax(most[0], f.N);
        most[1] = fmax(most[1], fabs(f.H));
    }
    v->N_continuum_rms = sqrt(sum[0] / (double)h->k) / most[0];
    v->H_continuum_rms = sqrt(sum[1] / (double)h->k) / most[1];
}

/* Of the contacts that are the strongest, or the weakest, of a disk: the part in a row. */
static rp_status find_level(const statics_pile *pile, pile_values *v)
{
    statics_contact *list;
    size_t n, all[2] = {0}, level[2] = {0};
    RP_TRY(statics_contacts(pile, &list, &n));
    for (size_t i = 0; i < n; i++) {
        all[0] += list[i].strongest;
        all[1] += list[i].weakest;
        level[0] += list[i].strongest && list[i].horizontal;
        level[1] += list[i].weakest && list[i].horizontal;
    }
    free(list);
    v->strongest_level = (double)level[0] / (double)all[0];
    v->weakest_level = (double)level[1] / (double)all[1];
    return RP_OK;
}

/* As of protocol drop, from the load of the base disks alone. A single disk has no profile. Diagonal contacts
 * alone, `exact`, are rays of 60 degrees under the pile's own steps. */
static rp_status base_profile(size_t k, const double x[], const double r[], const double N[],
                              const double exact[], pile_values *v)
{
    stress_base base, diagonals;
    double rays[STRESS_DIP_BINS];
    rp_status status = stress_base_profile(k, x, r, N, &base);
    if (status) return status == RP_NO_RESULT ? RP_OK : status;
    memcpy(v->n, base.N, sizeof base.N);
    v->D = stress_dip(base.N);
    v->middle = stress_middle(base.N);
    stress_base_bins(&base, k, x, r, exact, rays);
    v->excess = stress_excess(base.N, rays);
    status = stress_base_profile(k, x, r, exact, &diagonals);
    v->D_diagonals = stress_dip(diagonals.N);
    v->middle_diagonals = stress_middle(diagonals.N);
    return status;
}

/* Beside diagonals alone, `exact` is room for 2 k numbers. */
static void compare_diagonals(sweep_solved *s, const double x[], double exact[], pile_values *v)
{
    const sweep_outline *h = s->h;
    const size_t k = h->k;
    const double WITHIN = 0.1, middle = (x[0] + x[k - 1]) / 2;
    double squares = 0, most = 0, H_most = 0, exact_most = 0, thrust = 0, exact_thrust = 0, slope = 0,
           exact_slope = 0;
    for (size_t i = 0; i < k; i++) {
        exact[i] = h->exact[i].N;
        exact[k + i] = h->exact[i].H;
        const double e = s->N[i] / exact[i] - 1, u = x[i] - middle,
                     side = 2 * i + 1 > k   ? 1
                            : 2 * i + 1 < k ? -1
                                            : 0;
        squares += e * e;
        most = fmax(most, fabs(e));
        H_most = fmax(H_most, fabs(s->H[i]));
        exact_most = fmax(exact_most, fabs(exact[k + i]));
        thrust += side * s->H[i];
        exact_thrust += side * exact[k + i];
        if (!(fabs(u) < WITHIN * h->B)) continue;
        slope += u * s->H[i];
        exact_slope += u * exact[k + i];
    }
    v->H_N_max_diagonals = sweep_outline_friction(k, exact, exact + k);
    v->H_ratio = s->H_ratio = fabs(H_most / exact_most); /* no sign of 0/0 */
    v->thrust_ratio = thrust / exact_thrust;
    v->N_error_rms = s->N_error_rms = sqrt(squares / (double)k);
    v->N_error_max = s->N_error_max = most;
    v->H_slope_ratio = slope / exact_slope;
}

static rp_status measure(sweep_solved *s, pile_values *v)
{
    RP_SCOPE(memory);
    const size_t k = s->r.wells;
    double *x;
    RP_NEW(&memory, x, 4 * k);
    double *r = x + k, *exact = r + k;
    for (size_t i = 0; i < k; i++) {
        x[i] = s->h->disks[s->disk[i]].x;
        r[i] = 0.5;
    }
    compare_diagonals(s, x, exact, v);
    RP_TRY(base_profile(k, x, r, s->N, exact, v));
    RP_TRY(find_level(s->pile, v));
    v->H_N_max = sweep_outline_friction(k, s->N, s->H);
    compare_continuum(s, x, v);
    return RP_OK;
}

rp_status sweep_pile_solve(const sweep_pile *p, const sweep_outline *h,
                           void (*watch)(size_t n, const statics_result *so_far, void *context),
                           void *context, sweep_solved *s, sweep_result *results)
{
    statics_definition def = define(p, h);
    def.watch = watch;
    def.context = context;
    *s = (sweep_solved){.p = p, .h = h, .N_error_rms = NAN, .N_error_max = NAN, .H_ratio = NAN};
    sweep_result_clear(results);
    pile_values *const v = (void *)results->values;
    v->n_disks = (double)h->n;
    rp_status status = statics_create(&def, &s->pile);
    if (!status) status = statics_solve(s->pile, &s->r);
    if (status && status != RP_NO_RESULT) return status;
    sweep_conclude(results, statics_fault_texts[s->r.fault], "%s", status ? rp_message() : "");
    v->negative_modes = status ? NAN : (double)s->r.negative_modes;
    v->smallest_pivot = status ? NAN : s->r.smallest_pivot;
    v->contacts = (double)s->r.contacts;
    v->horizontal = (double)s->r.horizontal;
    v->broken = (double)s->r.broken;
    v->jumps = (double)s->r.jumps;
    v->load = s->r.load;
    v->residual = s->r.residual;
    v->energy = s->r.energy;
    v->released = s->r.released;
    if (status) return rp_fail(status, "%s", results->message);
    RP_NEW(&s->memory, s->disk, s->r.wells);
    RP_NEW(&s->memory, s->N, 2 * s->r.wells);
    s->H = s->N + s->r.wells;
    statics_base(s->pile, s->disk, s->N, s->H);
    return measure(s, v);
}

void sweep_solved_free(sweep_solved *s)
{
    statics_free(s->pile);
    rp_arena_end(&s->memory);
}

static rp_status is_stable(const sweep_pile *p, const sweep_outline *h, double eps, bool *stable,
                           statics_result *r)
{
    statics_pile *pile = NULL;
    statics_definition def = define(p, h);
    def.eps = eps;
    rp_status status = statics_create(&def, &pile);
    if (!status) status = statics_solve(pile, r);
    if (!status) *stable = r->negative_modes == 0;
    statics_free(pile);
    return status;
}

rp_status sweep_pile_threshold(const sweep_pile *p, const sweep_outline *h, sweep_result *results)
{
    const double PRECISION = 1e-4, WIDEN = 2, EPS_MAX = 0.1;
    double lo = 0, hi = 0, eps = p->eps;
    sweep_result_clear(results);
    pile_values *const v = (void *)results->values;
    v->n_disks = (double)h->n;
    while (!(lo > 0 && hi > 0 && hi / lo < 1 + PRECISION)) {
        bool stable = false;
        statics_result r;
        rp_status status = is_stable(p, h, eps, &stable, &r);
        if (status == RP_NO_RESULT) {
            rp_prefix(status, "stable up to eps = %g; at eps = %g ", lo, eps);
            return sweep_conclude(results, statics_fault_texts[r.fault], "%s", rp_message());
        }
        if (status) return status;
        *(stable ? &lo : &hi) = eps;
        if (!(lo < EPS_MAX)) {
            rp_fail(RP_NO_RESULT, "stable up to eps = %g: no threshold below", lo);
            return sweep_conclude(results, "no_threshold", "%s", rp_message());
        }
        eps = !(hi > 0) ? fmin(lo * WIDEN, EPS_MAX) : !(lo > 0) ? hi / WIDEN : sqrt(lo * hi);
    }
    v->eps_c = lo;
    return sweep_conclude(results, "ok", NULL);
}

static rp_status run_one(const void *params, unsigned long seed, unsigned long run,
                         const sweep_tables *tables, sweep_result *results)
{
    const sweep_pile *p = params;
    RP_ENDS(sweep_outline_free) sweep_outline h = {0};
    RP_ENDS(sweep_solved_free) sweep_solved s = {0};
    rp_status status = sweep_pile_outline(p, seed, run, &h);
    if (!status)
        status = p->threshold ? sweep_pile_threshold(p, &h, results)
                              : sweep_pile_solve(p, &h, NULL, NULL, &s, results);
    if (status && status != RP_NO_RESULT) return status; /* that is a row with its status */
    return tables && tables->directory && s.pile ? sweep_pile_write(&s, tables) : RP_OK;
}

const sweep_protocol sweep_protocol_pile = {
    .name = "pile",
    .about = "static equilibrium of a close-packed pile of soft disks (Liffman, Chan & Hughes 1992)",
    .schema = sweep_pile_schema,
    .params_size = sizeof(sweep_pile),
    .outputs = outputs,
    .check = check,
    .run = run_one};
