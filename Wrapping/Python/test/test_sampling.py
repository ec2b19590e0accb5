# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Values of images on surfaces."""

import unittest

import nibabel
import numpy as np

import explica


def coordinates(shape=(32, 30, 34)):
    """An oblique, mirrored image whose four frames are x, y, z and x + y, RAS mm."""
    c, s = np.cos(0.3), np.sin(0.3)
    affine = np.eye(4)
    affine[:3, :3] = np.array([[-c, s, 0], [s, c, 0], [0, 0, 1]]) @ np.diag([1.2, 1.3, 1.1])
    affine[:3, 3] = -affine[:3, :3] @ (np.array(shape) - 1) / 2
    index = np.indices(shape).reshape(3, -1)
    world = (affine[:3, :3] @ index + affine[:3, 3:]).reshape(3, *shape)
    return np.stack([*world, world[0] + world[1]], axis=-1).astype("f4"), affine


class Sampling(unittest.TestCase):
    def setUp(self):
        self.white = explica.icosphere(3, 9.0)
        self.pial = explica.icosphere(3, 13.0)

    def test_coordinates_come_back_from_arrays_and_images(self):
        values, affine = coordinates()
        for image, given in ((values, affine), (nibabel.Nifti1Image(values, affine), None)):
            got = explica.sample(image, self.white, self.pial, [0, 0.5, 1], given)
            self.assertEqual(got.shape, (3, 642, 4))
            at = 11 / 9 * self.white[0]
            np.testing.assert_allclose(got[1, :, :3], at, atol=1e-4)
            np.testing.assert_allclose(got[1, :, 3], at[:, 0] + at[:, 1], atol=1e-4)
        one = explica.sample(values[..., 0], self.white, self.pial, 0.5, affine, interpolate="cubic")
        np.testing.assert_allclose(one[0], got[1, :, 0], atol=1e-4)

    def test_unknown_is_nan(self):
        values, affine = coordinates()
        values[..., 0][values[..., 0] < 0] = np.nan
        got = explica.sample(values[..., 0], self.white, self.pial, affine=affine)[0]
        x = 11 / 9 * self.white[0][:, 0]
        self.assertTrue(np.isnan(got[x < -1]).all())
        self.assertFalse(np.isnan(got[x > 1]).any())
        mask = values[..., 1] > 0
        got = explica.sample(values[..., 2], self.white, self.pial, affine=affine, mask=mask)[0]
        self.assertTrue(np.isnan(got[self.white[0][:, 1] < -1]).all())

    def test_a_matrix_moves_the_places(self):
        values, affine = coordinates()
        shift = np.eye(4)
        shift[2, 3] = 1.5
        got = explica.sample(values[..., 2], self.white, self.pial, affine=affine, to_volume=shift)
        np.testing.assert_allclose(got[0], 11 / 9 * self.white[0][:, 2] + 1.5, atol=1e-4)

    def test_points_and_depths(self):
        found = explica.nearest_columns(self.white, self.pial, [[0, 0, 10], [0, 0, 20]])
        np.testing.assert_allclose(found["distance"], [0, 7], atol=0.2)
        np.testing.assert_allclose(found["depth"], [0.25, 1], atol=0.02)
        middle = explica.positions_at_depth(self.white, self.pial, 0.5, "volume")
        self.assertGreater(np.linalg.norm(middle, axis=1).min(), 11.0)

    def test_surfaces_must_correspond(self):
        values, affine = coordinates()
        with self.assertRaises(explica.InvalidInput):
            explica.sample(values[..., 0], self.white, explica.icosphere(2, 13.0), affine=affine)
        with self.assertRaises(explica.InvalidInput):
            explica.sample(values[..., 0], self.white, self.pial, affine=affine, interpolate="best")

    def test_crossings_are_parted(self):
        a, b = explica.icosphere(3, 10.0), explica.icosphere(3, 10.0)
        positions = np.vstack([a[0], b[0] + [19.8, 0.3, 0.2]])
        faces = np.vstack([a[1], b[1] + len(a[0])])
        result = explica.repair_surface((positions, faces), max_move=3)
        self.assertGreater(len(result["pairs_before"]), 0)
        self.assertEqual(len(result["pairs_after"]), 0)
        self.assertEqual(len(explica.self_intersections((result["positions"], faces))), 0)


if __name__ == "__main__":
    unittest.main()
