#!/usr/bin/env bash
# Builds tests/robustness/bytes_probe.cpp with several compilers, for this machine and for 64-bit ARM, runs each as
# several processors would, and says which lines differ from the golden ones. Takes 10 minutes of the processor for each
# compiler; needs none of the libraries that read and write files.
#
#     tools/compare_bytes.sh [-j JOBS] [gcc-fast gcc-plain clang libc++ arm ...]
#
# Debian's packages for what is built when nothing is named: g++ clang g++-aarch64-linux-gnu qemu-user. The build libc++
# needs one with stop tokens and with from_chars of doubles (LLVM 20).
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
work=$root/build/bytes
golden=$root/tests/robustness/golden_bytes.txt
jobs=$(nproc)
if [ "${1:-}" = -j ]; then jobs=$2; shift 2; fi
wanted=("$@")
[ ${#wanted[@]} -gt 0 ] || wanted=(gcc-fast gcc-plain clang arm)
mkdir -p "$work"

# oneTBB for 64-bit ARM, from Debian, unpacked beside the build.
arm_libraries() {
  local at=$work/arm64 lists
  if [ ! -e "$at/usr/lib/aarch64-linux-gnu/libtbb.so.12" ]; then
    lists=(-oAPT::Architecture=arm64 -oAPT::Architectures=arm64 "-oDir::State::Lists=$at/lists")
    mkdir -p "$at/lists/partial"
    (cd "$at" && apt-get "${lists[@]}" update >/dev/null && apt-get "${lists[@]}" download libtbb12 >/dev/null)
    for package in "$at"/*.deb; do dpkg -x "$package" "$at"; done
  fi
  echo "$at/usr/lib/aarch64-linux-gnu"
}

# build NAME COMPILER-AND-FLAGS... -- LIBRARIES...: leaves $work/NAME/probe
build() {
  local name=$1 compile=() link=() file
  shift
  while [ "$1" != -- ]; do compile+=("$1"); shift; done
  shift
  link=("$@")
  local at=$work/$name
  mkdir -p "$at"
  compile+=(-std=c++20 -DNDEBUG -ffp-contract=off "-I$root/src" -isystem /usr/include/eigen3)
  {
    echo "probe: $(for file in $(sources); do object_of "$file"; done | tr '\n' ' ')"
    echo "	${compile[*]} \$^ ${link[*]} -o probe"
    for file in $(sources); do
      echo "$(object_of "$file"): $file"
      echo "	${compile[*]} -MMD -c $file -o \$@"
    done
    echo "-include *.d"
  } >"$at/Makefile"
  make -s -C "$at" -j "$jobs"
}
sources() {
  local module
  for module in core image field mesh synthetic dynamics ventricle cloud; do
    find "$root/src/dynasurf/$module" -name '*.cpp' ! -name parallel_serial.cpp | sort
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
  compare "$1, one thread" "$work/$1/probe" 16 1
  compare "$1, old processor" env GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX512F,-AVX2,-FMA "$work/$1/probe" 4
  if command -v qemu-x86_64 >/dev/null; then compare "$1, SSE2 alone (qemu)" qemu-x86_64 -cpu qemu64 "$work/$1/probe"; fi
}

for name in "${wanted[@]}"; do
  case $name in
    gcc-fast) build "$name" g++ -O3 -march=native -- -ltbb && compare_here "$name" ;;
    gcc-plain) build "$name" g++ -O0 -- -ltbb && compare "$name" "$work/$name/probe" ;;
    clang) build "$name" clang++ -O2 -- -ltbb && compare_here "$name" ;;
    libc++) build "$name" clang++ -stdlib=libc++ -O1 -- -ltbb && compare_here "$name" ;;
    arm)
      libraries=$(arm_libraries)
      build "$name" aarch64-linux-gnu-g++ -O2 -- "$libraries/libtbb.so.12" "-Wl,--allow-shlib-undefined" -pthread
      compare "$name (qemu)" qemu-aarch64 -L /usr/aarch64-linux-gnu -E "LD_LIBRARY_PATH=$libraries" "$work/$name/probe"
      ;;
    *) echo "compare_bytes.sh: unknown build '$name'; expected gcc-fast, gcc-plain, clang, libc++, arm" >&2; exit 1 ;;
  esac
done
exit $failures
