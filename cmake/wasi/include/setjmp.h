/* setjmp and longjmp, which clang makes of WebAssembly's exceptions (-wasm-enable-sjlj) with the help of setjmp.c. */
#ifndef DYNASURF_SETJMP_H
#define DYNASURF_SETJMP_H
#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  void* function;
  unsigned label;
  struct {
    void* environment;
    int value;
  } thrown;
} jmp_buf[1];
typedef jmp_buf sigjmp_buf;

int setjmp(jmp_buf) __attribute__((returns_twice));
void longjmp(jmp_buf, int) __attribute__((noreturn));
#define setjmp setjmp

#ifdef __cplusplus
}
#endif
#endif
