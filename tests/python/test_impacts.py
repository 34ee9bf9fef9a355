"""Solids that break where they are hit: parts, budgets, a second blow, what is refused."""
import unittest

import numpy as np

import kerf
from shapes import block


def cube():
    return kerf.Solid(*block(parts=(4, 4, 4)))


BLOW = dict(point=(1, 0.5, 0.5), direction=(-1, 0, 0), energy=1500)


class Impacts(unittest.TestCase):
    def volumes(self, breaking):
        return sorted(piece.volume for piece in breaking.pieces)

    def test_pieces_are_closed_and_fill_the_solid(self):
        model = cube()
        breaking = model.strike(**BLOW, guard=True)
        self.assertTrue(breaking.finished)
        self.assertGreater(len(breaking.pieces), 5)
        self.assertAlmostEqual(sum(self.volumes(breaking)), model.volume, 9)
        for piece in breaking.pieces:
            solid = kerf.Solid(piece.mesh)
            self.assertAlmostEqual(solid.volume, piece.volume, 12)
            np.testing.assert_allclose(solid.centroid, piece.centroid, atol=1e-12)
            self.assertTrue(piece.whole and not piece.divided)
            self.assertEqual(len(piece.hulls), 1)
            self.assertGreaterEqual(piece.hulls[0].volume, piece.volume * (1 - 1e-9))
            self.assertTrue(np.array_equal(piece.mesh.patch != 0, piece.mesh.groups == piece.mesh.group_names.index("crack")))

    def test_pieces_are_smaller_where_it_is_hit(self):
        pieces = cube().strike(**BLOW).pieces
        near = [piece.volume for piece in pieces if piece.centroid[0] > 0.7]
        far = [piece.volume for piece in pieces if piece.centroid[0] < 0.4]
        self.assertLess(np.median(near), 0.5 * np.median(far))

    def test_more_energy_makes_more_pieces_and_none_makes_none(self):
        glass = kerf.Breakable(cube())
        counts = [len(glass.strike((1, 1, 1), energy).pieces) for energy in (0, 500, 2000)]
        self.assertEqual(counts[0], 1)
        self.assertTrue(counts[0] < counts[1] < counts[2], counts)
        self.assertEqual(len(glass.strike((1, 1, 1), 1e9, max_pieces=3, grading=0).pieces), 3)

    def test_a_break_goes_on_within_budgets(self):
        glass = kerf.Breakable(cube())
        breaking = glass.strike(**BLOW, seconds=0)
        self.assertFalse(breaking.finished)
        first, calls = breaking.parts[0], 0
        self.assertIsNone(first.parent)
        while not breaking.finished:
            self.assertAlmostEqual(sum(self.volumes(breaking)), 1, 9)
            self.assertEqual(breaking.advance(0), breaking.finished)
            calls += 1
        self.assertGreater(calls, 5)
        self.assertIs(breaking.parts[0], first)
        self.assertTrue(first.divided)
        self.assertEqual([part.index for part in breaking.parts], list(range(len(breaking.parts))))
        for part in breaking.parts[1:]:
            self.assertLess(part.parent, part.index)
            self.assertTrue(breaking.parts[part.parent].divided)

    def test_the_same_blow_makes_the_same_pieces(self):
        one, other = (cube().strike(**BLOW, seed=5) for _ in range(2))
        for a, b in zip(one.pieces, other.pieces, strict=True):
            np.testing.assert_array_equal(a.mesh.vertices, b.mesh.vertices)
        self.assertNotEqual(self.volumes(one), self.volumes(cube().strike(**BLOW, seed=6)))

    def test_a_part_is_hit_again_when_its_break_is_gone(self):
        part = max(cube().strike(**BLOW).pieces, key=lambda piece: piece.volume)
        again = part.solid.strike(part.centroid, 300)
        self.assertGreater(len(again.pieces), 1)
        self.assertAlmostEqual(sum(self.volumes(again)), part.volume, 9)
        self.assertTrue((again.pieces[0].mesh.patch != 0).any())

    def test_refused(self):
        glass = kerf.Breakable(cube())
        with self.assertRaisesRegex(kerf.InputError, "open|hole"):
            kerf.Breakable(kerf.Mesh(glass.mesh.vertices, glass.mesh.faces[1:]))
        for wrong, words in ((dict(energy=-1), "energy"), (dict(energy=float("nan")), "energy"), (dict(toughness=0), "toughness"),
                             (dict(max_pieces=1), "max_pieces"), (dict(grading=9), "grading"), (dict(elongation=0), "elongation"),
                             (dict(hull_corners=3), "hull_corners"), (dict(seconds=-1), "seconds"), (dict(point=(0, 0)), "point"),
                             (dict(direction=(0, 0, float("inf"))), "direction|finite")):
            with self.assertRaisesRegex(kerf.InputError, words):
                glass.strike(**{**BLOW, **wrong})
        with self.assertRaisesRegex(TypeError, "toughness"):
            glass.strike(**BLOW, toughnes=3)


if __name__ == "__main__":
    unittest.main()
