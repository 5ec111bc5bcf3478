/* repose pile: static equilibrium of a pile of soft disks, and its forces on the base. Its options are the
 * parameters of protocol `pile` (sweeps/driver/pile.h), with a dash for an underline, and those below. */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "analytic/analytic.h"
#include "stats/stats.h"
#include "cli/cli.h"
#include "core/clock.h"
#include "sweeps/driver/pile.h"

typedef struct {
    sweep_pile pile;
    long seed, piles;
    bool summary;
    const char *outline, *disks, *directory;
} options;

static const rp_param own[] = {
    {"outline", "", RP_TEXT, offsetof(options, outline), "", "",
     "a polygon: table with columns x, y of its vertices from left to right, in any unit"},
    {"disks", "", RP_TEXT, offsetof(options, disks), "", "",
     "any disks: table with columns x, y of their centres and, if not 0.5, r (sigma)"},
    {"seed", "", RP_INT, offsetof(options, seed), "1", "[0, 2147483647]", "of the z of --disorder"},
    {"piles", "", RP_INT, offsetof(options, piles), "1", "[1, 1000000]",
     "with --disorder: mean over so many piles and its standard error"},
    {"summary", "", RP_BOOL, offsetof(options, summary), "false", "",
     "one row for the pile, not one a base disk: parameters and results of protocol `pile`"},
    {"o", "", RP_TEXT, offsetof(options, directory), "", "",
     "folder for base.tsv, wells.tsv, contacts.tsv and disks.tsv, the last three also without an "
     "equilibrium"},
};

/* The protocol's parameters, then the command's own. */
enum { MOST = 40, NAME = 24 };
static rp_param schema[MOST];
static char dashed[MOST][NAME];

static void make_schema(void)
{
    size_t n = 0;
    for (const rp_param *p = sweep_pile_schema; p->name; p++, n++) {
        schema[n] = *p;
        schema[n].offset += offsetof(options, pile);
        snprintf(dashed[n], NAME, "%s", p->name);
        for (char *c = dashed[n]; *c; c++)
            if (*c == '_') *c = '-';
        schema[n].name = dashed[n];
    }
    memcpy(&schema[n], own, sizeof own);
}

static rp_status no_memory(void)
{
    return rp_fail(RP_NO_MEMORY, "pile: out of memory");
}

/* ---- Outlines ---- */

static rp_status read_outline(const char *path, an_point **v, size_t *n)
{
    double *block = NULL;
    rp_status status = cli_read_file(path, "x,y", &block, n);
    *v = status ? NULL : malloc((*n + 1) * sizeof **v);
    if (!status && !*v) status = no_memory();
    for (size_t i = 0; !status && i < *n; i++) (*v)[i] = (an_point){block[i], block[*n + i]};
    free(block);
    return status;
}

