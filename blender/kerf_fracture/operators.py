"""The operators: fracture, preview of walls, repair. Each runs in a thread while Blender stays responsive, and in the foreground
where Blender has no window."""

import time

import bpy
import mathutils
import mathutils.bvhtree
import numpy
from bpy.props import BoolProperty, FloatProperty

from . import backend, build, physics, settings, source
from .job import Job

WALLS = "kerf_walls_of"  # custom property of a preview: the name of its object


def refuse(context, name, sentence=None):
    """Notes that an object was refused, which the panel shows; without a sentence, that it was not."""
    found = context.window_manager.kerf_refusals
    at = found.find(name)
    if sentence is None:
        if at >= 0:
            found.remove(at)
        return
    entry = found[at] if at >= 0 else found.add()
    entry.name, entry.sentence = name, sentence


def remove_walls(names):
    for found in [o for o in bpy.data.objects if o.get(WALLS) in names]:
        mesh = found.data
        bpy.data.objects.remove(found)
        bpy.data.meshes.remove(mesh)


class Work:
    """An operator that works on each selected object: work() in a thread, then finish() with what it returned."""

    verb = ""

    @classmethod
    def poll(cls, context):
        if context.mode != "OBJECT":
            cls.poll_message_set("Leave edit mode first")
        elif any(o.type in source.TYPES for o in context.selected_objects):
            return True
        elif any(o.is_instancer for o in context.selected_objects):
            cls.poll_message_set("An instance has no faces of its own; make it real first (Object, Apply, Make Instances Real)")
        else:
            cls.poll_message_set("Select a mesh, curve, surface, text or metaball")
        return False

    def prepare(self, context):
        """Reads the objects and makes the job; False after a report when there is nothing to do."""
        self._begin = time.monotonic()
        self._refused = []
        try:
            self._kerf = backend.choose(*settings.preferences(context))
        except backend.Failed as error:
            self.report({"ERROR"}, f"{error}.")
            return False
        try:
            self._image = self.image_for_reading()
        except backend.Refused as error:
            self.report({"ERROR"}, f"{error}.")
            return False
        depsgraph = context.evaluated_depsgraph_get()
        sources = []
        for found in context.selected_objects:
            if found.type in source.TYPES and WALLS not in found:
                try:
                    sources.append(source.read(found, depsgraph, self.density_group_for_reading()))
                except backend.Refused as error:
                    self._refused.append((found.name, str(error)))
        cursor = context.scene.cursor.location.copy()
        options = [self.fracture_options(own, cursor) for own in sources]
        work = self.work
        self._job = Job(list(zip(sources, options)), lambda item, progress: work(self._kerf, *item, progress))
        return True

    def fracture_options(self, own, cursor):
        return None

    def density_group_for_reading(self):
        """The vertex group whose weights are read."""
        return ""

    def image_for_reading(self):
        """The brightness of the image that is cut out, None without one. Throws Refused."""
        return None

    def execute(self, context):
        if not self.prepare(context):
            return {"CANCELLED"}
        self._job.run()
        return self.end(context)

    def invoke(self, context, event):
        if bpy.app.background:
            return self.execute(context)
        if not self.prepare(context):
            return {"CANCELLED"}
        manager = context.window_manager
        self._timer = manager.event_timer_add(0.05, window=context.window)
        manager.progress_begin(0, 100)
        manager.modal_handler_add(self)
        self._job.start()
        self.show(context)
        return {"RUNNING_MODAL"}

    def show(self, context):
        context.window_manager.progress_update(100 * self._job.fraction)
        context.workspace.status_text_set(f"Kerf: {self.verb} {100 * self._job.fraction:.0f} % ({self._job.words}). Esc stops.")

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS":
            self.cancel(context)
            self.report({"INFO"}, "Stopped; nothing was changed.")
            return {"CANCELLED"}
        if event.type == "TIMER":
            if not self._job.running():
                self.clear(context)
                return self.end(context)
            self.show(context)
        if event.type in {"MIDDLEMOUSE", "WHEELUPMOUSE", "WHEELDOWNMOUSE", "TIMER", "MOUSEMOVE"}:
            return {"PASS_THROUGH"}  # the view may be turned meanwhile
        return {"RUNNING_MODAL"}

    def cancel(self, context):
        self._job.stop()
        self.clear(context)

    def clear(self, context):
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)

    def end(self, context):
        """Makes what the job has found; reports what was refused."""
        done = []
        for (own, _), outcome in zip(self._job.items, self._job.outcomes):
            if isinstance(outcome, backend.Refused):
                self._refused.append((own.name, str(outcome)))
            elif isinstance(outcome, (backend.Failed, OSError)):
                self.report({"ERROR"}, f"{own.name}: {outcome}.")
            elif isinstance(outcome, Exception):
                raise outcome
            else:
                done.append((own, outcome))
        for name, sentence in self._refused:
            refuse(context, name, sentence)
            self.report({"WARNING"} if done else {"ERROR"}, f"{name}: {sentence}.")
        if not done:
            return {"CANCELLED"}
        for own, _ in done:
            refuse(context, own.name)
        self.finish(context, done)
        return {"FINISHED"}


