/* Shared by the test files, which name these headers no more. A suite: a function, a line in the list. */
#ifndef CHECK_H
#define CHECK_H

#include <CUnit/CUnit.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/status.h"

/* In the order in which they run: unit tests, then the validation of the simulator against closed forms. */
#define CHECK_UNIT(X)                                                                                        \
    X(suite_core)                                                                                            \
    X(suite_arena)                                                                                           \
    X(suite_sparse)                                                                                          \
    X(suite_analytic)                                                                                        \
    X(suite_angle)                                                                                           \
    X(suite_calibrate_text)                                                                                  \
    X(suite_identify)                                                                                        \
    X(suite_claims)                                                                                          \
    X(suite_trend)                                                                                           \
    X(suite_dem)                                                                                             \
    X(suite_threads)                                                                                         \
    X(suite_removal)                                                                                         \
    X(suite_expression)                                                                                      \
    X(suite_experiment)                                                                                      \
    X(suite_actions)                                                                                         \
    X(suite_mixing)                                                                                          \
    X(suite_fills)                                                                                           \
    X(suite_material)                                                                                        \
    X(suite_kinds)                                                                                           \
    X(suite_units)                                                                                           \
    X(suite_sizes)                                                                                           \
    X(suite_laws)                                                                                            \
    X(suite_motion)                                                                                          \
    X(suite_soft)                                                                                            \
    X(suite_hard)                                                                                            \
    X(suite_midpoint)                                                                                        \
    X(suite_ledger)                                                                                          \
    X(suite_snapshot)                                                                                        \
    X(suite_run)                                                                                             \
    X(suite_walls)                                                                                           \
    X(suite_docs)                                                                                            \
    X(suite_examples)                                                                                        \
    X(suite_scene)                                                                                           \
    X(suite_keys)                                                                                            \
    X(suite_schemas)                                                                                         \
    X(suite_wrong)                                                                                           \
    X(suite_helpers)                                                                                         \
    X(suite_figures)                                                                                         \
    X(suite_evidence)                                                                                        \
    X(suite_options)                                                                                         \
    X(suite_tables)                                                                                          \
    X(suite_columns)                                                                                         \
    X(suite_notes)                                                                                           \
    X(suite_stress)                                                                                          \
    X(suite_repose)                                                                                          \
    X(suite_sweep)                                                                                           \
    X(suite_drill)                                                                                           \
    X(suite_model)                                                                                           \
    X(suite_power)                                                                                           \
    X(suite_flux)                                                                                            \
    X(suite_drop)                                                                                            \
    X(suite_help)                                                                                            \
    X(suite_folders)                                                                                         \
    X(suite_install)                                                                                         \
    X(suite_cli)                                                                                             \
    X(suite_view)                                                                                            \
    X(suite_export)                                                                                          \
    X(suite_golden)                                                                                          \
    X(suite_equilibrium)                                                                                     \
    X(suite_piles)                                                                                           \
    X(suite_rooms)                                                                                           \
    X(suite_places)                                                                                          \
    X(suite_property)                                                                                        \
    X(suite_fuzz)
#define CHECK_VALIDATION(X)                                                                                  \
    X(suite_scaling)                                                                                         \
    X(suite_models)                                                                                          \
    X(suite_impact)                                                                                          \
    X(suite_contacts)                                                                                        \
    X(suite_incline)                                                                                         \
    X(suite_rotation)                                                                                        \
    X(suite_published)                                                                                       \
    X(suite_order)                                                                                           \
    X(suite_stability)                                                                                       \
    X(suite_extreme)                                                                                         \
    X(suite_chaos)                                                                                           \
    X(suite_implicit)                                                                                        \
    X(suite_precision)                                                                                       \
    X(suite_calibration)

#define X(suite) void suite(void);
CHECK_UNIT(X)
CHECK_VALIDATION(X)
#undef X

/* A suite: its tests in the order in which they run, each named as its function, with blanks for underscores
 * and without "test ". SUMMED: the last reads what the others left, which then run before it in the same
 * process. WITHIN: with what is done before each test, and after it even where the test has ended early. */
#define CHECK_SUITE(suite, title, ...)        CHECK_SUITE_OF(suite, title, NULL, NULL, false, __VA_ARGS__)
#define CHECK_SUITE_SUMMED(suite, title, ...) CHECK_SUITE_OF(suite, title, NULL, NULL, true, __VA_ARGS__)
#define CHECK_SUITE_WITHIN(suite, title, before, after, ...)                                                 \
    CHECK_SUITE_OF(suite, title, before, after, false, __VA_ARGS__)
