"""Binary PLY as Kerf's tools write and read it: little-endian, triangles only."""

import numpy

TYPES = {"char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4", "uint": "<u4", "float": "<f4", "double": "<f8"}
CORNERS = {"vertex_indices": 3, "texcoord": 6, "normal": 9, "color": 12}  # numbers in a triangle's lists


def write(path, vertices, triangles, red=None):
    """Writes vertices (n, 3) as doubles, with a red (n,) where it is given, and triangles (m, 3)."""
    rows = numpy.empty(len(triangles), [("count", "u1"), ("vertex_indices", "<u4", 3)])
    rows["count"] = 3
    rows["vertex_indices"] = triangles
    names, values = ["x", "y", "z"], numpy.asarray(vertices, float)
    if red is not None:
        names += ["red", "green", "blue"]
        values = numpy.column_stack([values, red, numpy.zeros((len(red), 2))])
    properties = "".join(f"property double {name}\n" for name in names).encode()
    with open(path, "wb") as file:
        file.write(
            b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n%selement face %d\nproperty list uchar uint vertex_indices\nend_header\n"
            % (len(vertices), properties, len(triangles))
        )
        file.write(numpy.ascontiguousarray(values, "<f8").tobytes())
        file.write(rows.tobytes())


def read(path):
    """The vertices (n, 3) and a structured array of the faces, with `vertex_indices` (m, 3) and what else the file has."""
    with open(path, "rb") as file:
        content = file.read()
    end = content.index(b"end_header\n") + len(b"end_header\n")
    elements = []
    for line in content[:end].decode("utf-8", "replace").split("\n"):
        words = line.split()
        if words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:2] == ["property", "list"]:
            elements[-1][2].extend([(words[4] + " count", TYPES[words[2]]), (words[4], TYPES[words[3]], CORNERS.get(words[4], 0))])
        elif words[:1] == ["property"]:
            elements[-1][2].append((words[2], TYPES[words[1]]))
    tables = {}
    for name, count, fields in elements[:2]:  # fronts, which may follow, are of no use here
        tables[name] = numpy.frombuffer(content, numpy.dtype(fields), count, end)
        end += tables[name].nbytes
    vertex, face = tables["vertex"], tables["face"]
    for name in face.dtype.names:
        if name.endswith(" count") and (face[name] != CORNERS.get(name[: -len(" count")], 0)).any():
            raise ValueError(f"{path}: a face is not a triangle")
    return numpy.stack([vertex[axis] for axis in "xyz"], axis=1).astype("f8"), face
