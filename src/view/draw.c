/* Pictures of frames as text for gnuplot; see view.h. */
#include <gsl/gsl_sort.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "view/view.h"

/* Force chains are dark on pale grains: line style k of `classes` has a width in proportion to the force.
 * Colours are distinct for the colour-blind, and by their lightness alone. */
enum { PULLS = 20 }; /* above all classes */
static const double LEFT = 1.8, RIGHT = 0.7, COLOUR_BAR = 3.1, TOP = 1.4, BOTTOM = 1.5; /* cm */
static const double LOW = 4.0, ROOM = 0.5, PANEL = 3.2, TALLEST = 14.0, FLATTEST = 1.2, NARROWEST = 11.0,
                    FLATTEST_BAR = 2.2; /* of the bar of colours beside its label */
static const double PER_CM = 37.8;      /* of lines' widths */
static const double LETTER = 0.2;       /* width, cm */
static const char WALL[] = "#404040", PRESS[] = "#0072b2", PULL[] = "#d55e00";

/* Colours of the figures too: gnuplot reads the file that is included here. */
typedef struct {
    const char *grain, *outline;
    int classes, pale[3], dark[3];
} colours;

static colours find_colours(void)
{
    const char *grain, *outline;
    int classes, pale_r, pale_g, pale_b, dark_r, dark_g, dark_b;
#include "figures/chains.gp"
    return (colours){grain, outline, classes, {pale_r, pale_g, pale_b}, {dark_r, dark_g, dark_b}};
}

/* ---- scale ---- */

static void widen(double window[4], double x, double y, double r)
{
    window[0] = fmin(window[0], x - r), window[1] = fmax(window[1], x + r);
    window[2] = fmin(window[2], y - r), window[3] = fmax(window[3], y + r);
}

/* An end of a wall, `side` 0 or 1. */
static void end_of(const view_wall *w, double end, double p[2])
{
    p[0] = w->x + end * w->direction[1];
    p[1] = w->y - end * w->direction[0];
}

/* All grains, and segments of walls as far as half the size of the grains' region around them. */
static double find_window(const view_frame *first, const view_frame *end, double window[4])
{
    double grains[4] = {INFINITY, -INFINITY, INFINITY, -INFINITY}, sum = 0.0;
    size_t n = 0;
    for (const view_frame *f = first; f < end; n += f->n, f++)
        for (size_t i = 0; i < f->n; i++) widen(grains, f->x[i], f->y[i], f->r[i]), sum += f->r[i];
    const double r = sum / (double)n, most = 0.5 * fmax(grains[1] - grains[0], grains[3] - grains[2]);
    memcpy(window, grains, sizeof grains);
    for (const view_frame *f = first; f < end; f++)
        for (const view_wall *w = f->walls; f->n_walls && w < f->walls + f->n_walls; w++)
            for (int k = 0; k < 2; k++) {
                double p[2];
                end_of(w, w->ends[k], p);
                if (w->ends[0] < w->ends[1] && isfinite(w->ends[0] + w->ends[1]))
                    widen(window, p[0], p[1], 0.0);
            }
    for (int k = 0; k < 4; k++)
        window[k] = k % 2 ? fmin(window[k], grains[k] + most) + r : fmax(window[k], grains[k] - most) - r;
    return r;
}

static double largest_force(const view_frame *f)
{
    return f->n_contacts > 0 ? fabs(f->contacts[f->n_contacts - 1].normal) : 0.0;
}

/* Three of four frames stay below: an impact does not hide the forces at rest. */
static double typical(size_t n, double largest[])
{
    gsl_sort(largest, 1, n);
    return largest[3 * (n - 1) / 4] > 0.0 ? largest[3 * (n - 1) / 4] : largest[n - 1];
}

