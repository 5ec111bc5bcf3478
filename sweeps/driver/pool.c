/* The pool: worker processes, forked once, each with a socket on which the parent sends the number of a run
 * and the worker sends back one record. The parent is the only one that writes. Determinism: a run depends
 * on its parameters, the seed and its pile only, never on the worker or the order.
 *
 * A worker that dies, or that has used no processor time for a minute, is replaced, and its run goes to the
 * end of the queue. After three tries, or at once beyond a limit, the run is aborted: a row that says why. */
#include "core/clock.h"
#include "core/table.h"
#include "sweeps/driver/keep.h"
#include "sweeps/driver/private.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MOST_TRIES = 3 };
static const double TICK = 0.25, PATIENCE = 60.0; /* s */

typedef struct {
    pid_t pid;
    int socket; /* -1: no process */
    bool busy;
    size_t run;            /* that it is busy with */
    unsigned char tries;   /* of this run, that failed */
    double start, elapsed; /* of the run; s */
    double cpu, idle;      /* processor time so far, and since when it has been the same; s */
} worker;

typedef struct {
    const sweep_plan *plan;
    sweep_store *store;
    /* The queue is a ring: `waiting` runs from todo[next] on, and the tries of each that failed. */
    size_t *todo;
    unsigned char *tries;
    size_t n_todo, next, waiting, finished;
    bool careful; /* after a drive that failed, each row is committed by itself */
    const sweep_options *options;
    sweep_progress progress;
    double start, last_tick;
    worker *workers;
    size_t n_workers;
    int signals; /* descriptor on which stop signals arrive */
} pool;

/* The file that a run goes on from after its worker has died; it stays until the row is stored. */
static void snapshot_of(const pool *p, size_t run, char key[33], char path[4096])
{
    sweep_plan_key(p->plan, run, key);
    snprintf(path, 4096, "%s/%s", p->options->snapshots, key);
}

/* A stored run needs no snapshot, once its row is committed. */
static rp_status remove_snapshot(const pool *p, size_t run)
{
    char key[33], path[4096];
    snapshot_of(p, run, key, path);
    if (access(path, F_OK) != 0) return RP_OK;
    rp_status status = sweep_store_commit(p->store);
    if (!status) sweep_keep_remove(path);
    return status;
}

/* Make a run, from its snapshot if there is one; a snapshot that is refused is named in the row. */
static rp_status make(const pool *p, size_t run, sweep_result *result)
{
    const sweep_plan *plan = p->plan;
    char key[33], path[4096], why[sizeof result->message] = "";
    sweep_keep keep;
    const sweep_tables kept = {.keep = &keep};
    const bool keeps = p->options->snapshots != NULL;
    if (keeps) {
        snapshot_of(p, run, key, path);
        sweep_keep_begin(&keep, path, key, p->options->snapshot, why, sizeof why);
    }
    const sweep_stream stream = sweep_plan_stream(plan, run);
    rp_status status = plan->protocol->run(sweep_plan_point(plan, run / plan->replicas), stream.seed,
                                           stream.run, keeps ? &kept : NULL, result);
    if (keeps) sweep_keep_end(&keep, false);
    if (!*result->message) snprintf(result->message, sizeof result->message, "%s", why);
    return status;
}

/* At most `mb` more than this process has already. What is beyond is refused, and the run fails. */
static void limit_memory(double mb)
{
    double pages = 0.0;
    FILE *in = fopen("/proc/self/statm", "r");
    if (in && fscanf(in, "%*s %*s %*s %*s %*s %lf", &pages) != 1) pages = 0.0;
    if (in) fclose(in);
    const rlim_t most = (rlim_t)(pages * (double)sysconf(_SC_PAGESIZE) + 1e6 * mb);
    setrlimit(RLIMIT_DATA, &(struct rlimit){most, most});
}

/* The life of a worker. It ends when the parent does. */
static void work(const pool *p, int socket)
{
    if (p->options->memory > 0.0 && isfinite(p->options->memory)) limit_memory(p->options->memory);
    for (size_t run; recv(socket, &run, sizeof run, 0) == sizeof run;) {
        sweep_row row = {.run = run};
        sweep_result_clear(&row.result);
        double start = rp_clock();
        row.status = make(p, run, &row.result);
        row.seconds = rp_clock() - start;
        if (row.status) snprintf(row.result.message, sizeof row.result.message, "%s", rp_message());
        if (send(socket, &row, sizeof row, MSG_NOSIGNAL) != sizeof row) break;
    }
    _exit(0);
}

