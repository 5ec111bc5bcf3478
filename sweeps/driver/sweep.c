/* The folder of a sweep: making it, running it, asking it; one run of a sweep again. */
#include "sweeps/driver/private.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/table.h"

/* One process at a time changes a sweep. The lock goes with the process, whatever ends it. */
static rp_status take_lock(const char *dir, int *lock)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/lock", dir);
    *lock = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (*lock < 0 && errno == ENOENT)
        return rp_fail(RP_BAD_INPUT, "%s: no such folder; `repose sweep plan` makes it", dir);
    if (*lock < 0) return rp_fail(RP_IO, "%s: cannot write: %s", path, strerror(errno));
    if (flock(*lock, LOCK_EX | LOCK_NB) == 0) return RP_OK;
    return errno == EWOULDBLOCK ? rp_fail(RP_IO, "%s: another process runs or plans this sweep", dir)
                                : rp_fail(RP_IO, "%s: cannot lock: %s", path, strerror(errno));
}

rp_status sweep_folder_open(const char *dir, const sweep_protocol *const *protocols, bool write,
                            sweep_folder *folder)
{
    char path[4096], text[32];
    *folder = (sweep_folder){.lock = -1};
    snprintf(path, sizeof path, "%s/sweep.cfg", dir);
    rp_status status = write ? take_lock(dir, &folder->lock) : RP_OK;
    if (!status) status = sweep_plan_read(path, protocols, &folder->plan);
    if (!status) status = sweep_store_open(dir, write ? SWEEP_STORE_WRITE : SWEEP_STORE_READ, &folder->store);
    if (!status) status = sweep_store_note(folder->store, "replicas", text, sizeof text);
    const size_t replicas = status ? 0 : strtoul(text, NULL, 10);
    if (replicas > 0 && replicas != folder->plan.replicas)
        status = sweep_plan_replicate(&folder->plan, replicas);
    return status ? status : sweep_store_check_plan(folder->store, &folder->plan);
}

void sweep_folder_close(sweep_folder *folder)
{
    sweep_store_close(folder->store);
    sweep_plan_free(&folder->plan);
    if (folder->lock >= 0) close(folder->lock);
}

rp_status sweep_check_output(const char *dir, const char *path)
{
    static const char *const names[] = {
        "store.sqlite", "store.sqlite-journal", "store.sqlite-wal", "store.sqlite-shm", "sweep.cfg", "lock"};
    char own[4096];
    struct stat a, b;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        snprintf(own, sizeof own, "%s/%s", dir, names[i]);
        if (stat(own, &a) == 0 && stat(path, &b) == 0 && a.st_dev == b.st_dev && a.st_ino == b.st_ino)
            return rp_fail(RP_BAD_INPUT, "%s: is the sweep's own %s; give another file", path, names[i]);
    }
    return RP_OK;
}

rp_status sweep_prepare(const char *file, const char *dir, size_t replicas,
                        const sweep_protocol *const *protocols, sweep_counts *counts)
{
    sweep_folder f = {.lock = -1};
    char path[4096];
    FILE *out = NULL;
    rp_status status = sweep_plan_read(file, protocols, &f.plan);
    if (!status && replicas > 0) status = sweep_plan_replicate(&f.plan, replicas);
    if (!status) status = rp_make_directory(dir);
    if (!status) status = take_lock(dir, &f.lock);
    if (!status) status = sweep_store_open(dir, SWEEP_STORE_CREATE, &f.store);
    if (!status) status = sweep_store_write_plan(f.store, &f.plan, file);
    snprintf(path, sizeof path, "%s/sweep.cfg", dir);
    if (!status) status = rp_file_open(path, &out);
    if (!status) {
        fputs(f.plan.text, out);
        status = rp_file_close(path, out, RP_OK);
    }
    if (!status) status = sweep_store_count(f.store, &f.plan, counts);
    sweep_folder_close(&f);
    return status;
}

rp_status sweep_run(const char *dir, const sweep_protocol *const *protocols, const sweep_options *options,
                    sweep_counts *counts)
{
    sweep_folder f;
    size_t *todo = NULL, n = 0;
    if (options->workers < 1)
        return rp_fail(RP_BAD_INPUT, "workers = %d: out of range, allowed: [1, inf)", options->workers);
    rp_status status = sweep_folder_open(dir, protocols, true, &f);
    if (!status) status = sweep_store_missing(f.store, &f.plan, &todo, &n);
    if (!status) status = sweep_store_count(f.store, &f.plan, counts);
    if (!status && n > 0) status = sweep_pool_run(&f.plan, f.store, todo, n, f.lock, options, counts);
    if (!status) status = sweep_store_count(f.store, &f.plan, counts);
    if (!status) status = sweep_check_aborted(counts);
    free(todo);
    sweep_folder_close(&f);
    return status;
}

rp_status sweep_status(const char *dir, const sweep_protocol *const *protocols, sweep_counts *counts)
{
    sweep_folder f;
    rp_status status = sweep_folder_open(dir, protocols, false, &f);
    if (!status) status = sweep_store_count(f.store, &f.plan, counts);
    sweep_folder_close(&f);
    return status;
}

rp_status sweep_trace(const char *file, const sweep_protocol *const *protocols, size_t row,
                      const sweep_tables *tables, const sweep_protocol **protocol, sweep_result *result)
{
    sweep_plan plan;
    rp_status status = sweep_plan_read(file, protocols, &plan);
    *protocol = plan.protocol;
    if (!status && row >= plan.n_runs)
        status = rp_fail(RP_BAD_INPUT, "row = %zu: out of range, allowed: [0, %zu], the runs of %s", row,
                         plan.n_runs - 1, file);
    if (!status)
        status = plan.protocol->run(sweep_plan_point(&plan, row / plan.replicas), plan.seed,
                                    sweep_plan_pile(&plan, row), tables, result);
    sweep_plan_free(&plan);
    return status;
}
