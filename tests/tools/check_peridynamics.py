#!/usr/bin/env python3
"""Reads what `kerf-info --export` writes for peridynamics as Peridigm and PeriLab do.

  check_peridynamics.py NAME     NAME.peridigm, NAME.perilab and NAME.peridynamics are folders

Nodes and horizons by block; for each node all others within its horizon; without those that a rectangle of the bond
filters lies between. The families that remain are those of families.txt, in all three folders.
"""
import pathlib
import sys

import numpy as np
import yaml

name = sys.argv[1]


def families(folder):
    lines = (pathlib.Path(folder) / "families.txt").read_text().splitlines()
    rows = [list(map(int, line.split())) for line in lines]
    assert [row[0] for row in rows] == list(range(1, len(rows) + 1)), "families are in the order of nodes"
    return [set(row[1:]) for row in rows]


def found(folder, root, skip, space):
    """The families that a program finds."""
    table = np.loadtxt(pathlib.Path(folder) / "nodes.txt", skiprows=skip)
    deck = yaml.safe_load((pathlib.Path(folder) / "input.yaml").read_text())[root]
    assert deck["Discretization"]["Type"] == "Text File" and deck["Discretization"]["Input Mesh File"] == "nodes.txt"
    blocks = {block["Block Names"] if "Block Names" in block else f"block_{block['Block ID']}": block["Horizon"]
              for block in deck["Blocks"].values()}
    x, horizon = table[:, :3], np.array([blocks[f"block_{int(b)}"] for b in table[:, 3]])
    distance = np.linalg.norm(x[:, None] - x[None], axis=2)
    near = distance <= horizon[:, None]
    np.fill_diagonal(near, False)
    i, j = np.nonzero(near)
    whole = np.ones(len(i), bool)
    for rectangle in deck["Discretization"].get("Bond Filters", {}).values():
        assert rectangle["Type"] == "Rectangular_Plane"
        assert all(isinstance(value, float) for key, value in rectangle.items() if key != "Type"), rectangle
        vector = {key: np.array([rectangle[f"{key} {k}".replace(" ", space)] for k in "XYZ"])
                  for key in ("Normal", "Lower Left Corner", "Bottom Unit Vector")}
        normal, corner, bottom = vector.values()
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (corner - x[i]) @ normal / ((x[j] - x[i]) @ normal)
            r = x[i] + t[:, None] * (x[j] - x[i]) - corner
            b, a = r @ bottom, r @ np.cross(bottom, normal)
            whole &= ~((0 <= t) & (t <= 1) & (0 <= b) & (b <= rectangle[f"Bottom{space}Length"])
                       & (0 <= a) & (a <= rectangle[f"Side{space}Length"]))
    result = [set() for _ in x]
    for p, q in zip(i[whole], j[whole]):
        result[p].add(int(q) + 1)
    assert not whole.all(), "a cut body has broken bonds"
    return result


listed = families(f"{name}.peridigm")
assert listed == families(f"{name}.perilab") == families(f"{name}.peridynamics")
assert found(f"{name}.peridigm", "Peridigm", 0, "_") == listed, "Peridigm's families differ"
assert found(f"{name}.perilab", "PeriLab", 1, " ") == listed, "PeriLab's families differ"
script = (pathlib.Path(f"{name}.peridynamics") / "body.jl").read_text()
assert script.count("precrack!(body, :") > 0 and script.rstrip().endswith("end")
