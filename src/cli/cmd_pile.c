/* repose pile: static equilibrium of a pile of soft disks, and its forces on the base. */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <unistd.h>

#include "analytic/analytic.h"
#include "stats/stats.h"
#include "cli/cli.h"
#include "core/clock.h"
#include "sweeps/driver/outline.h"

typedef struct {
    long base, load_steps, seed, piles, leave;
    double alpha_deg, outer_deg, inner_deg, x_1, gap, disorder;
    double eps, k_x, well, mu, set_load;
    bool linear, set_again, summary, threshold;
    int branch;
    const char *outline, *disks, *directory;
} options;

static const rp_param schema[] = {
    {"base", "", RP_INT, offsetof(options, base), "45", "[1, 1000000]", "disks in the base"},
    {"alpha-deg", "degrees", RP_REAL, offsetof(options, alpha_deg), "auto", "(0, 60] | auto",
     "slope of the pile; auto: 60, the full triangle"},
    {"outer-deg", "degrees", RP_REAL, offsetof(options, outer_deg), "auto", "(0, 60) | auto",
     "a tent: alpha_1, slope from the edge to X_1"},
    {"inner-deg", "degrees", RP_REAL, offsetof(options, inner_deg), "auto", "(0, 60) | auto",
     "a tent: alpha_2, slope from X_1 to the middle"},
    {"x1", "B", RP_REAL, offsetof(options, x_1), "auto", "(0, 0.5) | auto",
     "a tent: X_1, where the slope changes"},
    {"outline", "", RP_TEXT, offsetof(options, outline), "", "",
     "a polygon: table with columns x, y of its vertices from left to right, in any unit"},
    {"disks", "", RP_TEXT, offsetof(options, disks), "", "",
     "any disks: table with columns x, y of their centres and, if not 0.5, r (sigma)"},
    {"gap", "sigma", RP_REAL, offsetof(options, gap), "0", "[0, 0.73]",
     "between the disks of a row; those of the diagonals touch"},
    {"disorder", "", RP_REAL, offsetof(options, disorder), "0", "[0, 0.1]",
     "S: radii of the disks above the base (1 + S z)/2 on the same places, z normal, cut at +-3"},
    {"seed", "", RP_INT, offsetof(options, seed), "1", "[0, 2147483647]", "of the z"},
    {"piles", "", RP_INT, offsetof(options, piles), "1", "[1, 1000000]",
     "with --disorder: mean over so many piles and its standard error"},
    {"eps", "", RP_REAL, offsetof(options, eps), "1e-4", "(0, 0.1]", "m g/(K_s sigma)"},
    {"linear", "", RP_BOOL, offsetof(options, linear), "false", "", "the limit eps -> 0"},
    {"k-x", "K_s", RP_REAL, offsetof(options, k_x), "auto", "(0, 1e9] | auto",
     "wells that are springs and never break, of this stiffness (1 without --well)"},
    {"well", "eps sigma", RP_REAL, offsetof(options, well), "auto", "(0, 1e9] | auto",
     "wells of static friction, of this half-width: stiffness mu N/a, broken beyond a"},
    {"mu", "", RP_REAL, offsetof(options, mu), "auto", "(0, 1e9] | auto",
     "coefficient of static friction of --well (auto: 1)"},
    {"set-again", "", RP_BOOL, offsetof(options, set_again), "false", "",
     "a broken well is set anew where its disk then is; else it stays broken"},
    {"set-load", "", RP_REAL, offsetof(options, set_load), "0", "[0, 1]",
     "part of the load under which the disks' places become the wells' x_0; 0: their places in the lattice"},
    {"branch", "", RP_CHOICE, offsetof(options, branch), "primary", "primary | minimum",
     "the state that grows from no load, stable or not; or a minimum of the energy near it"},
    {"leave", "", RP_INT, offsetof(options, leave), "0", "[0, 2147483647]",
     "with --branch minimum: the minimum that is come to from the primary state along direction number N, "
     "drawn among those in which it is not stable; 0: straight downhill from the linearised state"},
    {"load-steps", "", RP_INT, offsetof(options, load_steps), "1", "[1, 1000000]",
     "steps in which the load is raised"},
    {"summary", "", RP_BOOL, offsetof(options, summary), "false", "",
     "one row for the pile, not one a base disk: what its base bears, the solver's account, its time and "
     "memory"},
    {"threshold", "", RP_BOOL, offsetof(options, threshold), "false", "",
     "instead: the eps, sought from --eps on, above which the primary branch is not stable"},
    {"o", "", RP_TEXT, offsetof(options, directory), "", "",
     "folder for wells.tsv, contacts.tsv and disks.tsv, also without an equilibrium"},
    {0},
};

