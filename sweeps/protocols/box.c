/* The box that protocols share; see box.h. */
#include "sweeps/protocols/box.h"

#include <math.h>
#include <stdlib.h>
#include <xxhash.h>

#include "core/file.h"

double sweep_degrees(double radians)
{
    return radians * (180.0 / M_PI);
}

double sweep_touch_height(size_t n, const dem_state grains[], double x, double r, double gap)
{
    double y = r + gap;
    for (size_t i = 0; i < n; i++) {
        const double dx = grains[i].x - x, reach = r + grains[i].r + gap;
        if (fabs(dx) < reach) y = fmax(y, grains[i].y + sqrt(reach * reach - dx * dx));
    }
    return y;
}

void sweep_states_digits(size_t n, const dem_state states[], char digits[33])
{
    XXH3_state_t *hash = XXH3_createState();
    XXH3_128bits_reset(hash);
    for (const dem_state *s = states; s < states + n; s++)
        XXH3_128bits_update(hash, (double[]){s->x, s->y, s->vx, s->vy}, 4 * sizeof(double));
    rp_hash_digits(XXH3_128bits_digest(hash), digits);
    XXH3_freeState(hash);
}

void sweep_box_scene(const sweep_box *b, dem_scene *scene)
{
    dem_definition def = dem_definition_default();
    def.gravity[1] = -b->g;
    dem_physics_apply(&b->physics, &def);
    dem_material given = dem_material_auto;
    given.k_n = b->k_n_wall;
    given.mu = b->mu_wall;
    const dem_material wall = dem_wall_material(&given, &def.material);
    dem_box_walls(&def, b->W, &wall);
    def.walls[DEM_BOX_FLOOR].material.mu = b->mu_floor < 0.0 ? b->physics.mu : b->mu_floor;
    def.walls[DEM_BOX_RIGHT].open_speed = b->open;
    if (isfinite(b->open)) def.walls[DEM_BOX_RIGHT].extent[0] = 0.0;
    def.x_max = b->floor == SWEEP_FLOOR_ABSORBS ? b->W : 3.0 * b->W;
    if (b->floor == SWEEP_FLOOR_ENDS) {
        def.walls[DEM_BOX_FLOOR].extent[1] = b->W;
        def.y_min = -4.0 * b->radius_mean;
    }
    if (b->floor_grains) def.walls[DEM_BOX_FLOOR].point[1] = -2.0 * b->radius_mean;
    *scene = (dem_scene){.def = def};
}

size_t sweep_box_floor(const sweep_box *b, dem_grain *grains)
{
    if (!b->floor_grains) return 0;
    const double r = b->radius_mean, reach = b->floor == SWEEP_FLOOR_EXTENDS ? 3.0 * b->W : b->W;
    const size_t n = (size_t)lround(reach / (2.0 * r));
    for (size_t i = 0; grains && i < n; i++)
        grains[i] = (dem_grain){.x = (2.0 * (double)i + 1.0) * r,
                                .y = -r,
                                .r = r,
                                .m = dem_mass(b->physics.shape, b->physics.density, r),
                                .fixed = true};
    return n;
}

double sweep_box_step_limit(const sweep_box *b, double drop, const char **what)
{
    dem_scene scene;
    sweep_box_scene(b, &scene);
    const double m = dem_mass(b->physics.shape, b->physics.density,
                              b->radius_width > 0.0 ? b->radius_min : b->radius_mean);
    dem_grain two[2] = {{.r = b->radius_min, .m = m}, {.y = drop, .r = b->radius_min, .m = m}};
    scene.def.grains = two;
    scene.def.n_grains = 2;
    return dem_time_step_limit(&scene.def, what);
}

rp_status sweep_box_check(const sweep_box *b, double drop)
{
    dem_scene scene;
    sweep_box_scene(b, &scene);
    RP_TRY(dem_radius_check(b->radius_mean, b->radius_min, b->radius_max));
    RP_TRY(dem_physics_check(&scene.def));
    if (!(b->physics.k_n > 0.0))
        return rp_fail(RP_BAD_INPUT, "k_n = 0: a box holds its grains; allowed: (0, inf)");
    if (b->W < 10.0 * b->radius_mean)
        return rp_fail(RP_BAD_INPUT, "W = %g: at least five grain diameters (%g) expected", b->W,
                       10.0 * b->radius_mean);
    if (b->floor_grains && b->mu_floor >= 0.0)
        return rp_fail(RP_BAD_INPUT, "mu_floor = %g: a floor of grains has their friction mu = %g",
                       b->mu_floor, b->physics.mu);
    const char *what;
    const double limit = sweep_box_step_limit(b, drop, &what);
    if (b->physics.dt > limit)
        return rp_fail(RP_BAD_INPUT, "dt = %g: too large for %s, the limit is %.3g", b->physics.dt, what,
                       limit);
    return RP_OK;
}

