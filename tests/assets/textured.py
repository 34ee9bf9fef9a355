"""textured.py: a die with an .mtl and three small PNG files, in the current folder."""
import struct
import zlib


def png_bytes(size, pixel):
    rows = b"".join(b"\0" + bytes(c for x in range(size) for c in pixel(x, y)) for y in range(size))
    chunks = [(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(rows)), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)) for name, data in chunks)


def write(path, data):
    with open(path, "wb") as file:
        file.write(data)


def main():
    write("brick wall.png", png_bytes(16, lambda x, y: (200, 60, 30) if (x // 4 + y // 4) % 2 else (230, 220, 200)))
    write("surface.png", png_bytes(8, lambda x, y: (255, 30 * x, 30 * y)))
    write("bumps.png", png_bytes(8, lambda x, y: (128, 128, 255)))
    with open("die.mtl", "w") as file:
        file.write("newmtl side\nKd 0.9 0.8 0.7\nNs 250\nmap_Kd -s 2 3 1 -o 0.25 0.5 0 brick wall.png\nnorm -bm 0.5 bumps.png\n"
                   "newmtl lid\nKd 1 0.5 0\nPr 0.3\nPm 0.7\nKe 2 1 0\nd 0.5\nmap_Pr -imfchan g surface.png\nmap_Pm -imfchan b surface.png\n")
    corners = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    faces = [("side", 1, 2, 6, 5), ("side", 2, 4, 8, 6), ("side", 4, 3, 7, 8), ("side", 3, 1, 5, 7), ("lid", 1, 3, 4, 2), ("lid", 5, 6, 8, 7)]
    with open("die.obj", "w") as file:
        file.write("mtllib die.mtl\n" + "".join("v %d %d %d\n" % corner for corner in corners) + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n")
        for material, *face in faces:
            file.write(f"usemtl {material}\nf {' '.join(f'{v}/{k}' for k, v in enumerate(face, 1))}\n")


if __name__ == "__main__":
    main()
