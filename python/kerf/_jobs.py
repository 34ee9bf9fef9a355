"""Main jobs in one call that are none of a model."""
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
