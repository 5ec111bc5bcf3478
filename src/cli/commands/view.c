/* `repose view`: pictures and animations of grains, walls and forces, drawn by gnuplot. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/cli.h"
#include "params/config.h"
#include "table/columns.h"
#include "view/view.h"

#define VIEW_OPTIONS(X)                                                                                      \
    X(TEXT, o, "", "", "",                                                                                   \
      "picture (.png, .svg, .pdf) or animation (.gif, .mp4) to write; without it, a window opens")           \
    X(TEXT, frame, "", "auto", "",                                                                           \
      "last, all, the number of a frame from 0, step=N, or the name of a phase for its end; auto: last, or " \
      "all for an animation")                                                                                \
    X(TEXT, color, "", "", "", "column of the table of grains by which grains are coloured; kind: with their names")                 \
    X(BOOL, stress, "", "false", "", "draw principal stresses as crosses, with attraction in orange")        \
    X(BOOL, base, "", "false", "", "plot the vertical force per length on the base below the picture")       \
    X(REAL, cell, "", "auto", "(0, inf) | auto",                                                             \
      "width of the bins of stress and base, in the unit of the table; auto: three mean diameters, in a "    \
      "narrow pile an eighth of its width, but at least one diameter")                                       \
    X(TEXT, x, "", "", "", "column of a sweep's points, drawn along x")                                      \
    X(TEXT, y, "", "", "", "column of a sweep's points, drawn along y; NAME_mean has NAME_se as error bars") \
    X(TEXT, window, "", "auto", "", "X0,X1,Y0,Y1: region that is shown; auto: all grains")                   \
    X(REAL, width, "cm", "18", "[8, 60]", "width of the picture")                                            \
    X(REAL, fps, "1/s", "10", "[0.1, 50]", "frames per second of an animation")                              \
    CLI_FORCE(X)

CLI_OPTIONS(view, VIEW_OPTIONS)

#define TEXT_OF(number) TEXT(number)
#define TEXT(number)    #number

/* Kinds of output by the name's ending. */
static const struct kind {
    const char *ending, *terminal;
    double per_cm; /* pixels */
    bool moves;
} kinds[] = {
    {"", ""}, /* a window, of gnuplot's own choice */
    {".png", "pngcairo enhanced font 'DejaVu Sans,11' fontscale 1.5 linewidth 2 size %.0f,%.0f", 80.0},
    {".svg", "svg enhanced font 'DejaVu Sans," TEXT_OF(VIEW_LETTERS) "' background 'white' size %.0f,%.0f",
     37.8},
    {".pdf", "pdfcairo enhanced font 'DejaVu Sans,8' size %.3fcm,%.3fcm", 1.0},
    {".gif", "gif animate delay %d loop 0 enhanced font 'DejaVu Sans,10' size %.0f,%.0f", 48.0, true},
    {".mp4", "pngcairo enhanced font 'DejaVu Sans,11' fontscale 1.1 linewidth 1.5 size %.0f,%.0f", 60.0,
     true}};

static rp_status find_kind(const char *path, const struct kind **kind)
{
    *kind = kinds;
    if (!*path) return RP_OK;
    for (const struct kind *k = kinds + 1; k < kinds + N_OF(kinds); k++)
        if (strlen(path) > strlen(k->ending) && rp_ends_in(path, k->ending)) return *kind = k, RP_OK;
    return rp_fail(RP_USAGE, "-o %s: a name that ends in .png, .svg, .pdf, .gif or .mp4 expected", path);
}

/* The step at which a phase of an experiment ended last, by the notes of its measures, or by phases.tsv of a
 * row of a sweep; NAN: none does. */
