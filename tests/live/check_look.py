"""check_look.py TOOLS_DIR SCENES_DIR MODELS_DIR CASE...: what kerf-live's page shows of a body, and tools beside the knife, by real pointer and key events.

bodies: each body of the gallery is opened by its button, and has its look.
gape: a scalpel's cut in the tight skin of a slab opens, and stays a line without tension; resistance and dullness; the recording has all.
solids: what is inside of a cake, and of flesh, and the dark of a closed wound.
images: an OBJ that is dropped with its MTL and image has its colours, which a control takes away.
stress: it is painted on the surface, where the body is drawn.
lasso: closed lines of six kinds cut a part out, each by one step of undo; a short one is refused.
clamp: two places are drawn together, and let go.
follow: the view goes with a piece that is drawn away.
record: an animated GLB has the frames that were shown, in three.js, too, and Khronos' validator finds nothing; a video.
twice: a cut at the place of one before leaves no bridge.
"""
import base64, filecmp, glob, json, math, os, struct, subprocess
from hand import along
from page_session import Session, check, hand, kerf, models, run, tools
from pictures import ENDS, changed, count, gaps, keep, png

GROUPS = "surface.position.array.subarray(0, 3 * surface.corners.groups)"


def model(name, *options):
    session = Session(name, *options, scene=False)
    hand.run("quality.watch = () => {}; 1")  # a slow machine leaves nothing out here
    return session


def body(name):
    """Opens a body of the gallery by its button."""
    hand.key("i")
    hand.button(f'[data-body="{name}"]')
    hand.wait(f"live.told.name === '{name}' && live.frame === null && live.stats.undo === 0", seconds=120)


def pause():
    hand.key(" ")
    hand.wait("live.stats.paused")


def end(session, name):
    check(f"{name}: the console has {hand.errors}", not hand.errors)
    check(f"{name}: exit code", session.program.stop() == 0)


def middle():
    return hand.place([(a + b) / 2 for a, b in zip(*hand.run("live.told.box"))])


def cut(from_, to, steps=12):
    """A stroke of the knife on a paused body."""
    hand.tool("knife")
    before = hand.stats()["undo"]
    hand.drag(along(from_, to, steps=steps))
    hand.finish()
    check(f"a stroke from {from_} to {to} does not cut", hand.stats()["undo"] == before + 1)


def bodies():
    session = model("polyp")
    keep(hand, "before")
    looks = {"apple": "r > 1.6 * g && r > 90", "pumpkin": "r > 1.3 * g && g > 1.5 * b", "cake": "r > 1.2 * b && r < 130", "jelly": "g > 1.2 * r && g > 1.2 * b",
             "polyp": "r > 1.2 * g && g < 1.35 * b", "tissue": "r > 1.2 * g && g < 1.35 * b", "board": "r > 1.15 * g && g > 1.15 * b", "log": "r > 1.15 * b && r < 170",
             "stone": "Math.abs(r - b) < 40 && r < 190 && r > 60", "letter": "r > 1.4 * g && g > 1.4 * b"}
    names = hand.run("gallery.map(({ name }) => name)")
    check(f"bodies: {names}", sorted(names) == sorted(looks))
    for name in names:
        body(name)
        colored, differ = count(hand, looks[name]), changed(hand, "before")
        check(f"bodies: {colored} pixels of {name} have its colour, {differ:.2f} of all differ", colored > 2500 and differ > 0.05)
        keep(hand, "before")
        check(f"bodies: {name} begins with no tool of its own", hand.run("state.tool === gallery.find(({ name }) => name === live.told.name).tool"))
    session.program.save("model", "letter.ply")
    # The look belongs to the body: a page that is loaded again has it, and a model that is dropped does not take it on.
    body("cake")
    hand.reload()
    hand.wait("live.frame === null")
    check(f"bodies: loaded again the cake is of {hand.run('state.look')}", hand.run("state.look === 'cake' && $('look').value === 'cake'") and count(hand, looks["cake"]) > 2500)
    hand.drop_files("letter.ply")
    hand.wait("live.told.name === 'letter' && live.frame === null", seconds=120)
    check(f"bodies: a dropped model is of {hand.run('state.look')}", hand.run("state.look === 'clay'") and count(hand, looks["letter"]) > 2500 and not hand.run("live.told.gallery"))
    check("bodies: the model is not saved", open("letter.ply", "rb").read(3) == b"ply")
    end(session, "bodies")


