/* Short names for the settings of libconfig. */
#ifndef RP_SETTINGS_H
#define RP_SETTINGS_H

#include <libconfig.h>

#define member(group, name) config_setting_get_member(group, name)

static inline const config_setting_t *element(const config_setting_t *list, size_t i)
{
    return config_setting_get_elem(list, (unsigned)i);
}

static inline size_t length(const config_setting_t *list)
{
    return list ? (size_t)config_setting_length(list) : 0;
}

#endif
