/* Names that a text gives to numbers, truths and words, `let`, for the expressions that stand in place of its
 * values. */
#ifndef RP_LETS_H
#define RP_LETS_H

#include <libconfig.h>

#include "params/expression.h"

/* NAME = value; or NAME = { value; unit; range; meaning; }. */
typedef struct {
    const char *name, *unit, *range, *meaning; /* "" where nothing is said */
    rp_x_symbol is;
    bool computed; /* by an expression of others */
    enum { RP_LET_UNREAD, RP_LET_READING, RP_LET_READ } state;
    const config_setting_t *value; /* its setting */
} rp_let;

/* Constants of the text besides pi, deg and inf: diameter and mass of the mean grain, |gravity|, the time
 * step. */
enum { RP_PLACE_BYTES = 256 };
typedef enum { RP_LET_D, RP_LET_M, RP_LET_G, RP_LET_DT, RP_LET_CONSTANTS } rp_let_constant;

typedef struct rp_lets {
    rp_arena arena;
    size_t n;
    /* Read one, unless it has been read: where another one asks for it. Errors: RP_BAD_INPUT. */
    rp_status (*read)(rp_let *let, const struct rp_lets *lets);
    bool foreign; /* values are given in other units than the text is written in */
    rp_let *lets;
    double constants[RP_LET_CONSTANTS]; /* NAN: not known yet */
    /* Find one when a text asks for it; NULL: none is known. Errors: those of the keys it is read from. */
    rp_status (*know)(void *host, rp_let_constant which, double *value);
    void *host;
    /* As that of rp_x_names; its host is the rp_lets. */
    rp_status (*call)(void *host, const char *name, int n, const double args[], double *value, bool *known);
    /* Where a key that stands in a wrong place belongs, into `text`; false: nowhere. NULL: not known. */
    bool (*place)(const char *key, char text[RP_PLACE_BYTES]);
    bool asked[RP_LET_CONSTANTS];
    rp_x_names names;
} rp_lets;

/* Read the group `let` of a text, if it has one; from here on rp_config_* take expressions for the text's
 * values. `lets` must outlive them, and ends with rp_lets_end. Another reading forgets the first. Errors:
 * RP_BAD_INPUT (names that are taken, values that are none, out of their range). */
rp_status rp_lets_read(config_setting_t *root, rp_lets *lets);
void rp_lets_end(rp_lets *lets);

/* Add a place to a text of places: as NAME = { KEY = ...; }, or after the first by its name. */
void rp_put_place(char text[RP_PLACE_BYTES], size_t *used, const char *name, const char *key,
                  const char *brackets);

/* Where a key belongs that its group does not know, by `place`. */
bool rp_lets_place(const config_setting_t *setting, const char *key, char text[RP_PLACE_BYTES]);

/* What a name stands for in all expressions, beside lets; NULL: nothing. */
const char *rp_name_meaning(const char *name);

/* A constant, which is found where it is first asked for. Errors: RP_BAD_INPUT (not known here; those of
 * `know`). */
rp_status rp_lets_constant(rp_lets *lets, rp_let_constant which, double *value);

/* The names of lets and constants, as those of rp_x_names; the host is the rp_lets. */
rp_status rp_lets_find(void *lets, const char *name, int n_args, rp_x_symbol *symbol, bool *known);
void rp_lets_list(void *lets, rp_guess *guess);

/* The value of an expression that stands for a setting, which must be known before the run. Errors:
 * RP_BAD_INPUT, with the expression and the character; without lets RP_NO_RESULT and no message. */
rp_status rp_lets_value(const config_setting_t *setting, const char *text, rp_x_symbol *value);

/* A value as a setting has it: whole numbers are such, where doubles tell them apart. */
rp_value rp_x_value(rp_x_type type, double value, const char *word);

/* Is this a name of the text that the setting is of? */
bool rp_lets_has(const config_setting_t *setting, const char *name);

#endif
