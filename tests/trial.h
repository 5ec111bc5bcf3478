/* A text of an experiment, its plan and a run of it. */
#ifndef TRIAL_H
#define TRIAL_H

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

/* Texts of tests have ` in place of ". */
static inline void write_trial(const char *name, const char *text)
{
    scoped char *made = strdup(text);
    for (char *c = made; *c; c++) *c = *c == '`' ? '"' : *c;
    write_text(name, "%s", made);
}

/* As of check_changed. Free it. */
#define changed(text, from, to) strdup(check_changed(text, from, to))

static inline rp_status read_text(trial *t, const char *text)
{
    static char path[256]; /* which the text borrows */
    *t = (trial){0};
    write_trial("e.cfg", text);
    snprintf(path, sizeof path, "%s", path_of("e.cfg"));
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
    const exp_end *now = exp_ended(t->run);
    if (strcmp(now->status, status) != 0)
        fprintf(stderr, "%s (%s), not %s\n", now->status, now->message, status);
    CU_ASSERT_STRING_EQUAL(now->status, status);
    CU_ASSERT((strncmp(now->status, "ok", 2) == 0 || *now->message) && !strstr(now->message, "-nan"));
}

/* A trial of this name that has been run so. */
#define RUN_TRIAL(t, text, part, status)                                                                     \
    scoped_trial t;                                                                                          \
    run_whole(&t, text, part, status)

/* A change of a text, and what comes of it. */
typedef struct {
    const char *text, *from, *to, *expected;
} trial_change;

/* Each is refused with this message, when it is read or checked; NULL: it is not. Each run ends with this
 * word. Each has "another" key, or the "same". */
static inline void check_refused(size_t n, const trial_change changes[])
{
    for (const trial_change *c = changes; c < changes + n; c++) {
        scoped_trial t;
        rp_status status = read_text(&t, check_changed(c->text, c->from, c->to));
        if (!status) status = exp_check(t.plan);
        CHECK_FAILS_IF(c->expected, status, RP_BAD_INPUT, c->expected);
    }
}

static inline void check_ends(size_t n, const trial_change changes[])
{
    for (const trial_change *c = changes; c < changes + n; c++) {
        RUN_TRIAL(t, check_changed(c->text, c->from, c->to), 100000, c->expected);
    }
}

/* Of a run and all that it measures. */
static inline rp_status whole_key(const exp_plan *plan, XXH128_hash_t *key)
{
    exp_measured m;
    RP_TRY(exp_key(plan, key));
    for (size_t k = 0; k < exp_measure_count(plan); k++) {
        RP_TRY(exp_measure_at(plan, k, &m));
        *key = rp_hash_add(*key, m.key);
    }
    return RP_OK;
}

static inline void check_keys(size_t n, const trial_change changes[])
{
    for (const trial_change *c = changes; c < changes + n; c++) {
        scoped_trial a, b;
        CHECK_OK(read_text(&a, c->text));
        CHECK_OK(read_text(&b, check_changed(c->text, c->from, c->to)));
        XXH128_hash_t key, now;
        CHECK_OK(whole_key(a.plan, &key));
        CHECK_OK(whole_key(b.plan, &now));
        const char *is = XXH128_isEqual(key, now) ? "same" : "another";
        if (strcmp(is, c->expected) != 0) fprintf(stderr, "key of %s: %s\n", c->to, is);
        CU_ASSERT_STRING_EQUAL(is, c->expected);
    }
}

static inline void check_same_values(const trial *t, const trial *whole)
{
    size_t n;
    exp_outputs(whole->plan, &n);
    CU_ASSERT(memcmp(exp_values(t->run), exp_values(whole->run), n * sizeof(double)) == 0);
    CU_ASSERT(exp_steps(t->run) == exp_steps(whole->run));
}

/* A run that is cut into parts, others from so many steps on, and one that has been kept then and gone on
 * with in another, give what the whole one gives. */
static inline void check_cut(const char *text, const trial *whole, long part, long steps, long then)
{
    scoped_trial cut, kept;
    RP_ENDS(rp_snapshot_free) rp_snapshot s = {0};
    start(&cut, text), start(&kept, text);
    while (exp_steps(cut.run) < steps && !exp_done(cut.run)) CHECK_OK(exp_advance(cut.run, part));
    exp_keep(&s, cut.run);
    CHECK_OK(s.status);
    s.reading = true;
    exp_keep(&s, kept.run);
    CHECK_OK(rp_snapshot_end(&s));
    finish(&cut, then);
    finish(&kept, 333);
    check_same_values(&cut, whole), check_same_values(&kept, whole);
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
