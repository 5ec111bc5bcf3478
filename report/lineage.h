/* The sweeps whose runs answer a claim, and those of their runs that have no result. */
#ifndef REPORT_LINEAGE_H
#define REPORT_LINEAGE_H

#include "report/cells.h"

/* A sweep by the name in the header lines "# source: NAME DIGEST RUNS" of the tables made of its runs. */
typedef struct report_sweep {
    const char *name;
    const char
        *failed; /* of NAME/points: runs without a result, "8 of 15 (no_pile 6, overlap 2)"; "": none */
    struct report_sweep *next;
} report_sweep;

/* Add the sweeps behind both sides of a claim to a list, NULL at first. A side is a cell or several cells
 * that are pooled; NULL: a number, or none. Errors: those of rp_table_read, RP_BAD_INPUT. */
rp_status report_sweeps(report_tables *tables, const report_reference *answer,
                        const report_reference *against, report_sweep **sweeps);

/* Runs without a result behind the rows that both sides read, with their causes and how the mean changes
 * without them: "11 of 185 (no_response 11): the weakest piles are left out, theta_T is too large"; "" if
 * there are none. Errors: as above. */
rp_status report_failed(report_tables *tables, const report_reference *answer,
                        const report_reference *against, const char **text);

#endif
