/* Threads where there are none: one that is to be made is refused, and the only one locks for itself. */
#ifndef PAGE_PTHREAD_H
#define PAGE_PTHREAD_H

typedef int pthread_t, pthread_mutex_t, pthread_cond_t;
#define PTHREAD_MUTEX_INITIALIZER 0
#define PTHREAD_COND_INITIALIZER  0
#define pthread_create(thread, attributes, start, data)                                                      \
    ((void)(thread), (void)(attributes), (void)(start), (void)(data), 11)
#define pthread_join(thread, result)   ((void)(thread), (void)(result), 0)
#define pthread_mutex_init(lock, with) ((void)(lock), (void)(with), 0)
#define pthread_mutex_destroy(lock)    ((void)(lock), 0)
#define pthread_mutex_lock(lock)       ((void)(lock), 0)
#define pthread_mutex_unlock(lock)     ((void)(lock), 0)
#define pthread_cond_init(turn, with)  ((void)(turn), (void)(with), 0)
#define pthread_cond_destroy(turn)     ((void)(turn), 0)
#define pthread_cond_wait(turn, lock)  ((void)(turn), (void)(lock), 0)
#define pthread_cond_signal(turn)      ((void)(turn), 0)
#define pthread_cond_broadcast(turn)   ((void)(turn), 0)

#endif
