/* What a person sees of a run; see watch.h. */
#include "cli/watch.h"

#include <math.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "angle/angle.h"
#include "cli/cli.h"
#include "core/clock.h"
#include "params/units.h"

/* ---- the end of a run ---- */

/* Mean diameter, weight times diameter, extent in x and least y. */
typedef struct {
    double d, weight, x[2], bottom;
} size_of_pile;

static size_of_pile measure(const dem_sim *sim, const dem_state *states)
{
    double gravity[2], m = 0.0;
    const double n = (double)dem_count(sim);
    size_of_pile s = {.x = {INFINITY, -INFINITY}, .bottom = INFINITY};
    for (const dem_state *p = states; p < states + dem_count(sim); p++) {
        s.d += 2.0 * p->r / n;
        m += p->m / n;
        s.x[0] = fmin(s.x[0], p->x - p->r), s.x[1] = fmax(s.x[1], p->x + p->r);
        s.bottom = fmin(s.bottom, p->y - p->r);
    }
    dem_gravity(sim, gravity);
    s.weight = m * hypot(gravity[0], gravity[1]);
    return s;
}

static rp_status read_states(rp_arena *arena, const dem_sim *sim, dem_state **states)
{
    *states = rp_arena_memory(arena, dem_count(sim), sizeof **states);
    return dem_states(sim, *states);
}

rp_status cli_at_rest(rp_arena *arena, const dem_sim *sim, bool *at_rest)
{
    static const double ENERGY = 1e-7, FORCE = 1e-2; /* m g d and m g, as the boxes of sweeps have them */
    dem_state *states;
    dem_rest rest;
    RP_TRY(read_states(arena, sim, &states));
    RP_TRY(dem_rest_state(sim, -INFINITY, INFINITY, &rest));
    const size_of_pile s = measure(sim, states);
    *at_rest = dem_at_rest(&rest, ENERGY * s.weight * s.d, FORCE * s.weight, true);
    return RP_OK;
}

/* Grains left of a right wall that has opened, or right of a left one: the pile that stays. */
static void find_pile(const dem_sim *sim, double x[2])
{
    for (size_t k = 0; k < dem_wall_count(sim); k++) {
        const dem_wall_state w = dem_wall_now(sim, k);
        if (!w.open || fabs(w.direction[0]) < 0.99) continue;
        if (w.direction[0] < 0.0)
            x[1] = fmin(x[1], w.point[0]);
        else
            x[0] = fmax(x[0], w.point[0]);
    }
}

/* Slopes over this range of x, with the mean diameter as the cell, seen from the left or the right. */
static rp_status slopes_of(rp_arena *arena, size_t n, const dem_state *states, const size_of_pile *s,
                           bool mirrored, ang_slope slopes[ANG_N_METHODS])
{
    double *x = rp_arena_memory(arena, 2 * n, sizeof *x), *y = x + n;
    ang_options options = ANG_OPTIONS_DEFAULT;
    ang_surface surface = {0};
    for (size_t i = 0; i < n; i++) {
        x[i] = mirrored ? s->x[1] - states[i].x : states[i].x - s->x[0];
        y[i] = states[i].y - s->bottom;
    }
    options.diameter = s->d;
    rp_status status = ang_surface_make(n, x, y, NULL, s->x[1] - s->x[0], &options, &surface);
    if (!status)
        status = ang_slopes(surface.n, surface.column, surface.h, surface.cell, options.parabola, slopes);
    if (!status && 2 * surface.n_occupied < surface.n_cells) status = RP_NO_RESULT;
    ang_surface_free(&surface);
    return status;
}

rp_status cli_slope_of(rp_arena *arena, const dem_sim *sim, cli_slope *slope)
{
    static const double CLEAR = 3.0; /* standard errors */
    double gravity[2];
    dem_state *states;
    *slope = (cli_slope){NAN, NAN, {NAN, NAN}};
    dem_gravity(sim, gravity);
    if (!(gravity[0] == 0.0 && gravity[1] < 0.0) || dem_count(sim) == 0) return RP_OK;
    RP_TRY(read_states(arena, sim, &states));
    size_of_pile s = measure(sim, states);
    rp_status status = RP_OK;
    find_pile(sim, s.x);
    for (int mirrored = 0; mirrored < 2 && !status && s.x[0] < s.x[1]; mirrored++) {
        ang_slope slopes[ANG_N_METHODS];
        status = slopes_of(arena, dem_count(sim), states, &s, mirrored, slopes);
        bool clear = !status;
        for (int k = 0; k < ANG_N_METHODS && clear; k++) clear = slopes[k].slope > CLEAR * slopes[k].slope_se;
        if (clear) *slope = (cli_slope){slopes[2].theta / deg, slopes[2].theta_se / deg, {s.x[0], s.x[1]}};
    }
    return status == RP_NO_MEMORY ? status : RP_OK; /* too few cells: no slope */
}

