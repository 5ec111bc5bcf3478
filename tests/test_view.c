/* What is seen. Pictures by their contents: an svg file has each grain, force and wall at its position, in
 * its colour and width; a gif file has every frame. */
#include <fcntl.h>
#include <unistd.h>

#include "cli/progress.h"
#include "tests/numbers.h"
#include "tests/program.h"
#include "view/view.h"

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

/* The picture that these words ask for. gnuplot draws each grain by two points, its outline and its fill. */
static void view_svg(const char *words)
{
    double width = 0.0;
    n_circles = n_strokes = 0;
    GOOD("view -o a.svg --force %s", words);
    slurp("a.svg", svg, sizeof svg);
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
                  PULL[] = "rgb(213,  94,   0)";

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
    write_pile();
    view_svg(".");
    CU_ASSERT_FATAL(n_circles == 6);
    const double scale = (circles[1].x - circles[0].x) / 2.5;
    CU_ASSERT(scale > 60.0);
    for (int i = 0; i < 6; i++) {
        const mark *c = &circles[i];
        CU_ASSERT_STRING_EQUAL(c->color, i < 3 ? OUTLINE : GRAIN);
        CHECK_PAIRS(0.02, {c->x - circles[0].x, scale * (x[i % 3] - x[0])}, /* hundredths are printed */
                    {c->y - circles[0].y, -scale * (y[i % 3] - y[0])});
        /* the picture is a whole number of pixels wide, up to half a pixel of 680 less */
        CHECK_NEAR(c->r, scale * r[i % 3] + (i < 3 ? 0.25 : -0.25), 0.03 + scale * r[i % 3] * 0.5 / 680.0);
    }
}

/* Each force is a line between the centres of its contact, the strongest last. Its colour and its width are
 * those of its force over the largest, in twelve steps. */
