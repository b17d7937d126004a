/* Memory that another thread has made larger: a browser lets a thread fill and copy no further than it has seen the
   memory reach (V8 tells the others, who hear of it at their next call). So whoever gets memory looks first, be it from
   malloc or behind a lock. The linker puts these functions before those of the C library (--wrap). */
#include <errno.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static size_t pages;              /* of the memory, once malloc has asked for more */
static _Thread_local size_t seen; /* of them */

void dynasurf_see_memory(void) {
  static volatile const size_t none = 0;
  const size_t now = __atomic_load_n(&pages, __ATOMIC_ACQUIRE);
  if (now == seen) return;
  seen = now;
  __builtin_wasm_memory_grow(0, none);
}

void* __real_sbrk(intptr_t bytes);
void* __wrap_sbrk(intptr_t bytes) {
  void* const end = __real_sbrk(bytes);
  if (bytes > 0) __atomic_store_n(&pages, __builtin_wasm_memory_size(0), __ATOMIC_RELEASE);
  return end;
}

void* __real_malloc(size_t bytes);
void* __wrap_malloc(size_t bytes) {
  void* const memory = __real_malloc(bytes);
  dynasurf_see_memory();
  return memory;
}

void* __wrap_calloc(size_t count, size_t bytes) {
  size_t all;
  if (__builtin_mul_overflow(count, bytes, &all)) {
    errno = ENOMEM;
    return NULL;
  }
  void* const memory = __wrap_malloc(all);
  return memory ? memset(memory, 0, all) : NULL;
}

size_t malloc_usable_size(void* memory);
void* __wrap_realloc(void* old, size_t bytes) {
  if (!old) return __wrap_malloc(bytes);
  const size_t had = malloc_usable_size(old);
  if (bytes <= had && bytes > had / 2) return old;
  void* const memory = __wrap_malloc(bytes);
  if (!memory) return NULL;
  memcpy(memory, old, had < bytes ? had : bytes);
  free(old);
  return memory;
}

int __real_posix_memalign(void** memory, size_t alignment, size_t bytes);
int __wrap_posix_memalign(void** memory, size_t alignment, size_t bytes) {
  const int refusal = __real_posix_memalign(memory, alignment, bytes);
  dynasurf_see_memory();
  return refusal;
}

void* __real_aligned_alloc(size_t alignment, size_t bytes);
void* __wrap_aligned_alloc(size_t alignment, size_t bytes) {
  void* const memory = __real_aligned_alloc(alignment, bytes);
  dynasurf_see_memory();
  return memory;
}
