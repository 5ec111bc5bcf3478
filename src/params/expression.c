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

/* Steps, a row each: name, how it stands in texts and keys, operands on the stack, value of the step s with
 * the operands a, b, c. Of an operator between two parts also its priority, the lowest first, and what it
 * takes; of a function its least and most arguments, and whether it is for measures alone. A truth is 0, 1,
 * or NAN where a comparison had one and the rest does not decide. */
/* clang-format off */
#define X_OPERATORS(X) \
    X(OR, "or", 2, a > 0.0 || b > 0.0 ? 1.0 : a + b, 1, RP_X_TRUTH) \
    X(AND, "and", 2, a == 0.0 || b == 0.0 ? 0.0 : a * b, 2, RP_X_TRUTH) \
    X(LESS, "<", 2, isunordered(a, b) ? NAN : a < b, 3, RP_X_NUMBER) \
    X(LEAST, "<=", 2, isunordered(a, b) ? NAN : a <= b, 3, RP_X_NUMBER) \
    X(MORE, ">", 2, isunordered(a, b) ? NAN : a > b, 3, RP_X_NUMBER) \
    X(MOST, ">=", 2, isunordered(a, b) ? NAN : a >= b, 3, RP_X_NUMBER) \
    X(IS, "==", 2, isunordered(a, b) ? NAN : a == b, 3, RP_X_NUMBER) \
    X(IS_NOT, "!=", 2, isunordered(a, b) ? NAN : a != b, 3, RP_X_NUMBER) \
    X(ADD, "+", 2, a + b, 4, RP_X_NUMBER) \
    X(TAKE, "-", 2, a - b, 4, RP_X_NUMBER) \
    X(TIMES, "*", 2, a * b, 5, RP_X_NUMBER) \
    X(OVER, "/", 2, a / b, 5, RP_X_NUMBER)
#define X_FUNCTIONS(X) \
    X(MIN, "min", 2, isnan(a) || a < b ? a : b, 2, 9, false) \
    X(MAX, "max", 2, isnan(a) || a > b ? a : b, 2, 9, false) \
    X(ABS, "abs", 1, fabs(a), 1, 1, false) \
    X(SQRT, "sqrt", 1, sqrt(a), 1, 1, false) \
    X(FLOOR, "floor", 1, floor(a), 1, 1, false) \
    X(ROUND, "round", 1, a < 0.0 ? -floor(0.5 - a) : floor(a + 0.5), 1, 1, false) \
    X(SIN, "sin", 1, rp_sin(a), 1, 1, false) \
    X(COS, "cos", 1, rp_cos(a), 1, 1, false) \
    X(TAN, "tan", 1, rp_tan(a), 1, 1, false) \
    X(ATAN, "atan", 1, rp_atan(a), 1, 1, true) \
    X(EXP, "exp", 1, rp_exp(a), 1, 1, true) \
    X(LOG, "log", 1, rp_log(a), 1, 1, true) \
    X(HELD, "held", 1, isnan(a) ? a : held(a != 0.0, &states[s->n]) >= s->number, 2, 2, false) \
    X(KNOWN, "known", 0, NAN, 1, 1, false) \
    X(CHANGE, "change", 1, change(a, &states[s->n]), 1, 1, true)
#define X_OTHERS(X) \
    X(NUMBER, "", 0, s->number, 0) \
    X(NAME, "", 0, NAN, 0) \
    X(NEGATIVE, "neg", 1, -a, 0) \
    X(NOT, "not", 1, isnan(a) ? a : a == 0.0, 0) \
    X(POWER, "^", 1, power(a, s->number), 0) \
    X(CHOICE, "?", 3, isnan(a) ? a : a != 0.0 ? b : c, 0)
