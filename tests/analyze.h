/* For tests/analyze.sh alone: a failure returns the status that it is given, which an analyzer of one file at
 * a time does not see. Without this line each function that checks a status would look as if it went on after
 * a failure. */
#include "core/status.h"

#define rp_fail(status, ...) ((void)rp_fail(status, __VA_ARGS__), (status))
