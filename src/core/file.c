/* Files; see file.h. */
#include "core/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

rp_status rp_file_finish(FILE *out, const char *name)
{
    errno = 0;
    if (fflush(out) != 0 || ferror(out))
        return rp_fail(RP_IO, "%s: cannot write: %s", name, strerror(errno ? errno : EIO));
    return RP_OK;
}

static const char TEMPORARY[] = ".tmp";
enum { DIGITS = 8 };

bool rp_file_is_temporary(const char *name)
{
    const size_t n = strlen(name), end = sizeof TEMPORARY - 1 + DIGITS;
    return n > end && strncmp(name + n - end, TEMPORARY, sizeof TEMPORARY - 1) == 0 &&
           strspn(name + n - DIGITS, "0123456789abcdef") == DIGITS;
}

/* A new file beside it, under a name that no one can foresee; devices and pipes are written directly. */
rp_status rp_file_open(const char *path, bool replace, FILE **out)
{
    char temporary[PATH_MAX + 16];
    struct stat info;
    unsigned number;
    if (strcmp(path, "-") == 0) return *out = stdout, RP_OK;
    *out = NULL;
    if (strlen(path) >= PATH_MAX) return rp_fail(RP_BAD_INPUT, "%.60s...: path too long", path);
    const bool device = stat(path, &info) == 0 && !S_ISREG(info.st_mode);
    if (!device && !replace && lstat(path, &info) == 0)
        return rp_fail(RP_BAD_INPUT, "%s: is there; give another name, or --force to replace it", path);
    if (device) {
        *out = fopen(path, "w");
    } else if (getrandom(&number, sizeof number, 0) == sizeof number) {
        snprintf(temporary, sizeof temporary, "%s%s%0*x", path, TEMPORARY, DIGITS, number);
        const int file = open(temporary, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file >= 0) *out = fdopen(file, "w+");
    }
    return *out ? RP_OK : rp_fail(RP_IO, "%s: cannot write: %s", path, strerror(errno));
}

rp_status rp_file_close(const char *path, FILE *out, rp_status keep)
{
    char link[64], temporary[PATH_MAX] = "";
    struct stat info;
    if (out == stdout) return keep ? keep : rp_file_finish(out, "standard output");
    snprintf(link, sizeof link, "/proc/self/fd/%d", fileno(out));
    const bool renamed = fstat(fileno(out), &info) == 0 && S_ISREG(info.st_mode);
    const bool named = renamed && readlink(link, temporary, sizeof temporary - 1) > 0;
    rp_status status = keep ? keep : rp_file_finish(out, path);
    /* the bytes reach the disk before the name does */
    bool failed = renamed && !status && (fsync(fileno(out)) != 0 || !named);
    failed |= fclose(out) != 0;
    if (!status && !failed && renamed) failed = rename(temporary, path) != 0;
    if (!status && failed) status = rp_fail(RP_IO, "%s: cannot write: %s", path, strerror(errno));
    if (status && named) unlink(temporary);
    return status;
}

