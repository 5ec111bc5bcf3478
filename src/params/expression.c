/* Expressions: a parser by descent that writes postfix, folds what is known, and checks types; see
 * expression.h. */
#include "core/elementary.h"
#include "params/expression.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_STEPS = 200, MOST_WORD = 64, MOST_POWER = 64, MOST_NESTED = 50, MOST_ARGS = 4 };

typedef enum {
    X_NUMBER,
    X_NAME,
    X_NEGATIVE,
    X_NOT,
    X_ADD,
    X_TAKE,
    X_TIMES,
    X_OVER,
    X_POWER,
    X_LESS,
    X_LEAST,
    X_MORE,
    X_MOST,
    X_IS,
    X_IS_NOT,
    X_AND,
    X_OR,
    X_CHOICE,
    X_MIN,
    X_MAX,
    X_ABS,
    X_SQRT,
    X_FLOOR,
    X_ROUND,
    X_SIN,
    X_COS,
    X_TAN,
    X_ATAN,
    X_EXP,
    X_LOG,
    X_HELD,
    X_KNOWN,
    X_CHANGE
} x_kind;

/* A step takes its operands from a stack and leaves one number; `n` of a name: its arguments, of held and
 * change: its state. */
struct rp_x_step {
    x_kind kind;
    int id;
    size_t n, skip;  /* skip: so many steps ahead, past an `and` that is false or an `or` that is true */
    double number;   /* X_NUMBER; X_POWER: the exponent; X_HELD: how many looks */
    const char *key; /* X_NAME, X_KNOWN */
};

/* How a step stands in keys; operands it takes, a name aside. */
static const struct {
    const char *text;
    int takes;
} kinds[] = {
    [X_NUMBER] = {"", 0},      [X_NAME] = {"", 0},     [X_NEGATIVE] = {"neg", 1}, [X_NOT] = {"not", 1},
    [X_ADD] = {"+", 2},        [X_TAKE] = {"-", 2},    [X_TIMES] = {"*", 2},      [X_OVER] = {"/", 2},
    [X_POWER] = {"^", 1},      [X_LESS] = {"<", 2},    [X_LEAST] = {"<=", 2},     [X_MORE] = {">", 2},
    [X_MOST] = {">=", 2},      [X_IS] = {"==", 2},     [X_IS_NOT] = {"!=", 2},    [X_AND] = {"and", 2},
    [X_OR] = {"or", 2},        [X_CHOICE] = {"?", 3},  [X_MIN] = {"min", 2},      [X_MAX] = {"max", 2},
    [X_ABS] = {"abs", 1},      [X_SQRT] = {"sqrt", 1}, [X_FLOOR] = {"floor", 1},  [X_ROUND] = {"round", 1},
    [X_SIN] = {"sin", 1},      [X_COS] = {"cos", 1},   [X_TAN] = {"tan", 1},      [X_ATAN] = {"atan", 1},
    [X_EXP] = {"exp", 1},      [X_LOG] = {"log", 1},   [X_HELD] = {"held", 1},    [X_KNOWN] = {"known", 0},
    [X_CHANGE] = {"change", 1}};

/* ---- values ---- */

/* x^p of a multiple of 1/2: products, and a root. */
static double power(double x, double p)
{
    double product = 1.0;
    for (int k = 0; k < (int)fabs(p); k++) product *= x;
    if (fabs(p) != floor(fabs(p))) product *= sqrt(x);
    return p < 0.0 ? 1.0 / product : product;
}

