/* repose sweep make: the runs of a sweep file, and the tables that its settings derive from them. */
#include <libgen.h>
#include <string.h>

#include "cli/derive/derive.h"
#include "cli/progress.h"
#include "run/run.h"
#include "params/config.h"
#include "params/settings.h"

#define MAKE_OPTIONS(X)                                                                                      \
    X(TEXT, o, "", NULL, "", "folder of the sweep; created if missing")                                      \
    X(TEXT, tables, "", "auto", "", "folder of the tables; auto: DIR/tables")                                \
    CLI_WORKERS(X)                                                                                           \
    CLI_LIMITS(X)                                                                                            \
    X(INT, replicas, "", "auto", "[1, 1000000] | auto", "runs per grid point; auto: the number in the file") \
    X(BOOL, study, "", "false", "", "make as many runs per grid point as `study` in the file says")          \
    CLI_QUIET(X)                                                                                             \
    CLI_FORCE(X, "use the folders even if they hold a different sweep")

CLI_OPTIONS(make, MAKE_OPTIONS)

/* A table that a setting of the file asks for: a command of this program, and the values of its options. */
typedef struct step {
    struct step *next;
    const config_setting_t *setting;
    const char *table; /* its name */
    const char *rows;  /* "runs", "points" or an earlier table; NULL: none */
    const char *stage; /* of the traces, whose piles the command reads; NULL: none */
    const config_setting_t *of;
    bool folder; /* of a trace or a pile: its tables */
    cli_call call;
} step;

typedef struct {
    const cli_call *call;
    const make_options *o;
    const char *file, *tables; /* the sweep's file, and the folder */
    sweep_recipe recipe;
    step *first, **end;
} making;

/* ---- reading ---- */

static const char *text_of(const config_setting_t *group, const char *key)
{
    const char *text = NULL;
    config_setting_lookup_string(group, key, &text);
    return text;
}

/* The options of the command, their names as in a file, and which of them the setting has. */
static rp_param *schema_of(step *s)
{
    static const char settled[] = "|o|force|quiet|j|set|"; /* as where the table goes */
    cli_call *call = &s->call;
    size_t n = 0;
    while (call->options[n].name) n++;
    rp_param *schema = rp_arena_memory(call->arena, n, sizeof *schema), *to = schema;
    for (size_t i = 0; i < n; i++) {
        char *name = rp_text(call->arena, "%s", call->options[i].name);
        for (char *c = name; (c = strchr(c, '-'));) *c = '_';
        call->given[i] = member(s->setting, name) != NULL;
        if (strstr(settled, rp_text(call->arena, "|%s|", name))) continue;
        *to = call->options[i];
        to++->name = name;
    }
    return schema;
}

/* "trend x=W y=theta_r3_deg by=mu", in the order of the file. */
static const char *describe(const step *s, const rp_param *schema)
{
    char value[256];
    rp_arena *arena = s->call.arena;
    const char *text = cli_own_name(s->call.command);
    for (size_t i = 0; i < length(s->setting); i++) {
        const config_setting_t *m = element(s->setting, i);
        const rp_param *p = rp_params_find(schema, config_setting_name(m));
        if (p && p->type != RP_TEXTS)
            text = rp_text(arena, "%s %s=%s", text, p->name,
                           rp_params_text(p, s->call.values, value, sizeof value));
    }
    const rp_texts *where = cli_value(&s->call, "where");
    for (size_t i = 0; where && i < where->n; i++)
        text = rp_text(arena, "%s where=%s", text, where->items[i]);
    return text;
}

/* Columns that the options name are those of the runs, or of the points. */
static rp_status check_columns(const making *m, const step *s, const rp_param *schema)
{
    static const char *const names[] = {"x", "y", "se", "by", "column"};
    size_t n;
    rp_table *table;
    int *columns;
    const bool points = strcmp(s->rows, "points") == 0;
    if (!points && strcmp(s->rows, "runs") != 0) return RP_OK;
    rp_status status =
        sweep_columns(s->call.arena, m->file, sweep_protocols, points ? SWEEP_POINTS : SWEEP_RUNS, &table);
    for (size_t i = 0; i < N_OF(names) && !status; i++) {
        const rp_param *p = rp_params_find(schema, names[i]);
        if (!p || p->type != RP_TEXT) continue;
        const char *list = *(const char *const *)cli_value(&s->call, names[i]);
        if (strcmp(list, "none") != 0) status = rp_columns(s->call.arena, table, list, &n, &columns);
        if (status) status = rp_config_fail(s->setting, "%s: %s: %s", s->table, p->name, rp_message());
    }
    return status;
}

