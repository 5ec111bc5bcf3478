/* The pool: worker processes, forked once, each with a socket on which the parent sends the number of a run
 * and the worker sends back one record. The parent is the only one that writes. Determinism: a run depends
 * on its parameters, the seed and its pile only, never on the worker or the order. */
#include "core/clock.h"
#include "sweeps/driver/private.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

typedef struct {
    pid_t pid;
    int socket; /* -1: no process */
    bool busy;
    size_t run; /* that it is busy with */
} worker;

typedef struct {
    const sweep_plan *plan;
    sweep_store *store;
    const size_t *todo;
    size_t n_todo, handed_out, finished;
    const sweep_options *options;
    sweep_progress progress;
    double start;
    worker *workers;
    size_t n_workers;
    int signals; /* descriptor on which stop signals arrive */
} pool;

/* The life of a worker. It ends when the parent does. */
static void work(const sweep_plan *plan, int socket)
{
    for (size_t run; recv(socket, &run, sizeof run, 0) == sizeof run;) {
        sweep_row row = {.run = run};
        sweep_result_clear(&row.result);
        double start = rp_clock();
        const sweep_stream stream = sweep_plan_stream(plan, run);
        row.status = plan->protocol->run(sweep_plan_point(plan, run / plan->replicas), stream.seed,
                                         stream.run, NULL, &row.result);
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
        work(p->plan, pair[1]);
    }
    int why = errno;
    close(pair[1]);
    if (w->pid < 0) {
        close(pair[0]);
        return rp_fail(RP_IO, "cannot start a worker: %s", strerror(why));
    }
    w->socket = pair[0];
    w->busy = false;
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

static void hand_out(pool *p, worker *w)
{
    if (w->busy || p->handed_out == p->n_todo) return;
    w->run = p->todo[p->handed_out++];
    w->busy = true;
    send(w->socket, &w->run, sizeof w->run, MSG_NOSIGNAL); /* a dead worker is noticed by its closed socket */
}

static rp_status crashed(pool *p, worker *w, sweep_row *row)
{
    *row = (sweep_row){.run = w->run, .seconds = NAN};
    sweep_result_clear(&row->result);
    int end = end_worker(w);
    if (WIFSIGNALED(end))
        sweep_conclude(&row->result, "crashed", "worker ended by signal %d (%s)", WTERMSIG(end),
                       strsignal(WTERMSIG(end)));
    else
        sweep_conclude(&row->result, "crashed", "worker ended with exit status %d", WEXITSTATUS(end));
    return p->handed_out < p->n_todo ? start_worker(p, w) : RP_OK;
}

/* A busy worker has spoken or died: store the run. */
static rp_status collect(pool *p, worker *w)
{
    sweep_row row;
    rp_status status = RP_OK;
    char where[256];
    size_t point = w->run / p->plan->replicas;
    if (recv(w->socket, &row, sizeof row, 0) != sizeof row) status = crashed(p, w, &row);
    w->busy = false;
    if (row.status)
        return rp_fail(row.status, "run %zu (%s): %s", row.run,
                       sweep_plan_describe(p->plan, point, where, sizeof where), row.result.message);
    rp_status stored = sweep_store_insert(p->store, p->plan, &row);
    if (stored) return stored;
    p->finished++;
    p->progress.stored++;
    if (!sweep_is_result(row.result.status)) p->progress.failed++;
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
    if (poll(polled, p->n_workers + 1, p->store->pending ? 250 : 1000) < 0 && errno != EINTR)
        return rp_fail(RP_IO, "cannot wait for the workers: %s", strerror(errno));
    rp_status written = sweep_store_tick(p->store);
    if (written) return written;
    if (polled[p->n_workers].revents)
        return rp_fail(RP_STOPPED, "stopped: %zu of %zu stored; run again to resume", p->progress.stored,
                       p->progress.planned);
    rp_status status = RP_OK;
    for (size_t i = 0; !status && i < p->n_workers; i++)
        if (polled[i].revents) status = collect(p, &p->workers[i]);
    return status;
}

static rp_status run_all(pool *p)
{
    struct pollfd *polled = calloc(p->n_workers + 1, sizeof *polled);
    p->workers = calloc(p->n_workers, sizeof *p->workers);
    rp_status status = polled && p->workers ? RP_OK : rp_fail(RP_NO_MEMORY, "workers: out of memory");
    for (size_t i = 0; p->workers && i < p->n_workers; i++) p->workers[i].socket = -1;
    for (size_t i = 0; !status && i < p->n_workers; i++) status = start_worker(p, &p->workers[i]);
    show(p);
    while (!status && p->finished < p->n_todo) {
        for (size_t i = 0; i < p->n_workers; i++) hand_out(p, &p->workers[i]);
        status = serve(p, polled);
        show(p);
    }
    for (size_t i = 0; p->workers && i < p->n_workers; i++)
        if (p->workers[i].socket >= 0) end_worker(&p->workers[i]);
    free(p->workers);
    free(polled);
    return status;
}

rp_status sweep_pool_run(const sweep_plan *plan, sweep_store *store, const size_t *todo, size_t n,
                         const sweep_options *options, const sweep_counts *counts)
{
    pool p = {
        .plan = plan, .store = store, .todo = todo, .n_todo = n, .options = options, .start = rp_clock()};
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
    return status;
}
