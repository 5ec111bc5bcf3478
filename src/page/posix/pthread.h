/* Threads where there are none: one that is to be made is refused, and the only one locks for itself. */
typedef int pthread_t, pthread_mutex_t, pthread_cond_t;
#define pthread_create(thread, how, start, data)                                                             \
    ((void)(thread), (void)(how), (void)(start), (void)(data), 11)
#define pthread_join(thread, result)  (void)((void)(thread), (result))
#define PAGE_NO(lock)                 (void)(lock)
#define pthread_mutex_init(lock, as)  PAGE_NO(lock)
#define pthread_cond_init(turn, as)   PAGE_NO(turn)
#define pthread_mutex_destroy         PAGE_NO
#define pthread_mutex_lock            PAGE_NO
#define pthread_mutex_unlock          PAGE_NO
#define pthread_cond_destroy          PAGE_NO
#define pthread_cond_broadcast        PAGE_NO
#define pthread_cond_wait(turn, lock) PAGE_NO(turn)
