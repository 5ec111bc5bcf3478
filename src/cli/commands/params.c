/* repose params: parameters and outputs of the protocols. */
#include <ctype.h>
#include <string.h>

#include "cli/cli.h"
#include "dem/scene/text.h"
#include "experiment/experiment.h"
#include "params/config.h"
#include "params/expression.h"
#include "params/guess.h"
#include "sweeps/engine/experiment.h"

#define PARAMS_OPTIONS(X)                                                                                    \
    X(CHOICE, units, "", "cgs", RP_UNITS_WORDS, "system of the units and defaults shown")

CLI_OPTIONS(params, PARAMS_OPTIONS)

static const char *const type_words[] = {
    [RP_REAL] = "real", [RP_INT] = "whole", [RP_BOOL] = "bool", [RP_CHOICE] = "word", [RP_TEXT] = "text"};

/* The default as in the schema; in other units than its own converted. */
static const char *default_of(const rp_param *p, rp_units units, char text[64])
{
    rp_param alone = *p;
    double number;
    if (!p->fallback) return "(required)";
    if (p->type != RP_REAL || strcmp(rp_unit(units, p->unit), p->unit) == 0) return cli_cell(p->fallback);
    alone.offset = 0;
    rp_params_default(&alone, units, &number);
    return rp_params_text(&alone, &number, text, 64);
}

/* A line each, with what each word of a choice stands for. */
static void print_schema(const cli_call *call, const rp_param *schema)
{
    char text[64], word[64];
    fprintf(call->out, "# %-25s %-10s %-6s %-12s %-34s %s\n", "name", "unit", "type", "default", "range",
            "meaning");
    for (const rp_param *p = schema; p->name; p++)
        fprintf(call->out, "  %-25s %-10s %-6s %-12s %-34s %s\n", p->name,
                cli_cell(rp_unit(call->units, p->unit)), type_words[p->type],
                default_of(p, call->units, text), p->type == RP_BOOL ? "true | false" : cli_cell(p->range),
                p->meaning);
    for (const rp_param *p = schema; p->name; p++)
        for (int k = 0; p->manual && *rp_word_at(p->range, k, word, sizeof word); k++)
            fprintf(call->out, "#   %s = %s: %s\n", p->name, word, p->manual[k]);
}

/* A scene file has a group of keys for each of its schemas. */
static void print_scene(const cli_call *call)
{
    for (const dem_scene_group *g = dem_scene_schemas; g->name; g++) {
        fprintf(call->out, "# scene file, %s: %s\n", g == dem_scene_schemas ? "top level" : g->name,
                g->manual);
        print_schema(call, g->schema);
    }
}

/* Does a name of a family follow the other, as n_02 follows n_01? */
static bool is_next(const char *name, const char *after)
{
    const size_t n = strlen(name);
    return after && n > 2 && strlen(after) == n && isdigit((unsigned char)name[n - 1]) &&
           isdigit((unsigned char)name[n - 2]) && strncmp(name, after, n - 2) == 0;
}

static void print_experiment(const cli_call *call)
{
    RP_SCOPE(arena);
    for (const dem_scene_group *g = exp_groups; g->name; g++) {
        fprintf(call->out, "# experiment, %s: %s\n", g->name, g->manual);
        print_schema(call, g->schema);
    }
    for (const exp_module *const *at = exp_modules; *at; at++) {
        const exp_module *const m = *at;
        fprintf(call->out,
                "# experiment, measure of = \"%s\": %s; a column is the measure's name with one of\n",
                m->name, m->about);
        for (const exp_output *o = m->outputs; o->name; o++) {
            const exp_output *first = o;
            while (is_next(o->name, o[1].name)) o++;
            fprintf(call->out, "#   %-25s %-10s %s\n",
                    o == first ? o->name : rp_text(&arena, "%s to %s", first->name, o->name),
                    cli_cell(first->unit), first->meaning);
        }
        print_schema(call, m->schema);
    }
    fprintf(call->out,
            "# experiment, what expressions may ask for, besides lets and earlier measures: %s. "
            "What is of KIND. is also of the kind in a region, REGION.KIND. or KIND.REGION.\n# %-25s "
            "%-10s %-14s %s\n",
            rp_expression_functions, "name", "unit", "of", "meaning");
    exp_word w;
    for (size_t k = 0; (w = exp_observable_at(k)).name; k++)
        fprintf(call->out, "  %-25s %-10s %-14s %s\n", w.name, cli_cell(rp_unit(call->units, w.unit)), w.of,
                w.meaning);
}

static void print_protocol(const cli_call *call, const sweep_protocol *protocol)
{
    fprintf(call->out, "# protocol %s: %s\n", protocol->name, protocol->about);
    print_schema(call, protocol->schema);
    if (protocol->context) {
        fprintf(call->out, "# for sweeps also these of a scene:");
        for (const dem_named_key *k = dem_named_keys; k->key; k++)
            if (!rp_params_find(protocol->schema, k->param.name)) fprintf(call->out, " %s", k->param.name);
        fputc('\n', call->out);
    }
    fprintf(call->out, "# outputs of protocol %s\n# %-36s %-10s %s\n", protocol->name, "name", "unit",
            "meaning");
    for (const sweep_output *o = protocol->outputs; o->name; o++)
        fprintf(call->out, "  %-36s %-10s %s\n", o->name, cli_cell(rp_unit(call->units, o->unit)),
                o->meaning);
}