static void test_forces(void)
{
    write_pile();
    view_svg(".");
    const mark *strong = find_stroke(STRONGEST), *pull = find_stroke(PULL), *wall = find_stroke(WALL);
    CU_ASSERT_FATAL(strong && pull && wall && n_circles == 6);
    const double scale = (circles[1].x - circles[0].x) / 2.5;
    CU_ASSERT(count_strokes(STRONGEST) == 2 && count_strokes(PULL) == 1); /* with the sample in the key */
    for (size_t k = 0; k < n_strokes; k++) {
        const mark *m = &strokes[k];
        if (strcmp(m->color, STRONGEST) == 0 && m->x == m->x2) { /* 12 of 12 */
            CHECK_PAIRS(0.02, {m->x, circles[1].x}, {fabs(m->y2 - m->y), 1.5 * scale});
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
    const char *shade = check_text("rgb(%3ld, %3ld, %3ld)", lround((6.0 * pale_r + 5.0 * dark_r) / 11.0),
                                   lround((6.0 * pale_g + 5.0 * dark_g) / 11.0),
                                   lround((6.0 * pale_b + 5.0 * dark_b) / 11.0));
    CU_ASSERT(classes == 12 && *grain == '#' && *outline == '#');
    CU_ASSERT_STRING_EQUAL(half->color, shade);
    CHECK_PAIRS(0.02, {half->x, circles[0].x}, {half->y, circles[0].y}, {half->x2, circles[1].x},
                {half->y2, circles[1].y});
    CU_ASSERT(count_strokes(WALL) == 2); /* the open wall has nothing left */
    SHELL("grep -q 'normal force 12 N' a.svg && grep -q 'x (m)' a.svg && "
          "grep -q 'step 7, t = 0.5 s, 3 grains' a.svg");
}

/* A segment is drawn as far as half the size of the grains' region, whichever side of that is longer. */
static void test_segment(void)
{
    for (int tall = 0; tall < 2; tall++) {
        write_text("pile_grains.tsv", "x\ty\tr\n0\t0\t1\n%d\t%d\t1\n", tall ? 0 : 10, tall ? 10 : 0);
        write_text("pile_walls.tsv", "wall\tx\ty\tdirection_x\tdirection_y\tfrom\tto\n1\t0\t0\t%d\t%d\t%s\n",
                   tall ? 0 : -1, tall, tall ? "-1e308\t1e308" : "-30\t30");
        view_svg("pile_grains.tsv");
        const mark *wall = find_stroke(WALL);
        CU_ASSERT_FATAL(n_circles == 4 && wall != NULL);
        const double scale = hypot(circles[1].x - circles[0].x, circles[1].y - circles[0].y) / 10.0;
        /* the grains' region is 12 by 2; half of 12 and a radius to both sides of 2 */
        CHECK_NEAR(hypot(wall->x2 - wall->x, wall->y2 - wall->y) / scale, 16.0, 0.1);
    }
}

/* Corners of frame number `which`, from above: least and largest x, least and largest y. A frame begins with
 * its left side, downwards, is wider than a bar of colours, and is drawn below grains and above. */
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

/* The frame is the window, at the grains' scale, with room for labels: on the left 1.8 cm, on the right 0.7
 * cm or 3.1 with a bar of colours, above 1.4 cm, below 1.5. The pressure has a frame of 3.2 cm less its
 * labels below. No text is outside the picture. */
static void test_layout(void)
{
    static const struct {
        const char *words;
        double width, right, panel, x, y; /* of the window */
    } cases[] = {{"", 18.0, 0.7, 0.0, 9.0 + 1.0 / 3.0, 5.0 + 1.0 / 3.0},
                 {"--color m", 18.0, 3.1, 0.0, 9.0 + 1.0 / 3.0, 5.0 + 1.0 / 3.0},
                 {"--width 30 --window -2,8,-1,4", 30.0, 0.7, 0.0, 10.0, 5.0},
                 {"--base --width 12 --window -2,8,-1,5", 12.0, 0.7, 3.2, 10.0, 6.0},
                 /* as high as is allowed, and as wide as labels need; as low as is allowed */
                 {"--window -1,4,-1,19", 11.0, 0.7, 0.0, 5.0, 20.0},
                 {"--window -1,9,-1,13.5", 1.8 + 14.0 * 10.0 / 14.5 + 0.7, 0.7, 0.0, 10.0, 14.5},
                 {"--window -20,20,-1,1", 18.0, 0.7, 0.0, 40.0, 1.2 * 40.0 / 15.5}};
    write_pile();
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        double width, height, frame[4], panel[4], at[2];
        view_svg(check_text(". %s", cases[k].words));
        CU_ASSERT_FATAL(sscanf(strstr(svg, "viewBox=") + 9, "0 0 %lf %lf", &width, &height) == 2);
        const double cm = width / cases[k].width;
        CHECK_NEAR(cm, 37.8, 0.06); /* whole pixels */
        find_frame(0, frame);
        const double scale = (circles[1].x - circles[0].x) / 2.5;
        CHECK_PAIRS(0.01, {(frame[1] - frame[0]) / scale, cases[k].x},
                    {(frame[3] - frame[2]) / scale, cases[k].y});
        if (cases[k].y <= cases[k].x) /* else centred */
            CHECK_PAIRS(1.0, {frame[0], 1.8 * cm}, {frame[1], width - cases[k].right * cm});
        CHECK_PAIRS(1.0, {frame[2], 1.4 * cm}, {frame[3], height - (1.5 + cases[k].panel) * cm});
        find_frame(1, panel);
        if (cases[k].panel > 0.0) {
            CHECK_NEAR(panel[0], frame[0], 0.02);
            CHECK_PAIRS(1.0, {panel[1], frame[1]}, {panel[2], frame[3] + 1.3 * cm},
                        {panel[3], height - 1.5 * cm});
        }
        for (const char *label = svg; (label = strstr(label, "<g transform=\"translate(")); label++) {
            CU_ASSERT_FATAL(sscanf(label, "<g transform=\"translate(%lf,%lf)", &at[0], &at[1]) == 2);
            CU_ASSERT(at[0] > 11.0 && at[0] < width && at[1] > 11.0 && at[1] < height);
        }
    }
}

/* The picture that these words ask for has n grains of these colours. */
static void check_colors(const char *words, size_t n, const char *const colors[])
{
    view_svg(words);
    CU_ASSERT_FATAL(n_circles == 2 * n); /* below each, its outline */
    for (size_t i = 0; i < n; i++) CU_ASSERT_STRING_EQUAL(circles[n + i].color, colors[i]);
}

/* Colours run from the least to the largest value of the column; of both signs, white is 0. */
static void test_colors(void)
{
    static const char LEAST[] = "rgb( 43, 123, 186)", ZERO[] = "rgb(247, 247, 247)",
                      LARGEST[] = "rgb(230,  97,   1)";
    write_pile();
    check_colors(". --color m", 3,
                 (const char *[]){"rgb(255, 247, 188)", "rgb(204,  76,   2)", "rgb(254, 153,  41)"});
    SHELL("grep -q 'm (kg)' a.svg");
    write_text("t.csv", "x,y,r,charge\n0,0,1,-4\n3,0,1,0\n6,0,1,4\n");
    check_colors("t.csv --color charge", 3, (const char *[]){LEAST, ZERO, LARGEST});
    /* in the second frame, that frame's values */
    write_text("t.csv", "step,x,y,r,charge\n0,0,0,1,-4\n0,3,0,1,4\n1,0,0,1,4\n1,3,0,1,-4\n");
    check_colors("t.csv --color charge --frame last", 2, (const char *[]){LARGEST, LEAST});
    write_text("t.csv", "x,y,r,charge\n0,0,1,nan\n3,0,1,nan\n");
    FAILS(1, "column \"charge\": no number", "view t.csv -o a.svg --color charge");
}

/* The only contact: of a grain with the wall below it. */
static void write_press(double x, double x_b, double force)
{
    write_text("contacts.tsv", "x\ty\tx_b\ty_b\tforce\twall\n%g\t1.5\t%g\t0\t%g\t1\n", x, x_b, force);
}

/* Length of the largest cross's arm, cm, of a cell so wide in the picture of write_pile. */
static double arm(double cell)
{
    return 0.9 * cell * 15.5 / (28.0 / 3.0);
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
    write_moving();
    CU_ASSERT(run("run s.cfg --every 50 -o d") == 0);
    GOOD("view d -o a.gif --force --fps 20");
    SHELL("head -c 6 a.gif | grep -qx GIF89a");
    /* a graphic control extension a frame, with its delay in hundredths of a second */
    SHELL("LC_ALL=C grep -aob \"$(printf '\\041\\371\\004')\" a.gif | wc -l | grep -qx 3");
    SHELL("LC_ALL=C grep -aPq '\\x21\\xf9\\x04.\\x05\\x00' a.gif");
    GOOD("view d -o a.gif --force --frame 1");
    SHELL("LC_ALL=C grep -aob \"$(printf '\\041\\371\\004')\" a.gif | wc -l | grep -qx 1");
    /* the end of a phase has a frame beside those of an interval, also of a text without a measure */
    SHELL("sed 's/steps = 100;/phases = ( { name = \"one\"; steps = 30; }, { name = \"two\"; steps = 70; } "
          ");/' s.cfg >p.cfg && $REPOSE run p.cfg --every 50 -o p >out 2>err");
    GOOD("view p -o a.svg --force --frame one");
    SHELL("grep -q 'step 30, ' a.svg");
}

/* A film by ffmpeg where it is installed; else the message names its package. */
static void test_film(void)
{
    write_moving();
    CU_ASSERT(run("run s.cfg --every 50 -o d") == 0);
    if (shell("command -v ffmpeg >which") == 0) {
        GOOD("view d -o a.mp4 --force");
        SHELL("head -c 8 a.mp4 | tail -c 4 | grep -q ftyp");
        SHELL("test \"$(ffprobe -v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 "
              "a.mp4)\" = 3");
    } else {
        FAILS(1, "ffmpeg: cannot start: No such file or directory; Debian has it in the package ffmpeg",
              "view d -o a.mp4");
        SHELL("! ls | grep -q mp4");
    }
}

/* ---- what gnuplot is told ---- */

static char told[1 << 16];

/* A program of gnuplot's name writes to a file what it is told, before the words that start the program. */
#define tell(...) tell_words(check_text(__VA_ARGS__))
static void tell_words(const char *words)
{
    write_text("gnuplot", "#!/bin/sh\n[ \"$LC_ALL\" = C.UTF-8 ] && exec cat >told\n");
    write_text("ffmpeg", "#!/bin/sh\necho \"$@\" >film\nexec cat >>film\n");
    const int status = shell_line(
        "chmod +x gnuplot ffmpeg; LC_ALL=C PATH=.:$PATH \"$REPOSE\" view --force %s >out 2>err", words);
    if (status) fprintf(stderr, "view %s: %s", words, err);
    CU_ASSERT_FATAL(status == 0);
    slurp("told", told, sizeof told);
}

#define is_told(...) CHECK_OR_SAY(strstr(told, check_text(__VA_ARGS__)), "gnuplot is not told: " __VA_ARGS__)

static size_t count_told(const char *part)
{
    size_t n = 0;
    for (const char *c = told; (c = strstr(c, part)); c++) n++;
    return n;
}

/* The data of this name, which stand there for the which-th time from 0 on: n rows of so many numbers. */
static void check_data(const char *name, size_t which, size_t n, size_t width, const double expected[])
{
    char *end;
    const char *head = check_text("$%s << end\n", name);
    const char *at = strstr(told, head);
    for (size_t k = 0; at && k < which; k++) at = strstr(at + 1, head);
    CU_ASSERT_PTR_NOT_NULL_FATAL(at);
    at += strlen(head);
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < width; k++, at = end) {
            const double wanted = expected[i * width + k], number = strtod(at, &end);
            CHECK_NEAR(number, wanted, 1e-8 * fmax(1.0, fabs(wanted))); /* nine digits are printed */
            CU_ASSERT_FATAL(end > at);
        }
        CU_ASSERT_FATAL(*at++ == '\n');
    }
    CU_ASSERT(strncmp(at, "end\n", 4) == 0);
}

/* Five frames of two grains. Each side of the window is that of another frame, the first and the last among
 * them; so are the ends of the column m. */
enum { FRAMES = 5 };
static const double steps[FRAMES] = {3, 5, 9, 10, 12}, strength[FRAMES] = {0.25, 0.625, 0.0, 0.5, 0.375},
                    place[FRAMES][2][4] = {{{0, 1, 1, 2}, {4, 1.5, 0.5, 4}},
                                           {{1, 1, 1, 3}, {3, 1.5, 0.5, 5}},
                                           {{2, 1, 1, 5}, {5, 1.5, 0.5, 5}},
                                           {{1, 0.5, 1, 4}, {3.5, 1.5, 0.5, 6}},
                                           {{0.5, 1, 1, 6}, {4.5, 6, 0.5, 8}}};

