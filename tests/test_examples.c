/* Scenes of `examples`: one number of each against the known answer in its first lines. They run in the
 * repository's root. Under the sanitizers long ones only start; with --full, the hopper has more outlets. */
#include <unistd.h>

#include "angle/angle.h"
#include "tests/grains.h"
#include "tests/program.h"

static dem_sim *start(const char *path, const char *change, long *steps)
{
    scoped_scene scene = {0};
    dem_sim *sim = NULL;
    const rp_texts changes = {change != NULL, {change}};
    CHECK_OK(dem_scene_read(path, &changes, &scene));
    CHECK_OK(dem_scene_start(&scene, &sim));
    CU_ASSERT_PTR_NOT_NULL_FATAL(sim);
    *steps = scene.steps;
    return sim;
}

/* dt over the time of contact, 1e-6/4.5e-4, is the error of first order. */
static void impact(void)
{
    long steps;
    dem_state s[2];
    scoped_sim *sim = start("examples/impact.cfg", NULL, &steps);
    grains_run(sim, steps, s);
    CHECK_PAIRS(0.3, {s[0].vx, 20.0}, {s[1].vx, 80.0});
    CHECK_NEAR(s[0].vx + s[1].vx, 100.0, 1e-10);
}

/* The start's gaps and overlaps are 1e-4 of the radius: speeds of 1 mm/s across the chute. The shear spring
 * needs mu^2 m g cos/k_s of displacement, 1e-4 cm, before the grain slides. */
static void chute(void)
{
    static const double G = 981.0;
    for (int slides = 0; slides < 2; slides++) {
        long steps;
        dem_state s[3];
        scoped_sim *sim = start("examples/chute.cfg", slides ? NULL : "tangential.mu=0.6", &steps);
        grains_run(sim, steps, s);
        const double expected = slides ? G * (1.0 - 0.3 * 2.0) / sqrt(5.0) * dem_time(sim) : 0.0;
        for (int i = 0; i < 3; i++) CHECK_NEAR(hypot(s[i].vx, s[i].vy), expected, 0.4);
    }
}

/* All contacts with the floor slide. Means over time, since the grains still rattle. */
static void shear_box(void)
{
    long steps;
    double shear = 0.0, normal = 0.0, forces[2 * 3];
    scoped_sim *sim = start("examples/shear_box.cfg", NULL, &steps);
    CHECK_OK(dem_run(sim, steps / 2));
    for (int k = 0; k < 200; k++) {
        CHECK_OK(dem_run(sim, steps / 400));
        grains_wall_forces(sim, forces);
        shear += forces[0], normal -= forces[1];
    }
    CHECK_NEAR(shear / normal, 0.3, 0.005);
    scoped dem_state *s = grains_states(sim);
    double weight = 0.0, v = 0.0;
    for (size_t i = 0; i < dem_count(sim); i++)
        weight += s[i].m * 981.0, v += s[i].vx / (double)dem_count(sim);
    CHECK_NEAR(normal / 200.0, weight, 0.02 * weight);
    CHECK_NEAR(v, 5.0, 0.05); /* as the frame */
}

/* Angle of repose by the protocol `repose`, degrees. */
static double theta_r(void)
{
    write_text("r.cfg", "protocol = \"repose\"; replicas = 3; seed = 1993;\n"
                        "fixed = { W = 4.0; H = 4.0; floor = \"extends\"; mu = 0.2; };\n");
    GOOD("sweep plan r.cfg -o r > log");
    GOOD("sweep run r > log");
    scoped_table t = TABLE_OF("sweep export r");
    double sum = 0.0;
    for (size_t i = 0; i < t.n_rows; i++) sum += cell(&t, i, "theta_r3_deg");
    return sum / (double)t.n_rows;
}

/* A folder of its own, from which the examples are found. */
static void enter_folder(void)
{
    char root[4096];
    CU_ASSERT_FATAL(getcwd(root, sizeof root) != NULL);
    enter();
    setenv("REPOSE_DATA", root, 1);
}

