/* Folders and files that a test makes. */
#include "tests/folder.h"

#include <ftw.h>
#include <glob.h>
#include <unistd.h>

static void make_in(const char *root, const char *name, char path[FOLDER_PATH])
{
    snprintf(path, FOLDER_PATH, "%s/repose_%s_XXXXXX", root, name);
    CU_ASSERT_PTR_NOT_NULL_FATAL(mkdtemp(path));
}

void folder_make(const char *name, char path[FOLDER_PATH])
{
    make_in("/tmp", name, path);
}

void folder_make_in_memory(const char *name, char path[FOLDER_PATH])
{
    make_in(access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp", name, path);
}

static int remove_entry(const char *path, const struct stat *info, int type, struct FTW *ftw)
{
    (void)info, (void)type, (void)ftw;
    return remove(path);
}

const char *folder_path(const char *folder, const char *name)
{
    return check_text("%s/%s", folder, name);
}

void folder_remove(const char *path)
{
    nftw(path, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
}

void *file_read(const char *path, size_t *n)
{
    FILE *in = fopen(path, "r");
    CU_ASSERT_PTR_NOT_NULL_FATAL(in);
    fseek(in, 0, SEEK_END);
    *n = (size_t)ftell(in);
    rewind(in);
    char *bytes = calloc(*n + 1, 1);
    CU_ASSERT(bytes && fread(bytes, 1, *n, in) == *n);
    fclose(in);
    return bytes;
}

void file_lines(const char *pattern, file_line *take)
{
    RP_ENDS(globfree) glob_t found;
    scoped char *line = NULL;
    size_t size = 0;
    CU_ASSERT_FATAL(glob(pattern, 0, NULL, &found) == 0);
    for (size_t i = 0; i < found.gl_pathc; i++) {
        FILE *in = fopen(found.gl_pathv[i], "r");
        CU_ASSERT_PTR_NOT_NULL_FATAL(in);
        for (int number = 1; getline(&line, &size, in) > 0; number++) take(found.gl_pathv[i], number, line);
        fclose(in);
    }
}

void file_write(const char *path, const void *bytes, size_t n)
{
    FILE *out = fopen(path, "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(out);
    CU_ASSERT(fwrite(bytes, 1, n, out) == n);
    CU_ASSERT(fclose(out) == 0);
}

void file_text(const char *path, const char *text)
{
    file_write(path, text, strlen(text));
}