rp_status sweep_box_begin(sweep_box_run *run, const sweep_box *box, size_t most, const sweep_tables *tables,
                          sweep_result *result)
{
    sweep_result_clear(result);
    *run = (sweep_box_run){.box = box,
                           .tables = tables && tables->directory ? tables : NULL,
                           .keep = tables ? tables->keep : NULL,
                           .result = result,
                           .d = 2.0 * box->radius_mean,
                           .cells = NAN,
                           .most = most};
    sweep_box_scene(box, &run->scene);
    run->mg = dem_mass(box->physics.shape, box->physics.density, box->radius_mean) * box->g;
    run->states = malloc(most * sizeof *run->states);
    run->work = malloc(3 * most * sizeof *run->work);
    run->x = calloc(2 * (most + 1), sizeof *run->x);
    if (!run->states || !run->work || !run->x) return rp_fail(RP_NO_MEMORY, "run: out of memory");
    run->y = run->x + most + 1;
    SWEEP_ENTER(run->keep, *result);
    SWEEP_ENTER(run->keep, run->cells);
    sweep_keep_enter_sim(run->keep, &run->sim);
    sweep_keep_enter_sim(run->keep, &run->rested);
    SWEEP_ENTER(run->keep, run->steps_before);
    SWEEP_ENTER(run->keep, run->scene.def.walls[DEM_BOX_RIGHT].open_at_step);
    if (!run->tables) return run->keep ? run->keep->source.status : RP_OK;
    run->scene.def.ledger = tables->ledger;
    RP_TRY(rp_make_directory(tables->directory));
    RP_TRY(sweep_table_open(tables, "energy.tsv", &run->energy));
    dem_write_energy_columns(tables->ledger, run->energy.out);
    sweep_keep_enter_file(run->keep, run->energy.out);
    return run->keep ? run->keep->source.status : RP_OK;
}

rp_status sweep_box_end(sweep_box_run *run, rp_status status)
{
    dem_free(run->sim);
    dem_free(run->rested);
    free(run->scene.grains);
    free(run->states);
    free(run->work);
    free(run->x);
    /* a status word was given: physics without a result, which is an answer */
    if (status == RP_NO_RESULT) status = RP_OK;
    return run->energy.out ? sweep_table_close(&run->energy, status) : status;
}

rp_status sweep_box_start(sweep_box_run *run)
{
    rp_status status = dem_scene_start(&run->scene, &run->sim);
    return status == RP_NO_RESULT ? sweep_conclude(run->result, "no_room", "%s", rp_message()) : status;
}

rp_status sweep_box_advance(sweep_box_run *run, long steps)
{
    const long every = run->tables ? run->tables->every : 0,
               most = run->keep ? 1 + 1000000 / ((long)dem_count(run->sim) + 1) : steps;
    rp_status status = RP_OK;
    SWEEP_ENTER(run->keep, steps);
    while (steps > 0 && !status) {
        long part = steps < most ? steps : most;
        long to_next = every > 0 ? every - dem_step(run->sim) % every : steps;
        if (to_next < part) part = to_next;
        status = dem_run(run->sim, part);
        if (status == RP_BROKEN)
            status = sweep_conclude(run->result, dem_fault_text(dem_sim_fault(run->sim)), "%s", rp_message());
        steps -= part;
        if (!status && every > 0 && dem_step(run->sim) % every == 0)
            dem_write_energy(run->sim, run->energy.out);
        if (!status) status = sweep_keep_look(run->keep);
    }
    sweep_keep_leave(run->keep, 1);
    return status;
}

rp_status sweep_box_rest(const sweep_box_run *run, dem_rest *rest, bool *quiet)
{
    rp_status status = dem_rest_state(run->sim, 0.0, run->box->W, rest);
    *quiet = !status && dem_at_rest(rest, run->box->rest_energy * run->mg * run->d,
                                    run->box->rest_force * run->mg, false);
    return status;
}

rp_status sweep_box_settle(sweep_box_run *run, const char *phase, bool pile)
{
    const long every = DEM_REST_STEPS;
    long steps = 0, passed = 0;
    rp_status status = RP_OK;
    SWEEP_ENTER(run->keep, steps);
    SWEEP_ENTER(run->keep, passed);
    for (; passed < DEM_REST_LOOKS && !status; steps += every) {
        if (steps >= run->max_steps) {
            status = sweep_conclude(run->result, "not_at_rest", "%s: not at rest after %ld further steps",
                                    phase, steps);
            break;
        }
        dem_rest rest;
        bool quiet = false;
        ang_slope slopes[ANG_N_METHODS];
        status = sweep_box_advance(run, every);
        if (!status) status = sweep_box_rest(run, &rest, &quiet);
        if (!status && pile) status = sweep_box_slopes(run, slopes);
        passed = quiet ? passed + 1 : 0;
    }
    sweep_keep_leave(run->keep, 2);
    return status;
}

