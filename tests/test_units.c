/* Labels of units have the powers that they say. A scene in other units is the same scene. Units that are
 * powers of 2 change no digit, so that runs agree to the bit; a number that stands in the code without a unit
 * shows. Hertz' law takes the fourth root of a length, and so exponents of lengths are multiples of 4, all
 * others even. */
#include "dem/setup/definition.h"
#include "dem/scene/text.h"
#include "dem/state/state.h"
#include "table/columns.h"
#include "tests/grains.h"
#include "tests/labels.h"

typedef struct {
    int length, mass, time;
} units;

/* A value of the unit length^l mass^m time^t in other units. */
static double to(units u, double value, double l, double m, double t)
{
    return ldexp(value, (int)lround(l * u.length + m * u.mass + t * u.time));
}

static void scale_material(units u, const dem_definition *def, dem_material *c)
{
    const char *power = strchr(dem_normal_descriptors[def->normal].k_n_unit, '^'); /* "dyn/cm^1.5" */
    const bool mindlin = def->tangential == DEM_MINDLIN;
    c->k_n = to(u, c->k_n, power ? 1.0 - atof(power + 1) : 0.0, 1.0, -2.0);
    if (dem_damps_by_rate(def)) c->gamma_n = to(u, c->gamma_n, 0.0, 0.0, -1.0);
    c->k_s = to(u, c->k_s, mindlin ? -1.0 : 0.0, 1.0, -2.0);
    if (!mindlin) c->gamma_s = to(u, c->gamma_s, 0.0, 0.0, -1.0);
    c->k_roll = to(u, c->k_roll, mindlin ? -1.0 : 0.0, 1.0, -2.0);
    if (!mindlin) c->gamma_roll = to(u, c->gamma_roll, 0.0, 0.0, -1.0);
}

static void scale_grain(units u, dem_grain *p)
{
    p->x = to(u, p->x, 1.0, 0.0, 0.0), p->y = to(u, p->y, 1.0, 0.0, 0.0), p->r = to(u, p->r, 1.0, 0.0, 0.0);
    p->m = to(u, p->m, 0.0, 1.0, 0.0);
    p->vx = to(u, p->vx, 1.0, 0.0, -1.0), p->vy = to(u, p->vy, 1.0, 0.0, -1.0);
    p->omega = to(u, p->omega, 0.0, 0.0, -1.0);
}

static dem_definition scaled(units u, const dem_definition *def, dem_grain *grains)
{
    dem_definition s = *def;
    s.grains = memcpy(grains, def->grains, def->n_grains * sizeof *grains);
    for (size_t i = 0; i < s.n_grains; i++) scale_grain(u, &grains[i]);
    scale_material(u, def, &s.material);
    for (size_t w = 0; w < s.n_walls; w++) {
        dem_wall *wall = &s.walls[w];
        scale_material(u, def, &wall->material);
        for (int c = 0; c < 2; c++) {
            wall->point[c] = to(u, wall->point[c], 1.0, 0.0, 0.0);
            wall->extent[c] = to(u, wall->extent[c], 1.0, 0.0, 0.0);
            wall->pivot[c] = to(u, wall->pivot[c], 1.0, 0.0, 0.0);
            wall->velocity[c] = to(u, wall->velocity[c], 1.0, 0.0, -1.0);
        }
        wall->open_speed = to(u, wall->open_speed, 1.0, 0.0, -1.0);
        wall->omega = to(u, wall->omega, 0.0, 0.0, -1.0);
    }
    for (int c = 0; c < 2; c++) s.gravity[c] = to(u, def->gravity[c], 1.0, 0.0, -2.0);
    s.dt = to(u, def->dt, 0.0, 0.0, 1.0);
    s.skin = to(u, def->skin, 1.0, 0.0, 0.0), s.ground.a = to(u, def->ground.a, 1.0, 0.0, 0.0);
    s.x_max = to(u, def->x_max, 1.0, 0.0, 0.0), s.y_min = to(u, def->y_min, 1.0, 0.0, 0.0);
    return s;
}

/* Is b what a is in other units? */
#define SAME(name, l, m, t) same &= to(u, a->name, l, m, t) == b->name

