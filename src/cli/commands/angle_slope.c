/* repose angle slope: the slope of a pile's surface. */
#include <gsl/gsl_statistics_double.h>
#include <strings.h>

#include "angle/angle.h"
#include "cli/cli.h"

#define SLOPE_OPTIONS(X)                                                                                     \
    X(REAL, width, "", "auto", "(0, inf) | auto",                                                            \
      "width W of a box from x = 0, in the unit of FILE; auto: no box, the pile is found wherever it is")    \
    CLI_RANGE(X, "x")                                                                                        \
    X(REAL, cell, "", "auto", "(0, inf) | auto",                                                             \
      "nominal diameter d of a grain, in the unit of FILE, for round(W/d) bins; auto: the mean diameter")    \
    X(CHOICE, height, "", "centre", ANG_HEIGHT_WORDS,                                                        \
      "height of a bin: highest centre - d/2 (at least 0), highest centre, or highest point")                \
    X(CHOICE, empty, "", "zero", ANG_EMPTY_WORDS, "empty bins have height 0, or are left out")               \
    X(CHOICE, parabola, "", "free", ANG_PARABOLA_WORDS,                                                      \
      "parabola of method 3: three coefficients, or through the origin")                                     \
    X(CHOICE, y_axis, "", "up", "up | down",                                                                 \
      "direction in which y grows: down for the rows of a picture, where in a box the lowest point is d/2 "  \
      "above the ground")                                                                                    \
    CLI_WHERE(X)

CLI_OPTIONS(slope, SLOPE_OPTIONS)

/* Columns by name, unless there are only so many. Radii are read where the table has
 * them, if they are useful. */
static rp_status read_grains(rp_arena *arena, rp_table *t, const slope_options *o, bool *with_r,
                             double **block)
{
    const bool needs_r = o->height == ANG_TOP, useful = o->width > 0.0 && !(o->cell > 0.0);
    static char *first[] = {"x", "y", "r"};
    bool named = false;
    for (size_t c = 0; c < N_OF(first); c++) {
        const bool exact = rp_table_column(t, first[c]) >= 0;
        for (size_t i = 0; i < t->n_columns && !exact; i++)
            if (t->names[i] && strcasecmp(t->names[i], first[c]) == 0) t->names[i] = first[c];
        named |= rp_table_column(t, first[c]) >= 0;
    }
    if (!named && !t->names[0] && t->n_columns > 3) return rp_table_nameless(t);
    named |= t->names[0] && t->n_columns > 2; /* which are to be x and y */
    *with_r = needs_r || (useful && (named ? rp_table_column(t, "r") >= 0 : t->n_columns >= 3));
    const size_t n = *with_r ? 3 : 2;
    if (!named && t->n_columns < n)
        return rp_fail(RP_BAD_INPUT, "%s: %zu columns, at least %zu (%s) needed", t->path, t->n_columns, n,
                       *with_r ? "x y r" : "x y");
    for (size_t c = 0; !named && c < n; c++) t->names[c] = first[c];
    return rp_columns_read(arena, t, *with_r ? "x,y,r" : "x,y", block);
}

/* A table does not tell whether its surface falls to the left or its y points down. */
static void warn_negative(const cli_call *call, const ang_slope slopes[ANG_N_METHODS])
{
    bool negative = !cli_given(call, "y-axis");
    for (int i = 0; i < ANG_N_METHODS; i++) negative &= slopes[i].slope < 0.0;
    if (negative)
        cli_say(
            "repose angle slope: the angles are negative: give --y-axis down if y counts downward, as the "
            "rows of a picture do, or --y-axis up if the surface falls to the left");
}

/* Without slopes: rows without result. */
static void print_slopes(const cli_call *call, size_t n_cells, size_t n_occupied, const ang_slope *slopes,
                         const char *word)
{
    for (int i = 0; i < ANG_N_METHODS; i++) {
        ang_slope s = slopes ? slopes[i] : (ang_slope){NAN, NAN, NAN, NAN};
        CLI_ROW_WORD(word, i + 1, s.slope, s.theta / deg, s.theta_se / deg, (double)n_cells,
                     (double)n_occupied);
    }
}

