/* Verdicts: every word, at its edge and just beyond it; claims.tsv against the tests and figures it names. */
#include <ctype.h>
#include <glob.h>
#include <gsl/gsl_cdf.h>
#include <sys/stat.h>
#include <unistd.h>

#include "report/claims.h"
#include "sweeps/engine/private.h"
#include "sweeps/protocols/protocols.h"
#include "tests/program.h"

/* Numbers that are exact in binary make an edge an edge; one rounding more is `beyond`. */
static const double beyond = 1.0 + 0x1p-40;

#define IS(call, verdict) CU_ASSERT_STRING_EQUAL(report_verdict_text(call, false), verdict)

static stats_number number(double value, double se)
{
    return (stats_number){value, se};
}

static report_verdict exceeds(stats_number a, stats_number b, int sign, double margin)
{
    const report_chances p = {report_exceed_p(a, b), report_exceed_p_margin(a, b, sign, margin)};
    return report_exceed(a, b, sign, &p);
}

static report_verdict agrees(stats_number ours, stats_number published, double margin,
                             const report_chances *raised)
{
    double z;
    return report_agree(ours, published, margin, raised, &z);
}

static void test_agreement(void)
{
    /* 3 and 4 make 5: two standard errors are 10 */
    const stats_number published = number(20.0, 4.0);
    double z;
    IS(agrees(number(30.0, 3.0), published, INFINITY, NULL), "reproduced");
    IS(agrees(number(20.0 + 10.0 * beyond, 3.0), published, INFINITY, NULL), "not reproduced");
    IS(agrees(number(20.0 - 10.0 * beyond, 3.0), published, INFINITY, NULL), "not reproduced");
    IS(agrees(number(21.0, 3.0), published, 10.0, NULL), "reproduced");
    IS(agrees(number(21.0, 3.0), published, 10.0 / beyond, NULL), "open");
    IS(agrees(number(21.0, NAN), published, INFINITY, NULL), "open");
    IS(agrees(number(NAN, 1.0), published, INFINITY, NULL), "open");
    IS(agrees(number(-INFINITY, 1.0), published, INFINITY, NULL), "open");
    IS(agrees(number(2.0, 0.0), number(2.0, 0.0), 0.0, NULL), "reproduced");
    report_agree(number(30.0, 3.0), published, INFINITY, NULL, &z);
    CHECK_NEAR(z, 2.0, 0.0);
    CU_ASSERT_STRING_EQUAL(report_verdict_text(REPORT_REPRODUCED, true), "supported");
    CU_ASSERT_STRING_EQUAL(report_verdict_text(REPORT_NOT_REPRODUCED, true), "not supported");
}

