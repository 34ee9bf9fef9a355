"""Meshes of the module kerf: repair, refinement, hulls, imports from other packages, shapes, files."""
import json
import os
import tempfile
import types
import unittest
import warnings

import kerf
import numpy as np
from test_geometry import CUBE, CUBE_FACES, LINE, NO_ID, STEP, cube, plane


class Meshes(unittest.TestCase):
    def test_measures(self):
        m = cube()
        self.assertEqual((m.volume, m.area), (1, 6))
        np.testing.assert_array_equal(m.bounds, [[0, 0, 0], [1, 1, 1]])
        np.testing.assert_allclose(m.smallest_angles, 45)
        np.testing.assert_array_equal(m.corners, CUBE[CUBE_FACES])
        np.testing.assert_array_equal(m.face_normals[:2], [[-1, 0, 0], [-1, 0, 0]])
        at = m.corners.mean(axis=1) + 0.1 * m.face_normals
        np.testing.assert_array_equal(m.nearest(at), np.arange(12))

    def test_check(self):
        self.assertTrue(cube().check())
        open_cube = kerf.Mesh(CUBE, CUBE_FACES[1:])
        report = open_cube.check()
        self.assertFalse(report or report.closed)
        self.assertTrue(report.manifold and report.oriented)
        self.assertIn("open", report.first_problem)
        with self.assertRaises(kerf.InputError):
            kerf.Solid(CUBE, CUBE_FACES[1:])
        with self.assertRaises(kerf.InputError):
            kerf.Solid(CUBE, CUBE_FACES[:, ::-1])

    def test_repair(self):
        holed = kerf.Mesh(CUBE, np.vstack([CUBE_FACES[1:6], CUBE_FACES[6:, ::-1]]), groups=["a"] * 11)
        mesh, stats = holed.repair()
        self.assertTrue(stats and mesh.check())
        self.assertEqual((stats.filled_holes, stats.added_triangles, stats.flipped_triangles > 0), (1, 1, True))
        self.assertAlmostEqual(mesh.volume, 1)
        self.assertEqual(mesh.group_names, ("a",))
        self.assertFalse(cube().repair()[1])
        self.assertEqual(kerf.Solid.repaired(holed).volume, 1)
        soup = kerf.Mesh(CUBE[CUBE_FACES].reshape(-1, 3), np.arange(36).reshape(-1, 3))
        self.assertEqual(soup.repair()[1].welded_vertices, 28)
        with self.assertRaises(kerf.InputError):
            cube().crack(plane()).surface().repair()

    def test_refine(self):
        fine = kerf.Solid(CUBE, CUBE_FACES, uv=CUBE[:, :2]).refine(0.3)
        self.assertIsInstance(fine, kerf.Solid)
        edges = fine.corners - np.roll(fine.corners, 1, axis=1)
        self.assertLessEqual(np.linalg.norm(edges, axis=2).max(), 0.3)
        self.assertAlmostEqual(fine.volume, 1)
        np.testing.assert_allclose(fine.uv, fine.corners[:, :, :2], atol=1e-12)
        for longest in (0, -1, float("nan"), 1e-9):
            with self.assertRaises(kerf.InputError):
                cube().refine(longest)

    def test_shells(self):
        three = kerf.Mesh(np.vstack([3 * CUBE, CUBE + 1, CUBE + 5]), np.vstack([CUBE_FACES, CUBE_FACES + 8, CUBE_FACES[:, ::-1] + 16]))
        report = three.check()
        self.assertFalse(report.good)
        self.assertEqual([(s["kind"], s["parent"], s["depth"], s["faces"]) for s in report.shells],
                         [("outer", None, 0, 12), ("hidden", 0, 1, 12), ("inverted", None, 0, 12)])
        for inner, volume in (("oriented", 28), ("cavities", 27), ("filled", 28)):
            mended, stats = three.repair(inner=inner)
            self.assertEqual((mended.volume, stats.inverted_shells), (volume, 1))
            self.assertEqual(kerf.Solid.repaired(three, inner=inner).volume, volume)
        with self.assertRaises(kerf.InputError):
            three.repair(inner="other")

    def test_plates(self):
        sheet = plane()
        size, voxel = sheet.area, 0.05
        self.assertAlmostEqual(kerf.Solid.repaired(sheet, voxel=voxel).volume / (size * voxel), 1, delta=0.1)
        self.assertAlmostEqual(sheet.wrap(voxel).volume / (size * voxel), 1, delta=0.1)
        vessel = kerf.Mesh(CUBE, CUBE_FACES[:10])
        self.assertGreater(kerf.Solid.repaired(vessel, voxel=voxel).volume, 0.9)
        self.assertLess(kerf.Solid.repaired(vessel, voxel=voxel, open="sheets").volume, 0.3)

    def test_wrap(self):
        two = kerf.Mesh(np.vstack([CUBE, CUBE + 0.5]), np.vstack([CUBE_FACES, CUBE_FACES + 8]))
        self.assertGreater(two.crossings(), 0)
        whole = kerf.Solid.repaired(two, voxel=0.05)
        self.assertAlmostEqual(whole.volume, 2 - 0.125, delta=0.1)
        self.assertLess(whole.source.max(), 24)
        with self.assertRaises(kerf.InputError):
            two.wrap(1e-9)

    def test_hulls(self):
        l_shape = kerf.Solid.repaired(kerf.Mesh(np.vstack([CUBE * [2, 1, 1], CUBE * [1, 1, 1] + [0, 1, 0]]),
                                                np.vstack([CUBE_FACES, CUBE_FACES + 8])), voxel=0.05)
        one, two = l_shape.convex_decomposition(), l_shape.convex_decomposition(2, corners=1000)
        self.assertEqual((len(one), len(two)), (1, 2))
        self.assertLess(sum(h.volume for h in two), one[0].volume)
        for bad in (dict(count=0), dict(corners=3)):
            with self.assertRaises(kerf.InputError):
                l_shape.convex_decomposition(**bad)

    def test_attributes_are_transferred(self):
        model = cube(colors=CUBE)
        bare = kerf.Solid(CUBE, CUBE_FACES).crack(plane()).surface()
        np.testing.assert_array_equal(bare.source[bare.patch != 0], NO_ID)
        surface = bare.transfer_attributes(model)
        skin = surface.patch == 0
        np.testing.assert_allclose(surface.colors[skin][..., :3], surface.corners[skin], atol=1e-12)
        with self.assertRaises(kerf.InputError):
            cube().transfer_attributes(model)

    def test_other_packages(self):
        visual = types.SimpleNamespace(uv=CUBE[:, :2], kind="texture")
        t = types.SimpleNamespace(vertices=CUBE, faces=CUBE_FACES, visual=visual)
        np.testing.assert_array_equal(kerf.Solid.from_trimesh(t).uv, CUBE[CUBE_FACES][..., :2])
        colors = np.arange(48, dtype=np.uint8).reshape(12, 4)
        t.visual = types.SimpleNamespace(kind="face", face_colors=colors)
        np.testing.assert_allclose(kerf.Solid.from_trimesh(t).colors[:, 1], colors / 255)
        o = types.SimpleNamespace(vertices=CUBE, triangles=CUBE_FACES, vertex_colors=[], vertex_normals=[],
                                  triangle_uvs=CUBE[CUBE_FACES][..., :2].reshape(-1, 2),
                                  triangle_material_ids=np.arange(12) % 2)
        s = kerf.Solid.from_open3d(o)
        np.testing.assert_array_equal(s.uv, CUBE[CUBE_FACES][..., :2])
        self.assertEqual(len(s.group_names), 2)
        tensors = types.SimpleNamespace(vertex={"positions": CUBE}, triangle={"indices": CUBE_FACES})
        self.assertEqual(kerf.Solid.from_open3d(tensors).volume, 1)
        self.assertEqual(kerf.Solid(t).volume, 1)
        arguments = s.to_trimesh_kwargs()
        self.assertIs(arguments["process"], False)
        np.testing.assert_array_equal(arguments["faces"], CUBE_FACES)
        split = types.SimpleNamespace(vertices=CUBE[CUBE_FACES].reshape(-1, 3), faces=np.arange(36).reshape(12, 3))
        uv = np.random.default_rng(1).random((36, 2))
        split.visual = types.SimpleNamespace(uv=uv)
        split.triangles, split.triangle_uvs = split.faces, uv
        for seamless in (kerf.Solid.from_trimesh(split), kerf.Solid.from_open3d(split)):
            self.assertEqual(seamless.vertices.shape, (8, 3))
            np.testing.assert_array_equal(seamless.vertices[seamless.faces], CUBE[CUBE_FACES])
            np.testing.assert_array_equal(seamless.uv, uv.reshape(12, 3, 2))
        for call in (kerf.Solid.from_trimesh, kerf.Solid.from_open3d):
            for bad in (None, 3, types.SimpleNamespace(vertices=CUBE), types.SimpleNamespace(vertices=1, faces=2)):
                with self.assertRaises(kerf.InputError):
                    call(bad)


