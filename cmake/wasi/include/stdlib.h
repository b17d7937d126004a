#include_next <stdlib.h>
#ifndef DYNASURF_STDLIB_H
#define DYNASURF_STDLIB_H
#ifdef __cplusplus
extern "C" {
#endif
char* realpath(const char*, char*);
int mkstemp(char*);
#ifdef __cplusplus
}
#endif
#endif
