/* Help, manual and completion: their form with a program of two commands, letter by letter; and that all
 * words of the real commands and schemas stand there in order. Lists of parameters, put together a second
 * time from the schemas. */

#include "params/expression.h"
#include "params/units.h"
#include "core/version.h"
#include "experiment/experiment.h"
#include "report/pages.h"
#include "sweeps/engine/experiment.h"
#include "tests/program.h"
#include "tests/verbs.h"

/* ---- a text line by line ---- */

static char *rest;

/* The next line, or lines, are these. */
#define line_is(...) goes_on(check_text("%s\n", check_text(__VA_ARGS__)))
static void goes_on(const char *expected)
{
    const bool same = strncmp(rest, expected, strlen(expected)) == 0;
    if (!same) fprintf(stderr, "the text goes on:\n%.400s\nexpected:\n%s", rest, expected);
    CU_ASSERT_FATAL(same);
    rest += strlen(expected);
}

static void text_ends(void)
{
    CU_ASSERT(*rest == '\0');
}

/* So goes the text on but for its form: blanks, ends of lines, and marks of Markdown. */
#define words_are(...) words_go_on(check_text(__VA_ARGS__))
static void words_go_on(const char *expected)
{
    static const char form[] = " \n\\*";
    for (const char *e = expected; *(e += strspn(e, form)); e++, rest++) {
        rest += strspn(rest, form);
        if (*rest != *e) fprintf(stderr, "the text goes on:\n%.400s\nexpected:\n%s", rest, e);
        CU_ASSERT_FATAL(*rest == *e);
    }
    rest += strspn(rest, form);
}

/* What an option is for, with unit, range and default. */
static const char *text_of(const rp_param *p, char text[1024])
{
    const size_t said = strcspn(p->meaning, ";"); /* before what its words mean */
    int n = sprintf(text, "%.*s%s%s%s%s", (int)said, p->meaning, *p->unit ? " [" : "", p->unit,
                    *p->unit ? "]" : "", p->meaning + said);
    if (p->range && *p->range) n += sprintf(text + n, "; %s", p->range);
    if (!p->fallback) n += sprintf(text + n, " (required)");
    if (p->fallback && *p->fallback && p->type != RP_BOOL) sprintf(text + n, " (default %s)", p->fallback);
    return text;
}

/* ---- help ---- */

static const char *own_name(const cli_command *c)
{
    return strrchr(c->name, ' ') ? strrchr(c->name, ' ') + 1 : c->name;
}

/* The next words are the lines of a synopsis, after a command's name. */
static void synopsis_is(const char *program, const cli_command *c)
{
    for (const char *line = c->synopsis, *end; *line; line = end + (*end == '\n')) {
        end = line + strcspn(line, "\n");
        words_are("%s %s %.*s", program, c->name, (int)(end - line), line);
    }
}

static const char *typed = "repose"; /* the program */

/* Every command has these texts, a group its summary alone. */
static void check_texts(const cli_command *c)
{
    const struct {
        const char *name, *text;
    } texts[] = {{"summary", c->summary},
                 {"synopsis", c->group ? "-" : c->synopsis},
                 {"about", c->group ? "-" : c->about},
                 {"refuses", c->group ? "-" : c->refuses},
                 {"example", c->group ? "-" : c->example}};
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
        if (!texts[k].text) fprintf(stderr, "command %s: no %s\n", c->name, texts[k].name);
        CU_ASSERT_FATAL(texts[k].text != NULL);
    }
}

static void check_help(const cli_command *c)
{
    option options[64];
    char text[1024];
    CU_ASSERT_EQUAL_FATAL(
        shell_line("\"$%s\" %s --help >out 2>err", strcmp(typed, "report") ? "REPOSE" : "REPORT", c->name),
        0);
    rest = out;
    words_are("usage: ");
    if (c->group) {
        words_are("%s %s COMMAND [options]; %s %s COMMAND --help says more", typed, c->name, typed, c->name);
        for (const cli_command *const *g = c->group; *g; g++) words_are("%s %s", own_name(*g), (*g)->summary);
    } else {
        synopsis_is(typed, c);
        words_are("%s options:", c->about);
        const size_t n = options_of(c, options);
        for (size_t i = 0; i < n; i++) words_are("%.39s %s", options[i].typed, text_of(options[i].p, text));
        words_are("--help this text refuses: %s example: %s", c->refuses, c->example);
    }
    text_ends();
}

