/* repose forensics: which choices that a paper leaves open agree with the numbers that it gives?
 *
 * A sweep has run combinations of choices (factors), each at the grid points that the published claims speak
 * of. Every combination is judged by all claims at once; see angle.h. */
#include <gsl/gsl_statistics_double.h>
#include <stdlib.h>
#include <string.h>

#include "angle/angle.h"
#include "stats/stats.h"
#include "stats/forensics.h"
#include "cli/claims.h"
#include "cli/cli.h"

enum { MAX_FACTORS = 24, MAX_LEVELS = 12, MAX_CLAIMS = 24, MAX_TERMS = 64 };
enum { REPORT_COMBINATIONS, REPORT_EFFECTS, REPORT_LEVELS };

#define FORENSICS_OPTIONS(X)                                                                                 \
    X(TEXT, claims, "", "figures/claims.tsv", "", "published claims")                                        \
    X(TEXT, factors, "", NULL, "",                                                                           \
      "columns of the choices, joined by commas; a:b ranks the values of a within each value of b")          \
    X(CHOICE, report, "", "combinations", "combinations | effects | levels", "what to print")                \
    X(REAL, level, "", "0.05", "(0, 1)", "a true combination is excluded with this chance")                  \
    X(INT, draws, "", "1000", "[20, 1000000]", "simulated publications of each combination")                 \
    CLI_SEED(X, "1993", "seed of the draws")

CLI_OPTIONS(forensics, FORENSICS_OPTIONS)

/* How the surface of a pile is read; a column of the first has its stem alone. */
#define VARIANT(height, empty) #height "_" #empty, #height "_" #empty "_origin",
static const char *const variants[] = {ANG_SURFACES(VARIANT)};
enum { N_VARIANTS = sizeof variants / sizeof *variants };

typedef struct {
    size_t claim;
    double coefficient;
    bool *rows;             /* of the runs: is it measured there? */
    int column[N_VARIANTS]; /* of the runs */
} claim_term;

typedef struct {
    rp_table *runs;
    size_t n_factors, n_claims, n_terms;
    char factors[1024]; /* memory of the names */
    const char *name[MAX_FACTORS];
    cli_groups factor[MAX_FACTORS], combination; /* levels of each factor, combinations of all */
    size_t *first;                               /* first run of each combination */
    cli_words usual;                             /* key=value, where a term is measured if it does not say */
    struct {
        char name[40];
        bool held_out;
    } about[MAX_CLAIMS];
    stats_claim claims[MAX_CLAIMS];
    claim_term terms[MAX_TERMS];
    double *y, *se; /* [combination][variant][claim] */
} study;

/* Level of a factor in a combination; the first run's levels are the reference of each factor. */
static size_t level_of(const study *s, size_t combination, size_t factor)
{
    return s->factor[factor].of_row[s->first[combination]];
}

/* ---- reading ---- */

/* Rank of a run's value among the distinct values of its nest. */
static size_t rank_within(const rp_table *t, size_t row, int column, int within)
{
    size_t rank = 0, n_seen = 0;
    double value = strtod(cli_text(t, row, column), NULL), seen[MAX_LEVELS];
    for (size_t r = 0; r < t->n_rows && n_seen < MAX_LEVELS; r++) {
        if (strcmp(cli_text(t, r, within), cli_text(t, row, within)) != 0) continue;
        double other = strtod(cli_text(t, r, column), NULL);
        bool known = other >= value;
        for (size_t k = 0; k < n_seen && !known; k++) known = seen[k] == other;
        if (!known) seen[n_seen++] = other, rank++;
    }
    return rank;
}

/* Factor "a" or "a:b", whose cells become ranks; `raw` has the cells as they were. */
static rp_status read_factor(study *s, const rp_table *raw, char *name)
{
    static char *const ranks[] = {"1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13"};
    cli_groups *levels = &s->factor[s->n_factors];
    char *colon = strchr(name, ':');
    int column, within;
    if (s->n_factors == MAX_FACTORS) return rp_fail(RP_BAD_INPUT, "--factors: at most %d", MAX_FACTORS);
    if (colon) *colon++ = '\0';
    rp_status status = cli_find_column(raw, name, &column);
    if (!status && colon) status = cli_find_column(raw, colon, &within);
    for (size_t i = 0; i < raw->n_rows && !status && colon; i++)
        s->runs->cells[i * raw->n_columns + (size_t)column] = ranks[rank_within(raw, i, column, within)];
    if (!status) status = cli_group_rows(s->runs, name, ',', levels);
    s->name[s->n_factors++] = name;
    return status || levels->n_groups <= MAX_LEVELS
               ? status
               : rp_fail(RP_BAD_INPUT, "%s: column %s has more than %d different values: no factor",
                         raw->path, name, MAX_LEVELS);
}

