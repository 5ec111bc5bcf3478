/* Expressions of texts: values, types, messages, keys, and random ones against the trees they are of. */
#include "grains.h"
#include "params/expression.h"

enum { GRAINS, REST, MOVED, THETA, SPEED };
static double at[5]; /* what the observables are now */

static rp_status find(void *host, const char *name, int n_args, rp_x_symbol *symbol, bool *known)
{
    static const rp_x_symbol symbols[] = {{RP_X_NUMBER, true, 4.0, NULL, NULL, 0},
                                          {RP_X_NUMBER, true, 0.2, NULL, NULL, 0},
                                          {RP_X_WORD, true, 0.0, "ends", NULL, 0},
                                          {RP_X_NUMBER, false, 0.0, NULL, "grains", GRAINS},
                                          {RP_X_TRUTH, false, 0.0, NULL, "rest", REST},
                                          {RP_X_NUMBER, false, 0.0, NULL, "moved", MOVED},
                                          {RP_X_NUMBER, false, 0.0, NULL, "theta", THETA},
                                          {RP_X_NUMBER, false, 0.0, NULL, "pile.speed", SPEED}};
    static const char *const names[] = {"W", "mu", "floor", "grains", "rest", "moved", "theta", "pile.speed"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        if (strcmp(names[k], name) == 0 && n_args == (symbols[k].id == MOVED ? 2 : -1))
            *symbol = symbols[k], *known = true;
    if (strcmp(name, "late") == 0) return rp_fail(RP_BAD_INPUT, "late is measured at open, after this phase");
    return (void)host, RP_OK;
}

static void list(void *host, rp_guess *guess)
{
    (void)host;
    rp_guess_words(guess, "W | mu | floor | grains | rest | moved | theta | pile.speed");
}

static double load(void *host, int id, const double args[])
{
    return (void)host, id == MOVED ? at[MOVED] + args[0] - 10.0 * args[1] : at[id];
}

static const rp_x_names outside = {NULL, find, list, false}, inside = {NULL, find, list, true};
static const rp_x_values now = {NULL, load};

static double value_of(const char *text)
{
    RP_SCOPE(arena);
    rp_expression e = {0};
    double states[8] = {0.0};
    CHECK_OK(rp_expression_read(&arena, text, &inside, &e));
    return rp_expression_value(&e, &now, states);
}

static void test_values(void)
{
    at[GRAINS] = 12.0, at[REST] = 1.0, at[MOVED] = 3.0, at[THETA] = NAN, at[SPEED] = 0.5;
    CHECK_EACH(
        value_of(NAME), 1e-15, {"1 + 2*3 - 4/2", 5.0}, {"-2^2", -4.0}, {"2*-3", -6.0}, {"(1 + 2)*3", 9.0},
        {"8/2/2", 2.0}, {"2^3^1", 8.0}, {"2^-1", 0.5}, {"16^0.5", 4.0}, {"4^2.5", 32.0}, {"4^-1.5", 0.125},
        {"9^0", 1.0}, {".5e1 + 1E-1", 5.1}, {"2e+3/4e2", 5.0}, {"2*W", 8.0}, {"mu*grains", 0.2 * 12.0},
        {"pile.speed + 1", 1.5}, {"min(3, W, 2)", 2.0}, {"max(W, grains, 3)", 12.0}, {"abs(-W)", 4.0},
        {"sqrt(W)", 2.0}, {"floor(-1.5)", -2.0}, {"round(-1.5)", -2.0}, {"round(2.5)", 3.0},
        {"round(0.49999999999999994)", 1.0}, {"moved(1, 2)", 3.0 + 1.0 - 20.0}, {"W > 3 ? 1 : 2", 1.0},
        {"grains < 3 ? 1 : grains < 20 ? 5 : 7", 5.0}, {"1 < 2", 1.0}, {"2 <= 2 and 2 >= 2", 1.0},
        {"not 1 < 2", 0.0}, {"not rest or 1 > 2", 0.0}, {"1 == 1 and 1 != 2", 1.0},
        {"true or false and false", 1.0}, {"floor == 'ends'", 1.0}, {"floor != 'ends' ? 1 : 2", 2.0},
        {"rest == true", 1.0}, {"180*deg - pi", 0.0}, {"exp(log(W))", 4.0}, {"atan(1) - pi/4", 0.0},
        {"known(theta) ? 1 : 0", 0.0}, {"known(grains)", 1.0}, {" ( ( 1 ) ) ", 1.0}, {"1 - 1 - 1", -1.0});
    CU_ASSERT(value_of("-inf") == -INFINITY && isnan(value_of("min(theta, 1)")));
    for (double x = -1000.0; x < 1000.0; x += 0.37)
        CHECK_EACH(value_of(NAME), 4e-15 + 1e-16 * fabs(x), {check_text("sin(%.17g)", x), sin(x)},
                   {check_text("cos(%.17g)", x), cos(x)});
    CHECK_NEAR(value_of("tan(0.7)"), tan(0.7), 1e-15);
    CU_ASSERT(isnan(value_of("sin(inf)")));
}

static void test_messages(void)
{
    static const char *const cases[][2] = {
        {"grians < 300", "character 1: unknown name grians (did you mean \"grains\"?)"},
        {"1 + pile.sped", "character 5: unknown name pile.sped (did you mean \"pile.speed\"?)"},
        {"mu and rest", "character 1: a number stands where a condition is expected"},
        {"rest + 1", "character 1: a condition stands where a number is expected"},
        {"1 + (2 < 3)", "character 6: a condition stands where a number is expected"},
        {"floor + 1", "character 1: a word stands where a number is expected"},
        {"floor == 1", "character 10: a number stands where a word is expected"},
        {"rest ? 1 : 'a'", "character 12: a word stands where a number is expected"},
        {"rest ? 'a' : 'b'", "what chooses a word must be known before the run"},
        {"late > 1", "character 1: late is measured at open, after this phase"},
        {"atan(1)", "character 1: atan: only in measure"},
        {"change(grains)", "change: only in measure"},
        {"sqrt(1, 2)", "sqrt: another number of arguments expected"},
        {"min(1)", "min: another number of arguments expected"},
        {"held(rest)", "held: another number of arguments expected"},
        {"held(rest, grains)", "the second number of held must be known before the run"},
        {"held(rest, 0)", "held: at least one look expected"},
        {"held(1, 2)", "character 6: a number stands where a condition is expected"},
        {"known(1)", "character 7: known: the name of a measure expected"},
        {"2^grains", "character 3: an exponent must be known before the run"},
        {"2^65", "an exponent goes from -64 to 64"},
        {"moved(1)", "unknown name moved"},
        {"mved(1, 2)", "did you mean \"moved\"?"},
        {"sqr(2)", "did you mean \"sqrt\"?"},
        {"", "character 1: ends too early"},
        {"1 +", "character 4: ends too early"},
        {"(1", "character 3: \")\" expected at the end"},
        {"1 2", "character 3: \"2\" stands where the end is expected"},
        {"1 < 2 < 3", "character 7: \"<\" stands where the end is expected"},
        {"1 = 2", "character 3: \"=\" is no sign"},
        {"1 & 2", "character 3: \"&\" is no sign"},
        {"'open", "character 1: a word without its end"},
        {"1.2.3", "\"1.2.3\" is no number"},
        {"1e+x", "character 2: \"e\" stands where the end is expected"},
        {"*", "\"*\" stands where a value is expected"},
        {"rest ? 1", "\":\" expected at the end"},
        {"and", "\"and\" stands where a value is expected"}};
    char deep[256] = "";
    RP_SCOPE(arena);
    rp_expression e;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        CHECK_FAILS(rp_expression_read(&arena, cases[k][0], &outside, &e), RP_BAD_INPUT, cases[k][1]);
    for (int k = 0; k < 120; k++) strcat(deep, k % 2 ? "(" : "-");
    CHECK_FAILS(rp_expression_read(&arena, deep, &outside, &e), RP_BAD_INPUT, "too deep");
    scoped char *wide = calloc(2000, 1);
    for (int k = 0; k < 300; k++) strcat(wide, k ? "+mu*W" : "grains");
    CHECK_OK(rp_expression_read(&arena, "grains + 0.2", &outside, &e));
    *wide = '\0';
    for (int k = 0; k < 150; k++) strcat(wide, k ? "+grains" : "grains");
    CHECK_FAILS(rp_expression_read(&arena, wide, &outside, &e), RP_BAD_INPUT, "too many parts");
    CHECK_FAILS(rp_expression_read_as(&arena, "mu", RP_X_TRUTH, &outside, &e), RP_BAD_INPUT,
                "a number stands where a condition is expected");
}

static void test_states(void)
{
    RP_SCOPE(arena);
    rp_expression e;
    double states[8] = {0.0};
    CHECK_OK(rp_expression_read(&arena, "held(grains < 5, 3) or held(rest, 2)", &outside, &e));
    CU_ASSERT(e.n_states == 2 && e.type == RP_X_TRUTH && !e.known);
    static const double grains[] = {4, 4, 6, 4, 4, 4, 4, 9}, found[] = {0, 0, 0, 0, 0, 1, 1, 0};
    at[REST] = 0.0;
    for (int k = 0; k < 8; k++) {
        at[GRAINS] = grains[k];
        CU_ASSERT(rp_expression_value(&e, &now, states) == found[k]);
    }
    memset(states, 0, sizeof states);
    CHECK_OK(rp_expression_read(&arena, "change(grains) + 0*change(theta)", &inside, &e));
    at[THETA] = 1.0;
    for (int k = 0; k < 8; k++) {
        at[GRAINS] = grains[k];
        const double change = rp_expression_value(&e, &now, states);
        CU_ASSERT(k ? change == grains[k] - grains[k - 1] : isnan(change));
    }
    CU_ASSERT(e.n_states == 4);
}

static int asked;

static double load_counted(void *host, int id, const double args[])
{
    asked++;
    return load(host, id, args);
}

/* An `and` that is false, an `or` that is true ask no further; what counts its looks is always asked. */
static void test_decided(void)
{
    static const struct {
        const char *text;
        int asked, value;
    } cases[] = {{"grains < 5 and theta > 0 and theta < 9", 1, 0},
                 {"grains > 5 and theta > 0 and theta < 9", 3, 1},
                 {"grains > 5 or theta > 0 or grains > 5", 1, 1},
                 {"grains < 5 or theta < 0 or grains < 5", 3, 0},
                 {"grains < 5 and rest", 2, 0},
                 {"grains < 5 and held(theta > 0, 2)", 2, 0},
                 {"(grains < 5 and theta > 0) or theta > 1", 2, 1},
                 {"grains > 5 and (theta > 0 or theta > 1)", 2, 1},
                 {"not (grains < 5 and theta > 0)", 1, 1},
                 {"held(grains < 5 and theta > 0, 1)", 1, 0},
                 {"W > 3 and grains > 5 and W < 9", 1, 1},
                 {"W < 3 and grains > 5", 0, 0}};
    at[GRAINS] = 7.0, at[THETA] = 2.0, at[REST] = 0.0;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        RP_SCOPE(arena);
        rp_expression e;
        double states[8] = {0.0};
        CHECK_OK(rp_expression_read(&arena, cases[k].text, &inside, &e));
        asked = 0;
        CU_ASSERT((int)rp_expression_value(&e, &(rp_x_values){NULL, load_counted}, states) == cases[k].value);
        CHECK_OR_SAY(asked == cases[k].asked, "%s: asked %d", cases[k].text, asked);
    }
}

