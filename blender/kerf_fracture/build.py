"""Makes objects of Blender from pieces."""

import bpy
import mathutils
import numpy

from . import arrays

PIECES = "kerf_pieces_of"  # custom property of a collection of pieces: the name of their object
GREY = (0.5, 0.5, 0.5, 1.0)  # colour of inner faces
LOOP_TOTAL_IS_GIVEN = not bpy.types.MeshPolygon.bl_rna.properties["loop_total"].is_readonly  # before Blender 4


def plain_mesh(name, vertices, triangles):
    """A mesh of vertices (n, 3) and triangles (m, 3)."""
    return _mesh(name, vertices, numpy.asarray(triangles).ravel(), numpy.full(len(triangles), 3))


def _mesh(name, vertices, corners, sizes):
    """A mesh of vertices (n, 3) and faces: `corners` are their vertices, one face after another, `sizes` the numbers of them."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", numpy.ascontiguousarray(vertices, numpy.float32).ravel())
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", numpy.ascontiguousarray(corners, numpy.int32))
    mesh.polygons.add(len(sizes))
    mesh.polygons.foreach_set("loop_start", (numpy.cumsum(sizes) - sizes).astype(numpy.int32))
    if LOOP_TOTAL_IS_GIVEN:
        mesh.polygons.foreach_set("loop_total", numpy.asarray(sizes, numpy.int32))
    mesh.update(calc_edges=True)
    return mesh


def inner_material(name):
    """The material of this name, made when it is not there."""
    material = bpy.data.materials.get(name)
    if material is None:
        material = bpy.data.materials.new(name)
        material.diffuse_color = (0.55, 0.5, 0.45, 1.0)
        material.use_nodes = True
        for node in material.node_tree.nodes:
            if node.type == "BSDF_PRINCIPLED":
                node.inputs["Base Color"].default_value = material.diffuse_color
                node.inputs["Roughness"].default_value = 0.9
    return material


def dressed_meshes(source, surfaces, names, inner):
    """A mesh for each surface, a tuple (vertices, triangles, source triangles or -1 for inner ones, uv (m, 3, 2) of inner ones, the
    origin of the new mesh). Attributes of outer triangles are those of the source, and its faces stay where all of their triangles do. Inner ones have the last material slot, `inner`.
    None: there are no inner ones, and normals are custom ones only where the source's are."""
    triangle = numpy.concatenate([surface[2] for surface in surfaces])
    starts = numpy.cumsum([0] + [len(surface[0]) for surface in surfaces])
    ends = numpy.cumsum([0] + [len(surface[1]) for surface in surfaces])
    vertices = numpy.concatenate([surface[0] for surface in surfaces])
    triangles = numpy.concatenate([surface[1] + start for surface, start in zip(surfaces, starts)])
    tile = numpy.concatenate([surface[3] for surface in surfaces])
    outer = triangle >= 0
    from_source = triangle[outer]
    weight = arrays.weights(vertices[triangles[outer]], source.model.vertices[source.model.triangles[from_source]])

    def corners(values, inner_values):
        found = numpy.empty((len(triangles), 3, values.shape[-1]))
        found[outer] = arrays.interpolate(weight, from_source, values)
        found[~outer] = inner_values
        return found

    slots = list(source.materials)
    if inner and inner not in slots:
        slots = (slots or [None]) + [inner]  # a skin without material keeps none
    material = numpy.full(len(triangles), slots.index(inner) if inner else len(slots) - 1, numpy.int32)
    material[outer] = numpy.minimum(source.material, max(len(source.materials) - 1, 0))[from_source]
    smooth = numpy.ones(len(triangles), bool)
    smooth[outer] = source.smooth[from_source]
    normal = corners(source.normals, arrays.smooth_normals(vertices, triangles[~outer]))
    normal /= numpy.maximum(numpy.linalg.norm(normal, axis=-1, keepdims=True), 1e-30)
    uvs = [(layer, corners(layer.values, tile[~outer])) for layer in source.uvs]
    colors = [(layer, corners(layer.values, GREY)) for layer in source.colors]

    surface = numpy.repeat(numpy.arange(len(surfaces)), numpy.diff(ends))
    polygon, loop = numpy.full(len(triangles), -1), numpy.full((len(triangles), 3), -1)
    nearest = weight.argmax(-1)
    old = numpy.take_along_axis(source.model.triangles[from_source], nearest, -1)
    unchanged = (source.model.vertices[old] == vertices[triangles[outer]]).all((1, 2))[:, None]
    polygon[outer] = source.polygon[from_source]
    loop[outer] = numpy.where(unchanged, numpy.take_along_axis(source.loop[from_source], nearest, -1), -1)
    face_corners, sizes, firsts = arrays.faces(surface, triangles, polygon, loop, arrays.sides(source.polygon, source.loop))
    face_ends = numpy.searchsorted(firsts, ends)
    corner_ends = numpy.r_[0, numpy.cumsum(sizes)][face_ends]

    meshes = []
    for number, (points, own, _, _, origin) in enumerate(surfaces):
        part = slice(ends[number], ends[number + 1])
        faces = slice(face_ends[number], face_ends[number + 1])
        at = face_corners[corner_ends[number] : corner_ends[number + 1]]
        mine = at - 3 * ends[number]  # among the corners of this surface's triangles

        def per_corner(values):
            return numpy.ascontiguousarray(values[part].reshape(3 * len(own), -1)[mine], numpy.float32)

        mesh = _mesh(names[number], points - origin, own.ravel()[mine], sizes[faces])
        for slot in slots:
            mesh.materials.append(slot)
        mesh.polygons.foreach_set("material_index", material[firsts[faces]])
        mesh.polygons.foreach_set("use_smooth", smooth[firsts[faces]])
        for layer, values in uvs:
            mesh.uv_layers.new(name=layer.name, do_init=False).data.foreach_set("uv", per_corner(values).ravel())
        if not uvs and inner:
            mesh.uv_layers.new(name="UVMap", do_init=False).data.foreach_set("uv", per_corner(tile).ravel())
        for layer, values in colors:
            _add_colors(mesh, layer, values[part], own, outer[part], per_corner(values))
        _set_active(mesh, source)
        if inner or source.custom_normals:
            if hasattr(mesh, "use_auto_smooth"):  # before Blender 4.1, which always shows custom normals
                mesh.use_auto_smooth = True
            mesh.normals_split_custom_set(per_corner(normal).tolist())
        mesh.update()
        meshes.append(mesh)
    return meshes


