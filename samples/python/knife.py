"""A knife that follows a Python function saws through a block of gelatine. Units are SI.

python3 knife.py        writes knife.ply, the halves where they are at the end
"""
import kerf
import numpy as np
from numpy.typing import NDArray

SCENE = """
[body]
mesh = "block"                # given to Simulation() as an array
nodes = 300
[material]
young = 2e4
density = 1000
damping = 2.0
[ground]
point = [0, 0, 0]
[time]
frames = 24
step = 0.02
[[blade]]
name = "knife"
points = [[0, -0.2, 0], [0, 0, 0], [0, 0.2, 0.002]]
divide = 8
keys = [[0, 0.0507, 0.05, 0.12, 0, 0, 1, 3], [0.01, 0.0507, 0.05, 0.12, 0, 0, 1, 3]]  # it waits above; knife() moves it
"""


def knife(time: float) -> NDArray[np.float64]:
    """Pose of the knife: it goes down in half a second, and to and fro four times a second, turned by three degrees."""
    angle = np.radians(3)
    pose = np.eye(4)
    pose[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    pose[:3, 3] = [0.0507, 0.05 + 0.01 * np.sin(8 * np.pi * time), 0.12 - 0.32 * time]
    return pose


block = kerf.shapes.block((0.1, 0.1, 0.1), edge=0.02)
simulation = kerf.Simulation(SCENE, models=block)
blade = simulation.blade("knife")
frame = 1 / simulation.scene.frame_rate
pieces = 1
while pieces < 2 and simulation.time < 0.6:
    blade.move(knife(simulation.time + frame))
    stats = simulation.step()
    pieces = len(simulation.body.pieces())
    print(f"{simulation.time:.3f} s: {stats.split.edges_cut:3} edges cut, {pieces} pieces, highest stress {simulation.stress.max():.0f} Pa")

halves = simulation.body.pieces()
assert len(halves) == 2
assert simulation.body.graph.components()[0] == 2, "nodes of the two halves are still joined"
assert np.isclose(sum(half.volume for half in halves), block.volume), "a cut removes no material"
assert all(0.4 * block.volume < half.volume < 0.6 * block.volume for half in halves)
simulation.surface().save("knife.ply")
