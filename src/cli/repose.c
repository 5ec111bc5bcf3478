/* The program `repose`. */
#include "cli/cli.h"

int main(int argc, char **argv)
{
    static const cli_program repose = {"repose", cli_commands, cli_overview};
    return cli_main(&repose, argc, argv);
}
