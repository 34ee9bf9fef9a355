#!/usr/bin/env python3
"""Writes a PNG of black and white pixels, or one that says it is large and has no pixels, without any library.

    draw_png.py FILE WIDTH HEIGHT CONDITION     black where the condition of x and y, in pixels, holds; empty: no pixels
"""
import struct
import sys
import zlib


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


path, width, height, condition = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
rows = b""
if condition:
    black = compile(condition, "condition", "eval")
    rows = b"".join(b"\0" + bytes(0 if eval(black, {"x": x, "y": y}) else 255 for x in range(width)) for y in range(height))
with open(path, "wb") as out:
    out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)))
    out.write(chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