static rp_status make_outline(const options *o, sweep_outline *h)
{
    an_point *v = NULL;
    size_t n = 0;
    if (!*o->outline) return sweep_pile_outline(&o->pile, (unsigned long)o->seed, 0, h);
    rp_status status = read_outline(o->outline, &v, &n);
    if (!status) status = sweep_outline_make(h, o->pile.base, o->pile.gap, 0, n, v);
    if (!status && o->pile.disorder > 0)
        status = sweep_outline_disorder(h, o->pile.disorder, (unsigned long)o->seed, 0);
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

/* ---- Output ---- */

static const options *chosen; /* for the header of each table */

static void write_header(FILE *out)
{
    cli_table(out, schema, chosen);
}

/* One row: parameters, results, status. */
static void write_summary(const options *o, const sweep_result *results)
{
    const char *columns[MOST + SWEEP_MAX_OUTPUTS + 1][2] = {{0}};
    char text[64];
    size_t n = 0, n_outputs = 0;
    for (const rp_param *p = sweep_pile_schema; p->name; p++, n++)
        columns[n][0] = p->name, columns[n][1] = p->unit;
    for (const sweep_output *p = sweep_protocol_pile.outputs; p->name; p++, n++, n_outputs++)
        columns[n][0] = p->name, columns[n][1] = p->unit;
    columns[n][0] = "status", columns[n][1] = "";
    rp_table_note(stdout, "cost", "%.3g s, %.4g MB", rp_cpu_clock(), rp_peak_memory());
    rp_table_columns(stdout, n + 1, (const char *const(*)[2])columns);
    for (const rp_param *p = sweep_pile_schema; p->name; p++)
        printf("%s\t", *rp_params_text(p, &o->pile, text, sizeof text) ? text : "nan");
    rp_table_row_word(stdout, n_outputs, results->values, results->status);
}

/* The tables of a pile. Without an equilibrium N and H are no result: those of the state where the solve was
 * given up are in the folder's tables alone. */
static rp_status write_tables(const options *o, const sweep_solved *s, const sweep_result *results)
{
    write_header(stdout);
    sweep_pile_notes(s, stdout);
    if (o->summary)
        write_summary(o, results);
    else if (!s->r.fault)
        sweep_pile_write_base(s, stdout);
    return *o->directory
               ? sweep_pile_write(s, &(sweep_tables){.directory = o->directory, .header = write_header})
               : RP_OK;
}

/* Options that would have no effect beside others. */
static rp_status check_idle(const options *o)
{
    const sweep_pile *p = &o->pile;
    const bool linear = !(p->eps > 0), from_file = *o->outline || *o->disks;
    const struct {
        const char *option;
        bool idle;
        const char *why;
    } idle[] = {{"base", *o->disks, "--disks says it all"},
                {"gap", *o->disks, "--disks says it all"},
                {"disorder", *o->disks, "--disks says it all"},
                {"alpha-deg", from_file, "the file says it"},
                {"inner-deg", from_file, "the file says it"},
                {"x-1", !(p->inner_deg > 0), "goes with --inner-deg"},
                {"load-steps", linear, "eps = 0 has no steps of the load"},
                {"leave", !p->branch || linear, "goes with --branch minimum and eps > 0"},
                {"branch", linear, "eps = 0 has one state"},
                {"k-x", p->well > 0, "goes without --well"},
                {"set-again", !(p->well > 0), "goes with --well"},
                {"mu", !(p->well > 0), "goes with --well"},
                {"seed", !(p->disorder > 0), "goes with --disorder"}};
    for (size_t i = 0; i < sizeof idle / sizeof *idle; i++)
        if (idle[i].idle && cli_given(idle[i].option))
            return rp_fail(RP_USAGE, "--%s would do nothing: %s; see repose pile --help", idle[i].option,
                           idle[i].why);
    return RP_OK;
}

static rp_status check_usage(const options *o)
{
    const sweep_pile *p = &o->pile;
    if (*o->outline && *o->disks)
        return rp_fail(RP_USAGE, "give --outline or --disks, not both; see repose pile --help");
    if (p->threshold && (!(p->eps > 0) || p->branch || *o->directory || *o->disks))
        return rp_fail(RP_USAGE,
                       "--threshold goes with an outline, wells and --eps alone; see repose pile --help");
    if (o->piles > 1 && (!(p->disorder > 0) || p->threshold || o->summary || *o->directory))
        return rp_fail(RP_USAGE, "--piles goes with --disorder and gives one table; see repose pile --help");
    return check_idle(o);
}

static rp_status find_threshold(const options *o, const sweep_outline *h)
{
    sweep_result results;
    rp_status status = sweep_pile_threshold(&o->pile, h, &results);
    if (status) return status;
    write_header(stdout);
    write_summary(o, &results);
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

static rp_status solve(const options *o, const sweep_outline *h)
{
    sweep_solved s;
    sweep_result results;
    double start = rp_clock();
    const bool watched = isatty(STDERR_FILENO);
    rp_status status = sweep_pile_solve(&o->pile, h, watched ? draw : NULL, &start, &s, &results);
    if (watched) fputs("\r\033[K", stderr);
    if (!status) tell_unstable(s.r.negative_modes);
    if (!status || status == RP_NO_RESULT) {
        rp_status written = write_tables(o, &s, &results);
        status = status ? rp_fail(status, "%s", results.message) : written;
    }
    sweep_solved_free(&s);
    return status;
}

/* ---- An ensemble of unequal disks ---- */

/* N and H of pile number `run` at its base disks i, to N[i * piles + column], and the same of H. */
static rp_status solve_one(const options *o, sweep_outline *h, unsigned long run, size_t column, double *N,
                           double *H, size_t *unstable)
{
    sweep_solved s = {0};
    sweep_result results;
    rp_status status = sweep_outline_disorder(h, o->pile.disorder, (unsigned long)o->seed, run);
    if (!status) status = sweep_pile_solve(&o->pile, h, NULL, NULL, &s, &results);
    for (size_t i = 0; !status && i < h->k; i++) {
        N[i * (size_t)o->piles + column] = s.N[i];
        H[i * (size_t)o->piles + column] = s.H[i];
    }
    *unstable += !status && s.r.negative_modes;
    sweep_solved_free(&s);
    return status;
}

static rp_status write_means(const options *o, const sweep_outline *h, size_t solved, size_t unstable,
                             const double *N, const double *H)
{
    const size_t piles = (size_t)o->piles;
    write_header(stdout);
    rp_table_note(stdout, "n_disks", "%zu", h->n);
    rp_table_note(stdout, "B", "%.17g sigma", h->B);
    rp_table_note(stdout, "solved", "%zu of %zu piles, %zu of them unstable", solved, piles, unstable);
    rp_table_header(stdout,
                    "i, x/B, N/mg, N_se/mg, H/mg, H_se/mg, N_diagonals/mg, H_diagonals/mg, N/(chi*g*B), "
                    "N_se/(chi*g*B), H/(chi*g*B), H_se/(chi*g*B)");
    rp_status status = RP_OK;
    for (size_t i = 0; !status && i < h->k; i++) {
        stats_summary n, f;
        status = stats_mean(solved, N + i * piles, &n);
        if (!status) status = stats_mean(solved, H + i * piles, &f);
        const double x = 0.5 + ((double)i - ((double)h->k - 1) / 2) * (1 + o->pile.gap) / h->B;
        if (!status)
            CLI_ROW((double)i + 1, x, n.mean, n.se, f.mean, f.se, h->exact[i].N, h->exact[i].H, n.mean / h->B,
                    n.se / h->B, f.mean / h->B, f.se / h->B);
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
    options o = *(const options *)values;
    chosen = &o;
    rp_status status = check_usage(&o);
    if (status) return status;
    sweep_outline h = {0};
    status = *o.disks ? read_disks(o.disks, &h) : make_outline(&o, &h);
    if (*o.disks || *o.outline) o.pile.alpha_deg = -1; /* the parameters do not describe it */
    if (!status)
        status = o.piles > 1        ? solve_ensemble(&o, &h)
                 : o.pile.threshold ? find_threshold(&o, &h)
                                    : solve(&o, &h);
    sweep_outline_free(&h);
    return status;
}

static const cli_command command = {
    "pile",
    "static equilibrium of a close-packed pile of soft disks",
    "[--base K] [--alpha-deg A [--inner-deg A --x-1 X] | --outline FILE | --disks FILE] [--eps E]\n       "
    "[--k-x K | --well A [--mu MU]] [--branch primary|minimum [--leave N]]\n       [--disorder S [--seed N] "
    "[--piles N]] [--summary | --threshold] [-o DIR]",
    "Static equilibrium of soft frictionless disks, close-packed on a flat base: the computer model of\n"
    "Liffman, Chan & Hughes 1992 at rest. Row i is base disk i from the left. N is the normal force of\n"
    "the ground on the disk, H the horizontal force of the disk on the ground, positive to the right.\n"
    "Further columns: N and H of diagonal contacts alone, the exact limit of hard disks in which no\n"
    "contact within a row closes; N and H in chi g B, as in `repose continuum`. negative_modes in the\n"
    "header counts the unstable directions. An unstable primary state is a result all the same: exit\n"
    "status 0, with a note on standard error.\n"
    "\n"
    "Without an equilibrium: exit status 1, a message that names disks and wells, and one of these\n"
    "statuses. The tables of -o then hold the last state of the solver.\n"
    "  spreads        wells broke, and neighbours slid apart\n"
    "  collapses      neighbours slid apart although no well broke: toppled, or disks or springs too soft\n"
    "  creeps         with --set-again: wells are set anew without end\n"
    "  meets          disks overlap that were no neighbours\n"
    "  not_converged  the solver did not converge\n"
    "  singular       an equilibrium in which a disk can move freely, or none found for such a disk",
    "repose pile --alpha-deg 30 --base 45",
    schema,
    .act = solve_any};

static rp_status run(int argc, char **argv)
{
    make_schema();
    return cli_run(&command, argc, argv);
}

const cli_command cmd_pile = {"pile", "static equilibrium of a close-packed pile of soft disks", .run = run};