/* Keys are the same for what is the same, whatever its layout. */
static void test_keys(void)
{
    RP_SCOPE(arena);
    rp_expression e;
    int names[5] = {0};
    CHECK_OK(rp_expression_read(&arena, "grains + theta*grains + moved(grains, 0)", &outside, &e));
    for (size_t k = 0; rp_expression_asks(&e, k) >= 0; k++) names[rp_expression_asks(&e, k)]++;
    CU_ASSERT(names[GRAINS] == 3 && names[THETA] == 1 && names[MOVED] == 1 && names[REST] == 0);
    at[GRAINS] = 12.0, at[THETA] = NAN;
    CU_ASSERT(strcmp(rp_expression_operands(&arena, &e, &now),
                     "grains = 12, theta = nan, grains = 12, grains = 12") == 0);
}

/* ---- random texts ---- */

static unsigned long long state;
static int below(int n)
{
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return (int)((state >> 33) % (unsigned long long)n);
}

/* A random number or condition: its text, with brackets where they are needed and sometimes elsewhere, and
 * its value by the compiler's own arithmetic. */
static double write_random(rp_arena *arena, char **text, bool truth, int depth)
{
    char *a, *b, *c;
    const int kind = depth == 0 ? 0 : 1 + below(truth ? 5 : 7);
    double x, y, z;
    if (kind == 0 && truth) return *text = rp_text(arena, "%s", below(2) ? "rest" : "(1 < 2)"), 1.0;
    if (kind == 0) {
        static const char *const names[] = {"W", "mu", "grains", "pile.speed", "0.3", "7"};
        static const double values[] = {4.0, 0.2, 12.0, 0.5, 0.3, 7.0};
        const int k = below(6);
        return *text = rp_text(arena, "%s", names[k]), values[k];
    }
    if (truth) {
        x = write_random(arena, &a, kind > 2, depth - 1), y = write_random(arena, &b, kind > 2, depth - 1);
        if (kind == 1) return *text = rp_text(arena, "(%s < %s)", a, b), x < y;
        if (kind == 2) return *text = rp_text(arena, "(%s >= %s)", a, b), x >= y;
        if (kind == 3) return *text = rp_text(arena, "(%s and %s)", a, b), x != 0.0 && y != 0.0;
        if (kind == 4) return *text = rp_text(arena, "(%s or %s)", a, b), x != 0.0 || y != 0.0;
        return *text = rp_text(arena, "(not %s)", a), x == 0.0;
    }
    x = write_random(arena, &a, false, depth - 1), y = write_random(arena, &b, false, depth - 1);
    if (kind == 1) return *text = rp_text(arena, "(%s + %s)", a, b), x + y;
    if (kind == 2) return *text = rp_text(arena, "(%s - %s)", a, b), x - y;
    if (kind == 3) return *text = rp_text(arena, "(%s * %s)", a, b), x * y;
    if (kind == 4) return *text = rp_text(arena, "(%s/%s)", a, b), x / y;
    if (kind == 5) return *text = rp_text(arena, "min(%s, %s)", a, b), isnan(x) || x < y ? x : y;
    if (kind == 6) return *text = rp_text(arena, "(%s)^2", a), 1.0 * x * x;
    z = write_random(arena, &c, true, depth - 1);
    return *text = rp_text(arena, "(%s ? %s : %s)", c, a, b), z != 0.0 ? x : y;
}

