/* Files that the program brings along: sweeps, claims, tables of the studies. */
#include "cli/cli.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Folders of data beside the program: where it is installed, then the source above its build folder. */
static const char *const beside[] = {"../share/repose", "..", "../.."};

/* The program's folder; "" where the system does not tell. */
static void find_program(char folder[PATH_MAX])
{
    const ssize_t n = readlink("/proc/self/exe", folder, PATH_MAX - 1);
    folder[n > 0 ? n : 0] = '\0';
    char *slash = strrchr(folder, '/');
    if (slash) *slash = '\0';
}

static bool exists_in(const char *folder, const char *sub, const char *name, char path[PATH_MAX])
{
    char text[3 * PATH_MAX];
    snprintf(text, sizeof text, "%s/%s/%s", folder, sub, name);
    return realpath(text, path) != NULL;
}

bool cli_ends_in(const char *text, const char *end)
{
    return strlen(text) >= strlen(end) && strcmp(text + strlen(text) - strlen(end), end) == 0;
}

const char *cli_data(const char *name)
{
    char path[PATH_MAX], program[PATH_MAX];
    const char *folder = getenv("REPOSE_DATA");
    bool found = false;
    if (*name == '/' || access(name, F_OK) == 0) return name;
    if (folder && *folder) {
        found = exists_in(folder, ".", name, path);
    } else {
        find_program(program);
        for (size_t i = 0; i < N_OF(beside) && !found && *program; i++)
            found = exists_in(program, beside[i], name, path);
    }
    return found ? strcpy(cli_memory(strlen(path) + 1, 1), path) : name;
}
