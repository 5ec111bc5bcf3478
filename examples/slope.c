/* Slope of a pile's surface by the three methods of Lee & Herrmann: `slope FILE WIDTH`, with the columns x
 * and y in the file. `repose angle slope FILE --width WIDTH --cell 0.2` prints the same.
 *
 *     cc slope.c $(pkg-config --cflags --libs repose) -o slope */
#include <math.h>
#include <stdlib.h>

#include <repose/angle.h>
#include <repose/table.h>

/* Column `name` as a new array. */
static rp_status read_column(const rp_table *table, const char *name, double **values)
{
    const int column = rp_table_column(table, name);
    rp_status status = column >= 0 ? RP_OK : rp_fail(RP_BAD_INPUT, "%s: no column %s", table->path, name);
    *values = malloc((table->n_rows + 1) * sizeof **values);
    for (size_t i = 0; i < table->n_rows && !status; i++)
        status = rp_table_number(table, i, column, 0, &(*values)[i]);
    return status;
}

static void print_slopes(const ang_slope slopes[ANG_N_METHODS])
{
    const double degree = acos(-1.0) / 180;
    rp_table_header(stdout, RP_CGS, "method, theta_deg [deg], theta_se_deg [deg]");
    for (int i = 0; i < ANG_N_METHODS; i++)
        rp_table_row(stdout, 3, (double[]){i + 1, slopes[i].theta / degree, slopes[i].theta_se / degree});
}

int main(int argc, char **argv)
{
    const ang_options options =
        ANG_OPTIONS_DEFAULT; /* cells of 0.2, the diameter of Lee & Herrmann's grains */
    ang_surface surface = {0};
    ang_slope slopes[ANG_N_METHODS];
    rp_table table = {0};
    double *x = NULL, *y = NULL;
    rp_status status = argc == 3 ? rp_table_read(argv[1], &table) : rp_fail(RP_USAGE, "slope FILE WIDTH");
    if (!status) status = read_column(&table, "x", &x);
    if (!status) status = read_column(&table, "y", &y);
    if (!status) status = ang_surface_make(table.n_rows, x, y, NULL, atof(argv[2]), &options, &surface);
    if (!status)
        status = ang_slopes(surface.n, surface.column, surface.h, surface.cell, options.parabola, slopes);
    if (!status) print_slopes(slopes);
    if (status) fprintf(stderr, "slope: %s\n", rp_message());
    ang_surface_free(&surface);
    rp_table_free(&table);
    free(x);
    free(y);
    return (int)status;
}
