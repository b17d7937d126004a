#!/usr/bin/env bash
# Builds the Python module and all its libraries with the address and undefined sanitizers, and runs tests with it.
#
#     tools/python_sanitized.sh [TEST.py ...]
#
# The interpreter loads the sanitizer first and takes all memory from it. Leaks are not told: an interpreter keeps memory of
# its own at its end.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${BUILD:-build/asan}
cmake --preset asan -B "$build" -DDYNASURF_WITH_PYTHON=REQUIRED >/dev/null
cmake --build "$build" --target python
package=$PWD/$build/python
compiler=${CXX:-c++}
runtime="$($compiler -print-file-name=libasan.so) $($compiler -print-file-name=libubsan.so) $($compiler -print-file-name=libstdc++.so.6)"
cd python/tests
ASAN_OPTIONS=detect_leaks=0:abort_on_error=1:detect_stack_use_after_return=0 UBSAN_OPTIONS=print_stacktrace=1 LD_PRELOAD=$runtime \
  PYTHONMALLOC=malloc PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$package "${PYTHON:-/usr/bin/python3}" run.py "$@"