rp_status sweep_box_open(sweep_box_run *run, long steps)
{
    const long least = 5000;
    bool fallen = false;
    rp_status status = RP_OK;
    if (SWEEP_ENTER(run->keep, fallen)) {
        dem_wall_open(run->sim, DEM_BOX_RIGHT, run->box->open);
        run->scene.def.walls[DEM_BOX_RIGHT].open_at_step = dem_step(run->sim) + 1;
    }
    if (!fallen) status = sweep_box_advance(run, steps < 1 ? least : steps);
    fallen = true;
    if (!status && steps < 1) status = sweep_box_settle(run, "after the opening", true);
    sweep_keep_leave(run->keep, 1);
    return status;
}

rp_status sweep_box_phase(sweep_box_run *run, size_t phase)
{
    if (phase == 0) return sweep_box_start(run);
    if (phase == 1) return sweep_box_advance(run, run->box->fill_steps);
    return phase == 2 ? sweep_box_settle(run, "filling", false) : sweep_box_open(run, 0);
}

ang_options sweep_box_options(const sweep_box *b)
{
    return (ang_options){2.0 * b->radius_mean, (ang_height)b->height, (ang_empty)b->empty,
                         (ang_parabola)b->parabola};
}

rp_status sweep_box_surface(sweep_box_run *run, const ang_options *options, ang_surface *surface)
{
    const size_t n_all = dem_count(run->sim);
    double *x = run->work, *y = x + n_all, *r = y + n_all;
    *surface = (ang_surface){0};
    RP_TRY(dem_states(run->sim, run->states));
    size_t n = 0;
    for (size_t i = 0; i < n_all; i++) {
        if (run->states[i].fixed) continue;
        x[n] = run->states[i].x;
        y[n] = run->states[i].y;
        r[n++] = run->states[i].r;
    }
    rp_status status = ang_surface_make(n, x, y, r, run->box->W, options, surface);
    run->cells = (double)surface->n_occupied;
    return status == RP_NO_RESULT ? sweep_conclude(run->result, "no_pile", "%s", rp_message()) : status;
}

rp_status sweep_box_slopes(sweep_box_run *run, ang_slope slopes[ANG_N_METHODS])
{
    const ang_options options = sweep_box_options(run->box);
    ang_surface s;
    rp_status status = sweep_box_surface(run, &options, &s);
    if (!status) status = ang_slopes(s.n, s.column, s.h, s.cell, options.parabola, slopes);
    ang_surface_free(&s);
    return status;
}

rp_status sweep_box_pile_slopes(sweep_box_run *run, ang_slope slopes[ANG_N_METHODS])
{
    if (run->scene.def.walls[DEM_BOX_FLOOR].material.mu != 0.0 || run->box->floor_grains)
        return sweep_box_slopes(run, slopes);
    return sweep_conclude(run->result, "no_pile", "a floor without friction, and no wall on the right");
}

rp_status sweep_box_line(const ang_surface *s, size_t from, size_t n, double *theta_deg)
{
    ang_slope slopes[ANG_N_METHODS];
    if (n < 3) return RP_OK;
    RP_TRY(ang_slopes(n, s->column + from, s->h + from, s->cell, ANG_PARABOLA_FREE, slopes));
    *theta_deg = sweep_degrees(slopes[1].theta);
    return RP_OK;
}

static long count_grains(const sweep_box *box)
{
    const double r = box->radius_mean;
    return box->N > 0 ? box->N : lround(box->W * box->H / (4.0 * r * r));
}

rp_status sweep_box_check_fill(const sweep_box *box)
{
    RP_TRY(sweep_box_check(box, 2.0 * box->H));
    if (count_grains(box) < 1)
        return rp_fail(RP_BAD_INPUT, "W = %g, H = %g: no room for one grain of radius_mean = %g", box->W,
                       box->H, box->radius_mean);
    return RP_OK;
}

