/* The installed tree: found from any folder, moved as a whole, used as a library. RP_INSTALLED names a prefix
 * to be tested instead of a fresh installation, as of a package. */
#include <limits.h>

#include "cli/cli.h"
#include "core/version.h"
#include "tests/program.h"

/* An example prints what the program computes by the same operations, but for constants such as pi/6. */
#define SAME 1e-12

/* A line of shell in the folder of the test: $PREFIX is the tree, $SOURCE the source. */
#define PASSES(text) CHECK_OR_SAY(line_of(text) == 0, "%s\n%s%s", text, out, err)
static int line_of(const char *text)
{
    return shell_line("exec >out 2>err; export PKG_CONFIG_PATH=$PREFIX/lib/pkgconfig; %s", text);
}

/* The tree is installed in one folder and used in another. */
static void install_program(void)
{
    char source[PATH_MAX], build[PATH_MAX];
    const char *given = getenv("RP_INSTALLED"), *program = getenv("REPOSE");
    CU_ASSERT_FATAL(realpath(".", source) && realpath(program ? program : "build/repose", build));
    *strrchr(build, '/') = '\0';
    unsetenv("REPOSE_DATA");
    setenv("SOURCE", source, 1);
    setenv("BUILD", build, 1);
    setenv("PREFIX", given ? given : path_of("moved"), 1);
    setenv("SANITIZE", check_fast() ? "-fsanitize=address,undefined -no-pie" : "", 1);
    if (!given)
        PASSES("to=$PWD; cd $SOURCE && sh install.sh $BUILD $to/first " RP_VERSION
               " sweep run exp analytic dem statics angle stress stats core && mv $to/first $PREFIX");
}

/* ---- program ---- */

static void test_targets(void)
{
    install_program();
    PASSES("make -C $SOURCE --no-print-directory -n B=$BUILD DESTDIR=/d PREFIX=/p install");
    CU_ASSERT(strstr(out, "\"/d/p\" " RP_VERSION
                          " sweep run exp analytic dem statics angle stress stats core") != NULL);
    if (!getenv("RP_INSTALLED")) {
        /* what a person put among the files stays, a folder that is a link too; an odd name is one folder */
        PASSES(
            "mkdir -p t && echo mine >t/mine && umask 077 && to=\"$PWD/t \xc3\xbc, it's\" && "
            "mkdir \"$to\" real && ln -s ../real \"$to/bin\" && mkdir \"$to/lib\" && cd $SOURCE && "
            "for k in 1 2; do sh install.sh $BUILD \"$to\" " RP_VERSION " core stats && echo mine >\"$to\"/"
            "share/repose/examples/mine.cfg || exit; done && ar t \"$to\"/lib/librepose.a | grep -q status.o "
            "&& find \"$to\" -type f ! -perm -044 | grep -v mine; make -s B=$BUILD DESTDIR= PREFIX=\"$to\" "
            "uninstall >log; cd \"$to\"/..; find t* -type d -empty -o ! -type d | LC_ALL=C sort");
        CU_ASSERT_STRING_EQUAL(out, "t \xc3\xbc, it's/bin\nt \xc3\xbc, it's/lib\nt \xc3\xbc, "
                                    "it's/share/repose/examples/mine.cfg\nt/mine\n");
        /* folders of a former installation are still its own, and so is the prefix that it made */
        PASSES("for k in 1 2; do sh -c 'cd $SOURCE && sh install.sh $BUILD $0/whole " RP_VERSION
               " core stats' $PWD && touch whole/lib/mine || exit; done; rm whole/lib/mine; "
               "cp -r whole there && make -sC $SOURCE B=$BUILD DESTDIR=$PWD PREFIX=/there uninstall && ! ls "
               "there");
    }
    PASSES("! grep -rIl -e $SOURCE -e $PWD $PREFIX"); /* no path of the build */
}