static bool same_states(units u, const dem_sim *one, const dem_sim *other)
{
    const size_t n = dem_count(one);
    if (n != dem_count(other)) return false;
    scoped dem_state *s = grains_states(one), *t = grains_states(other);
    bool same = true;
    for (const dem_state *a = s, *b = t; a < s + n; a++, b++) {
        same &= a->id == b->id && a->contacts == b->contacts && a->angle == b->angle;
        SAME(x, 1, 0, 0), SAME(y, 1, 0, 0), SAME(r, 1, 0, 0), SAME(m, 0, 1, 0);
        SAME(vx, 1, 0, -1), SAME(vy, 1, 0, -1), SAME(omega, 0, 0, -1);
        SAME(fx, 1, 1, -2), SAME(fy, 1, 1, -2), SAME(torque, 2, 1, -2);
    }
    return same;
}

static bool same_contacts(units u, const dem_sim *one, const dem_sim *other)
{
    size_t n[2];
    scoped dem_contact *first = grains_contacts(one, &n[0]), *second = grains_contacts(other, &n[1]);
    bool same = n[0] == n[1];
    for (const dem_contact *a = first, *b = second; same && a < first + n[0]; a++, b++) {
        same &= a->id_a == b->id_a && a->id_b == b->id_b && a->wall == b->wall && a->well == b->well;
        SAME(x, 1, 0, 0), SAME(y_b, 1, 0, 0), SAME(overlap, 1, 0, 0);
        SAME(normal_force, 1, 1, -2), SAME(shear_force, 1, 1, -2), SAME(shear_spring, 1, 0, 0);
        SAME(rolling_torque, 2, 1, -2), SAME(rolling_spring, 1, 0, 0);
    }
    return same;
}

static bool same_energies(units u, const dem_sim *one, const dem_sim *other)
{
    const dem_energy energy[] = {grains_energies(one), grains_energies(other)};
    dem_ledger ledger[2] = {{0}, {0}};
    dem_rest rest[2];
    const double middle = 1.0;
    bool same = dem_ledger_read(one, &ledger[0]) == dem_ledger_read(other, &ledger[1]);
    CHECK_OK(dem_rest_state(one, -INFINITY, middle, &rest[0]));
    CHECK_OK(dem_rest_state(other, -INFINITY, to(u, middle, 1, 0, 0), &rest[1]));
    for (const dem_energy *a = &energy[0], *b = &energy[1]; a; a = NULL)
        SAME(kinetic, 2, 1, -2), SAME(elastic, 2, 1, -2), SAME(gravity, 2, 1, -2), SAME(rotational, 2, 1, -2);
    for (const dem_ledger *a = &ledger[0], *b = &ledger[1]; a; a = NULL) {
#define X(channel, sign) SAME(channel, 2, 1, -2);
        DEM_LEDGER_LIST(X)
#undef X
        SAME(start, 2, 1, -2), SAME(at_walls, 2, 1, -2), SAME(turnover, 2, 1, -2), SAME(residual, 2, 1, -2);
    }
    for (const dem_rest *a = &rest[0], *b = &rest[1]; a; a = NULL) {
        same &= a->n == b->n && a->contact_number == b->contact_number;
        SAME(kinetic_energy, 2, 1, -2), SAME(net_force, 1, 1, -2);
    }
    return same && to(u, dem_largest_speed(one, 0.0, middle), 1, 0, -1) ==
                       dem_largest_speed(other, 0.0, to(u, middle, 1, 0, 0));
}

static bool same_work(units u, const dem_sim *one, const dem_sim *other)
{
    const dem_counts a = grains_counts(one), b = grains_counts(other);
    double force[2][2 * DEM_FEW_WALLS] = {{0.0}, {0.0}};
    bool same = true;
    grains_wall_forces(one, force[0]);
    grains_wall_forces(other, force[1]);
    for (int k = 0; k < 2 * DEM_FEW_WALLS; k++) same &= to(u, force[0][k], 1, 1, -2) == force[1][k];
    return same && a.pairs == b.pairs && a.contacts == b.contacts && a.wall_slots == b.wall_slots &&
           a.rebuilds == b.rebuilds && a.collisions == b.collisions && a.grain_steps == b.grain_steps &&
           a.iterations == b.iterations;
}