static rp_status read_factors(study *s, const char *list)
{
    rp_table raw = *s->runs;
    const size_t n = raw.n_rows, cells = n * raw.n_columns;
    char names[sizeof s->factors] = "";
    if (strlen(list) >= sizeof s->factors) return rp_fail(RP_BAD_INPUT, "--factors: too long");
    strcpy(s->factors, list);
    raw.cells = cli_memory(cells, sizeof *raw.cells);
    s->first = cli_memory(n, sizeof *s->first);
    rp_status status = RP_OK;
    if (cells > 0) memcpy(raw.cells, s->runs->cells, cells * sizeof *raw.cells);
    for (char *save, *word = strtok_r(s->factors, ",", &save); word && !status;
         word = strtok_r(NULL, ",", &save)) {
        status = read_factor(s, &raw, word);
        strcat(strcat(names, *names ? "," : ""), word);
    }
    if (!status && s->n_factors == 0) status = rp_fail(RP_BAD_INPUT, "--factors: none given");
    if (!status) status = cli_group_rows(s->runs, names, ',', &s->combination);
    for (size_t i = n; i-- > 0 && !status;) s->first[s->combination.of_row[i]] = i;
    return status;
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
        status = cli_find_column(s->runs, name, &column[v]);
    }
    return status;
}

/* Where a term is measured: the usual values of the keys, but for the words first <= w < last. */
static rp_status find_rows(const study *s, const cli_words *words, int first, int last, bool rows[])
{
    cli_words at = s->usual;
    for (int w = first; w < last; w++) {
        const size_t length = strcspn(words->words[w], "=") + 1;
        int k = 0;
        while (k < at.n && strncmp(at.words[k], words->words[w], length) != 0) k++;
        if (k == at.n)
            return rp_fail(RP_BAD_INPUT, "\"%s\": not among the keys of the header line `at`",
                           words->words[w]);
        at.words[k] = words->words[w];
    }
    rp_status status = RP_OK;
    for (size_t row = 0; row < s->runs->n_rows && !status; row++)
        status = cli_row_matches(s->runs, row, &at, 0, at.n, &rows[row]);
    return status;
}

