/* Tables of commands and protocols whose numbers follow from other tables: every column is computed a second
 * time, in another way, from grains and contacts, from planted rows, or from a shorter run. */
#include <complex.h>
#include <malloc.h>

#include "core/clock.h"
#include "stress/stress.h"
#include "tests/grains.h"
#include "tests/numbers.h"
#include "tests/faults.h"
#include "tests/program.h"
#include "tests/protocol.h"

static const double deg = M_PI / 180.0;
/* sums of some hundred rounded products */
static const double tight = 1e-11;

/* ---- a pile: its grains and contacts as tables ---- */

/* Force on the first of two bodies, from the normal force and the shear along the normal turned clockwise. */
typedef struct {
    double fx, fy, lx, ly;
    bool floor;
} force;

static force force_of(checked *c, size_t k)
{
    const double lx = at(c, k, "x") - at(c, k, "x_b"), ly = at(c, k, "y") - at(c, k, "y_b");
    const double complex n = (lx + I * ly) / hypot(lx, ly),
                         f = n * (at(c, k, "normal_force") - I * at(c, k, "shear_force"));
    return (force){creal(f), cimag(f), lx, ly, at(c, k, "id_b") == 0.0 && at(c, k, "wall") == 1.0};
}

/* The part of the branch from x_b to x whose cells have the number `cell` in both directions: the segments
 * between its crossings with the grid lines belong to the cells of their middles. */
static double share(const checked *c, size_t k, double size, double column, double row)
{
    enum { MOST = 64 };
    const double from[] = {cell(&c->t, k, "x_b"), cell(&c->t, k, "y_b")},
                 to[] = {cell(&c->t, k, "x"), cell(&c->t, k, "y")};
    double cuts[MOST] = {0.0, 1.0}, part = 0.0;
    size_t n = 2;
    for (int a = 0; a < 2; a++)
        for (double line = floor(fmin(from[a], to[a]) / size); line * size <= fmax(from[a], to[a]); line++) {
            const double s = (line * size - from[a]) / (to[a] - from[a]);
            if (n < MOST && s > 0.0 && s < 1.0) cuts[n++] = s;
        }
    for (size_t i = 0; i < n; i++) {
        double next = 1.0;
        for (size_t j = 0; j < n; j++)
            if (cuts[j] > cuts[i]) next = fmin(next, cuts[j]);
        const double middle = 0.5 * (cuts[i] + next);
        bool is_in = true;
        for (int a = 0; a < 2; a++)
            is_in &= floor((from[a] + middle * (to[a] - from[a])) / size) == (a ? row : column);
        part += is_in ? next - cuts[i] : 0.0;
    }
    return part;
}

/* Over all planes: the largest pressure and angle between traction and normal; pi/2 if one pulls. */
static void scan_planes(const double s[4], double *pressure, double *mobilised)
{
    enum { PLANES = 20000 };
    *pressure = -INFINITY;
    *mobilised = 0.0;
    for (int k = 0; k < PLANES; k++) {
        const double a = M_PI * k / PLANES, x = cos(a), y = sin(a);
        const double tx = s[0] * x + s[1] * y, ty = s[2] * x + s[3] * y, normal = x * tx + y * ty;
        *pressure = fmax(*pressure, normal);
        *mobilised = fmax(*mobilised, normal > 0.0 ? atan(fabs(x * ty - y * tx) / normal) : M_PI_2);
    }
}

/* ---- protocol stress, stress field, stress base ---- */

enum { TILTS = 5, QUANTITIES = 6 };
static const double tilts_deg[TILTS] = {0.0, 0.5, 1.0, 2.0, 4.0};

/* n, h and the stress of a tilt over the weight normal to the floor; what grains lack of balance. */
typedef struct {
    double t, q[QUANTITIES], weight_error, balance_error;
} response;

static response read_tilt(int k, double width)
{
    response r = {.t = tan(tilts_deg[k] * deg)};
    double weight = 0.0, mean_weight = 4.0 / 3.0 * M_PI * 1e-3 * 981.0;
    scoped_table grains = read_table(check_text("d/read_%d_grains.tsv", k + 1));
    for (size_t i = 0; i < grains.n_rows; i++) {
        const double x = cell(&grains, i, "x"), fx = cell(&grains, i, "fx"), fy = cell(&grains, i, "fy");
        weight += 981.0 * cell(&grains, i, "m");
        if (!(x > 0.0 && x < width)) continue;
        r.weight_error += fy;
        if (cell(&grains, i, "contacts") > 0.0)
            r.balance_error = fmax(r.balance_error, hypot(fx, fy) / mean_weight);
    }
    r.weight_error /= weight;
    checked c = checked_read(check_text("d/read_%d_contacts.tsv", k + 1));
    const double normal = weight * cos(tilts_deg[k] * deg);
    for (size_t i = 0; i < c.t.n_rows; i++) {
        const force f = force_of(&c, i);
        const double part = share(&c, i, width, 0.0, 0.0) + share(&c, i, width, 0.0, 1.0);
        if (f.floor && cell(&c.t, i, "x") > 0.0 && cell(&c.t, i, "x") < width) {
            r.q[0] += cell(&c.t, i, "normal_force") / normal;
            r.q[1] -= cell(&c.t, i, "shear_force") / normal;
        }
        const double products[] = {f.fx * f.lx, f.fx * f.ly, f.fy * f.lx, f.fy * f.ly};
        for (int a = 0; a < 4; a++) r.q[2 + a] += part * products[a] / (normal * 0.2);
    }
    rp_table_free(&c.t);
    return r;
}

/* Line through the first four tilts: value at 0 and slope. */
static void line_through(const response r[], int quantity, double line[2])
{
    double X[8], v[4], covariance[4];
    for (int k = 0; k < 4; k++) X[2 * k] = 1.0, X[2 * k + 1] = r[k].t, v[k] = r[k].q[quantity];
    numbers_fit(4, 2, X, NULL, v, line, covariance);
}

static void check_response(checked *o, double mu, double width)
{
    static const char *const names[QUANTITIES] = {"n", "h", "sxx", "sxy", "syx", "syy"};
    response r[TILTS];
    double line[QUANTITIES][2], most, mobilised, balance_error = 0.0;
    for (int k = 0; k < TILTS; k++) {
        r[k] = read_tilt(k, width);
        balance_error = fmax(balance_error, r[k].balance_error);
    }
    for (int i = 0; i < QUANTITIES; i++) {
        line_through(r, i, line[i]);
        for (int a = 0; a < 2; a++) CHECK_NEAR(at(o, 0, check_text("%s_%d", names[i], a)), line[i][a], 1e-9);
    }
    const double *s = &r[0].q[2], last = r[4].t;
    scan_planes(s, &most, &mobilised);
    CHECK_NEAR(at(o, 0, "floor_friction_0"), r[0].q[1] / r[0].q[0], tight);
    CHECK_NEAR(at(o, 0, "bulk_friction_0"), tan(mobilised), 1e-6);
    CHECK_EACH(at(o, 0, NAME), tight, {"couple_0", (s[1] - s[2]) / (s[0] + s[3])},
               {"weight_error", r[0].weight_error}, {"balance_error", balance_error},
               {"friction_4", r[4].q[1] / r[4].q[0]});
    const double beyond = (line[1][0] + line[1][1] * last) / (line[0][0] + line[0][1] * last);
    CHECK_NEAR(at(o, 0, "floor_friction_beyond"), r[4].q[1] / r[4].q[0] - beyond, 1e-9);
    /* friction along the line passes mu there, from below */
    for (int side = -1; side < 2; side += 2) {
        const double t = tan(at(o, 0, "floor_tilt_deg") * deg) + 1e-7 * side;
        CU_ASSERT(((line[1][0] + line[1][1] * t) / (line[0][0] + line[0][1] * t) > mu) == (side > 0));
    }
}

