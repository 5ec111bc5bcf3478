/* repose forensics: which choices that a paper leaves open agree with the numbers that it gives?
 *
 * A sweep has run combinations of choices (factors), each at the grid points that the published claims speak
 * of. Every combination is judged by all claims at once; see angle.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "angle/angle.h"
#include "stats/stats.h"
#include "stats/forensics.h"
#include "cli/claims.h"
#include "cli/cli.h"
#include "core/random.h"

static const double deg = M_PI / 180.0;

enum { MAX_FACTORS = 24, MAX_LEVELS = 12, MAX_CLAIMS = 24, MAX_TERMS = 64, MAX_COORDINATES = 8 };
enum { REPORT_COMBINATIONS, REPORT_EFFECTS, REPORT_LEVELS };

typedef struct {
    const char *claims, *factors;
    int report;
    double level;
    long draws, seed;
} forensics_options;

static const rp_param options[] = {
    {"claims", "", RP_TEXT, offsetof(forensics_options, claims), "figures/claims.tsv", "",
     "published claims"},
    {"factors", "", RP_TEXT, offsetof(forensics_options, factors), NULL, "",
     "columns of the choices, joined by commas; a:b ranks the values of a within each value of b"},
    {"report", "", RP_CHOICE, offsetof(forensics_options, report), "combinations",
     "combinations | effects | levels", "what to print"},
    {"level", "", RP_REAL, offsetof(forensics_options, level), "0.05", "(0, 1)",
     "a true combination is excluded with this chance"},
    {"draws", "", RP_INT, offsetof(forensics_options, draws), "1000", "[20, 1000000]",
     "simulated publications of each combination"},
    {"seed", "", RP_INT, offsetof(forensics_options, seed), "1993", "[0, 2147483647]", "seed of the draws"},
    {0}};

/* How the surface of a pile is read; a column of the first has its stem alone. */
#define VARIANT(height, empty) #height "_" #empty, #height "_" #empty "_origin",
static const char *const variants[] = {ANG_SURFACES(VARIANT)};
enum { N_VARIANTS = sizeof variants / sizeof *variants };

typedef struct {
    size_t claim;
    double coefficient;
    double at[MAX_COORDINATES];
    int column[N_VARIANTS]; /* of the runs */
} claim_term;

typedef struct {
    const rp_table *runs;
    size_t n_factors, n_coordinates, n_claims, n_terms, n_combinations;
    struct {
        char name[40];
        int column, within; /* within: the column whose values it is nested in, or -1 */
        size_t n_levels;
        char levels[MAX_LEVELS][24];
    } factor[MAX_FACTORS];
    char coordinates[MAX_COORDINATES][24]; /* keys that say where a term is measured */
    double usual[MAX_COORDINATES];         /* and where, if the term does not say */
    int coordinate[MAX_COORDINATES], status;
    struct {
        char name[40];
        bool held_out;
    } about[MAX_CLAIMS];
    stats_claim claims[MAX_CLAIMS];
    claim_term terms[MAX_TERMS];
    size_t *level;  /* [combination][factor] */
    size_t *of_run; /* combination of each run */
    double *y, *se; /* [combination][variant][claim] */
} study;

static const char *cell(const rp_table *t, size_t row, int column)
{
    return t->cells[row * t->n_columns + (size_t)column];
}

static rp_status find_column(const rp_table *t, const char *name, int *column)
{
    return cli_find_columns(t, 1, &name, column);
}

/* ---- reading ---- */

static rp_status read_factors(study *s, const char *list)
{
    char text[1024];
    if (strlen(list) >= sizeof text) return rp_fail(RP_BAD_INPUT, "--factors: too long");
    strcpy(text, list);
    for (char *save, *word = strtok_r(text, ",", &save); word; word = strtok_r(NULL, ",", &save)) {
        if (s->n_factors == MAX_FACTORS) return rp_fail(RP_BAD_INPUT, "--factors: at most %d", MAX_FACTORS);
        char *colon = strchr(word, ':');
        if (colon) *colon = '\0';
        snprintf(s->factor[s->n_factors].name, sizeof s->factor->name, "%s", word);
        s->factor[s->n_factors].within = -1;
        rp_status status = find_column(s->runs, word, &s->factor[s->n_factors].column);
        if (!status && colon) status = find_column(s->runs, colon + 1, &s->factor[s->n_factors].within);
        if (status) return status;
        s->n_factors++;
    }
    return s->n_factors > 0 ? RP_OK : rp_fail(RP_BAD_INPUT, "--factors: none given");
}

