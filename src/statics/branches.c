/* The load: wells that follow it, break and are set anew; branches and where they end; kicks off a saddle. */
#include "statics/private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/random.h"

static const struct {
    int rounds, smallest;
} load = {.rounds = 100,   /* most of wells that follow N, break or are set anew */
          .smallest = 10}; /* part of the first step that the last may be */

/* From a saddle towards a minimum. */
static const struct {
    double part;
    int most, inverse, mixing;
} kicks = {.part = 0.1, /* of the largest force: displacement */
           .most = 20,
           .inverse = 30, /* steps of inverse iteration: to the least stable mode */
           .mixing = 1};  /* the same with def.leave: many modes are left in */

enum { HALVED = 1000 }; /* disks from which on a pile of half the size is solved first */

/* Let the wells' stiffness follow N; true if that changed a force. */
static bool follow_wells(statics_pile *pile)
{
    double change = 0;
    for (size_t i = 0; pile->def.well == STATICS_WELL_FRICTION && i < pile->n_wells; i++) {
        well *h = &pile->wells[i];
        const double k = h->broken ? 0 : pile->def.mu * h->N / pile->a;
        change = fmax(change, fabs((k - h->k) * (pile->w[2 * h->disk] - h->x_0)));
        if (k != h->k) pile->buckles = 0;
        h->k = k;
    }
    return change > statics_tolerance(pile);
}

/* Break, or set anew, the wells that their disks have left; true if there are any. */
static bool break_wells(statics_pile *pile)
{
    bool any = false;
    for (size_t i = 0; pile->def.well == STATICS_WELL_FRICTION && i < pile->n_wells; i++) {
        well *h = &pile->wells[i];
        const double x = pile->w[2 * h->disk];
        if (h->broken || fabs(x - h->x_0) <= pile->a) continue;
        if (!pile->result.broken) pile->result.first_broken = h->disk;
        pile->result.broken += !h->lost;
        h->lost = true;
        h->x_0 = x;
        h->broken = !pile->def.set_again;
        any = true;
    }
    return any;
}

/* Equilibrium, no well breaking. */
static rp_status converge(statics_pile *pile, bool start, int mode)
{
    for (int round = 0; round < load.rounds; round++, start = false) {
        rp_status status = statics_newton(pile, start, mode);
        if (status || !follow_wells(pile)) return status;
    }
    return statics_no_result(pile, STATICS_NOT_CONVERGED, "the wells' stiffness does not settle; ");
}

/* Equilibrium, with the wells that hold. */
static rp_status settle(statics_pile *pile, int mode)
{
    for (int round = 0; round < load.rounds; round++) {
        rp_status status = converge(pile, false, mode);
        if (status || !break_wells(pile)) return status;
        follow_wells(pile);
    }
    return statics_no_result(pile, STATICS_CREEPS, "wells are left as often as they are set anew; ");
}

/* A branch that is lost as wells break: the descent from the last equilibrium, under the whole load, tells
 * whether the pile comes apart or comes to rest on another branch. */
static rp_status descend_from_kept(statics_pile *pile, double to)
{
    memcpy(pile->w, pile->kept, 2 * pile->n * sizeof *pile->w);
    pile->eps = to;
    pile->factored = false;
    rp_status status = settle(pile, STRIDE);
    return status ? status
                  : statics_no_result(pile, STATICS_NOT_CONVERGED,
                                      "the branch was lost as wells broke, but downhill there is rest; ");
}

/* Raise eps from 0, where w is the linearised solution, to `to`. A step that fails is halved, one that
 * succeeds doubled. Where the smallest fails the branch has ended: the pile jumps downhill, and stays at
 * minima from there on. */
