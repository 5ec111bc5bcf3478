/* Piles: made from a definition, and what is read of them. */
#include "statics/private.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    double level, updates;
} network = {.level = 0.2588, /* sin(15 degrees): largest of horizontal bonds */
             .updates = 8};   /* of sqrt(n): most contacts that change without a new factorisation */

statics_definition statics_definition_default(void)
{
    return (statics_definition){.eps = 1e-4, .k_x = 1, .mu = 1, .a = 1, .load_steps = 1};
}

const char *const statics_fault_texts[] = {
#define X(name, text) text,
    STATICS_LIST(X)
#undef X
};

/* "disks 1, 2, 3 and 5 more"; `disks` holds the first NAMED of n. */
static void name_disks(FILE *text, size_t n, const size_t disks[])
{
    fputs(n == 1 ? "disk" : "disks", text);
    for (size_t i = 0; i < n && i < NAMED; i++) fprintf(text, "%s %zu", i ? "," : "", disks[i] + 1);
    if (n > NAMED) fprintf(text, " and %zu more", n - NAMED);
}

/* ---- Making a pile ---- */

static rp_status check_disks(const statics_definition *def)
{
    if (def->n < 1 || def->n > STATICS_MAX)
        return rp_fail(RP_BAD_INPUT, "%zu disks: out of range, allowed: [1, %d]", def->n, STATICS_MAX);
    for (size_t i = 0; i < def->n; i++) {
        const statics_disk *p = &def->disks[i];
        const double overlap = p->r - p->y;
        if (!(isfinite(p->x) && isfinite(p->y) && isfinite(p->r) && p->r > 0 && p->weight > 0 &&
              isfinite(p->weight)))
            return rp_fail(RP_BAD_INPUT, "disk %zu at (%g, %g) with r = %g, weight %g: not allowed", i + 1,
                           p->x, p->y, p->r, p->weight);
        if (overlap > (def->eps > 0 ? p->r / 2 : TOUCHING))
            return rp_fail(RP_BAD_INPUT, "disk %zu at (%g, %g): below the ground", i + 1, p->x, p->y);
    }
    return RP_OK;
}

static rp_status check_definition(const statics_definition *def)
{
    RP_TRY(rp_check_range("eps", def->eps, 0, 0.1, "[0, 0.1]"));
    if (def->well == STATICS_WELL_SPRING) RP_TRY(rp_check_range("k_x", def->k_x, DBL_MIN, 1e9, "(0, 1e9]"));
    if (def->well == STATICS_WELL_FRICTION) {
        RP_TRY(rp_check_range("mu", def->mu, DBL_MIN, 1e9, "(0, 1e9]"));
        RP_TRY(rp_check_range("a", def->a, DBL_MIN, 1e9, "(0, 1e9]"));
    }
    RP_TRY(rp_check_range("set_load", def->set_load, 0, 1, "[0, 1]"));
    RP_TRY(rp_check_range("load_steps", (double)def->load_steps, 1, 1e6, "[1, 1000000]"));
    return check_disks(def);
}

static rp_status make_bonds(statics_pile *pile)
{
    const statics_definition *def = &pile->def;
    for (size_t k = 0; k < pile->n_bonds; k++) {
        const statics_disk *p = &pile->disks[pile->pairs[k].a], *q = &pile->disks[pile->pairs[k].b];
        bond *b = &pile->bonds[k];
        b->d[0] = q->x - p->x;
        b->d[1] = q->y - p->y;
        b->length = sqrt(b->d[0] * b->d[0] + b->d[1] * b->d[1]);
        b->horizontal = fabs(b->d[1]) < network.level * b->length;
        const double overlap = p->r + q->r - b->length;
        if (overlap > (def->eps > 0 ? (p->r + q->r) / 2 : TOUCHING))
            return rp_fail(RP_BAD_INPUT, "disks %u and %u overlap by %g sigma, allowed: up to %s",
                           pile->pairs[k].a + 1, pile->pairs[k].b + 1, overlap,
                           def->eps > 0 ? "half of touching" : "rounding, as eps = 0");
        b->rest = rest_overlap(overlap, def->eps);
    }
    return RP_OK;
}

static int by_x(const void *left, const void *right)
{
    const well *p = left, *q = right;
    return (p->x_0 > q->x_0) - (p->x_0 < q->x_0);
}

