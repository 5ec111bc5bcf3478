/* The published claims, report/claims.tsv, and what our tables say of them. */
#ifndef REPORT_CLAIMS_H
#define REPORT_CLAIMS_H

#include "report/cells.h"
#include "report/verdict.h"

/* How a claim is tested: by what the word in the column `test` means. */
typedef enum {
    CLAIM_AGREES,      /* ours is the published number, within two standard errors of the difference */
    CLAIM_SAME,        /* equivalence: the difference from `against` lies within the margin */
    CLAIM_ABOVE,       /* ours exceeds `against` by two standard errors of the difference */
    CLAIM_BELOW,       /* ours is below `against` by two standard errors of the difference */
    CLAIM_LEAST,       /* ours, whose error does not count, is at least `against` */
    CLAIM_MOST,        /* ours, whose error does not count, is at most `against` */
    CLAIM_EQUALS,      /* ours, whose error does not count, is the published number within the margin */
    CLAIM_ORDER,       /* ours over `against` is 1 within a factor, the margin */
    CLAIM_INDEPENDENT, /* equivalence: the change lies within the margin */
    CLAIM_RISES,       /* the change is a significant rise */
    CLAIM_FALLS,       /* the change is a significant fall */
    CLAIM_JOINT,       /* the claims in `answer`, all of agrees, by chi^2 together */
    CLAIM_FORMULA,     /* the unit test in `answer` */
    N_CLAIM_TESTS
} report_test;

/* Columns of text in report/claims.tsv. There may be none of those below. */
#define REPORT_CLAIM_TEXTS(X)                                                                                \
    X(id)                                                                                                    \
    X(of)                                                                                                    \
    X(paper)                                                                                                 \
    X(place)                                                                                                 \
    X(section)                                                                                               \
    X(test)                                                                                                  \
    X(published)                                                                                             \
    X(published_se)                                                                                          \
    X(answer)                                                                                                \
    X(against)                                                                                               \
    X(statement)                                                                                             \
    X(note)

/* A row of report/claims.tsv. The texts point into its table, "" for what is not said. */
#define X(column) const char *column;
typedef struct {
    REPORT_CLAIM_TEXTS(X)
#undef X
    report_test kind;
    const char *family; /* of claims that answer one question */
    const char *on;     /* "page"; "full": not on it; of a variant "decides": see below */
    const char *error;  /* what the printed +- is: "se" (or ""), "sd", or "ours": see agrees */
    const char *fixed, *says,
        *unit;           /* when the test was fixed; the paper's word for a number; "" for degrees */
    stats_number number; /* published, with its standard error; NaN: none */
    report_reference *answers, *againsts; /* cells of both sides; NULL: none, or for `against` a number, */
    double limit;                         /* this */
    double samples, margin;               /* 0: not said; INFINITY: none */
} report_claim;

typedef struct {
    rp_table *table;
    report_claim *claims;
    size_t n;
} report_claims;

/* Errors: RP_BAD_INPUT with file and line (unknown test, a claim twice, a number or answer that its test
 * needs), those of rp_table_read. */
rp_status report_claims_read(rp_arena *arena, const char *path, report_claims *claims);

/* The claim called `id`; of a variant, the paper's number is that of the claim it varies. Errors:
 * RP_BAD_INPUT. */
rp_status report_claims_find(const report_claims *claims, const char *id, const report_claim **claim);

/* The published number as it is printed there, with its error, or the paper's word; "" for none. */
const char *report_published(rp_arena *arena, const report_claim *claim);

/* Between a number and its interval of 90 %. */
#define REPORT_INTERVAL " (90 %: "

/* A claim judged by tables. */
typedef struct {
    report_number ours, against;
    report_change change;                /* of what may depend on something, */
    double dof;                          /* with so many degrees of freedom; NaN: its error is known */
    report_verdict verdict, uncorrected; /* for the other tests of its family, */
    size_t tests;                        /* so many */
    double z;                            /* of an agreement: difference in standard errors */
    const char *failed;                  /* runs without a result, see report_failed */
    const char *text;                    /* ours, as the report shows it */
    const char *choice;                  /* variant that says otherwise, which leaves the claim open; NULL */
    report_verdict chosen, other;        /* then, what the claim says by itself, and what that variant */
    const char *word, *note;             /* the verdict, and what explains it */
} report_judged;

/* Every claim. Errors: RP_BAD_INPUT (a table without the cells that it names), those of rp_table_read. */
rp_status report_judge(const report_claims *claims, report_tables *tables, report_judged **judged);

/* Was its test fixed after a look at some of the runs? */
bool report_after_a_look(const report_claim *claim);

/* Is a claim a row of the page: no variant, and not in the full table alone? */
bool report_on_page(const report_claim *claim);

/* "12 reproduced, 5 not reproduced, ..." of all that a paper says, without variants; "" for none. */
const char *report_count(rp_arena *arena, const report_claims *claims, const report_judged judged[],
                         const char *paper);

#endif