/* One step of known operands a, b, c; of state where it has one. */
static double apply(const rp_x_step *s, double a, double b, double c, double states[])
{
    switch (s->kind) {
    case X_NUMBER: return s->number;
    case X_NEGATIVE: return -a;
    case X_NOT: return a == 0.0;
    case X_ADD: return a + b;
    case X_TAKE: return a - b;
    case X_TIMES: return a * b;
    case X_OVER: return a / b;
    case X_POWER: return power(a, s->number);
    case X_LESS: return a < b;
    case X_LEAST: return a <= b;
    case X_MORE: return a > b;
    case X_MOST: return a >= b;
    case X_IS: return a == b;
    case X_IS_NOT: return a != b;
    case X_AND: return a != 0.0 && b != 0.0;
    case X_OR: return a != 0.0 || b != 0.0;
    case X_CHOICE: return a != 0.0 ? b : c;
    case X_MIN: return isnan(a) || a < b ? a : b;
    case X_MAX: return isnan(a) || a > b ? a : b;
    case X_ABS: return fabs(a);
    case X_SQRT: return sqrt(a);
    case X_FLOOR: return floor(a);
    case X_ROUND: return a < 0.0 ? -floor(0.5 - a) : floor(a + 0.5);
    case X_SIN: return rp_sin(a);
    case X_COS: return rp_cos(a);
    case X_TAN: return rp_tan(a);
    case X_ATAN: return rp_atan(a);
    case X_EXP: return rp_exp(a);
    case X_LOG: return rp_log(a);
    case X_HELD: return (states[s->n] = a != 0.0 ? states[s->n] + 1.0 : 0.0) >= s->number;
    case X_CHANGE:
        b = states[s->n + 1] != 0.0 ? a - states[s->n] : 0.0; /* since the last sample, of the first 0 */
        states[s->n] = a, states[s->n + 1] = 1.0;
        return b;
    case X_NAME:
    case X_KNOWN: break;
    }
    return NAN;
}

double rp_expression_value(const rp_expression *e, const rp_x_values *values, double states[])
{
    double stack[MOST_STEPS + 3];
    size_t n = 0;
    for (size_t i = 0; i < e->n; i++) {
        const rp_x_step *s = &e->steps[i];
        if (s->kind == X_NAME || s->kind == X_KNOWN) {
            n -= s->n;
            const double value = values->load(values->host, s->id, stack + n);
            stack[n++] = s->kind == X_NAME ? value : !isnan(value);
        } else {
            const int takes = kinds[s->kind].takes;
            n -= (size_t)takes;
            stack[n] = apply(s, takes > 0 ? stack[n] : 0.0, takes > 1 ? stack[n + 1] : 0.0,
                             takes > 2 ? stack[n + 2] : 0.0, states);
            n++;
        }
        while (e->steps[i].skip && (stack[n - 1] != 0.0) == (e->steps[i + e->steps[i].skip].kind == X_OR))
            i += e->steps[i].skip;
    }
    return e->known ? e->value : stack[0];
}

/* ---- reading ---- */

typedef struct {
    const char *text, *at;
    const rp_x_names *names;
    rp_x_step steps[MOST_STEPS];
    size_t n, n_states, n_truths; /* truths: names of the host's that count their looks */
    int nested;
    char token[MOST_WORD];
    const char *begins; /* of the token */
    enum { T_END, T_NUMBER, T_NAME, T_WORD, T_SIGN } sort;
} x_reader;

/* What a part of the text is; its steps begin at `start`. */
typedef struct {
    rp_x_type type;
    size_t start;
    char word[MOST_WORD]; /* of a word, which is always known */
    const char *begins;
} x_part;

static const char *const types[] = {"a number", "a condition", "a word"};

static rp_status fail_at(const x_reader *r, const char *at, const char *format, const char *a, const char *b)
{
    rp_fail(RP_BAD_INPUT, format, a, b);
    return rp_prefix(RP_BAD_INPUT, "character %zu: ", (size_t)(at - r->text) + 1);
}

