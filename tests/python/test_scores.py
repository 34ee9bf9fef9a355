"""Scores that are painted, cut out by images, chipped: what Python adds to the library's options."""
import unittest
import warnings

import numpy as np

import kerf
from shapes import block


def cube():
    return kerf.Solid(*block())


def painted(low, high):
    """A cube of many faces whose vertices above the middle have one red, those below another."""
    vertices, faces = block(parts=(10, 10, 10))
    red = np.where(vertices[:, 2] > 0.5, high, low)
    colors = np.zeros((len(red), 3))
    colors[:, 0] = red
    return kerf.Solid(vertices, faces, colors=colors), red


def disc(size, radius):
    """True outside of a disc in the middle: white."""
    y, x = np.mgrid[:size, :size] - (size - 1) / 2
    return x * x + y * y > radius * radius


class Scores(unittest.TestCase):
    def above(self, model, **options):
        """The share of pieces that reach above the middle. Where few cells are below, they do, too."""
        pieces = model.fracture(24, **options)
        return np.mean([piece.vertices[:, 2].max() > 0.6 for piece in pieces])

    def test_density(self):
        model, red = painted(0.1, 1.0)
        by_color, by_value = (kerf.score(model, pieces=24, density=density).sheet.vertices for density in ("red", red))
        np.testing.assert_allclose(by_color, by_value, atol=1e-9)
        for density in ("red", red, lambda p: 1.0 if p[2] > 0.5 else 0.1, lambda p: np.float32(p[2] > 0.5)):
            self.assertGreater(self.above(model, density=density), 0.8)
        self.assertLess(self.above(model, density=lambda p: 2 if p[2] < 0.5 else 0.2), 0.6)
        # A complex knows the colours of its model.
        self.assertEqual(kerf.score(model.complex(), pieces=9, density="red").sheet.vertices.tolist(),
                         kerf.score(model, pieces=9, density="red").sheet.vertices.tolist())

    def test_wrong_densities(self):
        model, red = painted(0.1, 1.0)
        for error, density in ((kerf.InputError, "grey"), (kerf.InputError, red[1:]), (kerf.InputError, -red),
                               (kerf.InputError, "green"), (kerf.InputError, lambda p: -1), 
                               (ZeroDivisionError, lambda p: 1 / 0)):
            with self.assertRaises(error):
                kerf.score(model, pieces=5, density=density)
        for value in ("much", None, (1, 2), np.array([1.0, 2.0]), {}):
            with self.assertRaisesRegex(kerf.InputError, r"density: the callable returned .*; let it return one number, at least 0"):
                kerf.score(model, pieces=5, density=lambda p: value)
        with self.assertRaisesRegex(kerf.InputError, "voronoi and wood"):
            kerf.score(model, "planes", density="red")
        with self.assertRaisesRegex(kerf.InputError, "no colours"):
            kerf.score(cube(), density="red")

    def test_images(self):
        model = cube()
        wanted = np.pi / 16  # a disc of half the width
        for image in (disc(80, 20), disc(80, 20).astype(float), (255 * disc(80, 20)).astype(np.uint8)):
            pieces = model.fracture(pattern="curves", image=image, fit="stretched", tolerance=0.1)
            self.assertEqual(len(pieces), 2)
            self.assertAlmostEqual(pieces[1].volume / wanted, 1, delta=0.02)
            self.assertAlmostEqual(sum(piece.volume for piece in pieces), model.volume, places=12)
        both = kerf.score(model, "curves", image=disc(40, 10), axis="x", up="y",
                          curves=np.array([[0.5, -9, 0.5], [0.5, 9, 0.5]]))
        self.assertEqual(both.pieces, 4)  # the line halves the disc, and what is around
        spotted = disc(40, 10)
        spotted[3, 3] = False
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            kerf.score(model, "curves", image=spotted)
        self.assertIn("1 spot", str(said[0].message))
        for options in ({"image": np.ones((9, 9))}, {"image": np.zeros((9, 9, 3))}, {"image": disc(40, 10), "fit": "wide"},
                        {"image": disc(40, 10), "up": "z", "axis": "z"}, {"image": 3.0 * disc(40, 10)}, {}):
            with self.assertRaises(kerf.InputError):
                kerf.score(model, "curves", **options)

    def test_chips_and_edges(self):
        model = cube()
        score = kerf.score(model, pieces=5, chips=8, chip_size=0.2, seed=3)
        self.assertEqual((score.pieces, score.chips), (5, 8))
        self.assertEqual(len(model.crack(score).pieces()), 13)
        self.assertEqual(len(model.fracture(5, chips=8, chip_size=0.2, seed=3)), 13)
        plain, detailed = (kerf.score(model, pieces=5, edge_detail=height) for height in (0, 0.004))
        self.assertGreater(len(detailed.sheet.faces), 3 * len(plain.sheet.faces))
        self.assertEqual(kerf.score(model, pieces=5, chips=0, chip_size=0.3, edge_detail=0, edge_width=0.1).chips, 0)
        for option, companion in (("chip_size", "chips"), ("edge_width", "edge_detail"), ("up", "image"), ("fit", "image"), ("tolerance", "image")):
            with self.assertRaisesRegex(kerf.InputError, f"{option} changes nothing without {companion}; give both"):
                kerf.score(model, pieces=5, **{option: 0.1})
        for option in ({"image": disc(40, 10)}, {"curves": np.array([[0.5, -9, 0.5], [0.5, 9, 0.5]])}):
            with self.assertRaisesRegex(kerf.InputError, "go with pattern='curves'; give that"):
                kerf.score(model, **option)
        for options in ({"chips": -1}, {"chips": 3, "chip_size": 0}, {"chips": 3, "depth": 0.5}, {"edge_detail": 2}, {"edge_width": 0}):
            with self.assertRaises(kerf.InputError):
                kerf.score(model, pieces=5, **options)


if __name__ == "__main__":
    unittest.main()
