/* Published claims and what our tables say of them; see claims.h. */
#include "report/claims.h"
#include "cli/cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- reading ---- */

#define X(name, word, table, meaning) word,
static const char *const test_words[] = {CLI_CLAIM_TESTS(X)};
#undef X
#define X(name, word, table, meaning) table,
static const bool needs_table[] = {CLI_CLAIM_TESTS(X)};
#undef X

/* "-" stands for nothing. */
static const char *text_of(const rp_table *t, size_t row, int column)
{
    const char *text = cli_text(t, row, column);
    return strcmp(text, "-") == 0 ? "" : text;
}

static rp_status number_of(const rp_table *t, size_t row, const char *name, double otherwise, double *number)
{
    const int column = rp_table_column(t, name);
    *number = otherwise;
    return *text_of(t, row, column) ? rp_table_number(t, row, column, false, number) : RP_OK;
}

static rp_status read_numbers(const rp_table *t, size_t row, cli_claim *c)
{
    RP_TRY(number_of(t, row, "published", NAN, &c->published.value));
    RP_TRY(number_of(t, row, "published_se", 0.0, &c->published.se));
    RP_TRY(number_of(t, row, "samples", 0.0, &c->samples));
    return number_of(t, row, "margin", INFINITY, &c->margin);
}

/* A variant takes the published number of its claim, which stands before it. */
static rp_status find_number(const cli_claims *all, cli_claim *c)
{
    const cli_claim *original = NULL;
    if (!*c->of) return RP_OK;
    RP_TRY(cli_claims_find(all, c->of, &original));
    if (!isnan(c->published.value))
        return rp_fail(RP_BAD_INPUT, "variant %s of %s: a number is published once", c->id, c->of);
    c->published = original->published;
    c->published_text = original->published_text;
    c->se_text = original->se_text;
    c->samples = original->samples;
    return RP_OK;
}

static rp_status check(const cli_claims *all, const cli_claim *c)
{
    const bool number = c->test == CLAIM_AGREES || c->test == CLAIM_EQUALS || c->test == CLAIM_RATIO ||
                        (c->test == CLAIM_ORDER && !*c->against);
    const bool other = c->test == CLAIM_SAME || c->test == CLAIM_ABOVE || c->test == CLAIM_BELOW ||
                       c->test == CLAIM_LEAST || c->test == CLAIM_MOST || c->test == CLAIM_RATIO;
    for (size_t i = 0; i < all->n; i++)
        if (strcmp(all->claims[i].id, c->id) == 0)
            return rp_fail(RP_BAD_INPUT, "claim %s stands twice", c->id);
    if (number && isnan(c->published.value))
        return rp_fail(RP_BAD_INPUT, "claim %s: test %s needs a published number", c->id, c->test_word);
    if (other && !*c->against)
        return rp_fail(RP_BAD_INPUT, "claim %s: test %s needs `against`", c->id, c->test_word);
    if ((c->test == CLAIM_INDEPENDENT || c->test == CLAIM_ORDER || c->test == CLAIM_EQUALS) &&
        !isfinite(c->margin))
        return rp_fail(RP_BAD_INPUT, "claim %s: test %s needs a margin", c->id, c->test_word);
    if (c->test == CLAIM_UNTESTABLE ? !*c->note : !*c->answer)
        return rp_fail(RP_BAD_INPUT, "claim %s: test %s needs %s", c->id, c->test_word,
                       c->test == CLAIM_UNTESTABLE ? "a reason in `note`" : "an answer");
    return RP_OK;
}

static rp_status read_claim(cli_claims *all, size_t row)
{
    const rp_table *t = all->table;
    cli_claim *c = &all->claims[all->n];
#define X(column, member) c->member = text_of(t, row, rp_table_column(t, #column));
    CLI_CLAIM_TEXTS(X)
#undef X
    c->family = rp_table_column(t, "family") < 0 ? "" : text_of(t, row, rp_table_column(t, "family"));
    for (c->test = 0; c->test < CLI_N_CLAIM_TESTS; c->test++)
        if (strcmp(c->test_word, test_words[c->test]) == 0) break;
    rp_status status = c->test < CLI_N_CLAIM_TESTS
                           ? RP_OK
                           : rp_fail(RP_BAD_INPUT, "claim %s: unknown test \"%s\"", c->id, c->test_word);
    if (!status) status = read_numbers(t, row, c);
    if (!status) status = find_number(all, c);
    if (!status) status = check(all, c);
    RP_TRY(rp_prefix(status, "%s:%zu: ", t->places[row].path, t->places[row].line));
    all->n++;
    return RP_OK;
}

