/* From a table to a verdict to the words of the report: fixtures whose answers are known. And the sweeps of
 * the papers against the settings that report/claims.tsv states. */
#include <ctype.h>
#include <glob.h>
#include <libconfig.h>
#include <unistd.h>

#include "dem/scene/text.h"
#include "report/verdict.h"
#include "sweeps/engine/private.h"
#include "sweeps/protocols/protocols.h"
#include "tests/program.h"

/* ---- from a table to the words of the report ---- */

#define CLAIMS                                                                                               \
    "id\tof\tpaper\tplace\tsection\ttest\tpublished\tpublished_se\tsamples\tmargin\tanswer\t"                \
    "against\tstatement\tnote\n"

/* A test, the published number, the rows of ours, the verdict and the words of the cell `ours`. Errors of 1
 * and of 0.75 decide between one standard error and two; p_value and p_holm lie on two sides of 5 %. */
static const struct {
    const char *test, *published, *se, *samples, *margin, *answer, *against, *verdict, *ours;
} answers[] = {
    {"agrees", "20", "0", "0", "9", "t k=1 a", "-", "reproduced", "21.5 ± 1.0"},
    {"agrees", "20", "0", "0", "1.9", "t k=1 a", "-", "open", "21.5 ± 1.0"},
    {"agrees", "19.4", "0", "0", "9", "t k=1 a", "-", "not reproduced", "21.5 ± 1.0"},
    {"agrees", "18.9", "0.9", "0", "9", "t k=1 a", "-", "reproduced", "21.5 ± 1.0"},
    {"agrees", "18.9", "0.9", "100", "9", "t k=1 a", "-", "reproduced", "21.5 ± 1.0"},
    {"agrees", "20", "0.9", "100", "9", "t k=1 a", "-", "reproduced", "21.5 ± 1.0"},
    {"agrees", "19", "0", "0", "9", "means k=1 a", "-", "reproduced", "21.5 ± 1.0"},
    {"agrees", "19", "0", "0", "9", "means k=2 a", "-", "not reproduced", "21.5 ± 1.0"},
    {"same", "-", "-", "-", "4", "t k=1 a", "t k=2 a", "reproduced",
     "21.5 ± 1.0 against 23.25 ± 0.75 (90 %: -3.8 to 0.3)"},
    {"same", "-", "-", "100", "4", "t k=1 a", "t k=4 a", "open",
     "21.5 ± 1.0 against 23.70 ± 0.75 (90 %: -4.3 to -0.1)"},
    {"same", "-", "-", "-", "0.5", "t k=1 a", "t k=3 a", "not reproduced",
     "21.5 ± 1.0 against 24.20 ± 0.80 (90 %: -4.8 to -0.6)"},
    {"above", "-", "-", "-", "-", "t k=2 a", "t k=1 a", "open", "23.25 ± 0.75 against 21.5 ± 1.0"},
    {"above", "-", "-", "-", "9", "t k=2 a", "t k=1 a", "not reproduced", "23.25 ± 0.75 against 21.5 ± 1.0"},
    {"above", "-", "-", "-", "9", "t k=2 a", "22", "open", "23.25 ± 0.75 against 22"},
    {"above", "-", "-", "-", "9", "t k=6 a", "0", "not reproduced", "0.40 ± 0.80"},
    {"above", "-", "-", "-", "-", "t k=3 a", "t k=1 a", "reproduced", "24.20 ± 0.80 against 21.5 ± 1.0"},
    {"above", "-", "-", "-", "-", "t k=1 a", "t k=3 a", "not reproduced", "21.5 ± 1.0 against 24.20 ± 0.80"},
    {"below", "-", "-", "-", "-", "t k=1 a", "t k=3 a", "reproduced", "21.5 ± 1.0 against 24.20 ± 0.80"},
    {"below", "-", "-", "-", "-", "t k=1 a", "t k=2 a", "open", "21.5 ± 1.0 against 23.25 ± 0.75"},
    {"below", "-", "-", "-", "9", "t k=1 a", "t k=2 a", "not reproduced", "21.5 ± 1.0 against 23.25 ± 0.75"},
    {"below", "-", "-", "-", "-", "t k=3 a", "t k=1 a", "not reproduced", "24.20 ± 0.80 against 21.5 ± 1.0"},
    {"above", "-", "-", "-", "-", "t k=1 a", "means k=1 a_sd", "open", "21.5 ± 1.0 against 17.0 ± 8.5"},
    {"least", "-", "-", "-", "-", "t #count", "7", "reproduced", "7 against 7"},
    {"least", "-", "-", "-", "-", "t #count", "7.5", "not reproduced", "7 against 7.5"},
    {"most", "-", "-", "-", "-", "t #count", "7", "reproduced", "7 against 7"},
    {"most", "-", "-", "-", "-", "t #count", "6", "not reproduced", "7 against 6"},
    {"equals", "20", "-", "-", "1.5", "t k=1 a", "-", "reproduced", "21.5 ± 1.0"},
    {"equals", "20", "-", "-", "1.4", "t k=1 a", "-", "not reproduced", "21.5 ± 1.0"},
    {"order", "10", "-", "-", "3", "t k=1 a", "-", "reproduced", "21.5 ± 1.0"},
    {"order", "10", "-", "-", "2.2", "t k=1 a", "-", "open", "21.5 ± 1.0"},
    {"order", "10", "-", "-", "1.9", "t k=1 a", "-", "not reproduced", "21.5 ± 1.0"},
    {"order", "10", "-", "-", "1.3", "t k=1 a", "t k=2 a", "reproduced", "21.5 ± 1.0 against 23.25 ± 0.75"},
    {"independent", "-", "-", "-", "1", "trend k=1 change", "-", "reproduced",
     "0.10 ± 0.40 (90 %: -0.60 to 0.80)"},
    {"independent", "-", "-", "-", "0.7", "trend k=1 change", "-", "open",
     "0.10 ± 0.40 (90 %: -0.60 to 0.80)"},
    {"independent", "-", "-", "-", "1", "trend k=2 change", "-", "open", "2.0 ± 1.0 (90 %: 0.3 to 3.7)"},
    {"independent", "-", "-", "-", "0.2", "trend k=2 change", "-", "not reproduced",
     "2.0 ± 1.0 (90 %: 0.3 to 3.7)"},
    {"independent", "-", "-", "-", "1", "trend k=3 change", "-", "not reproduced",
     "-3.0 ± 1.0 (90 %: -4.7 to -1.3)"},
    {"independent", "-", "-", "-", "1", "trend k=4 change", "-", "open", "-inf (90 %: -inf to 1.100)"},
    {"rises", "-", "-", "-", "1", "trend k=2 change", "-", "open", "2.0 ± 1.0 (90 %: 0.3 to 3.7)"},
    {"rises", "-", "-", "-", "1", "trend k=3 change", "-", "not reproduced",
     "-3.0 ± 1.0 (90 %: -4.7 to -1.3)"},
    {"falls", "-", "-", "-", "1", "trend k=3 change", "-", "reproduced", "-3.0 ± 1.0 (90 %: -4.7 to -1.3)"},
    {"falls", "-", "-", "-", "1", "trend k=1 change", "-", "not reproduced",
     "0.10 ± 0.40 (90 %: -0.60 to 0.80)"},
    {"above", "-", "-", "-", "-", "nowhere v", "0", "no data", ""},
    {"formula", "-", "-", "-", "-", "angle: x", "-", "reproduced", ""}};
enum { N_ANSWERS = sizeof answers / sizeof *answers };

static void write_claims(void)
{
    FILE *file = file_of("claims.tsv");
    fputs(CLAIMS, file);
    for (size_t i = 0; i < N_ANSWERS; i++)
        fprintf(file, "c%zu\t-\tlh\tplace %zu\tall\t%s\t%s\t%s\t%s\t%s\t%s\t%s\tstatement %zu\tnote %zu\n", i,
                i, answers[i].test, answers[i].published, strcmp(answers[i].se, "0") ? answers[i].se : "-",
                strcmp(answers[i].samples, "0") ? answers[i].samples : "-", answers[i].margin,
                answers[i].answer, answers[i].against, i, i);
    fclose(file);
    write_text("t.tsv", "# count: 7 of 8\n# "
                        "k\ta\ta_se\tb\n1\t21.5\t1\t9\n2\t23.25\t0.75\t9\n3\t24.2\t0.8\t9\n4\t23.7\t0."
                        "75\t9\n6\t0.4\t0.8\t9\n");
    /* of three values Student's t is 4.3 instead of 2; the row has more runs than this output has values */
    write_text("means.tsv",
               "# k\tn\ta_mean\ta_se\ta_n\ta_sd\n1\t100\t21.5\t1\t3\t17\n2\t3\t21.5\t1\t100\t7\n");
    write_text("trend.tsv", "# k\tchange\tchange_se\tchange_lo90\tchange_hi90\tp_value\tp_holm\n"
                            "1\t0.1\t0.4\t-0.6\t0.8\t0.8\t0.9\n2\t2\t1\t0.3\t3.7\t0.03\t0.06\n"
                            "3\t-3\t1\t-4.7\t-1.3\t0.002\t0.01\n4\t-inf\tnan\t-inf\t1.1\tnan\tnan\n");
}