/* The names and measures of a file. */
static rp_status file_rows(cli_call *call, const char *path)
{
    dem_text text;
    dem_scene scene = {0};
    exp_plan *plan = NULL;
    char number[32];
    rp_status status = dem_text_open(path, NULL, NULL, &text);
    const bool phases = !status && exp_has_phases(&text);
    if (!status) status = phases ? exp_read(&text, &plan) : dem_text_scene(&text, &scene);
    if (!status) {
        call->units = rp_config_units(config_root_setting(&text.config));
        cli_provenance(call, call->out);
        rp_table_header(call->out, call->units, "name, kind, value, unit, range, meaning");
    }
    for (size_t k = 0; !status && k < text.lets.n; k++) {
        const rp_let *let = &text.lets.lets[k];
        fprintf(call->out, "%s\t%s\t%s\t%s\t%s\t%s\n", let->name, let->computed ? "computed" : "let",
                let->is.type == RP_X_WORD    ? let->is.word
                : let->is.type == RP_X_TRUTH ? (let->is.value != 0.0 ? "true" : "false")
                                             : rp_number_text(let->is.value, 6, number, sizeof number),
                cli_cell(let->unit), cli_cell(let->range), cli_cell(let->meaning));
    }
    size_t n = 0;
    const exp_output *o = plan && !status ? exp_outputs(plan, &n) : NULL;
    for (size_t k = 0; k < n; k++)
        fprintf(call->out, "%s\tmeasure\t-\t%s\t-\t%s\n", o[k].name, cli_cell(o[k].unit), o[k].meaning);
    if (!phases) dem_scene_free(&scene);
    exp_free(plan);
    dem_text_close(&text);
    return status;
}

static rp_status print_all(cli_call *call, const void *values)
{
    const params_options *o = values;
    const char *name = cli_argument(call, 0);
    bool found = false;
    if (name && rp_ends_in(name, ".cfg")) return file_rows(call, rp_data(call->arena, name));
    call->units = (rp_units)o->units;
    for (const sweep_protocol *const *p = sweep_protocols; *p; p++) {
        if (name && strcmp(name, (*p)->name) != 0) continue;
        if (found) fputc('\n', call->out);
        const sweep_protocol *opened;
        const rp_status status = sweep_protocol_open(*p, NULL, NULL, &opened);
        if (!status) sweep_protocol_in(opened, call->units);
        if (!status) print_protocol(call, opened);
        sweep_protocol_close(opened);
        RP_TRY(status);
        found = true;
    }
    for (int k = 0; k < 2; k++) {
        if (name && strcmp(name, k ? "experiment" : "scene") != 0) continue;
        if (found) fputc('\n', call->out);
        (k ? print_experiment : print_scene)(call);
        found = true;
    }
    if (found) return RP_OK;
    rp_guess guess = rp_guess_of(name);
    for (const sweep_protocol *const *p = sweep_protocols; *p; p++) rp_guess_try(&guess, (*p)->name);
    rp_guess_try(&guess, "scene"), rp_guess_try(&guess, "experiment");
    return rp_fail(RP_BAD_INPUT, "\"%s\": unknown protocol%s; repose params lists them", name,
                   rp_guess_text(&guess));
}

const cli_command cmd_params = {
    "params",
    "list all parameters of a protocol or scene file, with unit, default and range",
    "[PROTOCOL | scene | experiment | FILE.cfg] [--units WORD]",
    "PROTOCOL: prints the parameters of a sweep's protocol with unit, type, default, range and meaning, and "
    "the outputs of the protocol. scene: the keys of a scene file, and the meaning of each option value. "
    "experiment: the keys of phases and measures, and what expressions may contain. FILE.cfg: the `let` "
    "variables of this file with values, units and ranges, and the columns that it measures. Without an "
    "argument, everything is printed.\n"
    "\n"
    "Columns of the tables of a run, which are in the laboratory frame:\n"
    "  states.tsv    step, t (s), id, x, y (cm), angle (rad), vx, vy (cm/s),\n"
    "                omega (rad/s), net force fx, fy (dyn), r (cm), m (g), number of\n"
    "                contacts, whether the grain is fixed; kind, of a scene with kinds:\n"
    "                its number in the header's line of kinds, 0 for none\n"
    "  contacts.tsv  shear_force acts on the second body, along the centre line from\n"
    "                the first, turned 90 degrees clockwise; shear_spring has the\n"
    "                opposite sign. rolling_torque acts on the first body;\n"
    "                rolling_spring is the displacement at r_i r_j/(r_i + r_j)\n"
    "  walls.tsv     a wall is a line through x, y with the unit normal direction_x,\n"
    "                direction_y. Its ends `from` and `to` lie along the normal\n"
    "                turned 90 degrees clockwise, and are equal once it is open",
    "repose params repose",
    params_params,
    .refuses = "A name that is no protocol; the message names the nearest one.",
    .act = print_all};