static stress_grid grid_of(const view_scale *s)
{
    return (stress_grid){.x0 = s->start[0],
                         .y0 = s->start[1],
                         .dx = s->cell,
                         .dy = s->cell,
                         .nx = (size_t)ceil((s->window[1] - s->start[0]) / s->cell),
                         .ny = (size_t)ceil((s->window[3] - s->start[1]) / s->cell)};
}

static rp_status stress_of(rp_arena *arena, const view_frame *f, const view_scale *s, stress_tensor **cells)
{
    const stress_grid g = grid_of(s);
    stress_contact *contacts = rp_arena_memory(arena, f->n_contacts, sizeof *contacts);
    *cells = rp_arena_memory(arena, g.nx * g.ny, sizeof **cells);
    for (size_t k = 0; k < f->n_contacts; k++) contacts[k] = f->contacts[k].c;
    return stress_cells(f->n_contacts, contacts, &g, *cells);
}

/* A force is spread over the diameter of a mean grain: how many grains a bin has makes no peak or dip. */
static void add_to_bins(const view_scale *s, size_t n, double pressure[], double x, double force)
{
    const double from = (x - s->radius - s->start[0]) / s->cell, to = (x + s->radius - s->start[0]) / s->cell;
    for (size_t k = (size_t)fmax(from, 0.0); k < n && (double)k < to; k++)
        pressure[k] += force / s->cell * (fmin(to, (double)k + 1.0) - fmax(from, (double)k)) / (to - from);
}

/* Vertical force on the base a unit of length, in bins: of contacts with walls that are no steeper than 45
 * degrees and below the grain. */
static double *pressure_of(rp_arena *arena, const view_frame *f, const view_scale *s, size_t *n)
{
    *n = grid_of(s).nx;
    double *pressure = rp_arena_memory(arena, *n, sizeof *pressure);
    for (const view_contact *v = f->contacts; f->n_contacts && v < f->contacts + f->n_contacts; v++)
        if (v->wall && v->c.y - v->c.y_b >= fabs(v->c.x - v->c.x_b))
            add_to_bins(s, *n, pressure, v->c.x_b, v->c.fy);
    for (size_t k = 0; k < f->n_base; k++) add_to_bins(s, *n, pressure, f->base_x[k], f->base_force[k]);
    return pressure;
}

/* The largest principal stress and pressure of a frame; the range of the values of all. */
static rp_status measure(rp_arena *arena, const view_frame *f, const view_style *style, view_scale *s,
                         double *stress, double *pressure)
{
    const stress_grid g = grid_of(s);
    const rp_mark mark = rp_arena_mark(arena);
    stress_tensor *cells;
    rp_status status = style->stress ? stress_of(arena, f, s, &cells) : RP_OK;
    for (size_t k = 0; style->stress && !status && k < g.nx * g.ny; k++) {
        const stress_circle c = stress_mohr(&cells[k]);
        *stress = fmax(*stress, fabs(c.pressure) + c.shear);
    }
    size_t n = 0;
    const double *bins = style->base ? pressure_of(arena, f, s, &n) : NULL;
    for (size_t k = 0; k < n; k++) *pressure = fmax(*pressure, bins[k]);
    for (size_t i = 0; f->value && i < f->n; i++) {
        s->value[0] = fmin(s->value[0], f->value[i]);
        s->value[1] = fmax(s->value[1], f->value[i]);
    }
    rp_arena_release(arena, mark);
    return status;
}

/* The next of the names of kinds; false: there is none. */
static bool next_kind(const char **names, char name[32])
{
    int length = 0;
    const bool found = sscanf(*names, "%31s%n", name, &length) == 1;
    return *names += length, found;
}

/* What names of kinds need beside the bar, which has room for a number. */
static double beside_bar(const char *kinds)
{
    double most = 0.0;
    for (char name[32]; kinds && next_kind(&kinds, name);) most = fmax(most, (double)strlen(name));
    return LETTER * fmax(most - 5.0, 0.0);
}

