/* Limits and use of a process, as far as a module in a browser has them: ru_maxrss is its memory in KiB. */
#ifndef DYNASURF_SYS_RESOURCE_H
#define DYNASURF_SYS_RESOURCE_H
#include <sys/time.h>
#ifdef __cplusplus
extern "C" {
#endif
typedef unsigned long long rlim_t;
struct rlimit {
  rlim_t rlim_cur, rlim_max;
};
#define RLIM_INFINITY (~0ULL)
#define RLIMIT_CORE 4
#define RLIMIT_AS 9
int getrlimit(int, struct rlimit*);
int setrlimit(int, const struct rlimit*);

struct rusage {
  struct timeval ru_utime, ru_stime;
  long ru_maxrss;
};
#define RUSAGE_SELF 0
int getrusage(int, struct rusage*);
#ifdef __cplusplus
}
#endif
#endif
