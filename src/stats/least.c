/* Least value of a function of up to three variables; see stats.h. */
#include <math.h>
#include <nlopt.h>
#include <string.h>

#include "stats/stats.h"

enum { MOST = 3 };

/* The best of a grid, the last side fastest. */
static void best_of_grid(const stats_minimum *m, const double cell[], double x[], double *value)
{
    int at[MOST] = {0};
    double y[MOST];
    for (size_t p = 1; p > 0;) {
        /* round-off must not leave the box: NLopt refuses such a start */
        for (size_t k = 0; k < m->n; k++) y[k] = fmin(m->lo[k] + at[k] * cell[k], m->hi[k]);
        const double here = m->f((unsigned)m->n, y, NULL, m->data);
        if (here < *value) *value = here, memcpy(x, y, m->n * sizeof *x);
        for (p = m->n; p > 0 && (!(m->hi[p - 1] > m->lo[p - 1]) || at[p - 1] == m->cells); p--) at[p - 1] = 0;
        if (p > 0) at[p - 1]++;
    }
}

/* Downhill from y; x and *value if that ends lower. */
static rp_status descend(const stats_minimum *m, nlopt_algorithm algorithm, const double cell[], double y[],
                         double x[], double *value)
{
    double tolerance[MOST], least = HUGE_VAL;
    nlopt_opt o = nlopt_create(algorithm, (unsigned)m->n);
    if (!o) return rp_fail(RP_NO_MEMORY, "minimum: out of memory");
    for (size_t p = 0; p < m->n; p++) tolerance[p] = 1e-9 * cell[p];
    nlopt_set_min_objective(o, m->f, m->data);
    nlopt_set_lower_bounds(o, m->lo);
    nlopt_set_upper_bounds(o, m->hi);
    nlopt_set_initial_step(o, cell);
    nlopt_set_xtol_abs(o, tolerance);
    nlopt_set_maxeval(o, 2000);
    const nlopt_result result = nlopt_optimize(o, y, &least);
    nlopt_destroy(o);
    if (result < 0 && result != NLOPT_ROUNDOFF_LIMITED)
        return rp_fail(RP_BROKEN, "minimum not found: %s", nlopt_result_to_string(result));
    if (least < *value) *value = least, memcpy(x, y, m->n * sizeof *x);
    return RP_OK;
}

rp_status stats_least(const stats_minimum *m, double x[], double *value)
{
    double cell[MOST], y[MOST];
    size_t n_free = 0;
    if (m->n < 1 || m->n > MOST || m->cells < 1)
        return rp_fail(RP_BAD_INPUT, "minimum: %zu dimensions, %d cells: 1 to %d, and 1 or more expected",
                       m->n, m->cells, MOST);
    for (size_t p = 0; p < m->n; p++) {
        if (!isfinite(m->lo[p]) || !isfinite(m->hi[p]))
            return rp_fail(RP_BAD_INPUT, "minimum: side %zu: [%g, %g]: finite ends expected", p + 1, m->lo[p],
                           m->hi[p]);
        const bool held = !(m->hi[p] > m->lo[p]);
        n_free += !held;
        cell[p] = held ? 1.0 : (m->hi[p] - m->lo[p]) / m->cells;
    }
    *value = HUGE_VAL;
    best_of_grid(m, cell, x, value);
    if (n_free == 0) return RP_OK;
    memcpy(y, x, m->n * sizeof *y);
    if (n_free == 1) return descend(m, NLOPT_LN_COBYLA, cell, y, x, value);
    RP_TRY(descend(m, NLOPT_LN_BOBYQA, cell, y, x, value));
    /* the grid may miss a narrow valley: from the guess too, or from the middles of the halves of all sides
     */
    for (size_t k = 0; k < (m->guess ? 1 : 1u << m->n); k++) {
        for (size_t p = 0; p < m->n; p++)
            y[p] = m->guess ? fmin(fmax(m->guess[p], m->lo[p]), m->hi[p])
                            : m->lo[p] + (k >> p & 1 ? 0.75 : 0.25) * (m->hi[p] - m->lo[p]);
        RP_TRY(descend(m, NLOPT_LN_BOBYQA, cell, y, x, value));
    }
    memcpy(y, x, m->n * sizeof *y);
    return m->steps ? descend(m, NLOPT_LN_SBPLX, cell, y, x, value) : RP_OK;
}
