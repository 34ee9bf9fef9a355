"""Pictures of meshes, cracks, pieces, nodes, bodies and simulations, by the renderer of kerf-view."""
import itertools

from kerf import _kerf

__all__ = ["picture"]


class _Content:
    """What a picture shows. `values`: per vertex of all surfaces. `spacing`, `field` and `edges`: of the nodes."""

    def __init__(self):
        self.surfaces, self.obstacles = [], []
        self.positions = self.spacing = self.field = self.graph = None
        self.color = "model"


def _is(x, name):
    return isinstance(x, getattr(_kerf, name, ()))


def _content_of(x):
    content = _Content()
    if _is(x, "Mesh"):
        content.surfaces = [x]
    elif _is(x, "Complex"):
        content.surfaces = [x.surface()]
    elif _is(x, "Score"):
        content.surfaces = [x.sheet]
    elif _is(x, "NodeSet"):
        content.positions, content.spacing = x.positions, x.spacing
    elif _is(x, "Body"):
        content.surfaces = [x.surface]
        content.positions, content.spacing = x.nodes.positions, x.nodes.spacing
        content.graph = x.graph
    elif _is(x, "Simulation"):
        content.surfaces, content.obstacles = [x.surface()], [x.obstacle_surface()]
        content.positions, content.spacing, content.field = x.positions, x.body.nodes.spacing, x.stress
        content.graph = x.body.graph
    elif isinstance(x, (list, tuple)) and x and all(_is(part, "Mesh") for part in x):
        content.surfaces, content.color = list(x), "piece"
    else:
        raise _kerf.InputError(f"picture: nothing to draw in {type(x).__name__}; give a Mesh, pieces, Complex, NodeSet, Body or Simulation")
    return content


def _refuse(name, rule):
    return _kerf.InputError(f"{name}: give {rule}")


def _number(name, value, low, high):
    try:
        number = float("nan") if isinstance(value, (str, bytes, bool)) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = float("nan")
    if not low <= number <= high:
        raise _refuse(name, f"a number from {low:g} to {high:g}")
    return number


def _numbers(name, values, counts):
    try:
        given = [float(value) for value in itertools.islice(values, 5)]
    except (TypeError, ValueError, OverflowError):
        given = []
    if len(given) not in counts or not all(abs(value) <= 1e60 for value in given):
        raise _refuse(name, f"{' or '.join(map(str, counts))} finite numbers")
    return given


def _choice(name, value, choices):
    if not isinstance(value, str) or value not in choices:
        raise _refuse(name, "one of " + ", ".join(map(repr, choices)))
    return str(value)


def _flag(name, value):
    if type(value).__name__ not in ("bool", "bool_"):  # the second is NumPy's
        raise _refuse(name, "True or False")
    return bool(value)


def _plane(cut_away):
    if cut_away is None:
        return None
    plane = _numbers("cut_away", cut_away, (3, 4))
    if not any(plane[:3]):
        raise _refuse("cut_away", "a direction that is not zero")
    return plane + [0.0] * (4 - len(plane))


def _values_of_surface(x, color):
    """One number per vertex for an argument `color` that is no name."""
    if isinstance(color, str):
        if color != "stress" or not _is(x, "Simulation"):
            raise _refuse("color", "'model', 'patch', 'piece', 'plain', for a Simulation also 'stress', or one number per vertex")
        return _on_surface(x.body, x.stress)
    return color


def _on_surface(body, per_node):
    """Each vertex of the body's surface: the mean over the nodes that carry it (section 6.5 of the paper), weighted by the kernel
    (1 - (d / h)^2)^2, where d is the distance and h the node's support radius. Zero for an orphan."""
    import numpy as np

    indptr, nodes, distances = body.carriers()
    kernel = np.clip(1 - (distances / body.nodes.radius[nodes]) ** 2, 1e-6, 1) ** 2
    vertex = np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))
    weight = np.bincount(vertex, kernel, len(indptr) - 1)
    total = np.bincount(vertex, kernel * np.asarray(per_node)[nodes], len(indptr) - 1)
    return np.divide(total, weight, out=np.zeros_like(total), where=weight > 0)


def _size(size):
    width, height = _numbers("size", size, (2,))
    if not (8 <= width <= 16384 and 8 <= height <= 16384 and width == int(width) and height == int(height)):
        raise _refuse("size", "width and height in pixels, 8 to 16384")
    return int(width), int(height)


