#!/usr/bin/python3
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""What a picture costs while a surface is turned in the window, under Xvfb with software OpenGL.

    Modules/Viewer/benchmark/turning.py build/bin/explica [SURFACE]

Without a surface a ball of 327,680 faces is turned.  Prints processor milliseconds a picture (of the window and
of all its threads: 52 pictures less 2) and the same over the processors that the window may use, which is the
least time between two pictures: 50 ms are 20 a second."""

import os
import pathlib
import resource
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "Applications/View/test"))
import virtual_display  # noqa: E402


def write_ball(path, levels=7):
    """An icosphere of 20 * 4^levels faces, with folds, as OFF."""
    g = (1 + 5**0.5) / 2
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g)]
    points += [(0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4)]
    faces += [(11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8)]
    faces += [(3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    import numpy as np

    points, faces = np.array(points, float), np.array(faces)
    for _ in range(levels):
        edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
        edges, index = np.unique(edges, axis=0, return_inverse=True)
        a, b, c = (index.reshape(3, -1) + len(points))
        points = np.concatenate([points, points[edges].mean(axis=1)])
        x, y, z = faces.T
        faces = np.concatenate([np.stack(t, 1) for t in ((x, a, c), (y, b, a), (z, c, b), (a, b, c))])
    points /= np.linalg.norm(points, axis=1)[:, None]
    points *= 60 * (1 - 0.1 * np.sin(12 * points[:, :1]) * np.sin(11 * points[:, 1:2]))
    with open(path, "w") as file:
        file.write(f"OFF\n{len(points)} {len(faces)} 0\n")
        np.savetxt(file, points, "%.5f")
        np.savetxt(file, np.column_stack([np.full(len(faces), 3), faces]), "%d")


def seconds(executable, surface, pictures, folder):
    script = pathlib.Path(folder) / "script"
    script.write_text(f"turn {pictures}\n")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with virtual_display.VirtualDisplay() as environment:
        subprocess.run([executable, "view", surface, "--script", script], env=environment, check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    executable = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        surface = sys.argv[2] if len(sys.argv) > 2 else str(pathlib.Path(folder) / "ball.off")
        if len(sys.argv) < 3:
            write_ball(surface)
        few, many = (seconds(executable, surface, n, folder) for n in (2, 52))
        each = 1000 * (many - few) / 50
        processors = len(os.sched_getaffinity(0))
        print(f"{each:.0f} ms of processor a picture, {each / processors:.0f} ms on {processors} processors")


main()
