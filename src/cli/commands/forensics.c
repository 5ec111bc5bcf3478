/* repose forensics: which choices that a paper leaves open agree with the numbers that it gives?
 *
 * A sweep has run settings of the choices at the points of the published numbers. An emulator of these runs
 * predicts the numbers of any choices; the published numbers weight draws of the choices from their prior. */
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <string.h>

#include "cli/cli.h"
#include "cli/forensics.h"

enum { REPORT_CHOICES, REPORT_NUMBERS, REPORT_DENSITY, REPORT_EMULATOR, N_BINS = 20 };

#define FORENSICS_OPTIONS(X)                                                                                 \
    X(TEXT, claims, "", "report/claims.tsv", "", "published claims")                                         \
    X(INT, design, "", "auto", "[2, 100000] | auto", "print the grid of a sweep of so many settings")        \
    X(CHOICE, report, "", "choices", "choices | numbers | density | emulator", "what to print")              \
    X(REAL, shift_deg, "degree", "2", "(0, 45]",                                                             \
      "standard deviation of an error that all numbers may share")                                           \
    X(INT, draws, "", "4000", "[100, 1000000]", "draws of the choices from their prior")                     \
    CLI_SEED(X, "1993", "seed of the design and of the draws")

CLI_OPTIONS(forensics, FORENSICS_OPTIONS)

typedef struct {
    const forensics_options *o;
    forensics_claims claims;
    forensics_study study;
    forensics_emulator angles, completion;
    forensics_draws draws;
    stats_published used[FORENSICS_CLAIMS]; /* the numbers of the inference */
    stats_predictions model;                /* of these */
    stats_posterior posterior, exact;       /* exact: if the emulator had no error */
    bool stops;                             /* some runs have no result */
    double *weight;
    size_t *order;
} inference;

/* ---- posterior ---- */

/* The predictions of the numbers that are used, in the order of the claims, for the surfaces of the first
 * stem. */
static rp_status find_posterior(inference *s)
{
    size_t n = 0;
    const size_t k = s->claims.n_points, m = s->draws.n;
    for (size_t i = 0; i < s->claims.n; i++) n += !s->claims.claims[i].held;
    double *mean = cli_memory(m * FORENSICS_SURFACES * n, sizeof *mean),
           *covariance = cli_memory(m * n * n, sizeof *covariance);
    const forensics_claim *c = s->claims.claims; /* those held out come last */
    for (size_t i = 0; i < n; i++) s->used[i] = c[i].published;
    for (size_t d = 0; d < m; d++) {
        for (size_t f = 0; f < FORENSICS_SURFACES; f++)
            for (size_t i = 0; i < n; i++)
                mean[(d * FORENSICS_SURFACES + f) * n + i] =
                    s->draws.mean[(d * s->draws.n_sets + f) * k + c[i].point];
        for (size_t i = 0; i < n * n; i++)
            covariance[d * n * n + i] = s->draws.covariance[(d * k + c[i / n].point) * k + c[i % n].point];
    }
    s->model = (stats_predictions){m,
                                   FORENSICS_SURFACES,
                                   n,
                                   mean,
                                   covariance,
                                   s->angles.scale,
                                   s->draws.log_complete,
                                   s->o->shift_deg * deg};
    RP_TRY(stats_posterior_make(&s->model, s->used, &s->posterior));
    static const double none[FORENSICS_SURFACES];
    stats_predictions exact = s->model;
    exact.scale = none;
    return stats_posterior_make(&exact, s->used, &s->exact);
}

static rp_status infer(inference *s)
{
    RP_TRY(forensics_emulate(&s->study, &s->angles));
    for (size_t c = 0; c < s->study.n_cells; c++) s->stops |= s->study.ok[c] < s->study.runs_of[c];
    if (s->stops) RP_TRY(forensics_emulate_completion(&s->study, &s->completion));
    RP_TRY(forensics_draw(&s->study, &s->angles, s->stops ? &s->completion : NULL, (size_t)s->o->draws,
                          cli_random(0), &s->draws));
    RP_TRY(find_posterior(s));
    s->weight = cli_memory((size_t)s->o->draws, sizeof *s->weight);
    s->order = cli_memory((size_t)s->o->draws, sizeof *s->order);
    return RP_OK;
}

/* ---- choices ---- */

/* The label of rows for which the emulator's error counts as none. */
static const char given_exact[] = "emulator=exact";