/* clang-format on */
#define X_WORD(id, word, ...) word " "
const char rp_expression_functions[] = "pi deg inf dt d m g; " X_FUNCTIONS(
    X_WORD) "dt_limit; held(c, n): whether c was true at n successive checks; known(M): "
            "whether measure M has a value; change(e): change of e since the last sample; change, atan, exp "
            "and log only in measures; dt_limit(v): the largest time step for impacts at speed v, only in "
            "`dt`";
#define X_ID(id, ...) X_##id,
typedef enum { X_OPERATORS(X_ID) X_FUNCTIONS(X_ID) X_OTHERS(X_ID) } x_kind;
enum { HIGHEST = 5, COMPARISON = 3 }; /* priorities */

/* A step takes its operands from a stack and leaves one number; `n` of a name: its arguments, of held and
 * change: its state. */
struct rp_x_step {
    x_kind kind;
    int id;
    size_t n, skip;  /* skip: so many steps ahead, past an `and` that is false or an `or` that is true */
    double number;   /* X_NUMBER; X_POWER: the exponent; X_HELD: how many looks */
    const char *key; /* X_NAME, X_KNOWN */
};

static const struct {
    const char *text;
    int takes, priority;
    rp_x_type of;
    int least, most;
    bool measure;
} kinds[] = {
#define X(id, text, takes, value, ...) [X_##id] = {text, takes, __VA_ARGS__},
    X_OPERATORS(X)
#undef X
#define X(id, text, takes, value, ...) [X_##id] = {text, takes, 0, RP_X_NUMBER, __VA_ARGS__},
        X_FUNCTIONS(X)
#undef X
#define X(id, text, takes, value, priority) [X_##id] = {text, takes, priority},
            X_OTHERS(X)
#undef X
};

/* ---- values ---- */

/* x^p of a multiple of 1/2 by products, and a root. */
static double power(double x, double p)
{
    if (2.0 * p != floor(2.0 * p)) return rp_pow(x, p);
    double product = 1.0;
    for (int k = 0; k < (int)fabs(p); k++) product *= x;
    if (fabs(p) != floor(fabs(p))) product *= sqrt(x);
    return p < 0.0 ? 1.0 / product : product;
}

/* Looks so far at which a condition has held. */
static double held(bool holds, double *state)
{
    return *state = holds ? *state + 1.0 : 0.0;
}

/* Since the last sample; of the first none, which its state tells. */
static double change(double a, double state[2])
{
    const double by = state[1] != 0.0 ? a - state[0] : NAN;
    state[0] = a, state[1] = state[1] != 0.0 ? 1.0 : -INFINITY;
    return by;
}

/* One step of known operands a, b, c; of state where it has one. */
static double apply(const rp_x_step *s, double a, double b, double c, double states[])
{
    switch (s->kind) {
#define X(id, text, takes, value, ...)                                                                       \
    case X_##id: return value;
        X_OPERATORS(X)
        X_FUNCTIONS(X)
        X_OTHERS(X)
#undef X
    }
    return NAN;
}

