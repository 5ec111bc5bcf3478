#include "tests/twin.h"

#include <math.h>
#include <string.h>

/* Of a contact: with k_n and k_s over sqrt(R) where bodies are elastic. */
typedef struct {
    double k_n, k_s, gamma_n, gamma_s, mu, mu_roll;
} law;
typedef struct {
    double s, roll, overlap;
} memory;

static double said(double first, double otherwise)
{
    return isnan(first) ? otherwise : first;
}

static double series(double a, double b)
{
    return 1.0 / (1.0 / (2.0 * a) + 1.0 / (2.0 * b));
}

/* Of a, b: what both have; by the rule, or what is said of the two. */
static double together(const twin_scene *t, double a, double b, double of_two)
{
    return !isnan(of_two) ? of_two : a == b ? a : t->rule == 1 ? fmin(a, b) : sqrt(a * b);
}

/* x'' + 2 z x' + x = 0 from 0 with x' = 1, until the force is 0: -x'. */
static double rebound(double z)
{
    const double w = sqrt(1.0 - z * z), phase = atan2(2.0 * z * w, 2.0 * z * z - 1.0);
    return exp(-z / w * phase);
}

/* The damping ratio of a restitution, by bisection. */
static double ratio_of(double restitution)
{
    double low = 0.0, high = 1.0 - 1e-9;
    for (int k = 0; k < 200; k++) {
        const double z = 0.5 * (low + high);
        *(rebound(z) > restitution ? &low : &high) = z;
    }
    return 0.5 * (low + high);
}

static void moduli(double Ea, double na, double Eb, double nb, law *c)
{
    c->k_n = 4.0 / 3.0 / ((1.0 - na * na) / Ea + (1.0 - nb * nb) / Eb);
    c->k_s = 8.0 / (2.0 * (1.0 + na) * (2.0 - na) / Ea + 2.0 * (1.0 + nb) * (2.0 - nb) / Eb);
}

static twin_values kind_of(const twin_scene *t, int k)
{
    twin_values v, scene = t->kind[0];
    const double *from = (const double *)&t->kind[k], *all = (const double *)&scene;
    for (size_t i = 0; i < sizeof v / sizeof(double); i++) ((double *)&v)[i] = said(from[i], all[i]);
    return v;
}

/* gamma_n, and what follows from it, of mean masses. */
static void damp(const twin_scene *t, double restitution, double m_eff, law *c)
{
    const double z = ratio_of(restitution);
    c->gamma_n = t->bodies ? sqrt(5.0) * z : 2.0 * z * sqrt(c->k_n / m_eff);
    c->gamma_s = t->bodies ? sqrt(2.0 / 3.0) * c->gamma_n : t->gamma_s;
}

static law of_kinds(const twin_scene *t, int a, int b, const double mass[])
{
    const twin_values A = kind_of(t, a), B = kind_of(t, b), *p = &t->pair[a][b];
    law c;
    if (t->bodies) moduli(A.E, A.nu, B.E, B.nu, &c);
    if (!t->bodies) c.k_n = series(A.k_n, B.k_n), c.k_s = series(A.k_s, B.k_s);
    c.k_n = said(p->k_n, c.k_n);
    damp(t, together(t, A.restitution, B.restitution, p->restitution),
         mass[a] * mass[b] / (mass[a] + mass[b]), &c);
    c.mu = together(t, A.mu, B.mu, p->mu), c.mu_roll = together(t, A.mu_roll, B.mu_roll, p->mu_roll);
    return c;
}

/* A coefficient that both the kind and the wall give must be the same; of one alone it holds. */
static double at(const twin_scene *t, double own, double all, double wall, double of_two)
{
    if (!isnan(of_two)) return of_two;
    return isnan(own) || isnan(wall) ? said(wall, said(own, all)) : together(t, own, wall, of_two);
}

static law of_wall(const twin_scene *t, int a, int w, const double mass[])
{
    const twin_values A = kind_of(t, a), *W = &t->wall[w], *p = &t->pair[a][TWIN_KINDS + w];
    twin_values own = t->kind[a], all = t->kind[0];
    law c;
    if (a == 0) memset(&own, 0xff, sizeof own); /* the scene's are no kind's own: all NAN */
    if (t->bodies) moduli(A.E, A.nu, said(W->E, A.E), said(W->nu, A.nu), &c);
    if (!t->bodies) c.k_n = said(W->k_n, 2.0 * A.k_n), c.k_s = said(W->k_s, A.k_s);
    c.k_n = said(p->k_n, c.k_n);
    damp(t, at(t, own.restitution, all.restitution, W->restitution, p->restitution), mass[a], &c);
    c.mu = at(t, own.mu, all.mu, W->mu, p->mu);
    c.mu_roll = at(t, own.mu_roll, all.mu_roll, W->mu_roll, p->mu_roll);
    return c;
}

/* A spring and a dashpot under a limit; the spring of what slides keeps what the dashpot leaves. */
static double slide(double k, double c, double v, double limit, double *s)
{
    const double dashpot = c * v, pull = k * *s + dashpot;
    if (fabs(pull) <= limit) return -pull;
    const double held = copysign(limit, pull), left = held - dashpot;
    if (left * pull >= 0.0)
        *s = left / k;
    else if (*s * pull >= 0.0) /* not one that pushes along the slip */
        *s = 0.0;
    return -held;
}

