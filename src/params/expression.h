/* Expressions of texts: numbers, truths and words; see docs/scenes. Read once, checked, and kept as postfix,
 * whose steps a compiler leaves as they are written. Outside measures + - * / and sqrt alone compute, so that
 * all machines agree. */
#ifndef RP_EXPRESSION_H
#define RP_EXPRESSION_H

#include <stdbool.h>
#include <stddef.h>

#include "core/arena.h"
#include "params/guess.h"

typedef enum { RP_X_NUMBER, RP_X_TRUTH, RP_X_WORD } rp_x_type;
extern const char *const rp_x_types[]; /* "a number", ... */

/* Constants and functions, for people. */
extern const char rp_expression_functions[];

/* What a name stands for: a value that is known when the text is read, or one that `id` asks for. */
typedef struct {
    rp_x_type type;
    bool known;
    double value;     /* of a known one; a truth is 0 or 1 */
    const char *word; /* of a known word */
    const char *key;  /* of another: its name in keys, borrowed */
    int id;
} rp_x_symbol;

/* The names of one place in a text. */
typedef struct {
    void *host;
    /* NULL: there are none. *known: whether there is such a name. n_args is that of a call, -1 of a name
     * alone. Errors: what speaks against the name in this place. */
    rp_status (*find)(void *host, const char *name, int n_args, rp_x_symbol *symbol, bool *known);
    void (*list)(void *host, rp_guess *guess); /* tries every name, for "did you mean"; NULL: none */
    bool measure;                              /* atan, exp, log and change are allowed */
    /* A function of n known numbers, whose value is known too; NULL: there is none. Errors as of find. */
    rp_status (*call)(void *host, const char *name, int n, const double args[], double *value, bool *known);
    /* Names are columns of a table, also in quotes, and NAME=VALUE or NAME!=VALUE compares a cell with a
     * text, as it stands up to a blank, or in quotes: the id of the truth that it is equal, of a name's id;
     * -1: too many. NULL: = is no sign. */
    int (*cell)(void *host, int id, const char *text);
} rp_x_names;

typedef struct rp_x_step rp_x_step;

/* Zero: none was given. */
typedef struct {
    rp_x_type type;
    bool known; /* without a look at anything: then `value` or `word` is all */
    double value;
    const char *word, *text; /* text: borrowed */
    size_t n, n_states;
    rp_x_step *steps;
} rp_expression;

/* Read a text; the expression stays in the arena. Errors: RP_BAD_INPUT, "character 3: unknown name grians;
 * did you mean ...": syntax, unknown names, types, a name or function in the wrong place, more than 200
 * parts. */
rp_status rp_expression_read(rp_arena *arena, const char *text, const rp_x_names *names, rp_expression *e);

/* The same, of this type. */
rp_status rp_expression_read_as(rp_arena *arena, const char *text, rp_x_type type, const rp_x_names *names,
                                rp_expression *e);

/* The value now. `load` gives what names stand for. states[e->n_states], zero at first, are those of held and
 * change: each call is a look, or a sample. */
typedef struct {
    void *host;
    double (*load)(void *host, int id, const double args[]);
} rp_x_values;
double rp_expression_value(const rp_expression *e, const rp_x_values *values, double states[]);

/* The id of name number k that the value is asked of; -1 past the last. */
int rp_expression_asks(const rp_expression *e, size_t k);

/* "grains = 12, mu = nan": the names of an expression with their values, for messages. */
char *rp_expression_operands(rp_arena *arena, const rp_expression *e, const rp_x_values *values);

#endif
