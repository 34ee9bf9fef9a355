"""Each program of samples/python runs by itself in an empty folder, and writes what its description says."""
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

import kerf

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "samples" / "python"
# What each writes; the asserts of a sample are part of it.
WRITTEN = {
    "fracture": ["pumpkin.glb", *(f"piece_{i:02}.ply" for i in range(30))],
    "knife": ["knife.ply"],
    "peridynamics": [],
    "roundtrip": [],
    "seeds": ["seeds.png"],
}


class Samples(unittest.TestCase):
    def run_sample(self, name, work):
        """Runs it as a user does; its output."""
        path = FOLDER / f"{name}.py"
        self.assertTrue(path.read_text().startswith('"""'), "a sample begins with its description")
        done = subprocess.run([sys.executable, path], cwd=work, capture_output=True, text=True, timeout=600)
        self.assertEqual(done.returncode, 0, done.stderr)
        said = [line for line in done.stderr.splitlines() if "atplotlib" not in line]  # it tells of its cache of fonts
        self.assertEqual(said, [])
        self.assertEqual(sorted(p.name for p in work.iterdir()), sorted(WRITTEN[name]))
        return done.stdout

    def test_every_sample_has_a_test(self):
        self.assertEqual({p.stem for p in FOLDER.glob("*.py")}, set(WRITTEN))
        for name in WRITTEN:
            self.assertTrue(hasattr(self, f"test_{name}"), name)

    def test_fracture(self):
        with tempfile.TemporaryDirectory() as work:
            work = pathlib.Path(work)
            self.run_sample("fracture", work)
            pieces = [kerf.load(path) for path in sorted(work.glob("piece_*.ply"))]
            for piece in pieces:
                self.assertIsInstance(piece, kerf.Solid)
            model = kerf.shapes.pumpkin(16)
            self.assertAlmostEqual(sum(piece.volume for piece in pieces) / model.volume, 1, places=6)
            self.assertEqual((work / "pumpkin.glb").read_bytes()[:4], b"glTF")

    def test_knife(self):
        with tempfile.TemporaryDirectory() as work:
            work = pathlib.Path(work)
            said = self.run_sample("knife", work).splitlines()
            self.assertIn("1 pieces", said[0])
            self.assertIn("2 pieces", said[-1])
            halves = kerf.load(work / "knife.ply")
            self.assertTrue(halves.two_sided)
            self.assertGreater((halves.patch == 1).sum(), 0)
            self.assertEqual((halves.patch == 1).sum(), (halves.patch == -1).sum())

    def test_peridynamics(self):
        with tempfile.TemporaryDirectory() as work:
            said = self.run_sample("peridynamics", pathlib.Path(work))
            self.assertIn("dissipated per area of crack", said)

    def test_roundtrip(self):
        with tempfile.TemporaryDirectory() as work:
            self.assertIn("4 pieces", self.run_sample("roundtrip", pathlib.Path(work)))

    def test_seeds(self):
        with tempfile.TemporaryDirectory() as work:
            work = pathlib.Path(work)
            said = self.run_sample("seeds", work)
            self.assertEqual(said.count("20 to 20 pieces"), 3)
            data = (work / "seeds.png").read_bytes()
            self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
            self.assertEqual(struct.unpack(">II", data[16:24]), (1200, 400))


if __name__ == "__main__":
    unittest.main()