class Patterned(settings.Settings, Work):
    """An operator with the options of a pattern."""

    def density_group_for_reading(self):
        return self.density_group if self.pattern in {"voronoi", "wood"} else ""

    def image_for_reading(self):
        return source.brightness(self.image) if self.pattern == "curves" else None

    def fracture_options(self, own, cursor):
        """The backend's options for one object."""
        impact = axis = None
        if self.at_cursor:
            impact = tuple(own.frame.inverted() @ cursor)
        if self.axis != "AUTO":
            unit = mathutils.Vector([float(name == self.axis) for name in "XYZ"])
            axis = tuple((own.frame.to_3x3().inverted() @ (own.object.matrix_world.to_3x3() @ unit)).normalized())
        return backend.Options(
            pattern=self.pattern, pieces=self.pieces, jagged=self.jagged, bumps=self.bumps, seed=self.seed, axis=axis, impact=impact, image=self._image,
            edge_detail=self.edge_detail, chips=self.chips, chip_size=self.chip_size,
            cluster=self.cluster, grain=self.grain, tile=self.tile, hulls=self.hulls, corners=self.corners,
        )


class OBJECT_OT_kerf_fracture(Patterned, bpy.types.Operator):
    """Break the selected objects into closed pieces"""

    bl_idname = "object.kerf_fracture"
    bl_label = "Kerf Fracture"
    bl_options = {"REGISTER", "UNDO"}
    verb = "fracture"

    def work(self, kerf, own, options, progress):
        return kerf.fracture(own.model, options, progress)

    def finish(self, context, done):
        remove_walls({own.name for own, _ in done})
        build.remove_pieces({own.name for own, _ in done})
        material = build.inner_material(self.inner_material or "Kerf Inner")
        count = bonds = 0
        for own, fracture in done:
            own.object.select_set(False)
            above, made = build.pieces(context, own, fracture, material)
            if self.rigid_bodies:
                hulls = [child for piece in made for child in piece.children]
                physics.add_bodies(context.scene, made, hulls, self.density, self.at_rest, own.object)
                if own.animated:
                    physics.release(context.scene, made)
                if self.bonds:
                    physics.add_bonds(context.scene, own, above, made, fracture.bonds, self.strength)
            if self.hide_original:
                own.object.hide_set(True)
                own.object.hide_render = True
            for piece in made:
                piece.select_set(True)
            context.view_layer.objects.active = made[0]  # the largest
            count, bonds = count + len(made), bonds + len(fracture.bonds)
            for note in fracture.notes:
                self.report({"WARNING"}, f"{own.name}: {note}.")
            if own.left_out:
                self.report({"WARNING"}, f"{own.name}: pieces do not have its {', '.join(own.left_out)}.")
        self.report({"INFO"}, f"{count} pieces, {bonds} bonds in {time.monotonic() - self._begin:.1f} s.")

    def draw(self, context):
        settings.draw(self.layout, self)
        settings.draw_output(self.layout, self)


class OBJECT_OT_kerf_preview(Patterned, bpy.types.Operator):
    """Show the walls along which the selected objects would break"""

    bl_idname = "object.kerf_preview"
    bl_label = "Preview Walls"
    bl_options = {"REGISTER", "UNDO"}
    verb = "walls"

    def work(self, kerf, own, options, progress):
        return kerf.walls(own.model, options, progress)

    def finish(self, context, done):
        remove_walls({own.name for own, _ in done})
        for own, (vertices, triangles) in done:
            walls = bpy.data.objects.new(f"{own.name} Walls", build.plain_mesh(f"{own.name} Walls", vertices, triangles))
            walls[WALLS] = own.name
            build.home(own, context).objects.link(walls)
            build.place(walls, own)
            walls.display_type, walls.show_in_front, walls.hide_render, walls.hide_select = "WIRE", True, True, True

    def draw(self, context):
        settings.draw(self.layout, self)


