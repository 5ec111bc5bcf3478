/* The frames of a table: rows of equal step that follow one another; see export.h. */
#include <math.h>

#include "cli/export.h"

void cli_frames_split(size_t n, const double step[], cli_frames *f)
{
    f->first = cli_memory(n + 1, sizeof *f->first);
    f->steps = cli_memory(n, sizeof *f->steps);
    f->n = 0;
    for (size_t i = 0; i < n; i++) {
        if (i > 0 && (step[i] == step[i - 1] || isnan(step[i]))) continue;
        f->steps[f->n] = step[i];
        f->first[f->n++] = i;
    }
    f->first[f->n] = n;
}

size_t cli_frame_at(const cli_frames *f, double step)
{
    size_t k = 0;
    while (k < f->n && f->step >= 0 && f->steps[k] != step) k++;
    return k;
}
