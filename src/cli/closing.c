/* The closing line of a run; see closing.h. */
#include "cli/closing.h"

#include <limits.h>
#include <math.h>

#include "core/elementary.h"
#include "params/units.h"
#include "table/table.h"

/* The grains, mean diameter, weight times diameter, extent in x and least y. */
typedef struct {
    size_t n;
    dem_state *grain;
    double d, weight, x[2], bottom;
} pile;

static rp_status measure(rp_arena *arena, const dem_sim *sim, pile *s)
{
    double gravity[2], m = 0.0;
    *s = (pile){.n = dem_count(sim), .x = {INFINITY, -INFINITY}, .bottom = INFINITY};
    s->grain = rp_arena_memory(arena, s->n, sizeof *s->grain);
    RP_TRY(dem_states(sim, s->grain));
    for (const dem_state *p = s->grain; p < s->grain + s->n; p++) {
        s->d += 2.0 * p->r / (double)s->n;
        m += p->m / (double)s->n;
        s->x[0] = fmin(s->x[0], p->x - p->r), s->x[1] = fmax(s->x[1], p->x + p->r);
        s->bottom = fmin(s->bottom, p->y - p->r);
    }
    dem_gravity(sim, gravity);
    s->weight = m * rp_hypot(gravity[0], gravity[1]);
    return RP_OK;
}

static long gap_of(const cli_rest *rest)
{
    const long gap = rest->steps / DEM_REST_LOOKS;
    return gap < DEM_REST_STEPS ? gap : DEM_REST_STEPS;
}

long cli_rest_next(const cli_rest *rest, long step)
{
    const long gap = gap_of(rest), left = rest->steps - step, looks = gap > 0 ? (left - 1) / gap : 0;
    return left - (looks < DEM_REST_LOOKS ? looks : DEM_REST_LOOKS - 1) * gap;
}

/* Without gravity only without any energy and force. */
rp_status cli_rest_look(rp_arena *arena, const dem_sim *sim, cli_rest *rest)
{
    const long gap = gap_of(rest), left = rest->steps - dem_step(sim);
    const rp_mark mark = rp_arena_mark(arena);
    dem_rest now;
    pile s;
    if (gap == 0 || left % gap != 0 || left / gap >= DEM_REST_LOOKS) return RP_OK;
    RP_TRY(measure(arena, sim, &s));
    RP_TRY(dem_rest_state(sim, -INFINITY, INFINITY, &now));
    const bool passed =
        s.n > 0 && dem_at_rest(&now, DEM_REST_ENERGY * s.weight * s.d, DEM_REST_FORCE * s.weight, true);
    rest->passed = passed ? rest->passed + 1 : 0;
    rp_arena_release(arena, mark);
    return RP_OK;
}

enum { SAMPLES = 64, LEAST_STEPS = 100 * SAMPLES };
static const double MOST_GROWTH = 0.02; /* of the largest sum of kinetic and elastic energy */

cli_growth cli_growth_of(const dem_scene *scene, const dem_sim *sim)
{
    bool driven =
        scene->steps < LEAST_STEPS || scene->def.turn_per_step != 0.0 || scene->def.box_turn_per_step != 0.0;
    for (size_t w = 0; w < scene->def.n_walls; w++) {
        const dem_wall *wall = &dem_walls_of(&scene->def)[w];
        driven |= wall->open_at_step >= 0 || dem_wall_moves(wall);
    }
    return (cli_growth){.every = driven ? 0 : scene->steps / SAMPLES, .grains = dem_count(sim)};
}

long cli_growth_next(const cli_growth *g, long step)
{
    return g->every > 0 ? g->every - step % g->every : LONG_MAX;
}

void cli_growth_look(cli_growth *g, const dem_sim *sim)
{
    dem_energy e;
    if (g->every == 0 || dem_step(sim) % g->every != 0) return;
    dem_energies(sim, &e);
    const double free = e.kinetic + e.elastic + e.rotational;
    g->scale = fmax(g->scale, free);
    if (g->n < SAMPLES / 4) g->first += free + e.gravity;
    if (g->n >= SAMPLES - SAMPLES / 4 && g->n < SAMPLES) g->last += free + e.gravity;
    g->n++;
}

