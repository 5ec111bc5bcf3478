/* The programs from the shell, in a folder of one test, and their tables. The environment variable REPOSE
 * names the program `repose`; `report` is beside it. */
#ifndef PROGRAM_H
#define PROGRAM_H

#include "params/params.h"
#include "table/table.h"
#include "tests/check.h"
#include "tests/folder.h"

/* Output of the last run, also in the files `out` and `err` of the test's folder. */
extern char out[1 << 20], err[1 << 14];

/* Make the folder of a test, and remove it: for check_register_within. */
void enter(void);
void leave(void);

/* Path of a file of the folder, as of check_text. */
const char *path_of(const char *name);

/* A file of the folder, to be written. */
FILE *file_of(const char *name);

/* Write a file. Its name has no special characters of the shell. */
#define write_text(name, ...) file_print(path_of(name), __VA_ARGS__)

/* Read a file whole. */
void slurp(const char *name, char *text, size_t size);

/* Exit status of a line of shell in the folder; -1 after a signal. $REPOSE and $REPORT are the programs. */
int shell(const char *text);
#define shell_line(...) shell(check_text(__VA_ARGS__))

/* A line of shell at the top of the tree succeeds, or what it prints is shown; `$to` is the folder. */
void holds_in_tree(const char *line);

/* Exit status of `repose` and of `report` with these arguments. */
int run(const char *format, ...) __attribute__((format(printf, 1, 2)));
#define run_report(...) run_program("report", "REPORT", check_text(__VA_ARGS__))
int run_program(const char *name, const char *begin, const char *words);

/* Exit status, or 128 and the signal, of the program with these words, in a process that is forked from this
 * one, in its folder, and that begins with `begin`. Its output is in the files `out` and `err` there. */
int run_forked(const char *words, void (*begin)(void));

/* The same in the folder of the test; and with a signal to it, as of fault_signal, while its processor time
 * moves by a second at each look. */
int run_begun(const char *words, void (*begin)(void));
int run_signalled(int signal, const char *part, long n, const char *words);

/* The same where each look is a minute later, so that `repose run` writes a snapshot then. */
int run_by_minutes(int signal, const char *part, long n, const char *words);

/* A successful run leaves standard error empty but for the line that ends `repose run`: no
 * other message, and no progress without a terminal. */
bool good(const char *file, int line, int status);

/* A failure is an exit status and one line that contains `text`. */
bool failed(const char *file, int line, int status, int expected, const char *text);

#define GOOD(...)                CU_ASSERT(good(__FILE__, __LINE__, run(__VA_ARGS__)))
#define FAILS(status, text, ...) CU_ASSERT(failed(__FILE__, __LINE__, run(__VA_ARGS__), status, text))
#define SHELL(text)              CU_ASSERT(shell(text) == 0)
#define SHELL_FAILS(status, text, ...)                                                                       \
    CU_ASSERT(failed(__FILE__, __LINE__, shell_line(__VA_ARGS__), status, text))
/* A successful run prints `text`, among other things. */
#define PRINTS(text, ...) CU_ASSERT(prints(__FILE__, __LINE__, run(__VA_ARGS__), text))
bool prints(const char *file, int line, int status, const char *text);
/* It prints this text alone. */
#define PRINTS_ALL(text, ...) CU_ASSERT(prints_all(__FILE__, __LINE__, run(__VA_ARGS__), text))
bool prints_all(const char *file, int line, int status, const char *text);
/* Runs that fail and print nothing: status, part of the message, and arguments, which are no format. */
typedef struct {
    int status;
    const char *text, *words;
} failure;
#define CHECK_FAILURES(list) check_failures(sizeof(list) / sizeof *(list), list)
void check_failures(size_t n, const failure list[]);
/* Each text is refused with its message (65) as the file that this command reads, and nothing is printed. */
#define CHECK_REFUSED(list, file, words) check_refused_texts(sizeof(list) / sizeof *(list), list, file, words)
void check_refused_texts(size_t n, const char *const list[][2], const char *file, const char *words);
#define REPORTS(...) CU_ASSERT(good(__FILE__, __LINE__, run_report(__VA_ARGS__)))
#define REPORT_FAILS(status, text, ...)                                                                      \
    CU_ASSERT(failed(__FILE__, __LINE__, run_report(__VA_ARGS__), status, text))

/* A table of the folder; free with rp_table_free. A scoped_table is freed at the end of its scope. */
#define scoped_table __attribute__((cleanup(rp_table_free))) rp_table
rp_table read_table(const char *name);
void read_again(rp_table *table, const char *name); /* in place of what it holds */

/* The table that a successful run prints, and in place of what one holds. */
#define TABLE_OF(...)        table_of(__FILE__, __LINE__, run(__VA_ARGS__))
#define AGAIN_OF(table, ...) replace_table(&(table), TABLE_OF(__VA_ARGS__))
rp_table table_of(const char *file, int line, int status);
void replace_table(rp_table *table, rp_table by);

/* Text and number of a cell; a failed assertion, "" and NaN if there is no such cell. */
const char *word(const rp_table *t, size_t row, const char *column);
double cell(const rp_table *t, size_t row, const char *column);

/* A table whose columns must all be read: the end, of a scoped_checked that of its scope, fails, and names
 * them, for columns that `at` has not seen. */
#define scoped_checked __attribute__((cleanup(checked_end))) checked
enum { CHECKED_COLUMNS = 128 };
typedef struct {
    rp_table t;
    bool read[CHECKED_COLUMNS];
} checked;
checked checked_read(const char *name);
/* What the program prints with these arguments: so many rows. */
#define CHECKED_RUN(n_rows, ...) checked_run(__FILE__, __LINE__, n_rows, run(__VA_ARGS__))
checked checked_run(const char *file, int line, size_t n_rows, int status);
double at(checked *c, size_t row, const char *column);
/* The cell is this word. */
#define CHECKED_WORD(c, row, column, text) CU_ASSERT_STRING_EQUAL(checked_word(c, row, column), text)
const char *checked_word(checked *c, size_t row, const char *column);
/* A column with the name of a field of s; of a field with mean and error, NAME and NAME_se. */
#define CHECKED_COLUMN(name, value) ((check_value){name, value})
#define CHECKED_FIELD(s, name)      CHECKED_COLUMN(#name, (s).name)
#define CHECKED_MEAN(s, name)       CHECKED_COLUMN(#name, (s).name.mean), CHECKED_COLUMN(#name "_se", (s).name.se)
/* Columns of a row against n values, within tolerance of 1 + |value|; NaN where the value is NaN. */
void checked_row(checked *c, size_t row, size_t n, const check_value values[], double tolerance);
void checked_end(checked *c);

/* What `out` has in a column of the row that begins with this word. */
typedef struct {
    const char *begin, *column, *expected;
} cell_says;
#define CHECK_CELLS(...)                                                                                     \
    check_cells(__LINE__, sizeof((cell_says[]){__VA_ARGS__}) / sizeof(cell_says), (cell_says[]){__VA_ARGS__})
void check_cells(int line, size_t n, const cell_says cells[]);

/* A number just beyond an end of a parameter's range, "" for none that can be typed. */
const char *beyond_range(const rp_param *p, bool upper);

/* The same rows and columns, as text. */
bool equal_tables(const char *name_a, const char *name_b);

#endif