static void write_frames(void)
{
    static const char row[] = "%g\t%g\t%g\t%g\t%g\t%g\n";
    FILE *grains = file_of("states.tsv"), *contacts = file_of("contacts.tsv");
    fputs("# units: 1\ts\tm\tm\tm\tkg\nstep\tt\tx\ty\tr\tm\n", grains);
    fputs("# units: 1\tm\tm\tm\tm\tN\nstep\tx\ty\tx_b\ty_b\tnormal_force\n", contacts);
    for (size_t k = 0; k < FRAMES; k++) {
        const double *a = place[k][0], *b = place[k][1];
        for (const double *p = a; p <= b; p += 4)
            fprintf(grains, row, steps[k], 0.1 * steps[k], p[0], p[1], p[2], p[3]);
        if (k == 1) fprintf(contacts, row, steps[k], 3.0, 2.0, 3.5, 2.5, 0.25); /* in no order */
        if (k != 2) fprintf(contacts, row, steps[k], a[0], a[1], b[0], b[1], strength[k]);
        if (k != 1) continue;
        fprintf(contacts, row, steps[k], 1.0, 2.0, 1.0, 3.0, 0.0); /* of none, and pulling */
        fprintf(contacts, row, steps[k], 4.0, 2.0, 4.0, 1.0, -0.0625);
    }
    fclose(grains), fclose(contacts);
    write_text("walls.tsv",
               "step\twall\tx\ty\tdirection_x\tdirection_y\tfrom\tto\n3\t1\t0\t-0.5\t0\t1\t-1.5\t3\n"
               "12\t1\t5.5\t0\t-1\t0\t0\t9\n");
}

/* The window of all frames has a mean radius of 0.75 around grains and walls. Forces, weakest first, are in
 * twelfths of the fourth of five frames' largest ones, 0.5; one that pulls is 20 styles on. */
static void test_animation(void)
{
    static const int classes[FRAMES] = {6, 12, 0, 12, 9};
    write_frames();
    tell(". -o a.gif --color m --fps 20");
    /* 8.5 by 11 m: 14 cm high */
    const char *text =
        check_text("set terminal gif animate delay 5 loop 0 enhanced font 'DejaVu Sans,10' size %.0f,%.0f\n",
                   48.0 * (14.0 * 8.5 / 11.0 + 1.8 + 3.1), 48.0 * (14.0 + 1.4 + 1.5));
    CU_ASSERT(strncmp(told, text, strlen(text)) == 0);
    CHECK_PARTS(told, "set xrange [-2.25:6.25]\n", "set yrange [-1.25:9.75]\n", "set cbrange [2:8]\n",
                "set cblabel offset 1 'm (kg)' noenhanced\n");
    size_t with_contacts = 0;
    for (size_t k = 0; k < FRAMES; k++) {
        const double *a = place[k][0], *b = place[k][1];
        check_data("grains", k, 2, 4, a);
        is_told("set label 1 'step %g, t = %g s, 2 grains' ", steps[k], 0.1 * steps[k]);
        const double data[3][5] = {
            {4, 2, 0, -1, 22}, {3, 2, 0.5, 0.5, 6}, {a[0], a[1], b[0] - a[0], b[1] - a[1], classes[k]}};
        if (k != 2) check_data("contacts", with_contacts++, k == 1 ? 3 : 1, 5, data[k == 1 ? 0 : 2]);
    }
    check_data("walls", 0, 1, 4, (double[]){-1.5, -0.5, 4.5, 0});
    for (size_t k = 1; k < 4; k++) check_data("walls", k, 0, 4, NULL);
    check_data("walls", 4, 1, 4, (double[]){5.5, 0, 0, 9});
    CU_ASSERT(count_told("'normal force ") == 4 && count_told("'normal force at least 0.5 N'") == 1);
    /* without one frame of four that has forces, the strongest of all frames counts */
    write_text("contacts.tsv", "step\tx\ty\tx_b\ty_b\tnormal_force\n9\t2\t1\t5\t1.5\t0.375\n");
    tell(". -o a.gif");
    check_data("contacts", 0, 1, 5, (double[]){2, 1, 3, 0.5, 12});
    is_told("set label 2 'normal force 0.375' noenhanced at");
}

/* Which frame is drawn, and on what. */
static void test_chosen(void)
{
    static const struct {
        const char *words, *step, *terminal;
        size_t n;
    } cases[] = {{"a.svg", "12", "svg enhanced font 'DejaVu Sans,11' background 'white' size 680,529", 1},
                 {"a.svg --frame 0", "3", "", 1},
                 {"a.svg --frame 1", "5", "", 1},
                 {"a.svg --frame 4", "12", "", 1},
                 {"a.svg --frame step=9", "9", "", 1},
                 {"a.svg --frame step=12", "12", "", 1},
                 {"a.svg --frame last", "12", "", 1},
                 {"a.gif --frame last", "12",
                  "gif animate delay 10 loop 0 enhanced font 'DejaVu Sans,10' size 864,672", 1},
                 {"a.gif --frame all", "3", "", 5},
                 {"a.png", "12",
                  "pngcairo enhanced font 'DejaVu Sans,11' fontscale 1.5 linewidth 2 size 1440,1120", 1},
                 {"a.pdf", "12", "pdfcairo enhanced font 'DejaVu Sans,8' size 18.000cm,14.000cm", 1},
                 {"a.mp4", "3",
                  "pngcairo enhanced font 'DejaVu Sans,11' fontscale 1.1 linewidth 1.5 size 1080,840", 5}};
    write_frames();
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        /* 15.5 by 11.1 cm, and 2.9 cm above and below */
        tell(". --window 0,15.5,0,11.1 -o %s", cases[k].words);
        is_told("set terminal %s", cases[k].terminal);
        const char *text = check_text("'step %s, ", cases[k].step);
        const char *first = strstr(told, "set label 1 '");
        CU_ASSERT(first && strncmp(first + 12, text, strlen(text)) == 0);
        CU_ASSERT_EQUAL(count_told("set label 1 "), cases[k].n);
    }
    tell(". -o a.mp4 --fps 12.5");
    char film[256];
    slurp("film", film, sizeof film);
    const char *start = "-loglevel error -y -f image2pipe -framerate 12.5 -c:v png -i - "
                        "-vf pad=ceil(iw/2)*2:ceil(ih/2)*2 -pix_fmt yuv420p -f mp4 /proc/";
    CU_ASSERT(strncmp(film, start, strlen(start)) == 0 && strstr(film, "/fd/"));
    /* the scale is that frame's alone */
    tell(". -o a.svg --frame 1");
    CHECK_PARTS(told, "set xrange [-0.75:4.25]\n", "set label 2 'normal force 0.625 N' noenhanced at");
    tell(". -o a.svg --window 0.25,0.75,0.25,0.5");
    is_told("set xrange [0.25:0.75]\n");
    FAILS(65, "--frame 5: there are frames 0 to 4, steps 3 to 12", "view . -o a.svg --frame 5");
    FAILS(65, "--frame step=4: there are", "view . -o a.svg --frame step=4");
    FAILS(65, "--frame -1: there are", "view . -o a.svg --frame -1");
    static const char *const wrong[] = {"1x", "step=", "step=9x", "x", "''", "1,2"};
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
        FAILS(64, "last, all, a number or step=N", "view . -o a.svg --frame %s", wrong[k]);
    FAILS(64, "--frame all: a picture shows one frame; -o NAME.gif shows 5", "view . -o a.svg --frame all");
    SHELL("grep -v '^[59]\\|^1[02]' states.tsv >one.tsv");
    tell("one.tsv -o a.svg --frame all"); /* of one frame */
    static const char *const windows[] = {
        "1,1,0,1",   "1,0,0,1",    "0,1,1,1",          "0,1,2,1",         "0,1,0",
        "0,1,0,1,",  "0,1,0,1,2",  "0,1,0,x",          "0,inf,0,1",       "0,1,-inf,0",
        "nan,1,0,1", "-inf,0,0,1", "-1e308,1e308,0,1", "0,1,-1e308,1e308"};
    for (size_t k = 0; k < sizeof windows / sizeof *windows; k++)
        FAILS(64, "X0 < X1 and Y0 < Y1", "view . -o a.svg --window '%s'", windows[k]);
    FAILS(64, "ends in .png", "view . -o .svg"); /* an ending alone is no name */
    FAILS(64, "no screen for a window", "view .");
    CU_ASSERT_EQUAL(shell("DISPLAY= WAYLAND_DISPLAY= \"$REPOSE\" view . >out 2>err"), 64);
    /* a window, where there is a screen: all frames, with a tenth of a second between two */
    SHELL("DISPLAY=none PATH=.:$PATH \"$REPOSE\" view . >out 2>err");
    slurp("told", told, sizeof told);
    CU_ASSERT(strncmp(told, "if (GPVAL_TERM eq 'unknown'", 27) == 0 && !strstr(told, "set terminal"));
    CU_ASSERT(count_told("\npause 0.100\n") == FRAMES - 1 &&
              strstr(told, "\"step 3, ") < strstr(told, "\npause "));
}

