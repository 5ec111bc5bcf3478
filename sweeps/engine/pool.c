/* The pool: worker processes, forked once, each with a socket on which the parent sends runs to make and the
 * worker sends back records. The parent is the only one that writes. Determinism: a run depends on its
 * parameters, the seed and its pile only, never on the worker or the order.
 *
 * Runs of less than a few milliseconds are handed out in batches, so that a worker does not wait for the
 * parent between them; each comes back by itself.
 *
 * A worker that dies is replaced, and its run goes to the end of the queue. After three tries, or at once
 * beyond a limit, the run is aborted: a row that says why.
 *
 * A stop signal asks the workers to write a snapshot of their runs and end; a second one, or ten seconds, end
 * them. */
#include "core/clock.h"
#include "core/file.h"
#include "table/columns.h"
#include "run/run.h"
#include "sweeps/engine/private.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MOST_TRIES = 3, BATCH = 32, LEARNT = 16 };
/* s; a batch takes less than BATCH SHORT */
static const double TICK = 0.25, GRACE = 10.0, SHORT = 3e-3;

typedef struct {
    pid_t pid;
    int socket; /* -1: no process */
    size_t runs[BATCH];
    size_t n;       /* of the runs; it is at the first */
    double elapsed; /* of the run that it is busy with, to a tick; s */
} worker;

typedef struct {
    const sweep_plan *plan;
    sweep_store *store;
    /* The queue is a ring: `waiting` runs from todo[next] on. */
    size_t *todo;
    unsigned char *tries; /* of each run: those that failed */
    size_t n_todo, next, waiting, finished;
    const sweep_options *options;
    const char *snapshots; /* folder; NULL: none */
    sweep_progress progress;
    double start, last_tick;
    double pace; /* s a run, lately */
    worker *workers;
    size_t n_workers;
    volatile bool *stop; /* shared with the workers */
    int signals;         /* descriptor on which stop signals arrive */
} pool;

/* The file from which a run resumes after its worker has died; it stays until the row is stored. */
static void snapshot_of(const pool *p, size_t run, char key[33], char path[4096])
{
    sweep_plan_key(p->plan, run, key);
    snprintf(path, 4096, "%s/%s", p->snapshots, key);
}

/* A stored run needs no snapshot, once its row is committed. */
static rp_status remove_snapshot(const pool *p, size_t run)
{
    char key[33], path[4096];
    snapshot_of(p, run, key, path);
    if (!rp_is_there(path)) return RP_OK;
    RP_TRY(sweep_store_commit(p->store));
    run_forget(path);
    return RP_OK;
}

/* Make a run, from its snapshot if there is one; a snapshot that is refused is named in the row. */
static rp_status make(const pool *p, size_t run, sweep_result *result)
{
    char key[33], path[4096], owner[40], why[sizeof result->message] = "";
    const sweep_tables kept = {.snapshot = path,
                               .owner = owner,
                               .interval = p->options->snapshot,
                               .stop = p->stop,
                               .why = why,
                               .size = sizeof why};
    if (p->snapshots) snapshot_of(p, run, key, path);
    if (p->snapshots) /* with other measures it keeps other samples */
        snprintf(owner, sizeof owner, "%s %06x", key,
                 (unsigned)(sweep_outputs_hash(p->plan->protocol->outputs) & 0xffffff));
    const rp_status status = sweep_plan_run(p->plan, run, p->snapshots ? &kept : NULL, result);
    if (!*result->message) snprintf(result->message, sizeof result->message, "%s", why);
    return status;
}

/* At most `mb` more than this process has already. What is beyond is refused, and the run fails. */
static void limit_memory(double mb)
{
    double pages = 0.0;
    FILE *in = fopen("/proc/self/statm", "r");
    if (in) {
        (void)!fscanf(in, "%*s %*s %*s %*s %*s %lf", &pages);
        fclose(in);
    }
    const rlim_t most = (rlim_t)(pages * (double)sysconf(_SC_PAGESIZE) + 1e6 * mb);
    setrlimit(RLIMIT_DATA, &(struct rlimit){most, most});
}

