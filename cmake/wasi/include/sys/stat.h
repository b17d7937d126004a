/* Rights of files, which files in memory have not. */
#include_next <sys/stat.h>
#ifndef DYNASURF_SYS_STAT_H
#define DYNASURF_SYS_STAT_H
#ifdef __cplusplus
extern "C" {
#endif
int chmod(const char*, mode_t);
int fchmod(int, mode_t);
int fchmodat(int, const char*, mode_t, int);
mode_t umask(mode_t);
#ifdef __cplusplus
}
#endif
#endif
