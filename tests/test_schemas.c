/* All that a text says is in the key of its run, or stands here with the reason why not: what the key
 * forgets, a sweep takes from another run's row. Every key of every schema, at every place of the texts below
 * where it may stand, and every value that the texts give. A new key of a schema needs no line here. Beside
 * that: values beyond a range, and other words, are refused by name, and a text that is written is the same
 * run. */
#include "tests/grains.h"
#include "tests/trial.h"

/* ---- texts, in which each group stands ---- */

#define BEGIN "dt = 2e-5; normal = { law = `linear`; k_n = 1e5; };\n"
#define WALLS                                                                                                \
    "walls = ( { name = `base`; point = (0.0, 0.0); direction = (0.1, 1.0); pivot = (0.5, 0.0); },\n"        \
    "  { name = `lid`; point = (0.0, 5.0); direction = (0.1, -1.0); velocity = (0.0, 0.1); },\n"             \
    "  { name = `ring`; circle = (20.0, 9.0, 3.0); sides = 5; }, { name = `gate`; open_speed = 9.0;\n"       \
    "    polygon = ( (30.0, 0.0), (30.0, 9.0), (31.0, 9.0) ); closed = false; },\n"                          \
    "  { name = `step`; point = (40.0, 1.0); direction = (0.6, 0.8); extent = (-1.0, `inf`); } );\n"
#define FLOOR                                                                                                \
    "walls = ( { point = (0.0, 0.0); direction = (0.1, 1.0); }, { point = (0.0, -9.0); direction = (0.1, "   \
    "1.0); } );\n"
#define GRAINS "particles = ( { x = 0.0; y = 0.1; r = 0.1; }, { x = 1.0; y = 0.1; r = 0.1; } );\n"
#define PHASE  "phases = ( { name = `only`; steps = 9; } );\n"

