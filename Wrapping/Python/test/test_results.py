# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Commands run from Python, their records, and pictures and reports of what they wrote."""

import contextlib
import hashlib
import io
import json
import pathlib
import tempfile
import unittest

import numpy as np

import explica
from explica import phantoms, provenance, report, study


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

    def test_report_is_one_page(self):
        page = report.page(self.folder / "thick")
        self.assertTrue(page.lstrip().startswith("<!DOCTYPE html>"))
        self.assertIn("thickness", page)
        with tempfile.TemporaryDirectory() as empty, self.assertRaises(ValueError):
            report.page(empty)

    def test_plan_is_that_of_the_run(self):
        steps = study.plan(self.labels, self.folder / "run", kind="labels")
        self.assertEqual([s["command"] for s in steps], ["thickness", "surface", "unfold"])
        self.assertEqual(steps[2]["needs"], ["surface"])
        self.assertIn("SURFACE", steps[2]["values"])

    def test_participants_of_a_bids_dataset(self):
        dataset = self.folder / "bids"
        anat = dataset / "sub-01" / "anat"
        anat.mkdir(parents=True)
        (dataset / "dataset_description.json").write_text(
            json.dumps({"Name": "test", "BIDSVersion": "1.8.0"})
        )
        labels = anat / "sub-01_desc-aseg_dseg.nii.gz"
        labels.write_bytes(self.labels.read_bytes())
        (found,) = study.find_participants(dataset)
        self.assertEqual(found["name"], "sub-01")
        self.assertEqual(pathlib.Path(found["input"]).resolve(), anat.resolve())
        self.assertEqual(found["problem"], "")
        with self.assertRaisesRegex(ValueError, "07"):
            study.find_participants(dataset, ["07"])
        with self.assertRaisesRegex(ValueError, "no runs"):
            study.table(dataset)

    def test_a_study_of_hearts_is_a_list_of_rows(self):
        beat = self.folder / "beat"
        options = dict(size=64, spacing=2, slice=8, frames=2, quiet=True)
        explica.command("phantom ventricle", out=beat, **options)
        person = self.folder / "people" / "sub-1"
        person.mkdir(parents=True)
        for frame, phase in ((0, "ED"), (1, "ES")):
            name = f"sub-1_frame-{phase}_dseg.nii.gz"
            (person / name).write_bytes((beat / f"frame-000{frame}.nii.gz").read_bytes())
        (person.parent / "participants.tsv").write_text("participant_id\tsex\nsub-1\tF\n")
        (row,) = study.hearts(person.parent, self.folder / "hearts")
        self.assertEqual(row["state"], "not begun")
        explica.command("study hearts", person.parent, self.folder / "hearts", quiet=True)
        (row,) = study.hearts(person.parent, self.folder / "hearts")
        self.assertEqual((row["name"], row["state"], row["about"]), ("sub-1", "done", {"sex": "F"}))
        self.assertAlmostEqual(float(row["values"]["ejection_fraction_percent"]), 50, delta=2)
        self.assertIn("segment_16_thickening", row["values"])


class Pictures(unittest.TestCase):
    def test_picture_shows_the_surface_in_its_colours(self):
        ball = explica.icosphere(3, 10.0)
        grey = report.picture(ball, width=120, height=90)
        self.assertEqual((grey.shape, grey.dtype), ((90, 120, 3), np.uint8))
        self.assertTrue(np.all(grey[0, 0] == 255))  # background
        self.assertTrue(np.all(grey[45, 60] < 255))
        height = ball[0][:, 2]
        seen = report.picture(
            ball, height, towards=[1, 0, 0], width=120, height=90, range=(-10, 10), colours="grey"
        )
        column = seen[:, 60].astype(int).sum(axis=1)
        self.assertGreater(column[20], column[70])  # up is up: large values are light
        self.assertEqual(report.picture(ball, views=["left", "top"], width=80, height=60).shape[1], 160)
        with self.assertRaisesRegex(ValueError, "values: one a vertex"):
            report.picture(ball, height[:5])
        with self.assertRaisesRegex(ValueError, "left"):
            report.picture(ball, views=["below"])

    def test_slices_show_image_and_cut_lines(self):
        made = phantoms.shell(size=24)
        plain = report.slices(made["level"], made["affine"], count=2, height=80)
        self.assertEqual(plain.shape[2], 3)
        lined = report.slices(
            made["level"], made["affine"], [explica.icosphere(3, made["inner_radius"])], 2, 80
        )
        self.assertEqual(lined.shape, plain.shape)
        self.assertGreater(np.any(lined != plain, axis=2).sum(), 50)

    def test_files_hold_the_pixels(self):
        pixels = np.random.default_rng(0).integers(0, 256, (20, 30, 3), dtype=np.uint8)
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "a.png"
            report.write_png(file, pixels)
            from matplotlib import image

            np.testing.assert_array_equal(np.rint(image.imread(file) * 255), pixels)
        self.assertEqual(report.encode_gif([pixels, 255 - pixels])[:6], b"GIF89a")


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

    def test_laplacian_of_a_linear_function_is_its_energy(self):
        p, f = explica.rectangle(6, 4, 3.0, 2.0)
        values, rows, columns = explica.cotangent_laplacian((p, f))
        x = 2 * p[:, 0] - p[:, 1]
        self.assertAlmostEqual(np.sum(x[rows] * values * x[columns]), 5 * 6)

    def test_parts_and_edges(self):
        p, f = explica.torus(12, 8, 5.0, 2.0)
        edges, at = explica.mesh_edges((p, f))
        self.assertEqual(len(p) - len(edges) + len(f), 0)
        self.assertTrue(np.all(at >= 0))
        q, g, origin = explica.extract_faces((p, f), [0, 1])
        np.testing.assert_array_equal(p[origin], q)
        np.testing.assert_array_equal(origin[g], f[:2])
        self.assertEqual(len(explica.subdivide((p, f))[1]), 4 * len(f))
        both = (np.vstack([p, p + 100]), np.vstack([f, f + len(p)]))
        self.assertEqual(set(explica.face_components(both)), {0, 1})
        normals = explica.face_normals((p, f))
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1) / 2, explica.face_areas((p, f)))
        self.assertTrue(np.all(explica.smallest_angles((p, f)) < np.pi / 3 + 1e-9))


if __name__ == "__main__":
    unittest.main()
