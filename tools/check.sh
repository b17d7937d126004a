# The checks of ./dev check. Sourced by ./dev, which brings say, need, configure, compile and sources.
#
# Every check runs to its end, whatever the ones before it found, and the last lines are a table of all of them.

checked=()
passed_checks=build/check

# The tree that is checked out; nothing where files differ from it.
checked_tree() { [ -n "$(git status --porcelain 2>&1)" ] || git rev-parse 'HEAD^{tree}'; }

# step NAME COMMAND...
step() {
  local name=$1 begin=$SECONDS verdict=passed
  shift
  say "$name"
  ("$@") || verdict=FAILED
  checked+=("$(printf '%-34s %6d s  %s' "$name" $((SECONDS - begin)) "$verdict")")
}

# long_step NAME COMMAND... : what passed with these very sources is not repeated, so that hours can be cut in pieces.
long_step() {
  local passed=$passed_checks/${1// /-} tree
  tree=$(checked_tree)
  if [ -n "$tree" ] && grep -qs "^$tree " "$passed"; then
    checked+=("$(printf '%-34s %6d s  passed before' "$1" "$(cut -d ' ' -f 2 "$passed")")")
    return
  fi
  local begin=$SECONDS
  step "$@"
  case "${checked[-1]}" in
    *passed) mkdir -p $passed_checks && printf '%s %s\n' "$tree" $((SECONDS - begin)) >"$passed" ;;
  esac
}

end_of_checks() {
  printf '\n'
  printf '%s\n' "${checked[@]}"
  case "${checked[*]}" in *FAILED*) fail "not all checks passed" ;; esac
  say "all checks passed"
}

check_format() { sources | xargs clang-format --dry-run --Werror; }

check_rules() {
  configure release -DDYNASURF_WERROR="$(warnings)" && compile release dynasurf &&
    ctest --preset release -R '^tools/' --output-on-failure
}

# Sources that are joined are looked at together: what takes time are the headers of the libraries.
check_tidy() {
  configure tidy && compile tidy dynasurf_version && python3 tools/compiled_units.py build/tidy src app |
    xargs -r -P "$(job_count)" -n 1 clang-tidy --quiet --checks=-bugprone-suspicious-include -p build/tidy
}

# What tells nothing under a sanitizer: tests of sources and pages, which run nothing that is compiled; of other programs,
# which keep memory to the end; those that measure memory, time and instructions, limit the room for addresses, which
# sanitizers need, or count processes anew, among which leaks cannot be sought. Whole jobs run those commands too.
unsanitized='^((tools|package|web|oracles|robustness|cli/batch|cli/collect)/|cli/names/Reasons|cli/out/Containers)'

# What starts no thread tells nothing under ThreadSanitizer: readers and writers, pictures. Laws of the explicit scheme that
# take thousands of its steps take up to half an hour there, and tell no more of its threads than the other tests of fields.
unthreaded='^(io|fuzz|show)/|^field/(Gvf\.(OutsideASphere|InsideASphere|Reproduces|IsStableBelow|EveryPath)'
unthreaded+='|SteadyGvf\.(IsWhereTheExplicit|NeedsNoMore)|VoxelSphere\.BoundsTheStep)'

check_tests() {
  local left_out=$unsanitized
  [ "$1" != tsan ] || left_out="$left_out|$unthreaded"
  # Tests of hostile files allow so many times what they take elsewhere.
  local known_leaks=suppressions=$PWD/tests/robustness/leaks.supp:print_suppressions=0
  configure "$1" && compile "$1" && DYNASURF_SLOWNESS=20 LSAN_OPTIONS=$known_leaks \
    ctest --preset "$1" -j "$(nproc)" -E "$left_out"
}
check_jobs() {
  configure "$1" && compile "$1" dynasurf && python3 tests/robustness/whole_jobs.py --program "build/$1/bin/dynasurf"
}

check_leaks() {
  configure release -DDYNASURF_WERROR="$(warnings)" && compile release dynasurf &&
    python3 tests/robustness/whole_jobs.py --program "$program" --limit 7200 --wrapper "valgrind -q --error-exitcode=99
      --leak-check=full --errors-for-leak-kinds=definite,indirect,possible
      --suppressions=$PWD/tests/robustness/valgrind.supp"
}

# What needs no compiler.
check_quickly() {
  need clang-format:clang-format
  step "format" check_format
  step "include rules" python3 tools/check_includes.py
  step "sources" python3 tools/check_sources.py
  step "same bytes" python3 tools/check_same_bytes.py
  step "streams" python3 tools/check_streams.py
  step "words" python3 tools/check_words.py
  step "thesis map" python3 tools/check_thesis_map.py
  step "figures" python3 tools/figures.py
  end_of_checks
}

# 10,000 kills at random moments, then every call and allocation of four commands fails: most of a day. Shorter with
# DYNASURF_KILLS, DYNASURF_KILL_SECONDS (for each command) and DYNASURF_FAULTS (for each command and kind) in the environment.
check_campaign() {
  need
  configure release -DDYNASURF_WERROR="$(warnings)"
  compile release dynasurf fault_shim
  cd tests/robustness
  DYNASURF_PROGRAM=$OLDPWD/$program DYNASURF_FAULT_SHIM=$(find "$OLDPWD/$build" -name libfault_shim.so) \
    DYNASURF_KILLS=${DYNASURF_KILLS:-10000} DYNASURF_FAULTS=${DYNASURF_FAULTS:-all} PYTHONDONTWRITEBYTECODE=1 \
    PYTHONPATH=../cli exec nice python3 -m unittest -v test_kill test_faults
}

# The libraries by other compilers, with another C++ library and for 64-bit ARM.
check_bytes() {
  need
  missing=()
  want_packages clang clang-19 libc++-19-dev libc++abi-19-dev g++-aarch64-linux-gnu qemu-user
  install_missing || exit 1
  exec tools/compare_bytes.sh -j "$(job_count)"
}

do_check() {
  case "${1:-}" in
    --quick) check_quickly; return ;;
    --campaign) check_campaign; return ;;
    --bytes) check_bytes ;;
    "") ;;
    *) fail "check: unknown option '$1'; expected --quick, --campaign, --bytes or nothing" ;;
  esac
  need clang-format:clang-format clang-tidy:clang-tidy clang++:clang valgrind:valgrind
  step "format" check_format
  step "include rules and documents" check_rules
  long_step "clang-tidy" check_tidy
  local preset
  for preset in asan tsan; do
    long_step "every command under $preset" check_jobs "$preset"
    long_step "tests under $preset" check_tests "$preset"
  done
  long_step "every command under isan" check_jobs isan
  long_step "every command under Valgrind" check_leaks
  end_of_checks
}