static void test_data(void)
{
    install_program();
    PASSES("$PREFIX/bin/repose sweep plan sweeps/studies/calibrate.cfg -o planned");
    CU_ASSERT(strstr(out, "60 runs") != NULL);
    PASSES("$PREFIX/bin/repose params sweeps/protocols/flux.cfg | grep -q ^v_cut");
    PASSES("$PREFIX/bin/repose run examples/pile.cfg --set steps=10 --quiet | grep -q '^10'");
    PASSES("$PREFIX/bin/repose angle slope examples/outline.csv --y-axis down");
    PASSES("test -f $PREFIX/share/doc/repose/examples/pile.cfg"); /* a link */
    PASSES("cd $PREFIX/share/doc/repose && for f in *.md docs/*.md; do grep -oE '\\]\\([^):#]+[)#]' $f | sed "
           "'s/..//; s/.$//' | while read l; do test -e ${f%${f##*/}}$l || echo $f: $l; done; done");
    CU_ASSERT_STRING_EQUAL(out, ""); /* the pages' links hold */
    /* nothing of the report, no table of results */
    PASSES("ls $PREFIX/bin $PREFIX/share/repose | tr '\\n' ' '");
    CHECK_PARTS(out, "/bin: repose  ", "/share/repose: examples python sweeps ");
    PASSES("$PREFIX/bin/repose sweep make sweeps/li/tent.cfg -o tent --tables tables && ls "
           "tables/30_45_38.tsv");
    /* Python finds the program beside which it is installed, also through a link */
    PASSES("for folder in share/repose share/doc/repose; do to=$(cd /; env -u REPOSE PATH=/usr/bin:/bin "
           "PYTHONPATH=$PREFIX/$folder/python python3 -Bc 'import repose; print(repose.program())'); "
           "test \"$to\" -ef $PREFIX/bin/repose || exit 1; done");
}

/* A sweep of so many runs under a name of the program's own sweeps. */
static void write_sweep(const char *folder, int replicas)
{
    SHELL(check_text("mkdir -p %s/sweeps/studies >out 2>err", folder));
    write_text(check_text("%s/sweeps/studies/calibrate.cfg", folder),
               "protocol = \"repose\"; replicas = %d; seed = 7;\n"
               "fixed = { W = 2.0; H = 2.0; stop = \"steps\"; fill_steps = 2500; relax_steps = 1500; };\n"
               "grid = { mu = [0.1, 0.2, 0.3, 0.4]; };\n",
               replicas);
}

/* How many runs are planned of the sweep that is found. */
static int planned(const char *program)
{
    int runs = -1;
    PASSES(check_text(
        "rm -rf d; %s sweep plan sweeps/studies/calibrate.cfg -o d | sed 's/.*: \\([0-9]*\\) runs.*/\\1/'",
        program));
    CU_ASSERT(sscanf(out, "%d", &runs) == 1);
    return runs;
}

/* Current folder; REPOSE_DATA, and then nothing else; beside the program; the source. */
static void test_order(void)
{
    install_program();
    write_sweep("tree/share/repose", 2);
    write_sweep("source", 3);
    write_sweep("mine", 4);
    PASSES("mkdir -p tree/bin source/build source/build/asan && cp $PREFIX/bin/repose tree/bin && "
           "cp $PREFIX/bin/repose source/build && cp $PREFIX/bin/repose source/build/asan");
    CU_ASSERT(planned("tree/bin/repose") == 8 && planned("source/build/repose") == 12);
    CU_ASSERT_EQUAL(planned("source/build/asan/repose"), 12);
    CU_ASSERT_EQUAL(planned("REPOSE_DATA=$PWD/mine tree/bin/repose"), 16);
    CU_ASSERT_EQUAL(line_of("REPOSE_DATA=$PWD tree/bin/repose sweep plan sweeps/studies/calibrate.cfg -o d"),
                    RP_BAD_INPUT);
    CU_ASSERT(strstr(err, "sweeps/studies/calibrate.cfg: ") != NULL);
    write_sweep(".", 5);
    CU_ASSERT_EQUAL(planned("REPOSE_DATA=$PWD/mine tree/bin/repose"), 20);
}

/* ---- library ---- */