static double slope_of(const char *grains, double width)
{
    scoped_table t = TABLE_OF("angle slope %s --width %g --cell 0.2", grains, width);
    return cell(&t, 2, "theta_deg");
}

/* A cell of the field: force times branch of the two piles, by the segments of the branches. */
static void check_cell(checked *field, size_t row, checked piles[2], double width, double size)
{
    static const char *const names[] = {"sxx", "sxy", "syx", "syy"};
    const double columns = round(width / size), column = fmod((double)row, columns),
                 height = floor((double)row / columns);
    double s[4] = {0.0}, most, mobilised;
    for (size_t p = 0; p < 2; p++)
        for (size_t k = 0; k < piles[p].t.n_rows; k++) {
            const double part = share(&piles[p], k, size, column, height) / (2.0 * size * size);
            if (part == 0.0) continue;
            const force f = force_of(&piles[p], k);
            s[0] += part * f.fx * f.lx, s[1] += part * f.fx * f.ly;
            s[2] += part * f.fy * f.lx, s[3] += part * f.fy * f.ly;
        }
    CHECK_EACH(at(field, row, NAME), 1e-14, {"x/W", (column + 0.5) * size / width},
               {"y/W", (height + 0.5) * size / width});
    const double large = fabs(s[0]) + fabs(s[3]);
    for (int a = 0; a < 4; a++) CHECK_NEAR(at(field, row, names[a]), s[a], tight * large);
    CHECK_EACH(at(field, row, NAME), tight * large, {"p", 0.5 * (s[0] + s[3])},
               {"couple", 0.5 * (s[1] - s[2])});
    scan_planes(s, &most, &mobilised);
    CHECK_NEAR(at(field, row, "p") + at(field, row, "shear"), most, 1e-7 * large);
    const double a = at(field, row, "direction"), x = cos(a), y = sin(a),
                 angle = at(field, row, "mobilised_deg");
    if (large > 0.0) {
        CHECK_NEAR(x * x * s[0] + x * y * (s[1] + s[2]) + y * y * s[3], most, 1e-7 * large);
        CHECK_NEAR(angle, mobilised / deg, 1e-3);
    } else {
        CU_ASSERT(isnan(a) && isnan(angle));
    }
}

/* A column of the floor. The forces on its grains, with their weight, are what is missing in its balance; of
 * the second pile, gravity was tilted. */
static void check_column(checked *base, size_t row, checked contacts[2], checked grains[2], double width,
                         double size, double slope)
{
    double n[2] = {0.0}, h[2] = {0.0}, weight = 0.0, net = 0.0;
    for (size_t p = 0; p < 2; p++) {
        for (size_t k = 0; k < contacts[p].t.n_rows; k++) {
            const force f = force_of(&contacts[p], k);
            if (!f.floor || floor(at(&contacts[p], k, "x") / size) != (double)row) continue;
            n[p] += at(&contacts[p], k, "normal_force") / size;
            h[p] -= at(&contacts[p], k, "shear_force") / size;
        }
        for (size_t i = 0; i < grains[p].t.n_rows; i++) {
            if (floor(at(&grains[p], i, "x") / size) != (double)row) continue;
            weight += 0.5 * 981.0 * at(&grains[p], i, "m") / size;
            const double tilt = p ? 2.0 * deg : 0.0, m = at(&grains[p], i, "m");
            net += 0.5 * (at(&grains[p], i, "fy") + 981.0 * m * (cos(tilt) - 1.0)) / size;
        }
    }
    const double N = 0.5 * (n[0] + n[1]), H = 0.5 * (h[0] + h[1]), large = fabs(N) + fabs(weight) + 1.0,
                 t2 = pow(tan(slope * deg) / tan(55.0 * deg), 2.0);
    CHECK_NEAR(at(base, row, "x/W"), ((double)row + 0.5) * size / width, 1e-14);
    CHECK_EACH(at(base, row, NAME), tight * large, {"N", N}, {"H", H}, {"N_se", 0.5 * fabs(n[0] - n[1])},
               {"H_se", 0.5 * fabs(h[0] - h[1])}, {"weight", weight});
    CHECK_EACH(at(base, row, NAME), 1e-9 * large, {"imbalance", net}, {"through", N - weight - net});
    const double ratio = at(base, row, "H/N");
    CU_ASSERT(N > 0.0 || isnan(ratio));
    if (N > 0.0) CHECK_NEAR(ratio, H / N, 1e-9);
    CHECK_NEAR(at(base, row, "N_theory"), weight / (1.0 - t2), tight * large);
    CHECK_NEAR(at(base, row, "H_theory"), weight / (1.0 - t2) * tan(slope * deg) / pow(tan(55.0 * deg), 2.0),
               tight * large);
}

/* The pile of protocol stress, its field and its base. Two piles are the same one, upright and tilted. */
static void test_stress(void)
{
    const double width = 2.0, mu = 0.4;
    write_text("s.cfg", "protocol = \"stress\"; replicas = 1; seed = 1993;\n"
                        "fixed = { W = 2.0; H = 2.0; mu = 0.4; };\n");
    scoped_checked o = CHECKED_RUN(1, "run s.cfg -o d");
    check_response(&o, mu, width);
    CHECK_NEAR(at(&o, 0, "theta_r3_deg"), slope_of("d/pile_grains.tsv", width), tight);
    CHECK_NEAR(at(&o, 0, "tilts"), TILTS, 0.0);
    checked grains[2] = {checked_read("d/pile_grains.tsv"), checked_read("d/read_4_grains.tsv")},
            contacts[2] = {checked_read("d/pile_contacts.tsv"), checked_read("d/read_4_contacts.tsv")};
    double inside = 0.0;
    for (size_t i = 0; i < grains[0].t.n_rows; i++)
        inside += at(&grains[0], i, "x") > 0.0 && at(&grains[0], i, "x") < width;
    CHECK_NEAR(at(&o, 0, "grains"), inside, 0.0);
    /* to the last tilt at rest and one look, then from the pile on until it moves, 1e-3 degree a step */
    scoped_table last = read_table("d/read_5_grains.tsv");
    CHECK_NEAR(at(&o, 0, "steps"),
               cell(&last, 0, "step") + 500.0 + 1e3 * at(&o, 0, "theta_t_displacement_deg"), 1e-6);
    CHECKED_WORD(&o, 0, "status", "ok");

    GOOD("stress field d/pile d/read_4_contacts.tsv --width 2 --cell 0.42");
    scoped_checked field = checked_read("out");
    CU_ASSERT(field.t.n_rows >= 15 && field.t.n_rows % 5 == 0);
    for (size_t row = 0; row < field.t.n_rows; row++) check_cell(&field, row, contacts, width, 0.4);

    const double slope =
        0.5 * (slope_of("d/pile_grains.tsv", width) + slope_of("d/read_4_grains.tsv", width));
    GOOD("stress base d/pile d/read_4 --width 2 --cell 0.42 --phi-deg 55");
    CHECK_NEAR(strtod(strstr(out, "# theta_r_deg: ") + strlen("# theta_r_deg: "), NULL), slope, tight);
    scoped_checked base = checked_read("out");
    CU_ASSERT(base.t.n_rows > 5);
    for (size_t row = 0; row < base.t.n_rows; row++)
        check_column(&base, row, contacts, grains, width, 0.4, slope);
    for (int p = 0; p < 2; p++) rp_table_free(&grains[p].t), rp_table_free(&contacts[p].t);
}

