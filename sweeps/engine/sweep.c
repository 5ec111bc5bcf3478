/* The folder of a sweep: making it, running it whole or by shards, asking it; one run of a sweep again.
 *   sweep.cfg, store.sqlite, lock;  shards/3-of-8.sqlite, shards/3-of-8.sqlite.lock  */
#include "sweeps/engine/private.h"

#include <errno.h>
#include <fcntl.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/file.h"
#include "params/units.h"

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
    RP_TRY(rp_path(&f->memory, &f->experiment, "%s/experiment.cfg", dir));
    RP_TRY(rp_path(&f->memory, &f->sqlite, "%s/store.sqlite", dir));
    RP_TRY(rp_path(&f->memory, &f->snapshots, "%s/snapshots", dir));
    return rp_path(&f->memory, &f->shards, "%s/shards", dir);
}

/* A folder without a plan that should have one stays as it is. */
static rp_status lock_folder(sweep_folder *f, bool planned)
{
    const char *path;
    if (planned && access(f->dir, F_OK) == 0 && access(f->cfg, F_OK) != 0)
        return rp_fail(RP_BAD_INPUT, "%s: cannot read: %s", f->cfg, strerror(errno));
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
    RP_ENDS(rp_paths_free) rp_paths all = {0};
    RP_TRY(rp_paths_in(&all, folder, is_shard));
    for (size_t i = 0; i < all.n; i++) RP_TRY(add_store(f, all.path[i], stores));
    return RP_OK;
}

static bool is_other(const char *name)
{
    return strcmp(name, "lock") != 0;
}

/* An empty folder, or that of a sweep; one that was killed when it began has a lock alone. */
static rp_status claim(const sweep_folder *f)
{
    RP_ENDS(rp_paths_free) rp_paths files = {0};
    RP_TRY(rp_make_directory(f->dir));
    RP_TRY(rp_paths_in(&files, f->dir, is_other));
    return files.n == 0 || access(f->sqlite, F_OK) == 0
               ? RP_OK
               : rp_fail(RP_BAD_INPUT, "%s: holds other files and no sweep; give another folder", f->dir);
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
    char text[33];
    RP_TRY(sweep_plan_read(folder->cfg, protocols, &folder->plan));
    RP_TRY(sweep_store_open(folder->sqlite, access, &folder->store));
    RP_TRY(sweep_store_note(folder->store, "main", "replicas", text, sizeof text));
    const size_t replicas = strtoul(text, NULL, 10);
    if (replicas > 0 && replicas != folder->plan.replicas)
        RP_TRY(sweep_plan_replicate(&folder->plan, replicas));
    RP_TRY(sweep_store_note(folder->store, "main", "plan", text, sizeof text));
    if (!*text)
        return rp_fail(RP_BAD_INPUT,
                       "%s: holds no sweep: new, empty or cut; plan again with `repose sweep plan`",
                       folder->sqlite);
    if (strcmp(text, folder->plan.hash) != 0)
        return rp_fail(RP_BAD_INPUT,
                       "%s: the plan is not that of sweep.cfg and this version of the program; "
                       "plan again with `repose sweep plan` (stored rows are kept)",
                       folder->sqlite);
    return sweep_store_check_rows(folder->store, "main", folder->sqlite, &folder->plan);
}

rp_status sweep_folder_read(const char *dir, const sweep_protocol *const *protocols, bool verify,
                            sweep_folder *folder)
{
    RP_ENDS(rp_paths_free) rp_paths shards = {0};
    RP_TRY(name_files(dir, folder));
    RP_TRY(open_main(protocols, SWEEP_READ, folder));
    sweep_store *store = folder->store;
    RP_TRY(find_shards(folder, folder->shards, &shards));
    if (verify) RP_TRY(sweep_store_verify(store, "main", store->path));
    if (shards.n > 0)
        return sweep_store_unite(store, &folder->plan, shards.n, shards.path, verify, &folder->found);
    RP_TRY(sweep_sql(store, "read the store", "BEGIN")); /* as it is now, whoever writes */
    return sweep_store_running(store, "main", &folder->found.running);
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
    RP_ENDS(sweep_folder_close) sweep_folder f;
    *file = '\0';
    RP_TRY(name_files(dir, &f));
    if (access(f.sqlite, F_OK) != 0) return RP_OK;
    RP_TRY(sweep_store_open(f.sqlite, SWEEP_READ, &f.store));
    return sweep_store_note(f.store, "main", "file", file, 256);
}