/* Each header alone, and a program in C++ against a function of each module. */
static void test_headers(void)
{
    install_program();
    PASSES("for h in $PREFIX/include/repose/*.h; do echo \"#include <repose/${h##*/}>\" >${h##*/}.c && "
           "cp ${h##*/}.c ${h##*/}.cpp || exit 1; done; ls *.h.c | wc -l");
    CU_ASSERT(atoi(out) >= 18);
    PASSES("${CC:-gcc} -std=c11 -Wall -Wextra -Wpedantic -Werror -fsyntax-only $(pkg-config --cflags repose) "
           "*.h.c");
    if (line_of("command -v g++")) {
        check_skip("no g++: headers in C++");
    } else {
        PASSES("g++ -std=c++17 -Wall -Wextra -Wpedantic -Werror -fsyntax-only $(pkg-config --cflags repose) "
               "*.h.cpp");
        write_text(
            "all.cpp",
            "#include <gsl/gsl_errno.h>\n#include <repose/analytic.h>\n#include "
            "<repose/protocols.h>\n#include <repose/angle.h>\n"
            "#include <repose/scene.h>\n#include <repose/equilibrium.h>\n"
            "rp_status numbers(rp_arena *a, double **x)\n{\n    RP_NEW(a, *x, 7);\n    return RP_OK;\n}\n"
            "int main()\n{\n    an_force f;\n    dem_definition d = dem_definition_default();\n"
            "    statics_definition s = statics_definition_default();\n"
            "    sweep_counts c;\n    ang_surface a{};\n    ang_surface_free(&a);\n"
            "    return an_continuum(0.5, 0.5, &f) || d.n_grains || s.n || \n"
            "           !sweep_status(\"nowhere\", sweep_protocols, &c) || !*rp_message() ||\n"
            "           !gsl_set_error_handler(0);\n}\n"); /* GSL's own, 0, ends a program */
        PASSES("g++ -std=c++17 $SANITIZE all.cpp $(pkg-config --cflags --libs repose) -o all && ./all");
    }
}

/* Rows of an example equal those of a table of the program in the columns named. */
static void check_same(const char *example, const char *program, size_t n, const char *const columns[])
{
    scoped_table a = read_table(example), b = read_table(program);
    CU_ASSERT(a.n_rows > 2 && a.n_rows == b.n_rows);
    for (size_t row = 0; row < a.n_rows && row < b.n_rows; row++)
        for (size_t c = 0; c < n; c++)
            CHECK_NEAR(cell(&a, row, columns[c]), cell(&b, row, columns[c]),
                       SAME * (1.0 + fabs(cell(&b, row, columns[c]))));
}

#define COMPILE "${CC:-gcc} -std=c11 -Wall -Wextra -Wpedantic -Werror $SANITIZE $examples/"

static void test_examples(void)
{
    install_program();
    PASSES("examples=$PREFIX/share/doc/repose/examples; for e in profile run slope pile; do " COMPILE
           "$e.c $(pkg-config --cflags --libs repose) -o $e || exit 1; done");
    PASSES(
        "./profile >profile.tsv && $PREFIX/bin/repose continuum --alpha-deg 30 --points 11 >continuum.tsv");
    check_same("profile.tsv", "continuum.tsv", 3, (const char *const[]){"x/B", "N/(chi*g*B)", "H/(chi*g*B)"});
    write_text("box.cfg",
               "fill = { N = 30; W = 2.0; H = 3.0; };\nsteps = 20000;\nwalls = ( { point = (0.0, 0.0); "
               "direction = (0.0, 1.0); },\n  { point = (0.0, 0.0); direction = (1.0, 0.0); }, { point = "
               "(2.0, 0.0); direction = (-1.0, 0.0); } );\n");
    PASSES("./run box.cfg >run.tsv && $PREFIX/bin/repose run box.cfg >states.tsv");
    check_same("run.tsv", "states.tsv", 3, (const char *const[]){"x", "y", "r"});
    PASSES("./slope run.tsv 2 >slope.tsv && $PREFIX/bin/repose angle slope run.tsv --width 2 --cell 0.2 "
           ">angle.tsv");
    check_same("slope.tsv", "angle.tsv", 3, (const char *const[]){"method", "theta_deg", "theta_se_deg"});
    PASSES("./pile >pile.tsv && $PREFIX/bin/repose pile --base 7 --eps 1e-3 >base.tsv");
    check_same("pile.tsv", "base.tsv", 3, (const char *const[]){"i", "N/mg", "H/mg"});
    /* a module needs the libraries of its own .pc alone; also with --static */
    PASSES("examples=$PREFIX/share/doc/repose/examples; for e in profile=analytic run=dem slope=angle "
           "pile=statics; do " COMPILE
           "${e%=*}.c $(pkg-config --static --cflags --libs repose-${e#*=}) -o a || exit 1; done");
    PASSES("pkg-config --libs repose-analytic");
    CU_ASSERT(strstr(out, "-lrepose-analytic -lm") && !strstr(out, "gsl") && !strstr(out, "cholmod"));
    /* of several modules each finds its libraries after it, whatever their order */
    write_text("both.c",
               "#include <repose/angle.h>\n#include <repose/dem.h>\nint main(void)\n{\n    double m;\n"
               "    dem_sim *s;\n    dem_definition d = dem_definition_default();\n"
               "    return !dem_create(&d, &s) || ang_marginal(0.2, 1.0, &m, NULL);\n}\n");
    PASSES("for m in 'dem repose-angle' 'angle repose-dem' 'angle repose-analytic repose-dem'; do ${CC:-gcc} "
           "$SANITIZE both.c $(pkg-config --cflags --libs repose-$m) -o both || exit 1; done");
}

