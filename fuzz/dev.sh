# What `./dev fuzz` does. ./dev reads this file; the functions it calls (say, fail, need, configure, compile) are there.

fuzz_work=build/fuzz-work      # what campaigns found, and how far they came; safe to delete
fuzz_dcmtk=build/fuzz-dcmtk    # DCMTK with the sanitizers
fuzz_figures=$fuzz_work/figures.tsv

fuzz_usage() {
  cat <<'TEXT'
./dev fuzz                          the targets, and what was run so far, as a table in Markdown
./dev fuzz TARGET|all SECONDS       look for input that crashes, hangs (over 1 s) or leaks
./dev fuzz quick TARGET|all SECONDS the same without the address sanitizer and traced comparisons: three times as many
./dev fuzz minimise TARGET|all      write the smallest files that reach what was reached to fuzz/corpus/
./dev fuzz seeds                    make the first files anew, into build/fuzz-work/<target>/corpus
TEXT
}

fuzz_targets() { sed -n 's/^dynasurf_fuzz_target(\([a-z0-9_]*\) .*/\1/p' fuzz/CMakeLists.txt; }
# fuzz_fact TARGET KEY: of its line in fuzz/CMakeLists.txt.
fuzz_fact() { sed -n "s/^dynasurf_fuzz_target($1 .*\b$2 \([a-z0-9_]*\).*/\1/p" fuzz/CMakeLists.txt; }

# Debian's own source of the DCMTK that is installed, from the mirror that the machine uses, into $fuzz_dcmtk/source.
fuzz_fetch_dcmtk() {
  local apt=$PWD/$fuzz_dcmtk/apt version uri suite key=/usr/share/keyrings/debian-archive-keyring.gpg
  version=$(dpkg-query -W -f='${source:Version}' libdcmtk-dev)
  read -r uri suite < <(apt-cache policy libdcmtk-dev | awk '$2 ~ /^https?:/ {split($3, s, "/"); print $2, s[1]; exit}')
  mkdir -p "$apt"/{parts,lists/partial,cache/archives/partial}
  echo "deb-src $([ -f $key ] && echo "[signed-by=$key]") $uri $suite main" >"$apt/parts/source.list"
  local options=(-o Dir::Etc::SourceList=/dev/null -o "Dir::Etc::SourceParts=$apt/parts" -o "Dir::State::Lists=$apt/lists"
                 -o "Dir::Cache=$apt/cache")
  (cd $fuzz_dcmtk && apt-get "${options[@]}" update && apt-get "${options[@]}" source --download-only "dcmtk=$version" &&
    rm -rf source && dpkg-source -x dcmtk_*.dsc source)
}

# The flags go in after DCMTK has looked at the machine: its look divides by zero on purpose.
fuzz_build_dcmtk() {
  echo "add_compile_options(-w -O1 -gline-tables-only -fno-omit-frame-pointer -fno-sanitize-recover=all
    -fsanitize=address,undefined,fuzzer-no-link -fno-sanitize=vptr,function)" >$fuzz_dcmtk/flags.cmake
  local launcher off=()
  launcher=$(command -v ccache || true)
  for library in TIFF PNG XML OPENSSL SNDFILE ICONV STDLIBC_ICONV ICU WRAP OPENJPEG DOXYGEN; do
    off+=("-DDCMTK_WITH_$library=OFF")
  done
  cmake -S $fuzz_dcmtk/source -B $fuzz_dcmtk/build -G Ninja -DCMAKE_BUILD_TYPE=None "${off[@]}" -DDCMTK_WITH_ZLIB=ON \
    -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ \
    "-DCMAKE_C_COMPILER_LAUNCHER=$launcher" "-DCMAKE_CXX_COMPILER_LAUNCHER=$launcher" \
    -DCMAKE_PROJECT_INCLUDE="$PWD/$fuzz_dcmtk/flags.cmake" "-DDCMTK_MODULES=ofstd;oflog;dcmdata" \
    -DBUILD_SHARED_LIBS=OFF -DBUILD_APPS=OFF -DBUILD_TESTING=OFF -DDCMTK_DEFAULT_DICT=builtin -DCMAKE_INSTALL_DATADIC=share/dicom \
    -DDCMTK_ENABLE_STL=OFF -DCMAKE_INSTALL_PREFIX="$PWD/$fuzz_dcmtk/installed" &&
    cmake --build $fuzz_dcmtk/build -j "$(job_count)" && cmake --install $fuzz_dcmtk/build
}