/* The nominal diameter of a grain, and where it is from. */
static rp_status choose_cell(const slope_options *o, const rp_table *t, const double *block, bool with_r,
                             double *cell, const char **origin)
{
    const size_t n = t->n_rows;
    const double *r = block + 2 * n;
    *cell = o->cell;
    *origin = "by --cell";
    if (o->cell > 0.0) return RP_OK;
    if (!with_r)
        return rp_fail(RP_USAGE,
                       "%s: no radii, which --width needs for its bins; give --cell, or leave --width out",
                       t->path);
    for (size_t i = 0; i < n; i++)
        if (!(r[i] > 0.0))
            return rp_fail(RP_BAD_INPUT, "%s:%zu: r = %g: out of range, allowed: (0, inf)", RP_PLACE(t, i),
                           r[i]);
    *origin = "mean diameter of the grains";
    *cell = 2.0 * gsl_stats_mean(r, 1, n);
    return RP_OK;
}

/* As the slopes of one flank. A box has its ground at y = 0 and cells from x = 0 on. */
static rp_status slope_of_box(size_t n, const double *block, bool with_r, const slope_options *o, double cell,
                              ang_pile *pile)
{
    const ang_options options = {cell, (ang_height)o->height, (ang_empty)o->empty, (ang_parabola)o->parabola};
    const double *x = block, *y = block + n;
    double left = INFINITY, lowest = 0.0;
    RP_ENDS(ang_surface_free) ang_surface s;
    rp_status status = ang_surface_make(n, x, y, with_r ? y + n : NULL, o->width, &options, &s);
    for (size_t i = 0; i < n; i++) {
        if (!(x[i] >= 0.0 && x[i] < o->width)) continue;
        left = fmin(left, x[i]);
        if (o->height == ANG_CENTRE) lowest = fmin(lowest, y[i]);
    }
    if (!status && (2 * s.n_occupied <= s.n_cells || left >= s.cell || lowest < -0.5 * s.cell))
        status =
            rp_fail(RP_NO_RESULT,
                    "sparse: %zu of %zu bins hold a point, the first x is %g and the lowest y %g, but a box "
                    "begins at 0, 0; give a larger --cell than %g or a smaller --width, or leave --width out",
                    s.n_occupied, s.n_cells, left, lowest, s.cell);
    if (!status && (4 * s.n_occupied < 3 * s.n_cells || gsl_stats_min(x, 1, n) < 0.0 ||
                    (!ang_pile_find(n, x, y, (double[]){0.0, o->width}, pile) && pile->n_flanks == 2)))
        cli_say("repose angle slope: a box leaves out x < 0, its empty bins have height 0, and it has one "
                "flank; without --width the pile is found wherever it is");
    *pile = (ang_pile){.n = s.n_cells, .n_flanks = 1, .n_flank = {s.n_occupied}};
    return status ? status : ang_slopes(s.n, s.column, s.h, s.cell, options.parabola, pile->flank[0]);
}

/* There is no pile: a hint if there is one where y counts downward. */
static rp_status try_downward(size_t n, double *block, const slope_options *o)
{
    ang_pile pile;
    char why[512];
    snprintf(why, sizeof why, "%s", rp_message());
    for (size_t i = n; i < 2 * n; i++) block[i] = -block[i];
    const bool found = !ang_pile_find(n, block, block + n, CLI_RANGE_OF(o), &pile);
    return rp_fail(RP_NO_RESULT, "%s%s", why,
                   found ? "; as rows of a picture, whose y counts downward, there is one: --y-axis down"
                         : "");
}