rp_status cli_claims_read(const char *path, cli_claims *claims)
{
#define X(column, member) #column " "
    static const char header[] = CLI_CLAIM_TEXTS(X) "samples margin";
#undef X
#define X(column, member) #column,
    static const char *const columns[] = {CLI_CLAIM_TEXTS(X) "samples", "margin"};
#undef X
    int column;
    *claims = (cli_claims){0};
    RP_TRY(cli_texts_read(path, &claims->table));
    for (size_t k = 0; k < N_OF(columns); k++)
        RP_TRY(rp_table_find(claims->table, columns[k], header, &column));
    claims->claims = cli_memory(claims->table->n_rows, sizeof *claims->claims);
    for (size_t row = 0; row < claims->table->n_rows; row++) RP_TRY(read_claim(claims, row));
    return RP_OK;
}

rp_status cli_claims_find(const cli_claims *claims, const char *id, const cli_claim **claim)
{
    for (size_t i = 0; i < claims->n; i++)
        if (strcmp(claims->claims[i].id, id) == 0) {
            *claim = &claims->claims[i];
            return RP_OK;
        }
    return rp_fail(RP_BAD_INPUT, "no claim \"%s\"", id);
}

void cli_claim_published(const cli_claim *claim, char text[128])
{
    snprintf(text, 128, "%s%s%s", claim->published_text, *claim->se_text ? " ± " : "", claim->se_text);
}

/* ---- judging ---- */

/* A number as it is shown and as it is tested, how many values are behind it, and the p_fit of its table's
 * fit, NaN without one. The error of a mean is tested by Student's t; that of a fit or a bootstrap stands as
 * it is. */
typedef struct {
    stats_number shown, tested;
    double n, dof, p_fit;
} measured;

static rp_status read_measured(const cli_cell *cell, measured *m)
{
    char own[160], mean[160];
    snprintf(own, sizeof own, "%s_n", cell->column);
    snprintf(mean, sizeof mean, "%s_mean", cell->column);
    RP_TRY(cli_cell_number(cell, &m->shown));
    RP_TRY(cli_cell_column(cell, cli_cell_text(cell, own) ? own : "n", &m->n));
    RP_TRY(cli_cell_column(cell, "p_fit", &m->p_fit));
    const bool is_mean = cli_cell_text(cell, mean);
    m->tested = is_mean ? stats_of_few(m->shown, m->n) : m->shown;
    m->dof = is_mean ? m->n - 1.0 : INFINITY;
    return RP_OK;
}

static rp_status read_summary(const cli_cell *cell, stats_summary *part)
{
    static const char *const suffixes[] = {"mean", "sd", "n"};
    const int length = (int)strlen(cell->column) - (cli_cell_is_deviation(cell) ? (int)strlen("_sd") : 0);
    double numbers[N_OF(suffixes)];
    for (size_t k = 0; k < N_OF(suffixes); k++) {
        char name[160];
        snprintf(name, sizeof name, "%.*s_%s", length, cell->column, suffixes[k]);
        RP_TRY(cli_cell_column(cell, name, &numbers[k]));
        if (isnan(numbers[k]))
            return rp_fail(RP_BAD_INPUT, "%s: no column %s with a number", cell->path, name);
    }
    *part = (stats_summary){.n = (size_t)numbers[2], .mean = numbers[0], .sd = numbers[1]};
    return RP_OK;
}

/* The mean of all values of several cells, "CELL + CELL ..."; of columns NAME_sd, their standard deviation.
 */