static rp_status read_options(const making *m, step *s, const cli_command *command, const char *others)
{
    cli_options_of(&s->call, command);
    rp_param *schema = schema_of(s);
    RP_TRY(rp_config_group(s->setting, schema, s->call.values, others));
    s->call.lineage = rp_text(s->call.arena, "# derived by: %s\n", describe(s, schema));
    return s->rows ? check_columns(m, s, schema) : RP_OK;
}

static step *add_step(making *m, const config_setting_t *setting, const char *table)
{
    step *s = rp_arena_memory(m->call->arena, 1, sizeof *s);
    *s = (step){.setting = setting, .table = table, .call = *m->call};
    s->call.line = rp_text(m->call->arena, "%s sweep make %s", m->call->program->name, m->file);
    s->call.n_arguments = 0;
    *m->end = s;
    m->end = &s->next;
    return s;
}

/* Does an earlier setting, or the sweep itself, make a table of this name? */
static bool is_made(const making *m, const char *name)
{
    bool is = strcmp(name, "runs") == 0 || strcmp(name, "points") == 0;
    for (const step *s = m->first; s; s = s->next) is |= strcmp(s->table, name) == 0;
    return is;
}

/* The name of a table is one of a file, and stands once. */
static rp_status check_name(const making *m, const config_setting_t *setting, const char *name)
{
    if (!name) return rp_config_fail(setting, "table: missing (the name of the table)");
    if (is_made(m, name)) return rp_config_fail(setting, "table: %s: stands twice", name);
    if (!*name || *name == '.' || strchr(name, '/') || strlen(name) > 64)
        return rp_config_fail(
            setting, "table: %s: the name of a file expected, without / and at most 64 letters", name);
    return RP_OK;
}

/* The command that `with` names, one of these lists that derives a table, or one that does not. */
static rp_status find_command(const making *m, const config_setting_t *setting, bool derives,
                              const cli_command *const *const lists[], size_t n, const cli_command **command)
{
    const char *with = text_of(setting, "with"), *allowed = "";
    *command = NULL;
    for (size_t k = 0; k < n; k++)
        for (const cli_command *const *c = lists[k]; *c; c++) {
            if ((*c)->derives != derives) continue;
            allowed = rp_text(m->call->arena, "%s %s", allowed, cli_own_name(*c));
            if (with && strcmp(with, cli_own_name(*c)) == 0) return *command = *c, RP_OK;
        }
    return rp_config_fail(setting, "with = \"%s\": allowed:%s", with ? with : "", allowed);
}

static rp_status read_derive(making *m, const config_setting_t *setting)
{
    const cli_command *const *const lists[] = {cmd_stats.group, cmd_stress.group, cmd_angle.group}, *command;
    const char *name = text_of(setting, "table"), *rows = text_of(setting, "rows");
    RP_TRY(check_name(m, setting, name));
    RP_TRY(find_command(m, setting, true, lists, N_OF(lists), &command));
    if (member(setting, "rows") && (!rows || !is_made(m, rows)))
        return rp_config_fail(setting,
                              "rows = \"%s\": runs, points or an earlier table of this file expected",
                              rows ? rows : "");
    step *s = add_step(m, setting, name);
    s->of = member(setting, "of");
    s->stage = text_of(setting, "stage");
    if (!command->on_table != (s->stage != NULL))
        return rp_config_fail(setting, "%s %s: stage %s", name, command->name,
                              s->stage ? "is for piles of traces"
                                       : "missing (of the traces whose piles it reads)");
    const int n = s->of ? config_setting_length(s->of) : 0;
    bool named = !s->of || (n > 0 && !rows);
    for (int i = 0; i < n && named; i++) { /* each once */
        const char *one = config_setting_get_string_elem(s->of, i);
        named = one && !strchr(one, '/');
        for (int k = 0; k < i && named; k++)
            named = strcmp(one, config_setting_get_string_elem(s->of, k)) != 0;
    }
    if (!named)
        return rp_config_fail(s->of, "of: names of sweeps expected, each once, as in [\"lh_size\", "
                                     "\"lh_size_mid\"], and no rows");
    if (command->on_table) s->rows = rows ? rows : "runs";
    return read_options(m, s, command, "table with rows of stage");
}

