/* repose stress field, repose stress base: stress in piles and on their base, from tables of contacts. */
#include <string.h>

#include "core/elementary.h"
#include "angle/angle.h"
#include "stress/stress.h"
#include "table/where.h"
#include "cli/derive/derive.h"

#define BOX_OPTIONS(X)                                                                                       \
    X(REAL, width, "cm", NULL, "(0, inf)", "width W of the box, from x = 0")                                 \
    X(REAL, cell, "cm", "0.4", "(0, inf)", "width of a bin; round(W/cell) bins reach from 0 to W")           \
    CLI_WHERE(X)

/* ---- piles out of their tables ---- */

/* One step's rows of a table of a run's folder, or of PREFIX_..., one file of which names it too. */
static rp_status read_block(cli_call *call, const char *prefix, bool contacts, const rp_texts *where,
                            const char *names, double **block, size_t *rows)
{
    rp_arena *arena = call->arena;
    const char *path, *end = strstr(prefix, "_contacts.tsv"); /* as a shell's * finds it */
    rp_table *table;
    if (rp_is_in(prefix, "contacts.tsv"))
        RP_TRY(rp_path(arena, &path, "%s/%s.tsv", prefix, contacts ? "contacts" : "states"));
    else
        RP_TRY(rp_path(arena, &path, "%.*s_%s.tsv", (int)(end ? end - prefix : (long)strlen(prefix)), prefix,
                       contacts ? "contacts" : "grains"));
    RP_TRY(rp_table_load(arena, path, &table));
    call->units = rp_table_units(table);
    for (size_t i = 0; i < where->n; i++) RP_TRY(rp_table_where(table, where->items[i]));
    RP_TRY(rp_table_one_step(table));
    *rows = table->n_rows;
    return rp_columns_read(arena, table, names, block);
}

static const double NEAR = 1e-6; /* over the distance of a grain from a wall */

/* Mark the contacts with the floor: wall number `asked`, or, for auto, walls at the one height at which walls
 * lie level below a grain. block: columns id_b and wall. */
static rp_status find_floor(const char *prefix, const double *block, long asked, stress_pile *p)
{
    double y = NAN;
    size_t marked = 0;
    for (size_t k = 0; k < p->n; k++) {
        const stress_contact *c = &p->contacts[k];
        const double near = NEAR * (c->y - c->y_b);
        if (block[k] != 0.0 || !(fabs(c->x - c->x_b) <= near)) continue;
        if (asked < 1 && fabs(c->y_b - y) > near)
            return rp_fail(RP_BAD_INPUT,
                           "%s: walls carry grains at y = %g and %g: name the floor with --floor", prefix, y,
                           c->y_b);
        y = c->y_b;
    }
    for (size_t k = 0; k < p->n; k++) {
        const stress_contact *c = &p->contacts[k];
        const bool there = fabs(c->y_b - y) <= NEAR * rp_hypot(c->x - c->x_b, c->y - c->y_b);
        marked += p->floor[k] = block[k] == 0.0 && (asked < 1 ? there : block[p->n + k] == (double)asked);
    }
    if (marked) return RP_OK;
    if (asked > 0)
        return rp_fail(RP_BAD_INPUT, "%s: --floor = %ld: no grain touches this wall", prefix, asked);
    return rp_fail(RP_BAD_INPUT, "%s: no contact with a level floor: name its wall with --floor", prefix);
}

/* Where heights count from: the floor's lowest point; without one y = 0, or what contacts reach below. */
static double ground_of(const stress_pile *p, bool floor)
{
    double ground = floor ? INFINITY : 0.0, size = 0.0;
    for (size_t k = 0; k < p->n; k++) {
        const stress_contact *c = &p->contacts[k];
        size = fmax(size, rp_hypot(c->x - c->x_b, c->y - c->y_b));
        if (!floor || p->floor[k]) ground = fmin(ground, fmin(c->y, c->y_b));
    }
    return fabs(ground) <= NEAR * size ? 0.0 : ground;
}

