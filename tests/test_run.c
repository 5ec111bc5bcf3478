/* A run that is stopped or killed, wherever that happens, is gone on with by the same command, and leaves
 * what an undisturbed one leaves: of a scene, of phases with measures, of a row of a sweep, and of whole
 * sweeps. A look at the clock takes the time from one snapshot to the next, so that nothing here depends on
 * real time. */
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sweeps/engine/sweep.h"
#include "sweeps/protocols/protocols.h"
#include "tests/faults.h"
#include "tests/program.h"
#include "tests/trial.h"

/* ---- one run, with every sink ---- */

/* A pile of rolling grains whose wall is lifted while gravity turns, and which grains leave. */
static void write_scene(void)
{
    static const char scene[] = "rotation = true; dt = 5.0e-5; steps = 1500; ledger = true; x_max = 2.5;\n"
                                "gravity_turn_deg_per_step = 0.01; turn_from_step = 700;\n"
                                "normal = { law = \"hertz\"; k_n = 1.0e6; gamma_n = 500.0; };\n"
                                "tangential = { law = \"spring\"; k_s = 1.0e4; gamma_s = 5.0; mu = 0.2; };\n"
                                "rolling = { mu = 0.05; };\n"
                                "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; }, { point = [0.0, "
                                "0.0]; direction = [1.0, 0.0]; },\n"
                                "  { point = [2.0, 0.0]; direction = [-1.0, 0.0]; extent = [0.0, 9.0]; "
                                "open_at_step = 900; open_speed = 50.0; } );\n"
                                "fill = { N = 40; W = 2.0; H = 2.0; seed = 3; };\n";
    file_write(path_of("s.cfg"), scene, sizeof scene - 1);
}

#define RUN "run s.cfg --every 70 -o d"

/* Run undisturbed; its tables are then in the folder `whole`. */
static void run_undisturbed(void)
{
    write_scene();
    SHELL("\"$REPOSE\" " RUN " && mv d whole");
}

/* All tables equal those of the undisturbed run, and nothing else is left. */
static bool equal_files(void)
{
    return shell("diff -r d whole >diff || { head -c 1500 diff >&2; false; } && ! test -e d.part") == 0;
}

/* Much of what phases do and measures keep. */
static const char acting[] =
    "dt = 5e-5; seed = 2; let = { times = 3; }; tangential = { law = `spring`; mu = 0.4; }; ledger = true;\n"
    "walls = ( { name = `base`; point = (0.0, 0.0); direction = (0.0, 1.0); },\n"
    "  { name = `lid`; point = (0.0, 5.0); direction = (0.0, -1.0); } );\n"
    "fill = ( { kind = `a`; N = 20; W = 2.0; H = 3.0; }, { kind = `b`; pattern = `row`; W = 2.0; x0 = 3.0; } "
    ");\n"
    "regions = { part = { polygon = ( (0.0, 0.0), (2.0, 0.0), (1.0, `lid.y`) ); }; "
    "box = { x = (0.0, 2.0); y = (0.0, 2.0); }; };\n"
    "output = { states = 500; contacts = 0; walls = 300; };\n"
    "phases = ( { name = `fall`; steps = 900; damp = true; every = 70; },\n"
    "  { name = `press`; walls = { lid = { load_y = `-10*lid.y`; speed = 50.0; }; }; steps = 600; },\n"
    "  { name = `feed`; repeat = `times`; phases = ( { name = `drop`; mark = true;\n"
    "      add = { N = 1; kind = `c`; r = 0.1; x = (2.2, 2.8); y = `touch + r`; vy = `-y`; };\n"
    "      every = 10; most = 300; go_on = true; until = `held(touched, 3)`; } ); },\n"
    "  { name = `again`; from = `fall`; tangential = { mu = 0.2; }; dt = 2e-5; remove = `part`; steps = 500; "
    "} );\n"
    "measure = ( { name = `mean_y`; of = `y`; during = `fall`; take = `mean`; every = 30; series = true; },\n"
    "  { name = `most`; of = `change(lid.y)`; during = `press`; take = `max`; every = 20; },\n"
    "  { name = `flow`; of = `profile`; in = `box`; during = `again`; every = 40; bins = 4; },\n"
    "  { name = `moved`; of = `moved(0.01)`; at = `drop`; take = `mean`; },\n"
    "  { name = `s`; of = `part.syy + c.y + sliding`; at = `feed`; optional = true; },\n"
    "  { name = `order`; of = `order`; at = `fall`; } );\n";

