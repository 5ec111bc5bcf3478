/* A scene as a LAMMPS input: pair_style granular (version of 2021) and wall/gran/region, in two dimensions.
 * Both programs step by the same Verlet scheme, with the velocity of half a step before in dashpots and shear
 * springs. Laws that coincide are mapped; for any other setting the key is named and nothing is written. */
#include <gsl/gsl_poly.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "export/export.h"
#include "dem/law/law.h"
#include "dem/setup/definition.h"
#include "dem/scene/scene.h"

/* Each kind is a type. Where k_n is the same for all radii here and grows as sqrt(R_eff) in LAMMPS, so is
 * each radius; where rolling is damped by the mass, which LAMMPS leaves out, each radius and mass. For walls
 * a type is a group, of which LAMMPS has 32. */
enum { MOST_TYPES = 24 };
typedef struct {
    uint32_t kind;
    double r, m; /* 0: all */
} grain_type;

typedef struct {
    dem_scene scene;
    dem_definition def; /* with all coefficients known */
    dem_state *grains;
    size_t n, n_types;
    bool by_mass;
    grain_type types[MOST_TYPES];
    double box[2][2], largest;
} lammps_scene;

static const dem_normal_descriptor *normal_law(const dem_definition *def)
{
    return &dem_normal_descriptors[def->normal];
}

/* Is the damping that of Tsuji? LAMMPS' polynomial for it has no 0. */
static bool tsuji(const dem_definition *def, const dem_material *m)
{
    return normal_law(def)->lammps_damping && m->gamma_n > 0.0;
}

static rp_status check_material(const dem_definition *def, const dem_material *m, const char *of)
{
    const bool slides = dem_has_friction(def->tangential);
    if (slides && isinf(m->mu))
        return rp_fail(RP_BAD_INPUT, "%stangential.mu = infinite: LAMMPS needs a number", of);
    if (isinf(m->mu_roll)) return rp_fail(RP_BAD_INPUT, "%srolling.mu = infinite: LAMMPS needs a number", of);
    if (normal_law(def)->lammps_damping && m->gamma_n > 1.2728)
        return rp_fail(
            RP_BAD_INPUT,
            "%snormal.gamma_n = %g, given or by restitution: LAMMPS' damping tsuji goes up to 1.2728", of,
            m->gamma_n);
    if (slides && m->gamma_s > 0.0 && tsuji(def, m) != dem_is_of_radius(def->tangential))
        return rp_fail(
            RP_BAD_INPUT,
            "%stangential.gamma_s = %g: LAMMPS damps shear as the normal direction, which the laws "
            "\"%s\" and \"%s\" do not; 0 goes",
            of, m->gamma_s, normal_law(def)->name, dem_tangential_descriptors[def->tangential].name);
    if (slides && (m->gamma_n == 0.0 || (tsuji(def, m) && m->k_n == 0.0)) && m->gamma_s > 0.0)
        return rp_fail(RP_BAD_INPUT,
                       "%stangential.gamma_s = %g: LAMMPS has it as a part of the normal damping, which is 0",
                       of, m->gamma_s);
    return RP_OK;
}

static rp_status check_walls(const dem_definition *def)
{
    for (size_t w = 0; w < def->n_walls; w++) {
        const dem_wall *wall = &dem_walls_of(def)[w];
        char name[32];
        snprintf(name, sizeof name, "wall %zu: ", w + 1);
        if (!dem_wall_is_line(wall))
            return rp_fail(RP_BAD_INPUT,
                           "%sextent: LAMMPS has whole planes, no segments, polygons or circles", name);
        if (wall->open_at_step >= 0)
            return rp_fail(RP_BAD_INPUT, "%sopen_at_step = %ld: walls of the input stay", name,
                           wall->open_at_step);
        if (wall->velocity[0] != 0.0 || wall->velocity[1] != 0.0 || wall->omega != 0.0)
            return rp_fail(RP_BAD_INPUT, "%s%s: walls of the input are at rest", name,
                           wall->omega != 0.0 ? "omega" : "velocity");
    }
    return RP_OK;
}

