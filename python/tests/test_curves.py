"""Tests curves and blends: true normals, the memory that is read and written, and messages about invalid arguments."""

import gc
import threading
import tracemalloc
import unittest

import numpy as np

import chronormal as cn
from meshes import QUADS, angle, blended, face_normals, sheet, unit, vertex_normals


class CurvesTest(unittest.TestCase):
    def test_normals_of_vertices_are_those_of_cross_products(self):
        p0, p1, faces = sheet()
        curves = cn.curves(p0, p1, faces)
        for t in (0, 0.25, 0.7, 1):
            normals = curves.unit_normals(t)
            self.assertEqual(normals.dtype, np.float32)
            self.assertLess(angle(normals, vertex_normals(blended(p0, p1, t), faces)).max(), 2e-6)

    def test_normals_of_faces_and_corners_are_those_of_cross_products(self):
        p0, p1, faces = sheet(triangles=False)
        truth = unit(face_normals(blended(p0, p1, 0.3), faces))
        self.assertLess(angle(cn.curves(p0, p1, faces, elements="faces").unit_normals(0.3), truth).max(), 2e-6)
        hard = cn.curves(p0, p1, faces, elements="corners", crease=0).unit_normals(0.3)
        self.assertLess(angle(hard, np.repeat(truth, 4, axis=0)).max(), 2e-6)
        smooth = cn.curves(p0, p1, faces, elements="corners").unit_normals(0.3)
        self.assertLess(angle(smooth, vertex_normals(blended(p0, p1, 0.3), faces)[faces.reshape(-1)]).max(), 2e-6)

    def test_many_times_are_rows_of_the_same_bits(self):
        p0, p1, faces = sheet()
        curves = cn.curves(p0, p1, faces)
        times = [0, 0.5, 1]
        many = curves.unit_normals(times)
        self.assertEqual(many.shape, (3, 12, 3))
        for row, t in zip(many, times):
            np.testing.assert_array_equal(row, curves.unit_normals(t))
        self.assertEqual(curves.unit_normals(np.float32(0.5)).shape, (12, 3))
        self.assertEqual(curves.unit_normals([]).shape, (0, 12, 3))

    def test_faces_may_be_of_any_integers_and_of_any_size(self):
        p0, p1, faces = sheet(triangles=False)
        truth = cn.curves(p0, p1, faces).unit_normals(0.5)
        offsets = np.arange(0, 25, 4)
        for same in (faces.astype(np.int32), faces.astype(np.uint32), faces.astype(np.int64), faces.tolist(),
                     (offsets, faces.reshape(-1)), faces.astype(np.int32)[:, ::-1][:, ::-1]):
            np.testing.assert_array_equal(cn.curves(p0, p1, same).unit_normals(0.5), truth)
        mixed = faces.tolist()[:5] + [[6, 7, 11], [6, 11, 10]]
        normals = cn.curves(p0, p1, mixed).unit_normals(0.5)
        self.assertLess(angle(normals, vertex_normals(blended(p0, p1, 0.5), mixed)).max(), 2e-6)

    def test_float64_and_other_layouts_are_rounded_once(self):
        p0, p1, faces = sheet()
        truth = cn.curves(p0, p1, faces).unit_normals(0.5)
        wide = np.zeros((12, 5), dtype=np.float32)
        wide[:, 1:4] = p0
        for same in (p0.astype(np.float64), p0.tolist(), np.asfortranarray(p0), wide[:, 1:4], p0.astype(">f4")):
            np.testing.assert_array_equal(cn.curves(same, p1, faces).unit_normals(0.5), truth)

    def test_results_go_to_the_memory_of_out(self):
        p0, p1, faces = sheet()
        curves = cn.curves(p0, p1, faces)
        out = np.full((12, 3), 7, dtype=np.float32)
        address = out.__array_interface__["data"][0]
        result = curves.unit_normals(0.5, out=out)
        self.assertIs(result, out)
        self.assertEqual(result.__array_interface__["data"][0], address)
        np.testing.assert_array_equal(out, curves.unit_normals(0.5))
        rows = np.zeros((4, 12, 3), dtype=np.float32)
        curves.unit_normals(0.5, out=rows[2])  # rows[2] is a part of a larger array
        np.testing.assert_array_equal(rows[2], out)
        self.assertEqual(rows[[0, 1, 3]].any(), False)

    def test_float32_is_read_where_it_is(self):
        p0 = np.zeros((200_000, 3), dtype=np.float32)
        p0[:, 0] = np.arange(200_000)
        p0[1::2, 1] = 1
        p0.flags.writeable = False
        faces = np.stack([np.arange(0, 199_998), np.arange(1, 199_999), np.arange(2, 200_000)], 1).astype(np.uint32)
        self.assertEqual(cn._vectors(p0, "p0").__array_interface__["data"], p0.__array_interface__["data"])
        out = np.empty_like(p0)
        gc.collect()
        tracemalloc.start()  # NumPy reports the memory of its arrays to tracemalloc
        curves = cn.curves(p0, p0, faces)
        curves.unit_normals(0.5, out=out)
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        self.assertLess(peak, p0.nbytes // 10)

    def test_next_prepares_another_segment(self):
        p0, p1, faces = sheet(1)
        q0, q1, _ = sheet(2)
        curves = cn.curves(p0, p1, faces)
        curves.next(q0.astype(np.float64), q1)
        np.testing.assert_array_equal(curves.unit_normals(0.5), cn.curves(q0, q1, faces).unit_normals(0.5))
        with self.assertRaisesRegex(ValueError, "keyframe 1, vertex 3"):
            bad = q1.copy()
            bad[3, 0] = np.nan
            curves.next(q0, bad)
        np.testing.assert_array_equal(curves.unit_normals(0.5), cn.curves(q0, q1, faces).unit_normals(0.5))

    def test_errors_are_angles_in_degrees(self):
        p0, p1, faces = sheet()
        curves = cn.curves(p0, p1, faces)
        ends = curves.unit_normals([0, 1])
        linear = 0.5 * (ends[0] + ends[1])
        degrees = curves.errors(0.5, linear)
        self.assertEqual((degrees.shape, degrees.dtype), ((12,), np.float32))
        truth = np.degrees(angle(linear, vertex_normals(blended(p0, p1, 0.5), faces)))
        np.testing.assert_allclose(degrees, truth, atol=2e-4)
        linear[4] = 0
        self.assertTrue(np.isnan(curves.errors(0.5, linear)[4]))
        self.assertEqual(curves.errors([0, 1], ends).shape, (2, 12))
        self.assertLess(curves.errors([0, 1], ends).max(), 1e-4)

    def test_other_weightings_are_within_their_bound(self):
        p0, p1, faces = sheet()
        curves = cn.curves(p0, p1, faces, weighting="angle")
        self.assertGreater(curves.fit_bound, 0)
        self.assertEqual(cn.curves(p0, p1, faces).fit_bound, 0)

    def test_repr_says_what_there_is(self):
        p0, p1, faces = sheet()
        text = repr(cn.curves(p0, p1, faces, tolerance=1e-3))
        self.assertIn("12 vertices", text)
        self.assertIn("tolerance 0.001", text)
        self.assertEqual(len(cn.curves(p0, p1, faces, elements="faces")), 12)
        self.assertIn("2 targets", repr(cn.blend(p0, np.stack([p1, p0]), faces)))

    def test_other_threads_run_while_normals_are_computed(self):
        p0, p1, faces = sheet()
        curves = cn.curves(np.tile(p0, (5000, 1)), np.tile(p1, (5000, 1)),
                           (faces + 12 * np.arange(5000)[:, None, None]).reshape(-1, 3), weld=False)
        out = np.empty((100, 60000, 3), dtype=np.float32)
        curves.unit_normals(np.linspace(0, 1, 100), out=out)  # allocates the scratch memory before the measurement
        working = threading.Thread(target=curves.unit_normals, args=(np.linspace(0, 1, 100), out))
        rounds = 0
        working.start()
        while working.is_alive():
            rounds += 1
        self.assertGreater(rounds, 1000)

    def test_one_object_serves_many_threads(self):
        p0, p1, faces = sheet()
        curves = cn.curves(p0, p1, np.concatenate([faces] * 50))
        truth = {t: curves.unit_normals(t).copy() for t in (0.1, 0.5, 0.9)}
        wrong = []

        def work(t):
            for _ in range(300):
                if not np.array_equal(curves.unit_normals(t, threads=2), truth[t]):
                    wrong.append(t)

        threads = [threading.Thread(target=work, args=(t,)) for t in truth]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])