static rp_status next(x_reader *r)
{
    static const char *const pairs[] = {"<=", ">=", "==", "!="};
    while (isspace((unsigned char)*r->at)) r->at++;
    const char *end = r->begins = r->at;
    if (!*end) {
        r->sort = T_END;
    } else if (isdigit((unsigned char)*end) || *end == '.') {
        r->sort = T_NUMBER;
        while (isdigit((unsigned char)*end) || *end == '.') end++;
        if ((*end == 'e' || *end == 'E') && end[strspn(end + 1, "+-") + 1] >= '0' &&
            end[strspn(end + 1, "+-") + 1] <= '9') {
            end += 1 + (end[1] == '+' || end[1] == '-');
            while (isdigit((unsigned char)*end)) end++;
        }
    } else if (isalpha((unsigned char)*end) || *end == '_') {
        r->sort = T_NAME;
        while (isalnum((unsigned char)*end) || *end == '_' || *end == '.') end++;
    } else if (*end == '\'') {
        r->sort = T_WORD;
        end = strchr(end + 1, '\'');
        if (!end) return fail_at(r, r->begins, "a word without its end%s%s", "", "");
        end++;
    } else {
        r->sort = T_SIGN, end++;
        for (size_t k = 0; k < 4; k++)
            if (strncmp(r->begins, pairs[k], 2) == 0) end = r->begins + 2;
        if (!strchr("+-*/^()<>?:,=!", *r->begins) || (end == r->begins + 1 && strchr("=!", *r->begins)))
            return fail_at(r, r->begins, "\"%.1s\" is no sign of an expression%s", r->begins, "");
    }
    if (end - r->begins >= MOST_WORD) return fail_at(r, r->begins, "a name or number too long%s%s", "", "");
    snprintf(r->token, sizeof r->token, "%.*s", (int)(end - r->begins), r->begins);
    r->at = end;
    return RP_OK;
}

static bool is_sign(const x_reader *r, const char *sign)
{
    return (r->sort == T_SIGN || r->sort == T_NAME) && strcmp(r->token, sign) == 0;
}

static rp_status expect(x_reader *r, const char *sign)
{
    if (is_sign(r, sign)) return next(r);
    return fail_at(r, r->begins, "\"%s\" expected%s", sign, r->sort == T_END ? " at the end" : "");
}

static rp_status want(const x_reader *r, const x_part *part, rp_x_type type)
{
    if (part->type == type) return RP_OK;
    return fail_at(r, part->begins, "%s stands where %s is expected", types[part->type], types[type]);
}

static bool is_known(const x_reader *r, size_t start)
{
    for (size_t i = start; i < r->n; i++)
        if (r->steps[i].kind != X_NUMBER) return false;
    return true;
}

/* Add a step to a part; fold it where its operands are known. */
static rp_status add(x_reader *r, x_part *part, rp_x_step step)
{
    double v[3] = {0.0, 0.0, 0.0};
    const int takes = kinds[step.kind].takes;
    const bool pure =
        step.kind != X_NAME && step.kind != X_KNOWN && step.kind != X_HELD && step.kind != X_CHANGE;
    if (pure && takes > 0 && is_known(r, part->start)) {
        for (int k = 0; k < takes; k++) v[k] = r->steps[part->start + (size_t)k].number;
        step = (rp_x_step){.kind = X_NUMBER, .number = apply(&step, v[0], v[1], v[2], NULL)};
        r->n = part->start;
    }
    if (r->n == MOST_STEPS) return fail_at(r, part->begins, "an expression of too many parts%s%s", "", "");
    r->steps[r->n++] = step;
    return RP_OK;
}

static rp_status add_number(x_reader *r, x_part *part, rp_x_type type, double number)
{
    part->type = type;
    return add(r, part, (rp_x_step){.kind = X_NUMBER, .number = number});
}

static rp_status read_choice(x_reader *r, x_part *part);

/* A number that must be known: of held, and an exponent. */
static rp_status take_known(x_reader *r, const x_part *part, const char *what, double *number)
{
    RP_TRY(want(r, part, RP_X_NUMBER));
    if (!is_known(r, part->start))
        return fail_at(r, part->begins, "%s must be known before the run%s", what, "");
    *number = r->steps[--r->n].number;
    return RP_OK;
}

