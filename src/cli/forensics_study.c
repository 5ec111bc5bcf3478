/* Runs of a design as settings of the open choices, each at the points of the published numbers; see
 * forensics.h. */
#include <math.h>
#include <string.h>

#include "angle/angle.h"
#include "cli/cli.h"
#include "cli/forensics.h"

enum { MOST_LEVELS = 12, LEAST_CELLS = 8 };

#define SURFACE(height, empty) #height "_" #empty, #height "_" #empty "_origin",
const char *const forensics_surfaces[FORENSICS_SURFACES] = {ANG_SURFACES(SURFACE)};

double forensics_scaled(size_t group, double value)
{
    return sweep_groups[group].logarithmic ? log(value) : value;
}

double forensics_unscaled(size_t group, double scaled)
{
    return sweep_groups[group].logarithmic ? exp(scaled) : scaled;
}

/* ---- settings and factors ---- */

static bool in_list(const char *list, const char *name)
{
    const size_t n = strlen(name);
    for (; *list; list += strcspn(list, ","), list += *list == ',')
        if (strncmp(list, name, n) == 0 && (list[n] == ',' || !list[n])) return true;
    return false;
}

static bool is_point_key(const forensics_claims *claims, const char *name)
{
    const size_t n = strlen(name);
    for (int k = 0; k < claims->usual.n; k++)
        if (strncmp(claims->usual.words[k], name, n) == 0 && claims->usual.words[k][n] == '=') return true;
    return false;
}

static rp_status add_factor(forensics_study *s, const char *name)
{
    forensics_factor *f = &s->factors[s->n_factors];
    if (s->n_factors == FORENSICS_FACTORS)
        return rp_fail(RP_BAD_INPUT, "at most %d factors", FORENSICS_FACTORS);
    rp_status status = cli_group_rows(s->runs, name, ',', &f->levels);
    if (status || f->levels.n_groups < 2) return status;
    if (f->levels.n_groups > MOST_LEVELS)
        return rp_fail(RP_BAD_INPUT, "%s: column %s has more than %d different values: no factor",
                       s->runs->path, name, MOST_LEVELS);
    f->name = name;
    s->n_factors++;
    return RP_OK;
}

/* Columns of parameters other than those of a point make the settings. */
static rp_status find_settings(forensics_study *s)
{
    char names[1024] = "";
    for (size_t c = 0; c < s->runs->n_columns; c++) {
        const char *name = s->runs->names[c];
        if (!rp_params_find(sweep_protocol_repose.schema, name) || is_point_key(s->claims, name)) continue;
        if (strlen(names) + strlen(name) + 2 > sizeof names) return rp_fail(RP_BAD_INPUT, "too many columns");
        strcat(strcat(names, *names ? "," : ""), name);
        if (!in_list(SWEEP_GROUP_KEYS, name)) RP_TRY(add_factor(s, name));
    }
    if (!*names) return rp_fail(RP_BAD_INPUT, "%s: no column of a choice", s->runs->path);
    RP_TRY(cli_group_rows(s->runs, names, ',', &s->settings));
    s->first = cli_memory(s->settings.n_groups, sizeof *s->first);
    for (size_t i = s->runs->n_rows; i-- > 0;) s->first[s->settings.of_row[i]] = i;
    return RP_OK;
}

/* ---- groups ---- */

/* Parameters of a run: its cells, else what the header says of all runs, else the defaults. */
static rp_status read_params(const forensics_study *s, size_t row, void *params)
{
    for (const rp_param *p = sweep_protocol_repose.schema; p->name; p++) {
        char value[64];
        const int column = rp_table_column(s->runs, p->name);
        const char *text =
            column >= 0 ? cli_text(s->runs, row, column) : rp_table_find_note(s->runs, p->name);
        if (!text) continue;
        snprintf(value, sizeof value, "%.*s", (int)strcspn(text, " "), text);
        RP_TRY(rp_prefix(repose_params_set(params, p->name, value), "%s: ", s->runs->path));
    }
    return RP_OK;
}

rp_status forensics_study_params(const forensics_study *s, size_t setting, void *params)
{
    rp_params_defaults(sweep_protocol_repose.schema, params);
    rp_status status = read_params(s, s->first[setting], params);
    return status ? status : repose_params_at(params, &s->claims->usual);
}

static rp_status find_groups(forensics_study *s)
{
    void *own = repose_params_new(), *at = repose_params_new();
    for (size_t i = 0, c = 0; i < s->settings.n_groups; i++) {
        RP_TRY(forensics_study_params(s, i, own));
        sweep_groups_of(own, s->base + i * SWEEP_N_GROUPS);
        for (; c < s->n_cells && s->setting[c] == i; c++) {
            repose_params_copy(at, own);
            RP_TRY(repose_params_at(at, &s->claims->points[s->point[c]]));
            sweep_groups_of(at, s->group + c * SWEEP_N_GROUPS);
        }
    }
    return RP_OK;
}

