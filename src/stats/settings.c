/* Settings compared by runs: where the outcome turns, and what an error bar costs; see stats.h. */
#include <math.h>
#include <stdlib.h>

#include "stats/stats.h"

void stats_threshold_find(size_t n, const double x[], const bool holds[], stats_threshold *threshold)
{
    stats_threshold t = {n, NAN, NAN, 0};
    for (size_t i = 0; i < n; i++) {
        if (holds[i])
            t.holds_from = fmin(t.holds_from, x[i]); /* fmin, fmax leave out nan */
        else
            t.fails_to = fmax(t.fails_to, x[i]);
    }
    for (size_t i = 0; i < n; i++) t.mixed += holds[i] && x[i] < t.fails_to;
    *threshold = t;
}

void stats_front(size_t n, stats_cost costs[])
{
    for (stats_cost *c = costs; c < costs + n; c++) {
        c->front = !isnan(c->cost) && !isnan(c->bias);
        for (size_t j = 0; j < n && c->front; j++)
            c->front = !(costs[j].cost < c->cost && fabs(costs[j].bias) < fabs(c->bias));
    }
}

/* The runs of one setting, and its pairs with the reference: runs of the same replica. */
static rp_status cost_of(size_t n, const stats_cost_run runs[], size_t setting, size_t reference,
                         double work[], stats_cost *c)
{
    double *y = work, *difference = work + n, steps = 0.0, a_step = INFINITY;
    size_t count = 0, pairs = 0;
    stats_summary own, paired;
    for (size_t i = 0; i < n; i++) {
        if (runs[i].setting != setting) continue;
        const size_t before = pairs;
        y[count++] = runs[i].y;
        steps += runs[i].steps;
        for (size_t j = 0; j < n; j++) {
            if (runs[j].size == runs[i].size) a_step = fmin(a_step, runs[j].seconds / runs[j].steps);
            if (runs[j].setting != reference || runs[j].replica != runs[i].replica) continue;
            if (pairs > before)
                return rp_fail(RP_BAD_INPUT, "replica %g: two runs of the last setting; more columns vary",
                               runs[i].replica);
            difference[pairs++] = runs[i].y - runs[j].y;
        }
    }
    *c = (stats_cost){count, NAN, NAN, NAN, NAN, NAN, NAN, false};
    if (count == 0) return RP_OK;
    rp_status status = stats_mean(count, y, &own);
    if (!status && pairs > 0) {
        status = stats_mean(pairs, difference, &paired);
        c->bias = paired.mean;
        c->bias_se = paired.se;
    }
    c->mean = own.mean;
    c->sd = own.sd;
    c->seconds = a_step * steps / (double)count;
    c->cost = own.sd * own.sd * c->seconds;
    return status;
}

rp_status stats_costs(size_t n, const stats_cost_run runs[], size_t n_settings, size_t reference,
                      stats_cost costs[])
{
    double *work = malloc((2 * n + 1) * sizeof *work);
    rp_status status = work ? RP_OK : rp_fail(RP_NO_MEMORY, "cost: out of memory");
    for (size_t i = 0; i < n && !status; i++)
        if (!(runs[i].steps > 0.0 && isfinite(runs[i].seconds)))
            status = rp_fail(RP_BAD_INPUT, "run %zu: %g s, %g steps: out of range, allowed: finite, (0, inf)",
                             i + 1, runs[i].seconds, runs[i].steps);
    for (size_t s = 0; s < n_settings && !status; s++)
        status = cost_of(n, runs, s, reference, work, &costs[s]);
    if (!status) stats_front(n_settings, costs);
    free(work);
    return status;
}
