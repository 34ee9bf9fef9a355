# Sourced by samples/run and tests/run: the packages, and the build.
packages="build-essential cmake ninja-build ccache pkg-config git ca-certificates
  libcgal-dev libgmp-dev libeigen3-dev libpcl-dev libopenvdb-dev libimath-dev libblosc-dev libtbb-dev libboost-dev libboost-iostreams-dev libboost-graph-dev
  libcli11-dev catch2 libembree-dev libjpeg-dev libpng-dev zlib1g-dev libwebp-dev libjs-three libtomlplusplus-dev nlohmann-json3-dev libxxhash-dev libhdf5-dev libassimp-dev
  libhwy-dev libnanoflann-dev libbullet-dev libcgal-demo python3 lowdown doxygen"
test_packages="universal-ctags clang-format chromium snakemake ffmpeg python3-numpy python3-vtk9 assimp-utils zsh blender xvfb xauth
  python3-dev pybind11-dev mypy python3-pip python3-venv python3-scipy python3-tqdm python3-matplotlib python3-sphinx
  python3-open3d python3-torch python3-meshio emscripten godot3-server node-typescript esbuild"
# Readers of assets come from npm. An installation of npm that is not Debian's serves, too.
command -v npm >/dev/null || test_packages="$test_packages nodejs npm"

say() { printf '%s\n' "== $*"; }

# Installs with apt what dpkg does not have, more packages as arguments; needs no network when nothing is missing.
install_packages() {
  missing=
  for package in $packages "$@"; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing="$missing $package"
  done
  if [ -z "$missing" ]; then
    say "packages: all there"
    return
  fi
  say "packages: installing$missing"
  sudo=
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || { echo "not root and no sudo: run apt-get install$missing yourself" >&2; exit 1; }
    sudo=sudo
  fi
  export DEBIAN_FRONTEND=noninteractive
  $sudo apt-get update -qq
  # libcgal-demo's data are under /usr/share/doc, which minimal systems leave out: ask dpkg to keep them.
  $sudo apt-get install -y -qq --no-install-recommends -o DPkg::Options::=--path-include='/usr/share/doc/libcgal-demo/*' $missing \
    >/tmp/kerf-apt.$$ 2>&1 || { cat /tmp/kerf-apt.$$ >&2; rm -f /tmp/kerf-apt.$$; exit 1; }
  rm -f /tmp/kerf-apt.$$
}

# configure_and_build PRESET-ARGUMENTS...: into $build.
configure_and_build() {
  say "configure: $build"
  cmake -S "$root" -B "$build" -G Ninja "$@" >"$build.log" 2>&1 || { cat "$build.log"; exit 1; }
  say "build: $build ($(nproc) jobs)"
  start=$(date +%s)
  cmake --build "$build" >"$build.log" 2>&1 || { grep -E 'error|FAILED|warning' "$build.log" | head -50; tail -n 30 "$build.log"; exit 1; }
  if grep -q 'warning:' "$build.log"; then grep -A3 'warning:' "$build.log" | head -40; fi
  rm -f "$build.log"
  say "build: done in $(($(date +%s) - start)) s"
}
