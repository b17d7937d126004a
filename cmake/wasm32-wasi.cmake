# Toolchain file for the program in a browser: clang for wasm32-wasi with what tools/web_toolchain.sh has built.
# `./dev web` uses it.

set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(CMAKE_EXECUTABLE_SUFFIX .wasm)
set(DYNASURF_WITH_WORKERS ON) # threads are started by the page

get_filename_component(wasi_source ${CMAKE_CURRENT_LIST_DIR}/wasi REALPATH)
get_filename_component(wasi_project ${CMAKE_CURRENT_LIST_DIR}/.. REALPATH)
set(DYNASURF_WASI_PREFIX ${wasi_project}/build/web-toolchain/prefix CACHE PATH "What tools/web_toolchain.sh has built")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES DYNASURF_WASI_PREFIX)

find_program(DYNASURF_CLANG clang-19 REQUIRED)
find_program(DYNASURF_CLANGXX clang++-19 REQUIRED)
set(CMAKE_C_COMPILER ${DYNASURF_CLANG})
set(CMAKE_CXX_COMPILER ${DYNASURF_CLANGXX})
find_program(CMAKE_AR llvm-ar-19 REQUIRED)
find_program(CMAKE_RANLIB llvm-ranlib-19 REQUIRED)
set(CMAKE_C_COMPILER_TARGET wasm32-wasi)
set(CMAKE_CXX_COMPILER_TARGET wasm32-wasi)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)

# Exceptions and setjmp by WebAssembly's own exceptions, vectors of 16 bytes, threads. The folders of wasi/ and of the
# C++ library come before those of the system, which have neither.
string(JOIN " " wasi_flags
  "-fwasm-exceptions -mllvm -wasm-enable-sjlj -msimd128 -pthread"
  "-D_GNU_SOURCE -D_WASI_EMULATED_SIGNAL -D_WASI_EMULATED_PROCESS_CLOCKS -D_WASI_EMULATED_GETPID")
set(wasi_folders "-isystem ${wasi_source}/include -isystem ${DYNASURF_WASI_PREFIX}/include")
set(CMAKE_C_FLAGS_INIT "${wasi_flags} ${wasi_folders}")
# The page ends a program: nothing is destroyed at its end or at that of a thread.
string(JOIN " " CMAKE_CXX_FLAGS_INIT
  "${wasi_flags} -fno-c++-static-destructors -nostdinc++ -isystem ${wasi_source}/include/c++"
  "-isystem /usr/lib/llvm-19/include/wasm32-wasi/c++/v1 ${wasi_folders}"
  "-D_LIBCPP_ENABLE_EXPERIMENTAL")

# Eight megabytes of stack, as Linux gives, below everything else: an overflow traps instead of overwriting data. The
# memory is the page's, which hands it to all threads.
string(JOIN " " CMAKE_EXE_LINKER_FLAGS_INIT
  "-nostdlib++ -L${DYNASURF_WASI_PREFIX}/lib -Wl,-z,stack-size=8388608,--stack-first"
  "-Wl,--import-memory,--max-memory=4294967296,--strip-all"
  "-Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=posix_memalign,--wrap=aligned_alloc,--wrap=sbrk")
set(CMAKE_CXX_STANDARD_LIBRARIES
    "-lc++ -lc++abi -ldynasurf-wasi -lwasi-emulated-signal -lwasi-emulated-process-clocks -lwasi-emulated-getpid")

set(CMAKE_FIND_ROOT_PATH ${DYNASURF_WASI_PREFIX})
set(DCMTK_DIR ${DYNASURF_WASI_PREFIX}/lib/cmake/dcmtk)
set(pugixml_DIR ${DYNASURF_WASI_PREFIX}/lib/cmake/pugixml)
set(meshoptimizer_DIR ${DYNASURF_WASI_PREFIX}/lib/cmake/meshoptimizer)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH)
