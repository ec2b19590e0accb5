# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The surface functions against numpy's own arithmetic."""

import unittest

import numpy as np

import explica


class Geometry(unittest.TestCase):
    def setUp(self):
        self.surface = explica.folded_sphere(3)

    def test_areas_equal_numpy(self):
        p, f = self.surface
        cross = np.cross(p[f[:, 1]] - p[f[:, 0]], p[f[:, 2]] - p[f[:, 0]])
        expected = 0.5 * np.linalg.norm(cross, axis=1)
        np.testing.assert_allclose(explica.face_areas(self.surface), expected, rtol=1e-13)
        self.assertAlmostEqual(explica.vertex_areas(self.surface).sum(), expected.sum(), 12)

    def test_inspection_knows_a_sphere(self):
        condition = explica.inspect_mesh(self.surface)
        self.assertTrue(condition["closed_manifold"])
        self.assertEqual(condition["euler_characteristic"], 2)

    def test_intersections_appear_when_a_vertex_is_pushed_through(self):
        p, f = self.surface
        self.assertEqual(explica.self_intersections((p, f)).shape, (0, 2))
        pushed = p.copy()
        pushed[0] *= -1.5
        self.assertGreater(len(explica.self_intersections((pushed, f))), 0)

    def test_float32_and_fortran_order_are_taken(self):
        p, f = self.surface
        areas = explica.face_areas((np.asfortranarray(p.astype(np.float32)), f.astype(np.int64)))
        np.testing.assert_allclose(areas, explica.face_areas((p, f)), rtol=1e-5)

    def test_faces_out_of_range_are_a_value_error(self):
        p, f = self.surface
        with self.assertRaisesRegex(ValueError, "faces: name vertices"):
            explica.face_areas((p[:10], f))
        self.assertTrue(issubclass(explica.InvalidInput, ValueError))

    def test_geodesic_is_not_shorter_than_the_straight_line(self):
        p, f = self.surface
        d = explica.geodesic_distances((p, f), [0])
        self.assertEqual(d[0], 0)
        self.assertTrue(np.all(d >= np.linalg.norm(p - p[0], axis=1) * (1 - 1e-9)))

    def test_unknown_keyword_lists_the_known_ones(self):
        with self.assertRaisesRegex(TypeError, "known: .*xform"):
            explica.read_labels("nowhere.nii", colour=3)


if __name__ == "__main__":
    unittest.main()
