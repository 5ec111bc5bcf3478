/* Core: parameter schema, parameter files, random streams, tables. */
#include <fcntl.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sort.h>
#include <stdint.h>
#include <sys/stat.h>
#include <unistd.h>

#include "params/config.h"
#include "params/guess.h"
#include "core/elementary.h"
#include "core/version.h"
#include "core/random.h"
#include "core/file.h"
#include "core/plain.h"
#include "table/where.h"
#include "table/table.h"
#include "params/units.h"
#include "tests/folder.h"
#include "tests/faults.h"
#include "tests/numbers.h"

typedef struct {
    double a, b;
    long n;
    bool flag;
    int word;
    const char *text;
    rp_texts many;
} values;

static char folder[FOLDER_PATH];

static void enter(void)
{
    folder_make("core", folder);
}

static void leave(void)
{
    folder_remove(folder);
}

static const rp_param schema[] = {
    {"a", "cm", RP_REAL, offsetof(values, a), "0.5", "(0, 60)", "open range"},
    {"b", "", RP_REAL, offsetof(values, b), "auto", "[0, inf) | infinite | auto", "with words"},
    {"n", "", RP_INT, offsetof(values, n), "auto", "[1, 100] | auto", "whole"},
    {"flag", "", RP_BOOL, offsetof(values, flag), "true", "", "boolean"},
    {"word", "", RP_CHOICE, offsetof(values, word), "second", "first | second | third", "choice"},
    {"text", "", RP_TEXT, offsetof(values, text), "none", "", "text"},
    {"many", "", RP_TEXTS, offsetof(values, many), "", "", "texts"},
    {0}};

static rp_status set(values *v, const char *name, const char *text)
{
    return rp_params_set_text(rp_params_find(schema, name), RP_CGS, v, text);
}

/* A number without a range may be any; a default with a unit is in the units asked for, a word is not. */
static void ranges_and_units(void)
{
    static const rp_param free_one = {"free", "", RP_REAL, 0, "0", "", "no range"};
    double number = 0.0;
    values v;
    CHECK_OK(rp_params_set_text(&free_one, RP_CGS, &number, "-1e300"));
    CHECK_NEAR(number, -1e300, 0.0);
    CHECK_OK(rp_params_set_text(&free_one, RP_CGS, &number, "1e300"));
    rp_params_defaults(schema, RP_SI, &v);
    CHECK_NEAR(v.a, 0.005, 1e-17);
    CU_ASSERT(v.b == -1.0 && v.n == -1 && v.flag && v.word == 1);
}

static void defaults_and_text(void)
{
    values v, back;
    char text[128];
    rp_params_defaults(schema, RP_CGS, &v);
    CU_ASSERT(v.a == 0.5 && v.b == -1.0 && v.n == -1 && v.flag && v.word == 1);
    CU_ASSERT_STRING_EQUAL(v.text, "none");
    CU_ASSERT(v.many.n == 0);
    CHECK_OK(set(&v, "a", "0.1"));
    CHECK_OK(set(&v, "b", "infinite"));
    CHECK_OK(set(&v, "n", "37"));
    CU_ASSERT(isinf(v.b));
    rp_params_defaults(schema, RP_CGS, &back);
    for (const rp_param *p = schema; p->name; p++) /* written values read back exactly */
        if (p->type != RP_TEXTS) CHECK_OK(set(&back, p->name, rp_params_text(p, &v, text, sizeof text)));
    CU_ASSERT(back.a == v.a && isinf(back.b) && back.n == 37 && back.flag && back.word == 1);
    CU_ASSERT_STRING_EQUAL(rp_params_text(&schema[0], &v, text, sizeof text), "0.1");
    strcpy(text, "before"); /* nothing of what the buffer held before */
    CU_ASSERT_STRING_EQUAL(rp_params_text(rp_params_find(schema, "many"), &v, text, sizeof text), "");
    CU_ASSERT_PTR_NULL(rp_params_find(schema, "absent"));
}