static const cli_command command = {
    .name = "pile",
    .synopsis =
        "[--base K] [--alpha-deg A | --outer-deg A --inner-deg A --x1 X | --outline FILE | --disks FILE]\n"
        "       [--eps E | --linear] [--k-x K | --well A [--mu MU]] [--branch primary|minimum [--leave N]]\n"
        "       [--disorder S [--seed N] [--piles N]] [-o DIR]",
    .about =
        "Static equilibrium of soft frictionless disks, close-packed on a flat base: the computer model of\n"
        "Liffman, Chan & Hughes 1992 at rest. Row i is base disk i from the left; N is the normal force of "
        "the\n"
        "ground on it, H the force of the pile on the ground there, positive to the right. Beside them what\n"
        "diagonal contacts alone would carry, the exact limit of hard disks in which no contact within a "
        "row\n"
        "closes, and the columns in chi g B of `repose continuum`. The header tells whether the state is\n"
        "stable: negative_modes counts the directions in which it is not. The primary state need not be: it "
        "is\n"
        "a result all the same, exit status 0, and a note on standard error tells.\n"
        "\n"
        "Without an equilibrium: exit status 1, a message that names disks and wells, in the tables of -o "
        "the\n"
        "state in which the solve was given up, and one of these statuses.\n"
        "  spreads        wells broke, and neighbours slid apart\n"
        "  collapses      they did so though no well broke: toppled, or disks or springs too soft\n"
        "  creeps         with --set-again: wells are set anew without end\n"
        "  meets          disks overlap that were no neighbours\n"
        "  not_converged  the solver gave up\n"
        "  singular       an equilibrium in which a disk can move freely, or none found for such a disk",
    .example = "repose pile --alpha-deg 30 --base 45",
    .options = schema,
};

static rp_status no_memory(void)
{
    return rp_fail(RP_NO_MEMORY, "pile: out of memory");
}

/* ---- Outlines ---- */

static rp_status read_outline(const char *path, an_point **v, size_t *n)
{
    static const char *const names[] = {"x", "y"};
    rp_table table;
    int columns[2];
    double *block = NULL;
    rp_status status = rp_table_read(path, &table);
    if (!status) status = cli_find_columns(&table, 2, names, columns);
    if (!status) status = cli_read_columns(&table, 2, columns, 0, &block);
    *n = table.n_rows;
    *v = status ? NULL : malloc((*n + 1) * sizeof **v);
    if (!status && !*v) status = no_memory();
    for (size_t i = 0; !status && i < *n; i++) (*v)[i] = (an_point){block[i], block[*n + i]};
    free(block);
    rp_table_free(&table);
    return status;
}

static rp_status make_outline(const options *o, sweep_outline *h)
{
    const double deg = M_PI / 180;
    an_point tent[5], *v = NULL;
    size_t n = 0;
    rp_status status = RP_OK;
    if (*o->outline) {
        status = read_outline(o->outline, &v, &n);
        if (!status) status = sweep_outline_polygon(h, o->base, o->gap, v, n);
    } else if (o->outer_deg > 0) {
        status = an_tent(o->outer_deg * deg, o->inner_deg * deg, o->x_1, tent);
        if (!status) status = sweep_outline_polygon(h, o->base, o->gap, tent, 5);
    } else
        status = sweep_outline_slope(h, o->base, o->gap, o->alpha_deg > 0 ? o->alpha_deg * deg : 0);
    free(v);
    return status;
}

