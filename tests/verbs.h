/* Verbs and options: the commands of a program, and what each takes. */
#ifndef VERBS_H
#define VERBS_H

#include <stdio.h>
#include <string.h>

#include "cli/cli.h"

/* Options of a command, as they are typed: those of its protocol and its own. */
typedef struct {
    char typed[40];
    const rp_param *p;
} option;

static inline size_t options_of(const cli_command *c, option options[64])
{
    const rp_param *lists[] = {c->protocol, c->options ? c->options() : NULL};
    size_t n = 0;
    for (size_t k = 0; k < 2; k++)
        for (const rp_param *p = lists[k]; p && p->name; p++, n++) {
            sprintf(options[n].typed, "%s%s", p->name[1] ? "--" : "-", p->name);
            for (char *bar = options[n].typed; (bar = strchr(bar, '_'));) *bar = '-';
            options[n].p = p;
        }
    return n;
}

/* Each command, those of groups too. */
static inline void each(const cli_command *const *c, void (*check)(const cli_command *))
{
    for (; *c; c++) {
        check(*c);
        if ((*c)->group) each((*c)->group, check);
    }
}

#endif