/* The first key that has no equal. */
static rp_status check_scene(const dem_definition *def)
{
    const bool slides = dem_has_friction(def->tangential), rolls = dem_has_rolling(def);
    const struct {
        bool differs;
        const char *message;
    } checks[] = {
        {def->integrator != DEM_VERLET, "integrator: LAMMPS steps as \"verlet\" does"},
        {rolls && !dem_rolls_by_spring(def->rolling), "rolling.model: LAMMPS has \"spring\" alone"},
        {rolls && dem_is_of_radius(def->tangential),
         "rolling: of this tangential.law it depends on the overlap, which that of LAMMPS does not"},
        {(slides || rolls) && def->tension,
         "normal.tension = true: LAMMPS limits friction by mu |F_n| where the force pulls; set it to false"},
        {dem_has_spring(def->tangential) && def->slip != DEM_TRUNCATED,
         "tangential.slip = \"total\": LAMMPS truncates the spring"},
        {dem_has_spring(def->tangential) && def->damping != DEM_DAMPING_INSIDE,
         "tangential.damping = \"outside\": LAMMPS limits spring and dashpot together; set \"inside\""},
        {def->ground.wall > 0, "ground: LAMMPS has no wells of static friction"},
        {def->hard.on, "hard: LAMMPS has no hard collisions"},
        {def->n_contacts > 0, "contacts_file: springs of LAMMPS begin at 0"},
        {isfinite(def->x_min), "x_min: the input takes no grain out"},
        {isfinite(def->x_max), "x_max: the input takes no grain out"},
        {isfinite(def->y_min), "y_min: the input takes no grain out"},
        {def->turn_per_step != 0.0, "gravity_turn_deg_per_step: the input's gravity does not turn"},
        {def->box_turn_per_step != 0.0, "box_turn_deg_per_step: the input's walls do not turn"}};
    const dem_tangential_descriptor *shear = &dem_tangential_descriptors[def->tangential];
    if (!normal_law(def)->lammps)
        return rp_fail(RP_BAD_INPUT, "normal.law = \"%s\": LAMMPS has no such law", normal_law(def)->name);
    if (!shear->lammps)
        return rp_fail(RP_BAD_INPUT, "tangential.law = \"%s\": LAMMPS has no such law", shear->name);
    for (size_t i = 0; i < sizeof checks / sizeof *checks; i++)
        if (checks[i].differs) return rp_fail(RP_BAD_INPUT, "%s", checks[i].message);
    return check_walls(def);
}

static grain_type type_of(const lammps_scene *s, const dem_state *grain)
{
    return (grain_type){grain->kind, normal_law(&s->def)->lammps_by_radius || s->by_mass ? grain->r : 0.0,
                        s->by_mass ? grain->m : 0.0};
}

static int by_type(const void *a, const void *b)
{
    const grain_type *p = a, *q = b;
    if (p->kind != q->kind) return p->kind - 1 < q->kind - 1 ? -1 : 1; /* grains without a kind come last */
    return p->r != q->r ? (p->r > q->r) - (p->r < q->r) : (p->m > q->m) - (p->m < q->m);
}

/* Coefficients of types a and b; for b from the number of types on, of a and a wall. */
static const dem_material *material_of(const lammps_scene *s, size_t a, size_t b)
{
    const uint32_t kind = s->types[a].kind;
    return b < s->n_types ? dem_pair_material(&s->def, kind, s->types[b].kind)
                          : dem_material_at(&s->def, b - s->n_types, kind);
}

