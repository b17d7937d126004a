// The end of a module's one thread is the end of the program.
extern "C" {
int __cxa_atexit(void (*)(void*), void*, void*);
int __cxa_thread_atexit(void (*destructor)(void*), void* object, void* module) {
  return __cxa_atexit(destructor, object, module);
}
}
