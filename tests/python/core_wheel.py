"""What a wheel of the core does, and does not load; run by core-wheel in a fresh environment."""
import os
import re
import sys
import tempfile

import numpy as np


def loaded():
    """Names of the shared libraries that this process has mapped."""
    with open("/proc/self/maps") as maps:
        return {line.split()[-1] for line in maps if re.search(r"\.so(\.|$)", line)}


np.linalg.inv(np.eye(3))  # NumPy's own libraries
before = loaded()
import kerf  # noqa: E402

package = os.path.dirname(os.path.realpath(kerf.__file__))
assert package.startswith(os.path.realpath(sys.prefix)), package


def check_libraries():
    system = re.compile(r"/(libc|libm|libstdc\+\+|libgcc_s|libpthread|ld-linux[^/]*)\.so")
    own = {path for path in loaded() - before if os.path.realpath(path).startswith(package)}
    foreign = {path for path in loaded() - before - own if not system.search(path) and "/lib-dynload/" not in path}
    assert not foreign, foreign
    assert {re.match(r"[^.]*", os.path.basename(path))[0] for path in own} == {"_kerf", "libhwy"}, own


def refused(call):
    try:
        call()
    except kerf.InputError as problem:
        assert "\n" not in str(problem) and "build Kerf in full" in str(problem), problem
    else:
        raise AssertionError("not refused")


cube = kerf.Solid([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)],
                  [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]])
pieces = cube.crack(kerf.score(cube, "voronoi", pieces=30, jagged=0.02, seed=7)).pieces(hulls=True)
assert len(pieces) == 30 and all(len(piece.hulls) > 0 for piece in pieces), len(pieces)
assert abs(sum(piece.volume for piece in pieces) - 1) < 1e-12

scene = kerf.Scene("""gravity = [0, 0, -9.81]
[body]
mesh = "cube.ply"
nodes = 60
[ground]
point = [0, 0, -0.1]
[time]
frames = 3
""")
with tempfile.TemporaryDirectory() as work:
    path = os.path.join(work, "cube.stl")
    cube.save(path)
    assert abs(kerf.load(path).volume - 1) < 1e-12
    refused(lambda: kerf.write_level_set(os.path.join(work, "cube.vdb"), cube, 0.05))
    refused(lambda: kerf.picture(cube))
refused(lambda: kerf.reconstruct(np.random.default_rng(1).normal(size=(100, 3))))
run = kerf.Simulation(scene, models=cube)
height = run.positions[:, 2].mean()
while run.frame < 3:
    run.step()
assert run.positions[:, 2].mean() < height
check_libraries()
print("kerf", kerf.__version__, "from a wheel of the core:", len(pieces), "pieces")