/* What an experiment measures, with a change, or just measured; NAN under the sanitizers, which only read. */
static double measured(const char *file, const char *set, const char *name)
{
    double value = NAN;
    if (check_fast()) {
        GOOD("params examples/%s", file);
        return NAN;
    }
    if (set) GOOD("run examples/%s --set '%s' --quiet", file, set); /* no progress, however slow */
    scoped_table t = read_table("out");
    for (size_t i = 0; i < t.n_rows; i++)
        if (strcmp(word(&t, i, "measure"), name) == 0) value = cell(&t, i, "value");
    return value;
}

/* Between the angle of repose and that of marginal stability, equation (3), and nearer to the latter. Where
 * grains rotate, the drum carries their weight by its torque. */
static void drum(void)
{
    static const char balance[] =
        "measure = ( { name = \"balance\"; of = \"1 + drum.torque/(mass*g*x)\"; during = \"turn\"; } );";
    double theta_ms;
    const double angle = measured("drum.cfg", "turns=1", "angle_deg") * M_PI / 180.0;
    if (CHECK_SKIPS("a long run of code that others run")) return;
    CU_ASSERT(
        shell_line("sed '/^measure/,$d' \"$REPOSE_DATA\"/examples/drum.cfg >of.cfg && echo '%s' >>of.cfg",
                   balance) == 0);
    scoped_table t = TABLE_OF("run of.cfg --set rotation=true --set turns=0.5");
    CHECK_NEAR(cell(&t, 0, "value"), 0.0, 4.0 * cell(&t, 2, "value"));
    CHECK_OK(ang_marginal(0.2, M_PI / 3.0, &theta_ms, NULL));
    CU_ASSERT(angle > 0.5 * (theta_r() * M_PI / 180.0 + theta_ms) && angle < theta_ms);
    CHECK_NEAR(angle * 180.0 / M_PI, 30.0, 1.0); /* the scene's first lines */
}

/* The small grains flow into the lower left quadrant, and leave it as the drum carries them: less than half
 * of them would be there by chance. A smaller and softer drum than the example's. */
static void drum_two_kinds(void)
{
    if (check_fast()) {
        GOOD("params examples/drum_two_kinds.cfg");
        return;
    }
    GOOD("run examples/drum_two_kinds.cfg --set R=0.06 --set softer=10000 --set T=1.7 --quiet");
    scoped_table t = read_table("out");
    CU_ASSERT(strcmp(word(&t, 0, "measure"), "most") == 0 && cell(&t, 0, "value") > 0.8);
    CU_ASSERT(strcmp(word(&t, 1, "measure"), "least") == 0 && cell(&t, 1, "value") < 0.05);
    CU_ASSERT(strcmp(word(&t, 2, "measure"), "gone") == 0);
    CHECK_NEAR(cell(&t, 2, "value"), 1.05, 0.25);
}

/* Beverloo's law: one C for all outlets, within 10 %: some 800 grains are counted, that come in clusters. An
 * exponent of 1 would give C that differ by 44 % from the narrowest outlet to the widest. */
static void hopper(void)
{
    static const char *const D[] = {"D=1.6", "D=2", "D=2.6", "D=1.4", "D=1.8", "D=2.3"};
    const int n = check_full() ? 6 : check_fast() ? 1 : 3;
    double C[6], mean = 0.0;
    for (int k = 0; k < n; k++) mean += (C[k] = measured("hopper.cfg", D[k], "C")) / n;
    for (int k = 0; k < n && !check_fast(); k++) CHECK_NEAR(C[k], mean, 0.1 * mean);
    GOOD("sweep plan examples/hopper_sweep.cfg -o outlets");
}

