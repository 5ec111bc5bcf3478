/* What people keep in and beside the program's folders: no command changes it. */
#include <signal.h>
#include <sys/mman.h>

#include "core/file.h"
#include "core/folder.h"
#include "core/random.h"
#include "tests/faults.h"
#include "tests/program.h"

#define SCENE "steps = 4; gravity = [0.0, 0.0]; particles = ( { x = 0.0; y = 0.0; r = 0.1; } );\n"
#define SWEEP "protocol = \"pile\"; replicas = 2; fixed = { base = 4; };\n"

/* Make `what`, run the command, which is refused with this text, and compare what was made. */
static void refused(const char *what, const char *command, const char *text)
{
    const char *line =
        check_text("rm -rf d* side && mkdir d side && echo notes >side/notes && %s && cp -a d* "
                   "side before/",
                   what);
    CU_ASSERT(shell("rm -rf before; mkdir before") == 0 && shell(line) == 0);
    FAILS(65, text, "%s", command);
    SHELL(
        "for f in d* side; do diff -r --no-dereference $f before/$f >out || { cat out >&2; exit 1; }; done");
}

static void test_refusals(void)
{
    write_text("s.cfg", SCENE);
    write_text("w.cfg", SWEEP);
    write_text("w2.cfg", SWEEP);
    GOOD("run s.cfg -o r");
    GOOD("sweep make w.cfg -o w -j 1 --quiet");
    GOOD("export r --to vtk -o v.pvd");
    static const char *const cases[][3] = {
        {"cp -r r/. d", "run s.cfg -o d", "d: holds s.cfg, frames each last last last last, key "},
        {"cp -r r/. d", "pile -o d", "; give another folder, or --force to replace it"},
        {"cp -r r/. d", "calibrate f.cfg -o d", "d: holds s.cfg, frames each last last last last, key "},
        {"cp -r r/. d", "sweep plan w.cfg -o d", "d: holds other files and no sweep"},
        {"cp -r r/. d && echo a >d/notes", "run s.cfg -o d --force",
         "d/notes: not of a result of this program; move it away, or give another folder"},
        {"cp -r r/. d && mkdir d/more", "pile -o d --force", "d/more: not of a result"},
        {"cp -r r/. d && ln -s ../side/notes d/link", "pile -o d --force", "d/link: not of a result"},
        {"cp -r r/. d && rm d/.repose", "run s.cfg -o d --force", "d/contacts.tsv: not of a result"},
        {"cp -r w/. d", "run s.cfg -o d --force", "d/lock: not of a result"},
        {"rmdir d && cp -r r side && ln -s side/r d", "run s.cfg -o d --force", "d: not a folder; move it"},
        {"rmdir d && ln -s none d", "run s.cfg -o d", "d: not a folder"},
        {"rmdir d && echo a >d", "run s.cfg -o d --force", "d: not a folder"},
        {"echo mine >d/.repose", "run s.cfg -o d --force", "d: not of this version of the program"},
        {"printf 'repose folder 1\\nholds: s.cfg\\n' >d/.repose && mkdir d/unfinished",
         "run s.cfg -o d --force",
         "d: not of this version of the program (.repose says so); move it away, or give another folder"},
        {"mkdir d/unfinished", "run s.cfg -o d", "d/unfinished: not of a result"},
        {"mkdir d.part && echo a >d.part/notes", "run s.cfg -o d --force",
         "d.part: no result of this program; move it away"},
        {":", "run s.cfg -o .", ".: give a folder by its name"},
        {"mkdir d/d", "run s.cfg -o d/.", "d/.: give a folder by its name"},
        {"cp -r w/tables d", "sweep make w2.cfg -o w2 --tables d/tables",
         "d/tables: holds tables of the sweep w; give another folder, or --force"},
        {"cp -r r/. d", "sweep make w.cfg -o w --tables d --force", "d: holds s.cfg, frames each last"},
        {"echo a >d/notes", "sweep make w.cfg -o w --tables d --force", "d: holds other files; give another"},
        {"ln -s ../side/notes d/lock", "sweep plan w.cfg -o d --force", "d/lock: "},
        {"echo mine >d/sweep.cfg", "sweep plan w.cfg -o d", "d: holds other files and no sweep"},
        {"echo a >d/a", "export r --to csv -o d/a", "d/a: is there; give another name, or --force"},
        {"echo a >d/a.pvd", "export r --to vtk -o d/a.pvd", "d/a.pvd: is there"},
        {"mkdir d/a_frames && echo a >d/a_frames/grains_000000.vtp", "export r --to vtk -o d/a.pvd --force",
         "d/a_frames/grains_000000.vtp: not of a result"},
        {"cp -r v_frames d/a_frames", "export r --to vtk -o d/a.pvd",
         "d/a_frames: holds frames of v.pvd; give another folder, or --force"},
        {"echo a >d/a.contacts.lammpstrj", "export r --to lammps -o d/a.lammpstrj",
         "d/a.contacts.lammpstrj: is there"},
        {"echo a >d/a.in", "export s.cfg --to lammps-input -o d/a.in", "d/a.in: is there"},
        {"ln -s ../side/notes d/a.svg", "view r -o d/a.svg", "d/a.svg: is there"},
        {"ln -s none d/a.tsv", "sweep export w -o d/a.tsv", "d/a.tsv: is there"},
        {"echo a >d/a.tsv", "bench -n 9 --steps 1 --repeat 1 -o d/a.tsv", "d/a.tsv: is there"}};
    write_text("f.cfg", "fit = { mu = [0.1, 0.8]; };\nmeasured = ( { protocol = \"repose\"; of = "
                        "\"theta_r3_deg\"; value = 20.0; error = 1.0; } );\n");
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) refused(cases[k][0], cases[k][1], cases[k][2]);
    SHELL("echo mine >\"$(printf 'r/a\\nstates.tsv')\"; \"$REPOSE\" run s.cfg -o r --force >out 2>err; test "
          "$? = "
          "65 && test -e r/states.tsv && rm r/a*");
    FAILS(64, "\"steps=3\": one argument too many", "run s.cfg steps=3");
    FAILS(64, "\"more\": one argument too many", "sweep status r more");
}

