#!/usr/bin/env bash
# The image of Containerfile: container.sh CONTEXT, a folder with Containerfile and build/package/dynasurf_*.deb. Builds
# it and runs the program in it as nobody, without a network and with nothing but /tmp to write to. Prints a line
# `tried: ...` for each thing that worked; ends with 77 where no base can be had.
#
# The base is debian:bookworm-slim, or where no registry can be reached one that mmdebstrap makes in the same way.
set -euo pipefail
context=$(realpath "$1")
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
image=localhost/dynasurf-test base=docker.io/library/debian:bookworm-slim
most_mb=150
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

slim_base() {
  local paths=(--dpkgopt='path-exclude=/usr/share/doc/*' --dpkgopt='path-include=/usr/share/doc/*/copyright'
               --dpkgopt='path-exclude=/usr/share/man/*' --dpkgopt='path-exclude=/usr/share/locale/*')
  mmdebstrap --variant=apt --include=usr-is-merged --hook-dir=/usr/share/mmdebstrap/hooks/merged-usr "${paths[@]}" \
    bookworm "$1" </dev/null >"$work/base.log" 2>&1
}

fits() {
  [ "$1" -le $((most_mb * 1000000)) ] || { echo "the image has $(($1 / 1000000)) MB; expected at most $most_mb" >&2; exit 1; }
  echo "tried: an image of $(($1 / 1000000)) MB"
}

with_podman() {
  local runtime network=(--network none --read-only --tmpfs /tmp)
  if ! podman pull -q "$base" >/dev/null 2>&1; then
    base=localhost/dynasurf-test-base
    podman image exists $base || { slim_base "$work/base.tar" && podman import -q "$work/base.tar" $base >/dev/null; } || return 77
  fi
  # The network of the machine serves apt alone; the program gets none.
  podman build -q --isolation chroot --network host --build-arg BASE=$base -t $image "$context" >/dev/null || exit 1
  fits "$(podman image inspect -f '{{.Size}}' $image)"
  # Limits that a machine may not raise are lowered; crun wants other control groups than some have.
  for runtime in crun runc; do
    run=(podman --runtime "$runtime" run --rm --ulimit nofile=1024:1024 --ulimit nproc=1024:1024 "${network[@]}")
    [ "$("${run[@]}" --entrypoint id $image -un 2>/dev/null)" = nobody ] || continue
    [ "$("${run[@]}" $image --version)" = "$("${run[@]}" --entrypoint /usr/bin/dynasurf $image --version)" ] || exit 1
    "${run[@]}" -v "$here:/first:ro" --entrypoint bash $image /first/first_use.sh /usr/bin/dynasurf || exit 1
    echo "tried: all of it by podman and $runtime, as nobody and without a network"
    return
  done
  echo "podman can run no container here" >&2
  return 77
}

# The recipe's own RUN lines and files, in chroots.
with_chroot() {
  local root=$work/packages image=$work/image
  slim_base "$root" || return 77
  cp -a "$root" "$image"
  mkdir "$root/packages" "$image/first"
  cp "$context"/build/package/dynasurf_*.deb "$root/packages"
  cp /etc/resolv.conf "$root/etc"
  sed -n '/^RUN/,/[^\\]$/{/^#/!p}' "$context/Containerfile" | sed 's/^RUN \(--mount[^ ]* \\\)\?//' >"$root/recipe.sh"
  chroot "$root" /usr/bin/env PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive sh -e /recipe.sh >"$work/recipe.log" 2>&1 || { tail "$work/recipe.log" >&2; exit 1; }
  cp -a "$root/image/." "$image"
  fits "$(du -sb "$image" | cut -f1)"
  cp "$here/first_use.sh" "$image/first"
  unshare -n chroot --userspec=nobody:nogroup "$image" /usr/bin/env PATH=/usr/bin:/bin bash /first/first_use.sh /usr/bin/dynasurf
  echo "tried: all of it in a chroot, as nobody and without a network"
}

code=77
if command -v podman >/dev/null && podman info >/dev/null 2>&1; then
  code=0
  with_podman || code=$?
fi
if [ $code -ne 77 ]; then exit $code; fi
with_chroot
