/* Chaos: growth rate of a round-off perturbation in an avalanche. Reproducibility: the kernel of the pair
 * loop and the number of workers change no bit. */
#include <gsl/gsl_fit.h>
#include <gsl/gsl_statistics_double.h>

#include "dem/state/state.h"
#include "sweeps/protocols/protocols.h"
#include "tests/folder.h"
#include "tests/grains.h"

static const double D = 0.2; /* nominal diameter */

/* Root mean square distance of the grains' positions in two simulations, in diameters. */
static double distance(const dem_sim *a, const dem_sim *b, dem_state *s, dem_state *t)
{
    const size_t n = dem_count(a), m = dem_count(b);
    double sum = 0.0;
    size_t both = 0;
    if (dem_states(a, s) != RP_OK || dem_states(b, t) != RP_OK) return NAN;
    for (size_t i = 0, j = 0; i < n && j < m;) {
        if (s[i].id == t[j].id) {
            const double dx = s[i].x - t[j].x, dy = s[i].y - t[j].y;
            sum += dx * dx + dy * dy;
            both++;
        }
        const uint32_t next = s[i].id;
        i += next <= t[j].id;
        j += t[j].id <= next;
    }
    return sqrt(sum / (double)both) / D;
}

typedef struct {
    double rate; /* growth rate of the logarithm of the distance, 1/s; NaN if it stays below 1e-3 diameters */
    double first, last; /* distances at the opening and at the end, diameters */
    double tenth;       /* distance after 0.01 s */
} growth;

typedef struct {
    size_t n;
    double t[2000], log_d[2000];
    bool grown;
} series;

/* Add a distance to the fit, in the linear regime: from ten times the first distance to 1e-3 diameters. */
static void note(series *s, double t, double d, double first)
{
    s->grown |= d > 1e-3;
    if (s->grown || !(d > 10.0 * first)) return;
    s->t[s->n] = t;
    s->log_d[s->n++] = log(d);
}

static dem_sim *filled_box(long N, double W, double dt, long stream, int kernel)
{
    dem_definition def = grains_box(N, W, stream, NULL);
    def.dt = dt, def.x_max = 3.0 * W, def.kernel = kernel;
    return grains_start(&def);
}

/* A filled box at rest is cloned, and one grain of the clone is shifted. Both are opened, and their distance
 * is recorded for 0.3 s. The rate is the slope of a least-squares line through its logarithm. */
static growth avalanche(long N, double W, double dt, double shift, long stream, FILE *out)
{
    const int most = 1200;
    const long every = lround(2.5e-4 / dt);
    scoped_sim *a = filled_box(N, W, dt, stream, DEM_FAST), *b = NULL;
    scoped dem_state *s = calloc((size_t)(2 * N), sizeof *s);
    scoped series *fit = calloc(1, sizeof *fit);
    CU_ASSERT_FATAL(s && fit);
    CHECK_OK(dem_run(a, lround(1.0 / dt)));
    CHECK_OK(dem_clone(a, &b));
    b->grains.motion[N / 2].x[0] += shift;
    dem_wall_open(a, DEM_BOX_RIGHT, INFINITY);
    dem_wall_open(b, DEM_BOX_RIGHT, INFINITY);
    growth g = {.rate = NAN, .first = distance(a, b, s, s + N)};
    for (int k = 1; k <= most && dem_run(a, every) == RP_OK && dem_run(b, every) == RP_OK; k++) {
        const double t = (double)k * (double)every * dt;
        g.last = distance(a, b, s, s + N);
        if (k == 40) g.tenth = g.last;
        note(fit, t, g.last, g.first);
        if (k % 4 == 0) CHECK_ROW(out, NULL, dt, shift, (double)stream, t, g.last);
    }
    double c0, cov[3], sumsq;
    if (fit->grown && fit->n > 2)
        gsl_fit_linear(fit->t, 1, fit->log_d, 1, fit->n, &c0, &g.rate, cov, cov + 1, cov + 2, &sumsq);
    return g;
}

