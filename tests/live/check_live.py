"""check_live.py TOOLS_DIR SCENES_DIR MODELS_DIR CASE...: kerf-live's page in a browser, used by real pointer events.

polyp: cut off by one stroke; two pieces, and their volumes add up. apple: cut by three strokes. jello: grabbed and shaken.
Of each, no console error, no frame with triangles that cross, and the recorded scene replays to the same bytes.
"""
import glob
from hand import along
from page_session import Session, check, figures, hand, kerf, models, run


def volumes_add_up(name, pieces):
    """The pieces in material coordinates have the volume of the model together; specks are no pieces."""
    kerf("kerf-pieces", "-q", f"{name}.kerf", "-o", name + "-pieces")
    parts = [figures(path)["volume"] for path in sorted(glob.glob(f"{name}-pieces/*.ply"))]
    whole = figures(f"{models}/{name}.ply")["volume"]
    large = [part for part in parts if part > 1e-3 * whole]
    check(f"{name}: {len(large)} pieces, not {pieces}: {parts}", len(large) == pieces)
    check(f"{name}: pieces of {parts} do not add up to {whole}", abs(sum(parts) - whole) < 1e-6 * whole)


def polyp():
    session = Session("polyp")
    session.begin()
    hand.drag(along(hand.place([-1.0, 0.3, -0.02]), hand.place([1.0, -0.3, 0.03]), steps=12), each=hand.step)
    hand.finish()
    said = {key: hand.stats()[key] for key in ("pieces", "undo", "refused")}
    check(f"polyp: {said}", said["pieces"] == 2 and said["undo"] == 1)
    # Another view, by the other button, the wheel and keys, and what the page shows of the inside.
    before = hand.run("view.azimuth")
    hand.drag([[300, 300], [360, 280]], button="right")
    hand.mouse("mouseWheel", 300, 300, deltaX=0, deltaY=-120)
    check(f"polyp: the view does not turn from {before}: {hand.run('[view.azimuth, pointers.size, hand.stroke !== null]')}", hand.run("view.azimuth") != before)
    for key in "nte":
        hand.key(key)
    hand.wait("live.node && live.stress && live.pairs && live.pairs.length > 0")
    check("polyp: nodes are not in the surface's box", hand.run("live.node.every((x) => Math.abs(x) < 3)"))
    for key in "nte":
        hand.key(key)
    session.done()
    volumes_add_up("polyp", 2)


def apple():
    session = Session("apple")
    session.begin()
    (x, y), (_, top) = hand.place([0, 0, 0]), hand.place([0, 0, 1])
    r = y - top
    strokes = [((0.5, -1.5), (0.55, 1.5)), ((-0.6, -1.5), (-0.5, 1.5)), ((-1.6, -0.35), (1.6, -0.45))]
    for number, (a, b) in enumerate(strokes, 1):
        before = hand.stats()["pieces"]
        hand.drag(along((x + r * a[0], y + r * a[1]), (x + r * b[0], y + r * b[1]), steps=12), each=hand.step)
        hand.finish()
        said = {key: hand.stats()[key] for key in ("pieces", "undo", "refused")}
        check(f"apple: stroke {number}: {said}", said["pieces"] > before and said["undo"] == number)
    hand.key("u")
    hand.wait("live.stats.undo === 2")
    session.done()


def jello():
    session = Session("jello")
    hand.key("g")
    box = "(() => { let lo = 9, hi = -9; for (let v = 0; v < live.vertices; v++) if (surface.corners.first[v] >= 0) lo = Math.min(lo, live.position[3 * v]), hi = Math.max(hi, live.position[3 * v]); return hi - lo; })()"
    at_rest, top, widest = hand.run(box), hand.place([0.5, 0.5, 1.0]), []
    # Without a pause: frames go on while the pointer shakes it. Each place is held for half a second of the run.
    for dx, dy in [(90, -60), (-90, -40), (60, -80)]:
        hand.drag(along(top, [top[0] + dx, top[1] + dy], steps=4), release=False)
        hand.run("window.widest = 0")
        hand.wait(f"(window.widest = Math.max(window.widest, {box})) && live.time > {hand.run('live.time') + 0.5}", seconds=300)
        widest.append(hand.run("window.widest") / at_rest)
    check(f"jello: as wide as at rest times {widest}", max(widest) > 1.03)
    hand.mouse("mouseReleased", top[0] + 60, top[1] - 80)
    hand.wait("hand.stroke === null && live.stats.pieces === 1")
    session.pause()
    session.done()


run(globals())