static rp_status slope_of_table(cli_call *call, rp_table *table, const void *values)
{
    const slope_options *o = values;
    const bool box = o->width > 0.0;
    double *block = NULL, cell = NAN;
    const char *origin = "";
    bool with_r = false;
    ang_pile pile;
    if (table->n_rows == 0) return rp_fail(RP_BAD_INPUT, "%s: no grains", table->path);
    if (box ? cli_given(call, "from") || cli_given(call, "to")
            : cli_given(call, "cell") || cli_given(call, "empty") || cli_given(call, "parabola"))
        return rp_fail(RP_USAGE,
                       "--cell, --empty and --parabola need --width; --from and --to need its absence");
    RP_TRY(rp_table_one_step(table));
    RP_TRY(read_grains(call->arena, table, o, &with_r, &block));
    const size_t n = table->n_rows;
    if (box) RP_TRY(choose_cell(o, table, block, with_r, &cell, &origin));
    /* a height above the ground instead of a row of a picture */
    const double lowest = gsl_stats_max(block + n, 1, n), above = box ? 0.5 * cell : 0.0;
    for (size_t i = n; i < 2 * n && o->y_axis; i++) block[i] = lowest - block[i] + above;
    for (size_t i = 0; i < n && !box && o->height == ANG_TOP; i++) block[n + i] += block[2 * n + i];
    rp_status status = box ? slope_of_box(n, block, with_r, o, cell, &pile)
                           : ang_pile_find(n, block, block + n, CLI_RANGE_OF(o), &pile);
    if (!box && status == RP_NO_RESULT && !cli_given(call, "y-axis")) status = try_downward(n, block, o);
    if (!status && pile.n_flanks == 2 && pile.flank[0][1].slope > 0.0 && !cli_given(call, "y-axis"))
        status = rp_fail(RP_NO_RESULT, "a valley, two flanks that fall inwards: give --y-axis down if y "
                                       "counts downward, as the rows of a picture do, or else --y-axis up");
    if (!box && pile.n_stray > 0 && !status)
        cli_say("repose angle slope: %s: %zu stray points beside the pile are left out", table->path,
                pile.n_stray);
    rp_prefix(status, "%s: %s", table->path,
              !box && pile.n_flank[0] > 0 ? "choose a flank with --from and --to: " : "");
    if (status && status != RP_NO_RESULT) return status;
    cli_table(call, call->out);
    if (box) rp_table_note_number(call->out, "cell", cell, origin);
    rp_table_header(call->out, call->units,
                    "method, slope, theta_deg [deg], theta_se_deg [deg], n_cells, n_occupied, status");
    if (status) {
        const bool sparse = box && pile.n_flank[0] >= ANG_MIN_OCCUPIED;
        print_slopes(call, pile.n, pile.n_flank[0], NULL, sparse ? "sparse" : "no_pile");
    } else if (pile.n_flanks == 1) {
        print_slopes(call, pile.n, pile.n_flank[0], pile.flank[0], "ok");
        warn_negative(call, pile.flank[0]);
    } else {
        print_slopes(call, pile.n, pile.n_flank[0], pile.flank[0], "ok_left");
        print_slopes(call, pile.n, pile.n_flank[1], pile.flank[1], "ok_right");
        print_slopes(call, pile.n, pile.n_flank[0] + pile.n_flank[1], pile.mean, "ok_mean");
    }
    return status;
}

const cli_command cmd_angle_slope = {
    "angle slope",
    "slope of a table of grains, by three methods",
    "FILE [options]",
    "Slope of the surface h(x) of a pile, positive where it falls to the right, by the methods of Lee & "
    "Herrmann 1993, one row for each:\n"
    "  1  from the first to the last surface bin or point\n"
    "  2  straight line through h(x)\n"
    "  3  parabola through the running sum of h\n"
    "theta_se_deg is the standard error from the scatter of h about the straight line.\n"
    "\n"
    "FILE (- for standard input) has one row for each grain, or for each point of an outline, with columns "
    "named x y r (or X Y R). A table of two columns, or of three without names, has them in this order. r is "
    "needed only for --height top, and for --width without --cell. For points in pixels, where y is the row "
    "of a picture, give --y-axis down.\n"
    "\n"
    "Without --width, the pile is found wherever it is, on any ground. A point below another by more than 57 "
    "degrees is taken to be inside; the other n_cells points are the surface. A flank is the surface between "
    "its lowest and its highest tenth, with n_occupied points. If there are two flanks, both have rows, with "
    "status ok_left and ok_right, and rows with ok_mean have the mean of their steepness. If no flank is "
    "found, the status is no_pile.\n"
    "\n"
    "With --width, the surface is that of a box with its ground at y = 0, and consists of the highest grain "
    "in each surface bin. A bin is as wide as the mean diameter of the grains, or as --cell. The status is "
    "no_pile if fewer than 5 bins are occupied, and sparse if at most half of the bins are, if none is at x "
    "= 0, or if grains lie below y = 0.\n"
    "\n"
    "With no_pile and sparse, the exit status is 1.",
    "repose angle slope out/states.tsv --where step=20000",
    slope_params,
    .refuses = "Grains of several steps: choose one with --where step=N.\n"
               "--height top without radii; a radius that is not positive.\n"
               "Neither one nor two flanks: choose with --from and --to.\n"
               "A valley, unless --y-axis says which way is up.\n"
               "Without --width: --cell, --empty and --parabola; with it: --from and --to.",
    .on_table = slope_of_table};
