# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The examples run as a reader would run them, and what they print is right."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import matplotlib.image
import nibabel
import numpy as np

EXAMPLES = pathlib.Path(__file__).resolve().parents[1] / "examples"
REAL = pathlib.Path(os.environ.get("EXPLICA_REAL_DATA", "absent"))


class Examples(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = pathlib.Path(folder.name) / "out"

    def run_example(self, name, *words):
        words = [sys.executable, EXAMPLES / name, *words, "--out", self.out]
        return subprocess.check_output([str(word) for word in words], text=True)

    def assert_picture(self, name):
        """A picture that is not blank."""
        pixels = matplotlib.image.imread(self.out / name)[..., :3]
        self.assertGreater(pixels.shape[1], 300)
        self.assertGreater(pixels.std(), 0.05)

    def test_patch_unfolds_and_turns(self):
        said = self.run_example("unfold_patch.py", "--levels", 3, "--steps", 25)
        start, first, second = map(float, re.findall(r"visibility (\S+) -> (\S+) -> (\S+)", said)[0])
        self.assertLess(start, 0.9)
        self.assertGreater(min(first, second), 0.98)
        self.assertIn("0 pairs of faces intersect", said)
        self.assert_picture("evolution.png")
        self.assert_picture("patch.png")
        nibabel.load(self.out / "unfolded.surf.gii")

    def test_layer_profile_of_the_phantom_is_exact(self):
        said = self.run_example("layer_profile.py")
        self.assertLess(float(re.findall(r"profile: (\S+)", said)[0]), 0.01)
        self.assertIn("100.0 % of the values known", said)
        self.assert_picture("profile.png")
        self.assertEqual(np.loadtxt(self.out / "profile.tsv", skiprows=1).shape, (21, 4))

    def test_subject_without_data_says_so(self):
        self.assertEqual(
            self.run_example("thickness_of_subject.py", self.out), "skipped: no real data\n"
        )

    @unittest.skipUnless(REAL.is_dir(), "skipped: no real data")
    def test_real_subject_lies_near_freesurfer(self):
        """Along the trajectories through every voxel, not the vertices' distances: a little more."""
        said = self.run_example("thickness_of_subject.py", REAL / "bert_freesurfer")
        mean = float(re.findall(r"^mean (\S+) mm", said, re.M)[0])
        reference = float(re.findall(r"FreeSurfer: mean (\S+) mm", said)[0])
        self.assertAlmostEqual(mean, reference, delta=0.8)
        self.assert_picture("thickness.png")
        self.assertEqual(nibabel.load(self.out / "thickness.nii.gz").shape, (256, 256, 256))


if __name__ == "__main__":
    unittest.main()