/* Colours run from the least to the largest value, or as far to both sides of 0; of one value alone, half of
 * it to both sides, or half of 1. */
static void test_range(void)
{
    static const struct {
        double a, b;
        const char *range;
    } cases[] = {{-1.0, 4.0, "-4:4"},   {4.0, -1.0, "-4:4"}, {-4.0, 0.5, "-4:4"},     {2.0, 5.0, "2:5"},
                 {0.0, 0.5, "0:0.5"},   {-3.0, 0.0, "-3:0"}, {0.0, 0.0, "-0.5:0.5"},  {6.0, 6.0, "3:9"},
                 {-6.0, -6.0, "-9:-3"}, {0.5, 0.5, "0:1"},   {-0.5, 0.25, "-0.5:0.5"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const bool both = cases[k].a * cases[k].b < 0.0;
        write_text("t.tsv", "x\ty\tr\tq\n0\t0\t1\t%g\n3\t0\t1\tnan\n6\t0\t1\t%g\n", cases[k].a, cases[k].b);
        tell("t.tsv -o a.png --color q");
        is_told("set cbrange [%s]\n", cases[k].range);
        is_told("%s", both ? "'#f7f7f7'" : "'#fff7bc'");
        CHECK_PARTS(told, "set cblabel offset 1 'q' noenhanced",
                    "plot $grains using 1:2:3:4 with circles lw 0.4 fc palette notitle\n");
        /* a window of 8 by 2 m with a radius around it, whose plot is 13.1 cm wide */
        is_told("set lmargin at screen %.5f\nset rmargin at screen %.5f\n", 0.1, 1.0 - 3.1 / 18.0);
        is_told("set colorbox user origin %.5f, ", 1.0 - 2.7 / 18.0);
        CHECK_PARTS(told, "set xrange [-2:8]\n", "set yrange [-2:2]\n", "'3 grains'",
                    "set xlabel 'x' noenhanced");
    }
}

/* A force of 3 along a branch of length l up to the right and one of 4 across it, in a cell of area 9: the
 * principal stresses are 4 l/9 and -l/9, along (3, 1) and (-1, 3). One that pulls by 2 along a branch as long
 * and as steep has -2 l/9 along itself alone. */
static void test_crosses(void)
{
    const double l = 0.9 * 3.0, root = sqrt(10.0), half = sqrt(0.5);
    write_pile();
    write_text("contacts.tsv",
               "x\ty\tx_b\ty_b\tnormal_force\tshear_force\twall\n3.5\t1.5\t2.5\t0.5\t3\t4\t0\n"
               "1\t5\t0\t4\t-2\t0\t0\n");
    tell(". -o a.png --stress --cell 3");
    const double ends[3][3] = {
        {3.0 / root, 1.0 / root, 1.0}, {-1.0 / root, 3.0 / root, 0.25}, {half, half, 0.5}};
    double crosses[3][5];
    for (int k = 0; k < 3; k++) {
        const double dx = l * ends[k][2] * ends[k][0], dy = l * ends[k][2] * ends[k][1];
        memcpy(
            crosses[k],
            (double[]){(k < 2 ? 3.0 : 0.5) - 0.5 * dx, (k < 2 ? 1.0 : 4.5) - 0.5 * dy, dx, dy, k ? 51 : 50},
            sizeof crosses[k]);
    }
    check_data("stress", 0, 3, 5, *crosses);
    is_told(" as 50\nset label 2 'principal stress %.4g' noenhanced at",
            4.0 * sqrt(2.0) / 9.0 * 1.6 / arm(3.0));
    CU_ASSERT(!strstr(told, "normal force"));
    /* a single cell, of 20 m */
    write_text("contacts.tsv", "x\ty\tx_b\ty_b\tforce\n2.5\t1.5\t2.5\t0\t12\n");
    tell(". -o a.png --stress --cell 20");
    check_data("stress", 0, 1, 5, (double[]){2.5, -8.25, 0, 18, 50});
    /* below and left of the origin: four cells and bins to a side, of which the last one has the force */
    write_text("p_grains.tsv", "x\ty\tr\n-9\t-9\t1\n0\t0\t1\n");
    write_text("p_contacts.tsv", "x\ty\tx_b\ty_b\tforce\twall\n0\t0.5\t0\t-0.5\t12\t1\n");
    tell("p_grains.tsv -o a.png --stress --base --cell 3");
    check_data("stress", 0, 1, 5, (double[]){0, -1.35, 0, 2.7, 50});
    check_data("base", 0, 4, 2, (double[]){-8.5, 0, -5.5, 0, -2.5, 0, 0.5, 4});
}

static void write_forces(void)
{
    write_text("contacts.tsv", "# units: m\tm\tm\tm\tN\t1\nx\ty\tx_b\ty_b\tnormal_force\twall\n"
                               "-1\t3\t-1\t2\t6\t1\n"       /* where the bins begin */
                               "0\t3\t0\t4\t60\t1\n"        /* above */
                               "0\t3\t0\t2\t60\t0\n"        /* no wall */
                               "3\t4\t2\t3\t1.5\t1\n"       /* 45 degrees: the vertical part is 1.5/sqrt 2 */
                               "4.25\t4\t3\t3\t60\t1\n"     /* steeper */
                               "3\t4\t4.25\t3\t60\t1\n"     /* steeper to the other side */
                               "7.5\t3\t7.5\t2\t0.375\t1\n" /* the last bin */
                               "10\t3\t10\t2\t60\t1\n"      /* beyond it */
                               "-2.5\t3\t-2.5\t2\t60\t1\n");
}

/* Vertical forces of contacts with walls below, up to 45 degrees; of bins of 3 m from x = -1 m on to the end
 * of the window, at 7 m and a mean radius. */
static void test_bins(void)
{
    write_pile();
    write_forces(); /* before the first one */
    /* each over a diameter, of 7/3 m: half of the first one, halves of the second one, 5/7 of the last */
    const double half = 0.5 * 1.5 * sqrt(0.5) / 3.0;
    tell(". -o a.png --base --cell 3");
    check_data("base", 0, 3, 2, (double[]){0.5, 1.0 + half, 3.5, half, 6.5, 0.125 * 5.0 / 7.0});
    CHECK_PARTS(told, check_text("set yrange [0:%.17g]\nset ytics 0.5\n", 1.08 * (1.0 + half)),
                "set ylabel 'pressure (N/m)' noenhanced\nset xlabel 'x (m)' noenhanced\nset boxwidth 3\n",
                "set label 1 'step 7, t = 0.5 s, 3 grains'");
    /* marks at steps of 1, 2 or 5 times a power of ten; forces on 3 m */
    static const double marks[][2] = {{12.0, 1.0}, {12.6, 2.0}, {360.0, 50.0}, {1.44, 0.2}, {66.0, 10.0}};
    for (size_t k = 0; k < sizeof marks / sizeof *marks; k++) {
        write_press(3.5, 3.5, marks[k][0]);
        tell(". -o a.png --base --cell 3");
        is_told("\nset ytics %g\n", marks[k][1]);
    }
    write_forces();
    /* a unit of both, or none */
    SHELL("sed s/N/1/ contacts.tsv >bare; cp bare contacts.tsv");
    tell(". -o a.png --base --cell 3");
    is_told("set ylabel 'pressure' noenhanced\nset xlabel 'x (m)' noenhanced\n");
    write_text("states.tsv", "x\ty\tr\n0\t1\t1\n");
    write_text("contacts.tsv",
               "# units: 1\t1\t1\t1\tN\t1\nx\ty\tx_b\ty_b\tnormal_force\twall\n0\t1\t0\t0\t6\t1\n");
    tell(". -o a.png --base --cell 3");
    CHECK_PARTS(told, "set ylabel 'pressure' noenhanced\nset xlabel 'x' noenhanced\n",
                "set label 2 'normal force 6 N' noenhanced at");
    write_text("contacts.tsv", "# units: m\tm\tm\tm\tmN\nx\ty\tx_b\ty_b\tforce\n0\t1\t0\t0\t6\n");
    tell(". -o a.png");
    is_told("set label 2 'normal force 6 mN' noenhanced at");
    write_pile();
    /* without a cell, as many bins as are nearest to three mean diameters; up to eight: to one */
    static const double ends[][2] = {{1.25, 1.125}, {6.5, 7.5 / 8.0}, {27.5, 2.85}};
    tell(". -o a.png --base");
    is_told("set boxwidth %.17g\n", 7.0 / 3.0);
    for (size_t k = 0; k < 3; k++) {
        write_text("states.tsv", "x\ty\tr\tfixed\n0\t0.5\t0.5\t0\n%g\t0.5\t0.5\t1\n", ends[k][0]);
        tell(". -o a.png --base");
        is_told("set boxwidth %.17g\n", ends[k][1]);
    }
    /* a fixed grain has a core */
    is_told("$grains << end\n0 0.5 0.5 0\n27.5 0.5 0.5 0 0.4\nend\n");
    is_told(", \\\n $grains using 1:2:($3*$5) with circles fc rgb '#404040' fs solid noborder notitle");
    /* long numbers are over a power of ten */
    write_text("states.tsv", "# units: m\tm\tm\nx\ty\tr\n0\t0\t1e-4\n5e-4\t0\t1e-4\n");
    tell(". -o a.png --color x");
    CHECK_PARTS(told, "set cblabel offset 1 'x (1e-4 m)' noenhanced\n",
                "set xlabel 'x (1e-3 m)' noenhanced\n", "set xtics ('-0.2' -0.0002",
                "set ylabel 'y (1e-3 m)' noenhanced\n");
    write_pile();
    write_press(3.5, 3.5, 12e8);
    tell(". -o a.png --base --cell 3");
    CHECK_PARTS(told, "set ytics ('0' 0, '1' 100000000, '2' 200000000, '3' 300000000, '4' 400000000)\n",
                "set ylabel 'pressure (1e8)' noenhanced\n");
    /* of a static pile the forces are those of its base; without names of the units */
    write_text("disks.tsv", "x\ty\tr\n0\t0.5\t0.5\n1\t0.5\t0.5\n2\t0.5\t0.5\n");
    SHELL("rm contacts.tsv walls.tsv states.tsv");
    write_text("base.tsv", "i\tx\tN/mg\tH/mg\n1\t0\t0.25\t7\n2\t1\t0.5\t7\n3\t2\t0.125\t7\n");
    tell(". -o a.png --base --cell 1");
    check_data("base", 0, 4, 2, (double[]){0, 0.25, 1, 0.5, 2, 0.125, 3, 0});
    CHECK_PARTS(told, "set ylabel 'pressure' noenhanced", "'3 grains'");
}

/* Lines are as wide as 0.9 of a mean radius, from 2 to 5; class k of 12 has (k - 1/2)/12 of it, and a shade
 * from pale to dark. A window of W by W m is 14 by 14 cm, in a picture of 16.5 by 16.9 cm. */
static void test_styles(void)
{
    static const int windows[] = {50, 136, 900};
    write_pile();
    write_text("states.tsv", "# units: m\tm\tm\nx\ty\tr\n0\t1\t1\n2\t1\t1\n");
    SHELL("rm walls.tsv >out 2>err");
    for (int k = 0; k < 3; k++) {
        const double length = 14.0 / windows[k], width = fmin(fmax(0.9 * length * 37.8, 2.0), 5.0);
        tell(". -o a.svg --window 0,%d,0,%d", windows[k], windows[k]);
        static const char *const shades[] = {"#96aac3", "#495a78", "#08183a"};
        static const int classes[] = {1, 7, 12};
        for (int i = 0; i < 3; i++)
            is_told("set style arrow %d nohead lw %.3g lc rgb '%s'\nset style arrow %d nohead lw %.3g lc "
                    "rgb '#d55e00'\n",
                    classes[i], width * (classes[i] - 0.5) / 12.0, shades[i], classes[i] + 20,
                    width * (classes[i] - 0.5) / 12.0);
        is_told("set style arrow 50 nohead lw %.3g lc rgb '#0072b2'\nset style arrow 51 nohead lw %.3g lc "
                "rgb '#d55e00'\n",
                fmax(0.4 * width, 1.0), fmax(0.4 * width, 1.0));
        is_told(
            "plot $grains using 1:2:($3*%.9g + %g) with points pt 7 ps variable lc rgb '#a8a8a8' notitle, "
            "\\\n"
            " $grains using 1:2:($3*%.9g - %g) with points pt 7 ps variable lc rgb '#eeeeee' notitle, \\\n"
            " $contacts using",
            length * 37.8 / 4.125, 0.25 / 4.125, length * 37.8 / 4.125, 0.25 / 4.125);
        is_told("set yrange [0:%d]\nset tmargin at screen %.5f\nset bmargin at screen %.5f\n"
                "set ylabel 'y (m)' noenhanced\n",
                windows[k], 1.0 - 1.4 / 16.9, 1.5 / 16.9);
        is_told("lmargin at screen %.5f\nset rmargin at screen %.5f\n", 1.8 / 16.5, 1.0 - 0.7 / 16.5);
        is_told("'2 grains' noenhanced at graph 0, screen %.5f left\n", 1.0 - 0.5 / 16.9);
        CU_ASSERT(!strstr(told, "$walls with"));
    }
    tell(". -o a.png --color r");
    is_told("set style arrow 7 nohead lw 2.71 lc rgb '#000000'\n");
    tell(". -o a.png --stress");
    CHECK_PARTS(told, "set style arrow 7 nohead lw 2.71 lc rgb '#b9b9b9'\n",
                "plot $grains using 1:2:3 with circles lw 0.4 fc rgb '#eeeeee' notitle, \\\n");
}

/* Of walls without ends, what is within the window; none of those beside it, however near. */
static void test_clipped(void)
{
    write_text("p_grains.tsv", "x\ty\tr\n0\t1\t1\n");
    write_text("p_walls.tsv", "x\ty\tdirection_x\tdirection_y\tfrom\tto\n"
                              "3\t9.5\t0\t1\t-inf\tinf\n3\t-0.5\t0\t1\t-inf\tinf\n3\t10.5\t0\t1\t-inf\tinf\n"
                              "0.5\t3\t1\t0\t-inf\tinf\n-0.5\t3\t1\t0\t-inf\tinf\n10.5\t3\t1\t0\t-inf\tinf\n"
                              "0\t0.5\t0\t1\t-inf\tinf\n3\t5\t0\t1\t20\t30\n3\t5\t0\t1\t-1\t1e9\n");
    tell("p_grains.tsv -o a.png --window 0,10,0,10");
    check_data("walls", 0, 4, 4, (double[]){0, 9.5, 10, 0, 0.5, 10, 0, -10, 0, 0.5, 10, 0, 2, 5, 8, 0});
    /* through (1, 1) and (3, 1), along (4, -3) and (7, 24) */
    write_text("p_walls.tsv", "x\ty\tdirection_x\tdirection_y\tfrom\tto\n1\t1\t0.6\t0.8\t-inf\tinf\n"
                              "3\t1\t-0.96\t0.28\t-inf\tinf\n");
    tell("p_grains.tsv -o a.png --window 0,10,0,10");
    check_data("walls", 0, 2, 4, (double[]){0, 1.75, 7.0 / 3.0, -1.75, 3.0 - 7.0 / 24.0, 0, 70.0 / 24.0, 10});
    is_told("$walls with vectors nohead lw 2.5 lc rgb '#404040' notitle\n");
    /* a single frame has all contacts and walls, whatever their step */
    write_text("p_grains.tsv", "step\tx\ty\tr\n7\t0\t1\t1\n");
    write_text("p_contacts.tsv", "step\tx\ty\tx_b\ty_b\tforce\n5\t0\t1\t0\t0\t3\n7\t0\t1\t1\t1\t6\n");
    write_text("p_walls.tsv",
               "step\tx\ty\tdirection_x\tdirection_y\tfrom\tto\n5\t0\t0\t0\t1\t0\t1\n7\t0\t0\t0\t1\t2\t3\n");
    tell("p_grains.tsv -o a.png --window 0,10,0,10");
    check_data("contacts", 0, 2, 5, (double[]){0, 1, 0, -1, 6, 0, 1, 1, 0, 12});
    check_data("walls", 0, 2, 4, (double[]){0, 0, 1, 0, 2, 0, 1, 0});
}

/* Stages of a run by their steps, whatever their names; a stage without rows is none. */
static void test_stages(void)
{
    static const char *const names[] = {"a", "b", "d"};
    static const int order[] = {9, 1, 5};
    SHELL("mkdir d >out 2>err");
    for (int k = 0; k < 3; k++) {
        write_text(check_text("d/%s_grains.tsv", names[k]), "step\tx\ty\tr\n%d\t%d\t0\t1\n", order[k], k);
        write_text(check_text("d/%s_contacts.tsv", names[k]),
                   "step\tx\ty\tx_b\ty_b\tforce\n%d\t%d\t0\t%d\t2\t%d\n", order[k], k, k, 1 + k);
    }
    write_text("d/c_grains.tsv", "step\tx\ty\tr\n");
    tell("d -o a.gif");
    static const double x[] = {1, 2, 0}, class[] = {12, 12, 6}; /* of a force of 2 */
    for (size_t k = 0; k < 3; k++) {
        check_data("grains", k, 1, 4, (double[]){x[k], 0, 1, 0});
        check_data("contacts", k, 1, 5, (double[]){x[k], 0, 0, 2, class[k]});
    }
    is_told("set label 2 'normal force 2' noenhanced at");
}

/* ---- kinds of folders and files ---- */

static void test_kinds(void)
{
    write_pile();
    GOOD("view states.tsv -o a.png --force");
    SHELL("head -c 8 a.png | od -An -tx1 | grep -q '89 50 4e 47 0d 0a 1a 0a'");
    SHELL("test $(grep -ao IEND a.png | wc -l) = 1");
    /* 18 cm at 80 pixels */
    SHELL("head -c 20 a.png | tail -c 4 | od -An -tx1 | grep -q '00 00 05 a0'");
    GOOD("view . -o a.pdf --force --width 9");
    SHELL("head -c 5 a.pdf | grep -q ^%PDF-");
    GOOD("pile --base 5 --eps 1e-3 -o static");
    view_svg("static --base");
    CU_ASSERT(n_circles == 2 * 15);
    SHELL("grep -q 'y (sigma)' a.svg && grep -q 'pressure (m g/sigma)' a.svg");
    write_text("r.cfg", "protocol = \"repose\"; fixed = { W = 1.0; H = 1.0; fill_steps = 100; stop = "
                        "\"steps\"; relax_steps = 100; };\ngrid = { mu = [0.1]; };\n");
    CU_ASSERT(run("run r.cfg -o stages") <= 1);
    GOOD("view stages -o a.gif --force"); /* the ends of phases */
    SHELL("LC_ALL=C grep -aob \"$(printf '\\041\\371\\004')\" a.gif | wc -l | grep -qx 5");
}

/* No text of a table is a command to gnuplot: backquotes, quotes, ends of lines in units, names, folders. */
static void test_hostile(void)
{
    static const char *const texts[] = {"`>hit`",     "'`>hit`'", "\"`>hit`\"x", "';system('>hit');'",
                                        "\\\"`>hit`", "$(>hit)",  "a';!>hit;'"};
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
        write_text("g.tsv", "# units: s\t%s\t%s\t%s\t%s\nt\tx\ty\tr\t%s\n0.5\t0.25\t0.5\t0.125\t1\n",
                   texts[k], texts[k], texts[k], texts[k], texts[k]);
        write_text("name", "%s", texts[k]);
        SHELL("d=\"d$(cat name | tr / _)\"; mkdir -p \"$d\" && cp g.tsv \"$d/x_grains.tsv\" && \"$REPOSE\" "
              "view \"$d\" -o \"$d/p.svg\" --color \"$(cat name)\" >out 2>err && ls \"$d/p.svg\" >out && "
              "! ls hit >>out 2>&1");
    }
}