def solids():
    session = model("polyp")
    body("cake")
    pause()
    x, y = middle()
    cut((x - 200, y - 30), (x + 200, y + 20))
    hand.run("set('skin', 0); view.elevation = 0.7; 1")
    hand.wait("hand.ghosts.length === 0")  # they fade between two pictures
    kinds = {"sponge": "r > 120 && r > 1.12 * g && g > 1.2 * b", "cream": "Math.abs(r - b) < 0.16 * r && r > 1.04 * b && r > 90", "jam": "r > 2 * g && r > 60"}
    inside = {kind: count(hand, test) for kind, test in kinds.items()}
    check(f"solids: a cut cake has {inside}", min(inside.values()) > 40)
    keep(hand, "cake")
    hand.run("set('look', 'tissue'); 1")
    kinds = {"fat": "r > 110 && r > 1.15 * g && g > 1.3 * b", "muscle": "r > 2 * g && r > 50"}
    inside = {kind: count(hand, test) for kind, test in kinds.items()}
    check(f"solids: cut flesh has {inside}, {changed(hand, 'cake'):.3f} of the picture differ", min(inside.values()) > 60 and changed(hand, "cake") > 0.02)
    # The wound is closed: under opaque skin it is darker than one that is open.
    hand.run("set('look', 'clay'); set('skin', 1); surface.skin.visible = false; 1")
    bright = "r > 150 && r > 1.1 * b"
    closed = count(hand, bright)
    hand.run("surface.gap.array.fill(9), surface.gap.needsUpdate = true")
    opened = count(hand, bright)
    check(f"solids: {closed} pixels of a closed wound are bright, {opened} of an open one", opened > 300 and closed < 0.5 * opened)
    end(session, "solids")


# The widest place of wounds at the skin, in the distance of nodes.
GAPE = "(draw(), Math.max(0, ...[...surface.wallGroups].map((g) => surface.gap.array[g])) * about.unit / live.told.spacing)"


def slider(name, keys):
    """Sets a slider of the panel by keys."""
    hand.button("#menu")
    hand.run(f"$('{name}').focus()")
    for key, code in keys:
        hand.send("Input.dispatchKeyEvent", type="keyDown", key=key, code=key, windowsVirtualKeyCode=code)
        hand.send("Input.dispatchKeyEvent", type="keyUp", key=key, code=key, windowsVirtualKeyCode=code)
    hand.button("#menu")


def incision():
    """A scalpel's cut along the middle of the slab, half a second later; how far it gapes."""
    hand.tool("scalpel")
    lo, hi = hand.run("live.told.box")
    top, y = hi[2] - hand.run("live.told.spacing"), (lo[1] + hi[1]) / 2
    begin, end = ([lo[0] + share * (hi[0] - lo[0]), y, top] for share in (0.3, 0.7))
    hand.drag(along(hand.place(begin), hand.place(end), steps=16), each=hand.step)
    hand.finish()
    for _ in range(30):
        hand.step()
    hand.wait("hand.ghosts.length === 0")
    check(f"gape: {hand.stats()}", hand.stats()["pieces"] == 1 and hand.stats()["undo"] == 1)
    return hand.run(GAPE)


