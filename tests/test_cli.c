/* The program from the shell: exit statuses, one message that names the fault, values on standard output, and
 * a sweep from its file to its digest. The environment variable REPOSE names the program. */
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <sys/ptrace.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/clock.h"
#include "cli/derive/derive.h"
#include "tests/protocol.h"
#include "tests/numbers.h"
#include "tests/faults.h"
#include "tests/program.h"

/* Closed forms take a few operations on numbers up to 180. */
#define FORM_TOLERANCE (16.0 * 180.0 * 0x1p-53)

/* Measured after a fixed time, which is sooner than rest. */
#define SHORT_RUN "W = 2.0; H = 2.0; stop = \"steps\"; fill_steps = 2500; relax_steps = 1500;"

/* ---- help ---- */

/* Does an option say that it is required, or its default? Those of texts that may be left out say neither. */
static bool is_whole(const rp_param *p)
{
    static const char *const without[] = {"where", "set",   "o",     "outline", "disks", "from",
                                          "color", "shard", "start", "x",       "y"};
    const size_t length = strlen(p->name);
    bool whole = p->type == RP_BOOL || !p->fallback || *p->fallback;
    for (size_t k = 0; k < sizeof without / sizeof *without; k++) whole |= strcmp(p->name, without[k]) == 0;
    return whole &&
           (length < 4 || strcmp(p->name + length - 4, "_deg") != 0 || strncmp(p->unit, "deg", 3) == 0);
}

/* Options are whole, and examples valid, except for missing files. The suite `help` has the whole texts. */
static void check_commands(const cli_command *const *c)
{
    for (; *c; c++) {
        if ((*c)->group) {
            check_commands((*c)->group);
            continue;
        }
        const rp_param *lists[] = {(*c)->protocol, (*c)->options ? (*c)->options() : NULL};
        for (size_t k = 0; k < 2; k++)
            for (const rp_param *p = lists[k]; p && p->name; p++)
                CHECK_OR_SAY(is_whole(p), "repose %s: option %s", (*c)->name, p->name);
        CU_ASSERT(strstr((*c)->example, check_text("repose %s", (*c)->name)) == (*c)->example);
        if (strcmp((*c)->name, "bench") == 0) continue; /* takes seconds */
        const int status = run("%s", (*c)->example + strlen("repose "));
        CHECK_OR_SAY(status == RP_OK || status == RP_BAD_INPUT || status == RP_IO, "%s: exit status %d, %s",
                     (*c)->example, status, err);
    }
}

/* Addresses at random, tables of the linker read-only. */
static void test_hardened(void)
{
    static const char *const marks[] = {"DYN (Position-Independent", "GNU_RELRO", "BIND_NOW"};
    if (CHECK_SKIPS("sanitizers have flags of their own")) return;
    SHELL("readelf -hldW \"$REPOSE\" >out 2>err");
    for (size_t i = 0; i < sizeof marks / sizeof *marks; i++) CU_ASSERT_PTR_NOT_NULL(strstr(out, marks[i]));
}

static void test_help(void)
{
    write_text("scene.cfg", "steps = 2; fill = { N = 3; W = 1.0; H = 1.0; };\n");
    check_commands(cli_repose.commands);
    GOOD("--help");
    for (const cli_command *const *c = cli_repose.commands; *c; c++)
        CU_ASSERT_PTR_NOT_NULL(strstr(out, (*c)->name));
    GOOD("--version");
    CU_ASSERT(strncmp(out, "repose ", 7) == 0);
    CU_ASSERT(run("%s", "") == RP_USAGE && out[0] == '\0' && strstr(err, "usage: repose COMMAND") &&
              !strstr(err, "\nrepose: "));
}

/* ---- bad input ---- */

static void test_wrong_usage(void)
{
    static const failure list[] = {
        {64, "unknown command \"frob\"", "frob"},
        {64, "t: given twice", "stats fit a t t -x x -y y"},
        {64, "unknown command \"frob\"", "angle frob"},
        {64, "--threshold can't be combined with --o; it allows the outline",
         "pile --base 9 --eps 1e-4 --threshold -o d"},
        {64, "angle --help", "angle"},
        {64, "unknown command \"frob\"", "sweep frob"},
        {64, "sweep --help", "sweep"},
        {64, "unknown command \"calibrat\" (did you mean \"calibrate\"?)", "calibrat"},
        {64, "unknown command \"staus\" (did you mean \"status\"?); see repose sweep --help", "sweep staus"},
        {64, "unknown command \"trnd\" (did you mean \"trend\"?); see repose stats --help",
         "help stats trnd"},
        {64, "unknown option --frob", "lattice --frob 3"},
        {64, "unknown option --layres (did you mean --layers?)", "lattice --layres 3"},
        {64, "unknown option --alhpa-deg=3 (did you mean --alpha-deg?)", "lattice --alhpa-deg=3"},
        {64, "unknown option -J (did you mean -j?)", "sweep run d -J 2"},
        {64, "unknown option --J (did you mean -j?)", "sweep run d --J 2"},
        {64, "unknown option --quiet=1",
         "sweep run d --quiet=1"}, /* no value; the first option, and a later one */
        {64, "unknown option -q", "sweep run d -q"},
        {64, "unknown option -q", "sweep export d --reduce -qz"},
        {64, "unknown option -j; see repose sweep export --help", "sweep export d -j2"},
        {64, "unknown option -j; see repose lattice --help", "lattice -j 2"},
        {64, "option --layers needs a value", "lattice --layers"},
        {64, "option -o needs a value", "sweep plan s.cfg -o"},
        {64, "--alpha-deg is required", "continuum"},
        {64, "--x1 is required", "tent --outer-deg 30 --inner-deg 45"},
        {64, "repose sweep: -o is required", "sweep plan s.cfg"},
        {64, "--points or --at", "continuum --alpha-deg 30 --points 5 --at 0.1"},
        {64, "--layers, or --base", "lattice --layers 5 --base 5 --alpha-deg 30"},
        {64, "--alpha-deg needs --base", "lattice --layers 5 --alpha-deg 30"},
        {64, "--layers, or --base", "lattice --alpha-deg 30"},
        {64, "--base needs --alpha-deg", "lattice --base 5"},
        {64, "usage: repose lattice", "lattice --layers 5 6"},
        {64, "usage: repose angle slope FILE", "angle slope --width 4"},
        {64, "usage: repose run SCENE.cfg", "run"},
        {64, "-o is empty; leave it out", "run s.cfg -o ''"}};
    CHECK_FAILURES(list);
}

/* ---- killed ---- */

/* Start the program with these words, and kill it at the entry of its k-th call that changes files, from 1;
 * true if it came to that call. */
static bool kill_at(long k, char *const words[])
{
    static const unsigned long calls[] = {SYS_write,     SYS_pwrite64, SYS_ftruncate, SYS_fsync,
                                          SYS_fdatasync, SYS_mkdirat,  SYS_renameat2, SYS_unlinkat,
#ifdef SYS_mkdir /* older calls that some processors have */
                                          SYS_mkdir,     SYS_rename,   SYS_unlink
#endif
    };
    int end = 0;
    char program[PATH_MAX];
    const char *folder = path_of(".");
    CU_ASSERT_PTR_NOT_NULL_FATAL(realpath(getenv("REPOSE"), program));
    const pid_t child = fork();
    if (child == 0) {
        if (chdir(folder) != 0 || !freopen("out", "w", stdout) || !freopen("err", "w", stderr)) _exit(126);
        setenv("ASAN_OPTIONS", "detect_leaks=0", 1);
        ptrace(PTRACE_TRACEME, 0, NULL, NULL);
        execv(program, words);
        _exit(127);
    }
    while (waitpid(child, &end, 0) == child && WIFSTOPPED(end)) {
        struct __ptrace_syscall_info call = {0};
        ptrace(PTRACE_SETOPTIONS, child, NULL, PTRACE_O_TRACESYSGOOD);
        ptrace(PTRACE_GET_SYSCALL_INFO, child, sizeof call, &call);
        bool changes = call.entry.nr == SYS_openat && call.entry.args[2] & O_CREAT;
        for (size_t i = 0; i < sizeof calls / sizeof *calls; i++) changes |= call.entry.nr == calls[i];
        if (call.op == PTRACE_SYSCALL_INFO_ENTRY && changes && --k == 0) kill(child, SIGKILL);
        ptrace(PTRACE_SYSCALL, child, NULL, NULL);
    }
    return WIFSIGNALED(end);
}

/* A sweep is planned, and planned again for more runs, by a process that is killed at any of its calls: the
 * same command then does it. A shard that is killed so does not keep the others from being read. */
static void test_killed_plans(void)
{
    static char *const first[] = {"repose", "sweep", "plan", "s.cfg", "-o", "d", NULL},
                       *const more[] = {"repose", "sweep",      "plan", "s.cfg", "-o",
                                        "d",      "--replicas", "3",    NULL},
                       *const shard[] = {"repose", "sweep", "run", "d", "-j", "1", "--shard", "1/2", NULL};
    static const struct {
        const char *before, *after;
        char *const *words;
        long step;
    } cases[] = {{"rm -rf d", "\"$REPOSE\" sweep plan s.cfg -o d", first, 1},
                 {"rm -rf d && cp -r made d", "\"$REPOSE\" sweep plan s.cfg -o d --replicas 3", more, 4},
                 {"rm -rf d && cp -r half d",
                  "\"$REPOSE\" sweep run d -j 1 --shard 1/2 && \"$REPOSE\" sweep merge d", shard, 7}};
    write_text("s.cfg", "protocol = \"pile\"; replicas = 2; fixed = { base = 4; };\n");
    GOOD("sweep plan s.cfg -o made");
    SHELL("cp -r made half; for d in made 'half --shard 2/2'; do \"$REPOSE\" sweep run $d -j 1 >out "
          "2>err || exit 1; done");
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        long k = 0;
        for (bool killed = true; killed; k += killed ? cases[c].step : 0) {
            CU_ASSERT_FATAL(shell_line("%s >out 2>err", cases[c].before) == 0);
            killed = kill_at(k + 1, cases[c].words);
            if (c > 0) SHELL("\"$REPOSE\" sweep status d >out 2>err");
            const int status = shell_line("{ %s && \"$REPOSE\" sweep status d; } >out 2>err", cases[c].after);
            CHECK_OR_SAY(status == 0, "killed at call %ld of %s: %s", k + 1, cases[c].words[2], err);
        }
        CU_ASSERT(k > 20);
    }
}

/* Suite options has what an option does not take. */
static void test_bad_values(void)
{
    static const failure list[] = {
        {65, "--at: \",0.2\": numbers", "continuum --alpha-deg 30 --at 0.1,,0.2"},
        {65, "--at: \"0.1x\": numbers", "continuum --alpha-deg 30 --at 0.2,0.1x"},
        {65, "--at: \"0.1;1\": numbers", "continuum --alpha-deg 30 --at '0.1;1'"},
        {65, "--at: \"inf\": numbers", "continuum --alpha-deg 30 --at 0.1,inf"},
        {65, "--at: \"nan,1\": numbers", "continuum --alpha-deg 30 --at nan,1"},
        {65, "x/B = 1.5: out of range, allowed: [0, 1]", "continuum --alpha-deg 30 --at 0.1,1.5"},
        {65, "x/B = -0.5: out of range, allowed: [0, 1]", "continuum --alpha-deg 30 --at -0.5,0.1"},
        {65, "x/B = 1.25: out of range, allowed: [0, 1]", "continuum --alpha-deg 30 --at 1.25,0.1"},
        {65, "none.tsv: cannot read", "angle slope none.tsv --width 4"},
        {65, "none.tsv: cannot read", "angle compare none.tsv"},
        {65, "none.tsv: cannot read", "stats fit none.tsv -x a -y b --se c"},
        {65, "short.tsv:2", "angle slope short.tsv --width 4"},
        {65, "empty.tsv: no grains", "angle slope empty.tsv --width 4"},
        {65, "none.cfg: cannot read", "run none.cfg"},
        {65, "none.cfg: cannot read", "sweep plan none.cfg -o d"},
        {65, "none: no such folder", "sweep run none"},
        {65, "none/sweep.cfg: cannot read", "sweep status none"},
        {65, "none/sweep.cfg: cannot read", "sweep export none"},
        {65, "none/sweep.cfg: cannot read", "sweep digest none"}};
    write_text("short.tsv", "1 2 0.1\n1 2\n");
    write_text("empty.tsv", "# units: cm\tcm\n# x\ty\n");
    CHECK_FAILURES(list);
}

/* Each look at the processor time is a second later, at that of the wall a thousand. */
static void tick(void)
{
    fault_tick = 1.0, fault_monotonic_tick = 1000.0;
}

/* Times of a bench are those of the processor, of several threads those of the wall; the suite `columns` has
 * its numbers. */
static void test_bench(void)
{
    write_text("start.tsv", "# x\ty\tr\n0.1\t0.1\t0.1\n0.3\t0.1\t0.1\n0.2\t0.274\t0.1\n");
    write_text("short.tsv", "# x\ty\n0.1\t0.1\n");
    static const char *const words[] = {"bench --start start.tsv --steps 70 --repeat 3",
                                        "bench -n 100 --steps 10 --repeat 1 -j 1",
                                        "bench -n 100 --steps 10 --repeat 1 -j 2"};
    static const double rates[] = {3.0 * 70.0 / 1e6, 100.0 * 10.0 / 1e6, 100.0 * 10.0 / 1e9};
    for (int k = 0; k < 3; k++) {
        CU_ASSERT(run_begun(words[k], tick) == 0);
        scoped_table t = read_table("out");
        CHECK_NEAR(cell(&t, 0, "median"), rates[k], 1e-12 * rates[k]);
        CU_ASSERT(cell(&t, 0, "seconds") >= 1000.0 && fmod(cell(&t, 0, "seconds"), 1000.0) == 0.0);
    }
    FAILS(65, "none.tsv: cannot read", "bench --start none.tsv");
    FAILS(65, "no column \"r\"", "bench --start short.tsv");
    FAILS(65, "mu_roll = 0.1: needs rotation", "bench --mu-roll 0.1");
}

