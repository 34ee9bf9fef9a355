#!/bin/bash
# The tools, run as a user runs them: the pipeline on real models, and every refusal of the contract.
#   tests/tools/run.sh TOOLS_DIR SAMPLES_DIR MODELS_DIR pipeline MODEL | refusals | contract | kinds | attributes | details | files | stops | simulation | scores | chunks | repairs | readers | killed
set -u
script=$(realpath "$0")
PATH=$(realpath "$1"):$(realpath "$2"):$PATH models=$(realpath "$3") what=$4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failed=0
fail() { echo "FAILED: $*"; failed=1; }

# expect CODE PATTERN COMMAND...: the exit code, one line on standard error with the pattern, nothing left behind.
expect() {
  local code=$1 pattern=$2 before after status
  shift 2
  before=$(ls -A)
  "$@" >/tmp/kerf-out.$$ 2>/tmp/kerf-err.$$ </dev/null
  status=$?
  after=$(ls -A)
  [ "$status" = "$code" ] || fail "$* exits with $status, not $code: $(cat /tmp/kerf-err.$$)"
  [ "$(wc -l </tmp/kerf-err.$$)" = 1 ] || fail "$* says $(wc -l </tmp/kerf-err.$$) lines: $(cat /tmp/kerf-err.$$)"
  grep -q -e "$pattern" /tmp/kerf-err.$$ || fail "$* does not say '$pattern' but: $(cat /tmp/kerf-err.$$)"
  [ "$before" = "$after" ] || fail "$* leaves something behind: $after"
  rm -f /tmp/kerf-out.$$ /tmp/kerf-err.$$
}
# quietly COMMAND...: exit code 0 and nothing on standard error.
quietly() {
  "$@" 2>err.txt || fail "$* exits with $?: $(cat err.txt)"
  [ -s err.txt ] && fail "$* says: $(cat err.txt)"
  rm -f err.txt
}

