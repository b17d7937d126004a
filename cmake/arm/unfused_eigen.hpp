// Read before everything else where the processor is a 64-bit ARM (cmake/dynasurf.cmake). Eigen's vectors of two
// doubles would multiply and add in one rounding there and in two on x86-64; without this macro of the compiler they do
// the same on both. The header is read first since it sets the macro.
#if defined(__aarch64__) || defined(_M_ARM64)
#include <arm_neon.h>
#undef __ARM_FEATURE_FMA
#endif