static void test_inequalities(void)
{
    IS(exceeds(number(30.0, 3.0), number(20.0, 4.0), 1, INFINITY), "open");
    IS(exceeds(number(10.0, 3.0), number(20.0, 4.0), 1, INFINITY), "open");
    IS(exceeds(number(20.0 + 10.0 * beyond, 3.0), number(20.0, 4.0), 1, INFINITY), "reproduced");
    IS(exceeds(number(20.0 - 10.0 * beyond, 3.0), number(20.0, 4.0), 1, INFINITY), "not reproduced");
    IS(exceeds(number(20.0 - 10.0 * beyond, 3.0), number(20.0, 4.0), -1, INFINITY), "reproduced");
    IS(exceeds(number(1.0, 0.0), number(1.0, 0.0), 1, INFINITY),
       "not reproduced"); /* exact numbers that are equal */
    IS(exceeds(number(beyond, 0.0), number(1.0, 0.0), 1, INFINITY), "reproduced");
    IS(exceeds(number(5.0, NAN), number(1.0, 0.0), 1, INFINITY), "open");
    IS(exceeds(number(NAN, 0.0), number(1.0, 0.0), 1, 1.0), "open");
    /* so small a difference that the margin, 1.8 standard errors away, is excluded; at 1.6 it is not */
    IS(exceeds(number(20.5, 0.3), number(20.0, 0.4), 1, 1.4), "not reproduced");
    IS(exceeds(number(20.5, 0.3), number(20.0, 0.4), 1, 1.3), "open");
    IS(exceeds(number(20.5, 0.3), number(20.0, 0.4), -1, 1.4), "not reproduced");
    /* on the other side the margin is farther away */
    IS(exceeds(number(19.5, 0.3), number(20.0, 0.4), 1, 0.4), "not reproduced");
    IS(exceeds(number(19.5, 0.3), number(20.0, 0.4), 1, 0.3), "open");
    IS(exceeds(number(20.5, 0.3), number(20.0, 0.4), -1, 0.4), "not reproduced");
    /* a difference that is sure and no margin: less than what counts elsewhere */
    IS(exceeds(number(21.5, 0.3), number(20.0, 0.4), 1, 5.0), "open");
    IS(exceeds(number(21.5, 0.3), number(20.0, 0.4), 1, 2.3), "reproduced");
    IS(exceeds(number(21.5, 0.3), number(20.0, 0.4), -1, 5.0), "not reproduced");
    IS(report_bound(0.05, 0.05, 1), "reproduced");
    IS(report_bound(0.05 / beyond, 0.05, 1), "not reproduced");
    IS(report_bound(0.05, 0.05, -1), "reproduced");
    IS(report_bound(0.05 * beyond, 0.05, -1), "not reproduced");
    IS(report_bound(NAN, 0.05, -1), "open");
    IS(report_order(number(0.5, 0.125), 4.0), "reproduced"); /* 0.25 to 0.75 */
    IS(report_order(number(0.5, 0.125 * beyond), 4.0), "open");
    IS(report_order(number(3.5, 0.25), 4.0), "reproduced");
    IS(report_order(number(3.5, 0.25 * beyond), 4.0), "open");
    IS(report_order(number(0.125, 0.0625), 4.0), "open"); /* 0 to 0.25 */
    IS(report_order(number(0.125, 0.0625 / beyond), 4.0), "not reproduced");
    IS(report_order(number(5.0, 0.25), 4.0), "not reproduced");
    IS(report_order(number(NAN, 0.25), 4.0), "open");
}

static void test_changes(void)
{
    const report_change inside = {-0.5, 0.9, 0.4}, edge = {-0.5, 1.0, 0.4}, low = {-1.0, 0.5, 0.4},
                        rise = {0.2, 3.0, 0.0499}, over = {1.01, 3.0, 0.0499}, under = {-3.0, -1.01, 0.0499},
                        fall = {-3.0, -0.2, 0.0499}, almost = {0.0, 3.0, 0.05}, small = {0.1, 0.9, 0.001},
                        none = {NAN, NAN, NAN}, p_alone = {NAN, NAN, 0.001};
    IS(report_equivalent(&inside, 1.0, NULL), "reproduced");
    IS(report_equivalent(&edge, 1.0, NULL), "open");
    IS(report_equivalent(&low, 1.0, NULL), "open");
    IS(report_equivalent(&rise, 1.0, NULL), "open"); /* a change, but perhaps smaller than any that counts */
    IS(report_equivalent(&over, 1.0, NULL), "not reproduced");
    IS(report_equivalent(&under, 1.0, NULL), "not reproduced");
    IS(report_equivalent(&almost, 1.0, NULL), "open");
    IS(report_equivalent(&small, 1.0, NULL), "reproduced"); /* smaller than any that counts */
    IS(report_equivalent(&none, 1.0, NULL), "open");
    IS(report_trends(&rise, 1, 1.0, NULL), "reproduced");
    IS(report_trends(&rise, -1, 1.0, NULL), "not reproduced");
    IS(report_trends(&fall, -1, 1.0, NULL), "reproduced");
    IS(report_trends(&fall, 1, 1.0, NULL), "not reproduced");
    IS(report_trends(&almost, 1, 1.0, NULL), "open");
    IS(report_trends(&almost, -1, 1.0, NULL), "not reproduced");
    IS(report_trends(&inside, 1, 1.0, NULL), "not reproduced"); /* no change as large as the margin */
    IS(report_trends(&edge, 1, 1.0, NULL), "open");
    IS(report_trends(&edge, -1, 1.0, NULL), "not reproduced"); /* a fall of 1 is excluded */
    IS(report_trends(&low, 1, 1.0, NULL), "not reproduced");
    IS(report_trends(&low, -1, 1.0, NULL), "open");
    IS(report_trends(&none, 1, 1.0, NULL), "open");
    IS(report_trends(&p_alone, 1, 1.0, NULL), "open");
    IS(report_trends(&small, 1, 1.0, NULL), "open"); /* sure, and smaller than any that counts */
    IS(report_trends(&small, 1, 0.9, NULL), "reproduced");
    IS(report_trends(&small, -1, 1.0, NULL), "not reproduced");
    IS(report_trends(&small, 1, 1.0, &(report_chances){0.09, NAN}), "not reproduced");
    IS(report_trends(&small, 1, 0.9, &(report_chances){0.09, NAN}), "open");
    IS(report_trends(&inside, 1, 1.0, &(report_chances){0.9, NAN}), "not reproduced");
    const report_change endless = {-INFINITY, 0.5, 0.01};
    IS(report_equivalent(&endless, 1.0, NULL), "open");
    IS(report_trends(&endless, -1, 1.0, NULL), "open");
    IS(exceeds(number(INFINITY, 0.1), number(1.0, 0.0), 1, INFINITY), "open");
    IS(report_bound(INFINITY, 0.05, 1), "open");
}