/* In standard errors, or what is excluded. */
static const char *detail_of(size_t i)
{
    const bool agrees = strcmp(answers[i].test, "agrees") == 0;
    if (agrees && strcmp(answers[i].published, "20") == 0 && strcmp(answers[i].se, "0.9") == 0)
        return "+1.1 se"; /* 1.5 over the root of 1 + 0.81 */
    if (agrees) return NULL;
    if ((strcmp(answers[i].test, "above") == 0 || strcmp(answers[i].test, "below") == 0) &&
        strcmp(answers[i].margin, "9") == 0 && strcmp(answers[i].against, "22") != 0)
        return "a difference of 9 or more is excluded";
    return strcmp(answers[i].test, "formula") == 0 ? "by tests" : "-";
}

/* What the table of claims says; `test_section` has the words of the report. */
static void test_verdicts(void)
{
    write_claims();
    REPORTS("claims --claims claims.tsv --tables .");
    scoped_table t = read_table("out");
    CU_ASSERT_FATAL(t.n_rows == N_ANSWERS);
    for (size_t i = 0; i < N_ANSWERS; i++) {
        const char *verdict = word(&t, i, "verdict"), *ours = word(&t, i, "ours");
        CHECK_OR_SAY(
            strcmp(verdict, answers[i].verdict) == 0 &&
                (strcmp(ours, answers[i].ours) == 0 || (!*answers[i].ours && strcmp(ours, "-") == 0)),
            "claim %zu, %s: %s, \"%s\"; expected %s, \"%s\"", i, answers[i].test, verdict, ours,
            answers[i].verdict, answers[i].ours);
        const double n = cell(&t, i, "n"); /* behind the number, where the table says it */
        const bool means = strncmp(answers[i].answer, "means k", 7) == 0 && !strstr(answers[i].answer, "sd");
        CU_ASSERT(means ? n == (answers[i].answer[8] == '1' ? 3.0 : 100.0) : isnan(n));
        if (detail_of(i)) CU_ASSERT_STRING_EQUAL(word(&t, i, "detail"), detail_of(i));
    }
}

/* The same claims as rows, in full: 1.5 over the root of 0.9^2 and of Student's 1.1^2 of 12 values; of the
 * variant 4 over the root of 0.9^2 + 1. The errors of 40 samples are 0.142. */
static void check_claims_table(void)
{
    static const char
        head[] = "\nid\tpaper\tplace\tstatement\ttest\tpublished\tsamples\tanswer\tours\tn\tz\tfixed\tverdict"
                 "\tdetail\tfailed\n",
        one[] = "one\tlh\tfigure 9\tfirst\tagrees\t20 ± 0.9\t40\tmeans/points k=1 a\t21.5 ± "
                "1.0\t12\t1.06\t-\treproduced\t+1.1 se\t2 of 14 (no_pile, overlap)\n",
        two[] = "two\tlh\tfigure 9\tsecond\tagrees\t20 ± 0.9\t40\tt k=1 a\t24.0 ± 1.0\tnan\t2.97\t-\t"
                "not reproduced\t+3.0 se\t-\n",
        three[] =
            "three\tlh\tfigure 9\tthird\tformula\t-\t0\tangle: x\t-\tnan\tnan\t-\treproduced\tby tests\t-\n",
        five[] = "five\tli\t-\tfifth\tabove\t-\t0\tmeans/points k=1 a\t21.5 ± "
                 "1.0\t12\tnan\t-\treproduced\t-\t2 of 14 (no_pile, overlap)\n",
        seven[] =
            "seven\tours\t-\tseventh\tformula\t-\t0\tangle: x\t-\tnan\tnan\t-\tsupported\tby tests\t-\n",
        counts[] = "\n# lh: 3 reproduced, 0 not reproduced, 0 open\n"
                   "# li: 2 reproduced, 0 not reproduced, 0 open\n"
                   "# ours: 1 supported, 0 not supported, 0 open\n";
    static const struct {
        const char *words, *shown[4], *hidden[4];
    } cases[] = {
        {"claims --tables . --variants",
         {"\n# paper: all\n# variants: true\n# lh: ", counts, one, two},
         {NULL}},
        {"claims --tables .", {counts, head, three, seven}, {"\ntwo\t"}},
        {"claims --tables . --paper li",
         {"\n# li: 2 ", head, five, "\nfour\tli\t"},
         {"\n# lh: ", "\n# ours: ", "\none\t", "\nseven\t"}},
        {"claims --tables . --paper ours",
         {"\n# ours: 1 ", head, seven},
         {"\n# lh: ", "\n# li: ", "\nfive\t"}},
        {"claims --tables . --id one", {head, one, two}, {"\n# lh: ", "\n# li: ", "\n# ours: ", "\nthree\t"}},
        {"claims --tables . --id two", {head, two}, {"\n# lh: ", "\none\t"}}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        REPORTS("%s --claims claims.tsv", cases[k].words);
        for (int i = 0; i < 4; i++) {
            const char *shown = cases[k].shown[i], *hidden = cases[k].hidden[i];
            if (shown && !strstr(out, shown)) fprintf(stderr, "%s does not print: %s", cases[k].words, shown);
            CU_ASSERT(!shown || strstr(out, shown));
            CU_ASSERT(!hidden || !strstr(out, hidden));
        }
    }
}

/* A section in short and in full, every character: the variant of a claim stands in full only, marked, and is
 * not counted. Of the paper's number the samples stand in brackets, of ours in a column of their own. */