def picture(x, *, size=(960, 720), camera=(30.0, 22.0), zoom=1.0, up="z", color=None, color_range=None, skin="#e0803a", opacity=1.0,
            sheets=False, seams=False, wire=False, explode=0.0, cut_away=None, hollow=False, nodes=False, edges=False, field=None,
            ground=True, samples=3, progress=None):
    """Draws a Mesh, a list of pieces, a Complex, a Score, a NodeSet, a Body or a Simulation: (height, width, 3) uint8, sRGB.

    size: width and height in pixels. camera: azimuth about the vertical axis and elevation, in degrees. zoom: 1 shows
    everything. up: the model's vertical axis, "z" or "y".

    color: "model" (its materials and colours, where it has them), "patch" (skin, and the two sides of cracks), "piece", "plain"; of a Simulation "stress" (von Mises, Pa); or one number
    per vertex of the surface, shown by a scale from dark blue over green to yellow. color_range: lowest and highest number of
    the scale. skin: colour of the skin, "#rrggbb". opacity: of the surface, 0 to 1; with sheets, that of the skin alone.
    seams: draw where cracks meet the skin, green, and where they end, red. wire: draw the edges of triangles.

    explode: pieces move apart by this fraction of their distance from the middle. cut_away: a plane (nx, ny, nz) or (nx, ny,
    nz, offset), beyond which nothing is drawn; its offset from the middle is in half diagonals. hollow: leave the section
    open. nodes, edges: draw nodes, and the edges of the visibility graph (section 6.1 of the paper). field: one number per
    node, for colours; without, the stress of a Simulation, else the spacing. ground: draw a floor. samples: rays per pixel
    and direction. progress: see docs/python.md.

    Raises InputError for anything else, and for an option out of range.
    """
    from kerf import _picture

    content = _content_of(x)
    color = content.color if color is None else color
    named = isinstance(color, str) and color in ("model", "patch", "piece", "plain")
    drawn_nodes = {}
    nodes, edges = _flag("nodes", nodes), _flag("edges", edges)
    if (nodes or edges or not content.surfaces) and content.positions is not None:
        drawn_nodes = {"positions": content.positions, "spacing": content.spacing, "values": content.field if field is None else field}
        drawn_nodes["edges"] = content.graph.edges.tolist() if edges and content.graph is not None else None
    if drawn_nodes and explode and content.surfaces:
        raise _kerf.InputError("explode: nodes do not move with the pieces; draw nodes or explode")
    look = {
        "color": color if named else "plain",
        "values": None if named else _values_of_surface(x, color),
        "range": None if color_range is None else _numbers("color_range", color_range, (2,)),
        "skin": skin if isinstance(skin, str) else _choice("skin", skin, ["#rrggbb"]),
        "opacity": _number("opacity", opacity, 0, 1),
        "sheets": _flag("sheets", sheets),
        "seams": _flag("seams", seams),
        "wire": _flag("wire", wire),
        "explode": _number("explode", explode, 0, 1e6),
        "cut_away": _plane(cut_away),
        "hollow": _flag("hollow", hollow),
        "ground": _flag("ground", ground),
    }
    view = {
        "size": _size(size),
        "camera": _numbers("camera", camera, (2,)),
        "zoom": _number("zoom", zoom, 1e-3, 1e6),
        "y_up": _choice("up", up, ["z", "y"]) == "y",
        "samples": int(_number("samples", samples, 1, 16)),
    }
    return _picture.picture(content.surfaces, content.obstacles, drawn_nodes, look, view, progress)


# ---- Notebooks: classes get _repr_png_ and _repr_html_.

_SMALL = {"size": (480, 360), "samples": 2}


def _look_in_notebooks(x):
    if _is(x, "Simulation"):
        return {**_SMALL, "color": "stress"}
    if _is(x, "Complex"):
        return {**_SMALL, "explode": 0.3}
    return _SMALL


def _repr_png_(self):
    """The object as PNG, for notebooks."""
    from kerf import _picture

    return bytes(_picture.png(picture(self, **_look_in_notebooks(self))))


def _figures(x):
    if _is(x, "Mesh"):
        return [("vertices", f"{len(x.vertices)}"), ("faces", f"{len(x.faces)}"), ("volume", f"{x.volume:.6g}"), ("area", f"{x.area:.6g}")]
    if _is(x, "Complex"):
        return [("vertices", f"{x.vertex_count}"), ("faces", f"{x.live_face_count}"), ("cracks", f"{x.crack_count}")]
    if _is(x, "Body"):
        return [("nodes", f"{len(x.nodes.positions)}"), ("edges", f"{len(x.graph.edges)}"), ("faces", f"{len(x.surface.faces)}")]
    return [("frame", f"{x.frame}"), ("time", f"{x.time:.4g} s"), ("nodes", f"{len(x.positions)}"), ("largest stress", f"{max(x.stress, default=0):.4g} Pa")]


def _repr_html_(self):
    """The object's figures and picture, for notebooks."""
    import base64
    import html

    rows = "".join(f"<tr><th style='text-align:left'>{name}</th><td>{html.escape(value)}</td></tr>" for name, value in _figures(self))
    data = base64.b64encode(_repr_png_(self)).decode()
    return (
        f"<div><b>kerf.{html.escape(type(self).__name__)}</b><table>{rows}</table>"
        f"<img alt='' width='480' height='360' src='data:image/png;base64,{data}'></div>"
    )


for _name in ("Mesh", "Complex", "Body", "Simulation"):
    if hasattr(_kerf, _name):
        setattr(getattr(_kerf, _name), "_repr_png_", _repr_png_)
        setattr(getattr(_kerf, _name), "_repr_html_", _repr_html_)