static void test_random(void)
{
    char *text;
    at[GRAINS] = 12.0, at[REST] = 1.0, at[SPEED] = 0.5;
    state = 39;
    for (int k = 0; k < 3000; k++) {
        RP_SCOPE(arena);
        const double expected = write_random(&arena, &text, false, 1 + k % 4);
        const double v = value_of(text);
        CHECK_OR_SAY(memcmp(&v, &expected, sizeof v) == 0 || (isnan(v) && isnan(expected)),
                     "%s: %.17g, not %.17g", text, v, expected);
    }
    /* texts that were hurt at a random place: read, or refused */
    for (int k = 0; k < 20000; k++) {
        RP_SCOPE(arena);
        rp_expression e;
        double states[400] = {0.0};
        write_random(&arena, &text, true, 1 + k % 3);
        text[below((int)strlen(text))] = "()+-*/^<>=!?:,.'09aeW \x80&"[below(25)];
        if (rp_expression_read(&arena, text, &inside, &e) == RP_OK) rp_expression_value(&e, &now, states);
    }
}

/* ---- a scene's names ---- */

static const char scene_text[] = "let = { D = { value = 1.6; unit = \"cm\"; range = \"(0, 6)\"; meaning = "
                                 "\"outlet\"; }; mu = 0.2; N = 12; floor = \"ends\";\n"
                                 "        wide = \"3*D\"; turns = true; law = \"spring\"; };\n"
                                 "dt = 5.0e-5; y_min = \"floor == 'ends' ? -2*d : -inf\"; steps = \"N*10\"; "
                                 "density = \"4/pi\"; rotation = \"turns and wide > 1\";\n"
                                 "x_max = \"m*g\"; tangential = { law = \"law\"; mu = \"mu\"; };\n"
                                 "walls = ( { point = (\"-D\", 0.0); direction = (0.0, 1.0); extent = "
                                 "(\"-inf\", \"-wide\"); open_at_step = \"dt < 1 ? 7 : 8\"; } );\n"
                                 "fill = { N = \"N\"; W = \"wide\"; H = 16.0; };\n";

