"""The interface to Kerf: arrays in, pieces and bonds out. The Python module does the work, or the command-line tools where it is
not installed (with_module.py, with_tools.py). Nothing here needs Blender."""

import dataclasses
import re
import typing

import numpy


class Refused(Exception):
    """The model cannot be used as it is; the text is Kerf's sentence, with the remedy of the add-on in place of Kerf's own."""

    def __init__(self, sentence):
        super().__init__(re.sub(r"or try (kerf-repair|kerf\.Solid\.repaired\(\))", "or press Repair in the Kerf tab", sentence))


class Failed(Exception):
    """Kerf is not there, or did not succeed for a reason that is not the model's."""


class Stopped(Exception):
    """The user has stopped the work."""


@dataclasses.dataclass
class Model:
    """A closed triangle mesh: vertices (n, 3) float64, triangles (m, 3) int32, weights of vertices."""

    vertices: numpy.ndarray
    triangles: numpy.ndarray
    density: typing.Optional[numpy.ndarray] = None  # (n,): cells are many where it is high


@dataclasses.dataclass
class Options:
    """Where and how a model breaks. Lengths are fractions of the diagonal of the model's box, points are in its coordinates."""

    pattern: str = "voronoi"
    pieces: int = 20
    jagged: float = 0.0
    bumps: float = 8.0
    edge_detail: float = 0.0
    chips: int = 0
    chip_size: float = 0.25  # a fraction of the cube root of the mean piece's volume
    seed: int = 1
    axis: typing.Optional[tuple] = None  # none: the pattern's own default
    impact: typing.Optional[tuple] = None
    image: typing.Optional[numpy.ndarray] = None  # (height, width) brightness from 0 to 1, the highest row first; of the pattern curves
    cluster: float = 0.15
    grain: float = 5.0
    tile: float = 0.25  # one unit of the inner faces' texture coordinates
    hulls: int = 0  # convex parts of a piece, at most; 0: no hulls
    corners: int = 32  # of a hull, at most


@dataclasses.dataclass
class Piece:
    """A closed piece. `patch` (m,) is 0 on the skin. `source` (m,) is the model's triangle. `uv` (m, 3, 2) is valid on inner
    faces. `hulls` are pairs of vertices and triangles."""

    vertices: numpy.ndarray
    triangles: numpy.ndarray
    patch: numpy.ndarray
    source: numpy.ndarray
    uv: numpy.ndarray
    volume: float
    centroid: numpy.ndarray
    hulls: list


@dataclasses.dataclass
class Bond:
    """The wall between pieces `a` and `b`: area, unit normal from a to b, centroid."""

    a: int
    b: int
    area: float
    normal: tuple
    centroid: tuple


@dataclasses.dataclass
class Fracture:
    pieces: list
    bonds: list
    notes: list = dataclasses.field(default_factory=list)  # sentences for the user


# progress(words, fraction) -> bool, False to stop; it is called now and then from the thread that does the work.
Progress = typing.Callable[[str, float], bool]


def choose(kind="AUTO", tools="", module=""):
    """The backend: an object with fracture(model, options, progress) -> Fracture, walls(model, options, progress) ->
    (vertices, triangles), repair(model, voxel, smooth, progress) -> (vertices, triangles, words), and a `name`. `kind` is AUTO,
    MODULE or TOOLS; `tools` and `module` are folders to look in first. Throws Failed when there is none."""
    from . import with_module, with_tools

    if kind != "TOOLS":
        try:
            return with_module.load(module)
        except Failed:
            if kind == "MODULE":
                raise
    found = with_tools.find(tools)
    if found:
        return found
    raise Failed("Kerf is not installed: install the package python3-kerf or kerf, or set their folders in the preferences")
