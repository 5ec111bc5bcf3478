/* Sweeps behind a claim, and their failed runs; see lineage.h. */
#include "report/lineage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the sweeps behind a table ---- */

/* The sweep NAME; NULL where there is no such table, or one that is no sweep's. */
static report_sweep *find_sweep(report_tables *tables, const char *name)
{
    const rp_table *t;
    if (report_table(tables, name, &t) || !t || !rp_table_find_note(t, "sweep")) return NULL;
    const char *failed = rp_table_find_note(t, "failed");
    report_sweep *sweep = rp_arena_memory(tables->arena, 1, sizeof *sweep);
    *sweep = (report_sweep){name, failed && strtod(failed, NULL) > 0.0 ? failed : "", t, NULL, NULL};
    return sweep;
}

/* The same of NAME or NAME_*, the longest such name. */
static report_sweep *find_own_sweep(report_tables *tables, const char *table)
{
    char *name = rp_text(tables->arena, "%s", table);
    for (char *end = name + strlen(name); end; end = strrchr(name, '_')) {
        *end = '\0';
        report_sweep *sweep = find_sweep(tables, name);
        if (sweep) return sweep;
    }
    return NULL;
}

/* "FOLDER/NAME_runs.tsv" or "FOLDER/NAME.tsv" is the sweep NAME. */
static report_sweep *find_source(report_tables *tables, const char *word)
{
    const char *slash = strrchr(word, '/');
    char *name = rp_text(tables->arena, "%s", slash ? slash + 1 : word), *end = strstr(name, ".tsv");
    if (!end || strcmp(end, ".tsv") != 0) return NULL;
    *end = '\0';
    end = strrchr(name, '_');
    if (end && strcmp(end, "_runs") == 0) *end = '\0';
    return find_sweep(tables, name);
}

/* What follows a word of a command; NULL without this word. */
static char *word_after(const report_words *command, const char *word)
{
    for (int i = 0; i + 1 < command->n; i++)
        if (strcmp(command->word[i], word) == 0) return command->word[i + 1];
    return NULL;
}

/* ---- the grid points that a cell reads ---- */

/* key=value chooses rows of a sweep by its columns; a row of all, and an extreme of a derived table, do not.
 */
static rp_status word_matches(const rp_table *t, size_t row, char *word, bool *matches)
{
    char *equals = strchr(word, '=');
    *matches = true;
    if (!equals || strcmp(equals, "=nan") == 0) return RP_OK;
    *equals = '\0';
    const bool known = rp_table_column(t, word) >= 0;
    *equals = '=';
    return known ? report_row_matches(t, row, 1, &word, matches) : RP_OK;
}

/* The number in a cell of a sweep; NaN without such a column. */
static double number_at(const rp_table *t, size_t row, const char *name)
{
    const int column = name ? rp_table_column(t, name) : -1;
    return column < 0 ? NAN : strtod(t->cells[row * t->n_columns + (size_t)column], NULL);
}

/* A fit reads the range --from, --to of its x. */
static bool within_range(const rp_table *t, size_t row, const report_words *command)
{
    const char *from = word_after(command, "--from"), *to = word_after(command, "--to");
    const double x = number_at(t, row, word_after(command, "--x"));
    return !(from && x < strtod(from, NULL)) && !(to && x > strtod(to, NULL));
}

/* The rows that the words and the command choose. Points without any result enter no mean: only a cell of
 * the sweep itself reads them. */
static rp_status mark_rows(report_sweep *sweep, const report_words *reference, const report_words *command)
{
    const rp_table *t = sweep->table;
    const bool itself = strcmp(reference->word[0], sweep->name) == 0;
    char *where = word_after(command, "--where");
    for (size_t row = 0; row < t->n_rows; row++) {
        bool matches = itself || (within_range(t, row, command) && number_at(t, row, "n") > 0.0);
        if (matches && where && !itself) RP_TRY(word_matches(t, row, where, &matches));
        for (int w = 1; w < reference->n - 1 && matches; w++)
            RP_TRY(word_matches(t, row, reference->word[w], &matches));
        sweep->counted[row] |= matches;
    }
    return RP_OK;
}