/* Workers keep the stop signals blocked: the parent decides, also when a terminal signals all of them. */
static rp_status start_worker(const pool *p, worker *w)
{
    int pair[2];
    pid_t parent = getpid();
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair) != 0)
        return rp_fail(RP_IO, "cannot start a worker: %s", strerror(errno));
    w->pid = fork();
    if (w->pid == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (getppid() != parent) _exit(0);
        /* the lock, the store and the others' sockets are none of its business */
        if (pair[1] > 3) close_range(3, (unsigned)pair[1] - 1, 0);
        close_range((unsigned)pair[1] + 1, ~0u, 0);
        work(p, pair[1]);
    }
    int why = errno;
    close(pair[1]);
    if (w->pid < 0) {
        close(pair[0]);
        return rp_fail(RP_IO, "cannot start a worker: %s", strerror(why));
    }
    *w = (worker){.pid = w->pid, .socket = pair[0]};
    return RP_OK;
}

/* End a worker; returns its wait status. */
static int end_worker(worker *w)
{
    int wait_status = 0;
    close(w->socket);
    w->socket = -1;
    kill(w->pid, SIGKILL); /* too late for one that is dying already: its own end is what is reported */
    while (waitpid(w->pid, &wait_status, 0) < 0 && errno == EINTR) continue;
    return wait_status;
}

static rp_status hand_out(pool *p, worker *w)
{
    if (w->busy || p->waiting == 0) return RP_OK;
    w->run = p->todo[p->next];
    w->tries = p->tries[p->next];
    w->start = rp_clock();
    w->elapsed = w->idle = 0.0;
    w->busy = true;
    p->next = (p->next + 1) % p->n_todo;
    p->waiting--;
    /* a dead worker is noticed by its closed socket */
    if (send(w->socket, &w->run, sizeof w->run, MSG_NOSIGNAL) < 0 && errno != EPIPE && errno != ECONNRESET)
        return rp_fail(RP_IO, "cannot hand out run %zu: %s", w->run, strerror(errno));
    return RP_OK;
}

static rp_status store_row(pool *p, const sweep_row *row)
{
    rp_status status = sweep_store_insert(p->store, p->plan, row);
    if (!status && p->careful) status = sweep_store_commit(p->store);
    if (status) return status;
    p->finished++;
    p->progress.stored++;
    if (!sweep_is_result(row->result.status)) p->progress.failed++;
    return RP_OK;
}

/* "run 7 (mu = 0.2)" */
static const char *name_run(const pool *p, size_t run, char *buffer, size_t size)
{
    char where[256];
    snprintf(buffer, size, "run %zu (%s)", run,
             sweep_plan_describe(p->plan, run / p->plan->replicas, where, sizeof where));
    return buffer;
}

/* A run failed, and by no fault of physics: its worker is replaced, and the run is tried again after all
 * others, or stored as `word`. */
static rp_status give_up(pool *p, worker *w, const char *word, const char *cause)
{
    const bool again = strcmp(word, "crashed") == 0 && w->tries + 1 < MOST_TRIES;
    char name[320];
    sweep_row row = {.run = w->run, .seconds = w->elapsed};
    if (w->socket >= 0) end_worker(w);
    w->busy = false;
    if (p->options->report)
        p->options->report(p->options->context, "%s: %s; %s", name_run(p, w->run, name, sizeof name), cause,
                           again ? "goes to the end of the queue" : word);
    rp_status status = RP_OK;
    if (again) {
        const size_t end = (p->next + p->waiting++) % p->n_todo;
        p->todo[end] = w->run;
        p->tries[end] = w->tries + 1;
    } else {
        sweep_result_clear(&row.result);
        sweep_conclude(&row.result, word, "%s", cause);
        status = store_row(p, &row);
    }
    return status || p->waiting == 0 ? status : start_worker(p, w);
}

