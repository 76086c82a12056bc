/* A library that is no FMU's: it has one function of FMI 3.0. */
#include <stddef.h>
void fmi3FreeInstance(void* instance) { (void)instance; }