static void make_wells(statics_pile *pile)
{
    for (size_t i = 0; i < pile->n; i++)
        if (pile->disks[i].y - pile->disks[i].r <= TOUCHING)
            pile->wells[pile->n_wells++] = (well){.disk = (uint32_t)i, .x_0 = pile->disks[i].x};
    qsort(pile->wells, pile->n_wells, sizeof *pile->wells, by_x);
    for (size_t i = 0; i < pile->n_wells; i++) pile->wells[i].x_0 = 0; /* from here on a displacement */
}

static rp_status refuse_hanging(const statics_pile *pile, size_t n, const size_t hang[])
{
    char more[240] = "";
    FILE *text = n > 1 ? fmemopen(more, sizeof more, "w") : NULL;
    if (text) {
        fputs("; nor ", text);
        name_disks(text, n - 1, hang + 1);
        fclose(text);
    }
    return rp_fail(RP_BAD_INPUT,
                   "disk %zu at (%g, %g) has no support: its neighbours and the ground can't carry it%s",
                   hang[0] + 1, pile->disks[hang[0]].x, pile->disks[hang[0]].y, more);
}

static rp_status find_network(statics_pile *pile)
{
    statics_network net = network_of(pile);
    RP_TRY(statics_bonds_find(&net));
    pile->pairs = net.pairs;
    pile->n_bonds = net.n_pairs;
    size_t hang[NAMED + 1];
    const size_t hanging = statics_bonds_unsupported(&net, pile->trial, NAMED + 1, hang);
    if (hanging) return refuse_hanging(pile, hanging, hang);
    pile->bonds = calloc(pile->n_bonds + 1, sizeof *pile->bonds);
    pile->n_changes = (size_t)(network.updates * sqrt((double)pile->n));
    pile->changed = malloc(pile->n_changes * sizeof *pile->changed);
    pile->direction = malloc(pile->n_changes * sizeof *pile->direction);
    if (!pile->bonds || !pile->changed || !pile->direction) return no_memory(pile->n);
    RP_TRY(make_bonds(pile));
    make_wells(pile);
    const bool often = pile->n >= MANY && pile->def.eps > 0;
    return rp_stiffness_create(pile->n, pile->n_bonds, pile->pairs, often, &pile->matrix);
}

rp_status statics_create(const statics_definition *def, statics_pile **made)
{
    RP_TRY(check_definition(def));
    const size_t n = def->n;
    statics_pile *pile = calloc(1, sizeof *pile);
    if (!pile) return no_memory(n);
    pile->def = *def;
    pile->n = n;
    pile->def.disks = pile->disks = malloc(n * sizeof *pile->disks);
    pile->wells = malloc(n * sizeof *pile->wells);
    pile->block = calloc(10 * n, sizeof *pile->block);
    rp_status status = pile->disks && pile->wells && pile->block ? RP_OK : no_memory(n);
    if (!status) {
        double **const vectors[] = {&pile->w, &pile->g, &pile->p, &pile->trial, &pile->kept};
        for (size_t k = 0; k < 5; k++) *vectors[k] = pile->block + 2 * n * k;
        memcpy(pile->disks, def->disks, n * sizeof *pile->disks);
        status = find_network(pile);
    }
    if (status)
        statics_free(pile);
    else
        *made = pile;
    return status;
}

void statics_free(statics_pile *pile)
{
    if (!pile) return;
    rp_stiffness_free(pile->matrix);
    void *const parts[] = {pile->disks,     pile->pairs, pile->bonds, pile->changed,
                           pile->direction, pile->wells, pile->block, pile};
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) free(parts[k]);
}

/* ---- The end of a solve ---- */

/* Pairs that overlap now and were no neighbours. */
static rp_status check_new_overlaps(statics_pile *pile)
{
    const double eps = pile->def.eps;
    statics_disk *moved = malloc(pile->n * sizeof *moved);
    if (!moved) return no_memory(pile->n);
    for (size_t i = 0; i < pile->n; i++) {
        moved[i] = pile->disks[i];
        moved[i].x += eps * pile->w[2 * i];
        moved[i].y += eps * pile->w[2 * i + 1];
    }
    const statics_network before = network_of(pile);
    statics_network now = {pile->n, moved, 1 - TOUCHING, 0, NULL};
    rp_status status = statics_bonds_find(&now);
    for (size_t k = 0; k < now.n_pairs; k++) {
        if (statics_bonds_has(&before, now.pairs[k])) continue;
        if (pile->n_met < NAMED) pile->met[pile->n_met] = now.pairs[k];
        pile->n_met++;
    }
    free(now.pairs);
    free(moved);
    return status || !pile->n_met ? status : statics_no_result(pile, STATICS_MEETS, "");
}

