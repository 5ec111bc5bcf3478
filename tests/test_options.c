/* Every option of a command that computes something changes the rows that the command prints. An option that
 * is parsed and then ignored fails here, and so does a new option without a line below. */

#include "report/pages.h"
#include "tests/program.h"
#include "tests/verbs.h"

/* A command on the fixtures, and options to add, each by itself. */
static const struct {
    const char *command, *base, *changes;
} lines[] = {
    {"angle marginal", "--mu 0.2", "--mu 0.3|--phi-deg 50"},
    {"angle tilt", "--mu 0.3 --theta-r-deg 18",
     "--mu 0.4|--theta-r-deg 17|--phi-deg 50|--form lattice|--form sine|--form printed"},
    {"angle slope", "grains.tsv --width 4",
     "--width 3.6|--cell 0.3|--height raw_centre|--height top|--empty skip|--parabola origin|--y-axis "
     "down|--where 'r<0.105'"},
    {"angle slope", "grains.tsv", "--from 0.6|--to 3|--width 4"},
    {"angle compare", "runs.tsv --bootstrap 50", "--phi-deg 50|--bootstrap 51|--seed 4|--where mu=0.2"},
    {"stress field", "p --width 1.2", "--width 1.0|--cell 0.2"},
    {"stress base", "p --width 1.2", "--width 1.0|--cell 0.2|--diameter 0.25|-g 900|--phi-deg 50|--floor 2"},
    {"stress dip", "piles.tsv", "--margin 0.5|--level 1e-9|--profile|--where 'n_01<0.9'"},
    {"stats fit", "runs.tsv -x W -y theta",
     "-x mu|-y seconds|--se se|--from 3|--to 5|--scale log|--where mu=0.2"},
    {"stats trend", "runs.tsv -x W -y theta",
     "-x mu|-y seconds|--by mu|--from 3|--to 5|--power 2|--where mu=0.2|--scale log|--margin 0.01"},
    {"stats trend", "runs.tsv -x W -y theta --where mu=0.2", "--pair"},
    {"stats trend", "flat.tsv -x x -y y --margin 0.3", "--level 0.4"},
    {"stats size", "runs.tsv -x W -y theta",
     "-x seconds|-y seconds|--by mu|--from 3|--to 5|--power 1|--where mu=0.2"},
    {"stats correlation", "runs.tsv -y theta -x seconds", "-x W|-y se|--by mu|--where mu=0.2"},
    {"stats select", "runs.tsv", "--columns mu,W|--where mu=0.2"},
    {"export", "runs.tsv --to csv", "--to json|--columns mu,W|--where mu=0.2"},
    {"lattice", "--base 9 --alpha-deg 30", "--base 10|--alpha-deg 40|--theta-deg 31"},
    {"lattice", "--layers 5", "--layers 6"},
    {"continuum", "--alpha-deg 30", "--alpha-deg 31|--points 7|--at 0.2"},
    {"tent", "--outer-deg 30 --inner-deg 45 --x1 0.3",
     "--outer-deg 31|--inner-deg 44|--x1 0.31|--points 7|--at 0.2"},
    {"pile", "--base 7 --eps 1e-3",
     "--base 8|--eps 2e-3|--alpha-deg 30|--gap 0.01|--disorder 0.01|--k-x 0.5|--summary|--threshold"},
    {"pile", "--base 9 --eps 1e-3 --alpha-deg 30 --inner-deg 45", "--inner-deg 40|--x-1 0.3"},
    {"pile", "--base 9 --alpha-deg 30 --well 0.3 --mu 0.2 --eps 1e-3", "--well 0.4|--mu 0.25|--set-load 0.5"},
    {"pile", "--base 9 --alpha-deg 30 --disorder 0.02", "--seed 4"},
    {"pile", "--base 12 --eps 5e-3", "--branch minimum"},
    {"pile", "--base 12 --eps 5e-3 --branch minimum", "--leave 1"},
    {"report claims", "--claims claims.tsv --tables .",
     "--claims other.tsv|--tables nowhere|--paper li|--id angle|--variants"},
    {"bench", "-n 9 --steps 10 --repeat 1", "-n 10|--steps 11|--start start.tsv|--size-ratio 5"}};

