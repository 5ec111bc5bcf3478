/* The contact laws, each once, for one contact (law.h) or for as many as a vector holds (lanes.h). Pure
 * functions of a few numbers. `num` is a double or a vector of them, `lanes` a truth value for each;
 * num_sqrt, num_max, num_choose, and num_limit: `a`, or `most` with the sign of `a` where |a| > most. A law
 * that other functions than these would need has no vector form, and does not compile. */
#include "core/elementary.h"
#include "dem/law/laws.h"
#include "dem/law/parameters.h"

#define LAW static inline __attribute__((always_inline))

/* ---- Normal springs: force; then, of one contact: its derivative; its energy; the overlap at which it has
 * stopped v; the overlap at which it carries a force; the quotient of energies between two overlaps above 0,
 * and its derivative by the second, nowhere as a difference of numbers that are nearly the same. ----------
 */

/* Hertz: F = k_n x^(3/2). */
LAW num hertz_force(num k_n, num overlap)
{
    return k_n * overlap * num_sqrt(overlap);
}

static inline double hertz_stiffness(double k_n, double overlap)
{
    return 1.5 * k_n * sqrt(overlap);
}

static inline double hertz_potential(double k_n, double overlap)
{
    return 0.4 * (k_n * overlap * sqrt(overlap)) * overlap;
}

static inline double hertz_impact_overlap(double k_n, double m_eff, double v)
{
    return rp_pow(5.0 * m_eff * v * v / (4.0 * k_n), 0.4);
}

static inline double hertz_rest_overlap(double k_n, double force)
{
    return rp_pow(force / k_n, 2.0 / 3.0);
}

/* (s^5 - t^5)/(s^2 - t^2) of the roots */
static inline double hertz_quotient(double k_n, double before, double after, double *slope)
{
    const double s = sqrt(before), t = sqrt(after), sum = s + t;
    *slope = 0.2 * k_n * (s * before * 2.0 + t * (4.0 * before + 6.0 * s * t + 3.0 * after)) / (sum * sum);
    return 0.4 * k_n * (before * before + after * after + s * t * (before + s * t + after)) / sum;
}

/* E* = (3/4) k_n/sqrt(R) of two spheres of radius r, R = r/2. */
static inline double hertz_modulus(double k_n, double r)
{
    return 0.75 * k_n / sqrt(0.5 * r);
}

/* Linear: F = k_n x. */
LAW num linear_force(num k_n, num overlap)
{
    return k_n * overlap;
}

static inline double linear_stiffness(double k_n, double overlap)
{
    (void)overlap;
    return k_n;
}

static inline double linear_potential(double k_n, double overlap)
{
    return 0.5 * k_n * overlap * overlap;
}

static inline double linear_impact_overlap(double k_n, double m_eff, double v)
{
    return v * sqrt(m_eff / k_n);
}

static inline double linear_rest_overlap(double k_n, double force)
{
    return force / k_n;
}

static inline double linear_quotient(double k_n, double before, double after, double *slope)
{
    *slope = 0.5 * k_n;
    return 0.5 * k_n * (before + after);
}

/* ---- Normal dashpots: rate c(x) of the force -c(x) m_eff v_n; then, of one contact, its mean between two
 * overlaps. */

/* Lee & Herrmann 1993, eq (2a): c = gamma_n. */
LAW num constant_rate(num k_n, num gamma_n, num m_eff, num overlap)
{
    (void)k_n, (void)m_eff, (void)overlap;
    return gamma_n;
}

static inline double constant_mean_rate(double k_n, double gamma_n, double m_eff, double before, double after)
{
    (void)k_n, (void)m_eff, (void)before, (void)after;
    return gamma_n;
}

/* with the linear spring */
static inline double linear_damping_ratio(double k_n, double gamma_n, double m_eff)
{
    return 0.5 * gamma_n * sqrt(m_eff / k_n);
}

