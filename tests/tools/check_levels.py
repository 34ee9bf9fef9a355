"""Checks the hierarchy that kerf-pieces writes: check_levels.py FILE.glb BONDS.json FIGURES.json VOLUME LEAST

Nodes are nested as the JSON says, each piece is below one cluster of each level, volumes add up, no piece is below the
least, and bonds between clusters are sums of those between their pieces.
"""
import json
import math
import struct
import sys

data = open(sys.argv[1], "rb").read()
told, figures = json.load(open(sys.argv[2])), json.load(open(sys.argv[3]))
volume, least = float(sys.argv[4]), float(sys.argv[5])
gltf = json.loads(data[20:20 + struct.unpack_from("<I", data, 12)[0]])
assert gltf["scenes"][0]["extras"] == told
pieces, levels = told["pieces"], told["levels"]
assert figures["pieces"] == len(pieces) < 12 and figures["joined"] == 12 - len(pieces) and figures["isolated"] == 0
assert figures["clusters"] == [len(level["clusters"]) for level in levels] and figures["clusters"][-1] == 1
assert min(p["volume"] for p in pieces) >= least * volume
near = lambda a, b: abs(a - b) <= 1e-9 * max(abs(a), abs(b), 1)
below = pieces
for level in levels:
    for i, cluster in enumerate(level["clusters"]):
        members = [m for m in below if m["parent"] == i]
        assert members and near(sum(m["volume"] for m in members), cluster["volume"])
        for k in range(3):
            assert near(sum(m["volume"] * m["centroid"][k] for m in members), cluster["volume"] * cluster["centroid"][k])
    below = level["clusters"]
assert near(below[0]["volume"], volume) and "parent" not in below[0]
of = [p["parent"] for p in pieces]
for level in levels:
    sums = {}
    for bond in told["bonds"]:
        key = tuple(sorted((of[bond["a"]], of[bond["b"]])))
        if key[0] != key[1]:
            sums[key] = sums.get(key, 0) + bond["strength"]
    assert sums.keys() == {(b["a"], b["b"]) for b in level["bonds"]}
    assert all(near(b["strength"], sums[b["a"], b["b"]]) for b in level["bonds"])
    of = [level["clusters"][c].get("parent", 0) for c in of]

places = {}


def walk(index, origin, path):
    node = gltf["nodes"][index]
    here = [a + b for a, b in zip(origin, node.get("translation", [0, 0, 0]))]
    places[node["name"]] = (here, path)
    for child in node.get("children", []):
        walk(child, here, path + [node["name"]])


walk(gltf["scenes"][0]["nodes"][0], [0, 0, 0], [])
for piece in pieces:
    here, path = places[piece["node"]]
    first = levels[0]["clusters"][piece["parent"]]
    assert path == ["pieces", levels[1]["clusters"][first["parent"]]["name"], first["name"]]
    assert math.dist(here, piece["centroid"]) < 1e-9
for level in levels:
    for cluster in level["clusters"]:
        assert math.dist(places[cluster["name"]][0], cluster["centroid"]) < 1e-9
for bond in told["bonds"]:  # the two ends of each joint are at the bond's centroid
    a, b = pieces[bond["a"]]["node"], pieces[bond["b"]]["node"]
    for name in (f"{a}_to_{b}", f"{b}_to_{a}"):
        assert math.dist(places[name][0], bond["centroid"]) < 1e-9
    assert bond["torque"] > 0