/* ---- the form of help, manual and completion ---- */

static const rp_param *options_of_do(void)
{
    static const rp_param rows[] = {
        {"a_length", "cm", RP_REAL, 0, NULL, "> 0", "for which no line has room; of sixty columns", false},
        {"n", "", RP_INT, 8, "1", "", "a number", false},
        {"word", "", RP_CHOICE, 16, "one", "one | two", "with marks \\`*_{}[]<>#~^$@|+!&-", false},
        {"flag", "", RP_BOOL, 24, "false", "", "yes or no", false},
        {0}};
    return rows;
}

static const cli_command
    do_it =
        {"do it",
         "does it",
         "FILE --a-length CM [-n NUMBER] [--word one|two] [--flag]\nFILE",
         "A paragraph of which two lines\nare filled in here, with a_mark.\n  a line as it is\nOther words.",
         "made do it x",
         options_of_do,
         "One thing.\nAnother thing, which is said in so many words that they go on below."},
    do_all = {"do", "what is done", .group = (const cli_command *const[]){&do_it, NULL}};
static const cli_program made = {"made", "Made", "a program", (const cli_command *const[]){&do_all, NULL}};

/* What a command of the program prints. */
static char *printed(int argc, char **argv)
{
    char *text;
    size_t size;
    RP_SCOPE(arena);
    const cli_command *c = cli_find(cli_repose.commands, argv[0]);
    cli_call call = {.arena = &arena, .program = &made, .out = open_memstream(&text, &size)};
    CHECK_OK(cli_run(&call, c ? c : &do_it, argc, argv));
    fclose(call.out);
    return text;
}

static const char help_of_do[] =
    "usage: made do it FILE --a-length CM [-n NUMBER] [--word one|two] [--flag]\n"
    "       made do it FILE\n\n"
    "A paragraph of which two lines are filled in here, with a_mark.\n"
    "  a line as it is\n"
    "Other words.\n\n"
    "options:\n"
    "  --a-length             for which no line has room [cm]; of sixty columns; > 0\n"
    "                         (required)\n"
    "  -n                     a number (default 1)\n"
    "  --word                 with marks \\`*_{}[]<>#~^$@|+!&-; one | two (default\n"
    "                         one)\n"
    "  --flag                 yes or no\n"
    "  --help                 this text\n\n"
    "refuses:\n"
    "  One thing.\n"
    "  Another thing, which is said in so many words that they go on below.\n\n"
    "example:\n"
    "  made do it x\n";
static const char manual_of_do[] =
    "## repose do\n\nwhat is done\n\n## repose do it\n\n"
    "**repose do it** FILE \\-\\-a\\-length CM \\[\\-n NUMBER\\] \\[\\-\\-word one\\|two\\] "
    "\\[\\-\\-flag\\]\n\n"
    "**repose do it** FILE\n\n"
    "A paragraph of which two lines\n"
    "are filled in here, with a\\_mark.\n\n"
    "      a line as it is\n\n"
    "Other words.\n\n"
    "**\\-\\-a\\-length**\n"
    ":   for which no line has room \\[cm\\]; of sixty columns; \\> 0 (required)\n\n"
    "**\\-n**\n"
    ":   a number (default 1)\n\n"
    "**\\-\\-word**\n"
    ":   with marks \\\\\\`\\*\\_\\{\\}\\[\\]\\<\\>\\#\\~\\^\\$\\@\\|\\+\\!\\&\\-; one \\| two (default "
    "one)\n\n"
    "**\\-\\-flag**\n"
    ":   yes or no\n\n"
    "Refuses: One thing.\n"
    "Another thing, which is said in so many words that they go on below.\n\n"
    "Example:\n\n    made do it x\n\n";