void cli_growth_report(const cli_growth *g, const dem_sim *sim, FILE *states)
{
    const double grown = (g->last - g->first) / (SAMPLES / 4) / g->scale;
    char text[160];
    if (g->n < SAMPLES || dem_count(sim) != g->grains || !(grown > MOST_GROWTH)) return;
    snprintf(text, sizeof text,
             "energy grew by %.2g %% of its largest kinetic and elastic part; dt is too large for so little "
             "damping",
             100.0 * grown);
    rp_table_note(states, "warning", "%s", text);
    fprintf(stderr, "repose run: warning: %s\n", text);
}

void cli_tell_threads(const dem_sim *sim, const char *command, long threads)
{
    if (threads > 1 && !dem_threads_serve(sim))
        fprintf(stderr,
                "repose %s: -j %ld has no use here: one thread works. Threads serve velocity Verlet without "
                "hard collisions and ledger, from some 16000 grains on; there are %zu\n",
                command, threads, dem_count(sim));
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

rp_status cli_slope_of(rp_arena *arena, const dem_sim *sim, cli_slope *slope)
{
    pile s;
    double gravity[2];
    RP_TRY(measure(arena, sim, &s));
    *slope = (cli_slope){{NAN, NAN, NAN, NAN}, {s.x[0], s.x[1]}};
    dem_gravity(sim, gravity);
    if (!(gravity[0] == 0.0 && gravity[1] < 0.0)) return RP_OK;
    find_pile(sim, slope->x);
    double *x = rp_arena_memory(arena, 2 * s.n, sizeof *x), *y = x + s.n;
    for (size_t i = 0; i < s.n; i++) x[i] = s.grain[i].x, y[i] = s.grain[i].y - s.bottom;
    return ang_one_sided(s.n, x, y, slope->x, s.d, &slope->theta_r);
}

void cli_close_line(const char *directory)
{
    fputs(*directory ? "; tables in " : "; states on standard output", stderr);
    for (const char *c = directory; *c; c++) fputc(*c == '\n' || *c == '\r' ? ' ' : *c, stderr);
    fputc('\n', stderr);
}

/* " cm" or another unit of the scene; numbers in units of the grains have none. */
static const char *unit_text(rp_units units, const char *cgs, char text[32])
{
    const bool named = units != RP_SIGMA;
    snprintf(text, 32, "%s%s", named ? " " : "", named ? rp_unit(units, cgs) : "");
    return text;
}

void cli_close_run(rp_arena *arena, const dem_sim *sim, const cli_rest *looks, const char *directory)
{
    const bool rest = looks->passed == DEM_REST_LOOKS;
    char unit[32];
    cli_slope slope;
    if (cli_slope_of(arena, sim, &slope)) return;
    fprintf(stderr, "repose run: %zu grains, %ld steps, t = %.5g%s; %s", dem_count(sim), dem_step(sim),
            dem_time(sim), unit_text(dem_units(sim), "s", unit), rest ? "at rest" : "not at rest");
    if (rest && !isnan(slope.theta_r.theta)) {
        static const double deg = M_PI / 180.0;
        /* walls give way by parts of a grain: three digits of the length, and no minus of a zero */
        const double digit = pow(10.0, floor(log10(slope.x[1] - slope.x[0])) - 2.0);
        fprintf(stderr, "; theta_R = %.1f degrees, standard error %.1f, over x = %.6g to %.6g%s (method 3)",
                slope.theta_r.theta / deg, slope.theta_r.theta_se / deg,
                digit * round(slope.x[0] / digit) + 0.0, digit * round(slope.x[1] / digit) + 0.0,
                unit_text(dem_units(sim), "cm", unit));
    }
    cli_close_line(directory);
}
