/* For tests/analyze.sh alone: a failure returns its status, which an analyzer of one file at a time does not
 * see: each function that checks a status would look as if it went on. */
#include "core/status.h"

#define rp_fail(status, ...) ((void)rp_fail(status, __VA_ARGS__), (status))