case $what in
pipeline)
  model=$5
  case $model in
  pumpkin.ply) kerf-model pumpkin --frequency 11 -o pumpkin.ply || fail "kerf-model pumpkin" ;;
  *) cp "$models/$model" . ;;
  esac
  quietly kerf-model front --around "$model" --steps 12 -o halve.front
  kerf-sample "$model" --spacing 3% | kerf-graph --surface "$model" -o bear.kerf || fail "sample | graph"
  quietly kerf-crack "$model" --front halve.front -o cut.ply
  quietly kerf-update bear.kerf --surface cut.ply -o cut.kerf
  quietly kerf-pieces cut.ply -o pieces/
  kerf-sample "$model" --spacing 3% -o nodes.pcd || fail "sample to a file"
  for file in "$model" halve.front nodes.pcd bear.kerf cut.ply cut.kerf pieces/*.ply; do quietly kerf-info --check -q "$file"; done
  [ "$(ls pieces/*.ply | wc -l)" -ge 2 ] || fail "fewer than two pieces"
  # In two parts, the second taking up the first's output: the same pieces.
  quietly kerf-crack "$model" --front halve.front --steps 0:5 -o half.ply
  quietly kerf-crack half.ply --front halve.front --steps 5:12 -o resumed.ply
  one=$(kerf-info --json cut.ply | grep -o '"pieces":[0-9]*') two=$(kerf-info --json resumed.ply | grep -o '"pieces":[0-9]*')
  [ "$one" = "$two" ] || fail "in one go $one, in two $two"
  quietly kerf-info --check -q resumed.ply
  # The same bytes for any number of threads.
  kerf-sample -j1 "$model" --spacing 3% | kerf-graph -j1 --surface "$model" -o one.kerf
  cmp bear.kerf one.kerf || fail "threads change bytes"
  ;;
refusals)
  kerf-model block --edge 0.25 -o block.ply
  kerf-model front --around block.ply --steps 2 -o ok.front
  kerf-sample block.ply --spacing 12% | kerf-graph --surface block.ply -o ok.kerf
  touch empty
  head -c 700 block.ply >short.ply
  head -c 3000 ok.kerf >short.kerf
  printf 'OFF\n4 4 0\n0 0 0\n1 0 nan\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n' >nan.off
  printf 'OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n' >open.off
  printf 'OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 3 1\n3 1 3 2\n3 0 2 3\n' >inside.off
  printf 'OFF\n8 8 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n.1 .1 -.5\n1.1 .1 -.5\n.1 1.1 -.5\n.1 .1 .5\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n3 4 6 5\n3 4 5 7\n3 5 6 7\n3 4 7 6\n' >crossing.off
  printf 'front a\nstep 0\n0 0 0\nstep 1\n0 0 1\n' >point.front
  { head -c 12 ok.kerf; printf '\011\000\000\000'; tail -c +17 ok.kerf; } >newer.kerf
  for bad in "66 cannot missing.ply" "65 empty empty" "65 short.ply short.ply" "65 finite nan.off" "65 open open.off" "65 inside inside.off" "65 intersect crossing.off"; do
    set -- $bad
    expect "$1" "$2" kerf-sample "$3" --spacing 0.2 -o x.pcd
    expect "$1" "$2" kerf-crack "$3" --front ok.front -o x.ply
    expect "$1" "$2" kerf-graph /dev/null --surface "$3" -o x.kerf
    expect "$1" "$2" kerf-pieces "$3" -o x
    expect "$1" "$2" kerf-update ok.kerf --surface "$3" -o x.kerf
    printf '[body]\nmesh = "%s"\n' "$3" >scene.toml
    expect "$1" "$2" kerf-sim scene.toml -o x
    printf '[body]\nmesh = "ok.off"\n[[obstacle]]\nmesh = "%s"\n' "$3" >scene.toml
    expect "$1" "$2" kerf-sim scene.toml -o x
  done
  for bad in "66 cannot missing" "65 empty empty" "65 truncated short.kerf" "65 newer newer.kerf"; do
    set -- $bad
    expect "$1" "$2" kerf-update "$3" --surface block.ply -o x.kerf
    expect "$1" "$2" kerf-info "$3"
    expect "$1" "$2" kerf-view "$3" -o x.png
  done
  expect 65 "1 point" kerf-crack block.ply --front point.front -o x.ply
  expect 66 "cannot" kerf-crack block.ply --front missing.front -o x.ply
  # Files that are taken for others.
  expect 65 "ok.kerf: is a body (.kerf); give the surface" kerf-crack ok.kerf --front ok.front -o x.ply
  expect 65 "is a body (.kerf), which has its nodes already" kerf-graph ok.kerf --surface block.ply -o x.kerf
  expect 65 "a scene is a text file" kerf-sim open.off -o x
  kerf-crack block.ply --front ok.front -o cut.obj && expect 65 "is a cut surface as OBJ, .*give the PLY" kerf-pieces cut.obj -o x
  rm cut.obj
  expect 1 "inside out" kerf-info --check -q inside.off
  expect 1 "open" kerf-info --check -q open.off
  expect 1 "intersect" kerf-info --check -q crossing.off
  expect 65 "finite" kerf-info nan.off
  ;;
contract)
  kerf-model block --edge 0.25 -o block.ply
  kerf-model front --around block.ply --steps 2 -o ok.front
  kerf-sample block.ply --spacing 12% | kerf-graph --surface block.ply -o ok.kerf
  for tool in kerf-sample kerf-graph kerf-score kerf-crack kerf-update kerf-pieces kerf-info kerf-sim kerf-live kerf-view kerf-repair kerf-dataset; do
    $tool --help | grep -q Examples || fail "$tool --help has no examples"
    $tool --version | grep -q "$tool (kerf) [0-9]" || fail "$tool --version"
    expect 2 "no option --no-such-option; see $tool --help" $tool --no-such-option
    [ $tool = kerf-live ] || expect 2 "did you mean '--output'" $tool block.ply --ouput=x
  done
  expect 2 "spacing" kerf-sample block.ply --spacing banana -o x.pcd
  for options in "--spacing -1" "--spacing 0" "--spacing nan" "--spacing 3%%" "--spacing 0.1 -n 5" "--count -5" "--levels 0" "--levels 11" "--jitter 0.5" "--pattern red" "--min-across -1" "--min-across 101" "--iso 0" "--grid a" "--surface s.ply"; do
    expect 2 "${options%% *}" kerf-sample block.ply $options -o x.pcd
  done
  expect 65 "0.01 %" kerf-sample block.ply --spacing 1e-7 -o x.pcd
  kerf-model block --edge 0.5 -o level.vdb
  expect 65 "named 'none'" kerf-sample level.vdb --grid none --spacing 0.2 -o x.pcd
  expect 65 "level 5" kerf-sample level.vdb --iso 5 --spacing 0.2 -o x.pcd
  expect 2 "iso" kerf-sample level.vdb --iso high --spacing 0.2 -o x.pcd
  expect 73 "cannot" kerf-sample block.ply --spacing 12% -o none/x.pcd
  expect 73 "cannot" kerf-crack block.ply --front ok.front -o none/x.ply
  expect 73 "cannot be written" kerf-crack block.ply --front ok.front -o /dev/full
  # Where nothing can be written is found out before the work; what ends as another format's files do is not written.
  expect 73 "cannot be made (Not a directory)" timeout 10 kerf-view block.ply --size 4000x4000 -o block.ply/x.png
  expect 2 "writes .ply or .obj, not .stl" kerf-crack block.ply --front ok.front -o x.stl
  expect 2 "writes .png, .webp, .mp4 or .html, not .gif" kerf-view block.ply -o x.gif
  expect 2 "writes a folder, .glb or .usda, not .fbx" kerf-pieces block.ply -o x.fbx
  expect 2 "writes a folder, not .mp4" kerf-sim scene.toml -o x.mp4
  expect 2 "writes .pcd or .ply, not .xyz" kerf-sample block.ply -o x.xyz
  printf '#usda 1.0\n' >stage.usda
  expect 65 "stage.usda: is a USD file, which is not read here; save it as glTF" kerf-crack stage.usda --jagged 0.1 -o x.ply
  expect 2 "writes .kerf, not .ply" kerf-update ok.kerf --surface block.ply -o x.ply
  quietly kerf-crack block.ply --front ok.front -o cut.2 && quietly kerf-info -q cut.2 && rm cut.2
  # A front that misses the model is told of, with where both are; a sheet, too. What has been done, with -v.
  printf 'front far\nstep 0\n9 0 0\n9 1 0\nstep 1\n9.5 0 1\n9.5 1 1\nsheet off\nv 9 0 0\nv 9 1 0\nv 9 0 1\nf 1 2 3\n' >far.front
  kerf-crack block.ply --front far.front -o x.ply 2>said.txt || fail "a front that misses: $(cat said.txt)"
  grep -q "front 'far' meets no material; it is within (9, 0, 0) to (9.5, 1, 1), the model within (0, 0, 0) to (2, 1, 1)" said.txt || fail "of a front that misses: $(cat said.txt)"
  grep -q "sheet 'off' meets no material" said.txt || fail "of a sheet that misses: $(cat said.txt)"
  kerf-crack -v block.ply --front ok.front -o x.ply 2>&1 | grep -q '^kerf-crack: 2 pieces, 1 crack, [0-9]* triangles$' || fail "kerf-crack -v"
  kerf-update -v ok.kerf --surface x.ply -o x.kerf 2>&1 | grep -q '^kerf-update: [0-9]* triangles and [0-9]* edges cut, ' || fail "kerf-update -v"
  # The model may come last, behind an option that takes several values.
  quietly kerf-crack --front ok.front block.ply -o y.ply && cmp -s x.ply y.ply && rm y.ply || fail "kerf-crack with the model last"
  expect 2 "MESH is required" kerf-crack --front ok.front -o y.ply
  expect 2 "only one file can come from standard input" kerf-crack - --front - -o y.ply
  expect 2 "none of its models; did you mean 'sphere'" kerf-model sphre -o y.ply
  rm x.ply x.kerf said.txt
  for line in "kerf-sample block.ply --spacing 12%" "kerf-crack block.ply --front ok.front" "kerf-update ok.kerf --surface block.ply" "kerf-view block.ply --size 64x48"; do
    script -qec "$line" /dev/null </dev/null >tty.txt
    [ $? = 2 ] || fail "$line writes binary to a terminal"
    grep -q terminal tty.txt || fail "$line does not say why"
    rm -f tty.txt
  done
  script -qec "kerf-info -" /dev/null <<<"" >tty.txt && fail "a terminal is read"
  grep -q "is a terminal" tty.txt || fail "kerf-info - waits at a terminal: $(cat tty.txt)"
  rm tty.txt
  # A reader that has enough is no error to speak of; files may be called anything.
  for line in "kerf-info --json ok.kerf" "kerf-crack block.ply --front ok.front" "kerf-sample block.ply --spacing 12%"; do
    { $line 2>err.txt; echo $? >status; } | true
    case $(cat status) in 141 | 0) ;; *) fail "$line | true exits with $(cat status)" ;; esac
    [ -s err.txt ] && fail "$line | true says: $(cat err.txt)"
    rm err.txt status
  done
  cp block.ply ./-n.ply
  quietly kerf-sample --spacing 12% -o 'ä ö.pcd' -- -n.ply
  quietly kerf-info -q -- -n.ply 'ä ö.pcd'
  kerf-info --json block.ply | grep -q '"kind":"surface","vertices":' || fail "kerf-info --json"
  kerf-info --json ok.kerf | grep -q '"edges_crossing":null' || fail "kerf-info --json of a body"
  kerf-info --check --json ok.kerf | grep -q '"edges_crossing":0' || fail "kerf-info --check --json of a body"
  cat block.ply | kerf-sample - --spacing 12% -o stdin.pcd || fail "standard input"
  kerf-sample block.ply --spacing 12% -o file.pcd
  cmp stdin.pcd file.pcd || fail "standard input gives other nodes"
  kerf-view block.ply --size 80x60 --samples 1 -o a.png && kerf-view -j1 block.ply --size 80x60 --samples 1 -o b.png && cmp a.png b.png || fail "pictures differ"
  kerf-model block --edge 0.5 -o level.vdb && kerf-sample level.vdb --spacing 0.2 --surface level.ply -o vdb.pcd || fail "volume input"
  quietly kerf-graph vdb.pcd --surface level.ply -o vdb.kerf
  quietly kerf-info --check -q vdb.kerf
  kerf-sample block.ply -n 500 --levels 3 --pattern blue --json -o figures.pcd | grep -q '^{"nodes":500,.*"levels":\[{"spacing":.*"thinnest":null,"too_thin":null,"seconds":{"read":' || fail "kerf-sample --json"
  ;;
scans)
  # Points of a sphere, with colours and noise far away: a solid near them; half a sphere: the filled half is told.
  python3 - <<'END'
import math, random
random.seed(7)
rows = []
for i in range(4000):
    z = 1 - (2 * i + 1) / 4000
    a, r = i * math.pi * (3 - 5 ** 0.5), (1 - z * z) ** 0.5
    rows.append((r * math.cos(a), r * math.sin(a), z))
with open("ball.xyz", "w") as f:
    for x, y, z in rows:
        f.write(f"{x} {y} {z} {255 if z > 0 else 0} 0 {0 if z > 0 else 255}\n")
with open("noisy.xyz", "w") as f:
    for x, y, z in rows + [(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(2, 4)) for _ in range(20)]:
        f.write(f"{x} {y} {z}\n")
with open("half.xyz", "w") as f:
    for x, y, z in rows:
        if z > -0.3:
            f.write(f"{x} {y} {z} {x} {y} {z}\n")
END
  kerf-repair ball.xyz --json -o ball.ply | python3 -c 'import json, sys; r = json.load(sys.stdin); assert abs(r["volume"] - 4.18879) < 0.05 and r["median"] < 0.01 and r["upper"] < 0.02 and r["unseen"] == 0, r' || fail "a ball"
  kerf-info --check --json ball.ply | grep -q '"attributes":\["color"\]' || fail "colours of a scan"
  quietly kerf-repair -q ball.xyz -j1 -o again.ply
  quietly kerf-repair -q ball.xyz -o - >piped.ply
  cmp ball.ply again.ply && cmp ball.ply piped.ply || fail "a scan twice"
  kerf-repair noisy.xyz -o noisy.ply 2>said.txt || fail "kerf-repair of a scan: $(cat said.txt)"
  grep -q 'points, [0-9]* outliers left out, normals estimated; surface of depth [0-9]*, from the points' said.txt || fail "kerf-repair says: $(cat said.txt)"
  kerf-info --check --json noisy.ply | python3 -c 'import json, sys; r = json.load(sys.stdin); assert r["pieces"] == 1 and abs(r["volume"] - 4.18879) < 0.1, r' || fail "a ball with outliers"
  kerf-repair half.xyz -o half.ply 2>said.txt || fail "kerf-repair of half a scan: $(cat said.txt)"
  grep -q '1 region without points filled, [0-9.]* % of the area: look there first' said.txt || fail "kerf-repair says: $(cat said.txt)"
  kerf-info --check -q half.ply || fail "half a scan"
  expect 2 "--depth must be from 4 to 12" kerf-repair ball.xyz --depth 3 -o x.ply
  head -n 5 ball.xyz >few.xyz
  expect 65 "few.xyz: has fewer than ten points" kerf-repair few.xyz -o x.ply
  { head -n 5 ball.xyz; echo "1 2"; } >short.xyz
  expect 65 "short.xyz:6: a point has 2 numbers, not 6" kerf-repair short.xyz -o x.ply
  # Nine points at one place and three others: without outliers too few are left.
  { for i in 1 2 3 4 5 6 7 8 9 10 11; do echo "0 0 0"; done; echo "1 0 0"; } >twins.xyz
  expect 65 "twins.xyz: has most of its points several times" kerf-repair twins.xyz --outliers 0 -o x.ply
  [ ! -e x.ply ] || fail "a partial file"
  # PCL is loaded for scans alone.
  ldd "$(command -v kerf-repair)" | grep -q pcl && fail "kerf-repair loads PCL"
  ;;
repairs)
  # Overlapping boxes, one of them open, with a group each: closed as they are, one solid when wrapped.
  box='1 3 4 2\n5 6 8 7\n1 2 6 5\n2 4 8 6\n4 3 7 8\n3 1 5 7'
  corners() { for i in 0 1 2 3 4 5 6 7; do echo "v $(awk "BEGIN { print $1 + $i % 2, $1 + int($i / 2) % 2, $1 + int($i / 4) }")"; done; }
  { corners 0; printf 'usemtl wood\n'; printf "$box\n" | sed 's/^/f /'; } >box.obj
  { sed '$d' box.obj; corners 0.5; printf 'usemtl stone\n'; printf "$box\n" | awk '{ print "f", $1 + 8, $2 + 8, $3 + 8, $4 + 8 }'; } >two.obj
  expect 65 "open.*try kerf-repair" kerf-crack two.obj --jagged 0.1 -o x.ply
  kerf-repair two.obj -o united.ply 2>said.txt || fail "kerf-repair of boxes that overlap: $(cat said.txt)"
  grep -q '1 hole closed with 2 triangles, crossing triangles cut: 3 enclosed regions united' said.txt || fail "kerf-repair says: $(cat said.txt)"
  kerf-info --check --json united.ply | python3 -c 'import json, sys; r = json.load(sys.stdin); assert r["pieces"] == 1 and r["volume"] == 1.875 and "group" in r["attributes"], r' || fail "the united solid"
  quietly kerf-score -q two.obj --repair --pieces 4 -o two.front
  quietly kerf-crack -q two.obj --repair --front two.front -o broken.ply
  kerf-info --json broken.ply | python3 -c 'import json, sys; r = json.load(sys.stdin); assert r["pieces"] == 4 and abs(r["volume"] - 1.875) < 1e-12, r' || fail "a model that is repaired first"
  { cat box.obj; corners 3; printf "$box\n" | sed '$d' | awk '{ print "f", $1 + 8, $2 + 8, $3 + 8, $4 + 8 }'; } >apart.obj
  expect 65 "open.*try kerf-repair" kerf-pieces apart.obj -o apart
  kerf-pieces apart.obj --repair --json -o apart | grep -q '"pieces":2,"bonds":0' || fail "pieces of a surface that is repaired first"
  kerf-pieces broken.ply --repair --json -o broken | grep -q '"pieces":4,' || fail "kerf-pieces --repair of a cut surface"
  printf 'v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n' >sheet.obj
  expect 1 "encloses no volume; wrap it .*--voxel" kerf-repair sheet.obj -o x.ply
  expect 65 "sheet.obj: cannot be repaired: the surface encloses no volume" kerf-crack sheet.obj --repair --jagged 0.1 -o x.ply
  kerf-repair two.obj --voxel 0.01 -o two.ply 2>said.txt || fail "kerf-repair --voxel: $(cat said.txt)"
  grep -q 'wrapped in [0-9]* triangles' said.txt || fail "kerf-repair says: $(cat said.txt)"
  kerf-info --check --json two.ply | python3 -c 'import json, sys; r = json.load(sys.stdin); assert r["pieces"] == 1 and abs(r["volume"] - 1.875) < 0.01 and "group" in r["attributes"], r' || fail "the wrapped solid"
  sed '$d' box.obj | kerf-repair -q - | kerf-info --check --json - | python3 -c 'import json, sys; r = json.load(sys.stdin); assert r["volume"] == 1 and r["faces"] == 12, r' || fail "an open box in a pipe"
  kerf-repair --json box.obj -o box.ply | python3 -c 'import json, sys; r = json.load(sys.stdin); assert r["holes"] == 0 and r["volume"] == 1' || fail "kerf-repair --json"
  quietly kerf-repair -q two.obj --voxel 0.01 -j1 -o one.ply
  for ending in stl off; do
    kerf-repair two.obj -o united.$ending 2>said.txt || fail "kerf-repair to .$ending: $(cat said.txt)"
    grep -q "united.$ending: left out: all but vertices and faces; a .ply keeps them" said.txt || fail "kerf-repair to .$ending says: $(cat said.txt)"
    kerf-info --check --json united.$ending | python3 -c 'import json, sys; r = json.load(sys.stdin); assert r["pieces"] == 1 and r["volume"] == 1.875, r' || fail "united.$ending"
  done
  kerf-repair -q box.obj -o - | kerf-repair -q - -o piped.off || fail "a pipe to .off"
  awk '/^v / { $2 += 1e6 } { print }' box.obj >far.obj
  expect 65 "far.stl: the model is too far from the origin for single precision; write a .ply" kerf-repair far.obj -o far.stl
  [ ! -e far.stl ] || fail "a partial file"
  # Bytes of a binary file are no lines of text, and parts that do not touch are pieces.
  kerf-repair -q box.obj -o bytes.stl && printf 'a\nl 1 2\n' | dd of=bytes.stl conv=notrunc 2>/dev/null
  [ "$(kerf-info --json bytes.stl | python3 -c 'import json, sys; print(json.load(sys.stdin)["faces"])')" = 12 ] || fail "a binary file with a line of polylines in it"
  kerf-repair -q apart.obj -o parts.ply || fail "two boxes"
  expect 1 "parts.ply: consists of 2 parts that do not touch, which are pieces already; ask for more than that" kerf-score parts.ply --pieces 1 -o x.front
  # Balls that overlap far from the origin cross once they are rounded: an .stl is valid as it is written.
  kerf-model sphere --frequency 8 -o ball.ply && kerf-repair -q ball.ply -o ball.obj || fail "a ball"
  awk -v places="0 0.6 -0.5 0.6 -0.3 -0.1 0.5 -0.1 0.1 -0.7 0.4 0.1 -0.2 0.4 -0.3" '/^v / { x[++n] = $2; y[n] = $3; z[n] = $4 } /^f / { split($2, a, "/"); split($3, b, "/"); split($4, c, "/"); f[++m] = a[1] " " b[1] " " c[1] } END { count = split(places, at, " "); for (k = 0; k < count; k += 3) for (i = 1; i <= n; ++i) printf "v %.17g %.17g %.17g\n", x[i] + at[k + 1] + 200, y[i] + at[k + 2], z[i] + at[k + 3]; for (k = 0; k < count / 3; ++k) for (j = 1; j <= m; ++j) { split(f[j], a, " "); print "f", a[1] + k * n, a[2] + k * n, a[3] + k * n } }' ball.obj >balls.obj
  kerf-repair balls.obj -o balls.stl 2>said.txt || fail "kerf-repair of balls: $(cat said.txt)"
  grep -q '[1-9][0-9]* pairs* of triangles that cross* in single precision divided' said.txt || fail "kerf-repair of balls says: $(cat said.txt)"
  quietly kerf-info --check -q balls.stl
  # A scan with a hole, closed as the surface around it goes on.
  kerf-model sphere --frequency 8 -o ball.ply && kerf-repair -q ball.ply -o ball.obj || fail "a ball"
  awk '/^v / { z[++n] = $4 } /^f / { split($2, a, "/"); split($3, b, "/"); split($4, c, "/"); if (z[a[1]] > 0.7 && z[b[1]] > 0.7 && z[c[1]] > 0.7) next } { print }' ball.obj >scan.obj
  kerf-repair scan.obj --smooth -o smooth.ply 2>said.txt && kerf-repair -q scan.obj -o flat.ply || fail "kerf-repair --smooth: $(cat said.txt)"
  grep -q '1 hole smoothly closed with [0-9]* triangles' said.txt || fail "kerf-repair --smooth says: $(cat said.txt)"
  for file in ball smooth flat; do kerf-info --check --json $file.ply | grep -o '"volume":[0-9.]*'; done | python3 -c 'import sys; v = [float(l.split(":")[1]) for l in sys.stdin]; assert len(v) == 3 and v[2] < v[1] - 0.1 and abs(v[1] - v[0]) < 0.05, v' || fail "the smooth patch"
  cmp two.ply one.ply || fail "threads change bytes"
  # Sheets become plates at every size; a card with two faces, too.
  printf 'v 0 0 0\nv 1 0 0\nv 1 1 0.2\nv 0 1 0.2\nf 1 2 3\nf 1 3 4\nf 1 3 2\nf 1 4 3\n' >card.obj
  for voxel in 0.003 0.005 0.01 0.02 0.05 0.1; do
    for sheet in sheet card; do
      kerf-repair $sheet.obj --voxel $voxel -o plate.ply 2>said.txt || fail "kerf-repair --voxel $voxel of a $sheet: $(cat said.txt)"
      grep -q '1 open sheet made a plate one voxel thick' said.txt || fail "kerf-repair says: $(cat said.txt)"
      kerf-info --check --json plate.ply | python3 -c "import json, sys; v = json.load(sys.stdin)['volume']; e = $voxel * 2 ** 0.5; assert 0.95 * e < v < 1.3 * e + 1.6 * e * e, (v, e)" || fail "a plate of $voxel"
    done
  done
  printf 'v 0 0 0\nv 1 0 0\nf 1 1 2\n' >line.obj
  expect 65 "no triangle has three different corners" kerf-repair line.obj -o x.ply
  for options in "--weld -1" "--voxel 0.2" "--voxel nan"; do expect 2 "${options%% *}" kerf-repair box.obj $options -o x.ply; done
  expect 66 "cannot" kerf-repair missing.obj -o x.ply
  ;;
readers)
  cases=$(dirname "$script")/../io/cases
  # said PATTERN COMMAND...: exit code 0 and one line on standard error with the pattern.
  said() {
    local pattern=$1
    shift
    "$@" 2>err.txt || fail "$* exits with $?: $(cat err.txt)"
    [ "$(wc -l <err.txt)" = 1 ] && grep -q -e "$pattern" err.txt || fail "$* does not say '$pattern' in one line but: $(cat err.txt)"
    rm -f err.txt
  }
  size() { kerf-info "$1" 2>/dev/null | head -1 | grep -o '; [0-9.e-]* × [0-9.e-]* × [0-9.e-]*'; }
  # Extensions: read as they are meant, or refused by name.
  [ "$(size "$cases/gltf/quantised.glb")" = "; 2 × 1 × 1" ] || fail "quantised.glb: $(size "$cases/gltf/quantised.glb")"
  [ "$(size "$cases/gltf/skin.glb")" = "; 1 × 1 × 1" ] || fail "skin.glb: $(size "$cases/gltf/skin.glb")"
  kerf-info --json "$cases/gltf/instances.glb" | grep -q '"pieces":3,' || fail "instances.glb has not three boxes"
  expect 65 "meshopt.glb: requires the glTF extension EXT_meshopt_compression, .*; save it" kerf-crack "$cases/gltf/meshopt.glb" --jagged 0.1 -o x.ply
  for file in "$cases"/stl/*.stl; do quietly kerf-info --check -q "$file"; done
  # Readers say what they leave out, and -q is silent.
  printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\nl 1 2\n' >lines.obj
  said "kerf-repair: lines.obj: left out: 1 polyline" kerf-repair lines.obj --json -o tetrahedron.ply >/dev/null
  quietly kerf-repair -q lines.obj -o tetrahedron.ply
  # The materials of a .glb: through a .ply into the pieces. Other formats have their names.
  printf 'front a\nstep 0\n-1 0.53 3\n2 0.53 3\nstep 1\n-1 0.53 -2\n2 0.53 -2\n' >a.front
  quietly kerf-crack "$cases/gltf/prop.glb" --front a.front -o broken.ply
  quietly kerf-pieces broken.ply --physics omi -o pieces.glb
  /usr/bin/python3 - "$cases/gltf/prop.glb" pieces.glb <<'END' || fail "materials of pieces.glb"
import json, struct, sys
def parts(name):
    data = open(name, "rb").read()
    length = struct.unpack("<I", data[12:16])[0]
    return json.loads(data[20:20 + length]), data[28 + length:]
def image(document, binary):
    view = document["bufferViews"][document["images"][0]["bufferView"]]
    return binary[view.get("byteOffset", 0):][:view["byteLength"]]
(before, first), (after, last) = parts(sys.argv[1]), parts(sys.argv[2])
assert after["materials"][:2] == before["materials"] and len(after["images"]) == 1, after["materials"]
assert image(before, first) == image(after, last)
assert sum(node["name"].startswith("piece_") for node in after["nodes"] if "mesh" in node) == 2
END
  said "cut.obj: left out: doubleSided, second texture coordinates" kerf-crack "$cases/gltf/prop.glb" --front a.front -o cut.obj
  said "folder: left out: doubleSided" kerf-pieces broken.ply -o folder
  ! kerf-pieces broken.ply -o pieces.usda 2>&1 | grep -q 'left out' || fail "pieces.usda leaves something out"
  grep -q 'UsdPreviewSurface' pieces.usda || fail "pieces.usda has no materials"
  printf '[body]\nmesh = "%s"\nspacing = 0.3\n[time]\nframes = 1\n' "$(realpath "$cases/gltf/prop.glb")" >prop.toml
  # A run of one body keeps them in a file beside its frames, which pages and pieces of frames find.
  kerf-sim prop.toml -o prop 2>&1 | grep -q 'left out' && fail "kerf-sim leaves materials out"
  [ -s prop/materials.glb ] || fail "the run has no materials"
  kerf-view -q prop -o prop.html && grep -q 'data:image/png' prop.html || fail "the page of a run has no image"
  kerf-view -q prop --color patch -o bare.html && grep -q 'data:image/png' bare.html && fail "--color patch keeps images"
  kerf-pieces -q prop -o frame.glb && grep -aq '"images"' frame.glb || fail "pieces of a frame have no image"
  # USD has them, too: a subset and a preview surface each, and the image beside it.
  grep -q 'def Material "Oak"' prop/run.usda && grep -q 'asset inputs:file = @./run_' prop/run.usda || fail "run.usda has no materials"
  grep -o '@./run_[^@]*@' prop/run.usda | tr -d @ | while read -r image; do [ -s "prop/$image" ] || fail "run.usda names $image, which is not there"; done
  # Two bodies: those of the same file share materials, another "Oak" has a number.
  printf 'newmtl Oak\nKd 0 1 0\n' >green.mtl
  printf 'mtllib green.mtl\nv 9 0 0\nv 10 0 0\nv 9 1 0\nv 9 0 1\nusemtl Oak\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n' >green.obj
  printf '[[body]]\nmesh = "%s"\nspacing = 0.3\n[[body]]\nmesh = "%s"\nspacing = 0.3\nposition = [5, 0, 0]\n[[body]]\nmesh = "green.obj"\nspacing = 0.3\n[time]\nframes = 1\n' "$(realpath "$cases/gltf/prop.glb")" "$(realpath "$cases/gltf/prop.glb")" >three.toml
  kerf-sim three.toml -o three >said.txt 2>&1 || fail "three bodies: $(cat said.txt)"
  grep -q 'left out' said.txt && fail "kerf-sim leaves materials of three bodies out: $(cat said.txt)"
  kerf-pieces -q three -o three.glb
  /usr/bin/python3 - three.glb <<'END' || fail "materials of three bodies"
import json, struct, sys
data = open(sys.argv[1], "rb").read()
json_ = json.loads(data[20:20 + struct.unpack("<I", data[12:16])[0]])
colors = {m["name"]: m["pbrMetallicRoughness"].get("baseColorFactor") for m in json_["materials"]}
assert set(colors) >= {"Oak", "Oak 2"} and colors["Oak 2"] == [0, 1, 0, 1] and colors["Oak"] != colors["Oak 2"], colors
assert len(json_["images"]) == 1, json_["images"]
END
  grep -q 'def Material "Oak_2"' three/run.usda || fail "run.usda of three bodies has no Oak_2"
  # Units: a part of 40 mm weighs what it weighs.
  mass() { /usr/bin/python3 -c 'import json, sys; d = open(sys.argv[1], "rb").read(); n = int.from_bytes(d[12:16], "little"); print(*sorted("%.4g" % m["extensions"]["OMI_physics_body"]["motion"]["mass"] for m in json.loads(d[20:20 + n])["nodes"] if "motion" in m.get("extensions", {}).get("OMI_physics_body", {})))' "$1"; }
  awk '/^ *vertex/ { print "vertex", 40 * $2, 40 * $3, 40 * $4; next } { print }' "$cases/stl/ascii-lead.stl" >part.stl
  said "part.stl: states no unit; one is taken as a metre, and --unit" kerf-pieces part.stl --physics omi --density 2500 -o m.glb
  quietly kerf-pieces part.stl --physics omi --density 2500 --unit mm -o mm.glb
  [ "$(mass m.glb) $(mass mm.glb)" = "1.6e+08 0.16" ] || fail "masses: $(mass m.glb) $(mass mm.glb)"
  [ "$(size mm.glb)" = "; 0.04 × 0.04 × 0.04" ] || fail "mm.glb: $(size mm.glb)"
  quietly kerf-pieces part.stl --unit mm --density 2500 -o mm.usda
  grep -q 'metersPerUnit = 0.001' mm.usda && grep -q 'physics:mass = 0.16' mm.usda || fail "mm.usda: $(grep -e Unit -e mass mm.usda)"
  quietly kerf-repair -q part.stl --unit mm -o part.ply
  quietly kerf-crack part.ply --jagged 0.01 -o again.ply
  quietly kerf-pieces again.ply --physics omi --density 2500 -o again.glb
  [ "$(mass again.glb)" = 0.16 ] || fail "the unit of a .ply: $(mass again.glb)"
  kerf-info --json again.ply | grep -q '"unit":0.001' || fail "kerf-info has no unit"
  said "part.obj: left out: the unit" kerf-crack part.ply --jagged 0.01 -o part.obj
  expect 2 "'lightyear' is no unit of length; give one of m, cm, mm" kerf-pieces part.stl --unit lightyear -o x.glb
  printf '[body]\nmesh = "part.ply"\nspacing = 0.02\n[time]\nframes = 1\n' >part.toml
  kerf-sim part.toml --set body.spacing=15 -o large 2>&1 | grep -q 'part.ply: states a unit of 0.001 m, but a scene is in metres; give the body scale = 0.001$' || fail "kerf-sim says nothing of a unit"
  kerf-sim part.toml --set body.scale=0.001 -o small 2>&1 | grep -q 'states a unit' && fail "kerf-sim speaks of the unit of a scaled body"
  [ "$(size small/frames/frame_0000.ply)" = "; 0.04 × 0.04 × 0.04" ] || fail "a scaled body: $(size small/frames/frame_0000.ply)"
  # Far from the origin: an offset on the root, said once.
  awk '/^ *vertex/ { printf "vertex %.9f %.9f %.9f\n", 691234.5678 + $2, 5401234.5678 + $3, 512.3 + $4; next } { print }' "$cases/stl/ascii-lead.stl" >far.stl
  said "far.glb: the model is far from the origin; the root node moves the pieces by (6.912e+05, 5.401e+06, 512.8)" kerf-pieces far.stl -o far.glb
  [ "$(size far.glb)" = "; 1 × 1 × 1" ] || fail "far.glb: $(size far.glb)"
  said "far.usda: the model is far from the origin" kerf-pieces far.stl --unit m -o far.usda
  printf '[body]\nmesh = "far.stl"\nspacing = 0.3\n[time]\nframes = 1\n' >far.toml
  kerf-sim far.toml -o far-run 2>&1 | grep -q 'the root of run.usda moves them by (6.912e+05, 5.401e+06, 512.8)' || fail "kerf-sim says nothing of an offset"
  grep -q 'double3 xformOp:translate = (691235' far-run/run.usda || fail "run.usda has no offset"
  ;;
scores)
  kerf-model block --edge 0.25 -o block.ply
  for pattern in planes crossing voronoi radial glass wood bricks; do
    quietly kerf-score block.ply --pattern $pattern --pieces 8 --jagged 0.01 --bumps 4 -o $pattern.front
    quietly kerf-crack block.ply --front $pattern.front -o $pattern.ply
    quietly kerf-info --check -q $pattern.front
    quietly kerf-info --check -q $pattern.ply
    kerf-info --json $pattern.ply | grep -q '"pieces":8,' || fail "$pattern does not make 8 pieces"
  done
  kerf-score -j1 block.ply --pattern voronoi --pieces 8 --jagged 0.01 --bumps 4 -o one.front
  cmp voronoi.front one.front || fail "threads change bytes"
  kerf-score block.ply --pattern voronoi --pieces 8 --jagged 0.01 --bumps 4 --seed 2 -o other.front
  cmp -s voronoi.front other.front && fail "seeds change nothing"
  quietly kerf-score block.ply --pattern voronoi --pieces 8 --depth 60% -o partial.front
  quietly kerf-crack block.ply --front partial.front -o partial.ply
  kerf-info --json partial.ply | grep -q '"pieces":1,' || fail "a partial score parts the body"
  kerf-info --json partial.ply | grep -q '"crack_faces":0,' && fail "a partial score cuts nothing"
  printf 'o a\nv 0.5 -1 0\nv 0.6 2 0\nl 1 2\no b\nv -1 0.4 0\nv 3 0.6 0\nl 3 4\n' >lines.obj
  quietly kerf-score block.ply --pattern curves --curves lines.obj -o curves.front
  quietly kerf-crack block.ply --front curves.front -o curves.ply
  sed -n '1,4p' lines.obj >line.obj
  quietly kerf-score block.ply --pattern curves --curves line.obj -o curve.front
  quietly kerf-crack block.ply --front curve.front -o curve.ply
  kerf-info --json curve.ply | grep -q '"pieces":2,' || fail "one curve does not make 2 pieces"
  kerf-info --json curves.ply | grep -q '"pieces":4,' || fail "two curves that cross do not make 4 pieces"
  kerf-score block.ply --pattern planes --pieces 3 --json -o planes.front | grep -q '^{"pattern":"planes","pieces":3,"chips":0,"attempts":' || fail "kerf-score --json"

  # Chips are pieces beside the others; detail at edges changes walls alone.
  quietly kerf-score block.ply --pieces 6 --chips 10 --chip-size 0.15 --edge-detail 0.004 --json -o chips.front >chips.json
  grep -q '"pieces":6,"chips":10,' chips.json || fail "chips: $(cat chips.json)"
  quietly kerf-crack block.ply --front chips.front -o chips.ply
  quietly kerf-info --check -q chips.ply
  kerf-info --json chips.ply | grep -q '"pieces":16,' || fail "6 pieces and 10 chips are not 16"
  kerf-score -j1 block.ply --pieces 6 --chips 10 --chip-size 0.15 --edge-detail 0.004 -o one.front
  cmp chips.front one.front || fail "threads change chips"

  # Density: red is high at x > 1, where most cells are then.
  kerf-repair -q block.ply -o block.off
  awk 'NR == 2 { n = $1; print "ply\nformat ascii 1.0\nelement vertex " $1 "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face " $2 "\nproperty list uchar int vertex_indices\nend_header"; next }
    NR > 2 && NR <= n + 2 { print $0, ($1 > 1 ? 255 : 20), 0, 0; next } NR > n + 2' block.off >painted.ply
  quietly kerf-score painted.ply --density red --pieces 24 -o red.front
  quietly kerf-score painted.ply --density falling-x --pieces 24 -o falling.front
  cmp -s red.front falling.front && fail "densities are alike"
  expect 65 "has no colours" kerf-score block.ply --density red -o x.front
  expect 65 "0 everywhere" kerf-score painted.ply --density green -o x.front
  expect 2 "--density" kerf-score painted.ply --density red --pattern planes -o x.front

  # Images: a disc is cut out; files that are no such images are refused.
  python3 "$(dirname "$script")/draw_png.py" disc.png 60 60 "(x - 30) ** 2 + (y - 30) ** 2 < 400"
  quietly kerf-score block.ply --pattern curves --image disc.png -o disc.front
  quietly kerf-crack block.ply --front disc.front -o disc.ply
  kerf-info --json disc.ply | grep -q '"pieces":2,' || fail "a disc does not make 2 pieces"
  quietly kerf-score block.ply --pattern curves --image disc.png --fit stretched --axis x --up y --tolerance 0.1 -o stretched.front
  python3 "$(dirname "$script")/draw_png.py" spots.png 60 60 "(x, y) in ((5, 5), (50, 5)) or (x - 30) ** 2 + (y - 30) ** 2 < 400"
  kerf-score block.ply --pattern curves --image spots.png -o spots.front 2>said.txt
  grep -q "spots.png: left out: 2 spots smaller than 4 pixels" said.txt || fail "spots: $(cat said.txt)"
  python3 "$(dirname "$script")/draw_png.py" white.png 60 60 False
  expect 65 "white.png: the image has no border between black and white" kerf-score block.ply --pattern curves --image white.png -o x.front
  head -c 100 disc.png >short.png
  expect 65 "short.png: is damaged" kerf-score block.ply --pattern curves --image short.png -o x.front
  expect 65 "lines.obj: is not a PNG" kerf-score block.ply --pattern curves --image lines.obj -o x.front
  python3 "$(dirname "$script")/draw_png.py" huge.png 60000 60000 ""
  expect 65 "huge.png: has more than 16 million pixels" kerf-score block.ply --pattern curves --image huge.png -o x.front
  expect 66 "cannot" kerf-score block.ply --pattern curves --image missing.png -o x.front
  [ -e x.front ] && fail "a refused score leaves a file"
  for options in "--pattern zigzag" "--pieces 0" "--attempts 0" "--jagged 1" "--bumps 0" "--depth 0%" "--depth 80" "--axis 0,0,0" "--axis up" "--impact 1,2" "--cluster 0" "--grain 0" "--pattern curves" "--sheets x.obj" "--chips -1" "--chip-size 0" "--edge-detail 1" "--edge-width 0" "--tolerance -1" "--density grey" "--chips 3 --depth 50%" "--image x.png"; do
    expect 2 "${options%% *}" kerf-score block.ply $options -o x.front
  done
  for pair in "--chip-size 0.2 --chips" "--edge-width 0.1 --edge-detail" "--up z --image" "--fit inside --image" "--tolerance 1 --image"; do
    set -- $pair
    expect 2 "$1 changes nothing without $3; give both" kerf-score block.ply $1 $2 -o x.front
  done
  expect 2 "\-\-image goes with --pattern curves; add it" kerf-score block.ply --image disc.png -o x.front
  expect 2 "\-\-curves goes with --pattern curves; add it" kerf-score block.ply --pattern planes --curves lines.obj -o x.front
  expect 2 "\-\-pattern curves needs --curves FILE or --image FILE" kerf-score block.ply --pattern curves -o x.front
  # A scan has no faces: the remedy is named.
  printf '0 0 0\n1 0 0\n0 1 0\n' >scan.xyz
  printf 'ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n' >scan.ply
  printf '# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n0 0 0\n' >scan.pcd
  for scan in scan.xyz scan.ply scan.pcd; do
    expect 65 "$scan: has points without faces; make a solid of it: kerf-repair $scan -o solid.ply" kerf-score $scan -o x.front
    expect 65 "$scan: has points without faces" kerf-info $scan
  done
  expect 66 "cannot" kerf-score missing.ply -o x.front
  expect 66 "cannot" kerf-score block.ply --pattern sheets --sheets missing.ply -o x.front
  expect 73 "cannot" kerf-score block.ply --pieces 3 -o none/x.front
  ;;
chunks)
  here=$(dirname "$script")
  kerf-model pumpkin --frequency 8 -o pumpkin.ply
  quietly kerf-score pumpkin.ply --pieces 12 --jagged 0.015 -o score.front
  quietly kerf-crack pumpkin.ply --front score.front -o broken.ply
  volume=$(kerf-info --json pumpkin.ply | grep -o '"volume":[0-9.e+-]*' | cut -d: -f2)
  quietly kerf-pieces broken.ply --hulls --strength 2 --bonds bonds.json -o pieces.glb
  python3 "$here/check_glb.py" pieces.glb bonds.json "$volume" 12 || fail "the .glb"
  quietly kerf-pieces -j1 broken.ply --hulls --strength 2 --up y -o one.glb
  cmp pieces.glb one.glb || fail "threads change bytes"
  quietly kerf-pieces broken.ply --hulls --hull-parts 3 --strength 2 -o parts.glb
  python3 "$here/check_glb.py" parts.glb bonds.json "$volume" 12 || fail "the .glb with parts"
  if command -v blender >/dev/null; then blender -b --python "$here/check_blender.py" -- "$PWD/parts.glb" 12 "$volume" >blender.txt 2>&1 && grep -q "^12 pieces$" blender.txt || fail "Blender: $(tail -n 5 blender.txt)"; fi
  quietly kerf-pieces broken.ply --up z --tile 1 -o turned.glb
  cmp -s pieces.glb turned.glb && fail "options change nothing"
  # An importer that is not ours; and back.
  if command -v assimp >/dev/null; then
    assimp info pieces.glb >assimp.txt || fail "assimp cannot import the .glb: $(cat assimp.txt)"
    assimp export pieces.glb back.ply >assimp.txt || fail "assimp cannot convert the .glb: $(cat assimp.txt)"
    grep -q 'Materials: *[23]$' <(assimp info pieces.glb) || fail "assimp finds other materials"
  fi
  for kind in "" --obj; do
    quietly kerf-pieces broken.ply $kind --hulls --strength 2 -o folder
    for file in folder/piece_* folder/hull_*; do quietly kerf-info --check -q $file; done
    [ "$(ls folder/piece_* | wc -l)" = 12 ] || fail "not 12 files"
    sed 's/"file":"\(piece_[0-9]*\)\.[a-z]*/"node":"\1/g' folder/pieces.json | cmp - bonds.json || fail "bonds differ"
    rm -r folder
  done
  # Crumbs join, clusters are nodes, and USD is the same for any number of threads.
  kerf-pieces broken.ply --least 0.07 --levels 3 --physics khr --json --bonds levels.json -o levels.glb >levels.txt
  python3 "$here/check_levels.py" levels.glb levels.json levels.txt "$volume" 0.07 || fail "the hierarchy"
  quietly kerf-pieces broken.ply --unit m --least 0.07 --levels 3 -o levels.usda
  quietly kerf-pieces -j1 broken.ply --unit m --least 0.07 --levels 3 -o one.usda
  cmp levels.usda one.usda || fail "threads change USD"
  # A part without a bond stays, however small, and is reported.
  kerf-model sphere --frequency 2 -o ball.ply
  quietly kerf-pieces ball.ply --unit m --least 0.9 --levels 2 -o ball.usda
  python3 - <<'PYTHON'
