"""live.py [--rates BUILD_DIR] LIVE_DIR: the live page without a server (js/build), in a browser, used by real pointer and touch events.

The bear is cut by one drag, undone, cut three times, broken, saved. With KERF_TOOLS, a folder with kerf-sim, the saved scene is run
there. A GLB is dropped, cut and broken, on a phone's screen by a finger.
An OBJ has the colours of the MTL and image that are dropped with it. The console has no error, and after the page is loaded nothing asks any host for anything.
--rates: only how many frames of simulation a second the polyp and the bear of 800 nodes have, before and after a cut.
"""
import base64, functools, glob, http.server, json, os, shutil, struct, subprocess, sys, tempfile, threading, time

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "live"))
from hand import Hand, along
from pictures import count, png

rates = os.path.abspath(sys.argv[2]) if sys.argv[1] == "--rates" else None
folder, failures, served = os.path.abspath(sys.argv[-1]), [], []


def check(what, good):
    if not good:
        failures.append(what)
        print("FAILED:", what, flush=True)


class Files(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *arguments):
        served.append(self.path)


server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Files, directory=folder))
threading.Thread(target=server.serve_forever, daemon=True).start()
address = f"http://127.0.0.1:{server.server_port}/"


class Tab(Hand):
    """A hand at a page whose program runs in a worker of the tab."""

    def wait(self, condition, seconds=60):
        """Until an expression of the page is true, for so many seconds of the worker's processor: they do not count while the machine
        stands still, or others use it. A worker that does nothing is waited for two minutes."""
        before, used, worked = worker_seconds(self), 0, time.monotonic()
        while not self.run(f"Boolean({condition})"):
            now = worker_seconds(self) - before
            if now > used:
                used, worked = now, time.monotonic()
            assert used < seconds and time.monotonic() < worked + 120, \
                f"not after {used:.0f} s of the worker: {condition}; {self.run('JSON.stringify(live.stats) + $(`notice`).textContent')}"
            time.sleep(0.05)

    def press(self, id):
        """A click on a button, which the page may have to enable first: a click before it is lost."""
        self.wait(f"!document.querySelector({id!r}).disabled")
        self.button(id)


def middle(hand):
    """Where the middle of the body is on the screen."""
    return hand.place([(a + b) / 2 for a, b in zip(*hand.run("live.told.box"))])


def cut(hand, strokes, reach=250, slope=10, shift=0):
    """One drag across the body; the number of pieces after it."""
    hand.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")  # the view has moved
    x, y = middle(hand)
    hand.drag(along((x - reach, y + shift), (x + reach, y + shift + slope), steps=12))
    hand.wait(f"live.stats.undo === {strokes} && live.stats.waiting.length === 0", seconds=300)
    return hand.stats()["pieces"]


def press_save(hand, format):
    """Opens the panel, presses the link, closes the panel."""
    link = f"a[href='save?as={format}']"
    hand.button("#menu")
    hand.run(f'document.querySelector("{link}").scrollIntoView({{ block: "center" }})')
    hand.button(link)
    hand.button("#menu")


def saved(hand, format):
    """Bytes that a click on the link saves."""
    hand.run("""window.blob = null, window.address ??= URL.createObjectURL;
      URL.createObjectURL = (blob) => { window.blob = blob, URL.createObjectURL = window.address; return 'data:,'; }""")
    press_save(hand, format)
    hand.wait("window.blob !== null")
    return base64.b64decode(hand.run("""window.blob.arrayBuffer().then((buffer) => {
      let text = ""; for (const byte of new Uint8Array(buffer)) text += String.fromCharCode(byte); return btoa(text); })"""))


def check_saved(hand):
    """What the page saves of a bear in pieces, by the formats' own numbers."""
    pieces, triangles = hand.stats()["pieces"], hand.run("surface.corners.kind.subarray(0, surface.corners.slots).filter((kind) => kind !== noKind).length")
    glb = saved(hand, "glb")
    length, = struct.unpack_from("<I", glb, 12)
    nodes = [node for node in json.loads(glb[20:20 + length])["nodes"] if "mesh" in node]
    check(f"the .glb has {len(nodes)} meshes of {pieces} pieces", glb[:4] == b"glTF" and len(nodes) >= pieces)
    stl = saved(hand, "stl")
    check(f"the .stl has {len(stl)} bytes of {triangles} triangles", len(stl) == 84 + 50 * triangles and struct.unpack_from("<I", stl, 80)[0] == triangles)
    check("no .ply", saved(hand, "ply").startswith(b"ply\n"))
    check("no .kerf", len(saved(hand, "kerf")) > 10000)
    scene = saved(hand, "toml").decode()
    check(f"the scene has {scene.count('[[blade]]')} blades", scene.count("[[blade]]") == hand.stats()["undo"] and "[body]" in scene)