static rp_status write_text(const char *path, const char *text)
{
    FILE *out;
    RP_TRY(rp_file_open(path, true, &out));
    fputs(text, out);
    return rp_file_close(path, out, RP_OK);
}

/* Open the store of a shard, and write the plan into it. */
static rp_status plan_shard(const char *path, const sweep_plan *plan, const sweep_plan *before,
                            const char *file, sweep_folder *shard)
{
    const char *lock;
    RP_TRY(rp_path(&shard->memory, &lock, "%s.lock", path));
    RP_TRY(take_lock(lock, path, &shard->lock));
    RP_TRY(sweep_store_open(path, SWEEP_CREATE, &shard->store));
    return sweep_store_write_plan(shard->store, plan, before, file, NULL);
}

/* With another text the rows of all shards are looked through as those of the folder's store. */
static rp_status plan_shards(sweep_folder *f, const sweep_plan *before, const char *file)
{
    RP_ENDS(rp_paths_free) rp_paths shards = {0};
    RP_TRY(find_shards(f, f->shards, &shards));
    for (size_t i = 0; i < shards.n; i++) {
        RP_ENDS(sweep_folder_close) sweep_folder shard = {.lock = -1};
        RP_TRY(plan_shard(shards.path[i], &f->plan, before, file, &shard));
    }
    return RP_OK;
}

/* Write the plan, beside what the folder has of the one before. */
static rp_status plan_again(sweep_folder *f, const sweep_protocol *const *protocols, const char *file,
                            sweep_watch *watch)
{
    RP_ENDS(sweep_plan_free) sweep_plan before = {0};
    char hash[33];
    const rp_units units = rp_units_now();
    RP_TRY(sweep_store_note(f->store, "main", "plan", hash, sizeof hash));
    const char *text = sweep_protocol_bytes(f->plan.protocol), *was = NULL;
    const bool other = text && *hash && strcmp(hash, f->plan.hash) != 0;
    if (other && !sweep_plan_read(f->cfg, protocols, &before)) was = sweep_protocol_bytes(before.protocol);
    const bool known = was && strcmp(text, was) != 0 && rp_units_now() == units &&
                       !sweep_plan_replicate(&before, f->plan.replicas);
    rp_units_set(units);
    if (other && (!was || strcmp(text, was) != 0)) RP_TRY(plan_shards(f, known ? &before : NULL, file));
    return sweep_store_write_plan(f->store, &f->plan, known ? &before : NULL, file, watch);
}

rp_status sweep_prepare(const char *file, const char *dir, size_t replicas,
                        const sweep_protocol *const *protocols, sweep_watch *watch, sweep_counts *counts)
{
    RP_ENDS(sweep_folder_close) sweep_folder f;
    RP_TRY(name_files(dir, &f));
    RP_TRY(sweep_plan_read(file, protocols, &f.plan));
    if (replicas > 0) RP_TRY(sweep_plan_replicate(&f.plan, replicas));
    for (size_t i = 0; i < f.plan.n_points; i++) {
        RP_TRY(sweep_plan_check_point(&f.plan, file, i));
        if (watch) watch("grid points checked", i + 1, f.plan.n_points);
    }
    RP_TRY(claim(&f));
    RP_TRY(lock_folder(&f, false));
    RP_TRY(sweep_store_open(f.sqlite, SWEEP_CREATE, &f.store));
    RP_TRY(plan_again(&f, protocols, file, watch));
    const char *experiment = sweep_protocol_bytes(f.plan.protocol);
    if (experiment) RP_TRY(write_text(f.experiment, experiment));
    RP_TRY(write_text(f.cfg, f.plan.text));
    return sweep_store_count(f.store, &f.plan, counts);
}

/* ---- running ---- */

/* Mark what a store holds of the plan, if its rows are numbered by this plan. */
static rp_status mark_store(const char *path, const sweep_plan *plan, unsigned char *done)
{
    sweep_store *store;
    char hash[33];
    rp_status status = sweep_store_open(path, SWEEP_READ, &store);
    if (!status) status = sweep_store_note(store, "main", "plan", hash, sizeof hash);
    const bool same = !status && strcmp(hash, plan->hash) == 0;
    if (same) status = sweep_store_check_rows(store, "main", path, plan);
    if (same && !status) status = sweep_store_mark(store, plan->n_runs, done);
    sweep_store_close(store);
    return status;
}

