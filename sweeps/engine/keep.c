/* Snapshots of one run of a sweep; see keep.h. */
#include "sweeps/engine/keep.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <xxhash.h>

#include "core/clock.h"
#include "core/file.h"
#include "core/version.h"

/* Another commit may keep other variables: its snapshots are refused, and their runs start anew. */
static uint64_t layout(void)
{
    return XXH3_64bits_withSeed(rp_build_commit, strlen(rp_build_commit), dem_keep_layout());
}

void sweep_keep_begin(sweep_keep *k, char *why, size_t size)
{
    k->next = rp_cpu_clock() + k->interval;
    *why = '\0';
    if (access(k->path, F_OK) != 0 || rp_snapshot_read(&k->source, k->path, k->key, layout()) == RP_OK)
        return;
    snprintf(why, size, "%s", rp_message());
    rp_snapshot_free(&k->source);
}

bool sweep_keep_is_name(const char *name)
{
    const size_t digits = strspn(name, "0123456789abcdef");
    return digits == 32 && (!name[digits] || rp_ends_in(name, ".new"));
}

void sweep_keep_remove(const char *path)
{
    char unfinished[4096 + 8];
    snprintf(unfinished, sizeof unfinished, "%s.new", path);
    unlink(path);
    unlink(unfinished);
}

void sweep_keep_end(sweep_keep *k, bool done)
{
    rp_snapshot_free(&k->source);
    if (done) sweep_keep_remove(k->path);
}

void sweep_keep_file(rp_snapshot *s, FILE *file)
{
    size_t n = fflush(file) == 0 && !s->reading ? (size_t)ftell(file) : 0;
    RP_KEEP(s, n);
    rp_keep_check(s, n <= s->n - s->at, "a table that is too long");
    if (s->status) return;
    char *text = malloc(n + 1);
    bool good = text && (s->reading || pread(fileno(file), text, n, 0) == (ssize_t)n);
    if (good) rp_keep(s, text, n);
    if (good && s->reading) {
        rewind(file);
        good = ftruncate(fileno(file), 0) == 0 && fwrite(text, 1, n, file) == n;
    }
    if (!good) s->status = rp_fail(RP_IO, "%s: cannot keep a table", s->path ? s->path : "snapshot");
    free(text);
}

rp_status sweep_keep_resume(sweep_keep *k, void (*by)(rp_snapshot *, void *), void *data)
{
    if (!k) return RP_OK;
    k->by = by, k->data = data;
    if (k->source.n == 0) return RP_OK;
    by(&k->source, data);
    return rp_snapshot_end(&k->source);
}

rp_status sweep_keep_look(sweep_keep *k)
{
    if (!k) return RP_OK;
    const bool stops = k->stop && *k->stop;
    if (!stops && k->skipped < k->pause) return k->skipped++, RP_OK;
    const double now = rp_cpu_clock();
    k->pause = now - k->looked < 0.01 * fmin(k->interval, 1.0) ? 2 * (k->pause % 128) + 1 : 0;
    k->skipped = 0, k->looked = now;
    if (!stops && now < k->next) return RP_OK;
    rp_snapshot s = {0};
    k->by(&s, k->data);
    rp_status status = rp_snapshot_write(&s, k->path, k->key, layout());
    rp_snapshot_free(&s);
    k->next = rp_cpu_clock() + k->interval;
    return !status && stops ? rp_fail(RP_STOPPED, "stopped") : status;
}