static rp_status list_types(lammps_scene *s)
{
    s->n_types = 0;
    /* types by kind are the numbers of the kinds, also where a kind has no grains */
    for (uint32_t kind = 1; kind < s->def.n_kinds && kind <= MOST_TYPES; kind++) {
        const grain_type type = type_of(s, &(dem_state){.kind = kind});
        if (!normal_law(&s->def)->lammps_by_radius && !s->by_mass) s->types[s->n_types++] = type;
    }
    for (size_t i = 0, k; i < s->n; i++) {
        const grain_type type = type_of(s, &s->grains[i]);
        for (k = 0; k < s->n_types && by_type(&s->types[k], &type) != 0; k++) {
        }
        if (k == MOST_TYPES)
            return rp_fail(
                RP_BAD_INPUT,
                "normal.law = \"%s\"%s: each %s is a type of LAMMPS, at most %d; the law \"linear\" and "
                "rolling.gamma = 0 need one for each kind",
                normal_law(&s->def)->name, s->by_mass ? ", rolling.gamma" : "",
                s->by_mass     ? "radius and mass"
                : type.r > 0.0 ? "radius"
                               : "kind",
                MOST_TYPES);
        s->types[k] = type;
        if (k == s->n_types) s->n_types++;
    }
    qsort(s->types, s->n_types, sizeof *s->types, by_type);
    return RP_OK;
}

/* The types, whose laws LAMMPS must have. */
static rp_status find_types(lammps_scene *s)
{
    const size_t n_walls = s->def.n_walls;
    RP_TRY(list_types(s));
    for (size_t a = 0; a < s->n_types; a++)
        for (size_t b = a; b < s->n_types + n_walls; b++) {
            char of[2 * DEM_NAME_BYTES + 32] = "";
            const dem_material *m = material_of(s, a, b);
            const char *first = s->def.n_kinds > 1 ? s->def.kinds[s->types[a].kind].name : "";
            if (b >= s->n_types)
                snprintf(of, sizeof of, "wall %zu%s%s: ", b - s->n_types + 1, *first ? ", " : "", first);
            else if (s->def.pairs)
                snprintf(of, sizeof of, "%s, %s: ", first, s->def.kinds[s->types[b].kind].name);
            RP_TRY(check_material(&s->def, m, of));
            s->by_mass |= dem_has_rolling(&s->def) && m->gamma_roll > 0.0;
        }
    return s->by_mass ? list_types(s) : RP_OK;
}

/* The grains of the start, and with them what a restitution stands for. */
static rp_status start_scene(rp_arena *arena, lammps_scene *s)
{
    dem_sim *sim;
    RP_TRY(dem_scene_start(&s->scene, &sim));
    s->n = dem_count(sim);
    s->grains = rp_arena_memory(arena, s->n, sizeof *s->grains);
    rp_status status = dem_states(sim, s->grains);
    dem_free(sim);
    dem_grain *grains = rp_arena_memory(arena, s->n, sizeof *grains);
    s->box[0][0] = s->box[1][0] = INFINITY, s->box[0][1] = s->box[1][1] = -INFINITY;
    for (size_t i = 0; i < s->n && !status; i++) {
        const dem_state *p = &s->grains[i];
        const double x[2] = {p->x, p->y};
        grains[i] = (dem_grain){.x = p->x, .y = p->y, .r = p->r, .m = p->m, .fixed = p->fixed};
        grains[i].kind = p->kind, grains[i].vx = p->vx, grains[i].vy = p->vy, grains[i].omega = p->omega;
        for (int k = 0; k < 2; k++) {
            s->box[k][0] = fmin(s->box[k][0], x[k] - p->r);
            s->box[k][1] = fmax(s->box[k][1], x[k] + p->r);
        }
        s->largest = fmax(s->largest, p->r);
    }
    s->def = s->scene.def;
    s->def.grains = grains;
    s->def.n_grains = s->n;
    return status ? status : dem_physics_resolve(&s->def);
}

