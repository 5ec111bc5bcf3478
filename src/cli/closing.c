/* Looks at a run, and its closing line; see closing.h. */
#include "cli/closing.h"

#include "cli/cli.h"

#include <limits.h>
#include <math.h>
#include <unistd.h>

#include "core/clock.h"
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

void cli_tell_threads(const dem_sim *sim, const char *command, long threads)
{
    if (threads > 1 && !dem_threads_serve(sim))
        cli_say("repose %s: -j %ld has no effect: only velocity Verlet is threaded, without rigid-body "
                "impulses (hard) or "
                "energy ledger, from some 16000 grains on; there are %zu",
                command, threads, dem_count(sim));
}

/* ---- looking on ---- */

static long gap_of(const cli_looks *l)
{
    const long gap = l->steps / DEM_REST_LOOKS;
    return gap < DEM_REST_STEPS ? gap : DEM_REST_STEPS;
}

/* Without gravity only without any energy and force. */
static rp_status look_for_rest(cli_looks *l, const dem_sim *sim)
{
    const long gap = gap_of(l), left = l->steps - dem_step(sim);
    const rp_mark mark = rp_arena_mark(l->arena);
    dem_rest now;
    pile s;
    if (gap == 0 || left % gap != 0 || left / gap >= DEM_REST_LOOKS) return RP_OK;
    RP_TRY(measure(l->arena, sim, &s));
    RP_TRY(dem_rest_state(sim, -INFINITY, INFINITY, &now));
    const bool passed =
        s.n > 0 && dem_at_rest(&now, DEM_REST_ENERGY * s.weight * s.d, DEM_REST_FORCE * s.weight, true);
    l->rested = passed ? l->rested + 1 : 0;
    rp_arena_release(l->arena, mark);
    return RP_OK;
}

enum { SAMPLES = 64, LEAST_STEPS = 100 * SAMPLES };
static const double MOST_GROWTH = 0.02; /* of the largest sum of kinetic and elastic energy */

static void look_for_growth(cli_looks *l, const dem_sim *sim)
{
    dem_energy e;
    if (l->energy.every == 0 || dem_step(sim) % l->energy.every != 0) return;
    dem_energies(sim, &e);
    const double free = e.kinetic + e.elastic + e.rotational;
    l->energy.scale = fmax(l->energy.scale, free);
    if (l->energy.n < SAMPLES / 4) l->energy.first += free + e.gravity;
    if (l->energy.n >= SAMPLES - SAMPLES / 4 && l->energy.n < SAMPLES) l->energy.last += free + e.gravity;
    l->energy.n++;
}

void cli_looks_scene(cli_looks *l, const dem_scene *scene, const dem_sim *sim)
{
    bool driven =
        scene->steps < LEAST_STEPS || scene->def.turn_per_step != 0.0 || scene->def.box_turn_per_step != 0.0;
    for (size_t w = 0; w < scene->def.n_walls; w++) {
        const dem_wall *wall = &dem_walls_of(&scene->def)[w];
        driven |= wall->open_at_step >= 0 || dem_wall_moves(wall);
    }
    l->steps = scene->steps;
    l->energy.every = driven ? 0 : scene->steps / SAMPLES, l->energy.grains = dem_count(sim);
}

long cli_looks_next(const void *looks, long step)
{
    const cli_looks *l = looks;
    const long gap = gap_of(l), left = l->steps - step, rest = gap > 0 ? (left - 1) / gap : 0,
               every = l->energy.every,
               next = left - (rest < DEM_REST_LOOKS ? rest : DEM_REST_LOOKS - 1) * gap,
               sample = every > 0 ? every - step % every : LONG_MAX;
    return l->steps == 0 || sample < next ? sample : next;
}