def box_glb(n=8):
    """A box of 1 × 2 × 1, whose y axis is vertical, as a .glb; each side of n × n squares."""
    place, triangles = {}, []
    for axis in range(3):
        for side in (0, n):
            def corner(i, j):
                at = [i, j]
                at.insert(axis, side)
                return place.setdefault(tuple(at), len(place))
            for i in range(n):
                for j in range(n):
                    a, b, c, d = corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)
                    outwards = (side == n) == (axis != 1)
                    triangles += [a, b, c, a, c, d] if outwards else [a, c, b, a, d, c]
    data = b"".join(struct.pack("<3f", x / n, 2 * y / n, z / n) for x, y, z in place)
    index = struct.pack(f"<{len(triangles)}H", *triangles)
    text = json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "buffers": [{"byteLength": len(data + index)}],
        "bufferViews": [{"buffer": 0, "byteLength": len(data)}, {"buffer": 0, "byteOffset": len(data), "byteLength": len(index)}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(place), "type": "VEC3", "min": [0, 0, 0], "max": [1, 2, 1]},
                      {"bufferView": 1, "componentType": 5123, "count": len(triangles), "type": "SCALAR"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]}).encode()
    text += b" " * (-len(text) % 4)
    data += index
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def drop(hand, path, *beside):
    """Drops a file on the page, with others beside it; it is shown when this returns."""
    hand.drop_files(path, *beside)
    name = os.path.splitext(os.path.basename(path))[0]
    hand.wait(f"$('title').textContent === '{name}' && live.stats.undo === 0", seconds=120)


# Places of the screen where the body is, those near its middle first.
ON_BODY = """(() => {
  placeCamera();
  const c = $("canvas"), box = c.getBoundingClientRect(), m = bodySphere().middle.project(camera), found = [];
  const x = (m.x + 1) / 2 * c.clientWidth, y = (1 - m.y) / 2 * c.clientHeight;
  for (let i = -5; i <= 5; i++)
    for (let j = -5; j <= 5; j++) {
      const { origin, ray } = rayAt(x + 14 * i, y + 14 * j);
      if (surface.hit(origin, ray)) found.push([i * i + j * j, box.x + x + 14 * i, box.y + y + 14 * j]);
    }
  return found.sort((a, b) => a[0] - b[0]).map(([, x, y]) => [x, y]); })()"""


def elements(ply):
    """Lines of a PLY file that say how many vertices and faces it has."""
    return [line for line in ply.split(b"end_header")[0].split(b"\n") if line.startswith(b"element")]


def check_replayed(hand):
    """What the page did with the bear, cuts and a break, is what kerf-sim --portable does with the scene that it saves."""
    hand.key(" ")
    hand.wait("live.stats.paused")
    scene = saved(hand, "toml")
    check("the scene has the break", scene.count(b"[[blow]]") == 1)
    if "KERF_TOOLS" in os.environ:
        with open("bear.toml", "wb") as file:
            file.write(scene)
        shutil.copy(os.path.join(folder, "bear.off"), ".")
        tool = os.path.join(os.environ["KERF_TOOLS"], "kerf-sim")
        subprocess.run([tool, "bear.toml", "--portable", "-q", "-o", "replayed"], check=True)
        last = sorted(os.listdir("replayed/frames"))[-1]
        with open(os.path.join("replayed/frames", last), "rb") as file:
            there, here = elements(file.read()), elements(saved(hand, "ply"))
        check(f"{last} of kerf-sim has {there}, the page {here}", there == here)
    hand.key(" ")
    hand.wait("!live.stats.paused")


