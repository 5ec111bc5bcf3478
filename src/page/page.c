/* What a page calls: an experiment from its text, the same with phases more, what is seen. The page writes
 * down what is done as phases of the text, which `repose run` repeats to the same digest. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "angle/angle.h"
#include "experiment/experiment.h"
#include "table/columns.h"

#define EXPORT(name) __attribute__((export_name(#name))) name

/* A text with its run. */
typedef struct {
    dem_text text;
    exp_plan *plan;
    exp_run *run;
} experiment;
static experiment *now;
static char *words;

/* What is read at once; the page has the same list. Angles in degrees; NaN: none. */
static struct {
    double step, t, grains, links, walls, done, energy, at_rest, tilt, gravity[2], mu, mu_roll, k_n, weight,
        dt, d;
    double theta[ANG_N_METHODS], error[ANG_N_METHODS], flank[2][ANG_N_METHODS];
    double columns, picture; /* of the surface, whose heights are the last of the picture; its address */
} number;
static const double degree = 180.0 / M_PI;

static void forget(experiment *e)
{
    if (!e) return;
    exp_run_free(e->run);
    exp_free(e->plan);
    dem_text_close(&e->text);
    free(e);
}

static rp_status read_text(const char *bytes, const rp_texts *changes, experiment **made)
{
    experiment *e = *made = calloc(1, sizeof *e);
    if (!e) return rp_fail(RP_NO_MEMORY, "text: out of memory");
    RP_TRY(dem_text_open("text", bytes, changes, &e->text));
    if (!exp_has_phases(&e->text))
        return rp_fail(RP_BAD_INPUT, "text: no phases: give it some instead of `steps`, as "
                                     "phases = ( { name = \"fall\"; until = \"rest\"; } )");
    RP_TRY(exp_read(&e->text, &e->plan));
    return exp_check(e->plan);
}

/* The next experiment instead of the last, unless it failed. The calls return a message then, else NULL. */
static const char *replace(rp_status status, experiment *next)
{
    if (!status && !exp_sim(next->run)) status = rp_fail(RP_NO_RESULT, "%s", exp_ended(next->run)->message);
    forget(status ? next : now);
    if (!status) now = next;
    return status ? rp_message() : NULL;
}

/* Room for texts that are handed over. */
char *EXPORT(page_room)(int size)
{
    static char *room;
    return room = realloc(room, (size_t)size);
}

/* Begin with a text, and changes of it as --set has them, a line each. */
const char *EXPORT(page_start)(const char *bytes, char *changes)
{
    rp_texts texts = {0};
    experiment *next;
    for (char *at = strtok(changes, "\n"); at && texts.n < 32; at = strtok(NULL, "\n"))
        texts.items[texts.n++] = at;
    rp_status status = read_text(bytes, &texts, &next);
    const dem_scene *scene = status ? NULL : exp_scene(next->plan);
    if (!status)
        status = exp_start(next->plan, (unsigned long)scene->seed, (unsigned long)scene->run, &next->run);
    return replace(status, next);
}

/* Go on with a text whose phases but the last n have passed, by one step. After an error all is as before. */
const char *EXPORT(page_go_on)(const char *bytes, int n)
{
    experiment *next;
    const long before = exp_steps(now->run);
    rp_status status = read_text(bytes, &(rp_texts){0}, &next);
    if (!status)
        status =
            exp_start_at(next->plan, exp_phase_count(next->plan) - (size_t)n, exp_sim(now->run), &next->run);
    while (!status && !exp_done(next->run) && exp_steps(next->run) == before)
        status = exp_advance(next->run, 1);
    if (!status && exp_done(next->run)) status = rp_fail(RP_NO_RESULT, "%s", exp_ended(next->run)->message);
    return replace(status, next);
}

/* The text as it was given, with its changes. */
const char *EXPORT(page_text)(void)
{
    const dem_scene *scene = exp_scene(now->plan);
    size_t size;
    free(words);
    FILE *out = open_memstream(&words, &size);
    dem_text_write(&now->text, (unsigned long)scene->seed, (unsigned long)scene->run, out);
    fclose(out);
    return words;
}

/* How the run is, then a line for each phase: name, passes, step of its end, whether within another one. */
const char *EXPORT(page_phases)(void)
{
    char where[256];
    size_t size;
    free(words);
    FILE *out = open_memstream(&words, &size);
    fprintf(out, "%s", exp_where(now->run, where, sizeof where));
    for (size_t k = 0; k < exp_phase_count(now->plan); k++) {
        const exp_passed p = exp_phase_at(now->run, k);
        fprintf(out, "\n%s\t%ld\t%ld\t%d", p.name, p.passes, p.step, p.inner);
    }
    fclose(out);
    return words;
}

/* Bits of all grains, as `repose run` prints them. */
const char *EXPORT(page_digest)(void)
{
    static char digest[17];
    uint64_t bits = 0;
    dem_digest(exp_sim(now->run), &bits);
    snprintf(digest, sizeof digest, "%016" PRIx64, bits);
    return digest;
}

/* Go on by so many steps, or to the end. */
const char *EXPORT(page_run)(int steps)
{
    const long end = exp_steps(now->run) + steps;
    rp_status status = RP_OK;
    while (!status && !exp_done(now->run) && exp_steps(now->run) < end)
        status = exp_advance(now->run, end - exp_steps(now->run));
    if (!status && exp_done(now->run) && !rp_is_result(exp_ended(now->run)->status))
        status = rp_fail(RP_NO_RESULT, "%s: %s", exp_ended(now->run)->status, exp_ended(now->run)->message);
    return status ? rp_message() : NULL;
}

static float *put(float *to, int n, const double v[])
{
    for (int k = 0; k < n; k++) *to++ = (float)v[k];
    return to;
}