static double step_of_phase(rp_arena *arena, const char *folder, const char *phase)
{
    const char *path = rp_text(arena, "%s/measures.tsv", folder), *note = NULL;
    const bool row = !rp_is_there(path);
    rp_table *table;
    double step = NAN;
    if (row) path = rp_text(arena, "%s/phases.tsv", folder);
    if (access(path, R_OK) != 0 || rp_table_load(arena, path, &table)) return NAN;
    const int name = rp_table_column(table, "phase"), at = rp_table_column(table, "step");
    for (size_t k = 0; row && name >= 0 && at >= 0 && k < table->n_rows; k++)
        if (strcmp(rp_cell(table, k, name), phase) == 0) rp_table_number(table, k, at, 1, &step);
    if (!row) note = rp_table_find_note(table, rp_text(arena, "phase %s", phase));
    if (note && (note = strstr(note, "to step "))) sscanf(note, "to step %lf", &step);
    return step;
}

static rp_status choose_frames(rp_arena *arena, const char *folder, const view_scene *scene, const char *text,
                               bool moves, size_t *first, size_t *last)
{
    char *end;
    const size_t n = scene->n;
    *first = *last = n - 1;
    if (strcmp(text, "auto") == 0) text = moves ? "all" : "last";
    if (strcmp(text, "last") == 0) return RP_OK;
    if (strcmp(text, "all") == 0) {
        *first = 0;
        return moves || n == 1
                   ? RP_OK
                   : rp_fail(RP_USAGE, "--frame all: a picture shows one frame; -o NAME.gif shows %zu", n);
    }
    bool step = strncmp(text, "step=", 5) == 0;
    double number = strtod(text + (step ? 5 : 0), &end);
    if (*end || end == text + (step ? 5 : 0)) {
        step = true, number = step_of_phase(arena, folder, text);
        if (isnan(number))
            return rp_fail(RP_USAGE,
                           "--frame %s: last, all, a number or step=N expected, or a phase that has ended",
                           text);
    }
    for (size_t k = 0; k < n; k++)
        if (step ? scene->frames[k].step == number : (double)k == number) return *first = *last = k, RP_OK;
    return rp_fail(RP_BAD_INPUT, "--frame %s: there are frames 0 to %zu, steps %.0f to %.0f", text, n - 1,
                   scene->frames[0].step, scene->frames[n - 1].step);
}

static rp_status read_style(const view_options *o, view_style *style)
{
    *style = (view_style){.width = o->width,
                          .window = {NAN, NAN, NAN, NAN},
                          .cell = o->cell,
                          .color = o->color,
                          .stress = o->stress,
                          .base = o->base};
    double *w = style->window;
    int length = 0;
    if (strcmp(o->window, "auto") == 0) return RP_OK;
    if (sscanf(o->window, "%lf,%lf,%lf,%lf%n", w, w + 1, w + 2, w + 3, &length) == 4 && !o->window[length] &&
        isfinite(w[1] - w[0]) && isfinite(w[3] - w[2]) && w[0] < w[1] && w[2] < w[3])
        return RP_OK;
    return rp_fail(RP_USAGE, "--window %s: X0,X1,Y0,Y1 with X0 < X1 and Y0 < Y1 expected", o->window);
}

static void put_terminal(const struct kind *kind, const view_options *o, const view_scale *s, FILE *out)
{
    const double x = s->width * kind->per_cm, y = s->height * kind->per_cm;
    if (kind == kinds) {
        fputs(view_gnuplot_window, out);
        return;
    }
    fputs("set terminal ", out);
    if (strstr(kind->terminal, "%d"))
        fprintf(out, kind->terminal, (int)lround(100.0 / o->fps), x, y);
    else
        fprintf(out, kind->terminal, x, y);
    fputc('\n', out);
}

/* What is drawn, and on what: frames, or points with errors, NULL without. */
typedef struct {
    size_t n;
    double *points[3];
    char label[2][160];
    view_scene scene;
    view_style style;
    view_scale scale;
    size_t first, last;
    const struct kind *kind;
} picture;

