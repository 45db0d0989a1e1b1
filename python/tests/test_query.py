"""Tests queries about whole intervals of time against answers found by hand, and against samples in float64."""

import unittest

import numpy as np

import chronormal as cn

# A square of two triangles. Its last vertex crosses the diagonal and goes back.
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
        for span, words in (({"start": 1, "end": 1}, "^end: the last time must be later than the first"),
                            ({"start": 9}, "^start: the motion has nothing after 9"),
                            ({"end": -1}, "^end: the motion has nothing before -1")):
            for ask in (cn.collapse, cn.shutter):
                with self.subTest(span=span), self.assertRaisesRegex(ValueError, words):
                    ask(KEYFRAMES, FACES, **span)

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

    def test_random_vertices_and_hard_corners_show_the_sides_of_their_own_normals(self):
        random = np.random.default_rng(55)
        faces = np.array([[i, (i + 1) % 40, 40 + i % 9] for i in range(40)] + [[i, (i + 7) % 40, 40 + i % 5] for i in range(40)])
        positions = random.uniform(-1, 1, (2, 49, 3)).astype(np.float32)
        eye = np.float32([3, 1, 2])
        for elements, column, where in (("vertices", "vertex", np.arange(49)), ("corners", "corner", faces.ravel())):
            found = cn.facing(positions, faces, eye=eye, elements=elements, crease=0 if elements == "corners" else None)
            index = found[column]
            for t in random.uniform(0, 1, 20):
                points = (1 - t) * positions[0].astype(float) + t * positions[1]
                corners, sums = points[faces], np.zeros((49, 3))
                of_faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
                for k in range(3):
                    np.add.at(sums, faces[:, k], of_faces)
                normals = sums if elements == "vertices" else np.repeat(of_faces, 3, axis=0)
                sides = np.einsum("nk,nk->n", normals, eye - points[where])
                is_front = np.zeros(len(where), bool)
                is_front[index[(found["from"] <= t) & (t <= found["to"])]] = True
                clear = np.abs(sides) > 1e-9
                self.assertTrue(clear.any())
                np.testing.assert_array_equal(is_front[clear], (sides > 0)[clear])

    def test_means_of_vertices_are_those_of_many_samples(self):
        random = np.random.default_rng(56)
        positions = random.uniform(-1, 1, (2, 4, 3)).astype(np.float32)
        faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1]])
        found = cn.shutter(positions, faces, elements="vertices")
        times = (np.arange(20000) + 0.5) / 20000
        normals = cn.curves(positions[0], positions[1], faces).unit_normals(times).astype(float)
        np.testing.assert_allclose(found["mean_unit"][np.argsort(found["vertex"])], normals.mean(0)[np.sort(found["vertex"])],
                                   atol=1e-3)

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
        with self.assertRaisesRegex(ValueError, "edges"):
            cn.facing(KEYFRAMES, FACES, direction=[0, 0, 1], elements="edges")
        with self.assertRaisesRegex(ValueError, "crease"):
            cn.shutter(KEYFRAMES, FACES, crease=30, elements="vertices")


if __name__ == "__main__":
    unittest.main()
