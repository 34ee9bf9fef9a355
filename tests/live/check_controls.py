"""check_controls.py TOOLS_DIR SCENES_DIR MODELS_DIR CASE...: tools and controls of kerf-live's page, used by real pointer events.

scalpel: an edge that follows the pointer on the surface cuts in; pause, step, undo and reset by their buttons.
wound: the scalpel's edge stands on the skin as it is drawn, and passes over an open cut without going into it.
model: a model without a scene waits for the first hand, and again after a reset.
pin: it holds its place while the body is shaken. sliders: the material has the values that they show.
reconnect: a page that lost its connection, and one that is loaded again, show the whole state.
paused: a stroke drawn without a step cuts at the next one; keys after clicks, Escape in a stroke, the graph after a cut, a hidden page.
broken: a click breaks the body; what is kept then is no scene, and undo gives the scene back.
press: obstacles, a plane among them, are drawn, also in the view that the address asks for.
Of each, no console error, no frame with triangles that cross, and the recorded scene replays to the same bytes.
"""
import time
from hand import along
from page_session import Session, check, figures, hand, models, run

# The triangles that the page has: how many, how many on cracks, and sums of their vertices' numbers and positions.
SHOWN = """(() => {
  const c = surface.corners, sums = [0, 0, 0, 0];
  for (let s = 0; s < c.slots; s++) {
    if (c.kind[s] === noKind) continue;
    sums[0]++, sums[1] += c.kind[s] === 0 ? 0 : 1;
    for (let k = 3 * s; k < 3 * s + 3; k++) sums[2] += c.vertex[k] * (1 + k % 3), sums[3] += live.position[3 * c.vertex[k] + k % 3];
  }
  return sums; })()"""


def shown():
    hand.wait("live.frame === null")  # the newest frame is drawn
    return hand.run(SHOWN)


def scalpel():
    session = Session("polyp")
    session.pause()
    hand.button("#reset")
    hand.wait("live.time === 0 && live.stats.paused")
    whole = shown()
    hand.button("#step")
    hand.wait("live.time > 0")
    rate = hand.run("live.told.rate")
    check(f"scalpel: a step leads to {hand.run('live.time')} s", abs(hand.run("live.time") * rate - 1) < 1e-9)

    hand.tool("scalpel")
    for _ in range(16):
        hand.key("[")
    x, y = hand.place([0, 0, 0.45])
    hand.drag(along([x - 40, y], [x + 40, y + 6], steps=10), each=hand.step)
    hand.finish()
    now, stats = shown(), hand.stats()
    check(f"scalpel: {whole} became {now}, {stats}", now[1] > 0 and stats["undo"] == 1)
    hand.wait("!$('undo').disabled")  # figures are drawn ten times a second
    hand.button("#undo")
    hand.wait("live.stats.undo === 0")
    check(f"scalpel: after undo {shown()}, not {whole}", shown()[:3] == whole[:3])
    hand.step()
    check("scalpel: the first frame after undo says that it has cut", not hand.stats()["cut"])

    hand.button("#pause")
    hand.wait("!live.stats.paused && live.time > 0.2")
    hand.button("#pause")
    hand.wait("live.stats.paused")
    still = hand.run("new Promise((done) => { const at = live.time; setTimeout(() => done(live.time - at), 200); })")
    check(f"scalpel: the run goes on for {still} s while it is paused", still == 0)
    hand.drag(along([x - 40, y], [x + 40, y], steps=10), each=hand.step)
    hand.finish()
    check(f"scalpel: a second cut leaves {shown()}", shown()[1] > 0)
    session.done()


# Angles between the normals under neighbouring places of a row, where the skin faces the eye: as drawn, and of triangles.
ROW = """(() => {
  let drawn = 0, flat = 0, hits = 0, last = null;
  for (let x = 0; x < 640; x += 0.25) {
    const { origin, ray } = rayAt(x, %f), hit = surface.hit(origin, ray);
    if (hit && hit.flat.dot(ray) < -0.6) {
      hits++;
      if (last) drawn = Math.max(drawn, hit.normal.angleTo(last.normal)), flat = Math.max(flat, hit.flat.angleTo(last.flat));
      last = hit;
    } else last = null;
  }
  return { hits, drawn, flat }; })()"""