rows = {"v": [], "f": []}
for scale, shift in ((1, 0), (0.01, 5)):
    base = len(rows["v"])
    for x, y, z in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)):
        rows["v"].append(f"{scale * x + shift} {scale * y} {scale * z}")
    for a, b, c in ((1, 3, 2), (1, 2, 4), (2, 3, 4), (1, 4, 3)):
        rows["f"].append(f"{a + base} {b + base} {c + base}")
open("two.obj", "w").write("".join(f"{k} {row}\n" for k in "vf" for row in rows[k]))
PYTHON
  kerf-pieces two.obj --least 0.1 --json -o two.glb >two.txt 2>two.err
  grep -q '"pieces":2,"bonds":0,"joined":0,"isolated":1' two.txt || fail "an isolated piece: $(cat two.txt)"
  grep -q "without a bond" two.err || fail "an isolated piece is not reported"
  for options in "--least 1" "--least -0.1" "--levels 0" "--physics bullet" "--names max" "--density 0"; do
    expect 2 "${options%% *}" kerf-pieces broken.ply $options -o x.glb
  done
  expect 2 "belongs to a .glb" kerf-pieces broken.ply --physics omi -o x.usda
  expect 2 "belongs to a .glb" kerf-pieces broken.ply --names godot -o x
  # The same of a body that follows the cut.
  kerf-sample pumpkin.ply --spacing 8% | kerf-graph --surface pumpkin.ply -o body.kerf && quietly kerf-update body.kerf --surface broken.ply -o body.kerf
  quietly kerf-pieces body.kerf --hulls --strength 2 --bonds body.json -o body.glb
  python3 "$here/check_glb.py" body.glb body.json "$volume" 12 || fail "the .glb of a body"
  for options in "--up x" "--tile 0" "--strength -1" "--hull-corners 3" "--hull-parts 0"; do
    expect 2 "${options%% *}" kerf-pieces broken.ply $options -o x.glb
  done
  expect 2 "folder has pieces.json" kerf-pieces broken.ply --bonds b.json -o x
  expect 73 "cannot" kerf-pieces broken.ply -o none/x.glb
  ;;
