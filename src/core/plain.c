/* Texts of strangers; see plain.h. */
#include "core/plain.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

size_t rp_character(const char *text)
{
    static const unsigned long least[] = {0, 0x20, 0xa0, 0x800, 0x10000};
    const unsigned char *c = (const unsigned char *)text;
    const size_t n = *c < 0x80 ? 1 : *c < 0xc0 ? 0 : *c < 0xe0 ? 2 : *c < 0xf0 ? 3 : *c < 0xf5 ? 4 : 0;
    unsigned long code = n == 1 ? *c : *c & (0x7fu >> n);
    for (size_t k = 1; k < n; k++) {
        if ((c[k] & 0xc0) != 0x80) return 0;
        code = code << 6 | (c[k] & 0x3fu);
    }
    const bool good =
        code >= least[n] && code != 0x7f && code <= 0x10ffff && (code < 0xd800 || code > 0xdfff);
    return good ? n : 0;
}

bool rp_is_plain(const char *text)
{
    for (size_t n; *text; text += n)
        if ((n = rp_character(text)) == 0) return false;
    return true;
}

char *rp_plain(char *text)
{
    for (char *c = text; *c;) {
        const size_t n = rp_character(c);
        if (n == 0) *c = strchr("\t\n\r", *c) ? ' ' : '?';
        c += n ? n : 1;
    }
    return text;
}

void rp_plain_print(char text[RP_MESSAGE], const char *format, va_list args)
{
    enum { HEAD = RP_MESSAGE / 3 * 2, TAIL = RP_MESSAGE - HEAD - sizeof " ... " };
    va_list again;
    char *whole = NULL;
    va_copy(again, args);
    const int n = vsnprintf(text, RP_MESSAGE, format, args);
    if (n >= RP_MESSAGE && vasprintf(&whole, format, again) == n)
        snprintf(text, RP_MESSAGE, "%.*s ... %s", HEAD, whole, whole + n - TAIL);
    va_end(again);
    free(whole);
    rp_plain(text);
}
