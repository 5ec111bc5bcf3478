/* Power cuts. A shim between SQLite and the disk notes every write, sync, creation and removal of the real
 * driver. From these notes the disk is made as it may be after a power cut at any of them: what was synced is
 * there; of what was not, a random part is, whole, torn or as garbage. What is then opened must hold each
 * group of rows that was committed, and at most one more.
 *
 * The files that Repose writes itself are synced before they are renamed, and their folder afterwards. */
#include <glob.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "core/random.h"
#include "core/file.h"
#include "tests/faults.h"
#include "tests/noise.h"
#include "tests/program.h"
#include "tests/protocol.h"

/* ---- What happened to the disk */

typedef enum { WRITE, TRUNCATE, SYNC, CREATE, DELETE, SYNC_FOLDER } act;

/* A file lives from its creation to its removal; another of the same name is another file. */
typedef struct {
    act act;
    int file;
    sqlite3_int64 at; /* of a write; length of a truncation */
    size_t n;
    unsigned char *bytes;
} event;

/* So many rows were on the disk when so many events had happened. */
typedef struct {
    size_t events, rows;
} group;

enum { MOST_EVENTS = 20000, MOST_FILES = 100, MOST_GROUPS = 500, MOST_BYTES = 4000000, SECTOR = 512 };

static struct {
    bool on;
    size_t n, n_groups, rows;
    bool committing; /* a group, whose last event is not known yet */
    event events[MOST_EVENTS];
    group groups[MOST_GROUPS];
    int n_files;
    char names[MOST_FILES][96]; /* "" once removed */
    char first_names[MOST_FILES][96];
} disk;

static event *note(act what, int file)
{
    static event none;
    if (!disk.on) return &none;
    CU_ASSERT_FATAL(disk.n < MOST_EVENTS);
    disk.events[disk.n] = (event){.act = what, .file = file};
    return &disk.events[disk.n++];
}

static int find_file(const char *path)
{
    for (int k = disk.n_files; k-- > 0;)
        if (strcmp(disk.names[k], path) == 0) return k;
    return -1;
}

static int make_file(const char *path)
{
    CU_ASSERT_FATAL(disk.n_files < MOST_FILES);
    strcpy(disk.names[disk.n_files], path);
    strcpy(disk.first_names[disk.n_files], path);
    note(CREATE, disk.n_files);
    return disk.n_files++;
}

static void forget(void)
{
    for (size_t i = 0; i < disk.n; i++) free(disk.events[i].bytes);
    memset(&disk, 0, sizeof disk);
}

/* ---- The shim */

/* A file is that of the layer below, with other methods, and this behind it. */
typedef struct {
    const sqlite3_io_methods *real;
    sqlite3_io_methods methods;
    int file;
    bool sync_folder; /* with the first sync, as SQLite does for a new journal */
} shim;

static sqlite3_vfs *below, layer;

static shim *shim_of(sqlite3_file *f)
{
    return (shim *)((char *)f + below->szOsFile);
}

static int shim_write(sqlite3_file *f, const void *bytes, int n, sqlite3_int64 at)
{
    event *e = note(WRITE, shim_of(f)->file);
    *e = (event){WRITE, e->file, at, (size_t)n, disk.on ? malloc((size_t)n) : NULL};
    if (e->bytes) memcpy(e->bytes, bytes, (size_t)n);
    return shim_of(f)->real->xWrite(f, bytes, n, at);
}

static int shim_truncate(sqlite3_file *f, sqlite3_int64 length)
{
    note(TRUNCATE, shim_of(f)->file)->at = length;
    return shim_of(f)->real->xTruncate(f, length);
}

static int shim_sync(sqlite3_file *f, int flags)
{
    shim *s = shim_of(f);
    const int rc = s->real->xSync(f, flags);
    note(SYNC, s->file);
    if (s->sync_folder) note(SYNC_FOLDER, -1);
    s->sync_folder = false;
    return rc;
}

