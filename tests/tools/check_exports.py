"""check_exports.py BODY.kerf STEM: that STEM.json, .npz, .ply and .vtu hold what the body does."""
import ast, json, struct, sys, zipfile
import xml.etree.ElementTree as xml
from read_kerf import numbers, read_kerf, aligned

body, stem = read_kerf(sys.argv[1]), sys.argv[2]


def flat(rows):
    return [x for row in rows for x in row] if rows and isinstance(rows[0], list) else rows


single = lambda xs: [struct.unpack("<f", struct.pack("<f", x))[0] for x in xs]
exported = json.load(open(stem + ".json"))
assert set(exported) == set(body)
for name, section in body.items():
    if section[0] == "json":
        assert exported[name] == json.loads(section[2])
    else:
        read = flat(exported[name])
        assert (single(read) if section[0] == "f4" else read) == numbers(section), name

archive = zipfile.ZipFile(stem + ".npz")
assert archive.testzip() is None
assert len(archive.namelist()) == len(body)
for name, (dtype, shape, data) in body.items():
    if dtype == "json":
        assert archive.read(name + ".json") == data
        continue
    npy = archive.read(name + ".npy")
    assert npy[:8] == b"\x93NUMPY\x01\0"
    size = struct.unpack_from("<H", npy, 8)[0]
    assert (10 + size) % 64 == 0 and npy[9 + size:10 + size] == b"\n"
    header = ast.literal_eval(npy[10:10 + size].decode())
    assert header == {"descr": ("|" if dtype == "u1" else "<") + dtype, "fortran_order": False, "shape": tuple(shape)}
    assert npy[10 + size:] == data, name

position, count, to, bits = (numbers(body[name]) for name in ("nodes/position", "graph/count", "graph/to", "graph/bits"))
nodes, edges, at = len(count), [], 0
for i, n in enumerate(count):
    edges += [(i, j) for j, b in zip(to[at:at + n], bits[at:at + n]) if j > i and b & 0x8000]
    at += n
fields = {name: numbers(body["nodes/" + name]) for name in ("radius", "spacing", "volume", "debris")}

data = open(stem + ".ply", "rb").read()
begin = data.index(b"end_header\n") + 11
assert b"element vertex %d\n" % nodes in data[:begin] and b"element edge %d\n" % len(edges) in data[:begin]
row = struct.Struct("<6dBI")
for i in range(nodes):
    values = row.unpack_from(data, begin + i * row.size)
    assert list(values[:3]) == position[3 * i:3 * i + 3]
    assert values[3:7] == tuple(fields[name][i] for name in ("radius", "spacing", "volume", "debris"))
assert sorted(struct.iter_unpack("<II", data[begin + nodes * row.size:])) == sorted(edges)

data = open(stem + ".vtu", "rb").read()
begin, end = data.index(b'encoding="raw">\n_') + 17, data.rindex(b"\n  </AppendedData>")
tree = xml.fromstring(data[:begin - 1] + data[end:])
piece = tree.find("UnstructuredGrid/Piece")
assert tree.get("header_type") == "UInt64" and int(piece.get("NumberOfPoints")) == nodes and int(piece.get("NumberOfCells")) == len(edges)
values, expected = {}, begin
for part in tree.iter("DataArray"):
    at = begin + int(part.get("offset"))
    assert at == expected
    size = struct.unpack_from("<Q", data, at)[0]
    expected = at + 8 + size
    letter = {"Float64": "d", "UInt8": "B", "UInt32": "I", "Int64": "q"}[part.get("type")]
    values[part.get("Name")] = [x for x, in struct.iter_unpack("<" + letter, data[at + 8:expected])]
assert expected == end
assert values["Points"] == position
for name, field in fields.items():
    assert values[name] == field, name
ends = values["connectivity"]
assert sorted(zip(ends[::2], ends[1::2])) == sorted(edges)
assert values["offsets"] == list(range(2, 2 * len(edges) + 1, 2)) and set(values["types"]) == {3}
assert len(set(values["component"])) >= 1 and values["component"][0] == 0
