/* Writing texts with the values that were given. */
#include <string.h>

#include "dem/scene/file.h"

void dem_text_write(const dem_text *text, unsigned long seed, unsigned long stream, FILE *out)
{
    const config_setting_t *root = config_root_setting(&text->config);
    fprintf(out, "seed = %lu;\nrun = %lu;\n", seed, stream);
    for (size_t i = 0; i < length(root); i++) {
        const config_setting_t *s = element(root, i);
        const char *name = config_setting_name(s);
        const bool let = strcmp(name, "let") == 0;
        if (strcmp(name, "seed") == 0 || strcmp(name, "run") == 0) continue;
        fprintf(out, let ? "%s = {\n" : "%s = ", name);
        for (size_t k = 0; k < length(s) && let; k++) {
            fprintf(out, "  %s = ", config_setting_name(element(s, k)));
            rp_config_write_value(out, element(s, k));
            fputs(";\n", out);
        }
        let ? (void)fputc('}', out) : rp_config_write_value(out, s);
        fputs(";\n", out);
    }
}