static rp_status add_terms(study *s, const cli_words *words, int first)
{
    double coefficient = 1.0;
    for (int last; first < words->n; first = last + 1, coefficient = -1.0) {
        if (s->n_terms == MAX_TERMS) return rp_fail(RP_BAD_INPUT, "at most %d terms", MAX_TERMS);
        claim_term *term = &s->terms[s->n_terms++];
        for (last = first + 1; last < words->n && strcmp(words->words[last], "less") != 0;) last++;
        *term = (claim_term){s->n_claims, coefficient, cli_memory(s->runs->n_rows, sizeof *term->rows), {0}};
        rp_status status = find_rows(s, words, first + 1, last, term->rows);
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
    const char *at = status ? NULL : rp_table_find_note(all.table, "at");
    if (!status)
        status = at ? cli_split(at, &s->usual) : rp_fail(RP_BAD_INPUT, "%s: no header line \"at\"", path);
    for (size_t i = 0; i < all.n && !status; i++)
        if (*all.claims[i].forensics && (status = read_claim(s, &all.claims[i])) != RP_OK)
            rp_prefix(status, "%s: claim %s: ", path, all.claims[i].id);
    if (!status && s->n_claims == 0) status = rp_fail(RP_NO_RESULT, "%s: no claims", path);
    return status;
}

/* ---- numbers of each combination ---- */

/* Means of one term and variant over the runs of each combination, with the standard deviation pooled over
 * the combinations: six piles alone say too little of theirs. Adds to y and to the squares in se. */
static rp_status add_term(study *s, const claim_term *term, int v)
{
    const cli_choice choice = {.among = term->rows, .groups = &s->combination};
    const size_t n_groups = s->combination.n_groups;
    size_t *n_runs = cli_memory(n_groups, sizeof *n_runs);
    double squares = 0.0, dof = 0.0;
    cli_rows rows;
    rp_status status = cli_rows_read(s->runs, s->runs->names[term->column[v]], &choice, &rows);
    if (status && status != RP_NO_RESULT) return status;
    for (size_t row = 0; row < s->runs->n_rows; row++) n_runs[s->combination.of_row[row]] += term->rows[row];
    for (size_t c = 0; c < rows.n_groups; c++) {
        const size_t n = rows.first[c + 1] - rows.first[c];
        if (n < 2) continue;
        squares += gsl_stats_tss(rows.column[0] + rows.first[c], 1, n);
        dof += (double)n - 1.0;
    }
    for (size_t c = 0; c < n_groups; c++) {
        const size_t at = (c * N_VARIANTS + (size_t)v) * s->n_claims + term->claim;
        const size_t n = rows.n ? rows.first[c + 1] - rows.first[c] : 0;
        const bool enough = n > 0 && 2 * n >= n_runs[c];
        const double factor = enough ? term->coefficient * deg : NAN;
        s->y[at] += enough ? factor * gsl_stats_mean(rows.column[0] + rows.first[c], 1, n) : NAN;
        s->se[at] += factor * factor * squares / dof / (double)n;
    }
    return RP_OK;
}

static rp_status read_numbers(study *s)
{
    const size_t n = s->combination.n_groups * N_VARIANTS * s->n_claims;
    s->y = cli_memory(n, sizeof *s->y);
    s->se = cli_memory(n, sizeof *s->se);
    rp_status status = RP_OK;
    for (size_t k = 0; k < s->n_terms; k++)
        for (int v = 0; v < N_VARIANTS && !status; v++) {
            const size_t mark = cli_mark();
            status = add_term(s, &s->terms[k], v);
            cli_release(mark);
        }
    for (size_t i = 0; i < n && !status; i++) s->se[i] = sqrt(s->se[i]);
    return status;
}

/* ---- judging ---- */

/* Judge all combinations and variants by the claims that are held out, or that are not. */
static rp_status judge(const study *s, bool held_out, const forensics_options *o, stats_agreement agreement[],
                       stats_chance *chance)
{
    const size_t m = s->combination.n_groups * N_VARIANTS;
    stats_claim claims[MAX_CLAIMS];
    size_t n = 0;
    double *y = cli_memory(m * s->n_claims, sizeof *y), *se = cli_memory(m * s->n_claims, sizeof *se);
    for (size_t k = 0; k < s->n_claims; k++)
        if (s->about[k].held_out == held_out) claims[n++] = s->claims[k];
    for (size_t c = 0; c < m; c++)
        for (size_t k = 0, i = 0; k < s->n_claims; k++) {
            if (s->about[k].held_out != held_out) continue;
            y[c * n + i] = s->y[c * s->n_claims + k];
            se[c * n + i++] = s->se[c * s->n_claims + k];
        }
    for (size_t c = 0; c < m; c++) agreement[c] = (stats_agreement){false, true, NAN, NAN, NAN};
    return n == 0
               ? RP_OK
               : stats_claims_judge(m, n, claims, y, se, o->level, (size_t)o->draws,
                                    held_out ? 0 : (size_t)o->draws, cli_random(held_out), agreement, chance);
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
    char text[8192];
    size_t used = (size_t)snprintf(text, sizeof text, "rank, combination, simulated, surface");
    for (size_t f = 0; f < s->n_factors; f++)
        used += (size_t)snprintf(text + used, sizeof text - used, ", %s", s->name[f]);
    used += (size_t)snprintf(text + used, sizeof text - used, ", log_likelihood, p_value, p_held_out");
    for (size_t k = 0; k < s->n_claims; k++)
        used += (size_t)snprintf(text + used, sizeof text - used, ", %s_deg [deg], %s_se_deg [deg]",
                                 s->about[k].name, s->about[k].name);
    snprintf(text + used, sizeof text - used, ", status");
    rp_table_header(stdout, text);
}

static void print_combinations(const study *s, const stats_agreement *main, const stats_agreement *held)
{
    const size_t m = s->combination.n_groups * N_VARIANTS;
    size_t *order = cli_memory(m, sizeof *order);
    double *key = cli_memory(m, sizeof *key);
    bool *seen = cli_memory(s->combination.n_groups, sizeof *seen);
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
            printf("\t%s", s->factor[f].words[level_of(s, combination, f)]);
        putchar('\t');
        rp_table_numbers(stdout, 3, (double[]){main[c].log_likelihood, main[c].p_value, held[c].p_value});
        for (size_t k = 0; k < s->n_claims; k++) {
            putchar('\t');
            rp_table_numbers(stdout, 2,
                             (double[]){s->y[c * s->n_claims + k] / deg, s->se[c * s->n_claims + k] / deg});
        }
        printf("\t%s\n", verdict(&main[c]));
    }
}

