/* Folders and files that a test makes. */
#ifndef FOLDER_H
#define FOLDER_H

#include "tests/check.h"

enum { FOLDER_PATH = 64 };

/* A new folder /tmp/repose_NAME_XXXXXX; in memory where there is such a file system. */
void folder_make(const char *name, char path[FOLDER_PATH]);
void folder_make_in_memory(const char *name, char path[FOLDER_PATH]);

/* FOLDER/NAME, as of check_text. */
const char *folder_path(const char *folder, const char *name);

/* Remove a file or a folder with all that it holds. */
void folder_remove(const char *path);

/* The bytes of a file, and a zero after them. Free them. */
void *file_read(const char *path, size_t *n);

/* Take each line of each file of this pattern, with its number from 1. */
typedef void file_line(const char *path, int number, char *line);
void file_lines(const char *pattern, file_line *take);

/* Write a file anew: bytes, or formatted text. */
void file_write(const char *path, const void *bytes, size_t n);
#define file_print(path, ...) file_text(path, check_text(__VA_ARGS__))
void file_text(const char *path, const char *text);

#endif