static void refused_values(void)
{
    values v;
    rp_params_defaults(schema, RP_CGS, &v);
    static const char *const cases[][3] = {{"a", "60", "a = 60: out of range, allowed: (0, 60) cm"},
                                           {"a", "0", "out of range"},
                                           {"a", "nan", "a number expected"},
                                           {"a", "inf", "a number expected"},
                                           {"a", "1e400", "finite"},
                                           {"a", "infinite", "a number expected"},
                                           {"a", "", "a number expected"},
                                           {"a", "2x", "a number expected"},
                                           {"b", "-1", "b = -1"},
                                           {"n", "1.5", "a whole number expected"},
                                           {"n", "101", "n = 101"},
                                           {"n", "99999999999999999999", "n"},
                                           {"flag", "yes", "true or false"},
                                           {"word", "fourth", "first | second | third"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        CHECK_FAILS(set(&v, cases[i][0], cases[i][1]), RP_BAD_INPUT, cases[i][2]);
    CU_ASSERT(v.a == 0.5 && v.n == -1 && v.word == 1); /* a refused value changes nothing */
}

static XXH128_hash_t sum_of(const rp_param *p, const void *v)
{
    XXH128_hash_t sum = {0, 0};
    for (; p->name; p++) sum = rp_hash_add(sum, rp_params_hash_one(p, v));
    return sum;
}

/* A set of parameters has one hash, in any order of the schema; each value changes it, carries included. */
static void keys(void)
{
    values v;
    rp_param backwards[32] = {{0}};
    size_t n = 0;
    while (schema[n].name) n++;
    for (size_t i = 0; i < n; i++) backwards[i] = schema[n - 1 - i];
    rp_params_defaults(schema, RP_CGS, &v);
    const XXH128_hash_t one = sum_of(schema, &v);
    CU_ASSERT(XXH128_isEqual(one, sum_of(backwards, &v)));
    v.a = nextafter(v.a, 1.0);
    CU_ASSERT(!XXH128_isEqual(one, sum_of(schema, &v)));
    const XXH128_hash_t carry = rp_hash_add((XXH128_hash_t){~0ull, 1}, (XXH128_hash_t){2, 3});
    CU_ASSERT(carry.low64 == 1 && carry.high64 == 5);
}

/* A parameter that a list of many schemas gains keeps the keys of the runs that do not set it. */
static void inherited(void)
{
    struct {
        double a, b;
    } v;
    static const rp_param before[] = {{"a", "", RP_REAL, 0, "1.5", "[0, 2]", "", false}, {0}};
    static const rp_param after[] = {{"a", "", RP_REAL, 0, "1.5", "[0, 2]", "", false},
                                     {"b", "", RP_REAL, sizeof(double), "auto", "[0, 2] | auto", "", true},
                                     {0}};
    rp_params_defaults(after, RP_CGS, &v);
    const XXH128_hash_t one = sum_of(before, &v);
    CU_ASSERT(XXH128_isEqual(one, sum_of(after, &v)));
    v.b = 0.0;
    CU_ASSERT(!XXH128_isEqual(one, sum_of(after, &v)));
}

/* Write `text` to a file, read it through the schema. */
static rp_status read_text(const char *text, values *v)
{
    const char *path = folder_path(folder, "text.cfg");
    file_print(path, "%s", text);
    config_t config;
    rp_params_defaults(schema, RP_CGS, v);
    rp_status status = rp_config_read(path, &config);
    if (!status) status = rp_config_group(config_root_setting(&config), schema, v, NULL);
    v->text = NULL; /* borrowed from the config */
    config_destroy(&config);
    return status;
}

static void files(void)
{
    values v;
    CHECK_OK(read_text("a = 7; // an integer is a number\nb = \"infinite\"; n = 5;", &v));
    CU_ASSERT(v.a == 7.0 && isinf(v.b) && v.n == 5);
    CHECK_FAILS(read_text("a = 1.0;\nc = 2;", &v), RP_BAD_INPUT, ":2: c: unknown key");
    CHECK_FAILS(read_text("a = 1.0;\n\na = 2.0;", &v), RP_BAD_INPUT, ":3: duplicate setting name");
    CHECK_FAILS(read_text("n = 2.5;", &v), RP_BAD_INPUT, ":1: n = 2.5: a whole number expected");
    CHECK_FAILS(read_text("a = \"2.0\";", &v), RP_BAD_INPUT, ":1: a = \"2.0\": a number expected");
    CHECK_FAILS(read_text("a = true;", &v), RP_BAD_INPUT, "a = true: a number expected");
    CHECK_FAILS(read_text("flag = 1;", &v), RP_BAD_INPUT, "flag = 1: true or false expected");
    CHECK_FAILS(read_text("a = 61.5;", &v), RP_BAD_INPUT, ":1: a = 61.5: out of range");
    CHECK_FAILS(read_text("a = 1e400;", &v), RP_BAD_INPUT, "finite");
    CHECK_FAILS(read_text("a = [0, 0.1];", &v), RP_BAD_INPUT, "write 0.0 for 0");
    CHECK_FAILS(read_text("a = (1.0);", &v), RP_BAD_INPUT, "a: one value expected, not a list");
    CHECK_OK(read_text("a = 1.0", &v)); /* the last semicolon may be left out */
    CHECK_FAILS(read_text("word = [1, 2];", &v), RP_BAD_INPUT, "word: one value expected, not a list");
    config_t config;
    CHECK_FAILS(rp_config_read("/no/such/file.cfg", &config), RP_BAD_INPUT, "/no/such/file.cfg: cannot read");
    config_destroy(&config);
    CHECK_FAILS(rp_config_read("/tmp", &config), RP_BAD_INPUT, "is a directory");
    config_destroy(&config);
}

/* A syntax error has its line, in words too. */
static void syntax(void)
{
    static const char *const cases[][2] = {
        {"a = = 1.0;", ":1: syntax error in \"a = = 1.0;\" or before it; expected: key = value;"},
        {"a = 1.0;\n\nword = slow; # 5\nb = 1.0;", ":3: syntax error in \"word = slow; # 5\" or"},
        {"a = 0,5;\r\n", ":1: syntax error in \"a = 0,5;\" or before it; expected: key = value; words in "
                         "quotes, decimal numbers with a point"},
        {"g = {\n a = 1.0;\n", ":3: syntax error at the end of the file: a value, or } ] ) expected"},
        {"g = { a = (1.0, 2.0; };", ":1: syntax error in \"g = {"},
        {"a = 1.0; # note", ":1: a comment without the end of its line"},
        {"a = 1.0; // note", ":1: a comment without the end of its line"},
        {"a = .;", ":1: a = 0: out of range"},
        {"# a note\ntext = \"open;\nb = 1.0;", ":2: a text without its closing quote"},
        {"text = \"open\\\"", ":1: a text without its closing quote"},
        {"a = 1.0;\n/* b = 1.0;\n", ":2: a comment without */"},
        {"a = 1.0; /*/", ":1: a comment without */"}};
    values v;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        CHECK_FAILS(read_text(cases[i][0], &v), RP_BAD_INPUT, cases[i][1]);
}

/* What libconfig would wrap or read for minutes is refused, and comments and texts hold no numbers. */
static void whole_numbers(void)
{
    static const char *const list[][2] = {
        {"n = 0x7fffffffff;", ":1: 0x7fffffffff: whole numbers go up to"},
        {"n = 0X80000000;", ":1: 0X80000000: "},
        {"n = -3000000000;", ":1: -3000000000: "},
        {"n = 5;\r\n\tm\f=[1,2,+2147483648];", ":2: +2147483648: "},
        {"n = 99999999999999999999L;", "99999999999999999999L: "},
        {"// 99999999999\n/* 2147483648 \n */ text = \"4294967296\"; n = 4294967297;", ":3: 4294967297"},
        {"n = 0xffffffffffffffffL;", "0xffffffffffffffffL: "},
        {"/**/n=/*\n*/2147483648", ":2: 2147483648: "},
        {"text = \"\\\"\";n = 2147483648;", "2147483648: "},
        {"\xef\xbb\xbfn = 5;", ":1: begins with a byte-order mark"},
        {"n = 5;\nn = 6; n = 7;", ":2: duplicate setting name in \"n = 6; n = 7;\""},
        {"n = 10#3000000000\n;", NULL},
        {"n = 10//3000000000\n;", NULL},
        {"n = 0x1f;", NULL},
        {"n = 99L;", NULL},
        {"a = 3000000000e-9; // 1\nb = 3000000000.0; n = 5;", NULL},
        {"a = .3000000000; b = 0.3E+1;", NULL},
        {"text = \"\\\\\"; # 3000000000 \"\nn = 6; /* * 3000000000 **/", NULL},
        {"@include \"/no/such.cfg\"\n", ":1: @include: a file must be whole in itself"},
        {"n = 5;\n  @include  \"more.cfg\"\n", ":2: @include: a file must be whole in itself"},
        {"text = \"\n@include\"; /*\n@include \"more.cfg\" */", ":1: text: a text on one line, without tabs"},
        {"text = \" ~\xc2\xa0\xdf\xbf\xe0\xa0\x80\xef\xbf\xbf\xf0\x90\x80\x80\xf4\x8f\xbf\xbf\";", NULL}};
    static const char *const broken[] = {"\x1f", "\x7f",     "\x80",         "\xc1\x80",         "\xc2\x80",
                                         "\xdf", "\xe0\xa0", "\xf0\x90\x80", "\xf5\x80\x80\x80", "\xc2\xc2"};
    values v;
    for (size_t i = 0; i < sizeof broken / sizeof *broken; i++)
        CHECK_FAILS(read_text(check_text("text = \"%s\";", broken[i]), &v), RP_BAD_INPUT, "in UTF-8");
    for (size_t i = 0; i < sizeof list / sizeof *list; i++)
        CHECK_FAILS_IF(list[i][1], read_text(list[i][0], &v), RP_BAD_INPUT, list[i][1]);
}

/* `before`, n times `part`, `after`. */
static rp_status read_long(const char *before, const char *part, size_t n, const char *after)
{
    values v;
    char *text = malloc(strlen(before) + n * strlen(part) + strlen(after) + 1), *end = stpcpy(text, before);
    while (n--) end = stpcpy(end, part);
    strcpy(end, after);
    rp_status status = read_text(text, &v);
    free(text);
    return status;
}

static void large_files(void)
{
    config_t config;
    CHECK_OK(read_long("n = 5;", " ", 65536, ""));
    CHECK_FAILS(read_long("n = 5;", " ", 65537, ""), RP_BAD_INPUT, ":1: a text, comment, gap");
    CHECK_FAILS(read_long("\nn = 5; text = \"", "x", 65536, "\";"), RP_BAD_INPUT, ":2: a text, comment, gap");
    CHECK_FAILS(read_long("/*", "\n", 65536, "*/"), RP_BAD_INPUT, ":1: a text, comment, gap");
    CHECK_FAILS(read_long("n = ", "0", 65537, "5;"), RP_BAD_INPUT, "a text, comment, gap");
    CHECK_FAILS(read_long("", "n = 1;\n", 1001, ""), RP_BAD_INPUT, ":1001: more than 1000 keys in one group");
    CHECK_FAILS(read_long("m = ", "(", 32, ""), RP_BAD_INPUT, ":1: more than 31 groups and lists");
    CHECK_FAILS(read_long("m = ( ", "{n = 1;},\n", 2000, "{} )"), RP_BAD_INPUT, ":1: m: unknown key");
    CHECK_FAILS(rp_config_read("/dev/zero", &config), RP_BAD_INPUT, "is no regular file");
    config_destroy(&config);
    const char *path = folder_path(folder, "text.cfg");
    CU_ASSERT(truncate(path, (64 << 20) + 1) == 0);
    CHECK_FAILS(rp_config_read(path, &config), RP_BAD_INPUT, "more than 64 MB");
    config_destroy(&config);
}

/* Philox4x32-10 of the key and counter 0: the known answer of its authors' test vectors. */
static void random_known_answer(void)
{
    rp_random r = rp_random_of(0, 0, (rp_purpose)0);
    const unsigned long known[4] = {0x6627e8d5UL, 0xe169c58dUL, 0xbc57ac4cUL, 0x9b00dbd8UL};
    for (int i = 0; i < 4; i++) CU_ASSERT_EQUAL(rp_random_word(&r), known[i]);
}

static void random_streams(void)
{
    const unsigned long names[][3] = {{1993, 0, RP_PURPOSE_RADII},  {1993, 1, RP_PURPOSE_RADII},
                                      {1993, 0, RP_PURPOSE_PLACES}, {1994, 0, RP_PURPOSE_RADII},
                                      {0, 0, RP_PURPOSE_RADII},     {4357, 0, RP_PURPOSE_RADII}};
    double first[6];
    for (int i = 0; i < 6; i++) {
        rp_random r = rp_random_of(names[i][0], names[i][1], (rp_purpose)names[i][2]);
        first[i] = rp_random_uniform(&r);
        double sum = first[i];
        for (int k = 1; k < 10000; k++) {
            double u = rp_random_uniform(&r);
            CU_ASSERT(u >= 0.0 && u < 1.0);
            sum += u;
        }
        CHECK_NEAR(sum / 10000.0, 0.5, 5.0 * sqrt(1.0 / 12.0 / 10000.0)); /* five standard errors */
        for (int j = 0; j < i; j++) CU_ASSERT(first[i] != first[j]);
    }
}

/* Kolmogorov's distance of 40 000 deviates from the truncated normal is below the 1e-4 quantile. */
static void cut_normal(void)
{
    enum { N = 40000 };
    const double cases[][4] = {
        {0.1, 0.02, 0.07, 0.13}, {0.1, 0.02, 0.0, 0.2}, {2.0, 1.0, -1.5, 2.5}, {0.0, 1.0, -3.9, -0.4}};
    scoped double *v = malloc(N * sizeof *v);
    for (int c = 0; c < 4; c++) {
        const double m = cases[c][0], w = cases[c][1], lo = cases[c][2], hi = cases[c][3];
        rp_random r = rp_random_of(7, (unsigned long)c, RP_PURPOSE_TEST);
        for (int i = 0; i < N; i++) v[i] = rp_random_cut_normal(&r, m, w, lo, hi);
        gsl_sort(v, 1, N);
        CU_ASSERT(v[0] >= lo && v[N - 1] <= hi);
        double low = gsl_cdf_ugaussian_P((lo - m) / w), all = gsl_cdf_ugaussian_P((hi - m) / w) - low,
               most = 0.0;
        for (int i = 0; i < N; i++)
            most = fmax(most, fabs((gsl_cdf_ugaussian_P((v[i] - m) / w) - low) / all - (i + 0.5) / N));
        CHECK_NEAR(most, 0.0, 2.23 / sqrt(N));
    }
    rp_random r = rp_random_of(7, 9, RP_PURPOSE_TEST);
    CU_ASSERT(rp_random_cut_normal(&r, 0.1, 0.0, 0.07, 0.13) == 0.1);
    CU_ASSERT(isnan(rp_random_cut_normal(&r, 0.0, 1.0, 8.1, 9.0)) &&
              isnan(rp_random_cut_normal(&r, 0.0, 1.0, 1.0, 0.0)));
}

/* What pandas reads by read_csv(sep="\t", comment="#"): the lines without #. */
static void table_text(void)
{
    size_t size;
    const char *path = folder_path(folder, "table.tsv");
    const double row[] = {0.1, 1.0 / 3.0, 2.0 / 3.0, 1e6, -0.0, 123456789012345680.0, 5e-324, INFINITY, -NAN};
    FILE *out;
    CHECK_OK(rp_file_open(path, true, &out));
    rp_table_provenance(out, RP_CGS, NULL);
    rp_table_note_number(out, "B", 0.1, "sigma");
    rp_table_header(out, RP_CGS, "a [cm], b, c, d, e, f, g, h, i");
    rp_table_row(out, sizeof row / sizeof *row, row);
    CHECK_OK(rp_file_close(path, out, RP_OK));
    scoped char *text = file_read(path, &size);
    static const char units[] = "\n# units: cm\t1\t1\t1\t1\t1\t1\t1\t1\n";
    const char *below = strstr(text, units);
    CU_ASSERT_PTR_NOT_NULL_FATAL(below);
    CU_ASSERT_STRING_EQUAL(below + strlen(units),
                           "a\tb\tc\td\te\tf\tg\th\ti\n0.1\t0.3333333333333333\t0.6666666666666666\t"
                           "1000000\t-0\t1.2345678901234568e+17\t4.94065645841247e-324\tinf\tnan\n");
    CU_ASSERT_PTR_NOT_NULL(strstr(text, "\n# B: 0.1 sigma\n"));
}

/* A table of a file with this text, in place of the one before. */
static rp_status read_as(const char *text, rp_table *t)
{
    const char *path = folder_path(folder, "table.tsv");
    rp_table_free(t);
    file_print(path, "%s", text);
    const rp_status status = rp_table_read(path, t);
    t->path = "t"; /* that of the file is no more */
    return status;
}

/* Header with or without #, tabs, blanks or commas, a byte order mark, lines that end with CR: one table. */
static void table_forms(void)
{
    static const char *const same[] = {"# note: a b\n# units: cm\t1\nx\ty\n1\t2\n3\tnan\n",
                                       "# units: cm\t1\n# x\ty\n1\t2\n3\tnan\n",
                                       "# x y\n1 2\n3 nan\n",
                                       "# x, y\n1 2\n3 nan\n",
                                       "#x,y\n1,2\n3,nan\n",
                                       "x\ty\n1\t2\n# units: cm\t1\nx\ty\n3\tnan\n",
                                       "x,y\r\n1,2\r\n3,nan\r\n",
                                       "\xEF\xBB\xBFx, y\n1, 2\n3, nan\n",
                                       "\xEF\xBB\xBF# x\ty\n1\t2\n3\tnan\n# unfinished: x y\n",
                                       "\n  x  y\n\n1 2\n# between\n3 nan\n"};
    RP_ENDS(rp_table_free) rp_table t = {0};
    int column;
    for (int texts = 0; texts < 2; texts++)
        for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
            if (texts && strchr(same[i], ' ') && !strchr(same[i], '\t'))
                continue; /* blanks are part of a text */
            rp_table_free(&t);
            CHECK_OK(texts ? rp_table_parse("text", strdup(same[i]), &t) : read_as(same[i], &t));
            CU_ASSERT(t.n_columns == 2 && t.n_rows == 2 && rp_table_column(&t, "x") == 0 &&
                      rp_table_column(&t, "y") == 1);
            if (t.n_rows == 2) CU_ASSERT(strcmp(t.cells[1], "2") == 0 && strcmp(t.cells[3], "nan") == 0);
        }
    /* words alone: a header, unless the names stand above with units or tabs */
    static const struct {
        const char *text;
        size_t n_rows;
    } words[] = {
        {"a b\nok no\n", 1},     {"# my table\na b\nok no\n", 1}, {"# units: 1\t1\n# a\tb\nok\tno\n", 1},
        {"# a\tb\nok\tno\n", 1}, {"# units: 1\t1\na\tb\n", 0},    {"# units: 1\t1\n# a\tb\n", 0}};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        CHECK_OK(read_as(words[i].text, &t));
        CU_ASSERT(t.n_rows == words[i].n_rows && t.n_columns == 2 && rp_table_column(&t, "b") == 1);
    }
    /* names that are numbers stand below their units; a table without names has numbers for names */
    CHECK_OK(read_as("# units: 1\t1\n2\t1\n7\t8\n", &t));
    CU_ASSERT(t.n_rows == 1 && rp_table_column(&t, "1") == 1);
    CHECK_OK(read_as("1,2\n7,8\n", &t));
    CU_ASSERT(t.n_rows == 2 && rp_table_column(&t, "1") == 0);
    CHECK_FAILS(rp_table_find(&t, "x", "x y r", &column), RP_BAD_INPUT,
                "no column \"x\"; expected header: x y r; found: none");
    CHECK_FAILS(read_as("u v\n1 2\n3 4 5\n", &t), RP_BAD_INPUT, ":3: 3 cells where 2 are expected");
    CHECK_FAILS(rp_table_find(&t, "x", "x y r", &column), RP_BAD_INPUT, "expected header: x y r; found: u v");
    /* of too many columns the first are named */
    char wide[700];
    for (int k = 0; k < 680; k++) wide[k] = (char)(k % 17 == 16 ? ' ' : 'a' + k / 17 % 26);
    strcpy(wide + 680, "\n");
    CHECK_OK(read_as(wide, &t));
    CHECK_FAILS(rp_table_find(&t, "x", NULL, &column), RP_BAD_INPUT,
                check_text("\"x\"; found: %.506s ...", wide));
    CU_ASSERT_STRING_EQUAL(strstr(rp_message(), " ..."), " ...");
    CHECK_OK(read_as("say\ty\na few words\t2\n3\t4\n", &t)); /* tabs alone, where blanks belong to texts */
    CU_ASSERT(t.n_rows == 2 && strcmp(t.cells[0], "a few words") == 0 && strcmp(t.cells[1], "2") == 0);
    static const char *const blanks[] = {"a mu,of y\n1,a b\n3,c\n", "a mu , of y\n1, a b \n3,c\n",
                                         "a mu\tof y\n1\ta b\n3\tc\n", "# a mu\tof y\n1\ta_b\n3\tc\n",
                                         "a mu,of y\n"};
    for (size_t i = 0; i < 5; i++) { /* names with blanks */
        CHECK_OK(read_as(blanks[i], &t));
        CU_ASSERT(t.n_columns == 2 && rp_table_column(&t, "a mu") == 0 && rp_table_column(&t, "of y") == 1);
        CU_ASSERT(i == 4 || (t.n_rows == 2 && strcmp(t.cells[1], i == 3 ? "a_b" : "a b") == 0));
    }
    CHECK_OK(read_as("x,y,x\n1,2,3\n", &t));
    CHECK_FAILS(rp_table_find(&t, "x", NULL, &column), RP_BAD_INPUT, "columns 1 and 3 are both \"x\"");
    CHECK_OK(rp_table_find(&t, "y", NULL, &column));
    CHECK_FAILS(read_as("x,y\n1,2\n3,,4\n", &t), RP_BAD_INPUT, ":3: an empty cell");
    CHECK_FAILS(read_as("x\ty\tz\n1\t\t2 3\n", &t), RP_BAD_INPUT, ":2: an empty cell");
    CHECK_FAILS(read_as("x,y\n1,2\n5,\n", &t), RP_BAD_INPUT, ":3: 1 cells where 2 are expected");
    /* quotes around names and cells; a first column without a name is an index */
    static const char *const indexed[] = {"\"\",\"x\",\"say, y\"\n\"5\",\"1\",\"a, b\"\n6,2,c\n",
                                          ",x,say\n5,1,a\n6,2,c\n", "\tx\tsay\n5\t1\ta\n6\t2\tc\n"};
    for (size_t i = 0; i < sizeof indexed / sizeof *indexed; i++) {
        CHECK_OK(read_as(indexed[i], &t));
        CU_ASSERT(t.n_columns == 3 && t.n_rows == 2 && rp_table_column(&t, "x") == 1);
        CU_ASSERT(rp_table_column(&t, i ? "say" : "say, y") == 2 &&
                  (i == 0 || rp_table_column(&t, "index") == 0));
        CU_ASSERT_STRING_EQUAL(t.cells[0], "5");
        CU_ASSERT_STRING_EQUAL(t.cells[2], i ? "a" : "a, b");
        CU_ASSERT_STRING_EQUAL(t.cells[4], "2");
    }
    CHECK_FAILS(read_as(",x,y\n1,2\n3,4\n", &t), RP_BAD_INPUT, ":2: 2 cells where 3 are expected");
}