def break_here(hand, strokes, press):
    """Breaks the piece at a place of the body by the tool; the number of pieces after it. Another place where it is refused."""
    hand.tool("break")
    for number in range(5):
        places = hand.run(ON_BODY)
        hand.run("$('notice').textContent = ''")
        press(*places[number * len(places) // 8])
        hand.wait(f"(live.stats.blows > 0 && live.stats.undo === {strokes}) || $('notice').textContent.includes('does not break')", seconds=120)
        if hand.stats()["blows"]:
            break
    at = hand.run("live.time")
    hand.wait(f"live.time > {at} + 0.25", seconds=300)  # the parts part
    return hand.stats()["pieces"]


def touch(hand, kind, *places):
    hand.send("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y} for x, y in places])


def tap(hand, x, y):
    touch(hand, "touchStart", (x, y)), touch(hand, "touchEnd")


def on_phone(hand):
    """The box that was dropped, on a phone's screen: broken by a tap, cut by a finger, looked at by two fingers."""
    hand.key("r")
    hand.wait("live.stats.undo === 0 && live.stats.pieces === 1")
    hand.send("Emulation.setDeviceMetricsOverride", width=390, height=844, deviceScaleFactor=1, mobile=True)
    hand.send("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=2)
    hand.wait("window.innerWidth === 390")
    hand.run("document.body.classList.contains('wide') || orders.menu()")
    hand.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    wide = hand.run("""[document.documentElement.scrollWidth, $("tools").scrollWidth - $("tools").clientWidth,
      ...[...document.querySelectorAll("#tools button")].map((b) => b.getBoundingClientRect().right)]""")
    check(f"on a phone the page is {wide} wide", max(wide) <= 390 and wide[1] <= 0)
    hand.run("resetView()")
    pieces = break_here(hand, 1, lambda x, y: tap(hand, x, y))
    check(f"a tap makes {pieces} pieces of the box", pieces > 3)
    hand.press("#undo")
    hand.wait("live.stats.undo === 0 && live.stats.pieces === 1")
    x, y = middle(hand)
    knife = hand.run("(() => { const r = document.querySelector('[data-tool=knife]').getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]; })()")
    tap(hand, *knife)
    check("a tap chooses the knife", hand.run("state.tool") == "knife")
    places = along((x - 180, y), (x + 180, y + 6), steps=12)
    touch(hand, "touchStart", places[0])
    for place in places[1:]:
        touch(hand, "touchMove", place)
    touch(hand, "touchEnd")
    hand.wait("live.stats.undo === 1 && live.stats.waiting.length === 0", seconds=300)
    check(f"a finger makes {hand.stats()['pieces']} pieces of the box", hand.stats()["pieces"] >= 2)
    eye = hand.run("view.azimuth")
    touch(hand, "touchStart", (120, 300), (240, 300))
    for i in range(1, 8):
        touch(hand, "touchMove", (120 + 6 * i, 300), (240 + 6 * i, 300))
    touch(hand, "touchEnd")
    check("two fingers turn the view", hand.run("view.azimuth") != eye and hand.stats()["undo"] == 1)
    hand.send("Emulation.setTouchEmulationEnabled", enabled=False)


def check_painted(hand):
    """An OBJ that comes with its MTL and image has their colours; one that comes alone says what is missing."""
    with open("two.png", "wb") as file:
        file.write(png([[(230, 40, 30)] * 8 + [(30, 60, 220)] * 8] * 16))
    with open("two.mtl", "w") as file:
        file.write("newmtl sides\nKd 1 1 1\nmap_Kd two.png\n")
    n, place, faces = 8, {}, []
    for axis in range(3):
        for side in (0, n):
            for i in range(n):
                for j in range(n):
                    at = [[a, b] for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))]
                    corners = [tuple(p[:axis] + [side] + p[axis:]) for p in at]
                    faces.append([f"{place.setdefault(corner, len(place) + 1)}/{p[0] * (n + 1) + p[1] + 1}" for corner, p in zip(corners, at)])
                    if (side == n) != (axis != 1):
                        faces[-1].reverse()
    with open("two.obj", "w") as file:
        file.write("mtllib two.mtl\n" + "".join(f"v {x / n} {y / n} {z / n}\n" for x, y, z in place))
        file.write("".join(f"vt {i / n} {j / n}\n" for i in range(n + 1) for j in range(n + 1)) + "usemtl sides\n" + "".join("f " + " ".join(face) + "\n" for face in faces))
    red, blue = "r > 1.8 * g && r > 1.8 * b && r > 70", "b > 1.6 * r && b > 1.6 * g && b > 60"
    drop(hand, "two.obj", "two.mtl", "two.png")
    hand.wait("surface.painted !== null && surface.paint.textures.some((texture) => texture)")
    seen = [count(hand, red), count(hand, blue)]
    check(f"a painted box has {seen} red and blue pixels", min(seen) > 1500)
    hand.run("live.told.name = ''")
    drop(hand, "two.obj")
    hand.wait("$('notice').textContent.includes('names two.mtl, not in its folder')")
    check("an OBJ alone has colours", hand.run("surface.painted") is None)


def use(hand):
    started = time.time()
    hand.visit(address + "#shadows=false")
    loaded, first = len(served), time.time() - started
    check(f"the first model is {hand.run('live.told.name')}", hand.run("live.told.name") == "bear")
    hand.send("Browser.setDownloadBehavior", behavior="deny")
    pieces = cut(hand, 1)
    check(f"one drag makes {pieces} pieces of the bear", pieces == 2)
    hand.key("u")
    hand.wait("live.stats.undo === 0 && live.stats.pieces === 1")
    pieces = cut(hand, 1)
    check(f"a stroke after an undo makes {pieces} pieces", pieces >= 2)
    for number, shift in ((2, 50), (3, -60)):
        pieces = cut(hand, number, shift=shift, slope=-12)
    check(f"three cuts leave {pieces} pieces", pieces >= 4)
    check_saved(hand)

    before = pieces
    pieces = break_here(hand, 4, hand.click)
    check(f"{before} pieces are {pieces} after a break", pieces > before + 2)
    check_replayed(hand)
    check("no .glb of a broken bear", saved(hand, "glb")[:4] == b"glTF")
    hand.press("#undo")
    hand.wait(f"live.stats.undo === 3 && live.stats.blows === 0 && live.stats.pieces === {before}")
    hand.press("#redo")
    hand.wait(f"live.stats.undo === 4 && live.stats.blows === 1 && live.stats.pieces === {pieces}")

    with open("box.glb", "wb") as file:
        file.write(box_glb())
    hand.tool("knife")
    drop(hand, "box.glb")
    check(f"the vertical axis of a .glb is {hand.run('live.told.up')}", hand.run("live.told.up") == "y")
    pieces = cut(hand, 1)
    check(f"one drag makes {pieces} pieces of the box", pieces == 2)
    on_phone(hand)
    check_painted(hand)

    check(f"the console has {hand.errors}", not hand.errors)
    others = [url for url in hand.requests if not url.startswith((address, "data:", "blob:"))]
    check(f"it asks for {others + served[loaded:]}", not others and len(served) == loaded)
    print(f"bear shown after {first:.1f} s, {time.time() - started:.0f} s in all, {len(served)} files", flush=True)


def worker_seconds(hand):
    """Processor time of the page's worker so far."""
    parents, total = {}, 0
    for process in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{process}/stat") as file:
                parents[int(process)] = int(file.read().rsplit(")", 1)[1].split()[1])
        except OSError:
            pass  # it has ended
    for process in parents:
        above = process
        while above in parents and above != hand.process.pid:
            above = parents[above]
        if above != hand.process.pid:
            continue
        for thread in glob.glob(f"/proc/{process}/task/*"):
            try:
                with open(f"{thread}/stat") as file:
                    name, fields = file.read().split("(", 1)[1].rsplit(")", 1)
            except OSError:
                continue  # it has ended
            if name.startswith("DedicatedWorker"):
                total += sum(map(int, fields.split()[11:13])) / os.sysconf("SC_CLK_TCK")
    return total


def rate(hand):
    """Frames of a second of the worker's processor time, in the next second of the simulation; frames that are shown in a second."""
    time, seconds = hand.run("live.time"), worker_seconds(hand)
    hand.wait(f"live.time > {time} + 1", seconds=200)
    frames = (hand.run("live.time") - time) * hand.run("live.told.rate")
    return f"{frames / (worker_seconds(hand) - seconds):.0f} frames a second of processor time, {hand.stats()['fps']:.0f} shown"


def measure(hand):
    """Models whole and after a cut; 275 nodes are those of the scene of the polyp. Drawn as small as the page can be, since this browser draws without a card."""
    subprocess.run([os.path.join(rates, "samples", "kerf-model"), "polyp", "--frequency", "8", "-o", "polyp.ply"], check=True)
    for name, query in (("bear", "?nodes=800"), ("bear", "?nodes=600"), ("polyp", "?nodes=275")):
        hand.visit(address + query + "#shadows=false&plotted=false", width=480, height=420, scale=0.25)
        if name == "polyp":
            drop(hand, "polyp.ply")
        hand.key(".")
        hand.wait("live.time > 0")
        hand.key(" ")
        whole = rate(hand)
        hand.key("r")
        hand.wait("live.time === 0")
        pieces = cut(hand, 1, reach=200)
        print(f"{name}, {query[7:]} nodes: whole {whole}; in {pieces} pieces {rate(hand)}", flush=True)


hand = Tab(640, 560)
try:
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        (measure if rates else use)(hand)
finally:
    hand.close()
    os.chdir("/")
sys.exit(bool(failures))
