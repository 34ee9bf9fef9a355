"""blender -b --python check_blender.py -- PIECES.glb PIECES.json: Blender imports the hierarchy that the JSON tells; prints "imported"."""
import json
import sys

import bpy
import numpy

numpy.bool = bool  # Blender 3.4 of Debian 12 asks its numpy for it

path, told = sys.argv[sys.argv.index("--") + 1:]
told = json.load(open(told))
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=path)
objects = bpy.data.objects
levels = told["levels"]


def place(name):
    x, y, z = objects[name].matrix_world.translation
    return x, z, -y  # glTF's y is up, Blender's z


def near(a, b):
    return all(abs(x - y) < 1e-5 for x, y in zip(a, b))


for piece in told["pieces"]:
    cluster = levels[0]["clusters"][piece["parent"]]
    assert objects[piece["node"]].parent.name == cluster["name"], piece
    assert near(place(piece["node"]), piece["centroid"]), piece
    assert objects[piece["node"] + "_hull"].parent.name == piece["node"]
for k, level in enumerate(levels):
    for cluster in level["clusters"]:
        above = levels[k + 1]["clusters"][cluster["parent"]]["name"] if k + 1 < len(levels) else "pieces"
        assert objects[cluster["name"]].parent.name == above and near(place(cluster["name"]), cluster["centroid"]), cluster
print("imported")
