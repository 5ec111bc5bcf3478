/* The way of a run from its start to its end, and its snapshots; see run.h. */
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <xxhash.h>

#include "core/clock.h"
#include "core/file.h"
#include "core/version.h"
#include "run/tables.h"

/* Grains times steps from one look at the clock to the next, which costs a thousandth of them, and most at
 * once, some tenths of a second, after which a signal and progress are seen. */
static const double LOOK = 2e3, MOST = 1e7;

rp_status run_key(const exp_plan *plan, unsigned long seed, unsigned long stream, char digits[33])
{
    XXH128_hash_t sum;
    exp_measured m;
    RP_TRY(exp_key(plan, &sum));
    for (size_t k = 0; k < exp_measure_count(plan); k++) {
        RP_TRY(exp_measure_at(plan, k, &m));
        /* a snapshot has the samples by place, and a series of those that its table has */
        const unsigned long series = m.series;
        const XXH128_hash_t parts[] = {sum, m.key, XXH3_128bits(&series, sizeof series)};
        if (m.n_outputs > 0) sum = XXH3_128bits(parts, sizeof parts);
    }
    const XXH128_hash_t all[] = {sum, XXH3_128bits((unsigned long[]){seed, stream}, 2 * sizeof seed)};
    rp_hash_digits(XXH3_128bits(all, sizeof all), digits);
    return RP_OK;
}

rp_status run_start(exp_plan *plan, unsigned long seed, unsigned long stream, run_driver *d)
{
    *d = (run_driver){.plan = plan, .seed = seed, .stream = stream, .threads = 1};
    return exp_start(plan, seed, stream, &d->run);
}

void run_free(run_driver *d)
{
    run_close_tables(d);
    exp_run_free(d->run);
    rp_arena_end(&d->memory);
}

/* ---- snapshots ---- */

/* Another commit may keep other variables, and another build of changed sources has other laws. */
static uint64_t layout(void)
{
    const uint64_t kept = dem_keep_layout() ^ exp_keep_layout() << 20;
    const uint64_t sources = XXH3_64bits_withSeed(rp_build_sources, strlen(rp_build_sources), kept);
    return XXH3_64bits_withSeed(rp_build_commit, strlen(rp_build_commit), sources);
}

static void keep_all(run_driver *d, rp_snapshot *s)
{
    if (!s->status) s->status = run_keep_tables(d, s);
    if (d->to.keep) d->to.keep(s, d->to.host);
    exp_keep(s, d->run);
}

static rp_status read_back(run_driver *d)
{
    RP_ENDS(rp_snapshot_free) rp_snapshot s = {0};
    RP_TRY(rp_snapshot_read(&s, d->to.snapshot, d->to.owner, layout()));
    RP_TRY(run_open_tables(d, true));
    keep_all(d, &s);
    return rp_snapshot_end(&s);
}

rp_status run_open(run_driver *d, const run_sinks *to, bool *resumed)
{
    *resumed = false;
    if (!exp_sim(d->run)) return RP_OK; /* it has ended */
    d->to = *to;
    d->next = rp_cpu_clock() + to->interval;
    *resumed = to->snapshot && rp_is_there(to->snapshot);
    rp_status status = *resumed ? read_back(d) : run_open_tables(d, false);
    if (*resumed && to->folder) status = rp_prefix(status, "remove %s to begin anew: ", to->folder);
    RP_TRY(status);
    return run_begin_tables(d, *resumed);
}

static rp_status keep(run_driver *d)
{
    RP_ENDS(rp_snapshot_free) rp_snapshot s = {0};
    RP_TRY(run_sync(d));
    keep_all(d, &s);
    RP_TRY(rp_snapshot_write(&s, d->to.snapshot, d->to.owner, layout()));
    d->next = rp_cpu_clock() + d->to.interval;
    return RP_OK;
}

/* The clock costs as much as a step of a small pile. */
static rp_status keep_if_due(run_driver *d, double work)
{
    d->work += work;
    if (!d->to.snapshot || d->work < LOOK) return RP_OK;
    d->work = 0.0;
    return rp_cpu_clock() < d->next ? RP_OK : keep(d);
}

void run_forget(const char *snapshot)
{
    char unfinished[4096 + 8];
    snprintf(unfinished, sizeof unfinished, "%s.new", snapshot);
    unlink(snapshot);
    unlink(unfinished);
}

/* ---- on to the end ---- */

/* Steps to the next of a multiple of `every`, at most `most`. */
static long steps_to(long step, long every, long most)
{
    const long next = every > 0 ? every - step % every : most;
    return next < most ? next : most;
}

static rp_status stop(run_driver *d)
{
    char where[256];
    if (d->to.snapshot) RP_TRY(keep(d));
    return rp_fail(RP_STOPPED, "stopped at step %ld of %s", exp_steps(d->run),
                   exp_where(d->run, where, sizeof where));
}

static rp_status go_on(run_driver *d)
{
    const run_sinks *to = &d->to;
    const long before = exp_steps(d->run);
    const double grains = (double)dem_count(exp_sim(d->run)) + 1.0;
    const size_t stages = exp_stages(d->run);
    long part = 1 + (long)(MOST * (double)d->threads / grains);
    for (int k = 0; k < RUN_TABLES; k++) part = steps_to(before, d->table[k] ? to->every[k] : 0, part);
    if (to->next) part = to->next(to->host, before) < part ? to->next(to->host, before) : part;
    RP_TRY(exp_advance(d->run, part));
    const long steps = exp_steps(d->run) - before;
    if (to->stages) RP_TRY(run_write_stages(d));
    if (steps > 0 && to->look) RP_TRY(to->look(to->host, d->run));
    if (exp_done(d->run)) return RP_OK;
    if (steps > 0) RP_TRY(run_write_frames(d, exp_stages(d->run) > stages, false));
    return to->stop && *to->stop ? stop(d) : keep_if_due(d, (double)steps * grains);
}

rp_status run_finish(run_driver *d)
{
    if (!exp_sim(d->run)) return RP_OK;
    dem_threads(exp_sim(d->run), d->threads);
    while (!exp_done(d->run)) RP_TRY(go_on(d));
    return run_write_end(d);
}