/* Least and largest value of a group over n lists of groups, on its scale; steps and digits are rounded, so
 * that a range below a per cent is none. */
static bool find_range(size_t group, size_t n, const double list[], double *lo, double *hi)
{
    *lo = INFINITY, *hi = -INFINITY;
    for (size_t i = 0; i < n; i++) {
        const double v = forensics_scaled(group, list[i * SWEEP_N_GROUPS + group]);
        *lo = fmin(*lo, v), *hi = fmax(*hi, v);
    }
    return *hi - *lo > 0.01;
}

static rp_status find_inputs(forensics_study *s)
{
    for (size_t g = 0; g < SWEEP_N_GROUPS; g++) {
        double lo, hi;
        s->is_choice[g] =
            find_range(g, s->settings.n_groups, s->base, &lo, &hi) && sweep_groups[g].lo < sweep_groups[g].hi;
        s->varies[g] = find_range(g, s->n_cells, s->group, &s->lo[g], &s->hi[g]);
        if (s->varies[g] && !isfinite(s->hi[g] - s->lo[g]))
            return rp_fail(RP_BAD_INPUT, "%s: group %s, %s: infinite or 0 in some settings", s->runs->path,
                           sweep_groups[g].name, sweep_groups[g].formula);
    }
    return RP_OK;
}

/* ---- cells ---- */

/* Points of the runs, n_points where a run is at none; cells in the order of the settings. */
static rp_status find_cells(forensics_study *s, size_t point[], size_t cell[])
{
    const size_t n = s->runs->n_rows, k = s->claims->n_points, n_all = s->settings.n_groups * k;
    bool *seen = cli_memory(n_all, sizeof *seen);
    size_t *index = cli_memory(n_all, sizeof *index);
    for (size_t row = 0; row < n; row++) {
        bool here = false;
        for (point[row] = 0; point[row] < k; point[row]++) {
            const cli_words *words = &s->claims->points[point[row]];
            RP_TRY(cli_row_matches(s->runs, row, words, 0, words->n, &here));
            if (here) break;
        }
        if (here) seen[s->settings.of_row[row] * k + point[row]] = true;
    }
    s->setting = cli_memory(n_all, sizeof *s->setting);
    s->point = cli_memory(n_all, sizeof *s->point);
    for (size_t i = 0; i < n_all; i++) {
        if (!seen[i]) continue;
        s->setting[s->n_cells] = i / k;
        s->point[s->n_cells] = i % k;
        index[i] = s->n_cells++;
    }
    for (size_t row = 0; row < n; row++)
        cell[row] = point[row] < k ? index[s->settings.of_row[row] * k + point[row]] : s->n_cells;
    return RP_OK;
}

/* Column of a stem and surface, as theta_r3_top_zero_deg; the parabola is of method 3 alone. */
static rp_status find_column(const forensics_study *s, const char *stem, size_t surface, int *column)
{
    const char *end = forensics_surfaces[surface];
    int length = (int)strlen(end);
    char name[96];
    if (!strstr(stem, "r3") && strstr(end, "_origin")) length -= (int)strlen("_origin");
    const bool first = strncmp(end, forensics_surfaces[0], (size_t)length) == 0;
    snprintf(name, sizeof name, "%s%s%.*s_deg%s", stem, first ? "" : "_", first ? 0 : length, end,
             s->is_reduced ? "_mean" : "");
    return cli_find_column(s->runs, name, column);
}

/* The runs of a row and those of them with a result: one run, or all of a reduced row. */
static rp_status count_runs(const forensics_study *s, size_t row, double *runs, double *ok)
{
    const int status = rp_table_column(s->runs, "status");
    double failed;
    *runs = 1.0;
    *ok = status < 0 || sweep_is_result(cli_text(s->runs, row, status));
    if (!s->is_reduced) return RP_OK;
    RP_TRY(rp_table_number(s->runs, row, rp_table_column(s->runs, "n"), false, ok));
    RP_TRY(rp_table_number(s->runs, row, rp_table_column(s->runs, "n_failed"), false, &failed));
    *runs = *ok + failed;
    return RP_OK;
}

/* Number, mean and sum of squares about it of a row's values, in degrees: NAME_sd and NAME_n follow
 * NAME_mean. */