/* By force what is there is replaced: a file, a link and not what it points to, all of a result. */
static void test_forced(void)
{
    write_text("s.cfg", SCENE);
    write_text("w.cfg", SWEEP);
    GOOD("run s.cfg -o r");
    GOOD("sweep make w.cfg -o w -j 1 --quiet");
    static const char *const commands[] = {
        "export r --to csv -o a",   "export r --to vtk -o a.pvd", "export s.cfg --to lammps-input -o a.in",
        "view r -o a.svg",          "sweep export w -o a",        "bench -n 9 --steps 1 -o a",
        "export r --to lammps -o a"};
    for (size_t k = 0; k < sizeof commands / sizeof *commands; k++)
        for (int again = 0; again < 2; again++) {
            SHELL("rm -f notes && echo notes >notes && ln -sf notes a");
            CU_ASSERT(run("%s --force", commands[k]) == 0);
            SHELL("test \"$(cat notes)\" = notes");
        }
    GOOD("pile --base 4 -o r --force");
    SHELL("test \"$(ls r | tr '\\n' ' ')\" = 'base.tsv contacts.tsv disks.tsv wells.tsv '");
    GOOD("run s.cfg -o r/ --force");
    SHELL("test \"$(ls r | tr '\\n' ' ')\" = 'contacts.tsv energy.tsv states.tsv walls.tsv '; ! test -e "
          "r.part");
    /* in the tables of a sweep without, also its folders; those of another sweep by force */
    write_text("m.cfg", "model = ( { table = \"f\"; with = \"pile\"; base = 4; folder = true; } );\n");
    for (int again = 0; again < 2; again++) GOOD("sweep make m.cfg -o m --tables t");
    SHELL("test -s t/f/disks.tsv && cp m.cfg n.cfg");
    GOOD("sweep make n.cfg -o m --tables t --force");
    SHELL("mkdir e");
    GOOD("run s.cfg -o e"); /* an empty folder is free */
    GOOD("run s.cfg -o 'r[1]'");
    FAILS(65, "r[1]: holds s.cfg, frames each last", "run s.cfg --set steps=3 -o 'r[1]'");
}

