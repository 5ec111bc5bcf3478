/* An experiment's text as a protocol: its lets are the parameters, its measures the outputs. */
#include "sweeps/engine/experiment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/arena.h"
#include "core/file.h"
#include "experiment/experiment.h"
#include "params/config.h"
#include "params/units.h"
#include "table/columns.h"

/* A let's value among the parameters; the first 8 bytes of those are the experiment. */
typedef union {
    double number;
    bool truth;
    int choice;
    const char *word;
} slot;

typedef struct {
    sweep_protocol protocol;
    rp_arena arena;
    dem_text text;
    exp_plan *plan;   /* with the text's own values: owns the names of the outputs */
    char *bytes;      /* of a file */
    rp_param *schema; /* of lets, then of keys of the scene */
    size_t n_lets, n_params;
    const char **keys; /* of a computed let its expression */
} experiment;

static const char COMPUTED[] = "computed";

/* ---- one set of values ---- */

static const experiment *experiment_of(const void *params)
{
    const experiment *e;
    memcpy(&e, params, sizeof e);
    return e;
}

/* The text with these values of its lets. */
static rp_status plan_of(const void *params, exp_plan **plan)
{
    experiment *e = (experiment *)experiment_of(params);
    *plan = NULL;
    for (const dem_named_key *k = dem_named_keys; k->key; k++) { /* in their order, whatever the sweep's */
        char value[64], change[160];
        const rp_param *p = rp_params_find(e->schema + e->n_lets, k->param.name);
        if (!p) continue;
        rp_params_text(p, params, value, sizeof value);
        snprintf(change, sizeof change, "%s=%s", k->key, value);
        RP_TRY(dem_text_change(&e->text, change));
    }
    for (const rp_param *p = e->schema; p < e->schema + e->n_lets; p++) {
        char word[64];
        const slot *v = (const slot *)((const char *)params + p->offset);
        const char *own = e->keys[p - e->schema];
        const rp_value value =
            own && isinf(v->number) ? (rp_value){.kind = RP_V_TEXT, .s = own} /* over an earlier run's */
            : p->type == RP_REAL    ? (rp_value){.kind = RP_V_REAL, .r = v->number}
            : p->type == RP_BOOL    ? (rp_value){.kind = RP_V_BOOL, .i = v->truth}
            : p->type == RP_TEXT
                ? (rp_value){.kind = RP_V_TEXT, .s = v->word}
                : (rp_value){.kind = RP_V_TEXT, .s = rp_word_at(p->range, v->choice, word, sizeof word)};
        RP_TRY(dem_text_give(&e->text, p->name, &value));
    }
    return exp_read(&e->text, plan);
}

static rp_status check(const void *params)
{
    exp_plan *plan;
    rp_status status = plan_of(params, &plan);
    if (!status) status = exp_check(plan);
    exp_free(plan);
    return status;
}

static bool hash(const void *params, XXH128_hash_t *digest)
{
    exp_plan *plan;
    rp_status status = plan_of(params, &plan);
    if (!status) status = exp_key(plan, digest);
    exp_free(plan);
    return status == RP_OK;
}

static void end_run(run_driver *d)
{
    run_free(d);
    exp_free(d->plan);
}

/* Start it, or resume it: from a snapshot that is refused anew, of which the caller hears. */
static rp_status start(run_driver *d, unsigned long seed, unsigned long stream, const sweep_tables *t)
{
    const run_sinks to = {
        .snapshot = t->snapshot, .owner = t->owner, .interval = t->interval, .stop = t->stop};
    bool resumed;
    RP_TRY(run_start(d->plan, seed, stream, d));
    const rp_status status = run_open(d, &to, &resumed);
    if (status != RP_BAD_INPUT) return status;
    snprintf(t->why, t->size, "%s", rp_message());
    run_forget(t->snapshot);
    run_free(d);
    RP_TRY(run_start(d->plan, seed, stream, d));
    return run_open(d, &to, &resumed);
}

static rp_status run_one(const void *params, unsigned long seed, unsigned long stream,
                         const sweep_tables *tables, sweep_result *result)
{
    static const sweep_tables none = {0};
    RP_ENDS(end_run) run_driver d = {0};
    sweep_result_clear(result);
    RP_TRY(plan_of(params, &d.plan));
    RP_TRY(start(&d, seed, stream, tables ? tables : &none));
    RP_TRY(run_finish(&d));
    sweep_result_of(&d, result);
    return RP_OK;
}

