"""Checks a data set of kerf-dataset with NumPy alone: pieces closed, volumes, labels, bonds, transforms.

  check_dataset.py FOLDER VOLUMES        VOLUMES: JSON, the volume of each model by name
"""
import json
import pathlib
import sys

import numpy as np


def check_piece(vertices, faces, volume, where):
    """Every directed edge occurs once, with its reverse; the volume is the recorded one and positive."""
    assert faces.max() == len(vertices) - 1 and len(np.unique(faces)) == len(vertices), where
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.uint64)
    assert (edges[:, 0] != edges[:, 1]).all(), where
    there, back = edges[:, 0] << 32 | edges[:, 1], edges[:, 1] << 32 | edges[:, 0]
    assert len(np.unique(there)) == len(there) and np.array_equal(np.sort(there), np.sort(back)), f"{where}: open"
    a, b, c = (vertices[faces[:, k]].astype(float) - vertices.mean(0) for k in range(3))
    found = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
    assert found > 0 and abs(found - volume) <= tolerance * found, f"{where}: volume {found}, not {volume}"


def areas(vertices, faces):
    a, b, c = (vertices[faces[:, k]].astype(float) for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def rotated(quaternion, points):
    w, u = quaternion[0], quaternion[1:]
    return points + 2 * np.cross(u, np.cross(u, points) + w * points)


def check_archive(path, record, model_volume):
    z = np.load(path)
    assert list(z["seed"]) == [f["seed"] for f in record["fractures"]], path
    pieces, bonds = z["fracture_pieces"], z["fracture_bonds"]
    of_v, of_f = z["piece_vertices"], z["piece_faces"]
    for f, entry in enumerate(record["fractures"]):
        where = f"{path}, seed {z['seed'][f]}"
        p0, p1, b0, b1 = pieces[f], pieces[f + 1], bonds[f], bonds[f + 1]
        assert entry["pieces"] == p1 - p0 and entry["bonds"] == b1 - b0, where
        volumes = z["piece_volume"][p0:p1]
        assert (np.diff(volumes) <= 0).all(), where
        assert abs(volumes.sum() - model_volume) <= 1e-9 * model_volume, f"{where}: volumes {volumes.sum()}, {model_volume}"
        walls, corners = np.zeros((2, b1 - b0)), [{} for _ in range(b1 - b0)]
        for p in range(p0, p1):
            v, g = z["vertices"][of_v[p]:of_v[p + 1]], z["faces"][of_f[p]:of_f[p + 1]]
            label, source = z["face_label"][of_f[p]:of_f[p + 1]], z["face_source"][of_f[p]:of_f[p + 1]]
            check_piece(v, g, volumes[p - p0], f"{where}, piece {p - p0}")
            assert ((label == 0) == (source != -1)).all(), where
            area = areas(v, g)
            whole = rotated(z["piece_rotation"][p], v.astype(float)) + z["piece_translation"][p]
            for k in np.unique(label[label > 0]) - 1:
                side = list(z["bond_pieces"][b0 + k]).index(p - p0)  # fails where the bond is not of this piece
                walls[side, k] += area[label == k + 1].sum()
                corners[k][side] = whole[np.unique(g[label == k + 1])]
        assert np.allclose(walls, z["bond_area"][b0:b1], rtol=10 * tolerance), where
        # Pairs of triangles: all of each wall, once, at the same places with the corners in reversed order.
        for k in range(b1 - b0):
            pairs = z["wall_faces"][z["bond_walls"][b0 + k]:z["bond_walls"][b0 + k + 1]]
            placed = []
            for side, p in enumerate(z["bond_pieces"][b0 + k] + p0):
                label = z["face_label"][of_f[p]:of_f[p + 1]]
                assert np.array_equal(np.sort(pairs[:, side]), np.flatnonzero(label == k + 1)), where
                v, g = z["vertices"][of_v[p]:of_v[p + 1]].astype(float), z["faces"][of_f[p]:of_f[p + 1]]
                placed.append((rotated(z["piece_rotation"][p], v) + z["piece_translation"][p])[g[pairs[:, side]]])
            assert np.abs(placed[0] - placed[1][:, [0, 2, 1]]).max() <= 1e-6, where
        for sides in corners:  # both sides of a wall are in the same places once the pieces are put together
            a, b = (np.unique(np.round(sides[s], 5), axis=0) for s in (0, 1))
            assert abs(len(a) - len(b)) <= 0.2 * len(a) and np.allclose(a.min(0), b.min(0), atol=1e-4), where
            assert np.allclose(a.max(0), b.max(0), atol=1e-4), where


def read_ply(path):
    """Vertices, faces, patch and source of a PLY as kerf-dataset writes it."""
    data = path.read_bytes()
    header, _, rest = data.partition(b"end_header\n")
    counts = [int(line.split()[2]) for line in header.decode().split("\n") if line.startswith("element")]
    vertices = np.frombuffer(rest, "<f8", 3 * counts[0]).reshape(-1, 3)
    rows = np.frombuffer(rest, [("n", "u1"), ("v", "<u4", 3), ("patch", "<i4"), ("source", "<u4")], counts[1], 24 * counts[0])
    assert (rows["n"] == 3).all() and len(rest) == 24 * counts[0] + 21 * counts[1], path
    return vertices, rows["v"], rows["patch"], rows["source"]


def check_folder(folder, record, model_volume):
    entry = record["fractures"][0]
    names = sorted(f.name for f in folder.iterdir())
    assert names == sorted(f"piece_{p}.ply" for p in range(entry["pieces"])), names
    pieces = []
    total, walls = 0, {bond["label"]: 0 for bond in entry["bond"]}
    for piece in entry["piece"]:
        vertices, faces, label, source = read_ply(folder.parent / piece["file"])
        check_piece(vertices, faces, piece["volume"], piece["file"])
        assert ((label == 0) == (source != 2**32 - 1)).all(), folder
        total += piece["volume"]
        pieces.append((vertices, faces, label))
        for k in set(label) - {0}:
            walls[k] += areas(vertices, faces)[label == k].sum() / 2
    assert abs(total - model_volume) <= 1e-9 * model_volume, folder
    for bond in entry["bond"]:
        (v, f, label), (w, g, _) = pieces[bond["a"]], pieces[bond["b"]]
        pairs = np.array(bond["wall_faces"])
        assert np.array_equal(np.sort(pairs[:, 0]), np.flatnonzero(label == bond["label"])), folder
        if not settings["rotate"]:
            assert np.array_equal(v[f[pairs[:, 0]]], w[g[pairs[:, 1]]][:, [0, 2, 1]]), folder
    assert all(abs(walls[b["label"]] - b["area"]) <= 1e-9 * b["area"] for b in entry["bond"]), folder


root, volume_of = pathlib.Path(sys.argv[1]), json.loads(sys.argv[2])
settings = json.loads((root / "dataset.json").read_text())
tolerance = 1e-4 if settings["single"] else 1e-9
for path in root.rglob("*.npz"):
    assert all(np.load(path)[name].dtype.kind in "if" for name in np.load(path)), path  # torch has few unsigned integers
summary = json.loads((root / "summary.json").read_text())
checked = 0
for path in sorted(root.rglob("*.json")):
    record = json.loads(path.read_text())
    if "fractures" not in record or "model" not in record or not record["fractures"]:
        continue
    if settings["layout"] == "npz":
        check_archive(path.with_suffix(".npz"), record, volume_of[record["model"]])
    else:
        check_folder(path.with_name(path.stem.replace("labels_", "fractured_")), record, volume_of[record["model"]])
    checked += len(record["fractures"])
assert checked == summary["fractures"] > 0, (checked, summary)
listed = [line for split in ("train", "val", "test") for line in (root / f"data_split/shapes.{split}.txt").read_text().split()]
assert len(listed) == len(set(listed)) and all((root / line).exists() for line in listed), listed
if settings["layout"] == "folders":  # readers of Breaking Bad take each entry with one of these words for a folder of pieces
    for line in listed:
        folders = [entry for entry in (root / line).iterdir() if "fractured" in entry.name or "mode" in entry.name]
        assert folders and all(entry.is_dir() for entry in folders), folders
print(f"{checked} fractures are sound")
