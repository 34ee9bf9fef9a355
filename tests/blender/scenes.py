"""Objects that the add-on's tests break, and what must hold of pieces."""

import bmesh
import bpy
import mathutils
import numpy


def empty_scene():
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.preferences.addon_enable(module="kerf_fracture")


def select(*objects):
    bpy.ops.object.select_all(action="DESELECT")
    for found in objects:
        found.select_set(True)
    bpy.context.view_layer.objects.active = objects[0]
    bpy.context.view_layer.update()


def last_object(name):
    found = bpy.context.object
    found.name = found.data.name = name
    return found


def box(name="box", size=2.0):
    bpy.ops.mesh.primitive_cube_add(size=size)
    return last_object(name)


def ball(name="ball", subdivisions=3):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=subdivisions)
    return last_object(name)


def ring(name="ring"):
    bpy.ops.mesh.primitive_torus_add(major_segments=48, minor_segments=16)
    return last_object(name)


def open_box(name="open"):
    found = box(name)
    mesh = bmesh.new()
    mesh.from_mesh(found.data)
    mesh.faces.ensure_lookup_table()
    bmesh.ops.delete(mesh, geom=[mesh.faces[-1]], context="FACES_ONLY")
    mesh.to_mesh(found.data)
    mesh.free()
    return found


def paint(found):
    """Two materials, two layers of texture coordinates and two of colours, all of them affine functions of the place but for a jump
    between the materials. So they are known at any point of the surface."""
    mesh = found.data
    mesh.materials.clear()
    for name in ("red", "green"):
        mesh.materials.append(bpy.data.materials.get(name) or bpy.data.materials.new(name))
    for polygon in mesh.polygons:
        polygon.material_index = int(polygon.center.x > 0)
        polygon.use_smooth = True
    while mesh.uv_layers:
        mesh.uv_layers.remove(mesh.uv_layers[0])
    first, second = mesh.uv_layers.new(name="first"), mesh.uv_layers.new(name="second")
    mesh.uv_layers.active = second
    corner = mesh.color_attributes.new("corner", "FLOAT_COLOR", "CORNER")
    point = mesh.color_attributes.new("point", "FLOAT_COLOR", "POINT")
    for polygon in mesh.polygons:
        for loop in polygon.loop_indices:
            at = mesh.vertices[mesh.loops[loop].vertex_index].co
            first.data[loop].uv, second.data[loop].uv = uvs(at, polygon.material_index)
            corner.data[loop].color = color(at)
    for vertex in mesh.vertices:
        point.data[vertex.index].color = color(vertex.co)


def uvs(at, material):
    return (at.x + 10 * material, at.y), (at.z, at.x - at.y + 10 * material)


def color(at):
    return tuple(0.5 + 0.1 * x for x in at) + (1.0,)


def volume(found):
    """The volume of an object with its modifiers, in the scene."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    mesh = bmesh.new()
    mesh.from_object(found, depsgraph)
    mesh.transform(found.matrix_world)
    total = abs(mesh.calc_volume())
    mesh.free()
    return total


def closed(piece):
    """The volume of a piece, whose surface must be closed and oriented outwards, and its origin its centroid."""
    mesh = bmesh.new()
    mesh.from_mesh(piece.data)
    assert all(edge.is_manifold and edge.is_contiguous for edge in mesh.edges), piece.name
    total = mesh.calc_volume(signed=True)
    assert total > 0, piece.name
    corners = numpy.array([[loop.vert.co for loop in triangle] for triangle in mesh.calc_loop_triangles()], float)
    part = numpy.einsum("ij,ij->i", corners[:, 0], numpy.cross(corners[:, 1], corners[:, 2])) / 6
    centroid = (part[:, None] * corners.sum(1) / 4).sum(0) / part.sum()
    assert numpy.abs(centroid).max() < 1e-4 * total ** (1 / 3), (piece.name, centroid)
    mesh.free()
    return total


def pieces_of(name):
    """The pieces of an object, by number."""
    found = bpy.data.collections[f"{name} Pieces"].objects
    return sorted(found, key=lambda piece: piece.name)


def check_pieces(found, count, tolerance=1e-4):
    """The pieces of an object are closed and fill it. Returns them."""
    pieces = pieces_of(found.name)
    assert len(pieces) == count, (found.name, len(pieces))
    bpy.context.view_layer.update()
    total = sum(closed(piece) for piece in pieces)
    wanted = volume(found)
    assert abs(total - wanted) < tolerance * wanted, (found.name, total, wanted)
    for piece in pieces:
        assert max(abs(x - 1) for x in piece.matrix_world.to_scale()) < 1e-4, piece.name
    return pieces


def skin_distance(found, pieces):
    """The greatest distance of the pieces' outer vertices from the object's surface."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    mesh = bmesh.new()
    mesh.from_object(found, depsgraph)
    mesh.transform(found.matrix_world)
    tree = mathutils.bvhtree.BVHTree.FromBMesh(mesh)
    mesh.free()
    greatest = 0.0
    for piece in pieces:
        inner = len(piece.data.materials) - 1
        outer = {v for polygon in piece.data.polygons if polygon.material_index != inner for v in polygon.vertices}
        assert outer or len(pieces) > 8
        for vertex in outer:
            greatest = max(greatest, tree.find_nearest(piece.matrix_world @ piece.data.vertices[vertex].co)[3])
    return greatest
