/* What the readers of a text's parts share. */
#ifndef EXP_READING_H
#define EXP_READING_H

#include "experiment/private.h"
#include "params/settings.h"

/* A name; one that nothing else has. */
rp_status exp_check_word(const config_setting_t *setting, const char *what, const char *name);
rp_status exp_check_name(const exp_plan *plan, const config_setting_t *setting, const char *what,
                         const char *name);
bool exp_is_word(const char *word); /* of a run's status */

/* n numbers or expressions, (a, b, ...). */
rp_status exp_read_list(const config_setting_t *list, const char *key, size_t n, exp_place *place,
                        exp_expression *e);

/* A name among those of walls, or of phases, *at its number; a failure names the nearest. Without a key the
 * setting itself bears the name. */
rp_status exp_find_wall(const exp_plan *plan, const config_setting_t *setting, const char *key,
                        const char *name, size_t *at);
rp_status exp_find_phase(const exp_plan *plan, const config_setting_t *setting, const char *key,
                         const char *name, size_t *phase);

/* Kinds of grains first, then names and places of the phases, then of the measures; then what their
 * expressions say. */
rp_status exp_name_kinds(exp_plan *plan);
rp_status exp_name_phases(exp_plan *plan);
rp_status exp_name_measures(exp_plan *plan);
rp_status exp_read_phase(exp_plan *plan, size_t phase);
rp_status exp_read_measure(exp_plan *plan, size_t measure);
extern const rp_param exp_phase_schema[], exp_measure_schema[];

#endif
