#!/bin/sh
# Installs the build in $1 to a folder aside, builds the project in $2 against it with find_package(kerf), runs its programs.
# Then those of samples/c, against libkerf.so.
set -eu
build=$1 source=$2 generator=$3
stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT
cmake --install "$build" --prefix "$stage/prefix" >"$stage/log" 2>&1 || { cat "$stage/log"; exit 1; }
cmake -S "$source" -B "$stage/build" -G "$generator" -DCMAKE_PREFIX_PATH="$stage/prefix" "-DCMAKE_CXX_FLAGS=${4:-}" >"$stage/log" 2>&1 ||
  { cat "$stage/log"; exit 1; }
cmake --build "$stage/build" >"$stage/log" 2>&1 || { cat "$stage/log"; exit 1; }
cd "$stage"
for example in build/example-*; do
  test -f "$example" && echo "== $example" && "$example"
done
[ -f "$stage/prefix/include/kerf.h" ] || exit 0
root=$(cd "$(dirname "$0")/.." && pwd)
flags=$(PKG_CONFIG_PATH="$stage/prefix/lib/pkgconfig" pkg-config --cflags --libs kerf)
for example in break simulate; do
  # shellcheck disable=SC2086
  cc -std=c99 -Wall -Wextra -pedantic -Werror "$root/samples/c/$example.c" -o "$stage/$example" $flags -Wl,-rpath,"$stage/prefix/lib" ${4:-}
  echo "== $example.c" && "$stage/$example"
done
