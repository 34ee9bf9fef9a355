"""The panels in the sidebar of the 3D view."""

import textwrap

import bpy

from . import settings


class VIEW3D_PT_kerf_fracture(bpy.types.Panel):
    bl_label = "Kerf Fracture"
    bl_category = "Kerf"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"

    def draw(self, context):
        layout, own = self.layout, context.scene.kerf_fracture
        self.draw_refusals(context)
        settings.draw(layout, own)
        row = layout.row(align=True)
        row.operator_context = "INVOKE_DEFAULT"
        settings.copy(own, row.operator("object.kerf_preview"))
        row.operator("object.kerf_remove_preview", text="", icon="X")
        column = layout.column()
        column.operator_context, column.scale_y = "INVOKE_DEFAULT", 1.5
        settings.copy(own, column.operator("object.kerf_fracture", text="Fracture"))

    def draw_refusals(self, context):
        """What was refused among the selected objects, and the buttons that repair it."""
        refused = [context.window_manager.kerf_refusals.get(o.name) for o in context.selected_objects]
        width = max(20, int(context.region.width / (8.5 * context.preferences.system.ui_scale)))
        for refusal in filter(None, refused):
            box = self.layout.box()
            for number, line in enumerate(textwrap.wrap(f"{refusal.name}: {refusal.sentence}.", width)):
                box.label(text=line, icon="NONE" if number else "ERROR")
        if any(refused):
            row = self.layout.row(align=True)
            row.operator_context = "INVOKE_DEFAULT"
            row.operator("object.kerf_repair", icon="TOOL_SETTINGS")
            row.operator("object.kerf_repair", text="Wrap").voxel = 0.005


class VIEW3D_PT_kerf_fracture_output(bpy.types.Panel):
    bl_label = "Pieces and Physics"
    bl_category = "Kerf"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_parent_id = "VIEW3D_PT_kerf_fracture"

    def draw(self, context):
        settings.draw_output(self.layout, context.scene.kerf_fracture)


CLASSES = (VIEW3D_PT_kerf_fracture, VIEW3D_PT_kerf_fracture_output)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)


def unregister():
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
