/* Parameter files: libconfig syntax, read through a schema, every error with file, line, key and value. */
#ifndef RP_CONFIG_H
#define RP_CONFIG_H

#include <libconfig.h>
#include <stdbool.h>
#include <stdio.h>

#include "params/params.h"

/* Read a file. Afterwards config_destroy(config), also after an error.
 * Errors: RP_BAD_INPUT (missing file, syntax, whole number above 2^31 - 1, too large). */
rp_status rp_config_read(const char *path, config_t *config);

/* The same of a text that is there; its errors name it so. */
rp_status rp_config_read_text(const char *name, const char *text, config_t *config);

/* Refuse what libconfig would read wrong or without end: a whole number that does not fit an int, or a long
 * one (5L) a long long; a text or comment without its end; more than 64 MB, 65536 bytes in a text, comment or
 * gap, 1000 keys in a group, 31 levels; other files. `name` of a text: for messages. Errors: RP_BAD_INPUT. */
rp_status rp_config_scan_file(const char *path);
rp_status rp_config_scan_text(const char *name, const char *text);

/* The units of the numbers in a setting's text, its key `units`: cgs where it has none. */
rp_units rp_config_units(const config_setting_t *setting);

/* Read the settings of `group` into `values`, which must hold defaults. Keys that are neither in the
 * schema nor in `others` ("a b c", may be NULL; left to the caller) are errors. A required parameter that is
 * missing is an error. Texts are borrowed from the config. Errors: RP_BAD_INPUT. */
rp_status rp_config_group(const config_setting_t *group, const rp_param *schema, void *values,
                          const char *others);

/* Read those keys ("a b", NULL: all) of a schema that stand in a group, whatever else does: of a part of it,
 * or before the group is read, whose others may be written with them. Errors: RP_BAD_INPUT. */
rp_status rp_config_peek(const config_setting_t *group, const rp_param *schema, const char *keys,
                         void *values);

/* The error of a key that the schema and `others` do not have: its path, the nearest key, those that are
 * allowed, and `more`. */
rp_status rp_config_unknown(const config_setting_t *setting, const rp_param *schema, const char *others,
                            const char *more);

/* Store one setting in its parameter, a list of texts in one of RP_TEXTS. Errors: RP_BAD_INPUT. */
rp_status rp_config_value(const config_setting_t *setting, const rp_param *param, void *values);

/* Of names in a text. */
#define RP_NAME_LETTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_"

/* A text in quotes; a setting's value, as it is read back to the bit. */
void rp_config_write_text(FILE *out, const char *text);
void rp_config_write_value(FILE *out, const config_setting_t *setting);

/* The same for keys: however its numbers are typed. */
void rp_config_write_key(FILE *out, const config_setting_t *setting);

/* An RP_BAD_INPUT failure that starts with the setting's file and line. */
rp_status rp_config_fail(const config_setting_t *setting, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* A value as it stands; texts are borrowed. Errors: RP_BAD_INPUT, without a message, for a list or group. */
rp_status rp_config_scalar(const config_setting_t *setting, rp_value *value);

/* Two finite numbers, as in [0.0, 1.0]. Errors: RP_BAD_INPUT. */
rp_status rp_config_pair(const config_setting_t *setting, double pair[2]);

/* The same of n = 2 or 3 numbers; unless `finite`, "inf" and "-inf" stand for an end that is open. */
rp_status rp_config_numbers(const config_setting_t *setting, int n, bool finite, double *numbers);

#endif
