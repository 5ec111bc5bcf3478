/* Protocol `pile`: static equilibrium of a close-packed pile of soft disks, solved (dem/equilibrium.h), and
 * its forces on the base beside those of diagonal contacts alone. Replicas differ in the disks' sizes, if
 * these are unequal. Liffman, Chan & Hughes 1992. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <xxhash.h>

#include "stress/dip.h"
#include "sweeps/driver/outline.h"
#include "sweeps/driver/protocol.h"

typedef struct {
    long base;
    double alpha_deg, inner_deg, x_1, gap, disorder, eps, k_x, well, mu;
    int branch;
} pile_params;

#define AT(field) offsetof(pile_params, field)

/* clang-format off */
static const rp_param schema[] = {
    {"base", "", RP_INT, AT(base), "45", "[1, 1000000]", "disks in the base"},
    {"alpha_deg", "degree", RP_REAL, AT(alpha_deg), "60", "(0, 60]", "slope; of a tent alpha_1, from the edge to x_1"},
    {"inner_deg", "degree", RP_REAL, AT(inner_deg), "auto", "(0, 60) | auto",
     "alpha_2 of a tent, from x_1 to the middle; auto: no tent"},
    {"x_1", "B", RP_REAL, AT(x_1), "0.25", "(0, 0.5)", "where the slope of a tent changes"},
    {"gap", "sigma", RP_REAL, AT(gap), "0", "[0, 0.73]", "between the disks of a row; those of the diagonals touch"},
    {"disorder", "", RP_REAL, AT(disorder), "0", "[0, 0.1]",
     "radii of the disks above the base: (1 + disorder z)/2 on the same places, z normal, cut at +-3"},
    {"eps", "", RP_REAL, AT(eps), "1e-4", "[0, 0.1]", "m g/(K_s sigma); 0: the limit"},
    {"k_x", "K_s", RP_REAL, AT(k_x), "1", "(0, 1e9]", "wells that are springs, of this stiffness"},
    {"well", "eps sigma", RP_REAL, AT(well), "auto", "(0, 1e9] | auto",
     "wells of static friction instead, of this half-width a: stiffness mu N/a, broken beyond a; auto: springs"},
    {"mu", "", RP_REAL, AT(mu), "1", "(0, 1e9]", "coefficient of static friction of wells with a half-width"},
    {"branch", "", RP_CHOICE, AT(branch), "primary", "primary | minimum",
     "the state that grows from no load, stable or not; or a minimum of the energy near it"},
    {0}};
/* clang-format on */

/* clang-format off */
/* X(name, unit, meaning): OUT_name is its index among the values. */
#define OUTPUTS(X) \
    X(n_disks, "", "disks") \
    X(D, "", "mean N within 0.1 B of the centroid, less that from 0.1 B to 0.3 B, over the mean N") \
    X(D_diagonals, "", "the same of what diagonals alone carry") \
    X(N_centre, "", "N of the middle of the base over the largest") \
    X(N_centre_diagonals, "", "the same of what diagonals alone carry") \
    X(H_ratio, "", "largest H over that of diagonals alone") \
    X(thrust_ratio, "", "sum of H outwards, both halves, over that of diagonals alone") \
    X(H_slope_ratio, "", "slope of H within 0.1 B of the middle over that of diagonals alone") \
    X(N_error_rms, "", "relative deviation of N from diagonals alone, root mean square") \
    X(N_error_max, "", "the largest") \
    X(N_continuum_rms, "", "deviation of N from the continuum over its largest N, root mean square; not at 60 degrees") \
    X(H_continuum_rms, "", "the same of H") \
    X(negative_modes, "", "directions in which the state is not stable") \
    X(smallest_pivot, "K_s", "of the stiffness") \
    X(contacts, "", "between disks") \
    X(horizontal, "", "of those, in a row") \
    X(strongest_level, "", "part of the strongest contacts of the disks that is in a row") \
    X(weakest_level, "", "the same of the weakest") \
    X(broken, "", "wells of static friction that broke") \
    X(jumps, "", "times that the primary branch ended") \
    X(load, "", "part of the load up to which equilibrium was followed") \
    X(left_deg, "degree", "slope of the left side; of a tent from the edge to the top") \
    X(right_deg, "degree", "of the right side")
/* clang-format on */
enum { OUTPUTS(SWEEP_OUTPUT_INDEX) STRESS_DIP_BIN_LIST(SWEEP_BIN_INDEX) N_OUTPUTS };
static const sweep_output outputs[] = {OUTPUTS(SWEEP_OUTPUT_ROW) STRESS_DIP_BIN_LIST(SWEEP_BIN_ROW){0}};