static rp_status read_pooled(const char *text, const char *folders, measured *m, bool *missing)
{
    enum { MOST = 12 };
    stats_summary parts[MOST] = {0};
    size_t n = 0;
    bool deviation = false;
    for (const char *part = text, *end; part; part = end ? end + 3 : NULL) {
        char reference[CLI_MAX_REFERENCE];
        cli_cell cell;
        end = strstr(part, " + ");
        if (n == MOST) return rp_fail(RP_BAD_INPUT, "more than %d cells to pool", MOST);
        snprintf(reference, sizeof reference, "%.*s", (int)(end ? end - part : (long)strlen(part)), part);
        RP_TRY(cli_cell_find(folders, reference, &cell));
        *missing |= cell.missing;
        deviation = cli_cell_is_deviation(&cell);
        if (!cell.missing) RP_TRY(read_summary(&cell, &parts[n++]));
    }
    const stats_summary all = stats_pooled(n, parts);
    m->n = (double)all.n;
    m->shown = deviation ? (stats_number){all.sd, stats_deviation_error(all.sd, m->n)}
                         : (stats_number){all.mean, all.se};
    m->tested = deviation ? m->shown : stats_of_few(m->shown, m->n);
    m->dof = deviation ? INFINITY : m->n - 1.0;
    return RP_OK;
}

/* A number, a cell of a table, or several cells pooled; a table that is not there leaves *missing true. */
static rp_status read_side(const char *text, const char *folders, cli_cell *cell, measured *m, bool *missing)
{
    char *end;
    m->shown = m->tested = (stats_number){strtod(text, &end), 0.0};
    if (!*end) return RP_OK;
    if (strstr(text, " + ")) return read_pooled(text, folders, m, missing);
    RP_TRY(cli_cell_find(folders, text, cell));
    *missing |= cell->missing;
    return cell->missing ? RP_OK : read_measured(cell, m);
}

static bool is_inequality(const cli_claim *c)
{
    return c->test == CLAIM_ABOVE || c->test == CLAIM_BELOW;
}

/* The difference that an inequality must not exclude. A limit other than 0 has the smallest effect that
 * matters in itself: anything beyond it is enough. */
static double excluded_margin(const cli_claim *c)
{
    char *end;
    const double limit = strtod(c->against, &end);
    return !*end && limit != 0.0 ? INFINITY : c->margin;
}

static bool tests_change(const cli_claim *c)
{
    return c->test == CLAIM_INDEPENDENT || c->test == CLAIM_RISES || c->test == CLAIM_FALLS;
}

/* Within a family the correction follows later; else the table's own holds. */
static rp_status read_change(const cli_cell *cell, bool family, stats_change *change)
{
    char lo[160], hi[160];
    snprintf(lo, sizeof lo, "%s_lo90", cell->column);
    snprintf(hi, sizeof hi, "%s_hi90", cell->column);
    RP_TRY(cli_cell_column(cell, lo, &change->lo90));
    RP_TRY(cli_cell_column(cell, hi, &change->hi90));
    return cli_cell_column(cell, !family && cli_cell_text(cell, "p_holm") ? "p_holm" : "p_value",
                           &change->p_value);
}

/* The verdict of both readings of the published +-. */
static void read_match(cli_judged *j)
{
    j->verdict = j->match.verdict;
    j->two_readings = j->match.error != j->match.deviation;
}

static void apply_test(const cli_claim *c, cli_judged *j)
{
    const stats_number ours = j->tested, against = j->tested_against;
    const stats_change *change = &j->change;
    switch (c->test) {
    case CLAIM_RATIO:
    case CLAIM_AGREES: j->match = stats_agree(ours, c->published, c->samples, c->margin); break;
    case CLAIM_SAME: j->match = stats_agree(ours, against, 0.0, c->margin); break;
    case CLAIM_ABOVE: j->verdict = stats_exceed(ours, against, 1, excluded_margin(c)); return;
    case CLAIM_BELOW: j->verdict = stats_exceed(ours, against, -1, excluded_margin(c)); return;
    case CLAIM_LEAST: j->verdict = stats_bound(ours.value, against.value, 1); return;
    case CLAIM_MOST: j->verdict = stats_bound(ours.value, against.value, -1); return;
    case CLAIM_EQUALS: j->verdict = stats_bound(fabs(ours.value - c->published.value), c->margin, -1); return;
    case CLAIM_ORDER:
        j->verdict = stats_order(stats_quotient(ours, *c->against ? against : c->published), c->margin);
        return;
    case CLAIM_INDEPENDENT: j->verdict = stats_equivalent(change, c->margin); return;
    case CLAIM_RISES: j->verdict = stats_trends(change, 1, c->margin); return;
    case CLAIM_FALLS: j->verdict = stats_trends(change, -1, c->margin); return;
    case CLAIM_CONSTANT:
    case CLAIM_FORMULA:
    case CLAIM_PICTURE:
    case CLAIM_UNTESTABLE:
    case CLI_N_CLAIM_TESTS: return;
    }
    read_match(j);
}