static const char completion_of_do[] =
    "# Completion of repose, from `repose help --completion`; names of files where no word fits.\n"
    "_repose()\n"
    "{\n"
    "    local words=\n"
    "    case \"${COMP_WORDS[*]:1:COMP_CWORD-1} \" in\n"
    "    'do it'*' --a-length ') words='' ;;\n"
    "    'do it'*' -n ') words='' ;;\n"
    "    'do it'*' --word ') words='one  two' ;;\n"
    "    'do it '*) words='--a-length -n --word --flag --help' ;;\n"
    "    'do ') words='it --help' ;;\n"
    "    ' ') words='do --help --version' ;;\n"
    "    esac\n"
    "    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"${COMP_WORDS[COMP_CWORD]}\")\n"
    "}\n"
    "complete -o bashdefault -o default -F _repose repose\n";

static void test_form(void)
{
    char it[] = "it", help[] = "help", form[] = "--help", markdown[] = "--markdown", bash[] = "--completion";
    scoped char *text = printed(2, (char *[]){it, form, NULL});
    CU_ASSERT_STRING_EQUAL(text, help_of_do);
    scoped char *manual = printed(2, (char *[]){help, markdown, NULL});
    char *from = strstr(manual, "## repose do\n"), *to = strstr(manual, "# KEYS");
    CU_ASSERT_FATAL(from && to);
    *to = '\0';
    CU_ASSERT_STRING_EQUAL(from, manual_of_do);
    scoped char *completion = printed(2, (char *[]){help, bash, NULL});
    CU_ASSERT_STRING_EQUAL(completion, completion_of_do);
}

/* ---- all commands ---- */

static void test_help(void)
{
    each(cli_repose.commands, check_texts), each(report_commands, check_texts);
    static const char *const first[] = {"run", "view", "sweep", "calibrate"}; /* what a person tries first */
    for (int k = 0; k < 4; k++) CU_ASSERT_STRING_EQUAL(cli_repose.commands[k]->name, first[k]);
    each(cli_repose.commands, check_help);
    typed = "report";
    each(report_commands, check_help);
}

static rp_status nothing(cli_call *call, const void *values)
{
    (void)call, (void)values;
    return RP_OK;
}

/* A command has any number of options, with names of any length, and values of any size. */
static void test_room(void)
{
    enum { MANY = 100, FAR = 100000 };
    static rp_param rows[MANY + 1];
    static const char long_name[] = "abcdefghijklmnopqrstuvwxyz_0123456789_abcdefghijklmnopqrstuvwxyz";
    RP_SCOPE(arena);
    cli_call call = {.arena = &arena, .program = &cli_repose};
    char name[] = "many", needed[] = "--needed";
    cli_command c = {.name = name, .protocol = rows, .protocol_size = FAR * MANY};
    c.synopsis = "[options]", c.act = nothing;
    for (int i = 0; i < MANY; i++) rows[i] = (rp_param){"a", "", RP_TEXT, FAR * i, "of a", "", "", false};
    rows[3].name = long_name;
    cli_options_of(&call, &c);
    CU_ASSERT(call.options[MANY - 1].name && !call.options[MANY].name);
    CU_ASSERT_STRING_EQUAL(call.options[3].name,
                           "abcdefghijklmnopqrstuvwxyz-0123456789-abcdefghijklmnopqrstuvwxyz");
    for (size_t i = 0; i < MANY; i++)
        CU_ASSERT_STRING_EQUAL(*(const char **)((char *)call.values + FAR * i), "of a");
    CHECK_OK(cli_run(&call, &c, 1, (char *[]){name, NULL}));
    for (int i = 0; i < MANY; i += MANY - 1) { /* the first and the last one are required */
        rows[i].fallback = NULL;
        rows[i].name = "needed";
        CHECK_FAILS(cli_run(&call, &c, 1, (char *[]){name, NULL}), RP_USAGE, "--needed is required");
        CHECK_OK(cli_run(&call, &c, 3, (char *[]){name, needed, name, NULL}));
        rows[i] = rows[1];
    }
}

