/* Status codes and messages; see status.h. */
#include "core/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static _Thread_local char message[4096];

/* GSL's own handler ends the program; each caller of GSL here checks the returned status. A program of
 * modules without GSL need not link it. */
__attribute__((weak)) void *gsl_set_error_handler_off(void);

__attribute__((constructor)) static void switch_handler_off(void)
{
    if (gsl_set_error_handler_off) gsl_set_error_handler_off();
}

rp_status rp_fail(rp_status status, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    return status;
}

rp_status rp_prefix(rp_status status, const char *format, ...)
{
    char rest[sizeof message];
    if (!status) return RP_OK;
    memcpy(rest, message, sizeof message);
    va_list args;
    va_start(args, format);
    int n = vsnprintf(message, sizeof message, format, args);
    va_end(args);
    if (n >= 0 && (size_t)n < sizeof message) snprintf(message + n, sizeof message - (size_t)n, "%s", rest);
    return status;
}

rp_status rp_check_range(const char *name, double value, double lo, double hi, const char *allowed)
{
    if (value >= lo && value <= hi) return RP_OK;
    return rp_fail(RP_BAD_INPUT, "%s = %.15g: out of range, allowed: %s", name, value, allowed);
}

const char *rp_message(void)
{
    return message;
}