/* LAMMPS takes the mass of a sphere from its density. */
static void write_data(const lammps_scene *s, const char *scene, FILE *out)
{
    fprintf(out, "# %s, written by repose export; columns: id type diameter density x y z\n\n", scene);
    fprintf(out, "%zu atoms\n%zu atom types\n", s->n, s->n_types);
    fprintf(out, "%s %s xlo xhi\n%s %s ylo yhi\n%s %s zlo zhi\n\nAtoms # sphere\n\n", RP_SHORT(s->box[0][0]),
            RP_SHORT(s->box[0][1]), RP_SHORT(s->box[1][0]), RP_SHORT(s->box[1][1]), RP_SHORT(-s->largest),
            RP_SHORT(s->largest));
    for (size_t i = 0; i < s->n; i++) {
        const dem_state *p = &s->grains[i];
        const grain_type type = type_of(s, p),
                         *found = bsearch(&type, s->types, s->n_types, sizeof type, by_type);
        fprintf(out, "%u %td %s %s %s %s 0\n", p->id, found - s->types + 1, RP_SHORT(2.0 * p->r),
                RP_SHORT(p->m / dem_mass(DEM_SPHERE, 1.0, p->r)), RP_SHORT(p->x), RP_SHORT(p->y));
    }
    fputs("\nVelocities\n\n", out);
    for (size_t i = 0; i < s->n; i++)
        fprintf(out, "%u %s %s 0 0 0 %s\n", s->grains[i].id, RP_SHORT(s->grains[i].vx),
                RP_SHORT(s->grains[i].vy), RP_SHORT(s->grains[i].omega));
}

/* LAMMPS takes Tsuji's damping from a restitution, by a polynomial of its manual: where that is gamma_n. */
static double tsuji_restitution(double gamma_n)
{
    static const double c[] = {1.2728, -4.2783, 11.087, -22.348, 27.467, -18.022, 4.8218};
    double low = 0.0, high = 1.0;
    for (double middle; middle = 0.5 * (low + high), middle > low && middle < high;)
        *(gsl_poly_eval(c, 7, middle) > gamma_n ? &low : &high) = middle;
    return low;
}

/* The law of a contact of two types, or of a type and a wall, in the words of pair_coeff. */
static void write_law(const lammps_scene *s, size_t i, size_t j, FILE *out)
{
    const dem_definition *def = &s->def;
    const dem_material *m = material_of(s, i, j);
    const grain_type *a = &s->types[i], *b = j < s->n_types ? &s->types[j] : NULL;
    const double r_eff = b ? a->r * b->r / (a->r + b->r) : a->r,
                 m_eff = b ? a->m * b->m / (a->m + b->m) : a->m;
    const dem_normal_descriptor *law = normal_law(def);
    const double part = m->gamma_n > 0.0 ? m->gamma_s / m->gamma_n : 0.0,
                 damping = dem_is_of_radius(def->tangential) ? part * sqrt(m->k_s / m->k_n) : part;
    fprintf(out, "%s %s %s tangential %s", law->lammps,
            RP_SHORT(law->lammps_by_radius ? m->k_n / sqrt(r_eff) : m->k_n),
            RP_SHORT(tsuji(def, m) ? tsuji_restitution(m->gamma_n) : m->gamma_n),
            dem_tangential_descriptors[def->tangential].lammps);
    if (dem_has_spring(def->tangential)) fprintf(out, " %s", RP_SHORT(m->k_s));
    if (dem_has_friction(def->tangential))
        fprintf(out, " %s %s", RP_SHORT(damping), RP_SHORT(m->mu));
    else
        fputs(" 0 0", out);
    if (dem_has_rolling(def)) {
        const dem_slider rolls =
            dem_rolls_of(def->rolling, def->tangential, b && def->rolling_arm == DEM_ARM_RADIUS ? 2.0 : 1.0,
                         m->k_roll, m->gamma_roll, m->mu_roll);
        fprintf(out, " rolling sds %s %s %s", RP_SHORT(rolls.k),
                RP_SHORT(m->gamma_roll > 0.0 ? rolls.gamma * m_eff : 0.0), RP_SHORT(rolls.mu));
    }
    fprintf(out, " damping %s%s", tsuji(def, m) ? law->lammps_damping : "mass_velocity",
            def->tension ? "" : " limit_damping");
}

