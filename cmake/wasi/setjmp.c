/* What code that clang 19 makes of setjmp and longjmp calls. A longjmp throws its buffer; a function with setjmp catches
   it, and goes on at the label of the setjmp when the buffer was filled by this very call of the function. */
#include <setjmp.h>
#include <stdint.h>
#include <stddef.h>

typedef struct {
  void* function;
  unsigned label;
  struct {
    void* environment;
    int value;
  } thrown;
} Buffer;

void __wasm_setjmp(void* env, uint32_t label, void* function) {
  Buffer* buffer = env;
  buffer->function = function;
  buffer->label = label;
}

uint32_t __wasm_setjmp_test(void* env, void* function) {
  const Buffer* buffer = env;
  return buffer->function == function ? buffer->label : 0;
}

void __wasm_longjmp(void* env, int value) {
  Buffer* buffer = env;
  buffer->thrown.environment = env;
  buffer->thrown.value = value == 0 ? 1 : value;
  __builtin_wasm_throw(1, &buffer->thrown);
}