def gape():
    session = model("polyp")
    body("tissue")
    hand.run("set('depth', 0.25); view.elevation = 0.9; 1")
    pause()
    keep(hand, "whole")
    wide = incision()
    differ = changed(hand, "whole")
    check(f"gape: a wound in a tight skin is {wide:.2f} spacings wide, {differ:.4f} of the picture differ", wide > 0.3 and differ > 0.004)
    slider("tension", [("Home", 36)])
    hand.wait("live.stats.set.tension === 1 && live.stats.undo === 0", seconds=120)
    hand.run("view.elevation = 0.9")
    keep(hand, "whole")
    shut = incision()
    check(f"gape: without tension {shut:.2f} instead of {wide:.2f}, {changed(hand, 'whole'):.4f} of the picture differ", shut < 0.3 * wide and changed(hand, "whole") < 0.8 * differ)
    print(f"gape: {wide:.3f} node spacings, {shut:.3f} without tension; pictures {differ:.4f}, {changed(hand, 'whole'):.4f}", flush=True)
    slider("resistance", [("End", 35)])
    slider("dullness", [("End", 35)])
    hand.wait("live.stats.set.resistance > 0 && live.stats.set.dullness === 1")
    slider("tension", [("End", 35)])
    hand.wait("live.stats.set.tension > 1.5 && live.stats.undo === 0", seconds=120)
    check("gape: resistance and friction are lost", hand.stats()["set"]["resistance"] > 0 and hand.stats()["set"]["dullness"] == 1)
    incision()
    # The recording has them all, and gives the same frame.
    os.mkdir("again")
    session.program.save("model", "again/tissue.ply"), session.program.save("toml", "again/tissue.toml"), session.program.save("ply", "shown.ply")
    end(session, "gape")
    kerf("kerf-sim", "-q", "again/tissue.toml", "-o", "again/run")
    check("gape: the replay's last frame is not the one shown", filecmp.cmp(sorted(glob.glob("again/run/frames/*.ply"))[-1], "shown.ply", shallow=False))


def images():
    # A box whose sides have the whole image each: left half red, right half blue.
    with open("two.png", "wb") as file:
        file.write(png([[(230, 40, 30)] * 8 + [(30, 60, 220)] * 8] * 16))
    with open("box.mtl", "w") as file:
        file.write("newmtl sides\nKd 1 1 1\nmap_Kd two.png\n")
    corners = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    sides = [(1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6)]
    with open("plain.obj", "w") as file:
        file.write("mtllib box.mtl\n" + "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl sides\n")
        file.write("".join("f " + " ".join(f"{v}/{k + 1}" for k, v in enumerate(side)) + "\n" for side in sides))
    subprocess.run([os.path.join(tools, "kerf-repair"), "plain.obj", "--edge", "0.1", "-o", "box.obj", "-q"], check=True)
    open("box.mtl", "a").close()
    session = model("polyp")
    red, blue = "r > 1.8 * g && r > 1.8 * b && r > 70", "b > 1.6 * r && b > 1.6 * g && b > 60"
    with open("box.obj") as file:
        names = [line.split()[1] for line in file if line.startswith("mtllib")]
    hand.drop_files("box.obj", *names, *[name for name in os.listdir(".") if name.endswith(".png")])
    hand.wait("live.told.name === 'box' && live.frame === null && surface.painted !== null", seconds=120)
    hand.wait("surface.paint.textures.some((texture) => texture)")
    whole = [count(hand, red), count(hand, blue)]
    check(f"images: red and blue pixels: {whole}; {hand.run('$(`notice`).textContent')}", min(whole) > 1500)
    hand.wait("!$('paint').disabled")
    pause()
    x, y = middle()
    cut((x - 200, y - 10), (x + 200, y + 10))
    check(f"images: after a cut {[count(hand, red), count(hand, blue)]}, not {whole}", all(count(hand, kind) > 0.8 * n for kind, n in zip((red, blue), whole)))
    hand.run("set('skin', 0.5); 1")
    check("images: through transparent skin nothing is drawn", count(hand, "b > 1.1 * r && r + g + b < 600") > 500)
    hand.run("set('skin', 1); 1")
    hand.button("#menu")
    hand.run("$('paint').scrollIntoView({ block: 'center' })")
    hand.button("#paint")
    hand.wait("surface.painted === null")
    hand.button("#menu")
    check(f"images: without the colours of the model {[count(hand, red), count(hand, blue)]}", count(hand, blue) < 50)
    session.program.save("model", "same.obj")
    check("images: the model is saved as another one", open("same.obj").read() == open("box.obj").read())
    end(session, "images")


