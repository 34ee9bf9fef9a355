"""Files: what load() reads is decided by content."""
import warnings

from kerf import _kerf


def load(path, unit=""):
    """Reads a file of any kind, recognised by its content.

    A valid solid gives a Solid, a cut surface a Complex with its fronts; any other surface a Mesh, which is a sheet, or
    a model that Solid.repaired() mends: its crack() says what is wrong. An OpenVDB volume gives the Solid of its surface; fronts and sheets a list of Front; a .kerf file a Body; nodes a NodeSet.
    unit: of a surface's coordinates, "mm" and so on, in place of what the file states; see Mesh.unit. What a surface's
    reader leaves out is a warning (UserWarning).
    Raises InputError, with the line or entry, for a malformed file; MissingInputError where there is none.
    """
    kind = _kerf._kind(path)
    if kind == "surface":
        return _kerf._load_surface(path, unit)
    if unit:
        raise _kerf.InputError(f"{path}: is no surface, which alone has a unit; leave out unit")
    if kind == "fronts":
        return _kerf.load_fronts(path)
    if kind == "volume":
        return read_volume(path)
    return (_kerf.Body if kind == "body" else _kerf.NodeSet).load(path)


def read_volume(path, grid="", iso=None, adaptivity=0.0):
    """The surface of a scalar grid in an OpenVDB file, a Solid, in world units.

    grid: its name; by default the only scalar grid. iso: level of the surface, by default 0 of a level set and 0.5 of a
    fog volume; inside are values below the level for a level set, above it else. adaptivity: 0, triangles of voxel
    size, to 1, larger ones where the surface is flat. Raises InputError where there is no such grid or no closed surface.
    """
    from kerf import _formats
    return _formats.read_volume(path, grid, iso, adaptivity)


def write_level_set(path, mesh, voxel, fog=False):
    """Writes a closed Mesh as an OpenVDB level set, with voxels of edge `voxel`, model units.

    fog: a density from 0 outside to 1 inside instead. Raises OutputError; InputError unless voxel is 0.0005 to 0.1 of
    the diagonal.
    """
    from kerf import _formats
    _formats.write_level_set(path, mesh, voxel, fog)


def _save_score(self, path):
    """Writes the walls as one sheet to a front file, which `[[score]]` of a scene and kerf-crack read. Raises OutputError."""
    if not isinstance(self, _kerf.Score):  # called through the class
        raise TypeError(f"save() is a method of Score, and got a {type(self).__name__}")
    _kerf.save_fronts(path, _kerf.Front([self.sheet.vertices], name="score", triangles=self.sheet.faces))


_kerf.Score.save = _save_score


def read_points(path):
    """The points of a scan: three arrays, positions (n, 3), normals (n, 3) or None, colours (n, 3) from 0 to 1 or None.

    Reads PCD, PLY without faces, and text with a point on each line (.xyz, .pwn, .pts, .asc, .csv). Points that are not
    finite are left out. Raises InputError, with the line, for a malformed file.
    """
    return _kerf._read_points(path)


def reconstruct(points, normals=None, colors=None, outliers=3.0, depth=0, progress=None):
    """The Solid whose surface passes near the points of a scan, as kerf-repair makes it (docs/tools/kerf-repair.md).

    points, normals and colors: (n, 3) arrays; colours from 0 to 1, or integers up to 255. Normals are estimated where there
    are none. outliers: standard deviations above the mean distance of neighbours that leave a point out; 0: none. depth: of
    the octree, 4 to 12; 0: by the spacing of the points. Where the surface fills regions without points, a UserWarning has
    their share of the area. Raises InputError where the points make no surface or solid, Interrupted.
    """
    import numpy

    from kerf import _scan
    if colors is not None:
        colors = numpy.asarray(colors)
        if colors.dtype.kind in "iu":
            colors = colors / 255
        if colors.size and colors.dtype.kind == "f" and not (colors.min() >= 0 and colors.max() <= 1):
            raise _kerf.InputError("reconstruct: colors: a value outside 0 to 1; give floats from 0 to 1, or integers up to 255")
    mesh, regions, share = _scan.reconstruct(points, normals, colors, outliers, depth, progress)
    if regions:
        warnings.warn(f"reconstruct: {regions} region{'s' if regions > 1 else ''} without points filled, {100 * share:.2g} % of the area",
                      UserWarning, stacklevel=2)
    return _kerf.Solid.repaired(mesh)