rp_status sweep_box_begin_filled(sweep_box_run *run, const sweep_box *b, unsigned long seed,
                                 unsigned long stream, const sweep_tables *tables, sweep_result *result)
{
    const size_t most = (size_t)count_grains(b) + sweep_box_floor(b, NULL);
    rp_status status = sweep_box_begin(run, b, most, tables, result);
    run->scene.has_fill = true;
    run->scene.fill = (dem_fill){.N = count_grains(b),
                                 .W = b->W,
                                 .H = 2.0 * b->H,
                                 .radius_mean = b->radius_mean,
                                 .radius_width = b->radius_width,
                                 .radius_min = b->radius_min,
                                 .radius_max = b->radius_max,
                                 .density = b->physics.density,
                                 .shape = b->physics.shape,
                                 .seed = (long)seed,
                                 .run = (long)stream};
    const double rows = b->H / (20.0 * run->d);
    const double gamma_n = run->scene.def.material.gamma_n; /* negative: by restitution */
    const double patience =
        4e5 * (gamma_n < 0.0 ? 1.0 : fmax(1.0, 500.0 / fmax(gamma_n, 1.0))) * fmax(1.0, rows * rows);
    run->max_steps = b->max_steps > 0 ? b->max_steps : lround(fmin(patience, 2e9));
    if (status) return status;
    SWEEP_ENTER(run->keep, run->n_noted);
    sweep_keep_enter(run->keep, run->x, 2 * (most + 1) * sizeof *run->x);
    return RP_OK;
}

rp_status sweep_box_note(sweep_box_run *run)
{
    run->n_noted = 0;
    for (size_t id = 0; id <= run->most; id++) run->x[id] = NAN;
    RP_TRY(dem_states(run->sim, run->states));
    for (size_t i = 0; i < dem_count(run->sim); i++) {
        const dem_state *s = &run->states[i];
        if (!(s->x > 0.0 && s->x < run->box->W) || s->fixed) continue;
        run->x[s->id] = s->x;
        run->y[s->id] = s->y;
        run->n_noted++;
    }
    return RP_OK;
}

rp_status sweep_box_moved(sweep_box_run *run, double reach, int contacts, size_t *moved)
{
    size_t seen = 0;
    *moved = 0;
    RP_TRY(dem_states(run->sim, run->states));
    for (size_t i = 0; i < dem_count(run->sim); i++) {
        const dem_state *s = &run->states[i];
        if (isnan(run->x[s->id])) continue;
        seen++;
        double x = s->x, y = s->y;
        dem_box_frame(run->sim, &x, &y);
        double dx = x - run->x[s->id], dy = y - run->y[s->id];
        *moved += dx * dx + dy * dy > reach * reach && s->contacts >= contacts;
    }
    *moved += run->n_noted - seen;
    return RP_OK;
}

void sweep_box_go_back(sweep_box_run *run)
{
    if (!run->rested) return;
    run->steps_before += dem_step(run->sim) - dem_step(run->rested);
    dem_free(run->sim);
    run->sim = run->rested;
    run->rested = NULL;
}

double sweep_box_steps(const sweep_box_run *run)
{
    return run->sim ? (double)(dem_step(run->sim) + run->steps_before) : NAN;
}

rp_status sweep_box_onset(sweep_box_run *run, bool *moves)
{
    size_t moved;
    rp_status status = sweep_box_moved(run, 0.1 * run->d, 0, &moved);
    *moves = !status && (double)moved >= 0.05 * (double)run->n_noted;
    return status;
}

rp_status sweep_box_tilt(sweep_box_run *run, bool box, double rate_deg, double *displacement_deg,
                         double *energy_deg)
{
    const double sway_deg = 0.5, most_deg = 60.0;
    const long every = (long)fmin(10.0, 0.01 / rate_deg);
    struct {
        double turned, sway;
        bool moves, is_fast;
    } now = {.is_fast = !energy_deg};
    rp_status status = RP_OK;
    if (SWEEP_ENTER(run->keep, now))
        (box ? dem_box_turn : dem_gravity_turn)(run->sim, rate_deg * (M_PI / 180.0));
    while (!(now.moves && now.is_fast) && now.turned < most_deg && !status) {
        bool onset = false;
        dem_rest rest;
        status = sweep_box_advance(run, every);
        now.turned += (double)every * rate_deg;
        if (!status) status = sweep_box_onset(run, &onset);
        if (!status) status = dem_rest_state(run->sim, 0.0, run->box->W, &rest);
        if (status) break;
        if (now.turned <= sway_deg) now.sway = fmax(now.sway, rest.kinetic_energy);
        if (!now.moves && onset) *displacement_deg = now.turned;
        now.moves = now.moves || onset;
        if (now.is_fast || now.turned <= sway_deg || !(rest.kinetic_energy > 10.0 * now.sway) ||
            !(rest.kinetic_energy > 1e-5 * run->mg * run->d))
            continue;
        *energy_deg = now.turned;
        now.is_fast = true;
    }
    sweep_keep_leave(run->keep, 1);
    return status;
}