/* Where folders can't be exchanged, as on NFS: an older one that a killed process left aside is not lost. */
static void test_publish(void)
{
    rp_folder f, other;
    RP_SCOPE(memory);
    const char *dir = path_of("p"), *file = check_text("%s.part/a", dir);
    CHECK_OK(rp_folder_begin(&memory, dir, "one\ntwo", false, &f));
    CHECK_FAILS(rp_folder_begin(&memory, dir, "one\ntwo", false, &other), RP_IO, "p.part: another process");
    rp_folder_end(&other);
    CU_ASSERT(rp_folder_is_empty(&f));
    file_print(file, "a");
    CU_ASSERT(!rp_folder_is_empty(&f));
    CHECK_OK(rp_folder_publish(&f));
    rp_folder_end(&f);
    SHELL("printf 'repose result 1\\none two\\na\\n' | cmp - p/.repose && ! test -e p.part");
    CHECK_OK(rp_folder_begin(&memory, dir, "three", true, &f));
    SHELL("echo mine >p/mine"); /* meanwhile */
    CHECK_FAILS(rp_folder_publish(&f), RP_BAD_INPUT, "p/mine: not of a result");
    rp_folder_end(&f);
    SHELL("test -s p/a && ! test -e p.part");
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
    SHELL("test \"$(cat n)\" = n && test \"$(ls s)\" = photo.png");
    SHELL("rm 'y?/snapshots' && mv s 'y?/snapshots'");
    CU_ASSERT(run("sweep run 'y?' -j 1 --quiet") == 0);
    SHELL("test \"$(ls 'y?/snapshots')\" = photo.png");
}

/* Something of a person's in a result, or in the way: no command, not even by force, changes it. */
static void test_random_folders(void)
{
    static const char *const things[] = {"echo mine >d/%s", "mkdir d/%s", "ln -s ../side/notes d/%s",
                                         "ln -s ../side d/%s", ": >d/%s"},
                             *const names[] = {"notes",       "unfinished",     "sweep.cfg",    "-x",
                                               "'*'",         "states.tsv.old", "snapshot.new", "snapshots",
                                               ".repose.new", "w.tsv"},
                             *const starts[] = {"mkdir d", "cp -a run d", "cp -a pile d",
                                                "cp -a part d.part; mkdir d"},
                             *const commands[] = {"run s.cfg -o d",
                                                  "run s.cfg -o d --force",
                                                  "pile --base 4 -o d",
                                                  "pile --base 4 -o d --force",
                                                  "run w.cfg --row 1 -o d --force",
                                                  "sweep plan w.cfg -o d",
                                                  "sweep make w.cfg -o d -j 1 --tables d",
                                                  "sweep make w.cfg -o e -j 1 --tables d --force",
                                                  "export d --to csv -o d/w.tsv",
                                                  "view d -o d/pic.svg"};
    const size_t rounds = check_fast() ? 20 : 80;
    rp_random chance = rp_random_of(36, 1, RP_PURPOSE_TEST);
    write_text("s.cfg", SCENE);
    write_text("w.cfg", SWEEP);
    GOOD("run s.cfg -o run");
    GOOD("pile --base 4 -o pile");
    CU_ASSERT(run_by_minutes(SIGTERM, "snapshot", 1, "run s.cfg --set steps=4000 --every 1 -o part") == 75);
    SHELL("mv part.part part");
    for (size_t k = 0; k < rounds; k++) {
#define ANY(list) list[rp_random_below(&chance, sizeof list / sizeof *list)]
        const char *name = ANY(names), *thing = ANY(things), *start = ANY(starts), *words = ANY(commands);
        scoped char *put = strdup(
                        check_text("rm -rf d d.part e side saved; mkdir side && echo notes >side/notes "
                                   "&& { %s; } && cd d && name=%s && cd .. && ",
                                   start, name)),
                    *made = strdup(check_text(thing, name));
        CU_ASSERT(shell(check_text("%s%s && mkdir saved && cp -a side d/%s saved/", put, made, name)) == 0);
        const int status = run("%s", words);
        CU_ASSERT(status != 0 || strstr(words, "-o d/"));
        const bool same =
            shell(check_text("diff -r side saved/side && diff -r --no-dereference d/%s saved/%s >out", name,
                             name)) == 0;
        CHECK_OR_SAY(same, "%zu: %s; %s: changed by %s", k, start, made, words);
    }
}

