/* Readers of the program as targets of a fuzzer: bytes in, no crash and no broken invariant out. */
#ifndef FUZZ_TARGETS_H
#define FUZZ_TARGETS_H

#include <stdbool.h>
#include <stddef.h>

/* The files that one input is written to, split at its first byte 0, and what reads them: a command line or a
 * function. An input without a byte 0 leaves `other` in the second file. */
typedef struct {
    const char *name, *files[2], *other, *words;
    void (*act)(size_t n, const char text[]);
    bool simulates; /* physics may break down: exit status 70 is no fault of a reader */
} fuzz_target;

/* Ended by a NULL name. */
extern const fuzz_target fuzz_targets[];

/* Make a new folder of files that the targets need, and work in it. False if that fails. */
bool fuzz_enter(void);

/* Remove the folder. */
void fuzz_leave(void);

/* Abort the process, with a message, where the reader breaks a promise. */
void fuzz_run(const fuzz_target *target, size_t n, const char bytes[]);

#endif
