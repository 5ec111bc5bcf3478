/* "did you mean": the candidate nearest to a misspelt word, of commands, options, keys, columns, choices. */
#ifndef RP_GUESS_H
#define RP_GUESS_H

#include <stddef.h>

#include "params/params.h"

/* The search for the nearest of the candidates that are tried one after the other; of equals, the first. */
typedef struct {
    const char *word;
    size_t cost;
    char nearest[64]; /* "" so far */
    char text[96];
} rp_guess;

rp_guess rp_guess_of(const char *word);
void rp_guess_try(rp_guess *guess, const char *candidate);

/* Tries every name of a schema, and every word of a list separated by "|" and blanks. */
void rp_guess_schema(rp_guess *guess, const rp_param *schema);
void rp_guess_words(rp_guess *guess, const char *list);

/* ` (did you mean "NEAREST"?)`, or "" where no candidate is near. */
const char *rp_guess_text(rp_guess *guess);

/* Edit distance: 2 for each letter that is added, left out or another, and for two neighbours exchanged; 1
 * for a letter in the other case, and for a dash instead of an underline. Words of more than 63 bytes have
 * the distance SIZE_MAX. (Optimal string alignment.) */
size_t rp_edit_distance(const char *a, const char *b);

#endif