static void print_ours(const cli_claim *c, cli_judged *j)
{
    FILE *out = fmemopen(j->text, sizeof j->text, "w");
    cli_print_number(out, j->ours);
    if (tests_change(c)) {
        /* as many digits as the change, so that an end close to the margin is not rounded onto it */
        const int decimals = j->ours.se > 0.0 ? cli_decimals(j->ours.se) : 3;
        fprintf(out, " (90 %%: %.*f to %.*f)", decimals, j->change.lo90, decimals, j->change.hi90);
    }
    if (*c->against && c->test != CLAIM_RATIO) {
        fputs(" against ", out);
        cli_print_number(out, j->against);
    }
    fclose(out);
}

static rp_status judge_table(const cli_claim *c, const char *folders, cli_judged *j)
{
    cli_cell cell = {0}, other = {0};
    measured ours = {.p_fit = NAN}, against = {.p_fit = NAN};
    bool missing = false;
    RP_TRY(read_side(c->answer, folders, &cell, &ours, &missing));
    if (*c->against) RP_TRY(read_side(c->against, folders, &other, &against, &missing));
    if (!missing && tests_change(c)) RP_TRY(read_change(&cell, *c->family, &j->change));
    if (!missing && tests_change(c)) RP_TRY(cli_cell_column(&cell, "dof", &ours.dof));
    if (missing) j->verdict = STATS_NO_DATA;
    if (missing) return RP_OK;
    if (c->test == CLAIM_RATIO) {
        ours.shown = stats_quotient(ours.shown, against.shown);
        ours.tested = stats_quotient(ours.tested, against.tested);
    }
    j->ours = ours.shown;
    j->against = against.shown;
    j->n = ours.n;
    j->dof = ours.dof;
    j->p_fit = fmin(ours.p_fit, against.p_fit); /* a number beside NaN */
    RP_TRY(cli_claim_failed(c, folders, j->failed));
    j->tested = ours.tested;
    j->tested_against = against.tested;
    apply_test(c, j);
    print_ours(c, j);
    return RP_OK;
}

/* The published numbers of several claims among themselves. */
static rp_status judge_constant(const cli_claims *all, const cli_claim *c, cli_judged *j)
{
    cli_words words;
    stats_number numbers[CLI_MAX_WORDS];
    const cli_claim *other = c;
    RP_TRY(cli_split(c->answer, &words));
    for (int i = 0; i < words.n; i++) {
        RP_TRY(cli_claims_find(all, words.words[i], &other));
        numbers[i] = other->published;
    }
    j->match = stats_constant((size_t)words.n, numbers, other->samples);
    read_match(j);
    snprintf(j->text, sizeof j->text, "p = %.2g or %.1g", j->match.z_error, j->match.z_deviation);
    return RP_OK;
}

/* Whether the opposite of an inequality is significant by itself. */
static bool is_opposite(const cli_claim *c, const cli_judged *j)
{
    const int sign = c->test == CLAIM_ABOVE ? 1 : -1;
    return stats_exceed(j->tested, j->tested_against, sign, INFINITY) == STATS_NOT_REPRODUCED;
}