rp_status sweep_protocol_plan(const sweep_protocol *p, const void *params, exp_plan **plan)
{
    *plan = NULL;
    return p->context ? plan_of(params, plan) : RP_OK;
}

void sweep_result_of(const run_driver *d, sweep_result *result)
{
    size_t n;
    const exp_end *end = exp_ended(d->run);
    sweep_result_clear(result);
    exp_outputs(d->plan, &n);
    memcpy(result->values, exp_values(d->run), n * sizeof *result->values);
    snprintf(result->status, sizeof result->status, "%s", end->status);
    snprintf(result->message, sizeof result->message, "%s", end->message);
    result->of_measures = end->of_measure;
}

/* ---- the text's parameters and outputs ---- */

static rp_status add_let(experiment *e, const rp_let *let)
{
    rp_param *const p = &e->schema[e->n_lets];
    const bool number = let->is.type == RP_X_NUMBER, word = let->is.type == RP_X_WORD;
    char text[32];
    *p = (rp_param){.name = let->name,
                    .unit = let->unit,
                    .meaning = *let->meaning ? let->meaning : "variable of the experiment",
                    .type = number        ? RP_REAL
                            : !word       ? RP_BOOL
                            : *let->range ? RP_CHOICE
                                          : RP_TEXT,
                    .range = "",
                    .offset = sizeof(slot) * ++e->n_lets, /* behind the experiment */
                    .inherited = true};                   /* streams stay when a text gets one more name */
    if (number) p->range = *let->range ? let->range : "(-inf, inf)";
    if (word) p->range = let->range;
    if (isinf(let->is.value) && number)
        rp_params_text(&(rp_param){.type = RP_REAL, .range = p->range}, &let->is.value, text, sizeof text);
    else
        rp_number_text(let->is.value, 6, text, sizeof text);
    if (let->computed) { /* infinity stands for it, so that no word of the range can */
        const config_setting_t *own = config_lookup(&e->text.config, "let");
        own = config_setting_get_member(own, let->name);
        if (config_setting_is_group(own)) own = config_setting_get_member(own, "value");
        e->keys[p - e->schema] = rp_text(&e->arena, "%s", config_setting_get_string(own));
        p->range = rp_text(&e->arena, "%.*s | %s", (int)strcspn(p->range, ")]") + 1, p->range, COMPUTED);
    }
    p->fallback = let->computed ? COMPUTED
                  : number      ? rp_text(&e->arena, "%s", text)
                  : word        ? rp_text(&e->arena, "%s", let->is.word)
                                : (let->is.value != 0.0 ? "true" : "false");
    return p->fallback && p->range ? RP_OK : RP_NO_MEMORY;
}

/* A column is told from the lets. */
static rp_status check_output(const experiment *e, const sweep_output outputs[], size_t k)
{
    const char *name = outputs[k].name, *path = e->text.path;
    for (const rp_param *p = e->schema; p->name; p++)
        if (sweep_column_is_statistic(p->name, name))
            return rp_fail(RP_BAD_INPUT,
                           "%s: %s is a let, and what a sweep's points call a statistic of the measure %s; "
                           "give one another name",
                           path, p->name, name);
    return RP_OK;
}

/* A measure that is changed is another: what has been stored of it before is left alone. */
static rp_status name_stored(experiment *e, sweep_output outputs[])
{
    exp_measured m;
    char digits[33];
    for (size_t k = 0; k < exp_measure_count(e->plan); k++) {
        RP_TRY(exp_measure_at(e->plan, k, &m));
        rp_hash_digits(m.key, digits);
        for (sweep_output *o = outputs + m.output; o < outputs + m.output + m.n_outputs; o++)
            if (!(o->stored = rp_text(&e->arena, "%s %.16s", o->name, digits))) return RP_NO_MEMORY;
    }
    return RP_OK;
}

