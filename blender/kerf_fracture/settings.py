"""The options that the operators and the panel share, and the add-on's preferences."""

import bpy
from bpy.props import BoolProperty, CollectionProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

PATTERNS = [
    ("voronoi", "Cells", "Voronoi cells of points spread evenly inside the object"),
    ("planes", "Slices", "Parallel planes, a little unevenly spaced"),
    ("crossing", "Crossing planes", "Three families of planes"),
    ("radial", "Radial", "Planes that meet in a line"),
    ("glass", "Glass", "Radial cracks and rings, closer together near the middle"),
    ("wood", "Wood", "Long cells along the grain"),
    ("bricks", "Bricks", "Courses, each shifted by half a brick"),
    ("curves", "Image", "The borders of an image's black areas, swept along the axis"),
]
AXES = [("AUTO", "Automatic", "The longest extent; the shortest for Radial and Glass")] + [
    (axis, axis, f"The object's {axis} axis") for axis in "XYZ"
]


class Settings:
    """Properties of the operators and of the scene, which the panel shows."""

    pattern: EnumProperty(name="Pattern", items=PATTERNS, default="voronoi", description="Where the walls are")
    pieces: IntProperty(name="Pieces", default=20, min=2, max=100000, soft_max=1000, description="Number of pieces")
    jagged: FloatProperty(
        name="Jaggedness", default=0, min=0, max=0.2, soft_max=0.05, step=0.1, precision=3,
        description="Height of the walls' bumps as a fraction of the object's diagonal; 0: walls are flat",
    )
    bumps: FloatProperty(
        name="Bumps", default=8, min=1, max=100, description="How many of the largest bumps fit along the diagonal. Finer walls have more triangles"
    )
    edge_detail: FloatProperty(
        name="Edge Detail", default=0, min=0, max=0.1, soft_max=0.02, step=0.1, precision=3,
        description="Height of finer bumps where walls meet the surface, as a fraction of the diagonal; 0: none",
    )
    chips: IntProperty(
        name="Chips", default=0, min=0, max=100000, soft_max=1000,
        description="How many small pieces break off where walls meet the surface or each other; beside the number of pieces",
    )
    chip_size: FloatProperty(
        name="Chip Size", default=0.25, min=0.01, max=1, description="Length of a chip along its edge, compared with the size of the mean piece"
    )
    seed: IntProperty(name="Seed", default=1, min=0, description="Another seed gives other walls of the same kind")
    axis: EnumProperty(name="Axis", items=AXES, default="AUTO", description="Across slices, along the grain, up the courses, through radial cracks")
    at_cursor: BoolProperty(
        name="At 3D Cursor", default=False, description="Cells and Wood: smaller pieces near the 3D cursor. Radial and Glass: cracks meet there"
    )
    cluster: FloatProperty(
        name="Cluster", default=0.15, min=0.01, max=1, description="How far from the 3D cursor pieces are small, as a fraction of the diagonal"
    )
    density_group: StringProperty(
        name="Density Group", description="Cells and Wood: vertex group with high weights where pieces are to be small. Empty: pieces are alike everywhere"
    )
    image: StringProperty(name="Image", description="Image: of this file's images, the one whose black areas are cut out")
    grain: FloatProperty(name="Grain", default=5, min=1, max=100, description="Wood: how many times longer than thick pieces are")
    inner_material: StringProperty(
        name="Inner Material", description="Material of inner faces, in a slot of its own; made when it is not there. Empty: Kerf Inner"
    )
    tile: FloatProperty(
        name="Tile", default=0.25, min=0.001, max=100, description="Size of one texture tile on inner faces, as a fraction of the diagonal"
    )
    hide_original: BoolProperty(name="Hide Original", default=True, description="Hide the object that was broken")
    hulls: IntProperty(
        name="Hull Parts", default=0, min=0, max=64,
        description="Add convex hulls for collision as children of the pieces; a piece is divided into this many convex parts at most. 0: no hulls",
    )
    corners: IntProperty(name="Hull Corners", default=32, min=4, max=255, description="How many corners a hull has at most")
    rigid_bodies: BoolProperty(name="Rigid Bodies", default=False, description="Make the pieces rigid bodies; hulls are their shapes, if there are any")
    density: FloatProperty(name="Density", default=1000, min=0.001, soft_max=20000, description="Mass for each unit of volume")
    at_rest: BoolProperty(name="Start at Rest", default=False, description="Pieces do not move until something touches them")
    bonds: BoolProperty(name="Bonds", default=True, description="Join neighbouring pieces by fixed constraints that break")
    strength: FloatProperty(
        name="Strength", default=1e5, min=0, soft_max=1e8, description="Force for each unit of area that a bond withstands (pascal, in metres and kilograms)"
    )


