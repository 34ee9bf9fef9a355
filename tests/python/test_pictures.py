"""Pictures show what is there: colours, sizes, cut-aways; refusals; what notebooks show."""
import base64
import re
import unittest
import zlib

import numpy as np

import kerf
import values

SIZE = (96, 72)


def cube(**options):
    return kerf.Solid(*values.cube(), **options)


def red(picture):
    """The share of pixels that are mainly red."""
    r, g, b = (picture[..., i].astype(int) for i in range(3))
    return float(np.mean((r > 1.5 * g) & (r > 1.5 * b)))


class Pictures(unittest.TestCase):
    def test_a_cube(self):
        picture = kerf.picture(cube(), size=SIZE, samples=1)
        self.assertEqual((picture.shape, picture.dtype), ((72, 96, 3), np.uint8))
        self.assertFalse(picture.flags.writeable)
        self.assertGreater(red(picture), 0.05)  # the skin is orange
        np.testing.assert_array_equal(picture, kerf.picture(cube(), size=SIZE, samples=1))
        self.assertLess(red(kerf.picture(cube(), size=SIZE, samples=1, skin="#3050e0")), 0.01)

    def test_views_differ(self):
        first = kerf.picture(cube(), size=SIZE, samples=1)
        for options in (dict(camera=(80, 10)), dict(zoom=2), dict(cut_away=(1, 0, 0)), dict(cut_away=(1, 0, 0, 0.2), hollow=True),
                        dict(wire=True), dict(ground=False), dict(opacity=0.3), dict(color="piece")):
            self.assertFalse(np.array_equal(first, kerf.picture(cube(), size=SIZE, samples=1, **options)), options)
        lower = cube()
        tall = kerf.Solid(lower.vertices * [1, 4, 1], lower.faces)
        self.assertFalse(np.array_equal(kerf.picture(tall, size=SIZE, samples=1), kerf.picture(tall, size=SIZE, samples=1, up="y")))

    def test_numbers_as_colors(self):
        solid = cube()
        low = kerf.picture(solid, size=SIZE, samples=1, color=np.zeros(8), color_range=(0, 1), ground=False)
        high = kerf.picture(solid, size=SIZE, samples=1, color=np.ones(8), color_range=(0, 1), ground=False)
        self.assertGreater(high[36, 48, 1], low[36, 48, 1] + 40)  # yellow over dark blue

    def test_the_colors_of_a_model(self):
        green = cube(colors=np.tile([0.0, 1.0, 0.0, 1.0], (8, 1)))

        def is_green(picture):
            r, g, b = picture[36, 48].astype(int)
            return g > 2 * max(r, b)

        self.assertTrue(is_green(kerf.picture(green, size=SIZE, samples=1)))
        self.assertFalse(is_green(kerf.picture(green, size=SIZE, samples=1, color="patch")))
        self.assertFalse(is_green(kerf.picture(green, size=SIZE, samples=1, color=np.zeros(8))))
        pieces = green.crack(kerf.score(green, "planes", pieces=2, axis="z", jagged=0)).pieces()
        self.assertTrue(is_green(kerf.picture(pieces, size=SIZE, samples=1, color="model")))
        self.assertFalse(is_green(kerf.picture(pieces, size=SIZE, samples=1)))

    def test_pieces(self):
        solid = cube()
        pieces = solid.crack(kerf.score(solid, "planes", pieces=2, axis="z", jagged=0)).pieces()
        together = kerf.picture(pieces, size=SIZE, samples=1)
        apart = kerf.picture(pieces, size=SIZE, samples=1, explode=0.5)
        self.assertFalse(np.array_equal(together, apart))

    def test_nodes(self):
        solid = cube()
        nodes = kerf.sample(solid, spacing=0.3)
        picture = kerf.picture(nodes, size=SIZE, samples=1, ground=False)
        self.assertFalse(np.array_equal(picture, kerf.picture(nodes, size=SIZE, samples=1, ground=False, field=nodes.positions[:, 0])))
        with self.assertRaises(kerf.InputError):
            kerf.picture(nodes, size=SIZE, field=[1.0, 2.0])

    def test_refusals(self):
        for options in (dict(size=(3, 3)), dict(size=(10, 20, 30)), dict(size="96x72"), dict(camera=(1,)), dict(camera=(float("nan"), 0)),
                        dict(zoom=0), dict(up="x"), dict(color="stress"), dict(color=[1.0]), dict(color=[np.nan] * 8), dict(skin="orange"),
                        dict(skin=3), dict(opacity=2), dict(explode=-1), dict(cut_away=(0, 0, 0)), dict(cut_away=(1, 2)), dict(samples=0),
                        dict(color_range=(1,), color=[1.0] * 8)):
            with self.assertRaises(kerf.InputError, msg=options) as caught:
                kerf.picture(cube(), **{"size": SIZE, **options})
            self.assertNotIn("\n", str(caught.exception))
        for thing in (None, 3, "bear.obj", [], [1], [None], object()):
            with self.assertRaises(kerf.InputError, msg=thing):
                kerf.picture(thing)

    def test_progress_stops_it(self):
        seen = []
        kerf.picture(cube(), size=SIZE, samples=1, progress=lambda *report: seen.append(report))
        self.assertTrue(seen)
        with self.assertRaises(kerf.Interrupted):
            kerf.picture(cube(), size=SIZE, progress=lambda *report: False)
        with self.assertRaises(ZeroDivisionError):
            kerf.picture(cube(), size=SIZE, progress=lambda *report: 1 / 0)


def pixels_of(png):
    """Width, height and bytes of a PNG's rows."""
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    at, data, size = 8, b"", None
    while at < len(png):
        length, kind = int.from_bytes(png[at:at + 4], "big"), png[at + 4:at + 8]
        body = png[at + 8:at + 8 + length]
        assert zlib.crc32(kind + body) == int.from_bytes(png[at + 8 + length:at + 12 + length], "big")
        if kind == b"IHDR":
            size = int.from_bytes(body[:4], "big"), int.from_bytes(body[4:8], "big")
        data += body if kind == b"IDAT" else b""
        at += 12 + length
    return size, zlib.decompress(data)


class Notebooks(unittest.TestCase):
    def shown(self, thing):
        size, rows = pixels_of(thing._repr_png_())
        self.assertEqual(size, (480, 360))
        self.assertEqual(len(rows), 360 * (1 + 3 * 480))
        text = thing._repr_html_()
        self.assertEqual(pixels_of(base64.b64decode(re.search("base64,([^']+)'", text)[1]))[1], rows)
        return text

    def test_mesh(self):
        self.assertIn("<td>12</td>", self.shown(cube()))
        self.shown(kerf.Mesh([], []))

    def test_complex(self):
        solid = cube()
        self.assertIn("cracks", self.shown(solid.crack(kerf.score(solid, "planes", pieces=2, axis="z", jagged=0))))

    def test_body(self):
        self.assertIn("nodes", self.shown(kerf.Body(cube(), spacing=0.3)))


if __name__ == "__main__":
    unittest.main()