/* ---- plots ---- */

enum { MOST_SAMPLES = 1000 };

rp_status cli_plot_open(rp_arena *arena, cli_plot *plot)
{
    static char *const arguments[] = {"gnuplot", NULL};
    *plot = (cli_plot){.text = !cli_has_screen(), .every = 1};
    RP_TRY(cli_gnuplot_open(&plot->gnuplot, arguments, "gnuplot-nox", stderr));
    plot->sample = rp_arena_memory(arena, MOST_SAMPLES, sizeof *plot->sample);
    plot->open = true;
    struct winsize size = {.ws_col = 80, .ws_row = 32};
    if (isatty(STDERR_FILENO)) ioctl(STDERR_FILENO, TIOCGWINSZ, &size);
    fprintf(plot->gnuplot.in,
            "if (%d || GPVAL_TERM eq 'unknown') set terminal dumb noenhanced %d %d\nset grid\nset key "
            "outside top horizontal\n",
            plot->text, size.ws_col > 40 ? size.ws_col : 80, size.ws_row > 20 ? size.ws_row - 1 : 31);
    return RP_OK;
}

/* Every second sample goes when there are too many. */
static void add_sample(cli_plot *p, const dem_sim *sim)
{
    dem_energy e;
    if (p->taken++ % p->every != 0) return;
    if (p->n == MOST_SAMPLES) {
        for (size_t k = 0; k < MOST_SAMPLES / 2; k++)
            for (int c = 0; c < 3; c++) p->sample[k][c] = p->sample[2 * k][c];
        p->n /= 2;
        p->every *= 2;
    }
    dem_energies(sim, &e);
    double *s = p->sample[p->n++];
    s[0] = dem_time(sim), s[1] = e.kinetic + e.rotational, s[2] = e.elastic;
}

/* Highest point of the grains in cells of a mean diameter. */
static void put_surface(rp_arena *arena, const dem_sim *sim, FILE *out)
{
    enum { MOST_CELLS = 1000 };
    dem_state *states;
    const size_t n = dem_count(sim);
    const rp_mark mark = rp_arena_mark(arena);
    double top[MOST_CELLS + 1];
    if (n == 0 || read_states(arena, sim, &states)) return;
    const size_of_pile s = measure(sim, states);
    const size_t cells = (size_t)fmin(ceil((s.x[1] - s.x[0]) / s.d), MOST_CELLS);
    for (size_t k = 0; k <= cells; k++) top[k] = -INFINITY;
    for (size_t i = 0; i < n; i++) {
        const size_t k = (size_t)fmin((states[i].x - s.x[0]) / s.d, (double)cells);
        top[k] = fmax(top[k], states[i].y + states[i].r);
    }
    for (size_t k = 0; k <= cells; k++)
        if (isfinite(top[k])) fprintf(out, "%.9g %.9g\n", s.x[0] + ((double)k + 0.5) * s.d, top[k]);
    rp_arena_release(arena, mark);
}

void cli_plot_show(rp_arena *arena, cli_plot *p, const dem_sim *sim, const char *title, bool last)
{
    FILE *out = p->gnuplot.in;
    if (!p->open || ferror(out)) return;
    add_sample(p, sim);
    if (!last && rp_clock() < p->next) return;
    p->next = rp_clock() + (p->text && !isatty(STDERR_FILENO) ? 60.0 : 1.0);
    fputs("$energy << end\n", out);
    for (size_t k = 0; k < p->n; k++)
        fprintf(out, "%.9g %.9g %.9g\n", p->sample[k][0], p->sample[k][1], p->sample[k][2]);
    fputs("end\n$surface << end\n", out);
    put_surface(arena, sim, out);
    fprintf(out,
            "end\nset multiplot layout 2,1\nset title \"%s\" noenhanced\nset xlabel 't (%s)' noenhanced\n"
            "set ylabel 'energy (%s)' noenhanced\nplot $energy using 1:2 with lines title 'kinetic energy', "
            "'' using 1:3 with lines title 'elastic'\n"
            "set title 'surface'\nset xlabel 'x (%s)' noenhanced\nset ylabel 'y (%s)' noenhanced\n"
            "plot $surface with linespoints notitle\nunset multiplot\n",
            title, rp_unit("s"), rp_unit("erg"), rp_unit("cm"), rp_unit("cm"));
    fflush(out);
}

void cli_plot_close(cli_plot *p)
{
    if (p->open) (void)!cli_gnuplot_close(&p->gnuplot);
    p->open = false;
}
