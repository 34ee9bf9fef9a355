"""check_newcomer.py TOOLS_DIR SCENES_DIR MODELS_DIR CASE...: what a new user of kerf-live's page does first, by real pointer, touch and key events.

first: the first cut of a model has walls, whatever was clicked before, and the body does not sag under it.
path: on a paused body a U by the scalpel and a shallow stroke of the knife are cut as they were drawn.
late: a stroke goes on to where it was released, however long the program stands still.
steps: twenty cuts are undone, and made again.
hold: a grab that stays while the knife cuts; it is moved and let go, by mouse and by two fingers.
look: no picture depends on the order of triangles, walls do not clip, normals of uneven triangles are near those of the surface.
gone: the page says that the program has ended, or does not answer; work that nobody looks at is kept.
drop: a model that is dropped on the page is opened; one that cannot be is refused by a sentence.
keys: a cut by the keyboard alone, dark colours, controls that nothing covers.
begin: a start without a model shows the choice of bodies, once.
guide: clicks that do nothing say so, the body is found again, help begins at its top, a new body is in the middle, a button opens files.
"""
import glob, os, signal, subprocess, time, urllib.request
import pictures
from client import Program
from hand import along
from page_session import Session, check, hand, kerf, models, run, scenes, tools

# Places of the skin's edges at cuts, on the screen.
LIPS = """(() => {
  placeCamera();
  const at = [], p = new THREE.Vector3(), box = $("canvas").getBoundingClientRect(), index = surface.lips.geometry.index.array;
  for (const v of index) p.fromArray(live.position, 3 * v).project(camera), at.push([box.x + (p.x + 1) / 2 * box.width, box.y + (1 - p.y) / 2 * box.height]);
  return at; })()"""
HIGHEST = "(() => { surface.arrive(); let z = -9; for (let v = 0; v < live.vertices; v++) if (surface.corners.first[v] >= 0) z = Math.max(z, live.position[3 * v + 2]); return z; })()"


def model(name, *options):
    return Session(name, *options, scene=False)


def first():
    session = model("polyp")
    hand.tool("scalpel")
    hand.tool("knife")
    before, high = pictures.count(hand, "r > 160 && b > 95 && r > 1.15 * b"), hand.run(HIGHEST)
    middle = [(a + b) / 2 for a, b in zip(*hand.run("live.told.box"))]
    x, y = hand.place(middle)
    pictures.keep(hand, "whole")
    # The way to the body takes a second of the run: it would sag by then.
    sagged = []
    hand.drag(along((x - 260, y), (x - 150, y), steps=10), release=False, each=lambda: hand.wait("live.frame === null"))
    hand.wait("live.time > 1")
    sagged.append(abs(hand.run(HIGHEST) - high))
    differ = pictures.changed(hand, "whole")  # the edge, and what it has swept beside the body
    check(f"first: {differ:.4f} of the picture differ before the knife meets the body", differ < 0.015)
    for place in along((x - 150, y), (x + 260, y + 20), steps=12):
        hand.mouse("mouseMoved", *place)
    hand.mouse("mouseReleased", x + 260, y + 20)
    hand.wait("live.stats.undo === 1 && live.stats.pieces === 2 && live.stats.waiting.length === 0", seconds=200)
    check(f"first: the body sags by {sagged} before the knife meets it", max(sagged) < 1e-3)
    hand.wait("surface.walls.geometry.index && surface.walls.geometry.index.count > 0")
    at = hand.run("live.time")
    hand.wait(f"live.time > {at} + 0.7", seconds=200)
    hand.run("view.elevation = 0.9; draw()")
    after = pictures.count(hand, "r > 160 && b > 95 && r > 1.15 * b")
    check(f"first: walls are not drawn: {before} pixels became {after}", hand.run("surface.walls.visible") and after > before + 100)
    check("first: gravity is not shown as it is", hand.run("$('gravity-value').textContent") == "× 1.00")
    hand.key(" ")
    hand.wait("live.stats.paused")
    session.done()


