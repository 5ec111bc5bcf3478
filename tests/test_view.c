/* What is seen. Pictures by their contents: an svg file has each grain, force and wall at its position, in
 * its colour and width; a gif file has every frame. */
#include <stdlib.h>
#include <string.h>

#include "cli/watch.h"
#include "tests/check.h"
#include "tests/program.h"

/* ---- the marks of an svg file ---- */

typedef struct {
    double x, y, r; /* of a circle; of a line the first point, and its width */
    double x2, y2;
    char color[32];
} mark;

enum { MOST = 400 };
static mark circles[MOST], strokes[MOST];
static size_t n_circles, n_strokes;
static char svg[1 << 20];

/* The straight lines of a path. */
static void read_path(const char *path, double width)
{
    mark m = {.r = width};
    int length = 0;
    double x, y;
    char how;
    if (sscanf(path, "<path stroke='%31[^']' d='%n", m.color, &length) != 1 || length == 0) return;
    for (path += length; sscanf(path, " %c%lf,%lf%n", &how, &x, &y, &length) == 3; path += length) {
        m.x = m.x2, m.y = m.y2, m.x2 = x, m.y2 = y;
        if (how == 'L' && n_strokes < MOST) strokes[n_strokes++] = m;
    }
}

/* gnuplot draws each grain by two points, its outline and its fill. */
static void read_svg(const char *name)
{
    double width = 0.0;
    n_circles = n_strokes = 0;
    slurp(name, svg, sizeof svg);
    CU_ASSERT(strncmp(svg, "<?xml", 5) == 0 && strstr(svg, "</svg>") != NULL);
    for (const char *tag = svg; (tag = strchr(tag, '<')); tag++) {
        mark m;
        if (strncmp(tag, "<path", 5) == 0) read_path(tag, width);
        if (strncmp(tag, "<g fill", 7) == 0) width = strtod(strstr(tag, "stroke-width=") + 14, NULL);
        if (n_circles < MOST &&
            sscanf(tag, "<use xlink:href='#gpPt6' transform='translate(%lf,%lf) scale(%lf)' color='%31[^']",
                   &m.x, &m.y, &m.r, m.color) == 4)
            circles[n_circles++] = m;
    }
}

static const mark *find_stroke(const char *color)
{
    const mark *found = NULL;
    for (size_t k = 0; k < n_strokes; k++)
        if (strcmp(strokes[k].color, color) == 0) found = &strokes[k]; /* the last: drawn on top */
    return found;
}

static size_t count_strokes(const char *color)
{
    size_t n = 0;
    for (size_t k = 0; k < n_strokes; k++) n += strcmp(strokes[k].color, color) == 0;
    return n;
}

/* ---- pictures ---- */

static const char OUTLINE[] = "rgb(168, 168, 168)", GRAIN[] = "rgb(238, 238, 238)",
                  STRONGEST[] = "rgb(  8,  24,  58)", WALL[] = "rgb( 64,  64,  64)",
                  PULL[] = "rgb(213,  94,   0)", PRESS[] = "rgb(  0, 114, 178)";

/* Three grains of different radii on a floor, SI units: forces of 6 and 0.5 N between them, 12 N below. */
static void write_pile(void)
{
    write_text("states.tsv", "# units: 1\ts\t1\tm\tm\tm\tkg\nstep\tt\tid\tx\ty\tr\tm\n7\t0.5\t1\t0\t1\t1\t3\n"
                             "7\t0.5\t2\t2.5\t1.5\t1.5\t5\n7\t0.5\t3\t5\t1.5\t1\t4\n");
    write_text("contacts.tsv",
               "# units: 1\ts\t1\t1\t1\tm\tm\tm\tm\tN\tN\n"
               "step\tt\tid_a\tid_b\twall\tx\ty\tx_b\ty_b\tnormal_force\tshear_force\n"
               "7\t0.5\t2\t0\t1\t2.5\t1.5\t2.5\t0\t12\t0\n7\t0.5\t1\t2\t0\t0\t1\t2.5\t1.5\t6\t0\n"
               "7\t0.5\t2\t3\t0\t2.5\t1.5\t5\t1.5\t-0.5\t0\n");
    write_text("walls.tsv", "step\tt\twall\tx\ty\tdirection_x\tdirection_y\tfrom\tto\n"
                            "7\t0.5\t1\t0\t0\t0\t1\t-inf\tinf\n7\t0.5\t2\t-1\t0\t1\t0\t-3\t-3\n"
                            "7\t0.5\t3\t6\t0\t-1\t0\t0\t2\n");
}