class BlendTest(unittest.TestCase):
    def test_normals_are_those_of_blended_positions(self):
        base, target, faces = sheet()
        deltas = np.stack([target - base, np.roll(base, 1, axis=1)])
        blend = cn.blend(base, deltas, faces)
        for weights in ([0, 0], [1, 0], [0.3, 0.9], [-1, 2]):
            positions = base.astype(np.float64) + np.tensordot(weights, deltas.astype(np.float64), 1)
            self.assertLess(angle(blend.unit_normals(weights), vertex_normals(positions, faces)).max(), 2e-6)
        many = blend.unit_normals([[0, 0], [0.3, 0.9]])
        np.testing.assert_array_equal(many[1], blend.unit_normals(np.array([0.3, 0.9])))

    def test_targets_may_name_the_vertices_that_they_move(self):
        base, target, faces = sheet()
        dense = np.zeros_like(base)
        dense[[2, 5]] = [[0, 0, 1], [1, 0, 0]]
        sparse = (np.array([2, 5]), dense[[2, 5]])
        whole = cn.blend(base, [dense, target - base], faces).unit_normals([0.7, 0.2])
        np.testing.assert_array_equal(cn.blend(base, [sparse, target - base], faces).unit_normals([0.7, 0.2]), whole)
        out = np.empty((12, 3), dtype=np.float32)
        self.assertIs(cn.blend(base, [sparse], faces).unit_normals([1], out=out), out)

    def test_what_does_not_fit_is_said_with_its_place(self):
        base, target, faces = sheet()
        blend = cn.blend(base, [target - base], faces)
        for call, words in ((lambda: blend.unit_normals([1, 2]), r"weights: the shape must be \(1,\) or \(T, 1\), with a weight for each target, but is \(2,\)"),
                            (lambda: cn.blend(base, [target[:3]], faces), r"deltas\[0\]: the target must have a delta for each vertex of the mesh, which has 12, but the target has 3"),
                            (lambda: cn.blend(base, [([5, 2], target[:2])], faces), "target 0, entry 1"),
                            (lambda: cn.blend(base, [([99], target[:1])], faces), "target 0, entry 0"),
                            (lambda: cn.blend(base, [([1, 2], target[:1])], faces), "target 0"),
                            (lambda: cn.blend(base, [], []), "no faces")):
            with self.assertRaisesRegex(ValueError, words):
                call()


