/* exp and log of + - * / alone, so that every processor and C library gives the same bits; to 2 units in the
 * last place. For what is drawn or set up once: libm's are faster. */
#ifndef RP_ELEMENTARY_H
#define RP_ELEMENTARY_H

double rp_exp(double x); /* |x| <= 700 */
double rp_log(double x); /* normal x > 0 */

#endif
