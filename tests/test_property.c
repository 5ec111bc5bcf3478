/* Properties of every pile, outline, surface, collision and contact, tested on random ones. */
#include <float.h>

#include "analytic/analytic.h"
#include "angle/angle.h"
#include "statics/equilibrium.h"
#include "tests/grains.h"
#include "tests/property.h"

enum { SEED = 1992 };

static double larger(double a, double b)
{
    return a > b || isnan(a) ? a : b; /* NaN if either is NaN */
}

static double largest_of(size_t n, const double v[])
{
    double most = v[0];
    for (size_t k = 1; k < n; k++) most = larger(v[k], most);
    return most;
}
#define LARGEST(...) largest_of(sizeof((double[]){__VA_ARGS__}) / sizeof(double), (double[]){__VA_ARGS__})

/* Number k in [0, 1) of a seed. */
static double pick(double seed, long k)
{
    double whole;
    return modf(fabs(sin(12.9898 * (seed + 1.0) + 78.233 * (double)(k + 1))) * 43758.5453, &whole);
}

/* ---- the search for a simpler failure itself ---- */

static double at_most_three(const double x[])
{
    return x[0] + 0.0 * x[1] <= 3.2 ? 0.0 : 2.0;
}

static double not_a_number(const double x[])
{
    return x[0] > 0.5 ? NAN : 0.0;
}

static void finds_the_simplest(void)
{
    double x[PROPERTY_INPUTS];
    const property large = {"large", at_most_three, {{"a", -10.0, 10.0, false}, {"b", 2.0, 5.0, false}}};
    CU_ASSERT(!property_holds(&large, SEED, 100, x) && x[0] == 4.0 && x[1] == 2.0);
    const property none = {"none", at_most_three, {{"a", -10.0, 3.0, false}, {"b", 2.0, 5.0, false}}};
    CU_ASSERT(property_holds(&none, SEED, 100, x));
    const property nan = {"nan", not_a_number, {{"a", 0.0, 9.0, true}}};
    CU_ASSERT(!property_holds(&nan, SEED, 100, x) && x[0] == 1.0);
}

/* ---- analytic models ---- */

enum { K_MAX = 40 };

static double lattice_two_ways(const double x[])
{
    const long k = (long)x[0];
    const double theta = x[1] * M_PI / 180.0;
    long up[K_MAX], disks = 0;
    for (long s = k - 1, most = 1; s >= 0; most = up[s--] + 1) {
        up[s] = 1 + (long)(pick(x[2], s) * (double)most);
        disks += up[s];
    }
    an_force counts[K_MAX], recursion[K_MAX];
    if (an_lattice_counts(k, up, theta, counts) || an_lattice_recursion(k, up, theta, recursion)) return NAN;
    const double rounding = (double)(k * k) * DBL_EPSILON; /* forces to k after k additions */
    double worst = 0.0, weight = 0.0, push = 0.0;
    for (long i = 0; i < k; i++) {
        worst = LARGEST(worst, fabs(counts[i].N - recursion[i].N), fabs(counts[i].H - recursion[i].H));
        weight += counts[i].N, push += counts[i].H;
    }
    return LARGEST(worst, fabs(weight - (double)disks) / (double)k, fabs(push) / (double)k) / rounding;
}

/* N has corners at 0, x_c, 1 - x_c, 1: the trapezoids between them are its integral. */
static double continuum_balance(const double x[])
{
    const double alpha = x[0] * M_PI / 180.0;
    double x_c;
    if (an_continuum_kink(alpha, &x_c)) return NAN;
    an_force corner, middle, left, right;
    if (an_continuum(alpha, x_c, &corner) || an_continuum(alpha, 0.5, &middle) ||
        an_continuum(alpha, x[1], &left) || an_continuum(alpha, 1.0 - x[1], &right))
        return NAN;
    const double weight = corner.N * x_c + (corner.N + middle.N) * (0.5 - x_c);
    const double slope = left.N - corner.N * fmin(1.0, fmin(x[1], 1.0 - x[1]) / x_c);
    return LARGEST(fabs(left.H + right.H), fabs(left.N - right.N), fabs(middle.H),
                   fabs(weight - tan(alpha) / (2.0 * sqrt(3.0))), fabs(slope) / (1.0 + 1.0 / x_c)) /
           (8.0 * DBL_EPSILON);
}

