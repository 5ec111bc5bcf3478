/* Snapshots: a simulation that resumes from one has the bits of the one that was never stopped, in memory and
 * from a file; what is no such state is refused with the reason. Suite run has the program. */
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <xxhash.h>

#include "core/clock.h"
#include "dem/state/state.h"
#include "tests/faults.h"
#include "tests/grains.h"
#include "tests/program.h"
#include "tests/protocol.h"

/* ---- Simulations ---- */

enum { GRAINS = 24, HALF = 120 };

/* What a scene may have, one bit each. */
enum {
    ROTATION = 1,
    ROLLING = 2,
    WELLS = 4,
    HARD = 8,
    LIFTED_GATE = 16,
    GRAVITY_TURNS = 32,
    BOX_TURNS = 64,
    OUTFLOW = 128,
    LEDGER = 256,
    FIXED = 512,
    PUT_IN = 1024,
    FEATURES = 2048
};

static dem_definition scene_of(int features)
{
    dem_grain *grains;
    dem_definition def = grains_box(GRAINS, 1.2, 3, &grains);
    for (size_t i = 0; i < GRAINS; i++) {
        grains[i].vx = 60.0 * ((double)(i % 7) / 3.0 - 1.0);
        grains[i].vy = -50.0 * (double)(i % 3);
        if (features & ROTATION) grains[i].omega = (double)i - 20.0;
    }
    def.rotation = features & ROTATION;
    if (features & ROLLING) def.material.mu_roll = 0.1;
    if (features & WELLS) def.ground = (dem_ground){1, 0.5, 0.01, DEM_WELL_AGAIN};
    if (features & HARD) {
        def.hard = (dem_hard){true, 0.7, 0.3};
        def.tension = false;
    }
    if (features & LIFTED_GATE) {
        def.walls[DEM_BOX_RIGHT].extent[0] = 0.0, def.walls[DEM_BOX_RIGHT].open_speed = 100.0;
        def.walls[DEM_BOX_RIGHT].open_at_step = HALF / 2;
    }
    if (features & GRAVITY_TURNS) def.turn_per_step = 1e-3, def.turn_from_step = HALF / 3;
    if (features & BOX_TURNS) def.box_turn_per_step = 1e-4;
    if (features & OUTFLOW) {
        def.x_max = 1.1, def.walls[DEM_BOX_RIGHT].open_at_step = 0;
        for (size_t i = 0; i < GRAINS; i++)
            if (grains[i].x > 1.0) grains[i].x -= 0.1, grains[i].y += 4.0;
    }
    if (features & FIXED) grains[0].fixed = true, grains[0].vx = grains[0].vy = grains[0].omega = 0.0;
    def.ledger = features & LEDGER;
    return def;
}

static void advance(dem_sim *sim, long steps)
{
    CHECK_OK(dem_run(sim, steps));
}

static void put_in(dem_sim *sim, int features)
{
    if (!(features & PUT_IN)) return;
    const double y = 9.0 + 0.005 * (double)dem_step(sim);
    for (int k = 0; k < 3; k++)
        CHECK_OK(
            dem_add(sim, &(dem_grain){.x = 0.2 + 0.3 * k, .y = y, .r = 0.1, .m = 0.004, .vy = -9.0}, NULL));
}

