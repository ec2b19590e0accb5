# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Flat maps from Python: one-to-one, areas kept, distances measured, grids that agree."""

import unittest

import numpy as np

import explica


def areas(p, f):
    return np.linalg.norm(np.cross(p[f[:, 1]] - p[f[:, 0]], p[f[:, 2]] - p[f[:, 0]]), axis=1) / 2


class Flattening(unittest.TestCase):
    def setUp(self):
        self.positions, self.faces = explica.folded_sphere(4, 30.0)
        top = np.all(self.positions[self.faces][:, :, 2] > 8, axis=1)
        self.region = np.flatnonzero(top)
        self.map = explica.flatten((self.positions, self.faces), region=self.region)
        self.part = self.positions[self.map["vertices"]]
        self.flat = np.column_stack([self.map["positions"], np.zeros(len(self.part))])

    def test_no_face_is_turned_over_and_areas_are_kept(self):
        p, f = self.map["positions"], self.map["faces"]
        u, v = p[f[:, 1]] - p[f[:, 0]], p[f[:, 2]] - p[f[:, 0]]
        signed = (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
        self.assertTrue(np.all(signed > 0))
        self.assertLess(np.mean(np.abs(signed / areas(self.part, f) - 1)), 0.0101)
        self.assertEqual((self.map["turned_over"], self.map["rim_crossings"]), (0, 0))
        np.testing.assert_array_equal(self.map["vertices"][f], self.faces[self.map["region"]])

    def test_frames_lead_to_the_map_and_a_stopped_run_is_one_to_one(self):
        made = explica.flatten((self.positions, self.faces), region=self.region, frames=4)
        self.assertEqual(len(made["frames"]), 4)
        np.testing.assert_array_equal(made["frames"][-1], self.map["positions"])
        stopped = explica.flatten(
            (self.positions, self.faces), region=self.region, progress=lambda fraction, activity: False
        )
        self.assertEqual(stopped["termination"], "interrupted")
        self.assertEqual((stopped["turned_over"], stopped["rim_crossings"]), (0, 0))

    def test_relief_cuts_open_a_ball_so_that_it_lies_flat_with_less_strain(self):
        kept = np.flatnonzero(np.all(self.positions[self.faces][:, :, 2] > -25, axis=1))
        found = explica.relief_cuts((self.positions, self.faces), region=kept, strain=0.15)
        self.assertLessEqual(found["strain"], 0.15)
        self.assertGreater(found["strain_before"], 0.15)
        self.assertEqual(len(found["cuts"]), len(found["lengths"]))
        np.testing.assert_array_equal(found["vertices"][found["faces"]], self.faces[found["region"]])
        self.assertTrue(np.all(np.isin(found["region"], kept)))
        along = self.positions[found["cuts"][0]]
        length = np.linalg.norm(np.diff(along, axis=0), axis=1).sum()
        self.assertAlmostEqual(length, found["lengths"][0], places=9)
        opened = (self.positions[found["vertices"]], found["faces"])
        laid = explica.flatten(opened, area_tolerance=0.05)
        self.assertEqual((laid["turned_over"], laid["rim_crossings"]), (0, 0))

    def test_distance_errors_are_small_and_zero_for_itself(self):
        f = self.map["faces"]
        local, far = explica.distance_errors((self.part, f), self.part, pairs=400, sources=10)
        self.assertLess(max(local, far), 1e-9)
        local, far = explica.distance_errors((self.part, f), self.flat, pairs=400, sources=10)
        self.assertTrue(0 < local < 0.2 and 0 < far < 0.2)

    def test_grid_places_lie_between_the_surfaces(self):
        grid, affine = explica.flat_grid(
            (self.flat, self.map["faces"]), self.part, 1.1 * self.part, cell=1.0, depths=3
        )
        self.assertEqual(grid.shape[2:], (3, 3))
        self.assertEqual(affine[0, 0], 1)
        known = np.isfinite(grid[:, :, 0, 0])
        ratio = np.linalg.norm(grid[known][:, 2], axis=1) / np.linalg.norm(grid[known][:, 0], axis=1)
        np.testing.assert_allclose(ratio, 1.1, rtol=1e-5)


if __name__ == "__main__":
    unittest.main()