# Sets `dcmtk` to the options that make CMake take our DCMTK.
fuzz_need_dcmtk() {
  dcmtk=(-UDCMTK_DIR)
  mkdir -p $fuzz_dcmtk
  if [ ! -f $fuzz_dcmtk/ready ]; then
    say "fetching and building DCMTK with the sanitizers, once; it takes minutes"
    if ! { fuzz_fetch_dcmtk && fuzz_build_dcmtk && touch $fuzz_dcmtk/ready; } >$fuzz_dcmtk/log 2>&1; then
      say "warning: no source of DCMTK ($fuzz_dcmtk/log tells why); its own code runs without sanitizers" >&2
      return
    fi
  fi
  dcmtk=("-DDCMTK_DIR=$PWD/$(dirname $fuzz_dcmtk/installed/lib/cmake/dcmtk/DCMTKConfig.cmake)")
}

# fuzz_build PRESET TARGET...
fuzz_build() {
  local preset=$1 dcmtk=() names=()
  shift
  need clang:clang
  missing=()
  want_packages "libclang-rt-$(clang -dumpversion | cut -d. -f1)-dev" dpkg-dev
  install_missing || exit 1
  [ "$preset" != fuzz ] || fuzz_need_dcmtk
  configure "$preset" "${dcmtk[@]}"
  for target in "$@"; do names+=("fuzz_$target"); done
  compile "$preset" "${names[@]}" >build/fuzz.log 2>&1 || { tail -n 40 build/fuzz.log >&2; fail "build/fuzz.log tells more"; }
}

# A hang is counted by the clock on the wall: on a busy machine many are none. One that needs over 1 s of the processor
# (and 1 s for the start of the program) is.
fuzz_confirmed() {
  case $3 in
    */timeout-*) ! (ulimit -t 2 && "build/$1/bin/fuzz_$2" -timeout=1000 "$3") >/dev/null 2>&1 ;;
    *) true ;;
  esac
}

