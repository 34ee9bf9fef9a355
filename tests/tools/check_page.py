"""check_page.py FOLDER: the pages in it, in a browser, as somebody would use them: run.html (a run), body.html (a body, its
state before and a front), pieces.html (a surface in two pieces), nodes.html (nodes alone), coarse.html and coarse-run.html (made small),
or, where there is one, only pumpkin.html (a large run). Prints what fails; exit code 1."""
import os, sys
from browser import Browser

failures = []


def check(what, good):
    if not good:
        failures.append(what)
        print("FAILED:", what)


class Page:
    def __init__(self, browser, path):
        self.b, self.name = browser, os.path.basename(path)
        browser.errors.clear(), browser.requests.clear()
        browser.open(path)
        browser.run("""new Promise((done, failed) => { const wait = (tries) => document.getElementById("wait").hidden ? done(1)
          : tries ? setTimeout(wait, 50, tries - 1) : failed(document.getElementById("wait").textContent); wait(1200); })""")
        lit = self.lit()
        check(f"{self.name}: {lit} of the canvas is drawn on", 0.02 < lit < 0.98)

    # A number for what is drawn now, and the share of pixels that are not background.
    def picture(self):
        return self.b.run("""(() => { draw(); const gl = renderer.getContext(), w = gl.drawingBufferWidth, h = gl.drawingBufferHeight, p = new Uint8Array(4 * w * h);
          gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, p); let sum = 2166136261; for (const x of p) sum = Math.imul(sum ^ x, 16777619); return sum; })()""")

    def lit(self):
        return self.b.run("""(() => { draw(); const gl = renderer.getContext(), w = gl.drawingBufferWidth, h = gl.drawingBufferHeight, p = new Uint8Array(4 * w * h);
          gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, p); let n = 0; for (let i = 0; i < p.length; i += 4) n += p[i] !== 0xe4 || p[i + 1] !== 0xe9 || p[i + 2] !== 0xef; return n / (w * h); })()""")

    def place(self, id, along=0.5):
        x, y, w, h = self.b.run(f"""(() => {{ const e = document.getElementById("{id}"); e.scrollIntoView({{ block: "center" }}); const r = e.getBoundingClientRect(); return [r.x, r.y, r.width, r.height]; }})()""")
        check(f"{self.name}: {id} is not shown", w > 0 and h > 0)
        return x + along * w, y + h / 2

    def click(self, id, along=0.5):
        self.b.click(*self.place(id, along))

    def state(self, key):
        return self.b.run("state." + key)

    # What changes the picture, and changes it back where `back` is given.
    def changes(self, what, act, back=None):
        before = self.picture()
        act()
        check(f"{self.name}: {what} changes nothing", self.picture() != before)
        if back:
            back()
            check(f"{self.name}: {what} is not undone", self.picture() == before)

    def toggles(self, id):
        self.changes(id, lambda: self.click(id), lambda: self.click(id))

    def key(self, key, **more):
        self.b.run("document.activeElement.blur()")
        self.b.key(key, **more)

    def done(self):
        check(f"{self.name}: {self.b.errors}", not self.b.errors)
        # Its own file, and pictures within it.
        others = [url for url in self.b.requests[1:] if not url.startswith(("data:", "blob:"))]
        check(f"{self.name}: it asks for {others}", not others)


def choose(page, id, value):
    page.b.run(f'document.getElementById("{id}").focus()')
    page.b.key("Home")
    for _ in range(12):
        if page.b.run(f'document.getElementById("{id}").value') == value:
            return
        page.b.key("ArrowDown")
    check(f"{page.name}: {id} cannot be set to {value}", False)


