/* `repose bench`: particle-steps per second on this machine, and each phase's share, for the box scene. */
#include <gsl/gsl_sort.h>
#include <malloc.h>

#include "cli/cli.h"
#include "cli/closing.h"
#include "core/clock.h"
#include "dem/scene/scene.h"

enum { SETTLED, FLOWING, SAMPLE };
enum { EXTENDS, ABSORBS };
enum { MOST = 100, FILL_STEPS = 30000, RELAX_STEPS = 50000, WARM_STEPS = 2000 };

#define BENCH_OPTIONS(X)                                                                                     \
    X(INT, n, "", "400", "[1, 100000]",                                                                      \
      "number of grains; give larger piles, whose fall would be too high, with --start")                     \
    X(REAL, width, "cm", "auto", "(0, inf) | auto", "width of the box; auto: square when settled")           \
    X(INT, steps, "", "auto", "[1, 1000000000] | auto",                                                      \
      "timed steps, not for a sample; auto: 2e7 particle-steps, and at most 10000 steps if flowing")         \
    X(CHOICE, state, "", "settled", "settled | flowing | sample",                                            \
      "settled: at rest in the box; flowing: right after the opening; sample: a whole run from fill to "     \
      "slope, with input, 30000 steps closed, 50000 open, and output")                                       \
    X(CHOICE, floor, "", "extends", "extends | absorbs",                                                     \
      "floor beyond the opening: extends to 3 W, or absorbs grains at W")                                    \
    X(BOOL, rotation, "", "false", "", "let the grains rotate")                                              \
    X(REAL, mu_roll, "", "0", "[0, inf)", "rolling resistance, with --rotation")                             \
    X(REAL, size_ratio, "", "auto", "[1, 100] | auto",                                                       \
      "largest over smallest radius: grains of each range of radii then cover an area proportional to the "  \
      "range, and their root mean square radius is 0.1 cm; auto: Gaussian radii of 0.07 to 0.13 cm")         \
    X(CHOICE, kernel, "", "fast", "fast | reference | baseline | avx2 | avx512",                             \
      "kernel of the pair loop: the fastest here, the reference, or an instruction set")                     \
    X(INT, repeat, "", "5", "[1, 100]",                                                                      \
      "number of timed runs, for the best and the median; 1: no extra run for the phases")                   \
    X(TEXT, start, "", "", "",                                                                               \
      "table with columns x y r (cm) of initial grains at rest, instead of a fill of -n; settled and "       \
      "sample: the first 2000 steps are not timed")                                                          \
    X(INT, j, "", "1", "[1, 256]",                                                                           \
      "threads; with more than one, rates are per second of wall time, and the phases are those of one")     \
    X(TEXT, o, "", "", "",                                                                                   \
      "table for the grains, at the end of a sample, otherwise at rest before the timed steps")              \
    CLI_FORCE(X, "replace an existing file")

CLI_OPTIONS(bench, BENCH_OPTIONS)

/* The grains of a table as a new array, with velocity 0. */
static rp_status read_start(rp_arena *arena, const char *path, dem_grain **grains, long *n)
{
    double *values;
    size_t rows;
    RP_TRY(rp_columns_read_file(arena, path, "x,y,r", &values, &rows));
    if (rows == 0) return rp_fail(RP_BAD_INPUT, "%s: no grains", path);
    *grains = rp_arena_memory(arena, rows, sizeof **grains);
    for (size_t i = 0; i < rows; i++) {
        const double r = values[2 * rows + i];
        (*grains)[i] =
            (dem_grain){.x = values[i], .y = values[rows + i], .r = r, .m = dem_mass(DEM_SPHERE, 1.0, r)};
    }
    *n = (long)rows;
    return RP_OK;
}

/* Radii from the largest to the smallest: equal areas of equal ranges of r, n(r) ~ 1/r^2, are equal numbers
 * of equal ranges of 1/r; the mean of r^2 is the product of both ends. */
static rp_status fill(rp_arena *arena, const bench_options *o, dem_grain **grains)
{
    const dem_fill dilute = {o->n, o->width, 2.0 * o->width, 0.1, 0.02, 0.07, 0.13, 1.0, DEM_SPHERE, 1993, 0};
    *grains = rp_arena_memory(arena, (size_t)o->n, sizeof **grains);
    if (!(o->size_ratio > 0.0)) return dem_fill_grains(&dilute, *grains, &(size_t){0});
    const double first = 10.0 / sqrt(o->size_ratio), last = 10.0 * sqrt(o->size_ratio); /* 1/cm */
    for (long i = 0; i < o->n; i++)
        (*grains)[i].r = 1.0 / (first + (last - first) * ((double)i + 0.5) / (double)o->n);
    return dem_fill_place(&dilute, *grains);
}