static const struct {
    const char *name;
    x_kind kind;
    int least, most; /* arguments */
    bool measure;
} functions[] = {
    {"min", X_MIN, 2, 9, false},   {"max", X_MAX, 2, 9, false},     {"abs", X_ABS, 1, 1, false},
    {"sqrt", X_SQRT, 1, 1, false}, {"floor", X_FLOOR, 1, 1, false}, {"round", X_ROUND, 1, 1, false},
    {"sin", X_SIN, 1, 1, false},   {"cos", X_COS, 1, 1, false},     {"tan", X_TAN, 1, 1, false},
    {"atan", X_ATAN, 1, 1, true},  {"exp", X_EXP, 1, 1, true},      {"log", X_LOG, 1, 1, true},
    {"held", X_HELD, 2, 2, false}, {"known", X_KNOWN, 1, 1, false}, {"change", X_CHANGE, 1, 1, true}};

static rp_status fail_unknown(const x_reader *r, const char *at, const char *name, bool call)
{
    rp_guess guess = rp_guess_of(name);
    if (r->names->list) r->names->list(r->names->host, &guess);
    for (size_t k = 0; k < sizeof functions / sizeof *functions && call; k++)
        rp_guess_try(&guess, functions[k].name);
    return fail_at(r, at, "unknown name %s%s", name, rp_guess_text(&guess));
}

/* A name of the host, with its arguments on the stack. */
static rp_status take_name(x_reader *r, x_part *part, const char *name, int n_args, x_kind kind)
{
    static const struct {
        const char *name;
        double value;
    } constants[] = {
        {"pi", 3.14159265358979323846}, {"deg", 3.14159265358979323846 / 180.0}, {"inf", INFINITY}};
    rp_x_symbol symbol = {0};
    bool known = false;
    for (int k = 0; k < 3 && n_args < 0 && kind == X_NAME; k++)
        if (strcmp(name, constants[k].name) == 0) return add_number(r, part, RP_X_NUMBER, constants[k].value);
    RP_TRY(rp_prefix(r->names->find(r->names->host, name, n_args, &symbol, &known),
                     "character %zu: ", (size_t)(part->begins - r->text) + 1));
    if (!known) return fail_unknown(r, part->begins, name, n_args >= 0);
    part->type = symbol.type;
    r->n_truths += symbol.type == RP_X_TRUTH && !symbol.known;
    if (symbol.type == RP_X_WORD) return snprintf(part->word, sizeof part->word, "%s", symbol.word), RP_OK;
    if (symbol.known) return add_number(r, part, symbol.type, symbol.value);
    return add(
        r, part,
        (rp_x_step){.kind = kind, .id = symbol.id, .n = n_args > 0 ? (size_t)n_args : 0, .key = symbol.key});
}

/* A call of the host's: of known numbers, or a name with arguments. */
static rp_status take_call(x_reader *r, x_part *part, const char *name, int n)
{
    double args[MOST_ARGS] = {0.0}, value;
    bool known = false;
    if (r->names->call && n <= MOST_ARGS && is_known(r, part->start)) {
        for (int k = 0; k < n; k++) args[k] = r->steps[part->start + (size_t)k].number;
        RP_TRY(rp_prefix(r->names->call(r->names->host, name, n, args, &value, &known),
                         "character %zu: ", (size_t)(part->begins - r->text) + 1));
        if (known) r->n = part->start;
        if (known) return add_number(r, part, RP_X_NUMBER, value);
    }
    return take_name(r, part, name, n, X_NAME);
}

