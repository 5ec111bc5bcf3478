/* The sweeps whose runs answer a claim, and those of their runs that have no result. */
#ifndef REPORT_LINEAGE_H
#define REPORT_LINEAGE_H

#include "report/cells.h"

/* A sweep by the table of its grid points: one with a header line `sweep`. */
typedef struct report_sweep {
    const char *name;
    const char *failed; /* runs without a result, "8 of 15 (no_pile 6, overlap 2)"; "" if there are none */
    const rp_table *table;
    bool *counted; /* grid points that the references read */
    struct report_sweep *next;
} report_sweep;

/* Add the sweeps behind both sides of a claim to a list, NULL at first. A side is a cell or several cells
 * that are pooled, "CELL + CELL"; its sweeps are those that the commands in the headers of its tables read,
 * else that of a table's own name. Errors: those of rp_table_read, RP_BAD_INPUT. */
rp_status report_sweeps(report_tables *tables, const char *answer, const char *against,
                        report_sweep **sweeps);

/* Runs without a result at these grid points, with their causes and how the mean changes without them: "11 of
 * 185 (no_response 11): the weakest piles are left out, theta_T is too large"; "" if there are none. Points
 * without any result enter no mean. */
const char *report_failed(rp_arena *arena, const report_sweep *sweeps);

#endif