/* Pixels a metre, from the first two grains' centres: the axes have one scale, y upwards. */
static void test_circles(void)
{
    static const double x[] = {0.0, 2.5, 5.0}, y[] = {1.0, 1.5, 1.5}, r[] = {1.0, 1.5, 1.0};
    enter();
    write_pile();
    GOOD("view . -o a.svg");
    read_svg("a.svg");
    CU_ASSERT_FATAL(n_circles == 6);
    const double scale = (circles[1].x - circles[0].x) / 2.5;
    CU_ASSERT(scale > 60.0);
    for (int i = 0; i < 6; i++) {
        const mark *c = &circles[i];
        CU_ASSERT_STRING_EQUAL(c->color, i < 3 ? OUTLINE : GRAIN);
        CHECK_NEAR(c->x - circles[0].x, scale * (x[i % 3] - x[0]), 0.02); /* hundredths are printed */
        CHECK_NEAR(c->y - circles[0].y, -scale * (y[i % 3] - y[0]), 0.02);
        /* the picture is a whole number of pixels wide, up to half a pixel of 680 less */
        CHECK_NEAR(c->r, scale * r[i % 3] + (i < 3 ? 0.25 : -0.25), 0.03 + scale * r[i % 3] * 0.5 / 680.0);
    }
    leave();
}

/* Each force is a line between the centres of its contact, the strongest last. Its colour and its width are
 * those of its force over the largest, in twelve steps. */
static void test_forces(void)
{
    enter();
    write_pile();
    GOOD("view . -o a.svg");
    read_svg("a.svg");
    const mark *strong = find_stroke(STRONGEST), *pull = find_stroke(PULL), *wall = find_stroke(WALL);
    CU_ASSERT_FATAL(strong && pull && wall && n_circles == 6);
    const double scale = (circles[1].x - circles[0].x) / 2.5;
    CU_ASSERT(count_strokes(STRONGEST) == 2 && count_strokes(PULL) == 1); /* with the sample in the key */
    for (size_t k = 0; k < n_strokes; k++) {
        const mark *m = &strokes[k];
        if (strcmp(m->color, STRONGEST) == 0 && m->x == m->x2) { /* 12 of 12 */
            CHECK_NEAR(m->x, circles[1].x, 0.02);
            CHECK_NEAR(fabs(m->y2 - m->y), 1.5 * scale, 0.02);
            strong = m;
        }
    }
    CHECK_NEAR(pull->r / strong->r, 0.5 / 11.5, 0.02);
    const mark *half = NULL;  /* 6 of 12 */
    CU_ASSERT(strong > pull); /* the strongest is drawn last */
    for (size_t k = 0; k < n_strokes; k++)
        if (fabs(strokes[k].r / strong->r - 5.5 / 11.5) < 0.01) half = &strokes[k];
    CU_ASSERT_FATAL(half != NULL);
    /* class 6 of 12, on the way from the pale colour of the figures to the dark one */
    const char *grain, *outline;
    int classes, pale_r, pale_g, pale_b, dark_r, dark_g, dark_b;
#include "figures/chains.gp"
    char shade[32];
    snprintf(shade, sizeof shade, "rgb(%3ld, %3ld, %3ld)", lround((6.0 * pale_r + 5.0 * dark_r) / 11.0),
             lround((6.0 * pale_g + 5.0 * dark_g) / 11.0), lround((6.0 * pale_b + 5.0 * dark_b) / 11.0));
    CU_ASSERT(classes == 12 && *grain == '#' && *outline == '#');
    CU_ASSERT_STRING_EQUAL(half->color, shade);
    CHECK_NEAR(half->x, circles[0].x, 0.02);
    CHECK_NEAR(half->y, circles[0].y, 0.02);
    CHECK_NEAR(half->x2, circles[1].x, 0.02);
    CHECK_NEAR(half->y2, circles[1].y, 0.02);
    CU_ASSERT(count_strokes(WALL) == 2); /* the open wall has nothing left */
    CU_ASSERT(shell("grep -q 'normal force 12 N' a.svg && grep -q 'x (m)' a.svg && "
                    "grep -q 'step 7, t = 0.5 s, 3 grains' a.svg") == 0);
    leave();
}

/* Walls without end reach from border to border of the window: a level one, an upright one, and two that
 * slope, of which each end lies on one of the borders. */