static void test_section(void)
{
    shell("mkdir -p means more lone end none >out 2>err");
    write_text("claims.tsv", CLAIMS
               "one\t-\tlh\tfigure 9\ts\tagrees\t20\t0.9\t40\t9\tmeans/points k=1 a\t-\tfirst\tat rest\n"
               "two\tone\tlh\tfigure 9\ts\tagrees\t-\t-\t-\t9\tt k=1 a\t-\tsecond\t-\n"
               "three\t-\tlh\tfigure 9\tother\tformula\t-\t-\t-\t-\tangle: x\t-\tthird\ttoo few\n"
               "four\t-\tli\t-\tli\tabove\t-\t-\t-\t-\tmeans/fit k=1 a\t0\tfourth\t-\n"
               "five\t-\tli\t-\tli\tabove\t-\t-\t-\t-\tmeans/points k=1 a\t0\tfifth\t-\n"
               "six\t-\tlh\t-\tno\tleast\t-\t-\t-\t-\tnone/points k=1 a\t0\tsixth\t-\n"
               "seven\t-\tours\t-\town\tformula\t-\t-\t-\t-\tangle: x\t-\tseventh\t-\n");
    write_text("t.tsv", "# k\ta\ta_se\n1\t24\t1\n");
    /* a sweep with failed runs, and a fit to its table */
#define SWEEP(name) "# source: " name " D 15\n# failed: "
    write_text("means/points.tsv",
               SWEEP("means") "3 of 15 (no_pile 2, overlap 1)\n# k\tn\tn_failed\ta_mean\ta_se\ta_n\n"
                              "1\t12\t2\t21.5\t1\t12\n2\t0\t1\tnan\tnan\t0\n");
    write_text("none/points.tsv", SWEEP("none") "0 of 15\n# k\ta\n1\t1\n");
    write_text("means/fit.tsv", "# source: means D 15\n# k\ta\ta_se\n1\t3\t1\n");
    write_text(
        "in.md",
        "{{scores s}}\n{{claims lh}}\n{{counts lh}}\n{{scores other}}\n{{claims ours}}\n{{scores own}}\n"
        "{{failures all}}\n");
    REPORTS("page in.md --tables . --claims claims.tsv");
    CU_ASSERT_STRING_EQUAL(
        out, "| the paper says | paper | here | margin | verdict |\n|---|---|---|---|---|\n"
             "| first; at rest | 20 ± 0.9 | 21.5 ± 1.0 | 9 | reproduced |\n"
             "| claim | what it says | paper (samples) | here | values | verdict | note "
             "|\n|---|---|---|---|---|---|---|\n"
             "| one | first | 20 ± 0.9 (40) | 21.5 ± 1.0 | 12 | reproduced | at rest; +1.1 se; 2 of 14 "
             "failed (no_pile, overlap) |\n"
             "| variant two | second | 20 ± 0.9 (40) | 24.0 ± 1.0 |  | not reproduced | +3.0 se |\n"
             "| three | third |  |  |  | reproduced | too few; by tests |\n"
             "| six | sixth |  | 1 |  | reproduced |  |\n"
             "3 reproduced, 0 not reproduced, 0 open\n"
             "| the paper says | paper | here | margin | verdict |\n|---|---|---|---|---|\n"
             "| third; too few |  |  |  | reproduced |\n"
             "| claim | what it says | paper (samples) | here | values | verdict | note "
             "|\n|---|---|---|---|---|---|---|\n"
             "| seven | seventh |  |  |  | supported | by tests |\n"
             "| the paper says | paper | here | margin | verdict |\n|---|---|---|---|---|\n"
             "| seventh |  |  | supported |\n"
             "| `means` | 3 of 15 (no_pile 2, overlap 1) |\n");
    check_claims_table();
    /* a number of one sample; all failed runs of a sweep */
    write_text("claims.tsv",
               CLAIMS "none\t-\tlh\tfigure 9\tother\tabove\t-\t-\t-\t-\tlone/points k=1 a\t0\tnone\t-\n"
                      "one\t-\tlh\tfigure 9\ts\tagrees\t20\t0.9\t1\t9\tmeans/points k=1 a\t-\tfirst\t-\n"
                      "two\t-\tlh\tfigure 9\ts\tagrees\t20\t0.8\t-\t9\tmeans/points k=1 a\t-\tsecond\t-\n"
                      "three\t-\tlh\tfigure 9\ts\tabove\t-\t-\t-\t-\tmore/points k=1 a\t0\tthird\t-\n"
                      "four\t-\tlh\tfigure 9\ts\tabove\t-\t-\t-\t-\tmore/fit k=1 a\t0\tfourth\t-\n"
                      "last\t-\tlh\tfigure 9\tother\tabove\t-\t-\t-\t-\tend/points k=1 a\t0\tlast\t-\n");
    write_text("lone/points.tsv", SWEEP("lone") "3 of 9 (overlap 3)\n# k\ta\ta_se\n1\t3\t1\n");
    write_text("end/points.tsv", SWEEP("end") "4 of 9 (overlap 4)\n# k\ta\ta_se\n1\t3\t1\n");
    write_text("more/points.tsv", SWEEP("more") "2 of 9\n# k\ta\ta_se\tn\tn_failed\n1\t3\t1\t7\t2\n");
    write_text("more/fit.tsv", "# source: more D 9\n# failed: 2 of 9\n# k\ta\ta_se\n1\t3\t1\n");
    write_text(
        "means/points.tsv",
        SWEEP("means") "1 of 15 (no_pile 1)\n# k\tn\tn_failed\ta_mean\ta_se\ta_n\n1\t12\t1\t21.5\t1\t12\n");
    write_text("in.md", "{{claims lh}}\n{{failures all}}\n");
    REPORTS("page in.md --tables . --claims claims.tsv");
    CHECK_PARTS(out,
                "| 20 ± 0.9 (1) | 21.5 ± 1.0 | 12 | reproduced | +1.1 se; 1 of 13 failed (no_pile 1): the "
                "flattest piles are left out, theta_R is too large |",
                "| 20 ± 0.8 | 21.5 ± 1.0 | 12 | reproduced | +1.1 se; 1 of 13 failed (no_pile 1): ");
    /* a line for each sweep, and no other */
    static const char lines[] = "| 4 of 9 failed (overlap 4) |\n"
                                "| `lone` | 3 of 9 (overlap 3) |\n| `means` | 1 of 15 (no_pile 1) |\n| "
                                "`more` | 2 of 9 (causes not stored) |\n| `end` | 4 of 9 (overlap 4) |\n";
    CU_ASSERT_STRING_EQUAL(out + strlen(out) - strlen(lines), lines);
    /* blanks between the brackets do not count */
    write_text("in.md", "{{ value  means/points k=1  a }}; {{  cell means/points k=1 a_mean %%.2f}}; {{ note "
                        "means/points failed }}\n");
    REPORTS("page in.md --tables . --claims claims.tsv");
    CU_ASSERT_STRING_EQUAL(out, "21.5 ± 1.0; 21.50; 1 of 15 (no_pile 1)\n");
    write_text("in.md", "{{failures lh}}\n");
    REPORT_FAILS(65, "{{failures lh}}: allowed: all", "page in.md --tables . --claims claims.tsv");
}

/* Failed runs are those behind the rows that a claim reads, each row once: by the columns of a table, by the
 * entry of a row in a header, or at grid points by the causes of the whole sweep. */
static void test_failed_cells(void)
{
    shell("mkdir -p s r >out 2>err");
    static const char *const cases[][4] = {
        {"row", "s/points k=1 a", "0", "1 of 5 (overlap)"},
        {"clean", "s/points k=4 a", "0", "-"},
        {"empty", "s/points k=3 a", "0", "5 of 5 (overlap)"},
        {"both", "s/points k=1 a", "s/points k=2 a", "3 of 10 (overlap)"},
        {"once", "s/points k=2 a", "s/points k=2 a", "2 of 5 (overlap)"},
        {"pooled", "s/points k=1 a + r/points k=1 a", "0", "5 of 12 (overlap, no_response 4)"},
        {"pushed", "r/points k=1 a", "0",
         "4 of 7 (no_response 4): the weakest piles are left out, theta_T is too large"},
        {"entry", "s/moved g=2 change", "0", "3 of 8 (overlap 2, no_pile 1)"},
        {"entries", "s/moved g=2 change", "s/moved g=3 change", "7 of 12 (overlap 2, no_pile 5)"},
        {"none", "s/moved g=1 change", "0", "-"},
        {"no cause", "s/moved g=4 change", "0", "1 of 9 (cause not stored)"},
        {"columns", "s/new g=2 change", "0",
         "3 of 10 (no_pile 3): the flattest piles are left out, theta_R is too large"},
        {"without n", "s/less g=1 change", "0", "2 of 2 (overlap 2)"},
        {"two columns", "s/new g=2 change", "s/new g=1 change", "5 of 20 (no_pile 4, overlap 1)"}};
    const char *text = CLAIMS;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        text = check_text("%s%s\t-\tlh\t-\ts\tabove\t-\t-\t-\t-\t%s\t%s\t%s\t-\n", text, cases[k][0],
                          cases[k][1], cases[k][2], cases[k][0]);
    write_text("claims.tsv", "%s", text);
    write_text("s/points.tsv",
               SWEEP("s") "14 of 30 (overlap 14)\n# k\tg\tn\tn_failed\ta_mean\ta_sd\ta_se\ta_n\n"
                          "1\t1\t4\t1\t3\t1\t1\t4\n2\t1\t3\t2\t3\t1\t1\t3\n3\t1\t0\t5\tnan\tnan\tnan\t0\n"
                          "4\t1\t5\t0\t3\t1\t1\t5\n5\t1\t1\t4\t3\t1\t1\t1\n6\t2\t3\t2\t3\t1\t1\t3\n");
    write_text("r/points.tsv",
               SWEEP("r") "4 of 7 (no_response 4)\n# k\tn\tn_failed\ta_mean\ta_sd\ta_se\ta_n\n"
                          "1\t3\t4\t3\t1\t1\t3\n");
    write_text("s/moved.tsv",
               "# derived by: trend x=k\n# source: s D 30\n# failed: 0 of 5; 3 of 8 (overlap 2, no_pile 1); "
               "4 of 4 (no_pile 4); 1 of 9\n# g\tchange\tchange_se\n1\t3\t1\n2\t3\t1\n3\t3\t1\n4\t3\t1\n");
    write_text("s/new.tsv",
               "# source: s D 30\n# units: 1\t1\t1\t1\t1\t1\ng\tn\tchange\tchange_se\tn_failed\tfailed_for\n"
               "1\t8\t3\t1\t2\tno_pile:1,overlap:1\n2\t7\t3\t1\t3\tno_pile:3\n");
    write_text("s/less.tsv",
               "# source: s D 30\ng\tchange\tchange_se\tn_failed\tfailed_for\n1\t3\t1\t2\toverlap:2\n");
    REPORTS("claims --claims claims.tsv --tables .");
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        CHECK_CELLS({cases[k][0], "failed", cases[k][3]});
}