/* How many arguments go with a synopsis, and options that take no value. */
static void test_arguments(void)
{
    static const struct {
        const char *synopsis;
        bool fits[3]; /* none, one, two */
    } cases[] = {{"[options]", {true, false, false}},         {"--flag", {true, false, false}},
                 {"FILE [--flag]", {false, true, false}},     {"FILE... [--flag]", {false, true, true}},
                 {"[FILE] [--flag]", {true, true, false}},    {"[FILE...] [--flag]", {true, true, true}},
                 {"FILE.cfg [--flag]", {false, true, false}}, {"--flag\nFILE", {true, true, false}},
                 {"FILE\nFILE...", {false, true, true}}};
    static const rp_param rows[] = {{"flag", "", RP_BOOL, 0, "false", "", "a flag", false},
                                    {"x", "", RP_INT, 8, "1", "[0, 9]", "a number", false},
                                    {0}};
    char name[] = "few", one[] = "one", two[] = "two", flag[] = "--flag", wrong[] = "--flag=3",
         letter[] = "-y", both[] = "-x3";
    cli_command c = {.name = name, .protocol = rows, .act = nothing};
    RP_SCOPE(arena);
    cli_call call = {.arena = &arena, .program = &cli_repose};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        for (int n = 0; n < 3; n++) {
            char *line[] = {name, one, two, NULL};
            c.synopsis = cases[k].synopsis;
            line[n + 1] = NULL;
            const rp_status status = cli_run(&call, &c, n + 1, line);
            CU_ASSERT_EQUAL(status, cases[k].fits[n] ? RP_OK : RP_USAGE);
            if (status) {
                const char *usage = strstr(rp_message(), "usage: repose few ");
                CU_ASSERT(usage && strstr(usage, "; see repose few --help") &&
                          strncmp(usage + 18, c.synopsis, strcspn(c.synopsis, "\n")) == 0);
                CU_ASSERT_EQUAL(strstr(rp_message(), "\": one argument too many") != NULL, n > 0);
            }
            CU_ASSERT_PTR_EQUAL(cli_argument(&call, 0), n > 0 ? line[1] : NULL);
            CU_ASSERT_PTR_EQUAL(cli_argument(&call, 1), n > 1 ? line[2] : NULL);
            CU_ASSERT_PTR_EQUAL(call.arguments[0], line[1]);
        }
    c.synopsis = "[options]";
    CHECK_OK(cli_run(&call, &c, 2, (char *[]){name, flag, NULL}));
    CU_ASSERT(cli_given(&call, "flag") && !cli_given(&call, "x"));
    CHECK_OK(cli_run(&call, &c, 2, (char *[]){name, both, NULL}));
    CU_ASSERT(!cli_given(&call, "flag") && cli_given(&call, "x"));
    CHECK_FAILS(cli_run(&call, &c, 2, (char *[]){name, wrong, NULL}), RP_USAGE,
                "unknown option --flag=3 (did you mean --flag?)");
    CHECK_FAILS(cli_run(&call, &c, 2, (char *[]){name, letter, NULL}), RP_USAGE,
                "unknown option -y; see repose few --help");
}

/* ---- manual ---- */

static void schema_is(const rp_param *schema)
{
    char text[1024];
    for (const rp_param *p = schema; p->name; p++) {
        words_are("%s: %s", p->name, text_of(p, text));
        int k = 0;
        for (const char *at = p->range, *end; p->manual && *at; at = *end ? end + 3 : end) {
            end = at + strcspn(at, " ");
            words_are("%.*s: %s", (int)(end - at), at, p->manual[k++]);
        }
    }
}

static void command_is(const cli_command *c)
{
    char text[1024];
    option options[64];
    words_are("## repose %s", c->name);
    if (c->group) {
        words_are("%s", c->summary);
        return; /* `each` continues with its commands */
    }
    synopsis_is("repose", c);
    words_are("%s", c->about);
    const size_t n = options_of(c, options);
    for (size_t i = 0; i < n; i++) words_are("%.39s: %s", options[i].typed, text_of(options[i].p, text));
    words_are("Refuses: %s Example: %s", c->refuses, c->example);
}

