/* The parameter schema: one table says for each parameter its name, unit, type, default, range and meaning.
 * Parsing, validation, --help, `repose params` and provenance all read that table. */
#ifndef RP_PARAMS_H
#define RP_PARAMS_H

#include <stdbool.h>
#include <stddef.h>
#include <xxhash.h>

#include "core/status.h"
#include "params/units.h"

RP_C_BEGIN

typedef enum {
    RP_REAL,   /* double */
    RP_INT,    /* long */
    RP_BOOL,   /* bool */
    RP_CHOICE, /* int: index into the words of `range` */
    RP_TEXT,   /* const char *, borrowed from the caller; any text */
    RP_TEXTS   /* rp_texts: an option that may be given several times */
} rp_type;

typedef struct {
    size_t n;
    const char *items[32]; /* borrowed */
} rp_texts;

/* One parameter. `range` reads "[lo, hi]" with ( ) for open ends, for numbers; words after "|" are further
 * spellings ("[0, inf) | infinite | auto"). For RP_REAL "auto" stands for -1 and any other word for infinity;
 * for RP_INT one word is allowed, and stands for -1. For RP_CHOICE it lists the words: "ends | absorbs".
 * `fallback` is the default as a user would write it, in cgs; NULL makes the parameter required. */
typedef struct {
    const char *name;
    const char *unit; /* in cgs; "" where there is none */
    rp_type type;
    size_t offset; /* of the field in the structure that holds the values */
    const char *fallback;
    const char *range;
    const char *meaning;
    bool inherited; /* from a list that many schemas share: in a key only where it differs from the default */
    const char *const *manual; /* RP_CHOICE: what each word stands for; NULL: its meaning says it */
} rp_param;

/* A schema ends with an entry whose name is NULL. */

/* A value as found in a file or on the command line, before it is checked against its parameter. */
typedef struct {
    enum { RP_V_INT, RP_V_REAL, RP_V_BOOL, RP_V_TEXT } kind;
    long i; /* RP_V_INT, RP_V_BOOL */
    double r;
    const char *s;
} rp_value;

/* Entry called `name`, or NULL. */
const rp_param *rp_params_find(const rp_param *schema, const char *name);

/* Write every default, in a system of units; parameters without one become zero. */
void rp_params_default(const rp_param *param, rp_units units, void *values);
void rp_params_defaults(const rp_param *schema, rp_units units, void *values);

/* Is it a range of numbers, from the lower end to the upper, as "[0, 1)" or "(0, inf) | infinite"? */
bool rp_range_is_whole(const char *text);

/* Check `value` against `param` and store it. Errors, with the label of these units: RP_BAD_INPUT for a wrong
 * type, a number out of range or not finite, an unknown word. */
rp_status rp_params_set(const rp_param *param, rp_units units, void *values, const rp_value *value);

/* The same check for a text from the command line. Errors: RP_BAD_INPUT. */
rp_status rp_params_set_text(const rp_param *param, rp_units units, void *values, const char *text);

/* The shortest decimal form of at least `digits` significant digits that reads back to the same bits, or
 * "nan". Numbers of up to `digits` digits before the point have no exponent. At most 24 bytes; returns
 * `buffer`. */
const char *rp_number_text(double v, int digits, char *buffer, size_t size);

/* The same of at least 15 digits; it lives as long as the block. */
#define RP_SHORT(number) rp_number_text(number, 15, (char[32]){0}, 32)

/* Three digits of an upper bound, rounded down: what reads them stays below it. Returns `buffer`. */
const char *rp_text_below(double bound, char buffer[32]);

/* Word number `index` of a list separated by "|" and blanks; empty past the end. Returns `buffer`. */
const char *rp_word_at(const char *list, int index, char *buffer, size_t size);

/* Number of a word in such a list, or -1. */
int rp_word_index(const char *list, const char *word);

/* The value of one parameter as text that rp_params_set_text reads back exactly; returns `buffer`. */
const char *rp_params_text(const rp_param *param, const void *values, char *buffer, size_t size);

/* XXH3-128 of "name=value" of one parameter; 0 for an inherited one that has its default. */
XXH128_hash_t rp_params_hash_one(const rp_param *param, const void *values);

/* Sum of two hashes: that of a set of parameters is the sum over them, in any order. */
XXH128_hash_t rp_hash_add(XXH128_hash_t a, XXH128_hash_t b);

/* 32 hexadecimal digits and NUL. */
void rp_hash_digits(XXH128_hash_t hash, char digits[33]);

RP_C_END

#endif