/* gamma_n (m_eff/k_n)^(2/5) v^(-1/5) = 1.12798813552017 with Hertz' spring: the path that ends in rest at
 * overlap 0, integrated back from there */
static inline double hertz_sticking_speed(double k_n, double gamma_n, double m_eff)
{
    return rp_pow(gamma_n * rp_pow(m_eff / k_n, 0.4) / 1.12798813552017, 5.0);
}

/* Tsuji, Tanaka & Ishida 1992: c m_eff = gamma_n sqrt(m_eff k_n) x^(1/4), with Hertz' spring, gamma_n
 * a number. */
LAW num tsuji_rate(num k_n, num gamma_n, num m_eff, num overlap)
{
    return gamma_n * num_sqrt(k_n / m_eff * num_sqrt(overlap));
}

/* 4/5 (t^5 - s^5)/(t^4 - s^4) of the fourth roots */
static inline double tsuji_mean_rate(double k_n, double gamma_n, double m_eff, double before, double after)
{
    const double s = sqrt(sqrt(before)), t = sqrt(sqrt(after)), s2 = s * s, t2 = t * t;
    return 0.8 * gamma_n * sqrt(k_n / m_eff) * (before + after + s * t * (s2 + s * t + t2)) /
           ((s + t) * (s2 + t2));
}

/* In w = sqrt(4/5) x^(5/4) and the time that runs at x^(1/4) sqrt(5)/2, units of m_eff = k_n = 1, w' = v and
 * v' = -w - 2 gamma_n/sqrt(5) v: a linear oscillator, whatever the speed. */
static inline double tsuji_damping_ratio(double k_n, double gamma_n, double m_eff)
{
    (void)k_n, (void)m_eff;
    return gamma_n / sqrt(5.0);
}

/* ---- k_n of a contact: the same for all, or of elastic bodies by the effective radius ---- */

LAW num of_all_k_n(num k_n, num r_eff)
{
    (void)r_eff;
    return k_n;
}

LAW num by_radius_k_n(num k_n, num r_eff)
{
    return k_n * num_sqrt(r_eff);
}

LAW num dem_law_k_n(dem_normal_law law, num k_n, num r_eff)
{
    switch (law) {
#define X(id, word, manual, spring, dashpot, scaled, ...)                                                    \
    case id: return scaled##_k_n(k_n, r_eff);
        DEM_NORMAL_LAWS(X)
#undef X
    }
    __builtin_unreachable();
}

/* ---- Normal laws: a spring and a dashpot, by their rows in laws.h ---- */

LAW num dem_law_elastic(dem_normal_law law, num k_n, num overlap)
{
    switch (law) {
#define X(id, word, manual, spring, ...)                                                                     \
    case id: return spring##_force(k_n, overlap);
        DEM_NORMAL_LAWS(X)
#undef X
    }
    __builtin_unreachable();
}

LAW num dem_law_damping_rate(dem_normal_law law, num k_n, num gamma_n, num m_eff, num overlap)
{
    switch (law) {
#define X(id, word, manual, spring, dashpot, ...)                                                            \
    case id: return dashpot##_rate(k_n, gamma_n, m_eff, overlap);
        DEM_NORMAL_LAWS(X)
#undef X
    }
    __builtin_unreachable();
}

/* v_n is the normal relative velocity, positive when the grains part. Where they part fast the damping
 * outweighs the spring and the force pulls; `tension` false cuts it at 0. */
LAW num dem_law_normal(dem_normal_law law, bool tension, num k_n, num gamma_n, num m_eff, num overlap,
                       num v_n)
{
    const num zero = {0};
    num f = dem_law_elastic(law, k_n, overlap) -
            dem_law_damping_rate(law, k_n, gamma_n, m_eff, overlap) * m_eff * v_n;
    return tension ? f : num_max(f, zero);
}

/* ---- Forces along the contact ---- */

/* A spring and a dashpot under a Coulomb limit: of shear, or rolling. An infinite mu is given as a large
 * number. */
