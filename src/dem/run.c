/* The loop over steps. */
#ifdef __SSE2__
#include <xmmintrin.h>
#define get_mode _mm_getcsr
#define set_mode _mm_setcsr
#define FLUSH    0x8040u /* results and operands */
#elif defined __aarch64__
#define FLUSH 0x1000000u /* FPCR.FZ: both */
static unsigned get_mode(void)
{
    unsigned long mode;
    __asm__ volatile("mrs %0, fpcr" : "=r"(mode));
    return (unsigned)mode;
}

static void set_mode(unsigned mode)
{
    __asm__ volatile("msr fpcr, %0" : : "r"((unsigned long)mode) : "memory");
}
#else
#define FLUSH          0u
#define get_mode()     0
#define set_mode(mode) (void)(mode)
#endif

#include "core/clock.h"
#include "dem/list/list.h"
#include "dem/methods/methods.h"
#include "dem/observe/observe.h"
#include "dem/setup/definition.h"
#include "dem/threads/threads.h"

static rp_status advance(dem_sim *sim, long steps)
{
    /* the box may turn since the start */
    if (sim->grains.n_fixed > 0 && sim->def.box_turn_per_step != 0.0) return dem_refuse_turn();
    rp_status status = dem_scheme_check(&sim->def);
    if (!status) dem_threads_start(sim);
    for (; steps > 0 && !status; steps--) {
        dem_gravity_advance(sim);
        status = sim->scheme->step(sim, steps == 1);
        if (!status && sim->ledger) dem_ledger_step(sim);
    }
    dem_threads_end(sim);
    dem_neighbours_close_gaps(sim);
    return status;
}

/* Within a run, numbers below the smallest normal one, 2.2e-308, count as 0. Speeds and springs of a disk
 * that lies alone shrink for ever, and each operation on such a number takes the processor some 150 cycles.
 */
rp_status dem_run(dem_sim *sim, long steps)
{
    const unsigned mode = get_mode();
    set_mode(mode | FLUSH);
    rp_status status = advance(sim, steps);
    set_mode(mode);
    return status;
}

rp_status dem_run_timed(dem_sim *sim, long steps, dem_phases *times)
{
    sim->times = times;
    sim->clock = rp_clock();
    rp_status status = dem_run(sim, steps);
    sim->times = NULL;
    return status;
}