static void write_about(const lammps_scene *s, const char *scene, FILE *out)
{
    fprintf(out, "# %s for LAMMPS, written by repose export. Run it in this folder: lmp -in FILE\n#\n",
            scene);
    fprintf(out, "# Laws that coincide with those of `repose run`, up to %s:\n",
            s->def.rotation
                ? "round-off and the slip that spin makes, which LAMMPS takes at the radii, `repose run` "
                  "at the contact, nearer by half an overlap"
                : "round-off (spheres that do not rotate)");
    fprintf(out, "# normal force: %s%s, dashpot %s%s\n", normal_law(&s->def)->name,
            normal_law(&s->def)->lammps_by_radius
                ? "; LAMMPS' own stiffness is k sqrt(R_eff), so that each radius is a type"
                : "",
            normal_law(&s->def)->lammps_damping ? "of Tsuji" : "gamma_n m_eff",
            s->def.tension ? ", which may pull" : ", together not below 0");
    if (normal_law(&s->def)->lammps_damping)
        fputs("# damping: LAMMPS takes it from a restitution by a polynomial; the number here is where that "
              "has gamma_n, not the restitution of impacts\n",
              out);
    if (dem_has_rolling(&s->def))
        fputs("# rolling resistance: model C; where its dashpot gamma_roll m_eff has a part, each radius and "
              "mass is a "
              "type\n",
              out);
    fprintf(out, "# shear force: %s\n# walls: the same with R_eff = r and m_eff = m, whole planes at rest\n",
            dem_tangential_descriptors[s->def.tangential].in_lammps);
    for (size_t k = 0; k < s->n_types && s->def.n_kinds > 1; k++)
        fprintf(out, "# type %zu: kind %s\n", k + 1, s->def.kinds[s->types[k].kind].name);
    fprintf(
        out,
        "# integrator: velocity Verlet; forces that depend on velocity take that of half a step before\n");
    if (dem_has_spring(s->def.tangential))
        fputs("# start: of contacts whose dashpot alone exceeds mu F_n, LAMMPS leaves the shear force out of "
              "the first half step\n"
              "# dashpot alone above mu F_n (first touch of a fast slip): LAMMPS draws the spring the other "
              "way, "
              "here it stays: grains then move apart\n",
              out);
    fprintf(out, "# Every other setting of a scene is refused by repose export.\n\n");
}

static void write_walls(const lammps_scene *s, FILE *out)
{
    const dem_definition *def = &s->def;
    for (size_t k = 0; k < s->n_types && s->n_types > 1 && def->n_walls > 0; k++)
        fprintf(out, "group type%zu type %zu\n", k + 1, k + 1);
    for (size_t w = 0; w < def->n_walls; w++) {
        const dem_wall *wall = &dem_walls_of(def)[w];
        fprintf(out, "region wall%zu plane %s %s 0 %s %s 0\n", w + 1, RP_SHORT(wall->point[0]),
                RP_SHORT(wall->point[1]), RP_SHORT(wall->direction[0]), RP_SHORT(wall->direction[1]));
        for (size_t k = 0; k < s->n_types; k++) {
            char group[32] = "all";
            if (s->n_types > 1) snprintf(group, sizeof group, "type%zu", k + 1);
            fprintf(out, "fix wall%zu_%zu %s wall/gran/region granular ", w + 1, k + 1, group);
            write_law(s, k, s->n_types + w, out);
            fprintf(out, " region wall%zu\n", w + 1);
        }
    }
}

static void write_motion(const lammps_scene *s, FILE *out)
{
    const double *g = s->def.gravity, magnitude = hypot(g[0], g[1]);
    bool any = false;
    for (size_t i = 0; i < s->n; any |= s->grains[i++].fixed)
        if (s->grains[i].fixed) fprintf(out, "group fixed id %u\n", s->grains[i].id);
    fputs(any ? "fix hold fixed freeze\ngroup mobile subtract all fixed\n" : "group mobile union all\n", out);
    if (magnitude > 0.0)
        fprintf(out, "fix gravity mobile gravity %s vector %s %s 0\n", RP_SHORT(magnitude), RP_SHORT(g[0]),
                RP_SHORT(g[1]));
    fprintf(out, "fix move mobile nve%s\nfix flat all enforce2d\n",
            !s->def.rotation             ? ""
            : s->def.shape == DEM_SPHERE ? "/sphere"
                                         : "/sphere disc");
}

