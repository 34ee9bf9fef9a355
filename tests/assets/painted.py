"""painted.py: painted.glb in the current folder: a ball with all that a game's model has, and that a fracture must keep.

Four materials: an image that is moved and repeated, one placed by a second set of texture coordinates with a map of normals,
one of metal and roughness that glows, and colours of vertices alone. Normals are smooth, and the images have seams.
"""
import json, math, struct

from textured import png_bytes

LONG, ROUND = 48, 24  # quads around the axis, and from pole to pole


def checker(x, y):
    return (230, 120 + 6 * (x % 8), 60) if (x // 8 + y // 8) % 2 else (40, 70, 150 - 6 * (y % 8))


IMAGES = [
    png_bytes(64, checker),
    png_bytes(64, lambda x, y: (4 * x, 4 * y, 255 - 2 * x - 2 * y)),
    png_bytes(32, lambda x, y: (128 + int(60 * math.sin(x)), 128 + int(60 * math.cos(y)), 230)),  # normals
    png_bytes(32, lambda x, y: (255, 60 + 6 * x, 8 * y)),                                           # roughness, metal
]
MATERIALS = [
    {"name": "belt", "pbrMetallicRoughness": {"baseColorFactor": [1, 0.9, 0.8, 1], "metallicFactor": 0, "roughnessFactor": 0.7, "baseColorTexture": {
        "index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.2, 0.1], "rotation": 0.4, "scale": [3, 2]}}}}},
    {"name": "cap", "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.5, "baseColorTexture": {"index": 1, "texCoord": 1}},
     "normalTexture": {"index": 2, "scale": 0.6}, "occlusionTexture": {"index": 3, "texCoord": 1, "strength": 0.5}},
    {"name": "foot", "doubleSided": True, "emissiveFactor": [0.1, 0.05, 0.2], "emissiveTexture": {"index": 1},
     "pbrMetallicRoughness": {"baseColorFactor": [0.6, 0.6, 0.7, 1], "metallicFactor": 0.8, "roughnessFactor": 0.9, "metallicRoughnessTexture": {"index": 3}}},
    {"name": "bare", "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 1}},
]


def point(i, j):
    theta, phi = math.pi * j / ROUND, 2 * math.pi * (i % LONG) / LONG
    return (math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi)) if 0 < j < ROUND else (0.0, 1.0 if j == 0 else -1.0, 0.0)


def corner(i, j):
    p = point(i, j)
    return p + p + (4 * i / LONG, j / ROUND, 0.5 + 0.5 * p[0], 0.5 - 0.5 * p[2], 0.75 + 0.25 * p[0], 0.75 + 0.25 * p[1], 0.75 + 0.25 * p[2])


def material_of(i, j):
    return 1 if j < 7 else 2 if j >= 18 else 3 if i % 16 < 3 else 0


parts = [([], []) for _ in MATERIALS]
for j in range(ROUND):
    for i in range(LONG):
        corners, faces = parts[material_of(i, j)]
        first = len(corners)
        corners += [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]
        if j > 0:
            faces += [first, first + 1, first + 2]
        if j < ROUND - 1:
            faces += [first, first + 2, first + 3]

binary, views, accessors, primitives = b"", [], [], []


def view(data):
    global binary
    views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
    binary += data + bytes(-len(data) % 4)
    return len(views) - 1


def accessor(rows, code, component, kind, **more):
    data = b"".join(struct.pack(f"<{len(row)}{code}", *row) for row in rows)
    accessors.append({"bufferView": view(data), "componentType": component, "count": len(rows), "type": kind, **more})
    return len(accessors) - 1


for m, (corners, faces) in enumerate(parts):
    at = [c[0:3] for c in corners]
    box = {"min": [min(p[k] for p in at) for k in range(3)], "max": [max(p[k] for p in at) for k in range(3)]}
    rounded = struct.unpack("<6f", struct.pack("<6f", *box["min"], *box["max"]))
    box = {"min": list(rounded[:3]), "max": list(rounded[3:])}
    primitives.append({"material": m, "indices": accessor([(f,) for f in faces], "I", 5125, "SCALAR"), "attributes": {
        "POSITION": accessor(at, "f", 5126, "VEC3", **box), "NORMAL": accessor([c[3:6] for c in corners], "f", 5126, "VEC3"),
        "TEXCOORD_0": accessor([c[6:8] for c in corners], "f", 5126, "VEC2"), "TEXCOORD_1": accessor([c[8:10] for c in corners], "f", 5126, "VEC2"),
        "COLOR_0": accessor([c[10:13] for c in corners], "f", 5126, "VEC3")}})
images = [{"bufferView": view(image), "mimeType": "image/png", "name": f"image{k}"} for k, image in enumerate(IMAGES)]
text = json.dumps({
    "asset": {"version": "2.0"}, "extensionsUsed": ["KHR_texture_transform"], "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": primitives}], "materials": MATERIALS, "images": images, "textures": [{"source": k, "sampler": k % 2} for k in range(4)],
    "samplers": [{"wrapS": 10497, "wrapT": 10497}, {"wrapS": 33648, "wrapT": 33071}], "accessors": accessors, "bufferViews": views,
    "buffers": [{"byteLength": len(binary)}]}).encode()
text += b" " * (-len(text) % 4)
with open("painted.glb", "wb") as file:
    file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)))
    file.write(struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary)
