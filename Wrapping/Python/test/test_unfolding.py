# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Unfolding from Python: energies against finite differences, stepping, steering, stopping."""

import threading
import unittest

import numpy as np

import explica


class Unfolding(unittest.TestCase):
    def setUp(self):
        self.surface = explica.folded_sphere(3, 30.0)
        p, _ = self.surface
        self.centre = int(np.argmin(p[:, 0]))
        self.view = np.array([-1000.0, 0, 0])
        self.region = explica.select_region(self.surface, vertex=self.centre, radius=12)

    def test_visibility_gradient_is_the_derivative(self):
        p, f = self.surface
        faces = self.region["faces"]
        result = explica.average_visibility(self.surface, self.view, region=faces)
        direction = np.random.default_rng(5).normal(size=p.shape)
        h = 1e-5
        plus, minus = (
            explica.average_visibility((p + s * h * direction, f), self.view, faces)["value"]
            for s in (1, -1)
        )
        slope = np.sum(result["gradient"] * direction)
        self.assertAlmostEqual((plus - minus) / (2 * h), slope, delta=1e-7 * max(1, abs(slope)))

    def test_convex_ball_is_seen_exactly_where_it_faces_the_viewer(self):
        p, f = explica.icosphere(4, 10.0)
        seen = explica.visible_fraction((p, f), self.view)
        flux = explica.average_visibility((p, f), self.view)["face_flux"]
        np.testing.assert_array_equal(seen["face"] > 0.5, flux > 0)

    def test_one_shot_equals_steps(self):
        options = dict(max_iterations=6)
        once = explica.unfold(self.surface, self.region["vertices"], self.view, **options)
        stepper = explica.Unfolder(self.surface, self.region["vertices"], self.view)
        self.assertTrue(stepper.step(6))
        np.testing.assert_array_equal(stepper.positions, once["positions"])
        self.assertEqual(once["history"][-1]["visibility"], stepper.record["visibility"])
        self.assertGreater(once["history"][-1]["visibility"], once["history"][0]["visibility"])
        self.assertEqual(once["termination"], "max-iterations")

    def test_viewpoint_region_and_weights_change_on_the_way(self):
        stepper = explica.Unfolder(self.surface, self.region["vertices"], self.view)
        stepper.step(3)
        before = stepper.positions
        stepper.set_viewpoints([-800.0, 600.0, 0.0])
        stepper.set_weights(spring_weight=0.1)
        larger = explica.select_region(self.surface, vertex=self.centre, radius=15)
        stepper.set_region(larger["vertices"])
        np.testing.assert_array_equal(stepper.positions, before)
        self.assertEqual(stepper.region["faces"], larger["faces"])
        stepper.step(2)
        self.assertFalse(np.array_equal(stepper.positions, before))
        self.assertEqual(len(explica.self_intersections((stepper.positions, self.surface[1]))), 0)

    def test_progress_may_stop_the_work(self):
        calls = []
        result = explica.unfold(
            self.surface,
            self.region["vertices"],
            self.view,
            progress=lambda fraction, activity: calls.append(fraction) or len(calls) < 3,
        )
        self.assertEqual(result["termination"], "interrupted")
        self.assertGreaterEqual(len(calls), 3)

    def test_exception_in_progress_comes_out(self):
        def fail(fraction, activity):
            raise KeyError("mine")

        with self.assertRaisesRegex(KeyError, "mine"):
            explica.unfold(self.surface, self.region["vertices"], self.view, progress=fail)

    def test_other_threads_run_meanwhile(self):
        ticks = []
        stop = threading.Event()

        def tick():
            while not stop.wait(0.001):
                ticks.append(1)

        thread = threading.Thread(target=tick)
        thread.start()
        explica.unfold(self.surface, self.region["vertices"], self.view, max_iterations=20)
        stop.set()
        thread.join()
        self.assertGreater(len(ticks), 0)

    def test_distortion_of_nothing_is_none(self):
        p, _ = self.surface
        d = explica.distortion(self.surface, p, self.region["faces"])
        self.assertEqual(d["area_error_max"], 0)
        self.assertEqual(d["edge_strain_mean"], 0)

    def test_knot_energy_scales_with_the_square_of_size(self):
        p, f = explica.icosphere(2, 3.0)
        small, gradient = explica.knot_energy((p, f), method="all-pairs")
        large, _ = explica.knot_energy((2 * p, f), method="all-pairs")
        self.assertAlmostEqual(large / small, 4, places=10)
        # A sphere is in balance but for its size: the gradient runs along the radius.
        radial = p / np.linalg.norm(p, axis=1, keepdims=True)
        along = np.sum(gradient * radial, axis=1, keepdims=True) * radial
        self.assertLess(np.linalg.norm(gradient - along), 0.1 * np.linalg.norm(gradient))


if __name__ == "__main__":
    unittest.main()
