# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Harmonic shapes from Python: circles and spheres known exactly, and the command line's bytes."""

import json
import pathlib
import tempfile
import unittest

import numpy as np

import explica
from explica import planar, shapes


class Shapes(unittest.TestCase):
    def test_concentric_shapes_have_their_radius(self):
        """u = ln(r/a) / ln(b/a) is 1/2 at the geometric mean; in space, at the harmonic one."""
        ring = shapes.concentric(2, [1, 2, 0], 4.0, 9.0, 3)
        np.testing.assert_allclose(np.linalg.norm(ring.polygon() - [1, 2], axis=1), 6, rtol=1e-6)
        self.assertAlmostEqual(ring.values([[7.0, 2.0]])[0], 0.5)
        self.assertAlmostEqual(ring.margin, 0.5)
        ball = shapes.concentric(3, [0, 0, 0], 4.0, 12.0, 2)
        positions, faces = ball.surface(40)
        np.testing.assert_allclose(np.linalg.norm(positions, axis=1), 6, rtol=1e-5)
        self.assertTrue(explica.inspect_mesh((positions, faces))["closed_manifold"])
        u, affine = ball.field(32)
        self.assertEqual(u.shape, (32, 32, 32))
        self.assertEqual(affine.shape, (4, 4))

    def test_fit_equals_the_command_line(self):
        ellipse = planar.ellipse(200, 30.0, 20.0)
        options = dict(max_iterations=8, samples=400)
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "ellipse.csv"
            planar.write_polygon(file, ellipse)
            explica.command(
                "embed", file, out=pathlib.Path(folder) / "fit", order=16, quiet=True, **options
            )
            written = json.loads((pathlib.Path(folder) / "fit" / "coefficients.json").read_text())
            targets = [planar.read_polygon(file)]
        fit = shapes.fit(targets[0], shapes.around(targets, order=16, samples=400), **options)
        np.testing.assert_array_equal(fit["shape"].inner, written["inner"])
        np.testing.assert_array_equal(fit["shape"].outer, written["outer"])
        self.assertLess(
            fit["history"][-1]["symmetric_difference"], fit["history"][0]["symmetric_difference"]
        )
        self.assertEqual(len(fit["path"]), len(fit["history"]))
        mean, largest = shapes.distance(fit["shape"].polygon(), ellipse)
        self.assertLess(mean, 0.5)
        self.assertLess(mean, largest)

    def test_average_lies_between(self):
        tall, wide = planar.ellipse(200, 20.0, 30.0), planar.ellipse(200, 30.0, 20.0)
        start = shapes.around([tall, wide], order=12)
        fits = [shapes.fit(one, start, max_iterations=20)["shape"] for one in (tall, wide)]
        mean = shapes.average(fits)
        np.testing.assert_allclose(mean.inner, (fits[0].inner + fits[1].inner) / 2)
        self.assertGreater(mean.margin, 0)
        width, height = np.ptp(mean.polygon(), axis=0)
        self.assertAlmostEqual(width, height, delta=0.5)
        third = shapes.combine(fits, [1, 0])
        np.testing.assert_array_equal(third.inner, fits[0].inner)

    def test_a_given_annulus_is_taken_as_a_circular_one(self):
        round_one = shapes.concentric(2, [0, 0, 0], 12.0, 30.0, 16)
        given = shapes.between(planar.circle(400, 12.0), planar.circle(400, 30.0), order=16)
        self.assertIsNone(round_one.inner_boundary)
        self.assertEqual(given.outer_boundary.shape, (400, 2))
        target = planar.ellipse(200, 22.0, 18.0)
        a, b = (shapes.fit(target, start)["shape"] for start in (round_one, given))
        np.testing.assert_allclose(a.inner, b.inner, atol=2e-3)
        again = given.with_coefficients(b.inner, b.outer)
        np.testing.assert_array_equal(again.values([[20.0, 3.0]]), b.values([[20.0, 3.0]]))
        mixed = shapes.combine([given, b], [1, 3])
        self.assertGreater(mixed.margin, 0)

    def test_a_band_follows_what_a_circle_cannot(self):
        angle = 2 * np.pi * np.arange(300) / 300
        radius = 20 * (1 + 0.3 * np.cos(5 * angle))
        lobed = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
        near = shapes.fit(lobed, shapes.band([lobed], 3.0))["shape"]
        self.assertLess(shapes.distance(near.polygon(), lobed)[1], 0.3)
        far = shapes.fit(lobed)["shape"]
        self.assertGreater(shapes.distance(far.polygon(), lobed)[1], 1.0)

    def test_surfaces_are_taken_as_every_surface_is(self):
        ball = explica.icosphere(3, 10.0)
        fit = shapes.fit(ball, samples=300, max_iterations=5)
        mean, _ = shapes.distance(fit["shape"].surface(32), ball)
        self.assertLess(mean, 0.2)

    def test_mistakes_are_value_errors_in_words(self):
        with self.assertRaisesRegex(ValueError, "mixed"):
            shapes.around([planar.circle(20), explica.icosphere(1)])
        with self.assertRaisesRegex(ValueError, "coefficients each"):
            shapes.Shape(2, [0, 0, 0], 1, 2, np.zeros(3), np.zeros(4), 1)
        ring = shapes.concentric(2, [0, 0, 0], 1, 2, 1)
        with self.assertRaisesRegex(ValueError, "weight"):
            shapes.combine([ring], [])
        with self.assertRaisesRegex(ValueError, "in the plane"):
            ring.surface()
        with self.assertRaisesRegex(ValueError, "lie within"):
            shapes.between(planar.circle(20, 9.0), planar.circle(20, 5.0))
        with self.assertRaisesRegex(ValueError, "coefficients each"):
            ring.with_coefficients(np.zeros(2), np.zeros(2))


if __name__ == "__main__":
    unittest.main()
