/* Figures: what gnuplot draws from tables in which every cell has its own value, read back and compared with
 * the columns that tests/figures.txt names. Another column, table, row, factor or shift is another number. */
#include <ctype.h>
#include <glob.h>

#include "tests/program.h"

enum { MOST_NAMES = 512, MOST_TABLES = 16, MOST_ROWS = 16, MOST_KEYS = 24 };

/* gnuplot writes six digits. */
#define DRAWN 2e-5

/* ---- fixtures: tables of distinct numbers ---- */

typedef struct {
    char name[64]; /* "lh3.tsv" */
    bool only;     /* no columns but the keys */
    size_t n_rows, n_keys;
    char keys[MOST_KEYS][48]; /* columns whose cells are given */
    char cells[MOST_KEYS][MOST_ROWS][32];
    char notes[256]; /* header lines */
} fixture;

static fixture fixtures[MOST_TABLES];
static size_t n_fixtures;

/* Columns of every table: all words that figures quote, and columns near to them. */
static char names[MOST_NAMES][48];
static size_t n_names;

static size_t index_of(const char *name)
{
    size_t i = 0;
    while (i < n_names && strcmp(names[i], name) != 0) i++;
    return i;
}

static void add_name(const char *name)
{
    if (*name && strlen(name) < sizeof *names && n_names < MOST_NAMES && index_of(name) == n_names)
        strcpy(names[n_names++], name);
}

static void add_names_of(const char *path)
{
    size_t n;
    scoped char *text = file_read(path, &n);
    for (char *rest = text, *line; (line = strsep(&rest, "\n"));)
        for (char *quote = line; *line != '#' && (quote = strpbrk(quote, "'\"")); quote++) {
            const size_t length = strcspn(quote + 1, "'\"");
            const size_t word = strspn(quote + 1, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                                                  "0123456789_/()*");
            if (word == length && isalpha((unsigned char)quote[1]))
                add_name(check_text("%.*s", (int)length, quote + 1));
            if (!quote[1 + length]) break;
            quote += 1 + length;
        }
}

static void each_figure(void (*visit)(const char *path))
{
    RP_ENDS(globfree) glob_t found;
    CU_ASSERT_FATAL(glob("figures/*/*.gp", 0, NULL, &found) == 0);
    for (size_t i = 0; i < found.gl_pathc; i++) visit(found.gl_pathv[i]);
}

static void collect_names(void)
{
    const char *more =
        "theta_r1_deg_mean theta_r1_deg_se theta_r2_deg_mean theta_r2_deg_se theta_r3_deg_mean "
        "theta_r3_deg_sd theta_r3_deg_se theta_r3_deg_lo95 theta_r3_deg_hi95 H W mu H_ratio_mean "
        "H_slope_ratio_mean middle_mean weakest_level_mean H_ratio_se middle_diagonals_mean "
        "theta_t_displacement_deg_mean theta_t_displacement_deg_se theta_t_energy_deg_mean "
        "theta_t_energy_deg_se tilt_rate_deg";
    static const char *const forms[] = {"balanced", "lattice", "sine", "printed"};
    char name[128];
    n_names = 0;
    each_figure(add_names_of);
    while (check_word(&more, " ", name)) add_name(name);
    for (size_t i = 0; i < 4; i++)
        for (int k = 0; k < 2; k++) add_name(check_text("theta_t_%s_%sdeg", forms[i], k ? "se_" : ""));
    static const char *const onset[] = {"limit_floor", "limit_wall",   "limit_inside",
                                        "moved_floor", "moved_inside", "moved_surface"};
    for (int k = 0; k < 6 * 5 * 2; k++)
        add_name(check_text("%s_%d_%s", onset[k / 10], k / 2 % 5, k % 2 ? "se" : "mean"));
    for (int k = 0; k < 2; k++) {
        add_name(check_text("%c_diagonals/mg", "NH"[k]));
        add_name(check_text("%c/(chi*g*B)", "NH"[k]));
    }
}