static void print_share(const char *choice, const char *level, const char *given, double prior, double share)
{
    printf("%s\t%s\t%s\t", choice, level, given);
    CLI_ROW(prior, share, stats_bayes_factor(prior, share), NAN, NAN, NAN, NAN);
}

/* Median and 95 % interval of a number over the weights; `prior_width`: of the interval before, NaN for none.
 */
static void print_interval(const inference *s, const char *choice, const char *given, const double value[],
                           size_t group)
{
    const size_t n = s->draws.n;
    double q[3];
    static const double at[3] = {0.5, 0.025, 0.975};
    for (int k = 0; k < 3; k++) q[k] = stats_weighted_quantile(n, value, s->weight, at[k], s->order);
    double width = NAN;
    if (group < SWEEP_N_GROUPS)
        width = (forensics_scaled(group, q[2]) - forensics_scaled(group, q[1])) / 0.95 /
                (forensics_scaled(group, sweep_groups[group].hi) -
                 forensics_scaled(group, sweep_groups[group].lo));
    printf("%s\t-\t%s\t", choice, given);
    CLI_ROW(NAN, NAN, NAN, q[0], q[1], q[2], width);
}

/* A number, over all, for each level of a common error and of runs that stop, with an exact emulator, and
 * before the inference. */
static void print_number(const inference *s, const char *choice, const double value[], size_t group)
{
    static const struct {
        const char *words;
        int latent;
        unsigned level;
    } given[] = {{"all", -1, 0},
                 {"shift=none", STATS_LATENT_shift, 0},
                 {"shift=common", STATS_LATENT_shift, 1},
                 {"stop=ours", STATS_LATENT_stop, 0},
                 {"stop=theirs", STATS_LATENT_stop, 1}};
    for (size_t k = 0; k < N_OF(given); k++) {
        stats_posterior_draws(&s->posterior, given[k].latent, given[k].level, s->weight);
        print_interval(s, choice, given[k].words, value, group);
    }
    stats_posterior_draws(&s->exact, -1, 0, s->weight);
    print_interval(s, choice, given_exact, value, group);
    for (size_t d = 0; d < s->draws.n; d++) s->weight[d] = 1.0;
    print_interval(s, choice, "prior", value, group);
}

static void print_factor(const inference *s, size_t f, const stats_posterior *p, const char *given)
{
    const forensics_factor *factor = &s->study.factors[f];
    const size_t n = s->draws.n;
    stats_posterior_draws(p, -1, 0, s->weight);
    for (size_t l = 0; l < factor->levels.n_groups; l++) {
        double prior = 0.0, share = 0.0;
        for (size_t d = 0; d < n; d++) {
            if (s->draws.level[f * n + d] != l) continue;
            prior++;
            share += s->weight[d];
        }
        print_share(factor->name, factor->levels.words[l], given, prior / (double)n, share);
    }
}

