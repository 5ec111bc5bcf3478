/* `repose bench`: particle-steps a second on this machine, for the box scene. */
#include <math.h>
#include <stdlib.h>

#include "cli/cli.h"
#include "core/clock.h"
#include "dem/dem.h"

typedef struct {
    long n, steps;
    int state, kernel;
} bench_options;

static const rp_param options[] = {
    {"n", "", RP_INT, offsetof(bench_options, n), "400", "[1, 10000000]", "grains"},
    {"steps", "", RP_INT, offsetof(bench_options, steps), "auto", "[1, 1000000000] | auto",
     "steps timed; auto: 2e7 particle-steps, flowing at most 10000"},
    {"state", "", RP_CHOICE, offsetof(bench_options, state), "settled", "settled | flowing",
     "at rest in the box, or right after its wall is opened"},
    {"kernel", "", RP_CHOICE, offsetof(bench_options, kernel), "fast",
     "fast | reference | baseline | avx2 | avx512",
     "pair loop: the best here, the general one, or with these instructions"},
    {0}};

static const cli_command command = {
    "bench",
    "[--n N] [--state settled|flowing] [--steps N] [--kernel NAME]",
    "Fill a square box with grains of Lee & Herrmann's parameters (mu = 0.2, no rotation), let them settle,\n"
    "and time the simulator: million particle-steps a second, the best and the median of five runs, on one\n"
    "core.",
    "repose bench --n 1600 --state flowing",
    options,
    0,
    0};

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static rp_status settle(const bench_options *o, double width, dem_sim **sim)
{
    dem_fill fill = {o->n, width, 2.0 * width, 0.1, 0.02, 0.07, 0.13, 1.0, DEM_SPHERE, 1993, 0};
    dem_definition def = dem_definition_default();
    dem_grain *grains = malloc((size_t)o->n * sizeof *grains);
    if (!grains) return rp_fail(RP_NO_MEMORY, "%ld grains: out of memory", o->n);
    dem_material wall = def.material;
    wall.k_n *= 2.0;
    dem_box_walls(&def, width, &wall);
    def.x_max = 3.0 * width;
    def.grains = grains;
    def.n_grains = (size_t)o->n;
    def.kernel = o->kernel;
    rp_status status = dem_fill_random(&fill, grains);
    if (!status) status = dem_create(&def, sim);
    free(grains);
    /* a fall from 2 W and the time to calm down, both growing with the box */
    return status ? status : dem_run(*sim, lround(30000.0 * sqrt(width / 4.0)) + 10000);
}

rp_status cmd_bench(int argc, char **argv)
{
    static const char *const columns[][2] = {{"grains", ""},      {"steps", ""},    {"best", "1e6/s"},
                                             {"median", "1e6/s"}, {"seconds", "s"}, {"contacts", ""},
                                             {"pairs", ""},       {"rebuilds", ""}};
    enum { RUNS = 5 };
    bench_options o;
    int n;
    bool done;
    rp_status status = cli_parse(&command, argc, argv, &o, NULL, &n, &done);
    if (status || done) return status;
    const double width = fmax(0.4, sqrt(0.04 * (double)o.n));
    long steps = o.steps > 0 ? o.steps : (long)fmax(100.0, 2e7 / (double)o.n);
    if (o.steps <= 0 && o.state == 1 && steps > 10000) steps = 10000; /* later the pile has come to rest */
    const double begun = rp_clock();
    dem_sim *settled = NULL;
    double rates[RUNS];
    dem_counts before, after;
    status = settle(&o, width, &settled);
    if (!status && o.state == 1) dem_wall_open(settled, DEM_BOX_RIGHT, INFINITY);
    for (int k = 0; !status && k < RUNS; k++) {
        dem_sim *sim;
        status = dem_clone(settled, &sim);
        if (status) break;
        dem_count_work(sim, &before);
        double started = rp_clock();
        status = dem_run(sim, steps);
        double seconds = rp_clock() - started;
        dem_count_work(sim, &after);
        rates[k] = (after.grain_steps - before.grain_steps) / seconds / 1e6;
        dem_free(sim);
    }
    if (!status) {
        qsort(rates, RUNS, sizeof *rates, ascending);
        cli_table(stdout, options, &o);
        rp_table_note(stdout, "kernel", "%s", dem_kernel_name(settled));
        rp_table_columns(stdout, 8, columns);
        rp_table_row(stdout, 8,
                     (double[]){(double)o.n, (double)steps, rates[RUNS - 1], rates[RUNS / 2],
                                rp_clock() - begun, (double)after.contacts, (double)after.pairs,
                                (double)(after.rebuilds - before.rebuilds)});
    }
    dem_free(settled);
    return status;
}