/* Read a string as gnuplot does, from its first quote on: single quotes, and one of the text between double
 * ones. Returns what follows. */
static const char *read_string(const char *at, char text[256])
{
    size_t n = 0;
    for (at++; *at && (*at != '\'' || strncmp(at, "'.\"'\".'", 7) == 0); n++) {
        CU_ASSERT_FATAL(n < 255);
        text[n] = *at;
        at += *at == '\'' ? 7 : 1;
    }
    text[n] = '\0';
    CU_ASSERT(*at == '\'');
    return at + 1;
}

/* Random texts as units and as the name of the coloured column: what gnuplot is told has them as strings,
 * with blanks for control characters, and nothing of them elsewhere. gnuplot itself then draws all. */
static void test_random_texts(void)
{
    enum { TEXTS = 1000 };
    static const double x[] = {0.0}, r[] = {1.0}, value[] = {2.0};
    const view_contact contact = {.normal = 1.0, .wall = true, .c = {.y = 1.0, .fy = 1.0}};
    view_frame f = {
        .step = 5.0, .t = 0.5, .n = 1, .x = x, .y = r, .r = r, .value = value, .contacts = &contact};
    view_scene scene = {.n = 1, .frames = &f};
    scoped_rng *rng = numbers_of(2385, 7);
    char color[NUMBERS_TEXT], text[256], expected[2 * NUMBERS_TEXT + 8];
    FILE *all = file_of("all.gp");
    fputs("set terminal dumb\nset output '/dev/null'\n", all);
    for (int k = 0; k < TEXTS; k++) {
        char *const units[] = {scene.length, scene.force, scene.time, scene.quantity};
        scoped char *said = NULL;
        size_t size, found = 0, outside = 0;
        RP_SCOPE(arena);
        view_scale scale;
        for (int i = 0; i < 4; i++) numbers_text(rng, "", units[i]);
        numbers_text(rng, "", color);
        view_style style = {.width = 16.0, .window = {NAN}, .cell = 2.0, .color = color};
        style.stress = k % 3 == 1, style.base = k % 3 == 2;
        f.n_contacts = (size_t)(k % 4 > 0) | style.stress | style.base;
        FILE *file = open_memstream(&said, &size);
        CHECK_OK(view_scale_of(&arena, &scene, 0, 0, &style, &scale));
        view_draw_start(&scene, &style, &scale, file);
        CHECK_OK(view_draw(&arena, &scene, &f, &style, &scale, file));
        fclose(file);
        snprintf(expected, sizeof expected, strcmp(scene.quantity, "1") ? "%s (%s)" : "%s", color,
                 scene.quantity);
        for (char *c = expected; *c; c++)
            if ((unsigned char)*c < ' ') *c = ' ';
        for (const char *c = said; *c;)
            if (*c == '\'') {
                c = read_string(c, text);
                found += strcmp(text, expected) == 0;
            } else {
                outside += (strchr("`\"!@", *c) != NULL) + (*c == '\\' && c[1] != '\n');
                c++;
            }
        CU_ASSERT(found == 1 && outside == 0);
        fputs(said, all);
    }
    fclose(all);
    SHELL("gnuplot all.gp >warnings 2>&1 && ! ls hit >out 2>err");
}

