/* Progress of a run and of a sweep; see progress.h. */
#include <math.h>
#include <stdarg.h>
#include <unistd.h>

#include "cli/progress.h"
#include "core/clock.h"

static const char bar[] = "##############################";

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

cli_progress cli_progress_start(bool quiet, bool terminal, double now, long from, long to)
{
    return (cli_progress){quiet, terminal, false, now, now + (terminal ? 0.5 : 60.0), from, to};
}

static void progress_text(const cli_progress *p, double now, long step, char text[120])
{
    char left[32];
    const double done = (double)(step - p->from), all = (double)(p->to - p->from),
                 seconds = done > 0.0 ? (now - p->started) * (all - done) / done : NAN;
    snprintf(text, 120, "step %ld of %ld, %.0f %%, %s left", step, p->to,
             floor(100.0 * (double)step / fmax((double)p->to, 1.0)), clock_text(seconds, left, sizeof left));
}

void cli_progress_show(cli_progress *p, double now, long step, FILE *out)
{
    char text[120];
    const bool ends = step == p->to && p->drawn;
    if (p->quiet || (now < p->next && !(p->terminal && ends))) return;
    if (!p->terminal && step == p->to) return;
    p->next = now + (p->terminal ? 0.1 : 60.0);
    p->drawn = true;
    progress_text(p, now, step, text);
    if (!p->terminal) {
        fprintf(out, "repose run: %s\n", text);
        return;
    }
    const int width = (int)sizeof bar - 1,
              full = p->to > 0 ? (int)((double)step / (double)p->to * width) : width;
    fprintf(out, "\r[%.*s%*s] %-60s%s", full, bar, width - full, "", text, ends ? "\n" : "");
    fflush(out);
}

bool cli_progress_due(const cli_progress *p, double now)
{
    return !p->quiet && now >= p->next;
}

void cli_progress_tell(cli_progress *p, double now, const char *where, FILE *out)
{
    p->next = now + (p->terminal ? 0.1 : 60.0);
    if (p->terminal && (where || p->drawn))
        fprintf(out, where ? "\r%-79.79s" : "\r%79s\r", where ? where : "");
    else if (where)
        fprintf(out, "repose run: %s\n", where);
    p->drawn = where != NULL;
    fflush(out);
}

static double due; /* when a sweep shows its progress again, in its own time */

/* One line, redrawn in place, in plain text. */
static void draw(const sweep_progress *p, void *context)
{
    if (p->stored < p->planned && p->elapsed < due) return;
    due = p->elapsed + 0.1;
    *(bool *)context = true;
    char elapsed[32], left[32], line[160];
    int width = (int)sizeof bar - 1, full = (int)(p->stored * (size_t)width / p->planned);
    snprintf(line, sizeof line, "[%.*s%*s] %zu/%zu  %zu failed  %s  left %s", full, bar, width - full, "",
             p->stored, p->planned, p->failed, clock_text(p->elapsed, elapsed, sizeof elapsed),
             clock_text(p->left, left, sizeof left));
    fprintf(stderr, "\r%-79s", line);
    fflush(stderr);
}

/* A line a minute. */
static void print(const sweep_progress *p, void *context)
{
    (void)context;
    char left[32];
    if (p->elapsed < due) return;
    due = p->elapsed + 60.0;
    fprintf(stderr, "repose sweep: %zu of %zu runs, %zu failed, %s left\n", p->stored, p->planned, p->failed,
            clock_text(p->left, left, sizeof left));
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

static void draw_part(const char *what, size_t done, size_t of)
{
    static double next;
    if (of < 100000 || (done < of && rp_clock() < next)) return;
    next = rp_clock() + 0.5;
    fprintf(stderr, "\r%zu of %zu %s%s", done, of, what, done == of ? "\n" : "");
}

sweep_watch *cli_watch(bool quiet)
{
    return !quiet && isatty(STDERR_FILENO) ? draw_part : NULL;
}

void cli_sweep_progress(sweep_options *options, bool quiet, bool *drawn)
{
    *drawn = false;
    options->watch = quiet ? NULL : isatty(STDERR_FILENO) ? draw : print;
    options->context = drawn;
    due = options->watch == print ? 60.0 : 0.0;
    options->report = report;
}
