/* Validation of the analytic models, of hard collisions and of the static solver, each against an independent
 * result, over many values. */
#include <float.h>

#include "analytic/analytic.h"
#include "angle/angle.h"
#include "statics/equilibrium.h"
#include "tests/grains.h"
#include "validation/cases.h"

static case_problem
    hard_problem = {"hard", "impulses of rigid bodies, (12), (16), with the magnitude of (7)",
                    "round-off of a few steps; displacement along the floor/r"},
    lattice_problem = {"lattice", "the recursion (37), (38), disk by disk",
                       "round-off of sums over the layers"},
    limit_problem = {"lattice_limit", "the continuum (49)-(59)",
                     "one disk per diagonal, and a shift of the flank by one disk"},
    continuum_problem = {"continuum", "numerical chords of the outline",
                         "round-off over pi/3 minus the slope"},
    tent_problem = {"tent", "weight from the area", "kinks times (1/points)^2"},
    tilt_problem = {"tilt", "closed roots of (4), sine and lattice form; chords and forces of the others",
                    "round-off over the slope at the root"},
    static_problem = {"static_pile", "diagonal contacts alone, exact for the full triangle",
                      "round-off of displacements of n eps sigma"};

static double radians(double degrees)
{
    return degrees * (M_PI / 180.0);
}

/* Hard collision of two unequal spinning grains, or of one with a wall below, slip v_s, no gravity. */
static void check_hard(bool pair, int shape, double e, double mu, double ratio)
{
    const double r = 0.1193, m = 0.00471, r2 = 0.0871, m2 = 0.00297, v_n = 13.0, v_s = ratio * v_n, dt = 1e-7;
    const double spin = -0.4 * v_s / r, q = dem_inertia(shape, 1.0, 1.0), a = 1.0 + 1.0 / q;
    const double m_eff = pair ? m * m2 / (m + m2) : m;
    dem_grain grains[2] = {{0.0, r + 1.5 * v_n * dt, r, m, v_s - r * spin, -v_n, 0.0, spin},
                           {0.0, -r2, r2, m2, 0.0, 0.0}};
    dem_definition def = grains_bare(1 + pair, grains, DEM_LINEAR, (dem_material){.k_n = 1e5});
    def.tension = false, def.tangential = DEM_SLIP_ROLL, def.rotation = true, def.shape = shape;
    def.hard = (dem_hard){true, e, mu};
    def.dt = dt, def.n_walls = !pair;
    def.walls[0] = grains_line(0.0, 0.0, 0.0, 1.0, &def.material);
    scoped_sim *sim = grains_start(&def);
    dem_state s[2] = {0};
    grains_run(sim, 4, s);
    /* 1/M_t is a/m_eff for spheres alike and disks alike: arm^2/I = 1/(q m) */
    const double impulse = fmin(v_s * m_eff / a, mu * (1.0 + e) * m_eff * v_n);
    const double turn = pair ? 2.0 * (v_s + v_n) * dt / (r + r2) : 0.0; /* of the normal until contact */
    const double bound = (1e-13 + 4.0 * turn) * (v_n + v_s);
    case_near(&hard_problem, "normal speed", e * v_n, s[0].vy - s[1].vy, bound, "%s %s e=%g mu=%g v_s/v_n=%g",
              shape == DEM_SPHERE ? "sphere" : "disk", pair ? "grain" : "wall", e, mu, ratio);
    case_also(&hard_problem, "slip", v_s - a * impulse / m_eff,
              s[0].vx - s[1].vx + r * s[0].omega + r2 * s[1].omega, a * bound);
    case_also(&hard_problem, "spin", spin - impulse / (q * m * r), s[0].omega, a * bound / r);
}

static void hard(void)
{
    static const double restitutions[] = {0.0, 0.5, 0.93, 1.0}, mus[] = {0.0, 0.1, 0.5},
                        ratios[] = {0.01, 0.3, 1.0, 3.0, 20.0};
    for (int i = 0; i < 2 * 2 * 4 * 3 * 5; i += case_stride(7))
        check_hard(i % 2, i / 2 % 2 ? DEM_DISK : DEM_SPHERE, restitutions[i / 4 % 4], mus[i / 16 % 3],
                   ratios[i / 48]);
}

/* The largest differences over the base. */
typedef struct {
    double N, H, top; /* largest differences of N, H; largest N */
} apart;

static apart compare(long k, const an_force a[], const an_force b[])
{
    apart d = {0.0, 0.0, 0.0};
    for (long i = 0; i < k; i++) {
        d.N = fmax(d.N, fabs(a[i].N - b[i].N));
        d.H = fmax(d.H, fabs(a[i].H - b[i].H));
        d.top = fmax(d.top, b[i].N);
        if (isnan(a[i].N + a[i].H + b[i].N + b[i].H)) d.N = d.H = NAN;
    }
    return d;
}