#define GRAIN "{ x = 0.1; y = 0.2; r = 0.1; }"

/* The suite `scene` has what else is refused. */
static void test_bad_scenes(void)
{
#define SCENE " walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } ); particles = ( " GRAIN " );"
    static const char *const list[][2] = {{"frob = 3;" SCENE, "s.cfg:1: frob: unknown key"},
                                          {"dt = 1.0e-2;" SCENE, "the limit is "},
                                          {"particles_file = \"/dev/zero\";", "/dev/zero: no text"}};
    CHECK_REFUSED(list, "s.cfg", "run s.cfg -o made");
    write_text("s.cfg", "particles = ( " GRAIN " );\n");
    static const failure changes[] = {
        {64, "--row needs a sweep", "run s.cfg --row 1"},
        {65, "frob: unknown key", "run s.cfg --set frob=1"},
        {65, "steps = 4294967396: out of range", "run s.cfg --set steps=4294967396"},
        {65, "steps = \"5; dt = 6\"", "run s.cfg --set 'steps=5; dt = 6'"}};
    CHECK_FAILURES(changes);
    /* entries of lists, and lists as values */
    write_text("s.cfg", "steps = 10; particles = ( " GRAIN " );\n"
                        "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; },\n"
                        "{ point = [0.0, 0.0]; direction = [1.0, 0.0]; velocity = [0.0, 0.0]; } );\n");
    FAILS(65, "walls is a list of 2 entries", "run s.cfg --set 'walls[1x].mu=1'");
    FAILS(65, "steps has no keys of its own", "run s.cfg --set 'steps.mu=1'");
    FAILS(65, "did you mean \"omega\"", "run s.cfg --set 'walls[1].omeg=3'");
    GOOD("run s.cfg --set 'walls[1].omega=3' --set 'walls[1].velocity=[1/2, 0]' --set 'gravity=[0, -1]' "
         "--set 'steps=2*(4 + 1)' -o set");
    scoped_table walls = read_table("set/walls.tsv"), grains = read_table("set/states.tsv");
    CHECK_NEAR(cell(&walls, 0, "direction_y"), 1.0, 0.0);
    CHECK_EACH(cell(&walls, 1, NAME), 1e-12, {"x", 0.5 * 10 * 5e-5}, {"direction_y", sin(3.0 * 10 * 5e-5)});
    CHECK_NEAR(cell(&grains, 0, "vy"), -1.0 * 10 * 5e-5, 1e-12);
    SHELL("! test -e made"); /* no output before the scene is valid */
}

/* Scenes and sweeps are files of the same syntax: each command says which command takes the other. */
static void test_sweep_or_scene(void)
{
    write_text("scene.cfg", "fill = { N = 4; W = 1.0; H = 1.0; };\n");
    write_text("sweep.cfg", "protocol = \"pile\"; replicas = 1;\n");
    write_text("tables.cfg", "model = ( { table = \"a\"; with = \"tent\"; } );\n");
    FAILS(65, "scene.cfg: a scene (it has fill), no sweep; repose run", "sweep plan scene.cfg -o d");
    FAILS(65, "scene.cfg: a scene (it has fill), no sweep; repose run", "sweep make scene.cfg -o d");
    FAILS(64, "scene.cfg is a scene", "run scene.cfg --row 1 -o d");
    FAILS(64, "sweep.cfg is a sweep file; repose run sweep.cfg --row N -o DIR", "run sweep.cfg");
    FAILS(64, "repose sweep make sweep.cfg -o DIR makes all", "run sweep.cfg --row 0");
    FAILS(65, "tables.cfg is a sweep file with models only; repose sweep make", "run tables.cfg -o d");
}

/* The suite `sweep` has what else is refused. */
static void test_bad_sweeps(void)
{
#define REPOSE "protocol = \"repose\"; seed = 1; replicas = 1; "
    static const char *const list[][2] = {
        {REPOSE "fixed = { frob = 1; };", "frob: unknown key"},
        {REPOSE "fixed = { dt = 1.0e-3; };", "the limit is "},
        {REPOSE "fixed = { slip = \"total\"; };", "needs stop = \"steps\""}};
    CHECK_REFUSED(list, "s.cfg", "sweep plan s.cfg -o d");
    SHELL("! test -e d");
    write_text("s.cfg", "protocol = \"repose\"; replicas = 2; seed = 1;\n");
    FAILS(64, "--row N -o DIR", "run s.cfg");
    FAILS(64, "-j and --set need a scene", "run s.cfg --set mu=0.3 -o d");
    FAILS(64, "-j and --set need a scene", "run s.cfg -j 2 -o d");
    FAILS(65, "row = 2: out of range, allowed: [0, 1]", "run s.cfg --row 2 -o d");
    GOOD("sweep plan s.cfg -o d");
    FAILS(1, "missing", "sweep digest d");
}

static void test_broken_output(void)
{
    static const failure list[] = {
        {74, "file/d", "sweep plan s.cfg -o file/d"},
        {74, "file/t.tsv", "sweep export d -o file/t.tsv"},
        {65, "d/store.sqlite: is there; give another name", "sweep export d -o ./d/store.sqlite"},
        {74, "file/d", "run scene.cfg -o file/d"},
        {65, "file: not a folder", "run scene.cfg -o file"},
        {74, "file/d", "run s.cfg -o file/d"},
        {74, "garbage/store.sqlite: file is not a database", "sweep run garbage"},
        {74, "garbage/store.sqlite: file is not a database", "sweep status garbage"},
        {74, "garbage/store.sqlite: file is not a database", "sweep export garbage"},
        {74, "garbage/store.sqlite: file is not a database", "sweep digest garbage"},
        {74, "garbage/store.sqlite: file is not a database", "sweep plan s.cfg -o garbage"}};
    const char *writers =
        "--help\n--version\nlattice --help\nsweep --help\nangle --help\nlattice --layers 5\n"
        "lattice --layers 5000\n" /* more than a buffer */
        "continuum --alpha-deg 30\ntent --outer-deg 30 --inner-deg 45 --x1 0.38\n"
        "angle marginal --mu 0.2\nangle tilt --mu 0.2 --theta-r-deg 18\nrun scene.cfg\n"
        "sweep status d\nsweep export d\nbench -n 3 --steps 10\nparams";
    write_text("file", "a file where a folder is expected\n");
    write_text("scene.cfg", "steps = 2; fill = { N = 3; W = 1.0; H = 1.0; };\n");
    write_text("s.cfg", "protocol = \"repose\"; replicas = 2; seed = 1;\n");
    GOOD("sweep plan s.cfg -o d");
    GOOD("sweep plan s.cfg -o garbage");
    write_text("garbage/store.sqlite", "%4000s", "not a data base");
    CHECK_FAILURES(list);
    /* a limit of the file's size is a failed write, and no half table stays */
    SHELL_FAILS(74, "File too large",
                "ulimit -f 1; exec \"$REPOSE\" run scene.cfg --every 1 --set steps=99 -o full >out 2>err");
    SHELL("! test -e full");
    slurp("file", out, sizeof out);
    CU_ASSERT_STRING_EQUAL(out, "a file where a folder is expected\n");
    slurp("garbage/store.sqlite", out, sizeof out);
    CU_ASSERT(strlen(out) == 4000);
    for (char words[128]; check_word(&writers, "\n", words);)
        /* the reason is lost for an output longer than its buffer */
        FAILS(74, "cannot write: ", "%s >/dev/full", words);
}

/* ---- values ---- */

static void test_angles(void)
{
    /* half a unit of the last printed digit */
    const double printed = 5e-4;
    const double t18 = tan(18.0 * deg), phi = atan(0.2);
    const struct {
        const char *form;
        double theta_t, tolerance, limit;
    } forms[] = {
        {"balanced", 4.834, printed, 42.0},
        {"printed", 3.533, printed, 30.0},
        {"sine", 0.5 * (phi - 18.0 * deg - asin(cos(120.0 * deg) * sin(phi + 18.0 * deg))) / deg, 1e-9, 42.0},
        {"lattice", atan((0.2 - t18 / 3.0) / (1.0 - 0.2 * t18)) / deg, 1e-9, 90.0}};
    scoped_table t = {0};
    AGAIN_OF(t, "angle marginal --mu 0.2");
    CHECK_NEAR(cell(&t, 0, "theta_ms_deg"), atan(0.6) / deg, FORM_TOLERANCE);
    CU_ASSERT_STRING_EQUAL(word(&t, 0, "status"), "ok");
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        AGAIN_OF(t, "angle tilt --mu 0.2 --theta-r-deg 18 --form %s", forms[i].form);
        CHECK_NEAR(cell(&t, 0, "theta_t_deg"), forms[i].theta_t, forms[i].tolerance);
        CHECK_EACH(cell(&t, 0, NAME), FORM_TOLERANCE, {"margin_deg", atan(0.6) / deg - 18.0},
                   {"theta_ms_deg", atan(0.6) / deg}, {"limit_deg", forms[i].limit});
        CU_ASSERT_STRING_EQUAL(word(&t, 0, "status"), "ok");
    }
    AGAIN_OF(t, "angle marginal --mu 0.2 --phi-deg 50"); /* tan theta_MS = mu tan^2 phi */
    const double marginal = atan(0.2 * pow(tan(50.0 * deg), 2.0)) / deg;
    CHECK_NEAR(cell(&t, 0, "theta_ms_deg"), marginal, FORM_TOLERANCE);
    AGAIN_OF(t, "angle tilt --mu 0.2 --theta-r-deg 10 --phi-deg 50");
    CHECK_NEAR(cell(&t, 0, "margin_deg"), marginal - 10.0, FORM_TOLERANCE);
    AGAIN_OF(t, "angle tilt --mu 0.2 --theta-r-deg 38.5");
    CU_ASSERT_STRING_EQUAL(word(&t, 0, "theta_t_deg"), "nan");
    CHECK_NEAR(cell(&t, 0, "margin_deg"), atan(0.6) / deg - 38.5, FORM_TOLERANCE);
    CU_ASSERT_STRING_EQUAL(word(&t, 0, "status"), "already_unstable");
    char *first = strstr(out, "nan");
    CU_ASSERT(first && !strstr(first + 1, "nan"));
    /* no theory means no result, in the row too */
    FAILS(1, "theta-r-deg = 65", "angle tilt --mu 2 --theta-r-deg 65");
    CU_ASSERT(strstr(out, "rays_miss") != NULL);
}

/* An outline of 25 degrees in whole pixels, as traced from a photograph: every pixel, or 21 points. */
static void test_outline(void)
{
    for (int step = 1; step <= 20; step += 19) {
        FILE *file = file_of("outline.csv");
        fputs("x,y\n", file);
        for (int x = 0; x <= 400; x += step + (step > 1 && x % 3 == 0))
            fprintf(file, "%d,%.0f\n", x, round(220.0 - tan(25.0 * deg) * x));
        fclose(file);
        scoped_table t = TABLE_OF("angle slope outline.csv");
        for (size_t i = 0; i < t.n_rows; i++) {
            CHECK_NEAR(cell(&t, i, "theta_deg"), 25.0, 3.0 * cell(&t, i, "theta_se_deg"));
            CU_ASSERT(cell(&t, i, "theta_se_deg") < 1.0);
        }
    }
    /* the same picture with its rows counted from the top: the angles agree but for their last bits */
    SHELL("awk -F, 'NR > 1 { $2 = 480 - $2 } { print $1 \",\" $2 }' outline.csv >rows.csv");
    scoped_table up = read_table("out");
    scoped_table down = TABLE_OF("angle slope rows.csv --y-axis down");
    for (size_t i = 0; i < 3; i++) CHECK_NEAR(cell(&down, i, "theta_deg"), cell(&up, i, "theta_deg"), 1e-9);
    CU_ASSERT(!*err);
    CU_ASSERT(run("angle slope rows.csv") == 0 && strstr(err, "--y-axis down"));
    GOOD("angle slope rows.csv --y-axis up");
    CU_ASSERT(!*err);
    FAILS(64, "outline.csv: no radii, which --width needs for its bins; give --cell",
          "angle slope outline.csv --width 401");
    FAILS(1, "sparse: ", "angle slope outline.csv --width 401 --cell 0.2");
    CU_ASSERT(strstr(out, "\n2\tnan\tnan\tnan\t2005\t") && strstr(out, "\tsparse\n"));
    /* half of the cells is not enough */
    write_text("outline.csv", "x y\n0.5 9\n2.5 8\n4.5 7\n6.5 6\n8.5 5\n");
    CU_ASSERT(run("angle slope outline.csv --width 9 --cell 1") == 0);
    FAILS(1, "sparse: 5 of 10 bins", "angle slope outline.csv --width 10 --cell 1");
    /* three quarters are as of a box, and half a cell below its ground */
    write_text("outline.csv", "x y\n0.5 4\n1.5 3\n2.5 2\n3.5 1\n4.5 -0.45\n");
    CU_ASSERT(run("angle slope outline.csv --width 7 --cell 1") == 0 && strstr(err, "a box leaves out"));
    CU_ASSERT(run("angle slope outline.csv --width 6 --cell 1") == 0 && !*err);
    SHELL("sed -i s/-0.45/-0.55/ outline.csv");
    FAILS(1, "the lowest y -0.55, but", "angle slope outline.csv --width 6 --cell 1");
    SHELL("sed -i s/-0.55/0.1/ outline.csv; echo 5.5 -3 >>outline.csv"); /* beyond the width */
    GOOD("angle slope outline.csv --width 5 --cell 1");
    /* grains: their mean diameter, by name or in the third column */
    write_text("outline.csv", "0.5 9 0.3\n1.5 8 0.5\n2.5 7 0.7\n3.5 6 0.5\n4.5 5 0.5\n");
    PRINTS("\n# cell: 1 mean diameter of the grains\n", "angle slope outline.csv --width 5");
    /* one name makes names of all */
    static const char *const headers[][2] = {{"x h b", "\"y\""}, {"a y b", "\"x\""}, {"a b r", "\"x\""}};
    for (size_t k = 0; k < 3; k++) {
        write_text("outline.csv", "%s\n0.5 9 0.3\n1.5 8 0.5\n", headers[k][0]);
        FAILS(65, check_text("no column %s", headers[k][1]), "angle slope outline.csv --width 5");
    }
    /* an index and capital letters, as ImageJ writes them; other names are not guessed */
    static const char *const names[] = {" ,X,Y", "id,X,Y", "id,a,b"};
    for (size_t k = 0; k < 3; k++) {
        write_text("outline.csv", "%s\n1,0,5\n2,1,4\n3,2,3\n4,3,2\n5,4,1\n6,5,0\n", names[k]);
        if (k < 2) PRINTS("\n1\t1\t", "angle slope outline.csv");
        if (k == 2)
            FAILS(65, "no column \"x\"; expected header: x y; found: id a b", "angle slope outline.csv");
    }
    write_text("outline.csv", "0.5 9 0.3\n1.5 8 0\n2.5 7 0.7\n");
    FAILS(65, "outline.csv:2: r = 0: out of range", "angle slope outline.csv --width 5");
}