static void test_slopes(void)
{
    enter();
    write_pile();
    write_text("walls.tsv",
               "step\tt\twall\tx\ty\tdirection_x\tdirection_y\tfrom\tto\n"
               "7\t0.5\t1\t0\t0\t0\t1\t-inf\tinf\n7\t0.5\t2\t2\t1\t1\t0\t-inf\tinf\n"
               "7\t0.5\t3\t1\t1\t0.6\t0.8\t-inf\tinf\n7\t0.5\t4\t3\t1\t-0.96\t0.28\t-inf\tinf\n");
    GOOD("view . -o a.svg --window -2,7,-1,4");
    read_svg("a.svg");
    CU_ASSERT_FATAL(n_circles == 6 && count_strokes(WALL) == 4);
    const double scale = (circles[1].x - circles[0].x) / 2.5, borders[2][2] = {{-2.0, 7.0}, {-1.0, 4.0}},
                 least = 0.05; /* lines are wide, and hundredths of a pixel are printed */
    size_t level = 0, upright = 0, slopes = 0;
    for (size_t k = 0; k < n_strokes; k++) {
        const mark *m = &strokes[k];
        if (strcmp(m->color, WALL) != 0) continue;
        const double x[] = {(m->x - circles[0].x) / scale, (m->x2 - circles[0].x) / scale},
                     y[] = {1.0 - (m->y - circles[0].y) / scale, 1.0 - (m->y2 - circles[0].y) / scale};
        level += fabs(y[0]) < least && fabs(y[1]) < least && fabs(fabs(x[1] - x[0]) - 9.0) < least;
        upright += fabs(x[0] - 2.0) < least && fabs(fabs(y[1] - y[0]) - 5.0) < least;
        int at_border = 0;
        for (int end = 0; end < 2; end++) {
            const double third = 0.6 * (x[end] - 1.0) + 0.8 * (y[end] - 1.0),
                         fourth = -0.96 * (x[end] - 3.0) + 0.28 * (y[end] - 1.0);
            const bool is_on = fabs(third) < least || fabs(fourth) < least;
            bool is_end = false;
            for (int b = 0; b < 2; b++)
                is_end |= fabs(x[end] - borders[0][b]) < least || fabs(y[end] - borders[1][b]) < least;
            at_border += is_on && is_end;
        }
        slopes += at_border == 2 && fabs(x[1] - x[0]) > 1.0 && fabs(y[1] - y[0]) > 1.0;
    }
    CU_ASSERT(level == 1 && upright == 1 && slopes == 2);
    leave();
}

/* A segment is drawn as far as half the size of the grains' region, whichever side of that is longer. */
static void test_segment(void)
{
    enter();
    for (int tall = 0; tall < 2; tall++) {
        write_text("pile_grains.tsv", "x\ty\tr\n0\t0\t1\n%d\t%d\t1\n", tall ? 0 : 10, tall ? 10 : 0);
        write_text("pile_walls.tsv",
                   "wall\tx\ty\tdirection_x\tdirection_y\tfrom\tto\n1\t0\t0\t%d\t%d\t-30\t30\n",
                   tall ? 0 : -1, tall);
        GOOD("view pile_grains.tsv -o a.svg");
        read_svg("a.svg");
        const mark *wall = find_stroke(WALL);
        CU_ASSERT_FATAL(n_circles == 4 && wall != NULL);
        const double scale = hypot(circles[1].x - circles[0].x, circles[1].y - circles[0].y) / 10.0;
        /* the grains' region is 12 by 2; half of 12 and a radius to both sides of 2 */
        CHECK_NEAR(hypot(wall->x2 - wall->x, wall->y2 - wall->y) / scale, 16.0, 0.1);
    }
    leave();
}

/* Corners of frame number `which`, from above: least and largest x, least and largest y. A frame begins with
 * its left side, downwards, and is wider than a bar of colours; it is drawn twice, below the grains and
 * above. */
static void find_frame(size_t which, double corners[4])
{
    size_t n = 0;
    for (size_t k = 0; k < 4; k++) corners[k] = NAN;
    for (size_t k = 0; k + 4 < n_strokes; k++) {
        const mark *left = &strokes[k], *base = left + 1;
        if (strcmp(left->color, "black") != 0 || left->x != left->x2 || left->y2 < left->y + 30.0 ||
            base->x2 < base->x + 100.0 || n++ / 2 != which)
            continue;
        memcpy(corners, (double[]){left->x, base->x2, left->y, left->y2}, 4 * sizeof *corners);
    }
}

/* Labels left of a frame, which are to be 0, step, 2 step ...: their number, -1 if one is not; heights of the
 * first and of the last. */
static int count_marks(const double frame[4], double step, double at[2])
{
    int n = 0;
    for (const char *tag = svg; (tag = strstr(tag, "<g transform=\"translate(")); tag++) {
        double x, y, value;
        if (sscanf(tag, "<g transform=\"translate(%lf,%lf)\"", &x, &y) != 2 || x > frame[0] || y < frame[2] ||
            sscanf(strchr(tag, '\n'), " <text><tspan font-family=\"DejaVu Sans\" >%lf", &value) != 1)
            continue;
        if (fabs(value - n * step) > 1e-9 * step) return -1;
        at[n > 0] = y;
        n++;
    }
    return n;
}