/* Is d.part a result that lacks its name alone? */
#define IS_WHOLE "sed -n 3p d.part/.repose 2>err | grep -q ."

/* Stopped or killed before ever later calls that change a file: each snapshot, each rename, the end. */
static void any_call(void)
{
    static const int signals[] = {SIGTERM, SIGKILL}, ends[] = {75, 128 + SIGKILL};
    static const struct {
        const char *words;
        long step; /* from one call to the next */
    } runs[] = {{RUN, 2},
                {"run q.cfg -o d", 1},
                {"run a.cfg -o d --every 110", 3},
                {"run r.cfg --row 1 -o d --every 700", 5}};
    write_scene();
    /* at rest in all of its last looks, which are more than one process makes */
    write_text("q.cfg",
               "steps = 9000; gravity = [0.0, 0.0]; particles = ( { x = 0.0; y = 0.0; r = 0.1; } );\n");
    write_trial("a.cfg", acting);
    write_text("r.cfg", "protocol = \"repose\"; fixed = { W = 1.6; H = 1.6; theta_t = true; tilt_rate_deg = "
                        "0.01; };\n");
    for (size_t k = 0; k < sizeof runs / sizeof *runs; k++) {
        if (k == 3 && check_fast()) continue;
        CU_ASSERT(shell_line("rm -rf d whole; \"$REPOSE\" %s >whole.out 2>whole.err && mv d whole",
                             runs[k].words) == 0);
        for (int s = 0; s < 2; s++) {
            int status = -1, stops = 0;
            bool told = true; /* the last of them came to its closing line */
            SHELL("rm -rf d");
            for (long n = 1; status != 0 && n < 400; n += runs[k].step) {
                status = run_by_minutes(signals[s], "", n, runs[k].words);
                CHECK_OR_SAY(status == 0 || status == ends[s], "%s, call %ld: status %d, %s", runs[k].words,
                             n, status, err);
                stops += status != 0;
                if (status != 0 && shell(IS_WHOLE) == 0) FAILS(65, "d: holds ", "%s", runs[k].words);
                if (status != 0 && shell("test -e d") == 0) status = 0, told = false;
            }
            CHECK_OR_SAY(status == 0 && stops > 5, "%s: status %d, %d stops", runs[k].words, status, stops);
            CU_ASSERT(equal_files());
            if (told)
                SHELL("for t in whole.out out; do grep -v run_time $t >$t.rest; done; cmp whole.out.rest "
                      "out.rest && [ \"$(tail -n 1 err)\" = \"$(tail -n 1 whole.err)\" ]");
        }
    }
}

/* Killed before each call of a short run: the same command makes it, or gives a whole result its name; by
 * force in place of another, one of which has the name all the time. */