static void test_lets(void)
{
    scoped_scene s, t;
    CHECK_OK(grains_read(scene_text, NULL, &s));
    CU_ASSERT(s.def.y_min == -0.4 && s.steps == 120 && s.def.rotation && s.def.material.mu == 0.2 &&
              s.fills->N == 12);
    CHECK_PAIRS(1e-15, {s.fills->W, 4.8}, {s.fills->density, 4.0 / M_PI});
    CHECK_NEAR(s.def.x_max, 4.0 / 3.0 * M_PI * 1e-3 * 4.0 / M_PI * 981.0, 1e-14);
    CU_ASSERT(s.def.walls[0].open_at_step == 7 && s.def.walls[0].point[0] == -1.6);
    CU_ASSERT(s.def.walls[0].extent[1] == -s.fills->W && isinf(s.def.walls[0].extent[0]));
    CHECK_OK(grains_read(scene_text, &(rp_texts){3, {"D=0.5", "mu=0.7", "fill.H=3"}}, &t));
    CU_ASSERT(t.fills->W == 1.5 && t.def.material.mu == 0.7 && t.fills->H == 3.0);
}

static void test_lets_refused(void)
{
    static const char *const cases[][3] = {
        {"\"N*10\"", "\"N/7\"", "s.cfg:3: steps = \"N/7\": steps = 1.71429: a whole number expected"},
        {"\"N*10\"", "\"n*10\"",
         "s.cfg:3: steps = \"n*10\": character 1: unknown name n (did you mean \"N\"?)"},
        {"\"N*10\"", "\"N*inf\"", "s.cfg:3: steps = \"N*inf\": "},
        {"\"N*10\"", "\"floor\"", "steps = \"floor\": steps = \"ends\": "},
        {"\"N*10\"", "\"0/0\"", "steps = \"0/0\": is nan"},
        {"mu = \"mu\"", "mu = \"-mu\"",
         "s.cfg:4: tangential.mu = \"-mu\": mu = -0.2: out of range, allowed: [0, inf)"},
        {"mu = \"mu\"", "mu = \"atan(mu)\"", "atan: only in measure"},
        {"law = \"law\"", "law = \"laws\"", "tangential.law = \"laws\": unknown word, allowed: none"},
        {"law = \"law\"", "law = \"mu\"", "tangential.law = \"mu\": law = 0.2: "},
        {"\"-D\"", "\"-E\"", "walls.[0].point = \"-E\": character 2: unknown name E"},
        {"\"-D\"", "\"turns\"", "walls.[0].point: two numbers [a, b] expected"},
        {"\"-D\"", "\"inf\"", "walls.[0].point: finite numbers expected"},
        {"\"3*D\"", "\"3*later\"", "s.cfg:2: let.wide: character 3: unknown name later"},
        {"value = 1.6", "value = 7.0", "s.cfg:1: let.D: D = 7: out of range, allowed: (0, 6) cm"},
        {"value = 1.6", "valu = 1.6", "let.D.valu: unknown key (did you mean \"value\"?)"},
        {"unit =", "units =",
         "s.cfg:1: let.D.units: unknown key (did you mean \"unit\"?); allowed: unit range meaning"},
        {"unit = \"cm\"", "unit = 3", "s.cfg:1: let.D.unit = 3: text expected"},
        {"mu = 0.2", "mu = { unit = \"1\"; }", "let.mu: value is missing"},
        {"mu = 0.2", "pi = 0.2", "let.pi: pi is the number pi in every expression"},
        {"mu = 0.2", "mu = [1, 2]", "let.mu: a number, true, false, a word or an expression expected"},
        {"let =", "lets =", "unknown key"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        grains_refused(check_changed(scene_text, cases[k][0], cases[k][1]), NULL, cases[k][2]);
    grains_refused(scene_text, &(rp_texts){1, {"D=7"}}, "let.D: D = 7: out of range");
}

CHECK_SUITE(expression, "expression", test_values, test_messages, test_states, test_decided, test_keys,
            test_random, test_lets, test_lets_refused)
