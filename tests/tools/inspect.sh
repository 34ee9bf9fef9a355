#!/bin/bash
# kerf-info on every kind of file: what it says of parts and differences, and its exports in other programs' readers.
#   tests/tools/inspect.sh TOOLS_DIR SAMPLES_DIR
set -u
here=$(dirname "$(realpath "$0")")
. "$here/answers.sh"
PATH=$(realpath "$1"):$(realpath "$2"):$PATH
export PYTHONDONTWRITEBYTECODE=1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1

kerf-model pumpkin --frequency 8 -o p.ply
kerf-model front --around p.ply --steps 8 -o halve.front
kerf-sample p.ply -n 400 -o nodes.pcd
kerf-graph nodes.pcd --surface p.ply -o p.kerf
kerf-crack p.ply --front halve.front --steps 0:5 -o half.ply
kerf-crack p.ply --front halve.front -o whole.ply
kerf-update p.kerf --surface half.ply -o half.kerf
kerf-update p.kerf --surface whole.ply -o whole.kerf

# For people first, then the keys.
says '^A closed surface: 1,280 triangles of skin, 1 piece; ' kerf-info p.ply
says '^A closed surface: .* 1 crack of [0-9]+ triangles that ends inside, 1 piece; .* 1 front can go on' kerf-info half.ply
says '^A body of 2 pieces: .* 1 crack' kerf-info whole.kerf
says '^1 front of 9 time steps; ' kerf-info halve.front
says '^[0-9]+ nodes, ' kerf-info nodes.pcd
says '^kind  *body$' kerf-info whole.kerf
says '"history":\["kerf-graph [0-9.]*","kerf-update [0-9.]*"\]' kerf-info --json half.kerf
[ "$(kerf-info --json whole.kerf | wc -l)" = 1 ] || fail "--json says more than a line"
# Distributions: every edge and node is in a bin.
kerf-info --json --histogram half.kerf | python3 -c '
import json, sys
j = json.load(sys.stdin)
assert sum(j["radii"]["counts"]) == sum(j["neighbors"]["counts"]) == j["nodes"] and sum(j["edge_lengths"]["counts"]) == j["edges"], j
assert j["neighbors"]["lo"] == j["neighbors_min"] and j["neighbors"]["hi"] == j["neighbors_max"]
assert abs(j["neighbors"]["mean"] - j["neighbors_mean"]) < 0.006' || fail "histograms of a body"
says '█' kerf-info --histogram half.ply
# One node, edge, vertex: the same from both ends, and what the whole says.
python3 - <<'P' || fail "nodes, edges and vertices of a body"
import json, subprocess
ask = lambda *words: json.loads(subprocess.run(["kerf-info", "--json", "half.kerf", *map(str, words)], check=True, capture_output=True).stdout)
blocked = 0
for i in range(0, 400, 57):
    node = ask("--node", i)
    for n in node["neighbors"][::5]:
        pair = ask("--edge", n["node"], i)
        assert pair["distance"] == n["distance"] and pair["visible"] == n["seen"] == (pair["faces"] == []), (node, pair)
        assert pair["edge"] == (n["node"] in node["edges"])
        assert pair["distance"] >= pair["straight"] * (1 - 1e-6)
        blocked += not n["seen"]
    for v in node["masters"]:
        assert ask("--vertex", v)["master_node"] == i