static void each_call(void)
{
    static const char *const words[] = {"run q.cfg -o d", "run q.cfg -o d --force"};
    int named = 0;
    write_text("q.cfg",
               "steps = 2500; gravity = [0.0, 0.0]; particles = ( { x = 0.0; y = 0.0; r = 0.1; } );\n");
    write_text("o.cfg", "steps = 4; gravity = [0.0, 0.0]; particles = ( { x = 0.0; y = 0.0; r = 0.1; } );\n");
    GOOD("run o.cfg -o old");
    GOOD("run q.cfg -o d");
    SHELL("mv d whole");
    for (int force = 0; force < 2; force++) {
        int status = -1;
        for (long n = 1; status != 0 && n < 200; n++) {
            SHELL(force ? "rm -rf d d.part && cp -r old d" : "rm -rf d d.part");
            status = run_by_minutes(SIGKILL, "", n, words[force]);
            CU_ASSERT(status == 0 || status == 128 + SIGKILL);
            if (force) SHELL("diff -r d old >diff || diff -r -I '^# command: ' d whole >diff");
            const bool whole = !force && shell("test -e d || " IS_WHOLE) == 0;
            named += whole && shell("test -e d") != 0;
            if (status != 0 && whole) FAILS(65, "d: holds q.cfg, ", "%s", words[force]);
            if (status != 0 && !whole) CU_ASSERT(run("%s", words[force]) == 0);
            SHELL("diff -r -I '^# command: ' d whole >diff && ! test -e d.part");
        }
        CU_ASSERT(status == 0);
    }
    CU_ASSERT(named > 1);
}

/* A finished result is there until the new one is whole. What was begun by force goes on by force. */
static void stopped_runs(void)
{
    run_undisturbed();
    SHELL("cp -r whole d");
    CU_ASSERT(run_by_minutes(SIGTERM, "snapshot", 3, RUN " --set steps=1400 --force") == 75);
    CHECK_PARTS(err, "stopped at step ", " of 1400; the same command continues");
    SHELL("diff -r d whole && test -s d.part/snapshot");
    FAILS(65, "d: holds s.cfg, frames each 70", RUN " --set steps=1400");
    CU_ASSERT(run(RUN " --set steps=1400 --force") == 0);
    CHECK_PARTS(err, "repose run: d: continues from step ");
    SHELL("! test -e d.part && mv d resumed");
    GOOD(RUN " --set steps=1400");
    SHELL("diff -r -I '^# command: ' d resumed");
}

/* What is not the run that was begun is refused; a run that has no snapshot begins anew. */
static void refused_resumes(void)
{
    write_scene();
    CU_ASSERT(run_by_minutes(SIGTERM, "snapshot", 3, RUN) == 75);
    SHELL("cp -r d.part good");
    static const struct {
        const char *change, *text;
    } list[] = {{"printf x | dd of=d.part/snapshot bs=1 seek=3000 conv=notrunc 2>dd",
                 "remove d.part to begin anew: d.part/snapshot: damaged: its checksum is wrong"},
                {"truncate -s 3000 d.part/snapshot", "truncated: "},
                {"truncate -s 300 d.part/energy.tsv",
                 "remove d.part to begin anew: energy.tsv: shorter than at the snapshot"},
                {"sed -i '2s/.*/contacts.tsv/' d.part/.repose",
                 "d.part: holds contacts.tsv, unfinished; the command that began it "},
                {"rm d.part/.repose", "d.part: no result of this program; move it away"}};
    for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
        SHELL("rm -rf d.part && cp -r good d.part");
        CU_ASSERT(shell(list[k].change) == 0);
        FAILS(65, list[k].text, RUN);
    }
    static const char *const others[] = {"--every 5", "--set steps=300", "--set tangential.mu=0.4"};
    SHELL("rm -rf d.part && cp -r good d.part");
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        FAILS(65, "d.part: holds s.cfg, frames each 70 70 70 70, key ", "run s.cfg --every 70 %s -o d",
              others[k]);
    FAILS(65, "d.part: holds s.cfg, frames each 70", "pile -o d");
    SHELL("ln -sf ../s.cfg d.part/energy.tsv");
    FAILS(74, "d.part/energy.tsv: ", RUN); /* no link is followed */
    SHELL("rm -rf d.part && cp -r good d.part");
    const int other = open(path_of("d.part"), O_RDONLY | O_DIRECTORY);
    CU_ASSERT(flock(other, LOCK_EX) == 0);
    FAILS(74, "d.part: another process runs in this folder", RUN);
    close(other);
    SHELL("diff -r d.part good && rm d.part/snapshot");
    GOOD(RUN);
    SHELL("! test -e d.part && mv d again && cp -r good d.part");
    GOOD("pile --base 4 -o d --force");
    SHELL("test -s d/disks.tsv && ! test -e d.part");
}

