/* `report page`: a text whose numbers and verdicts come from tables and claims; see the help below. */
#include "report/pages.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PAGE_OPTIONS(X)                                                                                      \
    REPORT_OPTIONS(X)                                                                                        \
    X(TEXT, o, "", "-", "", "file to write; - is standard output")

CLI_OPTIONS(page, PAGE_OPTIONS)

typedef struct {
    report_tables tables;
    report_claims claims;
    report_judged *judged; /* each claim, from the first place on that asks for one */
    FILE *out;
    const char *lacking; /* table that the line asks for and nobody has made; NULL: none */
} page;

static const char no_data[] = "no data";

/* ---- tables ---- */

/* The text of a cell in a format such as %.3g or %.0f; without one a count stands as it is, other numbers
 * take %.3g. */
static rp_status in_format(rp_arena *arena, const char *cell, const char *format, const char **text)
{
    /* precision and letter alone are taken from the format, so that it cannot be a harmful one */
    int precision = 3, used = 0;
    char letter = 'g', *end;
    if (format && (sscanf(format, "%%.%1d%c%n", &precision, &letter, &used) != 2 || format[used] ||
                   !strchr("fg", letter)))
        return rp_fail(RP_BAD_INPUT, "\"%s\": a format such as %%.3g or %%.0f expected", format);
    const double value = strtod(cell, &end);
    const bool as_it_is = *end || (!format && !cell[strspn(cell, "0123456789")]);
    *text = as_it_is        ? cell
            : letter == 'f' ? rp_text(arena, "%.*f", precision, value)
                            : rp_text(arena, "%.*g", precision, value);
    return RP_OK;
}

/* A cell's text under a format, or with "+-" its number with the error. */
static rp_status fill_text(page *p, const report_cell *cell, const char *format)
{
    rp_arena *arena = p->tables.arena;
    const char *text = report_cell_text(cell, cell->column);
    report_number number;
    if (format && strcmp(format, "+-") == 0) {
        RP_TRY(report_cell_number(cell, &number));
        text = report_number_text(arena, number.shown);
    } else if (!text)
        return rp_table_find(cell->table, cell->column, NULL, &(int){0});
    else if (*cell->column != '#')
        RP_TRY(in_format(arena, text, format, &text));
    fputs(text, p->out);
    return RP_OK;
}

static rp_status fill_cell(page *p, const char *reference, const char *format)
{
    report_cell cell;
    report_reference *r;
    RP_TRY(report_reference_read(p->tables.arena, reference, &r));
    RP_TRY(report_cell_find(&p->tables, r, &cell));
    if (cell.table) return fill_text(p, &cell, format);
    p->lacking = r->table;
    fputs(no_data, p->out);
    return RP_OK;
}

/* "TABLE key=value ... | COLUMN ...", of which each may be COLUMN:FORMAT or COLUMN:+-. */
static rp_status fill_rows(page *p, const char *text)
{
    rp_arena *arena = p->tables.arena;
    const char *bar = strstr(text, " | "), *begin = "|";
    const rp_table *table;
    report_reference *r;
    bool *rows;
    if (!bar) return rp_fail(RP_BAD_INPUT, "{{rows ...}}: a table, | and columns expected");
    const report_words columns = report_split(arena, bar + 3);
    RP_TRY(report_reference_read(arena, rp_text(arena, "%.*s |", (int)(bar - text), text), &r));
    RP_TRY(report_rows(&p->tables, r, &table, &rows));
    if (!table) return fprintf(p->out, "| %s |", no_data), RP_OK;
    for (size_t row = 0; row < table->n_rows; row++) {
        if (!rows[row]) continue;
        fputs(begin, p->out);
        begin = "\n|";
        for (int k = 0; k < columns.n; k++) {
            const int length = (int)strcspn(columns.word[k], ":");
            const char *format = columns.word[k] + length;
            const report_cell cell = {table, row, rp_text(arena, "%.*s", length, columns.word[k])};
            fputc(' ', p->out);
            RP_TRY(fill_text(p, &cell, *format ? format + 1 : NULL));
            fputs(" |", p->out);
        }
    }
    return *begin == '|' ? rp_fail(RP_BAD_INPUT, "%s: no row for {{rows ...}}", table->path) : RP_OK;
}

/* ---- claims ---- */

static rp_status judge(page *p)
{
    return p->judged ? RP_OK : report_judge(&p->claims, &p->tables, &p->judged);
}

/* What `word` asks of a claim: published, ours, difference, number, verdict. */
static rp_status fill_claim(page *p, const char *id, char word)
{
    const report_claim *claim = NULL;
    RP_TRY(report_claims_find(&p->claims, id, &claim));
    if (word == 'p') return fputs(report_published(p->tables.arena, claim), p->out), RP_OK;
    RP_TRY(judge(p));
    const report_judged *j = &p->judged[claim - p->claims.claims];
    if (word == 'd' && j->verdict != REPORT_NO_DATA) {
        const stats_number d = report_difference(j->ours.shown, j->against.shown);
        return fputs(report_number_text(p->tables.arena, d), p->out), RP_OK;
    }
    if (word == 'n' && isfinite(j->ours.n)) return fprintf(p->out, "%.0f", j->ours.n), RP_OK;
    fputs(word == 'v' ? j->word : word == 'o' && *j->text ? j->text : no_data, p->out);
    return RP_OK;
}

