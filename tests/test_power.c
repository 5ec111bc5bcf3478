/* Power cuts. The files that Repose writes itself are synced before they are renamed, and their folder
 * afterwards; what takes the place of a result does so at once. That committed rows stay is SQLite's promise.
 */
#include <glob.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "core/file.h"
#include "tests/faults.h"
#include "tests/program.h"

static char base[FOLDER_PATH];

static void make_base(void)
{
    folder_make_in_memory("power", base);
}

static void remove_base(void)
{
    folder_remove(base);
}

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

CHECK_SUITE_WITHIN(power, "power", make_base, remove_base, replaced_results)