static rp_status raise_eps(statics_pile *pile, double to)
{
    double *reached = &pile->result.load;
    const double most = 1 / (double)pile->def.load_steps;
    int mode = pile->def.branch == STATICS_BRANCH_MINIMUM && !pile->def.leave ? STRIDE : FOLLOW;
    for (double step = most; *reached < 1;) {
        step = fmin(step, 1 - *reached);
        memcpy(pile->kept, pile->w, 2 * pile->n * sizeof *pile->w);
        pile->eps = (*reached + step) * to;
        pile->factored = false;
        rp_status status = settle(pile, mode);
        if (!status) {
            pile->buckles = 0;
            *reached = 1 - *reached > step ? *reached + step : 1;
            step = fmin(2 * step, most);
            continue;
        }
        step /= 2;
        const bool ended = step < most / load.smallest;
        if (status != RP_NO_RESULT || (mode == STRIDE && ended)) return status;
        if (pile->result.broken)
            return mode == FOLLOW && pile->result.fault == STATICS_NOT_CONVERGED ? descend_from_kept(pile, to)
                                                                                 : status;
        memcpy(pile->w, pile->kept, 2 * pile->n * sizeof *pile->w);
        if (ended) {
            mode = STRIDE;
            pile->result.jumps = 1;
            step = most;
        }
    }
    return RP_OK;
}

static rp_status solve_linear(statics_pile *pile, double a);

/* The pile of half the size, made and solved; NULL where there is none or it has no solution. */
static rp_status solve_half(const statics_pile *pile, double a, rp_pair *parents, statics_pile **solved)
{
    statics_definition def = pile->def;
    statics_disk *disks = NULL;
    statics_pile *half = NULL;
    const statics_network net = network_of(pile);
    rp_status status = statics_bonds_halve(&net, &disks, &def.n, parents);
    def.disks = disks;
    def.k_x *= 2; /* half the force, a quarter of the displacement */
    if (!status && def.n > 0) status = statics_create(&def, &half);
    if (half) status = solve_linear(half, a / 4);
    free(disks);
    if (status) {
        statics_free(half);
        half = NULL;
    }
    *solved = half;
    return status == RP_NO_MEMORY ? status : RP_OK;
}

/* Friction wells as under the N of the half-size pile, which is half of N here. */
static void expect_wells(statics_pile *pile, const statics_pile *half, const rp_pair parents[])
{
    for (size_t i = 0; i < pile->n_wells; i++) {
        const rp_pair from = parents[pile->wells[i].disk];
        if (from.a >= half->n || from.b >= half->n) continue;
        const double N = ground_force(half, from.a, half->w) + ground_force(half, from.b, half->w);
        if (N > 0) pile->wells[i].k = pile->def.mu * N / pile->a;
    }
}

/* Contacts that are expected to carry a force: all but the horizontal ones; if all neighbours touch, those
 * that do at the same position in the linearised pile of half the size. The solution does not need it. */
static rp_status expect_contacts(statics_pile *pile, double a)
{
    bool touching = pile->n >= HALVED;
    for (size_t k = 0; k < pile->n_bonds; k++) {
        pile->bonds[k].expected = !pile->bonds[k].horizontal;
        touching &= !(fabs(pile->bonds[k].rest) > 0);
    }
    if (!touching) return RP_OK;
    statics_pile *half = NULL;
    rp_pair *parents = malloc(pile->n * sizeof *parents);
    if (!parents) return no_memory(pile->n);
    rp_status status = solve_half(pile, a, parents, &half);
    for (size_t i = 0; half && i < 2 * pile->n; i++) {
        const size_t p = parents[i / 2].a, q = parents[i / 2].b;
        pile->w[i] = p < half->n && q < half->n ? half->w[2 * p + i % 2] + half->w[2 * q + i % 2] : NAN;
    }
    for (size_t k = 0; half && k < pile->n_bonds; k++) {
        const double f = force_of(pile, k);
        if (!isnan(f)) pile->bonds[k].expected = f > 0;
    }
    if (half && pile->def.well == STATICS_WELL_FRICTION && pile->n >= MANY) expect_wells(pile, half, parents);
    statics_free(half);
    free(parents);
    return status;
}