/* Piles away from x = 0 and y = 0, with two flanks, and in a box that does not fit. */
static void test_slope_anywhere(void)
{
    static const char *const words[] = {"ok_left", "ok_right", "ok_mean"};
    static const double signs[] = {-1.0, 1.0, 1.0};
    double theta[3];
    for (int right = 0; right <= 200; right += 50) {
        FILE *file = file_of("away.csv");
        fputs("x,y\n", file);
        for (int x = 0; x <= 400; x += 4) fprintf(file, "%d,%.0f\n", x + right, 260.0 + tan(25.0 * deg) * x);
        fclose(file);
        scoped_table t = TABLE_OF("angle slope away.csv --y-axis down");
        CU_ASSERT_FATAL(t.n_rows == 3 && !*err);
        for (size_t i = 0; i < 3; i++) {
            if (!right) theta[i] = cell(&t, i, "theta_deg");
            CHECK_NEAR(theta[i], 25.0, 0.2);
            CHECK_NEAR(cell(&t, i, "theta_deg"), theta[i], 1e-9);
        }
        if (!right) continue;
        FAILS(1, "sparse: ", "angle slope away.csv --y-axis down --width 601 --cell 20");
    }
    /* a heap on traced ground, and as a hollow */
    FILE *file = file_of("heap.csv");
    fputs("x,y\n", file);
    for (int x = -400; x <= 400; x++)
        fprintf(file, "%d,%.17g\n", x, 7.0 + fmax(0.0, 100.0 - tan(25.0 * deg) * abs(x)));
    fclose(file);
    for (int down = 0; down < 2; down++) {
        scoped_table t = TABLE_OF("angle slope heap.csv %s", down ? "--y-axis down" : "");
        CU_ASSERT_FATAL(t.n_rows == 9 && !*err);
        CHECK_NEAR(cell(&t, 0, "n_occupied"), 172.0, 0.0); /* from 10 to 90 of a height of 100: 22 to 193 */
        for (size_t i = 0; i < 9; i++) {
            CU_ASSERT_STRING_EQUAL(word(&t, i, "status"), words[i / 3]);
            CHECK_NEAR(cell(&t, i, "theta_deg"), 25.0 * (down && i < 6 ? -1.0 : 1.0) * signs[i / 3], 1e-9);
            CHECK_NEAR(cell(&t, i, "slope"), tan(cell(&t, i, "theta_deg") * deg), 1e-12);
        }
    }
    scoped_table t = TABLE_OF("angle slope heap.csv --from 1 --to 380");
    CU_ASSERT(t.n_rows == 3 && cell(&t, 0, "n_cells") == 380.0);
    CHECK_NEAR(cell(&t, 1, "theta_deg"), 25.0, 1e-9);
    FAILS(
        1,
        "no pile: a flank of 2 points without a clear slope: between the lowest and the highest tenth of the "
        "height it needs 4 points or more, and a slope above 3 of its errors",
        "angle slope heap.csv --from 212");
    FAILS(1, "heap.csv: no pile: no flank in a surface of 0 points, which is level or empty",
          "angle slope heap.csv --from 401");
    write_text("level.csv", "x,y\n0,1\n1,1\n2,1\n");
    FAILS(1, "level.csv: no pile: no flank in a surface of 3 points", "angle slope level.csv");
    write_text("few.csv", "x,y\n0,1\n1,2\n");
    FAILS(1, "few.csv: no pile: a flank of 0 points without", "angle slope few.csv");
    FAILS(1, "a second one that ends at 0.16 of the height", "angle slope heap.csv --to 180");
    FAILS(1, "a second one that ends at 0.49 of the height", "angle slope heap.csv --from -110");
    CU_ASSERT(run("angle slope heap.csv --to 100") == 0 && strstr(out, "\tok\n"));
    FAILS(64, "--from and --to need its absence", "angle slope heap.csv --from 1 --width 3 --cell 20");
    FAILS(64, "need --width", "angle slope heap.csv --cell 1");
    SHELL("awk -F, -v OFS=, 'NR > 1 { print $1, $2; print $1 + 801, $2 }' heap.csv >two.csv");
    FAILS(1, "two.csv: choose a flank with --from and --to: no pile: 4 flanks", "angle slope two.csv");
    CU_ASSERT(strstr(out, "\tno_pile\n") != NULL);
    /* a box takes y = 0 for its ground, x = 0 for its wall, and one flank */
    CU_ASSERT(run("angle slope heap.csv --width 401 --cell 20") == 0 &&
              strstr(err, "a box leaves out x < 0"));
    SHELL("awk -F, -v OFS=, 'NR > 1 { $1 += 400 } { print }' heap.csv >right.csv");
    CU_ASSERT(run("angle slope right.csv --width 801 --cell 20") == 0 && strstr(err, "it has one flank"));
    CU_ASSERT(run("angle slope right.csv --width 1001 --cell 20") == 0 &&
              strstr(err, "empty bins have height 0"));
    FAILS(1, "sparse: ", "angle slope right.csv --where 'x>=200' --width 801 --cell 20");
    SHELL("awk -F, -v OFS=, 'NR > 1 { $2 -= 50 } { print }' right.csv >low.csv");
    FAILS(1, "the lowest y -43, but a box begins at 0, 0", "angle slope low.csv --width 801 --cell 20");
    GOOD("angle slope low.csv");
}

/* The help of a group lists its commands in the order of what one does first. */
static void test_group_order(void)
{
    static const char *const groups[][12] = {{"angle", "marginal", "tilt", "slope", "compare"},
                                             {"stats", "fit", "trend", "size", "correlation", "select"},
                                             {"stress", "field", "base", "dip"}};
    for (size_t g = 0; g < 3; g++) {
        const char *at = out;
        GOOD("%s --help", groups[g][0]);
        for (int k = 1; groups[g][k]; k++) {
            at = strstr(at, check_text("\n  %s ", groups[g][k]));
            CU_ASSERT_PTR_NOT_NULL_FATAL(at);
        }
    }
}

/* A pile drawn with a ruler, and points on a line. */
static void test_angle_tables(void)
{
    FILE *file = file_of("pile.tsv");
    for (int j = 0; j < 20; j++)
        fprintf(file, "%.17g\t%.17g\t0.1\n", 0.1 + 0.2 * j, 2.0 - 0.385 * (0.1 + 0.2 * j));
    fclose(file);
    scoped_table t = TABLE_OF("angle slope pile.tsv --width 4 --cell 0.2");
    CU_ASSERT(t.n_rows == 3);
    for (size_t i = 0; i < t.n_rows; i++) CHECK_NEAR(cell(&t, i, "theta_deg"), atan(0.385) / deg, 1e-9);
    write_text("pile.tsv", "0.1 0.2\n0.3 0.2\n0.5 0.1\n");
    FAILS(1, "occupied", "angle slope pile.tsv --width 4 --cell 0.2");
    CU_ASSERT(strstr(out, "no_pile") != NULL);
    for (int k = 0; k < 2; k++) { /* a valley, and a pile too small for its powers */
        file = file_of("pile.tsv");
        for (int i = -20; i <= 20; i++)
            fprintf(file, k ? "%de-150\t%de-150\n" : "%d\t%d\n", 3 * i, k ? 20 - abs(i) : abs(i));
        fclose(file);
        FAILS(1, k ? "powers overflow" : "a valley, two flanks that fall inwards", "angle slope pile.tsv");
        CU_ASSERT(strstr(out, "no_pile") != NULL);
        if (k == 0) PRINTS("ok_mean", "angle slope pile.tsv --y-axis up");
        if (k == 0) PRINTS("ok_mean", "angle slope pile.tsv --y-axis down");
    }
    write_text("steep.tsv", "mu\ttheta_r3_deg\ttheta_t_displacement_deg\n0.2\t-500\t3\n");
    FAILS(65, "steep.tsv:2: theta_r3_deg = -500: out of range, allowed: (-90, 90)",
          "angle compare steep.tsv");
    test_outline();
    test_slope_anywhere();
    write_text("line.tsv", "# mu\ttheta\tse\n0.05\t1.5\t0.1\n");
    FAILS(65, "no column \"theta_r3_deg\"", "angle compare line.tsv");
}

/* Two grains of weight 981 and 1962 on a floor and one on both, supported by a wall; and its runs. */
static void test_stress_tables(void)
{
    write_text("p_grains.tsv",
               "# x\ty\tm\n0.1\t0.1\t1\n0.5\t0.1\t2\n0.3\t0.3\t1\n0.7\t0.1\t0.5\n0.9\t0.1\t0.5\n"
               "1.1\t0.1\t0.5\n");
    write_text("p_contacts.tsv",
               "# id_b\twall\tx\ty\tx_b\ty_b\tnormal_force\tshear_force\n"
               "1\t0\t0.3\t0.3\t0.1\t0.1\t%.17g\t0\n2\t0\t0.3\t0.3\t0.5\t0.1\t%.17g\t0\n"
               "0\t1\t0.1\t0.1\t0.1\t0\t1471.5\t0\n0\t1\t0.5\t0.1\t0.5\t0\t2452.5\t-490.5\n"
               "0\t2\t0.1\t0.1\t0\t0.1\t490.5\t0\n0\t1\t0.7\t0.1\t0.7\t0\t490.5\t0\n"
               "0\t1\t0.9\t0.1\t0.9\t0\t490.5\t0\n0\t1\t1.1\t0.1\t1.1\t0\t490.5\t0\n",
               490.5 * sqrt(2.0), 490.5 * sqrt(2.0));
    scoped_table t = TABLE_OF("stress base p --width 1.2 --cell 0.2");
    const char *const note = rp_table_find_note(&t, "errors");
    CU_ASSERT(note && strcmp(note, "nan for one pile; at least 2 needed") == 0);
    static const double n[] = {1471.5, 0.0, 2452.5, 490.5}, weight[] = {981.0, 981.0, 1962.0, 490.5};
    for (size_t i = 0; i < 4; i++)
        CHECK_EACH(cell(&t, i, NAME), 1e-8, {"N", n[i] / 0.2}, {"H", i == 2 ? 490.5 / 0.2 : 0.0},
                   {"weight", weight[i] / 0.2}, {"imbalance", 0.0});
    /* the same 5 lower */
    SHELL("awk -v FS='\t' -v OFS='\t' 'NR > 1 { $2 -= 5 } 1' p_grains.tsv >low_grains.tsv; "
          "awk -v FS='\t' -v OFS='\t' 'NR > 1 { $4 -= 5; $6 -= 5 } 1' p_contacts.tsv >low_contacts.tsv");
    for (int k = 0; k < 2; k++) {
        const char *how = k ? "field %s --width 1.2 --cell 0.2" : "base %s --width 1.2 --cell 0.2";
        scoped_table high = TABLE_OF("stress %s", check_text(how, "p")),
                     low = TABLE_OF("stress %s", check_text(how, "low"));
        CU_ASSERT_FATAL(low.n_rows == high.n_rows);
        for (size_t i = 0; i < low.n_rows; i++)
            CHECK_EACH(cell(&low, i, NAME) - cell(&high, i, NAME), 1e-9 * 2e4, {k ? "syy" : "N_theory", 0.0},
                       {k ? "y/W" : "H_theory", 0.0});
    }
    /* of a run's folder; of several steps one is named */
    SHELL("mkdir d; for t in contacts:contacts grains:states; do (sed '1s/# /# step\t/; 2,$s/^/1\t/' "
          "p_${t%:*}.tsv; sed '1d; s/^/2\t/' p_${t%:*}.tsv) >d/${t#*:}.tsv; done");
    FAILS(65, "d/contacts.tsv:10: step = 2 after 1: one step expected", "stress base d --width 1.2");
    scoped_table d = TABLE_OF("stress base d --width 1.2 --cell 0.2 --where step=2");
    CU_ASSERT_FATAL(d.n_rows == t.n_rows);
    for (size_t i = 0; i < t.n_rows; i++)
        CHECK_EACH(cell(&d, i, NAME), 0.0, {"N", cell(&t, i, "N")}, {"weight", cell(&t, i, "weight")});
    /* the floor is the same by any number, and in parts; level walls at two heights, and none, are told */
    static const char *const walls[] = {"$2 ? 3 - $2 : 0", "$2 == 1 ? 3 + ($3 > 0.6) : $2"};
    static const char named[] = "awk -v FS='\t' -v OFS='\t' 'NR > 1 { %s } { print }' p_contacts.tsv "
                                ">w_contacts.tsv && cp p_grains.tsv w_grains.tsv";
    for (size_t k = 0; k < 3; k++) {
        CU_ASSERT(shell_line(named, check_text("$2 = %s", walls[k % 2])) == 0);
        scoped_table w = TABLE_OF("stress base w --width 1.2 --cell 0.2 %s", k == 2 ? "--floor 2" : "");
        for (size_t i = 0; i < t.n_rows; i++) CHECK_NEAR(cell(&w, i, "N"), cell(&t, i, "N"), 0.0);
    }
    CU_ASSERT(shell_line(named, "if ($3 > 0.6 && $2) { $2 = 3; $6 = 0.05 }") == 0);
    FAILS(65, "w: walls carry grains at y = 0 and 0.05: name the floor with --floor",
          "stress base w --width 1.2");
    CU_ASSERT(shell_line(named, "if ($2) $5 += 0.01") == 0);
    FAILS(65, "w: no contact with a level floor: name its wall with --floor", "stress base w --width 1.2");
    GOOD("stress base w --width 1.2 --floor 1");
    FAILS(65, "w: --floor = 7: no grain touches this wall", "stress base w --width 1.2 --floor 7");
    /* a grain that flew off is named with its pile; 100000 cells away it still has one */
    shell("cp p_contacts.tsv far_contacts.tsv; sed 's/^0.7/2e4/' p_grains.tsv >far_grains.tsv; cp "
          "p_contacts.tsv high_contacts.tsv; sed 's/^0.7\t0.1/0.7\t-2.1e4/' p_grains.tsv >high_grains.tsv");
    FAILS(65, "far: grain 4 at (20000, 0.1): more than 100000 bins of 0.199 away",
          "stress field far p --width 1.2 --cell 0.199");
    FAILS(65, "high: grain 4 at (0.7, -21000): more than 100000 bins of 0.2 away",
          "stress base p high --width 1.2 --cell 0.2");
    FAILS(65, "width = 1.2: more than 100000 bins of 1e-05", "stress field p --width 1.2 --cell 1e-5");
    /* in metres, kilograms and newtons: cell, diameter and gravity of the defaults are those of the table */
    write_text("si_grains.tsv", "# system: si\n# units: m\tm\tkg\n# "
                                "x\ty\tm\n0.001\t0.001\t1e-3\n0.005\t0.001\t2e-3\n0.003\t0.003\t1e-3\n"
                                "0.007\t0.001\t5e-4\n0.009\t0.001\t5e-4\n0.011\t0.001\t5e-4\n");
    SHELL("awk -F'\t' -v OFS='\t' 'NR > 1 { for (k = 3; k < 7; k++) $k /= 100; $7 *= 1e-5; $8 *= 1e-5 } NR "
          "== 1 { print \"# system: si\"; print \"# units: 1\\t1\\tm\\tm\\tm\\tm\\tN\\tN\" } { print }' "
          "p_contacts.tsv >si_contacts.tsv");
    scoped_table cgs = TABLE_OF("stress base p --width 1.2");
    scoped_table si = TABLE_OF("stress base si --width 0.012");
    CU_ASSERT_FATAL(cgs.n_rows == si.n_rows && cgs.n_rows == 4);
    for (size_t i = 0; i < si.n_rows; i++) {
        CHECK_NEAR(cell(&si, i, "x/W"), cell(&cgs, i, "x/W"), 1e-12);
        CHECK_EACH(cell(&si, i, NAME), 1e-9, {"N", 1e-3 * cell(&cgs, i, "N")},
                   {"weight", 1e-3 * cell(&cgs, i, "weight")},
                   {"N_theory", 1e-3 * cell(&cgs, i, "N_theory")});
    }
    FAILS(65, "q_contacts.tsv: cannot read", "stress field q --width 4");
    write_text("r_contacts.tsv", "# x\ty\n1\t2\n");
    FAILS(65, "no column \"id_b\"", "stress field r --width 4");
}

