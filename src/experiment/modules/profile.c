/* Profile: what grains and contacts have in bins of a region, as a table; over several samples the mean. */
#include <math.h>

#include "core/elementary.h"
#include "experiment/modules/module.h"
#include "table/table.h"

typedef struct {
    int along;
    long bins;
} profile_params;

enum { ALONG_X, ALONG_Y };
static const rp_param schema[] = {
    {"along", "", RP_CHOICE, offsetof(profile_params, along), "y", "x | y", "direction of the bins"},
    {"bins", "", RP_INT, offsetof(profile_params, bins), "20", "[1, 10000]", "number of bins in the region"},
    {0}};

static const exp_output outputs[] = {{0}};

/* Of all samples: ends of the region and area of a bin, then of each bin these. */
enum { LOWER, UPPER, AREA, HEAD };
enum { COUNT, COVERED, MASS, P_X, P_Y, S_XX, S_XY, S_YY, SUMS };

static size_t room(const void *params)
{
    return HEAD + (size_t)((const profile_params *)params)->bins * SUMS;
}

/* The bin of a place, NULL beside all. */
static double *bin_of(const exp_view *s, const profile_params *p, double x, double y, double sums[])
{
    const int c = p->along == ALONG_Y;
    const double at = c ? y : x, k = floor((at - s->lo[c]) / (s->hi[c] - s->lo[c]) * (double)p->bins);
    const bool in = x >= s->lo[0] && x <= s->hi[0] && y >= s->lo[1] && y <= s->hi[1];
    return in ? &sums[HEAD + (size_t)fmin(k, (double)(p->bins - 1)) * SUMS] : NULL;
}

static rp_status add(const exp_view *s, const void *params, double sums[])
{
    const profile_params *p = params;
    for (int c = 0; c < 2; c++)
        if (!(s->hi[c] > s->lo[c] && isfinite(s->hi[c] - s->lo[c])))
            return rp_fail(RP_NO_RESULT, "the region goes from %c = %g to %g", c ? 'y' : 'x', s->lo[c],
                           s->hi[c]);
    const int along = p->along == ALONG_Y;
    sums[LOWER] += s->lo[along], sums[UPPER] += s->hi[along];
    sums[AREA] += (s->hi[0] - s->lo[0]) * (s->hi[1] - s->lo[1]) / (double)p->bins;
    for (size_t i = 0; i < s->n; i++) {
        const dem_state *g = &s->grains[i];
        double *bin = bin_of(s, p, g->x, g->y, sums);
        if (!bin) continue;
        bin[COUNT]++, bin[COVERED] += M_PI * g->r * g->r;
        bin[MASS] += g->m, bin[P_X] += g->m * g->vx, bin[P_Y] += g->m * g->vy;
    }
    for (const dem_contact *c = s->contacts; c < s->contacts + s->n_contacts; c++) {
        const double lx = c->x - c->x_b, ly = c->y - c->y_b, l = rp_hypot(lx, ly),
                     fx = (c->normal_force * lx + c->shear_force * ly) / l,
                     fy = (c->normal_force * ly - c->shear_force * lx) / l;
        double x = 0.5 * (c->x + c->x_b), y = 0.5 * (c->y + c->y_b);
        dem_box_frame(s->sim, &x, &y);
        double *bin = bin_of(s, p, x, y, sums);
        if (!bin) continue;
        bin[S_XX] += lx * fx, bin[S_YY] += ly * fy, bin[S_XY] += 0.5 * (lx * fy + ly * fx);
    }
    return RP_OK;
}

static void write(const void *params, rp_units units, double samples, const double sums[], FILE *out)
{
    const profile_params *p = params;
    const char *const columns[][2] = {{p->along == ALONG_Y ? "y" : "x", "cm"},
                                      {"grains", ""},
                                      {"fraction", ""},
                                      {"vx", "cm/s"},
                                      {"vy", "cm/s"},
                                      {"sxx", "dyn/cm"},
                                      {"sxy", "dyn/cm"},
                                      {"syy", "dyn/cm"}};
    rp_table_note(out, "samples", "%.0f", samples);
    rp_table_columns(out, units, 8, columns);
    for (long k = 0; k < p->bins && samples > 0.0; k++) {
        const double *bin = &sums[HEAD + k * SUMS],
                     at = (sums[LOWER] + (sums[UPPER] - sums[LOWER]) * ((double)k + 0.5) / (double)p->bins);
        rp_table_row(out, 8,
                     (double[]){at / samples, bin[COUNT] / samples, bin[COVERED] / sums[AREA],
                                bin[P_X] / bin[MASS], bin[P_Y] / bin[MASS], bin[S_XX] / sums[AREA],
                                bin[S_XY] / sums[AREA], bin[S_YY] / sums[AREA]});
    }
}

EXP_MODULE(profile,
           "solid fraction, mean velocity of the grains by their centres, and stress, in bins of a region; a "
           "table, without columns",
           "no_region", schema, profile_params, outputs, EXP_ON_CONTACTS, .room = room, .add = add,
           .write = write);