/* Rank of a run's value among the distinct values of its nest. */
static size_t rank_within(const rp_table *t, size_t row, int column, int within)
{
    size_t rank = 1;
    double value = strtod(cell(t, row, column), NULL), seen[MAX_LEVELS];
    size_t n_seen = 0;
    for (size_t r = 0; r < t->n_rows; r++) {
        if (strcmp(cell(t, r, within), cell(t, row, within)) != 0) continue;
        double other = strtod(cell(t, r, column), NULL);
        bool known = other >= value;
        for (size_t k = 0; k < n_seen && !known; k++) known = seen[k] == other;
        if (known || n_seen == MAX_LEVELS) continue;
        seen[n_seen++] = other;
        rank++;
    }
    return rank;
}

static rp_status level_of(study *s, size_t row, size_t f, size_t *level)
{
    char label[24];
    const char *text = cell(s->runs, row, s->factor[f].column);
    if (s->factor[f].within >= 0)
        snprintf(label, sizeof label, "%zu",
                 rank_within(s->runs, row, s->factor[f].column, s->factor[f].within));
    else
        snprintf(label, sizeof label, "%s", text);
    for (*level = 0; *level < s->factor[f].n_levels; ++*level)
        if (strcmp(s->factor[f].levels[*level], label) == 0) return RP_OK;
    if (*level == MAX_LEVELS)
        return rp_fail(RP_BAD_INPUT, "%s: column %s has more than %d different values: no factor",
                       s->runs->path, s->factor[f].name, MAX_LEVELS);
    strcpy(s->factor[f].levels[s->factor[f].n_levels++], label);
    return RP_OK;
}

/* Give each run the number of its combination; the first run's levels are the reference of each factor. */
static rp_status read_combinations(study *s)
{
    const size_t n = s->runs->n_rows, F = s->n_factors;
    s->level = calloc((n + 1) * F, sizeof *s->level);
    s->of_run = calloc(n + 1, sizeof *s->of_run);
    if (!s->level || !s->of_run) return rp_fail(RP_NO_MEMORY, "forensics: out of memory");
    for (size_t row = 0; row < n; row++) {
        size_t *mine = s->level + s->n_combinations * F, c = 0;
        for (size_t f = 0; f < F; f++) {
            rp_status status = level_of(s, row, f, &mine[f]);
            if (status) return status;
        }
        while (memcmp(s->level + c * F, mine, F * sizeof *mine) != 0) c++;
        s->of_run[row] = c;
        s->n_combinations += c == s->n_combinations;
    }
    return RP_OK;
}

/* The columns of all surface variants of a quantity such as theta_r3. */
static rp_status find_variants(const study *s, const char *stem, int column[N_VARIANTS])
{
    rp_status status = RP_OK;
    for (int v = 0; v < N_VARIANTS && !status; v++) {
        char name[80];
        /* the parabola is of method 3 alone */
        size_t length = strlen(variants[v]);
        if (strstr(variants[v], "_origin") && !strstr(stem, "r3")) length -= strlen("_origin");
        const bool first = strncmp(variants[v], variants[0], length) == 0;
        snprintf(name, sizeof name, "%s%s%.*s_deg", stem, first ? "" : "_", first ? 0 : (int)length,
                 variants[v]);
        status = find_column(s->runs, name, &column[v]);
    }
    return status;
}

/* Set coordinates from the words key=value, first <= w < last. */
static rp_status read_point(const study *s, const cli_words *words, int first, int last, double at[])
{
    for (int w = first; w < last; w++) {
        char *equals = strchr(words->words[w], '='), *end;
        size_t k = 0;
        if (!equals) return rp_fail(RP_BAD_INPUT, "\"%s\": key=value expected", words->words[w]);
        const size_t length = (size_t)(equals - words->words[w]);
        while (k < s->n_coordinates &&
               (strncmp(s->coordinates[k], words->words[w], length) != 0 || s->coordinates[k][length]))
            k++;
        if (k == s->n_coordinates)
            return rp_fail(RP_BAD_INPUT, "\"%s\": not among the keys of the header line `at`",
                           words->words[w]);
        at[k] = strtod(equals + 1, &end);
        if (*end) return rp_fail(RP_BAD_INPUT, "\"%s\": not a number", words->words[w]);
    }
    return RP_OK;
}

