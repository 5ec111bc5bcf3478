/* Least value of a function of one or two variables; see stats.h. */
#include <math.h>
#include <nlopt.h>

#include "stats/stats.h"

typedef struct {
    double (*f)(const double x[], void *data);
    void *data;
} function;

static double objective(unsigned n, const double *x, double *gradient, void *data)
{
    const function *s = data;
    (void)n, (void)gradient;
    return s->f(x, s->data);
}

rp_status stats_least(double (*f)(const double x[], void *data), void *data, const double lo[2],
                      const double hi[2], int cells, double x[2], double *value)
{
    const bool held[2] = {!(hi[0] > lo[0]), !(hi[1] > lo[1])};
    double cell[2], tolerance[2];
    *value = HUGE_VAL;
    for (int p = 0; p < 2; p++) {
        x[p] = lo[p];
        cell[p] = held[p] ? 1.0 : (hi[p] - lo[p]) / cells;
        tolerance[p] = 1e-9 * cell[p];
    }
    for (int i = 0; i <= (held[0] ? 0 : cells); i++)
        for (int j = 0; j <= (held[1] ? 0 : cells); j++) {
            /* round-off must not leave the box: NLopt refuses such a start */
            const double y[2] = {fmin(lo[0] + i * cell[0], hi[0]), fmin(lo[1] + j * cell[1], hi[1])};
            const double here = f(y, data);
            if (!(here < *value)) continue;
            *value = here;
            x[0] = y[0];
            x[1] = y[1];
        }
    if (held[0] && held[1]) return RP_OK;
    nlopt_opt o = nlopt_create(held[0] || held[1] ? NLOPT_LN_COBYLA : NLOPT_LN_SBPLX, 2);
    if (!o) return rp_fail(RP_NO_MEMORY, "minimum: out of memory");
    nlopt_set_min_objective(o, objective, &(function){f, data});
    nlopt_set_lower_bounds(o, lo);
    nlopt_set_upper_bounds(o, hi);
    nlopt_set_initial_step(o, cell);
    nlopt_set_xtol_abs(o, tolerance);
    nlopt_set_maxeval(o, 2000);
    const nlopt_result result = nlopt_optimize(o, x, value);
    nlopt_destroy(o);
    if (result > 0 || result == NLOPT_ROUNDOFF_LIMITED) return RP_OK;
    return rp_fail(RP_BROKEN, "minimum not found: %s", nlopt_result_to_string(result));
}
