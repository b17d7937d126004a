#!/usr/bin/env bash
# A first look at an installed program: first_use.sh PROGRAM. Prints a line `tried: ...` for each thing that worked.
set -euo pipefail
program=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$program" --version | sed -n 's/^dynasurf /tried: dynasurf --version: /p'
"$program" phantom patient --seed 1 --set gates=4 --set lattice.nx=40 --set lattice.ny=40 --set lattice.dx_mm=4 \
  --set lattice.dy_mm=4 --out "$work/patient" --quiet
echo "tried: dynasurf phantom patient"
# 3: computed, but not to be trusted; so small a study may end so.
"$program" ventricle "$work/patient/study.dcm" --out "$work/result" --quiet || [ $? = 3 ]
for file in report.html results.json manifest.txt; do [ -s "$work/result/$file" ]; done
echo "tried: dynasurf ventricle: $(find "$work/result" -type f | wc -l) files"
if [ -f "$(dirname "$program")/../share/dynasurf/dynasurf.html" ]; then
  "$program" view "$work/patient/study.dcm" --out "$work/study.html" >"$work/view"
  [ -s "$work/study.html" ]
  echo "tried: dynasurf view"
fi