# Shows a groove in place of the body: two plates of skin that face the eye, and two walls that meet 0.5 below their plane, 0.4 apart at the top.
# Messages of the scalpel are kept in `sent`, as places across the groove and heights above the plates' plane.
GROOVE = """(() => {
  const across = new THREE.Vector3(), up = new THREE.Vector3(), eye = new THREE.Vector3();
  camera.matrixWorld.extractBasis(across, up, eye);
  window.grooveAt = (u, v, w) => across.clone().multiplyScalar(u).addScaledVector(up, v).addScaledVector(eye, w);
  const rows = [[-0.8, 0], [-0.2, 0], [-0.2, 0], [0, -0.5], [0, -0.5], [0.2, 0], [0.2, 0], [0.8, 0]];
  const points = rows.flatMap(([u, w]) => [grooveAt(u, -0.6, w), grooveAt(u, 0.6, w)]).flatMap((p) => toWorld(p));
  const corners = [], patch = [];
  for (let part = 0; part < 4; part++) {
    const a = 4 * part;
    corners.push(a, a + 2, a + 1, a + 1, a + 2, a + 3), patch.push(...(part === 1 || part === 2 ? [1, 1] : [0, 0]));
  }
  const lo = [0, 1, 2].map((k) => Math.min(...points.filter((x, i) => i % 3 === k)));
  const step = [0, 1, 2].map((k) => Math.max(1e-9, Math.max(...points.filter((x, i) => i % 3 === k)) - lo[k]) / 65535);
  const vertices = points.length / 3, position = Uint16Array.from(points, (x, i) => Math.round((x - lo[i % 3]) / step[i % 3]));
  stateArrived({ about: live.told, revision: live.revision, vertices, faces: patch.length, nodes: 0, corners: Uint32Array.from(corners), patch });
  frameArrived({ revision: live.revision, vertices, nodes: 0, about: live.stats, lo, step, position }, live.time);
  window.sent = [];
  window.send = ({ scalpel }) => {
    if (!scalpel) return;
    const p = toShown(scalpel.point);
    sent.push({ u: p.dot(across), w: p.dot(eye), facing: new THREE.Vector3(...scalpel.normal).dot(eye) });
  };
})()"""


def model():
    session = Session("polyp", scene=False)

    def waits(when):
        hand.wait("live.time === 0")
        time.sleep(0.5)
        check(f"model: {when}, time went to {hand.run('live.time')}", hand.run("live.time") == 0)

    waits("before the first touch")
    hand.key("o")
    hand.drag([(300, 250), (330, 260)])
    hand.key("k")
    waits("with another view")
    middle = [(a + b) / 2 for a, b in zip(*hand.run("live.told.box"))]
    x, y = hand.place(middle)
    hand.drag(along((x - 250, y), (x + 250, y), steps=12), each=lambda: hand.wait("live.frame === null"))
    hand.wait("live.time > 0.3 && live.stats.undo === 1")
    hand.key("r")
    waits("after a reset")
    hand.button("#step")
    hand.wait("live.time > 0")
    check(f"model: the console has {hand.errors}", not hand.errors)
    check("model: exit code", session.program.stop() == 0)


def wound():
    session = Session("polyp")
    session.begin()
    row = hand.run(ROW % hand.place([0, 0, 0.3])[1])
    check(f"wound: normals along a row jump: {row}", row["hits"] > 100 and row["flat"] > 0.1 and row["drawn"] < 0.2 * row["flat"])
    hand.tool("scalpel")
    hand.run(GROOVE)
    place = lambda u: hand.place(hand.run(f"toWorld(grooveAt({u}, 0.05, 0))"))
    hand.drag(along(place(-0.5), place(0.5), steps=20), each=lambda: hand.run("new Promise((done) => setTimeout(done, 10))"))
    sent = hand.run("sent.splice(0)")
    over = [s for s in sent if abs(s["u"]) < 0.19]
    check(f"wound: the edge leaves the skin's plane: {sent}", len(over) > 3 and all(abs(s["w"]) < 1e-3 and s["facing"] > 0.999 for s in sent))
    check(f"wound: the edge stops before the other side: {sent}", sent[0]["u"] < -0.4 and sent[-1]["u"] > 0.49)
    hand.drag(along(place(-0.1), place(0.1), steps=4), each=lambda: hand.run("new Promise((done) => setTimeout(done, 10))"))
    sent = hand.run("sent.splice(0)")
    check(f"wound: on a wall the edge does not stand on it: {sent}", len(sent) > 3 and all(s["w"] < -0.2 and s["facing"] < 0.9 for s in sent))
    hand.reload()
    hand.step()
    session.done()