typedef struct {
    num k, inverse_k, gamma, mu;
    dem_slip slip;
    dem_damping damping;
} dem_slider;

LAW dem_slider dem_slider_of(dem_slip slip, dem_damping damping, num k, num gamma, num mu)
{
    return (dem_slider){k, 1.0 / k, gamma, mu, slip, damping};
}

/* Of a law whose coefficients are of the contact's radius, as Mindlin's, the spring at this overlap:
 * stiffness k sqrt(R_eff x), and a dashpot by gamma of the critical rate. *spring is shortened where the
 * contact has grown since it was at `before`, so that its force stays: the energy F^2/(2 k) falls then; while
 * the contact shrinks the spring stays, and k s^2/2 falls. */
LAW dem_slider dem_law_at_overlap(dem_slider c, num r_eff, num m_eff, num overlap, num before, num *spring)
{
    const num zero = {0}, k = c.k * num_sqrt(r_eff * overlap), was = num_max(before, zero);
    *spring = num_choose(num_less(was, overlap), *spring * num_sqrt(was / overlap), *spring);
    c.gamma = c.gamma * num_sqrt(k / m_eff), c.k = k, c.inverse_k = 1.0 / k;
    return c;
}

/* Shear force: Lee & Herrmann 1993, eq (2b), with the magnitudes its "min" needs:
 *
 *   F_s = -gamma_s m_eff v_s - sign(ds) min(k_s |ds|, mu max(F_n, 0))
 *
 * ds is the shear displacement since first touch. As printed it is never shortened ("total"), so a sliding
 * contact is a conservative spring; today's practice shortens it to the Coulomb limit ("truncated").
 * As printed the dashpot stands outside the limit; "inside", spring and dashpot are limited together:
 *
 *   F_s = -sign(T) min(|T|, mu max(F_n, 0)),  T = k_s ds + gamma_s m_eff v_s,
 *
 * and a truncated spring is left what the dashpot does not take of the limit. Where the dashpot alone takes
 * more, nothing is left: the spring is not drawn the other way, where it would store energy that no work has
 * brought; one that is drawn that way already stays. v_s is the relative velocity along s, the normal turned
 * clockwise; `h` the time since the last call; *spring is ds and is brought up to date. */
LAW num dem_law_shear(dem_slider c, num m_eff, num v_s, num normal_force, double h, num *spring)
{
    const num zero = {0};
    num ds = *spring + v_s * h, dashpot = c.gamma * m_eff * v_s;
    num cap = c.mu * num_max(normal_force, zero), pull = c.k * ds;
    if (c.damping == DEM_DAMPING_INSIDE) pull += dashpot;
    lanes slides;
    num held = num_limit(pull, cap, &slides), of_spring = held, force = -held;
    switch (c.damping) {
    case DEM_DAMPING_INSIDE: of_spring -= dashpot; break;
    case DEM_DAMPING_OUTSIDE: force = -dashpot - held; break;
    }
    num left = of_spring * c.inverse_k;
    if (c.damping == DEM_DAMPING_INSIDE)
        left = num_choose(num_less(of_spring * pull, zero), num_choose(num_less(ds * pull, zero), ds, zero),
                          left);
    switch (c.slip) {
    case DEM_TRUNCATED: ds = num_choose(slides, left, ds); break;
    case DEM_TOTAL: break;
    }
    *spring = ds;
    return force;
}

/* Viscous slip capped by friction: Liffman, Chan & Hughes 1992, eqs (27), (29), (32), with the sign of v_s
 * and the magnitude that their minimum needs, and k_slip = gamma_s m_eff. Their "rolling" friction is
 * Coulomb's limit of the slip, mu here: it does not resist rolling. */
LAW num dem_law_slip(dem_slider c, num m_eff, num v_s, num normal_force, double h, num *spring)
{
    const num zero = {0};
    lanes slides;
    (void)h, (void)spring;
    return -num_limit(c.gamma * m_eff * v_s, c.mu * num_max(normal_force, zero), &slides);
}