/* Piles with an unfinished drop, and layers, are failed runs, excluded from the mean dip. */
static void test_cut_drops(void)
{
    write_text("s.cfg", "protocol = \"drop\"; replicas = 3; seed = 20; fixed = { N = 40; };\n"
                        "grid = ({ max_steps = [20000, 200, 200]; mu_roll = [0.1, 0.1, 0.0]; });\n");
    FAILS(1, "drops_not_quiet: ", "run s.cfg --row 3 -o cut");
    FAILS(1, "phase drop, after 200 steps", "run s.cfg --row 3 -o cut --force");
    FAILS(1, "no_pile: phase relax, step 20: pile.height < 2", "run s.cfg --row 6 -o layer");
    GOOD("sweep plan s.cfg -o d");
    GOOD("sweep run d");
    scoped_table t = TABLE_OF("sweep export d --reduce");
    for (size_t k = 0; k < 3; k++)
        CHECK_EACH(cell(&t, k, NAME), 0.0, {"n", k == 0 ? 3.0 : 0.0}, {"n_failed", k == 0 ? 0.0 : 3.0});
    CU_ASSERT_STRING_EQUAL(word(&t, 1, "failed_for"), "drops_not_quiet:3");
    CU_ASSERT_STRING_EQUAL(word(&t, 2, "failed_for"), "no_pile:3");
    GOOD("sweep export d -o runs.tsv");
    read_again(&t, "runs.tsv");
    for (size_t k = 3; k < 9; k++) CU_ASSERT(cell(&t, k, "capped_share") > 0.0 || k > 5);
    PRINTS("# rows: 3 used, 6 left out\n", "stress dip runs.tsv");
}

/* Planted tables of runs: a change of -3 and of 0 over two decades; the suite `tables` has all columns. */
static void test_stats_trends(void)
{
    FILE *file = file_of("runs.tsv");
    fprintf(file, "# mu\tW\tk\ttheta\tpile\tstatus\n");
    for (int i = 0; i < 24; i++) {
        const double W = 2.0 + 2.0 * (i % 3), k = pow(10.0, 4 + i % 3), scatter = i / 12 * 0.1;
        fprintf(file, "0.%d\t%g\t%g\t%.17g\t%d\tok\n", 1 + i % 2, W, k,
                i % 2 ? 18.0 + scatter : 19.0 + 3.0 / W - 1.5 * (i % 3) + scatter, i / 6);
    }
    fprintf(file, "0.1\t2\t1e4\t99\t9\tnot_at_rest\n0.1\t2\t1e4\tnan\t9\tok\n0.3\t2\t1e4\tnan\t9\tok\n"
                  "0.2\t80\t1e4\t99\t9\tok\n");
    fclose(file);
    scoped_table t = TABLE_OF("stats size runs.tsv -x W -y theta --by mu --to 6");
    CU_ASSERT(t.n_rows == 3);
    CU_ASSERT_STRING_EQUAL(word(&t, 0, "status"), "curved");
    CU_ASSERT_STRING_EQUAL(word(&t, 1, "status"), "ok");
    CU_ASSERT_STRING_EQUAL(t.cells[3 * t.n_columns - 1], "no_result");
    PRINTS("# rows: 25 used, 1 without result, 2 with nan, 0 outside",
           "stats trend runs.tsv -x k -y theta --by mu --to 1e6 --scale log --pair");
    read_again(&t, "out");
    CHECK_NEAR(cell(&t, 0, "n_left"), 0.0, 0.0);
    CHECK_NEAR(cell(&t, 1, "n_left"), 1.0, 0.0); /* the pile with a single x */
    CU_ASSERT_STRING_EQUAL(t.cells[t.n_columns - 1], "falls");
    CU_ASSERT_STRING_EQUAL(t.cells[2 * t.n_columns - 1], "no_dependence_within_margin");
    CU_ASSERT_STRING_EQUAL(t.cells[3 * t.n_columns - 1], "no_result");
    /* several tables are read as one; those of other columns are refused */
    write_text("less.tsv", "# mu\tW\tk\ttheta\tpile\tstatus\n0.3\t2\t1\t17\t0\tok\n0.3\t2\t1\t19\t0\tok\n");
    write_text("more.tsv", "# mu\tW\tk\ttheta\tpile\tstatus\n0.3\t4\t1\t21\t0\tok\n0.3\t4\t1\t23\t0\tok\n");
    AGAIN_OF(t, "stats trend less.tsv more.tsv runs.tsv -x W -y theta --by mu --to 6");
    CU_ASSERT(t.n_rows == 3);
    CHECK_NEAR(cell(&t, 0, "n"), 4.0, 0.0);
    CHECK_NEAR(cell(&t, 0, "slope"), 2.0, 1e-12);
    CHECK_NEAR(cell(&t, 1, "n"), 12.0, 0.0);
    write_text("other.tsv", "# mu\tW\tk\tslope\tpile\tstatus\n0.3\t4\t1\t21\t0\tok\n");
    write_text("units.tsv",
               "# units: 1\tm\t1\t1\t1\t1\n# mu\tW\tk\ttheta\tpile\tstatus\n0.3\t4\t1\t21\t0\tok\n");
    FAILS(65, "runs.tsv and units.tsv have different units", "stats trend runs.tsv units.tsv -x W -y theta");
    FAILS(65, "runs.tsv and other.tsv have different columns",
          "stats trend runs.tsv other.tsv -x W -y theta");
    FAILS(65, "no column \"frob\"", "stats trend runs.tsv -x W -y theta --by frob");
    /* groups in the order in which they appear, the first of them without a row that counts */
    write_text("empty.tsv", "g\tx\ty\tstatus\nfew\t1\t9\tleaked\nb\t1\t2\tok\nb\t2\t4\tok\nb\t3\t6\tok\n"
                            "none\t1\tnan\tok\nd\t1\t5\tok\nd\t2\t4\tok\nd\t3\t3\tok\n");
    AGAIN_OF(t, "stats trend empty.tsv -x x -y y --by g");
    CU_ASSERT_FATAL(t.n_rows == 4);
    for (size_t k = 0; k < 4; k++) {
        CU_ASSERT_STRING_EQUAL(word(&t, k, "g"), k == 0 ? "few" : k == 1 ? "b" : k == 2 ? "none" : "d");
        CHECK_NEAR(cell(&t, k, "n"), k % 2 ? 3.0 : 0.0, 0.0);
        if (k % 2) CHECK_NEAR(cell(&t, k, "slope"), k == 1 ? 2.0 : -1.0, 1e-14);
    }
    FAILS(65, "pile 0: two values", "stats trend runs.tsv -x W -y theta --pair");
    FAILS(1, "at 1 different x", "stats trend runs.tsv -x W -y theta --to 3");
    write_text("runs.tsv",
               "# units: 1\tcm\t1\tdegree\t1\n# "
               "law\ta\tb\ty\tpile\nold\t1\tu\t5\t0\nnew\t1\tu\t7\t0\nold\t1\tu\t6\t1\n"
               "new\t1\tu\t8.5\t1\nold\t1\tv\t1\t0\nnew\t1\tv\t1\t0\nold\t1\tv\t2\t1\nnew\t1\tv\t2\t1\n");
    PRINTS("# words: old = 0, new = 1\n", "stats trend runs.tsv -x law -y y --by a,b --pair");
    read_again(&t, "out");
    CU_ASSERT(t.n_rows == 2);
    CU_ASSERT(strstr(out, "# units: cm\t1\t1\t1\t1\tx\tx\t") != NULL); /* each with its own unit */
    for (size_t row = 0; row < 2; row++) {
        CU_ASSERT_STRING_EQUAL(word(&t, row, "a"), "1");
        CU_ASSERT_STRING_EQUAL(word(&t, row, "b"), row ? "v" : "u");
    }
    CHECK_EACH(cell(&t, 0, NAME), 1e-12, {"change", 2.25}, {"change_se", 0.25});
    CHECK_NEAR(cell(&t, 1, "change"), 0.0, 1e-12);
    /* one word among numbers is an error of the table, wherever it stands; nan is a nan among words too */
    static const char *const mixed[] = {"old\t1\n2\t2\n3\t4\n", "2\t1\n3\t2\nold\t4\n"};
    for (int k = 0; k < 4; k++) {
        write_text("mixed.tsv", "# x\ty\n%s", mixed[k / 2]);
        FAILS(65, check_text("mixed.tsv:%d: column 1 x: \"old\" is not a finite number", k / 2 ? 4 : 2),
              "stats trend mixed.tsv -x x -y y --scale %s", k % 2 ? "log" : "linear");
    }
    write_text("mixed.tsv", "# x\ty\nnan\t7\nold\t1\nnew\t2\nnew\t4\n");
    PRINTS("# words: old = 0, new = 1\n", "stats trend mixed.tsv -x x -y y");
    CU_ASSERT(strstr(out, "3 used, 0 without result, 1 with nan") != NULL);
    write_text("runs.tsv", "# x\ty\n1\t2\n2\t4\n0\t1\n");
    FAILS(65, "runs.tsv:4: x = 0: out of range of this scale", "stats trend runs.tsv -x x -y y --scale log");
    FAILS(65, "no column \"pile\"", "stats trend runs.tsv -x x -y y --pair");
    FAILS(65, "runs.tsv:4: x = 0: out of range of this scale or --power",
          "stats trend runs.tsv -x x -y y --power 2");
    GOOD("stats trend runs.tsv -x x -y y");                        /* without status every row counts */
    write_text("runs.tsv", "x\ty\n5mm\t2\n9mm\tinf\n7mm\t\"\"\n"); /* not a word */
    FAILS(65, "runs.tsv:2: column 1 x: \"5mm\"", "stats trend runs.tsv -x x -y y");
    FAILS(65, "runs.tsv:3: column 2 y: \"inf\"", "stats correlation runs.tsv -x y -y y");
    FAILS(65, "runs.tsv:4: column 2 y: \"\"", "stats correlation runs.tsv -x y -y y --where x=7mm");
    FAILS(64, "-x = \"x,y\": one column expected", "stats fit runs.tsv -x x,y -y y");
    FAILS(64, "-y = \"x,y\": one column expected", "stats trend runs.tsv -x y -y x,y");
    write_text("runs.tsv", "x\ty\n1\t5\n2\t5\n1\t5\n2\t5\n"); /* no trend, but of round-off */
    PRINTS("\t0\t0\t0\t0\t1\t1\tnan\t0\t-\tok\n", "stats size runs.tsv -x x -y y");
    FAILS(1, "no row", "stats trend runs.tsv -x x -y y --where 'x=1:2'");
}

