/* Places of the report's texts: the words around a place name what it shows, its column and its row. A place
 * that reads another column, row or table then stands beside words that do not fit. */
#include <ctype.h>
#include <glob.h>

#include "tests/protocol.h"
#include "tests/program.h"

enum { MOST_TEXT = 1 << 16, MOST_WORDS = 24 };

/* What a column is called, one word of several; the first row whose `ends` or begins fit counts. */
static const struct {
    const char *begins, *ends, *words;
} called[] = {{"", "_n", "pile|grain"},
              {"", "_sd", "deviat|scatter"},
              {"", "_sd_deg", "deviat|scatter"},
              {"", "_lo", "from|to|95"},
              {"", "_hi", "from|to|95"},
              {"", "_lo95", "from|to|95"},
              {"", "_hi95", "from|to|95"},
              {"theta_r12", "", "1 less|methods 1 and 2|both differences"},
              {"theta_r1", "", "method 1"},
              {"theta_r23", "", "2 less|method 3|both differences"},
              {"theta_r2", "", "method 2"},
              {"theta_r3", "", "theta_R|method 3|slope|fill"},
              {"theta_rt", "", "theta_R + theta_T"},
              {"theta_t_energy", "", "energy"},
              {"theta_t", "", "theta_T"},
              {"theta_ms", "", "theta_MS"},
              {"theta_sd", "", "deviat"},
              {"theta_deg", "", "angle|degrees"},
              {"diff_printed", "", "printed"},
              {"diff_sine", "", "sine"},
              {"diff_balanced", "", "balance"},
              {"diff_lattice", "", "lattice|balance"},
              {"diff_ms", "", "difference"},
              {"excess", "", "excess|rays|lower"},
              {"middle", "", "middle"},
              {"below", "", "below|minimum"},
              {"p_", "", "p"},
              {"change_l", "", "from"},
              {"change_h", "", "to"},
              {"change", "", "change|rise"},
              {"limit_floor", "", "floor"},
              {"limit_wall", "", "wall"},
              {"limit_inside", "", "between grains"},
              {"limit", "", "limit|method"},
              {"slope_se", "", "power"},
              {"slope", "", "slope|power|per cm"},
              {"intercept", "", "intercept|at mu = 0"},
              {"correlation", "", "correlation"},
              {"residual", "", "straight line"},
              {"psi6", "", "bond order"},
              {"fabric", "", "anisotropy"},
              {"force_fabric", "", "anisotropy of our forces"},
              {"bulk_friction", "", "friction"},
              {"left_deg", "", "slope"},
              {"right_deg", "", "slope"},
              {"height", "", "high"},
              {"width_mean", "", "base"},
              {"contacts", "", "contact"},
              {"n_disks", "", "disks"},
              {"disks", "", "disks"},
              {"grains_mean", "", "grains"},
              {"packed", "", "close-packed"},
              {"moved_floor", "", "floor"},
              {"moved_surface", "", "surface"},
              {"moved_inside", "", "inside"},
              {"moves_depth", "", "depth of motion"},
              {"all_depth", "", "depth of the grains"},
              {"N_continuum", "", "N against the continuum|deviation of N"},
              {"H_continuum", "", "H against the continuum"},
              {"N_error_rms", "", "N, root mean square"},
              {"N_error", "", "N, largest|N deviates"},
              {"H_slope_ratio", "", "slope of H"},
              {"H_ratio", "", "largest H"},
              {"H_N", "", "H/N"},
              {"n_failed", "", "fail|without|spread|at rest"},
              {"weight_error", "", "weight"},
              {"balance_error", "", "force"},
              {"residual_energy", "", "energy"},
              {"eps_c", "", "stable"},
              {"level_insertion", "", "grains"},
              {"x_to", "", "up to|run to"},
              {"well", "", "half-width"},
              {"cases", "", "cases"},
              {"worst_over", "", "worst"},
              {"run_time", "", "time"},
              {"largest_error", "", "largest error"},
              {"n", "n", "pile|runs"}};