/* Forces of one contact on the first body: normal, tangential, torque of rolling. */
static void contact(const twin_scene *t, const law *c, double R, double m, double x, double v_n, double v_s,
                    double v_r, double arm, double h, memory *o, double f[3])
{
    const double K = t->bodies ? c->k_n * sqrt(R) : c->k_n;
    const double rate = t->bodies ? c->gamma_n * sqrt(K / m) * sqrt(sqrt(x)) : c->gamma_n;
    f[0] = fmax((t->bodies ? K * x * sqrt(x) : K * x) - rate * m * v_n, 0.0);
    double k = c->k_s, gamma = c->gamma_s, roll = arm * arm * c->k_s, gamma_roll = arm * arm * c->gamma_s;
    if (t->bodies) { /* loading preserves the force, unloading the displacement */
        const double less = x > o->overlap ? sqrt(fmax(o->overlap, 0.0) / x) : 1.0;
        o->s *= less, o->roll *= less;
        k *= sqrt(R * x), gamma *= sqrt(k / m), roll *= sqrt(R * x);
        gamma_roll = arm * c->gamma_s * sqrt(roll / m);
    }
    o->overlap = x, o->s += v_s * h, o->roll += v_r * h;
    f[1] = slide(k, gamma * m, v_s, c->mu * f[0], &o->s);
    f[2] = R * slide(roll, gamma_roll * m, v_r, arm * c->mu_roll * f[0], &o->roll);
}

typedef struct {
    double mass[TWIN_KINDS];
    law kinds[TWIN_KINDS][TWIN_KINDS], walls[TWIN_KINDS][TWIN_WALLS];
    memory pair[TWIN_GRAINS][TWIN_GRAINS], wall[TWIN_GRAINS][TWIN_WALLS];
} state;

static void forces(const twin_scene *t, state *s, double h, double f[][3])
{
    for (int i = 0; i < t->n; i++) {
        const twin_grain *a = &t->grain[i];
        double of[3];
        for (int j = 0; j < i; j++) {
            const twin_grain *b = &t->grain[j];
            const double dx = a->x - b->x, dy = a->y - b->y, r = sqrt(dx * dx + dy * dy), x = a->r + b->r - r;
            if (!(x > 0.0)) {
                s->pair[i][j] = (memory){0.0, 0.0, x};
                continue;
            }
            const double nx = dx / r, ny = dy / r, vx = a->vx - b->vx, vy = a->vy - b->vy,
                         R = a->r * b->r / (a->r + b->r);
            contact(t, &s->kinds[a->kind][b->kind], R, a->m * b->m / (a->m + b->m), x, vx * nx + vy * ny,
                    vx * ny - vy * nx + (a->r - 0.5 * x) * a->omega + (b->r - 0.5 * x) * b->omega,
                    R * (a->omega - b->omega), t->wide ? 2.0 : 1.0, h, &s->pair[i][j], of);
            f[i][0] += of[0] * nx + of[1] * ny, f[i][1] += of[0] * ny - of[1] * nx;
            f[j][0] -= of[0] * nx + of[1] * ny, f[j][1] -= of[0] * ny - of[1] * nx;
            f[i][2] += (a->r - 0.5 * x) * of[1] + of[2], f[j][2] += (b->r - 0.5 * x) * of[1] - of[2];
        }
        for (int w = 0; w < TWIN_WALLS; w++) {
            const double *l = t->line[w], x = a->r - ((a->x - l[0]) * l[2] + (a->y - l[1]) * l[3]);
            if (!(x > 0.0)) {
                s->wall[i][w] = (memory){0.0, 0.0, x};
                continue;
            }
            contact(t, &s->walls[a->kind][w], a->r, a->m, x, a->vx * l[2] + a->vy * l[3],
                    a->vx * l[3] - a->vy * l[2] + (a->r - x) * a->omega, a->r * a->omega, 1.0, h,
                    &s->wall[i][w], of);
            f[i][0] += of[0] * l[2] + of[1] * l[3], f[i][1] += of[0] * l[3] - of[1] * l[2];
            f[i][2] += (a->r - x) * of[1] + of[2];
        }
    }
}

static void push(twin_scene *t, double dt, double f[][3])
{
    for (int i = 0; i < t->n; i++) {
        twin_grain *g = &t->grain[i];
        g->vx += dt * (f[i][0] / g->m), g->vy += dt * (f[i][1] / g->m - t->g);
        g->omega += dt * f[i][2] / (0.4 * g->m * g->r * g->r);
    }
}

/* v(n + 1/2) = v(n - 1/2) + dt a(n), x(n + 1) = x(n) + dt v(n + 1/2); springs begin at 0. */
void twin_run(twin_scene *t, long steps)
{
    static state s;
    double number[TWIN_KINDS] = {0.0};
    memset(&s, 0, sizeof s);
    for (int i = 0; i < t->n; i++) {
        twin_grain *g = &t->grain[i];
        g->m = 4.0 / 3.0 * M_PI * kind_of(t, g->kind).density * g->r * g->r * g->r;
        s.mass[g->kind] += g->m, number[g->kind] += 1.0;
    }
    for (int a = 0; a < t->n_kinds; a++) s.mass[a] /= number[a];
    for (int a = 0; a < t->n_kinds; a++) {
        for (int b = 0; b < t->n_kinds; b++) s.kinds[a][b] = of_kinds(t, a, b, s.mass);
        for (int w = 0; w < TWIN_WALLS; w++) s.walls[a][w] = of_wall(t, a, w, s.mass);
    }
    for (long step = 0; step <= steps; step++) {
        double f[TWIN_GRAINS][3] = {{0.0}};
        forces(t, &s, step ? t->dt : 0.0, f);
        if (step == 0) push(t, -0.5 * t->dt, f);
        if (step == steps) return;
        push(t, t->dt, f);
        for (int i = 0; i < t->n; i++) {
            twin_grain *g = &t->grain[i];
            g->x += t->dt * g->vx, g->y += t->dt * g->vy, g->angle += t->dt * g->omega;
        }
    }
}
