#!/usr/bin/env bash
# own_functions.sh PREFIX: no function that a library defines is looked up at run time, where the copy that
# a program has compiled from the same header, for another instruction set, would be found first.
set -euo pipefail
prefix=$1
status=0 count=0
for library in "$prefix"/lib*/librepose_*.so; do
  count=$((count + 1))
  # T, W, i: functions; V, u, B, D, R: data, which has one place in a program
  found=$(comm -12 \
    <(nm -D --defined-only "$library" | awk '$2 ~ /^[TWi]$/ { print $3 }' | sort -u) \
    <(readelf -rW "$library" | awk '$3 ~ /^R_/ && NF >= 5 { sub(/@.*/, "", $5); print $5 }' | sort -u))
  if [[ -n $found ]]; then
    echo "$library looks up its own functions:" >&2
    c++filt <<< "$found" | head -20 >&2
    status=1
  fi
done
((count == 6)) || { echo "$count libraries in $prefix, not 6" >&2; exit 1; }
exit $status