/* *floor as --floor has it; NULL: not needed. */
static rp_status pile_read(cli_call *call, const char *prefix, const rp_texts *where, const long *floor,
                           stress_pile *p)
{
    rp_arena *arena = call->arena;
    double *block;
    RP_TRY(read_block(call, prefix, true, where, "id_b,wall,x,y,x_b,y_b,normal_force,shear_force", &block,
                      &p->n));
    RP_TRY(read_block(call, prefix, false, where, "x,y,m", &p->x, &p->n_grains));
    p->y = p->x + p->n_grains; /* columns of one block */
    p->m = p->y + p->n_grains;
    p->contacts = rp_arena_memory(arena, p->n, sizeof *p->contacts);
    p->floor = rp_arena_memory(arena, p->n, sizeof *p->floor);
    p->wall = rp_arena_memory(arena, p->n, sizeof *p->wall);
    for (size_t k = 0; k < p->n; k++) {
        const double *v = block + k;
        const size_t n = p->n;
        const double lx = v[2 * n] - v[4 * n], ly = v[3 * n] - v[5 * n], l = rp_hypot(lx, ly);
        const double fn = v[6 * n], fs = v[7 * n];
        p->wall[k] = v[0] == 0.0;
        if (!(l > 0.0)) return rp_fail(RP_BAD_INPUT, "%s: contact %zu has no branch", prefix, k + 1);
        /* normal from b to a; shear along the normal turned clockwise */
        p->contacts[k] = (stress_contact){
            v[2 * n], v[3 * n], v[4 * n], v[5 * n], (fn * lx + fs * ly) / l, (fn * ly - fs * lx) / l};
    }
    if (floor) RP_TRY(find_floor(prefix, block, *floor, p));
    p->ground = ground_of(p, floor != NULL);
    return RP_OK;
}

/* The number of cells is finite: a grain that flew off is left out of the table first. */
static rp_status check_size(const stress_pile *p, const char *prefix, double width, double cell)
{
    enum { MOST = 100000 };
    if (!(width <= MOST * cell))
        return rp_fail(RP_BAD_INPUT, "width = %g: more than %d bins of %g", width, MOST, cell);
    for (size_t i = 0; i < p->n_grains; i++)
        if (!(fmax(fabs(p->x[i]), fabs(p->y[i])) <= MOST * cell))
            return rp_fail(RP_BAD_INPUT, "%s: grain %zu at (%g, %g): more than %d bins of %g away", prefix,
                           i + 1, p->x[i], p->y[i], MOST, cell);
    return RP_OK;
}

/* The piles of all arguments, and the header of a table of them. */
static rp_status read_piles(cli_call *call, double width, const double *cell, const rp_texts *where,
                            const long *floor, size_t *n, stress_pile **piles)
{
    *n = 0;
    while (cli_argument(call, (int)*n)) ++*n;
    *piles = rp_arena_memory(call->arena, *n, sizeof **piles);
    for (size_t i = 0; i < *n; i++) {
        RP_TRY(pile_read(call, cli_argument(call, (int)i), where, floor, &(*piles)[i]));
        /* the units of the table are those of defaults too */
        for (const rp_param *p = call->options; i == 0 && p->name; p++)
            if (!call->given[p - call->options]) rp_params_default(p, call->units, call->values);
        RP_TRY(check_size(&(*piles)[i], cli_argument(call, (int)i), width, *cell));
    }
    cli_table(call, call->out);
    rp_table_note(call->out, "piles", "%zu", *n);
    return RP_OK;
}

/* ---- field ---- */

CLI_OPTIONS(field, BOX_OPTIONS)

static rp_status print_field(cli_call *call, const void *values)
{
    const field_options *o = values;
    stress_pile *piles;
    size_t n;
    RP_TRY(read_piles(call, o->width, &o->cell, &o->where, NULL, &n, &piles));
    const stress_grid g = stress_grid_over(n, piles, o->width, o->cell);
    const size_t cells = g.nx * g.ny;
    stress_tensor *mean = rp_arena_memory(call->arena, cells, sizeof *mean);
    RP_TRY(stress_mean_cells(n, piles, &g, mean));
    if (g.y0 != 0.0) rp_table_note_number(call->out, "ground", g.y0, "cm");
    rp_table_header(call->out, call->units,
                    "x/W, y/W, sxx [dyn/cm], sxy [dyn/cm], syx [dyn/cm], syy [dyn/cm], p [dyn/cm], shear "
                    "[dyn/cm], couple [dyn/cm], direction [rad], mobilised_deg [deg]");
    for (size_t k = 0; k < cells; k++) {
        const stress_tensor *s = &mean[k];
        const stress_circle m = stress_mohr(s);
        CLI_ROW(((double)(k % g.nx) + 0.5) * g.dx / o->width, ((double)(k / g.nx) + 0.5) * g.dy / o->width,
                s->xx, s->xy, s->yx, s->yy, m.pressure, m.shear, m.couple, m.direction, m.mobilised / deg);
    }
    return RP_OK;
}

const cli_command cmd_stress_field = {
    "stress field",
    "stress in bins of piles, from their contacts",
    "DIR|PREFIX... --width W [options]",
    "Stress in square bins, averaged over piles. Each pile is a folder DIR with contacts.tsv and states.tsv, "
    "or a pair of tables PREFIX_contacts.tsv and PREFIX_grains.tsv. In s_ab the force is along a and the "
    "branch along b; compression is positive, and bins without grains have 0. y is measured from 0, or from "
    "the lowest contact below it (`ground`). p is the mean pressure, shear the radius of Mohr's circle, "
    "couple (xy - yx)/2, direction that of the largest compression, and mobilised the angle of friction that "
    "is mobilised.",
    "repose stress field pile --width 4",
    field_params,
    .refuses = "Tables of several steps: choose one with --where step=N.\n"
               "More than 100000 bins, or a grain so many bins away: leave it out of the table, or give a "
               "larger --cell.\n"
               "A contact whose two ends are one point.",
    .derives = true,
    .act = print_field};

