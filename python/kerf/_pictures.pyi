from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kerf import _Progress

__all__ = ["picture"]

def picture(
    x: Any,
    *,
    size: Sequence[int] = (960, 720),
    camera: Sequence[float] = (30.0, 22.0),
    zoom: float = 1.0,
    up: str = "z",
    color: ArrayLike | None = None,
    color_range: Sequence[float] | None = None,
    skin: str = "#e0803a",
    opacity: float = 1.0,
    sheets: bool = False,
    seams: bool = False,
    wire: bool = False,
    explode: float = 0.0,
    cut_away: Sequence[float] | None = None,
    hollow: bool = False,
    nodes: bool = False,
    edges: bool = False,
    field: ArrayLike | None = None,
    ground: bool = True,
    samples: int = 3,
    progress: _Progress = None,
) -> NDArray[np.uint8]: ...