/* ---- manual and completion ---- */

/* Each option of a command in the completion. */
static void check_options(const cli_command *c, const char *completion)
{
    RP_SCOPE(arena);
    cli_call call = {.arena = &arena, .program = &cli_repose};
    if (c->group) {
        for (const cli_command *const *g = c->group; *g; g++) check_options(*g, completion);
        return;
    }
    cli_options_of(&call, c);
    const char *words = strstr(completion, check_text("    '%s '*) words='", c->name));
    CU_ASSERT_PTR_NOT_NULL_FATAL(words);
    for (const rp_param *p = call.options; p->name; p++) {
        const char *text = check_text("%s%s ", strlen(p->name) == 1 ? "-" : "--", p->name);
        const char *at = strstr(words, text);
        CHECK_OR_SAY(at && at < strchr(words, '\n'), "%s: not in the completion of %s", text, c->name);
    }
}

/* Words typed, and the word that follows. */
static void check_completion(void)
{
    static const char *const typed[][2] = {{"la", "lattice"},
                                           {"sweep pl", "plan"},
                                           {"sweep plan --rep", "--replicas"},
                                           {"lattice --method r", "recursion"},
                                           {"lattice --layers 3 --me", "--method"},
                                           {"help swe", "sweep"},
                                           {"lattice --layers ", ""},
                                           {"sweep plan sweeps/l", ""}};
    for (size_t i = 0; i < sizeof typed / sizeof *typed; i++) {
        const char *expected = check_text("%s\n", typed[i][1]);
        PASSES(
            check_text("bash -c 'source $PREFIX/share/bash-completion/completions/repose; words=\"repose "
                       "%s\"; COMP_WORDS=($words); [ \"${words%% }\" = \"$words\" ] || COMP_WORDS+=(\"\"); "
                       "COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _repose; echo \"${COMPREPLY[*]}\"'",
                       typed[i][0]));
        CU_ASSERT_STRING_EQUAL(out, expected);
    }
}

static void test_manual(void)
{
    install_program();
    PASSES("cat $PREFIX/share/bash-completion/completions/repose");
    scoped char *completion = strdup(out);
    for (const cli_command *const *c = cli_repose.commands; *c; c++) check_options(*c, completion);
    /* a package has the page; else pandoc makes it here, where it is there */
    PASSES("for p in $PREFIX/share/man/man1/repose.1*; do case $p in *.gz) gunzip -c $p >page ;; "
           "*.1) cp $p page ;; *) ! command -v pandoc >have || $PREFIX/bin/repose help --markdown | "
           "pandoc -s -f markdown-smart -t man -o page ;; esac; done");
    if (line_of("test -e page && command -v groff"))
        check_skip("no pandoc or groff: the form of the manual page");
    else
        PASSES(
            "groff -man -ww -z -Tutf8 page && test ! -s err && groff -man -Tascii -P-cbou page >read && "
            "grep -q '^ *mu_roll' read && grep -q REPOSE_DATA read && grep -q '^ *repose sweep plan$' read");
    check_completion();
}

static void test_help_command(void)
{
    GOOD("help angle slope");
    CU_ASSERT(strncmp(out, "usage: repose angle slope FILE", 30) == 0);
    GOOD("help sweep");
    CU_ASSERT(strncmp(out, "usage: repose sweep COMMAND", 27) == 0);
    FAILS(RP_USAGE, "unknown command \"nothing\"", "help nothing");
    FAILS(RP_USAGE, "unknown command \"more\"", "help lattice more");
}

/* ---- a machine that lacks packages ---- */

/* What `make` prints on a machine whose programs are those of the folder `bare`. */
#define BARE_MAKE                                                                                            \
    "PATH=$PWD/bare make --no-print-directory -C $SOURCE B=$BUILD REPOSE=$BUILD/repose -o $BUILD/repose "

/* `make setup` with these other goals asks for some packages and not for others. */
static void check_packages(const char *goals, const char *wanted, const char *unwanted)
{
    PASSES(check_text(BARE_MAKE "-n -o all -o figures -o check -o lint -o deb -o manual %s >list && "
                                "for p in %s; do grep -qwe $p list || { cat list; exit 1; }; done; "
                                "! grep -E '%s' list",
                      goals, wanted, unwanted));
    CU_ASSERT_STRING_EQUAL(err, "");
}

