#!/usr/bin/env bash
# Runs tests of the Python module with the memory of the address sanitizer.
#
#     tools/python_sanitized.sh [BUILD] [TEST.py ...]
#
# The module is the one that was built; the interpreter loads the sanitizer first, so that every block comes from its
# allocator. Blocks that are freed twice, or copied from or to after they were freed, end the tests; NumPy copies by the
# functions that it watches. Leaks are not told: an interpreter keeps memory of its own at its end.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${1:-build/release}
shift || true
[ $# -gt 0 ] || set -- test_arrays.py test_pickle.py test_camera.py
runtime="$(${CXX:-c++} -print-file-name=libasan.so) $(${CXX:-c++} -print-file-name=libstdc++.so.6)"
package=$PWD/$build/python
cd python/tests
ASAN_OPTIONS=detect_leaks=0:abort_on_error=1 LD_PRELOAD=$runtime PYTHONMALLOC=malloc PYTHONDONTWRITEBYTECODE=1 \
  PYTHONPATH=$package "${PYTHON:-/usr/bin/python3}" run.py "$@"