/* Add a sweep at the end of the list, once, and mark its rows. */
static rp_status add_sweep(rp_arena *arena, report_sweep **list, report_sweep *sweep,
                           const report_words *reference, const report_words *command)
{
    while (*list && strcmp((*list)->name, sweep->name) != 0) list = &(*list)->next;
    if (!*list) {
        sweep->counted = rp_arena_memory(arena, sweep->table->n_rows, sizeof(bool));
        *list = sweep;
    }
    return mark_rows(*list, reference, command);
}

static rp_status add_reference(report_tables *tables, const char *text, report_sweep **list)
{
    const rp_table *table;
    const report_words reference = report_split(tables->arena, text);
    bool any = false;
    if (reference.n < 2) return RP_OK;
    RP_TRY(report_table(tables, reference.word[0], &table));
    if (!table) return RP_OK;
    const char *line = rp_table_find_note(table, "command");
    const report_words command = report_split(tables->arena, line ? line : "");
    for (int i = 0; i < command.n; i++) {
        report_sweep *sweep = find_source(tables, command.word[i]);
        if (sweep) RP_TRY(add_sweep(tables->arena, list, sweep, &reference, &command));
        any |= sweep != NULL;
    }
    report_sweep *own = any ? NULL : find_own_sweep(tables, reference.word[0]);
    return own ? add_sweep(tables->arena, list, own, &reference, &command) : RP_OK;
}

rp_status report_sweeps(report_tables *tables, const char *answer, const char *against, report_sweep **sweeps)
{
    for (const char *part; (part = report_part(tables->arena, &answer));)
        RP_TRY(add_reference(tables, part, sweeps));
    for (const char *part; (part = report_part(tables->arena, &against));)
        RP_TRY(add_reference(tables, part, sweeps));
    return RP_OK;
}

/* ---- runs without a result ---- */

/* The causes of so many of a sweep's failed runs: with their numbers if these are all. */
static const char *causes_of(rp_arena *arena, const report_sweep *sweep, double failed)
{
    const char *open = strchr(sweep->failed, '(');
    if (!open) return "cause not stored";
    char *text = rp_arena_memory(arena, strlen(open), 1), *to = text;
    const bool all = failed == strtod(sweep->failed, NULL);
    for (const char *c = open + 1; *c && *c != ')'; c++)
        if (all || !strchr(" 0123456789", *c) || (*c == ' ' && c[-1] == ',')) *to++ = *c;
    return text;
}

/* How the mean changes without these runs. */
static const char *push_of(const char *causes)
{
    static const char *const pushes[][2] = {
        {"no_pile", "the flattest piles are left out, theta_R is too large"},
        {"no_response", "the weakest piles are left out, theta_T is too large"}};
    for (size_t k = 0; k < sizeof pushes / sizeof *pushes; k++)
        if (strncmp(causes, pushes[k][0], strlen(pushes[k][0])) == 0 && !strpbrk(causes, ",;"))
            return pushes[k][1];
    return "effect on the mean not known";
}

const char *report_failed(rp_arena *arena, const report_sweep *sweeps)
{
    const char *causes = "";
    double runs = 0.0, failed = 0.0;
    for (const report_sweep *s = sweeps; s; s = s->next) {
        double missing = 0.0;
        for (size_t row = 0; row < s->table->n_rows; row++)
            if (s->counted[row] && rp_table_column(s->table, "n_failed") >= 0) {
                missing += number_at(s->table, row, "n_failed");
                runs += number_at(s->table, row, "n") + number_at(s->table, row, "n_failed");
            }
        if (missing > 0.0)
            causes = rp_text(arena, "%s%s%s", causes, failed > 0.0 ? "; " : "", causes_of(arena, s, missing));
        failed += missing;
    }
    return failed > 0.0 ? rp_text(arena, "%g of %g (%s): %s", failed, runs, causes, push_of(causes)) : "";
}