/* Chances that a correction may raise: two standard errors are 4.55 %. */
static void test_corrected(void)
{
    const report_change none = {NAN, NAN, NAN};
    const stats_number a = number(30.0, 3.0), b = number(20.0, 4.0);
    CHECK_NEAR(report_exceed_p(a, b), 0.04550026389635839, 1e-14);
    CHECK_NEAR(report_exceed_p(b, a), 0.04550026389635839, 1e-14);
    CU_ASSERT(isnan(report_exceed_p(number(1.0, 0.0), number(2.0, 0.0))));
    IS(report_exceed(a, b, 1, &(report_chances){.effect = 0.0454, .margin = NAN}), "reproduced");
    IS(report_exceed(a, b, -1, &(report_chances){.effect = 0.0454, .margin = NAN}), "not reproduced");
    IS(report_exceed(b, a, 1, &(report_chances){.effect = 0.0454, .margin = NAN}), "not reproduced");
    IS(report_exceed(a, b, 1, &(report_chances){.effect = 0.0456, .margin = NAN}), "open");
    IS(report_exceed(a, b, 1, &(report_chances){.effect = NAN, .margin = NAN}), "open");
    IS(report_exceed(a, b, 1, &(report_chances){.effect = 0.0456, .margin = 0.0499}), "not reproduced");
    IS(report_exceed(a, b, 1, &(report_chances){.effect = 0.0456, .margin = 0.0501}), "open");
    IS(report_exceed(a, b, 1, &(report_chances){.effect = 0.0454, .margin = 0.0499}), "open");
    IS(report_exceed(a, b, 1, &(report_chances){.effect = 0.0454, .margin = 0.0501}), "reproduced");
    CHECK_NEAR(report_exceed_p_margin(a, b, 1, 5.0), gsl_cdf_ugaussian_Q(-1.0), 1e-15);
    CHECK_NEAR(report_exceed_p_margin(b, a, -1, 15.0), gsl_cdf_ugaussian_Q(1.0), 1e-15);
    CHECK_NEAR(report_exceed_p_margin(b, a, 1, 5.0), gsl_cdf_ugaussian_Q(3.0), 1e-15);
    CU_ASSERT(isnan(report_exceed_p_margin(a, b, 1, INFINITY)));
    const stats_number ours = number(25.0, 0.0), theirs = number(20.0, 2.0); /* 2.5 errors: 1.24 % */
    CHECK_NEAR(report_agree_p(-2.5), 0.012419330651552265, 1e-14);
    IS(agrees(ours, theirs, INFINITY, &(report_chances){0.0454, NAN}), "not reproduced");
    IS(agrees(ours, theirs, INFINITY, &(report_chances){0.0456, NAN}), "open"); /* never an agreement */
    IS(agrees(number(20.0, 1.0), number(20.0, 1.0), 3.0, &(report_chances){1.0, NAN}), "reproduced");
    IS(report_equivalent(&none, 1.0, &(report_chances){.effect = 0.2, .margin = 0.0499}), "reproduced");
    IS(report_equivalent(&none, 1.0, &(report_chances){.effect = 0.001, .margin = 0.0499}), "reproduced");
    IS(report_equivalent(&none, 1.0, &(report_chances){.effect = 0.0499, .margin = 0.05}), "not reproduced");
    IS(report_equivalent(&none, 1.0, &(report_chances){.effect = 0.05, .margin = 0.05}), "open");
    IS(report_equivalent(&none, 1.0, &(report_chances){.effect = NAN, .margin = NAN}), "open");
}