static rp_status crashed(pool *p, worker *w)
{
    char cause[128];
    const int end = end_worker(w);
    if (WIFSIGNALED(end))
        snprintf(cause, sizeof cause, "worker ended by signal %d (%s)", WTERMSIG(end),
                 strsignal(WTERMSIG(end)));
    else
        snprintf(cause, sizeof cause, "worker ended with exit status %d", WEXITSTATUS(end));
    return give_up(p, w, "crashed", cause);
}

/* A busy worker has spoken or died: store the run. */
static rp_status collect(pool *p, worker *w)
{
    sweep_row row;
    char name[320];
    w->elapsed = rp_clock() - w->start;
    if (recv(w->socket, &row, sizeof row, 0) != sizeof row) return crashed(p, w);
    if (row.status == RP_NO_MEMORY) return give_up(p, w, "no_memory", row.result.message);
    w->busy = false;
    if (row.status)
        return rp_fail(row.status, "%s: %s", name_run(p, row.run, name, sizeof name), row.result.message);
    rp_status status = store_row(p, &row);
    return status || !p->options->snapshots ? status : remove_snapshot(p, row.run);
}

/* Time that a process has had on a processor, s. */
static double cpu_time(pid_t pid)
{
    clockid_t clock;
    struct timespec t = {0};
    if (clock_getcpuclockid(pid, &clock) == 0) clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* End runs beyond the limit of time, and workers that no longer get on: stopped, or waiting for what never
 * comes. Time in which this process was stopped itself does not count. */
static rp_status look_after(pool *p)
{
    const double now = rp_clock(), passed = fmin(now - p->last_tick, 4.0 * TICK);
    const double patience = p->options->patience > 0.0 ? p->options->patience : PATIENCE;
    rp_status status = RP_OK;
    char cause[128];
    if (passed < TICK) return RP_OK;
    p->last_tick = now;
    for (worker *w = p->workers; !status && w < p->workers + p->n_workers; w++) {
        if (!w->busy) continue;
        const double cpu = cpu_time(w->pid);
        w->idle = cpu > w->cpu ? 0.0 : w->idle + passed;
        w->cpu = cpu;
        w->elapsed += fmin(passed, now - w->start);
        if (p->options->time > 0.0 && w->elapsed > p->options->time) {
            snprintf(cause, sizeof cause, "ended after %.3g s, the limit of time is %g s", w->elapsed,
                     p->options->time);
            status = give_up(p, w, "time_limit", cause);
        } else if (w->idle > patience) {
            snprintf(cause, sizeof cause, "worker without progress for %.3g s", w->idle);
            status = give_up(p, w, "crashed", cause);
        }
    }
    return status;
}

static void show(pool *p)
{
    if (!p->options->watch) return;
    p->progress.elapsed = rp_clock() - p->start;
    p->progress.left =
        p->finished ? p->progress.elapsed * (double)(p->n_todo - p->finished) / (double)p->finished : NAN;
    p->options->watch(&p->progress, p->options->context);
}

/* Wait for workers or a stop signal, and take in what arrived. */
static rp_status serve(pool *p, struct pollfd *polled)
{
    for (size_t i = 0; i < p->n_workers; i++)
        polled[i] = (struct pollfd){.fd = p->workers[i].busy ? p->workers[i].socket : -1, .events = POLLIN};
    polled[p->n_workers] = (struct pollfd){.fd = p->signals, .events = POLLIN};
    if (poll(polled, p->n_workers + 1, (int)(1000.0 * TICK)) < 0 && errno != EINTR)
        return rp_fail(RP_IO, "cannot wait for the workers: %s", strerror(errno));
    rp_status written = sweep_store_tick(p->store);
    if (written) return written;
    if (polled[p->n_workers].revents)
        return rp_fail(RP_STOPPED, "stopped: %zu of %zu stored; run again to resume", p->progress.stored,
                       p->progress.planned);
    rp_status status = RP_OK;
    for (size_t i = 0; !status && i < p->n_workers; i++)
        if (polled[i].revents) status = collect(p, &p->workers[i]);
    return status ? status : look_after(p);
}

static rp_status run_all(pool *p)
{
    struct pollfd *polled = calloc(p->n_workers + 1, sizeof *polled);
    p->workers = calloc(p->n_workers, sizeof *p->workers);
    p->tries = calloc(p->n_todo, sizeof *p->tries);
    rp_status status =
        polled && p->workers && p->tries ? RP_OK : rp_fail(RP_NO_MEMORY, "workers: out of memory");
    for (size_t i = 0; p->workers && i < p->n_workers; i++) p->workers[i].socket = -1;
    for (size_t i = 0; !status && i < p->n_workers; i++) status = start_worker(p, &p->workers[i]);
    show(p);
    while (!status && p->finished < p->n_todo) {
        for (size_t i = 0; !status && i < p->n_workers; i++) status = hand_out(p, &p->workers[i]);
        if (!status) status = serve(p, polled);
        show(p);
    }
    for (size_t i = 0; p->workers && i < p->n_workers; i++)
        if (p->workers[i].socket >= 0) end_worker(&p->workers[i]);
    free(p->workers);
    free(p->tries);
    free(polled);
    return status;
}

/* Where the queue starts. After a drive that failed it is elsewhere, so that one run that always ends the
 * drive does not keep the others from being made: the lock file counts drives without an orderly end. */
static void begin_drive(pool *p, int lock)
{
    unsigned char failed = 0;
    if (pread(lock, &failed, 1, 0) < 1) failed = 0;
    const unsigned char next = (unsigned char)(failed + 1);
    p->careful = failed > 0;
    if (pwrite(lock, &next, 1, 0) == 1) /* else, as on a full disk, in order */
        p->next = (size_t)(fmod(0.618 * failed, 1.0) * (double)p->n_todo);
}

static void end_drive(int lock, rp_status status)
{
    if (!status || status == RP_STOPPED) (void)!ftruncate(lock, 0);
}

rp_status sweep_pool_run(const sweep_plan *plan, sweep_store *store, size_t *todo, size_t n, int lock,
                         const sweep_options *options, const sweep_counts *counts)
{
    pool p = {.plan = plan,
              .store = store,
              .todo = todo,
              .n_todo = n,
              .waiting = n,
              .options = options,
              .start = rp_clock()};
    p.last_tick = p.start;
    begin_drive(&p, lock);
    p.progress = (sweep_progress){counts->planned, counts->stored, counts->failed, 0.0, NAN};
    p.n_workers = (size_t)options->workers < n ? (size_t)options->workers : n;
    sigset_t stops, before;
    sigemptyset(&stops);
    sigaddset(&stops, SIGINT);
    sigaddset(&stops, SIGTERM);
    sigaddset(&stops, SIGHUP);
    sigprocmask(SIG_BLOCK, &stops, &before);
    p.signals = signalfd(-1, &stops, SFD_CLOEXEC | SFD_NONBLOCK);
    rp_status status =
        p.signals >= 0 ? run_all(&p) : rp_fail(RP_IO, "cannot receive signals: %s", strerror(errno));
    struct signalfd_siginfo seen; /* those that are answered must not strike when they are let through */
    while (p.signals >= 0 && read(p.signals, &seen, sizeof seen) > 0) continue;
    close(p.signals);
    sigprocmask(SIG_SETMASK, &before, NULL);
    end_drive(lock, status);
    return status;
}

static bool is_aborted(const char *status)
{
    char quoted[32];
    snprintf(quoted, sizeof quoted, "'%s'", status);
    return strstr(SWEEP_MACHINE, quoted) != NULL;
}

size_t sweep_count_aborted(const sweep_counts *counts)
{
    size_t n = 0;
    for (size_t i = 0; i < counts->n_words; i++)
        if (is_aborted(counts->words[i].status)) n += counts->words[i].runs;
    return n;
}

rp_status sweep_check_aborted(const sweep_counts *counts)
{
    const size_t n = sweep_count_aborted(counts);
    char text[128] = "";
    size_t used = 0;
    for (size_t i = 0; i < counts->n_words; i++) {
        if (!is_aborted(counts->words[i].status)) continue;
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%zu %s", used ? ", " : "",
                                 counts->words[i].runs, counts->words[i].status);
    }
    return n == 0 ? RP_OK
                  : rp_fail(RP_NO_RESULT, "%zu of %zu runs are aborted: %s; run again to try them again", n,
                            counts->planned, text);
}