/* The number in a cell: distinct in five digits, and within the ranges of normalised axes. */
static double value_of(const fixture *f, const char *column, size_t row)
{
    for (size_t k = 0; k < f->n_keys; k++)
        if (strcmp(f->keys[k], column) == 0) return strtod(f->cells[k][row], NULL);
    const size_t c = index_of(column);
    if (c == n_names || f->only) return NAN;
    return 0.01 * (1.0 + 0.1 * (double)c + 0.013 * (double)row + 0.001 * (double)(f - fixtures));
}

/* Each column of the fixture, the keys first: its name, or what it has in this row. */
static void print_cells(const fixture *f, FILE *file, const size_t *row)
{
    for (size_t k = 0; k < f->n_keys; k++)
        fprintf(file, "%s%s", k ? "\t" : "", row ? f->cells[k][*row] : f->keys[k]);
    for (size_t c = 0, n = f->n_keys; c < n_names && !f->only; c++) {
        bool is_key = false;
        for (size_t k = 0; k < f->n_keys; k++) is_key |= strcmp(f->keys[k], names[c]) == 0;
        if (is_key) continue;
        if (n++) fputc('\t', file);
        if (row)
            fprintf(file, "%.6g", value_of(f, names[c], *row));
        else
            fputs(names[c], file);
    }
    fputc('\n', file);
}

static void write_fixture(const fixture *f)
{
    if (strchr(f->name, '/'))
        shell_line("mkdir -p %.*s; :>out; :>err", (int)(strrchr(f->name, '/') - f->name), f->name);
    FILE *file = file_of(f->name);
    fprintf(file, "%s# units: 1\n", f->notes);
    print_cells(f, file, NULL);
    for (size_t row = 0; row < f->n_rows; row++) print_cells(f, file, &row);
    fclose(file);
}

/* "NAME [only] KEY=a,b,c ... [#NOTE=text]": a table of as many rows as the longest list. */
static void read_fixture(char *words)
{
    CU_ASSERT_FATAL(n_fixtures < MOST_TABLES);
    fixture *f = &fixtures[n_fixtures++];
    memset(f, 0, sizeof *f);
    f->n_rows = 1;
    snprintf(f->name, sizeof f->name, "%s", strsep(&words, " "));
    for (char *word_now; (word_now = strsep(&words, " "));) {
        char *equals = strchr(word_now, '=');
        if (strcmp(word_now, "only") == 0) f->only = true;
        if (!equals) continue;
        *equals = '\0';
        if (*word_now == '#') {
            snprintf(f->notes + strlen(f->notes), sizeof f->notes - strlen(f->notes), "# %s: %s\n",
                     word_now + 1, equals + 1);
            continue;
        }
        snprintf(f->keys[f->n_keys], sizeof f->keys[0], "%s", word_now);
        size_t row = 0;
        for (char *list = equals + 1, *cell_now; (cell_now = strsep(&list, ",")); row++)
            snprintf(f->cells[f->n_keys][row], sizeof f->cells[0][0], "%s", cell_now);
        f->n_keys++;
        if (row > f->n_rows) f->n_rows = row;
    }
    for (size_t k = 0; k < f->n_keys; k++) /* a single value is that of every row */
        for (size_t row = 1; row < f->n_rows; row++)
            if (!*f->cells[k][row]) strcpy(f->cells[k][row], f->cells[k][row - 1]);
}

/* ---- expressions ---- */

static const fixture *find_fixture(const char *name)
{
    for (size_t i = 0; i < n_fixtures; i++)
        if (strncmp(fixtures[i].name, name, strlen(name)) == 0 &&
            strcmp(fixtures[i].name + strlen(name), ".tsv") == 0)
            return &fixtures[i];
    fprintf(stderr, "figures.txt: no table %s\n", name);
    CU_FAIL_FATAL("no such table");
    return NULL;
}