def body(page):
    b = page.b
    for id in ("wire", "nodes", "tree", "fronts"):
        page.toggles(id)
    page.changes("skin", lambda: page.click("skin", 0.3))
    page.toggles("cracks"), page.toggles("edges"), page.toggles("cut")
    page.key("s"), page.key("s")
    check(f"{page.name}: skin is {page.state('skin')}", page.state("skin") == 1)
    page.changes("pieces' colours", lambda: choose(page, "color", "piece"))
    for axis in ("0", "3", "6"):
        choose(page, "axis", axis)
        page.changes(f"cutting away along {axis}", lambda: page.click("clip"))
        if axis == "3":
            page.changes("depth", lambda: page.click("offset", 0.6))
            page.toggles("fill")
        page.click("clip")
    # A click on a node: selects it, its neighbours and its tree are drawn, and it is described.
    page.click("nodes"), page.click("skin", 0.3)
    x, y, picked = b.run("""(() => { draw(); const p = nodePositions(), c = $("canvas");
      for (let i = 0; i < about.nodes.count; i++) { const v = new THREE.Vector3().fromArray(p, 3 * i).project(camera), x = (v.x + 1) / 2 * c.clientWidth, y = (1 - v.y) / 2 * c.clientHeight;
        if (nodeAt(x, y) === i && arrays["tree/node"].includes(i + 1)) return [x, y, i]; } })()""")
    page.changes("a click on a node", lambda: b.click(x, y))
    check(f"{page.name}: node {page.state('selected')} is selected, not {picked}", page.state("selected") == picked)
    facts = b.run('document.getElementById("facts").textContent')
    check(f"{page.name}: {facts}", "radius" in facts and "edges cut" in facts and "masters" in facts)
    page.toggles("near"), page.toggles("own"), page.toggles("updated")
    page.changes("size", lambda: page.click("size", 0.9))
    page.changes("field", lambda: choose(page, "field", "neighbors"))
    legend = b.run('document.getElementById("legend").textContent')
    check(f"{page.name}: the legend says {legend}", "neighbors" in legend)
    page.changes("typing a node's number", lambda: (page.click("pick"), b.run('document.getElementById("pick").select()'), b.key("7")))
    check(f"{page.name}: the typed node is not selected", page.state("selected") == 7)
    page.changes("Escape", lambda: page.key("Escape"))
    check(f"{page.name}: Escape selects nothing", page.state("selected") == -1)
    # Neighbours over paths are those that the library says: behind a face, farther than as the crow flies.
    check(f"{page.name}: paths shorter than straight lines", b.run("""(() => { const r = arrays["nodes/rest"]; let bad = 0, behind = 0;
      rows.forEach((row, i) => row.forEach((e) => { const d = Math.hypot(r[3*i]-r[3*e.to], r[3*i+1]-r[3*e.to+1], r[3*i+2]-r[3*e.to+2]);
        if (isBehind(e.bits)) behind++, bad += e.distance < d - 1e-3; else bad += isNeighbor(e.bits) && Math.abs(e.distance - d) > 1e-3; })); return bad === 0 && behind > 0; })()"""))
    # Pointer and keys turn, zoom and move.
    canvas = page.place("canvas")
    page.changes("dragging", lambda: (b.mouse("mousePressed", *canvas), b.mouse("mouseMoved", canvas[0] + 80, canvas[1] + 20), b.mouse("mouseReleased", canvas[0] + 80, canvas[1] + 20)))
    page.changes("the wheel", lambda: b.mouse("mouseWheel", *canvas, deltaX=0, deltaY=-120))
    for key in ("ArrowLeft", "ArrowUp", "+", "-"):
        page.changes("key " + key, lambda: page.key(key))
    page.changes("shift and arrow", lambda: page.key("ArrowLeft", modifiers=8))
    page.changes("Reset view", lambda: page.click("home"))
    for key in "uswcnedtp":
        page.changes("key " + key, lambda: page.key(key))
    page.click("keys")
    check(f"{page.name}: no help", b.run('document.getElementById("help").open'))
    page.b.key("Escape")
    check(f"{page.name}: the help stays", not b.run('document.getElementById("help").open'))
    width = b.run("$('canvas').clientWidth")
    page.click("menu")
    check(f"{page.name}: the controls stay", b.run("new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(() => r($('canvas').clientWidth))))") > width)
    page.click("menu")
    # Every control can be come to by Tab, and has a name.
    names = b.run("""[...document.querySelectorAll("input, select, button")].filter((e) => e.offsetParent && !(e.labels?.[0]?.textContent || e.textContent || e.getAttribute("aria-label")).trim()).map((e) => e.id)""")
    check(f"{page.name}: controls without a name: {names}", not names)


