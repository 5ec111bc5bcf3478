/* Vectors in the plane, and arrays. */
#ifndef DEM_VEC_H
#define DEM_VEC_H

#include <stdbool.h>
#include <stddef.h>

#include "core/status.h"

/* Two doubles as one value: + - * act on both. */
typedef double dem_vec __attribute__((vector_size(16)));

static inline dem_vec dem_vec_of(const double x[2])
{
    return (dem_vec){x[0], x[1]};
}

static inline double dem_dot(dem_vec a, dem_vec b)
{
    dem_vec p = a * b;
    return p[0] + p[1];
}

/* The normal turned clockwise by 90 degrees: the paper's s. */
static inline dem_vec dem_clockwise(dem_vec n)
{
    return (dem_vec){n[1], -n[0]};
}

/* Items of an array, from one to before another. */
typedef struct {
    size_t from, to;
} dem_stretch;

/* A new array of n items of this size, all bytes 0; NULL without memory. It begins with a line of the cache,
 * and lies on huge pages if it is large enough: gathers from small ones wait for the page table. */
void *dem_array(size_t n, size_t size);

/* Let the array that `array` points to, one of dem_array or NULL, hold `capacity` items, of which the first
 * `n` stay; false, and as it was, if memory is short. */
bool dem_array_grow(void *array, size_t size, size_t n, size_t capacity);

/* Room for n items in the array of `capacity` items that `array` points to, any but one of dem_array: it
 * grows to twice as many, and keeps those it has. Errors: RP_NO_MEMORY, with the name of what it is for. */
rp_status dem_room(const char *name, void *array, size_t size, size_t n, size_t *capacity);

/* sin and cos by + - * / alone, |angle| < 1: the same bits on every processor. */
void dem_sine_cosine(double angle, double *sine, double *cosine);

#endif