/* Options that change no row, or that other tests follow. */
static const struct {
    const char *command, *option, *reason;
} exceptions[] = {{"stats select", "--bare", "takes the header away: suite cli"},
                  {"export", "-o", "a file: suite export"},
                  {"export", "--force", "suite folders"},
                  {"export", "--reduce", "of a sweep: suite export"},
                  {"export", "--set", "of a scene: suite export"},
                  {"stress field", "--where", "tables of several steps: suite cli"},
                  {"stress base", "--where", "tables of several steps: suite cli"},
                  {"lattice", "--method", "a second way to the same numbers: suite analytic"},
                  {"pile", "--set-again", "needs wells that break: suite keys"},
                  {"pile", "--load-steps", "the same state, in more steps: suite keys"},
                  {"pile", "-o", "a folder: suite tables"},
                  {"pile", "--force", "suite cli"},
                  {"bench", "--width", "times are not compared"},
                  {"bench", "--state", "times are not compared"},
                  {"bench", "--floor", "times are not compared"},
                  {"bench", "--rotation", "suite columns"},
                  {"bench", "--mu-roll", "suite columns"},
                  {"bench", "--kernel", "times are not compared"},
                  {"bench", "--repeat", "times are not compared"},
                  {"bench", "-j", "times are not compared"},
                  {"bench", "-o", "suite columns"},
                  {"bench", "--force", "suite folders"}};

/* ---- fixtures ---- */

static void write_file(const char *name, void (*print)(FILE *))
{
    FILE *file = file_of(name);
    print(file);
    fclose(file);
}

/* A pseudo-random number between 0 and 1. */
static double scatter(int i)
{
    const double x = 12.9898 * (i + 1) * (i + 1);
    return x / 7.31 - (double)(long)(x / 7.31);
}

/* Piles of repose and stress at mu 0.1 to 0.4 and W 2 to 6, five of each; theta bends with W. */
static void print_runs(FILE *file)
{
    fprintf(file, "# mu\tW\ttheta\tse\tseconds\tsteps\treplica\tpile\ttheta_r3_deg\t"
                  "theta_t_displacement_deg\tn_0\tn_1\th_0\th_1\t"
                  "sxx_0\tsxy_0\tsyx_0\tsyy_0\tsxx_1\tsxy_1\tsyx_1\tsyy_1\tstatus\n");
    for (int i = 0; i < 60; i++) {
        const double mu = 0.1 * (1 + i % 4), W = 2.0 + 2.0 * (i / 4 % 3), s = scatter(i), t = scatter(i + 60);
        fprintf(file,
                "%g\t%g\t%.6f\t%.6f\t%.6f\t%d\t%d\t%d\t%.6f\t%.6f\t%.4f\t0.1\t%.4f\t1\t1\t%.4f\t0.02\t1.2\t0."
                "1\t1\t1\t0.2\t%s\n",
                mu, W, 10.0 + 40.0 * mu + 0.2 * W * W + s, 0.1 + 0.1 * t, 1.0 + W * (1.0 + s), 100 + 7 * i,
                i / 12, i / 12, 5.0 + 45.0 * mu + 2.0 * s, 2.0 + 8.0 * mu + t, 1.0 + 0.01 * s,
                0.05 + 0.05 * t, 0.02 * s, i % 29 == 7 ? "not_at_rest" : "ok");
    }
}

static void print_more(FILE *file)
{
    fprintf(file, "# mu\ttheta_r3_deg\ttheta_t_displacement_deg\tstatus\n");
    for (int i = 0; i < 24; i++)
        fprintf(file, "%g\t%.6f\t%.6f\tok\n", 0.1 * (1 + i % 4), 7.0 + 35.0 * (1 + i % 4) * 0.1 + scatter(i),
                2.0 + scatter(i + 9));
}

/* A slope with one empty cell. */
static void print_grains(FILE *file)
{
    fprintf(file, "# x\ty\tr\n");
    for (int i = 0; i < 80; i++)
        if (i % 20 != 13)
            fprintf(file, "%.4f\t%.4f\t%.4f\n", 0.1 + 0.2 * (i % 20) + 0.05 * scatter(i),
                    0.1 + 0.2 * (i / 20) * (1.0 - 0.04 * (i % 20)) + 0.1 * scatter(i + 5),
                    0.09 + 0.02 * scatter(i + 2));
}

