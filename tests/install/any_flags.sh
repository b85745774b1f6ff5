#!/usr/bin/env bash
# any_flags.sh SOURCE PREFIX WORK: programs that differ in how they are compiled get the same numbers from
# the same libraries, to the last bit, and see the same memory in every public type.
set -euo pipefail
source=$1 prefix=$2 work=$3
rm -rf "$work" && mkdir -p "$work"
lib=$(dirname "$(ls "$prefix"/lib*/librepose_models.so)")
link=(-L"$lib" -Wl,-rpath,"$lib" -lrepose_calibration -lrepose_mpm -lrepose_pointdriver -lrepose_io
  -lrepose_models)
compile() { "$CXX" -std=c++20 -I "$prefix/include" "$@"; }

sets=("-O0 -march=x86-64" "-O2 -march=x86-64-v3" "-O3 -march=native")
[[ $(uname -m) != aarch64 ]] || sets=("-O0 -march=armv8-a" "-O2 -march=armv8.1-a" "-O3 -march=native")
for k in "${!sets[@]}"; do
  read -r -a flags <<< "${sets[k]}"
  compile "${flags[@]}" -DNUMBERS=numbers_$k -c "$source/tests/install/consumer.cpp" -o "$work/$k.o"
  compile "${flags[@]}" -DNUMBERS=numbers_$k -DMAIN "$source/tests/install/consumer.cpp" \
    -o "$work/consumer_$k" "${link[@]}"
  "$work/consumer_$k" > "$work/$k.txt"
done
# All three in one program, where each finds the others' copies of the inline functions.
cat > "$work/all.cpp" <<'END'
void numbers_0();
void numbers_1();
void numbers_2();
int main(int argc, char**) {
  if (argc == 1) numbers_0();
  if (argc == 2) numbers_1();
  if (argc == 3) numbers_2();
}
END
compile "$work/all.cpp" "$work/0.o" "$work/1.o" "$work/2.o" -o "$work/all" "${link[@]}"
"$work/all" > "$work/all_0.txt"
"$work/all" x > "$work/all_1.txt"
"$work/all" x x > "$work/all_2.txt"

lines=$(wc -l < "$work/0.txt")
((lines > 100)) || { echo "only $lines lines of numbers" >&2; exit 1; }
status=0
for other in 1 2 all_0 all_1 all_2; do
  if ! diff "$work/0.txt" "$work/$other.txt" > "$work/diff.txt"; then
    echo "0.txt and $other.txt differ:" >&2
    head -10 "$work/diff.txt" >&2
    status=1
  fi
done
echo "$lines numbers, six times the same"
exit $status
