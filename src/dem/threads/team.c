/* Threads in one large pile; see threads.h. They live as long as a dem_run: nothing of them is in a clone, a
 * snapshot or a process that is forked. */
#include "dem/threads/team.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>
#ifdef __SSE2__
#include <immintrin.h>
#define relax _mm_pause
#else
#define relax() (void)0
#endif

#include "dem/state/state.h"

typedef struct {
    dem_part part;
    struct dem_team *team;
    pthread_t thread;
    dem_sim sim; /* of the task */
    rp_status status;
    char message[512];

    dem_pairs found; /* new pairs, from this number on in the list */
    size_t found_from;
    bool collects;
    uint32_t *border; /* pairs of its stretch with a grain of another part */
    size_t n_border, border_capacity, done_capacity;
    uint32_t *done;
    void
        *force; /* forces, or with torques, on the grains from force_from on, as far as its pairs have them */
    size_t force_from, force_capacity;
    size_t *slot, *next; /* for each wall: the part's first slot; as of dem_walls */
    dem_vec *wall_force; /* not all of it, and read by nobody: a run's last step is one thread's */
} worker;

struct dem_team {
    size_t n, started;
    worker *worker;
    bool *late;
    size_t late_capacity;
    /* the task at hand, none at the end; tasks begun, and parts done of all tasks so far */
    dem_sim *sim;
    dem_task *task;
    atomic_uint begun, done, sleepers;
    unsigned tasks, spins;
    pthread_mutex_t mutex;
    pthread_cond_t changed;
};

/* ---- The team ---- */

/* Wait until a count has this value: a while in a loop, since most waits are shorter than a thread takes to
 * wake up. */
static void await(struct dem_team *team, atomic_uint *count, unsigned value)
{
    for (unsigned k = 0; k < team->spins; k++) {
        if (atomic_load(count) == value) return;
        relax();
    }
    pthread_mutex_lock(&team->mutex);
    atomic_fetch_add(&team->sleepers, 1);
    while (atomic_load(count) != value) pthread_cond_wait(&team->changed, &team->mutex);
    atomic_fetch_sub(&team->sleepers, 1);
    pthread_mutex_unlock(&team->mutex);
}

static void raise_count(struct dem_team *team, atomic_uint *count)
{
    atomic_fetch_add(count, 1);
    if (atomic_load(&team->sleepers) == 0) return;
    pthread_mutex_lock(&team->mutex);
    pthread_cond_broadcast(&team->changed);
    pthread_mutex_unlock(&team->mutex);
}

static void do_part(worker *w)
{
    w->sim = *w->team->sim;
    w->status = w->team->task(&w->sim, &w->part);
    if (w->status) snprintf(w->message, sizeof w->message, "%s", rp_message());
    if (w->collects) w->found = w->sim.pairs;
    w->collects = false;
}

static void *work(void *of)
{
    worker *w = of;
    for (unsigned task = 1;; task++) {
        await(w->team, &w->team->begun, task);
        if (!w->team->task) return NULL;
        do_part(w);
        raise_count(w->team, &w->team->done);
    }
}

rp_status dem_threads_do(dem_sim *sim, dem_task *task)
{
    struct dem_team *team = sim->team;
    if (!team) return task(sim, &(dem_part){.of = 1});
    team->sim = sim, team->task = task;
    raise_count(team, &team->begun);
    do_part(&team->worker[0]);
    await(team, &team->done, ++team->tasks * (unsigned)team->started);
    for (size_t t = 0; t < team->n; t++) {
        const worker *w = &team->worker[t];
        sim->too_deep |= w->sim.too_deep;
        sim->ahead_left |= w->sim.ahead_left;
        sim->list.fastest = fmax(sim->list.fastest, w->sim.list.fastest);
        sim->list.far2 = fmax(sim->list.far2, w->sim.list.far2);
    }
    for (size_t t = 0; t < team->n; t++) {
        const worker *w = &team->worker[t];
        if (!w->status) continue;
        sim->fault = w->sim.fault;
        return rp_fail(w->status, "%s", w->message);
    }
    return RP_OK;
}