static void test_refusals(void)
{
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
    FAILS(65, "more than 100000 cells", "view . -o a.svg --base --cell 1e-4");
    write_text("far.tsv", "x\ty\tr\n1\t2\t1\n1e200\t1e200\t1\n");
    FAILS(65, "no window holds the grains: x over 1e+200", "view far.tsv -o a.svg");
    write_text("far.tsv", "x\ty\tr\n1e20\t0\t1\n"); /* a radius is less than a digit */
    FAILS(65, "no window holds the grains: x over 0, y over 4", "view far.tsv -o a.svg");
    write_text("far.tsv", "x\ty\tr\n0\t1e20\t1\n");
    FAILS(65, "no window holds the grains: x over 4, y over 0", "view far.tsv -o a.svg");
    static const char *const grains[] = {"nan\t2\t1", "1\tnan\t1", "1\t2\tinf",
                                         "1\t2\tnan", "1\t2\t-1",  "inf\t2\t1"};
    for (size_t k = 0; k < 12; k++) {
        const char *bad = grains[k / 2], *good = "0.5\t-0.5\t0.25";
        write_text("row.tsv", "x\ty\tr\n%s\n%s\n", k % 2 ? good : bad, k % 2 ? bad : good);
        FAILS(65, k % 2 ? "row.tsv: row 2: x, y and a radius" : "row.tsv: row 1: x, y and a radius",
              "view row.tsv -o a.svg");
    }
    static const char *const contacts[] = {"1\t2\t1\t2\t3\t0", "1\t2\t1\t1\tinf\t0", "1\t2\t1\t1\t3\tinf",
                                           "1\t2\t1\t1\t1e308\t1e308"};
    write_text("one_grains.tsv", "x\ty\tr\n1\t2\t1\n");
    for (size_t k = 0; k < 4; k++) {
        write_text("one_contacts.tsv", "x\ty\tx_b\ty_b\tnormal_force\tshear_force\n1\t2\t1\t1\t3\t0\n%s\n",
                   contacts[k]);
        FAILS(65, "one_contacts.tsv: row 2 has no branch or no force", "view one_grains.tsv -o a.svg");
    }
    FAILS(1, "--stress: no table of contacts", "view points.tsv -o a.svg --stress");
    FAILS(1, "--base: no contacts that press on a wall", "view points.tsv -o a.svg --base");
    FAILS(74, "cannot write", "view . -o file/a.svg");
    CU_ASSERT(shell("mkdir empty none; PATH=empty DISPLAY= \"$(command -v \"$REPOSE\")\" view . -o a.svg "
                    "2>err") == 1);
    CHECK_PARTS(err, "Debian has it in the package gnuplot-nox");
    SHELL("! ls | grep -q svg");
    FAILS(65, "no rows in a states.tsv, disks.tsv or ..._grains.tsv", "view none -o a.svg");
}