static void explain(const cli_claim *c, cli_judged *j)
{
    const char *verdict = stats_verdict_texts[j->verdict];
    if (stats_fit_rejected(j->p_fit))
        snprintf(j->reason, sizeof j->reason,
                 "%s: the form of the fit does not describe the means (p = %.2g)", verdict, j->p_fit);
    else if (j->uncorrected != j->verdict)
        snprintf(j->reason, sizeof j->reason, "%s: %s without the correction for %zu tests of one question",
                 verdict, stats_verdict_texts[j->uncorrected], j->tests);
    else if (j->two_readings)
        snprintf(j->reason, sizeof j->reason,
                 "%s: %s if ± is a standard error, %s if it is a standard deviation", verdict,
                 stats_verdict_texts[j->match.error], stats_verdict_texts[j->match.deviation]);
    else if ((c->test == CLAIM_AGREES || c->test == CLAIM_SAME) && j->verdict != STATS_NO_DATA)
        snprintf(j->reason, sizeof j->reason, "%s (%+.1f standard errors)", verdict, j->match.z_error);
    else if (is_inequality(c) && j->verdict == STATS_NOT_REPRODUCED && !is_opposite(c, j))
        snprintf(j->reason, sizeof j->reason, "%s (a difference of %g or more is excluded)", verdict,
                 c->margin);
    else if (c->test == CLAIM_FORMULA)
        snprintf(j->reason, sizeof j->reason, "%s, by tests", verdict);
    else if (c->test == CLAIM_UNTESTABLE)
        snprintf(j->reason, sizeof j->reason, "%s: %s", verdict, c->note);
    else
        snprintf(j->reason, sizeof j->reason, "%s", verdict);
}

static rp_status judge_claim(const cli_claims *claims, const cli_claim *claim, const char *folders,
                             cli_judged *j)
{
    *j = (cli_judged){.n = NAN,
                      .dof = NAN,
                      .p_fit = NAN,
                      .ours = {NAN, NAN},
                      .against = {NAN, 0.0},
                      .match = {.z_error = NAN, .z_deviation = NAN}};
    rp_status status = RP_OK;
    if (needs_table[claim->test])
        status = judge_table(claim, folders, j);
    else if (claim->test == CLAIM_CONSTANT)
        status = judge_constant(claims, claim, j);
    else
        j->verdict = claim->test == CLAIM_FORMULA   ? STATS_REPRODUCED
                     : claim->test == CLAIM_PICTURE ? STATS_BY_EYE
                                                    : STATS_UNTESTABLE;
    j->uncorrected = j->verdict;
    return rp_prefix(status, "claim %s: ", claim->id);
}

/* ---- families ---- */

/* Chances that decide a claim: of such a difference or change if there is none, the same with the other
 * reading of the published +-, and of one as small if the truth is the margin. NaN: no such test. */
enum { OF_EFFECT, OF_DEVIATION, OF_MARGIN, CHANCES };

static bool tests_agreement(const cli_claim *c)
{
    return c->test == CLAIM_AGREES || c->test == CLAIM_SAME || c->test == CLAIM_RATIO;
}

static void find_chances(const cli_claim *c, const cli_judged *j, double chances[CHANCES])
{
    chances[OF_EFFECT] = chances[OF_MARGIN] = NAN;
    if (is_inequality(c)) {
        chances[OF_EFFECT] = stats_exceed_p(j->tested, j->tested_against);
        chances[OF_MARGIN] = stats_exceed_p_margin(j->tested, j->tested_against, excluded_margin(c));
    }
    if (tests_change(c)) chances[OF_EFFECT] = j->change.p_value;
    if (c->test == CLAIM_INDEPENDENT)
        chances[OF_MARGIN] = stats_contrast_p_margin(
            &(stats_contrast){j->ours.value, j->ours.se, isnan(j->dof) ? INFINITY : j->dof}, c->margin);
    if (tests_agreement(c)) chances[OF_EFFECT] = stats_agree_p(j->match.z_error);
    chances[OF_DEVIATION] = tests_agreement(c) ? stats_agree_p(j->match.z_deviation) : chances[OF_EFFECT];
}