/* Where a text with phases is, and what is not its run. */
static void stopped_phases(void)
{
    write_trial("a.cfg", acting);
    CU_ASSERT(run_by_minutes(SIGINT, "snapshot", 2, "run a.cfg -o d") == 75);
    CHECK_PARTS(err, "stopped at step ", " of fall: step ", "; the same command continues");
    static const char *const others[] = {"tangential.mu=0.3", "times=4", "measure[0].every=31",
                                         "measure[1].series=true", "seed=3"};
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        FAILS(65, "d.part: holds a.cfg, frames each 500 ", "run a.cfg -o d --set %s", others[k]);
    SHELL("cp a.cfg b; sed -i '/name = \"most\"/{h;d};/name = \"flow\"/G' a.cfg; ! cmp -s a.cfg b");
    FAILS(65, "d.part: holds a.cfg, frames each 500 ", "run a.cfg -o d"); /* samples are kept by place */
    SHELL("mv b a.cfg");
    CU_ASSERT(run("run a.cfg -o d --set 'measure[0].meaning=height' --set tangential.mu=0.40") == 0);
    CHECK_PARTS(err, "continues from step ");
}

/* A row of a sweep: a pile that is filled, opened and measured. */
static void stopped_row(void)
{
    write_text("p.cfg", "protocol = \"repose\"; replicas = 2; seed = 3; fixed = { W = 1.6; H = 1.6; };\n");
#define ROW "run p.cfg --row 1 -o d"
    GOOD(ROW);
    SHELL("mv d whole && grep -v run_time out >whole.out");
    CU_ASSERT(run_by_minutes(SIGTERM, "snapshot", 3, ROW) == 75);
    CHECK_PARTS(err, "stopped at step ", " of ", ": step ", "; the same command continues");
    static const char *const others[] = {"--row 0", "--row 1 --every 50", "--row 1 --ledger"};
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        FAILS(65, "d.part: holds p.cfg row 1, frames each 0 100 0 0, key ", "run p.cfg -o d %s", others[k]);
    CU_ASSERT(run(ROW) == 0);
    CHECK_PARTS(err, "repose run: d: continues from step ", "repose run: ok, ", "; tables in d\n");
    CU_ASSERT(equal_files());
    SHELL("grep -v run_time out | cmp - whole.out");
}

/* The file that a row leaves is the same run: the same key, and the same numbers. */
static void row_as_text(void)
{
    scoped_trial row;
    XXH128_hash_t key, own;
    write_trial("a.cfg", acting);
    write_text("s.cfg", "experiment = \"a.cfg\"; replicas = 1; seed = 5; grid = { times = [3.0, 2.0]; };\n");
    GOOD("run s.cfg --row 1 -o d");
    scoped_table numbers = read_table("out"), again = TABLE_OF("run d/scene.cfg --quiet");
    for (size_t k = 0; k < again.n_rows; k++)
        CU_ASSERT_STRING_EQUAL(word(&again, k, "value"), word(&numbers, 0, word(&again, k, "measure")));
    CHECK_OK(read_text(&row, check_changed(acting, "times = 3", "times = 2")));
    CHECK_OK(exp_key(row.plan, &key));
    end(&row), row = (trial){0};
    CHECK_OK(dem_text_open(path_of("d/scene.cfg"), NULL, NULL, &row.text));
    CHECK_OK(exp_read(&row.text, &row.plan));
    CHECK_OK(exp_key(row.plan, &own));
    CU_ASSERT(XXH128_isEqual(key, own));
}

/* ---- sweeps ---- */

