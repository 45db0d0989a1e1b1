"""Tests libchronormal_c as an engine calls it, through ctypes: interleaved vertex buffers, memory of the caller, codes
and messages.

CHRONORMAL_C names the library; without it these tests are skipped.
"""

import ctypes
import os
import unittest
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_size_t, c_void_p

import numpy as np

from meshes import angle, blended, sheet, vertex_normals

LIBRARY = os.environ.get("CHRONORMAL_C")


class Mesh(ctypes.Structure):
    _fields_ = [("vertex_count", c_size_t), ("face_count", c_size_t), ("corners", c_void_p), ("offsets", c_void_p)]


class Vectors(ctypes.Structure):
    _fields_ = [("data", c_void_p), ("stride", c_size_t)]


class Options(ctypes.Structure):
    _fields_ = [("size", c_size_t), ("elements", c_int), ("separate", c_int), ("crease_angle", c_double),
                ("weighting", c_char_p), ("tolerance", c_double), ("all_threads", c_int)]


class Target(ctypes.Structure):
    _fields_ = [("count", c_size_t), ("vertices", c_void_p), ("deltas", Vectors)]


def pointer(array):
    return array.ctypes.data


@unittest.skipUnless(LIBRARY, "CHRONORMAL_C names no library")
class EngineTest(unittest.TestCase):
    def setUp(self):
        self.c = ctypes.CDLL(LIBRARY)
        self.c.chronormal_last_message.restype = c_char_p
        self.c.chronormal_version.restype = c_char_p
        for name in ("curves", "blend"):
            getattr(self.c, f"chronormal_{name}_size").restype = c_size_t
            getattr(self.c, f"chronormal_{name}_size").argtypes = [c_void_p]
            getattr(self.c, f"chronormal_{name}_destroy").argtypes = [c_void_p]
        self.c.chronormal_curves_unit_normals.argtypes = [c_void_p, c_double, Vectors, POINTER(c_size_t)]
        self.c.chronormal_curves_errors.argtypes = [c_void_p, c_double, Vectors, c_void_p]
        self.c.chronormal_curves_next.argtypes = [c_void_p, Vectors, Vectors]
        self.c.chronormal_blend_unit_normals.argtypes = [c_void_p, POINTER(c_double), Vectors, POINTER(c_size_t)]
        # Each row of the buffer is a vertex with a position, a normal and a texture coordinate, as in engines.
        self.p0, self.p1, faces = sheet()
        self.faces = np.ascontiguousarray(faces, dtype=np.uint32)
        self.buffer = np.zeros((12, 8), dtype=np.float32)
        self.buffer[:, :3] = self.p0
        self.mesh = Mesh(12, len(faces), pointer(self.faces), None)

    def curves(self, options=None):
        curves = c_void_p()
        code = self.c.chronormal_curves_create(byref(self.mesh), Vectors(pointer(self.buffer), 32),
                                               Vectors(pointer(self.p1), 0), options, byref(curves))
        self.assertEqual(code, 0, self.c.chronormal_last_message())
        self.addCleanup(self.c.chronormal_curves_destroy, curves)
        return curves

    def test_normals_go_into_the_vertex_buffer_frame_by_frame(self):
        curves = self.curves()
        self.assertEqual(self.c.chronormal_curves_size(curves), 12)
        normals = Vectors(pointer(self.buffer) + 12, 32)
        for t in np.linspace(0, 1, 7):
            zeros = c_size_t(99)
            self.assertEqual(self.c.chronormal_curves_unit_normals(curves, t, normals, byref(zeros)), 0)
            self.assertEqual(zeros.value, 0)
            truth = vertex_normals(blended(self.p0, self.p1, t), self.faces)
            self.assertLess(angle(self.buffer[:, 3:6], truth).max(), 2e-6)
        np.testing.assert_array_equal(self.buffer[:, :3], self.p0)
        self.assertFalse(self.buffer[:, 6:].any())

    def test_the_error_of_what_the_engine_shows_is_measured(self):
        curves = self.curves()
        degrees = np.zeros(12, dtype=np.float32)
        ends = [vertex_normals(p, self.faces) for p in (self.p0, self.p1)]
        lerp = (ends[0] + ends[1]).astype(np.float32)
        self.assertEqual(self.c.chronormal_curves_errors(curves, 0.5, Vectors(pointer(lerp), 0), pointer(degrees)), 0)
        truth = np.degrees(angle(lerp, vertex_normals(blended(self.p0, self.p1, 0.5), self.faces)))
        np.testing.assert_allclose(degrees, truth, atol=2e-4)

    def test_blend_shapes_follow_their_weights(self):
        deltas = self.p1 - self.p0
        moved = np.array([2, 5], dtype=np.uint32)
        lifts = np.array([[0, 0, 1], [0, 0.5, 1]], dtype=np.float32)
        targets = (Target * 2)(Target(12, None, Vectors(pointer(deltas), 0)), Target(2, pointer(moved), Vectors(pointer(lifts), 0)))
        blend = c_void_p()
        self.assertEqual(self.c.chronormal_blend_create(byref(self.mesh), Vectors(pointer(self.buffer), 32), targets,
                                                        c_size_t(2), None, byref(blend)), 0)
        self.addCleanup(self.c.chronormal_blend_destroy, blend)
        out = np.zeros((12, 3), dtype=np.float32)
        weights = (c_double * 2)(0.3, 0.8)
        self.assertEqual(self.c.chronormal_blend_unit_normals(blend, weights, Vectors(pointer(out), 0), None), 0)
        positions = self.p0.astype(float) + 0.3 * deltas
        positions[moved] += 0.8 * lifts
        self.assertLess(angle(out, vertex_normals(positions, self.faces)).max(), 2e-6)

    def test_what_is_wrong_has_a_code_and_a_message_with_its_place(self):
        curves = self.curves()
        bad = self.p1.copy()
        bad[4, 2] = np.nan
        code = self.c.chronormal_curves_next(curves, Vectors(pointer(self.p0), 0), Vectors(pointer(bad), 0))
        self.assertEqual(code, 3)
        self.assertIn(b"keyframe 1, vertex 4", self.c.chronormal_last_message())
        code = self.c.chronormal_curves_unit_normals(curves, 0.5, Vectors(pointer(self.buffer), 13), None)
        self.assertEqual((code, b"multiple of 4" in self.c.chronormal_last_message()), (2, True))
        self.faces[3, 1] = 12
        made = c_void_p()
        code = self.c.chronormal_curves_create(byref(self.mesh), Vectors(pointer(self.p0), 0), Vectors(pointer(self.p1), 0),
                                               None, byref(made))
        self.assertEqual((code, made.value), (3, None))
        self.assertIn(b"face 3, corner 1", self.c.chronormal_last_message())

    def test_options_begin_with_their_size(self):
        options = Options()
        self.c.chronormal_options_init(byref(options))
        self.assertEqual(options.size, ctypes.sizeof(Options))
        options.elements = 0
        self.assertEqual(self.c.chronormal_curves_size(self.curves(byref(options))), len(self.faces))
        options.size = 8
        code = self.c.chronormal_curves_create(byref(self.mesh), Vectors(pointer(self.p0), 0), Vectors(pointer(self.p1), 0),
                                               byref(options), byref(c_void_p()))
        self.assertEqual(code, 2)


if __name__ == "__main__":
    unittest.main()
