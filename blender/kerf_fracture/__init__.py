"""Kerf Fracture: breaks solids into closed pieces, with bonds for rigid bodies. docs/blender.md says how it is used."""

bl_info = {
    "name": "Kerf Fracture",
    "author": "Kerf",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View: Object > Quick Effects, and the sidebar's Kerf tab",
    "description": "Break solids into closed pieces that keep materials, UVs and colours, with bonds between them",
    "category": "Object",
}

if "operators" in locals():  # the user has pressed Reload Scripts
    import importlib

    for module in (arrays, ply, backend, with_module, with_tools, job, source, build, physics, settings, operators, panel):  # noqa: F821
        importlib.reload(module)

from . import arrays, ply, backend, with_module, with_tools, job, source, build, physics, settings, operators, panel  # noqa: E402


def register():
    for module in (settings, operators, panel):
        module.register()


def unregister():
    for module in (panel, operators, settings):
        module.unregister()