/* A reference finds its row by numbers as numbers and by words as words. */
static void test_references(void)
{
    static const char *const cases[][2] = {{"k=5", "1"},
                                           {"k=5x", "2"},
                                           {"k=50", "3"},
                                           {"k=word", "4"},
                                           {"k=5e1", "3"},
                                           {"k>=6 k<=60", "3"},
                                           {"k>=50 k<=60", "3"},
                                           {"k>=6 k<=50", "3"},
                                           {"k=-.5", "5"},
                                           {"k>=-1 k<=-0.2", "5"},
                                           {"k=1e-6", "6"},
                                           {"k=1.0000001e-6", "7"},
                                           {"k=1000000.0000001", "8"},
                                           {"k=5 v=1", "1"}};
    write_text("claims.tsv", CLAIMS);
    write_text("t.tsv",
               "# k\tv\n5.0\t1\n5x\t2\n50\t3\nword\t4\n-0.5\t5\n0.000001\t6\n1.0000001e-6\t7\n1e6\t8\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        write_text("in.md", "{{cell t %s v}}\n", cases[i][0]);
        REPORTS("page in.md --tables . --claims claims.tsv");
        CU_ASSERT(strncmp(out, cases[i][1], 1) == 0 && out[1] == '\n');
    }
    /* the error is that of the mean or of the number, never the scatter */
    static const char filled[] = "20.0 ± 1.0, 30.00 ± 0.20, 40.00 ± 0.30, 7; 7 7.0 7.12 7.12346 7.1 ok\n| 1 "
                                 "| 7.0 | 20.0 ± 1.0 |\n";
    write_text("t.tsv", "# k\ta_mean\ta_sd\ta_se\tb_deg\tb_sd_deg\tb_se_deg\td_deg\td_deg_se\tc\te\tf\n"
                        "1\t20\t5\t1\t30\t6\t0.2\t40\t0.3\t7\t7.123456\tok\n");
    write_text("in.md", "{{value t k=1 a}}, {{value t k=1 b_deg}}, {{value t k=1 d_deg}}, {{value t k=1 c}}; "
                        "{{cell t k=1 c}} {{cell t k=1 c %%.1f}} {{cell t k=1 e}} {{cell t k=1 e %%.6g}} "
                        "{{cell t k=1 e %%.1f}} {{cell t k=1 f}}\n{{rows t | k c:%%.1f a:+-}}\n");
    REPORTS("page in.md --tables . --claims claims.tsv");
    CU_ASSERT_STRING_EQUAL(out, filled);
    /* from another folder */
    SHELL("mkdir sub && cd sub && \"$REPORT\" page ../in.md --tables .. --claims "
          "../claims.tsv >../out 2>../err");
    CU_ASSERT_STRING_EQUAL(out, filled);
    static const char *const formats[] = {"%.3fx", "%g", "%.17g", "%.3d", "%.3", "%3.f", "x%.3f"};
    for (size_t k = 0; k < sizeof formats / sizeof *formats; k++) {
        write_text("in.md", "{{cell t k=1 e %s%s}}\n", *formats[k] == '%' ? "" : "%", formats[k]);
        REPORT_FAILS(65, "a format such as %.3g or %.0f expected",
                     "page in.md --tables . --claims claims.tsv");
    }
}

/* ---- what a claim needs, families, numbers of the papers ---- */

#define HEADER                                                                                               \
    "id\tof\tpaper\tplace\tsection\ttest\tpublished\tpublished_se\tsamples\tmargin\tfamily\tanswer\t"        \
    "against\tstatement\tnote\n"

#define ASK "claims --claims claims.tsv --tables ."

static void write_claim(const char *test, const char *published, const char *margin, const char *answer,
                        const char *against, const char *note)
{
    write_text("claims.tsv", HEADER "x\t-\tlh\t-\ts\t%s\t%s\t-\t-\t%s\t-\t%s\t%s\tx\t%s\n", test, published,
               margin, answer, against, note);
}

/* The claims are read, or without what they need refused. */
static void check_need_in(const char *claims, bool needed, const char *message)
{
    const int status = run_report("claims --claims %s --tables .", claims);
    CU_ASSERT(needed ? failed(__FILE__, __LINE__, status, 65, message) : good(__FILE__, __LINE__, status));
}

static void check_need(bool needed, const char *message)
{
    check_need_in("claims.tsv", needed, message);
}

/* Which test needs a published number, something to compare with, a margin. All need an answer. */
/* A line that misses its points by twice their errors has twice the error; a variant that decides leaves its
 * claim open where it says otherwise, and another does not. */
static void test_choices(void)
{
#define CHOICE(id, of, on, k) id "\t" of "\tlh\t-\ts\t" on "\tabove\t-\t-\t-\t-\t-\tt k=" k " v\t0\tx\t-\n"
#define JOINT(id, of, on, test, published, answer)                                                           \
    id "\t" of "\tlh\t-\ts\t" on "\t" test "\t" published "\t1\t20\t-\t-\t" answer "\t-\tx\t-\n"
    write_text("t.tsv", "# k\tv\tv_se\tchi2\tdof\n1\t3\t1\t8\t2\n2\t3\t1\t1\t2\n3\t-3\t1\t1\t2\n");
    write_text("claims.tsv",
               "id\tof\tpaper\tplace\tsection\ton\ttest\tpublished\tpublished_se\tsamples\tmargin\t"
               "family\tanswer\tagainst\tstatement\tnote\n" CHOICE("wide", "-", "page", "1")
                   CHOICE("a", "-", "page", "2") CHOICE("a/other", "a", "decides", "3")
                       CHOICE("b", "-", "page", "2") CHOICE("b/other", "b", "full", "3")
                           JOINT("near", "-", "page", "agrees", "3", "t k=2 v")
                               JOINT("far", "-", "page", "agrees", "9", "t k=2 v")
                                   JOINT("both", "-", "page", "joint", "-", "near near")
                                       JOINT("both/other", "both", "decides", "joint", "-", "far far"));
    REPORTS(ASK);
    CHECK_CELLS({"wide", "ours", "3.0 ± 2.0"}, {"a", "ours", "3.0 ± 1.0"}, {"wide", "verdict", "open"},
                {"a", "detail", "reproduced by itself, not reproduced by a/other"}, {"a", "verdict", "open"},
                {"b", "verdict", "reproduced"}, {"both", "verdict", "open"},
                {"both", "detail", "reproduced by itself, not reproduced by both/other"});
}

static void test_needs(void)
{
    static const struct {
        const char *test;
        bool published, against, margin;
    } tests[] = {
        {"agrees", true, false, false}, {"same", false, true, true},    {"above", false, true, false},
        {"below", false, true, false},  {"least", false, true, false},  {"most", false, true, false},
        {"equals", true, false, true},  {"order", false, false, true},  {"independent", false, false, true},
        {"rises", false, false, false}, {"falls", false, false, false}, {"formula", false, false, false}};
    write_text("t.tsv", "v\tv_se\n2\t1\n");
    for (size_t k = 0; k < sizeof tests / sizeof *tests; k++) {
        const char *test = tests[k].test;
        write_claim(test, "20", "2", "t v", "1", "why");
        REPORTS(ASK);
        write_claim(test, "-", "2", "t v", "1", "why");
        check_need(tests[k].published,
                   check_text("claims.tsv:2: claim x: test %s needs a published number", test));
        write_claim(test, "20", "2", "t v", "-", "why");
        check_need(tests[k].against, check_text("test %s needs `against`", test));
        write_claim(test, "20", "-", "t v", "1", "why");
        check_need(tests[k].margin, check_text("test %s needs a margin", test));
        write_claim(test, "20", "2", "-", "1", "why");
        check_need(true, check_text("test %s needs an answer", test));
    }
    /* every column but that of families */
    static const char *const columns[] = {"id",   "of",        "paper",        "place",     "section",
                                          "test", "published", "published_se", "samples",   "margin",
                                          NULL,   "answer",    "against",      "statement", "note"};
    write_claim("agrees", "20", "2", "t v", "1", "why");
    for (int k = 0; k < 15; k++) {
        CU_ASSERT(shell_line("sed 's/^# //' claims.tsv | cut --complement -f %d >less.tsv", k + 1) == 0);
        check_need_in("less.tsv", columns[k],
                      check_text("less.tsv: no column \"%s\"", columns[k] ? columns[k] : ""));
    }
}

