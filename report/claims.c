/* Published claims and what our tables say of them; see claims.h. */
#include "report/claims.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What each test needs: a table that answers, a published number, `against`, a margin; what decides it. */
enum { BY_WORD, BY_DIFFERENCE, BY_SIDE, BY_BOUND, BY_CHANGE };
static const struct {
    const char *word;
    int by;
    bool number, against, margin;
} tests[] = {[CLAIM_AGREES] = {"agrees", BY_DIFFERENCE, .number = true},
             [CLAIM_SAME] = {"same", BY_CHANGE, .against = true, .margin = true},
             [CLAIM_ABOVE] = {"above", BY_SIDE, .against = true},
             [CLAIM_BELOW] = {"below", BY_SIDE, .against = true},
             [CLAIM_LEAST] = {"least", BY_BOUND, .against = true},
             [CLAIM_MOST] = {"most", BY_BOUND, .against = true},
             [CLAIM_EQUALS] = {"equals", BY_BOUND, .number = true, .margin = true},
             [CLAIM_ORDER] = {"order", BY_BOUND, .margin = true},
             [CLAIM_INDEPENDENT] = {"independent", BY_CHANGE, .margin = true},
             [CLAIM_RISES] = {"rises", BY_CHANGE},
             [CLAIM_FALLS] = {"falls", BY_CHANGE},
             [CLAIM_JOINT] = {"joint", BY_WORD},
             [CLAIM_FORMULA] = {"formula", BY_WORD}};

/* ---- reading ---- */

/* "-" stands for nothing, and so does a column that is not there. */
static const char *text_of(const rp_table *t, size_t row, const char *name)
{
    const int column = rp_table_column(t, name);
    const char *text = column < 0 ? "" : rp_cell(t, row, column);
    return strcmp(text, "-") == 0 ? "" : text;
}

static rp_status number_of(const rp_table *t, size_t row, const char *name, double otherwise, double *number)
{
    *number = otherwise;
    return *text_of(t, row, name) ? rp_table_number(t, row, rp_table_column(t, name), false, number) : RP_OK;
}

/* The printed +- is a standard error or, of so many samples, a standard deviation, which a variant may take
 * from our values instead. */
static rp_status read_numbers(const rp_table *t, size_t row, report_claim *c)
{
    RP_TRY(number_of(t, row, "published", NAN, &c->number.value));
    RP_TRY(number_of(t, row, "published_se", 0.0, &c->number.se));
    RP_TRY(number_of(t, row, "samples", 0.0, &c->samples));
    const bool deviation = strcmp(c->error, "sd") == 0;
    if (deviation ? !(c->samples > 0.0)
                  : *c->error && strcmp(c->error, "se") != 0 && strcmp(c->error, "ours") != 0)
        return rp_fail(RP_BAD_INPUT, "claim %s: error: se, sd of so many samples, or ours expected", c->id);
    if (deviation) c->number.se /= sqrt(c->samples);
    return number_of(t, row, "margin", INFINITY, &c->margin);
}

/* A variant takes the published number of its claim, which stands before it, unless it is another print of
 * the same quantity, with its own. */
static rp_status find_number(const report_claims *all, report_claim *c)
{
    const report_claim *original = NULL;
    if (!*c->of) return RP_OK;
    RP_TRY(report_claims_find(all, c->of, &original));
    if (!isnan(c->number.value)) return RP_OK;
    c->number = original->number, c->samples = original->samples;
    c->published = original->published, c->published_se = original->published_se;
    return RP_OK;
}

static rp_status lacks(const report_claim *c, const char *what)
{
    return rp_fail(RP_BAD_INPUT, "claim %s: test %s needs %s", c->id, c->test, what);
}

static rp_status check(const report_claims *all, const report_claim *c)
{
    for (size_t i = 0; i < all->n; i++)
        if (strcmp(all->claims[i].id, c->id) == 0)
            return rp_fail(RP_BAD_INPUT, "claim %s stands twice", c->id);
    if (tests[c->kind].number && isnan(c->number.value)) return lacks(c, "a published number");
    if (tests[c->kind].against && !*c->against) return lacks(c, "`against`");
    if (tests[c->kind].margin && !isfinite(c->margin)) return lacks(c, "a margin");
    return *c->answer ? RP_OK : lacks(c, "an answer");
}

