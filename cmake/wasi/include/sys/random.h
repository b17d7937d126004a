#include_next <sys/random.h>
#ifndef DYNASURF_SYS_RANDOM_H
#define DYNASURF_SYS_RANDOM_H
#ifdef __cplusplus
extern "C" {
#endif
#include <stddef.h>
long getrandom(void*, size_t, unsigned);
#ifdef __cplusplus
}
#endif
#endif