/* A claim as a line of a table: with its name, samples, values and what explains the verdict. */
static void print_in_full(page *p, const report_claim *c, const report_judged *j)
{
    const char *published = report_published(p->tables.arena, c);
    const int count = (int)strcspn(j->failed, "(");
    fprintf(p->out, "%s%s | %s | %s", *c->of ? "variant " : "", c->id, c->statement, published);
    if (c->samples > 0.0 && *published) fprintf(p->out, " (%.0f)", c->samples);
    fprintf(p->out, " | %s%s%s | ", j->text, *c->unit ? " " : "", c->unit);
    if (isfinite(j->ours.n)) fprintf(p->out, "%.0f", j->ours.n);
    fprintf(p->out, " | %s | ", j->word);
    const char *begin = "";
    const char *const notes[] = {c->note, j->note, report_after_a_look(c) ? c->fixed : ""};
    for (size_t k = 0; k < N_OF(notes); k++)
        if (*notes[k]) fprintf(p->out, "%s%s", begin, notes[k]), begin = "; ";
    if (*j->failed) fprintf(p->out, "%s%.*sfailed %s", begin, count, j->failed, j->failed + count);
    fputs(" |", p->out);
}

/* The line that is read first: what is claimed and how it is compared, both sides, the margin, the verdict.
 */
static void print_in_short(page *p, const report_claim *c, const report_judged *j)
{
    const char *interval = strstr(j->text, REPORT_INTERVAL);
    fprintf(p->out, "%s%s%s | ", c->statement, *c->note ? "; " : "", c->note);
    if (strcmp(c->paper, "ours") != 0)
        fprintf(p->out, "%s | ", isnan(c->number.value) ? "" : report_published(p->tables.arena, c));
    fprintf(p->out, "%.*s%s%s | ", (int)(interval ? (size_t)(interval - j->text) : strlen(j->text)), j->text,
            *c->unit ? " " : "", c->unit);
    if (isfinite(c->margin)) fprintf(p->out, "%g", c->margin);
    fprintf(p->out, " | %s%s |", j->word, report_after_a_look(c) ? "†" : "");
}

/* The claims of a paper in full; or those of a section that the page has, in short. */
static rp_status fill_section(page *p, const char *word, const char *section)
{
    const bool in_full = strcmp(word, "claims") == 0;
    bool any = false;
    RP_TRY(judge(p));
    fputs(in_full ? "| claim | what it says | paper (samples) | here | values | verdict | note |\n"
                    "|---|---|---|---|---|---|---|"
          : strcmp(section, "ours") == 0
              ? "| we say | here | margin | verdict |\n|---|---|---|---|"
              : "| the paper says | paper | here | margin | verdict |\n|---|---|---|---|---|",
          p->out);
    for (size_t i = 0; i < p->claims.n; i++) {
        const report_claim *c = &p->claims.claims[i];
        const bool wanted = strcmp(in_full ? c->paper : c->section, section) == 0;
        if (!wanted || (!in_full && !report_on_page(c))) continue;
        fputs("\n| ", p->out);
        (in_full ? print_in_full : print_in_short)(p, c, &p->judged[i]);
        any = true;
    }
    return any ? RP_OK : rp_fail(RP_BAD_INPUT, "{{%s %s}}: no such claim", word, section);
}

/* A line for each sweep behind the claims that has runs without a result. */
static rp_status fill_failures(page *p, const char *which)
{
    report_sweep *sweeps = NULL;
    const char *begin = "";
    if (strcmp(which, "all") != 0) return rp_fail(RP_BAD_INPUT, "{{failures %s}}: allowed: all", which);
    for (size_t i = 0; i < p->claims.n; i++)
        RP_TRY(report_sweeps(&p->tables, p->claims.claims[i].answers, p->claims.claims[i].againsts, &sweeps));
    for (const report_sweep *s = sweeps; s; s = s->next) {
        if (!*s->failed) continue;
        fprintf(p->out, "%s| `%s` | %s%s |", begin, s->name, s->failed,
                strchr(s->failed, '(') ? "" : " (causes not stored)");
        begin = "\n";
    }
    return RP_OK;
}

/* ---- places ---- */