/* ---- what a run says ---- */

/* A staircase of fixed grains is a pile: steps of 0.1 per diameter of 0.2 have a slope of 26.6 degrees. */
static void test_closing_line(void)
{
    static const char walls[] = "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } );";
    const char *grains = "";
    for (int k = 0; k < 12; k++)
        grains = check_text("%s%s{ x = %g; y = %g; r = 0.1; fixed = true; }", grains, k ? ", " : "",
                            0.1 + 0.2 * k, -1.0 - 0.1 * k);
    write_text(
        "stairs.cfg",
        "steps = 10; walls = ( { point = [0.0, -3.0]; direction = [0.0, 1.0]; } ); particles = ( %s );\n",
        grains);
    GOOD("run stairs.cfg -o d");
    CU_ASSERT(strncmp(err, "repose run: 12 grains, 10 steps, t = 0.0005 s; at rest; theta_R = ", 66) == 0);
    CHECK_NEAR(strtod(err + 66, NULL), 180.0 / M_PI * atan(0.5), 0.05); /* one decimal is printed */
    CU_ASSERT(strstr(err, ", over x = 0 to 2.4 cm (method 3); tables in d\n") != NULL);
    GOOD("run stairs.cfg -o d --force --quiet");
    CU_ASSERT_STRING_EQUAL(err, "");
    write_text("open.cfg",
               "steps = 10; walls = ( { point = [0.0, -3.0]; direction = [0.0, 1.0]; }, { point = [2.0, "
               "0.0]; direction = [-1.0, 0.0]; open_at_step = 5; }, { point = [0.6, 0.0]; direction = [1.0, "
               "0.0]; } ); particles = ( %s );\n",
               grains);
    write_text("level.cfg",
               "steps = 10; %s particles = ( { x = 0.3; y = 0.1; r = 0.1; fixed = true; }, { x = "
               "0.6; y = 0.1; r = 0.1; fixed = true; } );\n",
               walls);
    write_moving();
    write_text("thrown.cfg",
               "steps = 1000; dt = 1e-5; %s particles = ( { x = 0.3; y = 1.0; r = 0.1; vy = 9.81; } );\n",
               walls);
    write_text(
        "falls.cfg",
        "dt = 1e-5; normal = { gamma_n = 2000.0; }; %s particles = ( { x = 0.3; y = 0.105; r = 0.1; } );\n",
        walls);
    static const char *const cases[][2] = {
        /* a grain a little inside the wall at 0; units are the scene's, those of grains have no names */
        {"stairs.cfg --set 'particles[0].x=0.0991' --set units=si",
         ", t = 0.0005 s; at rest; theta_R = 26.6 degrees, standard error 0.0, over x = 0 to 2.4 m (method "
         "3); "},
        {"stairs.cfg --set 'particles[0].x=0.0991' --set units=sigma --set dt=5e-5",
         ", t = 0.0005; at rest; theta_R = 26.6 degrees, standard error 0.0, over x = 0 to 2.4 (method 3); "},
        /* a pile ends at the wall that has opened; a level one has no slope */
        {"open.cfg -o open", "over x = 0 to 2 cm (method 3)"},
        {"open.cfg --set 'walls[1].point=[0.4, 0.0]' --set 'walls[1].direction=[1.0, 0.0]'",
         "over x = 0.4 to 2.4 cm (method 3)"},
        {"level.cfg", "run: 2 grains, 10 steps, t = 0.0005 s; at rest; states on standard output\n"},
        {"s.cfg -o moving", "run: 2 grains, 100 steps, t = 0.001 s; not at rest; tables in moving\n"},
        /* at the top of a throw, where it has no energy; in the air; without a grain that is left */
        {"thrown.cfg", "t = 0.01 s; not at rest; "},
        {"thrown.cfg --set steps=0 --set 'particles[0].vy=0'", "t = 0 s; not at rest; "},
        {"thrown.cfg --set y_min=0.95 --set steps=5000",
         "run: 0 grains, 5000 steps, t = 0.05 s; not at rest; "},
        /* a grain that lands before the second of ten looks, or before all; too few steps for ten */
        {"falls.cfg --set steps=3000", " s; not at rest"},
        {"falls.cfg --set steps=10000", " s; at rest"},
        {"falls.cfg --set steps=9", " s; not at rest"},
        /* falls too slowly to be seen in so short a time */
        {"thrown.cfg --set dt=1e-9 --set 'particles[0].vy=0' --set steps=6000", " s; not at rest; "}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        GOOD("run %s", cases[k][0]);
        CHECK_PARTS(err, cases[k][1]);
    }
    CU_ASSERT(run("run level.cfg -j 3") == 0 &&
              strncmp(err, "repose run: -j 3 has no effect: only velocity Verlet is threaded, ", 66) == 0);
    CU_ASSERT(strstr(err, "; there are 2\nrepose run: 2 grains, ") != NULL);
}

