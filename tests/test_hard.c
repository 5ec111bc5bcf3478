/* Hard collisions: conservation, energy, Coulomb's law, over random pairs; the paper's misprints. */
#include "dem/dem.h"
#include "tests/check.h"
#include "tests/numbers.h"

/* Sums of some 20 rounded terms, relative to their size: 1e-13 is 450 units. */
static const double ROUND = 1e-13;

typedef struct {
    dem_body one, two; /* before */
    double n[2], e, mu;
} pair;

static double uniform(gsl_rng *r, double lo, double hi)
{
    return lo + (hi - lo) * gsl_rng_uniform(r);
}

static dem_body random_body(gsl_rng *r)
{
    dem_body b = {{uniform(r, -3.0, 3.0), uniform(r, -3.0, 3.0)}, .arm = uniform(r, 0.05, 0.5)};
    const double m = pow(10.0, uniform(r, -1.0, 1.0));
    b.inverse_mass = 1.0 / m;
    b.omega = uniform(r, -3.0, 3.0) / b.arm;
    b.inverse_inertia = 1.0 / dem_inertia(gsl_rng_get(r) & 1 ? DEM_DISK : DEM_SPHERE, m, b.arm);
    return b;
}

/* Every fourth with a wall, which may move; some without friction, some without rotation. */
static pair random_pair(gsl_rng *r, int k)
{
    pair p = {random_body(r), random_body(r)};
    const double angle = uniform(r, 0.0, 2.0 * M_PI);
    p.n[0] = cos(angle), p.n[1] = sin(angle);
    p.e = k % 7 == 0 ? 0.0 : k % 7 == 1 ? 1.0 : uniform(r, 0.0, 1.0);
    p.mu = k % 5 == 0 ? 0.0 : uniform(r, 0.0, 1.5);
    if (k % 4 == 0) p.two = (dem_body){.v = {p.two.v[0], p.two.v[1]}};
    if (k % 9 == 0) p.one.omega = p.two.omega = p.one.inverse_inertia = p.two.inverse_inertia = 0.0;
    return p;
}

/* Relative velocity of the surfaces along n and t, from 1 as seen from 2: (9) written out. */
static void surfaces(const dem_body *a, const dem_body *b, const double n[2], double *v_n, double *v_t)
{
    /* omega x arm, arm = +arm_1 n on body 1 and -arm_2 n on body 2 */
    const double ux = a->v[0] - a->omega * a->arm * n[1] - (b->v[0] + b->omega * b->arm * n[1]);
    const double uy = a->v[1] + a->omega * a->arm * n[0] - (b->v[1] - b->omega * b->arm * n[0]);
    *v_n = ux * n[0] + uy * n[1];
    *v_t = -ux * n[1] + uy * n[0];
}

static double kinetic(const dem_body *b)
{
    double e = 0.0;
    if (b->inverse_mass > 0.0) e += 0.5 * (b->v[0] * b->v[0] + b->v[1] * b->v[1]) / b->inverse_mass;
    if (b->inverse_inertia > 0.0) e += 0.5 * b->omega * b->omega / b->inverse_inertia;
    return e;
}

/* In the frame of body 2, which may be a wall that moves. */
static double energy(const dem_body *a, const dem_body *b, const double frame[2])
{
    dem_body p = *a, q = *b;
    for (int k = 0; k < 2; k++) p.v[k] -= frame[k], q.v[k] -= frame[k];
    return kinetic(&p) + kinetic(&q);
}

/* Moment about the origin, contact at (0.7, -1.9), and the size of its terms. */
static double moment(const dem_body *b, const double n[2], double side, double *size)
{
    const double x = 0.7 + side * b->arm * n[0], y = -1.9 + side * b->arm * n[1];
    double l = (x * b->v[1] - y * b->v[0]) / b->inverse_mass, s = 0.0;
    if (b->inverse_inertia > 0.0) s = b->omega / b->inverse_inertia;
    *size += (fabs(x * b->v[1]) + fabs(y * b->v[0])) / b->inverse_mass + fabs(s);
    return l + s;
}

static void check_conserved(const pair *p, const dem_body *a, const dem_body *b)
{
    for (int k = 0; k < 2; k++) {
        const double before = p->one.v[k] / p->one.inverse_mass + p->two.v[k] / p->two.inverse_mass;
        const double after = a->v[k] / a->inverse_mass + b->v[k] / b->inverse_mass;
        const double size = fabs(p->one.v[k]) / p->one.inverse_mass +
                            fabs(p->two.v[k]) / p->two.inverse_mass + fabs(a->v[k]) / a->inverse_mass +
                            fabs(b->v[k]) / b->inverse_mass;
        CHECK_NEAR(after - before, 0.0, ROUND * size);
    }
    if (p->one.inverse_inertia == 0.0) return; /* the constraint on rotation takes the moment */
    double size = 0.0;
    const double before = moment(&p->one, p->n, -1.0, &size) + moment(&p->two, p->n, 1.0, &size);
    const double after = moment(a, p->n, -1.0, &size) + moment(b, p->n, 1.0, &size);
    CHECK_NEAR(after - before, 0.0, ROUND * size);
}

