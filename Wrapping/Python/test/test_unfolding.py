# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Unfolding from Python: energies against finite differences, stepping, steering, stopping."""

import sys
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
        """As long as folds are closed; then `unfold` weighs visibility against lengths between the steps."""
        options = dict(max_iterations=2, target_visibility=1.0)
        once = explica.unfold(self.surface, self.region["vertices"], self.view, **options)
        stepper = explica.Unfolder(self.surface, self.region["vertices"], self.view)
        self.assertTrue(stepper.step(2))
        np.testing.assert_array_equal(stepper.positions, once["positions"])
        self.assertEqual(once["history"][-1]["visibility"], stepper.record["visibility"])
        self.assertGreater(once["history"][-1]["visibility"], once["history"][0]["visibility"])
        self.assertEqual(once["termination"], "max-iterations")

    def test_viewpoint_changes_on_the_way(self):
        """The visibility climbs for the new viewpoint, as counted from it."""
        elsewhere = np.array([-800.0, 600.0, 0.0])
        faces, region = self.surface[1], self.region
        stepper = explica.Unfolder(self.surface, region["vertices"], self.view)
        stepper.step(3)

        def seen():
            mesh = (stepper.positions, faces)
            return explica.average_visibility(mesh, elsewhere, region["faces"])["value"]

        before = stepper.positions
        start = seen()
        stepper.set_viewpoints(elsewhere)
        np.testing.assert_array_equal(stepper.positions, before)
        self.assertTrue(stepper.step(4))
        self.assertGreater(seen(), start)
        self.assertAlmostEqual(stepper.record["visibility"], seen(), places=12)

    def test_several_viewpoints_are_one_with_weights(self):
        view = explica.view_line([-900.0, -300.0, 0.0], [-900.0, 300.0, 0.0], 4)
        self.assertAlmostEqual(view.weights.sum(), 1)
        stepper = explica.Unfolder(self.surface, self.region["vertices"], view)
        stepper.step(2)
        each = [
            explica.average_visibility(
                (stepper.positions, self.surface[1]), point, self.region["faces"]
            )["value"]
            for point in view.points
        ]
        self.assertAlmostEqual(stepper.record["visibility"], np.dot(each, view.weights), places=10)

    def test_region_grows_on_the_way(self):
        stepper = explica.Unfolder(self.surface, self.region["vertices"], self.view)
        stepper.step(3)
        before = stepper.positions
        larger = explica.select_region(self.surface, vertex=self.centre, radius=15)
        stepper.set_region(larger["vertices"])
        np.testing.assert_array_equal(stepper.positions, before)
        np.testing.assert_array_equal(stepper.region["faces"], larger["faces"])
        stepper.step(2)
        self.assertFalse(np.array_equal(stepper.positions, before))
        self.assertEqual(len(explica.self_intersections((stepper.positions, self.surface[1]))), 0)

    def test_region_moves_on_the_way(self):
        """Beside fixed surroundings what the first region became stays, and stands in the way."""
        positions, faces = explica.folded_sphere(4, 30.0, 0.35, 8)
        first = explica.select_region((positions, faces), vertex=634, radius=13.9)
        second = explica.select_region((positions, faces), vertex=2177, radius=10.7)
        stepper = explica.Unfolder(
            (positions, faces), first["vertices"], [320.0, 50.0, 950.0], surround="fixed"
        )
        stepper.step(40)
        before = stepper.positions
        stepper.set_region(second["vertices"])
        stepper.set_viewpoints([-430.0, 900.0, -65.0])
        stepper.step(60)
        still = np.setdiff1d(np.arange(len(positions)), second["vertices"])
        np.testing.assert_array_equal(stepper.positions[still], before[still])
        self.assertFalse(np.array_equal(stepper.positions, before))
        self.assertEqual(len(explica.self_intersections((stepper.positions, faces))), 0)

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
        """No thread has to give way here, so that the other runs only while the work lets go."""
        interval = sys.getswitchinterval()
        self.addCleanup(sys.setswitchinterval, interval)
        ticks = []
        stop = threading.Event()

        def tick():
            while not stop.wait(0.001):
                ticks.append(1)

        thread = threading.Thread(target=tick)
        thread.start()
        sys.setswitchinterval(1000)
        before = len(ticks)
        for _ in range(500):
            explica.unfold(self.surface, self.region["vertices"], self.view, max_iterations=20)
            if len(ticks) > before:
                break
        meanwhile = len(ticks) - before
        sys.setswitchinterval(interval)
        stop.set()
        thread.join()
        self.assertGreater(meanwhile, 0)

    def test_half_of_a_ball_faces_away(self):
        p, f = ball = explica.icosphere(3, 10.0)
        flux = explica.vertex_flux(ball, [1000.0, 0, 0])
        self.assertGreater(np.corrcoef(flux, p[:, 0])[0, 1], 0.999)
        self.assertAlmostEqual(explica.backfacing_share(ball, np.arange(len(f)), [1e6, 0, 0]), 0.5, delta=0.02)

    def test_viewpoints_are_checked(self):
        with self.assertRaisesRegex(ValueError, "viewpoints"):
            explica.Viewpoints(np.zeros((2, 2)))
        with self.assertRaisesRegex(TypeError, "viewpoints"):
            explica.average_visibility(self.surface, np.zeros((2, 2)))
        with self.assertRaisesRegex(ValueError, "weights"):
            explica.Viewpoints([[1.0, 2, 3]], weights=[-1])
        with self.assertRaisesRegex(ValueError, "region: face 99999"):
            explica.distortion(self.surface, self.surface[0], [99999])

    def test_distortion_of_nothing_is_none(self):
        p, _ = self.surface
        d = explica.distortion(self.surface, p, self.region["faces"])
        self.assertEqual(d["area_error_max"], 0)
        self.assertEqual(d["edge_strain_mean"], 0)


if __name__ == "__main__":
    unittest.main()
