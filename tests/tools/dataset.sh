#!/bin/bash
# kerf-dataset: what it writes, checked with NumPy; threads, shards, kills and restarts give the same bytes; refusals.
#   dataset.sh TOOLS_DIR SAMPLES_DIR
set -u
PATH=$1:$2:$PATH
here=$(cd "$(dirname "$0")" && pwd)
stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT
cd "$stage"
fail() { echo "FAILED: $1" >&2; exit 1; }
expect() {  # expect CODE REGEX COMMAND...: this exit code, one line on standard error that matches
  local code=$1 said=$2; shift 2
  "$@" >/dev/null 2>said.txt </dev/null
  [ $? = "$code" ] || fail "$*: not exit $code: $(cat said.txt)"
  grep -q -- "$said" said.txt && [ "$(wc -l <said.txt)" = 1 ] || fail "$*: does not say '$said': $(cat said.txt)"
}
python() { PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 "$@"; }  # that of the packages, with NumPy

kerf-model pumpkin --frequency 4 -o pumpkin.ply && kerf-model apple --frequency 4 -o apple.ply &&
  kerf-model block --edge 0.25 -o block.ply || fail "models"
volumes=$(for m in pumpkin apple block; do printf '"%s": %s,' $m "$(kerf-info --json $m.ply | grep -o '"volume":[-0-9.e]*' | cut -d: -f2)"; done)
volumes="{${volumes%,}}"
some="pumpkin.ply apple.ply block.ply --patterns voronoi,planes --seeds 6 --per-shard 2 --pieces 3:9 --jagged 0:0.02"

# Archives: sound; the same from one thread, from parts, and after a kill at any moment.
kerf-dataset $some --json -o whole >figures.json || fail "kerf-dataset"
python -c 'import json; f = json.load(open("figures.json")); assert f["made"] == 36 and f["failed"] == 0 and f["complete"] and f["bytes"] > 1e5, f' || fail "--json: $(cat figures.json)"
python "$here/check_dataset.py" whole "$volumes" || fail "the data set"
{ sed -n '/^```python/,/^```/p' "$here/../../docs/datasets.md" | grep -v '^```'; cat <<'END'; } >loading.py
import glob
found = list(fractures(glob.glob("whole/*/pumpkin-planes-3.npz")[0]))
assert [seed for seed, *_ in found] == [3, 4]
for _, pieces, bonds, area, walls in found:
    assert len(bonds) == len(area) == len(walls) > 0 and bonds.max() < len(pieces)
    for k in range(len(bonds)):
        assert {p for p in range(len(pieces)) if (pieces[p][2] == k + 1).any()} == set(bonds[k])
        (v, t, _), (w, u, _) = (pieces[p] for p in bonds[k])
        assert np.array_equal(v[t[walls[k][:, 0]]], w[u[walls[k][:, 1]]][:, [0, 2, 1]])
try:
    import torch
    archive = np.load(glob.glob("whole/*/pumpkin-planes-3.npz")[0])
    assert all(len(torch.from_numpy(archive[name])) == len(archive[name]) for name in archive)
except ImportError:
    print("no torch is installed: not tried")
END
python loading.py || fail "the code of docs/datasets.md"
[ -e whole/unfinished ] && fail "whole/unfinished is left"
kerf-dataset $some -j1 -o one && diff -r whole one || fail "threads change bytes"
for part in 2/3 1/3 3/3; do kerf-dataset $some --shard $part -o parts || fail "--shard $part"; done
diff -r whole parts || fail "parts change bytes"
killed=0
for pause in 0.05 0.1 0.2 0.3 0.4; do
  kerf-dataset $some -j1 -o killed 2>/dev/null &
  sleep $pause
  kill -9 $! 2>/dev/null && killed=$((killed + 1))
  wait $! 2>/dev/null
done
[ $killed -gt 0 ] || fail "nothing was killed"
kerf-dataset $some --json -o killed >figures.json || fail "a killed data set cannot be completed"
find killed -name '*.tmp' -delete  # a killed program leaves what it was writing aside
diff -r whole killed || fail "a kill changes bytes"
rm -r killed/*/pumpkin-planes-5.* killed/summary.json
kerf-dataset $some --json -o killed >figures.json && diff -r whole killed || fail "a removed shard is made otherwise"
python -c 'import json; f = json.load(open("figures.json")); assert f["made"] == 2 and f["found"] == 34, f' || fail "a shard more than the missing one was made"
expect 65 "other models or options" kerf-dataset $some --bumps 5 -o whole
diff -r whole one || fail "a refused call changes a data set"

# The recorded command makes the same pieces.
python - <<'END' || fail "the recorded command makes another fracture"
import json, pathlib, subprocess, numpy as np
record = next(pathlib.Path("whole").glob("*/apple-voronoi-3.json"))
entry, z = json.loads(record.read_text())["fractures"][1], np.load(record.with_suffix(".npz"))
subprocess.run(entry["command"].replace("-o broken.ply", "-o ../broken.ply"), shell=True, check=True, cwd="whole")
subprocess.run("kerf-pieces broken.ply -o pieces", shell=True, check=True)
made = [p["volume"] for p in json.load(open("pieces/pieces.json"))["pieces"]]
assert np.allclose(made, z["piece_volume"][z["fracture_pieces"][1]:], rtol=1e-12), made
END