/* chi^2 of two degrees of freedom is above x with the chance exp(-x/2): 5 % at 5.99. What a common shift
 * leaves of two numbers is their difference over its error. */
static void test_joint(void)
{
    const stats_number d[] = {{1.2, 1.0}, {-4.2, 2.0}};
    const report_together t = report_joint(2, d);
    IS(t.verdict, "reproduced");
    CHECK_PAIRS(1e-14, {t.chi2, 1.44 + 4.41}, {t.p, exp(-0.5 * t.chi2)},
                {t.shift.value, (1.2 - 4.2 / 4.0) / 1.25}, {t.shift.se, 1.0 / sqrt(1.25)},
                {t.left, 5.4 * 5.4 / 5.0});
    IS(report_joint(2, (const stats_number[]){{2.0, 1.0}, {1.42, 1.0}}).verdict, "not reproduced");
    IS(report_joint(2, (const stats_number[]){{NAN, 1.0}, {1.42, 1.0}}).verdict, "open");
}

static void test_few(void)
{
    CHECK_NEAR(report_of_few(number(3.0, 1.0), 2).se, 12.706204736 / 2.0, 1e-8);
    CHECK_NEAR(report_of_few(number(3.0, 1.0), 21).se, 2.0859634473 / 2.0, 1e-8);
    CHECK_PAIRS(0.0, {report_of_few(number(3.0, 1.0), NAN).se, 1.0},
                {report_of_few(number(3.0, 1.0), 1).se, 1.0});
    CHECK_NEAR(report_deviation_error(3.0, 19), 0.5, 1e-15);
    CU_ASSERT(isnan(report_deviation_error(3.0, 1)) && isnan(report_deviation_error(3.0, NAN)));
    const stats_number q = report_quotient(number(6.0, 0.3), number(2.0, 0.2)); /* 5 % and 10 % */
    CHECK_NEAR(q.value, 3.0, 0.0);
    CHECK_NEAR(q.se, 3.0 * hypot(0.05, 0.1), 1e-15);
    CHECK_NEAR(report_quotient(number(0.0, 0.3), number(2.0, 0.2)).se, 0.15, 1e-15);
}

static void test_counts(void)
{
    RP_SCOPE(arena);
    /* all but a variant are counted */
    report_claim lh[] = {{.of = "", .on = "page", .paper = "lh"},
                         {.of = "", .on = "page", .paper = "lh"},
                         {.of = "", .on = "page", .paper = "li"},
                         {.of = "", .on = "", .paper = "lh"},
                         {.of = "a", .on = "page", .paper = "lh"},
                         {.of = "", .on = "full", .paper = "lh"},
                         {.of = "", .on = "page", .paper = "lh", .kind = CLAIM_JOINT}};
    const report_judged judged[] = {{.verdict = REPORT_NO_DATA},    {.verdict = REPORT_REPRODUCED},
                                    {.verdict = REPORT_OPEN},       {.verdict = REPORT_OPEN},
                                    {.verdict = REPORT_REPRODUCED}, {.verdict = REPORT_REPRODUCED},
                                    {.verdict = REPORT_REPRODUCED}};
    const report_claims all = {.claims = lh, .n = 7};
    CU_ASSERT_STRING_EQUAL(report_count(&arena, &all, judged, "lh"),
                           "3 reproduced, 0 not reproduced, 1 open");
    CU_ASSERT_STRING_EQUAL(report_count(&arena, &all, judged, "ours"), "");
}

/* ---- the claims themselves ---- */

/* Words anywhere; a number not as a part of another one. */
static bool line_holds(const char *line, const char *text)
{
    const size_t n = strlen(text);
    for (const char *at = line; (at = strstr(at, text)); at++)
        if (!isdigit((unsigned char)*text) ||
            ((at == line || !(isdigit((unsigned char)at[-1]) || at[-1] == '.')) &&
             !isdigit((unsigned char)at[n])))
            return true;
    return false;
}

static bool file_holds(const char *path, const char *text)
{
    char line[1024];
    bool found = false;
    FILE *in = fopen(path, "r");
    while (in && !found && fgets(line, sizeof line, in)) found = line_holds(line, text);
    if (in) fclose(in);
    return found;
}

