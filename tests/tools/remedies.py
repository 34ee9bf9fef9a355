#!/usr/bin/env python3
"""Every message that names a command or an option as a remedy is made, its remedy is executed, and the next command succeeds.

    remedies.py TOOLS_DIR SAMPLES_DIR [PYTHON_DIR]

Messages are found in the sources: a new one without a case here fails the test, and so does a case without a message. Cases of the
Python module run where PYTHON_DIR holds it.
"""
import json
import math
import os
import pathlib
import random
import re
import socket
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
TOOLS = "repair|sample|graph|score|crack|update|pieces|info|sim|live|view|dataset"
# A tool, an option, a class of the module, or an argument of one.
REMEDY = re.compile(rf"(?<![\w/.-])kerf-(?:{TOOLS})\b(?!:)|(?<![\w-])--[a-z][a-z-]+|kerf\.[A-Z]\w*\.\w+\(|\bvoxel=")
# Literals in these calls describe options, or document functions.
DESCRIPTION = re.compile(r"\b(option|flag|choice|argument|output|output_option|add_flag|add_option|Tool t|def\w*)\s*\(|_doc\b|class_|module|Tool::Tool")
# Literals that are no sentence: an option whose value is wrong, the name of a tool, a piece of a command line.
NO_SENTENCE = re.compile(rf"^(--|-\w,--)|^ *(\| )?kerf-({TOOLS}) *$|^ --[a-z-]+ *(- -o broken\.ply)?(\\n)?$|^  kerf-|^ --help")

# Messages that no test can make, or that name an option without telling anyone to use it.
EXEMPT = {
    "an array of a shard has more than 4 GB; give less --per-shard": "needs an array of 4 GB",
    "there are no nodes; make some with kerf-sample": "the tools refuse a file without nodes before",
    "run again with --repro FILE to keep the case": "a step that cannot be made is a fault of the library, and none is known",
    " below --least without a bond, left as found": "says which pieces remain; nothing is to be done",
    "; try another --voxel": "no surface is known that cannot be wrapped at some size",
    ": its triangles are not those of the frames before; run kerf-sim again": "needs a run whose files were exchanged by hand",
    "not here; use the address that kerf-live has printed": "an answer to a browser; tests/live has it",
    ": is a scene, which names other files: start kerf-live with it": "an answer to a browser, which drops a file",
    " s (--linger), so it ends": "says why the program ends; nothing is to be done",
    "kerf-live has ended": "a goodbye to a browser; tests/live has it",
    "Of a .glb: names of its hulls: ": "describes an option",
    "With --voxel, parts with open edges: ": "describes an option",
    ", the same bytes as kerf-sim's. Raises OutputError.": "describes a function",
    "; choose another --iso, --adaptivity 0 or smaller voxels": "needs a volume whose surface is no solid",
    ": has no field 'stress'; kerf-sim writes it": "needs a run whose files were exchanged by hand",
    ": was cut after its run's checkpoint.kerf was written, or is of another run; bring the run to its end with kerf-sim --resume":
        "needs a run that ended between a cut and the checkpoint after it",
}
CASES = {}


def case(*messages):
    """Registers a function for messages, each given by a part of it."""
    def register(function):
        for message in messages:
            CASES[message] = function
        return function
    return register