static double operand(const fixture *f, size_t row, const char **text)
{
    if (**text != '{' && **text != 'm') return strtod(*text, (char **)text);
    const char *open = strchr(*text, '{'), *other = strchr(*text, '@');
    if (other && other < open) { /* of another table */
        f = find_fixture(check_text("%.*s", (int)(open - other) - 1, other + 1));
    }
    const size_t length = strcspn(open, "}");
    const char *column = check_text("%.*s", (int)length - 1, open + 1);
    double v = **text == '{' ? value_of(f, column, row) : 0.0;
    for (size_t r = 0; r < f->n_rows && **text != '{'; r++) {
        const double u = value_of(f, column, r);
        v = (*text)[1] == 'a' ? fmax(v, fabs(u)) : v + u / (double)f->n_rows;
    }
    *text = open + length + 1;
    return v;
}

/* "{mu}+0.003", "{x_b}-{x}", "{N}/max{N}", "{N}/max@TABLE{N}": from left to right. */
static double evaluate(const fixture *f, size_t row, const char *text)
{
    double v = operand(f, row, &text);
    while (*text) {
        const char sign = *text++;
        const double next = operand(f, row, &text);
        v = sign == '+'   ? v + next
            : sign == '-' ? v - next
            : sign == '*' ? v * next
            : sign == '/' ? v / next
                          : NAN;
    }
    return v;
}

/* ---- drawn data ---- */

static char *drawn;

/* The next line of numbers of this curve; false at its end. */
static bool next_point(double point[6], size_t *n)
{
    while (drawn && *drawn && *drawn != '#' && *drawn != '\n') {
        char *line = strsep(&drawn, "\n"), *end;
        *n = 0;
        bool undefined = false;
        for (; *n < 6; (*n)++, line = end) {
            point[*n] = strtod(line, &end);
            if (end == line) break;
            undefined |= isnan(point[*n]);
        }
        if (strchr(line, 'u') || undefined) continue; /* an undefined point */
        return *n > 0;
    }
    return false;
}

/* Go to the next curve. */
static bool next_curve(void)
{
    while (drawn && *drawn && strncmp(drawn, "# Curve ", 8) != 0 && strncmp(drawn, "# Surface ", 10) != 0)
        strsep(&drawn, "\n");
    if (!drawn || !*drawn) return false;
    while (drawn && *drawn == '#') strsep(&drawn, "\n");
    return true;
}

static bool near(double a, double b)
{
    return fabs(a - b) <= DRAWN * fmax(fabs(b), 1e-3);
}

static bool is_among(double value, const char *list)
{
    for (char *end; *list; list = *end ? end + 1 : end)
        if (strtod(list, &end) == value) return true;
    return false;
}

/* "TABLE [KEY=VALUE] EXPRESSION ...": one point a row; ~E is a bar, of y - E and y + E. */
static bool check_curve(char *words)
{
    const fixture *f = find_fixture(strsep(&words, " "));
    const char *where = NULL, *expressions[6];
    size_t n_expressions = 0;
    for (char *word_now; (word_now = strsep(&words, " "));)
        if (strchr(word_now, '='))
            where = word_now;
        else if (n_expressions < 6)
            expressions[n_expressions++] = word_now;
    double point[6];
    size_t n;
    for (size_t row = 0; row < f->n_rows; row++) {
        if (where) {
            const char *key = check_text("%.*s", (int)strcspn(where, "="), where);
            if (!is_among(value_of(f, key, row), strchr(where, '=') + 1)) continue;
        }
        double expected[8];
        size_t m = 0;
        for (size_t k = 0; k < n_expressions; k++) {
            const bool bar = *expressions[k] == '~';
            const double v = evaluate(f, row, expressions[k] + bar);
            if (bar) expected[m + 1] = expected[m - 1] + v, expected[m] = expected[m - 1] - v;
            if (!bar) expected[m] = v;
            m += bar ? 2 : 1;
        }
        bool right = next_point(point, &n) && n >= m;
        for (size_t k = 0; k < m && right; k++) right = near(point[k], expected[k]);
        if (!right) {
            fprintf(stderr, "row %zu of %s: expected", row, f->name);
            for (size_t k = 0; k < m; k++) fprintf(stderr, " %g", expected[k]);
            fputs(", drawn", stderr);
            for (size_t k = 0; k < n && k < 6; k++) fprintf(stderr, " %g", point[k]);
            fputc('\n', stderr);
            return false;
        }
    }
    const bool more = next_point(point, &n);
    if (more) fprintf(stderr, "%s: more points than rows\n", f->name);
    return !more;
}