/* The header line `at`: the keys that say where a term is measured, and their values by default. */
static rp_status read_coordinates(study *s, const rp_table *claims)
{
    cli_words words;
    const char *note = rp_table_find_note(claims, "at");
    rp_status status = note ? cli_split(note, &words) : rp_fail(RP_BAD_INPUT, "no header line \"at\"");
    if (status) return status;
    if (words.n > MAX_COORDINATES) return rp_fail(RP_BAD_INPUT, "at: at most %d keys", MAX_COORDINATES);
    for (int w = 0; w < words.n && !status; w++) {
        snprintf(s->coordinates[w], sizeof s->coordinates[w], "%.*s", (int)strcspn(words.words[w], "="),
                 words.words[w]);
        status = find_column(s->runs, s->coordinates[w], &s->coordinate[w]);
        s->n_coordinates++;
    }
    return status ? status : read_point(s, &words, 0, words.n, s->usual);
}

static rp_status add_terms(study *s, const cli_words *words, int first)
{
    double coefficient = 1.0;
    for (int last; first < words->n; first = last + 1, coefficient = -1.0) {
        if (s->n_terms == MAX_TERMS) return rp_fail(RP_BAD_INPUT, "at most %d terms", MAX_TERMS);
        claim_term *term = &s->terms[s->n_terms++];
        for (last = first + 1; last < words->n && strcmp(words->words[last], "less") != 0;) last++;
        term->claim = s->n_claims;
        term->coefficient = coefficient;
        memcpy(term->at, s->usual, sizeof term->at);
        rp_status status = read_point(s, words, first + 1, last, term->at);
        if (!status) status = find_variants(s, words->words[first], term->column);
        if (status) return status;
    }
    return RP_OK;
}

static rp_status read_claim(study *s, const cli_claim *c)
{
    cli_words words;
    rp_status status = cli_split(c->forensics, &words);
    if (status) return status;
    int w = strcmp(words.words[0], "held") == 0;
    const bool sign = w < words.n && strchr("+-", words.words[w][0]) && !words.words[w][1];
    if (s->n_claims == MAX_CLAIMS) return rp_fail(RP_BAD_INPUT, "at most %d claims", MAX_CLAIMS);
    if (w + sign >= words.n) return rp_fail(RP_BAD_INPUT, "\"%s\": a column expected", c->forensics);
    if (!sign && !(c->published.se > 0.0))
        return rp_fail(RP_BAD_INPUT, "a published number with its error expected, or + or - for a sign");
    snprintf(s->about[s->n_claims].name, sizeof s->about->name, "%s", c->id);
    s->about[s->n_claims].held_out = w;
    s->claims[s->n_claims] =
        sign ? (stats_claim){STATS_CLAIM_SIGN, words.words[w][0] == '-' ? -1.0 : 1.0, 0.0}
             : (stats_claim){STATS_CLAIM_VALUE, c->published.value * deg, c->published.se * deg};
    status = add_terms(s, &words, w + sign);
    s->n_claims++;
    return status;
}

static rp_status read_claims(study *s, const char *path)
{
    cli_claims all;
    rp_status status = cli_claims_read(path, &all);
    if (!status && (status = read_coordinates(s, &all.table)) != RP_OK) rp_prefix(status, "%s: ", path);
    for (size_t i = 0; i < all.n && !status; i++)
        if (*all.claims[i].forensics && (status = read_claim(s, &all.claims[i])) != RP_OK)
            rp_prefix(status, "%s: claim %s: ", path, all.claims[i].id);
    if (!status && s->n_claims == 0) status = rp_fail(RP_NO_RESULT, "%s: no claims", path);
    cli_claims_free(&all);
    return status;
}

/* ---- numbers of each combination ---- */

static bool matches(const study *s, const claim_term *term, size_t row)
{
    for (size_t k = 0; k < s->n_coordinates; k++) {
        double at = strtod(cell(s->runs, row, s->coordinate[k]), NULL);
        if (!(fabs(at - term->at[k]) <= 1e-9 * fabs(term->at[k]))) return false;
    }
    return true;
}

