/* The share of a grain's area that is within a region, in closed form. */
#include <math.h>

#include "core/elementary.h"
#include "experiment/looks.h"

static double dot(const double p[2], const double q[2])
{
    return p[0] * q[0] + p[1] * q[1];
}

static double cross(const double p[2], const double q[2])
{
    return p[0] * q[1] - p[1] * q[0];
}

/* Twice the area that the disk of radius r about 0 shares with the triangle of 0 and a side; negative where
 * the side goes round clockwise. Beside the part of the side within the disk it is a sector. */
static double shared_with(double r, const double p[2], const double q[2])
{
    const double d[2] = {q[0] - p[0], q[1] - p[1]}, d2 = dot(d, d), b = dot(p, d),
                 root = sqrt(fmax(b * b - d2 * (dot(p, p) - r * r), 0.0)), from = fmax((-b - root) / d2, 0.0),
                 to = fmin((-b + root) / d2, 1.0);
    if (!(from < to)) return r * r * rp_atan2(cross(p, q), dot(p, q));
    const double in[2] = {p[0] + from * d[0], p[1] + from * d[1]},
                 out[2] = {p[0] + to * d[0], p[1] + to * d[1]};
    double area = cross(in, out);
    if (from > 0.0) area += r * r * rp_atan2(cross(p, in), dot(p, in));
    if (to < 1.0) area += r * r * rp_atan2(cross(out, q), dot(out, q));
    return area;
}

/* The same of the disks of radius r and R, their centres a distance d apart. */
static double shared_disks(double r, double R, double d)
{
    if (d >= r + R) return 0.0;
    if (d <= fabs(R - r)) return 2.0 * M_PI * fmin(r, R) * fmin(r, R);
    const double u = (d * d + (r - R) * (r + R)) / (2.0 * d), h = sqrt(fmax((r - u) * (r + u), 0.0));
    return 2.0 * (r * r * rp_atan2(h, u) + R * R * rp_atan2(h, d - u) - d * h);
}

double exp_share_within(const exp_within *a, const dem_state *s)
{
    const double x[2] = {s->x, s->y}, r = s->r, all = 2.0 * M_PI * r * r;
    if (a->kinds && a->kinds[s->id - 1] != a->kind) return 0.0;
    if (a->all) return 1.0;
    if (a->circle) return shared_disks(r, a->at[2], rp_hypot(x[0] - a->at[0], x[1] - a->at[1])) / all;
    double e[4], sum = 0.0; /* the part of the region that the grain may reach */
    for (int k = 0; k < 4; k++) e[k] = fmin(fmax(a->at[k] - x[k / 2], -r), r);
    if (e[0] >= e[1] || e[2] >= e[3]) return 0.0;
    const bool whole = e[0] == -r && e[1] == r && e[2] == -r && e[3] == r;
    if (whole && !a->n_points) return 1.0;
    const double box[8] = {e[0], e[2], e[1], e[2], e[1], e[3], e[0], e[3]}, none[2] = {0.0, 0.0};
    const double *points = a->n_points ? a->points : box, *from = a->n_points ? x : none;
    for (size_t n = a->n_points ? a->n_points : 4, k = 0; k < n; k++) {
        const double *p = &points[2 * k], *q = &points[2 * ((k + 1) % n)];
        sum += shared_with(r, (double[]){p[0] - from[0], p[1] - from[1]},
                           (double[]){q[0] - from[0], q[1] - from[1]});
    }
    return fabs(sum) > 1e-13 * all ? fabs(sum) / all : 0.0; /* beside it angles add up to rounding */
}