/* After the opening bracket of a call. */
static rp_status read_call(x_reader *r, x_part *part, const char *name)
{
    size_t f = 0;
    const size_t n_functions = sizeof functions / sizeof *functions;
    while (f < n_functions && strcmp(functions[f].name, name) != 0) f++;
    const bool own = f < n_functions;
    if (own && functions[f].measure && !r->names->measure)
        return fail_at(r, part->begins, "%s: only in measure%s", name, "");
    if (own && functions[f].kind == X_KNOWN) {
        if (r->sort != T_NAME)
            return fail_at(r, r->begins, "known: the name of a measure expected%s%s", "", "");
        char measure[MOST_WORD];
        memcpy(measure, r->token, sizeof measure);
        part->begins = r->begins;
        RP_TRY(next(r));
        RP_TRY(take_name(r, part, measure, -1, X_KNOWN));
        part->type = RP_X_TRUTH;
        return expect(r, ")");
    }
    int n = 0;
    for (x_part arg; !is_sign(r, ")"); n++) {
        if (n > 0) RP_TRY(expect(r, ","));
        RP_TRY(read_choice(r, &arg));
        if (own && n == (functions[f].kind == X_HELD)) RP_TRY(want(r, &arg, RP_X_NUMBER));
        if (own && n > 0 && (functions[f].kind == X_MIN || functions[f].kind == X_MAX)) {
            RP_TRY(want(r, &arg, RP_X_NUMBER));
            RP_TRY(add(r, part, (rp_x_step){.kind = functions[f].kind}));
        }
        if (own && functions[f].kind == X_HELD) {
            double looks;
            if (n == 0) RP_TRY(want(r, &arg, RP_X_TRUTH));
            if (n == 1) {
                RP_TRY(take_known(r, &arg, "the second number of held", &looks));
                if (!(looks >= 1.0))
                    return fail_at(r, arg.begins, "held: at least one look expected%s%s", "", "");
                RP_TRY(add(r, part, (rp_x_step){.kind = X_HELD, .n = r->n_states++, .number = ceil(looks)}));
            }
        }
        if (!own) RP_TRY(want(r, &arg, RP_X_NUMBER));
    }
    RP_TRY(expect(r, ")"));
    if (!own) return take_call(r, part, name, n);
    if (n < functions[f].least || n > functions[f].most)
        return fail_at(r, part->begins, "%s: another number of arguments expected%s", name, "");
    part->type = functions[f].kind == X_HELD ? RP_X_TRUTH : RP_X_NUMBER;
    if (functions[f].most > 1) return RP_OK;
    if (functions[f].kind == X_CHANGE) r->n_states += 2;
    return add(r, part, (rp_x_step){.kind = functions[f].kind, .n = r->n_states - 2});
}

static rp_status read_atom(x_reader *r, x_part *part)
{
    char name[MOST_WORD];
    *part = (x_part){.start = r->n, .begins = r->begins};
    memcpy(name, r->token, sizeof name);
    if (r->sort == T_NUMBER) {
        char *end;
        const double number = strtod(name, &end);
        if (*end) return fail_at(r, r->begins, "\"%s\" is no number%s", name, "");
        RP_TRY(next(r));
        return add_number(r, part, RP_X_NUMBER, number);
    }
    if (r->sort == T_WORD) {
        snprintf(part->word, sizeof part->word, "%.*s", (int)strlen(name) - 2, name + 1);
        part->type = RP_X_WORD;
        return next(r);
    }
    if (r->sort == T_NAME && strcmp(name, "and") != 0 && strcmp(name, "or") != 0) {
        RP_TRY(next(r));
        if (strcmp(name, "true") == 0 || strcmp(name, "false") == 0)
            return add_number(r, part, RP_X_TRUTH, *name == 't');
        if (!is_sign(r, "(")) return take_name(r, part, name, -1, X_NAME);
        RP_TRY(next(r));
        return read_call(r, part, name);
    }
    if (is_sign(r, "(")) {
        RP_TRY(next(r));
        RP_TRY(read_choice(r, part));
        return expect(r, ")");
    }
    return fail_at(r, r->begins,
                   r->sort == T_END ? "ends too early%s%s" : "\"%s\" stands where a value is expected%s",
                   r->sort == T_END ? "" : name, "");
}