# A repaired model: the intact one is the one that was broken; command and sources are of it.
kerf-repair -q apple.ply -o apple.obj && head -n -7 apple.obj >"a b's.obj" || fail "a model with a hole"
expect 1 "no fracture could be made" kerf-dataset -q "a b's.obj" --seeds 2 --pieces 3 -o refused
kerf-dataset -q "a b's.obj" --seeds 2 --pieces 3 --repair -o repaired || fail "--repair"
python - <<'END' || fail "--repair: command or sources"
import json, pathlib, subprocess, numpy as np
record = next(pathlib.Path("repaired").glob("train/*.json"))
entry, z = json.loads(record.read_text())["fractures"][1], np.load(record.with_suffix(".npz"))
subprocess.run(entry["command"], shell=True, check=True, cwd="repaired")
told = subprocess.run(["kerf-info", "--json", "repaired/models/a b's.ply"], check=True, capture_output=True, text=True).stdout
assert -1 in z["face_source"] and z["face_source"].max() == json.loads(told)["faces"] - 1, z["face_source"].max()
END

# A shard in which all failed is an archive without rows, which no list names.
python - <<'END' || fail "a shard in which all failed"
import pathlib, numpy as np
archive = np.load(next(pathlib.Path("refused").glob("*/*.npz")))
assert all(len(archive[name]) == name.startswith(("fracture_", "piece_vertices", "piece_faces", "bond_walls")) for name in archive), dict(archive)
assert not any(path.read_text() for path in pathlib.Path("refused/data_split").iterdir())
END

# Chips and detail at edges: drawn for each fracture, in the record's command, which makes the same pieces.
kerf-dataset -q block.ply --seeds 3 --pieces 4:6 --chips 2:5 --chip-size 0.2 --edge-detail 0:0.004 --edge-width 0.05 -o chipped || fail "--chips"
python "$here/check_dataset.py" chipped "$volumes" || fail "chips and detail"
python - <<'END' || fail "a command with chips makes another fracture"
import json, pathlib, re, subprocess, numpy as np
record = next(pathlib.Path("chipped").glob("train/*.json"))
entries, z = json.loads(record.read_text())["fractures"], np.load(record.with_suffix(".npz"))
chips = [int(re.search("--chips ([0-9]+) --chip-size 0.2 ", entry["command"])[1]) for entry in entries]
assert all(2 <= n <= 5 and entry["pieces"] == entry["wanted"] + n for n, entry in zip(chips, entries)), chips
subprocess.run(entries[2]["command"].replace("-o broken.ply", "-o ../broken.ply"), shell=True, check=True, cwd="chipped")
subprocess.run("kerf-pieces broken.ply -o chips", shell=True, check=True)
made = [p["volume"] for p in json.load(open("chips/pieces.json"))["pieces"]]
assert np.allclose(made, z["piece_volume"][z["fracture_pieces"][2]:], rtol=1e-12), made
settings = json.load(open("chipped/dataset.json"))
assert settings["chips"] == [2, 5] and "chips" not in json.load(open("whole/dataset.json"))
END

# No set with a share is empty as long as there are models; one that is empty is told.
for name in a b c d; do cp apple.ply $name.ply; done
for models in "a.ply b.ply c.ply" "b.ply c.ply d.ply" "d.ply c.ply a.ply b.ply"; do
  rm -rf sets && kerf-dataset -q $models --seeds 1 --pieces 2 -o sets || fail "$models"
  for set in train val test; do [ -s sets/data_split/shapes.$set.txt ] || fail "$models: $set is empty"; done
done
for name in a b c d; do
  rm -rf sets && kerf-dataset $name.ply --seeds 1 --pieces 2 -o sets 2>said.txt && [ -s sets/data_split/shapes.train.txt ] || fail "$name: train is empty"
  grep -q "shapes.val.txt is empty" said.txt && grep -q "shapes.test.txt is empty" said.txt || fail "empty sets are not told: $(cat said.txt)"
done

