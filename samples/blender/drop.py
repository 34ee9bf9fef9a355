"""Breaks a model by the add-on, drops it on the ground by Blender's rigid bodies, and renders a picture.

  blender -b --factory-startup --python-exit-code 1 --python drop.py -- kerf_fracture.zip MODEL.off PICTURE.png

The model's y is up. A moment of the fall is rendered by Cycles; PICTURE.blend beside it has the whole scene.
"""

import math
import os
import sys

import bpy

addon, model, picture = (os.path.abspath(name) for name in sys.argv[-3:])
sys.path.insert(0, addon)
import kerf_fracture  # noqa: E402  (an installed add-on needs no import)

bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
kerf_fracture.register()


def material(name, color, roughness):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    shader = next(node for node in made.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (*color, 1)
    shader.inputs["Roughness"].default_value = roughness
    return made


def load(path):
    """The model, 2 units high, above the ground and a little tilted."""
    with open(path, encoding="ascii") as file:
        words = file.read().split()
    count, faces, at = int(words[1]), int(words[2]), 4
    points = [tuple(float(x) for x in words[at + 3 * i : at + 3 * i + 3]) for i in range(count)]
    at += 3 * count
    triangles = [tuple(int(x) for x in words[at + 4 * i + 1 : at + 4 * i + 4]) for i in range(faces)]
    mesh = bpy.data.meshes.new("bear")
    mesh.from_pydata(points, [], triangles)
    mesh.polygons.foreach_set("use_smooth", [True] * faces)
    mesh.materials.append(material("fur", (0.55, 0.22, 0.06), 0.5))
    found = bpy.data.objects.new("bear", mesh)
    bpy.context.scene.collection.objects.link(found)
    found.scale = (2 / found.dimensions.y,) * 3
    found.rotation_euler, found.location = (math.radians(90), math.radians(8), math.radians(20)), (0, 0, 1.6)
    return found


bpy.ops.mesh.primitive_plane_add(size=40)
bpy.context.object.data.materials.append(material("ground", (0.25, 0.27, 0.3), 0.9))
bpy.ops.rigidbody.object_add(type="PASSIVE")

bear = load(model)
material("chalk", (0.75, 0.68, 0.52), 0.9)
bpy.ops.object.select_all(action="DESELECT")
bear.select_set(True)
bpy.context.view_layer.objects.active = bear
bpy.ops.object.kerf_fracture(pieces=40, jagged=0.015, seed=7, inner_material="chalk", rigid_bodies=True, strength=1e5)

scene = bpy.context.scene
scene.rigidbody_world.point_cache.frame_end = 60
for frame in range(1, 21):
    scene.frame_set(frame)

bpy.ops.object.light_add(type="SUN", rotation=(0.7, 0.2, 0.5))
bpy.context.object.data.energy, bpy.context.object.data.angle = 2.2, 0.1
bpy.ops.object.camera_add(location=(0.2, -4.6, 1.9), rotation=(math.radians(76), 0, math.radians(4)))
scene.camera = bpy.context.object
scene.world = bpy.data.worlds.new("sky")
scene.world.use_nodes = True
scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.7, 0.8, 1, 1)
scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.6
bpy.ops.preferences.addon_enable(module="cycles")
scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 64, False
scene.view_settings.view_transform = "Standard"
scene.render.resolution_x, scene.render.resolution_y, scene.render.filepath = 720, 520, picture
bpy.ops.wm.save_as_mainfile(filepath=picture.removesuffix(".png") + ".blend")
bpy.ops.render.render(write_still=True)