/* Make a run and give its row back; false if that is this worker's end. */
static bool make_row(const pool *p, size_t run, int socket)
{
    sweep_row row = {.run = run};
    const double start = rp_clock();
    sweep_result_clear(&row.result);
    row.status = make(p, run, &row.result);
    row.seconds = rp_clock() - start;
    if (row.status == RP_STOPPED) return false;
    if (row.status) snprintf(row.result.message, sizeof row.result.message, "%s", rp_message());
    return send(socket, &row, sizeof row, MSG_NOSIGNAL) == (ssize_t)sizeof row && !*p->stop;
}

/* The life of a worker. It ends when the parent does. */
static void work(const pool *p, int socket)
{
    size_t runs[BATCH];
    ssize_t n;
    bool goes_on = true;
    if (isnormal(p->options->memory)) limit_memory(p->options->memory);
    while (goes_on && (n = recv(socket, runs, sizeof runs, 0)) > 0)
        for (size_t i = 0; goes_on && i < (size_t)n / sizeof *runs; i++)
            goes_on = make_row(p, runs[i], socket);
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

/* Give an idle worker a run, or a batch of short ones: at most its share of what is left. */
static rp_status hand_out(pool *p, worker *w)
{
    const size_t share = p->waiting / p->n_workers,
                 most = p->finished < LEARNT || p->pace > SHORT || share < 1 ? 1
                        : share < BATCH                                      ? share
                                                                             : BATCH;
    if (w->n > 0 || p->waiting == 0) return RP_OK;
    if (w->socket < 0) RP_TRY(start_worker(p, w));
    while (w->n < most && p->waiting > 0) {
        w->runs[w->n++] = p->todo[p->next];
        p->next = (p->next + 1) % p->n_todo;
        p->waiting--;
    }
    w->elapsed = 0.0;
    /* a dead worker is noticed by its closed socket */
    if (send(w->socket, w->runs, w->n * sizeof *w->runs, MSG_NOSIGNAL) < 0 && errno != EPIPE &&
        errno != ECONNRESET)
        return rp_fail(RP_IO, "cannot hand out run %zu: %s", w->runs[0], strerror(errno));
    return RP_OK;
}

static void show(pool *p)
{
    if (!p->options->watch) return;
    p->progress.elapsed = rp_clock() - p->start;
    p->progress.left =
        p->finished ? p->progress.elapsed * (double)(p->n_todo - p->finished) / (double)p->finished : NAN;
    p->options->watch(&p->progress, p->options->context);
}

static rp_status store_row(pool *p, const sweep_row *row)
{
    RP_TRY(sweep_store_insert(p->store, p->plan, row));
    p->finished++;
    p->pace += (row->seconds - p->pace) / LEARNT;
    p->progress.stored++;
    if (!rp_is_result(row->result.status)) p->progress.failed++;
    show(p);
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

static void put_back(pool *p, size_t run)
{
    p->todo[(p->next + p->waiting++) % p->n_todo] = run;
}

/* A run failed, and not because of its physics: its worker is ended, and the run is tried again after all
 * others, or stored as `word`. So are the other runs of its batch. */
static rp_status give_up(pool *p, worker *w, const char *word, const char *cause)
{
    const size_t run = w->runs[0];
    const bool again = strcmp(word, "crashed") == 0 && ++p->tries[run] < MOST_TRIES;
    char name[320];
    sweep_row row = {.run = run, .seconds = w->elapsed};
    if (w->socket >= 0) end_worker(w);
    for (size_t i = 1; i < w->n; i++) put_back(p, w->runs[i]);
    w->n = 0;
    if (p->options->report)
        p->options->report(p->options->context, "%s: %s; %s", name_run(p, run, name, sizeof name), cause,
                           again ? "goes to the end of the queue" : word);
    if (again) return put_back(p, run), RP_OK;
    sweep_result_clear(&row.result);
    sweep_conclude(&row.result, word, "%s", cause);
    return store_row(p, &row);
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

/* One row has come back. */
static rp_status take_row(pool *p, worker *w, sweep_row *row)
{
    char name[320];
    if (row->status == RP_NO_MEMORY) {
        end_worker(w); /* which may be at the next run */
        return give_up(p, w, "no_memory", row->result.message);
    }
    memmove(w->runs, w->runs + 1, --w->n * sizeof *w->runs);
    w->elapsed = 0.0;
    if (row->status)
        return rp_fail(row->status, "%s: %s", name_run(p, row->run, name, sizeof name), row->result.message);
    RP_TRY(store_row(p, row));
    return p->snapshots ? remove_snapshot(p, row->run) : RP_OK;
}

/* A busy worker has spoken or died: store its runs. */
static rp_status collect(pool *p, worker *w)
{
    sweep_row row;
    ssize_t bytes = 1;
    while (w->n > 0 && (bytes = recv(w->socket, &row, sizeof row, MSG_DONTWAIT)) > 0)
        RP_TRY(take_row(p, w, &row));
    if (bytes > 0 || (bytes < 0 && errno == EAGAIN)) return RP_OK;
    if (!*p->stop) return crashed(p, w);
    end_worker(w);
    w->n = 0;
    return RP_OK;
}

/* End runs beyond the limit of time. Time in which this process was stopped itself does not count. */
static rp_status look_after(pool *p)
{
    const double now = rp_clock(), passed = fmin(now - p->last_tick, 4.0 * TICK);
    rp_status status = RP_OK;
    char cause[128];
    if (passed < TICK) return RP_OK;
    p->last_tick = now;
    for (worker *w = p->workers; !status && w < p->workers + p->n_workers; w++) {
        if (w->n == 0) continue;
        w->elapsed += passed;
        if (!(p->options->time > 0.0 && w->elapsed > p->options->time)) continue;
        snprintf(cause, sizeof cause, "ended after %.3g s, the limit of time is %g s", w->elapsed,
                 p->options->time);
        status = give_up(p, w, "time_limit", cause);
    }
    return status;
}

/* Wait for workers or a stop signal, and take in what arrived. *signals: how many came. */
static rp_status serve(pool *p, struct pollfd *polled, int *signals)
{
    struct signalfd_siginfo seen;
    for (size_t i = 0; i < p->n_workers; i++)
        polled[i] = (struct pollfd){.fd = p->workers[i].n > 0 ? p->workers[i].socket : -1, .events = POLLIN};
    polled[p->n_workers] = (struct pollfd){.fd = p->signals, .events = POLLIN};
    if (poll(polled, p->n_workers + 1, (int)(1000.0 * TICK)) < 0 && errno != EINTR)
        return rp_fail(RP_IO, "cannot wait for the workers: %s", strerror(errno));
    rp_status status = sweep_store_tick(p->store);
    while (!status && read(p->signals, &seen, sizeof seen) > 0) ++*signals;
    for (size_t i = 0; !status && i < p->n_workers; i++)
        if (polled[i].revents) status = collect(p, &p->workers[i]);
    return status;
}

static bool is_busy(const pool *p)
{
    for (size_t i = 0; i < p->n_workers; i++)
        if (p->workers[i].n > 0) return true;
    return false;
}

/* Let the workers end by themselves: a run that is nearly done with its row, a long one with a snapshot. */
static rp_status stop(pool *p, struct pollfd *polled, int signals)
{
    const double begin = rp_clock();
    rp_status status = RP_OK;
    *p->stop = true;
    while (!status && signals < 2 && is_busy(p) && rp_clock() - begin < GRACE)
        status = serve(p, polled, &signals);
    return status || p->finished == p->n_todo
               ? status
               : rp_fail(RP_STOPPED, "stopped: %zu of %zu stored; run again to resume", p->progress.stored,
                         p->progress.planned);
}

static rp_status run_all(pool *p)
{
    struct pollfd *polled = calloc(p->n_workers + 1, sizeof *polled);
    int signals = 0;
    p->workers = calloc(p->n_workers, sizeof *p->workers);
    p->stop = mmap(NULL, sizeof *p->stop, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    rp_status status = polled && p->workers && p->stop != MAP_FAILED
                           ? RP_OK
                           : rp_fail(RP_NO_MEMORY, "workers: out of memory");
    for (size_t i = 0; p->workers && i < p->n_workers; i++) p->workers[i].socket = -1;
    show(p);
    while (!status && p->finished < p->n_todo) {
        for (size_t i = 0; !status && i < p->n_workers; i++) status = hand_out(p, &p->workers[i]);
        if (!status) status = serve(p, polled, &signals);
        if (!status) status = signals ? stop(p, polled, signals) : look_after(p);
        show(p);
    }
    for (size_t i = 0; p->workers && i < p->n_workers; i++)
        if (p->workers[i].socket >= 0) end_worker(&p->workers[i]);
    if (p->stop != MAP_FAILED) munmap((void *)p->stop, sizeof *p->stop);
    free(p->workers);
    free(polled);
    return status;
}

rp_status sweep_pool_run(const sweep_folder *folder, size_t todo[], size_t n, const sweep_options *options,
                         const sweep_counts *counts)
{
    pool p = {.plan = &folder->plan,
              .store = folder->store,
              .todo = todo,
              .tries = calloc(folder->plan.n_runs, 1),
              .n_todo = n,
              .waiting = n,
              .options = options,
              .snapshots = isnormal(options->snapshot) ? folder->snapshots : NULL,
              .start = rp_clock()};
    p.last_tick = p.start;
    if (!p.tries) return rp_fail(RP_NO_MEMORY, "workers: out of memory");
    p.progress = (sweep_progress){counts->planned, counts->stored, counts->failed, 0.0, NAN};
    p.n_workers = (size_t)options->workers < n ? (size_t)options->workers : n;
    sigset_t stops, before;
    struct sigaction now;
    sigemptyset(&stops);
    sigaddset(&stops, SIGINT);
    sigaddset(&stops, SIGTERM);
    if (sigaction(SIGHUP, NULL, &now) == 0 && now.sa_handler != SIG_IGN)
        sigaddset(&stops, SIGHUP); /* nohup */
    sigprocmask(SIG_BLOCK, &stops, &before);
    p.signals = signalfd(-1, &stops, SFD_CLOEXEC | SFD_NONBLOCK);
    rp_status status =
        p.signals >= 0 ? run_all(&p) : rp_fail(RP_IO, "cannot receive signals: %s", strerror(errno));
    struct signalfd_siginfo seen; /* those that are answered must not strike when they are let through */
    while (p.signals >= 0 && read(p.signals, &seen, sizeof seen) > 0) continue;
    close(p.signals);
    sigprocmask(SIG_SETMASK, &before, NULL);
    free(p.tries);
    return status;
}

size_t sweep_count_aborted(const sweep_counts *counts)
{
    size_t n = 0;
    for (size_t i = 0; i < counts->words.n; i++)
        if (sweep_is_aborted(counts->words.of[i].word)) n += (size_t)counts->words.of[i].times;
    return n;
}

bool sweep_is_failed(const char *status)
{
    return !rp_is_result(status);
}

const char *sweep_words(const rp_tally *words, bool (*wanted)(const char *status), char text[1024])
{
    *text = '\0';
    for (size_t i = 0, used = 0; i < words->n; i++)
        if (wanted(words->of[i].word))
            used += (size_t)snprintf(text + used, 1024 - used, "%s%s %.0f", used ? ", " : "",
                                     words->of[i].word, words->of[i].times);
    return text;
}

rp_status sweep_check_aborted(const sweep_counts *counts)
{
    char text[1024];
    const size_t n = sweep_count_aborted(counts);
    return n == 0 ? RP_OK
                  : rp_fail(RP_NO_RESULT, "%zu of %zu runs were aborted (%s); the same command retries them",
                            n, counts->planned, sweep_words(&counts->words, sweep_is_aborted, text));
}

rp_status sweep_check_whole(const char *dir, const sweep_counts *counts)
{
    if (counts->stored < counts->planned)
        return rp_fail(RP_NO_RESULT, "%s: %zu of %zu runs are missing", dir, counts->planned - counts->stored,
                       counts->planned);
    return rp_prefix(sweep_check_aborted(counts), "%s: ", dir);
}