def _add_colors(mesh, layer, values, triangles, outer, at_corners_of_faces):
    data = mesh.color_attributes.new(layer.name, layer.kind, layer.domain).data
    if layer.domain == "POINT":  # on a border the skin's colour wins
        values, at_corners = numpy.tile(GREY, (len(mesh.vertices), 1)), values
        values[triangles[outer]] = at_corners[outer]
    else:
        values = at_corners_of_faces
    data.foreach_set("color", values.astype(numpy.float32).ravel())


def _set_active(mesh, source):
    if source.uvs:
        mesh.uv_layers.active_index = max(source.active_uv, 0)
        mesh.uv_layers[source.render_uv].active_render = True
    if source.colors:
        mesh.color_attributes.active_color_index = max(source.active_color, 0)
        mesh.color_attributes.render_color_index = max(source.render_color, 0)


def place(made, source, offset=(0.0, 0.0, 0.0)):
    """Puts an object at a point of the source's frame, below the source's parent; below the source itself where that is animated."""
    world = source.frame @ mathutils.Matrix.Translation(offset)
    made.location, made.rotation_euler = world.to_translation(), world.to_euler()
    if source.animated:
        made.parent = source.object
        made.matrix_parent_inverse = source.object.matrix_world.inverted_safe()
        return
    parent = source.object.parent
    if parent:
        made.parent, made.parent_type, made.parent_bone = parent, source.object.parent_type, source.object.parent_bone
        if source.object.parent_type in {"VERTEX", "VERTEX_3"}:
            made.parent_vertices = source.object.parent_vertices
        made.matrix_parent_inverse = source.parent.inverted_safe()


def collection(name, above):
    made = bpy.data.collections.new(name)
    above.children.link(made)
    return made


def remove_pieces(names):
    """Removes pieces of objects of these names, with their hulls and bonds, that earlier fractures made."""
    for above in [found for found in bpy.data.collections if found.get(PIECES) in names]:
        meshes = {made.data for made in above.all_objects if made.type == "MESH"}
        below = list(above.children_recursive)
        for made in list(above.all_objects):
            bpy.data.objects.remove(made)
        for mesh in meshes:
            if not mesh.users:
                bpy.data.meshes.remove(mesh)
        for found in (*below, above):
            bpy.data.collections.remove(found)


def home(source, context):
    """The collection that the source is in, one that the view layer shows where there are several."""
    shown = {child.collection for child in _layers(context.view_layer.layer_collection) if not child.exclude}
    found = sorted(source.object.users_collection, key=lambda own: own not in shown)
    return found[0] if found else context.scene.collection


def _layers(layer):
    yield layer
    for child in layer.children:
        yield from _layers(child)


def pieces(context, source, fracture, inner):
    """The collection and objects of the pieces, in order, with hulls as their children."""
    above = collection(f"{source.name} Pieces", home(source, context))
    above[PIECES] = source.name
    properties = {name: value for name, value in source.object.items() if not name.startswith(("_", "kerf_"))}
    names = [f"{source.name}_piece_{number:03}" for number in range(len(fracture.pieces))]
    surfaces = []
    for piece in fracture.pieces:
        triangle = numpy.where(piece.patch == 0, piece.source, -1)
        surfaces.append((piece.vertices, piece.triangles, triangle, piece.uv, piece.centroid))
    meshes = dressed_meshes(source, surfaces, names, inner)
    made = []
    for piece, name, mesh in zip(fracture.pieces, names, meshes):
        where, size = source.texture_space
        mesh.use_auto_texspace = False
        mesh.texspace_location, mesh.texspace_size = where - piece.centroid, size
        new = bpy.data.objects.new(name, mesh)
        above.objects.link(new)
        place(new, source, piece.centroid)
        new.color, new.pass_index = source.object.color, source.object.pass_index
        for name, value in properties.items():
            new[name] = value
        new["volume"] = piece.volume
        made.append(new)
    if any(piece.hulls for piece in fracture.pieces):
        below = collection(f"{source.name} Hulls", above)
        for piece, new in zip(fracture.pieces, made):
            for number, (vertices, triangles) in enumerate(piece.hulls):
                _hull(below, new, number, vertices - piece.centroid, triangles)
    return above, made


def _hull(below, piece, number, vertices, triangles):
    name = f"UCX_{piece.name}_{number:02}"  # a name that Unreal takes for collision shapes
    hull = bpy.data.objects.new(name, plain_mesh(name, vertices, triangles))
    below.objects.link(hull)
    hull.parent = piece
    hull.display_type, hull.hide_render = "WIRE", True