class Shapes(unittest.TestCase):
    def test_volumes(self):
        self.assertAlmostEqual(kerf.shapes.sphere(20).volume, 4 / 3 * np.pi, delta=0.03)
        self.assertAlmostEqual(kerf.shapes.block((1, 2, 3), 0.5).volume, 6)
        self.assertAlmostEqual(kerf.shapes.star(20, lambda d: 2.0).volume, 32 / 3 * np.pi, delta=0.2)
        for shape in (kerf.shapes.pumpkin(8), kerf.shapes.apple(8), kerf.shapes.polyp(12), kerf.shapes.letter("K")):
            self.assertIsInstance(shape, kerf.Solid)
            self.assertTrue(shape.check())

    def test_refusals(self):
        s = kerf.shapes
        for call in (lambda: s.sphere(0), lambda: s.sphere(10**9), lambda: s.block((1, 0, 1)), lambda: s.block(edge=0),
                     lambda: s.block(edge=1e-9), lambda: s.letter("ab"), lambda: s.letter("?"),
                     lambda: s.letter("A", resolution=3), lambda: s.star(3, lambda d: -1), lambda: s.star(3, lambda d: np.nan)):
            with self.assertRaises(kerf.InputError):
                call()
        for call in (lambda: s.sphere(2.5), lambda: s.star(3, 1), lambda: s.star(3, lambda d: "a")):
            with self.assertRaises(TypeError):
                call()
        with self.assertRaises(ZeroDivisionError):
            s.star(3, lambda d: 1 / 0)


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def test_models(self):
        s = kerf.Solid(CUBE, CUBE_FACES, uv=CUBE[:, :2], groups=["a", "b"] * 6)
        for name in ("cube.ply", "cube.obj"):
            s.save(self.path(name))
            read = kerf.load(self.path(name))
            self.assertIsInstance(read, kerf.Solid)
            np.testing.assert_array_equal(read.corners, s.corners)
            np.testing.assert_allclose(read.uv, s.uv)
            self.assertEqual(read.group_names, ("a", "b"))
        with open(self.path("cube.ply"), "rb") as file:
            self.assertEqual(len(kerf.Mesh.parse(file.read())), 12)
        s.save(self.path("cube.glb"))
        with open(self.path("cube.glb"), "rb") as file:
            self.assertEqual(file.read(4), b"glTF")
        kerf.Mesh(CUBE, CUBE_FACES[1:]).save(self.path("open.ply"))
        self.assertIs(type(kerf.load(self.path("open.ply"))), kerf.Mesh)
        with self.assertRaises(kerf.InputError):
            kerf.Solid.load(self.path("open.ply"))

    def test_units(self):
        s = cube()
        self.assertIsNone(s.unit)
        s.save(self.path("mm.ply"), unit="mm")
        self.assertEqual(kerf.load(self.path("mm.ply")).unit, 0.001)
        self.assertEqual(kerf.load(self.path("mm.ply"), unit="in").unit, 0.0254)
        part = kerf.Solid.load(self.path("mm.ply"))
        broken = part.crack(kerf.score(part, "voronoi", pieces=3, seed=7))
        broken.save(self.path("pieces.glb"))
        metres = kerf.load(self.path("pieces.glb"))
        self.assertEqual(metres.unit, 1)
        np.testing.assert_allclose(metres.bounds, [[0, 0, 0], [0.001] * 3], atol=1e-9)
        for piece in broken.pieces():
            self.assertEqual(piece.unit, 0.001)
        s.save(self.path("inch.glb"), unit="in")
        np.testing.assert_allclose(kerf.load(self.path("inch.glb")).bounds[1], [0.0254] * 3, rtol=1e-6)
        broken.save(self.path("feet.glb"), unit="ft")
        np.testing.assert_allclose(kerf.load(self.path("feet.glb")).bounds[1], [0.3048] * 3, rtol=1e-6)
        for call in (lambda: kerf.load(self.path("mm.ply"), unit="parsec"), lambda: s.save(self.path("a.ply"), unit="-")):
            with self.assertRaisesRegex(kerf.InputError, "give one of m, cm, mm"):
                call()

    def test_far_from_the_origin(self):
        far = np.array([691234.5678, 5401234.5678, 512.3])
        s = kerf.Solid(CUBE + far, CUBE_FACES)
        with self.assertWarnsRegex(UserWarning, "far.glb: the model is far from the origin"):
            s.save(self.path("far.glb"))
        np.testing.assert_allclose(kerf.load(self.path("far.glb")).bounds, [far, far + 1], rtol=0, atol=1e-6)

    def test_materials_of_a_glb(self):
        model = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../io/cases/gltf/prop.glb")
        s = kerf.load(model)
        self.assertEqual(s.uv2.shape, (108, 3, 2))
        s.crack(kerf.score(s, "voronoi", pieces=3, seed=7)).save(self.path("pieces.glb"))
        documents = []
        for name in (model, self.path("pieces.glb")):
            with open(name, "rb") as file:
                data = file.read()
            documents.append(json.loads(data[20:20 + int.from_bytes(data[12:16], "little")]))
        self.assertEqual(documents[1]["materials"][:2], documents[0]["materials"])
        self.assertEqual(len(documents[1]["images"]), 1)
        with self.assertWarnsRegex(UserWarning, "prop.obj: left out: doubleSided, second texture coordinates; a .ply"):
            s.save(self.path("prop.obj"))
        again = kerf.load(self.path("prop.obj"))
        again.save(self.path("again.glb"))
        with open(self.path("again.glb"), "rb") as file:
            data = file.read()
        document = json.loads(data[20:20 + int.from_bytes(data[12:16], "little")])
        self.assertEqual([m["name"] for m in document["materials"]], [m["name"] for m in documents[0]["materials"]])
        self.assertEqual(len(document["images"]), 1)

    def test_snapping_to_edges_is_an_option(self):
        s = kerf.Solid(CUBE, CUBE_FACES)
        low, high = s.bounds
        x = (low[0] + high[0]) / 2 + 1e-5 * (high[0] - low[0])
        lines = [[[x, y, z] for y in (low[1] - 1, high[1] + 1)] for z in (high[2] + 1, low[2] - 1)]
        self.assertEqual(len(s.crack(np.array(lines), snap_edges=1e-3).pieces()), 2)
        with self.assertRaisesRegex(kerf.InputError, "snap_edges"):
            s.crack(np.array(lines), snap_edges=2)

    def test_several_parts_of_a_scan(self):
        places = np.array([[0, 0, 0], [2, 0.3, 0], [0, 2.2, 0.1], [-1.7, 0, 0.2], [0.2, 0, 2.3]])
        radii = np.array([1, 0.5, 0.7, 0.35, 0.8])
        for parts in (2, 5):
            random = np.random.default_rng(parts)
            points = []
            for place, radius in zip(places[:parts], radii):
                ball = random.normal(size=(int(6000 * radius ** 2), 3))
                points.append(place + radius * ball / np.linalg.norm(ball, axis=1)[:, None])
            solid = kerf.reconstruct(random.permutation(np.concatenate(points)))
            self.assertEqual(kerf.Complex(solid).piece_count, parts)
            self.assertAlmostEqual(solid.volume / (4 / 3 * np.pi * (radii[:parts] ** 3).sum()), 1, delta=0.03)

    def test_a_flat_scan_is_no_solid(self):
        points = np.random.default_rng(1).random((3000, 3)) * [1, 1, 0]
        turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
        for given in (points, points @ turn):
            with self.assertRaisesRegex(kerf.InputError, "has all its points in a plane, which encloses no volume; give a scan from all sides"):
                kerf.reconstruct(given)

    def test_a_scan(self):
        turns = np.arange(3000) * np.pi * (3 - 5 ** 0.5)
        z = 1 - (2 * np.arange(3000) + 1) / 3000
        ball = np.stack([np.cos(turns) * np.sqrt(1 - z * z), np.sin(turns) * np.sqrt(1 - z * z), z], axis=1)
        colors = np.where(z[:, None] > 0, [255, 0, 0], [0, 0, 255]).astype(np.uint8)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            solid = kerf.reconstruct(ball, colors=colors)
        self.assertIsInstance(solid, kerf.Solid)
        self.assertAlmostEqual(solid.volume, 4 * np.pi / 3, delta=0.05)
        top = solid.vertices[solid.faces].mean(axis=1)[:, 2] > 0.2
        np.testing.assert_allclose(solid.colors[top][:, :, :3].mean(axis=(0, 1)), [1, 0, 0], atol=1e-6)
        with self.assertWarnsRegex(UserWarning, "1 region without points filled, [0-9]+ % of the area"):
            kerf.reconstruct(ball[z > -0.3], ball[z > -0.3])
        np.savetxt(self.path("ball.xyz"), np.hstack([ball, ball]))
        points, normals, none = kerf.read_points(self.path("ball.xyz"))
        np.testing.assert_allclose(points, ball, atol=1e-15)
        np.testing.assert_allclose(normals, ball, atol=1e-12)
        self.assertIsNone(none)
        for call, text in ((lambda: kerf.reconstruct(ball[:5]), "fewer than ten points"), (lambda: kerf.reconstruct(ball, ball[1:]), "normals: has 2999 rows"),
                           (lambda: kerf.reconstruct(ball, depth=3), "depth must be from 4 to 12"), (lambda: kerf.reconstruct(ball, 0 * ball), "no length"),
                           (lambda: kerf.read_points(self.path("none.xyz")), "cannot be opened")):
            with self.assertRaisesRegex(kerf.InputError, text):
                call()

    def test_what_is_left_out_is_a_warning(self):
        with open(self.path("lines.obj"), "w") as file:
            file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\nl 1 2\n")
        with self.assertWarnsRegex(UserWarning, "lines.obj: left out: 1 polyline"):
            self.assertEqual(len(kerf.load(self.path("lines.obj"))), 4)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with self.assertRaises(UserWarning):
                kerf.load(self.path("lines.obj"))

    def test_cut_models_go_on(self):
        c = kerf.Solid(CUBE, CUBE_FACES, groups=["a"] * 12).complex()
        c.front(LINE, name="halve").advance(LINE + STEP)
        c.save(self.path("cut.ply"))
        d = kerf.load(self.path("cut.ply"))
        self.assertIsInstance(d, kerf.Complex)
        f = d.fronts[0]
        self.assertEqual((f.name, f.crack, f.step), ("halve", 1, 1))
        f.advance(LINE + 2 * STEP)
        self.assertEqual(d.piece_count, 2)
        self.assertEqual(set(d.pieces()[0].group_names), {"a", "crack"})
        d.save(self.path("pieces.glb"), corners=16)
        d.save(self.path("cut.obj"))
        d.save_bonds(self.path("bonds.json"), strength=2)
        with open(self.path("bonds.json")) as file:
            import json
            bond = json.load(file)["bonds"][0]
        self.assertAlmostEqual(bond["area"], 1)
        self.assertAlmostEqual(bond["strength"], 2)
        d.pieces()[1].save(self.path("piece.glb"))
        self.assertEqual(kerf.Complex.load(self.path("cut.ply")).crack_count, 1)

    def test_fronts(self):
        front = kerf.Front([LINE, LINE + STEP], name="halve")
        sheet = kerf.Front([plane().vertices], name="half", triangles=plane().faces)
        kerf.save_fronts(self.path("a.front"), [front, sheet])
        a, b = kerf.load(self.path("a.front"))
        self.assertEqual((a.name, a.is_sheet, b.name, b.is_sheet), ("halve", False, "half", True))
        np.testing.assert_array_equal(a.steps[1], LINE + STEP)
        np.testing.assert_array_equal(b.triangles, plane().faces)
        with open(self.path("a.front"), "rb") as file:
            self.assertEqual(len(kerf.parse_fronts(file.read())), 2)
        self.assertEqual(cube().crack(kerf.load(self.path("a.front"))).crack_count, 2)
        self.assertEqual(len(kerf.load_curves(self.path("a.front"))), 2)
        curves = kerf.score(cube(), "curves", curves=[LINE + [0, 1, 0]], axis="z", jagged=0)
        self.assertGreater(len(curves.sheet), 0)

    def test_volumes(self):
        kerf.write_level_set(self.path("cube.vdb"), cube(), 0.02)
        s = kerf.load(self.path("cube.vdb"))
        self.assertIsInstance(s, kerf.Solid)
        self.assertAlmostEqual(s.volume, 1, delta=0.02)
        with self.assertRaises(kerf.InputError):
            kerf.read_volume(self.path("cube.vdb"), grid="none")

    def test_refusals(self):
        with self.assertRaises(FileNotFoundError):
            kerf.load(self.path("none.ply"))
        with self.assertRaises(kerf.OutputError):
            cube().save(self.path("none/cube.ply"))
        with self.assertRaises(kerf.InputError):
            cube().save(self.path("cube.xyz"))
        with open(self.path("bad.ply"), "w") as file:
            file.write("ply\nformat ascii 1.0\nelement vertex 3\n")
        with self.assertRaises(kerf.InputError):
            kerf.load(self.path("bad.ply"))
        with self.assertRaises(TypeError):
            kerf.load(5)


