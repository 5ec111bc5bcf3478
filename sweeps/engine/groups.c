/* Dimensionless groups of a pile; see groups.h. */
#include <math.h>

#include "sweeps/protocols/box.h"
#include "sweeps/protocols/protocols.h"
#include "sweeps/engine/groups.h"

/* Time for which a box fills, in units of t: several times that of a fall from its top. */
static const double fill_time = 100.0;

const sweep_group sweep_groups[SWEEP_N_GROUPS] = {
#define X(name, formula, logarithmic, lo, hi, meaning) {#name, formula, logarithmic, lo, hi, meaning},
    SWEEP_GROUPS(X)
#undef X
};

/* A parameter of the protocol beyond the box. */
static const void *member(const void *params, const char *name)
{
    return (const char *)params + rp_params_find(sweep_protocol_repose.schema, name)->offset;
}

static double diameter(const sweep_box *b)
{
    return 2.0 * b->radius_mean;
}

static double time_unit(const sweep_box *b)
{
    return sqrt(diameter(b) / b->g);
}

void sweep_groups_weight(const void *params, double *mass, double *gravity)
{
    const sweep_box *b = params;
    *mass = dem_mass(b->physics.shape, b->physics.density, b->radius_mean);
    *gravity = b->g;
}

static double damping_rate(const sweep_box *b)
{
    dem_scene scene;
    sweep_box_scene(b, &scene);
    return scene.def.material.gamma_n;
}

/* Friction of a wall over that of the grains; "auto" is theirs. */
static double friction_ratio(double wall, double mu)
{
    return wall < 0.0 ? 1.0 : wall / mu;
}

void sweep_groups_of(const void *params, double v[SWEEP_N_GROUPS])
{
    const sweep_box *b = params;
    const double d = diameter(b), t = time_unit(b);
    double mass, gravity;
    sweep_groups_weight(params, &mass, &gravity);
    const double weight = mass * gravity;
    const bool by_steps = *(const int *)member(params, "stop") != 0;
    const long pause = *(const long *)member(params, "relax_steps");
    v[SWEEP_GROUP_stiffness] = b->physics.k_n * pow(d, 1.5) / weight;
    v[SWEEP_GROUP_shear_stiffness] = b->physics.k_s * d / weight;
    v[SWEEP_GROUP_damping_rate] = damping_rate(b) * t;
    v[SWEEP_GROUP_wall_friction] = friction_ratio(b->mu_wall, b->physics.mu);
    v[SWEEP_GROUP_floor_friction] = friction_ratio(b->mu_floor, b->physics.mu);
    v[SWEEP_GROUP_pause] = by_steps ? (double)pause * b->physics.dt / t : INFINITY;
    v[SWEEP_GROUP_opening] = b->open * t / d;
    v[SWEEP_GROUP_friction] = b->physics.mu;
    v[SWEEP_GROUP_width] = b->W / d;
    v[SWEEP_GROUP_height] = b->H / d;
}

void sweep_groups_apply(const double v[SWEEP_N_GROUPS], void *params)
{
    sweep_box *b = params;
    const double d = diameter(b);
    if (isfinite(v[SWEEP_GROUP_damping_rate]))
        b->g = d * pow(damping_rate(b) / v[SWEEP_GROUP_damping_rate], 2.0);
    if (isfinite(v[SWEEP_GROUP_stiffness]))
        b->physics.density = b->physics.k_n * pow(d, 1.5) / (v[SWEEP_GROUP_stiffness] * b->g) /
                             dem_mass(b->physics.shape, 1.0, b->radius_mean);
    b->mu_wall = v[SWEEP_GROUP_wall_friction] * b->physics.mu;
    b->mu_floor = v[SWEEP_GROUP_floor_friction] * b->physics.mu;
    const double t = time_unit(b);
    if (isfinite(v[SWEEP_GROUP_opening])) b->open = v[SWEEP_GROUP_opening] * d / t;
    if (!isfinite(v[SWEEP_GROUP_pause])) return;
    b->fill_steps = lround(fill_time * t / b->physics.dt);
    *(long *)(void *)member(params, "relax_steps") = lround(v[SWEEP_GROUP_pause] * t / b->physics.dt);
}

double sweep_repose_step_limit(const void *params)
{
    const sweep_box *b = params;
    return sweep_box_step_limit(b, 2.0 * b->H, NULL);
}
