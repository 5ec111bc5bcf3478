/* Positions along the base, for the commands that evaluate a model there. */
#ifndef POSITIONS_H
#define POSITIONS_H

#include <stddef.h>

#include "cli/cli.h"

/* Values of the options --points and --at. */
typedef struct {
    long points;    /* -1: not given */
    const char *at; /* "auto": not given */
} cli_positions;

/* clang-format off */
#define CLI_POSITIONS(type, field)                                                                           \
    {"points", "", RP_INT, offsetof(type, field.points), "auto", "[2, 10000000] | auto",                     \
     "number of equidistant positions from 0 to B; auto: 201 unless --at is given"},                                      \
    {"at", "", RP_TEXT, offsetof(type, field.at), "auto", "", "positions as fractions of B, as in 0.1,0.25"}
/* clang-format on */

/* The positions as a new array (free it) of fractions of the base.
 * Errors: RP_USAGE (both given), RP_BAD_INPUT (not numbers in [0, 1]), RP_NO_MEMORY. */
rp_status cli_positions_read(const cli_positions *asked, double **x, size_t *n);

#endif
