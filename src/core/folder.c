/* Folders of the program; see folder.h. A marker's lines:
 *   repose folder 1         or "repose parts 1": rp_folder_admit adds to it
 *   holds: TEXT
 *   = CHECKSUM NAME         one line an own file, with its RP_OWN_... */
#define XXH_INLINE_ALL /* so that a program without sweeps needs no library for it */
#include "core/folder.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>
#include <xxhash.h>

static const char MARKER[] = ".repose", NEW_MARKER[] = ".repose.new", STAGE[] = "unfinished";
static const char *const HEADS[] = {"repose folder 1\n", "repose parts 1\n"};
static const char SIGNATURE[] = "user.repose"; /* attribute of a file: the checksum of its bytes */
static const char NO_SUM[] = "--------------------------------";
enum { NAME_AT = 2 + 32 + 1 };

static rp_status failed(const rp_folder *f, const char *name)
{
    return rp_fail(RP_IO, "%s/%s: %s", f->path, name, strerror(errno));
}

static rp_status not_ours(const rp_folder *f, const char *name, const char *why)
{
    return rp_fail(RP_BAD_INPUT, "%s/%s: %s; move it away, or give another folder", f->path, name, why);
}

static bool is_there(const rp_folder *f, const char *name, struct stat *info)
{
    return fstatat(f->file, name, info, AT_SYMLINK_NOFOLLOW) == 0;
}

/* ---- the marker ---- */

rp_own *rp_folder_find(const rp_folder *f, const char *name, char act)
{
    for (size_t i = 0; i < f->n; i++)
        if (strcmp(f->own[i].name, name) == 0 && f->own[i].act && (!act || f->own[i].act == act))
            return &f->own[i]; /* not of one that is gone */
    return NULL;
}

/* List it without a look at the others: frames may be many. */
static rp_status add(rp_folder *f, const char *name, char act)
{
    rp_own *more = realloc(f->own, (f->n + 1) * sizeof *more);
    if (more) f->own = more;
    char *copy = more ? strdup(name) : NULL;
    if (!copy) return rp_fail(RP_NO_MEMORY, "%s: out of memory", f->path);
    f->own[f->n] = (rp_own){.name = copy, .act = act};
    strcpy(f->own[f->n++].sum, NO_SUM);
    return RP_OK;
}

rp_status rp_folder_list(rp_folder *f, const char *name, char act)
{
    return rp_folder_find(f, name, act) ? RP_OK : add(f, name, act);
}

/* A name of this folder, not of another one. */
static rp_status read_line(rp_folder *f, char *line)
{
    if (strlen(line) <= NAME_AT || !strchr("=-+", *line) || line[NAME_AT] == '.' || strchr(line, '/'))
        return not_ours(f, MARKER, "damaged");
    RP_TRY(add(f, line + NAME_AT, *line));
    memcpy(f->own[f->n - 1].sum, line + 2, 32);
    return RP_OK;
}