/* Plan the same sweep in the folders `whole` and `d`. */
static void plan_twice(int replicas)
{
    write_text("s.cfg",
               "protocol = \"repose\"; replicas = %d; seed = 5;\n"
               "fixed = { W = 1.6; H = 1.6; }; grid = { mu = [0.1, 0.2]; };\n",
               replicas);
    SHELL("for d in whole d; do \"$REPOSE\" sweep plan s.cfg -o $d; done >plan");
}

/* The driven sweep has the rows of the undisturbed one, and no snapshot. */
static void check_driven(void)
{
    SHELL("test \"$(\"$REPOSE\" sweep digest d)\" = \"$(\"$REPOSE\" sweep digest whole)\"");
    SHELL("! test -e d/snapshots");
}

/* Of fault_watch: that snapshot of a run before which its whole sweep is killed. */
static int fatal_snapshot;

static void kill_at_snapshot(const char *call, int file, const char *from, const char *to)
{
    static char last[PATH_MAX];
    static int snapshots;
    (void)file, (void)from;
    if (strcmp(call, "rename") != 0 || !strstr(to, "/snapshots/")) return;
    snapshots = strcmp(to, last) == 0 ? snapshots + 1 : 1;
    snprintf(last, sizeof last, "%s", to);
    if (snapshots == fatal_snapshot) kill(0, SIGKILL);
}

/* Run a sweep of the folder with two workers and frequent snapshots until then. Was it killed? */
static bool drive_until_snapshot(int n)
{
    const pid_t child = fork();
    if (child == 0) {
        setpgid(0, 0);
        fatal_snapshot = n;
        fault_watch = kill_at_snapshot;
        fault_tick = 1.0; /* a snapshot is due after 5 looks at the clock */
        _exit((int)sweep_run(path_of("d"), sweep_protocols, &(sweep_options){.workers = 2, .snapshot = 5.0},
                             &(sweep_counts){0}));
    }
    int end = 0;
    CU_ASSERT_FATAL(waitpid(child, &end, 0) == child);
    CU_ASSERT(WIFSIGNALED(end) ? WTERMSIG(end) == SIGKILL : WEXITSTATUS(end) == 0);
    return WIFSIGNALED(end);
}

/* A sweep that is killed again and again stores the rows of the undisturbed one, and leaves no snapshot. A
 * damaged snapshot is refused, and its run starts anew. */
static void sweep_rows(void)
{
    plan_twice(2);
    SHELL("\"$REPOSE\" sweep run whole --snapshot 0 >counts && ! test -e whole/snapshots");
    int kills = 0;
    /* a run has one snapshot at least, and comes farther each time */
    while (drive_until_snapshot(2 + kills)) {
        SHELL("ls d/snapshots/???????????????????????????????? >kept");
        if (++kills == 2) shell("for f in d/snapshots/*; do truncate -s 999 $f; done");
    }
    CHECK_OR_SAY(kills > 2, "%d kills", kills);
    check_driven();
}

/* Stop the command again and again until it is done, each time after more looks at the clock. *kept: how
 * often `left` was there after a stop. */
static void stop_until_done(const char *words, const char *left, int *kept)
{
    const char *seen = check_text("ls %s >kept 2>&1", left);
    int status = 75;
    for (long n = 5; status == 75 && n < 1000000; n += n) {
        status = run_signalled(SIGTERM, "clock", n, words);
        *kept += shell(seen) == 0;
    }
    CHECK_OR_SAY(status == 0 && *kept > 2, "status %d, %d kept", status, *kept);
}

/* A sweep that is told to stop keeps its long runs, though no snapshot is due. */
static void stopped_sweep(void)
{
    int kept = 0;
    plan_twice(1);
    SHELL("\"$REPOSE\" sweep run whole >counts");
    stop_until_done("sweep run d -j 2 --snapshot 1e9", "d/snapshots/????????????????????????????????", &kept);
    check_driven();
}

CHECK_SUITE_WITHIN(run, "run", enter, leave, any_call, each_call, stopped_runs, refused_resumes,
                   stopped_phases, stopped_row, row_as_text, sweep_rows, stopped_sweep)
