"""Good and bad arguments for random calls."""
import numpy as np

TETRAHEDRON = ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


def cube():
    """Vertices and faces of the unit cube."""
    vertices = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
    faces = np.array([[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 6, 7], [2, 7, 3], [0, 4, 6],
                      [0, 6, 2], [1, 3, 7], [1, 7, 5]])
    return vertices, faces


def good_arrays(rng):
    """An array as callers give them."""
    vertices, faces = cube() if rng.random() < 0.5 else map(np.array, TETRAHEDRON)
    choice = rng.randrange(9)
    return [vertices.astype(rng.choice([np.float32, np.float64])), faces.astype(rng.choice([np.int32, np.int64, np.uint32, np.uint8])),
            vertices.tolist(), faces.tolist(), np.asfortranarray(vertices), np.ones(len(vertices)), np.zeros(len(faces), int),
            np.array([0.5, 0.5, 0.5]), np.array([[-1, 0.5, -1], [-1, 0.5, 2], [2, 0.5, 2]])][choice]


def spoiled(array, rng):
    """The array, made worse: what NumPy allows and a reader may not expect."""
    array = np.array(array)
    change = rng.randrange(20)
    if change == 0:
        return array[..., None]
    if change == 1:
        return array.reshape(-1)
    if change == 2:
        return array[::-1]
    if change == 3:
        return np.repeat(array, 2, axis=0)[::2]
    if change == 4:
        return array.T
    if change == 5:
        return array.astype(array.dtype.newbyteorder(">"))
    if change == 6:
        return array.astype(object)
    if change == 7:
        return array[:0]
    if change == 8:
        return np.array(array.ravel()[0]) if array.size else array
    if change == 9:
        return array.astype(complex)
    if change == 10:
        return array.astype(str)
    if change == 11:
        return array.astype(bool)
    if change == 12:
        return np.broadcast_to(array[:1], (3, *array.shape[1:])) if array.ndim else array
    if change == 13:
        return array.astype(np.float16)
    if change == 14:
        return np.empty((0, 3), array.dtype)
    if change == 15:
        return np.ma.masked_array(array, mask=False)
    if array.size == 0:
        return array
    worse = array.astype(float if change < 18 else np.int64).copy()
    at = rng.randrange(worse.size)
    flat = worse.reshape(-1)
    flat[at] = rng.choice([np.nan, np.inf, -np.inf, 1e300, -1e61]) if change < 18 else rng.choice([-1, 10**6, 2**31, 2**62, -2**63])
    return worse


SCALARS = [0, 1, 2, 3, 7, -1, 0.0, 0.5, 0.03, 1e-300, -0.5, 1e300, float("nan"), float("inf"), -float("inf"), 2**31, 2**32, 2**63, 2**64, 10**30,
           True, False, None, "", "voronoi", "z", "text", "\x00", "3%", "/nonexistent/file.ply", "ü" * 1000, b"bytes", (), [], {}, {"a": 1}, (1, 2),
           (1, 2, 3), [None], ["a", "b"], [[1, 2], [3]], 1j, object, len, range(3), np.float32(2.5), np.int8(3), np.datetime64("2020")]


def scalar(rng):
    return rng.choice(SCALARS)
