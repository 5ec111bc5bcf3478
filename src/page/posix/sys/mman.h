#define MADV_HUGEPAGE         0
#define madvise(at, size, as) ((void)(at), (void)(size), 0)