def path():
    session = Session("polyp")
    session.begin()
    hand.tool("scalpel")
    for _ in range(16):
        hand.key("[")
    x, y = hand.place([0, -0.3, 0.35])
    pictures.keep(hand, "whole")
    u = along((x - 45, y - 40), (x - 40, y + 25), (x + 40, y + 25), (x + 45, y - 40), steps=8)
    hand.drag(u)
    hand.wait("live.stats.waiting.length === 1")
    time.sleep(3)  # longer than what is drawn stays when it has cut
    check("path: what is still to be cut is not shown", hand.run("hand.ghosts.length === 1 && hand.ghosts[0].sheet.visible"))
    hand.finish()
    lips = hand.run(LIPS)
    far = [min(((a - c) ** 2 + (b - d) ** 2) ** 0.5 for c, d in lips) for a, b in u[4:-4]]
    hand.wait("hand.ghosts.length === 0")
    differ, shown = pictures.changed(hand, "whole"), pictures.changed_along(hand, "whole", u[4:-4])
    check(f"path: the picture has changed along {shown:.2f} of the U", shown > 0.7)
    check(f"path: the U is not cut where it was drawn, but {max(far):.0f} pixels from there: {u[4 + far.index(max(far))]}", max(far) < 12)
    hand.key("u")
    hand.wait("live.stats.undo === 0 && live.frame === null")
    again = pictures.changed(hand, "whole")
    check(f"path: after undo {again:.4f} of the picture differ", again < 0.2 * differ)
    hand.tool("knife")
    left, right = hand.place([-0.9, -0.2, 0.5]), hand.place([0.9, -0.2, 0.5])
    hand.drag(along(left, right, steps=30))
    hand.finish()
    hand.wait("hand.ghosts.length === 0")
    inner = [place for place in along(left, right, steps=30) if 0.25 * left[0] + 0.75 * right[0] > place[0] > 0.75 * left[0] + 0.25 * right[0]]
    shown = pictures.changed_along(hand, "whole", inner)
    check(f"path: the picture has changed along {shown:.2f} of the shallow stroke", shown > 0.9)
    across = sorted(x for x, y in hand.run(LIPS))
    gaps = [b - a for a, b in zip(across, across[1:])]
    check(f"path: a shallow stroke leaves {max(gaps, default=999):.0f} pixels of skin whole", len(across) > 10 and max(gaps) < 30 and across[-1] - across[0] > 60)
    session.done()


def late():
    session = model("polyp", "--nodes", "3000")  # so frames follow each other without a break
    middle = [(a + b) / 2 for a, b in zip(*hand.run("live.told.box"))]
    x, y = hand.place(middle)
    pictures.keep(hand, "whole")
    stand, go_on = [lambda s=s: session.program.process.send_signal(s) for s in (signal.SIGSTOP, signal.SIGCONT)]
    hand.drag([(x - 200, y), (x - 170, y), (x - 165, y)], release=False)
    stand()
    for place in along((x - 160, y), (x + 220, y), steps=6):
        hand.mouse("mouseMoved", *place)
    hand.mouse("mouseReleased", x + 220, y)
    go_on()
    time.sleep(0.08)  # the edge is on its way
    stand()
    time.sleep(2.5)
    go_on()
    hand.wait("live.stats.waiting.length === 0 && live.stats.stroke === 1", seconds=200)
    check(f"late: the stroke did not part the body: {hand.stats()['pieces']} pieces", hand.stats()["pieces"] == 2)
    parted = pictures.changed(hand, "whole")
    check(f"late: the parts change {parted:.4f} of the picture", parted > 0.001)
    hand.key(" ")
    hand.wait("live.stats.paused")
    session.done()


