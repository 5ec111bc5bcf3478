/* Walls that move, and walls of many sides: closed forms, changes of frame, corners, and equal bits. */
#include "core/random.h"
#include "dem/setup/definition.h"
#include "dem/forces/forces.h"
#include "tests/grains.h"
#include "tests/program.h"

static const double R = 0.1, M = 0.0042;
static rp_random stream;

/* ---- closed forms ---- */

/* A piston that hits a grain at rest gives it V (1 + e). No grain moves until then: the piston's own way must
 * bring it into the neighbour list. Soft: e of the collision apart from the simulator, to the error of a
 * step, dt/contact time = 1e-3. Hard: to round-off. */
static void piston(void)
{
    static const double V = 80.0;
    for (int hard = 0; hard < 2; hard++) {
        dem_grain grain = {.x = 3.0, .y = 0.7, .r = R, .m = M};
        dem_definition def = grains_afloat(1, &grain);
        def.normal = DEM_LINEAR, def.material.k_n = 1e4, def.material.gamma_n = 300.0;
        def.dt = hard ? 5e-5 : 2e-6;
        def.tension = !hard;
        if (hard) def.hard = (dem_hard){true, 0.7, 0.0};
        def.ledger = true;
        def.n_walls = 1;
        def.walls[0] = grains_line(0.0, 0.0, 1.0, 0.0, &def.material);
        def.walls[0].velocity[0] = V;
        dem_collision_result impact = {.restitution = 0.7};
        if (!hard)
            CHECK_OK(dem_collision(&(dem_head_on){def.normal, def.tension, 1e4, 300.0, M, V}, &impact));
        scoped_sim *sim =
            grains_after(&def, lround(3.3 / V / def.dt)); /* the gap, 2.9, and twice the contact time */
        const double v = V * (1.0 + impact.restitution), tolerance = hard ? 1e-12 : 2e-3;
        CHECK_NEAR(grains_state_of_one(sim).vx, v, tolerance * v);
        CHECK_NEAR(grains_state_of_one(sim).vy, 0.0, 0.0);
        /* the piston's work is V times the impulse; the rest is lost */
        const dem_ledger l = grains_ledger(sim);
        CHECK_NEAR(l.wall_work, M * v * V, 2.0 * tolerance * M * v * V);
        CHECK_NEAR(hard ? l.hard : l.normal_damping, M * v * (V - 0.5 * v), 4.0 * tolerance * M * v * V);
        CHECK_NEAR(l.residual, 0.0, 1e-13 * l.turnover);
    }
}

/* A floor that slides at V drags a grain: v = mu g t until V. The spring needs mu N/k_s of displacement to
 * reach the Coulomb force, during which the force is half of that in the mean. */
static void sliding_floor(void)
{
    static const double V = 20.0, MU = 0.3, G = 981.0, K_S = 1e5;
    const double reached = V / (MU * G), loading = MU * M * G / K_S / V;
    dem_grain grain = {.r = R, .m = M};
    dem_definition def = dem_definition_default();
    def.material = (dem_material){.k_n = 1e6, .gamma_n = 500.0, .k_s = K_S, .gamma_s = 200.0, .mu = MU};
    def.damping = DEM_DAMPING_INSIDE;
    grains_on_floor(&def, 1, &grain);
    grain.y = R - pow(M * G / 1e6, 2.0 / 3.0);
    def.walls[0].velocity[0] = V;
    scoped_sim *sim = grains_after(&def, lround(0.8 * reached / def.dt));
    dem_state s = grains_state_of_one(sim);
    CHECK_NEAR(s.vx, MU * G * (dem_time(sim) - 0.5 * loading), MU * G * (0.5 * loading + def.dt));
    CHECK_NEAR(s.y, grain.y, 1e-9);
    CHECK_OK(dem_run(sim, lround(2.0 * reached / def.dt)));
    CHECK_NEAR(grains_state_of_one(sim).vx, V, 1e-4 * V); /* exp(-gamma_s t/2) = 1e-6 of what it swings */
}

/* ---- largest speeds ---- */

/* The largest speed of a wall: its velocity, and of its turn that of a segment's farther end, or of a line
 * beside the farthest grain, whichever it is. */
static void speed_of_a_wall(void)
{
    static const double PIVOT[2] = {0.4, -0.3}, N[2] = {0.6, 0.8}, T[2] = {0.8, -0.6};
    /* ends in the segment's own coordinate; its point is 3 N + T from the pivot: distances of 5 and less */
    static const double ends[][2] = {{-5.0, 1.0}, {-1.0, 3.0}, {-INFINITY, 3.0}, {-5.0, INFINITY}};
    for (size_t far = 0; far < 3; far++)
        for (size_t e = 0; e < 4; e++) {
            dem_grain grains[3] = {{.x = 0.5, .y = 0.1}, {.x = 1.0, .y = 0.5}, {.x = -0.2, .y = 0.9}};
            grains[far] = (dem_grain){.x = PIVOT[0] + 5.0, .y = PIVOT[1] - 12.0};
            dem_definition def = grains_floored(3, grains);
            dem_wall *w = &def.walls[0];
            CU_ASSERT(dem_wall_speed(&def, w) == 0.0);
            w->velocity[0] = 3.0, w->velocity[1] = -4.0;
            CHECK_NEAR(dem_wall_speed(&def, w), 5.0, 1e-14);
            w->omega = -2.0;
            for (int a = 0; a < 2; a++) {
                w->pivot[a] = PIVOT[a];
                w->point[a] = PIVOT[a] + 3.0 * N[a] + T[a];
                w->direction[a] = N[a];
                w->extent[a] = ends[e][a];
            }
            CHECK_NEAR(dem_wall_speed(&def, w), 5.0 + 2.0 * (e < 2 ? 5.0 : 13.0), 1e-13);
            w->velocity[0] = w->velocity[1] = w->omega = 0.0, def.box_turn_per_step = 2.0 * def.dt;
            w->point[0] -= PIVOT[0], w->point[1] -= PIVOT[1]; /* the box turns about the origin */
            grains[far].x -= PIVOT[0], grains[far].y -= PIVOT[1];
            CHECK_NEAR(dem_wall_speed(&def, w), 2.0 * (e < 2 ? 5.0 : 13.0), 1e-13);
        }
}

/* What a wall keeps of its definition, and what the list keeps of moving walls, typed out: the farther end's
 * distance from the pivot; the displacement of a step that turns by a, (1 - cos a, sin a) over dt; the ways
 * of the fastest wall, of a line beside the farthest grain. */
