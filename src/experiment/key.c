/* The keys of a run and of its measures: hashes of what the text says about them. */
#include <stdlib.h>
#include <string.h>

#include "experiment/plan.h"
#include "params/config.h"
#include "params/settings.h"

/* Settings of a text that change no number of a run: its streams, which a key has beside it, tables, ways to
 * the same bits; and files, of which a key has what is in them. */
static const char no_physics[] =
    "seed run ledger kernel output particles_file particles_step contacts_file measure";

static void put(FILE *out, const config_setting_t *setting)
{
    fprintf(out, "%s = ", config_setting_name(setting));
    rp_config_write_key(out, setting);
    fputs(";\n", out);
}

/* Values, without unit, range and meaning. */
static void put_lets(FILE *out, const config_setting_t *lets)
{
    for (size_t k = 0; k < length(lets); k++) {
        const config_setting_t *let = element(lets, k);
        fprintf(out, "let %s = ", config_setting_name(let));
        rp_config_write_key(out, config_setting_is_group(let) ? member(let, "value") : let);
        fputs(";\n", out);
    }
}

static void put_measure(FILE *out, const config_setting_t *measure)
{
    for (size_t k = 0; k < length(measure); k++)
        if (rp_word_index("unit meaning series", config_setting_name(element(measure, k))) < 0)
            put(out, element(measure, k));
}

static void put_files(FILE *out, const dem_scene *scene)
{
    const dem_definition *def = &scene->def;
    for (const dem_grain *g = scene->grains; *scene->particles_file && g < scene->grains + def->n_grains;
         g++) {
        fwrite(g, offsetof(dem_grain, fixed), 1, out), fputc(g->fixed, out);
        if (g->kind > 0) fputs(def->kinds[g->kind].name, out);
    }
    for (const dem_contact *c = def->contacts; def->n_contacts && c < def->contacts + def->n_contacts; c++)
        fprintf(out, "spring %u %u %d %a %a\n", c->id_a, c->id_b, c->wall, c->shear_spring,
                c->rolling_spring);
}

/* A run that asks what is measured depends on all measures; so does one that asks what each look may change.
 */
static bool is_led_by_measures(const exp_plan *plan)
{
    return plan->asks_measures || exp_names(plan, "touched") || exp_names(plan, "tilt_deg");
}

/* A text in the making, and its hash, which frees it. */
typedef struct {
    char *bytes;
    size_t size;
    FILE *out;
} text;

static rp_status begin(text *t)
{
    *t = (text){0};
    t->out = open_memstream(&t->bytes, &t->size);
    return t->out ? RP_OK : rp_fail(RP_NO_MEMORY, "key: out of memory");
}

static XXH128_hash_t end(text *t)
{
    fclose(t->out);
    const XXH128_hash_t hash = XXH3_128bits(t->bytes, t->size);
    free(t->bytes);
    return hash;
}

rp_status exp_key(const exp_plan *plan, XXH128_hash_t *key)
{
    const config_setting_t *root = config_root_setting(&plan->text->config), *list = member(root, "measure");
    text t;
    RP_TRY(begin(&t));
    for (size_t k = 0; k < length(root); k++) {
        const config_setting_t *setting = element(root, k);
        const char *name = config_setting_name(setting);
        if (strcmp(name, "let") == 0)
            put_lets(t.out, setting);
        else if (rp_word_index(no_physics, name) < 0)
            put(t.out, setting);
    }
    put_files(t.out, &plan->scene);
    for (size_t k = 0; k < length(list) && is_led_by_measures(plan); k++)
        put_measure(t.out, element(list, k));
    *key = end(&t);
    return RP_OK;
}

static rp_status measure_key(const exp_plan *plan, const exp_measure *m, XXH128_hash_t *key);

/* The measures whose outputs an expression asks: earlier ones alone. */
static rp_status put_asked(const exp_plan *plan, const exp_expression *e, FILE *out)
{
    XXH128_hash_t key;
    int id;
    for (size_t k = 0; (id = rp_expression_asks(&e->x, k)) >= 0; k++)
        for (const exp_measure *m = plan->measures;
             id >= EXP_ID_MEASURE && m < plan->measures + plan->n_measures; m++) {
            if ((size_t)(id - EXP_ID_MEASURE) - m->output >= m->n_outputs) continue;
            RP_TRY(measure_key(plan, m, &key));
            fwrite(&key, sizeof key, 1, out);
        }
    return RP_OK;
}

static rp_status measure_key(const exp_plan *plan, const exp_measure *m, XXH128_hash_t *key)
{
    const exp_expression *const asking[] = {&m->of, &m->when, &m->event, &m->against};
    const exp_measure *level = &plan->measures[m->levels_with];
    rp_status status = RP_OK;
    text t;
    RP_TRY(begin(&t));
    put_measure(t.out, m->setting);
    for (size_t k = 0; k < sizeof asking / sizeof *asking && !status; k++)
        status = put_asked(plan, asking[k], t.out);
    if (!status && *m->level_of && level != m) {
        status = measure_key(plan, level, key);
        fwrite(key, sizeof *key, 1, t.out);
    }
    *key = end(&t);
    return status;
}

size_t exp_measure_count(const exp_plan *plan)
{
    return plan->n_measures;
}

rp_status exp_measure_at(const exp_plan *plan, size_t k, exp_measured *measured)
{
    const exp_measure *m = &plan->measures[k];
    *measured = (exp_measured){.output = m->output, .n_outputs = m->n_outputs, .series = m->series};
    return m->left_out ? RP_OK : measure_key(plan, m, &measured->key);
}
