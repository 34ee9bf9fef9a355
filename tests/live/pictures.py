"""Pictures of kerf-live's page, compared in the page itself; pictures for its models."""
import struct, zlib

# Pixels of the ends of springs that stay: clay has twice as much green as blue at most, these have four times.
ENDS = "r > 120 && r > 1.5 * g && g > 3 * b"

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


def changed_along(hand, name, places, near=6):
    """The share of places of the page around which, `near` pixels at most, a pixel is not as in the kept picture."""
    return hand.run(DRAWN % f"""(data, w, h) => {{
      const was = window.kept['{name}'], box = $("canvas").getBoundingClientRect(), scale = w / box.width, reach = Math.ceil({near} * scale);
      const differs = (x, y) => {{
        const i = 4 * (y * w + x);
        return Math.max(Math.abs(data[i] - was[i]), Math.abs(data[i + 1] - was[i + 1]), Math.abs(data[i + 2] - was[i + 2])) > 24;
      }};
      const places = {places}.filter(([px, py]) => {{
        const x = Math.round(scale * (px - box.x)), y = Math.round(h - scale * (py - box.y));
        for (let j = -reach; j <= reach; j++) for (let i = -reach; i <= reach; i++) if (differs(x + i, y + j)) return true;
        return false;
      }});
      return places.length / {len(places)}; }}""")


# Calls `what` with the pixels of the whole page as a person sees it, words and buttons included.
SEEN = """new Promise((done, failed) => {
  const image = new Image();
  image.onerror = () => failed(new Error("the picture of the page cannot be read"));
  image.onload = () => {
    const canvas = document.createElement("canvas"), paint = canvas.getContext("2d");
    canvas.width = image.width, canvas.height = image.height;
    paint.drawImage(image, 0, 0);
    done((%s)(paint.getImageData(0, 0, image.width, image.height).data, image.width, image.height));
  };
  image.src = "data:image/png;base64,%s"; })"""


def seen(hand, what):
    """The value of a function of the page's pixels, width and height."""
    return hand.run(SEEN % (what, hand.send("Page.captureScreenshot", format="png")["data"]))


def keep_page(hand, name):
    """Keeps the picture of the page by this name."""
    seen(hand, f"(data) => {{ (window.kept ??= {{}})['{name}'] = data; return 1; }}")


def page_changed(hand, name, element="body"):
    """The share of an element's pixels that are not as in the kept picture of the page, by more than 24 of 255."""
    return seen(hand, f"""(data, w, h) => {{
      const was = window.kept['{name}'], box = document.querySelector('{element}').getBoundingClientRect(), scale = w / window.innerWidth;
      let n = 0, all = 0;
      for (let y = Math.ceil(scale * box.top); y < Math.min(h, scale * box.bottom); y++)
        for (let x = Math.ceil(scale * box.left); x < Math.min(w, scale * box.right); x++) {{
          const i = 4 * (y * w + x);
          n += Math.max(Math.abs(data[i] - was[i]), Math.abs(data[i + 1] - was[i + 1]), Math.abs(data[i + 2] - was[i + 2])) > 24, all++;
        }}
      return n / all; }}""")


def gaps(hand, kind, least=3):
    """How many columns have pixels of a kind; how many of these show a gap, `least` others or more between two of them; how many do not, between two that do."""
    return hand.run(DRAWN % f"""(data, w, h) => {{
      const open = [];  // of the columns with such pixels
      for (let x = 0; x < w; x++) {{
        let last = -1, gap = 0;
        for (let y = 0; y < h; y++) {{
          const [r, g, b] = data.subarray(4 * (y * w + x), 4 * (y * w + x) + 3);
          if (!({kind})) continue;
          if (last >= 0) gap = Math.max(gap, y - last - 1);
          last = y;
        }}
        if (last >= 0) open.push(gap >= {least});
      }}
      const shown = open.filter((is) => is).length;
      return [open.length, shown, shown && open.lastIndexOf(true) + 1 - open.indexOf(true) - shown]; }}""")


def png(pixels):
    """A PNG of rows of (r, g, b)."""
    rows = b"".join(b"\0" + bytes(c for pixel in row for c in pixel) for row in pixels)
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", len(pixels[0]), len(pixels), 8, 2, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