/* An outline of five edges over [0, 1]; the middle one may have its ends at any height. */
static void random_outline(double seed, double steepest, an_point v[6])
{
    for (long i = 0; i < 6; i++) v[i] = (an_point){(double)i + 0.6 * (i % 5 ? pick(seed, i) : 0.0), 0.0};
    for (long i = 1; i < 5; i++) {
        const double up = steepest * (v[i].x - v[i - 1].x), down = steepest * (v[5].x - v[i].x);
        const double lo = fmax(0.0, v[i - 1].y - up), hi = fmin(v[i - 1].y + up, down);
        v[i].y = lo + (hi - lo) * pick(seed, 10 + i);
    }
    for (long i = 0; i < 6; i++) v[i] = (an_point){v[i].x / v[5].x, v[i].y / v[5].x};
}

/* Both chords end on the outline; their half sum and half difference give the forces, (52) and (53). */
static double chords_end_on_outline(const double x[])
{
    an_point v[6];
    random_outline(x[0], tan(x[1] * M_PI / 180.0), v);
    an_profile p;
    double l[2], y[2];
    an_force f;
    if (an_profile_set(&p, v, 6) || an_profile_chords(&p, x[2], l) || an_profile_force(&p, x[2], &f) ||
        an_profile_height(&p, fmax(0.0, x[2] - 0.5 * l[0]), &y[0]) ||
        an_profile_height(&p, fmin(1.0, x[2] + 0.5 * l[1]), &y[1]))
        return NAN;
    /* the smallest difference of slopes is that of 60 and 55 degrees, 0.3 */
    return LARGEST(fabs(y[0] - l[0] * sqrt(0.75)), fabs(y[1] - l[1] * sqrt(0.75)),
                   fabs(f.N - 0.5 * (l[0] + l[1])), fabs(f.H - (l[0] - l[1]) / sqrt(12.0))) /
           (16.0 * DBL_EPSILON);
}

/* A triangle with one more vertex anywhere on each flank, in any unit, against (54)-(59). */
static double triangle_as_outline(const double x[])
{
    const double alpha = x[0] * M_PI / 180.0, t = tan(alpha), unit = x[2], from = x[3];
    an_point v[5] = {{0.0, 0.0}, {0.2, 0.2 * t}, {0.5, 0.5 * t}, {0.7, 0.3 * t}, {1.0, 0.0}};
    for (int i = 0; i < 5; i++) v[i] = (an_point){from + unit * v[i].x, unit * v[i].y};
    an_profile p;
    an_force f, g;
    const double at = fmin(from + unit * x[1], v[4].x);
    if (an_profile_set(&p, v, 5) || an_profile_force(&p, at, &f) || an_continuum(alpha, x[1], &g)) return NAN;
    return larger(fabs(f.N - g.N), fabs(f.H - g.H)) / (32.0 * DBL_EPSILON * (1.0 + fabs(from) / unit));
}

/* ---- tilt and slopes ---- */

/* The friction required by (4) at the tilt found for mu is mu. */
static double root_of_tilt(const double x[])
{
    const ang_form form = (ang_form)x[0];
    const double phi = x[1], mu = x[2], theta_r = x[3] * atan(mu * tan(phi) * tan(phi));
    ang_tilt_result r;
    double needed;
    if (ang_tilt(form, mu, theta_r, phi, &r)) return NAN;
    const bool found = r.status <= ANG_TILT_OK_PULLING;
    if (found == isnan(r.theta_t)) return NAN;
    if (!found || r.theta_t == 0.0) return 0.0;
    if (ang_friction(form, theta_r, r.theta_t, phi, &needed)) return NAN;
    /* the error of the root is a few roundings of an angle, times the slope of mu: up to 1e3 */
    return fabs(atan(needed) - atan(mu)) / 1e-12;
}