def stress():
    session = Session("jello")
    viridis = "b > 1.25 * r && b > 0.8 * g && r < 120 && r + g + b < 420"
    before = count(hand, viridis)
    hand.key("g")
    top = hand.place([0.5, 0.5, 1.0])
    hand.drag(along(top, [top[0] + 60, top[1] - 60], steps=5), release=False)
    hand.key("t")
    hand.wait("live.skinStress !== null && live.skinStress.length === live.vertices", seconds=120)
    at = hand.run("live.time")
    hand.wait(f"live.time > {at} + 0.3", seconds=200)
    after, yellow = count(hand, viridis), count(hand, "r > 150 && g > 150 && b < 0.6 * g")
    check(f"stress: {before} pixels became {after}, {yellow} are yellow", after > 5000 + before and yellow > 20 and not hand.run("$('legend').hidden"))
    check("stress: nodes are drawn, too", not hand.run("inside.spots.points.visible"))
    hand.mouse("mouseReleased", top[0] + 60, top[1] - 60)
    hand.key("t")
    hand.wait("live.skinStress === null", seconds=120)
    check(f"stress: {count(hand, viridis)} pixels stay", count(hand, viridis) < 0.2 * after)
    session.pause()
    session.done()


def lasso():
    session = Session("jello", "--set", "gravity=[0,0,0]")
    session.begin()
    keep(hand, "whole")
    hand.key("a")
    x, y = hand.place([0.5, 0.0, 0.5])
    round_ = lambda turn, begin, size, places: [[x + size * math.cos(begin + turn * i * math.pi / 12), y + size * math.sin(begin + turn * i * math.pi / 12)] for i in range(places)]
    hand.drag([[x, y], [x + 6, y], [x + 12, y], [x + 6, y + 6]])
    hand.wait("$('notice').textContent === 'Draw a line around what is to be cut out.'")
    lines = {"a circle": round_(1, 0, 50, 24), "a circle the other way round": round_(-1, 2, 50, 24), "a small circle": round_(1, 0, 25, 24), "an open line": round_(1, 0.3, 45, 20),
             "a line that passes its begin": round_(-1, 2, 45, 27), "a square": along([x - 45, y - 45], [x + 45, y - 45], [x + 45, y + 45], [x - 45, y + 45], [x - 45, y - 42], steps=8)}
    for name, line in lines.items():
        hand.drag(line)
        hand.wait("live.stats.waiting.length === 2")
        hand.finish()
        stats = hand.stats()
        check(f"lasso: {name}: {stats['pieces']} pieces, {stats['undo']} to undo", stats["pieces"] == 2 and stats["undo"] == 1)
        if name == "a square":
            break
        hand.key("u")
        hand.wait("live.stats.undo === 0 && live.stats.pieces === 1 && live.frame === null")
    hand.wait("hand.ghosts.length === 0")
    check(f"lasso: {changed(hand, 'whole'):.4f} of the picture differ", changed(hand, "whole") > 0.002)
    hand.key("u")
    hand.wait("live.stats.undo === 0 && live.frame === null")
    check(f"lasso: after undo {changed(hand, 'whole'):.4f} of the picture differ", changed(hand, "whole") < 0.002)
    hand.step()
    session.done()


def clamp():
    session = Session("jello", "--set", "gravity=[0,0,0]")
    check(f"clamp: {count(hand, ENDS)} pixels have the colour of its ends before", count(hand, ENDS) == 0)
    hand.key("j")
    a, b = hand.place([0.2, 0.0, 0.8]), hand.place([0.8, 0.0, 0.8])
    hand.click(*a)
    hand.wait("clamp.first !== null")
    hand.click(*b)
    hand.wait("live.stats.holds.length === 2", seconds=200)
    at = hand.run("live.time")
    hand.wait(f"live.time > {at} + 0.5", seconds=200)
    p, q = (hold["at"] for hold in hand.stats()["holds"])
    check(f"clamp: places 0.6 apart are {math.dist(p, q):.2f} apart", math.dist(p, q) < 0.4)
    check(f"clamp: {count(hand, ENDS)} pixels of its ends", count(hand, ENDS) > 20)
    session.pause()
    hand.key("g")
    for left in (1, 0):
        hand.click(*hand.place(hand.stats()["holds"][0]["to"]))
        hand.step()
        hand.wait(f"live.stats.holds.length === {left}")
    session.done()