def literals():
    """(file, text) of each string literal of the sources that names a remedy; adjacent literals are joined."""
    literal = re.compile(r'(?:"(?:[^"\\\n]|\\.)*"\s*)+')
    for folder in ("libgeo", "tools", "python/src"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix not in (".cpp", ".h"):
                continue
            code = re.sub(r"//[^\n]*", lambda m: " " * len(m[0]), path.read_text())
            for match in literal.finditer(code):
                text = "".join(re.findall(r'"((?:[^"\\\n]|\\.)*)"', match[0]))
                before = code[:match.start()]
                statement = before[max(before.rfind(c) for c in ";{}") + 1:]
                if REMEDY.search(text) and not NO_SENTENCE.search(text) and not DESCRIPTION.search(statement):
                    yield path.relative_to(ROOT), text


def run(command, status=0, given=None):
    """Standard output and error of a command line, which must end with this exit code."""
    done = subprocess.run(command, shell=True, capture_output=True, text=True, input=given, timeout=300, executable="/bin/bash")
    assert (done.returncode == 0) == (status == 0), f"{command}: exits with {done.returncode}: {done.stderr}"
    return done.stdout, done.stderr


def said(command, pattern, status=1):
    """The match of a pattern in what a command says on standard error."""
    text = run(command, status)[1]
    match = re.search(pattern, text)
    assert match, f"{command} does not say {pattern!r} but: {text}"
    return match


def box(path, *boxes, faces=slice(None), flipped=()):
    """Writes boxes (low corner, size) as an OBJ; `faces`: of the last; `flipped`: indices of boxes inside out."""
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6)]
    lines, rows = [], []
    for k, (low, size) in enumerate(boxes):
        lines += [f"v {low[0] + i % 2 * size} {low[1] + i // 2 % 2 * size} {low[2] + i // 4 * size}" for i in range(8)]
        own = [[8 * k + v + 1 for v in (quad[::-1] if k in flipped else quad)] for quad in quads]
        rows += own[faces] if k == len(boxes) - 1 else own
    pathlib.Path(path).write_text("\n".join(lines + ["f " + " ".join(map(str, row)) for row in rows]) + "\n")


def scene(path, text, frames=1):
    pathlib.Path(path).write_text(f"{text}\n[material]\nyoung = 1e5\n[time]\nframes = {frames}\n")


# ---- Surfaces that are no solids


@case(", or try kerf-repair")
def try_repair():
    inner = ((1, 1, 1), 1)
    surfaces = {
        "open.obj": dict(boxes=[((0, 0, 0), 1)], faces=slice(0, 5)),
        "inverted.obj": dict(boxes=[((0, 0, 0), 1)], flipped=(0,)),
        "beside.obj": dict(boxes=[((0, 0, 0), 1), ((3, 0, 0), 1)], flipped=(1,)),
        "cavity.obj": dict(boxes=[((0, 0, 0), 3), inner]),
        "deep.obj": dict(boxes=[((0, 0, 0), 3), ((0.5, 0.5, 0.5), 2), inner], flipped=(1, 2)),
        "touch.obj": dict(boxes=[((0, 0, 0), 1), ((1, 0, 0), 1)]),
        "same.obj": dict(boxes=[((0, 0, 0), 1), ((0, 0, 0), 1)]),
        "coincident.obj": dict(boxes=[((0, 0, 0), 1), ((0, 0, 0), 1)], flipped=(1,)),
        "crossing.obj": dict(boxes=[((0, 0, 0), 1), ((0.5, 0.5, 0.5), 1)]),
    }
    scene("s.toml", "[body]\nmesh = 'MODEL'\nnodes = 40")
    box("plane.obj", ((-5, -5, 0.25), 20), faces=slice(0, 1))  # a sheet through all of them
    for name, surface in surfaces.items():
        box(name, *surface["boxes"], faces=surface.get("faces", slice(None)), flipped=surface.get("flipped", ()))
        users = ["kerf-info --check {}", "kerf-crack {} --jagged 0.1 -o x.ply", "kerf-score {} --pieces 6 -o x.front", "kerf-pieces {} -o x.glb",
                 "kerf-crack {} --sheet plane.obj -o x.ply", "kerf-sample {} --count 40 -o x.pcd", "sed s/MODEL/{}/ s.toml >own.toml; rm -rf x; kerf-sim own.toml -o x"]
        for command in users:
            tool = said(command.format(name), r"or try (kerf-repair)\n")[1]
            run(f"{tool} {name} -o solid.ply")
            run(command.format("solid.ply"))
        if name == "beside.obj":
            # Crack faces are inside both boxes, and nowhere else.
            figures = json.loads(run("kerf-crack solid.ply --sheet plane.obj -o x.ply && kerf-info --check --json x.ply")[0])
            assert figures["pieces"] == 4 and figures["volume"] == 2 and abs(figures["area"] - 16) < 1e-12, figures
        for leftover in ("x.ply", "x.front", "x.glb", "x.pcd"):
            pathlib.Path(leftover).unlink(missing_ok=True)


