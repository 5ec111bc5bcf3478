/* Memory that is freed together; see arena.h. */
#include "core/arena.h"

#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct rp_kept {
    struct rp_kept *before;
    void *thing;
    void (*release)(void *);
};

static void *no_memory(const rp_arena *arena)
{
    if (arena->exhausted) arena->exhausted();
    rp_fail(RP_NO_MEMORY, "out of memory");
    return NULL;
}

void *rp_arena_keep(rp_arena *arena, void *thing, void (*release)(void *))
{
    struct rp_kept *kept = thing ? malloc(sizeof *kept) : NULL;
    if (!kept) {
        if (thing) release(thing);
        return no_memory(arena);
    }
    *kept = (struct rp_kept){arena->last, thing, release};
    arena->last = kept;
    return thing;
}

void *rp_arena_memory(rp_arena *arena, size_t n, size_t size)
{
    return rp_arena_keep(arena, calloc(n + 1, size), free);
}

rp_mark rp_arena_mark(const rp_arena *arena)
{
    return arena->last;
}

void rp_arena_release(rp_arena *arena, rp_mark mark)
{
    while (arena->last != mark) {
        struct rp_kept *kept = arena->last;
        arena->last = kept->before;
        kept->release(kept->thing);
        free(kept);
    }
}

void rp_arena_end(rp_arena *arena)
{
    rp_arena_release(arena, NULL);
}

char *rp_text(rp_arena *arena, const char *format, ...)
{
    char *text;
    va_list args;
    va_start(args, format);
    const int n = vasprintf(&text, format, args);
    va_end(args);
    return rp_arena_keep(arena, n < 0 ? NULL : text, free);
}

rp_status rp_path(rp_arena *arena, const char **path, const char *format, ...)
{
    char text[PATH_MAX];
    va_list args;
    va_start(args, format);
    const int n = vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (n < 0 || n >= PATH_MAX) return rp_fail(RP_BAD_INPUT, "%.60s...: path too long", text);
    char *kept = rp_arena_memory(arena, (size_t)n, 1);
    if (!kept) return rp_fail(RP_NO_MEMORY, "%.60s: out of memory", text);
    *path = memcpy(kept, text, (size_t)n);
    return RP_OK;
}
