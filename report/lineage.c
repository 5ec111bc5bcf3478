/* The sweeps whose runs answer a claim, and those of their runs that have no result; see claims.h. */
#include "report/claims.h"
#include "cli/cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the sweeps behind a table ---- */

/* What follows a word of a command; NULL without this word. */
static const char *word_after(const cli_words *command, const char *word)
{
    for (int i = 0; i + 1 < command->n; i++)
        if (strcmp(command->words[i], word) == 0) return command->words[i + 1];
    return NULL;
}

/* The command that a table comes from, if its header line is one and not too long. */
static void read_command(const rp_table *t, cli_words *command)
{
    const char *text = rp_table_find_note(t, "command");
    command->n = 0;
    if (text && cli_split(text, command)) command->n = 0;
}

/* "FOLDER/NAME_runs.tsv" or "FOLDER/NAME.tsv" is the sweep NAME, where its table has one. */
static bool find_source(const char *folders, const char *word, cli_sweep *sweep)
{
    char name[128];
    if (!cli_ends_in(word, ".tsv")) return false;
    const char *slash = strrchr(word, '/');
    snprintf(name, sizeof name, "%s", slash ? slash + 1 : word);
    name[strlen(name) - strlen(".tsv")] = '\0';
    if (cli_ends_in(name, "_runs")) name[strlen(name) - strlen("_runs")] = '\0';
    return cli_find_sweep(folders, name, sweep) && strcmp(sweep->name, name) == 0;
}

/* The sweeps that the table of a reference was made of: those of its command, else the one of its name. */
static size_t sweeps_behind(const char *folders, const char *reference, const cli_words *command,
                            cli_sweep sweeps[CLI_MAX_SWEEPS])
{
    size_t n = 0;
    for (int i = 0; i < command->n && n < CLI_MAX_SWEEPS; i++)
        n += find_source(folders, command->words[i], &sweeps[n]);
    return n > 0 ? n : cli_find_sweep(folders, reference, &sweeps[0]);
}

/* ---- the grid points that a cell reads ---- */

/* Rows counted so far, of each sweep. */
typedef struct {
    size_t n;
    cli_sweep sweeps[CLI_MAX_SWEEPS];
    rp_table *tables[CLI_MAX_SWEEPS];
    bool *counted[CLI_MAX_SWEEPS];
} points;

static rp_status find_points(const char *folders, const cli_sweep *sweep, points *p, size_t *at)
{
    char path[4096];
    for (*at = 0; *at < p->n; (*at)++)
        if (strcmp(p->sweeps[*at].name, sweep->name) == 0) return RP_OK;
    if (p->n == CLI_MAX_SWEEPS) return rp_fail(RP_BAD_INPUT, "more than %d sweeps", CLI_MAX_SWEEPS);
    cli_find_table(folders, sweep->name, path);
    RP_TRY(cli_table_read(path, &p->tables[*at]));
    p->counted[*at] = cli_memory(p->tables[*at]->n_rows, sizeof(bool));
    p->sweeps[p->n++] = *sweep;
    return RP_OK;
}

/* key=value chooses rows of a sweep by its columns; a row of all, and an extreme of a derived table, do not.
 */
static rp_status word_matches(const rp_table *t, size_t row, const char *word, bool *matches)
{
    char key[128];
    const char *equals = strchr(word, '=');
    *matches = true;
    if (!equals) return RP_OK;
    snprintf(key, sizeof key, "%.*s", (int)(equals - word), word);
    if (rp_table_column(t, key) < 0 || strcmp(equals, "=nan") == 0) return RP_OK;
    cli_words one;
    RP_TRY(cli_split(word, &one));
    return cli_row_matches(t, row, &one, 0, 1, matches);
}

/* A fit reads the range --from, --to of its x. */
static bool within_range(const rp_table *t, size_t row, const cli_words *command)
{
    const char *x = word_after(command, "--x"), *from = word_after(command, "--from"),
               *to = word_after(command, "--to");
    const int column = x ? rp_table_column(t, x) : -1;
    if (column < 0) return true;
    const double value = strtod(cli_text(t, row, column), NULL);
    return !(from && value < strtod(from, NULL)) && !(to && value > strtod(to, NULL));
}

static double count_of(const rp_table *t, size_t row, const char *name)
{
    const int column = rp_table_column(t, name);
    return column < 0 ? NAN : strtod(cli_text(t, row, column), NULL);
}

/* The rows that the words and the command choose. Points without any result enter no mean: only a cell of
 * the sweep itself reads them. */