/* ---- base ---- */

#define BASE_OPTIONS(X)                                                                                      \
    BOX_OPTIONS(X)                                                                                           \
    X(INT, floor, "", "auto", "[1, 1000000] | auto", "number of the wall that is the floor; auto: as above") \
    X(REAL, diameter, "cm", "0.2", "(0, inf)", "nominal diameter of a grain, for the slope")                 \
    X(REAL, g, "cm/s^2", "981.0", "(0, inf)", "gravity")                                                     \
    X(REAL, phi_deg, "deg", "60", "(0, 90)", "inclination of the rays of theory")

CLI_OPTIONS(base, BASE_OPTIONS)

/* Mean slope by method 3 of the parts in 0 < x < W. */
static rp_status mean_slope(size_t n, const stress_pile piles[], const base_options *o, double *theta)
{
    ang_options how = ANG_OPTIONS_DEFAULT;
    how.diameter = o->diameter;
    *theta = 0.0;
    for (size_t i = 0; i < n; i++) {
        RP_ENDS(ang_surface_free) ang_surface s;
        ang_slope slopes[ANG_N_METHODS];
        for (size_t k = 0; k < piles[i].n_grains; k++) piles[i].y[k] -= piles[i].ground;
        RP_TRY(ang_surface_make(piles[i].n_grains, piles[i].x, piles[i].y, NULL, o->width, &how, &s));
        RP_TRY(ang_slopes(s.n, s.column, s.h, s.cell, how.parabola, slopes));
        *theta += slopes[2].theta / (double)n;
    }
    return RP_OK;
}

static rp_status print_base(cli_call *call, const void *values)
{
    const base_options *o = values;
    double theta, size;
    stress_pile *piles;
    size_t n;
    RP_TRY(read_piles(call, o->width, &o->cell, &o->where, &o->floor, &n, &piles));
    RP_TRY(mean_slope(n, piles, o, &theta));
    const size_t cells = stress_floor_cells(n, piles, o->width, o->cell, &size);
    stress_floor *floor = rp_arena_memory(call->arena, cells, sizeof *floor);
    RP_TRY(stress_floor_forces(n, piles, size, o->g, cells, floor));
    rp_table_note_number(call->out, "theta_r_deg", theta / deg, "");
    if (n == 1) rp_table_note(call->out, "errors", "nan for one pile; at least 2 needed");
    rp_table_header(call->out, call->units,
                    "x/W, N [dyn/cm], N_se [dyn/cm], H [dyn/cm], H_se [dyn/cm], weight [dyn/cm], through "
                    "[dyn/cm], imbalance [dyn/cm], H/N, N_theory [dyn/cm], H_theory [dyn/cm]");
    for (size_t j = 0; j < cells; j++) {
        const stress_floor *f = &floor[j];
        double N, H;
        stress_wedge(f->weight, theta, o->phi_deg * deg, &N, &H);
        CLI_ROW(((double)j + 0.5) * size / o->width, f->n.mean, f->n.se, f->h.mean, f->h.se, f->weight,
                f->through, f->imbalance, f->n.mean > 0.0 ? f->h.mean / f->n.mean : NAN, N, H);
    }
    return RP_OK;
}

const cli_command cmd_stress_base = {
    "stress base",
    "forces of piles on the floor, from their contacts",
    "DIR|PREFIX... --width W [options]",
    "Forces of untilted piles on the floor, in bins, averaged over piles, all per length. Each pile is a "
    "folder DIR with contacts.tsv and states.tsv, or a pair of tables PREFIX_contacts.tsv and "
    "PREFIX_grains.tsv.\n"
    "  N, H                normal force; horizontal force, away from the left wall\n"
    "  weight              of the grains above the bin\n"
    "  through             vertical force through the sides of the column above\n"
    "  imbalance           N - weight - through\n"
    "  N_theory, H_theory  of rays of inclination phi, in a wedge with this weight\n"
    "                      and the mean slope by method 3; nan if this slope is phi\n"
    "                      or more\n"
    "The floor consists of the level walls at the height at which grains touch one.",
    "repose stress base pile --width 4",
    base_params,
    .refuses = "Tables of several steps: choose one with --where step=N.\n"
               "More than 100000 bins, or a grain so many bins away: leave it out of the table, or give a "
               "larger --cell.\n"
               "A contact whose two ends are one point.\n"
               "No level wall below grains, or several at different heights: choose one with --floor.",
    .derives = true,
    .act = print_base};
