# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Commands run from Python, their and their records."""

import contextlib
import hashlib
import io
import pathlib
import tempfile
import unittest

import numpy as np

import explica
from explica import phantoms, provenance


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
        record = provenance.read_record(self.folder / "thick" / "provenance.json")
        self.assertEqual(record, self.thickness["provenance"])
        self.assertEqual(record["command"], "thickness")

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

    def test_records_tell_and_prove(self):
        result = self.folder / "thick" / "thickness.nii.gz"
        record = self.folder / "thick" / "provenance.json"
        self.assertEqual(
            provenance.sha256(result), hashlib.sha256(result.read_bytes()).hexdigest()
        )
        self.assertIn("thickness", provenance.history(result))
        found = provenance.verify(record, deep=True)
        self.assertTrue(found["all_same"])
        self.assertEqual(found["records"], 2)
        self.assertIn("activity", provenance.prov_json(record))
        self.assertEqual(provenance.software()["version"], explica.__version__)
        bytes_ = result.read_bytes()
        try:
            result.write_bytes(bytes_[:-1] + bytes([bytes_[-1] ^ 1]))
            found = provenance.verify(record)
            changed = [f["path"] for f in found["files"] if f["state"] == "changed"]
            self.assertFalse(found["all_same"])
            self.assertEqual([pathlib.Path(c).name for c in changed], ["thickness.nii.gz"])
        finally:
            result.write_bytes(bytes_)
        with self.assertRaisesRegex(OSError, "nowhere"):
            provenance.verify("nowhere.json")


class Phantoms(unittest.TestCase):
    def test_annuli_know_their_answers(self):
        for kind in ("shell", "eccentric", "spheroid", "ventricle"):
            made = phantoms.annulus(kind, size=40, spacing=3)
            with self.subTest(kind=kind):
                tissue = made["labels"] == 2
                self.assertGreater(tissue.sum(), 50)
                total = made["inner_distance"] + made["outer_distance"]
                np.testing.assert_allclose(made["thickness"][tissue], total[tissue], rtol=1e-4)

    def test_ribbon_is_measured_right(self):
        made = phantoms.cortex(size=40)
        result = explica.thickness(made["labels"], made["affine"], inner=[3], tissue=[2])
        self.assertAlmostEqual(result["summary"]["thickness_median"], made["thickness"], delta=0.5)
        tissue = explica.segment(made["image"], made["affine"])
        agree = (tissue["labels"] == made["labels"])[made["labels"] > 1].mean()
        self.assertGreater(agree, 0.85)


class Surfaces(unittest.TestCase):
    def test_topology_is_mended(self):
        """A ring becomes a ball; kept, it stays a ring."""
        i, j, k = np.meshgrid(*[np.arange(24)] * 3, indexing="ij")
        ring = (np.hypot(np.hypot(i - 11.5, j - 11.5) - 6, k - 11.5) < 3).astype(np.uint8)
        fixed = explica.correct_topology(ring, np.eye(4))
        surface = explica.iso_surface(fixed["level"], np.eye(4))
        self.assertEqual(explica.inspect_mesh(surface)["euler_characteristic"], 2)
        self.assertEqual(len(fixed["defects"]), 1)
        self.assertEqual((fixed["mask"] != ring).sum(), fixed["voxels_changed"])
        kept = explica.correct_topology(ring, np.eye(4), genus="keep")
        self.assertEqual(kept["handles_left"], 1)

    def test_shares_make_the_surfaces_of_labels(self):
        made = phantoms.shell(size=40)
        inner, both = (made["labels"] == 1) * 1.0, (made["labels"] > 0) * 1.0
        from_shares = explica.surfaces_of_shares(inner, both, made["affine"], faces=2000)
        radius = np.linalg.norm(from_shares["pial"], axis=1)
        self.assertAlmostEqual(radius.mean(), made["outer_radius"], delta=0.6)

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