# Rotated pieces, single precision; folders of PLY files.
kerf-dataset apple.ply block.ply --seeds 3 --pieces 4 --rotate --single -o posed && python "$here/check_dataset.py" posed "$volumes" || fail "--rotate --single"
python -c 'import glob, numpy as np; z = np.load(glob.glob("posed/*/apple-*.npz")[0]); assert z["vertices"].dtype == np.float32 and abs(z["piece_rotation"][:, 0]).max() < 1 and np.allclose(np.linalg.norm(z["piece_rotation"], axis=1), 1)' || fail "rotations"
# Single precision would part the pieces of a model that is far from the origin.
printf 'v 691234 5401234 0\nv 691235 5401234 0\nv 691234 5401235 0\nv 691234 5401234 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' >far.obj
kerf-dataset far.obj --seeds 1 --pieces 2 --single -o far || fail "a model far from the origin"
python -c 'import glob, numpy as np; assert np.load(glob.glob("far/*/far-*.npz")[0])["vertices"].dtype == np.float64' || fail "--single far from the origin"
kerf-dataset apple.ply block.ply --patterns voronoi,bricks --seeds 2 --pieces 4 --layout folders --split 50,0,50 -o folders && python "$here/check_dataset.py" folders "$volumes" || fail "--layout folders"
kerf-info --check -q folders/shapes/apple/intact.ply || fail "the intact model"
[ "$(cat folders/data_split/shapes.{train,val,test}.txt | sort)" = "$(printf 'shapes/apple\nshapes/block')" ] || fail "data_split"
kerf-info --check -q folders/shapes/apple/fractured_3/piece_0.ply || fail "a piece"
cp -r folders again && rm again/shapes/block/labels_1.json again/summary.json
kerf-dataset apple.ply block.ply --patterns voronoi,bricks --seeds 2 --pieces 4 --layout folders --split 50,0,50 -o again && diff -r folders again || fail "folders made anew differ"

# What cannot be used is listed, and the others are made.
kerf-info -q apple.ply && head -c 2000 apple.ply >torn.ply && printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' >open.off
printf '# three\nbad/torn\ttorn.ply\nopen.off\r\n\nfruit/apple\tapple.ply\n' >list.txt
kerf-dataset list.txt --seeds 2 --pieces 3 --json -o mixed >figures.json 2>said.txt || fail "a list with models that cannot be used: $(cat said.txt)"
grep -q '4 fractures failed, 2 models refused, which --repair may mend; reasons' said.txt || fail "of refused models: $(cat said.txt)"
grep -qP '^open\tvoronoi\t1..2\tthe surface is open' mixed/failed.txt && grep -qP '^bad/torn\tvoronoi\t1..2\t' mixed/failed.txt || fail "failed.txt: $(cat mixed/failed.txt)"
python "$here/check_dataset.py" mixed "{\"fruit/apple\": $(kerf-info --json apple.ply | grep -o '"volume":[-0-9.e]*' | cut -d: -f2)}" || fail "the mixed data set"
expect 1 "no fracture could be made" kerf-dataset -q open.off --seeds 2 -o none
kerf-dataset -q list.txt --seeds 2 --pieces 3 -o mixed 2>said.txt || fail "a complete data set: $(cat said.txt)"

# Refusals before any work; nothing is left.
for options in "--pieces 1" "--pieces 9:3" "--pieces 2.5" "--pieces x" "--jagged 1" "--jagged nan" "--jagged 0:0.1:2" "--seeds 0" "--patterns red" "--patterns voronoi,voronoi" "--patterns curves" "--split 80,10,11" "--split 1" "--shard 0/2" "--shard 3/2" "--shard -1/2" "--per-shard 0" "--attempts 0" "--bumps 0" "--chips -1" "--chips 1:2.5" "--edge-detail 1" "--chip-size 0.2" "--edge-width 0.1" "--chip-size 0 --chips 3"; do
  expect 2 "${options%% *}" kerf-dataset apple.ply $options -o x
done
expect 2 "give a folder" kerf-dataset apple.ply
expect 2 "MODELS is required" kerf-dataset -o x
expect 2 "writes a folder, not .glb" kerf-dataset apple.ply -o x.glb
expect 66 "missing.ply: cannot" kerf-dataset missing.ply -o x
expect 66 "none.txt: cannot" kerf-dataset none.txt -o x
expect 65 "two models are called 'apple'" kerf-dataset apple.ply list.txt apple.ply -o x
for name in ../up /root a//b a/../b fractured_1/a; do
  printf '%s\tapple.ply\n' "$name" >evil.txt
  expect 65 "evil.txt:1: the model's name" kerf-dataset evil.txt -o x
done
printf '\0\1\2' >evil.txt && expect 65 "evil.txt:1: is no text" kerf-dataset evil.txt -o x
echo '#' >evil.txt && expect 65 "lists no model" kerf-dataset evil.txt -o x
[ -e x ] && fail "a refusal leaves x"
touch file && expect 73 "is not a folder" kerf-dataset apple.ply -o file
mkdir full && touch full/other && expect 65 "is not empty, and no data set" kerf-dataset apple.ply -o full
echo "kerf-dataset is as it should be"
