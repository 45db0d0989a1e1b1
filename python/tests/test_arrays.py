"""Tests arrays in place of files: motions that are made, pickled, judged and baked; schemes; control normals; and
invalid arguments."""

import base64
import copy
import json
import os
import pickle
import tempfile
import typing
import unittest

import numpy as np

import chronormal as cn

SEED = 20261127


def walk(random, keyframes=5, size=6):
    """Return a sheet of triangles that is bent at random in every keyframe."""
    x, y = np.meshgrid(np.arange(size, dtype=np.float32), np.arange(size, dtype=np.float32))
    flat = np.stack([x, y, 0 * x], -1).reshape(-1, 3)
    positions = np.stack([flat + random.normal(0, 0.2, flat.shape) for _ in range(keyframes)]).astype(np.float32)
    faces = [face for v in range(size * (size - 1)) if v % size < size - 1
             for face in ((v, v + 1, v + size), (v + 1, v + size + 1, v + size))]
    return positions, np.array(faces), np.cumsum(random.uniform(0.5, 1.5, keyframes))


def face_normals(positions, faces):
    """Return the normals of faces by cross products in float64."""
    a, b, c = (positions[faces[:, k]].astype(np.float64) for k in range(3))
    return np.cross(b - a, c - a)


def mesh_at_rest():
    with tempfile.TemporaryDirectory() as folder:
        name = os.path.join(folder, "m.obj")
        with open(name, "w", encoding="ascii") as file:
            file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        return cn.read(name)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


class MotionTest(unittest.TestCase):
    def setUp(self):
        print(f"seed {SEED}")
        self.random = np.random.default_rng(SEED)
        self.positions, self.faces, self.times = walk(self.random)
        self.motion = cn.motion(self.positions, self.faces, self.times)

    def test_has_the_arrays_that_it_was_made_of(self):
        self.assertTrue(np.array_equal(self.motion.positions, self.positions))
        self.assertTrue(np.array_equal(self.motion.faces, self.faces))
        self.assertTrue(np.array_equal(self.motion.times, self.times))
        self.assertEqual(self.motion.kind, "sequence")
        self.assertEqual(cn.motion(self.positions, self.faces).times.tolist(), [0, 1, 2, 3, 4])

    def test_finds_what_a_file_with_the_same_arrays_finds(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "walk.npz")
            np.savez(file, positions=self.positions, faces=self.faces, times=self.times)
            for ask in (cn.audit, lambda source: cn.audit(source, rule="slerp", samples=7, tolerance=2),
                        lambda source: cn.compare(source, schemes=["linear", "slerp"]),
                        lambda source: cn.compare(source, elements="vertices", tolerance=1),
                        lambda source: cn.compare(source, face=(1, 2), schemes=["linear"])):
                found, expected = ask(self.motion), ask(file)
                found.pop("input"), expected.pop("input")
                self.assertEqual(found, expected)
            for options in ({}, {"scheme": "linear", "elements": "faces"}):
                (found,), (expected,) = cn.errors(self.motion, **options), cn.errors(file, **options)
                self.assertTrue(np.array_equal(found.errors, expected.errors, equal_nan=True))
            self.assertEqual(cn.bake(self.motion)[0], cn.bake(file)[0])
            self.assertEqual(cn.inspect(cn.read(file)), cn.inspect(file))
            self.assertEqual(cn.inspect(self.motion)["input"]["segments"], len(self.times) - 1)
            self.assertEqual(cn.inspect(mesh_at_rest())["input"]["segments"], 0)
            moments = self.times[:-1] + 0.25
            self.assertTrue(np.array_equal(self.motion.unit_normals(moments), cn.read(file).unit_normals(moments)))

    def test_says_what_it_cannot_be_asked(self):
        for name, value in {"fps": 2, "path": "catmull-rom", "animation": "a", "base": "b.obj", "loop": True}.items():
            with self.assertRaisesRegex(ValueError, f"^{name}: "):
                cn.audit(self.motion, **{name: value})
        with self.assertRaisesRegex(ValueError, "does not move"):
            cn.audit(mesh_at_rest())
        with self.assertRaisesRegex(ValueError, "two keyframes"):
            cn.motion(self.positions[:1], self.faces)
        with self.assertRaises(ValueError):
            cn.motion(self.positions, self.faces, self.times[::-1])

    def test_a_figure_has_the_exact_normals_of_its_face_and_the_errors_of_schemes(self):
        figure = cn.compare(self.motion, face=(1, 2), schemes=["linear", "quaternion:edge"], samples=11)["figure"]
        t = np.linspace(0, 1, 11)
        ends = [unit(n) for n in np.array(figure["normals"]).reshape(-1, 3)[[0, -1]]]
        corners = (1 - t)[:, None, None] * self.positions[2][self.faces[1]] + t[:, None, None] * self.positions[3][self.faces[1]]
        exact = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        np.testing.assert_allclose(np.array(figure["normals"]).reshape(-1, 3), unit(exact), atol=1e-6)
        np.testing.assert_allclose(figure["lengths"], np.linalg.norm(exact, axis=1), rtol=1e-6)
        linear = unit((1 - t)[:, None] * ends[0] + t[:, None] * ends[1])
        degrees = np.degrees(np.arccos(np.clip((linear * unit(exact)).sum(1), -1, 1)))
        np.testing.assert_allclose(figure["schemes"][0]["degrees"], degrees, atol=1e-3)
        self.assertEqual(figure["schemes"][1]["scheme"], "quaternion:edge")
        with self.assertRaisesRegex(ValueError, "there is no face"):
            cn.compare(self.motion, face=10**6)
        with self.assertRaisesRegex(ValueError, "^certify: this option cannot be used with face"):
            cn.compare(self.motion, face=0, certify=True)

    def test_is_pickled_and_copied_with_all_it_has(self):
        quads = cn.motion(self.positions, [[0, 1, 7, 6], [1, 2, 8]])
        for made in (self.motion, quads, cn.read(sample="twist"), mesh_at_rest()):
            ways = [pickle.loads(pickle.dumps(made, p)) for p in range(pickle.HIGHEST_PROTOCOL + 1)]
            for again in ways + [copy.copy(made), copy.deepcopy(made)]:
                self.assertEqual(repr(again), repr(made))
                self.assertEqual(again.names, made.names)
                self.assertEqual(again.origin, made.origin)
                for name in ("positions", "times", "segments"):
                    self.assertTrue(np.array_equal(getattr(again, name), getattr(made, name)), name)
                times = None if made.kind == "mesh" else made.times
                self.assertTrue(np.array_equal(again.unit_normals(times), made.unit_normals(times)))

    def test_refuses_a_state_that_no_pickle_has(self):
        state = self.motion.__getstate__()
        for i in range(len(state)):
            for wrong in (None, -1, "x", [], [(1, 2)], [0, 3, 1 << 40]):
                broken = cn.Motion.__new__(cn.Motion)
                with self.assertRaises((ValueError, TypeError, RuntimeError)):
                    broken.__setstate__((*state[:i], wrong, *state[i + 1:]))
                    # Some members of the state accept every value of their type, so the test raises the expected error
                    # itself.
                    raise ValueError


