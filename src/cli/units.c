/* Warnings of values that are of another system of units; see cli.h. */
#include "cli/cli.h"
#include "core/config.h"
#include "core/units.h"

void cli_warn_gravity(const char *path, double g)
{
    if (rp_units_now() == RP_CGS && g > 9.7 && g < 9.9)
        fprintf(stderr,
                "repose: warning: %s: g = %g among values in cm, g and s; give units = \"si\", or g = %g\n",
                path, g, 100.0 * g);
}

static void warn_of(const char *path, const config_setting_t *group)
{
    const config_setting_t *g = group ? config_setting_get_member(group, "g") : NULL;
    if (g)
        cli_warn_gravity(path, config_setting_is_aggregate(g) ? config_setting_get_float_elem(g, 0)
                                                              : config_setting_get_float(g));
}

void cli_warn_sweep(const char *path)
{
    config_t config;
    if (rp_config_read(path, &config) == RP_OK) {
        const config_setting_t *root = config_root_setting(&config),
                               *grid = config_setting_get_member(root, "grid");
        warn_of(path, config_setting_get_member(root, "fixed"));
        if (grid && config_setting_is_group(grid)) warn_of(path, grid);
        for (int i = 0; grid && config_setting_is_list(grid) && i < config_setting_length(grid); i++)
            warn_of(path, config_setting_get_elem(grid, (unsigned)i));
    }
    config_destroy(&config);
}