/* How a table of {{rows}} heads the columns that choose its rows: by their names or by these. */
static const char *const headed[][2] = {{"mu_roll", "rolling"},
                                        {"slip", "spring"},
                                        {"n_least", "piles"},
                                        {"alpha_deg", "slope"},
                                        {"inner_deg", "inner slope"},
                                        {"tilt", "turned"},
                                        {"tilt_rate_deg", "per step"},
                                        {"source_width", "source"},
                                        {"drop_height", "fall"},
                                        {"radius_width", "radii"},
                                        {"thrust_ratio", "thrust"},
                                        {"disorder", "deviation"},
                                        {"set_load", "load"},
                                        {"leave", "direction"},
                                        {"released", "released"},
                                        {"horizontal", "within rows"},
                                        {"base", "base"},
                                        {"law", "law"},
                                        {"case", "scheme"},
                                        {"eps", "eps|m g"},
                                        {"strongest_level", "strongest"},
                                        {"weakest_level", "weakest"},
                                        {"quantity", "quantity"},
                                        {"floor_friction", "floor"},
                                        {"bulk_friction", "mobilised"},
                                        {"base_shear", "shear"},
                                        {"fabric_deg", "direction"},
                                        {"force_deg", "forces"}};

/* ---- words ---- */

static bool holds_one(const char *text, const char *words)
{
    char copy[128], *rest = copy;
    snprintf(copy, sizeof copy, "%s", words);
    for (const char *word; (word = strsep(&rest, "|"));)
        if (strcasestr(text, word)) return true;
    return false;
}

/* Whether a number stands in the text, by itself or as per cent. */
static bool holds_number(const char *text, double wanted)
{
    for (const char *c = text; *c; c++) {
        char *end;
        if (!isdigit((unsigned char)*c) || (c > text && (isalnum((unsigned char)c[-1]) || c[-1] == '.')))
            continue;
        const double number = strtod(c, &end) * (strncmp(end, " %", 2) == 0 ? 0.01 : 1.0);
        if (fabs(number - wanted) <= 1e-12 * fabs(wanted)) return true;
        c = end - 1;
    }
    return false;
}

/* The numbers that follow "KEY = " in a sentence, "0.1, 0.2 and 0.3"; empty if it does not name the key. */
static void numbers_of(const char *line, const char *key, char list[256])
{
    size_t used = 0;
    const char *said = check_text("%s = ", key);
    for (const char *at = line; (at = strstr(at, said)); at++)
        if (at == line || !(isalnum((unsigned char)at[-1]) || at[-1] == '_'))
            for (const char *c = at + strlen(said);
                 used < 250 &&
                 (isdigit((unsigned char)*c) || strchr(".-e, ", *c) || strncmp(c, "and ", 4) == 0 ||
                  strncmp(c, "to ", 3) == 0 || strncmp(c, "or ", 3) == 0);)
                do list[used++] = *c++;
                while (used < 250 && isalpha((unsigned char)*c));
    list[used] = '\0';
}

/* A setting that needs no word: what a protocol has unless told, or the header of the claims. */
static bool is_usual(const rp_table *claims, const char *key, const char *value)
{
    static const char *const words[] = {"auto", "none",     "computed", "all",
                                        "free", "smallest", "largest",  "ok_fixed_time"};
    for (size_t k = 0; k < sizeof words / sizeof *words; k++)
        if (strcmp(value, words[k]) == 0) return true;
    for (size_t k = 0; sweep_protocols[k]; k++) {
        const rp_param *p = rp_params_find(protocol_of(sweep_protocols[k])->schema, key);
        char *end;
        if (p && p->fallback && strtod(p->fallback, &end) == strtod(value, NULL) && end > p->fallback &&
            !*end)
            return true;
    }
    const char *said = check_text("%s=%s", key, value);
    const char *lh = rp_table_find_note(claims, "at lh"), *li = rp_table_find_note(claims, "at li");
    return strstr(lh, said) || strstr(li, said);
}