static rp_status read_disks(const char *path, sweep_outline *h)
{
    static const char *const names[] = {"x", "y"};
    rp_table table;
    double *block = NULL;
    int columns[3];
    rp_status status = rp_table_read(path, &table);
    if (!status) status = cli_find_columns(&table, 2, names, columns);
    columns[2] = status ? -1 : rp_table_column(&table, "r");
    if (!status) status = cli_read_columns(&table, 3, columns, 0, &block);
    h->n = table.n_rows;
    h->disks = status ? NULL : malloc((h->n + 1) * sizeof *h->disks);
    if (!status && !h->disks) status = no_memory();
    for (size_t i = 0; !status && i < h->n; i++) {
        const double r = columns[2] >= 0 ? block[2 * h->n + i] : 0.5;
        h->disks[i] = (statics_disk){block[i], block[h->n + i], r, 4 * r * r};
    }
    h->B = NAN;
    free(block);
    rp_table_free(&table);
    return status;
}

static statics_definition define(const options *o, const sweep_outline *h)
{
    statics_definition def = statics_definition_default();
    def.n = h->n;
    def.disks = h->disks;
    def.eps = o->linear ? 0 : o->eps;
    if (o->k_x > 0) def.k_x = o->k_x;
    if (o->well > 0) {
        def.well = STATICS_WELL_FRICTION;
        def.a = o->well;
        if (o->mu > 0) def.mu = o->mu;
    }
    def.set_again = o->set_again;
    def.set_load = o->set_load;
    def.branch = o->branch;
    def.leave = (unsigned long)o->leave;
    def.load_steps = o->load_steps;
    return def;
}

/* ---- Output ---- */

static void write_header(FILE *out, const options *o, const sweep_outline *h, const statics_result *r)
{
    cli_table(out, schema, o);
    rp_table_note(out, "n_disks", "%zu", h->n);
    rp_table_note(out, "B", "%.17g sigma", h->B);
    rp_table_note(out, "status", "%s", statics_fault_text(r->fault));
    rp_table_note(out, "load", "%g of the weight; %zu jumps to another branch on the way", r->load, r->jumps);
    if (r->fault)
        rp_table_note(out, "state", "no equilibrium: where the solve was given up, at eps = %g", r->eps);
    rp_table_note(out, "energy", "%.17g m g eps sigma", r->energy);
    if (!isnan(r->released))
        rp_table_note(out, "released", "%.6g m g eps sigma, from the primary state on", r->released);
    rp_table_note(out, "residual", "%.3g m g", r->residual);
    if (r->fault)
        rp_table_note(out, "negative_modes", "nan");
    else
        rp_table_note(out, "negative_modes", "%zu", r->negative_modes);
    if (isnan(r->smallest_pivot))
        rp_table_note(out, "smallest_pivot", "nan");
    else
        rp_table_note(out, "smallest_pivot", "%.3g K_s, disk %zu", r->smallest_pivot, r->pivot_disk + 1);
    rp_table_note(out, "contacts", "%zu, %zu of them horizontal", r->contacts, r->horizontal);
    rp_table_note(out, "wells", "%zu, %zu of them %s", r->wells, r->broken,
                  o->set_again ? "set anew" : "broken");
    rp_table_note(out, "solver", "%zu steps, %zu factorisations", r->steps, r->factored);
}

static void write_base(const sweep_outline *h, const size_t *disk, const double *N, const double *H, size_t k)
{
    static const char *const columns[][2] = {{"i", ""},    {"x", "sigma"},         {"N/mg", ""},
                                             {"H/mg", ""}, {"N_diagonals/mg", ""}, {"H_diagonals/mg", ""},
                                             {"x/B", ""},  {"N/(chi*g*B)", ""},    {"H/(chi*g*B)", ""}};
    const double middle = (h->disks[disk[0]].x + h->disks[disk[k - 1]].x) / 2;
    rp_table_columns(stdout, 9, columns);
    for (size_t i = 0; i < k; i++) {
        const double x = h->disks[disk[i]].x;
        const an_force exact = h->exact ? h->exact[i] : (an_force){NAN, NAN};
        rp_table_row(stdout, 9,
                     (double[]){(double)i + 1, x, N[i], H[i], exact.N, exact.H, 0.5 + (x - middle) / h->B,
                                N[i] / h->B, H[i] / h->B});
    }
}