enum { CELLS = 12 };

/* A height added to all cells leaves slopes unchanged (except for the parabola through 0); an added plane
 * adds its slope; units of length do not matter. */
static double slopes_shift_and_scale(const double x[])
{
    size_t column[CELLS];
    double h[CELLS], changed[CELLS];
    const ang_parabola parabola = (ang_parabola)x[1];
    const double lift = parabola == ANG_PARABOLA_FREE ? x[2] : 0.0, plane = x[3], unit = x[4];
    for (long k = 0; k < CELLS; k++) {
        column[k] = k ? column[k - 1] + 1 + (pick(x[0], k) > 0.8) : 0;
        h[k] = 3.0 - 0.2 * (double)column[k] + pick(x[0], 20 + k);
        /* a plane from the left edge on: at the right edge of a cell that of its sum is an exact parabola */
        changed[k] = unit * (h[k] + lift + plane * ((double)column[k] + 0.5));
    }
    ang_slope a[ANG_N_METHODS], b[ANG_N_METHODS];
    if (ang_slopes(CELLS, column, h, 1.0, parabola, a) ||
        ang_slopes(CELLS, column, changed, unit, parabola, b))
        return NAN;
    double worst = 0.0;
    for (int m = 0; m < ANG_N_METHODS; m++)
        worst = LARGEST(worst, fabs(b[m].slope - (a[m].slope - plane)), fabs(b[m].slope_se - a[m].slope_se));
    return worst / 1e-13; /* a dozen heights to 30, with weights below 0.3 */
}

/* A heap of height 1 over the ground y = 0, or one flank of it, or a hollow; bumps that do not depend on the
 * points, from `margin` before to behind it. */
#define A_PILE                                                                                               \
    {"seed", 0, 1e4, true}, {"sides", 1, 3, true}, {"left_deg", 5, 40, false}, {"right_deg", 5, 40, false},  \
    {                                                                                                        \
        "bumps", 0, 0.01, false                                                                              \
    }
enum { PILE_POINTS = 4096 };
static const double everywhere[] = {-INFINITY, INFINITY};
typedef struct {
    size_t n;
    double x[PILE_POINTS], y[PILE_POINTS];
} points;

static void a_pile(const double v[], double step, double margin, points *p)
{
    const double left = v[1] > 1.0 ? -1.0 / tan(v[2] * M_PI / 180.0) : 0.0,
                 right = 1.0 / tan(v[3] * M_PI / 180.0);
    double x = left - (left < 0.0 ? margin : 0.0);
    for (p->n = 0; x <= right + margin && p->n < PILE_POINTS; x += step * (0.5 + pick(v[0], (long)p->n++))) {
        const double h = fmax(0.0, x < 0.0 ? 1.0 - x / left : 1.0 - x / right);
        p->x[p->n] = x;
        p->y[p->n] = (v[1] > 2.0 ? -h : h) + v[4] * (sin(40.0 * x + v[0]) + sin(17.0 * x)) / 2.0;
    }
}

