/* Memory of one command: what is kept is freed once, the latest first; texts and paths; failures. */
#include <limits.h>

#include "core/arena.h"
#include "tests/check.h"
#include "tests/faults.h"

static char released[16];

static void note(void *thing)
{
    strcat(released, thing);
}

static void order(void)
{
    rp_arena arena = {0};
    *released = '\0';
    CU_ASSERT_STRING_EQUAL(rp_arena_keep(&arena, "a", note), "a");
    rp_arena_keep(&arena, "b", note);
    const rp_mark mark = rp_arena_mark(&arena);
    rp_arena_keep(&arena, "c", note);
    rp_arena_keep(&arena, "d", note);
    rp_arena_release(&arena, mark);
    CU_ASSERT_STRING_EQUAL(released, "dc");
    rp_arena_keep(&arena, "e", note);
    rp_arena_release(&arena, NULL);
    CU_ASSERT_STRING_EQUAL(released, "dceba");
    rp_arena_release(&arena, NULL);
    CU_ASSERT_STRING_EQUAL(released, "dceba");
}

static void zeroed(void)
{
    RP_SCOPE(arena);
    for (size_t n = 0; n < 100; n++) {
        const double *x = rp_arena_memory(&arena, n, sizeof *x);
        for (size_t i = 0; i <= n; i++) CU_ASSERT(x[i] == 0.0);
    }
}

static void paths(void)
{
    RP_SCOPE(arena);
    const char *path = NULL, *other = NULL;
    char name[PATH_MAX];
    CHECK_OK(rp_path(&arena, &path, "%s/%s_%d.tsv", "build/a folder", "lh3", 7));
    CHECK_OK(rp_path(&arena, &other, "%s", ""));
    CU_ASSERT_STRING_EQUAL(path, "build/a folder/lh3_7.tsv");
    CU_ASSERT_STRING_EQUAL(other, "");
    memset(name, 'x', sizeof name);
    name[PATH_MAX - 2] = '\0'; /* with ".t" one letter too long */
    CHECK_FAILS(rp_path(&arena, &path, "%s.t", name), RP_BAD_INPUT, "xxx...: path too long");
    CU_ASSERT_STRING_EQUAL(path, "build/a folder/lh3_7.tsv");
    name[PATH_MAX - 3] = '\0';
    CHECK_OK(rp_path(&arena, &path, "%s.t", name));
    CU_ASSERT(strlen(path) == PATH_MAX - 1 && strcmp(path + PATH_MAX - 3, ".t") == 0);
}

static void texts(void)
{
    RP_SCOPE(arena);
    char name[2 * PATH_MAX];
    memset(name, 'x', sizeof name);
    name[sizeof name - 1] = '\0';
    CU_ASSERT_STRING_EQUAL(rp_text(&arena, "%s of %d", "3", 7), "3 of 7");
    CU_ASSERT_STRING_EQUAL(rp_text(&arena, "%s", ""), "");
    CU_ASSERT_STRING_EQUAL(rp_text(&arena, "%s", name), name); /* longer than any path */
}

static int n_exhausted;

static void count(void)
{
    n_exhausted++;
}

/* Without memory nothing is kept, and what was to be kept is released. */
static void exhausted(void)
{
    rp_arena arena = {.exhausted = count};
    const char *path = "as before";
    *released = '\0';
    n_exhausted = 0;
    CU_ASSERT_PTR_NULL(rp_arena_keep(&arena, NULL, note));
    CU_ASSERT(n_exhausted == 1 && !*released);
    if (!fault_possible(FAULT_MALLOC)) return;
    fault_order(FAULT_MALLOC, 1, false);
    CU_ASSERT_PTR_NULL(rp_arena_keep(&arena, "a", note));
    CU_ASSERT_STRING_EQUAL(released, "a");
    fault_order(FAULT_MALLOC, 1, true);
    CU_ASSERT_PTR_NULL(rp_arena_memory(&arena, 1, 1));
    CHECK_FAILS(rp_path(&arena, &path, "x"), RP_NO_MEMORY, "x: out of memory");
    CU_ASSERT_PTR_NULL(rp_text(&arena, "x"));
    fault_order(FAULT_MALLOC, 0, false);
    CU_ASSERT(n_exhausted == 5);
    CU_ASSERT_STRING_EQUAL(path, "as before");
    CU_ASSERT_PTR_NULL(rp_arena_mark(&arena));
}

CHECK_SUITE(arena, "arena", order, zeroed, paths, texts, exhausted)
