/* The equation of motion, of as many grains as a `plane` holds vectors and a `num` holds numbers. Every
 * method and every loop takes it from here: a new term is a line of dem_free_acceleration, and what it needs
 * a member of dem_equation. */
/* What the equation takes from a simulation. A loop reads it once. */
typedef struct {
    double dt;
    plane gravity;
} dem_equation;

INLINE dem_equation dem_equation_of(const dem_sim *sim)
{
    return (dem_equation){.dt = sim->def.dt, .gravity = plane_of(sim->gravity)};
}

/* Acceleration of a grain of velocity v that touches nothing. */
INLINE plane dem_free_acceleration(const dem_equation *e, plane v)
{
    (void)v;
    return e->gravity;
}

/* `force` is that of the contacts, `inverse_mass` a number of each grain. */
INLINE plane dem_acceleration(const dem_equation *e, plane force, num inverse_mass, plane v)
{
    return force * inverse_mass + dem_free_acceleration(e, v);
}

/* A step of leapfrog: v is of half a step before x, at the beginning and at the end. */
INLINE void dem_leap(const dem_equation *e, plane force, num inverse_mass, plane *x, plane *v)
{
    *v += e->dt * dem_acceleration(e, force, inverse_mass, *v);
    *x += e->dt * *v;
}

/* Change of a spin in time t. */
INLINE num dem_spin_gain(double t, num inverse_inertia, num torque)
{
    return t * inverse_inertia * torque;
}

/* A step of leapfrog of angle and spin. */
INLINE void dem_leap_spin(const dem_equation *e, num torque, num inverse_inertia, num *angle, num *omega)
{
    *omega += dem_spin_gain(e->dt, inverse_inertia, torque);
    *angle += e->dt * *omega;
}
