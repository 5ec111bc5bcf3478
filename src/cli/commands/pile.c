/* repose pile: static equilibrium of a pile of soft disks, and its forces on the base. Its options are the
 * parameters of protocol `pile` (sweeps/protocols/pile.h), with a dash for an underline, and those below. */
#include <unistd.h>

#include "analytic/analytic.h"
#include "stats/stats.h"
#include "cli/cli.h"
#include "core/folder.h"
#include "core/clock.h"
#include "sweeps/protocols/pile.h"

#define OWN_OPTIONS(X)                                                                                       \
    X(TEXT, outline, "", "", "",                                                                             \
      "a polygon: table with columns x, y of its vertices from left to right, in any unit")                  \
    X(TEXT, disks, "", "", "",                                                                               \
      "any disks: table with columns x, y of their centres and, if not 0.5, r (sigma)")                      \
    X(INT, seed, "", "1", "[0, 2147483647]", "of the z of --disorder")                                       \
    X(INT, piles, "", "1", "[1, 1000000]",                                                                   \
      "with --disorder: mean over so many piles and its standard error")                                     \
    X(BOOL, summary, "", "false", "",                                                                        \
      "one row for the pile, not one a base disk: parameters and results of protocol `pile`")                \
    X(TEXT, o, "", "", "",                                                                                   \
      "folder for base.tsv, wells.tsv, contacts.tsv and disks.tsv, the last three also without an "          \
      "equilibrium")                                                                                         \
    CLI_FORCE(X)

CLI_OPTIONS(own, OWN_OPTIONS)

/* The protocol's parameters, then the command's own. */
typedef struct {
    sweep_pile pile;
    own_options own;
} options;

/* ---- Outlines ---- */

static rp_status make_outline(rp_arena *arena, const options *o, sweep_outline *h)
{
    double *x;
    size_t n = 0;
    if (!*o->own.outline) return sweep_pile_outline(&o->pile, (unsigned long)o->own.seed, 0, h);
    RP_TRY(rp_columns_read_file(arena, o->own.outline, "x,y", &x, &n));
    an_point *v = rp_arena_memory(arena, n, sizeof *v);
    for (size_t i = 0; i < n; i++) v[i] = (an_point){x[i], x[n + i]};
    RP_TRY(sweep_outline_make(h, o->pile.base, o->pile.gap, 0, n, v));
    if (!(o->pile.disorder > 0)) return RP_OK;
    return sweep_outline_disorder(h, o->pile.disorder, (unsigned long)o->own.seed, 0);
}

static rp_status read_disks(rp_arena *arena, const char *path, sweep_outline *h)
{
    rp_table *table;
    double *x;
    RP_TRY(rp_table_load(arena, path, &table));
    const bool radii = rp_table_column(table, "r") >= 0;
    RP_TRY(rp_columns_read(arena, table, radii ? "x,y,r" : "x,y", &x));
    char unused[256];
    rp_columns_beside(table, ",id,x,y,r,", unused);
    if (*unused) fprintf(stderr, "repose pile: %s: not used:%s\n", path, unused);
    h->n = table->n_rows;
    RP_NEW(&h->memory, h->disks, h->n);
    for (size_t i = 0; i < h->n; i++) {
        const double *y = x + h->n, r = radii ? y[h->n + i] : 0.5;
        h->disks[i] = (statics_disk){x[i], y[i], r, 4 * r * r};
    }
    h->B = NAN;
    return RP_OK;
}

/* ---- Output ---- */

/* One row: parameters, results, status. */
static void write_summary(const cli_call *call, const options *o, const sweep_result *results)
{
    rp_table_note(call->out, "cost", "%.3g s, %.4g MB", rp_cpu_clock(), rp_peak_memory());
    cli_result_row(call, sweep_pile_schema, &o->pile, sweep_protocol_pile.outputs, results);
}

static void put_header(const void *call, rp_units units, FILE *out)
{
    (void)units;
    cli_table(call, out);
}

/* Options that would have no effect beside others. */
static rp_status check_idle(const cli_call *call, const options *o)
{
    const sweep_pile *p = &o->pile;
    const bool linear = !(p->eps > 0), from_file = *o->own.outline || *o->own.disks;
    const struct {
        const char *option;
        bool idle;
        const char *why;
    } idle[] = {{"base", *o->own.disks, "--disks says it all"},
                {"gap", *o->own.disks, "--disks says it all"},
                {"disorder", *o->own.disks, "--disks says it all"},
                {"alpha-deg", from_file, "the file says it"},
                {"inner-deg", from_file, "the file says it"},
                {"x-1", !(p->inner_deg > 0), "it needs --inner-deg"},
                {"load-steps", linear, "eps = 0 has no steps of the load"},
                {"leave", !p->branch || linear, "it needs --branch minimum and eps > 0"},
                {"branch", linear, "eps = 0 has one state"},
                {"k-x", p->well > 0, "--well sets the stiffness"},
                {"set-again", !(p->well > 0), "it needs --well"},
                {"mu", !(p->well > 0), "it needs --well"},
                {"seed", !(p->disorder > 0), "it needs --disorder"}};
    for (size_t i = 0; i < N_OF(idle); i++)
        if (idle[i].idle && cli_given(call, idle[i].option))
            return rp_fail(RP_USAGE, "--%s would do nothing: %s; see repose pile --help", idle[i].option,
                           idle[i].why);
    return RP_OK;
}