/* "A B": y = A + B x; "A B C": y = A + B/x + C; "A B C P": y = A + B/x^P + C. */
static bool check_line(const char *words)
{
    double a = 0.0, b = 0.0, c = 0.0, power = 1.0, point[6];
    const int given = sscanf(words, "%lf %lf %lf %lf", &a, &b, &c, &power);
    size_t n, points = 0;
    for (; next_point(point, &n); points++) {
        const double change = given >= 3 ? b / pow(point[0], power) + c : b * point[0];
        if (fabs(point[1] - a - change) > DRAWN * (fabs(a) + fabs(change))) {
            fprintf(stderr, "line %s: (%g, %g)\n", words, point[0], point[1]);
            return false;
        }
    }
    return points > 0;
}

/* ---- figures ---- */

/* Copies of the figures that draw tables: a table holds neither bars of lines nor radii, and numbers as the
 * axes' formats have them. */
static void copy_figures(void)
{
    CU_ASSERT_FATAL(shell("for f in $(cd \"$OLDPWD\" && ls figures/*.gp figures/*/*.gp); do mkdir -p "
                          "${f%/*}; sed -e '/^ *set format/d' -e 's/yerrorlines/yerrorbars/' -e 's/with "
                          "circles .*, \\\\$/with yerrorbars notitle, \\\\/' -e 's/with circles "
                          ".*[^\\\\]$/with yerrorbars notitle/' \"$OLDPWD/$f\" >$f; done >out 2>err") == 0);
}

/* Draw a figure of gnuplot into a table, and as it is. */
static bool draw(const char *figure)
{
    const char *sweeps = "";
    for (size_t i = 0; i < n_fixtures; i++) {
        write_fixture(&fixtures[i]);
        sweeps = check_text("%s%s%.*s", sweeps, i ? " " : "", (int)strcspn(fixtures[i].name, "/"),
                            fixtures[i].name);
    }
    const int status = shell_line(
        "w=$PWD/; set -- -e \"folders='$w'; sweeps='%s'; terminal='svg'\"; (cd \"$OLDPWD\"; exec "
        "gnuplot \"$@\" -e \"file='${w}plain'\" figures/style.gp figures/%s.gp >${w}out 2>${w}err) & "
        "gnuplot \"$@\" -e \"file='none'\" figures/style.gp -e \"set table '${w}drawn'\" figures/%s.gp "
        "-e \"save set '${w}set'\" 2>table_err; status=$?; wait $! && cat table_err >>err; exit $status",
        sweeps, figure, figure);
    if (status != 0 || *err) fprintf(stderr, "%s: gnuplot: %s\n", figure, err);
    return status == 0 && !*err;
}

/* Labels and titles. */
static bool file_holds(const char *name, const char *text)
{
    static char file[1 << 20];
    slurp(name, file, sizeof file);
    return strstr(file, text) != NULL;
}

/* ---- layout, from plain.svg at 96 dots an inch ---- */

static const double PER_CM = 96.0 / 2.54, LEAST_LETTERS = 7.0 * 96.0 / 72.0;

