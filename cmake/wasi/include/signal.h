#include_next <signal.h>
#ifndef DYNASURF_SIGNAL_H
#define DYNASURF_SIGNAL_H
#include <__typedef_sigset_t.h>
#endif