typedef struct {
    size_t n, n_ok;
    double sum, squares;
} cell_sum;

/* Means of one term and variant over the runs of each combination, with the standard deviation pooled over
 * the combinations: six piles alone say too little of theirs. Adds to y and to the squares in se. */
static rp_status add_term(study *s, const claim_term *term, int v, cell_sum sums[])
{
    const rp_table *t = s->runs;
    memset(sums, 0, s->n_combinations * sizeof *sums);
    for (size_t row = 0; row < t->n_rows; row++) {
        if (!matches(s, term, row)) continue;
        cell_sum *c = &sums[s->of_run[row]];
        double value;
        rp_status status = rp_table_number(t, row, term->column[v], 1, &value);
        if (status) return status;
        c->n++;
        if (strncmp(cell(t, row, s->status), "ok", 2) != 0 || !isfinite(value)) continue;
        c->n_ok++;
        c->sum += value * deg;
        c->squares += value * deg * value * deg;
    }
    double squares = 0.0, dof = 0.0;
    for (size_t c = 0; c < s->n_combinations; c++) {
        if (sums[c].n_ok < 2) continue;
        squares += sums[c].squares - sums[c].sum * sums[c].sum / (double)sums[c].n_ok;
        dof += (double)sums[c].n_ok - 1.0;
    }
    for (size_t c = 0; c < s->n_combinations; c++) {
        size_t at = (c * N_VARIANTS + (size_t)v) * s->n_claims + term->claim;
        double n = (double)sums[c].n_ok;
        bool enough = sums[c].n_ok > 0 && 2 * sums[c].n_ok >= sums[c].n;
        s->y[at] += enough ? term->coefficient * sums[c].sum / n : NAN;
        s->se[at] += enough ? term->coefficient * term->coefficient * squares / dof / n : NAN;
    }
    return RP_OK;
}

static rp_status read_numbers(study *s)
{
    const size_t n = s->n_combinations * N_VARIANTS * s->n_claims;
    s->y = calloc(n + 1, sizeof *s->y);
    s->se = calloc(n + 1, sizeof *s->se);
    cell_sum *sums = calloc(s->n_combinations + 1, sizeof *sums);
    rp_status status = s->y && s->se && sums ? RP_OK : rp_fail(RP_NO_MEMORY, "forensics: out of memory");
    for (size_t k = 0; k < s->n_terms; k++)
        for (int v = 0; v < N_VARIANTS && !status; v++) status = add_term(s, &s->terms[k], v, sums);
    for (size_t i = 0; i < n && !status; i++) s->se[i] = sqrt(s->se[i]);
    free(sums);
    return status;
}

/* ---- judging ---- */

/* Judge all combinations and variants by the claims that are held out, or that are not. */
static rp_status judge(const study *s, bool held_out, const forensics_options *o, stats_agreement agreement[],
                       stats_chance *chance)
{
    const size_t m = s->n_combinations * N_VARIANTS;
    stats_claim claims[MAX_CLAIMS];
    size_t n = 0;
    double *y = malloc((m * s->n_claims + 1) * sizeof *y), *se = malloc((m * s->n_claims + 1) * sizeof *se);
    gsl_rng *rng = rp_random_alloc((unsigned long)o->seed, held_out, RP_PURPOSE_BOOTSTRAP);
    rp_status status = y && se && rng ? RP_OK : rp_fail(RP_NO_MEMORY, "forensics: out of memory");
    for (size_t k = 0; k < s->n_claims; k++)
        if (s->about[k].held_out == held_out) claims[n++] = s->claims[k];
    for (size_t c = 0; c < m && !status; c++)
        for (size_t k = 0, i = 0; k < s->n_claims; k++) {
            if (s->about[k].held_out != held_out) continue;
            y[c * n + i] = s->y[c * s->n_claims + k];
            se[c * n + i++] = s->se[c * s->n_claims + k];
        }
    if (!status && n > 0)
        status = stats_claims_judge(m, n, claims, y, se, o->level, (size_t)o->draws,
                                    held_out ? 0 : (size_t)o->draws, rng, agreement, chance);
    if (!status && n == 0)
        for (size_t c = 0; c < m; c++) agreement[c] = (stats_agreement){false, true, NAN, NAN, NAN};
    if (rng) gsl_rng_free(rng);
    free(y);
    free(se);
    return status;
}