/* The picture is as wide as one or two columns of a journal, and no letter is below 7 points. */
static bool letters_are_readable(const char *svg)
{
    const char *width = strstr(svg, " width=\"");
    const double columns = width ? strtod(width + 8, NULL) / (8.6 * PER_CM) : NAN;
    bool good = fabs(columns - 1.0) < 0.005 || fabs(columns - 2.0) < 0.005;
    if (!good) fprintf(stderr, "%g columns of 8.6 cm\n", columns);
    for (const char *font = svg; (font = strstr(font, "font-size=\"")); font++) {
        const double size = strtod(font + 11, NULL);
        if (!(size >= LEAST_LETTERS))
            fprintf(stderr, "letters of %.2f pt\n", size * 72.0 / 96.0), good = false;
    }
    return good;
}

/* The next text's place, and whether it stands upright; NULL after the last one. */
static const char *next_text(const char *at, double place[2], bool *upright)
{
    while ((at = strstr(at + 1, "<g transform=\"translate(")))
        if (sscanf(at, "<g transform=\"translate(%lf,%lf)", place, place + 1) == 2) break;
    *upright = at && strncmp(strchr(at, ')') + 1, " rotate", 7) == 0;
    return at;
}

/* No text leaves the picture, and lines that begin beside one another have a line's distance. */
static bool texts_are_apart(const char *svg)
{
    const char *size = strstr(svg, " height=\"");
    const double height = size ? strtod(size + 9, NULL) : NAN;
    double a[2], b[2];
    bool good = true, upright, other;
    for (const char *text = svg; (text = next_text(text, a, &upright));) {
        bool clear = upright ? a[0] > LEAST_LETTERS : a[1] < height - 0.3 * LEAST_LETTERS;
        for (const char *more = text; !upright && (more = next_text(more, b, &other));)
            clear &= other || fabs(a[0] - b[0]) > 3.0 * LEAST_LETTERS || fabs(a[1] - b[1]) < 1.0 ||
                     fabs(a[1] - b[1]) > 1.2 * LEAST_LETTERS;
        if (!clear) fprintf(stderr, "text at (%g, %g) leaves the picture or meets another\n", a[0], a[1]);
        good &= clear;
    }
    return good;
}

/* Borders of panels: closed rectangles in black. Text is drawn beside them. */
static bool panels_are_alike(const char *svg, bool own_height)
{
    double first[2] = {NAN, NAN}, b[8];
    bool good = true;
    for (const char *path = svg; (path = strstr(path, " d='M")); path++) {
        if (sscanf(path, " d='M%lf,%lf L%lf,%lf L%lf,%lf L%lf,%lf", b, b + 1, b + 2, b + 3, b + 4, b + 5,
                   b + 6, b + 7) != 8 ||
            strncmp(path - 15, "stroke='black'", 14) != 0 || !memchr(path + 4, 'Z', strcspn(path + 4, "'")))
            continue;
        const double size[2] = {fabs(b[4] - b[0]), fabs(b[5] - b[1])};
        if (size[1] < PER_CM) continue; /* of colours */
        if (isnan(first[0])) memcpy(first, size, sizeof first);
        const bool wide = fabs(size[0] - 14.6 * PER_CM) < 3.0, narrow = fabs(size[0] - 6.0 * PER_CM) < 3.0;
        if (!(wide || narrow) || (!own_height && fabs(size[1] - 4.6 * PER_CM) > 3.0) ||
            fabs(size[0] - first[0]) > 1.5 || fabs(size[1] - first[1]) > 1.5) {
            fprintf(stderr, "panel of %.2f cm x %.2f cm\n", size[0] / PER_CM, size[1] / PER_CM);
            good = false;
        }
        for (const char *text = svg; (text = strstr(text, "<g transform=\"translate(")); text++) {
            double x, y;
            if (sscanf(text, "<g transform=\"translate(%lf,%lf)", &x, &y) != 2) continue;
            if (x > b[0] + 2.0 && x < b[4] - 2.0 && y > fmin(b[1], b[5]) + 2.0 && y < fmax(b[1], b[5]) - 2.0)
                fprintf(stderr, "text over data at (%g, %g)\n", x, y), good = false;
        }
    }
    if (isnan(first[0])) fprintf(stderr, "no panel\n");
    return good && !isnan(first[0]);
}

