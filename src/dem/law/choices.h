/* Lists of choices. A row is X(id, word, manual, ...): its name in C and in files, and what it is, with its
 * source. Types, ranges of schemas, help and tests are made of the list. */
#ifndef DEM_CHOICES_H
#define DEM_CHOICES_H

#define DEM_ID(id, ...)           id,
#define DEM_ONE(...)              +1
#define DEM_WORD(id, word, ...)   " | " #word
#define DEM_MANUAL(id, word, ...) DEM_FIRST(__VA_ARGS__, ),
#define DEM_FIRST(first, ...)     first

/* For the schemas of params.h: "hertz | linear", and the manuals of the words. */
#define DEM_WORDS(LIST)   (&(LIST(DEM_WORD))[3])
#define DEM_MANUALS(LIST) ((dem_manuals){LIST(DEM_MANUAL)})
typedef const char *const dem_manuals[];

#endif
