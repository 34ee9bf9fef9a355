"""Main jobs of a model in one line each: split, fracture, transformed, contains; what is refused, and what the sentence says."""
import os
import pickle
import tempfile
import types
import unittest
import warnings
from unittest import mock

import kerf
import numpy as np

FLAT = np.array([[-2, -2, 0.1], [2, -2, 0.1], [2, 2, 0.1], [-2, 2, 0.1]])
TWO = np.array([[0, 1, 2], [0, 2, 3]])


def like_trimesh():
    """The part of trimesh that to_trimesh() calls, with the signatures of version 4."""
    class Trimesh:
        def __init__(self, vertices, faces, process=True, face_attributes=None, vertex_colors=None, vertex_attributes=None, visual=None):
            self.vertices, self.faces, self.process = vertices, faces, process
            self.visual = visual or types.SimpleNamespace(kind=None if vertex_colors is None else "vertex", vertex_colors=vertex_colors)

    def textures(uv=None, material=None, image=None, face_materials=None):
        return types.SimpleNamespace(kind="texture", uv=uv, material=material, face_materials=face_materials)

    material = types.SimpleNamespace(PBRMaterial=dict, MultiMaterial=lambda materials: {"materials": materials})
    return types.SimpleNamespace(Trimesh=Trimesh, visual=types.SimpleNamespace(TextureVisuals=textures, material=material))