class ErrorsTest(unittest.TestCase):
    def test_what_does_not_fit_is_said_with_its_place(self):
        p0, p1, faces = sheet()
        curves = cn.curves(p0, p1, faces)
        read_only = np.zeros((12, 3), dtype=np.float32)
        read_only.flags.writeable = False
        infinite = p0.astype(np.float64)
        infinite[7, 1] = 1e300
        float32 = np.float32
        for call, words in (
                (lambda: cn.curves(p0[:5], p1, faces), "face 0, corner 2|face 2|keyframe"),
                (lambda: cn.curves(p0, p1[:5], faces),
                 "keyframe 1: the keyframe has 5 positions, but the mesh has 12 vertices; give one position for each vertex"),
                (lambda: cn.curves(p0[:, :2], p1, faces), r"p0: the shape must be \(n, 3\), a vector in each of n rows, but is \(12, 2\)"),
                (lambda: cn.curves(p0.astype(complex), p1, faces), "p0: the array must hold real numbers, best as float32"),
                (lambda: cn.curves(infinite, p1, faces), "keyframe 0, vertex 7: the position is NaN or infinite; positions must be finite numbers"),
                (lambda: cn.curves(p0, p1, [[0, 1, 99]]), "face 0, corner 2: the corner refers to vertex 99"),
                (lambda: cn.curves(p0, p1, [[0, 1, -2]]), r"faces\[0, 2\]: -2 cannot be an index"),
                (lambda: cn.curves(p0, p1, [[0, 1, 2 ** 40]]), r"faces\[0, 2\]: 1099511627776 cannot be an index"),
                (lambda: cn.curves(p0, p1, [[0, 1]]), r"faces: the shape is \(1, 2\)"),
                (lambda: cn.curves(p0, p1, faces.astype(float)), "faces: the type must be int32"),
                (lambda: cn.curves(p0, p1, []), "the mesh has no faces, so it has no normals; give it faces"),
                (lambda: cn.curves(p0, p1, (np.array([0, 3]), np.array([0, 1]))), "offsets|face|corners"),
                (lambda: cn.curves(p0, p1, (np.array([], int), np.array([0, 1, 2]))), "offsets: there must be one more"),
                (lambda: cn.curves(p0, p1, faces, elements="edges"), "faces, vertices or corners"),
                (lambda: cn.curves(p0, p1, faces, weighting="mass"), "area, angle"),
                (lambda: cn.curves(p0, p1, faces, elements="faces", weighting="angle"), "weighting: a weighting has no meaning for normals of faces"),
                (lambda: cn.curves(p0, p1, faces, crease=30), "crease: only corners can have hard edges"),
                (lambda: cn.curves(p0, p1, faces, elements="corners", crease=200), "crease"),
                (lambda: cn.curves(p0, p1, faces, tolerance=0), "tolerance"),
                (lambda: cn.curves(p0, p1, faces, tolerance=1e-3).control_normals,
                 "^control_normals: compact curves keep no control normals; make the curves with tolerance=1e-6$"),
                (lambda: cn.curves(p0, p1, faces, threads=-1), "threads"),
                (lambda: curves.unit_normals("now"), "t: the value must be a number"),
                (lambda: curves.unit_normals([[0.5]]), r"t: the shape must be .*but is \(1, 1\)"),
                (lambda: curves.unit_normals(0.5, out=np.zeros((12, 3))), "out: out must be a C-contiguous array"),
                (lambda: curves.unit_normals(0.5, out=np.zeros((3, 12), float32).T), "out: out must be a C-cont"),
                (lambda: curves.unit_normals(0.5, out=np.zeros((12, 3), ">f4")), "out: out must be a C-cont"),
                (lambda: curves.unit_normals(0.5, out=[1, 2]), "out: out must be a C-cont"),
                (lambda: curves.unit_normals(0.5, out=np.zeros((11, 3), float32)), r"out: the shape must be .*but is \(11, 3\)"),
                (lambda: curves.unit_normals([0.5], out=np.zeros((12, 3), float32)), r"must be \(1, 12, 3\)"),
                (lambda: curves.unit_normals(0.5, out=read_only), "out: the array is read-only; give one that can be written"),
                (lambda: curves.errors(0.5, p0[:3]), r"normals: the shape must be \(12, 3\), a vector for each normal, but is \(3, 3\)")):
            with self.assertRaisesRegex(ValueError, words):
                call()

    def test_arguments_of_any_kind_are_refused_or_taken_and_never_crash(self):
        p0, p1, faces = sheet()
        random = np.random.default_rng(20260101)  # seeds everything that follows
        odd = [None, 3, -1.5, "x", b"abc", [], [[]], [[1, 2], [3]], {}, np.array(3), np.array([], np.float32),
               np.zeros((0, 3), np.float32), np.zeros((12, 3), np.float16), np.full((12, 3), np.nan, np.float32),
               np.full((12, 3), np.inf), np.zeros((12, 3), bool), np.zeros((12, 3), object), np.zeros((12, 4), np.float32),
               np.zeros((2, 12, 3), np.float32), np.zeros((12, 3), "U4"), p0[::-1], p0[:, ::-1], p0[::2],
               np.broadcast_to(np.float32(1), (12, 3)), np.frombuffer(b"\0" * 145, np.uint8)[1:].view(np.float32).reshape(12, 3),
               faces, faces[:, :2], -faces, faces + 10 ** 12, faces.astype(np.uint8), np.array([[0, 1, 2 ** 32 - 1]]),
               (np.array([0, 3, 2, 6]), np.arange(6)), (np.array([0, 4]), np.arange(3)), p0.view(np.int32), np.ma.array(p0),
               np.lib.stride_tricks.as_strided(p0, (12, 3), (0, 4))]
        curves, blend = cn.curves(p0, p1, faces), cn.blend(p0, [p1 - p0], faces)
        taken = 0
        for _ in range(3000):
            a, b, c = (odd[random.integers(len(odd))] for _ in range(3))
            which = random.integers(6)
            calls = (lambda: cn.curves(a, b, faces).unit_normals(0.5), lambda: cn.curves(p0, p1, a).unit_normals(0.5),
                     lambda: curves.unit_normals(a, out=b), lambda: curves.errors(a, b), lambda: blend.unit_normals(a, out=b),
                     lambda: cn.blend(a, [b, (c, b)], faces).unit_normals([1, 1]))
            try:
                calls[which]()
                taken += 1
            except (ValueError, TypeError, OverflowError):
                pass
        self.assertGreater(taken, 30)
        for kind in (cn.Curves, cn.Blend, cn.Motion):
            unmade = kind.__new__(kind)
            for name in dir(kind):
                if name.startswith("_") and name not in ("__len__", "__repr__"):
                    continue
                member = getattr(kind, name)
                try:
                    member.__get__(unmade) if isinstance(member, property) else member(unmade)
                except (ValueError, TypeError):
                    pass
            with self.assertRaisesRegex(ValueError, "self: the object is not ready"):
                unmade.unit_normals([0.5])
        for t in (np.nan, np.inf, -np.inf, 1e300, -5.0):  # invalid fractions and weights are reported
            with self.assertRaisesRegex(ValueError, "^t: "):
                curves.unit_normals(t)
            if np.isfinite(t):
                self.assertEqual(blend.unit_normals([t]).shape, (12, 3))
            else:
                with self.assertRaisesRegex(ValueError, "^weights: "):
                    blend.unit_normals([t])


if __name__ == "__main__":
    unittest.main()