/* What stands in two columns of a claim. */
#define CHECK_CLAIM(id, ours, detail) CHECK_CELLS({id, "ours", ours}, {id, "detail", detail})

#define ROW(id, test, margin, family, answer, against)                                                       \
    id "\t-\tlh\t-\ts\t" test "\t-\t-\t-\t" margin "\t" family "\t" answer "\t" against "\t" id "\t-\n"

/* Eight claims of one question. Chances of no effect, 1e-5 twice, 0.0027 twice and more, raised to 0.016 at
 * most; of the margin 0.0228 three times, raised to 0.068 beside 1e-12, and to 0.0455 where they are two. */
static void test_family(void)
{
#define THREE ROW("c", "above", "1", "q", "t k=3 v", "0") ROW("d", "below", "1", "q", "t k=3 v", "0")
    write_text("t.tsv",
               "# k\tv\tv_se\tchange\tchange_se\tchange_lo90\tchange_hi90\tp_value\n"
               "1\t3\t1\t0\t1\t0\t0\t1\n2\t-3\t1\t0\t1\t0\t0\t1\n3\t0\t0.5\t0\t1\t0\t0\t1\n"
               "4\t0.125\t0.125\t0\t1\t0\t0\t1\n5\t0\t1\t4\t1\t2\t6\t1e-5\n6\t0\t1\t-4\t1\t-6\t-2\t1e-5\n");
    write_text(
        "claims.tsv",
        HEADER ROW("a", "above", "-", "q", "t k=1 v", "0") ROW("b", "below", "-", "q", "t k=2 v", "0")
            THREE ROW("e", "above", "1", "q", "t k=3 v", "0") ROW("f", "below", "1", "q", "t k=4 v", "0") ROW(
                "g", "rises", "9", "q", "t k=5 change", "-") ROW("h", "falls", "9", "q", "t k=6 change", "-")
                ROW("i", "above", "1", "-", "t k=3 v", "0") ROW("j", "above", "1", "-", "t k=2 v", "0")
                    ROW("k", "below", "1", "-", "t k=1 v", "0")
                        ROW("l", "above", "9", "-", "t k=1 v + t k=3 v", "0")
                            ROW("m", "rises", "9", "-", "t k=5 change + t k=1 change", "-"));
    REPORTS(ASK);
    CHECK_CLAIM("l", "0.60 ± 0.45", "a difference of 9 or more is excluded"); /* weights 1 and 4 */
    CHECK_CLAIM("m", "2.00 ± 0.71 (90 %: 0.84 to 3.16)", "a difference, but within the margin of 9");
    CHECK_CLAIM("a", "3.0 ± 1.0", "-");
    CHECK_CLAIM("b", "-3.0 ± 1.0", "-");
    static const char *const three[] = {"c", "d", "e"};
    for (size_t k = 0; k < 3; k++)
        CHECK_CLAIM(three[k], "0.00 ± 0.50",
                    "not reproduced without the correction for 8 tests of one question");
    CHECK_CLAIM("f", "0.12 ± 0.12", "a difference of 1 or more is excluded");
    CHECK_CLAIM("g", "4.0 ± 1.0 (90 %: 2.0 to 6.0)", "a difference, but within the margin of 9");
    CHECK_CLAIM("h", "-4.0 ± 1.0 (90 %: -6.0 to -2.0)", "a difference, but within the margin of 9");
    CHECK_CLAIM("i", "0.00 ± 0.50", "a difference of 1 or more is excluded");
    CHECK_CLAIM("j", "-3.0 ± 1.0", "-"); /* the opposite holds */
    CHECK_CLAIM("k", "3.0 ± 1.0", "-");
    write_text("claims.tsv", HEADER ROW("z", "above", "-", "p", "t k=1 v", "0") THREE);
    REPORTS(ASK);
    CHECK_CLAIM("c", "0.00 ± 0.50", "a difference of 1 or more is excluded");
    CHECK_CLAIM("d", "0.00 ± 0.50", "a difference of 1 or more is excluded");
}

/* Agreements together: differences 1.5 and 3.25 of errors 1.25 and 0.75 have chi^2 1.44 + 18.8; the shift
 * that is common to both is their mean, weighted by 0.64 and 1.78. */
static void test_joint_claims(void)
{
    write_text("t.tsv", "# k\ta\ta_se\n1\t21.5\t1\n2\t23.25\t0\n");
    write_text("claims.tsv", HEADER "one\t-\tlh\t-\ts\tagrees\t20\t0.75\t-\t9\t-\tt k=1 a\t-\tx\t-\n"
                                    "two\t-\tlh\t-\ts\tagrees\t20\t0.75\t-\t9\t-\tt k=2 a\t-\tx\t-\n"
                                    "gone\t-\tlh\t-\ts\tagrees\t20\t0.75\t-\t9\t-\tnone k=2 a\t-\tx\t-\n" ROW(
                                        "both", "joint", "-", "-", "one two", "-")
                                        ROW("first", "joint", "-", "-", "one", "-")
                                            ROW("less", "joint", "-", "-", "one gone", "-"));
    REPORTS(ASK);
    const double w1 = 1.0 / 1.5625, w2 = 1.0 / 0.5625, shift = (1.5 * w1 + 3.25 * w2) / (w1 + w2),
                 chi2 = 2.25 * w1 + 3.25 * 3.25 * w2,
                 left = (1.5 - shift) * (1.5 - shift) * w1 + (3.25 - shift) * (3.25 - shift) * w2;
    CHECK_CLAIM("both",
                check_text("chi² = %.1f over 2, p = %.2g; with a common shift of %.2f ± %.2f, %.1f over 1",
                           chi2, exp(-0.5 * chi2), shift, 1.0 / sqrt(w1 + w2), left),
                "-");
    scoped_table t = read_table("out");
    static const char *const verdicts[] = {"reproduced",     "not reproduced", "no data",
                                           "not reproduced", "reproduced",     "no data"};
    for (size_t row = 0; row < 6; row++) CU_ASSERT_STRING_EQUAL(word(&t, row, "verdict"), verdicts[row]);
    /* the printed number is a standard error, or a deviation of so many samples */
    static const char claim[] =
        "id\tof\tpaper\tplace\tsection\ttest\tpublished\tpublished_se\terror\tsamples\tmargin\t"
        "answer\tagainst\tstatement\tnote\nx\t-\tlh\t-\ts\tagrees\t20\t3\t%s\t%s\t9\tt k=2 a\t-\tx\t-\n";
    write_text("claims.tsv", claim, "se", "16");
    REPORTS(ASK);
    CHECK_CLAIM("x", "23.25", "+1.1 se");
    write_text("claims.tsv", claim, "sd", "16");
    REPORTS(ASK);
    CHECK_CLAIM("x", "23.25", "+4.3 se");
    /* or that of as many of our values */
    write_text("t.tsv", "# k\ta_mean\ta_se\ta_n\n2\t21.5\t1\t9\n");
    write_text("claims.tsv", claim, "ours", "16");
    REPORTS(ASK);
    CHECK_CLAIM("x", "21.5 ± 1.0",
                check_text("%+.1f se", 1.5 / hypot(report_of_few((stats_number){0.0, 1.0}, 9.0).se, 0.75)));
    /* a variant has the number of its claim, or is another print with its own */
    write_text("t.tsv", "# k\ta\ta_se\n2\t20\t0\n");
    write_text("claims.tsv", HEADER "one\t-\tlh\t-\ts\tagrees\t20\t0.75\t-\t9\t-\tt k=2 a\t-\tx\t-\n"
                                    "two\tone\tlh\t-\ts\tagrees\t25\t0.75\t-\t9\t-\tt k=2 a\t-\tx\t-\n"
                                    "three\tone\tlh\t-\ts\tagrees\t-\t-\t-\t9\t-\tt k=2 a\t-\tx\t-\n");
    REPORTS(ASK " --variants");
    CHECK_CLAIM("one", "20", "+0.0 se");
    CHECK_CLAIM("two", "20", "-6.7 se");
    CHECK_CLAIM("three", "20", "+0.0 se");
    write_text("claims.tsv", claim, "sd", "-");
    REPORT_FAILS(65, "claim x: error: se, sd of so many samples, or ours expected", ASK);
}

