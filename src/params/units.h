/* Systems of units. The program computes with plain numbers; schemas and table headers are written in cgs,
 * and this table has each label and each default in another system. The system belongs to the text or table
 * that is read or written: whoever reads or writes it hands it on. */
#ifndef RP_UNITS_H
#define RP_UNITS_H

#include <stddef.h>

#include "core/status.h"

RP_C_BEGIN

/* sigma: the diameter sigma and mass m of the default grain (a sphere of 0.2 cm and 1 g/cm^3), and g = 981
 * cm/s^2. */
#define RP_UNITS_WORDS "cgs | si | sigma"
typedef enum { RP_CGS, RP_SI, RP_SIGMA } rp_units;

/* "cgs", "si" or "sigma"; and back, RP_CGS for any other word or NULL. */
const char *rp_units_word(rp_units system);
rp_units rp_units_find(const char *word);

/* Label, in a system, of a quantity with this label in cgs. Other labels are returned as they are. */
const char *rp_unit(rp_units system, const char *cgs);

/* Label number k in cgs of those that are converted; NULL past the end. */
const char *rp_unit_label(size_t k);

/* RP_BAD_INPUT for a label with a unit of another system, or with a multiple (mm), which is not converted. */
rp_status rp_unit_check(rp_units system, const char *label);

/* A number of such a quantity in cgs, converted to a system; 12 digits. */
double rp_units_value(rp_units system, const char *cgs, double number);

RP_C_END

#endif