static rp_status mark_rows(points *p, size_t at, const cli_words *reference, const cli_words *command)
{
    const rp_table *t = p->tables[at];
    const bool itself = strcmp(reference->words[0], p->sweeps[at].name) == 0;
    const char *where = word_after(command, "--where");
    for (size_t row = 0; row < t->n_rows; row++) {
        bool matches = itself || (within_range(t, row, command) && count_of(t, row, "n") > 0.0);
        if (matches && where && !itself) RP_TRY(word_matches(t, row, where, &matches));
        for (int w = 1; w < reference->n - 1 && matches; w++)
            RP_TRY(word_matches(t, row, reference->words[w], &matches));
        p->counted[at][row] |= matches;
    }
    return RP_OK;
}

static rp_status add_reference(const char *folders, const char *text, points *p)
{
    char path[4096];
    rp_table *table;
    cli_words reference, command;
    cli_sweep sweeps[CLI_MAX_SWEEPS];
    RP_TRY(cli_split(text, &reference));
    if (reference.n < 2 || !cli_find_table(folders, reference.words[0], path)) return RP_OK;
    RP_TRY(cli_table_read(path, &table));
    read_command(table, &command);
    const size_t n = sweeps_behind(folders, text, &command, sweeps);
    for (size_t k = 0; k < n; k++) {
        size_t at;
        RP_TRY(find_points(folders, &sweeps[k], p, &at));
        RP_TRY(mark_rows(p, at, &reference, &command));
    }
    return RP_OK;
}

/* Both sides of a claim, and all parts of a pooled one. */
static rp_status read_points(const cli_claim *c, const char *folders, points *p)
{
    const char *const sides[] = {c->answer, c->against};
    *p = (points){0};
    for (size_t k = 0; k < N_OF(sides); k++)
        for (const char *part = sides[k], *end; part; part = end ? end + 3 : NULL) {
            char text[CLI_MAX_REFERENCE];
            end = strstr(part, " + ");
            snprintf(text, sizeof text, "%.*s", (int)(end ? end - part : (long)strlen(part)), part);
            RP_TRY(add_reference(folders, text, p));
        }
    return RP_OK;
}

rp_status cli_claim_sweeps(const cli_claim *c, const char *folders, cli_sweep sweeps[CLI_MAX_SWEEPS],
                           size_t *n)
{
    points p;
    *n = 0;
    RP_TRY(read_points(c, folders, &p));
    memcpy(sweeps, p.sweeps, sizeof p.sweeps);
    *n = p.n;
    return RP_OK;
}

/* ---- runs without a result ---- */

static const char not_stored[] = "cause not stored";

/* The causes of so many of a sweep's failed runs: with their numbers if these are all. */
static void print_causes(FILE *out, const cli_sweep *sweep, double failed)
{
    const char *open = strchr(sweep->failed, '(');
    if (!open) {
        fputs(not_stored, out);
    } else if (failed == strtod(sweep->failed, NULL)) {
        fprintf(out, "%.*s", (int)strcspn(open + 1, ")"), open + 1);
    } else { /* names without numbers */
        for (const char *c = open + 1; *c && *c != ')'; c++)
            if (!strchr(" 0123456789", *c) || (*c == ' ' && c[-1] == ',')) fputc(*c, out);
    }
}

/* How the mean changes without these runs. */
static const char *push_of(const char *causes)
{
    static const char *const pushes[][2] = {
        {"no_pile", "the flattest piles are left out, theta_R is too large"},
        {"no_response", "the weakest piles are left out, theta_T is too large"}};
    for (size_t k = 0; k < N_OF(pushes); k++)
        if (strncmp(causes, pushes[k][0], strlen(pushes[k][0])) == 0 && !strpbrk(causes, ",;"))
            return pushes[k][1];
    return "effect on the mean not known";
}

rp_status cli_claim_failed(const cli_claim *c, const char *folders, char text[512])
{
    points p;
    char causes[256] = "";
    double runs = 0.0, failed = 0.0;
    *text = '\0';
    RP_TRY(read_points(c, folders, &p));
    FILE *out = fmemopen(causes, sizeof causes, "w");
    for (size_t k = 0; k < p.n; k++) {
        double missing = 0.0;
        for (size_t row = 0; row < p.tables[k]->n_rows; row++)
            if (p.counted[k][row] && rp_table_column(p.tables[k], "n_failed") >= 0) {
                missing += count_of(p.tables[k], row, "n_failed");
                runs += count_of(p.tables[k], row, "n") + count_of(p.tables[k], row, "n_failed");
            }
        if (missing > 0.0 && failed > 0.0) fputs("; ", out);
        if (missing > 0.0) print_causes(out, &p.sweeps[k], missing);
        failed += missing;
    }
    fclose(out);
    if (failed > 0.0) snprintf(text, 512, "%g of %g (%s): %s", failed, runs, causes, push_of(causes));
    return RP_OK;
}
