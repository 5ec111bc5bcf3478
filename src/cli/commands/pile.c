/* repose pile: static equilibrium of a pile of soft disks, and its forces on the base. Its options are the
 * parameters of protocol `pile` (sweeps/protocols/pile.h), with a dash for an underline, and those below. */
#include <unistd.h>

#include "cli/cli.h"
#include "core/folder.h"
#include "core/clock.h"
#include "sweeps/protocols/pile.h"

#define OWN_OPTIONS(X)                                                                                       \
    X(INT, seed, "", "1", "[0, 2147483647]", "seed of the z of --disorder")                                  \
    X(BOOL, summary, "", "false", "",                                                                        \
      "print one row for the pile instead of one for each base disk, with parameters and results of "        \
      "protocol `pile`")                                                                                     \
    X(TEXT, o, "", "", "",                                                                                   \
      "folder for base.tsv, wells.tsv, contacts.tsv and disks.tsv, the last three also without an "          \
      "equilibrium")                                                                                         \
    CLI_FORCE(X, "replace a finished result in the folder")

CLI_OPTIONS(own, OWN_OPTIONS)

/* The protocol's parameters, then the command's own. */
typedef struct {
    sweep_pile pile;
    own_options own;
} options;

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
    const bool linear = !(p->eps > 0);
    const struct {
        const char *option;
        bool idle;
        const char *why;
    } idle[] = {{"x-1", !(p->inner_deg > 0), "it needs --inner-deg"},
                {"load-steps", linear, "eps = 0 has no steps of the load"},
                {"leave", !p->branch || linear, "it needs --branch minimum and eps > 0"},
                {"branch", linear, "eps = 0 has one state"},
                {"k-x", p->well > 0, "--well sets the stiffness"},
                {"set-again", !(p->well > 0), "it needs --well"},
                {"mu", !(p->well > 0), "it needs --well"},
                {"seed", !(p->disorder > 0), "it needs --disorder"}};
    for (size_t i = 0; i < N_OF(idle); i++)
        if (idle[i].idle && cli_given(call, idle[i].option))
            return rp_fail(RP_USAGE, "--%s has no effect: %s; see repose pile --help", idle[i].option,
                           idle[i].why);
    return RP_OK;
}

static rp_status check_usage(const cli_call *call, const options *o)
{
    const sweep_pile *p = &o->pile;
    if (p->threshold && (!(p->eps > 0) || p->branch || *o->own.o))
        return rp_fail(
            RP_USAGE,
            "--threshold can't be combined with --%s; it allows the outline, the wells and --eps > 0",
            p->branch   ? "branch"
            : *o->own.o ? "o"
                        : "eps 0");
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

static rp_status solve(const cli_call *call, const options *o, sweep_outline *h)
{
    RP_ENDS(sweep_solved_free) sweep_solved s = {0};
    sweep_result results;
    double start = rp_clock();
    const bool watched = isatty(STDERR_FILENO);
    RP_ENDS(rp_folder_end) rp_folder f = {0};
    if (*o->own.o) RP_TRY(rp_folder_begin(call->arena, o->own.o, call->line, o->own.force, &f));
    rp_status status = sweep_pile_solve(&o->pile, h, watched ? draw : NULL, &start, &s, &results);
    if (watched) fputs("\r\033[K", stderr);
    if (!status && s.r.negative_modes) /* no failure: the primary state is what was asked for */
        cli_say("repose pile: unstable: %zu negative mode%s; --branch minimum seeks a stable state",
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

static rp_status solve_any(cli_call *call, const void *values)
{
    const options *o = values;
    RP_TRY(check_usage(call, o));
    RP_ENDS(sweep_outline_free) sweep_outline h = {0};
    RP_TRY(sweep_pile_outline(&o->pile, (unsigned long)o->own.seed, 0, &h));
    if (!o->pile.threshold) return solve(call, o, &h);
    sweep_result results;
    RP_TRY(sweep_pile_threshold(&o->pile, &h, &results));
    cli_table(call, call->out);
    return write_summary(call, o, &results), RP_OK;
}

const cli_command cmd_pile = {
    "pile",
    "find the static equilibrium of a close-packed pile of soft disks",
    "[--base K] [--alpha-deg A [--inner-deg A --x-1 X]] [--eps E] [--k-x K | --well A [--mu MU]] [--branch "
    "primary|minimum [--leave N]] [--disorder S [--seed N]] [--summary | --threshold] [-o DIR [--force]]",
    "Static equilibrium of soft frictionless disks, close-packed on a flat base: the computer model of "
    "Liffman, Chan & Hughes 1992 at rest. Row i is base disk i from the left. N is the normal force of the "
    "ground on the disk, and H the horizontal force of the disk on the ground, positive to the right. "
    "Further columns have N and H of diagonal contacts alone, which is the exact limit of hard disks in "
    "which no contact within a row closes, and N and H in chi g B, as in `repose continuum`. negative_modes "
    "in the header counts the unstable directions. An unstable primary state is also a result: the exit "
    "status is 0, with a note on standard error.\n"
    "\n"
    "sigma and m are the mean diameter and mass of a disk, K_s is the stiffness of a contact, and B the "
    "width of the base. A well is the elastic range of static friction under a disk of the base, about its "
    "position x_0.\n"
    "\n"
    "Without an equilibrium the exit status is 1, and a message names disks, wells and one of these "
    "statuses. The tables of -o then hold the last state of the solver.\n"
    "  spreads        wells broke, and neighbours slid apart\n"
    "  collapses      neighbours slid apart although no well broke: the pile toppled,\n"
    "                 or disks or springs are too soft\n"
    "  creeps         with --set-again: wells are set again without end\n"
    "  meets          disks overlap that were not neighbours\n"
    "  not_converged  the solver did not converge\n"
    "  singular       a disk can move freely in the equilibrium, or no equilibrium\n"
    "                 was found for such a disk",
    "repose pile --alpha-deg 30 --base 45",
    own_params,
    .refuses = "An option that has no effect with the others; the message says which one it needs.\n"
               "A folder with a finished result, without --force; a folder with other files.\n"
               "--threshold with --branch, -o or eps = 0.",
    .act = solve_any,
    .protocol = sweep_pile_schema,
    .protocol_size = offsetof(options, own)};
