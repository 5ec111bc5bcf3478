/* Runs behind a claim, and those without a result; see cells.h. */
#include "report/cells.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the rows that a claim reads ---- */

/* A table of which rows are read, once each. */
typedef struct read_table {
    const rp_table *table;
    bool *counted;
    struct read_table *next;
} read_table;

static rp_status add_side(report_tables *tables, const report_reference *side, read_table **list)
{
    if (side && side->less) RP_TRY(add_side(tables, side->less, list));
    for (const report_reference *r = side; r; r = r->next) {
        const rp_table *t;
        read_table **at = list;
        bool *rows;
        RP_TRY(report_rows(tables, r, &t, &rows));
        if (!t) continue;
        while (*at && (*at)->table != t) at = &(*at)->next;
        if (!*at) {
            *at = rp_arena_memory(tables->arena, 1, sizeof **at);
            **at = (read_table){.table = t, .counted = rows};
        }
        for (size_t row = 0; row < t->n_rows; row++) (*at)->counted[row] |= rows[row];
    }
    return RP_OK;
}

/* ---- runs without a result ---- */

/* Causes with their numbers, NaN where it is not known how many. */
typedef struct {
    double runs, failed;
    rp_tally causes;
} failures;

/* "8 of 60 (no_pile 8)", the entry of a row among those that semicolons separate. */
static void add_entry(failures *f, const char *note, size_t row)
{
    for (; row > 0 && (note = strchr(note, ';')); row--) note++;
    if (!note) return;
    const char *of = strstr(note, " of "), *open = strchr(note, '(');
    f->failed += strtod(note, NULL);
    f->runs += of ? strtod(of + 4, NULL) : 0.0;
    if (open && open < note + strcspn(note, ";")) rp_tally_add_text(&f->causes, open + 1, 1.0);
}

/* Of the rows of a table: its columns n_failed and failed_for say it, else an entry of its header line for
 * each row; the line of a whole sweep says the causes. */
static void add_table(failures *f, const read_table *r)
{
    const rp_table *t = r->table;
    const int n = rp_table_column(t, "n"), column = rp_table_column(t, "n_failed"),
              words = rp_table_column(t, "failed_for");
    const char *note = rp_table_find_note(t, "failed"), *open = note ? strchr(note, '(') : NULL;
    double failed = 0.0;
    for (size_t row = 0; row < t->n_rows; row++) {
        if (!r->counted[row]) continue;
        if (column < 0 && note) add_entry(f, note, row);
        if (column >= 0) {
            const double lost = strtod(rp_cell(t, row, column), NULL);
            failed += lost;
            f->runs += lost + (n < 0 ? 0.0 : strtod(rp_cell(t, row, n), NULL));
        }
        if (words >= 0) rp_tally_add_text(&f->causes, rp_cell(t, row, words), 1.0);
    }
    /* as many runs as the line says only if all of them are read */
    if (failed > 0.0 && words < 0 && open)
        rp_tally_add_text(&f->causes, open + 1, failed == strtod(note, NULL) ? 1.0 : NAN);
    f->failed += failed;
}

static const char *text_of(rp_arena *arena, const rp_tally *causes)
{
    const char *text = causes->n ? "" : "cause not stored";
    for (size_t i = 0; i < causes->n; i++) {
        const double times = causes->of[i].times;
        text = rp_text(arena, "%s%s%s", text, i ? ", " : "", causes->of[i].word);
        if (!isnan(times)) text = rp_text(arena, "%s %g", text, times);
    }
    return text;
}

/* How the mean changes without these runs, where that is known. */
static const char *push_of(const rp_tally *causes)
{
    const char *cause = causes->n == 1 ? causes->of[0].word : "";
    return strcmp(cause, "no_pile") == 0       ? ": the flattest piles are left out, theta_R is too large"
           : strcmp(cause, "no_response") == 0 ? ": the weakest piles are left out, theta_T is too large"
                                               : "";
}

rp_status report_failed(report_tables *tables, const report_reference *answer,
                        const report_reference *against, const char **text)
{
    read_table *list = NULL;
    failures f = {0};
    RP_TRY(add_side(tables, answer, &list));
    RP_TRY(add_side(tables, against, &list));
    for (const read_table *r = list; r; r = r->next) add_table(&f, r);
    *text = f.failed > 0.0 ? rp_text(tables->arena, "%g of %g (%s)%s", f.failed, f.runs,
                                     text_of(tables->arena, &f.causes), push_of(&f.causes))
                           : "";
    return RP_OK;
}

/* ---- the sweeps behind tables ---- */

static rp_status add_source(report_tables *tables, const char *note, report_sweep **list)
{
    const rp_table *points;
    const char *name = rp_text(tables->arena, "%.*s", (int)strcspn(note, " "), note);
    while (*list && strcmp((*list)->name, name) != 0) list = &(*list)->next;
    if (*list) return RP_OK;
    RP_TRY(report_table(tables, rp_text(tables->arena, "%s/points", name), &points));
    const char *failed = points ? rp_table_find_note(points, "failed") : NULL;
    *list = rp_arena_memory(tables->arena, 1, sizeof **list);
    **list = (report_sweep){name, failed && strtod(failed, NULL) > 0.0 ? failed : "", NULL};
    return RP_OK;
}

rp_status report_sweeps(report_tables *tables, const report_reference *answer,
                        const report_reference *against, report_sweep **sweeps)
{
    read_table *list = NULL;
    RP_TRY(add_side(tables, answer, &list));
    RP_TRY(add_side(tables, against, &list));
    for (const read_table *r = list; r; r = r->next)
        for (const char *n = NULL; (n = rp_table_next_note(r->table, "source", n));)
            RP_TRY(add_source(tables, n, sweeps));
    return RP_OK;
}