static void test_stats_select(void)
{
    write_text("a.tsv", "# units: 1\tcm\t1\t1\nlaw\tx\tb\tstatus\nold\t1\t1e-3\tok\nnew\t2\t2e-3\tok\n"
                        "law\tx\tb\tstatus\nold\t10\tnan\tfell\nnew\t-3\t7\tok\n");
    PRINTS_ALL("2e-3\t2\n", "stats select a.tsv --where 'x>=2' --where law=new --columns b,x --bare");
    GOOD("stats select a.tsv --where 'x<1.5' --where 'b!=0.001'"); /* as numbers: 1e-3 is 0.001 */
    CU_ASSERT(strstr(out, "# units: 1\tcm\t1\t1\nlaw\tx\tb\tstatus\nnew\t-3\t7\tok\n") != NULL);
    GOOD("stats select a.tsv --where 'b<100' --columns x --bare"); /* nan is neither below nor above */
    CU_ASSERT_STRING_EQUAL(out, "1\n2\n-3\n");
    write_text("plain.tsv", "1\t2\t5\n3\t4\t6\n"); /* columns without names have numbers */
    PRINTS("\n3\t1\n5\t1\n6\t3\n", "stats select plain.tsv --columns 3,1");
    FAILS(65, "no column \"2nd\"", "stats select plain.tsv --columns 2nd");
    FAILS(65, "no column \"frob\"", "stats select a.tsv --where frob=1");
    FAILS(65, "no column \"B\" (did you mean \"b\"?); found: ", "stats select a.tsv --where B=1");
    FAILS(65, "no column \"frob\"", "stats select a.tsv --where frob");
    FAILS(65, "no column \"old\"", "stats select a.tsv --where 'law<old'");
    write_text("p.tsv", "# eps\te\tmodes\n1e-2\t9\t3\n1e-4\t2e-4\t0\n1e-6\t2e-6\t0\n1e-8\t2e-8\t0\n");
    scoped_table t = TABLE_OF("stats fit p.tsv -x eps -y e --scale log --where modes=0");
    CU_ASSERT(t.n_rows == 1);
    CHECK_NEAR(cell(&t, 0, "slope"), 1.0, 1e-12);
    CHECK_NEAR(cell(&t, 0, "intercept"), log(2.0), 1e-11);
    CHECK_NEAR(cell(&t, 0, "x_from"), 1e-8, 1e-20);
    CHECK_NEAR(cell(&t, 0, "x_to"), 1e-4, 1e-16);
    write_text("n.tsv", "# eps\te\n-1\t1\n2\t2\n");
    FAILS(65, "n.tsv:2: eps = -1: out of range of this scale", "stats fit n.tsv -x eps -y e --scale log");
    FAILS(65, "n.tsv:2: eps = -1: out of range, allowed: (0, inf)", "stats fit n.tsv -x e -y e --se eps");
    FAILS(64, "give one of them", "stats fit p.tsv -x eps -y e --se e --scale log");
    /* no result is none for the shell too */
    write_text("n.tsv", "# x\ty\tz\n-1e308\t1\t5\n1e308\t2\t5\n1e308\t2\t5\n-1e308\t1\t5\n");
    FAILS(1, "no line: numbers so large", "stats fit n.tsv -x x -y y");
    FAILS(1, "no trend: numbers so large", "stats trend n.tsv -x y -y x");
    FAILS(1, "values are all equal", "stats correlation n.tsv -x z -y y");
}

/* ---- claims and report ---- */

#define CLAIMS                                                                                               \
    "id\tof\tpaper\tplace\tsection\ttest\tpublished\tpublished_se\terror\tsamples\tmargin\tfamily\tfixed\t"  \
    "answer\tagainst\tsays\tstatement\tnote\n"
#define CLAIM(id, number)                                                                                    \
    id "\t-\tlh\t-\tall\tagrees\t" number "\tse\t20\t2\t-\tbefore\tt v\t-\t-\t" id "\t-\n"
/* The same of another choice. */
#define VARIANT(id, of, number, answer)                                                                      \
    id "\t" of "\tlh\t-\tall\tagrees\t" number "\t-\t-\t2\t-\tbefore\t" answer "\t-\t-\t" id "\t-\n"
/* Claims without a published number: one of a family, and one by itself. */
#define MEMBER(id, family, test, margin, answer, against)                                                    \
    id "\t-\tli\t-\tplain\t" test "\t-\t-\t-\t-\t" margin "\t" family "\tbefore\t" answer "\t" against       \
       "\tword\t" id "\tnote\n"
#define PLAIN(id, test, margin, answer, against) MEMBER(id, "-", test, margin, answer, against)
/* Verdicts on these claims by the tables of the folder. */
#define JUDGE(claims)                                                                                        \
    write_text("claims.tsv", CLAIMS claims);                                                                 \
    REPORTS("claims --claims claims.tsv --tables .")

/* What rows say of tables, in two folders; the suite `evidence` has each verdict. 101 values make two
 * standard errors the 95 % interval to 1 %. */
static void test_claims(void)
{
    write_text("claims.tsv", CLAIMS CLAIM("angle", "20\t1") VARIANT("twin", "angle", "-\t-", "u v")
                                 PLAIN("far", "independent", "1", "far limit", "-")
                                     PLAIN("level", "independent", "1", "trend k=1 change", "-")
                                         PLAIN("up", "rises", "1", "trend k=2 change", "-")
                                             PLAIN("high", "above", "-", "u v", "t v")
                                                 PLAIN("rest", "above", "-", "u v less t v", "9"));
    write_text("t.tsv", "# v_mean\tv_se\tn\n20.5\t0.1\t101\n");
    write_text("u.tsv", "# v\tv_se\n30\t0.5\n");
    write_text("trend.tsv", "# k\tchange\tchange_se\tchange_lo90\tchange_hi90\tp_value\tp_holm\n"
                            "1\t0.1\t0.2\t-0.2\t0.4\t0.6\t0.9\n2\t3\t1\t1.4\t4.6\t0.003\t0.04\n");
    write_text("far.tsv",
               "# limit\tlimit_se\tlimit_lo90\tlimit_hi90\tchange_lo90\tchange_hi90\tdof\tp_value\n"
               "0.5\t0.2\t0.3\t0.7\t-9\t9\t9\t0.01\n");
    REPORTS("claims --claims claims.tsv --tables nowhere,. --variants");
    CU_ASSERT(strstr(out, "# lh: 0 reproduced, 0 not reproduced, 1 open\n"
                          "# li: 4 reproduced, 0 not reproduced, 1 open\n") != NULL);
    CHECK_CELLS({"angle", "detail", "+0.5 se"}, {"twin", "verdict", "not reproduced"},
                {"twin", "published", "20 ± 1"},
                /* the interval of its own column */
                {"far", "ours", "0.50 ± 0.20 (90 %: 0.30 to 0.70)"},
                {"level", "ours", "0.10 ± 0.20 (90 %: -0.20 to 0.40)"}, {"up", "verdict", "reproduced"},
                {"high", "ours", "30.00 ± 0.50 against 20.50 ± 0.10"},
                {"rest", "ours", "9.50 ± 0.51 against 9"}, {"level", "verdict", "reproduced"});
    /* two values: two standard errors are 12.7, of a mean; of a fit they are 2 */
    write_text("t.tsv", "# v_mean\tv_se\tn\n20\t1\t2\n");
    write_text("u.tsv", "# v\tv_se\tn\n30\t1\t2\n");
    REPORTS("claims --claims claims.tsv --tables .");
    CHECK_CELLS({"high", "verdict", "open"});
    write_text("t.tsv", "# v\tv_se\tn\n20\t1\t2\n");
    REPORTS("claims --claims claims.tsv --tables .");
    CHECK_CELLS({"high", "verdict", "reproduced"});
}

/* Claims of one question: of no change chances 0.0228 and 0.0013 are raised to 0.0455 and 0.0027. The suite
 * `evidence` has families of inequalities and trends. */
static void test_families(void)
{
    write_text("t.tsv", "# k\tv\tv_se\tchange\tchange_se\tdof\tchange_lo90\tchange_hi90\tp_value\tp_holm\n"
                        "1\t3\t1\t4\t1\tinf\t-9\t17\t0.03\t0.04\n2\t3\t1\t-4\t1\tinf\t-17\t9\t0.03\t0.04\n"
                        "3\t3\t1\t4\t1\tinf\t-9\t17\t0.5\t0.5\n4\t3\t1\t0\t0.5\tinf\t-0.8\t0.8\t0.9\t0.9\n"
                        "5\t3\t1\t0\t1\tinf\t-0.8\t0.8\t0.9\t0.9\n");
    /* a table that is not there is no test */
    JUDGE(MEMBER("first", "q", "rises", "9", "t k=1 change", "-")
              MEMBER("gone", "q", "rises", "9", "nowhere k=1 change", "-"));
    CHECK_CELLS({"first", "verdict", "reproduced"}, {"gone", "verdict", "no data"});
    /* no change: margins of one error for the two claims, whose chances are 0.0228 (2 errors) */
    JUDGE(MEMBER("near", "q", "independent", "1", "t k=4 change", "-")
              MEMBER("far", "q", "independent", "3", "t k=5 change", "-"));
    CHECK_CELLS({"near", "verdict", "reproduced"}, {"far", "verdict", "reproduced"});
    JUDGE(MEMBER("near", "q", "independent", "1", "t k=4 change", "-")
              MEMBER("far", "q", "independent", "2", "t k=5 change", "-")
                  MEMBER("same", "q", "independent", "2", "t k=5 change", "-"));
    CHECK_CELLS({"near", "detail", "reproduced without the correction for 3 tests of one question"});
    /* agreements, each reading by itself: 2.4 errors have a chance of 1.6 %, of five tests 8.2 %. The
     * other reading of 20 samples makes one error 4.5. */
    write_text("u.tsv", "# k\tv\tv_se\n1\t22.4\t0\n2\t20\t0\n3\t21\t0\n");
#define FIVE(family)                                                                                         \
    NUMBER("hot", family, "1", "1\tse\t20")                                                                  \
    NUMBER("a", family, "2", "1\tse\t20")                                                                    \
    NUMBER("b", family, "2", "1\tse\t20")                                                                    \
    NUMBER("c", family, "2", "1\tse\t20")                                                                    \
    NUMBER("read", family, "3", "1.6\tsd\t16") NUMBER("hotter", "-", "1", "1\tse\t20")
#define NUMBER(id, family, k, plus)                                                                          \
    id "\t-\tlh\t-\tall\tagrees\t20\t" plus "\t2\t" family "\tbefore\tu k=" k " v\t-\t-\t" id "\t-\n"
    JUDGE(FIVE("-"));
    CHECK_CELLS({"hot", "detail", "+2.4 se"});
    JUDGE(FIVE("q"));
    CHECK_CELLS({"hot", "detail", "not reproduced without the correction for 5 tests of one question"},
                {"read", "detail", "not reproduced without the correction for 5 tests of one question"},
                {"a", "detail", "+0.0 se"}, {"hotter", "detail", "+2.4 se"});
    /* equalities beside an inequality: 1.9 errors within the margin have 2.9 %, raised by one another */
    JUDGE(MEMBER("equal", "q", "same", "4", "t k=3 v", "0.9") MEMBER(
        "twin", "q", "same", "4", "t k=3 v", "0.9") MEMBER("more", "q", "above", "0.1", "t k=3 v", "0"));
    CHECK_CELLS({"equal", "detail", "reproduced without the correction for 3 tests of one question"},
                {"more", "verdict", "reproduced"});
    JUDGE(MEMBER("equal", "-", "same", "4", "t k=3 v", "0.9"));
    CHECK_CELLS({"equal", "verdict", "reproduced"});
}

/* Means of piles that stand in several tables are one mean. By hand: 12 values of mean 21; squares within the
 * two parts, 3 2^2 + 7 3^2, and between them, 4 3^2 + 8 1.5^2. */
static void test_pooled(void)
{
    write_text("a.tsv", "# k\tv_mean\tv_sd\tv_se\tv_n\tn\n1\t7\t7\t7\t9\t9\n2\t18\t2\t1\t4\t5\n");
    write_text("b.tsv", "# v_mean\tv_sd\tv_se\tv_n\tn\n22.5\t3\t1.06066\t8\t8\n");
    JUDGE(PLAIN("pooled", "above", "-", "a k=2 v + b v", "0")
              PLAIN("short", "above", "-", "a k=2 v + none v", "0")
                  PLAIN("scatter", "above", "-", "a k=2 v_sd + b v_sd", "0"));
    CHECK_CELLS({"scatter", "ours", "3.42 ± 0.73"}, {"pooled", "ours", "21.00 ± 0.99"}, {"pooled", "n", "12"},
                {"short", "verdict", "no data"});
    const stats_summary parts[] = {{.n = 4, .mean = 18.0, .sd = 2.0}, {.n = 8, .mean = 22.5, .sd = 3.0}};
    const stats_summary all = stats_pooled(2, parts), one = stats_pooled(1, parts);
    CU_ASSERT(all.n == 12 && one.n == 4);
    CHECK_PAIRS(1e-14, {all.mean, 21.0}, {all.sd, sqrt((12.0 + 63.0 + 36.0 + 18.0) / 11.0)}, {one.sd, 2.0});
    CHECK_NEAR(one.hi - one.mean, 3.182446305284263, 1e-9); /* Student's t of 3 degrees of freedom, se 1 */
}