/* The same for each choice that the claims leave open: of k and mu they leave none, one of them by what its
 * paper has elsewhere; of the wall the first and the last. */
static void test_joint_choices(void)
{
    FILE *points = file_of("c.tsv");
    fputs("k\tmu\tslip\twall\ta_mean\ta_se\tn\tn_failed\n", points);
    for (int i = 0; i < 16; i++) {
        const int k = 1 + i / 8, mu = 4 + i / 4 % 2, slip = 3 * (i / 2 % 2), wall = 1 + i % 2;
        fprintf(points, "%d\t%d\t%d\t%d\t%g\t0.5\t%d\t%d\n", k, mu, slip, wall,
                20.0 + 0.5 * k + 0.25 * mu + slip + 0.125 * wall, 10 + k + wall, k * wall);
    }
    fclose(points);
    write_text("claims.tsv", "# at lh: mu=4 k=9\n" HEADER
                             "one\t-\tlh\t-\ts\tagrees\t20\t0.75\t-\t9\t-\tt k=1 mu=5 a\t-\tx\t-\n"
                             "two\t-\tlh\t-\ts\tagrees\t20\t0.75\t-\t9\t-\tt k=2 a\t-\tx\t-\n" ROW(
                                 "both", "joint", "-", "-", "one two", "-"));
    REPORTS("joint --claims claims.tsv --tables . --id both --table c --column a");
    scoped_table t = read_table("out");
    CU_ASSERT(t.n_rows == 4 && strcmp(t.names[0], "slip") == 0 && strcmp(t.names[1], "wall") == 0);
    CU_ASSERT_STRING_EQUAL(rp_table_find_note(&t, "dof"), "2, with a common shift 1");
    for (size_t i = 0; i < t.n_rows; i++) {
        const double wall = 1.0 + (double)(i % 2), rest = 3.0 * (double)(i / 2) + 0.125 * wall;
        stats_number d[] = {{1.75 + rest, 0.5}, {2.0 + rest, 0.5}};
        for (int k = 0; k < 2; k++) d[k].se = hypot(report_of_few(d[k], 11.0 + k + wall).se, 0.75);
        const report_together of = report_joint(2, d);
        CU_ASSERT_STRING_EQUAL(word(&t, i, "wall"), i % 2 ? "2" : "1");
        CHECK_EACH(cell(&t, i, NAME), 1e-4, {"slip", 3.0 * (double)(i / 2)}, {"chi2", of.chi2},
                   {"p_value", of.p}, {"shift", of.shift.value}, {"shift_se", of.shift.se}, {"left", of.left},
                   {"p_left", of.p_left}, {"n_least", 11.0 + wall}, {"n_failed", 3.0 * wall});
    }
}

/* ---- sweeps of the papers against the claims ---- */

/* A number that a sweep may name: a parameter of its file, or, by its default, what a text has besides. */
static const rp_param *find_number(const sweep_plan *plan, const char *key)
{
    const rp_param *p = rp_params_find(plan->protocol->schema, key);
    for (const dem_named_key *named = dem_named_keys; !p && plan->protocol->context && named->key; named++)
        if (strcmp(named->param.name, key) == 0) p = &named->param;
    return p && (p->type == RP_REAL || p->type == RP_INT) ? p : NULL;
}

/* Whether it is this at a grid point. Default damping is the paper's gamma_n = 500. */
static bool has_value(const sweep_plan *plan, const char *key, double value)
{
    const bool own = rp_params_find(plan->protocol->schema, key) != NULL;
    const rp_param *p = find_number(plan, key);
    for (size_t k = 0; k < (own ? plan->n_points : 1); k++) {
        char text[256];
        if (own)
            rp_params_text(p, sweep_plan_point(plan, k), text, sizeof text);
        else
            snprintf(text, sizeof text, "%s", p->fallback ? p->fallback : "");
        if (strcmp(text, "computed") == 0 && strncmp(key, "mu_", 3) == 0) return has_value(plan, "mu", value);
        const double number = strcmp(text, "auto") == 0 ? 500.0 : strtod(text, NULL);
        if (*text && fabs(number - value) <= 1e-9 * fabs(value)) return true;
    }
    return false;
}

/* The sweep file of a table SWEEP/NAME, or NULL. */
static const char *find_sweep(const char *table)
{
    static const char *const folders[] = {"lh", "li", "studies", "val"};
    for (size_t k = 0; k < 4; k++) {
        const char *path = check_text("sweeps/%s/%.*s.cfg", folders[k], (int)strcspn(table, "/"), table);
        if (access(path, F_OK) == 0) return path;
    }
    return NULL;
}

/* The plan of a sweep's file; false: it has models alone. */
static bool open_plan(const char *path, sweep_plan *plan)
{
    RP_ENDS(sweep_recipe_free) sweep_recipe recipe;
    CHECK_OK(sweep_recipe_read(path, &recipe));
    if (recipe.has_runs) CHECK_OK(sweep_plan_read(path, sweep_protocols, plan));
    return recipe.has_runs;
}

/* Every "KEY=VALUE" of the answer and "KEY = VALUE" of the statement is a value of the sweep, and "from KEY =
 * A to B" its ends. What the claims do not say is `at`: of figure 1 the paper says otherwise. */
static size_t check_statement(const char *id, const char *text, const sweep_plan *plan)
{
    size_t n_checked = 0;
    for (const char *equals = text; (equals = strchr(equals, '=')); equals++) {
        const char *end = equals, *begin;
        while (end > text && end[-1] == ' ') end--;
        for (begin = end; begin > text && (isalnum((unsigned char)begin[-1]) || begin[-1] == '_'); begin--) {
        }
        char *after;
        const bool wall = begin - text >= 9 && strncmp(begin - 9, "walls of ", 9) == 0;
        const char *key = check_text("%.*s%s", (int)(end - begin), begin, wall ? "_wall" : "");
        const double value = strtod(equals + 1, &after);
        if (!find_number(plan, key) || after == equals + 1) continue;
        bool right = has_value(plan, key, value);
        double to;
        if (begin - text >= 5 && strncmp(begin - 5, "from ", 5) == 0 && sscanf(after, " to %lf", &to) == 1)
            right &= has_value(plan, key, to);
        CHECK_OR_SAY(right, "claim %s: \"%s\": the sweep has no %s = %g", id, text, key, value);
        n_checked++;
    }
    return n_checked;
}

/* What a claim does not say is as the header line `at` of its paper has it, but for several boxes. */
static void check_at(const rp_table *t, size_t row, const char *path, const sweep_plan *plan)
{
    char key[64];
    const char *at = rp_table_find_note(t, check_text("at %s", word(t, row, "paper")));
    CU_ASSERT_PTR_NOT_NULL_FATAL(at);
    double value;
    for (int used; sscanf(at, " %63[^=]=%lf%n", key, &value, &used) == 2; at += used) {
        static const char *const texts[] = {"answer", "statement", "note"};
        bool mentioned = (strstr(path, "lh2") || strstr(path, "lh_grain") || strstr(path, "lh_wall") ||
                          strstr(path, "lh_size")) &&
                         (*key == 'W' || *key == 'H');
        for (size_t k = 0; k < 3; k++)
            mentioned |= strstr(word(t, row, texts[k]), check_text("%s =", key)) ||
                         strstr(word(t, row, texts[k]), check_text("%s=", key));
        if (mentioned || !find_number(plan, key)) continue;
        CHECK_OR_SAY(has_value(plan, key, value), "claim %s: %s has no %s = %g", word(t, row, "id"), path,
                     key, value);
    }
}

static void test_settings(void)
{
    scoped_table t = {0};
    size_t n_checked = 0;
    CHECK_OK(rp_table_read("report/claims.tsv", &t));
    for (size_t row = 0; row < t.n_rows; row++) {
        static const char *const texts[] = {"answer", "statement", "note"};
        char path[256];
        const char *found = find_sweep(word(&t, row, "answer"));
        if (strcmp(word(&t, row, "paper"), "ours") == 0 || !found) continue;
        strcpy(path, found);
        RP_ENDS(sweep_plan_free) sweep_plan plan = {0};
        if (!open_plan(path, &plan)) continue;
        for (size_t k = 0; k < 3; k++) {
            const char *text = word(&t, row, texts[k]), *others = strstr(text, " + ");
            const int used = (int)(others ? (size_t)(others - text) : strlen(text));
            /* the suite claims compares the cells of a pool */
            n_checked += check_statement(word(&t, row, "id"), check_text("%.*s", used, text), &plan);
        }
        check_at(&t, row, path, &plan);
    }
    CU_ASSERT(n_checked > 100);
}

