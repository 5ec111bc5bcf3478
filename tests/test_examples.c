/* Scenes of `examples`: one number of each against a known answer, as the scene's first lines state it. The
 * tests run from the repository's root. Under the sanitizers long ones only start; with --full, the hopper
 * has more outlets. */
#include <stdlib.h>
#include <string.h>

#include "angle/angle.h"
#include "dem/scene/scene.h"
#include "tests/check.h"
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
    CHECK_OK(dem_run(sim, steps));
    CHECK_OK(dem_states(sim, s));
    CHECK_NEAR(s[0].vx, 20.0, 0.3);
    CHECK_NEAR(s[1].vx, 80.0, 0.3);
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
        CHECK_OK(dem_run(sim, steps));
        CHECK_OK(dem_states(sim, s));
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
    scoped dem_state *s = malloc(dem_count(sim) * sizeof *s);
    CHECK_OK(dem_states(sim, s));
    double weight = 0.0, v = 0.0;
    for (size_t i = 0; i < dem_count(sim); i++)
        weight += s[i].m * 981.0, v += s[i].vx / (double)dem_count(sim);
    CHECK_NEAR(normal / 200.0, weight, 0.02 * weight);
    CHECK_NEAR(v, 5.0, 0.05); /* as the frame */
}

/* Angle of repose by the protocol `repose`, degrees. */
static double theta_r(void)
{
    enter();
    write_text("r.cfg",
               "protocol = \"repose\"; replicas = 3; seed = 1993;\n"
               "fixed = { W = 4.0; H = 4.0; floor = \"extends\"; mu = 0.2; measure = [\"theta_r\"]; };\n");
    GOOD("sweep plan r.cfg -o r > log");
    GOOD("sweep run r > log");
    GOOD("sweep export r -o r.tsv");
    scoped_table t = read_table("r.tsv");
    double sum = 0.0;
    for (size_t i = 0; i < t.n_rows; i++) sum += cell(&t, i, "theta_r3_deg");
    const double mean = sum / (double)t.n_rows;
    leave();
    return mean;
}

/* Between the angle of repose and that of marginal stability, equation (3), and nearer to the latter. */
static void drum(void)
{
    long steps;
    scoped_sim *sim = start("examples/drum.cfg", NULL, &steps);
    long from = 40000;
    const long every = 2000;
    double angle = 0.0, theta_ms;
    dem_state *s = malloc(dem_count(sim) * sizeof *s);
    if (check_fast()) steps = from = 300;
    CHECK_OK(dem_run(sim, from));
    for (long k = 0; k < (steps - from) / every; k++) {
        double x = 0.0, y = 0.0;
        CHECK_OK(dem_run(sim, every));
        CHECK_OK(dem_states(sim, s));
        for (size_t i = 0; i < dem_count(sim); i++) x += s[i].m * s[i].x, y += s[i].m * s[i].y;
        angle += atan(-x / y) / ((double)(steps - from) / (double)every);
    }
    CU_ASSERT_EQUAL(dem_count(sim), 440);
    free(s);
    if (check_fast()) return;
    CHECK_OK(ang_marginal(0.2, M_PI / 3.0, &theta_ms, NULL));
    const double repose = theta_r() * M_PI / 180.0;
    CU_ASSERT(angle > 0.5 * (repose + theta_ms) && angle < theta_ms);
    CHECK_NEAR(angle * 180.0 / M_PI, 29.0, 1.5); /* the scene's first lines */
}

/* Grains a second between 15 and 45 % of the filling, through an outlet of width D in the middle. */
static double flow(double D, long most)
{
    char text[4096], from[2][32], to[2][32];
    FILE *in = fopen("examples/hopper.cfg", "r"), *copy;
    CU_ASSERT_PTR_NOT_NULL_FATAL(in);
    text[fread(text, 1, sizeof text - 1, in)] = '\0';
    fclose(in);
    char path[] = "/tmp/repose-hopper-XXXXXX";
    copy = fdopen(mkstemp(path), "w");
    snprintf(to[0], sizeof to[0], "[%.3f, 0.0]", 3.0 - 0.5 * D), strcpy(from[0], "[2.2, 0.0]");
    snprintf(to[1], sizeof to[1], "[%.3f, 0.0]", 3.0 + 0.5 * D), strcpy(from[1], "[3.8, 0.0]");
    for (const char *p = text; *p;) {
        const int which = strncmp(p, from[0], 10) == 0 ? 0 : strncmp(p, from[1], 10) == 0 ? 1 : -1;
        if (which >= 0)
            fputs(to[which], copy), p += 10;
        else
            fputc(*p++, copy);
    }
    fclose(copy);
    long steps;
    scoped_sim *sim = start(path, NULL, &steps);
    remove(path);
    const size_t n = dem_count(sim);
    double begin = 0.0;
    size_t first = 0;
    while (dem_step(sim) < most && dem_count(sim) * 100 > n * 55) {
        CHECK_OK(dem_run(sim, 50));
        if (first == 0 && dem_count(sim) * 100 < n * 85) first = dem_count(sim), begin = dem_time(sim);
    }
    const double rate = first ? (double)(first - dem_count(sim)) / (dem_time(sim) - begin) : NAN;
    return rate;
}

/* Beverloo's law: one C for all outlets, within 10 %: some 300 grains are counted, that come in clusters. An
 * exponent of 1 would give C that differ by 44 % from the narrowest outlet to the widest. */
static void hopper(void)
{
    static const double D[] = {1.4, 2.0, 2.6, 1.6, 1.8, 2.3};
    const int n = check_full() ? 6 : check_fast() ? 0 : 3;
    double C[6], mean = 0.0;
    if (check_fast()) CU_ASSERT(isnan(flow(1.6, 200)));
    for (int k = 0; k < n; k++) {
        C[k] = flow(D[k], 100000) / pow(D[k] - 1.4 * 0.2, 1.5);
        mean += C[k] / n;
    }
    for (int k = 0; k < n; k++) CHECK_NEAR(C[k], mean, 0.1 * mean);
}

void suite_examples(void)
{
    static const check_case cases[] = {{"two grains collide", impact}, {"a chute", chute},
                                       {"a shear box", shear_box},     {"a drum", drum},
                                       {"a hopper", hopper},           {NULL, NULL}};
    check_register("examples", cases);
}