/* Slopes of q, a mirror image, over those of p: in units of 1e-9, or, of `errors`, two errors or 0.2 deg. */
static double differ(const points *p, const points *q, bool mirror, bool errors)
{
    ang_pile a, b;
    double worst = 0.0;
    if (ang_pile_find(p->n, p->x, p->y, everywhere, &a) || ang_pile_find(q->n, q->x, q->y, everywhere, &b) ||
        a.n_flanks != b.n_flanks)
        return NAN;
    for (size_t i = 0; i < a.n_flanks; i++)
        for (int m = 0; m < ANG_N_METHODS; m++) {
            const ang_slope *s = &a.flank[i][m], *t = &b.flank[mirror ? a.n_flanks - 1 - i : i][m];
            const double change = fabs(s->theta - (mirror ? -t->theta : t->theta));
            worst = larger(worst,
                           errors ? change / fmax(2.0 * hypot(s->theta_se, t->theta_se), 0.2 * M_PI / 180.0)
                                  : larger(change / fabs(s->theta), fabs(s->theta_se - t->theta_se)) / 1e-9);
        }
    for (int m = 0; m < ANG_N_METHODS && !errors;
         m++) { /* the error of a tangent is that of the angle over cos^2 */
        const ang_slope *s = &a.mean[m];
        worst = larger(worst, fabs(s->slope_se * pow(cos(s->theta), 2.0) - s->theta_se) / 1e-9);
    }
    return worst;
}

/* The angles that a pile was made with, by all methods, with ground before and behind; the same ones
 * elsewhere, in other units, mirrored, in another order, and with points inside. */
static double pile_anywhere(const double v[])
{
    static points p, q;
    ang_pile pile;
    double worst = 0.0;
    a_pile(v, 0.02, v[8], &p);
    const bool mirror = v[9] > 0.5;
    q.n = 0;
    for (size_t k = 0; k < p.n; k++) {
        const size_t i = (k * 7919 + (size_t)v[0]) % p.n; /* a prime */
        q.x[q.n] = v[5] + v[7] * (mirror ? -p.x[i] : p.x[i]);
        q.y[q.n++] = v[6] + v[7] * p.y[i];
        if (i % 3 || q.n + p.n - k >= PILE_POINTS) continue;
        q.x[q.n] = q.x[q.n - 1];
        q.y[q.n] = q.y[q.n - 1] - v[7] * (0.05 + pick(v[0], (long)i));
        q.n++;
    }
    if (ang_pile_find(p.n, p.x, p.y, everywhere, &pile) || pile.n_flanks != (v[1] > 1.0 ? 2 : 1)) return NAN;
    for (size_t i = 0; i < pile.n_flanks; i++)
        for (int m = 0; m < ANG_N_METHODS; m++) {
            const double made =
                v[2 + (v[1] < 2.0 || i)] * ((v[1] < 2.0 || i) == (v[1] < 3.0) ? 1.0 : -1.0) * M_PI / 180.0;
            worst = larger(worst, fabs(pile.flank[i][m].theta - made) /
                                      fmax(0.5 * M_PI / 180.0, 5.0 * pile.flank[i][m].theta_se));
        }
    return larger(worst, differ(&p, &q, mirror, false));
}

/* With other ground before and behind, and points that lie more closely or less. */
static double pile_on_ground(const double v[])
{
    static points p, q;
    a_pile(v, 0.02, 0.0, &p);
    a_pile(v, v[5], v[6], &q);
    return differ(&p, &q, false, true);
}

/* ---- collisions and contacts ---- */

enum { STEPS = 40 };

static bool rotates(double seed)
{
    return pick(seed, 4) < 0.5;
}

/* Two overlapping, moving grains with laws chosen by `seed`, after STEPS steps. The frame is rotated by
 * `angle`; the order of the grains may be swapped. */
