"""Tests that no sampled error is above the upper bound of a certificate, and that the error reaches the lower bound at
the named time."""

import unittest

import numpy as np

import chronormal as cn
from meshes import angle, blended, face_normals, sheet, unit


def linear(p0, p1, faces, t):
    return unit((1 - t) * unit(face_normals(p0, faces)) + t * unit(face_normals(p1, faces)))


class CertifyTest(unittest.TestCase):
    def test_no_sample_is_above_the_bounds(self):
        p0, p1, faces = sheet()
        p0, p1 = p0.astype(float), p1.astype(float)
        bounds = cn.certify(p0, p1, faces)
        self.assertEqual(set(bounds), {"lower", "upper", "at", "from", "to"})
        worst = np.zeros(len(faces))
        for t in np.linspace(0, 1, 101):
            worst = np.maximum(worst, np.degrees(angle(linear(p0, p1, faces, t), unit(face_normals(blended(p0, p1, t), faces)))))
        self.assertGreater(worst.max(), 1)
        self.assertTrue((worst <= bounds["upper"] + 1e-4).all())
        self.assertTrue((worst >= bounds["lower"] - 0.01 * worst - 1e-3).all())
        self.assertTrue((bounds["lower"] <= bounds["upper"]).all())
        self.assertLess(cn.certify(p0, p1, faces, "polynomial", threads=1)["upper"].max(), 1e-3)

    def test_what_does_not_fit_is_refused_with_its_place(self):
        p0, p1, faces = sheet()
        for call, words in ((lambda: cn.certify(p0, p1[1:], faces), "p1"),
                            (lambda: cn.certify(p0, p1, faces, "none"), "none"),
                            (lambda: cn.certify(p0, np.full_like(p1, np.nan), faces), "frame 1, vertex 0"),
                            (lambda: cn.certify(p0, p1, faces, threads=-1), "threads")):
            with self.assertRaisesRegex(ValueError, words):
                call()


if __name__ == "__main__":
    unittest.main()