/* The frame is the window, at the grains' scale, with room for labels: on the left 1.8 cm, on the right 0.7
 * cm or 2.6 with a bar of colours, above 1.4 cm, below 1.5. The pressure has a frame of 3.2 cm less its
 * labels below. No text is outside the picture. */
static void test_layout(void)
{
    static const struct {
        const char *words;
        double width, right, panel, x, y; /* of the window */
    } cases[] = {{"", 18.0, 0.7, 0.0, 9.0 + 1.0 / 3.0, 5.0 + 1.0 / 3.0},
                 {"--color m", 18.0, 2.6, 0.0, 9.0 + 1.0 / 3.0, 5.0 + 1.0 / 3.0},
                 {"--width 30 --window -2,8,-1,4", 30.0, 0.7, 0.0, 10.0, 5.0},
                 {"--base --width 12 --window -2,8,-1,5", 12.0, 0.7, 3.2, 10.0, 6.0},
                 /* as high as is allowed, and as wide as labels need; as low as is allowed */
                 {"--window -1,4,-1,19", 11.0, 0.7, 0.0, 5.0, 20.0},
                 {"--window -1,9,-1,13.5", 1.8 + 14.0 * 10.0 / 14.5 + 0.7, 0.7, 0.0, 10.0, 14.5},
                 {"--window -20,20,-1,1", 18.0, 0.7, 0.0, 40.0, 1.2 * 40.0 / 15.5}};
    enter();
    write_pile();
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        double width, height, frame[4], panel[4], at[2];
        GOOD("view . -o a.svg %s", cases[k].words);
        read_svg("a.svg");
        CU_ASSERT_FATAL(sscanf(strstr(svg, "viewBox=") + 9, "0 0 %lf %lf", &width, &height) == 2);
        const double cm = width / cases[k].width;
        CHECK_NEAR(cm, 37.8, 0.06); /* whole pixels */
        find_frame(0, frame);
        const double scale = (circles[1].x - circles[0].x) / 2.5;
        CHECK_NEAR((frame[1] - frame[0]) / scale, cases[k].x, 0.01);
        CHECK_NEAR((frame[3] - frame[2]) / scale, cases[k].y, 0.01);
        const bool is_tall = cases[k].y > cases[k].x; /* centred */
        if (!is_tall) CHECK_NEAR(frame[0], 1.8 * cm, 1.0);
        if (!is_tall) CHECK_NEAR(frame[1], width - cases[k].right * cm, 1.0);
        CHECK_NEAR(frame[2], 1.4 * cm, 1.0);
        CHECK_NEAR(frame[3], height - (1.5 + cases[k].panel) * cm, 1.0);
        find_frame(1, panel);
        if (cases[k].panel > 0.0) {
            CHECK_NEAR(panel[0], frame[0], 0.02);
            CHECK_NEAR(panel[1], frame[1], 1.0);
            CHECK_NEAR(panel[2], frame[3] + 1.3 * cm, 1.0);
            CHECK_NEAR(panel[3], height - 1.5 * cm, 1.0);
        }
        for (const char *label = svg; (label = strstr(label, "<g transform=\"translate(")); label++) {
            CU_ASSERT_FATAL(sscanf(label, "<g transform=\"translate(%lf,%lf)", &at[0], &at[1]) == 2);
            CU_ASSERT(at[0] > 11.0 && at[0] < width && at[1] > 11.0 && at[1] < height);
        }
    }
    leave();
}

/* The picture that these words ask for has n grains of these colours. */
static void check_colors(const char *words, size_t n, const char *const colors[])
{
    GOOD("view %s", words);
    read_svg("a.svg");
    CU_ASSERT_FATAL(n_circles == 2 * n); /* below each, its outline */
    for (size_t i = 0; i < n; i++) CU_ASSERT_STRING_EQUAL(circles[n + i].color, colors[i]);
}

/* Colours run from the least to the largest value of the column; of both signs, white is 0. */
static void test_colors(void)
{
    static const char LEAST[] = "rgb( 43, 123, 186)", ZERO[] = "rgb(247, 247, 247)",
                      LARGEST[] = "rgb(230,  97,   1)";
    enter();
    write_pile();
    check_colors(". -o a.svg --color m", 3,
                 (const char *[]){"rgb(255, 247, 188)", "rgb(204,  76,   2)", "rgb(254, 153,  41)"});
    CU_ASSERT(shell("grep -q 'm (kg)' a.svg") == 0);
    write_text("t.csv", "x,y,r,charge\n0,0,1,-4\n3,0,1,0\n6,0,1,4\n");
    check_colors("t.csv -o a.svg --color charge", 3, (const char *[]){LEAST, ZERO, LARGEST});
    /* in the second frame, that frame's values */
    write_text("t.csv", "step,x,y,r,charge\n0,0,0,1,-4\n0,3,0,1,4\n1,0,0,1,4\n1,3,0,1,-4\n");
    check_colors("t.csv -o a.svg --color charge --frame last", 2, (const char *[]){LARGEST, LEAST});
    write_text("t.csv", "x,y,r,charge\n0,0,1,nan\n3,0,1,nan\n");
    FAILS(1, "column \"charge\": no number", "view t.csv -o a.svg --color charge");
    leave();
}