class SchemeTest(unittest.TestCase):
    def test_names_are_those_that_compare_knows(self):
        names = list(cn.schemes())
        self.assertIn("linear", names)
        self.assertTrue(all(cn.schemes().values()))
        found = cn.compare(sample="bend", schemes=[name for name in names if ":" not in name], samples=2)
        self.assertGreater(len(found["schemes"]), 5)

    def test_linear_and_slerp_are_what_they_are_called(self):
        print(f"seed {SEED}")
        random = np.random.default_rng(SEED)
        positions, faces, _ = walk(random, 2)
        first, last = (unit(face_normals(p, faces)) for p in positions)
        angle = np.arccos(np.clip((first * last).sum(-1, keepdims=True), -1, 1))
        for t in (0, 0.3, 1, random.uniform()):
            linear = cn.interpolate("linear", positions[0], positions[1], faces, t)
            self.assertEqual(linear.shape, (len(faces), 3))
            self.assertLess(np.abs(linear - unit((1 - t) * first + t * last)).max(), 1e-5)
            slerp = unit(np.sin((1 - t) * angle) * first + np.sin(t * angle) * last)
            self.assertLess(np.abs(cn.interpolate("slerp", *positions, faces, t) - slerp).max(), 1e-5)
        many = cn.interpolate("linear", *positions, faces, [0, 0.5], elements="vertices")
        self.assertEqual(many.shape, (2, positions.shape[1], 3))
        exact = cn.curves(*positions, faces).unit_normals(0)
        self.assertLess(np.abs(many[0] - exact).max(), 1e-6)
        with self.assertRaisesRegex(ValueError, "bicubic"):
            cn.interpolate("bicubic", *positions, faces, 0.5)


