"""Uses the installed module as docs/python.md shows it; run by tests/installed in a bare system, where kerf-model has written
pumpkin.ply into the folder given."""
import pathlib
import sys

import kerf

folder = pathlib.Path(sys.argv[1])
assert pathlib.Path(kerf.__file__).parts[1:4] == ("usr", "lib", "python3"), kerf.__file__

tetrahedron = kerf.Solid([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
assert abs(tetrahedron.volume - 1 / 6) < 1e-15
try:
    kerf.Solid(tetrahedron.vertices, tetrahedron.faces[:3])
except kerf.InputError as error:
    print("refused:", error)
else:
    raise SystemExit("an open mesh was taken for a solid")
print("kerf", kerf.__version__, tetrahedron)