/* ---- a place ---- */

typedef struct {
    const rp_table *claims;
    char section[MOST_TEXT], line[MOST_TEXT], head[MOST_TEXT], before[MOST_TEXT]; /* without places */
} around;

/* Words of four letters and more of a value such as paired_less: one is enough. */
static bool holds_part(const char *text, const char *value)
{
    char copy[128], *rest = copy;
    snprintf(copy, sizeof copy, "%s", value);
    for (const char *part; (part = strsep(&rest, "_-,"));)
        if (strlen(part) >= 3 && strcasestr(text, part)) return true;
    return false;
}

/* Sentences name a condition that is not usual. A number after the key's own name is one of those there. */
static bool condition_fits(const around *a, bool sentence, const char *key, const char *value)
{
    char *end, list[256];
    const double number = strtod(value, &end), to = *end == ':' ? strtod(end + 1, NULL) : number;
    if (end == value || (*end && *end != ':'))
        return is_usual(a->claims, key, value) || holds_part(a->section, value);
    numbers_of(a->line, key, list);
    if (sentence && *list) return holds_number(list, number);
    return is_usual(a->claims, key, value) ||
           (holds_number(a->section, number) && holds_number(a->section, to));
}

/* Cell number `column` of a table's line, from 0. */
static void cell_of(const char *line, int column, char text[512])
{
    const char *c = line;
    while (column-- > 0 && c) c = strchr(c + 1, '|');
    snprintf(text, 512, "%.*s", c ? (int)strcspn(c + 1, "|") : 0, c ? c + 1 : "");
}

static bool column_fits(const char *column, const char *near)
{
    for (size_t k = 0; k < sizeof called / sizeof *called; k++) {
        const size_t length = strlen(column), end = strlen(called[k].ends);
        if (strncmp(column, called[k].begins, strlen(called[k].begins)) == 0 && length >= end &&
            strcmp(column + length - end, called[k].ends) == 0)
            return holds_one(near, called[k].words);
    }
    for (size_t k = 0; k < sizeof headed / sizeof *headed; k++)
        if (strncmp(column, headed[k][0], strlen(headed[k][0])) == 0 && holds_one(near, headed[k][1]))
            return true;
    return strcasestr(near, column) != NULL;
}

static size_t columns_of(const char *head)
{
    size_t n = 0;
    for (; *head; head++) n += *head == '|';
    return n - 1;
}

/* A place of a line: `column` of a table's line, -1 in a sentence. False after a message. */
static bool place_fits(const around *a, int column, char *place)
{
    static char near[MOST_TEXT];
    char head[512] = "", label[512] = "", *words[MOST_WORDS];
    size_t n = 0, bar = 0;
    for (char *save, *w = strtok_r(place, " ", &save); w && n < MOST_WORDS; w = strtok_r(NULL, " ", &save)) {
        if (*w == '|') bar = n;
        if (*w != '%') words[n++] = w;
    }
    const bool rows = strcmp(words[0], "rows") == 0, note = strcmp(words[0], "note") == 0;
    if (n < 3 || !(rows || note || strcmp(words[0], "value") == 0 || strcmp(words[0], "cell") == 0))
        return true;
    for (size_t k = 2; k < (rows ? bar : note ? 0 : n - 1); k++) {
        char *value = strchr(words[k], '=');
        if (!value) continue;
        *value = '\0';
        const bool fits = condition_fits(a, column < 0 && !rows, words[k], value + 1);
        if (!fits) fprintf(stderr, "%s=%s is not named: %s\n", words[k], value + 1, a->line);
        if (!fits) return false;
    }
    for (size_t k = rows ? bar + 1 : n - 1; k < n; k++) {
        words[k][strcspn(words[k], ":")] = '\0';
        if (rows || column >= 0) cell_of(a->head, rows ? (int)(k - bar - 1) : column, head);
        if (column >= 0) cell_of(a->line, 0, label);
        snprintf(near, sizeof near, "%.500s %.500s %.60000s", head, label,
                 rows || column >= 0 ? a->before : a->line);
        const bool fits = (note && strcmp(words[k], "run_time") != 0) || column_fits(words[k], near);
        if (!fits) fprintf(stderr, "column %s is not named: %s%s\n", words[k], head, a->line);
        if (!fits) return false;
    }
    return !rows || n - bar - 1 == columns_of(a->head);
}