/* The row that a place of the report reads is one of its sweep. */
static size_t check_place(const char *place)
{
    const char *path = find_sweep(place);
    if (!path || strncmp(path, "sweeps/l", 8) != 0) return 0; /* of the papers */
    RP_ENDS(sweep_plan_free) sweep_plan plan = {0};
    return open_plan(path, &plan) ? check_statement(path, place, &plan) : 0;
}

static size_t places_checked;

static void check_places(const char *page, int number, char *line)
{
    static const char *const words[] = {"{{value ", "{{cell ", "{{rows "};
    (void)page, (void)number;
    for (size_t w = 0; w < sizeof words / sizeof *words; w++)
        for (const char *at = line; (at = strstr(at, words[w]));) {
            at += strlen(words[w]);
            places_checked += check_place(check_text("%.*s", (int)strcspn(at, "}|"), at));
        }
}

static void test_rows(void)
{
    places_checked = 0;
    file_lines("report/text/*.md.in", check_places);
    CU_ASSERT(places_checked > 10);
}

/* A setting of a grid point as the table says it: in the row of this point, or in the header. */
static bool says_setting(const rp_table *t, size_t point, const sweep_plan *plan, const rp_param *param)
{
    char wanted[256], *end, *rest;
    const int column = rp_table_column(t, param->name);
    const char *said =
        column >= 0 ? t->cells[point * t->n_columns + (size_t)column] : rp_table_find_note(t, param->name);
    rp_params_text(param, sweep_plan_point(plan, point), wanted, sizeof wanted);
    if (!said) return true; /* a parameter that is newer than the table */
    static const char *const same[][3] = {{"gamma_n", "500", "auto"}, {"open", "0", "instant"}};
    for (size_t k = 0; k < 2; k++)
        if (strcmp(param->name, same[k][0]) == 0 && strcmp(wanted, same[k][1]) == 0 &&
            strncmp(said, same[k][2], strlen(same[k][2])) == 0)
            return true;
    if (strcmp(wanted, "computed") == 0)
        return strncmp(said, "auto", 4) == 0 || strncmp(said, wanted, 8) == 0;
    const double number = strtod(said, &end), other = strtod(wanted, &rest);
    if (end > said && rest > wanted)
        return fabs(number - other) <= 1e-5 * fabs(other); /* a header has six digits */
    return strncmp(said, wanted, strlen(wanted)) == 0;
}

/* The words of a header line: how many, and whether KEY=VALUE is among them, a number by its value. */
static size_t count_words(const char *text)
{
    size_t n = 0;
    for (const char *c = text; *c; c++) n += *c != ' ' && (c == text || c[-1] == ' ');
    return n;
}

static bool has_word(const char *line, const char *key, const char *text, double number)
{
    char word[512], *end;
    for (const char *c = line; *c; c += strcspn(c, " "), c += strspn(c, " ")) {
        snprintf(word, sizeof word, "%.*s", (int)strcspn(c, " "), c);
        char *value = strchr(word, '=');
        if (!value || strncmp(word, key, strlen(key)) != 0 || word + strlen(key) != value) continue;
        if (text ? strcmp(value + 1, text) == 0 : strtod(value + 1, &end) == number && !*end) return true;
    }
    return false;
}

/* A setting of the file as the header of its table in results has it. */
static bool says_member(const char *line, const config_setting_t *m, size_t *n)
{
    const char *key = config_setting_name(m);
    bool same = true;
    for (int i = 0; !config_setting_is_scalar(m) && i < config_setting_length(m); i++, ++*n)
        same &= has_word(line, key, config_setting_get_string_elem(m, i), 0.0);
    if (!config_setting_is_scalar(m)) return same;
    ++*n;
    const int type = config_setting_type(m);
    if (type == CONFIG_TYPE_BOOL)
        return has_word(line, key, config_setting_get_bool(m) ? "true" : "false", 0.0);
    return has_word(line, key, config_setting_get_string(m),
                    type == CONFIG_TYPE_INT ? config_setting_get_int(m) : config_setting_get_float(m));
}

/* The setting `derive` of a sweep made the table of its name in results, from the runs of these sweeps. */
static void check_derived(const char *sweep, const config_setting_t *setting)
{
    static const char *const others[] = {"table", "with", "rows", "of", "stage"};
    const char *table = "", *with = "", *source = NULL;
    scoped_table t = {0};
    size_t n = 1;
    config_setting_lookup_string(setting, "table", &table);
    config_setting_lookup_string(setting, "with", &with);
    const char *path = check_text("results/%s/%s.tsv", sweep, table);
    if (rp_table_read(path, &t)) return;
    const char *said = rp_table_find_note(&t, "derived by");
    CU_ASSERT_PTR_NOT_NULL_FATAL(said);
    bool same = strncmp(said, with, strlen(with)) == 0;
    for (int i = 0; i < config_setting_length(setting); i++) {
        const config_setting_t *m = config_setting_get_elem(setting, (unsigned)i);
        bool other = false;
        for (size_t k = 0; k < 5; k++) other |= strcmp(others[k], config_setting_name(m)) == 0;
        if (!other) same &= says_member(said, m, &n);
    }
    const config_setting_t *of = config_setting_get_member(setting, "of");
    for (int i = 0; i < (of ? config_setting_length(of) : 1); i++) {
        source = rp_table_next_note(&t, "source", source);
        const char *name = of ? config_setting_get_string_elem(of, i) : sweep;
        same &= source && strncmp(source, name, strlen(name)) == 0 && source[strlen(name)] == ' ';
    }
    same &= n == count_words(said) && !rp_table_next_note(&t, "source", source);
    CHECK_OR_SAY(same, "%s: %s; not the setting of %s", path, said, sweep);
}

/* The runs that a table of results is of: their seed, number, grid points and every setting. */
static void check_runs(const char *file, const char *name, const sweep_recipe *recipe)
{
    scoped_table t = {0};
    RP_ENDS(sweep_plan_free) sweep_plan plan = {0};
    const char *path = check_text("results/%s/points.tsv", name);
    if (rp_table_read(path, &t)) return;
    CHECK_OK(sweep_plan_read(file, sweep_protocols, &plan));
    if (recipe->study) CHECK_OK(sweep_plan_replicate(&plan, recipe->study));
    const char *said = rp_table_find_note(&t, "sweep"),
               *runs =
                   check_text("%s, protocol %s, seed %lu, %zu grid points x %zu replicas", file,
                              plan.protocol->name, (unsigned long)plan.seed, plan.n_points, plan.replicas);
    const bool same = said && strncmp(said, runs, strlen(runs)) == 0 && t.n_rows == plan.n_points;
    CHECK_OR_SAY(same, "%s: %s\n  the sweep has: %s", path, said, runs);
    for (size_t k = 0; k < plan.n_points && same; k++)
        for (const rp_param *p = plan.protocol->schema; p->name; p++)
            CHECK_OR_SAY(says_setting(&t, k, &plan, p), "%s: another %s at point %zu", path, p->name, k);
}

/* A table of results says by which runs it was made: those of its sweep's file, unless changed since. */
static void test_made(void)
{
    static const char *const patterns[] = {"sweeps/lh/*.cfg", "sweeps/li/*.cfg", "sweeps/studies/*.cfg",
                                           "sweeps/val/*.cfg"};
    for (size_t k = 0; k < sizeof patterns / sizeof *patterns; k++) {
        RP_ENDS(globfree) glob_t found;
        CU_ASSERT_FATAL(glob(patterns[k], 0, NULL, &found) == 0);
        for (size_t i = 0; i < found.gl_pathc; i++) {
            RP_ENDS(sweep_recipe_free) sweep_recipe recipe;
            const char *slash = strrchr(found.gl_pathv[i], '/') + 1;
            scoped char *name = strndup(slash, strcspn(slash, "."));
            CHECK_OK(sweep_recipe_read(found.gl_pathv[i], &recipe));
            check_runs(found.gl_pathv[i], name, &recipe);
            const config_setting_t *derive = config_lookup(&recipe.config, "derive");
            for (int j = 0; derive && j < config_setting_length(derive); j++)
                check_derived(name, config_setting_get_elem(derive, (unsigned)j));
        }
    }
}

