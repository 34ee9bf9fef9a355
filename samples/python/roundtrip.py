"""Meshes of trimesh and Open3D in, pieces for them out, with texture coordinates. Neither package is needed.

Kerf reads objects by the names of their attributes. The classes below have those of trimesh.Trimesh and of
open3d.geometry.TriangleMesh. Where a package is installed, its own class does the round trip, too.
"""
import importlib
import importlib.util
from dataclasses import dataclass
from typing import Any

import kerf
import numpy as np
from numpy.typing import NDArray


@dataclass
class Visual:
    """Texture coordinates of trimesh: one row per vertex, (n, 2)."""

    uv: NDArray[np.float64]


@dataclass
class Trimesh:
    """Arrays of trimesh.Trimesh."""

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    visual: Visual


@dataclass
class TriangleMesh:
    """Arrays of open3d.geometry.TriangleMesh. Texture coordinates: one row per corner, (3 m, 2)."""

    vertices: NDArray[np.float64]
    triangles: NDArray[np.int32]
    triangle_uvs: NDArray[np.float64]


def to_trimesh(mesh: kerf.Mesh) -> Any:
    """Corners become vertices of their own: at a seam, a vertex has several texture coordinates. Kerf merges them again."""
    assert mesh.uv is not None
    vertices, uv = mesh.vertices[mesh.faces].reshape(-1, 3), mesh.uv.reshape(-1, 2)
    faces = np.arange(len(vertices)).reshape(-1, 3)
    if importlib.util.find_spec("trimesh"):
        trimesh = importlib.import_module("trimesh")
        return trimesh.Trimesh(vertices, faces, visual=trimesh.visual.TextureVisuals(uv=uv), process=False)
    return Trimesh(vertices, faces, Visual(uv))


def to_open3d(mesh: kerf.Mesh) -> Any:
    assert mesh.uv is not None
    # Copies: Open3D refuses arrays that cannot be written.
    vertices, faces, uv = np.array(mesh.vertices), mesh.faces.astype(np.int32), np.array(mesh.uv).reshape(-1, 2)
    if importlib.util.find_spec("open3d"):
        open3d = importlib.import_module("open3d")
        made = open3d.geometry.TriangleMesh(open3d.utility.Vector3dVector(vertices), open3d.utility.Vector3iVector(faces))
        made.triangle_uvs = open3d.utility.Vector2dVector(uv)
        return made
    return TriangleMesh(vertices, faces, uv)


def described(mesh: kerf.Mesh) -> NDArray[np.float64]:
    """Position and texture coordinates of each corner, in an order that does not depend on that of vertices and faces."""
    assert mesh.uv is not None
    corners: NDArray[np.float64] = np.concatenate([mesh.vertices[mesh.faces], mesh.uv], axis=2).reshape(-1, 5)
    return np.array(corners[np.lexsort(corners.T)])


# A sphere whose texture goes around it, with a seam.
sphere = kerf.shapes.sphere(6)
x, y, z = np.moveaxis(sphere.vertices[sphere.faces], 2, 0)
around = np.arctan2(y, x) / (2 * np.pi)
around += (around < around.max(axis=1, keepdims=True) - 0.5)  # a face on the seam has its corners on one side of it
model = kerf.Solid(sphere.vertices, sphere.faces, uv=np.stack([around, z / 2 + 0.5], axis=2))

pieces = model.crack(kerf.score(model, "planes", pieces=4, jagged=0, seed=3)).pieces()
for mesh in [model, *pieces]:
    for again in [kerf.Solid.from_trimesh(to_trimesh(mesh)), kerf.Solid.from_open3d(to_open3d(mesh))]:
        assert np.array_equal(described(again), described(mesh)), "a corner or its texture coordinates changed"
        assert np.isclose(again.volume, mesh.volume)

# Where texture does not matter, trimesh gets the shared vertices: trimesh.Trimesh(**mesh.to_trimesh_kwargs()).
arguments = pieces[0].to_trimesh_kwargs()
assert np.array_equal(arguments["vertices"], pieces[0].vertices) and np.array_equal(arguments["faces"], pieces[0].faces)
print(f"{len(pieces)} pieces and their model went to trimesh and Open3D and back")
