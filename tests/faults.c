/* Stand in for functions of the C library, and do as they do until a failure is ordered; see faults.h. */
#include "tests/faults.h"

#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

static fault ordered;
static long calls_left; /* before the one that fails, counted from 1; 0: no order */
static bool all_fail, failing;

time_t fault_monotonic_clock;
void (*fault_watch)(const char *call, int file, const char *from, const char *to);
volatile bool *fault_seen;
bool fault_shared_file_system;
double fault_tick, fault_monotonic_tick;

/* Of fault_signal, shared with the processes that are forked. */
static struct {
    int signal;
    const char *part;
    long left;
    pid_t process;
} * due;

bool fault_signals_seen(pid_t process)
{
    char path[64], line[128], state = '?';
    unsigned long pending = 0, some;
    snprintf(path, sizeof path, "/proc/%d/status", (int)process);
    FILE *in = fopen(path, "r");
    while (in && fgets(line, sizeof line, in)) {
        sscanf(line, "State: %c", &state);
        if (sscanf(line, "SigPnd: %lx", &some) == 1 || sscanf(line, "ShdPnd: %lx", &some) == 1)
            pending |= some;
    }
    if (in) fclose(in);
    return !in || (state == 'S' && pending == 0);
}

static void send_when_due(const char *call, int file, const char *from, const char *to)
{
    char path[PATH_MAX] = "", link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    if (file >= 0) path[readlink(link, path, sizeof path - 1) < 0 ? 0 : sizeof path - 1] = '\0';
    const bool meant = strstr(call, due->part) || strstr(path, due->part) ||
                       (from && strstr(from, due->part)) || (to && strstr(to, due->part));
    if (!meant || __atomic_sub_fetch(&due->left, 1, __ATOMIC_RELAXED) != 0) return;
    kill(due->process, due->signal);
    while (due->process != getpid() && !fault_signals_seen(due->process)) usleep(1000);
}

