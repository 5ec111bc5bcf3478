/* The parameter schema; see params.h. */
#define XXH_INLINE_ALL /* so that a program without sweeps needs no library for it */
#include "params/params.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "params/guess.h"

#define DECIMAL "+-.0123456789eE" /* characters of plain decimal numbers */

/* The parts of a numeric range: bounds, whether they are open, and the further spellings; whether it is
 * whole. */
typedef struct {
    double lo, hi;
    bool open_lo, open_hi, whole;
    const char *words; /* "| infinite | auto", or "" */
} numeric_range;

static numeric_range parse_range(const char *text)
{
    numeric_range r = {.lo = -INFINITY, .hi = INFINITY, .words = ""};
    char *end;
    if (!text || (*text != '[' && *text != '(')) return r;
    r.open_lo = *text == '(';
    r.lo = strtod(++text, &end);
    if (end == text || *end != ',') return r;
    text = end + 1;
    r.hi = strtod(text, &end);
    r.open_hi = *end == ')';
    if (end == text || (*end != ']' && *end != ')')) return r;
    r.words = end + 1 + strspn(end + 1, " ");
    r.whole = r.lo <= r.hi && (*r.words == '|' || !*r.words);
    return r;
}

bool rp_range_is_whole(const char *text)
{
    return parse_range(text).whole;
}

const char *rp_word_at(const char *list, int index, char *buffer, size_t size)
{
    for (int i = 0; list; i++) {
        list += strspn(list, " |");
        size_t n = strcspn(list, " |");
        if (n == 0) break;
        if (i == index) {
            snprintf(buffer, size, "%.*s", (int)n, list);
            return buffer;
        }
        list += n;
    }
    buffer[0] = '\0';
    return buffer;
}

int rp_word_index(const char *list, const char *word)
{
    char buffer[64];
    for (int i = 0; *rp_word_at(list, i, buffer, sizeof buffer); i++)
        if (strcmp(buffer, word) == 0) return i;
    return -1;
}

/* The spelling of -1 (auto) or infinity among the words of a numeric range; empty if there is none. */
static const char *spelling(const char *words, bool is_auto, char *buffer, size_t size)
{
    for (int i = 0; *rp_word_at(words, i, buffer, size); i++)
        if ((strcmp(buffer, "auto") == 0) == is_auto) break;
    return buffer;
}

static bool in_range(const numeric_range *r, double v)
{
    return (r->open_lo ? v > r->lo : v >= r->lo) && (r->open_hi ? v < r->hi : v <= r->hi);
}

const rp_param *rp_params_find(const rp_param *schema, const char *name)
{
    for (; schema->name; schema++)
        if (strcmp(schema->name, name) == 0) return schema;
    return NULL;
}

void rp_params_default(const rp_param *param, rp_units units, void *values)
{
    static const size_t sizes[] = {
        [RP_REAL] = sizeof(double), [RP_INT] = sizeof(long),    [RP_BOOL] = sizeof(bool),
        [RP_CHOICE] = sizeof(int),  [RP_TEXT] = sizeof(char *), [RP_TEXTS] = sizeof(rp_texts)};
    void *field = (char *)values + param->offset;
    memset(field, 0, sizes[param->type]);
    if (!param->fallback || param->type == RP_TEXTS) return;
    rp_params_set_text(param, units, values, param->fallback);
    if (param->type == RP_REAL && strspn(param->fallback, DECIMAL) == strlen(param->fallback))
        *(double *)field = rp_units_value(units, param->unit, *(double *)field);
}

void rp_params_defaults(const rp_param *schema, rp_units units, void *values)
{
    for (; schema->name; schema++) rp_params_default(schema, units, values);
}