static void count_contacts(statics_pile *pile)
{
    pile->result.contacts = pile->result.horizontal = 0;
    for (size_t k = 0; k < pile->n_bonds; k++) {
        const bool closed = force_of(pile, k) > 0;
        pile->result.contacts += closed;
        pile->result.horizontal += closed && pile->bonds[k].horizontal;
    }
}

/* The disk with the largest net force. */
static size_t worst_disk(const statics_pile *pile)
{
    size_t worst = 0;
    for (size_t i = 0; i < 2 * pile->n; i++)
        if (fabs(pile->g[i]) > fabs(pile->g[worst])) worst = i;
    return worst / 2;
}

static void name_wells(const statics_pile *pile, FILE *text)
{
    const statics_result *r = &pile->result;
    size_t lost[NAMED], n = 0;
    if (!r->broken) return;
    for (size_t i = 0; i < pile->n_wells && n < NAMED; i++)
        if (pile->wells[i].lost) lost[n++] = pile->wells[i].disk;
    fprintf(text, "%zu of %zu wells %s, first that of disk %zu: ", r->broken, r->wells,
            pile->def.set_again ? "set anew" : "broken", r->first_broken + 1);
    name_disks(text, r->broken, lost);
    fputs("; ", text);
}

/* Which disks moved apart, met, or are free. */
static void name_cause(const statics_pile *pile, FILE *text)
{
    const statics_fault fault = pile->result.fault;
    if (fault == STATICS_SPREADS || fault == STATICS_COLLAPSES) {
        size_t widest = 0;
        const double moved = statics_largest_stretch(pile, pile->w, &widest);
        const rp_pair apart = pile->pairs[widest];
        fprintf(text, "neighbours %u and %u moved by %.3g %s against one another; ", apart.a + 1, apart.b + 1,
                pile->eps > 0 ? pile->eps * moved : moved, pile->eps > 0 ? "sigma" : "eps sigma");
    }
    if (fault == STATICS_NOT_CONVERGED || fault == STATICS_CREEPS) fputs(pile->why, text);
    if (fault == STATICS_SINGULAR) fprintf(text, "no pivot for disk %zu; ", pile->pivots.disk + 1);
    for (size_t i = 0; i < pile->n_met && i < NAMED; i++)
        fprintf(text, "%s%u on %u", i ? ", " : "no neighbours, but disk ", pile->met[i].a + 1,
                pile->met[i].b + 1);
    if (pile->n_met > NAMED) fprintf(text, " and %zu more pairs", pile->n_met - NAMED);
    if (pile->n_met) fputs("; ", text);
}

/* The message of a solve without a result: what is known. */
static rp_status explain(const statics_pile *pile)
{
    const statics_result *r = &pile->result;
    char known[900] = "";
    FILE *text = fmemopen(known, sizeof known, "w");
    if (!text) return no_memory(pile->n);
    name_wells(pile, text);
    name_cause(pile, text);
    fprintf(text, "followed up to %g of the load", r->load);
    if (!(r->residual <= statics_tolerance(pile)))
        fprintf(text, ", then a residual of %.3g m g, on disk %zu", r->residual, worst_disk(pile) + 1);
    fclose(text);
    return rp_fail(RP_NO_RESULT, "%s: %s, after %zu steps", statics_fault_texts[r->fault], known, r->steps);
}

/* The state in which a solve ended without a result. */
static void record_state(statics_pile *pile)
{
    statics_result *r = &pile->result;
    r->residual = statics_gradient(pile, pile->w, pile->g);
    r->eps = pile->eps;
    const double slid = 1e3 * ((double)pile->n + pile->a); /* the whole weight on one K_s, and a */
    if (r->broken && statics_spread(pile, slid)) r->fault = STATICS_SPREADS;
    const bool free_disk = r->fault == STATICS_SINGULAR;
    r->negative_modes = STATICS_UNCOUNTED;
    r->smallest_pivot = free_disk ? pile->pivots.smallest : NAN;
    r->pivot_disk = free_disk ? pile->pivots.disk : pile->n;
}