static rp_status read_model(making *m, const config_setting_t *setting)
{
    const cli_command *const models[] = {&cmd_pile, &cmd_tent, &cmd_continuum, &cmd_lattice, NULL},
                             *const *const lists[] = {models}, *command;
    RP_TRY(check_name(m, setting, text_of(setting, "table")));
    RP_TRY(find_command(m, setting, false, lists, 1, &command));
    step *s = add_step(m, setting, text_of(setting, "table"));
    const config_setting_t *folder = member(setting, "folder");
    s->folder = folder && config_setting_get_bool(folder);
    if (folder && (command != &cmd_pile || config_setting_type(folder) != CONFIG_TYPE_BOOL))
        return rp_config_fail(folder, "folder: only a pile has one, true or false");
    return read_options(m, s, command, "table with folder");
}

static rp_status read_trace(making *m, const config_setting_t *setting)
{
    const config_setting_t *rows = member(setting, "rows");
    if (!rows || !config_setting_length(rows))
        return rp_config_fail(setting, "rows: missing (numbers of runs, as in [0, 10])");
    for (int i = 0; i < config_setting_length(rows); i++) {
        const config_setting_t *one = config_setting_get_elem(rows, (unsigned)i);
        const long row = config_setting_type(one) == CONFIG_TYPE_INT ? config_setting_get_int(one) : -1;
        if (row < 0) return rp_config_fail(rows, "rows: numbers of runs from 0 expected, as in [0, 10]");
        step *s = add_step(m, setting, rp_text(m->call->arena, "row_%ld", row));
        RP_TRY(read_options(m, s, &cmd_run, "rows"));
        s->folder = true;
        s->call.lineage = NULL; /* its tables say it themselves */
        s->call.n_arguments = 1;
        s->call.arguments = rp_arena_memory(m->call->arena, 1, sizeof *s->call.arguments);
        *(const char **)s->call.arguments = m->file;
        *(long *)cli_value(&s->call, "row") = row;
        *(bool *)cli_value(&s->call, "quiet") = true;
    }
    return RP_OK;
}

static rp_status read_list(making *m, const char *key,
                           rp_status (*read)(making *m, const config_setting_t *setting))
{
    const config_setting_t *list = config_lookup(&m->recipe.config, key);
    if (!list) return RP_OK;
    if (!config_setting_is_list(list))
        return rp_config_fail(list, "%s: a list ( { ... }, ... ) expected", key);
    for (size_t i = 0; i < length(list); i++) {
        const config_setting_t *setting = element(list, i);
        if (!config_setting_is_group(setting))
            return rp_config_fail(setting, "%s: groups { ... } expected", key);
        RP_TRY(read(m, setting));
    }
    return RP_OK;
}

/* ---- making ---- */

static rp_status export_to(const making *m, const char *name, unsigned what)
{
    const char *path;
    RP_TRY(rp_path(m->call->arena, &path, "%s/%s.tsv", m->tables, name));
    return cli_sweep_export(m->call, m->o->o, what, path, true, NULL);
}

static rp_status plan_runs(const making *m, sweep_counts *counts)
{
    const make_options *o = m->o;
    const size_t replicas = o->replicas > 0 ? (size_t)o->replicas : o->study ? m->recipe.study : 0;
    RP_TRY(cli_claim_sweep(o->o, m->file, o->force));
    return cli_sweep_plan(m->file, o->o, replicas, o->quiet, counts);
}