/* The closed box with its grains, at step 0; o->n becomes their number, o->width that of the box. */
static rp_status begin(rp_arena *arena, bench_options *o, dem_sim **sim, double *dt)
{
    dem_grain *grains = NULL;
    const rp_mark mark = rp_arena_mark(arena); /* memory counts */
    if (*o->start) RP_TRY(read_start(arena, o->start, &grains, &o->n));
    if (!(o->width > 0.0)) o->width = fmax(0.4, sqrt(0.04 * (double)o->n));
    if (!grains) RP_TRY(fill(arena, o, &grains));
    dem_definition def = dem_definition_default();
    def.damping = DEM_DAMPING_OUTSIDE; /* of the paper's box */
    def.rotation = o->rotation;
    def.material.mu_roll = o->mu_roll;
    dem_material wall = def.material;
    wall.k_n *= 2.0;
    dem_box_walls(&def, o->width, &wall);
    def.x_max = o->floor == ABSORBS ? o->width : 3.0 * o->width;
    def.grains = grains;
    def.n_grains = (size_t)o->n;
    def.kernel = o->kernel;
    /* smaller from some 50 000 grains on: the grains fall from a great height */
    *dt = def.dt = fmin(def.dt, dem_time_step_limit(&def, NULL));
    RP_TRY(dem_create(&def, sim));
    dem_threads(*sim, (size_t)o->j);
    rp_arena_release(arena, mark);
    return RP_OK;
}

static rp_status write_grains(const cli_call *call, const bench_options *o, const dem_sim *sim)
{
    FILE *out;
    RP_TRY(rp_file_open(o->o, o->force, &out));
    cli_provenance(call, out);
    dem_write_columns(DEM_TABLE_STATES, sim, out);
    return rp_file_close(o->o, out, dem_write_rows(DEM_TABLE_STATES, sim, dem_step(sim), out));
}

/* A fall from 2 W and the time to settle, both growing with the box. Large grains that fall from so high
 * would crush small ones: these do so under a hundredth of gravity first, in short steps. */
static rp_status settle(const bench_options *o, dem_sim *sim, double dt)
{
    const double settling = 30000.0 * sqrt(o->width / 4.0) + 10000.0;
    if (!(o->size_ratio > 0.0)) return dem_run(sim, lround(settling));
    const long steps = lround(settling * 5e-5 / dt);
    double g[2];
    dem_gravity(sim, g);
    dem_gravity_set(sim, (double[2]){0.0, 0.01 * g[1]});
    RP_TRY(dem_run(sim, steps));
    dem_gravity_set(sim, g);
    return dem_run(sim, steps);
}

static rp_status advance(dem_sim *sim, long steps, dem_phases *times)
{
    return times ? dem_run_timed(sim, steps, times) : dem_run(sim, steps);
}

/* A whole run, from the fill to the slope. */
static rp_status run_sample(const cli_call *call, bench_options *o, dem_sim **sim, dem_phases *times,
                            cli_slope *slope)
{
    double dt;
    RP_TRY(begin(call->arena, o, sim, &dt));
    RP_TRY(advance(*sim, FILL_STEPS, times));
    dem_wall_open(*sim, DEM_BOX_RIGHT, INFINITY);
    RP_TRY(advance(*sim, RELAX_STEPS, times));
    RP_TRY(cli_slope_of(call->arena, *sim, slope));
    return *o->o ? write_grains(call, o, *sim) : RP_OK;
}

typedef struct {
    double rate; /* 1e6/s */
    size_t grains;
    long rebuilds;
    dem_counts counts; /* at the end */
    cli_slope slope;   /* of a sample */
} bench_run;

static void free_sim(dem_sim **sim)
{
    dem_free(*sim);
}

/* One run, of a sample or from `settled` on. */
static rp_status run_once(const cli_call *call, bench_options *o, const dem_sim *settled, dem_phases *times,
                          bench_run *run)
{
    dem_counts before = {0};
    RP_ENDS(free_sim) dem_sim *sim = NULL;
    if (settled) RP_TRY(dem_clone(settled, &sim));
    if (settled) dem_count_work(sim, &before);
    const double cpu = rp_cpu_clock(), wall = rp_clock();
    RP_TRY(settled ? advance(sim, o->steps, times) : run_sample(call, o, &sim, times, &run->slope));
    const double seconds = o->j > 1 ? rp_clock() - wall : rp_cpu_clock() - cpu;
    dem_count_work(sim, &run->counts);
    run->rate = (run->counts.grain_steps - before.grain_steps) / seconds / 1e6;
    run->rebuilds = run->counts.rebuilds - before.rebuilds;
    run->grains = dem_count(sim);
    return RP_OK;
}

