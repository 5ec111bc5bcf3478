/* The order of the rooms: what tests/rooms.py says of a small tree, and of one with a fault. */
#include <limits.h>

#include "tests/program.h"

static char script[PATH_MAX], sizes[PATH_MAX];

/* Two rooms, a file in each; the upper one uses the lower one by a function and a descriptor. */
static void plant(void)
{
    enter();
    write_text("rooms.txt", "core src/low core\ntop src/high tool < core\n");
    CU_ASSERT_EQUAL_FATAL(
        shell("mkdir -p tests src/low src/high build/obj/tests build/obj/src/low build/obj/src/high; "
              "mv rooms.txt tests; >out 2>err"),
        0);
    write_text("src/low/low.h", "extern int (*const low)(void);\n");
    write_text("src/low/low.c", "#include \"low/low.h\"\nstatic int f(void) { return 1; }\n"
                                "int (*const low)(void) = f;\n");
    write_text("src/high/high.c", "#include \"low/low.h\"\n#include \"high/grey.gp\"\nint high(void);\n"
                                  "int high(void) { return low(); }\n");
    write_text("src/high/grey.gp", "\n");
    write_text("tests/test.c", "int high(void);\nint test(void) { return high(); }\n");
}

/* What it says of the tree, "" for nothing. */
static void check_says(const char *expected)
{
    const int status =
        shell_line("for f in src/*/*.c tests/*.c; do gcc -Isrc -c $f -o build/obj/${f%%.c}.o || exit 9; "
                   "done; python3 -B %s build >out 2>err",
                   script);
    CU_ASSERT_EQUAL(status, *expected != '\0');
    CU_ASSERT_STRING_EQUAL(out, expected);
    leave();
}

static void test_rooms(void)
{
    if (CHECK_SKIPS("of Python the sanitizers see nothing")) return;
    CU_ASSERT_PTR_NOT_NULL_FATAL(realpath("tests/rooms.py", script));
    plant();
    check_says("");
    plant();
    write_text("src/high/high.h", "int high(void);\n");
    write_text("src/low/more.c", "#include \"high/high.h\"\n");
    check_says("lint: src/low/more.c:1: core must not include high/high.h\n");
    plant();
    write_text("src/high/b.h", "\n");
    write_text("src/low/more.c", "#include \"absent/b.h\"\n");
    SHELL("mkdir src/absent; cp src/high/b.h src/absent; :>out; :>err");
    check_says("lint: src/low/more.c:1: includes absent/b.h, which is in no room of tests/rooms.txt\n");
    plant();
    write_text("src/high/more.c", "int high(void);\nint (*const more)(void) = high;\n");
    write_text("src/high/high.c", "#include \"low/low.h\"\nextern int (*const more)(void);\n"
                                  "int high(void);\nint high(void) { return more() + low(); }\n");
    check_says("lint: these files use one another in a circle: src/high/high.c src/high/more.c\n");
    plant();
    write_text("src/low/more.c", "const int descriptor = 1;\n");
    check_says("lint: src/low/more.c: descriptor is used by no other file\n");
    plant();
    write_text("tests/rooms.txt", "core src/high core\ncore src/low core\n");
    check_says("lint: src/high/high.c:1: src/high must not include low/low.h, which stands above it\n");
    plant();
    SHELL("for k in $(seq 20); do echo >src/low/more$k.c; done; :>out; :>err");
    check_says("lint: src/low has 21 .c files, more than 20\n");
    plant();
    write_text("tests/rooms.txt", "core src/low core\ntop src/high < core\n");
    check_says("lint: tests/rooms.txt: src/high has the class <, which is none of core, tool, papers\n");
}

/* A semicolon counts in code alone, a header once, and a file without its ending is a room of its own. */
static void test_sizes(void)
{
    if (CHECK_SKIPS("of Python the sanitizers see nothing")) return;
    CU_ASSERT_PTR_NOT_NULL_FATAL(realpath("tests/sizes.py", sizes));
    plant();
    write_text("tests/rooms.txt", "core src/low core\ntop src/high/more papers\ntop src/high tool < core\n");
    write_text("src/high/more.h", "#include \"low/low.h\"\n\n");
    write_text("src/high/more.c", "/* a; \"\n */\n\n#include \"high/more.h\"\n#include \"low/low.h\"\n"
                                  "const char c[] = \"/* ;\", d = ';'; // ; \\\n");
    CU_ASSERT(shell_line("python3 -B %s | sed 's/  */ /g' >out 2>err", sizes) == 0);
    CU_ASSERT_STRING_EQUAL(out, "room class files lines code semi reads most\n"
                                "src/low core 2 4 4 3 1 src/low/low.c\n"
                                "src/high/more papers 2 8 4 1 3 src/high/more.c\n"
                                "src/high tool 1 4 4 2 1 src/high/high.c\n"
                                "core 2 4 4 3\n"
                                "tool 1 4 4 2\n"
                                "papers 2 8 4 1\n"
                                "all 5 16 12 6\n");
    leave();
}

CHECK_SUITE(rooms, "rooms", test_rooms, test_sizes)
