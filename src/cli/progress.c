/* Progress of a sweep on a terminal; see cli.h. */
#include <math.h>
#include <stdarg.h>
#include <unistd.h>

#include "cli/cli.h"

/* "1:02:03" or "2:03"; "-" for NaN. */
static const char *clock_text(double seconds, char *buffer, size_t size)
{
    long s = isfinite(seconds) ? lround(seconds) : -1;
    if (s < 0)
        snprintf(buffer, size, "-");
    else if (s < 3600)
        snprintf(buffer, size, "%ld:%02ld", s / 60, s % 60);
    else
        snprintf(buffer, size, "%ld:%02ld:%02ld", s / 3600, s / 60 % 60, s % 60);
    return buffer;
}

/* One line, redrawn in place, in plain text. */
static void draw(const sweep_progress *p, void *context)
{
    *(bool *)context = true;
    static const char bar[] = "##############################";
    char elapsed[32], left[32], line[160];
    int width = (int)sizeof bar - 1, full = (int)(p->stored * (size_t)width / p->planned);
    snprintf(line, sizeof line, "[%.*s%*s] %zu/%zu  %zu failed  %s  left %s", full, bar, width - full, "",
             p->stored, p->planned, p->failed, clock_text(p->elapsed, elapsed, sizeof elapsed),
             clock_text(p->left, left, sizeof left));
    fprintf(stderr, "\r%-79s", line);
    fflush(stderr);
}

static void report(void *context, const char *format, ...)
{
    va_list args;
    fputs(*(bool *)context ? "\nrepose sweep: " : "repose sweep: ", stderr);
    va_start(args, format);
    vfprintf(stderr, format, args);
    va_end(args);
    fputc('\n', stderr);
    *(bool *)context = false;
}

rp_status cli_sweep_run(const char *dir, long workers, double memory, double time, sweep_counts *counts)
{
    bool drawn = false;
    sweep_options options = {.workers = (int)(workers < 1 ? sysconf(_SC_NPROCESSORS_ONLN) : workers),
                             .watch = isatty(STDERR_FILENO) ? draw : NULL,
                             .context = &drawn,
                             .memory = memory,
                             .time = time,
                             .report = report};
    rp_status status = sweep_run(dir, sweep_protocols, &options, counts);
    if (drawn) fputc('\n', stderr);
    return status;
}
