"""Main jobs in one call that are made of others."""
from kerf import _kerf


def simulate(scene, each=None, **keys):
    """Simulates a scene up to its last frame, and returns the Simulation.

    scene: a Scene, a path, or a text. each: a callable of (simulation, stats) after every frame; False ends the run. keys: as
    for Simulation: models, set, progress, and keys of the scene such as young=8e4.
    Raises as Simulation and Simulation.run().
    """
    progress = keys.pop("progress", None)
    simulation = _kerf.Simulation(scene, progress=progress, **keys)
    simulation.run(each=each, progress=progress)
    return simulation


def _slice(self, planes, progress=None, **options):
    """The part of the model in front of a plane, towards which its normal points: a list of Piece, with walls in the plane.

    planes: a Plane, or a list; what remains is in front of all. As slice_plane(cap=True) of trimesh. options: those of cut().
    Raises InputError where the mesh is no valid model, GeometryError as cut(), Interrupted.
    """
    if not isinstance(self, _kerf.Mesh):  # called through the class
        raise TypeError(f"slice() is a method of Mesh, and got a {type(self).__name__}")
    all_planes = [planes] if isinstance(planes, _kerf.Plane) else list(planes)
    for plane in all_planes:
        if not isinstance(plane, _kerf.Plane):
            raise TypeError(f"slice(): give kerf.plane(point, normal), or a list of planes, not a {type(plane).__name__}")
    pieces = self.cut(all_planes, progress=progress, **options)
    return [piece for piece in pieces if all((piece.centroid - plane.point) @ plane.normal > 0 for plane in all_planes)]


_slice.__name__ = _slice.__qualname__ = "slice"
_kerf.Mesh.slice = _slice
