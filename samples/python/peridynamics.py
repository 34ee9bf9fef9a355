"""Bond-based peridynamics on Kerf's visibility graph: a crack grows through a stretched plate of glass.

The plate measures 100 mm by 40 mm, and a crack reaches from its left edge to its middle. Kerf finds the bonds: neighbours of
each node within the horizon that no crack hides. A bond breaks where its stretch exceeds a limit, which follows from the
fracture energy (S. A. Silling and E. Askari, Computers & Structures 83, 2005). Units are SI.
"""
import kerf
import numpy as np

# Soda-lime glass. In this model of a thin plate, Poisson's ratio is 1/3.
YOUNG, DENSITY, FRACTURE_ENERGY = 72e9, 2440.0, 3.8
LENGTH, HEIGHT, TIP, H = 0.1, 0.04, 0.05, 1e-3  # H: distance between nodes, and thickness of the plate
HORIZON, MIDDLE = 3.015 * H, HEIGHT / 2
STIFFNESS = 9 * YOUNG / (np.pi * H * HORIZON**3)  # force of a bond per stretch and volume squared
CRITICAL_STRETCH = np.sqrt(4 * np.pi * FRACTURE_ENERGY / (9 * YOUNG * HORIZON))
GRIP, SPEED, DT, STEPS = 3 * H, 0.02, 1e-7, 900  # height and speed of the grips; time integration

# The plate with its crack, and one layer of nodes: kerf.sample() would place them, but this model wants a grid.
plate = kerf.shapes.block((LENGTH, HEIGHT, H), edge=4e-3)
crack = kerf.Mesh([[-H, MIDDLE, -H], [TIP, MIDDLE, -H], [TIP, MIDDLE, 2 * H], [-H, MIDDLE, 2 * H]], [[0, 1, 2], [0, 2, 3]])
x = (np.indices((round(LENGTH / H), round(HEIGHT / H), 1)).reshape(3, -1).T + 0.5) * H
each = np.ones(len(x))
body = kerf.Body(plate.crack(crack), kerf.NodeSet(x, radius=HORIZON * each, spacing=H * each, volume=H**3 * each))

# Bonds: pairs i < j of nodes that see each other, from the rows of the graph.
graph = body.graph
i, j = np.repeat(np.arange(len(x)), np.diff(graph.indptr)), graph.indices
bonds = (i < j) & ~graph.hidden
i, j, length = i[bonds], j[bonds], graph.distances[bonds].astype(float)
at = (x[i] + x[j]) / 2
across = (x[i, 1] - MIDDLE) * (x[j, 1] - MIDDLE) < 0  # joins the upper and the lower half
held = np.abs(x[:, 1] - MIDDLE) > MIDDLE - GRIP
breakable = ~held[i] & ~held[j]

# Leapfrog: displacements at full steps, velocities at half steps. The grips pull up and down at constant speed.
u, v = np.zeros_like(x), np.zeros_like(x)
v[:, 1] = SPEED * np.clip((x[:, 1] - MIDDLE) / (MIDDLE - GRIP), -1, 1)  # the plate stretches evenly at the beginning
mass, intact = DENSITY * H**3, np.ones(len(i), bool)
work, dissipated = 0.5 * mass * (v[~held] ** 2).sum(), 0.0
first, tips = np.zeros((0, 3)), []  # where the first bonds break; x of the crack's tip at each step
for step in range(STEPS):
    u += DT * v
    d = x[j] + u[j] - x[i] - u[i]
    stretched = np.sqrt(np.einsum("bk,bk->b", d, d))
    stretch = stretched / length - 1
    energy = 0.5 * STIFFNESS * H**6 * length * stretch**2
    breaks = intact & breakable & (stretch > CRITICAL_STRETCH)
    pull = STIFFNESS * H**6 * (stretch / stretched * (intact - 0.5 * breaks))[:, None] * d  # breaks: half of the step
    force = np.stack([np.bincount(i, f, len(x)) - np.bincount(j, f, len(x)) for f in pull.T], axis=1)
    before, v = v, v + DT / mass * force * ~held[:, None]
    work -= DT * (force * v)[held].sum()
    dissipated += energy[breaks].sum()
    first = at[breaks] if len(first) == 0 else first
    intact &= ~breaks
    tips.append(at[across & ~intact, 0].max(initial=TIP))
    if step % 100 == 99:
        print(f"{1e6 * DT * (step + 1):3.0f} us: crack tip at {1e3 * tips[-1]:.1f} mm, {np.sum(~intact)} bonds broken")

# Physical facts. Of the broken bonds, none has been where the crack was at the beginning.
assert at[across, 0].min() > TIP - HORIZON / 2, "a bond crosses the crack"
assert len(first) and np.abs(first - (TIP, MIDDLE, H / 2)).max() < H, "the crack does not grow from its tip"
assert tips[-1] > LENGTH - H and not (across & breakable & intact).any(), "the plate is not in two"
assert np.abs(at[~intact, 1] - MIDDLE).max() < HORIZON, "the crack is not straight"
fastest = np.diff(tips[::50]).max() / (50 * DT)
rayleigh = 0.93 * np.sqrt(YOUNG / (2 * (1 + 1 / 3) * DENSITY))
assert fastest < rayleigh, "the crack is faster than Rayleigh waves"
per_area = dissipated / ((tips[-1] - TIP) * H)
assert FRACTURE_ENERGY < per_area < 3 * FRACTURE_ENERGY, "bonds break where no crack is"
kinetic, elastic = 0.5 * mass * (before * v)[~held].sum(), energy[intact].sum()
residual = work - kinetic - elastic - dissipated
assert abs(residual) < 0.02 * work, "energy is not conserved"
print(f"work {work:.3g} J = kinetic {kinetic:.3g} + elastic {elastic:.3g} + dissipated {dissipated:.3g}, error {residual / work:.1%}")
print(f"dissipated per area of crack: {per_area:.2f} J/m2; fastest tip: {fastest:.0f} m/s, Rayleigh waves {rayleigh:.0f} m/s")