static rp_status read_claim(rp_arena *arena, const report_claims *all, size_t row, report_claim *c)
{
    const rp_table *t = all->table;
#define X(column) c->column = text_of(t, row, #column);
    REPORT_CLAIM_TEXTS(X)
    X(family)
    X(on)
    X(error)
    X(fixed)
    X(says)
    X(unit)
#undef X
    while (c->kind < N_CLAIM_TESTS && strcmp(c->test, tests[c->kind].word) != 0) c->kind++;
    if (c->kind == N_CLAIM_TESTS)
        return rp_fail(RP_BAD_INPUT, "claim %s: unknown test \"%s\"", c->id, c->test);
    RP_TRY(read_numbers(t, row, c));
    RP_TRY(find_number(all, c));
    RP_TRY(check(all, c));
    char *end;
    c->limit = strtod(c->against, &end);
    if (tests[c->kind].by == BY_WORD) return RP_OK;
    RP_TRY(report_reference_read(arena, c->answer, &c->answers));
    return *end ? report_reference_read(arena, c->against, &c->againsts) : RP_OK;
}

rp_status report_claims_read(rp_arena *arena, const char *path, report_claims *claims)
{
#define X(column) #column " "
    static const char expected[] = REPORT_CLAIM_TEXTS(X) "samples margin";
#undef X
    const report_words columns = report_split(arena, expected);
    rp_table *t;
    RP_TRY(rp_table_keep(arena, path, NULL, &t));
    for (int k = 0; k < columns.n; k++) RP_TRY(rp_table_find(t, columns.word[k], expected, &(int){0}));
    *claims = (report_claims){t, rp_arena_memory(arena, t->n_rows, sizeof *claims->claims), 0};
    for (size_t row = 0; row < t->n_rows; row++, claims->n++)
        RP_TRY(rp_prefix(read_claim(arena, claims, row, &claims->claims[row]), "%s:%zu: ", RP_PLACE(t, row)));
    return RP_OK;
}

rp_status report_claims_find(const report_claims *claims, const char *id, const report_claim **claim)
{
    for (size_t i = 0; i < claims->n; i++)
        if (strcmp(claims->claims[i].id, id) == 0) {
            *claim = &claims->claims[i];
            return RP_OK;
        }
    return rp_fail(RP_BAD_INPUT, "no claim \"%s\"", id);
}

const char *report_published(rp_arena *arena, const report_claim *c)
{
    if (isnan(c->number.value)) return c->says;
    return rp_text(arena, "%s%s%s", c->published, *c->published_se ? " ± " : "", c->published_se);
}

/* ---- both sides ---- */

/* Degrees of freedom of the difference of two means (Welch and Satterthwaite); infinite where the error of a
 * side is not that of a mean of values. */
static double freedom(const report_number *a, const report_number *b)
{
    const report_number *const sides[] = {a, b};
    double sum = 0.0, parts = 0.0;
    for (int k = 0; k < 2; k++) {
        const double se = sides[k]->shown.se, variance = se * se;
        if (se == 0.0) continue;
        if (sides[k]->tested.se == se) return INFINITY;
        sum += variance, parts += variance * variance / (sides[k]->n - 1.0);
    }
    return parts > 0.0 ? sum * sum / parts : INFINITY;
}

static stats_contrast contrast_of(const report_judged *j)
{
    const stats_number n = isfinite(j->dof) ? report_difference(j->ours.shown, j->against.shown)
                                            : report_difference(j->ours.tested, j->against.tested);
    return (stats_contrast){n.value, n.se, isnan(j->dof) ? INFINITY : j->dof};
}

/* Within a family the correction follows later; else the table's own holds. */
static rp_status read_change(rp_arena *arena, const report_claim *c, const report_cell *cell,
                             report_judged *j)
{
    const bool corrected = !*c->family && report_cell_text(cell, "p_holm");
    if (c->kind == CLAIM_SAME || c->answers->next) {
        j->dof = freedom(&j->ours, &j->against);
        const stats_contrast change = contrast_of(j);
        stats_contrast_interval(&change, 0.9, &j->change.lo90, &j->change.hi90);
        j->change.p_value = stats_contrast_p(&change);
        return RP_OK;
    }
    RP_TRY(report_cell_column(cell, rp_text(arena, "%s_lo90", cell->column), &j->change.lo90));
    RP_TRY(report_cell_column(cell, rp_text(arena, "%s_hi90", cell->column), &j->change.hi90));
    RP_TRY(report_cell_column(cell, "dof", &j->dof));
    return report_cell_column(cell, corrected ? "p_holm" : "p_value", &j->change.p_value);
}

