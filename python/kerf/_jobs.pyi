from collections.abc import Callable, Mapping, Sequence
from typing import Any

from kerf import FrameStats, Scene, Simulation, _MeshLike, _Path, _Progress

def simulate(scene: _Path | Scene, each: Callable[[Simulation, FrameStats], bool | None] | None = None, *,
             models: _MeshLike | Sequence[_MeshLike] | None = None, set: Mapping[str, Any] | None = None,
             progress: _Progress = None, **keys: Any) -> Simulation: ...