static void write_input(const lammps_scene *s, const char *scene, const char *stem, FILE *out)
{
    const char *name = basename(stem);
    write_about(s, scene, out);
    fprintf(out, "# each may be set on the command line: lmp -in FILE -var steps 1000\n");
    fprintf(out, "variable steps index %ld\nvariable every index %ld\n", s->scene.steps,
            s->scene.steps < 200 ? 1 : s->scene.steps / 100);
    fprintf(out, "variable data index %s.data\nvariable dump index %s.lammpstrj\n\n", name, name);
    fputs("units lj\ndimension 2\nboundary m m p\natom_style sphere\natom_modify map array\nnewton off\n"
          "comm_modify vel yes\nread_data ${data}\n\npair_style granular\n",
          out);
    for (size_t i = 0; i < s->n_types; i++)
        for (size_t j = i; j < s->n_types; j++) {
            fprintf(out, s->n_types > 1 ? "pair_coeff %zu %zu " : "pair_coeff * * ", i + 1, j + 1);
            write_law(s, i, j, out);
            fputc('\n', out);
        }
    fprintf(out, "neighbor %s bin\nneigh_modify every 1 delay 0 check yes\ntimestep %s\n\n",
            RP_SHORT(0.5 * s->largest), RP_SHORT(s->def.dt));
    write_motion(s, out);
    write_walls(s, out);
    fprintf(out,
            "\ndump frames all custom ${every} ${dump} id type x y z radius mass vx vy vz%s\n"
            "dump_modify frames sort id format float %%.17g\nthermo ${every}\nrun ${steps}\n",
            s->def.rotation ? " omegaz" : "");
}

static rp_status write_files(rp_arena *arena, const lammps_scene *s, const char *scene, const char *path,
                             bool replace)
{
    FILE *input, *out;
    const char *stem = export_stem(arena, path), *name = export_word(rp_text(arena, "%s", basename(stem))),
               *data = rp_text(arena, "%s.data", stem);
    if (strcmp(name, basename(stem)) != 0)
        return rp_fail(RP_USAGE, "-o %s: the input of LAMMPS names its files: letters, digits and ._+- alone",
                       path);
    scene = export_word(rp_text(arena, "%s", scene)); /* for comments */
    const bool begun = rp_file_was_begun(path);
    RP_TRY(rp_file_open(path, replace, &input));
    const rp_status status = rp_file_open(data, replace || begun, &out);
    if (status) return rp_file_close(path, input, status);
    write_data(s, scene, out);
    write_input(s, scene, stem, input);
    return rp_file_close_both(path, input, data, out);
}

static void free_scene(lammps_scene *s)
{
    dem_physics_free(&s->def, &s->scene.def);
    dem_scene_free(&s->scene);
}

/* What can be written of a scene that was read. */
static rp_status prepare(rp_arena *arena, lammps_scene *s)
{
    if (s->scene.phases) return rp_fail(RP_BAD_INPUT, "phases: the input is of a scene without them");
    RP_TRY(check_scene(&s->scene.def));
    RP_TRY(start_scene(arena, s));
    return find_types(s); /* with what a restitution stands for */
}

rp_status export_lammps_input(rp_arena *arena, const char *scene, const rp_texts *changes, const char *path,
                              bool replace)
{
    RP_ENDS(free_scene) lammps_scene s = {.n = 0};
    if (strlen(path) < 4 || !rp_ends_in(path, ".in"))
        return rp_fail(RP_USAGE, "-o %s: lammps-input needs a name that ends in .in", path);
    RP_TRY(dem_scene_read(scene, changes, &s.scene));
    RP_TRY(rp_prefix(prepare(arena, &s), "%s: ", scene));
    return write_files(arena, &s, scene, path, replace);
}
