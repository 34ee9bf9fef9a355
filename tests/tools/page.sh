#!/bin/sh
# The pages that kerf-view makes, tried in headless Chromium.
#   tests/tools/page.sh TOOLS_DIR SAMPLES_DIR [pumpkin]     pumpkin: the page of a large run instead, which takes long
set -eu
here=$(dirname "$(realpath "$0")")
PATH=$(realpath "$1"):$(realpath "$2"):$PATH
export PYTHONDONTWRITEBYTECODE=1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
if [ "${3-}" = pumpkin ]; then  # 10 580 triangles, 8 000 nodes, 100 frames after the first
  kerf-model pumpkin --frequency 23 -o pumpkin.ply
  kerf-sim "$here/../../samples/scenes/halve.toml" --set body.mesh=pumpkin.ply --set body.nodes=8000 --set contact.self=false --set time.frame_rate=50 --set time.frames=100 -o run
  kerf-view run -o pumpkin.html 2>said.txt
  [ -s said.txt ] && { echo "FAILED: $(cat said.txt)"; exit 1; }
  [ "$(stat -c %s pumpkin.html)" -lt 20000000 ] || { echo "FAILED: the page has $(stat -c %s pumpkin.html) bytes"; exit 1; }
  exec python3 "$here/check_page.py" "$work"
fi
kerf-model pumpkin --frequency 8 -o p.ply
kerf-model front --around p.ply --steps 8 -o '<script>.front'  # a name that a careless page would run
kerf-sample p.ply -n 400 -o nodes.pcd
kerf-graph nodes.pcd --surface p.ply -o p.kerf
kerf-crack p.ply --front '<script>.front' --steps 0:5 -o half.ply
kerf-update p.kerf --surface half.ply -o half.kerf
kerf-view half.kerf '<script>.front' --before p.kerf -o body.html
kerf-view nodes.pcd --up y -o nodes.html
kerf-crack p.ply --front '<script>.front' -o whole.ply
kerf-view whole.ply -o pieces.html
kerf-model block --edge 0.1 -o cube.ply
kerf-model sphere --frequency 11 -o ball.ply
cat >s.toml <<'T'
[body]
mesh = "cube.ply"
spacing = 0.12
[time]
frames = 6
frame_rate = 20
step = 0.05
[[obstacle]]
mesh = "ball.ply"
scale = 0.3
keys = [[0.0, 0.3,0.5,1.4, 0,0,1,0],[0.3, 0.3,0.5,1.2, 0,0,1,0]]
[[blade]]
points = [[0,-0.4,0],[0,1.4,0]]
divide = 4
keys = [[0.0,1.013,0.007,1.3,0,0,1,2],[0.2,1.013,0.011,-0.7,0,0,1,3]]
T
kerf-sim -q s.toml -o run
kerf-view run -o run.html
python3 "$here/../assets/painted.py"
kerf-model front --around painted.glb -o painted.front
kerf-crack painted.glb --front painted.front -o painted.ply
kerf-view painted.ply -o painted.html
kerf-view painted.ply --color patch -o bare.html
grep -q 'data:image/png' painted.html || { echo "FAILED: painted.html has no image"; exit 1; }
grep -q 'data:image/png' bare.html && { echo "FAILED: --color patch leaves images in the page"; exit 1; }
kerf-model sphere --frequency 160 -o big.ply
kerf-view big.ply --megabytes 1.4 -o coarse.html 2>said.txt
grep -q decimated said.txt || { echo "FAILED: no notice of decimation"; exit 1; }
[ "$(stat -c %s coarse.html)" -le 1400000 ] || { echo "FAILED: coarse.html is too large"; exit 1; }
kerf-view run --megabytes 1 -o coarse-run.html 2>said.txt
grep -q decimated said.txt || { echo "FAILED: no notice of a run's decimation: $(cat said.txt)"; exit 1; }
kerf-view half.kerf '<script>.front' --before p.kerf -j1 -o again.html
cmp body.html again.html || { echo "FAILED: threads change the page"; exit 1; }
exec python3 "$here/check_page.py" "$work"
