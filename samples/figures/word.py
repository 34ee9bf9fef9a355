#!/usr/bin/env python3
"""Draws a word in black on white, as large as the picture: an image for kerf-score --image.

    word.py FILE.png WORD [WIDTH]     WIDTH: pixels, default 400; needs matplotlib
"""
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.patches import PathPatch
from matplotlib.textpath import TextPath

path, word = sys.argv[1:3]
width = int(sys.argv[3]) if len(sys.argv) > 3 else 400
text = TextPath((0, 0), word, size=1, prop={"family": "DejaVu Sans", "weight": "bold"})
box = text.get_extents()
margin = 0.15
wide, high = box.width + 2 * margin, box.height + 2 * margin
figure = plt.figure(figsize=(width / 100, width / 100 * high / wide), dpi=100)
axes = figure.add_axes((0, 0, 1, 1), xlim=(box.x0 - margin, box.x1 + margin), ylim=(box.y0 - margin, box.y1 + margin))
axes.axis("off")
axes.add_patch(PathPatch(text, color="black", linewidth=0))
figure.savefig(path, facecolor="white")
