"""Meshes to and from Open3D, torch and meshio: the real packages where they are installed, else a stand-in that refuses the same."""
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import kerf
import numpy as np

SAMPLE = pathlib.Path(__file__).resolve().parents[2] / "samples" / "python" / "roundtrip.py"
# Vectors of Open3D 0.16 refuse arrays that cannot be written, and others than float64 and int32.
STAND_IN = '''
import numpy as np


def _vector(dtype, *shape):
    def make(values):
        if not values.flags.writeable:
            raise ValueError("array is not writeable")
        if values.dtype != dtype or values.shape[1:] != shape:
            raise TypeError(f"incompatible array: {values.dtype}, {values.shape}")
        return values.copy()
    return staticmethod(make)


class utility:
    Vector3dVector, Vector2dVector, Vector3iVector, IntVector = (
        _vector(np.float64, 3), _vector(np.float64, 2), _vector(np.int32, 3), _vector(np.int32))


class geometry:
    class TriangleMesh:
        def __init__(self, vertices=(), triangles=()):
            self.vertices, self.triangles = vertices, triangles
            self.triangle_uvs = self.vertex_colors = self.vertex_normals = self.triangle_material_ids = ()
'''


def installed(name):
    return importlib.util.find_spec(name) is not None


def textured():
    sphere = kerf.shapes.sphere(6)
    uv = np.random.default_rng(2).random((len(sphere.faces), 3, 2))
    return kerf.Solid(sphere.vertices, sphere.faces, uv=uv, groups=(np.arange(len(sphere.faces)) % 2))


class Open3D(unittest.TestCase):
    """With the stand-in and, where it is installed, with the package."""

    def runs(self):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "open3d.py").write_text(STAND_IN)
            yield "stand-in", os.pathsep.join([folder, os.environ.get("PYTHONPATH", "")])
        if installed("open3d"):
            yield "Open3D", os.environ.get("PYTHONPATH", "")

    def run_with(self, path, *command):
        done = subprocess.run([sys.executable, *command], env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True, timeout=300,
                              cwd=pathlib.Path(__file__).parent)
        self.assertEqual(done.returncode, 0, done.stderr[-2000:])
        return done.stdout

    def test_the_sample(self):
        for name, path in self.runs():
            with self.subTest(name):
                self.assertIn("went to trimesh and Open3D and back", self.run_with(path, str(SAMPLE)))

    def test_to_open3d(self):
        code = """
import kerf, numpy as np, test_packages
model = test_packages.textured()
made = model.to_open3d()
assert type(made).__module__.startswith("open3d"), type(made)
again = kerf.Solid.from_open3d(made)
assert np.array_equal(again.vertices[again.faces], model.vertices[model.faces])
assert np.array_equal(again.uv, model.uv) and np.array_equal(again.groups, model.groups)
assert all(abs(kerf.Solid.from_open3d(p.to_open3d()).volume / p.volume - 1) < 1e-12 for p in model.fracture(4))
ball = kerf.shapes.sphere(8)
outwards = ball.vertices / np.linalg.norm(ball.vertices, axis=1)[:, None]
holes = kerf.Mesh(ball.vertices, ball.faces[9:])
assert np.array_equal(kerf.Mesh.from_open3d(holes.to_open3d()).faces, holes.faces) and not holes.check().closed
painted = kerf.Solid(ball.vertices, ball.faces, colors=0.5 + 0.5 * outwards, normals=outwards).to_open3d()
assert np.abs(np.asarray(painted.vertex_colors) - (0.5 + 0.5 * outwards)).max() < 1e-6
assert np.abs(np.asarray(painted.vertex_normals) - outwards).max() < 1e-6
"""
        for name, path in self.runs():
            with self.subTest(name):
                self.run_with(path, "-c", code)


class Torch(unittest.TestCase):
    @unittest.skipUnless(installed("torch"), "no torch is installed")
    def test_tensors(self):
        import torch

        piece = kerf.shapes.pumpkin(6).fracture(3)[0]
        vertices, faces = torch.tensor(piece.vertices), torch.tensor(piece.faces.astype(np.int64))
        a, b, c = vertices[faces].unbind(1)
        self.assertAlmostEqual(float((a * torch.linalg.cross(b, c)).sum() / 6), piece.volume, places=12)


class Meshio(unittest.TestCase):
    @unittest.skipUnless(installed("meshio"), "no meshio is installed")
    def test_files(self):
        import meshio

        model = kerf.shapes.pumpkin(6)
        with tempfile.TemporaryDirectory() as folder:
            for ending, tolerance in ((".off", 0), (".stl", 1e-6), (".ply", 0), (".obj", 1e-5)):
                with self.subTest(ending):
                    path = os.path.join(folder, "model" + ending)
                    kerf.Mesh(model.vertices, model.faces).save(path)
                    read = meshio.read(path)
                    np.testing.assert_allclose(read.points[read.cells_dict["triangle"]], model.vertices[model.faces], rtol=0, atol=tolerance)


if __name__ == "__main__":
    unittest.main()
