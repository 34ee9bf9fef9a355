"""Arithmetic on arrays of triangles: attributes of pieces from the triangles of their model, normals of inner faces."""

import numpy


def weights(corners, triangles):
    """Barycentric coordinates (m, 3, 3) of the corners (m, 3, 3) of m triangles, each in its own triangle (m, 3, 3). They are
    exactly 1 and 0 at corners that are equal, and the nearest corner's in a triangle without area."""
    a = triangles[:, None, 0]
    u, v = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    p = corners - a
    uu, uv, vv = (u * u).sum(-1)[:, None], (u * v).sum(-1)[:, None], (v * v).sum(-1)[:, None]
    pu, pv = (p * u[:, None]).sum(-1), (p * v[:, None]).sum(-1)
    area = uu * vv - uv * uv
    flat = area <= 1e-14 * uu * vv
    area = numpy.where(flat, 1.0, area)
    second = (vv * pu - uv * pv) / area
    third = (uu * pv - uv * pu) / area
    found = numpy.clip(numpy.stack([1 - second - third, second, third], -1), 0, 1)
    found /= found.sum(-1, keepdims=True)
    distances = ((corners[:, :, None] - triangles[:, None]) ** 2).sum(-1)
    exact = (distances.min(-1) == 0) | flat
    found[exact] = numpy.eye(3)[distances.argmin(-1)][exact]
    return found


def sides(polygon, loop):
    """The number of corners of each polygon of a model, from the polygon (m,) of each triangle and which corners it has (m, 3)."""
    found = numpy.zeros(polygon.max(initial=-1) + 1, int)
    numpy.maximum.at(found, polygon, loop.max(1) + 1)
    return found


def faces(surface, triangles, polygon, loop, count):
    """Faces made of triangles (m, 3): polygons of the model where all of their triangles are there, as they were, else triangles.

    surface (m,): numbers in ascending order, a polygon is within one. polygon (m,): of the model; -1: none. loop (m, 3): the model's
    corner at each corner, in the order of the polygon; -1: none. count: sides() of the model. Returns the faces' corners, 3 t + k for corner k of triangle t, one
    face after another; the number of corners of each face; and the first triangle of each.
    """
    kept = numpy.flatnonzero((polygon >= 0) & (loop >= 0).all(1))
    keys, group, size = numpy.unique(surface[kept] * len(count) + polygon[kept], return_inverse=True, return_counts=True)
    group = numpy.repeat(group.ravel(), 3)
    corner = (3 * kept[:, None] + numpy.arange(3)).ravel()
    order = numpy.lexsort((loop[kept].ravel(), group))
    group, corner = group[order], corner[order]
    place, vertex = loop.ravel()[corner], triangles.ravel()[corner]
    again, torn = numpy.zeros(len(group), bool), numpy.zeros(len(group), bool)
    again[1:] = (group[1:] == group[:-1]) & (place[1:] == place[:-1])  # a corner of the polygon belongs to several triangles
    whole = numpy.bincount(group[~again], minlength=len(keys)) == size + 2
    torn[1:] = again[1:] & (vertex[1:] != vertex[:-1])
    whole[group[torn]] = False
    whole &= size + 2 == count[keys % max(len(count), 1)]

    joined = numpy.zeros(len(triangles), bool)
    joined[corner[whole[group]] // 3] = True
    single = numpy.flatnonzero(~joined)
    used_corner = whole[group] & ~again
    first = numpy.full(len(keys), len(triangles))
    numpy.minimum.at(first, group, corner // 3)
    begins = numpy.concatenate([first[group[used_corner]], numpy.repeat(single, 3)])
    corners = numpy.concatenate([corner[used_corner], (3 * single[:, None] + numpy.arange(3)).ravel()])
    order = numpy.argsort(begins, kind="stable")
    firsts, sizes = numpy.unique(begins, return_counts=True)
    return corners[order], sizes, firsts


def interpolate(weight, source, values):
    """Values (m, 3, d) at corners, from values (n, 3, d) of the model's triangles."""
    return numpy.einsum("mij,mjd->mid", weight, values[source])


def normals(vertices, triangles):
    """Unit normals (m, 3) of triangles; of length 0 for those without area."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    found = numpy.cross(b - a, c - a)
    length = numpy.linalg.norm(found, axis=1, keepdims=True)
    return found / numpy.where(length > 0, length, 1)


def smooth_normals(vertices, triangles, degrees=45.0):
    """Unit normals (m, 3, 3) at corners: the mean over the triangles at the same vertex whose normals differ by less than
    `degrees`, weighted by the angle at the corner."""
    count = len(triangles)
    if not count:
        return numpy.zeros((0, 3, 3))
    own = normals(vertices, triangles)
    points = vertices[triangles]
    to_next, to_last = numpy.roll(points, -1, 1) - points, numpy.roll(points, 1, 1) - points
    sine = numpy.linalg.norm(numpy.cross(to_next, to_last), axis=-1)
    angle = numpy.arctan2(sine, (to_next * to_last).sum(-1)).ravel()

    order = numpy.argsort(triangles.ravel(), kind="stable")  # corners, vertex by vertex
    vertex = triangles.ravel()[order]
    first = numpy.flatnonzero(numpy.r_[True, vertex[1:] != vertex[:-1]])
    size = numpy.diff(numpy.r_[first, len(vertex)])
    begins, sizes = numpy.repeat(first, size), numpy.repeat(size, size)
    at = numpy.repeat(numpy.arange(len(vertex)), sizes)  # all pairs of corners at one vertex
    other = numpy.arange(len(at)) - numpy.repeat(numpy.cumsum(sizes) - sizes, sizes) + begins[at]
    at, other = order[at], order[other]
    near = (own[at // 3] * own[other // 3]).sum(1) > numpy.cos(numpy.radians(degrees))
    at, other = at[near], other[near]
    total = numpy.stack([numpy.bincount(at, angle[other] * own[other // 3, i], 3 * count) for i in range(3)], 1)
    length = numpy.linalg.norm(total, axis=1, keepdims=True)
    total = numpy.where(length > 0, total / numpy.where(length > 0, length, 1), numpy.repeat(own, 3, axis=0))
    return total.reshape(count, 3, 3)


def used(vertices, triangles):
    """The mesh without vertices that no triangle uses."""
    kept, numbers = numpy.unique(triangles, return_inverse=True)
    return vertices[kept], numbers.reshape(-1, 3).astype(numpy.int32)


def carried(vertices, values, kept):
    """The values (n,) of vertices at the places of others, which are among them."""
    places, first = numpy.unique(vertices, axis=0, return_index=True)
    _, numbers = numpy.unique(numpy.concatenate([places, kept]), axis=0, return_inverse=True)
    return values[first[numbers.ravel()[len(places):]]]


def welded(vertices, triangles):
    """The mesh with open vertices at exactly one place merged, as Kerf's readers of files do."""
    edges = numpy.sort(numpy.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    edges, count = numpy.unique(edges, axis=0, return_counts=True)
    rim = numpy.unique(edges[count == 1])
    if not len(rim):
        return vertices, triangles
    _, first, place = numpy.unique(vertices[rim], axis=0, return_index=True, return_inverse=True)
    number = numpy.arange(len(vertices))
    number[rim] = rim[first[place.ravel()]]
    return used(vertices, number[triangles])
