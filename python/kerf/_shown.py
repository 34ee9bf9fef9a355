"""Meshes in other packages and on the screen: to_trimesh() and show()."""
from kerf import _kerf
from kerf._pictures import picture


def to_trimesh(self):
    """The mesh as a trimesh.Trimesh, with the arguments of to_trimesh_kwargs(). Needs the package trimesh."""
    import trimesh

    return trimesh.Trimesh(**self.to_trimesh_kwargs())


def show(self, **options):
    """Shows the object: below the cell of a notebook, else in a window of matplotlib. options: those of kerf.picture()."""
    import sys

    image = picture(self, **options)
    if "IPython" in sys.modules and sys.modules["IPython"].get_ipython() is not None:
        from IPython.display import Image, display

        from kerf import _picture

        display(Image(data=bytes(_picture.png(image)), format="png"))
        return
    import matplotlib.pyplot as pyplot

    figure = pyplot.figure(figsize=(image.shape[1] / 100, image.shape[0] / 100), dpi=100)
    figure.figimage(image)
    pyplot.show()


_kerf.Mesh.to_trimesh = to_trimesh
for _name in ("Mesh", "Complex", "Body", "Simulation"):
    setattr(getattr(_kerf, _name), "show", show)
