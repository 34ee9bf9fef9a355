"""Scenes and runs: against kerf-sim byte for byte, a knife that Python drives, checkpoints, bad input."""
import os
import pathlib
import random
import shutil
import subprocess
import tempfile
import unittest
import warnings

import numpy as np

import kerf
from shapes import block

SCENE = """
[body]
mesh = "block.ply"
nodes = 250
[material]
young = 5e4
damping = 2.0
[ground]
point = [0, 0, -0.02]
stiffness = 4e3
[time]
frames = 6
frame_rate = 24
step = 0.021
checkpoint_every = 3
[[blade]]
name = "knife"
points = [[0, -0.8, 0], [0, 0, 0], [0, 0.8, 0.01]]
divide = 8
keys = [[0.0, 0.503, 0.5, 1.05, 0, 0, 1, 4], [0.5, 0.507, 0.5, -0.2, 0, 0, 1, 8]]
[[grip]]
box = [-0.1, -0.1, -0.1, 0.15, 1.1, 1.1]
keys = [[0.0, 0, 0, 0, 0, 0, 1, 0]]
"""


# A change in the middle of a run.
LATER = """
[[change]]
time = 0.09
gravity = [0, 0, 9]
"""


def model():
    return kerf.Solid(*block())


def simulation(text=SCENE, **options):
    return kerf.Simulation(text, models=model(), **options)


class Blades(unittest.TestCase):
    def test_a_blade_without_thickness_has_no_force_and_says_so(self):
        wedge = {"blade.0.back": [0, 0, 0.4], "blade.0.thickness": 0.06}
        largest, said = [], []
        for options in ({}, wedge):
            run = simulation(set=options)
            largest.append(0.0)
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                for _ in range(4):
                    run.step()
                    largest[-1] = max(largest[-1], np.abs(run.blade(0).force).max())
            said.append([str(each.message) for each in caught])
        self.assertEqual(len(said[0]), 4)
        self.assertIn("blade 'knife' has no force", said[0][0])
        self.assertEqual(said[1], [])
        self.assertEqual(largest[0], 0)
        self.assertGreater(largest[1], 0)
        self.assertIn("thickness", kerf.BladeHandle.force.__doc__)


class Scenes(unittest.TestCase):
    def test_fields(self):
        scene = kerf.Scene(SCENE, young=8e4, set={"blade.0.thickness": "0.1", "blade.0.back": [0, 0, 1]})
        self.assertEqual(scene.material.young, 8e4)
        self.assertEqual(scene.blades[0].thickness, 0.1)
        self.assertEqual(scene.blades[0].name, "knife")
        self.assertEqual(scene.blades[0].points.shape, (17, 3))
        self.assertEqual(scene.bodies[0].nodes, 250)
        self.assertEqual((scene.frames, scene.frame_rate, scene.ground), (6, 24, True))
        np.testing.assert_allclose(scene.blades[0].keys[1], [0.5, 0.507, 0.5, -0.2, 0, 0, 1, 8])
        self.assertEqual(kerf.Scene(SCENE, model="stvk").material.model, "stvk")
        self.assertEqual(kerf.Scene(SCENE, refine=0.2).bodies[0].refine, 0.2)
        self.assertEqual(list(kerf.Scene(SCENE, gravity=np.array([0, -9, 0])).gravity), [0, -9, 0])
        self.assertEqual(kerf.parse_motion("0 1 2 3 0 0 1 90", "rows").shape, (1, 8))

    def test_refused(self):
        with self.assertRaisesRegex(kerf.InputError, "did you mean 'young'"):
            kerf.Scene(SCENE, yuong=3)
        with self.assertRaisesRegex(kerf.InputError, "material.young"):
            kerf.Scene(SCENE, young=-1)
        with self.assertRaisesRegex(kerf.InputError, "thickness"):
            kerf.Scene(SCENE, set={"blade.0.thicknes": 1})
        for bad in ({"set": {"blade.7.thickness": 1}}, {"young": float("nan")}, {"young": object()}, {"gravity": 3}):
            with self.assertRaises(kerf.InputError, msg=str(bad)):
                kerf.Scene(SCENE, **bad)
        for bad in (3, None, {"set": 3}):
            with self.assertRaises(TypeError):
                kerf.Scene(bad) if not isinstance(bad, dict) else kerf.Scene(SCENE, **bad)
        with self.assertRaises(kerf.MissingInputError):
            kerf.Scene("none.toml")
        with self.assertRaises(kerf.InputError):
            kerf.Scene("not\ntoml")
        with self.assertRaisesRegex(kerf.InputError, "zero byte"):
            kerf.Scene("\0")
        with self.assertRaisesRegex(kerf.InputError, "zero byte"):
            kerf.write_usd("none.usda", ["\0"], 24)