static const char *const texts[] = {
    BEGIN WALLS
    "let = { n = 3; };\n"
    "rotation = true; tangential = { law = `spring`; mu = 0.4; }; rolling = { mu = 0.1; };\n"
    "gravity = (0.0, -900.0); rest = { looks = 3; }; result = `ok_so`;\n"
    "fill = ( { kind = `ka`; N = 20; W = 2.0; H = 3.0; polygon = ( (0.0, 0.0), (2.0, 0.0), "
    "(1.0, 3.0) ); },\n"
    "  { if = `n > 2`; kind = `kb`; pattern = `row`; W = 2.0; x0 = 3.0; radius_law = `table`; radii = ( "
    "(0.1, 1.0), (0.11, "
    "2.0) ); } );\n"
    "regions = { part = { x = (0.0, 2.0); y = (0.0, `n`); }; half = { y = (1.0, `inf`); };\n"
    "  tri = { polygon = ( (0.0, 0.0), (2.0, 0.0), (1.0, 9.0) ); }; disk = { circle = (0.0, 0.0, 1.0); }; "
    "};\n"
    "phases = ( { name = `fall`; steps = 200; every = 20; fail = { low = `height < 0`; }; },\n"
    "  { name = `wait`; time = 0.01; gravity = (1.0, `-900 - t`); gravity_turn_deg_per_step = 0.01; },\n"
    "  { name = `press`; from = `fall`; every = 20; until = `height < 1`; most = 900; remove = `disk`;\n"
    "    dt = 1e-5; x_min = -9.0; x_max = 99.0; y_min = -9.0; normal = { k_n = 2e5; }; tangential = { mu = "
    "0.3; };\n"
    "    rolling = { mu = 0.2; }; walls = { base = { mu = 0.1; omega = `0.1*t`; velocity = (`t`, 0.0); }; }; "
    "},\n"
    "  { name = `feed`; repeat = 3; until = `grains > 50`; phases = ( { name = `drop`; steps = 50;\n"
    "    add = { N = 1; kind = `kc`; x = (2.2, 2.8); y = `touch + 1`; vx = 1.0; vy = -2.0; omega = 3.0; gap "
    "= "
    "0.01; density = 1.1;\n"
    "      radius_mean = 0.11; radius_width = 0.01; radius_min = 0.1; radius_max = 0.12; radius_law = "
    "`uniform`; by = `area`; }; },\n"
    "    { if = `n > 2`; name = `more`; steps = 5; add = { x = 7.0; y = (1.0, 9.0); r = 0.1; }; },\n"
    "    { name = `most`; steps = 5; add = { x = 8.0; y = 9.0; radius_law = `table`; radii = ( (0.1, 1.0), "
    "(0.11, 2.0) ); }; } ); },\n"
    "  { name = `ending`; open = `gate`; walls = { lid = { load_y = -10.0; load_x = 1.0; speed = 50.0; }; "
    "ring "
    "= "
    "{ omega = 1.0; }; };\n"
    "    steps = 50; },\n"
    "  { name = `free`; walls = { lid = { load_y = `none`; }; }; steps = 5; } );\n"
    "measure = ( { name = `h`; of = `height`; at = `fall`; }, { name = `w`; if = `n > 2`; of = `moved(0.1, "
    "2)`; },\n"
    "  { name = `a`; of = `y`; during = `fall`; take = `avalanches`; drop = 0.1; },\n"
    "  { name = `e`; of = `y`; during = `fall`; take = `avalanches`; event = `y > 1`; },\n"
    "  { name = `mid`; of = `y`; during = `fall`; take = `mean`; when = `y > 0`; skip = 0.1; },\n"
    "  { name = `v`; of = `part.syy + ka.y + lid.fy`; during = `press`; take = `mean`; },\n"
    "  { name = `l`; of = `y`; during = `fall`; take = `line`; against = `t`; level_of = `mid`; },\n"
    "  { name = `s`; of = `slope`; in = `part`; prefix = `t`; }, { name = `f`; of = `flanks`; columns = "
    "[`one`, `two`]; },\n"
    "  { name = `b`; of = `base`; wall = `base`; in = `part`; }, { name = `fab`; of = `fabric.force`; },\n"
    "  { name = `p`; of = `profile`; in = `part`; }, { name = `u`; of = `surface`; in = `part`; },\n"
    "  { name = `o`; of = `order`; }, { name = `lim`; of = `limit`; wall = `base`; in = `part`; },\n"
    "  { name = `mo`; of = `motion`; in = `part`; }, { name = `fo`; of = `forces`; wall = `base`; in = "
    "`part`; "
    "},\n"
    "  { name = `d`; of = `deposit`; kind = `ka`; },\n"
    "  { name = `mi`; of = `mixing`; in = `part`; kind = `ka`; cell = 0.5; } );\n",
    /* a group `material`, and coefficients that follow from a restitution */
    "dt = 2e-5; rotation = true; material = { E = 1e6; nu = 0.3; restitution = 0.5; mu = 0.3; };\n"
    "walls = ( { point = (0.0, 0.0); direction = (0.1, 1.0); restitution = 0.4; },\n"
    "  { point = (9.0, 0.0); direction = (-1.0, 0.1); extent = (0.0, 9.0); E = 2e6; nu = 0.2; mu = 0.1; } "
    ");\n" GRAINS PHASE,
    "dt = 2e-5; rotation = true; normal = { restitution_speed = 9.0; }; tangential = { law = `spring`; mu = "
    "0.3; };\n"
    "rolling = { mu = 0.1; }; gravity_turn_deg_per_step = 0.01; turn_from_step = 4; skin = 0.01;\n"
    "walls = ( { point = (0.0, 0.0); direction = (0.1, 1.0); restitution = 0.4; open_at_step = 7; } "
    ");\n"
    "particles = ( { x = 0.0; y = 0.1; r = 0.1; m = 0.004; vx = 1.0; vy = 2.0; angle = 3.0; omega = 4.0; },\n"
    "  { x = 1.0; y = 0.1; r = 0.1; fixed = true; } );\n" PHASE,
    BEGIN "tangential = { law = `slip_roll`; mu = 0.3; };\n" FLOOR
          "ground = { mu_static = 0.5; a = 0.01; };\n" GRAINS PHASE,
    "dt = 2e-5; normal = { law = `linear`; k_n = 1e5; tension = false; };\n" FLOOR
    "box_turn_deg_per_step = 0.01; hard = { restitution = 0.5; mu = 0.2; };\n" GRAINS
    "phases = ( { name = `only`; steps = 9; box_turn_deg_per_step = 0.02; } );\n",
    /* kinds, and what two of them have */
    BEGIN "rotation = true; tangential = { law = `spring`; mu = 0.3; }; rolling = { mu = 0.1; };\n"
          "kinds = { drop = { k_n = 2e5; }; disk = { }; dropx = { }; diskx = { }; };\n"
          "pairs = ( { of = (`drop`, `disk`); mu = 0.2; mu_roll = 0.1; gamma_s = 3.0; gamma_roll = 3.0; } "
          ");\n" FLOOR "particles = ( { kind = `drop`; x = 0.0; y = 0.1; r = 0.1; }, { kind = `disk`; x = "
          "1.0; y = 0.1; r = 0.1; } );\n" PHASE,
    "dt = 2e-5; rotation = true; material = { E = 1e6; nu = 0.3; restitution = 0.5; mu = 0.3; };\n"
    "kinds = { drop = { E = 2e6; nu = 0.2; density = 2.0; mu = 0.4; }; disk = { }; dropx = { }; diskx = { }; "
    "}; "
    "pairs_rule = `smaller`;\n"
    "pairs = ( { of = (`drop`, `disk`); restitution = 0.4; } );\n" FLOOR
    "particles = ( { kind = `drop`; x = 0.0; y = 0.1; r = 0.1; }, { kind = `disk`; x = 1.0; y = 0.1; r = "
    "0.1; } );\n" PHASE,
    BEGIN "integrator = `implicit`; implicit = { solver = `sor`; tolerance = 1e-12; };\n" FLOOR GRAINS PHASE};
