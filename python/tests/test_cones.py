"""Tests cones, bounds of meshlets and means over a shutter against samples in float64."""

import unittest

import numpy as np

import chronormal as cn
from meshes import blended, face_normals, sheet, unit


def wide_sheet(cells=16):
    """Return a grid that is bent over: positions (2, V, 3), faces (F, 3)."""
    x, y = np.meshgrid(np.linspace(0, 1, cells + 1), np.linspace(0, 1, cells + 1))
    flat = np.stack([x, y, 0.1 * np.sin(7 * x) * np.cos(5 * y)], axis=-1).reshape(-1, 3)
    bent = np.stack([np.sin(x), y + 0.1 * x, 1 - np.cos(x) + 0.1 * np.cos(6 * y)], axis=-1).reshape(-1, 3)
    corner = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).reshape(-1, 1)
    faces = np.concatenate([corner + [0, 1, cells + 2], corner + [0, cells + 2, cells + 1]])
    return np.stack([flat, bent]).astype(np.float32), faces


class ConesTest(unittest.TestCase):
    def test_contain_every_sampled_normal(self):
        p0, p1, faces = sheet()
        for start, end in ((0, 1), (0.25, 0.5)):
            found = cn.cones([p0, p1], faces, start=start, end=end)
            self.assertEqual(found["axis"].dtype, np.float32)
            self.assertEqual(found["face"].tolist(), list(range(len(faces))))
            for t in np.linspace(start, end, 21):
                cosine = np.sum(found["axis"] * unit(face_normals(blended(p0, p1, t), faces)), axis=1)
                self.assertTrue((np.degrees(np.arccos(np.minimum(cosine, 1))) <= found["half_angle"] + 0.03).all())

    def test_meshlets_are_not_rejected_while_one_of_their_faces_is_seen(self):
        positions, faces = wide_sheet()
        found = cn.cones(positions, faces, meshlets=32, start=0.2, end=0.6)
        meshlet_of = np.zeros(len(faces), int)
        meshlet_of[found["member_face"]] = found["member_meshlet"]
        rejected = 0
        for camera in np.random.default_rng(5).normal(size=(40, 3)) * 4:
            view = unit(found["meshlet_cone_apex"] - camera)
            culled = np.sum(view * found["meshlet_cone_axis"], axis=1) >= found["meshlet_cone_cutoff"]
            rejected += culled.sum()
            for t in np.linspace(0.2, 0.6, 9):
                p = blended(positions[0], positions[1], t)
                is_front = np.sum(face_normals(p, faces) * (camera - p[faces[:, 0]]), axis=1) > 0
                self.assertFalse((is_front & culled[meshlet_of]).any())
        self.assertGreater(rejected, 50)

    def test_means_are_those_of_many_samples(self):
        p0, p1, faces = sheet()
        found = cn.shutter([p0, p1], faces, start=0.1, end=0.9)
        normals = [face_normals(blended(p0, p1, t), faces) for t in 0.1 + 0.8 * (np.arange(1000) + 0.5) / 1000]
        np.testing.assert_allclose(found["mean_unit"], np.mean([unit(n) for n in normals], axis=0), atol=1e-4)
        np.testing.assert_allclose(found["mean"], np.mean(normals, axis=0), atol=1e-5)
        self.assertTrue((found["error"] < 1e-5).all())
        there_and_back = cn.shutter([p0, p1, p0], faces)
        np.testing.assert_allclose(there_and_back["span_mean_unit"], there_and_back["mean_unit"][:len(faces)], atol=1e-7)

    def test_misuse_names_the_argument(self):
        p0, p1, faces = sheet()
        for arguments, place in (({"meshlets": 3}, "--meshlets"), ({"start": 1, "end": 1}, "end: the last time")):
            with self.assertRaisesRegex(ValueError, place):
                cn.cones([p0, p1], faces, **arguments)
        with self.assertRaisesRegex(ValueError, "positions: the shape"):
            cn.shutter(p0, faces)


if __name__ == "__main__":
    unittest.main()
