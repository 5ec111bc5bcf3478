/* Status codes and messages; see status.h. */
#include "core/status.h"

#include <stdarg.h>
#include <string.h>

#include "core/plain.h"

static _Thread_local char message[RP_MESSAGE];

/* GSL's own handler ends the program; each caller of GSL here checks the returned status. A program of
 * modules without GSL need not link it. */
__attribute__((weak)) void *gsl_set_error_handler_off(void);

__attribute__((constructor)) static void switch_handler_off(void)
{
    if (gsl_set_error_handler_off) gsl_set_error_handler_off();
}

rp_status rp_fail(rp_status status, const char *format, ...)
{
    char text[RP_MESSAGE]; /* the last message may be among what is printed */
    va_list args;
    va_start(args, format);
    rp_plain_print(text, format, args);
    va_end(args);
    memcpy(message, text, sizeof message);
    return status;
}

rp_status rp_prefix(rp_status status, const char *format, ...)
{
    char prefix[RP_MESSAGE];
    if (!status) return RP_OK;
    va_list args;
    va_start(args, format);
    rp_plain_print(prefix, format, args);
    va_end(args);
    return rp_fail(status, "%s%s", prefix, message);
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