/* Numbers of the runs of this part (0 of 1: of all) that are neither in the folder's store nor in the open
 * one; a sweep that runs whole leaves out what its shards have. In the memory of the folder. */
static rp_status find_todo(sweep_folder *f, const sweep_options *options, size_t **todo, size_t *n)
{
    const sweep_plan *plan = &f->plan;
    const size_t parts = options->shards > 0 ? (size_t)options->shards : 1,
                 part = options->shards > 0 ? (size_t)options->shard - 1 : 0;
    RP_ENDS(rp_paths_free) rp_paths shards = {0};
    unsigned char *done;
    RP_NEW(&f->memory, done, plan->n_runs / 8 + 1);
    RP_NEW(&f->memory, *todo, plan->n_runs / parts + 1);
    RP_TRY(sweep_store_mark(f->store, plan->n_runs, done));
    RP_TRY(options->shards > 0 ? mark_store(f->sqlite, plan, done) : find_shards(f, f->shards, &shards));
    for (size_t i = 0; i < shards.n; i++) RP_TRY(mark_store(shards.path[i], plan, done));
    for (size_t r = part; r < plan->n_runs; r += parts)
        if (!(done[r / 8] >> r % 8 & 1)) (*todo)[(*n)++] = r;
    return RP_OK;
}

/* A shard has a store of its own, so that machines that share a folder need no lock between them. */
static rp_status open_shard(const sweep_options *options, sweep_folder *f)
{
    const char *folder, *path;
    char file[256];
    rp_status status = sweep_store_note(f->store, "main", "file", file, sizeof file);
    sweep_store_close(f->store);
    f->store = NULL;
    RP_TRY(status);
    RP_TRY(rp_path(&f->memory, &folder, "%s/shards", f->dir));
    RP_TRY(rp_path(&f->memory, &path, "%s/%d-of-%d.sqlite", folder, options->shard, options->shards));
    RP_TRY(make_folder(folder));
    RP_TRY(plan_shard(path, &f->plan, NULL, file, f));
    return sweep_store_check_rows(f->store, "main", path, &f->plan);
}

static bool is_snapshot(const char *name)
{
    const size_t digits = strspn(name, "0123456789abcdef");
    return digits == 32 && (!name[digits] || rp_ends_in(name, ".new"));
}

/* Snapshots of a sweep whose runs are all stored: a driver that was killed may have left some. Other files of
 * the folder stay, and then the folder. */
static void remove_snapshots(const sweep_folder *f)
{
    RP_ENDS(rp_paths_free) rp_paths left = {0};
    rp_paths_in(&left, f->snapshots, is_snapshot);
    for (size_t i = 0; i < left.n; i++) unlink(left.path[i]);
    rmdir(f->snapshots);
}

rp_status sweep_run(const char *dir, const sweep_protocol *const *protocols, const sweep_options *options,
                    sweep_counts *counts)
{
    RP_ENDS(sweep_folder_close) sweep_folder f = {.lock = -1};
    size_t *todo, n = 0;
    const bool whole = options->shards == 0;
    RP_TRY(rp_check_range("workers", options->workers, 1.0, DBL_MAX, "[1, inf)"));
    const double limits[] = {options->memory, options->time, options->patience, options->slow,
                             options->snapshot};
    for (size_t k = 0; k < sizeof limits / sizeof *limits; k++)
        RP_TRY(
            rp_check_range("memory, time, patience, slow or snapshot", limits[k], 0.0, INFINITY, "[0, inf]"));
    if (!whole && (options->shard < 1 || options->shard > options->shards))
        return rp_fail(RP_BAD_INPUT, "shard = %d/%d: out of range, allowed: 1/%d to %d/%d", options->shard,
                       options->shards, options->shards, options->shards, options->shards);
    RP_TRY(name_files(dir, &f));
    if (whole) RP_TRY(lock_folder(&f, true));
    RP_TRY(open_main(protocols, whole ? SWEEP_WRITE : SWEEP_READ, &f));
    if (!whole) RP_TRY(open_shard(options, &f));
    RP_TRY(sweep_store_drop_crashed(f.store));
    RP_TRY(find_todo(&f, options, &todo, &n));
    RP_TRY(sweep_store_count(f.store, &f.plan, counts));
    const size_t planned =
        whole ? f.plan.n_runs
              : (f.plan.n_runs + (size_t)(options->shards - options->shard)) / (size_t)options->shards;
    counts->planned = planned;
    counts->stored = planned - n;
    if (n > 0 && isnormal(options->snapshot)) RP_TRY(make_folder(f.snapshots));
    if (n > 0) RP_TRY(sweep_pool_run(&f, todo, n, options, counts));
    RP_TRY(sweep_store_commit(f.store));
    RP_TRY(sweep_store_count(f.store, &f.plan, counts));
    if (whole && sweep_count_aborted(counts) == 0) remove_snapshots(&f);
    counts->planned = counts->stored = planned; /* some may stand in other stores */
    return sweep_check_aborted(counts);
}

