#!/usr/bin/env bash
# samples.sh SOURCE PREFIX WORK: compiles every C++ sample, fenced by ```cpp in a page or in a comment of a
# header, against the installed headers. A sample is the body of a function, or a whole file where it
# includes something and has a main() or a struct of its own; its #include lines go to the top.
set -euo pipefail
source=$1 prefix=$2 work=$3
rm -rf "$work" && mkdir -p "$work"
cd "$source"
mapfile -t pages < <(ls README.md CONTRIBUTING.md docs/*.md)
mapfile -t headers < <(find app calibration input io models mpm pointdriver report study umat -name '*.hpp' | sort)

# What looks like a statement in an indented comment, and is in no fence, would be compiled by nobody.
stray=$(awk '
  FNR == 1 { fenced = 0 }
  /^ *\/\/\/ *```/ { fenced = !fenced; next }
  fenced || !/^ *\/\/\/  +/ { next }
  /#include/ || (/;( *\/\/.*)?$/ && /::|auto |std::|[a-z]\(.*\);/) { print FILENAME ":" FNR ": " $0 }
' "${headers[@]}")
if [[ -n $stray ]]; then
  echo "code samples without a fence (\`\`\`cpp):" >&2
  echo "$stray" >&2
  exit 1
fi

awk -v work="$work" '
  function close_sample() {
    print includes "using namespace repose;" > file
    if (whole) print body > file
    else print "[[maybe_unused]] static void sample() {\n" body "}" > file
    close(file)
  }
  FNR == 1 { if (open) { print "no end of a fence in " last > "/dev/stderr"; exit 1 } }
  { last = FILENAME; line = $0; sub(/^ *\/\/\/ ?/, "", line) }
  !open && line ~ /^ *```cpp *$/ {
    open = 1; whole = 0; body = includes = ""
    file = FILENAME; gsub(/[\/.]/, "_", file); file = work "/" file "_" FNR ".cpp"
    if (FILENAME ~ /\.hpp$/) includes = "#include <repose/" FILENAME ">\n"
    includes = includes "#include <cstdio>\n"
    body = "#line " (FNR + 1) " \"" FILENAME "\"\n"
    next
  }
  open && line ~ /^ *```/ { open = 0; close_sample(); next }
  open && line ~ /^ *#include/ { includes = includes line "\n"; body = body "\n"; next }
  open { if (line ~ /^(struct|int main|template)/) whole = 1; body = body line "\n" }
  END { if (open) exit 1 }' "${pages[@]}" "${headers[@]}"

eigen=$(find /usr/include/eigen3 /usr/local/include/eigen3 -maxdepth 0 2> /dev/null | head -1 || true)
count=0 status=0
for sample in "$work"/*.cpp; do
  count=$((count + 1))
  "$CXX" -std=c++20 -fsyntax-only -Wall -Wextra -Werror -Wno-unused-variable \
    -I "$prefix/include" ${eigen:+-isystem "$eigen"} "$sample" || status=1
done
((count >= 4)) || { echo "only $count samples were found" >&2; exit 1; }
echo "$count samples"
exit $status