/* What the loads of the base are summed up to; NAN where it is not known. */
typedef struct {
    sweep_outline_error error;
    double friction, friction_diagonals, centre, dip;
} base_summary;

static rp_status sum_up(const sweep_outline *h, const size_t *disk, const double *N, const double *H,
                        size_t k, base_summary *b)
{
    double *x = malloc((3 * k + 1) * sizeof *x), *exact_N = x ? x + k : NULL, *exact_H = x ? x + 2 * k : NULL;
    rp_status status;
    if (!x) return no_memory();
    for (size_t i = 0; i < k; i++) x[i] = h->disks[disk[i]].x;
    b->friction = sweep_outline_friction(k, N, H);
    b->centre = sweep_outline_centre(k, N);
    stress_base base;
    status = sweep_outline_base(k, x, N, &base);
    b->dip = status ? NAN : stress_dip(base.N);
    if (status == RP_NO_RESULT) status = RP_OK; /* a single disk has no profile */
    if (h->exact) {
        for (size_t i = 0; i < k; i++) {
            exact_N[i] = h->exact[i].N;
            exact_H[i] = h->exact[i].H;
        }
        b->error = sweep_outline_compare(h, N, H);
        b->friction_diagonals = sweep_outline_friction(k, exact_N, exact_H);
    }
    free(x);
    return status;
}

static void write_summary(const options *o, const sweep_outline *h, const statics_result *r,
                          const base_summary *b)
{
    static const char *const columns[][2] = {{"eps", ""},
                                             {"alpha_deg", "degrees"},
                                             {"inner_deg", "degrees"},
                                             {"well", "eps sigma"},
                                             {"mu", ""},
                                             {"set_load", ""},
                                             {"set_again", ""},
                                             {"base", ""},
                                             {"n_disks", ""},
                                             {"N_error_rms", ""},
                                             {"N_error_max", ""},
                                             {"H_max/H_max_diagonals", ""},
                                             {"H/N_max", ""},
                                             {"H/N_max_diagonals", ""},
                                             {"N_centre", ""},
                                             {"D", ""},
                                             {"negative_modes", ""},
                                             {"smallest_pivot", "K_s"},
                                             {"residual", "m g"},
                                             {"contacts", ""},
                                             {"horizontal", ""},
                                             {"broken", ""},
                                             {"jumps", ""},
                                             {"leave", ""},
                                             {"energy", "m g eps sigma"},
                                             {"released", "m g eps sigma"},
                                             {"seconds", "s"},
                                             {"memory", "MB"},
                                             {"status", ""}};
    const statics_definition def = define(o, h);
    const bool friction = def.well == STATICS_WELL_FRICTION;
    const double alpha_deg = o->outer_deg > 0 ? o->outer_deg : o->alpha_deg;
    rp_table_columns(stdout, 29, columns);
    rp_table_row_word(stdout, 28,
                      (double[]){def.eps,
                                 alpha_deg > 0 ? alpha_deg : NAN,
                                 o->inner_deg > 0 ? o->inner_deg : NAN,
                                 friction ? def.a : NAN,
                                 friction ? def.mu : NAN,
                                 def.set_load,
                                 def.set_again,
                                 (double)h->k,
                                 (double)h->n,
                                 b->error.N_rms,
                                 b->error.N_max,
                                 b->error.H_ratio,
                                 b->friction,
                                 b->friction_diagonals,
                                 b->centre,
                                 b->dip,
                                 r->fault ? NAN : (double)r->negative_modes,
                                 r->smallest_pivot,
                                 r->residual,
                                 (double)r->contacts,
                                 (double)r->horizontal,
                                 (double)r->broken,
                                 (double)r->jumps,
                                 (double)o->leave,
                                 r->energy,
                                 r->released,
                                 rp_cpu_clock(),
                                 rp_peak_memory()},
                      statics_fault_text(r->fault));
}

