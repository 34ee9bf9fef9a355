#!/usr/bin/env python3
"""Paints the vertices of an OFF near a point red, and writes a PLY: a model for kerf-score --density red.

    paint.py MODEL.off X Y Z RADIUS OUT.ply     red falls from 1 to 0.05 within three times the radius, a length
"""
import math
import sys

model, out = sys.argv[1], sys.argv[6]
point, radius = [float(x) for x in sys.argv[2:5]], float(sys.argv[5])
with open(model) as file:
    words = file.read().split()
count, faces = int(words[1]), int(words[2])
at = 4
vertices = [[float(x) for x in words[at + 3 * i:at + 3 * i + 3]] for i in range(count)]
at += 3 * count
with open(out, "w") as file:
    file.write(f"ply\nformat ascii 1.0\nelement vertex {count}\n" + "".join(f"property float {k}\n" for k in "xyz"))
    file.write("".join(f"property uchar {k}\n" for k in ("red", "green", "blue")))
    file.write(f"element face {faces}\nproperty list uchar int vertex_indices\nend_header\n")
    for p in vertices:
        red = 0.05 + 0.95 * math.exp(-(math.dist(p, point) / radius) ** 2 / 2)
        file.write(f"{p[0]} {p[1]} {p[2]} {round(255 * red)} {round(220 - 190 * red)} {round(200 - 190 * red)}\n")
    for i in range(faces):
        file.write(f"3 {words[at + 4 * i + 1]} {words[at + 4 * i + 2]} {words[at + 4 * i + 3]}\n")
