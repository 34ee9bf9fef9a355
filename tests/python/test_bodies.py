"""Nodes, graphs, bodies and solids: arrays, snapshots, splits, files, bad input."""
import copy
import os
import pickle
import tempfile
import threading
import unittest

import numpy as np

import kerf
from shapes import block

try:
    import scipy.sparse
    import scipy.sparse.csgraph
except ImportError:
    scipy = None


def solid(**options):
    return kerf.Solid(*block(**options))


def halved(body):
    """Cuts a unit block in the plane x = 0.5, in two steps."""
    front = body.front([[0.5, -0.1, -0.1], [0.5, 1.1, -0.1]])
    deltas = [body.split(front, [[0.5, -0.1, z], [0.5, 1.1, z]]) for z in (0.5, 1.1)]
    return front, deltas


class Nodes(unittest.TestCase):
    def test_sample(self):
        nodes = kerf.sample(solid(), spacing=0.1)
        self.assertEqual(nodes.positions.shape, (len(nodes), 3))
        self.assertAlmostEqual(nodes.volume.sum(), 1.0)
        self.assertTrue(((nodes.positions > 0) & (nodes.positions < 1)).all())
        self.assertFalse(nodes.positions.flags.writeable)
        percent = kerf.sample(solid(), spacing=f"{10 / 3 ** 0.5}%")
        np.testing.assert_array_equal(percent.positions, nodes.positions)

    def test_options(self):
        for pattern in ("jitter", "blue", "grid"):
            nodes = kerf.sample(solid(), count=300, pattern=pattern, levels=1, seed=3)
            self.assertLess(abs(len(nodes) - 300), 45)
        self.assertGreater(len(kerf.sample(solid(size=(1, 1, 0.1)), spacing=0.2, across=3)),
                           len(kerf.sample(solid(size=(1, 1, 0.1)), spacing=0.2)))

    def test_refused(self):
        for options in ({"spacing": -1}, {"spacing": "x"}, {"spacing": "3%%"}, {"spacing": float("nan")}, {"count": 0},
                        {"count": 5, "spacing": 1}, {"pattern": "hexagons"}, {"levels": 0}, {"jitter": 2},
                        {"across": -1}, {"support": 0}, {"spacing": 50.0}):
            with self.assertRaises(kerf.InputError, msg=str(options)):
                kerf.sample(solid(), **options)
        vertices, faces = block()
        with self.assertRaises(kerf.InputError):
            kerf.sample(kerf.Mesh(vertices, faces[1:]), spacing=0.2)

    def test_files(self):
        nodes = kerf.sample(solid(), spacing=0.2)
        with tempfile.TemporaryDirectory() as folder:
            for name in ("nodes.pcd", "nodes.ply"):
                path = os.path.join(folder, name)
                nodes.save(path)
                again = kerf.NodeSet.load(path)
                for field in ("positions", "radius", "spacing", "volume"):
                    np.testing.assert_array_equal(getattr(again, field), getattr(nodes, field))
        made = kerf.NodeSet(nodes.positions, nodes.radius, nodes.spacing, nodes.volume)
        np.testing.assert_array_equal(made.radius, nodes.radius)
        with self.assertRaises(kerf.InputError):
            kerf.NodeSet(nodes.positions, nodes.radius[1:], nodes.spacing, nodes.volume)
        with self.assertRaises(kerf.InputError):
            kerf.NodeSet(nodes.positions, -nodes.radius, nodes.spacing, nodes.volume)