/* The tilt at which a pile moves is that of protocol repose for the same pile. */
static void test_stress_steps(void)
{
    const sweep_protocol *const protocols[] = {&sweep_protocol_stress, &sweep_protocol_repose};
    sweep_result r;
    double found[2][2];
    for (int k = 0; k < 2; k++) {
        static const char *const names[] = {"theta_r3_deg", "theta_t_displacement_deg"};
        const sweep_protocol *p = protocol_of(protocols[k]);
        scoped void *params = PROTOCOL_PARAMS(p, "W=2.0 H=1.0 mu=0.4", k == 1 ? "theta_t=true" : "");
        CHECK_OK(p->run(params, 1993, 2, NULL, &r));
        for (size_t j = 0; j < 2; j++) found[k][j] = protocol_output(p, &r, names[j]);
    }
    CU_ASSERT(found[0][0] == found[1][0] && found[0][1] == found[1][1] && found[0][1] > 1.0);
}

/* ---- stress dip --profile ---- */

enum { DIP_PILES = 5 };

/* Profiles with a slope to the right and a step in the middle, beside their rays; then one of a failed run,
 * and one without an excess, which do not count. */
static void write_dips(double n[DIP_PILES][STRESS_DIP_BINS], double excess[DIP_PILES])
{
    FILE *file = file_of("piles.tsv");
    fputs("# status\texcess", file);
    for (int k = 1; k <= STRESS_DIP_BINS; k++) fprintf(file, "\tn_%02d\trays_%02d", k, k);
    for (int i = 0; i < DIP_PILES; i++) {
        excess[i] = 0.02 * (i * 3 % 5) - 0.03;
        fprintf(file, "\nok\t%.17g", excess[i]);
        for (int k = 0; k < STRESS_DIP_BINS; k++) {
            n[i][k] = 1.0 + 0.02 * k + 0.03 * ((i * 7 + k * 3) % 5) - (k > 6 && k < 13 ? 0.2 : 0.0);
            fprintf(file, "\t%.17g\t%.17g", n[i][k], 1.0 + 0.1 * i + 0.01 * k * k);
        }
    }
    for (int i = 0; i < 2; i++) {
        fprintf(file, "\n%s\t%s", i ? "ok" : "not_at_rest", i ? "nan" : "10");
        for (int k = 0; k < 2 * STRESS_DIP_BINS; k++) fputs("\t7", file);
    }
    fputc('\n', file);
    fclose(file);
}

/* Of each distance the mean of both sides, its error, and the rays. */
static void check_profile(const stress_dips *d)
{
    scoped_checked c = CHECKED_RUN(STRESS_DIP_BINS / 2, "stress dip piles.tsv --profile");
    for (size_t row = 0; row < c.t.n_rows; row++) {
        const double left = 9.0 - (double)row, right = 10.0 + (double)row;
        CHECK_EACH(at(&c, row, NAME), 1e-13, {"distance", 0.025 + 0.05 * (double)row}, {"N", d->N[row]},
                   {"N_se", d->N_se[row]}, {"rays", 1.2 + 0.005 * (left * left + right * right)});
    }
}

/* Every column of the row. */
static void check_dip(double n[DIP_PILES][STRESS_DIP_BINS], const double excess[DIP_PILES])
{
    stress_dips d;
    CHECK_OK(stress_dip_ensemble(DIP_PILES, n[0], excess, 0.05, &d));
    scoped_checked c = CHECKED_RUN(1, "stress dip piles.tsv");
    const check_value columns[] = {
        {"n", DIP_PILES},           CHECKED_MEAN(d, middle),    {"middle_sd", d.middle.sd},
        {"middle_lo", d.middle.lo}, {"middle_hi", d.middle.hi}, CHECKED_FIELD(d, p_value),
        CHECKED_FIELD(d, p_margin), CHECKED_FIELD(d, below),    CHECKED_FIELD(d, below_se),
        CHECKED_MEAN(d, excess),    {"excess_sd", d.excess.sd}, {"excess_lo", d.excess.lo},
        {"excess_hi", d.excess.hi}};
    checked_row(&c, 0, sizeof columns / sizeof *columns, columns, 1e-15);
    CHECKED_WORD(&c, 0, "verdict", stress_dip_word(&d, 0.05));
    CHECK_NEAR(at(&c, 0, "n_failed"), 1.0, 0.0);
    CHECKED_WORD(&c, 0, "failed_for", "not_at_rest:1");
    check_profile(&d);
}

static void test_dip(void)
{
    double n[DIP_PILES][STRESS_DIP_BINS], excess[DIP_PILES];
    write_dips(n, excess);
    check_dip(n, excess);
    /* without rays */
    shell("cut -f 1-3,5,7,9,11,13,15,17,19,21,23,25,27,29,31,33,35,37,39,41 piles.tsv >plain.tsv");
    scoped_table t = TABLE_OF("stress dip plain.tsv --profile");
    for (size_t row = 0; row < STRESS_DIP_BINS / 2; row++) CU_ASSERT(isnan(cell(&t, row, "rays")));
    SHELL("sed '2,$s/\\t[^\\t]*/\\t0/g' plain.tsv >flat.tsv");
    FAILS(65, "flat.tsv:2: n_01 to n_20: sum = 0: out of range", "stress dip flat.tsv");
}

/* ---- bench ---- */

/* Bytes allocated by malloc. */
static double heap(void)
{
    const struct mallinfo2 now = mallinfo2();
    return (double)(now.uordblks + now.hblkhd);
}

/* A box whose walls are twice as stiff as its grains. */
static void bench_walls(dem_definition *def, double width)
{
    dem_material wall = def->material;
    wall.k_n *= 2.0;
    dem_box_walls(def, width, &wall);
}

/* Clocks that are a second later at each look. */
static void tick(void)
{
    fault_tick = fault_monotonic_tick = 1.0;
}