/* Each level of each factor, and each way to read the surface: how much of it is left. */
static void print_levels(const study *s, const stats_agreement *a)
{
    const size_t m = s->combination.n_groups * N_VARIANTS;
    double top = -INFINITY, total = 0.0;
    for (size_t c = 0; c < m; c++)
        if (a[c].complete) top = fmax(top, a[c].log_likelihood);
    for (size_t c = 0; c < m; c++)
        if (a[c].complete) total += exp(a[c].log_likelihood - top);
    rp_table_header(stdout, "factor, level, tested, complete, not_excluded, share");
    for (size_t f = 0; f <= s->n_factors; f++) {
        size_t n_levels = f < s->n_factors ? s->factor[f].n_groups : (size_t)N_VARIANTS;
        for (size_t l = 0; l < n_levels; l++) {
            size_t tested = 0, complete = 0, passed = 0;
            double share = 0.0;
            for (size_t c = 0; c < m; c++) {
                size_t mine = f < s->n_factors ? level_of(s, c / N_VARIANTS, f) : c % N_VARIANTS;
                if (mine != l) continue;
                tested++;
                complete += a[c].complete;
                passed += a[c].complete && !a[c].excluded;
                if (a[c].complete) share += exp(a[c].log_likelihood - top) / total;
            }
            printf("%s\t%s\t%zu\t%zu\t%zu\t", f < s->n_factors ? s->name[f] : "surface",
                   f < s->n_factors ? s->factor[f].words[l] : variants[l], tested, complete, passed);
            rp_table_row(stdout, 1, &share);
        }
    }
}

/* ---- effects ---- */

static void print_effect(const char *claim, const char *factor, const char *level, const char *reference,
                         const stats_effect *e, size_t n, double residual)
{
    const double numbers[] = {e->effect / deg, e->se / deg, e->lo / deg,   e->hi / deg,
                              e->p_value,      (double)n,   residual / deg};
    printf("%s\t%s\t%s\t%s\t", claim, factor, level, reference);
    rp_table_row(stdout, N_OF(numbers), numbers);
}

/* Main effects on claim k, the surface read as by default; y, level: work space. */
static rp_status factor_effects(const study *s, size_t k, double y[], size_t level[])
{
    size_t n = 0, n_levels[MAX_FACTORS];
    stats_effect effects[MAX_FACTORS * MAX_LEVELS];
    double residual;
    for (size_t c = 0; c < s->combination.n_groups; c++) {
        double value = s->y[c * N_VARIANTS * s->n_claims + k];
        if (!isfinite(value)) continue;
        for (size_t f = 0; f < s->n_factors; f++) level[n * s->n_factors + f] = level_of(s, c, f);
        y[n++] = value;
    }
    for (size_t f = 0; f < s->n_factors; f++) n_levels[f] = s->factor[f].n_groups;
    rp_status status = stats_effects(n, s->n_factors, level, n_levels, y, effects, &residual);
    if (status == RP_NO_RESULT) { /* a number that too few combinations have: no row, and it is said */
        fprintf(stderr, "%s: %s\n", s->about[k].name, rp_message());
        return RP_OK;
    }
    if (status) return status;
    const stats_effect *e = effects;
    for (size_t f = 0; f < s->n_factors; f++)
        for (size_t l = 1; l < n_levels[f]; l++)
            print_effect(s->about[k].name, s->name[f], s->factor[f].words[l], s->factor[f].words[0], e++, n,
                         residual);
    return RP_OK;
}

