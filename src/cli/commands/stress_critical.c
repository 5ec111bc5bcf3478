/* repose stress critical: the tilt at which the measured stress reaches Coulomb's law. */
#include <string.h>

#include "stress/stress.h"
#include "cli/cli.h"

#define CRITICAL_OPTIONS(X)                                                                                  \
    CLI_BOOTSTRAP(X, "1000")                                                                                 \
    CLI_WHERE(X)

CLI_OPTIONS(critical, CRITICAL_OPTIONS)

static void print_critical_header(void)
{
    static const char *const parts[] = {"", "_se", "_lo", "_hi"};
    char text[4096];
    size_t used = (size_t)snprintf(text, sizeof text, "mu, n");
#define X(name, angle)                                                                                       \
    for (size_t k = 0; k < N_OF(parts); k++)                                                                 \
        used += (size_t)snprintf(text + used, sizeof text - used, ", %s%s%s", #name, parts[k],               \
                                 angle ? "_deg [deg]" : "");
    STRESS_CRITICAL_LIST(X)
#undef X
    rp_table_header(stdout, text);
}

static void print_critical(double mu, size_t n, const stress_critical *c)
{
    double v[2 + sizeof *c / sizeof(double)] = {mu, (double)n};
    size_t used = 2;
#define X(name, angle)                                                                                       \
    v[used++] = c->name.value / (angle ? deg : 1.0);                                                         \
    v[used++] = c->name.se / (angle ? deg : 1.0);                                                            \
    v[used++] = c->name.lo / (angle ? deg : 1.0);                                                            \
    v[used++] = c->name.hi / (angle ? deg : 1.0);
    STRESS_CRITICAL_LIST(X)
#undef X
    rp_table_row(stdout, used, v);
}

/* The columns of a response are its numbers, in order, after mu and theta_t. */
static stress_response response_of(const cli_rows *runs, size_t i)
{
    double numbers[sizeof(stress_response) / sizeof(double)];
    stress_response response;
    for (size_t k = 0; k < N_OF(numbers); k++) numbers[k] = runs->column[2 + k][i];
    memcpy(&response, numbers, sizeof response);
    return response;
}

static rp_status critical_table(rp_table *table, void *values)
{
    const critical_options *o = values;
    cli_rows runs; /* a pile that stood every tilt has no theta_t to compare with */
    RP_TRY(cli_rows_read(table,
                         "mu,theta_t_displacement_deg,n_0,n_1,h_0,h_1,sxx_0,sxy_0,syx_0,syy_0,sxx_1,sxy_1,"
                         "syx_1,syy_1",
                         &(cli_choice){.grouped = true}, &runs));
    gsl_rng *rng = cli_random(0);
    stress_response *responses = cli_memory(runs.n, sizeof *responses);
    cli_table(stdout);
    cli_rows_note(table, &runs);
    print_critical_header();
    for (size_t i = 0; i < runs.n; i++) {
        runs.column[1][i] *= deg;
        responses[i] = response_of(&runs, i);
    }
    for (size_t g = 0; g < runs.n_groups; g++) {
        const size_t first = runs.first[g], n = runs.first[g + 1] - first;
        const double mu = runs.column[0][first];
        stress_critical critical;
        RP_TRY(rp_prefix(stress_critical_tilts(n, responses + first, runs.column[1] + first, mu,
                                               (size_t)o->bootstrap, rng, &critical),
                         "%s: mu = %g: ", table->path, mu));
        print_critical(mu, n, &critical);
    }
    return RP_OK;
}

const cli_command cmd_stress_critical = {
    "stress critical",
    "tilt at which the measured stress reaches Coulomb's law",
    "FILE [options]",
    "Tilt at which the measured stress of piles reaches Coulomb's law, one row for each mu, from the\n"
    "runs of protocol stress (repose sweep export; rows whose status is not ok are left out). Mean\n"
    "response of the piles, extrapolated in the tangent of the tilt; errors and 95 % intervals by\n"
    "bootstrap over piles.\n"
    "floor_tilt: friction on the floor comes to mu; floor_less: that less the measured theta_t.\n"
    "..._friction_0, _t: friction mobilised without tilt and at the measured theta_t. rank: Spearman's\n"
    "correlation of the piles' own floor_tilt and theta_t.",
    "repose stress critical build/tables/lh_stress_runs.tsv",
    critical_params,
    .on_table = critical_table};
