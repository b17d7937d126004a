#!/usr/bin/env bash
# Builds tests/robustness/bytes_probe.cpp with several compilers, for this machine and for 64-bit ARM, runs each as
# several processors would, and says which lines differ from the golden ones. Takes ten minutes of a processor for each
# compiler; needs none of the libraries that read and write files, and no threads. `./dev check --bytes` calls it.
#
#     tools/compare_bytes.sh [-j JOBS] [clang libc++ arm gcc gcc-plain ...]
#
# Debian's packages for what is built when nothing is named: clang, clang-19 libc++-19-dev libc++abi-19-dev,
# g++-aarch64-linux-gnu, qemu-user. `./dev test` compares gcc.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
work=$root/build/bytes
golden=$root/tests/robustness/golden_bytes.txt
jobs=$(nproc)
if [ "${1:-}" = -j ]; then jobs=$2; shift 2; fi
wanted=("$@")
[ ${#wanted[@]} -gt 0 ] || wanted=(clang libc++ arm)
mkdir -p "$work"

# build NAME COMPILER-AND-FLAGS...: leaves $work/NAME/probe, without threads, of which no result depends
build() {
  local name=$1 compile file
  shift
  compile=("$@" -std=c++20 -DNDEBUG -ffp-contract=off -fno-math-errno -fno-trapping-math -DEIGEN_DONT_VECTORIZE -Wno-psabi "-I$root/src" -isystem /usr/include/eigen3)
  local at=$work/$name
  mkdir -p "$at"
  {
    printf '#include <%s>\n' algorithm array cmath cstdint functional limits map memory numbers numeric optional \
      set span sstream stop_token string string_view utility variant vector Eigen/Dense
  } >"$at/common.hpp.new"
  cmp -s "$at/common.hpp.new" "$at/common.hpp" || mv "$at/common.hpp.new" "$at/common.hpp"
  {
    echo "probe: $(for file in $(sources); do object_of "$file"; done | tr '\n' ' ')"
    echo "	${compile[*]} \$^ ${link[*]} -o probe"
    echo "common.hpp.gch: common.hpp"
    echo "	${compile[*]} -x c++-header common.hpp -o \$@"
    for file in $(sources); do
      echo "$(object_of "$file"): $file common.hpp.gch"
      echo "	${compile[*]} -include common.hpp -MMD -c $file -o \$@"
    done
    echo "-include *.d"
  } >"$at/Makefile"
  make -s -C "$at" -j "$jobs"
}
link=()
sources() {
  local module
  for module in core image field mesh synthetic dynamics heart psf_fit ventricle organ cloud; do
    find "$root/src/dynasurf/$module" -name '*.cpp' ! -name parallel_tbb.cpp ! -name parallel_workers.cpp | sort
  done
  echo "$root/tests/robustness/bytes_probe.cpp"
}
object_of() {
  local path=${1#"$root"/}
  echo "${path//\//_}.o"
}

failures=0
# compare WORDS COMMAND...: one line of the table
compare() {
  local words=$1 found differ
  shift
  found=$("$@") || { printf '%-40s does not run\n' "$words"; failures=1; return; }
  if differ=$(diff <(echo "$found") "$golden" | sed -n 's/^< \(.*[^ ]\) \+[0-9a-f]*$/\1/p'); [ -z "$differ" ]; then
    printf '%-40s the same\n' "$words"
  else
    printf '%-40s differs: %s\n' "$words" "$(echo "$differ" | paste -sd, | sed 's/,/, /g')"
    failures=1
  fi
}

# As an old processor would: the C library has no AVX2 and no fused operations, our vectors are the narrowest.
compare_here() {
  compare "$1" "$work/$1/probe"
  compare "$1, old processor" env GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX512F,-AVX2,-FMA "$work/$1/probe" 4
  if command -v qemu-x86_64 >/dev/null; then compare "$1, SSE2 alone (qemu)" qemu-x86_64 -cpu qemu64 "$work/$1/probe"; fi
}

# build_and TABLE NAME COMPILER-AND-FLAGS...: one that does not compile is told too
build_and() {
  local table=$1 name=$2
  if build "${@:2}"; then
    $table "$name"
  else
    printf '%-40s does not compile\n' "$name"
    failures=1
  fi
}
compare_plain() { compare "$1" "$work/$1/probe"; }
compare_arm() { compare "$1 (qemu)" qemu-aarch64 -L /usr/aarch64-linux-gnu "$work/$1/probe"; }

for name in "${wanted[@]}"; do
  case $name in
    gcc) build_and compare_here "$name" g++ -O3 ;;
    gcc-plain) build_and compare_plain "$name" g++ -O0 ;;
    clang) build_and compare_here "$name" clang++ -O2 ;;
    libc++)
      # The reader of numbers that libc++ has not before LLVM 20 is the page's.
      mkdir -p "$work/charconv"
      cp "$root/cmake/wasi/include/c++/charconv" "$work/charconv/"
      link=("$root/cmake/wasi/charconv.cpp")
      build_and compare_here "$name" clang++-19 -stdlib=libc++ -fexperimental-library "-I$work/charconv" -O1
      link=()
      ;;
    arm) build_and compare_arm "$name" aarch64-linux-gnu-g++ -O2 ;;
    *) echo "compare_bytes.sh: unknown build '$name'; expected clang, libc++, arm, gcc, gcc-plain" >&2; exit 1 ;;
  esac
done
exit $failures