static rp_status print_choices(const inference *s)
{
    double *value = cli_memory(s->draws.n, sizeof *value);
    char word[32];
    rp_table_header(stdout, "choice, level, given, prior, share, bayes_factor, median, lower, upper, width");
    for (size_t g = 0; g < SWEEP_N_GROUPS; g++) {
        if (!s->study.is_choice[g]) continue;
        for (size_t d = 0; d < s->draws.n; d++) value[d] = s->draws.value[d * SWEEP_N_GROUPS + g];
        print_number(s, sweep_groups[g].name, value, g);
    }
    print_number(s, "grain_mass", s->draws.mass, SWEEP_N_GROUPS);
    print_number(s, "gravity", s->draws.gravity, SWEEP_N_GROUPS);
    for (size_t f = 0; f < s->study.n_factors; f++) {
        print_factor(s, f, &s->posterior, "-");
        print_factor(s, f, &s->exact, given_exact);
    }
    for (size_t f = 0; f < FORENSICS_SURFACES; f++)
        print_share("surface", forensics_surfaces[f], "-", 1.0 / FORENSICS_SURFACES,
                    stats_posterior_surface(&s->posterior, f));
#define X(name, levels, meaning)                                                                             \
    for (unsigned l = 0; l < 2; l++)                                                                         \
        print_share(#name, rp_word_at(levels, (int)l, word, sizeof word), "-", 0.5,                          \
                    stats_posterior_draws(&s->posterior, STATS_LATENT_##name, l, s->weight));
    STATS_LATENT_LIST(X)
#undef X
    return RP_OK;
}

/* ---- density ---- */

/* Posterior over prior in equal bins of each choice's scale. */
static rp_status print_density(const inference *s)
{
    rp_table_header(stdout, "choice, value, all, none, common");
    for (size_t g = 0; g < SWEEP_N_GROUPS; g++) {
        double ratio[N_BINS][3] = {{0.0}};
        const double lo = forensics_scaled(g, sweep_groups[g].lo),
                     hi = forensics_scaled(g, sweep_groups[g].hi);
        for (int k = 0; k < 3 && s->study.is_choice[g]; k++) {
            const double total =
                stats_posterior_draws(&s->posterior, k ? STATS_LATENT_shift : -1, k == 2, s->weight);
            for (size_t d = 0; d < s->draws.n; d++) {
                const double at = forensics_scaled(g, s->draws.value[d * SWEEP_N_GROUPS + g]);
                const int bin = (int)((at - lo) / (hi - lo) * N_BINS);
                ratio[bin < N_BINS ? bin : N_BINS - 1][k] += N_BINS * s->weight[d] / total;
            }
        }
        for (int bin = 0; bin < N_BINS && s->study.is_choice[g]; bin++) {
            printf("%s\t", sweep_groups[g].name);
            CLI_ROW(forensics_unscaled(g, lo + (hi - lo) * (bin + 0.5) / N_BINS), ratio[bin][0],
                    ratio[bin][1], ratio[bin][2]);
        }
    }
    return RP_OK;
}

/* ---- published numbers ---- */

/* Prediction of a claim by weights of draw, surface and latent: mean and variance of the model's own number,
 * and the chance that a publication of it lies as far from the mean of the model as the published one. A
 * number that is held out has the common error of the others, where there is one, and a +- of its own
 * reading. */
typedef struct {
    double mean, variance, p_value;
} prediction;

/* Chance of the claim for one draw, surface and latent. A number that is held out takes the common error from
 * the others, which moves *mean and *variance, and both readings of its own +- alike. p_value may be NULL. */
static rp_status claim_chance(const inference *s, const forensics_claim *c, size_t draw, size_t surface,
                              unsigned latent, double *mean, double *variance, double *p_value)
{
    const stats_predictions *m = &s->model;
    const size_t n = m->n_points;
    double error = 0.0, of_error = 0.0;
    if (c->held)
        RP_TRY(stats_common_error(n, s->used, m->mean + (draw * m->n_surfaces + surface) * n,
                                  m->covariance + draw * n * n, m->scale[surface], m->shift, latent, &error,
                                  &of_error));
    const double common = c->held ? 0.0 : stats_common_variance(m->shift, latent);
    *mean += error;
    *variance += of_error;
    if (!p_value) return RP_OK;
    *p_value = 0.0;
    for (unsigned reading = 0; reading < 2; reading++) {
        const double weight = c->held ? 0.5 : (latent >> STATS_LATENT_reading & 1u) == reading,
                     total = *variance + common + stats_published_variance(&c->published, reading);
        *p_value += weight * gsl_cdf_chisq_Q(pow(c->published.value - *mean, 2.0) / total, 1.0);
    }
    return RP_OK;
}

/* Without its chance, which takes most of the time, unless that is asked for. */
static rp_status predict_claim(const inference *s, const forensics_claim *c, bool chance, prediction *r)
{
    const size_t k = s->claims.n_points;
    double squares = 0.0;
    const double *share = s->posterior.share;
    *r = (prediction){0.0, 0.0, 0.0};
    for (size_t d = 0; d < s->draws.n; d++)
        for (size_t f = 0; f < FORENSICS_SURFACES; f++) {
            const size_t set = c->stem * FORENSICS_SURFACES + f;
            const double mean = s->draws.mean[(d * s->draws.n_sets + set) * k + c->point],
                         own = s->angles.scale[set] * s->draws.covariance[(d * k + c->point) * k + c->point];
            for (unsigned latent = 0; latent < STATS_LATENT_LEVELS; latent++) {
                const double w = *share++;
                double at = mean, variance = own, p_value = 0.0;
                if (w < 1e-12) continue; /* of no weight */
                RP_TRY(claim_chance(s, c, d, f, latent, &at, &variance, chance ? &p_value : NULL));
                r->mean += w * at;
                squares += w * (at * at + variance);
                r->p_value += w * p_value;
            }
        }
    r->variance = squares - r->mean * r->mean;
    return RP_OK;
}

/* The same before the published numbers are known: every draw and surface has the same weight. */
static rp_status predict_before(const inference *s, const forensics_claim *c, prediction *r)
{
    inference flat = *s;
    forensics_claim plain = *c;
    const size_t n = s->draws.n * FORENSICS_SURFACES * STATS_LATENT_LEVELS;
    plain.held = false; /* no common error is known yet */
    flat.posterior.share = cli_memory(n, sizeof *flat.posterior.share);
    for (size_t i = 0; i < n; i++) flat.posterior.share[i] = 1.0 / (double)n;
    return predict_claim(&flat, &plain, false, r);
}

static rp_status print_numbers(const inference *s)
{
    rp_table_header(stdout,
                    "claim, role, column, published_deg [deg], published_se_deg [deg], samples, "
                    "predicted_deg [deg], predicted_sd_deg [deg], prior_deg [deg], prior_sd_deg [deg], "
                    "p_value");
    for (size_t i = 0; i < s->claims.n; i++) {
        const forensics_claim *c = &s->claims.claims[i];
        const size_t mark = cli_mark();
        prediction after, before;
        RP_TRY(predict_claim(s, c, true, &after));
        RP_TRY(predict_before(s, c, &before));
        cli_release(mark);
        printf("%s\t%s\t%s\t", c->name, c->held ? "held_out" : "used", s->claims.stems[c->stem]);
        CLI_ROW(c->published.value / deg, c->published.error / deg, c->published.samples, after.mean / deg,
                sqrt(after.variance) / deg, before.mean / deg, sqrt(before.variance) / deg, after.p_value);
    }
    return RP_OK;
}

/* ---- emulator ---- */

static void print_left_out(const char *quantity, const char *left_out, const forensics_emulator *m, int k,
                           const forensics_left_out *cells, double unit)
{
    if (cells->n == 0) return;
    printf("%s\t%s\t%s\t%s\t", quantity, left_out, stats_kernel_words[k], (int)m->kernel == k ? "yes" : "no");
    CLI_ROW((double)cells->n, cells->spread / unit, cells->noise / unit, cells->rms / unit,
            cells->stated / unit, m->of[k].score, cells->covered);
}

static void print_kernels(const char *quantity, const forensics_emulator *m, double unit)
{
    for (int k = 0; k < STATS_KERNELS; k++) {
        print_left_out(quantity, "setting", m, k, &m->of[k].setting, unit);
        print_left_out(quantity, "sweep", m, k, &m->of[k].sweep, unit);
    }
}

static rp_status print_emulator(const inference *s)
{
    rp_table_header(
        stdout,
        "quantity, left_out, kernel, used, cells, spread, noise, rms_left_out, stated, score, covered");
    print_kernels(s->claims.stems[0], &s->angles, deg);
    if (s->stops) print_kernels("completion", &s->completion, 1.0);
    return RP_OK;
}

/* ---- command ---- */

/* Root mean square of the emulator's own error in the numbers that are used, over the posterior. */
static double model_error(const inference *s)
{
    const stats_predictions *m = &s->model;
    double sum = 0.0;
    stats_posterior_draws(&s->posterior, -1, 0, s->weight);
    for (size_t d = 0; d < m->n_draws; d++)
        for (size_t i = 0; i < m->n_points; i++)
            sum += s->weight[d] * m->covariance[(d * m->n_points + i) * m->n_points + i];
    return sqrt(sum / (double)m->n_points);
}

static void note_inference(const inference *s)
{
    size_t without = 0;
    for (size_t c = 0; c < s->study.n_cells; c++) without += !isfinite(s->study.mean[c]);
    cli_table(stdout);
    rp_table_note(stdout, "settings",
                  "%zu, at %zu points; %zu of %zu have fewer than two piles with a result",
                  s->study.settings.n_groups, s->claims.n_points, without, s->study.n_cells);
    rp_table_note(stdout, "emulator", "%s; leaving out a setting: %.2g degrees rms, noise of the piles %.2g",
                  stats_kernel_words[s->angles.kernel], s->angles.of[s->angles.kernel].setting.rms / deg,
                  s->angles.noise / deg);
    rp_table_note(stdout, "model_error", "%.2g degrees", model_error(s) / deg);
    rp_table_note(stdout, "effective_draws", "%.0f", s->posterior.effective);
    rp_table_note(stdout, "log_evidence", "%.6g", s->posterior.log_evidence);
    rp_table_note(stdout, "p_value", "%.3g", s->posterior.p_value);
}

/* Settings of a further design: draws of the posterior. */
static rp_status print_posterior_design(const inference *s)
{
    forensics_settings d = {.n = (size_t)s->o->design, .study = &s->study};
    size_t *index = cli_memory(d.n, sizeof *index);
    d.group = cli_memory(d.n * SWEEP_N_GROUPS, sizeof *d.group);
    d.params = cli_memory(d.n, sizeof *d.params);
    stats_posterior_draws(&s->posterior, -1, 0, s->weight);
    RP_TRY(stats_sample(s->draws.n, s->weight, d.n, index, cli_random(1)));
    for (size_t i = 0; i < d.n; i++) {
        memcpy(d.group + i * SWEEP_N_GROUPS, s->draws.value + index[i] * SWEEP_N_GROUPS,
               SWEEP_N_GROUPS * sizeof *d.group);
        d.params[i] = repose_params_new();
        RP_TRY(forensics_draw_params(&s->study, &s->draws, index[i], d.params[i]));
    }
    return forensics_design_print(&s->claims, &d);
}

static rp_status print_report(const inference *s)
{
    static rp_status (*const reports[])(const inference *) = {print_choices, print_numbers, print_density,
                                                              print_emulator};
    note_inference(s);
    return reports[s->o->report](s);
}

static rp_status report(inference *s)
{
    rp_table *runs;
    size_t n_first;
    rp_status status = cli_tables_read(&runs, &n_first);
    if (!status) status = forensics_study_read(runs, n_first, &s->claims, &s->study);
    if (!status) status = infer(s);
    if (!status) status = s->o->design > 0 ? print_posterior_design(s) : print_report(s);
    stats_emulator_free(&s->angles.e);
    stats_emulator_free(&s->completion.e);
    stats_posterior_free(&s->posterior);
    stats_posterior_free(&s->exact);
    return status;
}

static rp_status forensics(void *values)
{
    inference *s = cli_memory(1, sizeof *s);
    s->o = values;
    RP_TRY(forensics_claims_read(s->o->claims, &s->claims));
    if (cli_argument(0)) return report(s);
    if (s->o->design < 0)
        return rp_fail(RP_USAGE, "RUNS or --design N expected; see repose forensics --help");
    forensics_settings d;
    RP_TRY(forensics_design(&s->claims, (size_t)s->o->design, cli_random(0), &d));
    return forensics_design_print(&s->claims, &d);
}

const cli_command cmd_forensics = {
    "forensics",
    "unspecified choices of a paper, inferred from its published numbers",
    "[RUNS...] [options]",
    "Infers the choices that a paper leaves open from the numbers that it gives, with their errors.\n"
    "\n"
    "The numbers are the rows of the claims' file with a cell `forensics`:\n"
    "  [held] COLUMN key=value ...\n"
    "COLUMN is a result of the protocol repose without _deg. Keys that a claim does not name have the\n"
    "values of the header line `at`. Numbers marked `held` are predicted only.\n"
    "\n"
    "--design N prints the grid of a sweep: N settings of the choices by a scrambled Sobol sequence, with\n"
    "balanced factors, each at the points of the numbers. Choices with a scale are dimensionless groups:\n"
    "stiffness k_n d^1.5/(m g), damping rate gamma_n sqrt(d/g), frictions of walls and floor over that of\n"
    "the grains, time from the opening to the measurement, and speed of the opening. With RUNS the settings\n"
    "are draws of their posterior, for a second sweep where the published numbers are.\n"
    "\n"
    "RUNS has one row per run of such a sweep, as repose sweep export writes it, or the means of its "
    "--reduce; several tables are read as one.\n"
    "An emulator learns the angle from the runs: a Gaussian process or a quadratic regression, whichever "
    "predicts better the\n"
    "settings that it has not seen. Draws of the choices from their prior are weighted by the likelihood\n"
    "of the numbers. The surface, the meaning of the published errors (reading), an error that all\n"
    "numbers share (shift), and runs that stop (stop) are left open as well.\n"
    "\n"
    "--report choices prints shares and Bayes factors of levels, and medians with 95 % intervals; width is\n"
    "that of the interval over the prior's; `given` names what is taken for\n"
    "granted: a level, or the means of the emulator as exact. A number that "
    "is\n"
    "held out takes the shared error from the others, and both readings of its own error alike. numbers "
    "prints published and predicted numbers; density the\n"
    "posterior over the prior; emulator the errors of prediction of both kernels, for each setting of\n"
    "the first RUNS from all others, and for all settings of the other RUNS from the first.",
    "repose forensics --design 200 --seed 1993",
    forensics_params,
    .act = forensics};