/* ---- one call fails, or the process is killed ---- */

static long failing;
static fault failing_kind;

static void order_failure(void)
{
    fault_order(failing_kind, failing, false);
}

static void order_nothing(void)
{
}

/* Whichever call for files or memory fails, a command ends with a message, or with all that it makes
 * otherwise. Calls for memory are many: ever fewer of the later ones fail. */
static void check_failing(fault kind, long most)
{
    static const char *const commands[] = {"run s.cfg -o n",
                                           "run w.cfg --row 1 -o n",
                                           "pile --base 4 -o n",
                                           "sweep make w.cfg -o n -j 1 --quiet",
                                           "sweep export w -o n",
                                           "sweep merge part",
                                           "export r --to json -o n",
                                           "export r --to lammps -o n.dump",
                                           "export r --to vtk -o n.pvd",
                                           "export s.cfg --to lammps-input -o n.in",
                                           "view r -o n.svg",
                                           "calibrate f.cfg"};
    if (CHECK_SKIPS("sanitizers have functions of their own for files and memory")) return;
    failing_kind = kind;
    fault_seen = mmap(NULL, sizeof *fault_seen, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    CU_ASSERT_FATAL(fault_seen != MAP_FAILED);
    write_text("s.cfg", SCENE);
    write_text("w.cfg", SWEEP);
    write_text("f.cfg", "fit = { base = [3, 9]; };\nmeasured = ( { runs = \"w/tables/runs.tsv\"; of = \"N\"; "
                        "value = 2.0; error = 1.0; } );\n");
    GOOD("run s.cfg -o r");
    GOOD("sweep make w.cfg -o w -j 1 --quiet");
    GOOD("sweep plan w.cfg -o part");
    CU_ASSERT(run("sweep run part --shard 1/2 -j 1 --quiet") == 0);
    for (size_t k = 0; k < sizeof commands / sizeof *commands; k++) {
        const bool files = kind == FAULT_FILE, all = getenv("RP_DRILL") != NULL;
        const long step = files && !all && k > 0 ? 10 : 1, part = files ? most : all ? 50 : 2;
        SHELL("rm -rf n*");
        const int whole = run_begun(commands[k], order_nothing);
        SHELL("{ find n* -type f | sort; cat n*/.repose; } 2>/dev/null >files; tail -n +6 out >printed; :");
        for (failing = 1 + (long)k % step, *fault_seen = true; *fault_seen;
             failing += step + failing / part) {
            SHELL("rm -rf n*");
            *fault_seen = false;
            const int end = run_begun(commands[k], order_failure);
            const bool same =
                end == whole &&
                shell("{ find n* -type f | sort; cat n*/.repose; } 2>/dev/null | cmp -s - files && "
                      "tail -n +6 out | cmp -s - printed") == 0;
            slurp("err", err, sizeof err);
            CHECK_OR_SAY(same || (end != 0 && end < 128 && *err), "%s: call %ld: %d %s", commands[k], failing,
                         end, err);
        }
        CU_ASSERT(failing > 1 + (long)k % step && failing < most);
    }
    fault_seen = NULL;
}

static void test_failing_calls(void)
{
    check_failing(FAULT_FILE, 400);
}

static void test_failing_memory(void)
{
    check_failing(FAULT_MALLOC, 1000000);
}

/* Names with control characters, in a message, a closing line, a note and what a plan prints. */
static void test_terminal(void)
{
    write_text("s.cfg", SCENE);
    write_text("w.cfg", SWEEP);
    SHELL("e=$(printf 'e\\033[2J\\302\\2332J') && cp s.cfg \"$e.cfg\" && cp w.cfg \"$e.s\" && exec >all 2>&1 "
          "&& "
          "\"$REPOSE\" run \"$e.cfg\" -o \"$e\" && \"$REPOSE\" run \"$e.cfg\" -o \"$e\"; "
          "\"$REPOSE\" run \"$e.cfg\"; \"$REPOSE\" \"$e\"; \"$REPOSE\" run \"--$e\"; \"$REPOSE\" view "
          "\"$e.x\" -o a.svg; "
          "\"$REPOSE\" sweep plan \"$e.s\" -o \"$e.w\" && \"$REPOSE\" sweep run \"$e.w\" -j 1; "
          "\"$REPOSE\" sweep export \"$e.w\"; \"$REPOSE\" stats select \"$e/states.tsv\"; "
          "\"$REPOSE\" run s.cfg --set \"$e=1\"; \"$REPOSE\" run s.cfg --set \"units=$e\"; :");
    SHELL("test $(wc -l <all) -gt 40 && ! LC_ALL=C grep \"$(printf '[\\001-\\010\\013-\\037\\177]')\" all "
          ">&2 && ! LC_ALL=C "
          "grep \"$(printf '\\302\\233')\" all >&2");
}

/* So many of anything that is looked for by name are refused, with the limit. */
static void test_most(void)
{
    static const char *const kinds[][2] = {{"phases", "{ name = \"p%d\"; steps = 1; }"},
                                           {"measure", "{ name = \"p%d\"; of = \"height\"; }"},
                                           {"walls", "{ point = (%d.0, 0.0); direction = (0.0, 1.0); }"}};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        FILE *scene = file_of("m.cfg");
        fputs("particles = ( { x = 0.0; y = 0.0; r = 0.1; } );\n", scene);
        if (k == 1) fputs("phases = ( { name = \"a\"; steps = 1; } );\n", scene);
        fprintf(scene, "%s = (", kinds[k][0]);
        for (int i = 0; i <= 10000; i++) {
            fputs(i ? ",\n" : " ", scene);
            fprintf(scene, check_text("%s", kinds[k][1]), i);
        }
        fputs(" );\n", scene);
        fclose(scene);
        FAILS(65, check_text("%s: 10001 ", kinds[k][0]), "run m.cfg");
        CU_ASSERT_PTR_NOT_NULL(strstr(err, "at most 10000"));
    }
}

