/* Experiments: a scene whose file also says, in phases, what is done with it and, in measures, what is read
 * of it; docs/scenes has the language. A plan is such a text with one set of values of its names; a run of it
 * goes on from look to look, and gives one number for each output.
 *
 * Everything about a text is checked before its first step. A run depends on the plan and its random streams
 * alone; how it is cut into parts, and kept between them, changes no bit. */
#ifndef EXP_EXPERIMENT_H
#define EXP_EXPERIMENT_H

#include "core/snapshot.h"
#include "dem/scene/text.h"
#include "experiment/modules/module.h"

typedef struct exp_plan exp_plan;
typedef struct exp_run exp_run;

/* What came of a run: "ok", the text's own word, or why there is no result. */
typedef struct {
    char status[24], message[232];
    bool of_measure; /* of one without a value, not of the run itself */
} exp_end;

/* The language, for people: keys of phases and measures, what expressions may ask for. Ended by a NULL name.
 */
extern const dem_scene_group exp_groups[];
typedef struct {
    const char *name, *of, *unit, *meaning;
} exp_word;
exp_word exp_observable_at(size_t k); /* number k of the observables; a NULL name past the end */

/* Does a text have phases? Without them it is a scene of one phase, of which nothing is measured. */
bool exp_has_phases(const dem_text *text);

/* Read scene, phases and measures of a text that is open, and stays so. Afterwards exp_free, also after an
 * error. Errors: RP_BAD_INPUT with file, line, key, text, character and the nearest name; RP_NO_MEMORY. */
rp_status exp_read(dem_text *text, exp_plan **plan);
void exp_free(exp_plan *plan);

/* Refuse a time step that a fall within the scene's fill can't take. Errors: RP_BAD_INPUT. */
rp_status exp_check(const exp_plan *plan);

void exp_with_ledger(exp_plan *plan); /* by its runs */

const dem_text *exp_text(const exp_plan *plan);
const dem_scene *exp_scene(const exp_plan *plan);
const exp_output *exp_outputs(const exp_plan *plan, size_t *n); /* ended by a NULL name */

/* The key of a run, beside its streams and the model: the hash of its text, without what is no physics (unit,
 * meaning, comments, tables), and however a number is typed. Measures are no part of it, unless the run asks
 * them: each has its own, of its text and of the measures that it asks. Errors: RP_NO_MEMORY. */
rp_status exp_key(const exp_plan *plan, XXH128_hash_t *key);
typedef struct {
    XXH128_hash_t key;
    size_t output, n_outputs; /* of the plan's, from `output` on; 0 of one that is left out */
    bool series;              /* with a table of its samples */
} exp_measured;
size_t exp_measure_count(const exp_plan *plan);
rp_status exp_measure_at(const exp_plan *plan, size_t k, exp_measured *measured);

/* Start a run with the random streams (seed, stream, purpose). A scene that can't be filled is a run that has
 * ended. Afterwards exp_run_free, also after an error. Errors: RP_BAD_INPUT, RP_NO_MEMORY. */
rp_status exp_start(const exp_plan *plan, unsigned long seed, unsigned long stream, exp_run **run);

/* The same from this phase of the top level on, with a copy of a simulation that is where the phase begins,
 * as a run of a text that is the same up to there has it. Marks, samples, loads of walls and random streams
 * begin here. Errors: RP_NO_MEMORY. */
rp_status exp_start_at(const exp_plan *plan, size_t phase, const dem_sim *sim, exp_run **run);
void exp_run_free(exp_run *run);

/* Go on by `most` steps, at least one, or to the next look or the end of a phase if that comes earlier. What
 * the run ends with is no error. Errors: RP_NO_MEMORY, RP_BROKEN; RP_NO_RESULT (a scene without phases that
 * is too soft, too fast, too hard to solve). */
rp_status exp_advance(exp_run *run, long most);

bool exp_done(const exp_run *run);
dem_sim *exp_sim(const exp_run *run); /* NULL if there never was one */
bool exp_is_cut(const exp_run *run);  /* walls cut the region of a fill: grains lie in its largest part */
long exp_steps(const exp_run *run);   /* so far */
const exp_end *exp_ended(const exp_run *run);
const char *exp_why_none(const exp_run *run,
                         size_t output);      /* an output is NAN: why, until the next message */
const double *exp_values(const exp_run *run); /* of the outputs; NAN: none */

/* The phase, and how far it is: "discharge: grains = 842, until grains < 300", "fall: step 500 of 2000"; of a
 * scene without phases its steps. Returns `text`. */
const char *exp_where(const exp_run *run, char *text, size_t size);

/* Phases and blocks in the order of the text. How often one has ended (a block once, with its passes), and
 * the run's steps and the time at its last end; passes 0: not yet. */
typedef struct {
    const char *name;
    long passes, step;
    double time;
    bool inner, look; /* of a block; and without steps, of a block of few passes */
} exp_passed;
size_t exp_phase_count(const exp_plan *plan);
exp_passed exp_phase_at(const exp_run *run, size_t k);
size_t exp_stages(const exp_run *run); /* phases of the top level that have ended */

/* Tables of measures, by the names of their files: samples of those with `series`, columns step, time and
 * value; and modules that have tables. */
const char *exp_series_name(const exp_plan *plan, size_t k); /* NULL past the last */
void exp_series_write(const exp_run *run, size_t k, FILE *out);

/* Write the state of a run into a snapshot, or read it into one that has been started. */
void exp_keep(rp_snapshot *s, exp_run *run);
uint64_t exp_keep_layout(void); /* a number that changes with what a snapshot holds */

#endif