/* The verdict with chances that Holm's correction has raised. */
static void decide_again(const cli_claim *c, const double chances[CHANCES], cli_judged *j)
{
    j->change.p_value = chances[OF_EFFECT];
    if (tests_agreement(c)) {
        j->match = stats_agree_by_p(j->match, chances[OF_EFFECT], chances[OF_DEVIATION]);
        read_match(j);
    } else if (c->test == CLAIM_INDEPENDENT)
        j->verdict = stats_equivalent_by_p(chances[OF_MARGIN], chances[OF_EFFECT]);
    else if (tests_change(c))
        j->verdict = stats_trends(&j->change, c->test == CLAIM_RISES ? 1 : -1, c->margin);
    else
        j->verdict = stats_exceed_by_p(j->tested, j->tested_against, c->test == CLAIM_ABOVE ? 1 : -1,
                                       chances[OF_EFFECT], chances[OF_MARGIN]);
}

/* The claims of one family answer one question: Holm's correction for the number of their tests. */
static void correct_family(const cli_claims *claims, const char *family, cli_judged judged[])
{
    const size_t n = claims->n;
    double *found = cli_memory(CHANCES * n, sizeof *found), *raised = cli_memory(CHANCES * n, sizeof *raised);
    size_t tests = 0;
    for (size_t i = 0; i < n; i++) {
        double chances[CHANCES] = {NAN, NAN, NAN};
        if (strcmp(claims->claims[i].family, family) == 0 && judged[i].verdict != STATS_NO_DATA)
            find_chances(&claims->claims[i], &judged[i], chances);
        for (size_t k = 0; k < CHANCES; k++) found[k * n + i] = chances[k];
        tests += !isnan(chances[OF_EFFECT]);
    }
    for (size_t k = 0; k < CHANCES; k++) stats_holm(n, found + k * n, raised + k * n);
    for (size_t i = 0; i < n; i++) {
        double chances[CHANCES];
        if (isnan(found[OF_EFFECT * n + i])) continue;
        for (size_t k = 0; k < CHANCES; k++) chances[k] = raised[k * n + i];
        decide_again(&claims->claims[i], chances, &judged[i]);
        judged[i].tests = tests;
    }
}

static bool is_first_of_family(const cli_claims *claims, size_t i)
{
    const char *family = claims->claims[i].family;
    for (size_t k = 0; k < i; k++)
        if (strcmp(claims->claims[k].family, family) == 0) return false;
    return *family != '\0';
}

/* A fit that its own means reject decides nothing. Its test stays one of its family, so that no verdict on
 * another claim gets stronger. */
static void distrust_fits(size_t n, cli_judged judged[])
{
    for (size_t i = 0; i < n; i++)
        if (stats_fit_rejected(judged[i].p_fit)) judged[i].verdict = STATS_UNDECIDED;
}

rp_status cli_claims_judge(const cli_claims *claims, const char *folders, cli_judged **judged)
{
    *judged = cli_memory(claims->n, sizeof **judged);
    for (size_t i = 0; i < claims->n; i++) {
        const size_t mark = cli_mark();
        RP_TRY(judge_claim(claims, &claims->claims[i], folders, &(*judged)[i]));
        cli_release(mark);
    }
    for (size_t i = 0; i < claims->n; i++)
        if (is_first_of_family(claims, i)) correct_family(claims, claims->claims[i].family, *judged);
    distrust_fits(claims->n, *judged);
    for (size_t i = 0; i < claims->n; i++) explain(&claims->claims[i], &(*judged)[i]);
    return RP_OK;
}

void cli_claims_count(const cli_claims *claims, const cli_judged judged[], const char *paper, char text[256])
{
    size_t counts[STATS_VERDICTS], n = 0;
    stats_verdict *verdicts = cli_memory(claims->n, sizeof *verdicts);
    *text = '\0';
    for (size_t i = 0; i < claims->n; i++)
        if (!*claims->claims[i].of && strcmp(claims->claims[i].paper, paper) == 0)
            verdicts[n++] = judged[i].verdict;
    stats_count_verdicts(n, verdicts, counts);
    FILE *out = fmemopen(text, 256, "w");
    for (stats_verdict v = 0; v < STATS_VERDICTS && n > 0; v++)
        fprintf(out, "%s%zu %s", v ? ", " : "", counts[v], stats_verdict_texts[v]);
    fclose(out);
}