/* Rows of two tables, each with its cells and its place, also in a message and where rows before it go. A run
 * of the first is left out, whatever its number. */
static void table_append(void)
{
    static const char *const texts[] = {"# run\ty\n1\ta\n\n2\tb\n",
                                        "# note: 5\n# run\ty\n3\tc\n# a word\n4\td\n5\te\n6\ta\n"},
                             cells[] = "1a2b3c4d5e";
    static const size_t lines[] = {2, 4, 3, 5, 6};
    rp_table t[2];
    double value;
    for (int k = 0; k < 2; k++)
        CHECK_OK(rp_table_parse(k == 0 ? "first" : "second", strdup(texts[k]), &t[k]));
    CHECK_OK(rp_table_append(&t[0], &t[1]));
    CU_ASSERT_EQUAL_FATAL(t[0].n_rows, 5);
    for (size_t row = 0; row < 5; row++) {
        CU_ASSERT_EQUAL(t[0].places[row].line, lines[row]);
        CU_ASSERT_STRING_EQUAL(t[0].places[row].path, row < 2 ? "first" : "second");
        for (size_t c = 0; c < 2; c++) CU_ASSERT(*t[0].cells[2 * row + c] == cells[2 * row + c]);
    }
    CHECK_OK(rp_table_where(&t[0], "run!=2"));
    CHECK_FAILS(rp_table_number(&t[0], 0, 1, 0, &value), RP_BAD_INPUT, "first:2: column 2 y: ");
    CHECK_FAILS(rp_table_number(&t[0], 1, 1, 0, &value), RP_BAD_INPUT, "second:3: column 2 y: ");
    for (int k = 0; k < 2; k++) rp_table_free(&t[k]);
}

