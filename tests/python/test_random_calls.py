"""Random calls of everything public, with good and bad arguments. A call returns or raises, with one sentence, one of the errors
that the module promises. It never ends the process.

  KERF_CASES=N   N times as many calls        KERF_SEED=S   another seed
  KERF_CASE=K    call K alone, and tells it   KERF_TELL=1   tells every call before it is made
"""
import faulthandler
import mmap
import os
import random
import re
import resource
import subprocess
import sys
import tempfile
import time
import unittest

import numpy as np

import kerf
import values

CALLS, SECONDS = 10000, 2.0  # a call that takes longer is stopped by its progress function
# Errors that are Python's own: wrong types, memory that cannot be had, and the end of a sequence.
OTHER = (TypeError, MemoryError, IndexError)


SCENE = """
gravity = [0, 0, -1]
[body]
mesh = "cube.ply"
spacing = 0.3
[material]
young = 1e4
[[blade]]
name = "knife"
points = [[-1, 0.5, 0], [2, 0.5, 0]]
keys = [[0, 0, 0, 2, 0, 0, 1, 0], [1, 0, 0, -1, 0, 0, 1, 0]]
[[grip]]
box = [-1, -1, -1, 2, 2, 0.1]
[[obstacle]]
name = "floor"
normal = [0, 0, 1]
position = [0, 0, -1]
[time]
frames = 2
frame_rate = 24
"""
LINE = np.array([[-1, 0.5, 0.4], [2, 0.5, 0.4]])
POINTS = np.array([[0.5, 0.5, 0.5], [2, 2, 2], [0, 0, 0.5], [0.2, 0.3, 1.0]])
# Values that fit parameters of these names; "@Class": an object of the class.
FITTING = {"what": ["@Score", "@Front", "@Mesh"], "sheet": ["@Score", "@Mesh"], "surface": ["@Mesh", "@Solid"], "model": ["@Solid", "@Complex"],
           "solid": ["@Solid"], "nodes": ["@NodeSet"], "other": ["@Complex"], "before": ["@Complex"], "complex": ["@Complex"], "front": ["@FrontState"],
           "line": [LINE, LINE - 0.5], "next_line": [LINE + [0, 0, 0.2]], "next": [LINE + [0, 0, 0.2]], "points": [POINTS], "steps": [np.array([LINE, LINE + 1])],
           "positions": [POINTS], "pattern": ["planes", "voronoi", "radial", "glass", "bricks", "wood"], "pieces": [1, 2, 5], "attempts": [1, 3],
           "spacing": [0.3, "30%"], "count": [20, 100], "region": [np.array([0, 1, 2]), None], "radius": [np.ones(4)], "volume": [np.ones(4)],
           "frequency": [1, 4], "voxel": [0.1], "longest": [0.3], "set": [{"material.young": "1e4"}], "axis": ["x", [0, 0, 1]], "seed": [1, 2, 3], "body": ["@Body"],
           "state": ["@State"], "delta": ["@BodyDelta"], "material": ["@Material"], "materials": ["@Materials", "@Material"], "environment": ["@Environment"],
           "graph": ["@VisibilityGraph"], "scene": ["@Scene", SCENE], "models": ["@Solid"], "frames": [1, 2], "dt": [1e-3], "pose": [[0, 0, 1], np.eye(4)],
           "which": [0, "knife", "floor"], "node": [0, 3], "table": [[]], "u": ["@State"], "f": [np.eye(3)]}


class Stopped(Exception):
    """Raised by a progress function now and then."""


