/* Scenes and states as text: scene files that scene.c reads back, and tables. See scene.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/table.h"
#include "dem/scene.h"

/* A number with a point or exponent, as libconfig wants it for a float. */
static void write_number(FILE *out, const char *key, double value)
{
    char text[40];
    snprintf(text, sizeof text, "%.17g", value);
    fprintf(out, "%s = %s%s; ", key, text, strpbrk(text, ".en") ? "" : ".0");
}

static void write_pair(FILE *out, const char *key, const double pair[2])
{
    fprintf(out, "%s = ( %.17g, %.17g ); ", key, pair[0], pair[1]);
}

static void write_shear(FILE *out, const dem_material *c)
{
    write_number(out, "k_s", c->k_s);
    write_number(out, "gamma_s", c->gamma_s);
    if (isinf(c->mu))
        fputs("mu = \"infinite\"; ", out);
    else
        write_number(out, "mu", c->mu);
}

static void write_material(FILE *out, const dem_definition *def, const dem_material *c)
{
    write_number(out, "k_n", c->k_n);
    write_number(out, "gamma_n", c->gamma_n);
    if (def->tangential == DEM_NONE) return;
    write_shear(out, c);
}

static void write_laws(FILE *out, const dem_definition *def)
{
    fprintf(out, "normal = { law = \"%s\"; tension = %s; ", def->normal == DEM_HERTZ ? "hertz" : "linear",
            def->tension ? "true" : "false");
    write_number(out, "k_n", def->material.k_n);
    write_number(out, "gamma_n", def->material.gamma_n);
    fputs("};\n", out);
    if (def->tangential == DEM_NONE) return;
    fprintf(out, "tangential = { law = \"spring\"; slip = \"%s\"; ",
            def->slip == DEM_TRUNCATED ? "truncated" : "total");
    write_shear(out, &def->material);
    fputs("};\n", out);
}

static void write_walls(FILE *out, const dem_definition *def)
{
    fputs("walls = (", out);
    for (size_t w = 0; w < def->n_walls; w++) {
        const dem_wall *wall = &def->walls[w];
        fputs(w ? ",\n  { " : "\n  { ", out);
        write_pair(out, "point", wall->point);
        write_pair(out, "direction", wall->direction);
        /* libconfig has no infinity: an open end is written as a number far away */
        double ends[2] = {fmax(wall->extent[0], -1e300), fmin(wall->extent[1], 1e300)};
        if (isfinite(wall->extent[0]) || isfinite(wall->extent[1])) write_pair(out, "extent", ends);
        write_material(out, def, &wall->material);
        if (wall->open_at_step >= 0) fprintf(out, "open_at_step = %ld; ", wall->open_at_step);
        if (wall->open_at_step >= 0 && isfinite(wall->open_speed))
            write_number(out, "open_speed", wall->open_speed);
        fputs("}", out);
    }
    fputs(" );\n", out);
}

static void write_fill(FILE *out, const dem_fill *f)
{
    fprintf(out, "shape = \"%s\"; ", f->shape == DEM_SPHERE ? "sphere" : "disk");
    write_number(out, "density", f->density);
    fprintf(out, "\nfill = { N = %ld; seed = %ld; run = %ld; ", f->N, f->seed, f->run);
    write_number(out, "W", f->W);
    write_number(out, "H", f->H);
    write_number(out, "radius_mean", f->radius_mean);
    write_number(out, "radius_width", f->radius_width);
    write_number(out, "radius_min", f->radius_min);
    write_number(out, "radius_max", f->radius_max);
    fputs("};\n", out);
}

static void write_particles(FILE *out, const dem_scene *scene)
{
    fputs("particles = (", out);
    for (size_t i = 0; i < scene->def.n_grains; i++) {
        const dem_grain *p = &scene->grains[i];
        fputs(i ? ",\n  { " : "\n  { ", out);
        write_number(out, "x", p->x);
        write_number(out, "y", p->y);
        write_number(out, "r", p->r);
        write_number(out, "m", p->m);
        write_number(out, "vx", p->vx);
        write_number(out, "vy", p->vy);
        fputs("}", out);
    }
    fputs(" );\n", out);
}

void dem_scene_write(const dem_scene *scene, FILE *out)
{
    const dem_definition *def = &scene->def;
    write_pair(out, "gravity", def->gravity);
    write_number(out, "dt", def->dt);
    fprintf(out, "steps = %ld;\n", scene->steps);
    if (def->skin > 0.0) write_number(out, "skin", def->skin);
    if (isfinite(def->x_max)) write_number(out, "x_max", def->x_max);
    if (isfinite(def->y_min)) write_number(out, "y_min", def->y_min);
    if (def->turn_per_step != 0.0) {
        write_number(out, "gravity_turn_deg_per_step", def->turn_per_step * (180.0 / M_PI));
        fprintf(out, "turn_from_step = %ld;\n", def->turn_from_step);
    }
    write_laws(out, def);
    write_walls(out, def);
    if (scene->has_fill)
        write_fill(out, &scene->fill);
    else
        write_particles(out, scene);
}

void dem_write_state_columns(FILE *out)
{
    static const char *const columns[][2] = {
        {"step", ""},     {"t", "s"},     {"id", ""},     {"x", "cm"},        {"y", "cm"},
        {"angle", "rad"}, {"vx", "cm/s"}, {"vy", "cm/s"}, {"omega", "rad/s"}, {"fx", "dyn"},
        {"fy", "dyn"},    {"r", "cm"},    {"m", "g"},     {"contacts", ""}};
    rp_table_columns(out, sizeof columns / sizeof *columns, columns);
}

rp_status dem_write_states(const dem_sim *sim, FILE *out)
{
    dem_state *states = malloc((dem_count(sim) + 1) * sizeof *states);
    if (!states) return rp_fail(RP_NO_MEMORY, "states: out of memory");
    rp_status status = dem_states(sim, states);
    for (size_t i = 0; !status && i < dem_count(sim); i++) {
        const dem_state *p = &states[i];
        rp_table_row(out, 14,
                     (double[]){(double)dem_step(sim), dem_time(sim), p->id, p->x, p->y, 0.0, p->vx, p->vy,
                                0.0, p->fx, p->fy, p->r, p->m, p->contacts});
    }
    free(states);
    return status;
}

rp_status dem_write_contacts(const dem_sim *sim, FILE *out)
{
    static const char *const columns[][2] = {{"id_a", ""},
                                             {"id_b", ""},
                                             {"wall", ""},
                                             {"x", "cm"},
                                             {"y", "cm"},
                                             {"x_b", "cm"},
                                             {"y_b", "cm"},
                                             {"overlap", "cm"},
                                             {"normal_force", "dyn"},
                                             {"shear_force", "dyn"},
                                             {"shear_spring", "cm"}};
    dem_contact *contacts;
    size_t n;
    rp_status status = dem_contacts(sim, &contacts, &n);
    rp_table_columns(out, sizeof columns / sizeof *columns, columns);
    for (size_t k = 0; !status && k < n; k++) {
        const dem_contact *c = &contacts[k];
        rp_table_row(out, 11,
                     (double[]){c->id_a, c->id_b, c->wall + 1, c->x, c->y, c->x_b, c->y_b, c->overlap,
                                c->normal_force, c->shear_force, c->shear_spring});
    }
    free(contacts);
    return status;
}