/* The picture's size follows from the window's; lengths on paper are those of the plot. */
static void lay_out(const view_scene *scene, const view_style *style, view_scale *s)
{
    const double right = *style->color ? COLOUR_BAR + beside_bar(scene->kinds) : RIGHT,
                 least = *style->color ? FLATTEST_BAR : FLATTEST;
    s->panel = style->base ? PANEL : 0.0;
    double width = style->width - LEFT - right, x = s->window[1] - s->window[0],
           y = s->window[3] - s->window[2];
    if (y * width < least * x) s->window[3] = s->window[2] + (y = least * x / width);
    if (y * width > TALLEST * x) width = fmax(TALLEST * x / y, NARROWEST - LEFT - right);
    s->per_length = fmin(width / x, TALLEST / y);
    s->width = width + LEFT + right, s->right = right;
    s->height = fmin(width * y / x, TALLEST) + TOP + BOTTOM + s->panel;
}

rp_status view_scale_of(rp_arena *arena, const view_scene *scene, size_t first, size_t last,
                        const view_style *style, view_scale *s)
{
    enum { MOST_CELLS = 100000 };
    const view_frame *const from = scene->frames + first, *const end = scene->frames + last + 1;
    *s = (view_scale){.value = {INFINITY, -INFINITY}};
    s->radius = find_window(from, end, s->window);
    s->start[0] = s->window[0] + s->radius, s->start[1] = s->window[2] + s->radius;
    const double extent = s->window[1] - s->radius - s->start[0];
    const double wide = round(extent / (6.0 * s->radius)),
                 narrow = fmin(round(extent / (2.0 * s->radius)), 8.0);
    s->cell = style->cell > 0.0 ? style->cell : extent / fmax(fmax(wide, narrow), 1.0);
    if (!isnan(style->window[0])) memcpy(s->window, style->window, sizeof s->window);
    const double x = s->window[1] - s->window[0], y = s->window[3] - s->window[2];
    if (!isfinite(x * y) || !(x > 0.0 && y > 0.0))
        return rp_fail(RP_BAD_INPUT, "no window holds the grains: x over %g, y over %g", x, y);
    if ((style->stress || style->base) && !(x * y < MOST_CELLS * s->cell * s->cell))
        return rp_fail(RP_BAD_INPUT, "cell = %g: more than %d cells", s->cell, MOST_CELLS);
    lay_out(scene, style, s);
    const size_t n = last - first + 1;
    double *force = rp_arena_memory(arena, 3 * n, sizeof *force), *stress = force + n, *pressure = stress + n;
    for (size_t k = 0; k < n; k++) {
        force[k] = largest_force(from + k);
        RP_TRY(measure(arena, from + k, style, s, &stress[k], &pressure[k]));
    }
    s->force = typical(n, force), s->stress = typical(n, stress), s->pressure = typical(n, pressure);
    if (style->stress && !(s->stress > 0.0))
        return rp_fail(RP_NO_RESULT, "--stress: no table of contacts with forces beside the grains");
    if (style->base && !(s->pressure > 0.0))
        return rp_fail(RP_NO_RESULT, "--base: no contacts that press on a wall below the grains");
    if (*style->color && !(s->value[0] <= s->value[1]))
        return rp_fail(RP_NO_RESULT, "column \"%s\": no number", style->color);
    return RP_OK;
}

/* ---- text ---- */

/* A text as a string of gnuplot in which nothing is a command: in single quotes, those of the text apart, and
 * without control characters. */