static const char *text_of_ours(rp_arena *arena, const report_claim *c, const report_judged *j)
{
    const char *text = report_number_text(arena, j->ours.shown);
    if (*c->against && (c->againsts || c->limit != 0.0))
        text = rp_text(arena, "%s against %s", text, report_number_text(arena, j->against.shown));
    if (tests[c->kind].by != BY_CHANGE) return text;
    /* as many digits as the change, so that an end close to the margin is not rounded onto it */
    const double se = report_difference(j->ours.shown, j->against.shown).se;
    const int decimals = se > 0.0 ? report_decimals(se) : 3;
    return rp_text(arena, "%s%s%.*f to %.*f)", text, REPORT_INTERVAL, decimals, j->change.lo90, decimals,
                   j->change.hi90);
}

static rp_status read_tables(const report_claim *c, report_tables *tables, report_judged *j)
{
    report_judged found = *j;
    report_cell cell, other;
    bool missing = false;
    RP_TRY(report_number_find(tables, c->answers, &cell, &found.ours, &missing));
    if (c->againsts) RP_TRY(report_number_find(tables, c->againsts, &other, &found.against, &missing));
    if (!c->againsts) found.against.shown = found.against.tested = (stats_number){c->limit, 0.0};
    if (missing) j->verdict = REPORT_NO_DATA;
    if (missing) return RP_OK;
    if (tests[c->kind].by == BY_CHANGE) RP_TRY(read_change(tables->arena, c, &cell, &found));
    RP_TRY(report_failed(tables, c->answers, c->againsts, &found.failed));
    found.text = text_of_ours(tables->arena, c, &found);
    *j = found;
    return RP_OK;
}

/* ---- verdicts ---- */

/* The side on which a number or a trend is claimed to be. */
static int sign_of(const report_claim *c)
{
    return c->kind == CLAIM_ABOVE || c->kind == CLAIM_LEAST || c->kind == CLAIM_RISES ? 1 : -1;
}

static report_chances chances_of(const report_claim *c, const report_judged *j)
{
    const stats_number ours = j->ours.tested, against = j->against.tested;
    switch (j->verdict == REPORT_NO_DATA ? BY_WORD : tests[c->kind].by) {
    case BY_DIFFERENCE: return (report_chances){report_agree_p(j->z), NAN};
    case BY_SIDE: { /* beyond a limit other than 0 anything is enough: no difference is excluded */
        const double margin = !c->againsts && c->limit != 0.0 ? INFINITY : c->margin;
        return (report_chances){report_exceed_p(ours, against),
                                report_exceed_p_margin(ours, against, sign_of(c), margin)};
    }
    case BY_CHANGE: {
        const stats_contrast change = contrast_of(j);
        if (c->kind != CLAIM_INDEPENDENT && c->kind != CLAIM_SAME)
            return (report_chances){j->change.p_value, NAN};
        const double inside = stats_contrast_p_margin(&change, c->margin);
        return (report_chances){1.0 - inside, inside};
    }
    default: return (report_chances){NAN, NAN};
    }
}

/* The published number, with its error or that of as many of our values. */
static stats_number published_of(const report_claim *c, const report_judged *j)
{
    stats_number published = c->number;
    if (strcmp(c->error, "ours") == 0) published.se = j->ours.shown.se * sqrt(j->ours.n / c->samples);
    return published;
}