/* theta_R of a surface that falls to the right between two ends, and the heights of its columns. */
static void read_one_side(size_t n, const double x[], const double y[], double width, float *picture_end)
{
    ang_surface s = {0};
    ang_slope slopes[ANG_N_METHODS];
    rp_status status = ang_surface_make(n, x, y, NULL, width, &ANG_OPTIONS_DEFAULT, &s);
    if (!status) status = ang_slopes(s.n, s.column, s.h, s.cell, ANG_PARABOLA_FREE, slopes);
    for (int m = 0; m < ANG_N_METHODS && !status; m++)
        number.theta[m] = slopes[m].theta * degree, number.error[m] = slopes[m].theta_se * degree;
    if (!status) number.columns = (double)s.n, put(picture_end, (int)s.n, s.h);
    ang_surface_free(&s);
}

/* The same of both flanks of a heap. */
static void read_flanks(size_t n, const double x[], const double y[])
{
    ang_pile pile;
    if (ang_pile_find(n, x, y, (double[]){-INFINITY, INFINITY}, &pile)) return;
    for (int m = 0; m < ANG_N_METHODS; m++) {
        number.theta[m] = pile.mean[m].theta * degree, number.error[m] = pile.mean[m].theta_se * degree;
        for (size_t k = 0; k < pile.n_flanks; k++) number.flank[k][m] = pile.flank[k][m].theta * degree;
    }
}

/* Forces are over the mean weight; without gravity over the mean force of a contact. */
static void read_numbers(const dem_sim *sim, size_t n, const dem_state *s, size_t n_links,
                         const dem_contact *c)
{
    const dem_definition *def = &exp_scene(now->plan)->def;
    double down[2];
    dem_rest rest = {0};
    memset(&number, 0, sizeof number);
    number.step = (double)exp_steps(now->run), number.t = dem_time(sim), number.grains = (double)n;
    number.done = exp_done(now->run) + (dem_sim_fault(sim) != DEM_FAULT_NONE), number.dt = def->dt;
    number.mu = def->material.mu, number.mu_roll = def->material.mu_roll, number.k_n = def->material.k_n;
    if (rp_lets_constant(&now->text.lets, RP_LET_D, &number.d)) number.d = NAN;
    dem_gravity(sim, number.gravity);
    memcpy(down, number.gravity, sizeof down);
    dem_box_frame(sim, &down[0], &down[1]);
    number.tilt = atan2(down[0], 0.0 - down[1]) * degree;
    const double g = hypot(down[0], down[1]);
    for (size_t i = 0; i < n; i++) number.weight += s[i].m / (double)n * g;
    for (size_t k = 0; k < n_links && !(g > 0.0); k++) number.weight += c[k].normal_force / (double)n_links;
    if (!dem_rest_state(sim, -INFINITY, INFINITY, &rest))
        number.energy = rest.kinetic_energy / (number.weight * number.d);
    number.at_rest = number.weight > 0.0 && dem_at_rest(&rest, DEM_REST_ENERGY * number.weight * number.d,
                                                        DEM_REST_FORCE * number.weight, true);
    for (double *at = number.theta; at < &number.columns; at++) *at = NAN;
}

/* Read all that is seen. kind: 0, 1 slope between two ends in x, 2 flanks. The picture has of grains x, y, r,
 * load, angle; of contacts x, y, x, y, normal force; of walls point, direction, ends; heights of columns.
 * A grain's load is half of the sum over its contacts. */
double *EXPORT(page_read)(int kind, double from, double to)
{
    const dem_sim *sim = exp_sim(now->run);
    const size_t n = dem_count(sim), n_walls = dem_wall_count(sim);
    dem_state *s = malloc((n + 1) * sizeof *s);
    double *x = malloc((2 * n + 1) * sizeof *x), *y = x + n, *load = NULL;
    dem_contact *c = NULL;
    size_t n_links = 0;
    if (!s || !x || dem_states(sim, s) || dem_contacts(sim, &c, &n_links) ||
        !(load = calloc(n ? s[n - 1].id + 1 : 1, sizeof *load))) /* by ids, which rise */
        return NULL;
    read_numbers(sim, n, s, n_links, c);
    static float *picture;
    float *p = picture = realloc(picture, (6 * n + 5 * n_links + 6 * n_walls + 65536) * sizeof *picture);
    for (size_t k = 0; k < n_links; k++) {
        load[c[k].id_a] += 0.5 * c[k].normal_force / number.weight;
        if (c[k].id_b) load[c[k].id_b] += 0.5 * c[k].normal_force / number.weight;
    }
    for (size_t i = 0; i < n; i++)
        p = put(p, 5, (double[]){s[i].x, s[i].y, s[i].r, load[s[i].id], s[i].angle});
    for (size_t k = 0; k < n_links; k++)
        p = put(p, 5, (double[]){c[k].x, c[k].y, c[k].x_b, c[k].y_b, c[k].normal_force / number.weight});
    for (size_t k = 0; k < n_walls; k++) {
        const dem_wall_state w = dem_wall_now(sim, k);
        p = put(p, 4, (double[]){w.point[0], w.point[1], w.direction[0], w.direction[1]});
        p = put(p, 2, w.ends);
    }
    number.links = (double)n_links, number.walls = (double)n_walls,
    number.picture = (double)(uintptr_t)picture;
    for (size_t i = 0; i < n; i++) {
        x[i] = s[i].x, y[i] = s[i].y;
        dem_box_frame(sim, &x[i], &y[i]);
        x[i] -= kind == 1 ? from : 0.0;
    }
    if (kind == 1) read_one_side(n, x, y, to - from, p);
    if (kind == 2 && n > 0) read_flanks(n, x, y);
    free(s), free(x), free(c), free(load);
    return &number.step;
}
