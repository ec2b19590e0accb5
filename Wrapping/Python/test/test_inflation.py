# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Inflation from Python: folds opened, areas kept, stopped on request."""

import unittest

import numpy as np

import explica


def areas(p, f):
    return np.linalg.norm(np.cross(p[f[:, 1]] - p[f[:, 0]], p[f[:, 2]] - p[f[:, 0]]), axis=1) / 2


class Inflation(unittest.TestCase):
    def setUp(self):
        self.positions, self.faces = explica.folded_sphere(3, 30.0, 0.4)

    def test_folds_are_opened_and_areas_kept(self):
        surface = (self.positions, self.faces)
        before = explica.sphere_view(surface)
        made = explica.inflate(surface, frames=3)
        after = explica.sphere_view((made["positions"], self.faces))
        self.assertEqual((made["termination"], made["flag"]), ("target-reached", ""))
        self.assertLess(before["visibility"], 0.95)
        self.assertGreaterEqual(after["visibility"], 0.98)
        self.assertAlmostEqual(after["visibility"], made["visibility"], delta=1e-9)
        ratio = areas(made["positions"], self.faces) / areas(self.positions, self.faces)
        self.assertAlmostEqual(np.mean(np.abs(ratio - 1)), made["area_error_mean"], delta=1e-12)
        self.assertLessEqual(made["area_error_mean"], 0.008)
        self.assertEqual(len(explica.self_intersections((made["positions"], self.faces))), 0)
        np.testing.assert_array_equal(made["frames"][0][1], self.positions)
        np.testing.assert_array_equal(made["frames"][-1][1], made["positions"])

    def test_directions_of_a_convex_surface_are_its_normals(self):
        positions, faces = explica.icosphere(2, 10.0)
        view = explica.sphere_view((positions, faces), viewpoints=2000)
        normals = explica.face_normals((positions, faces))
        normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        self.assertGreater(np.min(np.sum(view["direction"] * normals, axis=1)), 0.95)
        np.testing.assert_allclose(view["share"], 1, atol=0.01)

    def test_progress_stops_it_and_bad_options_are_refused(self):
        surface = (self.positions, self.faces)
        made = explica.inflate(surface, progress=lambda fraction, activity: False)
        self.assertEqual(made["termination"], "interrupted")
        for bad in ({"target_seen": 2.0}, {"frames": -1}, {"unknown": 1}):
            with self.assertRaises((ValueError, TypeError)):
                explica.inflate(surface, **bad)


if __name__ == "__main__":
    unittest.main()
