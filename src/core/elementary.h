/* Elementary functions of + - * / and roots alone: every processor and C library gives the same bits. They
 * are rounded from some 100 bits, so that glibc's agree wherever those are rounded correctly; hypot is within
 * one unit in the last place. For what is set up or measured: libm's are ten times as fast. */
#ifndef RP_ELEMENTARY_H
#define RP_ELEMENTARY_H

double rp_hypot(double x, double y); /* sqrt(x^2 + y^2) without overflow */

double rp_exp(double x);
double rp_log(double x);           /* NAN below 0, -INFINITY at 0 */
double rp_pow(double x, double p); /* x >= 0 */
double rp_acosh(double x);         /* x >= 1 */

/* Of angles in radians; NAN from 1e9 on. */
double rp_sin(double angle);
double rp_cos(double angle);
double rp_tan(double angle);

double rp_asin(double x);
double rp_acos(double x);
double rp_atan(double x);
double rp_atan2(double y, double x); /* -pi to pi; 0 of two zeros */

#endif
