/* The nearest word; see guess.h. */
#include "params/guess.h"

#include <ctype.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { MOST = 63 };

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

static char plain(char c)
{
    return c == '-' ? '_' : (char)tolower((unsigned char)c);
}

static size_t cost_of(char a, char b)
{
    return a == b ? 0 : plain(a) == plain(b) ? 1 : 2;
}

size_t rp_edit_distance(const char *a, const char *b)
{
    const size_t n = strlen(a), m = strlen(b);
    size_t rows[3][MOST + 1], *before = rows[0], *last = rows[1], *now = rows[2];
    if (n > MOST || m > MOST) return SIZE_MAX;
    for (size_t j = 0; j <= m; j++) before[j] = last[j] = 2 * j;
    for (size_t i = 1; i <= n; i++) {
        now[0] = 2 * i;
        for (size_t j = 1; j <= m; j++) {
            now[j] = least(least(last[j], now[j - 1]) + 2, last[j - 1] + cost_of(a[i - 1], b[j - 1]));
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                now[j] = least(now[j], before[j - 2] + 2);
        }
        size_t *const free_row = before;
        before = last, last = now, now = free_row;
    }
    return last[m];
}

/* Of a letter only the case may be wrong, of two letters one, of a longer word a third. */
rp_guess rp_guess_of(const char *word)
{
    const size_t n = strlen(word);
    return (rp_guess){.word = word, .cost = n < 2 ? 2 : 2 * n / 3 + 2};
}

void rp_guess_try(rp_guess *guess, const char *candidate)
{
    const size_t n = strlen(guess->word);
    size_t cost = rp_edit_distance(guess->word, candidate);
    /* a beginning */
    if (n >= 2 && strncmp(guess->word, candidate, n) == 0) cost = least(cost, 2);
    if (cost >= guess->cost || strlen(candidate) >= sizeof guess->nearest) return;
    guess->cost = cost;
    strcpy(guess->nearest, candidate);
}

void rp_guess_schema(rp_guess *guess, const rp_param *schema)
{
    for (; schema->name; schema++) rp_guess_try(guess, schema->name);
}

void rp_guess_words(rp_guess *guess, const char *list)
{
    char word[64];
    for (list += strspn(list, " |"); *list; list += strspn(list, " |")) {
        const size_t n = strcspn(list, " |");
        snprintf(word, sizeof word, "%.*s", (int)n, list);
        if (n < sizeof word) rp_guess_try(guess, word);
        list += n;
    }
}

const char *rp_guess_text(rp_guess *guess)
{
    if (*guess->nearest) snprintf(guess->text, sizeof guess->text, " (did you mean \"%s\"?)", guess->nearest);
    return guess->text;
}
