"""Samples fulfil mypy --strict with the types of the package, a wrong program does not; the types fit the module."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Types(unittest.TestCase):
    def mypy(self, *paths):
        with tempfile.TemporaryDirectory() as cache:
            return subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", cache, *paths], cwd=ROOT,
                                  capture_output=True, text=True)

    def test_samples(self):
        done = self.mypy("samples/python")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_a_fault_is_found(self):
        with tempfile.TemporaryDirectory() as work:
            path = pathlib.Path(work) / "wrong.py"
            path.write_text("import kerf\nvolume: str = kerf.shapes.sphere(2).volume\nkerf.shapes.sphere(2).colour\n")
            done = self.mypy(str(path))
            self.assertIn("wrong.py:2: error", done.stdout)
            self.assertIn("wrong.py:3: error", done.stdout)

    def test_types_are_those_of_the_module(self):
        done = subprocess.run([sys.executable, "-m", "mypy.stubtest", "kerf"], capture_output=True, text=True,
                              env=dict(os.environ, MYPYPATH=os.environ["PYTHONPATH"]))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