/* The rows of a table of a simulation, below their header. Free with rp_table_free. */
static rp_table rows_of(dem_table kind, const dem_sim *sim)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    rp_table t = {0};
    dem_write_columns(kind, sim, out);
    CHECK_OK(dem_write_rows(kind, sim, dem_step(sim), out));
    fclose(out);
    CHECK_OK(rp_table_parse("rows", text, &t));
    return t;
}

/* Each column changes with the units as its label says. */
static bool same_tables(units u, const dem_sim *one, const dem_sim *other)
{
    bool same = true;
    for (dem_table kind = DEM_TABLE_STATES; kind <= DEM_TABLE_WALLS; kind++) {
        RP_ENDS(rp_table_free) rp_table a = rows_of(kind, one);
        RP_ENDS(rp_table_free) rp_table b = rows_of(kind, other);
        CU_ASSERT_FATAL(a.n_rows == b.n_rows && a.n_columns == b.n_columns);
        const char *labels = rp_table_find_note(&a, "units");
        char label[128];
        for (size_t c = 0; c < a.n_columns; c++) {
            double p[3] = {0.0, 0.0, 0.0};
            CU_ASSERT(check_word(&labels, "\t", label) && label_powers(label, false, p));
            for (size_t row = 0; row < a.n_rows; row++) {
                const double v = strtod(rp_cell(&a, row, (int)c), NULL),
                             w = strtod(rp_cell(&b, row, (int)c), NULL);
                const bool equal = to(u, v, p[0], p[1], p[2]) == w;
                if (!equal && same)
                    fprintf(stderr, "units: %s [%s] = %g, in other units %g\n", a.names[c], label, v, w);
                same &= equal;
            }
        }
    }
    return same;
}

/* The scene in two other units, of smaller and larger numbers, by other kernels; a grain comes on the way. */
static void check(const dem_definition *def, size_t chunk, long steps, const dem_grain *extra)
{
    static const units others[] = {
        {12, 10, 4}, {-12, -14, -6}, {12, -28, 4}}; /* of the last k_n is below 1 */
    static const dem_kernel_choice kernel[] = {DEM_REFERENCE, DEM_BASELINE};
    scoped_sim *sim = grains_start_in_chunks(def, chunk);
    scoped dem_grain *grains = malloc(def->n_grains * sizeof *grains);
    dem_sim *other[2];
    for (int k = 0; k < 3; k++) {
        const units u = others[k];
        dem_definition own = scaled(u, def, grains);
        const double limit = to(u, dem_time_step_limit(def, NULL), 0, 0, 1);
        if (isfinite(limit)) CHECK_NEAR(dem_time_step_limit(&own, NULL) / limit, 1.0, 1e-14);
        if (k == 2) continue;
        own.kernel = kernel[k];
        other[k] = grains_start_in_chunks(&own, chunk);
    }
    bool touched = false;
    for (int part = 0; part < 3; part++) {
        if (part == 1 && extra) CHECK_OK(dem_add(sim, extra, NULL));
        CHECK_OK(dem_run(sim, steps));
        const dem_energy energy = grains_energies(sim);
        touched |= energy.elastic > 0.0 || sim->count.collisions > 0;
        for (int k = 0; k < 2; k++) {
            const units u = others[k];
            dem_grain p = extra ? *extra : (dem_grain){0};
            scale_grain(u, &p);
            if (part == 1 && extra) CHECK_OK(dem_add(other[k], &p, NULL));
            CHECK_OK(dem_run(other[k], steps));
            CU_ASSERT(same_states(u, sim, other[k]) && same_contacts(u, sim, other[k]));
            CU_ASSERT(same_energies(u, sim, other[k]) && same_work(u, sim, other[k]));
            CU_ASSERT(same_tables(u, sim, other[k]));
        }
    }
    CU_ASSERT(touched);
    for (int k = 0; k < 2; k++) dem_free(other[k]);
}

static const dem_grain EXTRA = {.x = 0.5, .y = 9.0, .r = 0.1, .m = 0.004, .vx = 3.0, .vy = -90.0};