static void test_setup(void)
{
    if (CHECK_SKIPS("of make the sanitizers see nothing")) return;
    install_program();
    PASSES("mkdir bare && ln -s /usr/bin/* bare && rm -f bare/pandoc bare/dpkg-buildpackage");
    CU_ASSERT(line_of(BARE_MAKE "manual") != 0 && strstr(err, "`make setup manual`"));
    CU_ASSERT(!strstr(err, "not found"));
    CU_ASSERT(line_of(BARE_MAKE "-o dist deb") != 0 && strstr(err, "`make setup deb`"));
    CU_ASSERT(!strstr(err, "not found"));
    PASSES("rm bare/pkg-config");
    CU_ASSERT(line_of(BARE_MAKE "all") != 0 && strstr(err, "`make setup`") && !strstr(err, "pkg-config"));
    check_packages("setup figures", "libgsl-dev gnuplot-nox", "cunit|clang|python|lammps|vtk|wasm|pandoc");
    check_packages("setup check", "libgsl-dev gnuplot-nox libcunit1-dev python3",
                   "lammps|pandas|vtk|wasm|pandoc");
    check_packages("setup deb", "libgsl-dev build-essential debhelper pandoc", "cunit|clang|lammps|wasm");
    check_packages("setup-peers", "lammps python3-vtk9 python3-pandas", "libgsl|cunit|wasm");
    /* where no locale is set, gnuplot would warn */
    PASSES("LC_ALL=C make -sC $SOURCE B=$BUILD --eval='say: ; @echo $$LC_ALL' say");
    CU_ASSERT_STRING_EQUAL(out, "C.UTF-8\n");
}

/* ---- package ---- */

/* One licence for every file of the source; what is linked with GSL and CHOLMOD has another. */
static void check_licences(void)
{
    PASSES("cd $SOURCE && PATH=/usr/bin:/bin python3 -c 'import tomllib; t = "
           "tomllib.load(open(\"REUSE.toml\", \"rb\")); "
           "[(a)] = t[\"annotations\"]; print(t[\"version\"], a[\"path\"], a[\"SPDX-License-Identifier\"])'");
    CU_ASSERT_STRING_EQUAL(out, "1 ** MIT\n");
    PASSES(
        "cd $SOURCE && words() { sed 's/^ \\.\\{0,1\\}//' \"$1\" | tr -s ' \\n' '  '; }; for f in LICENSE "
        "debian/copyright; do "
        "case $(words $f) in *\"$(words LICENSES/MIT.txt | sed 's/.*Permission/Permission/; s/ $//')\"*) ;; "
        "*) echo $f; exit 1 ;; esac; done");
    PASSES("cd $SOURCE && for f in LICENSE docs/install.md src/page/page.html debian/copyright; do "
           "tr -s ' \\n' '  ' <$f | grep -q 'GNU General Public License, version 3 or later' || { echo $f; "
           "exit 1; }; done");
}

/* Version and libraries stand in debian/ a second time. */
static void test_debian(void)
{
    install_program();
    PASSES("head -1 $SOURCE/debian/changelog");
    CU_ASSERT(strncmp(out, "repose (" RP_VERSION ") ", strlen("repose (" RP_VERSION ") ")) == 0);
    PASSES("grep '^version: ' $SOURCE/CITATION.cff");
    CU_ASSERT_STRING_EQUAL(out, "version: " RP_VERSION "\n");
    PASSES("for p in $(sed -n '/^PACKAGES/,/[^\\\\]$/p' $SOURCE/Makefile); do case $p in libcunit*) ;; "
           "lib*-dev|pkg-config) grep -qw -e \"$p\" $SOURCE/debian/control || { echo $p; exit 1; } ;; esac; "
           "done");
    /* the page on installation has the packages of the program */
    PASSES("for p in $(sed -n '/^PACKAGES :=/,/[^\\\\]$/s/PACKAGES :=\\|\\\\//gp' $SOURCE/Makefile); do "
           "grep -q \"\\`$p\\`\" $SOURCE/docs/install.md || { echo $p; exit 1; }; done");
    PASSES("date -ud \"$(sed -n '/^ -- /{s/.*>  //p;q}' $SOURCE/debian/changelog)\" '+date-released: %F' | "
           "grep -qxf - $SOURCE/CITATION.cff");
    check_licences();
}

CHECK_SUITE_WITHIN(install, "install", enter, leave, test_targets, test_data, test_order, test_headers,
                   test_examples, test_manual, test_help_command, test_setup, test_debian)
