/* Positions along the base; see positions.h. */
#include "cli/positions.h"

#include <stdlib.h>
#include <string.h>

static rp_status read_list(const char *text, double **x, size_t *n)
{
    rp_status status = cli_numbers("--at", text, x, n);
    for (size_t i = 0; !status && i < *n; i++)
        if ((*x)[i] < 0 || (*x)[i] > 1) {
            status = rp_fail(RP_BAD_INPUT, "--at: x/B = %.15g: out of range, allowed: [0, 1]", (*x)[i]);
            free(*x);
            *x = NULL;
        }
    return status;
}

rp_status cli_positions_read(const cli_positions *asked, double **x, size_t *n)
{
    bool listed = strcmp(asked->at, "auto") != 0;
    if (listed && asked->points > 0) return rp_fail(RP_USAGE, "give --points or --at, not both");
    if (listed) return read_list(asked->at, x, n);
    *n = asked->points > 0 ? (size_t)asked->points : 201;
    *x = malloc(*n * sizeof **x);
    if (!*x) return rp_fail(RP_NO_MEMORY, "--points %zu: out of memory", *n);
    for (size_t i = 0; i < *n; i++) (*x)[i] = (double)i / (double)(*n - 1);
    return RP_OK;
}