/* The means of a sweep over a column, from its table of points. */
static rp_status read_points(rp_arena *arena, const char *path, const view_options *o, picture *p)
{
    static const char *const places[] = {"tables/points.tsv", "points.tsv"};
    const char *table = path, *const axes[] = {o->x, o->y};
    const size_t n = strlen(o->y);
    const bool mean = n > 5 && rp_ends_in(o->y, "_mean");
    char se[64], names[200], unit[32];
    rp_table *t;
    rp_rows rows;
    for (size_t k = 0; k < 2; k++)
        if (access(rp_text(arena, "%s/%s", path, places[k]), R_OK) == 0)
            table = rp_text(arena, "%s/%s", path, places[k]);
    RP_TRY(rp_one_column("-x", o->x));
    RP_TRY(rp_one_column("-y", o->y));
    if (rp_is_in(path, "store.sqlite") && table == path)
        return rp_fail(RP_BAD_INPUT,
                       "%s: no points.tsv; repose sweep export %s --reduce -o %s/points.tsv writes it", path,
                       path, path);
    RP_TRY(rp_table_load(arena, table, &t));
    snprintf(se, sizeof se, "%.*s_se", mean ? (int)n - 5 : 0, o->y);
    const bool errors = mean && rp_table_column(t, se) >= 0;
    snprintf(names, sizeof names, "%s,%s%s%s", o->x, o->y, errors ? "," : "", errors ? se : "");
    RP_TRY(rp_rows_read(arena, t, names, &(rp_choice){.grouped = true}, &rows));
    p->n = rows.n;
    for (int k = 0; k < 2 + errors; k++) p->points[k] = rows.column[k];
    for (int k = 0; k < 2; k++) {
        rp_column_unit(t, rp_table_column(t, axes[k]), unit);
        const bool bare = strcmp(unit, "1") == 0;
        snprintf(p->label[k], sizeof p->label[k], "%s%s%s", axes[k], bare ? "" : ", ", bare ? "" : unit);
    }
    p->scale = (view_scale){.width = o->width, .height = 0.7 * o->width};
    return RP_OK;
}

static void put_points(const picture *p, FILE *out)
{
    for (int k = 0; k < 2; k++) {
        fprintf(out, "set %clabel ", "xy"[k]);
        rp_config_write_text(out, p->label[k]);
        fputs(" noenhanced\n", out);
    }
    fputs("set grid\nset offsets graph 0.05, graph 0.05, graph 0.05, graph 0.05\n$points << end\n", out);
    for (size_t i = 0; i < p->n; i++)
        fprintf(out, "%.9g %.9g %.9g\n", p->points[0][i], p->points[1][i],
                p->points[2] ? p->points[2][i] : 0.0);
    fprintf(out, "end\nplot $points with %s pt 7 lc rgb '#0072b2' notitle\n",
            p->points[2] ? "yerrorbars" : "points");
}

static rp_status put_frames(rp_arena *arena, const picture *p, const view_options *o, FILE *out)
{
    put_terminal(p->kind, o, &p->scale, out);
    if (p->n > 0) return put_points(p, out), RP_OK;
    view_draw_start(&p->scene, &p->style, &p->scale, out);
    for (size_t k = p->first; k <= p->last; k++) {
        RP_TRY(view_draw(arena, &p->scene, &p->scene.frames[k], &p->style, &p->scale, out));
        if (p->kind == kinds && k < p->last) fprintf(out, "pause %.3f\n", 1.0 / o->fps);
    }
    return RP_OK;
}

/* gnuplot, whose pictures go to `out` (NULL: a window). */
static rp_status draw(rp_arena *arena, const picture *p, const view_options *o, FILE *out)
{
    char *const arguments[] = {"gnuplot", out ? NULL : "-persist", NULL};
    view_gnuplot gnuplot;
    RP_TRY(view_gnuplot_open(&gnuplot, arguments, out ? "gnuplot-nox" : "gnuplot-qt", out));
    rp_status status = put_frames(arena, p, o, gnuplot.in);
    const rp_status closed = view_gnuplot_close(&gnuplot);
    return closed ? closed : status;
}

