#!/usr/bin/env bash
# Builds the Python module with the address sanitizer and runs tests with it.
#
#     tools/python_sanitized.sh [TEST.py ...]
#
# The module has a folder of its own, python-asan in the build; the libraries in it are the ordinary ones. The interpreter
# loads the sanitizer first and takes all memory from it: whatever the module touches, and all that NumPy copies, must be
# inside a block that was not freed. Leaks are not told: an interpreter keeps memory of its own at its end.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${BUILD:-build/release}
[ $# -gt 0 ] || set -- test_arrays.py test_pickle.py test_camera.py
cmake --build "$build" --target dynasurf_python_sanitized
package=$PWD/$build/python-asan
cp python/dynasurf/*.py "$package/dynasurf"
runtime="$(${CXX:-c++} -print-file-name=libasan.so) $(${CXX:-c++} -print-file-name=libstdc++.so.6)"
cd python/tests
ASAN_OPTIONS=detect_leaks=0:abort_on_error=1 LD_PRELOAD=$runtime PYTHONMALLOC=malloc PYTHONDONTWRITEBYTECODE=1 \
  PYTHONPATH=$package "${PYTHON:-/usr/bin/python3}" run.py "$@"
