"""Memory of long runs, and of arrays that outlive what they show.

  KERF_CASES=N   N times as many fractures
"""
import gc
import os
import unittest
import weakref

import numpy as np

import kerf
import values


def resident():
    """Bytes of this process in memory."""
    gc.collect()
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def fracture(vertices, faces, seed):
    solid = kerf.Solid(vertices, faces)
    cracked = solid.crack(kerf.score(solid, "planes", pieces=3, axis="z", jagged=0, seed=seed))
    pieces = cracked.pieces()
    assert abs(sum(piece.volume for piece in pieces) - 1) < 1e-9
    return [(piece.vertices, piece.faces, piece.patch, piece.source) for piece in pieces], cracked.bonds


class Memory(unittest.TestCase):
    def test_fractures_in_a_loop(self):
        count = int(10000 * float(os.environ.get("KERF_CASES", "1")))
        kerf.set_threads(1)
        vertices, faces = values.cube()
        for seed in range(count // 20):
            fracture(vertices, faces, seed)
        before = resident()
        for seed in range(count):
            fracture(vertices, faces, seed)
        after = resident()
        print(f"{count} fractures: {before >> 10} KiB before, {after >> 10} KiB after")
        self.assertLess(after, 1.05 * before)

    def test_refusals_in_a_loop(self):
        vertices, faces = values.cube()
        wrong = [(vertices, faces[:-1]), (vertices[:, :2], faces), (vertices * np.nan, faces), (vertices, faces + 8), (None, None)]

        def refused(times):
            for _ in range(times):
                for arguments in wrong:
                    with self.assertRaises(kerf.InputError):
                        kerf.Solid(*arguments)

        refused(200)
        before = resident()
        refused(2000)
        self.assertLess(resident(), 1.05 * before)

    def test_objects_are_freed(self):
        vertices, faces = values.cube()
        mesh = kerf.Mesh(np.tile(vertices, (100000, 1)), faces)
        view = mesh.vertices
        before = resident()
        del mesh
        self.assertEqual(view[-1].tolist(), [1, 1, 1])  # the view keeps the mesh
        self.assertGreater(resident(), before - (1 << 20))
        del view
        self.assertLess(resident(), before - (10 << 20))

    def test_views_outlive_their_owners(self):
        vertices, faces = values.cube()
        arrays, bonds = fracture(vertices, faces, 1)
        copies = [[array.copy() for array in piece] for piece in arrays]
        gc.collect()
        for seed in range(50):  # what was freed would be written over
            fracture(vertices, faces, seed)
        for piece, copy in zip(arrays, copies):
            for array, kept in zip(piece, copy):
                np.testing.assert_array_equal(array, kept)
        self.assertEqual(len(bonds), 2)

    def test_views_cannot_be_written(self):
        mesh = kerf.Mesh(*values.cube())
        for array in (mesh.vertices, mesh.faces):
            self.assertFalse(array.flags.writeable)
            with self.assertRaises(ValueError):
                array[0] = 0
            with self.assertRaises(ValueError):
                array.flags.writeable = True

    def test_a_snapshot_stays_as_it_was(self):
        solid = kerf.Solid(*values.cube())
        cracked = solid.complex()
        surface = cracked.surface()
        before = surface.vertices.copy()
        front = cracked.front([[-1, 0.5, -0.1], [2, 0.5, -0.1]])
        front.advance([[-1, 0.5, 1.2], [2, 0.5, 1.2]])
        np.testing.assert_array_equal(surface.vertices, before)
        self.assertEqual(len(cracked.pieces()), 2)
        alive = weakref.ref(front)
        del cracked
        gc.collect()
        self.assertIsNotNone(alive())
        self.assertEqual(len(front.points), 2)


if __name__ == "__main__":
    unittest.main()