rp_status dem_threads_do_parts(dem_sim *sim, dem_task *task)
{
    dem_part all = {.of = 1, .grain_end = sim->grains.n, .pair_end = sim->pairs.n, .done = sim->pairs.done};
    return dem_threads_divided(sim) ? dem_threads_do(sim, task) : task(sim, &all);
}

static bool start_thread(worker *w, size_t walls)
{
    w->slot = calloc(2 * (walls + 1), sizeof *w->slot);
    w->wall_force = calloc(walls + 1, sizeof *w->wall_force);
    w->next = w->slot + walls + 1;
    return w->slot && w->wall_force &&
           (w == w->team->worker || pthread_create(&w->thread, NULL, work, w) == 0);
}

void dem_threads_start(dem_sim *sim)
{
    enum { SPINS = 3000 }; /* some 0.1 ms */
    if (sim->threads < 2 || !sim->scheme->runs_ahead || sim->def.hard.on || sim->ledger || sim->times ||
        !dem_pairs_are_many(&sim->pairs))
        return;
    struct dem_team *team = calloc(1, sizeof *team);
    if (team) team->worker = calloc(sim->threads, sizeof *team->worker);
    if (!team || !team->worker) {
        free(team);
        return;
    }
    pthread_mutex_init(&team->mutex, NULL);
    pthread_cond_init(&team->changed, NULL);
    team->spins = (long)sim->threads <= sysconf(_SC_NPROCESSORS_ONLN) ? SPINS : 0;
    for (size_t t = 0; t < sim->threads; t++) {
        worker *w = &team->worker[t];
        w->team = team;
        w->found = (dem_pairs){.springs_only = true};
        w->part.before = w->part.after =
            (dem_pairs){.rotation = sim->pairs.rotation, .rolling = sim->pairs.rolling};
        team->n += start_thread(w, sim->def.n_walls);
        if (team->n == t) break;
        team->started = t;
    }
    for (size_t t = 0; t < team->n; t++) team->worker[t].part.index = t, team->worker[t].part.of = team->n;
    sim->team = team;
    if (team->n == 0 || dem_threads_divide(sim)) dem_threads_end(sim);
}

void dem_threads_end(dem_sim *sim)
{
    struct dem_team *team = sim->team;
    if (!team) return;
    sim->team = NULL;
    team->task = NULL;
    raise_count(team, &team->begun);
    for (size_t t = 1; t <= team->started; t++) pthread_join(team->worker[t].thread, NULL);
    for (size_t t = 0; t < sim->threads; t++) {
        worker *w = &team->worker[t];
        dem_pairs_free(&w->part.before), dem_pairs_free(&w->part.after), dem_pairs_free(&w->found);
        free(w->border), free(w->done), free(w->force), free(w->slot), free(w->wall_force);
    }
    pthread_mutex_destroy(&team->mutex);
    pthread_cond_destroy(&team->changed);
    free(team->worker), free(team->late), free(team);
}

/* ---- The parts ---- */

bool dem_threads_divided(const dem_sim *sim)
{
    return sim->team && sim->pairs.n_chunks > 0;
}

static inline bool has(const dem_part *part, uint32_t i)
{
    return i >= part->grain && i < part->grain_end;
}

static worker *worker_of(const dem_sim *sim, const dem_part *part)
{
    return &sim->team->worker[part->index];
}

void dem_threads_collect(dem_sim *sim, const dem_part *part)
{
    if (sim->team) {
        sim->pairs = worker_of(sim, part)->found;
        worker_of(sim, part)->collects = true;
    }
    sim->pairs.n = 0;
}

static rp_status gather(dem_sim *sim, dem_part *part)
{
    const worker *w = worker_of(sim, part);
    if (w->found.n == 0) return RP_OK;
    memcpy(sim->pairs.i + w->found_from, w->found.i, w->found.n * sizeof *w->found.i);
    memcpy(sim->pairs.j + w->found_from, w->found.j, w->found.n * sizeof *w->found.j);
    return RP_OK;
}

