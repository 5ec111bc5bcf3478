/* Descriptors of the laws, from their rows; restitution. */
#include "core/elementary.h"
#include "dem/law/laws.h"
#include "dem/law/law.h"

const dem_normal_descriptor dem_normal_descriptors[DEM_NORMAL_N] = {
#define X(id, word, manual, spring, dashpot, scaled, k_n, ...)                                               \
    [id] = {.name = #word,                                                                                   \
            .k_n_unit = k_n,                                                                                 \
            .scale = scaled##_k_n,                                                                           \
            .stiffness = spring##_stiffness,                                                                 \
            .potential = spring##_potential,                                                                 \
            .impact_overlap = spring##_impact_overlap,                                                       \
            .rest_overlap = spring##_rest_overlap,                                                           \
            .quotient = spring##_quotient,                                                                   \
            .mean_rate = dashpot##_mean_rate,                                                                \
            .damping_rate = dashpot##_rate,                                                                  \
            .gamma_n_unit = __VA_ARGS__},
    DEM_NORMAL_LAWS(X)
#undef X
};

const dem_tangential_descriptor dem_tangential_descriptors[DEM_TANGENTIAL_N] = {
#define X(id, word, text, friction, spring, of_radius, force, ...) [id] = {.name = #word, __VA_ARGS__},
    DEM_TANGENTIAL_LAWS(X)
#undef X
};

void dem_elastic_contact(const double E[2], const double nu[2], double *k_n, double *k_s)
{
    double normal = 0.0, shear = 0.0;
    for (int k = 0; k < 2; k++) {
        normal += (1.0 - nu[k] * nu[k]) / E[k];
        shear += 2.0 * (1.0 + nu[k]) * (2.0 - nu[k]) / E[k];
    }
    *k_n = 4.0 / (3.0 * normal), *k_s = 8.0 / shear;
}

/* The damped oscillator x'' + 2 D x' + x = 0 from x = 0, with D = cos(a), is back at x = 0 with the part
 * exp(-pi/tan a) of its speed. Its force x + 2 D x' is 0 already at the phase 2 a, with exp(-2 a/tan a) of it
 * (Schwager & Poschel 2007, of gamma = 2 D): beyond D = 1, where a becomes imaginary, that goes on with the
 * hyperbolic functions, and with tension the grains do not part. */
double dem_restitution(bool tension, double damping_ratio)
{
    if (damping_ratio >= 1.0) {
        const double a = rp_acosh(damping_ratio),
                     sinh_a = sqrt((damping_ratio - 1.0) * (damping_ratio + 1.0));
        return tension ? 0.0 : rp_exp(a > 0.0 ? -2.0 * a * damping_ratio / sinh_a : -2.0);
    }
    const double cotangent = damping_ratio / sqrt((1.0 - damping_ratio) * (1.0 + damping_ratio));
    return rp_exp(-(tension ? M_PI : 2.0 * rp_acos(damping_ratio)) * cotangent);
}

/* With tension by inversion. Without it by bisection of the numbers themselves: restitution falls with the
 * ratio, and -ln(restitution) >= 2 a bounds it. */
double dem_damping_ratio_of(bool tension, double restitution)
{
    const double loss = -rp_log(restitution);
    if (tension) return loss / rp_hypot(M_PI, loss);
    double low = 0.0, high = 0.5 * (rp_exp(0.5 * loss) + rp_exp(-0.5 * loss));
    for (double middle; middle = 0.5 * (low + high), middle > low && middle < high;)
        *(dem_restitution(false, middle) > restitution ? &low : &high) = middle;
    return low;
}