/* Tables that differ in their first, their last or the number of their columns are not put together. */
static void table_append_columns(void)
{
    RP_ENDS(rp_table_free) rp_table t;
    CHECK_OK(rp_table_parse("t", strdup("a\tb\n1\t2\n"), &t));
    const char *const others[] = {"c\tb\n1\t2\n", "a\tc\n1\t2\n", "a\tb\tc\n1\t2\t3\n"};
    for (size_t k = 0; k < sizeof others / sizeof *others; k++) {
        RP_ENDS(rp_table_free) rp_table other;
        CHECK_OK(rp_table_parse("other", strdup(others[k]), &other));
        CHECK_FAILS(rp_table_append(&t, &other), RP_BAD_INPUT, "t and other have different columns");
        CU_ASSERT_EQUAL(t.n_rows, 1);
    }
    CHECK_OK(rp_table_append(&t, &t)); /* rows of no run */
    CU_ASSERT_EQUAL(t.n_rows, 2);
}

/* Which of the rows 1, 2, 3, word, nan and 20 a condition keeps, as a number of their digits. Numbers are
 * compared as numbers, words as words; nan is equal to nan alone; smallest and largest are one row. Other
 * comparisons hold for no row with a word or nan. A note has exactly its key. */
static void table_conditions(void)
{
    static const char *const cases[][2] = {{"x=2", "b"},
                                           {"x=2.0", "b"},
                                           {"x!=2", "acdef"},
                                           {"x<2", "a"},
                                           {"x<=2", "ab"},
                                           {"x>2", "cf"},
                                           {"x>=2", "bcf"},
                                           {"x>=3", "cf"},
                                           {"x=word", "d"},
                                           {"x!=word", "abcef"},
                                           {"x=nan", "e"},
                                           {"x!=nan", "abcdf"},
                                           {"x<20", "abc"},
                                           {"x<=20", "abcf"},
                                           {"x>20", ""},
                                           {"x>=20", "f"},
                                           {"x=2e1", "f"},
                                           {"y=c", "c"},
                                           {"x<inf", "abcf"},
                                           {"x=inf", ""},
                                           {"x=2.00000000001", ""},
                                           {"x=2.0000000000000001", "b"},
                                           {"x=smallest", "a"},
                                           {"x=largest", "f"},
                                           {"x != 2 and not y = 'c'", "adef"},
                                           {"(x=smallest) or y=nan or 1.5*x > 29", "af"},
                                           {"x > 1 and x <= 3", "bc"},
                                           {"x == 2 or x == 20", "bf"},
                                           {"not x < 2*1.5", "cf"},
                                           {"x+1 == 3", "b"},
                                           {"y < 2", ""}};
    RP_ENDS(rp_table_free) rp_table t = {0};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char kept[8] = "";
        CHECK_OK(read_as(
            "# mu_wall: 7\n# mu: 8 degrees\n#mu: 9\nx\ty\n1\ta\n2\tb\n3\tc\nword\td\nnan\te\n20\tf\n", &t));
        CHECK_OK(rp_table_where(&t, cases[i][0]));
        for (size_t row = 0; row < t.n_rows && row < 7; row++) {
            kept[row] = *t.cells[row * t.n_columns + 1];
            CU_ASSERT_EQUAL(t.places[row].line, 5 + (size_t)(kept[row] - 'a'));
        }
        CHECK_OR_SAY(strcmp(kept, cases[i][1]) == 0, "%s keeps %s, expected %s", cases[i][0], kept,
                     cases[i][1]);
        const char *note = rp_table_find_note(&t, "mu");
        CU_ASSERT(note && strcmp(note, "8 degrees") == 0);
        CU_ASSERT(rp_table_find_note(&t, "m") == NULL && rp_table_find_note(&t, "mu_") == NULL);
    }
    /* a column that is no name stands in quotes */
    CHECK_OK(read_as("x/W\tW\n0.25\t4\n0.75\t5\n", &t));
    CHECK_OK(rp_table_where(&t, "'x/W' < W/8 and 'x/W'=0.25"));
    CU_ASSERT_FATAL(t.n_rows == 1);
    CU_ASSERT_STRING_EQUAL(t.cells[0], "0.25");
    /* a word that begins with a number is a word */
    static const char *const words[][2] = {{"x=5", "a"}, {"x=5x", "b"}, {"x!=5", "b"}, {"x<6", "a"}};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        CHECK_OK(read_as("x\ty\n5.0\ta\n5x\tb\n", &t));
        CHECK_OK(rp_table_where(&t, words[i][0]));
        CU_ASSERT_FATAL(t.n_rows == 1);
        CU_ASSERT_STRING_EQUAL(t.cells[1], words[i][1]);
    }
    static const char *const bad[][2] = {{"x", "a number stands where a condition is expected"},
                                         {"=2", "character 1: \"=\" stands where a value is expected"},
                                         {"z=2", "no column \"z\""},
                                         {"x<word", "character 3: t: no column \"word\""},
                                         {"2*x = 4", "character 5: \"=\" stands where the end is expected"},
                                         {"x=", "character 3: a value of 1 to 63 letters expected"},
                                         {"y='c", "a value of 1 to 63 letters expected"},
                                         {"x=2 3", "\"3\" stands where the end is expected"},
                                         {"held(x > 1, 2)", "not of a table"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        CHECK_FAILS(rp_table_where(&t, bad[i][0]), RP_BAD_INPUT, bad[i][1]);
}

static void tables(void)
{
    const char *path = folder_path(folder, "table.tsv");
    file_print(path, "theirs");
    FILE *theirs;
    CHECK_FAILS(rp_file_open(path, false, &theirs), RP_BAD_INPUT,
                ": is there; give another name, or --force");
    static const char *const columns[][2] = {{"x", "cm"}, {"y", ""}};
    FILE *out;
    CHECK_OK(rp_file_open(path, true, &out));
    rp_table_provenance(out, RP_CGS, "a test");
    rp_table_columns(out, RP_CGS, 2, columns);
    rp_table_row(out, 2, (double[]){0.1, -1.0 / 3.0});
    rp_table_row(out, 2, (double[]){2.0, -NAN});
    CHECK_OK(rp_file_close(path, out, RP_OK));
    RP_ENDS(rp_table_free) rp_table t, still, cut, gone;
    double v;
    CHECK_OK(rp_table_read(path, &t));
    CU_ASSERT(t.n_rows == 2 && t.n_columns == 2 && rp_table_column(&t, "y") == 1);
    CU_ASSERT_EQUAL(rp_table_column(&t, "z"), -1);
    CHECK_OK(rp_table_number(&t, 0, 1, 0, &v));
    CU_ASSERT(v == -1.0 / 3.0);
    CHECK_OK(rp_table_number(&t, 1, 1, 1, &v));
    CU_ASSERT(isnan(v));
    CHECK_FAILS(rp_table_number(&t, 1, 1, 0, &v), RP_BAD_INPUT, "column 2 y: \"nan\" is not a finite number");
    /* a failed table leaves the old file unchanged */
    CHECK_OK(rp_file_open(path, true, &out));
    fputs("half", out);
    CU_ASSERT_EQUAL(rp_file_close(path, out, RP_NO_RESULT), RP_NO_RESULT);
    CHECK_OK(rp_table_read(path, &still));
    CU_ASSERT_EQUAL(still.n_rows, 2);
    /* a link is not followed */
    const char *link = folder_path(folder, "a.link");
    CU_ASSERT_FATAL(symlink(path, link) == 0);
    CHECK_FAILS(rp_file_open(link, false, &out), RP_BAD_INPUT, ".link: is there");
    CHECK_OK(rp_file_open(link, true, &out));
    CHECK_OK(rp_file_close(link, out, RP_OK));
    RP_ENDS(rp_table_free) rp_table linked;
    CHECK_OK(rp_table_read(path, &linked));
    CU_ASSERT(linked.n_rows == 2);
    unlink(link);
    /* a pipe is written to, not replaced */
    CU_ASSERT_FATAL(mkfifo(link, 0600) == 0);
    int reader = open(link, O_RDONLY | O_NONBLOCK);
    char got[8] = "";
    CHECK_OK(rp_file_open(link, false, &out));
    fputs("through", out);
    CHECK_OK(rp_file_close(link, out, RP_OK));
    CU_ASSERT(read(reader, got, 7) == 7 && strcmp(got, "through") == 0);
    struct stat info;
    CU_ASSERT(stat(link, &info) == 0 && S_ISFIFO(info.st_mode));
    close(reader);
    file_print(path, "1 2\n3\n");
    CHECK_FAILS(rp_table_read(path, &cut), RP_BAD_INPUT, ":2: 1 cells where 2 are expected");
    unlink(path);
    CHECK_FAILS(rp_table_read(path, &gone), RP_BAD_INPUT, "cannot read");
    CHECK_FAILS(rp_file_open("/no/such/folder/x", false, &out), RP_IO, "cannot write");
    CHECK_FAILS(rp_make_directory("/dev/null/x"), RP_IO, "/dev/null");
    out = fopen("/dev/full", "w");
    fputs("x", out);
    CHECK_FAILS(rp_file_finish(out, "full"), RP_IO, "full: cannot write");
    fclose(out);
    out = fopen("/dev/full", "w"); /* what failed before, and leaves nothing to write */
    setvbuf(out, NULL, _IONBF, 0);
    fputs("x", out);
    CHECK_FAILS(rp_file_finish(out, "full"), RP_IO, "full: cannot write: Input/output error");
    fclose(out);
}

/* A file has its name once its bytes are on the disk; one process at a time writes it, in place of what a
 * killed one has left. */
static void written_files(void)
{
    static const char first[] = "# program: repose one";
    const char *path = folder_path(folder, "table.tsv");
    size_t size;
    FILE *one, *two;
    file_print(check_text("%s.repose_part", path), "left by a killed process");
    CU_ASSERT(rp_file_was_begun(path));
    CHECK_OK(rp_file_open(path, true, &one));
    CHECK_FAILS(rp_file_open(path, true, &two), RP_IO, "table.tsv: another process writes it");
    fputs(first, one);
    CHECK_OK(rp_file_close(path, one, RP_OK));
    CU_ASSERT(!rp_file_was_begun(path));
    CHECK_OK(rp_file_open(path, true, &two));
    fputs("third", two);
    fault_order(FAULT_SYNC, 1, true);
    CHECK_FAILS(rp_file_close(path, two, RP_OK), RP_IO, "cannot write: Input/output error");
    fault_order(FAULT_SYNC, 0, false);
    scoped char *text = file_read(path, &size);
    CU_ASSERT_STRING_EQUAL(text, first);
}

/* One wide row asks for as many cells as there are bytes, not for cells of every line. */
static void hostile_tables(void)
{
    enum { N = 1000000 };
    const char *path = folder_path(folder, "table.tsv");
    scoped char *text = NULL;
    RP_ENDS(rp_table_free) rp_table t, zero;
    FILE *out = fopen(path, "w");
    for (int i = 0; i < N; i++) fputs("1 ", out);
    for (int i = 0; i < N; i++) fputs("\n1", out);
    fclose(out);
    CHECK_FAILS(rp_table_read(path, &t), RP_BAD_INPUT, ":2: 1 cells where 1000000 are expected");
    CHECK_OK(rp_file_read(path, &text));
    CU_ASSERT(strlen(text) == 4 * N);
    CHECK_FAILS(rp_table_read("/dev/zero", &zero), RP_BAD_INPUT, "/dev/zero: no text: holds a 0 byte");
}

static void statuses(void)
{
    CU_ASSERT(RP_USAGE == 64 && RP_BAD_INPUT == 65 && RP_BROKEN == 70 && RP_IO == 74 && RP_STOPPED == 75);
    rp_fail(RP_IO, "value %d", 3);
    CU_ASSERT_EQUAL(rp_prefix(RP_IO, "file:%d: ", 7), RP_IO);
    CU_ASSERT_STRING_EQUAL(rp_message(), "file:7: value 3");
    CU_ASSERT_EQUAL(rp_prefix(RP_OK, "nothing failed: "), RP_OK);
    CU_ASSERT_STRING_EQUAL(rp_message(), "file:7: value 3");
}

/* Costs by hand, and words between which no letter is right. */
static void guesses(void)
{
    static const struct {
        const char *a, *b;
        size_t cost;
    } pairs[] = {{"", "", 0},          {"", "mu", 4},       {"mu", "mu", 0},          {"mu", "nu", 2},
                 {"k_n", "k-n", 1},    {"W", "w", 1},       {"theta", "tehta", 2},    {"plan", "pln", 2},
                 {"pln", "plan", 2},   {"mass", "Ma_s", 3}, {"kitten", "sitting", 6}, {"ab", "bca", 6},
                 {"radius", "rho", 10}};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        CU_ASSERT_EQUAL(rp_edit_distance(pairs[i].a, pairs[i].b), pairs[i].cost);
        CU_ASSERT_EQUAL(rp_edit_distance(pairs[i].b, pairs[i].a), pairs[i].cost);
    }
    char many[128];
    memset(many, 'x', 127), many[127] = '\0';
    CU_ASSERT(rp_edit_distance(many, "mu") == SIZE_MAX && rp_edit_distance(many + 64, many + 64) == 0);
    static const char *const nearest[][2] = {
        {"sprin", "spring"}, {"frict", "friction"}, {"K", "k"},      {"x", ""},
        {"ab", ""},          {"frob", ""},          {"noen", "none"}};
    for (size_t i = 0; i < sizeof nearest / sizeof *nearest; i++) {
        rp_guess guess = rp_guess_of(nearest[i][0]);
        rp_guess_words(&guess, "spring | springs | k friction|none");
        CU_ASSERT_STRING_EQUAL(guess.nearest, nearest[i][1]);
        CU_ASSERT_EQUAL(*rp_guess_text(&guess) != '\0', *nearest[i][1] != '\0');
    }
    rp_guess guess = rp_guess_of(many);
    rp_guess_words(&guess, many);
    CU_ASSERT_STRING_EQUAL(rp_guess_text(&guess), "");
}

