# Part of ./dev: what compiles the program for a browser. Compilers come from Debian's packages; the C library for
# threads, the C++ library with exceptions, zlib, libpng, pugixml, meshoptimizer and DCMTK's dcmdata are built from the
# sources of Debian's packages, once, in build/web-toolchain. The machine's own list of package sources stays as it is.

web_toolchain=build/web-toolchain
web_packages=(clang-19 lld-19 llvm-19 wasi-libc libclang-rt-19-dev-wasm32 libc++-19-dev-wasm32 libc++abi-19-dev-wasm32 dpkg-dev binaryen zopfli
              libeigen3-dev nlohmann-json3-dev libcli11-dev libdcmtk-dev googletest)
web_sources=(llvm-toolchain-19 wasi-libc dcmtk zlib pugixml meshoptimizer)

# fetch_sources: Debian's source packages, by a list of package sources and a cache of its own.
fetch_sources() {
  local here=$PWD/$web_toolchain keys=/usr/share/keyrings/debian-archive-keyring.gpg suite
  local apt=(-o "Dir::Etc::sourcelist=$here/sources.list" -o Dir::Etc::sourceparts=/dev/null
             -o "Dir::State::lists=$here/lists" -o "Dir::Cache=$here/cache")
  mkdir -p "$here/lists/partial" "$here/cache/archives/partial" "$here/download"
  for suite in "debian bookworm" "debian bookworm-updates" "debian-security bookworm-security"; do
    echo "deb-src [signed-by=$keys] http://deb.debian.org/$suite main"
  done >"$here/sources.list"
  apt-get "${apt[@]}" update
  (cd "$here/download" && apt-get "${apt[@]}" source --download-only "${web_sources[@]}" &&
    # Its patches for Debian may be gone from the mirror when the release is not: the writer of pictures does without.
    { apt-get "${apt[@]}" source --download-only libpng1.6 || compgen -G 'libpng1.6_*.orig.tar.*'; })
  rm -rf "$here/lists" "$here/cache"
}

unpack_sources() {
  local here=$PWD/$web_toolchain
  rm -rf "$here/sources"
  mkdir -p "$here/sources/libpng"
  tar -C "$here/sources" --strip-components=1 -xJf "$here"/download/llvm-toolchain-19_*.orig.tar.xz --wildcards \
    '*/libcxx/src/*' '*/libcxx/include/*' '*/libcxxabi/src/*' '*/libcxxabi/include/*' '*/libunwind/src/*' \
    '*/libunwind/include/*'
  tar -C "$here/sources/libpng" --strip-components=1 -xf "$here"/download/libpng1.6_*.orig.tar.*
  cp "$here/sources/libpng/scripts/pnglibconf.h.prebuilt" "$here/sources/libpng/pnglibconf.h"
  local part
  for part in wasi-libc dcmtk zlib pugixml meshoptimizer; do (cd "$here/sources" && dpkg-source -x ../download/${part}_*.dsc $part); done
}

# install_headers: what the program includes of the libraries, apart from the system's headers of the same names. Their
# dates are kept, so that nothing is compiled anew for them.
install_headers() {
  local from=$web_toolchain/sources to=$web_toolchain/prefix part
  mkdir -p $to/include/dcmtk/config $to/lib/cmake/{dcmtk,pugixml,meshoptimizer}
  cp -p $from/zlib/{zlib,zconf}.h $from/libpng/{png,pngconf,pnglibconf}.h $from/pugixml/src/pugi{xml,config}.hpp \
    $from/meshoptimizer/src/meshoptimizer.h $to/include
  for part in ofstd oflog dcmdata; do cp -rp $from/dcmtk/$part/include/dcmtk/$part $to/include/dcmtk; done
  cp -p /usr/include/dcmtk/config/osconfig.h $to/include/debian_osconfig.h
  cp -p cmake/wasi/dcmtk/osconfig.h $to/include/dcmtk/config/
  cp -p cmake/wasi/dcmtk/DCMTKConfig.cmake $to/lib/cmake/dcmtk/
  for part in pugixml meshoptimizer; do cp -p cmake/wasi/$part/${part}Config.cmake $to/lib/cmake/$part/; done
  # A long has 32 bits here.
  part=$to/include/dcmtk/config/arith.h
  sed 's/\(SIGNED_LONG_DIGITS10\) .*/\1 9/' /usr/include/dcmtk/config/arith.h >$part
  touch -r /usr/include/dcmtk/config/arith.h $part
}

# build_libc: Debian's is for one thread. Here errno is each thread's own, and malloc has locks and asks for a megabyte at
# a time; files have no locks, for they are the first thread's.
build_libc() {
  local here=$PWD/$web_toolchain
  make -C "$here/sources/wasi-libc" -j "$(job_count)" CC=clang-19 AR=llvm-ar-19 NM=llvm-nm-19 THREAD_MODEL=of-flags \
    EXTRA_CFLAGS="-O2 -DNDEBUG -matomics -mbulk-memory -DUSE_LOCKS=1 -DDEFAULT_GRANULARITY=1048576" \
    OBJDIR="$here/libc" SYSROOT="$here/libc/root" libc &&
    mkdir -p "$here/prefix/lib" &&
    cp -p "$here"/libc/root/lib/wasm32-wasi/lib{c,wasi-emulated-{signal,process-clocks,getpid}}.a "$here/prefix/lib"
}

# need_web: everything for `cmake --preset web`. What was built is kept until its recipe changes.
need_web() {
  local stamp=$web_toolchain/built recipe
  missing=()
  want_packages "${web_packages[@]}"
  install_missing || exit 1
  recipe=$(cat cmake/wasm32-wasi.cmake tools/web_toolchain.sh $(git ls-files cmake/wasi) | sha256sum)
  [ "$(cat $stamp 2>/dev/null)" != "$recipe" ] || return 0
  mkdir -p $web_toolchain
  if [ "$(cat $web_toolchain/unpacked 2>/dev/null)" != "${web_sources[*]}" ]; then
    say "fetching the sources of the C and C++ libraries and DCMTK (170 MB)"
    { fetch_sources && unpack_sources; } </dev/null >$web_toolchain/fetch.log 2>&1 ||
      { tail -n 5 $web_toolchain/fetch.log >&2; fail "fetching failed; all of it is in $web_toolchain/fetch.log"; }
    echo "${web_sources[*]}" >$web_toolchain/unpacked
    rm -rf $web_toolchain/download
  fi
  say "building the C and C++ libraries and DCMTK for WebAssembly"
  install_headers
  rm -rf $web_toolchain/libc $web_toolchain/build # they hold the flags of before
  { build_libc &&
    cmake -G Ninja -S cmake/wasi -B $web_toolchain/build -DCMAKE_BUILD_TYPE=Release \
      -DCMAKE_TOOLCHAIN_FILE="$PWD/cmake/wasm32-wasi.cmake" -DSOURCES="$PWD/$web_toolchain/sources" &&
    cmake --build $web_toolchain/build -j "$(job_count)"; } </dev/null >$web_toolchain/build.log 2>&1 ||
    { grep -aE -A 5 'error:' $web_toolchain/build.log | head -n 40 >&2; fail "it failed; see $web_toolchain/build.log"; }
  rm -f build/web/CMakeCache.txt # so does this
  echo "$recipe" >$stamp
}

do_web() {
  need
  need_web
  configure web
  compile web dynasurf_page
  say "the program as one page: build/web/dynasurf.html"
}