class Case:
    """One call: its objects are made anew, so that each case can be run alone."""

    def __init__(self, seed, folder):
        self.rng = random.Random(seed)
        self.folder = folder
        self.made, self.files = {}, []
        self.start = time.monotonic()

    def object(self, name):
        """A small object of a class, by the calls that make one. None where the module has no such class."""
        if name not in self.made:
            made = self.make(name)
            self.made[name] = made if isinstance(made, getattr(kerf, name, ())) else None
        return self.made[name]

    def make(self, name):
        if not hasattr(kerf, name):
            return None
        vertices, faces = values.cube()
        if name == "Mesh":
            return kerf.Mesh(vertices, faces, groups=["a"] * 6 + ["b"] * 6, uv=vertices[:, :2])
        if name == "Solid":
            return kerf.Solid(vertices, faces)
        if name == "Score":
            return kerf.score(self.object("Solid"), "planes", pieces=2, jagged=0, seed=self.rng.randrange(3))
        if name == "Complex":
            return self.object("Solid").crack(self.object("Score")) if self.rng.random() < 0.5 else self.object("Solid").complex()
        if name == "Piece":
            return self.rng.choice(self.object("Complex").pieces())
        if name == "Front":
            return kerf.Front([[[-1, 0.5, z], [2, 0.5, z]] for z in (-0.1, 0.4, 1.1)])
        if name == "Breakable":
            return kerf.Breakable(self.object("Solid"))
        if name == "Breaking":
            return self.object("Breakable").strike([0.9, 0.8, 0.7], energy=500, seconds=0)
        if name == "BrokenPart":
            return self.object("Breaking").parts[-1]
        if name == "FrontState":
            return self.object("Complex").front([[-1, 0.5, -0.1], [2, 0.5, -0.1]])
        if name == "CrackDelta":
            return self.object("Solid").complex().front([[-1, 0.5, -0.1], [2, 0.5, -0.1]]).advance([[-1, 0.5, 0.4], [2, 0.5, 0.4]])
        if name == "SurfaceReport":
            return self.object("Mesh").check()
        if name == "NodeSet":
            return kerf.sample(self.object("Solid"), spacing=0.3)
        if name == "Body":
            return kerf.Body(self.object("Solid"), spacing=0.3)
        if name == "VisibilityGraph":
            return self.object("Body").graph
        if name == "Binding":
            return self.object("Body").binding
        if name == "BodyFront":
            return self.object("Body").front([[-1, 0.5, -0.1], [2, 0.5, -0.1]])
        if name == "BodyDelta":
            return self.object("BodyFront").advance([[-1, 0.5, 0.4], [2, 0.5, 0.4]])
        if name == "BodyReport":
            return self.object("Body").check()
        if name == "KerfFile":
            path = os.path.join(self.folder, "body.kerf")
            self.object("Body").save(path)
            return kerf.KerfFile(path)
        if name == "Material":
            return kerf.Material(young=1e4)
        if name == "Materials":
            return kerf.Materials([self.object("Material")])
        if name == "DeformingSolid":
            return kerf.DeformingSolid(self.object("Body"), self.object("Material"))
        if name == "State":
            return self.object("DeformingSolid").rest()
        if name == "Environment":
            return kerf.Environment(gravity=[0, 0, -9.81])
        if name == "Scene":
            return kerf.Scene(SCENE)
        if name == "Simulation":
            return kerf.Simulation(self.object("Scene"), models=self.object("Solid"))
        if name in ("BladeHandle", "GripHandle", "ObstacleHandle"):
            return getattr(self.object("Simulation"), name[:-6].lower())(0)
        if name == "StitchHandle":
            return self.object("Simulation").add_stitch([0.2, 0.5, 0.5], [0.8, 0.5, 0.5])
        if name == "PullHandle":
            return self.object("Simulation").add_pull([0.5, 0.5, 0.5], [0.5, 0.5, 0.5])
        if name in ("Blade", "Grip", "SceneObstacle", "SceneBody"):
            return getattr(self.object("Scene"), {"Blade": "blades", "Grip": "grips", "SceneObstacle": "obstacles", "SceneBody": "bodies"}[name])[0]
        return None

    def progress(self, phase, done, total):
        assert isinstance(phase, str) and 0 <= done and 0 <= total
        if self.rng.random() < 0.01:
            raise Stopped
        return time.monotonic() - self.start < SECONDS

    def file(self):
        """A file in the folder, which holds files of many kinds, or one that is not there."""
        if not self.files:
            mesh = kerf.Mesh(*values.cube())
            for name in ("a.ply", "b.obj", "h.glb"):
                mesh.save(os.path.join(self.folder, name))
            kerf.save_fronts(os.path.join(self.folder, "j.front"), [self.object("Front")])
            for name, data in (("c.stl", b"solid \xff"), ("d.off", b"OFF\n3 1 0\n"), ("f.txt", b"a\0b\n\xfe"), ("k.toml", b"[time]\nframes = 1\n")):
                with open(os.path.join(self.folder, name), "wb") as file:
                    file.write(data)
            self.files = sorted(os.listdir(self.folder)) + ["i.npz", "e.kerf", "l.csv", "none/g.ply"]
        return os.path.join(self.folder, self.rng.choice(self.files))

    def argument(self, name):
        """A value for a parameter of this name: often one that fits."""
        rng = self.rng
        if name == "progress":
            return self.progress
        if name == "path" and rng.random() < 0.8:
            return self.file()
        if name in ("vertices", "faces") and rng.random() < 0.7:
            array = values.cube()[name == "faces"]
            return array if rng.random() < 0.5 else values.spoiled(array, rng)
        if name in FITTING and rng.random() < 0.5:
            value = rng.choice(FITTING[name])
            value = self.object(value[1:]) if isinstance(value, str) and value[:1] == "@" else value
            return values.spoiled(value, rng) if isinstance(value, np.ndarray) and rng.random() < 0.5 else value
        kind = rng.random()
        if kind < 0.35:
            return values.scalar(rng)
        if kind < 0.5:
            return values.good_arrays(rng)
        if kind < 0.8:
            return values.spoiled(values.good_arrays(rng), rng)
        return self.object(rng.choice(["Mesh", "Solid", "Score", "Complex", "Front", "NodeSet", "Body", "Piece"]))