def follow():
    session = model("polyp")
    pause()
    x, y = middle()
    cut((x - 200, y), (x + 200, y + 10))
    hand.tool("orbit")
    hand.click(x, y - 70)
    hand.wait("follow.rest !== null")
    hand.wait("$('notice').textContent.startsWith('The view goes with this piece')")
    eye = hand.run("view.azimuth")
    hand.key("g")
    hand.key(" ")
    hand.drag(along((x, y - 70), (x + 120, y - 110), steps=8), release=False)
    at = hand.run("live.time")
    hand.wait(f"live.time > {at} + 1.5", seconds=200)
    pause()
    hand.mouse("mouseReleased", x + 120, y - 110)
    shift = hand.run("view.target.length()")
    off = hand.run("(() => { const lo = new THREE.Vector3(9, 9, 9), hi = lo.clone().negate(), p = new THREE.Vector3(); for (const v of follow.members) lo.min(p.fromArray(live.position, 3 * v)), hi.max(p); return lo.add(hi).multiplyScalar(0.5).distanceTo(view.target); })()")
    check(f"follow: the view went by {shift:.2f}, and is {off:.2f} from the piece", shift > 0.15 and off < 0.4 and hand.run("view.azimuth") == eye)
    check(f"follow: {hand.run('follow.members.length')} of {hand.run('live.vertices')} vertices", 20 < hand.run("follow.members.length") < hand.run("live.vertices") - 20)
    hand.tool("orbit")
    hand.click(30, 300)
    hand.wait("follow.rest === null")
    end(session, "follow")


def glb_of(path):
    """JSON and bytes of a .glb."""
    data = open(path, "rb").read()
    size, = struct.unpack_from("<I", data, 12)
    return json.loads(data[20:20 + size]), data[28 + size:]


def saved_blob(button):
    hand.run("window.blob = null; URL.createObjectURL = (blob) => { window.blob = blob; return 'data:,'; }; 1")
    hand.button(button)
    hand.wait("window.blob !== null")
    return base64.b64decode(hand.run("""window.blob.arrayBuffer().then((buffer) => {
      let text = ""; const bytes = new Uint8Array(buffer); for (let i = 0; i < bytes.length; i += 8192) text += String.fromCharCode(...bytes.subarray(i, i + 8192)); return btoa(text); })"""))


def record():
    session = model("polyp")
    hand.key("v")
    hand.wait("recorder.on")
    pause()
    x, y = middle()
    cut((x - 200, y), (x + 200, y + 10), steps=6)
    hand.key(" ")
    at = hand.run("live.time")
    hand.wait(f"live.time > {at} + 0.5", seconds=200)
    pause()
    hand.button("#record")
    hand.wait("$('recorded').open")
    frames = hand.run("recorder.frames.map(({ lasts }) => lasts)")
    check(f"record: frames at {frames}", len(frames) > 6 and all(a < b for a, b in zip(frames, frames[1:])))
    # The world's box of each frame, y up as the file has it: (x, y, z) there is (x, z, −y).
    boxes = hand.run("""recorder.frames.map(({ position, revision }, i) => {
      const first = recorder.frames.slice(0, i + 1).reverse().find(({ skin }) => skin), lo = [9e9, 9e9, 9e9], hi = [-9e9, -9e9, -9e9];
      for (const list of [first.skin, first.walls]) for (const g of list) for (let k = 0; k < 3; k++) {
        const x = about.middle[k] + about.unit * position[3 * g + k]; lo[k] = Math.min(lo[k], x), hi[k] = Math.max(hi[k], x); }
      return [lo[0], lo[2], -hi[1], hi[0], hi[2], -lo[1]]; })""")
    with open("run.glb", "wb") as file:
        file.write(saved_blob("#recorded-glb"))
    about, _ = glb_of("run.glb")
    meshes, channels = about["meshes"], about["animations"][0]["channels"]
    targets = sum(len(mesh["primitives"][0].get("targets", [])) for mesh in meshes)
    check(f"record: {len(meshes)} meshes with {targets} morph targets of {len(frames)} frames", len(meshes) > 1 and len(meshes) + targets == len(frames))
    check("record: no animation", {channel["target"]["path"] for channel in channels} == {"weights", "scale"})
    video = saved_blob("#recorded-video")
    check(f"record: a video of {len(video)} bytes", len(video) > 5000 and video[:4] == b"\x1aE\xdf\xa3")
    hand.errors.clear()  # the saved blobs are not there
    end(session, "record")
    readers = os.path.join(tools, "..", "assets")
    if not os.path.exists(os.path.join(readers, "node_modules", "three")):
        return print("record: no readers of glTF here; tests/assets/run installs them")
    done = subprocess.run(["node", "validate.mjs", os.path.abspath("run.glb")], cwd=readers, capture_output=True, text=True)
    check(f"record: {done.stdout}{done.stderr}", done.returncode == 0)
    program = os.path.join(os.path.dirname(os.path.realpath(__file__)), "animation.mjs")
    done = subprocess.run(["node", program, os.path.realpath(readers), "run.glb"], input=json.dumps(frames), capture_output=True, text=True)
    check(f"record: three.js: {done.stderr}", done.returncode == 0)
    shown = json.loads(done.stdout)
    off = [max(abs(a - b) for a, b in zip(box, seen)) for box, seen in zip(boxes, shown)]
    check(f"record: in three.js the body is up to {max(off):.4f} elsewhere", max(off) < 0.01)


