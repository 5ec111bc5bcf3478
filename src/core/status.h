/* Status codes and the message of the last failure.
 *
 * A function that can fail returns an rp_status. Its message (which field, which value, which range,
 * which file and line) is kept per thread and read with rp_message(). Libraries never print or exit. */
#ifndef RP_STATUS_H
#define RP_STATUS_H

/* Public headers stand between these, for programs in C++. */
#ifdef __cplusplus
#define RP_C_BEGIN extern "C" {
#define RP_C_END   }
#else
#define RP_C_BEGIN
#define RP_C_END
#endif

RP_C_BEGIN

/* One list: name, exit status of the program, meaning. */
#define RP_STATUS_LIST(X)                                                                                    \
    X(RP_OK, 0, "success")                                                                                   \
    X(RP_NO_RESULT, 1, "computed without a result")                                                          \
    X(RP_USAGE, 64, "wrong usage")                                                                           \
    X(RP_BAD_INPUT, 65, "bad input")                                                                         \
    X(RP_BROKEN, 70, "broken invariant")                                                                     \
    X(RP_NO_MEMORY, 71, "out of memory")                                                                     \
    X(RP_IO, 74, "input or output failed")                                                                   \
    X(RP_STOPPED, 75, "stopped; run again to resume")

typedef enum {
#define X(name, code, text) name = code,
    RP_STATUS_LIST(X)
#undef X
    /* bad input whose cause a caller may take for a result; a program that ends with one ends with 65 */
    RP_NO_ROOM = 1 << 8 | RP_BAD_INPUT,  /* a body does not fit where it is put */
    RP_TOO_FAST = 2 << 8 | RP_BAD_INPUT, /* a motion needs a smaller time step */
} rp_status;

/* Record a message and return `status`, so that a caller can write: return rp_fail(RP_BAD_INPUT, ...). */
rp_status rp_fail(rp_status status, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Return from this function with the status of a call that fails. For functions that have nothing to free by
 * then. */
#define RP_TRY(call)                                                                                         \
    do {                                                                                                     \
        const rp_status try_status = (call);                                                                 \
        if (try_status) return try_status;                                                                   \
    } while (0)

/* Of a variable: when its block is left, by whatever way, `end` is called with its address. */
#define RP_ENDS(end) __attribute__((cleanup(end)))

/* Prepend a prefix such as "file:line: " to the last message, unless `status`, which it returns, is RP_OK. */
rp_status rp_prefix(rp_status status, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* RP_OK where lo <= value <= hi, else RP_BAD_INPUT with the range that is `allowed`. DBL_MIN and DBL_MAX
 * stand for bounds that are open at 0 and infinity. */
rp_status rp_check_range(const char *name, double value, double lo, double hi, const char *allowed);

/* Message of the last failure in this thread; empty if there was none. */
const char *rp_message(void);

RP_C_END

#endif