def parameters(call):
    """Names and whether each is required, from the signature that pybind11 writes into the docstring; None where there is none."""
    text = (getattr(call, "__doc__", None) or "").lstrip()
    signatures = re.findall(r"^(?:\d+\. )?\w+\((.*)\)(?: -> .*)?$", text, re.M)
    if not signatures:
        return None
    out, depth, word = [], 0, ""
    for letter in signatures[0] + ",":
        depth += letter in "[(" and 1 or letter in "])" and -1 or 0
        if letter == "," and depth == 0:
            out.append(word.strip())
            word = ""
        else:
            word += letter
    only_by_name, found = False, []
    for word in out:
        name = re.match(r"\*{0,2}\w*", word)[0]
        if name == "*":
            only_by_name = True
        elif name.startswith("*"):
            continue
        elif name and name != "self":
            found.append((name, "=" not in word, only_by_name))
    return found


def public_calls():
    """(what to call, how it is named, its class or None), sorted by name."""
    found = [(getattr(kerf.shapes, name), f"shapes.{name}", None) for name in kerf.shapes.__all__]
    for name in sorted(vars(kerf)):
        value = getattr(kerf, name)
        if name.startswith("_") or isinstance(value, type(kerf)) or not callable(value):
            continue
        if isinstance(value, type) and issubclass(value, BaseException):
            continue
        found.append((value, name, None))
        if not isinstance(value, type):
            continue
        for member in sorted(dir(value)):
            if member.startswith("_") and member not in ("__len__", "__getitem__", "__repr__", "__eq__", "__iter__", "__contains__", "__hash__"):
                continue
            found.append((getattr(value, member), f"{name}.{member}", name))
    return found


SLOW = {"picture": dict(size=(16, 12), samples=1)}  # arguments that keep a call short
SKIPPED = {"set_threads", "show"}  # a thousand threads would serve nobody, and a window waits for someone to close it


