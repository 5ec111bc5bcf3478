#include "tests/check.h"
void suite_golden(void)
{
}