static rp_status wrong_type(const rp_param *param, const rp_value *value, const char *wanted)
{
    char shown[64];
    switch (value->kind) {
    case RP_V_INT: snprintf(shown, sizeof shown, "%ld", value->i); break;
    case RP_V_REAL: snprintf(shown, sizeof shown, "%g", value->r); break;
    case RP_V_BOOL: snprintf(shown, sizeof shown, "%s", value->i ? "true" : "false"); break;
    case RP_V_TEXT: snprintf(shown, sizeof shown, "\"%.50s\"", value->s); break;
    }
    return rp_fail(RP_BAD_INPUT, "%s = %s: %s expected%s%s", param->name, shown, wanted,
                   param->range && *param->range ? ", allowed: " : "", param->range ? param->range : "");
}

static rp_status set_number(const rp_param *param, rp_units units, void *field, const rp_value *value)
{
    const numeric_range range = parse_range(param->range);
    const bool whole = param->type == RP_INT;
    double v = value->kind == RP_V_INT ? (double)value->i : value->r + 0.0; /* -0 is 0 */
    const bool integer =
        value->kind == RP_V_INT || (value->kind == RP_V_REAL && v == floor(v) && fabs(v) < 1e15);
    if (value->kind == RP_V_TEXT && rp_word_index(range.words, value->s) >= 0)
        v = whole || strcmp(value->s, "auto") == 0 ? -1.0 : INFINITY;
    else if (!integer && (whole || value->kind != RP_V_REAL))
        return wrong_type(param, value, whole ? "a whole number" : "a number");
    else if (!isfinite(v))
        return rp_fail(RP_BAD_INPUT, "%s = %g: a finite number expected", param->name, v);
    else if (!in_range(&range, v))
        return rp_fail(RP_BAD_INPUT, "%s = %.15g: out of range, allowed: %s%s%s", param->name, v,
                       param->range, *param->unit ? " " : "", rp_unit(units, param->unit));
    if (whole)
        *(long *)field = value->kind == RP_V_INT ? value->i : (long)v;
    else
        *(double *)field = v;
    return RP_OK;
}

static rp_status set_word(const rp_param *param, void *field, const rp_value *value)
{
    if (value->kind != RP_V_TEXT) return wrong_type(param, value, "a word");
    int index = rp_word_index(param->range, value->s);
    if (index < 0) {
        rp_guess guess = rp_guess_of(value->s);
        rp_guess_words(&guess, param->range);
        return rp_fail(RP_BAD_INPUT, "%s = \"%.60s\": unknown word, allowed: %s%s", param->name, value->s,
                       param->range, rp_guess_text(&guess));
    }
    *(int *)field = index;
    return RP_OK;
}

static rp_status add_text(const rp_param *param, rp_texts *texts, const rp_value *value)
{
    if (value->kind != RP_V_TEXT) return wrong_type(param, value, "text");
    if (texts->n == sizeof texts->items / sizeof *texts->items)
        return rp_fail(RP_BAD_INPUT, "%s: given too often", param->name);
    texts->items[texts->n++] = value->s;
    return RP_OK;
}

rp_status rp_params_set(const rp_param *param, rp_units units, void *values, const rp_value *value)
{
    void *field = (char *)values + param->offset;
    switch (param->type) {
    case RP_REAL:
    case RP_INT: return set_number(param, units, field, value);
    case RP_CHOICE: return set_word(param, field, value);
    case RP_TEXTS: return add_text(param, field, value);
    case RP_BOOL:
        if (value->kind != RP_V_BOOL) return wrong_type(param, value, "true or false");
        *(bool *)field = value->i != 0;
        return RP_OK;
    case RP_TEXT:
        if (value->kind != RP_V_TEXT) return wrong_type(param, value, "text");
        *(const char **)field = value->s;
        return RP_OK;
    }
    return rp_fail(RP_BROKEN, "%s: unknown type", param->name);
}

