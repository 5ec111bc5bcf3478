/* `report page`: a text whose numbers and verdicts come from tables and from the claims; see the help
 * below. */
#include <glob.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "report/pages.h"

#include "report/claims.h"
#include "cli/cli.h"

#define PAGE_OPTIONS(X)                                                                                      \
    REPORT_TABLES(X)                                                                                         \
    REPORT_CLAIMS(X)                                                                                         \
    X(TEXT, o, "", "-", "", "file to write; - is standard output")

CLI_OPTIONS(page, PAGE_OPTIONS)

enum { MAX_DEPTH = 2 };

typedef struct {
    const page_options *options;
    const char *template;
    cli_claims claims;
    cli_judged *judged; /* each claim, from the first place on that asks for one */
    FILE *out;
    int depth;
    char lacking[128]; /* table that the line asks for and nobody has made; "" */
} report;

static const char no_data[] = "no data";

/* ---- tables ---- */

/* A cell's text under a format, or with "+-" its number with the error. */
static rp_status fill_text(report *r, const cli_cell *cell, const char *format)
{
    stats_number number;
    const char *text = cli_cell_text(cell, cell->column);
    if (format && strcmp(format, "+-") == 0) {
        RP_TRY(cli_cell_number(cell, &number));
        cli_print_number(r->out, number);
        return RP_OK;
    }
    if (text && *cell->column == '#') {
        fputs(text, r->out);
        return RP_OK;
    }
    return text ? cli_print_text(r->out, text, format)
                : rp_table_find(cell->table, cell->column, NULL, &(int){0});
}

static rp_status fill_cell(report *r, const char *reference, const char *format)
{
    cli_cell cell;
    RP_TRY(cli_cell_find(r->options->tables, reference, &cell));
    if (!cell.missing) return fill_text(r, &cell, format);
    reference += strspn(reference, " ");
    snprintf(r->lacking, sizeof r->lacking, "%.*s", (int)strcspn(reference, " "), reference);
    fputs(no_data, r->out);
    return RP_OK;
}

static rp_status fill_note(report *r, const cli_words *w)
{
    char reference[2 * CLI_MAX_REFERENCE];
    if (w->n != 3) return rp_fail(RP_BAD_INPUT, "{{note ...}}: table and key expected");
    snprintf(reference, sizeof reference, "%s #%s", w->words[1], w->words[2]);
    return fill_cell(r, reference, NULL);
}

/* One cell of a line of {{rows}}: COLUMN, COLUMN:FORMAT or COLUMN:+-. */
static rp_status fill_column(report *r, cli_cell *cell, char *word)
{
    char *format = strchr(word, ':');
    if (format) *format = '\0';
    cell->column = word;
    rp_status status = fill_text(r, cell, format ? format + 1 : NULL);
    if (format) *format = ':';
    return status;
}

static rp_status fill_rows(report *r, cli_words *w)
{
    int bar = 2;
    cli_cell cell = {0};
    while (bar < w->n && strcmp(w->words[bar], "|") != 0) bar++;
    if (bar >= w->n - 1) return rp_fail(RP_BAD_INPUT, "{{rows ...}}: a table, | and columns expected");
    if (!cli_find_table(r->options->tables, w->words[1], cell.path)) {
        fprintf(r->out, "| %s |", no_data);
        return RP_OK;
    }
    RP_TRY(cli_table_read(cell.path, &cell.table));
    bool first = true;
    for (cell.row = 0; cell.row < cell.table->n_rows; cell.row++) {
        bool matches;
        RP_TRY(cli_row_matches(cell.table, cell.row, w, 2, bar, &matches));
        if (!matches) continue;
        fputs(first ? "|" : "\n|", r->out);
        first = false;
        for (int k = bar + 1; k < w->n; k++) {
            fputc(' ', r->out);
            RP_TRY(fill_column(r, &cell, w->words[k]));
            fputs(" |", r->out);
        }
    }
    if (first) return rp_fail(RP_BAD_INPUT, "%s: no row for {{rows ...}}", cell.path);
    return RP_OK;
}

/* ---- claims ---- */

static rp_status judge(report *r)
{
    return r->judged ? RP_OK : cli_claims_judge(&r->claims, r->options->tables, &r->judged);
}

/* What `word` asks of a claim: published, ours, number, verdict. */
static rp_status fill_claim(report *r, const char *id, char word)
{
    const cli_claim *claim = NULL;
    char text[128];
    RP_TRY(cli_claims_find(&r->claims, id, &claim));
    if (word == 'p') {
        cli_claim_published(claim, text);
        fputs(text, r->out);
        return RP_OK;
    }
    RP_TRY(judge(r));
    const cli_judged *j = &r->judged[claim - r->claims.claims];
    if (word == 'n' && isfinite(j->n)) return fprintf(r->out, "%.0f", j->n), RP_OK;
    if (word == 'n') return fputs(no_data, r->out), RP_OK;
    fputs(word == 'v' ? j->reason : *j->text ? j->text : no_data, r->out);
    return RP_OK;
}