static void print_stress_grains(FILE *file)
{
    fprintf(file, "# x\ty\tr\tm\n");
    for (int i = 0; i < 24; i++)
        fprintf(file, "%.4f\t%.4f\t0.1\t%.5f\n", 0.1 + 0.2 * (i % 6),
                0.1 + 0.18 * (i / 6) * (1.0 - 0.1 * (i % 6)), 0.004 + 0.001 * scatter(i));
}

static void print_stress_contacts(FILE *file)
{
    fprintf(file, "# id_b\twall\tx\ty\tx_b\ty_b\tnormal_force\tshear_force\n"
                  "0\t2\t0.1\t0.1\t0\t0.1\t9\t0\n");
    for (int i = 0; i < 6; i++) {
        fprintf(file, "0\t1\t%.4f\t0.1\t%.4f\t0\t%.4f\t%.4f\n", 0.1 + 0.2 * i, 0.1 + 0.2 * i, 20.0 - 2.0 * i,
                scatter(i));
        fprintf(file, "%d\t0\t%.4f\t0.28\t%.4f\t0.1\t%.4f\t%.4f\n", i + 1, 0.14 + 0.2 * i, 0.1 + 0.2 * i,
                10.0 + scatter(i), scatter(i + 1));
    }
}

static void print_piles(FILE *file)
{
    fprintf(file, "# status\texcess");
    for (int k = 1; k <= 20; k++) fprintf(file, "\tn_%02d", k);
    for (int i = 0; i < 12; i++) {
        fprintf(file, "\nok\t%g", 0.1 * scatter(i));
        for (int k = 0; k < 20; k++)
            fprintf(file, "\t%.5f", 0.6 + 0.06 * (k < 10 ? k : 19 - k) + 0.5 * scatter(20 * i + k));
    }
    fputc('\n', file);
}

#define CLAIMS                                                                                               \
    "id\tof\tpaper\tplace\tsection\ttest\tpublished\tpublished_se\tsamples\tmargin\tanswer\t"                \
    "against\tstatement\tnote\n"

#define FIT                                                                                                  \
    "fit = { mu = [0.1, 0.6]; }; measured = ( { runs = \"more.tsv\"; of = \"theta_r3_deg\"; value = %g; "    \
    "error = 1.0; } );\n"

static void write_fixtures(void)
{
    write_text("fit.cfg", FIT, 15.0);
    write_file("runs.tsv", print_runs);
    write_file("more.tsv", print_more);
    write_file("grains.tsv", print_grains);
    write_file("p_grains.tsv", print_stress_grains);
    write_file("p_contacts.tsv", print_stress_contacts);
    write_file("piles.tsv", print_piles);
    write_text("flat.tsv", "# x\ty\n1\t1\n2\t1.3\n3\t0.9\n1\t1.1\n2\t1\n3\t1.4\n");
    write_text("start.tsv", "# x\ty\tr\n0.1\t0.1\t0.1\n0.3\t0.1\t0.1\n0.2\t0.274\t0.1\n");
    write_text("t.tsv", "# v_mean\tv_se\tn\n20.5\t0.1\t101\n");
    static const char *const rest = "\t1\t20\t2\tt v\t-\ta\t-\n"
                                    "twin\tangle\tlh\t-\tall\tagrees\t-\t-\t-\t2\tt v\t-\ttwin\t-\n"
                                    "high\t-\tli\t-\tall\tabove\t-\t-\t-\t-\tt v\t0\thigh\t-\n";
    write_text("claims.tsv", CLAIMS "angle\t-\tlh\t-\tall\tagrees\t20%s", rest);
    write_text("other.tsv", CLAIMS "angle\t-\tlh\t-\tall\tagrees\t18%s", rest);
}

/* ---- options ---- */

/* Run a command; those of `report` have its name before their own. */
static int run_command(const char *command, const char *words)
{
    return strncmp(command, "report ", 7) == 0 ? run_report("%s %s", command + 7, words)
                                               : run("%s %s", command, words);
}