/* The next member of a model that is a number, other than that of points of a curve. */
static bool next_number(const config_setting_t *model, int *at, double *number)
{
    while (*at < config_setting_length(model)) {
        const config_setting_t *m = config_setting_get_elem(model, (unsigned)(*at)++);
        const int type = config_setting_type(m);
        if ((type != CONFIG_TYPE_INT && type != CONFIG_TYPE_FLOAT) ||
            !strcmp(config_setting_name(m), "points"))
            continue;
        *number = type == CONFIG_TYPE_INT ? config_setting_get_int(m) : config_setting_get_float(m);
        return true;
    }
    return false;
}

/* 45_30_1e-4 has base = 45, alpha_deg = 30, eps = 1e-4; x_1 stands in hundredths. */
static void test_names(void)
{
    static const char *const files[] = {"continuum", "pile", "tent", "triangle"};
    for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
        RP_ENDS(sweep_recipe_free) sweep_recipe recipe;
        const char *path = check_text("sweeps/li/%s.cfg", files[k]);
        CHECK_OK(sweep_recipe_read(path, &recipe));
        const config_setting_t *models = config_lookup(&recipe.config, "model");
        CU_ASSERT_FATAL(models && config_setting_length(models) > 0);
        for (int j = 0; j < config_setting_length(models); j++) {
            const config_setting_t *model = config_setting_get_elem(models, (unsigned)j);
            const char *table = "";
            config_setting_lookup_string(model, "table", &table);
            scoped char *name = strdup(table);
            char *rest = name;
            double set;
            int at = 0;
            bool same = true;
            for (const char *part; (part = strsep(&rest, "_"));) {
                char *end;
                const double number = strtod(part, &end);
                if (end == part || *end) continue;
                same &= next_number(model, &at, &set) && (set == number || set == 0.01 * number);
            }
            same &= !next_number(model, &at, &set);
            CHECK_OR_SAY(same, "%s: %s", path, table);
        }
    }
}

/* What docs/choices.md says of the five printed angles, by its table: which settings have a chance of 5 %. */
static void test_five(void)
{
    size_t pass[2] = {0}, stand = 0;
    for (int falls = 0; falls < 2; falls++) {
        scoped_table t = {0};
        CHECK_OK(rp_table_read(falls ? "results/kept/claims/drop.tsv" : "results/kept/claims/ramp.tsv", &t));
        CU_ASSERT(t.n_rows == 16);
        for (size_t row = 0; row < t.n_rows; row++) {
            const double density = cell(&t, row, "density"), n_least = cell(&t, row, "n_least");
            const bool cut = strcmp(word(&t, row, "slip"), "truncated") == 0,
                       stands = density < (falls ? 0.5 : 2.0),
                       alone = !falls && (cut ? density == 1.0 || density == 1.7 : density == 0.65);
            CU_ASSERT((n_least >= 90.0) == stands);
            CU_ASSERT(density != 2.8 || falls || n_least < (cut ? 30.0 : 15.0));
            CU_ASSERT((n_least <= 1.0) == (density > (falls ? 0.9 : 4.0)));
            if (!stands) continue;
            stand++, pass[0] += alone, pass[1] += cut || density < 0.9;
            CU_ASSERT((cell(&t, row, "p_value") >= 0.05) == alone);
            CU_ASSERT((cell(&t, row, "p_left") >= 0.05) == (cut || density < 0.9));
        }
    }
    CU_ASSERT(stand == 14 && pass[0] == 3 && pass[1] == 12);
    for (int falls = 0; falls < 2; falls++) { /* without k_n = 1e4 */
        scoped_table t = {0};
        CHECK_OK(rp_table_read(
            falls ? "results/kept/claims/drop_four.tsv" : "results/kept/claims/ramp_four.tsv", &t));
        for (size_t row = 0; row < t.n_rows; row++) {
            const double density = cell(&t, row, "density");
            const bool cut = strcmp(word(&t, row, "slip"), "truncated") == 0;
            CU_ASSERT((cell(&t, row, "n_least") >= 90.0) == (!falls || density < 5.0));
            if (falls && density > 5.0) continue;
            CU_ASSERT((cell(&t, row, "p_value") >= 0.05) == (cut && density > (falls ? 0.6 : 0.9)));
        }
    }
    static const char *const tables[] = {"results/lh_ramp/points.tsv", "results/lh_drop/points.tsv"};
    for (int falls = 0; falls < 2;
         falls++) { /* piles fail by overlap, at k_n = 1e4; where grains fall, also at 1e5 */
        scoped_table t = {0};
        CHECK_OK(rp_table_read(tables[falls], &t));
        for (size_t row = 0; row < t.n_rows; row++) {
            const double density = cell(&t, row, "density"), k_n = cell(&t, row, "k_n");
            if (cell(&t, row, "n_failed") == 0.0) continue;
            CU_ASSERT(strncmp(word(&t, row, "failed_for"), "overlap:", 8) == 0 &&
                      !strchr(word(&t, row, "failed_for"), ','));
            CU_ASSERT((k_n == 1e4 && density >= (falls ? 0.4 : 1.7)) ||
                      (falls && k_n == 1e5 && density >= 4.7));
        }
    }
}

/* Numbers, tests and cells of the claims stand a second time in tests/claims.txt: a changed number of a paper
 * is a change of both. */
static void test_claims_again(void)
{
    static const char *const columns[] = {"id",      "paper",  "test",   "published", "published_se", "error",
                                          "samples", "margin", "family", "answer",    "against"};
    char line[4300];
    scoped_table t = {0};
    FILE *in = fopen("tests/claims.txt", "r");
    CU_ASSERT_PTR_NOT_NULL_FATAL(in);
    CHECK_OK(rp_table_read("report/claims.tsv", &t));
    for (size_t row = 0; row < t.n_rows; row++) {
        const char *wanted = "";
        for (size_t k = 0; k < sizeof columns / sizeof *columns; k++)
            wanted = check_text("%s%s%s", wanted, k ? " | " : "", word(&t, row, columns[k]));
        do {
            if (!fgets(line, sizeof line, in)) strcpy(line, "(end of the file)\n");
        } while (*line == '#');
        line[strcspn(line, "\n")] = '\0';
        CHECK_OR_SAY(strcmp(line, wanted) == 0, "tests/claims.txt has   : %s\n  expected: %s", line, wanted);
    }
    CU_ASSERT(fgetc(in) == EOF);
    fclose(in);
}

/* Each committed page, in every cell and verdict, is what the tables in results say. */
static void test_pages(void)
{
    holds_in_tree("for t in report/text/*.md.in; do p=$(basename $t .in); [ -e $p ] || p=docs/$p; "
                  "\"$REPORT\" page $t --tables results,results/kept -o $to/page && diff $p $to/page || "
                  "{ echo \"$p: not what results say: make report; a table that it lacks goes into "
                  "results/kept\"; exit 1; }; done");
}

/* Each table of results is the one whose checksum was taken as it was made, and each has one. */
static void test_checksums(void)
{
    holds_in_tree("cd results && find . -name '*.tsv' | sed 's|^./||' | LC_ALL=C sort | xargs sha256sum | "
                  "diff checksums.txt - && [ -s checksums.txt ]");
}

/* Where the whole history is there, each table was made by commits of it, and by no changed one. */
static void test_commits(void)
{
    holds_in_tree("[ \"$(git rev-parse --is-shallow-repository 2>/dev/null)\" = false ] || exit 0; git "
                  "rev-list HEAD >$to/commits; find results -name '*.tsv' -exec sed -n '/^# program:/p; /^# "
                  "runs made by:/p' {} + | grep -oE 'commit [0-9a-f]+(-dirty)?' | sort -u | while read -r _ "
                  "made; do grep -q \"^$made\" $to/commits || { grep -rl \"commit $made\" results; echo "
                  "\"$made: no commit of this history\"; exit 1; }; done");
}

static void test_remade(void)
{
    if (CHECK_SKIPS("tables that other suites make")) return;
    holds_in_tree("top=$PWD; mkdir $to/copy && cd $to/copy && sh $top/tests/remake.sh $top \"${REPOSE%/*}\"");
}

CHECK_SUITE_WITHIN(evidence, "evidence", enter, leave, test_verdicts, test_section, test_failed_cells,
                   test_references, test_choices, test_needs, test_family, test_joint_claims,
                   test_joint_choices, test_settings, test_five, test_rows, test_made, test_names,
                   test_claims_again, test_pages, test_checksums, test_commits, test_remade)