static void lines_of_walls(void)
{
    static const double DT = 0x1p-10, FAR = 7.0, SKIN = 0.25;
    dem_grain grain = {.x = 9.0, .y = 9.0, .r = R, .m = M};
    dem_definition def = grains_afloat(1, &grain);
    def.material = (dem_material){.k_n = 1e-9, .k_s = 1e-9};
    def.dt = DT, def.skin = SKIN, def.n_walls = 5;
    /* the tangent is (0.8, -0.6): ends at (0.8, 0.8) and (2.4, -0.4), or at (0, 1.4) and (1.6, 0.2) */
    static const double extent[5][2] = {
        {-0.5, 1.5}, {-1.5, 0.5}, {-INFINITY, INFINITY}, {-0.5, INFINITY}, {-0.5, 1.5}};
    static const double reach[4] = {4.85, 2.93, INFINITY, INFINITY}; /* squares */
    for (int w = 0; w < 5; w++) {
        def.walls[w] = grains_line(1.2, 0.5, 0.6, 0.8, &def.material);
        memcpy(def.walls[w].extent, extent[w], sizeof extent[w]);
        if (w == 4) continue;
        def.walls[w].pivot[0] = 0.2, def.walls[w].pivot[1] = -0.3;
        def.walls[w].omega = w % 2 ? -3.0 : 2.0;
    }
    def.walls[0].velocity[0] = 30.0, def.walls[0].velocity[1] = -40.0;
    scoped_sim *sim = grains_start(&def);
    CU_ASSERT_EQUAL(sim->walls.n_moving, 4);
    for (int w = 0; w < 5; w++) {
        const dem_wall_line *l = &sim->walls.line[w];
        CU_ASSERT(l->moves == (w < 4) && !l->plain);
        if (w == 4) continue;
        const double angle = (w % 2 ? 3.0 : -2.0) * DT; /* clockwise */
        CHECK_PAIRS(1e-15, {isinf(reach[w]) ? !isinf(l->reach) : l->reach - sqrt(reach[w]), 0.0},
                    {l->turn_of_step[0], cos(angle)}, {l->turn_of_step[1], sin(angle)},
                    {l->swing[0], 2.0 * sin(0.5 * angle) * sin(0.5 * angle) / DT});
        CHECK_NEAR(l->swing[1], sin(angle) / DT, 1e-12);
        CHECK_NEAR(l->drift[0] + l->drift[1], w ? 0.0 : -10.0, 1e-15);
    }
    const double lines = 3.0 * (FAR + sqrt(0.13) + SKIN), first = 50.0 + 2.0 * sqrt(4.85);
    CHECK_OK(dem_run(sim, 2));
    CHECK_NEAR(sim->walls.swept, 2.0 * sim->walls.stride, 1e-14);
    for (int slow = 0; slow < 2; slow++) {
        if (slow) sim->walls.line[0].drift = (dem_vec){0.0, 0.0};
        dem_walls_limit(sim, FAR);
        CHECK_NEAR(sim->walls.stride, DT * (slow ? lines : first), 1e-14);
        CHECK_NEAR(sim->walls.margin, 0.5 * SKIN + sim->walls.stride, 1e-15);
        CU_ASSERT(sim->walls.swept == 0.0 && sim->walls.sweep_limit == 0.5 * SKIN);
    }
    sim->walls.n_moving = 0;
    dem_walls_limit(sim, FAR);
    CHECK_NEAR(sim->walls.sweep_limit, 0.5 * SKIN / (FAR + SKIN), 1e-16);
}

/* A segment that moves carries grains as high as its higher end, and gives them its speed, in any order of
 * the walls and in any direction of gravity. The lowest position is of a line, unless that moves or is
 * upright, or of a grain. */
static void height_of_a_wall(void)
{
    static const double DOWN[2] = {0.6, -0.8}, ASIDE[2] = {0.8, 0.6}, G = 981.0, SPEED = 7.0;
    for (int k = 0; k < 8; k++) {
        const bool first = k % 2, upper = k / 2 % 2, grain_lowest = k / 4;
        const double low = 2.0, lowest = grain_lowest ? 3.0 : low; /* depths below the origin */
        dem_grain grains[2] = {{.x = 0.0},
                               {.x = DOWN[0] * lowest * grain_lowest, .y = DOWN[1] * lowest * grain_lowest}};
        dem_definition def = grains_floored(2, grains);
        def.n_walls = 3;
        for (int a = 0; a < 2; a++) def.gravity[a] = G * DOWN[a];
        dem_wall *lift = &def.walls[first ? 0 : 2];
        def.walls[first ? 2 : 0] =
            grains_line(low * DOWN[0], low * DOWN[1], -DOWN[0], -DOWN[1], &def.material);
        def.walls[1] = grains_line(9.0 * DOWN[0], 9.0 * DOWN[1], ASIDE[0], ASIDE[1], &def.material);
        /* upright, so that its own point has no height; the tangent, clockwise of ASIDE, is DOWN */
        *lift = grains_line(DOWN[0], DOWN[1], upper ? ASIDE[0] : -ASIDE[0], upper ? ASIDE[1] : -ASIDE[1],
                            &def.material);
        lift->extent[0] = upper ? -4.0 : -0.5, lift->extent[1] = upper ? 0.5 : 4.0;
        lift->velocity[0] = SPEED;
        CHECK_NEAR(dem_impact_speed(&def), 2.0 * SPEED + sqrt(2.0 * G * (3.0 + lowest)), 1e-11);
        lift->extent[upper] = upper ? INFINITY : -INFINITY; /* an end that has no height */
        grains[0].vx = -3.0 * SPEED, grains[0].vy = 4.0 * SPEED;
        CHECK_NEAR(dem_impact_speed(&def), 10.0 * SPEED + sqrt(2.0 * G * (3.0 + lowest)), 1e-11);
    }
}

/* ---- frames ---- */

/* In a frame that moves with the walls, they are at rest and the grains move: two grains between a whole line
 * and a turning segment, with friction and spin. Positions agree to round-off times the collisions' growth.
 */
static void galilean(void)
{
    static const double V[2] = {31.0, -17.0};
    dem_state s[2][2];
    dem_ledger l[2];
    double t = 0.0;
    for (int moving = 0; moving < 2; moving++) {
        dem_grain grains[2] = {{.x = 0.5, .y = 0.25, .r = R, .m = M, .vx = 20.0, .vy = -40.0, .omega = 30.0},
                               {.x = 0.3, .y = 0.6, .r = 0.08, .m = 0.003, .vx = 5.0, .vy = -60.0}};
        dem_definition def = dem_definition_default();
        def.rotation = def.ledger = true;
        grains_on_floor(&def, 2, grains);
        def.n_walls = 2;
        def.walls[1] = grains_line(0.9, 0.5, -1.0, 0.0, &def.material);
        def.walls[1].extent[0] = -0.6, def.walls[1].extent[1] = 0.5;
        def.walls[1].omega = 9.0;
        def.walls[1].pivot[0] = 1.4, def.walls[1].pivot[1] = 0.1;
        for (int w = 0; w < 2 && moving; w++)
            for (int a = 0; a < 2; a++) def.walls[w].velocity[a] = V[a];
        for (int i = 0; i < 2 && moving; i++) grains[i].vx += V[0], grains[i].vy += V[1];
        scoped_sim *sim = grains_start(&def);
        grains_run(sim, 1200, s[moving]);
        CU_ASSERT(s[moving][0].omega != 30.0 && s[moving][1].omega != 0.0); /* both have touched */
        l[moving] = grains_ledger(sim);
        t = dem_time(sim);
    }
    /* losses are those of relative motion; the walls' work is not */
    CHECK_NEAR(l[1].sliding, l[0].sliding, 1e-8 * l[0].sliding);
    CHECK_NEAR(l[1].normal_damping, l[0].normal_damping, 1e-8 * l[0].normal_damping);
    CU_ASSERT(l[0].sliding > 0.0 && l[0].normal_damping > 0.0 && l[1].wall_work != l[0].wall_work);
    for (int i = 0; i < 2; i++) {
        CHECK_PAIRS(1e-10, {s[1][i].x, s[0][i].x + V[0] * t}, {s[1][i].y, s[0][i].y + V[1] * t});
        CHECK_NEAR(s[1][i].omega, s[0][i].omega, 1e-7);
    }
}