def balls(far):
    """Five balls that overlap, united. Triangles cross once they are rounded, at the origin and, more of them, far from it."""
    ball = kerf.shapes.sphere(8)
    places = np.round(np.random.default_rng(1).uniform(-0.7, 0.7, (5, 3)), 1) + [far, 0, 0]
    return kerf.Solid.repaired(kerf.Mesh(np.concatenate([ball.vertices + place for place in places]),
                                         np.concatenate([ball.faces + i * len(ball.vertices) for i in range(5)])))


class SinglePrecision(unittest.TestCase):
    def test_rounded(self):
        for far in (0, 200, 3000):
            model = balls(far)
            rounded = model.rounded()
            self.assertFalse(kerf.Mesh(model.vertices.astype(np.float32), model.faces).check())
            np.testing.assert_array_equal(rounded.vertices, rounded.vertices.astype(np.float32))
            self.assertTrue(rounded.check())
            self.assertAlmostEqual(rounded.volume / model.volume, 1, delta=1e-3)

    def test_an_stl_is_a_solid(self):
        with tempfile.TemporaryDirectory() as work:
            path = os.path.join(work, "x.stl")
            balls(200).save(path)
            self.assertIsInstance(kerf.load(path), kerf.Solid)

    def test_a_glb_that_crosses_says_so(self):
        model, block = balls(200), kerf.shapes.block((1, 1, 1), 1)
        both = kerf.Solid(np.concatenate([model.vertices, block.vertices - [200, 0, 0]]),
                          np.concatenate([model.faces, block.faces + len(model.vertices)]))
        with tempfile.TemporaryDirectory() as work:
            with self.assertWarnsRegex(UserWarning, r"x\.glb: \d+ pairs of triangles cross in single precision; save rounded\(\), or a \.ply"):
                both.save(os.path.join(work, "x.glb"))


if __name__ == "__main__":
    unittest.main()