static bool run_pair(const double x[], double angle, bool swapped, dem_state out[2])
{
    const double seed = x[0], c = cos(angle), s = sin(angle), way = 0.15 + 0.04 * x[1];
    dem_definition def = dem_definition_default();
    def.gravity[0] = def.gravity[1] = 0.0;
    def.slip = pick(seed, 1) < 0.5 ? DEM_TRUNCATED : DEM_TOTAL;
    def.damping = pick(seed, 2) < 0.5 ? DEM_DAMPING_OUTSIDE : DEM_DAMPING_INSIDE;
    def.tension = pick(seed, 3) < 0.5;
    def.rotation = rotates(seed);
    def.tangential = pick(seed, 5) < 0.6 ? DEM_SPRING : DEM_SLIP_ROLL;
    def.integrator = !def.rotation && pick(seed, 6) < 0.3 ? DEM_GEAR5 : DEM_VERLET;
    def.kernel = pick(seed, 7) < 0.5 ? DEM_REFERENCE : DEM_BASELINE;
    def.dt = 1e-5;
    def.material = (dem_material){.k_s = 3e4, .gamma_s = 20.0, .mu = 0.3};
    grains_law(&def, (dem_normal_law)(pick(seed, 0) * DEM_NORMAL_N), 1e5, 50.0);
    if (def.rotation && pick(seed, 8) < 0.5)
        def.material.mu_roll = 0.2, def.material.k_roll = 2e4, def.material.gamma_roll = 20.0;
    dem_grain g[2] = {{.r = 0.08, .m = dem_mass(DEM_SPHERE, 1.0, 0.08)},
                      {.r = 0.12, .m = dem_mass(DEM_SPHERE, 1.0, 0.12)}};
    for (int i = 0; i < 2; i++) {
        const double place = i ? way : 0.0, vx = x[2] * (i ? -1.0 : 2.0), vy = x[3] * (i ? -1.0 : 0.5);
        g[i].x = c * place, g[i].y = s * place;
        g[i].vx = c * vx - s * vy, g[i].vy = s * vx + c * vy;
        if (def.rotation) g[i].omega = (i ? 1.5 : 4.0) * x[4];
    }
    const dem_grain order[2] = {g[swapped], g[!swapped]};
    def.grains = order, def.n_grains = 2;
    scoped_sim *sim = NULL;
    if (dem_create(&def, &sim)) return false;
    dem_state got[2];
    const bool good = dem_run(sim, STEPS) == RP_OK && dem_states(sim, got) == RP_OK;
    for (int i = 0; i < 2 && good; i++) {
        dem_state p = got[swapped ? 1 - i : i];
        out[i] = p;
        out[i].x = c * p.x + s * p.y, out[i].y = c * p.y - s * p.x;
        out[i].vx = c * p.vx + s * p.vy, out[i].vy = c * p.vy - s * p.vx;
        out[i].fx = c * p.fx + s * p.fy, out[i].fy = c * p.fy - s * p.fx;
    }
    return good;
}

static double difference(const dem_state *a, const dem_state *b)
{
    return LARGEST(fabs(a->x - b->x), fabs(a->y - b->y), /* of some 0.1 */
                   fabs(a->vx - b->vx) / 100.0, fabs(a->vy - b->vy) / 100.0, fabs(a->fx - b->fx) / 1e4,
                   fabs(a->fy - b->fy) / 1e4, fabs(a->omega - b->omega) / 1e3,
                   fabs(a->torque - b->torque) / 1e3);
}

static double contact_has_no_direction(const double x[])
{
    dem_state plain[2], turned[2], swapped[2];
    if (!run_pair(x, 0.0, false, plain) || !run_pair(x, x[5], false, turned) ||
        !run_pair(x, 0.0, true, swapped))
        return NAN;
    return LARGEST(difference(&plain[0], &turned[0]), difference(&plain[0], &swapped[0]),
                   difference(&plain[1], &turned[1]), difference(&plain[1], &swapped[1])) /
           1e-12; /* 40 steps of a dozen roundings each */
}

/* Momentum, and angular momentum of positions and spins. */
static void momenta(const dem_state s[2], double p[3])
{
    p[0] = p[1] = p[2] = 0.0;
    for (int i = 0; i < 2; i++) {
        p[0] += s[i].m * s[i].vx;
        p[1] += s[i].m * s[i].vy;
        p[2] += s[i].m * (s[i].x * s[i].vy - s[i].y * s[i].vx) +
                dem_inertia(DEM_SPHERE, s[i].m, s[i].r) * s[i].omega;
    }
}

