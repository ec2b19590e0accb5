# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Files read and written here against nibabel."""

import os
import pathlib
import tempfile
import unittest

import nibabel
import numpy as np

import explica

REAL = pathlib.Path(os.environ.get("EXPLICA_REAL_DATA", "absent"))

# Oblique, mirrored, anisotropic.
ANGLE = 0.3
ROTATION = np.array(
    [[np.cos(ANGLE), -np.sin(ANGLE), 0], [np.sin(ANGLE), np.cos(ANGLE), 0], [0, 0, 1]]
)
AFFINE = np.eye(4)
AFFINE[:3, :3] = ROTATION @ np.diag([-0.8, 1.0, 3.0])
AFFINE[:3, 3] = [10, -20, 30]


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_volumes_equal_nibabel(self):
        labels = np.random.default_rng(1).integers(0, 1000, (5, 6, 7), dtype=np.int32)
        for name in ("a.nii.gz", "a.mgz", "a.nii"):
            path = self.folder / name
            explica.write_volume(path, labels, AFFINE)
            image = nibabel.load(path)
            np.testing.assert_array_equal(np.asarray(image.dataobj), labels)
            np.testing.assert_allclose(image.affine, AFFINE, atol=1e-5)
            back, affine = explica.read_labels(str(path))
            np.testing.assert_array_equal(back, labels)
            np.testing.assert_allclose(affine, AFFINE, atol=1e-5)
            self.assertTrue(back.flags.f_contiguous)

    def test_nibabel_images_are_taken(self):
        values = np.random.default_rng(2).normal(size=(4, 5, 6)).astype(np.float32)
        explica.write_volume(self.folder / "b.nii", nibabel.Nifti1Image(values, AFFINE))
        back, _ = explica.read_scalars(str(self.folder / "b.nii"))
        np.testing.assert_array_equal(back, values)

    def test_surfaces_equal_nibabel(self):
        p, f = explica.icosphere(2, 50.0)
        path = self.folder / "c.surf.gii"
        explica.write_surface(path, (p, f), structure="CortexLeft")
        image = nibabel.load(path)
        positions, faces = image.agg_data(("pointset", "triangle"))
        np.testing.assert_array_equal(positions, p.astype(np.float32))
        np.testing.assert_array_equal(faces, f)
        # The image itself is a surface too.
        np.testing.assert_allclose(
            explica.vertex_areas(image), explica.vertex_areas((p, f)), rtol=1e-4
        )

    def test_missing_file_is_an_os_error_that_names_it(self):
        with self.assertRaisesRegex(OSError, "nowhere.nii"):
            explica.read_labels("nowhere.nii")

    @unittest.skipUnless(REAL.is_dir(), "skipped: no real data")
    def test_real_ribbon_equals_nibabel(self):
        path = REAL / "bert_freesurfer" / "mri" / "ribbon.mgz"
        labels, affine = explica.read_labels(str(path))
        image = nibabel.load(path)
        np.testing.assert_array_equal(labels, np.asarray(image.dataobj))
        np.testing.assert_allclose(affine, image.affine, atol=1e-4)


if __name__ == "__main__":
    unittest.main()