static rp_status write_contacts(const options *o, const sweep_outline *h, const statics_pile *pile,
                                const statics_result *r)
{
    static const char *const columns[][2] = {
        {"a", ""},        {"b", ""},        {"x", "sigma"},     {"y", "sigma"},    {"x_b", "sigma"},
        {"y_b", "sigma"}, {"force", "m g"}, {"horizontal", ""}, {"strongest", ""}, {"weakest", ""}};
    char path[4096];
    FILE *out;
    statics_contact *list;
    size_t n;
    rp_status status = statics_contacts(pile, &list, &n);
    if (status) return status;
    snprintf(path, sizeof path, "%s/contacts.tsv", o->directory);
    status = rp_file_open(path, &out);
    if (!status) {
        write_header(out, o, h, r);
        rp_table_columns(out, 10, columns);
        for (const statics_contact *c = list; c < list + n; c++)
            rp_table_row(out, 10,
                         (double[]){(double)c->a + 1, (double)c->b + 1, c->x, c->y, c->x_b, c->y_b, c->force,
                                    c->horizontal, c->strongest, c->weakest});
        status = rp_file_close(path, out, RP_OK);
    }
    free(list);
    return status;
}

static rp_status write_disks(const options *o, const sweep_outline *h, const statics_pile *pile,
                             const statics_result *r)
{
    static const char *const columns[][2] = {{"id", ""},     {"x", "sigma"},       {"y", "sigma"},
                                             {"r", "sigma"}, {"u_x", "eps sigma"}, {"u_y", "eps sigma"}};
    char path[4096];
    FILE *out;
    double *u = malloc(2 * h->n * sizeof *u);
    if (!u) return no_memory();
    const double eps = r->eps;
    statics_displacements(pile, u);
    snprintf(path, sizeof path, "%s/disks.tsv", o->directory);
    rp_status status = rp_file_open(path, &out);
    if (!status) {
        write_header(out, o, h, r);
        rp_table_columns(out, 6, columns);
        for (size_t i = 0; i < h->n; i++)
            rp_table_row(out, 6,
                         (double[]){(double)i + 1, h->disks[i].x + eps * u[2 * i],
                                    h->disks[i].y + eps * u[2 * i + 1], h->disks[i].r, u[2 * i],
                                    u[2 * i + 1]});
        status = rp_file_close(path, out, RP_OK);
    }
    free(u);
    return status;
}

static rp_status write_wells(const options *o, const sweep_outline *h, const statics_pile *pile,
                             const statics_result *r)
{
    static const char *const columns[][2] = {{"disk", ""},           {"x", "sigma"}, {"x_0", "sigma"},
                                             {"x-x_0", "eps sigma"}, {"N", "m g"},   {"H", "m g"},
                                             {"state", ""}};
    static const char *const states[] = {
        [STATICS_WELL_HOLDS] = "holds", [STATICS_WELL_BROKEN] = "broken", [STATICS_WELL_ANEW] = "set_anew"};
    char path[4096];
    FILE *out;
    statics_well *wells = malloc((r->wells + 1) * sizeof *wells);
    if (!wells) return no_memory();
    statics_wells(pile, wells);
    snprintf(path, sizeof path, "%s/wells.tsv", o->directory);
    rp_status status = rp_file_open(path, &out);
    if (!status) {
        write_header(out, o, h, r);
        rp_table_note(out, "x_0", "where a well rests; of a broken one where it gave way");
        rp_table_columns(out, 7, columns);
        for (const statics_well *w = wells; w < wells + r->wells; w++) {
            const double x = h->disks[w->disk].x;
            rp_table_row_word(out, 6,
                              (double[]){(double)w->disk + 1, x + r->eps * w->x, x + r->eps * w->x_0,
                                         w->x - w->x_0, w->N, w->H},
                              states[w->state]);
        }
        status = rp_file_close(path, out, RP_OK);
    }
    free(wells);
    return status;
}

/* The tables of a pile. Without an equilibrium N and H are no result: those of the state where the solve was
 * given up are in the folder's tables alone. */