/* One force of 12 N along y through a cell of 3 m times 3 m: the stress is 12 N * 1.5 m / 9 m^2 along y and
 * none along x, and the pressure on the base 12 N / 3 m. */
static void test_stress(void)
{
    enter();
    write_pile();
    write_text("contacts.tsv", "x\ty\tx_b\ty_b\tforce\twall\n2.5\t1.5\t2.5\t0\t12\t1\n");
    GOOD("view . -o a.svg --stress --base --cell 3");
    read_svg("a.svg");
    CU_ASSERT(count_strokes(PRESS) == 2); /* with the key's */
    size_t upright = 0;
    for (size_t k = 0; k < n_strokes; k++) {
        if (strcmp(strokes[k].color, PRESS) != 0 || strokes[k].y == strokes[k].y2) continue;
        CHECK_NEAR(strokes[k].x, strokes[k].x2, 0.02);
        const double scale = (circles[1].x - circles[0].x) / 2.5;
        CHECK_NEAR(fabs(strokes[k].y2 - strokes[k].y), 0.9 * 3.0 * scale, 0.02);
        /* in the cell's middle: x from 2 to 5 m, y from 0 to 3 m */
        CHECK_NEAR(strokes[k].x - circles[0].x, 3.5 * scale, 0.02);
        CHECK_NEAR(0.5 * (strokes[k].y + strokes[k].y2) - circles[0].y, -0.5 * scale, 0.02);
        upright++;
    }
    CU_ASSERT(upright == 1);
    /* the pressure's axis ends above 4, not above 12 */
    CU_ASSERT(shell("grep -q '> 4<' a.svg && ! grep -q '> 10<' a.svg") == 0);
    CU_ASSERT(shell("grep -q 'principal stress, largest 2 ' a.svg && grep -q '>pressure' a.svg") == 0);
    CU_ASSERT(shell("grep -c 'fill = .rgb(158, 202, 225)' a.svg | grep -qx 1") == 0);
    /* marks of the pressure from 0 at steps of 1, 2 or 5 times a power of ten, four or so; the axis ends at
     * 1.08 times the largest. The bar over x = 2 to 5 m is as high as the pressure. */
    static const struct {
        double force, step;
        int n;
    } cases[] = {{12.0, 1.0, 5}, {12.6, 2.0, 3}, {360.0, 50.0, 3}, {0.144, 0.02, 3}, {66.0, 10.0, 3}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        double frame[4], bar[4], at[2];
        write_text("contacts.tsv", "x\ty\tx_b\ty_b\tforce\twall\n2.5\t1.5\t2.5\t0\t%g\t1\n", cases[k].force);
        GOOD("view . -o a.svg --stress --base --cell 3");
        read_svg("a.svg");
        CU_ASSERT(count_strokes(PRESS) == 2 && count_strokes(PULL) == 0); /* however weak, it presses */
        find_frame(1, frame);
        const double largest = cases[k].force / 3.0, scale = (circles[1].x - circles[0].x) / 2.5,
                     height = (frame[3] - frame[2]) / (1.08 * largest);
        CU_ASSERT_EQUAL(count_marks(frame, cases[k].step, at), cases[k].n);
        CHECK_NEAR(at[0] - at[1], height * cases[k].step * (cases[k].n - 1), 0.03);
        const char *points = strstr(svg, "<polygon fill = 'rgb(158, 202, 225)' points = '");
        CU_ASSERT_FATAL(points && sscanf(strchr(points, '=') + 33, "%lf,%lf %*f,%*f %lf,%lf", &bar[0],
                                         &bar[1], &bar[2], &bar[3]) == 4);
        CHECK_NEAR(fabs(bar[2] - bar[0]), 3.0 * scale, 0.05);
        CHECK_NEAR(fmin(bar[0], bar[2]), circles[0].x + 2.0 * scale, 1.0); /* frames are whole pixels apart */
        CHECK_NEAR(fabs(bar[3] - bar[1]), height * largest, 0.05);
    }
    write_text("contacts.tsv", "x\ty\tx_b\ty_b\tforce\twall\n2.5\t1.5\t2.5\t0\t12\t1\n");
    /* in a single cell, which is the last one too */
    GOOD("view . -o a.svg --stress --cell 20");
    CU_ASSERT(shell("grep -q 'principal stress, largest 0.045 ' a.svg") == 0);
    /* 12 N along a branch of 2.5 m that leans: 12 * 2.5/400, whatever its direction */
    write_text("contacts.tsv", "x\ty\tx_b\ty_b\tforce\twall\n2.5\t1.5\t0.5\t0\t12\t1\n");
    GOOD("view . -o a.svg --stress --cell 20");
    CU_ASSERT(shell("grep -q 'principal stress, largest 0.075 ' a.svg") == 0);
    leave();
}