/* What is claimed, and of what the numbers are. */
static void print_statement(report *r, const cli_claim *c)
{
    fputs(c->statement, r->out);
    if (*c->note && c->test != CLAIM_UNTESTABLE) fprintf(r->out, " (%s)", c->note);
}

/* A claim as a line of a table: with its name, samples, values and reason. */
static void print_in_full(report *r, const cli_claim *c, const cli_judged *j)
{
    char published[160], values[600] = "";
    cli_claim_published(c, published);
    if (isfinite(j->n)) snprintf(values, sizeof values, "%.0f", j->n);
    if (*j->failed) {
        const int count = (int)strcspn(j->failed, "(");
        snprintf(values + strlen(values), sizeof values - strlen(values), "; %.*sfailed %s", count, j->failed,
                 j->failed + count);
    }
    if (c->samples > 0.0 && *published)
        snprintf(published + strlen(published), sizeof published - strlen(published), " (%.0f)", c->samples);
    fprintf(r->out, "\n| %s%s | ", *c->of ? "variant " : "", c->id);
    print_statement(r, c);
    fprintf(r->out, " | %s | %s | %s | %s |", published, j->text, values, j->reason);
}

/* The line that is read first: what is claimed, both numbers, the verdict. */
static void print_in_short(report *r, const cli_claim *c, const cli_judged *j)
{
    char published[128];
    cli_claim_published(c, published);
    fputs("\n| ", r->out);
    print_statement(r, c);
    fprintf(r->out, " | %s | %s | %s |", published, j->text,
            c->test == CLAIM_UNTESTABLE ? j->reason : stats_verdict_texts[j->verdict]);
}

/* The claims of a section; in short without their variants. */
static rp_status fill_section(report *r, const char *section, bool in_full)
{
    RP_TRY(judge(r));
    bool any = false;
    fputs(in_full ? "| claim | what it says | paper (samples) | ours | values | verdict "
                    "|\n|---|---|---|---|---|---|"
                  : "| claim | paper | ours | verdict |\n|---|---|---|---|",
          r->out);
    for (size_t i = 0; i < r->claims.n; i++) {
        const cli_claim *c = &r->claims.claims[i];
        if (strcmp(c->section, section) != 0 || (*c->of && !in_full)) continue;
        (in_full ? print_in_full : print_in_short)(r, c, &r->judged[i]);
        any = true;
    }
    return any ? RP_OK
               : rp_fail(RP_BAD_INPUT, "{{%s %s}}: no claim has this section", in_full ? "claims" : "scores",
                         section);
}

/* A line for each sweep behind the claims that has runs without a result. */
static rp_status fill_failures(report *r, const char *which)
{
    if (strcmp(which, "all") != 0) return rp_fail(RP_BAD_INPUT, "{{failures %s}}: allowed: all", which);
    cli_sweep sweeps[CLI_MAX_SWEEPS], *listed = cli_memory(r->claims.n * CLI_MAX_SWEEPS, sizeof *listed);
    size_t n, n_listed = 0;
    for (size_t i = 0; i < r->claims.n; i++) {
        RP_TRY(cli_claim_sweeps(&r->claims.claims[i], r->options->tables, sweeps, &n));
        for (size_t k = 0; k < n; k++) {
            bool again = !*sweeps[k].failed;
            for (size_t l = 0; l < n_listed && !again; l++)
                again = strcmp(listed[l].name, sweeps[k].name) == 0;
            if (again) continue;
            fprintf(r->out, "%s| `%s` | %s%s |", n_listed > 0 ? "\n" : "", sweeps[k].name, sweeps[k].failed,
                    strchr(sweeps[k].failed, '(') ? "" : " (causes not stored)");
            listed[n_listed++] = sweeps[k];
        }
    }
    return RP_OK;
}

static rp_status fill_counts(report *r, const char *paper)
{
    char text[256];
    RP_TRY(judge(r));
    cli_claims_count(&r->claims, r->judged, paper, text);
    fputs(text, r->out);
    return RP_OK;
}

/* ---- places ---- */

static rp_status fill_file(report *r, const char *path);

static rp_status fill_include(report *r, const char *pattern)
{
    char full[4096];
    glob_t found;
    const char *slash = strrchr(r->template, '/');
    snprintf(full, sizeof full, "%.*s%s", slash ? (int)(slash - r->template + 1) : 0, r->template, pattern);
    if (r->depth == MAX_DEPTH) return rp_fail(RP_BAD_INPUT, "{{include %s}}: in an included text", pattern);
    if (glob(full, 0, NULL, &found) != 0) return rp_fail(RP_BAD_INPUT, "{{include ...}}: no file %s", full);
    rp_status status = RP_OK;
    for (size_t i = 0; i < found.gl_pathc && !status; i++) {
        if (i > 0) fputc('\n', r->out);
        status = fill_file(r, found.gl_pathv[i]);
    }
    globfree(&found);
    return status;
}

