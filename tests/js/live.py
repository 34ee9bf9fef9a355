"""live.py LIVE_DIR: the live page without a server (js/build), in a browser, used by real pointer events.

The bear is cut by one drag, undone, cut again, saved; a model is dropped and cut. The console has no error, and after the page is
loaded nothing asks any host for anything.
"""
import functools, http.server, os, sys, tempfile, threading, time

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "live"))
from hand import Hand, along

folder, failures, served = os.path.abspath(sys.argv[1]), [], []


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


def cut(hand, strokes):
    """One drag across the middle of the body."""
    middle = [(a + b) / 2 for a, b in zip(*hand.run("live.told.box"))]
    x, y = hand.place(middle)
    hand.drag(along((x - 250, y), (x + 250, y + 10), steps=12))
    hand.wait(f"live.stats.undo === {strokes} && live.stats.waiting.length === 0", seconds=300)
    return hand.stats()["pieces"]


def saved(hand, format):
    """Bytes that a click on the link saves."""
    hand.run("window.blob = null; URL.createObjectURL = (blob) => { window.blob = blob; return 'data:,'; }")
    hand.run(f"document.querySelector(\"a[href='save?as={format}']\").click()")
    hand.wait("window.blob !== null")
    return hand.run("window.blob.size")


hand = Hand(640, 560)
try:
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        started = time.time()
        hand.visit(address + "#shadows=false")
        loaded, first = len(served), time.time() - started
        check(f"the first model is {hand.run('live.told.name')}", hand.run("live.told.name") == "bear")
        pieces = cut(hand, 1)
        check(f"one drag makes {pieces} pieces of the bear", pieces == 2)
        rate = hand.stats()["fps"]
        hand.key("u")
        hand.wait("live.stats.undo === 0 && live.stats.pieces === 1")
        check("a stroke after an undo", cut(hand, 1) == 2)
        sizes = {format: saved(hand, format) for format in ("glb", "ply", "kerf")}
        check(f"saved files have {sizes} bytes", min(sizes.values()) > 10000)

        with open("box.obj", "w") as file:
            corners = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
            sides = [(1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6)]
            file.write("".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "".join(f"f {' '.join(map(str, s))}\n" for s in sides))
        data = {"items": [], "files": [os.path.abspath("box.obj")], "dragOperationsMask": 1}
        for kind in ("dragEnter", "dragOver", "drop"):
            hand.send("Input.dispatchDragEvent", type=kind, x=300, y=250, data=data)
        hand.wait("$('title').textContent === 'box' && live.stats.undo === 0", seconds=120)
        pieces = cut(hand, 1)
        check(f"one drag makes {pieces} pieces of the box", pieces == 2)

        check(f"the console has {hand.errors}", not hand.errors)
        others = [url for url in hand.requests if not url.startswith((address, "data:", "blob:"))]
        check(f"it asks for {others + served[loaded:]}", not others and len(served) == loaded)
        print(f"bear shown after {first:.1f} s, {rate:.0f} frames/s after the cut, {len(served)} files", flush=True)
finally:
    hand.close()
    os.chdir("/")
sys.exit(bool(failures))