/* What a killed export leaves goes with its next call. */
static void test_killed_exports(void)
{
    static const char *const exports[] = {"export r --to csv -o n", "export r --to lammps -o n.dump",
                                          "export r --to vtk -o n.pvd",
                                          "export s.cfg --to lammps-input -o n.in"};
    write_text("s.cfg", SCENE);
    GOOD("run s.cfg -o r");
    for (size_t k = 0; k < sizeof exports / sizeof *exports; k++)
        for (long call = 1, end = 0; end != 0 || call == 1; call++) {
            CU_ASSERT_FATAL(call < 20);
            SHELL("rm -rf n*");
            end = run_signalled(SIGKILL, "rename", call, exports[k]);
            CU_ASSERT(end == 0 || end == 128 + SIGKILL);
            if (end != 0) GOOD("%s", exports[k]);
            SHELL("! find . -name '*part*' | grep . >&2");
        }
    /* one that goes on is not disturbed, and what is a person's is not taken */
    FILE *other;
    const char *path = path_of("n");
    SHELL("rm -rf n*");
    CHECK_OK(rp_file_open(path, false, &other));
    FAILS(74, "n: another process writes it", "export r --to csv -o n");
    CHECK_OK(rp_file_close(path, other, RP_OK));
    SHELL("echo mine >n.contacts.dump");
    FAILS(65, "n.contacts.dump: is there", "export r --to lammps -o n.dump");
    SHELL("test \"$(cat n.contacts.dump)\" = mine && ! test -e n.dump.repose_part");
}

CHECK_SUITE_WITHIN(folders, "folders", enter, leave, test_refusals, test_forced, test_publish, test_sweeps,
                   test_random_folders, test_terminal, test_most, test_failing_calls, test_failing_memory,
                   test_killed_exports)
