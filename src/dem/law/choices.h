/* Lists of choices. A row is X(id, word, manual): its name in C and in files, and what it is, with its
 * source; or X(id, word, ...) where a descriptor has the manual. Types, ranges of schemas, help and tests are
 * made of the list. */
#ifndef DEM_CHOICES_H
#define DEM_CHOICES_H

#define DEM_ID(id, ...)              id,
#define DEM_ONE(...)                 +1
#define DEM_WORD(id, word, ...)      " | " #word
#define DEM_MANUAL(id, word, manual) manual,

/* "hertz | linear" */
#define DEM_WORDS(LIST) (&(LIST(DEM_WORD))[3])

/* A function that gives the manual of a choice, for the schemas of params.h; define one. */
typedef const char *dem_manual(int choice);
#define DEM_MANUAL_OF(LIST, function)                                                                        \
    const char *function(int choice)                                                                         \
    {                                                                                                        \
        static const char *const manuals[] = {LIST(DEM_MANUAL)};                                             \
        return manuals[choice];                                                                              \
    }

#endif