static rp_status make_runs(const making *m)
{
    const make_options *o = m->o;
    sweep_counts counts;
    const sweep_options options = {
        .workers = (int)o->j, .memory = o->mem, .time = o->time, .snapshot = RUN_SNAPSHOT};
    const rp_status status = cli_sweep_run(o->o, options, o->quiet, &counts);
    if (!status || status == RP_NO_RESULT) { /* "lh3: 80 runs: 78 ok, 2 not_at_rest" */
        FILE *const out = m->call->out;
        fprintf(out, "%s: %zu runs", m->recipe.name, counts.stored);
        for (size_t i = 0; i < counts.words.n; i++)
            fprintf(out, "%s %.0f %s", i ? "," : ":", counts.words.of[i].times, counts.words.of[i].word);
        fputc('\n', out);
        fflush(out); /* before what is told of tables */
    }
    RP_TRY(status);
    RP_TRY(export_to(m, "runs", SWEEP_RUNS));
    return export_to(m, "points", SWEEP_POINTS);
}

/* The runs of other sweeps lie beside those of this one. */
static rp_status load_of(const making *m, const step *s, cli_call *call, rp_table **table)
{
    char *own = rp_text(call->arena, "%s", m->o->o), *beside = dirname(own);
    *table = NULL;
    for (int i = 0; i < config_setting_length(s->of); i++) {
        rp_table *more;
        sweep_counts counts;
        const char *name = config_setting_get_string_elem(s->of, i), *folder = m->o->o;
        if (strcmp(name, m->recipe.name) != 0) RP_TRY(rp_path(call->arena, &folder, "%s/%s", beside, name));
        rp_status status = cli_sweep_table(call, folder, SWEEP_RUNS, &more, &counts);
        if (!status) status = sweep_check_whole(folder, &counts);
        RP_TRY(rp_prefix(status, "%s reads the runs of %s, which must be made first: ", s->table, name));
        cli_sources(call, more);
        if (*table) RP_TRY(rp_table_append(*table, more));
        if (!*table) *table = more;
    }
    return RP_OK;
}

static rp_status load_rows(const making *m, const step *s, cli_call *call, rp_table **table)
{
    const char *path;
    if (s->of) return load_of(m, s, call, table);
    RP_TRY(rp_path(call->arena, &path, "%s/%s.tsv", m->tables, s->rows));
    RP_TRY(rp_table_load(call->arena, path, table));
    cli_sources(call, *table);
    return RP_OK;
}

/* The piles of the traces before this step, as arguments. */
static rp_status name_piles(const making *m, const step *s, cli_call *call)
{
    size_t n = 0;
    for (const step *t = m->first; t; t = t->next) n++;
    const char **piles = rp_arena_memory(call->arena, n, sizeof *piles);
    for (const step *t = m->first; t; t = t->next)
        if (t->call.command == &cmd_run)
            RP_TRY(
                rp_path(call->arena, &piles[call->n_arguments++], "%s/%s/%s", m->tables, t->table, s->stage));
    call->arguments = (char *const *)piles;
    return call->n_arguments ? RP_OK : rp_config_fail(s->setting, "%s: no traces in this file", s->table);
}

/* A command that finds no result is an answer too, if it prints a table. */
static rp_status make_step(const making *m, const step *s)
{
    const rp_mark mark = rp_arena_mark(m->call->arena);
    const char *path, *folder;
    FILE *out;
    rp_table *table = NULL;
    cli_call call = s->call;
    RP_TRY(rp_path(call.arena, &folder, "%s/%s", m->tables, s->table));
    RP_TRY(rp_path(call.arena, &path, "%s.tsv", folder));
    if (s->rows) RP_TRY(load_rows(m, s, &call, &table));
    if (s->stage) RP_TRY(name_piles(m, s, &call));
    if (s->folder) *(const char **)cli_value(&call, "o") = folder, *(bool *)cli_value(&call, "force") = true;
    RP_TRY(rp_file_open(path, true, &out));
    rp_status status = cli_act_into(&call, table, out);
    if (status == RP_NO_RESULT && ftell(out) > 0) {
        cli_say("repose sweep: %s: %s", s->table, rp_message());
        status = RP_OK;
    }
    status = rp_file_close(path, out, rp_prefix(status, "%s: ", s->table));
    rp_arena_release(m->call->arena, mark);
    return status;
}

