"""Kerf beside Blender's Cell Fracture, in one run: the same models and number of pieces. tests/blender/run.sh compare BUILD_DIR
OFF_FILE... prints a table: seconds, objects, how many are closed once coincident vertices are merged, connected parts, and the error of
the volume."""

import os
import sys
import time

import bmesh
import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import scenes  # noqa: E402

PIECES = 30


def load(path):
    """An OFF file as an object of diagonal 20: Cell Fracture merges vertices less than 0.005 apart, so a small model would suffer."""
    with open(path, encoding="ascii") as file:
        words = (word for line in file for word in line.partition("#")[0].split())
        assert next(words) == "OFF"
        count, faces, _ = (int(next(words)) for _ in range(3))
        points = [tuple(float(next(words)) for _ in range(3)) for _ in range(count)]
        polygons = [tuple(int(next(words)) for _ in range(int(next(words)))) for _ in range(faces)]
    box = [max(point[axis] for point in points) - min(point[axis] for point in points) for axis in range(3)]
    scale = 20 / sum(length**2 for length in box) ** 0.5
    points = [tuple(scale * x for x in point) for point in points]
    mesh = bpy.data.meshes.new("model")
    mesh.from_pydata(points, [], polygons)
    found = bpy.data.objects.new("model", mesh)
    bpy.context.scene.collection.objects.link(found)
    scenes.select(found)
    return found


def parts(mesh):
    """The connected parts of a bmesh."""
    count, left = 0, set(mesh.verts)
    while left:
        count += 1
        reached = [left.pop()]
        while reached:
            for edge in reached.pop().link_edges:
                for vertex in edge.verts:
                    if vertex in left:
                        left.remove(vertex)
                        reached.append(vertex)
    return count


def measure(path, name, call):
    scenes.empty_scene()
    preferences = bpy.context.preferences.addons["kerf_fracture"].preferences
    preferences.backend = os.environ["KERF_BACKEND"]
    bpy.ops.preferences.addon_enable(module="object_fracture_cell")
    found = load(path)
    wanted = scenes.volume(found)
    begin = time.monotonic()
    call()
    seconds = time.monotonic() - begin
    made = [o for o in bpy.data.objects if o.type == "MESH" and o is not found]
    closed = connected = 0
    total = 0.0
    for piece in made:
        mesh = bmesh.new()
        mesh.from_mesh(piece.data)
        bmesh.ops.remove_doubles(mesh, verts=mesh.verts, dist=1e-5)  # Cell Fracture splits sharp edges
        closed += bool(mesh.faces) and all(edge.is_manifold and edge.is_contiguous for edge in mesh.edges)
        connected += parts(mesh)
        total += mesh.calc_volume(signed=True)
        mesh.free()
    model = os.path.splitext(os.path.basename(path))[0]
    row = [f"{model}, {len(found.data.polygons)} triangles", name, f"{seconds:.2f}", len(made), closed, connected, f"{abs(total / wanted - 1):.1e}"]
    print("| " + " | ".join(str(cell) for cell in row) + " |", flush=True)


print("| model | add-on | seconds | objects | closed | connected parts | volume error |\n|---|---|---|---|---|---|---|")
for off in sys.argv[sys.argv.index("--") + 1:]:
    for margin in (0.001, 0.0):
        measure(
            off,
            f"Cell Fracture, margin {margin}",
            lambda: bpy.ops.object.add_fracture_cell_objects(source={"VERT_OWN"}, source_limit=PIECES, margin=margin),
        )
    for jagged in (0.0, 0.02):
        measure(off, f"Kerf, jaggedness {jagged}", lambda: bpy.ops.object.kerf_fracture(pieces=PIECES, jagged=jagged, seed=7))