enum { TEXTS = sizeof texts / sizeof *texts };

/* Keys whose value makes no other run, and why; a key NULL: all of the group. `unless`: it does at a place
 * that has this key, and may at others. */
static const struct {
    const char *group, *key, *reason, *unless;
} exempt[] = {{"", "steps", "an experiment ends with its last phase", NULL},
              {"", "kernel", "the same bits: suite laws", NULL},
              {"", "ledger", "reads, and changes nothing", NULL},
              {"", "particles_file", "the grains of the table are of the key: suite scene", NULL},
              {"", "particles_step", "as its table", NULL},
              {"", "contacts_file", "as its table", NULL},
              {"walls", "sides", "of a circle", "circle"},
              {"walls", "closed", "of a polygon", "polygon"},
              {"output", NULL, "tables, not numbers", NULL},
              {"phases", "go_on", "a block that is repeated goes on", "every"},
              {"measure", "prefix", "columns may have names of their own", "prefix"},
              {"lid", "load_y", "none, which nothing else replaces", NULL},
              {"measure", "series", "a table of the same samples", NULL},
              {"measure", "unit", "words", NULL},
              {"measure", "meaning", "words", NULL}};

enum { COUNTS, COUNTS_NOT, MAY_COUNT };
static int exemption(const char *group, const char *key, const config_setting_t *at)
{
    for (size_t i = 0; i < sizeof exempt / sizeof *exempt; i++)
        if (strcmp(exempt[i].group, group) == 0 && (!exempt[i].key || strcmp(exempt[i].key, key) == 0))
            return !exempt[i].unless                                       ? COUNTS_NOT
                   : at && config_setting_get_member(at, exempt[i].unless) ? COUNTS
                                                                           : MAY_COUNT;
    return COUNTS;
}

/* ---- keys of a text ---- */

static rp_status open_text(size_t k, const char *change, dem_text *text)
{
    const rp_texts changes = {change != NULL, {change}};
    scoped char *made = strdup(texts[k]);
    for (char *c = made; *c; c++) *c = *c == '`' ? '"' : *c;
    return dem_text_open("text", made, &changes, text);
}

/* The key of its run; false: the text is refused. */
static bool read_key(dem_text *text, XXH128_hash_t *key)
{
    exp_plan *plan;
    const rp_status status = exp_read(text, &plan);
    CU_ASSERT(!status || (status == RP_BAD_INPUT && *rp_message()));
    if (!status) CHECK_OK(whole_key(plan, key));
    exp_free(plan);
    return !status;
}

