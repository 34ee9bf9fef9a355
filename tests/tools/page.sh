#!/bin/sh
# The pages that kerf-view makes, tried in headless Chromium.
#   tests/tools/page.sh TOOLS_DIR SAMPLES_DIR
set -eu
here=$(dirname "$(realpath "$0")")
PATH=$1:$2:$PATH
export PYTHONDONTWRITEBYTECODE=1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
kerf-model pumpkin --frequency 8 -o p.ply
kerf-model front --around p.ply --steps 8 -o '<script>.front'  # a name that a careless page would run
kerf-sample p.ply -n 400 -o nodes.pcd
kerf-graph nodes.pcd --surface p.ply -o p.kerf
kerf-crack p.ply --front '<script>.front' --steps 0:5 -o half.ply
kerf-update p.kerf --surface half.ply -o half.kerf
kerf-view half.kerf '<script>.front' --before p.kerf -o body.html
kerf-view nodes.pcd -o nodes.html
kerf-crack p.ply --front '<script>.front' -o whole.ply
kerf-view whole.ply -o pieces.html
kerf-model block --edge 0.2 -o cube.ply
cat >s.toml <<'T'
[body]
mesh = "cube.ply"
spacing = 0.25
[time]
frames = 4
frame_rate = 20
step = 0.05
[[blade]]
points = [[0,-0.4,0],[0,1.4,0]]
divide = 4
keys = [[0.0,1.013,0.007,1.3,0,0,1,2],[0.2,1.013,0.011,-0.7,0,0,1,3]]
T
kerf-sim -q s.toml -o run
kerf-view run -o run.html
kerf-model sphere --frequency 160 -o big.ply
kerf-view big.ply --megabytes 1.4 -o coarse.html 2>said.txt
grep -q decimated said.txt || { echo "FAILED: no notice of decimation"; exit 1; }
[ "$(stat -c %s coarse.html)" -le 1400000 ] || { echo "FAILED: coarse.html is too large"; exit 1; }
kerf-view half.kerf '<script>.front' --before p.kerf -j1 -o again.html
cmp body.html again.html || { echo "FAILED: threads change the page"; exit 1; }
exec python3 "$here/check_page.py" "$work"
