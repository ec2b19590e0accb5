# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Commands run from Python, and their records."""

import contextlib
import io
import pathlib
import tempfile
import unittest

import numpy as np

import explica


class Commands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.phantom = explica.command("phantom shell", size=24, out=cls.folder / "shell", quiet=True)
        cls.labels = cls.folder / "shell" / "labels.nii.gz"
        cls.thickness = explica.command(
            "thickness", cls.labels, inner=[1], tissue=[2], out=cls.folder / "thick", quiet=True
        )

    def test_command_gives_its_summary_and_record(self):
        self.assertEqual(self.thickness["exit_code"], 0)
        self.assertAlmostEqual(
            self.thickness["summary"]["thickness_mean"], self.phantom["summary"]["thickness"], delta=0.2
        )
        self.assertEqual(self.thickness["provenance"]["command"], "thickness")
        self.assertEqual(explica.provenance.software()["version"], explica.__version__)

    def test_failures_are_exceptions_by_cause(self):
        with self.assertRaisesRegex(explica.InvalidInput, "nowhere.nii"):
            explica.command("thickness", "nowhere.nii", out=self.folder / "a", quiet=True)
        with self.assertRaisesRegex(explica.UsageError, "no-such-option"):
            explica.command("thickness", self.labels, no_such_option=3, quiet=True)
        with self.assertRaises(explica.InvalidInput):
            explica.command("thickness", self.labels, inner=[9], tissue=[2], out=self.folder / "b", quiet=True)
        self.assertFalse((self.folder / "b").exists())

    def test_messages_go_to_standard_error(self):
        said = io.StringIO()
        with contextlib.redirect_stderr(said):
            explica.command("report", self.folder / "thick")
        self.assertIn("report.html", said.getvalue())


class Surfaces(unittest.TestCase):
    def test_sphere_is_curved_by_its_radius(self):
        curvature = explica.mean_curvature(explica.icosphere(4, 20.0))
        self.assertAlmostEqual(curvature.mean(), -1 / 20, delta=1e-3)
        self.assertLess(np.abs(explica.sulcal_depth(explica.icosphere(4, 20.0))).max(), 0.02)

    def test_normals_are_twice_their_faces_areas(self):
        ball = explica.icosphere(2, 5.0)
        normals = explica.face_normals(ball)
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1) / 2, explica.face_areas(ball))


if __name__ == "__main__":
    unittest.main()