/* Forces along the base of a cut pile, in chi g B, and those of the continuum at the same x/B. */
static void check_limit(long k, double alpha, double theta, const long up[], const an_force force[])
{
    double disks = 0.0;
    for (long s = 0; s < k; s++) disks += (double)up[s];
    const double B = an_lattice_base(disks, theta, alpha), width = 2.0 * sin(theta);
    scoped an_force *scaled = calloc((size_t)k, sizeof *scaled), *exact = calloc((size_t)k, sizeof *exact);
    for (long i = 0; i < k; i++) {
        const double x = 0.5 + ((double)i + 1.0 - 0.5 * (double)(k + 1)) * width / B;
        scaled[i] = (an_force){force[i].N / B, force[i].H / B};
        CHECK_OK(an_continuum(alpha, fmin(fmax(x, 0.0), 1.0), &exact[i]));
    }
    const apart d = compare(k, scaled, exact);
    /* by the law of sines, in the triangle of shift, flank and diagonal */
    const double bound = (1.0 + sin(alpha) / sin(M_PI / 3.0 - alpha)) / (double)k;
    case_near(&limit_problem, "N", 0.0, d.N, bound, "alpha=%.4g base=%ld", alpha, k);
    case_also(&limit_problem, "H", 0.0, d.H, bound);
}

static void lattice(void)
{
    static const double alphas[] = {1.0, 10.0, 30.0, 45.0, 55.0, 59.0, 60.0}, thetas[] = {30.0, 33.0, 45.0};
    static const long bases[] = {1, 7, 45, 180, 1000};
    for (int i = 0; i < 7 * 5 * 3; i += case_stride(3)) {
        const long k = bases[i / 7 % 5];
        const double theta = radians(thetas[i / 35]),
                     alpha = fmin(radians(alphas[i % 7]), 0.5 * M_PI - theta);
        scoped long *up = calloc((size_t)k, sizeof *up);
        scoped an_force *closed = calloc((size_t)k, sizeof *closed),
                        *solved = calloc((size_t)k, sizeof *solved);
        CHECK_OK(an_lattice_cut(k, theta, alpha, up));
        CHECK_OK(an_lattice_counts(k, up, theta, closed));
        CHECK_OK(an_lattice_recursion(k, up, theta, solved));
        const apart d = compare(k, solved, closed);
        const double bound = (double)k * DBL_EPSILON * d.top;
        case_near(&lattice_problem, "N", 0.0, d.N, bound, "alpha=%.4g theta=%.4g base=%ld", alpha, theta, k);
        case_also(&lattice_problem, "H", 0.0, d.H, bound);
        if (thetas[i / 35] < 31.0 && alphas[i % 7] < 60.0 && k > 7) check_limit(k, alpha, theta, up, closed);
    }
}

static void continuum(void)
{
    for (int i = 1; i < 60; i += case_stride(3)) {
        const double alpha = radians(i), bound = DBL_EPSILON / (M_PI / 3.0 - alpha);
        const an_point outline[] = {{0.0, 0.0}, {0.5, 0.5 * tan(alpha)}, {1.0, 0.0}};
        an_profile profile;
        an_force a, b;
        CHECK_OK(an_profile_set(&profile, outline, 3));
        for (double x = 0.0; x <= 1.0; x += 0.0625) {
            CHECK_OK(an_continuum(alpha, x, &a));
            CHECK_OK(an_profile_force(&profile, x, &b));
            case_near(&continuum_problem, "N", a.N, b.N, 4.0 * bound, "alpha=%d x=%g", i, x);
            case_also(&continuum_problem, "H", a.H, b.H, 4.0 * bound);
        }
    }
}

/* N over the base of a tent sums to its weight: chi g per length sigma of a diagonal, and diagonals are sigma
 * apart on the base, which gives 2/sqrt 3 of the area. H sums to 0. */
static void tents(void)
{
    static const double slopes[] = {5.0, 30.0, 45.0, 58.0}, places[] = {0.1, 0.25, 0.38, 0.45};
    const int points = 4000;
    for (int i = 0; i < 4 * 4 * 4; i += case_stride(3)) {
        const double outer = radians(slopes[i % 4]), inner = radians(slopes[i / 4 % 4]), x_1 = places[i / 16];
        an_point v[5];
        an_profile tent;
        CHECK_OK(an_tent(outer, inner, x_1, v));
        CHECK_OK(an_profile_set(&tent, v, 5));
        double N = 0.0, H = 0.0, area = 0.0;
        for (int p = 0; p <= points; p++) {
            const double weight = (p == 0 || p == points ? 0.5 : 1.0) / points;
            an_force f;
            CHECK_OK(an_profile_force(&tent, (double)p / points, &f));
            N += weight * f.N;
            H += weight * f.H;
        }
        for (int p = 0; p < 4; p++) area += 0.5 * (v[p].y + v[p + 1].y) * (v[p + 1].x - v[p].x);
        /* each of some ten kinks contributes at most its jump in slope, below that between 60 degrees and the
         * steepest chord, over 8 points^2 */
        const double jump = 10.0 / (M_PI / 3.0 - fmax(outer, inner)) / (8.0 * points * points);
        case_near(&tent_problem, "weight", 2.0 / sqrt(3.0) * area, N, jump, "outer=%.4g inner=%.4g x_1=%g",
                  slopes[i % 4], slopes[i / 4 % 4], x_1);
        case_also(&tent_problem, "H", 0.0, H, 1e-12);
    }
}

