/* How full a file system is: not known of one in memory. */
#ifndef DYNASURF_SYS_STATVFS_H
#define DYNASURF_SYS_STATVFS_H
#ifdef __cplusplus
extern "C" {
#endif
struct statvfs {
  unsigned long f_frsize;
  unsigned long long f_blocks, f_bfree, f_bavail;
};
int statvfs(const char*, struct statvfs*);
#ifdef __cplusplus
}
#endif
#endif