kinds)
  # A file is known by what it holds, not by its first line.
  kerf-model block --edge 0.5 -o block.ply
  printf '# made by hand\n\nOFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n' >comment.off
  printf '# made by hand\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n' >comment.obj
  printf '# two time steps\no a\nv 0 0 0\nv 1 0 0\nl 1 2\no b\nv 0 0 1\nv 1 0 1\nl 3 4\n' >lines.obj
  printf '# made by hand\nfront a\nstep 0\n0 0 0\n1 0 0\nstep 1\n0 0 1\n1 0 1\n' >comment.txt
  for file in comment.off comment.obj; do kerf-info --json $file | grep -q '"kind":"surface"' || fail "$file is not known for a surface"; done
  for file in lines.obj comment.txt; do kerf-info --json $file | grep -q '"kind":"fronts"' || fail "$file is not known for a front"; done
  quietly kerf-view comment.obj --size 64x48 --samples 1 -o a.png
  quietly kerf-view comment.txt --size 64x48 --samples 1 -o b.png
  printf '# .PCD v0.7\nVERSION 0.7\nFIELDS x y z radius spacing volume\nSIZE 8 8 8 8 8 8\nTYPE F F F F F F\nCOUNT 1 1 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n0 0 0 1 1 1\n0 0 0 1 1 1\n' >twins.pcd
  expect 1 "nodes 0 and 1 are at one place" kerf-info --check -q twins.pcd
  # A front saved before it met anything keeps its crack number.
  printf 'front far\nstep 0\n-1 0.5 3\n2 0.5 3\nstep 1\n-1 0.5 2\n2 0.5 2\nstep 2\n-1 0.5 0.6\n2 0.5 0.6\n' >far.front
  printf 'front side\nstep 0\n0.3 -1 3\n0.3 2 3\nstep 1\n0.3 -1 0.55\n0.3 2 0.55\n' >side.front
  quietly kerf-crack block.ply --front far.front --steps 0:1 -o one.ply
  quietly kerf-crack one.ply --front side.front -o two.ply
  quietly kerf-crack two.ply --front far.front --steps 1:2 -o three.ply
  quietly kerf-info --check -q three.ply
  kerf-crack two.ply --front far.front --steps 1:2 -o three.obj && [ "$(grep -c "^g patch_-[12]" three.obj)" -ge 2 ] || fail "two cracks share a number: $(grep '^g' three.obj | tr '\n' ' ')"
  ;;