/* A row too many, before all runs. */
static rp_status check_steps(const making *m, size_t n_runs)
{
    for (const step *s = m->first; s; s = s->next)
        if (s->call.command == &cmd_run && *(const long *)cli_value(&s->call, "row") >= (long)n_runs)
            return rp_config_fail(s->setting, "rows: %s: the sweep has %zu runs, from 0", s->table, n_runs);
    return RP_OK;
}

static rp_status act_make(cli_call *call, const void *values)
{
    making m = {
        .call = call, .o = values, .file = rp_data(call->arena, cli_argument(call, 0)), .end = &m.first};
    rp_status status = sweep_recipe_read(m.file, &m.recipe);
    if (!status) status = read_list(&m, "trace", read_trace);
    if (!status) status = read_list(&m, "derive", read_derive);
    if (!status) status = read_list(&m, "model", read_model);
    m.tables = strcmp(m.o->tables, "auto") ? m.o->tables : rp_text(call->arena, "%s/tables", m.o->o);
    sweep_counts counts = {0};
    if (!status && m.recipe.has_runs) status = plan_runs(&m, &counts);
    if (!status) status = check_steps(&m, counts.planned);
    if (!status)
        status = rp_folder_own(m.tables, rp_text(call->arena, "tables of the sweep %s", m.recipe.name),
                               m.o->force); /* where all tables are the program's */
    if (!status && m.recipe.has_runs) status = make_runs(&m);
    for (const step *s = m.first; s && !status; s = s->next) status = make_step(&m, s);
    sweep_recipe_free(&m.recipe);
    return status;
}

const cli_command cmd_sweep_make = {
    "sweep make",
    "plan and make the runs, and write all tables of the sweep file",
    "FILE -o DIR [--tables DIR] [-j N] [--mem MB] [--time S] [--replicas N | --study] [--quiet] [--force]",
    "Plans a sweep, makes its missing runs, and writes its tables: runs.tsv, points.tsv with one row for "
    "each grid point, and the tables that these settings of the file ask for. All settings are checked "
    "before the first run.\n"
    "\n"
    "  study  = 60;             # runs per grid point with --study\n"
    "  derive = ( { table = \"a\"; with = \"compare\"; },\n"
    "             { table = \"line\"; with = \"fit\"; rows = \"points\";\n"
    "               x = \"mu\"; y = \"theta_r3_deg_mean\"; where = [\"mu<0.5\"]; } );\n"
    "  trace  = ( { rows = [0, 10]; every = 100; } );\n"
    "  model  = ( { table = \"30\"; with = \"continuum\"; alpha_deg = 30.0; } );\n"
    "\n"
    "derive: each entry writes one table, such as a.tsv. `with` is the command that writes it: one of repose "
    "stats, stress or angle that reads a table, here repose angle compare and repose stats fit. Options of "
    "the command are keys, with underlines for dashes. The command reads the table that `rows` names: runs "
    "(if `rows` is "
    "missing), points, or an earlier table of the file. With of = [\"a\", \"b\"] it reads instead the runs "
    "of the sweeps a and b, which must be complete, in folders beside DIR.\n"
    "\n"
    "trace: repeats runs of the sweep as `repose run FILE --row 0 --every 100` does; their results go to "
    "row_0.tsv, their tables to the folder row_0. The commands field and base of `derive` read these piles; "
    "stage = \"pile\" says at the end of which phase.\n"
    "\n"
    "model: each entry writes one table of repose pile, tent, continuum or lattice; for a pile, folder = "
    "true also writes the tables of its disks, contacts and wells. A file without a protocol may have only "
    "models.",
    "repose sweep make sweeps/li/tent.cfg -o build/sweeps/tent",
    make_params,
    .refuses = "All that `repose sweep plan` and `repose sweep run` refuse; an unknown key, command or "
               "column of a setting, before any run.\n"
               "A folder of a trace or a pile that holds something else.",
    .act = act_make};
