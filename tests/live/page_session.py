"""Scenes in kerf-live and a page that shows them, for the checks of check_live.py, check_controls.py and check_newcomer.py.

A check that imports this is called as `CHECK TOOLS_DIR SCENES_DIR MODELS_DIR CASE...`; cases are functions of the check, run by run().
"""
import filecmp, glob, json, os, subprocess, sys, tempfile, time
from client import Program
from hand import Hand

tools, scenes, models = map(os.path.abspath, sys.argv[1:4])
failures = []


def check(what, good):
    if not good:
        failures.append(what)
        print("FAILED:", what, flush=True)


def kerf(name, *arguments):
    done = subprocess.run([os.path.join(tools, name), *map(str, arguments)], capture_output=True, text=True)
    check(f"{name} {' '.join(map(str, arguments))}: {done.stderr}", done.returncode == 0)
    return done.stdout


def figures(path):
    return json.loads(kerf("kerf-info", "--json", path))


class Session:
    """A scene in kerf-live, and a page that shows it."""

    def __init__(self, name, *options, scene=True):
        self.name = name
        subject = [os.path.join(scenes, name + ".toml"), "--no-blades", "--set", f"body.mesh={models}/{name}.ply"] if scene else [f"{models}/{name}.ply"]
        self.program = Program(os.path.join(tools, "kerf-live"), *subject, *options)
        hand.errors.clear(), hand.requests.clear()
        hand.visit(self.program.address + "#shadows=false")

    def pause(self):
        hand.key(" ")
        hand.wait("live.stats.paused")

    # At its begin, and paused: steps are made one by one, the same on any machine.
    def begin(self):
        self.pause()
        hand.step()  # time 0 then tells that it has begun anew
        hand.key("r")
        hand.wait("live.time === 0 && live.stats.paused")

    # Saves, and compares with what kerf-sim makes of the recorded scene.
    def done(self):
        for kind in ("toml", "ply", "kerf"):
            self.program.save(kind, f"{self.name}.{kind}")
        time_shown = hand.run("live.time")
        check(f"{self.name}: the console has {hand.errors}", not hand.errors)
        others = [url for url in hand.requests if not url.startswith((self.program.address, self.program.address.replace("http", "ws"), "data:", "blob:"))]
        check(f"{self.name}: it asks for {others}", not others)
        code = self.program.stop()
        check(f"{self.name}: exit code {code}: {''.join(self.program.said)}", code == 0)
        kerf("kerf-sim", "-q", f"{self.name}.toml", "-o", self.name)
        frames = sorted(glob.glob(f"{self.name}/frames/*.ply"))
        last = frames[-1]
        check(f"{self.name}: the replay's last frame is not the one shown", filecmp.cmp(last, f"{self.name}.ply", shallow=False))
        kerf("kerf-info", "-q", "--check", f"{self.name}.kerf")
        with open(f"{self.name}/frames.jsonl") as lines:
            crossed = [frame["frame"] for frame in map(json.loads, lines) if frame["crossings"] != 0]
        check(f"{self.name}: triangles cross in frames {crossed}", not crossed)
        print(f"{self.name}: {len(frames)} frames to {time_shown:.2f} s, replayed and checked", flush=True)


def run(cases):
    """Runs the cases that the command names, in a temporary folder; ends the program."""
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        try:
            for case in sys.argv[4:]:
                started = time.time()
                cases[case]()
                print(f"{case}: {time.time() - started:.1f} s", flush=True)
        finally:
            hand.close()
            os.chdir("/")
    sys.exit(bool(failures))


hand = Hand(640, 560)