/* The rows that a command prints; NULL, with a message, if it fails in a way that is no result. */
static char *rows_of(const char *command, const char *base, const char *change)
{
    static char rows[sizeof out];
    const int status = run_command(command, check_text("%s %s", base, change));
    char *to = rows, *rest = out, *line;
    if (status != 0 && status != 1) {
        fprintf(stderr, "repose %s %s %s: %s", command, base, change, err);
        return NULL;
    }
    while ((line = strsep(&rest, "\n")))
        if (*line != '#') to = stpcpy(stpcpy(to, line), "\n");
    *to = '\0';
    return strdup(rows);
}

/* The rows without the columns that count runs without a result. */
static void drop_failed(char *rows)
{
    const char *end = strchr(rows, '\n'), *at = strstr(rows, "n_failed\t");
    size_t column = 0, k = 0;
    if (!at || !end || at > end) return;
    for (const char *c = rows; c < at; c++) column += *c == '\t';
    char *to = rows;
    for (const char *c = rows; *c; c++) {
        if (k != column && k != column + 1) *to++ = *c;
        if (*c == '\t') k++;
        if (*c == '\n' && (k == column || k == column + 1)) *to++ = *c;
        if (*c == '\n') k = 0;
    }
    *to = '\0';
}

static void check_line(size_t i)
{
    const char *rest = lines[i].changes;
    scoped char *base = rows_of(lines[i].command, lines[i].base, "");
    CU_ASSERT_PTR_NOT_NULL_FATAL(base);
    for (char change[128]; check_word(&rest, "|", change);) {
        if (check_fast() && *rest && strlen(rest + 1) % 4) continue; /* a few, with sanitizers */
        scoped char *now = rows_of(lines[i].command, lines[i].base, change);
        CHECK_OR_SAY(now && strcmp(now, base) != 0, "repose %s %s: %s changes nothing", lines[i].command,
                     lines[i].base, change);
    }
}

static bool has_word(const char *text, const char *typed)
{
    const size_t n = strlen(typed);
    for (const char *at = text; (at = strstr(at, typed)); at += n)
        if ((at == text || at[-1] == '|') && (at[n] == ' ' || at[n] == '|' || !at[n])) return true;
    return false;
}

static bool by_report; /* the program of a command: `report`, not `repose` */

/* The commands of both programs. */
static void each_of_both(void (*check)(const cli_command *))
{
    by_report = false;
    each(cli_repose.commands, check);
    by_report = true;
    each(report_commands, check);
}

/* Commands that write files or make runs: their own suites have their options. */
static const char elsewhere[] =
    "run|view|calibrate|params|help|sweep plan|sweep run|sweep status|sweep export|"
    "sweep digest|sweep make|sweep merge|sweep slurm|report joint|report page";

/* Every option of another command stands in a line, or among the exceptions. */
static void check_covered(const cli_command *c)
{
    option options[64];
    const size_t n = c->group ? 0 : options_of(c, options);
    const char *command = check_text("%s%s", by_report ? "report " : "", c->name);
    bool has_line = false;
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        has_line |= strcmp(lines[i].command, command) == 0;
    CHECK_OR_SAY(c->group || has_line || has_word(elsewhere, command), "repose %s: no line", command);
    for (size_t k = 0; k < n && has_line; k++) {
        const char *typed = options[k].typed;
        bool covered = false;
        for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
            covered |= strcmp(lines[i].command, command) == 0 && has_word(lines[i].changes, typed);
        for (size_t i = 0; i < sizeof exceptions / sizeof *exceptions; i++)
            covered |=
                strcmp(exceptions[i].command, command) == 0 && strcmp(exceptions[i].option, typed) == 0;
        CHECK_OR_SAY(covered, "repose %s: no line changes %s", command, typed);
    }
}

/* ---- values that are refused ---- */

static rp_status accepted(cli_call *call, const void *values)
{
    (void)call, (void)values;
    return RP_OK;
}

