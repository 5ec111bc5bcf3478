/* Published numbers of report/claims.tsv, and parameters at their points; see forensics.h. */
#include <string.h>

#include "report/claims.h"
#include "cli/cli.h"
#include "cli/forensics.h"

/* The usual values of the keys, but for the words first <= w < last. */
static rp_status find_point(const cli_words *usual, const cli_words *words, int first, int last,
                            cli_words *point)
{
    char text[CLI_MAX_REFERENCE] = "";
    for (int k = 0; k < usual->n; k++) {
        const char *value = usual->words[k];
        const size_t length = strcspn(value, "=") + 1;
        for (int w = first; w < last; w++)
            if (strncmp(words->words[w], usual->words[k], length) == 0) value = words->words[w];
        if (strlen(text) + strlen(value) + 2 > sizeof text) return rp_fail(RP_BAD_INPUT, "too long");
        strcat(strcat(text, k ? " " : ""), value);
    }
    for (int w = first; w < last; w++) {
        bool known = false;
        const size_t length = strcspn(words->words[w], "=") + 1;
        for (int k = 0; k < usual->n; k++) known |= strncmp(words->words[w], usual->words[k], length) == 0;
        if (!known)
            return rp_fail(RP_BAD_INPUT, "\"%s\": not among the keys of the header line `at`",
                           words->words[w]);
    }
    return cli_split(text, point);
}

static bool same_point(const cli_words *a, const cli_words *b)
{
    for (int k = 0; k < a->n; k++)
        if (strcmp(a->words[k], b->words[k]) != 0) return false;
    return true;
}

static rp_status add_point(forensics_claims *all, const cli_words *words, int first, size_t *index)
{
    cli_words *next = &all->points[all->n_points];
    RP_TRY(find_point(&all->usual, words, first, words->n, next));
    for (*index = 0; *index < all->n_points; ++*index)
        if (same_point(&all->points[*index], next)) return RP_OK;
    all->n_points++;
    return RP_OK;
}

static rp_status add_stem(forensics_claims *all, const char *stem, bool held, size_t *index)
{
    for (*index = 0; *index < all->n_stems; ++*index)
        if (strcmp(all->stems[*index], stem) == 0) break;
    if (!held && *index > 0)
        return rp_fail(RP_BAD_INPUT, "%s: all numbers that are not held out are of one column, %s", stem,
                       all->stems[0]);
    if (*index < all->n_stems) return RP_OK;
    if (all->n_stems == FORENSICS_STEMS)
        return rp_fail(RP_BAD_INPUT, "%s: at most %d columns", stem, FORENSICS_STEMS);
    snprintf(all->stems[all->n_stems++], sizeof *all->stems, "%s", stem);
    return RP_OK;
}

static rp_status add_claim(forensics_claims *all, const cli_claim *c, bool held, const cli_words *words)
{
    if (all->n == FORENSICS_CLAIMS) return rp_fail(RP_BAD_INPUT, "at most %d claims", FORENSICS_CLAIMS);
    if (held >= words->n) return rp_fail(RP_BAD_INPUT, "\"%s\": a column expected", c->forensics);
    if (!(c->published.se > 0.0 && c->samples >= 1.0))
        return rp_fail(RP_BAD_INPUT, "a published number with its error and number of samples expected");
    forensics_claim *claim = &all->claims[all->n];
    snprintf(claim->name, sizeof claim->name, "%s", c->id);
    claim->held = held;
    claim->published = (stats_published){c->published.value * deg, c->published.se * deg, c->samples};
    rp_status status = add_stem(all, words->words[held], held, &claim->stem);
    if (!status) status = add_point(all, words, held + 1, &claim->point);
    all->n++;
    return status;
}

/* Numbers that are held out come last: the first stem is that of the others. */
static rp_status read_claims(const cli_claims *table, bool held, forensics_claims *all)
{
    for (size_t i = 0; i < table->n; i++) {
        const cli_claim *c = &table->claims[i];
        cli_words words;
        if (!*c->forensics) continue;
        rp_status status = cli_split(c->forensics, &words);
        const bool own = !status && strcmp(words.words[0], "held") == 0;
        if (!status && own == held) status = add_claim(all, c, held, &words);
        RP_TRY(rp_prefix(status, "%s: claim %s: ", table->table->path, c->id));
    }
    return RP_OK;
}

rp_status forensics_claims_read(const char *path, forensics_claims *all)
{
    cli_claims table;
    void *params = repose_params_new();
    *all = (forensics_claims){0};
    RP_TRY(cli_claims_read(path, &table));
    const char *at = rp_table_find_note(table.table, "at");
    if (!at) return rp_fail(RP_BAD_INPUT, "%s: no header line \"at\"", path);
    RP_TRY(cli_split(at, &all->usual));
    RP_TRY(rp_prefix(repose_params_at(params, &all->usual), "%s: at: ", path));
    RP_TRY(read_claims(&table, false, all));
    if (all->n == 0) return rp_fail(RP_NO_RESULT, "%s: no claims", path);
    return read_claims(&table, true, all);
}

/* ---- parameters ---- */

void *repose_params_new(void)
{
    void *params = cli_memory(1, sweep_protocol_repose.params_size);
    rp_params_defaults(sweep_protocol_repose.schema, params);
    return params;
}

void repose_params_copy(void *to, const void *from)
{
    memcpy(to, from, sweep_protocol_repose.params_size);
}

rp_status repose_params_set(void *params, const char *name, const char *value)
{
    const rp_param *param = rp_params_find(sweep_protocol_repose.schema, name);
    return param ? rp_params_set_text(param, params, value)
                 : rp_fail(RP_BAD_INPUT, "%s: no parameter of repose", name);
}

rp_status repose_params_at(void *params, const cli_words *point)
{
    for (int k = 0; k < point->n; k++) {
        char name[64];
        const char *equals = strchr(point->words[k], '=');
        if (!equals) return rp_fail(RP_BAD_INPUT, "\"%s\": key=value expected", point->words[k]);
        snprintf(name, sizeof name, "%.*s", (int)(equals - point->words[k]), point->words[k]);
        RP_TRY(repose_params_set(params, name, equals + 1));
    }
    return RP_OK;
}