/* ---- frames ---- */

/* 2 frames of a scene whose right wall rises; the second one is the last. */
static void write_moving(void)
{
    write_text("s.cfg",
               "dt = 1.0e-5; steps = 100; walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; },\n"
               "  { point = [1.0, 0.0]; direction = [-1.0, 0.0]; extent = [0.0, 0.5]; open_at_step = 10; "
               "open_speed = 100.0; } );\n"
               "particles = ( { x = 0.3; y = 0.0999; r = 0.1; }, { x = 0.5; y = 0.3; r = 0.1; } );\n");
}

static void test_frames(void)
{
    enter();
    write_moving();
    CU_ASSERT(run("run s.cfg --every 50 -o d") == 0);
    GOOD("view d -o a.gif --fps 20");
    CU_ASSERT(shell("head -c 6 a.gif | grep -qx GIF89a") == 0);
    /* a graphic control extension a frame, with its delay in hundredths of a second */
    CU_ASSERT(shell("LC_ALL=C grep -aob \"$(printf '\\041\\371\\004')\" a.gif | wc -l | grep -qx 3") == 0);
    CU_ASSERT(shell("LC_ALL=C grep -aPq '\\x21\\xf9\\x04.\\x05\\x00' a.gif") == 0);
    GOOD("view d -o a.gif --frame 1");
    CU_ASSERT(shell("LC_ALL=C grep -aob \"$(printf '\\041\\371\\004')\" a.gif | wc -l | grep -qx 1") == 0);
    double top[3];
    static const char *const frames[] = {"0", "step=50", "last"};
    for (int k = 0; k < 3; k++) {
        char line[64];
        GOOD("view d -o a.svg --frame %s --window -0.2,1.2,-0.2,0.8", frames[k]);
        snprintf(line, sizeof line, "grep -q 'step %d, ' a.svg", 50 * k);
        CU_ASSERT(shell(line) == 0);
        read_svg("a.svg");
        const mark *wall = find_stroke(WALL);
        CU_ASSERT_FATAL(wall && n_circles == 4 && wall->x == wall->x2);
        top[k] = fabs(wall->y2 - wall->y) / (circles[1].x - circles[0].x) * 0.2;
    }
    CHECK_NEAR(top[0], 0.5, 1e-3);
    CHECK_NEAR(top[1], 0.46, 1e-3);
    CHECK_NEAR(top[2], 0.41, 1e-3);
    leave();
}

/* A film by ffmpeg where it is installed; else the message names its package. */
static void test_film(void)
{
    enter();
    write_moving();
    CU_ASSERT(run("run s.cfg --every 50 -o d") == 0);
    if (shell("command -v ffmpeg >which") == 0) {
        GOOD("view d -o a.mp4");
        CU_ASSERT(shell("head -c 8 a.mp4 | tail -c 4 | grep -q ftyp") == 0);
        CU_ASSERT(
            shell("test \"$(ffprobe -v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 "
                  "a.mp4)\" = 3") == 0);
    } else {
        FAILS(1, "ffmpeg: cannot start: No such file or directory; Debian has it in the package ffmpeg",
              "view d -o a.mp4");
        CU_ASSERT(shell("! ls | grep -q mp4") == 0);
    }
    leave();
}

/* ---- kinds of folders and files ---- */

static void test_kinds(void)
{
    enter();
    write_pile();
    GOOD("view states.tsv -o a.png");
    CU_ASSERT(shell("head -c 8 a.png | od -An -tx1 | grep -q '89 50 4e 47 0d 0a 1a 0a'") == 0);
    /* 18 cm at 80 pixels */
    CU_ASSERT(shell("head -c 20 a.png | tail -c 4 | od -An -tx1 | grep -q '00 00 05 a0'") == 0);
    GOOD("view . -o a.pdf --width 9");
    CU_ASSERT(shell("head -c 5 a.pdf | grep -q ^%PDF-") == 0);
    GOOD("pile --base 5 --eps 1e-3 -o static");
    GOOD("view static -o a.svg --base");
    read_svg("a.svg");
    CU_ASSERT(n_circles == 2 * 15);
    CU_ASSERT(shell("grep -q 'y (sigma)' a.svg && grep -q 'pressure (m g/sigma)' a.svg") == 0);
    write_text("r.cfg",
               "protocol = \"repose\"; fixed = { W = 1.0; H = 1.0; fill_steps = 100; stop = \"steps\"; "
               "relax_steps = 100; measure = [\"theta_r\"]; };\ngrid = { mu = [0.1]; };\n");
    CU_ASSERT(run("run r.cfg -o stages") <= 1);
    GOOD("view stages -o a.gif"); /* filled, and the pile */
    CU_ASSERT(shell("LC_ALL=C grep -aob \"$(printf '\\041\\371\\004')\" a.gif | wc -l | grep -qx 2") == 0);
    leave();
}