/* T/N of the forces along the two rays: proportional to the chords, balanced, also to the widths of beams. */
static double needed(int form, double theta_r, double theta, double P)
{
    const double a = P - theta, b = P + theta, t = tan(theta_r);
    const bool printed = form == ANG_PRINTED, wide = form == ANG_BALANCED;
    const double A = (wide ? sin(a) : 1.0) / ((printed ? tan(a) : sin(a)) - t * cos(a)),
                 B = (wide ? sin(b) : 1.0) / ((printed ? tan(b) : sin(b)) + t * cos(b));
    return (A * cos(a) - B * cos(b)) / (A * sin(a) + B * sin(b));
}

/* (3), and the tilts of (4): closed roots of the sine form, (phi - theta_R - asin(cos 2P sin(phi +
 * theta_R)))/2 with tan phi = mu, and of the lattice form, tan = (mu - t/tan^2 P)/(1 - mu t). */
static void check_tilt(double mu, double part, double P)
{
    const double phi = atan(mu);
    double ms;
    CHECK_OK(ang_marginal(mu, P, &ms, NULL));
    case_near(&tilt_problem, "theta_MS", atan(mu * tan(P) * tan(P)), ms, 4.0 * DBL_EPSILON, "mu=%g P=%g", mu,
              P);
    const double theta_r = part * fmin(ms, P), t = tan(theta_r), cot2 = 1.0 / (tan(P) * tan(P));
    const double closed[ANG_N_FORMS] = {[ANG_LATTICE] = atan((mu - t * cot2) / (1.0 - mu * t)),
                                        [ANG_SINE] =
                                            0.5 * (phi - theta_r - asin(cos(2.0 * P) * sin(phi + theta_r)))};
    for (int form = ANG_BALANCED; form < ANG_N_FORMS; form++) {
        ang_tilt_result r;
        CHECK_OK(ang_tilt((ang_form)form, mu, theta_r, P, &r));
        if (r.status != ANG_TILT_OK && r.status != ANG_TILT_OK_PULLING) continue;
        if (form == ANG_LATTICE || form == ANG_SINE)
            case_near(&tilt_problem, "theta_T", closed[form], r.theta_t, 2e-14, "%s mu=%g theta_R=%.6g P=%g",
                      ang_form_words[form], mu, theta_r, P);
        if (form != ANG_LATTICE)
            case_near(&tilt_problem, "mu", mu, needed(form, theta_r, r.theta_t, P), 2e-14,
                      "%s theta_R=%.6g P=%g", ang_form_words[form], theta_r, P);
    }
}

static void tilt(void)
{
    static const double mus[] = {0.01, 0.1, 0.2, 0.3, 0.5}, parts[] = {0.1, 0.4, 0.7, 0.95},
                        Ps[] = {50, 60, 70};
    for (int i = 0; i < 5 * 4 * 3; i += case_stride(3))
        check_tilt(mus[i % 5], parts[i / 5 % 4], radians(Ps[i / 20]));
}

/* Full triangles, linearised: only diagonal contacts carry force. */
static void static_piles(void)
{
    static const long bases[] = {1, 2, 5, 12, 26, 45, 77, 104};
    for (int b = 0; b < (check_fast() ? 4 : check_full() ? 8 : 6); b++) {
        const long k = bases[b];
        const size_t n = (size_t)(k * (k + 1) / 2);
        statics_disk *disks = calloc(n, sizeof *disks);
        double *N = calloc((size_t)k, sizeof *N), *H = calloc((size_t)k, sizeof *H);
        size_t at = 0;
        for (long i = 0; i < k; i++)
            for (long j = 0; j < k - i; j++)
                disks[at++] =
                    (statics_disk){(double)i + 0.5 * (double)j, 0.5 + (double)j * sqrt(0.75), 0.5, 1};
        statics_definition def = statics_definition_default();
        def.n = n, def.disks = disks, def.eps = 0.0;
        statics_pile *pile = NULL;
        statics_result result;
        CHECK_OK(statics_create(&def, &pile));
        CHECK_OK(statics_solve(pile, &result));
        statics_base(pile, NULL, N, H);
        for (long i = 0; i < k; i++) {
            an_force exact;
            CHECK_OK(an_lattice_triangle(k, M_PI / 6.0, i + 1, &exact));
            case_near(&static_problem, "N", exact.N, N[i], 1e-14 * (double)n, "base=%ld disk=%ld", k, i + 1);
            case_also(&static_problem, "H", exact.H, H[i], 1e-14 * (double)n);
        }
        statics_free(pile), free(disks), free(N), free(H);
    }
}

CASES(models, &hard_problem, &lattice_problem, &limit_problem, &continuum_problem, &tent_problem,
      &tilt_problem, &static_problem)

CHECK_SUITE_SUMMED(models, "validation: models", hard, lattice, continuum, tents, tilt, static_piles, cases)
