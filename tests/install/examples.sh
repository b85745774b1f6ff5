#!/usr/bin/env bash
# examples.sh SOURCE PREFIX WORK: builds examples/ against the prefix and checks the figures they print.
set -euo pipefail
source=$1 prefix=$2 work=$3
for name in drive fit collapse; do
  lines=$(wc -l < "$source/examples/$name.cpp")
  ((lines <= 60)) || { echo "examples/$name.cpp has $lines lines; 60 are allowed" >&2; exit 1; }
done
rm -rf "$work"
"$CMAKE" -S "$source/examples" -B "$work" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" \
  -DCMAKE_CXX_FLAGS="-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror" > "$work.log"
"$CMAKE" --build "$work" >> "$work.log" || { tail -50 "$work.log" >&2; exit 1; }

# close NAME GOT EXPECTED RELATIVE
close() {
  awk -v name="$1" -v got="$2" -v want="$3" -v most="$4" 'BEGIN {
    off = got / want - 1; if (off < 0) off = -off
    printf "%s: %s, expected %s within %s\n", name, got, want, most
    exit !(got != "" && off <= most) }'
}

drive=$("$work/drive")
echo "$drive"
# The critical state of the volume: p0 2^(kappa/lambda - 1), q = M p'; a path of 20 % is within 1 % of it
# (Cam-Clay comes near as exp(-const strain); the example itself asks for no more).
close "q at the end, kPa" "$(awk '/^ *0\.200/ { print $2 }' <<< "$drive")" \
  "$(awk 'BEGIN { print 0.95 * 207 * 2 ^ (0.035 / 0.093 - 1) }')" 0.01

fit=$("$work/fit")
echo "$fit"
# Noise of 1 kPa in 20 rows of a q of some 200 kPa: 1/(200 sqrt 20) = 0.1 % of M; lambda is known from the
# bend of the curve alone, some ten times worse. Four standard errors, which the example itself checks.
close "M" "$(awk '$1 == "M" { print $3 }' <<< "$fit")" 0.95 0.02
close "lambda" "$(awk '$1 == "lambda" { print $3 }' <<< "$fit")" 0.093 0.2

collapse=$("$work/collapse")
echo "$collapse"
# mass = rho_0 times the area of the column, which fills whole cells: 1300 x 0.2 x 0.4
close "mass, kg/m" "$(awk '/ points, / { print $3 }' <<< "$collapse")" 104.0 1e-3
# The fine run of this scene (README.md) stops at 0.96 m after 1.2 s; at half the time and twice the cell
# the front is on its way: between the column's edge and there.
awk '$1 == "0.60" && $2 > 0.5 && $2 < 0.96 { found = 1 } END { exit !found }' <<< "$collapse"

if [[ -x $work/own_law ]]; then
  own=$("$work/own_law")
  echo "$own"
  close "tau at 100/s, Pa" "$(awk '/^tau/ { last = $3 } END { print last }' <<< "$own")" 30.0 1e-5
else
  echo "own_law was not built: no Eigen, xsimd or ceres/jet.h" >&2
  exit 1
fi
