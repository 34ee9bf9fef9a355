"""blender -b --python check_blender.py -- FILE.glb PIECES VOLUME: what Blender imports is what kerf-pieces promises: a named
object for each piece, below one root, closed, its origin at its centroid, with both materials and texture coordinates, and hulls
below it. Prints `N pieces` last when all is well."""
import sys

import bmesh
import bpy
import numpy

numpy.bool = bool  # Blender 3.4 of Debian 12 asks its numpy for it

path, count, volume = sys.argv[-3], int(sys.argv[-2]), float(sys.argv[-1])
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=path)
meshes = [o for o in bpy.data.objects if o.type == "MESH"]
pieces = [o for o in meshes if o.name.startswith("piece_")]
hulls = [o for o in meshes if o.name.startswith("UCX_")]
assert len(pieces) == count and len(pieces) + len(hulls) == len(meshes)
assert {o.parent.name for o in pieces} == {"pieces"}
assert all(h.name.startswith("UCX_" + h.parent.name) for h in hulls) and {h.parent for h in hulls} == set(pieces)
summed = 0.0
for piece in pieces:
    assert {m.name for m in piece.data.materials} >= {"crack"} and piece.data.uv_layers.active and "volume" in piece
    mesh = bmesh.new()
    mesh.from_mesh(piece.data)
    bmesh.ops.remove_doubles(mesh, verts=mesh.verts, dist=1e-6)  # corners are apart where normals or texture are
    assert all(edge.is_manifold for edge in mesh.edges), piece.name
    summed += mesh.calc_volume()
    six, moment = 0.0, [0.0] * 3
    for face in mesh.faces:
        a, b, c = (v.co for v in face.verts)
        part = a.dot(b.cross(c))
        six += part
        moment = [m + part * (x + y + z) / 4 for m, x, y, z in zip(moment, a, b, c)]
    assert all(abs(m / six) < 1e-4 for m in moment), piece.name
    mesh.free()
assert abs(summed - volume) < 1e-5 * volume, summed
print(f"{len(pieces)} pieces")
