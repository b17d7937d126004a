// Loaded with LD_PRELOAD, it lets the n-th allocation of a program fail, or its n-th call into the system, or ends the
// process there. Counted is what happens between the begin and the end of main(). The environment says what to do:
//   DYNASURF_FAULT_KIND    memory (allocations) or system (calls)
//   DYNASURF_FAULT_AT      n, counted from 1; absent or 0: only count
//   DYNASURF_FAULT_ACTION  how it fails: "once", "onwards" (all later ones too); for calls the number of an error that
//                          the n-th one reports, "short" (half is written or read), "die" (SIGKILL before the call), or
//                          "torn" (half is written, then SIGKILL)
//   DYNASURF_FAULT_REPORT  file for the count, written when main() returns
//   DYNASURF_FAULT_TRACE   file for a line per call: its number and name, the path or descriptor it was given
//   DYNASURF_FAULT_SITES   file for the numbers of those allocations whose chain of callers is seen for the first time
//   DYNASURF_FAULT_STACK   file for the chain of callers where the fault struck
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace {

using Word = long;
enum class Kind { none, memory, system };
enum class Action { count, fail, cut, die, torn };

struct Plan {
  Kind kind = Kind::none;
  Action action = Action::count;
  long at = 0;
  bool onwards = false;
  int error = ENOMEM;
  int trace = -1, sites = -1;
  const char *report = nullptr, *stack = nullptr;
};

Plan plan;
std::atomic<bool> is_in_main{false};
std::atomic<long> counted{0};
// What the shim itself allocates and calls is not counted.
thread_local bool is_inside __attribute__((tls_model("initial-exec"))) = false;

struct Inside {
  bool before = is_inside;
  Inside() { is_inside = true; }
  ~Inside() { is_inside = before; }
};

// Past the wrappers of this file.
int open_file(const char* path) {
  return static_cast<int>(syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
}
void write_bytes(int file, const char* text, std::size_t size) { syscall(SYS_write, file, text, size); }

int file_of(const char* variable) {
  const char* path = std::getenv(variable);
  return path ? open_file(path) : -1;
}

void read_plan() {
  const auto text = [](const char* name) { return std::string_view(std::getenv(name) ? std::getenv(name) : ""); };
  plan.kind = text("DYNASURF_FAULT_KIND") == "memory"   ? Kind::memory
              : text("DYNASURF_FAULT_KIND") == "system" ? Kind::system
                                                        : Kind::none;
  plan.at = std::atol(text("DYNASURF_FAULT_AT").data());
  const std::string_view action = text("DYNASURF_FAULT_ACTION");
  plan.onwards = action == "onwards";
  plan.action = action == "short" ? Action::cut : action == "die" ? Action::die : Action::fail;
  if (action == "torn") plan.action = Action::torn;
  if (std::atoi(action.data()) > 0) plan.error = std::atoi(action.data());
  if (plan.at == 0) plan.action = Action::count;
  plan.report = std::getenv("DYNASURF_FAULT_REPORT");
  plan.stack = std::getenv("DYNASURF_FAULT_STACK");
  plan.trace = file_of("DYNASURF_FAULT_TRACE");
  plan.sites = file_of("DYNASURF_FAULT_SITES");
}

void write_count() {
  if (!plan.report) return;
  std::array<char, 32> text;
  const int size = std::snprintf(text.data(), text.size(), "%ld\n", counted.load());
  write_bytes(open_file(plan.report), text.data(), static_cast<std::size_t>(size));
}

[[noreturn]] void die() {
  for (;;) syscall(SYS_kill, getpid(), SIGKILL);
}

void tell_stack() {
  if (!plan.stack) return;
  std::array<void*, 40> frames;
  const int depth = backtrace(frames.data(), static_cast<int>(frames.size()));
  backtrace_symbols_fd(frames.data(), depth, open_file(plan.stack));
}

/// Whether the call that asks is the one to be struck. Counts it.
bool is_struck(Kind kind, long& number) {
  if (plan.kind != kind || is_inside || !is_in_main.load(std::memory_order_relaxed)) return false;
  number = ++counted;
  if (plan.at == 0 || (plan.onwards ? number < plan.at : number != plan.at)) return false;
  const Inside inside;
  if (number == plan.at) tell_stack();
  return true;
}

// ---- Allocations

/// Notes the allocation in the list of sites when no earlier one had the same chain of callers.
void note_site(long number) {
  static std::array<std::atomic<std::uint64_t>, 1u << 20> seen;
  const Inside inside;
  std::array<void*, 24> frames;
  const int depth = backtrace(frames.data(), static_cast<int>(frames.size()));
  std::uint64_t hash = 14695981039346656037u;
  for (int n = 3; n < depth; ++n)
    hash = (hash ^ reinterpret_cast<std::uintptr_t>(frames[static_cast<std::size_t>(n)])) * 1099511628211u;
  hash |= 1;  // 0 is an empty place
  for (std::size_t at = (hash >> 20) % seen.size();; at = (at + 1) % seen.size()) {
    std::uint64_t empty = 0;
    if (seen[at].compare_exchange_strong(empty, hash)) break;
    if (empty == hash) return;
  }
  std::array<char, 32> text;
  const int size = std::snprintf(text.data(), text.size(), "%ld\n", number);
  write_bytes(plan.sites, text.data(), static_cast<std::size_t>(size));
}

bool no_memory() {
  long number = 0;
  const bool struck = is_struck(Kind::memory, number);
  if (number > 0 && plan.sites >= 0) note_site(number);
  if (struck && plan.action == Action::die) die();
  if (struck) errno = ENOMEM;
  return struck;
}

}  // namespace

extern "C" {

void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

// The names of this file would stand in the way of those in the system's headers: each symbol gets its name here.
void* fault_malloc(std::size_t size) __asm__("malloc");
void* fault_malloc(std::size_t size) { return no_memory() ? nullptr : __libc_malloc(size); }

void* fault_calloc(std::size_t count, std::size_t size) __asm__("calloc");
void* fault_calloc(std::size_t count, std::size_t size) { return no_memory() ? nullptr : __libc_calloc(count, size); }

void* fault_realloc(void* block, std::size_t size) __asm__("realloc");
void* fault_realloc(void* block, std::size_t size) { return no_memory() ? nullptr : __libc_realloc(block, size); }

void* fault_memalign(std::size_t alignment, std::size_t size) __asm__("memalign");
void* fault_memalign(std::size_t alignment, std::size_t size) {
  return no_memory() ? nullptr : __libc_memalign(alignment, size);
}

void* fault_aligned_alloc(std::size_t alignment, std::size_t size) __asm__("aligned_alloc");
void* fault_aligned_alloc(std::size_t alignment, std::size_t size) { return fault_memalign(alignment, size); }

int fault_posix_memalign(void** block, std::size_t alignment, std::size_t size) __asm__("posix_memalign");
int fault_posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  void* const found = fault_memalign(alignment, size);
  if (!found) return ENOMEM;
  *block = found;
  return 0;
}
}

