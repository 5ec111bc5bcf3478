/* Runs and publications of a known function; see planted.h. */
#include "tests/planted.h"

#include <math.h>
#include <stdio.h>

#include "angle/angle.h"
#include "core/random.h"
#include "dem/dem.h"
#include "stats/forensics.h"
#include "tests/check.h"
#include "tests/program.h"

const double planted_k_n[] = {1e6, 1e5, 1e6}, planted_gamma_n[] = {500.0, 500.0, 100.0};

double planted_angle(double stiffness, double damping, int total)
{
    const double s = log10(stiffness) - 4.0;
    return 18.0 + 2.0 * s + 0.8 * sin(2.0 * s) + 4.0 * (log10(damping) - 1.0) - 2.5 * total;
}

double planted_stiffness(double density, double g, double k_n)
{
    return k_n * pow(0.2, 1.5) / (dem_mass(DEM_SPHERE, density, 0.1) * g);
}

double planted_damping(double g, double gamma_n)
{
    return gamma_n * sqrt(0.2 / g);
}

static void write_runs(const char *name, size_t n, int stop)
{
#define ENDS(height, empty) "_" #height "_" #empty "_deg", "_" #height "_" #empty "_origin_deg",
    static const char *const ends[] = {ANG_SURFACES(ENDS)};
    enum { SURFACES = sizeof ends / sizeof *ends };
    static const double scatter[PLANTED_PILES] = {-0.6, 0.4, -0.4, 0.6};
    double u[2 * 512];
    size_t slip[512], levels = 2;
    char path[256];
    gsl_rng *rng = rp_random_alloc(31, 0, RP_PURPOSE_TEST);
    CHECK_OK(stats_design(n, 2, u, 1, &levels, slip, rng));
    gsl_rng_free(rng);
    path_of(name, path);
    FILE *file = fopen(path, "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    fputs("# mu: 0.2\n# shape: sphere\n# status\tdensity\tg\tslip\tk_n\tgamma_n", file);
    for (size_t v = 0; v < SURFACES; v++)
        fprintf(file, "\ttheta_r3%s\ttheta_r1%s", v ? ends[v] : "_deg", v ? ends[v] : "_deg");
    fputc('\n', file);
    int row = 0;
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < PLANTED_POINTS; k++)
            for (size_t pile = 0; pile < PLANTED_PILES; pile++) {
                const double damping = 3.0 * pow(50.0 / 3.0, u[2 * i]), g = 0.2 * pow(500.0 / damping, 2.0),
                             density = planted_stiffness(1.0, g, 1e6) / (2e3 * pow(200.0, u[2 * i + 1]));
                const double angle = planted_angle(planted_stiffness(density, g, planted_k_n[k]),
                                                   planted_damping(g, planted_gamma_n[k]), (int)slip[i]) +
                                     scatter[pile];
                fprintf(file, "%s\t%.17g\t%.17g\t%s\t%g\t%g", stop && ++row % stop == 0 ? "overlap" : "ok",
                        density, g, slip[i] ? "total" : "truncated", planted_k_n[k], planted_gamma_n[k]);
                for (size_t v = 0; v < SURFACES; v++)
                    fprintf(file, "\t%.10g\t%.10g", angle + (v % 2 ? 9.0 : 0.0), angle + 1.0);
                fputc('\n', file);
            }
    fclose(file);
}

void planted_write(const char *prefix, size_t n, int stop)
{
    double angle[PLANTED_POINTS];
    for (size_t k = 0; k < PLANTED_POINTS; k++)
        angle[k] = planted_angle(planted_stiffness(2.0, 500.0, planted_k_n[k]),
                                 planted_damping(500.0, planted_gamma_n[k]), 1);
    char name[64];
    snprintf(name, sizeof name, "%sruns.tsv", prefix);
    write_runs(name, n, stop);
    snprintf(name, sizeof name, "%sclaims.tsv", prefix);
    write_text(name,
               "# at: k_n=1e6 gamma_n=500\n"
               "# "
               "id\tof\tpaper\tplace\tsection\ttest\tpublished\tpublished_"
               "se\tsamples\tmargin\tfamily\tanswer\tagainst\t"
               "forensics\tstatement\tnote\n"
               "first\t-\tlh\t-\tall\tagrees\t%.6f\t0.1\t20\t2\t-\tt v\t-\theld theta_r1\tby method 1\t-\n"
               "base\t-\tlh\t-\tall\tagrees\t%.6f\t0.3\t20\t2\t-\tt v\t-\ttheta_r3\ta\t-\n"
               "soft\t-\tlh\t-\tall\tagrees\t%.6f\t0.3\t20\t2\t-\tt v\t-\ttheta_r3 k_n=1e5\tb\t-\n"
               "damped\t-\tlh\t-\tall\tagrees\t%.6f\t0.3\t20\t2\t-\tt v\t-\ttheta_r3 gamma_n=100\tc\t-\n",
               angle[0] + 1.05, angle[0] + 0.2, angle[1] - 0.1, angle[2] + 0.1);
}