# fuzz_run PRESET TARGET SECONDS: 1 when something was found. Entropic weighs the corpus by how rare its features are;
# that took 15 % (NIfTI) to 40 % (DICOM) of the time, and re-reading the corpus of other processes is of no use to one.
fuzz_run() {
  local preset=$1 target=$2 seconds=$3 work=$fuzz_work/$2 begin=$SECONDS left finds=0 count
  local log=$work/log name words=()
  mkdir -p "$work/corpus" "$work/crashes"
  for name in "$target" "$(fuzz_fact "$target" SOURCE)"; do
    [ ! -f "fuzz/dictionaries/$name.dict" ] || { words=(-dict="fuzz/dictionaries/$name.dict"); break; }
  done
  while left=$((seconds - (SECONDS - begin))) && [ "$left" -gt 0 ]; do
    "build/$preset/bin/fuzz_$target" "$work/corpus" "fuzz/corpus/$target" -max_total_time="$left" -timeout=1 \
      -rss_limit_mb=2048 -malloc_limit_mb=256 -max_len="$(fuzz_fact "$target" LENGTH)" -print_final_stats=1 \
      -entropic=0 -reload=0 \
      "${words[@]}" -artifact_prefix="$work/crashes/" \
      >"$log" 2>&1 || true
    count=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
    printf '%s\t%s\t%s\t%s\t%s\n' "$target" "${count:-0}" \
      "$(grep -o 'cov: [0-9]*' "$log" | tail -n 1 | cut -d' ' -f2)" "$((SECONDS - begin))" "$preset" >>$fuzz_figures
    seconds=$((seconds - (SECONDS - begin))) begin=$SECONDS
    say "$target: ${count:-no} executions, $(grep -o 'cov: [0-9]* ft: [0-9]*' "$log" | tail -n 1)"
    [ -n "$count" ] || { tail -n 20 "$log" >&2; return 1; }
    for file in "$work"/crashes/*; do
      [ -e "$file" ] || continue
      if fuzz_confirmed "$preset" "$target" "$file"; then finds=1; else rm "$file"; fi
    done
    [ $finds = 0 ] || { grep -m 1 -E 'ERROR:|runtime error:|broken promise:' "$log" >&2; break; }
  done
  [ $finds = 0 ] || { say "found: $(ls "$work"/crashes/*)" >&2; return 1; }
}

# The figures of all runs so far, by target.
fuzz_table() {
  [ -f $fuzz_figures ] || touch $fuzz_figures
  printf '| target | executions | with addresses watched | edges | seconds | open finds |\n|---|---:|---:|---:|---:|---:|\n'
  for target in $(fuzz_targets); do
    awk -F '\t' -v t="$target" -v finds="$(find "$fuzz_work/$target/crashes" -type f 2>/dev/null | wc -l)" \
      '$1 == t {n += $2; s += $4; if ($5 != "fuzz-quick") {a += $2; if ($3 > e) e = $3}}
       END {printf "| %s | %d | %d | %d | %d | %d |\n", t, n, a, e, s, finds}' \
      $fuzz_figures
  done
}

# fuzz_minimise TARGET: at most 200 files of at most 8 kB, the smallest first; what once broke a reader stays.
fuzz_minimise() {
  local target=$1 merged=$fuzz_work/$1/merged corpus=fuzz/corpus/$1 count=0 file
  rm -rf "$merged" && mkdir -p "$merged" "$corpus" "$fuzz_work/$1/corpus"
  "build/fuzz/bin/fuzz_$target" -merge=1 -set_cover_merge=1 -use_counters=0 -use_cmp=0 -timeout=5 -max_len=8192 "$merged" "$corpus" "$fuzz_work/$target/corpus" \
    >"$fuzz_work/$target/log" 2>&1 || { tail -n 20 "$fuzz_work/$target/log" >&2; return 1; }
  find "$corpus" -type f ! -name 'once-*' -delete
  while read -r _ file && [ $count -lt 200 ]; do
    cp "$file" "$corpus/$(sha1sum "$file" | cut -c1-16).bin"
    count=$((count + 1))
  done < <(find "$merged" -type f -size -9k -printf '%s %p\n' | sort -n)
  say "$target: $(find "$corpus" -type f | wc -l) files, $(du -sb "$corpus" | cut -f1) bytes"
}

do_fuzz() {
  local targets target failed=0
  mkdir -p $fuzz_work
  if [ $# = 0 ]; then
    fuzz_usage
    echo
    fuzz_table
    return
  fi
  if [ "$1" = seeds ] && [ $# = 1 ]; then
    need
    configure release -DDYNASURF_WERROR="$(warnings)"
    compile release fuzz_seeds
    build/release/bin/fuzz_seeds $fuzz_work/seeds
    for target in $(fuzz_targets); do
      mkdir -p "$fuzz_work/$target/corpus"
      cp $fuzz_work/seeds/"$target"/* "$fuzz_work/$target/corpus/"
    done
    return
  fi
  local preset=fuzz verb=run what seconds
  if [ "$1" = quick ]; then preset=fuzz-quick; shift; fi
  what=${1:-} seconds=${2:-}
  if [ "$what" = minimise ]; then verb=minimise what=${2:-} seconds=0; fi
  if [ $# != 2 ] || ! [[ $seconds =~ ^[0-9]+$ ]]; then
    fuzz_usage >&2
    fail "expected a target or 'all', and seconds"
  fi
  targets=$(fuzz_targets | grep -x "$([ "$what" = all ] && echo '.*' || echo "$what")") ||
    fail "unknown target '$what'; choices: all $(fuzz_targets | xargs)"
  fuzz_build $preset $targets
  for target in $targets; do
    if [ $verb = run ]; then fuzz_run $preset "$target" "$seconds"; else fuzz_minimise "$target"; fi || failed=1
  done
  exit $failed
}