attributes)
  # A die with texture coordinates and materials keeps them through every cut, in every format.
  printf 'newmtl side\nKd 1 0 0\nnewmtl lid\nKd 0 1 0\nPr 0.25\n' >die.mtl
  quads() { for q in "$@"; do set -- $q; echo "f $1/1 $2/2 $3/3 $4/4"; done; }
  {
    printf 'mtllib die.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl side\n'
    quads "1 2 6 5" "2 3 7 6" "3 4 8 7" "4 1 5 8"
    echo usemtl lid
    quads "1 4 3 2" "5 6 7 8"
  } >die.obj
  printf 'front a\nstep 0\n-1 0.53 3\n2 0.53 3\nstep 1\n-1 0.53 0.4\n2 0.53 0.4\nstep 2\n-1 0.53 -2\n2 0.53 -2\n' >a.front
  printf 'front b\nstep 0\n0.41 -1 3\n0.41 2 3\nstep 1\n0.41 -1 -2\n0.41 2 -2\n' >b.front
  quietly kerf-crack die.obj --front a.front -o cut.obj
  printf '[body]\nmesh = "die.obj"\nspacing = 0.3\n[[score]]\nfile = "a.front"\n[time]\nframes = 1\n' >die.toml
  kerf-sim -q die.toml -o die && /usr/bin/python3 "$(dirname "$script")/check_usd.py" die | grep -q "texture" || fail "USD with texture coordinates"
  for line in "mtllib cut.mtl" "usemtl side" "usemtl lid" "usemtl crack" "g patch_-1" "f [0-9]*/[0-9]* [0-9]*/[0-9]* [0-9]*/[0-9]*"; do grep -q "^$line\$" cut.obj || fail "cut.obj has no '$line'"; done
  [ "$(grep -c '^vt ' cut.obj)" -gt 4 ] || fail "cut.obj has no new texture coordinates"
  quietly kerf-crack die.obj --front a.front --steps 0:1 -o half.ply
  quietly kerf-crack half.ply --front b.front -o cut.ply
  for file in half.ply cut.ply; do kerf-info --json $file | grep -q '"attributes":\["uv","group","source"\]' || fail "$file lost attributes: $(kerf-info --json $file)"; done
  kerf-info cut.ply | grep -q '^attributes  *\["uv","group","source"\]' || fail "kerf-info does not list attributes"
  kerf-info --json a.front | grep -q attributes && fail "a front has no attributes"
  quietly kerf-crack half.ply --front a.front --steps 1:2 -o whole.ply
  quietly kerf-pieces --obj whole.ply -o pieces
  # Materials of an .mtl go beside an OBJ, into a folder, and to standard output as names.
  quietly kerf-crack die.obj --front a.front -o red.ply
  quietly kerf-crack die.obj --front a.front -o red.obj
  grep -q '^mtllib red.mtl$' red.obj && grep -q '^newmtl crack$' red.mtl && grep -q '^Pr 0.25$' red.mtl || fail "red.obj without its materials: $(cat red.mtl)"
  quietly kerf-pieces red.ply -o red
  grep -q '^Kd 0 1 0$' red/materials.mtl || fail "a folder without materials"
  quietly kerf-pieces red/piece_000.ply -o red.glb
  grep -q 'baseColorFactor":\[0.0,1.0,0.0,1.0\]' red.glb || fail "a piece of a folder has no materials"
  mv die.mtl away.mtl
  kerf-crack die.obj --front a.front -o x.ply 2>&1 | grep -q 'die.obj: names die.mtl, not in its folder; materials of it have names only' || fail "a missing .mtl is not told"
  mv away.mtl die.mtl
  for piece in pieces/*.obj; do for line in "usemtl side" "usemtl lid" "usemtl crack"; do grep -q "^$line\$" $piece || fail "$piece has no '$line'"; done; done
  sed 's/^f 1\/1/f 1\/9/' die.obj >range.obj
  expect 65 "range.obj:.*texture coordinate 9" kerf-crack range.obj --front a.front -o x.ply
  printf '[body]\nmesh = "die.obj"\nspacing = 0.25\n[time]\nframes = 2\nframe_rate = 20\nstep = 0.05\ncheckpoint_every = 1\n[[blade]]\npoints = [[0,-0.4,0],[0,1.4,0]]\ndivide = 4\nkeys = [[0.0,0.513,0.007,1.3,0,0,1,2],[0.1,0.513,0.011,0.3,0,0,1,3]]\n' >s.toml
  quietly kerf-sim -q s.toml -o run
  quietly kerf-sim -q s.toml -o parts --frames 1
  quietly kerf-sim -q s.toml -o parts --resume
  cmp run/frames/frame_0002.ply parts/frames/frame_0002.ply || fail "attributes of a frame differ after --resume"
  kerf-info --json run/frames/frame_0002.ply | grep -q '"attributes":\["uv","group","source"\]' || fail "a frame has no attributes"
  ;;
details)
  # Sheets, remeshing, roughening, decimation: valid, the same for one seed, with attributes and fronts kept.
  kerf-model pumpkin --frequency 12 -o p.ply
  kerf-model front --around p.ply --steps 6 -o f.front
  printf 'v -2 -2 0.4\nv 2 -2 0.3\nv 2 2 0.41\nv -2 2 0.5\nf 1 2 3\nf 1 3 4\n' >sheet.obj
  quietly kerf-crack p.ply --sheet sheet.obj -o sheet.ply
  quietly kerf-crack p.ply --front f.front --remesh 15 -o remeshed.ply
  quietly kerf-crack p.ply --front f.front --steps 0:3 --remesh 15 -o half.ply
  quietly kerf-crack half.ply --front f.front --steps 3:6 --remesh 15 --sheet sheet.obj -o both.ply
  quietly kerf-crack p.ply --front f.front --jagged 0.01 --seed 3 -o jagged.ply
  quietly kerf-crack p.ply --front f.front --jagged 0.01 --seed 3 -j 1 -o again.ply
  quietly kerf-crack p.ply --front f.front --jagged 0.01 --seed 4 -o other.ply
  quietly kerf-crack p.ply --decimate 0.003 --front f.front -o few.ply
  for file in sheet remeshed both jagged few; do
    kerf-info --check --json $file.ply >info.json || fail "$file.ply: $(cat info.json)"
    grep -q '"pieces":[234]' info.json || fail "$file.ply is not cut through: $(cat info.json)"
  done
  cmp jagged.ply again.ply || fail "the same seed gives other bumps"
  cmp -s jagged.ply other.ply && fail "another seed gives the same bumps"
  faces() { kerf-info --json $1 | grep -o '"skin_faces":[0-9]*' | cut -d: -f2; }
  [ "$(faces few.ply)" -lt "$(faces p.ply)" ] || fail "few.ply has $(faces few.ply) faces"
  kerf-crack p.ply --front f.front --remesh 15 --jagged 0.005 --decimate 0.001 --json -o all.ply | grep -q '"decimate".*"remesh".*"jagged"' || fail "--json does not tell of each"
  # A body follows a crack that grows, but not one that was displaced since.
  kerf-sample p.ply --spacing 12% | kerf-graph --surface p.ply -o p.kerf
  quietly kerf-update p.kerf --surface jagged.ply -o jagged.kerf
  quietly kerf-info --check -q jagged.kerf
  kerf-crack p.ply --front f.front -o plain.ply
  quietly kerf-update p.kerf --surface plain.ply -o plain.kerf
  quietly kerf-crack plain.ply --jagged 0.01 -o later.ply
  expect 65 "crack 1 .*moved" kerf-update plain.kerf --surface later.ply -o x.kerf
  expect 2 "remesh" kerf-crack p.ply --front f.front --remesh 80 -o x.ply
  expect 2 "jagged" kerf-crack p.ply --jagged nan -o x.ply
  expect 2 "decimate" kerf-crack p.ply --decimate 2 -o x.ply
  expect 2 "at least one" kerf-crack p.ply -o x.ply
  expect 66 "none.obj" kerf-crack p.ply --sheet none.obj -o x.ply
  ;;
files)
  # A body that is updated in its own file, folded, exported, and read by a program that is not ours.
  here=$(dirname "$script")
  export PYTHONDONTWRITEBYTECODE=1
  kerf-model block --edge 0.1 -o block.ply
  printf 'front a\nstep 0\n-1 0.53 3\n2 0.53 3\nstep 1\n-1 0.53 0.7\n2 0.53 0.7\n' >a.front
  kerf-sample block.ply --spacing 6% | kerf-graph --surface block.ply -o body.kerf
  quietly kerf-crack block.ply --front a.front -o cut.ply
  quietly kerf-update body.kerf --surface cut.ply -o whole.kerf
  before=$(stat -c %s body.kerf)
  cp body.kerf appended.kerf
  quietly kerf-update appended.kerf --surface cut.ply -o appended.kerf
  after=$(stat -c %s appended.kerf)
  [ $((after - before)) -lt $((before / 2)) ] || fail "$((after - before)) bytes were appended to $before"
  head -c $before appended.kerf | cmp - body.kerf || fail "appending changed what was there"
  kerf-info --json appended.kerf | grep -q '"appended":1' || fail "nothing was appended"
  quietly kerf-info --check -q appended.kerf
  # At any stage of a write that was killed, and then updated again.
  head -c $((after - 1)) appended.kerf >killed.kerf
  kerf-info --json killed.kerf | grep -q '"updates":0' || fail "a killed update counts"
  quietly kerf-update killed.kerf --surface cut.ply -o killed.kerf
  kerf-info --json killed.kerf | grep -q '"appended":1' || fail "a killed update cannot be done again"
  quietly kerf-info --compact appended.kerf -o folded.kerf
  cat appended.kerf | kerf-info --compact - >piped.kerf || fail "--compact of a pipe"
  cmp folded.kerf piped.kerf || fail "--compact of a pipe differs"
  cp appended.kerf itself.kerf
  quietly kerf-info --compact itself.kerf
  cmp folded.kerf itself.kerf || fail "--compact in place differs"
  python3 -c '
import sys; sys.path.insert(0, sys.argv[1])
from read_kerf import read_kerf
a, b, c = map(read_kerf, ("appended.kerf", "folded.kerf", "whole.kerf"))
assert a == b
del a["about"], c["about"]
assert a == c' "$here" || fail "appended, folded and whole bodies differ"
  # With guides: none in a block, along the front once it is cut.
  kerf-sample block.ply --spacing 6% | kerf-graph --surface block.ply --guides 0.5 -o guided.kerf
  kerf-info --json guided.kerf | grep -q '"guides"' && fail "a block has no concave edges"
  quietly kerf-update guided.kerf --surface cut.ply -o guided.kerf
  kerf-info --json guided.kerf | grep -q '"guides":[1-9]' || fail "the front has no guides"
  quietly kerf-info --check -q guided.kerf
  expect 2 guides kerf-graph /dev/null --surface block.ply --guides 20 -o x.kerf
  for format in json npz ply vtu hdf; do
    quietly kerf-info appended.kerf --export e.$format
    quietly kerf-info folded.kerf --export f.$format
    cmp e.$format f.$format || fail "e.$format differs from f.$format"
  done
  python3 "$here/check_exports.py" appended.kerf e || fail "exports"
  head -c 8 e.hdf | cmp - <(printf '\211HDF\r\n\032\n') || fail "e.hdf is no HDF5 file"
  # Refused: another update at the same time, damage, and what cannot be.
  exec 9<appended.kerf
  flock -x 9
  expect 73 "being updated by another" kerf-update appended.kerf --surface cut.ply -o appended.kerf
  expect 73 "being updated by another" kerf-info --compact appended.kerf
  exec 9<&-
  { head -c $((after - 40)) appended.kerf; printf x; tail -c 39 appended.kerf; } >damaged.kerf
  expect 65 "damaged" kerf-info damaged.kerf
  expect 65 "damaged" kerf-update damaged.kerf --surface cut.ply -o damaged.kerf
  expect 65 "damaged" kerf-info --compact damaged.kerf
  expect 65 "damaged" kerf-info damaged.kerf --export x.vtu
  expect 65 "not a .kerf" kerf-info --compact block.ply
  expect 65 "not a .kerf" kerf-info block.ply --export x.vtu
  expect 66 "cannot" kerf-info --compact missing.kerf
  expect 2 "export" kerf-info body.kerf --export x.xyz
  expect 2 "goes with --compact" kerf-info body.kerf -o x.kerf
  expect 73 "cannot" kerf-info body.kerf --export none/x.npz
  ;;
stops)
  kerf-model block --edge 0.06 -o block.ply
  kerf-model block --edge 0.5 -o small.ply
  kerf-model front --around block.ply --steps 2 -o ok.front
  kerf-sample block.ply --spacing 6% | kerf-graph --surface block.ply -o ok.kerf
  kerf-crack block.ply --front ok.front -o cut.ply
  # Ctrl-C: 130, soon, and nothing left behind.
  for line in "kerf-update ok.kerf --surface cut.ply -o x.kerf" "kerf-info --check ok.kerf" "kerf-view cut.ply --size 4000x3000 --samples 8 -o x.png" "kerf-sample block.ply --spacing 1% -o x.pcd"; do
    before=$(ls -A)
    setsid $line >/dev/null 2>/dev/null </dev/null &
    pid=$!
    sleep 0.03
    # In the background Ctrl-C is not heard before the tool waits for it (bit 1 of what it blocks).
    for i in $(seq 100); do grep -qs '^SigBlk:.*[2367abef]$' /proc/$pid/status || [ ! -d /proc/$pid ] && break || sleep 0.01; done
    kill -INT $pid 2>/dev/null
    wait $pid
    status=$?
    [ $status = 130 ] || [ $status = 0 ] || fail "$line, stopped, exits with $status"
    case $line in kerf-view*) [ $status = 130 ] || fail "$line does not stop" ;; esac
    [ $status = 0 ] && rm -f x.kerf x.pcd
    [ "$before" = "$(ls -A)" ] || fail "$line, stopped, leaves something behind: $(ls -A)"
  done
  # Stopped and continued while it ends, as by Ctrl-Z and fg: it goes on ending as it should.
  for i in 1 2 3 4 5 6 7 8; do
    kerf-live block.ply --no-browser --port 0 >address.txt 2>said.txt &
    pid=$!
    for wait in $(seq 1000); do [ -s address.txt ] && break || sleep 0.01; done
    kill -INT $pid && sleep 0.002
    kill -STOP $pid 2>/dev/null && kill -CONT $pid
    wait $pid && rm address.txt || fail "kerf-live, stopped and continued, does not end: $(cat said.txt)"
  done
  # The terminal is closed: what was recorded is written. With nohup the run goes on. A bar is drawn while it begins alone.
  for hangup in default ignore; do
    env --$hangup-signal=HUP kerf-live block.ply --no-browser --progress always --record closed.toml >address.txt 2>said.txt &
    pid=$!
    for wait in $(seq 1000); do [ -s address.txt ] && break || sleep 0.01; done
    sleep 0.5
    kill -HUP $pid
    [ $hangup = default ] || { sleep 0.3 && kill -INT $pid || fail "kerf-live ends with its terminal, in spite of nohup"; }
    wait $pid || fail "kerf-live without its terminal: $(cat said.txt)"
    [ -s closed.toml ] || fail "kerf-live records nothing where its terminal is closed"
    [ "$(tr '\r' '\n' <said.txt | grep -c ' % $')" = 0 ] || fail "kerf-live draws a bar while it runs: $(cat -v said.txt)"
    rm address.txt closed.toml
  done
  # A bar where it is asked for, gone before anything else is said.
  for line in "kerf-graph --surface block.ply nodes.pcd -o y.kerf" "kerf-update ok.kerf --surface cut.ply -o y.kerf"; do
    kerf-sample -q block.ply --spacing 6% -o nodes.pcd && $line -v --progress always 2>bar.txt || fail "$line: $(cat bar.txt)"
    tr '\r' '\n' <bar.txt | grep -q ' % binding$' || fail "$line shows no progress: $(cat -v bar.txt)"
    tr '\r' '\n' <bar.txt | tail -n 1 | grep -q "^.\[K${line%% *}: [0-9]" || fail "$line leaves its bar: $(cat -v bar.txt)"
    $line 2>bar.txt && [ ! -s bar.txt ] || fail "$line says: $(cat bar.txt)"
  done
  expect 65 "fewer vertices" kerf-update ok.kerf --surface small.ply -o x.kerf
  # A full disk under standard output, and a configuration that does not fit.
  for line in "kerf-info block.ply" "kerf-info --help" "kerf-crack --version"; do
    $line >/dev/full 2>err.txt
    [ $? = 73 ] || fail "$line does not notice a full disk"
    grep -q "cannot be written" err.txt || fail "$line does not say that the disk is full: $(cat err.txt)"
    rm -f err.txt
  done
  printf 'no-such-key = 3\n' >wrong.toml
  expect 2 "no-such-key" kerf-sample block.ply --config wrong.toml -o x.pcd
  expect 66 "missing.toml" kerf-sample block.ply --config missing.toml -o x.pcd
  expect 2 "finite" kerf-crack block.ply --front ok.front --max-move nan -o x.ply
  mkdir full && touch full/file
  expect 73 "not empty" kerf-pieces cut.ply -o full
  expect 73 "cannot" kerf-pieces cut.ply -o /proc/x
  ;;
simulation)
  kerf-model block --edge 0.2 -o cube.ply
  kerf-model sphere --frequency 4 -o ball.ply
  printf '[body]\nmesh = "cube.ply"\nspacing = 0.25\n[[obstacle]]\nmesh = "ball.ply"\nscale = 0.5\nposition = [1, 0.5, -0.5]\nkeys = [[0, 0, 0, 0, 0, 0, 1, 0], [1, 0, 0, 0.1, 0, 0, 1, 90]]\n[time]\nframes = 6\nframe_rate = 20\nstep = 0.05\ncheckpoint_every = 2\n[[blade]]\npoints = [[0,-0.4,0],[0,1.4,0]]\ndivide = 4\nkeys = [[0.0,1.013,0.007,1.3,0,0,1,2],[0.2,1.013,0.011,-0.7,0,0,1,3]]\n' >s.toml
  kerf-sim -q --json s.toml -o whole >frames.json || fail "kerf-sim"
  [ "$(wc -l <frames.json)" = 6 ] || fail "not a line a frame: $(cat frames.json)"
  for phase in front mesh graph resample binding mechanics contact write; do grep -q "\"$phase\":[0-9.e-]*" frames.json || fail "no seconds of $phase"; done
  kerf-sim -q s.toml -o parts --frames 2 && kerf-sim -q s.toml -o parts --frames 4 --resume && kerf-sim -q s.toml -o parts --resume || fail "kerf-sim --resume"
  diff -r whole parts || fail "a run made in three parts differs"
  [ -s whole/obstacles/obstacles_0006.ply ] || fail "no obstacles of the last frame"
  /usr/bin/python3 "$(dirname "$script")/check_usd.py" whole || fail "the USD file"
  grep -q '"obstacles":\[{"force":\[[0-9e.,-]*\],"torque"' whole/frames.jsonl || fail "no forces on the obstacle"
  grep -q '"pieces":2' whole/summary.json || fail "not two pieces: $(cat whole/summary.json)"
  kerf-info --check -q whole/checkpoint.kerf || fail "the body is not sound"
  kerf-view whole --size 80x60 --samples 1 -o sheet.png || fail "contact sheet"
  # Pieces of a frame: where they are there, with the topology that the material has.
  quietly kerf-pieces whole/frames/frame_0006.ply -o there && quietly kerf-pieces whole/checkpoint.kerf -o before
  [ "$(ls there before | grep -c ply)" = 4 ] || fail "not two pieces of a frame and of a body"
  for file in before/*.ply; do quietly kerf-info --check -q $file; done
  for file in there/*.ply; do kerf-info --json $file | grep -q '"closed":true,"manifold":true,"oriented":true' || fail "$file is not closed"; done  # without contact they may cross
  cmp -s there/piece_000.ply before/piece_000.ply && fail "a frame's pieces are not where the frame is"
  quietly kerf-pieces whole -o last && diff -r there last || fail "a run's folder is not its last frame"
  expect 65 "without frames" kerf-pieces there -o x
  cp whole/frames/frame_0006.ply astray.ply
  expect 65 "no frame in the folder of its run" kerf-pieces astray.ply -o x
  kerf-sim -q s.toml -o late --frames 2 && cp whole/frames/frame_0006.ply late/frames/ || fail "a run of two frames"
  expect 65 "was cut after its run's checkpoint" kerf-pieces late/frames/frame_0006.ply -o x
  # A frame that nothing is cut in is a model like others.
  sed '/\[\[blade\]\]/,$d' s.toml >still.toml && kerf-sim -q still.toml -o still --frames 1 || fail "a run without a blade"
  quietly kerf-sample still/frames/frame_0001.ply --spacing 20% -o still.pcd && quietly kerf-info --check -q still.pcd
  printf '[body]\nmesh = "still/frames/frame_0001.ply"\nspacing = 0.4\n[time]\nframes = 1\n' >again.toml && kerf-sim -q again.toml -o again || fail "a scene of an uncut frame"
  quietly kerf-score cube.ply --pieces 2 -o c.front && quietly kerf-crack cube.ply --front c.front -o c.ply
  expect 65 "is cut already; sample the model" kerf-sample c.ply --spacing 20% -o x.pcd
  # A row of a list, told by its number; what is not there.
  kerf-sim -q s.toml -o cut --set blade.0.keys.1.3=0.4 --set blade.0.divide=5 || fail "--set of a row"
  grep -q '"pieces":1' cut/summary.json || fail "the blade stops half way, but: $(cat cut/summary.json)"
  expect 65 "no row 3" kerf-sim s.toml -o x --set blade.3.thickness=1
  expect 65 "names no row" kerf-sim s.toml -o x --set blade.first.thickness=1
  expect 65 "another scene" kerf-sim s.toml -o whole --resume --set material.young=2e5
  # A run goes on with the vectors that it began with. A blow says what it made.
  printf '[body]\nmesh = "cube.ply"\nspacing = 0.2\n[ground]\npoint = [0, 0, 0]\n[contact]\nself = true\n[[blow]]\ntime = 0.1\npoint = [0.3, 0.4, 1]\ncells = 6\n[time]\nframes = 5\nframe_rate = 24\nstep = 0.02\ncheckpoint_every = 1\n' >blow.toml
  kerf-sim blow.toml -o struck 2>said.txt || fail "a run with a blow: $(cat said.txt)"
  made=$(grep -o '"pieces":[0-9]*' struck/summary.json | cut -d: -f2)
  [ "$made" -gt 1 ] && grep -q " 1 blow made $made parts, $made pieces" said.txt || fail "kerf-sim says of a blow: $(cat said.txt)"
  [ "$(grep -c "\"blows\":1,\"blow_parts\":$made," struck/frames.jsonl)" = 1 ] && grep -q "\"blows\":1,\"blow_parts\":$made," struck/summary.json || fail "no blow in one line of frames.jsonl, and in summary.json"
  kerf-sim -q --portable blow.toml -o portable && kerf-sim -q --portable blow.toml -o onward --frames 2 || fail "kerf-sim --portable"
  kerf-sim -q blow.toml -o onward --frames 4 --resume && kerf-sim -q --portable blow.toml -o onward --resume || fail "a portable run that goes on"
  diff -rq portable onward || fail "a portable run made in three parts differs"
  if grep -qw fma /proc/cpuinfo; then cmp -s portable/frames/frame_0005.ply struck/frames/frame_0005.ply && fail "vectors make no difference"; fi
  kerf-sim -q blow.toml -o fused --frames 2 || fail "kerf-sim"
  expect 65 "fused: was begun without --portable; leave it out, or give another folder" kerf-sim blow.toml -o fused --resume --portable
  kerf-sim -q blow.toml -o fused --resume && diff -rq struck fused || fail "a run that goes on after a refusal differs"
  # Names of files that are empty, as of a shell variable that is not set.
  expect 2 "'body.mesh=' names no file; write body.mesh=FILE" kerf-sim s.toml -o x --set body.mesh=
  expect 2 "'score.0.file=' names no file" kerf-sim s.toml -o x --set score.0.file=
  sed 's/^mesh = .*/mesh = ""/' s.toml >unnamed.toml && expect 65 "unnamed.toml:.*'body.mesh' is empty: name the model" kerf-sim unnamed.toml -o x
  for tool in kerf-info kerf-repair "kerf-sample --spacing 20%" "kerf-score -o x" "kerf-pieces -o x" "kerf-view -o x.png" "kerf-sim -o x" "kerf-crack cube.ply -o x --front"; do
    expect 66 "name of an input file is empty" $tool ""
  done
  for tool in "kerf-sim s.toml -o" "kerf-sample cube.ply --spacing 20% -o" "kerf-live cube.ply --record" "kerf-pieces cube.ply -o x.glb --bonds"; do
    expect 2 "the name is empty; give one" $tool ""
  done
  expect 73 "holds a run already" kerf-sim s.toml -o whole
  # Up is where gravity comes from.
  kerf-sim -q s.toml -o upright --frames 1 --set gravity=[0,-9.81,0] && kerf-sim -q s.toml -o aslant --frames 1 --set gravity=[0,-9.81,1] || fail "gravity along y"
  grep -q 'upAxis = "Y"' upright/run.usda && grep -q 'upAxis = "Z"' aslant/run.usda && grep -q 'upAxis = "Z"' whole/run.usda || fail "which axis is up in USD"
  for up in auto y z; do kerf-view upright --up $up --size 80x60 --samples 1 -o up-$up.png || fail "kerf-view --up $up"; done
  cmp up-auto.png up-y.png && ! cmp -s up-auto.png up-z.png || fail "kerf-view does not stand a run up"
  # A run's folder is its own: nothing goes beside other files, or in place of one.
  mkdir empty others && touch empty/.hidden others/notes.txt
  expect 73 "others: holds other files, as 'notes.txt'; give another folder, or empty it" kerf-sim s.toml -o others
  expect 73 "holds other files" kerf-sim s.toml -o others/ --resume
  expect 73 "holds other files" kerf-sim s.toml -o .
  expect 73 "is not a folder" kerf-sim s.toml -o others/notes.txt
  [ "$(ls others)" = notes.txt ] || fail "others now has $(ls others)"
  quietly kerf-sim -q s.toml -o empty --frames 1
  touch empty/sheet.txt && quietly kerf-sim -q s.toml -o empty --frames 2 --resume
  # Boxes and blades that reach nothing are told.
  kerf-sim s.toml -o astray --frames 1 --set 'body.fixed=[[5,5,5,6,6,6]]' --set 'blade.0.keys=[[0,9,9,9,0,0,1,0],[1,9,9,9,0,0,1,0]]' 2>said.txt || fail "boxes that hold nothing"
  grep -q 'no node is in the box from (5, 5, 5) to (6, 6, 6)' said.txt && grep -q 'no blade met' said.txt || fail "kerf-sim says: $(cat said.txt)"
  # What would be noticed too late otherwise.
  expect 73 "are free" kerf-sim s.toml -o x --frames 100000000
  expect 73 "cannot be made" kerf-sim s.toml -o /proc/x
  # A model in millimetres, taken for metres.
  printf 'v 0 0 0\nv 400 0 0\nv 0 400 0\nv 0 0 400\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n' >mm.obj
  printf '[body]\nmesh = "mm.obj"\nnodes = 60\n[time]\nframes = 1\n' >mm.toml
  kerf-sim mm.toml -o mm 2>said.txt && grep -q '692.8 m across.*scale = 0.001' said.txt || fail "kerf-sim says of a model in mm: $(cat said.txt)"
  # One with a few large triangles.
  kerf-repair -q mm.obj --edge 0.1 -o fine.ply && kerf-sim mm.toml --set body.mesh=fine.ply -o fine 2>fine.txt || fail "kerf-repair --edge: $(cat fine.txt)"
  grep -q 'mm.obj has edges of up to 565.7, .* body.refine = .*, or kerf-repair --edge 0.1, gives it more' said.txt && ! grep -q 'has edges' fine.txt || fail "kerf-sim says of large triangles: $(cat said.txt fine.txt)"
  kerf-sim mm.toml --set body.scale=0.001 -o small 2>said.txt && ! grep -q across said.txt || fail "kerf-sim says of a scaled one: $(cat said.txt)"
  ;;
