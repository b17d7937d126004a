#include_next <unistd.h>
#ifndef DYNASURF_UNISTD_H
#define DYNASURF_UNISTD_H
#ifdef __cplusplus
extern "C" {
#endif
int dup(int);
int dup2(int, int);
int pause(void);
#ifdef __cplusplus
}
#endif
#endif
