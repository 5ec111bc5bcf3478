/* Derivations: commands that make a table from a table of runs, or from tables of piles, a file each. A sweep
 * file names them in its settings `derive`. A new one is its file, and its name in one of these lists. */
#ifndef CLI_DERIVE_H
#define CLI_DERIVE_H

#include "cli/cli.h"

#define CLI_STATS(X)  X(stats, fit) X(stats, trend) X(stats, size) X(stats, correlation)
#define CLI_STRESS(X) X(stress, field) X(stress, base) X(stress, dip)
#define CLI_ANGLE(X)  X(angle, compare)

#define CLI_DERIVED(group, name) cmd_##group##_##name,
#define CLI_ENTRY(group, name)   &cmd_##group##_##name,
extern const cli_command CLI_STATS(CLI_DERIVED) CLI_STRESS(CLI_DERIVED) CLI_ANGLE(CLI_DERIVED) cmd_stats;

#endif