/* ---- asking ---- */

/* "2,5-7 of 8": the shards that have runs to do, where the folder has shards. */
static rp_status list_shards(sweep_folder *f, char *text, size_t size)
{
    RP_ENDS(rp_paths_free) rp_paths shards = {0};
    size_t parts = 0, used = 0;
    unsigned char *done;
    bool *open;
    text[0] = '\0';
    RP_TRY(rp_paths_in(&shards, f->shards, is_shard));
    for (size_t i = 0; i < shards.n; i++) {
        const size_t n = strtoul(strstr(strrchr(shards.path[i], '/'), "-of-") + 4, NULL, 10);
        if (n > parts) parts = n;
    }
    RP_NEW(&f->memory, done, f->plan.n_runs / 8 + 1);
    RP_NEW(&f->memory, open, parts + 2);
    RP_TRY(sweep_store_mark(f->store, f->plan.n_runs, done));
    for (size_t r = 0; parts > 0 && r < f->plan.n_runs; r++) open[r % parts] |= !(done[r / 8] >> r % 8 & 1);
    for (size_t i = 0; i < parts && used < size; i++) {
        size_t last = i;
        while (open[last] && open[last + 1]) last++;
        if (open[i])
            used += (size_t)snprintf(text + used, size - used, last > i ? "%s%zu-%zu" : "%s%zu",
                                     used ? "," : "", i + 1, last + 1);
        i = last;
    }
    if (used > 0 && used < size) snprintf(text + used, size - used, " of %zu", parts);
    return RP_OK;
}

rp_status sweep_status(const char *dir, const sweep_protocol *const *protocols, sweep_counts *counts)
{
    RP_ENDS(sweep_folder_close) sweep_folder f;
    RP_TRY(sweep_folder_read(dir, protocols, false, &f));
    RP_TRY(sweep_store_count(f.store, &f.plan, counts));
    counts->running = f.found.running;
    return list_shards(&f, counts->shards, sizeof counts->shards);
}

/* A folder stands for its store and its shards. */
static rp_status add_source(const sweep_folder *f, const char *path, rp_paths *sources)
{
    RP_ENDS(sweep_folder_close) sweep_folder other;
    struct stat info;
    RP_TRY(name_files(path, &other));
    if (stat(path, &info) == 0 && S_ISDIR(info.st_mode)) {
        RP_TRY(add_store(f, other.sqlite, sources));
        return find_shards(f, other.shards, sources);
    }
    if (access(path, F_OK) != 0) return rp_fail(RP_BAD_INPUT, "%s: no store", path);
    return rp_paths_add(sources, NULL, path);
}

rp_status sweep_merge(const char *dir, const sweep_protocol *const *protocols, size_t n, char *const paths[],
                      sweep_merged *merged, sweep_counts *counts)
{
    RP_ENDS(sweep_folder_close) sweep_folder f;
    RP_ENDS(rp_paths_free) rp_paths sources = {0};
    RP_TRY(name_files(dir, &f));
    RP_TRY(lock_folder(&f, true));
    RP_TRY(open_main(protocols, SWEEP_WRITE, &f));
    if (n == 0) RP_TRY(find_shards(&f, f.shards, &sources));
    for (size_t i = 0; i < n; i++) RP_TRY(add_source(&f, paths[i], &sources));
    if (sources.n == 0)
        return rp_fail(RP_BAD_INPUT, "%s: no shards, and no other store is named%s%s", dir,
                       *f.store->skipped ? "; none yet: " : "", f.store->skipped);
    RP_TRY(sweep_store_merge(f.store, &f.plan, sources.n, sources.path, merged));
    RP_TRY(sweep_store_count(f.store, &f.plan, counts));
    if (counts->stored == counts->planned && sweep_count_aborted(counts) == 0) remove_snapshots(&f);
    return list_shards(&f, counts->shards, sizeof counts->shards);
}