class RandomCalls(unittest.TestCase):
    def call(self, case, public):
        what, name, owner = case.rng.choice(public)
        if name.rsplit(".")[-1] in SKIPPED:
            return None
        target, is_class = what, isinstance(what, type)
        given = parameters(what.__init__ if is_class else what)
        if owner and not is_class:
            mine = case.object(owner)
            if mine is None:
                return None
            subject = mine if case.rng.random() < 0.97 else values.scalar(case.rng)
            if isinstance(what, property):
                if self.tell:
                    print(f"{name} of {subject!r:.100}", flush=True)
                return getattr(mine, name.split(".")[1])
            if mine is subject:
                target = getattr(subject, name.split(".")[1])
        positional, named = [], {}
        for at, (word, required, by_name) in enumerate(given if given is not None else [("value", True, False)] * case.rng.randrange(3)):
            if word != "progress" and not required and case.rng.random() < 0.6:
                continue
            if by_name or len(positional) < at or not required:
                named[word] = case.argument(word)
            else:
                positional.append(case.argument(word))
        if case.rng.random() < 0.02:
            named[case.rng.choice(["nothing", "vertices", "é"])] = values.scalar(case.rng)
        named.update(SLOW.get(name, {}))
        if self.tell:
            print(f"{name}({', '.join([f'{a!r:.200}' for a in positional] + [f'{k}={v!r:.200}' for k, v in named.items()])})", flush=True)
        return target(*positional, **named)

    def test_random_calls(self):
        seed = int(os.environ.get("KERF_SEED", "1"))
        count = int(CALLS * float(os.environ.get("KERF_CASES", "1")))
        only = os.environ.get("KERF_CASE")
        self.tell = bool(only or os.environ.get("KERF_TELL"))
        print(f"seed {seed}: {count} calls", flush=True)
        public = public_calls()
        self.assertGreater(len(public), 20)
        returned, raised, wrong = 0, 0, []
        for number in [int(only)] if only else range(count):
            with tempfile.TemporaryDirectory() as folder:
                case = Case(seed * 10**9 + number, folder)
                self.current[:] = b"%-32d" % number
                try:
                    self.call(case, public)
                    returned += 1
                except (kerf.Error, Stopped, *OTHER) as error:
                    raised += 1
                    text = str(error)
                    sentence = text.strip() and ("\n" not in text or isinstance(error, TypeError))  # TypeErrors list signatures
                    if not sentence and not isinstance(error, (Stopped, MemoryError)):
                        wrong.append(f"case {number}: {type(error).__name__}({text!r}) is no sentence")
                except BaseException as error:
                    wrong.append(f"case {number}: {type(error).__name__}: {error}")
                if time.monotonic() - case.start > 30:
                    wrong.append(f"case {number} took {time.monotonic() - case.start:.0f} s")
        print(f"{returned} returned, {raised} raised", flush=True)
        self.assertEqual(wrong, [], f"seed {seed}")
        if not only:
            self.assertGreater(returned, count // 20)
            self.assertGreater(raised, count // 20)

    current = bytearray(32)


def main():
    """Runs the calls in a child process: a crash is then a failure that names its case."""
    if os.environ.get("KERF_CHILD") or os.environ.get("KERF_CASE"):
        faulthandler.enable()
        if "asan" not in os.environ.get("LD_PRELOAD", ""):  # a sanitizer maps terabytes
            resource.setrlimit(resource.RLIMIT_AS, (6 << 30, 6 << 30))
        shared = os.environ.get("KERF_CHILD")
        if shared:
            with open(shared, "r+b") as file:
                RandomCalls.current = mmap.mmap(file.fileno(), 32)
        unittest.main()
    with tempfile.NamedTemporaryFile() as shared, tempfile.TemporaryDirectory() as folder:
        shared.write(b" " * 32)
        shared.flush()
        # Calls may write files of any name.
        run = subprocess.run([sys.executable, os.path.abspath(__file__), *sys.argv[1:]], cwd=folder,
                             env={**os.environ, "KERF_CHILD": shared.name})
        if run.returncode < 0 or run.returncode > 1:
            print(f"the process ended with {run.returncode} in case {open(shared.name).read().strip()}: KERF_CASE=… tells it")
        sys.exit(run.returncode != 0)


if __name__ == "__main__":
    main()
