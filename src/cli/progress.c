/* Progress of a run and of a sweep; see progress.h. */
#include <math.h>
#include <stdarg.h>
#include <unistd.h>

#include "cli/cli.h"
#include "cli/progress.h"
#include "core/clock.h"
#include "core/plain.h"

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

static bool is_due(cli_progress *p, double now)
{
    if (p->quiet || now < p->next) return false;
    p->next = now + (p->terminal ? 0.1 : 60.0);
    return true;
}

/* One line, redrawn in place, in plain text. */
static void draw(cli_progress *p, double part, const char *text, FILE *out)
{
    static const char bar[] = "##############################";
    const int width = (int)sizeof bar - 1, full = (int)(part * width);
    fprintf(out, "\r[%.*s%*s] %-46s", full, bar, width - full, "", text);
    fflush(out);
    p->drawn = true;
}

void cli_progress_show(cli_progress *p, double now, long step, FILE *out)
{
    char text[120], left[32];
    const bool ends = step == p->to;
    if (ends ? !(p->terminal && p->drawn) : !is_due(p, now)) return;
    const double done = (double)(step - p->from), to = fmax((double)p->to, 1.0),
                 seconds = done > 0.0 ? (now - p->started) * (double)(p->to - step) / done : NAN;
    snprintf(text, sizeof text, "step %ld of %ld, %.0f %%, %s left", step, p->to,
             floor(100.0 * (double)step / to), clock_text(seconds, left, sizeof left));
    if (p->terminal)
        draw(p, (double)step / to, text, out);
    else
        fprintf(out, "repose run: %s\n", text);
    if (ends) fputc('\n', out);
}

void cli_progress_tell(cli_progress *p, double now, const char *where, FILE *out)
{
    if (where ? !is_due(p, now) : !(p->terminal && p->drawn)) return;
    if (p->terminal)
        fprintf(out, where ? "\r%-79.79s" : "\r%79s\r", where ? where : "");
    else
        fprintf(out, "repose run: %s\n", where);
    p->drawn = where != NULL;
    fflush(out);
}

void cli_progress_planning(void *progress, size_t checked, size_t points)
{
    cli_progress *p = progress;
    char text[80];
    if (!is_due(p, rp_clock())) return;
    snprintf(text, sizeof text, "%zu of %zu grid points checked", checked, points);
    if (p->terminal)
        draw(p, (double)checked / (double)points, text, stderr);
    else
        cli_say("repose sweep: %s", text);
}

static void show_sweep(const sweep_progress *s, void *context)
{
    cli_progress *p = context;
    char elapsed[32], left[32], line[120];
    const bool ends = p->terminal && s->stored == s->planned;
    if (!is_due(p, s->elapsed) && !ends) return;
    clock_text(s->left, left, sizeof left);
    if (p->terminal) {
        snprintf(line, sizeof line, "%zu/%zu  %zu failed  %s  left %s", s->stored, s->planned, s->failed,
                 clock_text(s->elapsed, elapsed, sizeof elapsed), left);
        draw(p, (double)s->stored / (double)s->planned, line, stderr);
    } else {
        fprintf(stderr, "repose sweep: %zu of %zu runs, %zu failed, %s left\n", s->stored, s->planned,
                s->failed, left);
    }
}

static void report(void *context, const char *format, ...)
{
    cli_progress *p = context;
    char text[RP_MESSAGE];
    va_list args;
    va_start(args, format);
    rp_plain_print(text, format, args);
    va_end(args);
    if (p->drawn) fputc('\n', stderr);
    cli_say("repose sweep: %s", text);
    p->drawn = false;
}

void cli_sweep_progress(sweep_options *options, bool quiet, cli_progress *p)
{
    const bool terminal = isatty(STDERR_FILENO);
    *p = (cli_progress){.terminal = terminal, .next = terminal ? 0.0 : 60.0};
    options->watch = quiet ? NULL : show_sweep;
    options->context = p;
    options->report = report;
}