/* Everything that can be read of two simulations. */
static bool same(const dem_sim *a, const dem_sim *b)
{
    double forces[2][2 * DEM_FEW_WALLS] = {{0}};
    dem_energy energy[2];
    dem_ledger ledger[2] = {{0}};
    dem_counts counts[2];
    double g[2][2];
    dem_contact *contacts[2];
    size_t n[2];
    for (int k = 0; k < 2; k++) {
        const dem_sim *sim = k ? b : a;
        grains_wall_forces(sim, forces[k]);
        dem_energies(sim, &energy[k]);
        dem_ledger_read(sim, &ledger[k]);
        counts[k] = grains_counts(sim);
        dem_gravity(sim, g[k]);
        contacts[k] = grains_contacts(sim, &n[k]);
    }
    bool equal = grains_same_bits(a, b) && dem_step(a) == dem_step(b) && n[0] == n[1] &&
                 memcmp(forces[0], forces[1], sizeof forces[0]) == 0 &&
                 memcmp(&energy[0], &energy[1], sizeof energy[0]) == 0 &&
                 memcmp(&ledger[0], &ledger[1], sizeof ledger[0]) == 0 &&
                 memcmp(&counts[0], &counts[1], sizeof counts[0]) == 0 &&
                 memcmp(g[0], g[1], sizeof g[0]) == 0;
    for (size_t k = 0; k < n[0] && equal; k++)
        equal = contacts[0][k].shear_spring == contacts[1][k].shear_spring &&
                contacts[0][k].rolling_spring == contacts[1][k].rolling_spring &&
                contacts[0][k].well == contacts[1][k].well;
    free(contacts[0]), free(contacts[1]);
    return equal;
}

/* Whether there is such a scene; if so, twice HALF steps, of which the second half is also made from a
 * snapshot; adds the contacts that it has there. */
static bool continues(dem_definition *def, int features, size_t *contacts)
{
    scoped_sim *sim = NULL;
    const double limit = dem_time_step_limit(def, NULL);
    if (!(def->dt <= 0.5 * limit)) def->dt = 0.5 * limit;
    const rp_status status = dem_create(def, &sim);
    CU_ASSERT(!status || status == RP_BAD_INPUT);
    if (status) return false;
    advance(sim, HALF - 40);
    put_in(sim, features);
    advance(sim, 40);
    *contacts += grains_counts(sim).contacts;
    scoped_sim *copy = grains_kept(sim);
    CU_ASSERT(same(sim, copy));
    for (int k = 0; k < 2; k++) {
        put_in(sim, features), put_in(copy, features);
        advance(sim, HALF / 2);
        advance(copy, HALF / 3);
        advance(copy, HALF / 2 - HALF / 3);
        CU_ASSERT(same(sim, copy));
    }
    return true;
}

/* Each feature alone, and all that go together. */
static const int sets[] = {0,
                           ROTATION,
                           ROTATION | ROLLING,
                           WELLS,
                           HARD,
                           LIFTED_GATE,
                           GRAVITY_TURNS,
                           BOX_TURNS,
                           OUTFLOW,
                           LEDGER,
                           FIXED,
                           PUT_IN,
                           ROTATION | ROLLING | WELLS | HARD | GRAVITY_TURNS | OUTFLOW | LEDGER | PUT_IN,
                           ROTATION | ROLLING | LIFTED_GATE | GRAVITY_TURNS | FIXED | LEDGER | PUT_IN,
                           WELLS | GRAVITY_TURNS | LEDGER | FIXED};
enum { SETS = sizeof sets / sizeof *sets };

static void every_law_integrator_and_feature(void)
{
    size_t of_integrator[DEM_INTEGRATORS] = {0}, of_set[SETS] = {0}, contacts = 0;
    for (int normal = 0; normal < DEM_NORMAL_N; normal++)
        for (int tangential = 0; tangential < DEM_TANGENTIAL_N; tangential++)
            for (int integrator = 0; integrator < DEM_INTEGRATORS; integrator++)
                for (size_t k = 0; k < SETS; k++) {
                    dem_definition def = scene_of(sets[k]);
                    grains_law(&def, (dem_normal_law)normal, 1e5, 200.0);
                    def.tangential = (dem_tangential_law)tangential;
                    def.integrator = (dem_integrator)integrator;
                    if (tangential == DEM_NONE) def.material.mu = def.material.mu_roll = 0.0;
                    for (size_t w = 0; w < def.n_walls; w++) def.walls[w].material = def.material;
                    const bool done = continues(&def, sets[k], &contacts);
                    of_integrator[integrator] += done, of_set[k] += done;
                }
    for (int k = 0; k < DEM_INTEGRATORS; k++) CU_ASSERT(of_integrator[k] >= 20);
    for (size_t k = 0; k < SETS; k++) CU_ASSERT(of_set[k] >= 3);
    CU_ASSERT(contacts > 500);
}