static int open_file(const rp_folder *f, const char *name)
{
    return openat(f->file, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
}

static void close_file(const int *file)
{
    if (*file >= 0) close(*file);
}

static rp_status read_marker(rp_folder *f)
{
    const int file = open_file(f, MARKER);
    if (file < 0 && errno == ENOENT) return RP_OK;
    if (file < 0 && errno != ELOOP) return failed(f, MARKER);
    FILE *in = file < 0 ? NULL : fdopen(file, "r");
    char *line = NULL;
    size_t room = 0;
    ssize_t n = in ? getline(&line, &room, in) : -1;
    f->parts = n > 0 && strcmp(line, HEADS[1]) == 0;
    f->marked = f->parts || (n > 0 && strcmp(line, HEADS[0]) == 0);
    f->marked = f->marked && (n = getline(&line, &room, in)) > 7 && strncmp(line, "holds: ", 7) == 0;
    rp_status status = f->marked ? RP_OK : not_ours(f, MARKER, "no marker of this version of the program");
    if (!status) snprintf(f->holds, sizeof f->holds, "%.*s", (int)n - 8, line + 7);
    /* a line without an end was being added when the machine stopped */
    while (!status && (n = getline(&line, &room, in)) > 0 && line[n - 1] == '\n') {
        line[n - 1] = '\0';
        status = read_line(f, line);
    }
    free(line);
    if (in) fclose(in);
    return status;
}

/* The first and the last bytes of a file as texts, "" where there is none; its length. */
static off_t read_ends(const rp_folder *f, const char *name, char first[512], char last[64])
{
    RP_ENDS(close_file) const int file = open_file(f, name);
    struct stat info = {0};
    const bool regular = file >= 0 && fstat(file, &info) == 0 && S_ISREG(info.st_mode);
    const off_t at = info.st_size > 64 ? info.st_size - 64 : 0;
    memset(first, 0, 512), memset(last, 0, 64);
    if (regular) (void)!pread(file, first, 511, 0), (void)!pread(file, last, 64, at);
    return regular ? info.st_size : -1;
}

/* The checksum of an open file. */
static bool sum_of(int file, char sum[33])
{
    struct stat info;
    const size_t n = fstat(file, &info) == 0 ? (size_t)info.st_size : 0;
    void *bytes = n > 0 ? mmap(NULL, n, PROT_READ, MAP_PRIVATE, file, 0) : "";
    if (file < 0 || bytes == MAP_FAILED) return false;
    const XXH128_hash_t hash = XXH3_128bits(bytes, n);
    snprintf(sum, 33, "%016llx%016llx", (unsigned long long)hash.high64, (unsigned long long)hash.low64);
    if (n > 0) munmap(bytes, n);
    return true;
}

void rp_folder_sign(FILE *whole)
{
    char sum[33];
    if (sum_of(fileno(whole), sum)) (void)!fsetxattr(fileno(whole), SIGNATURE, sum, 32, 0);
}

static bool is_signed(const rp_folder *f, const char *name)
{
    char sum[33], signature[33] = "";
    RP_ENDS(close_file) const int file = open_file(f, name);
    return file >= 0 && fgetxattr(file, SIGNATURE, signature, 32) == 32 && sum_of(file, sum) &&
           strcmp(sum, signature) == 0;
}

/* The tail of a picture, after what ends it, or in a comment. */
static bool is_drawn(const char last[64])
{
    const char *at = memmem(last, 64, "repose view", 11);
    return at && ((at > last && strchr("%\013e", at[-1])) || (at >= last + 5 && !memcmp(at - 5, "<!-- ", 5)));
}

bool rp_folder_shows(const rp_folder *f, const char *name)
{
    char first[512], last[64];
    read_ends(f, name, first, last);
    return strncmp(first, "# program: repose ", 18) == 0 || strncmp(first, "repose snapshot\n", 16) == 0 ||
           strstr(first, "\"program\": \"repose ") || is_drawn(last) ||
           (*first == '#' && strstr(first, ", written by repose ")) || is_signed(f, name);
}

static rp_status remove_file(const rp_folder *f, const char *name)
{
    return unlinkat(f->file, name, 0) == 0 || errno == ENOENT
               ? RP_OK
               : rp_fail(RP_IO, "%s/%s: cannot remove: %s", f->path, name, strerror(errno));
}

/* Of a process that was killed. */
static rp_status remove_new(const rp_folder *f)
{
    char first[512], last[64];
    const bool ours = read_ends(f, NEW_MARKER, first, last) == 0 || strncmp(first, "repose ", 7) == 0;
    return ours ? remove_file(f, NEW_MARKER) : RP_OK;
}

rp_status rp_folder_write(rp_folder *f)
{
    FILE *out;
    RP_TRY(remove_new(f));
    RP_TRY(rp_folder_file(f, NEW_MARKER, O_WRONLY | O_CREAT | O_EXCL, &out));
    fprintf(out, "%sholds: ", HEADS[f->parts]);
    for (const char *c = f->holds; *c; c++) fputc(*c == '\n' ? ' ' : *c, out);
    fputc('\n', out);
    for (const rp_own *o = f->own; o < f->own + f->n; o++)
        if (o->act) fprintf(out, "%c %s %s\n", o->act, o->sum, o->name);
    bool good = fflush(out) == 0 && !ferror(out) && fsync(fileno(out)) == 0;
    good = fclose(out) == 0 && good && renameat(f->file, NEW_MARKER, f->file, MARKER) == 0 &&
           fsync(f->file) == 0;
    f->marked |= good;
    return good ? RP_OK : failed(f, MARKER);
}

/* ---- folders ---- */

static rp_status open_folder(const char *path, rp_folder *f)
{
    *f = (rp_folder){.file = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
    if (snprintf(f->path, sizeof f->path, "%s", path) > (int)sizeof f->path - 64)
        return rp_fail(RP_BAD_INPUT, "%.60s...: path too long", path);
    return f->file < 0 ? rp_fail(RP_IO, "%s: %s", path, strerror(errno)) : RP_OK;
}

rp_status rp_folder_open(const char *path, rp_folder *f)
{
    RP_TRY(open_folder(path, f));
    return read_marker(f);
}

static struct stat entered; /* the folder "unfinished" of this process's own result */

static bool is_same(const struct stat *a, const struct stat *b)
{
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

/* Refuse the folder "unfinished" of a run, which belongs to it, unless this process is at it. */
static rp_status refuse_stage(const rp_folder *f)
{
    struct stat here, there;
    char path[PATH_MAX];
    RP_ENDS(close_file) const int above = openat(f->file, "..", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (!f->parts || above < 0 || fstat(f->file, &here) != 0 || is_same(&here, &entered)) return RP_OK;
    if (fstatat(above, STAGE, &there, AT_SYMLINK_NOFOLLOW) != 0 || !is_same(&here, &there)) return RP_OK;
    if (!realpath(f->path, path)) return failed(f, "");
    *strrchr(path, '/') = '\0';
    return rp_fail(RP_BAD_INPUT, "%s: belongs to the unfinished run in %s; give that folder, or another one",
                   f->path, path);
}

rp_status rp_folder_enter(const char *path, rp_folder *f)
{
    RP_TRY(rp_folder_open(path, f));
    RP_TRY(refuse_stage(f));
    if (flock(f->file, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return RP_OK;
    return rp_fail(RP_IO, "%s: another process runs in this folder", path);
}

/* A folder in another one. Errors: RP_BAD_INPUT. */
static rp_status open_in(const rp_folder *f, const char *name, rp_folder *in)
{
    *in = (rp_folder){.file = openat(f->file, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC)};
    snprintf(in->path, sizeof in->path, "%.*s/%s", PATH_MAX - 300, f->path, name);
    if (in->file < 0 && (errno == EMFILE || errno == ENFILE)) return failed(f, name);
    return in->file < 0 ? not_ours(f, name, "no folder of this program") : read_marker(in);
}

void rp_folder_close(rp_folder *f)
{
    for (size_t i = 0; i < f->n; i++) free(f->own[i].name);
    free(f->own);
    if (f->file > 0) close(f->file);
    *f = (rp_folder){0};
}

rp_status rp_folder_file(const rp_folder *f, const char *name, int flags, FILE **file)
{
    const int opened = openat(f->file, name, flags | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
    *file = opened < 0 ? NULL : fdopen(opened, (flags & O_ACCMODE) == O_WRONLY ? "w" : "r+");
    return *file ? RP_OK : failed(f, name);
}

/* The checksum of a file; of a folder, or of nothing, NO_SUM. */
static rp_status find_sum(const rp_folder *f, const char *name, char sum[33])
{
    struct stat info;
    strcpy(sum, NO_SUM);
    if (!is_there(f, name, &info) || !S_ISREG(info.st_mode)) return RP_OK;
    RP_ENDS(close_file) const int file = open_file(f, name);
    return file >= 0 && sum_of(file, sum) ? RP_OK : failed(f, name);
}

/* Visit what is in a folder, but for its marker. */
static rp_status each(const rp_folder *f, rp_status (*visit)(const rp_folder *f, const char *name))
{
    const int file = openat(f->file, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *list = file < 0 ? NULL : fdopendir(file);
    rp_status status = list ? RP_OK : failed(f, "");
    for (const struct dirent *e; !status && (e = readdir(list));)
        if (strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0 && strcmp(e->d_name, MARKER) != 0)
            status = visit(f, e->d_name);
    if (list) closedir(list);
    return status;
}

static rp_status refuse_any(const rp_folder *f, const char *name)
{
    return not_ours(f, name, "not listed as the program's own");
}

rp_status rp_folder_check(const rp_folder *f, const char *name)
{
    struct stat info;
    char sum[33];
    const rp_own *own = rp_folder_find(f, name, 0);
    RP_ENDS(rp_folder_close) rp_folder in = {0};
    if (!is_there(f, name, &info)) return RP_OK;
    if (!own) return refuse_any(f, name);
    if (S_ISDIR(info.st_mode) && strcmp(own->sum, NO_SUM) == 0) {
        RP_TRY(open_in(f, name, &in));
        return each(&in, rp_folder_check);
    }
    RP_TRY(find_sum(f, name, sum));
    const bool same = S_ISREG(info.st_mode) && (strcmp(own->sum, NO_SUM) == 0 || strcmp(own->sum, sum) == 0);
    return same ? RP_OK : not_ours(f, name, "changed since the program wrote it");
}

rp_status rp_folder_vacant(const rp_folder *f, bool force)
{
    /* older versions had no markers */
    static const char *const older[] = {"states.tsv", "energy.tsv", "disks.tsv", "store.sqlite"};
    const bool sweep = strncmp(f->holds, "the sweep ", 10) == 0;
    bool finished = false;
    for (size_t i = 0; i < 4 && !f->marked; i++) RP_TRY(rp_folder_check(f, older[i]));
    for (size_t i = 0; i < f->n; i++) finished |= strcmp(f->own[i].sum, NO_SUM) != 0;
    if (sweep || (finished && !force))
        return rp_fail(RP_BAD_INPUT, "%s: holds %s; give another folder%s", f->path, f->holds,
                       sweep ? "" : ", or --force to replace these results");
    for (size_t i = 0; i < f->n; i++)
        if (strcmp(f->own[i].name, STAGE) != 0) RP_TRY(rp_folder_check(f, f->own[i].name));
    return RP_OK;
}

bool rp_folder_empty(const rp_folder *f)
{
    return each(f, refuse_any) == RP_OK;
}

static rp_status remove_own(const rp_folder *f, const char *name, const struct stat *info)
{
    return S_ISDIR(info->st_mode) ? rp_folder_remove(f, name) : remove_file(f, name);
}

rp_status rp_folder_clear(rp_folder *f)
{
    struct stat info;
    for (size_t i = 0; i < f->n; i++)
        if (is_there(f, f->own[i].name, &info) && (S_ISDIR(info.st_mode) || S_ISREG(info.st_mode)))
            RP_TRY(remove_own(f, f->own[i].name, &info));
    RP_TRY(remove_new(f));
    for (size_t i = 0; i < f->n; i++) free(f->own[i].name);
    f->n = 0; /* their names are people's from now on */
    return f->parts && !rp_folder_empty(f) ? rp_folder_write(f) : remove_file(f, MARKER);
}

rp_status rp_folder_remove(const rp_folder *f, const char *name)
{
    RP_ENDS(rp_folder_close) rp_folder in = {0};
    struct stat info;
    if (!is_there(f, name, &info)) return RP_OK;
    RP_TRY(open_in(f, name, &in));
    if (in.marked) RP_TRY(rp_folder_clear(&in));
    return unlinkat(f->file, name, AT_REMOVEDIR) == 0 || errno == ENOTEMPTY || errno == EEXIST
               ? RP_OK
               : failed(f, name);
}

/* ---- a result ---- */

rp_status rp_folder_stage(rp_folder *f, bool make, rp_folder *stage)
{
    struct stat info;
    const bool there = is_there(f, STAGE, &info), listed = rp_folder_find(f, STAGE, 0);
    *stage = (rp_folder){0};
    if (!make && !there) return RP_OK;
    if (there && !listed) return refuse_any(f, STAGE);
    if (make && !listed) { /* first its name, then itself: a process may be killed */
        RP_TRY(rp_folder_list(f, STAGE, RP_OWN_STAYS));
        RP_TRY(rp_folder_write(f));
    }
    if (make && mkdirat(f->file, STAGE, 0777) != 0 && errno != EEXIST) return failed(f, STAGE);
    RP_TRY(open_in(f, STAGE, stage));
    RP_TRY(remove_new(stage));
    fstat(stage->file, &entered);
    if (!stage->marked) RP_TRY(each(stage, refuse_any));
    stage->parts = true;
    return RP_OK;
}

static rp_status take_over(rp_folder *f)
{
    RP_ENDS(rp_folder_close) rp_folder stage;
    struct stat info;
    RP_TRY(rp_folder_stage(f, false, &stage));
    for (rp_own *o = f->own; o < f->own + f->n; o++) {
        /* where the newer one is no more in "unfinished", it is this one */
        if (o->act != RP_OWN_GOES || !is_there(f, o->name, &info)) continue;
        if (rp_folder_find(f, o->name, RP_OWN_COMES) &&
            !(stage.file && is_there(&stage, o->name, &(struct stat){0})))
            continue;
        RP_TRY(remove_own(f, o->name, &info));
    }
    if (fsync(f->file) != 0) return failed(f, "");
    for (rp_own *o = f->own; stage.file && o < f->own + f->n; o++) {
        if (o->act != RP_OWN_COMES || !is_there(&stage, o->name, &info)) continue;
        if (is_there(f, o->name, &info)) return refuse_any(f, o->name);
        if (renameat(stage.file, o->name, f->file, o->name) != 0) return failed(f, o->name);
    }
    return fsync(f->file) == 0 ? RP_OK : failed(f, "");
}

rp_status rp_folder_settle(rp_folder *f, bool *moved)
{
    struct stat info;
    *moved = false;
    for (size_t i = 0; i < f->n; i++) *moved |= f->own[i].act != RP_OWN_STAYS;
    if (!*moved) return RP_OK;
    RP_TRY(take_over(f));
    RP_TRY(rp_folder_remove(f, STAGE));
    for (rp_own *o = f->own; o < f->own + f->n; o++) {
        const bool gone =
            o->act == RP_OWN_GOES || (strcmp(o->name, STAGE) == 0 && !is_there(f, STAGE, &info));
        o->act = gone ? 0 : RP_OWN_STAYS;
    }
    return rp_folder_write(f);
}

/* The checksums of a file, or of a folder's files, that become part of the result. */
static rp_status seal(const rp_folder *f, rp_own *o)
{
    RP_ENDS(rp_folder_close) rp_folder in = {0};
    struct stat info;
    if (!is_there(f, o->name, &info) || !S_ISDIR(info.st_mode)) return find_sum(f, o->name, o->sum);
    RP_TRY(open_in(f, o->name, &in));
    for (rp_own *own = in.own; own < in.own + in.n; own++) {
        if (own->act == RP_OWN_GOES && !is_there(&in, own->name, &info)) own->act = 0;
        RP_TRY(seal(&in, own));
    }
    in.parts = false;
    return rp_folder_write(&in);
}

static rp_status announce(rp_folder *f)
{
    RP_ENDS(rp_folder_close) rp_folder stage;
    struct stat info;
    RP_TRY(rp_folder_stage(f, false, &stage));
    for (rp_own *o = stage.own; o < stage.own + stage.n; o++) {
        if (o->act == RP_OWN_GOES || !is_there(&stage, o->name, &info)) continue;
        if (!rp_folder_find(f, o->name, 0)) RP_TRY(rp_folder_check(f, o->name));
        RP_TRY(seal(&stage, o));
        RP_TRY(rp_folder_list(f, o->name, RP_OWN_COMES));
        strcpy(rp_folder_find(f, o->name, RP_OWN_COMES)->sum, o->sum);
    }
    if (fsync(stage.file) != 0) return failed(f, STAGE);
    strcpy(f->holds, stage.holds);
    return rp_folder_write(f);
}

rp_status rp_folder_publish(rp_folder *f)
{
    RP_TRY(rp_folder_vacant(f, true)); /* people may have been here in the meantime */
    f->parts = false;
    for (rp_own *o = f->own; o < f->own + f->n; o++)
        if (strcmp(o->name, STAGE) != 0) o->act = RP_OWN_GOES;
    RP_TRY(announce(f));
    return rp_folder_settle(f, &(bool){0});
}

/* ---- single files and folders ---- */

/* The folder of a path, of whose marker only the head is read, and the name there. */
static rp_status open_of(const char *path, rp_folder *f, const char **name)
{
    char folder[PATH_MAX], first[512], last[64];
    const char *slash = strrchr(path, '/');
    snprintf(folder, sizeof folder, "%.*s", slash > path ? (int)(slash - path) : 1, slash ? path : ".");
    *name = slash ? slash + 1 : path;
    RP_TRY(open_folder(folder, f));
    read_ends(f, MARKER, first, last);
    f->parts = strncmp(first, HEADS[1], strlen(HEADS[1])) == 0;
    return RP_OK;
}

/* Add lines to the marker of a folder of parts. */
static rp_status add_lines(const rp_folder *f, const char *name, const char *temporary)
{
    FILE *out;
    if (!f->parts) return RP_OK;
    RP_TRY(rp_folder_file(f, MARKER, O_WRONLY | O_APPEND, &out));
    fprintf(out, "%c %s %s\n", RP_OWN_STAYS, NO_SUM, name);
    if (temporary) fprintf(out, "%c %s %s\n", RP_OWN_GOES, NO_SUM, temporary);
    return fclose(out) == 0 ? RP_OK : failed(f, MARKER);
}

rp_status rp_folder_admit(const char *path, const char *temporary, bool owner)
{
    RP_ENDS(rp_folder_close) rp_folder f = {0};
    const char *name, *slash = strrchr(temporary, '/');
    struct stat info;
    if (open_of(path, &f, &name)) return RP_OK; /* told by what follows */
    RP_TRY(refuse_stage(&f));
    const bool there = is_there(&f, name, &info);
    if (there) RP_TRY(read_marker(&f)); /* of a marker that cannot be read nobody knows what it lists */
    const bool own = there && rp_folder_find(&f, name, 0);
    if (own && !owner && !f.parts)
        return rp_fail(RP_BAD_INPUT, "%s: belongs to %s; give another name", path, f.holds);
    if (own)
        RP_TRY(rp_folder_check(&f, name));
    else if (there && !rp_folder_shows(&f, name))
        return rp_fail(RP_BAD_INPUT, "%s: %s; move it away, or give another name", path,
                       S_ISLNK(info.st_mode) ? "a link" : "nothing in it shows that this program wrote it");
    return add_lines(&f, name, slash ? slash + 1 : temporary);
}

rp_status rp_folder_fits(const char *path)
{
    RP_ENDS(rp_folder_close) rp_folder f = {0};
    const char *name;
    char sum[33];
    if (open_of(path, &f, &name) || read_marker(&f)) return RP_OK;
    const rp_own *own = rp_folder_find(&f, name, 0);
    if (!own || strcmp(own->sum, NO_SUM) == 0 || find_sum(&f, name, sum) || strcmp(own->sum, sum) == 0)
        return RP_OK;
    return rp_fail(RP_BAD_INPUT,
                   "%s: not what was written here (checksum in .repose); copy it elsewhere to use it", path);
}

rp_status rp_folder_make(const char *path)
{
    RP_ENDS(rp_folder_close) rp_folder f = {0}, made = {0};
    const char *name;
    struct stat info;
    RP_TRY(open_of(path, &f, &name));
    RP_TRY(add_lines(&f, name, NULL));
    const bool there = is_there(&f, name, &info);
    if (there && !S_ISDIR(info.st_mode)) return not_ours(&f, name, "no folder");
    if (!there && mkdir(path, 0777) != 0)
        return rp_fail(RP_IO, "%s: cannot make the directory: %s", path, strerror(errno));
    RP_TRY(rp_folder_open(path, &made));
    if (made.parts || (there && !(made.marked && f.parts))) return RP_OK;
    made.parts = true; /* also of one whose files a process that was killed had sealed */
    return rp_folder_write(&made);
}