static void test_bad_claims(void)
{
    write_text("t.tsv", "# k\tv\n1\t2\n1\t3\n");
#define BAD(text, message)                                                                                   \
    write_text("bad.tsv", CLAIMS text);                                                                      \
    REPORT_FAILS(65, message, "claims --claims bad.tsv --tables .")
    BAD(PLAIN("a", "guess", "-", "t v", "-"), "bad.tsv:2: claim a: unknown test \"guess\"");
    BAD(CLAIM("a", "1\t1") CLAIM("a", "1\t1"), "bad.tsv:3: claim a stands twice");
    BAD(VARIANT("b", "a", "-\t-", "t v"), "no claim \"a\"");
    BAD(PLAIN("a", "above", "-", "t k=1 v", "0"), "claim a: ./t.tsv: 2 rows for \"t k=1 v\", one expected");
    BAD(PLAIN("a", "above", "-", "t k=2 v", "0"), "0 rows");
    BAD(PLAIN("a", "above", "-", "t j=2 v", "0"), "t.tsv: no column \"j\"; found: k v");
    BAD(PLAIN("a", "above", "-", "t k>=1 k<=2 V", "0"), "2 rows");
    BAD(PLAIN("a", "above", "-", "t v=2 K", "0"), "no column \"K\" (did you mean \"k\"?)");
    BAD(PLAIN("a", "above", "-", "t #j", "0"), "no header line \"j\"");
}

static void test_report(void)
{
    write_text("claims.tsv",
               CLAIMS CLAIM("angle", "20.10\t1") PLAIN("high", "above", "-", "many k=8 v", "0"));
    write_text("many.tsv",
               "# note: so it is\n# k\tv\tv_se\tn\n7\t20.1\t0.2\t12\n8\t0.1\t0.01\t12\n9\tnan\tnan\t0\n");
    write_text("in.md", "{{value many k=7 v}}, {{value many k=9 v}}; {{cell many k=7 n}} {{cell many k=8 v "
                        "%%.2g}}; {{note many note}}; {{published angle}}; {{ours high}} of {{number high}}; "
                        "{{verdict high}}; {{counts li}}\n"
                        "{{rows many k>=7 k!=9 | k v:+- n:%%.0f}}\n{{rows none | k}}\n"
                        "All of {{value many k=7 v}} and {{value none v}} piles.\n| {{value none v}} |\n");
    REPORTS("page in.md --tables . --claims claims.tsv");
    CU_ASSERT_STRING_EQUAL(out, "20.10 ± 0.20, not known; 12 0.1; so it is; 20.10 ± 1; 0.100 ± 0.010 of 12; "
                                "reproduced; 1 reproduced, 0 not reproduced, 0 open\n"
                                "| 7 | 20.10 ± 0.20 | 12 |\n| 8 | 0.100 ± 0.010 | 12 |\n| no data |\n"
                                "No data: `none.tsv` has not been made.\n| no data |\n");
    write_text("in.md", "{{cell many v=smallest k}} {{cell many v=largest k}} {{cell many n=largest k}} "
                        "{{cell many n=smallest k}}\n");
    REPORTS("page in.md --tables . --claims claims.tsv");
    CU_ASSERT_STRING_EQUAL(out, "8 7 7 9\n");
    write_text("in.md", "{{claims li}}\n{{scores all}}\n");
    REPORTS("page in.md --tables . --claims claims.tsv");
    CHECK_PARTS(out, "| high | high | word | 0.100 ± 0.010 | 12 | reproduced | note |\n",
                "|---|---|---|---|---|\n| angle | 20.10 ± 1 |  | 2 | no data |\n");
#define BAD_PLACE(text, message)                                                                             \
    write_text("in.md", text);                                                                               \
    REPORT_FAILS(65, message, "page in.md --tables . --claims claims.tsv")
    BAD_PLACE("{{cell many k=7 v_Se}}", "many.tsv: no column \"v_Se\" (did you mean \"v_se\"?)");
    BAD_PLACE("{{value many k<9 v}}", "2 rows");
    BAD_PLACE("{{cell many k=7 v=smallest v}}", "0 rows");
    BAD_PLACE("{{rows many k=11 | v}}", "no row");
    BAD_PLACE("{{claims nowhere}}", "{{claims nowhere}}: no such claim");
    BAD_PLACE("{{scores nowhere}}", "{{scores nowhere}}: no such claim");
    BAD_PLACE("{{verdict nobody}}", "no claim \"nobody\"");
    BAD_PLACE("{{frob t v}}", "unknown word");
    BAD_PLACE("{{value many", "without }}");
}

/* A script of the page of the report on files of the test's folder. */
static int awk(const char *script, const char *arguments)
{
    char path[PATH_MAX];
    CU_ASSERT_PTR_NOT_NULL_FATAL(realpath(check_text("report/page/%s", script), path));
    return shell_line("awk -f %s %s >out 2>err", path, arguments);
}

/* Frames of a run: grain 9 leaves; the frame before `from` and a faint contact are left out; a wall is -1. */
static void test_page_frames(void)
{
    write_text("states.tsv", "# program: x\nstep\tid\tx\ty\tr\n5\t7\t0\t0\t0.1\n10\t7\t0.5\t0.25\t0.1\n"
                             "10\t9\t1.2346\t-0.5\t0.08\n20\t7\t0.75\t0.25\t0.1\n");
    write_text("contacts.tsv", "# program: x\nstep\tid_a\tid_b\twall\tnormal_force\n5\t7\t9\t0\t4\n"
                               "10\t7\t9\t0\t12.4\n10\t9\t0\t1\t3\n20\t7\t0\t2\t0.5\n");
    CU_ASSERT(awk("frames.awk", "-v from=10 -v opens=11 -v dt=5e-05 states.tsv contacts.tsv") == 0);
    CU_ASSERT_STRING_EQUAL(out, "{\"dt\":5e-05,\"opens\":11,\"id\":[7,9],\"r\":[100,80],\"frames\":[\n"
                                "{\"step\":10,\"xy\":[500,250,1235,-500],\"links\":[0,1,12,1,-1,3]},\n"
                                "{\"step\":20,\"xy\":[750,250,null,null],\"links\":[]}]}\n");
}

/* A polygon of a hundred corners on a circle becomes this circle; a square and a curve stay. */
static void test_page_circles(void)
{
    static const char square[] = "<path fill='none' d='M0,0 L9,0 L9,9 L0,9 Z'/>", text[] = "<text>a</text>";
    char corners[4096] = "", curve[4200];
    const double pi = acos(-1.0);
    for (int k = 0; k <= 100; k++)
        snprintf(corners + strlen(corners), sizeof corners - strlen(corners), "%s%.2f,%.2f ", k ? "L" : "M",
                 50 + 5 * cos(k * pi / 50), 40 + 5 * sin(k * pi / 50));
    snprintf(curve, sizeof curve, "<path d='%s'/>", corners);
    write_text("in.svg", "<svg>%s%s<path stroke='red'  d='%sZ  '/></g>%s</svg>\n", square, curve, corners,
               text);
    CU_ASSERT(awk("circles.awk", "in.svg") == 0);
    CU_ASSERT(strncmp(out, "<svg>", 5) == 0 && strstr(out, square) == out + 5);
    CU_ASSERT(strstr(out, curve) == out + 5 + strlen(square));
    CU_ASSERT_STRING_EQUAL(
        out + 5 + strlen(square) + strlen(curve),
        "<circle stroke='red'   cx='50.00' cy='40.00' r='5.00'/></g><text>a</text></svg>\n");
    for (char *c = corners; *c; c++)
        if (*c == 'M' || *c == 'L') *c = ' ';
    write_text("in.svg", "<svg><polygon fill = 'blue' points = '%s'/></svg>\n", corners);
    CU_ASSERT(awk("circles.awk", "in.svg") == 0);
    CU_ASSERT_STRING_EQUAL(out, "<svg><circle fill = 'blue'  cx='50.00' cy='40.00' r='5.00'/></svg>\n");
}

/* ---- run ---- */

/* Frames at multiples of their interval and at the end; the suite `tables` has all columns. */
static void test_free_fall(void)
{
    static const int steps[] = {0, 300, 600, 900, 1000};
    write_text("scene.cfg",
               "gravity = ( 12.5, -981.0 ); dt = 1.0; steps = 1000;\n"
               "particles = ( { x = 0.385; y = 52.85; r = 0.1; m = 0.5; vx = 23.85; vy = 17.5; } );\n");
    PRINTS("\nstep\tt\tid\tx\ty\tangle\tvx\tvy\tomega\tfx\tfy\tr\tm\tcontacts\tfixed\n",
           "run scene.cfg --set dt=5e-5 --every 300");
    scoped_table t = read_table("out");
    CU_ASSERT(t.n_rows == 5);
    for (size_t i = 0; i < t.n_rows && i < 5; i++)
        CHECK_EACH(cell(&t, i, NAME), 1e-15, {"step", steps[i]}, {"t", steps[i] * 5e-5});
    /* without --every, the final state alone: the same row */
    GOOD("run scene.cfg --set dt=5e-5");
    CU_ASSERT(strstr(out, "\n1000\t") && !strstr(out, "\n0\t"));
    PRINTS("\n0\t0\t1\t", "run scene.cfg --set dt=5e-5 --set steps=0");
}

/* A grain at rest on the floor, in three frames; the suite `tables` has all columns. */
static void test_output_folder(void)
{
    const double m = 0.5, overlap = pow(m * 981.0 / 2e6, 2.0 / 3.0);
    write_text("scene.cfg",
               "dt = 2.0e-5; steps = 100; walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } );\n"
               "particles = ( { x = 0.385; y = %.17g; r = 0.1; m = %.17g; } );\n",
               0.1 - overlap, m);
    GOOD("run scene.cfg --set ledger=true --every 50 -o new/d");
    CU_ASSERT(out[0] == '\0');
    SHELL("sed 's/steps = 100;/phases = ( { name = \"a\"; steps = 50; } ); "
          "measure = ( { name = \"x\"; of = \"x\"; } );/' scene.cfg >p.cfg");
    CU_ASSERT(run("run p.cfg -o phases --ledger --quiet") == 0);
    for (int k = 0; k < 2; k++) { /* rows of as many cells as the header */
        scoped_table e = read_table(k ? "phases/energy.tsv" : "new/d/energy.tsv");
        CHECK_NEAR(cell(&e, e.n_rows - 1, "residual"), 0.0, 1e-9);
    }
    scoped_table t = read_table("new/d/states.tsv");
    CU_ASSERT(t.n_rows == 3);
    CHECK_NEAR(cell(&t, 2, "y"), 0.1 - overlap, 1e-14);
    CHECK_NEAR(cell(&t, 2, "contacts"), 1.0, 0.0);
    GOOD("run scene.cfg -o 'two\nlines'"); /* which are one in the header */
    read_again(&t, "two\nlines/states.tsv");
    CU_ASSERT(t.n_rows == 1);
    static const char *const names[] = {"contacts", "walls", "energy"};
    for (size_t k = 0; k < 3; k++) {
        read_again(&t, check_text("new/d/%s.tsv", names[k]));
        CU_ASSERT_FATAL(t.n_rows == 3);
        for (size_t i = 0; i < 3; i++) CHECK_NEAR(cell(&t, i, "step"), 50.0 * (double)i, 0.0);
    }
    CU_ASSERT(rp_table_column(&t, "start") >= 0);
    GOOD("run scene.cfg -o new/d --force");
    read_again(&t, "new/d/energy.tsv");
    CU_ASSERT(rp_table_column(&t, "start") < 0 && rp_table_column(&t, "rotational") >= 0);
}

/* A floor too soft to carry the grain: the run stops, and keeps its output so far. */
static void test_broken_run(void)
{
    write_text("scene.cfg",
               "steps = 100000; walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; k_n = 10.0; } );\n"
               "particles = ( { x = 0.0; y = 0.5; r = 0.1; m = 0.004; } );\n");
    FAILS(1, "leaked at step ", "run scene.cfg --every 100");
    CU_ASSERT(strstr(err, "grain 1: its centre passed wall 1") != NULL);
    scoped_table t = read_table("out");
    /* it falls 0.5 cm first: sqrt(2 * 0.5/981) s, 638 steps */
    CU_ASSERT(t.n_rows >= 7 && t.n_rows < 20);
    for (size_t i = 0; i < t.n_rows; i++) CHECK_NEAR(cell(&t, i, "step"), 100.0 * (double)i, 0.0);
    FAILS(1, "leaked at step ", "run scene.cfg --every 100 -o d");
    CHECK_PARTS(err, "; the tables so far are in d.part");
    CU_ASSERT(shell("exec \"$REPOSE\" run scene.cfg --every 100 >out 2>err") == 1);
    CU_ASSERT(equal_tables("out", "d.part/states.tsv"));
    SHELL("tail -n 1 out | grep -q '^# unfinished: leaked at step' && ! test -e d");
}

/* ---- sweep ---- */

/* Two grid points, two replicas, in a small box. */
static void write_sweep(void)
{
    write_text("s.cfg", "protocol = \"repose\"; replicas = 2; seed = 1993;\n"
                        "fixed = { " SHORT_RUN " };\ngrid = { mu = [0.2, 0.3]; };\n");
}

static void test_sweep(void)
{
    write_sweep();
    PRINTS("d1: 4 runs (2 grid points x 2 replicas), 0 already stored", "sweep plan s.cfg -o d1");
    FAILS(1, "d1: 4 of 4 runs are missing", "sweep digest d1");
    FAILS(1, "the table is not whole: d1: 4 of 4 runs are missing", "sweep export d1 -o part.tsv");
    SHELL("test $(grep -vc '^#' part.tsv) = 1"); /* the names, and no run */
    FAILS(1, "not whole", "export d1 --to csv");
    GOOD("sweep run d1 -j 1");
    GOOD("sweep digest d1");
    CU_ASSERT(strspn(out, "0123456789abcdef") == 32 && strcmp(out + 32, "\t4\n") == 0);
    const char *digest = check_text("%.40s", out);
    GOOD("sweep plan s.cfg -o d2");
    GOOD("sweep run d2 -j 2");
    PRINTS_ALL(digest, "sweep digest d2");
    PRINTS("# planned: 4\n# stored: 4\n# missing: 0\n", "sweep status d2");
    scoped_table t = read_table("out");
    CU_ASSERT(t.n_rows == 1);
    CU_ASSERT_STRING_EQUAL(word(&t, 0, "status"), "ok_fixed_time");
    CHECK_NEAR(cell(&t, 0, "runs"), 4.0, 0.0);
    PRINTS("4 already stored", "sweep plan s.cfg -o d2");
}