/* ffmpeg makes a film of the pictures that gnuplot writes. */
static rp_status film(rp_arena *arena, const picture *p, const view_options *o, FILE *out)
{
    char *const rate = rp_text(arena, "%g", o->fps), *const path = rp_text(arena, "/proc/%d/fd/%d",
                                                                           (int)getpid(), fileno(out));
    char *const arguments[] = {
        "ffmpeg",   "-loglevel", "error", "-y",  "-f", "image2pipe", "-framerate",
        rate,       "-c:v",      "png",   "-i",  "-",  "-vf",        "pad=ceil(iw/2)*2:ceil(ih/2)*2",
        "-pix_fmt", "yuv420p",   "-f",    "mp4", path, NULL};
    view_gnuplot ffmpeg;
    RP_TRY(view_gnuplot_open(&ffmpeg, arguments, "ffmpeg", NULL));
    rp_status status = draw(arena, p, o, ffmpeg.in);
    const rp_status closed = view_gnuplot_close(&ffmpeg);
    return status ? status : closed;
}

static rp_status read_frames(rp_arena *arena, const char *path, const view_options *o, picture *p)
{
    RP_TRY(view_read(arena, path, o->color, &p->scene));
    RP_TRY(choose_frames(arena, path, &p->scene, o->frame, p->kind->moves || !*o->o, &p->first, &p->last));
    return view_scale_of(arena, &p->scene, p->first, p->last, &p->style, &p->scale);
}

static rp_status act_view(cli_call *call, const void *values)
{
    const view_options *o = values;
    picture p = {0};
    FILE *out;
    if (!*o->x != !*o->y) return rp_fail(RP_USAGE, "-x and -y go together: columns of a sweep's points");
    RP_TRY(find_kind(o->o, &p.kind));
    if (!*o->o && !view_has_screen())
        return rp_fail(RP_USAGE, "no screen for a window: -o FILE writes a picture");
    RP_TRY(read_style(o, &p.style));
    p.style.points = strcmp(p.kind->ending, ".svg") == 0;
    RP_TRY((*o->x ? read_points : read_frames)(call->arena, cli_argument(call, 0), o, &p));
    if (!*o->o) return draw(call->arena, &p, o, NULL);
    RP_TRY(rp_file_open(o->o, o->force, &out));
    rp_status status = (strcmp(p.kind->ending, ".mp4") ? draw : film)(call->arena, &p, o, out);
    return rp_file_close(o->o, out, status);
}

const cli_command cmd_view = {
    "view",
    "show grains, walls and forces as a picture or an animation",
    "DIR|TABLE [-o FILE] [--frame K] [--color COLUMN] [--stress] [--base] [--cell X] [--window X0,X1,Y0,Y1] "
    "[--width W] [--fps N]\n"
    "SWEEP|TABLE -x COLUMN -y COLUMN [-o FILE] [--width W]",
    "DIR is the folder of `repose run -o`, for a scene or one run of a sweep, or of `repose pile -o`. The "
    "frames of an experiment are the ends of its phases. TABLE is one of its tables of grains, or any table "
    "with columns x, y and r.\n"
    "\n"
    "The width and darkness of a line between two centres show the normal force; attraction is orange. A "
    "fixed grain has a dark core. Gravity is not drawn, because no table contains it. Lengths and forces "
    "have the units of the tables. All frames of an animation share one scale: the widest line stands for a "
    "force that a quarter of the frames exceed. gnuplot draws the pictures; an .mp4 file also needs ffmpeg.\n"
    "\n"
    "SWEEP is the folder of `repose sweep make`. Its points are drawn, a mean with its standard error.",
    "repose view out -o pile.png --color contacts",
    view_params,
    .refuses = "A window without a screen: use -o. --frame all with a picture: use -o NAME.gif.\n"
               "A table without columns x, y and r.",
    .act = act_view};