static rp_status fill_place(report *r, char *text)
{
    cli_words w;
    RP_TRY(cli_split(text, &w));
    if (w.n < 2) return rp_fail(RP_BAD_INPUT, "{{%s}}: a word and what it is of expected", text);
    char *rest = text + strspn(text, " ") + strlen(w.words[0]);
    const char *word = w.words[0], *first = w.words[1];
    if (strcmp(word, "value") == 0) return fill_cell(r, rest, "+-");
    if (strcmp(word, "cell") == 0) {
        char *format = strstr(rest, " %"); /* the last word may be one */
        if (format) *format++ = '\0';
        return fill_cell(r, rest, format);
    }
    if (strcmp(word, "note") == 0) return fill_note(r, &w);
    if (strcmp(word, "rows") == 0) return fill_rows(r, &w);
    if (strcmp(word, "published") == 0 || strcmp(word, "ours") == 0 || strcmp(word, "number") == 0 ||
        strcmp(word, "verdict") == 0)
        return fill_claim(r, first, *word);
    if (strcmp(word, "claims") == 0) return fill_section(r, first, true);
    if (strcmp(word, "scores") == 0) return fill_section(r, first, false);
    if (strcmp(word, "counts") == 0) return fill_counts(r, first);
    if (strcmp(word, "failures") == 0) return fill_failures(r, first);
    if (strcmp(word, "include") == 0) return fill_include(r, first);
    return rp_fail(RP_BAD_INPUT, "{{%s ...}}: unknown word", word);
}

static rp_status fill_places(report *r, char *line)
{
    for (char *open; (open = strstr(line, "{{"));) {
        char *close = strstr(open, "}}");
        if (!close) return rp_fail(RP_BAD_INPUT, "{{ without }} in the same line");
        fwrite(line, 1, (size_t)(open - line), r->out);
        *close = '\0';
        RP_TRY(fill_place(r, open + 2));
        line = close + 2;
    }
    fputs(line, r->out);
    return RP_OK;
}

/* A line of text is sentences: without a number of theirs it is left out, and says why. */
static rp_status fill_line(report *r, char *line)
{
    if (*line == '|' || strncmp(line, "{{rows", 6) == 0 || strncmp(line, "{{include", 9) == 0)
        return fill_places(r, line);
    FILE *out = r->out;
    char *text = NULL;
    size_t size;
    if (!(r->out = open_memstream(&text, &size))) return rp_fail(RP_NO_MEMORY, "report: out of memory");
    r->lacking[0] = '\0';
    rp_status status = fill_places(r, line);
    fclose(r->out);
    r->out = out;
    if (!status && *r->lacking)
        fprintf(out, "No data: `%s.tsv` has not been made.", r->lacking);
    else if (!status)
        fputs(text, out);
    free(text);
    return status;
}

static rp_status fill_file(report *r, const char *path)
{
    char *text;
    int number = 1;
    rp_status status = rp_file_read(path, &text);
    r->depth++;
    for (char *line = text, *end; !status && line && *line; line = end, number++) {
        end = strchr(line, '\n');
        if (end) *end++ = '\0';
        if ((status = fill_line(r, line)) != RP_OK)
            rp_prefix(status, "%s:%d: ", path, number);
        else if (end)
            fputc('\n', r->out);
    }
    r->depth--;
    free(text);
    return status;
}

static rp_status fill_report(void *values)
{
    const page_options *o = values;
    report r = {.options = o, .template = cli_argument(0)};
    RP_TRY(cli_claims_read(o->claims, &r.claims));
    RP_TRY(rp_file_open(o->o, &r.out));
    return rp_file_close(o->o, r.out, fill_file(&r, r.template));
}

const cli_command report_page = {
    "page",
    "a text of the report, filled from tables",
    "TEXT [--tables DIR,...] [-o FILE]",
    "Fill the places {{word ...}} of a text. The row of a table is the one whose cells equal all\n"
    "key=value.\n"
    "  {{value T k=v COL}}          value +- standard error\n"
    "  {{cell T k=v COL FORMAT}}    the cell itself, in the format given (%.Ng or %.Nf)\n"
    "  {{note T KEY}}               a header line of the table\n"
    "  {{rows T k=v ... | COL ...}} one line of a table for each row; COL:FORMAT, COL:+- for value +- "
    "error;\n"
    "                               key=FROM:TO for a range\n"
    "  {{published ID}}             the number that the paper gives\n"
    "  {{ours ID}}                  our number, as a claim compares it\n"
    "  {{number ID}}                how many values it is the mean of\n"
    "  {{verdict ID}}               verdict on a claim\n"
    "  {{scores SECTION}}           the claims of a section in short: paper, ours, verdict\n"
    "  {{claims SECTION}}           the same in full, with variants, counts, failed runs, reasons\n"
    "  {{counts PAPER}}             how many claims of a paper have which verdict\n"
    "  {{failures all}}             the sweeps behind the claims that have runs without a result\n"
    "  {{include FILES}}            texts beside the template, filled alike\n"
    "A table that has not been made gives `no data` in a table; a line of text then names it instead.",
    "report page report/text/paper-repro.md.in -o paper-repro.md",
    page_params,
    .prints_text = true,
    .act = fill_report};
