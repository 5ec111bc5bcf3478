/* A triangle of soft disks at rest, seven in its base: forces on the base, as `repose pile --base 7 --eps
 * 1e-3` prints them. Lengths in diameters, forces in units of a disk's weight.
 *
 *     cc pile.c $(pkg-config --cflags --libs repose) -o pile */
#include <math.h>

#include <repose/equilibrium.h>
#include <repose/table.h>

enum { BASE = 7, DISKS = BASE * (BASE + 1) / 2 };

/* Rows from the ground up, each in the gaps of the one below. */
static void stack(statics_disk disks[DISKS])
{
    size_t n = 0;
    for (int row = 0; row < BASE; row++)
        for (int i = 0; i < BASE - row; i++)
            disks[n++] =
                (statics_disk){.x = i + 0.5 * row, .y = 0.5 + row * sqrt(0.75), .r = 0.5, .weight = 1};
}

int main(void)
{
    statics_disk disks[DISKS];
    statics_definition definition = statics_definition_default();
    statics_pile *pile = NULL;
    statics_result result;
    double N[BASE], H[BASE];
    stack(disks);
    definition.disks = disks;
    definition.n = DISKS;
    definition.eps = 1e-3; /* softness: m g/(K_s sigma) */
    rp_status status = statics_create(&definition, &pile);
    if (!status) status = statics_solve(pile, &result);
    if (!status) {
        statics_base(pile, NULL, N, H);
        rp_table_header(stdout, RP_CGS, "i, N/mg, H/mg");
        for (int i = 0; i < BASE; i++) rp_table_row(stdout, 3, (double[]){i + 1, N[i], H[i]});
    }
    if (status) fprintf(stderr, "pile: %s\n", rp_message());
    statics_free(pile);
    return (int)status;
}
