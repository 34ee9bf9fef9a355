"""Geometry of the module kerf: values against known results, lifetimes of views, refusals."""
import gc
import os
import threading
import tempfile
import unittest

import kerf
import numpy as np

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
CUBE_FACES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
                       [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])
NO_ID = 2**32 - 1


def cube(**attributes):
    return kerf.Solid(CUBE, CUBE_FACES, **attributes)


def plane(z=0.5, size=3.0):
    """A square sheet across the cube at height z."""
    corners = np.array([[-size, -size, z], [size, -size, z], [size, size, z], [-size, size, z]])
    return kerf.Mesh(corners, [[0, 1, 2], [0, 2, 3]])


LINE = np.array([[-0.5, -0.5, 0.5], [1.5, -0.5, 0.5]])
STEP = np.array([0.0, 1.0, 0.0])


class Cracks(unittest.TestCase):
    def test_a_plane_halves_a_cube(self):
        c = cube().crack(plane(0.25))
        self.assertEqual(c.piece_count, 2)
        np.testing.assert_allclose(c.piece_volumes, [0.75, 0.25], rtol=1e-14)
        bonds = c.bonds
        self.assertEqual(bonds.dtype.names, ("a", "b", "area", "normal", "centroid", "section"))
        self.assertEqual((bonds["a"][0], bonds["b"][0], len(bonds)), (0, 1, 1))
        self.assertAlmostEqual(bonds["area"][0], 1, places=14)
        np.testing.assert_allclose(bonds["normal"][0], [0, 0, -1], atol=1e-14)
        np.testing.assert_allclose(bonds["centroid"][0], [0.5, 0.5, 0.25], atol=1e-14)
        self.assertAlmostEqual(bonds["section"][0], 2**0.5 / 12, places=14)  # of a unit square, bent about a diagonal

    def test_pieces_stick_out_of_limited_hulls_by_little(self):
        models = [kerf.shapes.pumpkin(16)]
        folder = os.environ.get("KERF_MODEL_FOLDER", "")
        if os.path.exists(os.path.join(folder, "bear.off")):
            models.append(kerf.Solid.load(os.path.join(folder, "bear.off")))
        for model in models:
            cracked = model.crack(kerf.score(model, pieces=30, seed=7))
            for corners, most in ((64, 0.01), (32, 0.03)):
                for piece in cracked.pieces(hulls=True, corners=corners):
                    hull, = piece.hulls
                    out = [(piece.vertices - corner[0]) @ normal for corner, normal in zip(hull.corners, hull.face_normals)]
                    self.assertLessEqual(np.max(out), most * np.linalg.norm(np.ptp(piece.vertices, axis=0)))

    def test_the_lines_of_the_introduction(self):
        uv = CUBE[:, :2]
        s = kerf.Solid(CUBE, CUBE_FACES, uv=uv, groups=["top"] * 6 + ["rest"] * 6)
        c = s.crack(kerf.score(s, "voronoi", pieces=30, jagged=0.02, seed=7))
        pieces = c.pieces(hulls=True)
        self.assertEqual(len(pieces), 30)
        for p in pieces:
            self.assertTrue(p.check())
            self.assertAlmostEqual(p.volume, kerf.Mesh(p.vertices, p.faces).volume, places=12)
            self.assertEqual(len(p.patch), len(p.faces))
            self.assertTrue(((p.patch == 0) == (p.source != NO_ID)).all())
            self.assertEqual(set(p.groups[p.patch != 0]), {p.group_names.index("crack")})
            self.assertEqual(p.uv.shape, (len(p.faces), 3, 2))
            self.assertEqual(len(p.hulls), 1)
            self.assertGreaterEqual(p.hulls[0].volume, 0.5 * p.volume)
            self.assertLessEqual(len(p.hulls[0].vertices), 64)
        self.assertAlmostEqual(sum(p.volume for p in pieces), 1, places=12)
        self.assertGreaterEqual(len(c.bonds), 29)
        self.assertTrue(c.check())

    def test_a_front_goes_on_step_by_step(self):
        c = cube().complex()
        f = c.front(LINE)
        delta = f.advance(LINE + STEP)
        self.assertEqual(c.piece_count, 1)
        self.assertGreater(len(delta.new_crack_faces), 0)
        self.assertEqual(delta.stats["attempts"], 1)
        f.advance(LINE + 2 * STEP)
        self.assertEqual((c.piece_count, f.crack, f.step), (2, 1, 2))
        np.testing.assert_allclose(c.piece_volumes, [0.5, 0.5], rtol=1e-14)
        np.testing.assert_array_equal(f.points, LINE + 2 * STEP)
        self.assertTrue(c.check())

    def test_undo_restores_complex_and_front(self):
        c = cube().complex()
        f = c.front(LINE)
        f.advance(LINE + STEP)
        points, faces, segments = c.points, c.faces, f.segments
        f.advance(LINE + 2 * STEP)
        c.undo()
        np.testing.assert_array_equal(c.points, points)
        np.testing.assert_array_equal(c.faces, faces)
        self.assertEqual(f.step, 1)
        np.testing.assert_array_equal(f.segments[0][1], segments[0][1])
        with self.assertRaises(kerf.GeometryError):
            c.undo()
        f.advance(LINE + 2 * STEP)
        self.assertEqual(c.piece_count, 2)

    def test_undo_of_a_step_that_met_nothing(self):
        c = cube().complex()
        c.insert(plane())
        f = c.front(LINE + 5)
        self.assertFalse(f.advance(LINE + 6))
        c.undo()
        self.assertEqual((c.piece_count, f.step), (2, 0))

    def test_all_kinds_of_cracks(self):
        s = cube()
        steps = [LINE, LINE + STEP, LINE + 2 * STEP]
        front = kerf.Front(steps, name="halve")
        for what in (steps, np.array(steps), front, [front], plane(), [plane()],
                     kerf.score(s, "planes", pieces=2, jagged=0)):
            c = s.crack(what)
            self.assertEqual(c.piece_count, 2)
            self.assertAlmostEqual(sum(c.piece_volumes), 1, places=14)
        c = s.crack([front, plane(0.25), plane(0.75)])
        self.assertEqual((c.piece_count, c.crack_count, len(c.fronts)), (4, 3, 1))
        c = s.crack(front, max_move=0.25)
        self.assertEqual(c.fronts[0].step, 2)

    def test_hierarchy(self):
        solid = cube()
        for seed in range(1, 9):
            with self.subTest(seed=seed):
                c = solid.crack(kerf.score(solid, "voronoi", pieces=30, seed=seed, jagged=0))
                pieces, least = c.piece_count, float(np.median(c.piece_volumes))
                levels = c.hierarchy(4)
                below, volumes = pieces, c.piece_volumes
                for level in levels:
                    self.assertEqual(len(level.of), below)
                    np.testing.assert_allclose(np.bincount(level.of, volumes), level.volume, rtol=1e-12)
                    self.assertTrue((np.diff(level.volume) <= 0).all())
                    self.assertTrue((level.bonds["a"] < level.bonds["b"]).all())
                    below, volumes = len(level.volume), level.volume
                self.assertEqual((len(levels), below), (3, 1))
                self.assertEqual(c.hierarchy(1), [])
                # The first level's areas are the sums of those between its clusters.
                a, b = (levels[0].of[c.bonds[k]] for k in "ab")
                self.assertAlmostEqual(c.bonds["area"][a != b].sum(), levels[0].bonds["area"].sum(), places=12)
                delta = c.join_small_pieces(least)
                self.assertEqual(delta.stats, {"joined": pieces - c.piece_count, "isolated": 0})
                self.assertGreater(delta.stats["joined"], 0)
                self.assertGreaterEqual(min(c.piece_volumes), least)
                self.assertAlmostEqual(sum(c.piece_volumes), 1, places=12)
                self.assertTrue(c.check())
                self.assertTrue(all(kerf.Mesh(p.vertices, p.faces).check() for p in c.pieces()))
                c.undo()
                self.assertEqual(c.piece_count, pieces)
                c.heal(np.arange(pieces) % 1)
                self.assertEqual(c.piece_count, 1)
                for call in (lambda: c.heal([0, 0]), lambda: c.heal([-1]), lambda: c.join_small_pieces(-1),
                             lambda: c.join_small_pieces(np.nan), lambda: c.hierarchy(0)):
                    self.assertRaises(kerf.InputError, call)

    def test_edits(self):
        c = cube().crack(plane())
        self.assertEqual(c.roughen(amplitude=0.02, frequency=4, seed=3).stats["refused"], 0)
        self.assertGreater(c.live_face_count, 200)
        self.assertAlmostEqual(sum(c.piece_volumes), 1, places=12)
        before = c.live_face_count
        self.assertGreater(c.decimate(deviation=0.02).stats["collapses"], 0)
        self.assertLess(c.live_face_count, before)
        self.assertTrue(c.check())
        asked = []
        c.remesh(angle=30, may_sweep=lambda corners: asked.append(corners.shape) or True)
        self.assertTrue(all(shape == (4, 3) for shape in asked))
        with self.assertRaises(ZeroDivisionError):
            thin = cube().crack([plane(0.5), plane(0.51)])
            thin.roughen(amplitude=0.001)
            thin.remesh(angle=30, deviation=0.1, may_sweep=lambda corners: 1 / 0)
        with self.assertRaises(kerf.GeometryError):
            c.undo()

    def test_difference_and_apply(self):
        s = cube()
        uncut, cut = s.complex(), s.crack(plane())
        edit = uncut.difference(cut)
        delta = uncut.apply(edit)
        self.assertEqual(len(delta.new_faces), len(edit.new_faces))
        self.assertEqual(uncut.piece_count, 2)
        with self.assertRaises(kerf.InputError):
            cut.difference(s.complex())
        with self.assertRaises(kerf.GeometryError):
            s.complex().apply(kerf.ComplexEdit(removed_faces=[0]))
        with self.assertRaises(kerf.GeometryError):
            s.complex().apply(kerf.ComplexEdit(new_faces=[[0, 1, 99]]))
        with self.assertRaises(kerf.InputError):
            s.complex().apply(kerf.ComplexEdit(new_faces=[[0, 1, 2]], parents=[99]))

    def test_copies_are_independent(self):
        c = cube().complex()
        f = c.front(LINE)
        f.advance(LINE + STEP)
        d = c.copy()
        f.advance(LINE + 2 * STEP)
        self.assertEqual((c.piece_count, d.piece_count), (2, 1))
        d.fronts[0].advance(LINE + 2 * STEP)
        self.assertEqual(d.piece_count, 2)