@case("in solid material, oriented like it, left out as hidden (--inner cavities makes ", " (--inner oriented leaves ",
      "; kerf-repair with that option, instead of --repair, decides otherwise")
def inner_shells():
    box("cavity.obj", ((0, 0, 0), 3), ((1, 1, 1), 1))
    volume = lambda path: json.loads(run(f"kerf-info --check --json {path}")[0])["volume"]
    option = said("kerf-repair cavity.obj -o filled.ply", r"1 shell .*left out as hidden \((--inner cavities) makes it a cavity\)", 0)[1]
    assert volume("filled.ply") == 27
    other = said(f"kerf-repair cavity.obj {option} -o hollow.ply", r"made a cavity \((--inner oriented) leaves it out\)", 0)[1]
    assert volume("hollow.ply") == 26
    run(f"kerf-repair cavity.obj {other} -o again.ply")
    assert volume("again.ply") == 27
    text = said("kerf-crack cavity.obj --repair --jagged 0.05 -o x.ply", r"\((--inner cavities) makes.*; (kerf-repair) with that option", 0)
    run(f"{text[2]} cavity.obj {text[1]} -o solid.ply && kerf-crack solid.ply --jagged 0.05 -o x.ply")


@case("has fewer than ten points without outliers; give --outliers 0")
def scan_of_few_points():
    places = [(1, 0.9, 0.8), (1, -1, 0.9), (-1, 1, 1), (-1, -1, 1.1), (1, 1, -1), (1, -0.8, -1), (-1, 1.2, -1), (-1, -1, -0.9), (1.4, 0, 0), (-1.6, 0, 0), (0, 1.5, 0), (0, -1.4, 0)]
    pathlib.Path("few.xyz").write_text("".join(f"{x} {y} {z} {x} {y} {z}\n" for x, y, z in places))
    option = said("kerf-repair few.xyz --outliers 0.001 -o x.ply", r"give (--outliers 0)\n")[1]
    run(f"kerf-repair few.xyz {option} -o solid.ply && kerf-info --check solid.ply")


@case(": has points without faces; make a solid of it: kerf-repair ")
def scan_for_a_surface():
    rng, points = random.Random(3), []
    for _ in range(3000):
        p = [rng.gauss(0, 1) for _ in range(3)]
        length = math.hypot(*p)
        points.append(" ".join(f"{x / length:.6f}" for x in p + p))
    pathlib.Path("ball.xyz").write_text("\n".join(points) + "\n")
    run(said("kerf-score ball.xyz --pieces 3 -o x.front", r"make a solid of it: (kerf-repair ball.xyz -o solid.ply), in Python")[1])
    run("kerf-score solid.ply --pieces 3 -o x.front")