// ---- Calls into the system

namespace {

/// What a call takes and gives fits in words: all are numbers and pointers, six at most, passed in the same registers
/// whatever their types (x86-64, aarch64).
using Call = Word (*)(Word, Word, Word, Word, Word, Word);
using Words = std::array<Word, 6>;

Word made(Call real, const Words& w) { return real(w[0], w[1], w[2], w[3], w[4], w[5]); }

Call find_next(const char* name) {
  const Inside inside;
  const auto found = reinterpret_cast<Call>(dlsym(RTLD_NEXT, name));
  if (!found) die();
  return found;
}

/// How a function tells that it failed.
enum class Tells { minus_one, null, error, nothing_read };

struct Function {
  const char* name;
  Tells tells;
  int path = -1;         // which argument is a path
  int size = -1;         // which argument is the number of bytes
  bool ends_it = false;  // done all the same, as the system does with close()
  int stream = -1;       // which argument is a FILE* that remembers errors
};

void trace(const Function& f, const Words& w, long number) {
  const Inside inside;
  std::array<char, 512> text;
  const auto given = f.path >= 0 ? reinterpret_cast<const char*>(w[static_cast<std::size_t>(f.path)]) : nullptr;
  int size = given ? std::snprintf(text.data(), text.size(), "%ld %s %s\n", number, f.name, given)
                   : std::snprintf(text.data(), text.size(), "%ld %s %ld\n", number, f.name, w[0]);
  if (size > static_cast<int>(text.size())) size = static_cast<int>(text.size());
  write_bytes(plan.trace, text.data(), static_cast<std::size_t>(size));
}

Word failure(const Function& f, const Words& w) {
  if (f.stream >= 0) {
    constexpr int error_was_seen = 0x20;  // as glibc notes it in the first number of a FILE
    *reinterpret_cast<int*>(w[static_cast<std::size_t>(f.stream)]) |= error_was_seen;
  }
  errno = plan.error;
  switch (f.tells) {
    case Tells::minus_one:
      return -1;
    case Tells::error:
      return plan.error;
    case Tells::null:
    case Tells::nothing_read:
      break;
  }
  return 0;
}

Word call(const Function& f, Call real, Words w) {
  long number = 0;
  const bool struck = is_struck(Kind::system, number);
  if (number > 0 && plan.trace >= 0) trace(f, w, number);
  if (!struck) return made(real, w);
  if (plan.action == Action::die) die();
  if (plan.action == Action::fail) {
    if (f.ends_it) made(real, w);
    return failure(f, w);
  }
  // Half of the bytes; a call without bytes is left alone, or dies.
  if (f.size >= 0 && w[static_cast<std::size_t>(f.size)] > 1) w[static_cast<std::size_t>(f.size)] /= 2;
  const Word result = f.size >= 0 || plan.action == Action::cut ? made(real, w) : 0;
  if (plan.action == Action::torn) die();
  return result;
}

}  // namespace

