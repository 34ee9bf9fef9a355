"""How alike are the pieces of fracture patterns? A sweep over patterns and seeds, and a plot of the volumes of pieces.

python3 seeds.py        writes seeds.png
"""
from concurrent.futures import ThreadPoolExecutor
from typing import Literal

import kerf
import matplotlib
import numpy as np
from numpy.typing import NDArray

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

Pattern = Literal["voronoi", "planes", "wood"]
PATTERNS: tuple[Pattern, ...] = ("voronoi", "planes", "wood")
SEEDS = range(1, 9)
PIECES = 20

model = kerf.shapes.sphere(8)


def volumes(pattern: Pattern, seed: int) -> NDArray[np.float64]:
    """Volumes of the pieces, ascending, as fractions of the model's."""
    broken = model.crack(kerf.score(model, pattern, pieces=PIECES, jagged=0, seed=seed))
    assert np.isclose(broken.piece_volumes.sum(), model.volume)
    return np.sort(broken.piece_volumes) / model.volume


# Long calls release the GIL, so that threads of Python share the cores.
with ThreadPoolExecutor() as pool:
    sweeps = {pattern: list(pool.map(lambda seed: volumes(pattern, seed), SEEDS)) for pattern in PATTERNS}

figure, axes = pyplot.subplots(1, len(PATTERNS), figsize=(12, 4), sharey=True, constrained_layout=True)
for axis, (pattern, sweep) in zip(axes, sweeps.items()):
    for each in sweep:
        axis.plot(np.arange(1, len(each) + 1), each, color="tab:blue", alpha=0.4)
    axis.axhline(1 / PIECES, color="black", linestyle=":")
    axis.set(title=f"{pattern}, {len(sweep)} seeds", xlabel="piece, from small to large", yscale="log")
    ratio = np.median([each[-1] / each[0] for each in sweep])
    print(f"{pattern}: {min(map(len, sweep))} to {max(map(len, sweep))} pieces; the largest is {ratio:.3g} times the smallest (median)")
axes[0].set_ylabel("fraction of the volume")
figure.savefig("seeds.png", dpi=100)
