/* The list of protocols; see protocols.h. */
#include "sweeps/protocols/protocols.h"

static const rp_param no_params[] = {{0}};
static const sweep_output no_outputs[] = {{0}};

/* One that is a text. */
#define TEXT(NAME, ABOUT)                                                                                    \
    extern const char sweep_text_##NAME[];                                                                   \
    const sweep_protocol sweep_protocol_##NAME = {.name = #NAME,                                             \
                                                  .about = ABOUT,                                            \
                                                  .schema = no_params,                                       \
                                                  .outputs = no_outputs,                                     \
                                                  .text = sweep_text_##NAME}
TEXT(repose, "fill a box, open its right wall, measure the slope at rest, tilt (Lee & Herrmann 1993)");
TEXT(flux, "grains put in at the left, one by one, leave over the right edge (Lee & Herrmann 1993)");
TEXT(stress,
     "the pile of `repose`, tilted by small angles: forces on the floor, stress, Coulomb-critical tilt");
TEXT(onset,
     "the pile of `repose`, tilted until it moves: what predicts the angle, what slides and moves first");
TEXT(drop, "a pile of disks dropped one at a time (Liffman, Chan & Hughes 1992, fig 20)");

const sweep_protocol *const sweep_protocols[] = {
#define X(name) &sweep_protocol_##name,
    SWEEP_TEXTS(X) SWEEP_PROTOCOLS(X)
#undef X
        NULL};
