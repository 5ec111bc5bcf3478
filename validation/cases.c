/* Cases of validation; see cases.h. */
#include "validation/cases.h"

#include "table/table.h"

/* A cell of a table holds no spaces. */
static void print_cell(FILE *out, const char *text)
{
    for (char last = ' '; *text; last = *text++)
        if (*text != ' ')
            fputc(*text, out);
        else if (last != ',')
            fputc(',', out);
    fputc('\t', out);
}

void case_of(case_problem *problem, const char *quantity, double expected, double observed, double bound,
             const char *parameters)
{
    snprintf(problem->parameters, sizeof problem->parameters, "%s", parameters);
    case_also(problem, quantity, expected, observed, bound);
}

void case_also(case_problem *problem, const char *quantity, double expected, double observed, double bound)
{
    const double error = fabs(observed - expected);
    CHECK_OR_SAY(error <= bound, "%s, %s: %s = %.17g, expected %.17g within %g", problem->problem,
                 problem->parameters, quantity, observed, expected, bound);
    const double ratio = isnan(error) ? INFINITY : error > 0.0 ? error / bound : 0.0;
    problem->n++;
    problem->worst = fmax(problem->worst, ratio);
    if (!problem->text) problem->text = open_memstream(&problem->rows, &problem->size);
    CU_ASSERT_PTR_NOT_NULL_FATAL(problem->text);
    print_cell(problem->text, problem->problem);
    print_cell(problem->text, problem->parameters);
    print_cell(problem->text, quantity);
    fprintf(problem->text, "%.17g\t%.17g\t%.17g\t%.17g\n", expected, observed, error, bound);
}

int case_stride(int daily)
{
    return check_full() ? 1 : check_fast() ? 5 * daily : daily;
}

void case_write(const char *suite, case_problem *const problems[], size_t n)
{
    CHECK_TABLE(out, suite, NULL);
    CHECK_TABLE(cases, check_text("%s_cases", suite),
                "problem, parameters, quantity, expected, observed, error, bound");
    for (size_t i = 0; i < n && out; i++) {
        rp_table_note(out, check_text("source_%s", problems[i]->problem), "%s", problems[i]->source);
        rp_table_note(out, check_text("bound_%s", problems[i]->problem), "%s", problems[i]->bound);
    }
    if (out) rp_table_header(out, RP_CGS, "problem, cases [1], worst_over_bound [1]");
    for (size_t i = 0; i < n; i++) {
        case_problem *p = problems[i];
        CU_ASSERT(p->n > 0);
        if (p->text) fclose(p->text);
        if (out) {
            fprintf(out, "%s\t%ld\t", p->problem, p->n);
            rp_table_row(out, 1, &p->worst);
        }
        if (cases && p->rows) fputs(p->rows, cases);
        free(p->rows);
        p->text = NULL;
        p->rows = NULL;
    }
}
