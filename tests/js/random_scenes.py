"""random_scenes.py COUNT [SEED]: writes random-0.toml and on: a model of this folder falls, turns, and is cut by a turning blade, or broken."""
import random
import sys

seed = int(sys.argv[2]) if len(sys.argv) > 2 else random.randrange(1 << 30)
print(f"random scenes of seed {seed}")
rng = random.Random(seed)
# Each stands above the ground, at the height given; blades reach through it.
MODELS = {"jello.ply": 0.02, "ball.ply": 1.02, "pumpkin.ply": 0.85}
for number in range(int(sys.argv[1])):
    model = rng.choice(list(MODELS))
    turn = [rng.uniform(-1, 1) for _ in range(3)]
    begin, end = rng.uniform(0, 40), rng.uniform(40, 90)
    with open(f"random-{number}.toml", "w") as out:
        out.write(f'''gravity = [0, 0, -9.81]
[body]
mesh = "{model}"
nodes = {rng.randrange(150, 500)}
spin = [{turn[0]}, {turn[1]}, {turn[2]}]
[material]
model = "{rng.choice(["neo-hookean", "stvk"])}"
young = {10 ** rng.uniform(4.7, 5.7)}
poisson = {rng.uniform(0.2, 0.4)}
volume_term = 1e5
density = {rng.uniform(500, 1200)}
damping = {rng.uniform(0, 3)}
[ground]
point = [0, 0, {-MODELS[model]}]
friction = {rng.uniform(0, 0.8)}
[contact]
self = true
[time]
frames = 8
frame_rate = 24
step = 0.021
accuracy = 0.01
''')
        if number % 2:
            out.write(f"""[[blow]]
time = {rng.uniform(0, 0.2)}
point = [{rng.uniform(-1, 1)}, {rng.uniform(-1, 1)}, {rng.uniform(0, 2)}]
cells = {rng.randrange(4, 12)}
""")
            continue
        out.write(f'''[[blade]]
points = [[-3, 0.011, 0], [0, {rng.uniform(-0.03, 0.03)}, 0], [3, 0.023, 0]]
divide = 12
keys = [
  [0.02, 0.503, 0.307, 1.6, {rng.uniform(-0.3, 0.3)}, {rng.uniform(-0.3, 0.3)}, 1, {begin}],
  [0.30, 0.507, 0.303, -1.3, {rng.uniform(-0.3, 0.3)}, {rng.uniform(-0.3, 0.3)}, 1, {end}],
]
''')
