/* Targets of the fuzzer; see targets.h. The variable FUZZ names the target of a libFuzzer build. */
#include "tests/fuzz/targets.h"

#include <fcntl.h>
#include <ftw.h>
#include <sqlite3.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "params/config.h"
#include "experiment/experiment.h"
#include "dem/state/state.h"

/* The programs' own main, as functions. */
int repose_main(int argc, char **argv);
int report_main(int argc, char **argv);
#define main repose_main
#include "cli/repose.c"
#undef main
#define main report_main
#include "report/main.c"
#undef main

static char folder[64];
static int begin = -1; /* the folder before */

static void demand(bool right, const char *promise)
{
    if (right) return;
    fprintf(stderr, "fuzz: %s: %s\n", promise, rp_message());
    abort();
}

static void put(const char *name, size_t n, const char text[])
{
    const int file = open(name, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    demand(file >= 0 && write(file, text, n) == (ssize_t)n, "cannot write");
    close(file);
}

static void put_text(const char *name, const char *text)
{
    put(name, strlen(text), text);
}

/* The first word is the program's name, or `repose` is meant. */
static int run_words(int argc, char **argv)
{
    static char name[] = "repose";
    argv[0] = name;
    argv[argc] = NULL;
    return argc > 1 && strcmp(argv[1], "report") == 0 ? report_main(argc - 1, argv + 1)
                                                      : repose_main(argc, argv);
}

/* A command line of words that a separator divides; returns its exit status. */
static int run_line(const char *line, const char *separator)
{
    enum { MOST_WORDS = 40 };
    char text[4096], *words[MOST_WORDS + 2], *save;
    int n = 1;
    snprintf(text, sizeof text, "%s", line);
    for (char *word = strtok_r(text, separator, &save); word && n <= MOST_WORDS;
         word = strtok_r(NULL, separator, &save))
        words[n++] = word;
    return run_words(n, words);
}

/* ---- scenes ---- */

/* Scenes of a few grains run for some steps. */
static void use_scene(dem_scene *scene)
{
    dem_sim *sim = NULL;
    const bool small = scene->fills ? scene->fills->N <= 30 : scene->def.n_grains <= 30;
    scene->def.implicit.max_iterations = 20;
    if (small && dem_scene_start(scene, &sim) == RP_OK) (void)!dem_run(sim, 5);
    dem_free(sim);
}

static void read_scene(size_t n, const char text[])
{
    (void)n, (void)text;
    dem_scene scene;
    if (dem_scene_read("s.cfg", NULL, &scene) == RP_OK) use_scene(&scene);
    dem_scene_free(&scene);
}

/* An experiment, for a while: each of its looks, and an end with a word. */
static void read_experiment(size_t n, const char bytes[])
{
    (void)n, (void)bytes;
    dem_text text;
    exp_plan *plan = NULL;
    exp_run *run = NULL;
    rp_status status = dem_text_open("e.cfg", NULL, NULL, &text);
    if (!status) status = exp_read(&text, &plan);
    if (!status) status = exp_check(plan);
    if (!status && exp_scene(plan)->fills && exp_scene(plan)->fills->N > 200) status = RP_NO_RESULT;
    if (!status) status = exp_start(plan, 1, 2, &run);
    for (int k = 0; !status && k < 300 && !exp_done(run); k++) status = exp_advance(run, 20);
    demand(status || !exp_done(run) || *exp_ended(run)->status, "an end without a word");
    exp_run_free(run);
    exp_free(plan);
    dem_text_close(&text);
}

/* The text of --set. */
static void read_set(size_t n, const char text[])
{
    dem_scene scene;
    char *change = strndup(text, n);
    const rp_texts changes = {1, {change}};
    if (dem_scene_read("scene.cfg", &changes, &scene) == RP_OK) use_scene(&scene);
    dem_scene_free(&scene);
    free(change);
}

/* Change bytes of a state: three numbers each, place (two bytes) and byte. */
static void change_bytes(size_t size, char bytes[], size_t n, const char text[])
{
    for (size_t i = 0; i + 2 < n && i < 60; i += 3) {
        const size_t place = (unsigned char)text[i] * 256u + (unsigned char)text[i + 1];
        if (place < size) bytes[place] = text[i + 2];
    }
}

/* A value of any parameter: accepted, it is written and reads back the same. The first bytes choose. */
static void read_param(size_t n, const char text[])
{
    _Alignas(max_align_t) char values[4096];
    char first[256], second[256];
    if (n < 2 || n > 100) return;
    const size_t group = (unsigned char)text[0] % 10;
    const rp_param *schema = dem_scene_schemas[group].schema;
    size_t row = (unsigned char)text[1], rows = 0;
    if (group == 9) schema = sweep_protocols[row / 51 % 5]->schema;
    while (schema[rows].name) rows++;
    if (rows == 0) return; /* of a text */
    const rp_param *p = &schema[row % rows];
    char *value = strndup(text + 2, n - 2);
    rp_params_defaults(schema, RP_CGS, values);
    if (p->type != RP_TEXT && p->type != RP_TEXTS && rp_params_set_text(p, RP_CGS, values, value) == RP_OK) {
        rp_params_text(p, values, first, sizeof first);
        demand(rp_params_set_text(p, RP_CGS, values, first) == RP_OK, "a written value is refused");
        demand(strcmp(rp_params_text(p, values, second, sizeof second), first) == 0, "another value is read");
    }
    free(value);
}

/* ---- sweeps ---- */

static size_t count(size_t n, const char text[], char c)
{
    size_t found = 0;
    for (size_t i = 0; i < n; i++) found += text[i] == c;
    return found;
}

/* Plans of few runs only: their number is what takes the time. */
static void read_sweep(size_t n, const char text[])
{
    RP_ENDS(sweep_recipe_free) sweep_recipe recipe;
    sweep_counts counts;
    (void)!sweep_recipe_read("s.cfg", &recipe);
    const char *replicas = memmem(text, n, "replicas", 8);
    if (count(n, text, ',') > 12 || count(n, text, '@') ||
        (replicas && memmem(replicas + 8, (size_t)(text + n - replicas) - 8, "replicas", 8)))
        return;
    for (size_t digits = 0; replicas && replicas < text + n && *replicas != ';' && *replicas != '\n';
         replicas++)
        if (strchr("0123456789abcdefABCDEF", *replicas) && *replicas && ++digits > 4) return;
    const rp_status status = sweep_prepare("s.cfg", "planned", 0, sweep_protocols, &counts);
    demand(status != RP_BROKEN && (status || counts.planned > 0), "a plan is broken");
    unlink("planned/store.sqlite");
}

typedef struct {
    double x;
} toy;

static const rp_param toy_schema[] = {{"x", "", RP_REAL, offsetof(toy, x), "0.25", "[-10, 10]", "x"}, {0}};
static const sweep_output toy_outputs[] = {{"y", "", "x"}, {0}};

static rp_status toy_check(const void *params)
{
    (void)params;
    return RP_OK;
}

static rp_status toy_run(const void *params, unsigned long seed, unsigned long run,
                         const sweep_tables *tables, sweep_result *result)
{
    (void)seed, (void)run, (void)tables;
    result->values[0] = ((const toy *)params)->x;
    strcpy(result->status, "ok");
    return RP_OK;
}

static const sweep_protocol toy_protocol = {
    "toy", "toy", toy_schema, sizeof(toy), toy_outputs, .check = toy_check, .run = toy_run};
static const sweep_protocol *const toys[] = {&toy_protocol, NULL};

static char whole_store[1 << 17];
static size_t store_size;

/* Small pages, so that more bytes mean something, and a rollback journal: a reader of a write-ahead log makes
 * two files each time. An input may ask for the log again. */
static bool make_small(const char *path)
{
    sqlite3 *db;
    const bool good = sqlite3_open(path, &db) == SQLITE_OK &&
                      sqlite3_exec(db, "PRAGMA journal_mode = DELETE; PRAGMA page_size = 512; VACUUM", NULL,
                                   NULL, NULL) == SQLITE_OK;
    sqlite3_close(db);
    return good;
}

static bool make_store(void)
{
    sweep_counts counts;
    put_text("toy.cfg", "protocol = \"toy\"; replicas = 2; grid = { x = [0.1, 2.385]; };\n");
    if (sweep_prepare("toy.cfg", "d", 0, toys, &counts) ||
        sweep_run("d", toys, &(sweep_options){.workers = 1}, &counts) || !make_small("d/store.sqlite"))
        return false;
    FILE *in = fopen("d/store.sqlite", "r");
    store_size = in ? fread(whole_store, 1, sizeof whole_store, in) : 0;
    if (in) fclose(in);
    return store_size > 0 && store_size < sizeof whole_store;
}

/* One of four questions in the fuzzer, by the input's length; all of them in a test. */
static bool asks(size_t n, size_t question)
{
    return !getenv("FUZZ") || n % 4 == question;
}

/* A good store with changes, three numbers each: place (two) and byte; the length, if beyond the end. */
static void read_store(size_t n, const char text[])
{
    static char bytes[sizeof whole_store];
    char digest[33];
    size_t size = store_size, rows;
    sweep_counts counts;
    memcpy(bytes, whole_store, size);
    change_bytes(size, bytes, n, text);
    if (n > 2 && text[0] == '\xff') size = (size_t)(unsigned char)text[2] * 256;
    unlink("d/store.sqlite-journal");
    put("d/store.sqlite", size < store_size ? size : store_size, bytes);
    FILE *out = fopen("/dev/null", "w");
    if (asks(n, 0)) (void)!sweep_status("d", toys, &counts);
    if (asks(n, 1)) (void)!sweep_export("d", toys, SWEEP_RUNS, NULL, NULL, out);
    if (asks(n, 2)) (void)!sweep_export("d", toys, SWEEP_POINTS, NULL, NULL, out);
    if (asks(n, 3)) (void)!sweep_digest("d", toys, digest, &rows);
    fclose(out);
}

/* ---- snapshots ---- */

static rp_snapshot whole_state; /* of two grains, one of them fixed */

static bool make_state(void)
{
    dem_scene scene;
    dem_sim *sim = NULL;
    bool made = dem_scene_read("scene.cfg", NULL, &scene) == RP_OK &&
                dem_scene_start(&scene, &sim) == RP_OK && dem_run(sim, 20) == RP_OK;
    if (made) dem_keep(&whole_state, &sim);
    dem_free(sim);
    dem_scene_free(&scene);
    return made && !whole_state.status;
}

/* The input as a file; then a good state with bytes changed, as in read_store, which no checksum guards. What
 * is taken for a state must run to some end. The numbers that memory is allocated for stay. */
static void read_snapshot(size_t n, const char text[])
{
    static const size_t fixed[] = {offsetof(dem_sim, grains.capacity), offsetof(dem_sim, grains.last_id)};
    rp_snapshot s;
    dem_sim *sim = NULL;
    (void)!rp_snapshot_read(&s, "snapshot", "fuzz", dem_keep_layout());
    rp_snapshot_free(&s);
    s = (rp_snapshot){
        .reading = true, .path = "snapshot", .bytes = malloc(whole_state.n), .n = whole_state.n};
    memcpy(s.bytes, whole_state.bytes, s.n);
    change_bytes(s.n, (char *)s.bytes, n, text);
    for (int k = 0; k < 2; k++) memcpy(s.bytes + fixed[k], whole_state.bytes + fixed[k], sizeof(size_t));
    dem_keep(&s, &sim);
    demand((sim != NULL) == (s.status == RP_OK), "a simulation without a state");
    if (sim) (void)!dem_run(sim, 3);
    dem_free(sim);
    rp_snapshot_free(&s);
}

/* ---- the command line ---- */

static bool has(const char *text, const char *part)
{
    return strstr(text, part) != NULL;
}

/* A pile of the default size takes longer than a hundred other lines and reads no more. */
static bool is_small(const char *line)
{
    const char *base = strstr(line, "--base\n");
    return strncmp(line, "pile", 4) != 0 || (base && strtol(base + strlen("--base\n"), NULL, 10) < 20);
}

/* Long runs, processes and files elsewhere are left out: commands that work long, numbers of three digits. */
static bool is_harmless(const char *line)
{
    int digits = 0;
    for (const char *c = line; *c; c++) {
        digits = *c >= '0' && *c <= '9' ? digits + 1 : 0;
        if (digits == 3 || *c == '/' || (digits && (c[1] == 'e' || c[1] == 'E'))) return false;
    }
    if (!is_small(line)) return false;
    if (has(line, "sweep\nrun") || has(line, "sweep\nmake") || strncmp(line, "bench", 5) == 0) return false;
    return strncmp(line, "calibrate", 9) != 0 || (has(line, "fit.cfg") && !has(line, "--theta"));
}

static int remove_entry(const char *path, const struct stat *info, int type, struct FTW *ftw)
{
    (void)info, (void)type;
    return ftw->level > 0 ? remove(path) : 0;
}

static bool make_files(void);

static void read_line(size_t n, const char text[])
{
    static unsigned runs;
    char *line = strndup(text, n);
    if (n < 4000 && is_harmless(line)) run_line(line, "\n");
    free(line);
    if (++runs % 1000) return;
    nftw(".", remove_entry, 8, FTW_DEPTH | FTW_PHYS);
    demand(make_files(), "cannot write");
}

/* ---- the list ---- */

#define TABLE(NAME, WORDS)                                                                                   \
    {                                                                                                        \
        NAME, {"t.tsv", NULL}, NULL, WORDS, NULL, false                                                      \
    }
#define TABLES(NAME, WORDS, A, B, OTHER)                                                                     \
    {                                                                                                        \
        NAME, {A, B}, OTHER, WORDS, NULL, false                                                              \
    }

static const char scene_text[] =
    "dt = 1.0e-4; steps = 2; gravity = [0.0, -981.0]; tangential = { law = \"spring\"; mu = 0.2; };\n"
    "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } );\n"
    "particles = ( { x = 0.1; y = 0.09; r = 0.1; }, { x = 0.295; y = 0.1; r = 0.1; fixed = true; } );\n";
static const char table_text[] =
    "# units: 1\t1\n# a\tb\tc\ts\tpile\tstatus\n1\t2\t1\t0.1\t1\tok\n2\t3.5\t1\t0.1\t2\tok\n"
    "3\t5.25\t2\t0.1\t3\tok\n4\t7\t2\t0.2\t4\tfell\n";
static const char claims_text[] =
    "id\tof\tpaper\tplace\tsection\ttest\tpublished\tpublished_se\tsamples\tmargin\tanswer\tagainst\t"
    "statement\tnote\n"
    "angle\t-\tlh\tp. 1\tlh1\tagrees\t2.10\t1\t20\t-\tmany a=1 b\t-\tangle\t-\n"
    "high\t-\tli\tp. 2\tlh1\tabove\t-\t-\t-\t-\tmany a=2 b\t0.5\tabove\t-\n";
static const char grains_text[] = "# x\ty\tm\n1\t1\t1\n1.1\t1.5\t1\n";

const fuzz_target fuzz_targets[] = {
    {"scene", {"s.cfg", "included.cfg"}, "steps = 3;\n", NULL, read_scene, true},
    {"experiment", {"e.cfg", NULL}, NULL, NULL, read_experiment, true},
    {"set", {"set.txt", NULL}, NULL, NULL, read_set, true},
    {"param", {"param.txt", NULL}, NULL, NULL, read_param, false},
    {"sweep", {"s.cfg", NULL}, NULL, NULL, read_sweep, false},
    {"store", {"store.txt", NULL}, NULL, NULL, read_store, false},
    {"snapshot", {"snapshot", NULL}, NULL, NULL, read_snapshot, false},
    {"line", {"line.txt", NULL}, NULL, NULL, read_line, true},
    TABLES("claims", "report claims --variants --claims c.tsv --tables .", "c.tsv", "many.tsv", table_text),
    TABLES("report", "report page in.md --claims c.tsv --tables .", "in.md", "many.tsv", table_text),
    {"particles", {"t.tsv", NULL}, NULL, "run particles.cfg", NULL, true},
    {"bench", {"t.tsv", NULL}, NULL, "bench --start t.tsv --steps 2 --repeat 1", NULL, true},
    TABLE("angle_slope", "angle slope t.tsv --width 4"),
    TABLE("angle_compare", "angle compare t.tsv --bootstrap 5"),
    TABLE("stress_dip", "stress dip t.tsv --profile"),
    TABLES("stress_field", "stress field t --width 4", "t_contacts.tsv", "t_grains.tsv", grains_text),
    TABLES("view", "view t_grains.tsv -o t.svg --color r --base --cell 0.1", "t_contacts.tsv", "t_grains.tsv",
           "step\tx\ty\tr\n1\t1\t1\t1\n2\t1.1\t1.5\t1\n"),
    TABLES("view_grains", "view t_grains.tsv -o t.svg --color r --base --cell 0.1", "t_grains.tsv",
           "t_contacts.tsv", "step\tx\ty\tx_b\ty_b\tforce\n1\t1\t1\t1\t0\t3\n"),
    TABLES("stress_base", "stress base t --width 4 --floor 1", "t_contacts.tsv", "t_grains.tsv", grains_text),
    TABLE("stats_select", "stats select t.tsv --columns a,b --where a>1.5 --where c!=x"),
    TABLE("export_json", "export t.tsv --to json"),
    TABLES("export_dump", "export t_grains.tsv --to lammps -o t.dump", "t_contacts.tsv", "t_grains.tsv",
           grains_text),
    TABLES("export_vtk", "export t_grains.tsv --to vtk -o t.pvd", "t_walls.tsv", "t_grains.tsv", grains_text),
    TABLE("stats_fit", "stats fit t.tsv -x a -y b --se s"),
    TABLE("stats_trend", "stats trend t.tsv -x a -y b --by c --pair"),
    TABLE("stats_size", "stats size t.tsv -x a -y b --by c"),
    TABLE("stats_correlation", "stats correlation t.tsv -x a -y b --by c"),
    TABLE("calibrate", "calibrate fit.cfg"),
    {NULL, {NULL, NULL}, NULL, NULL, NULL, false}};

static bool make_files(void)
{
    put_text("scene.cfg", scene_text);
    put_text("particles.cfg", "particles_file = \"t.tsv\"; steps = 2; normal = { gamma_n = 0.0; };\n");
    put_text("sweep.cfg", "protocol = \"pile\"; replicas = 2; fixed = { base = 3; };\n");
    put_text("fit.cfg", "fit = { mu = [0.1, 0.8]; }; measured = ( { runs = \"t.tsv\"; of = \"theta_r3_deg\"; "
                        "value = 20.0; error = 1.0; } );\n");
    put_text("t.tsv", table_text);
    put_text("many.tsv", table_text);
    put_text("c.tsv", claims_text);
    put_text("in.md", "{{value many a=1 b}} {{verdict high}}\n{{claims lh1}}\n");
    return true;
}

bool fuzz_enter(void)
{
    const char *parent = getenv("TMPDIR");
    /* in memory, where there is such a file system: a sync of the store takes longer than all the rest */
    if (!parent) parent = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
    snprintf(folder, sizeof folder, "%.40s/repose_fuzz_XXXXXX", parent);
    begin = open(".", O_RDONLY | O_CLOEXEC);
    if (begin < 0 || !mkdtemp(folder) || chdir(folder) != 0) return false;
    return make_files() && make_store() && make_state();
}

void fuzz_leave(void)
{
    nftw(".", remove_entry, 8, FTW_DEPTH | FTW_PHYS);
    (void)!fchdir(begin);
    rmdir(folder);
    close(begin);
}

void fuzz_run(const fuzz_target *target, size_t n, const char bytes[])
{
    const char *zero = target->files[1] ? memchr(bytes, 0, n) : NULL;
    const size_t first = zero ? (size_t)(zero - bytes) : n;
    /* nothing outside the folder */
    if (memmem(bytes, n, "/dev", 4) || memmem(bytes, n, "/proc", 5)) return;
    put(target->files[0], first, bytes);
    if (zero)
        put(target->files[1], n - first - 1, zero + 1);
    else if (target->files[1])
        put_text(target->files[1], target->other);
    if (target->act) {
        target->act(n, bytes);
        return;
    }
    const int status = run_line(target->words, " ");
    demand(status != RP_BROKEN || target->simulates, "exit status 70");
    demand(status != RP_USAGE || !has(rp_message(), "unknown"), "the target's own words are wrong");
}

/* ---- libFuzzer ---- */

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* libconfig 1.5 loses the text that it is reading where a file breaks off. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:libconfig.so\n";
}

static const fuzz_target *chosen;

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc, (void)argv;
    const char *name = getenv("FUZZ");
    for (chosen = fuzz_targets; chosen->name && name; chosen++)
        if (strcmp(chosen->name, name) == 0) break;
    demand(name && chosen->name, "FUZZ=target expected");
    demand(fuzz_enter(), "cannot make the folder");
    atexit(fuzz_leave);
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_run(chosen, size, (const char *)data);
    return 0;
}