/* Numbers of the simulation by another one of the same three grains; times by the looks at the clock. */
static void test_bench(void)
{
    dem_grain grains[] = {
        {.x = 0.1, .y = 0.1, .r = 0.1}, {.x = 0.3, .y = 0.1, .r = 0.1}, {.x = 0.2, .y = 0.274, .r = 0.1}};
    enum { STEPS = 3000 };
    write_text("start.tsv", "# y\tx\tr\n0.1\t0.1\t0.1\n0.1\t0.3\t0.1\n0.274\t0.2\t0.1\n");
    scoped_checked c = checked_run(
        __FILE__, __LINE__, 1,
        run_begun(check_text("bench --start start.tsv --steps %d --repeat 2 --width 0.41", STEPS), tick));
    for (int i = 0; i < 3; i++) grains[i].m = 4.0 / 3.0 * M_PI * 1e-3;
    dem_definition def = grains_of(3, grains);
    bench_walls(&def, 0.41);
    const double heap_before = heap();
    scoped_sim *sim = grains_after(&def, 2000);
    const double held = heap() - heap_before;
    const dem_counts before = grains_counts(sim);
    CHECK_OK(dem_run(sim, STEPS));
    const dem_counts after = grains_counts(sim);
    CHECK_EACH(at(&c, 0, NAME), 0.0, {"grains", 3.0}, {"steps", STEPS});
    CHECK_EACH(at(&c, 0, NAME), 1e-15, {"contacts", (double)after.contacts / 3.0},
               {"pairs", (double)after.pairs / 3.0});
    CHECK_NEAR(at(&c, 0, "rebuilds"), (double)(after.rebuilds - before.rebuilds), 0.0);
    CU_ASSERT(after.contacts == 2 && after.pairs == 3);
    const double lists = at(&c, 0, "share_lists"), walls = at(&c, 0, "share_walls"),
                 contacts = at(&c, 0, "share_contacts"), integration = at(&c, 0, "share_integration");
    CHECK_NEAR(contacts + lists + integration + walls, 1.0, 1e-14);
    CU_ASSERT(contacts > 0.0 && lists > 0.0 && integration > 0.0 && walls > 0.0);
    const double median = at(&c, 0, "median"), best = at(&c, 0, "best");
    CHECK_NEAR(at(&c, 0, "bound") * (contacts + integration), median, 1e-14 * median);
    CHECK_PAIRS(1e-15, {median, 3e-6 * STEPS}, {best, 3e-6 * STEPS}); /* grain steps in a second */
    CU_ASSERT(at(&c, 0, "seconds") > STEPS); /* those of the timed run are looked at */
    const double bytes = at(&c, 0, "bytes"), peak = at(&c, 0, "peak_bytes");
    /* of the sanitizers' memory the library knows nothing; what was freed while the table was read, some 2
     * kB, malloc keeps for small pieces and counts as held */
    if (!check_fast()) CHECK_NEAR(3.0 * bytes / held, 1.0, 0.2);
    CU_ASSERT(peak >= 0.0);
}

/* The options of one bench of a box that it fills, and what they mean. */
typedef struct {
    const char *options;
    bool flowing, rotation;
    double mu_roll, size_ratio; /* 0: grains of the default */
    bool sample;                /* a whole run, on a floor of 3 W */
} bench_box;

/* The simulation of such a box until its timed steps, here; of the default's radii, or of those given. A
 * sample is timed from its begin on. */
static dem_sim *bench_sim(const bench_box *b, int n, double width, const rp_table *radii)
{
    scoped dem_grain *grains = calloc((size_t)n, sizeof *grains);
    const dem_fill fill = {n, width, 2.0 * width, 0.1, 0.02, 0.07, 0.13, 1.0, DEM_SPHERE, 1993, 0};
    dem_definition def = grains_of((size_t)n, grains);
    def.rotation = b->rotation, def.damping = DEM_DAMPING_OUTSIDE;
    def.material.mu_roll = b->mu_roll;
    bench_walls(&def, width);
    for (int i = 0; i < n && b->size_ratio > 0.0; i++) grains[i].r = cell(radii, (size_t)i, "r");
    CHECK_OK(b->size_ratio > 0.0 ? dem_fill_place(&fill, grains)
                                 : dem_fill_grains(&fill, grains, &(size_t){0}));
    def.x_max = b->sample ? 3.0 * width : width;
    def.dt = fmin(5e-5, dem_time_step_limit(&def, NULL));
    dem_sim *sim = grains_start(&def);
    if (b->sample) return sim;
    const double settling = 30000.0 * sqrt(width / 4.0) + 10000.0;
    if (b->size_ratio > 0.0) {
        dem_gravity_set(sim, (double[2]){0.0, -9.81});
        CHECK_OK(dem_run(sim, lround(settling * 5e-5 / def.dt)));
        dem_gravity_set(sim, (double[2]){0.0, -981.0});
    }
    CHECK_OK(dem_run(sim, lround(b->size_ratio > 0.0 ? settling * 5e-5 / def.dt : settling)));
    if (b->flowing) dem_wall_open(sim, DEM_BOX_RIGHT, INFINITY);
    return sim;
}

/* The box that bench fills, settled and right after the opening: contacts, pairs and rebuilds of a simulation
 * of the same grains, here, and the grains before the timed steps. */
static void test_bench_fill(void)
{
    static const bench_box list[] = {{"", false, false, 0.0, 0.0},
                                     {"--state flowing", true, false, 0.0, 0.0},
                                     {"--rotation", false, true, 0.0, 0.0},
                                     {"--rotation --mu-roll 0.3 --state flowing", true, true, 0.3, 0.0},
                                     {"--size-ratio 10", false, false, 0.0, 10.0},
                                     {"--size-ratio 1", false, false, 0.0, 1.0}};
    enum { N = 30, STEPS = 2000 };
    const double width = 1.2;
    for (size_t k = check_fast(); k < sizeof list / sizeof *list; k += 1 + check_fast()) {
        GOOD("bench --n %d --width %g --steps %d --repeat 1 --floor absorbs %s -o grains.tsv --force", N,
             width, STEPS, list[k].options);
        scoped_table t = read_table("out"), start = read_table("grains.tsv");
        scoped_sim *sim = bench_sim(&list[k], N, width, &start);
        scoped dem_state *states = grains_states(sim);
        CU_ASSERT_EQUAL(start.n_rows, N);
        for (size_t i = 0; i < N; i++) {
            CHECK_EACH(cell(&start, i, NAME), 0.0, {"x", states[i].x}, {"angle", states[i].angle},
                       {"r", states[i].r});
            /* 1/r is uniform between its ends, at the middles of N equal parts; 1/0.1^2 is their product */
            const double least = 10.0 / sqrt(list[k].size_ratio), most = 10.0 * sqrt(list[k].size_ratio),
                         share = ((double)i + 0.5) / N;
            if (list[k].size_ratio > 0.0)
                CHECK_NEAR(cell(&start, i, "r") * (least * (1.0 - share) + most * share), 1.0, 1e-14);
        }
        const dem_counts before = grains_counts(sim);
        CHECK_OK(dem_run(sim, STEPS));
        const dem_counts after = grains_counts(sim);
        const double left = (double)dem_count(sim);
        CHECK_EACH(cell(&t, 0, NAME), 1e-14, {"contacts", (double)after.contacts / left},
                   {"pairs", (double)after.pairs / left});
        CHECK_NEAR(cell(&t, 0, "rebuilds"), (double)(after.rebuilds - before.rebuilds), 0.0);
        CU_ASSERT(after.contacts > 5);
    }
}

