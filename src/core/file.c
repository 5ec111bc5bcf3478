/* Files; see file.h. */
#include "core/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

rp_status rp_file_finish(FILE *out, const char *name)
{
    errno = 0;
    if (fflush(out) != 0 || ferror(out))
        return rp_fail(RP_IO, "%s: cannot write: %s", name, strerror(errno ? errno : EIO));
    return RP_OK;
}

rp_status rp_file_sync(FILE *out, const char *name)
{
    RP_TRY(rp_file_finish(out, name));
    if (fsync(fileno(out)) == 0 || errno == EINVAL || errno == EROFS) return RP_OK; /* none of a pipe */
    return rp_fail(RP_IO, "%s: cannot write: %s", name, strerror(errno));
}

bool rp_is_there(const char *path)
{
    return access(path, F_OK) == 0 || (errno != ENOENT && errno != ENOTDIR);
}

static const char TEMPORARY[] = ".repose_part";
enum { MOST_PATH = PATH_MAX + sizeof TEMPORARY };

static rp_status cannot_write(const char *path)
{
    return rp_fail(RP_IO, "%s: cannot write: %s", path, strerror(errno));
}

static const char *temporary_of(const char *path, char temporary[MOST_PATH])
{
    snprintf(temporary, MOST_PATH, "%s%s", path, TEMPORARY);
    return temporary;
}

bool rp_file_is_temporary(const char *name)
{
    return rp_ends_in(name, TEMPORARY);
}

bool rp_file_was_begun(const char *path)
{
    char temporary[MOST_PATH];
    return rp_is_there(temporary_of(path, temporary));
}

/* A new file, which its writer locks: one that nobody has locked is of a process that was killed. */
static rp_status begin(const char *path, const char *temporary, int *file)
{
    const int flags = O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC;
    *file = open(temporary, flags, 0666);
    if (*file < 0 && errno == EEXIST) {
        const int left = open(temporary, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
        if (left < 0) return cannot_write(temporary);
        const bool grows = flock(left, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
        if (!grows && unlink(temporary) == 0) *file = open(temporary, flags, 0666);
        close(left);
        if (grows) return rp_fail(RP_IO, "%s: another process writes it", path);
    }
    if (*file < 0) return cannot_write(path);
    (void)!flock(*file, LOCK_EX | LOCK_NB); /* some file systems have no locks */
    return RP_OK;
}

/* Devices and pipes are written directly. */
rp_status rp_file_open(const char *path, bool replace, FILE **out)
{
    char temporary[MOST_PATH];
    struct stat info;
    int file = -1;
    if (strcmp(path, "-") == 0) return *out = stdout, RP_OK;
    *out = NULL;
    if (strlen(path) >= PATH_MAX) return rp_fail(RP_BAD_INPUT, "%.60s...: path too long", path);
    const bool known = stat(path, &info) == 0, device = known && !S_ISREG(info.st_mode);
    if (!known && errno != ENOENT) return cannot_write(path);
    if (!device && !replace && lstat(path, &info) == 0)
        return rp_fail(RP_BAD_INPUT, "%s: is there; give another name, or --force to replace it", path);
    if (!device && !replace && errno != ENOENT) return cannot_write(path);
    if (!device) RP_TRY(begin(path, temporary_of(path, temporary), &file));
    *out = device ? fopen(path, "we") : fdopen(file, "w+");
    return *out ? RP_OK : cannot_write(path);
}

/* What is deleted meanwhile has a link that is no name: renaming it fails. */
rp_status rp_file_close(const char *path, FILE *out, rp_status keep)
{
    char link[64], temporary[MOST_PATH] = "";
    struct stat info;
    if (out == stdout) return keep ? keep : rp_file_finish(out, "standard output");
    rp_status status = keep ? keep : rp_file_finish(out, path);
    const bool known = fstat(fileno(out), &info) == 0, renamed = known && S_ISREG(info.st_mode);
    if (!status && !known) status = cannot_write(path);
    snprintf(link, sizeof link, "/proc/self/fd/%d", fileno(out));
    const bool named = renamed && readlink(link, temporary, sizeof temporary - 1) > 0;
    /* the bytes reach the disk before the name does */
    if (!status && renamed && (!named || fsync(fileno(out)) != 0)) status = cannot_write(path);
    if (fclose(out) != 0 && !status) status = cannot_write(path);
    if (!status && renamed && rename(temporary, path) != 0)
        return rp_fail(RP_IO, "%s: cannot write: %s; the whole file is %s", path, strerror(errno), temporary);
    if (status && named) unlink(temporary);
    return status;
}

rp_status rp_file_close_both(const char *path, FILE *out, const char *beside, FILE *other)
{
    const rp_status whole = rp_file_sync(out, path), status = rp_file_close(beside, other, whole);
    return rp_file_close(path, out, status);
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
    if (*name == '/' || rp_is_there(name)) return name;
    const bool is_set = folder && *folder;
    if (!is_set && !program_file(program, sizeof program)) return name;
    if (!is_set) *strrchr(program, '/') = '\0';
    for (const char *const *sub = is_set ? set : beside; *sub; sub++) {
        if (rp_path(arena, &path, "%s/%s/%s", is_set ? folder : program, *sub, name)) continue;
        char *real = realpath(path, NULL);
        if (real) return rp_arena_keep(arena, real, free);
        if (rp_is_there(path)) return path;
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
    return snprintf(path, sizeof path, "%s/%s", folder, name) < (int)sizeof path && rp_is_there(path);
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
    if (!files && errno != ENOENT) status = rp_fail(RP_IO, "%s: %s", folder, strerror(errno));
    for (const struct dirent *e; files && !status && (errno = 0, e = readdir(files));)
        if (strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0 && wanted(e->d_name))
            status = rp_paths_add(paths, folder, e->d_name);
    if (files && !status && errno) status = rp_fail(RP_IO, "%s: %s", folder, strerror(errno));
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
