"""blender -b --python check_materials.py -- CUT.obj PIECES.glb: Blender finds the materials of textured.py; prints "imported"."""
import sys

import bpy
import numpy

numpy.bool = bool  # Blender 3.4 of Debian 12 asks its numpy for it

obj, glb = sys.argv[sys.argv.index("--") + 1:]


def near(a, b):
    return all(abs(x - y) < 1e-5 for x, y in zip(a, b))


def materials():
    found = {}
    for material in bpy.data.materials:
        if not material.node_tree:
            continue
        nodes = material.node_tree.nodes
        surface = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
        images = {tuple(node.image.size) for node in nodes if node.type == "TEX_IMAGE"}
        found[material.name] = surface.inputs, images, {link.to_socket.name for link in material.node_tree.links}
    return found


bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.obj_import(filepath=obj)
found = materials()
inputs, images, linked = found["side"]
assert near(inputs["Base Color"].default_value, (0.9, 0.8, 0.7)) and near([inputs["Roughness"].default_value], [0.5])
assert images == {(16, 16)} and "Base Color" in linked, (images, linked)
inputs, images, linked = found["lid"]
assert near(inputs["Base Color"].default_value, (1, 0.5, 0)) and near([inputs["Alpha"].default_value], [0.5])
assert images == {(8, 8)} and {"Roughness", "Metallic"} <= linked, (images, linked)
assert near(found["crack"][0]["Base Color"].default_value, (0.42, 0.36, 0.31))

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=glb)
found = materials()
assert found["side"][1] == {(16, 16), (8, 8)} and {"Base Color", "Normal"} <= found["side"][2], found["side"][1:]
assert found["lid"][1] == {(8, 8)} and near([found["lid"][0]["Alpha"].default_value], [0.5]), found["lid"]
assert near(found["crack"][0]["Base Color"].default_value, (0.42, 0.36, 0.31))
print("imported")