static void refused(const cli_command *c, const option *o, const char *value, const char *text)
{
    char name[64], typed[64], given[64];
    cli_command idle = *c;
    RP_SCOPE(arena);
    cli_call call = {.arena = &arena, .program = &cli_repose};
    idle.act = accepted;
    snprintf(name, sizeof name, "%s", c->name);
    snprintf(typed, sizeof typed, "%s", o->typed), snprintf(given, sizeof given, "%s", value);
    const rp_status status = cli_run(&call, &idle, 3, (char *[]){name, typed, given, NULL});
    CHECK_OR_SAY(status == RP_BAD_INPUT && strstr(rp_message(), check_text("%s = %s", typed, text)),
                 "%s %s %s: %s", name, typed, value, status ? rp_message() : "is taken");
}

/* Every option says what it takes: no number beyond its range, no fraction where it counts, no other word. */
static void check_refusals(const cli_command *c)
{
    option options[64];
    const size_t n = c->group ? 0 : options_of(c, options);
    for (const option *o = options; o < options + n; o++) {
        for (int upper = 0; upper < 2; upper++) {
            const char *far = beyond_range(o->p, upper);
            if (*far) refused(c, o, far, check_text("%.15g: out of range, allowed: ", strtod(far, NULL)));
        }
        if (o->p->type == RP_INT) refused(c, o, "4.5", "4.5: a whole number expected");
        if (o->p->type == RP_REAL) refused(c, o, "nan", "\"nan\"");
        if (o->p->type == RP_REAL) refused(c, o, "steep", "\"steep\": a number");
        if (o->p->type == RP_CHOICE) refused(c, o, "frob", "\"frob\": unknown word, allowed: ");
    }
}

static void test_refusals(void)
{
    each_of_both(check_refusals);
}

static void test_options(void)
{
    write_fixtures();
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) check_line(i);
    each_of_both(check_covered);
}

/* ---- rows without a result ---- */

/* Append to a table rows whose status is not ok, with numbers that would change any result. */
static void add_failed(const char *name, const char *status)
{
    char copy[64];
    scoped_table t = read_table(name);
    FILE *file = fopen(path_of(name), "a");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    for (size_t row = 0; row < 2; row++)
        for (size_t c = 0; c < t.n_columns; c++) {
            const char *text = t.cells[row * t.n_columns + c], *column = t.names[c];
            snprintf(copy, sizeof copy, "%g", 3.0 * strtod(text, NULL) + 7.0);
            if (strcmp(column, "status") == 0)
                text = status;
            else if (strspn(text, "0123456789.") == strlen(text) && strcmp(column, "mu") != 0 &&
                     strcmp(column, "W") != 0 && strcmp(column, "k") != 0)
                text = copy;
            fprintf(file, "%s%s", text, c + 1 < t.n_columns ? "\t" : "\n");
        }
    fclose(file);
}

/* No command that reads runs takes one without a result for one. */
static void test_failed_runs(void)
{
    static const char *const commands[] = {"angle compare runs.tsv --bootstrap 20",
                                           "stress dip piles.tsv",
                                           "stats trend runs.tsv -x W -y theta --by mu",
                                           "stats size runs.tsv -x W -y theta --by mu",
                                           "stats correlation runs.tsv -x W -y theta --by mu",
                                           "calibrate fit.cfg"};
    const char *statuses = "not_at_rest no_pile leaked crashed broken not_level no_room drops_not_quiet "
                           "no_response too_high";
    enum { N = sizeof commands / sizeof *commands };
    char *before[N];
    write_fixtures();
    for (size_t i = 0; i < N; i++) before[i] = rows_of(commands[i], "", "");
    for (char status[128]; check_word(&statuses, " ", status);) {
        add_failed("runs.tsv", status);
        add_failed("more.tsv", status);
        add_failed("piles.tsv", status);
    }
    for (size_t i = 0; i < N; i++) {
        scoped char *after = rows_of(commands[i], "", "");
        if (before[i]) drop_failed(before[i]);
        if (after) drop_failed(after);
        CHECK_OR_SAY(before[i] && after && strcmp(before[i], after) == 0,
                     "repose %s: counts runs without a result", commands[i]);
        free(before[i]);
    }
}

CHECK_SUITE_WITHIN(options, "options", enter, leave, test_options, test_refusals, test_failed_runs)