/* A run of each integrator, stopped at any step and continued, is the run that was not stopped. */
static void any_step(void)
{
    enum { STEPS = 40 };
    for (int integrator = 0; integrator < DEM_INTEGRATORS; integrator++)
        for (int features = 0; features <= GRAVITY_TURNS; features += GRAVITY_TURNS) {
            dem_definition def = scene_of(features);
            def.integrator = (dem_integrator)integrator;
            if (!dem_schemes[integrator]->rotation) def.rotation = false;
            if (dem_schemes[integrator]->solves) def.tangential = DEM_NONE, def.material.mu = 0.0;
            for (size_t w = 0; w < def.n_walls; w++) def.walls[w].material = def.material;
            def.dt = fmin(def.dt, 0.5 * dem_time_step_limit(&def, NULL));
            scoped_sim *sim = grains_start(&def), *end = grains_start(&def);
            advance(sim, HALF), advance(end, HALF + STEPS);
            for (int step = 0; step < STEPS; step++) {
                scoped_sim *copy = grains_kept(sim);
                advance(copy, STEPS - step);
                CU_ASSERT(same(end, copy));
                advance(sim, 1);
            }
        }
}

/* So many grains that a step takes them in chunks, and runs ahead. */
static void large_pile(void)
{
    enum { SIDE = 130, N = SIDE * SIDE };
    scoped dem_grain *grains = calloc(N, sizeof *grains);
    for (int i = 0; i < N; i++)
        grains[i] = (dem_grain){0.1 + 0.198 * (i % SIDE) + 0.099 * (i / SIDE % 2), 0.1 + 0.172 * (i / SIDE),
                                0.1, 0.004, 3.0 * ((i * 7919) % 101 - 50)};
    dem_definition def = dem_definition_default();
    grains_on_floor(&def, N, grains);
    scoped_sim *sim = grains_start(&def);
    advance(sim, 30);
    scoped_sim *copy = grains_kept(sim);
    advance(sim, 30);
    advance(copy, 30);
    const dem_counts counts = grains_counts(sim);
    CU_ASSERT(counts.pairs > 6 * 8192 && counts.rebuilds > 2 && same(sim, copy));
}

/* ---- Files ---- */

/* Write the state of a small scene to the file s; its simulation. */
static dem_sim *write_small(long steps)
{
    dem_definition def = scene_of(LEDGER);
    def.n_grains = 10;
    dem_sim *sim = grains_start(&def);
    advance(sim, steps);
    RP_ENDS(rp_snapshot_free) rp_snapshot s = {0};
    dem_keep(&s, &sim);
    CHECK_OK(rp_snapshot_write(&s, path_of("s"), "test", dem_keep_layout()));
    return sim;
}

/* Read the file s. */
static rp_status read_small(const char *owner, uint64_t layout, dem_sim **sim)
{
    RP_ENDS(rp_snapshot_free) rp_snapshot s;
    rp_status status = rp_snapshot_read(&s, path_of("s"), owner, layout);
    *sim = NULL;
    if (!status) {
        dem_keep(&s, sim);
        status = rp_snapshot_end(&s);
    }
    return status;
}

static void refused(const char *text)
{
    dem_sim *sim;
    CHECK_FAILS(read_small("test", dem_keep_layout(), &sim), RP_BAD_INPUT, text);
    CU_ASSERT_PTR_NULL(sim);
    CU_ASSERT(strstr(rp_message(), path_of("s")) != NULL); /* which file */
}

/* Where numbers of the head are; its size. */
enum { AT_FORMAT = 16, AT_MODEL = 20, HEAD = 80 };

/* Put the checksum that belongs to the bytes. */
static void sign(unsigned char *bytes, size_t n)
{
    const XXH128_hash_t head = XXH3_128bits(bytes, HEAD),
                        all = XXH3_128bits_withSeed(bytes + HEAD, n - HEAD - sizeof all,
                                                    head.low64 ^ head.high64);
    memcpy(bytes + n - sizeof all, &all, sizeof all);
}