/* A clone without a shift stays identical; small shifts grow in proportion, up to the size of a grain. */
static void round_off_grows(void)
{
    const growth none = avalanche(60, 1.6, 5e-5, 0.0, 0, NULL),
                 small = avalanche(60, 1.6, 5e-5, 1e-12, 0, NULL),
                 large = avalanche(60, 1.6, 5e-5, 1e-10, 0, NULL);
    CU_ASSERT(none.first == 0.0 && none.last == 0.0);
    /* in the linear regime, a hundred times the shift is a hundred times the distance; the shift is rounded
     * by 1e-16, and the rounding of a step adds as much */
    CHECK_NEAR(large.tenth / small.tenth, 100.0, 1.0);
    CU_ASSERT(small.rate > 50.0 && small.rate < 1000.0 && small.last > 1e6 * small.first);
}

static void growth_rate(void)
{
    const struct {
        double dt, shift;
    } groups[] = {{5e-5, 1e-15}, {2.5e-5, 1e-15}, {5e-5, 1e-12}};
    enum { SEEDS = 12, GROUPS = sizeof groups / sizeof *groups };
    double rates[GROUPS], errors[GROUPS];
    CHECK_TABLE(out, "chaos", "dt [s], shift [cm], seed, t [s], distance [d]");
    CHECK_TABLE(fits, "chaos_fit", "dt [s], shift [cm], n, rate [1/s], rate_se [1/s], doubling [s]");
    for (int i = 0; i < GROUPS && check_full(); i++) {
        double rate[SEEDS];
        for (int seed = 0; seed < SEEDS; seed++) {
            const growth g = avalanche(400, 4.0, groups[i].dt, groups[i].shift, seed, out);
            CU_ASSERT(g.rate > 0.0 && g.last > 1e-2);
            rate[seed] = g.rate;
        }
        rates[i] = gsl_stats_mean(rate, 1, SEEDS);
        errors[i] = gsl_stats_sd(rate, 1, SEEDS) / sqrt(SEEDS);
        /* Four standard errors of a difference: one of 16000 by chance. Growth accelerates during the
         * avalanche, and a larger shift is fitted over a different part of it. */
        CHECK_NEAR(rates[i], rates[0],
                   groups[i].shift > groups[0].shift ? 0.25 * rates[0] : 4.0 * hypot(errors[i], errors[0]));
        CHECK_ROW(fits, NULL, groups[i].dt, groups[i].shift, SEEDS, rates[i], errors[i], M_LN2 / rates[i]);
    }
}

/* Piles of a sweep have the same digest from one, two and five workers. */
static void any_number_of_workers(void)
{
    char base[FOLDER_PATH], digests[3][33];
    folder_make("chaos", base);
    const char *file = folder_path(base, "s.cfg");
    file_print(file, "protocol = \"repose\"; replicas = 4; seed = 7; fixed = { W = 1.0; H = 1.0; fill_steps "
                     "= 2000; stop = \"steps\"; relax_steps = 2000; }; grid = { mu = [0.1, 0.3]; };");
    for (int k = 0; k < 3; k++) {
        const char *dir = folder_path(base, (const char *[]){"0", "1", "2"}[k]);
        sweep_counts counts;
        size_t n;
        CHECK_OK(sweep_prepare(file, dir, 0, sweep_protocols, &counts));
        CHECK_OK(sweep_run(dir, sweep_protocols, &(sweep_options){.workers = (int[]){1, 2, 5}[k]}, &counts));
        digests[k][0] = '\0';
        CHECK_OK(sweep_digest(dir, sweep_protocols, digests[k], &n));
        CU_ASSERT(n == 8 && strcmp(digests[k], digests[0]) == 0);
    }
    folder_remove(base);
}

CHECK_SUITE(chaos, "validation: chaos", round_off_grows, growth_rate, any_number_of_workers)
