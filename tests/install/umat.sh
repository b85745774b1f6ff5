#!/usr/bin/env bash
# umat.sh SOURCE PREFIX WORK: the commands of docs/umat_out.md with the installed UMAT, against what the page
# says that they print.
set -euo pipefail
source=$1 prefix=$2 work=$3
command -v gfortran > /dev/null || { echo "no gfortran (scripts/packages check)"; exit 77; }
rm -rf "$work" && mkdir -p "$work"
cd "$work"
ln -s "$source/tests" tests
# the fence of the commands, and the one behind it
awk '/^```sh$/ { to = "commands"; next }
     /^```$/ && to == "" && seen { to = "expected"; next }
     /^```/ { if (to == "commands") seen = 1; else if (to == "expected") exit; to = ""; next }
     to != "" { print > to }' "$source/docs/umat_out.md"
[[ -s commands && -s expected ]] || { echo "the page has no commands or no output" >&2; exit 1; }
export prefix
bash -euo pipefail commands > found
diff expected found
# It stands alone: nothing but the C library is asked for.
alien=$(readelf -d "$prefix"/lib*/librepose_umat.so | sed -n 's/.*NEEDED.*\[\(.*\)\]/\1/p' |
  grep -vE '^(libc|libm|ld-linux-x86-64)\.so' || true)
[[ -z $alien ]] || { echo "librepose_umat.so needs $alien" >&2; exit 1; }
shown=$(nm -D --defined-only "$prefix"/lib*/librepose_umat.so | awk '{ print $3 }')
[[ $shown == umat_ ]] || { echo "librepose_umat.so shows $shown" >&2; exit 1; }
