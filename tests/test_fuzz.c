/* The corpus of the fuzzer, read again: inputs that reach much of the readers, and that once broke one. */
#include <dirent.h>
#include <limits.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/folder.h"
#include "tests/fuzz/targets.h"
#include "tests/grains.h"
#include "tests/numbers.h"

enum { MOST_BYTES = 1 << 16 };

static char corpus[PATH_MAX];

/* Run each file of the target's folder; `path` is the last one. */
static int replay(const fuzz_target *target, char path[])
{
    static char name[PATH_MAX];
    snprintf(name, sizeof name, "%.4000s/%s", corpus, target->name);
    DIR *folder = opendir(name);
    int n = 0;
    for (struct dirent *e; folder && (e = readdir(folder));) {
        if (e->d_name[0] == '.') continue;
        snprintf(path, PATH_MAX, "%.2000s/%.255s", name, e->d_name);
        size_t size;
        scoped char *bytes = file_read(path, &size);
        fuzz_run(target, size < MOST_BYTES ? size : MOST_BYTES, bytes);
        n++;
    }
    if (folder) closedir(folder);
    return n;
}

/* Each target in a process, so that a failure names its input. What a process prints is shown if it fails. */
static void every_target(void)
{
    char line[1024];
    char *path = mmap(NULL, PATH_MAX, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    CU_ASSERT_FATAL(realpath("tests/fuzz/corpus", corpus) != NULL && path != MAP_FAILED);
    for (const fuzz_target *t = fuzz_targets; t->name; t++) {
        FILE *said = tmpfile();
        int status = -1;
        strcpy(path, "no corpus");
        fflush(NULL);
        const pid_t child = fork();
        if (child == 0) {
            const bool ready =
                fuzz_enter() && freopen("/dev/null", "w", stdout) && dup2(fileno(said), STDERR_FILENO) >= 0;
            const int n = ready ? replay(t, path) : 0;
            fuzz_leave();
            exit(n == 0);
        }
        CU_ASSERT(child > 0 && waitpid(child, &status, 0) == child && status == 0);
        rewind(said);
        if (status) fprintf(stderr, "fuzz: %s: %s\n", t->name, path);
        while (status && fgets(line, sizeof line, said)) fputs(line, stderr);
        fclose(said);
    }
}

/* ---- extreme scenes ---- */

/* "key = value; " with a value near an end of what the parameter allows, or nothing. */
static void write_key(FILE *out, gsl_rng *r, const rp_param *p)
{
    static const char *const reals[] = {"0.0", "5e-324", "1e-300", "1e-30", "1e-9",  "0.125",  "1.0", "2.385",
                                        "1e9", "1e30",   "1e300",  "1e304", "-1e-9", "-1e300", "-1.0"};
    static const char *const wholes[] = {"0", "1", "2", "8", "2147483647"};
    _Alignas(max_align_t) char values[4096];
    char chosen[128] = "";
    const char *number = p->type == RP_INT ? wholes[gsl_rng_uniform_int(r, sizeof wholes / sizeof *wholes)]
                                           : reals[gsl_rng_uniform_int(r, sizeof reals / sizeof *reals)];
    /* the damping that leaves next to no speed takes half a minute to find */
    if (strcmp(p->name, "restitution") == 0) number = "0.125";
    if ((p->type == RP_REAL || p->type == RP_INT) && rp_params_set_text(p, RP_CGS, values, number) == RP_OK)
        fprintf(out, "%s = %s; ", p->name, number);
    if (p->type == RP_BOOL) fprintf(out, "%s = %s; ", p->name, gsl_rng_uniform_int(r, 2) ? "true" : "false");
    if (p->type != RP_CHOICE) return;
    const char *words = p->range;
    size_t n = 0;
    for (char word[128]; check_word(&words, " |", word);)
        if (gsl_rng_uniform_int(r, ++n) == 0) strcpy(chosen, word);
    fprintf(out, "%s = \"%s\"; ", p->name, chosen);
}

/* Some keys of the group, each with this chance. */
static void write_keys(FILE *out, gsl_rng *r, const char *group, double chance)
{
    for (const dem_scene_group *g = dem_scene_schemas; g->name; g++)
        for (const rp_param *p = strcmp(g->name, group) ? NULL : g->schema; p && p->name; p++)
            if (gsl_rng_uniform(r) < chance) write_key(out, r, p);
}

static void write_extreme(FILE *out, gsl_rng *r)
{
    static const char *const groups[] = {"normal", "tangential", "rolling", "ground", "hard", "implicit"};
    write_keys(out, r, "scene", 0.1);
    for (size_t i = 0; i < sizeof groups / sizeof *groups; i++) {
        if (gsl_rng_uniform(r) > (i < 2 ? 0.5 : 0.1)) continue;
        fprintf(out, "%s = { ", groups[i]);
        write_keys(out, r, groups[i], i < 3 ? 0.3 : 0.9);
        fputs("};\n", out);
    }
    fputs("walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; ", out);
    write_keys(out, r, "walls", 0.05);
    fputs("} );\nparticles = ( ", out);
    for (int i = 0; i < 4; i++) {
        fprintf(out, "%s{ x = %g; y = 0.099; r = 0.1; ", i ? ",\n" : "", 0.199 * i);
        if (i == 3) write_keys(out, r, "particles", 0.1);
        fputs("}", out);
    }
    fputs(" );\n", out);
}

/* Refused, ended with a reason, or run; never a crash, and what has run has finite numbers. */
static void extreme_scenes(void)
{
    enum { SCENES = 640, LEAST_RUN = 60 };
    int n_run = 0, n_bad = 0;
    for (unsigned long i = 0; i < SCENES; i++) {
        char text[8192] = "";
        scoped_rng *r = numbers_of(18, i);
        CHECK_WRITTEN(written, out, write_extreme(out, r));
        scoped_scene scene = {0};
        scoped_sim *sim = NULL;
        rp_status status = grains_read(written, NULL, &scene);
        scene.def.implicit.max_iterations = 20;
        if (!status) status = dem_scene_start(&scene, &sim);
        if (!status) status = dem_run(sim, 20);
        out = fmemopen(text, sizeof text, "w");
        if (!status) status = dem_write_rows(DEM_TABLE_STATES, sim, dem_step(sim), out);
        fclose(out);
        n_run += !status;
        if (!status && (strstr(text, "nan") || strstr(text, "inf")))
            n_bad++, fprintf(stderr, "scene %lu: %s\n", i, text);
    }
    CU_ASSERT(n_run >= LEAST_RUN && n_bad == 0);
    if (n_run < LEAST_RUN) fprintf(stderr, "%d of %d scenes ran\n", n_run, SCENES);
}

CHECK_SUITE(fuzz, "fuzz", every_target, extreme_scenes)
