"""Small models for the tests."""
import numpy as np


def block(size=(1.0, 1.0, 1.0), parts=(4, 4, 4)):
    """Vertices and faces of a box whose sides are divided into squares of two triangles."""
    index, vertices, faces = {}, [], []

    def vertex(corner):
        if corner not in index:
            index[corner] = len(vertices)
            vertices.append([size[k] * corner[k] / parts[k] for k in range(3)])
        return index[corner]

    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, parts[axis]):
            for i in range(parts[u]):
                for j in range(parts[v]):
                    corners = []
                    for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                        corner = [0, 0, 0]
                        corner[axis], corner[u], corner[v] = side, a, b
                        corners.append(vertex(tuple(corner)))
                    a, b, c, d = corners if side else corners[::-1]
                    faces += [[a, b, c], [a, c, d]]
    return np.array(vertices, float), np.array(faces, np.int32)