double rp_expression_value(const rp_expression *e, const rp_x_values *values, double states[])
{
    double stack[MOST_STEPS + 3];
    size_t n = 0;
    stack[0] = NAN; /* of an expression that a text does not give */
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
        while (e->steps[i].skip && stack[n - 1] == (e->steps[i + e->steps[i].skip].kind == X_OR ? 1.0 : 0.0))
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

const char *const rp_x_types[] = {"a number", "a condition", "a word"};

/* A failure, and one that another function has reported, with the character of the text. */
#define fail_at(r, at, ...)  place(r, at, rp_fail(RP_BAD_INPUT, __VA_ARGS__))
#define place(r, at, status) rp_prefix(status, "character %zu: ", (size_t)((at) - (r)->text) + 1)

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
        if (!end) return fail_at(r, r->begins, "a word without its end");
        end++;
    } else {
        r->sort = T_SIGN, end++;
        for (size_t k = 0; k < 4; k++)
            if (strncmp(r->begins, pairs[k], 2) == 0) end = r->begins + 2;
        if (!strchr("+-*/^()<>?:,=!", *r->begins) ||
            (end == r->begins + 1 && strchr(r->names->cell ? "!" : "=!", *r->begins)))
            return fail_at(r, r->begins, "\"%.1s\" is no sign of an expression", r->begins);
    }
    if (end - r->begins >= MOST_WORD) return fail_at(r, r->begins, "a name or number too long");
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
    return fail_at(r, part->begins, "%s stands where %s is expected", rp_x_types[part->type],
                   rp_x_types[type]);
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
    double v[3] = {0};
    const int takes = kinds[step.kind].takes;
    const bool pure =
        step.kind != X_NAME && step.kind != X_KNOWN && step.kind != X_HELD && step.kind != X_CHANGE;
    if (pure && takes > 0 && is_known(r, part->start)) {
        for (int k = 0; k < takes; k++) v[k] = r->steps[part->start + (size_t)k].number;
        step = (rp_x_step){.kind = X_NUMBER, .number = apply(&step, v[0], v[1], v[2], NULL)};
        r->n = part->start;
    }
    if (r->n == MOST_STEPS) return fail_at(r, part->begins, "an expression of too many parts");
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
    *number = r->steps[r->n - 1].number;
    if (!is_known(r, part->start)) return fail_at(r, part->begins, "%s must be known before the run", what);
    return r->n--, RP_OK;
}

static rp_status fail_unknown(const x_reader *r, const char *at, const char *name, bool call)
{
    rp_guess guess = rp_guess_of(name);
    if (r->names->list) r->names->list(r->names->host, &guess);
    for (x_kind k = X_MIN; k <= X_CHANGE && call; k++) rp_guess_try(&guess, kinds[k].text);
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
    if (r->names->find)
        RP_TRY(place(r, part->begins, r->names->find(r->names->host, name, n_args, &symbol, &known)));
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
        RP_TRY(place(r, part->begins, r->names->call(r->names->host, name, n, args, &value, &known)));
        if (known) r->n = part->start;
        if (known) return add_number(r, part, RP_X_NUMBER, value);
    }
    return take_name(r, part, name, n, X_NAME);
}

/* The name of a measure, after known( */
static rp_status read_known(x_reader *r, x_part *part)
{
    char measure[MOST_WORD];
    if (r->sort != T_NAME) return fail_at(r, r->begins, "known: the name of a measure expected");
    memcpy(measure, r->token, sizeof measure);
    part->begins = r->begins;
    RP_TRY(next(r));
    RP_TRY(take_name(r, part, measure, -1, X_KNOWN));
    part->type = RP_X_TRUTH;
    return expect(r, ")");
}

/* How many looks, after the condition of held. */
static rp_status take_held(x_reader *r, x_part *part, const x_part *arg)
{
    double looks;
    RP_TRY(take_known(r, arg, "the second number of held", &looks));
    if (!(looks >= 1.0)) return fail_at(r, arg->begins, "held: at least one look expected");
    part->type = RP_X_TRUTH;
    return add(r, part, (rp_x_step){.kind = X_HELD, .n = r->n_states++, .number = ceil(looks)});
}

/* After the opening bracket of a call. */
static rp_status read_call(x_reader *r, x_part *part, const char *name)
{
    x_kind f = X_MIN;
    while (f <= X_CHANGE && strcmp(kinds[f].text, name) != 0) f++;
    const bool own = f <= X_CHANGE;
    if (own && kinds[f].measure && !r->names->measure)
        return fail_at(r, part->begins, "%s: only in measure", name);
    if (f == X_KNOWN) return read_known(r, part);
    x_part arg;
    int n = 0;
    for (; !is_sign(r, ")"); n++) {
        if (n > 0) RP_TRY(expect(r, ","));
        RP_TRY(read_choice(r, &arg));
        RP_TRY(want(r, &arg, f == X_HELD && n == 0 ? RP_X_TRUTH : RP_X_NUMBER));
        if (n > 0 && (f == X_MIN || f == X_MAX)) RP_TRY(add(r, part, (rp_x_step){.kind = f}));
    }
    RP_TRY(expect(r, ")"));
    if (!own) return take_call(r, part, name, n);
    if (n < kinds[f].least || n > kinds[f].most)
        return fail_at(r, part->begins, "%s: another number of arguments expected", name);
    if (f == X_HELD) return take_held(r, part, &arg);
    part->type = RP_X_NUMBER;
    if (kinds[f].most > 1) return RP_OK;
    if (f == X_CHANGE) r->n_states += 2;
    return add(r, part, (rp_x_step){.kind = f, .n = r->n_states - 2});
}