static bool key_of_change(size_t k, const char *change, XXH128_hash_t *key)
{
    RP_ENDS(dem_text_close) dem_text text;
    return open_text(k, change, &text) == RP_OK && read_key(&text, key);
}

/* ---- each key of a schema, at each place ---- */

/* Values to try, of which no two mean the same: words of the range, names of the texts, numbers. */
enum { MOST = 24 };
static size_t values_of(const rp_param *p, char value[MOST][128])
{
    const char *words = p->type == RP_BOOL     ? "true false"
                        : p->type == RP_CHOICE ? p->range
                        : p->type == RP_TEXT   ? "fall drop part disk base gate lid ka kb a a_word"
                        : p->type == RP_INT    ? "2 17 41 5003"
                                               : "0.317 0.103 7.31 -2.17 3170.0 1.73e-4 2.91e-13",
               *more = p->type == RP_REAL || p->type == RP_INT ? strchr(p->range, '|') : NULL;
    size_t n = 0;
    while (n < MOST && check_word(&words, "| ", value[n])) n++;
    while (more && n < MOST && check_word(&more, "| ", value[n])) n++;
    return n;
}

static XXH128_hash_t bases[TEXTS];

/* All values that are taken at the place make different keys. True: some are. */
static bool check_place(size_t text, const char *path, const char *group, const rp_param *p,
                        const config_setting_t *at)
{
    char value[MOST][128];
    XXH128_hash_t key[MOST];
    size_t taken[MOST], n = 0;
    const size_t tried = values_of(p, value);
    for (size_t i = 0; i < tried; i++) {
        if (key_of_change(text, check_text("%s%s=%s", path, p->name, value[i]), &key[n]))
            taken[n++] = i;
        else if (strstr(rp_message(), "unknown key"))
            break;
    }
    const int exempt_here = exemption(group, p->name, at);
    for (size_t i = 1; i < n; i++)
        for (size_t j = 0; j < i; j++)
            CHECK_OR_SAY(exempt_here == MAY_COUNT || XXH128_isEqual(key[i], key[j]) == exempt_here,
                         "text %zu: %s%s = %s and %s: %s", text, path, p->name, value[taken[i]],
                         value[taken[j]], exempt_here ? "another run, and exempt" : "the same run");
    for (int upper = 0; upper < 2; upper++) {
        const char *far = beyond_range(p, upper);
        if (!*far || n == 0) continue;
        const bool refused = !key_of_change(text, check_text("%s%s=%s", path, p->name, far), key);
        CHECK_OR_SAY(refused && strstr(rp_message(), check_text("%s = ", p->name)) &&
                         strstr(rp_message(), "out of range"),
                     "%s%s = %s: %s", path, p->name, far, refused ? rp_message() : "is not refused");
    }
    if (n > 0 && p->type == RP_CHOICE) {
        const bool refused = !key_of_change(text, check_text("%s%s=frob", path, p->name), key);
        CHECK_OR_SAY(refused &&
                         strstr(rp_message(), check_text("%s = \"frob\": unknown word, allowed: ", p->name)),
                     "%s%s = frob: %s", path, p->name, refused ? rp_message() : "is not refused");
    }
    return n > 1 || (n == 1 && !XXH128_isEqual(key[0], bases[text]));
}

/* The groups of this name from here on, "" the text itself, and entries of lists. */
static bool check_places(size_t text, const config_setting_t *at, const char *path, const char *group,
                         const rp_param *p)
{
    bool there = false;
    if (!*group) return check_place(text, "", "", p, at);
    const config_setting_t *of = config_setting_get_member(at, group);
    if (of && strcmp(group, "kinds") == 0)
        return check_place(text, "kinds.drop.", group, p, config_setting_get_member(of, "drop"));
    if (of && config_setting_is_group(of))
        return check_place(text, check_text("%s%s.", path, group), group, p, of);
    for (int i = 0; of && i < config_setting_length(of); i++) {
        const config_setting_t *entry = config_setting_get_elem(of, (unsigned)i);
        const char *here = check_text("%s%s[%d].", path, group, i);
        there |= check_place(text, here, group, p, entry);
        there |= check_places(text, entry, here, group, p); /* phases of a block */
    }
    return there;
}