/* Bytes allocated by malloc. */
static double heap(void)
{
    const struct mallinfo2 now = mallinfo2();
    return (double)(now.uordblks + now.hblkhd);
}

static void write_row(const cli_call *call, const bench_options *o, double rates[], const bench_run *last,
                      const dem_phases *times, const double memory[2], double seconds)
{
    const double all = times->contacts + times->lists + times->integration + times->walls;
    const double inner = times->contacts + times->integration;
    gsl_sort(rates, 1, (size_t)o->repeat);
    const double n = (double)o->n, grains = (double)last->grains, median = rates[o->repeat / 2];
    rp_table_header(call->out, call->units,
                    "grains, steps, best [1e6/s], median [1e6/s], bound [1e6/s], seconds [s], contacts "
                    "[1/grain], pairs [1/grain], rebuilds, share_contacts, share_lists, share_integration, "
                    "share_walls, bytes [B/grain], peak_bytes [B/grain]");
    /* the bound follows from the shares, so that the cost of the clocks enters only through them */
    CLI_ROW(n, (double)o->steps, rates[o->repeat - 1], median, median * all / inner, seconds,
            (double)last->counts.contacts / grains, (double)last->counts.pairs / grains,
            (double)last->rebuilds, times->contacts / all, times->lists / all, times->integration / all,
            times->walls / all, memory[0] / n, memory[1] / n);
}

static rp_status measure(cli_call *call, const void *values)
{
    bench_options *o = call->values; /* the header has what stands for auto */
    (void)values;
    const double begun = rp_clock(), heap_before = heap(), peak_before = rp_peak_memory();
    RP_ENDS(free_sim) dem_sim *sim = NULL;
    dem_phases times = {0};
    bench_run run = {0}, timed;
    double rates[MOST], dt = NAN;
    const bool sample = o->state == SAMPLE;
    RP_TRY(begin(call->arena, o, &sim, &dt));
    if (sample)
        o->steps = FILL_STEPS + RELAX_STEPS;
    else if (o->steps <= 0) { /* after 10000 steps the pile flows no more */
        const double most = o->state == FLOWING ? 10000.0 : INFINITY;
        o->steps = (long)fmin(fmax(100.0, 2e7 / (double)o->n), most);
    }
    if (!sample) RP_TRY(*o->start ? dem_run(sim, WARM_STEPS) : settle(o, sim, dt));
    if (!sample && *o->o) RP_TRY(write_grains(call, o, sim));
    if (o->state == FLOWING) dem_wall_open(sim, DEM_BOX_RIGHT, INFINITY);
    const double memory[2] = {heap() - heap_before, 1e6 * (rp_peak_memory() - peak_before)};
    const dem_sim *from = sample ? NULL : sim;
    for (int k = 0; k < o->repeat; k++) {
        RP_TRY(run_once(call, o, from, NULL, &run));
        rates[k] = run.rate;
    }
    if (o->repeat > 1) RP_TRY(run_once(call, o, from, &times, &timed));
    cli_tell_threads(sim, "bench", o->j);
    cli_table(call, call->out);
    rp_table_note(call->out, "pair_loop", "%s", dem_kernel_name(sim));
    rp_table_note(call->out, "dt", "%.17g s", dt);
    if (sample) rp_table_note(call->out, "theta_r", "%.17g degrees", run.slope.theta_r.theta / deg);
    write_row(call, o, rates, &run, &times, memory, rp_clock() - begun);
    return RP_OK;
}

const cli_command cmd_bench = {
    "bench",
    "measure particle-steps per second on this machine",
    "[-n N | --start TABLE] [--width W] [--size-ratio R] [--rotation] [--mu-roll MU] [--state "
    "settled|flowing|sample] [--floor extends|absorbs] [--steps N] [--kernel NAME] [--repeat N] [-j N] [-o "
    "TABLE]",
    "Fills a square box with grains of Lee & Herrmann's parameters (mu = 0.2; no rotation, unless asked "
    "for), lets them settle, and times the simulator on one core. The rate is in 1e6 particle-steps per "
    "second of processor time, best and median of several runs. An extra run times the phases one after "
    "another, and gives the fractions of contacts, neighbour lists, integration and walls, and `bound`, the "
    "rate without lists and walls. Numbers of contacts and listed pairs are per grain, at the end. `bytes` "
    "is the memory held per grain, and `peak_bytes` the growth so far of the largest memory of the process. "
    "For a sample, a line above the table has theta_R by method 3; it is nan if the surface does not fall to "
    "one side.",
    "repose bench -n 1600 --state flowing --floor absorbs",
    bench_params,
    .refuses = "More than 100000 grains in its own fill: give larger piles with --start.",
    .act = measure};