killed)
  # Ten kills at random moments, and a few polite ones (143: before it listens), with contact and without: the same bytes as a run that nobody disturbed.
  kerf-model block --edge 0.15 -o cube.ply
  RANDOM=${KERF_SEED:-$$}
  echo "KERF_SEED=${KERF_SEED:-$$}"
  for contact in false true; do
    printf '[contact]\nself = %s\n[body]\nmesh = "cube.ply"\nspacing = 0.15\n[time]\nframes = 20\nframe_rate = 40\nstep = 0.0125\ncheckpoint_every = 1\n[ground]\npoint = [0,0,-0.01]\n[[blade]]\npoints = [[0,-0.4,0],[0,1.4,0]]\ndivide = 4\nkeys = [[0.0,1.013,0.007,1.3,0,0,1,2],[0.45,1.013,0.011,-0.7,0,0,1,3]]\n' $contact >s.toml
    rm -rf whole killed
    kerf-sim -q -j1 s.toml -o whole || fail "kerf-sim"
    for signal in KILL KILL INT KILL KILL KILL TERM KILL KILL KILL KILL KILL; do
      setsid kerf-sim -q -j1 s.toml -o killed --resume >/dev/null 2>&1 </dev/null &
      pid=$!
      sleep "0.$(printf %03d $((RANDOM % 500)))"
      kill -$signal $pid 2>/dev/null
      wait $pid 2>/dev/null
      status=$?
      case $signal in KILL) ;; *) [ $status = 130 ] || [ $status = 0 ] || [ $status = 143 ] || fail "a run told to stop exits with $status" ;; esac
    done
    kerf-sim -q s.toml -o killed --resume || fail "kerf-sim --resume after twelve stops"
    find killed -name '*.tmp' -delete  # a killed program leaves what it was writing aside
    diff -r whole killed || fail "a run that was killed differs, contact $contact"
  done
  ;;
