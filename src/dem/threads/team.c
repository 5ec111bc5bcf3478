/* Threads and their tasks; see threads.h. */
#include "dem/threads/threads.h"

#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

typedef struct {
    struct dem_crew *crew;
    dem_part *part;
    pthread_t thread;
    dem_sim sim; /* of the task */
    rp_status status;
    char message[512];
} worker;

struct dem_crew {
    size_t started;
    worker *worker;
    /* the task at hand, none at the end; tasks begun, and parts done of all tasks so far */
    dem_sim *sim;
    dem_task *task;
    atomic_uint begun, done, sleepers;
    unsigned tasks, spins;
    pthread_mutex_t mutex;
    pthread_cond_t changed;
};

/* Wait until a count has this value: a while in a loop, since most waits are shorter than a thread takes to
 * wake up; there the processor goes to whoever else wants it. */
static void await(struct dem_crew *crew, atomic_uint *count, unsigned value)
{
    for (unsigned k = 0; k < crew->spins; k++) {
        if (atomic_load(count) == value) return;
        sched_yield();
    }
    pthread_mutex_lock(&crew->mutex);
    atomic_fetch_add(&crew->sleepers, 1);
    while (atomic_load(count) != value) pthread_cond_wait(&crew->changed, &crew->mutex);
    atomic_fetch_sub(&crew->sleepers, 1);
    pthread_mutex_unlock(&crew->mutex);
}

static void raise_count(struct dem_crew *crew, atomic_uint *count)
{
    atomic_fetch_add(count, 1);
    if (atomic_load(&crew->sleepers) == 0) return;
    pthread_mutex_lock(&crew->mutex);
    pthread_cond_broadcast(&crew->changed);
    pthread_mutex_unlock(&crew->mutex);
}

static void do_part(worker *w)
{
    w->sim = *w->crew->sim;
    w->status = w->crew->task(&w->sim, w->part);
    if (w->status) snprintf(w->message, sizeof w->message, "%s", rp_message());
    if (w->part->collects) w->part->found = w->sim.pairs;
    w->part->collects = false;
}

static void *work(void *of)
{
    worker *w = of;
    for (unsigned task = 1;; task++) {
        await(w->crew, &w->crew->begun, task);
        if (!w->crew->task) return NULL;
        do_part(w);
        raise_count(w->crew, &w->crew->done);
    }
}

rp_status dem_threads_do(dem_sim *sim, dem_task *task, size_t n, size_t unit)
{
    if (!sim->team) return task(sim, &(dem_part){.of = 1, .to = n});
    struct dem_crew *crew = sim->team->crew;
    crew->sim = sim, crew->task = task;
    for (size_t t = 0, from = 0; t < sim->team->n; t++) {
        dem_part *part = &sim->team->part[t];
        part->from = from;
        from = part->to = t + 1 == part->of ? n : n * (t + 1) / part->of / unit * unit;
    }
    raise_count(crew, &crew->begun);
    do_part(&crew->worker[0]);
    await(crew, &crew->done, ++crew->tasks * (unsigned)crew->started);
    for (size_t t = 0; t < sim->team->n; t++) {
        const worker *w = &crew->worker[t];
        sim->too_deep |= w->sim.too_deep;
        sim->ahead_left |= w->sim.ahead_left;
        sim->list.fastest = fmax(sim->list.fastest, w->sim.list.fastest);
        sim->list.far2 = fmax(sim->list.far2, w->sim.list.far2);
    }
    for (size_t t = 0; t < sim->team->n; t++) {
        const worker *w = &crew->worker[t];
        if (!w->status) continue;
        sim->fault = w->sim.fault;
        return rp_fail(w->status, "%s", w->message);
    }
    return RP_OK;
}

struct dem_team *dem_team_start(size_t n)
{
    enum { SPINS = 300 }; /* some 0.1 ms */
    struct dem_team *team = calloc(1, sizeof *team);
    struct dem_crew *crew = calloc(1, sizeof *crew);
    dem_part *part = calloc(n, sizeof *part);
    worker *workers = calloc(n, sizeof *workers);
    if (!team || !crew || !part || !workers) {
        free(team), free(crew), free(part), free(workers);
        return NULL;
    }
    crew->worker = workers;
    crew->spins = (long)n <= sysconf(_SC_NPROCESSORS_ONLN) ? SPINS : 0;
    pthread_mutex_init(&crew->mutex, NULL);
    pthread_cond_init(&crew->changed, NULL);
    for (size_t t = 0; t < n; t++) {
        worker *w = &workers[t];
        w->crew = crew, w->part = &part[t];
        if (t > 0 && pthread_create(&w->thread, NULL, work, w) != 0) break;
        crew->started = t;
    }
    *team = (struct dem_team){.n = crew->started + 1, .part = part, .crew = crew};
    for (size_t t = 0; t < team->n; t++) part[t].index = t, part[t].of = team->n;
    return team;
}

void dem_team_end(struct dem_team *team)
{
    struct dem_crew *crew = team->crew;
    crew->task = NULL;
    raise_count(crew, &crew->begun);
    for (size_t t = 1; t <= crew->started; t++) pthread_join(crew->worker[t].thread, NULL);
    pthread_mutex_destroy(&crew->mutex);
    pthread_cond_destroy(&crew->changed);
    free(crew->worker), free(crew), free(team->part), free(team->late), free(team);
}