/* So many grains that do not touch, on a square lattice. */
static void write_spread(const char *name, int n)
{
    const int side = (int)ceil(sqrt(n));
    FILE *file = file_of(name);
    fputs("x\ty\tr\n", file);
    for (int i = 0; i < n; i++)
        fprintf(file, "%.17g\t%.17g\t0.08\n", 0.1 + 0.2 * (i % side), 0.1 + 0.2 * (i / side));
    fclose(file);
}

/* Steps by default: 2e7 particle-steps, of grains that flow no more than 10000 steps. The box is as wide as
 * grains of 0.2 cm that fill a square of it, and two of them at least. */
static void test_bench_defaults(void)
{
    static const struct {
        const char *options;
        double steps, width;
    } list[] = {{"--n 2500 --state flowing --start many.tsv", 8000.0, 10.0},
                {"--n 2500 --start many.tsv --steps 200", 200.0, 10.0},
                {"--n 100", 200000.0, 2.0},
                {"--n 100 --state flowing", 10000.0, 2.0},
                {"--n 2 --steps 5", 5.0, 0.4},
                {"--n 5 --steps 6 --width 1", 6.0, 1.0},
                {"--n 2 --state sample --steps 5", 80000.0, 0.4}};
    write_spread("many.tsv", 2500);
    for (size_t k = check_fast() ? 3 : 0; k < sizeof list / sizeof *list; k++) {
        CU_ASSERT(
            good(__FILE__, __LINE__, run_begun(check_text("bench --repeat 1 %s", list[k].options), tick)));
        scoped_table t = read_table("out");
        CU_ASSERT(cell(&t, 0, "seconds") > 0.0);
        CU_ASSERT_EQUAL(rp_table_find_note(&t, "theta_r") != NULL, strstr(list[k].options, "sample") != NULL);
        CHECK_NEAR(cell(&t, 0, "steps"), list[k].steps, 0.0);
        CHECK_NEAR(strtod(rp_table_find_note(&t, "width"), NULL), list[k].width, 1e-14);
        /* of many grains the peak is what they hold, and what their table took before: no more than that */
        const double bytes = cell(&t, 0, "bytes"), peak = cell(&t, 0, "peak_bytes");
        if (k == 0) CU_ASSERT(peak > bytes && peak < 4.0 * bytes);
        /* in a second; 2000 steps before do not count */
        if (!strstr(list[k].options, "--state"))
            CHECK_NEAR(cell(&t, 0, "best"), 1e-6 * cell(&t, 0, "grains") * list[k].steps, 1e-12);
    }
}

/* theta_R of the grains of a table by `angle slope`: over cells as wide as the mean diameter, from the left
 * end of the pile to the wall that has opened. */
static double slope_of_grains(const rp_table *grains, double width)
{
    double d = 0.0, left = INFINITY, bottom = INFINITY;
    for (size_t i = 0; i < grains->n_rows; i++) {
        const double r = cell(grains, i, "r");
        d += 2.0 * r / (double)grains->n_rows;
        left = fmin(left, cell(grains, i, "x") - r);
        bottom = fmin(bottom, cell(grains, i, "y") - r);
    }
    FILE *shifted = file_of("shifted.tsv");
    fputs("x\ty\n", shifted);
    for (size_t i = 0; i < grains->n_rows; i++)
        fprintf(shifted, "%.17g\t%.17g\n", cell(grains, i, "x") - left, cell(grains, i, "y") - bottom);
    fclose(shifted);
    scoped_table t = TABLE_OF("angle slope shifted.tsv --width %.17g --cell %.17g", width - left, d);
    return cell(&t, 2, "theta_deg");
}

/* A sample: 30000 steps closed, 50000 open, the grains at the end, and their slope. Of few grains in a narrow
 * box some leave the floor, which ends at 3 W, and nothing is left with a slope. */
static void test_bench_sample(void)
{
    static const bench_box box = {.sample = true};
    static const int numbers[] = {120, 16};
    static const double widths[] = {2.6, 0.8};
    for (int k = check_fast(); k < 2; k++) {
        GOOD("bench --n %d --width %g --repeat 2 --state sample -o grains.tsv --force", numbers[k],
             widths[k]);
        scoped_table t = read_table("out"), end = read_table("grains.tsv");
        scoped_sim *sim = bench_sim(&box, numbers[k], widths[k], NULL);
        CHECK_OK(dem_run(sim, 30000));
        dem_wall_open(sim, DEM_BOX_RIGHT, INFINITY);
        CHECK_OK(dem_run(sim, 50000));
        scoped dem_state *states = grains_states(sim);
        const dem_counts counts = grains_counts(sim);
        const size_t left = dem_count(sim);
        CU_ASSERT_EQUAL_FATAL(end.n_rows, left);
        for (size_t i = 0; i < left; i++)
            CHECK_EACH(cell(&end, i, NAME), 0.0, {"x", states[i].x}, {"y", states[i].y});
        CHECK_EACH(cell(&t, 0, NAME), 1e-14, {"contacts", (double)counts.contacts / (double)left},
                   {"pairs", (double)counts.pairs / (double)left});
        CHECK_NEAR(cell(&t, 0, "rebuilds"), (double)counts.rebuilds, 0.0);
        const double theta = strtod(rp_table_find_note(&t, "theta_r"), NULL);
        if (k == 0) CHECK_NEAR(theta, slope_of_grains(&end, widths[k]), 1e-9); /* the table has 17 digits */
        CU_ASSERT(k == 0 ? theta > 5.0 : isnan(theta) && left < (size_t)numbers[k]);
    }
}

/* ---- outputs of protocol drop ---- */

enum { DROPPED = 60 };

/* The straight line through the highest points of columns, of one side. */
static double side_angle(const rp_table *grains, const bool away[], double sign)
{
    double x_top = 0.0, height = 0.0, top[40] = {0.0}, n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
    for (size_t i = 0; i < grains->n_rows; i++) {
        const double here = cell(grains, i, "y") + cell(grains, i, "r");
        if (!away[i] && here > height) height = here, x_top = cell(grains, i, "x");
    }
    for (size_t i = 0; i < grains->n_rows; i++) {
        const double along = sign * (cell(grains, i, "x") - x_top) + 0.5;
        if (away[i] || along < 0.0) continue;
        double *t = &top[(size_t)along];
        *t = fmax(*t, cell(grains, i, "y") + cell(grains, i, "r"));
    }
    for (int k = 0; top[k] > 0.1 * height; k++) {
        if (top[k] > 0.9 * height) continue;
        n++, x += k, y += top[k], xx += k * k, xy += k * top[k];
    }
    return -atan((n * xy - x * y) / (n * xx - x * x)) / deg;
}