static const char *const ends[] = {"-shm", "-wal", "-journal",
                                   ""}; /* of a store's files; the name itself last */
enum { N_ENDS = sizeof ends / sizeof *ends };

/* Nothing is there under this name, or with such an end. */
static rp_status check_no_store(sweep_folder *f, const char *store)
{
    struct stat info;
    const char *path;
    for (size_t i = 0; i < N_ENDS; i++) {
        RP_TRY(rp_path(&f->memory, &path, "%s%s", store, ends[i]));
        if (lstat(path, &info) == 0)
            return rp_fail(RP_BAD_INPUT, "%s: kept of an earlier salvage; move it away first", path);
    }
    return RP_OK;
}

static rp_status make_salvaged(sweep_folder *f, const char *made, size_t *n)
{
    rp_status status = sweep_store_open(made, SWEEP_CREATE, &f->store);
    if (!status) status = sweep_store_write_plan(f->store, &f->plan, NULL, f->cfg, NULL);
    if (!status) status = sweep_store_salvage(f->store, &f->plan, f->sqlite, n);
    sweep_store_close(f->store);
    f->store = NULL;
    return status;
}

/* A new store beside the damaged one, which takes its place when it is whole. */
rp_status sweep_salvage(const char *dir, const sweep_protocol *const *protocols, size_t *n)
{
    RP_ENDS(sweep_folder_close) sweep_folder f;
    const char *kept, *made, *from, *to;
    *n = 0;
    RP_TRY(name_files(dir, &f));
    RP_TRY(rp_path(&f.memory, &kept, "%s/damaged.sqlite", dir));
    RP_TRY(rp_path(&f.memory, &made, "%s/salvaged.sqlite", dir));
    RP_TRY(lock_folder(&f, true));
    RP_TRY(sweep_plan_read(f.cfg, protocols, &f.plan));
    if (access(f.sqlite, F_OK) != 0) return rp_fail(RP_BAD_INPUT, "%s: no store", f.sqlite);
    RP_TRY(check_no_store(&f, kept));
    RP_TRY(check_no_store(&f, made));
    const rp_status status = make_salvaged(&f, made, n);
    for (size_t i = 0; i < N_ENDS && status; i++) {
        RP_TRY(rp_path(&f.memory, &to, "%s%s", made, ends[i]));
        unlink(to);
    }
    if (status) return rp_prefix(status, "salvage: nothing is changed: ");
    for (size_t i = 0; i < N_ENDS; i++) {
        RP_TRY(rp_path(&f.memory, &from, "%s%s", f.sqlite, ends[i]));
        RP_TRY(rp_path(&f.memory, &to, "%s%s", kept, ends[i]));
        if (rename(from, to) != 0 && errno != ENOENT)
            return rp_fail(RP_IO, "%s: cannot rename: %s", from, strerror(errno));
    }
    return rename(made, f.sqlite) == 0 ? RP_OK
                                       : rp_fail(RP_IO, "%s: cannot rename: %s", made, strerror(errno));
}

/* Whose a snapshot is: of this run with these tables. */
static void trace_owner(const sweep_plan *plan, size_t row, const sweep_tables *tables, char owner[33])
{
    char text[128], key[33];
    sweep_plan_key(plan, row, key);
    snprintf(text, sizeof text, "%s every %ld ledger %d", key, tables->every, tables->ledger);
    rp_hash_digits(XXH3_128bits(text, strlen(text)), owner);
}

static void free_plan(void *plan)
{
    sweep_plan_free(plan);
}

rp_status sweep_trace(const char *file, const sweep_protocol *const *protocols, size_t row,
                      const sweep_tables *tables, rp_arena *arena, const sweep_output **outputs,
                      sweep_result *result)
{
    static const sweep_tables none = {0};
    sweep_plan *plan;
    char owner[33];
    sweep_tables own = tables ? *tables : none;
    RP_NEW(arena, plan, 1);
    rp_arena_keep(arena, plan, free_plan);
    RP_TRY(sweep_plan_read(file, protocols, plan));
    *outputs = plan->protocol->outputs;
    if (row >= plan->n_runs)
        return rp_fail(RP_BAD_INPUT, "row = %zu: out of range, allowed: [0, %zu], the runs of %s", row,
                       plan->n_runs - 1, file);
    RP_TRY(sweep_plan_check_point(plan, file, row / plan->replicas));
    trace_owner(plan, row, &own, owner);
    own.owner = owner;
    return sweep_plan_run(plan, row, &own, result);
}