class Runs(unittest.TestCase):
    @unittest.skipUnless(shutil.which("kerf-sim", path=os.environ.get("KERF_TOOLS", "")), "needs kerf-sim in KERF_TOOLS")
    def test_frames_of_kerf_sim(self):
        """The same frames and checkpoint as kerf-sim, byte for byte, where Python gives the material."""
        tool = shutil.which("kerf-sim", path=os.environ.get("KERF_TOOLS", ""))
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            simulation(SCENE).write_frame(folder / "block.ply")  # frame 0: the model itself
            (folder / "scene.toml").write_text(SCENE)
            subprocess.run([tool, folder / "scene.toml", "-o", folder / "run", "--set", "material.young=8e4"], check=True,
                           capture_output=True)
            run = kerf.Simulation(folder / "scene.toml", young=8e4)
            for frame in range(7):
                run.write_frame(folder / "frame.ply")
                run.write_nodes(folder / "nodes.ply")
                for made, path in (("frame.ply", run_path(folder / "run/frames", frame)),
                                   ("nodes.ply", run_path(folder / "run/nodes", frame))):
                    self.assertEqual((folder / made).read_bytes(), path.read_bytes(), f"frame {frame}")
                if frame < 6:
                    run.step()
            run.save(folder / "checkpoint.kerf")
            self.assertEqual((folder / "checkpoint.kerf").read_bytes(), (folder / "run/checkpoint.kerf").read_bytes())
            again = kerf.Simulation.resume(folder / "run/checkpoint.kerf", folder / "scene.toml", young=8e4)
            self.assertEqual(again.frame, 6)
            with self.assertRaises(kerf.InputError):
                kerf.Simulation.resume(folder / "run/checkpoint.kerf", folder / "scene.toml", young=9e4)
            nodes, stress = kerf.read_frame_nodes(folder / "nodes.ply")
            np.testing.assert_allclose(nodes.positions, run.positions, atol=1e-6)
            np.testing.assert_allclose(stress, run.stress, rtol=1e-5, atol=1e-3)

    def test_driven_knife_cuts(self):
        run = simulation(set={"blade.0.keys": [[0, 0.503, 0.5, 1.05, 0, 0, 1, 4], [0.01, 0.503, 0.5, 1.05, 0, 0, 1, 4]]})
        knife = run.blade("knife")
        for z in np.linspace(0.9, -0.2, 5):
            turn = np.eye(4)
            turn[:3, 3] = [0.503, 0.5, z]
            knife.move(turn)
            run.step()
            np.testing.assert_allclose(knife.pose[0], [0.503, 0.5, z], atol=1e-12)
        self.assertGreater(run.total.split.edges_cut, 0)
        self.assertEqual(run.body.graph.components()[0], 2)
        self.assertTrue(run.body.check().good)
        self.assertEqual(knife.points.shape, (17, 3))

    def test_grip_and_snapshots(self):
        run = simulation()
        positions, surface, body = run.positions, run.surface(), run.body
        self.assertIs(run.positions, positions)
        self.assertIs(run.surface(), surface)
        before = positions.copy(), surface.vertices.copy()
        run.grip(0).move((0.1, 0, 0))
        run.step()
        np.testing.assert_array_equal(positions, before[0])
        np.testing.assert_array_equal(surface.vertices, before[1])
        held = (run.body.nodes.positions[:, 0] < 0.15)
        np.testing.assert_allclose(run.displacement[held], [[0.1, 0, 0]] * held.sum(), atol=1e-12)
        self.assertEqual(run.stress.shape, (len(run.body),))
        self.assertGreater(run.stress.max(), 0)
        self.assertIsNot(run.body, body)

    def test_momentum(self):
        free = SCENE[:SCENE.index("[[blade]]")].replace("[ground]\npoint = [0, 0, -0.02]\nstiffness = 4e3\n", "")
        run = simulation(free, velocity=[1, 2, 3], gravity=[0, 0, 0], damping=0)
        first, mass = run.momentum, run.solid().mass.sum()
        np.testing.assert_allclose(first, mass * np.array([1, 2, 3]), rtol=1e-9)
        run.run(2)
        np.testing.assert_allclose(run.momentum, first, rtol=1e-6)

    def test_resume(self):
        """A knife that Python moves, an interruption in the middle: the same frames, byte for byte."""
        def drive(run, steps):
            for z in steps:
                run.blade(0).move(((0.503, 0.5, z), (1, 0, 0, 0.01)))
                run.step()

        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            whole = simulation()
            drive(whole, (0.8, 0.6))
            whole.save(folder / "half.kerf")
            motions = whole.motions
            drive(whole, (0.4, 0.2))
            later = kerf.Simulation.resume(folder / "half.kerf", SCENE, models=model(), motions=motions)
            self.assertEqual(later.frame, 2)
            drive(later, (0.4, 0.2))
            whole.save(folder / "a.kerf")
            later.save(folder / "b.kerf")
            self.assertEqual((folder / "a.kerf").read_bytes(), (folder / "b.kerf").read_bytes())

    def test_simulate_is_a_run_to_the_end(self):
        frames = []
        made = kerf.simulate(SCENE, lambda run, stats: frames.append(run.frame), models=model())
        same = kerf.Simulation(SCENE, models=model())
        same.run()
        self.assertEqual(frames, [1, 2, 3, 4, 5, 6])
        np.testing.assert_array_equal(made.positions, same.positions)
        self.assertEqual(kerf.simulate(SCENE, lambda run, stats: run.frame < 2, models=model()).frame, 2)
        with self.assertRaises(kerf.Interrupted):
            kerf.simulate(SCENE, models=model(), progress=lambda phase, done, total: False)

    def test_run_and_stop(self):
        run, frames, reports = simulation(), [], []
        stats = run.run(2, progress=lambda *r: reports.append(r), each=lambda s, stats: frames.append((s.frame, s.time)))
        self.assertEqual([frame for frame, time in frames], [1, 2])
        self.assertEqual(stats.steps, 4)
        self.assertEqual(reports[-1][1], reports[-1][2])
        run.run(each=lambda s, stats: s.frame < 3)
        self.assertEqual(run.frame, 3)
        with self.assertRaises(kerf.Interrupted):
            run.run(progress=lambda *r: False)
        self.assertEqual(run.frame, 4)  # a stop leaves the run between two frames
        with self.assertRaises(KeyError):
            run.run(1, progress=lambda *r: {}["x"])

        def use(phase, done, total):
            with self.assertRaises(kerf.Error):
                run.positions

        run.run(1, progress=use)
        run.step()
        self.assertEqual(run.frame, 7)

    def test_files(self):
        run = simulation()
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            meshes = [run.surface()]
            run.run(2, each=lambda s, stats: meshes.append(s.surface()))
            kerf.write_usd(folder / "run.usda", meshes)
            self.assertIn("timeSamples", (folder / "run.usda").read_text())
            kerf.write_series(folder / "run.ply.series", ["a.ply", "b.ply"], 24)
            self.assertIn("b.ply", (folder / "run.ply.series").read_text())
            with self.assertRaises(kerf.InputError):
                kerf.write_usd(folder / "run.usda", [])
            with self.assertRaises(kerf.InputError):
                kerf.write_usd(folder / "run.usda", meshes, up="X")
            with self.assertRaises(kerf.InputError):
                kerf.write_frame_nodes(folder / "n.ply", run.body.nodes, [1.0])

    def test_refused(self):
        run = simulation()
        with self.assertRaisesRegex(kerf.InputError, "did you mean 'knife'"):
            run.blade("knive")
        with self.assertRaises(kerf.InputError):
            run.blade(1)
        with self.assertRaises(TypeError):
            run.blade(None)
        with self.assertRaises(kerf.InputError):
            run.obstacle(0)
        knife = run.blade(0)
        scaled = 2 * np.eye(4)
        scaled[3, 3] = 1
        for bad in ([1, 2], [1, 2, np.nan], scaled, -np.eye(4), np.zeros((4, 4)), ((0, 0, 0), (0, 0, 0, 0)), "here", None):
            with self.assertRaises(kerf.InputError, msg=str(bad)):
                knife.move(bad)
        with self.assertRaises(kerf.InputError):
            kerf.Simulation(SCENE, models=[model(), model()])
        with self.assertRaises(kerf.InputError):
            kerf.Simulation(SCENE, models=kerf.Mesh(*block()[:1], block()[1][1:]))
        with self.assertRaises(kerf.MissingInputError):
            kerf.Simulation(SCENE)
        with self.assertRaises((kerf.InputError, TypeError)):
            run.run(-1)