/* The header's closed form. */
static double energy_lost(const pair *p, const dem_impulse *impulse)
{
    double v_n, v_t;
    surfaces(&p->one, &p->two, p->n, &v_n, &v_t);
    const double inverse_n = p->one.inverse_mass + p->two.inverse_mass;
    const double inverse_t = inverse_n + p->one.arm * p->one.arm * p->one.inverse_inertia +
                             p->two.arm * p->two.arm * p->two.inverse_inertia;
    const double rub = impulse->slips ? fabs(impulse->tangential * v_t) -
                                            0.5 * impulse->tangential * impulse->tangential * inverse_t
                                      : 0.5 * v_t * v_t / inverse_t;
    return 0.5 * (1.0 - p->e * p->e) * v_n * v_n / inverse_n + rub;
}

static void random_pairs(void)
{
    const int pairs = check_fast() ? 20000 : 200000;
    scoped_rng *r = numbers_of(1992, 0);
    int hits = 0, slips = 0;
    for (int k = 0; k < pairs; k++) {
        const pair p = random_pair(r, k);
        dem_body a = p.one, b = p.two;
        dem_impulse impulse;
        double v_n, v_t, w_n, w_t;
        surfaces(&p.one, &p.two, p.n, &v_n, &v_t);
        const bool hit = dem_impact(&a, &b, p.n, p.e, p.mu, &impulse);
        CU_ASSERT(hit == (v_n > 0.0));
        if (!hit) {
            CU_ASSERT(memcmp(&a, &p.one, sizeof a) == 0 && memcmp(&b, &p.two, sizeof b) == 0);
            continue;
        }
        hits++;
        slips += impulse.slips;
        surfaces(&a, &b, p.n, &w_n, &w_t);
        const double speed = 12.0 + fabs(p.one.omega * p.one.arm) + fabs(p.two.omega * p.two.arm);
        CHECK_NEAR(w_n, -p.e * v_n, ROUND * speed); /* (4) */
        CU_ASSERT(impulse.normal < 0.0 && fabs(impulse.tangential) <= p.mu * -impulse.normal);
        CU_ASSERT(impulse.tangential * v_t <= 0.0);
        if (impulse.slips)
            CU_ASSERT(fabs(impulse.tangential) == p.mu * -impulse.normal && w_t * v_t >= 0.0)
        else
            CHECK_NEAR(w_t, 0.0, ROUND * speed); /* (8) */
        if (p.two.inverse_mass > 0.0)
            check_conserved(&p, &a, &b);
        else
            CU_ASSERT(memcmp(&b, &p.two, sizeof b) == 0);
        const double before = energy(&p.one, &p.two, p.two.v), after = energy(&a, &b, p.two.v);
        const double size = before + after;
        CU_ASSERT(after <= before + ROUND * size);
        CHECK_NEAR(before - after, energy_lost(&p, &impulse), ROUND * size);
    }
    CU_ASSERT(hits > 0.45 * pairs && slips > 0.1 * hits && slips < 0.9 * hits);
}

/* As (7), (14) and (19) are printed, n from 1 to 2; returns P_t. */
static double collide_as_printed(dem_body *a, dem_body *b, const pair *p, bool signs, bool sign14)
{
    dem_impulse right;
    dem_body c = *a, d = *b;
    dem_impact(&c, &d, p->n, p->e, p->mu, &right);
    double v_n, v_t, p_t = right.tangential;
    surfaces(a, b, p->n, &v_n, &v_t);
    if (signs) {
        const double inverse_t = a->inverse_mass + b->inverse_mass + a->arm * a->arm * a->inverse_inertia +
                                 b->arm * b->arm * b->inverse_inertia;
        const double slip = p->mu * right.normal, no_slip = -v_t / inverse_t;
        p_t = no_slip > slip ? slip : no_slip;
    }
    for (int k = 0; k < 2; k++) {
        const double impulse = right.normal * p->n[k] + p_t * (k == 0 ? -p->n[1] : p->n[0]);
        a->v[k] += a->inverse_mass * impulse;
        b->v[k] -= b->inverse_mass * impulse;
    }
    a->omega += a->inverse_inertia * a->arm * p_t;
    b->omega += (sign14 ? -1.0 : 1.0) * b->inverse_inertia * b->arm * p_t;
    return p_t;
}