/* Curves with a title have a point. An entry of the key alone has no rows. */
static bool legend_is_of_drawn(void)
{
    static char table[1 << 20];
    slurp("drawn", table, sizeof table);
    bool good = true;
    for (char *title = table; (title = strstr(title, "# Curve title: ")); title++) {
        size_t rows = 0, points = 0;
        char *line = strchr(title, '\n') + 1;
        for (; *line && *line != '\n'; line += strcspn(line, "\n"), line += *line == '\n') {
            rows += *line != '#';
            points += *line != '#' && line[strcspn(line, "u\n")] != 'u';
        }
        if (rows == 0 || points > 0) continue;
        fprintf(stderr, "in the key, not drawn: %.*s\n", (int)strcspn(title, "\n"), title);
        good = false;
    }
    return good;
}

static bool is_set_out(const char *figure)
{
    static char svg[1 << 22], text[1 << 16];
    slurp("plain.svg", svg, sizeof svg);
    slurp(check_text("figures/%s.gp", figure), text, sizeof text);
    const bool own_height = strstr(text, "ratio = ") || file_holds("set", "set size ratio -1");
    const bool readable = letters_are_readable(svg), alike = panels_are_alike(svg, own_height),
               apart = texts_are_apart(svg), good = legend_is_of_drawn() && readable && alike && apart;
    if (!good) fprintf(stderr, "%s: layout\n", figure);
    return good;
}

static void test_drawn(void)
{
    static char data[1 << 20];
    char figure[64] = "";
    int number = 0;
    bool is_drawn = false, good_figure = true;
    if (CHECK_SKIPS("of gnuplot's work the sanitizers see nothing")) return;
    size_t size;
    scoped char *described = file_read("tests/figures.txt", &size);
    enter();
    collect_names();
    copy_figures();
    for (char *lines = described, *line; (line = strsep(&lines, "\n"));) {
        number++;
        char *rest = strchr(line, ' ');
        if (*line == '#' || !*line || strncmp(line, "skip ", 5) == 0) continue;
        if (rest) *rest++ = '\0';
        if (strcmp(line, "figure") == 0) {
            if (is_drawn && good_figure && next_curve()) {
                fprintf(stderr, "%s: more curves than figures.txt has\n", figure);
                CU_FAIL("more curves");
            }
            snprintf(figure, sizeof figure, "%s", rest);
            n_fixtures = 0;
            is_drawn = false, good_figure = true;
            continue;
        }
        if (strcmp(line, "table") == 0) {
            read_fixture(rest);
            continue;
        }
        if (strcmp(line, "file") == 0) {
            char *text = strchr(rest, ' ');
            *text = '\0';
            write_text(rest, "%s\n", text + 1);
            continue;
        }
        if (!is_drawn) {
            good_figure = draw(figure);
            CU_ASSERT(good_figure);
            if (good_figure) CU_ASSERT(is_set_out(figure));
            if (good_figure) slurp("drawn", data, sizeof data);
            drawn = data;
            is_drawn = true;
        }
        if (!good_figure) continue;
        if (strcmp(line, "text") == 0) {
            const bool shown =
                file_holds("set", rest) || file_holds("drawn", rest) || file_holds("plain.svg", rest);
            CHECK_OR_SAY(shown, "tests/figures.txt:%d: %s: no text \"%s\"", number, figure, rest);
            continue;
        }
        bool right = next_curve();
        if (!right) fprintf(stderr, "%s: no such curve\n", figure);
        if (right && strcmp(line, "curve") == 0) right = check_curve(rest);
        if (right && strcmp(line, "line") == 0) right = check_line(rest);
        CHECK_OR_SAY(right, "tests/figures.txt:%d: %s", number, figure);
        if (!right) good_figure = false;
    }
    leave();
}