static int shim_open(sqlite3_vfs *vfs, const char *path, sqlite3_file *f, int flags, int *opened)
{
    (void)vfs;
    shim *s = shim_of(f);
    const bool there = path && access(path, F_OK) == 0;
    const int rc = below->xOpen(below, path, f, flags, opened);
    s->file = -1;
    if (rc != SQLITE_OK) return rc;
    s->real = f->pMethods;
    s->methods = *s->real;
    s->methods.iVersion = 2; /* without maps of the file */
    s->methods.xWrite = shim_write;
    s->methods.xTruncate = shim_truncate;
    s->methods.xSync = shim_sync;
    f->pMethods = &s->methods;
    if (!path || !disk.on) return rc;
    s->file = there ? find_file(path) : make_file(path);
    CU_ASSERT_FATAL(s->file >= 0);
    s->sync_folder = !there && !(flags & SQLITE_OPEN_MAIN_DB);
    return rc;
}

static int shim_delete(sqlite3_vfs *vfs, const char *path, int sync_folder)
{
    (void)vfs;
    const int file = find_file(path), rc = below->xDelete(below, path, sync_folder);
    if (rc != SQLITE_OK || file < 0) return rc;
    note(DELETE, file);
    *disk.names[file] = '\0';
    if (sync_folder) note(SYNC_FOLDER, -1);
    return rc;
}

/* A group is on the disk, at the latest, when the first row of the next one comes. */
static void end_group(void)
{
    if (disk.on && disk.committing) disk.groups[disk.n_groups++] = (group){disk.n, disk.rows};
    CU_ASSERT_FATAL(disk.n_groups < MOST_GROUPS);
    disk.committing = false;
}

static int on_commit(void *context)
{
    (void)context;
    end_group();
    disk.committing = true;
    return 0;
}

static void on_change(void *context, int op, const char *schema, const char *table, sqlite3_int64 row)
{
    (void)context, (void)schema, (void)row;
    if (op != SQLITE_INSERT || strcmp(table, "runs") != 0) return;
    end_group();
    disk.rows++;
}

static int on_open(sqlite3 *db, const char **why, const struct sqlite3_api_routines *api)
{
    (void)why, (void)api;
    if (!disk.on) return SQLITE_OK;
    sqlite3_commit_hook(db, on_commit, NULL);
    sqlite3_update_hook(db, on_change, NULL);
    return SQLITE_OK;
}

static void put_shim(void)
{
    below = sqlite3_vfs_find(NULL);
    layer = *below;
    layer.zName = "power cut";
    layer.szOsFile = below->szOsFile + (int)sizeof(shim);
    layer.xOpen = shim_open;
    layer.xDelete = shim_delete;
    CU_ASSERT_FATAL(sqlite3_vfs_register(&layer, 1) == SQLITE_OK);
    CU_ASSERT_FATAL(sqlite3_auto_extension((void (*)(void))on_open) == SQLITE_OK);
}

/* ---- The disk after a cut */

static rp_random chance;

static bool draw(double p)
{
    return rp_random_uniform(&chance) < p;
}

/* A write that may be whole, not there, or torn: each sector new, old, or neither. */
static void write_part(const event *e, double share, unsigned char *bytes, size_t *length)
{
    const bool torn = share < 1.0 && draw(0.4);
    if (!torn && !draw(share)) return;
    for (size_t k = 0; k < e->n; k++) {
        static unsigned sector;
        const size_t at = (size_t)e->at + k;
        if (k == 0 || at % SECTOR == 0) sector = (unsigned)rp_random_below(&chance, 5);
        if (!torn || sector < 2)
            bytes[at] = e->bytes[k];
        else if (sector == 4)
            bytes[at] = (unsigned char)rp_random_below(&chance, 256);
    }
    if ((size_t)e->at + e->n > *length) *length = (size_t)e->at + e->n;
}

/* One file after a cut at event `cut`: the synced events, and this share of the others. */
static void write_file(int file, size_t cut, double share, const char *folder)
{
    static unsigned char bytes[MOST_BYTES];
    size_t synced = 0, length = 0;
    memset(bytes, 0, sizeof bytes);
    for (size_t i = 0; i < cut; i++)
        if (disk.events[i].file == file && disk.events[i].act == SYNC) synced = i;
    for (size_t i = 0; i < cut; i++) {
        const event *e = &disk.events[i];
        if (e->file != file) continue;
        CU_ASSERT_FATAL(e->at >= 0 && (size_t)e->at + e->n <= MOST_BYTES);
        const double part = i < synced ? 1.0 : share;
        if (e->act == WRITE) write_part(e, part, bytes, &length);
        if (e->act != TRUNCATE || !draw(part)) continue;
        if ((size_t)e->at < length) memset(bytes + e->at, 0, length - (size_t)e->at);
        length = (size_t)e->at;
    }
    file_write(folder_path(folder, strrchr(disk.first_names[file], '/') + 1), bytes, length);
}

