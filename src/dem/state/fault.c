/* Why a run stops. */
#include <stdarg.h>
#include <stdio.h>

#include "dem/state/state.h"

const char *dem_fault_text(dem_fault fault)
{
#define X(name, text) [name] = text,
    static const char *const texts[] = {DEM_FAULT_LIST(X)};
#undef X
    return texts[fault];
}

rp_status dem_stop(dem_sim *sim, dem_fault fault, size_t grain, const char *format, ...)
{
    char text[256];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    sim->fault = fault;
    return rp_fail(RP_BROKEN, "%s at step %ld: grain %u: %s", dem_fault_text(fault), sim->step,
                   sim->grains.id[grain], text);
}
