/* What people keep in and beside the program's folders: no command changes it. */
#include <gsl/gsl_rng.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include "core/file.h"
#include "core/folder.h"
#include "core/random.h"
#include "tests/program.h"

#define SCENE "steps = 4; gravity = [0.0, 0.0]; particles = ( { x = 0.0; y = 0.0; r = 0.1; } );\n"
#define FIT                                                                                                  \
    "fit = { k_x = [0.5, 2.0]; }; measured = ( { protocol = \"pile\"; of = \"D\"; value = 0.1; error = "     \
    "0.5; "                                                                                                  \
    "fixed = { base = 4; eps = 1e-2; }; } );\n"
#define SWEEP "protocol = \"pile\"; replicas = 2; fixed = { base = 4; };\n"

/* Make `what`, run the command, which is refused with this text, and compare what was made. */
static void refused(const char *what, const char *command, const char *text)
{
    const char *line = check_text(
        "rm -rf d side && mkdir d side && echo notes >side/notes && %s && cp -a d side before/", what);
    CU_ASSERT(shell("rm -rf before; mkdir before") == 0 && shell(line) == 0);
    FAILS(65, text, "%s", command);
    SHELL("diff -r --no-dereference d before/d >out && diff -r side before/side >out");
}

static void test_refusals(void)
{
    write_text("s.cfg", SCENE);
    write_text("w.cfg", SWEEP);
    GOOD("run s.cfg -o r");
    GOOD("sweep plan w.cfg -o w");
    GOOD("sweep make w.cfg -o w -j 1 --quiet");
    write_text("w2.cfg", SWEEP);
    write_text("f.cfg", FIT);
    SHELL("mkdir -p row/unfinished; no=$(printf %032d | tr 0 -); echo x >row/unfinished/snapshot; printf "
          "'repose folder 1\\nholds: \\n= %s unfinished\\n' $no >row/.repose; printf 'repose parts 1\\n"
          "holds: w.cfg row 1 (go)\\n- %s snapshot\\n' $no >row/unfinished/.repose");
    static const char *const cases[][3] = {
        {"cp -a row/. d", "pile -o d", "continue with the command that began it, of w.cfg row 1 (go)"},
        {"cp -a r/. d", "calibrate f.cfg -o d", "d: holds "},
        {"cp -a w/tables d", "sweep make w2.cfg -o d2 --tables d/tables",
         "d/tables/runs.tsv: of the sweep w; give another --tables, or --force"},
        {"cp -a row/. d", "run s.cfg -o d --force",
         "continue with the command that began it, of w.cfg row 1"},
        {"cp -a row/. d", "run --resume d", "the command that began it continues w.cfg row 1 (go)"},
        {"cp -a row/. d", "run --resume d/unfinished", "d/unfinished: belongs to the unfinished run in /"},
        {"cp -a row/. d", "pile -o d/unfinished/", "d/unfinished/: belongs to the unfinished run in /"},
        {"cp -a row/. d", "sweep plan w.cfg -o d/unfinished", "d/unfinished: belongs to the unfinished run"},
        {"cp -a row/. d", "export r --to csv -o d/unfinished/a",
         "d/unfinished: belongs to the unfinished run"},
        {"cp -a row/. d", "view r -o d/unfinished/a.svg", "d/unfinished: belongs to the unfinished run"},
        {"mkdir d/unfinished && echo a >d/unfinished/notes.txt", "run s.cfg -o d",
         "d/unfinished: not listed"},
        {"mkdir d/unfinished", "pile -o d", "d/unfinished: not listed"},
        {"ln -s ../side d/unfinished", "run s.cfg -o d --force", "d/unfinished: not listed"},
        {"echo mine >d/states.tsv", "run s.cfg -o d",
         "d/states.tsv: not listed as the program's own; move it away"},
        {"ln -s ../side/notes d/walls.tsv", "run s.cfg -o d --force", "d/walls.tsv: not listed"},
        {"echo mine >d/.repose", "run s.cfg -o d", "d/.repose: no marker of this version"},
        {"echo mine >d/lock", "sweep plan w.cfg -o d", "d/lock: not listed"},
        {"ln -s ../side/notes d/lock", "sweep plan w.cfg -o d --force", "d/lock: not listed"},
        {"echo mine >d/sweep.cfg", "sweep plan w.cfg -o d", "d/sweep.cfg: not listed"},
        {"cp -r r/. d", "run s.cfg -o d", "; give another folder, or --force to replace these results"},
        {"cp -r r/. d && cp d/walls.tsv d/contacts.tsv", "view d -o a.svg",
         "d/contacts.tsv: not what was written here"},
        {"cp -r r/. d && echo more >>d/states.tsv", "export d --to csv",
         "d/states.tsv: not what was written here"},
        {"cp -r r/. d && echo more >>d/energy.tsv", "run s.cfg -o d --force", "d/energy.tsv: changed since"},
        {"cp -r r/. d && rm d/walls.tsv && mkdir d/walls.tsv", "pile -o d --force", "d/walls.tsv: "},
        {"cp -r r/. d && rm d/walls.tsv && ln -s ../side/notes d/walls.tsv", "run s.cfg -o d --force",
         "d/walls.tsv: changed since"},
        {"echo id,x,y,r >d/a.csv", "export r --to csv -o d/a.csv", "d/a.csv: nothing in it shows"},
        {"echo 4 >d/a.xyz", "export r --to xyz -o d/a.xyz", "d/a.xyz: nothing in it shows"},
        {": >d/a.csv.gz", "export r --to csv -o d/a.csv.gz", "d/a.csv.gz: nothing in it shows"},
        {"echo '<?xml version=\"1.0\"?>' >d/a.pvd", "export r --to vtk -o d/a.pvd",
         "d/a.pvd: nothing in it shows"},
        {"echo '{' >d/a.json", "export r --to json -o d/a.json", "d/a.json: nothing in it shows"},
        {"echo 'see:# program: repose 1' >d/a.tsv", "sweep export w -o d/a.tsv",
         "d/a.tsv: nothing in it shows"},
        {"echo 'figure, written by repose view' >d/a.svg", "view r -o d/a.svg",
         "d/a.svg: nothing in it shows"},
        {"ln -s ../side/notes d/a.svg", "view r -o d/a.svg", "d/a.svg: a link; move it away"},
        {"echo mine >d/a.png", "view r -o d/a.png", "d/a.png: nothing in it shows"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) refused(cases[k][0], cases[k][1], cases[k][2]);
    FAILS(64, "\"steps=3\": one argument too many", "run s.cfg steps=3");
    FAILS(64, "\"more\": one argument too many", "sweep status r more");
    /* the same command again, and for another selection, also where a format has no header if the file system
     * has attributes; but not over what a person changed */
    static const char *const exports[] = {"csv -o a.csv",     "csv -o a.csv.gz", "json -o a.json",
                                          "lammps -o a.dump", "xyz -o a.xyz",    "vtk -o a.pvd"};
    write_text("n", "a");
    const bool signs = setxattr("n", "user.repose", "a", 1, 0) == 0;
    for (size_t k = 0; k < sizeof exports / sizeof *exports; k++)
        for (int again = 0; again < (signs ? 3 : 1); again++)
            GOOD("export r --to %s %s", exports[k], again == 2 ? "--where id=1" : "");
    SHELL("echo more >>a.csv");
    FAILS(65, "a.csv: nothing in it shows", "export r --to csv -o a.csv");
    /* of a finished result the marker has no name that is gone */
    GOOD("run s.cfg --every 2 --dump vtk -o v");
    SHELL("cd v/run_frames && test -e grains_000000.vtp && cut -c 36- .repose | sed 1,2d | while "
          "read name; do test -e \"$name\" || exit 1; done");
    /* patterns are names */
    GOOD("run s.cfg -o 'r[1]'");
    FAILS(65, "r[1]: holds s.cfg, 4 steps", "run s.cfg --set steps=3 -o 'r[1]'");
    /* an older process that was killed leaves no command to move a person's files */
    SHELL("mkdir d2 d2/unfinished.moving && echo a >d2/unfinished.moving/notes.txt && echo b >d2/notes.txt");
    GOOD("run s.cfg -o d2");
    SHELL("grep -q a d2/unfinished.moving/notes.txt && grep -q b d2/notes.txt");
}

/* Folders of sweeps: a link for the lock of a planned one, snapshots of another name. */
static void test_sweeps(void)
{
    write_text("w.cfg", SWEEP);
    SHELL(":>out; :>err; mkdir y1 y1/snapshots 'y?' && echo a >y1/snapshots/0123456789abcdef0123456789abcdef "
          "&& echo n >n");
    GOOD("sweep plan w.cfg -o 'y?'");
    CU_ASSERT(run("sweep run 'y?' -j 1 --quiet") == 0);
    SHELL("test -s y1/snapshots/0123456789abcdef0123456789abcdef && ! test -e 'y?/snapshots'");
    SHELL("mkdir 'y?/snapshots' && echo a >'y?/snapshots/photo.png' && rm 'y?/lock' && ln -s ../n 'y?/lock'");
    FAILS(65, "y?/lock: not made by this program; move it away", "sweep run 'y?'");
    SHELL("rm 'y?/lock' && mv 'y?/snapshots' s && ln -s ../s 'y?/snapshots'");
    GOOD("sweep plan w.cfg --replicas 3 -o 'y?'");
    FAILS(65, "y?/snapshots: no folder of this program", "sweep run 'y?'");
    /* a salvage without room leaves all as it was */
    SHELL("cp -a 'y?' before && cd 'y?' && { ulimit -f 8; \"$REPOSE\" sweep salvage . >../out 2>&1; test $? "
          "= 74; }");
    SHELL("cp -a 'y?'/store.sqlite-shm before 2>/dev/null; diff -r 'y?' before");
    SHELL("test \"$(cat n)\" = n && test \"$(ls s)\" = photo.png");
    SHELL("rm 'y?/snapshots' && mv s 'y?/snapshots'");
    CU_ASSERT(run("sweep run 'y?' -j 1 --quiet") == 0);
    SHELL("test \"$(ls 'y?/snapshots')\" = photo.png");
}

/* ---- 400 folders ---- */

static gsl_rng *chance;

static size_t draw(size_t n)
{
    return gsl_rng_uniform_int(chance, n);
}

/* What is a person's: a file with these bytes, a link with this target, or a folder. */
typedef struct {
    char path[128], text[64];
    mode_t type;
} thing;

enum { MOST_THINGS = 12 };
static struct {
    size_t n;
    thing of[MOST_THINGS];
} mine;

static bool is_same(const thing *t)
{
    struct stat info;
    char text[128] = "";
    if (lstat(t->path, &info) != 0 || (info.st_mode & S_IFMT) != t->type) return false;
    if (t->type == S_IFLNK) return readlink(t->path, text, sizeof text - 1) > 0 && strcmp(text, t->text) == 0;
    if (t->type == S_IFDIR) return true;
    size_t n;
    scoped char *bytes = file_read(t->path, &n);
    return n == strlen(t->text) && memcmp(bytes, t->text, n) == 0;
}

/* May a person's thing stand there: in a folder, no link to one, under a name that is not the program's? */
static bool is_free(const char *path)
{
    char *marker = NULL;
    const char *name = strrchr(path, '/') + 1, *folder = check_text("%.*s", (int)(name - path) - 1, path);
    struct stat info;
    if (lstat(path, &info) == 0 || lstat(folder, &info) != 0 || !S_ISDIR(info.st_mode)) return false;
    const bool is_own = rp_file_read(folder_path(folder, ".repose"), &marker) == RP_OK &&
                        strstr(marker, check_text(" %s\n", name));
    free(marker);
    return !is_own;
}

/* Put something where nothing is. A reserved name is never an empty file. */
static void put(const char *path, size_t kind, bool reserved)
{
    static const char *const targets[] = {"../side/notes", "../side", "nowhere", "../side/none"};
    thing t = {.type = kind == 0 ? S_IFDIR : kind == 1 ? S_IFLNK : S_IFREG};
    if (mine.n == MOST_THINGS || !is_free(path)) return;
    snprintf(t.path, sizeof t.path, "%s", path);
    if (t.type == S_IFDIR && mkdir(path, 0777) != 0) return;
    if (t.type == S_IFLNK) {
        snprintf(t.text, sizeof t.text, "%s", targets[draw(4)]);
        if (symlink(t.text, path) != 0) return;
    }
    if (t.type == S_IFREG) {
        if (reserved || draw(4) > 0) snprintf(t.text, sizeof t.text, "mine %zu\n\001\377\n", draw(1000));
        file_write(path, t.text, strlen(t.text));
    }
    mine.of[mine.n++] = t;
}

/* One of each in a line; the last four are never empty files. */
static const char names[] =
    "states.tsv\nenergy.tsv\ncontacts.tsv\nunfinished\nunfinished.moving\nunfinished.moving/notes.txt\nlock\n"
    "sweep.cfg\nsnapshots\nshards\nrun.xyz\nrun.pvd\nrun_frames\nbase.tsv\ndisks.tsv\nwells.tsv\nscene.cfg\n"
    ".repose\narray.sh\npic.svg\nruns.tsv\nw.tsv\ndamaged.sqlite\nnotes [1].txt\n*\n?\n-x\n"
    "unfinished/notes.txt\nunfinished/states.tsv\nunfinished/snapshot\nsnapshots/photo.png\n"
    "snapshots/0123456789abcdef0123456789abcdef\nrun_frames/mine.vtp\nrun_frames/grains_000000.vtp\n"
    "shards/mine\nshards/1-of-2.sqlite.lock\nstore.sqlite\n.repose.new\nunfinished/.repose.new\n"
    "store.sqlite-wal";
enum { N_NAMES = 40, RESERVED = N_NAMES - 4 };

static rlim_t most_bytes; /* of a file of the program, unless 0 */

static void limit_files(void)
{
    if (most_bytes > 0) setrlimit(RLIMIT_FSIZE, &(struct rlimit){most_bytes, most_bytes});
}

/* The program in this process's folder; `most` bytes a file, unless 0. */
static void run_words(const char *text, rlim_t most)
{
    most_bytes = most;
    const int end = run_forked(text, limit_files);
    CU_ASSERT(end < 128 && end != 99 && end != 70);
}

static void test_random_folders(void)
{
    static const char *const starts[] = {"mkdir d", "cp -a run d", "cp -a pile d", "cp -a sweep d",
                                         "cp -a stopped d"};
    static const char *const commands[] = {"run s.cfg -o d",
                                           "run s.cfg -o d --force",
                                           "run s.cfg -o d --force --dump vtk",
                                           "run s.cfg -o d --snapshot 1 --dump xyz",
                                           "run --resume d",
                                           "run w.cfg --row 1 -o d",
                                           "run w.cfg -o d --force",
                                           "pile --base 4 -o d",
                                           "pile --base 4 -o d --force",
                                           "sweep plan w.cfg -o d",
                                           "sweep plan v.cfg -o d --force",
                                           "sweep run d -j 1",
                                           "sweep run d -j 1 --shard 1/2",
                                           "sweep merge d",
                                           "sweep slurm d --shards 2",
                                           "sweep salvage d",
                                           "sweep export d -o d/runs.tsv",
                                           "sweep make w.cfg -o d -j 1 --tables d",
                                           "export d --to csv -o d/runs.tsv",
                                           "export d --to vtk -o d/run.pvd",
                                           "export d --to xyz -o d/run.xyz",
                                           "view d -o d/pic.svg",
                                           "calibrate fit.cfg -o d -j 1 --budget 24"};
    enum { N = sizeof commands / sizeof *commands };
    const size_t rounds = check_fast() ? 60 : 400;
    char base[FOLDER_PATH];
    folder_make_in_memory("folders", base);
    CU_ASSERT_FATAL(chdir(base) == 0);
    file_print("s.cfg", "%s", SCENE);
    file_print("w.cfg", "%s", SWEEP);
    file_print("v.cfg", "%s", SWEEP);
    file_print("fit.cfg", "%s", FIT);
    run_words("run s.cfg -o run --dump vtk", 0);
    run_words("pile --base 4 -o pile", 0);
    run_words("sweep plan w.cfg -o sweep", 0);
    run_words("run s.cfg --every 1 --set steps=4000 --snapshot 100 -o stopped", 9000);
    CU_ASSERT(access("stopped/unfinished/snapshot", F_OK) == 0);
    chance = rp_random_alloc(36, 1, RP_PURPOSE_TEST);
    size_t kept = 0;
    for (size_t k = 0; k < rounds; k++) {
        const char *line[2];
        const size_t start = draw(5);
        CU_ASSERT(system(check_text("rm -rf d side && mkdir side && echo notes >side/notes && %s",
                                    starts[start])) == 0);
        mine.n = 0;
        put("side/none", 0, false);
        strcpy(mine.of[mine.n].path, "side/notes");
        strcpy(mine.of[mine.n].text, "notes\n");
        mine.of[mine.n++].type = S_IFREG;
        /* one of the program's finished files may have become a person's */
        if (start == 1 && draw(3) == 0) unlink("d/contacts.tsv");
        if (start == 1 && draw(3) == 0) unlink("d/run_frames/grains_000000.vtp");
        for (size_t n = 1 + draw(6); n > 0; n--) {
            const size_t i = draw(N_NAMES);
            const char *from = names;
            char name[128] = "";
            for (size_t at = 0; at <= i; at++) CU_ASSERT_FATAL(check_word(&from, "\n", name));
            CU_ASSERT((*from == '\0') == (i == N_NAMES - 1)); /* the list has as many */
            put(folder_path("d", name), draw(4), i >= RESERVED);
        }
        kept += mine.n;
        for (size_t n = 0; n < 2; n++) run_words(line[n] = commands[draw(N)], 0);
        for (const thing *t = mine.of; t < mine.of + mine.n; t++)
            CHECK_OR_SAY(is_same(t), "%zu: %s of \"%s\" changed by %s; %s", k, t->path, starts[start],
                         line[0], line[1]);
        CU_ASSERT(rmdir("side/none") == 0 && unlink("side/notes") == 0 &&
                  rmdir("side") == 0); /* and no more */
    }
    CU_ASSERT(kept > 4 * rounds);
    gsl_rng_free(chance);
    CU_ASSERT(chdir("/") == 0);
    folder_remove(base);
}

/* One process is killed while a result takes its place, and the next one in the run after it. */
static void test_killed_twice(void)
{
    rp_folder f, stage;
    bool moved;
    write_text("s.cfg", SCENE);
    GOOD("run s.cfg -o k");
    SHELL("no=$(printf %032d | tr 0 -); printf -- '- %s old.tsv\n= %s unfinished\n' $no $no >>k/.repose");
    CU_ASSERT(rp_folder_enter(path_of("k"), &f) == RP_OK && rp_folder_settle(&f, &moved) == RP_OK && moved);
    CU_ASSERT(rp_folder_stage(&f, true, &stage) == RP_OK);
    rp_folder_close(&stage);
    rp_folder_close(&f);
    GOOD("run s.cfg -o k --force");
}

CHECK_SUITE_WITHIN(folders, "folders", enter, leave, test_refusals, test_killed_twice, test_sweeps,
                   test_random_folders)
