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

static rp_status read_tables(const config_setting_t *group, sweep_recipe *recipe)
{
    const size_t n = (size_t)config_setting_length(group), length = strlen(recipe->name);
    recipe->tables = calloc(n + 1, sizeof *recipe->tables);
    if (!recipe->tables) return rp_fail(RP_NO_MEMORY, "tables: out of memory");
    for (unsigned i = 0; i < n; i++) {
        const config_setting_t *table = config_setting_get_elem(group, i);
        const char *name = config_setting_name(table), *command = config_setting_get_string(table);
        if (!command)
            return rp_config_fail(table, "%s: a command expected, such as \"stats trend ...\"", name);
        if (strncmp(name, recipe->name, length) != 0 || (name[length] && name[length] != '_'))
            return rp_config_fail(table, "%s: the table's name must begin with %s_", name, recipe->name);
        recipe->tables[i].name = strdup(name);
        recipe->tables[i].command = strdup(command);
        if (!recipe->tables[i].name || !recipe->tables[i].command)
            return rp_fail(RP_NO_MEMORY, "tables: out of memory");
        recipe->n_tables++;
    }
    return RP_OK;
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
        if (tables && !config_setting_is_group(tables))
            status = rp_config_fail(tables, "tables: a group { NAME = \"COMMAND\"; ... } expected");
        else if (tables)
            status = read_tables(tables, recipe);
        else if (!recipe->has_runs)
            status = rp_fail(RP_BAD_INPUT, "%s: neither a protocol nor tables", file);
    }
    config_destroy(&config);
    return status;
}

void sweep_recipe_free(sweep_recipe *recipe)
{
    for (size_t i = 0; recipe->tables && i <= recipe->n_tables; i++) {
        free(recipe->tables[i].name);
        free(recipe->tables[i].command);
    }
    free(recipe->tables);
}
