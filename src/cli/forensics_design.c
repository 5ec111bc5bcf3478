/* The grid of a design: settings of all open choices, and the points of the published numbers; see
 * forensics.h. */
#include <math.h>
#include <string.h>

#include "cli/cli.h"
#include "cli/forensics.h"

/* Choices without a scale, with the values that a sweep file has. */
static const struct {
    const char *key, *values;
} factors[] = {{"floor", "\"extends\" | \"ends\" | \"absorbs\""},
               {"slip", "\"truncated\" | \"total\""},
               {"tension", "true | false"},
               {"damping", "\"outside\" | \"inside\""},
               {"integrator", "\"verlet\" | \"gear5\""},
               {"fill", "\"drop\" | \"ramp\""},
               {"k_n_wall", "\"auto\" | 2e6"}};
enum { N_FACTORS = N_OF(factors), WORD = 32 };

/* Part of the time-step limit that a design takes. */
static const double step_part = 0.9;

static size_t count_words(const char *list)
{
    char text[WORD];
    int n = 0;
    while (*rp_word_at(list, n, text, WORD)) n++;
    return (size_t)n;
}

/* Set a factor; a text's quotes are the file's. */
static rp_status set_factor(void *params, size_t f, size_t level)
{
    char text[WORD], *word = text;
    rp_word_at(factors[f].values, (int)level, text, WORD);
    if (*word == '"') {
        word++;
        word[strlen(word) - 1] = '\0';
    }
    return repose_params_set(params, factors[f].key, word);
}

/* The word of a setting's factor: that which sets the same value. */
static rp_status find_word(const void *params, size_t f, void *work, char word[WORD])
{
    const rp_param *param = rp_params_find(sweep_protocol_repose.schema, factors[f].key);
    char own[64], text[64];
    rp_params_text(param, params, own, sizeof own);
    for (size_t level = 0; *rp_word_at(factors[f].values, (int)level, word, WORD); level++) {
        RP_TRY(set_factor(work, f, level));
        if (strcmp(rp_params_text(param, work, text, sizeof text), own) == 0) return RP_OK;
    }
    return rp_fail(RP_BAD_INPUT, "%s = %s: no level of a design, allowed: %s", factors[f].key, own,
                   factors[f].values);
}

/* Choices with a scale; the other groups follow from the point. */
static bool is_open(size_t group)
{
    return sweep_groups[group].lo < sweep_groups[group].hi;
}

/* The parameters of one setting: its time step is that which all points allow, to two digits. */
static rp_status find_setting(const forensics_claims *claims, const double group[], void *params, void *work)
{
    double limit = INFINITY;
    sweep_groups_apply(group, params);
    for (size_t k = 0; k < claims->n_points; k++) {
        repose_params_copy(work, params);
        RP_TRY(repose_params_at(work, &claims->points[k]));
        limit = fmin(limit, step_part * sweep_repose_step_limit(work));
    }
    const double digit = pow(10.0, floor(log10(limit)) - 1.0);
    char text[WORD];
    snprintf(text, sizeof text, "%.6g", floor(limit / digit) * digit);
    RP_TRY(repose_params_set(params, "dt", text));
    sweep_groups_apply(group, params);
    return RP_OK;
}

/* One list of the grid, of n texts. */
static void print_list(const char *key, size_t n, char (*text)[WORD])
{
    const int width = 110;
    int at = printf("      %s = (", key);
    for (size_t i = 0; i < n; i++) {
        if (at + (int)strlen(text[i]) + 3 > width) at = printf("\n         ") - 1;
        at += printf(" %s%s", text[i], i + 1 < n ? "," : " );\n");
    }
}