/* The linearised state, its wells at their x_0 with the half-width a. */
static rp_status solve_linear(statics_pile *pile, double a)
{
    const statics_definition *def = &pile->def;
    const double even = def->mu / a * (double)pile->n / (double)pile->n_wells; /* until N is known */
    for (size_t i = 0; i < pile->n_wells; i++) {
        pile->wells[i].broken = pile->wells[i].lost = false;
        pile->wells[i].k = def->well == STATICS_WELL_SPRING ? def->k_x : even;
    }
    pile->factored = false;
    pile->soften = pile->eps = pile->buckles = 0;
    pile->a = a;
    pile->result = (statics_result){.wells = pile->n_wells, .first_broken = pile->n, .released = NAN};
    rp_status status = expect_contacts(pile, a);
    memset(pile->w, 0, 2 * pile->n * sizeof *pile->w);
    return status ? status : converge(pile, true, DESCEND);
}

/* The state at `eps`. */
static rp_status find_state(statics_pile *pile, double eps, double a)
{
    RP_TRY(solve_linear(pile, a));
    if (eps > 0) return raise_eps(pile, eps);
    const rp_status status = settle(pile, DESCEND);
    pile->result.load = !status;
    return status;
}

/* x_0 where the disks stand under a part of the load: eps is in proportion to the weight, and with it the
 * unit of displacements. */
static rp_status set_wells(statics_pile *pile, double part)
{
    rp_status status = find_state(pile, part * pile->def.eps, pile->def.a / part);
    if (status) pile->result.load *= part;
    for (size_t i = 0; !status && i < pile->n_wells; i++)
        pile->wells[i].x_0 = part * pile->w[2 * pile->wells[i].disk];
    return status;
}

/* Leave a saddle close to its least stable mode, by inverse iteration with the stiffness shifted until it is
 * positive. After few iterations the direction is a mixture of unstable modes. */
static rp_status kick(statics_pile *pile)
{
    const int steps = pile->def.leave ? kicks.mixing : kicks.inverse;
    rp_random rng = rp_random_of(pile->def.leave, 0, RP_PURPOSE_DIRECTION);
    rp_status status = RP_OK;
    double shift = 1e-6;
    do {
        statics_assemble(pile, false, 0, shift, true);
        status = rp_stiffness_factorise(pile->matrix, &pile->pivots);
        pile->result.factored++;
        shift *= 2;
    } while (!status && (pile->pivots.negative || !(pile->pivots.smallest > 0)));
    for (size_t i = 0; i < 2 * pile->n; i++) pile->p[i] = rp_random_uniform(&rng) - 0.5;
    for (int step = 0; !status && step < steps; step++) {
        const double scale = 1 / largest(pile->p, 2 * pile->n);
        for (size_t i = 0; i < 2 * pile->n; i++) pile->p[i] *= scale;
        status = rp_stiffness_solve(pile->matrix, pile->p, pile->p);
    }
    if (status) return status;
    const double scale =
        kicks.part * statics_largest_force(pile) / statics_largest_stretch(pile, pile->p, NULL);
    for (size_t i = 0; i < 2 * pile->n; i++) pile->w[i] += scale * pile->p[i];
    pile->factored = false;
    return RP_OK;
}

static rp_status go_to_minimum(statics_pile *pile)
{
    const double primary = statics_energy(pile);
    for (int i = 0; pile->result.negative_modes && i < kicks.most; i++) {
        RP_TRY(kick(pile));
        RP_TRY(settle(pile, DESCEND));
        RP_TRY(statics_count_modes(pile));
    }
    if (pile->def.leave && !pile->result.jumps) pile->result.released = primary - statics_energy(pile);
    return pile->result.negative_modes
               ? statics_no_result(pile, STATICS_NOT_CONVERGED, "no stable state downhill; ")
               : RP_OK;
}

rp_status statics_solve(statics_pile *pile, statics_result *result)
{
    const statics_definition *def = &pile->def;
    for (size_t i = 0; i < pile->n_wells; i++) pile->wells[i].x_0 = 0;
    pile->n_met = 0;
    rp_status status = def->set_load > 0 ? set_wells(pile, def->set_load) : RP_OK;
    if (!status) status = find_state(pile, def->eps, def->a);
    if (!status) status = statics_count_modes(pile);
    if (!status && (def->branch == STATICS_BRANCH_MINIMUM || pile->result.jumps))
        status = go_to_minimum(pile);
    status = statics_finish(pile, status);
    *result = pile->result;
    return status;
}
