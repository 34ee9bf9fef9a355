"""A hand at kerf-live's page: pointer events in a headless browser, aimed at places of the body."""
import os, sys, time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "tools"))
from browser import Browser

DRAWN = "live.told !== null && live.position.length > 0 && plots.frames.length > 0"


class Hand(Browser):
    def visit(self, address, width=640, height=560, scale=0.5):
        """Opens the page; the first frame is drawn when this returns."""
        self.send("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale, mobile=False)
        self.open(address)
        self.wait(DRAWN)

    def reload(self):
        """Loads the page again."""
        self.loaded = False
        self.send("Page.reload")
        until = time.time() + 60
        while not self.loaded:
            self.message(until)
        self.wait(DRAWN)

    def drop_files(self, *paths):
        """Drops files on the picture."""
        data = {"items": [], "files": [os.path.abspath(path) for path in paths], "dragOperationsMask": 1}
        for kind in ("dragEnter", "dragOver", "drop"):
            self.send("Input.dispatchDragEvent", type=kind, x=300, y=250, data=data)

    def wait(self, condition, seconds=60):
        """Until an expression of the page is true; longer where others use the machine, too."""
        seconds = round(seconds * max(1, 2 * os.getloadavg()[0] / os.cpu_count()))
        self.run(f"""new Promise((done, failed) => {{ const end = performance.now() + {1000 * seconds};
          const look = () => {condition} ? done(1) : performance.now() > end ? failed(new Error("not after {seconds} s: " + JSON.stringify(live.stats) + $("notice").textContent)) : setTimeout(look, 15); look(); }})""", 60 + seconds)

    def stats(self):
        return self.run("live.stats")

    def place(self, point):
        """Where a point of the world is on the screen."""
        return self.run(f"""(() => {{ placeCamera(); const p = toShown({list(point)}).project(camera), c = $("canvas").getBoundingClientRect();
          return [c.x + (p.x + 1) / 2 * c.width, c.y + (1 - p.y) / 2 * c.height]; }})()""")

    def button(self, id):
        x, y, w, h = self.run(f"""(() => {{ const r = document.querySelector({id!r}).getBoundingClientRect(); return [r.x, r.y, r.width, r.height]; }})()""")
        self.click(x + w / 2, y + h / 2)

    def tool(self, name):
        self.button(f'[data-tool="{name}"]')

    def step(self):
        """A single step of the run, which is paused."""
        before = self.run("live.time")
        self.key(".")
        self.wait(f"live.time > {before}")

    def finish(self):
        """Steps until no edge is in the body or waits to be: an edge that the pointer has left behind comes after it."""
        self.step()
        while self.stats()["edges"] or self.stats()["waiting"]:
            self.step()

    def drag(self, places, button="left", each=lambda: None, release=True):
        """Presses at the first place, moves along the others, and releases; `each` is done after each of these."""
        self.mouse("mouseMoved", *places[0], button="none")
        self.mouse("mousePressed", *places[0], button=button)
        for place in places[1:]:
            self.mouse("mouseMoved", *place, button=button)
            each()
        if release:
            self.mouse("mouseReleased", *places[-1], button=button)
            each()


def along(*corners, steps=20):
    """Places on a polyline, `steps` to each part."""
    return [[a + (b - a) * i / steps for a, b in zip(p, q)] for p, q in zip(corners, corners[1:]) for i in range(steps)] + [list(corners[-1])]
