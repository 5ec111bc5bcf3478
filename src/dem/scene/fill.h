/* Filling: grains that are drawn and placed; fill.c, radii.c. */
#ifndef DEM_FILL_H
#define DEM_FILL_H

#include "dem/dem.h"

RP_C_BEGIN

/* Filling: grains at rest. Their radii follow a law, whose shares count grains, or the area or the mass that
 * they have; their places a pattern. */
#define DEM_RADIUS_LAWS(X)                                                                                   \
    X(DEM_RADII_GAUSS, gauss, "normal law, cut at radius_min and radius_max")                                \
    X(DEM_RADII_UNIFORM, uniform,                                                                            \
      "all radii alike, from radius_mean - sqrt(3) radius_width to "                                         \
      "radius_mean + sqrt(3) radius_width")                                                                  \
    X(DEM_RADII_LOGNORMAL, lognormal, "normal law of the logarithm, of this mean and standard deviation")    \
    X(DEM_RADII_TABLE, table, "those of radii = ( [r, share], ... )")
typedef enum { DEM_RADIUS_LAWS(DEM_ID) } dem_radius_law;
#define DEM_SHARES(X)                                                                                        \
    X(DEM_BY_NUMBER, number, "a share of the grains")                                                        \
    X(DEM_BY_AREA, area, "a share of the area that they cover")                                              \
    X(DEM_BY_MASS, mass, "a share of their mass")
typedef enum { DEM_SHARES(DEM_ID) } dem_share;
#define DEM_PATTERNS(X)                                                                                      \
    X(DEM_PATTERN_RANDOM, random, "one after the other where they overlap none, at random")                  \
    X(DEM_PATTERN_ROW, row,                                                                                  \
      "one row from x0 on, each on y0 and touching the last or `spacing` from it, as many as fit in W")      \
    X(DEM_PATTERN_LATTICE, lattice,                                                                          \
      "close-packed rows from (x0, y0) on, of the width of the largest grain or `spacing`, as many as fit "  \
      "in W and H")
typedef enum { DEM_PATTERNS(DEM_ID) } dem_pattern;

typedef struct {
    long N;      /* of a row or lattice -1: as many as there is room for */
    double W, H; /* grains lie inside (x0, x0 + W) x (y0, y0 + H) */
    double radius_mean, radius_width, radius_min, radius_max;
    double density;
    dem_shape shape;
    long seed, run; /* names of the random streams */
    double x0, y0;
    size_t n_walls; /* of a scene: grains touch none, and lie in the largest part of the region that they
                       leave */
    const dem_wall *walls;
    bool *cut; /* may be NULL; set where places beside that part were left out */
    dem_radius_law law;
    dem_share by;
    dem_pattern pattern;
    size_t n_radii; /* of the table: radius and share of each, borrowed */
    const double *radii;
    const char *kind; /* a name of these grains, "" or NULL for none */
    uint32_t of_kind; /* its number in the definition; 0: none */
    bool fixed;       /* grains that never move */
    double spacing;   /* of a row or lattice, from centre to centre; 0: of grains that touch */
    size_t n_corners; /* of a polygon that centres lie in, x and y of each, borrowed; 0: none */
    const double *corners;
    long number;      /* of the fill in a scene, from 0 on: each has streams of its own */
    size_t n_there;   /* grains that are there already, right before `grains` in their array */
    void *streams[2]; /* rp_random of radii and places that go on afterwards; NULL: those of seed and run */
} dem_fill;

/* Draw radii, and place the grains: `grains` has room for dem_fill_most(fill), *n are placed, fill->N where
 * that is not -1.
 * Errors: RP_BAD_INPUT (a number that is not finite, radii), RP_NO_RESULT (no room found in a million tries
 * for a grain, or in a row or lattice for N: how many have it), RP_NO_MEMORY. */
rp_status dem_fill_grains(const dem_fill *fill, dem_grain *grains, size_t *n);
size_t dem_fill_most(const dem_fill *fill);

/* The same with the radii that `grains` already have; those of the fill are not used. Large ones should come
 * first: they find no room among many small ones. */
rp_status dem_fill_place(const dem_fill *fill, dem_grain *grains);

RP_C_END

#endif
