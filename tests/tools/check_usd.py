"""check_usd.py RUN: the USD file of a run folder says in each frame what the frame's PLY files do; prints how many values were compared."""
import json, os, re, sys
import numpy

run = sys.argv[1]
text = open(os.path.join(run, "run.usda")).read()


# The prims of the layer, each with its own lines, by their path.
def prims(lines):
    found, path, depth = {}, [], 0
    for line in lines:
        begin = re.match(r'\s*def (\w+) "(\w+)"', line)
        if begin:
            path.append((depth, begin[2]))
            found["/" + "/".join(name for _, name in path)] = (begin[1], [])
        elif path:
            found["/" + "/".join(name for _, name in path)][1].append(line)
        if line.endswith(("{", "(")):
            depth += 1
        if line.strip() in ("}", ")"):
            depth -= 1
            if line.strip() == "}" and path and path[-1][0] == depth:
                path.pop()
    assert depth == 0 and not path, "brackets do not match"
    return found


# Per frame an array of numbers: a sample holds until the next.
def samples(lines, name, frames):
    at = next(i for i, line in enumerate(lines) if name + ".timeSamples = {" in line)
    values, last = {}, None
    for line in lines[at + 1:]:
        if line.strip() == "}":
            break
        frame, rest = line.strip().rstrip(",").split(": ", 1)
        assert rest[0] == "[" and rest[-1] == "]" and (not values or int(frame) > max(values))
        values[int(frame)] = numpy.fromstring(rest.translate(str.maketrans("()[]", "    ")), sep=",")
    result = []
    for i in range(frames):
        last = values.get(i, last)
        result.append(last)
    return result


# Points, corners and patches of a frame; its lists are corners (three) and their texture coordinates (six).
def ply(path):
    head, body = open(path, "rb").read().split(b"end_header\n", 1)
    codes = {"char": "i1", "uchar": "u1", "int": "<i4", "uint": "<u4", "float": "<f4", "double": "<f8"}
    at, tables = 0, {}
    for name, count, rows in re.findall(r"element (\w+) (\d+)\n((?:property .*\n)*)", head.decode()):
        fields = []
        for words in map(str.split, rows.splitlines()):
            if words[1] == "list":
                fields += [("count of " + words[4], codes[words[2]]), (words[4], codes[words[3]], 6 if words[4] == "texcoord" else 3)]
            else:
                fields.append((words[2], codes[words[1]]))
        tables[name] = numpy.frombuffer(body, numpy.dtype(fields), int(count), at)
        at += tables[name].nbytes
    assert at == len(body), path
    vertex, face = tables["vertex"], tables["face"]
    return numpy.stack([vertex[k] for k in "xyz"], 1), face["vertex_indices"].ravel(), face["patch"] if "patch" in face.dtype.names else numpy.zeros(len(face), int)


found = prims(text.splitlines())
assert text.startswith("#usda 1.0\n") and 'defaultPrim = "run"' in text and found["/run"][0] == "Xform"
frames = int(re.search(r"endTimeCode = (\d+)", text)[1]) + 1
names = sorted(os.listdir(os.path.join(run, "frames")))
assert frames == len(names) > 1
kind, body = found["/run/body"]
subsets = [prim for prim, (kind_, _) in found.items() if kind_ == "GeomSubset"]
assert kind == "Mesh" and "/run/body/crack" in subsets and len(subsets) > 1
for prim, (_, lines) in found.items():
    for target in re.findall(r"rel material:binding = <(.*)>", "\n".join(lines)):
        assert found[target][0] == "Material", (prim, target)
points, counts, corners, patch = (samples(body, name, frames) for name in ("points", "faceVertexCounts", "faceVertexIndices", "primvars:patch"))
crack = samples(found["/run/body/crack"][1], "indices", frames)
# The skin is one subset, or one for each material of the model; together they have each of its triangles once.
parts = [samples(found[prim][1], "indices", frames) for prim in subsets if prim != "/run/body/crack"]
skin = [numpy.sort(numpy.concatenate([part[i] for part in parts])) for i in range(frames)]
textured = any("primvars:st.timeSamples" in line for line in body)
texture = samples(body, "primvars:st", frames) if textured else None
compared = 0
for i, name in enumerate(names):
    path = os.path.join(run, "frames", name)
    at, corner, which = ply(path)
    assert numpy.abs(points[i].reshape(-1, 3) - at).max() <= 1e-6 * numpy.abs(at).max(), name
    assert (corners[i] == corner).all() and (counts[i] == 3).all() and 3 * len(counts[i]) == len(corner), name
    assert (patch[i] == which).all(), name
    assert (skin[i] == numpy.flatnonzero(which == 0)).all() and (crack[i] == numpy.flatnonzero(which)).all(), name
    if textured:
        assert len(texture[i]) == 2 * len(corner) and texture[i].min() >= 0 and texture[i].max() == 1, name
    compared += at.size + corner.size
assert len(crack[-1]) > 0, "nothing was cut"
folder = os.path.join(run, "obstacles")
assert ("/run/obstacles" in found) == os.path.isdir(folder)
if os.path.isdir(folder):
    kind, lines = found["/run/obstacles"]
    moved = samples(lines, "points", frames)
    told = next(line for line in lines if "faceVertexIndices = " in line)
    corners = numpy.fromstring(told.split("=")[1].translate(str.maketrans("[]", "  ")), sep=",")
    for i, name in enumerate(sorted(os.listdir(folder))):
        at, corner, _ = ply(os.path.join(folder, name))
        assert numpy.abs(moved[i].reshape(-1, 3) - at).max() <= 1e-6 * numpy.abs(at).max() and (corners == corner).all(), name
        compared += at.size
for name in ["run.ply.series"] + ["obstacles.ply.series"] * os.path.isdir(folder):
    series = json.load(open(os.path.join(run, name)))
    assert series["file-series-version"] == "1.0" and len(series["files"]) == frames, name
    assert all(os.path.exists(os.path.join(run, f["name"])) for f in series["files"]) and series["files"][0]["time"] == 0, name
    assert all(a["time"] < b["time"] for a, b in zip(series["files"], series["files"][1:])), name
print(compared, "values of", frames, "frames" + (", with texture coordinates" if textured else ""))