@case("; wrap it in a new surface: --voxel 0.005")
def wrap():
    pathlib.Path("sheet.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    pathlib.Path("card.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0.2\nv 0 1 0.2\nf 1 2 3\nf 1 3 4\nf 1 3 2\nf 1 4 3\n")
    for name in ("sheet.obj", "card.obj"):
        option = said(f"kerf-repair {name} -o x.ply", r"wrap it in a new surface: (--voxel [0-9.]+)\n")[1]
        run(f"kerf-repair {name} {option} -o solid.ply && kerf-info --check solid.ply && kerf-crack solid.ply --jagged 0.1 -o x.ply")


@case("; wrap it in a new surface first: kerf-repair --voxel 0.005")
def wrap_first():
    pathlib.Path("sheet.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    command = said("kerf-crack sheet.obj --repair --jagged 0.1 -o x.ply", r"wrap it in a new surface first: (kerf-repair --voxel [0-9.]+)\n", 65)[1]
    run(f"{command} sheet.obj -o solid.ply && kerf-crack solid.ply --repair --jagged 0.1 -o x.ply")


@case(" one voxel thick (--open closed closes holes instead)", "(--open sheets leaves holes open)")
def open_parts():
    box("vessel.obj", ((0, 0, 0), 1), faces=slice(0, 5))
    volume = lambda path: json.loads(run(f"kerf-info --check --json {path}")[0])["volume"]
    option = said("kerf-repair vessel.obj --voxel 0.02 -o full.ply", r"\((--open sheets) leaves holes open\)", 0)[1]
    assert volume("full.ply") > 0.9
    other = said(f"kerf-repair vessel.obj --voxel 0.02 {option} -o shell.ply", r"made a plate one voxel thick \((--open closed) closes", 0)[1]
    assert volume("shell.ply") < 0.3
    run(f"kerf-repair vessel.obj --voxel 0.02 {other} -o again.ply")
    assert volume("again.ply") > 0.9


# ---- Bodies, nodes and graphs


@case("'; nodes come from kerf-sample", ": is a body (.kerf), which has its nodes already; give those of kerf-sample")
def nodes_of_another_tool():
    run("kerf-model block --edge 0.25 -o block.ply")
    run("kerf-sample block.ply --count 60 | kerf-graph --surface block.ply -o ok.kerf")
    for wrong in ("block.ply", "ok.kerf"):
        tool = said(f"kerf-graph {wrong} --surface block.ply -o x.kerf", r"(kerf-sample)\n")[1]
        run(f"{tool} block.ply --count 60 -o nodes.pcd && kerf-graph nodes.pcd --surface block.ply -o x.kerf")
    pathlib.Path("wrong.pcd").write_text("VERSION .7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n0 0 0\n")
    said("kerf-graph wrong.pcd --surface block.ply -o x.kerf", r"nodes come from kerf-sample\n")


@case(": is not a .kerf file; make one with kerf-graph")
def make_a_body():
    run("kerf-model block --edge 0.25 -o block.ply")
    run("kerf-crack block.ply --jagged 0.02 -o cut.ply")
    tool = said("kerf-update block.ply --surface cut.ply -o x.kerf", r"make one with (kerf-graph)")[1]
    run(f"kerf-sample block.ply --count 60 | {tool} --surface block.ply -o body.kerf && kerf-update body.kerf --surface block.ply -o x.kerf")


@case("give the model with --surface", "give the cut surface with --surface")
def give_the_surface():
    run("kerf-model block --edge 0.25 -o block.ply && kerf-sample block.ply --count 60 -o nodes.pcd")
    option = said("kerf-graph nodes.pcd -o x.kerf", r"give the model with (--surface)")[1]
    run(f"kerf-graph nodes.pcd {option} block.ply -o body.kerf")
    option = said("kerf-update body.kerf -o x.kerf", r"give the cut surface with (--surface)")[1]
    run(f"kerf-update body.kerf {option} block.ply -o x.kerf")


@case("give a positive --count or a --spacing, not both", "choose a smaller --spacing", ", or --min-across 0 if that is meant")
def sampling():
    run("kerf-model block --edge 0.25 -o block.ply")
    options = said("kerf-sample block.ply --count 60 --spacing 10% -o x.pcd", r"give a positive (--count) or a (--spacing), not both")
    run(f"kerf-sample block.ply {options[1]} 60 -o x.pcd")
    run(f"kerf-sample block.ply {options[2]} 10% -o x.pcd")
    box("thin.obj", ((0, 0, 0), 1))
    pathlib.Path("thin.obj").write_text(re.sub(r"^(v \S+ \S+) 1\b.*$", r"\1 0.05", pathlib.Path("thin.obj").read_text(), flags=re.M))
    said("kerf-sample thin.obj --spacing 30% --min-across 5 -o x.pcd", r"choose a smaller (--spacing), or (--min-across 0) if that is meant", 0)
    assert not run("kerf-sample thin.obj --spacing 4% --min-across 5 -o x.pcd")[1]
    assert not run("kerf-sample thin.obj --spacing 30% --min-across 0 -o x.pcd")[1]


# ---- Cracks and scores


@case(" time steps; change --steps")
def steps():
    run("kerf-model block --edge 0.25 -o block.ply && kerf-model front --around block.ply --steps 3 -o halve.front")
    match = said("kerf-crack block.ply --front halve.front --steps 7:9 -o x.ply", r"has only (\d+) time steps; change (--steps)")
    run(f"kerf-crack block.ply --front halve.front {match[2]} 0:{match[1]} -o x.ply")


@case("give at least one --front, --sheet, --jagged or --decimate")
def something_to_cut():
    run("kerf-model block --edge 0.25 -o block.ply && kerf-model front --around block.ply --steps 3 -o halve.front")
    options = said("kerf-crack block.ply -o x.ply", r"give at least one (--front), (--sheet), (--jagged) or (--decimate)")
    run(f"kerf-crack block.ply {options[1]} halve.front -o x.ply && kerf-crack block.ply {options[3]} 0.1 -o x.ply")


@case("; give a file with colours of vertices, or another --density", "; edges have room for more of a smaller --chip-size")
def densities_and_chips():
    run("kerf-model block --edge 0.5 -o block.ply")
    said("kerf-score block.ply --density red -o x.front", r"give a file with colours of vertices, or another --density")
    run("kerf-score block.ply --density x --pieces 6 -o x.front")
    wanted = "kerf-score block.ply --pieces 2 --chips 40 -o x.front"
    match = said(wanted, r"edges have room for more of a smaller (--chip-size)", 0)
    assert not run(f"{wanted} {match[1]} 0.03")[1]


@case("' is a sheet, not a curve; give it with --sheets", "; another --seed or more --attempts may find them", " goes with --pattern curves; add it")
def scores():
    run("kerf-model block --edge 0.25 -o block.ply && kerf-score block.ply --pieces 3 -o walls.front")
    said("kerf-score block.ply --pattern curves --curves walls.front -o x.front", r"is a sheet, not a curve; give it with --sheets")
    pathlib.Path("sheet.obj").write_text("v -1 -1 0.3\nv 2 -1 0.3\nv 2 2 0.3\nv -1 2 0.3\nf 1 2 3 4\n")
    run("kerf-score block.ply --pattern sheets --sheets sheet.obj -o x.front")
    pathlib.Path("line.obj").write_text("v 0.4 -1 0\nv 0.4 2 0\nl 1 2\n")
    wanted = "kerf-score block.ply --curves line.obj -o x.front"
    run(f"{wanted} {said(wanted, r'--curves goes with (--pattern curves); add it')[1]}")
    wanted = "kerf-score block.ply --pattern glass --pieces 11 -o x.front"
    match = said(f"{wanted} --attempts 1", r"another (--seed) or more (--attempts) may find them", 0)
    answers = [run(f"{wanted} {match[2]} 60")[1], *(run(f"{wanted} {match[1]} {seed}")[1] for seed in range(2, 8))]
    assert not all(answers), answers


# ---- Information and pictures


@case("give one of --diff, --compact, --export, --node, --edge and --vertex", "give one file to --compact, --export, --node, --edge and --vertex")
def one_question():
    run("kerf-model block --edge 0.25 -o block.ply && kerf-sample block.ply --count 60 | kerf-graph --surface block.ply -o ok.kerf && cp ok.kerf two.kerf")
    said("kerf-info ok.kerf --node 1 --vertex 1", r"give one of --diff")
    said("kerf-info ok.kerf two.kerf --node 1", r"give one file to --compact")
    run("kerf-info ok.kerf --node 1 && kerf-info ok.kerf --vertex 1 && kerf-info --diff ok.kerf two.kerf")


@case(": holds no frames; give the folder that kerf-sim wrote", ": holds a run already; go on with --resume, remove it, or give another folder")
def runs():
    run("kerf-model block --edge 0.25 -o block.ply")
    scene("s.toml", "[body]\nmesh = 'block.ply'\nnodes = 60", frames=2)
    os.mkdir("empty")
    said("kerf-view empty -o x.png", r"give the folder that kerf-sim wrote")
    run("kerf-sim s.toml -o run && kerf-view run -o x.png")
    option = said("kerf-sim s.toml -o run", r"go on with (--resume), remove it, or give another folder")[1]
    run(f"kerf-sim s.toml -o run {option} && kerf-sim s.toml -o other && rm -r run && kerf-sim s.toml -o run")


@case("was begun without --portable; leave it out, or give another folder")
def kinds_of_vectors():
    run("kerf-model block --edge 0.25 -o block.ply")
    scene("s.toml", "[body]\nmesh = 'block.ply'\nnodes = 60", frames=2)
    run("kerf-sim s.toml -o run --frames 1")
    said("kerf-sim s.toml -o run --resume --portable", r"leave it out, or give another folder")
    run("kerf-sim s.toml -o run --resume && kerf-sim s.toml -o other --resume --portable")


@case(", or kerf-repair --edge ")
def coarse_models():
    box("box.obj", ((0, 0, 0), 1))
    scene("s.toml", "[body]\nmesh = 'box.obj'\nnodes = 300")
    command = said("kerf-sim s.toml -o run", r"(kerf-repair --edge [0-9.e-]+), gives it more", 0)[1]
    refine = said("kerf-sim s.toml -o told", r"body.refine = ([0-9.e-]+), or", 0)[1]
    assert "gives it more" not in run(f"kerf-sim s.toml --set body.refine={refine} -o refined")[1]
    run(f"{command} box.obj -o fine.ply")
    scene("s.toml", "[body]\nmesh = 'fine.ply'\nnodes = 300")
    assert "kerf-repair" not in run("kerf-sim s.toml -o finer")[1]
    # A plate with one node across it; the spacing that the line names has two.
    run("kerf-model plate --edge 0.1 -o plate.ply")
    scene("p.toml", "gravity = [0, 0, 0]\n[body]\nmesh = 'plate.ply'\nspacing = 0.1")
    spacing = said("kerf-sim p.toml -o plate", r"body.spacing = ([0-9.e-]+) is needed", 0)[1]
    said("kerf-sim p.toml --strict -o strict", r"--strict: 1 thing not as asked for")
    assert "is needed" not in run(f"kerf-sim p.toml --strict --set body.spacing={spacing} -o plate2")[1]


@case(": states no unit; one is taken as a metre, and --unit gives another")
def units():
    run("kerf-model block --edge 0.5 -o block.ply && kerf-model front --around block.ply -o k.front")
    run("kerf-crack block.ply --front k.front -o cut.ply")
    option = said("kerf-pieces cut.ply -o pieces.usda", r"and (--unit) gives another", 0)[1]
    assert "states no unit" not in run(f"kerf-crack block.ply --front k.front {option} mm -o mm.ply && kerf-pieces mm.ply -o mm.usda")[1]


@case("; give another --address or --port")
def a_port_in_use():
    run("kerf-model block --edge 0.25 -o block.ply")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        option = said(f"kerf-live block.ply --no-browser --linger 1 --port {taken.getsockname()[1]}", r"give another --address or (--port)")[1]
    live = subprocess.Popen(["kerf-live", "block.ply", "--no-browser", option, "0"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        assert "http://" in live.stdout.readline()
    finally:
        live.terminate()
        live.wait()


# ---- Scenes whose bodies touch or overlap: remedies without the name of a command


def touching_bodies():
    run("kerf-model block --edge 0.5 -o block.ply")
    place = lambda z: scene("s.toml", f"[[body]]\nmesh = 'block.ply'\nnodes = 40\n[[body]]\nmesh = 'block.ply'\nnodes = 40\nposition = [0, 0, {z}]\n"
                                      "[contact]\nself = true")
    place(0.9)
    depth = float(said("kerf-sim s.toml -o x", r"body1 \(block.ply\) and body2 \(block.ply\) overlap, about ([0-9.e-]+) deep; move one")[1])
    place(0.9 + depth)
    assert re.search(r"body1 \(block.ply\) and body2 \(block.ply\) touch", run("kerf-sim s.toml -o x")[1])
    run("kerf-info --check s.toml")


# ---- Data sets


@case(", which --repair may mend")
def refused_models():
    box("open.obj", ((0, 0, 0), 1), faces=slice(0, 5))
    wanted = "kerf-dataset open.obj --seeds 1 --pieces 2 --split 100,0,0"
    run(f"{wanted} {said(f'{wanted} -o refused', r'1 model refused, which (--repair) may mend')[1]} -o mended")


@case("give more, or another --split")
def empty_sets():
    run("kerf-model apple --frequency 3 -o a.ply && cp a.ply b.ply && cp a.ply c.ply")
    told = "test.txt is empty: .*give more, or another --split"
    said("kerf-dataset a.ply b.ply --seeds 1 --pieces 2 -o few", told, 0)
    for remedy in ("a.ply b.ply c.ply", "a.ply b.ply --split 50,50,0"):
        assert "empty" not in run(f"rm -rf made && kerf-dataset {remedy} --seeds 1 --pieces 2 -o made")[1]


# ---- The module


def module_cases(folder):
    code = """
import kerf, re
from kerf import Mesh, Solid
quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6)]
box = [[i % 2, i // 2 % 2, i // 4] for i in range(8)]
faces = [f for a, b, c, d in quads for f in ((a, b, c), (a, c, d))]
def message(call):
    try:
        call()
    except kerf.InputError as error:
        return str(error)
    raise AssertionError("nothing is refused")
for wrong in (faces[:-1], [f[::-1] for f in faces]):
    for call in (lambda: Solid(box, wrong), lambda: Solid(Mesh(box, wrong))):
        assert "or try kerf.Solid.repaired()" in message(call)
    assert Solid.repaired(Mesh(box, wrong)).volume == 1
both = Mesh(box + [[x + 3, y, z] for x, y, z in box], faces + [[v + 8 for v in f[::-1]] for f in faces])
assert "shell 2" in message(lambda: Solid(both)) and Solid.repaired(both).volume == 2
hollow = Mesh([[3 * x for x in p] for p in box] + [[x + 1 for x in p] for p in box], faces + [[v + 8 for v in f] for f in faces])
assert "shell 2" in message(lambda: Solid(hollow))
assert [Solid.repaired(hollow, inner=inner).volume for inner in ("oriented", "cavities", "filled")] == [27, 26, 27]
sheet = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
remedy = re.search(r"voxel=([0-9.]+) \\* diagonal", message(lambda: Solid.repaired(sheet)))
assert Solid.repaired(sheet, voxel=float(remedy[1]) * 2 ** 0.5).volume > 0
cut = Solid(box, faces).crack(Mesh([[-1, -1, .5], [2, -1, .5], [2, 2, .5], [-1, 2, .5]], [[0, 1, 2], [0, 2, 3]]))
cut.save("cut.ply")
assert "kerf.Complex.load()" in message(lambda: Solid.load("cut.ply"))
assert len(kerf.Complex.load("cut.ply").pieces()) == 2
"""
    done = subprocess.run([sys.executable, "-c", code], env={**os.environ, "PYTHONPATH": folder, "PYTHONDONTWRITEBYTECODE": "1"}, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


IN_MODULE = ("; wrap it in a new surface: voxel=0.005 * diagonal", ", or try kerf.Solid.repaired()", ": is cut already; give it to kerf.Complex.load()")


def main():
    tools, samples = (str(pathlib.Path(p).resolve()) for p in sys.argv[1:3])
    module = str(pathlib.Path(sys.argv[3]).resolve()) if len(sys.argv) > 3 else ""
    os.environ["PATH"] = f"{tools}:{samples}:{os.environ['PATH']}"
    failed = []
    known = [m for m in (*CASES, *EXEMPT, *IN_MODULE)]
    found = list(literals())
    failed += [f"{path}: the remedy of this message has no case: {text!r}" for path, text in found if not any(m in text for m in known)]
    failed += [f"no source has this message: {m!r}" for m in known if not any(m in text for _, text in found)]
    functions = [*dict.fromkeys(CASES.values()), touching_bodies]
    if module and pathlib.Path(module, "kerf").is_dir():
        functions.append(lambda: module_cases(module))
    for function in functions:
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                function()
            except (AssertionError, subprocess.TimeoutExpired) as error:
                failed.append(f"{function.__name__}: {error}")
            os.chdir("/")
    print("\n".join(failed))
    print(f"{len(found)} messages, {len(functions)} cases, {len(failed)} failures")
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main())
