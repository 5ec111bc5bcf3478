/* What a sweep's file says of its tables; see sweep.h. */
#include "sweeps/driver/private.h"

#include <string.h>

#include "core/config.h"

/* "lh3_phi = angle phi @/lh3_runs.tsv" */
static rp_status read_table(const config_setting_t *setting, sweep_recipe *recipe)
{
    const char *text = config_setting_get_string(setting), *equals = text ? strstr(text, " = ") : NULL;
    const size_t length = strlen(recipe->name);
    sweep_table *table = &recipe->tables[recipe->n_tables];
    if (!equals) return rp_config_fail(setting, "tables: \"NAME = COMMAND\" expected");
    if (recipe->n_tables == SWEEP_MAX_TABLES || (size_t)(equals - text) >= sizeof table->name)
        return rp_config_fail(setting, "tables: at most %d, of names shorter than %zu", SWEEP_MAX_TABLES,
                              sizeof table->name);
    snprintf(table->name, sizeof table->name, "%.*s", (int)(equals - text), text);
    table->command = equals + strlen(" = ");
    if (strncmp(table->name, recipe->name, length) != 0 ||
        (table->name[length] && table->name[length] != '_') || strchr(table->name, '/'))
        return rp_config_fail(setting, "tables: %s: the name of a table must begin with %s_", table->name,
                              recipe->name);
    recipe->n_tables++;
    return RP_OK;
}

static rp_status read_tables(const config_setting_t *list, sweep_recipe *recipe)
{
    if (!config_setting_is_array(list) && !config_setting_is_list(list))
        return rp_config_fail(list, "tables: a list [ \"NAME = COMMAND\", ... ] expected");
    for (int i = 0; i < config_setting_length(list); i++)
        RP_TRY(read_table(config_setting_get_elem(list, (unsigned)i), recipe));
    return RP_OK;
}

rp_status sweep_recipe_read(const char *file, sweep_recipe *recipe)
{
    *recipe = (sweep_recipe){0};
    const char *base = basename(file); /* "lh3" of sweeps/lh/lh3.cfg */
    snprintf(recipe->name, sizeof recipe->name, "%.*s", (int)strcspn(base, "."), base);
    RP_TRY(rp_config_read(file, &recipe->config));
    const config_setting_t *root = config_root_setting(&recipe->config),
                           *tables = config_setting_get_member(root, "tables");
    int replicas = 0;
    recipe->has_runs = config_setting_get_member(root, "protocol") != NULL;
    if (config_setting_lookup_int(root, "study", &replicas) && replicas > 0) recipe->study = (size_t)replicas;
    RP_TRY(sweep_refuse_scene(file, root));
    if (tables) return read_tables(tables, recipe);
    return recipe->has_runs ? RP_OK : rp_fail(RP_BAD_INPUT, "%s: neither a protocol nor tables", file);
}

void sweep_recipe_free(sweep_recipe *recipe)
{
    config_destroy(&recipe->config);
}
