/* What the readers of a text's parts share. */
#ifndef EXP_READING_H
#define EXP_READING_H

#include "experiment/plan.h"
#include "params/settings.h"

/* A name; one that nothing else has. */
rp_status exp_check_word(const config_setting_t *setting, const char *what, const char *name);
rp_status exp_check_name(const exp_plan *plan, const config_setting_t *setting, const char *what,
                         const char *name);
/* A let or measure whose name expressions, `add` or `of` know as something else; `of`: what is measured. */
rp_status exp_check_meaning(const config_setting_t *setting, const char *what, const char *name,
                            const char *of);
bool exp_is_word(const char *word); /* of a run's status */

/* No more in a list than can be looked through for each name. */
rp_status exp_check_count(const config_setting_t *list, size_t n);

/* The first setting of a group whose name is one of these words, NULL: there is none. */
const config_setting_t *exp_has_key(const config_setting_t *group, const char *words);

/* n numbers or expressions, (a, b, ...). */
rp_status exp_read_list(const config_setting_t *list, const char *key, size_t n, exp_place *place,
                        exp_expression *e);

/* Keys of a group that are expressions, ended by a NULL key; those that are there are read, but for e = NULL.
 * n: numbers of a list, 0: one alone. The range is that of a number that is known, as of a parameter, NULL:
 * any; `within` stands before the key where it fails. Errors: RP_BAD_INPUT. */
typedef struct {
    const char *key;
    exp_expression *e;
    size_t n;
    rp_x_type type;
    const char *range;
    bool whole; /* a number that stands there alone; what is computed is rounded */
} exp_key_of;
rp_status exp_read_keys(const config_setting_t *group, const char *within, const exp_key_of *keys,
                        exp_place *place);

/* The condition `if` of a phase or measure: whether that is left out. */
rp_status exp_read_if(exp_plan *plan, const config_setting_t *group, bool *left_out);

/* The number of a name of this sort that a key of a group says, as it was if it says none; a failure names
 * the nearest. Without a key the group itself bears the name. */
rp_status exp_find(const exp_plan *plan, int sort, const config_setting_t *group, const char *key,
                   const char *name, size_t *index);
void exp_add_scope(exp_plan *plan, int sort, size_t index, const char *name);

/* Names and places of the phases, with the kinds of grains; of the measures; then what their expressions say.
 */
size_t exp_count_phases(const config_setting_t *list);
rp_status exp_name_phases(exp_plan *plan);
rp_status exp_name_measures(exp_plan *plan);
rp_status exp_read_phase(exp_plan *plan, size_t phase);
rp_status exp_read_measure(exp_plan *plan, size_t measure);
extern const rp_param exp_phase_schema[], exp_measure_schema[];
extern const char exp_phase_keys[], exp_measure_keys[]; /* beside the schemas */

#endif