/* ---- elementary functions ---- */

/* |value - reference| in units of the last place of value. */
static double places(double value, long double reference)
{
    return (double)(fabsl(value - reference) / (nextafter(fabs(value), INFINITY) - fabs(value)));
}

static bool same_number(double a, double b)
{
    return isnan(a) ? isnan(b) : fabs(a - b) <= 1e-15 * fabs(b) || a == b;
}

/* Rounded correctly: half a unit in the last place, and the error of the reference, long double. */
static void elementary(void)
{
    static const struct {
        double (*ours)(double);
        long double (*reference)(long double);
        double from, to; /* of x, or of the power of 10 in 1 + 10^x */
        bool above_1;
    } functions[] = {{rp_exp, expl, -700.0, 700.0, false}, {rp_log, logl, -0.999, 1.0, true},
                     {rp_log, logl, 0.01, 50.0, false},    {rp_acosh, acoshl, -10.0, 300.0, true},
                     {rp_sin, sinl, -40.0, 40.0, false},   {rp_cos, cosl, -40.0, 40.0, false},
                     {rp_tan, tanl, -5.0, 5.0, false},     {rp_asin, asinl, -1.0, 1.0, false},
                     {rp_acos, acosl, -1.0, 1.0, false},   {rp_atan, atanl, -9.0, 9.0, false}};
    scoped_rng *r = numbers_of(1, 0);
    for (size_t f = 0; f < sizeof functions / sizeof *functions; f++) {
        double worst = 0.0;
        for (int i = 0; i < 20000; i++) {
            double x = functions[f].from + (functions[f].to - functions[f].from) * gsl_rng_uniform(r);
            if (functions[f].above_1) x = 1.0 + pow(10.0, x);
            worst = fmax(worst, places(functions[f].ours(x), functions[f].reference(x)));
        }
        CHECK_OR_SAY(worst < 0.502, "function %zu: %g units in the last place", f, worst);
    }
    double worst[3] = {0.0, 0.0, 0.0};
    for (int n = 1; n < 5000; n++) { /* where what is left of the angle is small */
        const double x = n * M_PI_2;
        worst[0] = fmax(worst[0], n % 2 ? places(rp_cos(x), cosl(x)) : places(rp_sin(x), sinl(x)));
    }
    CU_ASSERT(worst[0] < 0.502);
    for (int i = 0; i < 20000; i++) {
        const double x = gsl_rng_uniform(r) - 0.5, y = pow(10.0, 600.0 * x) * (gsl_rng_uniform(r) - 0.5);
        worst[0] = fmax(worst[0], places(rp_hypot(x, y), hypotl(x, y)));
        worst[1] = fmax(worst[1], places(rp_atan2(x, y), atan2l(x, y)));
        worst[2] = fmax(worst[2], places(rp_pow(fabs(y), x), powl(fabs(y), x)));
    }
    CU_ASSERT(worst[0] < 0.6 && worst[1] < 0.502 && worst[2] < 0.502);
    static const double special[] = {0.0,   INFINITY, -INFINITY, NAN, 1.0,  -1.0,
                                     1e308, -1e308,   1e-300,    2.0, 750.0};
    enum { SPECIAL = sizeof special / sizeof *special };
    for (int i = 0; i < SPECIAL; i++) {
        const double x = special[i];
        CU_ASSERT(same_number(rp_exp(x), exp(x)) && same_number(rp_log(x), log(x)));
        CU_ASSERT(same_number(rp_atan(x), atan(x)) && same_number(rp_asin(x), asin(x)));
        CU_ASSERT(same_number(rp_acos(x), acos(x)) && same_number(rp_acosh(x), acosh(x)));
        for (int k = 0; k < SPECIAL; k++) {
            CU_ASSERT(same_number(rp_hypot(x, special[k]), hypot(x, special[k])));
            CU_ASSERT(same_number(rp_atan2(x, special[k]), atan2(x, special[k])));
            CU_ASSERT(x < 0.0 || same_number(rp_pow(x, special[k]), pow(x, special[k])));
        }
    }
    CU_ASSERT(isnan(rp_sin(1e9)) && isnan(rp_cos(INFINITY)) && isnan(rp_tan(NAN)));
}