/* Each law, with what may move, turn and open; alone and in chunks as a large pile. */
static void soft(void)
{
    for (int k = 0; k < 8; k++) {
        dem_grain extra = EXTRA;
        dem_definition def = grains_box(80, 2.0, 3, NULL);
        def.ledger = k % 2 == 0, def.rotation = k != 1;
        def.slip = k % 2 ? DEM_TOTAL : DEM_TRUNCATED;
        def.damping = k < 3 ? DEM_DAMPING_OUTSIDE : DEM_DAMPING_INSIDE;
        def.tension = k > 1;
        if (def.rotation) def.material.mu_roll = 0.1, extra.omega = 20.0;
        if (k == 4) def.material.mu = INFINITY;
        grains_law(&def, (dem_normal_law)(k % DEM_NORMAL_N), 1e5, 50.0);
        if (k > 5) {
            def.tangential = DEM_MINDLIN;
            def.material.k_s = def.material.k_roll = 0.9 * def.material.k_n;
            def.material.gamma_s = def.material.gamma_roll = 0.1;
        }
        for (int w = 0; w < 3; w++) def.walls[w].material = def.material;
        def.dt = 2e-5, def.walls[DEM_BOX_RIGHT].open_at_step = 900;
        def.x_max = 2.1, def.y_min = -0.3;
        if (k == 1) def.turn_per_step = 2e-4, def.turn_from_step = 500;
        if (k == 2) def.walls[DEM_BOX_LEFT].velocity[0] = 4.0, def.walls[DEM_BOX_FLOOR].omega = 0.3;
        if (k == 3) def.box_turn_per_step = 1e-4, def.turn_from_step = 300;
        if (k == 4) def.walls[DEM_BOX_LEFT].extent[0] = -2.0, def.walls[DEM_BOX_LEFT].extent[1] = 1.0;
        if (k == 5) def.skin = 0.03;
        check(&def, k == 1 || k == 5 ? 64 : 0, check_fast() ? 150 : 700, k == 3 ? NULL : &extra);
    }
}

static void hard(void)
{
    for (int k = 0; k < 2; k++) {
        dem_grain *grains;
        dem_definition def = grains_box(60, 2.0, 4, &grains);
        for (int i = 0; i < 60; i++) grains[i].vx = 90.0 * sin(3.0 * i), grains[i].vy = 90.0 * cos(7.0 * i);
        def.hard = (dem_hard){.on = true, .restitution = 0.7, .mu = 0.3};
        def.tension = false, def.ledger = true, def.rotation = k;
        if (k) grains[7].omega = 300.0, def.walls[DEM_BOX_LEFT].velocity[0] = 5.0;
        def.x_max = 3.0;
        def.walls[DEM_BOX_RIGHT].extent[0] = -1.0, def.walls[DEM_BOX_RIGHT].extent[1] = 9.0;
        def.dt = 2e-5;
        check(&def, 0, check_fast() ? 150 : 700, &EXTRA);
    }
}

/* Gear's predictor-corrector; wells of the ground. */
static void gear_and_ground(void)
{
    for (int k = 0; k < 4; k++) {
        dem_definition def = grains_box(40, 2.0, 5, NULL);
        def.dt = 1e-5;
        if (k == 0) def.integrator = DEM_GEAR5;
        if (k > 0) {
            def.tangential = DEM_SLIP_ROLL, def.material.gamma_s = 40.0;
            def.ground = (dem_ground){.wall = 1, .mu_static = 0.4, .a = 1e-3, .set = (dem_well_set)(k - 1)};
            def.rotation = k == 2, def.ledger = true;
        }
        for (int w = 0; w < 3; w++) def.walls[w].material = def.material;
        check(&def, 0, check_fast() ? 300 : 1500, &EXTRA);
    }
}

