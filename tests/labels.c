/* Labels of units: a product of factors, each after a blank or a stroke, which divides by that factor alone.
 */
#include "tests/labels.h"

#include <stdlib.h>
#include <string.h>

static const struct {
    const char *word;
    double of[3]; /* length, mass, time */
} bases[] = {{"cm", {1, 0, 0}},   {"m", {1, 0, 0}},  {"sigma", {1, 0, 0}}, {"g", {0, 1, 0}},
             {"kg", {0, 1, 0}},   {"s", {0, 0, 1}},  {"dyn", {1, 1, -2}},  {"N", {1, 1, -2}},
             {"erg", {2, 1, -2}}, {"J", {2, 1, -2}}, {"rad", {0, 0, 0}},   {"degree", {0, 0, 0}},
             {"1", {0, 0, 0}}},
  of_sigma[] = {{"m", {0, 1, 0}}, {"g", {1, 0, -2}}, {"|g|", {1, 0, -2}}};

static bool product(const char **text, bool sigma, double powers[3]);

static bool base(const char **text, bool sigma, double powers[3])
{
    const size_t n = strcspn(*text, " /^()");
    for (size_t k = 0; k < 3 && sigma; k++)
        if (strlen(of_sigma[k].word) == n && strncmp(of_sigma[k].word, *text, n) == 0)
            return *text += n, memcpy(powers, of_sigma[k].of, sizeof of_sigma[k].of), true;
    for (size_t k = 0; k < sizeof bases / sizeof *bases; k++)
        if (strlen(bases[k].word) == n && strncmp(bases[k].word, *text, n) == 0)
            return *text += n, memcpy(powers, bases[k].of, sizeof bases[k].of), true;
    return false;
}

static bool factor(const char **text, bool sigma, double powers[3])
{
    const bool inner = **text == '(';
    *text += inner;
    if (!(inner ? product : base)(text, sigma, powers) || (inner && *(*text)++ != ')')) return false;
    if (**text != '^') return true;
    char *end;
    const double power = strtod(*text + 1, &end);
    for (int k = 0; k < 3; k++) powers[k] *= power;
    *text = end;
    return true;
}

static bool product(const char **text, bool sigma, double powers[3])
{
    double one[3];
    if (!factor(text, sigma, powers)) return false;
    while (**text == ' ' || **text == '/') {
        const double sign = *(*text)++ == '/' ? -1.0 : 1.0;
        if (!factor(text, sigma, one)) return false;
        for (int k = 0; k < 3; k++) powers[k] += sign * one[k];
    }
    return true;
}

bool label_powers(const char *label, bool sigma, double powers[3])
{
    return product(&label, sigma, powers) && !*label;
}