/* The verdict of a claim's test; `raised`: chances that Holm's correction has raised, NULL: none. */
static report_verdict decide(const report_claim *c, const report_chances *raised, report_judged *j)
{
    const stats_number ours = j->ours.tested, against = j->against.tested;
    const int sign = sign_of(c);
    const report_chances own = chances_of(c, j);
    report_verdict verdict;
    switch (c->kind) {
    case CLAIM_AGREES: return report_agree(ours, published_of(c, j), c->margin, raised, &j->z);
    case CLAIM_ABOVE:
    case CLAIM_BELOW: return report_exceed(ours, against, sign, raised ? raised : &own);
    case CLAIM_LEAST:
    case CLAIM_MOST: return report_bound(ours.value, against.value, sign);
    case CLAIM_EQUALS: return report_bound(fabs(ours.value - c->number.value), c->margin, -1);
    case CLAIM_ORDER:
        return report_order(report_quotient(ours, *c->against ? against : c->number), c->margin);
    case CLAIM_SAME:
    case CLAIM_INDEPENDENT: return report_equivalent(&j->change, c->margin, raised);
    case CLAIM_RISES:
    case CLAIM_FALLS:
        verdict = report_trends(&j->change, sign, c->margin, raised);
        if (raised) j->change.p_value = raised->effect; /* that is told */
        return verdict;
    case CLAIM_JOINT:
    case CLAIM_FORMULA:
    case N_CLAIM_TESTS: break;
    }
    return REPORT_REPRODUCED; /* a formula, by its tests */
}

/* Several agreements together. */
static rp_status judge_joint(rp_arena *arena, const report_claims *all, const report_claim *c,
                             report_judged judged[], report_judged *j)
{
    const report_words words = report_split(arena, c->answer);
    stats_number *d = rp_arena_memory(arena, (size_t)words.n, sizeof *d);
    for (int i = 0; i < words.n; i++) {
        const report_claim *of = NULL;
        RP_TRY(report_claims_find(all, words.word[i], &of));
        const report_judged *one = &judged[of - all->claims];
        if (one->verdict == REPORT_NO_DATA) return j->verdict = REPORT_NO_DATA, RP_OK;
        d[i] = report_difference(one->ours.tested, of->number);
    }
    const report_together t = report_joint((size_t)words.n, d);
    j->verdict = j->uncorrected = t.verdict;
    j->text = rp_text(arena, "chi² = %.1f over %d, p = %.2g; with a common shift of %s, %.1f over %d", t.chi2,
                      words.n, t.p, report_number_text(arena, t.shift), t.left, words.n - 1);
    return RP_OK;
}

/* Whether the opposite of an inequality is significant by itself. */
static bool is_opposite(const report_claim *c, const report_judged *j)
{
    const report_chances p = {.effect = report_exceed_p(j->ours.tested, j->against.tested), .margin = NAN};
    return report_exceed(j->ours.tested, j->against.tested, sign_of(c), &p) == REPORT_NOT_REPRODUCED;
}

/* Whether it is the margin alone that leaves a claim open. */
static bool is_within_margin(const report_claim *c, const report_judged *j)
{
    report_claim without = *c;
    report_judged again = *j;
    without.margin = 0.0;
    return decide(&without, NULL, &again) == REPORT_REPRODUCED;
}

/* What explains a verdict, "" for nothing. */
static const char *note_of(rp_arena *arena, const report_claim *c, const report_judged *j)
{
    const bool own = strcmp(c->paper, "ours") == 0;
    if (j->verdict == REPORT_NO_DATA) return "";
    if (j->choice)
        return rp_text(arena, "%s by itself, %s by %s", report_verdict_text(j->chosen, own),
                       report_verdict_text(j->other, own), j->choice);
    if (j->uncorrected != j->verdict)
        return rp_text(arena, "%s without the correction for %zu tests of one question",
                       report_verdict_text(j->uncorrected, own), j->tests);
    if (!isnan(j->z)) return rp_text(arena, "%+.1f se", j->z);
    if (j->verdict == REPORT_OPEN && is_within_margin(c, j))
        return rp_text(arena, "a difference, but within the margin of %g", c->margin);
    if (tests[c->kind].by == BY_SIDE && j->verdict == REPORT_NOT_REPRODUCED && !is_opposite(c, j))
        return rp_text(arena, "a difference of %g or more is excluded", c->margin);
    return c->kind == CLAIM_FORMULA ? "by tests" : "";
}

/* Judge n claims that answer one question: read, decide each by itself, and then with Holm's correction for
 * the number of their tests. */