/* Texts of strangers: no control character is left, of no encoding, and a long message keeps its end. */
static void plain_texts(void)
{
    static const struct {
        const char *text, *plain;
    } texts[] = {{"\xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80", NULL},
                 {"a\x1b[31mb\x7f\x01", "a?[31mb??"},
                 {"a\tb\r\nc", "a b  c"},
                 {"\xc2\x9b"
                  "2J \x9b",
                  "??2J ?"},
                 {"\xe9t\xe9", "?t?"},
                 {"\xc0\x9b \xe0\x80\x9b \xed\xa0\x80 \xf4\x90\x80\x80 \xe2\x82", "?? ??? ??? ???? ??"}};
    char text[3 * RP_MESSAGE];
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
        strcpy(text, texts[k].text);
        CU_ASSERT_EQUAL(rp_is_plain(text), texts[k].plain == NULL);
        CU_ASSERT_STRING_EQUAL(rp_plain(text), texts[k].plain ? texts[k].plain : texts[k].text);
        CHECK_FAILS(rp_fail(RP_BAD_INPUT, "%s", texts[k].text), RP_BAD_INPUT, text);
        CHECK_FAILS(rp_prefix(RP_BAD_INPUT, "%s: ", texts[k].text), RP_BAD_INPUT, text);
    }
    memset(text, 'x', sizeof text - 1), text[sizeof text - 1] = '\0';
    CHECK_FAILS(rp_fail(RP_BAD_INPUT, "begin %s: allowed: [0, 1]", text), RP_BAD_INPUT, "x ... x");
    CU_ASSERT(strlen(rp_message()) == RP_MESSAGE - 1 && strncmp(rp_message(), "begin x", 7) == 0);
    CHECK_FAILS(rp_prefix(RP_BAD_INPUT, "file:%d: ", 7), RP_BAD_INPUT, "xx: allowed: [0, 1]");
    CU_ASSERT(strncmp(rp_message(), "file:7: begin x", 15) == 0);
}

/* What -ffp-contract=fast makes of it, tests/lint.sh and tests/arm64.sh see. */
static void exact_build(void)
{
    CHECK_OK(rp_build_check());
}

CHECK_SUITE_WITHIN(core, "core", enter, leave, statuses, plain_texts, exact_build, table_append,
                   defaults_and_text, ranges_and_units, refused_values, keys, inherited, guesses, files,
                   syntax, whole_numbers, large_files, random_known_answer, random_streams, cut_normal,
                   elementary, tables, table_text, table_conditions, table_forms, table_append_columns,
                   written_files, hostile_tables)