/* Order of six neighbours about each disk, and whether it is close-packed. Those away are neighbours alone.
 */
static double mean_order(const rp_table *grains, const bool away[], bool packed[])
{
    double sum = 0.0, n = 0.0;
    for (size_t i = 0; i < grains->n_rows; i++) {
        double complex order = 0.0;
        double neighbours = 0.0;
        for (size_t j = 0; j < grains->n_rows; j++) {
            const double dx = cell(grains, j, "x") - cell(grains, i, "x"),
                         dy = cell(grains, j, "y") - cell(grains, i, "y");
            if (i == j || hypot(dx, dy) > 1.25 * (cell(grains, i, "r") + cell(grains, j, "r"))) continue;
            order += cexp(6.0 * I * atan2(dy, dx));
            neighbours++;
        }
        packed[i] = neighbours == 6.0 && cabs(order) >= 0.9 * neighbours;
        if (neighbours >= 2.0 && !away[i]) sum += cabs(order) / neighbours, n++;
    }
    return sum / n;
}

/* Row of the disk that the contact's column `id` names; n_rows: a wall. */
static size_t disk_of(const rp_table *grains, const rp_table *contacts, size_t k, const char *id)
{
    size_t i = 0;
    while (i < grains->n_rows && cell(grains, i, "id") != cell(contacts, k, id)) i++;
    return i;
}

/* Contacts between disks that are the strongest of one of the two: the share within 10 degrees of 60, of all
 * and of those between close-packed disks. Of two disks that rolled away there is none. */
static void check_strongest(checked *o, const rp_table *grains, const rp_table *contacts, const bool away[],
                            const bool packed[])
{
    double all[2] = {0.0}, steep[2] = {0.0}, disks = 0.0, close = 0.0, strongest[DROPPED] = {0.0};
    for (size_t i = 0; i < DROPPED; i++) disks += !away[i], close += packed[i] && !away[i];
    for (int counts = 0; counts < 2; counts++)
        for (size_t k = 0; k < contacts->n_rows; k++) {
            const size_t a = disk_of(grains, contacts, k, "id_a"), b = disk_of(grains, contacts, k, "id_b");
            const double N = cell(contacts, k, "normal_force");
            if (a == DROPPED || b == DROPPED) continue;
            if (!counts) {
                strongest[a] = fmax(strongest[a], N), strongest[b] = fmax(strongest[b], N);
                continue;
            }
            if ((away[a] && away[b]) || (N < strongest[a] && N < strongest[b])) continue;
            const double rise = cell(contacts, k, "y_b") - cell(contacts, k, "y"),
                         run = cell(contacts, k, "x_b") - cell(contacts, k, "x"),
                         slope = fabs(atan(rise / run)) / deg;
            const bool is_steep = slope >= 50.0 && slope <= 70.0, both = packed[a] && packed[b];
            all[0]++, all[1] += both, steep[0] += is_steep, steep[1] += is_steep && both;
        }
    CU_ASSERT(all[1] > 0.0 && steep[0] > 0.0 && steep[0] < all[0]);
    CHECK_EACH(at(o, 0, NAME), 1e-14, {"packed", close / disks}, {"strongest_60", steep[0] / all[0]},
               {"packed_60", steep[1] / all[1]});
}

/* Height along a ray, to the left or right (side -1 or 1), from x on the base to where it leaves an outline:
 * highest points of columns about `middle`, which no slope of 1.7 passes. */
enum { COLUMNS = 61 };

static double ray_height(const double top[COLUMNS], double middle, double x, double side)
{
    double lo = 0.0, hi = 30.0;
    for (int i = 0; i < 60; i++) {
        const double y = 0.5 * (lo + hi), at = x + side * y / sqrt(3.0) - middle + 0.5 * COLUMNS - 0.5,
                     left = floor(at);
        double here = 0.0;
        for (int end = 0; end < 2; end++) {
            double height = 0.0;
            for (int k = 0; k < COLUMNS; k++) height = fmax(height, top[k] - 1.7 * fabs(k - left - end));
            here += height * (end ? at - left : 1.0 - at + left);
        }
        *(y < here ? &lo : &hi) = y;
    }
    return lo;
}

/* Twenty points to a bin. */
static void check_rays(checked *o, const rp_table *grains, const bool away[])
{
    double top[COLUMNS] = {0.0}, rays[20] = {0.0}, sum = 0.0, inner = 0.0, beside = 0.0, of_rays = 0.0;
    for (size_t i = 0; i < grains->n_rows; i++) {
        double *t = &top[(size_t)(cell(grains, i, "x") + 30.0)];
        if (!away[i]) *t = fmax(*t, cell(grains, i, "y") + cell(grains, i, "r"));
    }
    for (int p = 0; p < 400; p++) {
        const double x = at(o, 0, "centroid") + at(o, 0, "width") * ((p + 0.5) / 400.0 - 0.5);
        /* the middle column is from 0 to 1 */
        rays[p / 20] += ray_height(top, 0.5, x, -1.0) + ray_height(top, 0.5, x, 1.0);
    }
    for (int b = 0; b < 20; b++) sum += rays[b];
    for (int b = 0; b < 20; b++) {
        CHECK_NEAR(at(o, 0, check_text("rays_%02d", b + 1)), 20.0 * rays[b] / sum, 1e-9);
        const double distance = fabs(b - 9.5), n = at(o, 0, check_text("n_%02d", b + 1));
        if (distance < 2.0) inner += (n - 20.0 * rays[b] / sum) / 4.0;
        const double share = distance < 2.0 ? 0.25 : distance < 4.0 ? -0.25 : 0.0;
        beside += share * n, of_rays += share * 20.0 * rays[b] / sum;
    }
    CHECK_NEAR(at(o, 0, "excess"), inner, 1e-9);
    CHECK_NEAR(at(o, 0, "middle"), beside, 1e-12);
    CHECK_EACH(at(o, 0, NAME), 1e-9, {"rays_middle", of_rays}, {"arching", beside - of_rays},
               {"minimum", beside < 0.0 ? 1.0 : 0.0});
}

/* Disks glued to the base have their centres on it. */
static bool is_glued(const rp_table *grains, size_t i)
{
    return cell(grains, i, "y") == 0.0;
}

/* Does a disk of the pile touch the base there? Which, and the base's force on it, by the angle of the line
 * from the base to its centre: N along that line, the shear force along the line turned clockwise. */
static bool on_base(const rp_table *grains, const rp_table *contacts, size_t k, size_t *disk, double f[2])
{
    const size_t a = disk_of(grains, contacts, k, "id_a"), b = disk_of(grains, contacts, k, "id_b");
    const bool wall = b == grains->n_rows, b_below = wall || is_glued(grains, b);
    if (!b_below && !is_glued(grains, a)) return false;
    *disk = b_below ? a : b;
    const double N = cell(contacts, k, "normal_force"), S = cell(contacts, k, "shear_force"),
                 angle = atan2(cell(contacts, k, "y") - cell(contacts, k, "y_b"),
                               cell(contacts, k, "x") - cell(contacts, k, "x_b")) +
                         (b_below ? 0.0 : acos(-1.0));
    f[0] = N * cos(angle) + S * sin(angle);
    f[1] = N * sin(angle) - S * cos(angle);
    return true;
}

