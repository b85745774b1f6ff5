#!/usr/bin/env bash
# package.sh SOURCE WORK: makes the Debian package, installs it in an empty Debian that debootstrap lays out,
# and there prints the version, drives a shipped test and builds a law of one's own against it. Packages come
# from wherever this machine's apt has them from. Exits with 77 (skipped) where no root can be laid out.
set -euo pipefail
source=$1 work=$2
root=$work/root
skip() { echo "skipped: $*" >&2; exit 77; }
((EUID == 0)) || skip "chroot needs root"
for tool in debootstrap chroot dpkg-shlibdeps; do
  command -v $tool > /dev/null || skip "no $tool: scripts/packages nightly"
done
# shellcheck disable=SC1091
release=$(. /etc/os-release && echo "$VERSION_CODENAME")
mirror=$(apt-get indextargets --format '$(RELEASE) $(REPO_URI)' "Created-By: Packages" |
  awk -v release="$release" '$1 == release { print $2; exit }')
[[ -n $mirror ]] || skip "apt has no source of $release"

started=$SECONDS
took() { echo "[ measured ] $1: $((SECONDS - started)) s"; started=$SECONDS; }

# what the package holds beside what it always does, and what it can run by
more_sets= more_files=() sets=(neon)
if [[ $(uname -m) = x86_64 ]]; then
  more_sets=x86-64-v4 sets=(avx2 avx512)
  more_files=(./usr/lib/repose/x86-64-v4/repose ./usr/lib/glibc-hwcaps/x86-64-v4/librepose_mpm.so)
fi
"$CMAKE" -S "$source" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DREPOSE_NATIVE=OFF \
  -DREPOSE_MORE_SETS=$more_sets -DREPOSE_TESTS=OFF > "$work.configure.log"
"$CMAKE" --build "$work/build" > "$work.build.log" || { tail -30 "$work.build.log" >&2; exit 1; }
took "building without the tests"
rm -f "$work"/build/*.deb
(cd "$work/build" && "$(dirname "$CMAKE")/cpack" -G DEB > "$work.cpack.log") ||
  { tail -30 "$work.cpack.log" >&2; exit 1; }
deb=$(ls "$work"/build/*.deb)
took "packing"
dpkg-deb -f "$deb" Package Version Depends
dpkg-deb -c "$deb" | awk '{ print $6 }' > "$work.contents.txt"
for file in "${more_files[@]}" ./usr/bin/repose ./usr/lib/librepose_mpm.so ./usr/include/repose/models/law.hpp \
  ./usr/lib/cmake/repose/reposeConfig.cmake ./usr/share/doc/repose/copyright; do
  grep -qx -- "$file" "$work.contents.txt" || { echo "the package lacks $file" >&2; exit 1; }
done

rm -rf "$root"
debootstrap --variant=minbase "$release" "$root" "$mirror" > "$work.debootstrap.log" 2>&1 || {
  tail -5 "$work.debootstrap.log" >&2
  skip "debootstrap cannot lay out a root here"
}
took "an empty Debian"
cp "$deb" "$root/repose.deb"
in_root() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive "$@"; }
in_root apt-get install -y -qq --no-install-recommends /repose.deb g++ cmake make \
  libeigen3-dev libxsimd-dev libceres-dev > "$work.install.log" 2>&1 ||
  { tail -20 "$work.install.log" >&2; exit 1; }
took "installing the package and a compiler"

in_root repose --version
in_root repose point /usr/share/repose/experiments/weald_clay_undrained.toml -o /tmp/weald_clay
[[ -s $root/tmp/weald_clay/curve.csv ]]
took "a shipped test"
# the same collapse by every instruction set that this machine has
for set in "${sets[@]}"; do
  grep -qw avx512vl /proc/cpuinfo || [[ $set != avx512 ]] || continue
  in_root repose --instruction-set $set run flat_mu_i --set scene.end_time=0.1 --no-plot --quiet -o /tmp/$set
  grep -q "\"instruction_set\": \"$set\"" "$root/tmp/$set/summary.json"
  took "a collapse by $set"
done
# Between sets: 600 steps of round-off 2e-16 add up to 1e-13, and a thousand times that for what grows.
if [[ -s $root/tmp/avx512/summary.json ]]; then
  for key in front_99_m height_m kinetic_J_per_m; do
    figures=()
    for set in avx2 avx512; do
      figures+=("$(sed -nE "s/^ *\"$key\": ([-+.e0-9]+),?/\1/p" "$root/tmp/$set/summary.json")")
    done
    awk -v a="${figures[0]}" -v b="${figures[1]}" -v key=$key 'BEGIN {
      d = (a - b) / b; if (d < 0) d = -d
      printf "[ measured ] %s by avx2 and avx512: %.1e apart\n", key, d
      exit !(b > 0 && d <= 1e-10) }'
  done
fi

mkdir "$root/own"
cp "$source/examples/own_law.cpp" "$root/own/"
cat > "$root/own/CMakeLists.txt" << 'END'
cmake_minimum_required(VERSION 3.25)
project(own LANGUAGES CXX)
find_package(repose REQUIRED COMPONENTS law_kit)
add_executable(own_law own_law.cpp)
target_link_libraries(own_law PRIVATE repose::law_kit repose::mpm)
END
in_root cmake -S /own -B /own/build -DCMAKE_BUILD_TYPE=Release > "$work.own.log"
in_root cmake --build /own/build >> "$work.own.log" 2>&1 || { tail -30 "$work.own.log" >&2; exit 1; }
took "building a law of one's own, $(wc -l < "$source/examples/own_law.cpp") lines"
in_root /own/build/own_law
took "driving it"
rm -rf "$root"