static void check_schema(const char *group, const rp_param *p)
{
    for (; p->name; p++) {
        bool there = false;
        for (size_t t = 0; t < TEXTS; t++) {
            RP_ENDS(dem_text_close) dem_text text;
            CHECK_OK(open_text(t, NULL, &text));
            there |= check_places(t, config_root_setting(&text.config), "", group, p);
        }
        CHECK_OR_SAY(there || exemption(group, p->name, NULL) == COUNTS_NOT, "%s.%s: is taken nowhere", group,
                     p->name);
    }
}

static void read_bases(void)
{
    for (size_t t = 0; t < TEXTS; t++) {
        const bool good = key_of_change(t, NULL, &bases[t]);
        CHECK_OR_SAY(good, "text %zu: %s", t, rp_message());
        CU_ASSERT_FATAL(good);
    }
}

static void schemas(void)
{
    read_bases();
    for (const dem_scene_group *g = dem_scene_schemas; g->name; g++)
        check_schema(strcmp(g->name, "scene") == 0 ? "" : g->name, g->schema);
    for (const dem_scene_group *g = exp_groups; g->name; g++) check_schema(g->name, g->schema);
    for (const exp_module *const *m = exp_modules; *m; m++) check_schema("measure", (*m)->schema);
}

/* ---- each value that a text gives ---- */

/* Value number *k from here on, counted down; the group that it is of, and its path. */
static config_setting_t *value_at(config_setting_t *at, size_t *k, const char **group, const char **path)
{
    const char *name = config_setting_name(at), *before = *path, *within = *group;
    if (!config_setting_is_aggregate(at)) return (*k)-- == 0 ? at : NULL;
    if (name && (config_setting_is_group(at) || config_setting_is_list(at))) *group = check_text("%s", name);
    for (int i = 0; i < config_setting_length(at); i++) {
        config_setting_t *of = config_setting_get_elem(at, (unsigned)i);
        *path = config_setting_name(of) ? check_text("%s.%s", before, config_setting_name(of))
                                        : check_text("%s[%d]", before, i);
        config_setting_t *found = value_at(of, k, group, path);
        if (found) return found;
    }
    *path = before, *group = within;
    return NULL;
}

/* Change it, in one of several ways; false: there is none of this number. */
static bool change(config_setting_t *value, int way)
{
    static const char *const texts_of[] = {"(%s) + 1", "not (%s)", "%sx",    "7.31",
                                           "order",    "deposit",  "forces", "limit"};
    const int type = config_setting_type(value);
    if (way >= (type == CONFIG_TYPE_STRING ? 8 : type == CONFIG_TYPE_BOOL ? 1 : 2)) return false;
    switch (type) {
    case CONFIG_TYPE_STRING:
        return config_setting_set_string(value,
                                         check_text(texts_of[way], config_setting_get_string(value), ""));
    case CONFIG_TYPE_BOOL: return config_setting_set_bool(value, !config_setting_get_bool(value));
    case CONFIG_TYPE_FLOAT:
        return config_setting_set_float(value, config_setting_get_float(value) * (way ? 0.9 : 1.1) +
                                                   (way ? -1e-3 : 1e-3));
    default: return config_setting_set_int(value, config_setting_get_int(value) + (way ? -1 : 1));
    }
}

static bool is_of_schema(const char *key)
{
    bool is = false;
    for (int k = 0; k < 2; k++)
        for (const dem_scene_group *g = k ? exp_groups : dem_scene_schemas; g->name; g++)
            is |= rp_params_find(g->schema, key) != NULL;
    return is;
}

static void values(void)
{
    read_bases();
    for (size_t t = 0; t < TEXTS; t++) {
        XXH128_hash_t now;
        bool there = true;
        for (size_t k = 0; there; k++) {
            bool another = false, taken = false;
            const char *group, *path, *key = "";
            for (int way = 0; there && !another; way++) {
                RP_ENDS(dem_text_close) dem_text text;
                size_t left = k;
                CHECK_OK(open_text(t, NULL, &text));
                group = path = "";
                config_setting_t *value = value_at(config_root_setting(&text.config), &left, &group, &path);
                there = value != NULL;
                if (!there || !change(value, way)) break;
                key = check_text("%s", config_setting_name(value) ? config_setting_name(value) : "");
                if (!read_key(&text, &now)) continue;
                taken = true, another = !XXH128_isEqual(now, bases[t]);
            }
            if (!there) break;
            const bool counts = exemption(group, key, NULL) == COUNTS;
            /* a module with keys of its own leaves no other value of `of` */
            const bool alone = !taken && (is_of_schema(key) || strcmp(key, "of") == 0);
            CHECK_OR_SAY(another || !counts || alone, "text %zu: %s: %s", t, path,
                         taken ? "another value is the same run" : "no other value is taken");
        }
    }
}

