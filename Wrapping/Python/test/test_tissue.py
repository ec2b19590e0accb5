# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Thickness and surfaces from Python: equal to the command line, byte for byte, and to the truth."""

import os
import pathlib
import subprocess
import tempfile
import unittest

import nibabel
import numpy as np

import explica

EXECUTABLE = os.environ["EXPLICA_EXECUTABLE"]


def shell(size=40, inner=9.0, outer=15.0, spacing=(1.0, 1.0, 1.0)):
    """Labels of a spherical shell, 1 inside, 2 tissue, and its affine: oblique and mirrored."""
    axes = [(np.arange(size) - (size - 1) / 2) * s for s in spacing]
    r = np.sqrt(sum(a**2 for a in np.meshgrid(*axes, indexing="ij")))
    labels = np.where(r < inner, 1, np.where(r < outer, 2, 0)).astype(np.int32)
    c, s = np.cos(0.4), np.sin(0.4)
    affine = np.eye(4)
    affine[:3, :3] = np.array([[-c, -s, 0], [-s, c, 0], [0, 0, 1]]) @ np.diag(spacing)
    affine[:3, 3] = [7, -8, 9]
    return labels, affine


class Tissue(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_command(self, *words):
        subprocess.run([EXECUTABLE, *map(str, words), "--quiet"], check=True)

    def test_shell_has_its_thickness(self):
        labels, affine = shell()
        result = explica.thickness(labels, affine, inner=[1], tissue=[2], recover_sulci=False)
        inside = labels == 2
        self.assertLess(abs(result["thickness"][inside].mean() - 6), 0.1)
        self.assertAlmostEqual(result["summary"]["thickness_mean"], 6, delta=0.1)
        # The two ends lie on the spheres about the centre of the grid.
        centre = affine @ np.append((np.array(labels.shape) - 1) / 2, 1)
        for name, radius in (("inner_point", 9), ("outer_point", 15)):
            r = np.linalg.norm(result[name][inside] - centre[:3], axis=1)
            self.assertLess(np.abs(r - radius).mean(), 0.15)

    def test_thickness_equals_the_command_line(self):
        labels, affine = shell(spacing=(1.0, 0.8, 1.25))
        path = self.folder / "labels.nii.gz"
        explica.write_volume(path, labels, affine)
        self.run_command("thickness", path, "--inner", 1, "--tissue", 2, "--layers", 4, "--out",
                         self.folder / "out")  # fmt: skip
        # Both start from the numbers that the file holds.
        image = nibabel.Nifti1Image(*explica.read_labels(str(path)))
        result = explica.thickness(image, inner=[1], tissue=[2], layers=4)
        for name in ("harmonic", "thickness", "inner_distance", "depth", "inner_point", "layers"):
            written = np.asarray(nibabel.load(self.folder / "out" / f"{name}.nii.gz").dataobj)
            ours = np.asarray(result[name].dataobj)
            # NIfTI keeps the components of a vector in the fifth dimension.
            if written.ndim == 5:
                written = written[:, :, :, 0, :]
            self.assertEqual(ours.shape, written.shape)
            np.testing.assert_array_equal(ours, written, err_msg=name)

    def test_surfaces_equal_the_command_line_and_correspond(self):
        labels, affine = shell()
        path = self.folder / "labels.nii.gz"
        explica.write_volume(path, labels, affine)
        self.run_command("surface", path, "--white-label", 1, "--grey-label", 2, "--faces", 3000, "--out",
                         self.folder / "out")  # fmt: skip
        read = explica.read_labels(str(path))
        result = explica.surfaces_of(*read, white_label=[1], grey_label=[2], faces=3000)
        for name in ("white", "mid", "pial"):
            positions, faces = explica.read_surface(str(self.folder / "out" / f"{name}.surf.gii"))
            np.testing.assert_array_equal(result[name].astype(np.float32), positions)
            np.testing.assert_array_equal(result["faces"], faces)
        way = np.linalg.norm(result["pial"] - result["white"], axis=1)
        self.assertLess(np.abs(way - 6).mean(), 0.2)
        self.assertLess(np.abs(result["thickness"] - 6).mean(), 0.2)
        self.assertEqual(
            explica.inspect_mesh((result["white"], result["faces"]))["euler_characteristic"], 2
        )

    def test_an_image_places_the_borders(self):
        labels, affine = shell()
        # Inner bright, tissue grey, outside dark, and the outer border a little farther in.
        image = np.choose(labels, [10.0, 110.0, 70.0])
        plain = explica.surfaces_of(labels, affine, white_label=[1], grey_label=[2], faces=2000)
        placed = explica.surfaces_of(labels, affine, image, white_label=[1], grey_label=[2], faces=2000)
        self.assertEqual(plain["faces"].shape, placed["faces"].shape)
        self.assertFalse(np.array_equal(plain["white"], placed["white"]))
        self.assertLess(np.abs(placed["thickness"] - 6).mean(), 0.3)

    def test_a_block_of_tissue_gives_sheets(self):
        labels = np.zeros((24, 20, 20), np.int32)
        labels[:8], labels[8:14] = 1, 2
        made = explica.surfaces_of(labels, white_label=[1], grey_label=[2], faces=800)
        condition = explica.inspect_mesh((made["mid"], made["faces"]))
        self.assertEqual(condition["euler_characteristic"], 1)
        self.assertGreater(condition["boundary_edges"], 0)
        np.testing.assert_allclose(made["thickness"], 6, atol=0.1)

    def test_mistakes_are_value_errors_in_words(self):
        labels, affine = shell()
        with self.assertRaisesRegex(ValueError, "7"):
            explica.thickness(labels, affine, inner=[7], tissue=[2])
        with self.assertRaisesRegex(ValueError, "whole number"):
            explica.thickness(labels + 0.5, affine, inner=[1], tissue=[2])
        with self.assertRaisesRegex(ValueError, "whole number of 32 bits"):
            explica.thickness(labels.astype(np.int64) + 2**32, affine, inner=[1], tissue=[2])

    def test_keyboard_interrupt_comes_out(self):
        import signal
        import threading

        labels, affine = shell(72, 16, 32)
        timer = threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            for _ in range(200):
                explica.thickness(labels, affine, inner=[1], tissue=[2])
        timer.join()


if __name__ == "__main__":
    unittest.main()