static const char *verdict(const stats_agreement *a)
{
    return !a->complete ? "incomplete" : a->excluded ? "excluded" : "not_excluded";
}

static const double *sort_key;

static int by_likelihood(const void *a, const void *b)
{
    size_t i = *(const size_t *)a, j = *(const size_t *)b;
    double p = sort_key[i], q = sort_key[j];
    return p != q ? (p < q) - (p > q) : (i > j) - (i < j);
}

static void print_combination_header(const study *s)
{
    printf("#");
    for (size_t f = 0; f < s->n_factors + 5; f++) printf("\t");
    for (size_t k = 0; k < s->n_claims; k++) printf("\tdeg\tdeg");
    printf("\t\n# rank\tcombination\tsimulated\tsurface");
    for (size_t f = 0; f < s->n_factors; f++) printf("\t%s", s->factor[f].name);
    printf("\tlog_likelihood\tp_value\tp_held_out");
    for (size_t k = 0; k < s->n_claims; k++)
        printf("\t%s_deg\t%s_se_deg", s->about[k].name, s->about[k].name);
    printf("\tstatus\n");
}

static rp_status print_combinations(const study *s, const stats_agreement *main, const stats_agreement *held)
{
    const size_t m = s->n_combinations * N_VARIANTS;
    size_t *order = malloc((m + 1) * sizeof *order);
    double *key = malloc((m + 1) * sizeof *key);
    bool *seen = calloc(s->n_combinations + 1, sizeof *seen);
    if (!order || !key || !seen) {
        free(order);
        free(key);
        free(seen);
        return rp_fail(RP_NO_MEMORY, "forensics: out of memory");
    }
    for (size_t c = 0; c < m; c++) {
        order[c] = c;
        key[c] = main[c].complete ? main[c].log_likelihood : -INFINITY;
    }
    sort_key = key;
    qsort(order, m, sizeof *order, by_likelihood);
    print_combination_header(s);
    for (size_t i = 0, n_seen = 0; i < m; i++) {
        size_t c = order[i], combination = c / N_VARIANTS, simulated = 0;
        if (!seen[combination]) simulated = ++n_seen;
        seen[combination] = true;
        printf("%zu\t%zu\t%zu\t%s", i + 1, combination, simulated, variants[c % N_VARIANTS]);
        for (size_t f = 0; f < s->n_factors; f++)
            printf("\t%s", s->factor[f].levels[s->level[combination * s->n_factors + f]]);
        printf("\t%.17g\t%.17g\t%.17g", main[c].log_likelihood, main[c].p_value, held[c].p_value);
        for (size_t k = 0; k < s->n_claims; k++)
            printf("\t%.17g\t%.17g", s->y[c * s->n_claims + k] / deg, s->se[c * s->n_claims + k] / deg);
        printf("\t%s\n", verdict(&main[c]));
    }
    free(order);
    free(key);
    free(seen);
    return RP_OK;
}

/* Each level of each factor, and each way to read the surface: how much of it is left. */
static void print_levels(const study *s, const stats_agreement *a)
{
    const size_t m = s->n_combinations * N_VARIANTS;
    double top = -INFINITY, total = 0.0;
    for (size_t c = 0; c < m; c++)
        if (a[c].complete) top = fmax(top, a[c].log_likelihood);
    for (size_t c = 0; c < m; c++)
        if (a[c].complete) total += exp(a[c].log_likelihood - top);
    rp_table_header(stdout, "factor, level, tested, complete, not_excluded, share");
    for (size_t f = 0; f <= s->n_factors; f++) {
        size_t n_levels = f < s->n_factors ? s->factor[f].n_levels : (size_t)N_VARIANTS;
        for (size_t l = 0; l < n_levels; l++) {
            size_t tested = 0, complete = 0, passed = 0;
            double share = 0.0;
            for (size_t c = 0; c < m; c++) {
                size_t mine = f < s->n_factors ? s->level[c / N_VARIANTS * s->n_factors + f] : c % N_VARIANTS;
                if (mine != l) continue;
                tested++;
                complete += a[c].complete;
                passed += a[c].complete && !a[c].excluded;
                if (a[c].complete) share += exp(a[c].log_likelihood - top) / total;
            }
            printf("%s\t%s\t%zu\t%zu\t%zu\t%.17g\n", f < s->n_factors ? s->factor[f].name : "surface",
                   f < s->n_factors ? s->factor[f].levels[l] : variants[l], tested, complete, passed, share);
        }
    }
}

