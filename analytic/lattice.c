/* Forces on the base of a pile on a lattice: Liffman, Chan & Hughes 1992, equations (37)-(44), and the same
 * balance under any stepped outline. Hard disks, no contact between neighbours of a row. See analytic.h. */
#include "analytic/analytic.h"
#include "core/elementary.h"

#include <math.h>

/* Angles converted from degrees reach the ends of their ranges to rounding only. */
static const double ANGLE_SLACK = 1e-12;
static const double TIE = 1e-9; /* in row spacings: a disk on the cutting line stays */
static const double DEG = 180.0 / M_PI;

static rp_status check_lattice(long k, long k_max, double theta)
{
    if (k < 1 || k > k_max)
        return rp_fail(RP_BAD_INPUT, "%ld disks in the base: out of range, allowed: [1, %ld]", k, k_max);
    if (!(theta >= M_PI / 6 - ANGLE_SLACK && theta <= M_PI / 3 + ANGLE_SLACK))
        return rp_fail(RP_BAD_INPUT, "theta = %.15g degrees: out of range, allowed: [30, 60]", theta * DEG);
    return RP_OK;
}

static rp_status check_outline(long k, const long up[])
{
    for (long s = k - 1, most = 1; s >= 0; most = up[s--] + 1)
        if (up[s] < 1 || up[s] > most)
            return rp_fail(RP_BAD_INPUT,
                           "outline: %ld disks on diagonal %ld: out of range, allowed: [1, %ld]", up[s], s,
                           most);
    return RP_OK;
}

rp_status an_lattice_triangle(long k, double theta, long i, an_force *force)
{
    RP_TRY(check_lattice(k, AN_LAYERS_MAX, theta));
    if (i < 1 || i > k)
        return rp_fail(RP_BAD_INPUT, "base disk i = %ld: out of range, allowed: [1, %ld]", i, k);
    *force = (an_force){(double)(k + 1) / 2, rp_tan(theta) * (double)(2 * i - k - 1) / 2};
    return RP_OK;
}

rp_status an_lattice_cut(long k, double theta, double alpha, long up[])
{
    RP_TRY(check_lattice(k, AN_LAYERS_MAX, theta));
    if (!(alpha > 0 && alpha <= M_PI / 2 - theta + ANGLE_SLACK))
        return rp_fail(RP_BAD_INPUT, "alpha = %.15g degrees: out of range, allowed: (0, 90 - theta = %.15g]",
                       alpha * DEG, 90 - theta * DEG);
    /* Sites lost at each end of a row, per row of height. */
    double lost = fmax(0, 0.5 / (rp_tan(alpha) * rp_tan(theta)) - 0.5);
    for (long s = 0; s < k; s++) {
        double left = floor(((double)s + TIE) / lost); /* last row in which the left flank keeps site s */
        double right = floor(((double)(k - 1 - s) + TIE) / (1 + lost));
        up[s] = 1 + (long)fmin(left, right);
    }
    return RP_OK;
}

rp_status an_lattice_counts(long k, const long up[], double theta, an_force force[])
{
    RP_TRY(check_lattice(k, AN_LAYERS_MAX, theta));
    RP_TRY(check_outline(k, up));
    /* Diagonal s to the right crosses the diagonals to the left of base disks s .. s + up[s] - 1:
     * differences of their counts first, summed afterwards. */
    for (long i = 0; i < k; i++) force[i].N = 0;
    for (long s = 0; s < k; s++) {
        force[s].N += 1;
        if (s + up[s] < k) force[s + up[s]].N -= 1;
    }
    double n_ul = 0, slope = rp_tan(theta);
    for (long i = 0; i < k; i++) {
        n_ul += force[i].N;
        double n_ur = (double)up[i];
        force[i] = (an_force){(n_ul + n_ur) / 2, slope * (n_ul - n_ur) / 2};
    }
    return RP_OK;
}

rp_status an_lattice_recursion(long k, const long up[], double theta, an_force force[])
{
    RP_TRY(check_lattice(k, AN_RECURSION_MAX, theta));
    RP_TRY(check_outline(k, up));
    long top = 0;
    for (long s = 0; s < k; s++) {
        if (up[s] > top) top = up[s];
        force[s] = (an_force){0, 0}; /* (39) */
    }
    /* Until the ground is reached force[s].N, .H hold L, R of disk s of the row above. From right to left, so
     * that L of site s - 1 is still that row's. */
    const double W = 1 / rp_cos(theta);
    for (long row = top - 1; row >= 0; row--)
        for (long s = k - 1 - row; s >= 0; s--) {
            if (up[s] <= row) continue;
            double from_left = s > 0 ? force[s - 1].N : 0, from_right = force[s].H;
            if (row > 0) {
                double difference = from_left - from_right; /* L - R by (37) */
                double sum = from_left + from_right + W;    /* L + R by (38) */
                force[s] = (an_force){(sum + difference) / 2, (sum - difference) / 2};
            } else
                force[s] = (an_force){(from_left + from_right + W) * rp_cos(theta),
                                      (from_left - from_right) * rp_sin(theta)};
        }
    return RP_OK;
}

double an_lattice_base(double disks, double theta, double alpha)
{
    /* Area of the triangle B^2 tan(alpha)/4, of a lattice cell sin(2 theta). */
    return sqrt(4 * disks * rp_sin(2 * theta) / rp_tan(alpha));
}