/* Without a terminal a line a minute, with it a bar; the time left follows from the steps done. */
static void show(cli_progress p, size_t n, const double at[][2], FILE *file)
{
    for (size_t k = 0; k < n; k++) cli_progress_show(&p, at[k][0], (long)at[k][1], file);
}

static void test_progress(void)
{
    static const double file[][2] = {{1059, 120}, {1061, 200}, {1120, 300}, {1122, 600}, {1300, 1100}},
                        screen[][2] = {{0.4, 10}, {1, 100}, {1.05, 110}, {1.06, 300}},
                        end[][2] = {{100, 300}};
    CHECK_WRITTEN(lines, to, show(cli_progress_start(false, false, 1000.0, 100, 1100), 5, file, to));
    CU_ASSERT_STRING_EQUAL(lines, "repose run: step 200 of 1100, 18 %, 9:09 left\n" /* and the closing line */
                                  "repose run: step 600 of 1100, 54 %, 2:02 left\n");
    CHECK_WRITTEN(bar, on, show(cli_progress_start(false, true, 0.0, 0, 300), 4, screen, on));
    CU_ASSERT(strncmp(bar, "\r[##########                    ] step 100 of 300, 33 %, 0:02 left", 66) == 0);
    CU_ASSERT(!strstr(bar, "110") && strstr(bar, "\r[##############################] step 300 of 300"));
    CU_ASSERT(bar[bar_size - 1] == '\n');
    CHECK_WRITTEN(quiet, none, show(cli_progress_start(true, true, 0.0, 0, 300), 1, end, none));
    CU_ASSERT(quiet_size == 0);
}

/* Of a sweep: a line a minute in a file; on a terminal a bar, ten times a second and at the end. */
static void test_sweep_progress(void)
{
    static const sweep_progress shown[] = {
        {30, 0, 0, 0.0, NAN},    {30, 1, 0, 59.9, 1.0},      {30, 2, 1, 60.0, 75.0},  {30, 3, 1, 60.05, 74.0},
        {30, 4, 2, 119.9, 60.0}, {30, 15, 2, 120.0, 3661.0}, {30, 30, 2, 120.01, 0.0}};
    enum { SHOWN = sizeof shown / sizeof *shown };
    const int kept = dup(STDERR_FILENO), terminal = posix_openpt(O_RDWR | O_NOCTTY);
    for (int k = 0; k < 2; k++) {
        FILE *file = tmpfile();
        char text[2048] = "";
        cli_progress progress;
        sweep_options options = {0};
        const bool ready = k == 0 || (terminal >= 0 && grantpt(terminal) == 0 && unlockpt(terminal) == 0);
        CU_ASSERT_FATAL(file && ready);
        const int slave = k == 0 ? dup(fileno(file)) : open(ptsname(terminal), O_RDWR | O_NOCTTY);
        dup2(slave, STDERR_FILENO);
        cli_sweep_progress(&options, false, &progress);
        for (int i = 0; i < SHOWN; i++) options.watch(&shown[i], options.context);
        dup2(kept, STDERR_FILENO);
        if (k == 0) rewind(file);
        for (ssize_t used = 0, got = 1; got > 0 && !strstr(text, "30/30"); used += got)
            got = read(k == 0 ? fileno(file) : terminal, text + used, sizeof text - 1 - (size_t)used);
        close(slave);
        fclose(file);
        CU_ASSERT(progress.drawn == (k == 1));
        if (k == 0)
            CU_ASSERT_STRING_EQUAL(text, "repose sweep: 2 of 30 runs, 1 failed, 1:15 left\n"
                                         "repose sweep: 15 of 30 runs, 2 failed, 1:01:01 left\n");
        static const char *const bars[] = {
            "[                              ] 0/30  0 failed  0:00  left - ",
            "] 1/30 ",
            "] 2/30 ",
            "] 4/30 ",
            "[###############               ] 15/30  2 failed  2:00  left 1:01:01 ",
            "[##############################] 30/30 "};
        const char *at = text;
        for (size_t i = 0; k == 1 && at && i < sizeof bars / sizeof *bars; i++) at = strstr(at, bars[i]);
        CU_ASSERT(at && !strstr(text, "] 3/30"));
    }
    close(kept), close(terminal);
}

CHECK_SUITE_WITHIN(view, "view", enter, leave, test_circles, test_forces, test_segment, test_layout,
                   test_colors, test_frames, test_film, test_animation, test_chosen, test_sweep_progress,
                   test_range, test_crosses, test_bins, test_styles, test_clipped, test_stages, test_kinds,
                   test_hostile, test_random_texts, test_refusals, test_closing_line, test_progress)