static rp_status write_tables(const options *o, sweep_outline *h, const statics_pile *pile,
                              const statics_result *r)
{
    const size_t k = r->wells;
    size_t *disk = malloc((k + 1) * sizeof *disk);
    double *N = malloc((2 * k + 1) * sizeof *N), *H = N ? N + k : NULL;
    base_summary b = {{NAN, NAN, NAN, NAN}, NAN, NAN, NAN, NAN};
    rp_status status = disk && N ? RP_OK : no_memory();
    if (!status) {
        statics_base(pile, disk, N, H);
        if (!r->fault) status = sum_up(h, disk, N, H, k, &b);
    }
    if (!status) {
        double most = 0;
        for (size_t i = 0; i < k; i++) most = fmax(most, N[i]);
        write_header(stdout, o, h, r);
        rp_table_note(stdout, "sinks", "%.3g sigma at most", r->eps * most);
        rp_table_note(stdout, "N_error", "%.3g rms, %.3g at most, relative to diagonals alone", b.error.N_rms,
                      b.error.N_max);
        rp_table_note(stdout, "H_ratio", "%.6g, the largest H over that of diagonals alone", b.error.H_ratio);
        if (o->summary)
            write_summary(o, h, r, &b);
        else if (!r->fault)
            write_base(h, disk, N, H, k);
    }
    free(disk);
    free(N);
    if (!status && *o->directory) {
        status = rp_make_directory(o->directory);
        if (!status) status = write_wells(o, h, pile, r);
        if (!status) status = write_contacts(o, h, pile, r);
        if (!status) status = write_disks(o, h, pile, r);
    }
    return status;
}

/* Options that would have no effect beside others. */
static rp_status check_idle(const options *o)
{
    const struct {
        const char *option;
        bool idle;
        const char *why;
    } idle[] = {{"base", *o->disks, "--disks says it all"},
                {"eps", o->linear, "--linear is the limit eps -> 0"},
                {"load-steps", o->linear, "--linear has no steps of the load"},
                {"leave", !o->branch || o->linear, "goes with --branch minimum, not with --linear"},
                {"branch", o->linear, "--linear has one state"},
                {"set-again", !(o->well > 0), "goes with --well"},
                {"mu", !(o->well > 0), "goes with --well"},
                {"seed", !(o->disorder > 0), "goes with --disorder"}};
    for (size_t i = 0; i < sizeof idle / sizeof *idle; i++)
        if (idle[i].idle && cli_given(&command, idle[i].option))
            return rp_fail(RP_USAGE, "--%s would do nothing: %s; see repose pile --help", idle[i].option,
                           idle[i].why);
    return RP_OK;
}

static rp_status check_usage(const options *o)
{
    const int tent = (o->outer_deg > 0) + (o->inner_deg > 0) + (o->x_1 > 0);
    if (tent % 3)
        return rp_fail(RP_USAGE, "a tent needs --outer-deg, --inner-deg and --x1; see repose pile --help");
    if ((o->alpha_deg > 0) + (tent > 0) + (*o->outline != 0) + (*o->disks != 0) > 1)
        return rp_fail(RP_USAGE,
                       "give one outline: --alpha-deg, a tent, --outline or --disks; see repose pile --help");
    if (o->k_x > 0 && o->well > 0) return rp_fail(RP_USAGE, "give --k-x or --well; see repose pile --help");
    if (o->threshold && (o->linear || o->branch || o->summary || *o->directory || *o->disks))
        return rp_fail(RP_USAGE,
                       "--threshold goes with an outline, wells and --eps alone; see repose pile --help");
    if ((o->disorder > 0 || o->gap > 0) && *o->disks)
        return rp_fail(RP_USAGE, "--disks says it all: no --disorder, no --gap; see repose pile --help");
    if (o->piles > 1 && (!(o->disorder > 0) || o->threshold || o->summary || *o->directory))
        return rp_fail(RP_USAGE, "--piles goes with --disorder and gives one table; see repose pile --help");
    return check_idle(o);
}

/* ---- Threshold of stability ---- */

