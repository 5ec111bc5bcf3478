/* What a folder holds, so that no result is written over by another; see cli.h. */
#include <string.h>

#include "cli/cli.h"

/* The text of the header line "# KEY: text" of a table, "" without. */
static void find_note(const char *path, const char *key, char *text, size_t size)
{
    char line[8300];
    const size_t n = strlen(key);
    FILE *in = fopen(path, "r");
    *text = '\0';
    while (in && fgets(line, sizeof line, in) && *line == '#')
        if (strncmp(line + 2, key, n) == 0 && strncmp(line + 2 + n, ": ", 2) == 0)
            snprintf(text, size, "%.*s", (int)strcspn(line + n + 4, "\n"), line + n + 4);
    if (in) fclose(in);
}

static bool is_table(const char *name)
{
    return rp_ends_in(name, ".tsv");
}

/* The `run` note of the folder's tables, and the command that wrote them. Older tables of a scene have no
 * note. */
static void find_run(const char *directory, char run[CLI_RUN_NOTE], char *command, size_t size)
{
    rp_paths tables = {0};
    *run = *command = '\0';
    (void)rp_paths_in(&tables, directory, is_table);
    for (size_t i = 0; i < tables.n && !*run; i++) {
        const char *path = tables.path[i];
        find_note(path, "run", run, CLI_RUN_NOTE);
        if (*run || strcmp(basename(path), "states.tsv") == 0) find_note(path, "command", command, size);
        if (!*run && *command) snprintf(run, CLI_RUN_NOTE, "a scene");
    }
    rp_paths_free(&tables);
}

/* Both are of one scene: then their keys agree. */
static bool same_scene(const char *a, const char *b)
{
    const char *key_a = strstr(a, ", key "), *key_b = strstr(b, ", key ");
    return key_a && key_b && strcmp(key_a, key_b) == 0;
}

/* "20000 steps, the last frame" of "scene.cfg, 20000 steps, the last frame, key ..." */
static int middle(const char *run, const char **text)
{
    *text = strstr(run, ", ") + 2;
    return (int)(strstr(run, ", key ") - *text);
}

rp_status cli_claim_run(const char *directory, const char *run, bool force, char replaces[CLI_REPLACES])
{
    char found[CLI_RUN_NOTE], command[2048], sweep[256];
    const char *old, *new;
    *replaces = '\0';
    rp_status status = sweep_source(directory, sweep);
    if (status || force) return force ? RP_OK : status;
    if (*sweep)
        return rp_fail(RP_BAD_INPUT,
                       "%s: holds the sweep %s; give another folder, or --force to add this run's tables",
                       directory, sweep);
    find_run(directory, found, command, sizeof command);
    if (same_scene(found, run)) {
        const int length = middle(found, &old), length_new = middle(run, &new);
        snprintf(replaces, CLI_REPLACES, "%.*s, by %.*s", length, old, length_new, new);
    } else if (*found && strcmp(found, run) != 0) {
        return rp_fail(RP_BAD_INPUT,
                       "%s: holds %s (%s); give another folder, or --force to write over these results",
                       directory, found, command);
    }
    return RP_OK;
}

bool cli_holds_run(const char *directory, long steps, XXH128_hash_t scene)
{
    char found[CLI_RUN_NOTE], command[2048], of_steps[32], key[48] = ", key ";
    find_run(directory, found, command, sizeof command);
    snprintf(of_steps, sizeof of_steps, ", %ld steps, ", steps);
    rp_hash_digits(scene, key + strlen(key));
    return strstr(found, of_steps) && rp_ends_in(found, key);
}

rp_status cli_claim_sweep(const char *directory, const char *file, bool force)
{
    char found[CLI_RUN_NOTE], command[2048], sweep[256];
    rp_status status = sweep_source(directory, sweep);
    if (status || force) return force ? RP_OK : status;
    if (*sweep && strcmp(basename(sweep), basename(file)) != 0)
        return rp_fail(RP_BAD_INPUT,
                       "%s: holds the sweep %s; give another folder, or --force to plan %s there (stored "
                       "runs are kept)",
                       directory, sweep, file);
    find_run(directory, found, command, sizeof command);
    return !*found ? RP_OK
                   : rp_fail(RP_BAD_INPUT,
                             "%s: holds %s (%s); give another folder, or --force to add the sweep %s",
                             directory, found, command, file);
}
