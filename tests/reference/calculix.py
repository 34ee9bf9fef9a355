"""Boxes of twenty-node bricks (C3D20R) in CalculiX: St. Venant-Kirchhoff, large displacements.

A box is given by the coordinates of its element corners along x, y and z. A crack in a plane x = const has doubled nodes.
"""
import os
import subprocess

YOUNG, POISSON, DENSITY = 1e5, 0.3, 1000.0

# Corners, then middles of edges, in the order of CalculiX: offsets in half elements.
BRICK = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2),
         (1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2),
         (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]


def even(begin, end, count):
    """Corners of `count` equal elements."""
    return [begin + (end - begin) * i / count for i in range(count + 1)]


def towards(place, begin, end, finest, growth=1.5):
    """Corners from begin to end whose distances grow from `finest` at `place`."""
    def side(length):
        sizes = [finest]
        while sum(sizes) < length:
            sizes.append(sizes[-1] * growth)
        scale, sums = length / sum(sizes), [0.0]
        for size in sizes:
            sums.append(sums[-1] + size * scale)
        return sums
    below = [place - d for d in reversed(side(place - begin))] if place > begin else [place]
    return below + ([place + d for d in side(end - place)[1:]] if end > place else [])


class Bricks:
    """A box of bricks. `crack`: (x, z): its plane, and the height above which nodes are doubled."""

    def __init__(self, x, y, z, crack=None):
        self.nodes, self.elements, self.index = [], [], {}
        lines = [self.halves(c) for c in (x, y, z)]
        is_cracked = lambda p: crack and abs(p[0] - crack[0]) < 1e-9 and p[2] > crack[1] + 1e-9
        for i in range(len(x) - 1):
            for j in range(len(y) - 1):
                for k in range(len(z) - 1):
                    element = []
                    for a, b, c in BRICK:
                        at = (2 * i + a, 2 * j + b, 2 * k + c)
                        place = tuple(line[n] for line, n in zip(lines, at))
                        beyond = bool(is_cracked(place)) and x[i] > crack[0] - 1e-9
                        if (at, beyond) not in self.index:
                            self.nodes.append(place)
                            self.index[at, beyond] = len(self.nodes)
                        element.append(self.index[at, beyond])
                    self.elements.append(element)

    @staticmethod
    def halves(corners):
        return [c for a, b in zip(corners, corners[1:]) for c in (a, (a + b) / 2)] + [corners[-1]]

    def where(self, accepts):
        """Numbers of the nodes whose place is accepted."""
        return [n + 1 for n, place in enumerate(self.nodes) if accepts(place)]


def solve(path, bricks, fixed, observed, gravity=0.0, moved=None, push=0.0):
    """Runs ccx. Returns the displacement of the `observed` nodes at the end, and the force along z on the `moved` ones.

    `fixed`: nodes held. `moved`: nodes that move by `push` along z and are held sideways.
    """
    with open(path + '.inp', 'w') as f:
        f.write('*NODE, NSET=ALL\n')
        for n, place in enumerate(bricks.nodes):
            f.write('%d, %.12g, %.12g, %.12g\n' % (n + 1, *place))
        f.write('*ELEMENT, TYPE=C3D20R, ELSET=SOLID\n')
        for n, element in enumerate(bricks.elements):
            f.write('%d, %s,\n%s\n' % (n + 1, ', '.join(map(str, element[:10])), ', '.join(map(str, element[10:]))))
        for name, numbers in (('FIXED', fixed), ('MOVED', moved or []), ('OBSERVED', observed)):
            if numbers:
                f.write('*NSET, NSET=%s\n%s' % (name, ''.join('%d,\n' % n for n in numbers)))
        f.write('*BOUNDARY\nFIXED, 1, 3\n*MATERIAL, NAME=RUBBER\n*ELASTIC\n%g, %g\n*DENSITY\n%g\n'
                % (YOUNG, POISSON, DENSITY))
        f.write('*SOLID SECTION, ELSET=SOLID, MATERIAL=RUBBER\n*STEP, NLGEOM, INC=200\n*STATIC\n0.1, 1.\n')
        if moved:
            f.write('*BOUNDARY\nMOVED, 1, 2\nMOVED, 3, 3, %g\n' % push)
        if gravity:
            f.write('*DLOAD\nSOLID, GRAV, %g, 0, 0, -1\n' % gravity)
        f.write('*NODE PRINT, NSET=OBSERVED, FREQUENCY=1000\nU\n')
        if moved:
            f.write('*NODE PRINT, NSET=MOVED, TOTALS=ONLY, FREQUENCY=1000\nRF\n')
        f.write('*END STEP\n')
    # It writes spooles.out into the current folder.
    done = subprocess.run(['ccx', path], capture_output=True, text=True, cwd=os.path.dirname(path))
    if done.returncode != 0 or '*ERROR' in done.stdout:
        raise RuntimeError('ccx failed on %s.inp:\n%s' % (path, done.stdout[-2000:]))
    return read(path + '.dat')


def read(path):
    """The last displacements and the last total force along z in a .dat file."""
    rows, force, is_total = [], None, False
    for line in open(path):
        words = line.split()
        if 'displacements' in line:
            rows = []
        elif 'total force' in line:
            is_total = True
        elif is_total and words:
            force, is_total = float(words[-1]), False
        elif len(words) == 4 and words[0].isdigit():
            rows.append(tuple(map(float, words[1:])))
    return rows, force