class Hands(unittest.TestCase):
    """What a script adds to a run, and the recording of it."""

    def act(self, run, dice, folder, frames):
        """Adds and changes at random; returns positions and surface after each frame."""
        cuts, springs, pins, seen = [], [], [], []
        for frame in range(frames):
            if dice.random() < 0.5:
                at = [dice.uniform(0.3, 0.7), 0.5, dice.uniform(0.6, 1.2)]
                wedge = {"thickness": 0.02, "back": [0, 0, 0.2]} if dice.random() < 0.5 else {}
                cuts.append((run.add_blade([[0, -0.8, 0], [0, 0.1, 0.003], [0, 0.8, 0.01]], (at, (1, 0, 0, 0.03)), limit=0.7, **wedge), at))
            if dice.random() < 0.5:
                at = [1, dice.uniform(0.2, 0.8), dice.uniform(0.2, 0.8)]
                node = int(np.argmin(np.linalg.norm(run.body.nodes.positions - at, axis=1))) if dice.random() < 0.5 else None
                springs.append((run.add_pull(at, at, stiffness=dice.uniform(10, 1e4), node=node), at))
            if dice.random() < 0.3:
                pins.append(run.add_grip([0.8, -0.1, -0.1], [1.1, 1.1, dice.uniform(0.1, 0.4)]))
            if pins and dice.random() < 0.4:
                dice.choice(pins).end()  # a second end() changes nothing
            if dice.random() < 0.3:
                run.change(young=dice.uniform(2e4, 8e4), gravity=[0, 0, dice.uniform(-9, 0)],
                           **({"friction": 0.2, "damping": 1, "accuracy": 0.02, "step": 0.03} if dice.random() < 0.5 else {}))
            cuts = [cut for cut in cuts if dice.random() < 0.8]  # the others end here
            for cut, at in cuts:
                at[2] -= dice.uniform(0, 0.2)
                cut.extend((at, (1, 0, 0, 0.03)))
            for spring, at in springs:
                spring.extend(np.add(at, [0.1, 0.05, 0.1]))
            run.step()
            if dice.random() < 0.3:
                run.save(folder / "half.kerf")  # the run goes on from what it has written
            seen.append((run.positions.copy(), run.surface().vertices.copy()))
        return seen

    def test_recordings_give_the_same_frames(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            cut = 0
            for seed in range(8):
                run = simulation(SCENE + LATER)
                seen = self.act(run, random.Random(seed), folder, 5)
                cut += run.total.split.edges_cut
                run.write_recording(folder / "recorded.toml")
                again = kerf.Simulation(folder / "recorded.toml", models=model())
                self.assertEqual(again.scene.frames, 5)
                for frame, (positions, surface) in enumerate(seen):
                    again.step()
                    self.assertEqual(again.positions.tobytes(), positions.tobytes(), f"seed {seed}, frame {frame}")
                    self.assertEqual(again.surface().vertices.tobytes(), surface.tobytes(), f"seed {seed}, frame {frame}")
            self.assertGreater(cut, 0)

    def test_kinds_of_vectors(self):
        self.assertEqual(kerf.vectors(), "widest")
        self.addCleanup(kerf.set_vectors, "widest")
        kerf.set_vectors("portable")
        self.assertEqual(kerf.vectors(), "portable")
        self.assertRaises(kerf.InputError, kerf.set_vectors, "narrow")
        self.assertEqual(kerf.vectors(), "portable")

    def test_blows(self):
        scene = SCENE.split("[[blade]]")[0]  # a blade in the body would be in the way
        def pieces_of(run):
            return run.body.complex().piece_count

        dice = random.Random(dice_seed := random.randrange(1 << 30))
        with tempfile.TemporaryDirectory() as name:
            path = pathlib.Path(name) / "recorded.toml"
            run = kerf.Simulation(scene, models=model())
            for _ in range(dice.randrange(3)):
                run.step()
            for bad in (lambda: run.strike([0, 0]), lambda: run.strike([0, 0, np.nan]), lambda: run.strike([0, 0, 1], cells=1)):
                self.assertRaises(kerf.InputError, bad)
            run.strike([dice.random(), dice.random(), 1], cells=8)
            pieces = pieces_of(run)
            self.assertGreater(pieces, 1, f"seed {dice_seed}")
            run.step()
            run.write_recording(path)
            again = kerf.Simulation(path, models=model())
            for _ in range(again.scene.frames):
                again.step()
            self.assertEqual(pieces_of(again), pieces, f"seed {dice_seed}")
            self.assertEqual(again.surface().vertices.tobytes(), run.surface().vertices.tobytes(), f"seed {dice_seed}")

    @unittest.skipUnless(shutil.which("kerf-sim", path=os.environ.get("KERF_TOOLS", "")), "needs kerf-sim in KERF_TOOLS")
    def test_kerf_sim_replays_a_recording(self):
        tool = shutil.which("kerf-sim", path=os.environ.get("KERF_TOOLS", ""))
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "scene.toml").write_text(SCENE)
            model().save(folder / "block.ply")
            run = kerf.Simulation(folder / "scene.toml")
            self.act(run, random.Random(3), folder, 4)
            run.write_frame(folder / "frame.ply")
            run.write_recording(folder / "recorded.toml")
            subprocess.run([tool, folder / "recorded.toml", "-o", folder / "run"], check=True, capture_output=True)
            self.assertEqual((folder / "frame.ply").read_bytes(), run_path(folder / "run/frames", 4).read_bytes())

    def test_what_is_added(self):
        run = simulation()
        pin = run.add_grip([0.8, -0.1, -0.1], [1.1, 1.1, 0.3])
        blade = run.add_blade([[0, -0.8, 0], [0, 0.8, 0]], [0.5, 0, 1.2], name="mine")
        spring = run.add_pull([1, 0.5, 0.5], [1, 0.5, 0.5], stiffness=100, node=3)
        self.assertEqual((run.blade("mine").index, blade.name, blade.index, pin.index, spring.index), (1, "mine", 1, 1, 0))
        self.assertEqual((spring.node, spring.stiffness), (3, 100))
        spring.extend([2, 0.5, 0.5])
        blade.extend([0.5, 0, 0.7])
        for late in (lambda: blade.extend([0.5, 0, 0.6]), lambda: run.blade("knife").extend([0.5, 0, 0.6])):
            with self.assertRaisesRegex(kerf.InputError, "has a key later than now"):
                late()
        run.step()
        self.assertLess(spring.force[0], 0)  # it is pulled back
        self.assertEqual((len(spring.keys), len(blade.keys)), (2, 2))
        run.step()
        with self.assertRaisesRegex(kerf.InputError, "blade does not exist now"):
            blade.extend([0.5, 0, 0.6])
        with self.assertRaisesRegex(kerf.InputError, "pull does not exist now"):
            spring.extend([2, 0.5, 0.5])

    def test_stitches(self):
        free = SCENE[:SCENE.index("[[blade]]")]
        run = simulation(free, gravity=[0, 0, 0])
        stitch = run.add_stitch([0.1, 0.5, 0.5], [0.9, 0.5, 0.5], stiffness=1e3, length=0.4, closing=0.05)
        self.assertEqual((stitch.index, stitch.force), (0, 0))
        run.run(4)
        self.assertGreater(stitch.force, 0)
        self.assertEqual(run.last.stitch_force, [stitch.force])
        with tempfile.TemporaryDirectory() as name:
            run.write_recording(pathlib.Path(name) / "x.toml")
            self.assertIn("[[stitch]]", (pathlib.Path(name) / "x.toml").read_text())
        stitch.end()
        run.run(1)
        self.assertEqual(stitch.force, 0)
        for bad in (dict(length=-1), dict(node_a=10**6), dict(closing=float("nan"))):
            with self.assertRaises(kerf.InputError):
                run.add_stitch([0, 0, 0], [1, 0, 0], **bad)

    def test_changes_hold_up_to_the_next_of_the_scene(self):
        free = SCENE[:SCENE.index("[[blade]]")].replace("[ground]\npoint = [0, 0, -0.02]\nstiffness = 4e3\n", "")
        run = simulation(free + LATER, gravity=[0, 0, 0], damping=0)
        run.change(gravity=[0, 0, -1])
        run.run(2)
        mass = run.solid().mass.sum()
        self.assertAlmostEqual(run.momentum[2] / mass, -run.time, places=6)
        run.run(2)
        self.assertGreater(run.momentum[2], 0)  # the scene lets gravity act upwards from 0.09 s on

    def test_checkpoints_do_not_hold_what_was_added(self):
        with tempfile.TemporaryDirectory() as name:
            path = pathlib.Path(name) / "a.kerf"
            run = simulation()
            run.save(path)
            later = kerf.Simulation.resume(path, SCENE, models=model())
            with self.assertRaisesRegex(kerf.InputError, "was resumed"):
                later.write_recording(pathlib.Path(name) / "x.toml")
            for act in (lambda: run.change(young=1e4), lambda: run.add_grip([0, 0, 0], [1, 1, 0]), lambda: run.grip(0).end()):
                run = simulation()
                act()
                run.save(path)
                with self.assertRaisesRegex(kerf.InputError, "another scene"):
                    kerf.Simulation.resume(path, SCENE, models=model())

    def test_refused(self):
        run, line = simulation(), [[0, -1, 0], [0, 1, 0]]
        for bad in (lambda: run.add_blade(line[:1], [0, 0, 0]), lambda: run.add_blade(line, [0, 0]), lambda: run.add_blade(line, [0, 0, 0], closed=True),
                    lambda: run.add_blade(line, [0, 0, 0], thickness=0.1), lambda: run.add_blade(line, [0, 0, 0], limit=0),
                    lambda: run.add_grip([0, 0, 1], [1, 1, 0]), lambda: run.add_pull([0, 0, 0], [0, 0, 0], stiffness=-1),
                    lambda: run.add_pull([0, 0, 0], [0, 0, 0], node=10**6), lambda: run.change(young=-1), lambda: run.change(step=0),
                    lambda: run.change(gravity=[0, 1])):
            with self.assertRaises(kerf.InputError):
                bad()
        with self.assertRaisesRegex(TypeError, "young"):
            run.change(yuong=1)
        with self.assertRaises(TypeError):
            run.add_blade(line, [0, 0, 0], thicknes=1)
        with tempfile.TemporaryDirectory() as name:  # nothing was added
            run.write_recording(pathlib.Path(name) / "x.toml")
            text = (pathlib.Path(name) / "x.toml").read_text()
            self.assertEqual([text.count(f"[[{kind}]]") for kind in ("blade", "grip", "pull", "change")], [1, 1, 0, 0])
        with self.assertRaises(kerf.OutputError):
            run.write_recording("")
        self.assertEqual((run.add_pull([1, 0, 0], [1, 0, 0]).index, run.add_grip([0, 0, 0], [1, 1, 0]).index), (0, 1))
        run.blade(0).move([0, 0, 3])
        with self.assertRaisesRegex(kerf.InputError, "move\\(\\) was called"):
            run.write_recording("x.toml")
        self.assertFalse(os.path.exists("x.toml"))

    def test_touching_bodies(self):
        scene = "[[body]]\nmesh = 'a'\nnodes = 40\n[[body]]\nmesh = 'b'\nnodes = 40\nposition = [0, 0, HEIGHT]\n[time]\nframes = 1\n"
        block = kerf.shapes.block()
        height = float(np.ptp(block.vertices[:, 2]))
        run = kerf.Simulation(scene.replace("HEIGHT", str(height)), models=[block, block])
        self.assertIn("touch", run.touching)
        self.assertEqual(kerf.Simulation(scene.replace("HEIGHT", str(height + 1)), models=[block, block]).touching, "")
        with self.assertRaisesRegex(kerf.InputError, r"body1 \(a\) and body2 \(b\) overlap"):
            kerf.Simulation(scene.replace("HEIGHT", str(height / 2)), models=[block, block])


def run_path(folder, frame):
    """The file of a frame in a folder of kerf-sim."""
    return sorted(folder.iterdir())[frame]


if __name__ == "__main__":
    unittest.main()