rp_status dem_threads_gather(dem_sim *sim)
{
    size_t n = 0;
    if (!sim->team) return RP_OK;
    for (size_t t = 0; t < sim->team->n; t++) {
        sim->team->worker[t].found_from = n;
        n += sim->team->worker[t].found.n;
    }
    sim->pairs.n = 0;
    RP_TRY(dem_pairs_reserve(&sim->pairs, n));
    sim->pairs.n = n;
    return dem_threads_do(sim, gather);
}

/* Stretches of the list with as many pairs each. The grains whose pairs begin there, rounded to groups, are
 * the part's. */
static rp_status set_bounds(dem_sim *sim)
{
    struct dem_team *team = sim->team;
    const size_t groups = sim->grains.n / DEM_GROUP + 1;
    if (groups > team->late_capacity &&
        !dem_grow(&team->late, sizeof *team->late, team->late_capacity = 2 * groups))
        return rp_fail(RP_NO_MEMORY, "threads: out of memory");
    size_t pair = 0, grain = 0;
    for (size_t t = 0; t < team->n; t++) {
        dem_part *part = &team->worker[t].part;
        part->pair = pair, part->grain = grain;
        pair = part->pair_end = dem_share_end(part, sim->pairs.n, 64);
        grain = part->grain_end =
            t + 1 == team->n ? sim->grains.n : sim->pairs.i[pair] / DEM_GROUP * DEM_GROUP;
        part->late = team->late;
    }
    return RP_OK;
}

/* Of the part's stretch, the pairs that other parts need too. */
static rp_status find_border(dem_sim *sim, dem_part *part)
{
    worker *w = worker_of(sim, part);
    w->n_border = 0;
    for (size_t k = part->pair; k < part->pair_end; k++) {
        if (has(part, sim->pairs.i[k]) && has(part, sim->pairs.j[k])) continue;
        if (w->n_border == w->border_capacity &&
            !dem_grow(&w->border, sizeof *w->border, w->border_capacity = 2 * w->border_capacity + 1024))
            return rp_fail(RP_NO_MEMORY, "threads: out of memory");
        w->border[w->n_border++] = (uint32_t)k;
    }
    return RP_OK;
}

/* Copies of pairs of other stretches; groups that others read; from and to which grain there are pairs. */
static rp_status copy_border(dem_sim *sim, dem_part *part, size_t *from, size_t *to)
{
    const worker *all = sim->team->worker;
    bool *late = sim->team->late;
    *from = part->grain, *to = part->grain_end;
    part->before.n = part->after.n = 0;
    for (size_t g = *from; g < *to; g += DEM_GROUP) late[g / DEM_GROUP] = false;
    for (size_t t = 0; t < part->of; t++) {
        dem_pairs *copies = t < part->index ? &part->before : &part->after;
        for (size_t b = 0; b < all[t].n_border; b++) {
            const uint32_t k = all[t].border[b], i = sim->pairs.i[k], j = sim->pairs.j[k];
            const uint32_t low = i < j ? i : j, high = i < j ? j : i;
            if (has(part, i)) late[i / DEM_GROUP] = true;
            if (has(part, j)) late[j / DEM_GROUP] = true;
            if (t != part->index && !has(part, i) && !has(part, j)) continue;
            *from = low < *from ? low : *from;
            *to = high + 1 > *to ? high + 1 : *to;
            if (t != part->index) RP_TRY(dem_pairs_append(copies, &sim->pairs, k));
        }
    }
    dem_pairs_pad(&part->before), dem_pairs_pad(&part->after);
    return RP_OK;
}

static void find_done(dem_sim *sim, dem_part *part, uint32_t *done)
{
    uint32_t least = (uint32_t)part->grain_end;
    for (size_t k = 0; k < part->after.n; k++) {
        const uint32_t i = part->after.i[k], j = part->after.j[k];
        if (has(part, i) && i < least) least = i;
        if (has(part, j) && j < least) least = j;
    }
    if (least < part->grain_end) least = least / DEM_GROUP * DEM_GROUP;
    dem_pairs_find_done(&sim->pairs, part->pair, part->pair_end, part->grain, least, done);
    part->done = done;
}