rp_status cli_looks_at(void *looks, const exp_run *run)
{
    cli_looks *l = looks;
    const dem_sim *sim = exp_sim(run);
    char where[256];
    if (!l->begun)
        l->progress =
            cli_progress_start(l->quiet, isatty(STDERR_FILENO), rp_clock(), exp_steps(run), l->steps);
    if (!l->begun && !l->quiet) cli_tell_threads(sim, "run", l->threads);
    l->begun = true;
    if (l->steps == 0)
        cli_progress_tell(&l->progress, rp_clock(),
                          exp_done(run) ? NULL : exp_where(run, where, sizeof where), stderr);
    else
        cli_progress_show(&l->progress, rp_clock(), exp_steps(run), stderr);
    look_for_growth(l, sim);
    return look_for_rest(l, sim);
}

/* Once a run. */
void cli_looks_at_frame(void *looks, const exp_run *run)
{
    cli_looks *l = looks;
    size_t over = 0;
    const size_t n = l->quiet || l->over_friction ? 0 : dem_over_friction(exp_sim(run), &over);
    if (over == 0) return;
    l->over_friction = true;
    cli_say("repose run: warning: t = %.5g: the tangential force of %zu of %zu contacts exceeds mu times the "
            "normal force, because damping = \"outside\" adds the dashpot to this limit; \"inside\" obeys it",
            dem_time(exp_sim(run)), over, n);
}

void cli_looks_keep(rp_snapshot *s, void *looks)
{
    cli_looks *l = looks;
    RP_KEEP(s, l->energy);
    RP_KEEP(s, l->rested);
}

/* ---- the end ---- */

void cli_close_energy(const cli_looks *l, const dem_sim *sim, FILE *states)
{
    const double grown = (l->energy.last - l->energy.first) / (SAMPLES / 4) / l->energy.scale;
    char text[160];
    if (l->energy.n < SAMPLES || dem_count(sim) != l->energy.grains || !(grown > MOST_GROWTH)) return;
    snprintf(text, sizeof text,
             "energy grew by %.2g %% of its largest kinetic and elastic part; dt is too large for so little "
             "damping",
             100.0 * grown);
    rp_table_note(states, "warning", "%s", text);
    cli_say("repose run: warning: %s", text);
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

void cli_close_line(const char *said, const char *directory, const char *printed)
{
    cli_say("repose run: %s; %s%s", said, *directory ? "tables in " : printed,
            *directory ? directory : " on standard output");
}

/* " cm" or another unit of the scene; numbers in units of the grains have none. */
static const char *unit_text(rp_units units, const char *cgs, char text[32])
{
    const bool named = units != RP_SIGMA;
    snprintf(text, 32, "%s%s", named ? " " : "", named ? rp_unit(units, cgs) : "");
    return text;
}

void cli_close_run(const cli_looks *looks, const dem_sim *sim, const char *directory)
{
    const bool rest = looks->rested == DEM_REST_LOOKS;
    char unit[32];
    cli_slope slope;
    if (cli_slope_of(looks->arena, sim, &slope)) return;
    const char *said =
        rp_text(looks->arena, "%zu grains, %ld steps, t = %.5g%s; %s", dem_count(sim), dem_step(sim),
                dem_time(sim), unit_text(dem_units(sim), "s", unit), rest ? "at rest" : "not at rest");
    if (rest && !isnan(slope.theta_r.theta)) {
        /* walls give way by parts of a grain: three digits of the length, and no minus of a zero */
        const double digit = pow(10.0, floor(log10(slope.x[1] - slope.x[0])) - 2.0);
        said = rp_text(looks->arena,
                       "%s; theta_R = %.1f degrees, standard error %.1f, over x = %.6g to %.6g%s (method 3)",
                       said, slope.theta_r.theta / deg, slope.theta_r.theta_se / deg,
                       digit * round(slope.x[0] / digit) + 0.0, digit * round(slope.x[1] / digit) + 0.0,
                       unit_text(dem_units(sim), "cm", unit));
    }
    cli_close_line(said, directory, "states");
}
