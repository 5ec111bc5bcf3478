/* What a sweep's file says of its tables; see sweep.h. */
#include "sweeps/driver/private.h"

#include <stdlib.h>
#include <string.h>

#include "core/config.h"

/* "lh3" of sweeps/lh/lh3.cfg. */
static void base_name(const char *file, char *name, size_t size)
{
    const char *slash = strrchr(file, '/'), *base = slash ? slash + 1 : file;
    snprintf(name, size, "%.*s", (int)strcspn(base, "."), base);
}

/* "lh3_phi = angle phi @/lh3_runs.tsv" */
static rp_status read_table(const config_setting_t *setting, const char *sweep, sweep_table *table)
{
    const char *text = config_setting_get_string(setting), *equals = text ? strstr(text, " = ") : NULL;
    const size_t length = strlen(sweep);
    if (!equals) return rp_config_fail(setting, "tables: \"NAME = COMMAND\" expected");
    table->name = strndup(text, (size_t)(equals - text));
    table->command = strdup(equals + strlen(" = "));
    if (!table->name || !table->command) return rp_fail(RP_NO_MEMORY, "tables: out of memory");
    if (strncmp(table->name, sweep, length) != 0 || (table->name[length] && table->name[length] != '_') ||
        strchr(table->name, '/'))
        return rp_config_fail(setting, "tables: %s: the name of a table must begin with %s_", table->name,
                              sweep);
    return RP_OK;
}

static rp_status read_tables(const config_setting_t *list, sweep_recipe *recipe)
{
    if (!config_setting_is_array(list) && !config_setting_is_list(list))
        return rp_config_fail(list, "tables: a list [ \"NAME = COMMAND\", ... ] expected");
    const size_t n = (size_t)config_setting_length(list);
    rp_status status = RP_OK;
    recipe->tables = calloc(n + 1, sizeof *recipe->tables);
    if (!recipe->tables) return rp_fail(RP_NO_MEMORY, "tables: out of memory");
    for (size_t i = 0; !status && i < n; i++)
        status = read_table(config_setting_get_elem(list, (unsigned)i), recipe->name,
                            &recipe->tables[recipe->n_tables++]);
    return status;
}

rp_status sweep_recipe_read(const char *file, sweep_recipe *recipe)
{
    config_t config;
    *recipe = (sweep_recipe){0};
    base_name(file, recipe->name, sizeof recipe->name);
    rp_status status = rp_config_read(file, &config);
    if (!status) {
        const config_setting_t *root = config_root_setting(&config),
                               *tables = config_setting_get_member(root, "tables");
        int replicas = 0;
        recipe->has_runs = config_setting_get_member(root, "protocol") != NULL;
        recipe->study =
            config_setting_lookup_int(root, "study", &replicas) && replicas > 0 ? (size_t)replicas : 0;
        if (tables)
            status = read_tables(tables, recipe);
        else if (!recipe->has_runs)
            status = rp_fail(RP_BAD_INPUT, "%s: neither a protocol nor tables", file);
    }
    config_destroy(&config);
    return status;
}

void sweep_recipe_free(sweep_recipe *recipe)
{
    for (size_t i = 0; i < recipe->n_tables; i++) {
        free(recipe->tables[i].name);
        free(recipe->tables[i].command);
    }
    free(recipe->tables);
}