/* Runs, points, derived tables and traces by one command; then models. */
static void test_make(void)
{
    write_text("s.cfg", "protocol = \"repose\"; replicas = 1; study = 2; seed = 1993;\n"
                        "fixed = { " SHORT_RUN " };\ngrid = { mu = [0.2, 0.3]; };\n"
                        "derive = ( { x = \"mu\"; table = \"line\"; with = \"fit\"; rows = \"points\"; y = "
                        "\"theta_r3_deg_mean\"; },\n"
                        "           { table = \"lines\"; with = \"fit\"; rows = \"line\"; x = \"slope\"; y = "
                        "\"intercept\"; } );\n"
                        "trace = ( { rows = [0, 1]; every = 50; } );\n");
    CU_ASSERT(run("sweep make s.cfg -o d --tables t -j 1") == 0);
    scoped_table runs = read_table("t/runs.tsv");
    CU_ASSERT(runs.n_rows == 2);
    CU_ASSERT(run("sweep make s.cfg -o d --tables t -j 1 --study") == 0);
    read_again(&runs, "t/runs.tsv");
    CU_ASSERT(runs.n_rows == 4);
    scoped_table reduced = read_table("t/points.tsv"), line = read_table("t/line.tsv"),
                 row = read_table("t/row_1.tsv");
    CU_ASSERT(reduced.n_rows == 2);
    CHECK_NEAR(cell(&line, 0, "slope"),
               (cell(&reduced, 1, "theta_r3_deg_mean") - cell(&reduced, 0, "theta_r3_deg_mean")) / 0.1, 1e-9);
    CHECK_NEAR(cell(&row, 0, "theta_r2_deg"), cell(&runs, 2, "theta_r2_deg"), 0.0);
    SHELL("test -s t/row_0/energy.tsv && test -s t/row_1/energy.tsv");
    /* lineage, handed on to what is derived from a derived table */
    GOOD("sweep digest d");
    const char *source = check_text("s %.32s 4", out);
    CU_ASSERT_STRING_EQUAL(rp_table_find_note(&reduced, "source"), source);
    CU_ASSERT_STRING_EQUAL(rp_table_find_note(&line, "source"), source);
    CU_ASSERT_STRING_EQUAL(rp_table_find_note(&line, "derived by"), "fit x=mu y=theta_r3_deg_mean");
    scoped_table lines = read_table("t/lines.tsv");
    CU_ASSERT_STRING_EQUAL(rp_table_find_note(&lines, "source"), source);

    /* names are no patterns */
    CU_ASSERT(run("sweep make s.cfg -o d --tables 't[1]' --study") == 0);
    CU_ASSERT(equal_tables("t/line.tsv", "t[1]/line.tsv"));
    write_text("m.cfg",
               "model = ( { table = \"1\"; with = \"continuum\"; alpha_deg = 30.0; },\n"
               "          { table = \"f\"; with = \"pile\"; base = 3; eps = 1e-3; folder = true; } );\n");
    /* folders of tables are made anew too, but not those of a person or of another command */
    for (int again = 0; again < 2; again++) GOOD("sweep make m.cfg -o d --tables u");
    SHELL("test -e u/f/disks.tsv");
    GOOD("continuum --alpha-deg 30");
    SHELL("grep -v '^#' out >a && grep -v '^#' u/1.tsv | cmp - a");
    SHELL("echo mine >u/f/notes");
    FAILS(65, "f: u/f/notes: not of a result", "sweep make m.cfg -o d --tables u");
}

/* Each derivation of stored runs, by the setting and by the command, gives the same lines of data. */
static void test_derivations(void)
{
    static const struct {
        const char *with, *setting, *command;
    } cases[] = {
        {"fit", "x = \"alpha_deg\"; y = \"D\"; from = 20.0; where = \"alpha_deg<50\";",
         "stats fit -x alpha_deg -y D --from 20 --where 'alpha_deg<50'"},
        {"trend", "x = \"alpha_deg\"; y = \"D\"; scale = \"log\"; power = 1.0;",
         "stats trend -x alpha_deg -y D --scale log --power 1"},
        {"size", "x = \"alpha_deg\"; y = \"D\"; power = 1.0;", "stats size -x alpha_deg -y D --power 1"},
        {"correlation", "x = \"D,middle\"; y = \"H_ratio\";", "stats correlation -x D,middle -y H_ratio"},
        {"dip", "where = [\"alpha_deg>20\", \"alpha_deg<50\"];",
         "stress dip --where 'alpha_deg>20' --where 'alpha_deg<50'"},
        {"dip", "profile = true;", "stress dip --profile"}};
    const char *text =
        "protocol = \"pile\"; replicas = 6;\n"
        "fixed = { base = 9; disorder = 1e-4; };\ngrid = { alpha_deg = [30.0, 40.0, 50.0]; };\nderive = (";
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        text = check_text("%s%s { table = \"t%zu\"; with = \"%s\"; %s }", text, k ? ",\n" : "", k,
                          cases[k].with, cases[k].setting);
    write_text("s.cfg", "%s );\n", text);
    CU_ASSERT(run("sweep make s.cfg -o d --tables t -j 1") == 0);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        run("%s t/runs.tsv", cases[k].command);
        CHECK_OR_SAY(shell_line("grep -v '^#' out >a && test -s a && grep -v '^#' t/t%zu.tsv | cmp - a", k) ==
                         0,
                     "%s", cases[k].command);
    }
    /* every derivation of the lists; the suite `tables` tests those of measured angles and of traces */
    const cli_command *const *const groups[] = {cmd_stats.group, cmd_stress.group, cmd_angle.group};
    for (size_t g = 0; g < 3; g++)
        for (const cli_command *const *c = groups[g]; *c; c++) {
            bool tested = !(*c)->derives || strstr(" compare field base ", cli_own_name(*c));
            for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
                tested |= strcmp(cases[k].with, cli_own_name(*c)) == 0;
            CHECK_OR_SAY(tested, "%s: no case", (*c)->name);
        }
}