/* Names come and go in order: up to the last sync of the folder all, and of the later ones the first few. */
static void write_disk(size_t cut, const char *folder)
{
    static const double shares[] = {0.0, 0.5, 0.9, 1.0};
    const double share = shares[rp_random_below(&chance, 4)];
    bool there[MOST_FILES] = {false};
    size_t sure = 0, last;
    for (size_t i = 0; i < cut; i++)
        if (disk.events[i].act == SYNC_FOLDER) sure = i;
    last = share < 1.0 ? sure + rp_random_below(&chance, cut - sure + 1) : cut;
    for (size_t i = 0; i < last; i++) {
        const event *e = &disk.events[i];
        if (e->act == CREATE || e->act == DELETE) there[e->file] = e->act == CREATE;
    }
    for (int k = 0; k < disk.n_files; k++)
        if (there[k]) write_file(k, cut, share, folder);
}

/* ---- The sweep */

enum { ROWS = 80 };

static const sweep_protocol protocol = NOISE_PROTOCOL("power", noise_run);
static const sweep_protocol *const protocols[] = {&protocol, NULL};

static char base[FOLDER_PATH], file[96], dir[96], cut_dir[96];

static void make_base(void)
{
    folder_make_in_memory("power", base);
    snprintf(file, sizeof file, "%s/s.cfg", base);
    snprintf(dir, sizeof dir, "%s/d", base);
    snprintf(cut_dir, sizeof cut_dir, "%s/cut", base);
    chance = rp_random_of(18, 13, RP_PURPOSE_TEST);
    file_print(file, "protocol = \"power\"; replicas = %d; grid = { x = [1.0, 2.0]; };\n", ROWS / 2);
}

static void remove_base(void)
{
    folder_remove(base);
}

/* Now and then the clock advances, so that groups of rows of every size are committed. */
static void turn_clock(const sweep_progress *progress, void *context)
{
    (void)progress, (void)context;
    if (draw(0.2)) fault_monotonic_clock++;
}

static rp_status drive(const char *folder)
{
    return sweep_run(folder, protocols, &(sweep_options){.workers = 2, .watch = turn_clock},
                     &(sweep_counts){0});
}

static rp_status plan(const char *folder)
{
    return sweep_prepare(file, folder, 0, protocols, NULL, &(sweep_counts){0});
}

/* The lines of an export by the number of their run; "" for a run that is not there. */
static size_t read_rows(const char *folder, char lines[ROWS][256])
{
    scoped char *text = protocol_export(folder, protocols, SWEEP_RUNS);
    size_t run, n = 0;
    for (size_t k = 0; k < ROWS; k++) *lines[k] = '\0';
    for (char *rest = text, *line; (line = strsep(&rest, "\n"));)
        if (sscanf(line, "%zu", &run) == 1 && run < ROWS) snprintf(lines[run], 256, "%.255s", line), n++;
    CU_ASSERT(*text);
    return n;
}

/* Rows of the groups that were committed before the cut, and of the one that was being committed. */
static void rows_at(size_t cut, size_t *least, size_t *most)
{
    *least = *most = 0;
    for (size_t g = 0; g < disk.n_groups; g++) {
        if (disk.groups[g].rows > *least && disk.groups[g].events > cut) {
            *most = disk.groups[g].rows;
            return;
        }
        *least = *most = disk.groups[g].rows;
    }
}