/* Blank the places of a text. */
static void blank_places(char *text)
{
    for (char *open = text, *close; (open = strstr(open, "{{")) && (close = strstr(open, "}}")); open = close)
        memset(open, ' ', (size_t)(close + 2 - open));
}

/* A line of a table that begins with a number reads rows of this number. */
static bool label_fits(const char *line, const char *place)
{
    char label[512], *end;
    cell_of(line, 0, label);
    const double number = strtod(label, &end);
    if (end == label || end[strspn(end, " ")] || !strchr(place, '=')) return true;
    for (const char *c = place; (c = strchr(c, '=')); c++)
        if (strtod(c + 1, &end) == number && end > c + 1) return true;
    fprintf(stderr, "not of %g: %s\n", number, place);
    return false;
}

/* Whether a place stands in the line once. */
static bool is_single(const char *line, const char *place)
{
    const char *first = strstr(line, place), *again = strstr(first + 1, place);
    if (again) fprintf(stderr, "twice: %s\n", place);
    return !again;
}

static bool line_fits(around *a, const char *line)
{
    bool fits = true;
    const bool table = *line == '|';
    int column = -1;
    snprintf(a->line, sizeof a->line, "%s", line);
    blank_places(a->line);
    for (const char *c = line; *c; c++) {
        char place[1024];
        column += table && *c == '|';
        if (strncmp(c, "{{", 2) != 0) continue;
        snprintf(place, sizeof place, "%.*s", (int)(strstr(c, "}}") + 2 - c), c);
        fits &= is_single(line, place) && (!table || label_fits(line, place));
        place[strlen(place) - 2] = '\0';
        fits &= place_fits(a, table ? column : -1, place + 2);
        c = strstr(c, "}}");
    }
    return fits;
}

/* A section ends where the next line of this text begins one. */
static void read_section(const char *text, around *a)
{
    const char *end = strstr(text + 1, "\n#");
    snprintf(a->section, sizeof a->section, "%.*s", end ? (int)(end - text) : (int)strlen(text), text);
    blank_places(a->section);
}

static bool text_fits(const char *path, around *a)
{
    bool fits = true, in_table = false;
    size_t n;
    scoped char *text = file_read(path, &n);
    read_section(text, a);
    for (char *line = text, *end; *line; line = end) {
        if (*line == '#') read_section(line, a);
        end = line + strcspn(line, "\n");
        if (*end) *end++ = '\0';
        if (*line == '|' && !in_table) snprintf(a->head, sizeof a->head, "%s", line);
        in_table = *line == '|' || strncmp(line, "{{rows", 6) == 0;
        fits &= line_fits(a, line);
        if (*line && !in_table) snprintf(a->before, sizeof a->before, "%s", a->line);
    }
    return fits;
}

static void test_words(void)
{
    static around a;
    scoped_table claims = {0};
    CHECK_OK(rp_table_read("report/claims.tsv", &claims));
    a.claims = &claims;
    RP_ENDS(globfree) glob_t found;
    CU_ASSERT_FATAL(glob("report/text/*.md.in", 0, NULL, &found) == 0);
    for (size_t i = 0; i < found.gl_pathc; i++)
        if (!strstr(found.gl_pathv[i], "/validation")) CU_ASSERT(text_fits(found.gl_pathv[i], &a));
}

CHECK_SUITE(places, "places", test_words)
