/* What Linux has beyond WASI. A memory file system exchanges nothing: the callers know the refusal. */
#include_next <stdio.h>
#ifndef DYNASURF_STDIO_H
#define DYNASURF_STDIO_H
#ifdef __cplusplus
extern "C" {
#endif
#define RENAME_NOREPLACE 1
#define RENAME_EXCHANGE 2
FILE* popen(const char*, const char*);
int pclose(FILE*);
int renameat2(int, const char*, int, const char*, unsigned);
#ifdef __cplusplus
}
#endif
#endif