def run(page):
    b = page.b
    last = b.run("frameCount() - 1")
    check(f"{page.name}: {last} frames", last >= 3)
    page.changes("the last frame", lambda: page.click("frame", 0.995))
    check(f"{page.name}: frame {page.state('frame')} of {last}", page.state("frame") == last)
    page.changes("the frame before", lambda: page.key(","), lambda: page.key("."))
    if not b.run('$("obstacles-label").hidden'):
        page.toggles("obstacles")
        page.changes("key k", lambda: page.key("k"), lambda: page.key("k"))
        # A ball of radius 0.3 is drawn in every frame, where the scene has it.
        check(f"{page.name}: the obstacle is not where it should be", b.run("""(() => { const far = about.obstacles.map((name) => { let z = -9; const p = arrays[name]; for (let i = 2; i < p.length; i += 3) z = Math.max(z, p[i]); return z * about.unit; });
          return far.length === about.surfaces.length - 1 && far.every((z, i) => i === 0 || z < far[i - 1]) && Math.abs(far[0] - far[far.length - 1] - 0.2) < 1e-3; })()"""))
    else:
        check(f"{page.name}: its obstacle is missing", page.name == "pumpkin.html")
    page.changes("nodes at the last frame", lambda: page.click("nodes"))
    page.changes("stress", lambda: choose(page, "field", "stress"))
    legend = b.run('$("legend").textContent')
    check(f"{page.name}: the legend says {legend}", "Pa" in legend)
    page.changes("strain", lambda: choose(page, "field", "strain"))
    # Nodes are in the surface of each frame, coloured by its stress; every frame is another picture.
    choose(page, "field", "stress")
    pictures, outside, stresses = set(), 0, set()
    for frame in range(last + 1):
        b.run(f"showFrame({frame})")
        pictures.add(page.picture())
        outside += b.run("""(() => { const p = nodePositions(), s = arrays[about.surfaces[state.frame].position], lo = [9, 9, 9], hi = [-9, -9, -9];
          for (let i = 0; i < s.length; i++) lo[i % 3] = Math.min(lo[i % 3], s[i]), hi[i % 3] = Math.max(hi[i % 3], s[i]);
          let out = 0; for (let i = 0; i < p.length; i++) out += !(p[i] > lo[i % 3] - 0.02 && p[i] < hi[i % 3] + 0.02); return out; })()""")
        stresses.add(b.run('fieldValues("stress").reduce((a, x) => a + x, 0)'))
    check(f"{page.name}: {len(pictures)} pictures of {last + 1} frames", len(pictures) == last + 1)
    check(f"{page.name}: {outside} coordinates of nodes are outside", outside == 0)
    check(f"{page.name}: stress is the same in all frames", len(stresses) > last / 2)
    page.click("frame", 0.005)
    b.run('set("skin", 0.25)')
    for id in ("edges", "cut") if b.run("about.nodes.graph") else ():
        page.changes(id + " at the first frame", lambda: page.click(id), lambda: page.click(id))
    if b.run("about.nodes.graph"):
        page.changes("a node of the first frame", lambda: b.run("select(7)"), lambda: b.run("select(-1)"))
    b.run('set("skin", 1)')
    page.click("frame", 0.995)
    if not b.run('$("explode-label").hidden'):
        page.changes("explode", lambda: page.click("explode", 0.6), lambda: page.click("explode", 0.005))
    page.changes("at rest", lambda: page.click("rest"), lambda: page.click("rest"))
    page.click("frame", 0.005)
    page.key(" ")
    b.run("new Promise((done) => { const wait = (tries) => state.playing && tries ? setTimeout(wait, 50, tries - 1) : done(1); wait(400); })")
    check(f"{page.name}: playing ends at {page.state('frame')}", page.state("frame") == last and not page.state("playing"))
    check(f"{page.name}: the button still says pause", b.run('$("play").textContent') == "▶")


