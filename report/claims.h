/* The published claims, report/claims.tsv, and what our tables say of them. */
#ifndef REPORT_CLAIMS_H
#define REPORT_CLAIMS_H

#include "cli/cli.h"
#include "report/cells.h"

/* Options of the commands. */
#define REPORT_CLAIMS(X) X(TEXT, claims, "", "report/claims.tsv", "", "file of the claims")
#define REPORT_TABLES(X)                                                                                     \
    X(TEXT, tables, "", "results,build/tables", "",                                                          \
      "folders of tables, joined by commas; a table is read from the first folder that holds it")

/* How a claim is tested: name, word, whether a table answers, meaning. No test decides by a fit that its own
 * means reject: a cell of a row with p_fit < 0.05 leaves the claim undecided. */
#define CLI_CLAIM_TESTS(X)                                                                                   \
    X(AGREES, "agrees", true, "ours is the published number, within two standard errors of the difference")  \
    X(SAME, "same", true, "ours is `against`, within two standard errors of the difference")                 \
    X(ABOVE, "above", true, "ours exceeds `against` by two standard errors of the difference")               \
    X(BELOW, "below", true, "ours is below `against` by two standard errors of the difference")              \
    X(LEAST, "least", true, "ours, whose error does not count, is at least `against`")                       \
    X(MOST, "most", true, "ours, whose error does not count, is at most `against`")                          \
    X(EQUALS, "equals", true, "ours, whose error does not count, is the published number within the margin") \
    X(RATIO, "ratio", true, "ours over `against` is the published number, as in agrees")                     \
    X(ORDER, "order", true,                                                                                  \
      "ours over `against`, or over the published number, is 1 within a factor, the margin")                 \
    X(INDEPENDENT, "independent", true, "equivalence: the change lies within the margin")                    \
    X(RISES, "rises", true, "the change is a significant rise")                                              \
    X(FALLS, "falls", true, "the change is a significant fall")                                              \
    X(CONSTANT, "constant", false, "the published numbers of the claims in `answer` are one, by chi^2")      \
    X(FORMULA, "formula", false, "the unit test in `answer`")                                                \
    X(PICTURE, "picture", false, "no number is possible: the figure in `answer` is judged by eye")           \
    X(UNTESTABLE, "untestable", false, "cannot be tested, for the reason in `note`")

#define X(name, word, table, meaning) CLAIM_##name,
typedef enum { CLI_CLAIM_TESTS(X) CLI_N_CLAIM_TESTS } cli_claim_test;
#undef X

/* Columns of text in report/claims.tsv, with their members. */
#define CLI_CLAIM_TEXTS(X)                                                                                   \
    X(id, id)                                                                                                \
    X(of, of)                                                                                                \
    X(paper, paper)                                                                                          \
    X(place, place)                                                                                          \
    X(section, section)                                                                                      \
    X(test, test_word)                                                                                       \
    X(published, published_text)                                                                             \
    X(published_se, se_text)                                                                                 \
    X(answer, answer)                                                                                        \
    X(against, against)                                                                                      \
    X(statement, statement)                                                                                  \
    X(note, note)

/* A row of report/claims.tsv; the texts point into its table. */
#define X(column, member) const char *member;
typedef struct {
    CLI_CLAIM_TEXTS(X)
#undef X
    cli_claim_test test;
    const char *family;     /* of claims that answer one question; "" without a column of that name */
    stats_number published; /* NaN: none */
    double samples, margin; /* 0: not said; INFINITY: none */
} cli_claim;

typedef struct {
    rp_table *table;
    cli_claim *claims;
    size_t n;
} cli_claims;

/* Errors: RP_BAD_INPUT with file and line (unknown test, a claim twice, a number or answer that its test
 * needs), those of rp_table_read, RP_NO_MEMORY. */
rp_status cli_claims_read(const char *path, cli_claims *claims);

/* The claim called `id`; of a variant, the paper's number is that of the claim it varies. Errors:
 * RP_BAD_INPUT. */
rp_status cli_claims_find(const cli_claims *claims, const char *id, const cli_claim **claim);

/* A claim judged by the tables in `folders`. */
typedef struct {
    stats_verdict verdict, uncorrected; /* for the other tests of its family, */
    size_t tests;                       /* so many */
    bool two_readings;                  /* of the published +-, with different verdicts */
    stats_match match;
    stats_number ours, against;
    stats_number tested, tested_against; /* with the errors that decide */
    stats_change change;
    double n;         /* values behind ours; NaN where the table does not say */
    double dof;       /* of the error of ours; infinite where the test takes it as known */
    double p_fit;     /* of the fit behind a number, of two the smaller one; NaN without a fit */
    char failed[512]; /* runs without a result, see cli_claim_failed */
    char text[256];   /* ours, as the report shows it */
    char reason[512]; /* verdict with what explains it */
} cli_judged;

/* Every claim, in new memory. Errors: RP_BAD_INPUT (a table without the cells that the claim names), those of
 * rp_table_read. */
rp_status cli_claims_judge(const cli_claims *claims, const char *folders, cli_judged **judged);

/* The sweeps whose runs answer a claim, both its sides: those that the commands in the headers of its tables
 * read. Errors: those of rp_table_read, RP_BAD_INPUT for more sweeps. */
enum { CLI_MAX_SWEEPS = 16 };
rp_status cli_claim_sweeps(const cli_claim *claim, const char *folders, cli_sweep sweeps[CLI_MAX_SWEEPS],
                           size_t *n);

/* Runs without a result at the grid points that a claim reads, with their causes and how the mean changes
 * without them: "11 of 185 (no_response 11): the weakest piles are left out, theta_T is too large"; "" if
 * there are none. Points without any result enter no mean. Errors: as cli_claim_sweeps. */
rp_status cli_claim_failed(const cli_claim *claim, const char *folders, char text[512]);

/* "12 reproduced, 5 not reproduced, ..." of a paper's claims, without variants; "" for none. */
void cli_claims_count(const cli_claims *claims, const cli_judged judged[], const char *paper, char text[256]);

/* The published number as it is printed there, with its error and samples; "" for none. */
void cli_claim_published(const cli_claim *claim, char text[128]);

#endif
