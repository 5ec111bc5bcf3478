/* Failures of the C library to order, for this program and its libraries. */
#ifndef FAULTS_H
#define FAULTS_H

#include <stdbool.h>
#include <sys/types.h>
#include <time.h>

typedef enum { FAULT_FORK, FAULT_SYNC, FAULT_WRITE, FAULT_SEND, FAULT_MALLOC, FAULT_FILE, N_FAULTS } fault;

/* The call-th call from now on fails, in this process and in those that it forks; `for_good`: so do all that
 * follow. call = 0 takes the order back. */
void fault_order(fault kind, long call, bool for_good);

/* In shared memory, unless NULL: set when a call has failed, in whatever process. */
extern volatile bool *fault_seen;

/* Sanitizers have functions of their own for memory and files. */
bool fault_possible(fault kind);

/* By which the monotonic clock is wrong, s. */
extern time_t fault_monotonic_clock;

/* Unless 0: the processor time of this process, or monotonic time, s, is so much later at each look at it,
 * and nothing else moves it. */
extern double fault_tick, fault_monotonic_tick;

/* Called before each fsync (of a file), rename and renameat2 (from, to), unlink and rmdir (from); with a tick
 * of the clock also before each look at it ("clock"). */
extern void (*fault_watch)(const char *call, int file, const char *from, const char *to);

/* The process has taken in the signals that it got, and sleeps again, or is gone. */
bool fault_signals_seen(pid_t process);

/* From now on fault_watch sends a signal to this process before the n-th of the calls, of it or of a process
 * that it forks, that have `part` in the name of the call, the path of the file or its new one. Such
 * a process goes on when the signal has been seen. */
void fault_signal(int signal, const char *part, long n);

/* As on a file system of several machines (NFS), folders can't be exchanged. */
extern bool fault_shared_file_system;

#endif