/* Nothing of the committed groups is lost, nothing is another, and the same command continues. */
static void check_cut(size_t cut, size_t planned, char good[ROWS][256], const char *digest)
{
    static char left[ROWS][256];
    char again[33];
    size_t least, most, n;
    CU_ASSERT(mkdir(cut_dir, 0777) == 0);
    write_disk(cut, cut_dir);
    if (cut >= planned) {
        CU_ASSERT(link(folder_path(dir, "sweep.cfg"), folder_path(cut_dir, "sweep.cfg")) == 0);
        n = read_rows(cut_dir, left);
        rows_at(cut, &least, &most);
        CU_ASSERT(n == least || n == most);
        if (n != least && n != most) fprintf(stderr, "cut %zu: %zu rows, %zu or %zu\n", cut, n, least, most);
        for (size_t k = 0; k < ROWS; k++) CU_ASSERT(!*left[k] || strcmp(left[k], good[k]) == 0);
    }
    if (cut < planned || cut % 8 == 0) {
        CHECK_OK(plan(cut_dir));
        CHECK_OK(drive(cut_dir));
        CHECK_OK(sweep_digest(cut_dir, protocols, again, &n));
        CU_ASSERT_STRING_EQUAL(again, digest);
    }
    folder_remove(cut_dir);
}

static void cut_sweeps(bool shared)
{
    static char good[ROWS][256];
    const size_t cuts = check_fast() ? 40 : 250;
    char digest[33];
    size_t n;
    fault_shared_file_system = shared;
    put_shim();
    disk.on = true;
    CHECK_OK(plan(dir));
    const size_t planned = disk.n;
    CHECK_OK(drive(dir));
    end_group();
    disk.on = false;
    CHECK_OK(sweep_digest(dir, protocols, digest, &n));
    CU_ASSERT(n == ROWS && read_rows(dir, good) == ROWS && disk.rows == ROWS && disk.n_groups > 5);
    bool journal = false;
    for (int k = 0; k < disk.n_files; k++) journal |= strstr(disk.first_names[k], "-wal") != NULL;
    CU_ASSERT(journal != shared);
    for (size_t k = 0; k < cuts; k++) {
        const size_t first = k % 5 ? planned : 0;
        check_cut(first + rp_random_below(&chance, disk.n - first + 1), planned, good, digest);
    }
    forget();
    fault_shared_file_system = false;
    sqlite3_vfs_unregister(&layer);
    sqlite3_reset_auto_extension();
}

static void write_ahead_log(void)
{
    cut_sweeps(false);
}

static void rollback_journal(void)
{
    cut_sweeps(true);
}

/* ---- Files that Repose writes itself */

enum { MOST_SYNCED = 64 };

/* Of a process that is watched: what it synced, and what it did too early. */
static struct {
    long calls, kill_at, renames, early, n;
    ino_t loose; /* the folder that a file was last renamed into, until it is synced */
    struct {
        ino_t file;
        XXH64_hash_t hash;
    } synced[MOST_SYNCED];
} * seen;

static XXH64_hash_t hash_file(const char *path)
{
    scoped char *text = NULL;
    XXH64_hash_t hash = 0;
    if (rp_file_read(path, &text) == RP_OK) hash = XXH3_64bits(text, strlen(text));
    return hash;
}

static void note_sync(const struct stat *info, const char *path)
{
    long k = 0;
    while (k < seen->n && seen->synced[k].file != info->st_ino) k++;
    if (k == MOST_SYNCED) abort();
    if (k == seen->n) seen->n++;
    seen->synced[k].file = info->st_ino;
    seen->synced[k].hash = hash_file(path);
}

static void note_rename(const char *from, const char *to)
{
    char folder[256];
    struct stat info;
    if (stat(from, &info) != 0) return;
    bool synced = !S_ISREG(info.st_mode);
    for (long k = 0; k < seen->n; k++)
        synced |= seen->synced[k].file == info.st_ino && seen->synced[k].hash == hash_file(from);
    seen->renames++;
    seen->early += !synced;
    snprintf(folder, sizeof folder, "%s", to);
    char *slash = strrchr(folder, '/');
    if (slash) *slash = '\0';
    if (stat(slash ? folder : ".", &info) == 0) seen->loose = info.st_ino;
}

static void watch(const char *call, int descriptor, const char *from, const char *to)
{
    struct stat info;
    if (++seen->calls == seen->kill_at) raise(SIGKILL);
    if (to) note_rename(from, to);
    if (strcmp(call, "fsync") != 0 || fstat(descriptor, &info) != 0) return;
    if (S_ISREG(info.st_mode)) note_sync(&info, check_text("/proc/self/fd/%d", descriptor));
    if (S_ISDIR(info.st_mode) && info.st_ino == seen->loose) seen->loose = 0;
}

static void start_to_watch(void)
{
    fault_watch = watch;
}