# The two images of base colours, which are repeated and moved, and the cracks' own material.
def painted(page):
    counts = page.b.run("""(() => { draw(); const gl = renderer.getContext(), w = gl.drawingBufferWidth, h = gl.drawingBufferHeight, p = new Uint8Array(4 * w * h);
      gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, p); let orange = 0, blue = 0, edges = 0;
      for (let i = 0; i < p.length; i += 4) { const o = p[i] > 2 * p[i + 2], b = p[i + 2] > 1.7 * p[i]; orange += o, blue += b, edges += o && p[i + 6] > 1.2 * p[i + 4]; }
      return [images.length, orange, blue, edges]; })()""")
    check(f"{page.name}: {counts}", counts[0] == 2 and counts[1] > 5000 and counts[2] > 5000 and counts[3] > 300)
    check(f"{page.name}: is not in the model's colours", page.state("color") == "model")
    page.changes("skin and sheets", lambda: choose(page, "color", "patch"), lambda: page.b.run('set("color", "model")'))
    page.changes("explode", lambda: page.click("explode", 0.6), lambda: page.click("explode", 0.005))
    page.changes("skin", lambda: page.click("skin", 0.3))
    page.changes("triangles", lambda: page.click("wire"))
    page.click("clip")


browser = Browser(900, 620)
try:
    folder = sys.argv[1]
    if os.path.exists(os.path.join(folder, "pumpkin.html")):
        page = Page(browser, os.path.join(folder, "pumpkin.html"))
        run(page), page.done()
        sys.exit(bool(failures))
    page = Page(browser, os.path.join(folder, "body.html"))
    body(page), page.done()
    page = Page(browser, os.path.join(folder, "run.html"))
    run(page), page.done()
    page = Page(browser, os.path.join(folder, "pieces.html"))
    page.changes("explode", lambda: page.click("explode", 0.6), lambda: page.click("explode", 0.005))
    page.changes("key x", lambda: page.key("x"))
    page.done()
    page = Page(browser, os.path.join(folder, "painted.html"))
    painted(page), page.done()
    page = Page(browser, os.path.join(folder, "bare.html"))
    check("bare.html: has materials", page.state("color") == "patch" and browser.run('[...$("color").options].every((o) => o.value !== "model") && images.length === 0'))
    page.done()
    page = Page(browser, os.path.join(folder, "body.html#nodes=true&skin=0.25&selected=7&field=neighbors&azimuth=1"))
    check(f"{page.name}: the address is not followed", page.state("nodes") and page.state("skin") == 0.25 and page.state("selected") == 7 and browser.run("view.azimuth") == 1)
    page.done()
    page = Page(browser, os.path.join(folder, "nodes.html"))
    check("nodes.html: a surface's controls are shown", browser.run('document.getElementById("surface-controls").hidden'))
    check("nodes.html: its y is not up", browser.run("eyePosition(), camera.up.y === 1 && camera.position.y > 0"))
    page.done()
    page = Page(browser, os.path.join(folder, "coarse.html"))
    notices = browser.run('document.getElementById("notices").innerText')
    check(f"coarse.html says {notices!r}", "decimated" in notices)
    page.done()
    page = Page(browser, os.path.join(folder, "coarse-run.html"))
    notices = browser.run('document.getElementById("notices").innerText')
    check(f"coarse-run.html says {notices!r}", "decimated" in notices and "Obstacles decimated" in notices and "One node in" in notices)
    run(page), page.done()
finally:
    browser.close()
sys.exit(bool(failures))