class Graphs(unittest.TestCase):
    def setUp(self):
        self.body = kerf.Body(solid(), spacing=0.16)

    def test_rows(self):
        g, n = self.body.graph, len(self.body.nodes)
        self.assertEqual((g.indptr.dtype, g.indices.dtype, g.distances.dtype), (np.int64, np.int32, np.float32))
        self.assertEqual(g.indptr.shape, (n + 1,))
        self.assertEqual(len(g.indices), g.indptr[-1])
        self.assertEqual(len(g.hidden), len(g.warped), len(g.indices))
        self.assertIs(g.indices, g.indices)
        positions = self.body.nodes.positions
        rows = np.repeat(np.arange(n), np.diff(g.indptr))
        straight = np.linalg.norm(positions[rows] - positions[g.indices], axis=1)
        np.testing.assert_allclose(g.distances, straight, rtol=1e-6)
        count, label = g.components()
        self.assertEqual((count, label.max()), (1, 0))
        self.assertEqual(len(g.edges), g.edge_count)
        i, j = g.edges[7]
        self.assertTrue(g.has_edge(i, j) and g.has_edge(j, i))
        with self.assertRaises(kerf.InputError):
            g.has_edge(0, n)

    @unittest.skipUnless(scipy, "needs SciPy")
    def test_paths_against_scipy(self):
        """Hidden neighbours are as far away as the shortest path over the graph's edges, where all radii are equal."""
        nodes = kerf.sample(solid(), spacing=0.12, levels=1)
        nodes = kerf.NodeSet(nodes.positions, np.full(len(nodes), 0.3), nodes.spacing, nodes.volume)
        body = kerf.Body(solid(), nodes)
        body.resample_limit = 0
        front = body.front([[-0.1, 0.33, -0.1], [-0.1, 0.33, 1.1]])
        body.split(front, [[0.45, 0.33, -0.1], [0.45, 0.33, 1.1]])  # ends inside
        g, n = body.graph, len(nodes)
        edges, lengths = g.edges, g.edge_lengths
        graph = scipy.sparse.csr_matrix((lengths, (edges[:, 0], edges[:, 1])), shape=(n, n))
        paths = scipy.sparse.csgraph.dijkstra(graph, directed=False)
        rows = np.repeat(np.arange(n), np.diff(g.indptr))
        self.assertGreater(g.hidden.sum(), 50)
        np.testing.assert_allclose(g.distances[g.hidden], paths[rows, g.indices][g.hidden], rtol=1e-3)
        between = paths + np.eye(n) < 0.3 * (1 - 1e-4)
        self.assertTrue(between.sum() > 0 and np.isin(np.argwhere(between) @ [n, 1], rows * n + g.indices).all())
        csr = scipy.sparse.csr_matrix((g.distances, g.indices, g.indptr), shape=(n, n))
        self.assertEqual(abs(csr - csr.T).max(), 0)
        count, label = scipy.sparse.csgraph.connected_components(graph, directed=False)
        self.assertEqual((count, list(label)), (g.components()[0], list(g.components()[1])))

    def test_plain_nodes(self):
        nodes = self.body.nodes
        edges = kerf.build_visibility_graph(nodes, k=26)
        self.assertEqual(len(edges.indices), 0)
        walls = kerf.build_neighborhoods(edges, solid())
        self.assertEqual(walls, kerf.build_neighborhoods(edges, solid(), method="mfw"))
        self.assertEqual(walls, kerf.build_neighborhoods(edges, solid(), method="dijkstra"))
        np.testing.assert_array_equal(walls.indices, self.body.graph.indices)
        sheet = np.array([[[0.5, -1, -1], [0.5, 3, -1], [0.5, -1, 3]]])
        self.assertEqual(kerf.build_visibility_graph(nodes, sheet).components()[0], 2)
        for bad in (np.zeros((3, 3)), np.full((1, 3, 3), np.nan), "x", object()):
            with self.assertRaises((kerf.InputError, TypeError)):
                kerf.build_visibility_graph(nodes, bad)
        with self.assertRaises(kerf.InputError):
            kerf.build_neighborhoods(edges, method="astar")