def pin():
    session = Session("jello")
    top = hand.place([0.5, 0.5, 1.0])
    hand.tool("pin")
    hand.click(*top)
    hand.wait("live.stats.pins.length === 1")
    # The vertex nearest to the pin, and its way from there.
    hand.run("""window.pinned = (() => { const at = toShown(live.stats.pins[0]), p = new THREE.Vector3(); let best = 0, least = 9;
      for (let v = 0; v < live.vertices; v++) { const d = p.fromArray(live.position, 3 * v).distanceTo(at); if (surface.corners.first[v] >= 0 && d < least) least = d, best = v; }
      return { v: best, at: p.fromArray(live.position, 3 * best).clone() }; })(); 1""")
    hand.tool("grab")
    side, held, moved = hand.place([0.95, 0.1, 0.9]), 0, 0
    other = """(() => { const p = new THREE.Vector3(), g = hand.stroke?.tool; return g ? g.held().distanceTo(g.at.point) : 0; })()"""
    for dx, dy in [(80, -50), (-60, -70)]:
        hand.drag(along(side, [side[0] + dx, side[1] + dy], steps=6), release=False,
                  each=lambda: hand.wait(f"live.time > {hand.run('live.time')} + 0.02"))
        moved = max(moved, hand.run(other))
        held = max(held, hand.run("new THREE.Vector3().fromArray(live.position, 3 * pinned.v).distanceTo(pinned.at)"))
        hand.mouse("mouseReleased", side[0] + dx, side[1] + dy)
        hand.wait("hand.stroke === null")
        side = hand.place([0.95, 0.1, 0.9])
    check(f"pin: the held place moves by {moved}, the pinned one by {held}", moved > 0.05 and held < max(0.02, moved / 10))
    hand.tool("pin")
    hand.click(*hand.run("(() => { placeCamera(); const p = pinned.at.clone().project(camera), c = $('canvas').getBoundingClientRect(); return [c.x + (p.x + 1) / 2 * c.width, c.y + (1 - p.y) / 2 * c.height]; })()"))
    hand.wait("live.stats.pins.length === 0")
    session.pause()
    session.done()


def broken():
    session = Session("jello", "--record", "broken.toml")
    session.pause()
    hand.tool("break")
    hand.click(*hand.place([0.5, 0.1, 0.9]))
    hand.wait("live.stats.blows === 1 && live.stats.undo === 1 && live.stats.pieces > 4")
    check("broken: a click beside the body breaks it", not hand.run("breakAt(3, 3)"))
    pieces = hand.stats()["pieces"]
    hand.key("u")
    hand.wait("live.stats.blows === 0 && live.stats.pieces === 1")
    session.program.save("toml", "whole.toml")
    hand.key("U")
    hand.wait(f"live.stats.blows === 1 && live.stats.pieces === {pieces}")
    hand.key(" ")
    hand.wait("!live.stats.paused")
    at = hand.run("live.time")
    hand.wait(f"live.time > {at} + 0.3")
    session.program.save("stl", "broken.stl")
    check(f"broken: the .stl has {figures('broken.stl')}", figures("broken.stl")["faces"] > 1000)
    check(f"broken: the console has {hand.errors}", not hand.errors)
    code = session.program.stop()
    check(f"broken: exit code {code}: {session.program.said}", code == 0 and "recorded in broken.toml" in "".join(session.program.said))
    check("broken: the scene has the blow", open("broken.toml").read().count("[[blow]]") == 1)


def sliders():
    session = Session("jello")
    session.pause()
    hand.button("#menu")
    hand.wait("!document.body.classList.contains('wide')")

    def box(name):
        return hand.run(f"(() => {{ const e = $('{name}'); e.scrollIntoView({{ block: 'center' }}); const r = e.getBoundingClientRect(); return [r.x, r.y, r.width, r.height]; }})()")

    for name in ("young", "gravity", "friction", "damping"):
        x, y, w, h = box(name)
        before = hand.stats()["set"][name]
        hand.drag(along([x + w / 2, y + h / 2], [x + 0.8 * w, y + h / 2], steps=3))
        hand.step()  # values change between two frames
        hand.wait(f"JSON.stringify(live.stats.set.{name}) !== {str(before).replace(' ', '')!r}")
        hand.wait(f"(() => {{ const at = Number($('{name}').value), set = live.stats.set.{name}; "
                  f"const value = {'length(set) / length(live.told.gravity)' if name == 'gravity' else 'set'}; return Math.abs(toSlider('{name}', value) - at) < 1e-4; }})()")
        at = hand.run(f"Number($('{name}').value)")
        check(f"sliders: {name} is at {at}, not where the pointer left it", 0.6 < at < 0.95)
    check(f"sliders: {hand.stats()['set']}", hand.run("live.stats.set.young > live.told.young && length(live.stats.set.gravity) > length(live.told.gravity)"))
    # An arrow key on a slider that was clicked moves the slider, and not the eye.
    x, y, w, h = box("young")
    hand.click(x + 0.6 * w, y + h / 2)
    hand.step()
    hand.wait("Math.abs(toSlider('young', live.stats.set.young) - 0.6) < 0.05")
    eye, young = hand.run("view.azimuth"), hand.stats()["set"]["young"]
    hand.key("ArrowLeft")
    hand.step()
    hand.wait(f"live.stats.set.young < {young}")
    check("sliders: the eye moves", hand.run("view.azimuth") == eye)
    session.done()


