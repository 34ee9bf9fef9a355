"""Large deformations in Kerf beside CalculiX. Run by tests/reference/run.

Prints a table as in docs/validation.md. Exit code 1 where the finest sampling is off by more than its bound.
With --convergence: the errors of bars over seeds instead, and their order in the spacing of nodes.
"""
import math
import os
import sys
import tempfile

import calculix as ccx
import kerf

BOUND = 0.02
NODES = (600, 2400, 9600)

MATERIAL = '''
[material]
model = "stvk"
young = {young}
poisson = {poisson}
density = {density}
damping = 0
'''

# A bar whose first half unit is held, 4 long and of unit section beyond. Time steps of 100 s lead to rest.
CANTILEVER = '''
gravity = [0, 0, -GRAVITY]
[body]
mesh = "bar.off"
nodes = {nodes}
levels = LEVELS
fixed = [[-1, -1, -1, 0, 2, 2]]
CRACK
''' + MATERIAL + '''
[time]
seed = SEED
frames = 4
frame_rate = 0.01
step = 100
'''

# A unit cube between two slabs of a quarter, each held as a whole: bonded plates. The upper one moves by PUSH, and
# before and after that by a thirtieth less and more: the difference of the energies is the work of the force.
PLATES = '''
gravity = [0, 0, 0]
[body]
mesh = "block.off"
nodes = {nodes}
levels = 1
fixed = [[-1, -1, -1, 2, 2, 0]]
[[grip]]
box = [-1, -1, 1, 2, 2, 2]
keys = [[0, 0, 0, 0, 0, 0, 1, 0], [500, 0, 0, LESS, 0, 0, 1, 0], [700, 0, 0, MORE, 0, 0, 1, 0]]
''' + MATERIAL + '''
[time]
frames = 7
frame_rate = 0.01
step = 100
'''

FRONT = '''front crack
step 0
1 -0.2 1.3
1 1.2 1.3
step 1
1 -0.2 0.9
1 1.2 0.9
step 2
1 -0.2 0.5
1 1.2 0.5
'''


def cantilever_in_ccx(folder, gravity, crack):
    """The mean deflection of the tip in CalculiX, m."""
    if crack:
        bricks = ccx.Bricks(ccx.towards(1, 0, 4, 0.03), ccx.even(0, 1, 6), ccx.towards(0.5, 0, 1, 0.03), (1, 0.5))
    else:
        bricks = ccx.Bricks(ccx.even(0, 4, 24), ccx.even(0, 1, 6), ccx.even(0, 1, 6))
    rows, _ = ccx.solve(os.path.join(folder, 'bar'), bricks, bricks.where(lambda p: p[0] < 1e-9),
                        bricks.where(lambda p: p[0] > 4 - 1e-9), gravity=gravity)
    return sum(r[2] for r in rows) / len(rows)


def cantilever_in_kerf(gravity, crack, levels, nodes, seed=1):
    """The same in Kerf."""
    scene = CANTILEVER.replace('GRAVITY', str(gravity)).replace('LEVELS', str(levels)).replace('SEED', str(seed))
    scene = scene.replace('CRACK', '\n[[score]]\nfile = "crack.front"\n' if crack else '')
    with tempfile.TemporaryDirectory() as folder:
        kerf.write_block(os.path.join(folder, 'bar.off'), (-0.5, 0, 0), (4, 1, 1), 0.125)
        with open(os.path.join(folder, 'crack.front'), 'w') as f:
            f.write(FRONT)
        return kerf.mean_displacement(kerf.simulate(folder, scene, nodes), lambda p: abs(p[0] - 4) < 1e-6, 2)


def cantilever(folder, gravity, crack, levels=1):
    measured = [cantilever_in_kerf(gravity, crack, levels, n) for n in NODES]
    return [('tip, m', cantilever_in_ccx(folder, gravity, crack), measured)]


