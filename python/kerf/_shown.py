"""Meshes in other packages and on the screen: to_trimesh(), to_open3d() and show()."""
from kerf import _kerf
from kerf._pictures import picture


def _require_mesh(of, method):
    # Called through the class, a method takes any object; those of the compiled module refuse it likewise.
    if not isinstance(of, _kerf.Mesh):
        raise TypeError(f"{method}() is a method of Mesh, and got a {type(of).__name__}")


def to_trimesh(self):
    """The mesh as a trimesh.Trimesh, with the arguments of to_trimesh_kwargs(). Raises kerf.Error without the package trimesh."""
    _require_mesh(self, "to_trimesh")
    try:
        import trimesh
    except ImportError as error:
        raise _kerf.Error("to_trimesh: the package trimesh is not installed") from error

    return trimesh.Trimesh(**self.to_trimesh_kwargs())


def _of_vertices(mesh, corners):
    """Values of corners, of shape (n, 3, k), as means at vertices."""
    import numpy as np

    at = mesh.faces.reshape(-1)
    values = corners.reshape(len(at), -1)
    total = np.zeros((len(mesh.vertices), values.shape[1]))
    np.add.at(total, at, values)
    return total / np.maximum(np.bincount(at, minlength=len(total)), 1)[:, None]


def to_open3d(self):
    """The mesh as an open3d.geometry.TriangleMesh, with texture coordinates and groups as material ids.

    Colours and normals are those of its vertices: the means of their corners. Open3D's have no alpha.
    Raises kerf.Error without the package open3d.
    """
    _require_mesh(self, "to_open3d")
    try:
        import open3d
    except ImportError as error:
        raise _kerf.Error("to_open3d: the package open3d is not installed") from error
    import numpy as np

    # Open3D copies arrays, but refuses those that cannot be written.
    of = open3d.utility
    made = open3d.geometry.TriangleMesh(of.Vector3dVector(np.array(self.vertices)), of.Vector3iVector(self.faces.astype(np.int32)))
    if self.uv is not None:
        made.triangle_uvs = of.Vector2dVector(np.array(self.uv).reshape(-1, 2))
    if self.groups is not None:
        made.triangle_material_ids = of.IntVector(np.array(self.groups))
    if self.colors is not None:
        made.vertex_colors = of.Vector3dVector(_of_vertices(self, self.colors[:, :, :3]))
    if self.normals is not None:
        mean = _of_vertices(self, self.normals)
        length = np.linalg.norm(mean, axis=1)[:, None]
        made.vertex_normals = of.Vector3dVector(mean / np.where(length > 0, length, 1))
    return made


def show(self, **options):
    """Shows the object: below the cell of a notebook, else in a window of matplotlib. options: those of kerf.picture().

    Raises kerf.Error without the package matplotlib, and as kerf.picture().
    """
    import sys

    image = picture(self, **options)
    if "IPython" in sys.modules and sys.modules["IPython"].get_ipython() is not None:
        from IPython.display import Image, display

        from kerf import _picture

        display(Image(data=bytes(_picture.png(image)), format="png"))
        return
    try:
        import matplotlib.pyplot as pyplot
    except ImportError as error:
        raise _kerf.Error("show: the package matplotlib is not installed; kerf.picture() gives the image") from error

    figure = pyplot.figure(figsize=(image.shape[1] / 100, image.shape[0] / 100), dpi=100)
    figure.figimage(image)
    pyplot.show()


_kerf.Mesh.to_trimesh = to_trimesh
_kerf.Mesh.to_open3d = to_open3d
for _name in ("Mesh", "Complex", "Body", "Simulation"):
    setattr(getattr(_kerf, _name), "show", show)