/* "SUITE: TEST" names a test of that suite, by a row of its list, or by a function. */
static bool test_exists(const char *answer)
{
    char name[128];
    const char *colon = strchr(answer, ':');
    if (!colon) return false;
    const char *path = check_text("tests/test_%.*s.c", (int)(colon - answer), answer);
    snprintf(name, sizeof name, "%s(void)", colon + 2);
    for (char *c = name; *c; c++) *c = *c == ' ' ? '_' : *c;
    const char *prefixed = check_text("static void test_%s", name);
    return file_holds(path, check_text("static void %s", name)) || file_holds(path, prefixed);
}

/* The program reads every claim. Those answered by tests name ones that exist. Without tables
 * nothing is reproduced, but by tests. */
static void test_claims_file(void)
{
    enter();
    holds_in_tree("\"$REPORT\" claims --variants --tables /nowhere");
    scoped_table t = read_table("out");
    leave();
    CU_ASSERT(t.n_rows > 100);
    for (size_t row = 0; row < t.n_rows; row++) {
        const char *test = word(&t, row, "test"), *answer = word(&t, row, "answer"),
                   *verdict = word(&t, row, "verdict");
        const bool formula = strcmp(test, "formula") == 0;
        CHECK_OR_SAY((!formula || test_exists(answer)) && formula == (strcmp(verdict, "reproduced") == 0),
                     "claim %s: %s", word(&t, row, "id"), answer);
    }
}

/* How many of the files that match the pattern hold the text; the first of them is named on failure. */
static size_t files_with(const char *pattern, const char *text, bool wanted)
{
    RP_ENDS(globfree) glob_t found;
    size_t n = 0;
    CU_ASSERT_FATAL(glob(pattern, 0, NULL, &found) == 0);
    for (size_t i = 0; i < found.gl_pathc; i++) {
        const bool holds = file_holds(found.gl_pathv[i], text);
        if (holds && !wanted) fprintf(stderr, "%s: \"%s\"\n", found.gl_pathv[i], text);
        n += holds;
    }
    return n;
}

/* The report's texts give no verdict of their own and type no published number; nor do figures and sweeps.
 * Each section of the claims stands once in full, and those of the two papers once in short. */
static void test_report_texts(void)
{
    static const char *const words[] = {"reproduced", "supported", "agrees", "confirmed"};
    static const char *const without_numbers[] = {"report/text/*.md.in", "figures/*/*.gp", "sweeps/*/*.cfg",
                                                  "src/*/*.c", "src/*/*/*.c"};
    scoped_table t = {0};
    for (size_t k = 0; k < sizeof words / sizeof *words; k++)
        CU_ASSERT(files_with("report/text/beyond.md.in", words[k], false) == 0);
    CHECK_OK(rp_table_read("report/claims.tsv", &t));
    for (size_t row = 0; row < t.n_rows; row++) {
        const char *full = check_text("{{claims %s}}", word(&t, row, "paper")),
                   *brief = check_text("{{scores %s}}", word(&t, row, "section"));
        CHECK_OR_SAY(files_with("report/text/claims.md.in", full, true) == 1, "%s: not shown once", full);
        CHECK_OR_SAY(strcmp(word(&t, row, "on"), "page") != 0 ||
                         files_with("report/text/paper-repro.md.in", brief, true) == 1,
                     "%s: not shown once", brief);
        if (strcmp(word(&t, row, "published_se"), "-") == 0) continue; /* round numbers stand elsewhere too */
        for (size_t k = 0; k < sizeof without_numbers / sizeof *without_numbers; k++)
            CU_ASSERT(files_with(without_numbers[k], word(&t, row, "published"), false) == 0);
    }
}

/* ---- numbers and ranks in the report's sentences ---- */

enum { MOST_KNOWN = 20000 };
static double known[MOST_KNOWN];
static size_t n_known;

/* The next number from *text on that is no part of a name; its first character, NULL if there is none. */
static const char *next_number(const char **text, double *number)
{
    for (const char *c = *text; *c; c++) {
        char *end;
        if (!isdigit((unsigned char)*c)) continue;
        *number = strtod(c, &end);
        const bool part = c > *text && (isalnum((unsigned char)c[-1]) || strchr("_./-", c[-1]));
        *text = end;
        if (!part && !isalpha((unsigned char)*end) && *end != '_') return c;
        c = end - 1;
    }
    return NULL;
}