/* Change with the way to read the surface, pile by pile the same piles: over combinations. */
static rp_status surface_effects(const study *s, size_t k, double difference[])
{
    for (size_t v = 1; v < N_VARIANTS; v++) {
        size_t n = 0;
        for (size_t c = 0; c < s->combination.n_groups; c++) {
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
    double *y = cli_memory(s->combination.n_groups, sizeof *y);
    size_t *level = cli_memory(s->combination.n_groups * s->n_factors, sizeof *level);
    rp_status status = RP_OK;
    rp_table_header(stdout, "claim, factor, level, reference, effect_deg [deg], effect_se_deg [deg], "
                            "lower_deg [deg], upper_deg [deg], p_value, n, residual_sd_deg [deg]");
    for (size_t k = 0; k < s->n_claims && !status; k++) {
        status = factor_effects(s, k, y, level);
        if (!status) status = surface_effects(s, k, y);
    }
    return status;
}

/* ---- command ---- */

/* Notes of how many combinations are complete and how many of these are not excluded, by sets of `variants`
 * judgements of one simulated combination: it counts if one of them does. */
static void note_counts(const char *prefix, size_t n, size_t n_variants, const stats_agreement *a)
{
    char key[40];
    size_t complete = 0, passed = 0;
    for (size_t c = 0; c < n; c += n_variants) {
        bool any_complete = false, any_passed = false;
        for (size_t v = c; v < c + n_variants; v++) {
            any_complete |= a[v].complete;
            any_passed |= a[v].complete && !a[v].excluded;
        }
        complete += any_complete;
        passed += any_passed;
    }
    snprintf(key, sizeof key, "%scomplete", prefix);
    rp_table_note(stdout, key, "%zu", complete);
    snprintf(key, sizeof key, "%snot_excluded", prefix);
    rp_table_note(stdout, key, "%zu", passed);
}

static rp_status print_report(const study *s, const forensics_options *o)
{
    const size_t m = s->combination.n_groups * N_VARIANTS;
    stats_chance chance = {NAN, NAN}, unused;
    stats_agreement *main = cli_memory(m, sizeof *main), *held = cli_memory(m, sizeof *held);
    rp_status status = RP_OK;
    if (o->report != REPORT_EFFECTS) {
        status = judge(s, false, o, main, &chance);
        if (!status) status = judge(s, true, o, held, &unused);
        if (status) return status;
    }
    cli_table(stdout);
    rp_table_note(stdout, "combinations", "%zu, each with %d ways to read the surface",
                  s->combination.n_groups, (int)N_VARIANTS);
    if (o->report == REPORT_EFFECTS) return print_effects(s);
    note_counts("", m, 1, main);
    rp_table_note(stdout, "by_chance", "%.2g", chance.mean);
    rp_table_note(stdout, "chance_of_as_many", "%.2g", chance.as_many);
    note_counts("simulated_", m, N_VARIANTS, main);
    if (o->report == REPORT_COMBINATIONS)
        print_combinations(s, main, held);
    else
        print_levels(s, main);
    return RP_OK;
}

static rp_status judge_runs(rp_table *runs, void *values)
{
    const forensics_options *o = values;
    study *s = cli_memory(1, sizeof *s);
    s->runs = runs;
    rp_status status = read_factors(s, o->factors);
    if (!status) status = read_claims(s, o->claims);
    if (!status) status = read_numbers(s);
    return status ? status : print_report(s, o);
}

const cli_command cmd_forensics = {
    "forensics",
    "unspecified choices of a paper against its published numbers",
    "RUNS --factors LIST [options]",
    "Tests each combination of the choices that a paper leaves open against all of its published\n"
    "numbers at once.\n"
    "\n"
    "RUNS has one row per run, as repose sweep export writes it. A grid point with fewer than half of\n"
    "its runs ok has no number. A combination that lacks a number is incomplete and is not tested.\n"
    "\n"
    "The claims are the rows of the claims' file with a cell `forensics`:\n"
    "  [held] [+|-] COLUMN key=value ... [less COLUMN key=value ...]\n"
    "Without a sign, the claim is the published mean at a grid point with its error. After + or -, it is\n"
    "the sign of a difference of two means. Keys that a claim does not name have the values of the\n"
    "header line `at`. A common scale of the errors is averaged over 1/5 to 2. COLUMN is written without\n"
    "_deg; every surface variant COLUMN_VARIANT_deg makes a combination of its own. Claims marked\n"
    "`held` do not exclude a combination; they test the combinations that are left.\n"
    "\n"
    "--report combinations prints likelihood, p-value, status and numbers of each combination, and the\n"
    "rank of simulated ones (0 for surfaces that are not the best). effects prints the change of each\n"
    "number from the first level of a factor, with its 95 % interval; the residual holds the\n"
    "interactions. levels prints the combinations that are left for each level.",
    "repose forensics build/tables/lh_forensics_runs.tsv --factors slip,shape,floor",
    forensics_params,
    .on_table = judge_runs};