class CurvesTest(unittest.TestCase):
    def setUp(self):
        print(f"seed {SEED}")
        self.positions, self.faces, _ = walk(np.random.default_rng(SEED), 2)
        self.curves = cn.curves(*self.positions, self.faces, elements="faces")

    def test_control_normals_are_those_of_the_quadratic(self):
        control = self.curves.control_normals
        self.assertEqual((control.shape, control.dtype), ((len(self.faces), 3, 3), np.float32))
        for t in (0, 0.25, 0.7, 1):
            n = (1 - t) ** 2 * control[:, 0] + 2 * t * (1 - t) * control[:, 1] + t * t * control[:, 2]
            between = (1 - t) * self.positions[0].astype(np.float64) + t * self.positions[1]
            self.assertLess(np.abs(n - face_normals(between, self.faces)).max(), 1e-5)
        with self.assertRaisesRegex(ValueError, "1e-6"):
            cn.curves(*self.positions, self.faces, tolerance=1e-3).control_normals

    def test_t_outside_of_the_segment_is_refused(self):
        for t, place in ((-1e-9, "t"), (1.5, "t"), (float("nan"), "t"), (float("inf"), "t"),
                         ([0, 0.5, 2], r"t\[2\]"), (np.array([np.nan]), r"t\[0\]")):
            for call in (self.curves.unit_normals, lambda t: self.curves.errors(t, np.zeros(np.shape(t) + (len(self.faces), 3)))):
                with self.assertRaisesRegex(ValueError, f"^{place}: the value must be from 0 to 1"):
                    call(t)
        blend = cn.blend(self.positions[0], [self.positions[1]], self.faces)
        with self.assertRaisesRegex(ValueError, "weight 0 is NaN or infinite; give finite weights"):
            blend.unit_normals([float("nan")])

    def test_a_tuple_of_two_faces_is_two_faces(self):
        for faces in (((0, 1, 2), (2, 1, 7)), ([0, 1, 2], [2, 1, 7]), ((0, 3, 4), (1, 2, 7)), ((0, 1, 2, 3), (4, 5, 6, 7)),
                      (np.array([0, 1, 2]), np.array([0, 2, 3])), (np.array([0, 3, 4]), [1, 2, 7])):
            as_tuple = cn.curves(*self.positions, tuple(faces), elements="faces")
            self.assertEqual(len(as_tuple), 2)
            as_array = cn.curves(*self.positions, np.array(faces), elements="faces")
            self.assertTrue(np.array_equal(as_tuple.unit_normals(0.5), as_array.unit_normals(0.5)))
        corners = [0, 1, 7, 6, 1, 2, 8]
        for offsets in ([0, 4, 7], np.array([0, 4, 7])):
            self.assertEqual(len(cn.curves(*self.positions, (offsets, corners), elements="faces")), 2)
        with_quad = (np.array([0, 1, 2]), np.array([0, 2, 3, 8]))
        self.assertEqual(len(cn.curves(*self.positions, with_quad, elements="faces")), 2)
        with self.assertRaisesRegex(ValueError, "offset"):
            cn.curves(*self.positions, (np.array([0, 4, 8]), np.array(corners)))

    def test_every_weighting_of_the_program_has_a_type(self):
        names = typing.get_args(cn._Weighting)
        with self.assertRaises(ValueError) as refused:
            cn.curves(*self.positions, self.faces, weighting="mass")
        self.assertTrue(str(refused.exception).endswith(", ".join(names)), refused.exception)
        for name in names:
            cn.curves(*self.positions, self.faces, weighting=name)


class FileOptionTest(unittest.TestCase):
    def test_a_loop_comes_back_to_its_first_keyframe(self):
        with tempfile.TemporaryDirectory() as folder:
            for k in range(3):
                with open(os.path.join(folder, f"m_{k}.obj"), "w", encoding="ascii") as file:
                    file.write(f"v 0 0 0\nv 1 0 0\nv 0 1 {k}\nf 1 2 3\n")
            self.assertEqual(cn.read(folder).positions.shape, (3, 3, 3))
            looped = cn.read(folder, loop=True).positions
            self.assertEqual(looped.shape, (4, 3, 3))
            self.assertTrue(np.array_equal(looped[3], looped[0]))
            self.assertEqual(len(cn.errors(folder, scheme="linear", loop=True, samples=2)[0].errors), 6)

    def test_strict_refuses_what_is_read_in_part(self):
        triangle = np.array([0, 0, 0, 1, 0, 0, 0, 1, 0], dtype="<f4").tobytes()
        document = {"asset": {"version": "2.0"}, "extensionsUsed": ["EXT_nobody_knows"], "extensionsRequired": ["EXT_nobody_knows"],
                    "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,"
                                                          + base64.b64encode(triangle).decode()}],
                    "bufferViews": [{"buffer": 0, "byteLength": 36}],
                    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                                   "min": [0, 0, 0], "max": [1, 1, 0]}],
                    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}]}
        text = json.dumps(document).encode()
        self.assertEqual(cn.inspect(text)["command"], "inspect")
        with self.assertRaisesRegex(ValueError, "EXT_nobody_knows"):
            cn.inspect(text, strict=True)


if __name__ == "__main__":
    unittest.main()
