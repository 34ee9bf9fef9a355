"""Meshes in other packages and on the screen: to_trimesh(), to_open3d() and show()."""
from kerf import _kerf
from kerf._pictures import picture


def _require_mesh(of, method):
    # Called through the class, a method takes any object; those of the compiled module refuse it likewise.
    if not isinstance(of, _kerf.Mesh):
        raise TypeError(f"{method}() is a method of Mesh, and got a {type(of).__name__}")


def to_trimesh(self):
    """The mesh as a trimesh.Trimesh, with the arguments of to_trimesh_kwargs(), texture coordinates, materials and colours.

    trimesh keeps texture coordinates and colours at vertices: these are divided along seams, where corners differ. Materials are
    base colours with their images, which need the package PIL. Raises kerf.Error without the package trimesh.
    """
    _require_mesh(self, "to_trimesh")
    try:
        import trimesh
    except ImportError as error:
        raise _kerf.Error("to_trimesh: the package trimesh is not installed") from error

    import numpy as np

    given = self.to_trimesh_kwargs()
    if self.uv is None and self.colors is None:
        return trimesh.Trimesh(**given)
    values = np.concatenate([part.reshape(3 * len(self.faces), -1) for part in (self.uv, self.colors) if part is not None], axis=1)
    corners = np.concatenate([self.faces.reshape(-1, 1), values], axis=1)
    _, first, vertex = np.unique(corners, axis=0, return_index=True, return_inverse=True)
    given["vertices"] = self.vertices[self.faces.reshape(-1)[first]]
    given["faces"] = vertex.reshape(-1, 3)
    colors = None if self.colors is None else np.round(255 * values[first, -4:]).astype(np.uint8)
    if self.uv is None:
        return trimesh.Trimesh(vertex_colors=colors, **given)
    if colors is not None:
        given["vertex_attributes"] = {"color": colors}
    return trimesh.Trimesh(visual=_textures(self, trimesh, values[first, :2]), **given)


def _textures(mesh, trimesh, uv):
    """Texture coordinates with the materials of the groups."""
    import io

    try:
        from PIL import Image
    except ImportError:
        Image = None
    names = mesh.group_names or ("skin",)
    made = []
    for name, (factor, image) in zip(names, mesh._base_colors()):
        picture = Image.open(io.BytesIO(image)) if image and Image else None
        made.append(trimesh.visual.material.PBRMaterial(name=name, baseColorFactor=list(factor), baseColorTexture=picture))
    if len(made) == 1:
        return trimesh.visual.TextureVisuals(uv=uv, material=made[0])
    return trimesh.visual.TextureVisuals(uv=uv, material=trimesh.visual.material.MultiMaterial(made), face_materials=mesh.groups)


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
