"""Tests which points are inside a mesh that deforms, and when they cross its surface."""

import unittest

import numpy as np

import chronormal as cn

# A cube of quads (KEYFRAMES[0]), and the cube with edges of twice the length (KEYFRAMES[1]).
CUBE = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], np.float32)
QUADS = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
KEYFRAMES = np.array([CUBE, 2 * CUBE])


class ContainTest(unittest.TestCase):
    def test_points_that_rest_are_passed_by_the_surface(self):
        found = cn.contain(KEYFRAMES, QUADS, [[0, 0, 0], [1.5, 0.25, 0], [9, 9, 9]], times=[2, 4])
        self.assertEqual(found["inside"].dtype, np.bool_)
        self.assertEqual(found["inside"].tolist(), [True, False, False])
        self.assertEqual(found["crossing_point"].tolist(), [1])
        self.assertEqual(found["crossing_face"].tolist(), [5])
        self.assertEqual(found["crossing_inward"].tolist(), [True])
        self.assertAlmostEqual(found["crossing_time"][0], 3, places=12)
        np.testing.assert_allclose(found["crossing_normal"], [[1, 0, 0]], atol=1e-15)

    def test_points_that_move_do_so_over_all_times(self):
        path = np.array([[[-4, 0.25, 0.125], [4, 0.25, 0.125]]])
        found = cn.contain(np.array([CUBE, CUBE, CUBE]), QUADS, path)
        np.testing.assert_allclose(found["crossing_time"], [0.75, 1.25], atol=1e-12)
        self.assertEqual(found["crossing_inward"].tolist(), [True, False])
        later = cn.contain(np.array([CUBE, CUBE, CUBE]), QUADS, path, start=1)
        self.assertEqual((later["inside"].tolist(), later["crossing_inward"].tolist()), ([True], [False]))

    def test_what_does_not_fit_is_a_value_error(self):
        for message, arguments in [("4 edges have a face on one side only", (KEYFRAMES, QUADS[1:], CUBE)),
                                   (r"points: the shape must be .*but is \(3,\)", (KEYFRAMES, QUADS, [1, 2, 3])),
                                   (r"points\[1\]: a coordinate", (KEYFRAMES, QUADS, [[1, 2, 3], [1, np.nan, 3]])),
                                   (r"positions: the shape must be .*but is \(8, 3\)", (CUBE, QUADS, CUBE))]:
            with self.subTest(message), self.assertRaisesRegex(ValueError, message):
                cn.contain(*arguments)


if __name__ == "__main__":
    unittest.main()