scene)
  # A scene of the paper, small: to its end, with the pieces that it must have, sound, at rest or finite; also with the time
  # step doubled and halved, and with material ten times softer and stiffer.
  scene=$5 file=$(dirname "$script")/../../samples/scenes/$5.toml bear=$models/bear.off
  mkdir models
  models=$PWD/models
  kerf-model pumpkin --frequency 10 -o models/pumpkin.ply
  kerf-model apple --frequency 10 -o models/apple.ply
  kerf-model polyp --frequency 8 -o models/polyp.ply
  kerf-score -q models/pumpkin.ply --pattern voronoi --pieces 6 -o models/smash.front
  kerf-model block --edge 0.16 -o models/jello.ply
  for letter in K E R F; do kerf-model letter --text $letter --depth 0.25 --resolution 12 -o models/letter-$letter.ply; done
  moves=0    # how far something must have gone at least
  frames=32
  soft=      # not empty: in material ten times softer, too, it parts in as many pieces (crumbs may come off besides), and one step at most is refused.
             # The latter is chance (one run of ten has more): it need hold at two of three accuracies only, all else at each
  cracks=0   # that begin by themselves
  refused=0  # steps; of a scene that breaks by itself up to three may be, which is chance, too: 4 of 20 runs at other accuracies and nodes have some
  # most: elastic energy, J; less than weight times the way that it falls
  case $scene in
  apple) young=3e5 pieces=1 most=3e3 moves=0.3 set="--set body.mesh=models/apple.ply --set body.nodes=600 --set time.accuracy=0.001" ;;  # so few nodes make a stiff peel: it slides, slowly
  peeled) young=3e5 pieces=2 most=3e3 moves=0.3 frames=72 set="--set body.mesh=models/apple.ply --set body.nodes=600" ;;  # to the end of the spiral
  collapse) young=1e5 pieces=4 most=2e3 moves=0.3 set="--set body.mesh=models/jello.ply --set body.nodes=300" ;;
  sliced) young=4e5 pieces=8 most=1e3 moves=0.3 frames=56 set="--set body.mesh=models/polyp.ply" ;;  # all ten strokes
  apple-clamped) young=3e5 pieces=1 most=3e3 moves=0.3 set="--set body.mesh=models/apple.ply --set body.nodes=600" ;;  # it bends off
  jello) young=2e5 pieces=4 most=1e3 soft=yes set="--set body.mesh=models/jello.ply --set body.nodes=300" ;;
  polyp) young=4e5 pieces=2 most=5e2 set="--set body.mesh=models/polyp.ply --set body.nodes=150" ;;
  halve) young=4e4 pieces=2 most=1e4 soft=yes set="--set body.mesh=models/pumpkin.ply --set body.nodes=200" ;;
  smashed) young=3e5 pieces=12 most=1e4 set="--set body.0.mesh=models/pumpkin.ply --set body.1.mesh=models/pumpkin.ply --set score.0.file=models/smash.front --set score.1.file=models/smash.front --set body.0.nodes=150 --set body.1.nodes=150" ;;
  drop) young=5e5 pieces=6 most=1e3 frames=10 set="--set body.mesh=$bear --set body.nodes=150 --set score.0.file=models/bear.front" && kerf-score -q $bear --pattern voronoi --pieces 6 -o models/bear.front ;;
  plate) young=2e7 pieces='[0-9]*' cracks='[1-9]' most=1e4 frames=16 set="--set body.mesh=models/plate.ply --set body.spacing=0.1" && kerf-model plate --edge 0.1 -o models/plate.ply ;;
  thrown) young=3e6 pieces='[0-9]*' cracks='[1-9]' refused='[0-3]' most=1e5 frames=12 set="--set body.mesh=models/pumpkin.ply --set body.nodes=200" ;;
  sag) young=1e6 pieces=4 most=1e3 moves=0.3 frames=16 set=$(for i in 0 1 2 3; do printf -- "--set body.$i.mesh=models/letter-$(echo KERF | cut -c $((i + 1))).ply --set body.$i.nodes=200 "; done) ;;
  letters) young=4e5 pieces=9 most=1e2 set=$(for i in 0 1 2 3; do printf -- "--set body.$i.mesh=models/letter-$(echo KERF | cut -c $((i + 1))).ply --set body.$i.nodes=200 "; done) ;;
  esac
  step=$(sed -n 's/^step = \([0-9.]*\).*/\1/p' $file) rate=$(sed -n 's/^frame_rate = //p' $file)
  times() { awk "BEGIN { printf \"%.9g\", $1 * $2 }"; }
  kerf-sim -q $file $set -o run --frames $frames || fail "$scene"
  crossing() { grep -q '^self = true' $file && grep -v '"crossings":0,' $1/frames.jsonl | head -1; }  # in scenes with contact nothing may, in any frame
  crossing run | grep . && fail "$scene has frames in which triangles cross"
  grep -q "\"pieces\":$pieces," run/summary.json || fail "$scene has not $pieces pieces: $(cat run/summary.json)"
  kerf-info --json run/checkpoint.kerf | grep -o '"displacement_max":[0-9.]*' | awk -F: -v least=$moves '$2 < least { exit 1 }' || fail "nothing of $scene goes as far as $moves"
  grep -q "\"refused\":$refused," run/summary.json || fail "$scene has refused steps: $(cat run/summary.json)"
  grep -q "\"cracks_begun\":$cracks" run/summary.json || fail "$scene has not cracks enough: $(cat run/summary.json)"
  grep -qi "nan\|inf" run/frames.jsonl && fail "$scene has numbers that are none"
  grep -o '"energy":[-+0-9.e]*' run/frames.jsonl | awk -F: -v most=$most '$2 > most { print "energy", $2; exit 1 }' || fail "$scene has more energy than $most J"
  kerf-info --check -q run/checkpoint.kerf || fail "the body of $scene is not sound"
  doubled=time.step=$(times $step 2)
  # A step is a frame at most: where it is one, there are half as many frames a second.
  awk "BEGIN { exit !(2 * $step * $rate > 1.05) }" && doubled="$doubled --set time.frame_rate=$(times $rate 0.5)"
  softer=material.young=${young%e*}e$((${young#*e} - 1))
  # otherwise OPTION...: the scene with these, and what must hold for each such run.
  otherwise() {
    rm -rf other
    kerf-sim -q $file $set "$@" -o other --frames $few || fail "$scene with $*"
    crossing other | grep . && fail "$scene with $* has frames in which triangles cross"
    grep -qi "nan\|inf" other/frames.jsonl && fail "$scene with $* has numbers that are none"
    kerf-info --check -q other/checkpoint.kerf || fail "the body of $scene with $* is not sound"
    [ -z "$whole" ] || [ "$(sed 's/.*"pieces":\([0-9]*\),.*/\1/' other/summary.json)" -ge $pieces ] || fail "$scene with $* has too few pieces: $(cat other/summary.json)"
  }
  few_refused() { grep -q '"refused":[01],' other/summary.json; }
  for other in "$doubled" time.step=$(times $step 0.5) $softer material.young=${young%e*}e$((${young#*e} + 1)); do
    few=$((frames < 12 ? frames : 12)) whole=
    [ -z "$soft" ] || [ "$other" != "$softer" ] || few=$frames whole=yes
    otherwise --set $other
    if [ -n "$whole" ] && ! few_refused; then
      kept=$(cat other/summary.json)
      for accuracy in 0.0009 0.0011; do
        otherwise --set $other --set time.accuracy=$accuracy
        few_refused || fail "$scene with $other has refused steps: $kept, and with accuracy $accuracy: $(cat other/summary.json)"
      done
    fi
    rm -rf other
  done
  ;;
*) fail "unknown test $what" ;;
esac
exit $failed
