/* A second program of grains of several kinds, written from docs/physics.md: it shares no line with the
 * simulator, which tests compare it with. */
#ifndef TWIN_H
#define TWIN_H

#include <stdbool.h>

enum { TWIN_KINDS = 5, TWIN_WALLS = 3, TWIN_GRAINS = 12 };

/* What a kind, a wall, or two of them together say; NAN: nothing. E and nu with elastic bodies, k_n and k_s
 * without. */
typedef struct {
    double density, E, nu, k_n, k_s, restitution, mu, mu_roll;
} twin_values;

typedef struct {
    double x, y, r, vx, vy, omega, angle, m;
    int kind;
} twin_grain;

typedef struct {
    bool
        bodies; /* elastic bodies: elastic and mindlin; else linear springs along and across, gamma_s given */
    bool wide;  /* arm = "radius" */
    int rule;   /* 0: equal values hold; 1: the smaller; 2: the root of the product */
    double dt, g, gamma_s;
    int n, n_kinds; /* kind 0: grains without one, of which the scene speaks */
    twin_values kind[TWIN_KINDS], wall[TWIN_WALLS], pair[TWIN_KINDS][TWIN_KINDS + TWIN_WALLS];
    double line[TWIN_WALLS][4]; /* point, normal */
    twin_grain grain[TWIN_GRAINS];
} twin_scene;

/* Let the grains be where they are after some steps. */
void twin_run(twin_scene *scene, long steps);

#endif