class Queries(unittest.TestCase):
    def test_incidence(self):
        c = cube().crack(plane())
        faces, cracks, alive = c.faces, c.face_cracks, c.alive
        self.assertEqual(alive.sum(), c.live_face_count)
        wall = np.flatnonzero(alive & (cracks == 1))
        np.testing.assert_allclose(c.points[faces[wall]][..., 2], 0.5)
        for f in wall:
            self.assertTrue(c.has_side(f, 0) and c.has_side(f, 1))
            for k in range(3):
                self.assertIn(f, c.faces_at(faces[f][k]))
                around = c.faces_around(faces[f][k], faces[f][(k + 1) % 3])
                self.assertIn(f, around)
                self.assertIn(len(around), (2, 3))
                g, which = c.neighbor(f, 0, k)
                self.assertTrue(c.has_side(g, which))
                v = c.surface_vertex(f, 1, k)
                self.assertEqual(c.sites[v], faces[f][k])
                self.assertEqual(c.sites[c.surface_vertex(*c.corner_of(v))], c.sites[v])
                self.assertGreater(len(c.surface_neighbors(v)), 2)
        np.testing.assert_array_equal(c.faces_on_segment([0.3, 0.2, 0.4], [0.3, 0.2, 0.6]).size, 1)
        np.testing.assert_array_equal(np.sort(c.faces_near([0.2, 0.2, 0.45], [0.8, 0.8, 0.55])), wall)
        self.assertEqual(set(wall) - set(c.faces_near_triangle(c.corners(wall[0]), 1e-9)), set())
        np.testing.assert_array_equal(c.box(wall[0])[:, 2], [0.5, 0.5])
        self.assertEqual(c.self_intersections().shape, (0, 2))
        self.assertTrue(c.check_near(wall))

    def test_surface(self):
        c = cube(groups=["skin"] * 12).crack(plane())
        surface = c.surface()
        self.assertTrue(surface.two_sided and surface.check())
        self.assertEqual(surface.crossings(), 0)
        self.assertEqual((surface.patch == 1).sum(), (surface.patch == -1).sum())
        self.assertEqual(kerf.Complex(surface).piece_count, 2)
        np.testing.assert_array_equal(surface.site, c.sites[c.sites != NO_ID])

    def test_deformed_pieces(self):
        c = cube().crack(plane(0.25))
        moved = 2 * c.surface().vertices
        np.testing.assert_allclose([p.volume for p in c.pieces(moved=moved)], [6, 2])
        np.testing.assert_allclose(c.find_bonds(moved)["centroid"][0], [1, 1, 0.5])
        with self.assertRaises(kerf.InputError):
            c.pieces(moved=moved[:-1])

    def test_ids_out_of_range(self):
        c = cube().crack(plane())
        dead = np.flatnonzero(~c.alive)[0]
        for call in (lambda: c.corners(-1), lambda: c.corners(c.face_count), lambda: c.faces_at(10**9),
                     lambda: c.faces_around(0, c.vertex_count), lambda: c.box(dead), lambda: c.neighbor(dead, 0, 0),
                     lambda: c.neighbor(c.face_count - 1, 2, 0), lambda: c.surface_vertex(c.face_count - 1, 0, 3),
                     lambda: c.corner_of(c.surface_vertex_count), lambda: c.surface_neighbors(-1),
                     lambda: c.check_near([c.face_count]), lambda: c.remesh(region=[-1]),
                     lambda: c.roughen(cracks=[2])):
            with self.assertRaises(kerf.InputError):
                call()

    def test_predicates(self):
        a = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
        b = np.array([[0.2, 0.2, -1], [0.2, 0.2, 1], [2, 2, 0]])
        self.assertTrue(kerf.faces_cross([0, 1, 2], a, [3, 4, 5], b))
        self.assertFalse(kerf.faces_cross([0, 1, 2], a, [3, 4, 5], b + [5, 0, 0]))
        self.assertTrue(kerf.in_radial_order([0, 0, 0], [0, 0, 1], [[1, 0, 0], [0, 1, 0], [-1, 0, 0]]))
        self.assertFalse(kerf.in_radial_order([0, 0, 0], [0, 0, 1], [[1, 0, 0], [-1, 0, 0], [0, 1, 0]]))
        self.assertAlmostEqual(kerf.smallest_angle(a), 45)
        np.testing.assert_array_equal(kerf.face_normal(a), [0, 0, 1])
        counter = kerf.CrossingCounter()
        both = kerf.Mesh(np.vstack([a, b]), [[0, 1, 2], [3, 4, 5]])
        self.assertEqual((counter.count(both), counter.count(both), both.crossings()), (1, 1, 1))
        self.assertEqual(kerf.substep_count(LINE, LINE + STEP, 0.3), 4)
        self.assertEqual(kerf.resample_front(LINE, np.vstack([LINE, LINE[1:] + 1])).shape, (2, 3))