static rp_status describe(experiment *e)
{
    const rp_lets *lets = &e->text.lets;
    sweep_output *outputs;
    size_t n, n_keys = 0;
    const exp_output *o = exp_outputs(e->plan, &n);
    if (n > SWEEP_MAX_OUTPUTS)
        return rp_fail(RP_BAD_INPUT, "%s: %zu columns of measures; a sweep has up to %d", e->text.path, n,
                       SWEEP_MAX_OUTPUTS);
    while (dem_named_keys[n_keys].key) n_keys++;
    RP_NEW(&e->arena, e->schema, lets->n + n_keys + 1);
    RP_NEW(&e->arena, e->keys, lets->n + n_keys);
    for (size_t k = 0; k < lets->n; k++) /* a truth or word that is computed is the text's own affair */
        if (!lets->lets[k].computed || lets->lets[k].is.type == RP_X_NUMBER)
            RP_TRY(add_let(e, &lets->lets[k]));
    RP_NEW(&e->arena, outputs, n);
    for (size_t k = 0; k < n; k++) {
        outputs[k] = (sweep_output){o[k].name, o[k].unit, o[k].meaning, NULL};
        RP_TRY(check_output(e, outputs, k));
    }
    RP_TRY(name_stored(e, outputs));
    e->protocol.outputs = outputs;
    e->n_params = e->n_lets;
    e->protocol.schema = e->schema;
    e->protocol.params_size = sizeof(slot) * (1 + e->n_lets + n_keys);
    return RP_OK;
}

/* A sweep's folder keeps all that its runs depend on. */
static rp_status refuse_files(const experiment *e)
{
    static const char *const keys[] = {"particles_file", "contacts_file"};
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        const config_setting_t *setting = config_lookup(&e->text.config, keys[k]);
        if (setting)
            return rp_config_fail(setting, "%s: a text that is swept must be whole in itself", keys[k]);
    }
    return RP_OK;
}

/* Allocated by its protocol's opening; of one that is no text NULL. */
static experiment *open_in(const sweep_protocol *p)
{
    return (experiment *)p->context;
}

rp_status sweep_protocol_open(const sweep_protocol *of, const char *path, const rp_texts *changes,
                              const sweep_protocol **opened)
{
    static const sweep_protocol any = {.name = "experiment", .about = "a scene with phases and measures"};
    *opened = of;
    if (path) of = &any;
    if (!path && !of->text) return RP_OK;
    experiment *e = calloc(1, sizeof *e);
    if (!e) return rp_fail(RP_NO_MEMORY, "experiment: out of memory");
    *opened = &e->protocol;
    e->protocol = (sweep_protocol){
        .name = of->name, .about = of->about, .check = check, .hash = hash, .run = run_one, .context = e};
    path = path ? rp_text(&e->arena, "%s", path) : rp_text(&e->arena, "protocol %s", of->name);
    if (!path) return RP_NO_MEMORY;
    if (!of->text) RP_TRY(rp_file_read(path, &e->bytes));
    RP_TRY(dem_text_open(path, of->text, changes, &e->text));
    if (!exp_has_phases(&e->text))
        return rp_fail(RP_BAD_INPUT, "%s: has no phases; a sweep needs an experiment", path);
    RP_TRY(refuse_files(e));
    RP_TRY(exp_read(&e->text, &e->plan));
    e->protocol.units = rp_config_units(config_root_setting(&e->text.config));
    return describe(e);
}

void sweep_protocol_in(const sweep_protocol *p, rp_units units)
{
    experiment *e = open_in(p);
    if (!p->context || units == p->units) return;
    config_setting_t *root = config_root_setting(&e->text.config),
                     *key = config_setting_get_member(root, "units");
    if (!key) key = config_setting_add(root, "units", CONFIG_TYPE_STRING);
    config_setting_set_string(key, rp_units_word(units)); /* what a key has */
    e->protocol.units = units, e->text.lets.foreign = true;
}

void sweep_protocol_also(const sweep_protocol *p, const char *name)
{
    experiment *e = open_in(p);
    const dem_named_key *k = dem_named_keys;
    while (k->key && strcmp(k->param.name, name) != 0) k++;
    if (!e || !k->key || rp_params_find(e->schema, name)) return;
    e->schema[e->n_params] = k->param;
    e->schema[e->n_params].offset = sizeof(slot) * (1 + e->n_params);
    e->keys[e->n_params++] = k->key;
}

void sweep_protocol_close(const sweep_protocol *p)
{
    experiment *e = p ? open_in(p) : NULL;
    if (!e) return;
    exp_free(e->plan);
    dem_text_close(&e->text);
    rp_arena_end(&e->arena);
    free(e->bytes);
    free(e);
}

const char *sweep_protocol_bytes(const sweep_protocol *p)
{
    return p->context ? open_in(p)->bytes : NULL;
}
