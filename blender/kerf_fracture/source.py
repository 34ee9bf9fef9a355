"""Reads an object of Blender, with its modifiers applied, into arrays."""

import dataclasses

import bpy
import mathutils
import numpy

from . import arrays
from .backend import Model, Refused

TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}


@dataclasses.dataclass
class Layer:
    """Texture coordinates (m, 3, 2) or colours (m, 3, 4) at the corners of triangles. `kind` and `domain` are Blender's words for
    the storage of colours."""

    name: str
    values: numpy.ndarray
    kind: str = ""
    domain: str = ""


@dataclasses.dataclass
class Source:
    """An object as triangles. The frame is the object's place without its scale; vertices are in it, in the scene's units."""

    object: object
    name: str
    frame: mathutils.Matrix
    scale: numpy.ndarray  # (3, 3), from the object's coordinates to the frame
    parent: mathutils.Matrix  # the parent's effect: world = parent @ the object's own transformation
    model: Model
    material: numpy.ndarray  # (m,), into materials
    smooth: numpy.ndarray  # (m,)
    polygon: numpy.ndarray  # (m,): the face that each triangle is of
    loop: numpy.ndarray  # (m, 3): which corner of its face each corner of a triangle is, from 0, in the order of the face
    normals: numpy.ndarray  # (m, 3, 3)
    custom_normals: bool
    uvs: list
    colors: list
    active_uv: int
    active_color: int
    render_uv: int
    render_color: int
    materials: list
    texture_space: tuple  # location and size of generated texture coordinates
    animated: bool  # whether the object moves by itself, not by its parent alone
    left_out: list  # words for what pieces do not have


def read(found, depsgraph, density_group=""):
    """The object's triangles, with the weights of a vertex group as density. Throws Refused when there are none."""
    evaluated = found.evaluated_get(depsgraph)
    try:
        mesh = evaluated.to_mesh(preserve_all_data_layers=True, depsgraph=depsgraph)
    except RuntimeError:
        mesh = None
    try:
        if mesh is None or not len(mesh.polygons):
            raise Refused("the object has no faces")
        own = _arrays(found, evaluated, mesh)
        if density_group:
            own.model.density = _weights(found, mesh, density_group)
        return own
    finally:
        evaluated.to_mesh_clear()


def brightness(name):
    """An image as (height, width) values from 0 to 1, the highest row first; what is transparent is white. Throws Refused."""
    found = bpy.data.images.get(name)
    if found is None:
        raise Refused(f"there is no image '{name}'; open one in the image editor, and choose it" if name else "the pattern Image needs one; choose it")
    width, height = found.size
    if width == 0 or height == 0:
        raise Refused(f"the image '{name}' has no pixels; find its file in the image editor")
    pixels = numpy.empty(4 * width * height, numpy.float32)
    found.pixels.foreach_get(pixels)
    color, alpha = pixels.reshape(height, width, 4)[::-1, :, :3], pixels.reshape(height, width, 4)[::-1, :, 3]
    return numpy.clip(color.mean(2) * alpha + 1 - alpha, 0, 1).astype(float)


def _weights(found, mesh, name):
    """The weights of a vertex group at the vertices that triangles use."""
    group = found.vertex_groups.get(name) if hasattr(found, "vertex_groups") else None
    if group is None:
        raise Refused(f"the object has no vertex group '{name}'; paint one, or clear Density Group")
    weights = numpy.zeros(len(mesh.vertices))
    for vertex in mesh.vertices:
        for own in vertex.groups:
            if own.group == group.index:
                weights[vertex.index] = own.weight
    return weights[numpy.unique(_get(mesh.loop_triangles, "vertices", (len(mesh.loop_triangles), 3), numpy.int32))]


def _frame(matrix):
    """The object's place without scale, and the scale and shear that are left, (3, 3)."""
    linear = numpy.array(matrix.to_3x3(), float)
    if abs(numpy.linalg.det(linear)) < 1e-30:
        raise Refused("the object is scaled to nothing; its scale must not be 0")
    if numpy.abs(linear.T @ linear - numpy.eye(3)).max() < 1e-5 and numpy.linalg.det(linear) > 0:
        return matrix.copy(), numpy.eye(3)
    place, rotation, _ = matrix.decompose()
    frame = mathutils.Matrix.Translation(place) @ rotation.to_matrix().to_4x4()
    return frame, numpy.linalg.inv(numpy.array(rotation.to_matrix(), float)) @ linear


def _get(collection, name, shape, kind=numpy.float32):
    values = numpy.empty(shape, kind)
    collection.foreach_get(name, values.ravel())
    return values


def _corner_normals(mesh):
    if hasattr(mesh, "calc_normals_split"):  # before Blender 4.1
        mesh.calc_normals_split()
        return _get(mesh.loops, "normal", (len(mesh.loops), 3))
    return _get(mesh.corner_normals, "vector", (len(mesh.loops), 3))