/* Exit status of the program in a folder, or 128 and the signal; killed before its call number `kill_at`. */
static int run_in(const char *folder, const char *text, long kill_at)
{
    CU_ASSERT_FATAL(chdir(folder_path(base, folder)) == 0);
    memset(seen, 0, sizeof *seen);
    seen->kill_at = kill_at;
    const int end = run_forked(text, start_to_watch);
    CU_ASSERT(chdir(base) == 0);
    return end;
}

/* Of the tables that two folders have, those that are the same file by content; *n: all of the first. */
static int count_equal(const char *a, const char *b, int *n)
{
    int equal = 0;
    RP_ENDS(globfree) glob_t tables = {0};
    glob(check_text("%s/%s/d/*.tsv", base, a), 0, NULL, &tables);
    *n = (int)tables.gl_pathc;
    for (int k = 0; k < *n; k++) {
        const char *other = check_text("%s/%s/d/%s", base, b, strrchr(tables.gl_pathv[k], '/') + 1);
        equal += access(other, F_OK) == 0 && hash_file(other) == hash_file(tables.gl_pathv[k]);
    }
    return equal;
}

/* A folder with the files of `from` and what a run makes there. */
static void make_case(const char *name, const char *from)
{
    const char *line = check_text("rm -rf %s/%s && cp -r %s/%s %s/%s", base, name, base, from, base, name);
    CU_ASSERT(system(line) == 0);
}

/* A run that takes the place of a result, killed before each call that changes a folder: the old result or
 * the new one is whole, or where folders can't be exchanged for a moment none. The same command then ends
 * with the new one. */
static void replace_result(const char *options)
{
    int n, n_new, kills = 0;
    scoped char *old = strdup(check_text("run %s --every 2 -o d", options)),
                *new = strdup(check_text("run %s --every 1 -o d --force", options));
    make_case("old", "start");
    CU_ASSERT(run_in("old", old, 0) == 0);
    make_case("new", "start");
    CU_ASSERT(run_in("new", new, 0) == 0 && seen->renames > 1 && seen->early == 0 && seen->loose == 0);
    count_equal("new", "new", &n_new);
    CU_ASSERT(n_new >= 3 && count_equal("new", "old", &n) == 0);
    for (long k = 1;; k += check_fast() ? 5 : 1) {
        make_case("k", "old");
        const int end = run_in("k", new, k);
        if (end != 128 + SIGKILL) {
            CU_ASSERT(end == 0);
            break;
        }
        const int of_old = count_equal("k", "old", &n), of_new = count_equal("k", "new", &n);
        CU_ASSERT(of_old == n_new || of_new == n_new || (n == 0 && fault_shared_file_system));
        CU_ASSERT(run_in("k", new, 0) == 0);
        CU_ASSERT(count_equal("k", "new", &n) == n_new && n == n_new);
        CU_ASSERT(system(check_text("ls -d %s/k/d.* >/dev/null 2>&1", base)) != 0);
        kills++;
    }
    CU_ASSERT(kills > 2);
}

static void replaced_results(void)
{
    static const char scene[] = "dt = 1.0e-4; steps = 4; gravity = [0.0, -981.0];\n"
                                "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } );\n"
                                "particles = ( { x = 0.1; y = 0.1; r = 0.1; } );\n",
                      sweep[] = "protocol = \"pile\"; replicas = 2; fixed = { base = 4; };\n";
    seen = mmap(NULL, sizeof *seen, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    CU_ASSERT_FATAL(seen != MAP_FAILED);
    CU_ASSERT(mkdir(folder_path(base, "start"), 0777) == 0);
    file_print(folder_path(base, "start/scene.cfg"), "%s", scene);
    file_print(folder_path(base, "start/sweep.cfg"), "%s", sweep);
    for (int k = 0; k < 4; k++) {
        fault_shared_file_system = k % 2;
        fault_tick = 60.0; /* a snapshot at each look */
        replace_result(k < 2 ? "scene.cfg" : "sweep.cfg --row 1");
    }
    fault_shared_file_system = false, fault_tick = 0.0;
    munmap(seen, sizeof *seen);
}

CHECK_SUITE_WITHIN(power, "power", make_base, remove_base, write_ahead_log, rollback_journal,
                   replaced_results)