static void damaged_files(void)
{
    scoped_sim *sim = write_small(50), *copy = NULL;
    size_t n;
    scoped unsigned char *bytes = file_read(path_of("s"), &n);
    CHECK_OK(read_small("test", dem_keep_layout(), &copy));
    CU_ASSERT(same(sim, copy));
    for (size_t k = 0; k < n; k += k < HEAD + 20 || k > n - 20 ? 1 : 50) {
        bytes[k] ^= 0x10;
        file_write(path_of("s"), bytes, n);
        refused(k < AT_FORMAT       ? "not a snapshot of repose"
                : k < AT_MODEL      ? "format version"
                : k >= 32 && k < 40 ? " expected"
                                    : "damaged: its checksum is wrong");
        bytes[k] ^= 0x10;
    }
    const size_t cut[] = {1, 15, 16, HEAD - 1, HEAD, HEAD + 15, HEAD + 16, n / 2, n - 16, n - 1};
    for (size_t k = 0; k < sizeof cut / sizeof *cut; k++) {
        file_write(path_of("s"), bytes, cut[k]);
        refused("truncated: ");
    }
    file_write(path_of("s"), bytes, 0);
    refused("truncated: 0 bytes");
    file_write(path_of("s"), bytes, n + 1);
    refused("damaged: ");
    file_write(path_of("s"), "gravity = ( 0.0, -981.0 );", 26);
    refused("not a snapshot of repose");
    unlink(path_of("s"));
    refused("No such file");
    CU_ASSERT(mkdir(path_of("s"), 0777) == 0);
    refused("not a regular file");
}

static void foreign_files(void)
{
    dem_sim *sim = write_small(20), *copy;
    size_t n;
    CHECK_FAILS(read_small("other", dem_keep_layout(), &copy), RP_BAD_INPUT,
                "the state of another run: \"test\", not \"other\"");
    CHECK_FAILS(read_small("test", 1, &copy), RP_BAD_INPUT, "another layout of the state");
    unsigned char *bytes = file_read(path_of("s"), &n), first = bytes[AT_FORMAT];
    bytes[AT_FORMAT] = RP_SNAPSHOT_FORMAT + 1;
    sign(bytes, n);
    file_write(path_of("s"), bytes, n);
    refused("format version 2; this program reads 1");
    bytes[AT_FORMAT] = first;
    bytes[AT_MODEL]--;
    sign(bytes, n);
    file_write(path_of("s"), bytes, n);
    refused("made by model version ");
    free(bytes), dem_free(sim);
}

/* A state with a true checksum that no simulation has: refused, or run to some end; never a crash. */
static void impossible_states(void)
{
    dem_definition def = scene_of(LEDGER | GRAVITY_TURNS | FIXED);
    dem_sim *sim = grains_start(&def), *copy = sim;
    advance(sim, HALF);
    RP_ENDS(rp_snapshot_free) rp_snapshot s = {0};
    dem_keep(&s, &copy);
    size_t refusals = 0;
    s.reading = true, s.path = "memory";
    for (size_t k = 3; k < s.n; k += k < 4000 ? 7 : 97) {
        const unsigned char before = s.bytes[k];
        s.bytes[k] = k % 2 ? 0xff : (unsigned char)~before;
        s.at = 0, s.status = RP_OK;
        dem_keep(&s, &copy);
        rp_status status = rp_snapshot_end(&s);
        CU_ASSERT((status == RP_OK && copy) || (status == RP_BAD_INPUT && !copy));
        CHECK_OR_SAY(!status || strncmp(rp_message(), "memory: ", 8) == 0, "byte %zu: %s", k, rp_message());
        refusals += status != RP_OK;
        if (copy) dem_run(copy, 3); /* to any end */
        dem_free(copy);
        s.bytes[k] = before;
    }
    CHECK_OR_SAY(refusals > 5, "%zu refusals", refusals);
    s.n -= 5, s.at = 0, s.status = RP_OK;
    dem_keep(&s, &copy);
    CU_ASSERT(s.status == RP_BAD_INPUT && !copy);
    CU_ASSERT_STRING_EQUAL(rp_message(), "memory: its state ends too early");
    dem_free(sim);
}

