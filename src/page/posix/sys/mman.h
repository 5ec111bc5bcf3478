#define madvise(at, size, as) (void)((void)(at), (void)(size), 0)