/* ---- a text that is written ---- */

static dem_sim *sim_of(dem_text *text)
{
    scoped_scene scene = {0};
    dem_sim *sim;
    CHECK_OK(dem_text_scene(text, &scene));
    CHECK_OK(dem_scene_start(&scene, &sim));
    CHECK_OK(dem_run(sim, 50));
    return sim;
}

/* As dem_text_write writes it the text is the same run, to the bit, and is written the same again. */
static void written(void)
{
    read_bases();
    for (size_t t = 0; t < TEXTS; t++) {
        RP_ENDS(dem_text_close) dem_text text, again;
        XXH128_hash_t key, key_again;
        CHECK_OK(open_text(t, "rest.energy=1.2345678901234567e-3", &text));
        CHECK_WRITTEN(first, to, dem_text_write(&text, 7, 3, to));
        CHECK_OK(dem_text_open("written", first, NULL, &again));
        CHECK_WRITTEN(second, to_second, dem_text_write(&again, 7, 3, to_second));
        CU_ASSERT_STRING_EQUAL(first, second);
        CU_ASSERT(strstr(first, "seed = 7;") && strstr(first, "run = 3;"));
        CU_ASSERT(read_key(&text, &key) && read_key(&again, &key_again));
        CU_ASSERT(XXH128_isEqual(key, key_again) && !XXH128_isEqual(key, bases[t]));
        CHECK_OK(dem_text_change(&text, "seed=7"));
        CHECK_OK(dem_text_change(&text, "run=3"));
        scoped_sim *a = sim_of(&text), *b = sim_of(&again);
        CU_ASSERT(grains_same_bits(a, b));
    }
}

/* Grains of a table are those that a text lists; the springs of its contacts are of the run too. */
static void tables(void)
{
    static const char bed[] =
        "dt = 1e-5; tangential = { law = `spring`; mu = 0.5; }; steps = 200;\n"
        "walls = ( { point = (0.0, 0.0); direction = (0.0, 1.0); } );\n"
        "particles = ( { x = 0.0; y = 0.0999; r = 0.1; vx = 1.0; }, { x = 0.199; y = 0.0999; r = 0.1; } );\n";
    static const char text[] =
        "dt = 1e-5; tangential = { law = `spring`; mu = 0.5; };\n"
        "walls = ( { point = (0.0, 0.0); direction = (0.0, 1.0); } );\n"
        "particles_file = `bed/states.tsv`; contacts_file = `bed/contacts.tsv`;\n" PHASE;
    write_trial("bed.cfg", bed);
    GOOD("run bed.cfg -o bed");
    SHELL("cp -r bed half && rm half/.repose && awk -F'\\t' -v OFS='\\t' '/^#/ {print; next} !n++ {for (k = "
          "1; k <= NF; k++) if "
          "($k == "
          "\"shear_spring\") c = k} n > 1 {$c = $c*0.5} 1' bed/contacts.tsv >half/contacts.tsv");
    SHELL("cp -r bed other && rm other/.repose && awk -F'\\t' -v OFS='\\t' '/^#/ {print; next} !n++ {for (k "
          "= 1; k <= NF; k++) "
          "if ($k == "
          "\"vx\") c = k} n > 1 {$c = $c*0.5} 1' bed/states.tsv >other/states.tsv");
    check_keys(3, (const trial_change[]){{text, "bed/contacts", "half/contacts", "another"},
                                         {text, "contacts_file = `bed/contacts.tsv`;", "", "another"},
                                         {text, "bed/states", "other/states", "another"}});
}

CHECK_SUITE_WITHIN(schemas, "schemas", enter, leave, schemas, values, written, tables)