static rp_status check_usage(const cli_call *call, const options *o)
{
    const sweep_pile *p = &o->pile;
    if (*o->own.outline && *o->own.disks)
        return rp_fail(RP_USAGE, "give --outline or --disks, not both; see repose pile --help");
    if (p->threshold && (!(p->eps > 0) || p->branch || *o->own.o || *o->own.disks))
        return rp_fail(
            RP_USAGE,
            "--threshold can't be combined with --%s; it allows the outline, the wells and --eps > 0",
            p->branch       ? "branch"
            : *o->own.o     ? "o"
            : *o->own.disks ? "disks"
                            : "eps 0");
    if (o->own.piles > 1 && (!(p->disorder > 0) || p->threshold || o->own.summary || *o->own.o))
        return rp_fail(RP_USAGE,
                       "--piles needs --disorder, and can't be combined with --threshold, --summary or -o");
    return check_idle(call, o);
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

static rp_status solve(const cli_call *call, options *o, sweep_outline *h)
{
    RP_ENDS(sweep_solved_free) sweep_solved s = {0};
    sweep_result results;
    double start = rp_clock();
    const bool watched = isatty(STDERR_FILENO);
    RP_ENDS(rp_folder_end) rp_folder f = {0};
    if (*o->own.o) RP_TRY(rp_folder_begin(call->arena, o->own.o, call->line, o->own.force, &f));
    if (f.part) RP_TRY(rp_folder_clear(&f));
    rp_status status = sweep_pile_solve(&o->pile, h, watched ? draw : NULL, &start, &s, &results);
    if (watched) fputs("\r\033[K", stderr);
    if (*o->own.disks) o->pile.base = (long)s.r.wells;
    if (!status && s.r.negative_modes) /* no failure: the primary state is what was asked for */
        fprintf(stderr, "repose pile: unstable: %zu negative mode%s; --branch minimum seeks a stable state\n",
                s.r.negative_modes, s.r.negative_modes == 1 ? "" : "s");
    if (!status || status == RP_NO_RESULT) {
        cli_table(call, call->out);
        sweep_pile_notes(&s, call->out);
        /* without an equilibrium N and H are no result: those of the state where the solve was given up are
         * in the folder's tables alone */
        if (o->own.summary)
            write_summary(call, o, &results);
        else if (!s.r.fault)
            sweep_pile_write_base(&s, call->out);
        const sweep_tables tables = {.directory = f.part, .header = put_header, .context = call};
        if (f.part) RP_TRY(sweep_pile_write(&s, &tables));
        if (f.part) RP_TRY(rp_folder_publish(&f));
        return status ? rp_fail(status, "%s", results.message) : RP_OK;
    }
    return status;
}

/* Piles: how many, those with an equilibrium, and of these the unstable ones; N and H[disk][pile]. */
typedef struct {
    size_t piles, solved, unstable;
    double *N, *H;
} ensemble;

static void write_means(const cli_call *call, const options *o, const sweep_outline *h, const ensemble *e)
{
    cli_table(call, call->out);
    rp_table_note(call->out, "n_disks", "%zu", h->n);
    rp_table_note_number(call->out, "B", h->B, "sigma");
    rp_table_note(call->out, "solved", "%zu of %zu piles, %zu of them unstable", e->solved, e->piles,
                  e->unstable);
    rp_table_header(call->out, call->units,
                    "i, x/B, N/mg, N_se/mg, H/mg, H_se/mg, N_diagonals/mg, H_diagonals/mg, N/(chi*g*B), "
                    "N_se/(chi*g*B), H/(chi*g*B), H_se/(chi*g*B)");
    for (size_t i = 0; i < h->k; i++) {
        stats_summary n, f;
        stats_mean(e->solved, e->N + i * e->piles, &n);
        stats_mean(e->solved, e->H + i * e->piles, &f);
        const double x = 0.5 + ((double)i - ((double)h->k - 1) / 2) * (1 + o->pile.gap) / h->B;
        CLI_ROW((double)i + 1, x, n.mean, n.se, f.mean, f.se, h->exact[i].N, h->exact[i].H, n.mean / h->B,
                n.se / h->B, f.mean / h->B, f.se / h->B);
    }
}

/* An ensemble of unequal disks; piles without an equilibrium are told on the way. */
static rp_status solve_ensemble(const cli_call *call, options *o, sweep_outline *h)
{
    ensemble e = {.piles = (size_t)o->own.piles};
    e.N = rp_arena_memory(call->arena, 2 * h->k * e.piles, sizeof *e.N);
    e.H = e.N + h->k * e.piles;
    for (size_t run = 0; run < e.piles; run++) {
        RP_ENDS(sweep_solved_free) sweep_solved s = {0};
        sweep_result results;
        rp_status status = sweep_outline_disorder(h, o->pile.disorder, (unsigned long)o->own.seed, run);
        if (!status) status = sweep_pile_solve(&o->pile, h, NULL, NULL, &s, &results);
        for (size_t i = 0; !status && i < h->k; i++) {
            e.N[i * e.piles + e.solved] = s.N[i];
            e.H[i * e.piles + e.solved] = s.H[i];
        }
        e.unstable += !status && s.r.negative_modes;
        e.solved += !status;
        if (status && status != RP_NO_RESULT) return status;
        if (status) fprintf(stderr, "pile %zu: %s\n", run, rp_message());
    }
    if (!e.solved) return rp_fail(RP_NO_RESULT, "none of %zu piles has an equilibrium", e.piles);
    write_means(call, o, h, &e);
    if (e.unstable)
        fprintf(stderr, "repose pile: unstable: %zu of %zu piles; --branch minimum seeks stable states\n",
                e.unstable, e.solved);
    return RP_OK;
}

static rp_status solve_any(cli_call *call, const void *values)
{
    options *o = call->values; /* the header has the pile that is solved */
    (void)values;
    RP_TRY(check_usage(call, o));
    RP_ENDS(sweep_outline_free) sweep_outline h = {0};
    RP_TRY(*o->own.disks ? read_disks(call->arena, o->own.disks, &h) : make_outline(call->arena, o, &h));
    /* what the parameters do not describe */
    if (*o->own.disks || *o->own.outline) o->pile.alpha_deg = -1;
    if (*o->own.disks) o->pile.gap = o->pile.disorder = NAN;
    if (!o->pile.threshold) return (o->own.piles > 1 ? solve_ensemble : solve)(call, o, &h);
    sweep_result results;
    RP_TRY(sweep_pile_threshold(&o->pile, &h, &results));
    cli_table(call, call->out);
    return write_summary(call, o, &results), RP_OK;
}

const cli_command cmd_pile = {
    "pile",
    "static equilibrium of a close-packed pile of soft disks",
    "[--base K] [--alpha-deg A [--inner-deg A --x-1 X] | --outline FILE | --disks FILE] [--eps E] "
    "[--k-x K | --well A [--mu MU]] [--branch primary|minimum [--leave N]] [--disorder S [--seed N] "
    "[--piles N]] [--summary | --threshold] [-o DIR [--force]]",
    "Static equilibrium of soft frictionless disks, close-packed on a flat base: the computer model of "
    "Liffman, Chan & Hughes 1992 at rest. Row i is base disk i from the left. N is the normal force of the "
    "ground on the disk, H the horizontal force of the disk on the ground, positive to the right. Further "
    "columns: N and H of diagonal contacts alone, the exact limit of hard disks in which no contact within a "
    "row closes; N and H in chi g B, as in `repose continuum`. negative_modes in the header counts the "
    "unstable directions. An unstable primary state is a result all the same: exit status 0, with a note on "
    "standard error.\n"
    "\n"
    "Without an equilibrium: exit status 1, a message that names disks and wells, and one of these statuses. "
    "The tables of -o then hold the last state of the solver.\n"
    "  spreads        wells broke, and neighbours slid apart\n"
    "  collapses      neighbours slid apart although no well broke: toppled, or disks or springs too soft\n"
    "  creeps         with --set-again: wells are set anew without end\n"
    "  meets          disks overlap that were no neighbours\n"
    "  not_converged  the solver did not converge\n"
    "  singular       an equilibrium in which a disk can move freely, or none found for such a disk",
    "repose pile --alpha-deg 30 --base 45",
    own_params,
    .refuses = "An option that would do nothing beside the others; the message says which it needs.\n"
               "A folder with a finished result: give another one, or --force.\n"
               "--threshold with --branch, --disks, -o or eps = 0; --piles without --disorder, or with "
               "--threshold, --summary or -o.",
    .act = solve_any,
    .protocol = sweep_pile_schema,
    .protocol_size = offsetof(options, own)};
