#include "tests/check.h"
void suite_cli(void)
{
}