rp_status rp_params_set_text(const rp_param *param, rp_units units, void *values, const char *text)
{
    rp_value v = {.kind = RP_V_TEXT, .s = text};
    char *end;
    if (param->type == RP_BOOL && (strcmp(text, "true") == 0 || strcmp(text, "false") == 0))
        v = (rp_value){.kind = RP_V_BOOL, .i = *text == 't'};
    if (*text && (param->type == RP_INT || param->type == RP_REAL)) {
        errno = 0;
        const long i = strtol(text, &end, 10);
        if (!*end && errno == 0)
            return rp_params_set(param, units, values, &(rp_value){.kind = RP_V_INT, .i = i});
        const double r = strtod(text, &end);
        /* strtod also reads "inf" and hexadecimal: only plain decimal numbers are meant */
        if (!*end && strspn(text, DECIMAL) == strlen(text)) v = (rp_value){.kind = RP_V_REAL, .r = r};
    }
    return rp_params_set(param, units, values, &v);
}

const char *rp_text_below(double bound, char buffer[32])
{
    double v = bound;
    do {
        snprintf(buffer, 32, "%.3g", v);
        v *= 0.999;
    } while (strtod(buffer, NULL) > bound);
    return buffer;
}

const char *rp_number_text(double v, int digits, char *buffer, size_t size)
{
    if (isnan(v)) { /* printf writes "-nan" for some */
        snprintf(buffer, size, "nan");
        return buffer;
    }
    for (; digits <= 17; digits++) {
        snprintf(buffer, size, "%.*g", digits, v);
        if (strtod(buffer, NULL) == v) break;
    }
    return buffer;
}

const char *rp_params_text(const rp_param *param, const void *values, char *buffer, size_t size)
{
    const char *field = (const char *)values + param->offset;
    switch (param->type) {
    case RP_REAL: {
        double v = *(const double *)field;
        numeric_range range = parse_range(param->range);
        if (isinf(v) || (v == -1.0 && !in_range(&range, v)))
            spelling(range.words, !isinf(v), buffer, size);
        else
            rp_number_text(v, 6, buffer, size);
        break;
    }
    case RP_INT: {
        long v = *(const long *)field;
        numeric_range range = parse_range(param->range);
        if (v == -1 && *range.words)
            rp_word_at(range.words, 0, buffer, size);
        else
            snprintf(buffer, size, "%ld", v);
        break;
    }
    case RP_BOOL: snprintf(buffer, size, "%s", *(const bool *)field ? "true" : "false"); break;
    case RP_CHOICE: rp_word_at(param->range, *(const int *)field, buffer, size); break;
    case RP_TEXT: {
        const char *s = *(const char *const *)field;
        snprintf(buffer, size, "%s", s ? s : "");
        break;
    }
    case RP_TEXTS: buffer[0] = '\0'; break;
    }
    return buffer;
}

/* Whether `text` is the value that the default stands for. */
static bool is_default(const rp_param *param, const char *text)
{
    rp_param alone = *param;
    union {
        double real;
        long whole;
        bool yes;
        int word;
    } value;
    char shown[256];
    alone.offset = 0;
    return param->fallback && !rp_params_set_text(&alone, RP_CGS, &value, param->fallback) &&
           strcmp(rp_params_text(&alone, &value, shown, sizeof shown), text) == 0;
}

XXH128_hash_t rp_params_hash_one(const rp_param *param, const void *values)
{
    char text[256], line[384];
    rp_params_text(param, values, text, sizeof text);
    if (param->inherited && is_default(param, text)) return (XXH128_hash_t){0, 0};
    const int n = snprintf(line, sizeof line, "%s=%s", param->name, text);
    return XXH3_128bits(line, (size_t)n);
}

XXH128_hash_t rp_hash_add(XXH128_hash_t a, XXH128_hash_t b)
{
    const XXH64_hash_t low = a.low64 + b.low64;
    return (XXH128_hash_t){low, a.high64 + b.high64 + (low < a.low64)};
}

void rp_hash_digits(XXH128_hash_t hash, char digits[33])
{
    const uint64_t halves[] = {hash.high64, hash.low64};
    for (int i = 0; i < 32; i++) digits[i] = "0123456789abcdef"[halves[i / 16] >> (60 - 4 * (i % 16)) & 15];
    digits[32] = '\0';
}
