/* Least value of a function of up to three variables; see stats.h. */
#include <math.h>
#include <nlopt.h>
#include <string.h>

#include "stats/stats.h"

enum { MOST = 3 };

/* The best of a grid, the last side fastest. */
static void best_of_grid(stats_function *f, void *data, size_t n, const double lo[], const double hi[],
                         const double cell[], int cells, double x[], double *value)
{
    int at[MOST] = {0};
    double y[MOST];
    for (size_t p = 1; p > 0;) {
        /* round-off must not leave the box: NLopt refuses such a start */
        for (size_t k = 0; k < n; k++) y[k] = fmin(lo[k] + at[k] * cell[k], hi[k]);
        const double here = f((unsigned)n, y, NULL, data);
        if (here < *value) *value = here, memcpy(x, y, n * sizeof *x);
        for (p = n; p > 0 && (!(hi[p - 1] > lo[p - 1]) || at[p - 1] == cells); p--) at[p - 1] = 0;
        if (p > 0) at[p - 1]++;
    }
}

rp_status stats_least(stats_function *f, void *data, size_t n, const double lo[], const double hi[],
                      int cells, double x[], double *value)
{
    double cell[MOST], tolerance[MOST];
    size_t n_free = 0;
    for (size_t p = 0; p < n; p++) {
        const bool held = !(hi[p] > lo[p]);
        n_free += !held;
        cell[p] = held ? 1.0 : (hi[p] - lo[p]) / cells;
        tolerance[p] = 1e-9 * cell[p];
        x[p] = lo[p];
    }
    *value = HUGE_VAL;
    best_of_grid(f, data, n, lo, hi, cell, cells, x, value);
    if (n_free == 0) return RP_OK;
    nlopt_opt o = nlopt_create(n_free == 1 ? NLOPT_LN_COBYLA : NLOPT_LN_SBPLX, (unsigned)n);
    if (!o) return rp_fail(RP_NO_MEMORY, "minimum: out of memory");
    nlopt_set_min_objective(o, f, data);
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
