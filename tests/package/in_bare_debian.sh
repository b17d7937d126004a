#!/usr/bin/env bash
# Runs in a bare Debian 12, beside the packages and two folders of sources: installs the packages with what they depend
# on and nothing else, runs the program, and builds against the libraries.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
export DEBIAN_FRONTEND=noninteractive
install() { apt-get install -y --no-install-recommends "$@" >/dev/null; }

install ./dynasurf_*.deb
echo "tried: installation of $(dpkg-query -W -f='${Package} ${Version}' dynasurf)"
bash first_use.sh /usr/bin/dynasurf
for page in dynasurf dynasurf-ventricle; do [ -s /usr/share/man/man1/$page.1.gz ]; done
bash -c '. /usr/share/bash-completion/completions/dynasurf && complete -p dynasurf' >/dev/null
echo "tried: manual pages and completion"

install ./libdynasurf-dev_*.deb
install g++ cmake make pkg-config
cmake -S installed -B build -DEXAMPLES="$PWD/examples" >/dev/null
cmake --build build --target flow study >/dev/null
vectors=$(build/flow)
echo "tried: programs by find_package(dynasurf)"
c++ -O1 installed/flow.cpp $(pkg-config --cflags --libs dynasurf) -o flow
[ "$(./flow)" = "$vectors" ]
echo "tried: a program by pkg-config"
dynasurf phantom patient --set gates=4 --set lattice.nx=40 --set lattice.ny=40 --set lattice.dx_mm=4 \
  --set lattice.dy_mm=4 --out patient --quiet
build/study patient/study.dcm result
[ -s result/report.html ]
echo "tried: examples/study.cpp with the installed libraries"

install ./python3-dynasurf_*.deb
python3 - <<'TEXT'
import dynasurf
heart = dynasurf.ventricle.reconstruct(dynasurf.read_study("patient/study.dcm"), fwhm_mm=12)
heart.save("from_python")
assert dynasurf.load("from_python").ef.value == heart.ef.value
TEXT
[ -s from_python/report.html ]
echo "tried: import dynasurf"

# Nothing stays behind.
apt-get purge -y dynasurf libdynasurf-dev python3-dynasurf >/dev/null
left=$(find /usr /etc -name '*dynasurf*' -not -path '/usr/share/doc/*')
[ -z "$left" ] || { echo "left behind: $left"; exit 1; }
echo "tried: removal"