/* Each word and truth of the list of parameters is checked. */
static void unknown_words(void)
{
    static const struct {
        const char *name;
        size_t at;
        rp_type type;
    } members[] = {
#define MEMBER(kind, type, name, ...) DEM_IF_SCENE(kind, {#name, offsetof(dem_sim, def.name), type}, )
        DEM_PHYSICS(MEMBER)};
    dem_definition def = scene_of(FIXED);
    dem_sim *sim = grains_start(&def), *copy = sim;
    RP_ENDS(rp_snapshot_free) rp_snapshot s = {0};
    dem_keep(&s, &copy);
    s.reading = true, s.path = "memory";
    for (size_t k = 0; k < sizeof members / sizeof *members; k++) {
        unsigned char *byte = s.bytes + members[k].at;
        const unsigned char before = *byte;
        if (members[k].type == RP_REAL) continue;
        *byte = 77;
        s.at = 0, s.status = RP_OK;
        dem_keep(&s, &copy);
        CHECK_OR_SAY(s.status == RP_BAD_INPUT && strstr(rp_message(), "unknown words"), "%s",
                     members[k].name);
        CU_ASSERT_PTR_NULL(copy);
        *byte = before;
    }
    dem_free(sim);
}

/* Without room for the new one, the older snapshot stays, and no other file. */
static void full_disk(void)
{
    scoped_sim *sim = write_small(20), *copy = NULL;
    const struct rlimit little = {2000, RLIM_INFINITY}, all = {RLIM_INFINITY, RLIM_INFINITY};
    RP_ENDS(rp_snapshot_free) rp_snapshot s = {0};
    advance(sim, 20);
    dem_keep(&s, &sim);
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &little);
    CHECK_FAILS(rp_snapshot_write(&s, path_of("s"), "test", dem_keep_layout()), RP_IO,
                "cannot write: File too large");
    setrlimit(RLIMIT_FSIZE, &all);
    CHECK_FAILS(rp_snapshot_write(&s, path_of("none/s"), "test", dem_keep_layout()), RP_IO, "No such file");
    CHECK_OK(read_small("test", dem_keep_layout(), &copy));
    CU_ASSERT(dem_step(copy) == 20);
    SHELL("test \"$(ls -I out -I err)\" = s");
}

/* Of fault_watch: what is done with the files of a folder, f: a file synced, r: renamed, d: folder synced. */
static char done[16];

static void note_done(const char *call, int file, const char *from, const char *to)
{
    struct stat info, of_folder;
    (void)from;
    const bool sync = strcmp(call, "fsync") == 0 && fstat(file, &info) == 0 &&
                      stat(path_of("."), &of_folder) == 0,
               own = sync && S_ISDIR(info.st_mode) && info.st_ino == of_folder.st_ino;
    if ((sync || to) && strlen(done) < sizeof done - 1) strcat(done, to ? "r" : own ? "d" : "f");
}

/* A snapshot is on the disk, and then its name is. */
static void synced(void)
{
    RP_ENDS(rp_snapshot_free) rp_snapshot s = {0};
    long step = 7;
    RP_KEEP(&s, step);
    *done = '\0';
    fault_watch = note_done;
    CHECK_OK(rp_snapshot_write(&s, path_of("s"), "test", 1));
    fault_watch = NULL;
    CU_ASSERT_STRING_EQUAL(done, "frd");
}

CHECK_SUITE_WITHIN(snapshot, "snapshot", enter, leave, every_law_integrator_and_feature, any_step, large_pile,
                   damaged_files, foreign_files, impossible_states, unknown_words, full_disk, synced)
