/* Random streams and texts, and least squares by GSL; see numbers.h. */
#include <gsl/gsl_multifit.h>

#include "core/random.h"
#include "tests/check.h"
#include "tests/numbers.h"

void numbers_end(gsl_rng **rng)
{
    gsl_rng_free(*rng);
}

static void set(void *state, unsigned long seed)
{
    *(rp_random *)state = rp_random_of(seed, 0, (rp_purpose)0);
}

static unsigned long word(void *state)
{
    return rp_random_word(state);
}

static double uniform(void *state)
{
    return rp_random_uniform(state);
}

gsl_rng *numbers_of(unsigned long seed, unsigned long run)
{
    static const gsl_rng_type type = {"philox4x32", UINT32_MAX, 0, sizeof(rp_random), set, word, uniform};
    gsl_rng *r = gsl_rng_alloc(&type);
    *numbers_stream(r) = rp_random_of(seed, run, RP_PURPOSE_TEST);
    return r;
}

rp_random *numbers_stream(const gsl_rng *r)
{
    return gsl_rng_state(r);
}

void numbers_text(gsl_rng *rng, const char *without, char text[NUMBERS_TEXT])
{
    static const char *const words[] = {"`>hit`",
                                        "$(>hit)",
                                        "`touch hit`",
                                        "$(touch hit)",
                                        "system('touch hit')",
                                        "shell touch hit",
                                        "touch hit",
                                        "\"\"\"",
                                        "${x}",
                                        "$x",
                                        "%s",
                                        "%n",
                                        "@{",
                                        "..",
                                        ">hit",
                                        "!touch hit",
                                        "\xc3\xa9"};
    static const char letters[] = "'\"\\`$;|&<>#%{}[]()*?~!^@=+-_,.:/ \n\t\r\x01"
                                  "aZ9";
    const size_t n_words = sizeof words / sizeof *words;
    const size_t most = 1 + gsl_rng_uniform_int(rng, NUMBERS_TEXT - 1);
    *text = '\0';
    for (int k = 0; k < 12 || !*text; k++) {
        const size_t at = gsl_rng_uniform_int(rng, n_words + sizeof letters - 1);
        const char *part = at < n_words ? words[at] : (char[]){letters[at - n_words], '\0'};
        if (strlen(text) + strlen(part) <= (*text ? most : NUMBERS_TEXT - 1) && !strpbrk(part, without))
            strcat(text, part);
    }
}

void numbers_fit(size_t n, size_t p, const double X[], const double w[], const double y[], double c[],
                 double covariance[])
{
    gsl_matrix_const_view columns = gsl_matrix_const_view_array(X, n, p);
    gsl_vector_const_view values = gsl_vector_const_view_array(y, n),
                          weights = gsl_vector_const_view_array(w ? w : y, n);
    gsl_vector_view found = gsl_vector_view_array(c, p);
    gsl_matrix_view errors = gsl_matrix_view_array(covariance, p, p);
    gsl_multifit_linear_workspace *work = gsl_multifit_linear_alloc(n, p);
    double chi2;
    const int code =
        w ? gsl_multifit_wlinear(&columns.matrix, &weights.vector, &values.vector, &found.vector,
                                 &errors.matrix, &chi2, work)
          : gsl_multifit_linear(&columns.matrix, &values.vector, &found.vector, &errors.matrix, &chi2, work);
    CU_ASSERT(code == 0);
    gsl_multifit_linear_free(work);
}
