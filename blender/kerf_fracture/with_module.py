"""Kerf by its Python module."""

import importlib
import sys

import numpy

from . import arrays
from .backend import Bond, Failed, Fracture, Piece, Refused, Stopped

NEEDED = ("Solid", "Mesh", "score", "InputError", "GeometryError", "Interrupted")


def load(folder=""):
    """The module in the folder, or where Python looks. Throws Failed when it is not there or cannot be loaded."""
    if folder and folder not in sys.path:
        sys.path.insert(0, folder)
    try:
        kerf = importlib.import_module("kerf")
    except ImportError as error:
        raise Failed(f"The Python module kerf cannot be loaded ({error}): install the package python3-kerf, or set its folder in the preferences") from error
    missing = [name for name in NEEDED if not hasattr(kerf, name)]
    if missing:
        raise Failed(f"The Python module kerf is of another version: it has no {missing[0]}; install the package python3-kerf again")
    return Module(kerf)


class Module:
    name = "module"

    def __init__(self, kerf):
        self.kerf = kerf

    def fracture(self, model, options, progress):
        with _Sentences(self.kerf):
            cut, notes = self._crack(model, options, progress, 0.7)
            hulls = {"hulls": True, "parts": options.hulls, "corners": options.corners} if options.hulls else {}
            found = cut.pieces(tile=options.tile, progress=_span(progress, 0.7, 1.0), **hulls)
            bonds = [Bond(int(b["a"]), int(b["b"]), float(b["area"]), tuple(b["normal"]), tuple(b["centroid"])) for b in cut.bonds]
            return Fracture([_piece(piece) for piece in found], bonds, notes)

    def walls(self, model, options, progress):
        with _Sentences(self.kerf):
            cut, _ = self._crack(model, options, progress, 1.0)
            surface = cut.surface()
            return arrays.used(surface.vertices, surface.faces[surface.patch > 0])

    def repair(self, model, voxel, smooth, progress):
        with _Sentences(self.kerf):
            mesh = self.kerf.Mesh(*arrays.welded(model.vertices, model.triangles))
            progress("repair", 0.0)
            mended, stats = mesh.repair(smooth=smooth)
            words = [_words(stats)] if stats else []
            if voxel:
                size = numpy.linalg.norm(numpy.ptp(numpy.array(mesh.vertices), axis=0))
                mended = self.kerf.Solid.repaired(mesh, smooth=smooth, voxel=voxel * size)
                words = [f"wrapped in {len(mended.faces)} triangles"]
            elif not mended.check().good:
                mended = mended.self_union()
                words.append("crossing triangles cut, parts united")
            solid = self.kerf.Solid(mended)  # refuses what is still none
            rounded = solid.rounded()  # a mesh of Blender holds no more
            if not numpy.array_equal(rounded.faces, solid.faces):
                words.append("triangles divided that cross in single precision")
            mended = rounded
            if not progress("repair", 1.0):
                raise Stopped()
            return numpy.array(mended.vertices), numpy.array(mended.faces, numpy.int32), "; ".join(words) or "nothing to repair"

    def _crack(self, model, options, progress, end):
        """The cut complex, and sentences for the user."""
        solid = self.kerf.Solid(*arrays.welded(model.vertices, model.triangles))
        names = ("pieces", "jagged", "seed", "cluster", "grain", "edge_detail", "chips", "chip_size")
        wanted = {name: getattr(options, name) for name in names}
        if model.density is not None:
            wanted["density"] = arrays.carried(model.vertices, model.density, numpy.array(solid.vertices))
        wanted.update({name: list(getattr(options, name)) for name in ("axis", "impact") if getattr(options, name) is not None})
        if options.image is not None:
            wanted["image"] = options.image
        score = self.kerf.score(solid, options.pattern, frequency=options.bumps, progress=_span(progress, 0, end / 2), **wanted)
        notes = []
        if score.pieces != options.pieces and options.image is None:
            notes.append(f"{score.pieces} pieces, not {options.pieces}; another seed may find them")
        if score.chips != options.chips:
            notes.append(f"{score.chips} chips, not {options.chips}; edges have room for more of a smaller size")
        return solid.crack(score, progress=_span(progress, end / 2, end)), notes


class _Sentences:
    """Turns the module's exceptions into the backend's."""

    def __init__(self, kerf):
        self.kerf = kerf

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        if kind is None:
            return False
        if issubclass(kind, self.kerf.Interrupted):
            raise Stopped() from error
        if issubclass(kind, (self.kerf.InputError, self.kerf.GeometryError)):
            raise Refused(str(error)) from error
        if issubclass(kind, self.kerf.Error):
            raise Failed(str(error)) from error
        return False


def _words(stats):
    """What a repair has done, in a sentence."""
    counts = [
        (stats.welded_vertices, "vertex welded", "vertices welded"),
        (stats.dropped_triangles, "triangle dropped", "triangles dropped"),
        (stats.flipped_triangles, "triangle flipped", "triangles flipped"),
        (stats.filled_holes, "hole filled", "holes filled"),
        (stats.added_triangles, "triangle added", "triangles added"),
        (stats.dropped_shells, "shell dropped", "shells dropped"),
    ]
    return ", ".join(f"{count} {one if count == 1 else many}" for count, one, many in counts if count)


def _span(progress, begin, end):
    """The module's progress, from a part of the whole."""

    def report(phase, done, total):
        return progress(phase, begin + (end - begin) * (done / total if total else 0.0))

    return report


def _piece(piece):
    return Piece(
        numpy.array(piece.vertices),
        numpy.array(piece.faces, numpy.int32),
        numpy.array(piece.patch),
        numpy.array(piece.source, numpy.int64),
        numpy.array(piece.uv),
        piece.volume,
        numpy.array(piece.centroid),
        [(numpy.array(hull.vertices), numpy.array(hull.faces, numpy.int32)) for hull in piece.hulls],
    )