/* What a setting cannot say is refused before any run, with its line. */
static void test_settings(void)
{
#define DERIVE(with, rest) "derive = ( { table = \"a\"; with = \"" with "\"; " rest "} );"
    static const char *const cases[][2] = {
        {DERIVE("fits", ""), "with = \"fits\": allowed: fit trend size"},
        {"derive = ( { with = \"fit\"; } );", "table: missing"},
        {"derive = ( { table = \"a/b\"; with = \"compare\"; } );", "table: a/b: the name of a file"},
        {"derive = ( { table = \"runs\"; with = \"compare\"; } );", "table: runs: stands twice"},
        {DERIVE("compare", "}, { table = \"a\"; with = \"compare\"; "), "table: a: stands twice"},
        {DERIVE("fit", "frm = 1.0; "), "frm: unknown key (did you mean \"from\"?)"},
        {DERIVE("compare", "phi_deg = -1.0; "), "phi_deg = -1: out of range"},
        {DERIVE("compare", "o = \"x\"; "), "o: unknown key"},
        {DERIVE("compare", "rows = \"b\"; "), "rows = \"b\": runs, points or an"},
        {DERIVE("compare", "rows = [\"points\"]; "), "rows = \"\": runs, points or an"},
        {DERIVE("compare", "where = [1]; "), "where = 1: text expected"},
        {DERIVE("fit", "x = \"alpha_deg\"; "), "y: missing"},
        {DERIVE("fit", "x = \"alpha_deg\"; y = \"DD\"; "), "a: y: runs: no column"},
        {DERIVE("fit", "rows = \"points\"; x = \"alpha_deg\"; y = \"D\"; "), "a: y: points: no column"},
        {DERIVE("compare", "of = [\"x/y\"]; "), "of: names of sweeps"},
        {DERIVE("compare", "of = [ ]; "), "of: names of sweeps"},
        {DERIVE("compare", "of = \"x\"; "), "of: names of sweeps"},
        {DERIVE("compare", "of = [\"x\", \"y\", \"x\"]; "), "of: names of sweeps"},
        {DERIVE("compare", "of = [\"x\"]; rows = \"points\"; "), "of: names of sweeps"},
        {DERIVE("field", "width = 4.0; "), "a stress field: stage missing"},
        {DERIVE("compare", "stage = \"b\"; "), "a angle compare: stage is for piles"},
        {"derive = { };", "derive: a list ("},
        {"trace = ( { every = 3; } );", "rows: missing"},
        {"trace = ( { rows = [-1]; } );", "rows: numbers of runs from 0"},
        {"trace = ( { rows = [0.5]; } );", "rows: numbers of runs from 0"},
        {"trace = ( { rows = [\"0\"]; } );", "rows: numbers of runs from 0"},
        {"trace = ( { rows = [0]; quiet = true; } );", "quiet: unknown key"},
        {"model = ( { table = \"a\"; with = \"fit\"; } );",
         "with = \"fit\": allowed: pile tent continuum lattice"},
        {"model = ( { table = \"a\"; with = \"tent\"; x1 = 0.9; } );", "x1 = 0.9: out of range"},
        {"model = ( { table = \"a\"; with = \"tent\"; x1 = 0.3; folder = true; } );", "folder: only a pile"},
        {"model = ( { table = \"a\"; with = \"pile\"; folder = 1; } );", "folder: only a pile"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        write_text("s.cfg",
                   "protocol = \"pile\"; replicas = 1; fixed = { base = 4; };\ngrid = { alpha_deg = [30.0]; "
                   "};\n%s\n",
                   cases[k][0]);
        FAILS(65, cases[k][1], "sweep make s.cfg -o d --tables t");
        CU_ASSERT(strstr(err, "s.cfg:3: ") != NULL);
    }
    write_text("s.cfg", "experiment = \"gone.cfg\"; replicas = 1;\n");
    FAILS(65, "gone.cfg: cannot read", "sweep make s.cfg -o d");
    CU_ASSERT(access("d", F_OK) != 0 && access("t", F_OK) != 0);
    write_text(
        "s.cfg",
        "protocol = \"pile\"; replicas = 1; fixed = { base = 4; };\n"
        "derive = ( { table = \"a\"; with = \"correlation\"; of = [\"x\"]; x = \"D\"; y = \"D\"; } );\n");
    FAILS(65, "a reads the runs of x, which must be made first", "sweep make s.cfg -o e/d --tables t");
    SHELL("sed '/derive/d' s.cfg >x.cfg && $REPOSE sweep plan x.cfg -o e/x >out");
    FAILS(1, "must be made first: e/x: 1 of 1 runs are missing", "sweep make s.cfg -o e/d --tables t");
    /* what is known of the tables before the first run */
    static const char *const late[][2] = {
        {"trace = ( { rows = [99]; } );", "rows: row_99: the sweep has 1 runs, from 0"},
        {"derive = ( { table = \"mine\"; with = \"compare\"; } );",
         "m: holds other files; give another folder"}};
    SHELL("mkdir m && echo notes >m/mine.tsv");
    for (int k = 0; k < 2; k++) {
        write_text("s.cfg", "protocol = \"pile\"; replicas = 1; fixed = { base = 4; }; %s\n", late[k][0]);
        FAILS(65, late[k][1], "sweep make s.cfg -o e/d --tables m --force");
        CU_ASSERT(access("e/d/tables/runs.tsv", F_OK) != 0 && strcmp(out, "") == 0);
    }
}

/* Shared piles differ only after the opening. */
static void test_shared_piles(void)
{
    write_text("s.cfg", "protocol = \"repose\"; replicas = 2; seed = 1993; piles = \"shared\";\n"
                        "fixed = { " SHORT_RUN " };\ngrid = { floor = [\"extends\", \"absorbs\"]; };\n");
    GOOD("sweep plan s.cfg -o d");
    GOOD("sweep run d");
    scoped_table t = TABLE_OF("sweep export d");
    CU_ASSERT(t.n_rows == 4);
    for (size_t k = 0; k < 2; k++) {
        CU_ASSERT(cell(&t, k, "pile") == (double)k && cell(&t, k + 2, "pile") == (double)k);
        CU_ASSERT_STRING_EQUAL(word(&t, k, "fill_steps_used"), word(&t, k + 2, "fill_steps_used"));
        CU_ASSERT_STRING_NOT_EQUAL(word(&t, k, "residual_energy"), word(&t, k + 2, "residual_energy"));
    }
    /* the last row again, by itself, and the fills of others */
    GOOD("run s.cfg --row 1 -o first");
    GOOD("run s.cfg --row 2 -o other");
    GOOD("run s.cfg --row 3 -o box");
    CU_ASSERT(equal_tables("first/filled_grains.tsv", "box/filled_grains.tsv"));
    CU_ASSERT(!equal_tables("other/filled_grains.tsv", "box/filled_grains.tsv"));
    scoped_table again = read_table("out");
    CU_ASSERT_STRING_EQUAL(word(&again, 0, "residual_energy"), word(&t, 3, "residual_energy"));
}

/* One row of a sweep again: the stored numbers, and tables of its states. */
static void test_row_again(void)
{
    write_sweep();
    scoped_table again = TABLE_OF("run s.cfg --row 1 -o box --every 1000 --ledger");
    GOOD("sweep plan s.cfg -o d");
    GOOD("sweep run d -j 2");
    scoped_table runs = TABLE_OF("sweep export d");
    for (const sweep_output *o = protocol_of(&sweep_protocol_repose)->outputs; o->name; o++)
        CU_ASSERT_STRING_EQUAL(word(&again, 0, o->name), word(&runs, 1, o->name));
    GOOD("run s.cfg --row 1 -o again");
    CU_ASSERT(equal_tables("again/pile_grains.tsv", "box/pile_grains.tsv"));
    CU_ASSERT(equal_tables("again/pile_contacts.tsv", "box/pile_contacts.tsv"));
    CU_ASSERT(!equal_tables("again/pile_grains.tsv", "box/filled_grains.tsv"));
    CU_ASSERT(equal_tables("again/phases.tsv", "box/phases.tsv"));
    scoped_table measures = TABLE_OF("run box/scene.cfg --quiet");
    for (size_t row = 0; row < measures.n_rows; row++)
        CU_ASSERT_STRING_EQUAL(word(&measures, row, "value"),
                               word(&again, 0, word(&measures, row, "measure")));
    scoped_table energy = read_table("box/energy.tsv");
    CU_ASSERT_FATAL(energy.n_rows == 4);
    for (size_t i = 0; i < 4; i++) /* at multiples, though a phase ends between two of them */
        CHECK_NEAR(cell(&energy, i, "step"), 1000.0 * (double)(i + 1), 0.0);
    CU_ASSERT(cell(&energy, 3, "normal_damping") > 0.0);
    CHECK_NEAR(cell(&energy, 3, "residual"), 0.0, 1e-10 * cell(&energy, 3, "turnover"));
}

/* A short run, which is there already, and an endless one. */
static void plan_endless(void)
{
    const char *grid = "protocol = \"repose\"; replicas = 1; seed = 1993;\n"
                       "fixed = { W = 2.0; H = 2.0; fill_steps = 100; stop = \"steps\"; };\n"
                       "grid = { relax_steps = [100%s]; };\n";
    write_text("s.cfg", grid, "");
    GOOD("sweep plan s.cfg -o d");
    GOOD("sweep run d");
    write_text("s.cfg", grid, ", 1000000000");
    GOOD("sweep plan s.cfg -o d");
}

/* An endless run and a large one end at their limits: the others are made, no digest or table hides it. */
static void test_limits(void)
{
    plan_endless();
    CU_ASSERT(run("sweep run d -j 2 --time 0.5") == 1 &&
              strstr(err, "1 of 2 runs were aborted (time_limit 1); the same"));
    CU_ASSERT(strstr(err, "run 1 (relax_steps = 1e+09): ended after ") != NULL);
    CHECK_PARTS(out, "# missing: 0\n# aborted: 1, to be tried again\n",
                "\nok_fixed_time\t1\ntime_limit\t1\n");
    FAILS(1, "no digest: d: 1 of 2 runs were aborted", "sweep digest d");
    for (int reduce = 0; reduce < 2; reduce++) {
        FAILS(1, "not whole: d: 1 of 2 runs were aborted", "sweep export d%s", reduce ? " --reduce" : "");
        CU_ASSERT(
            strstr(out, "# failed: 1 of 2 (time_limit 1)\n# aborted: 1 of the failed, to be tried again\n") !=
            NULL);
    }
    scoped_table points = read_table("out");
    for (size_t k = 0; k < 2; k++)
        CHECK_EACH(cell(&points, k, NAME), 0.0, {"n", k == 0}, {"n_failed", k == 1});
    CU_ASSERT(run("sweep make s.cfg -o d --tables t --time 0.5") == 1 && strstr(err, "(time_limit 1)"));
    CU_ASSERT_STRING_EQUAL(out, "s: 2 runs: 1 ok_fixed_time, 1 time_limit\n");
    SHELL("! ls t | grep -q .");
    write_text("p.cfg", "protocol = \"pile\"; replicas = 1; fixed = { disorder = 1.0e-3; well = 1.0; };\n"
                        "grid = { base = [12, 700]; };\n");
    GOOD("sweep plan p.cfg -o p");
    if (!check_fast()) { /* a sanitizer takes terabytes of addresses */
        CU_ASSERT(run("sweep run p --mem 40") == 1 && strstr(err, "1 of 2 runs were aborted (no_memory 1)"));
        CU_ASSERT(strstr(err, "run 1 (base = 700): pile of 245350 disks: out of memory; no_memory") != NULL);
    }
}

/* Stopped during its endless run: stored runs stay, and status 75 means "resume". */
static void test_stopped(void)
{
    plan_endless();
    CU_ASSERT(failed(__FILE__, __LINE__, run_signalled(SIGTERM, "clock", 9, "sweep run d -j 1 --quiet"), 75,
                     "1 of 2 stored"));
    GOOD("sweep status d");
    CU_ASSERT(strstr(out, "# stored: 1\n# missing: 1\n") != NULL);
    FAILS(1, "missing", "sweep digest d");
}

/* A folder is of one scene: a change of any particle is another. Gravity of 9.8 in any direction is said. */
static void test_run_scene(void)
{
    for (int k = -1; k < 3; k++) {
        const double x[] = {1.0 + (k == 0), 4.0 + (k == 1), 7.0 + (k == 2)};
        write_text("s.cfg",
                   "steps = 2; particles = ( { x = %g; y = 5.0; r = 0.1; }, { x = %g; y = 5.0; r = 0.1; },\n"
                   "                         { x = %g; y = 5.0; r = 0.1; } );\n",
                   x[0], x[1], x[2]);
        CU_ASSERT((run("run s.cfg -o d --quiet") == 0) == (k < 0));
        CU_ASSERT(k < 0 || strstr(err, "d: ") != NULL);
    }
    for (int k = 0; k < 4; k++) {
        static const char *const gravity[] = {"0.0, -9.8", "-9.8, 0.0", "-5.0, -5.0", "0.0, -10.0"};
        CU_ASSERT(run("run s.cfg --quiet --set 'gravity=[%s]'", gravity[k]) == 0);
        CU_ASSERT((strstr(err, " among values in cm") != NULL) == (k < 2));
    }
}

/* The help has the columns of the states in their order, and its lists in that of what is printed. */
static void test_run_help(void)
{
    static const char *const lists[] = {"states.tsv, contacts.tsv, walls.tsv", "number of grains and steps",
                                        "grains, contacts and walls", "disks, contacts, wells",
                                        "direction_x, direction_y"};
    static char help[sizeof out];
    SHELL("{ \"$REPOSE\" run --help && \"$REPOSE\" params --help; } 2>err | tr -s '\\n ' ' ' >out");
    slurp("out", help, sizeof help);
    for (size_t k = 0; k < sizeof lists / sizeof *lists; k++) CU_ASSERT_PTR_NOT_NULL(strstr(help, lists[k]));
    const char *at = strstr(help, "states.tsv step, ");
    CU_ASSERT_PTR_NOT_NULL_FATAL(at);
    write_text("s.cfg", "steps = 1; particles = ( { x = 1.0; y = 5.0; r = 0.1; } );\n");
    CU_ASSERT(run("run s.cfg") == 0);
    scoped_table t = read_table("out");
    for (size_t c = 0; at && c < t.n_columns; c++) CU_ASSERT_PTR_NOT_NULL(at = strstr(at, t.names[c]));
}

/* The growth that the warning names: mean energy of the last 16 of 64 samples less that of the first 16, over
 * the largest kinetic and elastic energy, from the table of energies. */
static void check_growth(int every)
{
    double first = 0.0, last = 0.0, most = 0.0;
    CU_ASSERT(run("run s.cfg --set steps=%d --every %d -o d%d", 64 * every, every, every) == 0);
    scoped_table t = read_table(check_text("d%d/energy.tsv", every));
    CU_ASSERT_EQUAL(t.n_rows, 65);
    for (size_t i = 1; i < t.n_rows; i++) {
        const double moving = cell(&t, i, "kinetic") + cell(&t, i, "elastic");
        most = fmax(most, moving);
        if (i <= 16) first += (moving + cell(&t, i, "gravity")) / 16.0;
        if (i > 48) last += (moving + cell(&t, i, "gravity")) / 16.0;
    }
    CU_ASSERT(last > first &&
              strstr(err, check_text("energy grew by %.2g %% of", 100.0 * (last - first) / most)));
}

/* At the largest step allowed, 30 grains without damping heat up in thousands of impacts; at a fifth of it,
 * or with damping, their energy does not grow. */
static void test_energy_growth(void)
{
    if (CHECK_SKIPS("a long run: other runs of the program are shorter")) return;
    write_text("s.cfg",
               "steps = 1280000; dt = 3.1e-5; normal = { k_n = 1.0e6; gamma_n = 1e-9; };\n"
               "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; },\n"
               "          { point = [0.0, 0.0]; direction = [1.0, 0.0]; },\n"
               "          { point = [2.0, 0.0]; direction = [-1.0, 0.0]; } );\n"
               "fill = { N = 30; W = 2.0; H = 3.0; seed = 5; radius_mean = 0.1; radius_width = 0.0; };\n");
    CU_ASSERT(run("run s.cfg") == 0 && strstr(err, "warning: energy grew by "));
    CU_ASSERT(strstr(out, "\n# warning: energy grew by ") != NULL);
    GOOD("run s.cfg --set dt=6e-6");
    GOOD("run s.cfg --set normal.gamma_n=50");
    check_growth(20000);
    /* runs that are too short, and what takes or gives energy or grains */
    static const char *const silent[] = {"steps=6399",
                                         "gravity_turn_deg_per_step=1e-12",
                                         "box_turn_deg_per_step=1e-12",
                                         "walls[2].open_at_step=1279999",
                                         "walls[0].velocity=[1.0e-12, 0.0]",
                                         "y_min=-1' --set 'walls[0].extent=[0.0, 1.5]"};
    for (size_t k = 0; k < sizeof silent / sizeof *silent; k++) GOOD("run s.cfg --set '%s'", silent[k]);
}

/* A grain slides down a slope. With the dashpot outside Coulomb's limit that is said, once; not of a grain
 * that sticks, by its own friction or the wall's. */
static void test_drag(void)
{
    static const char told[] = "warning: t = 0.1: the tangential force of 1 of 1 contacts exceeds mu",
                      slope[] = "dt = 5e-5; tangential = { law = \"spring\"; mu = 0.3; };\n"
                                "walls = ( { point = [0.0, 0.0]; direction = [1.0, 2.0]; } );\n"
                                "particles = ( { x = 0.0447; y = 0.0894; r = 0.1; } );\n";
    for (int phases = 0; phases < 2; phases++) {
        write_text("s.cfg", "%s%s", slope,
                   phases ? "phases = ( { name = \"a\"; steps = 2000; }, { name = \"b\"; steps = 2000; } );\n"
                          : "steps = 4000;\n");
        GOOD("run s.cfg");
        CU_ASSERT(run("run s.cfg --set tangential.damping=outside --every 2000 -o d%d", phases) == 0);
        const char *first = strstr(err, told);
        CU_ASSERT(first && !strstr(first + 1, "warning"));
        CU_ASSERT(run("run s.cfg --set tangential.damping=outside --quiet") == 0 && !*err);
        CU_ASSERT(run("run s.cfg --set tangential.damping=outside") == 0 && strstr(err, "warning"));
        for (int wall = 0; wall < 2; wall++)
            GOOD("run s.cfg --set tangential.damping=outside --set '%s.mu=0.9'",
                 wall ? "walls[0]" : "tangential");
    }
}

/* A point of a sweep without damping, or with a restitution without its speed, is refused as a scene is. */
static void test_undamped_sweep(void)
{
    write_text("s.cfg", "protocol = \"repose\"; fixed = { W = 2.0; H = 2.0; };\n"
                        "grid = { gamma_n = [0.0, 50.0]; mu = [0.1, 0.2, 0.3]; };\n");
    CU_ASSERT(run("sweep plan s.cfg -o d") == 65 &&
              strstr(err, "grid point gamma_n = 0, mu = 0.1: protocol repose: dt = 5e-05: too large"));
    write_text("s.cfg", "protocol = \"repose\"; fixed = { W = 2.0; H = 2.0; restitution = 0.5; };\n");
    CU_ASSERT(run("sweep plan s.cfg -o d") == 65 && strstr(err, "give one, the other follows"));
    write_text("s.cfg", "protocol = \"repose\"; set = [\"normal.gamma_n=auto\"];\n"
                        "fixed = { W = 2.0; H = 2.0; restitution = 0.5; };\n");
    CU_ASSERT(run("sweep plan s.cfg -o d") == 65 && strstr(err, "give restitution_speed, in (0, inf)"));
}

/* As under nohup: a hangup amid the run is no stop. */
static void ignore_hangup(void)
{
    signal(SIGHUP, SIG_IGN);
    fault_tick = 1.0;
    fault_signal(SIGHUP, "clock", 9);
}

/* Each signal stops a run, where it has no tables to write for long, too. The suite `run` has what it leaves,
 * and what the same command goes on with. Streams that are closed are no files of the run. */
static void test_run_stopped(void)
{
    static const int signals[] = {SIGTERM, SIGINT, SIGHUP};
    write_text("s.cfg",
               "steps = 2000; particles = ( { x = 0.0; y = 0.0; r = 0.1; } ); gravity = [0.0, 0.0];\n");
    write_text("many.cfg", "steps = 2000000000; fill = { N = 90; W = 2.0; H = 4.0; };\n"
                           "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } );\n");
    GOOD("run s.cfg --every 10 -o d");
    SHELL("\"$REPOSE\" run s.cfg --every 10 -o closed <&- >&- 2>&-; grep -v '^#' closed/states.tsv >out; "
          "grep -v '^#' d/states.tsv | cmp - out");
    for (int k = 0; k < 3; k++) {
        CU_ASSERT(run_signalled(signals[k], "clock", 9 + k, "run many.cfg -o many") == 75);
        CHECK_PARTS(err, "stopped", "; the same command continues\n");
    }
    SHELL("test -s many.part/snapshot && ! test -e many");
    CU_ASSERT(run_begun("run many.cfg --set steps=30000 -o whole", ignore_hangup) == 0);
}

CHECK_SUITE_WITHIN(cli, "command line", enter, leave, test_hardened, test_help, test_wrong_usage,
                   test_bad_values, test_killed_plans, test_bench, test_bad_scenes, test_bad_sweeps,
                   test_sweep_or_scene, test_broken_output, test_angles, test_group_order, test_angle_tables,
                   test_stress_tables, test_claims, test_families, test_pooled, test_bad_claims, test_report,
                   test_page_frames, test_page_circles, test_cut_drops, test_stats_trends, test_stats_select,
                   test_free_fall, test_output_folder, test_broken_run, test_sweep, test_make,
                   test_derivations, test_settings, test_shared_piles, test_row_again, test_run_stopped,
                   test_energy_growth, test_drag, test_run_help, test_run_scene, test_undamped_sweep,
                   test_limits, test_stopped)
