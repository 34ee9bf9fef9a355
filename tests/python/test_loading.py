"""What importing the module loads, and what it does not."""
import os
import pathlib
import subprocess
import sys
import unittest

import kerf

FOLDER = pathlib.Path(kerf.__file__).parent


def needed(library):
    """Names of the shared libraries that a library asks for, directly or not."""
    text = subprocess.run(["ldd", library], capture_output=True, text=True, check=True).stdout
    return [line.split()[0] for line in text.splitlines() if line.strip()]


class Loading(unittest.TestCase):
    def test_heavy_libraries_are_not_needed(self):
        (extension,) = FOLDER.glob("_kerf.*.so")
        names = needed(extension)
        self.assertTrue(any("libtbb" in name or "libstdc++" in name for name in names), names)
        for heavy in ("openvdb", "hdf5", "embree", "pcl", "boost", "webp", "png"):
            self.assertFalse([name for name in names if heavy in name], f"kerf._kerf needs {heavy}")

    def test_import_loads_neither_numpy_nor_the_renderer(self):
        code = "import sys, kerf; print([m for m in ('numpy', 'kerf._picture', 'kerf._formats') if m in sys.modules])"
        run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=dict(os.environ))
        self.assertEqual(run.stdout.strip(), "[]")

    def test_the_version_is_that_of_the_project(self):
        text = (pathlib.Path(__file__).parents[2] / "CMakeLists.txt").read_text()
        self.assertIn(f"VERSION {kerf.__version__} ", text)


if __name__ == "__main__":
    unittest.main()
