#!/usr/bin/env bash
# install.sh BUILD PREFIX: builds what is installed, and nothing else, and installs it.
set -euo pipefail
build=$1 prefix=$2
"$CMAKE" --build "$build" --target repose repose_models_shared repose_io_shared repose_point_shared \
  repose_mpm_shared repose_calibration_shared repose_umat
rm -rf "$prefix"
"$CMAKE" --install "$build" --prefix "$prefix" > /dev/null
for file in bin/repose include/repose/version.hpp include/repose/models/law.hpp; do
  [[ -f $prefix/$file ]] || { echo "no $file was installed" >&2; exit 1; }
done
"$prefix/bin/repose" --version
# An include that still begins at the root of the source would find nothing, or another project's file.
if grep -rnE '#include "(app|calibration|input|io|models|mpm|pointdriver|report|study|umat)/' "$prefix/include"; then
  echo "these includes were not rewritten" >&2
  exit 1
fi
# Private flags stay private: a consumer gets include folders, C++20 and the libraries.
if grep -rnE 'march|-W[a-z]|-f[a-z]|COMPILE_OPTIONS|COMPILE_DEFINITIONS' "$prefix"/lib*/cmake/repose/reposeTargets*.cmake; then
  echo "these flags reach whoever links the libraries" >&2
  exit 1
fi