/* A box that turns about the origin, and walls that each turn about it: the same grains, to round-off. */
static void turning_box(void)
{
    static const double TURN = 2e-5; /* a step, clockwise */
    dem_state s[2][9];
    for (int own = 0; own < 2; own++) {
        dem_definition def = grains_box(9, 1.0, 5, NULL);
        def.rotation = true;
        def.material.mu_roll = 0.2, def.material.k_roll = 1e4, def.material.gamma_roll = 30.0;
        for (size_t w = 0; w < def.n_walls; w++) def.walls[w].material = def.material;
        def.walls[DEM_BOX_FLOOR].open_at_step = 100000; /* a wall that opens later turns as well */
        for (size_t w = 0; w < def.n_walls && own; w++) def.walls[w].omega = -TURN / def.dt;
        if (!own) def.box_turn_per_step = TURN;
        scoped_sim *sim = grains_start(&def);
        grains_run(sim, 1500, s[own]);
    }
    for (int i = 0; i < 9; i++) {
        CHECK_PAIRS(1e-9, {s[1][i].x, s[0][i].x}, {s[1][i].y, s[0][i].y});
        CHECK_NEAR(s[1][i].angle, s[0][i].angle, 1e-7);
    }
}

/* The list is built anew as the box begins to turn, and not again until the walls may have come near. */
static void list_of_a_turning_box(void)
{
    dem_grain grain = {.x = 1.0, .y = 1.0, .r = R, .m = M};
    dem_definition def = grains_floored(1, &grain);
    def.gravity[1] = 0.0;
    def.box_turn_per_step = 1e-5, def.turn_from_step = 10;
    scoped_sim *sim = grains_after(&def, 10);
    const long before = sim->count.rebuilds;
    CU_ASSERT(sim->walls.angle == 0.0);
    CHECK_OK(dem_run(sim, 1));
    CU_ASSERT(sim->walls.angle == 1e-5 && sim->count.rebuilds == before + 1);
    CHECK_OK(dem_run(sim, 100));
    CU_ASSERT(sim->count.rebuilds == before + 1);
    CHECK_OK(dem_run(sim, 5000));
    CU_ASSERT(sim->count.rebuilds > before + 1 && sim->count.rebuilds < before + 20);
}

/* A wall that moves by itself and then back, at a grain that it does not touch, is where it was. */
static void where_it_is(void)
{
    dem_grain grain = {.x = -5.0, .y = 5.0, .r = R, .m = M};
    dem_definition def = grains_floored(1, &grain);
    def.gravity[1] = 0.0;
    def.walls[0].velocity[0] = 3.0, def.walls[0].velocity[1] = -2.0;
    def.walls[0].pivot[0] = 1.0, def.walls[0].omega = 0.5 * M_PI / (1000 * def.dt);
    scoped_sim *sim = grains_after(&def, 1000);
    /* the origin was at the pivot's left, and is below it after a quarter turn */
    const dem_wall_line *l = &sim->walls.line[0];
    CHECK_PAIRS(1e-12, {l->point[0], 1.0 + 3.0 * dem_time(sim)}, {l->point[1], -1.0 - 2.0 * dem_time(sim)},
                {l->direction[0], -1.0});
}

/* ---- drums: ledger, kernels, snapshots ---- */

static const char *const DRUM =
    "rotation = true; dt = 1.5e-5; steps = 1500; tangential = { law = \"spring\"; mu = 0.4; };\n"
    "normal = { law = \"linear\"; k_n = 1.0e5; tension = false; }; rolling = { mu = 0.02; };\n"
    "walls = ( { circle = [0.3, 0.2, 1.0]; omega = 8.0; velocity = [7.0, -4.0]; },\n"
    "          { polygon = ( [0.2, 0.75], [0.6, 0.7], [0.4, 0.95] ); omega = -5.0; pivot = [0.4, 0.8]; } );\n"
    "fill = { N = 50; W = 1.2; H = 1.0; x0 = -0.3; y0 = -0.5; radius_mean = 0.05; radius_min = 0.04;\n"
    "radius_max = 0.06; };\n";

static dem_sim *drum(dem_kernel_choice kernel, bool ledger, dem_integrator integrator, long steps)
{
    scoped_scene scene = {0};
    dem_sim *sim = NULL;
    CHECK_OK(grains_read(DRUM, NULL, &scene));
    scene.def.kernel = kernel, scene.def.ledger = ledger, scene.def.integrator = integrator;
    if (integrator == DEM_GEAR5) scene.def.rotation = false, scene.def.material.mu_roll = 0.0;
    for (size_t w = 0; w < scene.def.n_walls && integrator == DEM_GEAR5; w++)
        ((dem_wall *)dem_walls_of(&scene.def))[w].material.mu_roll = 0.0;
    CU_ASSERT_EQUAL(scene.def.n_walls, 67);
    CHECK_OK(dem_scene_start(&scene, &sim));
    CU_ASSERT_PTR_NOT_NULL_FATAL(sim);
    CHECK_OK(dem_run(sim, steps));
    return sim;
}

/* Energy and the sum of the channels agree to round-off, with work of the walls. */
static void drum_ledger(void)
{
    for (int k = 0; k < 2; k++) {
        scoped_sim *sim = drum(DEM_FAST, true, k ? DEM_GEAR5 : DEM_VERLET, 1500);
        const dem_ledger l = grains_ledger(sim);
        CHECK_NEAR(l.residual, 0.0, 1e-13 * l.turnover);
        CU_ASSERT(fabs(l.wall_work) > 1e-4 * l.turnover && l.sliding > 0.0 && l.normal_damping > 0.0);
    }
}

static void drum_kernels(void)
{
    scoped_sim *reference = drum(DEM_REFERENCE, false, DEM_VERLET, 1500);
    GRAINS_EACH_KERNEL (k, DEM_FAST) {
        scoped_sim *sim = drum(k, false, DEM_VERLET, 1500);
        CU_ASSERT(grains_same_bits(reference, sim));
    }
}