/* The slope of a heap falls with the speed of the lift. */
static void cylinder(void)
{
    const double slow = measured("cylinder.cfg", "v=1.0", "heap_mean_deg"),
                 fast = measured("cylinder.cfg", "v=8.0", "heap_mean_deg");
    if (CHECK_SKIPS("a long run of code that others run")) return;
    CHECK_PAIRS(2.0, {slow, 18.0}, {fast, 10.0});
}

/* The page's box: the same grains as those of pile.cfg, whose wall waits for rest. */
static void box(void)
{
    enter_folder();
    const double theta = measured("box.cfg", "mu=0.2", "theta_r3_deg"),
                 rough = measured("box.cfg", "mu=0.5", "theta_r3_deg"),
                 full = measured("box.cfg", "opens=false", "height");
    leave();
    if (CHECK_SKIPS("a long run of code that others run")) return;
    CHECK_PAIRS(0.5, {theta, 14.0}, {rough, 30.0});
    CHECK_NEAR(full, 4.0, 0.1);
}

/* A column keeps its area: the triangle or trapezium of its deposit holds what the column held. A tall one
 * runs farther than a short one. */
static void column(void)
{
    const double near = measured("column.cfg", "a=1.0", "run_out"),
                 far = measured("column.cfg", "a=3.0", "run_out");
    if (!check_fast()) CU_ASSERT(near > 0.5 && near < 1.5 && far > 2.2 * near && far < 6.0);
}

/* Grains that have fallen make a flatter heap than those that stay. */
static void ledge(void)
{
    const double above = measured("ledge.cfg", "slot=2.4", "draw_down_deg"),
                 below = measured("ledge.cfg", NULL, "heap_mean_deg");
    if (!check_fast()) CU_ASSERT(above > below + 4.0 && above < 31.0 && below > 4.0);
}

/* Resistance to rolling decides how high the heap is; a fifth of the grains here. */
static void wedge(void)
{
    static const char few[] =
        "small=500' --set 'large=100' --set 'opened=1.0' --set 'end=4.0' --set 'mu_roll=%g";
    double height[2];
    GOOD("sweep plan examples/wedge_sweep.cfg -o plan");
    for (int k = 0; k < 2; k++) {
        height[k] = measured("wedge.cfg", check_text(few, k ? 0.3 : 0.0), "heap_height");
        if (!check_fast()) CHECK_NEAR(measured("wedge.cfg", NULL, "below"), 600.0, 0.0);
    }
    static const double said[] = {0.250, 0.207, 0.166, 0.239, 0.180, 0.227},
                        sd = 0.008; /* of the file's head; of a heap */
    for (int k = 0; k < 6 && check_full(); k++) {
        CU_ASSERT(run("run examples/wedge_sweep.cfg --row %d -o heap%d", 10 * k, k) == 0);
        scoped_table t = read_table("out");
        CHECK_NEAR(cell(&t, 0, "heap_height"), said[k], 4.0 * sd);
    }
    if (!check_fast()) CU_ASSERT(height[0] > 0.03 && height[1] > 1.3 * height[0] && height[1] < 0.15);
}

/* Equal loads make equal stresses; the angle of friction grows with that of the grains, below it: 26.6
 * degrees at mu = 0.5. */
static void biaxial(void)
{
    const double low = measured("biaxial.cfg", "mu=0.1", "phi_deg"),
                 high = measured("biaxial.cfg", "mu=0.5", "phi_deg"),
                 ratio = measured("biaxial.cfg", NULL, "ratio0"),
                 p = measured("biaxial.cfg", NULL, "pressure0");
    if (CHECK_SKIPS("a long run of code that others run")) return;
    CHECK_NEAR(ratio, 1.0, 0.1);
    CHECK_NEAR(p, 1.0, 0.15);
    CU_ASSERT(low > 5.0 && high > low + 3.0 && high < 26.6);
}