static rp_status read_signed(x_reader *r, x_part *part)
{
    if (is_sign(r, "-")) {
        const char *begins = r->begins;
        if (++r->nested > MOST_NESTED) return fail_at(r, begins, "too deep%s%s", "", "");
        RP_TRY(next(r));
        RP_TRY(read_signed(r, part));
        r->nested--, part->begins = begins;
        RP_TRY(want(r, part, RP_X_NUMBER));
        return add(r, part, (rp_x_step){.kind = X_NEGATIVE});
    }
    RP_TRY(read_atom(r, part));
    if (!is_sign(r, "^")) return RP_OK;
    x_part exponent;
    double p;
    RP_TRY(want(r, part, RP_X_NUMBER));
    RP_TRY(next(r));
    RP_TRY(read_signed(r, &exponent));
    RP_TRY(take_known(r, &exponent, "an exponent", &p));
    if (!(fabs(p) <= MOST_POWER) || 2.0 * p != floor(2.0 * p))
        return fail_at(r, exponent.begins, "an exponent must be a multiple of 0.5 from -64 to 64%s%s", "",
                       "");
    return add(r, part, (rp_x_step){.kind = X_POWER, .number = p});
}

/* Operators of one priority, from left to right: their signs, and the type that they take and give. */
typedef struct {
    const char *signs[2];
    x_kind kinds[2];
    rp_x_type type;
} x_level;
static const x_level levels[] = {{{"or", NULL}, {X_OR, X_OR}, RP_X_TRUTH},
                                 {{"and", NULL}, {X_AND, X_AND}, RP_X_TRUTH},
                                 {{"+", "-"}, {X_ADD, X_TAKE}, RP_X_NUMBER},
                                 {{"*", "/"}, {X_TIMES, X_OVER}, RP_X_NUMBER}};

static rp_status read_level(x_reader *r, int level, x_part *part);

static rp_status read_comparison(x_reader *r, x_part *part)
{
    static const char *const signs[] = {"<", "<=", ">", ">=", "==", "!="};
    if (is_sign(r, "not")) {
        const char *begins = r->begins;
        if (++r->nested > MOST_NESTED) return fail_at(r, begins, "too deep%s%s", "", "");
        RP_TRY(next(r));
        RP_TRY(read_comparison(r, part));
        r->nested--, part->begins = begins;
        RP_TRY(want(r, part, RP_X_TRUTH));
        return add(r, part, (rp_x_step){.kind = X_NOT});
    }
    RP_TRY(read_level(r, 2, part));
    for (int k = 0; k < 6; k++) {
        if (!is_sign(r, signs[k])) continue;
        x_part right;
        RP_TRY(next(r));
        RP_TRY(read_level(r, 2, &right));
        if (part->type == RP_X_WORD && k >= 4) {
            RP_TRY(want(r, &right, RP_X_WORD));
            return add_number(r, part, RP_X_TRUTH, (strcmp(part->word, right.word) == 0) == (k == 4));
        }
        RP_TRY(want(r, part, k < 4 || part->type == RP_X_WORD ? RP_X_NUMBER : part->type));
        RP_TRY(want(r, &right, part->type));
        part->type = RP_X_TRUTH;
        return add(r, part, (rp_x_step){.kind = (x_kind)(X_LESS + k)});
    }
    return RP_OK;
}

static rp_status read_level(x_reader *r, int level, x_part *part)
{
    if (level == 4) return read_signed(r, part);
    const x_level *l = &levels[level];
    RP_TRY(level == 1 ? read_comparison(r, part) : read_level(r, level + 1, part));
    for (;;) {
        const int k = is_sign(r, l->signs[0]) ? 0 : l->signs[1] && is_sign(r, l->signs[1]) ? 1 : -1;
        x_part right;
        if (k < 0) return RP_OK;
        const size_t last = r->n - 1, looks = r->n_states + r->n_truths;
        RP_TRY(want(r, part, l->type));
        RP_TRY(next(r));
        RP_TRY(level == 1 ? read_comparison(r, &right) : read_level(r, level + 1, &right));
        RP_TRY(want(r, &right, l->type));
        RP_TRY(add(r, part, (rp_x_step){.kind = l->kinds[k]}));
        if (level < 2 && r->n - 1 > last && r->n_states + r->n_truths == looks)
            r->steps[last].skip = r->n - 1 - last;
    }
}