class OBJECT_OT_kerf_remove_preview(bpy.types.Operator):
    """Remove the walls that are shown"""

    bl_idname = "object.kerf_remove_preview"
    bl_label = "Remove Walls"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return any(WALLS in o for o in context.scene.objects)

    def execute(self, context):
        remove_walls({o[WALLS] for o in context.scene.objects if WALLS in o})
        return {"FINISHED"}


class OBJECT_OT_kerf_repair(Work, bpy.types.Operator):
    """Make solids of the selected objects: weld, orient, close holes. Modifiers are applied"""

    bl_idname = "object.kerf_repair"
    bl_label = "Repair"
    bl_options = {"REGISTER", "UNDO"}
    verb = "repair"

    smooth: BoolProperty(name="Smooth Patches", default=False, description="Close holes by patches that continue the surface around them")
    voxel: FloatProperty(
        name="Voxel", default=0, min=0, max=0.1, step=0.1, precision=4,
        description="Wrap all parts in a new surface, of voxels of this fraction of the diagonal; for parts that overlap. 0: keep the triangles",
    )

    def work(self, kerf, own, _, progress):
        return kerf.repair(own.model, self.voxel, self.smooth, progress)

    def finish(self, context, done):
        for own, (vertices, triangles, words) in done:
            self.report({"INFO"}, f"{own.name}: {words}.")
            if numpy.array_equal(vertices, own.model.vertices) and numpy.array_equal(triangles, own.model.triangles):
                continue  # it was a solid: its polygons and modifiers stay
            if own.object.type != "MESH":
                self.add_mesh(context, own, vertices, triangles)
                continue
            local, vertices, triangles = source.without_scale(own, vertices, triangles)
            triangle = _nearest_triangles(local, vertices, triangles)
            surface = (vertices, triangles, triangle, numpy.zeros((len(triangles), 3, 2)), numpy.zeros(3))
            old = own.object.data
            mesh = build.dressed_meshes(local, [surface], [old.name], None)[0]
            if hasattr(mesh, "use_auto_smooth") and old.use_auto_smooth:  # before Blender 4.1
                mesh.use_auto_smooth, mesh.auto_smooth_angle = True, old.auto_smooth_angle
            own.object.modifiers.clear()
            own.object.data = mesh

    def add_mesh(self, context, own, vertices, triangles):
        """A solid beside an object that cannot hold triangles, a text or a curve, which is hidden."""
        triangle = _nearest_triangles(own, vertices, triangles)
        surface = (vertices, triangles, triangle, numpy.zeros((len(triangles), 3, 2)), numpy.zeros(3))
        name = f"{own.name} Solid"
        made = bpy.data.objects.new(name, build.dressed_meshes(own, [surface], [name], None)[0])
        build.home(own, context).objects.link(made)
        build.place(made, own)
        own.object.select_set(False)
        own.object.hide_set(True)
        own.object.hide_render = True
        made.select_set(True)
        context.view_layer.objects.active = made


def _nearest_triangles(own, vertices, triangles):
    """For each triangle the one of the source nearest to its centroid."""
    tree = mathutils.bvhtree.BVHTree.FromPolygons(own.model.vertices.tolist(), own.model.triangles.tolist(), all_triangles=True)
    return numpy.array([tree.find_nearest(point)[2] for point in vertices[triangles].mean(1).tolist()], numpy.int64)


CLASSES = (OBJECT_OT_kerf_fracture, OBJECT_OT_kerf_preview, OBJECT_OT_kerf_remove_preview, OBJECT_OT_kerf_repair)


def menu(self, context):
    self.layout.operator_context = "INVOKE_DEFAULT"
    self.layout.operator(OBJECT_OT_kerf_fracture.bl_idname)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.VIEW3D_MT_object_quick_effects.append(menu)


def unregister():
    bpy.types.VIEW3D_MT_object_quick_effects.remove(menu)
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
