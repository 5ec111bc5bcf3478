/* Runs without a result behind a row of a derived table; see derive.h. */
#include "cli/derive/derive.h"

#include <stdlib.h>
#include <string.h>

const char *cli_failed(rp_arena *arena, const rp_table *t, const rp_groups *groups, size_t group,
                       const char *x, const double range[2])
{
    const int status = rp_table_column(t, "status"), n = rp_table_column(t, "n"),
              failed = rp_table_column(t, "n_failed"), words = rp_table_column(t, "failed_for"),
              at = x && range ? rp_table_column(t, x) : -1;
    rp_tally causes = {0};
    char text[1024];
    double runs = 0.0;
    for (size_t i = 0; i < t->n_rows; i++) {
        const double value = at < 0 ? 0.0 : strtod(rp_cell(t, i, at), NULL);
        if ((groups && groups->of_row[i] != group) || (at >= 0 && !(value >= range[0] && value <= range[1])))
            continue;
        /* points without any result enter no mean */
        if (failed >= 0 && (n < 0 || strtod(rp_cell(t, i, n), NULL) > 0.0)) {
            runs += strtod(rp_cell(t, i, failed), NULL);
            if (words >= 0) rp_tally_add_text(&causes, rp_cell(t, i, words), 1.0);
        } else if (failed < 0 && status >= 0 && !rp_is_result(rp_cell(t, i, status))) {
            runs++;
            rp_tally_add(&causes, rp_cell(t, i, status), strlen(rp_cell(t, i, status)), 1.0);
        }
    }
    rp_tally_text(&causes, text);
    return rp_text(arena, "%.0f\t%s", runs, text);
}