class Lifetimes(unittest.TestCase):
    def test_views_outlive_their_owners(self):
        c = cube().crack(plane())
        pieces = c.pieces(hulls=True)
        kept = [(p.vertices, p.vertices.copy(), p.faces, p.faces.copy(), p.hulls[0].vertices) for p in pieces]
        bonds, delta = c.bonds, c.front(LINE).advance(LINE + 0.1)
        new_faces, points = delta.new_faces, c.points
        copies = bonds.copy(), new_faces.copy(), points.copy()
        del c, pieces, delta
        gc.collect()
        for vertices, vertices_copy, faces, faces_copy, hull in kept:
            np.testing.assert_array_equal(vertices, vertices_copy)
            np.testing.assert_array_equal(faces, faces_copy)
            self.assertTrue(np.isfinite(hull).all())
            self.assertFalse(vertices.flags.writeable or faces.flags.writeable)
        for view, copy in zip((bonds, new_faces, points), copies):
            np.testing.assert_array_equal(view, copy)

    def test_an_edit_leaves_snapshots(self):
        c = cube().complex()
        before = c.points
        copy = before.copy()
        c.insert(plane())
        np.testing.assert_array_equal(before, copy)

    def test_a_front_keeps_its_complex(self):
        f = cube().complex().front(LINE)
        gc.collect()
        f.advance(LINE + 2 * STEP)
        self.assertEqual(f.complex.piece_count, 2)