static rp_status is_stable(const options *o, const sweep_outline *h, double eps, bool *stable)
{
    statics_pile *pile = NULL;
    statics_result result;
    statics_definition def = define(o, h);
    def.eps = eps;
    rp_status status = statics_create(&def, &pile);
    if (!status) status = statics_solve(pile, &result);
    if (!status) *stable = result.negative_modes == 0;
    statics_free(pile);
    return status;
}

/* eps_c by halving an interval that is first widened until it holds the threshold. */
static rp_status find_threshold(const options *o, const sweep_outline *h)
{
    static const char *const columns[][2] = {
        {"base", ""}, {"n_disks", ""}, {"eps_c", ""}, {"eps_c*base^3", ""}};
    const double PRECISION = 1e-4, WIDEN = 2, EPS_MAX = 0.1, k = (double)h->k;
    double lo = 0, hi = 0, eps = o->eps;
    while (!(lo > 0 && hi > 0 && hi / lo < 1 + PRECISION)) {
        bool stable = false;
        rp_status status = is_stable(o, h, eps, &stable);
        if (status == RP_NO_RESULT) {
            char why[1024];
            snprintf(why, sizeof why, "%s", rp_message());
            return rp_fail(status, "stable up to eps = %g; at eps = %g %s", lo, eps, why);
        }
        if (status) return status;
        *(stable ? &lo : &hi) = eps;
        if (!(lo < EPS_MAX)) return rp_fail(RP_NO_RESULT, "stable up to eps = %g: no threshold below", lo);
        eps = !(hi > 0) ? fmin(lo * WIDEN, EPS_MAX) : !(lo > 0) ? hi / WIDEN : sqrt(lo * hi);
    }
    cli_table(stdout, schema, o);
    rp_table_columns(stdout, 4, columns);
    rp_table_row(stdout, 4, (double[]){k, (double)h->n, lo, lo * k * k * k});
    return RP_OK;
}

/* One line on a terminal, drawn over and over, once it takes long. */
static void draw(size_t n, const statics_result *r, void *context)
{
    const double LONG = 1;
    const double elapsed = rp_clock() - *(double *)context;
    if (elapsed < LONG) return;
    fprintf(stderr, "\r%zu disks: step %zu, %zu factorisations, residual %.2g m g  %.0f s   ", n, r->steps,
            r->factored, r->residual, elapsed);
    fflush(stderr);
}

/* No failure: the primary state is what was asked for. */
static void tell_unstable(size_t modes)
{
    if (modes)
        fprintf(stderr, "repose pile: unstable: %zu negative mode%s; --branch minimum seeks a stable state\n",
                modes, modes == 1 ? "" : "s");
}

static rp_status solve(const options *o, sweep_outline *h)
{
    statics_pile *pile = NULL;
    statics_result result;
    double start = rp_clock();
    statics_definition def = define(o, h);
    def.watch = isatty(STDERR_FILENO) ? draw : NULL;
    def.context = &start;
    rp_status status = statics_create(&def, &pile);
    if (status) return status;
    status = statics_solve(pile, &result);
    if (def.watch) fputs("\r\033[K", stderr);
    if (!status || status == RP_NO_RESULT) {
        char why[1024];
        snprintf(why, sizeof why, "%s", rp_message());
        if (!status) tell_unstable(result.negative_modes);
        rp_status written = write_tables(o, h, pile, &result);
        status = status ? rp_fail(status, "%s", why) : written;
    }
    statics_free(pile);
    return status;
}

/* ---- An ensemble of unequal disks ---- */

/* N and H of pile number `run` at its base disks i, to N[i * piles + column], and the same of H. */
static rp_status solve_one(const options *o, sweep_outline *h, unsigned long run, size_t column, double *N,
                           double *H, size_t *unstable)
{
    statics_pile *pile = NULL;
    statics_result result;
    double *base = malloc(2 * h->k * sizeof *base);
    rp_status status =
        base ? sweep_outline_disorder(h, o->disorder, (unsigned long)o->seed, run) : no_memory();
    const statics_definition def = define(o, h);
    if (!status) status = statics_create(&def, &pile);
    if (!status) status = statics_solve(pile, &result);
    if (!status) statics_base(pile, NULL, base, base + h->k);
    for (size_t i = 0; !status && i < h->k; i++) {
        N[i * (size_t)o->piles + column] = base[i];
        H[i * (size_t)o->piles + column] = base[h->k + i];
    }
    *unstable += !status && result.negative_modes;
    statics_free(pile);
    free(base);
    return status;
}