# How many triangles each part has that triangles join by vertices, and how many of these have both skin and a size worth it.
PARTS = """(() => {
  const c = surface.corners, top = new Int32Array(live.vertices).map((x, i) => i), count = new Map();
  const root = (i) => { while (top[i] !== i) i = top[i] = top[top[i]]; return i; };
  for (let s = 0; s < c.slots; s++) if (c.kind[s] !== noKind) for (let k = 1; k < 3; k++) top[root(c.vertex[3 * s + k])] = root(c.vertex[3 * s]);
  for (let s = 0; s < c.slots; s++) if (c.kind[s] !== noKind) count.set(root(c.vertex[3 * s]), 1 + (count.get(root(c.vertex[3 * s])) ?? 0));
  return [...count.values()].sort((a, b) => b - a); })()"""


def twice():
    session = Session("jello", "--set", "gravity=[0,0,0]")
    # A line twice and back on it; beside it, which leaves a thin slice; across it at a small angle, which leaves wedges. In pixels, at its ends.
    for name, lines in {"same": [(0, 0), (0, 0), (0, 0)], "beside": [(0, 0), (1.5, 1.5)], "across": [(0, 0), (-4, 4)]}.items():
        session.begin()
        hand.key("h")
        x, y = hand.place([0.5, 0.5, 0.5])
        hand.tool("knife")
        for i, (left, right) in enumerate(lines):
            line = along((x - 200, y - 20 + left), (x + 200, y + 10 + right), steps=14)
            hand.drag(line[::-1] if i == 2 else line)
            hand.finish()
        parts, pieces = hand.run(PARTS), hand.stats()["pieces"]
        hand.tool("grab")
        top = hand.place([0.5, 0.5, 1.0])
        hand.key(" ")
        hand.drag(along(top, [top[0], top[1] - 130], steps=6), release=False)
        at = hand.run("live.time")
        hand.wait(f"live.time > {at} + 2", seconds=300)
        pause()
        hand.mouse("mouseReleased", top[0], top[1] - 130)
        check(f"twice: {name}: parts of {parts} triangles, {pieces} pieces", len([n for n in parts if n > 1000]) >= 2 and pieces >= 2)
        # Seen along the cut as it was made, from near: nothing spans the gap between the halves. The upper one turns in the hand, and may
        # hide up to half of it; halves that are joined show none.
        hand.run("hand.trail = [], seeBody(), view.distance *= 0.8, redraw(), 1")
        hand.wait("hand.ghosts.length === 0")
        wide, open_, bridged = gaps(hand, "r > 1.12 * b")
        print(f"twice: {name}: {parts} {pieces} {open_} of {wide} columns have a gap, {bridged} are bridged", flush=True)
        check(f"twice: {name}: {open_} of {wide} columns of the picture have a gap between the halves, {bridged} are bridged", open_ > 0.5 * wide and bridged < 0.2 * wide)
        hand.key(" ")
        hand.wait("!live.stats.paused")
    pause()
    session.done()


run(globals())
