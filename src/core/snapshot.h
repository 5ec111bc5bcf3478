/* Snapshots: files from which a run continues bit for bit, on the same kind of machine.
 *
 * One list of rp_keep calls is both the writer and the reader of a state, so that the two agree. A file holds
 * a head (format, model, layout of the state, owner), the state, and the XXH3-128 of both. */
#ifndef RP_SNAPSHOT_H
#define RP_SNAPSHOT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "core/status.h"

RP_C_BEGIN

enum { RP_SNAPSHOT_FORMAT = 1, RP_SNAPSHOT_OWNER = 40 };

typedef struct {
    bool reading;
    rp_status status; /* of the first failure; later calls do nothing */
    unsigned char *bytes;
    size_t n, capacity, at; /* at: read so far */
    const char *path;       /* for messages, of a reading; borrowed */
} rp_snapshot;

/* Write the data behind those written before, or read them back, in the same order. Errors, in the status:
 * RP_BAD_INPUT (fewer data than asked for), RP_NO_MEMORY. */
void rp_keep(rp_snapshot *s, void *data, size_t size);
#define RP_KEEP(s, variable) rp_keep(s, &(variable), sizeof(variable))

/* Whether the byte that was read is one of a bool. */
bool rp_keep_bool(const bool *value);

/* After a reading: refuse the state with a reason; the first reason stays. */
void rp_keep_check(rp_snapshot *s, bool good, const char *what);

/* Write a state to `path`: a new file PATH.new, synced, then renamed. A failure leaves the older
 * snapshot. `owner` names what the state is of, `layout` is a number that changes with its structure.
 * rp_snapshot_free follows. Errors: RP_IO, that of the status. */
rp_status rp_snapshot_write(rp_snapshot *s, const char *path, const char *owner, uint64_t layout);

/* Read a file that rp_snapshot_write made, for the rp_keep calls to come. rp_snapshot_free follows, also
 * after an error. Errors: RP_BAD_INPUT (no snapshot; truncated, damaged; of another format, model, layout or
 * owner; not a file), RP_NO_MEMORY. */
rp_status rp_snapshot_read(rp_snapshot *s, const char *path, const char *owner, uint64_t layout);

/* After the last rp_keep of a reading: RP_BAD_INPUT if data are left over. */
rp_status rp_snapshot_end(rp_snapshot *s);
void rp_snapshot_free(rp_snapshot *s);

RP_C_END

#endif
