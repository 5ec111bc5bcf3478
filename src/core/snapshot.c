/* Snapshots; see snapshot.h. */
#include "core/snapshot.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "core/file.h"
#include "core/version.h"

/* The head of a file. The numbers are the machine's own: another byte order is another format. */
typedef struct {
    char magic[16];
    uint32_t format, model;
    uint64_t layout, length; /* length: bytes of the state */
    char owner[RP_SNAPSHOT_OWNER];
} head;

static const char MAGIC[16] = "repose snapshot\n";

static void make_room(rp_snapshot *s, size_t more)
{
    if (s->capacity - s->n >= more) return;
    const size_t capacity = 2 * (s->n + more);
    unsigned char *bytes = realloc(s->bytes, capacity);
    if (bytes)
        s->bytes = bytes, s->capacity = capacity;
    else
        s->status = rp_fail(RP_NO_MEMORY, "snapshot: out of memory");
}

void rp_keep(rp_snapshot *s, void *data, size_t size)
{
    if (!s->status && !s->reading) make_room(s, size);
    if (!s->status && s->reading && s->n - s->at < size)
        s->status = rp_fail(RP_BAD_INPUT, "%s: its state ends too early", s->path);
    if (s->status || size == 0) return;
    if (s->reading)
        memcpy(data, s->bytes + s->at, size), s->at += size;
    else
        memcpy(s->bytes + s->n, data, size), s->n += size;
}

void rp_keep_check(rp_snapshot *s, bool good, const char *what)
{
    if (!s->status && s->reading && !good)
        s->status = rp_fail(RP_BAD_INPUT, "%s: its state has %s", s->path, what);
}

bool rp_keep_bool(const bool *value)
{
    unsigned char byte;
    memcpy(&byte, value, 1);
    return byte <= 1;
}

void rp_snapshot_free(rp_snapshot *s)
{
    free(s->bytes);
    *s = (rp_snapshot){0};
}

static rp_status cannot_write(const char *path)
{
    return rp_fail(RP_IO, "%s: cannot write: %s", path, strerror(errno));
}

/* XXH3-128 of head and state. */
static XXH128_hash_t checksum(const head *h, const void *state, size_t length)
{
    XXH128_hash_t hash = XXH3_128bits(h, sizeof *h);
    return XXH3_128bits_withSeed(state, length, hash.low64 ^ hash.high64);
}

static head head_of(const rp_snapshot *s, const char *owner, uint64_t layout)
{
    head h = {.format = RP_SNAPSHOT_FORMAT, .model = RP_MODEL_VERSION, .layout = layout, .length = s->n};
    memcpy(h.magic, MAGIC, sizeof MAGIC);
    snprintf(h.owner, sizeof h.owner, "%s", owner);
    return h;
}

rp_status rp_snapshot_write(rp_snapshot *s, const char *path, const char *owner, uint64_t layout)
{
    if (s->status) return s->status;
    char temporary[PATH_MAX];
    if (snprintf(temporary, sizeof temporary, "%s.new", path) >= (int)sizeof temporary)
        return rp_fail(RP_IO, "%.60s...: path too long", path);
    unlink(temporary); /* of a writer that was killed */
    FILE *out = fopen(temporary, "wxe");
    if (!out) return cannot_write(path);
    const head h = head_of(s, owner, layout);
    const XXH128_hash_t hash = checksum(&h, s->bytes, s->n);
    fwrite(&h, sizeof h, 1, out), fwrite(s->bytes, 1, s->n, out), fwrite(&hash, sizeof hash, 1, out);
    const rp_status status = rp_file_close(path, out, RP_OK);
    return status || rp_file_sync_folder(path) ? status : cannot_write(path);
}

static rp_status read_file(rp_snapshot *s, const char *path)
{
    const int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    FILE *in = file < 0 ? NULL : fdopen(file, "r");
    struct stat info;
    if (!in) return rp_fail(RP_BAD_INPUT, "cannot read: %s", strerror(errno));
    rp_status status = fstat(file, &info) == 0 && S_ISREG(info.st_mode)
                           ? RP_OK
                           : rp_fail(RP_BAD_INPUT, "not a regular file");
    if (!status) make_room(s, (size_t)info.st_size + 1), status = s->status;
    if (!status) s->n = fread(s->bytes, 1, s->capacity, in);
    if (ferror(in)) status = rp_fail(RP_BAD_INPUT, "cannot read: %s", strerror(errno));
    fclose(in);
    return status;
}

static rp_status check_head(const rp_snapshot *s, const head *h, const char *owner, uint64_t layout)
{
    XXH128_hash_t hash, expected;
    if (s->n < sizeof *h || memcmp(h->magic, MAGIC, sizeof MAGIC) != 0)
        return rp_fail(RP_BAD_INPUT,
                       s->n < sizeof *h && memcmp(s->bytes, MAGIC, s->n < 16 ? s->n : 16) == 0
                           ? "truncated: %zu bytes"
                           : "not a snapshot of repose (%zu bytes)",
                       s->n);
    if (h->format != RP_SNAPSHOT_FORMAT)
        return rp_fail(RP_BAD_INPUT, "format version %u; this program reads %d", h->format,
                       RP_SNAPSHOT_FORMAT);
    const size_t rest = s->n - sizeof *h;
    if (rest < sizeof hash || h->length != rest - sizeof hash)
        return rp_fail(RP_BAD_INPUT, "%s: %zu bytes of state and checksum, %llu of state expected",
                       rest < sizeof hash || h->length > rest - sizeof hash ? "truncated" : "damaged", rest,
                       (unsigned long long)h->length);
    memcpy(&expected, s->bytes + s->n - sizeof expected, sizeof expected);
    hash = checksum(h, s->bytes + sizeof *h, h->length);
    if (!XXH128_isEqual(hash, expected)) return rp_fail(RP_BAD_INPUT, "damaged: its checksum is wrong");
    if (h->model != RP_MODEL_VERSION)
        return rp_fail(RP_BAD_INPUT, "made by model version %u; this program has %d", h->model,
                       RP_MODEL_VERSION);
    if (strncmp(h->owner, owner, sizeof h->owner - 1) != 0)
        return rp_fail(RP_BAD_INPUT, "the state of another run: \"%.*s\", not \"%s\"",
                       (int)sizeof h->owner - 1, h->owner, owner);
    return h->layout == layout ? RP_OK
                               : rp_fail(RP_BAD_INPUT, "made by a program with another layout of the state");
}

rp_status rp_snapshot_read(rp_snapshot *s, const char *path, const char *owner, uint64_t layout)
{
    head h = {.magic = ""};
    *s = (rp_snapshot){.reading = true, .path = path};
    rp_status status = read_file(s, path);
    if (!status) {
        memcpy(&h, s->bytes, s->n < sizeof h ? s->n : sizeof h);
        status = check_head(s, &h, owner, layout);
    }
    if (status) return s->status = rp_prefix(status, "%s: ", path);
    s->at = sizeof h;
    s->n -= sizeof(XXH128_hash_t);
    return RP_OK;
}

rp_status rp_snapshot_end(rp_snapshot *s)
{
    rp_keep_check(s, s->at == s->n, "more data than it should");
    return s->status;
}