/* Every number of the files is a setting, a published number or a case of the validation. */
static void learn_numbers(const char *path, int line_number, char *line)
{
    (void)path, (void)line_number;
    const char *rest = line;
    for (double number; next_number(&rest, &number);) {
        CU_ASSERT_FATAL(n_known < MOST_KNOWN);
        known[n_known++] = number;
    }
}

static bool is_known(double number)
{
    for (size_t i = 0; i < n_known; i++)
        if (known[i] == number) return true;
    return false;
}

/* Blank what stands between `open` and `close`. */
static void blank(char *line, const char *open, const char *close)
{
    for (char *from = line, *to; (from = strstr(from, open)); from = to) {
        to = strstr(from + strlen(open), close);
        to = to ? to + strlen(close) : from + strlen(from);
        memset(from, ' ', (size_t)(to - from));
    }
}

/* Blank what a work is cited by: "(Nature 435, 188, 2005)". */
static void blank_citations(char *line)
{
    char *open = NULL;
    for (char *c = line; *c; c++) {
        int year = 0;
        if (*c == '(') open = c;
        if (*c != ')' || !open) continue;
        if (c - open > 7 && sscanf(c - 6, ", %4d)", &year) == 1 && year > 1800 && year < 2100)
            memset(open, ' ', (size_t)(c - open));
        open = NULL;
    }
}

/* A sentence types no result: a number with a point or three digits is a setting, and a rank of results
 * stands beside a place that shows it. */
static bool sentence_is_clean(char *line)
{
    static const char *const ranks[] = {" best ",    " worst ", " highest ", " lowest ",
                                        " closest ", "± 0",     "± 1",       "± 2"};
    const bool shown = strstr(line, "{{") != NULL;
    bool clean = true;
    double number;
    blank(line, "{{", "}}");
    blank(line, "`", "`");
    blank(line, "](", ")");
    blank_citations(line);
    for (size_t k = 0; k < sizeof ranks / sizeof *ranks; k++) clean &= shown || !strstr(line, ranks[k]);
    const char *rest = line;
    for (const char *at; (at = next_number(&rest, &number));)
        clean &= is_known(number) ||
                 (number == floor(number) && number < 100.0 && !memchr(at, '.', (size_t)(rest - at)));
    return clean;
}

static void check_sentence(const char *path, int number, char *line)
{
    scoped char *copy = strdup(line);
    CHECK_OR_SAY(strchr("|#", *line) || sentence_is_clean(copy), "%s:%d: typed: %s", path, number, line);
}

static void test_sentences(void)
{
    static const char *const sources[] = {"sweeps/*/*.cfg", "report/claims.tsv", "validation/*.c"};
    char typed[][64] = {"The pile has 18.04 degrees.", "It differs by 2.49 ± 0.3.", "The best pile extends.",
                        "In all 3217 piles were made.", "A few (of 435, 188) fell."},
         clean[][80] = {"W = 4, mu = 0.2: {{value t v}}.", "The best is {{value t v}}, of 400 grains.",
                        "A base that gives way (Powder Technol. 14, 401, 2003) is another one."};
    n_known = 0;
    for (size_t k = 0; k < 3; k++) file_lines(sources[k], learn_numbers);
    for (size_t k = 0; k < sizeof typed / sizeof *typed; k++) CU_ASSERT(!sentence_is_clean(typed[k]));
    for (size_t k = 0; k < sizeof clean / sizeof *clean; k++) CU_ASSERT(sentence_is_clean(clean[k]));
    file_lines("report/text/*.md.in", check_sentence);
}

/* ---- the page that is read: paper-repro.md ---- */

enum { MOST_WORDS = 3500, LONGEST_ROW = 250, LARGEST_PICTURE = 120000 };

/* What follows `open` up to `close` in the line, in turn; NULL after the last. */
static const char *next_between(const char **line, const char *open, char close, char text[256])
{
    const char *start = strstr(*line, open), *end = start ? strchr(start + strlen(open), close) : NULL;
    if (!end) return NULL;
    snprintf(text, 256, "%.*s", (int)(end - start - (long)strlen(open)), start + strlen(open));
    *line = end;
    return text;
}

static bool picture_is_small(const char *name)
{
    struct stat info;
    return stat(check_text("figures/shown/%s", name), &info) == 0 && info.st_size <= LARGEST_PICTURE;
}

