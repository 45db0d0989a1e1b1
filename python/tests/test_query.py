"""Questions about whole intervals: answers on arrays are those of the program, and right by hand."""

import unittest

import numpy as np

import chronormal as cn

# Two triangles of a square. The last vertex crosses the diagonal and goes back.
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], np.float32)
FOLDED = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0]], np.float32)
KEYFRAMES, FACES = np.array([SQUARE, FOLDED, SQUARE]), [[0, 1, 2], [1, 3, 2]]


class QueryTest(unittest.TestCase):
    def test_collapses_have_their_instant_and_both_limits(self):
        found = cn.collapse(KEYFRAMES, FACES, times=[0, 2, 3])
        self.assertEqual(found["segment"].tolist(), [0, 1])
        self.assertEqual(found["face"].tolist(), [1, 1])
        self.assertEqual(found["lower"].tolist(), [0.5, 0.5])
        self.assertEqual(found["time"].tolist(), [1, 2.5])
        self.assertEqual(found["turns_over"].dtype, np.bool_)
        self.assertTrue(found["turns_over"].all())
        np.testing.assert_array_equal(found["before"], [[0, 0, 1], [0, 0, -1]])
        np.testing.assert_array_equal(found["after"], -found["before"])
        self.assertEqual(found["always_face"].size, 0)

    def test_a_span_is_in_the_times_of_the_keyframes(self):
        self.assertEqual(cn.collapse(KEYFRAMES, FACES, times=[0, 2, 3], start=2)["segment"].tolist(), [1])
        with self.assertRaisesRegex(ValueError, "--to: it must be later than --from"):
            cn.collapse(KEYFRAMES, FACES, start=1, end=1)

    def test_fronts_are_intervals(self):
        found = cn.facing(KEYFRAMES, FACES, direction=[0, 0, 1], silhouettes=True)
        self.assertEqual(found["face"].tolist(), [0, 1, 0, 1])
        np.testing.assert_allclose(found["from"], [0, 0, 0, 0.5], atol=1e-12)
        np.testing.assert_allclose(found["to"], [1, 0.5, 1, 1], atol=1e-12)
        self.assertEqual(found["silhouette_vertices"].tolist(), [[1, 2], [1, 2]])
        still = cn.facing(KEYFRAMES, FACES, eye=[0, 0, 5])
        np.testing.assert_allclose(still["to"], found["to"], atol=1e-12)
        moving = cn.facing(KEYFRAMES, FACES, eye=[0.2, 0.2, 1], eye_to=[0.2, 0.2, -1])
        np.testing.assert_allclose(moving["to"], [1, 0.5, 0.5], atol=1e-12)

    def test_random_faces_show_the_sides_that_samples_show(self):
        random = np.random.default_rng(7)
        positions = random.uniform(-1, 1, (2, 600, 3)).astype(np.float32)
        faces = np.arange(600).reshape(-1, 3)
        eye, eye_to = np.float32([3, 1, 2]), np.float32([-1, 2, 2])
        found = cn.facing(positions, faces, eye=eye, eye_to=eye_to)
        for t in random.uniform(0, 1, 20):
            corners = ((1 - t) * positions[0].astype(float) + t * positions[1])[faces]
            normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            sides = np.einsum("fk,fk->f", normals, (1 - t) * eye + t * eye_to - corners[:, 0])
            is_front = np.zeros(len(faces), bool)
            is_front[found["face"][(found["from"] <= t) & (t <= found["to"])]] = True
            clear = np.abs(sides) > 1e-9
            np.testing.assert_array_equal(is_front[clear], (sides > 0)[clear])

    def test_misuse_names_the_argument(self):
        for arguments, place in (({}, "direction"), ({"eye": [1, 2]}, "direction"), ({"eye_to": [1, 2, 3]}, "direction"),
                                 ({"direction": [0, 0, 1], "eye_to": [1, 2, 3]}, "eye_to"),
                                 ({"direction": [0, 0, 0]}, "--direction")):
            with self.assertRaisesRegex(ValueError, place):
                cn.facing(KEYFRAMES, FACES, **arguments)
        with self.assertRaisesRegex(ValueError, "positions: the shape"):
            cn.collapse(SQUARE, FACES)
        with self.assertRaisesRegex(ValueError, "times"):
            cn.collapse(KEYFRAMES, FACES, times=[0, 1])


if __name__ == "__main__":
    unittest.main()