def reconnect():
    session = Session("polyp")
    session.begin()
    whole = shown()
    # The connection breaks while an edge is in the body: the stroke ends, and the page comes back by itself.
    way = along(hand.place([-1.0, 0.3, -0.02]), hand.place([1.0, -0.3, 0.03]), steps=12)
    hand.drag(way[:8], each=hand.step, release=False)
    half = shown()
    check(f"reconnect: {whole} became {half} by half a stroke", half[1] > 0)
    hand.run("window.stateBefore = live.told; link.socket.close()")
    hand.wait("wire.open && live.told !== stateBefore")
    check(f"reconnect: the page shows {shown()}, not {half}", shown() == half)
    hand.mouse("mouseReleased", *way[7])
    hand.finish()
    after, stats = shown(), hand.stats()
    check(f"reconnect: {stats}", stats["undo"] == 1 and stats["paused"])
    hand.reload()
    check(f"reconnect: a page that is loaded again shows {shown()}, not {after}", shown() == after)
    check("reconnect: the run is not paused any more", hand.stats()["paused"])
    hand.wait("!$('undo').disabled")  # figures are drawn ten times a second
    hand.button("#undo")
    hand.wait("live.stats.undo === 0")
    check(f"reconnect: after undo {shown()}, not {whole}", shown()[:2] == whole[:2])
    hand.step()
    session.done()


def paused():
    session = Session("polyp")
    session.begin()
    hand.key("e")
    hand.wait("live.pairs && inside.edges.lines.visible")
    whole = hand.run("live.pairs.length")
    way = along(hand.place([-1.0, 0.3, -0.02]), hand.place([1.0, -0.3, 0.03]), steps=12)
    hand.drag(way)
    hand.finish()
    said = {key: hand.stats()[key] for key in ("pieces", "undo", "refused")}
    check(f"paused: a stroke from side to side, then steps: {said}", said["pieces"] == 2 and said["undo"] == 1)
    hand.wait(f"live.pairs && !live.asked && live.pairs.length !== {whole}")
    check("paused: no graph is drawn after a cut", hand.run("inside.edges.lines.visible"))
    hand.wait("!$('undo').disabled")  # figures are drawn ten times a second
    hand.button("#undo")
    hand.wait(f"live.pairs && !live.asked && live.pairs.length === {whole}")
    hand.key("e")

    hand.button("#reset")
    hand.key(" ")
    hand.wait("!live.stats.paused && live.time > 0")
    hand.tool("knife")
    hand.key(" ")
    hand.wait("live.stats.paused")

    eye = hand.run("[view.azimuth, view.elevation]")
    hand.drag(way[:6], release=False)
    hand.key("Escape")
    hand.wait("hand.stroke === null")
    hand.drag(way[6:10])
    check("paused: after Escape the drag turns the view", hand.run("[view.azimuth, view.elevation]") == eye)
    hand.finish()

    # Hidden, as in a tab behind another one: a notice comes, and the page is seen again.
    hand.key("r")
    hand.wait("live.time === 0")
    hand.run("window.covered = true; Object.defineProperty(document, 'hidden', { configurable: true, get: () => window.covered }); 1")
    hand.key(" ")
    time.sleep(0.5)  # the page is sent one frame, which it does not confirm
    hand.run("send({ undo: true })")
    hand.wait("!$('notice').hidden && $('notice').classList.contains('wrong')")
    hand.run("window.covered = false; document.dispatchEvent(new Event('visibilitychange')); 1")
    at = hand.run("live.time")
    hand.wait(f"live.time > {at} + 0.2")
    hand.key(" ")
    hand.wait("live.stats.paused")
    session.done()


def press():
    session = Session("press", "--set", f"obstacle.1.mesh={models}/ball.ply", "--set", "body.nodes=300")
    session.begin()
    drawn = hand.run("world.things.children.map((mesh) => mesh.geometry.index.count)")
    check(f"press: obstacles of {drawn} corners are drawn", len(drawn) == 2 and min(drawn) > 100)
    plate = hand.run("world.things.children[0].geometry.attributes.position.array.slice(0, 3)")
    check(f"press: the plate is at {plate}", abs(hand.run(f"toWorld(new THREE.Vector3({plate['0']}, {plate['1']}, {plate['2']}))")[2]) < 1e-3)
    hand.run("location.hash = '#shadows=false&edges=true&look=tissue&distance=3'")
    hand.reload()
    hand.wait("live.pairs && inside.edges.lines.visible && state.skin < 1")
    check("press: the address's controls", hand.run("$('look').value === 'tissue' && $('edges').checked && !$('shadows').checked"))
    hand.step()
    session.done()


run(globals())