#define FAULT_CALL(name, ...)                                                      \
  extern "C" Word fault_##name(Word, Word, Word, Word, Word, Word) __asm__(#name); \
  extern "C" Word fault_##name(Word a, Word b, Word c, Word d, Word e, Word f) {   \
    static const Call real = find_next(#name);                                     \
    static constexpr Function function{#name, __VA_ARGS__};                        \
    return call(function, real, {a, b, c, d, e, f});                               \
  }

FAULT_CALL(open, Tells::minus_one, 0)
FAULT_CALL(open64, Tells::minus_one, 0)
FAULT_CALL(__open_2, Tells::minus_one, 0)
FAULT_CALL(__open64_2, Tells::minus_one, 0)
FAULT_CALL(openat, Tells::minus_one, 1)
FAULT_CALL(openat64, Tells::minus_one, 1)
FAULT_CALL(__openat_2, Tells::minus_one, 1)
FAULT_CALL(__openat64_2, Tells::minus_one, 1)
FAULT_CALL(creat, Tells::minus_one, 0)
FAULT_CALL(close, Tells::minus_one, -1, -1, true)
FAULT_CALL(read, Tells::minus_one, -1, 2)
FAULT_CALL(__read_chk, Tells::minus_one, -1, 2)
FAULT_CALL(pread, Tells::minus_one, -1, 2)
FAULT_CALL(pread64, Tells::minus_one, -1, 2)
FAULT_CALL(write, Tells::minus_one, -1, 2)
FAULT_CALL(pwrite, Tells::minus_one, -1, 2)
FAULT_CALL(pwrite64, Tells::minus_one, -1, 2)
FAULT_CALL(writev, Tells::minus_one)
FAULT_CALL(lseek, Tells::minus_one)
FAULT_CALL(lseek64, Tells::minus_one)
FAULT_CALL(fsync, Tells::minus_one)
FAULT_CALL(fdatasync, Tells::minus_one)
FAULT_CALL(sync_file_range, Tells::minus_one)
FAULT_CALL(syncfs, Tells::minus_one)
FAULT_CALL(ftruncate, Tells::minus_one)
FAULT_CALL(ftruncate64, Tells::minus_one)
FAULT_CALL(truncate, Tells::minus_one, 0)
FAULT_CALL(posix_fallocate, Tells::error)
FAULT_CALL(fopen, Tells::null, 0)
FAULT_CALL(fopen64, Tells::null, 0)
FAULT_CALL(fdopen, Tells::null)
FAULT_CALL(fclose, Tells::minus_one, -1, -1, true)
FAULT_CALL(fflush, Tells::minus_one)
FAULT_CALL(fread, Tells::nothing_read, -1, 2, false, 3)
FAULT_CALL(__fread_chk, Tells::nothing_read, -1, 3, false, 4)
FAULT_CALL(fwrite, Tells::nothing_read, -1, 2, false, 3)
FAULT_CALL(rename, Tells::minus_one, 0)
FAULT_CALL(renameat, Tells::minus_one, 1)
FAULT_CALL(renameat2, Tells::minus_one, 1)
FAULT_CALL(link, Tells::minus_one, 0)
FAULT_CALL(linkat, Tells::minus_one, 1)
FAULT_CALL(unlink, Tells::minus_one, 0)
FAULT_CALL(unlinkat, Tells::minus_one, 1)
FAULT_CALL(remove, Tells::minus_one, 0)
FAULT_CALL(rmdir, Tells::minus_one, 0)
FAULT_CALL(mkdir, Tells::minus_one, 0)
FAULT_CALL(mkdirat, Tells::minus_one, 1)
FAULT_CALL(mkdtemp, Tells::null, 0)
FAULT_CALL(mkstemp, Tells::minus_one, 0)
FAULT_CALL(mkstemp64, Tells::minus_one, 0)
FAULT_CALL(mkostemp, Tells::minus_one, 0)
FAULT_CALL(mkostemp64, Tells::minus_one, 0)
FAULT_CALL(opendir, Tells::null, 0)
FAULT_CALL(fdopendir, Tells::null)
FAULT_CALL(readdir, Tells::null)
FAULT_CALL(readdir64, Tells::null)
FAULT_CALL(closedir, Tells::minus_one, -1, -1, true)
FAULT_CALL(stat, Tells::minus_one, 0)
FAULT_CALL(stat64, Tells::minus_one, 0)
FAULT_CALL(lstat, Tells::minus_one, 0)
FAULT_CALL(lstat64, Tells::minus_one, 0)
FAULT_CALL(fstat, Tells::minus_one)
FAULT_CALL(fstat64, Tells::minus_one)
FAULT_CALL(fstatat, Tells::minus_one, 1)
FAULT_CALL(fstatat64, Tells::minus_one, 1)
FAULT_CALL(statx, Tells::minus_one, 1)
FAULT_CALL(access, Tells::minus_one, 0)
FAULT_CALL(faccessat, Tells::minus_one, 1)
FAULT_CALL(readlink, Tells::minus_one, 0)
FAULT_CALL(realpath, Tells::null, 0)
FAULT_CALL(getcwd, Tells::null)
FAULT_CALL(fchmod, Tells::minus_one)
FAULT_CALL(fchmodat, Tells::minus_one, 1)
FAULT_CALL(chmod, Tells::minus_one, 0)
FAULT_CALL(utimensat, Tells::minus_one, 1)
FAULT_CALL(futimens, Tells::minus_one)
FAULT_CALL(flock, Tells::minus_one)
FAULT_CALL(fcntl, Tells::minus_one)
FAULT_CALL(fcntl64, Tells::minus_one)
FAULT_CALL(dup, Tells::minus_one)
FAULT_CALL(getrandom, Tells::minus_one)
FAULT_CALL(getentropy, Tells::minus_one)
FAULT_CALL(statvfs, Tells::minus_one, 0)
FAULT_CALL(fstatvfs, Tells::minus_one)
FAULT_CALL(sendfile, Tells::minus_one, -1, 3)
FAULT_CALL(copy_file_range, Tells::minus_one, -1, 4)
FAULT_CALL(mmap, Tells::minus_one)
FAULT_CALL(mmap64, Tells::minus_one)
FAULT_CALL(pthread_create, Tells::error)

// ---- The beginning and the end of main()

namespace {

using Main = int (*)(int, char**, char**);
Main real_main = nullptr;

int watched_main(int argc, char** argv, char** environment) {
  read_plan();
  unsetenv("LD_PRELOAD");  // the programs that this one starts are left alone
  std::array<void*, 4> frames;
  backtrace(frames.data(), static_cast<int>(frames.size()));  // loads what it needs before anything is counted
  is_in_main = true;
  const int code = real_main(argc, argv, environment);
  is_in_main = false;
  write_count();
  return code;
}

}  // namespace

extern "C" int __libc_start_main(Main begin, int argc, char** argv, void (*init)(), void (*fini)(), void (*rtld)(),
                                 void* stack) {
  using Start = int (*)(Main, int, char**, void (*)(), void (*)(), void (*)(), void*);
  const auto start = reinterpret_cast<Start>(dlsym(RTLD_NEXT, "__libc_start_main"));
  real_main = begin;
  return start(watched_main, argc, argv, init, fini, rtld, stack);
}