static void check_page_line(const char *line)
{
    char text[256];
    const char *rest = line;
    while (next_between(&rest, "](figures/shown/", ')', text))
        CHECK_OR_SAY(picture_is_small(text), "figures/shown/%s: none, or too large", text);
    CHECK_OR_SAY(*line != '|' || strlen(line) <= LONGEST_ROW, "a long row: %s", line);
}

/* The page is short enough to be read, and each claim that belongs on it has a row. */
static void test_page(void)
{
    size_t size;
    scoped char *text = file_read("paper-repro.md", &size);
    scoped_table t = {0};
    CHECK_OK(rp_table_read("report/claims.tsv", &t));
    for (size_t row = 0; row < t.n_rows; row++) {
        if (strcmp(word(&t, row, "on"), "page") != 0) continue;
        const char *note = word(&t, row, "note"),
                   *start = check_text("\n| %s%s%s | ", word(&t, row, "statement"),
                                       strcmp(note, "-") ? "; " : "", strcmp(note, "-") ? note : "");
        CHECK_OR_SAY(strstr(text, start), "paper-repro.md lacks: %s", start + 1);
    }
    /* what its first page counts are the rows of the full table */
    scoped char *full = file_read("docs/claims.md", &size);
    static const char *const papers[] = {"Lee & Herrmann", "Liffman, Chan & Hughes"};
    static const char *const verdicts[] = {" | reproduced | ", " | not reproduced | ", " | open | "};
    for (size_t p = 0; p < 2; p++) {
        int counts[3] = {0};
        const char *row = strstr(full, check_text("\n## %s", papers[p]));
        CU_ASSERT_PTR_NOT_NULL_FATAL(row);
        for (row = strchr(row + 1, '\n'); row && strncmp(row, "\n## ", 4) != 0; row = strchr(row + 1, '\n')) {
            const char *line = check_text("%.*s", (int)strcspn(row + 1, "\n"), row + 1);
            for (int k = 0; k < 3 && strncmp(line, "| variant ", 10) != 0; k++)
                counts[k] += strstr(line, verdicts[k]) != NULL;
        }
        CU_ASSERT(strstr(text, check_text("\n| %s | %d reproduced, %d not reproduced, %d open |\n", papers[p],
                                          counts[0], counts[1], counts[2])) != NULL);
    }
    size_t words = 0, lines = 0;
    for (const char *c = text; *c; c++) words += !strchr(" \n|", *c) && (c == text || strchr(" \n", c[-1]));
    for (char *save, *line = strtok_r(text, "\n", &save); line; line = strtok_r(NULL, "\n", &save), lines++)
        check_page_line(line);
    CU_ASSERT(lines > 150 && words > 1000 && words <= MOST_WORDS);
}

/* A cell of a pool: the grid point of its row, in the larger ensemble of its sweep. */
static void open_cell(char *cell_text, sweep_plan *plan, size_t *point)
{
    char text[64], *save;
    RP_ENDS(sweep_recipe_free) sweep_recipe recipe;
    char *table = strtok_r(cell_text, " ", &save), *key;
    table[strcspn(table, "/")] = '\0';
    const char *path = check_text("sweeps/lh/%s.cfg", table);
    if (access(path, R_OK)) path = check_text("sweeps/studies/%s.cfg", table);
    CHECK_OK(sweep_recipe_read(path, &recipe));
    CHECK_OK(sweep_plan_read(path, sweep_protocols, plan));
    CHECK_OK(sweep_plan_replicate(plan, recipe.study));
    bool fits[128];
    CU_ASSERT_FATAL(plan->n_points <= 128);
    for (size_t k = 0; k < plan->n_points; k++) fits[k] = true;
    for (char *value; (key = strtok_r(NULL, " ", &save)) && (value = strchr(key, '='));) {
        *value++ = '\0';
        const rp_param *param = rp_params_find(plan->protocol->schema, key);
        CU_ASSERT_FATAL(param != NULL);
        char *end;
        const double number = strtod(value, &end);
        for (size_t k = 0; k < plan->n_points; k++) {
            rp_params_text(param, sweep_plan_point(plan, k), text, sizeof text);
            fits[k] &= end == value ? strcmp(text, value) == 0 : strtod(text, NULL) == number;
        }
    }
    size_t n = 0;
    for (size_t k = 0; k < plan->n_points; k++)
        if (fits[k]) *point = k, n++;
    CU_ASSERT_EQUAL(n, 1);
}