/* Directions of the contacts between disks of the pile beyond 0.2 sqrt(N) from its middle, mirrored
 * to the right: principal axis of the tensor sum w n n, by its two invariants and by trying all axes. */
static void check_fabric(checked *o, const rp_table *grains, const rp_table *contacts, double limit,
                         const char *fabric, const char *degrees, const char *weight)
{
    double xx = 0.0, xy = 0.0, yy = 0.0, most = 0.0, lean = 0.0;
    for (size_t k = 0; k < contacts->n_rows; k++) {
        const size_t ends[2] = {disk_of(grains, contacts, k, "id_a"), disk_of(grains, contacts, k, "id_b")};
        bool counts = true;
        for (int e = 0; e < 2; e++)
            counts = counts && ends[e] < grains->n_rows && !is_glued(grains, ends[e]) &&
                     fabs(cell(grains, ends[e], "x")) <= limit;
        const double middle = 0.5 * (cell(contacts, k, "x") + cell(contacts, k, "x_b"));
        if (!counts || fabs(middle) <= 0.2 * sqrt(DROPPED)) continue;
        const double angle =
                         atan2(cell(contacts, k, "y_b") - cell(contacts, k, "y"),
                               (cell(contacts, k, "x_b") - cell(contacts, k, "x")) * (middle < 0.0 ? -1 : 1)),
                     w = weight ? cell(contacts, k, weight) : 1.0;
        xx += w * cos(angle) * cos(angle), xy += w * cos(angle) * sin(angle),
            yy += w * sin(angle) * sin(angle);
    }
    for (int i = -9000; i < 9000; i++) { /* the upper end is at x = -sin: towards the middle */
        const double here = 0.01 * i * deg, along = xx * sin(here) * sin(here) -
                                                    2.0 * xy * sin(here) * cos(here) +
                                                    yy * cos(here) * cos(here);
        if (along > most) most = along, lean = 0.01 * i;
    }
    CHECK_NEAR(at(o, 0, fabric), sqrt(1.0 - 4.0 * (xx * yy - xy * xy) / ((xx + yy) * (xx + yy))), 1e-9);
    CHECK_NEAR(at(o, 0, degrees), lean, 0.01);
    CHECK_NEAR(at(o, 0, weight ? "lean_force_deg" : "lean_deg"), -lean, 0.01);
    CU_ASSERT(fabs(lean) > 0.1);
}

static void check_base(checked *o, const rp_table *grains, const rp_table *contacts, double limit)
{
    enum { MOST = 3 * DROPPED };
    double x[MOST], r[MOST], N[MOST], H[MOST], total = 0.0, moment = 0.0, weight = 0.0, width = INFINITY,
                                               outward = 0.0, f[2];
    size_t n = 0, i;
    for (size_t k = 0; k < contacts->n_rows && n < MOST; k++) {
        if (!on_base(grains, contacts, k, &i, f) || fabs(cell(grains, i, "x")) > limit) continue;
        x[n] = cell(grains, i, "x"), r[n] = cell(grains, i, "r"), H[n] = -f[0], N[n] = f[1];
        total += N[n], moment += N[n] * x[n], n++;
    }
    for (i = 0; i < grains->n_rows; i++)
        if (fabs(cell(grains, i, "x")) <= limit && !is_glued(grains, i)) weight += cell(grains, i, "m");
    const double centroid = moment / total;
    for (size_t k = 0; k < n; k++) outward += H[k] * (x[k] > centroid ? 1.0 : -1.0);
    CHECK_NEAR(at(o, 0, "shear"), outward / total, 1e-12);
    CU_ASSERT(outward > 0.01 * total);
    for (size_t k = 0; k < n; k++) { /* the least width that holds 98 % */
        double held = 0.0;
        for (size_t j = 0; j < n; j++) held += fabs(x[j] - centroid) <= fabs(x[k] - centroid) ? N[j] : 0.0;
        if (held >= 0.98 * total) width = fmin(width, 2.0 * fabs(x[k] - centroid));
    }
    CHECK_EACH(at(o, 0, NAME), 1e-12, {"centroid", centroid}, {"width", width});
    CHECK_NEAR(at(o, 0, "load"), total, 1e-12 * total);
    CHECK_NEAR(at(o, 0, "balance"), 1.0 - total / weight, 1e-12);
    /* load left of a line, each disk's spread evenly over its width; bins are differences */
    double left[21], pressure[20], dip = 0.0;
    for (int b = 0; b <= 20; b++) {
        const double line = centroid + width * (b / 20.0 - 0.5);
        left[b] = 0.0;
        for (size_t k = 0; k < n; k++)
            left[b] += N[k] * fmin(fmax(0.5 + 0.5 * (line - x[k]) / r[k], 0.0), 1.0);
    }
    for (int b = 0; b < 20; b++) {
        pressure[b] = 20.0 * (left[b + 1] - left[b]) / (left[20] - left[0]);
        CHECK_NEAR(at(o, 0, check_text("n_%02d", b + 1)), pressure[b], 1e-11);
        const double distance = fabs(b - 9.5);
        dip += distance < 2.0 ? pressure[b] / 4.0 : distance < 6.0 ? -pressure[b] / 8.0 : 0.0;
    }
    CHECK_NEAR(at(o, 0, "dip"), dip, 1e-12);
}

/* A pile on glued disks: those are no part of it. */
static void test_rough(void)
{
    const double limit = 15.0;
    write_text("s.cfg",
               "protocol = \"drop\"; replicas = 1; seed = 1993;\n"
               "fixed = { N = %d; glued = 1.3; x_limit = %.1f; };\n",
               DROPPED, limit);
    checked o = CHECKED_RUN(1, "run s.cfg -o d");
    scoped_table grains = read_table("d/pile_grains.tsv"), contacts = read_table("d/pile_contacts.tsv");
    double glued = 0.0, carried = 0.0, contact_number = 0.0, height = 0.0, right = -INFINITY;
    for (size_t i = 0; i < grains.n_rows; i++) {
        if (is_glued(&grains, i)) { /* 1.3 apart, the middle is between two */
            CHECK_NEAR(cell(&grains, i, "x"), 1.3 * ((double)i - 12.5), 1e-12);
            CHECK_NEAR(cell(&grains, i, "r"), 0.5, 0.0);
            right = cell(&grains, i, "x");
            glued++, carried -= cell(&grains, i, "fy");
            continue;
        }
        contact_number += cell(&grains, i, "contacts") / DROPPED;
        height = fmax(height, cell(&grains, i, "y") + cell(&grains, i, "r"));
    }
    CU_ASSERT(glued == 26.0 && grains.n_rows == DROPPED + 26 && right > limit);
    CHECK_EACH(at(&o, 0, NAME), 0.0, {"disks", DROPPED}, {"away", 0.0}, {"height", height});
    CHECK_EACH(at(&o, 0, NAME), 1e-12, {"contacts", contact_number}, {"balance", 1.0 - carried / DROPPED});
    CHECK_NEAR(at(&o, 0, "balance"), 0.0, 1e-5);
    check_base(&o, &grains, &contacts, limit);
    check_fabric(&o, &grains, &contacts, limit, "fabric", "fabric_deg", NULL);
    rp_table_free(&o.t);
}

