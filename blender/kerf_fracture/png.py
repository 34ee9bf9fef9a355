"""Writes PNG files of one channel (ISO/IEC 15948)."""

import struct
import zlib

import numpy


def write(path, brightness):
    """(height, width) values from 0, black, to 1; the highest row first."""
    height, width = brightness.shape
    rows = numpy.zeros((height, 1 + width), numpy.uint8)  # each begins with its filter, which is none
    rows[:, 1:] = numpy.clip(numpy.round(255 * brightness), 0, 255)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)))
        file.write(chunk(b"IDAT", zlib.compress(rows.tobytes())) + chunk(b"IEND", b""))