/* A parameter of a grid point as text, with what "auto" means at the paper's setting: damping, and at its k_n
 * walls and filling. */
static const char *setting_of(const sweep_plan *plan, size_t point, const rp_param *param, char text[256])
{
    static const char *const same[][3] = {{"gamma_s", "auto", "5"},
                                          {"gamma_n", "auto", "500"},
                                          {"open", "instant", "0"},
                                          {"k_n_wall", "auto", "2e+06"},
                                          {"fill", "auto", "drop"}};
    const void *at = sweep_plan_point(plan, point);
    const rp_param *stiffness = rp_params_find(plan->protocol->schema, "k_n");
    char k_n[256] = "";
    if (stiffness) rp_params_text(stiffness, at, k_n, sizeof k_n);
    const size_t n = sizeof same / sizeof *same - (strcmp(k_n, "1e+06") == 0 ? 0 : 2);
    rp_params_text(param, at, text, 256);
    if (strcmp(text, "computed") == 0) strcpy(text, "auto");
    for (size_t k = 0; k < n; k++)
        if (strcmp(param->name, same[k][0]) == 0 && strcmp(text, same[k][1]) == 0) strcpy(text, same[k][2]);
    return text;
}

/* What is measured at rest, and what turns afterwards, may differ in a pool of angles of repose. */
static void check_one_setting(const sweep_plan *a, size_t at, const sweep_plan *b, size_t bt)
{
    char text[2][256];
    for (const rp_param *p = a->protocol->schema; p->name; p++) {
        const rp_param *q = rp_params_find(b->protocol->schema, p->name);
        if (!q || strncmp(p->name, "theta_t", 7) == 0 || strcmp(p->name, "tilt") == 0) continue;
        if (strcmp(p->name, "v_cut") == 0) continue; /* a claim of its own says that it makes no difference */
        CHECK_OR_SAY(strcmp(setting_of(a, at, p, text[0]), setting_of(b, bt, q, text[1])) == 0,
                     "pooled: %s = %s and %s", p->name, text[0], text[1]);
    }
}

static int by_stream(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Pooled cells are of one setting, and no pile is in two of them. */
static void test_pools(void)
{
    enum { MOST_CELLS = 12, MOST_PILES = 8192 };
    static uint64_t streams[MOST_PILES];
    scoped_table t = {0};
    size_t pools = 0;
    CHECK_OK(rp_table_read("report/claims.tsv", &t));
    for (size_t side = 0; side < 2 * t.n_rows; side++) {
        char text[1024], *rest = text;
        sweep_plan plans[MOST_CELLS];
        size_t points[MOST_CELLS], cells = 0, n = 0;
        const char *less = strstr(word(&t, side / 2, side % 2 ? "against" : "answer"), " less ");
        snprintf(text, sizeof text, "%s",
                 less ? less + 6 : word(&t, side / 2, side % 2 ? "against" : "answer"));
        /* trends are weighted by their errors, bins are of the same piles, a first set has another seed */
        if (!strstr(text, " + ") || strstr(text, "trend") || strstr(text, "rays_") || strstr(text, "/first "))
            continue;
        for (pools++; rest; cells++) {
            char *one = rest, *plus = strstr(rest, " + ");
            rest = plus ? plus + 3 : NULL;
            if (plus) *plus = '\0';
            CU_ASSERT_FATAL(cells < MOST_CELLS);
            open_cell(one, &plans[cells], &points[cells]);
            check_one_setting(&plans[0], points[0], &plans[cells], points[cells]);
            for (size_t k = 0; k < plans[cells].replicas && n < MOST_PILES; k++) {
                const sweep_stream s =
                    sweep_plan_stream(&plans[cells], points[cells] * plans[cells].replicas + k);
                streams[n++] = (uint64_t)s.seed << 32 | s.run;
            }
        }
        qsort(streams, n, sizeof *streams, by_stream);
        for (size_t k = 1; k < n; k++) CU_ASSERT(streams[k] != streams[k - 1]);
        for (size_t k = 0; k < cells; k++) sweep_plan_free(&plans[k]);
    }
    CU_ASSERT(pools > 3);
}

CHECK_SUITE(claims, "claims", test_agreement, test_inequalities, test_changes, test_corrected, test_joint,
            test_few, test_counts, test_claims_file, test_pools, test_report_texts, test_sentences, test_page)
