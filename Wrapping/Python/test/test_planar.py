# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The plane from Python: against finite differences, formulas and the command line."""

import pathlib
import tempfile
import unittest

import numpy as np

import explica
from explica import planar


class Planar(unittest.TestCase):
    def setUp(self):
        self.phantom = planar.polygon19()
        self.polygon, self.region = self.phantom["polygon"], self.phantom["region"]
        self.viewpoint = self.phantom["viewpoint"]

    def slope(self, value, gradient):
        direction = np.random.default_rng(3).normal(size=self.polygon.shape)
        h = 1e-6
        plus, minus = (value(self.polygon + s * h * direction) for s in (1, -1))
        along = np.sum(gradient * direction)
        self.assertAlmostEqual((plus - minus) / (2 * h), along, delta=1e-6 * abs(along))

    def test_gradients_are_the_derivatives(self):
        result = planar.visibility(self.polygon, self.viewpoint, self.region)
        self.slope(
            lambda p: planar.visibility(p, self.viewpoint, self.region)["value"], result["gradient"]
        )
        _, gradient = planar.knot_energy(self.polygon)
        self.slope(lambda p: planar.knot_energy(p)[0], gradient)

    def test_circle_has_its_measures(self):
        circle = planar.circle(400, 10.0, [3.0, 4.0])
        self.assertAlmostEqual(planar.signed_area(circle), 100 * np.pi, delta=0.02)
        self.assertAlmostEqual(planar.edge_lengths(circle).sum(), 20 * np.pi, delta=0.001)
        self.assertAlmostEqual(planar.self_occlusion(circle), 0)
        self.assertEqual(planar.self_intersections(circle).shape, (0, 2))
        self.assertEqual(len(planar.self_intersections([[0, 0], [1, 1], [1, 0], [0, 1]])), 1)
        seen = planar.visible_part(circle, [1e6, 0.0])
        self.assertAlmostEqual(seen["fraction"], 0.5, delta=0.01)
        self.assertAlmostEqual(planar.largest_safe_step(circle, 1.5 * circle), 1)
        self.assertLess(planar.largest_safe_step(circle, 7 - circle + [-1, 1]), 1)

    def test_unfolding_equals_the_command_line(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "polygon.csv"
            planar.write_polygon(file, self.polygon)
            np.testing.assert_array_equal(planar.read_polygon(file), self.polygon)
            explica.command(
                "polygon", file, out=pathlib.Path(folder) / "out", quiet=True,
                region="{}:{}".format(*self.region), viewpoint=self.viewpoint, max_iterations=15,
            )  # fmt: skip
            written = planar.read_polygon(pathlib.Path(folder) / "out" / "unfolded.csv")
        made = planar.unfold(self.polygon, self.region, self.viewpoint, max_iterations=15)
        np.testing.assert_array_equal(made["polygon"], written)
        self.assertEqual(made["termination"], "max-iterations")
        self.assertEqual(len(made["path"]), len(made["history"]))
        first, last = made["history"][0], made["history"][-1]
        self.assertGreater(last["visibility"], first["visibility"])
        self.assertLess(last["length_error"], 1e-6)
        self.assertEqual(len(made["self_intersections_final"]), 0)

    def test_several_viewpoints_with_weights(self):
        views = np.array([self.viewpoint, np.asarray(self.viewpoint) + [400.0, 0.0]])
        single = [planar.visibility(self.polygon, v, self.region) for v in views]
        mean = planar.visibility(self.polygon, views, self.region, view_weights=[3, 1])
        for key in ("value", "gradient", "edge_flux"):
            expected = 0.75 * np.asarray(single[0][key]) + 0.25 * np.asarray(single[1][key])
            np.testing.assert_allclose(mean[key], expected, atol=1e-12)
        seen = [planar.visible_part(self.polygon, v, self.region)["fraction"] for v in views]
        both = planar.visible_part(self.polygon, views, self.region)
        self.assertAlmostEqual(both["fraction"], 0.5 * sum(seen))
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "polygon.csv"
            planar.write_polygon(file, self.polygon)
            words = ["{!r},{!r}".format(*map(float, view)) for view in views]
            explica.command(
                "polygon", file, out=pathlib.Path(folder) / "out", quiet=True, max_iterations=8,
                region="{}:{}".format(*self.region), viewpoint=words, view_weights="3,1",
            )  # fmt: skip
            written = planar.read_polygon(pathlib.Path(folder) / "out" / "unfolded.csv")
        made = planar.unfold(
            self.polygon, self.region, views, view_weights=[3, 1], max_iterations=8
        )
        np.testing.assert_array_equal(made["polygon"], written)
        with self.assertRaisesRegex(ValueError, "viewpoint"):
            planar.visibility(self.polygon, [[0.0, 0.0, 1.0]], self.region)
        with self.assertRaisesRegex(ValueError, "weights"):
            planar.visibility(self.polygon, views, self.region, view_weights=[1])

    def test_progress_may_stop_the_work(self):
        made = planar.unfold(
            self.polygon, self.region, self.viewpoint, progress=lambda fraction, activity: False
        )
        self.assertEqual(made["termination"], "interrupted")

    def test_contours_of_a_label(self):
        i, j = np.meshgrid(np.arange(40), np.arange(40), indexing="ij")
        r = np.hypot(i - 20, j - 20)
        labels = np.where((r > 6) & (r < 12), 5, 0)[:, :, None]
        affine = np.diag([2.0, 2.0, 5.0, 1.0])
        curves, plane = planar.contours_of_label(labels, 5, affine)
        self.assertEqual(len(curves), 2)
        disc, hole = 4 * np.sum(r < 12), 4 * np.sum(r <= 6)
        self.assertAlmostEqual(planar.signed_area(curves[0]) / disc, 1, delta=0.02)
        self.assertAlmostEqual(planar.signed_area(curves[1]) / -hole, 1, delta=0.03)
        world = plane["origin"] + curves[0] @ np.vstack([plane["x"], plane["y"]])
        np.testing.assert_allclose(world.mean(axis=0)[:2], [40, 40], atol=0.5)
        self.assertEqual(len(planar.resample(curves[0], 64)), 64)
        rings, _ = planar.contours_of_level(r[:, :, None], 10.0, affine)
        self.assertEqual(len(rings), 1 + 1)  # the level's circle, and the grid's rim
        with self.assertRaisesRegex(ValueError, "label"):
            planar.contours_of_label(labels, 7, affine)

    def test_mistakes_are_value_errors_in_words(self):
        with self.assertRaisesRegex(ValueError, "three vertices|vertices"):
            planar.visibility([[0, 0], [1, 0]], [5, 5])
        with self.assertRaisesRegex(ValueError, "'off' has no energy"):
            planar.knot_energy(self.polygon, method="off")
        with self.assertRaisesRegex(TypeError, "known: .*knot_weight"):
            planar.unfold(self.polygon, self.region, self.viewpoint, weight=3)


if __name__ == "__main__":
    unittest.main()