/* (7) and (19): with P_n < 0 about half of the collisions gain energy, and friction exceeds its bound. */
static void misprint_signs(void)
{
    scoped_rng *r = numbers_of(1992, 2);
    int hits = 0, gained = 0, broken = 0;
    for (int k = 0; k < 20000; k++) {
        pair p = random_pair(r, 2); /* two rotating bodies */
        dem_body a = p.one, b = p.two, c = a, d = b;
        dem_impulse right;
        if (!dem_impact(&c, &d, p.n, p.e, p.mu, &right)) continue;
        hits++;
        const double before = energy(&a, &b, b.v), p_t = collide_as_printed(&a, &b, &p, true, false);
        gained += energy(&a, &b, p.two.v) > before * (1.0 + ROUND);
        broken += fabs(p_t) > p.mu * fabs(right.normal) * (1.0 + ROUND);
    }
    CU_ASSERT(gained > 0.25 * hits && broken > 0.1 * hits);
}

/* (14): after no sticking collision are the surfaces at relative rest, and angular momentum is lost. */
static void misprint_spin(void)
{
    scoped_rng *r = numbers_of(1992, 3);
    int sticks = 0, slide = 0, turns = 0, same = 0;
    for (int k = 0; k < 20000; k++) {
        pair p = random_pair(r, 2);
        dem_body a = p.one, b = p.two, c = a, d = b;
        dem_impulse right;
        double v_n, v_t, size = 0.0;
        if (!dem_impact(&c, &d, p.n, p.e, p.mu, &right) || right.slips) continue;
        sticks++;
        const double before = moment(&a, p.n, -1.0, &size) + moment(&b, p.n, 1.0, &size);
        collide_as_printed(&a, &b, &p, false, true);
        surfaces(&a, &b, p.n, &v_n, &v_t);
        slide += fabs(v_t) > 1e-9;
        turns += fabs(moment(&a, p.n, -1.0, &size) + moment(&b, p.n, 1.0, &size) - before) > 1e-9 * size;
        a = p.one, b = p.two;
        collide_as_printed(&a, &b, &p, false, false); /* with the plus sign it equals dem_impact */
        same += fabs(a.v[0] - c.v[0]) + fabs(b.omega - d.omega) < 1e-9;
    }
    CU_ASSERT(sticks > 1000 && slide == sticks && turns == sticks && same == sticks);
}

/* (2), (3) and (9) do not define r_i. As the vector from contact point Q to centre, each body conserves its
 * moment about Q, and (9) is the surfaces' velocity; as the reverse, neither holds. */
static void vector_to_contact(void)
{
    scoped_rng *r = numbers_of(1992, 4);
    int hits = 0, kept[2] = {0}, surface[2] = {0};
    for (int k = 0; k < 2000; k++) {
        const pair p = random_pair(r, 2);
        dem_body after[2] = {p.one, p.two};
        dem_impulse impulse;
        if (!dem_impact(&after[0], &after[1], p.n, p.e, p.mu, &impulse)) continue;
        hits++;
        double v_n, v_t;
        surfaces(&p.one, &p.two, p.n, &v_n, &v_t);
        for (int away = 0; away < 2; away++) {
            double c12 = 0.0;
            bool same = true;
            for (int i = 0; i < 2; i++) {
                const dem_body *b = i ? &p.two : &p.one;
                const double side = (i ? 1.0 : -1.0) * (away ? -1.0 : 1.0) * b->arm; /* r_i = side n */
                const double dv = p.n[0] * (after[i].v[1] - b->v[1]) - p.n[1] * (after[i].v[0] - b->v[0]);
                const double orbit = side * dv / b->inverse_mass,
                             spin = (after[i].omega - b->omega) / b->inverse_inertia;
                same = same && fabs(orbit + spin) <= 1e-9 * (fabs(orbit) + fabs(spin));
                /* along t: (r x omega) t = -side omega */
                c12 += (i ? -1.0 : 1.0) * (-p.n[1] * b->v[0] + p.n[0] * b->v[1] - side * b->omega);
            }
            kept[away] += same;
            surface[away] += fabs(c12 - v_t) < 1e-9;
        }
    }
    CU_ASSERT(hits > 800 && kept[0] == hits && surface[0] == hits && kept[1] == 0 && surface[1] == 0);
}

CHECK_SUITE(hard, "hard collisions", random_pairs, misprint_signs, misprint_spin, vector_to_contact)
