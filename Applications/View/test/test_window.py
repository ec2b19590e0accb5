# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The interactive window under a virtual display, with scripted events and pictures of it."""

import math
import os
import pathlib
import subprocess
import tempfile
import unittest

import virtual_display

EXECUTABLE = os.environ["EXPLICA_EXECUTABLE"]


def folded_ball(path, rings=48, sectors=72, radius=30.0):
    """A ball with folds, as OFF, faces counter-clockwise from outside."""

    def point(theta, phi):
        x, y, z = (
            math.sin(theta) * math.cos(phi),
            math.sin(theta) * math.sin(phi),
            math.cos(theta),
        )
        r = radius * (1 - 0.2 * (0.5 + 0.5 * math.sin(7 * y) * math.sin(7 * z)))
        return r * x, r * y, r * z

    points = [point(0, 0)]
    points += [
        point(math.pi * i / rings, 2 * math.pi * j / sectors)
        for i in range(1, rings)
        for j in range(sectors)
    ]
    points.append(point(math.pi, 0))
    at = lambda i, j: 1 + (i - 1) * sectors + j % sectors
    faces = []
    for j in range(sectors):
        faces.append((0, at(1, j), at(1, j + 1)))
        for i in range(1, rings - 1):
            faces.append((at(i, j), at(i + 1, j), at(i + 1, j + 1)))
            faces.append((at(i, j), at(i + 1, j + 1), at(i, j + 1)))
        faces.append((len(points) - 1, at(rings - 1, j + 1), at(rings - 1, j)))
    with open(path, "w") as file:
        file.write(f"OFF\n{len(points)} {len(faces)} 0\n")
        file.writelines("%.17g %.17g %.17g\n" % p for p in points)
        file.writelines("3 %d %d %d\n" % f for f in faces)


class Window(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        folded_ball(self.folder / "ball.off")

    def view(self, script, *words):
        path = self.folder / "script"
        path.write_text(script)
        with virtual_display.VirtualDisplay() as environment:
            result = subprocess.run(
                [EXECUTABLE, "view", *words, "--script", str(path)],
                cwd=self.folder,
                env=environment,
                capture_output=True,
                text=True,
                timeout=250,
            )
        return result

    def pictures(self, names):
        pictures = [(self.folder / f"{name}.png").read_bytes() for name in names.split()]
        for picture in pictures:
            self.assertEqual(picture[1:4], b"PNG")
            self.assertGreater(len(picture), 20000, "a blank window compresses to less")
        self.assertEqual(len(set(pictures)), len(pictures), "every event must show")

    @unittest.skipUnless(virtual_display.SERVER, "skipped: Xvfb is not installed")
    def test_choose_run_turn_step_back_and_save(self):
        result = self.view(
            "picture start.png\n"
            "key c 540 420\npicture chosen.png\n"
            "set radius 16\npicture larger.png\ndo undo\n"
            "set target 1\nkey space 0 0\nwait 8\nkey space 0 0\npicture unfolded.png\n"
            "drag 500 400 700 380\npicture turned.png\n"
            "key m 0 0\npicture flux.png\n"
            "key m 0 0\npicture seen.png\n"
            "key m 0 0\npicture area.png\n"
            "set low 0.5\npicture range.png\n"
            "key Home 0 0\npicture first.png\n"
            "key Right 0 0\nkey Right 0 0\nkey w 0 0\nsaved\npicture saved.png\n"
            "key r 0 0\npicture reset.png\n",
            "ball.off", "--radius", "14", "--save", "kept",
        )  # fmt: skip
        self.assertEqual(result.returncode, 0, result.stderr)
        self.pictures(
            "start chosen larger unfolded turned flux seen area range first saved reset"
        )

        # The saved state is what the printed command writes.
        saved = self.folder / "kept" / "iteration-2"
        command = result.stderr.split("the same as: ")[1].splitlines()[0].split()
        command[0] = EXECUTABLE
        command[command.index("--out") + 1] = "again"
        again = subprocess.run(command, cwd=self.folder, capture_output=True)
        self.assertEqual(again.returncode, 3)
        for name in ("unfolded.surf.gii", "visibility.shape.gii"):
            self.assertEqual(
                (saved / name).read_bytes(), (self.folder / "again" / name).read_bytes()
            )

    @unittest.skipUnless(virtual_display.SERVER, "skipped: Xvfb is not installed")
    def test_it_stops_by_itself_and_opens_what_was_finished(self):
        result = self.view(
            "key c 540 420\nkey space 0 0\nwait 100000\npicture over.png\nkey w 0 0\nsaved\n",
            "ball.off", "--radius", "14", "--save", "kept",
        )  # fmt: skip
        self.assertEqual(result.returncode, 0, result.stderr)
        saved = next((self.folder / "kept").iterdir())
        result = self.view(
            f"picture opened.png\nkey Home 0 0\npicture before.png\n"
            f"open {saved}/region.label.gii\nset map region.label.gii\npicture labels.png\n"
            f"open {saved}/distortion.shape.gii\nkey m 0 0\npicture map.png\n"
            "open ball.off\npicture refused.png\n",
            str(saved),
        )
        self.assertEqual(result.returncode, 0, result.stderr)
        self.pictures("over opened before labels refused")

    def test_without_a_display_it_says_so(self):
        environment = {k: v for k, v in os.environ.items() if k != "DISPLAY"}
        for display in ({}, {"DISPLAY": ":4711"}):
            result = subprocess.run(
                [EXECUTABLE, "view", "ball.off"],
                cwd=self.folder,
                capture_output=True,
                text=True,
                env={**environment, **display},
            )
            self.assertEqual(result.returncode, 4)
            self.assertIn("--screenshot", result.stderr)

    @unittest.skipUnless(virtual_display.SERVER, "skipped: Xvfb is not installed")
    def test_unknown_event_is_named(self):
        result = self.view("jump 3\n", "ball.off")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("jump 3", result.stderr)


if __name__ == "__main__":
    unittest.main()