static void find_slots(const dem_sim *sim, worker *w)
{
    for (size_t a = 0; a < sim->def.n_walls; a++) {
        size_t k = sim->walls.start[a];
        while (k < sim->walls.start[a + 1] && sim->walls.slot[k].grain < w->part.grain) k++;
        w->slot[a] = k;
    }
}

void dem_threads_find_slots(dem_sim *sim)
{
    for (size_t t = 0; dem_threads_divided(sim) && t < sim->team->n; t++)
        find_slots(sim, &sim->team->worker[t]);
}

static rp_status plan(dem_sim *sim, dem_part *part)
{
    worker *w = worker_of(sim, part);
    size_t from, to;
    RP_TRY(copy_border(sim, part, &from, &to));
    const size_t size = sim->grains.force_torque ? sizeof(dem_force_torque) : sizeof(dem_vec),
                 chunks = (part->pair_end - part->pair) / sim->pairs.chunk + 1;
    w->force_from = from / DEM_GROUP * DEM_GROUP;
    if (to - w->force_from > w->force_capacity) {
        free(w->force);
        w->force = dem_array(w->force_capacity = (to - w->force_from) / 8 * 9 + 64, size);
    } else if (to > w->force_from) {
        memset(w->force, 0, (to - w->force_from) * size);
    }
    if (chunks > w->done_capacity && !dem_grow(&w->done, sizeof *w->done, w->done_capacity = 2 * chunks))
        w->done_capacity = 0;
    if (!w->force || w->done_capacity == 0) return rp_fail(RP_NO_MEMORY, "threads: out of memory");
    find_done(sim, part, w->done);
    find_slots(sim, w);
    return RP_OK;
}

void dem_threads_enter(dem_sim *sim, const dem_part *part)
{
    if (!dem_threads_divided(sim)) return;
    const worker *w = worker_of(sim, part);
    /* not a pointer into the array where it begins before that */
    const uintptr_t force = (uintptr_t)w->force;
    if (sim->grains.force_torque)
        sim->grains.force_torque = (dem_force_torque *)(force - w->force_from * sizeof(dem_force_torque));
    else
        sim->grains.force = (dem_vec *)(force - w->force_from * sizeof(dem_vec));
    memcpy(w->next, w->slot, sim->def.n_walls * sizeof *w->next);
    sim->walls.next = w->next;
    sim->walls.force = w->wall_force;
}

static rp_status take_forces(dem_sim *sim, dem_part *part)
{
    const size_t n = part->grain_end - part->grain;
    dem_sim own = *sim;
    dem_threads_enter(&own, part);
    if (sim->grains.force_torque) {
        memcpy(own.grains.force_torque + part->grain, sim->grains.force_torque + part->grain,
               n * sizeof *sim->grains.force_torque);
        memset(sim->grains.force_torque + part->grain, 0, n * sizeof *sim->grains.force_torque);
    } else {
        memcpy(own.grains.force + part->grain, sim->grains.force + part->grain,
               n * sizeof *sim->grains.force);
        memset(sim->grains.force + part->grain, 0, n * sizeof *sim->grains.force);
    }
    return RP_OK;
}

rp_status dem_threads_divide(dem_sim *sim)
{
    if (!dem_threads_divided(sim)) return RP_OK;
    RP_TRY(set_bounds(sim));
    RP_TRY(dem_threads_do(sim, find_border));
    RP_TRY(dem_threads_do(sim, plan));
    return dem_threads_do(sim, take_forces);
}

/* They touch or not as in their own part, which reports an overlap that is too deep. */
void dem_threads_copies(dem_sim *sim, const dem_pairs *copies)
{
    const bool too_deep = sim->too_deep;
    const dem_pairs all = sim->pairs;
    if (copies->n == 0) return;
    sim->pairs = *copies;
    sim->loops.pairs(sim, 0, copies->n, sim->def.dt);
    sim->pairs = all;
    sim->too_deep = too_deep;
}