def steps():
    session = Session("jello", "--set", "gravity=[0,0,0]")
    session.begin()
    for _ in range(14):
        hand.key("[")
    pictures.keep(hand, "whole")
    # Short strokes in rows on the face that is seen.
    for k in range(24):
        u, v = 0.14 + 0.24 * (k % 4), 0.12 + 0.15 * (k // 4)
        a, b = hand.place([u - 0.08, 0, v]), hand.place([u + 0.08, 0, v])
        hand.drag(along(a, b, steps=3))
        hand.finish()
    made = hand.stats()["undo"]
    check(f"steps: {made} cuts can be undone", made >= 20)
    hand.wait("hand.ghosts.length === 0")
    seen = pictures.changed(hand, "whole")
    check(f"steps: the cuts change {seen:.4f} of the picture", seen > 0.002)
    for k in range(made):
        hand.key("u")
        hand.wait(f"live.stats.undo === {made - 1 - k}")
    hand.wait("live.frame === null")
    again = pictures.changed(hand, "whole")
    check(f"steps: {again:.4f} of the picture is not as before the cuts, which were {seen:.4f}", again < 0.2 * seen)
    check("steps: the body is not whole", hand.run("!surface.walls.visible && surface.walls.empty") and hand.stats()["redo"] == made)
    hand.key("u")
    hand.wait("$('notice').textContent === 'there is no cut to undo'")
    hand.wait("!$('redo').disabled")  # figures are drawn ten times a second
    hand.button("#redo")
    hand.wait(f"live.stats.undo === 1 && live.stats.redo === {made - 1}")
    hand.key("Z", modifiers=2)
    hand.wait("live.stats.undo === 2")
    for k in range(2, made):
        hand.key("U")
        hand.wait(f"live.stats.undo === {k + 1}")
    hand.step()
    session.done()


def touch(kind, *points):
    hand.send("Input.dispatchTouchEvent", type=kind, touchPoints=[dict(x=x, y=y, id=i) for i, (x, y) in points])


def hold():
    session = Session("jello")
    hand.key("g")
    ends = lambda: pictures.count(hand, pictures.ENDS)
    check(f"hold: {ends()} pixels have the colour of a held place before there is one", ends() == 0)
    top = hand.place([0.5, 0.5, 1.0])
    up = [top[0] + 10, top[1] - 70]
    control = 2
    hand.mouse("mouseMoved", *top, button="none")
    hand.mouse("mousePressed", *top, modifiers=control)
    for place in along(top, up, steps=5):
        hand.mouse("mouseMoved", *place, modifiers=control)
        hand.wait("live.frame === null")
    hand.mouse("mouseReleased", *up, modifiers=control)
    hand.wait("live.stats.holds.length === 1 && hand.stroke === null")
    check("hold: the page does not say so", hand.run("$('notice').textContent").startswith("This place stays held"))
    at = hand.run("live.time")
    hand.wait(f"live.time > {at} + 0.3", seconds=200)
    check(f"hold: the spring has {hand.stats()['pull_force']} N", hand.stats()["pull_force"] > 0)
    check(f"hold: {ends()} pixels show the held place and its end", ends() > 15)

    # The same pointer cuts meanwhile.
    hand.key(" ")
    hand.wait("live.stats.paused")
    hand.tool("knife")
    y = hand.place([0.5, 0.5, 0.6])[1]
    hand.wait("hand.ghosts.length === 0")
    pictures.keep(hand, "held")
    hand.drag(along((60, y), (600, y), steps=6))
    hand.finish()
    hand.wait("hand.ghosts.length === 0")
    parted = pictures.changed(hand, "held")
    check(f"hold: the stroke changes {parted:.4f} of the picture, {ends()} pixels show the held place", parted > 0.004 and ends() > 15)
    check(f"hold: while it is held, a stroke cuts not: {hand.stats()}", hand.stats()["undo"] == 1 and hand.run("surface.walls.visible") and len(hand.stats()["holds"]) == 1)

    # Its end is moved, and stays there; a click on it lets go.
    end = lambda: hand.place(hand.stats()["holds"][0]["to"])
    hand.tool("grab")
    before = end()
    hand.drag(along(before, (before[0] + 50, before[1]), steps=5), each=hand.step)
    hand.step()
    check(f"hold: its end went from {before} to {end()}", len(hand.stats()["holds"]) == 1 and abs(end()[0] - before[0] - 50) < 8)
    hand.click(*end())
    hand.step()
    hand.wait("live.stats.holds.length === 0")
    hand.wait("hand.ghosts.length === 0")
    check(f"hold: {ends()} pixels still show what was let go", ends() == 0)

    # A second finger, while the first one grabs.
    hand.key("r")
    hand.wait("live.time === 0")
    hand.send("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=2)
    eye = hand.run("view.azimuth")
    touch("touchStart", (0, top))
    touch("touchMove", (0, up))
    hand.step()
    touch("touchStart", (0, up), (1, [100, 300]))
    touch("touchMove", (0, up), (1, [130, 310]))
    touch("touchEnd", (0, up))
    touch("touchEnd")
    hand.step()
    hand.wait("live.stats.holds.length === 1 && hand.stroke === null")
    check("hold: the second finger turns the view", hand.run("view.azimuth") == eye)
    hand.send("Emulation.setTouchEmulationEnabled", enabled=False)
    session.done()


# Where the picture differs when the skin's triangles are drawn in the opposite order.
REVERSED = """(() => {
  const gl = renderer.getContext(), w = gl.drawingBufferWidth, h = gl.drawingBufferHeight, a = new Uint8Array(4 * w * h), b = a.slice();
  const picture = (into) => (draw(), gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, into));
  picture(a);
  const index = surface.skin.geometry.index, was = index.array.slice();
  for (let i = 0; i < was.length; i += 3) index.array.set(was.subarray(was.length - 3 - i, was.length - i), i);
  index.needsUpdate = true;
  picture(b);
  index.array.set(was), index.needsUpdate = true;
  let different = 0, drawn = 0;
  for (let i = 0; i < a.length; i += 4) { drawn += a[i] > 1.15 * a[i + 2]; different += Math.max(Math.abs(a[i] - b[i]), Math.abs(a[i + 1] - b[i + 1]), Math.abs(a[i + 2] - b[i + 2])) > 24; }
  return [different, drawn]; })()"""
# The largest angle, in degrees, between drawn normals and those of a sphere of rings and meridians that are unevenly far apart.
NORMALS = """(() => {
  const c = new CornerGroups(), rings = [0.12, 0.35, 0.5, 0.9, 1.2, 1.75, 1.95, 2.4, 2.8], meridians = [0, 0.3, 1.0, 1.25, 2.0, 2.9, 3.2, 4.1, 4.4, 5.3, 5.9], m = meridians.length, at = [];
  for (const t of rings) for (const f of meridians) at.push(Math.sin(t) * Math.cos(f), Math.sin(t) * Math.sin(f), Math.cos(t));
  const faces = [];
  for (let i = 0; i + 1 < rings.length; i++) for (let j = 0; j < m; j++) { const a = i * m + j, b = i * m + (j + 1) % m; faces.push([a, a + m, b], [b, a + m, b + m]); }
  c.reserve(at.length / 3, faces.length);
  faces.forEach(([a, b, d], s) => c.put(s, a, b, d, 0));
  c.regroup(at);
  const position = new Float32Array(3 * c.groups), normal = new Float32Array(3 * c.groups);
  c.place(at, position, normal);
  let sum = 0, count = 0;
  for (let g = 0; g < c.groups; g++) {
    const v = c.groupVertex[g];
    if (v < m || v >= at.length / 3 - m) continue;
    sum += Math.acos(Math.min(1, [0, 1, 2].reduce((s, k) => s + position[3 * g + k] * normal[3 * g + k], 0))) * 180 / Math.PI, count++;
  }
  return sum / count; })()"""


def look():
    session = Session("polyp")
    session.begin()
    hand.drag(along(hand.place([-1.0, 0.3, 0.02]), hand.place([0.05, 0, 0.02]), steps=12))
    hand.finish()
    hand.run("set('skin', 0.7); view.azimuth -= 1; view.distance *= 0.7; draw()")
    hand.wait("hand.ghosts.length === 0")  # they fade between two pictures
    different, drawn = hand.run(REVERSED)
    check(f"look: {different} of {drawn} pixels depend on the order of triangles", drawn > 3000 and different < 0.003 * drawn)
    hand.run("set('skin', 1)")
    hand.drag(along(hand.place([-1.0, 0.3, 0.02]), hand.place([1.0, -0.3, 0.02]), steps=12))
    hand.finish()
    hand.key(" ")
    hand.wait("live.time > 1.2", seconds=200)
    hand.key(" ")
    hand.wait("live.stats.paused")
    # The light stands on the walls, and is half as strong again.
    hand.run("view.elevation = 1.5; world.sun.intensity *= 1.5; lamp.intensity *= 1.5; sky.intensity *= 1.5; draw()")
    white, pale = pictures.count(hand, "r > 253 && b < 0.97 * r"), pictures.count(hand, "r > 170 && b > 0.5 * r && r > 1.08 * b")
    check(f"look: {white} of {pale} pixels of walls are clipped", pale > 500 and white < 0.01 * pale)
    off = hand.run(NORMALS)
    check(f"look: normals are {off} degrees off on average", off < 9)
    session.done()


def pale(name):
    """What has no program is pale, and words that say so are over it: in the picture of the page, compared with `name`."""
    words, body = pictures.page_changed(hand, name, "#wait"), pictures.page_changed(hand, name, "#canvas")
    check(f"gone: {words:.2f} of the words' place and {body:.2f} of the picture differ", words > 0.1 and body > 0.06)


def gone():
    session = model("polyp")
    pictures.keep_page(hand, "live")
    check("gone: exit code", session.program.stop() == 0)
    hand.wait("$('wait').textContent.startsWith('kerf-live has ended')")
    time.sleep(1.5)
    pale("live")
    check("gone: the page tries again", hand.run("$('wait').textContent").startswith("kerf-live has ended") and not hand.run("$('wait').hidden"))

    session = model("polyp")
    pictures.keep_page(hand, "live")
    session.program.process.kill()
    session.program.process.wait()
    hand.wait("$('wait').textContent.startsWith('No connection')")
    hand.wait("$('wait').textContent.startsWith('kerf-live does not answer')", seconds=40)
    pale("live")

    session = model("polyp", "--linger", "1")
    middle = [(a + b) / 2 for a, b in zip(*hand.run("live.told.box"))]
    x, y = hand.place(middle)
    hand.drag(along((x - 200, y), (x + 220, y), steps=12))
    hand.wait("live.stats.undo === 1 && live.stats.waiting.length === 0", seconds=200)
    hand.open("about:blank")
    check("gone: exit code after --linger", session.program.process.wait(60) == 0)
    time.sleep(0.2)  # its last lines are read by a thread
    said = "".join(session.program.said)
    check(f"gone: it says {said}", "no page for 1 s (--linger), so it ends" in said and "recorded in polyp-recorded.toml" in said)
    kerf("kerf-sim", "-q", "polyp-recorded.toml", "-o", "kept")
    check("gone: no frames of the kept work", len(glob.glob("kept/frames/*.ply")) > 5)
    hand.errors.clear()


def drop():
    with open("box.mtl", "w") as file:
        file.write("newmtl red\nKd 1 0 0\n")
    corners = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    sides = [(1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6)]
    with open("box.obj", "w") as file:
        file.write("mtllib box.mtl\n" + "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "usemtl red\n" + "".join(f"f {' '.join(map(str, s))}\n" for s in sides))
    with open("open.off", "w") as file:
        file.write("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    with open("scene.toml", "w") as file:
        file.write("")
    session = model("polyp")
    x, y = hand.place([0, 0, 0])
    hand.drag(along((x - 200, y), (x + 220, y), steps=12))
    hand.wait("live.stats.undo === 1", seconds=200)

    hand.drop_files("scene.toml")
    hand.wait("$('notice').textContent.startsWith('scene.toml cannot be opened here')")
    hand.drop_files("open.off")
    hand.wait("$('notice').textContent.startsWith('open.off: ')")
    check("drop: what could not be opened is shown", hand.run("$('title').textContent") == "polyp" and hand.stats()["undo"] == 1)
    hand.drop_files("box.obj", "box.mtl")
    hand.wait("$('title').textContent === 'box' && live.time === 0 && live.stats.undo === 0", seconds=120)
    hand.wait("surface.painted !== null")
    red = pictures.count(hand, "r > 2 * g && r > 2 * b && r > 60")
    check(f"drop: {red} pixels are red", red > 2000)
    check("drop: the new body is not the box, or its skin is coarse", hand.run("surface.corners.slots") > 200 and hand.run("$('wait').hidden"))
    sides = [hand.place([a, 0.5, 0.5])[0] for a in (0, 1)]
    check(f"drop: the box is not in view: {sides}", all(0 < s < 640 for s in sides) and abs(sides[0] - sides[1]) > 80)
    x, y = hand.place([0.5, 0.5, 0.5])
    hand.drag(along((x - 220, y), (x + 220, y), steps=12))
    hand.wait("live.stats.undo === 1 && live.stats.pieces === 2 && live.stats.waiting.length === 0", seconds=200)
    hand.reload()
    check("drop: a page that is loaded again shows another body", hand.run("$('title').textContent") == "box" and hand.stats()["pieces"] == 2)
    hand.errors[:] = [line for line in hand.errors if "422" not in line]  # the refusal, as the browser sees it
    check(f"drop: the console has {hand.errors}", not hand.errors)
    check("drop: exit code", session.program.stop() == 0)


def keys():
    # By the keyboard alone.
    session = model("polyp")
    hand.key("Enter")
    check("keys: no cross", not hand.run("$('cursor').hidden"))
    for _ in range(25):
        hand.key("ArrowLeft")
    hand.key("Enter")
    for _ in range(55):
        hand.key("ArrowRight")
    check("keys: no stroke", hand.run("hand.stroke !== null && hand.trail.length > 40"))
    hand.key("Enter")
    hand.wait("live.stats.undo === 1 && live.stats.pieces === 2 && live.stats.waiting.length === 0", seconds=200)
    eye = hand.run("view.azimuth")
    hand.key("Escape")
    hand.key("ArrowLeft")
    check("keys: after Escape the arrows turn the view", hand.run("$('cursor').hidden") and hand.run("view.azimuth") != eye)

    # A link of the panel does not keep the space bar.
    hand.button("#menu")
    hand.send("Browser.setDownloadBehavior", behavior="deny")
    hand.run("document.querySelector('a.button').scrollIntoView({ block: 'center' })")
    hand.button("a.button[href='save?as=toml']")
    hand.key(" ")
    hand.wait("live.stats.paused")

    # No value is under the button of the menu, wherever the panel is scrolled.
    covered = hand.run("""(() => {
      const m = $("menu").getBoundingClientRect(), found = [];
      for (let at = 0; at < $("panel").scrollHeight; at += 7) {
        $("panel").scrollTop = at;
        for (const e of document.querySelectorAll("#panel output, #panel input, #panel select, #panel kbd")) {
          const r = e.getBoundingClientRect(), x = (Math.max(r.left, m.left) + Math.min(r.right, m.right)) / 2, y = (Math.max(r.top, m.top) + Math.min(r.bottom, m.bottom)) / 2;
          const crosses = r.width > 0 && r.left < m.right && r.right > m.left && r.top < m.bottom && r.bottom > m.top;
          if (crosses && !document.elementsFromPoint(x, y).slice(0, 2).includes($("title"))) found.push(e.id);
        }
      }
      return found; })()""")
    check(f"keys: the menu's button covers {covered}", not covered)
    hand.button("#menu")

    # Bodies are not drawn under the tools, on a phone and on a desktop.
    for width, height in ((375, 700), (1200, 760)):
        hand.send("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=0.5, mobile=False)
        hand.wait(f"window.innerWidth === {width}")
        below = hand.run("[$('canvas').getBoundingClientRect().bottom, $('tools').getBoundingClientRect().top, $('tools').scrollWidth - $('tools').clientWidth]")
        check(f"keys: at {width} pixels the tools are over the picture: {below}", below[0] <= below[1] + 0.5 and below[2] <= 0)
    # On a phone the controls cover neither the picture nor the tools, however it is held.
    for width, height in ((390, 844), (360, 640), (640, 360)):
        hand.send("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=0.5, mobile=False)
        hand.wait(f"window.innerWidth === {width}")
        hand.button("#menu")
        hand.wait("!document.body.classList.contains('wide')")
        left, top, right, bottom = range(4)
        picture, panel, bar = places = [hand.run(f"(() => {{ const r = $('{id}').getBoundingClientRect(); return [r.left, r.top, r.right, r.bottom]; }})()") for id in ("canvas", "panel", "tools")]
        apart = lambda a, b: a[right] <= b[left] + 0.5 or a[bottom] <= b[top] + 0.5
        check(f"keys: at {width} by {height} pixels picture, panel and tools are at {places}",
              apart(picture, panel) and apart(picture, bar) and (apart(panel, bar) or apart(bar, panel)) and bar[bottom] <= height and panel[bottom] <= height)
        check(f"keys: at {width} by {height} pixels picture and panel are at {places[:2]}, which is little", all(r[bottom] - r[top] > 200 and r[right] - r[left] > 240 for r in places[:2]))
        hand.tool("knife")
        check(f"keys: at {width} pixels a tool is not reached beside the panel", hand.run("state.tool === 'knife'"))
        at = hand.run(MIDDLE)
        check(f"keys: at {width} pixels the body is seen at {at}", max(map(abs, at[:2])) < 0.3 and at[2] < 1.2)
        hand.tool("orbit")
        hand.button("#menu")
    check("keys: the page cannot be enlarged", "maximum-scale" not in hand.run("document.querySelector('meta[name=viewport]').content"))
    # The look of the night.
    light = pictures.count(hand, "r + g + b > 600")
    hand.run("window.background = scene.background, 1")
    hand.send("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
    hand.wait("scene.background !== window.background", seconds=10)  # to ask for darkness.matches would take the event away from the page
    dark = pictures.count(hand, "r + g + b > 600")
    text = hand.run("getComputedStyle($('panel')).backgroundColor + getComputedStyle($('tools')).backgroundColor")
    check(f"keys: {light} bright pixels became {dark}, panels are {text}", light > 20000 and dark < 0.1 * light and "248" not in text)
    hand.send("Emulation.setEmulatedMedia", features=[])
    hand.send("Emulation.setDeviceMetricsOverride", width=640, height=560, deviceScaleFactor=0.5, mobile=False)
    session.done()

    # Friction of the ground and of the bodies, and warnings under the program's own name.
    session = Session("polyp", "--set", "body.scale=200")
    hand.wait("$('friction-value').textContent !== ''")
    shown = hand.run("$('friction-value').textContent")
    check(f"keys: friction is shown as {shown}", shown == "0–0.5")
    said = "".join(session.program.said)
    check(f"keys: it says {said}", "kerf-live: no node is in the box" in said and "kerf-sim" not in said)
    check("keys: exit code", session.program.stop() == 0)


def begin():
    # Without a model the page begins with the choice of bodies; an apple is behind it.
    program = Program(os.path.join(tools, "kerf-live"))
    hand.errors.clear()
    hand.visit(program.address + "#bodies=true")
    check("begin: no choice of bodies", hand.run("$('bodies').open && live.told.name === 'apple' && state.look === 'apple'"))
    hand.key("Tab")
    hand.button('[data-body="stone"]')
    hand.wait("live.told.name === 'stone' && live.frame === null")
    hand.reload()
    check("begin: a page that is loaded again asks once more", hand.run("!$('bodies').open && live.told.name === 'stone'"))
    program.save("model", "stone.ply")
    check("begin: the body has no model", os.path.getsize("stone.ply") > 1000)
    named = {}
    for kind in ("model", "kerf", "ply", "glb", "stl", "toml"):
        with urllib.request.urlopen(f"{program.address}save?as={kind}", timeout=120) as answer:
            named[kind] = answer.headers["Content-Disposition"].split('"')[1]
    check(f"begin: saved files are named {named}", named["model"] == "stone.ply" and named["toml"] == "stone.toml" and len(set(named.values())) == 6)
    check(f"begin: the console has {hand.errors}", not hand.errors)
    check("begin: exit code", program.stop() == 0)
    empty = subprocess.run([os.path.join(tools, "kerf-live"), "--no-browser", ""], capture_output=True, text=True, timeout=60)
    check(f"begin: an empty name is taken for none: {empty}", empty.returncode != 0 and empty.stdout == "")


MIDDLE = "(() => { placeCamera(); const p = bodySphere().middle.project(camera); return [p.x, p.y, bodySphere().radius * camera.projectionMatrix.elements[5] / view.distance]; })()"


def guide():
    # Each act has an answer, and nobody loses the body or the help.
    session = model("polyp")
    noticed = lambda: hand.run("$('notice').hidden ? '' : $('notice').textContent")
    hint = lambda: hand.run("$('hint').textContent")
    x, y = hand.place([(a + b) / 2 for a, b in zip(*hand.run("live.told.box"))])
    hand.click(x, y)
    check(f"guide: a click of the knife has the answer '{noticed()}'", noticed().startswith("A click does not cut. Drag across"))
    for tool in ("clamp", "pin", "break"):
        hand.run("$('notice').hidden = true")
        hand.tool(tool)
        hand.click(20, 300)
        check(f"guide: a click of the {tool} beside the body has the answer '{noticed()}'", noticed() == "That is beside the body: click on it.")
    hand.tool("clamp")
    hand.click(x, y)
    check(f"guide: after the first place the clamp says '{hint()}'", hint().startswith("Click the place that it is to be drawn to"))
    hand.tool("pin")
    hand.tool("clamp")
    check(f"guide: the first place of a clamp outlives the tool: '{hint()}'", hand.run("clamp.first === null") and hint().startswith("Click two places"))
    hand.click(x, y), hand.click(x, y + 12)
    check(f"guide: the clamp says '{noticed()}', '{hint()}'", noticed().startswith("Both places are drawn together") and hint().startswith("Click two places"))

    # A body that is out of the picture is found; help is read from its begin.
    hand.run("view.target.x += 6, redraw()")
    hand.wait("!$('find').hidden")
    hand.button("#find")
    hand.wait("$('find').hidden")
    at = hand.run(MIDDLE)
    check(f"guide: the body is shown at {at}", max(map(abs, at[:2])) < 0.2)
    hand.send("Emulation.setDeviceMetricsOverride", width=390, height=700, deviceScaleFactor=1, mobile=False)
    hand.wait("window.innerWidth === 390")
    if hand.run("!document.body.classList.contains('wide')"):
        hand.key("m")
    hand.button("#help-button")
    hand.wait("$('help').open")
    top, close = hand.run("[document.querySelector('#help h2').getBoundingClientRect().top, document.querySelector('#help button').getBoundingClientRect().bottom]")
    check(f"guide: help begins at {top}, and is closed at {close}", top > 0 and close < 700)
    hand.button("#help button")
    hand.wait("!$('help').open")
    hand.send("Emulation.setDeviceMetricsOverride", width=640, height=560, deviceScaleFactor=0.5, mobile=False)
    hand.wait("window.innerWidth === 640")

    # Another body is in the middle, whatever the one before did; its file may be chosen by a button.
    at = hand.run("live.time")
    hand.wait(f"live.time > {at} + 0.3", seconds=200)
    hand.key(" ")
    hand.wait("live.stats.paused && live.frame === null", seconds=20)  # the space bar is not the Help button's, which was clicked
    hand.run("surface.arrive(), live.position.fill(9), 1")  # as of a body that has flown away
    chosen = hand.send("Runtime.evaluate", expression="$('file')")["result"]["objectId"]
    with open(f"{models}/polyp.ply", "rb") as file, open("other.ply", "wb") as copy:
        copy.write(file.read())
    hand.key("i")
    check("guide: no button opens a model", hand.run("$('open').getBoundingClientRect().width > 40 && $('open').getBoundingClientRect().bottom < 560"))
    hand.send("DOM.setFileInputFiles", files=[os.path.abspath("other.ply")], objectId=chosen)
    hand.wait("live.told.name === 'other' && live.frame === null && $('wait').hidden && !$('bodies').open", seconds=120)
    at = hand.run(MIDDLE)
    check(f"guide: the new body is seen at {at}", max(map(abs, at[:2])) < 0.2 and 0.5 < at[2] < 1.5)
    check(f"guide: the console has {hand.errors}", not hand.errors)
    check("guide: exit code", session.program.stop() == 0)


run(globals())