static rp_status read_choice(x_reader *r, x_part *part)
{
    if (++r->nested > MOST_NESTED) return fail_at(r, r->begins, "too deep%s%s", "", "");
    RP_TRY(read_level(r, 0, part));
    if (is_sign(r, "?")) {
        x_part yes, no;
        const bool known = is_known(r, part->start), first = known && r->steps[r->n - 1].number != 0.0;
        RP_TRY(want(r, part, RP_X_TRUTH));
        RP_TRY(next(r));
        RP_TRY(read_choice(r, &yes));
        RP_TRY(expect(r, ":"));
        RP_TRY(read_choice(r, &no));
        RP_TRY(want(r, &no, yes.type));
        if (yes.type == RP_X_WORD && !known)
            return fail_at(r, part->begins, "what chooses a word must be known before the run%s%s", "", "");
        part->type = yes.type;
        memcpy(part->word, first ? yes.word : no.word, sizeof part->word);
        if (known) { /* only what is chosen stays */
            const size_t from = first ? yes.start : no.start, n = (first ? no.start : r->n) - from;
            memmove(&r->steps[part->start], &r->steps[from], n * sizeof *r->steps);
            r->n = part->start + n;
        } else {
            RP_TRY(add(r, part, (rp_x_step){.kind = X_CHOICE}));
        }
    }
    r->nested--;
    return RP_OK;
}

rp_status rp_expression_read(rp_arena *arena, const char *text, const rp_x_names *names, rp_expression *e)
{
    x_reader r = {.text = text, .at = text, .names = names};
    x_part whole;
    RP_TRY(next(&r));
    RP_TRY(read_choice(&r, &whole));
    if (r.sort != T_END)
        return fail_at(&r, r.begins, "\"%s\" stands where the end is expected%s", r.token, "");
    *e = (rp_expression){.type = whole.type, .text = text, .n = r.n, .n_states = r.n_states};
    e->known = is_known(&r, 0);
    if (e->known && r.n > 0) e->value = r.steps[0].number;
    if (whole.type == RP_X_WORD) {
        e->word = rp_text(arena, "%s", whole.word);
        return e->word ? RP_OK : RP_NO_MEMORY;
    }
    RP_NEW(arena, e->steps, r.n);
    memcpy(e->steps, r.steps, r.n * sizeof *r.steps);
    return RP_OK;
}

rp_status rp_expression_read_as(rp_arena *arena, const char *text, rp_x_type type, const rp_x_names *names,
                                rp_expression *e)
{
    RP_TRY(rp_expression_read(arena, text, names, e));
    if (e->type == type) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "is %s, %s is expected", types[e->type], types[type]);
}

/* ---- what is in it ---- */

void rp_expression_each(const rp_expression *e, void (*each)(void *host, int id), void *host)
{
    for (size_t i = 0; i < e->n; i++)
        if (e->steps[i].kind == X_NAME || e->steps[i].kind == X_KNOWN) each(host, e->steps[i].id);
}

char *rp_expression_key(rp_arena *arena, const rp_expression *e)
{
    char number[32], *key = rp_text(arena, "%s", e->type == RP_X_WORD ? e->word : "");
    for (size_t i = 0; i < e->n && key; i++) {
        const rp_x_step *s = &e->steps[i];
        const bool named = s->kind == X_NAME || s->kind == X_KNOWN,
                   numbered = s->kind == X_NUMBER || s->kind == X_POWER || s->kind == X_HELD;
        key = rp_text(arena, "%s%s%s%s%s", key, i ? " " : "",
                      numbered ? rp_number_text(s->number, 6, number, sizeof number) : "",
                      named ? s->key : "", kinds[s->kind].text);
    }
    return key;
}

char *rp_expression_operands(rp_arena *arena, const rp_expression *e, const rp_x_values *values)
{
    char *text = rp_text(arena, "%s", "");
    for (size_t i = 0; i < e->n && text; i++)
        if (e->steps[i].kind == X_NAME && e->steps[i].n == 0)
            text = rp_text(arena, "%s%s%s = %g", text, *text ? ", " : "", e->steps[i].key,
                           values->load(values->host, e->steps[i].id, NULL));
    return text;
}