LAW num dem_law_no(dem_slider c, num m_eff, num v_s, num normal_force, double h, num *spring)
{
    (void)c, (void)m_eff, (void)v_s, (void)normal_force, (void)h, (void)spring;
    return (num){0};
}

LAW num dem_law_tangential(dem_tangential_law law, dem_slider c, num m_eff, num v_s, num normal_force,
                           double h, num *spring)
{
    switch (law) {
#define X(id, word, manual, friction, has_spring, of_radius, force, ...)                                     \
    case id: return dem_law_##force(c, m_eff, v_s, normal_force, h, spring);
        DEM_TANGENTIAL_LAWS(X)
#undef X
    }
    __builtin_unreachable();
}

/* Rolling resistance (Ai, Chen, Rotter & Ooi 2011): force at the distance R_eff = r_i r_j/(r_i + r_j) (a
 * wall: r_i) from both centres, against the speed v = R_eff (omega_i - omega_j). Of a spring and a slider as
 * for shear, at most mu_roll max(F_n, 0), dashpot included, *xi the rolling displacement; or that limit; or
 * mu_roll F_n v. The torque of R_eff times it on i, and its opposite on j, conserve angular momentum. An arm
 * of `arm` R_eff is R_eff with that times the limit, and its square times what multiplies xi and v: of a
 * dashpot by the critical rate the root of the stiffness has one of the two. */
LAW dem_slider dem_rolls_of(dem_rolling model, dem_tangential_law law, double arm, num k, num gamma, num mu)
{
    const double square = arm * arm;
    return dem_slider_of(DEM_TRUNCATED, DEM_DAMPING_INSIDE, square * k,
                         (dem_is_of_radius(law) ? arm : square) * gamma,
                         (dem_rolls_by_speed(model) ? square : arm) * mu);
}

LAW num spring_rolls(dem_slider c, num m_eff, num v, num normal_force, double h, num *xi)
{
    return dem_law_shear(c, m_eff, v, normal_force, h, xi);
}

LAW num constant_rolls(dem_slider c, num m_eff, num v, num normal_force, double h, num *xi)
{
    lanes slides;
    (void)m_eff, (void)h, (void)xi;
    return -num_limit(v * 1e300, c.mu * num_max(normal_force, (num){0}), &slides);
}

LAW num viscous_rolls(dem_slider c, num m_eff, num v, num normal_force, double h, num *xi)
{
    (void)m_eff, (void)h, (void)xi;
    return -(c.mu * num_max(normal_force, (num){0}) * v);
}

LAW num dem_law_rolling(dem_rolling model, dem_slider c, num m_eff, num v, num normal_force, double h,
                        num *xi)
{
    switch (model) {
#define X(id, word, ...)                                                                                     \
    case id: return word##_rolls(c, m_eff, v, normal_force, h, xi);
        DEM_ROLLINGS(X)
#undef X
    }
    __builtin_unreachable();
}

/* The laws of one kind of contact, with their coefficients. */
typedef struct {
    dem_normal_law normal;
    dem_tangential_law tangential;
    dem_rolling rolling;
    bool tension;
    num k_n, gamma_n;
    dem_slider shear, rolls;
} dem_laws;

/* The choices that most scenes make, beside the slip DEM_TRUNCATED: loops have instances of these, where the
 * compiler knows them. tangential; tension; the normal laws, as a condition of `law`; damping. */
#define DEM_COMMON_LAWS(X)                                                                                   \
    X(DEM_SPRING, true, true, DEM_DAMPING_OUTSIDE)                                                           \
    X(DEM_SPRING, law.tension, true, DEM_DAMPING_INSIDE)                                                     \
    X(DEM_MINDLIN, false, law.normal == DEM_ELASTIC, DEM_DAMPING_INSIDE)
#define DEM_COMMON_ROLLING DEM_ROLL_SPRING
