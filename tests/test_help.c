/* Help, manual, completion and lists of parameters: whole texts, put together a second time from the
 * commands' own words and schemas. */

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

/* The next line of what is expected; false at its end. */
enum { MOST = 4096 };
static bool next_line(const char **text, char line[static MOST])
{
    const size_t length = strcspn(*text, "\n");
    const bool there = **text != '\0';
    snprintf(line, MOST, "%.*s", (int)length, *text);
    *text += length + ((*text)[length] == '\n');
    return there;
}

/* Words of a text in lines of at most `width`, the first of which has begun with `start`, the others with so
 * many blanks; each line takes the words that fit. */
static void filled(const char *start, const char *text, int indent, int width)
{
    char line[4096];
    snprintf(line, sizeof line, "%s", start);
    bool empty = true;
    for (const char *word = text; *word; word += strspn(word, " \n")) {
        const int length = (int)strcspn(word, " \n"), at = (int)strlen(line);
        if (at > indent && at + 1 + length > width) {
            line_is("%s", line);
            sprintf(line, "%*s", indent, "");
            empty = true;
        }
        sprintf(line + strlen(line), "%s%.*s", empty ? "" : " ", length, word);
        empty = false;
        word += length;
    }
    line_is("%s", line);
}

/* What an option is for, with unit, range and default. */
static const char *text_of(const rp_param *p, char text[1024])
{
    int n = sprintf(text, "%s", p->meaning);
    if (*p->unit) n += sprintf(text + n, ", %s", p->unit);
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

/* The description: paragraphs are filled, lines that begin with a blank stand as they are. */
static void check_about(const char *about, int width)
{
    char text[8192] = "", line[MOST];
    while (next_line(&about, line)) {
        if (*text && (!*line || *line == ' ')) filled("", text, 0, width), *text = '\0';
        if (!*line || *line == ' ')
            line_is("%s", line);
        else
            strcat(strcat(text, line), "\n");
    }
    if (*text) filled("", text, 0, width);
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
    const char *variable = strcmp(typed, "report") == 0 ? "REPORT" : "REPOSE";
    option options[64];
    char start[80], text[1024], line[MOST];
    enum { width = 80 };
    CU_ASSERT_EQUAL_FATAL(shell_line("\"$%s\" %s --help >out 2>err", variable, c->name), 0);
    rest = out;
    snprintf(start, sizeof start, "usage: %s %s ", typed, c->name);
    if (c->group) {
        line_is("%sCOMMAND [options]; repose %s COMMAND --help says more\n", start, c->name);
        for (const cli_command *const *g = c->group; *g; g++)
            line_is("  %-10s %s", own_name(*g), (*g)->summary);
        text_ends();
        return;
    }
    for (const char *from = c->synopsis; next_line(&from, line);) {
        filled(start, line, 11, width);
        snprintf(start, sizeof start, "       %s %s ", typed, c->name);
    }
    line_is("%s", "");
    check_about(c->about, width);
    line_is("\noptions:");
    const size_t n = options_of(c, options);
    for (size_t i = 0; i < n; i++) {
        snprintf(start, sizeof start, "  %-22.39s ", options[i].typed);
        filled(start, text_of(options[i].p, text), 25, width);
    }
    line_is("  %-22s this text\n\nrefuses:", "--help");
    for (const char *from = c->refuses; next_line(&from, line);) filled("  ", line, 4, width);
    line_is("\nexample:\n  %s", c->example);
    text_ends();
}

static void test_help(void)
{
    each(cli_repose.commands, check_texts), each(report_commands, check_texts);
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

/* The next line is this text between two others: each mark of Markdown is escaped. */
static void marked(const char *before, const char *text, const char *after)
{
    char line[4096], *to = stpcpy(line, before);
    for (; *text; text++) to += sprintf(to, strspn(text, "\\`*_{}[]<>#~^$@|+!&-") ? "\\%c" : "%c", *text);
    strcpy(to, after);
    line_is("%s", line);
}

static void title_is(const char *before, const char *name)
{
    marked(before, name, "\n");
}

static void item_is(const char *dashes, const char *name, const char *text)
{
    marked(check_text("**%s", dashes), name, "**");
    marked(":   ", text, "\n");
}

/* Lines in the form of the text are indented, with a blank line before and after. */
static void lines_are(const char *text)
{
    char line[MOST];
    for (bool kept = false; next_line(&text, line);) {
        if (*line && kept != (*line == ' ')) {
            kept = !kept;
            line_is("%s", "");
        }
        if (kept)
            line_is("    %s", line);
        else
            marked("", line, "");
    }
    line_is("%s", "");
}

static void schema_is(const rp_param *schema)
{
    char text[1024], word[64];
    for (const rp_param *p = schema; p->name; p++) {
        item_is("", p->name, text_of(p, text));
        int k = 0;
        for (const char *at = p->range, *end; p->manual && *at; at = *end ? end + 3 : end) {
            end = at + strcspn(at, " ");
            char *to = stpcpy(text, "    *");
            for (const char *c = strncpy(word, at, 63); c - word < end - at; c++)
                to += sprintf(to, *c == '_' ? "\\%c" : "%c", *c);
            strcpy(to, "*: ");
            marked(text, p->manual[k++], "\n");
        }
    }
}

static void command_is(const cli_command *c)
{
    char text[1024], line[MOST];
    option options[64];
    title_is("## repose ", c->name);
    if (c->group) {
        title_is("", c->summary);
        return; /* `each` continues with its commands */
    }
    snprintf(text, sizeof text, "**repose %s** ", c->name);
    for (const char *from = c->synopsis; next_line(&from, line);) marked(text, line, "\n");
    lines_are(c->about);
    const size_t n = options_of(c, options);
    for (size_t i = 0; i < n; i++) {
        const char *name = options[i].typed + strspn(options[i].typed, "-");
        item_is(name - options[i].typed == 2 ? "\\-\\-" : "\\-", name, text_of(options[i].p, text));
    }
    snprintf(text, sizeof text, "Refuses: ");
    for (const char *from = c->refuses; next_line(&from, line);) {
        marked(text, line, "");
        *text = '\0';
    }
    line_is("\nExample:\n\n    %s\n", c->example);
}

static void test_manual(void)
{
    GOOD("help");
    char *overview = strdup(out), *files = strstr(overview, "\n\nAn example, sweep or table ");
    CU_ASSERT_PTR_NOT_NULL_FATAL(files);
    GOOD("help --markdown");
    rest = out;
    line_is("%% REPOSE(1) Repose %s | User Commands\n", RP_VERSION);
    title_is("# ", "NAME");
    title_is("repose \\- ", cli_repose.about);
    title_is("# ", "SYNOPSIS");
    line_is("**repose** *COMMAND* [options]\n");
    title_is("# ", "COMMANDS");
    each(cli_repose.commands, command_is);
    title_is("# ", "KEYS OF A SCENE FILE");
    for (const dem_scene_group *g = dem_scene_schemas; g->name; g++) {
        title_is("## ", g->name);
        lines_are(g->manual);
        schema_is(g->schema);
    }
    title_is("# ", "KEYS AND OUTPUTS OF A SWEEP'S PROTOCOL");
    for (const sweep_protocol *const *each_of = sweep_protocols; *each_of; each_of++) {
        const sweep_protocol *p;
        CHECK_OK(sweep_protocol_open(*each_of, NULL, NULL, &p));
        title_is("## Protocol ", p->name);
        lines_are(p->about);
        schema_is(p->schema);
        title_is("### Outputs of protocol ", p->name);
        for (const sweep_output *o = p->outputs; o->name; o++) {
            char text[1024];
            snprintf(text, sizeof text, *o->unit ? "%s, %s" : "%s", o->meaning, o->unit);
            item_is("", o->name, text);
        }
        sweep_protocol_close(p);
    }
    title_is("# ", "EXIT STATUS");
#define X(name, code, text) item_is("", #code, text);
    RP_STATUS_LIST(X)
#undef X
    title_is("# ", "FILES");
    lines_are(files + 2);
    text_ends();
    free(overview);
}

/* ---- completion ---- */

static void completion_of(const cli_command *c)
{
    char words[4096] = "";
    option options[64];
    if (c->group) {
        for (const cli_command *const *g = c->group; *g; g++) completion_of(*g);
        for (const cli_command *const *g = c->group; *g; g++) strcat(strcat(words, own_name(*g)), " ");
        line_is("    '%s ') words='%s--help' ;;", c->name, words);
        return;
    }
    const size_t n = options_of(c, options);
    for (size_t i = 0; i < n; i++) {
        const rp_param *p = options[i].p;
        char choices[512] = "";
        if (p->type == RP_CHOICE)
            for (const char *r = p->range; *r; r += *r == '|')
                strncat(choices, r, strcspn(r, "|")), r += strcspn(r, "|");
        if (p->type != RP_BOOL) line_is("    '%s'*' %s ') words='%s' ;;", c->name, options[i].typed, choices);
    }
    for (const cli_command *const *g = cli_repose.commands; *g && strcmp(c->name, "help") == 0; g++)
        strcat(strcat(words, (*g)->name), " ");
    for (size_t i = 0; i < n; i++) strcat(strcat(words, options[i].typed), " ");
    line_is("    '%s '*) words='%s--help' ;;", c->name, words);
}

static void test_completion(void)
{
    char words[1024] = "";
    GOOD("help --completion");
    rest = out;
    line_is("# Completion of repose, from `repose help --completion`; names of files where no word fits.\n"
            "_repose()\n{\n    local words=\n    case \"${COMP_WORDS[*]:1:COMP_CWORD-1} \" in");
    for (const cli_command *const *c = cli_repose.commands; *c; c++) completion_of(*c);
    for (const cli_command *const *c = cli_repose.commands; *c; c++) strcat(strcat(words, (*c)->name), " ");
    line_is("    ' ') words='%s--help --version' ;;\n    esac", words);
    line_is("    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"${COMP_WORDS[COMP_CWORD]}\")\n}\n"
            "complete -o bashdefault -o default -F _repose repose");
    text_ends();
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
    static const char *const words[] = {[RP_REAL] = "real",   [RP_INT] = "whole", [RP_BOOL] = "bool",
                                        [RP_CHOICE] = "word", [RP_TEXT] = "text", [RP_TEXTS] = "text"};
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
    line_is("# experiment, what expressions may ask for, besides lets and earlier measures: %s",
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

CHECK_SUITE_WITHIN(help, "help", enter, leave, test_help, test_room, test_arguments, test_manual,
                   test_completion, test_params)