/* The faster, the deeper and the stronger; soon over. */
static void crater(void)
{
    if (check_fast()) {
        GOOD("params examples/crater_bed.cfg");
        return;
    }
    double depth[2], force[2], time[2];
    SHELL("cp \"$REPOSE_DATA\"/examples/crater*.cfg .");
    GOOD("run crater_bed.cfg -o bed");
    for (int k = 0; k < 2; k++) {
        CU_ASSERT(run("run crater.cfg --set v=%d", k ? 80 : 40) == 0);
        depth[k] = measured("crater.cfg", NULL, "depth"), force[k] = measured("crater.cfg", NULL, "force");
        time[k] = measured("crater.cfg", NULL, "stop_time");
    }
    CU_ASSERT(depth[1] > 1.5 * depth[0] && force[1] > 1.5 * force[0] && time[1] < time[0]);
}

/* More of the heavy, smooth kind leaves first; of equal kinds half, within the scatter of 200 grains. */
static void two_materials(void)
{
    const double share = measured("two_materials.cfg", "run=1", "share"),
                 equal = measured("two_materials.cfg", "rho=2.6' --set 'mu=0.6", "share");
    if (CHECK_SKIPS("a long run of code that others run")) return;
    CHECK_PAIRS(0.1, {share, 0.72}, {equal, 0.5}); /* of the file's head */
}

/* Large grains rise from the bottom through the small ones, in half of the file's cycles. */
static void shaken(void)
{
    const double after = measured("shaken.cfg", "cycles=30", "after"),
                 before = measured("shaken.cfg", NULL, "before"),
                 start = measured("shaken.cfg", NULL, "start_lacey"),
                 end = measured("shaken.cfg", NULL, "end_lacey");
    if (CHECK_SKIPS("a long run of code that others run")) return;
    CU_ASSERT(before < -7.0 && after > -1.0 && start < 0.5 && end > 0.7);
}

/* The program of the core alone says what it lacks, has no library but these, and the bits of its text. */
static void core_alone(void)
{
    write_text("lacks.c",
               "#include <stdio.h>\n#include \"dem/dem.h\"\nint main(void)\n{\n    dem_sim *sim;\n"
               "    dem_definition def = dem_definition_default();\n    def.radius_to_come = 0.1;\n"
               "    def.hard.on = true;\n    dem_create(&def, &sim);\n    puts(rp_message());\n"
               "    def.hard.on = false, def.integrator = DEM_GEAR5;\n    dem_create(&def, &sim);\n"
               "    puts(rp_message());\n}\n");
    CU_ASSERT(
        shell_line("${CC:-gcc} %s -I\"$REPOSE_DATA/src\" lacks.c \"${REPOSE%%/*}/libalone.a\" -lxxhash -lm "
                   "-o lacks && ./lacks >out",
                   check_fast() ? "-fsanitize=address,undefined -no-pie" : "") == 0);
    CU_ASSERT_STRING_EQUAL(out, "hard: this program is built without it\n"
                                "integrator: this program is built without it\n");
    if (check_fast()) return;
    SHELL("readelf -d \"${REPOSE%/*}/core\" | sed -n 's/.*NEEDED.*\\[\\(.*\\)\\.so.*/\\1/p' | sort | xargs "
          ">out");
    CU_ASSERT_STRING_EQUAL(out, "libc libm libxxhash\n");
    GOOD("run examples/core.cfg");
    SHELL("\"${REPOSE%/*}/core\" >core 2>err && awk '/^# steps:/ { steps = $3 } /^# digest:/ { digest = $3 } "
          "$1 == \"height\" { printf \".* %s steps, .* height %.6g cm\\ndigest %s\\n\", steps, $2, digest }' "
          "out "
          ">run && grep -xf run core | wc -l >out");
    CU_ASSERT_STRING_EQUAL(out, "2\n");
}

CHECK_SUITE_WITHIN(examples, "examples", enter_folder, leave, impact, chute, shear_box, drum, drum_two_kinds,
                   hopper, cylinder, box, column, ledge, biaxial, wedge, crater, two_materials, shaken,
                   core_alone)
