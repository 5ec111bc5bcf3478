/* Forces under a pile whose two slopes have 30 degrees, as `repose continuum --alpha-deg 30 --points 11`
 * prints them.
 *
 *     cc profile.c $(pkg-config --cflags --libs repose) -o profile */
#include <math.h>

#include <repose/analytic.h>
#include <repose/table.h>

int main(void)
{
    const double pi = acos(-1.0), slope = 30 * pi / 180;
    rp_table_header(stdout, RP_CGS, "x/B, N/(chi*g*B), H/(chi*g*B)");
    for (int i = 0; i <= 10; i++) {
        an_force force;
        const double x = i / 10.0;
        if (an_continuum(slope, x, &force)) {
            fprintf(stderr, "profile: %s\n", rp_message());
            return 1;
        }
        rp_table_row(stdout, 3, (double[]){x, force.N, force.H});
    }
    return 0;
}