def names():
    return list(Settings.__annotations__)


def copy(a, b):
    """Sets the operator's properties `b` from the settings `a`."""
    for name in names():
        setattr(b, name, getattr(a, name))


def draw(layout, settings, column=True):
    """The options, for the panel and for the operators' dialogs."""
    layout.use_property_split, layout.use_property_decorate = True, False
    block = layout.column(align=True)
    for name in ("pattern", "pieces", "seed"):
        block.prop(settings, name)
    block = layout.column(align=True)
    block.prop(settings, "jagged")
    if settings.jagged:
        block.prop(settings, "bumps")
    block.prop(settings, "edge_detail")
    block.prop(settings, "chips")
    if settings.chips:
        block.prop(settings, "chip_size")
    block = layout.column(align=True)
    if settings.pattern == "curves":
        block.prop_search(settings, "image", bpy.data, "images")
    if settings.pattern in {"planes", "wood", "bricks", "radial", "glass", "curves"}:
        block.prop(settings, "axis")
    if settings.pattern == "wood":
        block.prop(settings, "grain")
    if settings.pattern in {"voronoi", "wood", "radial", "glass"}:
        block.prop(settings, "at_cursor")
        if settings.at_cursor and settings.pattern in {"voronoi", "wood"}:
            block.prop(settings, "cluster")
    if settings.pattern in {"voronoi", "wood"}:
        block.prop(settings, "density_group")


def draw_output(layout, settings):
    layout.use_property_split, layout.use_property_decorate = True, False
    block = layout.column(align=True)
    block.prop_search(settings, "inner_material", bpy.data, "materials")
    block.prop(settings, "tile")
    block.prop(settings, "hide_original")
    block = layout.column(align=True)
    block.prop(settings, "hulls")
    if settings.hulls:
        block.prop(settings, "corners")
    block = layout.column(align=True)
    block.prop(settings, "rigid_bodies")
    if settings.rigid_bodies:
        block.prop(settings, "density")
        block.prop(settings, "at_rest")
        block.prop(settings, "bonds")
        if settings.bonds:
            block.prop(settings, "strength")


class KERF_PG_settings(Settings, bpy.types.PropertyGroup):
    pass


class KERF_PG_refusal(bpy.types.PropertyGroup):
    """An object that was refused, by its name, and Kerf's sentence."""

    sentence: StringProperty()


class KERF_AP_preferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    backend: EnumProperty(
        name="Kerf", default="AUTO", description="How Kerf is called",
        items=[
            ("AUTO", "Automatic", "The Python module where it is installed, else the command-line tools"),
            ("MODULE", "Python module", "The module kerf"),
            ("TOOLS", "Command-line tools", "kerf-score, kerf-crack, kerf-pieces and kerf-repair"),
        ],
    )
    module: StringProperty(name="Module's folder", subtype="DIR_PATH", description="Folder that has the folder kerf of the Python module; empty: where Python looks")
    tools: StringProperty(name="Tools' folder", subtype="DIR_PATH", description="Folder of kerf-score and the other tools; empty: PATH")

    def draw(self, context):
        self.layout.use_property_split = True
        for name in ("backend", "module", "tools"):
            self.layout.prop(self, name)


def preferences(context):
    """backend, module folder, tools folder; the defaults when the add-on was not enabled in the preferences."""
    found = context.preferences.addons.get(__package__)
    own = found and found.preferences
    return (own.backend, bpy.path.abspath(own.tools), bpy.path.abspath(own.module)) if own else ("AUTO", "", "")


CLASSES = (KERF_PG_settings, KERF_PG_refusal, KERF_AP_preferences)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Scene.kerf_fracture = PointerProperty(type=KERF_PG_settings)
    bpy.types.WindowManager.kerf_refusals = CollectionProperty(type=KERF_PG_refusal)


def unregister():
    del bpy.types.WindowManager.kerf_refusals, bpy.types.Scene.kerf_fracture
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
