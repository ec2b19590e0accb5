# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""The interactive window under a virtual display, with scripted events and pictures of it."""

import json
import math
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import nibabel
import numpy as np

import virtual_display

EXECUTABLE = os.environ["EXPLICA_EXECUTABLE"]


def folded_ball(path, rings=48, sectors=72, radius=30.0, thrown=0.0):
    """A ball with folds, as OFF, faces counter-clockwise from outside; some points of its side at -x are
    thrown out of place by so many millimetres, so that faces cross."""

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
    random = np.random.default_rng(7)
    for n in range(0, len(points), 17):
        if points[n][0] < -15:
            points[n] = tuple(np.array(points[n]) + thrown * random.standard_normal(3))
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


def sampled_and_flat(folder):
    """A folded sheet with a volume on it: the folders of explica sample and explica flatten."""
    points, faces = [], []
    count, pitch = 41, 1.0
    for i in range(count):
        for j in range(count):
            x, y = pitch * (i - count // 2), pitch * (j - count // 2)
            points.append((x, y, 4 * math.cos(0.35 * x) * math.cos(0.1 * y)))
    for i in range(count - 1):
        for j in range(count - 1):
            a, b = i * count + j, (i + 1) * count + j
            faces += [(a, b, b + 1), (a, b + 1, a + 1)]
    points = np.array(points, "f4")
    faces = np.array(faces, "i4")
    gifti = nibabel.gifti
    for name, lift in (("white", 0), ("pial", 2)):
        surface = gifti.GiftiImage()
        for data, intent in ((points + [0, 0, lift], "POINTSET"), (faces, "TRIANGLE")):
            kind = "NIFTI_TYPE_FLOAT32" if intent == "POINTSET" else "NIFTI_TYPE_INT32"
            surface.add_gifti_data_array(
                gifti.GiftiDataArray(
                    data.astype("f4" if intent == "POINTSET" else "i4"),
                    "NIFTI_INTENT_" + intent,
                    kind,
                )
            )
        surface.meta["AnatomicalStructurePrimary"] = "CortexLeft"
        nibabel.save(surface, folder / f"{name}.surf.gii")
    affine = np.diag([1.0, 1, 1, 1])
    affine[:3, 3] = (-25, -25, -8)
    place = np.moveaxis(np.indices((51, 51, 18)), 0, -1) + affine[:3, 3]
    folded = 4 * np.cos(0.35 * place[..., 0]) * np.cos(0.1 * place[..., 1])
    depth = (place[..., 2] - folded) / 2
    values = 10 * depth + np.where(place[..., 1] > 0, 5, 0)
    nibabel.save(nibabel.Nifti1Image(values.astype("f4"), affine), folder / "t1.nii.gz")
    labels = gifti.GiftiImage()
    keys = np.where(points[:, 1] > 0, 2, 1).astype("i4")
    labels.add_gifti_data_array(
        gifti.GiftiDataArray(keys, "NIFTI_INTENT_LABEL", "NIFTI_TYPE_INT32")
    )
    for key, name, red in ((1, "posterior", 0.9), (2, "anterior", 0.1)):
        entry = gifti.GiftiLabel(key, red, 0.2, 1 - red, 1)
        entry.label = name
        labels.labeltable.labels.append(entry)
    nibabel.save(labels, folder / "areas.label.gii")
    for words in (
        ["sample", "t1.nii.gz", "--surfaces", ".", "--depths", "5", "--labels", "areas.label.gii"]
        + ["--out", "sampled"],
        ["flatten", "white.surf.gii", "--surfaces", ".", "--volumes", "t1.nii.gz"]
        + ["--regions", "areas.label.gii", "--out", "flat"],
    ):
        subprocess.run([EXECUTABLE, *words, "--quiet"], cwd=folder, check=True)


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

        self.saved_is_what_the_command_writes(result, 2)

    def saved_is_what_the_command_writes(self, result, state):
        saved = self.folder / "kept" / f"iteration-{state}"
        command = result.stderr.split("the same as: ")[1].splitlines()[0].split()
        command[0] = EXECUTABLE
        command[command.index("--out") + 1] = "again"
        again = subprocess.run(command, cwd=self.folder, capture_output=True)
        self.assertEqual(again.returncode, 3)
        for name in ("unfolded.surf.gii", "visibility.shape.gii"):
            self.assertEqual(
                (saved / name).read_bytes(), (self.folder / "again" / name).read_bytes()
            )
        return command

    @unittest.skipUnless(virtual_display.SERVER, "skipped: Xvfb is not installed")
    def test_the_view_that_is_taken_is_the_viewpoint(self):
        result = self.view(
            "key c 540 420\npicture one.png\ndrag 500 400 560 380\ndo view\npicture two.png\n"
            "set distance 500\npicture nearer.png\n"
            "set target 1\nkey space 0 0\nwait 4\nkey space 0 0\n"
            "key Home 0 0\nkey Right 0 0\nkey Right 0 0\nkey w 0 0\nsaved\npicture saved.png\n",
            "ball.off", "--radius", "14", "--save", "kept",
        )  # fmt: skip
        self.assertEqual(result.returncode, 0, result.stderr)
        self.pictures("one two nearer saved")
        command = self.saved_is_what_the_command_writes(result, 2)
        self.assertEqual(command[command.index("--distance") + 1], "500")
        self.assertNotEqual(command[command.index("--direction") + 1], "-1,0,0")

    @unittest.skipUnless(virtual_display.SERVER, "skipped: Xvfb is not installed")
    def test_faces_that_cross_are_parted_first(self):
        folded_ball(self.folder / "ball.off", thrown=4)
        result = self.view(
            "key c 540 420\nset target 1\nkey space 0 0\nwait 3\nkey space 0 0\n"
            "key Home 0 0\npicture parted.png\nkey Right 0 0\nkey w 0 0\nsaved\npicture one.png\n",
            "ball.off", "--radius", "14", "--save", "kept",
        )  # fmt: skip
        self.assertEqual(result.returncode, 0, result.stderr)
        self.pictures("parted one")
        self.saved_is_what_the_command_writes(result, 1)
        summary = json.loads((self.folder / "kept" / "iteration-1" / "summary.json").read_text())
        self.assertGreater(summary["self_intersections_repaired"], 0)

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

    @unittest.skipUnless(virtual_display.SERVER, "skipped: Xvfb is not installed")
    def test_sampled_and_flattened_folders_open(self):
        sampled_and_flat(self.folder)
        result = self.view(
            "picture maps.png\n"
            "set map areas.label.gii\npicture labels.png\n"
            "open flat\npicture montage.png\n",
            "sampled",
        )
        self.assertEqual(result.returncode, 0, result.stderr)
        self.pictures("maps labels montage")
        # A flattening by itself: its patch, folded and flat, under the maps of the whole.
        result = self.view(
            "picture flat.png\nkey b 0 0\npicture folded.png\n"
            "set map t1 depth 1\npicture map.png\ndo profiles\n",
            "flat", "sampled",
        )  # fmt: skip
        self.assertEqual(result.returncode, 2, result.stderr)  # there is no such action
        self.assertIn("do profiles", result.stderr)
        self.pictures("flat folded map")

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

    def test_only_the_window_needs_qt_and_vtk(self):
        needed = subprocess.run(["ldd", EXECUTABLE], capture_output=True, text=True, check=True).stdout
        for library in ("libvtk", "libQt5", "libX11", "libGL"):
            self.assertNotIn(library, needed)

    def test_without_the_window_beside_it_the_program_says_so(self):
        program = self.folder / "bin" / "explica"
        program.parent.mkdir()
        shutil.copy(EXECUTABLE, program)
        result = subprocess.run(
            [program, "view", "ball.off"], cwd=self.folder, capture_output=True, text=True
        )
        self.assertEqual(result.returncode, 4)
        self.assertIn("explica-window: the window is not installed", result.stderr)
        self.assertIn("--screenshot", result.stderr)

    @unittest.skipUnless(virtual_display.SERVER, "skipped: Xvfb is not installed")
    def test_unknown_event_is_named(self):
        result = self.view("jump 3\n", "ball.off")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("jump 3", result.stderr)


if __name__ == "__main__":
    unittest.main()
