/* The corpus of the fuzzer, read again: inputs that reach much of the readers, and those that once broke one.
 */
#include <dirent.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/check.h"
#include "tests/fuzz/targets.h"

enum { MOST_BYTES = 1 << 16 };

static char corpus[PATH_MAX];

/* Run each file of the target's folder; `path` is the last one. */
static int replay(const fuzz_target *target, char path[])
{
    static char bytes[MOST_BYTES], name[PATH_MAX];
    snprintf(name, sizeof name, "%.4000s/%s", corpus, target->name);
    DIR *folder = opendir(name);
    int n = 0;
    for (struct dirent *e; folder && (e = readdir(folder));) {
        if (e->d_name[0] == '.') continue;
        snprintf(path, PATH_MAX, "%.2000s/%.255s", name, e->d_name);
        FILE *in = fopen(path, "r");
        if (!in) return 0;
        const size_t size = fread(bytes, 1, sizeof bytes, in);
        fclose(in);
        fuzz_run(target, size, bytes);
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

void suite_fuzz(void)
{
    static const check_case cases[] = {{"corpus of every target", every_target}, {NULL, NULL}};
    check_register("fuzz", cases);
}
