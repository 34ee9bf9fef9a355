"""Objects are pickled, copied and passed to worker processes; every value returns to the bit."""
import copy
import multiprocessing
import pickle
import unittest

import numpy as np

import kerf
from values import cube

VERTICES, FACES = cube()
ARRAYS = ("vertices", "faces", "uv", "normals", "colors", "groups", "patch", "site", "source")


def plane():
    return kerf.Mesh([[-1, -1, 0.5], [2, -1, 0.5], [2, 2, 0.5], [-1, 2, 0.5]], [[0, 1, 2], [0, 2, 3]])


def dressed():
    rng = np.random.default_rng(1)
    corners = (len(FACES), 3)
    normals = rng.normal(size=(*corners, 3))
    return kerf.Solid(VERTICES, FACES, uv=rng.random((*corners, 2)), normals=normals, colors=rng.random((*corners, 4)),
                      groups=["a", "b"] * 6, materials="parts.mtl")


def volume_of(solid):
    """For a worker: needs an object that is a Solid there, too."""
    return type(solid).__name__, solid.crack(plane()).pieces()[0].volume


def pieces_of(task):
    solid, seed = task
    broken = solid.crack(kerf.score(solid, "voronoi", pieces=4, seed=seed))
    return broken.pieces(hulls=True), broken


def refused(faces):
    return kerf.Solid(VERTICES, faces)


class Pickles(unittest.TestCase):
    def copies(self, made):
        return [*(pickle.loads(pickle.dumps(made, protocol)) for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1)),
                copy.copy(made), copy.deepcopy(made), copy.deepcopy([made, made])[1]]

    def same_meshes(self, one, other):
        self.assertIs(type(one), type(other))
        for name in ARRAYS:
            a, b = getattr(one, name), getattr(other, name)
            self.assertEqual(a is None, b is None, name)
            if a is not None:
                self.assertEqual(a.dtype, b.dtype)
                np.testing.assert_array_equal(a, b, name)
        self.assertEqual((one.group_names, one.materials), (other.group_names, other.materials))

    def test_meshes(self):
        far = kerf.Mesh(VERTICES * 1e-7 + 1e9 / 3, FACES)
        two_sided = dressed().crack(plane()).surface()
        for mesh in (dressed(), kerf.Solid(VERTICES, FACES), far, plane(), kerf.Mesh(np.empty((0, 3)), np.empty((0, 3), int)), two_sided):
            for again in self.copies(mesh):
                self.same_meshes(mesh, again)
        again = pickle.loads(pickle.dumps(dressed()))
        self.assertEqual(len(again.crack(plane()).pieces()), 2)

    def test_pieces_and_scores(self):
        for piece in dressed().crack(plane()).pieces(hulls=True):
            for again in self.copies(piece):
                self.same_meshes(piece, again)
                self.assertEqual((piece.index, piece.volume), (again.index, again.volume))
                np.testing.assert_array_equal(piece.centroid, again.centroid)
                self.assertEqual(len(piece.hulls), len(again.hulls))
                self.same_meshes(piece.hulls[0], again.hulls[0])
        score = kerf.score(dressed(), "voronoi", pieces=3, chips=4)
        for again in self.copies(score):
            self.same_meshes(score.sheet, again.sheet)
            self.assertEqual((score.pieces, score.chips, score.attempts), (again.pieces, again.chips, again.attempts))

    def test_complexes(self):
        cut = dressed().crack(plane())
        front = cut.front([[-0.5, 0.3, -0.5], [-0.5, 0.3, 1.5]])
        front.advance([[0.4, 0.3, -0.5], [0.4, 0.3, 1.5]])
        for again in self.copies(cut):
            self.same_meshes(cut.surface(), again.surface())
            self.assertTrue(again.check().good)
            self.assertEqual([p.volume for p in cut.pieces()], [p.volume for p in again.pieces()])
            self.assertEqual(len(cut.fronts), len(again.fronts))
            again.fronts[0].advance([[1.5, 0.3, -0.5], [1.5, 0.3, 1.5]])
            self.assertEqual(len(again.pieces()), 4)
        self.assertEqual(len(cut.pieces()), 2)

    def test_nodes_bodies_fronts_and_the_rest(self):
        solid = dressed()
        nodes = kerf.sample(solid, count=60)
        for again in self.copies(nodes):
            for name in ("positions", "radius", "spacing", "volume"):
                np.testing.assert_array_equal(getattr(nodes, name), getattr(again, name))
        body = kerf.Body(solid, nodes)
        for again in self.copies(body):
            self.assertEqual(body.to_bytes(), again.to_bytes())
        front = kerf.Front([[[0, 0, 0], [1, 0, 1 / 3]], [[0, 1, 0], [1, 1, 0]]], name="f")
        sheet = kerf.Front([plane().vertices], triangles=plane().faces)
        for one in (front, sheet):
            for again in self.copies(one):
                self.assertEqual((one.name, one.closed, one.is_sheet), (again.name, again.closed, again.is_sheet))
                np.testing.assert_array_equal(np.array(one.steps), np.array(again.steps))
                np.testing.assert_array_equal(one.triangles, again.triangles)
        soft, hard = kerf.Material(young=1 / 3), kerf.Material(young=1e7, poisson=0.2)
        for again in self.copies(hard):
            self.assertEqual(repr(hard), repr(again))
        for table in (kerf.Materials([soft, hard], [0, 1, 1]), kerf.Materials([soft])):
            for again in self.copies(table):
                self.assertEqual(len(table), len(again))
                self.assertEqual(table.fits(3), again.fits(3))
                self.assertEqual(repr(table[0]), repr(again[0]))
        stats = kerf.Mesh(VERTICES, FACES[:-1]).repair()[1]
        for again in self.copies(stats):
            self.assertEqual((stats.filled_holes, repr(stats)), (1, repr(again)))
        scene = kerf.Scene("[[body]]\nmesh = 'a.ply'\n[material]\nyoung = 3e4\n", young=5e4)
        for again in self.copies(scene):
            self.assertEqual(repr(scene), repr(again))

    def test_workers(self):
        solid = dressed()
        with multiprocessing.get_context("spawn").Pool(2) as pool:
            self.assertEqual(pool.map(volume_of, [solid, solid]), [("Solid", 0.5)] * 2)
            for pieces, broken in pool.map(pieces_of, [(solid, 1), (solid, 2)]):
                self.assertAlmostEqual(sum(p.volume for p in pieces), 1)
                self.assertEqual(len(broken.pieces()), len(pieces))
            with self.assertRaises(kerf.InputError):
                pool.apply(refused, (FACES[:-1],))

    def test_damaged_states(self):
        _, arguments, state = (*dressed().__reduce_ex__(2), None)[:3]
        for change in (lambda s: s[:-1], lambda s: (99, *s[1:]), lambda s: (*s[:2], s[2][:-4], *s[3:]), lambda s: (s[0], s[1][:24], *s[2:])):
            with self.assertRaises(kerf.InputError):
                kerf.Mesh.__new__(kerf.Mesh).__setstate__(change(state))


if __name__ == "__main__":
    unittest.main()
