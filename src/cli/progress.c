/* Progress of a sweep on a terminal; see cli.h. */
#include <math.h>
#include <stdarg.h>
#include <unistd.h>

#include "cli/cli.h"
#include "core/clock.h"

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
    static double next;
    if (p->stored < p->planned && rp_clock() < next) return;
    next = rp_clock() + 0.1;
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

static void draw_part(const char *what, size_t done, size_t of, void *context)
{
    (void)context;
    static double next;
    if (of < 100000 || (done < of && rp_clock() < next)) return;
    next = rp_clock() + 0.5;
    fprintf(stderr, "\r%zu of %zu %s%s", done, of, what, done == of ? "\n" : "");
}

const sweep_watch *cli_watch(void)
{
    static const sweep_watch watch = {draw_part, NULL};
    return isatty(STDERR_FILENO) ? &watch : NULL;
}

rp_status cli_sweep_run(const char *dir, sweep_options options, sweep_counts *counts)
{
    bool drawn = false;
    if (options.workers < 1) options.workers = (int)sysconf(_SC_NPROCESSORS_ONLN);
    options.watch = isatty(STDERR_FILENO) ? draw : NULL;
    options.context = &drawn;
    options.report = report;
    rp_status status = sweep_run(dir, sweep_protocols, &options, counts);
    if (drawn) fputc('\n', stderr);
    return status;
}