/* Values of the keys that follow from the groups; every text with six digits at most. */
static void print_keys(size_t n, void *params[])
{
    char keys[] = SWEEP_GROUP_KEYS, *rest = keys, *key;
    char(*text)[WORD] = cli_memory(n, sizeof *text);
    while ((key = strsep(&rest, ","))) {
        const rp_param *param = rp_params_find(sweep_protocol_repose.schema, key);
        for (size_t i = 0; i < n; i++) {
            const char *value = (const char *)params[i] + param->offset;
            char own[WORD], *end;
            strtod(rp_params_text(param, params[i], own, sizeof own), &end);
            if (*end)
                snprintf(text[i], WORD, "\"%.*s\"", WORD - 3, own); /* a word in place of a number */
            else if (param->type == RP_INT)
                snprintf(text[i], WORD, "%ld", *(const long *)(const void *)value);
            else
                snprintf(text[i], WORD, "%.5g", *(const double *)(const void *)value);
        }
        print_list(key, n, text);
    }
}

/* Keys of the header line `at`, as lists that go together. */
static void print_points(const forensics_claims *claims)
{
    char(*text)[WORD] = cli_memory(claims->n_points, sizeof *text);
    for (int k = 0; k < claims->points[0].n; k++) {
        char key[64];
        const char *word = claims->points[0].words[k];
        snprintf(key, sizeof key, "%.*s", (int)strcspn(word, "="), word);
        const rp_param *param = rp_params_find(sweep_protocol_repose.schema, key);
        const bool quoted = param->type == RP_CHOICE;
        for (size_t i = 0; i < claims->n_points; i++)
            snprintf(text[i], WORD, quoted ? "\"%s\"" : "%s", strchr(claims->points[i].words[k], '=') + 1);
        print_list(key, claims->n_points, text);
    }
}

rp_status forensics_design(const forensics_claims *claims, size_t n, gsl_rng *rng, forensics_settings *d)
{
    size_t n_open = 0, n_levels[N_FACTORS];
    for (size_t g = 0; g < SWEEP_N_GROUPS; g++) n_open += is_open(g);
    for (size_t f = 0; f < N_FACTORS; f++) n_levels[f] = count_words(factors[f].values);
    double *u = cli_memory(n * n_open, sizeof *u);
    size_t *level = cli_memory(n * N_FACTORS, sizeof *level);
    *d = (forensics_settings){n, cli_memory(n * SWEEP_N_GROUPS, sizeof *d->group),
                              cli_memory(n, sizeof *d->params), NULL};
    RP_TRY(stats_design(n, n_open, u, N_FACTORS, n_levels, level, rng));
    for (size_t i = 0; i < n; i++) {
        d->params[i] = repose_params_new();
        for (size_t g = 0; g < SWEEP_N_GROUPS; g++) {
            const double lo = forensics_scaled(g, sweep_groups[g].lo),
                         hi = forensics_scaled(g, sweep_groups[g].hi);
            d->group[i * SWEEP_N_GROUPS + g] =
                is_open(g) ? forensics_unscaled(g, lo + (hi - lo) * *u++) : INFINITY;
        }
        RP_TRY(repose_params_at(d->params[i], &claims->usual));
        for (size_t f = 0; f < N_FACTORS; f++) RP_TRY(set_factor(d->params[i], f, level[f * n + i]));
    }
    return RP_OK;
}

/* A factor that the runs of a study do not vary is none of its choices. */
static bool has_factor(const forensics_study *s, const char *key)
{
    bool has = !s;
    for (size_t f = 0; s && f < s->n_factors; f++) has |= strcmp(s->factors[f].name, key) == 0;
    return has;
}

rp_status forensics_design_print(const forensics_claims *claims, const forensics_settings *d)
{
    char(*text)[WORD] = cli_memory(d->n, sizeof *text);
    void *work = repose_params_new();
    for (size_t i = 0; i < d->n; i++)
        RP_TRY(find_setting(claims, d->group + i * SWEEP_N_GROUPS, d->params[i], work));
    puts("grid = (\n    {");
    for (size_t f = 0; f < N_FACTORS; f++) {
        if (!has_factor(d->study, factors[f].key)) continue;
        for (size_t i = 0; i < d->n; i++) RP_TRY(find_word(d->params[i], f, work, text[i]));
        print_list(factors[f].key, d->n, text);
    }
    print_keys(d->n, d->params);
    puts("    },\n    {");
    print_points(claims);
    puts("    }\n);");
    return RP_OK;
}