static void test_manual(void)
{
    GOOD("help");
    char *overview = strdup(out), *files = strstr(overview, "\n\nAn example, sweep or table ");
    CU_ASSERT_PTR_NOT_NULL_FATAL(files);
    GOOD("help --markdown");
    rest = out;
    words_are("%% REPOSE(1) Repose %s | User Commands # NAME repose - %s # SYNOPSIS repose COMMAND [options] "
              "# COMMANDS",
              RP_VERSION, cli_repose.about);
    each(cli_repose.commands, command_is);
    words_are("# KEYS OF A SCENE FILE");
    for (const dem_scene_group *g = dem_scene_schemas; g->name; g++) {
        words_are("## %s %s", g->name, g->manual);
        schema_is(g->schema);
    }
    words_are("# KEYS AND OUTPUTS OF A SWEEP'S PROTOCOL");
    for (const sweep_protocol *const *each_of = sweep_protocols; *each_of; each_of++) {
        const sweep_protocol *p;
        CHECK_OK(sweep_protocol_open(*each_of, NULL, NULL, &p));
        words_are("## Protocol %s %s", p->name, p->about);
        schema_is(p->schema);
        words_are("### Outputs of protocol %s", p->name);
        for (const sweep_output *o = p->outputs; o->name; o++)
            words_are("%s: %s%s%s", o->name, o->meaning, *o->unit ? ", " : "", o->unit);
        sweep_protocol_close(p);
    }
    words_are("# EXIT STATUS");
#define X(name, code, text) words_are("%s: %s", #code, text);
    RP_STATUS_LIST(X)
#undef X
    words_are("# FILES %s", files + 2);
    text_ends();
    free(overview);
}

/* ---- parameters ---- */

static const char *or_dash(const char *text)
{
    return text && *text ? text : "-";
}

/* The default in these units; numbers of cgs by hand. */
static const char *default_of(const rp_param *p, bool si, char text[64])
{
    static const struct {
        const char *unit;
        double factor;
    } factors[] = {{"cm", 1e-2},    {"cm/s", 1e-2},   {"cm/s^2", 1e-2},    {"g", 1e-3},
                   {"g/cm^3", 1e3}, {"dyn/cm", 1e-3}, {"dyn/cm^1.5", 1e-2}};
    char *end;
    if (!p->fallback) return "(required)";
    const double number = strtod(p->fallback, &end);
    for (size_t k = 0; k < sizeof factors / sizeof *factors && si && p->type == RP_REAL; k++)
        if (strcmp(p->unit, factors[k].unit) == 0 && *p->fallback && !*end) {
            sprintf(text, "%g", number * factors[k].factor);
            return text;
        }
    return or_dash(p->fallback);
}

static const char *type_of(const rp_param *p)
{
    static const char *const words[] = {[RP_REAL] = "real",     [RP_INT] = "int",   [RP_BOOL] = "bool",
                                        [RP_CHOICE] = "choice", [RP_TEXT] = "text", [RP_TEXTS] = "text"};
    return words[p->type];
}

static void schema_is_listed(const rp_param *schema, bool si)
{
    char text[64];
    line_is("# %-25s %-10s %-6s %-12s %-34s %s", "name", "unit", "type", "default", "range", "meaning");
    for (const rp_param *p = schema; p->name; p++) {
        const char *unit = or_dash(rp_unit(si ? RP_SI : RP_CGS, p->unit)),
                   *fallback = default_of(p, si, text);
        line_is("  %-25s %-10s %-6s %-12s %-34s %s", p->name, unit, type_of(p), fallback,
                p->type == RP_BOOL ? "true | false" : or_dash(p->range), p->meaning);
    }
}

static void protocol_is_listed(const sweep_protocol *protocol, bool si)
{
    line_is("# protocol %s: %s", protocol->name, protocol->about);
    schema_is_listed(protocol->schema, si);
    if (protocol->context) {
        char also[1024] = "# for sweeps also these of a scene:";
        for (const dem_named_key *k = dem_named_keys; k->key; k++)
            if (!rp_params_find(protocol->schema, k->param.name)) strcat(strcat(also, " "), k->param.name);
        line_is("%s", also);
    }
    line_is("# outputs of protocol %s", protocol->name);
    line_is("# %-36s %-10s %s", "name", "unit", "meaning");
    for (const sweep_output *o = protocol->outputs; o->name; o++) {
        const char *unit = or_dash(rp_unit(si ? RP_SI : RP_CGS, o->unit));
        line_is("  %-36s %-10s %s", o->name, unit, o->meaning);
    }
}

