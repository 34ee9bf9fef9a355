"""Uses the installed module as docs/python.md shows it; run by tests/installed in a bare system, where kerf-model has written
pumpkin.ply into the folder given."""
import pathlib
import sys

import kerf

folder = pathlib.Path(sys.argv[1])
assert pathlib.Path(kerf.__file__).parts[1:4] == ("usr", "lib", "python3"), kerf.__file__
assert "numpy" not in sys.modules

s = kerf.load(folder / "pumpkin.ply")
s = kerf.Solid(s.vertices, s.faces)
c = s.crack(kerf.score(s, "voronoi", pieces=30, jagged=0.02, seed=7))
pieces = c.pieces(hulls=True)
for p in pieces:
    p.vertices, p.faces, p.patch, p.source, p.volume
assert len(pieces) == 30 and abs(sum(p.volume for p in pieces) / s.volume - 1) < 1e-9
assert len(c.bonds) >= 29 and c.bonds["area"].min() > 0

c = s.complex()
low, high = s.bounds
line = [[low[0] - 1, 0.01, low[2] - 0.1], [high[0] + 1, 0.02, low[2] - 0.1]]
next_line = [[x, y, high[2] + 0.1] for x, y, _ in line]
f = c.front(line)
f.advance(next_line)
assert len(c.pieces()) == 2

b = kerf.Body(c, spacing=0.2)
assert b.graph.indptr[-1] == len(b.graph.indices) == len(b.graph.distances)
assert b.graph.components()[0] == 2

(folder / "scene.toml").write_text("""
[body]
mesh = "pumpkin.ply"
spacing = 0.3
[[blade]]
name = "knife"
points = [[-2, 0, 0], [2, 0, 0]]
keys = [[0, 0, 0, 2, 0, 0, 1, 0], [1, 0, 0, 2, 0, 0, 1, 0]]
[time]
frames = 2
""")
sim = kerf.Simulation(folder / "scene.toml", young=8e4)
sim.blade("knife").move((0, 0.01, 1.8))
sim.step()
assert sim.positions.shape == (len(sim.stress), 3)

picture = kerf.picture(pieces, explode=0.3, size=(160, 120), samples=1)
assert picture.shape == (120, 160, 3) and picture.std() > 10
assert c._repr_png_().startswith(b"\x89PNG")
kerf.write_level_set(folder / "pumpkin.vdb", s, 0.05)
assert abs(kerf.read_volume(folder / "pumpkin.vdb").volume / s.volume - 1) < 0.02
try:
    kerf.Solid(s.vertices, s.faces[1:])
except kerf.InputError as error:
    print("refused:", error)
else:
    raise SystemExit("an open mesh was taken for a solid")
print("kerf", kerf.__version__, s, sim)