static rp_status judge_family(const report_claims *all, report_tables *tables, size_t n,
                              const size_t members[], report_judged judged[])
{
    rp_arena *arena = tables->arena;
    double *found = rp_arena_memory(arena, 4 * n, sizeof *found), *raised = found + 2 * n;
    size_t n_tests = 0;
    for (size_t i = 0; i < n; i++) {
        const report_claim *c = &all->claims[members[i]];
        report_judged *j = &judged[members[i]];
        *j = (report_judged){.ours = {.n = NAN}, .z = NAN, .failed = "", .text = ""};
        if (tests[c->kind].by != BY_WORD) RP_TRY(rp_prefix(read_tables(c, tables, j), "claim %s: ", c->id));
        if (j->verdict != REPORT_NO_DATA) j->verdict = decide(c, NULL, j);
        j->uncorrected = j->verdict;
        const report_chances p = chances_of(c, j);
        found[i] = p.effect, found[n + i] = p.margin;
        n_tests += !isnan(p.effect);
    }
    for (size_t k = 0; k < 2 * n; k += n) stats_holm(n, found + k, raised + k);
    for (size_t i = 0; i < n; i++) {
        const report_claim *c = &all->claims[members[i]];
        report_judged *j = &judged[members[i]];
        j->tests = n_tests;
        if (*c->family && !isnan(found[i]))
            j->verdict = decide(c, &(report_chances){raised[i], raised[n + i]}, j);
    }
    return RP_OK;
}

/* A variant that decides too leaves its claim, which stands before it, open where the two differ. */
static void weigh_choice(const report_claims *all, size_t i, report_judged judged[])
{
    for (size_t k = i + 1; k < all->n; k++) {
        const report_claim *variant = &all->claims[k];
        if (strcmp(variant->on, "decides") != 0 || strcmp(variant->of, all->claims[i].id) != 0) continue;
        report_judged *j = &judged[i];
        if (j->verdict == judged[k].verdict || judged[k].verdict == REPORT_NO_DATA) continue;
        j->choice = variant->id, j->chosen = j->verdict, j->other = judged[k].verdict;
        j->verdict = REPORT_OPEN;
    }
}

rp_status report_judge(const report_claims *all, report_tables *tables, report_judged **judged)
{
    size_t *members = rp_arena_memory(tables->arena, all->n, sizeof *members);
    bool *decided = rp_arena_memory(tables->arena, all->n, sizeof *decided);
    *judged = rp_arena_memory(tables->arena, all->n, sizeof **judged);
    for (size_t i = 0; i < all->n; i++) {
        const char *family = all->claims[i].family;
        size_t n = 0;
        for (size_t k = decided[i] ? all->n : i; k < all->n; k++)
            if (k == i || (*family && strcmp(all->claims[k].family, family) == 0))
                decided[members[n++] = k] = true;
        RP_TRY(judge_family(all, tables, n, members, *judged));
    }
    for (size_t i = 0; i < all->n; i++)
        if (all->claims[i].kind == CLAIM_JOINT)
            RP_TRY(judge_joint(tables->arena, all, &all->claims[i], *judged, &(*judged)[i]));
    for (size_t i = 0; i < all->n; i++) {
        const report_claim *c = &all->claims[i];
        report_judged *j = &(*judged)[i];
        weigh_choice(all, i, *judged);
        j->word = report_verdict_text(j->verdict, strcmp(c->paper, "ours") == 0);
        j->note = note_of(tables->arena, c, j);
    }
    return RP_OK;
}

bool report_after_a_look(const report_claim *c)
{
    return *c->fixed && strcmp(c->fixed, "before") != 0;
}

bool report_on_page(const report_claim *c)
{
    return !*c->of && strcmp(c->on, "full") != 0;
}

const char *report_count(rp_arena *arena, const report_claims *claims, const report_judged judged[],
                         const char *paper)
{
    size_t counts[REPORT_VERDICTS] = {0}, n = 0;
    const char *text = "";
    for (size_t i = 0; i < claims->n; i++)
        if (!*claims->claims[i].of && strcmp(claims->claims[i].paper, paper) == 0)
            counts[judged[i].verdict]++, n++;
    for (report_verdict v = 0; v < REPORT_NO_DATA && n > 0; v++)
        text = rp_text(arena, "%s%s%zu %s", text, v ? ", " : "", counts[v],
                       report_verdict_text(v, strcmp(paper, "ours") == 0));
    return text;
}
