/* A text of an experiment, its plan and a run of it. */
#ifndef TRIAL_H
#define TRIAL_H

#include <math.h>
#include <string.h>

#include "check.h"
#include "experiment/experiment.h"
#include "program.h"

typedef struct {
    dem_text text;
    exp_plan *plan;
    exp_run *run;
} trial;

static inline void end(trial *t)
{
    exp_run_free(t->run);
    exp_free(t->plan);
    dem_text_close(&t->text);
}
#define scoped_trial __attribute__((cleanup(end))) trial

static inline rp_status read_text(trial *t, const char *text)
{
    static char path[256]; /* which the text borrows */
    *t = (trial){0};
    write_text("e.cfg", "%s", text);
    path_of("e.cfg", path);
    RP_TRY(dem_text_open(path, NULL, NULL, &t->text));
    return exp_read(&t->text, &t->plan);
}

static inline void start(trial *t, const char *text)
{
    CHECK_OK(read_text(t, text));
    CHECK_OK(exp_start(t->plan, 7, 3, &t->run));
}

static inline void finish(trial *t, long part)
{
    while (!exp_done(t->run)) CHECK_OK(exp_advance(t->run, part));
}

/* From the start to an end of this status. */
static inline void run_whole(trial *t, const char *text, long part, const char *status)
{
    start(t, text);
    finish(t, part);
    CU_ASSERT_STRING_EQUAL(exp_ended(t->run)->status, status);
}

static inline double measured(const trial *t, const char *name)
{
    size_t n;
    const exp_output *o = exp_outputs(t->plan, &n);
    for (size_t k = 0; k < n; k++)
        if (strcmp(o[k].name, name) == 0) return exp_values(t->run)[k];
    fprintf(stderr, "%s: no such measure\n", name);
    return NAN;
}

#endif
