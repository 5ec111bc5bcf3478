/* Systems of units; see units.h. */
#include "core/elementary.h"
#include "params/units.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LETTERS                                                                                              \
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ\xc2\xb5" /* and the two bytes of a micro sign */

static const char *const words[] = {"cgs", "si", "sigma"};

/* A label in each system, and its powers of length, time and mass. */
static const struct {
    const char *label[3];
    double length, time, mass;
} units[] = {{{"cm", "m", "sigma"}, 1, 0, 0},
             {{"s", "s", "(sigma/g)^0.5"}, 0, 1, 0},
             {{"1/s", "1/s", "(g/sigma)^0.5"}, 0, -1, 0},
             {{"rad/s", "rad/s", "rad (g/sigma)^0.5"}, 0, -1, 0},
             {{"cm/s", "m/s", "(g sigma)^0.5"}, 1, -1, 0},
             {{"cm/s^2", "m/s^2", "|g|"}, 1, -2, 0},
             {{"g", "kg", "m"}, 0, 0, 1},
             {{"g/cm^3", "kg/m^3", "m/sigma^3"}, -3, 0, 1},
             {{"dyn", "N", "m g"}, 1, -2, 1},
             {{"dyn/cm", "N/m", "m g/sigma"}, 0, -2, 1},
             {{"dyn/cm^1.5", "N/m^1.5", "m g/sigma^1.5"}, -0.5, -2, 1},
             {{"dyn cm", "N m", "m g sigma"}, 2, -2, 1},
             {{"dyn/cm^2", "N/m^2", "m g/sigma^2"}, -1, -2, 1},
             {{"erg", "J", "m g sigma"}, 2, -2, 1}};
enum { N_UNITS = sizeof units / sizeof *units };

const char *rp_units_word(rp_units system)
{
    return words[system];
}

rp_units rp_units_find(const char *word)
{
    for (rp_units u = RP_SIGMA; word && u > RP_CGS; u--)
        if (strcmp(words[u], word) == 0) return u;
    return RP_CGS;
}

static size_t find(const char *cgs)
{
    size_t i = 0;
    while (i < N_UNITS && strcmp(units[i].label[RP_CGS], cgs) != 0) i++;
    return i;
}

const char *rp_unit(rp_units system, const char *cgs)
{
    const size_t i = system == RP_CGS ? N_UNITS : find(cgs);
    return i < N_UNITS ? units[i].label[system] : cgs;
}

const char *rp_unit_label(size_t k)
{
    return k < N_UNITS ? units[k].label[RP_CGS] : NULL;
}

/* Has a label a unit that the system lacks? m, g, t, h and d are left alone: mass, gravity, height. */
static bool is_foreign(rp_units system, const char *label)
{
    static const char others[] =
        " nm um µm mm km inch ft ug mg us ms min rpm kHz mN kN mJ kJ hPa kPa MPa GPa bar atm ",
                      *const of_systems[] = {" kg N J Pa ", " cm dyn erg ", " cm s kg N J Pa dyn erg "};
    char word[16];
    for (size_t n; *label; label += n + strcspn(label + n, LETTERS)) {
        n = strspn(label, LETTERS);
        snprintf(word, sizeof word, " %.*s ", (int)n, label);
        if (n > 0 && (strstr(others, word) || strstr(of_systems[system], word))) return true;
    }
    return false;
}

rp_status rp_unit_check(rp_units system, const char *label)
{
    static const char *const of_system[] = {"cm, g, s, dyn, erg", "m, kg, s, N, J, Pa", "sigma, m, |g|"};
    const char *meant = is_foreign(system, label) ? of_system[system] : label;
    for (size_t i = 0; i < N_UNITS; i++) {
        const char *const *const of = units[i].label;
        if (strcmp(of[system], label) == 0) return RP_OK;
        if (strcmp(of[RP_CGS], label) == 0 || strcmp(of[RP_SI], label) == 0) meant = of[system];
    }
    return meant == label
               ? RP_OK
               : rp_fail(RP_BAD_INPUT, "unit = %s: the file's units are %s; %s", label, words[system], meant);
}

double rp_units_value(rp_units system, const char *cgs, double number)
{
    const size_t i = system == RP_CGS ? N_UNITS : find(cgs);
    if (i == N_UNITS) return number;
    char text[32];
    const double d = 0.2, g = 981.0, length = system == RP_SI ? 100.0 : d,
                 time = system == RP_SI ? 1.0 : sqrt(d / g),
                 mass = system == RP_SI ? 1000.0 : M_PI / 6.0 * d * d * d;
    snprintf(text, sizeof text, "%.12g",
             number / (rp_pow(length, units[i].length) * rp_pow(time, units[i].time) *
                       rp_pow(mass, units[i].mass)));
    return strtod(text, NULL);
}