way = next(w for w in (ask("--vertex", v)["way"] for v in range(200)) if len(w) > 1)
assert ask("--vertex", way[-1])["way"] == way[-1:]
P
says '"triangles":\[[0-9,]+\].*"site":7' kerf-info --json half.ply --vertex 7
# Several files: a sentence or a line of JSON each; one that is damaged stops none.
says '^whole.kerf: A body of 2 pieces' kerf-info halve.front whole.kerf p.ply
kerf-info --json halve.front whole.kerf p.ply | python3 -c 'import json, sys; assert [json.loads(line)["file"] for line in sys.stdin] == ["halve.front", "whole.kerf", "p.ply"]' || fail "--json of several files"
head -c 300 p.ply >damaged.ply
kerf-info --check damaged.ply whole.kerf >told.txt 2>why.txt && fail "a damaged file among others passes"
grep -q '^whole.kerf: ' told.txt && grep -q 'damaged.ply:.*truncated' why.txt && grep -q '1 of 2 files' why.txt || fail "several files: $(cat told.txt why.txt)"
kerf-score -q p.ply --pieces 4 -o walls.front
says '^1 sheet of [0-9]+ triangles; [0-9]+ points\.$' kerf-info walls.front
# A node behind the crack is behind a face of it.
python3 - <<'P' || fail "no pair behind a crack"
import json, subprocess
told = json.loads(subprocess.run(["kerf-info", "--json", "--diff", "p.kerf", "half.kerf"], capture_output=True).stdout)
assert not told["same"] and told["edges_cut"] > 0 and told["pieces"] == [1, 1] and told["nodes"][1] - told["nodes"][0] == told["nodes_added"]
assert told["edges"][1] - told["edges"][0] == told["edges_drawn"] - told["edges_cut"]
pairs = [p for p in told["edges_cut_first"]]
seen = [json.loads(subprocess.run(["kerf-info", "--json", "half.kerf", "--edge", *map(str, p)], check=True, capture_output=True).stdout) for p in pairs]
assert any(f["crack"] == 1 for s in seen for f in s["faces"]) and not any(s["edge"] for s in seen)
P
says '^The same body' kerf-info --diff half.kerf half.kerf
kerf-info --diff half.kerf whole.kerf >told.txt 2>why.txt
[ $? = 1 ] || fail "bodies that differ do not end --diff with 1"
grep -q '1 piece → 2' told.txt || fail "--diff says $(cat told.txt)"
grep -q '^kerf-info: half.kerf: differs from whole.kerf$' why.txt || fail "--diff says $(cat why.txt)"
# A scene, and the folder of a run.
printf '[body]\nmesh = "p.ply"\nnodes = 200\n[time]\nframes = 2\nframe_rate = 20\nstep = 0.05\n[[blade]]\nname = "knife"\npoints = [[-1.4,0.02,0],[1.4,0.04,0]]\ndivide = 5\nkeys = [[0.0,0.013,0.021,1.3,0,0,1,8],[0.2,0.017,0.013,-0.3,0,0,1,11]]\n' >s.toml
says '^A scene: 1 body and 1 blade, 2 frames' kerf-info --check s.toml
kerf-sim -q s.toml -o run || fail "kerf-sim"
says '^A run: 3 frames, and a checkpoint .* frame 2, ' kerf-info --check run
says '"kind":"run","frames":3,.*"body":\{"kind":"body"' kerf-info --json run
says 'The checkpoint of a run at frame 2' kerf-info run/checkpoint.kerf
head -c 2000 run/frames/frame_0001.ply >cut && mv cut run/frames/frame_0001.ply
refuses 65 'frame_0001.ply' kerf-info --check run
printf '[body]\nmesh = "none.ply"\n' >none.toml
refuses 66 'none.ply' kerf-info --check none.toml
mkdir empty
refuses 65 'neither frames nor a checkpoint' kerf-info empty
# Wrong use and what is not there.
refuses 65 'no node 99999; the last is' kerf-info half.kerf --node 99999
refuses 65 'no surface vertex 99999' kerf-info half.kerf --vertex 99999
refuses 65 'two different' kerf-info half.kerf --edge 3 3
refuses 65 'no body' kerf-info half.ply --node 1
refuses 2 'two nodes' kerf-info half.kerf --edge 3
refuses 2 "'x' is not" kerf-info half.kerf --edge 3 x
refuses 2 'two bodies' kerf-info half.kerf --diff
refuses 2 'one file' kerf-info half.kerf whole.kerf --node 1
refuses 2 'one of' kerf-info half.kerf --node 1 --vertex 2
refuses 2 'give a file' kerf-info
# The exports, in the readers that people have: Debian's, of Debian's Python.
for format in npz vtu hdf ply; do kerf-info half.kerf --export e.$format || fail "--export e.$format"; done
kerf-info --json half.kerf >told.json
/usr/bin/python3 "$here/check_readers.py" half.kerf e told.json || fail "exports in their readers"
for format in peridigm perilab peridynamics; do
  kerf-info half.kerf --export e.$format --horizon 2.5 || fail "--export e.$format"
done
/usr/bin/python3 "$here/check_peridynamics.py" e || fail "bonds for peridynamics"
refuses 65 'from 1 to 20' kerf-info half.kerf --export f.peridigm --horizon 0
refuses 73 'e.peridigm' kerf-info half.kerf --export e.peridigm
refuses 2 'not .*x.xyz' kerf-info half.kerf --export x.xyz
exit $failed