class Bodies(unittest.TestCase):
    def setUp(self):
        self.body = kerf.Body(solid(), spacing=0.16)

    def test_split_keeps_invariants(self):
        front, deltas = halved(self.body)
        report = self.body.check()
        self.assertTrue(report.good, report.first_problem)
        self.assertEqual((report.graph_components, report.pieces), (2, 2))
        self.assertEqual(len(deltas[1].detached), 1)
        self.assertGreater(deltas[0].stats.edges_cut, 0)
        # A donor may be a new node itself, one that was inserted before.
        donors = deltas[0].donors
        self.assertTrue((donors < deltas[0].first_new_node + np.arange(len(donors))).all())
        self.assertEqual(front.crack, 1)
        self.assertEqual(self.body.surface.patch.max(), 1)
        self.assertAlmostEqual(self.body.surface.volume, 1)
        self.assertAlmostEqual(self.body.nodes.volume.sum(), 1)

    def test_views_across_changes(self):
        nodes, graph, surface = self.body.nodes, self.body.graph, self.body.surface
        self.assertIs(self.body.nodes, nodes)
        self.assertIs(self.body.graph, graph)
        positions, indices = nodes.positions, graph.indices
        before = positions.copy(), indices.copy(), surface.vertices.copy()
        halved(self.body)
        self.assertIsNot(self.body.nodes, nodes)
        self.assertNotEqual(self.body.graph, graph)
        np.testing.assert_array_equal(positions, before[0])
        np.testing.assert_array_equal(indices, before[1])
        np.testing.assert_array_equal(surface.vertices, before[2])
        binding = self.body.binding.master
        del self.body, nodes, graph
        self.assertEqual(len(binding), len(binding.copy()))
        self.assertEqual(positions.sum(), before[0].sum())

    def test_update(self):
        cut = copy.copy(self.body)
        halved(cut)
        delta = self.body.update(cut.surface)
        self.assertTrue(delta)
        self.assertTrue(self.body.check().good)
        self.assertEqual(self.body.graph.components()[0], 2)
        with self.assertRaises(kerf.InputError):
            self.body.update(solid(parts=(3, 3, 3)))
        self.assertTrue(self.body.check().good)

    def test_cracked_model(self):
        """A body of a cracked model is that of the model after an update, bit for bit."""
        model = solid(parts=(6, 6, 6))
        cracked = model.crack(kerf.score(model, "voronoi", pieces=5, seed=7))
        body = kerf.Body(cracked, spacing=0.16)
        self.assertTrue(body.check().good)
        self.assertEqual(body.graph.components()[0], 5)
        updated = kerf.Body(model, spacing=0.16)
        updated.update(cracked)
        self.assertEqual(updated.to_bytes(), body.to_bytes())
        self.assertEqual(len(body.pieces()), 5)
        np.testing.assert_array_equal(body.bonds["area"], cracked.bonds["area"])
        self.assertTrue(kerf.Body(cracked, kerf.sample(model, spacing=0.16)).check().good)
        delta = body.front([[0.4, -0.1, -0.1], [0.4, 1.1, -0.1]]).advance([[0.4, -0.1, 1.1], [0.4, 1.1, 1.1]])
        self.assertGreater(len(delta.crack.new_faces), 0)
        self.assertGreater(len(body.complex().pieces()), 5)

    def test_resize(self):
        widest = self.body.widest_radius
        delta = self.body.resize([5, 2], [widest, 0.9 * widest])
        self.assertEqual(list(delta.resized_nodes[0]), [2, 5])
        self.assertEqual(self.body.nodes.radius[5], widest)
        self.assertTrue(self.body.check().good)
        for nodes, radii in (([1], [-1]), ([1], [2 * widest]), ([1, 1], [widest, widest]), ([10**6], [widest]),
                             ([1, 2], [widest])):
            with self.assertRaises(kerf.InputError):
                self.body.resize(nodes, radii)

    def test_carriers(self):
        indptr, nodes, distances = self.body.carriers()
        vertex = self.body.binding.vertex
        self.assertEqual(len(indptr), len(vertex) + 1)
        one = self.body.carriers(vertex[3])
        np.testing.assert_array_equal(one[0], nodes[indptr[3]:indptr[4]])
        x = self.body.surface.vertices[3]
        np.testing.assert_allclose(np.linalg.norm(self.body.nodes.positions[one[0]] - x, axis=1), one[1])
        with self.assertRaises(kerf.InputError):
            self.body.carriers(10**6)

    def test_files(self):
        halved(self.body)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "body.kerf")
            kerf.Body(solid(), spacing=0.16).save(path)
            self.body.save(path, update=True)
            file = kerf.KerfFile(path)
            self.assertEqual(file.updates, 1)
            self.assertEqual(kerf.Body.load(path).to_bytes(), self.body.to_bytes())
            kerf.compact(path)
            self.assertEqual(kerf.KerfFile(path).updates, 0)
            self.assertEqual(kerf.Body.load(path).to_bytes(), self.body.to_bytes())
            np.testing.assert_array_equal(kerf.KerfFile(path)["nodes/position"], self.body.nodes.positions)
            self.assertEqual(kerf.KerfFile(path)["about"]["k"], 26)
            with self.assertRaisesRegex(kerf.InputError, "nodes/position"):
                kerf.KerfFile(path)["nodes/positions"]
            for name in ("graph.ply", "graph.vtu", "graph.hdf"):
                self.body.save_graph(os.path.join(folder, name))
                self.assertGreater(os.path.getsize(os.path.join(folder, name)), 10000)
            self.body.export(os.path.join(folder, "body.npz"))
            with np.load(os.path.join(folder, "body.npz")) as archive:
                np.testing.assert_array_equal(archive["nodes/radius"], self.body.nodes.radius)
            self.body.export(os.path.join(folder, "body.json"))
            with self.assertRaises(kerf.InputError):
                self.body.export(os.path.join(folder, "body.xml"))
            self.body.export(os.path.join(folder, "body.perilab"), horizon=2)
            with open(os.path.join(folder, "body.perilab", "nodes.txt")) as table:
                self.assertEqual(len(table.readlines()), len(self.body.nodes) + 1)
            with self.assertRaisesRegex(kerf.InputError, "horizon"):
                self.body.export(os.path.join(folder, "other.perilab"), horizon=0)
            with self.assertRaises(kerf.MissingInputError):
                kerf.Body.load(os.path.join(folder, "none.kerf"))
            with self.assertRaises(kerf.OutputError):
                self.body.save(os.path.join(folder, "none", "body.kerf"))
        self.assertEqual(pickle.loads(pickle.dumps(self.body)).graph, self.body.graph)
        with self.assertRaises(kerf.InputError):
            kerf.Body.from_bytes(self.body.to_bytes()[:-9])

    def test_refused(self):
        for options in ({"k": 2}, {"guide_spacing": 0.01}, {"method": "x"}, {"nodes": 3}):
            with self.assertRaises((kerf.InputError, TypeError), msg=str(options)):
                kerf.Body(solid(), **{"spacing": 0.3, **options} if "nodes" not in options else options)
        outside = kerf.NodeSet([[2.0, 0, 0]], [1], [1], [1])
        with self.assertRaises(kerf.InputError):
            kerf.Body(solid(), outside)
        other = kerf.Body(solid(), spacing=0.3)
        front = other.front([[0.5, -0.1, -0.1], [0.5, 1.1, -0.1]])
        with self.assertRaises(kerf.InputError):
            self.body.split(front, [[0.5, 0, 0], [0.5, 1, 1]])
        for line in ([], [[0, 0, 0]], [[0, 0, np.nan], [0, 0, 1]], "line", [[0, 0], [1, 1]]):
            with self.assertRaises(kerf.InputError):
                self.body.front(line)
            with self.assertRaises(kerf.InputError):
                other.split(front, line)
        with self.assertRaises((kerf.InputError, TypeError)):
            other.split(front, [[0.5, 0, 0.5], [0.5, 1, 0.5]], attempts=0)
        with self.assertRaises(TypeError):
            other.split(front, [[0.5, 0, 0.5], [0.5, 1, 0.5]], seeds=0)

    def test_progress(self):
        phases = []
        kerf.Body(solid(), spacing=0.16, progress=lambda phase, done, total: phases.append(phase))
        self.assertGreater(len(phases), 0)
        with self.assertRaises(kerf.Interrupted):
            kerf.Body(solid(), spacing=0.1, progress=lambda *report: False)
        with self.assertRaises(ZeroDivisionError):
            kerf.Body(solid(), spacing=0.1, progress=lambda *report: 1 / 0)

    def test_busy(self):
        """A progress callable that uses the body that is being changed is refused."""
        cut = copy.copy(self.body)
        halved(cut)
        errors = []

        def report(phase, done, total):
            try:
                self.body.nodes
            except kerf.Error as error:
                errors.append(str(error))

        self.body.update(cut.surface, progress=report)
        self.assertTrue(errors and "call" in errors[0])
        results = []
        threads = [threading.Thread(target=lambda: results.append(self.body.check().good)) for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(results, [True, True])


class Solids(unittest.TestCase):
    def test_laws(self):
        material = kerf.Material(young=2e5, poisson=0.25)
        rotation = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
        self.assertAlmostEqual(kerf.energy_density(material, rotation), 0)
        f, h = np.array([[1.1, 0.2, 0], [0, 0.9, 0.1], [0, 0, 1.05]]), 1e-6
        p = kerf.stress(material, f)
        for i in range(3):
            for j in range(3):
                d = np.zeros((3, 3))
                d[i, j] = h
                slope = (kerf.energy_density(material, f + d) - kerf.energy_density(material, f - d)) / (2 * h)
                self.assertAlmostEqual(p[i, j], slope, delta=1e-3 * abs(p).max())
        self.assertEqual(material.replace(young=1e6).young, 1e6)
        for bad in ({"young": -1}, {"poisson": 0.5}, {"model": "rubber"}):
            with self.assertRaises(kerf.InputError):
                kerf.Material(**bad)
        with self.assertRaisesRegex(TypeError, "young"):
            kerf.Material(yuong=3)

    def test_forces_and_steps(self):
        body = kerf.Body(solid(), spacing=0.2)
        deforming = kerf.DeformingSolid(body, kerf.Material(young=1e5, damping=0))
        self.assertAlmostEqual(deforming.mass.sum(), 1000, delta=1)
        u = 0.05 * np.sin(3 * body.nodes.positions)
        force = deforming.forces(u)
        np.testing.assert_allclose(force.sum(axis=0), 0, atol=1e-6 * abs(force).max())
        rate = np.random.default_rng(1).normal(size=u.shape)
        slope = (deforming.energy(u + 1e-6 * rate) - deforming.energy(u - 1e-6 * rate)) / 2e-6
        self.assertAlmostEqual(slope, -(force * rate).sum(), delta=1e-3 * abs(slope))
        gradient = deforming.gradients(body.nodes.positions @ np.diag([1, 2, 3.0]))
        np.testing.assert_allclose(gradient[10], np.diag([1, 2, 3.0]), atol=1e-6)
        state = deforming.rest()
        state.displacement = u
        empty = kerf.Environment(gravity=(0, 0, 0))
        with self.assertRaisesRegex(kerf.InputError, "ground: an Environment has no ground"):
            kerf.Environment(ground=True)
        velocity = state.velocity
        for _ in range(3):
            self.assertGreater(deforming.step_explicit(state, 1e-3, empty).substeps, 0)
        np.testing.assert_allclose(deforming.momentum(state), 0, atol=1e-6)
        self.assertEqual(abs(velocity).max(), 0)  # a snapshot
        fall = deforming.rest()
        deforming.step_implicit(fall, 0.01, kerf.Environment())
        np.testing.assert_allclose(fall.velocity[:, 2], -0.0981, rtol=1e-4)
        shown = kerf.von_mises_stress(deforming, body.nodes, state)
        self.assertEqual(shown.shape, (len(body),))
        self.assertEqual(kerf.material_displacement(deforming, body.graph, state).shape, u.shape)

    def test_cut_keeps_momentum(self):
        body = kerf.Body(solid(), spacing=0.2)
        deforming = kerf.DeformingSolid(body, kerf.Material())
        state = deforming.rest()
        state.velocity = np.cross([0, 0, 1.0], body.nodes.positions)
        momentum, spin = deforming.momentum(state), deforming.angular_momentum(state)
        front = body.front([[0.5, -0.1, -0.1], [0.5, 1.1, -0.1]])
        delta = body.split(front, [[0.5, -0.1, 1.1], [0.5, 1.1, 1.1]])
        deforming.update(body, delta, state)
        self.assertEqual(len(state), len(body))
        np.testing.assert_allclose(deforming.momentum(state), momentum, rtol=1e-6, atol=1e-6)
        np.testing.assert_allclose(deforming.angular_momentum(state), spin, rtol=1e-2)
        with self.assertRaises(kerf.InputError):
            deforming.update(body, delta, state)  # the same change again
        scratch = kerf.DeformingSolid(body, kerf.Material())
        self.assertEqual(scratch.energy(state), deforming.energy(state))

    def test_held_material(self):
        body = kerf.Body(solid(), spacing=0.2)
        deforming = kerf.DeformingSolid(body, kerf.Material(young=1e5))
        positions, box, none = body.nodes.positions, [-1, -1, -1, 0.35, 2, 2], np.empty((0, 6))
        fixed = positions[:, 0] <= 0.35
        u = 0.05 * np.sin(3 * positions) * ~fixed[:, None]
        plain = deforming.energy(u)

        def sag():
            state = deforming.rest()
            environment = kerf.Environment(gravity=(0, 0, -1), fixed=fixed)
            for _ in range(3):
                deforming.step_implicit(state, 10, environment)
            return -state.displacement[:, 2].min()

        of_nodes = sag()
        deforming.hold(body, [box])
        self.assertGreater(deforming.energy(u), 1.01 * plain)
        turned = positions @ np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]]) - positions
        self.assertLess(deforming.energy(turned), 1e-9 * plain)
        self.assertLess(sag(), of_nodes)
        held = deforming.energy(u)
        deforming.hold(body, [box])  # the same boxes
        self.assertEqual(deforming.energy(u), held)
        deforming.hold(body, none)
        self.assertEqual(deforming.energy(u), plain)
        for bad in (box, [box[:5]], [box[::-1]], [[np.nan] * 6]):
            with self.assertRaises(kerf.InputError, msg=str(bad)):
                deforming.hold(body, bad)
        with self.assertRaisesRegex(kerf.InputError, "another"):
            deforming.hold(kerf.Body(solid(), spacing=0.3), [box])

    def test_refused(self):
        body = kerf.Body(solid(), spacing=0.3)
        deforming = kerf.DeformingSolid(body, kerf.Material())
        state, n = deforming.rest(), len(body)
        for bad in (np.zeros((n - 1, 3)), np.zeros(n), np.full((n, 3), np.inf)):
            with self.assertRaises(kerf.InputError):
                deforming.energy(bad)
            with self.assertRaises(kerf.InputError):
                state.velocity = bad
        with self.assertRaises(kerf.InputError):
            deforming.step_explicit(state, 0, kerf.Environment())
        with self.assertRaises(kerf.InputError):
            deforming.step_explicit(state, 0.1, kerf.Environment(fixed=[True]))
        with self.assertRaises(kerf.InputError):
            deforming.momentum(kerf.State(np.zeros((2, 3))))
        with self.assertRaises(kerf.InputError):
            kerf.DeformingSolid(body, kerf.Materials([kerf.Material(), kerf.Material(young=1)], np.zeros(3, int)))


if __name__ == "__main__":
    unittest.main()
