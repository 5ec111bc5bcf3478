/* Arrays, and sines of small angles. */
#include "dem/state/vec.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

void *dem_array(size_t n, size_t size)
{
    enum { LINE = 64, PAGE = 1 << 21 };
    const size_t bytes = (n * size + LINE - 1) / LINE * LINE;
    char *array = aligned_alloc(LINE, bytes);
    if (!array) return NULL;
    const size_t skip = (PAGE - (uintptr_t)array % PAGE) % PAGE;
    if (bytes >= skip + PAGE) madvise(array + skip, (bytes - skip) / PAGE * PAGE, MADV_HUGEPAGE);
    return memset(array, 0, bytes);
}

bool dem_array_grow(void *array, size_t size, size_t n, size_t capacity)
{
    void *old = *(void **)array, *more = dem_array(capacity, size);
    if (!more) return false;
    if (old) memcpy(more, old, size * n);
    free(old);
    *(void **)array = more;
    return true;
}

rp_status dem_room(const char *name, void *array, size_t size, size_t n, size_t *capacity)
{
    if (n <= *capacity) return RP_OK;
    void *more = realloc(*(void **)array, 2 * n * size);
    if (!more) return rp_fail(RP_NO_MEMORY, "%s: out of memory", name);
    *(void **)array = more;
    *capacity = 2 * n;
    return RP_OK;
}

void dem_sine_cosine(double angle, double *sine, double *cosine)
{
    double term = 1.0, sums[2] = {0.0, 0.0};
    for (int k = 0; k < 24; k++) {
        sums[k % 2] += k % 4 < 2 ? term : -term;
        term *= angle / (k + 1);
    }
    *cosine = sums[0];
    *sine = sums[1];
}