static void test_refusals(void)
{
    enter();
    write_pile();
    write_text("bare.tsv", "x\ty\n1\t2\n");
    write_text("flat.tsv", "x\ty\tr\n1\t2\t0\n");
    write_text("points.tsv", "x\ty\tr\n1\t2\t1\n");
    write_text("file", "x\n");
    FAILS(64, "ends in .png, .svg, .pdf, .gif or .mp4", "view . -o a.jpg");
    FAILS(64, "-o FILE writes a picture", "view .");
    FAILS(65, "cannot read", "view nowhere -o a.svg");
    FAILS(65, "no column \"r\"", "view bare.tsv -o a.svg");
    FAILS(65, "flat.tsv: row 1: x, y and a radius above 0 expected", "view flat.tsv -o a.svg");
    FAILS(65, "no column \"age\"", "view . -o a.svg --color age");
    FAILS(65, "there are frames 0 to 0, steps 7 to 7", "view . -o a.svg --frame 1");
    FAILS(64, "last, all, a number or step=N", "view . -o a.svg --frame first");
    FAILS(64, "X0 < X1 and Y0 < Y1", "view . -o a.svg --window 1,0,0,1");
    FAILS(65, "more than 100000 cells", "view . -o a.svg --base --cell 1e-4");
    write_text("far.tsv", "x\ty\tr\n1\t2\t1\n1e200\t1e200\t1\n");
    FAILS(65, "no window holds the grains: x over 1e+200", "view far.tsv -o a.svg");
    FAILS(1, "--stress: no table of contacts", "view points.tsv -o a.svg --stress");
    FAILS(1, "--base: no contacts that press on a wall", "view points.tsv -o a.svg --base");
    FAILS(74, "cannot write", "view . -o file/a.svg");
    CU_ASSERT(shell("mkdir empty; PATH=empty DISPLAY= \"$(command -v \"$REPOSE\")\" view . -o a.svg 2>err") ==
                  1 &&
              shell("grep -q 'Debian has it in the package gnuplot-nox' err") == 0);
    CU_ASSERT(shell("! ls | grep -q svg") == 0);
    CU_ASSERT(shell("mkdir none; \"$REPOSE\" view none -o a.svg 2>err") == 65 &&
              shell("grep -q 'no rows in a states.tsv, disks.tsv or ..._grains.tsv' err") == 0);
    leave();
}

/* ---- what a run says ---- */

/* A staircase of fixed grains is a pile: its steps of 0.1 per diameter of 0.2 have a slope of 26.6 degrees.
 */
static void test_closing_line(void)
{
    char walls[256], grains[4096] = "";
    enter();
    for (int k = 0; k < 12; k++)
        snprintf(grains + strlen(grains), sizeof grains - strlen(grains),
                 "%s{ x = %g; y = %g; r = 0.1; fixed = true; }", k ? ", " : "", 0.1 + 0.2 * k, 2.0 - 0.1 * k);
    snprintf(walls, sizeof walls, "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } );");
    write_text("stairs.cfg", "steps = 10; %s particles = ( %s );\n", walls, grains);
    GOOD("run stairs.cfg -o d");
    CU_ASSERT(strncmp(err, "repose run: 12 grains, 10 steps, t = 0.0005 s; at rest; theta_R = ", 66) == 0);
    CHECK_NEAR(strtod(err + 66, NULL), 180.0 / M_PI * atan(0.5), 0.05); /* one decimal is printed */
    CU_ASSERT(strstr(err, ", over x = 0 to 2.4 cm (method 3); tables in d\n") != NULL);
    /* a grain a little inside the wall at 0; the units are the scene's, and those of grains have no names */
    GOOD("run stairs.cfg --set 'particles[0].x=0.0991' --set units=si");
    CU_ASSERT(strstr(err, ", t = 0.0005 s; ") && strstr(err, ", over x = 0 to 2.4 m (method 3); "));
    GOOD("run stairs.cfg --set 'particles[0].x=0.0991' --set units=sigma --set dt=5e-5");
    CU_ASSERT(strstr(err, ", t = 0.0005; ") && strstr(err, ", over x = 0 to 2.4 (method 3); "));
    GOOD("run stairs.cfg -o d --quiet");
    CU_ASSERT_STRING_EQUAL(err, "");
    /* a pile ends at the wall that has opened; a level one has no slope */
    write_text("open.cfg",
               "steps = 10; walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; }, { point = [2.0, 0.0]; "
               "direction = [-1.0, 0.0]; open_at_step = 5; } ); particles = ( %s );\n",
               grains);
    GOOD("run open.cfg -o open");
    CU_ASSERT(strstr(err, "over x = 0 to 2 cm (method 3)") != NULL);
    write_text("level.cfg",
               "steps = 10; %s particles = ( { x = 0.3; y = 0.1; r = 0.1; fixed = true; }, { x = "
               "0.6; y = 0.1; r = 0.1; fixed = true; } );\n",
               walls);
    GOOD("run level.cfg");
    CU_ASSERT_STRING_EQUAL(
        err, "repose run: 2 grains, 10 steps, t = 0.0005 s; at rest; states on standard output\n");
    write_moving();
    GOOD("run s.cfg -o moving");
    CU_ASSERT_STRING_EQUAL(err,
                           "repose run: 2 grains, 100 steps, t = 0.001 s; not at rest; tables in moving\n");
    leave();
}

