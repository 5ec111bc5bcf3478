/* Texts of strangers - names of files, cells, words of parameter files - on their way to a terminal, which
 * would obey the control characters in them. */
#ifndef RP_PLAIN_H
#define RP_PLAIN_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

/* The bytes of a text's first character in UTF-8; 0 where it is a control character or no UTF-8, and at the
 * end. A plain text has no such place before its end. */
size_t rp_character(const char *text);
bool rp_is_plain(const char *text);

/* Make it plain: ends of lines and tabs become blanks, what else is not plain "?". */
char *rp_plain(char *text);

/* As vsnprintf, and plain. A text that is too long loses its middle: messages end with what to do. */
enum { RP_MESSAGE = 2048 };
void rp_plain_print(char text[RP_MESSAGE], const char *format, va_list args)
    __attribute__((format(printf, 2, 0)));

#endif