static void implicit(void)
{
    for (int k = 0; k < 3; k++) {
        enum { N = 6 };
        dem_grain grains[N];
        grains_gas(N, grains);
        grains[5].fixed = k == 1, grains[5].vx *= k != 1, grains[5].vy *= k != 1;
        dem_definition def = grains_disks(N, grains, 1e4);
        def.material.gamma_n = 3.0, def.skin = 0.4, def.dt = 0.01;
        if (k > 0) def.tangential = DEM_SLIP_ROLL, def.material.mu = 0.3, def.material.gamma_s = 5.0;
        if (k == 2) def.implicit = (dem_implicit_solver){DEM_SOLVER_SOR, 0.7, 1e-12, 3000};
        dem_box_walls(&def, 3.6, &def.material);
        if (k == 2) def.ground = (dem_ground){.wall = 1, .mu_static = 0.4, .a = 0.01, .set = DEM_WELL_TOUCH};
        def.ledger = true;
        check(&def, 0, 400, NULL);
    }
}

/* The three labels of a unit have the same powers of length, mass and time, and numbers change by these. */
static void labels(void)
{
    const double d = 0.2, g = 981.0,
                 one[][3] = {
                     [RP_SI] = {100.0, 1000.0, 1.0}, [RP_SIGMA] = {d, M_PI / 6.0 * d * d * d, sqrt(d / g)}};
    for (size_t k = 0; rp_unit_label(k); k++) {
        const char *cgs = rp_unit_label(k);
        double p[3], q[3];
        CHECK_OR_SAY(label_powers(cgs, false, p), "unit %s: a word that is no unit", cgs);
        for (rp_units system = RP_SI; system <= RP_SIGMA; system++) {
            CHECK_OR_SAY(label_powers(rp_unit(system, cgs), system == RP_SIGMA, q) &&
                             memcmp(p, q, sizeof p) == 0,
                         "unit %s: in other units %s", cgs, rp_unit(system, cgs));
            double factor = 1.0;
            for (int i = 0; i < 3; i++) factor *= pow(one[system][i], p[i]);
            CHECK_OR_SAY(fabs(rp_units_value(system, cgs, 2.385) * factor / 2.385 - 1.0) < 1e-11,
                         "unit %s: 2.385 is %g %s", cgs, rp_units_value(system, cgs, 2.385),
                         rp_unit(system, cgs)); /* 12 digits */
        }
    }
}

/* Texts that are open together have each its own defaults, labels and messages. */
static void side_by_side(void)
{
    static const char *const words[] = {"cgs", "si"}, *const limit[] = {"cm/s", "m/s"},
                             *const label[] = {"cm", "m"};
    dem_text text[2];
    dem_scene scene[2];
    dem_sim *sim[2] = {NULL, NULL};
    char bytes[2][256];
    for (int k = 0; k < 2; k++) {
        snprintf(bytes[k], sizeof bytes[k],
                 "units = \"%s\"; dt = %g; particles = ( { x = 0.0; y = 0.0; r = %g; } );", words[k], 5e-5,
                 k ? 0.001 : 0.1);
        CHECK_OK(dem_text_open(words[k], bytes[k], NULL, &text[k]));
    }
    for (int k = 0; k < 2; k++) {
        CHECK_OK(dem_text_scene(&text[k], &scene[k]));
        CHECK_OK(dem_scene_start(&scene[k], &sim[k]));
    }
    CHECK_NEAR(scene[0].def.gravity[1], -981.0, 0.0);
    CHECK_NEAR(scene[1].def.gravity[1], -9.81, 0.0);
    CHECK_NEAR(scene[0].laws.physics.density / scene[1].laws.physics.density, 1e-3, 1e-18);
    for (int k = 0; k < 2; k++) {
        RP_ENDS(rp_table_free) rp_table t = rows_of(DEM_TABLE_STATES, sim[k]);
        char unit[32];
        rp_column_unit(&t, rp_table_column(&t, "x"), unit);
        CU_ASSERT_STRING_EQUAL(unit, label[k]);
        scene[k].def.grains = scene[k].grains;
        CHECK_FAILS(dem_refuse_step(&scene[k].def, 1e-9, "this"), RP_BAD_INPUT, limit[k]);
    }
    for (int k = 0; k < 2; k++) dem_free(sim[k]), dem_scene_free(&scene[k]), dem_text_close(&text[k]);
}

CHECK_SUITE(units, "units", labels, soft, hard, gear_and_ground, implicit, side_by_side)