static void put_quoted(FILE *out, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void put_quoted(FILE *out, const char *format, ...)
{
    char text[512];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    fputc('\'', out);
    for (const char *c = text; *c; c++) {
        if (*c == '\'')
            fputs("'.\"'\".'", out);
        else
            fputc((unsigned char)*c < ' ' ? ' ' : *c, out);
    }
    fputc('\'', out);
}

/* " cm", or nothing for a number without a unit. */
static const char *unit_after(const char *unit, char text[100])
{
    snprintf(text, 100, "%s%s", strcmp(unit, "1") ? " " : "", strcmp(unit, "1") ? unit : "");
    return text;
}

/* The power of ten that an axis is labelled in: numbers of many digits have no room. */
static int power_of(double largest)
{
    const double power = floor(log10(largest));
    return power < -1.0 || power > 2.0 ? (int)power : 0;
}

static int power_of_window(const view_scale *s)
{
    double largest = 0.0;
    for (int k = 0; k < 4; k++) largest = fmax(largest, fabs(s->window[k]));
    return power_of(largest);
}

/* Of stress and pressure, in two dimensions. */
static const char *force_a_length(const view_scene *scene, char text[80])
{
    const bool known = strcmp(scene->force, "1") != 0 && strcmp(scene->length, "1") != 0;
    snprintf(text, 80, "%s%s%s", known ? scene->force : "1", known ? "/" : "", known ? scene->length : "");
    return text;
}

static void put_label(FILE *out, const char *set, const char *name, const char *unit, int power)
{
    char ten[16] = "", unused[100];
    if (power) snprintf(ten, sizeof ten, "1e%d", power);
    const char *in = unit_after(unit, unused);
    fprintf(out, "set %s ", set);
    if (*ten || *in)
        put_quoted(out, "%s (%s%s)", name, ten, in + !*ten);
    else
        put_quoted(out, "%s", name);
    fputs(" noenhanced\n", out);
}

/* The least of 1, 2, 5, 10, ... that is not below x > 0. */
static double round_step(double x)
{
    const double ten = pow(10.0, floor(log10(x)));
    return ten * (x <= ten ? 1.0 : x <= 2.0 * ten ? 2.0 : x <= 5.0 * ten ? 5.0 : 10.0);
}

/* Marks of an axis from lo to hi, whose numbers are over this power of ten. */
static void put_marks(FILE *out, const char *axis, double lo, double hi, double step, int power)
{
    const double first = ceil(lo / step), n = fmin(floor(hi / step) - first, 50.0);
    fprintf(out, "set %stics (", axis);
    for (int k = 0; k <= n; k++)
        fprintf(out, "%s'%.7g' %.17g", k ? ", " : "", (first + k) * (step / pow(10.0, power)),
                (first + k) * step);
    fputs(")\n", out);
}

static double thickest(const view_scale *s)
{
    return fmin(fmax(0.9 * s->radius * s->per_length * PER_CM, 2.0), 5.0);
}

static void put_chains(const view_style *style, const view_scale *s, FILE *out)
{
    const colours look = find_colours();
    for (int k = 1; k <= look.classes; k++) {
        const double f = (double)(k - 1) / (look.classes - 1), lw = thickest(s) * (k - 0.5) / look.classes;
        char rgb[8];
        int c[3];
        for (int i = 0; i < 3; i++)
            c[i] = *style->color   ? 0
                   : style->stress ? 185
                                   : (int)lround(look.pale[i] + f * (look.dark[i] - look.pale[i]));
        snprintf(rgb, sizeof rgb, "#%02x%02x%02x", c[0], c[1], c[2]);
        fprintf(out, "set style arrow %d nohead lw %.3g lc rgb '%s'\n", k, lw, rgb);
        fprintf(out, "set style arrow %d nohead lw %.3g lc rgb '%s'\n", PULLS + k, lw, PULL);
    }
    fprintf(out, "set style arrow 50 nohead lw %.3g lc rgb '%s'\n", fmax(0.4 * thickest(s), 1.0), PRESS);
    fprintf(out, "set style arrow 51 nohead lw %.3g lc rgb '%s'\n", fmax(0.4 * thickest(s), 1.0), PULL);
}

/* Numbers of both signs have white in the middle. */
static void put_palette(const view_scene *scene, const view_style *style, const view_scale *s, FILE *out)
{
    double lo = s->value[0], hi = s->value[1];
    if (lo < 0.0 && hi > 0.0) {
        fputs("set palette defined (0 '#2b7bba', 1 '#f7f7f7', 2 '#e66101')\n", out);
        hi = fmax(hi, -lo), lo = -hi;
    } else {
        fputs("set palette defined (0 '#fff7bc', 1 '#fe9929', 2 '#cc4c02')\n", out);
    }
    if (!(hi > lo)) lo -= fmax(fabs(lo), 1.0) * 0.5, hi += fmax(fabs(hi), 1.0) * 0.5;
    const int power = power_of(fmax(fabs(lo), fabs(hi)));
    const double height = s->height - TOP - BOTTOM - s->panel,
                 step = round_step((hi - lo) * fmax(0.4 / height, 0.1));
    put_label(out, "cblabel offset 1", style->color, scene->quantity, power); /* past one digit */
    fprintf(out, "set cbrange [%.17g:%.17g]\nset cbtics scale 0.5\n", lo, hi);
    if (power || height < LOW) put_marks(out, "cb", lo, hi, step, power);
}

/* Kinds have a colour each, and their names beside it; white are grains without one. */
static void put_kinds(const char *kinds, const view_scale *s, FILE *out)
{
    static const char *const hues[] = {"#ffffff", "#56b4e9", "#e69f00", "#009e73", "#f0e442",
                                       "#cc79a7", "#0072b2", "#d55e00", "#999999"};
    enum { MOST = sizeof hues / sizeof *hues - 1 };
    const int first = s->value[0] > 0.0;
    int n = first;
    char name[32];
    fputs("set termoption noenhanced\nset cbtics scale 0 (", out);
    if (!first) fputs("'none' 0", out);
    for (n = 0; next_kind(&kinds, name);) {
        fputs(n++ || !first ? ", " : "", out);
        put_quoted(out, "%s", name);
        fprintf(out, " %d", n);
    }
    fputs(")\nset palette defined (", out);
    for (int k = first; k <= n; k++)
        for (int end = 0; end < 2; end++)
            fprintf(out, "%s%g '%s'", k > first || end ? ", " : "", k + end - 0.5,
                    hues[k ? (k - 1) % MOST + 1 : 0]);
    fprintf(out, ")\nset cbrange [%g:%g]\nset cblabel 'kind' offset 1\n", first - 0.5, n + 0.5);
}

void view_draw_start(const view_scene *scene, const view_style *style, const view_scale *s, FILE *out)
{
    fprintf(out,
            "set border lw 0.7\nset tics scale 0.6 nomirror out\nset grid lw 0.3 lc rgb '#d8d8d8'\n"
            "set xrange [%.17g:%.17g]\nset style fill solid border lc rgb '%s'\n"
            "set lmargin at screen %.5f\nset rmargin at screen %.5f\n",
            s->window[0], s->window[1], find_colours().outline, LEFT / s->width, 1.0 - s->right / s->width);
    const int power = power_of_window(s);
    put_label(out, "xlabel", "x", scene->length, power);
    if (power)
        put_marks(out, "x", s->window[0], s->window[1], round_step((s->window[1] - s->window[0]) / 8.0),
                  power);
    put_chains(style, s, out);
    if (scene->kinds)
        put_kinds(scene->kinds, s, out);
    else if (*style->color)
        put_palette(scene, style, s, out);
}

static void put_contacts(const view_frame *f, const view_scale *s, FILE *out)
{
    const int classes = find_colours().classes;
    fputs("$contacts << end\n", out);
    for (const view_contact *v = f->contacts; f->n_contacts && v < f->contacts + f->n_contacts; v++) {
        const int k = (int)fmin(ceil(classes * fabs(v->normal) / s->force), classes);
        if (k > 0)
            fprintf(out, "%.9g %.9g %.9g %.9g %d\n", v->c.x, v->c.y, v->c.x_b - v->c.x, v->c.y_b - v->c.y,
                    v->normal < 0.0 ? PULLS + k : k);
    }
    fputs("end\n", out);
}

/* Part of a wall within the window, in lengths along it; false without. */
static bool clip(const view_wall *w, const double window[4], double ends[2])
{
    const double p[2] = {w->x, w->y}, along[2] = {w->direction[1], -w->direction[0]};
    ends[0] = w->ends[0], ends[1] = w->ends[1];
    for (int axis = 0; axis < 2; axis++) {
        double a = window[2 * axis] - p[axis], b = window[2 * axis + 1] - p[axis];
        if (fabs(along[axis]) < 1e-12) {
            if (a > 0.0 || b < 0.0) return false;
            continue;
        }
        a /= along[axis], b /= along[axis];
        ends[0] = fmax(ends[0], fmin(a, b)), ends[1] = fmin(ends[1], fmax(a, b));
    }
    return ends[0] < ends[1];
}

/* False: there is none in the window. */
static bool put_walls(const view_frame *f, const view_scale *s, FILE *out)
{
    bool any = false;
    fputs("$walls << end\n", out);
    for (const view_wall *w = f->walls; f->n_walls && w < f->walls + f->n_walls; w++) {
        double ends[2], a[2], b[2];
        if (!clip(w, s->window, ends)) continue;
        end_of(w, ends[0], a);
        end_of(w, ends[1], b);
        fprintf(out, "%.9g %.9g %.9g %.9g\n", a[0], a[1], b[0] - a[0], b[1] - a[1]);
        any = true;
    }
    fputs("end\n", out);
    return any;
}

/* A share of what is in a cell, and its places times that. */
typedef struct {
    double sum, x, y;
} weighted;

/* Of the contacts' forces along their branches, which lie in the pile; a cell's middle may not. */
static weighted *places_of(rp_arena *arena, const view_frame *f, const stress_grid *g)
{
    enum { PARTS = 8 };
    weighted *cells = rp_arena_memory(arena, g->nx * g->ny, sizeof *cells);
    for (const view_contact *v = f->contacts; f->n_contacts && v < f->contacts + f->n_contacts; v++)
        for (int k = 0; k < PARTS; k++) {
            const stress_contact *c = &v->c;
            const double part = (k + 0.5) / PARTS, x = c->x + part * (c->x_b - c->x),
                         y = c->y + part * (c->y_b - c->y), i = floor((x - g->x0) / g->dx),
                         j = floor((y - g->y0) / g->dy),
                         weight = hypot(c->fx, c->fy) * hypot(c->x_b - c->x, c->y_b - c->y);
            if (!(i >= 0.0 && j >= 0.0 && i < (double)g->nx && j < (double)g->ny)) continue;
            weighted *cell = &cells[(size_t)j * g->nx + (size_t)i];
            cell->sum += weight, cell->x += weight * x, cell->y += weight * y;
        }
    return cells;
}

/* Both principal stresses of each cell as a cross, at the mean place of the forces there. */
static rp_status put_stress(rp_arena *arena, const view_frame *f, const view_scale *s, FILE *out)
{
    const stress_grid g = grid_of(s);
    stress_tensor *cells;
    rp_status status = stress_of(arena, f, s, &cells);
    const weighted *places = places_of(arena, f, &g);
    fputs("$stress << end\n", out);
    for (size_t k = 0; !status && k < g.nx * g.ny; k++) {
        const stress_circle c = stress_mohr(&cells[k]);
        const double x = places[k].x / places[k].sum, y = places[k].y / places[k].sum;
        for (int minor = 0; minor < 2; minor++) {
            const double p = c.pressure + (minor ? -c.shear : c.shear),
                         angle = c.direction + (minor ? M_PI_2 : 0.0), l = 0.9 * g.dx * fabs(p) / s->stress,
                         dx = l * cos(angle), dy = l * sin(angle);
            if (p != 0.0 && places[k].sum > 0.0)
                fprintf(out, "%.9g %.9g %.9g %.9g %d\n", x - 0.5 * dx, y - 0.5 * dy, dx, dy,
                        p < 0.0 ? 51 : 50);
        }
    }
    fputs("end\n", out);
    return status;
}

static void put_panel(rp_arena *arena, const view_scene *scene, const view_frame *f, const view_scale *s,
                      FILE *out)
{
    char unit[80];
    const int power = power_of(s->pressure);
    const double top = 1.08 * s->pressure, step = round_step(s->pressure / 4.0);
    size_t n;
    const double *pressure = pressure_of(arena, f, s, &n);
    fputs("$base << end\n", out);
    for (size_t k = 0; k < n; k++)
        fprintf(out, "%.9g %.9g\n", s->start[0] + ((double)k + 0.5) * s->cell, pressure[k]);
    fprintf(out,
            "end\nunset label\nunset arrow 1\nunset colorbox\nset size noratio\nset tmargin at screen %.5f\n"
            "set bmargin at screen %.5f\nset yrange [0:%.17g]\nset ytics %g\n",
            (BOTTOM + PANEL - 1.3) / s->height, BOTTOM / s->height, top, step);
    if (power) put_marks(out, "y", 0.0, top, step, power);
    put_label(out, "ylabel", "pressure", force_a_length(scene, unit), power);
    put_label(out, "xlabel", "x", scene->length, power_of_window(s));
    fprintf(out,
            "set boxwidth %.17g\nplot $base using 1:2 with boxes fc rgb '#9ecae1' notitle\n"
            "unset multiplot\n",
            s->cell);
}

/* What the picture shows, above it. */
static void put_title(const view_scene *scene, const view_frame *f, const view_scale *s, FILE *out)
{
    char step[32] = "", t[128] = "", unit[100];
    if (!isnan(f->step)) snprintf(step, sizeof step, "step %.0f, ", f->step);
    if (!isnan(f->t)) snprintf(t, sizeof t, "t = %.5g%s, ", f->t, unit_after(scene->time, unit));
    fputs("set label 1 ", out);
    put_quoted(out, "%s%s%zu grains", step, t, f->n);
    fprintf(out, " noenhanced at graph 0, screen %.5f left\n", 1.0 - 0.5 / s->height);
}

/* A line, and what it stands for: from the left on, so that it is in pictures of any width. */
static void put_keys(const view_scene *scene, const view_frame *f, const view_style *style,
                     const view_scale *s, FILE *out)
{
    char unit[80], after[100];
    /* as long as the arms of the largest cross, or a part or a multiple of that */
    const double arm = 0.9 * s->cell * s->per_length,
                 length = style->stress ? fmin(fmax(arm, 0.4), 1.6) : 0.8;
    const double x = (LEFT + length + 0.2) / s->width, y = 1.0 - (TOP - 0.3) / s->height;
    fputs("unset label 2\nunset arrow 1\n", out);
    if (!style->stress && !(f->n_contacts > 0 && s->force > 0.0)) return;
    fprintf(out, "set arrow 1 from screen %.5f, %.5f to screen %.5f, %.5f as %d\nset label 2 ",
            LEFT / s->width, y, (LEFT + length) / s->width, y, style->stress ? 50 : find_colours().classes);
    if (style->stress)
        put_quoted(out, "principal stress %.4g%s", s->stress * length / arm,
                   unit_after(force_a_length(scene, unit), after));
    else
        put_quoted(out, "normal force %s%.4g%s", largest_force(f) > s->force ? "at least " : "", s->force,
                   unit_after(scene->force, after));
    fprintf(out, " noenhanced at screen %.5f, screen %.5f left\n", x, y);
}

/* The radius of a point of size 1 in an svg picture: three eighths of the height of its letters. */
static const double POINT = 0.375 * VIEW_LETTERS; /* pixels */

static void put_circles(const view_style *style, const view_scale *s, bool any_fixed, FILE *out)
{
    char fill[32];
    snprintf(fill, sizeof fill, *style->color ? "palette" : "rgb '%s'", find_colours().grain);
    const double size = s->per_length * PER_CM / POINT, line = 0.25 / POINT;
    if (style->points)
        fprintf(out,
                "plot $grains using 1:2:($3*%.9g + %g) with points pt 7 ps variable lc rgb '%s' notitle, \\\n"
                " $grains using 1:2:($3*%.9g - %g)%s with points pt 7 ps variable lc %s notitle",
                size, line, find_colours().outline, size, line, *style->color ? ":4" : "", fill);
    else
        fprintf(out, "plot $grains using 1:2:3%s with circles lw 0.4 fc %s notitle",
                *style->color ? ":4" : "", fill);
    if (any_fixed) /* a core */
        fprintf(out, ", \\\n $grains using 1:2:($3*$5) with circles fc rgb '%s' fs solid noborder notitle",
                WALL);
}

rp_status view_draw(rp_arena *arena, const view_scene *scene, const view_frame *f, const view_style *style,
                    const view_scale *s, FILE *out)
{
    const rp_mark mark = rp_arena_mark(arena);
    const bool chains = f->n_contacts > 0 && s->force > 0.0;
    rp_status status = RP_OK;
    fputs("$grains << end\n", out);
    bool any_fixed = false;
    for (size_t i = 0; i < f->n; i++) {
        const bool fixed = f->fixed && f->fixed[i] > 0.0;
        any_fixed |= fixed;
        fprintf(out, "%.9g %.9g %.9g %.9g%s\n", f->x[i], f->y[i], f->r[i], f->value ? f->value[i] : 0.0,
                fixed ? " 0.4" : "");
    }
    fputs("end\n", out);
    if (chains) put_contacts(f, s, out);
    const bool walls = put_walls(f, s, out);
    if (style->stress) status = put_stress(arena, f, s, out);
    put_title(scene, f, s, out);
    put_keys(scene, f, style, s, out);
    if (style->base) fputs("set multiplot\nunset xlabel\n", out);
    const int power = power_of_window(s);
    const double height = (s->window[3] - s->window[2]) * s->per_length;
    if (power)
        put_marks(out, "y", s->window[2], s->window[3], round_step(fmax(ROOM, 0.1 * height) / s->per_length),
                  power);
    else if (height < LOW) /* with room between the numbers */
        fprintf(out, "set ytics %g\n", round_step(ROOM / s->per_length));
    else
        fputs("set ytics autofreq\n", out);
    fprintf(out,
            "set size ratio -1\nset yrange [%.17g:%.17g]\nset tmargin at screen %.5f\n"
            "set bmargin at screen %.5f\n",
            s->window[2], s->window[3], 1.0 - TOP / s->height, (BOTTOM + s->panel) / s->height);
    if (*style->color) /* as far from the plot, and as wide, in pictures of all sizes */
        fprintf(out, "set colorbox user origin %.5f, %.5f size %.5f, %.5f\n",
                1.0 - (s->right - 0.4) / s->width, (BOTTOM + s->panel) / s->height, 0.5 / s->width,
                1.0 - (TOP + BOTTOM + s->panel) / s->height);
    put_label(out, "ylabel", "y", scene->length, power);
    put_circles(style, s, any_fixed, out);
    if (chains) fputs(", \\\n $contacts using 1:2:3:4:5 with vectors arrowstyle variable notitle", out);
    if (walls) fprintf(out, ", \\\n $walls with vectors nohead lw 2.5 lc rgb '%s' notitle", WALL);
    if (style->stress) fputs(", \\\n $stress using 1:2:3:4:5 with vectors arrowstyle variable notitle", out);
    fputc('\n', out);
    if (style->base) put_panel(arena, scene, f, s, out);
    rp_arena_release(arena, mark);
    return ferror(out) ? rp_fail(RP_IO, "gnuplot ended early") : status;
}