/* ---- effects ---- */

static void print_effect(const char *claim, const char *factor, const char *level, const char *reference,
                         const stats_effect *e, size_t n, double residual)
{
    printf("%s\t%s\t%s\t%s\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\t%zu\t%.17g\n", claim, factor, level, reference,
           e->effect / deg, e->se / deg, e->lo / deg, e->hi / deg, e->p_value, n, residual / deg);
}

/* Main effects on claim k, the surface read as by default; y, level: work space. */
static rp_status factor_effects(const study *s, size_t k, double y[], size_t level[])
{
    size_t n = 0, n_levels[MAX_FACTORS];
    stats_effect effects[MAX_FACTORS * MAX_LEVELS];
    double residual;
    for (size_t c = 0; c < s->n_combinations; c++) {
        double value = s->y[c * N_VARIANTS * s->n_claims + k];
        if (!isfinite(value)) continue;
        memcpy(level + n * s->n_factors, s->level + c * s->n_factors, s->n_factors * sizeof *level);
        y[n++] = value;
    }
    for (size_t f = 0; f < s->n_factors; f++) n_levels[f] = s->factor[f].n_levels;
    rp_status status = stats_effects(n, s->n_factors, level, n_levels, y, effects, &residual);
    if (status == RP_NO_RESULT) { /* a number that too few combinations have: no row, and it is said */
        fprintf(stderr, "%s: %s\n", s->about[k].name, rp_message());
        return RP_OK;
    }
    if (status) return status;
    const stats_effect *e = effects;
    for (size_t f = 0; f < s->n_factors; f++)
        for (size_t l = 1; l < n_levels[f]; l++)
            print_effect(s->about[k].name, s->factor[f].name, s->factor[f].levels[l], s->factor[f].levels[0],
                         e++, n, residual);
    return RP_OK;
}

/* Change with the way to read the surface, pile by pile the same piles: over combinations. */
static rp_status surface_effects(const study *s, size_t k, double difference[])
{
    for (size_t v = 1; v < N_VARIANTS; v++) {
        size_t n = 0;
        for (size_t c = 0; c < s->n_combinations; c++) {
            double d = s->y[(c * N_VARIANTS + v) * s->n_claims + k] - s->y[c * N_VARIANTS * s->n_claims + k];
            if (isfinite(d)) difference[n++] = d;
        }
        stats_summary stats;
        rp_status status = stats_mean(n, difference, &stats);
        if (status == RP_NO_RESULT) return RP_OK;
        if (status) return status;
        stats_effect e = {stats.mean, stats.se, stats.lo, stats.hi, NAN};
        print_effect(s->about[k].name, "surface", variants[v], variants[0], &e, n, stats.sd);
    }
    return RP_OK;
}

static rp_status print_effects(const study *s)
{
    double *y = malloc((s->n_combinations + 1) * sizeof *y);
    size_t *level = malloc((s->n_combinations + 1) * s->n_factors * sizeof *level);
    rp_status status = y && level ? RP_OK : rp_fail(RP_NO_MEMORY, "forensics: out of memory");
    if (!status)
        rp_table_header(
            stdout,
            "claim, factor, level, reference, effect_deg [deg], effect_se_deg [deg], lower_deg [deg], "
            "upper_deg [deg], p_value, n, residual_sd_deg [deg]");
    for (size_t k = 0; k < s->n_claims && !status; k++) {
        status = factor_effects(s, k, y, level);
        if (!status) status = surface_effects(s, k, y);
    }
    free(y);
    free(level);
    return status;
}

/* ---- command ---- */