void fault_signal(int signal, const char *part, long n)
{
    due = mmap(NULL, sizeof *due, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (due == MAP_FAILED) abort();
    due->signal = signal, due->part = part, due->left = n, due->process = getpid();
    fault_watch = send_when_due;
}

void fault_order(fault kind, long call, bool for_good)
{
    ordered = kind;
    calls_left = call;
    all_fail = for_good;
    failing = false;
}

static bool fails(fault kind)
{
    if (ordered != kind || (calls_left == 0 && !failing)) return false;
    if (failing) return true;
    if (--calls_left > 0) return false;
    failing = all_fail;
    if (fault_seen) *fault_seen = true;
    return true;
}

/* A function that sets errno to `code` and returns -1 where it shall fail, and else does as the library's. */
#define CAN_FAIL(kind, code, type, name, parameters, arguments)                                              \
    CAN_FAIL_AS(-1, kind, code, type, name, parameters, arguments)
#define CAN_FAIL_AS(failed, kind, code, type, name, parameters, arguments)                                   \
    type name parameters;                                                                                    \
    type name parameters                                                                                     \
    {                                                                                                        \
        static type(*real) parameters;                                                                       \
        if (!real) *(void **)&real = dlsym(RTLD_NEXT, #name);                                                \
        if (!fails(kind)) return real arguments;                                                             \
        errno = code;                                                                                        \
        return failed;                                                                                       \
    }

CAN_FAIL(FAULT_FILE, EIO, int, access, (const char *path, int mode), (path, mode))
CAN_FAIL(FAULT_FILE, EIO, int, stat, (const char *path, struct stat *info), (path, info))
CAN_FAIL(FAULT_FILE, EIO, int, lstat, (const char *path, struct stat *info), (path, info))
CAN_FAIL(FAULT_FILE, EIO, int, fstat, (int file, struct stat *info), (file, info))
CAN_FAIL(FAULT_FILE, EACCES, int, mkdir, (const char *path, mode_t mode), (path, mode))
CAN_FAIL_AS(NULL, FAULT_FILE, EMFILE, FILE *, fopen, (const char *path, const char *mode), (path, mode))
CAN_FAIL_AS(NULL, FAULT_FILE, ENOMEM, FILE *, fdopen, (int file, const char *mode), (file, mode))
CAN_FAIL_AS(NULL, FAULT_FILE, EMFILE, DIR *, opendir, (const char *path), (path))
CAN_FAIL_AS(NULL, FAULT_FILE, EIO, struct dirent *, readdir, (DIR * folder), (folder))
CAN_FAIL(FAULT_FORK, EAGAIN, pid_t, fork, (void), ())
CAN_FAIL(FAULT_SYNC, EIO, int, fdatasync, (int file), (file))
CAN_FAIL(FAULT_WRITE, ENOSPC, ssize_t, pwrite64, (int file, const void *bytes, size_t n, off64_t at),
         (file, bytes, n, at))
CAN_FAIL(FAULT_SEND, ENOBUFS, ssize_t, send, (int to, const void *bytes, size_t n, int flags),
         (to, bytes, n, flags))

int open(const char *path, int flags, ...); /* <fcntl.h> may have an inline one */
int open(const char *path, int flags, ...)
{
    static int (*real)(const char *, int, ...);
    va_list args;
    va_start(args, flags);
    const mode_t mode = va_arg(args, mode_t); /* of no meaning without O_CREAT */
    va_end(args);
    if (!real) *(void **)&real = dlsym(RTLD_NEXT, "open");
    return fails(FAULT_FILE) ? (errno = EMFILE, -1) : real(path, flags, mode);
}

int fsync(int file)
{
    static int (*real)(int);
    if (!real) *(void **)&real = dlsym(RTLD_NEXT, "fsync");
    if (fault_watch) fault_watch("fsync", file, NULL, NULL);
    return fails(FAULT_SYNC) ? (errno = EIO, -1) : real(file);
}

#define WATCHED(name, parameters, arguments, to)                                                             \
    int name parameters                                                                                      \
    {                                                                                                        \
        static int(*real) parameters;                                                                        \
        if (!real) *(void **)&real = dlsym(RTLD_NEXT, #name);                                                \
        if (fault_watch) fault_watch(#name, -1, path, to);                                                   \
        return real arguments;                                                                               \
    }

/* In a folder, for the watcher: its path of a name there. */
static const char *path_in(int folder, const char *name, char path[4200])
{
    snprintf(path, 4200, "/proc/self/fd/%d/%s", folder, name);
    return path;
}

int unlinkat(int folder, const char *path, int flags)
{
    static int (*real)(int, const char *, int);
    char whole[4200];
    if (!real) *(void **)&real = dlsym(RTLD_NEXT, "unlinkat");
    if (fault_watch) fault_watch("unlinkat", -1, path_in(folder, path, whole), NULL);
    return real(folder, path, flags);
}

int renameat(int from, const char *path, int folder, const char *to)
{
    static int (*real)(int, const char *, int, const char *);
    char whole[4200], target[4200];
    if (!real) *(void **)&real = dlsym(RTLD_NEXT, "renameat");
    if (fault_watch) fault_watch("renameat", -1, path_in(from, path, whole), path_in(folder, to, target));
    return real(from, path, folder, to);
}

int renameat2(int from, const char *path, int folder, const char *to, unsigned flags)
{
    static int (*real)(int, const char *, int, const char *, unsigned);
    if (!real) *(void **)&real = dlsym(RTLD_NEXT, "renameat2");
    if (fault_watch) fault_watch("renameat2", -1, path, to);
    return fault_shared_file_system ? (errno = EINVAL, -1) : real(from, path, folder, to, flags);
}

WATCHED(rename, (const char *path, const char *to), (path, to), to)
WATCHED(unlink, (const char *path), (path), NULL)
WATCHED(rmdir, (const char *path), (path), NULL)

static struct timespec time_of(double seconds)
{
    return (struct timespec){(time_t)seconds, (long)(1e9 * (seconds - floor(seconds)))};
}

int clock_gettime(clockid_t clock, struct timespec *t)
{
    static int (*real)(clockid_t, struct timespec *);
    if (!real) *(void **)&real = dlsym(RTLD_NEXT, "clock_gettime");
    const int result = real(clock, t);
    if (clock == CLOCK_PROCESS_CPUTIME_ID && fault_tick > 0.0) {
        static double now;
        *t = time_of(now += fault_tick);
        if (fault_watch) fault_watch("clock", -1, NULL, NULL);
    }
    if (clock == CLOCK_MONOTONIC && fault_monotonic_tick > 0.0) {
        static double now;
        *t = time_of(now += fault_monotonic_tick);
    }
    if (clock == CLOCK_MONOTONIC) t->tv_sec += fault_monotonic_clock;
    return result;
}

#ifdef __SANITIZE_ADDRESS__
bool fault_possible(fault kind)
{
    return kind != FAULT_MALLOC && kind != FAULT_FILE;
}
#else
bool fault_possible(fault kind)
{
    (void)kind;
    return true;
}

extern void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t), *__libc_realloc(void *, size_t);

/* libconfig does not check its own memory, which docs/guarantees.md says: its calls do not fail. */
static bool has_none(const void *caller)
{
    Dl_info of;
    const bool none = fails(FAULT_MALLOC) && !(dladdr(caller, &of) && strstr(of.dli_fname, "/libconfig"));
    if (none) errno = ENOMEM;
    return none;
}
#define HAS_NONE has_none(__builtin_extract_return_addr(__builtin_return_address(0)))

void *malloc(size_t n)
{
    return HAS_NONE ? NULL : __libc_malloc(n);
}

void *calloc(size_t n, size_t size)
{
    return HAS_NONE ? NULL : __libc_calloc(n, size);
}

void *realloc(void *old, size_t n)
{
    return HAS_NONE ? NULL : __libc_realloc(old, n);
}

/* libconfig's strdup; the library's would hide who calls. */
char *__strdup(const char *text);
char *__strdup(const char *text)
{
    const size_t n = strlen(text) + 1;
    char *copy = HAS_NONE ? NULL : __libc_malloc(n);
    return copy ? memcpy(copy, text, n) : NULL;
}
#endif
