# What `./dev package` and `./dev release` do. ./dev reads this file; the functions it calls (say, fail, need, configure,
# compile, warnings) are there.

packages=build/package

project_version() { sed -n 's/^project(dynasurf VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt; }

make_packages() {
  # Times in the packages are those of the commit: the same commit gives the same packages.
  SOURCE_DATE_EPOCH=$(git log -1 --format=%ct 2>/dev/null || stat -c %Y CHANGELOG.md)
  export SOURCE_DATE_EPOCH
  configure package -DDYNASURF_WERROR="$(warnings)"
  compile package
  # The page is a part of them where ./dev web ran before, which needs a toolchain of its own; of these sources.
  if [ -f build/web/build.ninja ]; then compile web dynasurf_page
  else say "without dynasurf.html, which ./dev web makes"; fi
  rm -f $packages/*.deb
  (umask 022 && cd $packages && cpack) >build/cpack.log 2>&1 || { cat build/cpack.log >&2; fail "cpack failed"; }
}

# The packages in a bare Debian 12 that is thrown away afterwards: tests/package/in_bare_debian.sh says what is tried.
try_in_bare_debian() {
  local log=build/bare-debian.log begun=build/bare-debian-begun trial=build/trial
  rm -rf $begun $trial
  mkdir -p $trial
  cp -r $packages/*.deb tests/package/*.sh tests/package/installed examples $trial
  if mmdebstrap --variant=apt --customize-hook="touch '$PWD/$begun'" --customize-hook="copy-in $trial /tmp" \
       --customize-hook='chroot "$1" bash /tmp/trial/in_bare_debian.sh' bookworm /dev/null </dev/null >$log 2>&1; then
    sed -n 's/^tried: /dev: in a bare Debian 12: /p' $log
  elif [ -e $begun ]; then
    tail -n 20 $log >&2
    fail "the packages do not work in a bare Debian 12; all of it is in $log"
  else
    say "warning: a bare Debian cannot be set up here ($log tells why); the programs run unpacked instead" >&2
    try_unpacked
  fi
}

try_unpacked() {
  local folder=$packages/unpacked package
  rm -rf $folder
  for package in $packages/*.deb; do dpkg-deb -x "$package" $folder; done
  bash tests/package/first_use.sh $folder/usr/bin/dynasurf | sed -n 's/^tried: /dev: unpacked: /p'
  [ "${PIPESTATUS[0]}" = 0 ] || fail "the unpacked program does not work"
}

try_container() {
  local log=build/container.log code=0
  bash tests/package/container.sh . >$log 2>&1 || code=$?
  case $code in
    0) sed -n 's/^tried: /dev: in a container: /p' $log ;;
    77) say "warning: no base of a container can be had here ($log tells why)" >&2 ;;
    *) tail -n 20 $log >&2; fail "the container does not work; all of it is in $log" ;;
  esac
}

do_package() {
  need lintian:lintian mmdebstrap:mmdebstrap dpkg-shlibdeps:dpkg-dev file:file
  make_packages
  say "lintian"
  # Nothing is uploaded to Debian, so no bug of its list is closed.
  lintian --fail-on error --suppress-tags initial-upload-closes-no-bugs $packages/*.deb || fail "lintian found errors"
  say "the packages in a bare Debian 12"
  try_in_bare_debian
  say "the program in a container"
  try_container
  ls $packages/*.deb
}

# Those of the Debian packages of the build that dpkg knows here, with commas between them.
build_packages() {
  dpkg-query -W -f='${db:Status-Status} ${Package}\n' "${libraries[@]}" "${tools[@]##*:}" nodejs npm 2>/dev/null |
    sed -n 's/^installed //p' | sort -u | paste -sd ,
}

do_release() {
  local version folder
  [ -z "$(git status --porcelain)" ] || fail "release: there are changes that are not committed"
  version=$(project_version)
  folder=build/release-$version
  do_package
  rm -rf "$folder"
  mkdir -p "$folder"
  git archive --format=tar --prefix="dynasurf-$version/" HEAD | gzip -9n >"$folder/dynasurf-$version.tar.gz"
  cp $packages/*.deb "$folder"
  local listed=(--program $packages/bin/dynasurf --packages "$(build_packages)")
  python3 tools/sbom.py "${listed[@]}" "$folder/sbom.spdx.json"
  python3 tools/check_sbom.py "${listed[@]}" "$folder/sbom.spdx.json"
  (cd "$folder" && sha256sum -- *.tar.gz *.deb sbom.spdx.json >SHA256SUMS)
  cat "$folder/SHA256SUMS"
  say "version $version is in $PWD/$folder"
}