/* A lattice on glued disks: places of protocol `pile`, whose base is the glued row, radii of its scatter. */
static void test_lattice(void)
{
    write_text("s.cfg",
               "protocol = \"drop\"; replicas = 1; seed = 1993;\n"
               "fixed = { N = 0; lattice = 13; lattice_deg = 45.0; glued = 1.0; x_limit = 15.0; mu = 0.1;\n"
               "          radius_width = 1e-3; };\n");
    write_text("p.cfg", "protocol = \"pile\"; replicas = 1; seed = 1993;\n"
                        "fixed = { base = 13; alpha_deg = 45.0; disorder = 1e-3; };\n");
    GOOD("run s.cfg -o d");
    GOOD("run p.cfg -o p");
    scoped_table grains = read_table("d/pile_grains.tsv"), disks = read_table("p/disks.tsv");
    size_t n = 0;
    while (n < grains.n_rows && is_glued(&grains, n)) n++;
    const double unequal = (double)(grains.n_rows - n);
    double square = 0.0;
    for (size_t i = 0; i < disks.n_rows; i++) {
        if (cell(&disks, i, "y") < 0.6) continue; /* the base */
        CU_ASSERT_FATAL(n < grains.n_rows);
        square += pow(cell(&grains, n, "r") / 0.5 - 1.0, 2.0);
        CHECK_NEAR(cell(&grains, n, "m"), 4.0 * pow(cell(&grains, n, "r"), 2.0), 1e-12);
        double nearest = INFINITY;
        for (size_t j = 0; j < grains.n_rows; j++)
            nearest = fmin(nearest, hypot(cell(&grains, j, "x") + 6.5 - cell(&disks, i, "x"),
                                          cell(&grains, j, "y") + 0.5 - cell(&disks, i, "y")));
        CHECK_NEAR(nearest, 0.0, 0.03);
        n++;
    }
    CU_ASSERT(n == grains.n_rows);
    CHECK_NEAR(sqrt(square / unequal), 1e-3, 4e-4);
}

/* A pile from which some disks roll away: all from its grains, its contacts and what each drop moved. */
static void test_drop(void)
{
    const double limit = 10.0;
    write_text("s.cfg",
               "protocol = \"drop\"; replicas = 1; seed = 1996;\n"
               "fixed = { N = %d; radius_width = 0.05; mu_roll = 0.03; x_limit = %.1f; };\n",
               DROPPED, limit);
    scoped_checked o = CHECKED_RUN(1, "run s.cfg -o d"), drops = checked_read("d/series_moved_max.tsv");
    scoped_table grains = read_table("d/pile_grains.tsv"), contacts = read_table("d/pile_contacts.tsv");
    bool away[DROPPED], packed[DROPPED];
    double disks = 0.0, height = 0.0, touching = 0.0, most = 0.0, large = 0.0;
    CU_ASSERT_FATAL(grains.n_rows == DROPPED && drops.t.n_rows == DROPPED);
    for (size_t i = 0; i < DROPPED; i++) {
        CU_ASSERT(at(&drops, i, "step") > (i ? at(&drops, i - 1, "step") : 0.0) &&
                  at(&drops, i, "time") > 0.0);
        most = fmax(most, at(&drops, i, "moved_max")), large += at(&drops, i, "moved_max") > 10.0;
        CU_ASSERT(at(&drops, i, "moved_max") <= (double)i);
        away[i] = fabs(cell(&grains, i, "x")) > limit;
        if (away[i]) continue;
        disks++;
        touching += cell(&grains, i, "contacts");
        height = fmax(height, cell(&grains, i, "y") + cell(&grains, i, "r"));
    }
    CU_ASSERT(disks > 40.0 && disks < DROPPED && large > 0.0);
    CHECK_EACH(at(&o, 0, NAME), 0.0, {"disks", disks}, {"away", DROPPED - disks}, {"height", height});
    CHECK_NEAR(at(&o, 0, "contacts"), touching / disks, 1e-14);
    CHECK_NEAR(at(&o, 0, "moved_max"), most, 0.0);
    CHECK_NEAR(at(&o, 0, "moved_share"), large / DROPPED, 1e-14);
    CHECK_EACH(at(&o, 0, NAME), 1e-11, {"left_deg", side_angle(&grains, away, -1.0)},
               {"right_deg", side_angle(&grains, away, 1.0)});
    CHECK_NEAR(at(&o, 0, "psi6"), mean_order(&grains, away, packed), 1e-12);
    check_strongest(&o, &grains, &contacts, away, packed);
    CU_ASSERT(fmod(at(&o, 0, "steps"), 20.0) == 0.0 && at(&o, 0, "steps") > 20.0 * DROPPED);
    /* ten looks in a row, of 20 steps each, end the relaxation */
    CU_ASSERT(fmod(at(&o, 0, "relax_steps"), 20.0) == 0.0 && at(&o, 0, "relax_steps") >= 200.0);
    CHECK_NEAR(at(&o, 0, "capped_share"), 0.0, 0.0);
    CU_ASSERT(at(&o, 0, "settled") >= 0.0 && at(&o, 0, "settled") < 0.2 * disks);
    CHECKED_WORD(&o, 0, "status", "ok");
    check_base(&o, &grains, &contacts, limit);
    check_fabric(&o, &grains, &contacts, limit, "fabric", "fabric_deg", NULL);
    check_fabric(&o, &grains, &contacts, limit, "force_fabric", "force_deg", "normal_force");
    check_rays(&o, &grains, away);
}

/* Of two disks the second one can move the first, and does in some of six piles; none moves before. */
static void test_drop_of_two(void)
{
    double moved = 0.0;
    write_text("s.cfg", "protocol = \"drop\"; replicas = 6; seed = 1; fixed = { N = 2; };\n");
    for (int k = 0; k < 6; k++) {
        run("run s.cfg --row %d -o d%d", k, k);
        scoped_table t = read_table(check_text("d%d/series_moved_max.tsv", k));
        CU_ASSERT_FATAL(t.n_rows == 2);
        CHECK_NEAR(cell(&t, 0, "moved_max"), 0.0, 0.0);
        CU_ASSERT(cell(&t, 1, "moved_max") <= 1.0);
        moved += cell(&t, 1, "moved_max");
    }
    CU_ASSERT(moved > 0.0 && moved < 6.0);
}

CHECK_SUITE_WITHIN(columns, "columns", enter, leave, test_stress, test_stress_steps, test_dip, test_bench,
                   test_bench_fill, test_bench_defaults, test_bench_sample, test_drop, test_rough,
                   test_lattice, test_drop_of_two)