static rp_status read_values(const forensics_study *s, size_t row, int column, double *n, double *mean,
                             double *squares)
{
    double sd = 0.0;
    RP_TRY(rp_table_number(s->runs, row, column, true, mean));
    *n = isfinite(*mean);
    *squares = 0.0;
    if (!s->is_reduced || *n == 0.0) return RP_OK;
    char name[96];
    const int stem = (int)strlen(s->runs->names[column]) - (int)strlen("mean");
    snprintf(name, sizeof name, "%.*sn", stem, s->runs->names[column]);
    RP_TRY(rp_table_find(s->runs, name, NULL, &column));
    RP_TRY(rp_table_number(s->runs, row, column, false, n));
    snprintf(name + stem, sizeof name - (size_t)stem, "sd");
    RP_TRY(rp_table_find(s->runs, name, NULL, &column));
    if (*n > 1.0) RP_TRY(rp_table_number(s->runs, row, column, false, &sd));
    *squares = (*n - 1.0) * sd * sd;
    return RP_OK;
}

/* Means of one column over the runs with a result; `squares` and `n_values` of each cell. */
static rp_status read_means(forensics_study *s, int column, const size_t cell[], double mean[],
                            double squares[], double n_values[])
{
    for (size_t c = 0; c < s->n_cells; c++) mean[c] = squares[c] = n_values[c] = 0.0;
    for (size_t row = 0; row < s->runs->n_rows; row++) {
        const size_t c = cell[row];
        double runs, ok, n, own, own_squares;
        RP_TRY(count_runs(s, row, &runs, &ok));
        if (c == s->n_cells || ok == 0.0) continue;
        RP_TRY(read_values(s, row, column, &n, &own, &own_squares));
        if (n == 0.0) continue;
        const double change = own * deg - mean[c], before = n_values[c]; /* Welford */
        n_values[c] += n;
        mean[c] += change * n / n_values[c];
        squares[c] += own_squares * deg * deg + change * change * before * n / n_values[c];
    }
    for (size_t c = 0; c < s->n_cells; c++)
        if (n_values[c] < 2.0) mean[c] = NAN;
    return RP_OK;
}

/* Variances of the means, the piles' one pooled over the settings of each point: ten piles alone say too
 * little of theirs. */
static void pool_variance(forensics_study *s, const double squares[], const double n_values[])
{
    for (size_t k = 0; k < s->claims->n_points; k++) {
        double sum = 0.0, dof = 0.0;
        for (size_t c = 0; c < s->n_cells; c++)
            if (s->point[c] == k && n_values[c] >= 2.0) sum += squares[c], dof += n_values[c] - 1.0;
        for (size_t c = 0; c < s->n_cells; c++)
            if (s->point[c] == k) s->variance[c] = sum / dof / n_values[c];
    }
}

static rp_status read_numbers(forensics_study *s, const size_t cell[])
{
    const size_t n = s->n_cells, n_sets = s->claims->n_stems * FORENSICS_SURFACES;
    double *squares = cli_memory(n, sizeof *squares), *n_values = cli_memory(n, sizeof *n_values);
    s->runs_of = cli_memory(n, sizeof *s->runs_of);
    s->ok = cli_memory(n, sizeof *s->ok);
    s->variance = cli_memory(n, sizeof *s->variance);
    s->mean = cli_memory(n_sets * n, sizeof *s->mean);
    for (size_t row = 0; row < s->runs->n_rows; row++) {
        double runs, ok;
        RP_TRY(count_runs(s, row, &runs, &ok));
        if (cell[row] == n) continue;
        s->runs_of[cell[row]] += runs;
        s->ok[cell[row]] += ok;
    }
    for (size_t k = 0; k < n_sets; k++) {
        int column;
        RP_TRY(find_column(s, s->claims->stems[k / FORENSICS_SURFACES], k % FORENSICS_SURFACES, &column));
        RP_TRY(read_means(s, column, cell, s->mean + k * n, squares, n_values));
        if (k == 0) pool_variance(s, squares, n_values);
    }
    return RP_OK;
}

rp_status forensics_study_read(rp_table *runs, size_t n_first, const forensics_claims *claims,
                               forensics_study *s)
{
    *s = (forensics_study){.claims = claims,
                           .runs = runs,
                           .n_first = n_first,
                           .is_reduced =
                               rp_table_column(runs, "n") >= 0 && rp_table_column(runs, "n_failed") >= 0};
    size_t *point = cli_memory(runs->n_rows, sizeof *point), *cell = cli_memory(runs->n_rows, sizeof *cell),
           n = 0;
    RP_TRY(find_settings(s));
    RP_TRY(find_cells(s, point, cell));
    s->group = cli_memory(s->n_cells * SWEEP_N_GROUPS, sizeof *s->group);
    s->base = cli_memory(s->settings.n_groups * SWEEP_N_GROUPS, sizeof *s->base);
    RP_TRY(find_groups(s));
    RP_TRY(find_inputs(s));
    RP_TRY(read_numbers(s, cell));
    for (size_t c = 0; c < s->n_cells; c++) n += isfinite(s->mean[c]);
    if (n < LEAST_CELLS)
        return rp_fail(RP_NO_RESULT, "%s: %zu settings and points with two results, at least %d expected",
                       runs->path, n, LEAST_CELLS);
    return RP_OK;
}
