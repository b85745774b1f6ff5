#!/usr/bin/env bash
# open_frames.sh SOURCE REPOSE WORK: runs a scene of every kind for a moment and opens its frames with
# pvbatch; then the picture of scripts/paraview_view.py, on a display in memory.
set -euo pipefail
source=$1 repose=$2 work=$3
for program in pvbatch xvfb-run; do
  command -v "$program" > /dev/null || { echo "no $program: scripts/packages nightly"; exit 77; }
done
rm -rf "$work"
mkdir -p "$work"
run() {
  local name=$1 scene=$2
  shift 2
  "$repose" run "$source/data/scenes/$scene.toml" -o "$work/$name" --quiet \
    --set scene.end_time=0.1 --set output.frame_interval=0.05 --set output.series_interval=0.05 \
    --set output.grid_frames=true "$@"
}
run clay flat_mcc --set grid.h=0.0125
run grains flat_mu_i --set grid.h=0.0125 --set output.shear_strain=true
run both flat_critical_state --set grid.h=0.0125
run water tilted_newtonian --set grid.h=0.0125
run space axisymmetric_mu_i --set grid.h=0.0125 --set domain.size='[0.3, 0.125, 0.3]'
# a reader that runs over its own arrays may hang in the handler of its abort, which ends only so
timeout -s KILL 200 pvbatch "$source/tests/paraview/open_frames.py" "$work"/{clay,grains,both,water,space}

for name in grains space; do
  xvfb-run -a pvbatch "$source/scripts/paraview_view.py" "$work/$name" -c pressure_Pa -o "$work/$name.png"
  # a picture of 1400 × 700 points with more on it than a background
  [[ $(head -c 4 "$work/$name.png" | tail -c 3) = PNG ]]
  (($(stat -c %s "$work/$name.png") > 20000))
done
if pvbatch "$source/scripts/paraview_view.py" "$work/grains" -c pressure > "$work/typo" 2>&1; then
  echo "a field that is not there was taken"
  exit 1
fi
grep -q "have no field pressure; there are .*pressure_Pa" "$work/typo"