static rp_status write_means(const options *o, const sweep_outline *h, size_t solved, size_t unstable,
                             const double *N, const double *H)
{
    static const char *const columns[][2] = {
        {"i", ""},
        {"x/B", ""},
        {"N/mg", ""},
        {"N_se/mg", ""},
        {"H/mg", ""},
        {"H_se/mg", ""},
        {"N_diagonals/mg", ""},
        {"H_diagonals/mg", ""},
        {"N/(chi*g*B)", ""},
        {"N_se/(chi*g*B)", ""},
        {"H/(chi*g*B)", ""},
        {"H_se/(chi*g*B)", ""},
    };
    const size_t piles = (size_t)o->piles;
    cli_table(stdout, schema, o);
    rp_table_note(stdout, "n_disks", "%zu", h->n);
    rp_table_note(stdout, "B", "%.17g sigma", h->B);
    rp_table_note(stdout, "solved", "%zu of %zu piles, %zu of them unstable", solved, piles, unstable);
    rp_table_columns(stdout, 12, columns);
    rp_status status = RP_OK;
    for (size_t i = 0; !status && i < h->k; i++) {
        stats_summary n, f;
        status = stats_mean(solved, N + i * piles, &n);
        if (!status) status = stats_mean(solved, H + i * piles, &f);
        const double x = 0.5 + ((double)i - ((double)h->k - 1) / 2) * (1 + o->gap) / h->B;
        if (!status)
            rp_table_row(stdout, 12,
                         (double[]){(double)i + 1, x, n.mean, n.se, f.mean, f.se, h->exact[i].N,
                                    h->exact[i].H, n.mean / h->B, n.se / h->B, f.mean / h->B, f.se / h->B});
    }
    return status;
}

/* Means over the piles that have an equilibrium; the others are told on the way. */
static rp_status solve_ensemble(const options *o, sweep_outline *h)
{
    const size_t room = h->k * (size_t)o->piles;
    double *N = malloc(2 * room * sizeof *N);
    size_t solved = 0, unstable = 0;
    rp_status status = N ? RP_OK : no_memory();
    for (long run = 0; !status && run < o->piles; run++) {
        status = solve_one(o, h, (unsigned long)run, solved, N, N + room, &unstable);
        if (!status) solved++;
        if (status != RP_NO_RESULT) continue;
        fprintf(stderr, "pile %ld: %s\n", run, rp_message());
        status = RP_OK;
    }
    if (!status && !solved) status = rp_fail(RP_NO_RESULT, "none of %ld piles has an equilibrium", o->piles);
    if (!status) status = write_means(o, h, solved, unstable, N, N + room);
    if (unstable)
        fprintf(stderr, "repose pile: unstable: %zu of %zu piles; --branch minimum seeks stable states\n",
                unstable, solved);
    free(N);
    return status;
}

static rp_status solve_any(const void *values)
{
    const options *o = values;
    rp_status status = check_usage(o);
    if (status) return status;
    sweep_outline h = {0};
    status = *o->disks ? read_disks(o->disks, &h) : make_outline(o, &h);
    if (!status && o->piles > 1)
        status = solve_ensemble(o, &h);
    else if (!status) {
        if (o->disorder > 0) status = sweep_outline_disorder(&h, o->disorder, (unsigned long)o->seed, 0);
        if (!status) status = o->threshold ? find_threshold(o, &h) : solve(o, &h);
    }
    sweep_outline_free(&h);
    return status;
}

rp_status cmd_pile(int argc, char **argv)
{
    options o;
    return cli_plain(&command, argc, argv, &o, solve_any);
}