static rp_status outline(const pile_params *p, an_point v[5], size_t *n)
{
    const double alpha = p->alpha_deg * M_PI / 180;
    *n = p->inner_deg > 0 ? 5 : 3;
    if (p->inner_deg > 0) return an_tent(alpha, p->inner_deg * M_PI / 180, p->x_1, v);
    v[0] = (an_point){0, 0};
    v[1] = (an_point){0.5, 0.5 * tan(alpha)};
    v[2] = (an_point){1, 0};
    return RP_OK;
}

static rp_status make_heap(const pile_params *p, unsigned long seed, unsigned long run, sweep_outline *heap)
{
    an_point v[5];
    size_t n;
    rp_status status = outline(p, v, &n);
    if (!status)
        status = p->inner_deg > 0 ? sweep_outline_polygon(heap, p->base, p->gap, v, n)
                                  : sweep_outline_slope(heap, p->base, p->gap,
                                                        p->alpha_deg < 60 ? p->alpha_deg * M_PI / 180 : 0);
    return status || !(p->disorder > 0) ? status : sweep_outline_disorder(heap, p->disorder, seed, run);
}

static rp_status make_pile(const pile_params *p, const sweep_outline *heap, statics_pile **pile)
{
    statics_definition def = statics_definition_default();
    def.n = heap->n;
    def.disks = heap->disks;
    def.eps = p->eps;
    def.k_x = p->k_x;
    if (p->well > 0) {
        def.well = STATICS_WELL_FRICTION;
        def.a = p->well;
        def.mu = p->mu;
    }
    def.branch = p->branch;
    return statics_create(&def, pile);
}

static rp_status check(const void *params)
{
    const pile_params *p = params;
    sweep_outline heap = {0};
    statics_pile *pile = NULL;
    rp_status status = make_heap(p, 0, 0, &heap);
    if (!status) status = make_pile(p, &heap, &pile);
    statics_free(pile);
    sweep_outline_free(&heap);
    return status;
}

/* Root mean square deviations of N and H from the continuum, over the largest of its; the continuum has none
 * at 60 degrees. */
static void compare_continuum(const pile_params *p, const sweep_outline *h, const double x[],
                              const double N[], const double H[], double deviation[2])
{
    double sum[2] = {0}, most[2] = {0};
    an_point v[5];
    size_t n;
    an_profile profile;
    deviation[0] = deviation[1] = NAN;
    if (outline(p, v, &n) || an_profile_set(&profile, v, n)) return;
    for (size_t i = 0; i < h->k; i++) {
        const double place = 0.5 + (x[i] - (x[0] + x[h->k - 1]) / 2) / h->B;
        an_force f;
        if (an_profile_force(&profile, place, &f)) return;
        sum[0] += (N[i] / h->B - f.N) * (N[i] / h->B - f.N);
        sum[1] += (H[i] / h->B - f.H) * (H[i] / h->B - f.H);
        most[0] = fmax(most[0], f.N);
        most[1] = fmax(most[1], fabs(f.H));
    }
    for (int c = 0; c < 2; c++) deviation[c] = sqrt(sum[c] / (double)h->k) / most[c];
}

static double middle_slope(const sweep_outline *h, const double x[], const double H[])
{
    const double WITHIN = 0.1, middle = (x[0] + x[h->k - 1]) / 2;
    double ours = 0, exact = 0;
    for (size_t i = 0; i < h->k; i++) {
        const double u = x[i] - middle;
        if (!(fabs(u) < WITHIN * h->B)) continue;
        ours += u * H[i];
        exact += u * h->exact[i].H;
    }
    return ours / exact;
}

/* Of the contacts that are the strongest, or the weakest, of a disk: the part in a row. */
static rp_status find_level(const statics_pile *pile, double *strongest, double *weakest)
{
    statics_contact *list;
    size_t n, all[2] = {0}, level[2] = {0};
    rp_status status = statics_contacts(pile, &list, &n);
    if (status) return status;
    for (size_t i = 0; i < n; i++) {
        all[0] += list[i].strongest;
        all[1] += list[i].weakest;
        level[0] += list[i].strongest && list[i].horizontal;
        level[1] += list[i].weakest && list[i].horizontal;
    }
    free(list);
    *strongest = (double)level[0] / (double)all[0];
    *weakest = (double)level[1] / (double)all[1];
    return RP_OK;
}

/* As protocol drop has it, from the load of the base disks alone; `exact` is that of diagonals alone. */
static rp_status base_profile(const pile_params *p, const sweep_outline *h, const double x[],
                              const double N[], const double exact[], double *v)
{
    an_point outside[5];
    size_t n = 0;
    stress_base base, diagonals;
    rp_status status = outline(p, outside, &n);
    if (!status) status = sweep_outline_base(h->k, x, N, &base);
    if (!status) status = sweep_outline_base(h->k, x, exact, &diagonals);
    if (status) return status;
    v[OUT_D] = stress_dip(base.N);
    v[OUT_D_diagonals] = stress_dip(diagonals.N);
    v[OUT_left_deg] = v[OUT_right_deg] = atan(outside[n / 2].y / 0.5) * 180 / M_PI;
    for (int k = 0; k < STRESS_DIP_BINS; k++) v[OUT_n_01 + k] = base.N[k];
    return RP_OK;
}

