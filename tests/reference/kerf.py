"""The same solids in Kerf: models, scenes, and what their frames say."""
import glob
import json
import os
import struct
import subprocess

from calculix import DENSITY, POISSON, YOUNG

TYPES = {'float': 'f', 'double': 'd', 'uchar': 'B', 'int': 'i', 'uint': 'I'}


def write_block(path, lo, hi, edge):
    """An OFF file of a box with triangles of about this edge."""
    count = [max(1, round((h - l) / edge)) for l, h in zip(lo, hi)]
    index, points, faces = {}, [], []

    def vertex(at):
        if at not in index:
            index[at] = len(points)
            points.append([l + (h - l) * k / n for l, h, k, n in zip(lo, hi, at, count)])
        return index[at]

    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for end in (0, count[axis]):
            for i in range(count[u]):
                for j in range(count[v]):
                    corners = []
                    for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                        at = [0, 0, 0]
                        at[axis], at[u], at[v] = end, a, b
                        corners.append(vertex(tuple(at)))
                    a, b, c, d = corners if end else corners[::-1]
                    faces += [(a, b, c), (a, c, d)] if (i + j) % 2 else [(b, c, d), (b, d, a)]
    with open(path, 'w') as f:
        f.write('OFF\n%d %d 0\n' % (len(points), len(faces)))
        f.writelines('%.12g %.12g %.12g\n' % tuple(p) for p in points)
        f.writelines('3 %d %d %d\n' % face for face in faces)


def simulate(folder, scene, nodes):
    """Runs kerf-sim with this number of nodes. Returns the folder of the run."""
    run = os.path.join(folder, 'nodes-%d' % nodes)
    path = run + '.toml'
    with open(path, 'w') as f:
        f.write(scene.format(nodes=nodes, young=YOUNG, poisson=POISSON, density=DENSITY))
    subprocess.run(['kerf-sim', path, '-q', '-o', run], check=True)
    return run


def positions(path):
    """The vertices of a binary PLY."""
    data = open(path, 'rb').read()
    end = data.index(b'end_header\n') + len(b'end_header\n')
    element, count, layout = None, 0, []
    for words in (line.split() for line in data[:end].decode().splitlines()):
        if words[0] == 'element':
            element = words[1]
            count = int(words[2]) if element == 'vertex' else count
        elif words[0] == 'property' and element == 'vertex':
            layout.append((words[2], TYPES[words[1]]))
    names = [name for name, _ in layout]
    row = struct.Struct('<' + ''.join(kind for _, kind in layout))
    at = [names.index(axis) for axis in 'xyz']
    rows = (row.unpack_from(data, end + i * row.size) for i in range(count))
    return [tuple(r[a] for a in at) for r in rows]


def mean_displacement(run, accepts, axis, frame=-1):
    """The mean displacement along an axis, in a frame, of the vertices whose first place is accepted."""
    frames = sorted(glob.glob(os.path.join(run, 'frames', '*.ply')))
    begin, end = positions(frames[0]), positions(frames[frame])
    moved = [q[axis] - p[axis] for p, q in zip(begin, end) if accepts(p)]
    return sum(moved) / len(moved)


def energies(run):
    """The elastic energy in each frame, J."""
    return [json.loads(line)['energy'] for line in open(os.path.join(run, 'frames.jsonl'))]
