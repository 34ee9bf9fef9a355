"""Kerf by its command-line tools: kerf-score, kerf-crack, kerf-pieces and kerf-repair, with files in a temporary folder."""

import json
import os
import re
import shutil
import subprocess
import tempfile
import threading

import numpy

from . import arrays, ply, png
from .backend import Bond, Failed, Fracture, Piece, Refused, Stopped

NAMES = ("kerf-score", "kerf-crack", "kerf-pieces", "kerf-repair")
BAR = re.compile(r"^\x1b\[K\s*(\d+) % ?(.*)")
CHECK_FOUND, BAD_INPUT, INTERRUPTED = 1, 65, 130


def find(folder=""):
    """The tools in the folder or on PATH; None when one of them is missing."""
    path = os.pathsep.join(filter(None, [folder, os.environ.get("PATH", os.defpath)]))
    tools = {name: shutil.which(name, path=path) for name in NAMES}
    return Tools(tools) if all(tools.values()) else None


class Tools:
    name = "tools"

    def __init__(self, paths):
        self.paths = paths

    def fracture(self, model, options, progress):
        with tempfile.TemporaryDirectory(prefix="kerf-") as folder:
            notes = self._crack(folder, model, options, lambda words, share: progress(words, 0.8 * share))
            more = ["--hulls", "--hull-parts", str(options.hulls), "--hull-corners", str(options.corners)] if options.hulls else []
            self._run(
                ["kerf-pieces", "cut.ply", "--tile", repr(options.tile), *more, "-o", "pieces"],
                folder,
                lambda words, share: progress(words, 0.8 + 0.2 * share),
            )
            return _read_pieces(os.path.join(folder, "pieces"), notes)

    def walls(self, model, options, progress):
        with tempfile.TemporaryDirectory(prefix="kerf-") as folder:
            self._crack(folder, model, options, progress)
            vertices, faces = ply.read(os.path.join(folder, "cut.ply"))
            return arrays.used(vertices, faces["vertex_indices"][faces["patch"] > 0])

    def repair(self, model, voxel, smooth, progress):
        with tempfile.TemporaryDirectory(prefix="kerf-") as folder:
            ply.write(os.path.join(folder, "model.ply"), model.vertices, model.triangles)
            more = (["--voxel", repr(voxel)] if voxel else []) + (["--smooth"] if smooth else [])
            notes = self._run(["kerf-repair", "model.ply", "--single", *more, "-o", "solid.ply"], folder, progress)
            vertices, faces = ply.read(os.path.join(folder, "solid.ply"))
            return vertices, faces["vertex_indices"].astype(numpy.int32), " ".join(notes)

    def _crack(self, folder, model, options, progress):
        """Writes cut.ply; returns the notes of kerf-score."""
        ply.write(os.path.join(folder, "model.ply"), model.vertices, model.triangles, model.density)
        arguments = ["--pattern", options.pattern, "--pieces", str(options.pieces), "--seed", str(options.seed)]
        arguments += ["--jagged", repr(options.jagged), "--bumps", repr(options.bumps)]
        arguments += ["--edge-detail", repr(options.edge_detail), "--chips", str(options.chips), "--chip-size", repr(options.chip_size)]
        arguments += ["--cluster", repr(options.cluster), "--grain", repr(options.grain)]
        for name in ("axis", "impact"):
            if getattr(options, name) is not None:
                arguments += [f"--{name}=" + ",".join(repr(float(x)) for x in getattr(options, name))]
        if model.density is not None:
            arguments += ["--density", "red"]
        if options.image is not None:
            png.write(os.path.join(folder, "image.png"), options.image)
            arguments += ["--image", "image.png"]
        notes = self._run(
            ["kerf-score", "model.ply", *arguments, "-o", "score.front"], folder, lambda words, share: progress(words, share / 2)
        )
        self._run(
            ["kerf-crack", "model.ply", "--front", "score.front", "-o", "cut.ply"],
            folder,
            lambda words, share: progress(words, 0.5 + share / 2),
        )
        return notes

    def _run(self, command, folder, progress):
        """Runs a tool; returns its lines on standard error. Throws Stopped, Refused or Failed."""
        tool = command[0]
        process = subprocess.Popen(
            [self.paths[tool], "--progress", "always", *command[1:]],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
        )
        state = {"words": tool, "share": 0.0, "lines": []}
        reader = threading.Thread(target=_listen, args=(process.stderr, state), daemon=True)
        reader.start()
        stopped = False
        while True:
            try:
                process.wait(0.05)
                break
            except subprocess.TimeoutExpired:
                if not stopped and not progress(state["words"], state["share"]):
                    stopped = True
                    process.terminate()
        reader.join()
        process.stderr.close()
        if stopped or process.returncode == INTERRUPTED:
            raise Stopped()
        lines = [re.sub(rf"^{tool}: (\w+\.ply: )?", "", line) for line in state["lines"]]
        if process.returncode in (CHECK_FOUND, BAD_INPUT):
            raise Refused(lines[-1] if lines else f"{tool} refuses the model")
        if process.returncode:
            raise Failed(f"{tool}: " + (lines[-1] if lines else f"exit code {process.returncode}"))
        if not progress(state["words"], 1.0):
            raise Stopped()
        return lines


def _listen(pipe, state):
    """Splits standard error into the progress bar and lines."""
    text = ""
    while True:
        some = os.read(pipe.fileno(), 4096)
        text += some.decode("utf-8", "replace")
        *whole, text = re.split(r"[\r\n]", text)
        for line in whole + ([] if some else [text]):
            bar = BAR.match(line)
            if bar:
                state["share"], state["words"] = int(bar[1]) / 100, bar[2]
            elif line.removeprefix("\x1b[K").strip():
                state["lines"].append(line.removeprefix("\x1b[K").strip())
        if not some:
            return


def _read_pieces(folder, notes):
    with open(os.path.join(folder, "pieces.json"), encoding="utf-8") as file:
        content = json.load(file)
    hulls = sorted(name for name in os.listdir(folder) if name.startswith("hull_"))
    pieces = []
    for entry in content["pieces"]:
        vertices, faces = ply.read(os.path.join(folder, entry["file"]))
        number = entry["file"].removeprefix("piece_").removesuffix(".ply")
        own = [ply.read(os.path.join(folder, name)) for name in hulls if re.fullmatch(rf"hull_{number}(_\d+)?\.ply", name)]
        pieces.append(
            Piece(
                vertices,
                faces["vertex_indices"].astype(numpy.int32),
                faces["patch"],
                faces["source"].astype(numpy.int64),
                faces["texcoord"].astype("f8").reshape(-1, 3, 2),
                entry["volume"],
                numpy.array(entry["centroid"]),
                [(points, rows["vertex_indices"].astype(numpy.int32)) for points, rows in own],
            )
        )
    bonds = [Bond(b["a"], b["b"], b["area"], tuple(b["normal"]), tuple(b["centroid"])) for b in content["bonds"]]
    return Fracture(pieces, bonds, notes)