static double pair_keeps_momentum(const double x[])
{
    dem_state s[2];
    if (!run_pair(x, x[5], false, s)) return NAN;
    const double m[2] = {dem_mass(DEM_SPHERE, 1.0, 0.08), dem_mass(DEM_SPHERE, 1.0, 0.12)};
    double p[3];
    momenta(s, p);
    double worst = LARGEST(fabs(p[0] - x[2] * (2.0 * m[0] - m[1])), fabs(p[1] - x[3] * (0.5 * m[0] - m[1])),
                           fabs(s[0].fx + s[1].fx) / 1e4, fabs(s[0].fy + s[1].fy) / 1e4);
    const double way = 0.15 + 0.04 * x[1], orbit = -m[1] * way * x[3];
    const double spin =
        (4.0 * dem_inertia(DEM_SPHERE, m[0], 0.08) + 1.5 * dem_inertia(DEM_SPHERE, m[1], 0.12)) * x[4];
    if (rotates(x[0])) worst = larger(fabs(p[2] - orbit - spin), worst);
    return worst / 1e-13;
}

/* ---- piles of soft disks ---- */

/* Strongest and weakest contact of each disk, found contact by contact. */
static bool marks_right(const statics_contact *c, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        bool strongest[2] = {true, true}, weakest[2] = {true, true};
        for (size_t k = 0; k < n; k++)
            for (int e = 0; e < 2; e++) {
                const size_t disk = e ? c[i].b : c[i].a;
                if (c[k].a != disk && c[k].b != disk) continue;
                if (c[k].force > c[i].force * (1.0 + 1e-9)) strongest[e] = false;
                if (c[k].force < c[i].force * (1.0 - 1e-9)) weakest[e] = false;
            }
        if (c[i].strongest != (strongest[0] || strongest[1]) || c[i].weakest != (weakest[0] || weakest[1]))
            return false;
    }
    return true;
}

/* Every disk is in force balance, with contact forces computed from positions: overlap over eps. */
static double pile_in_balance(const double x[])
{
    const long k = (long)x[0];
    const double theta = asin(0.5 + 0.5 * x[2]), eps = pow(10.0, x[3]);
    long up[K_MAX];
    if (an_lattice_cut(k, theta, fmin(x[1] * M_PI / 180.0, M_PI_2 - theta), up)) return NAN;
    statics_disk disks[K_MAX * K_MAX];
    double net[K_MAX * K_MAX][2] = {{0.0}}, u[2 * K_MAX * K_MAX], N[K_MAX], H[K_MAX];
    size_t n = 0, n_contacts, base[K_MAX];
    for (long s = 0; s < k; s++)
        for (long j = 0; j < up[s]; j++, n++)
            disks[n] = (statics_disk){((double)s + 0.5 * (double)j) * 2.0 * sin(theta),
                                      0.5 + (double)j * cos(theta), 0.5, 0.5 + pick(x[4], (long)n)};
    statics_definition def = statics_definition_default();
    def.n = n, def.disks = disks, def.eps = eps;
    def.k_x = 0.5 + pick(x[4], -1);
    statics_pile *pile = NULL;
    statics_result r;
    scoped statics_contact *c = NULL;
    if (statics_create(&def, &pile)) return NAN;
    const rp_status status = statics_solve(pile, &r);
    if (status || statics_contacts(pile, &c, &n_contacts)) {
        statics_free(pile);
        return status == RP_NO_RESULT ? 0.0 : NAN;
    }
    statics_displacements(pile, u);
    statics_base(pile, base, N, H);
    statics_free(pile);
    const bool marked = n_contacts == r.contacts && marks_right(c, n_contacts);
    for (size_t i = 0; i < n_contacts; i++) {
        const double dx = c[i].x_b - c[i].x, dy = c[i].y_b - c[i].y, length = hypot(dx, dy),
                     f = (1.0 - length) / eps;
        net[c[i].a][0] -= f * dx / length, net[c[i].a][1] -= f * dy / length;
        net[c[i].b][0] += f * dx / length, net[c[i].b][1] += f * dy / length;
    }
    double worst = 0.0;
    for (size_t i = 0; i < r.wells; i++) {
        net[base[i]][0] -= H[i], net[base[i]][1] += N[i];
        worst = larger(fabs(H[i] - def.k_x * u[2 * base[i]]), worst);
    }
    for (size_t i = 0; i < n; i++)
        worst = larger(larger(fabs(net[i][0]), fabs(net[i][1] - disks[i].weight)), worst);
    if (!marked) return NAN;
    return worst /
           (16.0 * (double)k * DBL_EPSILON / eps); /* positions up to 2 k are rounded, and six contacts add */
}

