"""The add-on in Blender with a window, driven by events as a user's: progress, Esc, undo; tests/blender/run.sh runs it.
KERF_BACKEND: AUTO, TOOLS or MODULE. KERF_SCREENSHOT: a file for a picture of the panel."""

import os
import sys
import time
import traceback

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import scenes  # noqa: E402

KINDS = ("objects", "meshes", "materials", "collections", "images", "texts")


def data():
    """The names of all data-blocks, the selection, and which objects are hidden."""
    names = {kind: sorted(block.name for block in getattr(bpy.data, kind)) for kind in KINDS}
    names["selected"] = sorted(o.name for o in bpy.context.scene.objects if o.select_get())
    names["hidden"] = sorted(o.name for o in bpy.context.scene.objects if o.hide_get() or o.hide_render)
    names["world"] = bpy.context.scene.rigidbody_world is None
    return names


def view():
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    return {"window": window, "area": area, "region": region}


def call(operator, *arguments, **options):
    with bpy.context.temp_override(**view()):
        return operator(*arguments, **options)


def press(key):
    window = bpy.context.window_manager.windows[0]
    window.event_simulate(type=key, value="PRESS")
    window.event_simulate(type=key, value="RELEASE")


def running():
    """The words of the operator that runs; none when there is none."""
    return next((state["words"] for state in shown if state["running"]), None)


shown = [{"running": False, "words": ""}]


def watch():
    """Notes what the operators show in the status bar, and which panels are drawn without an error."""
    import kerf_fracture.operators as operators

    show, clear = operators.Work.show, operators.Work.clear

    def noting_show(self, context):
        show(self, context)
        shown[0].update(running=True, words=f"{self.verb} {self._job.fraction:.2f} {self._job.words}")
        seen.append(shown[0]["words"])

    def noting_clear(self, context):
        clear(self, context)
        shown[0].update(running=False)

    operators.Work.show, operators.Work.clear = noting_show, noting_clear
    for panel in (bpy.types.VIEW3D_PT_kerf_fracture, bpy.types.VIEW3D_PT_kerf_fracture_output):
        panel.draw = noting(panel.draw, panel.__name__)


def noting(draw, name):
    def noting_draw(self, context):
        draw(self, context)
        drawn.add(name)

    return noting_draw


seen, drawn = [], set()


def until_idle(seconds):
    end = time.monotonic() + seconds
    while running():
        assert time.monotonic() < end, "the operator does not end"
        yield


def steps():
    scenes.empty_scene()
    bpy.context.preferences.addons["kerf_fracture"].preferences.backend = os.environ["KERF_BACKEND"]
    yield
    watch()
    ball, box = scenes.ball(subdivisions=5), scenes.box()
    box.location.x = 4
    scenes.select(ball, box)
    call(bpy.ops.ed.undo_push, message="scene")
    before = data()
    fracture = bpy.ops.object.kerf_fracture

    # Esc stops, and nothing has changed.
    assert call(fracture, "INVOKE_DEFAULT", pieces=2000, jagged=0.01, bumps=30) == {"RUNNING_MODAL"}
    for _ in range(5):
        yield
    assert running() and len(seen) > 1
    begin = time.monotonic()
    press("ESC")
    yield from until_idle(10)
    print(f"Esc stopped it in {time.monotonic() - begin:.2f} s")
    assert data() == before, data()

    # It ends by itself; one step of undo removes all of it, redo brings it back.
    seen.clear()
    assert call(fracture, "INVOKE_DEFAULT", pieces=20, jagged=0.01, bumps=10, hulls=1, rigid_bodies=True) == {"RUNNING_MODAL"}
    yield
    yield from until_idle(60)
    yield
    after = data()
    assert len(scenes.pieces_of("ball")) == 20 and len(scenes.pieces_of("box")) == 20
    assert {"ball", "box"} <= set(after["hidden"]) and not after["world"] and "Kerf Inner" in after["materials"]
    shares = [float(words.split()[1]) for words in seen]
    assert shares == sorted(shares) and any(0 < share < 1 for share in shares), seen
    call(bpy.ops.ed.undo)
    yield
    assert data() == before, data()
    call(bpy.ops.ed.redo)
    yield
    assert data() == after
    call(bpy.ops.ed.undo)
    yield

    # The preview, and the panel's button with the panel's settings.
    own = bpy.context.scene.kerf_fracture
    own.pieces, own.jagged = 7, 0
    call(bpy.ops.object.kerf_preview, "INVOKE_DEFAULT", pieces=7, jagged=0)
    yield
    yield from until_idle(60)
    assert {"ball Walls", "box Walls"} <= set(data()["objects"])
    call(bpy.ops.ed.undo)
    yield
    assert data() == before

    # A refused object: the panel shows the sentence and the buttons.
    broken = scenes.open_box()
    broken.location.x = -4
    scenes.select(broken)
    try:
        call(fracture, "INVOKE_DEFAULT", pieces=4)
    except RuntimeError as error:
        print(error)
    yield
    yield from until_idle(60)
    yield
    refusals = bpy.context.window_manager.kerf_refusals
    assert [refusal.name for refusal in refusals] == ["open"] and "open" in refusals[0].sentence
    place = view()
    place["area"].spaces.active.show_region_ui = True
    for _ in range(5):
        yield
    sidebar = next(region for region in place["area"].regions if region.type == "UI")
    for below in range(20, 300, 20):  # its tabs, until the add-on's is met
        at = {"x": sidebar.x + sidebar.width - 12, "y": sidebar.y + sidebar.height - below}
        place["window"].event_simulate(type="MOUSEMOVE", value="NOTHING", **at)
        yield
        place["window"].event_simulate(type="LEFTMOUSE", value="PRESS", **at)
        place["window"].event_simulate(type="LEFTMOUSE", value="RELEASE", **at)
        yield
        yield
        if drawn:
            break
    assert drawn == {"VIEW3D_PT_kerf_fracture", "VIEW3D_PT_kerf_fracture_output"}, drawn
    if os.environ.get("KERF_SCREENSHOT"):
        call(bpy.ops.screen.screenshot, filepath=os.environ["KERF_SCREENSHOT"])
    call(bpy.ops.object.kerf_repair, "INVOKE_DEFAULT")
    yield
    yield from until_idle(60)
    yield
    assert not bpy.context.window_manager.kerf_refusals and abs(scenes.volume(broken) - 8) < 1e-4


def main():
    run = steps()

    def tick():
        try:
            next(run)
            return 0.1
        except StopIteration:
            print("1 passed, 0 failed", flush=True)
            os._exit(0)
        except BaseException:
            traceback.print_exc()
            sys.stderr.flush()
            os._exit(1)

    bpy.app.timers.register(tick, first_interval=0.5, persistent=True)


main()