static rp_status fill_place(page *p, char *text)
{
    const report_words w = report_split(p->tables.arena, text);
    if (w.n < 2) return rp_fail(RP_BAD_INPUT, "{{%s}}: a word and what it is of expected", text);
    char *rest = text + strspn(text, " ") + strlen(w.word[0]);
    const char *word = w.word[0], *first = w.word[1];
    if (strcmp(word, "value") == 0) return fill_cell(p, rest, "+-");
    if (strcmp(word, "cell") == 0) {
        char *format = strstr(rest, " %"); /* the last word may be one */
        if (format) *format++ = '\0';
        return fill_cell(p, rest, format);
    }
    if (strcmp(word, "note") == 0)
        return w.n == 3 ? fill_cell(p, rp_text(p->tables.arena, "%s #%s", first, w.word[2]), NULL)
                        : rp_fail(RP_BAD_INPUT, "{{note ...}}: table and key expected");
    if (strcmp(word, "rows") == 0) return fill_rows(p, rest);
    if (strcmp(word, "published") == 0 || strcmp(word, "ours") == 0 || strcmp(word, "number") == 0 ||
        strcmp(word, "verdict") == 0 || strcmp(word, "difference") == 0)
        return fill_claim(p, first, *word);
    if (strcmp(word, "claims") == 0 || strcmp(word, "scores") == 0) return fill_section(p, word, first);
    if (strcmp(word, "counts") == 0) {
        RP_TRY(judge(p));
        return fputs(report_count(p->tables.arena, &p->claims, p->judged, first), p->out), RP_OK;
    }
    if (strcmp(word, "failures") == 0) return fill_failures(p, first);
    return rp_fail(RP_BAD_INPUT, "{{%s ...}}: unknown word", word);
}

static rp_status fill_places(page *p, char *line)
{
    for (char *open; (open = strstr(line, "{{"));) {
        char *close = strstr(open, "}}");
        if (!close) return rp_fail(RP_BAD_INPUT, "{{ without }} in the same line");
        fwrite(line, 1, (size_t)(open - line), p->out);
        *close = '\0';
        RP_TRY(fill_place(p, open + 2));
        line = close + 2;
    }
    fputs(line, p->out);
    return RP_OK;
}

/* A line of text is sentences: without a number of theirs it is left out, and says why. */
static rp_status fill_line(page *p, char *line)
{
    if (*line == '|' || strncmp(line, "{{rows", 6) == 0) return fill_places(p, line);
    FILE *out = p->out;
    char *text = NULL;
    size_t size;
    if (!(p->out = open_memstream(&text, &size))) return rp_fail(RP_NO_MEMORY, "page: out of memory");
    p->lacking = NULL;
    rp_status status = fill_places(p, line);
    fclose(p->out);
    p->out = out;
    if (!status && p->lacking)
        fprintf(out, "No data: `%s.tsv` has not been made.", p->lacking);
    else if (!status)
        fputs(text, out);
    free(text);
    return status;
}

static rp_status fill_file(page *p, const char *path)
{
    char *text;
    int number = 1;
    rp_status status = rp_file_read(path, &text);
    for (char *line = text, *end; !status && line && *line; line = end, number++) {
        end = strchr(line, '\n');
        if (end) *end++ = '\0';
        if ((status = fill_line(p, line)) != RP_OK)
            rp_prefix(status, "%s:%d: ", path, number);
        else if (end)
            fputc('\n', p->out);
    }
    free(text);
    return status;
}

static rp_status fill_page(cli_call *call, const void *values)
{
    const page_options *o = values;
    page p = {.tables = {call->arena, o->tables, NULL}};
    RP_TRY(report_claims_read(p.tables.arena, o->claims, &p.claims));
    RP_TRY(rp_file_open(o->o, true, &p.out));
    return rp_file_close(o->o, p.out, fill_file(&p, cli_argument(call, 0)));
}

const cli_command report_page = {
    "page",
    "fill a text of the report from tables",
    "TEXT [--tables DIR,...] [-o FILE]",
    "Fills the places {{word ...}} of a text. The row of a table is the one whose cells equal all "
    "key=value.\n"
    "  {{value T k=v COL}}          value +- standard error\n"
    "  {{cell T k=v COL FORMAT}}    the cell itself, in the given format (%.Ng or %.Nf)\n"
    "  {{note T KEY}}               a header line of the table\n"
    "  {{rows T k=v ... | COL ...}} one line of a table for each row; COL:FORMAT, COL:+- for value +- error\n"
    "  {{published ID}}             the number in the paper\n"
    "  {{ours ID}}                  our number, as a claim compares it\n"
    "  {{difference ID}}            our number minus the number that it is compared with\n"
    "  {{number ID}}                the number of values whose mean it is\n"
    "  {{verdict ID}}               the verdict on a claim\n"
    "  {{scores SECTION}}           the claims of a section in short: paper, here, verdict\n"
    "  {{claims PAPER}}             the claims of a paper in full, with variants, counts, failed runs, "
    "notes\n"
    "  {{counts PAPER}}             how many claims of a paper have which verdict\n"
    "  {{failures all}}             the sweeps behind the claims that have runs without a result\n"
    "If a table has not been made, a table shows `no data`, and a line of text names the missing table.",
    "report page report/text/paper-repro.md.in -o paper-repro.md",
    page_params,
    .refuses = "A place with an unknown word, or whose table has no such row or column.",
    .act = fill_page};