/* Without a terminal a line a minute, with it a bar; the time left follows from the steps done. */
static void test_progress(void)
{
    char *text;
    size_t size;
    FILE *file = open_memstream(&text, &size);
    cli_progress p = cli_progress_start(false, false, 1000.0, 100, 1100);
    cli_progress_show(&p, 1059.0, 120, file);
    cli_progress_show(&p, 1061.0, 200, file);
    cli_progress_show(&p, 1120.0, 300, file);
    cli_progress_show(&p, 1122.0, 600, file);
    cli_progress_show(&p, 1300.0, 1100, file); /* the closing line says this */
    fclose(file);
    CU_ASSERT_STRING_EQUAL(text, "repose run: step 200 of 1100, 18 %, 9:09 left\n"
                                 "repose run: step 600 of 1100, 54 %, 2:02 left\n");
    free(text);
    file = open_memstream(&text, &size);
    p = cli_progress_start(false, true, 0.0, 0, 300);
    cli_progress_show(&p, 0.4, 10, file);
    cli_progress_show(&p, 1.0, 100, file);
    cli_progress_show(&p, 1.05, 110, file);
    cli_progress_show(&p, 1.06, 300, file);
    fclose(file);
    CU_ASSERT(strncmp(text, "\r[##########                    ] step 100 of 300, 33 %, 0:02 left", 66) == 0);
    CU_ASSERT(strstr(text, "110") == NULL &&
              strstr(text, "\r[##############################] step 300 of 300"));
    CU_ASSERT(text[size - 1] == '\n');
    free(text);
    file = open_memstream(&text, &size);
    p = cli_progress_start(true, true, 0.0, 0, 300);
    cli_progress_show(&p, 100.0, 300, file);
    fclose(file);
    CU_ASSERT(size == 0);
    free(text);
}

/* Without a screen gnuplot draws text on standard error, and the tables are the same. */
static void test_plot(void)
{
    enter();
    write_moving();
    GOOD("run s.cfg --every 50");
    CU_ASSERT(
        shell("cp out plain; DISPLAY= WAYLAND_DISPLAY= \"$REPOSE\" run s.cfg --every 50 --plot >out 2>err") ==
        0);
    CU_ASSERT(equal_tables("out", "plain"));
    CU_ASSERT(shell("grep -q 'step 100 of 100, 100 %' err && grep -q 'kinetic energy' err && grep -q 'x "
                    "(cm)' err && grep -q surface err && "
                    "tail -n 1 err | grep -q 'repose run: 2 grains'") == 0);
    write_text("r.cfg", "protocol = \"repose\";\n");
    FAILS(64, "--plot goes with a scene", "run r.cfg --plot -o d");
    leave();
}

void suite_view(void)
{
    static const check_case cases[] = {{"grains", test_circles},
                                       {"forces and walls", test_forces},
                                       {"walls that slope", test_slopes},
                                       {"segments of walls", test_segment},
                                       {"frame and labels", test_layout},
                                       {"colours", test_colors},
                                       {"stress and base", test_stress},
                                       {"frames", test_frames},
                                       {"film", test_film},
                                       {"folders and files", test_kinds},
                                       {"refusals", test_refusals},
                                       {"closing line of a run", test_closing_line},
                                       {"progress of a run", test_progress},
                                       {"plot of a run", test_plot},
                                       {0}};
    check_register("view", cases);
}