/* Every figure is described, or skipped for a reason. */
static void check_described(const char *path)
{
    size_t n;
    scoped char *text = file_read("tests/figures.txt", &n);
    const char *name = path + strlen("figures/");
    const int length = (int)(strrchr(name, '.') - name);
    const char *figure = check_text("\nfigure %.*s\n", length, name);
    const char *skip = check_text("\nskip %.*s ", length, name);
    CHECK_OR_SAY(strstr(text, figure) || strstr(text, skip), "tests/figures.txt: no figure %s", path);
}

static void test_all_described(void)
{
    each_figure(check_described);
}

/* A figure says what it shows, and leaves sizes and fonts to figures/style.gp. */
static void check_style(const char *path)
{
    static const char *const elsewhere[] = {
        " font '", " font \"", "set terminal", "\nwidth = ", "\nheight = ", "set title", "set key"};
    size_t n;
    scoped char *text = file_read(path, &n);
    bool good = strstr(text, "heading = ") || strstr(text, "load 'figures/l");
    for (size_t k = 0; k < sizeof elsewhere / sizeof *elsewhere; k++) good &= !strstr(text, elsewhere[k]);
    CHECK_OR_SAY(good, "%s: no heading, or a size or font of its own", path);
}

static void test_style_in_one_place(void)
{
    each_figure(check_style);
}

/* Fixtures are tables of their own: the published numbers that figures name, and the tables of sweeps whose
 * results stand here, are there. */
static void test_present(void)
{
    CU_ASSERT(
        system("made=$(cut -f 1,8 report/claims.tsv) && n=0\n"
               "numbers=\"published('[^']*'\\|printed('[^']*', '[^']*'\\|note('claims/[^']*', '[^']*'\"\n"
               "for name in $(grep -oh \"$numbers\" figures/l*/*.gp figures/studies/*.gp |\n"
               "  sed \"s/'$//; s/.*'//\"); do\n"
               "  n=$((n + 1)); echo \"$made\" | grep -q \"^$name\t[0-9]\\|^# $name: \" ||\n"
               "  { echo \"$name: not published\"; exit 1; }\n"
               "done\n"
               "for table in $(sed -n 's/^table \\([^ ]*\\).*/\\1/p' tests/figures.txt); do\n"
               "  sweep=${table%%/*}; [ -e sweeps/studies/$sweep.cfg ] || continue\n"
               "  n=$((n + 1)); [ -e results/$table ] || { echo \"results/$table: none\"; exit 1; }\n"
               "done\n"
               "[ $n -gt 30 ]") == 0);
}

/* `make` draws a figure again after a change of a file that it loads. */
static void test_loaded_files(void)
{
    CU_ASSERT(
        system(
            "n=0\n"
            "lines=$(sed -n \"s/^load '\\(.*\\)'/\\1/p; T; F\" figures/l?/*.gp | paste -d: - -)\n"
            "rules=$(for line in $lines; do name=${line##*/}; echo build/figures/${name%.gp}.svg; done |\n"
            "  sort -u | xargs make --no-print-directory -np 2>/dev/null | grep '^build/figures/.*svg: ')\n"
            "for line in $lines; do\n"
            "  name=${line##*/}; loaded=${line%%:*}; n=$((n + 1))\n"
            "  echo \"$rules\" | grep -q \"^build/figures/${name%.gp}.svg: .*$loaded\" || { echo \"$line\"; "
            "exit 1; }\n"
            "done\n"
            "[ $n -gt 20 ]") == 0);
}

CHECK_SUITE(figures, "figures", test_drawn, test_all_described, test_style_in_one_place, test_present,
            test_loaded_files)
