/* Memory that is freed together: of one command, or of one function that makes many things. An arena is
 * handed on to whoever makes something in it. */
#ifndef RP_ARENA_H
#define RP_ARENA_H

#include <stddef.h>

#include "core/status.h"

RP_C_BEGIN

/* Zero is an empty arena. Without memory `exhausted` is called, and may end the program; where it is NULL or
 * returns, the function that asked for memory returns NULL or RP_NO_MEMORY. */
typedef struct {
    struct rp_kept *last;
    void (*exhausted)(void);
} rp_arena;

/* Zeroed memory for n objects, and one more for the zero that ends them. */
void *rp_arena_memory(rp_arena *arena, size_t n, size_t size);

/* n zeroed objects for `pointer`, or the end of this function: RP_NO_MEMORY. */
#define RP_NEW(arena, pointer, n)                                                                            \
    do {                                                                                                     \
        (pointer) = (__typeof__(pointer))rp_arena_memory(arena, n, sizeof *(pointer));                       \
        if (!(pointer)) return RP_NO_MEMORY;                                                                 \
    } while (0)

/* Keep `thing`, which `release` frees with the arena; returns it. NULL stands for a thing that could not be
 * made. Without memory, `thing` is released. */
void *rp_arena_keep(rp_arena *arena, void *thing, void (*release)(void *));

/* A mark, and the end of all that was kept since, the latest first; NULL: of everything. */
typedef struct rp_kept *rp_mark;
rp_mark rp_arena_mark(const rp_arena *arena);
void rp_arena_release(rp_arena *arena, rp_mark mark);

/* RP_SCOPE(memory): an arena that ends with the block. */
void rp_arena_end(rp_arena *arena);
#define RP_SCOPE(name) RP_ENDS(rp_arena_end) rp_arena name = {0}

/* A text of the arena in the format of printf; NULL without memory. */
char *rp_text(rp_arena *arena, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* A path of the arena in the format of printf. Errors: RP_BAD_INPUT (longer than the system takes),
 * RP_NO_MEMORY. */
rp_status rp_path(rp_arena *arena, const char **path, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

RP_C_END

#endif