/* The same counts of the combinations that were simulated, whatever the reading of their surface. */
static void note_simulated(const study *s, const stats_agreement *a)
{
    size_t complete = 0, passed = 0;
    for (size_t c = 0; c < s->n_combinations; c++) {
        bool any_complete = false, any_passed = false;
        for (size_t v = 0; v < N_VARIANTS; v++) {
            const stats_agreement *one = &a[c * N_VARIANTS + v];
            any_complete |= one->complete;
            any_passed |= one->complete && !one->excluded;
        }
        complete += any_complete;
        passed += any_passed;
    }
    rp_table_note(stdout, "simulated_complete", "%zu", complete);
    rp_table_note(stdout, "simulated_not_excluded", "%zu", passed);
}

static rp_status print_report(const study *s, const forensics_options *o)
{
    const size_t m = s->n_combinations * N_VARIANTS;
    stats_chance chance = {NAN, NAN}, unused;
    stats_agreement *main = malloc((m + 1) * sizeof *main), *held = malloc((m + 1) * sizeof *held);
    rp_status status = main && held ? RP_OK : rp_fail(RP_NO_MEMORY, "forensics: out of memory");
    if (!status && o->report != REPORT_EFFECTS) {
        status = judge(s, false, o, main, &chance);
        if (!status) status = judge(s, true, o, held, &unused);
    }
    if (!status) {
        cli_table(stdout, options, o);
        rp_table_note(stdout, "combinations", "%zu, each with %d ways to read the surface", s->n_combinations,
                      (int)N_VARIANTS);
    }
    if (!status && o->report != REPORT_EFFECTS) {
        size_t complete = 0, passed = 0;
        for (size_t c = 0; c < m; c++) {
            complete += main[c].complete;
            passed += main[c].complete && !main[c].excluded;
        }
        rp_table_note(stdout, "complete", "%zu", complete);
        rp_table_note(stdout, "not_excluded", "%zu", passed);
        rp_table_note(stdout, "by_chance", "%.2g", chance.mean);
        rp_table_note(stdout, "chance_of_as_many", "%.2g", chance.as_many);
        note_simulated(s, main);
    }
    if (!status && o->report == REPORT_COMBINATIONS) status = print_combinations(s, main, held);
    if (!status && o->report == REPORT_LEVELS) print_levels(s, main);
    if (!status && o->report == REPORT_EFFECTS) status = print_effects(s);
    free(main);
    free(held);
    return status;
}

static rp_status judge_runs(rp_table *runs, const void *values)
{
    const forensics_options *o = values;
    study *s = calloc(1, sizeof *s);
    if (!s) return rp_fail(RP_NO_MEMORY, "forensics: out of memory");
    s->runs = runs;
    rp_status status = find_column(runs, "status", &s->status);
    if (!status) status = read_factors(s, o->factors);
    if (!status) status = read_combinations(s);
    if (!status) status = read_claims(s, o->claims);
    if (!status) status = read_numbers(s);
    if (!status) status = print_report(s, o);
    free(s->level);
    free(s->of_run);
    free(s->y);
    free(s->se);
    free(s);
    return status;
}

const cli_command cmd_forensics = {
    "forensics",
    "unspecified choices of a paper against its published numbers",
    "RUNS --factors LIST [options]",
    "Which combinations of unsaid choices agree with all published numbers at once? RUNS: one row a\n"
    "run, as repose sweep export writes; a grid point with fewer than half of its runs ok has no\n"
    "number, and a combination without one of the numbers is incomplete: not computable as it stands.\n"
    "Claims: the rows of the claims' file with a cell `forensics`, [held] [+|-] COLUMN key=value ...\n"
    "[less COLUMN key=value ...]: the published number +- its error of a mean at a grid point, or after\n"
    "+ or - the sign of a difference of two; keys that are not given are those of the header line `at`.\n"
    "Errors are taken up to a common scale, averaged over 1/5 to 2; signs have none. COLUMN is without\n"
    "_deg: every surface variant COLUMN_VARIANT_deg makes a combination of its own. Claims that are\n"
    "`held` do not judge: they test the combinations that are not excluded.\n"
    "combinations: likelihood, p-value, status and numbers; simulated: rank of a simulated combination,\n"
    "at its best surface, 0 at the others; effects: change of each number from a factor's first level\n"
    "(95 % interval; the residual holds interactions); levels: what is left of each level.",
    "repose forensics build/tables/lh_forensics_runs.tsv --factors slip,shape,floor",
    options,
    .on_table = judge_runs};
