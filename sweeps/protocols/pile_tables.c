/* Tables of a static pile; see pile.h. */
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>

#include "core/file.h"
#include "table/table.h"
#include "sweeps/protocols/pile.h"

void sweep_pile_notes(const sweep_solved *s, FILE *out)
{
    const statics_result *r = &s->r;
    rp_table_note(out, "n_disks", "%zu", s->h->n);
    rp_table_note_number(out, "B", s->h->B, "sigma");
    rp_table_note(out, "status", "%s", statics_fault_texts[r->fault]);
    rp_table_note(out, "load", "%g of the weight; %zu jumps to another branch before", r->load, r->jumps);
    if (r->fault)
        rp_table_note(out, "state", "no equilibrium: the last state of the solve, at eps = %g", r->eps);
    rp_table_note_number(out, "energy", r->energy, "m g eps sigma");
    if (!isnan(r->released))
        rp_table_note(out, "released", "%.6g m g eps sigma, from the primary state on", r->released);
    rp_table_note(out, "residual", "%.3g m g", r->residual);
    rp_table_note_number(out, "negative_modes", r->fault ? NAN : (double)r->negative_modes, "");
    if (isnan(r->smallest_pivot))
        rp_table_note(out, "smallest_pivot", "nan");
    else
        rp_table_note(out, "smallest_pivot", "%.3g K_s, disk %zu", r->smallest_pivot, r->pivot_disk + 1);
    rp_table_note(out, "contacts", "%zu, %zu of them horizontal", r->contacts, r->horizontal);
    rp_table_note(out, "wells", "%zu, %zu of them %s", r->wells, r->broken,
                  s->p->set_again ? "set anew" : "broken");
    rp_table_note(out, "solver", "%zu steps, %zu factorisations", r->steps, r->factored);
    const double most = r->fault ? 0 : gsl_stats_max(s->N, 1, r->wells);
    rp_table_note(out, "sinks", "%.3g sigma at most", r->eps * most);
    rp_table_note(out, "N_error", "%.3g rms, %.3g at most, relative to diagonals alone", s->N_error_rms,
                  s->N_error_max);
    rp_table_note(out, "H_ratio", "%.6g, the largest H over that of diagonals alone", s->H_ratio);
}

rp_status sweep_pile_write_base(const sweep_solved *s, FILE *out)
{
    const sweep_outline *h = s->h;
    const size_t k = s->r.wells, *disk = s->disk;
    const double *N = s->N, *H = s->H;
    const double middle = (h->disks[disk[0]].x + h->disks[disk[k - 1]].x) / 2;
    rp_table_header(out, RP_CGS,
                    "i, x [sigma], N/mg, H/mg, N_diagonals/mg, H_diagonals/mg, x/B, N/(chi*g*B), "
                    "H/(chi*g*B)");
    for (size_t i = 0; i < k; i++) {
        const double x = h->disks[disk[i]].x;
        const an_force exact = h->exact[i];
        rp_table_row(out, 9,
                     (double[]){(double)i + 1, x, N[i], H[i], exact.N, exact.H, 0.5 + (x - middle) / h->B,
                                N[i] / h->B, H[i] / h->B});
    }
    return RP_OK;
}

static rp_status write_contacts(const sweep_solved *s, FILE *out)
{
    statics_contact *list;
    size_t n;
    RP_TRY(statics_contacts(s->pile, &list, &n));
    rp_table_header(out, RP_CGS,
                    "a, b, x [sigma], y [sigma], x_b [sigma], y_b [sigma], force [m g], horizontal, "
                    "strongest, weakest");
    for (const statics_contact *c = list; c < list + n; c++)
        rp_table_row(out, 10,
                     (double[]){(double)c->a + 1, (double)c->b + 1, c->x, c->y, c->x_b, c->y_b, c->force,
                                c->horizontal, c->strongest, c->weakest});
    free(list);
    return RP_OK;
}

static rp_status write_disks(const sweep_solved *s, FILE *out)
{
    RP_SCOPE(memory);
    double *u;
    RP_NEW(&memory, u, 2 * s->h->n);
    const double eps = s->r.eps;
    statics_displacements(s->pile, u);
    rp_table_header(out, RP_CGS, "id, x [sigma], y [sigma], r [sigma], u_x [eps sigma], u_y [eps sigma]");
    for (size_t i = 0; i < s->h->n; i++) {
        const statics_disk *p = &s->h->disks[i];
        const double u_x = u[2 * i], u_y = u[2 * i + 1];
        rp_table_row(out, 6, (double[]){(double)i + 1, p->x + eps * u_x, p->y + eps * u_y, p->r, u_x, u_y});
    }
    return RP_OK;
}

static rp_status write_wells(const sweep_solved *s, FILE *out)
{
    static const char *const states[] = {
        [STATICS_WELL_HOLDS] = "holds", [STATICS_WELL_BROKEN] = "broken", [STATICS_WELL_ANEW] = "set_anew"};
    RP_SCOPE(memory);
    statics_well *wells;
    RP_NEW(&memory, wells, s->r.wells);
    statics_wells(s->pile, wells);
    rp_table_note(out, "x_0", "position at which a well rests; of a broken one, at which it broke");
    rp_table_header(out, RP_CGS, "disk, x [sigma], x_0 [sigma], x-x_0 [eps sigma], N [m g], H [m g], state");
    for (const statics_well *w = wells; w < wells + s->r.wells; w++) {
        const double x = s->h->disks[w->disk].x;
        rp_table_row_word(out, 6,
                          (double[]){(double)w->disk + 1, x + s->r.eps * w->x, x + s->r.eps * w->x_0,
                                     w->x - w->x_0, w->N, w->H},
                          states[w->state]);
    }
    return RP_OK;
}

rp_status sweep_pile_write(const sweep_solved *s, const sweep_tables *tables)
{
    static const struct {
        const char *name;
        rp_status (*write)(const sweep_solved *s, FILE *out);
    } list[] = {{"wells.tsv", write_wells},
                {"contacts.tsv", write_contacts},
                {"disks.tsv", write_disks},
                {"base.tsv", sweep_pile_write_base}};
    const size_t n = sizeof list / sizeof *list - (s->r.fault != 0); /* no forces on the base */
    RP_TRY(rp_make_directory(tables->directory));
    for (size_t i = 0; i < n; i++) {
        sweep_file f;
        RP_TRY(sweep_table_open(tables, RP_CGS, list[i].name, &f));
        sweep_pile_notes(s, f.out);
        RP_TRY(sweep_table_close(&f, list[i].write(s, f.out)));
    }
    return RP_OK;
}