def plates(folder, push):
    kerf.write_block(os.path.join(folder, 'block.off'), (0, 0, -0.25), (1, 1, 1.25), 0.125)
    bricks = ccx.Bricks(ccx.even(0, 1, 6), ccx.even(0, 1, 6), ccx.even(0, 1, 8))
    side = lambda p: abs(p[0] - 1) < 1e-6 and abs(p[1] - 0.5) < 1e-6 and abs(p[2] - 0.5) < 1e-6
    rows, force = ccx.solve(os.path.join(folder, 'block'), bricks, bricks.where(lambda p: p[2] < 1e-9),
                            bricks.where(side), moved=bricks.where(lambda p: p[2] > 1 - 1e-9), push=push)
    less, more = push * 29 / 30, push * 31 / 30
    scene = PLATES.replace('LESS', str(less)).replace('MORE', str(more))
    forces, sides = [], []
    for nodes in NODES:
        run = kerf.simulate(folder, scene, nodes)
        energy = kerf.energies(run)
        forces.append((energy[6] - energy[4]) / (more - less))
        sides.append(kerf.mean_displacement(run, side, 0, frame=6))
    return [('force, N', force, forces), ('middle of a side, m', rows[0][0], sides)]


def convergence():
    """Root mean squares of errors over five seeds, and the slope of their logarithms by least squares."""
    samplings = (300, 600, 1200, 2400, 4800, 9600)
    print('| case | %s | order |' % ' | '.join('%d nodes' % n for n in samplings))
    print('|---|' + '---|' * (len(samplings) + 1))
    for name, gravity, crack in (('Cantilever', 0.3, False), ('Cracked', 0.15, True)):
        with tempfile.TemporaryDirectory() as folder:
            expected = cantilever_in_ccx(folder, gravity, crack)
            for levels in (1, 2):
                errors = []
                for nodes in samplings:
                    tips = [cantilever_in_kerf(gravity, crack, levels, nodes, seed) for seed in range(1, 6)]
                    errors.append(math.sqrt(sum((t / expected - 1) ** 2 for t in tips) / len(tips)))
                x, y = [-math.log(n) / 3 for n in samplings], [math.log(e) for e in errors]
                mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
                order = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x)
                cells = ' | '.join('%.1f %%' % (100 * e) for e in errors)
                print('| %s, levels = %d | %s | %.1f |' % (name, levels, cells, order), flush=True)


def main():
    if sys.argv[1:] == ['--convergence']:
        convergence()
        return 0
    failed = False
    print('| case | CalculiX | %s |' % ' | '.join('%d nodes' % n for n in NODES))
    print('|---|---|' + '---|' * len(NODES))
    cases = [('Cantilever, 4 long, g = 0.3 m/s²', BOUND, lambda d: cantilever(d, 0.3, False)),
             ('The same with two levels of nodes', BOUND, lambda d: cantilever(d, 0.3, False, 2)),
             ('Cracked half through 1 from its foot, g = 0.15 m/s²', BOUND, lambda d: cantilever(d, 0.15, True)),
             ('Cube between bonded plates, 30 % longer', BOUND, lambda d: plates(d, 0.3)),
             ('Cube between bonded plates, 15 % shorter', BOUND, lambda d: plates(d, -0.15))]
    for name, bound, run in cases:
        with tempfile.TemporaryDirectory() as folder:
            for what, expected, measured in run(folder):
                errors = [m / expected - 1 for m in measured]
                cells = ' | '.join('%.4g (%+.1f %%)' % (m, 100 * e) for m, e in zip(measured, errors))
                print('| %s: %s | %.4g | %s |' % (name, what, expected, cells), flush=True)
                failed = failed or abs(errors[-1]) > bound
    if failed:
        print('tests/reference/run: the finest sampling is off by more than its bound', file=sys.stderr)
    return int(failed)


if __name__ == '__main__':
    sys.exit(main())