bool rp_file_sync_folder(const char *path)
{
    char copy[PATH_MAX];
    snprintf(copy, sizeof copy, "%s", path);
    const int folder = open(dirname(copy), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    const bool good = folder >= 0 && fsync(folder) == 0;
    if (folder >= 0) close(folder);
    return good;
}

/* The file of this program; false where the system does not tell. */
static bool program_file(char path[], size_t size)
{
    const ssize_t n = readlink("/proc/self/exe", path, size - 1);
    path[n > 0 ? n : 0] = '\0';
    return n > 0;
}

const char *rp_data(rp_arena *arena, const char *name)
{
    /* next to the program: where it is installed, then the source above its build folder */
    static const char *const beside[] = {"../share/repose", "..", "../..", NULL};
    const char *const set[] = {".", NULL}, *folder = getenv("REPOSE_DATA"), *path;
    char program[PATH_MAX];
    if (*name == '/' || access(name, F_OK) == 0) return name;
    const bool is_set = folder && *folder;
    if (!is_set && !program_file(program, sizeof program)) return name;
    if (!is_set) *strrchr(program, '/') = '\0';
    for (const char *const *sub = is_set ? set : beside; *sub; sub++) {
        if (rp_path(arena, &path, "%s/%s/%s", is_set ? folder : program, *sub, name)) continue;
        char *real = realpath(path, NULL);
        if (real) return rp_arena_keep(arena, real, free);
    }
    return name;
}

bool rp_ends_in(const char *text, const char *end)
{
    return strlen(text) >= strlen(end) && strcmp(text + strlen(text) - strlen(end), end) == 0;
}

bool rp_is_in(const char *folder, const char *name)
{
    char path[PATH_MAX];
    return snprintf(path, sizeof path, "%s/%s", folder, name) < (int)sizeof path && access(path, F_OK) == 0;
}

rp_status rp_paths_add(rp_paths *paths, const char *folder, const char *name)
{
    char **more = realloc(paths->path, (paths->n + 1) * sizeof *more), *path = NULL;
    if (more) paths->path = more;
    if (!more || asprintf(&path, "%s%s%s", folder ? folder : "", folder ? "/" : "", name) < 0)
        return rp_fail(RP_NO_MEMORY, "%s: out of memory", name);
    paths->path[paths->n++] = path;
    return RP_OK;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

rp_status rp_paths_in(rp_paths *paths, const char *folder, bool (*wanted)(const char *name))
{
    const size_t first = paths->n;
    rp_status status = RP_OK;
    DIR *files = opendir(folder);
    for (const struct dirent *e; files && !status && (e = readdir(files));)
        if (strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0 && wanted(e->d_name))
            status = rp_paths_add(paths, folder, e->d_name);
    if (files) closedir(files);
    if (paths->n > first) qsort(paths->path + first, paths->n - first, sizeof *paths->path, by_name);
    return status;
}

void rp_paths_free(rp_paths *paths)
{
    for (size_t i = 0; i < paths->n; i++) free(paths->path[i]);
    free(paths->path);
    *paths = (rp_paths){0};
}

rp_status rp_make_directory(const char *path)
{
    char part[4096];
    if (strlen(path) >= sizeof part) return rp_fail(RP_BAD_INPUT, "%.60s...: path too long", path);
    for (size_t i = 1; i <= strlen(path); i++) {
        if (path[i] != '/' && path[i] != '\0') continue;
        snprintf(part, sizeof part, "%.*s", (int)i, path);
        if (mkdir(part, 0777) != 0 && errno != EEXIST)
            return rp_fail(RP_IO, "%s: cannot make the directory: %s", part, strerror(errno));
    }
    struct stat info;
    if (stat(path, &info) != 0 || !S_ISDIR(info.st_mode)) return rp_fail(RP_IO, "%s: not a directory", path);
    return RP_OK;
}

enum { MOST_BYTES = 1 << 30 };

rp_status rp_file_read(const char *path, char **text)
{
    FILE *in = strcmp(path, "-") == 0 ? stdin : fopen(path, "r");
    *text = NULL;
    if (!in) return rp_fail(RP_BAD_INPUT, "%s: cannot read: %s", path, strerror(errno));
    rp_status status = RP_OK;
    size_t size = 0, room = 0, n = 0;
    do {
        room = 2 * room + 65536;
        char *more = realloc(*text, room);
        if (!more) status = rp_fail(RP_NO_MEMORY, "%s: out of memory", path);
        if (!more) break;
        *text = more;
        n = fread(more + size, 1, room - 1 - size, in);
        if (memchr(more + size, '\0', n)) status = rp_fail(RP_BAD_INPUT, "%s: no text: holds a 0 byte", path);
        more[size += n] = '\0';
        if (!status && size > MOST_BYTES) status = rp_fail(RP_BAD_INPUT, "%s: more than 1 GB", path);
    } while (!status && size == room - 1);
    if (!status && ferror(in)) status = rp_fail(RP_BAD_INPUT, "%s: cannot read: %s", path, strerror(errno));
    if (in != stdin) fclose(in);
    return status;
}