/* A clone, and the simulation that the bytes of a snapshot make, continue as the original. */
static void drum_snapshot(void)
{
    for (int ledger = 0; ledger < 2; ledger++) {
        dem_sim *sim = drum(DEM_FAST, ledger, DEM_VERLET, 6000), *clone;
        int touching = 0;
        for (uint32_t id = 1; id <= dem_count(sim); id++) touching += dem_contact_count(sim, id);
        CU_ASSERT(touching > 5);
        CHECK_OK(dem_clone(sim, &clone));
        double forces[3][2 * 67];
        dem_sim *const all[] = {sim, clone, grains_kept(sim)};
        for (int k = 0; k < 3; k++) {
            CHECK_OK(dem_run(all[k], 800));
            grains_wall_forces(all[k], forces[k]);
            CU_ASSERT(grains_same_bits(sim, all[k]) && memcmp(forces[0], forces[k], sizeof forces[0]) == 0);
        }
        for (int k = 0; k < 3; k++) dem_free(all[k]);
    }
}

/* ---- corners ---- */

/* Grains stay inside of a triangle, a concave star and a drum, that turn fast about points inside. */
static void inside(void)
{
    static const char *const shapes[] = {"circle = [0.0, 0.0, 1.6]; sides = 3; omega = 6.0;",
                                         "polygon = ( [0.0, -1.4], [0.5, -0.4], [1.6, -0.2], [0.7, 0.5], "
                                         "[0.8, 1.5], [0.0, 0.9], [-0.8, 1.5],\n"
                                         "[-0.7, 0.5], [-1.6, -0.2], [-0.5, -0.4] ); omega = -5.0;",
                                         "circle = [0.0, 0.0, 0.9]; sides = 400; omega = 10.0;"};
    for (int k = 0; k < 3; k++) {
        scoped_sim *sim = grains_after_text(
            12000,
            "rotation = true; dt = 2e-5; steps = 12000; tangential = { law = \"spring\"; mu = 0.3; };\n"
            "walls = ( { %s } ); fill = { N = 24; W = 1.0; H = 0.9; x0 = -0.5; y0 = -0.35; radius_mean "
            "= 0.06;\n"
            "radius_min = 0.05; radius_max = 0.07; };\n",
            shapes[k]);
        scoped dem_state *s = grains_states(sim);
        for (size_t i = 0; i < dem_count(sim); i++) {
            int crossings = 0; /* of a ray to the right with the sides */
            for (size_t w = 0; w < sim->def.n_walls; w++) {
                const dem_vec a = sim->walls.line[w].point,
                              b = sim->walls.line[(w + 1) % sim->def.n_walls].point;
                crossings += (a[1] > s[i].y) != (b[1] > s[i].y) &&
                             s[i].x < a[0] + (s[i].y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
            }
            CU_ASSERT_EQUAL(crossings % 2, 1);
        }
    }
}

static double between(double lo, double hi)
{
    return lo + (hi - lo) * rp_random_uniform(&stream);
}

/* A random surface, and the same cut at random points into segments, in any order, with either side as their
 * direction; each piece may be there twice, or move away later where nothing goes. */
enum { SIDES = 4, PIECES = 40 };
typedef struct {
    size_t n, n_cut;
    dem_wall whole[SIDES], cut[PIECES];
} surface;

static void cut_surface(surface *s, const dem_material *material)
{
    double x = -1.0, y = 0.0, angle = between(-0.3, 0.3);
    *s = (surface){.n = 1 + (size_t)between(0.0, SIDES)};
    for (size_t k = 0; k < s->n; k++) {
        const double length = between(0.3, 1.5), tx = cos(angle), ty = sin(angle);
        s->whole[k] = grains_line(x, y, -ty, tx, material);
        s->whole[k].extent[0] = 0.0, s->whole[k].extent[1] = length;
        for (double from = 0.0, to; from < length; from = to) {
            to = fmin(from + between(0.02, 0.8), length);
            for (int twice = 0; twice < 1 + (between(0.0, 1.0) < 0.2); twice++) {
                const size_t place = (size_t)between(0.0, (double)s->n_cut + 1.0);
                const double sign = between(-1.0, 1.0) < 0.0 ? -1.0 : 1.0, at = between(from, to);
                dem_wall piece = grains_line(x + at * tx, y + at * ty, -sign * ty, sign * tx, material);
                piece.extent[0] = sign > 0.0 ? from - at : at - to;
                piece.extent[1] = sign > 0.0 ? to - at : at - from;
                memmove(s->cut + place + 1, s->cut + place, (s->n_cut - place) * sizeof *s->cut);
                s->cut[place] = piece, s->n_cut++;
            }
        }
        x += length * tx, y += length * ty;
        angle += between(0.0, 1.0) < 0.4 ? between(-0.04, 0.04) : between(-0.6, 0.6);
    }
}

/* A surface acts the same however it is cut: on slow and fast grains, smooth and rough ones, that roll or
 * not, by each law, also where the grain starts exactly above a joint. */
static void cut_surfaces(void)
{
    stream = rp_random_of(1993, 36, RP_PURPOSE_TEST);
    for (int k = 0; k < 120; k++) {
        dem_definition def = dem_definition_default();
        dem_state end[2];
        surface s;
        def.normal = (dem_normal_law)(k % DEM_NORMAL_N);
        grains_law(&def, def.normal, between(1e4, 1e6), k % 3 ? between(50.0, 500.0) : 0.0);
        def.dt = 1e-5, def.rotation = k % 4 > 1;
        def.tangential = k % 4 ? DEM_SPRING : DEM_NONE;
        def.material.mu = k % 4 ? between(0.0, 0.6) : 0.0;
        def.material.mu_roll = k % 4 == 3 ? 0.05 : 0.0;
        if (k % 8 == 7) def.tension = false, def.hard = (dem_hard){true, 0.6, 0.3};
        cut_surface(&s, &def.material);
        const dem_wall *first = &s.whole[0];
        const double along = k % 5 ? 0.1 : s.whole[0].extent[1], speed = pow(10.0, between(-1.0, 1.7));
        const double *at = first->point, *n = first->direction;
        const dem_grain grain = {at[0] + along * n[1] + 0.1001 * n[0],
                                 at[1] - along * n[0] + 0.1001 * n[1],
                                 0.1,
                                 M,
                                 speed * n[1],
                                 -speed * n[0]};
        for (int cut = 0; cut < 2; cut++) {
            def.grains = &grain, def.n_grains = 1;
            def.wall_list = cut ? s.cut : s.whole, def.n_walls = cut ? s.n_cut : s.n;
            scoped_sim *sim = grains_after(&def, 6000);
            end[cut] = grains_state_of_one(sim);
        }
        const double size = 1.0 + hypot(end[0].x, end[0].y), v = speed + 60.0;
        CHECK_PAIRS(1e-7 * size, {end[0].x, end[1].x}, {end[0].y, end[1].y});
        CHECK_PAIRS(1e-6 * v, {end[0].vx, end[1].vx}, {end[0].vy, end[1].vy});
        CHECK_NEAR(end[0].omega, end[1].omega, 1e-6 * v / 0.1);
    }
}

/* A grain that falls on a joint of a floor, or as near to it as round-off, rebounds as beside it. */
static void landing_on_a_joint(void)
{
    static const double x[] = {0.0, 3e-6, -3e-6, 1e-17, -1e-17};
    double rebound = 0.0;
    for (int k = -1; k < 10; k++) {
        dem_grain grain = {.x = k < 0 ? 0.5 : x[k % 5], .y = 0.15, .r = R, .m = M};
        dem_definition def = grains_floored(1, &grain);
        def.n_walls = 2;
        for (int w = 0; w < 2; w++) {
            def.walls[w] = grains_line((w == 0) == (k < 5) ? -1.0 : 0.0, 0.0, 0.0, 1.0, &def.material);
            def.walls[w].extent[0] = 0.0, def.walls[w].extent[1] = 1.0;
        }
        scoped_sim *sim = grains_after(&def, 240);
        const dem_state s = grains_state_of_one(sim);
        if (k < 0) rebound = s.vy;
        CHECK_PAIRS(1e-9 * rebound, {s.vy, rebound}, {s.vx, 0.0});
    }
    CU_ASSERT(rebound > 1.0);
}

/* A gate that is flush with the floors beside it is floor until it opens: then its neighbours end in corners,
 * over which a slow grain tips. */
static void flush_gate(void)
{
    static const char *const gates[] = {"open_at_step = 30000;", "open_at_step = 30000; open_speed = 2.0;"};
    for (int k = 0; k < 4; k++) {
        const char *ends[] = {"[0.0, 0.0], [1.0, 0.0]", "[1.0, 0.0], [0.0, 0.0]"};
        scoped_sim *sim = grains_after_text(
            29000,
            "dt = 5.0e-5; steps = 60000; normal = { gamma_n = 200.0; }; walls = (\n"
            "{ polygon = ( [-1.0, 0.0], [0.0, 0.0] ); closed = false; }, { polygon = ( %s ); closed = "
            "false; %s },\n"
            "{ point = [2.0, 0.0]; direction = [0.0, -1.0]; extent = [0.0, 1.0]; } );\n"
            "particles = ( { x = -0.1; y = 0.1; r = 0.1; vx = 0.4; } );\n",
            ends[k / 2], gates[k % 2]);
        CHECK_NEAR(grains_state_of_one(sim).x, -0.1 + 0.4 * dem_time(sim), 1e-9);
        CHECK_OK(dem_run(sim, 31000));
        CU_ASSERT(grains_state_of_one(sim).y < -0.5);
    }
}

/* Mirror images of scenes, in x, give those of the run: walls of all kinds, gates, motions, spins, turns. */
static void print_scene(char *text, size_t size, unsigned long run, double sign)
{
    FILE *f = fmemopen(text, size, "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(f);
    stream = rp_random_of(1993, run, RP_PURPOSE_TEST);
    const bool turns = between(0.0, 1.0) < 0.3, hard = between(0.0, 1.0) < 0.2;
    fprintf(
        f,
        "rotation = true; dt = 1.0e-5; steps = 3000; tangential = { law = \"spring\"; mu = %.17g; };\n"
        "rolling = { mu = 0.02; }; normal = { law = \"%s\"; k_n = 1.0e5; gamma_n = 100.0; tension = %s; };\n",
        between(0.0, 0.7), between(0.0, 1.0) < 0.5 ? "hertz" : "linear", hard ? "false" : "true");
    fprintf(f, "%s = %.17g;\n", sign > 0.0 ? "x_max" : "x_min", sign * between(0.8, 1.5));
    if (hard) fprintf(f, "hard = { restitution = 0.5; mu = 0.2; };\n");
    if (turns) fprintf(f, "gravity_turn_deg_per_step = %.17g;\n", sign * between(-0.01, 0.01));
    const double x = between(-0.5, 0.5), tilt = between(-0.3, 0.3);
    fprintf(f, "walls = ( { point = [%.17g, -0.5]; direction = [%.17g, 1.0]; },\n", sign * x, sign * tilt);
    double from = between(-0.5, 0.0), to = between(0.1, 0.8), height = between(-0.2, 0.2);
    fprintf(f, "  { point = [%.17g, %.17g]; direction = [0.0, 1.0]; extent = [%.17g, %.17g]; },\n", sign * x,
            height, sign > 0.0 ? from : -to, sign > 0.0 ? to : -from);
    fprintf(f, "  { polygon = ( [%.17g, -0.4], [%.17g, %.17g], [%.17g, 0.9] ); closed = false; },\n",
            sign * between(-0.9, -0.6), sign * between(-0.8, -0.7), between(-0.2, 0.2),
            sign * between(-1.2, -1.0));
    const bool up = between(0.0, 1.0) < 0.5;
    const double gate = sign * between(0.6, 0.8), lean = sign * between(-0.2, 0.2);
    fprintf(f,
            "  { polygon = ( [%.17g, %g], [%.17g, %g] ); closed = false; open_at_step = 800; open_speed = "
            "30.0; },\n",
            gate, up ? -0.6 : 1.2, gate + lean, up ? 1.2 : -0.6);
    fprintf(f, "  { circle = [%.17g, %.17g, 0.3]; sides = 7; omega = %.17g; velocity = [%.17g, 3.0]; } );\n",
            sign * between(-0.3, 0.3), between(-0.9, -0.7), sign * between(-9.0, 9.0),
            sign * between(-3.0, 3.0));
    fprintf(f, "particles = (");
    for (int i = 0; i < 6; i++)
        fprintf(f, "%s{ x = %.17g; y = %.17g; r = %.17g; vx = %.17g; vy = %.17g; omega = %.17g; }",
                i ? ",\n" : " ", sign * (-0.45 + 0.18 * i + between(-0.01, 0.01)), between(0.35, 0.8),
                between(0.05, 0.07), sign * between(-20.0, 20.0), between(-20.0, 5.0),
                sign * between(-50.0, 50.0));
    fprintf(f, " );\n");
    fclose(f);
}

static void mirror_images(void)
{
    for (unsigned long run = 1; run <= 60; run++) {
        dem_state s[2][6];
        dem_wall_state wall[2];
        size_t n[2];
        for (int k = 0; k < 2; k++) {
            char text[4096];
            print_scene(text, sizeof text, run, k ? -1.0 : 1.0);
            scoped_sim *sim = grains_after_text(3000, "%s", text);
            CHECK_OK(dem_states(sim, s[k]));
            n[k] = dem_count(sim);
            wall[k] = dem_wall_now(sim, 4);
        }
        CU_ASSERT_EQUAL(n[0], n[1]);
        CHECK_NEAR(wall[0].ends[0], wall[1].ends[0], 1e-12);
        for (size_t i = 0; i < n[0] && i < n[1]; i++) {
            CU_ASSERT_EQUAL(s[0][i].id, s[1][i].id);
            CHECK_PAIRS(1e-6, {s[0][i].x, -s[1][i].x}, {s[0][i].y, s[1][i].y});
            CHECK_NEAR(s[0][i].vx, -s[1][i].vx, 1e-3);
            CHECK_NEAR(s[0][i].omega, -s[1][i].omega, 1e-2);
        }
    }
}

/* At a corner that points at it, one grain has one contact: the force of the corner, not of two ends. Inside
 * of a right angle it touches both sides. At a slight inner turn, where both sides are as near as the overlap
 * can tell, it has one. */
static void contacts_at_corners(void)
{
    static const struct {
        const char *polygon;
        double x, y;
        int contacts;
    } cases[] = {{"[-1.0, -1.0], [0.0, 0.0], [1.0, -1.0]", 0.0, 0.099, 1},    /* on a ridge */
                 {"[-1.0, -1.0], [0.0, 0.0], [1.0, -1.0]", 0.005, 0.0985, 1}, /* beside its top */
                 {"[-1.0, -1.0], [0.0, 0.0], [1.0, -1.0]", 0.09, 0.0505, 1},  /* on its flank */
                 {"[0.0, 1.0], [0.0, 0.0], [1.0, 0.0]", 0.099, 0.099, 2},     /* in a box's corner */
                 {"[0.0, 1.0], [0.0, 0.0], [1.0, 0.0]", 0.3, 0.099, 1},
                 {"[-1.0, 0.01], [0.0, 0.0], [1.0, 0.01]", 0.0001, 0.099, 1}, /* in a slight dent */
                 {"[-1.0, 0.01], [0.0, 0.0], [1.0, 0.01]", -0.0001, 0.099, 1},
                 {"[1.0, -1.0], [0.0, 0.0], [-1.0, -1.0]", 0.0, 0.099, 1},    /* ridge, from its outside */
                 {"[1.0, 0.01], [0.0, 0.0], [-1.0, 0.01]", 0.0001, 0.099, 1}, /* dent, from its outside */
                 {"[-1.0, 0.0245], [0.0, 0.0], [1.0, 0.0245]", 0.0001, 0.099, 1}, /* a turn of 0.049 */
                 {"[-1.0, 0.0255], [0.0, 0.0], [1.0, 0.0255]", 0.0001, 0.099, 2}, /* of 0.051 */
                 /* of 0.1, cut or not beside the corner */
                 {"[-1.0, 0.05], [0.0, 0.0], [1.0, 0.05]", 0.0025, 0.0999, 2},
                 {"[-1.0, 0.05], [0.0, 0.0], [2e-3, 1e-4], [1.0, 0.05]", 0.0025, 0.0999, 2},
                 /* on the floor at y = -5: a ramp's foot, a ramp, a plate, and a post */
                 {"[0.0, -5.0], [1.0, -4.5]", -0.05, -4.901, 1},
                 {"[0.0, -5.0], [1.0, -4.5]", -0.01, -4.901, 2},
                 {"[0.0, -5.0], [1.0, -5.0]", 0.3, -4.901, 1},
                 {"[0.0, -5.0], [0.0, -4.0]", 0.099, -4.901, 2}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scoped_sim *sim =
            grains_after_text(0,
                              "steps = 0; walls = ( { point = [0.0, -5.0]; direction = [0.0, 1.0]; },\n"
                              "{ polygon = ( %s ); closed = false; } );\n"
                              "particles = ( { x = %.17g; y = %.17g; r = 0.1; } );\n",
                              cases[k].polygon, cases[k].x, cases[k].y);
        CU_ASSERT_EQUAL(dem_contact_count(sim, 1), cases[k].contacts);
    }
}

/* Two segments that are joined at the origin: along x, and on from there, turned by `turn`. A grain at (x, y)
 * touches what it stands above, or the corner, which is the second one's, if it is beyond both ends. Inside
 * of a slight turn it touches the nearer one. */
static void check_joint(dem_sim *sim, double turn, double x, double y)
{
    const double tangent[2][2] = {{1.0, 0.0}, {cos(turn), sin(turn)}};
    double along[2], above[2];
    for (int w = 0; w < 2; w++) {
        along[w] = tangent[w][0] * x + tangent[w][1] * y;
        above[w] = tangent[w][0] * y - tangent[w][1] * x;
    }
    const bool inside[2] = {along[0]<0.0, along[1]> 0.0}, both = inside[0] && inside[1];
    const double tie = fmin(fabs(along[0]), fabs(along[1]));
    if (tie < 2e-3 * R || (both && fabs(fabs(above[0]) - fabs(above[1])) < 1e-9)) return;
    sim->grains.motion[0].x = (dem_vec){x, y};
    for (int w = 0; w < 2; w++) sim->walls.slot[w].side = copysign(1.0, above[w]);
    for (int w = 0; w < 2; w++) {
        const bool nearer = fabs(above[w]) < fabs(above[!w]), corner = w == 1 && !inside[0] && !inside[1];
        const bool has = corner || (inside[w] && !(both && fabs(turn) < 0.05 && !nearer));
        const double distance = corner ? hypot(x, y) : fabs(above[w]), foot = corner ? 0.0 : along[w];
        dem_wall_slot *slot = &sim->walls.slot[w];
        dem_touch touch;
        CU_ASSERT_EQUAL(dem_wall_touch(sim, slot, &touch) && !dem_wall_yields(sim, slot, &touch), has);
        if (!has) continue;
        CHECK_NEAR(touch.overlap, R - distance, 1e-15);
        CHECK_NEAR(touch.normal[0], (x - foot * tangent[w][0]) / distance, 1e-14 / distance);
        CHECK_NEAR(touch.normal[1], (y - foot * tangent[w][1]) / distance, 1e-14 / distance);
    }
}

static void joints(void)
{
    static const double turns[] = {-2.5, -1.5,  -0.5,  -0.051, -0.049, -0.02,
                                   0.02, 0.049, 0.051, 0.5,    1.5,    2.5};
    for (size_t t = 0; t < sizeof turns / sizeof *turns; t++) {
        dem_grain grain = {.x = -0.5, .y = 0.5, .r = R, .m = M};
        dem_definition def = grains_floored(1, &grain);
        def.n_walls = 2;
        for (int w = 0; w < 2; w++) {
            const double angle = w ? turns[t] : 0.0;
            def.walls[w] = grains_line(w ? 0.0 : -1.0, 0.0, -sin(angle), cos(angle), &def.material);
            def.walls[w].extent[0] = 0.0, def.walls[w].extent[1] = 1.0;
        }
        scoped_sim *sim = grains_start(&def);
        free(sim->walls.slot);
        sim->walls.slot = dem_array(sim->walls.capacity = 2, sizeof *sim->walls.slot);
        for (uint32_t w = 0; w < 2; w++) sim->walls.slot[w] = (dem_wall_slot){.wall = w, .next = !w};
        sim->walls.n_slots = 2;
        for (int k = 0; k < 720; k++) {
            const double angle = M_PI / 360.0 * (k + 0.1), distance = 0.02 + 0.005 * (k % 11);
            check_joint(sim, turns[t], distance * cos(angle), distance * sin(angle));
        }
    }
}

/* Nothing is lost: a grain that slides in a bowl of 300 sides, without friction or damping, keeps its energy
 * to 1e-4 over hundreds of joints. A side's end that pushed as well would be a kick at each. */
static void bowl(void)
{
    scoped_sim *sim = grains_after_text(0, "steps = 20000; dt = 1.0e-5; gravity = [0.0, -981.0];\n"
                                           "normal = { law = \"linear\"; k_n = 1.0e5; gamma_n = 0.0; };\n"
                                           "walls = ( { circle = [0.0, 0.0, 2.0]; sides = 300; } );\n"
                                           "particles = ( { x = 1.8994; y = 0.0; r = 0.1; } );\n");
    const double before = grains_energy(sim);
    CHECK_OK(dem_run(sim, 20000));
    const dem_state s = grains_state_of_one(sim);
    CU_ASSERT(fabs(s.x) < 1.9 && s.vx != 0.0);
    /* the height fallen through: that of the bowl's radius */
    CHECK_NEAR(grains_energy(sim), before, 1e-4 * s.m * 981.0 * 1.9);
}

/* ---- scene files ---- */

static void normalised(void)
{
    scoped_scene s = {0};
    CHECK_OK(grains_read("walls = ( { point = [0.0, 0.0]; direction = [3.0, 4.0]; },\n"
                         "          { point = [0.0, 0.0]; direction = [0.6, 0.8]; },\n"
                         "          { circle = [1.0, 2.0, 3.0]; sides = 4; velocity = [1.0, 2.0]; } );\n"
                         "particles = ( { x = 3.0; y = 3.0; r = 0.1; } );\n",
                         NULL, &s));
    CU_ASSERT_EQUAL(s.def.n_walls, 6);
    CHECK_NEAR(s.def.walls[0].direction[0], 0.6, 1e-16);
    CU_ASSERT(s.def.walls[1].direction[0] == 0.6 && s.def.walls[1].direction[1] == 0.8);
    const dem_wall *bottom = &s.def.walls[5]; /* the side that ends where the first begins */
    CHECK_PAIRS(1e-14, {bottom->point[0], 1.0 - 3.0 * sqrt(0.5)}, {bottom->point[1], 2.0 - 3.0 * sqrt(0.5)},
                {bottom->direction[1], 1.0}, {bottom->extent[1], 3.0 * sqrt(2.0)});
    CU_ASSERT(bottom->pivot[0] == 1.0 && bottom->pivot[1] == 2.0 && bottom->velocity[1] == 2.0);
}

/* A wall that opens at a speed has its lower end first, however it is given; a level one keeps its first. */
static void lower_ends(void)
{
    static const char *const gates[] = {"polygon = ( [-1.0, 10.0], [-1.0, 0.0] ); closed = false;",
                                        "polygon = ( [1.0, 0.0], [1.0, 10.0] ); closed = false;",
                                        "point = [-2.0, 0.0]; direction = [1.0, 0.0]; extent = [-10.0, 0.0];",
                                        "point = [2.0, 0.0]; direction = [-1.0, 0.0]; extent = [0.0, 10.0];",
                                        "point = [-2.0, 0.0]; direction = [1.0, 0.0]; extent = [-9e9, 0.0];",
                                        "polygon = ( [3.0, 0.0], [-3.0, 0.0] ); closed = false;"};
    for (int k = 0; k < 6; k++) {
        scoped_scene s = {0};
        CHECK_OK(grains_read_as(&s,
                                "walls = ( { %s %s open_speed = 5.0; } );\n"
                                "particles = ( { x = 0.0; y = 6.0; r = 0.1; } );\n",
                                gates[k], k % 4 ? "open_at_step = 1;" : "/* in a phase */"));
        const dem_wall *w = &s.def.walls[0];
        CHECK_NEAR(w->point[1] - w->extent[0] * w->direction[0], 0.0, 1e-12);
        CU_ASSERT(w->point[1] - w->extent[1] * w->direction[0] >= (k == 5 ? 0.0 : 10.0));
        if (k == 5) CHECK_NEAR(w->point[0] + w->extent[0] * w->direction[1], 3.0, 1e-12);
    }
}

/* A circle of one side more or less than a definition holds without a list. */
static void sides_of_circle(void)
{
    for (int n = DEM_FEW_WALLS - 1; n <= DEM_FEW_WALLS + 1; n++) {
        scoped_scene s = {0};
        CHECK_OK(grains_read_as(&s,
                                "walls = ( { circle = [1.0, 2.0, 3.0]; sides = %d; } );\n"
                                "particles = ( { x = 1.0; y = 2.0; r = 0.1; } );\n",
                                n));
        CU_ASSERT_EQUAL_FATAL(s.def.n_walls, (size_t)n);
        CU_ASSERT((s.def.wall_list != NULL) == (n > DEM_FEW_WALLS));
    }
}

/* A filling elsewhere is the same filling, moved. */
static void filling(void)
{
    dem_fill fill = {20, 1.2, 1.5, 0.1, 0.02, 0.07, 0.13, 1.0, DEM_SPHERE, 1993, 2};
    dem_grain at[2][20];
    CHECK_OK(dem_fill_grains(&fill, at[0], &(size_t){0}));
    fill.x0 = -3.5, fill.y0 = 12.25;
    CHECK_OK(dem_fill_grains(&fill, at[1], &(size_t){0}));
    for (int i = 0; i < 20; i++) {
        CHECK_PAIRS(1e-14, {at[1][i].x, at[0][i].x - 3.5}, {at[1][i].y, at[0][i].y + 12.25});
        CU_ASSERT(at[1][i].r == at[0][i].r);
    }
}

static void refused(void)
{
#define ONE "particles = ( { x = 0.0; y = 0.5; r = 0.1; } );\n"
    static const char *const cases[][2] = {
        {"polygon = ( [0.0, 0.0], [1.0, 0.0] );", "of at least 3 points"},
        {"polygon = ( [0.0, 0.0] ); closed = false;", "of at least 2 points"},
        {"polygon = [0.0, 0.0, 1.0, 0.0];", "a list ( [x, y], ... )"},
        {"polygon = ( [0.0, 0.0], [0.0, 0.0], [1.0, 0.0] );", "points 1 and 2 are"},
        {"polygon = ( [0.0, 0.0], [2.0, 0.0], [1.0, 7.0], [1.0, 7.0] );", "points 3 and 4 are [1, 7]"},
        {"polygon = ( [3.0, 5.0], [2.0, 0.0], [3.0, 5.0] );", "points 3 and 1 are [3, 5]"},
        {"circle = [0.0, 0.0, 2.0]; direction = [0.0, 1.0];", "one of point, polygon and circle"},
        {"polygon = ( [0.0, 0.0], [1.0, 0.0], [0.0, 1.0] ); extent = [0.0, 1.0];",
         "one of point, polygon and circle"},
        {"polygon = ( [0.0, 0.0], [1.0, 0.0], [0.0, 1.0] ); circle = [0.0, 0.0, 2.0];",
         "one of point, polygon and circle"},
        {"circle = [0.5, 2.0, 0.0];", "radius = 0: must be above 0"},
        {"circle = [0.5, 2.0, -3.0];", "radius = -3: must be above 0"},
        {"circle = [0.0, 0.0];", "circle: three numbers [a, b, c]"},
        {"circle = [0.0, 0.0, 2.0]; sides = 2;", "sides = 2: out of range"},
        {"circle = [0.0, 0.0, 2.0]; point = [0.0, 0.0];", "one of point, polygon and circle"},
        {"circle = [0.0, 0.0, 2.0]; polygon = ( );", "one of point, polygon and circle"},
        {"point = [0.0, 0.0]; direction = [0.0, 1.0]; extent = [0.0, 1.0]; open_at_step = 3;\n"
         "open_speed = 2.0; omega = 1.0;",
         "can only open at once"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        grains_refused(check_text("walls = ( { %s } ); " ONE, cases[k][0]), NULL, cases[k][1]);
#define FLOOR "{ point = [0.0, 0.0]; direction = [0.0, 1.0]; }"
    static const char *const starts[][2] = {
        /* what lies on a whole line would never act, unless it is alike, or the line opens */
        {"walls = ( " FLOOR
         ", { point = [3.0, 0.0]; direction = [0.0, 1.0]; k_n = 7e5; } ); " ONE, /* either */
         "wall 1: lies on wall 2, an infinite line, and would never act"},
        {"walls = ( { point = [-2.00009, 0.5]; direction = [1.0, 0.0]; extent = [0.0, 1.0]; k_n = 7e5; },\n"
         "{ point = [-2.0, 0.0]; direction = [1.0, 0.0]; } ); " ONE,
         "wall 1: lies on wall 2, an infinite line"},
        {"walls = ( " FLOOR
         ", { polygon = ( [0.0, 0.0], [5.0, 0.0] ); closed = false; velocity = [9.0, 0.0]; } ); " ONE,
         "wall 2: lies on wall 1, an infinite line"},
        {"box_turn_deg_per_step = 10.0; walls = ( " FLOOR
         " ); particles = ( { x = 3.0; y = 0.5; r = 0.1; } );",
         "box_turn_deg_per_step: wall 1: moves 0.53"},
        {"box_turn_deg_per_step = 0.01; walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; omega = 1.0; "
         "} );" ONE,
         "wall 1: velocity or omega: not in a box that turns"},
        {"integrator = \"implicit\"; walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0];\n"
         "velocity = [1.0, 0.0]; } );" ONE,
         "wall 1 moves, but the integrator implicit"},
        {"ground = { mu_static = 0.4; a = 0.013; }; walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0];\n"
         "velocity = [1.0, 0.0]; } );" ONE,
         "never opens or moves"},
        {"walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; velocity = [0.0, 3e3]; } );" ONE,
         "wall 1: moves 0.15 in one step, the smallest radius is 0.1"},
        {"walls = ( { circle = [0.0, 0.0, 3.0]; omega = 1e3; } );" ONE, "wall 1: moves 0.15 in one step"},
        {"walls = ( { circle = [0.0, 0.0, 3.0]; omega = 500.0; velocity = [0.0, 1.5e3]; } );" ONE,
         "wall 1: moves 0.15 in one step"},
        {"walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; },\n"
         "{ point = [0.0, 9.0]; direction = [0.0, -1.0]; velocity = [0.0, 3e3]; } );" ONE,
         "wall 2: moves 0.15 in one step"},
        {"walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; omega = 3e4; } );" ONE,
         "omega = 30000: must be below one radian a step"},
        {"dt = 1e-4; walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; velocity = [0.0, 500.0]; } "
         ");" ONE,
         "dt = 0.0001: too large for impacts of the lightest grain at wall 1"}};
    for (size_t k = 0; k < sizeof starts / sizeof *starts; k++) {
        scoped_scene s = {0};
        dem_sim *sim = NULL;
        CHECK_OK(grains_read(starts[k][0], NULL, &s));
        CHECK_FAILS(dem_scene_start(&s, &sim), RP_BAD_INPUT, starts[k][1]);
    }
    static const char *const alike[] = {
        "walls = ( " FLOOR ", { point = [0.5, 0.0]; direction = [0.0, 1.0]; extent = [0.0, 1.0]; } ); " ONE,
        "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; open_at_step = 3; },\n"
        "{ point = [0.5, 0.0]; direction = [0.0, 1.0]; extent = [0.0, 1.0]; k_n = 7e5; } ); " ONE,
        "walls = ( " FLOOR
        ", { point = [0.5, 1.1e-4]; direction = [0.0, 1.0]; extent = [2.0, 3.0]; k_n = 7e5; } ); " ONE};
    for (size_t k = 0; k < sizeof alike / sizeof *alike; k++) {
        scoped_sim *sim = grains_after_text(0, "%s", alike[k]);
        CU_ASSERT_PTR_NOT_NULL(sim);
    }
}

/* A grain that lies on a wall that moves has a soft contact, and no hard collision besides: with and without
 * hard collisions its states are the same bits. */
static void soft_on_moving_wall(void)
{
    enter();
    write_text(
        "s.cfg",
        "dt = 1.0e-5; steps = 300; gravity = [0.0, -981.0]; normal = { law = \"linear\"; k_n = 1.0e6;\n"
        "gamma_n = 100.0; tension = false; };\n"
        "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; velocity = [0.0, 40.0]; } );\n"
        "particles = ( { x = 0.0; y = 0.0995; r = 0.1; vx = 1.0; } );\n");
    GOOD("run s.cfg --every 20 -o soft");
    shell("echo 'hard = { restitution = 0.5; mu = 0.0; };' >>s.cfg; :>out; :>err");
    GOOD("run s.cfg --every 20 -o hard");
    CU_ASSERT(equal_tables("soft/states.tsv", "hard/states.tsv"));
    leave();
}

CHECK_SUITE(walls, "walls", piston, sliding_floor, speed_of_a_wall, lines_of_walls, list_of_a_turning_box,
            height_of_a_wall, galilean, turning_box, where_it_is, drum_ledger, drum_kernels, drum_snapshot,
            inside, cut_surfaces, landing_on_a_joint, flush_gate, mirror_images, contacts_at_corners, joints,
            soft_on_moving_wall, bowl, normalised, lower_ends, sides_of_circle, filling, refused)