static void properties(const property *list, size_t n, int trials)
{
    for (size_t i = 0; i < n; i++) property_check(&list[i], SEED, trials);
}

static void of_models(void)
{
    const property list[] = {
        {"lattice: recursion is counting",
         lattice_two_ways,
         {{"k", 1, K_MAX, true}, {"theta_deg", 30, 60, false}, {"seed", 0, 1e4, true}}},
        {"continuum: balance", continuum_balance, {{"alpha_deg", 0.1, 59, false}, {"x", 0, 1, false}}},
        {"outline: chords",
         chords_end_on_outline,
         {{"seed", 0, 1e4, true}, {"steepest_deg", 1, 55, false}, {"x", 0, 1, false}}},
        {"outline: triangle",
         triangle_as_outline,
         {{"alpha_deg", 1, 55, false},
          {"x", 0, 1, false},
          {"unit", 0.1, 10, false},
          {"from", -5, 5, false}}}};
    properties(list, sizeof list / sizeof *list, 2000);
}

static void of_angles(void)
{
    const property list[] = {{"tilt: residual of (4)",
                              root_of_tilt,
                              {{"form", 0, ANG_N_FORMS - 1, true},
                               {"phi", 0.7, 1.3, false},
                               {"mu", 0.01, 1, false},
                               {"theta_r_part", 0, 0.99, false}}},
                             {"slopes: shift and scale",
                              slopes_shift_and_scale,
                              {{"seed", 0, 1e4, true},
                               {"parabola", 0, 1, true},
                               {"lift", -3, 3, false},
                               {"plane", -1, 1, false},
                               {"unit", 0.1, 5, false}}},
                             {"pile: anywhere",
                              pile_anywhere,
                              {A_PILE,
                               {"x", -100, 100, false},
                               {"y", -100, 100, false},
                               {"unit", 0.01, 100, false},
                               {"margin", 0, 9, false},
                               {"mirror", 0, 1, true}}},
                             {"pile: ground and density",
                              pile_on_ground,
                              {A_PILE, {"step", 0.012, 0.04, false}, {"margin", 0, 9, false}}}};
    properties(list, sizeof list / sizeof *list, 1000);
}

static void of_contacts(void)
{
#define PAIR                                                                                                 \
    {"seed", 0, 1e4, true}, {"distance", 0, 1, false}, {"v_n", -10, 10, false}, {"v_s", -10, 10, false},     \
        {"spin", -20, 20, false},                                                                            \
    {                                                                                                        \
        "angle", -M_PI, M_PI, false                                                                          \
    }
    const property list[] = {{"contact: frame and order", contact_has_no_direction, {PAIR}},
                             {"contact: momentum", pair_keeps_momentum, {PAIR}}};
#undef PAIR
    properties(list, 2, check_fast() ? 60 : 300);
}

static void of_piles(void)
{
    const property pile = {"pile: balance",
                           pile_in_balance,
                           {{"k", 1, 12, true},
                            {"alpha_deg", 20, 60, false},
                            {"gap", 0, 0.1, false},
                            {"lg_eps", -5, -2, false},
                            {"seed", 0, 1e4, true}}};
    property_check(&pile, SEED, check_fast() ? 40 : 200);
}

CHECK_SUITE(property, "property", finds_the_simplest, of_models, of_angles, of_contacts, of_piles)