/* Each word of a choice has a manual. */
static void manual_lines(const rp_param *schema)
{
    for (const rp_param *p = schema; p->name; p++) {
        CU_ASSERT(!p->manual || p->type == RP_CHOICE);
        int k = 0;
        for (const char *word = p->range, *end; p->manual && *word; word = *end ? end + 3 : end, k++) {
            end = word + strcspn(word, " ");
            CU_ASSERT(strlen(p->manual[k]) > 10);
            line_is("#   %s = %.*s: %s", p->name, (int)(end - word), word, p->manual[k]);
        }
    }
}

static void scene_is_listed(bool si)
{
    for (const dem_scene_group *g = dem_scene_schemas; g->name; g++) {
        const char *name = g > dem_scene_schemas ? g->name : "top level";
        line_is("# scene file, %s: %s", name, g->manual);
        schema_is_listed(g->schema, si);
        manual_lines(g->schema);
    }
}

static void experiments_are_listed(bool si)
{
    for (const dem_scene_group *g = exp_groups; g->name; g++) {
        line_is("# experiment, %s: %s", g->name, g->manual);
        schema_is_listed(g->schema, si);
    }
    for (const exp_module *const *at = exp_modules; *at; at++) {
        const exp_module m = **at;
        line_is("# experiment, measure of = \"%s\": %s; a column is the measure's name with one of", m.name,
                m.about);
        for (const exp_output *o = m.outputs; o->name; o++) {
            const exp_output *first = o; /* a family of the bins stands in one line */
            const size_t stem = strcspn(o->name, "0123456789");
            while (o[1].name && strlen(o->name) == stem + 2 && strlen(o[1].name) == stem + 2 &&
                   strncmp(o->name, o[1].name, stem) == 0)
                o++;
            const char *names = check_text(o > first ? "%s to %s" : "%s", first->name, o->name);
            line_is("#   %-25s %-10s %s", names, or_dash(first->unit), first->meaning);
        }
        schema_is_listed(m.schema, si);
    }
    line_is("# experiment, what expressions may ask for, besides lets and earlier measures: %s. What is of "
            "KIND. is "
            "also of the kind in a region, REGION.KIND. or KIND.REGION.",
            rp_expression_functions);
    line_is("# %-25s %-10s %-14s %s", "name", "unit", "of", "meaning");
    exp_word w;
    for (size_t k = 0; (w = exp_observable_at(k)).name; k++) {
        const char *unit = or_dash(rp_unit(si ? RP_SI : RP_CGS, w.unit));
        line_is("  %-25s %-10s %-14s %s", w.name, unit, w.of, w.meaning);
    }
}

static void opened_is_listed(const sweep_protocol *p, bool si)
{
    CHECK_OK(sweep_protocol_open(p, NULL, NULL, &p));
    sweep_protocol_in(p, si ? RP_SI : RP_CGS);
    protocol_is_listed(p, si);
    sweep_protocol_close(p);
}

/* What is asked for, blank lines between the protocols, the scene and experiments. */
static void check_params(const char *command)
{
    const bool si = strstr(command, "si") != NULL, flux = strstr(command, "flux") != NULL,
               experiment = strstr(command, "experiment") != NULL, scene = strstr(command, "scene") != NULL,
               all = !flux && !experiment && !scene;
    for (const sweep_protocol *const *p = sweep_protocols; *p && all; p++) {
        opened_is_listed(*p, si);
        line_is("%s", "");
    }
    if (scene || all) scene_is_listed(si);
    if (flux) opened_is_listed(&sweep_protocol_flux, si);
    if (all) line_is("%s", "");
    if (experiment || all) experiments_are_listed(si);
}

static void test_params(void)
{
    static const char *const words[] = {"params", "params --units si", "params scene --units si",
                                        "params flux", "params experiment"};
    for (size_t k = 0; k < 5; k++) {
        GOOD("%s", words[k]);
        rest = out;
        check_params(words[k]);
        text_ends();
    }
    FAILS(65, "\"fluxx\": unknown protocol (did you mean \"flux\"?); repose params lists them",
          "params fluxx");
    FAILS(65, "(did you mean \"scene\"?)", "params scen");
}

CHECK_SUITE_WITHIN(help, "help", enter, leave, test_form, test_help, test_room, test_arguments, test_manual,
                   test_params)