class Use(unittest.TestCase):
    def test_a_saved_score_cuts_as_the_score_does(self):
        s = cube()
        walls = kerf.score(s, "voronoi", pieces=6, seed=3)
        with tempfile.TemporaryDirectory() as work:
            path = os.path.join(work, "walls.front")
            walls.save(path)
            front, = kerf.load(path)
            with self.assertRaises(kerf.OutputError):
                walls.save(os.path.join(work, "none", "walls.front"))
        self.assertTrue(front.is_sheet)
        self.assertEqual(list(s.crack(front).piece_volumes), list(s.crack(walls).piece_volumes))

    def test_progress(self):
        s, told = cube(), []
        kerf.score(s, pieces=8, progress=lambda *report: told.append(report))
        self.assertTrue(told)
        s.crack([LINE, LINE + STEP, LINE + 2 * STEP], progress=lambda *report: told.append(report))
        self.assertEqual(told[-1][1:], (2, 2))
        with self.assertRaises(kerf.Interrupted):
            kerf.score(s, pieces=8, progress=lambda *report: False)
        with self.assertRaises(ZeroDivisionError):
            kerf.score(s, pieces=8, progress=lambda *report: 1 / 0)

    def test_a_complex_in_use_is_not_changed(self):
        c = cube().complex()
        def change(*report):
            c.insert(plane())
        with self.assertRaisesRegex(kerf.Error, "in use"):
            kerf.score(c, pieces=8, progress=change)
        c.insert(plane())
        self.assertEqual(c.piece_count, 2)

    def test_two_threads(self):
        c, errors = cube().crack(plane()), []

        def work():
            for _ in range(50):
                try:
                    c.roughen(amplitude=0.001)
                    c.pieces()
                except kerf.Error as error:
                    errors.append(error)

        threads = [threading.Thread(target=work) for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertTrue(c.check())

    def test_bad_arguments(self):
        s = cube()
        c = s.complex()
        for error, call in (
                (kerf.InputError, lambda: kerf.score(s, "glas")),
                (TypeError, lambda: kerf.score(s, peces=3)),
                (TypeError, lambda: kerf.score(s, pieces="3")),
                (TypeError, lambda: kerf.score(s, pieces=2.5)),
                (TypeError, lambda: kerf.score(s, jagged=True)),
                (kerf.InputError, lambda: kerf.score(s, jagged=float("nan"))),
                (kerf.InputError, lambda: kerf.score(s, pieces=2**70)),
                (kerf.InputError, lambda: kerf.score(s, "curves")),
                (kerf.InputError, lambda: kerf.score(s, axis=[0, 0, 0])),
                (kerf.InputError, lambda: kerf.score(None)),
                (kerf.InputError, lambda: kerf.score(plane())),
                (kerf.InputError, lambda: s.crack(None)),
                (kerf.InputError, lambda: s.crack([])),
                (kerf.InputError, lambda: s.crack([LINE])),
                (kerf.InputError, lambda: s.crack(np.array(1.0))),
                (kerf.InputError, lambda: s.crack(np.zeros((0, 2, 3)))),
                (kerf.InputError, lambda: s.crack(["a", "b"])),
                (kerf.InputError, lambda: c.insert(5)),
                (kerf.InputError, lambda: c.front(LINE[:1])),
                (kerf.InputError, lambda: c.front(LINE * np.nan)),
                (kerf.InputError, lambda: c.front(LINE, closed=True)),
                (TypeError, lambda: c.front(LINE, attempt=3)),
                (kerf.InputError, lambda: c.front(LINE).advance(LINE[:0])),
                (kerf.InputError, lambda: c.pieces(corners=3)),
                (kerf.InputError, lambda: c.pieces(tile=0)),
                (kerf.InputError, lambda: kerf.Complex(plane())),
                (kerf.InputError, lambda: kerf.Front([], name="a")),
                (TypeError, lambda: kerf.score(s, progress=3))):
            with self.assertRaises(error):
                call()


if __name__ == "__main__":
    unittest.main()