class Jobs(unittest.TestCase):
    def setUp(self):
        self.model = kerf.shapes.pumpkin(8)

    def test_cut_by_planes(self):
        halves = self.model.cut(kerf.plane((0, 0, 0.1), (0, 0, 5)))
        older = self.model.split(kerf.plane((0, 0, 0.1), (0, 0, 5)))
        self.assertEqual([half.volume for half in halves], [half.volume for half in older])
        self.assertEqual(len(halves), 2)
        self.assertAlmostEqual(sum(half.volume for half in halves), self.model.volume, places=12)
        self.assertEqual({bool(half.vertices[:, 2].mean() > 0.1) for half in halves}, {True, False})
        for half in halves:  # all of each is on one side
            z = half.vertices[:, 2]
            self.assertTrue(z.min() >= 0.1 - 1e-9 or z.max() <= 0.1 + 1e-9)
        self.assertEqual(len(self.model.cut([kerf.plane((0, 0, 0.1), (0, 0, 1)), kerf.plane((0, 0.01, 0), (0, 1, 0.02))])), 4)
        self.assertEqual(len(self.model.cut(kerf.plane((0, 0, 9), (0, 0, 1)))), 1)
        rng = np.random.default_rng(5)
        for normal in rng.normal(size=(8, 3)):  # the plane reaches through the whole model
            self.assertEqual(self.model.crack(kerf.plane(0.3 * normal / np.linalg.norm(normal), normal)).piece_count, 2)

    def test_planes(self):
        plane = kerf.plane([1, 2, 3], [0, 0, -2])
        np.testing.assert_array_equal(plane.normal, [0, 0, -1])
        again = pickle.loads(pickle.dumps(plane))
        np.testing.assert_array_equal(np.r_[again.point, again.normal], np.r_[plane.point, plane.normal])
        with self.assertRaisesRegex(kerf.InputError, "no length"):
            kerf.plane((0, 0, 0), (0, 0, 0))

    def test_fracture_is_score_and_crack(self):
        pieces = self.model.fracture(12, seed=7)
        same = self.model.crack(kerf.score(self.model, pieces=12, seed=7)).pieces()
        self.assertEqual([piece.volume for piece in pieces], [piece.volume for piece in same])
        wood = self.model.fracture(6, "wood", seed=3, axis="x", jagged=0.01)
        self.assertAlmostEqual(sum(piece.volume for piece in wood), self.model.volume, places=9)
        with self.assertRaisesRegex(TypeError, "sed"):
            self.model.fracture(6, sed=3)

    def test_pieces_are_models(self):
        piece = self.model.fracture(5, seed=2)[0]
        parts = piece.fracture(4, seed=1, jagged=0.02)
        self.assertAlmostEqual(sum(part.volume for part in parts), piece.volume, places=12)
        self.assertTrue(all(part.check() for part in parts))
        self.assertEqual(len(piece.cut(kerf.plane(piece.centroid, (1, 0, 0)))), 2)
        self.assertEqual(parts[0].group_names.count("crack"), 1)
        self.assertEqual(kerf.score(piece, pieces=3, seed=1).pieces, 3)

    def test_pieces_are_solids(self):
        pieces = self.model.crack(kerf.score(self.model, pieces=5, seed=2)).pieces(hulls=True)
        for piece in pieces:
            self.assertIsInstance(piece, kerf.Solid)
            fine = piece.refine(0.2)
            self.assertIs(type(fine), kerf.Piece)
            self.assertEqual((fine.index, fine.volume, len(fine.hulls)), (piece.index, piece.volume, 1))
            self.assertGreater(len(fine.faces), len(piece.faces))
            self.assertTrue(kerf.Solid(piece).check())
            self.assertIs(type(pickle.loads(pickle.dumps(piece))), kerf.Piece)
            self.assertEqual(len(kerf.sample(piece, spacing=0.3)), len(kerf.sample(kerf.Mesh(piece.vertices, piece.faces), spacing=0.3)))
        self.assertTrue({name for name in dir(kerf.Solid) if not name.startswith("_")} <= set(dir(pieces[0])))
        # Both sides of a crack that ends inside are at one place: the piece is closed, but no valid model.
        slit = self.model.crack(kerf.score(self.model, "planes", pieces=2, depth=0.5)).pieces()
        self.assertEqual(len(slit), 1)
        self.assertEqual(slit[0].euler_number % 2, 0)
        for call in (lambda: slit[0].fracture(3), slit[0].complex, lambda: kerf.sample(slit[0], spacing=0.3), lambda: kerf.Body(slit[0], spacing=0.3)):
            with self.assertRaises(kerf.InputError):
                call()

    def test_slice(self):
        plane = kerf.plane((0, 0, 0.1), (0, 0, 2))
        above, below = self.model.slice(plane), self.model.slice(kerf.plane((0, 0, 0.1), (0, 0, -1)))
        self.assertEqual((len(above), len(below)), (1, 1))
        self.assertGreaterEqual(above[0].vertices[:, 2].min(), 0.1 - 1e-9)
        self.assertAlmostEqual(above[0].volume + below[0].volume, self.model.volume, places=12)
        quarter = self.model.slice([plane, kerf.plane((0.01, 0, 0), (1, 0.02, 0))])
        self.assertEqual(len(quarter), 1)
        self.assertLess(quarter[0].volume, above[0].volume)
        self.assertEqual(self.model.slice(kerf.plane((0, 0, 9), (0, 0, 1))), [])
        self.assertAlmostEqual(self.model.slice(kerf.plane((0, 0, -9), (0, 0, 1)))[0].volume, self.model.volume, places=12)
        legs = kerf.shapes.letter("H", 0.3, 30)  # what is in front may be several pieces
        middle = legs.bounds.mean(axis=0)
        self.assertEqual(len(legs.slice(kerf.plane(middle + (0, 0.12, 0), (0, 1, 0)))), 2)
        for wrong in ("z", [(0, 0, 1)], None):
            with self.assertRaises(TypeError):
                self.model.slice(wrong)

    def test_transformed(self):
        turn = np.array([[0, -1, 0, 2], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
        mirrored = np.diag([-2, 1, 3, 1.0])
        mirrored[:3, 3] = 4, 5, 6
        for matrix in (turn, mirrored):
            for mesh in (self.model, kerf.Mesh(FLAT, TWO), self.model.crack(kerf.plane((0, 0, 0), (0, 0, 1))).pieces(hulls=True)[1]):
                moved = mesh.transformed(matrix)
                self.assertIs(type(moved), type(mesh))
                np.testing.assert_allclose(moved.vertices, mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3], rtol=1e-15)
                if not isinstance(mesh, kerf.Solid) and not isinstance(mesh, kerf.Piece):
                    continue
                factor = abs(np.linalg.det(matrix))
                self.assertAlmostEqual(moved.volume, factor * mesh.volume, places=12)
                self.assertAlmostEqual(kerf.Mesh(moved.vertices, moved.faces).volume, factor * mesh.volume, places=12)  # still outside
                np.testing.assert_allclose(moved.centroid, matrix[:3, :3] @ mesh.centroid + matrix[:3, 3], atol=1e-14)
            self.assertEqual(len(moved.hulls), 1)
            np.testing.assert_allclose(moved.hulls[0].volume, factor * mesh.hulls[0].volume)
        uv = np.random.default_rng(1).random((len(TWO), 3, 2))
        flipped = kerf.Mesh(FLAT, TWO, uv=uv, normals=np.tile([0, 0, 1.0], (4, 1))).transformed(np.diag([-1, 1, 1, 1]))
        self.assertEqual(flipped.face_normals[0, 2], 1)  # mirrored in its plane: its front stays in front
        np.testing.assert_array_equal(flipped.uv, uv[:, [0, 2, 1]])
        np.testing.assert_array_equal(flipped.normals[0, 0], [0, 0, 1])
        for wrong in (np.eye(3), np.diag([1, 1, 0, 1]), np.ones((4, 4)), np.diag([1e300, 1, 1, 1]), "text"):
            with self.assertRaises((kerf.InputError, TypeError)):
                self.model.transformed(wrong)

    def test_contains(self):
        rng = np.random.default_rng(3)
        block = kerf.shapes.block((1, 2, 3), edge=0.5)
        points = rng.uniform(-0.5, 3.5, (4000, 3))
        np.testing.assert_array_equal(block.contains(points), ((points > 0) & (points < (1, 2, 3))).all(axis=1))
        at_edges = np.stack(np.meshgrid([0.25, 0.5, 0.75], [0.5, 1, 1.5], [0.5, 1, 2]), -1).reshape(-1, 3)  # in planes of many edges
        self.assertTrue(block.contains(at_edges).all())
        inside = self.model.contains(rng.uniform(-1.5, 1.5, (20000, 3)))
        self.assertAlmostEqual(27 * inside.mean() / self.model.volume, 1, delta=0.05)
        piece, other = self.model.split(kerf.plane((0, 0, 0), (0, 0, 1)))
        self.assertEqual((piece.contains([piece.centroid])[0], piece.contains([other.centroid])[0]), (True, False))
        self.assertEqual(self.model.contains(np.empty((0, 3))).shape, (0,))

    def test_measures_and_copies(self):
        block = kerf.shapes.block((1, 2, 3), edge=0.5)
        np.testing.assert_allclose(block.centroid, [0.5, 1, 1.5], rtol=1e-14)
        self.assertEqual((block.euler_number, kerf.shapes.letter("O", 0.3, 30).euler_number, kerf.Mesh(FLAT, TWO).euler_number), (2, 0, 1))
        self.assertIs(block.copy(), block)

    def test_a_mesh_that_is_no_model_says_so(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "holes.ply")
            kerf.Mesh(self.model.vertices, self.model.faces[10:]).save(path)
            loaded = kerf.load(path)
        self.assertIs(type(loaded), kerf.Mesh)
        plane = kerf.plane((0, 0, 0), (0, 0, 1))
        for call in (lambda: loaded.crack(plane), lambda: loaded.split(plane), lambda: loaded.fracture(3), loaded.complex,
                     lambda: loaded.contains([[0, 0, 0]]), lambda: kerf.score(loaded)):
            with self.assertRaisesRegex(kerf.InputError, r"open: edge .*kerf\.Solid\.repaired\(\)"):
                call()
        self.assertEqual(len(kerf.Solid.repaired(loaded).split(plane)), 2)
        with self.assertRaisesRegex(kerf.InputError, r"cut already; give it to kerf\.Complex\(\)"):
            self.model.crack(plane).surface().crack(plane)

    def test_vertices_and_faces_are_a_sheet(self):
        for pair in ((FLAT, TWO), [FLAT, TWO], (FLAT.tolist(), TWO.tolist()), (FLAT.astype(np.float32), TWO.astype(np.uint8))):
            self.assertEqual(self.model.crack(pair).piece_count, self.model.crack(kerf.Mesh(*pair)).piece_count)
            self.assertEqual(self.model.crack(pair).piece_count, 2)
        x = np.linspace(-2, 2, 5)
        lines = [np.column_stack([x, 0 * x + y, 0 * x + 0.1]) for y in (-2, 2)]
        self.assertEqual(self.model.crack(lines).piece_count, 2)
        self.assertEqual(self.model.crack(tuple(lines)).piece_count, 2)
        self.assertEqual(self.model.crack([[[-2, -2, 0], [2, -2, 0]], [[-2, 2, 0], [2, 2, 0]]]).piece_count, 2)  # two lines of integers
        with self.assertRaisesRegex(kerf.InputError, r"may be a mesh or two lines; give kerf\.Mesh"):
            self.model.crack((np.round(10 * FLAT).astype(int), TWO))
        with self.assertRaisesRegex(kerf.InputError, r"may be a mesh or two lines; give kerf\.Mesh"):
            self.model.crack((FLAT, TWO.astype(float)))
        with self.assertRaisesRegex(kerf.InputError, "vert"):  # indices that the points do not have
            self.model.crack((FLAT, TWO + 9))

    def test_bytes_are_colors(self):
        given = np.full((4, 3), 200, np.uint8)
        for colors in (given, np.full((4, 3), 200 / 255)):
            np.testing.assert_allclose(kerf.Mesh(FLAT, TWO, colors=colors).colors[..., :3], 200 / 255, rtol=1e-15)
        with self.assertRaisesRegex(kerf.InputError, "uint8"):
            kerf.Mesh(FLAT, TWO, colors=np.full((4, 3), 200))

    def test_stl_and_off(self):
        with tempfile.TemporaryDirectory() as folder:
            for ending, tolerance in (("off", 0), ("stl", 1e-6)):
                path = os.path.join(folder, "x." + ending)
                with warnings.catch_warnings():
                    warnings.simplefilter("error")
                    self.model.save(path)
                again = kerf.load(path)
                self.assertIsInstance(again, kerf.Solid)
                self.assertEqual(len(again.faces), len(self.model.faces))
                np.testing.assert_allclose(again.vertices[again.faces], self.model.vertices[self.model.faces], rtol=0, atol=tolerance)
                with self.assertWarnsRegex(UserWarning, "left out"):
                    kerf.Mesh(FLAT, TWO, colors=np.ones((4, 3))).save(path)
            with self.assertRaisesRegex(kerf.InputError, "single precision; save a .ply"):
                kerf.Mesh(FLAT + 1e7, TWO).save(os.path.join(folder, "far.stl"))

    def test_one_default_of_jagged(self):
        flat = kerf.score(self.model, pieces=6, seed=3, jagged=0)
        self.assertEqual(len(kerf.score(self.model, pieces=6, seed=3).sheet.faces), len(flat.sheet.faces))

    def test_to_trimesh(self):
        with mock.patch.dict("sys.modules", trimesh=like_trimesh()):
            self.assertEqual(kerf.Solid.from_trimesh(self.model.to_trimesh()).volume, self.model.volume)

    def test_looks_in_trimesh(self):
        model = kerf.shapes.block((1, 1, 1), 1)
        at = model.vertices[model.faces]
        uv = at[..., :2] + at[..., 2:]  # with seams where z divides corners of one vertex: none, so that nothing is split
        plain = kerf.Solid(model.vertices, model.faces, uv=uv)
        seams = kerf.Solid(model.vertices, model.faces, uv=uv + np.arange(len(uv))[:, None, None])
        colors = kerf.Solid(model.vertices, model.faces, colors=(model.vertices - model.bounds[0]))
        with mock.patch.dict("sys.modules", trimesh=like_trimesh()):
            self.assertEqual(len(plain.to_trimesh().vertices), len(model.vertices))
            for given in (plain, seams, colors):
                made = given.to_trimesh()
                again = kerf.Solid.from_trimesh(made)
                np.testing.assert_array_equal(again.vertices[again.faces], model.vertices[model.faces])
                if given.uv is not None:
                    np.testing.assert_array_equal(again.uv, given.uv)
                else:
                    np.testing.assert_allclose(again.colors, given.colors, atol=0.5 / 255)
            self.assertEqual(len(seams.to_trimesh().vertices), 3 * len(model.faces))
            prop = kerf.load(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../io/cases/gltf/prop.glb"))
            visual = prop.to_trimesh().visual
            self.assertEqual([m["name"] for m in visual.material["materials"]], list(prop.group_names))
            np.testing.assert_array_equal(visual.face_materials, prop.groups)

    def test_materials_of_arrays(self):
        prop = kerf.load(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../io/cases/gltf/prop.glb"))
        with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            prop.save(os.path.join(folder, "prop.obj"))
            again = kerf.Solid(prop.vertices, prop.faces, uv=prop.uv, groups=prop.groups, group_names=prop.group_names,
                               materials=os.path.join(folder, "prop.mtl"))
            images = [image for _, image in again._base_colors() if image]
            self.assertEqual(images, [image for _, image in prop._base_colors() if image])
            self.assertEqual(len(images), 1)

    def test_capitals(self):
        with tempfile.TemporaryDirectory() as folder:
            for ending in ("STL", "PLY", "Off", "OBJ", "GLB"):
                path = os.path.join(folder, "p." + ending)
                self.model.save(path)
                self.assertAlmostEqual(kerf.load(path).volume, self.model.volume, delta=1e-5 * self.model.volume)

    def test_colours_out_of_range(self):
        faces, vertices = self.model.faces, self.model.vertices
        for value in (200.0, -5.0):
            with self.assertRaisesRegex(kerf.InputError, f"colors: a value of {value}; give floats from 0 to 1, or uint8"):
                kerf.Mesh(vertices, faces, colors=np.full((len(vertices), 3), value))
            with self.assertRaisesRegex(kerf.InputError, "colors: a value outside 0 to 1"):
                kerf.reconstruct(vertices, colors=np.full((len(vertices), 3), value))

    def test_tensors(self):
        class Tensor:
            requires_grad, is_cuda = True, False

            def __array__(self, *_):
                raise RuntimeError("Can't call numpy() on Tensor that requires grad.")

        with self.assertRaisesRegex(kerf.InputError, r"vertices: a tensor that requires a gradient; give its detach\(\).cpu\(\)"):
            kerf.Mesh(Tensor(), self.model.faces)
        Tensor.requires_grad, Tensor.is_cuda = False, True
        with self.assertRaisesRegex(kerf.InputError, r"vertices: a tensor of a GPU; give its cpu\(\)"):
            kerf.Mesh(Tensor(), self.model.faces)

    def test_show(self):
        os.environ["MPLBACKEND"] = "Agg"
        try:
            import matplotlib.pyplot as pyplot
        except ImportError:
            self.skipTest("no matplotlib is installed")
        with mock.patch.object(pyplot, "show") as shown:
            self.model.show(size=(64, 48), samples=1)
        self.assertEqual(shown.call_count, 1)
        self.assertEqual(pyplot.gcf().get_size_inches().tolist(), [0.64, 0.48])


if __name__ == "__main__":
    unittest.main()
