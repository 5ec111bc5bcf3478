/* Oblique impact of an undamped grain, linear normal law, truncated shear spring, event by event, independent
 * of the simulator (after Di Maio & Di Renzo 2004, Chem. Eng. Sci. 59, 3461). */
#ifndef OBLIQUE_H
#define OBLIQUE_H

/* Slip velocity after an impact of approach speed v_n > 0 and slip v_s. a = 1 + m r^2/I, kappa = k_s/k_n.
 * Exact in the limit of small overlaps. */
double oblique_left(double a, double kappa, double mu, double v_n, double v_s);

#endif
