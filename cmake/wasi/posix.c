/* What Linux has beyond WASI, for a module that is alone with its files in memory. What cannot be done is refused with
   ENOSYS, which every caller knows; what needs no doing is done. */
#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

static int refused(void) {
  errno = ENOSYS;
  return -1;
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  (void)from_folder, (void)from, (void)to_folder, (void)to, (void)flags;
  return refused();
}

int sync_file_range(int file, off_t begin, off_t bytes, unsigned flags) {
  (void)file, (void)begin, (void)bytes, (void)flags;
  return 0;
}

/* Nobody else could hold a lock. */
int flock(int file, int operation) {
  (void)file, (void)operation;
  return 0;
}

long getrandom(void* bytes, size_t count, unsigned flags) {
  (void)flags;
  const size_t most = 256;
  for (size_t at = 0; at < count; at += most)
    if (getentropy((char*)bytes + at, count - at < most ? count - at : most) != 0) return -1;
  return (long)count;
}

int getrlimit(int resource, struct rlimit* limit) {
  (void)resource;
  limit->rlim_cur = limit->rlim_max = RLIM_INFINITY;
  return 0;
}

int setrlimit(int resource, const struct rlimit* limit) {
  (void)resource, (void)limit;
  return 0;
}

int getrusage(int who, struct rusage* usage) {
  (void)who;
  *usage = (struct rusage){0};
  usage->ru_maxrss = (long)__builtin_wasm_memory_size(0) * 64;
  return 0;
}

int chmod(const char* path, mode_t mode) {
  (void)path, (void)mode;
  return 0;
}

int fchmod(int file, mode_t mode) {
  (void)file, (void)mode;
  return 0;
}

int fchmodat(int folder, const char* path, mode_t mode, int flags) {
  (void)folder, (void)path, (void)mode, (void)flags;
  return 0;
}

mode_t umask(mode_t mode) {
  (void)mode;
  return 0;
}

int statvfs(const char* path, struct statvfs* facts) {
  (void)path, (void)facts;
  return refused();
}

int mkstemp(char* pattern) {
  (void)pattern;
  return refused();
}

int dup(int file) {
  (void)file;
  return refused();
}

int dup2(int from, int to) {
  (void)from, (void)to;
  return refused();
}

/* Nobody else is there to end the program meanwhile. */
int pause(void) { __builtin_trap(); }

FILE* popen(const char* command, const char* mode) {
  (void)command, (void)mode;
  refused();
  return NULL;
}

int pclose(FILE* file) {
  (void)file;
  return refused();
}

struct hostent* gethostbyname(const char* name) {
  (void)name;
  return NULL;
}

struct hostent* gethostbyaddr(const void* address, socklen_t bytes, int kind) {
  (void)address, (void)bytes, (void)kind;
  return NULL;
}

long gethostid(void) { return 0; }

/* Files in memory have no links: a path is real once its dots are folded. */
char* realpath(const char* path, char* to) {
  char whole[2 * 4096];
  const int length = path[0] == '/' ? snprintf(whole, sizeof whole, "%s", path) : -1;
  if (path[0] != '/') {
    if (!getcwd(whole, sizeof whole / 2)) return NULL;
    strncat(whole, "/", 1);
    strncat(whole, path, sizeof whole - strlen(whole) - 1);
  } else if (length < 0 || (size_t)length >= sizeof whole) {
    errno = ENAMETOOLONG;
    return NULL;
  }
  char real[sizeof whole] = "";
  for (char* part = strtok(whole, "/"); part; part = strtok(NULL, "/")) {
    if (strcmp(part, ".") == 0) continue;
    if (strcmp(part, "..") == 0) {
      char* const slash = strrchr(real, '/');
      if (slash) *slash = '\0';
      continue;
    }
    strcat(strcat(real, "/"), part);
  }
  if (real[0] == '\0') strcpy(real, "/");
  struct stat facts;
  if (stat(real, &facts) != 0) return NULL;
  return to ? strcpy(to, real) : strdup(real);
}