static rp_status measure(const pile_params *p, const sweep_outline *h, const statics_pile *pile, double *v)
{
    const size_t k = h->k;
    size_t *disk = malloc(k * sizeof *disk);
    double *x = malloc(4 * k * sizeof *x);
    rp_status status = disk && x ? RP_OK : rp_fail(RP_NO_MEMORY, "pile: out of memory");
    if (!status) {
        double *N = x + k, *H = N + k, *exact = H + k;
        statics_base(pile, disk, N, H);
        for (size_t i = 0; i < k; i++) {
            x[i] = h->disks[disk[i]].x;
            exact[i] = h->exact[i].N;
        }
        const sweep_outline_error e = sweep_outline_compare(h, N, H);
        v[OUT_N_centre] = sweep_outline_centre(k, N);
        v[OUT_N_centre_diagonals] = sweep_outline_centre(k, exact);
        v[OUT_H_ratio] = e.H_ratio;
        v[OUT_thrust_ratio] = e.thrust_ratio;
        v[OUT_N_error_rms] = e.N_rms;
        v[OUT_N_error_max] = e.N_max;
        double deviation[2];
        compare_continuum(p, h, x, N, H, deviation);
        v[OUT_N_continuum_rms] = deviation[0];
        v[OUT_H_continuum_rms] = deviation[1];
        v[OUT_H_slope_ratio] = middle_slope(h, x, H);
        status = find_level(pile, &v[OUT_strongest_level], &v[OUT_weakest_level]);
        if (!status) status = base_profile(p, h, x, N, exact, v);
    }
    free(disk);
    free(x);
    return status;
}

static rp_status run_one(const void *params, unsigned long seed, unsigned long run, sweep_result *result)
{
    const pile_params *p = params;
    sweep_outline heap = {0};
    statics_pile *pile = NULL;
    statics_result r;
    double *v = result->values;
    for (size_t i = 0; i < N_OUTPUTS; i++) v[i] = NAN;
    result->message[0] = '\0';
    rp_status status = make_heap(p, seed, run, &heap);
    if (!status) status = make_pile(p, &heap, &pile);
    if (!status) status = statics_solve(pile, &r);
    if (status == RP_OK || status == RP_NO_RESULT) {
        snprintf(result->status, sizeof result->status, "%s", statics_fault_text(r.fault));
        if (status) snprintf(result->message, sizeof result->message, "%s", rp_message());
        v[OUT_n_disks] = (double)heap.n;
        v[OUT_negative_modes] = status ? NAN : (double)r.negative_modes;
        v[OUT_smallest_pivot] = status ? NAN : r.smallest_pivot;
        v[OUT_contacts] = (double)r.contacts;
        v[OUT_horizontal] = (double)r.horizontal;
        v[OUT_broken] = (double)r.broken;
        v[OUT_jumps] = (double)r.jumps;
        v[OUT_load] = r.load;
        status = status ? RP_OK : measure(p, &heap, pile, v);
    }
    statics_free(pile);
    sweep_outline_free(&heap);
    return status;
}

/* Numbers of a small pile, to fewer digits than a solver's order of operations changes. */
static rp_status fingerprint(char digits[33])
{
    const double DIGITS = 1e6;
    static const int hashed[] = {OUT_n_disks,
                                 OUT_D,
                                 OUT_D_diagonals,
                                 OUT_H_ratio,
                                 OUT_N_error_rms,
                                 OUT_N_continuum_rms,
                                 OUT_H_continuum_rms,
                                 OUT_negative_modes,
                                 OUT_smallest_pivot,
                                 OUT_contacts,
                                 OUT_strongest_level,
                                 OUT_broken,
                                 OUT_load,
                                 OUT_n_05,
                                 -1};
    pile_params p;
    sweep_result result;
    rp_params_defaults(schema, &p);
    p.base = 12;
    p.alpha_deg = 30;
    p.disorder = 1e-4;
    p.well = 1;
    rp_status status = run_one(&p, 1, 0, &result);
    if (status) return status;
    for (size_t i = 0; i < N_OUTPUTS; i++) result.values[i] = floor(result.values[i] * DIGITS + 0.5);
    sweep_results_digits(1, &result, outputs, hashed, digits);
    return RP_OK;
}

const sweep_protocol sweep_protocol_pile = {
    .name = "pile",
    .about = "static equilibrium of a close-packed pile of soft disks (Liffman, Chan & Hughes 1992)",
    .schema = schema,
    .params_size = sizeof(pile_params),
    .outputs = outputs,
    .check = check,
    .fingerprint = fingerprint,
    .run = run_one};
