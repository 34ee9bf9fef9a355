"""Reads a .glb by itself and checks what kerf-pieces promises: check_glb.py FILE.glb BONDS.json VOLUME PIECES

Chunks and accessors as glTF 2.0 has them, one named node a piece, each a closed mesh about its centroid, volumes that sum
to the model's, a material for the inside, whose texture coordinates are a projection along each wall's plane at one scale, convex
hulls, bonds in the scene's extras as in the JSON file.
"""
import json
import struct
import sys

data = open(sys.argv[1], "rb").read()
bonds, volume, count = json.load(open(sys.argv[2])), float(sys.argv[3]), int(sys.argv[4])
magic, version, total = struct.unpack_from("<4sII", data)
assert (magic, version, total) == (b"glTF", 2, len(data)), "header"
length, kind = struct.unpack_from("<I4s", data, 12)
assert kind == b"JSON" and length % 4 == 0
gltf = json.loads(data[20:20 + length])
size, kind = struct.unpack_from("<I4s", data, 20 + length)
assert kind == b"BIN\0" and 28 + length + size == len(data)
binary = data[28 + length:]
assert gltf["buffers"] == [{"byteLength": size}]
formats = {5126: "f", 5125: "I", 5123: "H"}
widths = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def read(index):
    accessor = gltf["accessors"][index]
    view = gltf["bufferViews"][accessor["bufferView"]]
    form, width = formats[accessor["componentType"]], widths[accessor["type"]]
    assert view["byteOffset"] % 4 == 0
    assert view["byteLength"] == accessor["count"] * width * struct.calcsize(form) and view["byteOffset"] + view["byteLength"] <= size
    flat = struct.unpack_from(f"<{accessor['count'] * width}{form}", binary, view["byteOffset"])
    return [flat[i:i + width] for i in range(0, len(flat), width)]


root = gltf["nodes"][gltf["scenes"][gltf["scene"]]["nodes"][0]]
pieces = [gltf["nodes"][i] for i in root["children"]]
assert len(pieces) == count and len({p["name"] for p in pieces}) == count
assert [m["name"] for m in gltf["materials"]].count("crack") == 1
inside = [m["name"] for m in gltf["materials"]].index("crack")
told = gltf["scenes"][0]["extras"]
assert told["bonds"] == bonds["bonds"] and len(told["pieces"]) == count
summed = 0.0
scales = []


def scale(p, t):
    """The larger singular value of the map from a triangle's plane to its texture coordinates; None of a needle."""
    u, v = ([b - a for a, b in zip(p[0], p[k])] for k in (1, 2))
    s, w = ([b - a for a, b in zip(t[0], t[k])] for k in (1, 2))
    dot = lambda a, b: sum(x * y for x, y in zip(a, b))
    area = dot(u, u) * dot(v, v) - dot(u, v) ** 2
    if area < 0.05 * dot(u, u) * dot(v, v) or area < 1e-10:
        return None
    # Of the pencil (texture's metric, plane's metric): x² area - x trace + determinant = 0.
    trace = dot(s, s) * dot(v, v) - 2 * dot(s, w) * dot(u, v) + dot(w, w) * dot(u, u)
    determinant = dot(s, s) * dot(w, w) - dot(s, w) ** 2
    return ((trace + max(0, trace * trace - 4 * area * determinant) ** 0.5) / (2 * area)) ** 0.5


for piece in pieces:
    edges, materials, doubled, moment = {}, set(), 0.0, [0.0] * 3
    places = {}
    for primitive in gltf["meshes"][piece["mesh"]]["primitives"]:
        materials.add(primitive["material"])
        corner = {name: read(at) for name, at in primitive["attributes"].items()}
        position = corner["POSITION"]
        bounds = gltf["accessors"][primitive["attributes"]["POSITION"]]
        assert tuple(map(min, zip(*position))) == tuple(struct.unpack("<3f", struct.pack("<3f", *bounds["min"])))
        assert tuple(map(max, zip(*position))) == tuple(struct.unpack("<3f", struct.pack("<3f", *bounds["max"])))
        assert all(abs(sum(x * x for x in n) - 1) < 1e-5 for n in corner["NORMAL"])
        index = [i for i, in read(primitive["indices"])]
        assert max(index) < len(position) and len({len(values) for values in corner.values()}) == 1
        for t in range(0, len(index), 3):
            a, b, c = (position[i] for i in index[t:t + 3])
            for p, q in ((a, b), (b, c), (c, a)):
                edges[p, q] = edges.get((p, q), 0) + 1
            six = (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]))
            doubled += six
            if primitive["material"] == inside:
                scales.append(scale((a, b, c), [corner["TEXCOORD_0"][i] for i in index[t:t + 3]]))
            moment = [m + six * (p + q + r) / 4 for m, p, q, r in zip(moment, a, b, c)]
    assert all(edges.get((q, p)) == n for (p, q), n in edges.items()), piece["name"] + " is open"
    assert inside in materials
    assert abs(doubled / 6 - piece["extras"]["volume"]) < 1e-5 * volume
    assert all(abs(m / doubled) < 1e-4 * volume ** (1 / 3) for m in moment), piece["name"] + " is not about its centroid"
    hulls = [gltf["nodes"][child] for child in piece["children"]]
    several = len(hulls) > 1
    assert [h["name"] for h in hulls] == ["UCX_" + piece["name"] + (f"_{k:02}" if several else "") for k in range(len(hulls))]
    summed += piece["extras"]["volume"]
scales = [x for x in scales if x is not None]
assert len(scales) > 100 and max(scales) < 1.01 * min(scales), f"texture scales from {min(scales)} to {max(scales)}"
assert abs(summed - volume) < 1e-12 * volume
print(f"{count} pieces, {len(told['bonds'])} bonds")