rp_status statics_finish(statics_pile *pile, rp_status status)
{
    statics_result *r = &pile->result;
    /* new overlaps count also where another disk is free */
    const bool free_disk =
        status == RP_NO_RESULT && r->fault == STATICS_SINGULAR && r->residual <= statics_tolerance(pile);
    if (pile->def.eps > 0 && (!status || free_disk)) {
        rp_status met = check_new_overlaps(pile);
        if (met) status = met;
    }
    r->eps = pile->def.eps;
    if (status == RP_NO_RESULT) record_state(pile);
    count_contacts(pile);
    r->energy = statics_energy(pile);
    return status == RP_NO_RESULT ? explain(pile) : status;
}

/* ---- Reading ---- */

void statics_displacements(const statics_pile *pile, double *u)
{
    memcpy(u, pile->w, 2 * pile->n * sizeof *u);
}

void statics_base(const statics_pile *pile, size_t *disk, double *N, double *H)
{
    for (size_t i = 0; i < pile->n_wells; i++) {
        if (disk) disk[i] = pile->wells[i].disk;
        N[i] = pile->wells[i].N;
        H[i] = pile->wells[i].H;
    }
}

void statics_wells(const statics_pile *pile, statics_well *wells)
{
    for (size_t i = 0; i < pile->n_wells; i++) {
        const well *h = &pile->wells[i];
        wells[i] = (statics_well){.disk = h->disk,
                                  .x = pile->w[2 * h->disk],
                                  .x_0 = h->x_0,
                                  .N = h->N,
                                  .H = h->broken ? 0 : h->H,
                                  .state = h->broken ? STATICS_WELL_BROKEN
                                           : h->lost ? STATICS_WELL_ANEW
                                                     : STATICS_WELL_HOLDS};
    }
}

/* Uses two of the pile's vectors as work space. */
static void mark_extremes(const statics_pile *pile, statics_contact *contacts, size_t n)
{
    const double TIE = 1e-9;
    double *most = pile->p, *least = pile->trial;
    for (size_t i = 0; i < pile->n; i++) {
        most[i] = 0;
        least[i] = INFINITY;
    }
    for (size_t e = 0; e < 2 * n; e++) {
        const size_t i = e % 2 ? contacts[e / 2].b : contacts[e / 2].a;
        most[i] = fmax(most[i], contacts[e / 2].force);
        least[i] = fmin(least[i], contacts[e / 2].force);
    }
    for (size_t e = 0; e < 2 * n; e++) {
        statics_contact *c = &contacts[e / 2];
        const size_t i = e % 2 ? c->b : c->a;
        c->strongest |= c->force >= most[i] * (1 - TIE);
        c->weakest |= c->force <= least[i] * (1 + TIE);
    }
}

rp_status statics_contacts(const statics_pile *pile, statics_contact **contacts, size_t *n)
{
    const double eps = pile->result.eps, *w = pile->w;
    statics_contact *list = malloc((pile->n_bonds + 1) * sizeof *list);
    if (!list) return rp_fail(RP_NO_MEMORY, "contacts of %zu disks: out of memory", pile->n);
    *n = 0;
    for (size_t k = 0; k < pile->n_bonds; k++) {
        double dir[2], r;
        const double f = bond_force(pile, k, w, dir, &r);
        if (!(f > 0)) continue;
        const size_t a = pile->pairs[k].a, b = pile->pairs[k].b;
        list[(*n)++] = (statics_contact){.a = a,
                                         .b = b,
                                         .x = pile->disks[a].x + eps * w[2 * a],
                                         .y = pile->disks[a].y + eps * w[2 * a + 1],
                                         .x_b = pile->disks[b].x + eps * w[2 * b],
                                         .y_b = pile->disks[b].y + eps * w[2 * b + 1],
                                         .force = f,
                                         .horizontal = pile->bonds[k].horizontal};
    }
    mark_extremes(pile, list, *n);
    *contacts = list;
    return RP_OK;
}