static rp_status read_atom(x_reader *r, x_part *part)
{
    char name[MOST_WORD];
    *part = (x_part){.start = r->n, .begins = r->begins};
    memcpy(name, r->token, sizeof name);
    if (r->sort == T_NUMBER) {
        char *end;
        const double number = strtod(name, &end);
        if (*end) return fail_at(r, r->begins, "\"%s\" is no number", name);
        RP_TRY(next(r));
        return add_number(r, part, RP_X_NUMBER, number);
    }
    if (r->sort == T_WORD) {
        snprintf(part->word, sizeof part->word, "%.*s", (int)strlen(name) - 2, name + 1);
        part->type = RP_X_WORD;
        RP_TRY(next(r));
        memcpy(name, part->word, sizeof name);
        return r->names->cell ? take_name(r, part, name, -1, X_NAME) : RP_OK;
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
    if (r->sort == T_END) return fail_at(r, r->begins, "ends too early");
    return fail_at(r, r->begins, "\"%s\" stands where a value is expected", name);
}

/* A sign before a part of this type, which `read` reads. */
static rp_status read_prefix(x_reader *r, x_part *part, x_kind kind, rp_x_type type,
                             rp_status (*read)(x_reader *r, x_part *part))
{
    const char *begins = r->begins;
    if (++r->nested > MOST_NESTED) return fail_at(r, begins, "too deep");
    RP_TRY(next(r));
    RP_TRY(read(r, part));
    r->nested--, part->begins = begins;
    RP_TRY(want(r, part, type));
    return add(r, part, (rp_x_step){.kind = kind});
}

static rp_status read_signed(x_reader *r, x_part *part)
{
    if (is_sign(r, "-")) return read_prefix(r, part, X_NEGATIVE, RP_X_NUMBER, read_signed);
    RP_TRY(read_atom(r, part));
    if (!is_sign(r, "^")) return RP_OK;
    x_part exponent;
    double p;
    RP_TRY(want(r, part, RP_X_NUMBER));
    RP_TRY(next(r));
    RP_TRY(read_signed(r, &exponent));
    RP_TRY(take_known(r, &exponent, "an exponent", &p));
    if (!(fabs(p) <= MOST_POWER)) return fail_at(r, exponent.begins, "an exponent goes from -64 to 64");
    return add(r, part, (rp_x_step){.kind = X_POWER, .number = p});
}

static rp_status read_level(x_reader *r, int priority, x_part *part);

static rp_status read_comparison(x_reader *r, x_part *part)
{
    return read_level(r, COMPARISON, part);
}

/* Is the part a column alone, before = or != ? */
static bool is_cell(const x_reader *r, const x_part *part)
{
    return r->names->cell && (is_sign(r, "=") || is_sign(r, "!=")) && r->n == part->start + 1 &&
           r->steps[part->start].kind == X_NAME;
}

/* The text that the cell of a column is compared with, after = or != */
static rp_status read_cell(x_reader *r, x_part *part)
{
    char text[MOST_WORD];
    const bool differs = is_sign(r, "!=");
    const char *cell = r->at + strspn(r->at, " ");
    const size_t quote = *cell == '\'', n = strcspn(cell + quote, quote ? "'" : " )");
    if (n == 0 || n >= sizeof text || (quote && cell[n + 1] != '\''))
        return fail_at(r, cell, "a value of 1 to %d letters expected", MOST_WORD - 1);
    snprintf(text, sizeof text, "%.*s", (int)n, cell + quote);
    rp_x_step *step = &r->steps[part->start];
    step->id = r->names->cell(r->names->host, step->id, text);
    if (step->id < 0) return fail_at(r, part->begins, "too many comparisons");
    part->type = RP_X_TRUTH;
    r->at = cell + n + 2 * quote;
    RP_TRY(next(r));
    return differs ? add(r, part, (rp_x_step){.kind = X_NOT}) : RP_OK;
}

/* Operators of one priority, from left to right; of comparisons one. */
static rp_status read_level(x_reader *r, int priority, x_part *part)
{
    if (priority > HIGHEST) return read_signed(r, part);
    if (priority == COMPARISON && is_sign(r, "not"))
        return read_prefix(r, part, X_NOT, RP_X_TRUTH, read_comparison);
    RP_TRY(read_level(r, priority + 1, part));
    if (priority == COMPARISON && is_cell(r, part)) return read_cell(r, part);
    for (;;) {
        x_kind op = X_OR;
        x_part right;
        while (op <= X_OVER && (kinds[op].priority != priority || !is_sign(r, kinds[op].text))) op++;
        if (op > X_OVER) return RP_OK;
        const size_t last = r->n - 1, looks = r->n_states + r->n_truths;
        const bool equal = op == X_IS || op == X_IS_NOT; /* of any type */
        RP_TRY(want(r, part, equal ? part->type : kinds[op].of));
        RP_TRY(next(r));
        RP_TRY(read_level(r, priority + 1, &right));
        RP_TRY(want(r, &right, part->type));
        if (part->type == RP_X_WORD)
            return add_number(r, part, RP_X_TRUTH, (strcmp(part->word, right.word) == 0) == (op == X_IS));
        RP_TRY(add(r, part, (rp_x_step){.kind = op}));
        if (priority < COMPARISON && r->n - 1 > last && r->n_states + r->n_truths == looks)
            r->steps[last].skip = r->n - 1 - last;
        if (priority == COMPARISON) return part->type = RP_X_TRUTH, RP_OK;
    }
}

static rp_status read_choice(x_reader *r, x_part *part)
{
    if (++r->nested > MOST_NESTED) return fail_at(r, r->begins, "too deep");
    RP_TRY(read_level(r, 1, part));
    if (is_sign(r, "?")) {
        x_part yes, no;
        const bool known = is_known(r, part->start), first = known && r->steps[r->n - 1].number != 0.0;
        RP_TRY(want(r, part, RP_X_TRUTH));
        RP_TRY(next(r));
        RP_TRY(read_choice(r, &yes));
        RP_TRY(expect(r, ":"));
        RP_TRY(read_choice(r, &no));
        RP_TRY(want(r, &no, yes.type));
        const bool neither = known && isnan(r->steps[part->start].number);
        if (yes.type == RP_X_WORD && (!known || neither))
            return fail_at(r, part->begins, "what chooses a word must be known before the run");
        part->type = yes.type;
        memcpy(part->word, first ? yes.word : no.word, sizeof part->word);
        if (neither) {
            r->n = part->start;
            return r->nested--, add_number(r, part, yes.type, NAN);
        } else if (known) { /* only what is chosen stays */
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
    if (r.sort != T_END) return fail_at(&r, r.begins, "\"%s\" stands where the end is expected", r.token);
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
    return rp_fail(RP_BAD_INPUT, "%s stands where %s is expected", rp_x_types[e->type], rp_x_types[type]);
}

/* ---- what is in it ---- */

int rp_expression_asks(const rp_expression *e, size_t k)
{
    for (size_t i = 0; i < e->n; i++)
        if ((e->steps[i].kind == X_NAME || e->steps[i].kind == X_KNOWN) && k-- == 0) return e->steps[i].id;
    return -1;
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
