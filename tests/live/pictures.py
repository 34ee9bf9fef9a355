"""Pictures of kerf-live's page, compared in the page itself; pictures for its models."""
import struct, zlib

# Draws, and calls `what` with the pixels (r, g, b, a, row by row from below), their width and height.
DRAWN = """(() => {
  draw();
  const gl = renderer.getContext(), w = gl.drawingBufferWidth, h = gl.drawingBufferHeight, data = new Uint8Array(4 * w * h);
  gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, data);
  return (%s)(data, w, h); })()"""


def count(hand, kind):
    """How many pixels are of a kind, which is told by r, g and b."""
    return hand.run(DRAWN % f"(data) => {{ let n = 0; for (let i = 0; i < data.length; i += 4) {{ const [r, g, b] = data.subarray(i, i + 3); if ({kind}) n++; }} return n; }}")


def keep(hand, name):
    """Keeps the picture by this name."""
    hand.run(DRAWN % f"(data) => {{ (window.kept ??= {{}})['{name}'] = data; return 1; }}")


def changed(hand, name):
    """The share of pixels that are not as in the kept picture, by more than 24 of 255."""
    return hand.run(DRAWN % f"""(data) => {{
      const was = window.kept['{name}']; let n = 0;
      for (let i = 0; i < data.length; i += 4) if (Math.max(Math.abs(data[i] - was[i]), Math.abs(data[i + 1] - was[i + 1]), Math.abs(data[i + 2] - was[i + 2])) > 24) n++;
      return 4 * n / data.length; }}""")


def png(pixels):
    """A PNG of rows of (r, g, b)."""
    rows = b"".join(b"\0" + bytes(c for pixel in row for c in pixel) for row in pixels)
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", len(pixels[0]), len(pixels), 8, 2, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