#define CHECK_SUITE_OF(suite, title, before, after, summed, ...)                                             \
    void suite_##suite(void)                                                                                 \
    {                                                                                                        \
        check_suite(title, before, after, summed, #__VA_ARGS__, (check_test *const[]){__VA_ARGS__});         \
    }
typedef void check_test(void);
void check_suite(const char *suite, check_test *before, check_test *after, bool summed, const char *names,
                 check_test *const tests[]);

/* Memory of malloc that is freed at the end of its pointer's scope. */
#define scoped __attribute__((cleanup(check_free)))
void check_free(void *pointer);

/* True in the sanitizer build, where long tests take a smaller size. */
bool check_fast(void);

/* A part of a test is left out, or all of it, and why: a line of the output, and the summary has their
 * numbers. A test that is left out is none that passed. */
void check_skip(const char *reason);
void check_skip_test(const char *reason);

/* True in the sanitizer build, where the test is left out for this reason. */
#define CHECK_SKIPS(reason) (check_fast() && (check_skip_test(reason), true))

/* True for `check --full`, where validation takes its full size. */
bool check_full(void);

/* The stream of a table of the suite that NAME begins with, for NAME chaos_fit DIR/chaos/fit.tsv, for chaos
 * DIR/chaos/chaos.tsv, with its provenance, finished at the end of its scope; NULL unless `check --full -o
 * DIR`. Columns as of rp_table_header; NULL: notes come first. */
#define CHECK_TABLE(out, name, columns)                                                                      \
    __attribute__((cleanup(check_table_close))) FILE *out = check_table(name, columns)
FILE *check_table(const char *name, const char *columns);
void check_table_close(FILE **table);

/* A row of the table, if there is one: numbers, and a last word, or NULL. */
#define CHECK_ROW(table, word, ...)                                                                          \
    check_row(table, sizeof((double[]){__VA_ARGS__}) / sizeof(double), (double[]){__VA_ARGS__}, word)
void check_row(FILE *table, size_t n, const double values[], const char *word);

/* |a - b| <= tolerance; NaN fails. On failure the values are printed. */
#define CHECK_NEAR(a, b, tolerance) CU_ASSERT(check_near(__FILE__, __LINE__, #a, a, b, tolerance))
bool check_near(const char *file, int line, const char *what, double a, double b, double tolerance);

/* The same for each {a, b}. */
#define CHECK_PAIRS(tolerance, ...)                                                                          \
    check_pairs(__FILE__, __LINE__, #__VA_ARGS__, tolerance,                                                 \
                sizeof((double[][2]){__VA_ARGS__}) / sizeof(double[2]), (const double[][2]){__VA_ARGS__})
void check_pairs(const char *file, int line, const char *rows, double tolerance, size_t n,
                 const double pairs[][2]);

/* It is true; else the text is printed, as by printf. */
#define CHECK_OR_SAY(right, ...)                                                                             \
    CU_ASSERT((right) || (fprintf(stderr, __VA_ARGS__), fputc('\n', stderr), false))

/* A text of this name: what the statement writes to the stream `to`. */
#define CHECK_WRITTEN(text, to, statement)                                                                   \
    scoped char *text = NULL;                                                                                \
    size_t text##_size;                                                                                      \
    FILE *to = open_memstream(&text, &text##_size);                                                          \
    statement;                                                                                               \
    fclose(to)

/* A text, as of printf, that stays for 1023 further ones. */
const char *check_text(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* The text with another part in place of the first `from`, as of check_text. */
const char *check_changed(const char *text, const char *from, const char *to);

/* |found - value| <= tolerance for each {name, value}, by its name; `found` is an expression of NAME, and the
 * tolerance one of NAMED_VALUE. */
typedef struct {
    const char *name;
    double value;
} check_value;
#define NAME        named_->name
#define NAMED_VALUE named_->value
#define CHECK_EACH(found, tolerance, ...)                                                                    \
    do {                                                                                                     \
        const check_value list_[] = {__VA_ARGS__};                                                           \
        for (const check_value *named_ = list_; named_ < list_ + sizeof list_ / sizeof *list_; named_++)     \
            CU_ASSERT(check_near(__FILE__, __LINE__, NAME, found, named_->value, tolerance));                \
    } while (0)

/* The text holds each of these parts. */
#define CHECK_PARTS(text, ...) check_parts(__FILE__, __LINE__, text, (const char *const[]){__VA_ARGS__, NULL})
void check_parts(const char *file, int line, const char *text, const char *const parts[]);

/* The next word of a text whose words stand between these characters; false at its end. */
bool check_word(const char **text, const char *between, char word[static 128]);

/* The call fails with this status, and its message contains `text`. */
#define CHECK_FAILS(call, status, text) CU_ASSERT(check_status(__FILE__, __LINE__, #call, call, status, text))
#define CHECK_OK(call)                  CHECK_FAILS(call, RP_OK, "")
bool check_status(const char *file, int line, const char *call, rp_status got, rp_status expected,
                  const char *text);

/* It fails so, or if `fails` is false it is well. */
#define CHECK_FAILS_IF(fails, call, status, text)                                                            \
    CHECK_FAILS(call, (fails) ? (status) : RP_OK, (fails) ? (text) : "")

#endif
