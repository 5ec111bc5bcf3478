/* The folder of a sweep: making it, running it whole or by shards, asking it; one run of a sweep again.
 *   sweep.cfg, store.sqlite, lock;  shards/3-of-8.sqlite, shards/3-of-8.sqlite.lock  */
#include "sweeps/engine/private.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/file.h"
#include "core/folder.h"
#include "sweeps/engine/keep.h"

/* One process at a time changes a store. The lock goes with the process, whatever ends it; its workers, which
 * may live on for a moment, do not inherit it. */
static rp_status take_lock(const char *path, const char *store, int *lock)
{
    struct stat info;
    *lock = open(path, O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
    if (*lock < 0 && errno == ENOENT)
        return rp_fail(RP_BAD_INPUT, "%s: no such folder; `repose sweep plan` makes it", store);
    if (*lock < 0 && errno != ELOOP) return rp_fail(RP_IO, "%s: cannot write: %s", path, strerror(errno));
    if (*lock < 0 || fstat(*lock, &info) != 0 || !S_ISREG(info.st_mode) || info.st_size > 1)
        return rp_fail(RP_BAD_INPUT, "%s: not made by this program; move it away", path);
    if (fcntl(*lock, F_SETLK, &(struct flock){.l_type = F_WRLCK, .l_whence = SEEK_SET}) == 0) return RP_OK;
    return errno == EACCES || errno == EAGAIN
               ? rp_fail(RP_IO, "%s: another process runs or plans this sweep", store)
               : rp_fail(RP_IO, "%s: cannot lock: %s", path, strerror(errno));
}

/* The names of a folder's files. Afterwards sweep_folder_close, also after an error. */
static rp_status name_files(const char *dir, sweep_folder *f)
{
    *f = (sweep_folder){.dir = dir, .lock = -1};
    RP_TRY(rp_path(&f->memory, &f->cfg, "%s/sweep.cfg", dir));
    RP_TRY(rp_path(&f->memory, &f->sqlite, "%s/store.sqlite", dir));
    RP_TRY(rp_path(&f->memory, &f->snapshots, "%s/snapshots", dir));
    return rp_path(&f->memory, &f->shards, "%s/shards", dir);
}

static rp_status lock_folder(sweep_folder *f)
{
    const char *path;
    RP_TRY(rp_path(&f->memory, &path, "%s/lock", f->dir));
    return take_lock(path, f->dir, &f->lock);
}

static bool is_shard(const char *name)
{
    return rp_ends_in(name, ".sqlite") && strstr(name, "-of-");
}

/* Add a store, or name it among those that are left out. */
static rp_status add_store(const sweep_folder *f, const char *path, rp_paths *stores)
{
    char *skipped = f->store->skipped;
    const size_t used = strlen(skipped);
    if (sweep_store_is_made(path)) return rp_paths_add(stores, NULL, path);
    snprintf(skipped + used, sizeof f->store->skipped - used, "%s%s", used ? ", " : "", path);
    return RP_OK;
}

/* Add the stores of the shards of a folder, in order. */
static rp_status find_shards(const sweep_folder *f, const char *folder, rp_paths *stores)
{
    rp_paths all = {0};
    rp_status status = rp_paths_in(&all, folder, is_shard);
    for (size_t i = 0; !status && i < all.n; i++) status = add_store(f, all.path[i], stores);
    rp_paths_free(&all);
    return status;
}

/* The sweep's files are the program's own; those of an older version, whose store says so. */
static rp_status claim(const sweep_folder *f, const char *file)
{
    static const char *const names[] = {
        "sweep.cfg",        "lock",     "store.sqlite", "store.sqlite-journal", "store.sqlite-wal",
        "store.sqlite-shm", "snapshots"};
    char before[256] = "", holds[512];
    rp_folder folder = {0};
    struct stat info;
    rp_status status = rp_make_directory(f->dir);
    if (!status) status = rp_folder_enter(f->dir, &folder);
    const bool older = !folder.marked && lstat(f->sqlite, &info) == 0 && S_ISREG(info.st_mode);
    if (!status && older) status = sweep_source(f->dir, before);
    if (!status && !folder.marked && !older) status = rp_folder_vacant(&folder, false);
    if (!status && folder.marked && !rp_folder_find(&folder, "sweep.cfg"))
        status = rp_fail(RP_BAD_INPUT, "%s: holds %s; give another folder", f->dir,
                         *folder.holds ? folder.holds : "an unfinished run");
    for (size_t i = 0; !status && i < sizeof names / sizeof *names; i++) {
        const bool snapshots = i + 1 == sizeof names / sizeof *names;
        if (snapshots && access(f->snapshots, F_OK) == 0) break; /* people's, if it was there before */
        if (!older || (i == 0 && !*before)) status = rp_folder_check(&folder, names[i]);
        if (!status) status = rp_folder_list(&folder, names[i], RP_OWN_STAYS);
    }
    snprintf(holds, sizeof holds, "the sweep %s", file);
    if (!status && strcmp(folder.holds, holds) != 0) {
        strcpy(folder.holds, holds);
        status = rp_folder_write(&folder);
    }
    rp_folder_close(&folder);
    return status;
}

static rp_status make_folder(const char *path)
{
    struct stat info;
    RP_TRY(rp_make_directory(path));
    return lstat(path, &info) == 0 && S_ISDIR(info.st_mode)
               ? RP_OK
               : rp_fail(RP_BAD_INPUT, "%s: no folder of this program, but a link; move it away", path);
}

/* Read the plan of a folder, and open its store. */
static rp_status open_main(const sweep_protocol *const *protocols, sweep_access access, sweep_folder *folder)
{
    char text[32];
    RP_TRY(sweep_plan_read(folder->cfg, protocols, &folder->plan));
    RP_TRY(sweep_store_open(folder->sqlite, access, &folder->store));
    RP_TRY(sweep_store_note(folder->store, "main", "replicas", text, sizeof text));
    const size_t replicas = strtoul(text, NULL, 10);
    if (replicas > 0 && replicas != folder->plan.replicas)
        RP_TRY(sweep_plan_replicate(&folder->plan, replicas));
    RP_TRY(sweep_store_check_plan(folder->store, &folder->plan));
    return sweep_store_check_rows(folder->store, "main", folder->sqlite, &folder->plan);
}

rp_status sweep_folder_read(const char *dir, const sweep_protocol *const *protocols, bool verify,
                            sweep_folder *folder)
{
    rp_paths shards = {0};
    RP_TRY(name_files(dir, folder));
    RP_TRY(open_main(protocols, SWEEP_READ, folder));
    rp_status status = find_shards(folder, folder->shards, &shards);
    if (!status && verify) status = sweep_store_verify(folder->store, "main", folder->store->path);
    if (!status && shards.n > 0)
        status =
            sweep_store_unite(folder->store, &folder->plan, shards.n, shards.path, verify, &folder->found);
    else if (!status) {
        status = sweep_store_freeze(folder->store);
        if (!status) status = sweep_store_running(folder->store, "main", &folder->found.running);
    }
    rp_paths_free(&shards);
    return status;
}

void sweep_folder_close(sweep_folder *folder)
{
    sweep_store_close(folder->store);
    sweep_plan_free(&folder->plan);
    if (folder->lock >= 0) close(folder->lock);
    rp_arena_release(&folder->memory, NULL);
}

rp_status sweep_source(const char *dir, char file[256])
{
    sweep_folder f;
    rp_status status = name_files(dir, &f);
    *file = '\0';
    if (!status && access(f.sqlite, F_OK) == 0) {
        status = sweep_store_open(f.sqlite, SWEEP_READ, &f.store);
        if (!status) status = sweep_store_note(f.store, "main", "file", file, 256);
    }
    sweep_folder_close(&f);
    return status;
}

rp_status sweep_check_output(const char *dir, const char *path)
{
    static const char *const names[] = {
        "store.sqlite", "store.sqlite-journal", "store.sqlite-wal", "store.sqlite-shm", "sweep.cfg", "lock"};
    rp_arena memory = {0};
    const char *own;
    struct stat a, b;
    rp_status status = RP_OK;
    for (size_t i = 0; !status && i < sizeof names / sizeof *names; i++) {
        status = rp_path(&memory, &own, "%s/%s", dir, names[i]);
        if (!status && stat(own, &a) == 0 && stat(path, &b) == 0 && a.st_dev == b.st_dev &&
            a.st_ino == b.st_ino)
            status = rp_fail(RP_BAD_INPUT, "%s: is the sweep's own %s; give another file", path, names[i]);
    }
    rp_arena_release(&memory, NULL);
    return status;
}

static rp_status check_points(const sweep_plan *plan, const char *file, const sweep_watch *watch)
{
    for (size_t i = 0; i < plan->n_points; i++) {
        RP_TRY(sweep_plan_check_point(plan, file, i));
        if (watch && watch->call) watch->call("grid points checked", i + 1, plan->n_points, watch->context);
    }
    return RP_OK;
}

rp_status sweep_prepare(const char *file, const char *dir, size_t replicas,
                        const sweep_protocol *const *protocols, const sweep_watch *watch,
                        sweep_counts *counts)
{
    sweep_folder f;
    FILE *out = NULL;
    rp_status status = name_files(dir, &f);
    if (!status) status = sweep_plan_read(file, protocols, &f.plan);
    if (!status && replicas > 0) status = sweep_plan_replicate(&f.plan, replicas);
    if (!status) status = check_points(&f.plan, file, watch);
    if (!status) status = claim(&f, file);
    if (!status) status = lock_folder(&f);
    if (!status) status = sweep_store_open(f.sqlite, SWEEP_CREATE, &f.store);
    if (!status) status = sweep_store_write_plan(f.store, &f.plan, file, watch);
    if (!status) status = rp_file_open(f.cfg, &out);
    if (!status) {
        fputs(f.plan.text, out);
        status = rp_file_close(f.cfg, out, RP_OK);
    }
    if (!status) status = sweep_store_count(f.store, &f.plan, counts);
    sweep_folder_close(&f);
    return status;
}

/* ---- running ---- */

/* Mark what a store holds of the plan, if its rows are numbered by this plan. */
static rp_status mark_store(const char *path, const sweep_plan *plan, unsigned char *done)
{
    sweep_store *store;
    char hash[33];
    rp_status status = sweep_store_open(path, SWEEP_READ, &store);
    if (!status) status = sweep_store_note(store, "main", "plan", hash, sizeof hash);
    if (!status) status = sweep_store_check_rows(store, "main", path, plan);
    if (!status && strcmp(hash, plan->hash) == 0) status = sweep_store_mark(store, plan->n_runs, done);
    sweep_store_close(store);
    return status;
}

/* Numbers of the runs of this part (0 of 1: of all) that are neither in the folder's store nor in the open
 * one; a sweep that runs whole leaves out what its shards have. free(*todo). */
static rp_status find_todo(const sweep_folder *f, const sweep_options *options, size_t **todo, size_t *n)
{
    const sweep_plan *plan = &f->plan;
    const size_t parts = options->shards > 0 ? (size_t)options->shards : 1,
                 part = options->shards > 0 ? (size_t)options->shard - 1 : 0;
    unsigned char *done = calloc(plan->n_runs / 8 + 1, 1);
    rp_paths shards = {0};
    rp_status status = done ? sweep_store_mark(f->store, plan->n_runs, done)
                            : rp_fail(RP_NO_MEMORY, "%s: out of memory", f->dir);
    if (!status && options->shards > 0) status = mark_store(f->sqlite, plan, done);
    if (!status && options->shards == 0) status = find_shards(f, f->shards, &shards);
    for (size_t i = 0; !status && i < shards.n; i++) status = mark_store(shards.path[i], plan, done);
    rp_paths_free(&shards);
    *todo = malloc((plan->n_runs / parts + 1) * sizeof **todo);
    if (!status && !*todo) status = rp_fail(RP_NO_MEMORY, "%s: out of memory", f->dir);
    *n = 0;
    for (size_t r = part; !status && r < plan->n_runs; r += parts)
        if (!(done[r / 8] >> r % 8 & 1)) (*todo)[(*n)++] = r;
    free(done);
    return status;
}

/* A shard has a store of its own, so that machines that share a folder need no lock between them. */
static rp_status open_shard(const sweep_options *options, sweep_folder *f)
{
    const char *folder, *path, *lock;
    char file[256];
    rp_status status = sweep_store_note(f->store, "main", "file", file, sizeof file);
    sweep_store_close(f->store);
    f->store = NULL;
    RP_TRY(status);
    RP_TRY(rp_path(&f->memory, &folder, "%s/shards", f->dir));
    RP_TRY(rp_path(&f->memory, &path, "%s/%d-of-%d.sqlite", folder, options->shard, options->shards));
    RP_TRY(rp_path(&f->memory, &lock, "%s.lock", path));
    RP_TRY(make_folder(folder));
    RP_TRY(take_lock(lock, path, &f->lock));
    RP_TRY(sweep_store_open(path, SWEEP_CREATE, &f->store));
    RP_TRY(sweep_store_write_plan(f->store, &f->plan, file, NULL));
    return sweep_store_check_rows(f->store, "main", path, &f->plan);
}

/* Snapshots of a sweep whose runs are all stored: a driver that was killed may have left some. Other files of
 * the folder, and then the folder, stay. */
static void remove_snapshots(const sweep_folder *f)
{
    rp_folder folder;
    rp_paths left = {0};
    rp_status status = rp_folder_open(f->snapshots, &folder);
    if (!status) status = rp_paths_in(&left, f->snapshots, sweep_keep_is_name);
    for (size_t i = 0; !status && i < left.n; i++)
        if (rp_folder_shows(&folder, basename(left.path[i]))) unlink(left.path[i]);
    rp_folder_close(&folder);
    status = rp_folder_open(f->dir, &folder);
    if (!status && rp_folder_find(&folder, "snapshots")) rmdir(f->snapshots);
    rp_folder_close(&folder);
    rp_paths_free(&left);
}

rp_status sweep_run(const char *dir, const sweep_protocol *const *protocols, const sweep_options *options,
                    sweep_counts *counts)
{
    sweep_folder f;
    size_t *todo = NULL, n = 0;
    const bool whole = options->shards == 0;
    if (options->workers < 1)
        return rp_fail(RP_BAD_INPUT, "workers = %d: out of range, allowed: [1, inf)", options->workers);
    if (!whole && (options->shard < 1 || options->shard > options->shards))
        return rp_fail(RP_BAD_INPUT, "shard = %d/%d: out of range, allowed: 1/%d to %d/%d", options->shard,
                       options->shards, options->shards, options->shards, options->shards);
    rp_status status = name_files(dir, &f);
    if (!status && whole) status = lock_folder(&f);
    if (!status) status = open_main(protocols, whole ? SWEEP_WRITE : SWEEP_READ, &f);
    if (!status && !whole) status = open_shard(options, &f);
    if (!status) status = sweep_store_drop_crashed(f.store);
    if (!status) status = find_todo(&f, options, &todo, &n);
    if (!status) status = sweep_store_count(f.store, &f.plan, counts);
    sweep_options own = *options;
    own.snapshots = isnormal(options->snapshot) ? f.snapshots : NULL;
    const size_t planned =
        whole ? f.plan.n_runs
              : (f.plan.n_runs + (size_t)(options->shards - options->shard)) / (size_t)options->shards;
    counts->planned = planned;
    counts->stored = planned - n;
    if (!status && n > 0 && own.snapshots) status = make_folder(f.snapshots);
    if (!status && n > 0) status = sweep_pool_run(&f, todo, n, &own, counts);
    if (!status) status = sweep_store_commit(f.store);
    if (!status) status = sweep_store_count(f.store, &f.plan, counts);
    if (!status && whole && sweep_count_aborted(counts) == 0) remove_snapshots(&f);
    if (!status) counts->planned = counts->stored = planned; /* some may stand in other stores */
    if (!status) status = sweep_check_aborted(counts);
    free(todo);
    sweep_folder_close(&f);
    return status;
}

/* ---- asking ---- */

/* "2,5-7 of 8": the shards that have runs to do, where the folder has shards. */
static rp_status list_shards(const sweep_folder *f, char *text, size_t size)
{
    rp_paths shards = {0};
    size_t parts = 0, used = 0;
    text[0] = '\0';
    RP_TRY(rp_paths_in(&shards, f->shards, is_shard));
    for (size_t i = 0; i < shards.n; i++) {
        const size_t n = strtoul(strstr(strrchr(shards.path[i], '/'), "-of-") + 4, NULL, 10);
        if (n > parts) parts = n;
    }
    rp_paths_free(&shards);
    unsigned char *done = calloc(f->plan.n_runs / 8 + 1, 1);
    bool *open = calloc(parts + 2, sizeof *open);
    rp_status status = done && open ? sweep_store_mark(f->store, f->plan.n_runs, done)
                                    : rp_fail(RP_NO_MEMORY, "%s: out of memory", f->dir);
    for (size_t r = 0; !status && parts > 0 && r < f->plan.n_runs; r++)
        open[r % parts] |= !(done[r / 8] >> r % 8 & 1);
    for (size_t i = 0; !status && i < parts && used < size; i++) {
        size_t last = i;
        while (open[last] && open[last + 1]) last++;
        if (open[i])
            used += (size_t)snprintf(text + used, size - used, last > i ? "%s%zu-%zu" : "%s%zu",
                                     used ? "," : "", i + 1, last + 1);
        i = last;
    }
    if (used > 0 && used < size) snprintf(text + used, size - used, " of %zu", parts);
    free(done);
    free(open);
    return status;
}

rp_status sweep_status(const char *dir, const sweep_protocol *const *protocols, sweep_counts *counts)
{
    sweep_folder f;
    rp_status status = sweep_folder_read(dir, protocols, false, &f);
    if (!status) status = sweep_store_count(f.store, &f.plan, counts);
    if (!status) status = sweep_store_pace(f.store, &counts->seconds);
    if (!status) status = list_shards(&f, counts->shards, sizeof counts->shards);
    counts->running = f.found.running;
    sweep_folder_close(&f);
    return status;
}

rp_status sweep_check_done(const char *file, const char *dir, const sweep_protocol *const *protocols)
{
    sweep_folder f;
    sweep_plan plan = {0};
    sweep_counts counts;
    rp_status status = sweep_folder_read(dir, protocols, false, &f);
    if (!status) status = sweep_plan_read(file, protocols, &plan);
    if (!status && strcmp(plan.hash, f.plan.hash) != 0)
        status =
            rp_fail(RP_BAD_INPUT, "%s: holds another plan than that of %s, and may only be read", dir, file);
    if (!status) status = sweep_store_count(f.store, &f.plan, &counts);
    if (!status) status = sweep_check_whole(dir, &counts);
    sweep_plan_free(&plan);
    sweep_folder_close(&f);
    return status;
}

rp_status sweep_merge(const char *dir, const sweep_protocol *const *protocols, size_t n, char *const paths[],
                      sweep_merged *merged, sweep_counts *counts)
{
    sweep_folder f, other;
    rp_paths sources = {0};
    rp_status status = name_files(dir, &f);
    if (!status) status = lock_folder(&f);
    if (!status) status = open_main(protocols, SWEEP_WRITE, &f);
    if (!status && n == 0) status = find_shards(&f, f.shards, &sources);
    for (size_t i = 0; !status && i < n; i++) { /* a folder stands for its store and its shards */
        struct stat info;
        const bool folder = stat(paths[i], &info) == 0 && S_ISDIR(info.st_mode);
        status = name_files(paths[i], &other);
        const char *store = folder ? other.sqlite : paths[i];
        if (!status && !folder && access(store, F_OK) != 0)
            status = rp_fail(RP_BAD_INPUT, "%s: no store", store);
        if (!status) status = folder ? add_store(&f, store, &sources) : rp_paths_add(&sources, NULL, store);
        if (!status && folder) status = find_shards(&f, other.shards, &sources);
        sweep_folder_close(&other);
    }
    if (!status && sources.n == 0)
        status = rp_fail(RP_BAD_INPUT, "%s: no shards, and no other store is named%s%s", dir,
                         *f.store->skipped ? "; none yet: " : "", f.store->skipped);
    if (!status) status = sweep_store_merge(f.store, &f.plan, sources.n, sources.path, merged);
    if (!status) status = sweep_store_count(f.store, &f.plan, counts);
    if (!status) status = list_shards(&f, counts->shards, sizeof counts->shards);
    rp_paths_free(&sources);
    sweep_folder_close(&f);
    return status;
}

rp_status sweep_salvage(const char *dir, const sweep_protocol *const *protocols, size_t *n)
{
    static const char *const ends[] = {"", "-wal", "-journal"};
    enum { N_ENDS = sizeof ends / sizeof *ends };
    struct stat info;
    sweep_folder f;
    const char *kept = NULL, *from, *to;
    *n = 0;
    rp_status status = name_files(dir, &f);
    if (!status) status = rp_path(&f.memory, &kept, "%s/damaged.sqlite", dir);
    if (!status) status = lock_folder(&f);
    if (!status) status = sweep_plan_read(f.cfg, protocols, &f.plan);
    if (!status && access(f.sqlite, F_OK) != 0) status = rp_fail(RP_BAD_INPUT, "%s: no store", f.sqlite);
    for (size_t i = 0; !status && i < 2 * N_ENDS; i++) { /* look at all, then rename all */
        status = rp_path(&f.memory, &from, "%s%s", f.sqlite, ends[i % N_ENDS]);
        if (!status) status = rp_path(&f.memory, &to, "%s%s", kept, ends[i % N_ENDS]);
        if (!status && i < N_ENDS && lstat(to, &info) == 0)
            status = rp_fail(RP_BAD_INPUT, "%s: kept of an earlier salvage; move it away first", to);
        if (!status && i >= N_ENDS && rename(from, to) != 0 && errno != ENOENT)
            status = rp_fail(RP_IO, "%s: cannot rename: %s", from, strerror(errno));
    }
    if (!status) status = sweep_store_open(f.sqlite, SWEEP_CREATE, &f.store);
    if (!status) status = sweep_store_write_plan(f.store, &f.plan, f.cfg, NULL);
    if (!status) status = sweep_store_salvage(f.store, &f.plan, kept, n);
    sweep_folder_close(&f);
    return status;
}

/* Whose a snapshot is: of this run with these tables. */
static void trace_owner(const sweep_plan *plan, size_t row, const sweep_tables *tables, char owner[33])
{
    char text[128], key[33];
    sweep_plan_key(plan, row, key);
    snprintf(text, sizeof text, "%s every %ld ledger %d", key, tables->every, tables->ledger);
    rp_hash_digits(XXH3_128bits(text, strlen(text)), owner);
}

rp_status sweep_trace(const char *file, const sweep_protocol *const *protocols, size_t row,
                      const sweep_tables *tables, const sweep_protocol **protocol, sweep_result *result)
{
    sweep_plan plan;
    char owner[33], why[1024] = "";
    sweep_keep keep = {
        .path = tables->snapshot, .key = owner, .interval = tables->interval, .stop = tables->stop};
    sweep_tables kept = *tables;
    kept.keep = tables->snapshot ? &keep : NULL;
    rp_status status = sweep_plan_read(file, protocols, &plan);
    *protocol = plan.protocol;
    if (!status && row >= plan.n_runs)
        status = rp_fail(RP_BAD_INPUT, "row = %zu: out of range, allowed: [0, %zu], the runs of %s", row,
                         plan.n_runs - 1, file);
    if (!status) status = sweep_plan_check_point(&plan, file, row / plan.replicas);
    if (!status) {
        trace_owner(&plan, row, tables, owner);
        if (kept.keep) sweep_keep_begin(&keep, true, why, sizeof why);
        const sweep_stream stream = sweep_plan_stream(&plan, row);
        status = *why ? rp_fail(RP_BAD_INPUT, "%s; remove this file to start anew", why)
                      : plan.protocol->run(sweep_plan_point(&plan, row / plan.replicas), stream.seed,
                                           stream.run, &kept, result);
        if (kept.keep) sweep_keep_end(&keep, status == RP_OK);
    }
    sweep_plan_free(&plan);
    return status;
}
