#include_next <fcntl.h>
#ifndef DYNASURF_FCNTL_H
#define DYNASURF_FCNTL_H
#ifdef __cplusplus
extern "C" {
#endif
#ifndef F_DUPFD
#define F_DUPFD 0
#endif
#define SYNC_FILE_RANGE_WRITE 2
int sync_file_range(int, off_t, off_t, unsigned);
#ifdef __cplusplus
}
#endif
#endif
