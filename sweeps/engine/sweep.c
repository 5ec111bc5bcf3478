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
    if (*lock < 0 || fstat(*lock, &info) != 0 || !S_ISREG(info.st_mode) || info.st_size > 0)
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

/* Add the stores of the shards of a folder, in order. */
static rp_status find_shards(const char *folder, rp_paths *stores)
{
    return rp_paths_in(stores, folder, is_shard);
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
static rp_status open_main(const sweep_protocol *const *protocols, bool writes, sweep_folder *folder)
{
    char model[128];
    RP_TRY(sweep_plan_read(folder->cfg, protocols, &folder->plan));
    if (access(folder->sqlite, F_OK) != 0)
        return rp_fail(RP_BAD_INPUT, "%s: no store; `repose sweep plan` makes it", folder->sqlite);
    RP_TRY(sweep_store_open(folder->sqlite, writes, &folder->store));
    RP_TRY(sweep_store_note(folder->store, "model", model, sizeof model));
    if (strcmp(model, folder->plan.model) == 0) return RP_OK;
    if (!*model)
        return rp_fail(RP_BAD_INPUT, "%s: holds no sweep; `repose sweep plan` makes it", folder->sqlite);
    return rp_fail(
        RP_BAD_INPUT,
        "%s: planned with another model of the physics (%s), not with this one (%s); plan again with "
        "`repose sweep plan` (stored rows are kept)",
        folder->sqlite, model, folder->plan.model);
}

rp_status sweep_folder_read(const char *dir, const sweep_protocol *const *protocols, sweep_folder *folder)
{
    RP_ENDS(rp_paths_free) rp_paths shards = {0};
    RP_TRY(name_files(dir, folder));
    RP_TRY(open_main(protocols, false, folder));
    RP_TRY(find_shards(folder->shards, &shards));
    return sweep_store_unite(folder->store, &folder->plan, shards.n, shards.path);
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
    if (!rp_is_there(f.sqlite)) return RP_OK;
    RP_TRY(sweep_store_open(f.sqlite, false, &f.store));
    return sweep_store_note(f.store, "file", file, 256);
}

static rp_status write_text(const char *path, const char *text)
{
    FILE *out;
    RP_TRY(rp_file_open(path, true, &out));
    fputs(text, out);
    return rp_file_close(path, out, RP_OK);
}

rp_status sweep_prepare(const char *file, const char *dir, size_t replicas,
                        const sweep_protocol *const *protocols, sweep_counts *counts)
{
    return sweep_prepare_seen(file, dir, replicas, protocols, NULL, NULL, counts);
}

rp_status sweep_prepare_seen(const char *file, const char *dir, size_t replicas,
                             const sweep_protocol *const *protocols, sweep_planning *look, void *context,
                             sweep_counts *counts)
{
    RP_ENDS(sweep_folder_close) sweep_folder f;
    RP_TRY(name_files(dir, &f));
    RP_TRY(sweep_plan_read(file, protocols, &f.plan));
    if (replicas > 0) RP_TRY(sweep_plan_replicate(&f.plan, replicas));
    for (size_t i = 0; i < f.plan.n_points; i++) {
        RP_TRY(sweep_plan_check_point(&f.plan, file, i));
        if (look) look(context, i + 1, f.plan.n_points);
    }
    RP_TRY(claim(&f));
    RP_TRY(lock_folder(&f, false));
    RP_TRY(sweep_store_open(f.sqlite, true, &f.store));
    RP_TRY(sweep_store_write_notes(f.store, &f.plan, file));
    const char *experiment = sweep_protocol_bytes(f.plan.protocol);
    if (experiment) RP_TRY(write_text(f.experiment, experiment));
    RP_TRY(write_text(f.cfg, f.plan.text));
    return sweep_store_count(f.store, &f.plan, counts);
}

/* ---- running ---- */

static rp_status mark_run(const sweep_row *row, void *context)
{
    bool *const done = context;
    done[row->run] |= !sweep_is_aborted(row->result.status);
    return RP_OK;
}

/* Mark what the open store has, with these others. */
static rp_status mark_stored(const sweep_folder *f, const rp_paths *others, bool *done)
{
    if (others->n > 0) RP_TRY(sweep_store_unite(f->store, &f->plan, others->n, others->path));
    RP_TRY(sweep_store_visit(f->store, &f->plan, false, mark_run, done));
    return others->n > 0 ? sweep_store_part(f->store) : RP_OK;
}

/* A shard has a store of its own, so that machines that share a folder need no lock between them. */
static rp_status open_shard(const sweep_options *options, sweep_folder *f)
{
    const char *path, *lock;
    char file[256];
    RP_TRY(sweep_store_note(f->store, "file", file, sizeof file));
    sweep_store_close(f->store);
    f->store = NULL;
    RP_TRY(make_folder(f->shards));
    RP_TRY(rp_path(&f->memory, &path, "%s/%d-of-%d.sqlite", f->shards, options->shard, options->shards));
    RP_TRY(rp_path(&f->memory, &lock, "%s.lock", path));
    RP_TRY(take_lock(lock, path, &f->lock));
    RP_TRY(sweep_store_open(path, true, &f->store));
    return sweep_store_write_notes(f->store, &f->plan, file);
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
    RP_ENDS(rp_paths_free) rp_paths others = {0};
    size_t *todo, n = 0;
    bool *done;
    const bool whole = options->shards == 0;
    const size_t parts = whole ? 1 : (size_t)options->shards;
    RP_TRY(rp_check_range("workers", options->workers, 1.0, DBL_MAX, "[1, inf)"));
    const double limits[] = {options->memory, options->time, options->snapshot};
    for (size_t k = 0; k < sizeof limits / sizeof *limits; k++)
        RP_TRY(rp_check_range("memory, time or snapshot", limits[k], 0.0, INFINITY, "[0, inf]"));
    if (!whole && (options->shard < 1 || options->shard > options->shards))
        return rp_fail(RP_BAD_INPUT, "shard = %d/%d: out of range, allowed: 1/%d to %d/%d", options->shard,
                       options->shards, options->shards, options->shards, options->shards);
    RP_TRY(name_files(dir, &f));
    if (whole) RP_TRY(lock_folder(&f, true));
    RP_TRY(open_main(protocols, whole, &f));
    RP_NEW(&f.memory, done, f.plan.n_runs);
    RP_NEW(&f.memory, todo, f.plan.n_runs / parts + 1);
    if (!whole) RP_TRY(mark_stored(&f, &others, done));
    RP_TRY(whole ? find_shards(f.shards, &others) : open_shard(options, &f));
    RP_TRY(sweep_store_drop_aborted(f.store));
    RP_TRY(mark_stored(&f, &others, done));
    size_t planned = 0;
    for (size_t r = whole ? 0 : (size_t)options->shard - 1; r < f.plan.n_runs; r += parts, planned++)
        if (!done[r]) todo[n++] = r;
    RP_TRY(sweep_store_count(f.store, &f.plan, counts));
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

rp_status sweep_status(const char *dir, const sweep_protocol *const *protocols, sweep_counts *counts)
{
    RP_ENDS(sweep_folder_close) sweep_folder f;
    RP_TRY(sweep_folder_read(dir, protocols, &f));
    return sweep_store_count(f.store, &f.plan, counts);
}

/* A folder stands for its store and its shards. */
static rp_status add_source(const char *path, rp_paths *sources)
{
    RP_ENDS(sweep_folder_close) sweep_folder other;
    struct stat info;
    RP_TRY(name_files(path, &other));
    if (stat(path, &info) != 0) return rp_fail(RP_BAD_INPUT, "%s: no store", path);
    if (!S_ISDIR(info.st_mode)) return rp_paths_add(sources, NULL, path);
    if (access(other.sqlite, F_OK) != 0) return rp_fail(RP_BAD_INPUT, "%s: no store", other.sqlite);
    RP_TRY(rp_paths_add(sources, NULL, other.sqlite));
    return find_shards(other.shards, sources);
}

rp_status sweep_merge(const char *dir, const sweep_protocol *const *protocols, size_t n, char *const paths[],
                      sweep_counts *counts)
{
    RP_ENDS(sweep_folder_close) sweep_folder f;
    RP_ENDS(rp_paths_free) rp_paths sources = {0};
    RP_TRY(name_files(dir, &f));
    RP_TRY(lock_folder(&f, true));
    RP_TRY(open_main(protocols, true, &f));
    if (n == 0) RP_TRY(find_shards(f.shards, &sources));
    for (size_t i = 0; i < n; i++) RP_TRY(add_source(paths[i], &sources));
    if (sources.n == 0) return rp_fail(RP_BAD_INPUT, "%s: no shards, and no other store is named", dir);
    RP_TRY(sweep_store_merge(f.store, &f.plan, sources.n, sources.path));
    RP_TRY(sweep_store_count(f.store, &f.plan, counts));
    if (counts->stored == counts->planned && sweep_count_aborted(counts) == 0) remove_snapshots(&f);
    return RP_OK;
}

static void free_plan(void *plan)
{
    sweep_plan_free(plan);
}

rp_status sweep_read_again(const char *file, const sweep_protocol *const *protocols, size_t row,
                           rp_arena *arena, sweep_again *again)
{
    sweep_plan *plan;
    RP_NEW(arena, plan, 1);
    rp_arena_keep(arena, plan, free_plan);
    RP_TRY(sweep_plan_read(file, protocols, plan));
    if (row >= plan->n_runs)
        return rp_fail(RP_BAD_INPUT, "row = %zu: out of range, allowed: [0, %zu], the runs of %s", row,
                       plan->n_runs - 1, file);
    RP_TRY(sweep_plan_check_point(plan, file, row / plan->replicas));
    const sweep_stream stream = sweep_plan_stream(plan, row);
    *again =
        (sweep_again){plan->protocol, sweep_plan_point(plan, row / plan->replicas), stream.seed, stream.run};
    return RP_OK;
}