def _arrays(found, evaluated, mesh):
    frame, scale = _frame(evaluated.matrix_world)
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    vertices = _get(mesh.vertices, "co", (len(mesh.vertices), 3)).astype(float)
    triangles = _get(mesh.loop_triangles, "vertices", (count, 3), numpy.int32)
    corners = _get(mesh.loop_triangles, "loops", (count, 3), numpy.int32)
    polygon = _get(mesh.loop_triangles, "polygon_index", count, numpy.int32)
    begin = _get(mesh.polygons, "loop_start", len(mesh.polygons), numpy.int32)[polygon]
    loop = corners - begin[:, None]
    smooth = _get(mesh.polygons, "use_smooth", len(mesh.polygons), bool)[polygon]
    material = _get(mesh.polygons, "material_index", len(mesh.polygons), numpy.int32)[polygon]
    normals = _corner_normals(mesh)
    place, size = numpy.array(mesh.texspace_location, float), numpy.array(mesh.texspace_size, float)
    if (scale != numpy.eye(3)).any():
        vertices = vertices @ scale.T
        normals = normals @ numpy.linalg.inv(scale)
        normals /= numpy.maximum(numpy.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        place, size = scale @ place, numpy.abs(scale @ size)
        if numpy.linalg.det(scale) < 0:  # mirrored
            triangles, corners, loop = triangles[:, ::-1], corners[:, ::-1], _turned(loop, polygon)[:, ::-1]
    colors = []
    for layer in mesh.color_attributes:
        at = triangles if layer.domain == "POINT" else corners
        colors.append(Layer(layer.name, _get(layer.data, "color", (len(layer.data), 4))[at], layer.data_type, layer.domain))
    uvs = [Layer(layer.name, _get(layer.data, "uv", (len(layer.data), 2))[corners]) for layer in mesh.uv_layers]
    slots = [slot.material for slot in evaluated.material_slots]
    materials = [own or None for own in mesh.materials]
    materials = [slot or own for slot, own in zip(slots + [None] * len(materials), materials + [None] * len(slots))]
    materials = materials[: max(len(slots), len(mesh.materials))]
    used, numbers = numpy.unique(triangles, return_inverse=True)  # loose vertices are no part of a solid
    return Source(
        object=found,
        name=found.name,
        frame=frame,
        scale=scale,
        parent=evaluated.matrix_world @ evaluated.matrix_local.inverted() if found.parent else mathutils.Matrix(),
        model=Model(numpy.ascontiguousarray(vertices[used]), numpy.ascontiguousarray(numbers.reshape(-1, 3), dtype=numpy.int32)),
        material=material,
        smooth=smooth,
        polygon=polygon,
        loop=loop,
        normals=normals[corners],
        custom_normals=mesh.has_custom_normals,
        uvs=uvs,
        colors=colors,
        active_uv=mesh.uv_layers.active_index,
        active_color=mesh.color_attributes.active_color_index,
        render_uv=next((i for i, layer in enumerate(mesh.uv_layers) if layer.active_render), 0),
        render_color=mesh.color_attributes.render_color_index,
        materials=[own and own.original for own in materials],
        texture_space=(place, size),
        animated=_is_animated(found),
        left_out=_left_out(found, mesh),
    )


def _turned(loop, polygon):
    """Corners of faces in the opposite order."""
    return arrays.sides(polygon, loop)[polygon][:, None] - 1 - loop


def _is_animated(found):
    moves = found.animation_data
    return bool(found.constraints) or moves is not None and bool(moves.action or moves.drivers or moves.nla_tracks)


def _left_out(found, mesh):
    """What the object has and pieces do not have, in words."""
    lost = []
    if getattr(found, "vertex_groups", None):
        lost.append("vertex groups")
    if getattr(found.data, "shape_keys", None):
        lost.append("shape keys")
    kept = {layer.name for layer in (*mesh.uv_layers, *mesh.color_attributes)} | {"position", "material_index", "sharp_face", "sharp_edge"}
    own = [a.name for a in mesh.attributes if a.name not in kept and not a.name.startswith(".") and not a.is_internal]
    if own:
        lost.append(f"the attribute{'s' * (len(own) > 1)} {', '.join(own)}")
    return lost


def without_scale(own, vertices, triangles):
    """The source, and a surface in its frame, in the object's own coordinates."""
    inverse = numpy.linalg.inv(own.scale).T
    order = slice(None, None, -1 if numpy.linalg.det(own.scale) < 0 else 1)

    def turned(layers):
        return [dataclasses.replace(layer, values=layer.values[:, order]) for layer in layers]

    normals = own.normals[:, order] @ own.scale
    normals /= numpy.maximum(numpy.linalg.norm(normals, axis=-1, keepdims=True), 1e-30)
    model = Model(own.model.vertices @ inverse, own.model.triangles[:, order])
    loop = own.loop if order.step == 1 else _turned(own.loop, own.polygon)[:, order]
    local = dataclasses.replace(own, model=model, loop=loop, normals=normals, uvs=turned(own.uvs), colors=turned(own.colors))
    return local, vertices @ inverse, triangles[:, order]
